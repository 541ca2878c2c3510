//! Moves between passes: steps on the surface, hops and retracts.
//!
//! A retract leaves along the tool's own axis until the tip is above the plane that touches the part's bounding
//! sphere (grown by the clearance) on the side the axis points to; there nothing of the part can meet the tool,
//! whose body lies beyond the tip. From the pole of that plane the axis swings over the sphere, always pointing
//! outward, to the pole of the next pass and down again. Passes that begin near the end of the one before are
//! joined by a hop instead: up along the normal, or between it and the axis where there is no room, across, and down, as low as keeps
//! the tool off other walls and far enough from faces that are not machined; where none does, by a way as high as what stands between.

use super::around::Cloud;
use super::kept::Kept;
use super::walls::Walls;
use super::{CcPoint, Pass};
use osculate_geom::{Box3, Point3, Unit3, Vec3};
use osculate_tools::cl::{ClMove, ClPath, Motion};
use osculate_tools::{Cutter, Holder, Pose};

/// How passes are linked. Lengths mm, feeds mm/min.
#[derive(Clone, Debug, PartialEq)]
pub struct Links {
    /// Box of everything the tool must stay clear of on rapid moves.
    pub obstacles: Box3,
    /// Clearance above the sphere around the obstacles.
    pub clearance_mm: f64,
    /// Distance from the surface at which a rapid approach changes to feed.
    pub approach_mm: f64,
    /// The least lift of a hop; one that is not clear is doubled until it is, up to `approach_mm`.
    pub hop_mm: f64,
    /// Whether the tool touches the part where passes say it does: those along waterlines know the height of the tool, and of
    /// what it touches the slope nearby only.
    pub contacts: bool,
    /// Whether the tool keeps its axis and stands nowhere lower than all faces let it: then nothing is in its way straight up, whereas
    /// points of the faces may miss an edge that it would meet on a way aside.
    pub dropped: bool,
    /// Material that may stand on the faces yet: rapids do not go into it.
    pub layer_mm: f64,
    /// The cutter.
    pub cutter: Cutter,
    /// The holder, whose nose sits where the cutter's length ends.
    pub holder: Option<Holder>,
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
/// Share of its lift that a low hop may lose and be clear still: the part is known at points only.
const SPARE: f64 = 0.5;
/// Ways in which hops leave a contact, from the normal to the axis.
const ALONG: [f64; 3] = [0.0, 0.5, 1.0];
/// Shares of the way along the normal on which a tool leaves that leans far over.
const ASIDE: [f64; 6] = [1.0, 0.5, 0.35, 0.25, 0.18, 0.125];
/// Quotient of the heights at which a way over what stands between two passes is looked for.
const HIGHER: f64 = 1.5;

/// The pose over a contact, off it between the normal (0) and the tool's axis (1).
fn lifted(p: &CcPoint, mm: f64, along: f64) -> Pose {
    let way = p.normal.into_inner() * (1.0 - along) + p.pose.axis.into_inner() * along;
    // Opposite to each other they have no middle: no tool stands so.
    let way = Unit3::try_new(way, 1e-9).unwrap_or(p.normal);
    Pose { tip: p.pose.tip + way.into_inner() * mm, axis: p.pose.axis }
}

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
        pose.retracted((self.radius - height).max(0.0))
    }

    fn pole(&self, axis: &Unit3) -> Pose {
        Pose { tip: self.centre + axis.into_inner() * self.radius, axis: *axis }
    }

    /// Leaves a contact, as far up the axis as is given.
    fn leave(&mut self, from: &CcPoint, height_mm: f64) {
        let off = self.off(from);
        self.go(off, Motion::Feed(self.links.feed_mm_min), None);
        self.go(off.retracted(height_mm), Motion::Rapid, None);
    }

    fn retract(&mut self, from: &CcPoint) {
        let off = self.off(from);
        self.leave(from, (self.above(&off).tip - off.tip).norm());
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

    fn approach(&mut self, to: &CcPoint) {
        let off = self.off(to);
        let above = self.above(&off);
        self.go(above, Motion::Rapid, None);
        self.come(to, (above.tip - off.tip).norm());
    }

    /// Comes down to a contact from so far up its axis; in a narrow place the last of the way is fed.
    fn come(&mut self, to: &CcPoint, height_mm: f64) {
        let off = self.off(to);
        let step = self.links.cutter.radius_mm();
        let steps = (height_mm / step) as usize;
        let free = (0..=steps).map(|k| off.retracted(k as f64 * step)).find(|p| self.is_free(p));
        self.go(free.unwrap_or_else(|| off.retracted(height_mm)), Motion::Rapid, None);
        self.go(off, Motion::Feed(self.links.feed_mm_min), None);
        self.go(to.pose, Motion::Feed(self.links.plunge_mm_min), None);
    }

    /// The tool on ways that begin and end at poses.
    fn kept(&self, ends: [Pose; 2]) -> Kept<'_> {
        let tool = (&self.links.cutter, self.links.holder.as_ref());
        Kept::new(tool, ends, (&self.cloud, self.walls))
    }

    /// The poses above both ends of a hop on a way that is clear of the part, if there is one: as low as may be, along the normals
    /// rather than along the axes, but in a narrow place there may be no other way than along them.
    fn hop_over(&self, from: &CcPoint, to: &CcPoint) -> Option<[Pose; 2]> {
        let kept = self.kept([from.pose, to.pose]);
        let clear =
            |[up, over]: &[Pose; 2]| kept.room(&[from.pose, *up, *over, to.pose]).is_some_and(|r| r >= 1.0);
        let highest = self.links.approach_mm;
        let mut low = self.links.hop_mm.min(highest);
        while low > 0.0 && low < highest {
            for along in self.ways() {
                let hop = |mm: f64| [from, to].map(|p| lifted(p, mm, *along));
                if clear(&hop(low)) && clear(&hop((1.0 - SPARE) * low)) {
                    return Some(hop(low));
                }
            }
            low *= 2.0;
        }
        self.ways().iter().map(|along| [from, to].map(|p| lifted(p, highest, *along))).find(clear)
    }

    /// The ways in which hops leave a contact.
    fn ways(&self) -> &'static [f64] {
        if self.links.dropped { &ALONG[ALONG.len() - 1..] } else { &ALONG }
    }

    /// Where the tool is off a contact by the approach distance. One that leans far over would rub along the face if it left along
    /// its axis alone: it leaves along the normal too, as far as there is most room.
    fn off(&self, p: &CcPoint) -> Pose {
        let straight = p.pose.retracted(self.links.approach_mm);
        if self.links.dropped {
            return straight;
        }
        let most = self.links.approach_mm * p.pose.axis.angle(&p.normal).sin();
        let kept = self.kept([p.pose, p.pose]);
        let aside =
            |share: f64| Pose { tip: straight.tip + p.normal.into_inner() * (share * most), ..straight };
        let all = ASIDE.iter().map(|share| aside(*share));
        let rooms = all.filter_map(|off| Some((kept.room(&[p.pose, off])?, off)));
        rooms.fold((0.0, straight), |best, next| if next.0 > best.0 { next } else { best }).1
    }

    /// Whether a rapid down the axis to a pose leaves what may stand on the faces where it is.
    fn is_free(&self, pose: &Pose) -> bool {
        !self.cloud.is_within(&self.links.cutter, pose, self.links.layer_mm)
            && self.links.holder.as_ref().is_none_or(|h| {
                h.posed(&self.links.cutter, pose)
                    .all(|(body, at)| !self.cloud.is_within(body, &at, self.links.layer_mm))
            })
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
        if let Some(height_mm) = self.height_over(from, to) {
            self.leave(from, height_mm);
            self.go(self.off(to).retracted(height_mm), Motion::Feed(self.links.feed_mm_min), None);
            self.come(to, height_mm);
            return;
        }
        self.retract(from);
        self.travel(&from.pose.axis, &to.pose.axis);
        self.approach(to);
    }

    /// How far up their axes both ends of a way are over what stands between them, where that is lower than the safe plane.
    fn height_over(&self, from: &CcPoint, to: &CcPoint) -> Option<f64> {
        if from.pose.axis.angle(&to.pose.axis) > HOP_SWING {
            return None;
        }
        let kept = self.kept([from.pose, to.pose]);
        let [a, b] = [self.off(from), self.off(to)];
        let most = [a, b].iter().map(|p| (self.above(p).tip - p.tip).norm()).fold(f64::INFINITY, f64::min);
        let mut height = self.links.approach_mm;
        while height < most {
            let way = [a, a.retracted(height), b.retracted(height), b];
            if kept.room(&way).is_some_and(|room| room >= 1.0) {
                return Some(height);
            }
            height *= HIGHER;
        }
        None
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
    let touched = if links.contacts { passes } else { &[] };
    let cloud = Cloud::of(touched, NEAR_POINTS * links.cutter.radius_mm(), walls.ground());
    let mut b = Builder { links, walls, cloud, out: Linked::default(), centre, radius };
    let mut last: Option<CcPoint> = None;
    for (k, pass) in passes.iter().enumerate() {
        let (Some(first), Some(end)) = (pass.points.first(), pass.points.last()) else { continue };
        match &last {
            None => {
                b.go(b.pole(&first.pose.axis), Motion::Rapid, None);
                b.approach(first);
            }
            Some(from) => b.join(from, first),
        }
        for p in &pass.points[1..] {
            b.go(p.pose, Motion::Feed(links.feed_mm_min), Some(k as u32));
        }
        last = Some(*end);
    }
    if let Some(end) = &last {
        b.retract(end);
        b.go(b.pole(&end.pose.axis), Motion::Rapid, None);
    }
    b.out
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
