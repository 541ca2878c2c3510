//! A coarse look at what a CL path leaves: enough to choose between plans, not to judge one.

use crate::failure::Failure;
use crate::job::Job;
use crate::part::{LoadedFace, Part, area};
use crate::work::budget;
use osculate_geom::Surface;
use osculate_productivity::plan::Linked;
use osculate_tools::removal::{self, Limits, Sample, Swept};

/// Samples on the machined faces, and on the check faces.
const SAMPLES: usize = 30_000;
const CHECK_SAMPLES: usize = 10_000;
/// Share of the area that may stand higher: samples this far apart say little about the rest.
const TAIL: f64 = 0.01;
/// Beside what is left out strips end: with them so many times its area may stand higher. (Tried on both sides of a blade on its platform.)
const BESIDE: f64 = 3.0;
/// Of the stock looked at, what is left of it where nothing cut.
const UNCUT: f64 = 0.999;

/// What a path leaves and takes, mm.
#[derive(Clone, Debug)]
pub struct Look {
    /// Deepest gouge of the cutter, in check faces too.
    pub gouge_mm: f64,
    /// Heights and areas of the samples, the highest first; of the stock looked at where that is less.
    heights: Vec<[f64; 2]>,
    /// The area where nothing cut, mm2.
    pub uncut_mm2: f64,
    /// The most that the holder took.
    pub holder_mm: f64,
}

impl Look {
    /// Looks at a path.
    pub fn at(job: &Job, faces: &Part, linked: &Linked) -> Result<Self, Failure> {
        let (cutter, holder, tolerance) = (job.cutter(), job.holder(), job.tolerance());
        let (mut samples, mut apart_mm) = (Vec::new(), 0.0_f64);
        let mut number = 0;
        for (all, count, check_only) in [(&faces.faces, SAMPLES, false), (&faces.check, CHECK_SAMPLES, true)]
        {
            let total: f64 = all.iter().map(area).sum();
            let spacing = (total / count as f64).sqrt();
            apart_mm = apart_mm.max(spacing);
            for face in all {
                let found = sampled(face, number, spacing, count)?;
                number += 1;
                samples.extend(found.into_iter().map(|s| Sample { check_only, ..s }));
            }
        }
        let motions = Swept::along(&linked.path);
        let work = removal::Job {
            cutter: &cutter,
            holder,
            changes: &[],
            motions: &motions,
            samples: &samples,
            stock_mm: 5.0 * tolerance.scallop_mm,
            depth_mm: cutter.radius_mm(),
        };
        let mut cuts = removal::cut(&work, &|_| {}).map_err(Failure::job)?;
        // Where a tool goes over an edge, the depth along the normal of the wall below it says nothing.
        let surfaces: Vec<&dyn Surface> =
            faces.faces.iter().chain(&faces.check).map(|f| &*f.surface as &dyn Surface).collect();
        let limit_mm = budget::left_in(job).gouge_mm;
        removal::measure_beside_edges(&surfaces, (&samples, apart_mm), &mut cuts, limit_mm);
        let machined = samples.iter().zip(&cuts).filter(|(s, _)| !s.check_only);
        let mut heights: Vec<[f64; 2]> = machined.map(|(s, c)| [c.standoff_mm, s.area_mm2]).collect();
        heights.sort_by(|a, b| b[0].total_cmp(&a[0]));
        let uncut = heights.iter().take_while(|h| h[0] > UNCUT * work.stock_mm);
        Ok(Self {
            uncut_mm2: uncut.map(|h| h[1]).sum(),
            gouge_mm: cuts.iter().map(|c| -c.standoff_mm).fold(0.0, f64::max),
            heights,
            holder_mm: cuts.iter().filter_map(|c| c.holder).map(|t| t.removed_mm).fold(0.0, f64::max),
        })
    }

    /// Height that all but a hundredth of the area stays below, and an area that is left to others, mm.
    fn left_mm(&self, others_mm2: f64) -> f64 {
        let mut tail = tail_mm2(self.heights.iter().map(|h| h[1]).sum(), others_mm2);
        let left = self.heights.iter().find(|h| {
            tail -= h[1];
            tail < 0.0
        });
        left.map_or(0.0, |h| h[0].max(0.0))
    }

    /// Why the path cannot be within tolerance, but for an area that is left to others; None where it may be.
    pub fn objection(&self, job: &Job, others_mm2: f64) -> Result<Option<Objection>, Failure> {
        let t = job.tolerance();
        let collision = Limits::new(t.scallop_mm, t.gouge_mm).collision_mm;
        // Verdicts add what words and blended corners may take: with less room than that nothing can be shown to hold.
        let left_mm = budget::left_in(job).gouge_mm;
        let found = [
            ("gouges", self.gouge_mm, left_mm),
            ("its holder takes", self.holder_mm, collision),
            ("leaves", self.left_mm(others_mm2), t.scallop_mm),
        ];
        let bad = found.into_iter().enumerate().find(|(_, (_, is, limit))| is > limit);
        Ok(bad.map(|(k, (what, is, limit))| Objection {
            dug: (k == 0).then_some(Excess { is_mm: is, may_mm: limit }),
            left: (k == 2).then_some(Excess { is_mm: is, may_mm: limit }),
            hidden: false,
            text: format!("{what} {is:.4} mm by a coarse look, {limit:.4} mm is accepted"),
        }))
    }
}

/// The area that may stand higher than the tolerance, of all and with what is left to others.
fn tail_mm2(all_mm2: f64, others_mm2: f64) -> f64 {
    TAIL * all_mm2 + BESIDE * others_mm2
}

/// What may stand too high of faces of which so much is left to others, mm2.
pub fn accepted_mm2(job: &Job, faces: &Part, others_mm2: f64) -> f64 {
    let all_mm2 = faces.faces.iter().map(area).sum();
    let others = if others_mm2 > 0.0 { tail_mm2(all_mm2, others_mm2) } else { 0.0 };
    job.unreached_mm2() + others
}

/// What a path leaves or takes, and what it may, mm: without what another layout of passes leaves as it is, as far as that is known (marks of teeth,
/// blended corners).
#[derive(Clone, Copy, Debug)]
pub struct Excess {
    /// What it leaves or takes.
    pub is_mm: f64,
    /// What it may.
    pub may_mm: f64,
}

/// Why a path cannot be within tolerance.
#[non_exhaustive]
pub struct Objection {
    /// How deep the cutter goes, where that is too deep, which a smaller lead does not make better.
    pub dug: Option<Excess>,
    /// What it leaves, where nothing is wrong but that.
    pub left: Option<Excess>,
    /// Whether that is what may be hidden between samples, and not what was found at one.
    pub hidden: bool,
    /// In words.
    pub text: String,
}

fn sampled(face: &LoadedFace, number: u32, spacing_mm: f64, most: usize) -> Result<Vec<Sample>, Failure> {
    removal::sample_surface(&*face.surface, number, spacing_mm, most)
        .map(|found| found.samples)
        .map_err(|e| Failure::job(format!("{}: {e}", face.id)))
}
