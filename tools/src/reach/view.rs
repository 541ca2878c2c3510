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
use osculate_geom::{Point3, Vec3};
use std::f64::consts::PI;

/// The lean of an axis along the normal is known to no more than the root of a rounding, rad.
const LEAN_ROUNDING_RAD: f64 = 1e-7;

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
    /// Depth below the tangent plane, and depth below the sphere, less the ball's radius, mm.
    above_mm: f64,
    contact_mm2: f64,
}

/// Bounds of the distance of a ball's centre from a body, mm.
#[derive(Clone, Copy)]
pub(super) struct Range {
    pub least_mm: f64,
    pub most_mm: f64,
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

    /// Bounds of the distance of a ball's centre from a body over all axes of the cone.
    pub fn range(&self, at: &Polar, solid: &Solid) -> Range {
        let off = solid.base_mm - self.pivot_z_mm;
        let (shape, slack) = (&solid.shape, self.slack_mm);
        if shape.is_end_mill() && off + shape.corner_mm() >= 0.0 {
            let top = off + shape.length_mm();
            let ends = [at.near, at.far].map(|(s, z)| shape.local_endless_distance(s, z - off));
            Range {
                least_mm: ends[0].max(at.far.1 - top) - slack,
                most_mm: ends[1].max(at.near.1 - top) + slack,
            }
        } else {
            let middle = shape.local_distance(at.middle.0, at.middle.1 - off);
            Range { least_mm: middle - at.move_mm, most_mm: middle + at.move_mm }
        }
    }

    /// A lower bound of the distance of all points of a ball from the cutter, from where the contact is alone.
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
