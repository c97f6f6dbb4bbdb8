//! Damage for the tests of parsers: the same on every run.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

/// How long a parser is fed with damaged files.
const DURATION: Duration = Duration::from_secs(2);

/// Every prefix of a file (of long ones, a thousand), for parsers that must tell that it is cut off.
pub(crate) fn truncations(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    (0..bytes.len()).step_by(bytes.len().div_ceil(1000).max(1)).map(|length| &bytes[..length])
}

/// Feeds `parse` with variants of valid files for two seconds; names the variant at which it panics.
pub(crate) fn feed_damaged(valid: &[Vec<u8>], parse: impl Fn(&[u8])) {
    let mut random = SplitMix(2_026);
    let start = Instant::now();
    let mut iteration = 0_u64;
    while start.elapsed() < DURATION {
        let bytes = damage(&valid[random.below(valid.len())], &mut random);
        if catch_unwind(AssertUnwindSafe(|| parse(&bytes))).is_err() {
            panic!("panic at variant {iteration}: {:?}", &bytes[..bytes.len().min(400)]);
        }
        iteration += 1;
    }
}

fn damage(valid: &[u8], random: &mut SplitMix) -> Vec<u8> {
    let mut bytes = valid.to_vec();
    for _ in 0..=random.below(4) {
        let at = random.below(bytes.len() + 1);
        let end = (at + random.below(9)).min(bytes.len());
        match random.below(7) {
            0 => bytes.truncate(at),
            1 => bytes[at..end].iter_mut().for_each(|byte| *byte ^= 1 << random.below(8)),
            2 => bytes[at..end].iter_mut().for_each(|byte| *byte = random.next() as u8),
            3 => drop(bytes.drain(at..end)),
            4 => drop(bytes.splice(at..at, valid[random.below(valid.len())..].iter().copied().take(32))),
            5 => {
                let extremes =
                    [0_u64, 1, 0x7f, 0x80, 0xff, 0x7fff_ffff, 0xffff_ffff, u64::MAX >> 1, u64::MAX];
                let extreme = extremes[random.below(extremes.len())].to_le_bytes();
                bytes[at..end].iter_mut().zip(extreme).for_each(|(byte, new)| *byte = new);
            }
            _ => {
                let words: [&[u8]; 8] =
                    [b"-1", b"99999999999999999999", b"nan", b"-inf", b"1e400", b"\n", b" ", b"\\\n"];
                drop(bytes.splice(at..end, words[random.below(words.len())].iter().copied()));
            }
        }
    }
    bytes
}

/// Steele, Lea and Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014.
pub(crate) struct SplitMix(pub u64);

impl SplitMix {
    /// The next number.
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number below `bound`, nearly uniform; 0 when `bound` is 0.
    pub fn below(&mut self, bound: usize) -> usize {
        (self.next() % bound.max(1) as u64) as usize
    }
}
