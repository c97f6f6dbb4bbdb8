//! Rectangle cut into cells by a uniform grid and quadtrees in it.
//!
//! Cells follow a pilot sample: where many of its points fall they are split, so that a sharply peaked density
//! spreads over many cells of similar probability. That gives the chi-squared test its power there (a lobe inside a
//! single cell tests nothing) and the quadrature a smooth integrand.

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

    pub fn area(&self) -> f64 {
        (self.max[0] - self.min[0]) * (self.max[1] - self.min[1])
    }

    pub fn centre(&self) -> [f64; 2] {
        [0, 1].map(|axis| 0.5 * (self.min[axis] + self.max[axis]))
    }

    /// Quadrant 0..4: bit 0 for the upper half of the first axis, bit 1 of the second.
    pub fn quadrant(&self, index: usize) -> Self {
        let centre = self.centre();
        let mut quadrant = *self;
        for (axis, middle) in centre.into_iter().enumerate() {
            let side = if index >> axis & 1 == 1 { &mut quadrant.min } else { &mut quadrant.max };
            side[axis] = middle;
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_tile_the_domain_and_locate_agrees() {
        let domain = Rectangle { min: [-1.0, 2.0], max: [1.0, 5.0] };
        let pilot: Vec<[f64; 2]> = (0..1000).map(|i| [0.3 + 1e-4 * f64::from(i % 10), 2.5]).collect();
        let partition = Partition::new(domain, [3, 2], &pilot, 20);
        let area: f64 = partition.cells().map(|(_, bounds)| bounds.area()).sum();
        assert!((area - 6.0).abs() < 1e-12);
        assert!(partition.cells().count() > 20);
        for (index, bounds) in partition.cells() {
            assert_eq!(partition.locate(bounds.centre()), index);
        }
        assert!(partition.locate(domain.max) < partition.len());
    }
}
