//! The least lead at which a tool, standing at a contact, goes nowhere into the part.
//!
//! Every pose of a pass is one of these, so that a pass whose poses are clear is clear: no motion has to be followed. The face is
//! a lattice of points, dense against the tool's radius; where the distance to the tool has a minimum among them its neighbours
//! say how low it may be between, as convex as it is, and the surface itself how low it is. Below the tool's end all points of the lattice are asked, further up
//! along its shank every few.
//!
//! *Limits.* Ripples that no tool follows go into it at any lead: what the tool's end meets at a great lead is accepted at any,
//! and [`super::super::seat`] raises the tool over it. A place that no lead clears asks for none and is told of: verification has
//! the last word.

use super::lean::LocalLead;
use crate::plan::Task;
use crate::rectangle::{Rectangle, lengths};
use osculate_geom::{Axis, Darboux, Point3, Unit3, Uv, Vec3};
use osculate_tools::{Cutter, Lean, Pose};
use rayon::prelude::*;

/// Distance of the lattice's points, of the tool's radius, and most points a side.
const APART: f64 = 0.1;
const MOST: usize = 900;
/// Half the side of the part of the lattice that is asked in full, in radii: the bottom reaches two from the contact.
const NEAR: f64 = 2.2;
/// Further off one point in so many along each parameter is asked.
const STRIDE: usize = 5;
/// Points of the lattice along each side of what is passed over at once, near the tool and further off.
const BLOCK: usize = 4;
const GROUP: usize = 30;
/// Depth accepted, of the tolerance, as fields of axes have it: what else goes too deep, chords above all, needs the rest.
const ACCEPTED: f64 = 0.3;
/// Depth accepted of a pose beyond the border, of the tolerance: no lead was found for it.
const DUG: f64 = 0.5;
/// Quotient of leads that are tried one after the other, and halvings between the last two.
const STEP: f64 = 1.25;
const HALVINGS: u32 = 10;
/// The lead at which only ripples go into a face next to the contact, rad.
const RELIEF_RAD: f64 = 0.5;
/// Minima nearer to the contact than so many steps of the lattice are the contact's own.
const OWN: f64 = 1.5;
/// A point of the lattice and those that tell how low it may be next to it.
const BESIDE: [i64; 5] = [-2, -1, 0, 1, 2];
/// Rounds of a look between the lattice's points.
const PATTERN: u32 = 12;
/// Normals of rough faces are averaged this far around, of the tool's radius.
const AVERAGE: f64 = 0.04;

/// The points of a face against which a tool is held.
pub(in crate::plan) struct Clearance<'a> {
    task: &'a Task<'a>,
    local: &'a LocalLead<'a>,
    rectangle: Rectangle,
    rough: bool,
    /// Steps of the lattice along u and v.
    count: [usize; 2],
    /// In rows of v for each u; None outside the trims.
    points: Vec<Option<Point3>>,
    /// Every few of them in groups, each with a ball around it.
    far: Vec<(Point3, f64, Vec<Point3>)>,
    /// Greatest length of a step, mm.
    step_mm: [f64; 2],
    accepted_mm: f64,
}

/// A contact with one direction of feed, and a tilt.
pub(in crate::plan) struct Stand {
    pub(super) at: Uv,
    pub(super) frame: Darboux,
    pub(super) tilt_rad: f64,
}

impl<'a> Clearance<'a> {
    pub fn new(task: &'a Task<'a>, local: &'a LocalLead<'a>, rough: bool) -> Self {
        let rectangle = Rectangle::of(task.surface);
        let apart = APART * task.cutter.radius_mm();
        let long = lengths(task.surface, &rectangle);
        let count = long.map(|l| ((l / apart).ceil() as usize).clamp(8, MOST));
        let points: Vec<Option<Point3>> = (0..=count[0])
            .into_par_iter()
            .flat_map_iter(|i| {
                (0..=count[1]).map(move |j| {
                    let at = rectangle.domain.at(i as f64 / count[0] as f64, j as f64 / count[1] as f64);
                    task.surface.contains(at).then(|| task.surface.point(at))
                })
            })
            .collect();
        let width = count[1] + 1;
        let longest = |by: usize| {
            let pairs = points.iter().zip(points.iter().skip(by)).enumerate();
            let steps = pairs.filter(|(k, _)| by > 1 || k % width + 1 < width);
            steps.filter_map(|(_, (a, b))| Some((a.as_ref()? - b.as_ref()?).norm())).fold(0.0, f64::max)
        };
        let step_mm = [longest(width), longest(1)];
        let group = |i0: usize, j0: usize| {
            let side = |from: usize, to: usize| (from..=to.min(from + GROUP - 1)).step_by(STRIDE);
            let all = side(i0, count[0]).flat_map(|i| side(j0, count[1]).map(move |j| i * width + j));
            let all: Vec<Point3> = all.filter_map(|k| points[k]).collect();
            let middle = all.get(all.len() / 2).copied()?;
            let reach = all.iter().map(|p| (p - middle).norm()).fold(0.0, f64::max);
            Some((middle, reach, all))
        };
        let corners = (0..=count[0]).step_by(GROUP);
        let corners = corners.flat_map(|i| (0..=count[1]).step_by(GROUP).map(move |j| (i, j)));
        let far = corners.filter_map(|(i, j)| group(i, j)).collect();
        let accepted_mm = ACCEPTED * task.tolerance.gouge_mm;
        Self { task, local, rectangle, rough, count, points, far, step_mm, accepted_mm }
    }

    /// The contact at a place with the feed along `way` and a tilt.
    pub fn stand(&self, at: Uv, way: &Vec3, tilt_rad: f64) -> Option<Stand> {
        let surface = self.task.surface;
        let jet = surface.jet2(at);
        let forms = jet.forms().ok()?;
        let mut frame = Darboux::with_forms(&jet, &forms, way, 0.0);
        if self.rough {
            let by = AVERAGE * self.task.cutter.radius_mm();
            let (du, dv) = (by / jet.du.norm(), by / jet.dv.norm());
            let around = [(du, 0.0), (-du, 0.0), (0.0, dv), (0.0, -dv)];
            let normals = around.iter().filter_map(|(a, b)| {
                let at = self.rectangle.bring(Uv { u: at.u + a, v: at.v + b })?;
                surface.jet2(at).normal().ok()
            });
            let sum = normals.fold(forms.normal.into_inner(), |s, n| s + n.into_inner());
            let normal = Unit3::try_new(sum, 1e-6)?;
            let tangent = osculate_geom::project_to_tangent(&normal, way);
            let left = Unit3::new_unchecked(normal.cross(&tangent));
            frame = Darboux { normal, tangent, left, ..frame };
        }
        frame.tangent.iter().all(|x| x.is_finite()).then_some(Stand { at, frame, tilt_rad })
    }

    fn pose(&self, stand: &Stand, lead_rad: f64) -> Pose {
        Lean { lead_rad, tilt_rad: stand.tilt_rad }.pose(self.task.cutter, &stand.frame, 0.0)
    }

    /// Whether a pose of a pass at a place, or nearest to it beyond a border, goes deeper into the part than it may.
    pub fn digs_in(&self, at: Uv, pose: &Pose) -> bool {
        let way = self.task.surface.jet2(at).du;
        let most_mm = DUG * self.task.tolerance.gouge_mm;
        self.stand(at, &way, 0.0)
            .is_some_and(|s| self.near_mm(&s, pose, most_mm) > most_mm || self.far_mm(&s, pose) > most_mm)
    }

    /// Whether the tool goes no deeper than `most_mm` into the part at a contact.
    fn is_clear(&self, stand: &Stand, lead_rad: f64, most_mm: f64) -> bool {
        let pose = self.pose(stand, lead_rad);
        self.near_mm(stand, &pose, most_mm) <= most_mm && self.far_mm(stand, &pose) <= most_mm
    }

    /// The lattice's indices around a place, running on past seams: from and to along each parameter.
    fn window(&self, at: Uv) -> [[i64; 2]; 2] {
        [Axis::U, Axis::V].map(|axis| {
            let k = usize::from(axis == Axis::V);
            let (i, n) = (self.rectangle.domain.get(axis), self.count[k] as i64);
            let x = (at.get(axis) - i.lo) / i.length() * n as f64;
            // The lattice is nowhere sparser than its step; where it is denser the window is smaller than it need be.
            let jet = self.task.surface.jet2(at);
            let speed = if axis == Axis::U { jet.du.norm() } else { jet.dv.norm() };
            let step = (speed * i.length() / n as f64).min(self.step_mm[k]).max(1e-3 * self.step_mm[k]);
            let half = (NEAR * self.task.cutter.radius_mm() / step).ceil().min(n as f64) as i64;
            let (from, to) = (x.floor() as i64 - half, x.floor() as i64 + 1 + half);
            if self.rectangle.closes[k] {
                if to - from >= n { [0, n - 1] } else { [from, to] }
            } else {
                [from.max(0), to.min(n)]
            }
        })
    }

    fn point(&self, i: i64, j: i64) -> Option<Point3> {
        let held = |k: i64, axis: usize| {
            let n = self.count[axis] as i64;
            if self.rectangle.closes[axis] { k.rem_euclid(n) as usize } else { k.clamp(0, n) as usize }
        };
        self.points[held(i, 0) * (self.count[1] + 1) + held(j, 1)]
    }

    /// The depth below the tool's end.
    fn near_mm(&self, stand: &Stand, pose: &Pose, enough_mm: f64) -> f64 {
        let [[u0, u1], [v0, v1]] = self.window(stand.at);
        let width = (v1 - v0 + 1) as usize;
        let cutter = self.task.cutter;
        let mut gaps = vec![f64::INFINITY; (u1 - u0 + 1) as usize * width];
        let reach = BLOCK as f64 * (self.step_mm[0] + self.step_mm[1]);
        for (i0, j0) in (u0..=u1).step_by(BLOCK).flat_map(|i| (v0..=v1).step_by(BLOCK).map(move |j| (i, j))) {
            // What lies so far from the tool as a whole is not looked at.
            if self.point(i0, j0).is_some_and(|p| cutter.distance(pose, &p) > reach) {
                continue;
            }
            for i in i0..=u1.min(i0 + BLOCK as i64 - 1) {
                for j in j0..=v1.min(j0 + BLOCK as i64 - 1) {
                    let gap = self.point(i, j).map_or(f64::INFINITY, |p| cutter.distance(pose, &p));
                    if -gap > enough_mm {
                        return -gap;
                    }
                    gaps[(i - u0) as usize * width + (j - v0) as usize] = gap;
                }
            }
        }
        let lowest = gaps.iter().copied().fold(f64::INFINITY, f64::min);
        let rows = gaps.len() / width;
        let gap = |i: i64, j: i64| {
            let inside = i >= 0 && j >= 0 && (i as usize) < rows && (j as usize) < width;
            if inside { gaps[i as usize * width + j as usize] } else { f64::INFINITY }
        };
        let own = OWN * APART * cutter.radius_mm();
        let limit = -enough_mm.min(self.accepted_mm);
        // The two places that may be lowest between the points.
        let mut doubtful = [(limit, 0); 2];
        for (k, here) in gaps.iter().enumerate().filter(|(_, here)| here.is_finite()) {
            let (i, j) = (k / width, k % width);
            let along_u = BESIDE.map(|n| gap(i as i64 + n, j as i64));
            let along_v = BESIDE.map(|n| gap(i as i64, j as i64 + n));
            if ![along_u, along_v].iter().all(|[_, b, c, d, _]| c <= b && c <= d) {
                continue;
            }
            let low = here - dip(along_u) - dip(along_v);
            let apart =
                self.point(u0 + i as i64, v0 + j as i64).map_or(0.0, |p| (p - stand.frame.point).norm());
            // The contact's own minimum is zero.
            if low < doubtful[1].0 && apart > own {
                doubtful[1] = (low, k);
                if low < doubtful[0].0 {
                    doubtful.swap(0, 1);
                }
            }
        }
        let refined = doubtful.iter().filter(|d| d.0 < limit).map(|(_, k)| {
            let place = [u0 as f64 + (k / width) as f64, v0 as f64 + (k % width) as f64];
            self.lowest_mm(pose, place, gaps[*k])
        });
        -refined.fold(lowest, f64::min)
    }

    /// The least distance to the tool around a place of the lattice, by steps that halve.
    fn lowest_mm(&self, pose: &Pose, mut from: [f64; 2], mut gap: f64) -> f64 {
        let surface = self.task.surface;
        let mut step = 0.5;
        for _ in 0..PATTERN {
            let ways = [[step, 0.0], [-step, 0.0], [0.0, step], [0.0, -step]];
            let found = ways.iter().filter_map(|[a, b]| {
                let x = [from[0] + a, from[1] + b];
                let at = self.rectangle.domain.at(x[0] / self.count[0] as f64, x[1] / self.count[1] as f64);
                let at = self.rectangle.bring(at).filter(|at| surface.contains(*at))?;
                Some((self.task.cutter.distance(pose, &surface.point(at)), x))
            });
            match found.min_by(|a, b| a.0.total_cmp(&b.0)) {
                Some((lower, x)) if lower < gap => (gap, from) = (lower, x),
                _ => step *= 0.5,
            }
        }
        gap
    }

    /// The depth of shank and holder, and of the whole tool in what else is around.
    fn far_mm(&self, stand: &Stand, pose: &Pose) -> f64 {
        let (cutter, task) = (self.task.cutter, self.task);
        let mut lowest = f64::INFINITY;
        // Roughness and the coarse points' own distance from the face are not meant.
        let slack = task.tolerance.gouge_mm + task.tolerance.scallop_mm;
        let beyond = (NEAR * cutter.radius_mm()).powi(2);
        let holder: Vec<(&Cutter, Pose)> =
            self.local.holder.iter().flat_map(|h| h.posed(cutter, pose)).collect();
        for (middle, reach, points) in &self.far {
            let clear = |body: &Cutter, at: &Pose| body.distance(at, middle) > *reach;
            if clear(cutter, pose) && holder.iter().all(|(body, at)| clear(body, at)) {
                continue;
            }
            for p in points.iter().filter(|p| (*p - stand.frame.point).norm_squared() > beyond) {
                lowest = lowest.min(cutter.distance(pose, p) + slack);
                for (body, at) in &holder {
                    lowest = lowest.min(body.distance(at, p));
                }
            }
        }
        if let Some(around) = self.local.around {
            let above = holder.into_iter().map(|(body, at)| (body, at, 0.0));
            let bodies = [(cutter, *pose, slack)].into_iter().chain(above);
            for (body, at, slack) in bodies {
                if let Some((depth, _)) = around.met(body, &at, slack) {
                    lowest = lowest.min(slack - depth);
                }
            }
        }
        -lowest
    }

    /// Leads that are tried, from one on.
    fn leads(&self, from_rad: f64) -> impl Iterator<Item = f64> {
        let most = self.local.most_rad;
        let mut next = Some(from_rad.min(most));
        std::iter::from_fn(move || {
            let lead = next?;
            next = (lead < most).then(|| (lead * STEP).min(most));
            Some(lead)
        })
    }

    /// The least lead from `from_rad` on that is clear at a contact; None where none is.
    pub fn least(&self, stand: &Stand, from_rad: f64) -> Option<f64> {
        if self.is_clear(stand, from_rad, self.accepted_mm) {
            return Some(from_rad);
        }
        // What goes into the part next to the contact at a great lead too are ripples.
        let relief = RELIEF_RAD.clamp(from_rad, self.local.most_rad.max(from_rad));
        let ripple_mm = if self.rough {
            self.near_mm(stand, &self.pose(stand, relief), f64::INFINITY).max(0.0)
        } else {
            0.0
        };
        let slack = self.task.tolerance.gouge_mm + self.task.tolerance.scallop_mm;
        for accepted in [self.accepted_mm, slack] {
            let clear = |lead: f64| self.is_clear(stand, lead, accepted + ripple_mm);
            let mut bad = None;
            for lead in self.leads(from_rad) {
                if !clear(lead) {
                    bad = Some(lead);
                    continue;
                }
                let (Some(mut low), mut good) = (bad, lead) else { return Some(lead) };
                for _ in 0..HALVINGS {
                    if good - low <= self.missing_rad() {
                        break;
                    }
                    let middle = 0.5 * (low + good);
                    if clear(middle) { good = middle } else { low = middle }
                }
                return Some(good);
            }
        }
        None
    }

    /// A lead that may be missing: the heel, two radii away, comes down by what is accepted.
    pub fn missing_rad(&self) -> f64 {
        self.accepted_mm / (2.0 * self.task.cutter.radius_mm())
    }
}

/// How far a convex function may come down below the middle one of five equally spaced values, the least of them: between two it lies above the
/// lines through those before and behind. Values that are not known are infinite.
fn dip([a, b, c, d, e]: [f64; 5]) -> f64 {
    // Towards `near`, with `far` beyond it, from the middle; `other` is on the other side of that.
    let towards = |far: f64, near: f64, other: f64| {
        let (behind, before) = (other - c, far - near);
        let meet = match (behind.is_finite(), before.is_finite()) {
            _ if !near.is_finite() => return 0.0,
            (true, true) if behind + before > 0.0 => (c - near + before) / (behind + before),
            (true, false) => 1.0,
            (false, true) => return (c - near + before).max(0.0),
            _ => return 0.0,
        };
        behind * meet.clamp(0.0, 1.0)
    };
    towards(a, b, d).max(towards(e, d, b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// A flat bottom that falls along a line to the place 0, a rounded corner and a cone after it: nowhere between three of five values is it
        /// lower than said, whether the outer two are known or not.
        #[test]
        fn a_convex_gap_comes_down_no_further(
            from in -3.0..-1.0f64, slope in 0.0..0.3f64, radius in 0.05..3.0f64, known in prop::array::uniform2(any::<bool>()),
        ) {
            let gap = |x: f64| {
                let corner = 0.8 * radius;
                let round = |x: f64| radius - (radius * radius - x * x).sqrt();
                if x < 0.0 { -slope * x } else if x < corner { round(x) } else { round(corner) + (x - corner) / 0.75 }
            };
            let mut values = [0, 1, 2, 3, 4].map(|k| gap(from + f64::from(k)));
            prop_assume!(values[2] <= values[1] && values[2] <= values[3]);
            let least = (0..=2000).map(|k| gap(from + 1.0 + f64::from(k) * 1e-3)).fold(f64::INFINITY, f64::min);
            for (k, known) in [0, 4].into_iter().zip(known) {
                values[k] = if known { values[k] } else { f64::INFINITY };
            }
            prop_assert!(values[2] - dip(values) <= least + 1e-12, "{values:?} {least}");
        }
    }
}
