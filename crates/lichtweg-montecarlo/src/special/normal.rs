//! Error function and normal distribution.

use super::gamma::{gamma_p, gamma_q};
use std::f64::consts::{SQRT_2, TAU};

/// Error function, by erf x = P(1/2, x^2) (A&S 6.5.16).
#[must_use]
pub fn erf(x: f64) -> f64 {
    gamma_p(0.5, x * x).copysign(x)
}

/// Complementary error function 1 - erf x, accurate far out.
#[must_use]
pub fn erfc(x: f64) -> f64 {
    if x < 0.0 { 1.0 + gamma_p(0.5, x * x) } else { gamma_q(0.5, x * x) }
}

/// Probability that a standard normal variable is below `x`. For the upper tail use `normal_cdf(-x)`.
#[must_use]
pub fn normal_cdf(x: f64) -> f64 {
    0.5 * erfc(-x / SQRT_2)
}

/// The x with normal_cdf(x) = p; infinite at 0 and 1. For the upper tail q use `-normal_quantile(q)`.
#[must_use]
pub fn normal_quantile(p: f64) -> f64 {
    if !(0.0..=1.0).contains(&p) {
        f64::NAN
    } else if p == 0.0 {
        f64::NEG_INFINITY
    } else if p > 0.5 {
        // 1 - p is exact here.
        -normal_quantile(1.0 - p)
    } else {
        // Initial guess A&S 26.2.23 (absolute error 4.5e-4), then Halley steps, each of which triples the digits.
        let t = (-2.0 * p.ln()).sqrt();
        let numerator = 2.515_517 + t * (0.802_853 + t * 0.010_328);
        let denominator = 1.0 + t * (1.432_788 + t * (0.189_269 + t * 0.001_308));
        let mut x = numerator / denominator - t;
        for _ in 0..3 {
            let density = (-0.5 * x * x).exp() / TAU.sqrt();
            let step = (normal_cdf(x) - p) / density;
            if step.is_finite() {
                x -= step / (1.0 + 0.5 * x * step);
            }
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::super::assert_relative;
    use super::*;

    /// (x, erf x, erfc x) computed with 60 digits.
    const ERF: [(f64, f64, f64); 11] = [
        (1.0e-20, 1.128_379_167_095_512_5e-20, 1.0),
        (0.001, 0.001_128_378_790_969_236_5, 0.998_871_621_209_030_7),
        (0.3, 0.328_626_759_459_127_4, 0.671_373_240_540_872_6),
        (0.9, 0.796_908_212_422_832_2, 0.203_091_787_577_167_86),
        (1.2, 0.910_313_978_229_635_3, 0.089_686_021_770_364_64),
        (1.3, 0.934_007_944_940_652_4, 0.065_992_055_059_347_55),
        (2.0, 0.995_322_265_018_952_7, 0.004_677_734_981_047_266),
        (3.5, 0.999_999_256_901_627_6, 7.430_983_723_414_128e-7),
        (6.0, 1.0, 2.151_973_671_249_891_3e-17),
        (15.0, 1.0, 7.212_994_172_451_207e-100),
        (26.0, 1.0, 5.663_192_408_856_143e-296),
    ];

    /// (p, quantile) computed with 60 digits.
    const NORMAL_QUANTILE: [(f64, f64); 12] = [
        (1.0e-300, -37.047_096_299_361_2),
        (1.0e-100, -21.273_453_560_965_326),
        (1.0e-20, -9.262_340_089_798_407),
        (1.0e-10, -6.361_340_902_404_057),
        (1.0e-5, -4.264_890_793_922_825),
        (0.001, -3.090_232_306_167_813_6),
        (0.01, -2.326_347_874_040_841),
        (0.025, -1.959_963_984_540_054_3),
        (0.1, -1.281_551_565_544_600_4),
        (0.3, -0.524_400_512_708_040_8),
        (0.45, -0.125_661_346_855_074_02),
        (0.499, -0.002_506_630_899_571_766),
    ];

    #[test]
    fn error_function_values() {
        for (x, expected, complement) in ERF {
            assert_relative(erf(x), expected, 1e-14, &format!("erf({x})"));
            assert_relative(erfc(x), complement, 5e-13, &format!("erfc({x})"));
            assert_eq!(erf(-x), -erf(x));
        }
        assert!(erf(f64::NAN).is_nan() && erfc(f64::NAN).is_nan());
    }

    #[test]
    fn quantile_values() {
        for (p, expected) in NORMAL_QUANTILE {
            assert_relative(normal_quantile(p), expected, 1e-13, &format!("normal_quantile({p})"));
            assert_relative(normal_cdf(expected), p, 1e-12, &format!("normal_cdf({expected})"));
        }
        assert!(normal_quantile(0.5).abs() < 1e-16);
        assert_eq!((normal_quantile(0.0), normal_quantile(1.0)), (f64::NEG_INFINITY, f64::INFINITY));
        assert!(normal_quantile(-0.1).is_nan());
    }
}
