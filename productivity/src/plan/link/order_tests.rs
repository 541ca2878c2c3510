//! Orders against all orders that there are, and against what is plain to see.

use super::links::{GRAZING, STRAIGHT};
use super::*;
use crate::plan::Stretches;
use osculate_geom::{Box3, Point3, Vec3, uv};
use osculate_tools::{Cutter, CutterSpec};
use proptest::prelude::*;

const RADIUS: f64 = 1.0;

fn links() -> Links {
    let obstacles = Box3 { min: Point3::new(-50.0, -50.0, 0.0), max: Point3::new(50.0, 50.0, 0.0) };
    let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 2.0 * RADIUS, length_mm: 30.0 }).unwrap();
    Links { clearance_mm: 5.0, plunge_mm_min: 3000.0, ..Links::new(obstacles, ball, 1500.0) }
}

/// Upright at a place of the plane z = 0.
fn at([x, y]: [f64; 2]) -> CcPoint {
    let point = Point3::new(x, y, 0.0);
    let pose = Pose { tip: point, axis: Vec3::z_axis() };
    CcPoint { uv: uv(x, y), point, normal: Vec3::z_axis(), pose, width_mm: 1.0 }
}

fn straight(from: [f64; 2], to: [f64; 2]) -> Pass {
    Pass { points: vec![at(from), at(to)], closed: false }
}

fn in_order(passes: Vec<Pass>, freedom: Freedom) -> Vec<Pass> {
    let found = ordered(&passes.into(), &links(), &Walls::default(), freedom);
    assert_eq!(found.passes.len(), found.skipped.len());
    found.passes
}

/// Time of the moves between passes in their order, min: over a plane on which nothing stands.
fn min(passes: &[Pass]) -> f64 {
    let linked = link(passes, &links(), &Walls::default());
    let first = linked.pass_of_move.iter().position(Option::is_some).unwrap();
    let last = linked.pass_of_move.iter().rposition(Option::is_some).unwrap();
    let legs = linked.path.moves[first..=last].windows(2).zip(&linked.pass_of_move[first + 1..=last]);
    legs.filter(|(_, p)| p.is_none())
        .map(|(w, _)| {
            let length_mm = (w[1].pose.tip - w[0].pose.tip).norm();
            match w[1].motion {
                Motion::Feed(feed) => length_mm / feed,
                Motion::Rapid => links().rates.rapid_min(Step { length_mm, turn_rad: 0.0 }),
            }
        })
        .sum()
}

/// Which of the passes one is, and whether it is turned.
fn of(pass: &Pass, all: &[Pass]) -> (usize, bool) {
    let same = |p: &Pass| p.points == pass.points;
    if let Some(k) = all.iter().position(same) {
        return (k, false);
    }
    let back: Vec<CcPoint> = pass.points.iter().rev().copied().collect();
    (all.iter().position(|p| p.points == back).unwrap(), true)
}

/// All orders of numbers, by Heap.
fn permutations(n: usize) -> Vec<Vec<usize>> {
    fn heap(k: usize, own: &mut Vec<usize>, out: &mut Vec<Vec<usize>>) {
        if k <= 1 {
            out.push(own.clone());
            return;
        }
        for i in 0..k {
            heap(k - 1, own, out);
            own.swap(if k.is_multiple_of(2) { i } else { 0 }, k - 1);
        }
    }
    let mut out = Vec::new();
    heap(n, &mut (0..n).collect(), &mut out);
    out
}

/// Where passes end, mm; five of them.
fn few() -> impl Strategy<Value = Vec<[[f64; 2]; 2]>> {
    let place = || prop::array::uniform2(-40.0..40.0f64);
    prop::collection::vec((place(), place()).prop_map(|(a, b)| [a, b]), 5)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Of few passes the order is hardly slower than the best of all, each is there once, and none is turned that may not be.
    #[test]
    fn an_order_is_nearly_the_best_of_all(ends in few(), turned in any::<bool>()) {
        let passes: Vec<Pass> = ends.iter().map(|[a, b]| straight(*a, *b)).collect();
        let found = in_order(passes.clone(), Freedom { turned, in_turn: false });
        let mut was: Vec<(usize, bool)> = found.iter().map(|p| of(p, &passes)).collect();
        prop_assert!(turned || was.iter().all(|w| !w.1));
        was.sort_unstable();
        prop_assert!(was.iter().map(|w| w.0).eq(0..passes.len()));
        let orders = permutations(passes.len());
        let ways = if turned { 1u32 << passes.len() } else { 1 };
        let best = orders.iter().flat_map(|o| (0..ways).map(move |w| (o, w))).map(|(order, ways)| {
            let one = |k: &usize| {
                let mut pass = passes[*k].clone();
                if ways >> k & 1 == 1 {
                    pass.points.reverse();
                }
                pass
            };
            let ends: Vec<[CcPoint; 2]> = order.iter().map(one).map(|p| [p.points[0], p.points[1]]).collect();
            // As `min`, from end to end; a way of two passes alone takes what it takes among others.
            ends.windows(2).map(|w| (w[1][0].point - w[0][1].point).norm()).map(|far| {
                let l = links();
                let fed = if far > STRAIGHT * RADIUS { (far + 2.0 * l.hop_mm) / l.feed_mm_min } else { far / (GRAZING * l.plunge_mm_min) };
                let over = l.approach_mm / l.feed_mm_min + l.approach_mm / l.plunge_mm_min;
                fed.min(over + l.rates.rapid_min(Step { length_mm: far, turn_rad: 0.0 }))
            }).sum::<f64>()
        }).fold(f64::INFINITY, f64::min);
        // Moves of two kinds between five passes get stuck now and then, and low ways come down at the feed of plunges.
        prop_assert!(min(&found) <= 1.2 * best + 1e-3, "{} {best}", min(&found));
        prop_assert!(min(&found) <= min(&passes) + 1e-12);
    }

    /// Rows over a plane in any order and sense become rows to and fro, from one to the next.
    #[test]
    fn rows_go_to_and_fro(keys in prop::collection::vec((any::<u32>(), any::<bool>()), 2..40)) {
        let mut rows: Vec<(u32, Pass)> = keys.iter().enumerate().map(|(k, (key, back))| {
            let y = k as f64;
            (*key, if *back { straight([20.0, y], [0.0, y]) } else { straight([0.0, y], [20.0, y]) })
        }).collect();
        rows.sort_by_key(|r| r.0);
        let rows: Vec<Pass> = rows.into_iter().map(|r| r.1).collect();
        let n = rows.len();
        let free = in_order(rows.clone(), Freedom { turned: true, in_turn: false });
        let far: f64 = free.windows(2).map(|w| (w[1].points[0].point - w[0].points[1].point).norm()).sum();
        prop_assert!((far - (n - 1) as f64).abs() < 1e-9, "{far}");
        // In their own senses: no row is turned.
        let own = in_order(rows.clone(), Freedom { turned: false, in_turn: false });
        prop_assert!(own.iter().all(|p| !of(p, &rows).1));
        // In turn: each row lies beside the two next to it only, and comes after that of them that came before it.
        let kept = in_order(rows.clone(), Freedom { turned: true, in_turn: true });
        let place: Vec<usize> = kept.iter().map(|p| of(p, &rows).0).collect();
        for (i, a) in place.iter().enumerate() {
            for b in &place[i + 1..] {
                let apart = (rows[*a].points[0].point.y - rows[*b].points[0].point.y).abs();
                prop_assert!(apart > 1.5 || a < b);
            }
        }
    }
}

#[test]
fn closed_passes_begin_where_the_tool_comes_from() {
    let circle = |radius: f64, turn: f64| {
        let point = |k: usize| {
            let (s, c) = (turn + std::f64::consts::TAU * (k % 120) as f64 / 120.0).sin_cos();
            at([radius * c, radius * s])
        };
        Pass { points: (0..=120).map(point).collect(), closed: true }
    };
    let rings: Vec<Pass> = (0..8).map(|k| circle(20.0 - 0.5 * f64::from(k), 1.3 * f64::from(k))).collect();
    let found = in_order(rings, Freedom { turned: true, in_turn: false });
    for w in found.windows(2) {
        let (a, b) = (w[0].points[120], w[1].points[0]);
        assert_eq!(w[0].points[0], a);
        // Straight on to the next ring, to the nearer of its points: they are 3 degrees apart.
        let far = (a.point - b.point).norm();
        assert!(far >= 0.5 - 1e-9 && far <= 0.5f64.hypot(20.0 * 1.5f64.to_radians()), "{far}");
    }
}

#[test]
fn what_was_taken_out_stays_between_its_passes() {
    let way = |from: f64, to: f64| vec![at([from, 0.0]), at([0.5 * (from + to), 0.0]), at([to, 0.0])];
    let all = Stretches {
        passes: vec![
            straight([0.0, 0.0], [4.0, 0.0]),
            straight([9.0, 0.0], [20.0, 0.0]),
            straight([0.0, 30.0], [20.0, 30.0]),
        ],
        skipped: vec![way(4.0, 9.0), Vec::new(), Vec::new()],
    };
    let found = ordered(&all, &links(), &Walls::default(), Freedom { turned: true, in_turn: false });
    let x = |p: &CcPoint| p.point.x;
    for (k, skipped) in found.skipped.iter().enumerate() {
        let Some(next) = found.passes.get(k + 1) else { continue };
        let last = &found.passes[k].points[1];
        let ends = [x(last), x(&next.points[0])];
        let inside = [[4.0, 9.0], [9.0, 4.0]].contains(&ends) && last.point.y == next.points[0].point.y;
        assert_eq!(skipped.len(), if inside { 3 } else { 0 });
        if inside {
            assert_eq!([x(&skipped[0]), x(&skipped[2])], ends);
        }
    }
    assert_eq!(found.skipped.iter().filter(|s| !s.is_empty()).count(), 1);
}
