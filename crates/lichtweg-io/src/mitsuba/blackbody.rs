//! The luminance of a black body in Mitsuba's units.
//!
//! Planck's law B(lambda, T) = 2 h c^2 / (lambda^5 (exp(h c / (lambda k T)) - 1)) in W / (m^2 sr nm), averaged with the
//! weight of the CIE 1931 luminosity: Y = integral of B y / integral of y, as Mitsuba converts spectra to colours. The
//! weight is the two-lobe fit of Wyman, Sloan and Shirley, "Simple Analytic Approximations to the CIE XYZ Color Matching
//! Functions", JCGT 2(2), 2013, within one percent of the tables.

/// Luminance at `kelvin`, in W / (m^2 sr nm).
pub(super) fn planck_luminance(kelvin: f64) -> f64 {
    let (mut weighted, mut total) = (0.0, 0.0);
    for nanometres in 360..=830 {
        let weight = luminosity(f64::from(nanometres));
        weighted += weight * planck(f64::from(nanometres), kelvin);
        total += weight;
    }
    weighted / total
}

/// Spectral radiance in W / (m^2 sr nm).
fn planck(nanometres: f64, kelvin: f64) -> f64 {
    const C: f64 = 2.997_924_58e8;
    const H: f64 = 6.626_070_15e-34;
    const K: f64 = 1.380_649e-23;
    let metres = nanometres * 1e-9;
    let exponent = H * C / (metres * K * kelvin);
    1e-9 * 2.0 * H * C * C / (metres.powi(5) * exponent.exp_m1())
}

fn luminosity(nanometres: f64) -> f64 {
    let lobe = |height: f64, centre: f64, left: f64, right: f64| {
        let width = if nanometres < centre { left } else { right };
        height * (-0.5 * ((nanometres - centre) / width).powi(2)).exp()
    };
    lobe(0.821, 568.8, 46.9, 40.5) + lobe(0.286, 530.9, 16.3, 31.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn luminosity_has_the_area_of_the_tables() {
        let area: f64 = (360..=830).map(|l| luminosity(f64::from(l))).sum();
        assert!((area / 106.856_895 - 1.0).abs() < 0.005, "{area}");
    }

    #[test]
    fn planck_peaks_where_wien_says_and_sums_to_stefan_boltzmann() {
        let kelvin = 6000.0;
        let peak = (200..2000)
            .max_by(|a, b| planck(f64::from(*a), kelvin).total_cmp(&planck(f64::from(*b), kelvin)));
        assert!((f64::from(peak.unwrap()) - 2.897_771_955e6 / kelvin).abs() < 1.0);
        let total: f64 = (50..100_000).map(|l| planck(f64::from(l), kelvin)).sum();
        let want = 5.670_374_419e-8 * kelvin.powi(4) / std::f64::consts::PI;
        assert!((total / want - 1.0).abs() < 1e-3, "{total} {want}");
        assert!(planck_luminance(1.0) == 0.0 && planck_luminance(1e6).is_finite());
    }
}
