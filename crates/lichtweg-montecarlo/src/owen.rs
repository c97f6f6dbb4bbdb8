//! The first two Sobol' dimensions with hash-based Owen scrambling.
//!
//! The pair (van der Corput, Pascal matrix) is a (0,2)-sequence in base 2: of the first 2^m points, and of every
//! aligned block of 2^m, each elementary box of area 2^-m holds exactly one. Nested uniform ("Owen") scrambling keeps
//! that and makes the points random: each is uniform, and for smooth integrands the variance of the mean falls as
//! N^-3 log N (Owen, *Scrambled net variance for integrals of smooth functions*, 1997).
//!
//! The scramble as a hash whose bit i depends on bits 0..=i only is by Laine and Karras (*Stratified sampling for
//! stochastic transparency*, 2011); use by index shuffling and padding by Burley (*Practical hash-based Owen
//! scrambling*, JCGT 2020); the constants are N. Vegdahl's (*Building a better LK hash*, 2021).
//!
//! Points have 32 bits: after 2^32 samples the sequence repeats.

/// Nested uniform scramble of a word whose *least* significant bit is the first digit.
#[inline]
const fn scramble_reversed(mut x: u32, seed: u32) -> u32 {
    // Multiplication by an even constant moves information upwards only: a bit never sees one above it.
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

/// Permutes sample indices so that aligned blocks of 2^m indices map to aligned blocks of 2^m indices: pairs with
/// unlike seeds can then be padded together without correlation while each stays well stratified.
#[inline]
#[must_use]
pub const fn shuffle_index(index: u32, seed: u32) -> u32 {
    scramble_reversed(index.reverse_bits(), seed).reverse_bits()
}

/// The word whose bit i (least significant first) is binary digit i of the second Sobol' dimension.
///
/// Digit i is the sum mod 2 of C(j,i) a_j over the index bits a_j. By Lucas' theorem C(j,i) is odd exactly when the
/// bits of i are a subset of those of j, so the matrix is the fifth Kronecker power of `[[1, 1], [0, 1]]` and factors
/// into five shifts.
#[inline]
const fn pascal(mut x: u32) -> u32 {
    x ^= (x >> 16) & 0x0000_ffff;
    x ^= (x >> 8) & 0x00ff_00ff;
    x ^= (x >> 4) & 0x0f0f_0f0f;
    x ^= (x >> 2) & 0x3333_3333;
    x ^ (x >> 1) & 0x5555_5555
}

/// Point `index` of the scrambled van der Corput sequence, as a 32-bit fraction.
#[inline]
#[must_use]
pub const fn van_der_corput(index: u32, seed: u32) -> u32 {
    scramble_reversed(index, seed).reverse_bits()
}

/// Point `index` of the scrambled second Sobol' dimension, as a 32-bit fraction.
#[inline]
#[must_use]
pub const fn sobol_second(index: u32, seed: u32) -> u32 {
    scramble_reversed(pascal(index), seed).reverse_bits()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Direction numbers of the second dimension by the recurrence of its primitive polynomial x + 1
    /// (Joe and Kuo 2008): v_0 = 1/2, v_k = v_{k-1} xor v_{k-1}/2.
    fn sobol_second_by_direction_numbers(index: u32) -> u32 {
        let mut direction = 1_u32 << 31;
        let mut point = 0;
        for bit in 0..32 {
            if index >> bit & 1 == 1 {
                point ^= direction;
            }
            direction ^= direction >> 1;
        }
        point
    }

    #[test]
    fn pascal_matches_direction_numbers() {
        for i in 0..100_000_u32 {
            let index = i.wrapping_mul(0x9e37_79b9);
            assert_eq!(pascal(index).reverse_bits(), sobol_second_by_direction_numbers(index));
        }
    }

    #[test]
    fn scramble_is_nested() {
        // Points that share their first k digits still do, and first differ in digit k + 1 if they did.
        for seed in (0..64_u32).map(|i| i.wrapping_mul(0xdead_beef)) {
            for bit in 0..32 {
                let x = 0x1234_5678_u32.wrapping_mul(seed | 1);
                let flipped = scramble_reversed(x, seed) ^ scramble_reversed(x ^ (1 << bit), seed);
                assert_eq!(flipped.trailing_zeros(), bit);
            }
        }
    }
}
