//! 64-bit integer hashing: the randomness under every sample value.
//!
//! `mix64` is the finaliser "Mix13" of D. Stafford (*Better Bit Mixing*, 2011), the output function of SplitMix64
//! (Steele, Lea, Flood: *Fast Splittable Pseudorandom Number Generators*, OOPSLA 2014). Applied to a counter times
//! an odd constant it passes BigCrush. It is a bijection, so distinct counters give distinct values. None of this is
//! fit for cryptography.

/// The odd 64-bit constant nearest 2^64 / golden ratio: multiples of it are spread evenly (Weyl sequence).
pub const GOLDEN_GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;

/// Bijective mix of 64 bits: each input bit flips each output bit with probability close to one half.
#[inline]
#[must_use]
pub const fn mix64(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Hash of `key` and a counter; for a fixed key a bijection of the counter.
#[inline]
#[must_use]
pub const fn combine(key: u64, counter: u64) -> u64 {
    mix64(key.wrapping_add(counter.wrapping_mul(GOLDEN_GAMMA)))
}

/// Hash of three words, for example (seed, pixel, sample index). Each is mixed in fully before the next enters,
/// so adjacent seeds, pixels and samples are unrelated.
#[inline]
#[must_use]
pub const fn hash3(a: u64, b: u64, c: u64) -> u64 {
    combine(combine(first(a), b), c)
}

/// The hash of the first of several words, to be combined with the others.
#[inline]
#[must_use]
pub const fn first(a: u64) -> u64 {
    // The offset keeps the all-zero input from the fixed point of `mix64` at zero.
    mix64(a ^ 0xd1b5_4a32_d192_ed03)
}

/// Uniform value in [0,1) from the 24 high bits of a word: every value is a multiple of 2^-24, never 1.
#[inline]
#[must_use]
pub const fn unit_f32(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// Uniform value in [0,1) from the 53 high bits of a word: every value is a multiple of 2^-53, never 1.
#[inline]
#[must_use]
pub const fn unit_f64(bits: u64) -> f64 {
    (bits >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splitmix64_published_output() {
        // First outputs of SplitMix64 seeded with 1234567 (Rosetta Code, "Pseudo-random numbers/Splitmix64").
        let outputs: Vec<u64> = (1..=3).map(|i| combine(1_234_567, i)).collect();
        assert_eq!(
            outputs,
            [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423]
        );
    }

    #[test]
    fn conversions_stay_below_one() {
        assert_eq!(unit_f32(u32::MAX), 1.0 - f32::EPSILON / 2.0);
        assert_eq!(unit_f64(u64::MAX), 1.0 - f64::EPSILON / 2.0);
        assert_eq!((unit_f32(0), unit_f64(0)), (0.0, 0.0));
    }

    #[test]
    fn every_input_bit_flips_every_output_bit_half_the_time() {
        // Binomial(4096, 1/2) has sigma 32; 4096 cells, so 5.5 sigma is alpha of about 1.6e-4 over all.
        let trials = 4096_u64;
        for input in 0..64 {
            let mut flips = [0_i64; 64];
            for i in 0..trials {
                let changed = hash3(1, i, 2) ^ hash3(1, i ^ (1 << input), 2);
                for (output, count) in flips.iter_mut().enumerate() {
                    *count += (changed >> output & 1) as i64;
                }
            }
            for count in flips {
                assert!((count - trials as i64 / 2).abs() < 176, "input bit {input}: {count} of {trials}");
            }
        }
    }
}
