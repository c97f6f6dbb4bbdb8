//! A segment as a cubic Bezier polynomial in four dimensions, the position and the radius.
//!
//! Every basis is brought to this form in `f64`: lines by degree elevation, B-splines by knot insertion
//! (Farin, *Curves and Surfaces for CAGD*, 2002, sections 6.1 and 8.5). End points are computed by one formula
//! on both sides of a joint, so that neighbours share them to the bit.

use super::{CurveBasis, Curves};

/// Position and radius.
pub(crate) type Point4 = [f64; 4];

/// A cubic in Bezier form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bezier(pub [Point4; 4]);

#[inline(always)]
fn combine<const N: usize>(points: [&Point4; N], weights: [f64; N]) -> Point4 {
    std::array::from_fn(|i| {
        let mut sum = 0.0;
        for (p, w) in points.iter().zip(weights) {
            sum += p[i] * w;
        }
        sum
    })
}

impl Bezier {
    /// A segment of `curves`, each control point mapped by `map` first.
    #[inline]
    pub(crate) fn new(curves: &Curves, segment: u32, map: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        let control = curves.control(segment);
        let point = |i: usize| {
            let [x, y, z] = map(control[i].position.to_array().map(f64::from));
            [x, y, z, f64::from(control[i].radius)]
        };
        let third = |p: &Point4, q: &Point4| combine([p, q], [2.0 / 3.0, 1.0 / 3.0]);
        match curves.basis {
            CurveBasis::Bezier => Self([point(0), point(1), point(2), point(3)]),
            CurveBasis::Linear => {
                let (a, b) = (point(0), point(1));
                Self([a, third(&a, &b), third(&b, &a), b])
            }
            CurveBasis::BSpline => {
                let [a, b, c, d] = [point(0), point(1), point(2), point(3)];
                let joint = |points| combine(points, [1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0]);
                Self([joint([&a, &b, &c]), third(&b, &c), third(&c, &b), joint([&b, &c, &d])])
            }
        }
    }

    /// The point at `u`; exactly an end point at 0 and 1.
    #[inline(always)]
    pub(crate) fn at(&self, u: f64) -> Point4 {
        let [a, b, c, d] = &self.0;
        let v = 1.0 - u;
        combine([a, b, c, d], [v * v * v, 3.0 * u * v * v, 3.0 * u * u * v, u * u * u])
    }

    /// The derivative at `u`. Where control points coincide and it vanishes, the direction in which the curve
    /// leaves or arrives takes its place.
    pub(crate) fn derivative(&self, u: f64) -> Point4 {
        let [a, b, c, d] = &self.0;
        let v = 1.0 - u;
        let difference = |p: &Point4, q: &Point4| -> Point4 { std::array::from_fn(|i| 3.0 * (q[i] - p[i])) };
        let [e, f, g] = [difference(a, b), difference(b, c), difference(c, d)];
        let exact = combine([&e, &f, &g], [v * v, 2.0 * u * v, u * u]);
        let vanishes = |p: &Point4| p[..3].iter().all(|x| *x == 0.0);
        if !vanishes(&exact) {
            return exact;
        }
        if vanishes(&f) { combine([&e, &f, &g], [1.0 / 3.0; 3]) } else { f }
    }

    /// A bound on the length of the second derivative, radius included.
    pub(crate) fn bend(&self) -> f64 {
        let second = |i: usize| {
            let [p, q, r] = [&self.0[i], &self.0[i + 1], &self.0[i + 2]];
            combine([p, q, r], [1.0, -2.0, 1.0]).iter().map(|x| x * x).sum::<f64>()
        };
        6.0 * second(0).max(second(1)).sqrt()
    }

    /// The largest radius of the control points, which no radius of the curve exceeds.
    pub(crate) fn largest_radius(&self) -> f64 {
        self.0.iter().fold(0.0, |r, p| p[3].max(r))
    }
}
