//! What happens when a signal ends a running command: no half file stays, and the user hears how far it came.
//!
//! The handler runs in a thread of its own, so that it answers at once whatever the work is doing. It waits while a set
//! of results is being written ([`whole`]), removes temporary files, saves what is worth saving ([`keep`]) under a name
//! that says that it is partial, and ends the program with exit code 1.

use crate::screen::render;
use osculate::failure::Failure;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What a stopped run saves.
pub const PARTIAL: &str = "path.partial.cl";
/// Exit code of a run that was stopped: the job was not done.
const STOPPED: i32 = 1;

/// Saves what is finished and says in words what it wrote.
type Save = Box<dyn FnOnce() -> Result<String, Failure> + Send>;

/// What the handler needs to know.
struct Now {
    stage: &'static str,
    temporary: Vec<PathBuf>,
    save: Option<Save>,
    written: bool,
}

static NOW: Mutex<Now> =
    Mutex::new(Now { stage: "start", temporary: Vec::new(), save: None, written: false });
/// Held while a set of results is written.
static WRITING: Mutex<()> = Mutex::new(());
/// The fraction of the stage, the bits of an f64.
static FRACTION: AtomicU64 = AtomicU64::new(0);

fn now() -> MutexGuard<'static, Now> {
    // A thread that panicked has left nothing half-done in plain assignments.
    NOW.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Begins to watch for signals.
pub fn watch() -> Result<(), ctrlc::Error> {
    ctrlc::set_handler(stop)
}

/// A stage begins.
pub fn stage(name: &'static str) {
    now().stage = name;
    reached(0.0);
}

/// How far the stage is, 0 to 1.
pub fn reached(fraction: f64) {
    FRACTION.store(fraction.clamp(0.0, 1.0).to_bits(), Ordering::Relaxed);
}

/// A file that must not stay when the run is stopped.
pub fn temporary(path: &Path) {
    now().temporary.push(path.to_path_buf());
}

/// It has its final name, or is gone.
pub fn settled(path: &Path) {
    now().temporary.retain(|p| p != path);
}

/// What to save when the run is stopped from here on, instead of what was said before.
pub fn keep(save: Save) {
    now().save = Some(save);
}

/// Results are complete or absent: a stop waits until the guard is dropped, and then says that they are there.
pub fn whole() -> impl Drop {
    struct Whole(#[allow(dead_code)] MutexGuard<'static, ()>);
    impl Drop for Whole {
        fn drop(&mut self) {
            now().written = true;
        }
    }
    Whole(WRITING.lock().unwrap_or_else(PoisonError::into_inner))
}

fn stop() {
    let _writing = WRITING.lock().unwrap_or_else(PoisonError::into_inner);
    let (stage, save, temporary, written) = {
        let mut now = now();
        (now.stage, now.save.take(), std::mem::take(&mut now.temporary), now.written)
    };
    let percent = 100.0 * f64::from_bits(FRACTION.load(Ordering::Relaxed));
    for path in temporary {
        // Gone already is as good.
        let _ = std::fs::remove_file(path);
    }
    let what = match save {
        _ if written => "the results were complete and are written".to_owned(),
        None => "nothing was written".to_owned(),
        Some(save) => save().unwrap_or_else(|e| format!("nothing was written: {}", e.message())),
    };
    render::complaint(&format!("stopped in stage {stage} at {percent:.0} %; {what}"));
    std::process::exit(STOPPED);
}
