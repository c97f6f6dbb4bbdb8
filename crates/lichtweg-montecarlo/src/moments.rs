//! Running mean and variance, mergeable, and compensated sums.
//!
//! Single pass update by Welford (1962), merge by Chan, Golub and LeVeque (*Updating formulae and a pairwise
//! algorithm for computing sample variances*, 1979); both avoid the cancellation of sum-of-squares formulas.
//! Merging in a fixed order gives bit-identical results.

use crate::special::student_t_quantile;

/// Count, mean and sum of squared deviations of the values pushed so far, in f64.
///
/// ```
/// use lichtweg_montecarlo::Moments;
/// let moments: Moments = [1.0, 2.0, 3.0, 4.0].into_iter().collect();
/// assert_eq!(moments.mean(), 2.5);
/// let (low, high) = moments.confidence_interval(0.95);
/// assert!(low < 0.5 && high > 4.5);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    count: u64,
    mean: f64,
    squared_deviations: f64,
}

impl Moments {
    /// From stored values: `squared_deviations` is the sum of (x - mean)^2.
    #[must_use]
    pub const fn from_parts(count: u64, mean: f64, squared_deviations: f64) -> Self {
        Self { count, mean, squared_deviations }
    }

    /// Adds one value.
    #[inline]
    pub fn push(&mut self, value: f64) {
        self.count += 1;
        let deviation = value - self.mean;
        self.mean += deviation / self.count as f64;
        self.squared_deviations += deviation * (value - self.mean);
    }

    /// Adds all values of `other`, as if they had been pushed here.
    #[inline]
    pub fn merge(&mut self, other: &Self) {
        if other.count == 0 {
            return;
        }
        if self.count == 0 {
            *self = *other;
            return;
        }
        let (n, m) = (self.count as f64, other.count as f64);
        let difference = other.mean - self.mean;
        self.count += other.count;
        self.mean += difference * (m / (n + m));
        self.squared_deviations += other.squared_deviations + difference * difference * (n * m / (n + m));
    }

    /// Number of values.
    #[must_use]
    pub const fn count(&self) -> u64 {
        self.count
    }

    /// Mean of the values; 0 when there are none.
    #[must_use]
    pub const fn mean(&self) -> f64 {
        self.mean
    }

    /// Sum of the squared deviations from the mean.
    #[must_use]
    pub const fn squared_deviations(&self) -> f64 {
        self.squared_deviations
    }

    /// Unbiased sample variance (divisor n - 1); infinite below two values, where nothing is known of it.
    #[must_use]
    pub fn variance(&self) -> f64 {
        if self.count < 2 { f64::INFINITY } else { self.squared_deviations / (self.count - 1) as f64 }
    }

    /// Estimated variance of the mean: variance / n; infinite below two values.
    #[must_use]
    pub fn variance_of_mean(&self) -> f64 {
        if self.count < 2 { f64::INFINITY } else { self.variance() / self.count as f64 }
    }

    /// Estimated standard deviation of the mean.
    #[must_use]
    pub fn standard_error(&self) -> f64 {
        self.variance_of_mean().sqrt()
    }

    /// Two-sided interval that covers the expectation with probability `level` (e.g. 0.95), by Student's t with
    /// n - 1 degrees of freedom. Exact for normal values, asymptotically right otherwise; unbounded below two values
    /// or at a level of 1 or more.
    #[must_use]
    pub fn confidence_interval(&self, level: f64) -> (f64, f64) {
        if self.count < 2 || level >= 1.0 {
            return (f64::NEG_INFINITY, f64::INFINITY);
        }
        // The lower tail keeps full precision for levels near 1.
        let half_width = -student_t_quantile(0.5 * (1.0 - level.max(0.0)), (self.count - 1) as f64)
            * self.standard_error();
        (self.mean - half_width, self.mean + half_width)
    }
}

impl Extend<f64> for Moments {
    fn extend<I: IntoIterator<Item = f64>>(&mut self, values: I) {
        values.into_iter().for_each(|value| self.push(value));
    }
}

impl FromIterator<f64> for Moments {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Self {
        let mut moments = Self::default();
        moments.extend(values);
        moments
    }
}

/// Sum that carries its rounding error along (Neumaier 1974): error about one rounding for any number of terms.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CompensatedSum {
    sum: f64,
    compensation: f64,
}

impl CompensatedSum {
    /// Adds one term.
    #[inline]
    pub fn add(&mut self, term: f64) {
        let sum = self.sum + term;
        // The smaller of the two lost its low digits: recover them.
        self.compensation +=
            if self.sum.abs() >= term.abs() { (self.sum - sum) + term } else { (term - sum) + self.sum };
        self.sum = sum;
    }

    /// The sum.
    #[must_use]
    pub fn value(&self) -> f64 {
        // An overflowed sum has a compensation of NaN.
        if self.sum.is_finite() { self.sum + self.compensation } else { self.sum }
    }
}

impl Extend<f64> for CompensatedSum {
    fn extend<I: IntoIterator<Item = f64>>(&mut self, terms: I) {
        terms.into_iter().for_each(|term| self.add(term));
    }
}

impl FromIterator<f64> for CompensatedSum {
    fn from_iter<I: IntoIterator<Item = f64>>(terms: I) -> Self {
        let mut sum = Self::default();
        sum.extend(terms);
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Sampler, SamplerKind};
    use proptest::prelude::*;

    fn close(a: f64, b: f64, tolerance: f64) -> bool {
        (a - b).abs() <= tolerance * a.abs().max(b.abs()).max(1e-300)
    }

    #[test]
    fn known_values() {
        let moments: Moments = [2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0].into_iter().collect();
        assert_eq!((moments.count(), moments.mean()), (8, 5.0));
        assert!(close(moments.variance(), 32.0 / 7.0, 1e-15));
        // t quantile at 0.975 with 7 degrees of freedom is 2.364624251592785.
        let (low, high) = moments.confidence_interval(0.95);
        assert!(close(high - low, 2.0 * 2.364_624_251_592_785 * (4.0_f64 / 7.0).sqrt(), 1e-12));
    }

    #[test]
    fn large_offset_does_not_cancel() {
        let moments: Moments = (0..1000).map(|i| 1e9 + f64::from(i % 2)).collect();
        assert!(close(moments.variance(), 0.25 * 1000.0 / 999.0, 1e-9));
    }

    #[test]
    fn too_few_values_know_no_error() {
        assert_eq!(Moments::default().mean(), 0.0);
        let one: Moments = [3.0].into_iter().collect();
        assert_eq!(one.variance_of_mean(), f64::INFINITY);
        assert_eq!(one.confidence_interval(0.5), (f64::NEG_INFINITY, f64::INFINITY));
    }

    #[test]
    fn interval_covers_at_its_level() {
        // 4000 means of 8 uniforms: covered count is about Binomial(4000, 0.9), sigma 19; 4.5 sigma.
        let covered = (0..4000)
            .filter(|&stream| {
                let moments: Moments = (0..8)
                    .map(|i| f64::from(Sampler::new(SamplerKind::Independent, 4, stream, i).next_1d()))
                    .collect();
                let (low, high) = moments.confidence_interval(0.9);
                low <= 0.5 && 0.5 <= high
            })
            .count();
        assert!((3515..=3685).contains(&covered), "{covered}");
    }

    #[test]
    fn compensated_sum_recovers_lost_terms() {
        let sum: CompensatedSum = [1.0, 1e100, 1.0, -1e100].into_iter().collect();
        assert_eq!(sum.value(), 2.0);
        let infinite: CompensatedSum = [f64::MAX, f64::MAX].into_iter().collect();
        assert_eq!(infinite.value(), f64::INFINITY);
    }

    proptest! {
        #[test]
        fn merge_equals_push(values in prop::collection::vec(-1e6_f64..1e6, 0..200), cut in 0_usize..200) {
            let cut = cut.min(values.len());
            let mut merged: Moments = values[..cut].iter().copied().collect();
            merged.merge(&values[cut..].iter().copied().collect());
            let pushed: Moments = values.iter().copied().collect();
            prop_assert_eq!(merged.count(), pushed.count());
            prop_assert!((merged.mean() - pushed.mean()).abs() < 1e-8);
            prop_assert!(close(merged.squared_deviations(), pushed.squared_deviations(), 1e-10));
        }
    }
}
