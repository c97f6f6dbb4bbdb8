//! Adaptive quadrature over rectangles for densities: smooth, sharply peaked, or cut off along an edge.
//!
//! 3 x 3 Gauss-Legendre rules in a quadtree. Agreement of a part with its quarters is not trusted where the function
//! varies much, since along an edge it may be chance; there quartering goes on until the part is negligible, and that
//! rest is integrated with random points, because the errors of a fixed rule add up along an edge parallel to the
//! cells.

use super::partition::Rectangle;
use crate::{Sampler, SamplerKind};

/// Integral of `f` over a rectangle.
///
/// A part is quartered until its quarters agree with it to 10^-4 of the value plus `tolerance` and `f` varies by no
/// more than a factor of 2 over it, or until its area times the largest value is below 10 `tolerance`; at least
/// once, at most `depth` + 1 times. A peak that falls between the points of the first two levels is missed.
pub(super) fn integrate(
    f: &mut impl FnMut([f64; 2]) -> f64,
    bounds: Rectangle,
    tolerance: f64,
    depth: u32,
) -> f64 {
    let parts = quarters(f, bounds);
    quarter(f, bounds, &parts, tolerance, depth)
}

type Parts = [Estimate; 4];

fn quarters(f: &mut impl FnMut([f64; 2]) -> f64, bounds: Rectangle) -> Parts {
    [0, 1, 2, 3].map(|i| gauss_legendre(f, bounds.quadrant(i)))
}

/// Sum over the quadrants, of which `parts` are first estimates.
fn quarter(
    f: &mut impl FnMut([f64; 2]) -> f64,
    bounds: Rectangle,
    parts: &Parts,
    tolerance: f64,
    depth: u32,
) -> f64 {
    (0..4).map(|i| subdivide(f, bounds.quadrant(i), parts[i].integral, tolerance, depth)).sum()
}

fn subdivide(
    f: &mut impl FnMut([f64; 2]) -> f64,
    bounds: Rectangle,
    whole: f64,
    tolerance: f64,
    depth: u32,
) -> f64 {
    let parts = quarters(f, bounds);
    let sum: f64 = parts.iter().map(|part| part.integral).sum();
    let smallest = parts.iter().fold(f64::INFINITY, |m, part| m.min(part.smallest));
    let largest = parts.iter().fold(0.0_f64, |m, part| m.max(part.largest));
    let smooth = largest <= 2.0 * smallest;
    let agrees = (sum - whole).abs() <= 1e-4 * sum.abs() + tolerance;
    // NaN ends the recursion too; the caller sees it in the result.
    if (agrees && smooth) || sum.is_nan() {
        sum
    } else if depth == 0 || largest * bounds.area() <= 10.0 * tolerance {
        stratified(f, bounds)
    } else {
        quarter(f, bounds, &parts, tolerance, depth - 1)
    }
}

/// An estimate of an integral and the range of the values seen.
struct Estimate {
    integral: f64,
    smallest: f64,
    largest: f64,
}

fn gauss_legendre(f: &mut impl FnMut([f64; 2]) -> f64, bounds: Rectangle) -> Estimate {
    const NODES: [f64; 3] = [-0.774_596_669_241_483_4, 0.0, 0.774_596_669_241_483_4];
    const WEIGHTS: [f64; 3] = [5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0];
    // The corners show an edge that passes outside of the nodes; not quite at the corner, since a function may be
    // anything on the boundary of its support.
    const CORNER: f64 = 0.999;
    let centre = bounds.centre();
    let extent = [0, 1].map(|axis| bounds.max[axis] - bounds.min[axis]);
    let mut at = |x: f64, y: f64| f([centre[0] + 0.5 * extent[0] * x, centre[1] + 0.5 * extent[1] * y]);
    let mut estimate = Estimate { integral: 0.0, smallest: f64::INFINITY, largest: 0.0 };
    let mut see = |value: f64, weight: f64| {
        estimate.integral += weight * value;
        estimate.smallest = estimate.smallest.min(value);
        estimate.largest = estimate.largest.max(value);
    };
    for (x, weight_x) in NODES.into_iter().zip(WEIGHTS) {
        for (y, weight_y) in NODES.into_iter().zip(WEIGHTS) {
            see(at(x, y), weight_x * weight_y * bounds.area());
        }
    }
    for [x, y] in [[-CORNER, -CORNER], [CORNER, -CORNER], [-CORNER, CORNER], [CORNER, CORNER]] {
        see(at(x, y), 0.0);
    }
    estimate
}

/// Unbiased estimate by one random point in each of 3 x 3 strata, seeded by the place.
fn stratified(f: &mut impl FnMut([f64; 2]) -> f64, bounds: Rectangle) -> f64 {
    const STRATA: u32 = 3;
    let [seed, stream] = bounds.centre().map(f64::to_bits);
    let extent = [0, 1].map(|axis| bounds.max[axis] - bounds.min[axis]);
    let mut sum = 0.0;
    for i in 0..STRATA * STRATA {
        let jitter = Sampler::new(SamplerKind::Independent, seed, stream, i).next_2d().map(f64::from);
        let stratum = [i % STRATA, i / STRATA].map(f64::from);
        sum += f([0, 1].map(|axis| {
            bounds.min[axis] + extent[axis] * (stratum[axis] + jitter[axis]) / f64::from(STRATA)
        }));
    }
    sum * bounds.area() / f64::from(STRATA * STRATA)
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Rectangle = Rectangle { min: [0.0; 2], max: [1.0; 2] };

    /// Error relative to the tolerance: the rest along edges and in tails is integrated to several of it.
    fn error(f: impl Fn([f64; 2]) -> f64, expected: f64) -> f64 {
        let tolerance = 1e-6;
        (integrate(&mut |p| f(p), UNIT, tolerance, 12) - expected).abs() / tolerance
    }

    fn indicator(inside: bool) -> f64 {
        f64::from(u8::from(inside))
    }

    #[test]
    fn smooth_and_peaked() {
        use std::f64::consts::PI;
        assert!(error(|[x, y]| x.powi(5) * y.powi(4), 1.0 / 30.0) < 20.0);
        let peak = |[x, y]: [f64; 2]| (-1e3 * ((x - 0.4).powi(2) + (y - 0.5).powi(2))).exp();
        assert!(error(peak, PI / 1e3) < 20.0);
        assert!(integrate(&mut |_| f64::NAN, UNIT, 1e-6, 12).is_nan());
    }

    #[test]
    fn edges_curved_and_parallel_to_the_cells() {
        let disk = |[x, y]: [f64; 2]| indicator(x * x + y * y < 1.0);
        assert!(error(disk, std::f64::consts::FRAC_PI_4) < 50.0);
        for cut in [0.126, 0.248, 0.2512, 1.0 / 3.0, 0.7] {
            assert!(error(|[x, _]| indicator(x < cut), cut) < 50.0, "{cut}");
        }
    }

    #[test]
    fn singularities_end() {
        // Integral of x^(-1/2) is 2; the depth bounds the work.
        assert!(error(|[x, _]| x.powf(-0.5), 2.0) < 5e4);
    }
}
