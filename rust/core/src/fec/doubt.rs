//! How doubtful the likeliest of several explanations of a word is.

/// Chance, word by word, of something other than Gaussian noise: a half-cycle slip, interference.
const SURPRISE: f64 = 1e-8;

/// Probability that the cheapest explanation of a word is wrong.
///
/// A cost is the sum of the magnitudes of the symbols of amplitude 1 that would be wrong: in noise
/// of variance s^2, errors of cost c have the weight exp(-2 c / s^2). Those of `more` symbols or
/// beyond are not among the explanations; they count as if the weakest symbols were wrong, or as
/// the cheapest explanation if that costs more. The magnitudes are left in another order.
pub fn doubt(costs: &[f64], magnitudes: &mut [f64], more: usize, noise: f64) -> f64 {
    let least = costs.iter().copied().fold(f64::INFINITY, f64::min);
    if more > 0 && more < magnitudes.len() {
        magnitudes.select_nth_unstable_by(more - 1, f64::total_cmp);
    }
    let weakest: f64 = magnitudes.iter().take(more).sum();
    let chance = |cost: f64| (-2.0 * (cost - least) / noise.powi(2)).max(-700.0).exp();
    let known: f64 = costs.iter().map(|&cost| chance(cost)).sum();
    let surprise = SURPRISE * (2.0 * least / noise.powi(2)).min(700.0).exp();
    let others = known + chance(weakest.max(least)) - 1.0 + surprise;
    others / (1.0 + others)
}
