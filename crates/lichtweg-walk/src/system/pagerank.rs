//! Personalised PageRank: x = a P^T x + (1 - a) s, with P the adjacency matrix whose rows are scaled to sum 1, s the
//! teleport distribution and a the damping (Page, Brin, Motwani, Winograd 1999; Jeh and Widom 2003).
//!
//! From a node without edges out a walk teleports, as in NetworkX and fast-pagerank. That would be one dense row for each
//! such node. Instead they all lead to one further unknown, the last, which leads to s: x_n = sqrt(a) sum of their ranks, and
//! x = a P^T x + s (1 - a + sqrt(a) x_n). The system stays sparse, the ranks are the same, and no column sums to one.

use super::{System, SystemError, check_square, check_vector};
use crate::Matrix;

impl System {
    /// The ranks by adjacency (row i: edges from node i, with weights), teleport weights (any scale) and damping.
    ///
    /// There is one unknown more than nodes where some node has no edge out.
    ///
    /// # Errors
    /// Negative weights, all teleport weights zero, a damping outside of [0,1), lengths that do not fit.
    pub fn personalised_pagerank(
        adjacency: &Matrix,
        teleport: &[f64],
        damping: f64,
    ) -> Result<Self, SystemError> {
        check_square(adjacency)?;
        check_vector("teleport vector", teleport, adjacency)?;
        if !(0.0..1.0).contains(&damping) {
            return Err(SystemError::Parameter(format!("the damping has to be in [0,1), not {damping}")));
        }
        if !adjacency.is_nonnegative() || teleport.iter().any(|&weight| weight < 0.0) {
            return Err(SystemError::Parameter(
                "weights of edges and of the teleport must not be negative".into(),
            ));
        }
        let total: f64 = teleport.iter().sum();
        if !(total > 0.0 && total.is_finite()) {
            return Err(SystemError::Parameter(
                "the teleport weights have to sum to a positive number".into(),
            ));
        }
        let nodes = adjacency.rows();
        let any_dangling = damping > 0.0 && (0..nodes).any(|i| adjacency.row_len(i) == 0);
        let size = nodes + usize::from(any_dangling);
        let share: Vec<f64> = teleport.iter().map(|weight| weight / total).collect();
        // Rows of M^T: where a walk goes from each node.
        let (mut offsets, mut indices) = (vec![0], Vec::with_capacity(adjacency.entries()));
        let mut values = Vec::with_capacity(adjacency.entries());
        for i in 0..nodes {
            let row = adjacency.row(i);
            if !row.indices.is_empty() {
                let mass = row.mass();
                indices.extend_from_slice(row.indices);
                values.extend(row.values.iter().map(|value| damping * (value / mass)));
            } else if any_dangling {
                indices.push(nodes as u32);
                values.push(damping.sqrt());
            }
            offsets.push(values.len());
        }
        if any_dangling {
            indices.extend(0..nodes as u32);
            values.extend(share.iter().map(|share| damping.sqrt() * share));
            offsets.push(values.len());
        }
        let walk = Matrix::from_csr(size, size, offsets, indices, values)
            .map_err(|error| SystemError::Parameter(error.to_string()))?;
        let mut source: Vec<f64> = share.iter().map(|share| (1.0 - damping) * share).collect();
        source.resize(size, 0.0);
        let system = Self::fixed_point(walk.transposed(), source)?;
        // Already at hand, and what forward walks want.
        let _ = system.transposed.set(walk);
        Ok(system)
    }
}
