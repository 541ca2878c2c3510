//! A tool that does not turn, against the distance of real points from a real tool and against M86's condition.

use osculate_geom::analytic::Paraboloid;
use osculate_geom::{Surface, Unit3, Vec3, uv};
use osculate_productivity::closed_form::{DomainError, contour_per_mm, three_axis_flat, three_axis_toroidal};
use osculate_productivity::fixed_axis::{Undercut, clear, over};
use osculate_tools::{Cutter, CutterSpec, pose_with_axis};
use proptest::prelude::*;
use std::f64::consts::TAU;

fn toroidal(diameter_mm: f64, corner_radius_mm: f64) -> Cutter {
    Cutter::try_from(CutterSpec::Toroidal { diameter_mm, corner_radius_mm, length_mm: 80.0 }).unwrap()
}

fn flat(diameter_mm: f64) -> Cutter {
    Cutter::try_from(CutterSpec::Flat { diameter_mm, length_mm: 80.0 }).unwrap()
}

/// An axis that leans by an angle, some way around z.
fn leaning(lean: f64, around: f64) -> Unit3 {
    Unit3::new_normalize(Vec3::new(lean.sin() * around.cos(), lean.sin() * around.sin(), lean.cos()))
}

/// The least of 2 d / e^2 over a circle of places around the contact, d their distance from the tool, e the circle's radius: to the
/// circle's order the smaller eigenvalue of the relative form.
fn measured(part: &Paraboloid, axis: &Unit3, [core, corner]: [f64; 2], cutter: &Cutter) -> f64 {
    const EPS: f64 = 1e-3;
    let foot = part.jet2(uv(0.0, 0.0));
    let pose = pose_with_axis(cutter, &foot.point, &foot.normal().unwrap(), axis);
    let distance = |k: usize| {
        let (s, c) = (TAU * k as f64 / 3600.0).sin_cos();
        let from_tip = part.point(uv(EPS * c, EPS * s)) - pose.tip;
        let z = from_tip.dot(axis);
        let rho = (from_tip - axis.into_inner() * z).norm();
        // From the circle of corner arcs, and from the bottom's plane within it.
        let off = (rho - core).max(0.0).hypot(corner - z) - corner;
        2.0 * off / (EPS * EPS)
    };
    (0..3600).map(distance).fold(f64::INFINITY, f64::min)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// What is told is the distance of the part's points from the tool, to second order; where nothing is, points lie inside it.
    #[test]
    fn the_part_keeps_off_the_tool_where_it_is_clear(
        k in [-0.04f64..0.04, -0.04f64..0.04], lean in 0.05f64..1.3, around in 0.0f64..TAU,
        radius in 3.0f64..20.0, share in 0.2f64..0.9,
    ) {
        let part = Paraboloid::new(k, 20.0).unwrap();
        let corner = share * radius;
        let (cutter, axis) = (toroidal(2.0 * radius, corner), leaning(lean, around));
        let least = measured(&part, &axis, [radius - corner, corner], &cutter);
        match clear(&part.jet2(uv(0.0, 0.0)), &axis, &cutter) {
            Ok(q) => prop_assert!((q - least).abs() < 1e-3, "{q} {least}"),
            Err(why) => prop_assert!(least < 1e-3 && why != Undercut::FacesAway, "{why} {least}"),
        }
    }

    /// M86's condition: a flat end does not fit where the contour line is hollow and bends tighter than the end. Along the slope the
    /// edge is sharp, so that there is no other.
    #[test]
    fn a_flat_end_is_undercut_where_the_contour_line_is_tighter(
        k in [-0.04f64..0.04, -0.04f64..0.04], lean in 0.05f64..1.3, around in 0.0f64..TAU, radius in 3.0f64..20.0,
    ) {
        let part = Paraboloid::new(k, 20.0).unwrap();
        let jet = part.jet2(uv(0.0, 0.0));
        let axis = leaning(lean, around);
        // Across the slope, at right angles to the normal z and the axis.
        let across = jet.forms().unwrap().normal_curvature(&Vec3::new(-around.sin(), around.cos(), 0.0));
        let told = clear(&jet, &axis, &flat(2.0 * radius));
        let tight = contour_per_mm(across, lean).unwrap() < -1.0 / radius;
        prop_assert_eq!(told == Err(Undercut::TightContour), tight, "{:?}", told);
        let width = three_axis_flat(radius, lean, across, 1e-4);
        prop_assert_eq!(matches!(width, Err(DomainError::DoesNotFit { .. })), tight, "{:?}", width);
        // With a corner the same, by the toroidal form.
        let corner = 0.3 * radius;
        let told = clear(&jet, &axis, &toroidal(2.0 * radius, corner));
        let width = three_axis_toroidal(radius - corner, corner, lean, across, 1e-4);
        let unfit = matches!(width, Err(DomainError::DoesNotFit { .. }));
        prop_assert_eq!(told == Err(Undercut::TightContour), unfit, "{:?} {:?}", told, width);
    }
}

/// Places of a grid: a bowl turned over looks away everywhere; of a bowl a flat end that stands upright misses its bottom alone.
#[test]
fn places_of_a_bowl() {
    let bowl = Paraboloid::new([0.01, 0.01], 20.0).unwrap();
    let down = over(&bowl, &-Vec3::z_axis(), &flat(10.0), [4, 4]);
    assert!(down.iter().all(|p| p.clear == Some(Err(Undercut::FacesAway))));
    // Its contour lines are circles, whose radius is the distance from its middle.
    let up = over(&bowl, &Vec3::z_axis(), &flat(10.0), [41, 41]);
    let mut tight = 0;
    for p in &up {
        let radius = p.at.u.hypot(p.at.v);
        let (near, clear) = (radius < 5.0 * (1.0 - 1e-9), p.clear.unwrap());
        assert_eq!(clear.is_err(), near, "{radius} {clear:?}");
        tight += usize::from(near);
    }
    assert!(tight > 60);
}
