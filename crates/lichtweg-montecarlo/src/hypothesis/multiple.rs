//! Many tests at once: corrections that keep the chance of any false alarm at alpha.

/// Sidak's level for each of `n` independent tests: 1 - (1 - alpha)^(1/n). With `n` = 0 it is `alpha`.
#[must_use]
pub fn sidak(alpha: f64, n: usize) -> f64 {
    -((-alpha).ln_1p() / n.max(1) as f64).exp_m1()
}

/// Holm's step-down procedure (1979): which of the hypotheses are rejected. Holds for dependent tests too and is more
/// powerful than Bonferroni. A NaN p-value is rejected.
#[must_use]
pub fn holm(p_values: &[f64], alpha: f64) -> Vec<bool> {
    let p = |i: usize| if p_values[i].is_nan() { 0.0 } else { p_values[i] };
    let mut order: Vec<usize> = (0..p_values.len()).collect();
    order.sort_by(|&i, &j| p(i).total_cmp(&p(j)));
    let mut rejected = vec![false; p_values.len()];
    for (rank, &i) in order.iter().enumerate() {
        if p(i) > alpha / (p_values.len() - rank) as f64 {
            break;
        }
        rejected[i] = true;
    }
    rejected
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sidak_level() {
        assert_eq!(sidak(0.0, 10), 0.0);
        assert!((sidak(0.01, 1) - 0.01).abs() < 1e-17);
        assert!((1.0 - (1.0 - sidak(0.01, 100)).powi(100) - 0.01).abs() < 1e-12);
        // For tiny levels it approaches Bonferroni without losing digits.
        assert!((sidak(1e-12, 1_000_000) * 1e18 - 1.0).abs() < 1e-9);
    }

    #[test]
    fn holm_textbook_example() {
        // At 0.05: 0.005 <= 0.05/4, 0.01 <= 0.05/3, 0.03 > 0.05/2: stop.
        assert_eq!(holm(&[0.01, 0.04, 0.03, 0.005], 0.05), [true, false, false, true]);
        assert_eq!(holm(&[f64::NAN, 1.0], 0.05), [true, false]);
        assert!(holm(&[], 0.05).is_empty());
    }
}
