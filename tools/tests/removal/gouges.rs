//! Planted faults are found with their size and block.

use crate::removal::common::{ball, pose, run, through, upright};
use osculate_geom::analytic::{Cylinder, Placed, Placement, Plane};
use osculate_geom::{Domain, Interval, Point3, Surface, Unit3, Vec3};
use osculate_tools::removal::{Kind, Limits, Sampling, Swept, Tally, sample_surface, tally};
use osculate_tools::{Cutter, Pose};

fn face(side: f64, spacing: f64) -> Sampling {
    let i = Interval::new(0.0, side);
    sample_surface(&Plane::new(Domain { u: i, v: i }), 7, spacing, 1_000_000).expect("a good face")
}

fn verdict(cutter: &Cutter, motions: &[Swept], sampling: &Sampling) -> Tally {
    let cuts = run(cutter, motions, &sampling.samples, 0.5);
    let limits = Limits::new(0.02, 1e-3);
    tally(&sampling.samples, &cuts, &limits, &sampling.density, cutter.radius_mm()).expect("good limits")
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

/// Gouges of 0.002 to 0.5 mm in tip, axis, order, pivot and radius: the size within 5 percent, and the block.
///
/// On a plane, where each has a closed form. Samples are so dense that a gouge of relative curvature K looks shallower by
/// at most `K (spacing / sqrt 2)^2 / 2`, a fiftieth of its depth.
#[test]
fn planted_gouges_have_their_size_and_block() {
    let cutter = crate::removal::common::toroidal(10.0, 2.0);
    let (core, r) = (cutter.core_mm(), cutter.corner_mm());
    // Leaned by b along the feed, the corner's lowest point touches the plane.
    let b = 0.1f64;
    let touching = |x: f64, y: f64, lean: f64, extra: f64| {
        let axis = [lean.sin(), 0.0, lean.cos()];
        pose([x, y, r + core * lean.sin() - r * lean.cos() + extra], axis)
    };
    for depth in [0.002, 0.02, 0.5f64] {
        let spacing = (2.0 * 0.02 * depth * r).sqrt().min(0.1);
        let near = |x: f64, y: f64| {
            let i = |c: f64| Interval::new(c - 20.0 * spacing, c + 20.0 * spacing);
            let surface = Plane::new(Domain { u: i(x), v: i(y) });
            sample_surface(&surface, 7, spacing, 1_000_000).unwrap()
        };
        let passes = |place: &dyn Fn(usize) -> Pose| through(&(0..=20).map(place).collect::<Vec<_>>());
        let x = |k: usize| k as f64 - 10.0;
        // Where each fault is deepest, the poses with it, and the blocks that may be named.
        let lowest = |pose: &Pose| {
            let low = -pose.axis.z * pose.axis.into_inner();
            let out = (Vec3::new(0.0, 0.0, -1.0) - low).normalize();
            pose.tip + pose.axis.into_inner() * r + out * core - Vec3::z() * r
        };
        // An axis turned further about its own tip: the corner goes down by g.
        let down = |lean: f64| r + core * lean.sin() - r * lean.cos();
        let mut turned = b;
        for _ in 0..60 {
            // Newton on down(lean) = down(b) + depth; the slope is core cos + r sin.
            turned -= (down(turned) - down(b) - depth) / (core * turned.cos() + r * turned.sin());
        }
        let tipped = touching(x(12), 0.0, b, -depth);
        let leaned = Pose {
            axis: pose([0.0; 3], [turned.sin(), 0.0, turned.cos()]).axis,
            ..touching(x(12), 0.0, b, 0.0)
        };
        for (what, fault) in [("tip", tipped), ("axis", leaned)] {
            let motions = passes(&|k| if k == 12 { fault } else { touching(x(k), 0.0, b, 0.0) });
            let at = lowest(&fault);
            let bad = verdict(&cutter, &motions, &near(at.x, at.y));
            let got = bad.gouge_max_mm;
            assert!((got - depth).abs() < 0.05 * depth, "{what}: {got} of {depth}");
            let worst = bad.worst.iter().find(|w| w.kind == Kind::Gouge).unwrap();
            assert!(matches!(worst.block, Some(12 | 13)), "{what} {worst:?}");
        }
        // A pivot that is off by d lowers a leaned tool by d (1 - cos b) everywhere, towards d sin b.
        let off = depth / (1.0 - b.cos());
        let motions = passes(&|k| {
            let good = touching(x(k), 0.0, b, 0.0);
            Pose { tip: good.tip + (good.axis.into_inner() - Vec3::z()) * off, ..good }
        });
        let got = verdict(&cutter, &motions, &near(off * b.sin() + core, 0.0)).gouge_max_mm;
        assert!((got - depth).abs() < 0.05 * depth, "pivot: {got} of {depth}");
        // A tool that is larger than programmed by e goes down by e (1 - cos b) and e sin b: the flat's radius grows.
        let more = depth / b.sin();
        let large = crate::removal::common::toroidal(2.0 * (core + r + more), r);
        let motions = passes(&|k| touching(x(k), 0.0, b, 0.0));
        let got = verdict(&large, &motions, &near(core, 0.0)).gouge_max_mm;
        assert!((got - depth).abs() < 0.05 * depth, "radius: {got} of {depth}");
        // Two points of a zigzag over a ridge swapped: the tool goes straight where it should climb over.
        let ball = ball(6.0);
        let height = |k: usize| if k % 2 == 1 { 2.0 * depth } else { 0.0 };
        let mut order: Vec<usize> = (0..=20).collect();
        order.swap(11, 12);
        let poses: Vec<Pose> = order.iter().map(|k| upright(x(*k), 0.0, height(*k))).collect();
        let motions = through(&poses);
        // Points 10, 12, 11, 13: from 10 to 12 along the ground through the crest of 11. The part's face there is the
        // tool's own way over the crest, at half of it: a plane at `depth` above the ground.
        let i = |c: f64| Interval::new(c - 20.0 * spacing, c + 20.0 * spacing);
        let crest = Placed {
            surface: Plane::new(Domain { u: i(x(11)), v: i(0.0) }),
            placement: Placement::new(Point3::new(0.0, 0.0, depth), Vec3::z_axis(), Some(Vec3::x())),
        };
        let bad = verdict(&ball, &motions, &sample_surface(&crest, 7, spacing, 1_000_000).unwrap());
        assert!((bad.gouge_max_mm - depth).abs() < 0.05 * depth, "swap: {} of {depth}", bad.gouge_max_mm);
        let worst = bad.worst.iter().find(|w| w.kind == Kind::Gouge).unwrap();
        assert_eq!(worst.block, Some(11), "{worst:?}");
    }
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
    let cutter = crate::removal::common::toroidal(6.0, 1.0);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| (face(10.0, 0.1), run(&cutter, &motions, &sampling.samples, 0.5)))
    };
    let (one, four) = (on(1), on(4));
    assert_eq!(one.0, four.0);
    assert_eq!(one.1, four.1);
    assert!(one.1.iter().filter(|c| c.by.is_some()).count() > 5000);
}
