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
use osculate_productivity::access::{Access, Asked};
use osculate_productivity::axis::{Around, Left};
use osculate_productivity::plan::{Named, Tolerance};
use serde::Serialize;
use std::f64::consts::FRAC_PI_2;

/// About so many places of the faces of an operation are asked for.
pub const PLACES: usize = 500;
/// Axes stay so far off the tangent planes, rad.
const UPRIGHT_RAD: f64 = 0.035;
/// A flat end leans so much at least where it may lean, rad.
const LEAST_RAD: f64 = 0.0175;

/// What a tool reaches of the faces of an operation.
#[derive(Debug, Serialize)]
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
    /// Area that the operations together cannot reach, at least, mm2.
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

/// What the tool in hand of a job reaches of the faces of a part as the job sees it.
fn of_tool(operation: &str, job: &Job, part: &Part) -> Result<Reached, Failure> {
    let cutter = job.cutter();
    let gouge_mm = coarse_mm(job.tolerance());
    let (own, check) = (named(&part.faces), named(&part.check));
    let kept = job.strategy().kept_axis();
    let least = if cutter.is_ball() || kept.is_some() { 0.0 } else { LEAST_RAD };
    let asked = Asked {
        around: Around { faces: &own, check: &check, cutter: &cutter, gouge_mm, left: Left::default() },
        holder: job.holder(),
        places: PLACES,
        lean_rad: [least, FRAC_PI_2 - UPRIGHT_RAD],
        axis: kept,
    };
    let access = Access::of(&asked).map_err(|e| Failure::file(job.path(), e))?;
    let (stands, _) = setup::of(job, part, None);
    let joints = Orienting::new(&job.control().machine, &stands.part_zero.rotation);
    // A kept axis is reached by the turn of the part that is found for it.
    let left = access.without_mm2(&|a: &Unit3| kept.is_some() || joints.reaches(a));
    let unreached: Vec<(String, f64)> =
        part.faces.iter().zip(&left).filter(|(_, l)| **l > 0.0).map(|(f, l)| (f.id.clone(), *l)).collect();
    let area_mm2 = access.area_mm2();
    Ok(Reached {
        operation: operation.to_owned(),
        tool: format!("T{} {}", job.tool().number(), job.tool().words()),
        area_mm2,
        reached_mm2: area_mm2 - left.iter().sum::<f64>(),
        unreached,
    })
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

/// The area of the faces of a part that operations cannot reach whatever they share, mm2: each may reach another piece of a face, so that
/// what they reach is added up.
fn out_of_reach_mm2(part: &Part, all: &[(Vec<String>, &Reached)]) -> f64 {
    let left = |f: &LoadedFace| {
        let area_mm2 = crate::part::area(f);
        let own = all.iter().filter(|(ids, _)| ids.contains(&f.id));
        let left = |r: &Reached| r.unreached.iter().find(|u| u.0 == f.id).map_or(0.0, |u| u.1);
        (area_mm2 - own.map(|(_, r)| area_mm2 - left(r)).sum::<f64>()).max(0.0)
    };
    part.faces.iter().map(left).sum()
}

/// Looks what the tools of a job of one operation reach.
///
/// # Errors
/// Where the part cannot be read or sampled.
pub fn of_job(job: &Job, part: &Part) -> Result<Checked, Failure> {
    part.part.to_plan(job.path())?;
    let reached: Vec<Reached> =
        job.each_tool().iter().map(|one| of_tool("", one, part)).collect::<Result<_, _>>()?;
    let best = reached.iter().map(|r| r.area_mm2 - r.reached_mm2).fold(f64::INFINITY, f64::min);
    Ok(checked(job, part, reached, best))
}

/// Looks what the tools of a list of operations reach.
///
/// # Errors
/// As [`of_job`].
pub fn of_list(list: &Operations, part: &Part) -> Result<Checked, Failure> {
    part.part.to_plan(list.path())?;
    let mut reached = Vec::new();
    let mut faces: Vec<Vec<String>> = Vec::new();
    for operation in list.all().iter().filter(|o| o.kind != OperationWord::Rough) {
        let job = operation.judged()?;
        let own = operations::seen(operation, &job, part)?;
        for one in job.each_tool() {
            reached.push(of_tool(&operation.name, &one, &own)?);
            faces.push(own.faces.iter().map(|f| f.id.clone()).collect());
        }
    }
    let all: Vec<(Vec<String>, &Reached)> = faces.into_iter().zip(&reached).collect();
    let unreached = if all.is_empty() { 0.0 } else { out_of_reach_mm2(part, &all) };
    drop(all);
    Ok(checked(list.whole(), part, reached, unreached))
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
