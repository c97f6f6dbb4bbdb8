//! Solving for the three colour channels, where one can see how far it is, and stop it.

use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};
use lichtweg_walk::solver::Watch;
use lichtweg_walk::stopping::Goal;
use lichtweg_walk::walk::Ending;
use lichtweg_walk::{Functional, Method, Options, Refusal, Solver, System};

use super::RadiosityArgs;
use crate::console::Console;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::progress::Ticker;
use crate::text::{count, countdown};

/// Exit code of what Ctrl-C has ended.
const INTERRUPTED: u8 = 130;
/// Steps of the bar.
const STEPS: u64 = 10_000;

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
        let ticker = stage.show(console, watch.clone(), interrupt.clone());
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

/// One channel of all.
#[derive(Clone, Copy, Debug)]
struct Stage {
    channel: usize,
    channels: usize,
    began: Instant,
    unit: &'static str,
}

impl Stage {
    /// Shows a bar on a terminal and passes Ctrl-C on, until dropped.
    fn show(self, console: Console, watch: Watch, interrupt: Interrupt) -> Ticker {
        let bar = (console == Console::Terminal).then(|| {
            let style = ProgressStyle::with_template("{bar:30} {percent:>3} % {wide_msg}");
            ProgressBar::new(STEPS).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        });
        let began = Instant::now();
        Ticker::start(move |last| {
            if interrupt.asked() {
                watch.stop();
            }
            let Some(bar) = &bar else { return };
            let (done, of) = watch.progress();
            bar.set_position((self.fraction(done, of) * STEPS as f64) as u64);
            bar.set_message(self.message(done, of, began.elapsed().as_secs_f64()));
            if last {
                bar.finish_and_clear();
            }
        })
    }

    /// The part of all channels that is done, in [0, 1].
    fn fraction(self, done: u64, of: u64) -> f64 {
        let here = if of > 0 { (done as f64 / of as f64).min(1.0) } else { 0.0 };
        (self.channel as f64 + here) / self.channels as f64
    }

    /// `1,200 of 4,418 patches of channel 2 of 3`.
    fn part(self, done: u64, of: u64) -> String {
        let channel = format!("channel {} of {}", self.channel + 1, self.channels);
        match of {
            0 => channel,
            _ => format!("{} of {} {} of {channel}", count(done), count(of), self.unit),
        }
    }

    /// What is done, how fast, and how long the rest will take, `here` seconds after this channel began.
    fn message(self, done: u64, of: u64, here: f64) -> String {
        let fraction = self.fraction(done, of);
        let elapsed = self.began.elapsed().as_secs_f64();
        let rate = if done > 0 && here > 0.0 {
            format!(", {} {}/s", count((done as f64 / here) as u64), self.unit)
        } else {
            String::new()
        };
        let left = if fraction > 0.0 {
            format!(", {} left", countdown(elapsed * (1.0 - fraction) / fraction))
        } else {
            String::new()
        };
        format!("{}{rate}{left}", self.part(done, of))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_told_how_far_all_channels_are() {
        let stage = Stage { channel: 1, channels: 3, began: Instant::now(), unit: "patches" };
        assert_eq!(stage.fraction(0, 0), 1.0 / 3.0);
        assert_eq!(stage.fraction(50, 100), 0.5);
        assert_eq!(stage.fraction(200, 100), 2.0 / 3.0);
        assert_eq!(stage.part(1200, 4418), "1,200 of 4,418 patches of channel 2 of 3");
        assert!(stage.message(1200, 4418, 2.0).contains("600 patches/s, "));
        assert!(stage.message(1200, 4418, 2.0).ends_with(" s left"));
    }
}
