//! The tool for some faces: the largest ball of a library that reaches them, from which axes, and how the part stands for these.

use super::asked::{Grouped, Wanted};
use super::target::Target;
use crate::failure::Failure;
use crate::job::Tool;
use crate::job::words::ToolKind;
use crate::words::number;
use crate::work::reached::{PLACES, coarse_mm};
use nalgebra::UnitQuaternion;
use osculate_geom::{Surface, Unit3};
use osculate_postproc::Orienting;
use osculate_productivity::access::{Access, Asked, At, From};
use osculate_productivity::axis::{Around, Left};
use osculate_productivity::plan::{Named, Tolerance};
use std::f64::consts::FRAC_PI_2;
use std::fmt::Write;

/// The scallop as a part of the side of a square with the area of the faces: passes then are some hundreds, and a part of 50 mm is made to
/// a hundredth.
const FINE: f64 = 2e-4;
/// Scallops that are written, mm: steps that people use.
const STEPS_MM: [f64; 14] =
    [0.001, 0.002, 0.003, 0.005, 0.01, 0.015, 0.02, 0.03, 0.05, 0.1, 0.15, 0.2, 0.3, 0.5];
/// The step that is finest for the largest parts.
const FINEST_MM: f64 = 0.05;
/// Passes over a square of the faces' area, of all axes together: what takes more is made to the next step. A first plan then ends in minutes.
const MOST_PASSES: f64 = 400.0;
/// Operations are planned for this part of the scallop: the rest is for teeth, rounding, and walls beside which strips turn.
pub const OF_SCALLOP: f64 = 0.5;
/// Gouge and chord of the scallop.
const SHARES: [f64; 2] = [0.5, 0.2];
/// A ball is no larger than this part of the side of a square with the area of the faces.
const LARGEST: f64 = 0.1;
/// Balls that are tried, from the largest that may fit.
const MOST_BALLS: usize = 6;
/// Axes of a job at most: each is an operation.
const MOST_AXES: usize = 4;
/// Axes stay so far off the tangent planes, rad: passes across steep places are close, and a ball marks a wall at its equator.
const UPRIGHT_RAD: f64 = 0.26;
/// A tool that leaves no more than this share of the faces is taken before smaller ones are tried.
const NEARLY_ALL: f64 = 0.02;
/// Faces of which more is left than this share are refused.
const TOO_MUCH: f64 = 0.3;
/// What is accepted as not reached is the estimate times this: strips fade out beside it.
const SKIRT: f64 = 1.6;
/// A way for the part to stand is as good as the first one where it reaches this much of it.
const AS_GOOD: f64 = 0.995;

/// How faces are to be machined.
#[non_exhaustive]
pub struct Fit {
    /// The tool.
    pub tool: Tool,
    /// Why it.
    pub why: String,
    /// What must hold.
    pub tolerance: Tolerance,
    /// Why it, in words.
    pub why_tolerance: String,
    /// The axes, each with the faces that it is for, by their places in the target.
    pub axes: Vec<(From, Vec<usize>)>,
    /// Turn of the part about x, y, z, degrees, and which of its axes then is up.
    pub stands: ([f64; 3], &'static str),
    /// Faces that none of the axes reaches, by their places in the target; there are others.
    pub missed: Vec<usize>,
    /// What the job accepts as not reached, mm2.
    pub accepted_mm2: f64,
    /// Length of the sharp inner edges of the faces, mm.
    pub inner_mm: f64,
}

/// Ways for the part to stand: one of its own axes up, with the turns about x, y, z in degrees that do that.
const STANDS: [([f64; 3], &str); 6] = [
    ([0.0, 0.0, 0.0], "z"),
    ([90.0, 0.0, 0.0], "y"),
    ([-90.0, 0.0, 0.0], "-y"),
    ([0.0, -90.0, 0.0], "x"),
    ([0.0, 90.0, 0.0], "-x"),
    ([180.0, 0.0, 0.0], "-z"),
];

fn turned([a, b, c]: [f64; 3]) -> UnitQuaternion<f64> {
    use osculate_geom::Vec3;
    let turn = |axis: Vec3, deg: f64| UnitQuaternion::from_scaled_axis(axis * deg.to_radians());
    turn(Vec3::z(), c) * turn(Vec3::y(), b) * turn(Vec3::x(), a)
}

fn of_scallop(scallop_mm: f64) -> Tolerance {
    Tolerance { scallop_mm, gouge_mm: SHARES[0] * scallop_mm, chord_mm: SHARES[1] * scallop_mm }
}

/// What must hold for faces of such an area.
fn finest(area_mm2: f64) -> Tolerance {
    let wanted = (FINE * area_mm2.sqrt()).min(FINEST_MM);
    of_scallop(STEPS_MM.iter().copied().filter(|s| *s <= wanted).fold(STEPS_MM[0], f64::max))
}

/// What must hold where a ball of such a radius goes over areas, one for each axis, of faces of such an area, and why. Passes
/// on a plane are sqrt(8 r h) apart.
fn tolerance(area_mm2: f64, radius_mm: f64, each_mm2: &[f64]) -> (Tolerance, String) {
    let side_mm = area_mm2.sqrt();
    let passes = |scallop_mm: f64| {
        let apart_mm = (8.0 * radius_mm * OF_SCALLOP * scallop_mm).sqrt();
        each_mm2.iter().sum::<f64>() / (side_mm * apart_mm)
    };
    let finest = finest(area_mm2);
    let mut steps = STEPS_MM.iter().copied().filter(|s| *s >= finest.scallop_mm);
    let step = steps.find(|s| passes(*s) <= MOST_PASSES).unwrap_or(STEPS_MM[STEPS_MM.len() - 1]);
    let mut why = format!("for faces of {} mm2 together; the drawing says it better", number(area_mm2, 4));
    if step > finest.scallop_mm {
        let _ = write!(
            why,
            ". To {} mm it would be some {} passes with this tool, and a first plan would take long",
            finest.scallop_mm,
            number(passes(finest.scallop_mm), 2)
        );
    }
    (of_scallop(step), why)
}

/// The balls that may fit, largest first, and why the first of them is no larger.
fn balls<'a>(target: &Target, wanted: &Wanted<'a>) -> Result<(Vec<&'a Tool>, String), String> {
    let side_mm = target.area_mm2.sqrt();
    let wide = LARGEST * side_mm;
    let mut all: Vec<&Tool> = wanted.tools.0.tools.iter().filter(|t| t.kind() == ToolKind::Ball).collect();
    let diameter = |t: &Tool| 2.0 * t.cutter().radius_mm();
    all.sort_by(|a, b| diameter(b).total_cmp(&diameter(a)).then(a.number().cmp(&b.number())));
    let Some(smallest) = all.last().copied() else {
        return Err(format!("{} has no ball", wanted.tools.1));
    };
    let fitting: Vec<&Tool> = all.into_iter().filter(|t| diameter(t) <= wide).take(MOST_BALLS).collect();
    if fitting.is_empty() {
        return Ok((vec![smallest], "it is the smallest one".to_owned()));
    }
    let why = format!("the faces are {} mm wide", number(side_mm, 3));
    Ok((fitting, why))
}

/// What a tool reaches from one way for the part to stand.
struct Tried {
    axes: Vec<From>,
    left_mm2: Vec<f64>,
    stands: ([f64; 3], &'static str),
}

fn tried(access: &Access, wanted: &Wanted<'_>) -> Tried {
    let from = |stands: ([f64; 3], &'static str)| {
        let joints = Orienting::new(wanted.on, &turned(stands.0));
        let axes = access.axes(MOST_AXES, &|axis: &Unit3| joints.reaches(axis));
        Tried { left_mm2: access.left_mm2(&axes), axes, stands }
    };
    let all: Vec<Tried> = STANDS.into_iter().map(from).collect();
    let left = |t: &Tried| t.left_mm2.iter().sum::<f64>();
    let least = all.iter().map(left).fold(f64::INFINITY, f64::min);
    // Of those that reach as much the one that sees most from above; of equal ones the first.
    let limit = access.area_mm2() - AS_GOOD * (access.area_mm2() - least);
    let worth = |t: &Tried| (access.worth_mm2(&t.axes) / access.area_mm2() * 50.0).round() as i64;
    let good = all.into_iter().filter(|t| left(t) <= limit);
    good.min_by_key(|t| (-worth(t), t.axes.len())).unwrap_or(Tried {
        axes: Vec::new(),
        left_mm2: Vec::new(),
        stands: STANDS[0],
    })
}

/// Finds the tool and the axes for faces; in words why there are none.
///
/// # Errors
/// Where a face cannot be sampled.
pub fn fit(grouped: &Grouped, target: &Target, wanted: &Wanted<'_>) -> Result<Result<Fit, String>, Failure> {
    let (balls, why_size) = match balls(target, wanted) {
        Ok(found) => found,
        Err(why) => return Ok(Err(why)),
    };
    let faces = &grouped.part.faces;
    let named = |k: &usize| Named { face: &faces[*k].id, surface: &*faces[*k].surface as &dyn Surface };
    let own: Vec<Named<'_>> = target.faces.iter().map(named).collect();
    let seen = |k: &usize| !target.faces.contains(k) && !grouped.open.contains(&faces[*k].id);
    let check: Vec<Named<'_>> = (0..faces.len()).filter(seen).collect::<Vec<_>>().iter().map(named).collect();
    let tolerance = finest(target.area_mm2);
    let mut best: Option<(&Tool, Tried, f64)> = None;
    for tool in &balls {
        let cutter = tool.cutter();
        let around = Around {
            faces: &own,
            check: &check,
            cutter: &cutter,
            gouge_mm: coarse_mm(tolerance),
            left: Left::default(),
        };
        let asked = Asked {
            around,
            holder: tool.holder(),
            at: At::About(PLACES),
            lean_rad: [0.0, FRAC_PI_2 - UPRIGHT_RAD],
            axis: None,
        };
        let access = Access::of(&asked).map_err(|e| Failure::file(wanted.part, e))?;
        let tried = tried(&access, wanted);
        let share = tried.left_mm2.iter().sum::<f64>() / access.area_mm2();
        let enough = share <= NEARLY_ALL;
        // A smaller tool is worth its time where it leaves half as much.
        if best.as_ref().is_none_or(|b| enough || share < 0.5 * b.2) {
            best = Some((tool, tried, share));
        }
        if enough {
            break;
        }
    }
    let Some((tool, tried, share)) = best else { return Ok(Err("no tool fits".to_owned())) };
    if tried.axes.is_empty() || share > TOO_MUCH {
        return Ok(Err(format!(
            "{} and smaller balls of the library reach no more than {} % of it from {MOST_AXES} axes of {}",
            balls[0].words(),
            number(100.0 * (1.0 - share), 3),
            wanted.machine
        )));
    }
    let why = if tool.number() == balls[0].number() {
        format!("the largest ball for their size: {why_size}")
    } else {
        let hollow = if target.hollow_mm.is_finite() {
            format!(", which are hollow to a radius of {} mm", number(target.hollow_mm, 3))
        } else {
            String::new()
        };
        format!("larger balls reach less of the faces{hollow}")
    };
    let (inner_mm, inner_mm2) = inner(grouped, target, tool.cutter().radius_mm());
    let left_mm2: f64 = tried.left_mm2.iter().sum();
    let accepted = SKIRT * left_mm2.max(inner_mm2);
    let axes: Vec<(From, Vec<usize>)> =
        tried.axes.iter().map(|from| (from.clone(), faces_from(grouped, target, from))).collect();
    let missed: Vec<usize> =
        (0..target.faces.len()).filter(|k| !axes.iter().any(|(_, own)| own.contains(k))).collect();
    let each_mm2: Vec<f64> = axes.iter().map(|(from, _)| from.area_mm2).collect();
    let (tolerance, why_tolerance) = self::tolerance(target.area_mm2, tool.cutter().radius_mm(), &each_mm2);
    if missed.len() == target.faces.len() {
        return Ok(Err("no axis reaches more than slivers of its faces".to_owned()));
    }
    Ok(Ok(Fit {
        tool: (*tool).clone(),
        why,
        tolerance,
        why_tolerance,
        axes,
        stands: tried.stands,
        missed,
        accepted_mm2: if accepted > 0.0 { rounded_up(accepted) } else { 0.0 },
        inner_mm,
    }))
}

/// The faces of a target of which an axis reaches more than a sliver, by their places in it.
fn faces_from(grouped: &Grouped, target: &Target, from: &From) -> Vec<usize> {
    const SLIVER: f64 = 0.02;
    let area = |k: usize| crate::part::area(&grouped.part.faces[target.faces[k]]);
    (0..target.faces.len()).filter(|k| from.of_faces_mm2[*k] > SLIVER * area(*k)).collect()
}

/// The length of the sharp inner edges of the faces to machine, and the area beside them that a ball does not touch: it touches both
/// faces at r tan(b / 2) from an edge that bends by b.
fn inner(grouped: &Grouped, target: &Target, radius_mm: f64) -> (f64, f64) {
    let mut sum = (0.0, 0.0);
    for m in grouped.meetings.iter().filter(|m| !m.smooth && m.bend_rad < 0.0) {
        let own = m.faces.iter().filter(|f| target.faces.contains(f)).count();
        if own > 0 {
            sum.0 += m.length_mm;
            sum.1 += own as f64 * m.length_mm * radius_mm * (0.5 * -m.bend_rad).tan().min(MOST_WIDE);
        }
    }
    sum
}

/// Edges sharper than this are not followed to where a ball touches: the rest of the face is there before, in radii.
const MOST_WIDE: f64 = 3.0;

/// A number rounded up to two digits.
fn rounded_up(x: f64) -> f64 {
    let step = 10f64.powf(x.log10().floor() - 1.0);
    (x / step).ceil() * step
}
