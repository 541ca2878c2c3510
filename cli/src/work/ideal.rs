//! The least time of any plan of a job, and how near a plan comes to it.

use crate::failure::Failure;
use crate::job::Job;
use crate::part::{self, LoadedFace, Part};
use crate::words::number;
use crate::work::choice::patches;
use crate::work::operations::standing::LeftStanding;
use crate::work::program::Planned;
use osculate_productivity::compare::Axes;
use osculate_productivity::ideal::{self, Feeding, MOST_LEAD_RAD, Patch, Search};
use osculate_productivity::optimum::{OptimumError, Range};
use osculate_productivity::plan::Tolerance;
use serde::Serialize;
use std::collections::BTreeMap;
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
}

impl IdealTime {
    fn of(ideal: Bound, contact_length_mm: f64, cutting_min: f64) -> Self {
        let efficiency_percent = if cutting_min > 0.0 { 100.0 * ideal.time_min / cutting_min } else { 0.0 };
        Self { ideal, contact_length_mm, efficiency_percent }
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

fn with(job: &Job, faces: &Part, tilt: (Range, &str)) -> Result<Bound, Failure> {
    over(&job.each_tool(), &patches(faces), &job.tolerance(), tilt)
}

/// The bound over faces with the tools of these jobs, one at least.
fn over(
    jobs: &[Job],
    patches: &[Patch<'_>],
    tolerance: &Tolerance,
    (tilt, tilts): (Range, &str),
) -> Result<Bound, Failure> {
    let cutters = jobs.iter().map(Job::cutter).collect::<Vec<_>>();
    let tools: Vec<Feeding<'_>> = jobs
        .iter()
        .zip(&cutters)
        .map(|(one, cutter)| Feeding { cutter, feed_mm_min: one.feed_mm_min() })
        .collect();
    let search = Search { places: PLACES, tilt };
    let failed = |e: OptimumError| Failure::file(jobs[0].path(), e);
    let found = ideal::ideal(patches, &tools, tolerance, search).map_err(failed)?;
    let isoparametric_min = if patches.len() <= MOST_FACES {
        ideal::isoparametric_min(patches, &tools, tolerance, SIDE).map_err(failed)?
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

/// What an operation has of a part's finishing.
#[derive(Clone, Copy)]
pub struct Share<'a> {
    /// Its job, with the tool in hand.
    pub job: &'a Job,
    /// Its faces.
    pub part: &'a Part,
    /// Length of its passes, mm.
    pub contact_length_mm: f64,
    /// Time of its feed moves, min.
    pub cutting_min: f64,
}

/// The bound beside operations that finish a part together: each face counts once, less what is left standing on it, with whichever of its
/// operations' tools is quickest, and to the tolerance of the part. None where there is none.
pub fn of_part(
    shares: &[Share<'_>],
    tolerance: &Tolerance,
    standing: &[LeftStanding],
) -> Result<Option<IdealTime>, Failure> {
    let left = |id: &str| standing.iter().filter(|l| l.face == id).map(|l| l.area_mm2).sum::<f64>();
    // Faces by the operations that have them.
    let mut having: BTreeMap<&str, (&LoadedFace, Vec<usize>)> = BTreeMap::new();
    for (k, share) in shares.iter().enumerate() {
        for face in &share.part.faces {
            having.entry(face.id.as_str()).or_insert((face, Vec::new())).1.push(k);
        }
    }
    let mut groups: BTreeMap<Vec<usize>, Vec<Patch<'_>>> = BTreeMap::new();
    for (face, of) in having.into_values() {
        let area_mm2 = part::area(face) - left(&face.id);
        if area_mm2 > 0.0 {
            groups.entry(of).or_default().push(Patch { surface: &*face.surface, area_mm2 });
        }
    }
    let mut each = Vec::with_capacity(groups.len());
    for (of, patches) in &groups {
        let jobs: Vec<Job> = of.iter().flat_map(|k| shares[*k].job.each_tool()).collect();
        each.push(over(&jobs, patches, tolerance, ANY_TILT)?);
    }
    let Some(first) = each.first() else { return Ok(None) };
    let sum = |of: &dyn Fn(&Bound) -> f64| each.iter().map(of).sum::<f64>();
    let isoparametric: Option<Vec<f64>> = each.iter().map(|b| b.isoparametric_min).collect();
    let bound = Bound {
        time_min: sum(&|b| b.time_min),
        error_min: sum(&|b| b.error_min.powi(2)).sqrt(),
        places: each.iter().map(|b| b.places).sum(),
        unreached_mm2: sum(&|b| b.unreached_mm2),
        assumes: format!(
            "every face once but what is left standing, by {} operations that finish it, {}",
            shares.len(),
            first.assumes
        ),
        isoparametric_min: isoparametric.map(|all| all.iter().sum()),
    };
    let length_mm = shares.iter().map(|s| s.contact_length_mm).sum();
    let time = |s: &Share<'_>| s.cutting_min.max(s.contact_length_mm / s.job.feed_mm_min());
    Ok(Some(IdealTime::of(bound, length_mm, shares.iter().map(time).sum())))
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
