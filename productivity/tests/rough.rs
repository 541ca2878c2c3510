//! Roughing against closed forms and against a dense model of heights: what is taken of a known pocket, that nothing is met in rapid or
//! straight down, that what is cleared is not cut again, and that a leaning axis clears what an upright one cannot.

use crate::heights;

use heights::{Done, Heights};
use osculate_geom::analytic::{Placed, Placement, Plane};
use osculate_geom::{Box3, Domain, Interval, Point3, Unit3, Vec3};
use osculate_productivity::plan::{
    Entry, Headings, Links, Named, PlanError, RoughTask, Roughing, Rows, Search, Sizes, rough,
};
use osculate_tools::cl::Motion;
use osculate_tools::removal::Swept;
use osculate_tools::removal::stock::{Blank, Resolution, Stock, StockJob};
use osculate_tools::{Cutter, CutterSpec};
use std::f64::consts::PI;

const SIZES: Sizes = Sizes {
    stepdown_mm: 2.0,
    stepover_mm: 2.4,
    allowance_mm: 0.4,
    ramp_rad: 0.1,
    chord_mm: 0.01,
    stands_mm: 0.5,
};
const RADIUS: f64 = 3.0;
const FEED: f64 = 1000.0;

fn flat() -> Cutter {
    Cutter::try_from(CutterSpec::Flat { diameter_mm: 2.0 * RADIUS, length_mm: 40.0 }).unwrap()
}

fn boxed(low: [f64; 3], high: [f64; 3]) -> Box3 {
    Box3 { min: Point3::from(low), max: Point3::from(high) }
}

fn filled(block: Box3) -> Stock {
    let resolution = Resolution { cell_mm: 0.25, tri: true, budget_bytes: 1 << 28 };
    Stock::fill(&Blank::Box(block), &resolution).unwrap().stock
}

/// A rectangle from a corner, along x and across the normal.
fn rectangle(corner: [f64; 3], normal: [f64; 3], x: [f64; 3], size: [f64; 2]) -> Placed<Plane> {
    let frame =
        Placement::new(Point3::from(corner), Unit3::new_normalize(Vec3::from(normal)), Some(Vec3::from(x)));
    let side = |s: f64| Interval::new(0.0, s);
    Placed { surface: Plane::new(Domain { u: side(size[0]), v: side(size[1]) }), placement: frame }
}

/// How it is roughed.
#[derive(Clone, Copy)]
struct How<'a> {
    from: Headings<'a>,
    entry: Entry,
    plunges: bool,
    rate: f64,
    rows: Rows,
    /// Feed where nothing is taken.
    air: f64,
}

impl How<'_> {
    fn upright() -> Self {
        let from = Headings::Along(Vec3::z_axis());
        let rows = Rows::Along(Vec3::x());
        Self { from, entry: Entry::Auto, plunges: false, rate: f64::INFINITY, rows, air: FEED }
    }
}

fn planned(faces: &[Placed<Plane>], block: Box3, stock: &Stock, how: How<'_>) -> Result<Roughing, PlanError> {
    let cutter = flat();
    let mut links = Links::new(block, cutter, FEED);
    (links.clearance_mm, links.approach_mm, links.hop_mm) = (5.0, 1.0, 1.0);
    links.air_mm_min = how.air;
    let named: Vec<Named<'_>> = faces.iter().map(|f| Named { face: "F1", surface: f }).collect();
    rough(&RoughTask {
        faces: &named,
        check: &[],
        cutter: &cutter,
        from: how.from,
        rows: how.rows,
        stock,
        repeat: None,
        sizes: SIZES,
        entry: how.entry,
        plunges: how.plunges,
        volume_rate_mm3_min: how.rate,
        links: &links,
        progress: &|_| {},
    })
}

/// Takes from stock what a path takes; its volume and whether something was met in rapid.
fn carved(stock: &mut Stock, plan: &Roughing) -> f64 {
    let motions = Swept::along(&plan.linked.path);
    let cutter = flat();
    let job = StockJob { cutter: &cutter, uppers: &[], motions: &motions, touch_mm: 0.02 };
    let carved = stock.carve(&job, &|_| ()).unwrap();
    assert!(carved.collisions.is_empty(), "{:?}", carved.collisions);
    carved.volume_mm3()
}

/// A pocket of 20 x 16, 6 deep, in a block: floor, walls and the top around.
fn pocket() -> (Vec<Placed<Plane>>, Box3) {
    let (floor, up) = ([-10.0, -8.0, -6.0], [0.0, 0.0, 1.0]);
    let x = [1.0, 0.0, 0.0];
    let faces = vec![
        rectangle(floor, up, x, [20.0, 16.0]),
        rectangle(floor, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [16.0, 6.0]),
        rectangle([10.0, 8.0, -6.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [16.0, 6.0]),
        rectangle([10.0, -8.0, -6.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [20.0, 6.0]),
        rectangle([-10.0, 8.0, -6.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [20.0, 6.0]),
        rectangle([-16.0, -14.0, 0.0], up, x, [32.0, 6.0]),
        rectangle([-16.0, 8.0, 0.0], up, x, [32.0, 6.0]),
        rectangle([-16.0, -8.0, 0.0], up, x, [6.0, 16.0]),
        rectangle([10.0, -8.0, 0.0], up, x, [6.0, 16.0]),
    ];
    (faces, boxed([-16.0, -14.0, -8.0], [16.0, 14.0, 0.0]))
}

fn heights_of(block: Box3, plan: &Roughing) -> Done {
    Heights::of(&block, RADIUS).run(&plan.linked.path, SIZES.ramp_rad)
}

/// What may be met straight down: slivers that the layers leave on purpose.
const SLIVER: f64 = 0.05;

/// Less the allowance all around, with the tool's radius in the corners, down to the allowance on the floor.
#[test]
fn a_pocket_is_taken_by_its_volume() {
    let (faces, block) = pocket();
    let stock = filled(block);
    let a = SIZES.allowance_mm;
    let area = (20.0 - 2.0 * a) * (16.0 - 2.0 * a) - (4.0 - PI) * RADIUS * RADIUS;
    let want = area * (6.0 - a);
    {
        for entry in [Entry::Auto, Entry::Helix, Entry::Ramp] {
            let how = How { entry, ..How::upright() };
            let plan = planned(&faces, block, &stock, how).unwrap_or_else(|e| panic!("{entry:?}: {e}"));
            let done = heights_of(block, &plan);
            assert!((done.taken_mm3 / want - 1.0).abs() < 0.02, "{entry:?}: {done:?}, {want}");
            assert!(done.rapid_mm < 1e-6, "{entry:?}: {done:?}");
            assert!(done.dive_mm < SLIVER, "{entry:?}: {done:?}");
            let told: f64 = plan.headings.iter().map(|h| h.volume_mm3).sum();
            assert!((told / want - 1.0).abs() < 0.05, "{told} {want}");

            // Nothing of it is left for the same again.
            let mut rest = stock.clone();
            let taken = carved(&mut rest, &plan);
            assert!((taken / want - 1.0).abs() < 0.02, "{taken} {want}");
            match planned(&faces, block, &rest, how) {
                Err(PlanError::Nothing { .. }) => {}
                Ok(again) => {
                    let more = carved(&mut rest.clone(), &again);
                    assert!(more < 0.01 * want, "{more} {want}");
                }
                Err(e) => panic!("{e}"),
            }
        }
    }
}

/// From outside nothing leads into it; straight down a tool goes that may.
#[test]
fn a_closed_pocket_needs_a_way_in() {
    let (faces, block) = pocket();
    let stock = filled(block);
    let how = How { entry: Entry::Outside, ..How::upright() };
    assert!(matches!(planned(&faces, block, &stock, how), Err(PlanError::Nothing { .. })));
    let how = How { plunges: true, ..How::upright() };
    let plan = planned(&faces, block, &stock, how).unwrap();
    assert!(heights_of(block, &plan).rapid_mm < 1e-6);
}

/// The time of a path, min.
fn minutes(plan: &Roughing) -> f64 {
    let each = plan.linked.path.moves.windows(2).map(|w| match w[1].motion {
        Motion::Feed(feed) => (w[1].pose.tip - w[0].pose.tip).norm() / feed,
        Motion::Rapid => (w[1].pose.tip - w[0].pose.tip).norm() / 30_000.0,
    });
    each.sum()
}

/// Over a long narrow place rows do not go across it, whichever way is given; what is taken is the same, with fewer passes.
#[test]
fn rows_go_the_quickest_way() {
    let long = [-4.0, -30.0, -2.0];
    let faces = vec![rectangle(long, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [8.0, 60.0])];
    let block = boxed([-4.0, -30.0, -4.0], [4.0, 30.0, 0.0]);
    let stock = filled(block);
    let with = |rows: Rows| planned(&faces, block, &stock, How { rows, ..How::upright() }).unwrap();
    let [across, found] = [Rows::Along, Rows::Quickest].map(|rows| with(rows(Vec3::x())));
    let way = |plan: &Roughing| plan.headings[0].rows.into_inner();
    assert!(way(&across).x.abs() > 1.0 - 1e-9 && way(&found).x.abs() < 0.6, "{:?}", found.headings);
    assert!(2 * found.passes.passes.len() < across.passes.passes.len());
    let volumes = [&across, &found].map(|plan| carved(&mut stock.clone(), plan));
    assert!((volumes[0] / volumes[1] - 1.0).abs() < 0.02, "{volumes:?}");
    assert!(minutes(&found) < minutes(&across), "{} {}", minutes(&found), minutes(&across));
    // The quickest is found from any of them.
    let again = with(Rows::Quickest(Vec3::y()));
    assert!((minutes(&again) / minutes(&found) - 1.0).abs() < 0.1, "{} {}", minutes(&again), minutes(&found));
}

/// Two long pockets across each other have rows of their own, along each: fewer passes and less time than with any one way for both.
#[test]
fn rows_go_another_way_in_each_part() {
    let over = |[x, y]: [[f64; 2]; 2], z: f64| {
        rectangle([x[0], y[0], z], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [x[1] - x[0], y[1] - y[0]])
    };
    let tops = [
        [[-36.0, 40.0], [6.0, 36.0]],
        [[-36.0, 40.0], [-36.0, -6.0]],
        [[-36.0, -30.0], [-6.0, 6.0]],
        [[30.0, 40.0], [-6.0, 6.0]],
        [[40.0, 52.0], [30.0, 36.0]],
        [[40.0, 52.0], [-36.0, -30.0]],
        [[52.0, 58.0], [-36.0, 36.0]],
    ];
    let mut faces = vec![over([[-30.0, 30.0], [-6.0, 6.0]], -2.0), over([[40.0, 52.0], [-30.0, 30.0]], -2.0)];
    faces.extend(tops.map(|top| over(top, 0.0)));
    let block = boxed([-36.0, -36.0, -4.0], [58.0, 36.0, 0.0]);
    let stock = filled(block);
    let with = |rows: Rows| planned(&faces, block, &stock, How { rows, ..How::upright() }).unwrap();
    let own = with(Rows::Quickest(Vec3::x()));
    let volume = carved(&mut stock.clone(), &own);
    // Down to the allowance, but for corners of the tool's radius.
    let long = 60.0 - 2.0 * SIZES.allowance_mm;
    let wide = 12.0 - 2.0 * SIZES.allowance_mm;
    let pockets = 2.0 * (long * wide - (4.0 - PI) * RADIUS * RADIUS) * (2.0 - SIZES.allowance_mm);
    assert!((volume / pockets - 1.0).abs() < 0.02, "{volume} {pockets}");
    for way in [Vec3::x(), Vec3::y()] {
        let same = with(Rows::Along(way));
        assert!((volume / carved(&mut stock.clone(), &same) - 1.0).abs() < 0.01);
        let [few, many] = [&own, &same].map(|plan| plan.passes.passes.len());
        let [own, same] = [&own, &same].map(minutes);
        assert!(3 * few < many && own < 0.9 * same, "{few} of {many}, {own} of {same} min");
    }
}

/// Rows of a deep pocket end at a rib that leads into it from one wall: from one side of it to the other the tool goes around its end,
/// not over it. It comes up for
/// the layer below at most (over the rib it came up 25 times).
#[test]
fn the_tool_goes_around_a_rib_in_a_deep_pocket() {
    const DEEP: f64 = 18.0;
    let up = [0.0, 0.0, 1.0];
    let over = |[x, y]: [[f64; 2]; 2], z: f64| {
        rectangle([x[0], y[0], z], up, [1.0, 0.0, 0.0], [x[1] - x[0], y[1] - y[0]])
    };
    // A wall from one place to another, with the pocket on its left.
    let wall = |[from, to]: [[f64; 2]; 2]| {
        let way = [to[0] - from[0], to[1] - from[1]];
        let long = way[0].hypot(way[1]);
        rectangle([from[0], from[1], -DEEP], [-way[1], way[0], 0.0], [way[0], way[1], 0.0], [long, DEEP])
    };
    let corners = [
        [-20.0, -15.0],
        [-1.5, -15.0],
        [-1.5, 5.0],
        [1.5, 5.0],
        [1.5, -15.0],
        [20.0, -15.0],
        [20.0, 15.0],
        [-20.0, 15.0],
    ];
    let mut faces =
        vec![over([[-20.0, -1.5], [-15.0, 15.0]], -DEEP), over([[1.5, 20.0], [-15.0, 15.0]], -DEEP)];
    faces.extend([over([[-1.5, 1.5], [5.0, 15.0]], -DEEP), over([[-1.5, 1.5], [-15.0, 5.0]], 0.0)]);
    faces.extend((0..corners.len()).map(|k| wall([corners[k], corners[(k + 1) % corners.len()]])));
    faces.extend([
        over([[-26.0, 26.0], [15.0, 21.0]], 0.0),
        over([[-26.0, 26.0], [-21.0, -15.0]], 0.0),
        over([[-26.0, -20.0], [-15.0, 15.0]], 0.0),
        over([[20.0, 26.0], [-15.0, 15.0]], 0.0),
    ]);
    let block = boxed([-26.0, -21.0, -DEEP - 2.0], [26.0, 21.0, 0.0]);
    let stock = filled(block);
    let plan = planned(&faces, block, &stock, How { plunges: true, ..How::upright() }).unwrap();
    let done = heights_of(block, &plan);
    assert!(done.rapid_mm < 0.05, "{done:?}");
    let floor = (40.0 - 2.0 * SIZES.allowance_mm) * (30.0 - 2.0 * SIZES.allowance_mm);
    let rib = (3.0 + 2.0 * SIZES.allowance_mm) * 20.0;
    // But for six corners inside, of the tool's radius, and the rib's end, which it goes around.
    let volume = (floor - rib - 6.0 * (1.0 - PI / 4.0) * RADIUS * RADIUS) * (DEEP - SIZES.allowance_mm);
    assert!((done.taken_mm3 / volume - 1.0).abs() < 0.02, "{} {volume}", done.taken_mm3);
    let layers = plan.headings[0].layers.len();
    let (mut ups, mut is_deep) = (0, false);
    for m in &plan.linked.path.moves {
        let was_deep = is_deep;
        is_deep = if is_deep { m.pose.tip.z < -0.5 } else { m.pose.tip.z < -2.5 };
        ups += usize::from(was_deep && !is_deep);
    }
    assert!(ups <= layers, "{ups} times up for {layers} layers");
}

/// No more is taken in a minute than the job allows, and without a limit more is.
#[test]
fn the_feed_follows_the_volume_rate() {
    let (faces, block) = pocket();
    let stock = filled(block);
    {
        let most = 2500.0;
        let free = heights_of(block, &planned(&faces, block, &stock, How::upright()).unwrap());
        let how = How { rate: most, ..How::upright() };
        let held = heights_of(block, &planned(&faces, block, &stock, how).unwrap());
        assert!(free.rate_mm3_min > 1.5 * most, "{free:?}");
        // Sections are known to a node, a seventh of the tool's radius.
        assert!(held.rate_mm3_min < 1.15 * most, "{held:?}");
        assert!((held.taken_mm3 / free.taken_mm3 - 1.0).abs() < 0.01, "{held:?} {free:?}");
    }
}

/// What is gone along faster than passes takes no more than slivers, and is no small part of the way between them.
#[test]
fn only_air_is_gone_along_faster() {
    let (faces, block) = pocket();
    let stock = filled(block);
    let mut plan = planned(&faces, block, &stock, How { air: 4.0 * FEED, ..How::upright() }).unwrap();
    let moves = &mut plan.linked.path.moves;
    let (mut between_mm, mut air_mm) = (0.0, 0.0);
    for k in 1..moves.len() {
        let long = (moves[k].pose.tip - moves[k - 1].pose.tip).norm();
        if let Motion::Feed(feed) = moves[k].motion {
            between_mm += if plan.linked.pass_of_move[k].is_none() { long } else { 0.0 };
            if feed > FEED {
                assert_eq!(feed, 4.0 * FEED);
                air_mm += long;
                moves[k].motion = Motion::Rapid;
            }
        }
    }
    assert!(air_mm > 0.3 * between_mm, "{air_mm} {between_mm}");
    let done = heights_of(block, &plan);
    assert!(done.rapid_mm < SLIVER, "{done:?}");
}

/// A face that leans over a floor: what lies under it an upright tool does not reach, a leaning one does.
#[test]
fn a_leaning_axis_clears_under_an_overhang() {
    let (reach, high, long) = (9.0_f64, 12.0, 16.0);
    let slant = reach.hypot(high);
    let faces = vec![
        rectangle([0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [24.0, long]),
        rectangle([0.0, long, 0.0], [high, 0.0, -reach], [reach, 0.0, high], [slant, long]),
        rectangle([0.0, 0.0, high], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [reach, long]),
    ];
    let block = boxed([0.0, 0.0, -1.0], [24.0, long, high]);
    let stock = filled(block);
    let lean = Unit3::new_normalize(Vec3::new(reach, 0.0, high));
    let under = 0.5 * reach * high * long;

    let mut upright = stock.clone();
    let plan = planned(&faces, block, &stock, How::upright()).unwrap();
    let first = carved(&mut upright, &plan);
    // It comes no nearer than its radius beside the upper edge, and to the allowance over the floor.
    let a = SIZES.allowance_mm;
    assert!(first < (24.0 - reach) * long * (high - a), "{first}");

    let how = How { from: Headings::Along(lean), ..How::upright() };
    let plan = planned(&faces, block, &upright, how).unwrap();
    let mut both = upright.clone();
    let second = carved(&mut both, &plan);
    assert!(second > 0.6 * under, "{second} {under}");

    // Both are found, with the upright one as good as any to begin with, and nothing worth it is left.
    let candidates = [Vec3::z_axis(), Vec3::x_axis(), lean];
    let search = Search { candidates: &candidates, most: 5, least_share: 0.02 };
    let how = How { from: Headings::Found(search), ..How::upright() };
    let plan = planned(&faces, block, &stock, how).unwrap();
    let mut found = stock.clone();
    let all = carved(&mut found, &plan);
    assert!(all > 0.97 * (first + second), "{all} {first} {second}");
    assert!(plan.headings.len() <= 3, "{:?}", plan.headings);
}
