//! What isoparametric passes could take: between the ideal, whose feed directions are free at every point, and a plan.
//!
//! A pass has the lead of the widest strip at each of its places, in the sense in which it runs there, and the next one lies as far away as
//! its narrowest place allows; passes run to and fro, half of them in either sense. A face may be cut across its passes into a few regions at no
//! cost. Tool and parameter are the best for each face as a whole.
//!
//! *Error.* A sum over a lattice of places; strips are those of charts, which see what lies about a tool's radius around a contact, and are
//! taken to reach as far to the left as to the right. Fractions of passes count as such. No overlap, no links, no limits of the machine.

use super::{BALL_LEAD_RAD, Feeding, LOOK_REACH, MOST_LEAD_RAD, Patch, peak};
use crate::optimum::{self, OptimumError, Range};
use crate::plan::Tolerance;
use osculate_geom::{Axis, Surface, Uv};
use osculate_tools::strip::{Chart, Within};
use osculate_tools::{Cutter, Lean};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Leads that are looked at, by equal factors, before the best is looked for closer.
const LEADS: i32 = 24;
/// Misfit of charts, of the tolerance.
const MISFIT: f64 = 0.05;
/// Most regions of a face.
const REGIONS: usize = 4;

/// The least time of isoparametric passes over faces, min, at `side` x `side` places of each; None where some face has none for which any tool
/// leaves a strip.
///
/// ```
/// use osculate_geom::{Domain, Interval, analytic::Plane};
/// use osculate_productivity::ideal::{Feeding, Patch, isoparametric_min};
/// use osculate_productivity::plan::Tolerance;
/// use osculate_tools::{Cutter, CutterSpec};
///
/// let plane = Plane::new(Domain { u: Interval::new(0.0, 40.0), v: Interval::new(0.0, 40.0) });
/// let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 10.0, length_mm: 50.0 })?;
/// let tolerance = Tolerance { scallop_mm: 0.02, gouge_mm: 0.005, chord_mm: 0.005 };
/// let faces = [Patch { surface: &plane, area_mm2: 1600.0 }];
/// let tools = [Feeding { cutter: &ball, feed_mm_min: 2000.0 }];
/// let least = isoparametric_min(&faces, &tools, &tolerance, 4)?.unwrap();
/// // Area over feed times strip, 2 sqrt(h (2 R - h)).
/// let width_mm = 2.0 * f64::sqrt(0.02 * (10.0 - 0.02));
/// assert!((least * 2000.0 * width_mm / 1600.0 - 1.0).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`OptimumError`] of limits that are none and of an empty list of tools.
pub fn isoparametric_min(
    faces: &[Patch<'_>],
    tools: &[Feeding<'_>],
    tolerance: &Tolerance,
    side: usize,
) -> Result<Option<f64>, OptimumError> {
    if tools.is_empty() {
        return Err(OptimumError::NoTools);
    }
    for tool in tools {
        let limits = super::limits(tool, tolerance, Range::only(0.0));
        optimum::check(std::slice::from_ref(tool.cutter), &limits)?;
    }
    let within = Within { scallop_mm: tolerance.scallop_mm, gouge_mm: tolerance.gouge_mm };
    let over = |face: &Patch<'_>| {
        let each = tools.iter().flat_map(|tool| [Axis::U, Axis::V].map(|along| (tool, along)));
        let times = each.filter_map(|(tool, along)| {
            let lattice = lattice(face, tool.cutter, (along, side), within)?;
            Some(length_mm(&lattice, side) / tool.feed_mm_min)
        });
        times.min_by(f64::total_cmp)
    };
    Ok(faces.iter().map(over).sum())
}

/// What a place asks of passes of either sense, and how long they are there; None outside the trims.
type Place = Option<Asked>;

#[derive(Clone, Copy)]
struct Asked {
    /// Passes that go through the lattice's cell, at the place's own width, running either way.
    passes: [f64; 2],
    /// Length of one of them in the cell, mm, and the cell's area.
    length_mm: f64,
    area_mm2: f64,
}

/// Places of a face in rows across the passes; None where the tool leaves no strip at one of them.
fn lattice(
    face: &Patch<'_>,
    cutter: &Cutter,
    (along, side): (Axis, usize),
    within: Within,
) -> Option<Vec<Place>> {
    let surface = face.surface;
    let domain = surface.domain();
    let part = |k: usize| (k as f64 + 0.5) / side as f64;
    // The steps of a cell along the passes and across them, mm, and the widths.
    let seen = |k: usize| -> Option<Place> {
        let (t, x) = (part(k / side), part(k % side));
        let at = if along == Axis::U { domain.at(t, x) } else { domain.at(x, t) };
        let jet = surface.jet2(at);
        if !surface.contains(at) || jet.forms().is_err() {
            return Some(None);
        }
        let step = |axis: Axis| {
            let d = if axis == Axis::U { jet.du } else { jet.dv };
            d * (domain.get(axis).length() / side as f64)
        };
        let (way, other) = (step(along), step(along.other()));
        let (length_mm, area_mm2) = (way.norm(), way.cross(&other).norm());
        let widths = widths(surface, at, cutter, along, within)?;
        Some(Some(Asked { passes: widths.map(|w| area_mm2 / length_mm / w), length_mm, area_mm2 }))
    };
    let mut all: Vec<Place> = (0..side * side).into_par_iter().map(seen).collect::<Option<_>>()?;
    let cells_mm2: f64 = all.iter().flatten().map(|p| p.area_mm2).sum();
    if cells_mm2 == 0.0 {
        return None;
    }
    // The cells' areas add up to the face's.
    let scale = face.area_mm2 / cells_mm2;
    all.iter_mut().flatten().for_each(|p| p.passes = p.passes.map(|x| x * scale));
    Some(all)
}

/// The widest strips at a place for passes along a parameter and against it, mm; None where there is none.
fn widths(surface: &dyn Surface, at: Uv, cutter: &Cutter, along: Axis, within: Within) -> Option<[f64; 2]> {
    let chart = Chart::new(surface, at, LOOK_REACH * cutter.radius_mm(), MISFIT * within.scallop_mm).ok()?;
    let jet = surface.jet2(at);
    let way = if along == Axis::U { jet.du } else { jet.dv };
    let [x, y] = chart.forms.frame.map(|e| way.dot(&e));
    let angle_rad = (y * jet.side.sign()).atan2(x);
    let widest = |angle_rad: f64| {
        let width = |lead_rad: f64| {
            let lean = Lean { lead_rad, tilt_rad: 0.0 };
            chart.strip(cutter, angle_rad, lean, within).map_or(0.0, |strip| strip.width_mm)
        };
        if cutter.is_ball() {
            return width(BALL_LEAD_RAD);
        }
        let least = cutter.least_lean_rad().max(f64::MIN_POSITIVE);
        let factor = (MOST_LEAD_RAD / least).powf(1.0 / f64::from(LEADS));
        let leads = (0..=LEADS).map(|k| least * factor.powi(k));
        let (_, best) =
            leads.map(|lead| (width(lead), lead)).fold((0.0, least), |a, b| if b.0 > a.0 { b } else { a });
        peak(|lead| width(lead.max(least)), best, factor.sqrt())
    };
    let widths = [angle_rad, angle_rad + PI].map(widest);
    widths.iter().all(|w| *w > 0.0).then_some(widths)
}

/// The length of passes over a lattice, cut across them into regions where that is shorter, mm.
fn length_mm(lattice: &[Place], side: usize) -> f64 {
    // Of the places from one row across the passes to before another.
    let cost = |from: usize, to: usize| -> f64 {
        let line = |x: usize| {
            let places = || (from..to).filter_map(|t| lattice[t * side + x]);
            let narrowest = |sense: usize| places().map(|p| p.passes[sense]).fold(0.0, f64::max);
            0.5 * (narrowest(0) + narrowest(1)) * places().map(|p| p.length_mm).sum::<f64>()
        };
        (0..side).map(line).sum()
    };
    let mut least: Vec<f64> = (0..=side).map(|to| cost(0, to)).collect();
    for _ in 1..REGIONS {
        let cut = |to: usize| (1..to).map(|from| least[from] + cost(from, to)).fold(least[to], f64::min);
        least = (0..=side).map(cut).collect();
    }
    least[side]
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::analytic::Sphere;
    use osculate_tools::CutterSpec;

    const TOLERANCE: Tolerance = Tolerance { scallop_mm: 0.01, gouge_mm: 0.002, chord_mm: 0.002 };

    /// A ball's strip on a sphere is the same everywhere; parallels come together, so that meridians would lie closer than they must.
    #[test]
    fn a_ball_on_a_sphere_needs_parallels() {
        let sphere = Sphere::new(30.0).unwrap();
        let area_mm2 = 4.0 * PI * 900.0;
        let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 10.0, length_mm: 80.0 }).unwrap();
        let tools = [Feeding { cutter: &ball, feed_mm_min: 1500.0 }];
        let faces = [Patch { surface: &sphere, area_mm2 }];
        let found = isoparametric_min(&faces, &tools, &TOLERANCE, 8).unwrap().unwrap();
        let search = super::super::Search { places: 16, tilt: Range::only(0.0) };
        let free = super::super::ideal(&faces, &tools, &TOLERANCE, search).unwrap().time_min;
        assert!((found / free - 1.0).abs() < 1e-3, "{found} {free}");
    }

    /// Two halves of a lattice that need one pass and three: two regions take the mean, and no number of regions less.
    #[test]
    fn regions_cut_where_the_need_changes() {
        let side = 6;
        let place = |k: usize| {
            let many = if k / side < 3 { 1.0 } else { 3.0 };
            Some(Asked { passes: [many; 2], length_mm: 2.0, area_mm2: 1.0 })
        };
        let lattice: Vec<Place> = (0..side * side).map(place).collect();
        assert!((length_mm(&lattice, side) - 6.0 * (6.0 * 1.0 + 6.0 * 3.0)).abs() < 1e-12);
    }

    #[test]
    fn no_tools_are_an_error() {
        assert_eq!(isoparametric_min(&[], &[], &TOLERANCE, 4), Err(OptimumError::NoTools));
    }
}
