//! Inverse of the normal distribution function.

/// Value of the polynomial with these coefficients, constant term first.
fn polynomial(coefficients: [f64; 8], x: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

/// x with P(X < x) = `p` for a standard normal X, 0 < p < 1; relative error about 1e-16.
///
/// Wichura 1988, "Algorithm AS 241: the percentage points of the normal distribution", PPND16.
#[allow(clippy::excessive_precision)]
pub(super) fn normal_quantile(p: f64) -> f64 {
    let q = p - 0.5;
    if q.abs() <= 0.425 {
        let r = 0.180625 - q * q;
        return q * polynomial(
            [
                3.387_132_872_796_366_608_0,
                1.331_416_678_917_843_774_5e2,
                1.971_590_950_306_551_442_7e3,
                1.373_169_376_550_946_112_5e4,
                4.592_195_393_154_987_145_7e4,
                6.726_577_092_700_870_085_3e4,
                3.343_057_558_358_812_810_5e4,
                2.509_080_928_730_122_672_7e3,
            ],
            r,
        ) / polynomial(
            [
                1.0,
                4.231_333_070_160_091_125_2e1,
                6.871_870_074_920_579_082_9e2,
                5.394_196_021_424_751_107_7e3,
                2.121_379_430_158_659_586_7e4,
                3.930_789_580_009_271_061_0e4,
                2.872_908_573_572_194_267_4e4,
                5.226_495_278_852_854_561_0e3,
            ],
            r,
        );
    }
    let r = (-p.min(1.0 - p).ln()).sqrt();
    let tail = if r <= 5.0 {
        polynomial(
            [
                1.423_437_110_749_683_577_34,
                4.630_337_846_156_545_295_90,
                5.769_497_221_460_691_405_50,
                3.647_848_324_763_204_605_04,
                1.270_458_252_452_368_382_58,
                2.417_807_251_774_506_117_70e-1,
                2.272_384_498_926_918_458_33e-2,
                7.745_450_142_783_414_076_40e-4,
            ],
            r - 1.6,
        ) / polynomial(
            [
                1.0,
                2.053_191_626_637_758_821_87,
                1.676_384_830_183_803_849_40,
                6.897_673_349_851_000_045_50e-1,
                1.481_039_764_274_800_745_90e-1,
                1.519_866_656_361_645_719_66e-2,
                5.475_938_084_995_344_946_00e-4,
                1.050_750_071_644_416_843_24e-9,
            ],
            r - 1.6,
        )
    } else {
        polynomial(
            [
                6.657_904_643_501_103_777_20,
                5.463_784_911_164_114_369_90,
                1.784_826_539_917_291_335_80,
                2.965_605_718_285_048_912_30e-1,
                2.653_218_952_657_612_309_30e-2,
                1.242_660_947_388_078_438_60e-3,
                2.711_555_568_743_487_578_15e-5,
                2.010_334_399_292_288_132_65e-7,
            ],
            r - 5.0,
        ) / polynomial(
            [
                1.0,
                5.998_322_065_558_879_376_90e-1,
                1.369_298_809_227_358_053_10e-1,
                1.487_536_129_085_061_485_25e-2,
                7.868_691_311_456_132_591_00e-4,
                1.846_318_317_510_054_681_80e-5,
                1.421_511_758_316_445_888_70e-7,
                2.044_263_103_389_939_785_64e-15,
            ],
            r - 5.0,
        )
    };
    if q < 0.0 {
        -tail
    } else {
        tail
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// P(X > x), by the continued fraction of Mills' ratio (x > 1) in 400 terms.
    pub(in crate::synth) fn normal_tail(x: f64) -> f64 {
        let fraction = (1..400).rev().fold(x, |f, k| x + f64::from(k) / f);
        (-0.5 * x * x).exp() / (fraction * (2.0 * std::f64::consts::PI).sqrt())
    }

    #[test]
    fn inverts_the_distribution() {
        for x in [1.5, 2.0, 3.0, 4.5, 6.0, 8.0] {
            assert!((normal_quantile(normal_tail(x)) + x).abs() < 1e-9, "{x}");
        }
        // Abramowitz and Stegun table 26.5: Q(x) = 0.25 and 0.4
        assert!((normal_quantile(0.75) - 0.674_489_750_196_082).abs() < 1e-14);
        assert!((normal_quantile(0.4) + 0.253_347_103_135_800).abs() < 1e-14);
        assert_eq!(normal_quantile(0.5), 0.0);
    }
}
