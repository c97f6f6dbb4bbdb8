//! Every operation gives the same bits on every instruction set.

use super::{Double, Float, FloatLanes, Kernel, LANES, Lanes, Long, Mask, Row, Wide, Word, WordLanes, on};
use crate::simd::Isa;

/// Awkward numbers, and ordinary ones.
const VALUES: [f32; LANES] = [
    0.0,
    -0.0,
    1.0,
    -1.5,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
    f32::MIN_POSITIVE,
    1.0e-42,
    -3.0e38,
    0.1,
    7.25,
    -1234.567,
    16_777_216.0,
    2.0e9,
    std::f32::consts::PI,
];

/// Everything there is, as bits, for one pair of inputs.
struct Everything(Lanes<f32>, Lanes<f32>);

/// NaN has many patterns, and which one an operation yields is nobody's promise.
fn canonical(x: f32) -> u32 {
    if x.is_nan() { f32::NAN.to_bits() } else { x.to_bits() }
}

impl Kernel for Everything {
    type Output = Vec<u32>;

    #[inline(always)]
    fn run<W: Wide>(self) -> Vec<u32> {
        let (a, b) = (W::F32::load(&self.0), W::F32::load(&self.1));
        let mut out = Vec::new();
        let mut floats = |x: W::F32| out.extend(x.to_lanes().0.map(canonical));
        floats(a + b);
        floats(a - b);
        floats(a * b);
        floats(a / b);
        floats(-a);
        floats(a.mul_add(b, a));
        floats(a.mul_sub(b, a));
        floats(a.neg_mul_add(b, b));
        floats(a.sqrt());
        floats(a.min(b));
        floats(a.max(b));
        floats(a.abs());
        floats(a.copysign(b));
        let odd = W::Mask::from_bits(0x5a3c);
        floats(a.select(odd, b));
        let (x, y) = (a.widen(), b.widen());
        floats((x + y).narrow());
        floats((x * y - x).narrow());
        floats((x / y).sqrt().narrow());
        // The sign of NaN is nobody's promise either.
        let sign = y.select(y.equal(y), <W::F32 as Float>::Double::splat(-1.0));
        floats((-x).copysign(sign).select(odd, y).narrow());
        let mut masks: Vec<u32> = [a.lt(b), a.le(b), a.equal(b), a.gt(b), a.ge(b)].map(W::Mask::bits).into();
        masks.extend([x.lt(y), x.le(y), x.equal(y)].map(W::Mask::bits));
        masks.push((odd & a.lt(b) | !odd).bits());
        masks.push(odd.and_not(a.le(b)).bits());
        let (p, q) = (a.bits(), b.bits());
        let small = W::F32::splat(3.75).min(a.max(W::F32::splat(-2.5)));
        let mut words = |x: W::U32| masks.extend(x.to_lanes().0);
        words(small.truncate());
        words(p + q);
        words(p - q);
        words(p * q);
        words(p & q | p ^ q);
        words(p.shl::<7>());
        words(p.shr::<9>());
        words(p.select(odd, q));
        words(p.to_float().bits());
        let (m, n) = (p.widen().shl::<32>() | q.widen(), W::U64::splat(0xbf58_476d_1ce4_e5b9));
        let mixed = (m ^ m.shr::<30>()).wrapping_mul(n).wrapping_add(m);
        words(mixed.low());
        words(mixed.high());
        masks.extend([p.equal(q).bits(), p.lt(q).bits()]);
        let rows: Vec<Row> = (0..40).map(|i| Lanes(std::array::from_fn(|j| (i * 16 + j) as f32))).collect();
        for column in W::F32::columns(&std::array::from_fn(|i| &rows[i * 7 % 40])) {
            masks.extend(column.bits().to_lanes().0);
        }
        let columns = W::F32::columns(&std::array::from_fn(|i| &rows[i * 7 % 40]));
        masks.extend(W::F32::rows(columns).iter().flat_map(|row| row.0.map(f32::to_bits)));
        let index = p.shr::<29>();
        masks.extend(W::F32::gather(&VALUES, index).bits().to_lanes().0);
        masks.extend(W::U32::gather(&[3, 1, 4, 1, 5, 9, 2, 6], index).to_lanes().0);
        masks.push(b.select(b.lt(b) | b.ge(b), W::F32::splat(0.0)).smallest().to_bits() << 1);
        out.extend(masks);
        out
    }
}

#[test]
fn all_instruction_sets_agree() {
    for shift in 0..LANES {
        let (a, b) = (Lanes(VALUES), Lanes(std::array::from_fn(|i| VALUES[(i + shift) % LANES])));
        let expected = on(Isa::Portable, Everything(a, b));
        for isa in Isa::available() {
            let found = on(isa, Everything(a, b));
            let different = found.iter().zip(&expected).position(|(x, y)| x != y);
            assert_eq!((different, found.len()), (None, expected.len()), "{isa:?}, shift {shift}");
        }
    }
}

#[test]
fn rows_become_columns() {
    let rows: Vec<Row> = (0..20).map(|i| Lanes(std::array::from_fn(|j| (i * 100 + j) as f32))).collect();
    struct Columns<'a>([&'a Row; LANES]);
    impl Kernel for Columns<'_> {
        type Output = Vec<Lanes<f32>>;
        #[inline(always)]
        fn run<W: Wide>(self) -> Self::Output {
            W::F32::columns(&self.0).into_iter().map(|c| c.to_lanes()).collect()
        }
    }
    for isa in Isa::available() {
        for (j, column) in on(isa, Columns(std::array::from_fn(|i| &rows[19 - i]))).iter().enumerate() {
            for (lane, &value) in column.0.iter().enumerate() {
                assert_eq!(value, ((19 - lane) * 100) as f32 + j as f32, "{isa:?}");
            }
        }
    }
}
