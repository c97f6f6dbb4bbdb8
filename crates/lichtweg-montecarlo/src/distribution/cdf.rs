//! Cumulative distribution in 32-bit fixed point, and the discrete distribution by binary search in it.
//!
//! Probabilities are whole multiples of q = 1 / (2^32 - 1), and the density reported is the quantised one: sampling
//! and density agree exactly. Every positive weight gets at least one quantum (so nothing that contributes is lost,
//! as happens to small entries in an f32 table), every zero weight none.

use super::{Pick, WeightError, below_one, largest_weight};

/// The whole probability, in quanta.
const WHOLE: u32 = u32::MAX;

/// Writes the cumulative quanta *before* each entry. Weights must be checked, with a positive sum, and fewer than
/// 2^31; `weight(i)` must give the same value each time.
pub(super) fn fill_cdf(cdf: &mut [u32], scale: f64, weight: impl Fn(usize) -> f64) {
    let relative = |i: usize| weight(i) / scale;
    let mut total = 0.0;
    let mut positive = 0_u32;
    for i in 0..cdf.len() {
        total += relative(i);
        positive += u32::from(weight(i) > 0.0);
    }
    // One quantum each for the positive entries, the rest in proportion.
    let shared = f64::from(WHOLE - positive);
    let (mut sum, mut seen) = (0.0_f64, 0_u32);
    for (i, entry) in cdf.iter_mut().enumerate() {
        // The second sum runs in the same order, so after the last positive entry it equals the total exactly.
        *entry = (sum / total * shared) as u32 + seen;
        sum += relative(i);
        seen += u32::from(weight(i) > 0.0);
    }
}

/// Quanta of entry `i`.
#[inline]
pub(super) fn quanta(cdf: &[u32], i: usize) -> u32 {
    cdf.get(i + 1).copied().unwrap_or(WHOLE) - cdf[i]
}

/// Probability of entry `i`.
#[inline]
pub(super) fn probability(cdf: &[u32], i: usize) -> f64 {
    f64::from(quanta(cdf, i)) / f64::from(WHOLE)
}

/// Entry that holds the fraction `u` in [0,1) (clamped) of the whole, and the position inside it, in [0,1).
#[inline]
pub(super) fn locate(cdf: &[u32], u: f64) -> (usize, f64) {
    let position = u.clamp(0.0, 1.0 - f64::EPSILON / 2.0).max(0.0) * f64::from(WHOLE);
    let entry = entry_of(cdf, (position as u32).min(WHOLE - 1));
    (entry, (position - f64::from(cdf[entry])) / f64::from(quanta(cdf, entry)))
}

/// Entry that holds a quantum. Of entries with equal cumulative values all but the last are empty; empty ones at the
/// very end start at the whole.
#[inline]
fn entry_of(cdf: &[u32], quantum: u32) -> usize {
    cdf.partition_point(|&before| before <= quantum) - 1
}

/// As [`locate`], searching only between the entries that `guide` names (Chen and Asau 1974): two or three cache
/// misses in a table too large for the cache, where bisection has one a step.
#[inline]
pub(super) fn locate_guided(cdf: &[u32], guide: &[u32], u: f64) -> (usize, f64) {
    let position = u.clamp(0.0, 1.0 - f64::EPSILON / 2.0).max(0.0) * f64::from(WHOLE);
    let quantum = (position as u32).min(WHOLE - 1);
    let slot = ((u64::from(quantum) * guide.len() as u64) >> 32) as usize;
    let first = guide[slot] as usize;
    let last = guide.get(slot + 1).map_or(cdf.len() - 1, |&entry| entry as usize);
    let entry = first + entry_of(&cdf[first..=last], quantum);
    (entry, (position - f64::from(cdf[entry])) / f64::from(quanta(cdf, entry)))
}

/// Writes the entry that holds the first quantum of each of `guide.len()` equal slots of the whole.
pub(super) fn fill_guide(guide: &mut [u32], cdf: &[u32]) {
    let slots = guide.len() as u64;
    for (slot, entry) in (0_u64..).zip(guide.iter_mut()) {
        let first_quantum = (slot << 32).div_ceil(slots) as u32;
        *entry = entry_of(cdf, first_quantum) as u32;
    }
}

/// Draws index i with probability w_i / sum w by binary search. The index grows with u, so stratified numbers give
/// stratified picks (which an alias table does not).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Discrete {
    cdf: Vec<u32>,
}

impl Discrete {
    /// From weights (f32 or f64), not necessarily normalised.
    ///
    /// # Errors
    /// No weights, a negative, NaN or infinite one, all zero, or 2^31 and more.
    pub fn new<W: Copy + Into<f64>>(weights: &[W]) -> Result<Self, WeightError> {
        let largest = largest_weight(weights.iter().map(|&w| w.into()))?;
        if weights.len() >= 1 << 31 {
            return Err(WeightError::TooMany);
        }
        let mut cdf = vec![0; weights.len()];
        fill_cdf(&mut cdf, largest, |i| weights[i].into());
        Ok(Self { cdf })
    }

    /// Draws by a uniform number in [0,1); see [`Discrete::sample_f64`] where entries are rarer than 2^-24.
    #[inline]
    #[must_use]
    pub fn sample(&self, u: f32) -> Pick {
        self.sample_f64(f64::from(u))
    }

    /// Draws by a uniform number in [0,1); numbers outside are clamped.
    #[inline]
    #[must_use]
    pub fn sample_f64(&self, u: f64) -> Pick {
        let (index, fraction) = locate(&self.cdf, u);
        Pick { index, pmf: self.pmf(index), remapped: below_one(fraction) }
    }

    /// Probability of index `i`; 0 out of range.
    #[inline]
    #[must_use]
    pub fn pmf(&self, i: usize) -> f32 {
        if i < self.cdf.len() { probability(&self.cdf, i) as f32 } else { 0.0 }
    }

    /// Number of entries; at least one.
    #[must_use]
    #[allow(clippy::len_without_is_empty)] // Never empty by construction.
    pub fn len(&self) -> usize {
        self.cdf.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn bad_weights_are_refused() {
        assert_eq!(Discrete::new::<f32>(&[]), Err(WeightError::Empty));
        assert_eq!(Discrete::new(&[0.0_f64]), Err(WeightError::AllZero));
        assert_eq!(Discrete::new(&[2.0_f32, f32::NAN]), Err(WeightError::NotFinite(1)));
    }

    #[test]
    fn tiny_weights_keep_a_quantum_and_zero_weights_none() {
        let table = Discrete::new(&[0.0, 1e-30, 1.0, 0.0, 1e-30, 0.0]).unwrap();
        let counts: Vec<u32> = (0..6).map(|i| quanta(&table.cdf, i)).collect();
        assert_eq!(counts, [0, 1, WHOLE - 2, 0, 1, 0]);
        assert_eq!(table.sample_f64(0.0).index, 1);
        assert_eq!(table.sample_f64(1.0).index, 4);
        assert_eq!(table.sample_f64(f64::NAN).index, 1);
    }

    proptest! {
        #[test]
        fn picks_agree_with_the_weights(
            weights in prop::collection::vec(prop_oneof![Just(0.0_f32), 0.0_f32..1.0, 1e3_f32..1e6], 1..300),
            u in 0.0_f64..1.0,
        ) {
            let total: f64 = weights.iter().map(|&w| f64::from(w)).sum();
            prop_assume!(total > 0.0);
            let table = Discrete::new(&weights).unwrap();
            let pick = table.sample_f64(u);
            prop_assert!(weights[pick.index] > 0.0);
            prop_assert_eq!(pick.pmf, table.pmf(pick.index));
            for slots in [1, 7, 300] {
                let mut guide = vec![0; slots];
                fill_guide(&mut guide, &table.cdf);
                prop_assert_eq!(locate_guided(&table.cdf, &guide, u), locate(&table.cdf, u));
            }
            let before: f64 = (0..pick.index).map(|i| probability(&table.cdf, i)).sum();
            let reached = before + probability(&table.cdf, pick.index) * f64::from(pick.remapped);
            prop_assert!((reached - u).abs() < 1e-6);
            let sum: u64 = (0..weights.len()).map(|i| u64::from(quanta(&table.cdf, i))).sum();
            prop_assert_eq!(sum, u64::from(WHOLE));
            for (i, &w) in weights.iter().enumerate() {
                prop_assert!((probability(&table.cdf, i) - f64::from(w) / total).abs() < 1e-7);
            }
        }
    }
}
