//! Passes taken apart at stations: poses so close along them that nothing happens between, and what remains where some are dropped.

use super::{CcPoint, Pass};
use osculate_tools::sweep::{LinearMotion, SweptMotion};

/// A pose along a pass; those between its points are put in.
pub(super) struct Station {
    pub point: CcPoint,
    pub of_pass: bool,
}

/// The points of a pass with others between them, no further apart than `step_mm` at tip and contact.
pub(super) fn stations(pass: &Pass, step_mm: f64) -> Vec<Station> {
    let mut out = Vec::new();
    for w in pass.points.windows(2) {
        let [a, b] = [w[0], w[1]];
        out.push(Station { point: a, of_pass: true });
        let motion = LinearMotion { from: a.pose, to: b.pose };
        let length = (b.point - a.point).norm().max((b.pose.tip - a.pose.tip).norm());
        // A pass has no gaps: a length that is no number, or endless, was refused before.
        let pieces = (length / step_mm).ceil().max(1.0) as usize;
        for k in 1..pieces {
            let t = k as f64 / pieces as f64;
            let Some(now) = motion.at(t) else { continue };
            // Parameters may jump over a seam: those of the nearer point.
            let near = if t < 0.5 { a } else { b };
            let point = a.point + (b.point - a.point) * t;
            let width_mm = a.width_mm + (b.width_mm - a.width_mm) * t;
            out.push(Station { point: CcPoint { point, pose: now.pose, width_mm, ..near }, of_pass: false });
        }
    }
    out.extend(pass.points.last().map(|p| Station { point: *p, of_pass: true }));
    out
}

/// What remains of a pass without the stations that are `out`: pieces no shorter than `short` of their strips' width.
pub(super) fn pieces(pass: &Pass, stations: &[Station], out: &[bool], short: f64) -> Vec<Pass> {
    let mut runs: Vec<Vec<CcPoint>> = Vec::new();
    let mut run: Vec<CcPoint> = Vec::new();
    for (k, s) in stations.iter().enumerate() {
        if out[k] {
            runs.extend((!run.is_empty()).then(|| std::mem::take(&mut run)));
            continue;
        }
        let is_end = run.is_empty() || out.get(k + 1).is_none_or(|next| *next);
        if s.of_pass || is_end {
            run.push(s.point);
        }
    }
    if !run.is_empty() {
        // Where a closed pass begins nothing is left out: its end leads on to its beginning, which is the same point.
        if pass.closed && !out[0] && !runs.is_empty() {
            run.extend(runs.remove(0).into_iter().skip(1));
        }
        runs.push(run);
    }
    let pieces = runs.into_iter().map(|points| Pass { points, closed: false });
    let is_long = |p: &Pass| p.points.len() > 1 && p.length_mm() >= short * p.mean_width_mm();
    pieces.filter(is_long).collect()
}
