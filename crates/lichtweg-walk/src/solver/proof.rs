//! What is proven of a system, and the error bounds that follow from it.
//!
//! With v > 0, |M| v <= c v (rows) or u > 0, |M|^T u <= c u (columns), c < 1, the solution of e = M e + f obeys
//!
//! ```text
//! |<g, e>| <= sum_i |g_i| v_i  max_j |f_j| / v_j / (1 - c),      |<g, e>| <= max_i |g_i| / u_i  sum_j u_j |f_j| / (1 - c).
//! ```
//!
//! With f = b and the residual of a push for g, these bound what was left unpushed (the second is the classical one of
//! PageRank, where u = 1 and c is the damping); with the residual of an approximation for f, they bound its error.

use std::sync::OnceLock;

use crate::System;
use crate::convergence::{Certificate, Radius, spectral_radius};

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
    verified: OnceLock<Option<Certificate>>,
    source_norm: OnceLock<f64>,
}

impl Proof {
    /// Whether the rows of |M| sum to less than one.
    pub fn rows_contract(&self, system: &System) -> bool {
        system.row_mass().1 < 1.0
    }

    /// Whether the columns of |M| sum to less than one.
    pub fn columns_contract(&self, system: &System) -> bool {
        *self.column_norm.get_or_init(|| {
            let mut sums = vec![0.0; system.unknowns()];
            for i in 0..system.unknowns() {
                system.matrix().row(i).iter().for_each(|(j, value)| sums[j] += value.abs());
            }
            crate::vector::largest(&sums)
        }) < 1.0
    }

    /// rho(|M|), by rows.
    pub fn rows(&self, system: &System) -> &Radius {
        self.rows.get_or_init(|| {
            let (low, high) = system.row_mass();
            if high < 1.0 {
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

    /// A certificate by rows: one that is at hand, or, where chains of rows prove convergence without a rate, from the
    /// solution of (I - |M|) v = 1, checked.
    pub fn verified(&self, system: &System) -> Option<&Certificate> {
        if let Some(certificate) = &self.rows(system).certificate {
            return Some(certificate);
        }
        if !self.rows(system).is_below_one() {
            return None;
        }
        self.verified.get_or_init(|| verify(system)).as_ref()
    }

    /// A bound of |<g, x>| for the solution of x = M x + b; `None` without a cheap proof. g may name an element twice.
    pub fn bound_of_solution(&self, system: &System, g: impl Iterator<Item = (usize, f64)>) -> Option<f64> {
        if self.rows_contract(system) || !self.columns_contract(system) {
            let certificate = self.rows(system).certificate.as_ref()?;
            let norm = *self.source_norm.get_or_init(|| match certificate.weights {
                None => system.summary().largest_source / (1.0 - certificate.contraction),
                Some(_) => certificate.solution_bound(system.source()),
            });
            return Some(norm * g.map(|(i, value)| value.abs() * certificate.weight(i)).sum::<f64>());
        }
        let contraction = *self.column_norm.get()?;
        let norm = *self.source_norm.get_or_init(|| {
            system.source().iter().map(|value| value.abs()).sum::<f64>() / (1.0 - contraction)
        });
        Some(norm * g.map(|(_, value)| value.abs()).fold(0.0, f64::max))
    }

    /// A bound of |<g, e>| for the error e of an approximation with the residual `f`; `None` without a proof.
    pub fn bound_of_error(&self, system: &System, g: &[(usize, f64)], f: &[f64]) -> Option<f64> {
        if !self.rows_contract(system) && self.columns_contract(system) {
            let contraction = *self.column_norm.get()?;
            let total: f64 = f.iter().map(|value| value.abs()).sum();
            return Some(
                g.iter().map(|(_, value)| value.abs()).fold(0.0, f64::max) * total / (1.0 - contraction),
            );
        }
        let certificate = self.verified(system)?;
        let weight: f64 = g.iter().map(|&(i, value)| value.abs() * certificate.weight(i)).sum();
        Some(weight * certificate.solution_bound(f))
    }
}

fn products(system: &System) -> usize {
    (OPERATIONS / system.matrix().entries().max(1)).clamp(20, PRODUCTS)
}

/// v of (I - |M|) v = 1, if it proves anything.
fn verify(system: &System) -> Option<Certificate> {
    let magnitudes = system.matrix().magnitudes();
    let ones = vec![1.0; system.unknowns()];
    let a = crate::krylov::one_minus(&magnitudes);
    let found = crate::krylov::solve(&a, &ones, None, 1e-3, 100_000);
    let largest = crate::vector::largest(&found.x);
    let product = magnitudes.multiply(&found.x);
    let ratio = |(v, product): (&f64, &f64)| if *v > 0.0 { product / v } else { f64::INFINITY };
    let contraction = found.x.iter().zip(&product).map(ratio).fold(0.0, f64::max);
    (contraction < 1.0).then(|| {
        let weights = found.x.iter().map(|v| v / largest).collect();
        Certificate { weights: Some(weights), contraction }
    })
}
