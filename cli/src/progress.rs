//! Progress bars on stderr for work that takes over a second, where stderr is a terminal.

use crate::cancel;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::time::{Duration, Instant};

/// Work shorter than this shows no bar.
const QUIET: Duration = Duration::from_secs(1);
/// Steps of a bar.
const STEPS: u64 = 1000;

/// A stage of a command: measures its time and shows its progress.
pub struct Stage {
    bar: ProgressBar,
    start: Instant,
}

impl Stage {
    /// Begins a stage.
    pub fn begin(name: &'static str) -> Self {
        let bar = ProgressBar::with_draw_target(Some(STEPS), ProgressDrawTarget::hidden());
        let style = ProgressStyle::with_template("{msg:>9} [{bar:40}] {percent:>3} % {elapsed}");
        if let Ok(style) = style {
            bar.set_style(style.progress_chars("=> "));
        }
        bar.set_message(name);
        cancel::stage(name);
        Self { bar, start: Instant::now() }
    }

    /// Reports a fraction done, 0 to 1.
    pub fn at(&self, fraction: f64) {
        if self.start.elapsed() > QUIET && self.bar.is_hidden() && std::io::stderr().is_terminal() {
            self.bar.set_draw_target(ProgressDrawTarget::stderr_with_hz(10));
        }
        cancel::reached(fraction);
        // A fraction of a thousand fits.
        self.bar.set_position((fraction.clamp(0.0, 1.0) * STEPS as f64) as u64);
    }

    /// Ends the stage and returns its wall time, s.
    pub fn end(self) -> f64 {
        self.bar.finish_and_clear();
        self.start.elapsed().as_secs_f64()
    }
}
