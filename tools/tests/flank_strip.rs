//! The ruled strip: its rules and their derivatives, its laws as a surface, and what it refuses.

use osculate_geom::analytic::Line;
use osculate_geom::{Axis, Interval, Point3, Side, Surface, Vec3, laws, uv};
use osculate_surfaces::gallery::{
    LiuSize, ParaboloidSize, d98_liu, eq18_directrices, liu_directrices, paraboloid_directrices,
};
use osculate_tools::flank::{RuleError, RuledError, RuledStrip};

const LEAST_MM: f64 = 1e-6;

fn eq18() -> RuledStrip<'static> {
    let [a, b] = eq18_directrices();
    RuledStrip::new(a, b, Side::Along, LEAST_MM).expect("directrices apart")
}

fn liu() -> RuledStrip<'static> {
    let [a, b] = liu_directrices(LiuSize::default());
    RuledStrip::new(a, b, Side::Along, LEAST_MM).expect("directrices apart")
}

/// Reference values of surface (18) at u = 0.4: 15 and 13 digits of a 30-digit computation.
#[test]
fn the_rule_of_surface_18_has_the_known_length_and_twist() {
    let rule = eq18().rule(0.4).unwrap();
    assert!((rule.length_mm - 122.772_576_426_018).abs() < 1e-11);
    assert!((rule.twist_rad().abs().to_degrees() - 129.463_643_468_2).abs() < 1e-9);
    assert!((rule.frame.y.norm() - 1.0).abs() < 1e-15 && rule.frame.x.dot(&rule.frame.z).abs() < 1e-15);
}

/// Every derivative of a rule against central differences: error h^2 f''' / 6 with h = 1e-5 of the range.
#[test]
fn derivatives_of_rules_match_differences() {
    for (strip, u, h) in [(eq18(), 0.4, 1e-5), (liu(), 17.0, 2e-4), (liu(), 23.5, 2e-4), (liu(), -0.5, 2e-4)]
    {
        let [a, r, b] = [u - h, u, u + h].map(|u| strip.rule(u).unwrap());
        let close = |lo: Vec3, hi: Vec3, rate: Vec3| {
            assert!(((hi - lo) / (2.0 * h) - rate).norm() < 1e-6 * (1.0 + rate.norm()), "{u}: {rate}");
        };
        close(a.frame.x, b.frame.x, r.frame_rate.x);
        close(a.frame.y, b.frame.y, r.frame_rate.y);
        close(a.frame.z, b.frame.z, r.frame_rate.z);
        for k in 0..2 {
            close(a.normals[k].into_inner(), b.normals[k].into_inner(), r.normal_rates[k]);
            close(a.ends[k].point.coords, b.ends[k].point.coords, r.ends[k].first);
        }
        assert!(((b.length_mm - a.length_mm) / (2.0 * h) - r.length_rate_mm).abs() < 1e-6);
    }
}

#[test]
fn the_strip_obeys_the_laws_of_surfaces() {
    let (e, l) = (eq18(), liu().on_side(Side::Against));
    for (s, at) in [(&e, uv(0.3, 0.2)), (&e, uv(0.7, 0.9)), (&l, uv(3.0, 0.5)), (&l, uv(20.0, 1.0))] {
        laws::jets_match_differences(s, at, 1e-5, 1e-6);
    }
    // The normal of a rule is the surface's, on either side.
    for v in [0.0, 0.3, 1.0] {
        let n = l.jet2(uv(9.0, v)).normal().unwrap();
        assert!((l.rule(9.0).unwrap().normal(v).unwrap().into_inner() - n.into_inner()).norm() < 1e-14);
    }
}

/// Liu's parabola goes on beyond the patch exactly, from the formula as from the NURBS patch.
#[test]
fn polynomial_directrices_go_on_beyond_their_ends() {
    let patch = d98_liu();
    let borders = RuledStrip::between_borders(&patch, Axis::U, LEAST_MM).unwrap();
    assert_eq!(borders.side(), Side::Along);
    for strip in [liu(), borders] {
        for u in [-2.0, 10.0, 25.766_461_227_9] {
            let j = strip.directrix(1, u);
            assert!((j.point - Point3::new(u, 0.0382 * u * u, 33.995)).norm() < 1e-12);
            assert!((j.first - Vec3::new(1.0, 0.0764 * u, 0.0)).norm() < 1e-12);
            assert!((j.second - Vec3::new(0.0, 0.0764, 0.0)).norm() < 1e-12);
        }
    }
    // The same patch with u and v exchanged: the same strip, the same side of the tool.
    let turned = RuledStrip::between_borders(&patch, Axis::V, LEAST_MM).unwrap();
    assert_eq!(turned.side(), Side::Against);
}

/// The curvature along the rule's section of a directrix: a parabola y = c x^2 bends by 2 c at its vertex.
#[test]
fn projected_curvature_is_that_of_the_parabola() {
    let rule = liu().rule(0.0).unwrap();
    // The rule from (0, 20.429, 0) to (0, 0, 33.995) leans against y: the projection shortens y by its cosine.
    let cos = 33.995 / rule.length_mm;
    let k = rule.projected_curvature_per_mm(1);
    assert!((k.abs() - 0.0764 * cos).abs() < 1e-14 && rule.projected_curvature_per_mm(0) == 0.0);
    assert_eq!(liu().on_side(Side::Against).rule(0.0).unwrap().projected_curvature_per_mm(1), -k);
}

#[test]
fn bad_strips_are_refused() {
    let line = |from: Point3, by: Vec3| Line::new(from, by, Interval::new(0.0, 1.0)).unwrap();
    let a = line(Point3::origin(), Vec3::x());
    // Directrices that cross at u = 0.3, between the rules looked at.
    let b = line(Point3::new(0.0, -0.3 / 7.0, 0.0), Vec3::new(1.0, 1.0 / 7.0, 0.0));
    match RuledStrip::new(a, b, Side::Along, LEAST_MM) {
        Err(RuledError::Crossing { u, length_mm, .. }) => assert!((u - 0.3).abs() < 1e-9 && length_mm < 1e-9),
        other => panic!("{other:?}"),
    }
    // The same curve twice: rules without length everywhere.
    assert!(matches!(RuledStrip::new(a, a, Side::Along, LEAST_MM), Err(RuledError::Crossing { .. })));
    let endless = Line::new(Point3::origin(), Vec3::x(), Interval::new(0.0, f64::INFINITY)).unwrap();
    assert!(matches!(
        RuledStrip::new(a, endless, Side::Along, LEAST_MM),
        Err(RuledError::Unlimited { end: 1, .. })
    ));
    assert!(matches!(RuledStrip::new(a, a, Side::Along, f64::NAN), Err(RuledError::LeastLength { .. })));
    let holed =
        paraboloid_directrices(ParaboloidSize { height_mm: 80.0, half_twist_rad: 0.5, extent_mm: 80.0 });
    let mut holed = holed.unwrap();
    holed[1].powers[0].x = f64::NAN;
    let got = RuledStrip::new(holed[0], holed[1], Side::Along, LEAST_MM);
    assert!(matches!(got, Err(RuledError::NotFinite { end: 1, .. })), "{got:?}");
}

#[test]
fn rules_without_a_frame_say_why() {
    let line = |from: Point3, by: Vec3| Line::new(from, by, Interval::new(0.0, 1.0)).unwrap();
    // Surface (18) begins with an infinite derivative.
    assert!(matches!(eq18().rule(0.0), Err(RuleError::NotFinite { end: 0, .. })));
    // A directrix along the rule.
    let (a, b) =
        (line(Point3::origin(), Vec3::x()), line(Point3::new(0.0, 0.0, 9.0), Vec3::new(0.0, 0.0, 2.0)));
    let strip = RuledStrip::new(a, b, Side::Along, LEAST_MM).unwrap();
    assert!(matches!(strip.rule(0.0), Err(RuleError::NoNormal { end: 1, .. })));
    // Directrices that run against each other: the surface turns over.
    let c = line(Point3::new(0.5, 0.0, 9.0), Vec3::new(-1.0, 0.0, 0.0));
    let strip = RuledStrip::new(a, c, Side::Along, LEAST_MM).unwrap();
    match strip.rule(0.25) {
        Err(RuleError::Opposed { angle_deg, .. }) => assert!((angle_deg - 180.0).abs() < 1e-6),
        other => panic!("{other:?}"),
    }
}
