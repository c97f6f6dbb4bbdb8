//! Watching a render: draws the bar, and passes Ctrl-C on to the job.

use std::sync::Arc;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use lichtweg::render::Progress;

use crate::console::Console;
use crate::interrupt::Interrupt;
use crate::text;

/// A thread that does something ten times a second, until dropped.
#[derive(Debug)]
pub struct Ticker {
    stop: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

const INTERVAL: Duration = Duration::from_millis(100);

impl Ticker {
    /// Calls `tick(false)` again and again, and `tick(true)` at the end.
    pub fn start(mut tick: impl FnMut(bool) + Send + 'static) -> Self {
        let (stop, stopped) = channel();
        let thread = std::thread::spawn(move || {
            while stopped.recv_timeout(INTERVAL) == Err(RecvTimeoutError::Timeout) {
                tick(false);
            }
            tick(true);
        });
        Self { stop: Some(stop), thread: Some(thread) }
    }
}

impl Drop for Ticker {
    fn drop(&mut self) {
        drop(self.stop.take());
        if let Some(thread) = self.thread.take() {
            // A panic in it has been printed; what it watched over is not affected.
            let _ = thread.join();
        }
    }
}

/// How far a render will go.
#[derive(Clone, Copy, Debug)]
pub struct Goal {
    /// Pixels of the window.
    pub pixels: u64,
    /// Samples of each; `None` where only time counts.
    pub samples_per_pixel: Option<u32>,
    /// Stop after this time.
    pub time: Option<Duration>,
}

impl Goal {
    /// The fraction done, in [0, 1].
    fn fraction(&self, samples: u64, elapsed: Duration) -> f64 {
        let of_samples =
            self.samples_per_pixel.map_or(0.0, |n| samples as f64 / (self.pixels as f64 * f64::from(n)));
        let of_time = self.time.map_or(0.0, |t| elapsed.as_secs_f64() / t.as_secs_f64());
        of_samples.max(of_time).clamp(0.0, 1.0)
    }

    /// One line: how far it is.
    fn message(&self, progress: &Progress, elapsed: Duration) -> String {
        let samples = progress.samples();
        let per_pixel = samples as f64 / self.pixels as f64;
        let of = self.samples_per_pixel.map_or(String::new(), |n| format!("/{n}"));
        let rate = progress.rays() as f64 / elapsed.as_secs_f64().max(1e-9) * 1e-6;
        let fraction = self.fraction(samples, elapsed);
        let left = if fraction > 0.0 {
            let left = elapsed.as_secs_f64() * (1.0 - fraction) / fraction;
            format!("{} left", text::countdown(left))
        } else {
            String::new()
        };
        format!("{per_pixel:.1}{of} spp, pass {}, {rate:.2} Mrays/s, {left}", progress.passes() + 1)
    }
}

/// Steps of the bar.
const STEPS: u64 = 10_000;

/// Watches until dropped.
pub fn watch(console: Console, progress: Arc<Progress>, interrupt: Interrupt, goal: Goal) -> Ticker {
    let start = Instant::now();
    let bar = (console == Console::Terminal).then(|| {
        let style = ProgressStyle::with_template("{bar:30} {percent:>3} % {wide_msg}");
        ProgressBar::new(STEPS).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
    });
    Ticker::start(move |last| {
        let elapsed = start.elapsed();
        if let Some(bar) = &bar {
            let fraction = goal.fraction(progress.samples(), elapsed);
            bar.set_position((fraction * STEPS as f64) as u64);
            bar.set_message(goal.message(&progress, elapsed));
        }
        if interrupt.asked() && !progress.is_stopped() {
            progress.stop();
            let message = "stopping after this pass; Ctrl-C again leaves at once, without an image";
            match &bar {
                Some(bar) => bar.println(message),
                None => console.say(message),
            }
        }
        if last {
            bar.iter().for_each(ProgressBar::finish_and_clear);
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearer_goal_counts() {
        let goal = Goal { pixels: 100, samples_per_pixel: Some(10), time: Some(Duration::from_secs(4)) };
        assert_eq!(goal.fraction(250, Duration::from_secs(0)), 0.25);
        assert_eq!(goal.fraction(250, Duration::from_secs(2)), 0.5);
        assert_eq!(goal.fraction(250, Duration::from_secs(9)), 1.0);
        let unlimited = Goal { samples_per_pixel: None, ..goal };
        assert_eq!(unlimited.fraction(250, Duration::from_secs(1)), 0.25);
    }
}
