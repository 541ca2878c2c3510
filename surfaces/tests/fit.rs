//! Fits: points of known curves and surfaces come back, closed sections close smoothly, and measured blades
//! become surfaces within their stated error (`data/blade`, see its notice).

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common;

use common::reference;
use nalgebra::Vector3;
use osculate_geom::{Axis, Point3, Surface, uv};
use osculate_surfaces::fit::{
    Ends, FitError, Grid, LoftOptions, Spacing, approximate, approximate_grid, approximate_within,
    compatible, interpolate, interpolate_grid, loft, skin,
};
use osculate_surfaces::{NurbsCurve3, closest};
use std::f64::consts::TAU;

fn helix(count: usize) -> Vec<Point3> {
    (0..count)
        .map(|k| {
            let t = 4.0 * k as f64 / (count - 1) as f64;
            Point3::new(10.0 * t.cos(), 10.0 * t.sin(), 3.0 * t)
        })
        .collect()
}

#[test]
fn interpolating_curves_pass_through_their_points_and_converge() {
    for degree in [1, 2, 3, 5] {
        for spacing in [Spacing::Uniform, Spacing::Chord, Spacing::Centripetal] {
            let mut errors = [0.0_f64; 2];
            for (error, count) in errors.iter_mut().zip([21, 161]) {
                let fit = interpolate(&helix(count), degree, spacing, &Ends::Free).unwrap();
                assert!(fit.misfit.max_mm < 1e-12, "{degree} {:?}", fit.misfit);
                for k in 0..=500 {
                    let p = fit.curve.point(f64::from(k) / 500.0);
                    *error = error.max((p.coords.xy().norm() - 10.0).abs());
                }
            }
            // An eighth of the step: the error falls with the power degree + 1, less a half for what averaged
            // knots lose at the ends of an even degree.
            let order = (errors[0] / errors[1]).log2() / 3.0;
            assert!(
                order > degree as f64 + 0.4 || errors[1] < 1e-12,
                "{degree} {spacing:?}: {errors:?} {order}"
            );
        }
    }
}

#[test]
fn end_conditions_hold() {
    let points = helix(70);
    // Parameters run from 0 to 1 over 4 rad.
    let tangent = |t: f64| Vector3::new(-40.0 * t.sin(), 40.0 * t.cos(), 12.0);
    let ends = Ends::Tangents([tangent(0.0), tangent(4.0)]);
    let fit = interpolate(&points, 3, Spacing::Chord, &ends).unwrap();
    assert!((fit.curve.jet(0.0).first - tangent(0.0)).norm() < 1e-10);
    assert!((fit.curve.jet(1.0).first - tangent(4.0)).norm() < 1e-10);
    assert!(fit.misfit.max_mm < 1e-12);
    // With the true tangents a cubic spline on 69 steps of 0.058 rad is off by 10 h^4 5 / 384 at most.
    for k in 0..=300 {
        let t = f64::from(k) / 300.0;
        let want = Point3::new(10.0 * (4.0 * t).cos(), 10.0 * (4.0 * t).sin(), 12.0 * t);
        assert!((fit.curve.point(t) - want).norm() < 10.0 * 0.058f64.powi(4) * 5.0 / 384.0 * 1.05);
    }
    let natural = interpolate(&points, 3, Spacing::Chord, &Ends::Natural).unwrap();
    assert!(natural.curve.jet(0.0).second.norm() < 1e-8 && natural.curve.jet(1.0).second.norm() < 1e-8);
    assert!(natural.misfit.max_mm < 1e-12);
    let refused = interpolate(&points, 4, Spacing::Chord, &Ends::Natural).unwrap_err();
    assert_eq!(refused, FitError::Ends { degree: 4 });
}

#[test]
fn closed_curves_close_smoothly() {
    for degree in [2, 3, 4, 5] {
        for count in [9, 64] {
            let ring: Vec<Point3> = (0..count)
                .map(|k| {
                    let a = TAU * f64::from(k) / f64::from(count);
                    Point3::new(6.0 * a.cos(), 4.0 * a.sin(), (2.0 * a).sin())
                })
                .collect();
            let fit = interpolate(&ring, degree, Spacing::Chord, &Ends::Closed).unwrap();
            assert!(fit.misfit.max_mm < 1e-12, "{degree} {count} {:?}", fit.misfit);
            let d = fit.curve.domain();
            let (a, b) = (fit.curve.jet(d.lo), fit.curve.jet(d.hi));
            assert!((a.point - b.point).norm() < 1e-13 && (a.first - b.first).norm() < 1e-11);
            if degree > 2 {
                assert!((a.second - b.second).norm() < 1e-8, "{degree} {count}");
            }
            let near = approximate(&ring, degree, count as usize / 2 + 2, Spacing::Chord, true).unwrap();
            let d = near.curve.domain();
            assert!((near.curve.jet(d.lo).first - near.curve.jet(d.hi).first).norm() < 1e-11);
            assert!(near.misfit.rms_mm > 0.0 && near.misfit.rms_mm <= near.misfit.max_mm);
        }
    }
}

#[test]
fn least_squares_finds_the_curve_that_the_points_come_from() {
    // A parabola by uniform parameters is in every space of degree two and more.
    let points: Vec<Point3> =
        (0..90).map(|k| f64::from(k) / 89.0).map(|t| Point3::new(t, t * t, 1.0)).collect();
    let fit = approximate(&points, 3, 9, Spacing::Uniform, false).unwrap();
    assert!(fit.misfit.max_mm < 1e-13, "{:?}", fit.misfit);
    let within = approximate_within(&helix(200), 3, 1e-4, Spacing::Chord, false).unwrap();
    assert!(within.misfit.max_mm <= 1e-4 && within.curve.poles().len() < 40);
    let ends = (within.curve.poles()[0] - helix(200)[0]).norm();
    assert_eq!(ends, 0.0);
    // The residual is perpendicular to the space: more poles in the same place never fit worse.
    let coarse = approximate(&helix(200), 3, 6, Spacing::Chord, false).unwrap();
    assert!(coarse.misfit.rms_mm > within.misfit.rms_mm);
}

#[test]
fn grids_of_a_spline_come_back() {
    let s = reference(false);
    let count = [37, 41];
    let points = (0..count[0] * count[1])
        .map(|k| s.point(uv((k / count[1]) as f64 / 36.0, (k % count[1]) as f64 / 40.0)))
        .collect();
    let grid = Grid { count, points };
    let through = interpolate_grid(&grid, [3, 3], Spacing::Uniform, [false; 2]).unwrap();
    assert!(through.misfit.max_mm < 1e-11, "{:?}", through.misfit);
    // The surface is a spline of degree three with knots at sevenths, which those of the fit are not: h^4.
    let at = uv(0.412, 0.777);
    assert!((through.surface.point(at) - s.point(at)).norm() < 1e-2);
    let near = approximate_grid(&grid, [3, 3], [14, 15], Spacing::Uniform, [false; 2]).unwrap();
    assert!(near.misfit.max_mm > 0.0 && near.misfit.rms_mm < near.misfit.max_mm && near.misfit.max_mm < 1.5);
    let count = [70, 8];
    let points = (0..560).map(|k| s.point(uv((k / 8) as f64 / 69.0, (k % 8) as f64 / 7.0))).collect();
    let long = interpolate_grid(&Grid { count, points }, [3, 3], Spacing::Uniform, [false; 2]).unwrap();
    assert!(long.misfit.max_mm < 1e-11, "{:?}", long.misfit);
    let short = Grid { count: [3, 3], points: vec![Point3::origin(); 8] };
    let refused = interpolate_grid(&short, [2, 2], Spacing::Chord, [false; 2]).unwrap_err();
    assert_eq!(refused, FitError::Count { got: 8, need: 9 });
}

#[test]
fn a_tube_of_points_becomes_a_closed_surface() {
    let (n, m) = (24, 10);
    let points = (0..n * m)
        .map(|k| {
            let (a, z) = (TAU * (k / m) as f64 / n as f64, (k % m) as f64);
            Point3::new((5.0 + 0.2 * z) * a.cos(), (5.0 + 0.2 * z) * a.sin(), 3.0 * z)
        })
        .collect();
    let fit =
        interpolate_grid(&Grid { count: [n, m], points }, [3, 3], Spacing::Chord, [true, false]).unwrap();
    assert!(fit.surface.domain().u.periodic && fit.misfit.max_mm < 1e-12);
    // On 24 points of a circle a cubic spline is off by r h^4 / 384 with h = 0.26.
    let p = fit.surface.point(uv(0.013, 0.5));
    let want = 5.0 + 0.2 * p.z / 3.0;
    assert!((p.coords.xy().norm() - want).abs() < want * 0.262f64.powi(4) / 384.0 * 1.1);
}

/// The sections of the compressor rotor, in mm (the file has cm), without the repeated first point.
fn rotor37() -> Vec<Vec<Point3>> {
    let mut sections: Vec<Vec<Point3>> = Vec::new();
    for line in include_str!("data/blade/nasa_rotor37_profile_R37.dat").lines() {
        if line.trim_start().starts_with('#') {
            sections.push(Vec::new());
            continue;
        }
        let v: Vec<f64> = line.split_whitespace().map(|x| x.parse().unwrap()).collect();
        if let [x, y, z] = v[..] {
            sections.last_mut().unwrap().push(Point3::new(10.0 * x, 10.0 * y, 10.0 * z));
        }
    }
    for s in &mut sections {
        s.dedup_by(|a, b| a == b);
        if s.first() == s.last() {
            s.pop();
        }
    }
    sections
}

#[test]
fn a_rotor_blade_becomes_a_surface() {
    let sections = rotor37();
    assert_eq!((sections.len(), sections[0].len()), (6, 300));
    let grid_of = |sections: &[Vec<Point3>]| {
        let count = [300, sections.len()];
        let points = (0..300 * count[1]).map(|k| sections[k % count[1]][k / count[1]]).collect();
        Grid { count, points }
    };
    let spacing = Spacing::Centripetal;
    let fit = interpolate_grid(&grid_of(&sections), [3, 3], spacing, [true, false]).unwrap();
    assert!(fit.misfit.max_mm < 1e-10 && fit.surface.domain().u.periodic, "{:?}", fit.misfit);
    // Along the sections the surface stays near the blade: the points of every other row, left out, are near a
    // surface over the rest.
    let half: Vec<Vec<Point3>> = sections.iter().map(|s| s.iter().step_by(2).copied().collect()).collect();
    let count = [150, 6];
    let points = (0..900).map(|k| half[k % 6][k / 6]).collect();
    let coarse = interpolate_grid(&Grid { count, points }, [3, 3], spacing, [true, false]).unwrap();
    for p in sections[2].iter().skip(1).step_by(22) {
        let off = closest(&coarse.surface, p, None).unwrap().distance_mm;
        assert!(off < 5e-3, "{off} mm at {p}");
    }
}

#[test]
fn sections_of_differing_counts_are_lofted() {
    let full = rotor37();
    // Every section loses other points.
    let sections: Vec<Vec<Point3>> = full
        .iter()
        .enumerate()
        .map(|(k, s)| s.iter().enumerate().filter(|(i, _)| i % (7 + k) != 3).map(|(_, p)| *p).collect())
        .collect();
    assert!(sections.windows(2).any(|w: &[Vec<Point3>]| w[0].len() != w[1].len()));
    let mut options =
        LoftOptions { degree: [3, 3], spacing: Spacing::Centripetal, closed: true, tolerance_mm: Some(0.2) };
    let near = loft(&sections, &options).unwrap();
    assert!(near.misfit.max_mm <= 0.2 && near.misfit.max_mm > 0.0, "{:?}", near.misfit);
    assert!(near.surface.closed(Axis::U) && near.surface.net().count[1] == sections.len());
    options.tolerance_mm = None;
    let through = loft(&sections, &options).unwrap();
    assert!(through.misfit.max_mm < 1e-9, "{:?}", through.misfit);
    assert!(through.surface.net().count[0] > near.surface.net().count[0]);
    options.tolerance_mm = Some(1e-9);
    let refused = loft(&sections, &options).unwrap_err();
    assert!(matches!(refused, FitError::Tolerance { reached_mm, .. } if reached_mm > 1e-9), "{refused}");
}

/// A point is missing in one section: the others keep their common knots, and the surface is no finer than two sections.
#[test]
fn sections_of_as_many_points_share_their_knots() {
    let mut sections = rotor37();
    let points = sections[0].len();
    sections[1].remove(points / 3);
    let options =
        LoftOptions { degree: [3, 3], spacing: Spacing::Centripetal, closed: true, tolerance_mm: None };
    let made = loft(&sections, &options).unwrap();
    assert!(made.misfit.max_mm < 1e-9, "{:?}", made.misfit);
    let poles = made.surface.net().count[0];
    assert!(poles <= 2 * points + 3, "{poles} poles of sections of {points} points");
}

#[test]
fn a_compressor_blade_of_rulings() {
    let text = include_str!("data/blade/nasa_pyturbo_centrif_compressor_mainblade_xyz_pts.csv");
    let mut sections: Vec<[Vec<Point3>; 2]> = Vec::new();
    for line in text.lines().skip(1) {
        let v: Vec<f64> = line.split(',').map(|x| x.trim().parse().unwrap()).collect();
        let span = v[0] as usize;
        if span == sections.len() {
            sections.push([Vec::new(), Vec::new()]);
        }
        // Metres to millimetres.
        for (side, c) in sections[span].iter_mut().zip([&v[1..4], &v[4..7]]) {
            side.push(Point3::new(1e3 * c[0], 1e3 * c[1], 1e3 * c[2]));
        }
    }
    for side in 0..2 {
        let rows: Vec<&Vec<Point3>> = sections.iter().map(|s| &s[side]).collect();
        let count = [rows[0].len(), rows.len()];
        let points = (0..count[0] * count[1]).map(|k| rows[k % count[1]][k / count[1]]).collect();
        let grid = Grid { count, points };
        let through = interpolate_grid(&grid, [3, 3], Spacing::Chord, [false; 2]).unwrap();
        assert!(through.misfit.max_mm < 1e-10, "{:?}", through.misfit);
        let near = approximate_grid(&grid, [3, 3], [40, 6], Spacing::Chord, [false; 2]).unwrap();
        // A third of the unknowns on a blade of 65 mm: the round leading edge, 0.1 mm in radius, is what is left.
        assert!(near.misfit.max_mm < 0.1 && near.misfit.rms_mm < 0.01, "{:?}", near.misfit);
    }
}

#[test]
fn curves_are_made_compatible_and_skinned() {
    let line = NurbsCurve3::new(
        1,
        vec![0.0, 0.0, 0.3, 2.0, 2.0],
        vec![Point3::origin(), Point3::new(4.0, 1.0, 0.0), Point3::new(9.0, 0.0, 0.0)],
        None,
    )
    .unwrap();
    let arc = NurbsCurve3::new(
        2,
        vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0],
        vec![Point3::new(0.0, 0.0, 6.0), Point3::new(5.0, 5.0, 6.0), Point3::new(9.0, 0.0, 7.0)],
        Some(vec![1.0, 0.6, 1.0]),
    )
    .unwrap();
    let both = compatible(&[line.clone(), arc.clone()]).unwrap();
    assert_eq!(both[0].knots(), both[1].knots());
    for k in 0..=20 {
        let f = f64::from(k) / 20.0;
        assert!((both[0].point(2.0 * f) - line.point(2.0 * f)).norm() < 1e-14);
        assert!((both[1].point(2.0 * f) - arc.point(f)).norm() < 1e-14);
    }
    let s = skin(&[line, arc.clone()], 1, Spacing::Chord).unwrap();
    assert!((s.point(uv(0.8, 1.0)) - arc.point(0.4)).norm() < 1e-14);
}

#[test]
fn every_refusal() {
    let two = [Point3::origin(), Point3::new(1.0, 0.0, 0.0)];
    let few = interpolate(&two, 3, Spacing::Chord, &Ends::Free).unwrap_err();
    assert_eq!(few, FitError::Degree { degree: 3, points: 2, need: 4, most: 25 });
    assert!(matches!(interpolate(&two, 0, Spacing::Chord, &Ends::Free), Err(FitError::Degree { .. })));
    let mut points = helix(6);
    points[3] = points[2];
    let same = interpolate(&points, 3, Spacing::Chord, &Ends::Free).unwrap_err();
    assert_eq!(same, FitError::Coincident { index: 2 });
    points[3].y = f64::NAN;
    let nan = interpolate(&points, 3, Spacing::Chord, &Ends::Free).unwrap_err();
    assert!(matches!(nan, FitError::NotFinite { index: 3, got } if got.is_nan()));
    let many = approximate(&helix(8), 3, 8, Spacing::Chord, false).unwrap_err();
    assert_eq!(many, FitError::Poles { poles: 8, degree: 3, points: 8, least: 4, most: 7 });
    let options = LoftOptions { degree: [3, 3], spacing: Spacing::Chord, closed: false, tolerance_mm: None };
    let alone = loft(&[helix(9), helix(9)], &options).unwrap_err();
    assert_eq!(alone, FitError::Sections { got: 2, need: 4 });
    assert_eq!(compatible(&[]).unwrap_err(), FitError::Sections { got: 0, need: 1 });
}
