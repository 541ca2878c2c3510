//! Verification of a program that somebody hands in, as text: read, then judged against the goal of the job.

use crate::failure::Failure;
use crate::job::Job;
use crate::part::Part;
use crate::watch::{Stage, Watch};
use crate::work::reading::{self, Read};
use crate::work::verify::{self, Verified};
use std::path::Path;

/// A program or CL data as it is handed in.
#[derive(Debug, Clone, Copy)]
pub struct Source<'a> {
    /// Where it is from, for messages. The ending may say that it is CL data; otherwise the text says it.
    pub file: &'a Path,
    /// What stands in it.
    pub text: &'a str,
    /// Skip words that are not understood.
    pub lenient: bool,
}

/// A program that was read and judged.
pub struct Checked {
    /// What was measured, with all findings from the part to the verdict.
    pub verified: Verified,
    /// The job with the tool in hand that the program calls.
    pub job: Job,
    /// What the program does.
    pub read: Read,
    /// Wall time of the judgement, s.
    pub wall_s: f64,
}

/// Reads a program or CL data and judges it.
///
/// # Errors
/// Where the job has several tools and the program calls none of them, or more than one, and where the text cannot be read or judged. A program that
/// does not hold is no failure: its verdict says so.
pub fn check(part: &Part, job: &Job, source: &Source<'_>, watch: &dyn Watch) -> Result<Checked, Failure> {
    let job = reading::with_its_tool(source.file, source.text, job, part)?;
    let job = &job;
    let read =
        reading::read(source.file, source.text, job, part, source.lenient).map_err(|why| part.warned(why))?;
    let stage = Stage::begin(watch, "verify");
    let mut verified = verify::run(job, part, read.motions.reading(read.source), &|f| stage.at(f))?;
    let wall_s = stage.end();
    let of_stock = std::mem::take(&mut verified.diagnostics);
    verified.diagnostics =
        part.part.diagnostics.iter().chain(&read.diagnostics).cloned().chain(of_stock).collect();
    Ok(Checked { verified, job: job.clone(), read, wall_s })
}

/// Judges the text of an NC program, or of CL data, against the job.
///
/// The text alone counts, whoever wrote it. The program of a [`Plan`](crate::work::plan::Plan) gets the verdict of that plan
/// again, byte for byte.
///
/// ```
/// use osculate::{Answer, Job, Part};
/// use std::path::Path;
///
/// let text = r#"
/// format = 1
/// part = { builtin = { kind = "plane", half_size_mm = 1 } }
/// tool = { kind = "ball", diameter_mm = 6, length_mm = 40 }
/// tolerance = { scallop_mm = 0.2 }
/// cutting = { spindle_rpm = 8000, feed_mm_min = 500 }
/// machine = { name = "3-axis", dialect = "linuxcnc", feed = "none" }
/// "#;
/// let job = Job::from_toml(text, Path::new("strip.toml"))?;
/// let part = Part::of(&job)?;
/// // One pass along the middle of a strip 2 mm wide, written by hand. The ball leaves R - sqrt(R^2 - 1) beside it.
/// let pass = "G21 G90 G94 G54 G61\nT1 M6\nS8000 M3\nG43 H1\nG0 X-4 Y0\nG0 Z5\nG1 Z0 F500\nG1 X4\nG0 Z50\nM30\n";
/// let verified = osculate::verify(&part, &job, pass)?;
/// assert!((verified.summary.scallop_max_mm - (3.0 - 8f64.sqrt())).abs() < 1e-6);
/// // Half a millimetre too deep.
/// let deep = osculate::verify(&part, &job, &pass.replace("Z0", "Z-0.5"))?;
/// assert_eq!(deep.verdict.answer(), Answer::NotHeld);
/// assert!((deep.summary.gouge_max_mm - 0.5).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`check()`].
pub fn verify(part: &Part, job: &Job, program: &str) -> Result<Verified, Failure> {
    let source = Source { file: Path::new("the program"), text: program, lenient: false };
    Ok(check(part, job, &source, &())?.verified)
}
