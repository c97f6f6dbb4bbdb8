//! The maps of [`lichtweg_montecarlo::warp`] for any width; see there. A test holds both to the same bits.

use std::f32::consts::{FRAC_1_PI, FRAC_PI_4, TAU};

use lichtweg_ray::math::Vector;
use lichtweg_ray::wide::{Float, Word};

/// See `warp::uniform_disk`.
#[inline(always)]
pub(crate) fn uniform_disk<F: Float>([u, v]: [F; 2]) -> [F; 2] {
    let splat = F::splat;
    let (a, b) = (splat(2.0) * u - splat(1.0), splat(2.0) * v - splat(1.0));
    let steep = a.abs().le(b.abs());
    let (radius, other) = (b.select(steep, a), a.select(steep, b));
    let zero = splat(0.0);
    let ratio = zero.select(radius.equal(zero), other / radius);
    let (sin, cos) = sin_cos_eighth(ratio);
    [radius * sin.select(steep, cos), radius * cos.select(steep, sin)]
}

#[inline(always)]
fn sin_cos_eighth<F: Float>(r: F) -> (F, F) {
    let splat = F::splat;
    let x = splat(FRAC_PI_4) * r;
    let y = x * x;
    let sin = x
        * (splat(1.0)
            + y * (splat(-1.0 / 6.0)
                + y * (splat(1.0 / 120.0) + y * (splat(-1.0 / 5040.0) + y * splat(1.0 / 362_880.0)))));
    let cos = splat(1.0)
        + y * (splat(-0.5) + y * (splat(1.0 / 24.0) + y * (splat(-1.0 / 720.0) + y * splat(1.0 / 40_320.0))));
    (sin, cos)
}

/// See `warp::sin_cos_turn`.
#[inline(always)]
pub(crate) fn sin_cos_turn<F: Float>(turns: F) -> (F, F) {
    let splat = F::splat;
    let (one, two) = (F::Bits::splat(1), F::Bits::splat(2));
    let quarter = (splat(4.0) * turns + splat(0.5)).truncate();
    let (sin, cos) = sin_cos_eighth(splat(2.0) * (splat(4.0) * turns - quarter.to_float()));
    let odd = (quarter & one).equal(one);
    // Bit 1 is the sign of the sine, that of the next quarter the sign of the cosine.
    let sin_sign = (quarter & two).shl::<30>();
    let cos_sign = ((quarter + one) & two).shl::<30>();
    let (sin, cos) = (cos.select(odd, sin), sin.select(odd, cos));
    ((sin.bits() ^ sin_sign).as_float(), (cos.bits() ^ cos_sign).as_float())
}

/// See `warp::tent`.
#[inline(always)]
pub(crate) fn tent<F: Float>(u: F, radius: f32) -> F {
    let splat = F::splat;
    let (one, two) = (splat(1.0), splat(2.0));
    let lower = u.lt(splat(0.5));
    let root = (two * u.select(lower, one - u)).sqrt();
    splat(radius) * (root - one).select(lower, one - root)
}

/// See `warp::cosine_hemisphere`.
#[inline(always)]
pub(crate) fn cosine_hemisphere<F: Float>(u: [F; 2]) -> Vector<F> {
    let [x, y] = uniform_disk(u);
    Vector::new(x, y, (F::splat(1.0) - x * x - y * y).max(F::splat(0.0)).sqrt())
}

/// See `warp::cosine_hemisphere_pdf`.
#[inline(always)]
pub(crate) fn cosine_hemisphere_pdf<F: Float>(cos_theta: F) -> F {
    cos_theta.max(F::splat(0.0)) * F::splat(FRAC_1_PI)
}

/// See `warp::uniform_cone`.
#[inline(always)]
pub(crate) fn uniform_cone<F: Float>([u, v]: [F; 2], one_minus_cos: F) -> Vector<F> {
    let splat = F::splat;
    let height = u * one_minus_cos;
    let sin_theta = (height * (splat(2.0) - height)).max(splat(0.0)).sqrt();
    let (sin_phi, cos_phi) = sin_cos_turn(v);
    Vector::new(sin_theta * cos_phi, sin_theta * sin_phi, splat(1.0) - height)
}

/// See `warp::uniform_cone_pdf`.
#[inline(always)]
pub(crate) fn uniform_cone_pdf<F: Float>(one_minus_cos: F) -> F {
    F::splat(1.0) / (F::splat(TAU) * one_minus_cos)
}

/// See `warp::one_minus_cos`.
#[inline(always)]
pub(crate) fn one_minus_cos<F: Float>(sin_squared: F) -> F {
    let one = F::splat(1.0);
    sin_squared / (one + (one - sin_squared).max(F::splat(0.0)).sqrt())
}

/// See `warp::uniform_triangle`.
#[inline(always)]
pub(crate) fn uniform_triangle<F: Float>([u, v]: [F; 2]) -> [F; 3] {
    let half = F::splat(0.5);
    let upper = u.lt(v);
    let b0 = (half * u).select(upper, u - half * v);
    let b1 = (v - half * u).select(upper, half * v);
    [b0, b1, (F::splat(1.0) - b0 - b1).max(F::splat(0.0))]
}

#[cfg(test)]
mod tests {
    use lichtweg_montecarlo::warp;

    use super::*;

    #[test]
    fn the_same_bits_as_for_one() {
        let n = 257;
        for i in 0..n * n {
            let u = [(i % n) as f32 / n as f32, (i / n) as f32 / (n - 1) as f32];
            let cone = u[0] * u[1] + 1e-3;
            assert_eq!(uniform_disk(u), warp::uniform_disk(u));
            assert_eq!(sin_cos_turn(u[1]), warp::sin_cos_turn(u[1]));
            assert_eq!(cosine_hemisphere(u).to_array(), warp::cosine_hemisphere(u));
            assert_eq!(cosine_hemisphere_pdf(u[0] - 0.1), warp::cosine_hemisphere_pdf(u[0] - 0.1));
            assert_eq!(uniform_cone(u, cone).to_array(), warp::uniform_cone(u, cone));
            assert_eq!(uniform_cone_pdf(cone), warp::uniform_cone_pdf(cone));
            assert_eq!(one_minus_cos(u[1]), warp::one_minus_cos(u[1]));
            assert_eq!(uniform_triangle(u), warp::uniform_triangle(u));
            assert_eq!(tent(u[0], cone), warp::tent(u[0], cone));
        }
    }
}
