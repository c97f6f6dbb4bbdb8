//! Black bodies: Planck's law, B(lambda, T) = 2 h c^2 / (lambda^5 (exp(h c / (lambda k T)) - 1)).

use super::cie::{Illuminant, tristimulus};

/// Luminance at `kelvin` in W / (m^2 sr nm): the mean of the spectral radiance, weighed by the CIE 1931 luminosity.
pub fn blackbody_luminance(kelvin: f64) -> f64 {
    tristimulus(|nanometres| planck(nanometres, kelvin), Illuminant::Equal)[1]
}

/// Spectral radiance in W / (m^2 sr nm).
pub(super) fn planck(nanometres: f64, kelvin: f64) -> f64 {
    const C: f64 = 2.997_924_58e8;
    const H: f64 = 6.626_070_15e-34;
    const K: f64 = 1.380_649e-23;
    let metres = nanometres * 1e-9;
    let exponent = H * C / (metres * K * kelvin);
    1e-9 * 2.0 * H * C * C / (metres.powi(5) * exponent.exp_m1())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planck_peaks_where_wien_says_and_sums_to_stefan_boltzmann() {
        let kelvin = 6000.0;
        let peak = (200..2000)
            .max_by(|a, b| planck(f64::from(*a), kelvin).total_cmp(&planck(f64::from(*b), kelvin)));
        assert!((f64::from(peak.unwrap()) - 2.897_771_955e6 / kelvin).abs() < 1.0);
        let total: f64 = (50..100_000).map(|l| planck(f64::from(l), kelvin)).sum();
        let want = 5.670_374_419e-8 * kelvin.powi(4) / std::f64::consts::PI;
        assert!((total / want - 1.0).abs() < 1e-3, "{total} {want}");
        assert!(blackbody_luminance(1.0) == 0.0 && blackbody_luminance(1e6).is_finite());
    }
}
