//! [`lichtweg_montecarlo::owen`] for any width; see there. A test holds both to the same bits.

use lichtweg_ray::wide::Word;

/// Nested uniform scramble of words whose least significant bit is the first digit. In lanes only: it multiplies modulo 2^32.
#[inline(always)]
fn scramble_reversed<U: Word>(x: U, seed: U) -> U {
    let number = U::splat;
    let x = x ^ (x * number(0x3d20_adea));
    let x = (x + seed) * (seed.shr::<16>() | number(1));
    let x = x ^ (x * number(0x0552_6c56));
    x ^ (x * number(0x53a2_2864))
}

/// See [`u32::reverse_bits`].
#[inline(always)]
fn reverse_bits<U: Word>(x: U) -> U {
    let number = U::splat;
    let x = x.shr::<1>() & number(0x5555_5555) | (x & number(0x5555_5555)).shl::<1>();
    let x = x.shr::<2>() & number(0x3333_3333) | (x & number(0x3333_3333)).shl::<2>();
    let x = x.shr::<4>() & number(0x0f0f_0f0f) | (x & number(0x0f0f_0f0f)).shl::<4>();
    let x = x.shr::<8>() & number(0x00ff_00ff) | (x & number(0x00ff_00ff)).shl::<8>();
    x.shr::<16>() | x.shl::<16>()
}

/// The matrix of the second dimension.
#[inline(always)]
fn pascal<U: Word>(x: U) -> U {
    let number = U::splat;
    let x = x ^ x.shr::<16>();
    let x = x ^ x.shr::<8>() & number(0x00ff_00ff);
    let x = x ^ x.shr::<4>() & number(0x0f0f_0f0f);
    let x = x ^ x.shr::<2>() & number(0x3333_3333);
    x ^ x.shr::<1>() & number(0x5555_5555)
}

/// See `owen::shuffle_index`.
#[inline(always)]
pub(crate) fn shuffle_index<U: Word>(index: U, seed: U) -> U {
    reverse_bits(scramble_reversed(reverse_bits(index), seed))
}

/// See `owen::van_der_corput`.
#[inline(always)]
pub(crate) fn van_der_corput<U: Word>(index: U, seed: U) -> U {
    reverse_bits(scramble_reversed(index, seed))
}

/// See `owen::sobol_second`.
#[inline(always)]
pub(crate) fn sobol_second<U: Word>(index: U, seed: U) -> U {
    reverse_bits(scramble_reversed(pascal(index), seed))
}
