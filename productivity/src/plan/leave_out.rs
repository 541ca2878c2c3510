//! Passes cut where the tool would go into the part: what it cannot machine is left out.
//!
//! The faces are samples in a tree of balls. At poses close to each other along every pass the tree says whether cutter or
//! holder comes nearer to a sample than it may; a signed distance changes by no more than the way to another point, so that
//! balls far off are passed over. A stretch that goes too deep is left out as far as the tool is deeper than half of
//! what is accepted on either side. What remains is the same motion as before, less these stretches.
//!
//! *Limits.* Depth is measured at samples along their normals, as verification does, but for those beside sharp outer edges. Between samples the tool may be a little
//! deeper, and moves between passes are not looked at: verification has the last word.
//! A stretch is left out, never machined in another way: leads are chosen before.

use super::samples::{Wanted, samples};
use super::stations::{Stretches, pieces, stations};
use super::{CcPoint, Named, Pass, Passes, Tolerance};
use crate::axis::{Left, sunk};
use osculate_geom::Surface;
use osculate_tools::reach::Obstacles;
use osculate_tools::removal::{self, JobError, Limits, Sample, SamplingError, Swept, beside_edges};
use osculate_tools::{Cutter, Holder};
use rayon::prelude::*;

/// Most samples that the tool is held against, over all faces, and fewest of one face.
const MOST: f64 = 4e5;
const FEWEST: usize = 4000;
/// Samples by which areas are measured, over all faces to machine.
const MOST_MEASURED: f64 = 4e4;
/// Samples stand no closer than lets the cutter's radius go deeper between them by this part of the gouge tolerance.
const HIDDEN: f64 = 0.05;
/// What half a cell's diagonal and a little bend add to a distance kept at samples, of their spacing.
const ADDED: f64 = 0.75;
/// How far the end of a tool reaches from its contact, in radii: it may touch check faces there, beside an inner edge.
const END: f64 = 3.0;
/// What is kept from points of check faces further off, of their spacing.
const APART: f64 = 0.15;
/// What a tool that comes at a face from beside keeps from it, of the gouge tolerance: more would leave out what lies next to sharp outer
/// edges.
const ASIDE: f64 = 0.1;
/// Distance of poses along a pass, in radii of the cutter.
const STEP: f64 = 0.05;
/// The share of the accepted depth beyond which a stretch is left out: words, chords and edges, along whose normals the depth is more,
/// need the rest.
const ACCEPTED: f64 = 0.7;
/// The share of that for faces that are not machined, which the side of the tool meets at their edges: there the depth grows from
/// nothing to all of it between two samples.
const BESIDE: f64 = 0.4;
/// The share of the accepted depth that ends a stretch left out.
const RELEASE: f64 = 0.5;
/// What remains between two stretches left out is left out too where it is shorter than this part of its strip's width.
const SHORT: f64 = 0.5;

/// What passes are held against. Lengths mm.
#[derive(Clone, Copy)]
pub struct Guard<'a> {
    /// Faces to machine.
    pub faces: &'a [Named<'a>],
    /// Faces that the tool must not cut.
    pub check: &'a [Named<'a>],
    /// Places along the rims of these, which name them by their place among them: samples inside a face end half a cell before its rim.
    pub rims: &'a [Sample],
    /// The cutter with its shank.
    pub cutter: &'a Cutter,
    /// The holder, whose nose sits where the cutter's length ends.
    pub holder: Option<&'a Holder>,
    /// What must hold: the cutter may go as deep into faces to machine as its gouges say.
    pub tolerance: Tolerance,
    /// What cutter and holder keep from check faces, and the holder from faces to machine. Zero: the cutter may go in by the gouge tolerance
    /// as verification accepts it, and the holder keeps off as far as samples may hide something.
    pub keep_off_mm: f64,
    /// Raw material that is left, which the holder must not meet.
    pub left: Left<'a>,
}

/// Passes with what was left out of them.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct LeftOut {
    /// What remains.
    pub passes: Passes,
    /// After each of these passes the poses of the pass that it was cut out of up to the next; none where that is of another.
    pub skipped: Vec<Vec<CcPoint>>,
    /// Passes of which something was left out.
    pub touched: usize,
    /// Of each face to machine, the area that the whole passes cut and what remains of them leaves standing, mm2.
    pub area_mm2: Vec<f64>,
}

/// Why nothing can be said about passes.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LeaveOutError {
    /// A distance that is none.
    #[error("what the tool keeps off must be finite and not negative, got {got} mm")]
    KeepOff {
        /// The value, mm.
        got: f64,
    },
    /// A face that cannot be sampled.
    #[error("face {face}: {source}")]
    Sampling {
        /// The face.
        face: String,
        /// What is wrong.
        source: SamplingError,
    },
    /// What is left cannot be measured.
    #[error(transparent)]
    Removal(#[from] JobError),
}

/// Samples of faces, and their greatest spacing, mm.
fn sampled(faces: &[Named<'_>], [spacing_mm, most]: [f64; 2]) -> Result<(Vec<Sample>, f64), LeaveOutError> {
    let all: Vec<&Named<'_>> = faces.iter().collect();
    let found = samples(&all, Wanted { spacing_mm, most, fewest: FEWEST })
        .map_err(|(face, source)| LeaveOutError::Sampling { face, source })?;
    let coarsest = found.iter().map(|f| f.density.spacing_mm).fold(0.0, f64::max);
    let samples = found.into_iter().flat_map(|f| f.samples).collect();
    Ok((samples, coarsest))
}

/// Points of faces, and the same sunk into them by what is accepted of a pass, and by what ends a stretch left out; those beside sharp
/// outer edges are not sunk.
struct Points {
    at: Obstacles,
    sunk: [Obstacles; 2],
    edges: Obstacles,
}

/// Samples sunk into their faces.
fn obstacles<'s>(samples: impl Iterator<Item = &'s Sample>, by_mm: f64) -> Obstacles {
    // Samples have finite coordinates, and there are far fewer than an index can hold.
    Obstacles::new(samples.map(|s| sunk(s, by_mm))).unwrap_or_default()
}

impl Points {
    /// `beside`: samples beside sharp outer edges, beneath which nothing lies as deep as is accepted. A tool on the next face goes
    /// along them without harm.
    fn new(samples: &[Sample], beside: &[bool], deep_mm: [f64; 2]) -> Self {
        let those = |wanted: bool| {
            samples.iter().zip(beside).filter(move |(_, beside)| **beside == wanted).map(|(s, _)| s)
        };
        Self {
            at: obstacles(samples.iter(), 0.0),
            sunk: deep_mm.map(|mm| obstacles(those(false), mm)),
            edges: obstacles(those(true), 0.0),
        }
    }
}

/// Which depth counts.
#[derive(Clone, Copy)]
enum Depth {
    Accepted,
    Release,
}

/// Faces and tool ready to be asked.
struct Watch<'a> {
    guard: &'a Guard<'a>,
    faces: Points,
    check: Points,
    /// Raw material that is left.
    left: Obstacles,
    /// What the side of the tool keeps from check faces further from its contact than its end reaches, mm: a side that is hardly in an edge
    /// goes deep along its normal between two points.
    apart_mm: f64,
    /// Samples are sunk by so much more, and a tool keeps that from them: one that lies along a face may be as deep as it may, one that
    /// comes at it from beside, over an edge, keeps off, mm.
    aside_mm: f64,
    /// Distance that is kept from check faces by the cutter, mm; None where it may go in as far as is accepted.
    keep_mm: Option<f64>,
    /// Distance that the holder keeps from all faces, mm.
    holder_mm: f64,
}

impl<'a> Watch<'a> {
    fn new(guard: &'a Guard<'a>) -> Result<Self, LeaveOutError> {
        let keep = guard.keep_off_mm;
        if !(keep >= 0.0 && keep.is_finite()) {
            return Err(LeaveOutError::KeepOff { got: keep });
        }
        let gouge_mm = guard.tolerance.gouge_mm;
        // Between two samples on a plane a ball comes deeper by s^2 / 8 r.
        let spacing_mm = (8.0 * guard.cutter.radius_mm() * HIDDEN * gouge_mm).sqrt();
        let (faces, apart) = sampled(guard.faces, [spacing_mm, MOST])?;
        let (mut check, check_apart) = sampled(guard.check, [spacing_mm, MOST])?;
        check.extend(guard.rims);
        let holder_mm = keep + ADDED * apart.max(check_apart);
        let keep_mm = (keep > 0.0).then_some(holder_mm);
        let aside_mm = (ASIDE * gouge_mm).min(guard.tolerance.chord_mm);
        let deep_mm = |gouge_mm: f64| [ACCEPTED, RELEASE].map(|share| share * gouge_mm + aside_mm);
        let (own_mm, others_mm) = (deep_mm(gouge_mm), deep_mm(BESIDE * gouge_mm));
        // All faces together, those to machine first.
        let surfaces: Vec<&dyn Surface> = guard.faces.iter().chain(guard.check).map(|f| f.surface).collect();
        let first = guard.faces.len() as u32;
        let all: Vec<Sample> = faces
            .iter()
            .copied()
            .chain(check.iter().map(|s| Sample { face: s.face + first, ..*s }))
            .collect();
        let accepted_mm = |s: &Sample| if s.face < first { own_mm[0] } else { others_mm[0] };
        let beside = beside_edges(&surfaces, &all, apart.max(check_apart), accepted_mm);
        let (of_faces, of_check) = beside.split_at(faces.len());
        let faces = Points::new(&faces, of_faces, own_mm);
        let check = Points::new(&check, of_check, others_mm);
        let left = Obstacles::new(guard.left.obstacles()).unwrap_or_default();
        Ok(Self { guard, faces, check, left, apart_mm: APART * check_apart, aside_mm, keep_mm, holder_mm })
    }

    /// Whether the tool is where it must not be.
    fn is_in(&self, at: &CcPoint, depth: Depth) -> bool {
        let Guard { cutter, holder, .. } = self.guard;
        let (pose, end_mm) = (&at.pose, END * cutter.radius_mm());
        // Into an edge the tool goes no deeper than into the faces on both sides of it.
        let edge_mm = -[ACCEPTED, RELEASE][depth as usize] * self.guard.tolerance.gouge_mm;
        let is_sunk = |points: &Points| {
            points.sunk[depth as usize].is_within(cutter, pose, self.aside_mm)
                || points.edges.is_within(cutter, pose, edge_mm)
        };
        is_sunk(&self.faces)
            || self
                .keep_mm
                .map_or_else(|| is_sunk(&self.check), |mm| self.check.at.is_within(cutter, pose, mm))
            || self.check.at.is_within_beyond((cutter, pose), self.apart_mm, (&at.point, end_mm))
            || holder.is_some_and(|h| {
                let mut sections = h.posed(cutter, pose);
                sections.any(|(body, at)| {
                    let faces = [&self.faces, &self.check];
                    faces.iter().any(|f| f.at.is_within(body, &at, self.holder_mm))
                        || self.left.is_within(body, &at, self.guard.left.keep_mm())
                })
            })
    }

    /// The pieces of a pass that remain; None where it remains whole.
    fn remaining(&self, pass: &Pass) -> Option<Stretches> {
        let stations = stations(pass, STEP * self.guard.cutter.radius_mm());
        let mut out: Vec<bool> = stations.iter().map(|s| self.is_in(&s.point, Depth::Accepted)).collect();
        if !out.iter().any(|b| *b) {
            return None;
        }
        // Both ways from what is left out, as far as the tool is in by the lesser limit.
        let n = out.len();
        let grow = |out: &mut Vec<bool>, order: &mut dyn Iterator<Item = usize>| {
            let mut before = false;
            for k in order {
                out[k] = out[k] || (before && self.is_in(&stations[k].point, Depth::Release));
                before = out[k];
            }
        };
        // A closed pass goes on over its end: twice around reaches everywhere.
        let rounds = if pass.closed { 2 } else { 1 };
        grow(&mut out, &mut (0..rounds * n).map(|k| k % n));
        grow(&mut out, &mut (0..rounds * n).rev().map(|k| k % n));
        // One station more: the depth of a tool that comes at a wall straight grows fast.
        let near = |k: usize| k > 0 && out[k - 1] || k + 1 < n && out[k + 1];
        let out: Vec<bool> = (0..n).map(|k| out[k] || near(k)).collect();
        Some(pieces(pass, &stations, &out, SHORT))
    }
}

/// Area of each face that one set of passes cuts and another leaves standing, mm2.
fn left_standing(guard: &Guard<'_>, whole: &[Pass], rest: &[Pass]) -> Result<Vec<f64>, LeaveOutError> {
    let (samples, _) = sampled(guard.faces, [STEP * guard.cutter.radius_mm(), MOST_MEASURED])?;
    let t = guard.tolerance;
    let uncut_mm = Limits::new(t.scallop_mm, t.gouge_mm).uncut_mm;
    let standing = |passes: &[Pass]| -> Result<Vec<bool>, LeaveOutError> {
        let pairs = passes.iter().zip(0u32..).flat_map(|(p, k)| p.points.windows(2).map(move |w| (w, k)));
        let motions: Vec<Swept> =
            pairs.map(|(w, block)| Swept { from: w[0].pose, to: w[1].pose, rapid: false, block }).collect();
        let work = removal::Job {
            cutter: guard.cutter,
            holder: None,
            changes: &[],
            motions: &motions,
            samples: &samples,
            stock_mm: 2.0 * uncut_mm,
            depth_mm: guard.cutter.radius_mm(),
        };
        Ok(removal::cut(&work, &|_| {})?.iter().map(|c| c.standoff_mm > uncut_mm).collect())
    };
    let (before, after) = (standing(whole)?, standing(rest)?);
    let mut out = vec![0.0; guard.faces.len()];
    for ((s, before), after) in samples.iter().zip(before).zip(after) {
        if after && !before {
            out[s.face as usize] += s.area_mm2;
        }
    }
    Ok(out)
}

/// Leaves out of passes what the tool cannot machine without going into the part or the check faces.
///
/// Without such places the passes come back as they are. A closed pass of which something is left out is open.
///
/// # Errors
/// A distance to keep off that is none, or faces and passes that cannot be measured.
pub fn leave_out(passes: &Passes, guard: &Guard<'_>) -> Result<LeftOut, LeaveOutError> {
    let watch = Watch::new(guard)?;
    let remaining: Vec<Option<Stretches>> = passes.passes.par_iter().map(|p| watch.remaining(p)).collect();
    let area_mm2 = vec![0.0; guard.faces.len()];
    if remaining.iter().all(Option::is_none) {
        let skipped = vec![Vec::new(); passes.passes.len()];
        return Ok(LeftOut { passes: passes.clone(), skipped, touched: 0, area_mm2 });
    }
    let touched = remaining.iter().filter(|r| r.is_some()).count();
    let pieces = passes.passes.iter().zip(remaining);
    let rest: Stretches = pieces.map(|(p, r)| r.unwrap_or_else(|| vec![p.clone()].into())).collect();
    let area_mm2 = left_standing(guard, &passes.passes, &rest.passes)?;
    Ok(LeftOut {
        passes: Passes { passes: rest.passes, diagnostics: passes.diagnostics.clone() },
        skipped: rest.skipped,
        touched,
        area_mm2,
    })
}
