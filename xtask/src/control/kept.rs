//! Which runs there are of a part, and where their results are kept.

use super::programs::Part;
use std::path::{Path, PathBuf};

/// How many times as fast the control's clock runs.
pub const RATE: f64 = 20.0;
/// The program that is run with other clocks too, and these.
pub const CLOCKED: (&str, &str) = ("m86-1", "inverse_time");
pub const OTHER_RATES: [f64; 2] = [1.0, 5.0];

/// Which run of a part.
pub struct Which<'a> {
    pub feed: &'a str,
    /// By `post`, from the path of the part's first plan.
    pub posted: bool,
    pub rate: f64,
}

impl Which<'_> {
    /// Where its result is kept.
    pub fn file(&self, root: &Path, part: &Part) -> PathBuf {
        let kind = if self.posted { "posted" } else { "planned" };
        root.join(format!("target/control/results/{}.{}.{kind}.{}.json", part.name, self.feed, self.rate))
    }
}

/// Where programs and samples of a part are kept.
pub fn place(root: &Path, part: &Part) -> PathBuf {
    root.join("target/control").join(part.name.replace([' ', ','], "-"))
}
