//! Roughing in layers with a tool that keeps its axis: every layer takes no more than a step down, and the last ones leave an
//! even allowance on the faces for finishing.
//!
//! The cutter grown by the allowance is dropped onto all faces along parallel rows, which gives the lowest height T of the
//! true tip on each. A layer from c down to z takes the stretches of rows on which `T < c`, at the height `max(z, T)`: so it
//! ends along the allowance and not in steps, and the layer below finds above it what this one has cleared. Rows are a
//! stepover apart; a row is cut to and fro, entered from the row beside it or down a ramp along itself ([`clear`]).

use super::clear::Clearing;
use super::course::Course;
use super::height::Drops;
use super::{DropTask, Ground, Lines, Named, WORTH_A_WORD, areas, frame::Frame, seeds, trace};
use crate::plan::{CcPoint, Linked, Links, Pass, Passes, PlanError, Tolerance};
use osculate_geom::{Box3, Diagnostic, Point3, Surface, Unit3, Vec3};
use osculate_tools::{Cutter, CutterSpec};
use rayon::prelude::*;

/// What to rough.
#[derive(Clone, Copy)]
pub struct RoughTask<'a> {
    /// Faces to machine.
    pub faces: &'a [Named<'a>],
    /// Faces that the tool must not come nearer to than the allowance either.
    pub check: &'a [Named<'a>],
    /// The cutter: a ball, flat or toroidal end.
    pub cutter: &'a Cutter,
    /// The tool axis, from the tip to the holder.
    pub axis: Unit3,
    /// The way of the rows, brought into the plane across the axis.
    pub feed: Vec3,
    /// Box around the raw material.
    pub blank: Box3,
    /// How much is taken and left.
    pub sizes: Sizes,
    /// How the tool goes between rows and layers.
    pub links: &'a Links,
    /// Told how far the work is, 0 to 1.
    pub progress: &'a (dyn Fn(f64) + Sync),
}

/// How much a roughing takes at once and leaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sizes {
    /// Deepest cut along the axis, mm.
    pub stepdown_mm: f64,
    /// Distance of rows, mm.
    pub stepover_mm: f64,
    /// What is left on the faces, mm; zero or more.
    pub allowance_mm: f64,
    /// Steepest way down into material, rad.
    pub ramp_rad: f64,
    /// Deviation of the path's pieces from the allowance, mm.
    pub chord_mm: f64,
}

impl Sizes {
    fn check(&self) -> Result<(), PlanError> {
        for (what, got, least) in [
            ("stepdown_mm", self.stepdown_mm, 0.0),
            ("stepover_mm", self.stepover_mm, 0.0),
            ("chord_mm", self.chord_mm, 0.0),
            ("ramp", self.ramp_rad, 0.0),
            ("allowance_mm", self.allowance_mm, -f64::MIN_POSITIVE),
        ] {
            if !(got > least && got.is_finite()) {
                return Err(PlanError::Tolerance { what, got });
            }
        }
        Ok(())
    }
}

/// Layers, and how they are joined.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Roughing {
    /// Rows in the order of cutting, each a pass.
    pub passes: Passes,
    /// The whole path.
    pub linked: Linked,
    /// Heights of the layers along the axis, from the top, mm.
    pub layers: Vec<f64>,
}

/// A place of a row: along it and the height of the tip, mm.
pub(super) type Place = [f64; 2];

/// A stretch of a row on a layer.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    /// Position of the row across the feed, mm.
    pub y: f64,
    pub places: Vec<Place>,
}

/// Most layers of a job.
const MOST_LAYERS: f64 = 10_000.0;
/// Most rows of a job.
const MOST_ROWS: f64 = 20_000.0;

/// Plans layers.
///
/// # Errors
/// [`PlanError`]: sizes that are none, a cutter whose grown body is none of ours, faces that lie above the raw material, or that
/// the tool does not meet from above.
pub fn z_level(task: &RoughTask<'_>) -> Result<Roughing, PlanError> {
    let s = &task.sizes;
    s.check()?;
    let grown = grown(task.cutter, s.allowance_mm)?;
    let tolerance = Tolerance { scallop_mm: s.chord_mm, gouge_mm: s.chord_mm, chord_mm: s.chord_mm };
    let (faces, check, axis, feed) = (task.faces, task.check, task.axis, task.feed);
    let drop = DropTask { faces, check, cutter: &grown, axis, feed, tolerance, progress: task.progress };
    let surfaces: Vec<&dyn Surface> = faces.iter().chain(check).map(|n| n.surface).collect();
    let frame = Frame::new(axis, &feed);
    let (seeds, spacing, extent) = seeds(&drop, (&surfaces, &areas(&surfaces)), &frame)?;
    let drops = Drops::new(&surfaces, &grown, frame, seeds, spacing);
    let ground = Ground {
        task: &drop,
        lines: Lines::Planes,
        frame,
        drops,
        places: Vec::new(),
        spacing: 0.0,
        judged: Vec::new(),
    };
    (task.progress)(0.1);
    let rows = rows(&ground, task, extent)?;
    (task.progress)(0.8);
    let lowest = rows.iter().flat_map(|r| &r.1).flatten().map(|p| p[1]).fold(f64::INFINITY, f64::min);
    let top = top_mm(&task.blank, &axis);
    let layers = heights(&drop, top, lowest, s.stepdown_mm)?;
    let step = (top - lowest) / layers.len() as f64;
    let mut clearing = Clearing::new(&ground, task, top);
    for z in &layers {
        clearing.layer(pieces(&rows, [*z + step, *z]), [*z + step, *z]);
    }
    (task.progress)(1.0);
    let (linked, cut, left_out) = clearing.done();
    let mut out = Roughing { passes: passes(&frame, &axis, cut), linked, layers };
    let n = out.layers.len();
    out.passes.diagnostics.push(Diagnostic::note(
        "z_level",
        format!(
            "{n} layers of {step:.3} mm, {} rows, {:.0} mm; {} mm are left on the faces",
            out.passes.passes.len(),
            out.linked.cutting_length_mm,
            s.allowance_mm
        ),
    ));
    let area = (extent[1][0] - extent[0][0]) * (extent[1][1] - extent[0][1]);
    if left_out > WORTH_A_WORD * area {
        let text = format!(
            "{left_out:.1} mm2 of layers lie in pockets too short to ramp down into; use a smaller tool there"
        );
        out.passes.diagnostics.push(Diagnostic::loss("z_level", text));
    }
    Ok(out)
}

/// Heights of even layers from the top down to the lowest place of the tool.
fn heights(drop: &DropTask<'_>, top: f64, lowest: f64, stepdown_mm: f64) -> Result<Vec<f64>, PlanError> {
    if !lowest.is_finite() || lowest >= top {
        let why = if lowest.is_finite() {
            format!(
                "what lies under the tool is not below the raw material's top at {top:.3} mm along the axis; check [stock]"
            )
        } else {
            "the tool meets none of it from above; give another axis".to_owned()
        };
        return Err(super::nothing(drop, &why));
    }
    let count = ((top - lowest) / stepdown_mm - 1e-9).ceil().max(1.0);
    if count > MOST_LAYERS {
        return Err(super::nothing(drop, &format!("{count:.0} layers are needed; raise stepdown_mm")));
    }
    let step = (top - lowest) / count;
    Ok((1..=count as usize).map(|k| top - step * k as f64).collect())
}

/// The cutter whose body is everywhere `by_mm` larger; its tip lies that far below.
fn grown(cutter: &Cutter, by_mm: f64) -> Result<Cutter, PlanError> {
    let need = PlanError::Tool { strategy: "z_level", need: "ball, flat or toroidal cutter" };
    if !cutter.is_end_mill() {
        return Err(need);
    }
    let diameter_mm = 2.0 * (cutter.radius_mm() + by_mm);
    let (corner_radius_mm, length_mm) = (cutter.corner_mm() + by_mm, cutter.length_mm() + 2.0 * by_mm);
    let spec = if cutter.is_ball() {
        CutterSpec::Ball { diameter_mm, length_mm }
    } else if corner_radius_mm > 0.0 {
        CutterSpec::Toroidal { diameter_mm, corner_radius_mm, length_mm }
    } else {
        CutterSpec::Flat { diameter_mm, length_mm }
    };
    Cutter::try_from(spec).map_err(|_| need)
}

/// Greatest height of a box along the axis.
pub(super) fn top_mm(b: &Box3, axis: &Unit3) -> f64 {
    let ends = [b.min, b.max];
    (0..8)
        .map(|k| Point3::new(ends[k & 1].x, ends[k >> 1 & 1].y, ends[k >> 2].z).coords.dot(axis))
        .fold(f64::NEG_INFINITY, f64::max)
}

/// A row's position across the feed, and the true tip's heights along its runs.
pub(super) type Row = (f64, Vec<Vec<Place>>);

/// The rows over everything that the tool can meet.
fn rows(ground: &Ground<'_>, task: &RoughTask<'_>, [lo, hi]: [[f64; 2]; 2]) -> Result<Vec<Row>, PlanError> {
    let s = &task.sizes;
    let radius = ground.task.cutter.radius_mm();
    // On a slope the tool touches the edge of a face from outside.
    let wide = hi[1] - lo[1] + 2.0 * radius;
    let count = (wide / s.stepover_mm).ceil() + 1.0;
    if count.is_nan() || count > MOST_ROWS {
        return Err(super::nothing(ground.task, &format!("{count:.0} rows are needed; raise stepover_mm")));
    }
    Ok((0..count as usize)
        .into_par_iter()
        .map(|j| {
            let y = lo[1] - radius + wide * j as f64 / (count - 1.0).max(1.0);
            let ends = [[lo[0] - radius, y], [hi[0] + radius, y]];
            let runs = Course::through(ends).map_or_else(Vec::new, |c| trace::along(ground, &c));
            let places = |p: &Pass| -> Vec<Place> {
                p.points
                    .iter()
                    .map(|p| ground.frame.of(&p.pose.tip))
                    .map(|t| [t[0], t[2] + s.allowance_mm])
                    .collect()
            };
            (y, runs.iter().map(places).collect())
        })
        .collect())
}

/// The stretches of rows that a layer from `ceiling` down to `floor` takes.
fn pieces(rows: &[Row], [ceiling, floor]: [f64; 2]) -> Vec<Piece> {
    let mut out = Vec::new();
    for (y, runs) in rows {
        for run in runs {
            for places in below(run, ceiling) {
                out.push(Piece { y: *y, places: raised(&places, floor) });
            }
        }
    }
    out
}

/// Where a line of heights is on a level between two of its places.
fn crossing(a: Place, b: Place, level: f64) -> Place {
    [a[0] + (b[0] - a[0]) * (level - a[1]) / (b[1] - a[1]), level]
}

/// The parts of a line of heights that lie below a level, each of two places at least.
pub(super) fn below(run: &[Place], level: f64) -> Vec<Vec<Place>> {
    let mut out: Vec<Vec<Place>> = Vec::new();
    let mut part: Vec<Place> = Vec::new();
    for (k, p) in run.iter().enumerate() {
        let before = k.checked_sub(1).map(|k| run[k]);
        let inside = p[1] < level;
        if let Some(b) = before
            && (b[1] < level) != inside
        {
            part.push(crossing(b, *p, level));
        }
        if inside {
            part.push(*p);
        } else if !part.is_empty() {
            out.push(std::mem::take(&mut part));
        }
    }
    out.push(part);
    out.retain(|p| p.len() > 1);
    out
}

/// A line of heights held above a level.
pub(super) fn raised(run: &[Place], level: f64) -> Vec<Place> {
    let mut out: Vec<Place> = Vec::with_capacity(run.len());
    let add = |out: &mut Vec<Place>, p: Place| {
        // Between two others on the level a place says nothing.
        let n = out.len();
        if n >= 2 && out[n - 1][1] == level && out[n - 2][1] == level && p[1] == level {
            out[n - 1] = p;
        } else {
            out.push(p);
        }
    };
    for (k, p) in run.iter().enumerate() {
        if let Some(b) = k.checked_sub(1).map(|k| run[k])
            && (b[1] < level) != (p[1] < level)
        {
            add(&mut out, crossing(b, *p, level));
        }
        add(&mut out, [p[0], p[1].max(level)]);
    }
    out
}

/// Rows as passes; the tool's own tip stands for the contact, which a roughing does not have.
fn passes(frame: &Frame, axis: &Unit3, cut: Vec<Piece>) -> Passes {
    let pass = |piece: Piece| Pass {
        points: piece
            .places
            .iter()
            .map(|p| {
                let tip = frame.point([p[0], piece.y, p[1]]);
                let pose = osculate_tools::Pose { tip, axis: *axis };
                CcPoint {
                    uv: osculate_geom::uv(0.0, 0.0),
                    point: tip,
                    normal: *axis,
                    pose,
                    width_mm: f64::NAN,
                }
            })
            .collect(),
        closed: false,
    };
    Passes { passes: cut.into_iter().map(pass).collect(), diagnostics: Vec::new() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_heights_is_cut_and_held() {
        let run = [[0.0, 4.0], [2.0, 0.0], [4.0, 4.0], [6.0, 0.0]];
        assert_eq!(
            below(&run, 2.0),
            vec![vec![[1.0, 2.0], [2.0, 0.0], [3.0, 2.0]], vec![[5.0, 2.0], [6.0, 0.0]]]
        );
        assert_eq!(raised(&run[..3], 2.0), vec![[0.0, 4.0], [1.0, 2.0], [3.0, 2.0], [4.0, 4.0]]);
    }

    #[test]
    fn a_grown_cutter_is_larger_all_around() {
        let flat = Cutter::try_from(CutterSpec::Flat { diameter_mm: 10.0, length_mm: 30.0 }).unwrap();
        let large = grown(&flat, 0.4).unwrap();
        for [rho, z] in [[0.0, -1.0], [6.0, -0.5], [7.0, 3.0], [5.5, -0.1]] {
            let (a, b) = (flat.local_distance(rho, z), large.local_distance(rho, z + 0.4));
            assert!((a - b - 0.4).abs() < 1e-12, "{a} {b}");
        }
    }
}
