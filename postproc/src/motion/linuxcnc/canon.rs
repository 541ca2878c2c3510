//! From programmed moves to pieces of the planner: speed and acceleration along the path from the axes' limits, F as
//! the control reads it, and the joining of short straight moves (the second tolerance of `G64 P Q`).
//!
//! F counts along X Y Z where any of them moves, else along the rotary axes in degrees; rotary axes take the time
//! that the linear ones need, or the linear ones wait for them: `v = L / max_i(|d_i| / v_i)` bounds the speed, and the
//! same quotient with accelerations bounds the acceleration.

use osculate_geom::Vec3;

use super::segment::{End, NORMAL_SHARE, Run, Segment, Shape, TANGENTIAL_SHARE};
use super::{Limits, Planner};

/// Moves below this, mm or deg, are none to the control.
const LEAST: f64 = 1e-8;
/// Straight moves joined to one at most.
const MOST_JOINED: usize = 100;
/// The smallest F that inverse time is turned into, mm/min.
const LEAST_INVERSE: f64 = 0.1;

/// How the control goes from block to block.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum PathControl {
    /// G64: corners may be left by the tolerance (0: by as much as half of a block allows), straight moves within the
    /// second tolerance are joined.
    Blend {
        /// P.
        tolerance_mm: f64,
        /// Q, or P where Q is not given.
        join_mm: f64,
    },
    /// G61: on the path, stops where it is not tangent.
    ExactPath,
    /// G61.1: stops after every block.
    ExactStop,
}

impl PathControl {
    /// Before any G61 or G64: corners within a thousandth of an inch, nothing joined.
    pub const FIRST: Self = Self::Blend { tolerance_mm: 0.0254, join_mm: 0.0 };
}

/// One programmed move.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct CanonMove {
    /// G0.
    pub rapid: bool,
    /// Where X Y Z end, mm.
    pub xyz_mm: [f64; 3],
    /// Where the rotary axes end, deg.
    pub rotary_deg: [f64; 2],
    /// The arc on which X Y Z get there.
    pub arc: Option<CanonArc>,
    /// F.
    pub feed: CanonFeed,
}

/// F of a move.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum CanonFeed {
    /// G94: mm/min, and deg/min where only rotary axes move.
    PerMinute {
        /// Along X Y Z.
        mm_min: f64,
        /// Along the rotary axes.
        deg_min: f64,
    },
    /// G93: 1/min.
    Inverse(f64),
}

/// An arc in X Y Z.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct CanonArc {
    /// First and second axis of its plane; the third one moves along.
    pub plane: [usize; 2],
    /// Centre in the plane, mm.
    pub centre_mm: [f64; 2],
    /// Counter-clockwise positive, rad.
    pub sweep_rad: f64,
}

/// Programmed moves in, time out.
#[derive(Clone, Debug)]
pub struct Canon {
    planner: Planner,
    limits: Limits,
    at: ([f64; 3], [f64; 2]),
    control: PathControl,
    feed: CanonFeed,
    joined: Vec<Vec3>,
    limited: [usize; 5],
    /// Moves so far.
    count: usize,
    /// The first and the last of the joined moves.
    run: [usize; 2],
    /// Runs of moves that became one piece, where times of moves are asked for.
    runs: Vec<[usize; 2]>,
}

/// A move's way as the axes' limits see it.
struct Bounds {
    length: f64,
    velocity: f64,
    acceleration: f64,
    /// The axis that bounds the speed: 0 to 2 linear, 3 and 4 rotary.
    slowest: usize,
    linear: bool,
    rotary: bool,
}

impl Canon {
    /// At this place, before the first move.
    #[must_use]
    pub fn new(limits: &Limits, xyz_mm: [f64; 3], rotary_deg: [f64; 2]) -> Self {
        Self {
            planner: Planner::new(limits),
            limits: *limits,
            at: (xyz_mm, rotary_deg),
            control: PathControl::FIRST,
            feed: CanonFeed::Inverse(0.0),
            joined: Vec::new(),
            limited: [0; 5],
            count: 0,
            run: [0; 2],
            runs: Vec::new(),
        }
    }

    /// Keeps the time of every move, for [`Self::take_each_s`]. Before the first one.
    pub fn keep_each(&mut self) {
        self.planner.each_s = Some(Vec::new());
    }

    /// The time of every move so far, s, after [`Self::stop`]; moves that became one piece share its time as `weights` say. Empty where
    /// times are not kept.
    #[must_use]
    pub fn take_each_s(&mut self, weights: &[f64]) -> Vec<f64> {
        let mut each = self.planner.each_s.take().unwrap_or_default();
        for [first, last] in self.runs.drain(..) {
            let own = weights.get(first..=last).unwrap_or_default();
            let (all, count) = (own.iter().sum::<f64>(), (last + 1 - first) as f64);
            let Some(times) = each.get_mut(first..=last) else { continue };
            let spent = times.last().copied().unwrap_or(0.0);
            for (k, time) in times.iter_mut().enumerate() {
                *time = spent * own.get(k).filter(|_| all > 0.0).map_or(1.0 / count, |w| w / all);
            }
        }
        each
    }

    /// Another path control from here on.
    pub fn path_control(&mut self, control: PathControl) {
        self.flush();
        self.control = control;
    }

    /// Stands still, for a dwell or a tool change; the time of that is the caller's.
    pub fn stop(&mut self) {
        self.flush();
        self.planner.run_out();
    }

    /// A jump to a place without a move of its own (machine coordinates, a kinematics switch).
    pub fn jump(&mut self, xyz_mm: [f64; 3], rotary_deg: [f64; 2]) {
        self.stop();
        self.at = (xyz_mm, rotary_deg);
    }

    /// The same place in other words: after a switch of the kinematics.
    pub fn stand_at(&mut self, xyz_mm: [f64; 3], rotary_deg: [f64; 2]) {
        if self.joined.is_empty() {
            self.at = (xyz_mm, rotary_deg);
        }
    }

    /// Time of feed and of rapid moves, s. All of it only after [`Self::stop`].
    #[must_use]
    pub const fn clock_s(&self) -> [f64; 2] {
        self.planner.clock_s()
    }

    /// Moves that each axis made slower than F asks: three linear, two rotary.
    #[must_use]
    pub const fn limited(&self) -> [usize; 5] {
        self.limited
    }

    /// One move.
    pub fn go(&mut self, m: &CanonMove) {
        self.count += 1;
        if let Some(each) = &mut self.planner.each_s {
            each.push(0.0);
        }
        if m.rapid {
            self.flush();
            self.straight(m, None, self.count - 1);
            return;
        }
        if self.feed != m.feed {
            self.flush();
            self.feed = m.feed;
        }
        if let Some(arc) = m.arc {
            if let Some(middle) = self.flat_arc(m, &arc) {
                self.see(middle);
                self.see(Vec3::from(m.xyz_mm));
            } else {
                self.flush();
                self.arc(m, &arc);
            }
            return;
        }
        if m.rotary_deg == self.at.1 {
            self.see(Vec3::from(m.xyz_mm));
        } else {
            self.flush();
            self.straight(m, Some(m.feed), self.count - 1);
        }
    }

    /// A straight move of X Y Z that may be joined to those before.
    fn see(&mut self, to: Vec3) {
        if !self.joined.is_empty() && !self.joins(&to) {
            self.flush();
        }
        let now = self.count - 1;
        if self.joined.is_empty() {
            self.run[0] = now;
        }
        self.run[1] = now;
        self.joined.push(to);
    }

    fn joins(&self, to: &Vec3) -> bool {
        let PathControl::Blend { join_mm, .. } = self.control else { return false };
        let from = Vec3::from(self.at.0);
        let way = to - from;
        if join_mm == 0.0 || self.joined.len() > MOST_JOINED || way == Vec3::zeros() {
            return false;
        }
        self.joined.iter().all(|p| {
            let t = (way.dot(&(p - from)) / way.norm_squared()).clamp(0.0, 1.0);
            (p - from - way * t).norm() <= join_mm
        })
    }

    fn flush(&mut self) {
        let Some(to) = self.joined.pop() else { return };
        self.joined.clear();
        if self.planner.each_s.is_some() && self.run[0] < self.run[1] {
            self.runs.push(self.run);
        }
        let m =
            CanonMove { rapid: false, xyz_mm: to.into(), rotary_deg: self.at.1, arc: None, feed: self.feed };
        self.straight(&m, Some(self.feed), self.run[1]);
    }

    /// A straight piece that ends with the move `of`.
    fn straight(&mut self, m: &CanonMove, feed: Option<CanonFeed>, of: usize) {
        let b = self.bounds(m);
        let from = Vec3::from(self.at.0);
        self.at = (m.xyz_mm, m.rotary_deg);
        if b.length <= LEAST {
            return;
        }
        let to = Vec3::from(m.xyz_mm);
        let way = if b.linear { (to - from) / b.length } else { Vec3::x() };
        let wanted = self.wanted(&b, feed);
        let segment = Segment { of, ..self.segment(m, (Shape::Line { from, to }, way, way), &b, wanted) };
        self.planner.add(segment);
    }

    fn wanted(&mut self, b: &Bounds, feed: Option<CanonFeed>) -> f64 {
        let asked = match feed {
            None => return b.velocity,
            Some(CanonFeed::PerMinute { mm_min, .. }) if b.linear => mm_min,
            Some(CanonFeed::PerMinute { deg_min, .. }) => deg_min,
            Some(CanonFeed::Inverse(f)) => (b.length * f).max(LEAST_INVERSE),
        } / 60.0;
        if asked > b.velocity {
            self.limited[b.slowest] += 1;
        }
        asked.min(b.velocity)
    }

    fn segment(&self, m: &CanonMove, way: (Shape, Vec3, Vec3), b: &Bounds, wanted: f64) -> Segment {
        let (shape, start, end) = way;
        let (ends, tolerance_mm) = match self.control {
            PathControl::Blend { tolerance_mm, .. } => (End::Parabolic, tolerance_mm),
            PathControl::ExactPath => (End::Exact, 0.0),
            PathControl::ExactStop => (End::Stop, 0.0),
        };
        Segment {
            of: 0,
            rapid: m.rapid,
            shape,
            start,
            end,
            rotary: b.rotary,
            pure_rotary: b.rotary && !b.linear,
            length: b.length,
            nominal: b.length,
            wanted,
            greatest: b.velocity,
            acceleration: b.acceleration,
            tolerance_mm,
            ends,
            blended_into: false,
            kink: None,
            kink_share: [0.0; 2],
            tangential: TANGENTIAL_SHARE,
            final_length: false,
            out: 0.0,
            run: Run::default(),
        }
    }

    /// Limits along a straight move to the end of `m`.
    fn bounds(&self, m: &CanonMove) -> Bounds {
        let l = &self.limits;
        let (p, q) = (m.xyz_mm, self.at.0);
        let (r, t) = (m.rotary_deg, self.at.1);
        let d = [p[0] - q[0], p[1] - q[1], p[2] - q[2], r[0] - t[0], r[1] - t[1]].map(f64::abs);
        let d = d.map(|d| if d < LEAST { 0.0 } else { d });
        let linear = d[..3].iter().any(|d| *d > 0.0);
        let rotary = d[3..].iter().any(|d| *d > 0.0);
        let own = if linear { &d[..3] } else { &d[3..] };
        let length = own.iter().map(|d| d * d).sum::<f64>().sqrt();
        let velocity = |k: usize| if k < 3 { l.velocity_mm_s[k] } else { l.velocity_deg_s[k - 3] };
        let acceleration =
            |k: usize| if k < 3 { l.acceleration_mm_s2[k] } else { l.acceleration_deg_s2[k - 3] };
        let (mut slowest, mut t, mut ta) = (0, 0.0, 0.0f64);
        for (k, d) in d.iter().enumerate() {
            if d / velocity(k) > t {
                (slowest, t) = (k, d / velocity(k));
            }
            ta = ta.max(d / acceleration(k));
        }
        Bounds { length, velocity: length / t, acceleration: length / ta, slowest, linear, rotary }
    }

    /// The middle of an arc that is flatter than the tolerance of joining.
    fn flat_arc(&self, m: &CanonMove, arc: &CanonArc) -> Option<Vec3> {
        let PathControl::Blend { join_mm, .. } = self.control else { return None };
        let from = self.joined.last().copied().unwrap_or(Vec3::from(self.at.0));
        let spoke = [0, 1].map(|k| from[arc.plane[k]] - arc.centre_mm[k]);
        let radius = spoke[0].hypot(spoke[1]);
        let half = 0.5 * arc.sweep_rad;
        if arc.plane != [0, 1] || radius * (1.0 - half.cos()) >= join_mm || m.rotary_deg != self.at.1 {
            return None;
        }
        let mut middle = (from + Vec3::from(m.xyz_mm)) * 0.5;
        let (s, c) = half.sin_cos();
        middle[0] = arc.centre_mm[0] + spoke[0] * c - spoke[1] * s;
        middle[1] = arc.centre_mm[1] + spoke[0] * s + spoke[1] * c;
        Some(middle)
    }

    fn arc(&mut self, m: &CanonMove, arc: &CanonArc) {
        let l = self.limits;
        let from = Vec3::from(self.at.0);
        let to = Vec3::from(m.xyz_mm);
        let [p, q] = arc.plane;
        let third = 3 - p - q;
        let spoke = [from[p] - arc.centre_mm[0], from[q] - arc.centre_mm[1]];
        let radius = spoke[0].hypot(spoke[1]);
        let rise = to[third] - from[third];
        let round = radius * arc.sweep_rad.abs();
        let length = round.hypot(rise);
        let mut b = self.bounds(m);
        let (a, v) = (
            l.acceleration_mm_s2[p].min(l.acceleration_mm_s2[q]),
            l.velocity_mm_s[p].min(l.velocity_mm_s[q]),
        );
        let v = v.min((NORMAL_SHARE * a * radius).sqrt());
        let straight_s = if b.velocity.is_finite() && b.velocity > 0.0 { b.length / b.velocity } else { 0.0 };
        let straight_s2 =
            if b.acceleration.is_finite() && b.acceleration > 0.0 { b.length / b.acceleration } else { 0.0 };
        b.velocity = length / straight_s.max(round / v);
        b.acceleration = length / straight_s2.max(round / a);
        b.length = length;
        b.linear = true;
        self.at = (m.xyz_mm, m.rotary_deg);
        if length <= LEAST {
            return;
        }
        let tangent = |angle: f64| {
            let (s, c) = angle.sin_cos();
            let turn = arc.sweep_rad;
            let mut t = Vec3::zeros();
            t[p] = -(spoke[0] * s + spoke[1] * c) * turn;
            t[q] = (spoke[0] * c - spoke[1] * s) * turn;
            t[third] = rise;
            t / length
        };
        let ends = (tangent(0.0), tangent(arc.sweep_rad));
        let slope = rise / arc.sweep_rad;
        let mut normal = Vec3::zeros();
        normal[third] = 1.0;
        let shape = Shape::Circle { radius_mm: radius + slope * slope / radius, normal };
        let wanted = self.wanted(&b, Some(m.feed));
        let of = self.count - 1;
        let segment = Segment { of, ..self.segment(m, (shape, ends.0, ends.1), &b, wanted) };
        self.planner.add(segment);
    }
}
