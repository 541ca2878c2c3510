//! How a face stands under a tool axis, and the axis nearest to a given one from which no hollow of it holds water [M86, 5.2].
//!
//! A height has a minimum inside the face where the outward normal is the axis and the face is hollow both ways. Axes that have one
//! are the spherical image of the hollow places, axes that have none are the rest: an axis is looked for in rings around the one
//! asked for. Images of the cells tell which of them is promising, [`critical_points`] counts for those.

use super::chart::Chart;
use super::critical::{CriticalKind, critical_points};
use super::field::Height;
use osculate_geom::{Axis, Surface, Unit3, Uv, Vec3, any_perpendicular, uv};
use std::f64::consts::{FRAC_PI_2, TAU};

/// How a face stands under an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Standing {
    /// The axis: from the part to the tool.
    pub axis: Unit3,
    /// Angle between it and the one asked for, rad.
    pub turn_rad: f64,
    /// Minima of the height inside the face.
    pub minima: usize,
    /// Part of the face's area that faces away from the axis, as sampled.
    pub away: f64,
}

/// A face under the axis asked for and under the one that suits it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Turn {
    /// Under the axis asked for.
    pub asked: Standing,
    /// Under the axis with the fewest minima from which no more of the face faces away, of those the nearest on rings of
    /// [`Turn::STEP_RAD`].
    pub fewest: Standing,
}

impl Turn {
    /// Between rings of axes, and between axes of a ring, rad: 2 degrees.
    pub const STEP_RAD: f64 = TAU / 180.0;
}

/// Most cells of the images along a parameter.
const MOST_CELLS: usize = 64;
/// Most axes whose minima are counted; of 23 faces of real parts none took more than three.
const MOST_COUNTED: usize = 24;

/// A part of the face.
struct Cell {
    /// Normals of its corners, around it.
    corners: [Vec3; 4],
    /// Whether one of them stands on a place that is hollow both ways.
    hollow: bool,
    /// Weight, mm2.
    area: f64,
}

/// The face under `axis`, and the axis with the fewest minima of height.
///
/// ```
/// use osculate_geom::{Unit3, Vec3, analytic::Paraboloid};
/// use osculate_surfaces::lines::{Chart, LineTolerance, turned};
/// // A bowl as steep as 2 * 0.01 * 20 at its sides has a bottom until it is turned by 21.8 degrees.
/// let bowl = Paraboloid::new([0.01, 0.01], 20.0)?;
/// let chart = Chart::new(&bowl, LineTolerance::for_size(60.0))?;
/// let turn = turned(&chart, Vec3::z_axis());
/// assert!(turn.asked.minima == 1 && turn.fewest.minima == 0);
/// let degrees = turn.fewest.turn_rad.to_degrees();
/// assert!(degrees > 21.8 && degrees < 21.8 + 2.0, "{degrees}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn turned(chart: &Chart, axis: Unit3) -> Turn {
    let cells = cells(chart);
    let counted = |axis: Unit3, turn_rad: f64| Standing {
        axis,
        turn_rad,
        minima: critical_points(chart, &Height { axis }).inside(CriticalKind::Minimum).count(),
        away: away(&cells, &axis),
    };
    let asked = counted(axis, 0.0);
    let mut fewest = asked;
    if asked.minima == 0 {
        return Turn { asked, fewest };
    }
    let (e1, steps) = (any_perpendicular(&axis), (FRAC_PI_2 / Turn::STEP_RAD) as usize);
    let e2 = axis.cross(&e1);
    let mut left = MOST_COUNTED;
    // Those that may have some wait, the fewest first and of equals the nearest.
    let mut later: Vec<(usize, f64, Unit3)> = Vec::new();
    for ring in 1..=steps {
        let turn = ring as f64 * Turn::STEP_RAD;
        let (sin, cos) = turn.sin_cos();
        let around = (TAU * sin / Turn::STEP_RAD).ceil().max(1.0) as usize;
        for k in 0..around {
            let (s, c) = (TAU * k as f64 / around as f64).sin_cos();
            let tried = Unit3::new_normalize(axis.into_inner() * cos + (e1.into_inner() * c + e2 * s) * sin);
            if away(&cells, &tried) > asked.away {
                continue;
            }
            match images(&cells, &tried) {
                0 if left > 0 => {
                    left -= 1;
                    let found = counted(tried, turn);
                    if found.minima < fewest.minima {
                        fewest = found;
                    }
                    if found.minima == 0 {
                        return Turn { asked, fewest };
                    }
                }
                0 => {}
                some => later.push((some, turn, tried)),
            }
        }
    }
    later.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    for (_, turn, tried) in later.into_iter().take(left) {
        let found = counted(tried, turn);
        if found.minima < fewest.minima {
            fewest = found;
        }
    }
    Turn { asked, fewest }
}

/// The face in cells, those within its trims.
fn cells(chart: &Chart) -> Vec<Cell> {
    let surface = chart.surface();
    let d = chart.domain();
    let count = |axis| (chart.borders(axis).len() - 1).min(MOST_CELLS);
    let (n, m) = (count(Axis::U), count(Axis::V));
    let at = |i: f64, j: f64| uv(d.u.at(i / n as f64), d.v.at(j / m as f64));
    (0..n * m)
        .filter_map(|k| {
            let (i, j) = ((k / m) as f64, (k % m) as f64);
            let middle = at(i + 0.5, j + 0.5);
            if !surface.contains(middle) {
                return None;
            }
            let forms = surface.jet2(middle).forms().ok()?;
            let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[a, b]| at(i + a, j + b));
            let looks = corners.map(|at| look(surface, at));
            let [a, b, c, e] = looks;
            let (a, b, c, e) = (a?, b?, c?, e?);
            Some(Cell {
                corners: [a.0, b.0, c.0, e.0],
                hollow: [a.1, b.1, c.1, e.1].into_iter().any(|h| h),
                area: forms.area_density() * d.u.length() * d.v.length() / (n * m) as f64,
            })
        })
        .collect()
}

/// The normal of a place, and whether it is hollow both ways.
fn look(surface: &dyn Surface, at: Uv) -> Option<(Vec3, bool)> {
    let forms = surface.jet2(at).forms().ok()?;
    Some((forms.normal.into_inner(), forms.principal().k_max < 0.0))
}

/// The part of the area that faces away from an axis.
fn away(cells: &[Cell], axis: &Unit3) -> f64 {
    let (mut gone, mut all) = (0.0, 0.0);
    for cell in cells {
        all += cell.area;
        if cell.corners.iter().any(|n| n.dot(axis) < 0.0) {
            gone += cell.area;
        }
    }
    if all > 0.0 { gone / all } else { 0.0 }
}

/// How many hollow cells have the axis in their spherical image.
fn images(cells: &[Cell], axis: &Unit3) -> usize {
    let within = |t: [Vec3; 3]| {
        let turns = [0, 1, 2].map(|k| axis.dot(&t[k].cross(&t[(k + 1) % 3])));
        let towards = axis.dot(&(t[0] + t[1] + t[2])) > 0.0;
        towards && (turns.iter().all(|x| *x >= 0.0) || turns.iter().all(|x| *x <= 0.0))
    };
    let holds = |c: &&Cell| {
        let [a, b, d, e] = c.corners;
        c.hollow && (within([a, b, d]) || within([a, d, e]))
    };
    cells.iter().filter(holds).count()
}
