//! Fresnel's equations for unpolarised light at a plane boundary.
//!
//! Dielectrics have a real relative index: the reflectance is the mean over both polarisations,
//! R = (r_s^2 + r_p^2) / 2, and what is not reflected is transmitted. Conductors have a complex index eta + i k and absorb the
//! rest (Moeller, "Optics", 1988, section 2.7). Indices are relative: inside over outside, the normal pointing outside.
//!
//! Limits: real indices for dielectrics, no polarisation, no thin-film interference.

use lichtweg_ray::wide::Float;

use crate::color::Spectra;

/// What happens to light at the boundary of a dielectric.
#[derive(Clone, Copy, Debug)]
pub struct FresnelDielectric {
    /// Reflected fraction of radiant flux; the rest is transmitted.
    pub reflectance: f32,
    /// Cosine between the normal and the transmitted direction, of the opposite sign to the incident one; 0 under
    /// total internal reflection.
    pub cos_theta_t: f32,
    /// Index of the far side over the near side.
    pub eta_it: f32,
    /// Its reciprocal: what refraction scales the tangential components by.
    pub eta_ti: f32,
}

/// The boundary between dielectrics as seen under the (signed) cosine `cos_theta_i`; `eta` is the index on the negative side
/// of the normal over that on the positive side.
#[inline]
pub fn dielectric(cos_theta_i: f32, eta: f32) -> FresnelDielectric {
    let (eta_it, eta_ti) = if cos_theta_i >= 0.0 { (eta, 1.0 / eta) } else { (1.0 / eta, eta) };
    let cos_i = cos_theta_i.abs();
    // Snell: sin_t = eta_ti sin_i. A negative square of the cosine means total internal reflection.
    let cos_t = (1.0 - eta_ti * eta_ti * (1.0 - cos_i * cos_i)).max(0.0).sqrt();
    let reflectance = if eta == 1.0 {
        0.0
    } else if cos_i == 0.0 {
        1.0
    } else {
        let r_s = (cos_i - eta_it * cos_t) / (cos_i + eta_it * cos_t);
        let r_p = (cos_t - eta_it * cos_i) / (cos_t + eta_it * cos_i);
        0.5 * (r_s * r_s + r_p * r_p)
    };
    FresnelDielectric { reflectance, cos_theta_t: -cos_t.copysign(cos_theta_i), eta_it, eta_ti }
}

/// Reflectance of a conductor of index `eta` + i `k`, per lane, seen under the cosine `cos_theta_i` > 0.
#[inline(always)]
pub fn conductor<F: Float>(cos_theta_i: F, eta: Spectra<F>, k: Spectra<F>) -> Spectra<F> {
    let ([a, b, c, d], [p, q, r, s]) = (eta.0, k.0);
    let cos = cos_theta_i;
    Spectra([
        conductor_lane(cos, a, p),
        conductor_lane(cos, b, q),
        conductor_lane(cos, c, r),
        conductor_lane(cos, d, s),
    ])
}

#[inline(always)]
fn conductor_lane<F: Float>(cos_theta_i: F, eta: F, k: F) -> F {
    let (half, two) = (F::splat(0.5), F::splat(2.0));
    let cos2 = cos_theta_i * cos_theta_i;
    let sin2 = F::splat(1.0) - cos2;
    // a + i b is the normal component of the refracted wave vector: (a + i b)^2 = (eta + i k)^2 - sin^2.
    let real = eta * eta - k * k - sin2;
    let imaginary = two * eta * k;
    let a2_plus_b2 = (real * real + imaginary * imaginary).sqrt();
    let a = (half * (a2_plus_b2 + real)).max(F::splat(0.0)).sqrt();
    let twice_a_cos = two * a * cos_theta_i;
    let r_s = quotient(a2_plus_b2 + cos2, twice_a_cos);
    let r_p = r_s * quotient(a2_plus_b2 * cos2 + sin2 * sin2, twice_a_cos * sin2);
    half * (r_s + r_p)
}

/// (p - q) / (p + q), and not NaN where both vanish, as they do for the unphysical index 0.
#[inline(always)]
fn quotient<F: Float>(p: F, q: F) -> F {
    (p - q) / (p + q).max(F::splat(f32::MIN_POSITIVE))
}

/// Mean reflectance of a dielectric boundary under diffuse light that arrives from the side of the normal.
///
/// Published fits, chosen as in Mitsuba 3 where they hold: Egan and Hilgeman 1973 for 1/2 <= eta < 1 (relative error up to
/// 0.6 %), d'Eon and Irving 2011 for eta >= 1 (0.2 % up to 10). The former exceeds one for small eta, so that below 1/2 the
/// reflectance follows from that of the other side: what crosses is the same both ways, per squared index.
pub fn diffuse_reflectance(eta: f32) -> f32 {
    let polynomial = |x: f32, c: &[f32]| c.iter().rev().fold(0.0, |sum, &c| sum * x + c);
    let from_thin_side =
        |eta: f32| polynomial(1.0 / eta, &[0.919_317, -3.4793, 6.753_35, -7.809_89, 4.985_54, -1.368_81]);
    if eta >= 1.0 {
        from_thin_side(eta)
    } else if eta >= 0.5 {
        polynomial(eta, &[0.6681, 0.7099, -1.4399]) + 0.0636 / eta
    } else {
        1.0 - (1.0 - from_thin_side(1.0 / eta)) * eta * eta
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Spectrum;

    /// Integral of 2 R(mu) mu over mu in (0, 1), by the midpoint rule.
    fn integrated_reflectance(eta: f32) -> f32 {
        let n = 100_000;
        let mu = |i: i32| (i as f64 + 0.5) / f64::from(n);
        let sum: f64 =
            (0..n).map(|i| 2.0 * mu(i) * f64::from(dielectric(mu(i) as f32, eta).reflectance)).sum();
        (sum / f64::from(n)) as f32
    }

    #[test]
    fn normal_incidence_has_the_textbook_value() {
        let f = dielectric(1.0, 1.5);
        assert!((f.reflectance - 0.04).abs() < 1e-6);
        assert_eq!((f.cos_theta_t, f.eta_it), (-1.0, 1.5));
        let metal = conductor(1.0, Spectrum::splat(0.2), Spectrum::splat(3.0)).0[0];
        assert!((metal - (0.8f32 * 0.8 + 9.0) / (1.2 * 1.2 + 9.0)).abs() < 1e-6);
    }

    #[test]
    fn brewster_angle_extinguishes_p_polarisation() {
        // At tan = eta only s-polarised light is reflected: R = ((eta^2 - 1) / (eta^2 + 1))^2 / 2.
        let eta = 1.5f32;
        let cos = 1.0 / (1.0 + eta * eta).sqrt();
        let expected = 0.5 * ((eta * eta - 1.0) / (eta * eta + 1.0)).powi(2);
        assert!((dielectric(cos, eta).reflectance - expected).abs() < 1e-6);
    }

    #[test]
    fn both_sides_reflect_alike_and_total_reflection_is_total() {
        for cos in [0.05f32, 0.3, 0.8, 1.0] {
            let outside = dielectric(cos, 1.5);
            let inside = dielectric(outside.cos_theta_t, 1.5);
            assert!((outside.reflectance - inside.reflectance).abs() < 1e-5, "{cos}");
            assert!((inside.cos_theta_t - cos).abs() < 1e-5);
        }
        let f = dielectric(-0.5, 1.5);
        assert_eq!((f.reflectance, f.cos_theta_t), (1.0, 0.0));
        assert_eq!(dielectric(0.3, 1.0).reflectance, 0.0);
    }

    #[test]
    fn a_conductor_without_absorption_is_a_dielectric() {
        for cos in [0.02f32, 0.4, 0.9] {
            let metal = conductor(cos, Spectrum::splat(1.5), Spectrum::ZERO).0[0];
            assert!((metal - dielectric(cos, 1.5).reflectance).abs() < 1e-5);
        }
    }

    #[test]
    fn unphysical_indices_stay_finite() {
        for (eta, k) in [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1e6, 1e6)] {
            for cos in [0.0, 1e-6, 0.5, 1.0] {
                let r = conductor(cos, Spectrum::splat(eta), Spectrum::splat(k));
                assert!(r.is_valid_radiance() && r.max_element() <= 1.0, "eta {eta} k {k} cos {cos}: {r:?}");
            }
        }
    }

    #[test]
    fn diffuse_fits_follow_the_integral() {
        for (eta, tolerance) in [
            (1.0 / 1.5, 2e-3),
            (1.0 / 2.0, 7e-3),
            (0.4, 1e-3),
            (0.2, 1e-3),
            (1.2, 3e-3),
            (1.49, 3e-3),
            (3.0, 3e-3),
        ] {
            let expected = integrated_reflectance(eta);
            assert!((diffuse_reflectance(eta) / expected - 1.0).abs() < tolerance, "eta {eta}: {expected}");
        }
    }
}
