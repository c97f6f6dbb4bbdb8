//! Deterministic solvers for the whole vector: conjugate gradients where the matrix is symmetric and positive definite,
//! stabilised bi-conjugate gradients elsewhere (Saad, *Iterative methods for sparse linear systems*, 2nd ed., algorithms 9.1
//! and 7.7), preconditioned by the diagonal.
//!
//! They are what walks have to beat for one unknown, and what is right for all of them.

use crate::Matrix;
use crate::vector::{dot, length, update};

/// A solution and how good it is.
#[derive(Clone, Debug)]
pub struct Solution {
    /// x.
    pub x: Vec<f64>,
    /// |b - A x| / |b|, Euclidean, recomputed at the end.
    pub residual: f64,
    /// Products with the matrix.
    pub products: usize,
    /// Name of the method.
    pub method: &'static str,
}

/// Solves A x = b from a first guess until the residual is `tolerance` times |b|, by at most `products` products.
/// The best x so far is returned where that is not reached.
#[must_use]
pub fn solve(a: &Matrix, b: &[f64], guess: Option<Vec<f64>>, tolerance: f64, products: usize) -> Solution {
    let x = guess.unwrap_or_else(|| vec![0.0; b.len()]);
    let size = length(b);
    if size == 0.0 {
        return Solution { x: vec![0.0; b.len()], residual: 0.0, products: 0, method: "zero" };
    }
    let diagonal = a.diagonal();
    let inverse: Vec<f64> = diagonal.iter().map(|&d| if d == 0.0 { 1.0 } else { 1.0 / d }).collect();
    let mut used = 0;
    if diagonal.iter().all(|&d| d > 0.0) && a.is_symmetric() {
        let (found, products_used) =
            conjugate_gradients(a, b, x.clone(), &inverse, tolerance * size, products);
        used = products_used;
        if let Some(x) = found {
            return finish(a, b, x, used, "conjugate gradients");
        }
    }
    let (x, more) = stabilised(a, b, x, &inverse, tolerance * size, products.saturating_sub(used));
    finish(a, b, x, used + more, "BiCGSTAB")
}

/// A solution with its residual, which is infinite where it is not finite.
pub(crate) fn finish(a: &Matrix, b: &[f64], x: Vec<f64>, products: usize, method: &'static str) -> Solution {
    let mut left = a.multiply(&x);
    update(&mut left, b, |ax, b| b - ax);
    let residual = length(&left) / length(b);
    Solution {
        residual: if residual.is_finite() { residual } else { f64::INFINITY },
        x,
        products: products + 1,
        method,
    }
}

/// `None` where the matrix turns out not to be positive definite.
fn conjugate_gradients(
    a: &Matrix,
    b: &[f64],
    mut x: Vec<f64>,
    inverse: &[f64],
    target: f64,
    products: usize,
) -> (Option<Vec<f64>>, usize) {
    let mut r = a.multiply(&x);
    update(&mut r, b, |ax, b| b - ax);
    let mut z = r.clone();
    update(&mut z, inverse, |r, d| r * d);
    let mut p = z.clone();
    let mut q = vec![0.0; b.len()];
    let mut rz = dot(&r, &z);
    for used in 1..=products {
        if length(&r) <= target {
            return (Some(x), used);
        }
        a.multiply_into(&p, &mut q);
        let curvature = dot(&p, &q);
        if curvature <= 0.0 || !curvature.is_finite() {
            return (None, used);
        }
        let step = rz / curvature;
        update(&mut x, &p, |x, p| x + step * p);
        update(&mut r, &q, |r, q| r - step * q);
        z.copy_from_slice(&r);
        update(&mut z, inverse, |r, d| r * d);
        let next = dot(&r, &z);
        let turn = next / rz;
        update(&mut p, &z, |p, z| z + turn * p);
        rz = next;
    }
    (Some(x), products)
}

fn stabilised(
    a: &Matrix,
    b: &[f64],
    mut x: Vec<f64>,
    inverse: &[f64],
    target: f64,
    products: usize,
) -> (Vec<f64>, usize) {
    let preconditioned = |v: &[f64]| {
        let mut out = v.to_vec();
        update(&mut out, inverse, |v, d| v * d);
        out
    };
    let left = |x: &[f64]| {
        let mut r = a.multiply(x);
        update(&mut r, b, |ax, b| b - ax);
        r
    };
    let mut r = left(&x);
    let (mut shadow, mut p) = (r.clone(), r.clone());
    let mut rho = dot(&shadow, &r);
    let (mut best, mut best_length) = (x.clone(), length(&r));
    let mut length_at_restart = f64::INFINITY;
    let mut used = 1;
    while used + 2 <= products && best_length > target {
        let y = preconditioned(&p);
        let v = a.multiply(&y);
        let alpha = rho / dot(&shadow, &v);
        update(&mut r, &v, |r, v| r - alpha * v);
        let z = preconditioned(&r);
        let t = a.multiply(&z);
        used += 2;
        let omega = match dot(&t, &t) {
            0.0 => 0.0,
            tt => dot(&t, &r) / tt,
        };
        update(&mut x, &y, |x, y| x + alpha * y);
        update(&mut x, &z, |x, z| x + omega * z);
        update(&mut r, &t, |r, t| r - omega * t);
        let size = length(&r);
        if size < best_length {
            best_length = size;
            best.copy_from_slice(&x);
        }
        let next = dot(&shadow, &r);
        let turn = (next / rho) * (alpha / omega);
        if size.is_finite() && turn.is_finite() && turn != 0.0 {
            update(&mut p, &v, |p, v| p - omega * v);
            update(&mut p, &r, |p, r| r + turn * p);
            rho = next;
            continue;
        }
        // Broken down: once more from the best so far, as long as that gets anywhere.
        if best_length >= length_at_restart {
            break;
        }
        length_at_restart = best_length;
        x.copy_from_slice(&best);
        r = left(&x);
        used += 1;
        (shadow, p) = (r.clone(), r.clone());
        rho = dot(&shadow, &r);
    }
    (best, used)
}

/// Iterates x = M x + b from a guess, until the residual b + M x - x is `tolerance` times |b|. Slow, but where rho(|M|) < 1 it
/// cannot fail.
#[must_use]
pub fn fixed_point(m: &Matrix, b: &[f64], mut x: Vec<f64>, tolerance: f64, products: usize) -> Solution {
    let size = length(b);
    let mut next = vec![0.0; b.len()];
    let mut residual = f64::INFINITY;
    let mut used = 0;
    while used < products && residual > tolerance {
        m.multiply_into(&x, &mut next);
        update(&mut next, b, |mx, b| mx + b);
        update(&mut x, &next, |x, next| next - x);
        residual = length(&x) / size;
        x.copy_from_slice(&next);
        used += 1;
    }
    let residual = if residual.is_nan() { f64::INFINITY } else { residual };
    Solution { x, residual, products: used, method: "fixed point iteration" }
}

/// I - M.
#[must_use]
pub fn one_minus(m: &Matrix) -> Matrix {
    let n = m.rows();
    let (mut offsets, mut indices) = (Vec::with_capacity(n + 1), Vec::with_capacity(m.entries() + n));
    let mut values = Vec::with_capacity(m.entries() + n);
    offsets.push(0);
    for i in 0..n {
        let row = m.row(i);
        let (mut diagonal, at) = (1.0, row.indices.partition_point(|&j| (j as usize) < i));
        let own = row.indices.get(at) == Some(&(i as u32));
        if own {
            diagonal -= row.values[at];
        }
        indices.extend_from_slice(&row.indices[..at]);
        values.extend(row.values[..at].iter().map(|value| -value));
        indices.push(i as u32);
        values.push(diagonal);
        indices.extend_from_slice(&row.indices[at + usize::from(own)..]);
        values.extend(row.values[at + usize::from(own)..].iter().map(|value| -value));
        offsets.push(values.len());
    }
    Matrix::from_csr(n, n, offsets, indices, values).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(a: &Matrix, method: &str) {
        let exact: Vec<f64> = (0..a.rows()).map(|i| (i as f64).sin()).collect();
        let b = a.multiply(&exact);
        let found = solve(a, &b, None, 1e-12, 10_000);
        assert_eq!(found.method, method);
        assert!(found.residual < 1e-11, "{found:?}");
        assert!(found.x.iter().zip(&exact).all(|(x, e)| (x - e).abs() < 1e-8));
    }

    #[test]
    fn solvers_solve() {
        let n = 50_u32;
        let line = |left: f64, right: f64| {
            let entries = (0..n).flat_map(|i| [(i, i.wrapping_sub(1), left), (i, i, 2.5), (i, i + 1, right)]);
            let entries: Vec<_> = entries.filter(|&(_, j, _)| j < n).collect();
            Matrix::from_triplets(n as usize, n as usize, &entries).unwrap()
        };
        check(&line(-1.0, -1.0), "conjugate gradients");
        check(&line(-0.3, 1.7), "BiCGSTAB");
        // Symmetric, but with eigenvalues of both signs.
        let indefinite =
            Matrix::from_triplets(2, 2, &[(0, 0, 1.0), (0, 1, 2.0), (1, 0, 2.0), (1, 1, 1.0)]).unwrap();
        check(&indefinite, "BiCGSTAB");
    }

    #[test]
    fn one_minus_keeps_its_diagonal() {
        let m = Matrix::from_triplets(2, 2, &[(0, 0, 0.25), (0, 1, 0.5), (1, 0, -3.0)]).unwrap();
        let a = one_minus(&m);
        assert_eq!([a.get(0, 0), a.get(0, 1), a.get(1, 0), a.get(1, 1)], [0.75, -0.5, 3.0, 1.0]);
    }
}
