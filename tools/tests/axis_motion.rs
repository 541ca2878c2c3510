//! The motion of a cutter with an axis of its own against what its poses say, and leans of axes against their poses.

use osculate_geom::analytic::Torus;
use osculate_geom::line::{IsoLine, SurfaceLine};
use osculate_geom::{Axis, Unit3, Vec3};
use osculate_tools::{Cutter, CutterSpec, Lean, moving_with_axis, pose_with_axis};
use proptest::prelude::*;

fn cutter(kind: u32) -> Cutter {
    let length_mm = 60.0;
    let spec = match kind {
        0 => CutterSpec::Ball { diameter_mm: 10.0, length_mm },
        1 => CutterSpec::Flat { diameter_mm: 12.0, length_mm },
        _ => CutterSpec::Toroidal { diameter_mm: 16.0, corner_radius_mm: 2.0, length_mm },
    };
    Cutter::try_from(spec).unwrap()
}

/// An axis that turns at a steady rate about another direction.
fn turning(axis: &Unit3, about: &Vec3, t: f64) -> Unit3 {
    nalgebra::Rotation3::from_scaled_axis(about * t) * axis
}

proptest! {
    #[test]
    fn rates_are_those_of_the_poses(
        kind in 0u32..3, along in 0.3..6.0f64, tube in 0.2..6.0f64, lead in 0.03..1.4f64, tilt in -3.1..3.1f64,
        about in prop::array::uniform3(-0.5..0.5f64), u in any::<bool>(), reversed in any::<bool>(),
    ) {
        let torus = Torus::new(200.0, 60.0).unwrap();
        let axis = if u { Axis::U } else { Axis::V };
        let (t0, fixed) = if u { (along, tube) } else { (tube, along) };
        let line = IsoLine { surface: &torus, along: axis, fixed, reversed };
        let cutter = cutter(kind);
        let (frame, speed) = line.frame(t0).unwrap();
        let a = Lean { lead_rad: lead, tilt_rad: tilt }.pose(&cutter, &frame, 0.0).axis;
        let about = Vec3::from(about);
        let at = |t: f64| {
            let frame = line.frame(t0 + t).unwrap().0;
            pose_with_axis(&cutter, &frame.point, &frame.normal, &turning(&a, &about, t))
        };
        let got = moving_with_axis(&cutter, &frame, speed, &a, &about.cross(&a));
        let d = 1e-5;
        let (before, after) = (at(-d), at(d));
        let tip = (after.tip - before.tip) / (2.0 * d);
        let axis_rate = (after.axis.into_inner() - before.axis.into_inner()) / (2.0 * d);
        prop_assert!((got.pose.tip - at(0.0).tip).norm() < 1e-12);
        prop_assert!((got.tip_rate - tip).norm() < 1e-5 * (1.0 + tip.norm()), "{} {}", got.tip_rate, tip);
        prop_assert!((got.turn.cross(&a) - axis_rate).norm() < 1e-7);
    }

    #[test]
    fn a_lean_of_an_axis_is_its_pose(kind in 0u32..3, at in 0.3..6.0f64, lead in 0.02..1.5f64, tilt in -3.1..3.1f64) {
        let torus = Torus::new(200.0, 60.0).unwrap();
        let line = IsoLine { surface: &torus, along: Axis::V, fixed: 1.0, reversed: false };
        let (frame, _) = line.frame(at).unwrap();
        let cutter = cutter(kind);
        let lean = Lean { lead_rad: lead, tilt_rad: tilt };
        let pose = lean.pose(&cutter, &frame, 0.0);
        let again = Lean::of(&pose.axis, &frame);
        prop_assert!((again.lead_rad - lead).abs() < 1e-12 && (again.tilt_rad - tilt).abs() < 1e-12);
        let same = pose_with_axis(&cutter, &frame.point, &frame.normal, &pose.axis);
        prop_assert!((same.tip - pose.tip).norm() < 1e-11);
    }
}
