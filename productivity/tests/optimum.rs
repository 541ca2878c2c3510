//! The posture of greatest productivity against scans and known cases.

use crate::limits::{CAPS, limits};
use osculate_geom::analytic::{Ellipsoid, Sphere, Torus};
use osculate_geom::{Flipped, Surface, Uv, uv};
use osculate_productivity::optimum::{
    self, AxisCone, Binding, Limits, OptimumError, Posture, Range, measure,
};
use osculate_productivity::rate::{Caps, FeedLimit};
use osculate_tools::{Cutter, CutterSpec, Lean};
use std::f64::consts::{PI, TAU};

fn toroidal(diameter_mm: f64, corner_radius_mm: f64) -> Cutter {
    Cutter::try_from(CutterSpec::Toroidal { diameter_mm, corner_radius_mm, length_mm: 80.0 }).unwrap()
}

/// The greatest productivity of a scan in steps of 10 degrees, 8 leads and 3 tilts.
fn scan(part: &dyn Surface, at: Uv, cutter: &Cutter, limits: &Limits) -> f64 {
    let on =
        |r: Range, k: u32, n: u32| r.least_rad + (r.most_rad - r.least_rad) * f64::from(k) / f64::from(n - 1);
    let mut best = 0.0f64;
    for i in 0..36 {
        for j in 0..8 {
            for k in 0..3 {
                let lean = Lean { lead_rad: on(limits.lead, j, 8), tilt_rad: on(limits.tilt, k, 3) };
                let posture = Posture { direction_rad: TAU * f64::from(i) / 36.0, lean };
                let found = measure(part, at, cutter, posture, limits);
                best = best.max(found.map_or(0.0, |m| m.rate.area_mm2_min));
            }
        }
    }
    best
}

#[test]
fn never_beaten_by_a_scan() {
    let ellipsoid = Ellipsoid::new([90.0, 60.0, 40.0]).unwrap();
    let groove = Flipped(Torus::new(200.0, 60.0).unwrap());
    let ring = Torus::new(80.0, 30.0).unwrap();
    let places: [(&dyn Surface, Uv, Cutter); 4] = [
        (&ellipsoid, ellipsoid.domain().at(0.31, 0.42), toroidal(12.0, 2.0)),
        (&ring, uv(0.3, 2.6), toroidal(10.0, 1.0)),
        (&groove, uv(0.3, PI - 0.2), toroidal(20.0, 2.0)),
        (&groove, uv(0.3, 0.4), toroidal(12.0, 3.0)),
    ];
    for (part, at, cutter) in &places {
        let limits = limits();
        let best = optimum::at(*part, *at, std::slice::from_ref(cutter), &limits).unwrap();
        let scanned = scan(*part, *at, cutter, &limits);
        assert!(best.rate.area_mm2_min >= 0.995 * scanned, "{best:?} against {scanned}");
        assert!(best.undercut_mm <= limits.gouge_mm * 1.01, "{best:?}");
    }
}

/// On a hollow place the tool rests on two contacts: the strip is many times a ball's, and the dip is what binds.
#[test]
fn two_contacts_are_found_on_hollow_places() {
    let groove = Flipped(Torus::new(200.0, 60.0).unwrap());
    let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 20.0, length_mm: 80.0 }).unwrap();
    let bull = toroidal(20.0, 2.0);
    let at = uv(0.2, PI);
    let by_ball = optimum::at(&groove, at, std::slice::from_ref(&ball), &limits()).unwrap();
    let both = optimum::at(&groove, at, &[ball, bull], &limits()).unwrap();
    assert_eq!(both.tool, 1);
    assert!(both.rate.width_mm > 8.0 * by_ball.rate.width_mm, "{both:?} {by_ball:?}");
    assert_eq!(both.binding, Binding::Gouge);
    assert_eq!(both.rate.limit, FeedLimit::Feed);
}

/// On a sphere a ball is as good in every direction, and its strip is that of two arcs.
#[test]
fn a_ball_on_a_sphere_has_no_preference() {
    let sphere = Sphere::new(50.0).unwrap();
    let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 10.0, length_mm: 80.0 }).unwrap();
    let fine = Limits { caps: Caps { feed_per_tooth_mm: 1e-3, ..CAPS }, ..limits() };
    let best = optimum::at(&sphere, uv(0.3, 0.4), std::slice::from_ref(&ball), &fine).unwrap();
    let h = best.share.across_mm();
    let (kp, kt) = (1.0 / 50.0, 1.0 / 5.0);
    let x = (h * (2.0 - h * kt) / ((kp + kt) * (1.0 + kp * h))).sqrt();
    let width = 4.0 / kp * (0.5 * kp * x).asin();
    assert!((best.rate.width_mm / width - 1.0).abs() < 1e-8, "{best:?} {width}");
}

#[test]
fn the_cone_of_axes_binds_and_bad_input_is_refused() {
    let ellipsoid = Ellipsoid::new([90.0, 60.0, 40.0]).unwrap();
    let at = ellipsoid.domain().at(0.31, 0.42);
    let cutter = [toroidal(12.0, 2.0)];
    let normal = ellipsoid.jet2(at).normal().unwrap();
    let free = optimum::at(&ellipsoid, at, &cutter, &limits()).unwrap();
    let wide = AxisCone { middle: normal, half_angle_rad: 0.8 };
    let same = optimum::at(&ellipsoid, at, &cutter, &Limits { axis: Some(wide), ..limits() }).unwrap();
    assert!((same.rate.area_mm2_min / free.rate.area_mm2_min - 1.0).abs() < 1e-9);
    // A cone that leaves no lead of the range.
    let none = Limits { axis: Some(AxisCone { middle: normal, half_angle_rad: 0.01 }), ..limits() };
    assert!(matches!(optimum::at(&ellipsoid, at, &cutter, &none), Err(OptimumError::None { .. })));
    assert!(matches!(optimum::at(&ellipsoid, at, &[], &limits()), Err(OptimumError::NoTools)));
    let backwards = Limits { lead: Range { least_rad: 0.5, most_rad: 0.1 }, ..limits() };
    assert!(matches!(optimum::at(&ellipsoid, at, &cutter, &backwards), Err(OptimumError::Range { .. })));
    let caps = Limits { caps: Caps { teeth: 0, ..CAPS }, ..limits() };
    assert!(matches!(optimum::at(&ellipsoid, at, &cutter, &caps), Err(OptimumError::Caps(_))));
}
