//! What is said on standard error, and how: on a terminal with moving bars, elsewhere as plain lines, or not at all.

use std::fmt::Display;
use std::io::{IsTerminal, Write, stderr};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use lichtweg::scene::description::{Diagnostics, SourceMap};

use crate::progress::Ticker;

/// How to talk to the user.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Console {
    /// Warnings and errors only.
    Quiet,
    /// Lines.
    Plain,
    /// Lines, and bars that move.
    Terminal,
}

/// Writes a line to standard error. One that nobody reads any more, as after `2>&1 | head`, must not end a render.
pub fn tell(message: impl Display) {
    let _ = writeln!(stderr(), "{message}");
}

/// A stage shorter than this shows nothing on a terminal.
const PATIENCE: Duration = Duration::from_secs(1);

impl Console {
    /// What fits standard error.
    pub fn new(quiet: bool) -> Self {
        match (quiet, stderr().is_terminal()) {
            (true, _) => Self::Quiet,
            (false, false) => Self::Plain,
            (false, true) => Self::Terminal,
        }
    }

    /// Says something, unless quiet.
    pub fn say(self, message: &str) {
        if self != Self::Quiet {
            tell(message);
        }
    }

    /// Does some work that may take a while, under a label such as `building`.
    pub fn stage<T>(self, label: &str, work: impl FnOnce() -> T) -> T {
        match self {
            Self::Quiet => work(),
            Self::Plain => {
                tell(label);
                work()
            }
            Self::Terminal => {
                let _spinner = spinner(label.to_owned());
                work()
            }
        }
    }

    /// Shows findings, with colours on a terminal unless `NO_COLOR` is set.
    pub fn show(self, diagnostics: &Diagnostics, sources: &SourceMap) {
        let color = stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|v| v.is_empty());
        let text = lichtweg_io::diagnostics::render(diagnostics, sources, color);
        if !text.is_empty() {
            tell(text.trim_end());
        }
    }
}

/// Spins after a second, until dropped.
fn spinner(label: String) -> Ticker {
    let start = Instant::now();
    let mut bar: Option<ProgressBar> = None;
    Ticker::start(move |last| {
        if last {
            bar.iter().for_each(ProgressBar::finish_and_clear);
        } else if start.elapsed() >= PATIENCE {
            bar.get_or_insert_with(|| {
                let style = ProgressStyle::with_template("{spinner} {msg} {elapsed}");
                ProgressBar::new_spinner()
                    .with_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()))
                    .with_message(label.clone())
                    .with_elapsed(start.elapsed())
            })
            .tick();
        }
    })
}
