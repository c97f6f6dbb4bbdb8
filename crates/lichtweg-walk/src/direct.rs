//! Sparse factorisation by `faer`: Cholesky where the matrix is symmetric and positive definite, LU elsewhere.

use faer::Side;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::amd;
use faer::sparse::{SparseColMat, SymbolicSparseColMatRef, Triplet};

use crate::Matrix;

/// Entries of a factor that are too many: 4 GiB.
pub const MOST_FILL: f64 = 5e8;

/// What factors of a symmetric matrix would take.
#[derive(Clone, Copy, Debug)]
pub struct Fill {
    /// Entries of the factor.
    pub entries: f64,
    /// Multiplications to find it.
    pub operations: f64,
}

/// Counts fill and work of a Cholesky factorisation in the order of approximate minimum degree (Amestoy, Davis, Duff 1996),
/// for the pattern of A + A^T; without pivoting, LU takes twice as much. `None` without memory to find out.
#[must_use]
pub fn fill(a: &Matrix) -> Option<Fill> {
    let n = a.rows();
    let mut starts = vec![0];
    let mut indices = Vec::with_capacity(a.entries());
    for i in 0..n {
        indices.extend(a.row(i).indices.iter().map(|&j| j as usize));
        starts.push(indices.len());
    }
    let pattern = SymbolicSparseColMatRef::<'_, usize>::new_checked(n, n, &starts, None, &indices);
    let mut memory = MemBuffer::try_new(amd::order_scratch::<usize>(n, indices.len())).ok()?;
    let (mut order, mut inverse) = (vec![0; n], vec![0; n]);
    let stack = MemStack::new(&mut memory);
    let count = amd::order(&mut order, &mut inverse, pattern, amd::Control::default(), stack).ok()?;
    Some(Fill { entries: count.n_div + n as f64, operations: count.n_mult_subs_ldl })
}

/// Solves for a right side.
type Applied = dyn Fn(&[f64]) -> Vec<f64>;

/// A matrix in factors.
pub struct Factors {
    solve: Box<Applied>,
    /// Which factors.
    pub method: &'static str,
}

impl Factors {
    /// Factors of A; `None` where there are none.
    #[must_use]
    pub fn new(a: &Matrix) -> Option<Self> {
        let n = a.rows();
        let triplets: Vec<_> = a.triplets().map(|(i, j, value)| Triplet::new(i, j, value)).collect();
        let sparse = SparseColMat::<usize, f64>::try_new_from_triplets(n, n, &triplets).ok()?;
        drop(triplets);
        let column = |b: &[f64]| faer::Col::from_fn(b.len(), |i| b[i]);
        let symmetric = a.is_symmetric() && a.diagonal().iter().all(|&d| d > 0.0);
        if symmetric && let Ok(factors) = sparse.sp_cholesky(Side::Lower) {
            let solve = move |b: &[f64]| factors.solve(column(b)).iter().copied().collect();
            return Some(Self { solve: Box::new(solve), method: "sparse Cholesky" });
        }
        let factors = sparse.sp_lu().ok()?;
        let solve = move |b: &[f64]| factors.solve(column(b)).iter().copied().collect();
        Some(Self { solve: Box::new(solve), method: "sparse LU" })
    }

    /// x of A x = b; not finite where A is singular.
    #[must_use]
    pub fn solve(&self, b: &[f64]) -> Vec<f64> {
        (self.solve)(b)
    }
}
