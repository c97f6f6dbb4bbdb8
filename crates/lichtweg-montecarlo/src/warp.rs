//! Maps from the unit square to the shapes that light transport samples, with their densities.
//!
//! All are area-preserving up to the density stated, so stratified points stay stratified. Directions have z as
//! their axis; the caller turns them into its own frame. Sources: Shirley and Chiu, *A low distortion map between
//! disk and square* (1997); Heitz, *A low-distortion map between triangle and square* (2019); Malley's method for
//! the cosine hemisphere (Pharr, Jakob, Humphreys, *Physically based rendering*, appendix A.5).

use std::f32::consts::{FRAC_1_PI, FRAC_PI_4, TAU};

/// Point of the unit disk about the origin, by the concentric map. Density per area [`UNIFORM_DISK_PDF`].
#[inline]
#[must_use]
pub fn uniform_disk([u, v]: [f32; 2]) -> [f32; 2] {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    // Each of four triangles of the square becomes a wedge of the disk: radius from the longer coordinate.
    let steep = b.abs() >= a.abs();
    let (radius, other) = if steep { (b, a) } else { (a, b) };
    let ratio = if radius == 0.0 { 0.0 } else { other / radius };
    let (sin, cos) = sin_cos_eighth(ratio);
    if steep { [radius * sin, radius * cos] } else { [radius * cos, radius * sin] }
}

/// Sine and cosine of r times an eighth of a turn, |r| <= 1, by Taylor's series: right to 3e-8, without a call.
#[inline(always)]
fn sin_cos_eighth(r: f32) -> (f32, f32) {
    let x = FRAC_PI_4 * r;
    let y = x * x;
    let sin = x * (1.0 + y * (-1.0 / 6.0 + y * (1.0 / 120.0 + y * (-1.0 / 5040.0 + y * (1.0 / 362_880.0)))));
    let cos = 1.0 + y * (-0.5 + y * (1.0 / 24.0 + y * (-1.0 / 720.0 + y * (1.0 / 40_320.0))));
    (sin, cos)
}

/// Sine and cosine of `turns` full turns, for `turns` in [0, 1].
#[inline]
#[must_use]
pub fn sin_cos_turn(turns: f32) -> (f32, f32) {
    // The nearest quarter turn, and the rest in eighths.
    let quarter = (4.0 * turns + 0.5) as i32;
    let (sin, cos) = sin_cos_eighth(2.0 * (4.0 * turns - quarter as f32));
    match quarter & 3 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// Density per area of [`uniform_disk`].
pub const UNIFORM_DISK_PDF: f32 = FRAC_1_PI;

/// Direction about +z with density cos(theta)/pi. On the rim (u or v exactly 0) z may be 0, where the density is 0.
#[inline]
#[must_use]
pub fn cosine_hemisphere(u: [f32; 2]) -> [f32; 3] {
    let [x, y] = uniform_disk(u);
    [x, y, (1.0 - x * x - y * y).max(0.0).sqrt()]
}

/// Density per solid angle of [`cosine_hemisphere`] at a direction with the given z; 0 below the horizon.
#[inline]
#[must_use]
pub fn cosine_hemisphere_pdf(cos_theta: f32) -> f32 {
    cos_theta.max(0.0) * FRAC_1_PI
}

/// Direction of the upper hemisphere. Density per solid angle [`UNIFORM_HEMISPHERE_PDF`].
#[inline]
#[must_use]
pub fn uniform_hemisphere(u: [f32; 2]) -> [f32; 3] {
    uniform_cone(u, 1.0)
}

/// Density per solid angle of [`uniform_hemisphere`], for z >= 0.
pub const UNIFORM_HEMISPHERE_PDF: f32 = 0.5 * FRAC_1_PI;

/// Direction of the whole sphere. Density per solid angle [`UNIFORM_SPHERE_PDF`].
#[inline]
#[must_use]
pub fn uniform_sphere(u: [f32; 2]) -> [f32; 3] {
    uniform_cone(u, 2.0)
}

/// Density per solid angle of [`uniform_sphere`].
pub const UNIFORM_SPHERE_PDF: f32 = 0.25 * FRAC_1_PI;

/// Direction of the cone about +z whose half-angle t is given as 1 - cos t, in (0, 2]; see [`one_minus_cos`].
///
/// Giving the cosine itself would lose cones narrower than about 0.02 degrees to rounding.
/// Density [`uniform_cone_pdf`].
#[inline]
#[must_use]
pub fn uniform_cone([u, v]: [f32; 2], one_minus_cos: f32) -> [f32; 3] {
    let height = u * one_minus_cos;
    let sin_theta = (height * (2.0 - height)).max(0.0).sqrt();
    let (sin_phi, cos_phi) = sin_cos_turn(v);
    [sin_theta * cos_phi, sin_theta * sin_phi, 1.0 - height]
}

/// Density per solid angle of [`uniform_cone`] inside the cone: 1 / (2 pi (1 - cos t)).
#[inline]
#[must_use]
pub fn uniform_cone_pdf(one_minus_cos: f32) -> f32 {
    1.0 / (TAU * one_minus_cos)
}

/// 1 - cos t of an angle t in [0, pi/2] given the square of its sine, without cancellation for small angles. A
/// sphere of radius r seen from distance d has `sin_squared` = (r/d)^2.
#[inline]
#[must_use]
pub fn one_minus_cos(sin_squared: f32) -> f32 {
    sin_squared / (1.0 + (1.0 - sin_squared).max(0.0).sqrt())
}

/// Barycentric coordinates, uniform over a triangle: density 1 / area. They are never negative and sum to 1.
#[inline]
#[must_use]
pub fn uniform_triangle([u, v]: [f32; 2]) -> [f32; 3] {
    // Folds the square onto the triangle along its diagonal: less distortion than the square-root map.
    let [b0, b1] = if v > u { [0.5 * u, v - 0.5 * u] } else { [u - 0.5 * v, 0.5 * v] };
    [b0, b1, (1.0 - b0 - b1).max(0.0)]
}

/// Coordinate in `[-radius, radius]` with the tent density of [`tent_pdf`].
#[inline]
#[must_use]
pub fn tent(u: f32, radius: f32) -> f32 {
    if u < 0.5 { radius * ((2.0 * u).sqrt() - 1.0) } else { radius * (1.0 - (2.0 * (1.0 - u)).sqrt()) }
}

/// Density per length of [`tent`]: (radius - |x|) / radius^2, 0 outside.
#[inline]
#[must_use]
pub fn tent_pdf(x: f32, radius: f32) -> f32 {
    (radius - x.abs()).max(0.0) / (radius * radius)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_right() {
        for i in 0..=1000 {
            let turns = i as f32 / 1000.0;
            let (sin, cos) = sin_cos_turn(turns);
            let (want_sin, want_cos) = (std::f64::consts::TAU * f64::from(turns)).sin_cos();
            assert!(
                (f64::from(sin) - want_sin).abs() < 3e-7 && (f64::from(cos) - want_cos).abs() < 3e-7,
                "{turns}"
            );
        }
    }

    fn length(d: [f32; 3]) -> f32 {
        (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt()
    }

    /// Corners, edges and centre of the unit square.
    fn extreme_points() -> impl Iterator<Item = [f32; 2]> {
        let values = [0.0, f32::MIN_POSITIVE, 0.25, 0.5, 0.75, 1.0 - f32::EPSILON / 2.0];
        values.into_iter().flat_map(move |u| values.map(|v| [u, v]))
    }

    #[test]
    fn extreme_points_stay_on_their_shape() {
        for u in extreme_points() {
            let [x, y] = uniform_disk(u);
            assert!(x * x + y * y <= 1.0 + 2.0 * f32::EPSILON, "{u:?}");
            for direction in [cosine_hemisphere(u), uniform_hemisphere(u), uniform_sphere(u)] {
                assert!((length(direction) - 1.0).abs() < 1e-6, "{u:?} {direction:?}");
            }
            assert!(cosine_hemisphere(u)[2] >= 0.0 && uniform_hemisphere(u)[2] >= 0.0);
            let barycentric = uniform_triangle(u);
            assert!(barycentric.iter().all(|b| (0.0..=1.0).contains(b)), "{u:?} {barycentric:?}");
            assert!((barycentric.iter().sum::<f32>() - 1.0).abs() < 1e-6);
            assert!(tent(u[0], 2.0).abs() <= 2.0);
        }
    }

    #[test]
    fn tiny_cones_keep_their_width() {
        for angle in [1e-2_f32, 1e-4, 1e-6, 1e-10] {
            let height = one_minus_cos(angle.sin().powi(2));
            assert!((height / (0.5 * angle * angle) - 1.0).abs() < 1e-4, "{angle}");
            let rim = uniform_cone([1.0 - f32::EPSILON / 2.0, 0.0], height);
            assert!((rim[0] / angle - 1.0).abs() < 1e-4, "{angle} {rim:?}");
            assert!((uniform_cone_pdf(height) * TAU * height - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn tent_inverts_its_distribution_function() {
        for i in 0..=100 {
            let u = i as f32 / 100.0;
            let x = tent(u, 1.0);
            let cdf = if x < 0.0 { 0.5 * (1.0 + x) * (1.0 + x) } else { 1.0 - 0.5 * (1.0 - x) * (1.0 - x) };
            assert!((cdf - u).abs() < 1e-6);
        }
        assert_eq!((tent_pdf(0.0, 2.0), tent_pdf(1.0, 2.0), tent_pdf(3.0, 2.0)), (0.5, 0.25, 0.0));
    }
}
