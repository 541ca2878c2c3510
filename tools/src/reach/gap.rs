//! How far one pose is from what it must keep out of.
//!
//! The spare of a pose is the least, over bodies of the tool and obstacle points, of the distance less the limit: positive
//! where the pose is clear. It is continuous in place and axis, but where a flat or toroidal end stands upright and where
//! the contact of a cone passes from one part of it to the next.

use super::obstacles::ObstaclePoint;
use super::problem::{Place, Reach};
use super::stance::Stance;
use super::tool::Member;
use osculate_geom::Unit3;

/// What is nearest to a pose, measured from its limit.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Met {
    /// The point.
    pub obstacle: ObstaclePoint,
    /// The body of the tool that it stands against.
    pub member: Member,
}

/// How far a pose is from its limits.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Gap {
    /// The least distance less its limit, mm: negative where the pose is not clear, infinite without obstacles. Above the
    /// upper end of a body distances are lower bounds, see [`crate::Cutter::local_distance`].
    pub spare_mm: f64,
    /// What has it; None without obstacles.
    pub met: Option<Met>,
}

/// Places for the balls that wait: the tree halves its points, so that one place for each bit of their number is enough.
const WAITING: usize = 64;

impl Reach<'_> {
    /// The gap of the tool that touches a place with an axis, any unit vector: limits of the lean and what the machine
    /// allows are not looked at.
    #[must_use]
    pub fn gap(&self, place: &Place, axis: &Unit3) -> Gap {
        let (spare_mm, found) = self.least_spare(place, axis, None);
        Gap { spare_mm, met: found.map(|found| self.met(found)) }
    }

    /// The point of a ball of one, and a solid.
    pub(super) fn met(&self, (ball, solid): (u32, usize)) -> Met {
        let first = self.obstacles.balls()[ball as usize].first;
        Met { obstacle: self.obstacles.points()[first as usize], member: self.solids[solid].member }
    }

    /// Whether an axis is possible at a place: its lean is within the limits and all points keep theirs.
    #[must_use]
    pub fn is_clear(&self, place: &Place, axis: &Unit3) -> bool {
        let all = u32::MAX >> (32 - self.solids.len());
        let stance = Stance::new(self, place, axis);
        let mut stack = Vec::with_capacity(WAITING);
        self.leans_within_limits(place, axis)
            && self.obstacles.roots().all(|root| stance.blocker(self, root, all, &mut stack).is_none())
    }

    /// The least spare, with the ball of one point and the solid that have it. The point of `guess` is looked at first: the
    /// smaller its spare, the sooner the others are done with.
    pub(super) fn least_spare(
        &self,
        place: &Place,
        axis: &Unit3,
        guess: Option<u32>,
    ) -> (f64, Option<(u32, usize)>) {
        let stance = Stance::new(self, place, axis);
        let balls = self.obstacles.balls();
        let mut best = guess.map_or((f64::INFINITY, None), |at| {
            let (spare, solid) = stance.spare(self, at, &balls[at as usize]);
            (spare, Some((at, solid)))
        });
        for root in self.obstacles.roots() {
            let mut stack = [(0.0, 0u32); WAITING];
            let mut waiting = 1;
            stack[0] = (f64::NEG_INFINITY, root);
            while waiting > 0 {
                waiting -= 1;
                let (bound, at) = stack[waiting];
                if bound >= best.0 {
                    continue;
                }
                let ball = &balls[at as usize];
                if ball.second == 0 {
                    let (spare, solid) = stance.spare(self, at, ball);
                    if spare < best.0 {
                        best = (spare, Some((at, solid)));
                    }
                    continue;
                }
                let of = |k: u32| {
                    let ball = &balls[k as usize];
                    (stance.spare(self, k, ball).0 - ball.radius_mm - stance.rounding_mm(), k)
                };
                let (a, b) = (of(at + 1), of(ball.second));
                let [near, far] = if a.0 <= b.0 { [a, b] } else { [b, a] };
                stack[waiting] = far;
                stack[waiting + 1] = near;
                waiting += 2;
            }
        }
        best
    }
}
