//! A roughing from the first axis to the last, in all places that are alike.

use super::super::frame::Frame;
use super::super::ground::nothing;
use super::super::height::Seed;
use super::super::seeds::{areas, seeds};
use super::columns::Underside;
use super::directions::Views;
use super::heading::{Along, Known, along, drop_task};
use super::material::Material;
use super::relief::{Points, Rougher};
use super::site::CELL;
use super::swing::Sphere;
use super::task::{Headings, Places, RoughTask, Roughing, Search};
use crate::plan::{Linked, PlanError, Stretches, repeated};
use nalgebra::Isometry3;
use osculate_geom::{Diagnostic, Surface, Unit3, Vec3};
use osculate_tools::cl::ClMove;
use osculate_tools::removal::stock::{Stock, StockJob};
use osculate_tools::removal::{SamplingError, Swept, sample_surface};
use osculate_tools::{Cutter, CutterSpec, HolderSection, Pose};
use rayon::prelude::*;

/// Where findings are.
const NAME: &str = "z_level";
/// What stands no thicker than this many cells of the stock is not known to stand.
const KNOWN: f64 = 1.0;
/// What is thinner than this share of what may stand is left by found axes after the first.
const THIN: f64 = 0.5;
/// Points of faces are this part of a node's distance apart, and no more than so many, on one face and about in all.
const APART: f64 = 0.8;
const MOST_OF_A_FACE: usize = 1_000_000;
const MOST_POINTS: f64 = 1e6;
/// Axes that are looked at closely before one is taken.
const LOOKED_AT: usize = 3;

/// Roughs along one axis, or along those that take most.
///
/// # Errors
/// [`PlanError`]: sizes that are none, a cutter whose grown body is none of ours, and where nothing is to be taken.
pub fn rough(task: &RoughTask<'_>) -> Result<Roughing, PlanError> {
    task.sizes.check()?;
    let known = known(task)?;
    match task.from {
        Headings::Along(axis) => fixed(&known, axis),
        Headings::Found(search) => found(&known, &search),
    }
}

/// The cutter whose body is everywhere `by_mm` larger; its tip lies that far below.
fn grown(cutter: &Cutter, by_mm: f64) -> Result<Cutter, PlanError> {
    let need = PlanError::Tool { strategy: NAME, need: "ball, flat or toroidal cutter" };
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

fn known<'a>(task: &'a RoughTask<'a>) -> Result<Known<'a>, PlanError> {
    let s = &task.sizes;
    let grown = grown(task.cutter, s.allowance_mm)?;
    let surfaces: Vec<&dyn Surface> = task.faces.iter().chain(task.check).map(|n| n.surface).collect();
    let keep = task.links.approach_mm;
    // A section that opens upwards counts as wide as it is at its end.
    let wide = |body: &Cutter| body.outline_mm(0.1).iter().map(|p| p[0]).fold(body.radius_mm(), f64::max);
    let section = |s: &HolderSection| [wide(&s.body) + keep, task.cutter.length_mm() + s.above_mm - keep];
    let holder = task.links.holder.iter().flat_map(|h| h.sections()).map(section).collect();
    let rougher = Rougher {
        bare: Underside::of(task.cutter),
        grown: Underside::of(&grown),
        allowance_mm: s.allowance_mm,
        holder,
    };
    let seen = Frame::new(Vec3::z_axis(), &Vec3::x());
    let mut known = Known {
        task,
        surfaces,
        grown,
        rougher,
        seeds: Vec::new(),
        seen,
        spacing_mm: 0.0,
        points: Points::default(),
    };
    let (seeds, spacing_mm, _) =
        seeds(&drop_task(&known, Vec3::z_axis()), (&known.surfaces, &areas(&known.surfaces)), &seen)?;
    known.points = points(&known, &seeds)?;
    (known.seeds, known.spacing_mm) = (seeds, spacing_mm);
    Ok(known)
}

/// Points of all faces, so close that nodes are not missed; with the seeds, which have those of the rims.
fn points(known: &Known<'_>, seeds: &[Seed]) -> Result<Points, PlanError> {
    let own = known.task.faces.len();
    let areas = areas(&known.surfaces);
    let all: f64 = areas.iter().sum();
    let apart_mm = (APART * CELL * known.rougher.bare.radius_mm).max((all / MOST_POINTS).sqrt());
    let mut out = Points { spacing_mm: apart_mm, ..Points::default() };
    let each: Vec<_> = (0u32..)
        .zip(&known.surfaces)
        .collect::<Vec<_>>()
        .par_iter()
        .map(|(k, surface)| sample_surface(*surface, *k, apart_mm, MOST_OF_A_FACE))
        .collect();
    for (k, found) in each.into_iter().enumerate() {
        match found {
            Ok(sampling) => {
                out.spacing_mm = out.spacing_mm.max(sampling.density.spacing_mm);
                out.at.extend(sampling.samples.iter().map(|s| s.point));
                out.own.resize(out.at.len(), k < own);
            }
            // A sliver has its seeds on the rim.
            Err(SamplingError::Nothing { .. }) => {}
            Err(e) => return Err(nothing(&drop_task(known, Vec3::z_axis()), &e.to_string())),
        }
    }
    out.at.extend(seeds.iter().map(|s| known.seen.point(s.at)));
    out.own.extend(seeds.iter().map(|s| (s.face as usize) < own));
    Ok(out)
}

/// A path in all places, one after the other.
fn everywhere(linked: &Linked, turns: &[Isometry3<f64>], sphere: &Sphere, out: &mut Linked, passes: u32) {
    let count = linked.pass_of_move.iter().flatten().max().map_or(0, |last| last + 1);
    for (n, turn) in (0u32..).zip(turns) {
        let moved = |m: &ClMove| {
            // A turn keeps unit vectors but for rounding, which is not to grow.
            let axis = Unit3::new_normalize(turn * m.pose.axis.into_inner());
            ClMove { pose: Pose { tip: turn * m.pose.tip, axis }, motion: m.motion, aloft: false }
        };
        for (k, (m, pass)) in linked.path.moves.iter().zip(&linked.pass_of_move).enumerate() {
            let m = moved(m);
            if k == 0 {
                sphere.lead(out, &m.pose);
            }
            out.go(m.pose, m.motion, pass.map(|p| p + passes + n * count));
        }
    }
}

fn told(out: &mut Roughing, known: &Known<'_>, along: &Along, places: usize) {
    let heading = &along.heading;
    let n = heading.layers.len();
    let [x, y, z] = [heading.axis.x, heading.axis.y, heading.axis.z].map(|x| format!("{x:.4}"));
    let deep = match heading.layers[..] {
        [a, b, ..] => a - b,
        _ => known.task.sizes.stepdown_mm,
    };
    let times = if places > 1 { format!(" in each of {places} places") } else { String::new() };
    let text = format!(
        "along [{x}, {y}, {z}]: {n} layers of {deep:.3} mm, {} passes, {:.0} mm, {:.0} mm3{times}; {} mm are left on the faces",
        along.passes.len(),
        heading.cutting_length_mm,
        heading.volume_mm3,
        known.task.sizes.allowance_mm
    );
    out.passes.diagnostics.push(Diagnostic::note(NAME, text));
    if heading.shut_mm3 > 1e-3 * heading.volume_mm3 {
        let text = format!(
            "{:.0} mm3 lie in pockets that the tool does not come down into; use a smaller one there, a steeper ramp_deg, or a tool that plunges",
            heading.shut_mm3
        );
        out.passes.diagnostics.push(Diagnostic::loss(NAME, text));
    }
}

fn fixed(known: &Known<'_>, axis: Unit3) -> Result<Roughing, PlanError> {
    let task = known.task;
    let places = task.repeat.and_then(|p| p.of_axis(&axis));
    let material = Material::of(task.stock, places.as_ref());
    let thin = KNOWN * material.cell_mm();
    let made = along(known, &material, (axis, places.as_ref(), thin), task.progress)?;
    let Some(made) = made else {
        let why =
            "nothing stands on it that the tool reaches along the axis; check [stock], or give another axis";
        return Err(nothing(&drop_task(known, axis), why));
    };
    let mut out = Roughing::default();
    match places {
        Some(places) => {
            let sphere = sphere(known, &material);
            let turns = places.turns();
            everywhere(&made.linked, &turns, &sphere, &mut out.linked, 0);
            sphere.leave(&mut out.linked);
            out.passes.passes = repeated(&Stretches::from(made.passes.clone()), &turns).passes;
        }
        None => {
            out.linked = made.linked.clone();
            out.passes.passes.clone_from(&made.passes);
        }
    }
    told(&mut out, known, &made, places.map_or(1, |p| p.count));
    out.headings.push(made.heading);
    Ok(out)
}

fn sphere(known: &Known<'_>, material: &Material<'_>) -> Sphere {
    let links = known.task.links;
    Sphere::around(&links.obstacles.union(material.bounds()), links.clearance_mm)
}

fn found(known: &Known<'_>, search: &Search<'_>) -> Result<Roughing, PlanError> {
    let task = known.task;
    let mut stock = task.stock.clone();
    let material = Material::of(&stock, task.repeat.as_ref());
    let cell = material.cell_mm();
    let sphere = sphere(known, &material);
    let views = Views::of(known, &material, search, task.repeat.as_ref());
    // Candidates are weighed in one of the places.
    let (all_mm3, all_places) = (views.all_mm3(), task.repeat.map_or(1.0, |p| p.count as f64));
    (task.progress)(0.1);
    let mut out = Roughing::default();
    let mut done: Vec<Unit3> = Vec::new();
    for n in 0..search.most {
        let material = Material::of(&stock, task.repeat.as_ref());
        let left = views.left(&material);
        let mut best = views.best(&left, known);
        best.retain(|(axis, mm3)| *mm3 >= search.least_share * all_mm3 && !done.contains(axis));
        let here = |f: f64| (task.progress)(0.1 + 0.9 * (n as f64 + f) / search.most as f64);
        // What is left thinly by the axes before is not worth another.
        let thin = if n == 0 { KNOWN * cell } else { THIN * task.sizes.stands_mm };
        let mut made: Option<(Along, Option<Places>)> = None;
        for (axis, _) in best.into_iter().take(LOOKED_AT) {
            let places: Option<Places> = task.repeat.and_then(|p| p.of_axis(&axis));
            let seen = Material::of(&stock, places.as_ref());
            done.push(axis);
            if let Some(along) = along(known, &seen, (axis, places.as_ref(), thin), &here)? {
                let times = places.map_or(1.0, |p| p.count as f64);
                if along.heading.volume_mm3 * times >= search.least_share * all_mm3 * all_places {
                    made = Some((along, places));
                    break;
                }
            }
        }
        let Some((made, places)) = made else { break };
        let turns = places.map_or_else(|| vec![Isometry3::identity()], |p| p.turns());
        let passes = out.passes.passes.len() as u32;
        let before = out.linked.path.moves.len();
        everywhere(&made.linked, &turns, &sphere, &mut out.linked, passes);
        out.passes.passes.extend(repeated(&Stretches::from(made.passes.clone()), &turns).passes);
        told(&mut out, known, &made, turns.len());
        carve(&mut stock, known, &out.linked, before)?;
        out.headings.push(made.heading);
    }
    if out.headings.is_empty() {
        let why = "no axis of the machine reaches anything of what stands on it";
        return Err(nothing(&drop_task(known, Vec3::z_axis()), why));
    }
    sphere.leave(&mut out.linked);
    Ok(out)
}

/// Takes from stock what the path takes from a move on.
fn carve(stock: &mut Stock, known: &Known<'_>, linked: &Linked, from: usize) -> Result<(), PlanError> {
    let motions = Swept::along(&linked.path).split_off(from.saturating_sub(1));
    let job = StockJob { cutter: known.task.cutter, uppers: &[], motions: &motions, touch_mm: f64::INFINITY };
    let carved = stock.carve(&job, &|_| {});
    carved.map(|_| ()).map_err(|e| nothing(&drop_task(known, Vec3::z_axis()), &e.to_string()))
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
