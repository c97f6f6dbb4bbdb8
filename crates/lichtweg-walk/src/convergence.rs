//! Whether walks converge: the spectral radius of |K|, and that of the variance matrix, between proven bounds.
//!
//! Walks see |K|: their mean is finite where rho(|K|) < 1, even though the Neumann series needs rho(K) < 1 only. Their
//! variance is finite where rho(V) < 1 with V_ij = K_ij^2 / p_ij (Ji, Mascagni, Li, *Convergence analysis of Markov chain
//! Monte Carlo linear solvers using Ulam-von Neumann algorithm*, SIAM J. Numer. Anal. 51(4), 2013). For the proportional
//! choice that is V = diag(max(1, m)) |K| with absorption, diag(m) |K| without.
//!
//! Bounds are those of Collatz (1942) and Wielandt (1950): for any v >= 0,
//!
//! ```text
//! min over v_i > 0 of (A v)_i / v_i  <=  rho(A),     and if all v_i > 0,     rho(A)  <=  max (A v)_i / v_i.
//! ```
//!
//! The upper bound is taken at v = 1 + A 1 + ... + A^(k-1) 1, which is positive for every A and certifies rho(A) < 1 as soon
//! as all elements of A^k 1 are below 1: in the end, whenever it is true. Rounding is not part of the proof.
//!
//! Where no row sums to more than one, it is enough that from each state a row can be reached that sums to less (weakly
//! chained diagonal dominance; Shivakumar and Chew 1974). That proves rho(A) < 1 without saying by how much.

use rayon::prelude::*;

use crate::Matrix;
use crate::vector::sum as sum_of;

/// What is known about the spectral radius of a non-negative matrix A = diag(scale) |K|.
#[derive(Clone, Debug)]
pub struct Radius {
    /// Proven lower bound.
    pub low: f64,
    /// Proven upper bound.
    pub high: f64,
    /// Best guess, from the growth of A^k 1.
    pub estimate: f64,
    /// Products with the matrix that were made.
    pub products: usize,
    /// Whether chains of rows prove that it is below 1, although `high` does not.
    pub chained: bool,
    /// v > 0 with A v <= contraction v, where `high` is below 1.
    pub certificate: Option<Certificate>,
}

/// A proof that rho(A) < 1, and the key to error bounds: |(I - A)^-1 f| <= v max(|f_i| / v_i) / (1 - contraction).
#[derive(Clone, Debug)]
pub struct Certificate {
    /// v, scaled to a largest element of 1; `None` stands for ones.
    pub weights: Option<Vec<f64>>,
    /// Largest (A v)_i / v_i, below 1.
    pub contraction: f64,
}

impl Radius {
    /// Whether it is proven to be below 1.
    #[must_use]
    pub fn is_below_one(&self) -> bool {
        self.certificate.is_some() || self.chained
    }

    /// Whether it is 1 or more: proven, or by all that is seen of it.
    #[must_use]
    pub fn is_at_least_one(&self) -> bool {
        self.low >= 1.0 || (!self.is_below_one() && self.estimate >= 1.0 - 1e-9)
    }
}

impl Certificate {
    /// v_i.
    #[inline]
    #[must_use]
    pub fn weight(&self, i: usize) -> f64 {
        self.weights.as_ref().map_or(1.0, |weights| weights[i])
    }

    /// Largest |f_i| / v_i.
    #[must_use]
    pub fn norm(&self, f: &[f64]) -> f64 {
        f.par_iter()
            .with_min_len(4096)
            .enumerate()
            .map(|(i, f)| f.abs() / self.weight(i))
            .reduce(|| 0.0, f64::max)
    }

    /// C such that |x_i| <= C v_i for the solution of x = A x + f.
    #[must_use]
    pub fn solution_bound(&self, f: &[f64]) -> f64 {
        self.norm(f) / (1.0 - self.contraction)
    }
}

/// Bounds the spectral radius of diag(scale) |K|, by at most `products` products with the matrix; stops as soon as it is
/// known on which side of 1 it is.
#[must_use]
pub fn spectral_radius(matrix: &Matrix, scale: Option<&[f64]>, products: usize) -> Radius {
    let n = matrix.rows();
    let masses: Vec<f64> = row_masses(matrix, scale);
    let high = masses.par_iter().copied().reduce(|| 0.0, f64::max);
    let low = masses.par_iter().copied().reduce(|| f64::INFINITY, f64::min);
    let low = if n == 0 { 0.0 } else { low };
    let mut radius = Radius { low, high, estimate: f64::NAN, products: 1, chained: false, certificate: None };
    if high < CONTRACTS {
        radius.estimate = high;
        radius.certificate = Some(Certificate { weights: None, contraction: high });
        return radius;
    }
    if high <= 1.0 + 1e-12 {
        radius.chained = all_reach_a_loss(matrix, &masses);
    }
    // Where it is proven, a guess will do.
    let products = if radius.chained { products.min(GUESS) } else { products };
    iterate(matrix, scale, masses, products, &mut radius);
    radius
}

/// Row sums that are below one by no more than this may be so by rounding: six times 1/6 is less than one.
pub(crate) const CONTRACTS: f64 = 1.0 - 1e-9;

/// Largest element of A^k 1 that makes a certificate: error bounds grow as one over what it lacks to one.
const GOOD: f64 = 0.9;

/// Products to guess a radius by, where it is known to be below 1.
const GUESS: usize = 32;

/// Row sums of diag(scale) |K|.
fn row_masses(matrix: &Matrix, scale: Option<&[f64]>) -> Vec<f64> {
    matrix.map_rows(|i| matrix.row(i).mass() * scale.map_or(1.0, |scale| scale[i]))
}

/// Power iteration from A 1, with v = sum A^k 1 alongside.
fn iterate(matrix: &Matrix, scale: Option<&[f64]>, first: Vec<f64>, products: usize, radius: &mut Radius) {
    let n = first.len();
    // `power` is A^k 1 times `unit`, `sum` is 1 + ... + A^(k-1) 1.
    let (mut power, mut sum) = (first, vec![1.0; n]);
    let mut next = vec![0.0; n];
    let mut largest = 1.0_f64;
    while radius.products < products {
        sum.par_iter_mut().with_min_len(4096).zip(&power).for_each(|(sum, power)| *sum += power);
        next.par_iter_mut().with_min_len(1024).enumerate().for_each(|(i, out)| {
            let product: f64 = matrix.row(i).iter().map(|(j, value)| value.abs() * power[j]).sum();
            *out = product * scale.map_or(1.0, |scale| scale[i]);
        });
        radius.products += 1;
        let top = next.par_iter().copied().reduce(|| 0.0, f64::max);
        // At the threshold of 1 / n: states that matter, in a matrix that may fall into classes.
        for threshold in [0.0, 0.1] {
            let floor = threshold * power.par_iter().copied().reduce(|| 0.0, f64::max);
            let bound = lower_bound(matrix, scale, &power, &next, floor);
            radius.low = radius.low.max(bound);
        }
        let growth = sum_of(&next) / sum_of(&power);
        radius.estimate = if growth.is_finite() { growth } else { 0.0 };
        // (A v)_i / v_i = 1 + (A^k 1 - 1)_i / v_i for the sum up to k - 1; now for the sum up to k.
        let high =
            next.par_iter().zip(&sum).map(|(next, sum)| 1.0 + (next - 1.0) / sum).reduce(|| 0.0, f64::max);
        radius.high = radius.high.min(high);
        std::mem::swap(&mut power, &mut next);
        largest = largest.max(top);
        // A bound that is barely below one is worth little: some more products make it a good one.
        let last = radius.products + 1 >= products;
        if top < GOOD || (top < CONTRACTS && last && !radius.chained) {
            let scale = 1.0 / sum.par_iter().copied().reduce(|| 0.0, f64::max);
            let weights = sum.par_iter().map(|sum| sum * scale).collect();
            radius.certificate = Some(Certificate { weights: Some(weights), contraction: high });
            radius.estimate = radius.estimate.min(radius.high).max(radius.low);
            return;
        }
        if radius.low >= 1.0 || largest > 1e200 {
            break;
        }
    }
    radius.estimate = radius.estimate.max(radius.low).min(radius.high);
}

/// Collatz and Wielandt's lower bound at v, restricted to where it is above `floor`; `product` is A v.
fn lower_bound(matrix: &Matrix, scale: Option<&[f64]>, v: &[f64], product: &[f64], floor: f64) -> f64 {
    let ratio = |i: usize| {
        if v[i] <= floor {
            return f64::INFINITY;
        }
        if floor == 0.0 {
            return product[i] / v[i];
        }
        let kept = matrix.row(i).iter().filter(|&(j, _)| v[j] > floor).map(|(j, value)| value.abs() * v[j]);
        kept.sum::<f64>() * scale.map_or(1.0, |scale| scale[i]) / v[i]
    };
    let low = (0..v.len()).into_par_iter().with_min_len(1024).map(ratio).reduce(|| f64::INFINITY, f64::min);
    if low.is_finite() { low } else { 0.0 }
}

/// Whether from every state a row that sums to less than one can be reached.
fn all_reach_a_loss(matrix: &Matrix, masses: &[f64]) -> bool {
    // Backwards from the lossy rows, along the edges turned round.
    let mut reached: Vec<bool> = masses.iter().map(|&mass| mass < 1.0 - 1e-12).collect();
    if reached.iter().all(|&r| !r) {
        return false;
    }
    let turned = matrix.transposed();
    let mut waiting: Vec<usize> = (0..masses.len()).filter(|&i| reached[i]).collect();
    while let Some(i) = waiting.pop() {
        for (j, _) in turned.row(i).iter() {
            if !std::mem::replace(&mut reached[j], true) {
                waiting.push(j);
            }
        }
    }
    reached.iter().all(|&r| r)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dense(rows: &[&[f64]]) -> Matrix {
        let entries = rows
            .iter()
            .enumerate()
            .flat_map(|(i, row)| row.iter().enumerate().map(move |(j, &value)| (i as u32, j as u32, value)));
        Matrix::from_triplets(rows.len(), rows.len(), &entries.collect::<Vec<_>>()).unwrap()
    }

    #[test]
    fn bounds_hold_the_radius() {
        // Eigenvalues of [[a, b], [c, d]] in closed form.
        for (a, b, c, d) in
            [(0.5_f64, 1.2, 0.1, 0.3), (0.0, 2.0, 0.3, 0.1), (0.9, 0.0, 5.0, 0.2), (0.9, 3.0, 0.0, 1.1)]
        {
            let exact = 0.5 * (a + d) + (0.25 * (a - d).powi(2) + b * c).sqrt();
            let radius = spectral_radius(&dense(&[&[a, -b], &[c, d]]), None, 500);
            assert!(radius.low <= exact + 1e-12 && exact <= radius.high + 1e-12, "{exact} {radius:?}");
            assert_eq!(radius.is_below_one(), exact < 1.0, "{exact} {radius:?}");
            assert_eq!(radius.is_at_least_one(), exact >= 1.0, "{exact} {radius:?}");
            if let Some(certificate) = radius.certificate {
                assert!(certificate.contraction < 1.0);
            }
        }
    }

    #[test]
    fn scaling_is_part_of_the_matrix() {
        let matrix = dense(&[&[0.0, 0.9], &[0.9, 0.0]]);
        assert!(spectral_radius(&matrix, Some(&[1.2, 1.2]), 500).is_at_least_one());
        assert!(spectral_radius(&matrix, Some(&[1.2, 1.0]), 500).is_below_one());
    }

    #[test]
    fn chains_of_rows_prove_what_the_norm_does_not() {
        let line: Vec<_> = (0..500_u32)
            .flat_map(|i| [(i, i.wrapping_sub(1), 0.5), (i, i + 1, 0.5)])
            .filter(|&(_, j, _)| j < 500)
            .collect();
        let radius = spectral_radius(&Matrix::from_triplets(500, 500, &line).unwrap(), None, 10);
        assert!(radius.chained && radius.is_below_one() && radius.certificate.is_none());
        let closed = dense(&[&[0.0, 1.0, 0.0], &[1.0, 0.0, 0.0], &[0.0, 0.0, 0.5]]);
        let radius = spectral_radius(&closed, None, 10);
        assert!(!radius.is_below_one() && radius.is_at_least_one(), "{radius:?}");
    }

    #[test]
    fn rounding_is_no_loss() {
        // Six neighbours on a ring, each 1/6: nothing is ever lost, though the rows sum to less than one.
        let n = 12;
        let steps = [1, 2, 3, 9, 10, 11];
        let ring: Vec<_> = (0..n).flat_map(|i| steps.map(|step| (i, (i + step) % n, 1.0 / 6.0))).collect();
        let ring = Matrix::from_triplets(n as usize, n as usize, &ring).unwrap();
        assert!(ring.row(0).mass() < 1.0);
        let radius = spectral_radius(&ring, None, 500);
        assert!(!radius.is_below_one() && radius.is_at_least_one(), "{radius:?}");
    }

    #[test]
    fn empty_and_zero_matrices_contract() {
        for n in [0, 1, 3] {
            assert!(spectral_radius(&Matrix::from_triplets(n, n, &[]).unwrap(), None, 5).is_below_one());
        }
    }
}
