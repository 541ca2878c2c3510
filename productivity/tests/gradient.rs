//! Gradient lines on three axes: what they leave and name, measured with the swept cutter; strips against M86's formula.

use crate::dropped;

use dropped::{TOLERANCE, dropped, holds, left};
use osculate_geom::analytic::{Cone, Cylinder, Paraboloid, Placed, Placement, Plane, Sphere};
use osculate_geom::{Domain, Flipped, Interval, Patch, Point3, Side, Surface, Unit3, Vec3};
use osculate_productivity::plan::{Passes, PlanError, gradient_3c};
use osculate_tools::{Cutter, CutterSpec};

fn toroid() -> Cutter {
    Cutter::try_from(CutterSpec::Toroidal { diameter_mm: 8.0, corner_radius_mm: 1.0, length_mm: 40.0 })
        .unwrap()
}

fn flat() -> Cutter {
    Cutter::try_from(CutterSpec::Flat { diameter_mm: 8.0, length_mm: 40.0 }).unwrap()
}

fn plan(face: &dyn Surface, cutter: &Cutter) -> Result<Passes, PlanError> {
    dropped(gradient_3c, &[face], &[], cutter)
}

fn says(passes: &Passes, what: &str) -> bool {
    passes.diagnostics.iter().any(|d| d.to_string().contains(what))
}

/// A plane through the origin that rises by `slope` along x.
fn ramp(slope: f64) -> Placed<Plane> {
    let normal = Unit3::new_normalize(Vec3::new(-slope, 0.0, 1.0));
    let square = Interval::new(0.0, 20.0);
    let placement = Placement::new(Point3::origin(), normal, Some(Vec3::y()));
    Placed { surface: Plane::new(Domain { u: square, v: square }), placement }
}

#[test]
fn a_ramp_is_cut_straight_up_at_the_spacing_of_the_circle() {
    for (slope, cutter) in [(0.3, toroid()), (0.3, flat()), (0.1, toroid())] {
        let face = ramp(slope);
        let passes = plan(&face, &cutter).unwrap();
        holds(&[&face], &cutter, &passes);
        for p in &passes.passes {
            let way = p.points.last().unwrap().pose.tip - p.points[0].pose.tip;
            assert!(way.y.abs() <= 5e-3 * way.norm(), "{way:?}");
        }
        // A circle of radius rho leaning by the slope's angle: cusps of h at half the spacing d.
        let sine = slope / slope.hypot(1.0);
        let rho = cutter.core_mm() + cutter.corner_mm() * sine;
        let rise = TOLERANCE.scallop_mm / sine;
        let d = 2.0 * (2.0 * rho * rise - rise * rise).sqrt();
        let count = passes.passes.len() as f64;
        assert!(count >= 20.0 / d && count <= 20.0 / d * 1.35 + 2.0, "{count} passes for {}", 20.0 / d);
    }
}

#[test]
fn round_and_free_faces_hold() {
    let dome = Patch {
        surface: Sphere::new(40.0).unwrap(),
        domain: Domain { u: Interval::new(0.2, 0.8), v: Interval::new(0.7, 1.2) },
        side: Side::Along,
    };
    let hill = Paraboloid::new([-0.01, -0.02], 9.0).unwrap();
    for (face, cutter) in [(&dome as &dyn Surface, toroid()), (&hill, toroid()), (&dome, flat())] {
        let passes = plan(face, &cutter).unwrap();
        holds(&[face], &cutter, &passes);
    }
}

/// A funnel whose contour circles are smaller than the cutter's below some height.
#[test]
fn a_tight_contour_is_left_by_name() {
    // Radius grows by one for each unit of height; the material is outside.
    let cone = Patch {
        surface: Cone::new(2.0, std::f64::consts::FRAC_PI_4, Interval::new(0.0, 12.0)).unwrap(),
        domain: Domain { u: Interval::new(0.0, 1.0), v: Interval::new(0.0, 12.0) },
        side: Side::Along,
    };
    let funnel = Flipped(cone);
    let passes = plan(&funnel, &toroid()).unwrap();
    assert!(says(&passes, "contour lines bend tighter"), "{:?}", passes.diagnostics);
    assert!(says(&passes, "takes a cutter of radius 2.0"), "{:?}", passes.diagnostics);
    // Up to where the contour has the radius of the cutter's circle on a slope of 45 degrees.
    let sine = std::f64::consts::FRAC_1_SQRT_2;
    let long = (toroid().core_mm() + toroid().corner_mm() * sine - 2.0) / sine;
    let area = 2.0 * long + 0.5 * sine * long * long;
    let told: f64 = passes
        .diagnostics
        .iter()
        .map(ToString::to_string)
        .find(|d| d.contains("contour lines bend tighter"))
        .and_then(|d| d.split(" mm2 of").next()?.rsplit(' ').next()?.parse().ok())
        .unwrap();
    assert!((told / area - 1.0).abs() < 0.05, "{told} mm2 told, {area} mm2");
    let [cut, _] = left(&[&funnel], &toroid(), &passes);
    assert!(cut >= -TOLERANCE.gouge_mm, "cut {cut}");
}

#[test]
fn undercuts_and_wrong_tools_are_told() {
    let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 8.0, length_mm: 40.0 }).unwrap();
    assert!(matches!(plan(&ramp(0.3), &ball), Err(PlanError::Tool { strategy: "gradient_3c", .. })));
    // About x: u from 0 to pi is above, the rest below.
    let pipe = Patch {
        surface: Cylinder::new(15.0, Interval::new(0.0, 10.0)).unwrap(),
        domain: Domain { u: Interval::new(-0.4, 1.2), v: Interval::new(0.0, 10.0) },
        side: Side::Along,
    };
    let placement = Placement::new(Point3::origin(), Vec3::x_axis(), Some(Vec3::y()));
    let round = Placed { surface: pipe, placement };
    let passes = plan(&round, &toroid()).unwrap();
    assert!(says(&passes, "faces away from the tool axis"), "{:?}", passes.diagnostics);
    let [cut, _] = left(&[&round], &toroid(), &passes);
    assert!(cut >= -TOLERANCE.gouge_mm, "cut {cut}");
}
