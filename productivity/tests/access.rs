//! From where a ball reaches a dome, beside the area that the limit of the lean leaves.

use osculate_geom::analytic::Paraboloid;
use osculate_geom::{Unit3, Vec3};
use osculate_productivity::access::{Access, Asked, At};
use osculate_productivity::axis::{Around, Left};
use osculate_productivity::plan::Named;
use osculate_tools::{Cutter, CutterSpec};
use std::f64::consts::PI;

/// z = -0.05 (x^2 + y^2) over a square of 20 mm: its normals lean off z by atan(0.1 r).
fn asked(dome: &Paraboloid, axis: Option<Unit3>, test: impl Fn(&Access)) {
    let cutter = Cutter::try_from(CutterSpec::Ball { diameter_mm: 4.0, length_mm: 40.0 }).unwrap();
    let faces = [Named { face: "F1", surface: dome }];
    let around = Around { faces: &faces, check: &[], cutter: &cutter, gouge_mm: 0.02, left: Left::default() };
    let lean_rad = [0.0, 30f64.to_radians()];
    test(&Access::of(&Asked { around, holder: None, at: At::About(2000), lean_rad, axis }).unwrap());
}

/// Area of a paraboloid of revolution z = c r^2 up to a radius.
fn cap_mm2(c: f64, r: f64) -> f64 {
    PI / (6.0 * c * c) * ((1.0 + 4.0 * c * c * r * r).powf(1.5) - 1.0)
}

#[test]
fn a_dome_is_reached_from_above_up_to_the_greatest_lean() {
    let dome = Paraboloid::new([-0.05, -0.05], 10.0).unwrap();
    let wanted = cap_mm2(0.05, 30f64.to_radians().tan() / 0.1);
    asked(&dome, Some(Vec3::z_axis()), |access| {
        let from = access.axes(4, &|_| true);
        assert_eq!(from.len(), 1);
        // Some 2000 places: the rim of the cap passes between 130 of them, and half of these err by chance.
        assert!((from[0].area_mm2 / wanted - 1.0).abs() < 0.03, "{} {wanted}", from[0].area_mm2);
        let left: f64 = access.left_mm2(&from).iter().sum();
        assert!((left + from[0].area_mm2 - access.area_mm2()).abs() < 1e-9 * access.area_mm2());
        let without = |allowed: bool| -> f64 {
            access.reached(&|_| allowed).filter(|(_, reached)| !reached).map(|(s, _)| s.area_mm2).sum()
        };
        assert!((without(true) - access.left_mm2(&from).iter().sum::<f64>()).abs() < 1e-9);
        assert!((without(false) - access.area_mm2()).abs() < 1e-9);
    });
}

/// Free to choose, the first axis is the part's own, others take the corners, and together they reach more than any of them.
#[test]
fn more_axes_reach_more_and_forbidden_ones_are_not_taken() {
    let dome = Paraboloid::new([-0.05, -0.05], 10.0).unwrap();
    asked(&dome, None, |access| {
        let from = access.axes(6, &|_| true);
        assert!(from.len() > 2 && from.iter().all(|f| f.axis.z > 0.3));
        let left: f64 = access.left_mm2(&from).iter().sum();
        assert!(left < 0.02 * access.area_mm2(), "{left}");
        assert!(access.worth_mm2(&from) > 0.9 * (access.area_mm2() - left));
        assert!(access.worth_mm2(&from) <= access.area_mm2());
        let upright = access.axes(6, &|axis| axis.z > 0.999);
        assert_eq!(upright.iter().map(|f| f.axis).collect::<Vec<_>>(), [Vec3::z_axis()]);
        assert!(access.axes(6, &|_| false).is_empty());
    });
}
