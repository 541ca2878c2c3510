//! A whole cone of axes at a place: bounds of the distances of a point to the tool over all of them.
//!
//! With n the normal, a the axis, theta the lean between them and m the unit vector at right angles to a in their plane,
//! the point of the tool's axis at the height of the touching arc's centre is
//!
//! `T(a) = x + r n + c m(a)`,
//!
//! r and c being the arc's radius and the distance of its centre from the axis. What a point q has to do with the tool is
//! told by its distance s from the axis and its height z above T. Over a cone of half angle alpha about a0:
//!
//! 1. T moves by `c |m(a) - m(a0)|`. From `dm^2 = dtheta^2 + cos^2 theta dphi^2` and `da^2 = dtheta^2 + sin^2 theta dphi^2`
//!    that is at most `c alpha max(1, cot(theta0 - alpha))`, and, turning first about n and then towards it, at most
//!    `c (alpha + 2 cos(theta0 - alpha) sin(dphi / 2))` with `sin dphi = sin alpha / sin theta0`.
//! 2. Held at T, the angle of q from the axis changes by at most alpha at the same distance. Away from the axis the distance
//!    to a body that goes on upwards without end, and begins no lower than T, grows with that angle; the distance above its
//!    upper end falls. Both ends of the range of angles give bounds. Other bodies are bounded by the chord.
//! 3. Whatever the axis, the cutter lies above the tangent plane, and as far as it is below T inside the sphere that touches
//!    the plane at x with radius `r + c / sin theta`, of which the least lean gives the largest.
//!
//! Near the contact 3 decides, far from it 1 and 2. For a ball c = 0: T stands still and the sphere is the ball.

use super::cones::Cone;
use super::obstacles::Ball;
use super::problem::{Place, Reach, Solid};
use crate::cutter::Cutter;
use crate::meridian::Arc;
use osculate_geom::{Point3, Unit3, Vec3};
use std::f64::consts::PI;

/// The lean of an axis along the normal is known to no more than the root of a rounding, rad.
const LEAN_ROUNDING_RAD: f64 = 1e-7;

/// The angle between the normal of a place and an axis, rad, to a few roundings.
pub(super) fn lean_rad(place: &Place, axis: &Unit3) -> f64 {
    let n = place.normal.into_inner();
    n.cross(axis).norm().atan2(n.dot(axis))
}

/// Whether the lean of some axis of a cone may be within the limits, `lean_rad` being that of its middle.
pub(super) fn may_lean(reach: &Reach<'_>, cone: &Cone, lean_rad: f64) -> bool {
    let apart = cone.angle_rad + LEAN_ROUNDING_RAD;
    lean_rad - apart <= reach.limits.most_lean_rad && lean_rad + apart >= reach.limits.least_lean_rad
}

/// A cone of axes at a place.
pub(super) struct View {
    contact: Point3,
    normal: Vec3,
    axis: Vec3,
    /// T(a0).
    pivot: Point3,
    /// Height of T above the tip, mm.
    pivot_z_mm: f64,
    sin: f64,
    cos: f64,
    /// `2 sin(alpha / 2)`.
    chord: f64,
    /// How far T moves, and the rounding of distances, mm.
    slack_mm: f64,
    rounding_mm: f64,
    /// Radius of the sphere that holds the cutter's lower part, mm; infinite where there is none.
    sphere_mm: f64,
}

/// Where a ball of points stands against the axes of a cone.
pub(super) struct Polar {
    /// Distance from the axis and height above T, mm: of the middle axis, turned towards the axis, turned away from it.
    middle: (f64, f64),
    near: (f64, f64),
    far: (f64, f64),
    /// How far the tool moves there, mm.
    pub move_mm: f64,
    /// Height of the ball's centre above the tangent plane, mm, and its squared distance from the contact, mm2.
    above_mm: f64,
    contact_mm2: f64,
}

/// The one arc that touches over a range of leans; None where several do, or none really.
fn touching(cutter: &Cutter, leans_rad: [f64; 2]) -> Option<Arc> {
    let [a, b] = leans_rad.map(|lean| cutter.touching(lean));
    (a == b && (cutter.is_end_mill() || leans_rad.iter().all(|lean| a.touches_at(*lean)))).then_some(a)
}

impl View {
    /// The cone's axes that lean within the limits; None where no one arc of the cutter serves them all.
    pub fn new(reach: &Reach<'_>, place: &Place, cone: &Cone, lean_rad: f64) -> Option<Self> {
        let alpha = cone.angle_rad;
        let (n, a) = (place.normal.into_inner(), cone.axis.into_inner());
        let least = (lean_rad - alpha).max(reach.limits.least_lean_rad) - LEAN_ROUNDING_RAD;
        let most = (lean_rad + alpha).min(reach.limits.most_lean_rad) + LEAN_ROUNDING_RAD;
        let cutter = &reach.solids[0].shape;
        let arc = touching(cutter, [least.max(0.0), most])?;
        let (r, c) = (arc.radius_mm, arc.centre_rho_mm);
        let across = n - a * n.dot(&a);
        let sine = across.norm();
        let m = if sine > 0.0 { across / sine } else { Vec3::zeros() };
        let (sin, cos) = if alpha < PI { alpha.sin_cos() } else { (0.0, -1.0) };
        let rounding_mm = reach.rounding_mm(place);
        let turn = if c == 0.0 { 0.0 } else { turn_of_m(alpha, lean_rad) };
        let is_held = cutter.is_end_mill() && least > 0.0;
        Some(Self {
            contact: place.point,
            normal: n,
            axis: a,
            pivot: place.point + n * r + m * c,
            pivot_z_mm: arc.centre_z_mm,
            sin,
            cos,
            chord: 2.0 * (0.5 * alpha).sin(),
            slack_mm: c.abs() * turn + rounding_mm,
            rounding_mm,
            sphere_mm: if c == 0.0 && cutter.is_end_mill() {
                r
            } else if is_held {
                r + c / least.sin()
            } else {
                f64::INFINITY
            },
        })
    }

    /// Where a ball of points stands.
    #[inline]
    pub fn polar(&self, ball: &Ball) -> Polar {
        let u = ball.centre - self.contact;
        let w = ball.centre - self.pivot;
        let z = w.dot(&self.axis);
        let s2 = (w - self.axis * z).norm_squared();
        let (s, apart) = (s2.sqrt(), (s2 + z * z).sqrt());
        let inner = s * self.cos - z * self.sin;
        let outer = s * self.cos + z * self.sin;
        Polar {
            middle: (s, z),
            near: if inner < 0.0 { (0.0, apart) } else { (inner, z * self.cos + s * self.sin) },
            far: if outer < 0.0 { (0.0, -apart) } else { (outer, z * self.cos - s * self.sin) },
            move_mm: self.chord * apart + self.slack_mm,
            above_mm: u.dot(&self.normal),
            contact_mm2: u.norm_squared(),
        }
    }

    /// The least distance of a ball's centre from a body over all axes of the cone, or less, mm.
    #[inline]
    pub fn least_mm(&self, at: &Polar, solid: &Solid) -> f64 {
        let off = solid.base_mm - self.pivot_z_mm;
        let shape = &solid.shape;
        if grows(shape, off) {
            let side = shape.local_endless_distance(at.near.0, at.near.1 - off);
            side.max(at.far.1 - off - shape.length_mm()) - self.slack_mm
        } else {
            shape.local_distance(at.middle.0, at.middle.1 - off) - at.move_mm
        }
    }

    /// The greatest distance of a ball's centre from a body over all axes of the cone, or more, mm.
    #[inline]
    pub fn most_mm(&self, at: &Polar, solid: &Solid) -> f64 {
        let off = solid.base_mm - self.pivot_z_mm;
        let shape = &solid.shape;
        if grows(shape, off) {
            let side = shape.local_endless_distance(at.far.0, at.far.1 - off);
            side.max(at.near.1 - off - shape.length_mm()) + self.slack_mm
        } else {
            shape.local_distance(at.middle.0, at.middle.1 - off) + at.move_mm
        }
    }

    /// A lower bound of the distance of all points of a ball from the cutter, from where the contact is alone.
    #[inline]
    pub fn least_at_contact_mm(&self, at: &Polar, ball: &Ball) -> f64 {
        let big = self.sphere_mm;
        let plane = -at.above_mm;
        let is_below = at.near.1 + self.slack_mm + ball.radius_mm <= 0.0;
        let least = if is_below && big.is_finite() {
            let power = at.contact_mm2 - 2.0 * big * at.above_mm;
            let sphere = power / ((power + big * big).max(0.0).sqrt() + big);
            sphere.max(plane)
        } else {
            plane
        };
        least - ball.radius_mm - self.rounding_mm
    }
}

/// Whether the distance to a body, its lower end at the height `off_mm` above T, grows with the angle from the axis.
#[inline]
fn grows(shape: &Cutter, off_mm: f64) -> bool {
    shape.is_end_mill() && off_mm + shape.corner_mm() >= 0.0
}

/// A bound of `|m(a) - m(a0)|` over a cone about an axis of a lean.
fn turn_of_m(alpha_rad: f64, lean_rad: f64) -> f64 {
    let least = lean_rad - alpha_rad;
    if least <= LEAN_ROUNDING_RAD {
        return 2.0;
    }
    let (sin, cos) = least.sin_cos();
    let along = alpha_rad * (cos / sin).max(1.0);
    // least > 0, so that alpha is less than the lean; beyond a right angle of lean any turn about n is possible.
    let about = if lean_rad < std::f64::consts::FRAC_PI_2 {
        2.0 * (0.5 * (alpha_rad.sin() / lean_rad.sin()).min(1.0).asin()).sin()
    } else {
        2.0
    };
    along.min(alpha_rad + about).min(2.0)
}
