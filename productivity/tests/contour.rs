//! Contour passes of a ball on a dome: heights, spacing and coverage against closed forms.

use osculate_geom::analytic::Sphere;
use osculate_geom::{Domain, Interval, Patch, Side, Surface, Vec3};
use osculate_productivity::plan::{PlanError, Task, Tolerance, contour_2cl};
use osculate_tools::{Cutter, CutterSpec, Lean};

fn dome() -> Patch<Sphere> {
    // Latitudes 20 to 75 degrees, a quarter around.
    let domain = Domain { u: Interval::new(0.0, 1.5), v: Interval::new(0.35, 1.3) };
    Patch { surface: Sphere::new(40.0).unwrap(), domain, side: Side::Along }
}

const TOLERANCE: Tolerance = Tolerance { scallop_mm: 0.01, gouge_mm: 0.005, chord_mm: 0.002 };

#[test]
fn passes_on_a_sphere_are_parallels_spaced_by_the_strip() {
    let surface = dome();
    let cutter = Cutter::try_from(CutterSpec::Ball { diameter_mm: 8.0, length_mm: 40.0 }).unwrap();
    let task = Task::new("F1", &surface, &cutter, Lean::default(), TOLERANCE);
    let got = contour_2cl(&task, Vec3::z_axis()).unwrap();
    let mut latitudes: Vec<f64> = Vec::new();
    for pass in &got.passes {
        let z0 = pass.points[0].pose.tip.z;
        // Every pass stays at its height, to the thousandth of the chord tolerance that contours are projected to.
        assert!(pass.points.iter().all(|p| (p.pose.tip.z - z0).abs() < 4e-6));
        // It runs the whole quarter around.
        let (a, b) = (pass.points[0].uv.u, pass.points[pass.points.len() - 1].uv.u);
        assert!((a.min(b) - 0.0).abs() < 1e-9 && (a.max(b) - 1.5).abs() < 1e-9);
        latitudes.push(pass.points[0].uv.v);
    }
    latitudes.sort_by(f64::total_cmp);
    // Exact cusp between parallels d apart on a sphere of radius 40 cut by a ball of 4: at the middle of the gap.
    let cusp = |d: f64| {
        let half = 0.5 * d;
        44.0 * half.cos() - (16.0 - (44.0 * half.sin()).powi(2)).sqrt() - 40.0
    };
    let mut used = 0;
    for w in latitudes.windows(2) {
        let c = cusp(w[1] - w[0]);
        assert!(c <= 0.01, "{c}");
        used += i32::from(c > 0.006);
    }
    assert!(used as usize >= (latitudes.len() - 1) * 9 / 10, "{used} of {}", latitudes.len());
    // The ends of the face are covered too.
    let d = surface.domain();
    assert!(cusp(2.0 * (latitudes[0] - d.v.lo)) <= 0.01);
    assert!(cusp(2.0 * (d.v.hi - latitudes[latitudes.len() - 1])) <= 0.01);
}

#[test]
fn other_cutters_and_faces_that_look_away_are_refused() {
    let surface = dome();
    let flat = Cutter::try_from(CutterSpec::Flat { diameter_mm: 8.0, length_mm: 40.0 }).unwrap();
    let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 8.0, length_mm: 40.0 }).unwrap();
    let task = |cutter| Task::new("F1", &surface, cutter, Lean::default(), TOLERANCE);
    assert!(matches!(contour_2cl(&task(&flat), Vec3::z_axis()), Err(PlanError::Tool { .. })));
    assert!(matches!(contour_2cl(&task(&ball), -Vec3::z_axis()), Err(PlanError::Nothing { .. })));
}
