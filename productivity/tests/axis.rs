//! Fields of the tool's axis: what passes along them leave, that they keep the tool out of what stands around, and which places they
//! say no axis reaches.

use crate::cutting;

use cutting::{motions, verdict};
use osculate_geom::analytic::{Line, Paraboloid};
use osculate_geom::{
    Axis, Domain, Extruded, Interval, Jet2, Point3, Series, Side, Surface, Taylor, Unit3, Uv, Vec3,
};
use osculate_productivity::axis::{Around, AxisField, Found, Joints, Left, Surroundings, Wish, find};
use osculate_productivity::plan::{
    Along, Leaning, Milling, Named, Senses, Task, Tolerance, isoparametric, run_in,
};
use osculate_tools::reach::Tool;
use osculate_tools::removal::{Job, Swept, cut, sample_surface};
use osculate_tools::{Cutter, CutterSpec, Holder, Pose, pose_with_axis};
use proptest::prelude::*;

const TOLERANCE: Tolerance = Tolerance { scallop_mm: 0.02, gouge_mm: 0.01, chord_mm: 0.002 };

fn ball(diameter_mm: f64, length_mm: f64) -> Cutter {
    Cutter::try_from(CutterSpec::Ball { diameter_mm, length_mm }).unwrap()
}

fn tilted(deg: f64, about_deg: f64) -> Unit3 {
    let ((s, c), (t, d)) = (deg.to_radians().sin_cos(), about_deg.to_radians().sin_cos());
    Unit3::new_normalize(Vec3::new(s * d, s * t, c))
}

/// A machine that turns the axis anywhere at a radian a second, or not at all.
struct Machine {
    fixed: Option<Unit3>,
}

impl Joints for Machine {
    fn reaches(&self, axis: &Unit3) -> bool {
        self.fixed.is_none_or(|only| only.angle(axis) < 1e-9)
    }
    fn turn_s(&self, from: &Unit3, to: &Unit3) -> f64 {
        from.angle(to)
    }
    fn nearest(&self, axis: &Unit3) -> Unit3 {
        self.fixed.unwrap_or(*axis)
    }
    fn line(&self) -> Option<Vec<Unit3>> {
        self.fixed.map(|only| vec![only])
    }
    fn travels(&self, _: &Pose) -> bool {
        true
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 6, ..ProptestConfig::default() })]

    /// A pass leaves the same whichever way it is run, and all of them what was asked for.
    #[test]
    fn the_sense_of_passes_changes_nothing(
        tilt in 0.0..50.0f64, about in 0.0..360.0f64, end in 0u32..2, climb in any::<bool>(),
    ) {
        let dome = Paraboloid::new([-0.02, -0.01], 10.0).unwrap();
        let cutter = if end == 0 { ball(8.0, 40.0) } else {
            Cutter::try_from(CutterSpec::Toroidal { diameter_mm: 8.0, corner_radius_mm: 2.0, length_mm: 40.0 }).unwrap()
        };
        // A toroidal end must lean off every normal of the dome, which lean off z by 23 degrees.
        let tilt = if end == 0 { tilt } else { 30.0 + 0.3 * tilt };
        let field = AxisField::held(&dome, tilted(tilt, about));
        let task = Task::new("F1", &dome, &cutter, Leaning::Axes(&field), TOLERANCE);
        let mut passes = isoparametric(&task, Along::Fixed(Axis::U)).unwrap().passes;
        let spacing = 0.5;
        let moves = motions(&dome, &passes, &cutter);
        let found = verdict(&dome, &moves, &cutter, TOLERANCE, spacing);
        prop_assert!(found.within, "scallop {} gouge {}", found.scallop_max_mm, found.gouge_max_mm);
        let samples = sample_surface(&dome, 0, spacing, 100_000).unwrap().samples;
        let heights = |passes: &[osculate_productivity::plan::Pass]| -> Vec<f64> {
            let points = passes.iter().flat_map(|p| p.points.windows(2));
            let motions: Vec<Swept> =
                points.map(|w| Swept { from: w[0].pose, to: w[1].pose, rapid: false, block: 0 }).collect();
            let job = Job { cutter: &cutter, holder: None, changes: &[], motions: &motions, samples: &samples, stock_mm: 1.0, depth_mm: 2.0 };
            cut(&job, &|_| {}).unwrap().iter().map(|c| c.standoff_mm).collect()
        };
        let before = heights(&passes);
        let milling = if climb { Milling::Climb } else { Milling::Conventional };
        run_in(&mut passes, Senses { one_way: false, milling });
        for (a, b) in before.iter().zip(heights(&passes)) {
            prop_assert!((a - b).abs() < 1e-9, "{a} {b}");
        }
    }
}

/// A plane with a groove that is narrower than columns of passes are apart, `z = -0.045 / (1 + (x / 0.08)^2)^2`.
struct Groove;

impl Surface for Groove {
    fn domain(&self) -> Domain {
        Domain { u: Interval::new(-20.0, 21.3), v: Interval::new(0.0, 1.2) }
    }
    fn jet2(&self, at: Uv) -> Jet2 {
        self.taylor(at, 2).jet2()
    }
    fn taylor(&self, at: Uv, order: usize) -> Taylor {
        let (x, y) = (Series::variable(Axis::U, at.u, order), Series::variable(Axis::V, at.v, order));
        let wide = x * x * (1.0 / 0.0064) + Series::constant(1.0, order);
        let z = (wide * wide).recip() * -0.045;
        Taylor { uv: at, side: Side::Along, coordinates: [x, y, z] }
    }
    fn breaks(&self, axis: Axis) -> Vec<f64> {
        let i = self.domain().get(axis);
        (0..=200).map(|k| i.at(f64::from(k) / 200.0)).collect()
    }
}

/// A ball does not enter the groove. What it leaves there and the ridges between passes are within the scallop together: passes across
/// the groove lie closer than on the plane for it, and go into its edges by a part of the gouge.
#[test]
fn a_narrow_groove_is_found_between_columns() {
    let tolerance = Tolerance { scallop_mm: 0.05, ..TOLERANCE };
    let cutter = ball(8.0, 40.0);
    let field = AxisField::held(&Groove, tilted(10.0, 30.0));
    let task = Task::new("F1", &Groove, &cutter, Leaning::Axes(&field), tolerance);
    let passes = isoparametric(&task, Along::Fixed(Axis::U)).unwrap().passes;
    let moves = motions(&Groove, &passes, &cutter);
    let found = verdict(&Groove, &moves, &cutter, tolerance, 0.04);
    assert!(found.within, "scallop {} gouge {}", found.scallop_max_mm, found.gouge_max_mm);
    // The tool at rest would leave nearly the depth of the groove, and the ridges of a plane as much again.
    assert!(
        found.scallop_max_mm > 0.035 && found.gouge_max_mm > 0.002,
        "{} {}",
        found.scallop_max_mm,
        found.gouge_max_mm
    );
}

/// A floor in the plane z = 0 over `x` from 0.5 to 30 mm and a wall in the plane x = 0 that is as long and 25 mm high.
fn corner() -> [Extruded<Line>; 2] {
    let line = |at: Point3, way: Vec3, to: f64| Line::new(at, way, Interval::new(0.0, to)).unwrap();
    let floor =
        Extruded::new(line(Point3::new(0.5, 0.0, 0.0), Vec3::x(), 29.5), Vec3::y(), Interval::new(0.0, 30.0));
    let wall = Extruded::new(line(Point3::origin(), Vec3::y(), 30.0), Vec3::z(), Interval::new(0.0, 25.0));
    [floor.unwrap(), wall.unwrap()]
}

fn along_v(_: Uv, jet: &Jet2) -> Option<Vec3> {
    Some(jet.dv)
}

fn found(tool: &Tool, machine: &Machine, left: Left<'_>) -> Found {
    let [floor, wall] = corner();
    let around = Around {
        faces: &[Named { face: "floor", surface: &floor }],
        check: &[Named { face: "wall", surface: &wall }],
        cutter: tool.cutter(),
        gouge_mm: 0.005,
        left,
    };
    let wish = Wish {
        surface: &floor,
        scallop_mm: 0.02,
        feed_mm_min: 1000.0,
        joints: machine,
        tool,
        around: &Surroundings::of(&around).unwrap(),
        lean_rad: [0.0, 1.5],
    };
    find(&wish, &along_v).unwrap()
}

#[test]
fn a_field_keeps_cutter_and_holder_off_a_wall_and_names_what_no_axis_reaches() {
    const RADIUS: f64 = 3.0;
    let (cutter, holder) = (ball(2.0 * RADIUS, 15.0), Holder::cylinder(16.0, 40.0).unwrap());
    let found = found(&Tool::new(cutter, Some(&holder)), &Machine { fixed: None }, Left::default());
    let [floor, _] = corner();
    // The centre of the ball stands over its contact: no axis helps within a radius of the wall. Nodes are half a radius apart.
    let unreached: f64 = found.unreached.iter().map(|u| u.area_mm2).sum();
    let cells = 0.5 * RADIUS * 30.0;
    assert!((unreached - (RADIUS - 0.5) * 30.0).abs() <= cells, "{unreached}");
    for u in &found.unreached {
        assert!(u.point.x < RADIUS + 1.0, "{}", u.point);
        assert_eq!(u.best.unwrap().gap.met.unwrap().obstacle.owner, 1);
    }
    // Everywhere else the axes of the field keep both out of the wall's half space: all of a body's points are at x > 0.
    let domain = floor.domain();
    for k in 0..400 {
        let part = |k: usize| (k as f64 + 0.5) / 20.0;
        let at = domain.at(part(k % 20), part(k / 20));
        let point = floor.point(at);
        if point.x < RADIUS + 1.0 {
            continue;
        }
        let (axis, _) = found.field.at(at);
        let pose = pose_with_axis(&cutter, &point, &Vec3::z_axis(), &axis);
        let sine = (1.0 - axis.x * axis.x).sqrt();
        let holder_at = pose.retracted(cutter.length_mm());
        // The leftmost point of a disc of radius R at right angles to the axis.
        let least = |disc: &Point3, radius: f64| disc.x - radius * sine;
        assert!(least(&holder_at.tip, 8.0) > 0.0, "{point} {}", axis.into_inner());
        assert!(least(&holder_at.tip, RADIUS) > 0.0 && point.x > RADIUS);
        let top = holder_at.retracted(25.0 / axis.z.max(0.1)).tip;
        assert!(axis.x >= 0.0 || least(&top, 8.0) > 0.0 || top.z > 25.0);
    }
}

/// Raw material stands beyond a plane that an upright holder reaches over from the far end of the floor. The cutter may take it: a layer of
/// it on the floor changes nothing.
#[test]
fn a_field_keeps_the_holder_off_raw_material_that_is_left() {
    const BEYOND: f64 = 31.0;
    const HOLDER: f64 = 8.0;
    let cutter = ball(6.0, 15.0);
    let tool = Tool::new(cutter, Some(&Holder::cylinder(2.0 * HOLDER, 40.0).unwrap()));
    let lattice = |n: usize, m: usize| (0..n).flat_map(move |i| (0..m).map(move |j| (i as f64, j as f64)));
    let wall = lattice(91, 61).map(|(y, z)| Point3::new(BEYOND, y - 30.0, z));
    let layer = lattice(31, 31).map(|(x, y)| Point3::new(x, y, 0.8));
    let raw: Vec<Point3> = wall.chain(layer).collect();
    let [floor, _] = corner();
    // How far the holder of the worst place is from the plane, as its lowest disc and the one in which it ends.
    let room = |found: &Found| {
        let places = (0..400).map(|k| [k % 20, k / 20].map(|k| (k as f64 + 0.5) / 20.0));
        let rooms = places.map(|[s, t]| {
            let at = floor.domain().at(s, t);
            let (axis, _) = found.field.at(at);
            let pose = pose_with_axis(&cutter, &floor.point(at), &Vec3::z_axis(), &axis);
            let reach = HOLDER * (1.0 - axis.x * axis.x).sqrt();
            let ends = [15.0, 55.0].map(|up| BEYOND - pose.retracted(up).tip.x - reach);
            ends[0].min(ends[1])
        });
        rooms.fold(f64::INFINITY, f64::min)
    };
    let machine = Machine { fixed: None };
    let free = found(&tool, &machine, Left::default());
    assert!(room(&free) < -1.0, "{}", room(&free));
    let kept = found(&tool, &machine, Left { points: &raw, apart_mm: 1.0 });
    assert!(room(&kept) > 0.0, "{}", room(&kept));
    assert_eq!(kept.unreached.len(), free.unreached.len());
}

#[test]
fn a_machine_of_three_axes_has_a_field_of_one() {
    let up = Vec3::z_axis();
    let found = found(&Tool::new(ball(6.0, 30.0), None), &Machine { fixed: Some(up) }, Left::default());
    for (u, v) in [(0.0, 0.0), (5.0, 7.0), (29.5, 30.0)] {
        let (axis, slope) = found.field.at(Uv { u, v });
        assert!(axis.angle(&up) < 1e-12 && slope.iter().all(|s| s.norm() < 1e-12));
    }
}

/// Between points of a plane that are s apart an end with a corner r comes s^2 / 8 r deeper: on a plane so large that this is far more
/// than what is accepted the points are hardly sunk, on a small one by all of it.
#[test]
fn points_that_stand_far_apart_are_sunk_less() {
    const GOUGE: f64 = 1e-3;
    let spec = CutterSpec::Toroidal { diameter_mm: 10.0, corner_radius_mm: 1.0, length_mm: 40.0 };
    let cutter = Cutter::try_from(spec).unwrap();
    let sunk = |side: f64| {
        let line = Line::new(Point3::origin(), Vec3::x(), Interval::new(0.0, side)).unwrap();
        let plane = Extruded::new(line, Vec3::y(), Interval::new(0.0, side)).unwrap();
        let faces = [Named { face: "plane", surface: &plane }];
        let around =
            Around { faces: &faces, check: &[], cutter: &cutter, gouge_mm: GOUGE, left: Left::default() };
        let all = Surroundings::of(&around).unwrap();
        let depths = all.obstacles.points().iter().map(|p| -p.point.z);
        depths.fold([f64::INFINITY, 0.0], |[least, most], d| [least.min(d), f64::max(most, d)])
    };
    for (side, part) in [(5.0, 1.0), (400.0, 0.2)] {
        let [least, most] = sunk(side);
        assert!(
            (least - part * GOUGE).abs() < 1e-12 && (most - part * GOUGE).abs() < 1e-12,
            "{least} {most}"
        );
    }
}
