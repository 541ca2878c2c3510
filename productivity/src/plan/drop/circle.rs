//! Where a flat end rests on its edge: the highest place of a face under a circle.
//!
//! Under the flat bottom the height of the tip is the greatest height of the face within the disc, which on a slope lies on
//! the circle itself. There the height's gradient is along that of the distance from the axis:
//! `z_u q_v - z_v q_u = 0`, `q = x^2 + y^2 = R^2`, two equations that Newton solves with the face's second derivatives.

use super::frame::Frame;
use osculate_geom::solve::general;
use osculate_geom::{Surface, Uv, uv};

/// Steps of Newton: quadratic convergence needs a few.
const STEPS: usize = 12;
/// The circle is met to this part of its radius.
const MET: f64 = 1e-9;

/// A circle in the frame's plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Circle {
    pub centre: [f64; 2],
    pub radius_mm: f64,
}

/// The place of the face near `at` that is highest on the circle, and its height; None where Newton does not get there, or
/// leaves the face.
pub(super) fn highest(surface: &dyn Surface, frame: &Frame, circle: &Circle, at: Uv) -> Option<(Uv, f64)> {
    let (domain, r2) = (surface.domain(), circle.radius_mm * circle.radius_mm);
    let mut here = at;
    for _ in 0..STEPS {
        let jet = surface.jet2(here);
        let p = frame.of(&jet.point);
        let w = [p[0] - circle.centre[0], p[1] - circle.centre[1]];
        let [du, dv] = [frame.along(&jet.du), frame.along(&jet.dv)];
        let [duu, duv, dvv] = [&jet.duu, &jet.duv, &jet.dvv].map(|d| frame.along(d));
        let plan = |a: [f64; 3]| 2.0 * (w[0] * a[0] + w[1] * a[1]);
        let both = |a: [f64; 3], b: [f64; 3]| 2.0 * (a[0] * b[0] + a[1] * b[1]);
        let (qu, qv) = (plan(du), plan(dv));
        let [quu, quv, qvv] = [both(du, du) + plan(duu), both(du, dv) + plan(duv), both(dv, dv) + plan(dvv)];
        let off = [w[0] * w[0] + w[1] * w[1] - r2, du[2] * qv - dv[2] * qu];
        let bend = [
            duu[2] * qv + du[2] * quv - duv[2] * qu - dv[2] * quu,
            duv[2] * qv + du[2] * qvv - dvv[2] * qu - dv[2] * quv,
        ];
        let step = general([[qu, qv], bend], off).map(|x| -x);
        if !(step[0].is_finite() && step[1].is_finite()) {
            return None;
        }
        let moved = (jet.du.norm() * step[0]).hypot(jet.dv.norm() * step[1]);
        if moved > circle.radius_mm {
            return None;
        }
        here = domain.bring(uv(here.u + step[0], here.v + step[1]));
        if moved <= MET * circle.radius_mm {
            let p = frame.of(&surface.point(here));
            let out = (p[0] - circle.centre[0]).hypot(p[1] - circle.centre[1]) - circle.radius_mm;
            // Held on the border of the face, the place may be off the circle.
            let met = out.abs() <= 10.0 * MET * circle.radius_mm;
            return (met && surface.contains(here)).then_some((here, p[2]));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::analytic::Paraboloid;
    use osculate_geom::{Surface, Vec3};

    /// On z = a x^2 under a circle beside the axis the highest place is where the circle reaches furthest along x.
    #[test]
    fn the_highest_place_of_a_trough() {
        let trough = Paraboloid::new([0.02, 0.0], 20.0).unwrap();
        let frame = Frame::new(Vec3::z_axis(), &Vec3::x());
        let circle = Circle { centre: [3.0, 1.0], radius_mm: 4.0 };
        let (at, z) = highest(&trough, &frame, &circle, uv(6.3, 2.0)).unwrap();
        assert!((z - 0.02 * 49.0).abs() < 1e-9 && (trough.point(at).x - 7.0).abs() < 1e-7);
    }
}
