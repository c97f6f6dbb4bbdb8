//! Tests of the difference of two means.

use super::Outcome;
use crate::special::{normal_cdf, student_t_cdf};

/// Welch's two-sided t test (1947) that two estimates have the same expectation, for unequal variances. Each estimate
/// is given as (mean, estimated variance *of the mean*, degrees of freedom of that variance, usually n - 1).
///
/// Degrees of freedom by Welch and Satterthwaite. Two exact estimates (variance zero) agree only if equal.
#[must_use]
pub fn welch_t_test(a: (f64, f64, f64), b: (f64, f64, f64)) -> Outcome {
    let variance = a.1 + b.1;
    // Shares of the variance, so that their squares cannot underflow.
    let (share_a, share_b) = (a.1 / variance, b.1 / variance);
    let dof = if variance > 0.0 {
        1.0 / (share_a * share_a / a.2 + share_b * share_b / b.2)
    } else {
        f64::INFINITY
    };
    two_sided(a.0 - b.0, variance, dof)
}

/// Two-sided z test that a quantity with the given (known or well estimated) variance has expectation zero.
#[must_use]
pub fn z_test(difference: f64, variance: f64) -> Outcome {
    two_sided(difference, variance, f64::INFINITY)
}

fn two_sided(difference: f64, variance: f64, dof: f64) -> Outcome {
    if variance == 0.0 {
        let (statistic, p_value) = if difference == 0.0 { (0.0, 1.0) } else { (f64::INFINITY, 0.0) };
        return Outcome { statistic, dof, p_value };
    }
    let statistic = difference / variance.sqrt();
    let lower = -statistic.abs();
    let tail = if dof == f64::INFINITY { normal_cdf(lower) } else { student_t_cdf(lower, dof) };
    Outcome { statistic, dof, p_value: 2.0 * tail }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Moments, Sampler, SamplerKind};

    #[test]
    fn welch_against_published_example() {
        // Wikipedia, "Welch's t-test", example 1: t = -2.46, dof = 25.0, p = 0.021.
        let a = [27.5, 21.0, 19.0, 23.6, 17.0, 17.9, 16.9, 20.1, 21.9, 22.6, 23.1, 19.6, 19.0, 21.7, 21.4];
        let b = [27.1, 22.0, 20.8, 23.4, 23.4, 23.5, 25.8, 22.0, 24.8, 20.2, 21.9, 22.1, 22.9, 20.5, 24.4];
        let [a, b] = [a, b].map(|values| {
            let moments: Moments = values.into_iter().collect();
            (moments.mean(), moments.variance_of_mean(), (moments.count() - 1) as f64)
        });
        let outcome = welch_t_test(a, b);
        assert!((outcome.statistic + 2.46).abs() < 0.006, "{outcome:?}");
        assert!((outcome.dof - 25.0).abs() < 0.06, "{outcome:?}");
        assert!((outcome.p_value - 0.021).abs() < 0.000_6, "{outcome:?}");
    }

    #[test]
    fn degenerate_input() {
        assert_eq!(z_test(0.0, 0.0).p_value, 1.0);
        assert_eq!(z_test(1e-9, 0.0).p_value, 0.0);
        assert_eq!(welch_t_test((1.0, 0.0, 3.0), (1.0, 0.0, 3.0)).p_value, 1.0);
        for outcome in [z_test(f64::NAN, 1.0), z_test(1.0, f64::NAN), z_test(1.0, -1.0)] {
            assert!(outcome.rejects(1e-9));
        }
        assert!((z_test(1.959_963_984_540_054, 1.0).p_value - 0.05).abs() < 1e-12);
    }

    /// The p-value is uniform under the hypothesis, even for few values of unlike variance.
    #[test]
    fn welch_keeps_its_level() {
        let normal = |stream, i| {
            let [u, v] = Sampler::new(SamplerKind::Independent, 21, stream, i).next_2d().map(f64::from);
            (-2.0 * (1.0 - u).ln()).sqrt() * (std::f64::consts::TAU * v).cos()
        };
        let estimate = |stream, n, scale| {
            let moments: Moments = (0..n).map(|i| scale * normal(stream, i)).collect();
            (moments.mean(), moments.variance_of_mean(), f64::from(n - 1))
        };
        let trials = 20_000;
        let rejected = (0..trials)
            .filter(|t| welch_t_test(estimate(2 * t, 12, 1.0), estimate(2 * t + 1, 20, 3.0)).rejects(0.05))
            .count();
        // Binomial(20000, 0.05): mean 1000, sigma 31; 5 sigma allow for the approximate degrees of freedom.
        assert!((845..=1155).contains(&rejected), "{rejected}");
    }
}
