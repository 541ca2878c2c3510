//! The tool's formulas by hand, against the cutters' other formulas, and along lines.
#![allow(clippy::unwrap_used)]

use super::*;
use osculate_tools::{Cutter, CutterSpec};

fn tool(shape: Shape, diameter_mm: f64) -> Tool {
    Tool { shape, diameter_mm, length_mm: 40.0, flute_mm: None, holder: Vec::new() }
}

fn bodies(shape: Shape, diameter_mm: f64) -> Bodies {
    Bodies::of(&tool(shape, diameter_mm)).unwrap()
}

const CONE: Shape = Shape::Cone { taper_deg: 30.0, corner_radius_mm: 2.0, tip_diameter_mm: None };
const BLUNT: Shape = Shape::Cone { taper_deg: 20.0, corner_radius_mm: 1.0, tip_diameter_mm: Some(6.0) };
const BARREL: Shape = Shape::Barrel { barrel_radius_mm: 60.0, corner_radius_mm: 2.0 };
const APT: Shape = Shape::Apt { corner_radius_mm: 1.5, bottom_angle_deg: 10.0, side_angle_deg: 5.0 };
const CLOSING: Shape = Shape::Apt { corner_radius_mm: 0.5, bottom_angle_deg: 0.0, side_angle_deg: -4.0 };

fn is(got: f64, want: f64) {
    assert!((got - want).abs() < 1e-12, "{got} {want}");
}

#[test]
fn round_ends_by_hand() {
    let ball = bodies(Shape::Ball, 10.0);
    is(ball.cutter(0.0, 0.0), 0.0);
    is(ball.cutter(0.0, 1.0), -1.0);
    // From the centre at 5: sqrt(3^2 + 4^2) = 5.
    is(ball.cutter(3.0, 1.0), 0.0);
    is(ball.cutter(6.0, 20.0), 1.0);
    is(ball.cutter(2.0, 39.5), -0.5);
    let flat = bodies(Shape::Flat, 10.0);
    is(flat.cutter(4.0, 3.0), -1.0);
    is(flat.cutter(1.0, 3.0), -3.0);
    is(flat.cutter(8.0, -4.0), 5.0);
    let bull = bodies(Shape::Toroidal { corner_radius_mm: 2.0 }, 10.0);
    // The corner's centre is at (3, 2).
    is(bull.cutter(3.0 + 1.2, 2.0 - 0.9), -0.5);
    is(bull.cutter(3.0 + 3.0, 2.0 - 4.0), 3.0);
    is(bull.cutter(2.0, 0.5), -0.5);
}

#[test]
fn meridians_by_hand() {
    // A ball of 2 into a cone of 30 deg: it leaves the ball at (sqrt 3, 1) and reaches 5 mm.
    let cone = bodies(CONE, 10.0);
    is(cone.cutter(0.0, -1.0), 1.0);
    let begin = [3f64.sqrt(), 1.0];
    let flank = |along: f64, out: f64| {
        cone.cutter(
            begin[0] + 0.5 * along + out * 0.75f64.sqrt(),
            begin[1] + 0.75f64.sqrt() * along - 0.5 * out,
        )
    };
    is(flank(2.0, 0.0).abs(), 0.0);
    is(flank(2.0, 0.3), 0.3);
    is(flank(2.0, -0.3), -0.3);
    is(cone.cutter(5.5, 30.0), 0.5);
    // The barrel's widest place: its centre is 55 beyond the axis, sqrt(58^2 - 55^2) above the ball's.
    let barrel = bodies(BARREL, 10.0);
    let widest = 2.0 + (58.0f64 * 58.0 - 55.0 * 55.0).sqrt();
    is(barrel.cutter(5.0, widest).abs(), 0.0);
    is(barrel.cutter(5.3, widest), 0.3);
    is(barrel.cutter(0.0, 0.4), -0.4);
    // APT without angles is a bull nose.
    let plain =
        bodies(Shape::Apt { corner_radius_mm: 2.0, bottom_angle_deg: 0.0, side_angle_deg: 0.0 }, 10.0);
    let bull = bodies(Shape::Toroidal { corner_radius_mm: 2.0 }, 10.0);
    // Its bottom rises by 10 deg: on the line 1 mm inside.
    let apt = bodies(APT, 12.0);
    let (s, c) = 10f64.to_radians().sin_cos();
    is(apt.cutter(2.0 * c - s, 2.0 * s + c), -1.0);
    for k in 0..400 {
        let (rho, z) = (0.5 * f64::from(k % 20), 2.1 * f64::from(k / 20) - 1.0);
        // Where both are exact: not beside the upper rim.
        if z < 40.0 {
            is(plain.cutter(rho, z), bull.cutter(rho, z));
        }
    }
}

/// Another way to the same bodies: by their support functions. Not beside the upper rim, where that is a bound.
#[test]
fn meridians_are_those_of_the_cutters() {
    let (diameter_mm, length_mm) = (12.0, 40.0);
    let specs = [
        (
            CONE,
            CutterSpec::Cone {
                diameter_mm,
                taper_deg: 30.0,
                corner_radius_mm: 2.0,
                tip_diameter_mm: None,
                length_mm,
            },
        ),
        (
            BLUNT,
            CutterSpec::Cone {
                diameter_mm,
                taper_deg: 20.0,
                corner_radius_mm: 1.0,
                tip_diameter_mm: Some(6.0),
                length_mm,
            },
        ),
        (
            BARREL,
            CutterSpec::Barrel { diameter_mm, barrel_radius_mm: 60.0, corner_radius_mm: 2.0, length_mm },
        ),
        (
            APT,
            CutterSpec::Apt {
                diameter_mm,
                corner_radius_mm: 1.5,
                bottom_angle_deg: 10.0,
                side_angle_deg: 5.0,
                length_mm,
            },
        ),
        (
            CLOSING,
            CutterSpec::Apt {
                diameter_mm,
                corner_radius_mm: 0.5,
                bottom_angle_deg: 0.0,
                side_angle_deg: -4.0,
                length_mm,
            },
        ),
    ];
    for (shape, spec) in specs {
        let (own, other) = (bodies(shape, diameter_mm), Cutter::try_from(spec).unwrap());
        for i in 0..60 {
            for j in 0..90 {
                let (rho, z) = (0.17 * f64::from(i), 0.41 * f64::from(j) - 2.0);
                let (a, b) = (own.cutter(rho, z), other.local_distance(rho, z));
                if z + 2.0 * a.abs() < length_mm {
                    assert!((a - b).abs() < 1e-9, "{shape:?} {rho} {z}: {a} {b}");
                }
            }
        }
    }
}

/// Derivatives are those of the distance, and a line's entry is where the distance is nothing and was more before.
#[test]
fn lines_enter_where_the_distance_ends() {
    let shapes = [
        Shape::Ball,
        Shape::Flat,
        Shape::Toroidal { corner_radius_mm: 1.5 },
        CONE,
        BLUNT,
        BARREL,
        APT,
        CLOSING,
    ];
    let mut entered = 0;
    for shape in shapes {
        let b = bodies(shape, 12.0);
        for k in 0..500 {
            let wave = |n: f64| (n * (f64::from(k) + 0.7)).sin();
            let (rho, z) = (4.5 + 4.0 * wave(1.3), 8.0 + 10.0 * wave(2.1));
            let near = b.near(rho, z);
            let e = 1e-6;
            let slopes = [
                (b.cutter(rho + e, z) - b.cutter(rho - e, z)) / (2.0 * e),
                (b.cutter(rho, z + e) - b.cutter(rho, z - e)) / (2.0 * e),
            ];
            // Next to the middle of the body two sides are as near.
            let off = (slopes[0] - near.by_rho).hypot(slopes[1] - near.by_z);
            assert!(off < 1e-4 || near.distance < -0.4, "{shape:?} {rho} {z} {near:?} {slopes:?}");
            // A line from (rho, 0, z) along a unit vector.
            let n = [wave(3.1), wave(4.7), wave(5.9)];
            let size = (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt().max(1e-3);
            let n = n.map(|c| c / size);
            for grown in [0.0, 0.3] {
                let got =
                    b.entry([z, rho * rho], [n[2], n[0] * n[0] + n[1] * n[1]], rho * n[0], (grown, 20.0));
                let at = |s: f64| b.cutter((rho + s * n[0]).hypot(s * n[1]), z + s * n[2]) - grown;
                let first = (0..2000).map(|i| 0.01 * f64::from(i)).find(|s| at(*s) <= 0.0);
                match (got, first) {
                    (Some(s), Some(f)) => {
                        entered += 1;
                        assert!(s <= f + 1e-9 && s > f - 0.0101, "{shape:?}: {s} {f}");
                        assert!(s == 0.0 || at(s).abs() < 1e-6, "{shape:?}: {}", at(s));
                    }
                    // A line that only grazes between two steps.
                    (Some(s), None) => assert!(at(s) < 1e-6 && at(s) > -2e-2),
                    (None, f) => assert!(f.is_none(), "{shape:?} {f:?}"),
                }
            }
        }
    }
    assert!(entered > 1000);
}

#[test]
fn shank_and_holder_stand_above() {
    let mut t = tool(Shape::Ball, 6.0);
    t.flute_mm = Some(10.0);
    t.holder = vec![
        HolderPart { diameter_mm: 20.0, upper_diameter_mm: 20.0, length_mm: 5.0 },
        HolderPart { diameter_mm: 40.0, upper_diameter_mm: 40.0, length_mm: 9.0 },
    ];
    let b = Bodies::of(&t).unwrap();
    is(b.cutter(0.0, 12.0), 2.0);
    is(b.holder(2.0, 12.0), -1.0);
    is(b.holder(8.0, 42.0), -2.0);
    is(b.holder(18.0, 47.0), -2.0);
    is(b.holder(0.0, 55.0), 1.0);
    // A cone that opens by 45 degrees, and closes again at half that slope.
    t.holder = vec![
        HolderPart { diameter_mm: 20.0, upper_diameter_mm: 40.0, length_mm: 10.0 },
        HolderPart { diameter_mm: 40.0, upper_diameter_mm: 30.0, length_mm: 10.0 },
    ];
    let b = Bodies::of(&t).unwrap();
    let (half, [across, along]) = (0.5f64.sqrt(), [2.0 / 5f64.sqrt(), 1.0 / 5f64.sqrt()]);
    is(b.holder(15.0 + half, 45.0 - half), 1.0);
    is(b.holder(17.5 + across, 55.0 + along), 1.0);
    is(b.holder(17.5 - 0.5 * across, 55.0 - 0.5 * along), -0.5);
    assert_eq!(bodies(Shape::Ball, 6.0).holder(0.0, 50.0), f64::INFINITY);
}

#[test]
fn what_is_no_tool_is_refused() {
    let mut bad = vec![
        tool(Shape::Flat, f64::NAN),
        tool(Shape::Toroidal { corner_radius_mm: 4.0 }, 6.0),
        tool(Shape::Cone { taper_deg: 95.0, corner_radius_mm: 1.0, tip_diameter_mm: None }, 6.0),
        tool(Shape::Cone { taper_deg: 2.0, corner_radius_mm: 1.0, tip_diameter_mm: None }, 60.0),
        tool(Shape::Barrel { barrel_radius_mm: 2.0, corner_radius_mm: 1.0 }, 6.0),
        tool(Shape::Barrel { barrel_radius_mm: 4000.0, corner_radius_mm: 1.0 }, 6.0),
        tool(Shape::Apt { corner_radius_mm: 1.0, bottom_angle_deg: 50.0, side_angle_deg: 45.0 }, 6.0),
        tool(Shape::Apt { corner_radius_mm: 0.0, bottom_angle_deg: 0.0, side_angle_deg: -30.0 }, 6.0),
    ];
    let ball = tool(Shape::Ball, 6.0);
    bad.push(Tool { flute_mm: Some(50.0), ..ball.clone() });
    bad.push(Tool {
        holder: vec![HolderPart { diameter_mm: 0.0, upper_diameter_mm: 0.0, length_mm: 5.0 }],
        ..ball
    });
    for t in bad {
        assert!(matches!(Bodies::of(&t), Err(NoOpinion::Tool { .. })), "{t:?}");
    }
}
