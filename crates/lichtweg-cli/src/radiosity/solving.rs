//! Solving for the three colour channels, where one can see how far it is, and stop it.

use std::time::Instant;

use lichtweg_walk::solver::Watch;
use lichtweg_walk::stopping::Goal;
use lichtweg_walk::walk::Ending;
use lichtweg_walk::{Functional, Method, Options, Refusal, Solver, System};

use super::RadiosityArgs;
use crate::console::Console;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::solve::stage::Stage;

/// Exit code of what Ctrl-C has ended.
const INTERRUPTED: u8 = 130;

/// The radiosity of each patch in each channel: of all patches, or of those that are wanted, among zeros.
pub fn solve(
    systems: &[System],
    wanted: Option<&[usize]>,
    args: &RadiosityArgs,
    console: Console,
) -> Result<Vec<Vec<f64>>, Failure> {
    let interrupt = Interrupt::install()
        .map_err(|error| Failure::Failed(format!("Ctrl-C cannot be listened to: {error}")))?;
    console.say(&format!("solving by {}", args.method.name()));
    let began = Instant::now();
    let mut found = Vec::with_capacity(systems.len());
    for (channel, system) in systems.iter().enumerate() {
        let stage = Stage { channel, channels: systems.len(), began, unit: unit(args.method) };
        let watch = Watch::default();
        let ticker = stage.show(console, watch.clone(), Some(interrupt.clone()));
        let solved = channel_of(system, wanted, args, watch.clone());
        drop(ticker);
        match solved {
            Err(Refusal::Stopped) => {
                let (done, of) = watch.progress();
                console.say(&format!(
                    "stopped: {}; no image is written, since patches would be missing. A larger --tolerance or --patch takes less",
                    stage.part(done, of)
                ));
                return Err(Failure::Quiet(INTERRUPTED));
            }
            solved => found.push(solved.map_err(|refusal| Failure::Failed(refusal.to_string()))?),
        }
    }
    Ok(found)
}

/// Unknowns of one channel.
fn channel_of(
    system: &System,
    wanted: Option<&[usize]>,
    args: &RadiosityArgs,
    watch: Watch,
) -> Result<Vec<f64>, Refusal> {
    let largest = system.source().iter().copied().fold(0.0, f64::max);
    let options = Options {
        method: args.method,
        // Dark patches are not worth a relative tolerance.
        goal: Goal { relative: args.tolerance, absolute: 1e-2 * args.tolerance * largest, confidence: 0.95 },
        // Walks need not come to a light, nor to what it shines on: products with the matrix do that for all patches.
        // Forward walks come to a given patch seldom, and are to have less left to find.
        ahead: if matches!(args.method, Method::Forward | Method::Bidirectional) { 4 } else { 2 },
        // What is left is so even that short walks say as much as long ones.
        ending: Ending::Analog,
        seed: args.seed,
        watch,
        ..Options::default()
    };
    let asked: Vec<usize> = wanted.map_or_else(|| (0..system.unknowns()).collect(), <[usize]>::to_vec);
    let functionals: Vec<Functional> = asked.iter().copied().map(Functional::Unknown).collect();
    let answers = Solver::new(system).solve_each(&functionals, &options)?;
    options.watch.check()?;
    let found = answers.iter().find_map(|answer| answer.x.clone());
    Ok(found.unwrap_or_else(|| {
        let mut radiosity = vec![0.0; system.unknowns()];
        asked.iter().zip(&answers).for_each(|(&patch, answer)| radiosity[patch] = answer.value);
        radiosity
    }))
}

/// What a method counts.
fn unit(method: Method) -> &'static str {
    if method == Method::Forward { "walks" } else { "patches" }
}
