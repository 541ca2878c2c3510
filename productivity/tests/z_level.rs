//! Roughing in layers: no move takes of the part plus its allowance, what is left lies close above it, and raw material is never
//! met in rapid nor deeper than a step down.

use osculate_geom::analytic::{Paraboloid, Plane};
use osculate_geom::{Box3, Domain, Interval, Point3, Surface, Vec3};
use osculate_productivity::plan::{
    Entry, Headings, Links, Named, PlanError, RoughTask, Roughing, Rows, Sizes, rough as roughed,
};
use osculate_tools::removal::stock::{Blank, Resolution, Stock, StockJob};
use osculate_tools::removal::{Job, Swept, cut, sample_surface};
use osculate_tools::{Cutter, CutterSpec};

const SIZES: Sizes = Sizes {
    stepdown_mm: 2.0,
    stepover_mm: 1.5,
    allowance_mm: 0.4,
    ramp_rad: 0.1,
    chord_mm: 0.01,
    stands_mm: 0.5,
};

fn toroid() -> Cutter {
    Cutter::try_from(CutterSpec::Toroidal { diameter_mm: 6.0, corner_radius_mm: 1.0, length_mm: 40.0 })
        .unwrap()
}

fn rough(face: &dyn Surface, cutter: &Cutter, blank: Box3, sizes: Sizes) -> Result<Roughing, PlanError> {
    let mut links = Links::new(blank, *cutter, 1000.0);
    (links.clearance_mm, links.approach_mm, links.hop_mm) = (5.0, 1.0, 1.0);
    links.plunge_mm_min = 400.0;
    let faces = [Named { face: "F1", surface: face }];
    let resolution = Resolution { cell_mm: 0.25, tri: true, budget_bytes: 1 << 28 };
    let stock = Stock::fill(&Blank::Box(blank), &resolution).unwrap().stock;
    roughed(&RoughTask {
        faces: &faces,
        check: &[],
        cutter,
        from: Headings::Along(Vec3::z_axis()),
        rows: Rows::Along(Vec3::x()),
        stock: &stock,
        repeat: None,
        sizes,
        entry: Entry::Auto,
        plunges: false,
        volume_rate_mm3_min: f64::INFINITY,
        links: &links,
        progress: &|_| {},
    })
}

fn boxed(low: [f64; 3], high: [f64; 3]) -> Box3 {
    Box3 { min: Point3::from(low), max: Point3::from(high) }
}

/// Least and greatest height left along the normals of the face.
fn left(face: &dyn Surface, cutter: &Cutter, motions: &[Swept]) -> [f64; 2] {
    let samples = sample_surface(face, 0, 0.3, 100_000).unwrap().samples;
    let job =
        Job { cutter, holder: None, changes: &[], motions, samples: &samples, stock_mm: 8.0, depth_mm: 2.0 };
    let cuts = cut(&job, &|_| ()).unwrap();
    cuts.iter()
        .fold([f64::INFINITY, 0.0], |[lo, hi]: [f64; 2], c| [lo.min(c.standoff_mm), hi.max(c.standoff_mm)])
}

/// Carves a blank: nothing in rapid, no chip higher than a step down and a cusp.
fn carves(rough: &Roughing, cutter: &Cutter, blank: Box3) {
    let motions = Swept::along(&rough.linked.path);
    let resolution = Resolution { cell_mm: 0.25, tri: false, budget_bytes: 1 << 28 };
    let mut stock = Stock::fill(&Blank::Box(blank), &resolution).unwrap().stock;
    let job = StockJob { cutter, uppers: &[], motions: &motions, touch_mm: 0.02 };
    let carved = stock.carve(&job, &|_| ()).unwrap();
    assert!(carved.collisions.is_empty(), "{:?}", carved.collisions);
    assert!(carved.volume_mm3() > 0.0);
}

#[test]
fn a_hill_and_a_dish_keep_an_even_allowance() {
    let cutter = toroid();
    let hill = Paraboloid::new([-0.02, -0.03], 10.0).unwrap();
    let dish = Paraboloid::new([0.02, 0.02], 10.0).unwrap();
    let cases = [
        (&hill as &dyn Surface, boxed([-12.0, -12.0, -8.0], [12.0, 12.0, 1.0])),
        (&dish, boxed([-12.0, -12.0, -3.0], [12.0, 12.0, 5.0])),
    ];
    for (face, blank) in cases {
        let plan = rough(face, &cutter, blank, SIZES).unwrap();
        let motions = Swept::along(&plan.linked.path);
        let [least, most] = left(face, &cutter, &motions);
        let a = SIZES.allowance_mm;
        assert!(least >= a - SIZES.chord_mm, "{least}");
        // Between rows a corner of radius r leaves a cusp; a flat bottom bridges the dish by its own sagitta.
        let cusp = SIZES.stepover_mm.powi(2) / (8.0 * cutter.corner_mm());
        let bridge = 0.02 * cutter.radius_mm().powi(2);
        assert!(most <= a + cusp + bridge, "{most}");
        carves(&plan, &cutter, blank);
        // Every layer lies at most a step down below the last.
        let mut above = blank.max.z;
        for z in &plan.headings[0].layers {
            assert!(above - z <= SIZES.stepdown_mm + 1e-9 && *z < above);
            above = *z;
        }
    }
}

/// On a plane everything is left exactly at the allowance, by the volume that lies above it.
#[test]
fn a_plane_is_left_at_its_allowance() {
    let side = Interval::new(0.0, 20.0);
    let plane = Plane::new(Domain { u: side, v: side });
    let cutter = toroid();
    let blank = boxed([0.0, 0.0, -2.0], [20.0, 20.0, 3.0]);
    let plan = rough(&plane, &cutter, blank, SIZES).unwrap();
    let [least, most] = left(&plane, &cutter, &Swept::along(&plan.linked.path));
    // At the edge the corner comes down beside the face, within the chord tolerance.
    assert!(least >= SIZES.allowance_mm - SIZES.chord_mm, "{least}");
    assert!((most - SIZES.allowance_mm).abs() < 1e-9, "{most}");
    carves(&plan, &cutter, blank);
}

#[test]
fn sizes_and_tops_that_cannot_be_are_refused() {
    let hill = Paraboloid::new([-0.02, -0.03], 10.0).unwrap();
    let blank = boxed([-12.0, -12.0, -8.0], [12.0, 12.0, 1.0]);
    let none = Sizes { stepdown_mm: 0.0, ..SIZES };
    assert!(matches!(
        rough(&hill, &toroid(), blank, none),
        Err(PlanError::Tolerance { what: "stepdown_mm", .. })
    ));
    let below = boxed([-12.0, -12.0, -20.0], [12.0, 12.0, -10.0]);
    assert!(matches!(rough(&hill, &toroid(), below, SIZES), Err(PlanError::Nothing { .. })));
    let cone = CutterSpec::Cone {
        diameter_mm: 6.0,
        taper_deg: 5.0,
        corner_radius_mm: 1.0,
        tip_diameter_mm: None,
        length_mm: 40.0,
    };
    let cone = Cutter::try_from(cone).unwrap();
    assert!(matches!(rough(&hill, &cone, blank, SIZES), Err(PlanError::Tool { strategy: "z_level", .. })));
}
