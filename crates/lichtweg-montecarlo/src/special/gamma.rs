//! ln Gamma and the regularised incomplete gamma functions P(a,x), Q(a,x).

use super::{continued_fraction, term_limit};
use std::f64::consts::{PI, TAU};

/// Euler's constant.
const EULER: f64 = 0.577_215_664_901_532_9;

/// zeta(k) - 1 for k = 2, 3, ...
const ZETA_MINUS_ONE: [f64; 26] = [
    0.644_934_066_848_226_4,
    0.202_056_903_159_594_3,
    0.082_323_233_711_138_19,
    0.036_927_755_143_369_93,
    0.017_343_061_984_449_14,
    0.008_349_277_381_922_827,
    0.004_077_356_197_944_339,
    0.002_008_392_826_082_214_4,
    0.000_994_575_127_818_085_3,
    0.000_494_188_604_119_464_6,
    0.000_246_086_553_308_048_3,
    0.000_122_713_347_578_489_15,
    6.124_813_505_870_483e-5,
    3.058_823_630_702_049e-5,
    1.528_225_940_865_187e-5,
    7.637_197_637_899_762e-6,
    3.817_293_264_999_84e-6,
    1.908_212_716_553_939e-6,
    9.539_620_338_727_962e-7,
    4.769_329_867_878_065e-7,
    2.384_505_027_277_33e-7,
    1.192_199_259_653_110_7e-7,
    5.960_818_905_125_948e-8,
    2.980_350_351_465_228e-8,
    1.490_155_482_836_504e-8,
    7.450_711_789_835_429e-9,
];

/// Coefficients B_2k / (2k (2k-1)) of Stirling's series (A&S 6.1.41).
const STIRLING: [f64; 8] = [
    1.0 / 12.0,
    -1.0 / 360.0,
    1.0 / 1260.0,
    -1.0 / 1680.0,
    1.0 / 1188.0,
    -691.0 / 360_360.0,
    1.0 / 156.0,
    -3617.0 / 122_400.0,
];

/// Where Stirling's series with eight terms reaches full precision.
const STIRLING_FROM: f64 = 10.0;

/// Natural logarithm of |Gamma(x)|; infinite at zero and the negative integers.
#[must_use]
pub fn ln_gamma(x: f64) -> f64 {
    if x.is_nan() || x == f64::NEG_INFINITY {
        f64::NAN
    } else if x <= 0.0 {
        // Reflection, A&S 6.1.17. The sine is of the distance to the nearest integer, which is exact.
        let sine = (PI * (x - x.round())).sin().abs();
        if sine == 0.0 { f64::INFINITY } else { (PI / sine).ln() - ln_gamma(1.0 - x) }
    } else if x < 0.5 {
        ln_gamma_near_two(x) - x.ln() - x.ln_1p()
    } else if x < 1.5 {
        ln_gamma_near_two(x - 1.0) - (x - 1.0).ln_1p()
    } else if x < STIRLING_FROM {
        // Gamma(x) = (x-1) (x-2) ... Gamma(y) with y in [1.5, 2.5).
        let (mut product, mut y) = (1.0, x);
        while y >= 2.5 {
            y -= 1.0;
            product *= y;
        }
        product.ln() + ln_gamma_near_two(y - 2.0)
    } else if x < 1e300 {
        (x - 0.5) * (x.ln() - 1.0) + (0.5 * (TAU.ln() - 1.0) + stirling_error(x))
    } else {
        x * (x.ln() - 1.0)
    }
}

/// ln Gamma(2 + z) for |z| <= 1/2 by its Taylor series (A&S 6.1.33).
fn ln_gamma_near_two(z: f64) -> f64 {
    let mut series = 0.0;
    for (i, zeta) in ZETA_MINUS_ONE.iter().enumerate().rev() {
        series = zeta / (i + 2) as f64 - z * series;
    }
    z * (1.0 - EULER) + z * z * series
}

/// ln Gamma(x) minus Stirling's formula (x - 1/2) ln x - x + ln(2 pi)/2, for x > 0.
pub(super) fn stirling_error(x: f64) -> f64 {
    if x < STIRLING_FROM {
        return ln_gamma(x) - ((x - 0.5) * x.ln() - x + 0.5 * TAU.ln());
    }
    let inverse_square = 1.0 / (x * x);
    STIRLING.iter().rev().fold(0.0, |sum, coefficient| sum * inverse_square + coefficient) / x
}

/// Loader's deviance x ln(x/m) + m - x for x, m > 0, accurate also for x near m if `difference` is x - m accurately.
pub(super) fn deviance(x: f64, mean: f64, difference: f64) -> f64 {
    if difference.abs() > 0.1 * (x + mean) {
        return x * (x / mean).ln() - difference;
    }
    // With v = (x-m)/(x+m), ln(x/m) = 2 artanh v.
    let v = difference / (x + mean);
    let mut sum = difference * v;
    let mut power = 2.0 * x * v;
    for odd in (3..60).step_by(2) {
        power *= v * v;
        let next = sum + power / f64::from(odd);
        if next == sum {
            break;
        }
        sum = next;
    }
    sum
}

/// x^a e^-x / Gamma(a).
fn leading_factor(a: f64, x: f64) -> f64 {
    if a < 1.0 {
        return (a * x.ln() - x - ln_gamma(a)).exp();
    }
    (a / TAU).sqrt() * (-deviance(a, x, a - x) - stirling_error(a)).exp()
}

/// P(a,x): regularised lower incomplete gamma function, the probability that a Gamma(a) variable is below x.
#[must_use]
pub fn gamma_p(a: f64, x: f64) -> f64 {
    incomplete_gamma(a, x).0
}

/// Q(a,x) = 1 - P(a,x), without cancellation.
#[must_use]
pub fn gamma_q(a: f64, x: f64) -> f64 {
    incomplete_gamma(a, x).1
}

/// Beyond this shape the cube-root normal approximation takes over (relative error below 1e-8 in the bulk).
const LARGEST_SHAPE: f64 = 1e9;

/// (P, Q), each accurate on its own.
fn incomplete_gamma(a: f64, x: f64) -> (f64, f64) {
    if a.is_nan() || x.is_nan() || a <= 0.0 || a == f64::INFINITY || x < 0.0 {
        (f64::NAN, f64::NAN)
    } else if x == 0.0 {
        (0.0, 1.0)
    } else if x == f64::INFINITY {
        (1.0, 0.0)
    } else if a > LARGEST_SHAPE {
        // Wilson and Hilferty (1931).
        let ninth = 1.0 / (9.0 * a);
        let z = ((x / a).cbrt() - (1.0 - ninth)) / ninth.sqrt();
        (super::normal_cdf(z), super::normal_cdf(-z))
    } else if x < a + 1.0 {
        let p = leading_factor(a, x) * lower_series(a, x);
        if a < 1.0 && p > 0.5 { (p, small_shape_q(a, x)) } else { (p, 1.0 - p) }
    } else {
        let q = leading_factor(a, x) / upper_fraction(a, x);
        (1.0 - q, q)
    }
}

/// Q for a < 1 and x < a + 1, where P may be near one: 1 - Gamma-free form of A&S 6.5.29,
/// Q = [1 - x^a / Gamma(1+a)] - x^a / Gamma(a) * sum_{n>=1} (-x)^n / (n! (a+n)).
fn small_shape_q(a: f64, x: f64) -> f64 {
    let log_ratio = a * x.ln() - ln_gamma(1.0 + a);
    let (mut term, mut sum) = (1.0, 0.0);
    for n in 1..60 {
        let n = f64::from(n);
        term *= -x / n;
        sum += term / (a + n);
    }
    -log_ratio.exp_m1() - log_ratio.exp() * a * sum
}

/// gamma(a,x) / (x^a e^-x) = sum x^n / (a (a+1) ... (a+n)), A&S 6.5.29.
fn lower_series(a: f64, x: f64) -> f64 {
    let (mut term, mut sum) = (1.0 / a, 1.0 / a);
    for n in 1..=term_limit(a) {
        term *= x / (a + f64::from(n));
        sum += term;
        if term < 1e-17 * sum {
            break;
        }
    }
    sum
}

/// x^a e^-x / Gamma(a,x) as the continued fraction DLMF 8.9.2 (even part).
fn upper_fraction(a: f64, x: f64) -> f64 {
    continued_fraction(x + 1.0 - a, term_limit(a), |k| (-k * (k - a), x + 2.0 * k + 1.0 - a))
}

#[cfg(test)]
mod tests {
    use super::super::assert_relative;
    use super::*;

    /// (x, ln|Gamma(x)|) computed with 60 digits.
    const LN_GAMMA: [(f64, f64); 20] = [
        (1.0e-10, 23.025_850_929_882_736),
        (0.01, 4.599_479_878_042_022),
        (0.3, 1.095_797_994_818_075_6),
        (0.5, 0.572_364_942_924_700_1),
        (0.9, 0.066_376_239_734_742_95),
        (0.999, 0.000_578_038_532_891_380_2),
        (1.001, -0.000_576_393_598_283_306_2),
        (1.3, -0.108_174_809_507_860_47),
        (1.9999, -4.227_520_877_215_346e-5),
        (2.0001, 4.228_165_811_291_994_5e-5),
        (2.7, 0.434_820_553_655_104_7),
        (5.5, 3.957_813_967_618_716_5),
        (9.9, 12.577_179_904_219_88),
        (10.1, 13.027_526_738_633_236),
        (100.0, 359.134_205_369_575_4),
        (12_345.678, 103_959.919_905_546_06),
        (1_000_000_000.0, 19_723_265_827.503_716),
        (1.0e200, 4.595_170_185_988_091e202),
        (-0.5, 1.265_512_123_484_645_4),
        (-3.7, -1.379_739_904_965_824_5),
    ];

    /// (a, x, P, Q) computed with 60 digits.
    const GAMMA: [(f64, f64, f64, f64); 22] = [
        (0.5, 1.0e-8, 0.000_112_837_916_333_424_87, 0.999_887_162_083_666_6),
        (0.5, 0.3, 0.561_421_973_919_000_2, 0.438_578_026_080_999_9),
        (0.5, 1.4, 0.905_735_693_158_789_7, 0.094_264_306_841_210_32),
        (0.5, 1.6, 0.926_361_729_879_697_3, 0.073_638_270_120_302_65),
        (0.5, 600.0, 1.0, 6.099_568_814_808_433_4e-263),
        (0.001, 1.0e-5, 0.989_123_044_695_782_7, 0.010_876_955_304_217_33),
        (0.001, 0.5, 0.999_439_933_343_529_2, 0.000_560_066_656_470_749_8),
        (0.9, 1.85, 0.866_786_687_593_137_6, 0.133_213_312_406_862_38),
        (1.0, 1.0, 0.632_120_558_828_557_7, 0.367_879_441_171_442_33),
        (3.5, 0.01, 8.530_580_469_428_509e-9, 0.999_999_991_469_419_5),
        (3.5, 3.0, 0.460_250_649_604_442_56, 0.539_749_350_395_557_4),
        (3.5, 60.0, 1.0, 7.661_246_463_353_02e-23),
        (50.0, 30.0, 0.000_518_891_462_548_034_3, 0.999_481_108_537_452),
        (50.0, 49.0, 0.462_104_393_600_940_24, 0.537_895_606_399_059_8),
        (50.0, 52.0, 0.627_850_298_426_132_5, 0.372_149_701_573_867_56),
        (50.0, 150.0, 1.0, 7.412_100_857_322_876e-22),
        (500.0, 350.0, 2.890_359_939_561_195_6e-14, 0.999_999_999_999_971_1),
        (500.0, 499.5, 0.497_024_293_829_115_95, 0.502_975_706_170_884),
        (500.0, 700.0, 0.999_999_999_999_999_3, 7.032_145_641_828_589e-16),
        (10_000.0, 9700.0, 0.001_234_175_584_468_492, 0.998_765_824_415_531_5),
        (10_000.0, 10_500.0, 0.999_999_572_412_754_5, 4.275_872_455_059_647_5e-7),
        (1_000_000.0, 1_003_000.0, 0.998_638_259_353_782_4, 0.001_361_740_646_217_591_5),
    ];

    #[test]
    fn ln_gamma_values() {
        for (x, expected) in LN_GAMMA {
            assert_relative(ln_gamma(x), expected, 4e-15, &format!("ln_gamma({x})"));
        }
        assert_eq!((ln_gamma(1.0), ln_gamma(2.0)), (0.0, 0.0));
        assert_eq!((ln_gamma(0.0), ln_gamma(-3.0)), (f64::INFINITY, f64::INFINITY));
        assert_eq!(ln_gamma(f64::INFINITY), f64::INFINITY);
        assert!(ln_gamma(f64::NAN).is_nan());
    }

    #[test]
    fn incomplete_gamma_values() {
        for (a, x, p, q) in GAMMA {
            assert_relative(gamma_p(a, x), p, 2e-13, &format!("P({a}, {x})"));
            assert_relative(gamma_q(a, x), q, 2e-13, &format!("Q({a}, {x})"));
        }
    }

    #[test]
    fn outside_the_domain_is_nan() {
        for (a, x) in [(-1.0, 1.0), (0.0, 1.0), (1.0, -1.0), (f64::NAN, 1.0), (1.0, f64::NAN)] {
            assert!(gamma_p(a, x).is_nan() && gamma_q(a, x).is_nan());
        }
        assert_eq!((gamma_q(2.0, 0.0), gamma_q(2.0, f64::INFINITY)), (1.0, 0.0));
    }

    #[test]
    fn huge_shapes_join_smoothly() {
        for z in [-3.0, -1.0, 0.0, 2.0, 5.0] {
            let at = |a: f64| gamma_q(a, a + z * a.sqrt());
            assert_relative(at(LARGEST_SHAPE * 1.000_001), at(LARGEST_SHAPE), 1e-6, "Q across the switch");
        }
    }
}
