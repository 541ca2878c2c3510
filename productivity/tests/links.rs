//! Moves between passes among walls and in narrow channels, held against frozen poses of cutter and holder.
//!
//! The part is a plane with upright plates on it, whose distance from the tool is known by formulas of this file. Passes run on the plane
//! wherever the tool fits, upright or leaning along them, in any order and sense. Whatever the way from one to the next is, the tool
//! stays out of plates and plane at every instant, its rapid moves stay above what may stand on the plane, and it goes over the sphere
//! around the part no more often than passes lie in different channels.

use osculate_geom::analytic::{Line, Plane};
use osculate_geom::{Box3, Domain, Extruded, Interval, Point3, Unit3, Vec3, uv};
use osculate_productivity::plan::{
    CcPoint, Freedom, Keeping, Links, Named, Pass, Stretches, Walls, link_stretches, ordered,
};
use osculate_tools::cl::{ClPath, Motion};
use osculate_tools::{Cutter, CutterSpec, Holder, Pose};
use proptest::prelude::*;

const RADIUS: f64 = 2.0;
const LENGTH: f64 = 24.0;
const HOLDER: [f64; 2] = [5.0, 20.0];
const LAYER: f64 = 0.4;
const CLEARANCE: f64 = 0.8;
/// Half the side of the plane.
const SIDE: f64 = 24.0;
/// Frozen poses of a move are no farther apart, mm.
const STEP: f64 = 0.1;
/// What ways may go into faces, and what the tool's roundness hides between two points of a face.
const INTO: f64 = 0.002;
const HIDDEN: f64 = 0.004;

/// A plate: its x, how far it goes along y, and how high.
#[derive(Clone, Copy, Debug)]
struct Plate {
    x: f64,
    y: [f64; 2],
    height: f64,
}

impl Plate {
    fn surface(&self) -> Extruded<Line> {
        let foot =
            Line::new(Point3::new(self.x, 0.0, 0.0), Vec3::y(), Interval::new(self.y[0], self.y[1])).unwrap();
        Extruded::new(foot, Vec3::z(), Interval::new(0.0, self.height)).unwrap()
    }

    /// The nearest point of it to a point.
    fn nearest(&self, p: &Point3) -> Point3 {
        Point3::new(self.x, p.y.clamp(self.y[0], self.y[1]), p.z.clamp(0.0, self.height))
    }

    /// How far it is off a segment: the distance of a point from a convex set is convex along the segment, so that thirds find the
    /// least.
    fn off(&self, from: &Point3, to: &Point3) -> f64 {
        let far = |t: f64| {
            let p = from + (to - from) * t;
            (p - self.nearest(&p)).norm()
        };
        let (mut lo, mut hi) = (0.0, 1.0);
        for _ in 0..60 {
            let (a, b) = (lo + (hi - lo) / 3.0, hi - (hi - lo) / 3.0);
            if far(a) < far(b) { hi = b } else { lo = a }
        }
        far(0.5 * (lo + hi))
    }
}

/// How far cutter and holder are off plates and plane at a pose, both as bodies with round ends: the holder's are within it.
fn off(pose: &Pose, plates: &[Plate]) -> [f64; 2] {
    let at = |up: f64| pose.tip + pose.axis.into_inner() * up;
    let cutter = [at(RADIUS), at(LENGTH - RADIUS)];
    let holder = [at(LENGTH + HOLDER[0]), at(LENGTH + HOLDER[1] - HOLDER[0])];
    let least = |[a, b]: [Point3; 2], radius: f64| {
        plates.iter().map(|p| p.off(&a, &b)).fold(f64::INFINITY, f64::min) - radius
    };
    // The plane is nearest to the lower end, for all axes look up.
    let plane = if at(RADIUS).x.abs().max(at(RADIUS).y.abs()) > SIDE + RADIUS {
        f64::INFINITY
    } else {
        at(RADIUS).z - RADIUS
    };
    [least(cutter, RADIUS).min(least(holder, HOLDER[0])), plane]
}

/// Every pose of a path that is looked at, with whether it is on a rapid move and of a pass.
fn frozen(path: &ClPath, pass_of_move: &[Option<u32>]) -> impl Iterator<Item = (Pose, bool, bool)> {
    let legs = path.moves.windows(2).zip(pass_of_move.iter().skip(1));
    legs.flat_map(|(w, pass)| {
        let [a, b] = [w[0].pose, w[1].pose];
        let n = ((b.tip - a.tip).norm() / STEP).ceil().max((a.axis.angle(&b.axis) / 0.01).ceil()).max(1.0)
            as usize;
        (0..=n).map(move |k| {
            let t = k as f64 / n as f64;
            let axis = Unit3::new_normalize(a.axis.into_inner() * (1.0 - t) + b.axis.into_inner() * t);
            (Pose { tip: a.tip + (b.tip - a.tip) * t, axis }, w[1].motion == Motion::Rapid, pass.is_some())
        })
    })
}

/// The ball on the plane, leaning along y.
fn contact(x: f64, y: f64, lean: f64) -> CcPoint {
    let axis = Unit3::new_normalize(Vec3::new(0.0, lean.sin(), lean.cos()));
    let point = Point3::new(x, y, 0.0);
    let tip = point + (Vec3::z() - axis.into_inner()) * RADIUS;
    CcPoint { uv: uv(x, y), point, normal: Vec3::z_axis(), pose: Pose { tip, axis }, width_mm: 0.5 }
}

/// Plates side by side, each some room from the last: channels as narrow as the ball lets them be, or wide ones.
fn plates() -> impl Strategy<Value = Vec<Plate>> {
    let one = (0.3..6.0f64, prop::bool::ANY, 3.0..18.0f64, 4.0..20.0f64, -8.0..8.0f64);
    prop::collection::vec(one, 1..5).prop_map(|all| {
        let mut x = -10.0;
        let plate = |(room, narrow, height, long, middle): (f64, bool, f64, f64, f64)| {
            x += 2.0 * RADIUS + if narrow { 0.1 * room } else { room };
            Plate { x, y: [middle - 0.5 * long, middle + 0.5 * long], height }
        };
        all.into_iter().map(plate).collect()
    })
}

/// Passes on the plane as far as the ball and its holder are off all plates: pieces of rows along y, in any order.
fn passes(plates: &[Plate], rows: &[(f64, f64, f64, f64, bool)]) -> Vec<Pass> {
    let mut out = Vec::new();
    for (x, from, long, lean, back) in rows {
        let all = (0..=120).map(|k| contact(*x, from + long * f64::from(k) / 120.0, *lean));
        let mut run: Vec<CcPoint> = Vec::new();
        for p in all.map(Some).chain([None]) {
            match p.filter(|p| off(&p.pose, plates)[0] > 0.03) {
                Some(p) => run.push(p),
                None if run.len() > 1 => {
                    let mut points = std::mem::take(&mut run);
                    if *back {
                        points.reverse();
                    }
                    out.push(Pass { points, closed: false });
                }
                None => run.clear(),
            }
        }
    }
    out
}

fn links() -> Links {
    let obstacles = Box3 { min: Point3::new(-SIDE, -SIDE, 0.0), max: Point3::new(SIDE, SIDE, 18.0) };
    let ball = CutterSpec::Ball { diameter_mm: 2.0 * RADIUS, length_mm: LENGTH };
    let mut links = Links::new(obstacles, Cutter::try_from(ball).unwrap(), 1500.0);
    links.clearance_mm = 5.0;
    (links.dip_mm, links.layer_mm) = (INTO, LAYER);
    links.holder = Some(Holder::cylinder(2.0 * HOLDER[0], HOLDER[1]).unwrap());
    links
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn no_way_goes_into_walls_or_rapidly_into_material(
        plates in plates(),
        rows in prop::collection::vec((-9.0..16.0f64, -16.0..0.0f64, 4.0..24.0f64, -0.35..0.35f64, any::<bool>()), 2..16),
        leans in any::<bool>(),
    ) {
        let rows: Vec<_> = rows.into_iter().map(|(x, from, long, lean, back)| (x, from, long, if leans { lean } else { 0.0 }, back)).collect();
        let passes = passes(&plates, &rows);
        prop_assume!(passes.len() > 1);
        let surfaces: Vec<_> = plates.iter().map(Plate::surface).collect();
        let check: Vec<Named<'_>> = surfaces.iter().map(|s| Named { face: "plate", surface: s }).collect();
        let side = Interval::new(-SIDE, SIDE);
        let floor = Plane::new(Domain { u: side, v: side });
        let own = [Named { face: "floor", surface: &floor }];
        let keeping = Keeping { clearance_mm: CLEARANCE, accepted_mm: INTO, radius_mm: RADIUS };
        let walls = Walls::of(&check, &own, &keeping).unwrap();
        let links = links();
        let all = ordered(&Stretches::from(passes), &links, &walls, Freedom { turned: true, in_turn: false });
        let linked = link_stretches(&all.passes, &all.skipped, &links, &walls);
        for (pose, rapid, of_pass) in frozen(&linked.path, &linked.pass_of_move) {
            let [walls, floor] = off(&pose, &plates);
            // Passes keep 0.03 mm.
            prop_assert!(walls >= if of_pass { 0.03 - HIDDEN } else { -HIDDEN }, "{walls} at {pose:?}");
            prop_assert!(floor >= -INTO - HIDDEN, "{floor} at {pose:?}");
            prop_assert!(!rapid || floor > LAYER, "{floor} at {pose:?}");
        }
    }
}

#[test]
fn ways_are_no_longer_than_what_stands_between_needs() {
    // Rows on both sides of a plate: half a millimetre apart on each side, 6 mm across it.
    let plate = Plate { x: 0.0, y: [-8.0, 8.0], height: 6.0 };
    let row = |x: f64| Pass { points: vec![contact(x, -6.0, 0.0), contact(x, 6.0, 0.0)], closed: false };
    let rows: Vec<Pass> = (0..8)
        .map(|k| row(if k < 4 { -4.5 + 0.5 * f64::from(k) } else { 1.0 + 0.5 * f64::from(k) }))
        .collect();
    let surface = plate.surface();
    let side = Interval::new(-SIDE, SIDE);
    let floor = Plane::new(Domain { u: side, v: side });
    let keeping = Keeping { clearance_mm: CLEARANCE, accepted_mm: INTO, radius_mm: RADIUS };
    let walls = Walls::of(
        &[Named { face: "plate", surface: &surface }],
        &[Named { face: "floor", surface: &floor }],
        &keeping,
    )
    .unwrap();
    let links = links();
    let all = ordered(&rows.into(), &links, &walls, Freedom { turned: true, in_turn: false });
    let linked = link_stretches(&all.passes, &all.skipped, &links, &walls);
    let first = linked.pass_of_move.iter().position(Option::is_some).unwrap();
    let last = linked.pass_of_move.iter().rposition(Option::is_some).unwrap();
    let highest = linked.path.moves[first..=last].iter().map(|m| m.pose.tip.z).fold(0.0, f64::max);
    // Over the plate by its clearance, once; the next height that is looked at is half as much again.
    assert!(
        highest >= 6.0 + CLEARANCE && highest <= 1.5 * (6.0 + CLEARANCE) + links.approach_mm,
        "{highest}"
    );
    let legs = linked.path.moves[first..=last].windows(2).zip(&linked.pass_of_move[first + 1..=last]);
    let air: f64 =
        legs.filter(|(_, p)| p.is_none()).map(|(w, _)| (w[1].pose.tip - w[0].pose.tip).norm()).sum();
    // From row to row along the surface, or just off it where that is faster.
    assert!(air <= 6.0 * (0.6 + 2.0 * links.hop_mm) + 2.0 * highest + 6.0, "{air} {}", links.hop_mm);
}
