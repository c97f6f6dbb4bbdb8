//! A bar that tells how far a solver is.

use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};
use lichtweg_walk::solver::Watch;

use crate::console::Console;
use crate::interrupt::Interrupt;
use crate::progress::Ticker;
use crate::text::{count, countdown};

/// Steps of the bar.
const STEPS: u64 = 10_000;

/// A part of what is solved for.
#[derive(Clone, Copy, Debug)]
pub struct Stage {
    /// Which colour channel of how many.
    pub channel: usize,
    /// One where there are no colours.
    pub channels: usize,
    /// When the first began.
    pub began: Instant,
    /// What is counted.
    pub unit: &'static str,
}

impl Stage {
    /// Shows a bar on a terminal and passes Ctrl-C on where that is wanted, until dropped.
    pub fn show(self, console: Console, watch: Watch, interrupt: Option<Interrupt>) -> Ticker {
        let bar = (console == Console::Terminal).then(|| {
            let style = ProgressStyle::with_template("{bar:30} {percent:>3} % {wide_msg}");
            ProgressBar::new(STEPS).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        });
        let began = Instant::now();
        Ticker::start(move |last| {
            if interrupt.as_ref().is_some_and(Interrupt::asked) {
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
    pub fn part(self, done: u64, of: u64) -> String {
        let channel = format!("channel {} of {}", self.channel + 1, self.channels);
        let part = format!("{} of {} {}", count(done), count(of), self.unit);
        match (of, self.channels) {
            (0 | 1, 1) => "solving".to_owned(),
            (_, 1) => part,
            (0, _) => channel,
            _ => format!("{part} of {channel}"),
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
        assert_eq!(Stage { channel: 0, channels: 1, ..stage }.part(1200, 4418), "1,200 of 4,418 patches");
    }
}
