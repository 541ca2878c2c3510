//! From a motion to a pass: tip and length of the cutter, clear of check faces, straight ways before and after.

use crate::failure::Failure;
use crate::job::Job;
use crate::job::words::Tip;
use crate::part::LoadedFace;
use crate::work::flank::methods::Motion;
use crate::work::verify::Verified;
use osculate_geom::{Diagnostic, Interval, Point3, Surface, uv};
use osculate_productivity::plan::{CcPoint, Pass, Passes};
use osculate_tools::Cutter;
use osculate_tools::flank::axes::{AxisPoints, AxisSurface};
use osculate_tools::flank::envelope::{Envelope, Scratch};
use osculate_tools::flank::path::{Placed, Reach, Stepping, beyond, poses, way_parameter};
use rayon::prelude::*;
use serde::Serialize;

/// Way beyond a radius before and after the face where the job does not say, mm.
const BEYOND_MM: f64 = 2.0;
/// Part of the way to the middle of the face at which a normal is taken where there is none: a thousandth of the length
/// off along a root.
const ASIDE: f64 = 1e-6;
/// Points of check faces along each parameter.
const CHECKS: usize = 48;
/// Steps in which the tool is raised from a check face, of the rule's length.
const RAISES: f64 = 200.0;

/// What a path is made of.
pub struct Work<'a> {
    /// The job.
    pub job: &'a Job,
    /// The face, u along.
    pub face: &'a dyn Surface,
    /// Where it is judged.
    pub judge: Interval,
    /// The cutter.
    pub cutter: &'a Cutter,
    /// The motion of the axis.
    pub motion: &'a Motion,
    /// Faces to keep clear of.
    pub check: &'a [LoadedFace],
    /// Chord tolerance of the path.
    pub chord_mm: f64,
}

/// The spindle at the end of the rules that the job asks for.
pub fn oriented(job: &Job, motion: &Motion) -> Result<Motion, Failure> {
    let turn = match job.flank().tip {
        Tip::V0 => false,
        Tip::V1 => true,
        Tip::Auto => {
            let up: f64 = motion.pieces.iter().map(|p| p.pose(p.range().at(0.5), 0.0).axis.z).sum();
            up < -1e-6
        }
    };
    if !turn {
        return Ok(motion.clone());
    }
    if !motion.side.is_cylinder() {
        // The shape of the cutter depends on its end: the face itself is to be turned over.
        return Err(Failure::file(
            job.path(),
            "[flank] a cutter that is no cylinder stands with its tip at v = 0: exchange the directrices, or say tip = \"v0\" \
             if the spindle may point down",
        ));
    }
    Ok(Motion { pieces: motion.pieces.iter().map(AxisSurface::reversed).collect(), ..motion.clone() })
}

/// The straight way before and after the face.
pub fn lead_mm(job: &Job, cutter: &Cutter) -> f64 {
    job.flank().lead_mm.unwrap_or(cutter.radius_mm() + BEYOND_MM)
}

/// The pass of a motion.
pub fn pass(work: &Work<'_>) -> Result<Passes, Failure> {
    let (job, cutter) = (work.job, work.cutter);
    let fail = |text: String| Failure::file(job.path(), format!("[flank] {text}"));
    let [axes] = work.motion.pieces.as_slice() else {
        return Err(fail(format!(
            "method = \"{}\" has no position at some rules of the span: choose another, or a span_u where it has",
            job.flank().method.word()
        )));
    };
    let mut notes = Vec::new();
    let envelope = Envelope::new(work.motion.side, &work.motion.pieces);
    let reach = Reach::of(&envelope, work.face, work.judge)
        .ok_or_else(|| fail("the motion does not come near the face".to_owned()))?;
    let mut tip_mm = work.motion.tip_mm.unwrap_or_else(|| reach.tip_mm(cutter, job.flank().below_mm));
    let lead_mm = lead_mm(job, cutter);
    let stepping =
        |tip_mm: f64| Stepping { tip_mm, top_mm: reach.highest_mm, chord_mm: 0.5 * work.chord_mm, lead_mm };
    let points = check_points(work.check);
    if !points.is_empty() {
        let step = (reach.highest_mm - reach.lowest_mm) / RAISES;
        let most = (RAISES * 0.9) as usize;
        let clear = |tip: f64| clearance_mm(cutter, &poses(axes, &stepping(tip)), &points) >= 0.0;
        let raised = (0..=most).find(|k| clear(tip_mm + *k as f64 * step));
        match raised {
            Some(0) => {}
            Some(k) if work.motion.tip_mm.is_none() => {
                let by = k as f64 * step;
                tip_mm += by;
                notes.push(Diagnostic::warning(
                    "check_faces",
                    format!("the tool is raised by {by:.3} mm to stay clear of them: that much of the face's lower end is left"),
                ));
            }
            _ => notes.push(Diagnostic::warning(
                "check_faces",
                "the tool cannot be raised clear of them along its axis; the verification says where it touches",
            )),
        }
    }
    let need = reach.length_mm(tip_mm, 0.0);
    if cutter.length_mm() < need {
        return Err(Failure::file(
            job.path(),
            format!(
                "[tool] length_mm = {}: the cutter must be at least {need:.3} mm long to reach over the whole face",
                cutter.length_mm()
            ),
        ));
    }
    let placed = poses(axes, &stepping(tip_mm));
    let mut points = Vec::with_capacity(placed.len());
    for p in placed {
        let u = work.judge.bring(p.tau);
        let at = uv(u, 0.5);
        let jet = work.face.jet2(at);
        let (point, normal) = match jet.normal() {
            Ok(normal) => (jet.point, normal),
            // At a rule with infinite derivatives the normal is that of the rules beside it.
            Err(e) => {
                let aside = work.face.jet2(uv(u + ASIDE * (work.judge.at(0.5) - u), 0.5)).normal();
                let normal = aside.map_err(|_| fail(format!("no normal at u = {}: {e}", p.tau)))?;
                (work.face.point(at), normal)
            }
        };
        let width_mm = (work.face.point(uv(u, 1.0)) - work.face.point(uv(u, 0.0))).norm();
        points.push(CcPoint { uv: at, point, normal, pose: p.pose, width_mm });
    }
    Ok(Passes { passes: vec![Pass { points, closed: false }], diagnostics: notes })
}

/// The program held against the envelope of the motion that it was made from.
#[derive(Debug, Clone, Copy, Default, Serialize)]
#[non_exhaustive]
pub struct Agreement {
    /// Samples compared: those of the machined face that the program cut and the envelope lies over.
    pub samples: usize,
    /// Greatest difference of the heights along the normals, mm.
    pub max_mm: f64,
    /// Of 99 in 100 samples, mm.
    pub p99_mm: f64,
}

/// Heights left by the program, as verified, against those of the envelope with its straight ways.
pub fn agreement(motion: &Motion, lead_mm: f64, verified: &Verified) -> Agreement {
    let mut pieces = motion.pieces.clone();
    if let [axes] = motion.pieces.as_slice() {
        pieces.extend(leads(axes, lead_mm));
    }
    let envelope = Envelope::new(motion.side, &pieces);
    // The even samples: those added crowd where limits are near.
    let even = verified.summary.samples - verified.summary.added_samples;
    let pairs: Vec<_> = verified.verdict.samples().iter().zip(verified.verdict.cuts()).take(even).collect();
    let mut differences: Vec<f64> = pairs
        .par_iter()
        .map_init(Scratch::default, |scratch, (sample, cut)| {
            let machined = !sample.check_only && sample.face == 0 && cut.by.is_some();
            let height = envelope.height_mm(&sample.point, &sample.normal, scratch).filter(|_| machined)?;
            Some((height - cut.standoff_mm).abs())
        })
        .flatten()
        .collect();
    differences.sort_by(f64::total_cmp);
    let at = |share: f64| {
        let k = (share * differences.len().saturating_sub(1) as f64) as usize;
        differences.get(k).copied().unwrap_or(0.0)
    };
    Agreement { samples: differences.len(), max_mm: at(1.0), p99_mm: at(0.99) }
}

/// The straight ways before and after a motion.
fn leads(axes: &AxisSurface, lead_mm: f64) -> Vec<AxisSurface> {
    let range = axes.range();
    let way = |from: f64, to: f64| {
        let places: Vec<AxisPoints> =
            (0..=3).map(|k| beyond(axes, from + (to - from) * f64::from(k) / 3.0)).collect();
        AxisSurface::along(Interval::new(from, to), &places).ok()
    };
    let share = way_parameter(axes, lead_mm);
    let mut out = Vec::new();
    if share[0] > 0.0 {
        out.extend(way(range.lo - share[0], range.lo));
    }
    if share[1] > 0.0 {
        out.extend(way(range.hi, range.hi + share[1]));
    }
    out
}

fn check_points(faces: &[LoadedFace]) -> Vec<Point3> {
    faces.iter().flat_map(|f| crate::part::grid(&*f.surface, CHECKS)).map(|(_, p, _)| p).collect()
}

/// Least distance of the cutter from points, over poses.
fn clearance_mm(cutter: &Cutter, placed: &[Placed], points: &[Point3]) -> f64 {
    placed
        .iter()
        .flat_map(|p| points.iter().map(move |q| cutter.distance(&p.pose, q)))
        .fold(f64::INFINITY, f64::min)
}
