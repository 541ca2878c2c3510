//! A second opinion on plans of every strategy: the distance from dense points of the face to cutter and holder, at poses close
//! together along the whole path, links included. Nothing of the removal model or of the cutter's own distance is used.
//!
//! A point at height z above the tip and at distance rho from the axis lies in the cutter as deep as its distance to the nearest
//! of bottom, side and corner circle; this is never more than the depth along the face's normal. Between the poses of the path
//! the tip goes straight and the axis is the normalised chord, as controls and the removal model have it.

use crate::cutting;

use osculate_geom::analytic::{Paraboloid, Sphere, Torus};
use osculate_geom::{Axis, Box3, Domain, Flipped, Interval, Patch, Point3, Side, Surface, Unit3, Vec3};
use osculate_productivity::plan::{
    Along, DropTask, Entry, Headings, Links, Named, Pass, Passes, PlanError, RoughTask, Rows, Sizes,
    Strategy, Task, Tolerance, drop_cutter, gradient_3c, rough, run,
};
use osculate_tools::removal::Swept;
use osculate_tools::removal::stock::{Blank, Resolution, Stock};
use osculate_tools::{Cutter, CutterSpec, Lean};
use rayon::prelude::*;

const TOLERANCE: Tolerance = Tolerance { scallop_mm: 0.02, gouge_mm: 0.005, chord_mm: 0.003 };
/// Between points of the face, and between poses: a hundredth of the gouge tolerance is at stake on a radius of 3 mm.
const POINTS_MM: f64 = 0.15;
const POSES_MM: f64 = 0.15;
const POSES_RAD: f64 = 0.01;

/// Cutter with a corner, and a holder above it, mm.
#[derive(Clone, Copy)]
struct Tool {
    radius: f64,
    corner: f64,
    length: f64,
    holder_radius: f64,
    holder_length: f64,
}

impl Tool {
    /// How deep a point is in the cutter, and in the holder; negative outside, and then only a bound.
    fn depths(&self, rho: f64, z: f64) -> [f64; 2] {
        let core = self.radius - self.corner;
        let low = if z >= self.corner {
            (self.radius - rho).min(z)
        } else if rho <= core {
            z
        } else {
            self.corner - (rho - core).hypot(z - self.corner)
        };
        let holder =
            (self.holder_radius - rho).min(z - self.length).min(self.length + self.holder_length - z);
        [low.min(self.length - z), holder]
    }

    fn cutter(&self) -> Cutter {
        let (diameter_mm, length_mm) = (2.0 * self.radius, self.length);
        let spec = if self.corner == self.radius {
            CutterSpec::Ball { diameter_mm, length_mm }
        } else {
            CutterSpec::Toroidal { diameter_mm, corner_radius_mm: self.corner, length_mm }
        };
        Cutter::try_from(spec).unwrap()
    }

    /// The deepest that cutter and holder go into the points over all motions, each lowered by `sunk` along its axis.
    fn deepest(&self, motions: &[Swept], points: &[Point3], sunk: f64) -> [f64; 2] {
        let reach = (self.length + self.holder_length).hypot(self.holder_radius.max(self.radius));
        let motion = |m: &Swept| {
            let way = m.to.tip - m.from.tip;
            let swing = (m.to.axis.into_inner() - m.from.axis.into_inner()).norm();
            let steps = (way.norm() / POSES_MM).max(swing / POSES_RAD).ceil().max(1.0) as usize;
            let mut out = [f64::NEG_INFINITY; 2];
            for k in 0..=steps {
                let t = k as f64 / steps as f64;
                let axis = (m.from.axis.into_inner() * (1.0 - t) + m.to.axis.into_inner() * t).normalize();
                let tip = m.from.tip + way * t - axis * sunk;
                for p in points {
                    let d = p - tip;
                    let z = d.dot(&axis);
                    // Far below the tip or beside everything there is nothing to ask.
                    if z > -0.1 && z < reach {
                        let rho = (d.norm_squared() - z * z).max(0.0).sqrt();
                        let found = self.depths(rho, z);
                        out = [out[0].max(found[0]), out[1].max(found[1])];
                    }
                }
            }
            out
        };
        motions
            .par_iter()
            .map(motion)
            .reduce(|| [f64::NEG_INFINITY; 2], |a, b| [a[0].max(b[0]), a[1].max(b[1])])
    }
}

fn points(surface: &dyn Surface) -> Vec<Point3> {
    let d = surface.domain();
    let middle = surface.jet2(d.at(0.5, 0.5));
    let count = |interval: Interval, speed: f64| (interval.length() * speed / POINTS_MM).ceil() as usize;
    let [n, m] = [count(d.u, middle.du.norm()), count(d.v, middle.dv.norm())];
    (0..=n)
        .flat_map(|i| (0..=m).map(move |j| (i as f64 / n as f64, j as f64 / m as f64)))
        .map(|(f, g)| surface.point(d.at(f, g)))
        .collect()
}

/// Holds a plan against the points, and shows that the check would see it sink.
fn holds(name: &str, surface: &dyn Surface, tool: &Tool, passes: &[Pass]) {
    let motions = cutting::motions(surface, passes, &tool.cutter());
    let points = points(surface);
    let [cutter, holder] = tool.deepest(&motions, &points, 0.0);
    assert!(cutter <= TOLERANCE.gouge_mm, "{name}: {cutter} mm deep");
    // It does touch: a path that hovers would pass any check.
    assert!(cutter > -0.5 * TOLERANCE.scallop_mm, "{name}: {cutter}");
    assert!(holder < 0.0, "{name}: holder {holder} mm deep");
    let few: Vec<Swept> = motions.iter().step_by(motions.len().div_ceil(40)).copied().collect();
    let [sunk, _] = tool.deepest(&few, &points, 3.0 * TOLERANCE.gouge_mm);
    assert!(sunk > TOLERANCE.gouge_mm, "{name}: sunk on purpose, {sunk}");
}

fn plan(surface: &dyn Surface, tool: &Tool, lead_rad: f64, strategy: &Strategy) -> Vec<Pass> {
    let lean = Lean { lead_rad, tilt_rad: 0.0 };
    let cutter = &tool.cutter();
    let task = Task::new("F1", surface, cutter, lean, TOLERANCE);
    run(&task, strategy).unwrap().passes
}

const TOROIDAL: Tool =
    Tool { radius: 5.0, corner: 1.5, length: 30.0, holder_radius: 15.0, holder_length: 40.0 };
const BALL: Tool = Tool { radius: 3.0, corner: 3.0, length: 25.0, holder_radius: 12.0, holder_length: 40.0 };

fn patch<S: Surface>(surface: S, u: [f64; 2], v: [f64; 2]) -> Patch<S> {
    let domain = Domain { u: Interval::new(u[0], u[1]), v: Interval::new(v[0], v[1]) };
    Patch { surface, domain, side: Side::Along }
}

/// The inner side of a groove, hollow across, where five-axis strips are wide and heels dig in.
#[test]
fn toroidal_cutters_in_a_groove() {
    let groove = Flipped(patch(Torus::new(90.0, 40.0).unwrap(), [0.0, 0.22], [2.9, 3.3]));
    let planes = Strategy::Isoplanar { normal: Unit3::new_normalize(Vec3::new(0.0, 0.1, 1.0)) };
    let all = [
        Strategy::Isoparametric { along: Along::Auto },
        Strategy::Regions { along: Along::Fixed(Axis::V) },
        planes,
        Strategy::Isoscallop,
        Strategy::Streamline,
        Strategy::Curvature5c,
    ];
    for strategy in &all {
        holds(strategy.name(), &groove, &TOROIDAL, &plan(&groove, &TOROIDAL, 0.25, strategy));
    }
}

#[test]
fn balls_on_a_saddle_and_a_dome() {
    let saddle = Paraboloid::new([0.02, -0.015], 6.0).unwrap();
    for strategy in [Strategy::Isoparametric { along: Along::Auto }, Strategy::Streamline] {
        holds(strategy.name(), &saddle, &BALL, &plan(&saddle, &BALL, 0.3, &strategy));
    }
    let dome = patch(Sphere::new(25.0).unwrap(), [0.0, 0.5], [0.7, 1.2]);
    let contour = Strategy::Contour2cl { axis: Vec3::z_axis() };
    holds("contour", &dome, &BALL, &plan(&dome, &BALL, 0.0, &contour));
}

#[test]
fn dropped_cutters_on_a_saddle() {
    let saddle = Paraboloid::new([0.02, -0.015], 6.0).unwrap();
    let hill = Paraboloid::new([-0.02, -0.04], 6.0).unwrap();
    type Plan = fn(&DropTask<'_>) -> Result<Passes, PlanError>;
    let all: [(&str, &Paraboloid, Tool, Plan); 3] = [
        ("ball, planes", &saddle, BALL, drop_cutter),
        ("toroidal, planes", &saddle, TOROIDAL, drop_cutter),
        ("toroidal, gradient lines", &hill, TOROIDAL, gradient_3c),
    ];
    for (name, face, tool, plan) in all {
        let passes = plan(&DropTask {
            faces: &[Named { face: "F1", surface: face }],
            check: &[],
            cutter: &tool.cutter(),
            axis: Vec3::z_axis(),
            feed: Vec3::x(),
            tolerance: TOLERANCE,
            progress: &|_| {},
        });
        holds(name, face, &tool, &passes.unwrap().passes);
    }
}

/// Layers of roughing keep the cutter, grown by the allowance, off the part, links, ramps and all.
#[test]
fn roughing_keeps_its_allowance() {
    let saddle = Paraboloid::new([0.02, -0.03], 8.0).unwrap();
    let sizes = Sizes {
        stepdown_mm: 1.5,
        stepover_mm: 2.0,
        allowance_mm: 0.4,
        ramp_rad: 0.1,
        chord_mm: 0.01,
        stands_mm: 0.5,
    };
    let blank = Box3 { min: Point3::new(-9.0, -9.0, -4.0), max: Point3::new(9.0, 9.0, 3.0) };
    let mut links = Links::new(blank, TOROIDAL.cutter(), 1000.0);
    (links.clearance_mm, links.approach_mm, links.hop_mm) = (5.0, 1.0, 0.125);
    links.plunge_mm_min = 400.0;
    let resolution = Resolution { cell_mm: 0.25, tri: true, budget_bytes: 1 << 28 };
    let stock = Stock::fill(&Blank::Box(blank), &resolution).unwrap().stock;
    let rough = rough(&RoughTask {
        faces: &[Named { face: "F1", surface: &saddle }],
        check: &[],
        cutter: &TOROIDAL.cutter(),
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
    .unwrap();
    let motions = Swept::along(&rough.linked.path);
    let a = sizes.allowance_mm;
    let grown = Tool {
        radius: TOROIDAL.radius + a,
        corner: TOROIDAL.corner + a,
        length: TOROIDAL.length + 2.0 * a,
        ..TOROIDAL
    };
    let points = points(&saddle);
    // The grown cutter's tip is the allowance below that of the cutter.
    let [cutter, holder] = grown.deepest(&motions, &points, a);
    assert!(cutter <= sizes.chord_mm && holder < 0.0, "{cutter} {holder}");
    // It does come as near as that.
    assert!(cutter > -0.1 * a, "{cutter}");
}

/// A holder that is too wide for its length is seen.
#[test]
fn a_wide_low_holder_is_seen() {
    let bowl = Flipped(patch(Sphere::new(20.0).unwrap(), [0.0, 1.0], [-0.5, 0.5]));
    let tool = Tool { length: 14.0, holder_radius: 18.0, ..BALL };
    let passes = plan(&bowl, &tool, 0.3, &Strategy::Isoparametric { along: Along::Auto });
    let [_, holder] = tool.deepest(&cutting::motions(&bowl, &passes, &tool.cutter()), &points(&bowl), 0.0);
    assert!(holder > 1.0, "{holder}");
}
