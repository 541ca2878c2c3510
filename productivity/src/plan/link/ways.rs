//! Ways from the end of a pass to the beginning of the next, the fastest that is clear.
//!
//! A way is a polyline of poses. From the contact it goes off, across, and down to the other one; the higher it goes off, the more of
//! it can be rapid. Tried are, from low to high: straight along the surface, off it by little, over what stands between, and over the
//! sphere around everything. Each is held against the part (`kept`), and of those that are clear the one of the least time counts.

use super::kept::{Around, Kept};
use super::left::Left;
use super::links::{GRAZING, Links, STRAIGHT};
use super::rates::Step;
use super::tree::Dots;
use super::walls::Walls;
use crate::plan::CcPoint;
use osculate_geom::{Point3, Unit3};
use osculate_tools::Pose;
use osculate_tools::cl::Motion;
use osculate_tools::sweep::{LinearMotion, SweptMotion};

/// Swing of the axis in one piece of a rapid, rad.
const SWING_STEP: f64 = 0.1;
/// Largest swing on a way that does not go over the sphere, rad: about a lead of 25 degrees turned over.
const SWING: f64 = 0.9;
/// Share of its lift that a low way may lose and be clear still: the part is known at points only.
const SPARE: f64 = 0.5;
/// Directions in which low ways leave a contact, from the normal to the axis.
const ALONG: [f64; 3] = [0.0, 0.5, 1.0];
/// Shares of the way along the normal on which a tool leaves that leans far over.
const ASIDE: [f64; 6] = [1.0, 0.5, 0.35, 0.25, 0.18, 0.125];
/// Quotient of the heights at which a way over what stands between two passes is looked for.
const HIGHER: f64 = 1.5;
/// Where the ways off two contacts keep less from walls than they should the way across keeps this share of that: walls are known at
/// points, beside which a tool may pass or over them.
const AS_NEAR: f64 = 0.9;
/// Low ways are not looked for where they would take so many times as long as one off the surface and back at least does: that is often
/// not clear so low.
const FED: f64 = 3.0;
/// Of surfaces steeper than this, as the cosine between normal and axis, the way up the axis is no measure of the way off.
const STEEP: f64 = 0.1;
/// Times that a way along what was taken out of a pass is raised where it is not clear between two places.
const RAISES: usize = 12;
/// Rapid moves keep off what may stand on the faces, and off raw material, by so many of the least lifts.
const RAPID_OFF: f64 = 2.0;
/// Poses at which it is asked whether a way is free for a rapid are so far apart, in radii.
const LOOK: f64 = 0.5;

/// Where a leg of a way ends, and how it gets there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Leg {
    pub pose: Pose,
    pub motion: Motion,
    /// Whether it is off everything, by no less than the least lift.
    pub aloft: bool,
}

/// A way with its time.
#[derive(Clone, Debug, PartialEq, Default)]
pub(super) struct Way {
    pub legs: Vec<Leg>,
    pub min: f64,
    /// Whether it was found clear of the part.
    pub clear: bool,
}

/// The pose over a contact, off it between the normal (0) and the tool's axis (1).
fn lifted(p: &CcPoint, mm: f64, along: f64) -> Pose {
    let way = p.normal.into_inner() * (1.0 - along) + p.pose.axis.into_inner() * along;
    // Opposite to each other they have no middle: no tool stands so.
    let way = Unit3::try_new(way, 1e-9).unwrap_or(p.normal);
    Pose { tip: p.pose.tip + way.into_inner() * mm, axis: p.pose.axis }
}

fn step(a: &Pose, b: &Pose) -> Step {
    Step { length_mm: (b.tip - a.tip).norm(), turn_rad: a.axis.angle(&b.axis) }
}

/// Who finds ways.
#[derive(Clone, Copy)]
pub(super) struct Finder<'a> {
    pub links: &'a Links,
    pub around: Around<'a>,
    /// Raw material that is left, where it is known.
    pub left: Option<&'a Left>,
    /// The sphere around everything, with the clearance.
    pub centre: Point3,
    pub radius_mm: f64,
}

impl<'a> Finder<'a> {
    pub fn new(links: &'a Links, (contacts, walls): (&'a Dots, &'a Walls), left: Option<&'a Left>) -> Self {
        let centre = links.obstacles.centre();
        let radius_mm = 0.5 * links.obstacles.diagonal_mm() + links.clearance_mm;
        Self { links, around: Around { contacts, walls }, left, centre, radius_mm }
    }

    /// The tool on ways that begin and end at poses.
    fn kept(&self, ends: [Pose; 2]) -> Kept<'a> {
        Kept::new(self.links.bodies(), ends, self.around, self.links.dip_mm)
    }

    /// How far above the centre the safe plane across an axis is: on the sphere, and where the axis stays as it is over the box alone.
    fn safe_mm(&self, axis: &Unit3) -> f64 {
        if !self.links.dropped {
            return self.radius_mm;
        }
        let half = 0.5 * (self.links.obstacles.max - self.links.obstacles.min);
        half.abs().dot(&axis.abs()) + self.links.clearance_mm
    }

    /// The pose on the axis of `pose` whose tip is on the safe plane, never below `pose` itself.
    fn above(&self, pose: &Pose) -> Pose {
        let height = (pose.tip - self.centre).dot(&pose.axis);
        pose.retracted((self.safe_mm(&pose.axis) - height).max(0.0))
    }

    pub fn pole(&self, axis: &Unit3) -> Pose {
        Pose { tip: self.centre + axis.into_inner() * self.radius_mm, axis: *axis }
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

    /// Whether nothing that may stand on the faces, and no raw material that is left when pass `k` begins, is near the tool.
    fn is_free(&self, pose: &Pose, k: u32) -> bool {
        let off_mm = self.links.layer_mm + RAPID_OFF * self.links.hop_mm;
        let mut up_mm = 0.0;
        self.links.bodies().all(|body| {
            let pose = pose.retracted(up_mm);
            up_mm += body.length_mm();
            !self.around.is_within(body, &pose, off_mm)
                && self
                    .left
                    .is_none_or(|left| !left.is_within((body, &pose), RAPID_OFF * self.links.hop_mm, k))
        })
    }

    /// A straight piece of a way from `from` on: rapid where the tool is free and that is faster, else fed.
    fn paced(&self, way: &mut Way, (from, to): (&Pose, &Pose), k: u32) {
        let whole = step(from, to);
        if whole.length_mm == 0.0 && whole.turn_rad == 0.0 {
            return;
        }
        let motion = LinearMotion { from: *from, to: *to };
        let apart = LOOK * self.links.cutter.radius_mm();
        // Bounded by the size of the sphere; coordinates are finite.
        let count =
            ((whole.length_mm / apart).max(whole.turn_rad / SWING_STEP).ceil() as usize).clamp(1, 4000);
        let at = |i: usize| {
            let now = motion.at(i as f64 / count as f64).map_or(*to, |m| m.pose);
            if i == count { *to } else { now }
        };
        let free: Vec<bool> = (0..=count).map(|i| self.is_free(&at(i), k)).collect();
        let mut begin = 0;
        while begin < count {
            let is_free = free[begin] && free[begin + 1];
            let end = (begin + 1..count).find(|i| (free[*i] && free[i + 1]) != is_free).unwrap_or(count);
            let (a, b) = (at(begin), at(end));
            let run = step(&a, &b);
            let turns = (run.turn_rad / SWING_STEP).ceil().max(1.0) as usize;
            let part =
                Step { length_mm: run.length_mm / turns as f64, turn_rad: run.turn_rad / turns as f64 };
            let rapid_min = turns as f64 * self.links.rates.rapid_min(part);
            let feed_min = self.links.rates.feed_min(run, self.links.feed_mm_min);
            if is_free && rapid_min < feed_min {
                let piece = LinearMotion { from: a, to: b };
                for t in 1..=turns {
                    let pose =
                        if t == turns { b } else { piece.at(t as f64 / turns as f64).map_or(b, |m| m.pose) };
                    way.legs.push(Leg { pose, motion: Motion::Rapid, aloft: true });
                }
                way.min += rapid_min;
            } else {
                way.legs.push(Leg { pose: b, motion: Motion::Feed(self.links.feed_mm_min), aloft: true });
                way.min += feed_min;
            }
            begin = end;
        }
    }

    /// Appends a leg at a feed.
    fn fed(&self, way: &mut Way, (from, to): (&Pose, &Pose), feed_mm_min: f64) {
        way.min += self.links.rates.feed_min(step(from, to), feed_mm_min);
        way.legs.push(Leg { pose: *to, motion: Motion::Feed(feed_mm_min), aloft: false });
    }

    /// A way through poses from a contact to another: fed off the one and down to the other, in between as fast as may be.
    fn through(&self, poses: &[Pose], k: u32) -> Way {
        let mut way = Way { clear: true, ..Way::default() };
        let last = poses.len() - 1;
        for (i, w) in poses.windows(2).enumerate() {
            match i {
                0 => self.fed(&mut way, (&w[0], &w[1]), self.links.feed_mm_min),
                i if i + 1 == last => self.fed(&mut way, (&w[0], &w[1]), self.links.plunge_mm_min),
                _ => self.paced(&mut way, (&w[0], &w[1]), k),
            }
        }
        way
    }

    /// What of a way up from a contact, over and down to another is to be asked of the part: where nothing is in the tool's way straight
    /// up only what goes over.
    fn asked<'p>(&self, poses: &'p [Pose]) -> &'p [Pose] {
        let ups = if self.links.dropped { (poses.len() - 1) / 2 } else { 0 };
        &poses[ups..poses.len() - ups]
    }

    /// What straight ways along the surface rise by: twice what the tool may graze between the points that the part is known at, where
    /// that is more than ways may go into it.
    fn graze_mm(&self) -> f64 {
        let hidden = self.around.walls.hidden_mm(&self.links.cutter);
        if hidden > SPARE * self.links.dip_mm { hidden / SPARE } else { 0.0 }
    }

    /// A way off the surface by little, straight along it where the contacts lie beside each other: as low as may be, along the normals
    /// rather than along the axes, but in a narrow place there may be no other way than along them. What goes straight along the
    /// surface is slow: just off it may be faster.
    fn low(&self, kept: &Kept<'_>, (from, to): (&CcPoint, &CcPoint), k: u32) -> Option<Way> {
        let across = step(&from.pose, &to.pose);
        let dropped = self.links.dropped;
        let ways = if dropped { &ALONG[ALONG.len() - 1..] } else { &ALONG[..] };
        let highest = self.links.approach_mm;
        let beside = across.length_mm <= STRAIGHT * self.links.cutter.radius_mm();
        let mut lift = if beside { self.graze_mm().min(highest) } else { self.links.hop_mm.min(highest) };
        let mut grazed: Option<Way> = None;
        loop {
            let is_graze = lift < self.links.hop_mm;
            for along in ways {
                let way = |mm: f64| {
                    let off = |p: &CcPoint| {
                        // As high above the surface up the axis as along the normal.
                        let rise = p.normal.dot(&p.pose.axis).max(STEEP);
                        lifted(p, if dropped && is_graze { mm / rise } else { mm }, *along)
                    };
                    [from.pose, off(from), off(to), to.pose]
                };
                let room = |way: &[Pose]| {
                    if is_graze { kept.room_along(way) } else { kept.room(self.asked(way)) }
                };
                let clear = |mm: f64| room(&way(mm)).is_some_and(|r| r >= 1.0);
                if clear(lift) && (lift >= highest || clear((1.0 - SPARE) * lift)) {
                    let way = way(lift);
                    if !is_graze {
                        let off = self.through(&way, k);
                        return Some(grazed.filter(|way| way.min <= off.min).unwrap_or(off));
                    }
                    let on = if lift > 0.0 { &way[..] } else { &[from.pose, to.pose][..] };
                    grazed = Some(self.grazing(on));
                    break;
                }
                if lift == 0.0 {
                    break;
                }
            }
            // Higher than just off the surface is slower still.
            if lift >= highest || (grazed.is_some() && !is_graze) {
                return grazed;
            }
            lift = if is_graze { self.links.hop_mm } else { 2.0 * lift }.min(highest);
        }
    }

    /// Straight along the surface: the tool cuts there, across the passes, where teeth mark the crests between them more than those of
    /// the passes do; what touches goes slower than into material.
    fn grazing(&self, poses: &[Pose]) -> Way {
        let mut way = Way { clear: true, ..Way::default() };
        for w in poses.windows(2) {
            let whole = step(&w[0], &w[1]);
            let share = whole.length_mm / self.links.grazed_mm(whole).max(f64::MIN_POSITIVE);
            if whole.length_mm > 0.0 {
                self.fed(&mut way, (&w[0], &w[1]), share * GRAZING * self.links.plunge_mm_min);
            }
        }
        way
    }

    /// A way over what stands between two contacts, up their axes: as high as that needs, where that is lower than the safe plane. The
    /// ways off the contacts and down to them are those of a way over the safe plane too: what counts is the way across, which keeps
    /// what it should, or nearly what they keep.
    fn over(&self, kept: &Kept<'_>, (from, to): (&CcPoint, &CcPoint), k: u32) -> Option<Way> {
        if from.pose.axis.angle(&to.pose.axis) > SWING {
            return None;
        }
        let [a, b] = [self.off(from), self.off(to)];
        let most = [a, b].iter().map(|p| (self.above(p).tip - p.tip).norm()).fold(f64::INFINITY, f64::min);
        let mut best: Option<Way> = None;
        let mut height = 0.0;
        while height < most {
            let [high_a, high_b] = [a.retracted(height), b.retracted(height)];
            let poses = [from.pose, a, high_a, high_b, b, to.pose];
            let ups = if self.links.dropped {
                Some(1.0)
            } else {
                [&poses[..3], &poses[3..]]
                    .iter()
                    .try_fold(1.0_f64, |least, ups| Some(least.min(kept.room(ups)?)))
            };
            let enough = ups.map_or(1.0, |ups| if ups < 1.0 { AS_NEAR * ups } else { 1.0 });
            if kept.room(&poses[2..4]).is_some_and(|room| room >= enough) {
                let way = Way { clear: ups.is_some(), ..self.through(&poses, k) };
                let is_rapid = way.legs.iter().any(|leg| leg.motion == Motion::Rapid && leg.pose == high_b);
                if best.as_ref().is_none_or(|b| (!way.clear, way.min) < (!b.clear, b.min)) {
                    best = Some(way);
                }
                // Higher takes longer from here on.
                if is_rapid {
                    break;
                }
            }
            height = if height > 0.0 { HIGHER * height } else { self.links.approach_mm };
        }
        best
    }

    /// A way along the pass that both contacts are of, over what was taken out of it: up its axes, at each place as high as that needs.
    /// None where it would take as long as `within_min`.
    fn along(
        &self,
        kept: &Kept<'_>,
        (from, to): (&CcPoint, &CcPoint),
        skipped: &[CcPoint],
        within_min: f64,
    ) -> Option<Way> {
        let apart = LOOK * self.links.cutter.radius_mm();
        let mut poses = vec![from.pose];
        for p in skipped {
            let last = poses.last()?;
            if step(last, &p.pose).length_mm >= apart && step(&p.pose, &to.pose).length_mm >= 0.5 * apart {
                poses.push(p.pose);
            }
        }
        poses.push(to.pose);
        let whole: f64 = poses
            .windows(2)
            .map(|w| self.links.rates.feed_min(step(&w[0], &w[1]), self.links.feed_mm_min))
            .sum();
        if whole >= within_min {
            return None;
        }
        let clear = |way: &[Pose]| kept.room(way).is_some_and(|room| room >= 1.0);
        let most = poses.iter().map(|p| step(p, &self.above(p)).length_mm).fold(f64::INFINITY, f64::min);
        let least = self.links.hop_mm.min(most);
        let mut lifts = vec![least; poses.len()];
        for (pose, lift) in poses.iter().zip(&mut lifts) {
            while !clear(&[pose.retracted(*lift); 2]) {
                *lift *= HIGHER;
                if *lift > most {
                    return None;
                }
            }
        }
        // Between two places that are clear higher ones are.
        for _ in 0..RAISES {
            let up: Vec<Pose> = poses.iter().zip(&lifts).map(|(p, lift)| p.retracted(*lift)).collect();
            let blocked: Vec<usize> = (1..up.len()).filter(|k| !clear(&up[k - 1..=*k])).collect();
            if blocked.is_empty() {
                let all: Vec<Pose> = std::iter::once(from.pose).chain(up).chain([to.pose]).collect();
                let mut way =
                    Way { clear: clear(&all[..2]) && clear(&all[all.len() - 2..]), ..Way::default() };
                let last = all.len() - 2;
                for (k, w) in all.windows(2).enumerate() {
                    let feed = if k == last { self.links.plunge_mm_min } else { self.links.feed_mm_min };
                    self.fed(&mut way, (&w[0], &w[1]), feed);
                }
                return Some(way).filter(|way| way.clear && way.min < within_min);
            }
            for k in blocked {
                let lift = HIGHER * lifts[k - 1].max(lifts[k]);
                if lift > most {
                    return None;
                }
                (lifts[k - 1], lifts[k]) = (lift, lift);
            }
        }
        None
    }

    /// Up to the sphere from a contact.
    pub fn retract(&self, from: &CcPoint, k: u32) -> Way {
        let off = self.off(from);
        let mut way = Way {
            clear: self.kept([from.pose, from.pose]).room(&[from.pose, off, self.above(&off)]).is_some(),
            ..Way::default()
        };
        self.fed(&mut way, (&from.pose, &off), self.links.feed_mm_min);
        self.paced(&mut way, (&off, &self.above(&off)), k);
        way
    }

    /// Down from the sphere to a contact.
    pub fn approach(&self, to: &CcPoint, k: u32) -> Way {
        let off = self.off(to);
        let above = self.above(&off);
        let mut way = Way {
            clear: self.kept([to.pose, to.pose]).room(&[above, off, to.pose]).is_some(),
            ..Way::default()
        };
        way.legs.push(Leg { pose: above, motion: Motion::Rapid, aloft: true });
        self.paced(&mut way, (&above, &off), k);
        self.fed(&mut way, (&off, &to.pose), self.links.plunge_mm_min);
        way
    }

    /// Over the sphere from one axis to another, always looking outward.
    fn travel(&self, way: &mut Way, from: &Unit3, to: &Unit3) {
        let angle = from.angle(to);
        let steps = (angle / SWING_STEP).ceil() as usize;
        if steps == 0 {
            return;
        }
        way.legs.push(Leg { pose: self.pole(from), motion: Motion::Rapid, aloft: true });
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
            way.legs.push(Leg { pose: self.pole(&axis), motion: Motion::Rapid, aloft: true });
        }
        let one = Step { length_mm: angle * self.radius_mm / steps as f64, turn_rad: angle / steps as f64 };
        way.min += steps as f64 * self.links.rates.rapid_min(one);
    }

    /// Over the sphere.
    fn around(&self, from: &CcPoint, to: &CcPoint, k: u32) -> Way {
        let mut way = self.retract(from, k);
        self.travel(&mut way, &from.pose.axis, &to.pose.axis);
        let down = self.approach(to, k);
        let last = way.legs.last().map_or(from.pose, |leg| leg.pose);
        way.min += down.min
            + down.legs.first().map_or(0.0, |leg| self.links.rates.rapid_min(step(&last, &leg.pose)));
        way.legs.extend(down.legs);
        way.clear &= down.clear;
        way
    }

    /// The fastest clear way from the end of a pass to the beginning of pass `k`. Where both are of one pass `skipped` is what was taken
    /// out of it between them.
    pub fn between(&self, (from, to): (&CcPoint, &CcPoint), k: u32, skipped: &[CcPoint]) -> Way {
        let kept = self.kept([from.pose, to.pose]);
        // No way off the surface and back is faster than that.
        let l = self.links;
        let across = step(&from.pose, &to.pose);
        let off_min = l.approach_mm / l.feed_mm_min + l.approach_mm / l.plunge_mm_min;
        let least = off_min + l.rates.rapid_min(across);
        let near = across.turn_rad <= SWING && l.rates.feed_min(across, l.feed_mm_min) <= FED * least;
        let low = near.then(|| self.low(&kept, (from, to), k)).flatten();
        if let Some(way) = low.as_ref().filter(|way| way.min <= least) {
            return way.clone();
        }
        let over = self.over(&kept, (from, to), k);
        let (over, tight) = match over {
            Some(way) if !way.clear => (None, Some(way)),
            over => (over, None),
        };
        let known = [&low, &over].into_iter().flatten().map(|w| w.min).fold(f64::INFINITY, f64::min);
        let along = (!skipped.is_empty()).then(|| self.along(&kept, (from, to), skipped, known)).flatten();
        let fastest = [low, over, along].into_iter().flatten().min_by(|a, b| a.min.total_cmp(&b.min));
        fastest.or(tight).unwrap_or_else(|| self.around(from, to, k))
    }
}
