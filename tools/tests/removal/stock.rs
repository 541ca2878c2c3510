//! Volumes with closed forms, bodies that must not meet material, and meshes as raw material.
//!
//! A wall's place counts to the cell over the number of rows, a rounded one's to about the cell squared over its radius:
//! at cells of a fiftieth of the tool's radius volumes are good to well below 0.1 percent.

use crate::removal::common::{ball, flat, pose, shapes, through, toroidal, upright};
use crate::removal::volumes::cases;
use osculate_geom::{Box3, Point3, Unit3, Vec3};
use osculate_tools::removal::stock::{Blank, BlankError, Carved, Resolution, Stock, StockJob, Upper};
use osculate_tools::removal::{Body, Swept};
use osculate_tools::{Cutter, Pose};
use std::f64::consts::PI;

const PLENTY: usize = 1 << 30;

fn block(size: [f64; 3], cell_mm: f64) -> Stock {
    let whole = Box3 { min: Point3::origin(), max: Point3::from(size) };
    let resolution = Resolution { cell_mm, tri: true, budget_bytes: PLENTY };
    let made = Stock::fill(&Blank::Box(whole), &resolution).expect("a good box");
    assert!(made.coarsened.is_none());
    made.stock
}

fn carve(stock: &mut Stock, cutter: &Cutter, motions: &[Swept]) -> Carved {
    let before = stock.volume().mm3;
    let job = StockJob { cutter, uppers: &[], motions, touch_mm: 1e-3 };
    let carved = stock.carve(&job, &|_| ()).expect("a good job");
    // What is taken and what is left make up the whole.
    assert!((before - stock.volume().mm3 - carved.volume_mm3()).abs() < 1e-9 * before);
    carved
}

/// Within 0.1 percent.
fn close(what: &str, got: f64, want: f64) {
    assert!(
        (got - want).abs() < 1e-3 * want,
        "{what}: {got} mm3, the closed form says {want}: {:.3} %",
        100.0 * (got / want - 1.0)
    );
}

#[test]
fn volumes_of_slots_pockets_holes_and_faces() {
    let all = cases();
    assert!(all.len() > 12);
    for case in all {
        let mut stock = block(case.size_mm, case.cell_mm);
        let carved = carve(&mut stock, &case.cutter, &case.motions);
        close(case.name, carved.volume_mm3(), case.volume_mm3);
        let spread = stock.volume().spread_mm3;
        assert!(spread < 2e-3 * carved.volume_mm3(), "{}: {spread}", case.name);
    }
}

#[test]
fn what_a_slot_tells_of_its_chip() {
    for case in cases().into_iter().filter(|c| c.name.starts_with("slot")) {
        let mut stock = block(case.size_mm, 2.0 * case.cell_mm);
        let carved = carve(&mut stock, &case.cutter, &case.motions);
        let work = carved.work[0];
        // Over the sides that face the way only, and as high as the slot is deep.
        assert!((work.arc_rad - PI).abs() < 0.2, "{work:?}");
        assert!(work.height_mm[1] <= 3.3 && work.height_mm[1] > 1.5, "{work:?}");
        let length = (case.motions[0].to.tip - case.motions[0].from.tip).norm();
        assert!((work.section_mm2 - carved.volume_mm3() / length).abs() < 1e-12);
    }
}

/// A ball that goes down along its own axis into a thin layer takes a cap of it, whichever way the axis leans: the way has no
/// direction across the axis but for rounding.
#[test]
fn a_plunge_along_a_leaning_axis_takes_a_cap() {
    let (cutter, deep) = (ball(4.0), 0.6);
    let cap = PI * deep * deep * (2.0 - deep / 3.0);
    for k in 0..24 {
        let lean = 0.3 * f64::from(k) / 24.0;
        let axis = Unit3::new_normalize(Vec3::new(lean.sin(), 0.3 * lean.sin(), lean.cos()));
        let tip = Point3::new(3.0, 3.0, 2.0) - axis.into_inner() * 2.0;
        let mut stock = block([6.0, 6.0, deep], 0.04);
        let from = Pose { tip: tip + axis.into_inner() * 20.0, axis };
        let down = Swept { from, to: Pose { tip, axis }, rapid: false, block: 1 };
        let got = carve(&mut stock, &cutter, &[down]).volume_mm3();
        assert!((got / cap - 1.0).abs() < 2e-3, "lean {lean}: {got} mm3, the cap has {cap}");
    }
}

/// Volume converges: smooth walls with the square of the cell, and the three directions agree.
#[test]
fn volume_converges_with_the_cell() {
    let section = 25.0 * (1.7f64 / 5.0).acos() - 1.7 * (25.0f64 - 1.7 * 1.7).sqrt();
    let motions =
        through(&[pose([-10.0, 3.0, 16.7], [0.0, 0.0, 1.0]), pose([50.0, 27.0, 16.7], [0.0, 0.0, 1.0])]);
    let (s, c) = (24f64 / 60.0).atan().sin_cos();
    // Across the feed it is the section; the block cuts it off at x = 0 and 40, over 40 / cos.
    let want = section * 40.0 / c;
    assert!(s > 0.0);
    let error = |cell: f64| {
        let mut stock = block([40.0, 30.0, 20.0], cell);
        (carve(&mut stock, &ball(10.0), &motions).volume_mm3() - want).abs() / want
    };
    let errors = [0.8, 0.4, 0.2].map(error);
    // An order of 1.5 or better from a fifth to a twentieth of the radius; single steps scatter.
    assert!(errors[2] < errors[0] / 8.0 && errors[2] < 1e-3, "{errors:?}");
}

/// A turning motion takes what many frozen poses take.
#[test]
fn turning_motions() {
    let ends = [pose([5.0, 6.0, 8.0], [0.5, 0.1, 1.0]), pose([14.0, 9.0, 7.0], [-0.6, 0.3, 1.0])];
    let [cone, _, barrel, apt] = shapes();
    for cutter in [ball(6.0), toroidal(8.0, 1.5), flat(5.0), cone, barrel, apt] {
        let mut stock = block([20.0, 15.0, 12.0], 0.4);
        let whole = carve(&mut stock, &cutter, &through(&ends)).volume_mm3();
        let between = |t: f64| {
            let axis = ends[0].axis.into_inner() * (1.0 - t) + ends[1].axis.into_inner() * t;
            pose((ends[0].tip + (ends[1].tip - ends[0].tip) * t).into(), axis.into())
        };
        let frozen: Vec<Swept> = (0..=300)
            .map(|k| between(f64::from(k) / 300.0))
            .map(|p| Swept { from: p, to: p, rapid: false, block: 1 })
            .collect();
        let mut again = block([20.0, 15.0, 12.0], 0.4);
        let poses = carve(&mut again, &cutter, &frozen).volume_mm3();
        // Poses 0.03 mm apart leave cusps below 1e-4 mm, more on sharp rims; the pieces stray by a fiftieth of the cell at
        // most, to both sides.
        assert!((whole - poses).abs() < 1e-3 * whole, "{whole} {poses}");
    }
}

#[test]
fn what_must_not_meet_material() {
    let cutter = Cutter::cylinder(6.0, 8.0).unwrap();
    let (shank, holder) = (Cutter::cylinder(6.0, 4.0).unwrap(), Cutter::cylinder(20.0, 30.0).unwrap());
    let uppers = [
        Upper { body: &shank, above_mm: 8.0, kind: Body::Shank },
        Upper { body: &holder, above_mm: 12.0, kind: Body::Holder },
    ];
    let run = |depth: f64, rapid: bool| {
        let mut stock = block([40.0, 30.0, 20.0], 0.25);
        let z = 20.0 - depth;
        let motions = [
            Swept { from: upright(-20.0, 15.0, z), to: upright(20.0, 15.0, z), rapid, block: 5 },
            Swept { from: upright(20.0, 15.0, z), to: upright(20.0, 15.0, 50.0), rapid: true, block: 6 },
        ];
        let job = StockJob { cutter: &cutter, uppers: &uppers, motions: &motions, touch_mm: 1e-3 };
        stock.carve(&job, &|_| ()).unwrap()
    };
    // Within the cutting length nothing is wrong, and the way out in rapid is free.
    assert!(run(7.5, false).collisions.is_empty());
    // Deeper, the shank rubs in the slot that the cutter made only above it; deeper still the holder hits the top.
    let deep = run(10.0, false);
    assert!(
        deep.collisions.iter().all(|c| c.body == Body::Shank && c.block == 5) && deep.collisions.len() == 1
    );
    let deeper = run(13.0, false);
    let holder = deeper.collisions.iter().find(|c| c.body == Body::Holder).unwrap();
    assert!((holder.at.z - 19.5).abs() < 0.26 && holder.block == 5 && !holder.rapid, "{holder:?}");
    // Its bite is a millimetre deep, 20 wide and up to the middle, less the slot in front of it.
    assert!(holder.volume_mm3 > 300.0);
    // A rapid through material.
    let fast = run(3.0, true);
    assert!(fast.work.is_empty() && fast.collisions[0].rapid && fast.collisions[0].body == Body::Cutter);
    close("rapid", fast.collisions[0].volume_mm3, 3.0 * (6.0 * 20.0 + 0.5 * PI * 9.0));
}

fn cube(at: [f64; 3], side: f64) -> Vec<[Point3; 3]> {
    let p = |k: usize| {
        let bit = |b: usize| if k >> b & 1 == 1 { side } else { 0.0 };
        Point3::new(at[0] + bit(0), at[1] + bit(1), at[2] + bit(2))
    };
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    quads.iter().flat_map(|q| [[p(q[0]), p(q[1]), p(q[2])], [p(q[0]), p(q[2]), p(q[3])]]).collect()
}

#[test]
fn meshes_as_raw_material() {
    let resolution = Resolution { cell_mm: 0.06, tri: true, budget_bytes: PLENTY };
    let of = |blank: &Blank<'_>| Stock::fill(blank, &resolution);
    // Two cubes that overlap in a corner of 2 x 2 x 2.
    let mut two = cube([0.0; 3], 5.0);
    two.extend(cube([3.0; 3], 5.0));
    close("two cubes", of(&Blank::Mesh(&two)).unwrap().stock.volume().mm3, 250.0 - 8.0);
    // A layer around a square, open: two plates, half cylinders at the sides, a ball in all at the corners.
    let square = &cube([0.0; 3], 6.0)[..2];
    let r = 1.5;
    let want = 36.0 * 2.0 * r + 12.0 * PI * r * r + 4.0 / 3.0 * PI * r * r * r;
    let layer = Blank::Layer { triangles: square, thickness_mm: r, filled: false };
    close("layer", of(&layer).unwrap().stock.volume().mm3, want);
    // And around a cube that is filled: Steiner's formula.
    let one = cube([0.0; 3], 6.0);
    let want = 216.0 + 216.0 * r + 18.0 * PI * r * r + 4.0 / 3.0 * PI * r * r * r;
    let filled = Blank::Layer { triangles: &one, thickness_mm: r, filled: true };
    close("filled", of(&filled).unwrap().stock.volume().mm3, want);
    // A mesh with a hole.
    assert!(matches!(of(&Blank::Mesh(&one[1..])), Err(BlankError::Open { .. })));
    assert!(matches!(of(&Blank::Mesh(&[])), Err(BlankError::Empty(_))));
    let bad = Resolution { cell_mm: f64::NAN, ..resolution };
    assert!(matches!(Stock::fill(&Blank::Mesh(&one), &bad), Err(BlankError::Size { .. })));
    let none = Blank::Layer { triangles: &one, thickness_mm: 0.0, filled: true };
    assert!(matches!(of(&none), Err(BlankError::Size { .. })));
}

#[test]
fn memory_stays_within_its_budget() {
    let whole = Blank::Box(Box3 { min: Point3::origin(), max: Point3::new(100.0, 80.0, 50.0) });
    let budget_bytes = 2 << 20;
    let resolution = Resolution { cell_mm: 1e-3, tri: true, budget_bytes };
    let made = Stock::fill(&whole, &resolution).unwrap();
    assert!(made.coarsened == Some(1e-3) && made.stock.cell_mm() > 0.5 && made.stock.bytes() < budget_bytes);
    // Along z alone there is room for finer ones.
    let single = Stock::fill(&whole, &Resolution { tri: false, ..resolution }).unwrap();
    assert!(single.stock.cell_mm() < made.stock.cell_mm());
}

#[test]
fn threads_do_not_matter_to_the_stock() {
    let poses: Vec<Pose> = (0..60)
        .map(|k| {
            let t = 0.2 * f64::from(k);
            pose(
                [10.0 + 8.0 * t.sin(), 8.0 + 6.0 * (1.3 * t).cos(), 6.0 + t.cos()],
                [0.3 * t.sin(), 0.2, 1.0],
            )
        })
        .collect();
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut stock = block([20.0, 16.0, 10.0], 0.3);
            let carved = carve(&mut stock, &toroidal(6.0, 1.0), &through(&poses));
            (stock, carved)
        })
    };
    let (one, four) = (on(1), on(4));
    assert!(one == four && one.1.work.len() > 20);
}
