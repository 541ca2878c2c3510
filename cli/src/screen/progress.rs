//! Progress bars on stderr for work that takes over a second, where stderr is a terminal; with `--progress` a line for
//! every per cent instead, wherever it goes.

use crate::screen::cancel;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use osculate::failure::Failure;
use osculate::files;
use osculate::watch::{PartialText, Watch};
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Work shorter than this shows no bar.
const QUIET: Duration = Duration::from_secs(1);
/// Steps of a bar.
const STEPS: u64 = 1000;

/// The screen of this process, which hears how work goes on.
pub static SCREEN: Screen = Screen {
    lines: AtomicBool::new(false),
    quiet: AtomicBool::new(false),
    next_line: AtomicU64::new(0),
    bars: Mutex::new(Vec::new()),
    folder: Mutex::new(None),
};

/// Shows the progress of the stage that began last, and saves what is finished when the run is stopped.
pub struct Screen {
    /// Whether per cents are printed as lines.
    lines: AtomicBool,
    /// Whether no bars are shown.
    quiet: AtomicBool,
    /// The next per cent to print a line for.
    next_line: AtomicU64,
    /// The stages that go on, each within the one before.
    bars: Mutex<Vec<Bar>>,
    /// Where a stopped run saves what is finished.
    folder: Mutex<Option<PathBuf>>,
}

/// The bar of a stage.
struct Bar {
    name: &'static str,
    bar: ProgressBar,
    start: Instant,
}

/// What is behind a lock: plain assignments, of which a thread that panicked has left none half done.
fn held<T>(lock: &Mutex<T>) -> MutexGuard<'_, T> {
    lock.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Screen {
    /// Prints per cents as lines from here on, or not.
    pub fn lines(&self, yes: bool) {
        self.lines.store(yes, Ordering::Relaxed);
    }

    /// Shows no bars from here on, or does.
    pub fn quiet(&self, yes: bool) {
        self.quiet.store(yes, Ordering::Relaxed);
    }

    /// A run that is stopped from here on saves what is finished in this folder.
    pub fn saves_into(&self, folder: &Path) {
        *held(&self.folder) = Some(folder.to_path_buf());
    }

    /// Prints the per cent of a stage where it is a new one.
    #[allow(clippy::print_stderr)]
    fn line(&self, name: &str, fraction: f64) {
        // At most a hundred.
        let percent = (100.0 * fraction.clamp(0.0, 1.0)) as u64;
        if self.next_line.fetch_max(percent + 1, Ordering::Relaxed) <= percent {
            eprintln!("progress: {name} {percent} %");
        }
    }
}

impl Watch for Screen {
    fn begin(&self, name: &'static str) {
        let bar = ProgressBar::with_draw_target(Some(STEPS), ProgressDrawTarget::hidden());
        let style = ProgressStyle::with_template("{msg:>9} [{bar:40}] {percent:>3} % {elapsed}");
        if let Ok(style) = style {
            bar.set_style(style.progress_chars("=> "));
        }
        bar.set_message(name);
        cancel::stage(name);
        self.next_line.store(0, Ordering::Relaxed);
        held(&self.bars).push(Bar { name, bar, start: Instant::now() });
    }

    fn at(&self, fraction: f64) {
        cancel::reached(fraction);
        let bars = held(&self.bars);
        let Some(Bar { name, bar, start }) = bars.last() else { return };
        if self.lines.load(Ordering::Relaxed) {
            self.line(name, fraction);
            return;
        }
        let shown = !self.quiet.load(Ordering::Relaxed) && std::io::stderr().is_terminal();
        if start.elapsed() > QUIET && bar.is_hidden() && shown {
            bar.set_draw_target(ProgressDrawTarget::stderr_with_hz(10));
        }
        // A fraction of a thousand fits.
        bar.set_position((fraction.clamp(0.0, 1.0) * STEPS as f64) as u64);
    }

    fn end(&self) {
        if let Some(ended) = held(&self.bars).pop() {
            ended.bar.finish_and_clear();
        }
    }

    fn partial(&self, text: PartialText, what: String) {
        let Some(folder) = held(&self.folder).clone() else { return };
        let file = folder.join(cancel::PARTIAL);
        cancel::keep(Box::new(move || {
            files::write(&file, text().map_err(Failure::job)?.as_bytes(), &SCREEN)?;
            Ok(format!("{} has {what}, not posted and not verified", file.display()))
        }));
    }

    fn wants_partial(&self) -> bool {
        held(&self.folder).is_some()
    }

    fn keep(&self, name: &str, bytes: &[u8]) {
        let Some(folder) = held(&self.folder).clone() else { return };
        let file = folder.join(name);
        // A full disk ends the run when its results are written; until then it goes on without.
        if files::write(&file, bytes, &SCREEN).is_ok() {
            let words = format!(
                "{} and those before it are there: the same command goes on from them",
                file.display()
            );
            cancel::keep(Box::new(move || Ok(words)));
        }
    }

    fn kept(&self, name: &str) -> Option<Vec<u8>> {
        std::fs::read(held(&self.folder).clone()?.join(name)).ok()
    }

    fn temporary(&self, file: &Path) {
        cancel::temporary(file);
    }

    fn settled(&self, file: &Path) {
        cancel::settled(file);
    }
}
