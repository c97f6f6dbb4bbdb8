//! Sparse factorisation by `faer`: Cholesky where the matrix is symmetric and positive definite, LU elsewhere.

use faer::Side;
use faer::linalg::solvers::Solve;
use faer::sparse::{SparseColMat, Triplet};

use crate::Matrix;
use crate::krylov::Solution;
use crate::vector::{length, update};

/// Solves A x = b; `None` where the factorisation fails.
#[must_use]
pub fn solve(a: &Matrix, b: &[f64]) -> Option<Solution> {
    let n = a.rows();
    let triplets: Vec<_> = a.triplets().map(|(i, j, value)| Triplet::new(i, j, value)).collect();
    let sparse = SparseColMat::<usize, f64>::try_new_from_triplets(n, n, &triplets).ok()?;
    drop(triplets);
    let right = faer::Col::from_fn(n, |i| b[i]);
    let symmetric = a.is_symmetric() && a.diagonal().iter().all(|&d| d > 0.0);
    let cholesky = if symmetric { sparse.sp_cholesky(Side::Lower).ok() } else { None };
    let (x, method) = match cholesky {
        Some(factors) => (factors.solve(&right), "sparse Cholesky"),
        None => (sparse.sp_lu().ok()?.solve(&right), "sparse LU"),
    };
    let x: Vec<f64> = x.iter().copied().collect();
    let mut left = a.multiply(&x);
    update(&mut left, b, |ax, b| b - ax);
    let residual = length(&left) / length(b);
    residual.is_finite().then_some(Solution { x, residual, products: 1, method })
}
