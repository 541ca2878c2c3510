//! Drops of a ball beside round edges and in a bore, in closed form.

use super::*;
use crate::plan::drop::ground::{DropTask, areas, seeds};
use crate::plan::{Named, Tolerance};
use osculate_geom::analytic::{Cylinder, Placed, Placement};
use osculate_geom::{Domain, Interval, Patch, Side, Vec3};
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
