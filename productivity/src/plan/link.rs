//! Moves between passes: steps on the surface, hops and retracts.
//!
//! A retract leaves along the tool's own axis until the tip is above the plane that touches the part's bounding
//! sphere (grown by the clearance) on the side the axis points to; there nothing of the part can meet the tool,
//! whose body lies beyond the tip. From the pole of that plane the axis swings over the sphere, always pointing
//! outward, to the pole of the next pass and down again. Passes that begin near the end of the one before are
//! joined by a hop instead: up along the normal, across, and down; where the tool would meet another wall of the part on
//! that way, up and down along its axis; where it would there too, by a retract.

use super::around::Cloud;
use super::{CcPoint, Pass};
use osculate_geom::{Box3, Point3, Unit3, Vec3};
use osculate_tools::cl::{ClMove, ClPath, Motion};
use osculate_tools::sweep::{LinearMotion, SweptMotion};
use osculate_tools::{Cutter, Pose};

/// How passes are linked. Lengths mm, feeds mm/min.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Links {
    /// Box of everything the tool must stay clear of on rapid moves.
    pub obstacles: Box3,
    /// Clearance above the sphere around the obstacles.
    pub clearance_mm: f64,
    /// Distance from the surface at which a rapid approach changes to feed.
    pub approach_mm: f64,
    /// The cutter.
    pub cutter: Cutter,
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
/// Distance of the points along passes that stand for the part in a hop, in radii of the cutter.
const NEAR_POINTS: f64 = 0.25;
/// The tool may lie by this part of its radius deeper in the points on its way than at the contacts: chords between points
/// of a bent pass, and rounding.
const SLACK: f64 = 1e-4;
/// Poses of one piece of a hop at which the tool is held against the part.
const LOOKS: u32 = 6;

struct Builder<'a> {
    links: &'a Links,
    cloud: Cloud,
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

    /// The poses above both ends of a hop on a way that is clear of the part, if there is one.
    fn hop_over(&self, from: &CcPoint, to: &CcPoint) -> Option<[Pose; 2]> {
        let height = self.links.approach_mm;
        let lift = |p: &CcPoint| Pose { tip: p.pose.tip + p.normal.into_inner() * height, axis: p.pose.axis };
        let cutter = &self.links.cutter;
        // What the tool is into the points of the contacts' own neighbourhood is no obstacle.
        let limit = [from, to].iter().map(|p| self.cloud.depth_mm(cutter, &p.pose)).fold(0.0, f64::max)
            + SLACK * cutter.radius_mm();
        let clear = |[up, over]: &[Pose; 2]| {
            [(from.pose, *up), (*up, *over), (to.pose, *over)].iter().all(|(a, b)| {
                let motion = LinearMotion { from: *a, to: *b };
                (1..=LOOKS).all(|k| {
                    let now = motion.at(f64::from(k) / f64::from(LOOKS));
                    now.is_some_and(|now| self.cloud.depth_mm(cutter, &now.pose) <= limit)
                })
            })
        };
        let along_axes = [from, to].map(|p| p.pose.retracted(height));
        [[lift(from), lift(to)], along_axes].into_iter().find(clear)
    }

    fn hop(&mut self, [up, over]: [Pose; 2], to: &CcPoint) {
        let feed = Motion::Feed(self.links.feed_mm_min);
        self.go(up, feed, None);
        self.go(over, feed, None);
        self.go(to.pose, Motion::Feed(self.links.plunge_mm_min), None);
    }

    /// Leads from the end of a pass to the beginning of the next.
    fn join(&mut self, from: &CcPoint, to: &CcPoint) {
        let over = near(self.links, from, to).then(|| self.hop_over(from, to)).flatten();
        if let Some(over) = over {
            self.hop(over, to);
            return;
        }
        self.retract(&from.pose);
        self.travel(&from.pose.axis, &to.pose.axis);
        self.approach(&to.pose);
    }
}

/// Whether the tool may hop from the end of one pass to the beginning of the next.
fn near(links: &Links, from: &CcPoint, to: &CcPoint) -> bool {
    let reach = 1.5 * links.cutter.radius_mm();
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
    let cloud = Cloud::of(passes, NEAR_POINTS * links.cutter.radius_mm());
    let mut b = Builder { links, cloud, out: Linked::default(), centre, radius };
    let mut last: Option<CcPoint> = None;
    for (k, pass) in passes.iter().enumerate() {
        let (Some(first), Some(end)) = (pass.points.first(), pass.points.last()) else { continue };
        match &last {
            None => {
                b.go(b.pole(&first.pose.axis), Motion::Rapid, None);
                b.approach(&first.pose);
            }
            Some(from) => b.join(from, first),
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

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use osculate_geom::uv;
    use osculate_tools::CutterSpec;

    const TROUGH_MM: f64 = 4.0;
    const BALL_MM: f64 = 3.0;

    /// A pass along y on the wall of a half round trough about the y axis, `angle` from its bottom; the ball stands upright.
    fn pass(angle: f64, back: bool) -> Pass {
        let normal = Unit3::new_normalize(Vec3::new(-angle.sin(), 0.0, angle.cos()));
        let at = |k: u32| {
            let y = if back { f64::from(8 - k) } else { f64::from(k) };
            let point = Point3::new(0.0, y, 0.0) - normal.into_inner() * TROUGH_MM;
            let tip = point + (normal.into_inner() - Vec3::z()) * BALL_MM;
            let pose = Pose { tip, axis: Vec3::z_axis() };
            CcPoint { uv: uv(angle, y), point, normal, pose, width_mm: 1.0 }
        };
        Pass { points: (0..=8).map(at).collect(), closed: false }
    }

    #[test]
    fn a_hop_does_not_go_into_the_wall_across() {
        let cutter =
            Cutter::try_from(CutterSpec::Ball { diameter_mm: 2.0 * BALL_MM, length_mm: 30.0 }).unwrap();
        let obstacles = Box3 { min: Point3::new(-4.0, 0.0, -4.0), max: Point3::new(4.0, 8.0, 0.0) };
        // Twice what there is room for between ball and wall.
        let links = Links {
            obstacles,
            clearance_mm: 5.0,
            approach_mm: 4.0 * (TROUGH_MM - BALL_MM),
            cutter,
            feed_mm_min: 1000.0,
            plunge_mm_min: 500.0,
        };
        let passes: Vec<Pass> =
            (-18..=18).map(|k| pass(f64::from(k) * 5.0f64.to_radians(), k % 2 == 0)).collect();
        let linked = link(&passes, &links);
        for w in linked.path.moves.windows(2) {
            let motion = LinearMotion { from: w[0].pose, to: w[1].pose };
            for k in 0..=20 {
                let centre = motion.at(f64::from(k) / 20.0).unwrap().pose.tip + Vec3::z() * BALL_MM;
                // Below the rim the wall is as far off the axis everywhere, above it the rim is nearest.
                let gap = if centre.z < 0.0 {
                    TROUGH_MM - centre.x.hypot(centre.z)
                } else {
                    (TROUGH_MM - centre.x.abs()).hypot(centre.z)
                };
                assert!(gap >= BALL_MM - 1e-9, "{centre}");
            }
        }
        // All the same passes are joined by hops: nothing goes up to the sphere but at both ends.
        let rapid = linked.path.moves.iter().filter(|m| m.motion == Motion::Rapid).count();
        assert_eq!(rapid, 5);
    }
}
