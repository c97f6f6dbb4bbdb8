//! A page that shows particles on a small chain: created, on their way, and ended; with the exact equilibrium beside the
//! counts.

use std::path::Path;

use lichtweg_walk::krylov;
use serde_json::json;

use super::input::{SystemInput, write_text};
use crate::failure::Failure;

/// More states than this do not fit on a page.
const MOST_STATES: usize = 60;

/// Writes the page.
pub fn write(input: &SystemInput, path: &Path, seed: u64) -> Result<(), Failure> {
    let system = &input.system;
    let n = system.unknowns();
    if n > MOST_STATES {
        let message = format!("the page shows at most {MOST_STATES} states, not {n}");
        return Err(Failure::Failed(message));
    }
    if !system.is_nonnegative() || system.source().iter().sum::<f64>() <= 0.0 {
        return Err(Failure::Failed(
            "particles are shown for M and b without negative elements, and b not zero".into(),
        ));
    }
    let transitions = system.transposed();
    if let Some(state) = (0..n).find(|&i| transitions.row(i).mass() > 1.0 + 1e-9) {
        let message = format!(
            "column {} of M sums to {:.3}: particles would have to multiply, which the page does not show",
            state + 1,
            transitions.row(state).mass()
        );
        return Err(Failure::Failed(message));
    }
    let exact = krylov::solve(&krylov::one_minus(system.matrix()), system.source(), None, 1e-12, 10_000);
    if exact.residual > 1e-6 {
        return Err(Failure::Failed("the equilibrium does not exist: some particles would never end".into()));
    }
    let total: f64 = system.source().iter().sum();
    let rows: Vec<Vec<(usize, f64)>> = (0..n).map(|i| transitions.row(i).iter().collect()).collect();
    let data = json!({
        "creation": system.source().iter().map(|b| b / total).collect::<Vec<f64>>(),
        "transitions": rows,
        "equilibrium": exact.x.iter().map(|x| x / total).collect::<Vec<f64>>(),
        "seed": seed,
    });
    write_text(path, &include_str!("particles.html").replace("\"DATA\"", &data.to_string()))
}
