//! From an axis surface to poses of a cutter: how deep it reaches, how long it must be, and where the path needs points.
//!
//! Tip and axis move linearly between points. A step is halved until, halfway, the axis is within the chord tolerance of
//! where it should be, at the tip and at the upper end of the face. Before and after the motion the cutter goes straight on along
//! the directions that both guiding curves have at its ends.

use crate::cutter::Cutter;
use crate::flank::axes::{AxisPoints, AxisSurface};
use crate::flank::envelope::{Envelope, Scratch};
use crate::pose::Pose;
use osculate_geom::{Interval, Point3, Surface, Unit3, Vec3, uv};

/// Most halvings of a step.
const MOST_HALVINGS: u32 = 12;
/// Steps of the motion before halving, and along its ends.
const FIRST_STEPS: usize = 64;
/// Rules looked at for the reach.
const RULES: usize = 200;

/// Heights on the axis, from Q0, between which the cutter touches a face, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Reach {
    /// The lowest contact.
    pub lowest_mm: f64,
    /// The highest contact.
    pub highest_mm: f64,
}

impl Reach {
    /// The heights at which a moving flank meets the ends of the rules over a range of u.
    #[must_use]
    pub fn of(envelope: &Envelope<'_>, surface: &dyn Surface, u: Interval) -> Option<Self> {
        let mut scratch = Scratch::default();
        let mut out: Option<Self> = None;
        for k in 0..=RULES {
            for v in [0.0, 1.0] {
                let p = surface.point(uv(u.at(k as f64 / RULES as f64), v));
                let z = envelope.nearest(&p, &mut scratch)?.foot_mm;
                let r = out.get_or_insert(Self { lowest_mm: z, highest_mm: z });
                r.lowest_mm = r.lowest_mm.min(z);
                r.highest_mm = r.highest_mm.max(z);
            }
        }
        out
    }

    /// Where the tip of an end mill goes so that its straight side begins `below_mm` under the lowest contact, from Q0.
    #[must_use]
    pub fn tip_mm(&self, cutter: &Cutter, below_mm: f64) -> f64 {
        self.lowest_mm - below_mm - cutter.corner_mm()
    }

    /// How long a cutter with its tip there must be to reach `above_mm` over the highest contact.
    #[must_use]
    pub fn length_mm(&self, tip_mm: f64, above_mm: f64) -> f64 {
        self.highest_mm + above_mm - tip_mm
    }
}

/// How a motion becomes poses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepping {
    /// Height of the tip on the axis from Q0, mm.
    pub tip_mm: f64,
    /// Height from Q0 up to which the axis must be right, mm.
    pub top_mm: f64,
    /// Chord tolerance, mm.
    pub chord_mm: f64,
    /// Straight way before and after the motion, mm at Q0.
    pub lead_mm: f64,
}

/// A pose with its place in the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// The parameter of the axis surface, that of the nearer end on the ways before and after it.
    pub tau: f64,
    /// The pose.
    pub pose: Pose,
}

/// The axis at a parameter, straight on beyond the range: the point at Q0 and the unit direction.
fn axis(axes: &AxisSurface, tau: f64) -> (Vec3, Vec3) {
    let inside = axes.range().bring(tau);
    let j = axes.jet(inside);
    let beyond = tau - inside;
    let lower = j.lower + j.lower_rate * beyond;
    let upper = j.lower + j.direction * j.length + j.upper_rate * beyond;
    (lower, (upper - lower).normalize())
}

fn pose(axes: &AxisSurface, tau: f64, tip_mm: f64) -> Pose {
    let (lower, direction) = axis(axes, tau);
    Pose { tip: Point3::from(lower + direction * tip_mm), axis: Unit3::new_unchecked(direction) }
}

/// The axis at a parameter, straight on beyond the range of a surface.
#[must_use]
pub fn beyond(axes: &AxisSurface, tau: f64) -> AxisPoints {
    let (lower, direction) = axis(axes, tau);
    let length = axes.jet(tau).length;
    AxisPoints { lower: lower.into(), upper: (lower + direction * length).into() }
}

/// By how much of the parameter the straight ways of a length at Q0 reach beyond both ends of the range.
#[must_use]
pub fn way_parameter(axes: &AxisSurface, lead_mm: f64) -> [f64; 2] {
    let range = axes.range();
    [range.lo, range.hi].map(|tau| {
        let rate = axes.jet(tau).lower_rate.norm();
        if lead_mm > 0.0 && rate > 0.0 { lead_mm / rate } else { 0.0 }
    })
}

/// Poses along a motion, straight ways before and after it included.
#[must_use]
pub fn poses(axes: &AxisSurface, s: &Stepping) -> Vec<Placed> {
    let range = axes.range();
    let ways = way_parameter(axes, s.lead_mm);
    let (first, last) = (range.lo - ways[0], range.hi + ways[1]);
    let mut marks: Vec<f64> = (0..=FIRST_STEPS).map(|k| range.at(k as f64 / FIRST_STEPS as f64)).collect();
    // The straight ways turn the axis a little, too: halving takes care of it.
    if first < range.lo {
        marks.insert(0, first);
    }
    if last > range.hi {
        marks.push(last);
    }
    let at = |tau: f64| Placed { tau: range.bring(tau), pose: pose(axes, tau, s.tip_mm) };
    let mut out = vec![at(marks[0])];
    for w in marks.windows(2) {
        halve(axes, s, [w[0], w[1]], 0, &mut |tau| out.push(at(tau)));
    }
    out
}

/// Visits the ends of the pieces of a step, its own beginning left out.
fn halve(axes: &AxisSurface, s: &Stepping, [a, b]: [f64; 2], depth: u32, see: &mut dyn FnMut(f64)) {
    let middle = 0.5 * (a + b);
    let [pa, pm, pb] = [a, middle, b].map(|tau| pose(axes, tau, s.tip_mm));
    let height = s.top_mm - s.tip_mm;
    // The linear motion at its middle: tips and axes averaged, the axis renormalised.
    let tip = Point3::from((pa.tip.coords + pb.tip.coords) / 2.0);
    let direction = (pa.axis.into_inner() + pb.axis.into_inner()).normalize();
    let low = (tip - pm.tip).norm();
    let high = ((tip + direction * height) - (pm.tip + pm.axis.into_inner() * height)).norm();
    if low.max(high) > s.chord_mm && depth < MOST_HALVINGS {
        halve(axes, s, [a, middle], depth + 1, see);
        halve(axes, s, [middle, b], depth + 1, see);
    } else {
        see(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poses_keep_the_chord_tolerance_and_lead_in_straight() {
        let range = Interval::new(0.0, 1.0);
        let line = |u: f64| {
            let (s, c) = (1.3 * u).sin_cos();
            let p = Point3::new(60.0 * s, 60.0 * c, 0.0);
            AxisPoints { lower: p, upper: p + Vec3::new(8.0 * u, 3.0, 40.0) }
        };
        let places: Vec<AxisPoints> = (0..=80).map(|k| line(f64::from(k) / 80.0)).collect();
        let axes = AxisSurface::along(range, &places).unwrap();
        let s = Stepping { tip_mm: -5.0, top_mm: 40.0, chord_mm: 1e-3, lead_mm: 12.0 };
        let all = poses(&axes, &s);
        assert!(all.len() > 100 && all.len() < 400, "{}", all.len());
        let way = (all[0].pose.tip - all[1].pose.tip).norm();
        assert!((way - 12.0).abs() < 0.5);
        for w in all.windows(2) {
            if w[0].tau == w[1].tau {
                continue;
            }
            for t in [0.25, 0.5, 0.75] {
                let tau = w[0].tau + t * (w[1].tau - w[0].tau);
                let want = axes.pose(tau, s.tip_mm);
                let tip = w[0].pose.tip + (w[1].pose.tip - w[0].pose.tip) * t;
                assert!((tip - want.tip).norm() < 1.01e-3);
            }
        }
    }
}
