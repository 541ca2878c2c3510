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

/// Passes in the order of cutting, with what was taken out between those that were one.
///
/// ```
/// use osculate_geom::{Point3, Vec3, uv};
/// use osculate_productivity::plan::{CcPoint, Pass, Rest, Stretches, rest_of};
/// use osculate_tools::Pose;
///
/// // A pass of 100 mm along x with a strip of 1 mm.
/// let at = |x: f64| {
///     let point = Point3::new(x, 0.0, 0.0);
///     CcPoint { uv: uv(x, 0.0), point, normal: Vec3::z_axis(), pose: Pose { tip: point, axis: Vec3::z_axis() }, width_mm: 1.0 }
/// };
/// let pass = Pass { points: vec![at(0.0), at(100.0)], closed: false };
/// assert_eq!((pass.length_mm(), pass.mean_width_mm()), (100.0, 1.0));
/// // Material is left at x = 20 and x = 70 only: two short passes go 2.5 mm to either side.
/// let places = [Point3::new(20.0, 0.0, 0.0), Point3::new(70.0, 0.0, 0.0)];
/// let rest: Stretches = rest_of(&[pass], &Rest { places: &places, overlap_mm: 2.0, hop_mm: 1.0 })?;
/// assert_eq!(rest.passes.len(), 2);
/// assert!(rest.passes.iter().all(|p| (p.length_mm() - 5.0).abs() < 0.6));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Stretches {
    /// The passes.
    pub passes: Vec<Pass>,
    /// After each the poses of the pass that led on to the next, where nothing is cut; none where the next is of another.
    pub skipped: Vec<Vec<CcPoint>>,
}

impl From<Vec<Pass>> for Stretches {
    fn from(passes: Vec<Pass>) -> Self {
        Self { skipped: vec![Vec::new(); passes.len()], passes }
    }
}

impl Stretches {
    /// Appends others.
    pub fn extend(&mut self, others: Self) {
        self.passes.extend(others.passes);
        self.skipped.extend(others.skipped);
    }
}

impl FromIterator<Self> for Stretches {
    fn from_iter<T: IntoIterator<Item = Self>>(all: T) -> Self {
        let mut out = Self::default();
        all.into_iter().for_each(|one| out.extend(one));
        out
    }
}

/// What remains of a pass without the stations that are `out`: pieces no shorter than `short` of their strips' width.
pub(super) fn pieces(pass: &Pass, stations: &[Station], out: &[bool], short: f64) -> Stretches {
    // First and last station of each run; a run of a closed pass that goes on over its end has a later first than last.
    let mut runs: Vec<[usize; 2]> = Vec::new();
    for k in (0..stations.len()).filter(|k| !out[*k]) {
        match runs.last_mut() {
            Some(run) if run[1] + 1 == k => run[1] = k,
            _ => runs.push([k, k]),
        }
    }
    // Where a closed pass begins nothing is left out: its end leads on to its beginning, which is the same point.
    let goes_on = pass.closed && runs.len() > 1 && !out[0] && out.last() == Some(&false);
    if goes_on {
        let first = runs.remove(0);
        if let Some(last) = runs.last_mut() {
            last[1] = first[1];
        }
    }
    let n = stations.len();
    // The stations from one to another, over the end where that is behind; the same point is there once.
    let between = |from: usize, to: usize| -> Vec<usize> {
        if from <= to { (from..=to).collect() } else { (from..n).chain(1..=to).collect() }
    };
    let points = |[from, to]: [usize; 2]| -> Vec<CcPoint> {
        let all = between(from, to).into_iter();
        all.filter(|k| stations[*k].of_pass || *k == from || *k == to).map(|k| stations[k].point).collect()
    };
    let made = runs.into_iter().map(|run| (run, Pass { points: points(run), closed: false }));
    // Strips that are not known are no reason to drop a piece.
    let is_short = |p: &Pass| p.length_mm() < short * p.mean_width_mm();
    let long: Vec<([usize; 2], Pass)> = made.filter(|(_, p)| p.points.len() > 1 && !is_short(p)).collect();
    let next = long.iter().skip(1).map(|(run, _)| Some(run[0])).chain([None]);
    let skipped = long
        .iter()
        .zip(next)
        .map(|((run, _), next)| {
            let all = next.map(|next| between(run[1], next)).unwrap_or_default();
            all.into_iter().map(|k| stations[k].point).collect()
        })
        .collect();
    Stretches { skipped, passes: long.into_iter().map(|(_, pass)| pass).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::{Point3, Vec3, uv};
    use osculate_tools::Pose;
    use proptest::prelude::*;

    proptest! {
        /// What remains and what was skipped are the pass again, station by station.
        #[test]
        fn nothing_is_lost(out in prop::collection::vec(prop::bool::weighted(0.4), 4..60), closed in any::<bool>()) {
            let n = out.len() - 1;
            let at = |k: usize| {
                let (s, c) = (std::f64::consts::TAU * (k % n) as f64 / n as f64).sin_cos();
                let point = if closed { Point3::new(c, s, 0.0) } else { Point3::new(k as f64, 0.0, 0.0) };
                let pose = Pose { tip: point, axis: Vec3::z_axis() };
                CcPoint { uv: uv(k as f64, 0.0), point, normal: Vec3::z_axis(), pose, width_mm: 1.0 }
            };
            let pass = Pass { points: (0..=n).map(at).collect(), closed };
            let mut out = out;
            // A closed pass ends where it begins.
            if closed {
                out[n] = out[0];
            }
            let all: Vec<Station> = (0..=n).map(|k| Station { point: at(k), of_pass: true }).collect();
            let found = pieces(&pass, &all, &out, 0.0);
            prop_assert_eq!(found.passes.len(), found.skipped.len());
            let on = |p: &CcPoint| (p.point - at(0).point).norm() < 1e-12;
            for (pass, way) in found.passes.iter().zip(&found.skipped) {
                prop_assert!(pass.points.iter().all(|p| !out[p.uv.u as usize]));
                let last = pass.points[pass.points.len() - 1].point;
                if let (Some(a), Some(b)) = (way.first(), way.last()) {
                    prop_assert_eq!(a.point, last);
                    // All inside were left out, or lie in pieces of one station.
                    prop_assert!(way.len() > 2 || on(b));
                }
            }
            for (k, way) in found.skipped.iter().enumerate() {
                match found.passes.get(k + 1) {
                    Some(next) => prop_assert_eq!(way[way.len() - 1].point, next.points[0].point),
                    None => prop_assert!(way.is_empty()),
                }
            }
            // Runs of two stations and more, and no others, are there.
            let kept: usize = found.passes.iter().map(|p| p.points.len()).sum();
            let mut runs: Vec<usize> = out.split(|o| *o).map(<[bool]>::len).collect();
            if closed && !out[0] && runs.len() > 1 {
                // The same point at both ends counts once.
                let first = runs.remove(0);
                if let Some(last) = runs.last_mut() {
                    *last += first - 1;
                }
            }
            prop_assert_eq!(kept, runs.into_iter().filter(|len| *len > 1).sum::<usize>());
        }
    }
}
