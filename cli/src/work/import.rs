//! The part of a job as every verb takes it: read, its material sides settled, its faces those that are judged.

use crate::failure::Failure;
use crate::job::Job;
use crate::part::{self, Part};
use crate::watch::{Stage, Watch};
use crate::work::flank::face::judged;

impl Part {
    /// Reads the part of a job and chooses the faces that the job works on.
    ///
    /// ```
    /// use osculate::{Job, Part};
    /// use std::path::Path;
    ///
    /// let text = r#"
    /// format = 1
    /// part = { builtin = { kind = "plane", half_size_mm = 5 } }
    /// tool = { kind = "ball", diameter_mm = 6, length_mm = 40 }
    /// tolerance = { scallop_mm = 0.1 }
    /// "#;
    /// let part = Part::of(&Job::from_toml(text, Path::new("plane.toml"))?)?;
    /// // One face to machine, and no others to keep off.
    /// assert_eq!((part.faces.len(), part.check.len()), (1, 0));
    /// assert_eq!(part.part.format, "builtin");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Where the file cannot be read or is no part, where the job names a face that is not there, and where nothing says on
    /// which side of a face the material is.
    pub fn of(job: &Job) -> Result<Self, Failure> {
        Self::watched(job, &())
    }

    /// As [`of`](Self::of), with somebody who hears of it.
    ///
    /// # Errors
    /// As [`of`](Self::of).
    pub fn watched(job: &Job, watch: &dyn Watch) -> Result<Self, Failure> {
        let stage = Stage::begin(watch, "import");
        let faces = judged(job, part::of_job(job)?)?;
        Ok(Self { import_s: stage.end(), ..faces })
    }
}
