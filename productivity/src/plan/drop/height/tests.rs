//! Drops of a ball beside round edges and in a bore, in closed form.

use super::*;
use crate::plan::drop::seeds::{areas, seeds};
use crate::plan::drop::task::DropTask;
use crate::plan::{Named, Tolerance};
use osculate_geom::analytic::{Cylinder, Placed, Placement};
use osculate_geom::{Curve, CurveTaylor, Domain, Extruded, Interval, Patch, Side, Vec3};
use osculate_tools::CutterSpec;
use std::f64::consts::PI;

const TOLERANCE: Tolerance = Tolerance { scallop_mm: 0.02, gouge_mm: 0.015, chord_mm: 0.003 };

/// Drops of a ball along z, with seeds as passes have them.
fn with_drops(surfaces: &[&dyn Surface], ball_mm: f64, then: impl Fn(&Drops<'_>)) {
    let spec = CutterSpec::Ball { diameter_mm: 2.0 * ball_mm, length_mm: 30.0 };
    let cutter = Cutter::try_from(spec).unwrap();
    let faces: Vec<Named<'_>> = surfaces.iter().map(|s| Named { face: "F", surface: *s }).collect();
    let (axis, feed) = (Vec3::z_axis(), Vec3::x());
    let task = DropTask {
        faces: &faces,
        check: &[],
        cutter: &cutter,
        axis,
        feed,
        tolerance: TOLERANCE,
        progress: &|_| {},
    };
    let frame = Frame::new(axis, &feed);
    let (found, spacing, _) = seeds(&task, (surfaces, &areas(surfaces)), &frame).unwrap();
    then(&Drops::new(surfaces, &cutter, frame, found, spacing));
}

#[test]
fn a_ball_rests_on_a_thin_round_edge_up_to_its_side() {
    const BALL_MM: f64 = 3.0;
    const EDGE_MM: f64 = 0.3;
    // The axis of the edge is x, and two faces meet along a line on it.
    let surface = Cylinder::new(EDGE_MM, Interval::new(-10.0, 10.0)).unwrap();
    let pipe = Placed { surface, placement: Placement::new(Point3::origin(), Vec3::x_axis(), None) };
    for parting in [0.05, 0.3, 0.8, 1.4] {
        let part = |lo: f64, hi: f64| {
            let domain = Domain { u: Interval::new(lo, hi), v: Interval::new(-10.0, 10.0) };
            Patch { surface: &pipe, domain, side: Side::Along }
        };
        let (a, b) = (part(-PI, parting), part(parting, PI));
        with_drops(&[&a, &b], BALL_MM, |drops| {
            let reach = BALL_MM + EDGE_MM;
            for k in -399..400 {
                let d = reach * f64::from(k) / 400.0;
                let tip = (reach * reach - d * d).sqrt() - BALL_MM;
                let got = drops.rest([0.137, d]).unwrap().tip;
                assert!((got - tip).abs() < 1e-8, "{parting} {d}: {got} {tip}");
            }
        });
    }
}

/// In a bore that is a little wider a ball goes down beside its rim, which is known by chords.
#[test]
fn a_ball_goes_into_a_bore() {
    const BALL_MM: f64 = 1.5;
    const BORE_MM: f64 = 2.0;
    let bore = Cylinder::new(BORE_MM, Interval::new(-10.0, 0.0)).unwrap();
    with_drops(&[&bore], BALL_MM, |drops| {
        for k in 0..100 {
            let (s, c) = (f64::from(k) * 0.0628).sin_cos();
            let out = BORE_MM - BALL_MM - 0.25 * TOLERANCE.chord_mm;
            assert!(!drops.is_above([out * c, out * s], -10.0 - BALL_MM), "{k}");
        }
    });
}

/// y = sqrt(TIP_MM^2 + x^2): two sides that meet in a tip of that radius.
struct Narrow;

const TIP_MM: f64 = 0.03;

impl Narrow {
    fn y(x: f64) -> f64 {
        TIP_MM.hypot(x)
    }
}

impl Curve for Narrow {
    fn domain(&self) -> Interval {
        Interval::new(-10.0, 10.0)
    }
    fn taylor(&self, t: f64, order: usize) -> CurveTaylor {
        let (y, square) = (Self::y(t), TIP_MM * TIP_MM);
        let all = [y, t / y, square / y.powi(3), -3.0 * square * t / y.powi(5)];
        let x = [t, 1.0, 0.0, 0.0];
        CurveTaylor::from_derivatives(t, order.min(3), |k| Vec3::new(x[k], all[k], 0.0))
    }
}

/// The rim of a wall whose narrow tip lies between lines that are as far apart as a ball asks for.
#[test]
fn a_ball_rests_on_the_tip_of_a_narrow_rim() {
    const BALL_MM: f64 = 3.0;
    let wall = Extruded::new(Narrow, Vec3::z(), Interval::new(-10.0, 0.0)).unwrap();
    with_drops(&[&wall], BALL_MM, |drops| {
        for (x, y) in [(0.0, -1.0), (0.011, -0.5), (0.3, -1.0), (-0.023, -2.5), (0.0, -2.9)] {
            let away = |t: f64| (t - x).hypot(Narrow::y(t) - y);
            let nearest = (-20_000..20_000).map(|k| away(f64::from(k) * 1e-5)).fold(f64::INFINITY, f64::min);
            let want = (BALL_MM * BALL_MM - nearest * nearest).sqrt() - BALL_MM;
            let got = drops.rest([x, y]).unwrap().tip;
            // The rim is known by chords a tenth of the chord tolerance off it, and the ball rises and falls with the slope of its side.
            let slope = nearest / (want + BALL_MM);
            let off = 0.1 * TOLERANCE.chord_mm * slope;
            assert!(got <= want + 1e-6 && got >= want - off - 1e-6, "{x} {y}: {got} {want}");
        }
    });
}

/// A rod stands out furthest between the lines on which it is seeded, and a ball beside it comes down on that.
#[test]
fn a_ball_rests_beside_a_rod_until_it_clears_it() {
    const BALL_MM: f64 = 3.0;
    const ROD_MM: f64 = 0.33;
    let surface = Cylinder::new(ROD_MM, Interval::new(-10.0, 10.0)).unwrap();
    let rod = Placed { surface, placement: Placement::new(Point3::origin(), Vec3::x_axis(), None) };
    with_drops(&[&rod], BALL_MM, |drops| {
        let reach = BALL_MM + ROD_MM;
        for k in 1..400 {
            // Closer and closer to where it passes it by.
            let d = reach - 10.0_f64.powf(-6.0 * f64::from(k) / 400.0);
            for side in [-1.0, 1.0] {
                let c = [0.137, side * d];
                let tip = (reach * reach - d * d).sqrt() - BALL_MM;
                // The rod's side is known to a tenth of the chord tolerance, and the ball falls with the slope of what it touches.
                let off = 0.1 * TOLERANCE.chord_mm * d / (tip + BALL_MM);
                if let Some(rest) = drops.rest(c) {
                    let low = if d + 0.1 * TOLERANCE.chord_mm < reach { tip - off } else { -2.0 * BALL_MM };
                    assert!(rest.tip <= tip + 1e-8 && rest.tip >= low - 1e-8, "{d}: {} {tip}", rest.tip);
                } else {
                    assert!(d + 0.1 * TOLERANCE.chord_mm >= reach, "{d}: nothing holds it");
                }
                assert!(!drops.is_above(c, tip + 1e-4 * BALL_MM), "{d}: held higher than it can be");
            }
        }
    });
}

/// The same beside a small globe, whose silhouette bends.
#[test]
fn a_ball_rests_beside_a_globe() {
    const BALL_MM: f64 = 3.0;
    const GLOBE_MM: f64 = 0.33;
    let globe = osculate_geom::analytic::Sphere::new(GLOBE_MM).unwrap();
    with_drops(&[&globe], BALL_MM, |drops| {
        let reach = BALL_MM + GLOBE_MM;
        for k in 0..200 {
            let (s, c) = (f64::from(k) * 0.0314).sin_cos();
            let d = reach - 0.25 * TOLERANCE.chord_mm;
            let tip = (reach * reach - d * d).sqrt() - BALL_MM;
            let rest = drops.rest([d * c, d * s]).unwrap();
            let off = 0.1 * TOLERANCE.chord_mm * d / (tip + BALL_MM);
            assert!((rest.tip - tip).abs() < off + 1e-8, "{k}: {} {tip}", rest.tip);
        }
    });
}
