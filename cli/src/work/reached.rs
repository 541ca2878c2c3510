//! What the tools of a job reach of its faces, before anything is planned.
//!
//! Of an operation whose tool keeps its axis that axis is asked, of another one any axis that the machine's joints reach. Places stand for the
//! faces, so that the areas are estimates; what is said to be unreached is where even the best axis has the tool in the part.

use crate::failure::Failure;
use crate::job::{Job, OperationWord, Operations};
use crate::part::{LoadedFace, Part};
use crate::work::operations;
use crate::work::setup;
use osculate_geom::{Surface, Unit3};
use osculate_postproc::Orienting;
use osculate_productivity::access::{self, Access, Asked, At};
use osculate_productivity::axis::{Around, Left};
use osculate_productivity::plan::{Named, Tolerance};
use osculate_tools::removal::Sample;
use serde::Serialize;
use std::collections::HashMap;
use std::f64::consts::FRAC_PI_2;

/// About so many places of the faces of a job are asked for, and of those of a list of operations.
pub const PLACES: usize = 500;
const PLACES_OF_A_LIST: usize = 1500;
/// Axes stay so far off the tangent planes, rad.
const UPRIGHT_RAD: f64 = 0.035;
/// A flat end leans so much at least where it may lean, rad.
const LEAST_RAD: f64 = 0.0175;

/// What a tool reaches of the faces of an operation.
#[derive(Debug, Serialize)]
#[non_exhaustive]
pub struct Reached {
    /// The operation; empty for a job of one.
    pub operation: String,
    /// The tool, in words.
    pub tool: String,
    /// Area of its faces, mm2.
    pub area_mm2: f64,
    /// Area that the tool reaches, mm2.
    pub reached_mm2: f64,
    /// Faces of which something is not reached, with its area, mm2.
    pub unreached: Vec<(String, f64)>,
}

/// What is said of a job before it is planned.
#[derive(Debug, Serialize)]
pub struct Checked {
    /// Faces to machine, and others that are kept.
    pub faces: [usize; 2],
    /// Each operation but roughings, with each of its tools.
    pub reached: Vec<Reached>,
    /// Area that no operation reaches, mm2.
    pub unreached_mm2: f64,
    /// What the job accepts as unreached, mm2.
    pub accepted_mm2: f64,
    /// What is not set and matters.
    pub unset: Vec<String>,
    /// What was found on reading the part.
    pub diagnostics: Vec<String>,
}

impl Checked {
    /// Whether everything is reached, or accepted as unreached.
    #[must_use]
    pub fn fits(&self) -> bool {
        self.unreached_mm2 <= self.accepted_mm2
    }
}

/// How deep an end may go into points of the part here, mm: points stand so near to each other as that asks, and twice as deep as a job
/// accepts is near enough for a share.
pub fn coarse_mm(tolerance: Tolerance) -> f64 {
    2.0 * tolerance.gouge_mm
}

fn named(faces: &[LoadedFace]) -> Vec<Named<'_>> {
    faces.iter().map(|f| Named { face: &f.id, surface: &*f.surface as &dyn Surface }).collect()
}

/// What the tool in hand of a job reaches of the faces of a part as the job sees it, and whether it reaches each of the places.
fn of_tool(operation: &str, job: &Job, part: &Part, at: At<'_>) -> Result<(Reached, Vec<bool>), Failure> {
    let cutter = job.cutter();
    let gouge_mm = coarse_mm(job.tolerance());
    let (own, check) = (named(&part.faces), named(&part.check));
    let kept = job.strategy().kept_axis();
    let least = if cutter.is_ball() || kept.is_some() { 0.0 } else { LEAST_RAD };
    let asked = Asked {
        around: Around { faces: &own, check: &check, cutter: &cutter, gouge_mm, left: Left::default() },
        holder: job.holder(),
        at,
        lean_rad: [least, FRAC_PI_2 - UPRIGHT_RAD],
        axis: kept,
    };
    let access = Access::of(&asked).map_err(|e| Failure::file(job.path(), e))?;
    let (stands, _) = setup::of(job, part, None);
    let joints = Orienting::new(&job.control().machine, &stands.part_zero.rotation);
    // A kept axis is reached by the turn of the part that is found for it.
    let reaches = |a: &Unit3| kept.is_some() || joints.reaches(a);
    let mut left = vec![0.0; part.faces.len()];
    let mut each = Vec::new();
    for (place, reached) in access.reached(&reaches) {
        left[place.face as usize] += if reached { 0.0 } else { place.area_mm2 };
        each.push(reached);
    }
    let unreached: Vec<(String, f64)> =
        part.faces.iter().zip(&left).filter(|(_, l)| **l > 0.0).map(|(f, l)| (f.id.clone(), *l)).collect();
    let area_mm2 = access.area_mm2();
    let reached = Reached {
        operation: operation.to_owned(),
        tool: format!("T{} {}", job.tool().number(), job.tool().words()),
        area_mm2,
        reached_mm2: area_mm2 - left.iter().sum::<f64>(),
        unreached,
    };
    Ok((reached, each))
}

/// What matters and is not said by a job.
fn unset(job: &Job) -> Vec<String> {
    let mut out = Vec::new();
    let mut say = |missing: bool, what: &str| {
        if missing {
            out.push(what.to_owned());
        }
    };
    say(
        job.stock().is_none(),
        "[stock]: no raw material, so that a layer on the faces is assumed and the holder is not held against a block",
    );
    say(!job.names_machine(), "[machine]: no machine of yours, whose joints would be judged");
    say(
        job.tools().iter().any(|t| t.holder().is_none()),
        "[tool.holder]: a tool has no holder, so that only its cutter is looked at",
    );
    say(
        job.tools().iter().any(|t| t.teeth().is_none()),
        "[tool] teeth: marks of teeth are taken for one tooth",
    );
    say(
        job.tools().iter().any(|t| t.spindle_rpm().is_none()),
        "[cutting] spindle_rpm: the program has no speed",
    );
    out
}

/// Looks what the tools of a job of one operation reach.
///
/// ```
/// use osculate::{Job, Part, work::reached};
/// use std::path::Path;
///
/// let text = r#"
/// format = 1
/// part = { builtin = { kind = "plane", half_size_mm = 5 } }
/// tool = { kind = "ball", diameter_mm = 6, length_mm = 40 }
/// tolerance = { scallop_mm = 0.1 }
/// machine = { name = "3-axis" }
/// "#;
/// let job = Job::from_toml(text, Path::new("plane.toml"))?;
/// let checked = reached::of_job(&job, &Part::of(&job)?)?;
/// // A ball from above reaches all of a plane.
/// assert!(checked.fits() && checked.unreached_mm2 == 0.0);
/// assert!((checked.reached[0].area_mm2 - 100.0).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Where the part cannot be read or sampled.
pub fn of_job(job: &Job, part: &Part) -> Result<Checked, Failure> {
    part.part.to_plan(job.path())?;
    let of_one = |one: &Job| of_tool("", one, part, At::About(PLACES)).map(|(reached, _)| reached);
    let reached: Vec<Reached> = job.each_tool().iter().map(of_one).collect::<Result<_, _>>()?;
    let best = reached.iter().map(|r| r.area_mm2 - r.reached_mm2).fold(f64::INFINITY, f64::min);
    Ok(checked(job, part, reached, best))
}

/// Looks what the tools of a list of operations reach.
///
/// # Errors
/// As [`of_job`].
pub fn of_list(list: &Operations, part: &Part) -> Result<Checked, Failure> {
    part.part.to_plan(list.path())?;
    let places = access::places(&named(&part.faces), PLACES_OF_A_LIST);
    let places = places.map_err(|e| Failure::file(list.path(), e))?;
    // Which of them no operation reaches so far.
    let mut open = vec![true; places.len()];
    let mut reached = Vec::new();
    for operation in list.all().iter().filter(|o| o.kind != OperationWord::Rough) {
        let job = operation.judged()?;
        let own = operations::seen(operation, &job, part)?;
        let number: HashMap<&str, u32> = own.faces.iter().map(|f| f.id.as_str()).zip(0..).collect();
        let of_place = |(k, s): (usize, &Sample)| {
            let face = *number.get(part.faces[s.face as usize].id.as_str())?;
            Some((k, Sample { face, ..*s }))
        };
        let (at, asked): (Vec<usize>, Vec<Sample>) = places.iter().enumerate().filter_map(of_place).unzip();
        for one in job.each_tool() {
            let (found, each) = of_tool(&operation.name, &one, &own, At::Places(&asked))?;
            at.iter().zip(each).filter(|(_, reached)| *reached).for_each(|(k, _)| open[*k] = false);
            reached.push(found);
        }
    }
    let left = if reached.is_empty() { 0.0 } else { left_mm2(&places, &open) };
    Ok(checked(list.whole(), part, reached, left))
}

fn left_mm2(places: &[Sample], open: &[bool]) -> f64 {
    places.iter().zip(open).filter(|(_, open)| **open).map(|(s, _)| s.area_mm2).sum()
}

fn checked(job: &Job, part: &Part, reached: Vec<Reached>, unreached_mm2: f64) -> Checked {
    Checked {
        faces: [part.faces.len(), part.check.len()],
        reached,
        unreached_mm2,
        accepted_mm2: job.unreached_mm2(),
        unset: unset(job),
        diagnostics: part.part.diagnostics.iter().map(ToString::to_string).collect(),
    }
}
