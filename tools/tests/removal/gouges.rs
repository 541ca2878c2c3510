//! Planted faults are found with their size and block.

use crate::common::{ball, pose, run, through, upright};
use osculate_geom::analytic::{Cylinder, Placed, Placement, Plane};
use osculate_geom::{Domain, Interval, Point3, Surface, Unit3, Vec3};
use osculate_tools::removal::{Kind, Limits, Sampling, Swept, Verdict, judge, sample_surface};
use osculate_tools::{Cutter, Pose};

fn face(side: f64, spacing: f64) -> Sampling {
    let i = Interval::new(0.0, side);
    sample_surface(&Plane::new(Domain { u: i, v: i }), 7, spacing, 1_000_000).expect("a good face")
}

fn verdict(cutter: &Cutter, motions: &[Swept], sampling: &Sampling) -> Verdict {
    let cuts = run(cutter, motions, &sampling.samples, 0.5);
    let limits = Limits::new(0.02, 1e-3);
    judge(&sampling.samples, &cuts, &limits, &sampling.density, cutter.radius_mm()).expect("good limits")
}

/// A raster with one point every 0.5 mm; `place` may move a point.
fn raster(place: impl Fn(usize, usize) -> Pose) -> Vec<Swept> {
    let mut poses = Vec::new();
    for line in 0..=20 {
        for k in 0..=20 {
            poses.push(place(line, if line % 2 == 0 { k } else { 20 - k }));
        }
    }
    through(&poses)
}

#[test]
fn a_tip_lowered_at_one_point() {
    let cutter = ball(6.0);
    let sampling = face(10.0, 0.1);
    let good = verdict(&cutter, &raster(|i, k| upright(0.5 * k as f64, 0.5 * i as f64, 0.0)), &sampling);
    assert!(good.within, "{good:?}");
    assert!(good.gouge_max_mm < 1e-12);
    for depth in [0.002, 0.01, 0.05, 0.5] {
        let motions = raster(|i, k| {
            let z = if (i, k) == (8, 12) { -depth } else { 0.0 };
            upright(0.5 * k as f64, 0.5 * i as f64, z)
        });
        let bad = verdict(&cutter, &motions, &sampling);
        // The samples stand on a grid of at most 0.1 mm, at most 0.071 from the point: r^2 / 2R = 8e-4, and
        // the tip falls towards the point by depth / 0.5 mm; so much may be missed.
        let missed = (0.071f64 * 0.071 / 6.0).min(bad.hidden.gouge_mm) + 0.05 * depth;
        assert!(!bad.within && bad.gouge_max_mm <= depth + 1e-12, "{bad:?}");
        assert!(bad.gouge_max_mm >= depth - missed, "{} of {depth}", bad.gouge_max_mm);
        let worst = bad.worst.iter().find(|w| w.kind == Kind::Gouge).unwrap();
        // Point (8, 12) is number 8 * 21 + 12 = 180: block 180 leads to it, 181 away.
        assert!(matches!(worst.block, Some(180 | 181)), "{worst:?}");
        assert!((worst.at - Point3::new(6.0, 4.0, 0.0)).norm() < 0.11 && worst.face == 7);
    }
}

/// On a slope b a ball larger by d than programmed goes in by d (1 - cos b).
#[test]
fn a_tool_of_the_wrong_radius() {
    let (radius, more, slope) = (3.0, 0.1, 0.8f64);
    let n = Vec3::new(-slope.sin(), 0.0, slope.cos());
    let placement = Placement::new(
        Point3::origin(),
        Unit3::new_normalize(n),
        Some(Vec3::new(slope.cos(), 0.0, slope.sin())),
    );
    let i = Interval::new(0.0, 10.0);
    let surface = Placed { surface: Plane::new(Domain { u: i, v: i }), placement };
    let sampling = sample_surface(&surface, 0, 0.2, 100_000).unwrap();
    let motions = raster(|i, k| {
        let p = surface.point(osculate_geom::uv(0.5 * k as f64, 0.5 * i as f64));
        Pose { tip: p + n * radius - Vec3::z() * radius, axis: Vec3::z_axis() }
    });
    assert!(verdict(&ball(2.0 * radius), &motions, &sampling).within);
    let bad = verdict(&ball(2.0 * (radius + more)), &motions, &sampling);
    let want = more * (1.0 - slope.cos());
    assert!(!bad.within && (bad.gouge_max_mm - want).abs() < 0.05 * want, "{} want {want}", bad.gouge_max_mm);
    assert!(bad.median_mm < 0.0);
}

/// Around a cylinder, two points swapped make the tool cut a corner of two steps: the tip's chord dips by
/// `R_part (1 - cos step)`, and so does the ball, as the axis turns with it.
#[test]
fn two_points_swapped() {
    let (part, radius, step) = (20.0f64, 4.0f64, 0.05f64);
    let cutter = ball(2.0 * radius);
    let surface = Cylinder::new(part, Interval::new(-0.2, 0.2)).unwrap();
    let sampling = sample_surface(&surface, 0, 0.1, 100_000).unwrap();
    let at = |k: usize| {
        let (s, c) = (step * k as f64).sin_cos();
        pose([part * c, part * s, 0.0], [c, s, 0.0])
    };
    let mut order: Vec<usize> = (0..=126).collect();
    let path = |order: &[usize]| through(&order.iter().map(|k| at(*k)).collect::<Vec<_>>());
    // The chord of one step dips too.
    let chord = |angle: f64| part * (1.0 - (0.5 * angle).cos());
    let good = verdict(&cutter, &path(&order), &sampling);
    assert!((good.gouge_max_mm - chord(step)).abs() < 0.05 * chord(step), "{}", good.gouge_max_mm);
    order.swap(40, 41);
    let bad = verdict(&cutter, &path(&order), &sampling);
    let want = chord(2.0 * step);
    assert!(!bad.within && (bad.gouge_max_mm - want).abs() < 0.05 * want, "{} want {want}", bad.gouge_max_mm);
    // Points 39 to 41 by block 40, 40 to 42 by block 42.
    let worst = bad.worst.iter().find(|w| w.kind == Kind::Gouge).unwrap();
    assert!(matches!(worst.block, Some(40 | 42)), "{worst:?}");
}

#[test]
fn depth_is_clipped() {
    let sampling = face(2.0, 0.5);
    let cuts = run(
        &ball(20.0),
        &through(&[upright(0.0, 0.0, -5.0), upright(2.0, 2.0, -5.0)]),
        &sampling.samples,
        0.5,
    );
    assert!(cuts.iter().all(|c| c.standoff_mm == -2.0));
}

/// The result does not depend on the number of threads, bit for bit.
#[test]
fn threads_do_not_matter() {
    let sampling = face(10.0, 0.1);
    let motions = raster(|i, k| {
        let lean = 0.3 * (0.7 * k as f64 + i as f64).sin();
        pose([0.5 * k as f64, 0.5 * i as f64, 0.01 * ((i * k) as f64).sin()], [lean, 0.1, 1.0])
    });
    let cutter = crate::common::toroidal(6.0, 1.0);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| (face(10.0, 0.1), run(&cutter, &motions, &sampling.samples, 0.5)))
    };
    let (one, four) = (on(1), on(4));
    assert_eq!(one.0, four.0);
    assert_eq!(one.1, four.1);
    assert!(one.1.iter().filter(|c| c.by.is_some()).count() > 5000);
}
