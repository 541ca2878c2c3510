//! Nearest points of trimmed faces against brute force on dense samples of the inside and the boundary, and
//! against closed forms.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common;

use common::{graph, reference};
use osculate_geom::{Point3, Side, Surface, Uv, uv};
use osculate_surfaces::{ClosestError, FaceSearch, FootKind, NurbsSurface, TrimmedSurface};
use std::f64::consts::TAU;
use std::sync::Arc;

/// A ring of parameters around the middle, with a wave.
fn ring(radius: f64, wave: f64) -> Vec<Uv> {
    (0..400)
        .map(|k| {
            let t = TAU * f64::from(k) / 400.0;
            let r = radius * (1.0 + wave * (5.0 * t).cos());
            uv(0.5 + r * t.cos(), 0.5 + r * t.sin())
        })
        .collect()
}

/// The reference surface inside a wavy ring, with a hole.
fn punched(s: &NurbsSurface) -> TrimmedSurface {
    TrimmedSurface::new(Arc::new(s.clone()), &[ring(0.42, 0.1), ring(0.15, 0.2)], Side::Along).unwrap()
}

fn queries(s: &NurbsSurface, count: u32) -> Vec<(Point3, Uv)> {
    (0..count)
        .map(|k| {
            let part = |step: f64| (0.5 + f64::from(k) * step).fract();
            let at = uv(part(0.754_877_666_246_693), part(0.569_840_290_998_053));
            let jet = s.jet2(at);
            let away = 40.0 * (part(0.414_213_562_373_095) - 0.5);
            (jet.point + jet.normal().unwrap().into_inner() * away, at)
        })
        .collect()
}

#[test]
fn no_sample_of_the_face_is_nearer() {
    for rational in [false, true] {
        let s = reference(rational);
        let face = punched(&s);
        let search = FaceSearch::new(&face, Some(&s));
        let blind = FaceSearch::new(&face, None);
        let n = 300;
        let mut samples: Vec<Point3> = (0..=n * n)
            .map(|k| uv(f64::from(k % n) / f64::from(n - 1), f64::from(k / n) / f64::from(n - 1)))
            .filter(|at| at.v <= 1.0 && face.contains(*at))
            .map(|at| s.point(at))
            .collect();
        for l in face.loops() {
            let m = l.points.len();
            for k in 0..m {
                let (a, b) = (l.points[k], l.points[(k + 1) % m]);
                for t in [0.0, 0.25, 0.5, 0.75] {
                    samples.push(s.point(uv(a.u + t * (b.u - a.u), a.v + t * (b.v - a.v))));
                }
            }
        }
        let mut kinds = [0; 4];
        for (q, _) in queries(&s, 150) {
            let foot = search.closest(&q, None).unwrap();
            let brute = samples.iter().map(|p| (p - q).norm()).fold(f64::INFINITY, f64::min);
            assert!(foot.distance_mm <= brute * (1.0 + 1e-9), "{q}: {foot:?}, sampled {brute}");
            // The samples are half a millimetre apart: what they miss is bounded.
            assert!(foot.distance_mm >= brute - 0.5, "{q}: {foot:?}, sampled {brute}");
            assert!((s.point(foot.uv) - foot.point).norm() <= 1e-12 * (1.0 + foot.point.coords.norm()));
            assert!(foot.residual <= 1e-6, "{foot:?}");
            let same = blind.closest(&q, None).unwrap();
            assert!(
                (same.distance_mm - foot.distance_mm).abs() <= 1e-9 * (1.0 + brute),
                "{q}: {same:?} {foot:?}"
            );
            kinds[foot.kind as usize] += 1;
        }
        assert!(kinds[FootKind::Interior as usize] > 30 && kinds[FootKind::Edge as usize] > 30, "{kinds:?}");
    }
}

#[test]
fn a_hint_finds_the_foot_nearby() {
    let s = reference(false);
    let face = punched(&s);
    let search = FaceSearch::new(&face, Some(&s));
    let mut inside = 0;
    for (q, at) in queries(&s, 200) {
        let whole = search.closest(&q, None).unwrap();
        let near = search.closest(&q, Some(at)).unwrap();
        assert!(near.distance_mm >= whole.distance_mm * (1.0 - 1e-9), "{near:?} {whole:?}");
        // From the foot itself the same foot.
        let again = search.closest(&q, Some(whole.uv)).unwrap();
        assert!(
            (again.distance_mm - whole.distance_mm).abs() <= 1e-9 * (1.0 + whole.distance_mm),
            "{again:?} {whole:?}"
        );
        inside += usize::from(whole.kind == FootKind::Interior);
    }
    assert!(inside > 40 && inside < 160, "{inside}");
}

#[test]
fn corners_and_sides_of_a_plane_have_closed_forms() {
    let s = graph(10.0, |_, _| 0.0);
    let d = s.domain();
    let at = |x: f64, y: f64| d.at(0.05 * (x + 10.0), 0.05 * (y + 10.0));
    // A triangle with corners at (0, 0), (6, 0) and (0, 6).
    let rim = vec![at(0.0, 0.0), at(6.0, 0.0), at(0.0, 6.0)];
    let face = TrimmedSurface::new(Arc::new(s.clone()), &[rim], Side::Along).unwrap();
    let search = FaceSearch::new(&face, Some(&s));
    let third = 0.5_f64.sqrt();
    for (q, want, kind) in [
        (Point3::new(1.0, 2.0, 3.0), 3.0, FootKind::Interior),
        (Point3::new(2.0, -4.0, 3.0), 5.0, FootKind::Edge),
        (Point3::new(-3.0, -4.0, 12.0), 13.0, FootKind::Corner),
        (Point3::new(8.0, -1.0, 2.0), 3.0, FootKind::Corner),
        (Point3::new(5.0, 5.0, 0.0), 4.0 * third, FootKind::Edge),
    ] {
        for hint in [None, Some(at(1.0, 1.0))] {
            let foot = search.closest(&q, hint).unwrap();
            assert!((foot.distance_mm - want).abs() <= 1e-12 * want, "{q}: {foot:?}");
            assert_eq!(foot.kind, kind, "{q}: {foot:?}");
            assert!(foot.residual <= 1e-9);
        }
    }
    let nan = Point3::new(f64::NAN, 0.0, 0.0);
    assert!(matches!(search.closest(&nan, None), Err(ClosestError::NotFinite { .. })));
}

#[test]
fn a_batch_is_its_queries_one_by_one() {
    let s = reference(true);
    let face = punched(&s);
    let search = FaceSearch::new(&face, Some(&s));
    let (points, hints): (Vec<Point3>, Vec<Uv>) = queries(&s, 100).into_iter().unzip();
    for hints in [None, Some(&hints[..50])] {
        let all = search.closest_batch(&points, hints);
        for (k, (q, foot)) in points.iter().zip(&all).enumerate() {
            assert_eq!(*foot, search.closest(q, hints.and_then(|h| h.get(k).copied())), "{k}");
        }
    }
}
