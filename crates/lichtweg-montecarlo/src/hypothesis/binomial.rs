//! Binomial counts: tails by the incomplete beta function (A&S 26.5.24), the exact test, Clopper-Pearson bounds.

use crate::special::{beta_quantile, regularized_beta};

/// Probability of `successes` or more in `trials` at probability `p` each.
#[must_use]
pub fn binomial_survival(successes: u64, trials: u64, p: f64) -> f64 {
    if successes == 0 {
        1.0
    } else if successes > trials {
        0.0
    } else {
        regularized_beta(p, successes as f64, (trials - successes) as f64 + 1.0)
    }
}

/// Probability of `successes` or fewer in `trials` at probability `p` each.
#[must_use]
pub fn binomial_cdf(successes: u64, trials: u64, p: f64) -> f64 {
    if successes >= trials {
        1.0
    } else {
        regularized_beta(1.0 - p, (trials - successes) as f64, successes as f64 + 1.0)
    }
}

/// Two-sided p-value that the success probability is `p`: twice the smaller tail, at most 1.
#[must_use]
pub fn binomial_test(successes: u64, trials: u64, p: f64) -> f64 {
    let (upper, lower) = (binomial_survival(successes, trials, p), binomial_cdf(successes, trials, p));
    if upper.is_nan() || lower.is_nan() { f64::NAN } else { (2.0 * upper.min(lower)).min(1.0) }
}

/// Interval that covers the success probability with probability at least `level` (Clopper and Pearson 1934).
#[must_use]
pub fn binomial_interval(successes: u64, trials: u64, level: f64) -> (f64, f64) {
    let tail = 0.5 * (1.0 - level);
    let successes = successes.min(trials);
    let (s, f) = (successes as f64, (trials - successes) as f64);
    let low = if successes == 0 { 0.0 } else { beta_quantile(tail, s, f + 1.0) };
    let high = if successes == trials { 1.0 } else { beta_quantile(1.0 - tail, s + 1.0, f) };
    (low, high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails_by_summation() {
        // n = 6, p = 1/3: probabilities 64, 192, 240, 160, 60, 12, 1 over 729.
        let weights = [64.0, 192.0, 240.0, 160.0, 60.0, 12.0, 1.0];
        for k in 0..=6_u64 {
            let upper: f64 = weights[k as usize..].iter().sum::<f64>() / 729.0;
            let lower: f64 = weights[..=k as usize].iter().sum::<f64>() / 729.0;
            assert!((binomial_survival(k, 6, 1.0 / 3.0) - upper).abs() < 1e-13);
            assert!((binomial_cdf(k, 6, 1.0 / 3.0) - lower).abs() < 1e-13);
        }
        assert_eq!((binomial_survival(7, 6, 0.5), binomial_cdf(9, 6, 0.5)), (0.0, 1.0));
    }

    #[test]
    fn interval_of_no_success_is_the_rule_of_three() {
        let (low, high) = binomial_interval(0, 1000, 0.9);
        assert_eq!(low, 0.0);
        assert!((high - (1.0 - 0.05_f64.powf(1e-3))).abs() < 1e-12);
        let (low, high) = binomial_interval(30, 100, 0.95);
        // Published: 0.2124, 0.3998.
        assert!((low - 0.2124).abs() < 5e-5 && (high - 0.3998).abs() < 5e-5, "{low} {high}");
    }

    #[test]
    fn test_is_two_sided() {
        assert!(binomial_test(500, 1000, 0.5) > 0.97);
        assert!(binomial_test(600, 1000, 0.5) < 1e-8 && binomial_test(400, 1000, 0.5) < 1e-8);
        assert!(binomial_test(1, 2, f64::NAN).is_nan());
    }
}
