//! Layers along one axis: what is known of the place, the lines of all layers, and the moves through them.

use super::super::ground::{DropTask, Ground, Lines};
use super::super::height::{Drops, Seed};
use super::clear;
use super::layer::{Layer, Masks, Sheet, Walls};
use super::material::Material;
use super::moves::{Manner, Moved, Moves};
use super::pace::Pace;
use super::relief::{Points, Rougher};
use super::site::{Sight, Site};
use super::task::{Heading, Places, RoughTask, Rows};
use super::ways;
use crate::plan::{CcPoint, Linked, Pass, PlanError};
use nalgebra::Rotation3;
use osculate_geom::{Surface, Unit3, Vec3};
use osculate_tools::{Cutter, Pose};
use rayon::prelude::*;

/// Most layers along an axis.
const MOST_LAYERS: f64 = 10_000.0;
/// Ways of rows that are tried, evenly over half a turn: along what is given, across, and both diagonals.
const TURNS: usize = 4;
/// A way of rows that takes less than this share of what the given one takes is none.
const ALL: f64 = 0.999;

/// The part with the tool, for any axis.
pub(super) struct Known<'a> {
    pub task: &'a RoughTask<'a>,
    pub surfaces: Vec<&'a dyn Surface>,
    /// The cutter everywhere larger by the allowance.
    pub grown: Cutter,
    pub rougher: Rougher,
    /// Places on the faces that the tool may rest on, in the frame of `seen`.
    pub seeds: Vec<Seed>,
    pub seen: super::super::frame::Frame,
    pub spacing_mm: f64,
    pub points: Points,
}

/// A roughing along one axis.
pub(super) struct Along {
    pub heading: Heading,
    pub linked: Linked,
    pub passes: Vec<Pass>,
    /// Where more is left of what is to go than may stand, mm2 across the axis.
    high_mm2: f64,
}

/// Plans layers along an axis, for what is thicker than `thin_mm`; None where nothing is to go.
pub(super) fn along(
    known: &Known<'_>,
    material: &Material<'_>,
    (axis, places, thin_mm): (Unit3, Option<&Places>, f64),
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Option<Along>, PlanError> {
    let one = |rows: Vec3, progress: &(dyn Fn(f64) + Sync)| {
        rowed(known, material, (axis, places, thin_mm), (rows, progress))
    };
    let given = known.task.rows.given();
    if let Rows::Along(_) = known.task.rows {
        return one(given, progress);
    }
    let turn = std::f64::consts::PI / TURNS as f64;
    let ways = (0..TURNS).map(|k| Rotation3::from_axis_angle(&axis, turn * k as f64) * given);
    let silent = |_: f64| {};
    let made: Vec<Option<Along>> = ways
        .enumerate()
        .collect::<Vec<_>>()
        .into_par_iter()
        .map(|(k, rows)| one(rows, if k == 0 { progress } else { &silent }))
        .collect::<Result<_, _>>()?;
    // What is quick because it leaves something out is none, and slivers that lie so between other nodes are nothing.
    let Some(given) = made.first().and_then(Option::as_ref) else { return Ok(None) };
    let (given_mm3, high_mm2) = (given.heading.volume_mm3, given.high_mm2);
    let fits = |a: &Along| a.heading.volume_mm3 >= ALL * given_mm3 && a.high_mm2 <= high_mm2;
    let all = made.into_iter().flatten().filter(fits);
    let links = known.task.links;
    let timed = all.map(|a| (links.rates.path_min(&a.linked.path) / a.heading.volume_mm3, a));
    Ok(timed.min_by(|a, b| a.0.total_cmp(&b.0)).map(|best| best.1))
}

/// Layers along an axis with rows along a way.
fn rowed(
    known: &Known<'_>,
    material: &Material<'_>,
    (axis, places, thin_mm): (Unit3, Option<&Places>, f64),
    (rows, progress): (Vec3, &(dyn Fn(f64) + Sync)),
) -> Result<Option<Along>, PlanError> {
    let (task, s) = (known.task, &known.task.sizes);
    let sight = Sight::of(&known.points, material, (axis, &rows), (&known.rougher, places, thin_mm));
    progress(0.1);
    let frame = sight.frame();
    let drop = DropTask { feed: rows, ..drop_task(known, axis) };
    let from = &known.seen;
    let seed = |seed: &Seed| {
        let ([x, y, z], [dx, dy, dz]) = (seed.at, seed.along);
        let way = from.point([x + dx, y + dy, z + dz]) - from.point(seed.at);
        Seed { at: frame.of(&from.point(seed.at)), along: frame.along(&way), ..*seed }
    };
    let seeds = known.seeds.iter().map(seed).collect();
    let drops = Drops::new(&known.surfaces, &known.grown, frame, seeds, known.spacing_mm);
    let (places_of, judged) = (Vec::new(), Vec::new());
    let ground =
        Ground { task: &drop, lines: Lines::Planes, frame, drops, places: places_of, spacing: 0.0, judged };
    let Some(site) = Site::of(&sight, &ground, &known.rougher, material) else { return Ok(None) };
    progress(0.3);
    let Some([top, low]) = site.heights() else { return Ok(None) };
    let floors = heights([top, low], s.stepdown_mm, &drop)?;
    let step = (top - low) / floors.len() as f64;
    let lines = ways::rows(&site, s.stepover_mm);
    let found: Vec<(Sheet, _)> = floors
        .par_iter()
        .map(|floor| {
            let layer = Layer { ceiling: floor + step, floor: *floor };
            let [thin, steps] = layer.thin(s.stands_mm);
            // Rows go up slopes, and leave none in steps.
            let masks = Masks::of(&site, layer, [thin; 2]);
            let walls = Walls::of(&site, layer, &masks, s.chord_mm);
            let mut cuts = ways::of_rows(&lines, layer, site.grid.cell);
            cuts.extend(ways::along_walls(&site, layer, (&masks, &walls), (1.0, [steps; 2])));
            (Sheet { layer, masks, walls }, cuts)
        })
        .collect();
    progress(0.6);
    let (sheets, lines): (Vec<Sheet>, Vec<_>) = found.into_iter().unzip();
    let apart_mm = s.stepover_mm;
    let mut parts = clear::parts(&site.grid, &sheets, lines, (apart_mm, known.rougher.bare.radius_mm));
    let safe = super::columns::extent(material.bounds(), &frame)[1][2]
        .max(super::columns::extent(&task.links.obstacles, &frame)[1][2])
        + task.links.clearance_mm;
    let manner =
        Manner { sizes: s, links: task.links, entry: task.entry, plunges: task.plunges, apart_mm, safe };
    let pace = Pace::new(task.cutter, s.stepdown_mm, task.volume_rate_mm3_min);
    let mut moves = Moves::new(&site, pace, manner);
    clear::clear(&mut parts, &sheets, &mut moves, apart_mm);
    progress(1.0);
    let Moved { linked, passes, taken_mm3, shut_mm3, high_mm2 } = moves.done();
    if passes.is_empty() {
        return Ok(None);
    }
    let heading = Heading {
        axis,
        rows: Unit3::new_normalize(frame.point([1.0, 0.0, 0.0]).coords),
        layers: floors,
        volume_mm3: taken_mm3,
        cutting_length_mm: linked.cutting_length_mm,
        shut_mm3,
    };
    let passes = passes.into_iter().map(|places| pass(&frame, &axis, &places)).collect();
    Ok(Some(Along { heading, linked, passes, high_mm2 }))
}

/// The dropping of the grown cutter along an axis.
pub(super) fn drop_task<'a>(known: &'a Known<'_>, axis: Unit3) -> DropTask<'a> {
    let task = known.task;
    let chord = task.sizes.chord_mm;
    let tolerance = crate::plan::Tolerance { scallop_mm: chord, gouge_mm: chord, chord_mm: chord };
    let (faces, check, cutter) = (task.faces, task.check, &known.grown);
    DropTask { faces, check, cutter, axis, feed: task.rows.given(), tolerance, progress: &|_| {} }
}

/// Heights of even layers from the top down to the lowest place of the tool.
fn heights([top, low]: [f64; 2], stepdown_mm: f64, drop: &DropTask<'_>) -> Result<Vec<f64>, PlanError> {
    let count = ((top - low) / stepdown_mm - 1e-9).ceil().max(1.0);
    if count > MOST_LAYERS {
        let why = format!("{count:.0} layers are needed; raise stepdown_mm");
        return Err(super::super::ground::nothing(drop, &why));
    }
    let step = (top - low) / count;
    Ok((1..=count as usize).map(|k| top - step * k as f64).collect())
}

/// Places of a line as a pass; the tool's own tip stands for the contact, which a roughing does not have.
fn pass(frame: &super::super::frame::Frame, axis: &Unit3, places: &[[f64; 3]]) -> Pass {
    let point = |p: &[f64; 3]| {
        let tip = frame.point(*p);
        let pose = Pose { tip, axis: *axis };
        CcPoint { uv: osculate_geom::uv(0.0, 0.0), point: tip, normal: *axis, pose, width_mm: f64::NAN }
    };
    Pass { points: places.iter().map(point).collect(), closed: false }
}
