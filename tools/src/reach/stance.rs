//! One axis at a place: where points stand against the axis of the tool.

use super::obstacles::Ball;
use super::problem::{Place, Reach, Solid};
use crate::contact::pose_with_axis;
use crate::cutter::Cutter;
use crate::pose::Pose;
use osculate_geom::{Point3, Unit3, Vec3};

/// A tool that touches a place with one axis.
pub(super) struct Stance {
    pose: Pose,
    rounding_mm: f64,
}

impl Stance {
    pub fn new(reach: &Reach<'_>, place: &Place, axis: &Unit3) -> Self {
        let pose = pose_with_axis(&reach.solids[0].shape, &place.point, &place.normal, axis);
        Self { pose, rounding_mm: reach.rounding_mm(place) }
    }

    /// Distance from the axis and height above the tip, mm.
    fn local(&self, p: &Point3) -> (f64, f64) {
        let (across, z) = self.apart(p);
        (across.norm(), z)
    }

    /// The way from the axis, and the height above the tip, mm.
    fn apart(&self, p: &Point3) -> (Vec3, f64) {
        let w = p - self.pose.tip;
        let z = w.dot(&self.pose.axis);
        (w - self.pose.axis.into_inner() * z, z)
    }

    /// The least distance of a body from any point of a ball that lies in its slab, mm: the distance to a convex body is nowhere
    /// below its tangent at the centre. None where the body or the ball has none.
    fn least_mm(&self, reach: &Reach<'_>, solid: &Solid, ball: &Ball) -> Option<f64> {
        let slab = reach.obstacles.slab(ball)?;
        let (across, z) = self.apart(&ball.centre);
        let rho = across.norm();
        let [by_rho, by_z] = slope(&solid.shape, rho, z - solid.base_mm)?;
        let out = if rho > 0.0 { across / rho } else { across };
        let slope = out * by_rho + self.pose.axis.into_inner() * by_z;
        let at = solid.shape.local_endless_distance(rho, z - solid.base_mm);
        Some(at + slab.least_mm(&slope, ball.radius_mm))
    }

    /// The first ball found that no axis of this stance may have, from one on; `members` are the bits of the solids that are
    /// to be looked at.
    pub fn blocker(
        &self,
        reach: &Reach<'_>,
        from: u32,
        members: u32,
        stack: &mut Vec<[u32; 2]>,
    ) -> Option<u32> {
        let balls = reach.obstacles.balls();
        let kind = reach.obstacles.kind(from);
        stack.clear();
        stack.push([from, members]);
        while let Some([at, members]) = stack.pop() {
            let ball = &balls[at as usize];
            let (rho, z) = self.local(&ball.centre);
            let (mut open, mut left) = (0, members);
            while left != 0 {
                let k = left.trailing_zeros();
                left &= left - 1;
                let solid = &reach.solids[k as usize];
                let spare = solid.shape.local_distance(rho, z - solid.base_mm) - solid.limit_mm(kind);
                if ball.second == 0 {
                    // A distance that is none is not clear.
                    if !spare.ge(&0.0) {
                        return Some(at);
                    }
                } else {
                    let around = ball.radius_mm + self.rounding_mm;
                    if spare + around < 0.0 {
                        return Some(at);
                    }
                    let is_clear = spare >= around
                        || self
                            .least_mm(reach, solid, ball)
                            .is_some_and(|least| least >= solid.limit_mm(kind) + self.rounding_mm);
                    if !is_clear {
                        open |= 1 << k;
                    }
                }
            }
            if open != 0 {
                stack.push([ball.second, open]);
                stack.push([at + 1, open]);
            }
        }
        None
    }

    /// Of all points that do not keep their limits the one that lies lowest along the axis, as a ball of its own, with the solid that it
    /// comes nearest to; of several equally low ones any, always the same. None where all keep them.
    pub fn lowest(&self, reach: &Reach<'_>) -> Option<(u32, usize)> {
        let balls = reach.obstacles.balls();
        let mut best: Option<(f64, u32, usize)> = None;
        let mut stack: Vec<u32> = reach.obstacles.roots().collect();
        while let Some(at) = stack.pop() {
            let ball = &balls[at as usize];
            let (spare, solid) = self.spare(reach, at, ball);
            let (_, z) = self.local(&ball.centre);
            if ball.second == 0 {
                // A distance that is none is not clear.
                if !spare.ge(&0.0) && best.is_none_or(|(low, ..)| z < low) {
                    best = Some((z, at, solid));
                }
                continue;
            }
            let around = ball.radius_mm + self.rounding_mm;
            if spare >= around || best.is_some_and(|(low, ..)| z - around >= low) {
                continue;
            }
            let height = |k: u32| self.local(&balls[k as usize].centre).1;
            let halves = [at + 1, ball.second];
            // The lower half comes from the stack first.
            stack.extend(if height(halves[0]) <= height(halves[1]) {
                [halves[1], halves[0]]
            } else {
                halves
            });
        }
        best.map(|(_, ball, solid)| (ball, solid))
    }

    /// The least spare of the centre of a ball, with the solid that has it.
    pub fn spare(&self, reach: &Reach<'_>, at: u32, ball: &Ball) -> (f64, usize) {
        let kind = reach.obstacles.kind(at);
        let (rho, z) = self.local(&ball.centre);
        let spares =
            reach.solids.iter().enumerate().map(|(k, solid)| {
                (solid.shape.local_distance(rho, z - solid.base_mm) - solid.limit_mm(kind), k)
            });
        spares.fold((f64::INFINITY, 0), |best, own| if own.0 < best.0 { own } else { best })
    }

    /// What computed distances may be wrong by, mm.
    pub const fn rounding_mm(&self) -> f64 {
        self.rounding_mm
    }
}

/// The slope of a cutter's distance by the distance from its axis and the height, a unit vector; None for shapes that need not be convex.
fn slope(cutter: &Cutter, rho_mm: f64, z_mm: f64) -> Option<[f64; 2]> {
    if !cutter.is_end_mill() {
        return None;
    }
    let (x, y) = (rho_mm - cutter.core_mm(), cutter.corner_mm() - z_mm);
    Some(if x > 0.0 && y > 0.0 {
        let length = (x * x + y * y).sqrt();
        [x / length, -y / length]
    } else if x > y {
        [1.0, 0.0]
    } else {
        [0.0, -1.0]
    })
}
