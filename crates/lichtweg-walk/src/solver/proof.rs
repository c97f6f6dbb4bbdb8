//! What is proven of a system, and the error bounds that follow from it.
//!
//! With v > 0, |M| v <= c v (rows) or u > 0, |M|^T u <= c u (columns), c < 1, the solution of e = M e + f obeys
//!
//! ```text
//! |<g, e>| <= sum_i |g_i| v_i  max_j |f_j| / v_j / (1 - c),      |<g, e>| <= max_i |g_i| / u_i  sum_j u_j |f_j| / (1 - c).
//! ```
//!
//! Where rows sum to at most one, c < 1 may be out of reach. Then w > 0 with (I - |M|) w >= 1 is solved for, and checked:
//! |<g, e>| <= sum_i |g_i| w_i  max_j |f_j|.
//!
//! With f = b and the residual of a push for g, these bound what was left unpushed (the second is the classical one of
//! PageRank, where u = 1 and c is the damping); with the residual of an approximation for f, they bound its error.

use std::sync::OnceLock;

use crate::convergence::{CONTRACTS, Certificate, Radius, spectral_radius};
use crate::{Matrix, System};

/// Entries of matrices that may be used to find out whether walks converge.
const OPERATIONS: usize = 2_000_000_000;
/// Products with the matrix for the same, at most.
const PRODUCTS: usize = 5_000;

/// Certificates of a system, found when they are asked for.
#[derive(Debug, Default)]
pub(super) struct Proof {
    rows: OnceLock<Radius>,
    columns: OnceLock<Radius>,
    column_norm: OnceLock<f64>,
    majorant: OnceLock<Option<Vec<f64>>>,
    source_norm: OnceLock<f64>,
}

impl Proof {
    /// Whether the rows of |M| sum to less than one.
    pub fn rows_contract(&self, system: &System) -> bool {
        system.row_mass().1 < CONTRACTS
    }

    /// Whether the columns of |M| sum to less than one.
    pub fn columns_contract(&self, system: &System) -> bool {
        *self.column_norm.get_or_init(|| {
            let mut sums = vec![0.0; system.unknowns()];
            for i in 0..system.unknowns() {
                system.matrix().row(i).iter().for_each(|(j, value)| sums[j] += value.abs());
            }
            crate::vector::largest(&sums)
        }) < CONTRACTS
    }

    /// rho(|M|), by rows.
    pub fn rows(&self, system: &System) -> &Radius {
        self.rows.get_or_init(|| {
            let (low, high) = system.row_mass();
            if self.rows_contract(system) {
                // The norm was summed up when the system was made.
                let certificate = Some(Certificate { weights: None, contraction: high });
                return Radius { low, high, estimate: high, products: 0, chained: false, certificate };
            }
            spectral_radius(system.matrix(), None, products(system))
        })
    }

    /// rho(|M|), by columns.
    pub fn columns(&self, system: &System) -> &Radius {
        self.columns.get_or_init(|| {
            if self.columns_contract(system) {
                let contraction = self.column_norm.get().copied().unwrap_or(f64::NAN);
                let certificate = Some(Certificate { weights: None, contraction });
                let (low, high) = (0.0, contraction);
                return Radius { low, high, estimate: high, products: 0, chained: false, certificate };
            }
            spectral_radius(system.transposed(), None, products(system))
        })
    }

    /// Whether walks converge; whichever proof is at hand or cheap.
    pub fn converges(&self, system: &System) -> bool {
        self.rows_contract(system) || self.columns_contract(system) || self.rows(system).is_below_one()
    }

    /// w > 0 with (I - |M|) w >= 1, for systems that are known to converge without a certificate by rows. It takes the solution
    /// of a system as large as this one.
    pub fn majorant(&self, system: &System) -> Option<&[f64]> {
        let rows = self.rows(system);
        if rows.certificate.is_some() || !rows.is_below_one() {
            return None;
        }
        self.majorant.get_or_init(|| find_majorant(system)).as_deref()
    }

    /// Takes a majorant from a solver of A y = right, where A is an M-matrix split by its diagonal, and a majorant is wanted.
    #[cfg(feature = "faer")]
    pub fn offer_majorant(&self, system: &System, solve: impl Fn(&[f64]) -> Vec<f64>) {
        let Some(linear) = system.as_linear().filter(|linear| linear.by_diagonal()) else { return };
        let rows = self.rows(system);
        let wanted = rows.certificate.is_none() && rows.is_below_one() && self.by_columns(system).is_none();
        if wanted && linear.matrix == linear.matrix.comparison() {
            let v = solve(&linear.matrix.diagonal());
            if let Ok(majorant) = checked(v, &system.matrix().magnitudes()) {
                let _ = self.majorant.set(Some(majorant));
            }
        }
    }

    /// A bound of all |x_i| at once, where rows sum to less than one.
    pub fn bound_of_each(&self, system: &System) -> Option<f64> {
        let contracts = self.rows_contract(system);
        contracts.then(|| system.summary().largest_source / (1.0 - system.row_mass().1))
    }

    /// A bound of |<g, x>| for the solution of x = M x + b; `None` without a cheap proof. g may name an element twice.
    pub fn bound_of_solution(&self, system: &System, g: impl Iterator<Item = (usize, f64)>) -> Option<f64> {
        if let Some(bound) = self.bound_of_each(system) {
            return Some(bound * g.map(|(_, value)| value.abs()).sum::<f64>());
        }
        if self.columns_contract(system) {
            let contraction = *self.column_norm.get()?;
            let norm = *self.source_norm.get_or_init(|| {
                system.source().iter().map(|value| value.abs()).sum::<f64>() / (1.0 - contraction)
            });
            return Some(norm * g.map(|(_, value)| value.abs()).fold(0.0, f64::max));
        }
        let largest = system.summary().largest_source;
        if let Some(certificate) = &self.rows(system).certificate {
            let norm = *self.source_norm.get_or_init(|| certificate.solution_bound(system.source()));
            return Some(norm * g.map(|(i, value)| value.abs() * certificate.weight(i)).sum::<f64>());
        }
        // Only where it has been found already.
        let majorant = self.majorant.get()?.as_deref()?;
        Some(largest * g.map(|(i, value)| value.abs() * majorant[i]).sum::<f64>())
    }

    /// A norm of the error e of an approximation with the residual `f`, such that |<g, e>| <= norm * [`Proof::weight`] of g;
    /// `None` without a proof.
    pub fn norm_of_error(&self, system: &System, f: &[f64]) -> Option<f64> {
        if let Some(contraction) = self.by_columns(system) {
            return Some(f.iter().map(|value| value.abs()).sum::<f64>() / (1.0 - contraction));
        }
        match &self.rows(system).certificate {
            Some(certificate) => Some(certificate.solution_bound(f)),
            None => self.majorant(system).map(|_| crate::vector::largest(f)),
        }
    }

    /// The factor of g in error bounds.
    pub fn weight(&self, system: &System, g: &[(usize, f64)]) -> f64 {
        if self.by_columns(system).is_some() {
            return g.iter().map(|(_, value)| value.abs()).fold(0.0, f64::max);
        }
        let certificate = self.rows(system).certificate.as_ref();
        let majorant = self.majorant(system);
        let weight = |i: usize| match (certificate, majorant) {
            (Some(certificate), _) => certificate.weight(i),
            (None, majorant) => majorant.map_or(f64::INFINITY, |w| w[i]),
        };
        g.iter().map(|&(i, value)| value.abs() * weight(i)).sum()
    }

    /// Largest column sum, where it is what bounds rest on.
    fn by_columns(&self, system: &System) -> Option<f64> {
        let by_columns = !self.rows_contract(system) && self.columns_contract(system);
        self.column_norm.get().copied().filter(|_| by_columns)
    }
}

fn products(system: &System) -> usize {
    (OPERATIONS / system.matrix().entries().max(1)).clamp(20, PRODUCTS)
}

/// Tries to find a majorant, each to a smaller residual.
const TRIES: u32 = 3;

/// w with (I - |M|) w >= 1.
fn find_majorant(system: &System) -> Option<Vec<f64>> {
    let magnitudes = system.matrix().magnitudes();
    let (a, right) = dominated(system, &magnitudes);
    let mut guess = None;
    for tolerance in (0..TRIES).map(|k| 1e-2 * 0.01_f64.powi(k as i32)) {
        let v = crate::krylov::solve(&a, &right, guess, tolerance, 20_000).x;
        match checked(v, &magnitudes) {
            Ok(majorant) => return Some(majorant),
            Err(v) => guess = Some(v),
        }
    }
    None
}

/// v scaled to a majorant, or v again.
fn checked(mut v: Vec<f64>, magnitudes: &Matrix) -> Result<Vec<f64>, Vec<f64>> {
    let product = magnitudes.multiply(&v);
    let least = v.iter().zip(&product).map(|(v, product)| v - product).fold(f64::INFINITY, f64::min);
    if least > 0.0 && v.iter().all(|&v| v > 0.0 && v.is_finite()) {
        v.iter_mut().for_each(|v| *v /= least);
        Ok(v)
    } else {
        Err(v)
    }
}

/// A system whose solution v has (I - |M|) v near a constant: for symmetric A split by its diagonal D, A with the signs of an
/// M-matrix and D 1, which stays symmetric; else I - |M| and 1.
fn dominated(system: &System, magnitudes: &Matrix) -> (Matrix, Vec<f64>) {
    if let Some(linear) = system.as_linear()
        && linear.by_diagonal()
        && linear.matrix.is_symmetric()
    {
        let diagonal = linear.matrix.diagonal();
        return (linear.matrix.comparison(), diagonal.iter().map(|d| d.abs()).collect());
    }
    (crate::krylov::one_minus(magnitudes), vec![1.0; system.unknowns()])
}
