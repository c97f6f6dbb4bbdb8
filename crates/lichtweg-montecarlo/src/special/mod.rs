//! Special functions behind statistical tests, in f64.
//!
//! Relative error about 1e-12 or better in the bulk and in the tails (each tail has its own function, so that none
//! is one minus something); parameters up to about 10^9. Arguments outside the domain give NaN, never a panic or an
//! endless loop.
//!
//! Sources: Abramowitz and Stegun (A&S); NIST Digital Library of Mathematical Functions (DLMF); Loader, *Fast and
//! accurate computation of binomial probabilities* (2000), for leading factors free of cancellation.

mod beta;
mod gamma;
mod normal;
mod student;

pub use beta::{beta_quantile, regularized_beta};
pub use gamma::{gamma_p, gamma_q, ln_gamma};
pub use normal::{erf, erfc, normal_cdf, normal_quantile};
pub use student::{student_t_cdf, student_t_quantile};

/// Probability that a chi-squared variable of `dof` degrees of freedom exceeds `x` (the p-value of a test).
#[must_use]
pub fn chi_squared_survival(x: f64, dof: f64) -> f64 {
    gamma_q(0.5 * dof, 0.5 * x.max(0.0))
}

/// Probability that a chi-squared variable of `dof` degrees of freedom is at most `x`.
#[must_use]
pub fn chi_squared_cdf(x: f64, dof: f64) -> f64 {
    gamma_p(0.5 * dof, 0.5 * x.max(0.0))
}

/// Terms of a series or fraction at which to give up, for a parameter of size `scale`: convergence takes a small
/// multiple of its square root.
fn term_limit(scale: f64) -> u32 {
    (500.0 + 40.0 * scale.max(0.0).sqrt()).min(4e6) as u32
}

/// Continued fraction b0 + a1/(b1 + a2/(b2 + ...)) by the modified Lentz method (Thompson and Barnett 1986).
/// `term(k)` gives (a_k, b_k) for k = 1, 2, ...
fn continued_fraction(b0: f64, limit: u32, term: impl Fn(f64) -> (f64, f64)) -> f64 {
    let nonzero = |x: f64| if x == 0.0 { 1e-300 } else { x };
    let mut value = nonzero(b0);
    let (mut c, mut d) = (value, 0.0);
    for k in 1..=limit {
        let (a, b) = term(f64::from(k));
        c = nonzero(b + a / c);
        d = 1.0 / nonzero(b + a * d);
        value *= c * d;
        if (c * d - 1.0).abs() < 1e-16 {
            break;
        }
    }
    value
}

/// The root in (0, infinity) of a decreasing function by bracketing and bisection to full precision. Returns the
/// nearest bound when there is no root in the range of f64.
fn decreasing_root(f: impl Fn(f64) -> f64, guess: f64) -> f64 {
    let (mut low, mut high) = (guess, guess);
    while f(low) < 0.0 && low > 1e-300 {
        (low, high) = (low * 0.125, low);
    }
    while f(high) > 0.0 && high < 1e300 {
        (low, high) = (high, high * 8.0);
    }
    // The bracket spans a factor of at most 8: 55 halvings reach the spacing of f64.
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if f(middle) > 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
fn assert_relative(value: f64, expected: f64, tolerance: f64, what: &str) {
    let error = if expected == 0.0 { value.abs() } else { (value / expected - 1.0).abs() };
    assert!(error <= tolerance, "{what}: {value:e}, expected {expected:e}, relative error {error:e}");
}
