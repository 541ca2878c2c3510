//! Who hears how work goes on: stages, fractions, and what a run that is stopped can save.
//!
//! The library prints nothing and writes no file that it is not asked for. Work of a second or more names its stages to a [`Watch`];
//! `()` is one that listens to nothing.

use std::path::Path;
use std::time::Instant;

/// Makes the text of what is finished of a path.
pub type PartialText = Box<dyn FnOnce() -> Result<String, String> + Send>;

/// Hears how work goes on, from whichever thread does it.
///
/// ```
/// use osculate::{Watch, watch::Stage};
/// use std::sync::Mutex;
///
/// /// Keeps the names of stages.
/// #[derive(Default)]
/// struct Names(Mutex<Vec<&'static str>>);
///
/// impl Watch for Names {
///     fn begin(&self, stage: &'static str) {
///         self.0.lock().expect("nobody panics").push(stage);
///     }
/// }
///
/// let names = Names::default();
/// let stage = Stage::begin(&names, "import");
/// let seconds = stage.end();
/// assert!(seconds >= 0.0);
/// assert_eq!(*names.0.lock().expect("nobody panics"), ["import"]);
/// ```
pub trait Watch: Sync {
    /// A stage begins.
    fn begin(&self, _stage: &'static str) {}

    /// This fraction of the stage is done, 0 to 1; not always in ascending order.
    fn at(&self, _fraction: f64) {}

    /// The stage has ended.
    fn end(&self) {}

    /// What a run that is stopped from here on can save as CL data, and what that has, in words.
    fn partial(&self, _text: PartialText, _what: String) {}

    /// Whether somebody would save what is partial: making it costs a copy of the passes.
    fn wants_partial(&self) -> bool {
        false
    }

    /// Whether report and pictures are made: of many plans nobody looks at most.
    fn wants_pages(&self) -> bool {
        true
    }

    /// Something finished that is worth keeping where results go to, by its name: a run that was stopped goes on from there.
    fn keep(&self, _name: &str, _bytes: &[u8]) {}

    /// What an earlier run has kept under a name.
    fn kept(&self, _name: &str) -> Option<Vec<u8>> {
        None
    }

    /// A file under a temporary name that must not stay where the run is stopped.
    fn temporary(&self, _file: &Path) {}

    /// That file has its final name, or is gone.
    fn settled(&self, _file: &Path) {}
}

/// Nobody listens.
impl Watch for () {}

/// A stage of work: measures its time and tells its progress.
pub struct Stage<'a> {
    watch: &'a dyn Watch,
    start: Instant,
}

impl<'a> Stage<'a> {
    /// Begins a stage.
    pub fn begin(watch: &'a dyn Watch, name: &'static str) -> Self {
        watch.begin(name);
        Self { watch, start: Instant::now() }
    }

    /// Tells a fraction done, 0 to 1.
    pub fn at(&self, fraction: f64) {
        self.watch.at(fraction);
    }

    /// Ends the stage; its wall time, s.
    pub fn end(self) -> f64 {
        self.watch.end();
        self.start.elapsed().as_secs_f64()
    }
}
