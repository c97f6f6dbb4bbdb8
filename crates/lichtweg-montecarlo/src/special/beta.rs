//! Regularised incomplete beta function I_x(a,b).

use super::gamma::{deviance, stirling_error};
use super::{continued_fraction, term_limit};
use std::f64::consts::TAU;

/// I_x(a,b) for a, b > 0 and x in `[0,1]`: the probability that a Beta(a,b) variable is below x.
#[must_use]
pub fn regularized_beta(x: f64, a: f64, b: f64) -> f64 {
    regularized_beta_complement(x, 1.0 - x, a, b)
}

/// I_x(a,b) with y = 1 - x given too, so that either may be tiny without loss.
pub(super) fn regularized_beta_complement(x: f64, y: f64, a: f64, b: f64) -> f64 {
    let in_domain = a > 0.0 && b > 0.0 && a.is_finite() && b.is_finite() && x >= 0.0 && y >= 0.0;
    if !in_domain {
        f64::NAN
    } else if x == 0.0 {
        0.0
    } else if y == 0.0 {
        1.0
    } else if x * (a + b + 2.0) < a + 1.0 {
        lower_tail(x, y, a, b)
    } else {
        // The fraction converges fast below the mean only: use I_x(a,b) = 1 - I_y(b,a).
        1.0 - lower_tail(y, x, b, a)
    }
}

/// I_x(a,b) for x below about the mean, as leading factor over continued fraction: DiDonato and Morris, *Algorithm
/// 708* (1992), equation 9. Unlike the textbook fraction it takes a - (a+b) x as a number of its own, whose digits
/// count where a is large.
fn lower_tail(x: f64, y: f64, a: f64, b: f64) -> f64 {
    // The smaller of x and y has lost no digits.
    let below_mean = if x < y { a - (a + b) * x } else { (a + b) * y - b };
    let denominator = |n: f64| {
        n + n * (b - n) * x / (a + 2.0 * n - 1.0)
            + (a + n) / (a + 2.0 * n + 1.0) * (below_mean + 1.0 + n * (1.0 + y))
    };
    let fraction = continued_fraction(a / (a + 1.0) * (below_mean + 1.0), term_limit(a.max(b)), |n| {
        let middle = x / (a + 2.0 * n - 1.0);
        let numerator = (a + n - 1.0) * (a + b + n - 1.0) * n * (b - n) * middle * middle;
        (numerator, denominator(n))
    });
    leading_factor(x, y, a, b, below_mean) / fraction
}

/// x^a y^b / B(a,b) in Loader's form, given a - (a+b) x: the large logarithms cancel before they are formed.
fn leading_factor(x: f64, y: f64, a: f64, b: f64, below_mean: f64) -> f64 {
    let n = a + b;
    let exponent = stirling_error(n)
        - stirling_error(a)
        - stirling_error(b)
        - deviance(a, n * x, below_mean)
        - deviance(b, n * y, -below_mean);
    // For tiny a or b their product may underflow.
    (a / (n * TAU)).sqrt() * b.sqrt() * exponent.exp()
}

/// The x with I_x(a,b) = p, by bisection; absolute error 1e-16. NaN outside the domain.
#[must_use]
pub fn beta_quantile(p: f64, a: f64, b: f64) -> f64 {
    if !(0.0..=1.0).contains(&p) || regularized_beta(0.5, a, b).is_nan() {
        return f64::NAN;
    }
    let (mut low, mut high) = (0.0, 1.0);
    while high - low > 1e-16 * high {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if regularized_beta(middle, a, b) < p { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::super::assert_relative;
    use super::*;

    /// (x, a, b, I_x(a,b)) computed with 60 digits.
    const BETA: [(f64, f64, f64, f64); 17] = [
        (0.3, 0.5, 0.5, 0.369_010_119_565_545_36),
        (0.999, 0.5, 0.5, 0.979_864_958_366_622_5),
        (1.0e-10, 0.5, 0.5, 6.366_197_723_781_917e-6),
        (0.5, 1.0, 1.0, 0.5),
        (0.1, 2.0, 5.0, 0.114_265),
        (0.9, 2.0, 5.0, 0.999_945),
        (0.5, 10.0, 10.0, 0.5),
        (0.05, 10.0, 10.0, 5.939_339_059_664_382e-9),
        (0.4, 100.0, 150.0, 0.503_435_610_298_540_3),
        (0.3, 100.0, 150.0, 0.000_406_631_808_825_510_4),
        (0.5, 100.0, 150.0, 0.999_259_416_933_435_9),
        (0.999, 5000.0, 0.5, 0.001_561_579_160_289_283_4),
        (0.01, 10_000.0, 1_000_000.0, 0.842_544_606_174_883_2),
        (0.011, 10_000.0, 1_000_000.0, 1.0),
        (0.0095, 10_000.0, 1_000_000.0, 1.872_867_253_672_840_6e-5),
        (0.2, 0.001, 3.0, 0.999_510_374_902_940_7),
        (0.7, 30.0, 0.001, 2.345_353_697_669_141_4e-9),
    ];

    #[test]
    fn incomplete_beta_values() {
        for (x, a, b, expected) in BETA {
            assert_relative(regularized_beta(x, a, b), expected, 5e-13, &format!("I_{x}({a}, {b})"));
        }
    }

    #[test]
    fn edges_and_domain() {
        assert_eq!((regularized_beta(0.0, 2.0, 3.0), regularized_beta(1.0, 2.0, 3.0)), (0.0, 1.0));
        for (x, a, b) in [(-0.1, 1.0, 1.0), (1.1, 1.0, 1.0), (0.5, 0.0, 1.0), (0.5, 1.0, f64::NAN)] {
            assert!(regularized_beta(x, a, b).is_nan());
        }
    }

    #[test]
    fn quantile_inverts() {
        for (a, b) in [(0.5, 0.5), (1.0, 20.0), (300.0, 2.0), (1e5, 1e5)] {
            for p in [1e-10, 0.01, 0.5, 0.99] {
                assert_relative(regularized_beta(beta_quantile(p, a, b), a, b), p, 1e-9, "quantile");
            }
        }
        assert!(beta_quantile(1.5, 1.0, 1.0).is_nan());
    }
}
