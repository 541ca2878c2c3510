//! The lines of a layer: rows, and lines along the walls.

use super::super::course::Course;
use super::super::trace;
use super::contour::Line;
use super::layer::{Cut, Layer, Masks, THIN, Walls, lifted};
use super::moves::stations;
use super::profile::{below, raised};
use super::site::Site;
use crate::plan::CcPoint;
use rayon::prelude::*;

/// A way of rows in the plane across the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Way {
    along: [f64; 2],
}

impl Way {
    /// Turned about the axis from the frame's x.
    pub fn turned(by_rad: f64) -> Self {
        let (sin, cos) = by_rad.sin_cos();
        Self { along: [cos, sin] }
    }

    /// Coordinates of a place along and across the way.
    fn of(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [c, s] = self.along;
        [x * c + y * s, y * c - x * s]
    }

    /// The place with these coordinates.
    pub fn place(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let [c, s] = self.along;
        [u * c - v * s, u * s + v * c]
    }
}

/// A row: its way, its position across that, and stretches of places along it with the tip's height.
pub(super) struct Row {
    way: Way,
    across: f64,
    runs: Vec<Vec<[f64; 2]>>,
}

/// The least and the greatest of numbers.
fn range(all: impl Iterator<Item = f64>) -> [f64; 2] {
    all.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], v| [lo.min(v), hi.max(v)])
}

/// Rows over a site along a way, `apart_mm` from each other at most.
pub(super) fn rows(site: &Site<'_>, way: Way, apart_mm: f64) -> Vec<Row> {
    let grid = &site.grid;
    let wanted = (0..grid.len()).filter(|k| site.least[*k].is_finite());
    let [lo, hi] = range(wanted.map(|k| way.of(grid.at(k))[1]));
    let (lo, hi) = (lo - site.tool.bare.radius_mm, hi + site.tool.bare.radius_mm);
    let count = ((hi - lo) / apart_mm).ceil().max(1.0) as usize;
    let (first, last) = (grid.lo, grid.at(grid.len() - 1));
    let corners = [first, [last[0], first[1]], [first[0], last[1]], last];
    let [begin, end] = range(corners.into_iter().map(|p| way.of(p)[0]));
    let steps = ((end - begin) / grid.cell).round() as usize;
    (0..=count)
        .into_par_iter()
        .map(|r| {
            let across = lo + (hi - lo) * r as f64 / count as f64;
            let course = Course::through([begin, end].map(|u| way.place([u, across])));
            let dropped = course.map_or_else(Vec::new, |c| trace::along(site.ground, &c));
            let seen = |p: &CcPoint| {
                let [x, y, z] = site.ground.frame.of(&p.pose.tip);
                [way.of([x, y])[0], z + site.tool.allowance_mm]
            };
            let mut all: Vec<[f64; 2]> = dropped.iter().flat_map(|run| &run.points).map(seen).collect();
            // Where nothing is below the tool its way goes on as the nodes say.
            let ends: Vec<[f64; 2]> = dropped
                .iter()
                .filter_map(|run| Some([run.points.first()?, run.points.last()?]))
                .map(|e| e.map(|p| seen(p)[0]))
                .collect();
            let nodes = (0..=steps).filter_map(|i| {
                let u = begin + grid.cell * i as f64;
                let covered = ends.iter().any(|[a, b]| *a <= u && u <= *b);
                (!covered).then(|| grid.near(way.place([u, across]))).flatten().map(|k| [u, site.tip[k]])
            });
            all.extend(nodes.filter(|[_, z]| !z.is_nan()));
            all.sort_by(|a, b| a[0].total_cmp(&b[0]));
            // A run ends where the tool may not go, or where nothing is known.
            let mut runs: Vec<Vec<[f64; 2]>> = vec![Vec::new()];
            for p in all {
                let apart = runs.last().and_then(|r| r.last()).is_some_and(|b| p[0] - b[0] > 1.5 * grid.cell)
                    && !ends.iter().any(|[a, b]| *a <= p[0] && p[0] <= *b);
                if apart || p[1] == f64::INFINITY {
                    runs.push(Vec::new());
                }
                if let Some(run) = runs.last_mut().filter(|_| p[1] < f64::INFINITY) {
                    run.push(p);
                }
            }
            runs.retain(|r| r.len() > 1);
            Row { way, across, runs }
        })
        .collect()
}

/// The stretches of rows on a layer, with places no further apart than a step.
pub(super) fn of_rows(rows: &[Row], layer: Layer, step: f64) -> Vec<Cut> {
    let (mut out, deep) = (Vec::new(), layer.ceiling - layer.floor);
    for row in rows {
        let at = |[u, z]: [f64; 2]| {
            let [x, y] = row.way.place([u, row.across]);
            [x, y, z]
        };
        for run in &row.runs {
            for places in below(run, layer.ceiling) {
                let places: Vec<[f64; 3]> = raised(&places, layer.floor).into_iter().map(at).collect();
                let places = stations(&places, false, step);
                out.push(Cut { places, closed: false, order: 0.0, thin: [THIN * deep; 2] });
            }
        }
    }
    out
}

/// The lines along the walls.
pub(super) fn along_walls(
    site: &Site<'_>,
    layer: Layer,
    (masks, walls): (&Masks, &Walls),
    (order, thin): (f64, [f64; 2]),
) -> Vec<Cut> {
    let cut = |line: &Line| {
        let places = lifted(site, layer, masks, (line, true));
        Cut { places, closed: line.closed, order, thin }
    };
    walls.lines.iter().map(cut).collect()
}
