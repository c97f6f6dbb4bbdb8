//! An alias table of few entries, for one number or for sixteen.
//!
//! Places in it are whole numbers of 24 bits, like the uniform numbers themselves: nothing is rounded but what is left of them.

use lichtweg_montecarlo::distribution::AliasTable;
use lichtweg_ray::wide::{Float, FloatLanes, Wide, Word, WordLanes};

use crate::lanes::BELOW_ONE;

/// See [`AliasTable`].
#[derive(Debug)]
pub(super) struct FewTable {
    thresholds: Vec<f32>,
    aliases: Vec<u32>,
}

/// Where a number falls: the bucket, and the fraction of it.
#[derive(Clone, Copy)]
struct Place<F: Float> {
    bucket: F::Bits,
    fraction: F,
}

impl<F: Float> Place<F> {
    #[inline(always)]
    fn new(u: F, buckets: u32) -> Self {
        const UNITS: f32 = (1 << 24) as f32;
        let u = u.max(F::splat(0.0)).min(F::splat(BELOW_ONE));
        let position = (u * F::splat(UNITS)).truncate() * F::Bits::splat(buckets);
        let fraction = (position & F::Bits::splat((1 << 24) - 1)).to_float() * F::splat(1.0 / UNITS);
        Self { bucket: position.shr::<24>(), fraction }
    }

    /// The entry, and what is left of the number.
    #[inline(always)]
    fn entry(self, threshold: F, alias: F::Bits) -> (F::Bits, F) {
        let (zero, one) = (F::splat(0.0), F::splat(1.0));
        let own = self.fraction.lt(threshold);
        let start = zero.select(own, threshold);
        let length = threshold.select(own, one - threshold);
        let rest = ((self.fraction - start) / length).min(F::splat(BELOW_ONE));
        (self.bucket.select(own, alias), rest)
    }
}

impl FewTable {
    /// Entries, at most: a place has 32 bits, 24 of which are of the number.
    pub const MOST: usize = 255;

    /// From a table of at most [`FewTable::MOST`] entries.
    pub fn new(table: &AliasTable) -> Self {
        debug_assert!(table.len() <= Self::MOST);
        let (thresholds, aliases) = (0..table.len()).map(|i| table.bucket(i)).unzip();
        Self { thresholds, aliases }
    }

    fn len(&self) -> u32 {
        self.thresholds.len() as u32
    }

    /// An entry by a uniform number in [0,1), and what is left of the number. Others are taken to the nearest of these, NaN to 0.
    #[inline]
    pub fn sample(&self, u: f32) -> (u32, f32) {
        let place = Place::new(u, self.len());
        let bucket = place.bucket as usize;
        place.entry(self.thresholds[bucket], self.aliases[bucket])
    }

    /// [`FewTable::sample`] of sixteen numbers.
    #[inline(always)]
    pub fn sample_lanes<W: Wide>(&self, u: W::F32) -> (W::U32, W::F32) {
        let place = Place::new(u, self.len());
        let threshold = W::F32::gather(&self.thresholds, place.bucket);
        place.entry(threshold, W::U32::gather(&self.aliases, place.bucket))
    }
}

#[cfg(test)]
mod tests {
    use lichtweg_ray::wide::{self, Kernel, LANES, Lanes};

    use super::*;

    struct Sample<'a>(&'a FewTable, Lanes<f32>);

    impl Kernel for Sample<'_> {
        type Output = (Lanes<u32>, Lanes<f32>);

        #[inline(always)]
        fn run<W: Wide>(self) -> Self::Output {
            let (entry, rest) = self.0.sample_lanes::<W>(W::F32::load(&self.1));
            (entry.to_lanes(), rest.to_lanes())
        }
    }

    /// Even numbers choose entries as often as they weigh, evenly inside; sixteen at a time as one by one.
    #[test]
    fn entries_come_by_weight() {
        const NUMBERS: u32 = 1 << 18;
        for weights in [&[1.0][..], &[1.0, 3.0], &[0.0, 2.0, 0.5, 7.0, 1.25], &[1.0; 255]] {
            let table = AliasTable::new(weights).unwrap();
            let few = FewTable::new(&table);
            let mut sums = vec![(0_u32, 0.0); weights.len()];
            for i in (0..NUMBERS).step_by(LANES) {
                let u = Lanes(std::array::from_fn(|lane| {
                    (i + lane as u32) as f32 / NUMBERS as f32 + 0.5 / NUMBERS as f32
                }));
                let (entries, rests) = wide::dispatch(Sample(&few, u));
                for lane in 0..LANES {
                    let (entry, rest) = few.sample(u.0[lane]);
                    assert_eq!((entry, rest), (entries.0[lane], rests.0[lane]));
                    assert!((0.0..1.0).contains(&rest));
                    let (count, sum) = &mut sums[entry as usize];
                    *count += 1;
                    *sum += f64::from(rest);
                }
            }
            for (i, (count, sum)) in sums.into_iter().enumerate() {
                let expected = f64::from(table.pmf(i)) * f64::from(NUMBERS);
                assert!((f64::from(count) - expected).abs() <= 2.0, "{i}: {count}, {expected}");
                assert!(count == 0 || (sum / f64::from(count) - 0.5).abs() < 1e-3, "{i}: {sum}, {count}");
            }
        }
    }

    #[test]
    fn any_number_gives_an_entry() {
        let few = FewTable::new(&AliasTable::new(&[0.0_f32, 1.0, 0.0]).unwrap());
        for u in [-1.0, 0.0, 1.0, 7.0, f32::NAN, f32::INFINITY] {
            assert_eq!(few.sample(u).0, 1, "{u}");
        }
    }
}
