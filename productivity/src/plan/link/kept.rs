//! A tool on its way between two poses, and what it keeps from the part.
//!
//! A straight way is looked at pose by pose. What the tool has to spare at one pose it may go before it is looked at again, as no point
//! of it moves farther than that; where it has nothing to spare poses are so close that what it may graze between them is far less than
//! what ways may go into the part.

use super::tree::Dots;
use super::walls::{Ends, Room, Walls};
use osculate_tools::sweep::{LinearMotion, SweptMotion};
use osculate_tools::{Cutter, Pose};

/// The tool may lie by this part of its radius deeper in the points on its way than at the contacts: chords between points
/// of a bent pass, and rounding.
const SLACK: f64 = 1e-4;
/// Poses next to the part are no farther apart than this part of the cutter's radius: between them a cylinder grazes by an eighth of the
/// square of that, a thousandth of its radius.
const STEP: f64 = 0.1;
/// As far as this many radii it is asked what a tool has to spare.
const SPARE: f64 = 1.0;
/// Most poses of a piece.
const LOOKS: u32 = 4000;

/// Everything that the tool keeps off.
#[derive(Clone, Copy)]
pub(super) struct Around<'a> {
    /// The contacts of passes, which lie on the faces that are machined.
    pub contacts: &'a Dots,
    pub walls: &'a Walls,
}

impl Around<'_> {
    fn of_faces(&self) -> impl Iterator<Item = &Dots> {
        std::iter::once(self.contacts).chain(self.walls.ground())
    }

    /// The least signed distance of a body from the faces that are machined, where that is less than `below_mm`.
    pub fn off_mm(&self, body: &Cutter, pose: &Pose, below_mm: f64) -> f64 {
        self.of_faces().fold(below_mm, |least, dots| dots.least_mm(body, pose, least))
    }

    /// Whether a point of the faces that are machined is nearer to a body than so much.
    pub fn is_within(&self, body: &Cutter, pose: &Pose, limit_mm: f64) -> bool {
        self.of_faces().any(|dots| dots.any((body, pose), limit_mm, &mut |_, _| true))
    }
}

/// A body of the tool on ways between two poses: how far above the tip it sits, how deep it is in the points of the contacts' own
/// neighbourhood at the ends, which is no obstacle, and how near to the walls.
struct KeptBody<'a> {
    body: &'a Cutter,
    up_mm: f64,
    limit_mm: f64,
    nearest_mm: Vec<f64>,
}

/// A tool that is to be kept off the part.
pub(super) struct Kept<'a> {
    around: Around<'a>,
    slack_mm: f64,
    /// Distance of poses next to the part.
    step_mm: f64,
    /// What is asked for of what there is to spare.
    most_mm: f64,
    /// From the tip to the top of all bodies.
    height_mm: f64,
    bodies: Vec<KeptBody<'a>>,
}

impl<'a> Kept<'a> {
    /// A cutter, and what stands on it, each where the one before ends, on ways that begin and end at poses. They may go as deep into the faces that are
    /// machined as they are at the ends, or as deep as `dip_mm`.
    pub fn new(
        bodies: impl Iterator<Item = &'a Cutter>,
        ends: [Pose; 2],
        around: Around<'a>,
        dip_mm: f64,
    ) -> Self {
        let mut kept =
            Self { around, slack_mm: 0.0, step_mm: 0.0, most_mm: 0.0, height_mm: 0.0, bodies: Vec::new() };
        for body in bodies {
            if kept.bodies.is_empty() {
                let radius_mm = body.radius_mm();
                (kept.slack_mm, kept.step_mm) = (SLACK * radius_mm, STEP * radius_mm);
                kept.most_mm = SPARE * radius_mm;
            }
            let up_mm = kept.height_mm;
            let ends = ends.map(|p| p.retracted(up_mm));
            let deepest = ends.iter().map(|p| -around.off_mm(body, p, 0.0)).fold(0.0, f64::max);
            let nearest_mm = around.walls.nearest(body, &ends);
            let limit_mm = (deepest + kept.slack_mm).max(dip_mm);
            kept.bodies.push(KeptBody { body, up_mm, limit_mm, nearest_mm });
            kept.height_mm += body.length_mm();
        }
        kept
    }

    /// What the tool keeps at a pose; None where it goes into the part or may touch a wall.
    fn room_at(&self, pose: &Pose) -> Option<Room> {
        let all = Room { share: 1.0, spare_mm: self.most_mm };
        self.bodies.iter().try_fold(all, |least, b| {
            let pose = pose.retracted(b.up_mm);
            let off = self.around.off_mm(b.body, &pose, least.spare_mm - b.limit_mm) + b.limit_mm;
            if off < 0.0 {
                return None;
            }
            let ends = Ends { nearest_mm: &b.nearest_mm, slack_mm: self.slack_mm };
            let room = self.around.walls.room((b.body, &pose), &ends, least.spare_mm.min(off))?;
            Some(Room { share: least.share.min(room.share), ..room })
        })
    }

    /// The least that the tool keeps of what it should on straight ways from pose to pose, 1 at most; None where it goes into the part
    /// or may touch a wall.
    pub fn room(&self, way: &[Pose]) -> Option<f64> {
        way.windows(2).try_fold(1.0, |least: f64, w| {
            let motion = LinearMotion { from: w[0], to: w[1] };
            // No point of the tool moves farther.
            let length = (w[1].tip - w[0].tip).norm() + self.height_mm * w[0].axis.angle(&w[1].axis);
            let mut least = least;
            let mut at = 0.0;
            for _ in 0..LOOKS {
                let now = motion.at(if length > 0.0 { (at / length).min(1.0) } else { 1.0 })?;
                let room = self.room_at(&now.pose)?;
                least = least.min(room.share);
                if at >= length {
                    return Some(least);
                }
                at = (at + room.spare_mm.max(self.step_mm)).min(length);
            }
            None
        })
    }
}
