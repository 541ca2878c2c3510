//! Roughing in layers with a tool that keeps its axis: every layer takes no more than a step down, and the last ones leave an
//! even allowance on the faces for finishing.
//!
//! The cutter grown by the allowance is dropped onto all faces along parallel rows, which gives the lowest height T of the
//! true tip on each. A layer from c down to z takes the stretches of rows on which `T < c`, at the height `max(z, T)`: so it
//! ends along the allowance and not in steps, and the layer below finds above it what this one has cleared. Rows are a
//! stepover apart; a row is cut to and fro, entered from the row beside it or down a ramp along itself ([`clear`]).

use super::clear::Clearing;
use super::course::Course;
use super::frame::Frame;
use super::ground::{DropTask, Ground, Lines, WORTH_A_WORD, areas, nothing, seeds};
use super::height::Drops;
use super::pieces::{Piece, Place, RoughTask, Roughing, below, raised, top_mm};
use super::trace;
use crate::plan::{CcPoint, Pass, Passes, PlanError, Tolerance};
use osculate_geom::{Diagnostic, Surface, Unit3};
use osculate_tools::{Cutter, CutterSpec};
use rayon::prelude::*;

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
        return Err(nothing(drop, &why));
    }
    let count = ((top - lowest) / stepdown_mm - 1e-9).ceil().max(1.0);
    if count > MOST_LAYERS {
        return Err(nothing(drop, &format!("{count:.0} layers are needed; raise stepdown_mm")));
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
        return Err(nothing(ground.task, &format!("{count:.0} rows are needed; raise stepover_mm")));
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
    fn a_grown_cutter_is_larger_all_around() {
        let flat = Cutter::try_from(CutterSpec::Flat { diameter_mm: 10.0, length_mm: 30.0 }).unwrap();
        let large = grown(&flat, 0.4).unwrap();
        for [rho, z] in [[0.0, -1.0], [6.0, -0.5], [7.0, 3.0], [5.5, -0.1]] {
            let (a, b) = (flat.local_distance(rho, z), large.local_distance(rho, z + 0.4));
            assert!((a - b - 0.4).abs() < 1e-12, "{a} {b}");
        }
    }
}
