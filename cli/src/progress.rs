//! Progress bars on stderr for work that takes over a second, where stderr is a terminal; with `--progress` a line for
//! every per cent instead, wherever it goes.

use crate::cancel;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Work shorter than this shows no bar.
const QUIET: Duration = Duration::from_secs(1);
/// Steps of a bar.
const STEPS: u64 = 1000;

/// Whether per cents are printed as lines.
static LINES: AtomicBool = AtomicBool::new(false);

/// Prints per cents as lines from here on, or not.
pub fn lines(yes: bool) {
    LINES.store(yes, Ordering::Relaxed);
}

/// A stage of a command: measures its time and shows its progress.
pub struct Stage {
    name: &'static str,
    bar: ProgressBar,
    start: Instant,
    /// The next per cent to print a line for.
    next_line: AtomicU64,
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
        Self { name, bar, start: Instant::now(), next_line: AtomicU64::new(0) }
    }

    /// Reports a fraction done, 0 to 1.
    pub fn at(&self, fraction: f64) {
        if LINES.load(Ordering::Relaxed) {
            cancel::reached(fraction);
            self.line(fraction);
            return;
        }
        if self.start.elapsed() > QUIET && self.bar.is_hidden() && std::io::stderr().is_terminal() {
            self.bar.set_draw_target(ProgressDrawTarget::stderr_with_hz(10));
        }
        cancel::reached(fraction);
        // A fraction of a thousand fits.
        self.bar.set_position((fraction.clamp(0.0, 1.0) * STEPS as f64) as u64);
    }

    /// Prints the per cent where it is a new one.
    #[allow(clippy::print_stderr)]
    fn line(&self, fraction: f64) {
        // At most a hundred.
        let percent = (100.0 * fraction.clamp(0.0, 1.0)) as u64;
        if self.next_line.fetch_max(percent + 1, Ordering::Relaxed) <= percent {
            eprintln!("progress: {} {percent} %", self.name);
        }
    }

    /// Ends the stage and returns its wall time, s.
    pub fn end(self) -> f64 {
        self.bar.finish_and_clear();
        self.start.elapsed().as_secs_f64()
    }
}
