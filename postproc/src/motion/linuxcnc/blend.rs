//! What happens between two pieces: straight on over a kink, round on an arc, or parabolically.
//!
//! A kink is passed without slowing down if the jump of the velocity within one step stays below a share of the axes'
//! acceleration. Otherwise three speeds are compared: over the kink, along an inscribed arc, and half of that through
//! a parabolic blend (which halves the acceleration of both pieces); the fastest one wins. With the half angle theta
//! between the pieces and the tolerance T, an inscribed arc touches them at most at
//!
//! ```text
//! d = min(L_1, L_2, cos(theta) T / (1 - sin(theta))),   R = d tan(theta),   v^2 <= a_n R
//! ```
//!
//! Pieces on which rotary axes move are always blended parabolically.

use osculate_geom::Vec3;

use super::Planner;
use super::segment::{End, NORMAL_SHARE, Run, Segment, Shape, TANGENTIAL_SHARE, half_angle, join};

/// Reversals within this angle stop, squared: 2 degrees.
const REVERSAL: f64 = (2.0 * std::f64::consts::PI / 180.0) * (2.0 * std::f64::consts::PI / 180.0);
/// A kink may take this share of the acceleration.
const KINK_SHARE: f64 = 0.1;
/// Nothing is blended where the pieces enclose an angle nearer than this to 0 or 180 degrees, rad.
const LEAST_ANGLE: f64 = 1e-6;
/// A parabolic blend looks at its tolerance only where the angle differs from straight on by more than this, rad.
const LEAST_ARC_ANGLE: f64 = 1e-3;
/// An arc shorter than this, mm, is left out.
const LEAST_ARC_MM: f64 = 1e-6;
/// A piece that would take fewer steps than this before an arc becomes part of the arc.
const GAP_STEPS: f64 = 4.0;

/// An arc to be put between two pieces.
struct Arc {
    segment: Segment,
    trim_mm: f64,
    /// The first piece becomes part of the arc.
    swallows: bool,
}

impl Planner {
    /// Joins the new piece to the last one of the queue; an arc between them goes into the queue.
    pub(super) fn blend(&mut self, next: &mut Segment) {
        let Some(mut last) = self.queue.pop_back() else { return };
        if last.rapid != next.rapid {
            join(&mut last, next, End::Stop);
        }
        let started = last.run.done > 0.5 * last.length;
        let mut arc = None;
        let straight = !(last.rotary || next.rotary);
        if !started && straight && last.ends != End::Stop && !self.over_kink(&mut last, next) {
            arc = self.best(&mut last, next);
        }
        match arc {
            None => {
                last.finalize(self.step_s);
                self.queue.push_back(last);
            }
            Some(arc) => self.insert(last, arc, next),
        }
    }

    /// Whether the pieces go on without slowing down, or stop; sets the speed over the kink.
    fn over_kink(&self, last: &mut Segment, next: &mut Segment) -> bool {
        if (last.end + next.start).norm_squared() < REVERSAL {
            join(last, next, End::Stop);
            return true;
        }
        let v = last.target(f64::INFINITY).min(next.target(f64::INFINITY));
        let jump = (next.start - last.end) * (v / self.step_s + next.acceleration);
        let mut share = (0..3).map(|k| jump[k].abs() / self.acceleration_mm_s2[k]).fold(0.0, f64::max);
        if [&last.shape, &next.shape].into_iter().any(|s| matches!(s, Shape::Circle { .. })) {
            share /= TANGENTIAL_SHARE;
        }
        let tangent = share < KINK_SHARE;
        let taken = share.min(KINK_SHARE);
        last.kink = Some(if tangent { v } else { v * KINK_SHARE / share });
        last.kink_share[1] = last.kink_share[1].max(taken);
        next.kink_share[0] = next.kink_share[0].max(taken);
        if tangent {
            join(last, next, End::Tangent);
        }
        tangent
    }

    /// The fastest of the three ways.
    fn best(&self, last: &mut Segment, next: &mut Segment) -> Option<Arc> {
        if last.ends == End::Exact {
            return None;
        }
        let arc = self.arc(last, next);
        let caps = [last.target(self.cap_mm_s), next.target(self.cap_mm_s)];
        let (v1, v2, theta) = blend_speeds(last, next, caps);
        let parabolic = 0.5 * theta.sin() * 0.5 * (v1 + v2);
        let tangent = last.kink.unwrap_or(0.0);
        let round = arc.as_ref().map_or(0.0, |a| a.segment.greatest);
        if tangent > parabolic && tangent >= round {
            join(last, next, End::Tangent);
            return None;
        }
        last.kink = None;
        last.kink_share[1] = 0.0;
        next.kink_share[0] = 0.0;
        if round > parabolic {
            return arc;
        }
        join(last, next, End::Parabolic);
        None
    }

    /// The inscribed arc, where there is one.
    fn arc(&self, last: &Segment, next: &Segment) -> Option<Arc> {
        if last.final_length {
            return None;
        }
        let (u1, u2) = (last.end, next.start);
        let theta = half_angle(&u1, &u2);
        if theta < LEAST_ANGLE || std::f64::consts::FRAC_PI_2 - theta < LEAST_ANGLE {
            return None;
        }
        let phi = std::f64::consts::PI - 2.0 * theta;
        let binormal = u1.cross(&u2).normalize();
        let lines = [last, next].iter().all(|s| matches!(s.shape, Shape::Line { .. }));
        // A circle must lie in the plane of the corner; near it, it is taken for its tangent.
        let flat = |s: &Segment| match s.shape {
            Shape::Circle { normal, .. } => normal.cross(&binormal).norm() < LEAST_ANGLE,
            _ => true,
        };
        if !(flat(last) && flat(next)) {
            return None;
        }
        let tolerance = blend_tolerance(last, next);
        let a = inscribed(&binormal, &self.acceleration_mm_s2);
        let v = self.goal(last, next, &binormal, if lines { Some(phi) } else { None });
        let d = last.length.min(0.5 * last.nominal).min(0.5 * next.length);
        let d = d.min(theta.cos() * tolerance / (1.0 - theta.sin()));
        let r = theta.tan() * d;
        let v = v.min((NORMAL_SHARE * a * r).sqrt());
        // No wider than a parabolic blend would be.
        let half = 0.5 * a;
        let wide = (2.0 * half * d).sqrt().min(v) / half * v / phi;
        let radius = (v * v / (NORMAL_SHARE * a)).max(wide.min(r));
        let trim_mm = radius / theta.tan();
        if radius.is_nan() || radius * phi < LEAST_ARC_MM {
            return None;
        }
        let left = last.length - trim_mm;
        let straight = matches!(last.shape, Shape::Line { .. });
        let swallows = straight && left / v < GAP_STEPS * self.step_s && !last.blended_into;
        let length = radius * phi + if swallows { left } else { 0.0 };
        let wanted = last.target(f64::INFINITY).max(next.target(f64::INFINITY));
        let mut segment = Segment {
            of: last.of,
            rapid: last.rapid,
            shape: Shape::Blend,
            start: u1,
            end: u2,
            rotary: false,
            pure_rotary: false,
            length,
            nominal: length,
            wanted,
            greatest: v,
            acceleration: a,
            tolerance_mm: last.tolerance_mm,
            ends: End::Tangent,
            blended_into: false,
            kink: None,
            kink_share: [0.0; 2],
            tangential: TANGENTIAL_SHARE,
            final_length: false,
            out: 0.0,
            run: Run::default(),
        };
        segment.finalize(self.step_s);
        Some(Arc { segment, trim_mm, swallows })
    }

    /// The greatest speed that the two pieces and the axes allow in the plane of the corner; between lines by their
    /// own speeds and the angle they turn by, too.
    fn goal(&self, last: &Segment, next: &Segment, binormal: &Vec3, phi: Option<f64>) -> f64 {
        let asked = last.target(f64::INFINITY).max(next.target(f64::INFINITY));
        let planar = inscribed(binormal, &self.velocity_mm_s);
        let Some(phi) = phi else { return asked.min(planar) };
        let c = phi.min(0.49 * std::f64::consts::PI).cos();
        let v1 = last.greatest.min(next.greatest / c);
        let v2 = next.greatest.min(last.greatest / c);
        // Altitude of the triangle of both velocities.
        let base = (next.start * v2 - last.end * v1).norm();
        asked.min((v1 * v2 * phi.sin() / base).max(planar))
    }

    fn insert(&mut self, mut last: Segment, arc: Arc, next: &mut Segment) {
        if let Shape::Line { from, to } = &mut next.shape {
            *from += next.start * arc.trim_mm;
            next.length = (*to - *from).norm();
        } else {
            next.length -= arc.trim_mm;
        }
        next.blended_into = false;
        if !arc.swallows {
            if let Shape::Line { to, .. } = &mut last.shape {
                *to -= last.end * arc.trim_mm;
            }
            last.length -= arc.trim_mm;
            join(&mut last, next, End::Tangent);
            last.finalize(self.step_s);
            self.queue.push_back(last);
        }
        self.queue.push_back(arc.segment);
    }
}

/// Speeds at which a parabolic blend of the two starts and ends, with the half angle between them.
pub(super) fn blend_speeds(last: &Segment, next: &Segment, targets: [f64; 2]) -> (f64, f64, f64) {
    let (a1, a2) = (last.along(), next.along());
    let r1 = last.triangle().min(targets[0]);
    let r2 = next.triangle().min(targets[1]);
    let longest = (last.length / r1).min(next.length / r2);
    let t = longest.min((r1 / a1).max(r2 / a2));
    let (mut v1, mut v2) = (r1.min(t * a1), r2.min(t * a2));
    let theta = half_angle(&last.end, &next.start);
    if last.tolerance_mm > 0.0 && theta.cos() > LEAST_ARC_ANGLE.sin() {
        // Slowing down at a passes 2 T / cos(theta) before the corner at this speed.
        let v = 2.0 * (a1 * last.tolerance_mm / theta.cos()).sqrt();
        v1 = v1.min(v);
        v2 = v2.min(v);
    }
    (v1, v2, theta)
}

/// How far the corner may be left: a quarter of either piece at most.
fn blend_tolerance(last: &Segment, next: &Segment) -> f64 {
    let quarter = 0.25 * last.nominal.min(next.nominal);
    let own = |s: &Segment| if s.tolerance_mm == 0.0 { 0.25 * s.nominal } else { s.tolerance_mm };
    own(last).min(own(next)).min(quarter)
}

/// Radius of the largest circle about the origin in the plane across `normal` inside the box of these half extents.
fn inscribed(normal: &Vec3, extents: &[f64; 3]) -> f64 {
    let across = |k: usize| {
        let mut e = -normal * normal[k];
        e[k] += 1.0;
        // Along the normal the axis does not take part.
        extents[k] / e.norm().max(1e-12)
    };
    (0..3).map(across).fold(f64::INFINITY, f64::min)
}
