//! All unknowns by walks: sequential Monte Carlo.
//!
//! With an approximation y of x = M x + b, the correction solves d = M d + f with the residual f = b + M y - y. Walks from f
//! estimate all of d at once, by depositing their weight wherever they come; the corrected y has a smaller residual, and so
//! each stage's walks have less left to do: the error falls geometrically instead of as 1/sqrt(n) (Halton, *Sequential Monte
//! Carlo*, 1962 and 1994). A sweep of the fixed point iteration before each stage smooths what walks leave rough: Monte
//! Carlo synthetic acceleration (Evans, Mosher, Slattery, Hamilton 2014).
//!
//! The residual is known exactly at each stage, so the result needs no statistics.

use lichtweg_montecarlo::hash::combine;
use lichtweg_montecarlo::{Sampler, SamplerKind};
use rayon::prelude::*;

use crate::System;
use crate::vector::{largest, length, update};
use crate::walk::{Kernel, Selection, Start, WalkError};

/// All unknowns.
#[derive(Clone, Debug)]
pub struct Vector {
    /// x.
    pub x: Vec<f64>,
    /// |b + M x - x| / |b|, Euclidean.
    pub residual: f64,
    /// Stages.
    pub stages: u32,
    /// Walks.
    pub walks: u64,
    /// Transitions of walks.
    pub steps: u64,
}

/// Stages that make nothing better, at most in a row: the residual is then as small as rounding allows, or walks do not help.
const IN_VAIN: u32 = 5;
/// Walks of one task, and tasks whose deposits are kept at a time.
const CHUNK: u64 = 1024;
const GROUP: usize = 64;

/// Solves until `is_enough` of the vector so far and its residual b + M x - x, or for at most `stages` stages of `walks` walks
/// each. A stage that makes the residual larger is undone, and followed by one of twice as many walks.
///
/// # Errors
/// Walks that do not end.
pub fn solve(
    system: &System,
    mut is_enough: impl FnMut(&Vector, &[f64]) -> bool,
    stages: u32,
    walks: u64,
    seed: u64,
) -> Result<Vector, WalkError> {
    let kernel = Kernel::new(system.transposed(), Selection::Proportional);
    let n = system.unknowns();
    let size = length(system.source());
    let mut out = Vector { x: vec![0.0; n], residual: 1.0, stages: 0, walks: 0, steps: 0 };
    let mut residual = system.source().to_vec();
    let mut walks = walks.max(1);
    let most = walks.saturating_mul(64);
    let mut in_vain = 0;
    while size > 0.0 && !is_enough(&out, &residual) && out.stages < stages && in_vain < IN_VAIN {
        // One sweep, whose residual the walks get.
        let mut y = out.x.clone();
        update(&mut y, &residual, |y, f| y + f);
        let rough = system.residual(&y);
        let start = Start::by(rough.iter().copied().enumerate())?;
        if let Some(start) = start {
            let seed = combine(seed, u64::from(out.stages));
            out.steps += stage(&kernel, &start, seed, walks, &mut y)?;
            out.walks += walks;
        }
        out.stages += 1;
        let next = system.residual(&y);
        let relative = length(&next) / size;
        if relative < out.residual {
            if relative > 0.5 * out.residual {
                walks = walks.saturating_mul(2).min(most);
            }
            (out.x, residual, out.residual) = (y, next, relative);
            in_vain = 0;
        } else {
            walks = walks.saturating_mul(2);
            in_vain += 1;
            if !largest(&out.x).is_finite() {
                return Err(WalkError::Overflow);
            }
        }
    }
    if size == 0.0 {
        out.residual = 0.0;
    }
    Ok(out)
}

/// Adds to `y` what the walks of one stage deposit on average, in the order of the walks; number of transitions.
fn stage(kernel: &Kernel<'_>, start: &Start, seed: u64, walks: u64, y: &mut [f64]) -> Result<u64, WalkError> {
    let chunk = |chunk: u64| {
        let mut deposits = Vec::new();
        for walk in chunk * CHUNK..walks.min((chunk + 1) * CHUNK) {
            let sampler = Sampler::new(SamplerKind::Independent, seed, walk >> 32, walk as u32);
            deposit(kernel, start, sampler, &mut deposits)?;
        }
        Ok(deposits)
    };
    let scale = 1.0 / walks as f64;
    let (chunks, mut visits) = (walks.div_ceil(CHUNK), 0);
    for group in (0..chunks).step_by(GROUP) {
        let range = group..chunks.min(group + GROUP as u64);
        let found: Result<Vec<Vec<(u32, f64)>>, WalkError> = range.into_par_iter().map(chunk).collect();
        for (i, weight) in found?.into_iter().flatten() {
            y[i as usize] += scale * weight;
            visits += 1;
        }
    }
    Ok(visits - walks)
}

/// Steps of one walk, at most.
const ENDLESS: usize = 1 << 24;

/// One walk that loses weight with the rows and plays roulette.
fn deposit(
    kernel: &Kernel<'_>,
    start: &Start,
    mut sampler: Sampler,
    deposits: &mut Vec<(u32, f64)>,
) -> Result<(), WalkError> {
    let (mut state, start_weight) = start.draw(&mut sampler);
    let mut weight = start_weight;
    for _ in 0..ENDLESS {
        deposits.push((state as u32, weight));
        let mass = kernel.mass(state);
        if mass == 0.0 {
            return Ok(());
        }
        let survival = mass.min(1.0);
        let u = sampler.next_1d_f64();
        if u >= survival {
            return Ok(());
        }
        let step = kernel.step(state, mass, u / survival);
        (state, weight) = (step.state, weight * (step.factor / survival));
    }
    Err(WalkError::Endless { steps: ENDLESS as u64 })
}
