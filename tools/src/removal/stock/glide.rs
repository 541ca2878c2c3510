//! One body over a short piece of its motion, against many parallel rays.
//!
//! In the frame of the tool at the middle of the piece a point s along a ray passes on a parabola, x from -1/2 to 1/2, but
//! for terms of third order in the turn. Its straight line of least deviation, `y(x, s) = p + s d + x (u + s c)`, is off by
//! half the piece's sagitta to both sides: a sixteenth of the second derivative. The body's signed distance D is a convex
//! function of y, so that D(x, s) is convex in x and in s; in both together but for the term `x s c`, which vanishes for
//! motions that do not turn. The ray is covered where `f(s) = min over x of D(x, s)` is not positive. With x at its minimum
//!
//! `f(s') >= f(s) + D_s (s' - s) - |c| |s' - s|`,
//!
//! so that Newton's method with this slope, from outside, never passes the first s that is covered. D_x and D_xx come with
//! the distance in closed form: the least x takes one or two steps.

use super::ENDS_MM;
use super::instant::{Instant, Lowest};
use crate::removal::body::Body;
use crate::removal::piece::Approach;
use osculate_geom::{Point3, Unit3, Vec3, any_perpendicular};

/// Accuracy of distances over the piece: far below [`ENDS_MM`].
const FLAT_MM: f64 = 1e-3 * ENDS_MM;
/// A body is taken smaller by this much, so that on rounding it does not cut its own walls again ...
const LEVEL_MM: f64 = -ENDS_MM;
/// ... and this near to that level is at it.
const AT_LEVEL_MM: f64 = 0.1 * ENDS_MM;
/// Where the body met material is told when it is this near, of its radius: a fraction of a sector.
const MET: f64 = 0.01;
/// A way that is less than this part of it across the axis has no direction there: rounding is a billionth of that.
const ACROSS: f64 = 1e-6;
/// Steps towards the least x: Newton's are two or three, at kinks tangents cross in a few more.
const MOST_STILL: u32 = 40;
/// Steps by Newton's rule among them.
const MOST_NEWTON: u32 = 8;
/// Steps along a ray: quadratic at a crossing, halving where it grazes.
const MOST_STEPS: u32 = 50;
/// Steps after which one from within is not followed by another: a crossing of smooth walls takes three or four. Within, no least x
/// is looked for, so that beside an edge the tangent is that of one wall, and steps may come closer by a fifth only.
const MOST_BOLD: u32 = 10;

/// The body over the piece, for rays along one axis.
pub(super) struct Glide<'a> {
    body: Body<'a>,
    tip: Point3,
    /// p for a point at the tip, and the rows of the matrix by which it grows with the place: the frame's but for turning.
    start: Vec3,
    feet: [Vec3; 3],
    /// d, and one over its coordinates.
    along: Vec3,
    inverse: Vec3,
    /// u for a point at the tip, and the rows of the matrix by which it grows; zero for motions that do not turn.
    way: Vec3,
    turn: [Vec3; 3],
    /// c and its length.
    cross: Vec3,
    skew: f64,
    /// How far pieces may stray, mm.
    stray_mm: f64,
}

/// How a piece is looked at.
#[derive(Clone, Copy)]
pub(super) struct View {
    /// The axis of the rays.
    pub axis: usize,
    /// The way of the tip over the whole motion: ahead.
    pub way: Vec3,
    /// How far the piece strays from a straight line at most, mm.
    pub stray_mm: f64,
}

/// A ray seen from the tool: p and u.
#[derive(Clone, Copy)]
pub(super) struct Ray {
    foot: Vec3,
    way: Vec3,
}

/// D and its derivatives at an x.
#[derive(Clone, Copy)]
struct Side {
    x: f64,
    distance: f64,
    by_x: f64,
    by_s: f64,
}

/// A stretch of a ray that is covered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Covered {
    pub from: f64,
    pub to: f64,
    /// Whether all between the ends is covered for sure, to what a piece may stray: a turning body may leave a gap.
    pub whole: bool,
}

/// Where the body met a point first, in its frame: ahead, left, up.
pub(super) type Met = Vec3;

impl<'a> Glide<'a> {
    pub fn new(body: Body<'a>, approach: &Approach, view: &View) -> Self {
        let View { axis, way, stray_mm } = *view;
        let up = approach.axis;
        // A way along the axis has rounding across it, which is at no right angle to the axis.
        let ahead = Unit3::try_new(way - up * way.dot(&up), ACROSS * way.norm())
            .unwrap_or_else(|| any_perpendicular(&Unit3::new_unchecked(up)))
            .into_inner();
        let frame = [ahead, up.cross(&ahead), up];
        let Approach { advance, turn, spin, .. } = approach;
        // The second derivative of the path, w the place: -spin x w + turn x (turn x w) + 2 turn x advance.
        let bend = |e: &Vec3| spin.cross(e) + turn * e.dot(turn) - e * turn.norm_squared();
        let feet = frame.map(|e| e + bend(&e) / 16.0);
        let start = Vec3::from(frame.map(|e| e.dot(&turn.cross(advance)) / 8.0));
        let rows = frame.map(|e| turn.cross(&e));
        let cross = Vec3::from(rows.map(|t| t[axis]));
        Self {
            body,
            tip: approach.tip,
            start,
            along: Vec3::from(feet.map(|e| e[axis])),
            inverse: Vec3::from(feet.map(|e| 1.0 / e[axis])),
            feet,
            way: -Vec3::from(frame.map(|e| e.dot(advance))),
            turn: rows,
            cross,
            skew: cross.norm(),
            stray_mm,
        }
    }

    /// A ray by its point at s = 0.
    pub fn ray(&self, foot: &Point3) -> Ray {
        let w = foot - self.tip;
        let by = |[a, b, c]: &[Vec3; 3]| Vec3::new(a.dot(&w), b.dot(&w), c.dot(&w));
        Ray { foot: self.start + by(&self.feet), way: self.way + by(&self.turn) }
    }

    #[inline]
    fn at(&self, ray: &Ray, x: f64, s: f64) -> Instant {
        let rate = ray.way + self.cross * s;
        let place = ray.foot + self.along * s + rate * x;
        let local = self.body.local((place.x * place.x + place.y * place.y).sqrt(), place.z);
        let slope = |v: &Vec3| local.outwards * (place.x * v.x + place.y * v.y) + local.by_z * v.z;
        let (by_x, by_s) = (slope(&rate), slope(&(self.along + self.cross * x)));
        Instant { x, local, by_x, by_s, place, rate }
    }

    /// The ray's direction as seen from the tool at an instant.
    fn along_at(&self, x: f64) -> Vec3 {
        self.along + self.cross * x
    }

    /// Whether nothing is covered from an instant on, so far along the ray: by the plane that touches D there, which D nowhere lies below
    /// but for the term `x s c`.
    #[inline]
    fn is_clear(&self, here: &Instant, sign: f64, room: f64) -> bool {
        let by_x = here.by_x * (here.x + 0.5 * here.by_x.signum());
        let by_s = (-sign * here.by_s).max(0.0) * room;
        here.local.distance - by_x - by_s - self.skew * room > LEVEL_MM
    }

    /// f at `s`, the search beginning at an instant there; any x where D is at most `enough` will do.
    fn lowest(&self, ray: &Ray, s: f64, guess: Instant, enough: f64) -> Lowest {
        let (mut left, mut right): (Option<Side>, Option<Side>) = (None, None);
        let mut here = guess;
        for step in 0..MOST_STILL {
            let x = here.x;
            let (distance, by_x) = (here.local.distance, here.by_x);
            let room = match (&left, &right) {
                (Some(side), _) if by_x > 0.0 => x - side.x,
                (_, Some(side)) if by_x <= 0.0 => side.x - x,
                _ if by_x > 0.0 => x + 0.5,
                _ => 0.5 - x,
            };
            if distance <= enough {
                return here.inside();
            }
            let bend = here.bend_along(&here.rate);
            // What Newton's step gains.
            if 0.5 * by_x * by_x <= FLAT_MM * bend {
                return here.lowest(&self.along_at(here.x));
            }
            let side = Side { x, distance, by_x, by_s: here.by_s };
            if by_x.abs() * room <= FLAT_MM {
                // Across an edge neither side's slope is that of f.
                return match (&left, &right) {
                    (Some(left), _) if by_x > 0.0 => Self::between(left, &side),
                    (_, Some(right)) if by_x <= 0.0 => Self::between(&side, right),
                    _ => here.lowest(&self.along_at(here.x)),
                };
            }
            if by_x > 0.0 {
                right = Some(side);
            } else {
                left = Some(side);
            }
            let lo = left.map_or(-0.5, |i| i.x);
            let hi = right.map_or(0.5, |i| i.x);
            let newton = x - by_x / bend;
            let x = match (&left, &right) {
                _ if newton > lo && newton < hi && step < MOST_NEWTON => newton,
                (Some(a), Some(b)) => {
                    let best = Self::between(a, b);
                    if a.distance.min(b.distance) - best.value <= FLAT_MM {
                        return best;
                    }
                    best.x
                }
                (None, _) => -0.5,
                (_, None) => 0.5,
            };
            here = self.at(ray, x, s);
        }
        // At rounding: the bracket's two sides still bound f from below.
        match (&left, &right) {
            (Some(a), Some(b)) => Self::between(a, b),
            _ => here.lowest(&self.along_at(here.x)),
        }
    }

    /// Where the tangents of both sides of a bracket cross: f is not below it, and the mixture of both sides' slopes whose
    /// derivative by x vanishes is a slope of f (Danskin).
    fn between(a: &Side, b: &Side) -> Lowest {
        let share = b.by_x / (b.by_x - a.by_x);
        // Tangents at the crossing: a.distance + a.by_x (x - a.x) = b.distance + b.by_x (x - b.x).
        let gap = a.distance - b.distance + b.by_x * b.x - a.by_x * a.x;
        let x = (gap / (b.by_x - a.by_x)).clamp(a.x, b.x);
        let (value, slope) = (a.distance + a.by_x * (x - a.x), share * a.by_s + (1.0 - share) * b.by_s);
        Lowest { x, value, slope, bend: 0.0 }
    }

    /// The part of a stretch of a ray that the body covers, at most from the first covered point to the last. `guess` is
    /// where in the piece a neighbouring ray is covered first.
    pub fn covered(&self, ray: &Ray, span: [f64; 2], guess: &mut f64) -> Option<Covered> {
        let [lo, hi] = self.beside(ray, span)?;
        let first = self.first(ray, [lo, hi], *guess)?;
        *guess = first.x;
        let last = self.first(ray, [hi, lo], first.x)?;
        let (from, to) = (first.s, last.s);
        let whole = self.skew * (first.x - last.x).abs() * (to - from) <= 4.0 * self.stray_mm;
        (from < to).then_some(Covered { from, to, whole })
    }

    /// Part of a stretch of a ray outside of which it is clear: within the slabs between which the body passes and the
    /// circle around its axis.
    fn beside(&self, ray: &Ray, [lo, hi]: [f64; 2]) -> Option<[f64; 2]> {
        let (middle, half) = (0.5 * (lo + hi), 0.5 * (hi - lo));
        // Half of what the place moves over the piece, at most.
        let moves = |k: usize| 0.5 * (ray.way[k] + self.cross[k] * middle).abs() + self.cross[k].abs() * half;
        let moves = [moves(0), moves(1), moves(2)];
        let (radius, base) = (self.body.cutter.radius_mm(), self.body.above_mm);
        let slabs = [[-radius, radius], [-radius, radius], [base, base + self.body.cutter.length_mm()]];
        let (mut lo, mut hi) = (lo, hi);
        for k in 0..3 {
            let [from, to] = [slabs[k][0] - moves[k], slabs[k][1] + moves[k]];
            if self.along[k] == 0.0 {
                if ray.foot[k] < from || ray.foot[k] > to {
                    return None;
                }
                continue;
            }
            let (a, b) = ((from - ray.foot[k]) * self.inverse[k], (to - ray.foot[k]) * self.inverse[k]);
            (lo, hi) = (lo.max(a.min(b)), hi.min(a.max(b)));
        }
        // |foot + s along| = reach in the plane across the axis.
        let (x, y, a, b) = (ray.foot.x, ray.foot.y, self.along.x, self.along.y);
        let reach = radius + moves[0] + moves[1];
        let (square, cross) = (a * a + b * b, x * b - y * a);
        let room = reach * reach * square - cross * cross;
        if square > 0.0 {
            if room < 0.0 {
                return None;
            }
            let (nearest, chord) = (-(x * a + y * b) / square, room.sqrt() / square);
            (lo, hi) = (lo.max(nearest - chord), hi.min(nearest + chord));
        }
        (lo < hi).then_some([lo, hi])
    }

    /// The first covered point from `start` towards `end`, and when it is.
    fn first(&self, ray: &Ray, [start, end]: [f64; 2], guess: f64) -> Option<Found> {
        let sign = (end - start).signum();
        let mut s = start;
        let glance = self.at(ray, guess, s);
        if self.is_clear(&glance, sign, (end - start).abs()) {
            return None;
        }
        let mut here = self.lowest(ray, s, glance, LEVEL_MM - AT_LEVEL_MM);
        if here.value <= LEVEL_MM - AT_LEVEL_MM {
            return Some(Found { s, x: here.x });
        }
        // The last place that is clear, where a bold step was taken from it.
        let mut clear = None;
        let mut bold = true;
        for step in 0..MOST_STEPS {
            let (sure, plain) = (self.skew - sign * here.slope, -sign * here.slope);
            let above = here.value - LEVEL_MM;
            let room = (end - s).abs();
            let slow = bold && step >= MOST_BOLD && above <= 0.0;
            let misses = slow || if above > 0.0 { sure <= 0.0 || above > sure * room } else { plain <= 0.0 };
            if misses {
                // There, or a bold step has passed by what is covered, or lies in it and comes back too slowly.
                (s, here) = clear.take()?;
                bold = false;
                continue;
            }
            let step = match self.bold(&here, above, plain) {
                Some(step) if bold => {
                    if above > 0.0 {
                        clear = Some((s, here));
                    }
                    step
                }
                _ => above / sure,
            };
            s += sign * step.min(room);
            // From within a tangent leads outside again.
            here = self.lowest(ray, s, self.at(ray, here.x, s), LEVEL_MM - AT_LEVEL_MM);
            if (here.value - LEVEL_MM).abs() <= AT_LEVEL_MM || (here.value < LEVEL_MM && !bold) {
                return Some(Found { s, x: here.x });
            }
        }
        // Grazing.
        None
    }

    /// How far along a ray f meets the level by its parabola or, from within, its tangent. None where that is so far that a
    /// point might be passed by that is covered by more than a piece may stray.
    fn bold(&self, here: &Lowest, above: f64, plain: f64) -> Option<f64> {
        let room = plain * plain - 2.0 * above * here.bend;
        let step = if above > 0.0 && room > 0.0 && plain > 0.0 {
            2.0 * above / (plain + room.sqrt())
        } else {
            above / plain
        };
        (self.skew * step.abs() <= self.stray_mm).then_some(step)
    }

    /// Where on the body it met a point of the ray, which it covers.
    pub fn met(&self, ray: &Ray, s: f64) -> Met {
        let near = MET * self.body.cutter.radius_mm();
        let mut here = self.at(ray, -0.5, s);
        // Newton from outside on a convex function.
        for _ in 0..MOST_STEPS {
            if here.local.distance <= near || here.by_x >= 0.0 {
                break;
            }
            let next = here.x - here.local.distance / here.by_x;
            if next >= 0.5 {
                break;
            }
            here = self.at(ray, next, s);
        }
        here.place
    }
}

/// A place on a ray and the instant.
#[derive(Clone, Copy)]
struct Found {
    s: f64,
    x: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::removal::Swept;
    use crate::removal::piece::{Piece, moving};
    use crate::{Cutter, CutterSpec, Pose};
    use proptest::prelude::*;

    fn cutter(kind: usize, r: f64) -> Cutter {
        let (diameter_mm, length_mm) = (10.0, 14.0);
        let spec = match kind {
            0 => CutterSpec::Toroidal { diameter_mm, corner_radius_mm: 5.0 * r, length_mm },
            1 => CutterSpec::Flat { diameter_mm, length_mm },
            2 => CutterSpec::Cone {
                diameter_mm,
                taper_deg: 40.0,
                corner_radius_mm: r,
                tip_diameter_mm: None,
                length_mm,
            },
            _ => CutterSpec::Barrel {
                diameter_mm,
                barrel_radius_mm: 10.0 + 2.0 * r,
                corner_radius_mm: 1.0 + 3.0 * r,
                length_mm,
            },
        };
        Cutter::try_from(spec).unwrap()
    }

    const STRAY_MM: f64 = 4e-3;
    const SPAN: [f64; 2] = [-22.0, 22.0];

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]
        /// What is covered is what frozen poses cover, to what a piece may stray; the sagitta is within twice that:
        /// (30 (0.02^2 + less) + 2 x 0.02 x 1) / 8 mm.
        #[test]
        fn covers_what_poses_cover(
            kind in 0usize..4,
            r in 0.0..=1.0f64,
            tip in prop::array::uniform3(-6.0..6.0f64),
            lean in prop::array::uniform3(-1.0..1.0f64),
            way in prop::array::uniform3(-0.55..0.55f64),
            turn in prop::array::uniform3(-0.01..0.01f64),
            (axis, turns) in (0usize..3, any::<bool>()),
        ) {
            let Some(up) = Unit3::try_new(Vec3::from(lean), 0.2) else { return Ok(()) };
            let turn = if turns { Vec3::from(turn) } else { Vec3::zeros() };
            let turned = |k: f64| if turns { Unit3::new_normalize(up.into_inner() + turn * k) } else { up };
            let from = Pose { tip: Point3::from(tip), axis: turned(-1.0) };
            let to = Pose { tip: from.tip + Vec3::from(way), axis: turned(1.0) };
            let swept = Swept { from, to, rapid: false, block: 1 };
            let cutter = cutter(kind, r);
            let body = Body { cutter: &cutter, above_mm: 0.0, tool: 0, intrudes: false };
            let approach = Approach::new(&swept, &Piece { motion: 0, range: [0.0, 1.0] });
            let view = View { axis, way: to.tip - from.tip, stray_mm: STRAY_MM };
            let glide = Glide::new(body, &approach, &view);
            let ray = glide.ray(&Point3::origin());
            let found = glide.covered(&ray, SPAN, &mut 0.0);
            // Second method: the distance to the poses in between, as the cutter tells it, least by thirds.
            let depth = |s: f64| {
                let mut p = Point3::origin();
                p[axis] = s;
                let at = |t: f64| cutter.distance(&moving(&swept, t).pose, &p);
                let (mut lo, mut hi) = (0.0, 1.0);
                for _ in 0..40 {
                    let (a, b) = ((2.0 * lo + hi) / 3.0, (lo + 2.0 * hi) / 3.0);
                    if at(a) <= at(b) { hi = b } else { lo = a }
                }
                at(lo).min(at(0.0)).min(at(1.0))
            };
            let slack = if turns { STRAY_MM } else { 0.0 } + 5.0 * ENDS_MM;
            for k in 0..=176 {
                let s = SPAN[0] + 0.25 * f64::from(k);
                let d = depth(s);
                let within = found.is_some_and(|f| f.from <= s && s <= f.to);
                prop_assert!(within || d >= -slack, "not covered at {s}: {d}, {found:?}");
                prop_assert!(
                    !within || d <= slack || found.is_some_and(|f| !f.whole),
                    "covered at {s}: {d}, {found:?}"
                );
            }
            if let Some(f) = found {
                for s in [f.from, f.to] {
                    prop_assert!(depth(s).abs() <= slack || SPAN.contains(&s), "{s}: {}", depth(s));
                }
                // Met where the body is, seen from the tool.
                let met = glide.met(&ray, 0.5 * (f.from + f.to));
                let off = body.local(met.x.hypot(met.y), met.z).distance;
                prop_assert!(off <= MET * 5.0 + slack || !f.whole, "{off}");
            }
        }
    }
}
