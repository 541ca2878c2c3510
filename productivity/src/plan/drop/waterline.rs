//! Three-axis passes at constant heights around steep faces: waterlines of all faces together.
//!
//! Planes along the axis run up and down a wall, and none touches it. A waterline goes around it: the places of the plane
//! across the axis at which the dropped tool comes to rest at a height z are the rim of what is free at z, and along a wall, where
//! heights jump, they are the rim all the same. Heights are the fewest that leave no steep place out of reach; of a rim only the
//! stretches remain that some place wants. What the passes leave is measured with the swept cutter, as for planes.

use super::ground::{Ground, Lines, asked, ground, hide, nothing, told, too_many};
use super::planes::levels;
use super::rims::{Rim, Rims};
use super::rounds::{Round, in_rounds};
use super::task::DropTask;
use super::wants::Want;
use crate::plan::{CcPoint, MAX_PASSES, Pass, Passes, PlanError, check_tolerance};
use osculate_geom::{Point3, Surface, Unit3};
use osculate_tools::Pose;
use rayon::prelude::*;
use std::collections::HashMap;

/// Passes run past the last place that wants them by this part of the tool's radius.
const PAST: f64 = 0.05;
/// Gaps shorter than this part of the tool's radius are cut along.
const GAP: f64 = 1.0;
/// A place faces the free side of a rim when their directions agree so well, cosine.
const SIDE: f64 = 0.5;
/// Places at which a closed pass may begin.
const STARTS: usize = 64;

/// Plans passes at constant heights around the steep places of the faces with a tool that keeps its axis.
///
/// Places flatter than 45 degrees are left to passes that run over them, and named with their area, as are those that the end
/// of the tool cannot touch. Material lies on the right of the feed.
///
/// # Errors
/// [`PlanError`]: a cutter that is neither ball nor toroidal, a tolerance that is none, no steep place that the tool reaches, or
/// too many passes.
pub fn waterline_3c(task: &DropTask<'_>) -> Result<Passes, PlanError> {
    check_tolerance(&task.tolerance)?;
    if task.cutter.corner_mm() <= 0.0 || !task.cutter.is_end_mill() {
        return Err(PlanError::Tool { strategy: "waterline_3c", need: "ball or toroidal cutter" });
    }
    let surfaces: Vec<&dyn Surface> = task.faces.iter().chain(task.check).map(|n| n.surface).collect();
    let ground = ground(task, &surfaces, Lines::Waterlines)?;
    (task.progress)(0.1);
    let (mut wants, mut lost) = asked(&ground);
    let hidden = hide(&ground, &mut wants);
    lost.push((hidden, "is beside another place that the tool touches first"));
    if wants.is_empty() {
        let why = "no place of it is steep and free beside this tool; give another axis or a smaller tool";
        return Err(nothing(task, why));
    }
    (task.progress)(0.2);
    let rims = Rims::around(&ground, &wants).map_err(|why| nothing(task, &why))?;
    (task.progress)(0.4);
    let passes = in_rounds(&ground, &mut wants, &mut lost, |wants| {
        let mut tips: Vec<Want> = wants.iter().map(|w| Want { at: [0.0, w.tip], ..*w }).collect();
        let levels = levels(&mut tips);
        if levels.len() > MAX_PASSES {
            return Err(too_many(task));
        }
        let wants: &[Want] = wants;
        let found: Vec<Vec<Pass>> = levels.par_iter().map(|z| level(&ground, &rims, wants, *z)).collect();
        let passes = found.into_iter().rev().flatten().collect();
        Ok(Round { passes, shares: Box::new(move |wants| shares(&levels, wants)) })
    })?;
    Ok(told(&ground, down(passes), &lost))
}

/// How far places are off the nearest of heights, of their reach.
fn shares(levels: &[f64], wants: &[Want]) -> Vec<f64> {
    let share = |w: &Want| {
        let k = levels.partition_point(|z| *z < w.tip);
        let near = [k.checked_sub(1), Some(k)].into_iter().flatten().filter_map(|k| levels.get(k));
        near.map(|z| (z - w.tip).abs()).fold(f64::INFINITY, f64::min) / w.reach
    };
    wants.par_iter().map(share).collect()
}

/// Wants by their positions.
struct Near<'a> {
    cell: f64,
    bins: HashMap<[i64; 2], Vec<&'a Want>>,
}

impl<'a> Near<'a> {
    /// Those that a pass at a height serves.
    fn of(wants: &'a [Want], z: f64, least: f64) -> Self {
        let served: Vec<&Want> = wants.iter().filter(|w| (w.tip - z).abs() <= w.reach + w.widest()).collect();
        let cell = served.iter().map(|w| Self::pad(w)).fold(least, f64::max);
        let mut bins: HashMap<[i64; 2], Vec<&Want>> = HashMap::new();
        for w in served {
            bins.entry(Self::bin(cell, w.at)).or_default().push(w);
        }
        Self { cell, bins }
    }

    /// How far from a want's own position a pass may be that serves it: as steep as 45 degrees, it shifts by what it rises.
    fn pad(w: &Want) -> f64 {
        w.reach + 2.0 * w.widest()
    }

    fn bin(cell: f64, at: [f64; 2]) -> [i64; 2] {
        // Coordinates over a cell, which is no less than a part of the tool.
        at.map(|x| (x / cell).floor() as i64)
    }

    /// The nearest that a pass through a place serves, of those that `may` be.
    fn nearest(&self, c: [f64; 2], past: f64, may: impl Fn(&Want) -> bool) -> Option<&'a Want> {
        let [i, j] = Self::bin(self.cell, c);
        let around = (-1..=1).flat_map(|a| (-1..=1).map(move |b| [i + a, j + b]));
        around
            .filter_map(|b| self.bins.get(&b))
            .flatten()
            .map(|w| ((w.at[0] - c[0]).hypot(w.at[1] - c[1]), *w))
            .filter(|(d, w)| *d <= Self::pad(w) + past && may(w))
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, w)| w)
    }
}

/// The passes of one height.
fn level(ground: &Ground<'_>, rims: &Rims, wants: &[Want], z: f64) -> Vec<Pass> {
    let radius = ground.task.cutter.radius_mm();
    let near = Near::of(wants, z, PAST * radius);
    let mut out = Vec::new();
    for rim in rims.at(ground, z, &|c| near.nearest(c, rims.cell_mm(), |_| true).is_some()) {
        let out_of: Vec<[f64; 2]> = (0..rim.nodes.len()).map(|k| free_way(&rim, k)).collect();
        let faces = |w: &Want, way: [f64; 2]| {
            let n = ground.frame.along(&w.normal);
            n[0] * way[0] + n[1] * way[1] > SIDE * n[0].hypot(n[1])
        };
        let seen = |(c, way): (&[f64; 2], &[f64; 2])| near.nearest(*c, PAST * radius, |w| faces(w, *way));
        let wanted: Vec<Option<&Want>> = rim.nodes.iter().zip(&out_of).map(seen).collect();
        for piece in stretches(&rim.nodes, &wanted, rim.closed, GAP * radius) {
            let points: Vec<CcPoint> = piece
                .nodes
                .iter()
                .map(|k| point(ground, (rim.nodes[*k], z), out_of[*k], wanted[*k]))
                .collect();
            let points = thin(points, 0.5 * ground.task.tolerance.chord_mm);
            if points.len() > 1 {
                out.push(Pass { points, closed: piece.closed });
            }
        }
    }
    out
}

/// Nodes of a rim that follow one another.
struct Stretch {
    nodes: Vec<usize>,
    closed: bool,
}

/// The stretches of a rim whose nodes are wanted, with the gaps between them that are no longer than `gap_mm`.
fn stretches(nodes: &[[f64; 2]], wanted: &[Option<&Want>], closed: bool, gap_mm: f64) -> Vec<Stretch> {
    let n = nodes.len();
    let apart = |a: usize, b: usize| (nodes[b][0] - nodes[a][0]).hypot(nodes[b][1] - nodes[a][1]);
    let Some(first) = (0..n).find(|k| wanted[*k].is_some()) else { return Vec::new() };
    // A closed rim is gone around from the end of its longest gap, as far as there is one.
    let order: Vec<usize> = if closed {
        let around: Vec<usize> = (0..=n).map(|k| (first + k) % n).collect();
        let (mut gap, mut longest, mut start) = (0.0, gap_mm, None);
        for w in around.windows(2) {
            gap += apart(w[0], w[1]);
            if wanted[w[1]].is_some() {
                if gap > longest && wanted[w[0]].is_none() {
                    (longest, start) = (gap, Some(w[1]));
                }
                gap = 0.0;
            }
        }
        match start {
            Some(start) => (0..n).map(|k| (start + k) % n).collect(),
            None => return vec![Stretch { nodes: around, closed: true }],
        }
    } else {
        (first..n).collect()
    };
    let mut out: Vec<Stretch> = Vec::new();
    let (mut gap, mut between): (f64, Vec<usize>) = (0.0, Vec::new());
    let mut last: Option<usize> = None;
    for k in order {
        gap += last.map_or(0.0, |l| apart(l, k));
        last = Some(k);
        if wanted[k].is_none() {
            between.push(k);
            continue;
        }
        match out.last_mut() {
            Some(stretch) if gap <= gap_mm || between.is_empty() => stretch.nodes.append(&mut between),
            _ => out.push(Stretch { nodes: Vec::new(), closed: false }),
        }
        between.clear();
        gap = 0.0;
        if let Some(stretch) = out.last_mut() {
            stretch.nodes.push(k);
        }
    }
    out.retain(|s| s.nodes.len() > 1);
    out
}

/// The way out to what is free at a node of a rim, on the left of the way along it.
fn free_way(rim: &Rim, k: usize) -> [f64; 2] {
    let (n, last) = (rim.nodes.len(), rim.nodes.len() - 1);
    let [before, after] =
        if rim.closed { [(k + last) % n, (k + 1) % n] } else { [k.saturating_sub(1), (k + 1).min(last)] };
    let (a, b) = (rim.nodes[before], rim.nodes[after]);
    let long = (b[0] - a[0]).hypot(b[1] - a[1]).max(f64::MIN_POSITIVE);
    [(a[1] - b[1]) / long, (b[0] - a[0]) / long]
}

/// The tool over a place at a height. It touches what is across the rim, as steep there as the nearest want is; where nothing is
/// wanted, a wall.
fn point(ground: &Ground<'_>, ([x, y], z): ([f64; 2], f64), out: [f64; 2], want: Option<&Want>) -> CcPoint {
    let (frame, cutter) = (&ground.frame, ground.task.cutter);
    let pose = Pose { tip: frame.point([x, y, z]), axis: frame.axis };
    let rise = want.map_or(0.0, |w| frame.along(&w.normal)[2]);
    let sine = ((1.0 - rise) * (1.0 + rise)).sqrt();
    let away = frame.point([out[0] * sine, out[1] * sine, rise]).coords;
    let normal = Unit3::try_new(away, 0.5).unwrap_or(frame.axis);
    let arc = cutter.touching(sine.atan2(rise));
    let rho = arc.centre_rho_mm + arc.radius_mm * sine;
    let height = z + arc.centre_z_mm - arc.radius_mm * rise;
    let point = frame.point([x - rho * out[0], y - rho * out[1], height]);
    let width_mm = want.map_or(f64::NAN, |w| 2.0 * w.reach / sine);
    let uv = want.map_or(osculate_geom::uv(0.0, 0.0), |w| w.uv);
    CcPoint { uv, point, normal, pose, width_mm }
}

/// Leaves out points that the chord over them passes within a tolerance.
fn thin(all: Vec<CcPoint>, within_mm: f64) -> Vec<CcPoint> {
    let off = |p: &Point3, a: &Point3, b: &Point3| {
        let (d, w) = (b - a, p - a);
        let long = d.norm_squared();
        let t = if long > 0.0 { (w.dot(&d) / long).clamp(0.0, 1.0) } else { 0.0 };
        (w - d * t).norm()
    };
    let tip = |k: usize| &all[k].pose.tip;
    let mut keep = vec![0];
    let mut at = 0;
    while at + 1 < all.len() {
        let mut next = at + 1;
        // Chords over more points than that are long enough.
        while next + 1 < all.len()
            && next - at < 64
            && (at + 1..=next).all(|k| off(tip(k), tip(at), tip(next + 1)) <= within_mm)
        {
            next += 1;
        }
        keep.push(next);
        at = next;
    }
    keep.into_iter().map(|k| all[k]).collect()
}

/// Passes from the highest down, the nearest first; a closed one begins where it is nearest.
fn down(passes: Vec<Pass>) -> Vec<Pass> {
    let mut open: Vec<Option<Pass>> = passes.into_iter().map(Some).collect();
    let mut out: Vec<Pass> = Vec::with_capacity(open.len());
    while out.len() < open.len() {
        let here = out.last().and_then(|p| p.points.last()).map(|p| p.pose.tip);
        let nearest = |p: &Pass| -> (f64, usize) {
            let Some(here) = here else { return (0.0, 0) };
            let starts = if p.closed { p.points.len() } else { 1 };
            let far = |k: usize| (p.points[k].pose.tip - here).norm();
            // A few of many are as good.
            (0..starts)
                .step_by(starts.div_ceil(STARTS))
                .map(|k| (far(k), k))
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .unwrap_or((f64::INFINITY, 0))
        };
        let next = open.iter().enumerate().filter_map(|(k, p)| Some((k, nearest(p.as_ref()?))));
        let Some((k, (_, start))) = next.min_by(|a, b| a.1.0.total_cmp(&b.1.0)) else { break };
        let Some(mut pass) = open[k].take() else { break };
        if pass.closed && start > 0 {
            pass.points.pop();
            let n = pass.points.len();
            pass.points.rotate_left(start % n);
            pass.points.push(pass.points[0]);
        }
        out.push(pass);
    }
    out
}
