//! Moves between passes: steps on the surface, hops and retracts.
//!
//! A retract leaves along the tool's own axis until the tip is above the plane that touches the part's bounding
//! sphere (grown by the clearance) on the side the axis points to; there nothing of the part can meet the tool,
//! whose body lies beyond the tip. From the pole of that plane the axis swings over the sphere, always pointing
//! outward, to the pole of the next pass and down again. Passes that begin near the end of the one before are
//! joined by a hop instead: up along the normal, across, and down, as low as keeps cutter and holder off other walls of the part
//! on that way, and far enough from faces that are not machined; where the highest does not, up and down along the axis; where
//! that does not either, by a retract.

use super::around::Cloud;
use super::walls::Walls;
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
    /// The least lift of a hop; one that is not clear is doubled until it is, up to `approach_mm`.
    pub hop_mm: f64,
    /// The cutter.
    pub cutter: Cutter,
    /// The holder, a body whose lower end sits where the cutter's length ends.
    pub holder: Option<Cutter>,
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
/// Share of its lift that a low hop may lose and be clear still: the part is known at points only.
const SPARE: f64 = 0.5;
/// Poses of one piece of a hop at which the tool is held against the part.
const LOOKS: u32 = 6;

struct Builder<'a> {
    links: &'a Links,
    walls: &'a Walls,
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
        let lift =
            |p: &CcPoint, mm: f64| Pose { tip: p.pose.tip + p.normal.into_inner() * mm, axis: p.pose.axis };
        let ends = [from.pose, to.pose];
        let slack_mm = SLACK * self.links.cutter.radius_mm();
        let cutter = (&self.links.cutter, 0.0);
        let holder = self.links.holder.as_ref().map(|h| (h, self.links.cutter.length_mm()));
        // Of each body how far above the tip it sits, and how deep it is in at the ends: what the tool is into the points of
        // the contacts' own neighbourhood is no obstacle.
        let bodies = [Some(cutter), holder].into_iter().flatten().map(|(body, up_mm)| {
            let ends = ends.map(|p| p.retracted(up_mm));
            let limit = ends.iter().map(|p| self.cloud.depth_mm(body, p)).fold(0.0, f64::max) + slack_mm;
            (body, up_mm, ends, limit)
        });
        let bodies: Vec<_> = bodies.collect();
        let is_clear = |pose: &Pose| {
            bodies.iter().all(|(body, up_mm, ends, limit)| {
                let pose = pose.retracted(*up_mm);
                self.cloud.depth_mm(body, &pose) <= *limit
                    && self.walls.cleared_by(body, &pose, ends, slack_mm)
            })
        };
        let clear = |[up, over]: &[Pose; 2]| {
            [(from.pose, *up), (*up, *over), (to.pose, *over)].iter().all(|(a, b)| {
                let motion = LinearMotion { from: *a, to: *b };
                (1..=LOOKS).all(|k| {
                    let now = motion.at(f64::from(k) / f64::from(LOOKS));
                    now.is_some_and(|now| is_clear(&now.pose))
                })
            })
        };
        let highest = self.links.approach_mm;
        let lifted = |mm: f64| [lift(from, mm), lift(to, mm)];
        let mut low = self.links.hop_mm.min(highest);
        while low > 0.0 && low < highest {
            let hop = lifted(low);
            if clear(&hop) && clear(&lifted((1.0 - SPARE) * low)) {
                return Some(hop);
            }
            low *= 2.0;
        }
        let along_axes = [from, to].map(|p| p.pose.retracted(highest));
        [lifted(highest), along_axes].into_iter().find(clear)
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

/// Joins passes in their order, by hops that keep off `walls`.
#[must_use]
pub fn link(passes: &[Pass], links: &Links, walls: &Walls) -> Linked {
    let centre = links.obstacles.centre();
    let radius = 0.5 * links.obstacles.diagonal_mm() + links.clearance_mm;
    let cloud = Cloud::of(passes, NEAR_POINTS * links.cutter.radius_mm());
    let mut b = Builder { links, walls, cloud, out: Linked::default(), centre, radius };
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
    use crate::plan::Named;
    use osculate_geom::analytic::Line;
    use osculate_geom::{Extruded, Interval, uv};
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
            hop_mm: 4.0 * (TROUGH_MM - BALL_MM),
            cutter,
            holder: None,
            feed_mm_min: 1000.0,
            plunge_mm_min: 500.0,
        };
        let passes: Vec<Pass> =
            (-18..=18).map(|k| pass(f64::from(k) * 5.0f64.to_radians(), k % 2 == 0)).collect();
        let linked = link(&passes, &links, &Walls::default());
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

    /// Passes along y, `apart` from each other, over the plane z = 0 with a ball that stands upright.
    fn over_plane(apart: f64, radius: f64) -> Vec<Pass> {
        let one = |x: f64, back: bool| {
            let at = |k: u32| {
                let y = if back { f64::from(8 - k) } else { f64::from(k) };
                let point = Point3::new(x, y, 0.0);
                let pose = Pose { tip: point, axis: Vec3::z_axis() };
                CcPoint { uv: uv(x, y), point, normal: Vec3::z_axis(), pose, width_mm: radius }
            };
            Pass { points: (0..=8).map(at).collect(), closed: false }
        };
        (0..3).map(|k| one((f64::from(k) - 0.5) * apart, k % 2 == 1)).collect()
    }

    #[test]
    fn a_hop_rises_by_no_more_than_is_clear() {
        let cutter = Cutter::try_from(CutterSpec::Ball { diameter_mm: 6.0, length_mm: 30.0 }).unwrap();
        let links = |hop_mm: f64| Links {
            obstacles: Box3 { min: Point3::new(-5.0, 0.0, 0.0), max: Point3::new(14.0, 8.0, 1.5) },
            clearance_mm: 5.0,
            approach_mm: 2.0,
            hop_mm,
            cutter,
            holder: None,
            feed_mm_min: 1000.0,
            plunge_mm_min: 500.0,
        };
        let top = |linked: &Linked| {
            let hops = linked.path.moves.iter().zip(&linked.pass_of_move).skip(3);
            let hops = hops.filter(|(m, pass)| pass.is_none() && m.motion != Motion::Rapid);
            // The last one is the retract.
            let heights: Vec<f64> = hops.map(|(m, _)| m.pose.tip.z).collect();
            heights[..heights.len() - 1].iter().copied().fold(0.0, f64::max)
        };
        let flat = over_plane(4.0, 3.0);
        let low = link(&flat, &links(0.125), &Walls::default());
        let high = link(&flat, &links(2.0), &Walls::default());
        assert_eq!([top(&low), top(&high)], [0.125, 2.0]);
        // Two hops, up and down by so much less each.
        assert!((high.air_length_mm - low.air_length_mm - 4.0 * 1.875).abs() < 1e-12);
        // A rib along the middle of the first hop, machined by a later pass: half of the lift must be spare.
        for (rib, lift) in [(0.1, 0.25), (0.2, 0.5), (0.4, 1.0), (0.7, 2.0)] {
            let mut passes = over_plane(4.0, 3.0);
            for p in &mut passes[2].points {
                p.point = Point3::new(0.0, p.point.y, rib);
            }
            let linked = link(&passes[..3], &links(0.125), &Walls::default());
            assert_eq!(top(&linked), lift, "{rib}");
        }
    }

    #[test]
    fn a_hop_keeps_off_a_wall_that_is_not_machined() {
        const RADIUS: f64 = 6.0;
        const APART: f64 = 8.8;
        let passes = over_plane(APART, RADIUS);
        let links = Links {
            obstacles: Box3 { min: Point3::new(-5.0, 0.0, 0.0), max: Point3::new(14.0, 8.0, 1.5) },
            clearance_mm: 5.0,
            approach_mm: 1.2,
            hop_mm: 1.2,
            cutter: Cutter::try_from(CutterSpec::Ball { diameter_mm: 2.0 * RADIUS, length_mm: 30.0 })
                .unwrap(),
            holder: None,
            feed_mm_min: 1000.0,
            plunge_mm_min: 500.0,
        };
        // A thin wall on the plane x = 0, between the first two passes.
        let joined = |height: f64, clearance: f64| {
            let foot = Line::new(Point3::origin(), Vec3::y(), Interval::new(-2.0, 10.0)).unwrap();
            let wall = Extruded::new(foot, Vec3::z(), Interval::new(0.0, height)).unwrap();
            let named = Named { face: "wall", surface: &wall };
            link(&passes, &links, &Walls::of(&[named], clearance).unwrap())
        };
        // How far the ball's surface is off the wall at the nearest, in the closed form.
        let gap = |linked: &Linked, height: f64| {
            let motions = linked.path.moves.windows(2);
            let motions = motions.map(|w| LinearMotion { from: w[0].pose, to: w[1].pose });
            let at = motions.flat_map(|m| (0..=40).map(move |k| m.at(f64::from(k) / 40.0).unwrap().pose.tip));
            at.map(|tip| {
                let c = tip + Vec3::z() * RADIUS;
                let nearest = Point3::new(0.0, c.y.clamp(-2.0, 10.0), c.z.clamp(0.0, height));
                (c - nearest).norm() - RADIUS
            })
            .fold(f64::INFINITY, f64::min)
        };
        let rapid = |linked: &Linked| linked.path.moves.iter().filter(|m| m.motion == Motion::Rapid).count();
        let hops = link(&passes, &links, &Walls::default());
        // A wall higher than the hop: a hop that does not see it goes into it, one that does is none. The hop from the second
        // pass to the third stays.
        assert!(gap(&hops, 1.5) < -0.29, "{}", gap(&hops, 1.5));
        let seen = joined(1.5, 0.5);
        let at_passes = (0.5 * APART).hypot(RADIUS - 1.5) - RADIUS;
        assert!(gap(&seen, 1.5) >= at_passes - 1e-9 && rapid(&seen) > rapid(&hops), "{}", gap(&seen, 1.5));
        assert_eq!(
            seen.path.moves.iter().rev().take(20).collect::<Vec<_>>(),
            hops.path.moves.iter().rev().take(20).collect::<Vec<_>>()
        );
        // One that leaves 0.3 mm is passed over with a clearance of 0.2, not of 0.5.
        assert_eq!(joined(0.9, 0.2), hops);
        assert!((gap(&hops, 0.9) - 0.3).abs() < 1e-9);
        assert_eq!(rapid(&joined(0.9, 0.5)), rapid(&seen));
    }

    #[test]
    fn a_holder_keeps_off_a_wall_too() {
        let passes = over_plane(6.0, 4.0);
        let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 8.0, length_mm: 10.0 }).unwrap();
        let with = |holder: Option<Cutter>| Links {
            obstacles: Box3 { min: Point3::new(-3.0, 0.0, 0.0), max: Point3::new(9.0, 12.2, 20.0) },
            clearance_mm: 5.0,
            approach_mm: 1.2,
            hop_mm: 1.2,
            cutter: ball,
            holder,
            feed_mm_min: 1000.0,
            plunge_mm_min: 500.0,
        };
        // A post above the cutter's length, behind the middle between the ends of the first two passes: 5.05 mm off their axes, and
        // 4.2 mm off that of a tool half way between.
        let foot = Line::new(Point3::new(0.0, 12.2, 12.0), Vec3::x(), Interval::new(-0.2, 0.2)).unwrap();
        let post = Extruded::new(foot, Vec3::z(), Interval::new(0.0, 8.0)).unwrap();
        let walls = Walls::of(&[Named { face: "post", surface: &post }], 0.5).unwrap();
        let without = link(&passes, &with(None), &walls);
        assert_eq!(without, link(&passes, &with(None), &Walls::default()));
        let holder = Some(Cutter::cylinder(9.0, 30.0).unwrap());
        assert_eq!(link(&passes, &with(holder), &Walls::default()), without);
        assert_ne!(link(&passes, &with(holder), &walls), without);
    }
}
