//! Rectangle cut into cells by a uniform grid and quadtrees in it, and integrals over its cells.
//!
//! Cells follow a pilot sample: where many of its points fall they are split, so that a sharply peaked density spreads over many
//! cells of similar probability. That gives the chi-squared test its power there (a lobe inside a single cell tests
//! nothing) and the quadrature a smooth integrand.

/// An axis-parallel rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rectangle {
    pub min: [f64; 2],
    pub max: [f64; 2],
}

impl Rectangle {
    pub fn contains(&self, p: [f64; 2]) -> bool {
        (0..2).all(|axis| self.min[axis] <= p[axis] && p[axis] <= self.max[axis])
    }

    fn centre(&self) -> [f64; 2] {
        [0, 1].map(|axis| 0.5 * (self.min[axis] + self.max[axis]))
    }

    /// Quadrant 0..4: bit 0 for the upper half of the first axis, bit 1 of the second.
    fn quadrant(&self, index: usize) -> Self {
        let centre = self.centre();
        let mut quadrant = *self;
        for axis in 0..2 {
            let side = if index >> axis & 1 == 1 { &mut quadrant.min } else { &mut quadrant.max };
            side[axis] = centre[axis];
        }
        quadrant
    }

    fn quadrant_of(&self, p: [f64; 2]) -> usize {
        let centre = self.centre();
        usize::from(p[0] >= centre[0]) | usize::from(p[1] >= centre[1]) << 1
    }
}

struct Node {
    bounds: Rectangle,
    /// Index of the first of four children, if split.
    children: Option<usize>,
}

/// A partition of a rectangle; cells are the leaves among its nodes.
pub(super) struct Partition {
    domain: Rectangle,
    grid: [usize; 2],
    nodes: Vec<Node>,
}

/// Splits of one grid cell at most: below, cells would be finer than f32 coordinates.
const MAX_SPLITS: u32 = 16;

impl Partition {
    /// Grid of `grid` cells over `domain`, split until no cell holds more than `capacity` of the `pilot` points.
    pub fn new(domain: Rectangle, grid: [usize; 2], pilot: &[[f64; 2]], capacity: usize) -> Self {
        let grid = grid.map(|n| n.max(1));
        let edge = |axis: usize, i: usize| {
            let fraction = i as f64 / grid[axis] as f64;
            domain.min[axis] + (domain.max[axis] - domain.min[axis]) * fraction
        };
        let nodes = (0..grid[0] * grid[1])
            .map(|cell| [cell % grid[0], cell / grid[0]])
            .map(|[i, j]| Rectangle { min: [edge(0, i), edge(1, j)], max: [edge(0, i + 1), edge(1, j + 1)] })
            .map(|bounds| Node { bounds, children: None })
            .collect();
        let mut partition = Self { domain, grid, nodes };
        let mut points = vec![Vec::new(); grid[0] * grid[1]];
        for &p in pilot {
            points[partition.grid_cell(p)].push(p);
        }
        for (cell, points) in points.into_iter().enumerate() {
            partition.refine(cell, points, capacity, MAX_SPLITS);
        }
        partition
    }

    fn refine(&mut self, node: usize, points: Vec<[f64; 2]>, capacity: usize, splits_left: u32) {
        if points.len() <= capacity || splits_left == 0 {
            return;
        }
        let bounds = self.nodes[node].bounds;
        let first = self.nodes.len();
        self.nodes[node].children = Some(first);
        self.nodes.extend((0..4).map(|i| Node { bounds: bounds.quadrant(i), children: None }));
        let mut quadrants = [const { Vec::new() }; 4];
        for p in points {
            quadrants[bounds.quadrant_of(p)].push(p);
        }
        for (i, points) in quadrants.into_iter().enumerate() {
            self.refine(first + i, points, capacity, splits_left - 1);
        }
    }

    fn grid_cell(&self, p: [f64; 2]) -> usize {
        let [i, j] = [0, 1].map(|axis| {
            let extent = self.domain.max[axis] - self.domain.min[axis];
            let position = (p[axis] - self.domain.min[axis]) / extent * self.grid[axis] as f64;
            (position as usize).min(self.grid[axis] - 1)
        });
        j * self.grid[0] + i
    }

    /// Number of nodes; cell indices are below it.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Index of the cell that holds `p`.
    pub fn locate(&self, p: [f64; 2]) -> usize {
        let mut node = self.grid_cell(p);
        while let Some(first) = self.nodes[node].children {
            node = first + self.nodes[node].bounds.quadrant_of(p);
        }
        node
    }

    /// The cells: (index, rectangle).
    pub fn cells(&self) -> impl Iterator<Item = (usize, Rectangle)> {
        let leaves = self.nodes.iter().enumerate().filter(|(_, node)| node.children.is_none());
        leaves.map(|(i, node)| (i, node.bounds))
    }
}

/// Integral of `f` over a rectangle by adaptive 3 x 3 Gauss-Legendre quadrature.
///
/// A part is quartered until its quarters agree with the whole to 10^-4 of the value plus `tolerance`, at least once
/// and at most `depth` + 1 times. Agreement across an edge may be chance, so a part where `f` varies by more than a factor of 2 is
/// quartered regardless, unless it is small. A peak that falls between all 144 points of the first two levels is missed.
pub(super) fn integrate(
    f: &mut impl FnMut([f64; 2]) -> f64,
    bounds: Rectangle,
    tolerance: f64,
    depth: u32,
) -> f64 {
    let quadrants = [0, 1, 2, 3].map(|i| bounds.quadrant(i));
    let parts = quadrants.map(|quadrant| gauss_legendre(f, quadrant));
    (0..4).map(|i| subdivide(f, quadrants[i], parts[i].integral, tolerance, depth)).sum()
}

fn subdivide(
    f: &mut impl FnMut([f64; 2]) -> f64,
    bounds: Rectangle,
    whole: f64,
    tolerance: f64,
    depth: u32,
) -> f64 {
    let parts = [0, 1, 2, 3].map(|i| gauss_legendre(f, bounds.quadrant(i)));
    let sum: f64 = parts.iter().map(|part| part.integral).sum();
    let smallest = parts.iter().fold(f64::INFINITY, |m, part| m.min(part.smallest));
    let largest = parts.iter().fold(0.0_f64, |m, part| m.max(part.largest));
    let agrees = (sum - whole).abs() <= 1e-4 * sum.abs() + tolerance;
    let smooth = largest <= 2.0 * smallest || sum.abs() <= 10.0 * tolerance;
    // NaN ends the recursion too; the caller sees it in the result.
    if depth == 0 || sum.is_nan() || (agrees && smooth) {
        return sum;
    }
    (0..4).map(|i| subdivide(f, bounds.quadrant(i), parts[i].integral, tolerance, depth - 1)).sum()
}

/// An estimate of an integral and the range of values that it is made of.
struct Estimate {
    integral: f64,
    smallest: f64,
    largest: f64,
}

fn gauss_legendre(f: &mut impl FnMut([f64; 2]) -> f64, bounds: Rectangle) -> Estimate {
    const NODES: [f64; 3] = [-0.774_596_669_241_483_4, 0.0, 0.774_596_669_241_483_4];
    const WEIGHTS: [f64; 3] = [5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0];
    let centre = bounds.centre();
    let extent = [0, 1].map(|axis| bounds.max[axis] - bounds.min[axis]);
    let mut estimate = Estimate { integral: 0.0, smallest: f64::INFINITY, largest: 0.0 };
    for (x, weight_x) in NODES.iter().zip(WEIGHTS) {
        for (y, weight_y) in NODES.iter().zip(WEIGHTS) {
            let value = f([centre[0] + 0.5 * extent[0] * x, centre[1] + 0.5 * extent[1] * y]);
            estimate.integral += weight_x * weight_y * value * extent[0] * extent[1];
            estimate.smallest = estimate.smallest.min(value);
            estimate.largest = estimate.largest.max(value);
        }
    }
    estimate
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Rectangle = Rectangle { min: [0.0; 2], max: [1.0; 2] };

    #[test]
    fn cells_tile_the_domain_and_locate_agrees() {
        let domain = Rectangle { min: [-1.0, 2.0], max: [1.0, 5.0] };
        let pilot: Vec<[f64; 2]> = (0..1000).map(|i| [0.3 + 1e-4 * f64::from(i % 10), 2.5]).collect();
        let partition = Partition::new(domain, [3, 2], &pilot, 20);
        let area: f64 = partition.cells().map(|(_, r)| (r.max[0] - r.min[0]) * (r.max[1] - r.min[1])).sum();
        assert!((area - 6.0).abs() < 1e-12);
        assert!(partition.cells().count() > 20);
        for (index, bounds) in partition.cells() {
            assert_eq!(partition.locate(bounds.centre()), index);
        }
        assert!(partition.locate(domain.max) < partition.len());
    }

    #[test]
    fn integrals_of_smooth_peaked_and_broken_functions() {
        let close = |f: &mut dyn FnMut([f64; 2]) -> f64, expected: f64, tolerance: f64| {
            let value = integrate(&mut |p| f(p), UNIT, 1e-6, 12);
            assert!((value - expected).abs() < tolerance, "{value} {expected}");
        };
        close(&mut |[x, y]| x.powi(5) * y.powi(4), 1.0 / 30.0, 1e-12);
        close(&mut |[x, y]| (-1e3 * ((x - 0.4).powi(2) + (y - 0.5).powi(2))).exp(), 3.141_592_65e-3, 1e-7);
        close(&mut |[x, y]| f64::from(u8::from(x * x + y * y < 1.0)), std::f64::consts::FRAC_PI_4, 1e-4);
        assert!(integrate(&mut |_| f64::NAN, UNIT, 1e-6, 12).is_nan());
    }
}
