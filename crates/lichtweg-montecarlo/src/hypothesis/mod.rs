//! Statistical hypothesis tests: how claims of agreement are proven.
//!
//! # Convention
//!
//! Every test returns the p-value of "they agree" ([`Outcome::p_value`]). It fails when p < alpha, with alpha =
//! 0.01 for a family of n tests together, so each single one is held to [`sidak`]`(0.01, n)`. A p-value that is NaN
//! fails. Seeds are fixed, so a test that passes keeps passing until the code under test changes.
//!
//! * sample() against pdf(): [`DensityTest`], 10^6 samples, cells with an expectation below 5 pooled.
//! * two estimates of one number: [`welch_t_test`] (few samples), [`z_test`] (many).
//! * an image against a reference: [`z_test`] for each block and channel at the Sidak level, of which 99.75 % have to
//!   pass, and one for the whole at 3.5 standard errors.
//! * counts of rare events: [`binomial_test`], [`binomial_interval`].

mod binomial;
mod chi_squared;
mod density;
mod means;
mod multiple;
mod partition;
mod quadrature;

pub use binomial::{binomial_cdf, binomial_interval, binomial_survival, binomial_test};
pub use chi_squared::{ChiSquaredError, MIN_EXPECTED, chi_squared_test};
pub use density::{DensityReport, DensityTest, DensityTestError};
pub use means::{welch_t_test, z_test};
pub use multiple::{holm, sidak};

/// What a test found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// The test statistic: chi-squared, t or z.
    pub statistic: f64,
    /// Its degrees of freedom; infinite for a z test.
    pub dof: f64,
    /// Probability of a statistic at least as extreme if the hypothesis holds.
    pub p_value: f64,
}

impl Outcome {
    /// Whether the hypothesis is rejected at significance `alpha`; a NaN p-value rejects.
    #[must_use]
    pub fn rejects(&self, alpha: f64) -> bool {
        self.p_value.is_nan() || self.p_value < alpha
    }
}
