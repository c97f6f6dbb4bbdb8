//! Exponential, logarithm and arc tangent in single precision, and polynomials.
//!
//! All reduce their argument to a short interval and take a polynomial there, with the coefficients of the Cephes library
//! (Moshier 1989, `expf`, `logf` and `atanf`): relative error below 2e-7 (the logarithm's relative to one near 1), of angles below 3e-7.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, LOG2_E, PI, SQRT_2};

use lichtweg_ray::wide::{Float, Word};

/// ln 2 in two parts: multiples of the first by small integers are exact.
const LN_2: [f32; 2] = [0.693_359_4, -2.121_944_4e-4];

/// e^x; x is held within -87.3 and 88, so that neither end leaves the normal numbers. That of NaN is the least.
#[inline(always)]
pub(crate) fn exp<F: Float>(x: F) -> F {
    let splat = F::splat;
    // Adding it leaves the nearest integer, and the bias of an exponent, in the lowest bits.
    const SHIFT: f32 = 12_582_912.0 + 127.0;
    let x = x.max(splat(-87.3)).min(splat(88.0));
    let shifted = x * splat(LOG2_E) + splat(SHIFT);
    let n = shifted - splat(SHIFT);
    let power_of_two = shifted.bits().shl::<23>().as_float();
    let r = x - n * splat(LN_2[0]) - n * splat(LN_2[1]);
    let r2 = r * r;
    let high = splat(4.166_579_6e-2)
        + r * (splat(8.333_452e-3) + r * (splat(1.398_2e-3) + r * splat(1.987_569_1e-4)));
    let low = splat(0.5) + r * splat(0.166_666_65);
    (r2 * (low + r2 * high) + r + splat(1.0)) * power_of_two
}

/// The natural logarithm of a positive normal number.
#[inline(always)]
pub(crate) fn ln<F: Float>(x: F) -> F {
    const C: [f32; 9] = [
        0.333_333_3,
        -2.499_999_4e-1,
        2.000_071_5e-1,
        -1.666_805_8e-1,
        1.424_932_3e-1,
        -1.242_014_1e-1,
        1.167_699_9e-1,
        -1.151_461e-1,
        7.037_683_6e-2,
    ];
    let (splat, word) = (F::splat, F::Bits::splat);
    let one = splat(1.0);
    let bits = x.bits();
    let mantissa = (bits & word(0x007f_ffff) | word(0x3f80_0000)).as_float();
    let exponent = bits.shr::<23>().to_float() - splat(127.0);
    // Near one from both sides, where the result is small, the exponent is zero.
    let large = splat(SQRT_2).lt(mantissa);
    let e = (exponent + one).select(large, exponent);
    let r = (mantissa * splat(0.5)).select(large, mantissa) - one;
    let r2 = r * r;
    let mut c = [r; 9];
    for (c, &constant) in c.iter_mut().zip(&C) {
        *c = splat(constant);
    }
    let tail = r * r2 * polynomial(&c, r) + e * splat(LN_2[1]) - splat(0.5) * r2;
    r + tail + e * splat(LN_2[0])
}

/// The angle of (x, y) from the x axis, in [-pi, pi]; 0 or pi, with y's sign, where y is zero. See [`f32::atan2`].
#[inline(always)]
pub(crate) fn atan2<F: Float>(y: F, x: F) -> F {
    let splat = F::splat;
    let (across, along) = (y.abs(), x.abs());
    let steep = along.lt(across);
    let (low, high) = (along.min(across), along.max(across));
    // Beyond an eighth of pi it is counted from a quarter.
    let wide = (high * splat(SQRT_2 - 1.0)).lt(low);
    let t = (low - high).select(wide, low) / (low + high).select(wide, high).max(splat(f32::MIN_POSITIVE));
    let z = t * t;
    let tail = splat(-3.333_295e-1)
        + z * (splat(1.997_771e-1) + z * (splat(-1.387_768_6e-1) + z * splat(8.053_745e-2)));
    let angle = t + t * z * tail;
    let angle = (angle + splat(FRAC_PI_4)).select(wide, angle);
    let angle = (splat(FRAC_PI_2) - angle).select(steep, angle);
    let angle = (splat(PI) - angle).select(x.lt(splat(0.0)), angle);
    angle.copysign(y)
}

/// Sum of c_i t^i by Estrin's scheme: Horner's would be one long chain of dependent operations.
#[inline(always)]
pub(crate) fn polynomial<F: Float>(c: &[F; 9], t: F) -> F {
    let t2 = t * t;
    let t4 = t2 * t2;
    let [c01, c23, c45, c67] = [c[0] + c[1] * t, c[2] + c[3] * t, c[4] + c[5] * t, c[6] + c[7] * t];
    (c01 + c23 * t2) + (c45 + c67 * t2 + c[8] * t4) * t4
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_are_right_over_their_range() {
        let worst = |f: fn(f32) -> f32, exact: fn(f64) -> f64, x: &dyn Fn(f32) -> f32, least: f64| {
            (0..200_000).map(|i| x(i as f32 / 200_000.0)).fold(0.0f64, |worst, x| {
                let exact = exact(f64::from(x));
                worst.max((f64::from(f(x)) - exact).abs() / exact.abs().max(least))
            })
        };
        assert!(worst(exp, f64::exp, &|u| 175.0 * u - 87.2, 0.0) < 2e-7);
        assert!(worst(ln, f64::ln, &|u| f32::exp(174.0 * u - 87.0), 1.0) < 2e-7);
        assert!(worst(ln, f64::ln, &|u| 0.5 + 1.5 * u, 1.0) < 1e-7);
    }

    #[test]
    fn arc_tangents_are_right_all_around() {
        for i in 0..200_000 {
            let (y, x) = (f64::from(i) * (std::f64::consts::TAU / 200_000.0)).sin_cos();
            let (y, x) = (1e3 * y as f32, 1e3 * x as f32);
            let exact = f64::from(y).atan2(f64::from(x));
            assert!((f64::from(atan2(y, x)) - exact).abs() <= 3e-7 * exact.abs(), "{y} {x}");
        }
        let axes = [
            (0.0, 1.0, 0.0),
            (1.0, 0.0, FRAC_PI_2),
            (0.0, -1.0, PI),
            (-1.0, 0.0, -FRAC_PI_2),
            (0.0, 0.0, 0.0),
        ];
        assert!(axes.iter().all(|&(y, x, angle)| atan2(y, x) == angle));
    }

    #[test]
    fn ends_are_finite() {
        assert_eq!((exp(0.0f32), ln(1.0f32)), (1.0, 0.0));
        assert!(
            exp(f32::NEG_INFINITY) < 2e-38 && exp(f32::INFINITY) > 1e38 && exp(f32::INFINITY).is_finite()
        );
        assert!((ln(f32::MIN_POSITIVE) + 87.336_54).abs() < 1e-4);
    }
}
