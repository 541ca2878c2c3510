//! Moves between passes: steps on the surface, hops and retracts.
//!
//! A retract leaves along the tool's own axis until the tip is above the plane that touches the part's bounding
//! sphere (grown by the clearance) on the side the axis points to; there nothing of the part can meet the tool,
//! whose body lies beyond the tip. From the pole of that plane the axis swings over the sphere, always pointing
//! outward, to the pole of the next pass and down again. Passes that begin near the end of the one before are
//! joined by a hop instead: up along the normal, across, and down.

use super::{CcPoint, Pass};
use osculate_geom::{Box3, Point3, Unit3, Vec3};
use osculate_tools::Pose;
use osculate_tools::cl::{ClMove, ClPath, Motion};

/// How passes are linked. Lengths mm, feeds mm/min.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Links {
    /// Box of everything the tool must stay clear of on rapid moves.
    pub obstacles: Box3,
    /// Clearance above the sphere around the obstacles.
    pub clearance_mm: f64,
    /// Distance from the surface at which a rapid approach changes to feed.
    pub approach_mm: f64,
    /// Outer radius of the cutter.
    pub cutter_radius_mm: f64,
    /// Feed of the tip on the part.
    pub feed_mm_min: f64,
    /// Feed on approaches.
    pub plunge_mm_min: f64,
}

/// A linked path with the share of cutting in it.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Linked {
    /// The whole path.
    pub path: ClPath,
    /// For each move, the pass that it cuts; None for links.
    pub pass_of_move: Vec<Option<u32>>,
    /// Length of cutting moves along the tip, mm.
    pub cutting_length_mm: f64,
    /// Length of all other moves along the tip, mm.
    pub air_length_mm: f64,
}

/// Swing of the axis in one piece of a rapid over the sphere, rad.
const SWING_STEP: f64 = 0.1;
/// Largest swing in a hop, rad: about a lead of 25 degrees turned over.
const HOP_SWING: f64 = 0.9;

struct Builder<'a> {
    links: &'a Links,
    out: Linked,
    centre: Point3,
    radius: f64,
}

impl Linked {
    /// Adds a move, unless it leads nowhere.
    pub(super) fn go(&mut self, pose: Pose, motion: Motion, pass: Option<u32>) {
        if let Some(last) = self.path.moves.last() {
            let length = (pose.tip - last.pose.tip).norm();
            if length == 0.0 && pose.axis == last.pose.axis {
                return;
            }
            if pass.is_some() {
                self.cutting_length_mm += length;
            } else {
                self.air_length_mm += length;
            }
        }
        self.path.moves.push(ClMove { pose, motion });
        self.pass_of_move.push(pass);
    }
}

impl Builder<'_> {
    fn go(&mut self, pose: Pose, motion: Motion, pass: Option<u32>) {
        self.out.go(pose, motion, pass);
    }

    /// The pose on the axis of `pose` whose tip is on the safe plane, never below `pose` itself.
    fn above(&self, pose: &Pose) -> Pose {
        let height = (pose.tip - self.centre).dot(&pose.axis);
        pose.retracted((self.radius - height).max(self.links.approach_mm))
    }

    fn pole(&self, axis: &Unit3) -> Pose {
        Pose { tip: self.centre + axis.into_inner() * self.radius, axis: *axis }
    }

    fn retract(&mut self, from: &Pose) {
        self.go(from.retracted(self.links.approach_mm), Motion::Feed(self.links.feed_mm_min), None);
        self.go(self.above(from), Motion::Rapid, None);
    }

    fn travel(&mut self, from: &Unit3, to: &Unit3) {
        let angle = from.angle(to);
        let steps = (angle / SWING_STEP).ceil() as usize;
        if steps == 0 {
            return;
        }
        self.go(self.pole(from), Motion::Rapid, None);
        // Antipodal axes have no single arc between them: any perpendicular serves.
        let side = {
            let s = to.into_inner() - from.into_inner() * to.dot(from);
            Unit3::try_new(s, 1e-9).unwrap_or_else(|| osculate_geom::any_perpendicular(from))
        };
        for k in 1..=steps {
            let (s, c) = (angle * k as f64 / steps as f64).sin_cos();
            let axis = if k == steps {
                *to
            } else {
                Unit3::new_normalize(from.into_inner() * c + side.into_inner() * s)
            };
            self.go(self.pole(&axis), Motion::Rapid, None);
        }
    }

    fn approach(&mut self, to: &Pose) {
        self.go(self.above(to), Motion::Rapid, None);
        self.go(to.retracted(self.links.approach_mm), Motion::Rapid, None);
        self.go(*to, Motion::Feed(self.links.plunge_mm_min), None);
    }

    fn hop(&mut self, from: &CcPoint, to: &CcPoint) {
        let lift = |p: &CcPoint| Pose {
            tip: p.pose.tip + p.normal.into_inner() * self.links.approach_mm,
            axis: p.pose.axis,
        };
        let (up, over) = (lift(from), lift(to));
        let feed = Motion::Feed(self.links.feed_mm_min);
        self.go(up, feed, None);
        self.go(over, feed, None);
        self.go(to.pose, Motion::Feed(self.links.plunge_mm_min), None);
    }
}

/// Whether the tool may hop from the end of one pass to the beginning of the next.
fn near(links: &Links, from: &CcPoint, to: &CcPoint) -> bool {
    let reach = 1.5 * links.cutter_radius_mm;
    let step: Vec3 = to.point - from.point;
    // Neither end may lie far off the other's tangent plane: the hop rises by the approach distance only.
    let sink = step.dot(&from.normal).abs().max(step.dot(&to.normal).abs());
    step.norm() <= reach
        && sink <= 0.25 * links.approach_mm
        && from.normal.angle(&to.normal) <= 0.35
        && from.pose.axis.angle(&to.pose.axis) <= HOP_SWING
}

/// Joins passes in their order.
#[must_use]
pub fn link(passes: &[Pass], links: &Links) -> Linked {
    let centre = links.obstacles.centre();
    let radius = 0.5 * links.obstacles.diagonal_mm() + links.clearance_mm;
    let mut b = Builder { links, out: Linked::default(), centre, radius };
    let mut last: Option<CcPoint> = None;
    for (k, pass) in passes.iter().enumerate() {
        let (Some(first), Some(end)) = (pass.points.first(), pass.points.last()) else { continue };
        match &last {
            None => {
                b.go(b.pole(&first.pose.axis), Motion::Rapid, None);
                b.approach(&first.pose);
            }
            Some(from) if near(links, from, first) => b.hop(from, first),
            Some(from) => {
                b.retract(&from.pose);
                b.travel(&from.pose.axis, &first.pose.axis);
                b.approach(&first.pose);
            }
        }
        for p in &pass.points[1..] {
            b.go(p.pose, Motion::Feed(links.feed_mm_min), Some(k as u32));
        }
        last = Some(*end);
    }
    if let Some(end) = &last {
        b.retract(&end.pose);
        b.go(b.pole(&end.pose.axis), Motion::Rapid, None);
    }
    b.out
}
