//! Planted gouges of 0.002 to 0.5 mm: their size and their block.
//!
//! The part is the plane z = 0; a toroidal end leaned along the feed runs over it in steps of 1 mm, each with a closed form
//! for what the fault takes. Pivots are wrong in a machine's kinematics: a program is posted for one and read back on
//! another whose trunnion axis lies lower, or whose head is shorter.

use super::{ball, pose, run, through, toroidal};
use nalgebra::Vector3;
use osculate_geom::analytic::Plane;
use osculate_geom::{Domain, Interval, Point3, Vec3};
use osculate_postproc::readback::{ReadOptions, read};
use osculate_postproc::{Dialect, FeedMode, Machine, PostOptions, Setup, post};
use osculate_tools::cl::{ClMove, ClPath, Motion};
use osculate_tools::removal::{Kind, Limits, Swept, sample_surface, tally};
use osculate_tools::{Cutter, CutterSpec, Pose};

/// Share of its depth by which a gouge may look shallower for the samples' spacing.
const LOOKS: f64 = 0.02;
const ALLOWED: f64 = 0.05;

/// The deepest gouge of a path around a place of the plane at a height, with its block.
fn deepest(cutter: &Cutter, motions: &[Swept], depth: f64, at: Point3) -> (f64, Option<u32>) {
    let sharpest = if cutter.is_ball() { cutter.radius_mm() } else { cutter.corner_mm() };
    let spacing = (2.0 * LOOKS * depth * sharpest).sqrt().min(0.1);
    let i = |c: f64| Interval::new(c - 15.0 * spacing, c + 15.0 * spacing);
    let surface = Plane::new(Domain { u: i(at.x), v: i(at.y) });
    let mut sampling = sample_surface(&surface, 1, spacing, 1_000_000).expect("a good face");
    for s in &mut sampling.samples {
        s.point.z = at.z;
    }
    let cuts = run(cutter, motions, &sampling.samples);
    let limits = Limits::new(0.02, 1e-3);
    let v = tally(&sampling.samples, &cuts, &limits, &sampling.density, sharpest).expect("good limits");
    (v.gouge_max_mm, v.worst.iter().find(|w| w.kind == Kind::Gouge).and_then(|w| w.block))
}

/// A leaned toroidal end on the plane.
struct Leaned {
    cutter: Cutter,
    lean: f64,
}

impl Leaned {
    /// The height of the tip above the plane at a lean.
    fn height(&self, lean: f64) -> f64 {
        let (core, r) = (self.cutter.core_mm(), self.cutter.corner_mm());
        r + core * lean.sin() - r * lean.cos()
    }
    fn at(&self, x: f64, extra: f64) -> Pose {
        let axis = Vec3::new(self.lean.sin(), 0.0, self.lean.cos());
        pose(Point3::new(x, 0.0, self.height(self.lean) + extra), axis)
    }
    /// The lowest point of the tool at a pose.
    fn lowest(&self, p: &Pose) -> Point3 {
        let a = p.axis.into_inner();
        let out = (a * a.z - Vec3::z()).normalize();
        let r = self.cutter.corner_mm();
        p.tip + a * r + out * self.cutter.core_mm() - Vec3::z() * r
    }
}

fn x(k: usize) -> f64 {
    k as f64 - 10.0
}

/// The text of a program for the passes, posted for a machine, and the lines of its blocks read back on another.
fn posted(
    poses: &[Pose],
    spec: CutterSpec,
    [own, other]: [&Machine; 2],
    [good, bad]: [Setup; 2],
) -> Vec<Swept> {
    let moves = poses
        .iter()
        .enumerate()
        .map(|(k, pose)| ClMove {
            pose: *pose,
            motion: if k == 0 { Motion::Rapid } else { Motion::Feed(500.0) },
            aloft: false,
        })
        .collect();
    let path = ClPath { cutter: Some(spec), holder: Vec::new(), spindle_rpm: Some(6000.0), moves };
    let options = PostOptions::new(Dialect::Sinumerik, FeedMode::Kv { fgref_mm: None });
    let text = post(&path, own, &good, &options).expect("within reach").text;
    let back =
        read(&text, Dialect::Sinumerik, other, &bad, &ReadOptions::default()).expect("its own dialect");
    back.moves
        .windows(2)
        .map(|w| Swept {
            from: w[0].pose,
            to: w[1].pose,
            rapid: matches!(w[1].motion, Motion::Rapid),
            block: w[1].line as u32,
        })
        .collect()
}

/// The trunnion machine, its A axis this much lower than where it is taken to be.
fn trunnion(lower_mm: f64) -> Machine {
    let text = include_str!("../../machines/trunnion-ac.toml");
    let axis = "letter = \"A\"\nside = \"table\"\n";
    assert!(text.contains(axis));
    let with = format!("{axis}point_mm = [0, 0, {}]\n", -lower_mm);
    Machine::from_toml(&text.replacen(axis, &with, 1)).expect("a good machine")
}

/// All faults at all depths; whether each is found.
pub fn planted() -> bool {
    println!("planted gouges on a plane, allowed {:.0} % of the size", 100.0 * ALLOWED);
    println!("{:<28} {:>9} {:>13} {:>8}  block (of)", "fault", "size mm", "found mm", "off %");
    let mut good = true;
    let mut row = |what: &str, depth: f64, found: (f64, Option<u32>), blocks: Option<[u32; 2]>| {
        let off = found.0 / depth - 1.0;
        let named = found.1.unwrap_or(0);
        let right = blocks.is_none_or(|b| b.contains(&named));
        good &= off.abs() <= ALLOWED && right;
        let of = blocks.map_or("any".to_owned(), |b| format!("{} or {}", b[0], b[1]));
        println!(
            "{what:<28} {depth:>9} {:>13.9} {:>8.2}  {named} ({of}){}",
            found.0,
            100.0 * off,
            if right { "" } else { " WRONG" }
        );
    };
    for depth in [0.002, 0.01, 0.05, 0.2, 0.5f64] {
        let spec = CutterSpec::Toroidal { diameter_mm: 10.0, corner_radius_mm: 2.0, length_mm: 60.0 };
        let t = Leaned { cutter: toroidal(10.0, 2.0), lean: 0.3 };
        let (core, b) = (t.cutter.core_mm(), t.lean);
        let path = |fault: Option<Pose>| -> Vec<Pose> {
            (0..=20).map(|k| fault.filter(|_| k == 12).unwrap_or_else(|| t.at(x(k), 0.0))).collect()
        };
        let lowered = t.at(x(12), -depth);
        let found = deepest(&t.cutter, &through(&path(Some(lowered))), depth, project(t.lowest(&lowered)));
        row("tip lowered", depth, found, Some([12, 13]));
        // Turned about its tip; Newton on the height, whose slope is core cos + r sin.
        let mut turned = b;
        for _ in 0..60 {
            turned -= (t.height(turned) - t.height(b) - depth) / (core * turned.cos() + 2.0 * turned.sin());
        }
        let leaned = pose(t.at(x(12), 0.0).tip, Vec3::new(turned.sin(), 0.0, turned.cos()));
        let found = deepest(&t.cutter, &through(&path(Some(leaned))), depth, project(t.lowest(&leaned)));
        row("axis turned", depth, found, Some([12, 13]));
        // Straight through where the path climbs over a crest of twice the size.
        let up =
            |k: usize| pose(Point3::new(x(k), 0.0, if k % 2 == 1 { 2.0 * depth } else { 0.0 }), Vec3::z());
        let mut order: Vec<usize> = (0..=20).collect();
        order.swap(11, 12);
        let motions = through(&order.iter().map(|k| up(*k)).collect::<Vec<_>>());
        let found = deepest(&ball(6.0), &motions, depth, Point3::new(x(11), 0.0, depth));
        row("blocks swapped", depth, found, Some([11, 11]));
        // A larger tool goes down by the growth of its core times sin b.
        let large = toroidal(2.0 * (core + 2.0 + depth / b.sin()), 2.0);
        let under = project(t.lowest(&t.at(0.0, 0.0)) - Vec3::x() * (depth / b.sin() * b.cos()));
        row("tool radius", depth, deepest(&large, &through(&path(None)), depth, under), None);
        // Seen from the part the axis of a trunnion that lies d lower moves the tool by d (1 - cos b) along the part's
        // normal, and d sin b across.
        let d = depth / (1.0 - b.cos());
        let setup = Setup::at(Vector3::new(0.0, 0.0, 30.0), 150.0);
        let near = project(t.lowest(&t.at(0.0, 0.0)) + Vec3::x() * (d * b.sin()));
        let motions = posted(&path(None), spec, [&trunnion(0.0), &trunnion(d)], [setup; 2]);
        row("pivot, trunnion A lower", depth, deepest(&t.cutter, &motions, depth, near), None);
        // A tool shorter by d than what the head is told: the control makes up for it upright, and leaned by b the tip goes
        // d (1 - cos b) deeper.
        let head = Machine::built_in("head-ca").expect("built in");
        let shorter = Setup { gauge_length_mm: setup.gauge_length_mm - d, ..setup };
        let motions = posted(&path(None), spec, [&head; 2], [setup, shorter]);
        row("pivot, head too short", depth, deepest(&t.cutter, &motions, depth, near), None);
    }
    println!("{}", if good { "all found" } else { "NOT all found as they are" });
    good
}

/// On the plane.
fn project(p: Point3) -> Point3 {
    Point3::new(p.x, p.y, 0.0)
}
