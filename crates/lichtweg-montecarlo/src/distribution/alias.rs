//! Alias table: a discrete draw in constant time (Walker 1974; linear-time construction by Vose 1991).
//!
//! Entry i of n owns a bucket of probability 1/n; the part above its threshold belongs to one other entry, its alias.

use super::{Pick, WeightError, below_one, largest_weight};
use crate::moments::CompensatedSum;

/// Draws index i with probability w_i / sum w in O(1).
///
/// ```
/// use lichtweg_montecarlo::distribution::AliasTable;
/// let table = AliasTable::new(&[1.0_f32, 0.0, 3.0]).unwrap();
/// assert_eq!(table.pmf(2), 0.75);
/// assert_ne!(table.sample(0.4).index, 1);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct AliasTable {
    buckets: Vec<Bucket>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Bucket {
    /// Share of the bucket that its own entry keeps, in `[0,1]`.
    threshold: f32,
    alias: u32,
    pmf: f32,
}

impl AliasTable {
    /// From weights (f32 or f64), not necessarily normalised.
    ///
    /// # Errors
    /// No weights, a negative, NaN or infinite one, all zero, or more than 2^32 - 1.
    pub fn new<W: Copy + Into<f64>>(weights: &[W]) -> Result<Self, WeightError> {
        let largest = largest_weight(weights.iter().map(|&w| w.into()))?;
        let count = weights.len();
        if u32::try_from(count).is_err() {
            return Err(WeightError::TooMany);
        }
        // Relative to the largest, the sum of f64 weights cannot overflow.
        let relative = |w: W| w.into() / largest;
        let total: CompensatedSum = weights.iter().map(|&w| relative(w)).collect();
        let mut share: Vec<f64> =
            weights.iter().map(|&w| relative(w) / total.value() * count as f64).collect();
        let mut buckets: Vec<Bucket> = (0..)
            .zip(&share)
            .map(|(i, s)| Bucket { threshold: 1.0, alias: i, pmf: (s / count as f64) as f32 })
            .collect();

        let (mut small, mut large): (Vec<u32>, Vec<u32>) =
            (0..count as u32).partition(|&i| share[i as usize] < 1.0);
        while let (Some(&poor), Some(&rich)) = (small.last(), large.last()) {
            small.pop();
            let (poor, donor) = (poor as usize, rich as usize);
            buckets[poor].threshold = share[poor] as f32;
            buckets[poor].alias = rich;
            share[donor] -= 1.0 - share[poor];
            if share[donor] < 1.0 {
                large.pop();
                small.push(rich);
            }
        }
        // Rounding can leave a bucket unpaired. Its share is one up to rounding, unless its weight is zero: such an
        // entry must not be drawn, so the largest takes the bucket.
        let heaviest = (0..count).max_by(|&i, &j| buckets[i].pmf.total_cmp(&buckets[j].pmf)).unwrap_or(0);
        for i in small {
            if weights[i as usize].into() == 0.0 {
                buckets[i as usize].threshold = 0.0;
                buckets[i as usize].alias = heaviest as u32;
            }
        }
        Ok(Self { buckets })
    }

    /// Draws by a uniform number in [0,1) of 24 bits. With n entries, only 24 - log2 n bits are left to choose
    /// inside a bucket: for more than a few hundred entries use [`AliasTable::sample_f64`].
    #[inline]
    #[must_use]
    pub fn sample(&self, u: f32) -> Pick {
        self.sample_f64(f64::from(u))
    }

    /// Draws by a uniform number in [0,1); numbers outside are clamped.
    #[inline]
    #[must_use]
    pub fn sample_f64(&self, u: f64) -> Pick {
        let position = u.max(0.0) * self.buckets.len() as f64;
        let own = (position as usize).min(self.buckets.len() - 1);
        let bucket = self.buckets[own];
        let fraction = (position - own as f64).min(1.0);
        let threshold = f64::from(bucket.threshold);
        if bucket.threshold >= 1.0 {
            // The whole bucket, as always in tables of equal weights: nothing to rescale.
            Pick { index: own, pmf: bucket.pmf, remapped: below_one(fraction) }
        } else if fraction < threshold {
            Pick { index: own, pmf: bucket.pmf, remapped: below_one(fraction / threshold) }
        } else {
            let index = bucket.alias as usize;
            let remapped = below_one((fraction - threshold) / (1.0 - threshold));
            Pick { index, pmf: self.buckets[index].pmf, remapped }
        }
    }

    /// Probability of index `i`; 0 out of range.
    #[inline]
    #[must_use]
    pub fn pmf(&self, i: usize) -> f32 {
        self.buckets.get(i).map_or(0.0, |bucket| bucket.pmf)
    }

    /// Bucket `i`: the share of it in `[0,1]` that belongs to entry i, and the entry that the rest belongs to. Panics out of range.
    #[must_use]
    pub fn bucket(&self, i: usize) -> (f32, u32) {
        let Bucket { threshold, alias, .. } = self.buckets[i];
        (threshold, alias)
    }

    /// Number of entries; at least one.
    #[must_use]
    #[allow(clippy::len_without_is_empty)] // Never empty by construction.
    pub fn len(&self) -> usize {
        self.buckets.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Probabilities that the buckets realise.
    fn realised(table: &AliasTable) -> Vec<f64> {
        let mut probability = vec![0.0; table.len()];
        for (i, bucket) in table.buckets.iter().enumerate() {
            probability[i] += f64::from(bucket.threshold) / table.len() as f64;
            probability[bucket.alias as usize] += (1.0 - f64::from(bucket.threshold)) / table.len() as f64;
        }
        probability
    }

    #[test]
    fn bad_weights_are_refused() {
        assert_eq!(AliasTable::new::<f32>(&[]), Err(WeightError::Empty));
        assert_eq!(AliasTable::new(&[0.0_f32, 0.0]), Err(WeightError::AllZero));
        assert_eq!(AliasTable::new(&[1.0_f32, -1.0]), Err(WeightError::Negative(1)));
        assert_eq!(AliasTable::new(&[f64::NAN]), Err(WeightError::NotFinite(0)));
        assert_eq!(AliasTable::new(&[1.0, f64::INFINITY]), Err(WeightError::NotFinite(1)));
    }

    #[test]
    fn extreme_scales_do_not_overflow() {
        for scale in [1e308_f64, 5e-324] {
            let table = AliasTable::new(&[scale, scale, 0.0, scale]).unwrap();
            assert!((table.pmf(0) - 1.0 / 3.0).abs() < 1e-7);
            assert_eq!(table.pmf(2), 0.0);
        }
    }

    #[test]
    fn remapped_number_is_uniform() {
        let table = AliasTable::new(&[0.5_f64, 2.0, 0.1, 1.4]).unwrap();
        let n = 100_000;
        let mut sums = [(0.0, 0.0); 4];
        for i in 0..n {
            let pick = table.sample_f64((f64::from(i) + 0.5) / f64::from(n));
            assert!((0.0..1.0).contains(&pick.remapped));
            sums[pick.index].0 += 1.0;
            sums[pick.index].1 += f64::from(pick.remapped);
        }
        for (i, (count, sum)) in sums.iter().enumerate() {
            assert!((count / f64::from(n) - f64::from(table.pmf(i))).abs() < 1e-4);
            assert!((sum / count - 0.5).abs() < 1e-3);
        }
    }

    #[test]
    fn any_number_gives_a_valid_index() {
        let table = AliasTable::new(&[0.0_f32, 1.0, 0.0]).unwrap();
        for u in [-1.0, 0.0, 0.999_999_9, 1.0, 7.0, f32::NAN, f32::INFINITY] {
            let pick = table.sample(u);
            assert_eq!((pick.index, pick.pmf), (1, 1.0));
        }
    }

    proptest! {
        #[test]
        fn buckets_realise_the_weights(
            weights in prop::collection::vec(prop_oneof![Just(0.0_f64), 0.0..1.0, 1e-9..1e-6, 1e3..1e6], 1..300)
        ) {
            let total: f64 = weights.iter().sum();
            prop_assume!(total > 0.0);
            let table = AliasTable::new(&weights).unwrap();
            for (i, probability) in realised(&table).into_iter().enumerate() {
                let expected = weights[i] / total;
                prop_assert!((probability - expected).abs() < 1e-6 * expected + 1e-7 / weights.len() as f64);
                prop_assert!((f64::from(table.pmf(i)) - expected).abs() <= 1e-7 * expected);
                prop_assert!(weights[i] > 0.0 || probability == 0.0);
            }
        }
    }
}
