//! The closed forms against the exact positions: equality where they are exact, their order where they are not.

use osculate_geom::Side;
use osculate_geom::analytic::{Conic, ConicKind, Line, Placement};
use osculate_geom::{Interval, Point3, Vec3};
use osculate_surfaces::gallery::{
    FormulaCurve, LiuSize, ParaboloidSize, liu_directrices, paraboloid_directrices,
};
use osculate_tools::flank::closed::{MiddleRule, RuleEnd};
use osculate_tools::flank::{
    RadiusLimit, RadiusSearch, RuledStrip, Setting, SideTool, Stations, largest_radius, place, profile,
    three_tangent,
};
use proptest::prelude::*;

fn strip([a, b]: [FormulaCurve; 2], side: Side) -> RuledStrip<'static> {
    RuledStrip::new(a, b, side, 1e-6).expect("directrices apart")
}

fn paraboloid(m: &MiddleRule, extent_mm: f64) -> RuledStrip<'static> {
    let size = ParaboloidSize { height_mm: m.height_mm, half_twist_rad: m.half_twist_rad, extent_mm };
    strip(paraboloid_directrices(size).expect("good sizes"), Side::Along)
}

/// Depth of three tangencies by Newton's method and by the search along the rule.
fn exact_depth(m: &MiddleRule) -> f64 {
    let s = paraboloid(m, 2.0 * (m.height_mm + m.radius_mm));
    let tool = SideTool::cylinder(m.radius_mm).expect("positive");
    let root = three_tangent(&s, 0.5, tool).expect("a root");
    let stations = Stations::beyond(&s, 128, 1.0);
    -profile(&s, &stations, &tool, &root.axis.line, 65).lowest.deviation_mm
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// The paraboloid's closed form against the solver: two ways to one number.
    #[test]
    fn the_paraboloid_is_exact(h in 20.0..200.0f64, share in 0.05..0.6f64, deg in 0.5..40.0f64) {
        let m = MiddleRule { height_mm: h, half_twist_rad: deg.to_radians(), radius_mm: share * h };
        let closed = m.three_tangent().expect("a root for moderate twist");
        let exact = exact_depth(&m);
        // Distances of size R to rounding.
        prop_assert!((closed.depth_mm - exact).abs() < 1e-13 * m.radius_mm + 1e-11 * exact, "{} {exact}", closed.depth_mm);
        let s = paraboloid(&m, 4.0 * h);
        let root = three_tangent(&s, 0.5, SideTool::cylinder(m.radius_mm).unwrap()).unwrap();
        prop_assert!((root.turn_rad.abs() - closed.turn_rad).abs() < 1e-11);
        let x = (root.contacts[0] - 0.5).abs() * 4.0 * h;
        prop_assert!((x - closed.contact_mm).abs() < 1e-9 * h);
    }

    /// The leading orders: what is left falls with a^2, so that halving a quarters the relative error.
    #[test]
    fn the_leading_orders_are_leading(h in 20.0..200.0f64, share in 0.05..1.0f64) {
        let error = |a: f64| {
            let m = MiddleRule { height_mm: h, half_twist_rad: a, radius_mm: share * h };
            let exact = m.three_tangent().unwrap().depth_mm;
            let ratio = m.standard_depth_mm() / exact;
            [m.leading_depth_mm() / exact - 1.0, m.leading_ratio() / ratio - 1.0]
        };
        let (wide, narrow) = (error(0.08), error(0.04));
        for k in 0..2 {
            prop_assert!(wide[k].abs() < 3.0 * (1.0 + share * share) * 0.08 * 0.08, "{wide:?}");
            // A quarter, to the next order, unless the coefficient itself is near zero.
            prop_assert!((narrow[k] - 0.25 * wide[k]).abs() < 0.1 * 0.08 * 0.08 * 0.25 + 0.02 * wide[k].abs());
        }
    }

    /// The standard depth is exact for a circular directrix, convex, straight or hollow.
    #[test]
    fn the_standard_depth_is_exact_on_circles(r in 2.0..15.0f64, rho in 20.0..80.0f64, alpha in 0.01..0.6f64, hollow: bool) {
        // A circle of radius rho about z over a straight line whose normal is turned by alpha.
        let frame = Placement::new(Point3::new(0.0, 0.0, 50.0), Vec3::z_axis(), Some(Vec3::x()));
        let range = Interval::new(-1.5, 1.5);
        let circle = Conic::new(ConicKind::Ellipse { semi_axes_mm: [rho, rho] }, frame, range).unwrap();
        let direction = Vec3::new(alpha.sin(), alpha.cos(), 0.0);
        let line = Line::new(Point3::new(rho, 0.0, 0.0), direction * rho, range).unwrap();
        let side = if hollow { Side::Along } else { Side::Against };
        let s = RuledStrip::new(line, circle, side, 1.0).unwrap();
        let rule = s.rule(0.0).unwrap();
        let k = rule.projected_curvature_per_mm(1);
        prop_assert!((k.abs() * rho - 1.0).abs() < 1e-12);
        prop_assert!((rule.twist_rad().abs() - alpha).abs() < 1e-12);
        let stations = Stations::new(&s, 64);
        let tool = SideTool::cylinder(r).unwrap();
        // Tangent at the line: the circle gets all the error.
        let placed = place(&s, &stations, 0.0, tool, Setting::AtDirectrix(0)).unwrap();
        let depth = -placed.profile(&s, &stations, &tool, 17).samples[16].deviation_mm;
        let closed = RuleEnd { radius_mm: r, curvature_per_mm: k, turn_rad: alpha }.depth_mm();
        prop_assert!((depth - closed).abs() < 1e-12 * rho, "{depth} {closed} {k}");
        // Tangent at the circle: the straight line, R (1 - cos alpha).
        let placed = place(&s, &stations, 0.0, tool, Setting::AtDirectrix(1)).unwrap();
        let depth = -placed.profile(&s, &stations, &tool, 17).samples[0].deviation_mm;
        prop_assert!((depth - r * (1.0 - alpha.cos())).abs() < 1e-12 * rho);
    }

    /// On a parabola the third order shows: halving alpha leaves an eighth of the error or less.
    #[test]
    fn the_standard_depth_is_of_third_order_on_parabolas(r in 3.0..12.0f64, bend in 0.002..0.02f64, u in 5.0..18.0f64) {
        let size = LiuSize { bend_per_mm: bend, end_mm: 40.0, ..LiuSize::default() };
        let s = strip(liu_directrices(size), Side::Along);
        let rule = s.rule(u).unwrap();
        let stations = Stations::beyond(&s, 128, 0.5);
        let tool = SideTool::cylinder(r).unwrap();
        let k = rule.projected_curvature_per_mm(1);
        prop_assume!(k * r > -0.5);
        // A tool whose contact normal is turned by t from the parabola's own.
        let error = |t: f64| {
            let n = rule.normals[1].into_inner();
            let z = rule.frame.z;
            let turned = n * t.cos() + z.cross(&n) * t.sin();
            let axis = osculate_tools::flank::AxisLine {
                point: rule.ends[0].point + turned * r,
                direction: osculate_geom::Unit3::new_normalize(z),
            };
            let depth = -osculate_tools::flank::least_at(&s, &stations, &tool, &axis, 1.0).deviation_mm;
            (depth - RuleEnd { radius_mm: r, curvature_per_mm: k, turn_rad: t }.depth_mm()).abs()
        };
        let (wide, narrow) = (error(0.1), error(0.05));
        prop_assert!(narrow < wide * 0.16 + 1e-12, "{wide} {narrow}");
        prop_assert!(wide < 0.02 * r * 0.1 * 0.1, "{wide}");
    }
}

/// The printed form of eps loses its digits on nearly straight directrices; the implemented one agrees where it does not.
#[test]
fn the_depth_agrees_with_the_printed_form() {
    for (r, rho, alpha) in [(10.0, 40.0, 0.3), (10.0, -40.0, 0.3), (3.0, -3.5, 0.05), (25.0, 8.0, 1.2)] {
        let (cos, sign) = (f64::cos(alpha), f64::signum(rho));
        let printed = r + rho - sign * (r * r + rho * rho + 2.0 * r * rho * cos).sqrt();
        let got = RuleEnd { radius_mm: r, curvature_per_mm: 1.0 / rho, turn_rad: alpha }.depth_mm();
        assert!((got - printed).abs() < 1e-12, "{got} {printed}");
    }
    let straight = RuleEnd { radius_mm: 10.0, curvature_per_mm: 0.0, turn_rad: 0.3 }.depth_mm();
    assert!((straight - 10.0 * (1.0 - 0.3f64.cos())).abs() < 1e-14);
    assert!(RuleEnd { radius_mm: 10.0, curvature_per_mm: -0.1, turn_rad: 0.3 }.depth_mm().is_nan());
}

/// The table of the paraboloid from the closed forms alone.
#[test]
fn the_table_follows_from_the_closed_forms() {
    let ratio = |share: f64, deg: f64| {
        let m = MiddleRule { height_mm: 80.0, half_twist_rad: deg.to_radians(), radius_mm: share * 80.0 };
        m.three_tangent().map(|t| m.standard_depth_mm() / t.depth_mm)
    };
    for (share, deg, want) in
        [(0.25, 5.0, 2092.35), (0.5, 45.0, 14.497), (1.0, 15.0, 195.27), (1.0, 30.0, 13.062)]
    {
        let got = ratio(share, deg).unwrap();
        assert!((got - want).abs() < 0.5e-4 * want, "{share} {deg}: {got}");
    }
    assert!(ratio(1.0, 45.0).is_none());
    // The same for any height: the ratio depends on R/h and the twist alone.
    let m = MiddleRule { height_mm: 3.0, half_twist_rad: 0.3, radius_mm: 1.2 };
    let big = MiddleRule { height_mm: 3e4, radius_mm: 1.2e4, ..m };
    let [a, b] = [m, big].map(|m| m.standard_depth_mm() / m.three_tangent().unwrap().depth_mm);
    assert!((a / b - 1.0).abs() < 1e-12);
}

/// The largest radius within a tolerance, against the closed forms.
#[test]
fn the_largest_radius_meets_the_tolerance() {
    let m = MiddleRule { height_mm: 80.0, half_twist_rad: 0.5, radius_mm: 10.0 };
    let s = paraboloid(&m, 80.0);
    let stations = Stations::beyond(&s, 64, 0.5);
    let how = RadiusSearch { tolerance_mm: 0.05, least_mm: 0.1, most_mm: 200.0, relative: 1e-9, samples: 33 };
    let along = largest_radius(&s, &stations, &[0.5], Setting::Distributed, &how).unwrap();
    let want = 0.05 / (1.0 - 0.5f64.cos());
    assert!((along.radius_mm.unwrap() - want).abs() < 1e-6 * want, "{along:?}");
    assert!(matches!(along.limit, RadiusLimit::Tolerance { deviation_mm, .. } if deviation_mm < 0.0));
    let three = largest_radius(&s, &stations, &[0.5], Setting::ThreeTangent, &how).unwrap();
    let r = three.radius_mm.unwrap();
    let depth = MiddleRule { radius_mm: r, ..m }.three_tangent().unwrap().depth_mm;
    assert!((depth - 0.05).abs() < 1e-7 && r > 40.0 * want, "{three:?} {depth}");
    // A hollow names what fits; a large allowance meets what was asked for.
    let liu = strip(liu_directrices(LiuSize::default()), Side::Against);
    let stations = Stations::beyond(&liu, 64, 0.3);
    let wide = RadiusSearch { tolerance_mm: 5.0, most_mm: 60.0, ..how };
    let hollow = largest_radius(&liu, &stations, &[2.0], Setting::AtDirectrix(1), &wide).unwrap();
    assert!(
        matches!(hollow.limit, RadiusLimit::Hollow { largest_mm, .. }
        if (hollow.radius_mm.unwrap() - largest_mm).abs() < 1e-6),
        "{hollow:?}"
    );
    let easy = RadiusSearch { tolerance_mm: 5.0, most_mm: 2.0, ..how };
    let asked = largest_radius(&liu, &stations, &[2.0], Setting::Distributed, &easy).unwrap();
    assert_eq!((asked.radius_mm, asked.limit), (Some(2.0), RadiusLimit::Asked));
    assert!(
        largest_radius(&liu, &stations, &[2.0], Setting::Distributed, &RadiusSearch { least_mm: 0.0, ..how })
            .is_err()
    );
}
