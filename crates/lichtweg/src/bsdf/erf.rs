//! The complementary error function and its inverse in single precision, for slopes of Beckmann surfaces.

use lichtweg_ray::wide::Float;

use crate::lanes::{ln, polynomial};

/// erfc(x) for x >= 0, given `gauss` = exp(-x^2), which callers need anyway.
///
/// Abramowitz and Stegun 1964, formula 7.1.26: absolute error below 1.5e-7 plus rounding.
#[inline(always)]
pub(super) fn erfc<F: Float>(x: F, gauss: F) -> F {
    let splat = F::splat;
    let t = splat(1.0) / (splat(1.0) + splat(0.327_591_1) * x);
    let p = splat(1.421_413_7) + t * (splat(-1.453_152) + t * splat(1.061_405_4));
    t * (splat(0.254_829_6) + t * (splat(-0.284_496_74) + t * p)) * gauss
}

/// The x with erfc(x) = `q`, for q in (0, 2).
///
/// Giles 2010, "Approximating the erfinv function", table 5, of 1 - q: relative error below 1e-6 up to x = 3, 5e-6 at 4. Small q keep
/// their digits here, where 1 - q would lose them.
#[inline(always)]
pub(super) fn inverse_erfc<F: Float>(q: F) -> F {
    const CENTRE: [f32; 9] = [
        1.501_409_4,
        0.246_640_73,
        -0.004_177_681_6,
        -0.001_253_725,
        2.185_808_7e-4,
        -4.391_506_5e-6,
        -3.523_387_8e-6,
        3.432_739_5e-7,
        2.810_226_4e-8,
    ];
    const TAIL: [f32; 9] = [
        2.832_976_8,
        1.001_674,
        0.009_438_871,
        -0.007_622_461,
        0.005_739_508,
        -0.003_673_428_4,
        0.001_349_343_2,
        1.009_505_6e-4,
        -2.002_142_6e-4,
    ];
    let splat = F::splat;
    let w = -ln((q * (splat(2.0) - q)).max(splat(f32::MIN_POSITIVE)));
    let central = w.lt(splat(5.0));
    let t = (w - splat(2.5)).select(central, w.sqrt() - splat(3.0));
    let mut c = [t; 9];
    for (c, (&centre, &tail)) in c.iter_mut().zip(CENTRE.iter().zip(&TAIL)) {
        *c = splat(centre).select(central, splat(tail));
    }
    polynomial(&c, t) * (splat(1.0) - q)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn erfc_matches_tabulated_values() {
        // Abramowitz and Stegun 1964, table 7.1.
        for (x, erf) in
            [(0.0f32, 0.0f32), (0.5, 0.520_499_9), (1.0, 0.842_700_8), (1.6, 0.976_348_4), (2.0, 0.995_322_3)]
        {
            assert!((1.0 - erfc(x, (-x * x).exp()) - erf).abs() < 4e-7, "{x}");
        }
        assert_eq!(erfc(f32::INFINITY, 0.0), 0.0);
    }

    #[test]
    fn inverse_undoes_erfc() {
        // Values of erfc with seven digits, into the tails.
        for (x, q) in [
            (0.1f32, 0.887_537_1f32),
            (1.0, 0.157_299_2),
            (2.0, 4.677_735e-3),
            (3.0, 2.209_05e-5),
            (4.0, 1.541_726e-8),
        ] {
            assert!((inverse_erfc(q) / x - 1.0).abs() < 5e-6, "{x}: {}", inverse_erfc(q));
        }
        assert!((inverse_erfc(2.0f32 - 0.157_299_2) + 1.0).abs() < 1e-6);
        assert_eq!(inverse_erfc(1.0f32), 0.0);
        assert!(inverse_erfc(0.0f32).is_finite() && inverse_erfc(2.0f32).is_finite());
    }
}
