//! Cones and barrels against rules: contacts are contacts, limits are cylinders, and a cone fits a cone.

use osculate_geom::analytic::{Conic, ConicKind, Placement};
use osculate_geom::{Interval, Point3, Side, Vec3};
use osculate_surfaces::gallery::{ParaboloidSize, paraboloid_directrices};
use osculate_tools::flank::{
    PlaceError, RuledStrip, Setting, SideTool, Stations, place, profile, three_tangent,
};

fn paraboloid(half_twist_deg: f64) -> RuledStrip<'static> {
    let half_twist_rad = half_twist_deg.to_radians();
    let size = ParaboloidSize { height_mm: 80.0, half_twist_rad, extent_mm: 120.0 };
    let [a, b] = paraboloid_directrices(size).expect("good sizes");
    RuledStrip::new(a, b, Side::Along, 1e-6).expect("directrices apart")
}

/// Deviation and slope vanish at both contacts on the directrices and on the rule.
#[test]
fn cones_and_barrels_touch_three_times() {
    let tools = [
        SideTool::cone(10.0, 4f64.to_radians()).unwrap(),
        SideTool::cone(10.0, -4f64.to_radians()).unwrap(),
        SideTool::barrel(10.0, 0.0, 1e-5).unwrap(),
        SideTool::barrel(10.0, 0.03, 1e-5).unwrap(),
    ];
    let s = paraboloid(15.0);
    for tool in tools {
        let root = three_tangent(&s, 0.5, tool).unwrap();
        let axis = root.axis.line;
        assert!(root.residual_mm < 1e-12);
        for (end, u) in root.contacts.into_iter().enumerate() {
            let j = s.directrix(end, u);
            let near = tool.near(&axis, &j.point);
            assert!(
                near.deviation_mm.abs() < 1e-12 && near.normal.dot(&j.first).abs() < 1e-10 * j.first.norm()
            );
        }
        // The rule touches at M2: deviation and slope along it vanish there.
        let rule = s.rule(0.5).unwrap();
        let near = tool.near(&axis, &rule.point(root.height_mm / rule.length_mm));
        assert!(near.deviation_mm.abs() < 1e-12 && near.normal.dot(&rule.frame.z).abs() < 1e-12);
        // A cylinder gouges by 0.0015 mm (R a^4 / 32); the change of radius along a twisted rule adds a cubic in v.
        let stations = Stations::new(&s, 64);
        let p = profile(&s, &stations, &tool, &axis, 65);
        assert!(p.lowest.deviation_mm > -0.04 && p.highest.deviation_mm < 0.04, "{tool:?} {p:?}");
        // The stated motion is that of the neighbouring positions.
        let h = 1e-5;
        let [a, b] = [0.5 - h, 0.5 + h].map(|u| three_tangent(&s, u, tool).unwrap().axis.line);
        let turned = (b.direction.into_inner() - a.direction.into_inner()) / (2.0 * h);
        let moved = (b.point - a.point) / (2.0 * h);
        assert!((turned - root.axis.direction_rate).norm() < 1e-6);
        assert!((moved - root.axis.point_rate).norm() < 1e-4, "{moved} {}", root.axis.point_rate);
    }
}

/// As taper and bulge vanish the position is the cylinder's, linearly.
#[test]
fn the_limit_is_the_cylinder() {
    let s = paraboloid(20.0);
    let turn = |tool| three_tangent(&s, 0.5, tool).unwrap().turn_rad;
    let cylinder = turn(SideTool::cylinder(10.0).unwrap());
    for small in [1e-6, 1e-9] {
        assert!((turn(SideTool::cone(10.0, small).unwrap()) - cylinder).abs() < 10.0 * small);
        assert!((turn(SideTool::barrel(10.0, 0.0, small * 1e-3).unwrap()) - cylinder).abs() < 10.0 * small);
    }
}

/// A conical tool along the rules of a cone deviates nowhere; the double point offset is refused.
#[test]
fn a_cone_fits_a_cone() {
    let circle = |radius: f64, z: f64| {
        let frame = Placement::new(Point3::new(0.0, 0.0, z), Vec3::z_axis(), Some(Vec3::x()));
        Conic::new(ConicKind::Ellipse { semi_axes_mm: [radius, radius] }, frame, Interval::new(0.0, 2.0))
            .unwrap()
    };
    let s = RuledStrip::new(circle(30.0, 0.0), circle(22.0, 40.0), Side::Along, 1.0).unwrap();
    let stations = Stations::new(&s, 32);
    let tool = SideTool::cone(8.0, 0.1).unwrap();
    for setting in [Setting::AtDirectrix(1), Setting::Distributed] {
        let placed = place(&s, &stations, 1.0, tool, setting).unwrap();
        let p = placed.profile(&s, &stations, &tool, 33);
        assert!(p.max_abs_mm() < 1e-12, "{setting:?} {}", p.max_abs_mm());
    }
    let refused = place(&s, &stations, 1.0, tool, Setting::DoublePoint(0.25));
    assert_eq!(refused, Err(PlaceError::CylinderOnly));
    assert_eq!(place(&s, &stations, 1.0, tool, Setting::BalancedDoublePoint), refused);
    let refused = place(&s, &stations, 1.0, SideTool::cylinder(8.0).unwrap(), Setting::DoublePoint(0.5));
    assert!(matches!(refused, Err(PlaceError::Fraction { .. })));
}

/// The best position is about half as wrong as three tangencies for a cylinder, and better for a cone too.
#[test]
fn minimax_is_better_than_three_tangencies() {
    let s = paraboloid(15.0);
    let stations = Stations::new(&s, 64);
    for (tool, share) in
        [(SideTool::cylinder(10.0).unwrap(), 0.51), (SideTool::cone(10.0, 0.05).unwrap(), 0.65)]
    {
        let [three, best] = [Setting::ThreeTangent, Setting::Minimax].map(|setting| {
            let placed = place(&s, &stations, 0.5, tool, setting).unwrap();
            placed.profile(&s, &stations, &tool, 65).max_abs_mm()
        });
        assert!(best < share * three, "{tool:?}: {best} {three}");
    }
}
