//! Why there is no number, and what would help.

use crate::System;
use crate::convergence::{Radius, spectral_radius};
use crate::system::{Linear, Splitting};
use crate::walk::WalkError;

/// Why there is no number.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// rho(|M|) is 1 or more, or could not be shown to be less.
    #[error(
        "walks do not converge: rho(|M|), the spectral radius of the matrix of magnitudes, {radius}.\n{advice}"
    )]
    Diverges {
        /// What is known of it.
        radius: String,
        /// What would help.
        advice: String,
    },
    /// The mean of walks is right, but their variance is not finite.
    #[error(
        "walks of this choice have infinite variance: the spectral radius of the variance matrix {radius}.\nLet walks choose by --choice auto or perron, which have a finite one."
    )]
    InfiniteVariance {
        /// What is known of it.
        radius: String,
    },
    /// There is no such unknown.
    #[error("there is no unknown {unknown} (from 0): the system has {unknowns}")]
    OutOfRange {
        /// The unknown, from 0.
        unknown: usize,
        /// How many there are.
        unknowns: usize,
    },
    /// Walks failed.
    #[error(transparent)]
    Walk(#[from] WalkError),
    /// Walks gave scores that no interval can be made of.
    #[error(
        "{scored} of {walks} walks scored: too few to believe any interval. Take the adjoint direction, push or bidirectional, where walks start at the unknown, or allow more steps"
    )]
    NotBelieved {
        /// Walks made.
        walks: u64,
        /// Walks that scored.
        scored: u64,
    },
    /// Bounds of push rest on a certificate that could not be found.
    #[error(
        "push has no proven bound here: that rho(|M|) < 1 is known, but not by how much. Take walks or the deterministic solver"
    )]
    NoCertificate,
    /// The deterministic solver did not converge.
    #[error(
        "the deterministic solver came to a relative residual of {residual:.1e} only: the system is singular or nearly so, or \
         too hard for a Krylov method; --method direct factorises it"
    )]
    NotSolved {
        /// The residual it came to.
        residual: f64,
    },
    /// The program was built without a sparse factorisation.
    #[error(
        "this program was built without a sparse factorisation (cargo build --release --features faer); --method deterministic \
         solves by Krylov iterations"
    )]
    NoFactorisation,
    /// Factors that do not fit.
    #[error(
        "factors of this matrix have about {entries:.1e} entries, which is more than fits; --method deterministic needs no factors"
    )]
    TooMuchFill {
        /// Entries of the factors.
        entries: f64,
    },
    /// Someone asked to end ([`Watch::stop`](super::Watch::stop)).
    #[error("stopped")]
    Stopped,
    /// A parameter makes no sense.
    #[error("{0}")]
    Parameter(String),
}

impl Refusal {
    /// Of a system whose |M| is too large.
    pub(super) fn diverges(system: &System, radius: &Radius) -> Self {
        Self::Diverges { radius: describe(radius), advice: advice(system) }
    }
}

/// A radius in words.
pub(super) fn describe(radius: &Radius) -> String {
    if radius.low >= 1.0 {
        format!("is at least {:.6}", radius.low)
    } else if radius.is_at_least_one() {
        format!("is 1 or more by all that is seen (between {:.6} and {:.6})", radius.low, radius.high)
    } else {
        let products = radius.products;
        format!("could not be shown to be below 1 in {products} products (about {:.6})", radius.estimate)
    }
}

/// Systems up to this size are tried with other splittings.
const TRIED: usize = 2_000_000;

fn advice(system: &System) -> String {
    let Some(linear) = system.as_linear() else {
        return "If the system came from A x = b, give A and b: other splittings may converge. A deterministic solver does \
                not need rho(|M|) < 1: --method deterministic."
            .to_owned();
    };
    let fits = linear.matrix.entries() <= TRIED;
    if linear.splitting != Splitting::default() {
        let radius = fits.then(|| radius_of(linear, Splitting::default())).flatten();
        return match radius {
            Some(radius) => format!(
                "Jacobi's splitting without damping converges (rho(|M|) <= {radius:.4}): --splitting jacobi. Or take --method \
                 deterministic, which does not need it."
            ),
            None => "Try --splitting jacobi, or block:SIZE, without --damping. Or take --method deterministic, which does not \
                     need rho(|M|) < 1."
                .to_owned(),
        };
    }
    let mut advice = String::from(
        "A smaller damping cannot help (|1 - w| + w rho >= 1 for rho >= 1), and a matrix whose rows are not dominated by their \
         diagonal needs another splitting or preconditioning. ",
    );
    let helps = |size| Some((size, radius_of(linear, Splitting::BlockJacobi { size, damping: 1.0 })?));
    match [2, 4, 8, 16, 32].into_iter().filter(|_| fits).find_map(helps) {
        Some((size, radius)) => {
            advice += &format!(
                "Block Jacobi with blocks of {size} converges (rho(|M|) <= {radius:.4}): --splitting block:{size}. "
            );
        }
        None => {
            advice +=
                "Block Jacobi with blocks of 2 to 32 does not converge either, or was too large to try. "
        }
    }
    advice + "Or take --method deterministic, which does not need it."
}

/// A bound of rho(|M|) below 1 of another splitting, where there is one.
fn radius_of(linear: &Linear, splitting: Splitting) -> Option<f64> {
    let system = System::linear(&linear.matrix, &linear.right_side, splitting).ok()?;
    let radius = spectral_radius(system.matrix(), None, 200);
    radius.is_below_one().then_some(radius.high)
}
