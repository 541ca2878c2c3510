//! A tool on its way between two poses, and what it keeps from the part.

use super::around::Cloud;
use super::walls::Walls;
use osculate_tools::sweep::{LinearMotion, SweptMotion};
use osculate_tools::{Cutter, Holder, Pose};

/// The tool may lie by this part of its radius deeper in the points on its way than at the contacts: chords between points
/// of a bent pass, and rounding.
const SLACK: f64 = 1e-4;
/// Poses of one piece of a hop at which the tool is held against the part.
const LOOKS: u32 = 6;
/// On long ways such poses are so far apart, in radii of the cutter, but no more than so many.
const STEP: f64 = 0.5;
const LONGEST: f64 = 500.0;

/// A body of the tool on ways between two poses: how far above the tip it sits, how deep it is in the points of the contacts' own
/// neighbourhood at the ends, which is no obstacle, and how near to the walls, by face.
struct KeptBody<'a> {
    body: &'a Cutter,
    up_mm: f64,
    limit_mm: f64,
    nearest_mm: Vec<f64>,
}

/// A tool that is to be kept off the part.
pub(super) struct Kept<'a> {
    cloud: &'a Cloud,
    walls: &'a Walls,
    slack_mm: f64,
    /// Distance of poses at which a long way is looked at.
    step_mm: f64,
    bodies: Vec<KeptBody<'a>>,
}

impl<'a> Kept<'a> {
    /// A cutter, and a holder where it ends, on ways that begin and end at poses, kept off points of passes and walls.
    pub fn new(
        (cutter, holder): (&'a Cutter, Option<&'a Holder>),
        ends: [Pose; 2],
        (cloud, walls): (&'a Cloud, &'a Walls),
    ) -> Self {
        let slack_mm = SLACK * cutter.radius_mm();
        let kept = |body: &'a Cutter, up_mm: f64| {
            let ends = ends.map(|p| p.retracted(up_mm));
            let deepest = ends.iter().map(|p| cloud.depth_mm(body, p)).fold(0.0, f64::max);
            let nearest_mm = walls.nearest(body, &ends);
            KeptBody { body, up_mm, limit_mm: deepest + slack_mm, nearest_mm }
        };
        let sections = holder.map(Holder::sections).unwrap_or_default();
        let above = sections.iter().map(|s| kept(&s.body, cutter.length_mm() + s.above_mm));
        let bodies = std::iter::once(kept(cutter, 0.0)).chain(above).collect();
        Self { cloud, walls, slack_mm, step_mm: STEP * cutter.radius_mm(), bodies }
    }

    /// What the tool keeps from walls at a pose, of what it should; None where it goes into the part or may touch a wall.
    fn room_at(&self, pose: &Pose) -> Option<f64> {
        self.bodies.iter().try_fold(1.0, |least: f64, b| {
            let pose = pose.retracted(b.up_mm);
            let clear = self.cloud.depth_mm(b.body, &pose) <= b.limit_mm;
            let room =
                clear.then(|| self.walls.room(b.body, &pose, &b.nearest_mm, self.slack_mm)).flatten()?;
            Some(least.min(room))
        })
    }

    /// The least that the tool keeps on straight ways from pose to pose.
    pub fn room(&self, way: &[Pose]) -> Option<f64> {
        way.windows(2).try_fold(1.0, |least: f64, w| {
            let motion = LinearMotion { from: w[0], to: w[1] };
            let length = (w[1].tip - w[0].tip).norm().min(LONGEST * self.step_mm);
            // At most LONGEST.
            let looks = LOOKS.max((length / self.step_mm).ceil() as u32);
            (1..=looks).try_fold(least, |least, k| {
                let now = motion.at(f64::from(k) / f64::from(looks))?;
                Some(least.min(self.room_at(&now.pose)?))
            })
        })
    }
}
