//! What one check of four symbols says of each of them.

use super::gf64::{PRODUCT, SIZE};

/// Probability of each element.
pub type Message = [f32; SIZE];

/// Least probability, lest rounding errors exclude an element for good.
const LEAST: f32 = 1e-8;

/// Walsh-Hadamard transform in place, which turns the distribution of a sum (exclusive or) into
/// a product.
pub fn transform(m: &mut Message) {
    let mut half = SIZE / 2;
    while half > 0 {
        for pair in m.chunks_exact_mut(2 * half) {
            let (low, high) = pair.split_at_mut(half);
            for (a, b) in low.iter_mut().zip(high) {
                (*a, *b) = (*a + *b, *a - *b);
            }
        }
        half /= 2;
    }
}

/// Transformed distribution of element times symbol, scaled to a sum of one.
fn spectrum(message: &Message, element: u8) -> Message {
    let product = &PRODUCT[usize::from(element)];
    let mut out = [0.0; SIZE];
    for (&to, &p) in product.iter().zip(message) {
        out[usize::from(to)] = p;
    }
    transform(&mut out);
    let scale = 1.0 / out[0];
    out.iter_mut().for_each(|p| *p *= scale);
    out
}

/// Distribution of a symbol from the spectrum of element times symbol.
fn distribution(mut spectrum: Message, element: u8) -> Message {
    transform(&mut spectrum);
    let product = &PRODUCT[usize::from(element)];
    let value = |&from: &u8| (spectrum[usize::from(from)] / SIZE as f32).max(LEAST);
    let mut out = [0.0; SIZE];
    for (p, from) in out.iter_mut().zip(product) {
        *p = value(from);
    }
    out
}

fn times(a: &Message, b: &Message) -> Message {
    std::array::from_fn(|k| a[k] * b[k])
}

/// Distribution of each of four symbols whose products with their elements sum to zero, from
/// those of the three others (Davey and MacKay 1998; by transform: MacKay and Davey 2000).
pub fn update(messages: &[Message; 4], elements: &[u8; 4]) -> [Message; 4] {
    let s: [Message; 4] = std::array::from_fn(|k| spectrum(&messages[k], elements[k]));
    let (front, back) = (times(&s[0], &s[1]), times(&s[2], &s[3]));
    let others = [
        times(&s[1], &back),
        times(&s[0], &back),
        times(&s[3], &front),
        times(&s[2], &front),
    ];
    let mut k = 0;
    others.map(|spectrum| {
        k += 1;
        distribution(spectrum, elements[k - 1])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn update_is_the_sum_over_all_combinations() {
        let elements = [33, 42, 14, 24];
        let messages: [Message; 4] = std::array::from_fn(|k| {
            let mut m: Message = std::array::from_fn(|x| ((x * (7 + k) + 3 * k) % 17) as f32 + 0.5);
            let sum: f32 = m.iter().sum();
            m.iter_mut().for_each(|p| *p /= sum);
            m
        });
        let found = update(&messages, &elements);
        let mut expected = [0.0f64; SIZE];
        let product = |k: usize, x: usize| PRODUCT[usize::from(elements[k])][x];
        for a in 0..SIZE {
            for b in 0..SIZE {
                for c in 0..SIZE {
                    let sum = product(0, a) ^ product(1, b) ^ product(3, c);
                    let x = (0..SIZE).find(|&x| product(2, x) == sum).unwrap();
                    let p = messages[0][a] * messages[1][b] * messages[3][c];
                    expected[x] += f64::from(p);
                }
            }
        }
        for (&f, e) in found[2].iter().zip(expected) {
            assert!((f64::from(f) - e).abs() < 1e-6, "{f} {e}");
        }
    }
}
