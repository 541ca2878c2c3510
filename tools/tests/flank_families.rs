//! Three tangencies over whole families of surfaces: the equations in their own form, the motion, and what is refused.

use osculate_geom::{Curve, CurveTaylor, Interval, Side, Vec3};
use osculate_surfaces::gallery::{
    FormulaCurve, LiuSize, ParaboloidSize, eq18_directrices, liu_directrices, paraboloid_directrices,
};
use osculate_tools::flank::{PlaceError, RuleError, RuledStrip, SideTool, three_tangent};
use proptest::prelude::*;

fn strip([a, b]: [FormulaCurve; 2], side: Side) -> RuledStrip<'static> {
    RuledStrip::new(a, b, side, 1e-6).expect("directrices apart")
}

/// |w_perp| = R and w_perp . C' = 0 at both contacts, with A = P0 + h0 z + R y and d = cos(gamma) z - sin(gamma) x.
fn holds(s: &RuledStrip<'_>, u: f64, radius_mm: f64) -> Result<(), TestCaseError> {
    let root = three_tangent(s, u, SideTool::cylinder(radius_mm).expect("positive"));
    let root = root.map_err(|e| TestCaseError::fail(e.to_string()))?;
    let rule = s.rule(u).expect("a frame");
    let f = &rule.frame;
    let a = rule.ends[0].point + f.z * root.height_mm + f.y * radius_mm;
    let d = f.z * root.turn_rad.cos() - f.x * root.turn_rad.sin();
    for (end, at) in root.contacts.into_iter().enumerate() {
        let j = s.directrix(end, at);
        let w = j.point - a;
        let across = w - d * w.dot(&d);
        prop_assert!(
            (across.norm() - radius_mm).abs() < 1e-10 * (1.0 + w.norm()),
            "{}",
            across.norm() - radius_mm
        );
        prop_assert!(across.dot(&j.first).abs() < 1e-9 * radius_mm * j.first.norm());
    }
    prop_assert!((root.contacts[0] - u) * (root.contacts[1] - u) <= 0.0);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn surfaces_like_lius(line in 5.0..40.0f64, bend in 0.0..0.02f64, h in 20.0..80.0f64, u in 0.5..25.0f64, r in 2.0..12.0f64, left: bool) {
        let side = if left { Side::Against } else { Side::Along };
        let s = strip(liu_directrices(LiuSize { line_mm: line, bend_per_mm: bend, height_mm: h, end_mm: 30.0 }), side);
        holds(&s, u, r)?;
    }

    #[test]
    fn paraboloids_at_any_rule(h in 20.0..200.0f64, deg in 0.0..35.0f64, share in 0.02..0.5f64, u in 0.1..0.9f64, left: bool) {
        let side = if left { Side::Against } else { Side::Along };
        let size = ParaboloidSize { height_mm: h, half_twist_rad: deg.to_radians(), extent_mm: h };
        let s = strip(paraboloid_directrices(size).expect("good sizes"), side);
        holds(&s, u, share * h)?;
    }

    #[test]
    fn surface_18_at_any_rule(u in 0.3..0.95f64, r in 0.5..12.0f64) {
        holds(&strip(eq18_directrices(), Side::Along), u, r)?;
    }

    /// Ten orders of size: lengths scale, angles stay.
    #[test]
    fn the_position_scales(power in -5i32..5, u in 0.2..0.8f64) {
        let k = 10f64.powi(power);
        let made = |k: f64| {
            let size = ParaboloidSize { height_mm: 50.0 * k, half_twist_rad: 0.4, extent_mm: 60.0 * k };
            let [a, b] = paraboloid_directrices(size).expect("good sizes");
            let s = RuledStrip::new(a, b, Side::Along, 1e-9).expect("directrices apart");
            three_tangent(&s, u, SideTool::cylinder(9.0 * k).expect("positive")).expect("a root")
        };
        let (one, scaled) = (made(1.0), made(k));
        prop_assert!((one.turn_rad - scaled.turn_rad).abs() < 1e-12);
        prop_assert!((one.height_mm * k - scaled.height_mm).abs() < 1e-10 * scaled.height_mm);
    }
}

/// A directrix with a cusp at u = 0: `(u^2, u^3, 0)`.
struct Cusp;

impl Curve for Cusp {
    fn domain(&self) -> Interval {
        Interval::new(-1.0, 1.0)
    }
    fn taylor(&self, t: f64, order: usize) -> CurveTaylor {
        CurveTaylor::from_coefficients(t, order, |k| match k {
            0 => Vec3::new(t * t, t * t * t, 0.0),
            1 => Vec3::new(2.0 * t, 3.0 * t * t, 0.0),
            2 => Vec3::new(1.0, 3.0 * t, 0.0),
            3 => Vec3::new(0.0, 1.0, 0.0),
            _ => Vec3::zeros(),
        })
    }
}

#[test]
fn cusps_are_named() {
    let zero = Vec3::zeros();
    let line =
        FormulaCurve::cubic([Vec3::new(0.0, 0.0, 10.0), Vec3::x(), zero, zero], Interval::new(-1.0, 1.0));
    let s = RuledStrip::new(Cusp, line, Side::Along, 1e-6).unwrap();
    let got = three_tangent(&s, 0.0, SideTool::cylinder(1.0).unwrap());
    assert!(matches!(got, Err(PlaceError::Rule(RuleError::NoNormal { end: 0, .. }))), "{got:?}");
}

/// On the hollow side of Liu's parabola a cylinder of 60 mm finds no root, and the answer names what fits.
#[test]
fn what_is_too_large_for_the_hollow_is_named() {
    let s = strip(liu_directrices(LiuSize::default()), Side::Against);
    let fits = s.rule(2.0).unwrap().largest_fit_mm();
    match three_tangent(&s, 2.0, SideTool::cylinder(60.0).unwrap()) {
        Err(PlaceError::TooLarge { largest_mm, .. }) => assert!(largest_mm == fits && fits < 20.0),
        other => panic!("{other:?} {fits}"),
    }
}
