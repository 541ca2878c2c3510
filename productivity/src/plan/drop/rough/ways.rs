//! The lines of a layer: rows, lines at even distances from the walls, or fronts that go out from what is cleared.

use super::super::course::Course;
use super::profile::{below, raised};
use super::super::trace;
use super::contour::{self, Line};
use super::field;
use super::layer::{Cut, Layer, Masks, THIN, Walls, lifted};
use super::moves::stations;
use super::site::{Site, slope};
use super::task::Sizes;
use rayon::prelude::*;

/// Radius of a helix, of the tool's: more would leave a core.
pub(super) const HELIX: f64 = 0.9;
/// A front comes in from the one before over this many radii of the tool.
const BLEND: f64 = 2.0;
/// Most levels of lines around.
const MOST_LEVELS: usize = 10_000;

/// A row: its position across the feed, and stretches of places along it with the tip's height.
pub(super) struct Row {
    y: f64,
    runs: Vec<Vec<[f64; 2]>>,
}

/// Rows over a site, `apart_mm` from each other at most.
pub(super) fn rows(site: &Site<'_>, apart_mm: f64) -> Vec<Row> {
    let grid = &site.grid;
    let wants: Vec<f64> = (0..grid.len()).filter(|k| site.least[*k].is_finite()).map(|k| grid.at(k)[1]).collect();
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
                out.push(Cut { places, closed: false, one_way: false, order: 0.0, thin: [THIN * deep; 2] });
            }
        }
    }
    out
}

/// Lines around at even distances from the walls, those farthest from them first. Lines no further apart than the tool's radius leave
/// nothing between them. On slopes they are as near as what may stand there requires.
pub(super) fn around(
    site: &Site<'_>,
    layer: Layer,
    (masks, walls): (&Masks, &Walls),
    sizes: &Sizes,
) -> Vec<Cut> {
    let apart_mm = sizes.stepover_mm.min(site.tool.bare.radius_mm);
    let useful: Vec<usize> = (0..site.grid.len()).filter(|k| masks.useful[*k] && !walls.depth[*k].is_nan()).collect();
    let deepest = useful.iter().map(|k| walls.depth[*k]).fold(0.0, f64::max);
    let steepest = useful.iter().map(|k| walls.depth[*k]).fold(0.0, f64::min);
    let on_slope = slope_apart_mm(site, masks, &useful, sizes.stands_mm).min(apart_mm);
    let levels = |least: f64, most: f64, step: f64| {
        let all = (1..MOST_LEVELS).map(move |n| step * n as f64);
        all.take_while(move |d| (least..=most).contains(d))
    };
    let mut out = Vec::new();
    let thin = layer.thin(sizes.stands_mm);
    for depth in levels(0.0, deepest, apart_mm).chain(levels(steepest, 0.0, -on_slope)) {
        for line in contour::level(&site.grid, &walls.depth, depth) {
            let places = lifted(site, layer, masks, (&line, false));
            out.push(Cut { places, closed: line.closed, one_way: false, order: -depth, thin });
        }
    }
    out.extend(along_walls(site, layer, (masks, walls), (0.0, thin)));
    out
}

/// How near lines along a slope are so that steps between them stand no higher than is accepted, mm: by the steep ones of its nodes.
fn slope_apart_mm(site: &Site<'_>, masks: &Masks, useful: &[usize], stands_mm: f64) -> f64 {
    let mut sines: Vec<f64> = useful
        .iter()
        .filter(|k| !masks.flat[**k])
        .map(|k| slope(&site.grid, &site.tip, *k))
        .filter(|slope| slope.is_finite())
        .map(|slope| slope / slope.hypot(1.0))
        .collect();
    if sines.is_empty() {
        return f64::INFINITY;
    }
    sines.sort_by(f64::total_cmp);
    stands_mm / sines[(sines.len() - 1) * 4 / 5].max(1e-3)
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
        Cut { places, closed: line.closed, one_way: false, order, thin }
    };
    walls.lines.iter().map(cut).collect()
}

/// A place where the tool is to come in by a helix, with its radius.
pub(super) type Hole = ([f64; 2], f64);

/// Fronts that go out from where the tool is in air, or from holes where it is so nowhere, and at last the lines along the walls.
pub(super) fn fronts(
    site: &Site<'_>,
    layer: Layer,
    (masks, walls): (&Masks, &Walls),
    (apart_mm, sizes): (f64, &Sizes),
) -> (Vec<Cut>, Vec<Hole>) {
    let grid = &site.grid;
    let free: Vec<bool> = masks.height.iter().map(|h| !h.is_nan()).collect();
    let (part, count) = grid.parts(&free);
    let own = |k: usize| part[k] as usize;
    // Parts that are to be cut and have no air: their deepest place.
    let (mut air, mut deepest, mut cuts) = (vec![false; count], vec![(0.0, usize::MAX); count], vec![false; count]);
    for k in (0..grid.len()).filter(|k| free[*k]) {
        air[own(k)] |= masks.in_air[k];
        cuts[own(k)] |= masks.useful[k];
        if masks.flat[k] && walls.depth[k] > deepest[own(k)].0 {
            deepest[own(k)] = (walls.depth[k], k);
        }
    }
    let mut holes: Vec<Hole> = Vec::new();
    for p in 0..count {
        let (depth, k) = deepest[p];
        if cuts[p] && !air[p] && k != usize::MAX {
            holes.push((grid.at(k), depth.min(HELIX * site.tool.bare.radius_mm)));
        }
    }
    let in_hole = |k: usize| {
        let at = grid.at(k);
        holes.iter().any(|(c, r)| (at[0] - c[0]).hypot(at[1] - c[1]) <= *r)
    };
    let sources: Vec<usize> = (0..grid.len()).filter(|k| free[*k] && (masks.in_air[*k] || in_hole(*k))).collect();
    let near: Vec<f64> = field::ways(grid, &free, sources.into_iter()).into_iter().map(|d| -d).collect();
    let useful = |k: &usize| masks.useful[*k] && near[*k].is_finite();
    let farthest = (0..grid.len()).filter(useful).map(|k| -near[k]).fold(0.0, f64::max);
    let mut out = Vec::new();
    let thin = layer.thin(sizes.stands_mm);
    for n in 1..MOST_LEVELS {
        let far = apart_mm * n as f64;
        if far > farthest + apart_mm {
            break;
        }
        for line in contour::level(grid, &near, -far) {
            let line = blended(site, line, &near, apart_mm);
            let places = lifted(site, layer, masks, (&line, false));
            out.push(Cut { places, closed: line.closed, one_way: true, order: far, thin });
        }
    }
    let last = farthest + 2.0 * apart_mm;
    if (0..grid.len()).any(|k| masks.useful[k] && !near[k].is_finite()) {
        // Where no front comes lines around do: places too narrow for a helix.
        let others = around(site, layer, (masks, walls), sizes);
        let deepest = others.iter().map(|c| -c.order).fold(0.0, f64::max);
        out.extend(others.into_iter().map(|c| Cut { order: last + deepest + c.order, ..c }));
    } else {
        out.extend(along_walls(site, layer, (masks, walls), (last, thin)));
    }
    (out, holes)
}

/// An open front that begins on the one before: the tool comes into the material little by little.
fn blended(site: &Site<'_>, mut line: Line, near: &[f64], apart_mm: f64) -> Line {
    if line.closed {
        return line;
    }
    let grid = &site.grid;
    let long = BLEND * site.tool.bare.radius_mm;
    let mut way = 0.0;
    let mut last = line.points[0];
    for p in &mut line.points {
        let here = *p;
        way += (here[0] - last[0]).hypot(here[1] - last[1]);
        last = here;
        if way >= long {
            break;
        }
        let Some(([a, b, c, d], [f, g])) = grid.around(here) else { continue };
        let slope = [
            (near[b] - near[a]) * (1.0 - g) + (near[d] - near[c]) * g,
            (near[c] - near[a]) * (1.0 - f) + (near[d] - near[b]) * f,
        ];
        let steep = slope[0].hypot(slope[1]);
        if steep > 0.0 && steep.is_finite() {
            let back = apart_mm * (1.0 - way / long) / steep;
            *p = [0, 1].map(|k| here[k] + slope[k] * back);
        }
    }
    line
}
