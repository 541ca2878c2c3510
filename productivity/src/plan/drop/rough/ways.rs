//! The lines of a layer: rows, and lines along the walls.

use super::super::course::Course;
use super::super::trace;
use super::contour::Line;
use super::layer::{Cut, Layer, Masks, THIN, Walls, lifted};
use super::moves::stations;
use super::profile::{below, raised};
use super::site::Site;
use rayon::prelude::*;

/// A row: its position across the feed, and stretches of places along it with the tip's height.
pub(super) struct Row {
    y: f64,
    runs: Vec<Vec<[f64; 2]>>,
}

/// Rows over a site, `apart_mm` from each other at most.
pub(super) fn rows(site: &Site<'_>, apart_mm: f64) -> Vec<Row> {
    let grid = &site.grid;
    let wants: Vec<f64> =
        (0..grid.len()).filter(|k| site.least[*k].is_finite()).map(|k| grid.at(k)[1]).collect();
    let lo = wants.iter().copied().fold(f64::INFINITY, f64::min) - site.tool.bare.radius_mm;
    let hi = wants.iter().copied().fold(f64::NEG_INFINITY, f64::max) + site.tool.bare.radius_mm;
    let count = ((hi - lo) / apart_mm).ceil().max(1.0) as usize;
    let end = grid.at(grid.len() - 1)[0];
    (0..=count)
        .into_par_iter()
        .map(|r| {
            let y = lo + (hi - lo) * r as f64 / count as f64;
            let course = Course::through([[grid.lo[0], y], [end, y]]);
            let dropped = course.map_or_else(Vec::new, |c| trace::along(site.ground, &c));
            let mut all: Vec<[f64; 2]> = dropped
                .iter()
                .flat_map(|run| &run.points)
                .map(|p| site.ground.frame.of(&p.pose.tip))
                .map(|t| [t[0], t[2] + site.tool.allowance_mm])
                .collect();
            // Where nothing is below the tool its way goes on as the nodes say.
            let ends: Vec<[f64; 2]> = dropped
                .iter()
                .filter_map(|run| Some([run.points.first()?, run.points.last()?]))
                .map(|e| e.map(|p| site.ground.frame.of(&p.pose.tip)[0]))
                .collect();
            let nodes = (0..grid.n[0]).filter_map(|i| {
                let x = grid.lo[0] + grid.cell * i as f64;
                let covered = ends.iter().any(|[a, b]| *a <= x && x <= *b);
                (!covered).then(|| grid.near([x, y])).flatten().map(|k| [x, site.tip[k]])
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
            Row { y, runs }
        })
        .collect()
}

/// The stretches of rows on a layer, with places no further apart than a step.
pub(super) fn of_rows(rows: &[Row], layer: Layer, step: f64) -> Vec<Cut> {
    let (mut out, deep) = (Vec::new(), layer.ceiling - layer.floor);
    for row in rows {
        for run in &row.runs {
            for places in below(run, layer.ceiling) {
                let places: Vec<[f64; 3]> =
                    raised(&places, layer.floor).into_iter().map(|[x, z]| [x, row.y, z]).collect();
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
