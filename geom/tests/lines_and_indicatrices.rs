//! Lines on surfaces between Darboux and Frenet, and the indicatrices against the strips that they speak of.

use osculate_geom::analytic::{Cylinder, Ellipsoid, Paraboloid, Sphere, Torus};
use osculate_geom::indicatrix::{Conformity, DupinKind, dupin_kind, dupin_root_mm};
use osculate_geom::line::{IsoLine, PathLine, PathState, SurfaceLine};
use osculate_geom::{
    Axis, Curve, Forms, Interval, Relative, Surface, ToolCurvature, Unit3, line_curvature, uv,
};
use proptest::prelude::*;
use std::f64::consts::PI;

fn direction(forms: &Forms, angle: f64) -> Unit3 {
    let (s, c) = angle.sin_cos();
    Unit3::new_normalize(forms.frame[0].into_inner() * c + forms.frame[1].into_inner() * s)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    /// Meusnier and his like: an isoparametric line's curvature in space from normal and geodesic curvature, its torsion
    /// from the geodesic torsion and the turn of its principal normal.
    #[test]
    fn darboux_and_frenet_agree(fu in 0.05..0.95f64, fv in 0.15..0.85f64, along_u in any::<bool>()) {
        let kinds: [Box<dyn Surface>; 3] = [
            Box::new(Ellipsoid::new([3.0, 2.0, 1.0]).unwrap()),
            Box::new(Torus::new(5.0, 2.0).unwrap()),
            Box::new(Paraboloid::new([0.3, -0.2], 2.0).unwrap()),
        ];
        for s in kinds {
            let at = s.domain().at(fu, fv);
            let (along, t, fixed) = if along_u { (Axis::U, at.u, at.v) } else { (Axis::V, at.v, at.u) };
            let line = IsoLine { surface: &*s, along, fixed, reversed: false };
            let rate = osculate_geom::Uv::from_axis(along, 1.0, 0.0);
            let c = line_curvature(&s.jet2(at), rate, uv(0.0, 0.0)).unwrap();
            let f = line.jet(t).frenet().unwrap();
            let k2 = c.normal_per_mm.powi(2) + c.geodesic_per_mm.powi(2);
            prop_assert!((k2 - f.curvature_per_mm.powi(2)).abs() < 1e-12 * (1.0 + k2));
            let turn = |t: f64| {
                let n = line.jet(t).frenet().unwrap();
                let d = line.frame(t).unwrap().0;
                n.normal.dot(&d.left).atan2(n.normal.dot(&d.normal))
            };
            let h = 1e-5;
            let mut step = turn(t + h) - turn(t - h);
            step -= (step / (2.0 * PI)).round() * 2.0 * PI;
            let speed = line.jet(t).first.norm();
            // From n towards b = n x t is a negative turn about t.
            let want = -step / (2.0 * h * speed) - c.torsion_per_mm;
            prop_assert!((f.torsion_per_mm - want).abs() < 1e-7 * (1.0 + want.abs()), "{} {want}", f.torsion_per_mm);
        }
    }

    /// Any path: the frame's angular velocity against differences of the frame.
    #[test]
    fn frames_along_any_path_turn_as_they_say(f in 0.1..0.9f64, a in 0.1..1.0f64, b in -1.0..1.0f64) {
        let s = Ellipsoid::new([3.0, 2.0, 1.0]).unwrap();
        let path = |t: f64| PathState {
            at: uv(1.0 + a * t + 0.3 * t * t, 0.2 + b * t - 0.1 * t * t * t),
            rate: uv(a + 0.6 * t, b - 0.3 * t * t),
            acceleration: uv(0.6, -0.6 * t),
        };
        let line = PathLine { surface: &s, path };
        let h = 1e-5;
        let (here, speed) = line.frame(f).unwrap();
        let (x, y) = (line.frame(f - h).unwrap().0, line.frame(f + h).unwrap().0);
        for (p, q, now) in [(x.tangent, y.tangent, here.tangent), (x.normal, y.normal, here.normal)] {
            let rate = (q.into_inner() - p.into_inner()) / (2.0 * h);
            prop_assert!((rate - here.turn.cross(&now) * speed).norm() < 1e-7 * (1.0 + here.turn.norm()));
        }
    }

    #[test]
    fn dupins_radius_is_eulers(fu in 0.0..1.0f64, fv in 0.1..0.9f64, angle in 0.0..PI) {
        let s = Torus::new(5.0, 2.0).unwrap();
        let forms = s.jet2(s.domain().at(fu, fv)).forms().unwrap();
        let p = forms.principal();
        let d = p.d_max.into_inner() * angle.cos() + p.d_min.into_inner() * angle.sin();
        let k = p.euler(angle);
        let r = dupin_root_mm(&forms, &d);
        prop_assert!((r * r * k.abs() - 1.0).abs() < 1e-9 && r.signum() == k.signum());
    }

    /// A ball in a concave part: the direction of R97's claim is that of the widest strip. On a convex part it is the
    /// direction of the narrowest.
    #[test]
    fn the_claim_for_a_ball(fu in 0.0..1.0f64, p1 in 0.01..0.4f64, p2 in 0.01..0.4f64, t in 0.42..2.0f64) {
        prop_assume!((p1 - p2).abs() > 0.01);
        for (sign, want) in [(1.0, 0.0), (-1.0, 0.5 * PI)] {
            let part = Paraboloid::new([0.5 * sign * p1, 0.5 * sign * p2], 1.0).unwrap();
            let forms = part.jet2(uv(0.0, 0.0)).forms().unwrap();
            let tool = ToolCurvature { along: t, across: t, direction: direction(&forms, fu * PI) };
            let claim = Conformity::new(forms, tool).claim();
            // Golden section on a minimum settles to the root of rounding.
            prop_assert!((claim.off_rad - want).abs() < 1e-5, "{}", claim.off_rad);
        }
    }

    /// The radius vanishes exactly where the surfaces osculate.
    #[test]
    fn a_radius_of_zero_is_osculation(p1 in 0.1..0.2f64, p2 in 0.01..0.05f64, t in 0.06..0.09f64) {
        let part = Paraboloid::new([0.5 * p1, 0.5 * p2], 1.0).unwrap();
        let forms = part.jet2(uv(0.0, 0.0)).forms().unwrap();
        let tool = ToolCurvature { along: t, across: t, direction: forms.frame[0] };
        let both = Conformity::new(forms, tool);
        // k_P = -t at cos^2 = (t - p2) / (p1 - p2) from the first principal direction.
        let d = direction(&forms, ((t - p2) / (p1 - p2)).sqrt().acos());
        prop_assert!(both.root_mm(&d).abs() < 1e-7);
        prop_assert!(Relative::new(&forms, &tool).along(&d).abs() < 1e-15);
    }
}

#[test]
fn kinds_of_dupins_indicatrix() {
    let kind =
        |s: &dyn Surface, u: f64, v: f64| dupin_kind(&s.jet2(uv(u, v)).forms().unwrap().principal(), 1e-12);
    let torus = Torus::new(5.0, 2.0).unwrap();
    assert_eq!(kind(&torus, 0.3, 0.5), DupinKind::Ellipse);
    assert_eq!(kind(&torus, 0.3, 3.0), DupinKind::Hyperbolas);
    assert_eq!(
        kind(&Cylinder::new(2.0, Interval::new(0.0, 1.0)).unwrap(), 0.3, 0.5),
        DupinKind::ParallelLines
    );
    assert_eq!(kind(&Paraboloid::new([0.0, 0.0], 1.0).unwrap(), 0.3, 0.5), DupinKind::Flat);
    // An asymptotic direction has no radius.
    let wall = Cylinder::new(2.0, Interval::new(0.0, 1.0)).unwrap();
    let jet = wall.jet2(uv(0.3, 0.5));
    assert!(dupin_root_mm(&jet.forms().unwrap(), &jet.dv).is_infinite());
    let ball = Sphere::new(9.0).unwrap().jet2(uv(0.3, 0.5));
    assert!((dupin_root_mm(&ball.forms().unwrap(), &ball.du) - 3.0).abs() < 1e-14);
}

#[test]
fn the_claim_fails_in_a_concave_part_with_common_directions() {
    let s = Paraboloid::new([0.005, 0.01], 1.0).unwrap();
    let forms = s.jet2(uv(0.0, 0.0)).forms().unwrap();
    let tool = ToolCurvature { along: 0.05, across: 0.1, direction: forms.frame[0] };
    let both = Conformity::new(forms, tool);
    let r = forms.frame.map(|d| both.root_mm(&d).abs());
    // sqrt 100 - sqrt 20 and sqrt 50 - sqrt 10.
    assert!(
        (r[0] - (10.0 - 20f64.sqrt())).abs() < 1e-12 && (r[1] - (50f64.sqrt() - 10f64.sqrt())).abs() < 1e-12
    );
    let q = Relative::new(&forms, &tool);
    let along = forms.frame.map(|d| q.along(&d));
    assert!((along[0] - 0.04).abs() < 1e-15 && (along[1] - 0.08).abs() < 1e-15);
    // The width by the exact formula of two arcs (37*), at a tolerance of 0.01 mm.
    let width = |kp: f64, kt: f64| {
        let h = 0.01f64;
        4.0 / kp * (0.5 * kp * (h * (2.0 - h * kt) / ((kp + kt) * (1.0 + kp * h))).sqrt()).asin()
    };
    assert!(width(-0.01, 0.05) / width(-0.02, 0.1) > 1.41);
    let claim = both.claim();
    assert!((claim.off_rad - 0.5 * PI).abs() < 1e-5 && claim.widest.dot(&forms.frame[0]).abs() > 1.0 - 1e-12);
}
