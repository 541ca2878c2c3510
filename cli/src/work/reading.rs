//! Programs and CL data read for their verdict: motions, times, and the state of the control. The same for every verb.

use crate::failure::Failure;
use crate::job::Control;
use crate::job::Job;
use crate::part::Part;
use crate::work::nc::{self, Motions};
use crate::work::{bodies, posted_setup, stock};
use osculate_geom::{Box3, Diagnostic};
use osculate_postproc::cldata;
use osculate_tools::Cutter;
use osculate_tools::cl::{ClPath, Motion};
use osculate_tools::removal::Swept;
use std::path::Path;

/// A text that was read.
#[non_exhaustive]
pub struct Read {
    /// `nc` or `cl`.
    pub source: &'static str,
    /// What it does.
    pub motions: Motions,
    /// Findings beside those of the motions.
    pub diagnostics: Vec<Diagnostic>,
}

/// Reads a program or CL data for the verdict of a job.
///
/// # Errors
/// Where the text cannot be read, or what it does cannot be meant for the part.
pub fn read(file: &Path, text: &str, job: &Job, faces: &Part, lenient: bool) -> Result<Read, Failure> {
    let mut read =
        if is_cl(file, text) { of_cl(file, text, job)? } else { of_nc(file, text, job, faces, lenient)? };
    let motions = &read.motions.motions;
    if motions.is_empty() {
        return Err(Failure::file(file, "has no motion: at least two positions are needed"));
    }
    let strange = meet(file, motions, faces).map_err(|why| why.warned(&read.diagnostics))?;
    read.diagnostics.extend(strange);
    Ok(read)
}

/// The job with the tool in hand that a program calls, or that CL data is for.
///
/// # Errors
/// Where the job has several tools and the text does not say one of them.
pub fn with_its_tool(file: &Path, text: &str, job: &Job, faces: &Part) -> Result<Job, Failure> {
    if job.one_tool().is_ok() {
        return Ok(job.clone());
    }
    let all = job.each_tool();
    let found: Vec<&Job> = if is_cl(file, text) {
        let cl = cldata::read(text).map_err(|e| Failure::file(file, e))?;
        let cutter = cl.path.cutter.and_then(|c| Cutter::try_from(c).ok());
        all.iter().filter(|one| Some(one.cutter()) == cutter).collect()
    } else {
        // Which tool is called does not depend on its length, which tool is in hand does not matter.
        let (motions, _) = program(text, job.control(), &all[0], faces, true)
            .map_err(|e| Failure::file(file, e.message()))?;
        all.iter().filter(|one| motions.tools.contains(&one.tool().number())).collect()
    };
    match found[..] {
        [one] => Ok(one.clone()),
        _ => {
            let numbers: Vec<String> = all.iter().map(|one| one.tool().number().to_string()).collect();
            let text = format!(
                "calls {} of the job's tools, {}: a verdict is on one of them; copy the job with the one meant as [tool]",
                if found.is_empty() { "none" } else { "several" },
                numbers.join(", ")
            );
            Err(Failure::file(file, text))
        }
    }
}

fn of_cl(file: &Path, text: &str, job: &Job) -> Result<Read, Failure> {
    let cl = cldata::read(text).map_err(|e| Failure::file(file, e))?;
    let mut diagnostics = cl.diagnostics;
    let own = job.cutter_spec();
    if let Some(other) = cl.path.cutter.filter(|c| Cutter::try_from(*c) != Cutter::try_from(own)) {
        let text = format!("the CL data is for another cutter: {other:?}; verified with the job's, {own:?}");
        diagnostics.push(Diagnostic::warning("tool", text));
    }
    Ok(Read { source: "cl", motions: timed(&cl.path), diagnostics })
}

/// The motions of CL data, with times by their feeds; rapid moves take none, as nothing says their speed.
fn timed(path: &ClPath) -> Motions {
    let motions = Swept::along(path);
    let mut clock = 0.0;
    let times_min = motions
        .iter()
        .zip(path.moves.iter().skip(1))
        .map(|(m, to)| {
            if let Motion::Feed(feed) = to.motion {
                clock += (m.to.tip - m.from.tip).norm() / feed;
            }
            clock
        })
        .collect();
    let (time_min, spindle_rpm) = (clock, path.spindle_rpm);
    Motions { motions, times_min, time_min, cutting_time_min: clock, spindle_rpm, ..Motions::default() }
}

fn of_nc(file: &Path, text: &str, job: &Job, faces: &Part, lenient: bool) -> Result<Read, Failure> {
    let control = job.control();
    let mut diagnostics = Vec::new();
    if !job.names_machine() {
        diagnostics.push(Diagnostic::warning(
            "machine",
            format!(
                "the job has no [machine]: the program is read as {} for {}; give [machine] name or file, and dialect",
                control.dialect_name,
                control.machine.name()
            ),
        ));
    }
    let (motions, notes) =
        program(text, control, job, faces, lenient).map_err(|e| Failure::file(file, e.message()))?;
    diagnostics.extend(notes);
    diagnostics.extend(motions.diagnostics.iter().cloned());
    Ok(Read { source: "nc", motions, diagnostics })
}

/// What a program does to the part of a job that stands where the program's head says, with findings on that place.
///
/// # Errors
/// Where it cannot be read.
pub fn program(
    text: &str,
    control: &Control,
    job: &Job,
    faces: &Part,
    lenient: bool,
) -> Result<(Motions, Vec<Diagnostic>), Failure> {
    let (setup, notes) =
        posted_setup::of_program(job, faces, &control.language.engine_text(text), control.dialect);
    let mut motions = nc::read_back(text, job, control, &setup, lenient).map_err(Failure::job)?;
    let tools = std::slice::from_ref(job);
    bodies::look(&mut motions.control, text, (job, tools), control, &setup, (faces, lenient))?;
    Ok((motions, notes))
}

/// Whether a text is CL data: a statement of APT stands in its first lines.
fn is_cl(path: &Path, text: &str) -> bool {
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    if matches!(ending.as_deref(), Some("cl" | "apt" | "cls" | "aptsource")) {
        return true;
    }
    text.lines().take(200).any(|l| {
        let l = l.trim_start().to_uppercase();
        l.starts_with("GOTO/") || l.starts_with("PARTNO") || l.starts_with("LOADTL/")
    })
}

/// What unit a path may be in that meets the part only when scaled: a hint for the message.
fn unit_hint(path: &Box3, reach: &Box3) -> &'static str {
    const INCH: f64 = 25.4;
    let meets = |scale: f64| {
        (0..3).all(|k| path.min[k] * scale <= reach.max[k] && path.max[k] * scale >= reach.min[k])
    };
    if path.is_empty() {
        ""
    } else if meets(INCH) {
        "; taken as inches they would meet: does the program need G20 or UNITS/INCHES?"
    } else if meets(1.0 / INCH) {
        "; divided by 25.4 they would meet: is the part in inches, or the program in mm under G20?"
    } else {
        ""
    }
}

/// Feed moves that span more than this many times the part, or less than its share, are told.
const SPAN: f64 = 8.0;

/// Refuses a path that never comes near the part, a wrong unit or a wrong part zero, and tells one of another size.
pub fn meet(file: &Path, motions: &[Swept], faces: &Part) -> Result<Option<Diagnostic>, Failure> {
    let mut path = Box3::empty();
    for m in motions.iter().filter(|m| !m.rapid) {
        path.add(&m.from.tip);
        path.add(&m.to.tip);
    }
    let whole = stock::around(faces);
    let reach = whole.grown(0.5 * whole.diagonal_mm());
    let apart = path.is_empty() || (0..3).any(|k| path.min[k] > reach.max[k] || path.max[k] < reach.min[k]);
    let part = stock::corners(&whole);
    if apart {
        let path_text = if path.is_empty() { "nothing".to_owned() } else { stock::corners(&path) };
        return Err(Failure::file(
            file,
            format!(
                "the feed moves lie in {path_text} mm, the part in {part} mm: they do not meet; is the unit right (inch \
                 against mm), or [setup] part_zero_mm?{}",
                unit_hint(&path, &reach)
            ),
        ));
    }
    let times = path.diagonal_mm() / whole.diagonal_mm();
    let strange = !(1.0 / SPAN..=SPAN).contains(&times);
    Ok(strange.then(|| {
        let text = format!(
            "the feed moves lie in {} mm, {times:.3} times the size of the part in {part} mm: is the unit right (inch against \
             mm)?",
            stock::corners(&path)
        );
        Diagnostic::warning("units", text)
    }))
}
