//! Ways between passes beside walls whose distance is known in closed form.

use super::*;
use crate::plan::Named;
use osculate_geom::analytic::Line;
use osculate_geom::{Box3, Extruded, Interval, Point3, Unit3, Vec3, uv};
use osculate_tools::sweep::{LinearMotion, SweptMotion};
use osculate_tools::{Cutter, CutterSpec, Holder};

const TROUGH_MM: f64 = 4.0;
const BALL_MM: f64 = 3.0;

/// Links over a box for a cutter without a holder.
fn links_over(obstacles: Box3, cutter: Cutter) -> Links {
    Links {
        obstacles,
        clearance_mm: 5.0,
        approach_mm: 2.0,
        hop_mm: 0.25,
        contacts: true,
        dropped: false,
        dip_mm: 0.0,
        layer_mm: 0.0,
        rates: Rates::default(),
        cutter,
        holder: None,
        feed_mm_min: 5000.0,
        air_mm_min: 5000.0,
        plunge_mm_min: 2500.0,
    }
}

fn ball(diameter_mm: f64, length_mm: f64) -> Cutter {
    Cutter::try_from(CutterSpec::Ball { diameter_mm, length_mm }).unwrap()
}

/// A pass along y on the wall of a half round trough about the y axis, `angle` from its bottom; the ball stands upright.
fn pass(angle: f64, back: bool) -> Pass {
    let normal = Unit3::new_normalize(Vec3::new(-angle.sin(), 0.0, angle.cos()));
    let at = |k: u32| {
        let y = if back { f64::from(8 - k) } else { f64::from(k) };
        let point = Point3::new(0.0, y, 0.0) - normal.into_inner() * TROUGH_MM;
        let tip = point + (normal.into_inner() - Vec3::z()) * BALL_MM;
        let pose = Pose { tip, axis: Vec3::z_axis() };
        CcPoint { uv: uv(angle, y), point, normal, pose, width_mm: 1.0 }
    };
    Pass { points: (0..=8).map(at).collect(), closed: false }
}

#[test]
fn a_hop_does_not_go_into_the_wall_across() {
    let cutter = ball(2.0 * BALL_MM, 30.0);
    let obstacles = Box3 { min: Point3::new(-4.0, 0.0, -4.0), max: Point3::new(4.0, 8.0, 0.0) };
    // Twice what there is room for between ball and wall.
    let links = Links {
        approach_mm: 4.0 * (TROUGH_MM - BALL_MM),
        hop_mm: 4.0 * (TROUGH_MM - BALL_MM),
        ..links_over(obstacles, cutter)
    };
    let passes: Vec<Pass> =
        (-18..=18).map(|k| pass(f64::from(k) * 5.0f64.to_radians(), k % 2 == 0)).collect();
    let linked = link(&passes, &links, &Walls::default());
    for w in linked.path.moves.windows(2) {
        let motion = LinearMotion { from: w[0].pose, to: w[1].pose };
        for k in 0..=20 {
            let centre = motion.at(f64::from(k) / 20.0).unwrap().pose.tip + Vec3::z() * BALL_MM;
            // Below the rim the wall is as far off the axis everywhere, above it the rim is nearest.
            let gap = if centre.z < 0.0 {
                TROUGH_MM - centre.x.hypot(centre.z)
            } else {
                (TROUGH_MM - centre.x.abs()).hypot(centre.z)
            };
            assert!(gap >= BALL_MM - 1e-9, "{centre}");
        }
    }
    // All the same nothing goes up to the sphere but at both ends: passes are joined where they are.
    let first = linked.pass_of_move.iter().position(Option::is_some).unwrap();
    let last = linked.pass_of_move.iter().rposition(Option::is_some).unwrap();
    let highest =
        linked.path.moves[first..last].iter().map(|m| m.pose.tip.z).fold(f64::NEG_INFINITY, f64::max);
    assert!(highest <= 4.0 * (TROUGH_MM - BALL_MM), "{highest}");
    // From each of the 36 ends the ball goes on by 5 degrees about the trough's axis.
    let on = 2.0 * (TROUGH_MM - BALL_MM) * 2.5f64.to_radians().sin();
    let legs = linked.path.moves[first..=last].windows(2).zip(&linked.pass_of_move[first + 1..=last]);
    let air: f64 =
        legs.filter(|(_, p)| p.is_none()).map(|(w, _)| (w[1].pose.tip - w[0].pose.tip).norm()).sum();
    assert!((air - 36.0 * on).abs() < 1e-9, "{air} {}", 36.0 * on);
}

/// Passes along y, `apart` from each other, over the plane z = 0 with a ball that stands upright.
fn over_plane(apart: f64, radius: f64) -> Vec<Pass> {
    let one = |x: f64, back: bool| {
        let at = |k: u32| {
            let y = if back { f64::from(8 - k) } else { f64::from(k) };
            let point = Point3::new(x, y, 0.0);
            let pose = Pose { tip: point, axis: Vec3::z_axis() };
            CcPoint { uv: uv(x, y), point, normal: Vec3::z_axis(), pose, width_mm: radius }
        };
        Pass { points: (0..=8).map(at).collect(), closed: false }
    };
    (0..3).map(|k| one((f64::from(k) - 0.5) * apart, k % 2 == 1)).collect()
}

/// Of a long flat part the sphere around it is far above: a tool that keeps its axis begins and ends over its passes, and goes over a
/// rib as high as everything between them at most.
#[test]
fn a_tool_that_keeps_its_axis_stays_low() {
    let cutter = ball(6.0, 60.0);
    let (top, clearance_mm) = (1.5, 5.0);
    let links = |dropped: bool| Links {
        clearance_mm,
        approach_mm: 2.0,
        hop_mm: 0.125,
        dropped,
        ..links_over(Box3 { min: Point3::new(-150.0, 0.0, -2.0), max: Point3::new(150.0, 8.0, top) }, cutter)
    };
    let mut passes = over_plane(40.0, 3.0);
    for p in &mut passes[2].points {
        p.point = Point3::new(0.0, p.point.y, top);
    }
    let highest = |linked: &Linked| linked.path.moves.iter().map(|m| m.pose.tip.z).fold(0.0, f64::max);
    let [low, high] = [true, false].map(|dropped| link(&passes, &links(dropped), &Walls::default()));
    assert_eq!(highest(&low), top + clearance_mm);
    assert!(highest(&high) > 150.0, "{}", highest(&high));
    let ends = [&low.path.moves[0], &low.path.moves[low.path.moves.len() - 1]].map(|m| m.pose.tip);
    let at = [passes[0].points[0].pose.tip, passes[2].points[8].pose.tip];
    for (end, at) in ends.iter().zip(&at) {
        assert!((end - at - Vec3::z() * (top + clearance_mm)).norm() < 1e-9, "{end} {at}");
    }
}

#[test]
fn a_hop_rises_by_no_more_than_is_clear() {
    let cutter = ball(6.0, 30.0);
    let links = |hop_mm: f64| Links {
        approach_mm: 2.0,
        hop_mm,
        plunge_mm_min: 10000.0,
        ..links_over(Box3 { min: Point3::new(-5.0, 0.0, 0.0), max: Point3::new(14.0, 8.0, 1.5) }, cutter)
    };
    // Of the hop from the first pass to the second.
    let top = |linked: &Linked| {
        let moves = linked.path.moves.iter().zip(&linked.pass_of_move);
        let hop = moves.skip_while(|m| *m.1 != Some(0)).take_while(|m| *m.1 != Some(1));
        hop.filter(|m| m.1.is_none()).map(|(m, _)| m.pose.tip.z).fold(0.0, f64::max)
    };
    // Farther apart than the tool is wide: nothing goes straight along the surface.
    let flat = over_plane(7.0, 3.0);
    let low = link(&flat, &links(0.125), &Walls::default());
    let high = link(&flat, &links(2.0), &Walls::default());
    assert_eq!([top(&low), top(&high)], [0.125, 2.0]);
    // Two hops, up and down by so much less each.
    assert!((high.air_length_mm - low.air_length_mm - 4.0 * 1.875).abs() < 1e-12);
    // The tool is aloft on the ways across, between the way up and the way down, and nowhere on what touches.
    let aloft =
        |linked: &Linked| linked.path.moves.iter().filter(|m| m.aloft && m.motion != Motion::Rapid).count();
    for linked in [&low, &high] {
        let fed = linked.path.moves.windows(2).filter(|w| w[1].motion != Motion::Rapid);
        fed.for_each(|w| assert_eq!(w[1].aloft, w[0].pose.tip.z.min(w[1].pose.tip.z) > 0.0));
    }
    assert!(aloft(&low) >= 2 && aloft(&high) >= 2);
    // A rib along the middle of the first hop, machined by a later pass: half of the lift must be spare.
    for (rib, lift) in [(0.1, 0.25), (0.2, 0.5), (0.4, 1.0), (0.7, 2.0)] {
        let mut passes = over_plane(7.0, 3.0);
        for p in &mut passes[2].points {
            p.point = Point3::new(0.0, p.point.y, rib);
        }
        let linked = link(&passes[..3], &links(0.125), &Walls::default());
        assert_eq!(top(&linked), lift, "{rib}");
    }
    // Beside each other: straight along the surface, as long as nothing stands there.
    let beside = link(&over_plane(4.0, 3.0), &links(0.125), &Walls::default());
    assert_eq!((top(&beside), aloft(&beside)), (0.0, 0));
}

#[test]
fn a_hop_keeps_off_a_wall_that_is_not_machined() {
    const RADIUS: f64 = 6.0;
    const APART: f64 = 8.8;
    let passes = over_plane(APART, RADIUS);
    let links = Links {
        approach_mm: 1.2,
        hop_mm: 1.2,
        plunge_mm_min: 10000.0,
        ..links_over(
            Box3 { min: Point3::new(-5.0, 0.0, 0.0), max: Point3::new(14.0, 8.0, 1.5) },
            ball(2.0 * RADIUS, 30.0),
        )
    };
    // A thin wall on the plane x = 0, between the first two passes.
    let joined = |height: f64, clearance: f64| {
        let foot = Line::new(Point3::origin(), Vec3::y(), Interval::new(-2.0, 10.0)).unwrap();
        let wall = Extruded::new(foot, Vec3::z(), Interval::new(0.0, height)).unwrap();
        let named = Named { face: "wall", surface: &wall };
        let keeping = Keeping { clearance_mm: clearance, accepted_mm: 0.0, radius_mm: RADIUS };
        link(&passes, &links, &Walls::of(&[named], &[], &keeping).unwrap())
    };
    // How far the ball's surface is off the wall at the nearest, in the closed form.
    let gap = |linked: &Linked, height: f64| {
        let motions = linked.path.moves.windows(2);
        let motions = motions.map(|w| LinearMotion { from: w[0].pose, to: w[1].pose });
        let at = motions.flat_map(|m| (0..=40).map(move |k| m.at(f64::from(k) / 40.0).unwrap().pose.tip));
        at.map(|tip| {
            let c = tip + Vec3::z() * RADIUS;
            let nearest = Point3::new(0.0, c.y.clamp(-2.0, 10.0), c.z.clamp(0.0, height));
            (c - nearest).norm() - RADIUS
        })
        .fold(f64::INFINITY, f64::min)
    };
    // How high the tool goes between the first two passes.
    let top = |linked: &Linked| {
        let moves = linked.path.moves.iter().zip(&linked.pass_of_move);
        let way = moves.skip_while(|m| *m.1 != Some(0)).take_while(|m| *m.1 != Some(1));
        way.filter(|m| m.1.is_none()).map(|(m, _)| m.pose.tip.z).fold(0.0, f64::max)
    };
    // A wall between two passes that lie beside each other: a way that does not see it goes straight through it.
    let blind = link(&passes, &links, &Walls::default());
    assert!(gap(&blind, 1.5) < -1.2 && top(&blind) == 0.0);
    // One that does goes over it, by its clearance at least but for where passes are nearer; from the second pass to the third nothing
    // stands in the way.
    let at_passes = |height: f64| (0.5 * APART).hypot(RADIUS - height) - RADIUS;
    for (height, clearance) in [(1.5, 0.5), (0.9, 0.5), (0.9, 0.2)] {
        let seen = joined(height, clearance);
        assert!(
            gap(&seen, height) >= clearance.min(0.5 * at_passes(height)) - 1e-9,
            "{}",
            gap(&seen, height)
        );
        assert!(top(&seen) >= height + clearance.min(at_passes(height)), "{}", top(&seen));
        let last = |linked: &Linked| linked.path.moves.iter().rev().take(20).copied().collect::<Vec<_>>();
        assert_eq!(last(&seen), last(&blind));
    }
    // With 0.3 mm over the wall a hop of 1.2 mm keeps 0.2 mm, not half a millimetre.
    assert_eq!(top(&joined(0.9, 0.2)), 1.2);
    assert!(top(&joined(0.9, 0.5)) > 1.2);
}

#[test]
fn a_holder_keeps_off_a_wall_too() {
    let passes = over_plane(6.0, 4.0);
    let ball = ball(8.0, 10.0);
    let with = |holder: Option<Holder>| Links {
        approach_mm: 1.2,
        hop_mm: 1.2,
        holder,
        ..links_over(Box3 { min: Point3::new(-3.0, 0.0, 0.0), max: Point3::new(9.0, 12.2, 20.0) }, ball)
    };
    // A post above the cutter's length, behind the middle between the ends of the first two passes: 5.05 mm off their axes, and
    // 4.2 mm off that of a tool half way between.
    let foot = Line::new(Point3::new(0.0, 12.2, 12.0), Vec3::x(), Interval::new(-0.2, 0.2)).unwrap();
    let post = Extruded::new(foot, Vec3::z(), Interval::new(0.0, 8.0)).unwrap();
    let keeping = Keeping { clearance_mm: 0.5, accepted_mm: 0.0, radius_mm: 4.0 };
    let walls = Walls::of(&[Named { face: "post", surface: &post }], &[], &keeping).unwrap();
    let without = link(&passes, &with(None), &walls);
    assert_eq!(without, link(&passes, &with(None), &Walls::default()));
    let holder = Some(Holder::cylinder(9.0, 30.0).unwrap());
    assert_eq!(link(&passes, &with(holder.clone()), &Walls::default()), without);
    assert_ne!(link(&passes, &with(holder), &walls), without);
}

#[test]
fn under_a_ceiling_a_tool_stays_as_near_to_it_as_it_must() {
    const RADIUS: f64 = 4.0;
    const CLEARANCE: f64 = 0.5;
    // A ball lies on the floor, under a ceiling that leans as it does; as it leaves the floor it comes nearer to that than it should.
    let (sin, cos) = 70.0_f64.to_radians().sin_cos();
    let axis = Unit3::new_normalize(Vec3::new(0.0, sin, cos));
    let aside = Vec3::new(0.0, -cos, sin);
    let ceiling_mm = RADIUS + 0.75;
    let at = |x: f64| {
        let centre = Point3::new(x, 0.0, RADIUS);
        let pose = Pose { tip: centre - axis.into_inner() * RADIUS, axis };
        let point = Point3::new(x, 0.0, 0.0);
        CcPoint { uv: uv(x, 0.0), point, normal: Vec3::z_axis(), pose, width_mm: RADIUS }
    };
    let passes = [0.0, 60.0].map(|x| Pass { points: vec![at(x), at(x + 2.0)], closed: false });
    let links = Links {
        approach_mm: 1.2,
        hop_mm: 0.3,
        ..links_over(
            Box3 { min: Point3::new(-5.0, -5.0, 0.0), max: Point3::new(65.0, 30.0, 30.0) },
            ball(2.0 * RADIUS, 20.0),
        )
    };
    let foot = Point3::new(0.0, 0.0, RADIUS) + aside * ceiling_mm - axis.into_inner() * 10.0;
    let foot = Line::new(foot, Vec3::x(), Interval::new(-10.0, 75.0)).unwrap();
    let ceiling = Extruded::new(foot, axis.into_inner(), Interval::new(0.0, 50.0)).unwrap();
    let keeping = Keeping { clearance_mm: CLEARANCE, accepted_mm: 0.0, radius_mm: RADIUS };
    // A rib between the passes, higher than hops.
    let foot = Line::new(Point3::new(30.0, 0.0, 0.0), Vec3::y(), Interval::new(-10.0, 30.0)).unwrap();
    let rib = Extruded::new(foot, Vec3::z(), Interval::new(0.0, 1.0)).unwrap();
    let named = [Named { face: "ceiling", surface: &ceiling }, Named { face: "rib", surface: &rib }];
    let walls = Walls::of(&named, &[], &keeping).unwrap();
    let linked = link(&passes, &links, &walls);
    let moves = linked.path.moves.iter().zip(&linked.pass_of_move);
    let way = moves.skip_while(|m| *m.1 != Some(0)).take_while(|m| *m.1 != Some(1));
    let way: Vec<Pose> = way.filter(|m| m.1.is_none()).map(|(m, _)| m.pose).collect();
    assert!(way.len() > 2);
    for pose in way {
        // Off the ceiling and the floor in the closed form; not over the sphere, which is five times as far.
        let centre = pose.tip + axis.into_inner() * RADIUS;
        let off = ceiling_mm - (centre - Point3::new(0.0, 0.0, RADIUS)).dot(&aside) - RADIUS;
        assert!(off > CLEARANCE && off < 0.75 + 1e-9, "{off}");
        assert!(centre.z > RADIUS - 1e-9, "{centre}");
        assert!(centre.y < 10.0, "{centre}");
    }
}
