//! The least time of any plan of a job, and how near a plan comes to it.

use crate::failure::Failure;
use crate::job::Job;
use crate::part::Part;
use crate::words::number;
use crate::work::choice::patches;
use crate::work::program::Planned;
use osculate_productivity::compare::Axes;
use osculate_productivity::ideal::{self, Feeding, MOST_LEAD_RAD, Search};
use osculate_productivity::optimum::{OptimumError, Range};
use serde::Serialize;
use std::f64::consts::FRAC_PI_2;

/// Places over all faces at which the best posture is searched.
const PLACES: usize = 16;
/// Places a side of a face at which strips of isoparametric passes are looked at, and most faces of a job with which that is done: it takes
/// a few tenths of a second for each and tool.
const SIDE: usize = 12;
const MOST_FACES: usize = 4;

/// The bound.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct Bound {
    /// Least time, min.
    pub time_min: f64,
    /// Standard error of the sum over places, min.
    pub error_min: f64,
    /// Places.
    pub places: usize,
    /// Area that none of the tools reaches.
    pub unreached_mm2: f64,
    /// What it is the least time of.
    pub assumes: String,
    /// Least time of isoparametric passes, each with the best lead at each place and as wide as its narrowest place, min; of few faces only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub isoparametric_min: Option<f64>,
}

impl Bound {
    /// Time and error, min, as tables show them.
    pub fn words(&self) -> String {
        format!("{} +- {}", number(self.time_min, 3), number(self.error_min, 2))
    }
}

/// The bound and the plan's share of it, keys of `summary.json`.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct IdealTime {
    /// The bound.
    pub ideal: Bound,
    /// Length of the passes on the part, mm.
    pub contact_length_mm: f64,
    /// The bound over the longer of cutting time and contact length over feed.
    pub efficiency_percent: f64,
    /// That time, min.
    #[serde(skip)]
    pub cutting_min: f64,
}

impl IdealTime {
    fn of(ideal: Bound, contact_length_mm: f64, cutting_min: f64) -> Self {
        let efficiency_percent = if cutting_min > 0.0 { 100.0 * ideal.time_min / cutting_min } else { 0.0 };
        Self { ideal, contact_length_mm, efficiency_percent, cutting_min }
    }

    /// Those of several operations together, each of them over its own faces; None where there are none.
    pub fn of_all(each: &[&Self]) -> Option<Self> {
        let first = each.first()?;
        let sum = |of: &dyn Fn(&Self) -> f64| each.iter().map(|i| of(i)).sum::<f64>();
        let isoparametric: Option<Vec<f64>> = each.iter().map(|i| i.ideal.isoparametric_min).collect();
        let n = each.len();
        let ideal = Bound {
            time_min: sum(&|i| i.ideal.time_min),
            error_min: sum(&|i| i.ideal.error_min.powi(2)).sqrt(),
            places: each.iter().map(|i| i.ideal.places).sum(),
            unreached_mm2: sum(&|i| i.ideal.unreached_mm2),
            assumes: format!("{n} operations that finish whole faces, of each {}", first.ideal.assumes),
            isoparametric_min: isoparametric.map(|all| all.iter().sum()),
        };
        Some(Self::of(ideal, sum(&|i| i.contact_length_mm), sum(&|i| i.cutting_min)))
    }
}

/// The bound over the faces of a job with all its tools.
///
/// ```
/// use osculate::{Job, Part, work::ideal};
/// use std::path::Path;
///
/// let text = r#"
/// format = 1
/// part = { builtin = { kind = "plane", half_size_mm = 5 } }
/// tool = { kind = "ball", diameter_mm = 6, length_mm = 40 }
/// tolerance = { scallop_mm = 0.1 }
/// cutting = { feed_mm_min = 1000 }
/// "#;
/// let job = Job::from_toml(text, Path::new("plane.toml"))?;
/// let bound = ideal::of_job(&job, &Part::of(&job)?)?;
/// // 100 mm2 at 1000 mm a minute with strips of 2 sqrt(h (2 R - h)): no plan with a ball that does not tilt is faster.
/// let least_min = 100.0 / (1000.0 * 2.0 * f64::sqrt(0.1 * (6.0 - 0.1)));
/// assert!((bound.time_min / least_min - 1.0).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn of_job(job: &Job, faces: &Part) -> Result<Bound, Failure> {
    with(job, faces, tilts(job))
}

fn with(job: &Job, faces: &Part, (tilt, tilts): (Range, &str)) -> Result<Bound, Failure> {
    let jobs = job.each_tool();
    let cutters = jobs.iter().map(Job::cutter).collect::<Vec<_>>();
    let mut tools = Vec::with_capacity(jobs.len());
    for (one, cutter) in jobs.iter().zip(&cutters) {
        tools.push(Feeding { cutter, feed_mm_min: one.feed_mm_min() });
    }
    let search = Search { places: PLACES, tilt };
    let (patches, tolerance) = (patches(faces), job.tolerance());
    let failed = |e: OptimumError| Failure::file(job.path(), e);
    let found = ideal::ideal(&patches, &tools, &tolerance, search).map_err(failed)?;
    let isoparametric_min = if patches.len() <= MOST_FACES {
        ideal::isoparametric_min(&patches, &tools, &tolerance, SIDE).map_err(failed)?
    } else {
        None
    };
    Ok(Bound {
        time_min: found.time_min,
        error_min: found.error_min,
        places: found.places,
        unreached_mm2: found.unreached_mm2,
        assumes: format!(
            "the best posture at every point with leads to {:.0} deg and {tilts}, tool touching the part, contact at the \
             tool's feed; no overlap, no links, no tooth marks, no limits of the machine",
            MOST_LEAD_RAD.to_degrees()
        ),
        isoparametric_min,
    })
}

/// Tilts of the bound, and in words: where the job does not tilt, nor does the bound, as the feed is free to turn instead.
pub fn tilts(job: &Job) -> (Range, &'static str) {
    let strategy = job.strategy();
    if strategy.tilt_deg() == 0.0 && strategy.side_tilt_deg.is_none_or(|deg| deg == 0.0) {
        (Range::only(0.0), "no tilt")
    } else {
        ANY_TILT
    }
}

const ANY_TILT: (Range, &str) = (Range { least_rad: -FRAC_PI_2, most_rad: FRAC_PI_2 }, "any tilt");

/// The bound beside a plan whose feed moves take this time, min: where its tilts were found place by place those of the bound are free
/// too. None beside a plan that leaves some of the faces out, or does not know its strips: the least time for whole faces says nothing of it.
pub fn of_plan(
    job: &Job,
    faces: &Part,
    planned: &Planned<'_>,
    cutting_min: f64,
) -> Result<Option<IdealTime>, Failure> {
    if !planned.with_strips || !planned.extras.left_out.is_empty() {
        return Ok(None);
    }
    let balanced = planned.axes == Axes::Balanced;
    let ideal = with(job, faces, if balanced { ANY_TILT } else { tilts(job) })?;
    let contact_length_mm = planned.passes.length_mm();
    // The tip may be slower than the contact or faster: the bound is one of contacts.
    let cutting_min = cutting_min.max(contact_length_mm / job.feed_mm_min());
    Ok(Some(IdealTime::of(ideal, contact_length_mm, cutting_min)))
}
