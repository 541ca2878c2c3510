//! Verification of programs against the goal of a job, shared by all verbs, and its figures as files have them.

use crate::failure::Failure;
use crate::job::Job;
use crate::part::Part;
use crate::work::goal::Aim;
use crate::work::stock::{self, StockSummary};
use osculate_geom::Diagnostic;
use osculate_tools::removal::{self, GoalControl, Kind, Program, ProveError, Verdict, prove};
use serde::Serialize;

/// The `verification` object of `summary.json` and of `verify --json`.
#[derive(Debug, Serialize, Clone)]
#[non_exhaustive]
pub struct Verification {
    /// `nc` or `cl`.
    pub source: &'static str,
    /// Number of samples.
    pub samples: usize,
    /// Those of them that were added where limits might be exceeded between the others.
    pub added_samples: usize,
    /// The program is so far off that a coarse look tells: figures are of that look.
    pub coarse: bool,
    /// Distance between the others, mm.
    pub spacing_mm: f64,
    /// Scallop that may hide between samples above the highest one seen, mm; absent where nothing bounds it.
    pub hidden_scallop_mm: Option<f64>,
    /// Gouge that may hide between samples below the deepest one seen, mm; absent where nothing bounds it.
    pub hidden_gouge_mm: Option<f64>,
    /// The smallest radius of curvature at a sample; absent where everything is flat.
    pub smallest_radius_mm: Option<f64>,
    /// Whether the limits hold with what may hide added to what was measured.
    pub certain: bool,
    /// Highest material left where the tool passed.
    pub scallop_max_mm: f64,
    /// Of 99 % of the area.
    pub scallop_p99_mm: f64,
    /// Median over the area.
    pub scallop_median_mm: f64,
    /// Median height of the crests between passes, on lines across the feed. Zero where none is found.
    pub crest_median_mm: f64,
    /// That over the scallop tolerance.
    pub scallop_use: f64,
    /// Deepest undercut.
    pub gouge_max_mm: f64,
    /// Area left standing at more than five times the scallop tolerance, or never touched.
    pub uncut_area_mm2: f64,
    /// Area measured higher than the scallop tolerance, or never touched. Where the job accepts an area the uncut one counts what is next
    /// to that as well: nothing can be shown about it.
    pub high_area_mm2: f64,
    /// The most that a rapid move of the cutter took.
    pub rapid_max_mm: f64,
    /// The most that the holder took.
    pub holder_max_mm: f64,
    /// The highest tooth mark; absent where nothing tells the spindle's speed.
    pub tooth_mark_max_mm: Option<f64>,
    /// Highest scallop with its tooth mark.
    pub height_max_mm: f64,
    /// Whether everything holds: exactly where the verdict's answer is `held`.
    pub within_tolerance: bool,
}

/// A bin of the histogram: area by what stands on it.
#[derive(Debug, Serialize, Clone)]
#[non_exhaustive]
pub struct HistogramBin {
    /// From here, negative is below the part; absent in the first.
    pub from_mm: Option<f64>,
    /// To here; absent in the last.
    pub to_mm: Option<f64>,
    /// Area of the machined faces.
    pub area_mm2: f64,
}

impl Verification {
    /// What the figures are worth, in a sentence.
    pub fn confidence(&self) -> String {
        let bend = self.smallest_radius_mm.map_or_else(
            || "the faces are flat".to_owned(),
            |r| {
                let turn = (self.spacing_mm / r).to_degrees();
                format!("the sharpest radius met is {r:.3} mm, over which normals turn by {turn:.2} deg from sample to sample")
            },
        );
        if self.coarse {
            return format!(
                "{} samples {:.4} mm apart: the program is so far off that nothing was looked at closer",
                self.samples, self.spacing_mm
            );
        }
        format!(
            "{} samples {:.4} mm apart and {} between them where limits were near; {bend}; between them all scallops may be \
             {:.5} mm higher and gouges {:.5} mm deeper than measured",
            self.samples - self.added_samples,
            self.spacing_mm,
            self.added_samples,
            self.hidden_scallop_mm.unwrap_or(f64::INFINITY),
            self.hidden_gouge_mm.unwrap_or(f64::INFINITY)
        )
    }
}

/// A worst place.
#[derive(Debug, Serialize, Clone)]
#[non_exhaustive]
pub struct WorstPlace {
    /// `scallop`, `gouge`, `uncut`, `holder` or `rapid`.
    pub kind: String,
    /// How bad.
    pub value_mm: f64,
    /// Where, part coordinates.
    pub at_mm: [f64; 3],
    /// The face.
    pub face: String,
    /// Its parameters.
    pub uv: [f64; 2],
    /// NC line or CL move, from 1; 0 where no motion did it.
    pub block: u32,
    /// Of a list of operations, the one that made it so; of places that nothing touched, the last one that is to machine the face.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub operation: Option<String>,
    /// With which tool.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tool_number: Option<u32>,
    /// The motion of what was judged, by its index.
    #[serde(skip)]
    pub motion: Option<u32>,
}

impl WorstPlace {
    /// What made it so, in words: block, and of a list of operations the operation with its tool.
    pub fn made_by(&self) -> String {
        match (&self.operation, self.tool_number, self.block) {
            (Some(name), Some(n), block) => format!("block {block} of {name} with T{n}"),
            (Some(name), None, _) => format!("where {name} does not come"),
            (None, _, block) => format!("block {block}"),
        }
    }
}

/// The `verdict` object of `summary.json` and of `verify --json`.
#[derive(Debug, Serialize, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct VerdictKeys {
    /// `held`, `not_held` or `not_shown`.
    pub answer: &'static str,
    /// Why it is not held.
    pub why: Vec<String>,
    /// What is to be told whatever the answer.
    pub remarks: Vec<String>,
    /// What it covers and what not.
    pub scope: std::collections::BTreeMap<String, String>,
}

impl VerdictKeys {
    /// Of a verdict.
    pub fn of(verdict: &Verdict) -> Self {
        Self {
            answer: verdict.answer().key(),
            why: verdict.why().to_vec(),
            remarks: verdict.remarks().to_vec(),
            scope: verdict
                .scope()
                .iter()
                .map(|row| (row.what.replace(' ', "_"), row.covers.clone()))
                .collect(),
        }
    }
}

/// What was read of a program or of CL data.
#[non_exhaustive]
pub struct Reading<'a> {
    /// `nc` or `cl`.
    pub source: &'static str,
    /// Motions and times.
    pub program: Program<'a>,
    /// The state of the control.
    pub control: GoalControl,
    /// The speed of each tool that the program calls, where it says one.
    pub speeds_rpm: Vec<Option<f64>>,
}

/// A verification with what the report needs.
#[non_exhaustive]
pub struct Verified {
    /// The figures.
    pub summary: Verification,
    /// Worst places.
    pub worst: Vec<WorstPlace>,
    /// Area by what stands on it.
    pub histogram: Vec<HistogramBin>,
    /// The verdict.
    pub verdict: Verdict,
    /// What became of declared raw material.
    pub stock: Option<StockSummary>,
    /// Findings.
    pub diagnostics: Vec<Diagnostic>,
}

/// Judges what a program does against the goal of the job.
pub fn run(
    job: &Job,
    faces: &Part,
    reading: Reading<'_>,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Verified, Failure> {
    judge(&Aim::of(job, faces)?, reading, progress)
}

/// As [`run`], of a goal that is made already.
pub fn judge(
    aim: &Aim<'_>,
    reading: Reading<'_>,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Verified, Failure> {
    let source = reading.source;
    let goal = aim.goal(reading.control, &reading.speeds_rpm);
    let verdict = prove(&goal, reading.program, progress).map_err(|why| refused(aim.job(), why))?;
    Ok(Verified::of(aim, verdict, source))
}

/// A program that cannot be judged, as a failure of its job.
pub fn refused(job: &Job, why: ProveError) -> Failure {
    match why {
        ProveError::Blank(why) => Failure::file(job.path(), format!("[stock] {why}")),
        other => Failure::file(job.path(), other),
    }
}

impl Verified {
    /// A verdict on what a goal is made for, as files have it.
    pub fn of(aim: &Aim<'_>, verdict: Verdict, source: &'static str) -> Self {
        let limits = aim.limits();
        let f = verdict.figures();
        let finite = |x: f64| x.is_finite().then_some(x);
        let summary = Verification {
            source,
            samples: f.tally.samples,
            added_samples: f.added,
            coarse: f.coarse,
            spacing_mm: f.spacing_mm,
            hidden_scallop_mm: finite(f.hidden.scallop_mm),
            hidden_gouge_mm: finite(f.hidden.gouge_mm),
            smallest_radius_mm: f.smallest_radius_mm,
            certain: verdict.is_held() && !limits.at_samples,
            scallop_max_mm: f.tally.scallop_max_mm,
            scallop_p99_mm: f.tally.scallop_p99_mm,
            scallop_median_mm: f.tally.median_mm,
            crest_median_mm: f.crest_median_mm,
            scallop_use: f.crest_median_mm / limits.scallop_mm,
            gouge_max_mm: f.tally.gouge_max_mm,
            uncut_area_mm2: f.tally.uncut_area_mm2,
            high_area_mm2: f.high_area_mm2,
            rapid_max_mm: f.tally.rapid_max_mm,
            holder_max_mm: f.tally.holder_max_mm,
            tooth_mark_max_mm: f.mark_max_mm,
            height_max_mm: f.height_max_mm,
            within_tolerance: verdict.is_held(),
        };
        let bin = |b: &removal::Bin| HistogramBin {
            from_mm: finite(b.from_mm),
            to_mm: finite(b.to_mm),
            area_mm2: b.area_mm2,
        };
        let histogram = f.tally.histogram.iter().map(bin).collect();
        let (stock, diagnostics) = f.stock.as_ref().map(|found| stock::told(found, aim.faces())).unzip();
        let diagnostics = diagnostics.unwrap_or_default();
        let worst = worst(aim, &f.tally.worst);
        Self { summary, worst, histogram, verdict, stock, diagnostics }
    }
}

/// The worst places, by how much of its own limit each takes.
fn worst(aim: &Aim<'_>, found: &[removal::Worst]) -> Vec<WorstPlace> {
    let limits = aim.limits();
    let share = |w: &removal::Worst| match w.kind {
        Kind::Scallop | Kind::Uncut => w.value_mm / limits.scallop_mm,
        Kind::Gouge | Kind::Holder | Kind::Rapid => w.value_mm / limits.gouge_mm,
    };
    let mut places: Vec<removal::Worst> = found.to_vec();
    places.sort_by(|a, b| share(b).total_cmp(&share(a)));
    let place = |w: &removal::Worst| WorstPlace {
        kind: match w.kind {
            Kind::Scallop => "scallop",
            Kind::Gouge => "gouge",
            Kind::Uncut => "uncut",
            Kind::Holder => "holder",
            Kind::Rapid => "rapid",
        }
        .to_owned(),
        value_mm: w.value_mm,
        at_mm: [w.at.x, w.at.y, w.at.z],
        face: aim.face_name(w.face),
        uv: [w.uv.u, w.uv.v],
        block: w.block.unwrap_or(0),
        motion: w.motion,
        operation: None,
        tool_number: None,
    };
    places.iter().map(place).collect()
}
