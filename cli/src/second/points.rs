//! Points of the whole part, in cells.

use super::refusal::NoOpinion;
use super::vector::{V, norm, sub, usual};

/// A point of the part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartPoint {
    /// The face it is on.
    pub face: u32,
    /// The face is to be machined: what stands over the point counts.
    pub machined: bool,
    /// The point, mm.
    pub at: [f64; 3],
    /// Unit normal, out of the material.
    pub normal: [f64; 3],
}

/// Points near each other, within a sphere.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub centre: V,
    pub radius: f64,
    /// First and last but one in the order of the cloud.
    pub range: [usize; 2],
    pub machined: bool,
}

/// Points in the order of their cells.
pub(super) struct Cloud {
    pub points: Vec<PartPoint>,
    pub cells: Vec<Cell>,
    /// How far points are apart, mm.
    pub apart_mm: f64,
}

/// Points of a cell at most.
const IN_CELL: usize = 24;

impl Cloud {
    pub fn of(points: &[PartPoint]) -> Result<Self, NoOpinion> {
        let wrong = |what| Err(NoOpinion::Points { what });
        if points.is_empty() {
            return wrong("there are no points of the part");
        }
        if u32::try_from(points.len()).is_err() {
            return wrong("there are too many points of the part");
        }
        for p in points {
            let whole = p.at.iter().all(|x| usual(*x)) && (norm(p.normal) - 1.0).abs() < 1e-6;
            if !whole {
                return wrong("a point of the part is no place or its normal is no unit vector");
            }
        }
        let mut points = points.to_vec();
        let mut cells = Vec::new();
        let mut open = vec![[0, points.len()]];
        while let Some([from, to]) = open.pop() {
            let group = &mut points[from..to];
            let [low, high] = corners(group);
            if to - from <= IN_CELL {
                let centre = [0, 1, 2].map(|k| 0.5 * (low[k] + high[k]));
                let radius = group.iter().map(|p| norm(sub(p.at, centre))).fold(0.0, f64::max);
                let machined = group.iter().any(|p| p.machined);
                cells.push(Cell { centre, radius, range: [from, to], machined });
                continue;
            }
            // Halved across its longest side; ties keep an order that is the same everywhere.
            let size = sub(high, low);
            let k = (0..3).fold(0, |best, k| if size[k] > size[best] { k } else { best });
            let middle = group.len() / 2;
            group.select_nth_unstable_by(middle, |p, q| {
                let all = |a: &V, b: &V| {
                    a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])).then(a[2].total_cmp(&b[2]))
                };
                p.at[k].total_cmp(&q.at[k]).then_with(|| all(&p.at, &q.at)).then(p.face.cmp(&q.face))
            });
            open.extend([[from + middle, to], [from, from + middle]]);
        }
        let apart_mm = apart(&points, &cells);
        Ok(Self { points, cells, apart_mm })
    }
}

fn corners(points: &[PartPoint]) -> [V; 2] {
    let none = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    points.iter().fold(none, |[low, high], p| {
        [[0, 1, 2].map(|k| low[k].min(p.at[k])), [0, 1, 2].map(|k| high[k].max(p.at[k]))]
    })
}

/// How far points are apart, up to one in a hundred: the distance of a point from its nearest neighbour in its cell, or the side
/// of the square that a point of a cell has to itself, whichever is larger.
fn apart(points: &[PartPoint], cells: &[Cell]) -> f64 {
    let mut nearest: Vec<f64> = Vec::with_capacity(points.len());
    let mut sides: Vec<f64> = Vec::with_capacity(cells.len());
    for cell in cells {
        let group = &points[cell.range[0]..cell.range[1]];
        for (i, p) in group.iter().enumerate() {
            let others = group.iter().enumerate().filter(|(j, _)| *j != i);
            let far = others.map(|(_, q)| norm(sub(p.at, q.at))).filter(|d| *d > 0.0);
            let least = far.fold(f64::INFINITY, f64::min);
            if least.is_finite() {
                nearest.push(least);
            }
        }
        let [low, high] = corners(group);
        let mut size = sub(high, low);
        size.sort_by(f64::total_cmp);
        sides.push((size[1] * size[2] / group.len().max(1) as f64).sqrt());
    }
    let most = |mut all: Vec<f64>| {
        all.sort_by(f64::total_cmp);
        all.get(all.len() * 99 / 100).copied().unwrap_or(0.0)
    };
    most(nearest).max(most(sides))
}
