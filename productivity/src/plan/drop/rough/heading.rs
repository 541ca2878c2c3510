//! Layers along one axis: what is known of the place, the lines of all layers, and the moves through them.

use super::super::ground::{Ground, Lines::Planes};
use super::super::height::{Drops, Seed};
use super::super::task::DropTask;
use super::clear::{self, ALL, Lines, Part, Pick};
use super::layer::{Layer, Masks, Sheet, Walls};
use super::material::Material;
use super::moves::{Manner, Moved, Moves};
use super::pace::Pace;
use super::relief::{Points, Rougher};
use super::site::{Sight, Site};
use super::task::{Heading, Places, RoughTask, Rows};
use super::ways;
use crate::plan::{CcPoint, Linked, Pass, PlanError};
use osculate_geom::{Surface, Unit3};
use osculate_tools::{Cutter, Pose};
use rayon::prelude::*;

/// Most layers along an axis.
const MOST_LAYERS: f64 = 10_000.0;
/// Ways of rows, evenly over half a turn from what is given.
const TURNS: usize = 6;
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
}

/// Plans layers along an axis, for what is thicker than `thin_mm`; None where nothing is to go.
pub(super) fn along(
    known: &Known<'_>,
    material: &Material<'_>,
    (axis, places, thin_mm): (Unit3, Option<&Places>, f64),
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Option<Along>, PlanError> {
    let (task, s) = (known.task, &known.task.sizes);
    let given = task.rows.given();
    let sight = Sight::of(&known.points, material, (axis, &given), (&known.rougher, places, thin_mm));
    progress(0.2);
    let frame = sight.frame();
    let drop = drop_task(known, axis);
    let from = &known.seen;
    let seed = |seed: &Seed| {
        let ([x, y, z], [dx, dy, dz]) = (seed.at, seed.along);
        let way = from.point([x + dx, y + dy, z + dz]) - from.point(seed.at);
        Seed { at: frame.of(&from.point(seed.at)), along: frame.along(&way), ..*seed }
    };
    let seeds = known.seeds.iter().map(seed).collect();
    let drops = Drops::new(&known.surfaces, &known.grown, frame, seeds, known.spacing_mm);
    let (places_of, judged) = (Vec::new(), Vec::new());
    let ground = Ground { task: &drop, lines: Planes, frame, drops, places: places_of, spacing: 0.0, judged };
    let Some(site) = Site::of(&sight, &ground, &known.rougher, material) else { return Ok(None) };
    progress(0.6);
    let Some([top, low]) = site.heights() else { return Ok(None) };
    let floors = heights([top, low], s.stepdown_mm, &drop)?;
    let step = (top - low) / floors.len() as f64;
    let turns: Vec<f64> = match task.rows {
        Rows::Along(_) => vec![0.0],
        Rows::Quickest(_) => (0..TURNS).map(|k| std::f64::consts::PI * k as f64 / TURNS as f64).collect(),
    };
    let rows: Vec<_> =
        turns.iter().map(|turn| ways::rows(&site, ways::Way::turned(*turn), s.stepover_mm)).collect();
    let found: Vec<(Sheet, Lines)> = floors
        .par_iter()
        .map(|floor| {
            let layer = Layer { ceiling: floor + step, floor: *floor };
            let [thin, steps] = layer.thin(s.stands_mm);
            // Rows go up slopes, and leave none in steps.
            let masks = Masks::of(&site, layer, [thin; 2]);
            let walls = Walls::of(&site, layer, &masks, s.chord_mm);
            let rows = rows.iter().map(|rows| ways::of_rows(rows, layer, site.grid.cell)).collect();
            let along = ways::along_walls(&site, layer, (&masks, &walls), (1.0, [steps; 2]));
            (Sheet { layer, masks, walls }, Lines { rows, walls: along })
        })
        .collect();
    progress(0.8);
    let (sheets, lines): (Vec<Sheet>, Vec<_>) = found.into_iter().unzip();
    let parts = clear::parts(&site.grid, &sheets, lines, (s.stepover_mm, known.rougher.bare.radius_mm));
    let picks: Vec<Pick> =
        std::iter::once(Pick::Given).chain((turns.len() > 1).then_some(Pick::Own)).collect();
    let made: Vec<Cleared> =
        picks.into_par_iter().map(|pick| cleared(known, material, (&site, &sheets, &parts), pick)).collect();
    progress(1.0);
    // What is quick because it leaves something out is none, and slivers that lie so between other nodes are nothing.
    let (given_mm3, high_mm2) = (made[0].moved.taken_mm3, made[0].moved.high_mm2);
    let fits = |c: &Cleared| c.moved.taken_mm3 >= ALL * given_mm3 && c.moved.high_mm2 <= high_mm2;
    let rates = &task.links.rates;
    let timed = made.into_iter().filter(|c| !c.moved.passes.is_empty() && fits(c));
    let timed = timed.map(|c| (rates.path_min(&c.moved.linked.path) / c.moved.taken_mm3, c));
    let Some((_, Cleared { moved, most })) = timed.min_by(|a, b| a.0.total_cmp(&b.0)) else {
        return Ok(None);
    };
    let way = ways::Way::turned(turns[most]).place([1.0, 0.0]);
    let heading = Heading {
        axis,
        rows: Unit3::new_normalize(frame.point([way[0], way[1], 0.0]).coords),
        layers: floors,
        volume_mm3: moved.taken_mm3,
        cutting_length_mm: moved.linked.cutting_length_mm,
        shut_mm3: moved.shut_mm3,
    };
    let passes = moved.passes.into_iter().map(|places| pass(&frame, &axis, &places)).collect();
    Ok(Some(Along { heading, linked: moved.linked, passes }))
}

/// All layers, cut.
struct Cleared {
    moved: Moved,
    /// The way of most passes.
    most: usize,
}

fn cleared(
    known: &Known<'_>,
    material: &Material<'_>,
    (site, sheets, parts): (&Site<'_>, &[Sheet], &[Part]),
    pick: Pick,
) -> Cleared {
    let (task, s) = (known.task, &known.task.sizes);
    let (frame, apart_mm) = (&site.ground.frame, s.stepover_mm);
    let safe = super::columns::extent(material.bounds(), frame)[1][2]
        .max(super::columns::extent(&task.links.obstacles, frame)[1][2])
        + task.links.clearance_mm;
    let manner =
        Manner { sizes: s, links: task.links, entry: task.entry, plunges: task.plunges, apart_mm, safe };
    let pace = Pace::new(task.cutter, s.stepdown_mm, task.volume_rate_mm3_min);
    let mut moves = Moves::new(site, pace, manner);
    let passes = clear::clear(parts, sheets, &mut moves, (apart_mm, pick));
    // Of equal counts the first.
    let most = (0..passes.len()).rev().max_by_key(|k| passes[*k]).unwrap_or(0);
    Cleared { moved: moves.done(), most }
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
