//! Which way the passes of a strategy run at a place, and which way the tool leans there.

use super::Candidate;
use crate::plan::{Along, Strategy, ThreeAxis, ThreeAxisLines};
use osculate_geom::{Axis, Forms, Jet2, SymEigen, Unit3, Vec3};
use osculate_tools::Lean;
use std::f64::consts::PI;

/// Directions tried where the strategy is free to choose.
const FREE: usize = 8;

/// A face that slopes no more than this has no way up.
const LEVEL: f64 = 1e-9;

/// A posture of a strategy at a place.
#[derive(Clone, Copy)]
pub(super) struct Course {
    /// Feed from S_u towards S_v, rad.
    pub angle_rad: f64,
    /// Lead and tilt.
    pub lean: Lean,
    /// How fast the parameter grows whose levels are the passes, across the feed, 1/mm; None where spacing may vary along a pass.
    pub across_per_mm: Option<f64>,
}

/// Fixed levels of a strategy: rows of places that one spacing must serve.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Level {
    /// Levels of v, or of u.
    Parameter(Axis),
    /// Planes, levels of the distance along a normal.
    Planes(Unit3),
    /// None.
    Free,
}

pub(super) fn level(strategy: &Strategy) -> Level {
    match *strategy {
        Strategy::Isoparametric { along: Along::Fixed(axis) } => Level::Parameter(axis),
        Strategy::Isoplanar { normal } => Level::Planes(normal),
        Strategy::ThreeAxis(way) => match way.lines {
            ThreeAxisLines::Planes => across(&way).map_or(Level::Free, Level::Planes),
            ThreeAxisLines::Waterlines => Level::Planes(way.axis),
            ThreeAxisLines::Gradient => Level::Free,
        },
        _ => Level::Free,
    }
}

/// The normal of the planes in which passes of a tool that keeps its axis run; None where the way along them is that axis.
fn across(way: &ThreeAxis) -> Option<Unit3> {
    Unit3::try_new(way.axis.cross(&way.feed), 1e-12)
}

fn angle_of(jet: &Jet2, forms: &Forms, direction: &Vec3) -> f64 {
    let side = jet.side.sign();
    (side * direction.dot(&forms.frame[1])).atan2(direction.dot(&forms.frame[0]))
}

/// The postures of a candidate at a place; the best of them counts. Empty where the place looks away from a fixed axis.
pub(super) fn courses(candidate: &Candidate, jet: &Jet2, forms: &Forms) -> Vec<Course> {
    let n = forms.normal;
    let fixed = |direction: Vec3, across_per_mm: Option<f64>| Course {
        angle_rad: angle_of(jet, forms, &direction),
        lean: candidate.lean,
        across_per_mm,
    };
    let element = jet.du.cross(&jet.dv).norm();
    match candidate.strategy {
        Strategy::Isoparametric { along: Along::Fixed(Axis::U) } => {
            vec![fixed(jet.du, Some(jet.du.norm() / element))]
        }
        Strategy::Isoparametric { along: Along::Fixed(Axis::V) } => {
            vec![fixed(jet.dv, Some(jet.dv.norm() / element))]
        }
        // In regions passes are spaced by what places near each other need.
        Strategy::Regions { along: Along::Fixed(axis) } => {
            vec![fixed(if axis == Axis::U { jet.du } else { jet.dv }, None)]
        }
        Strategy::Isoplanar { normal } => {
            let direction = n.cross(&normal);
            let slope = direction.norm();
            // Where the face lies in the plane any direction does, and no spacing covers it.
            if slope > 0.0 { vec![fixed(direction, Some(slope))] } else { Vec::new() }
        }
        Strategy::Curvature5c => {
            let d = SymEigen::of(&forms.curvature).d_max;
            let angle_rad = d[1].atan2(d[0]) * jet.side.sign();
            vec![Course { angle_rad, lean: candidate.lean, across_per_mm: None }]
        }
        Strategy::Contour2cl { axis } => axial(&axis, n.cross(&axis), jet, forms),
        Strategy::ThreeAxis(way) => {
            let of_planes = |normal: Unit3| (n.cross(&normal), Some(n.cross(&normal).norm()));
            let (direction, across_per_mm) = match way.lines {
                ThreeAxisLines::Planes => across(&way).map_or((way.feed, None), of_planes),
                ThreeAxisLines::Waterlines => of_planes(way.axis),
                // Up the slope, where there is any.
                ThreeAxisLines::Gradient => {
                    let up = way.axis.into_inner() - n.into_inner() * n.dot(&way.axis);
                    (if up.norm() > LEVEL { up } else { way.feed }, None)
                }
            };
            let along = direction - n.into_inner() * n.dot(&direction);
            axial(&way.axis, along, jet, forms).into_iter().map(|c| Course { across_per_mm, ..c }).collect()
        }
        _ => {
            let d = SymEigen::of(&forms.curvature).d_max;
            let first = d[1].atan2(d[0]) * jet.side.sign();
            let turned = |k: usize| first + PI * k as f64 / FREE as f64;
            (0..FREE)
                .map(|k| Course { angle_rad: turned(k), lean: candidate.lean, across_per_mm: None })
                .collect()
        }
    }
}

/// The posture of a tool that keeps its axis.
fn axial(axis: &Unit3, direction: Vec3, jet: &Jet2, forms: &Forms) -> Vec<Course> {
    let n = forms.normal;
    let up = n.dot(axis);
    let Some(tangent) = Unit3::try_new(direction, 1e-12) else { return Vec::new() };
    if up <= 0.0 {
        return Vec::new();
    }
    let left = n.cross(&tangent);
    let lean = Lean {
        lead_rad: n.cross(axis).norm().atan2(up),
        tilt_rad: axis.dot(&left).atan2(axis.dot(&tangent)),
    };
    vec![Course { angle_rad: angle_of(jet, forms, &tangent), lean, across_per_mm: None }]
}
