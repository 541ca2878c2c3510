//! Passes and links of the static picture: cut where something hides them, thinned, coloured.

use super::super::data::Report;
use super::super::legend::{Scale, UNKNOWN};
use super::super::pack::finite;
use super::super::project::{Camera, DepthMap};
use super::paint::step;
use super::view::{PathColours, View};
use std::fmt::Write;

/// Passes in the picture; more are a grey area and not lines.
const PASSES: usize = 130;
/// Corners of all lines in the picture, about 8 bytes each.
const LINE_POINTS: usize = 9000;
/// Lines lie on the surface: this many pixels behind it they still count as visible.
const SLACK_PX: f64 = 2.5;

/// Segments longer than this are looked at in between: their ends may be visible and their middle not.
const LOOK_PX: f64 = 5.0;
/// Colours of the strip width; beside them stands the one for widths not known.
const CLASSES: usize = 10;

/// A run of visible points with the class of colour it has.
type Run = (usize, Vec<[f64; 2]>);

/// Where lines are drawn and what may hide them.
#[non_exhaustive]
pub struct Scene {
    /// The camera.
    pub camera: Camera,
    /// Everything solid.
    pub depth: DepthMap,
}

/// Draws passes and links; returns how many passes of how many are drawn.
pub fn lines(
    out: &mut String,
    report: &Report,
    view: &View,
    scale: Option<&Scale>,
    scene: &Scene,
) -> [usize; 2] {
    let project = |p: &[f32; 3]| scene.camera.project(p.map(f64::from));
    let depth = &scene.depth;
    let cut: Vec<_> = report.passes.iter().filter(|p| !p.points_mm.is_empty()).collect();
    let stride = cut.len().div_ceil(PASSES).max(1);
    let shown: Vec<_> = match view.path {
        PathColours::Hidden => Vec::new(),
        _ => cut.iter().step_by(stride).collect(),
    };
    let class = |width: Option<&f32>| -> usize {
        let (Some(scale), Some(w)) = (scale, width.filter(|w| w.is_finite())) else { return CLASSES };
        let (lo, hi) = scale.range();
        let t = if hi > lo { (f64::from(*w) - lo) / (hi - lo) } else { 0.0 };
        (t * CLASSES as f64).clamp(0.0, CLASSES as f64 - 1.0) as usize
    };
    let mut runs: Vec<Run> = Vec::new();
    for pass in &shown {
        let points = pass.points_mm.iter().enumerate().filter(|(_, p)| finite(p));
        let located = points.map(|(i, p)| (class(pass.widths_mm.get(i)), project(p)));
        visible_runs(&mut runs, located, depth);
    }
    let thinned = thin(runs);
    for c in 0..=CLASSES {
        let mut d = String::new();
        for (_, run) in thinned.iter().filter(|(k, _)| *k == c) {
            polyline(&mut d, run);
        }
        if d.is_empty() {
            continue;
        }
        let (colour, opacity, width) = match scale {
            Some(scale) => {
                let (lo, hi) = scale.range();
                let colour = if c == CLASSES {
                    UNKNOWN
                } else {
                    scale.colour(lo + (hi - lo) * (c as f64 + 0.5) / CLASSES as f64)
                };
                (colour, "1", "3")
            }
            None => ([0x1c, 0x2b, 0x3a], ".55", "1.5"),
        };
        let [r, g, b] = colour;
        let _ = write!(
            out,
            "<path transform=\"scale(.5)\" fill=\"none\" stroke=\"#{r:02x}{g:02x}{b:02x}\" stroke-opacity=\"{opacity}\" \
             stroke-width=\"{width}\" stroke-linejoin=\"round\" d=\"{d}\"/>"
        );
    }
    if view.links {
        let mut runs: Vec<Run> = Vec::new();
        for link in &report.links {
            let located =
                link.points_mm.iter().filter(|p| finite(p)).map(|p| (usize::from(!link.rapid), project(p)));
            visible_runs(&mut runs, located, depth);
        }
        let thinned = thin(runs);
        for (kind, stroke) in [(0, "#c2410c\" stroke-dasharray=\"7 5"), (1, "#0369a1")] {
            let mut d = String::new();
            thinned.iter().filter(|(k, _)| *k == kind).for_each(|(_, run)| polyline(&mut d, run));
            if !d.is_empty() {
                let _ = write!(
                    out,
                    "<path transform=\"scale(.5)\" fill=\"none\" stroke=\"{stroke}\" stroke-width=\"1.6\" d=\"{d}\"/>"
                );
            }
        }
    }
    [shown.len(), cut.len()]
}

/// Cuts a line into runs of points that can be seen and have one class; a run of another class begins where the last
/// one ends.
fn visible_runs(runs: &mut Vec<Run>, points: impl Iterator<Item = (usize, [f64; 3])>, depth: &DepthMap) {
    let mut open: Option<Run> = None;
    let mut last: Option<(usize, [f64; 3])> = None;
    let mut look = |class: usize, p: [f64; 3]| {
        let at = [p[0], p[1]];
        if !depth.sees(p, SLACK_PX) {
            runs.extend(open.take().filter(|(_, run)| run.len() > 1));
            return;
        }
        match &mut open {
            Some((c, run)) => {
                run.push(at);
                if *c != class {
                    runs.extend(open.replace((class, vec![at])));
                }
            }
            None => open = Some((class, vec![at])),
        }
    };
    for (class, p) in points {
        if let Some((from_class, from)) = last {
            let pieces = ((p[0] - from[0]).hypot(p[1] - from[1]) / LOOK_PX).ceil().clamp(1.0, 2000.0);
            for i in 1..pieces as usize {
                let t = i as f64 / pieces;
                look(from_class, std::array::from_fn(|k| from[k] + (p[k] - from[k]) * t));
            }
        }
        look(class, p);
        last = Some((class, p));
    }
    runs.extend(open.filter(|(_, run)| run.len() > 1));
}

/// Leaves out points that lie on the line of their neighbours, within a quarter pixel or as much more as the bound on
/// points needs.
fn thin(runs: Vec<Run>) -> Vec<Run> {
    let mut slack = 0.25;
    loop {
        let out: Vec<Run> = runs.iter().map(|(c, run)| (*c, straightened(run, slack))).collect();
        let points: usize = out.iter().map(|(_, run)| run.len()).sum();
        // At two points a run nothing more can be left out.
        if points <= LINE_POINTS.max(2 * runs.len()) || slack > 1e4 {
            return out;
        }
        slack *= 1.6;
    }
}

/// Douglas and Peucker's thinning, without recursion.
fn straightened(run: &[[f64; 2]], slack: f64) -> Vec<[f64; 2]> {
    let mut keep = vec![false; run.len()];
    let mut open = vec![(0, run.len().saturating_sub(1))];
    while let Some((from, to)) = open.pop() {
        keep[from] = true;
        keep[to] = true;
        let (a, b) = (run[from], run[to]);
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let length = dx.hypot(dy);
        let off = |p: [f64; 2]| {
            let (px, py) = (p[0] - a[0], p[1] - a[1]);
            if length > 0.0 { (px * dy - py * dx).abs() / length } else { px.hypot(py) }
        };
        let far = (from + 1..to).max_by(|&i, &j| off(run[i]).total_cmp(&off(run[j])));
        if let Some(far) = far.filter(|&i| off(run[i]) > slack) {
            open.push((from, far));
            open.push((far, to));
        }
    }
    run.iter().zip(keep).filter(|(_, k)| *k).map(|(p, _)| *p).collect()
}

fn polyline(d: &mut String, run: &[[f64; 2]]) {
    let points: Vec<[i64; 2]> = run.iter().map(|p| p.map(|x| (2.0 * x).round() as i64)).collect();
    let Some(first) = points.first() else { return };
    let _ = write!(d, "M{} {}", first[0], first[1]);
    for (i, pair) in points.windows(2).enumerate() {
        step(d, if i == 0 { 'l' } else { ' ' }, pair[0], pair[1]);
    }
}
