//! Parts as clouds of points, with places on them, and the reach found by asking for everything.

use osculate_geom::{Point3, Unit3, Vec3};
use osculate_tools::reach::{
    Bits, Directions, Met, ObstacleKind, ObstaclePoint, Obstacles, Place, Reach, ReachLimits, ReachProblem,
    Tool,
};
use osculate_tools::{Cutter, CutterSpec, Holder, pose_with_axis};
use std::f64::consts::TAU;

pub const WIDE: ReachLimits = ReachLimits {
    gouge_mm: 0.01,
    clearance_mm: 0.5,
    stock_mm: 0.7,
    least_lean_rad: 0.0,
    most_lean_rad: std::f64::consts::FRAC_PI_2,
};

pub fn cutter(kind: usize) -> Cutter {
    let length_mm = 12.0;
    let spec = match kind {
        0 => CutterSpec::Ball { diameter_mm: 4.0, length_mm },
        1 => CutterSpec::Flat { diameter_mm: 5.0, length_mm },
        2 => CutterSpec::Toroidal { diameter_mm: 6.0, corner_radius_mm: 1.0, length_mm },
        3 => CutterSpec::Cone {
            diameter_mm: 6.0,
            taper_deg: 8.0,
            corner_radius_mm: 1.0,
            tip_diameter_mm: None,
            length_mm: 20.0,
        },
        4 => {
            CutterSpec::Barrel { diameter_mm: 6.0, barrel_radius_mm: 30.0, corner_radius_mm: 1.0, length_mm }
        }
        _ => CutterSpec::Apt {
            diameter_mm: 6.0,
            corner_radius_mm: 0.5,
            bottom_angle_deg: 5.0,
            side_angle_deg: 3.0,
            length_mm,
        },
    };
    Cutter::try_from(spec).unwrap()
}

pub const KINDS: usize = 6;

/// A cutter with a holder of 12 mm, and a wider nut above.
pub fn tool(kind: usize) -> Tool {
    let cutter = cutter(kind);
    let nut = Cutter::cylinder(18.0, 10.0).unwrap();
    let height_mm = cutter.length_mm() + 5.0;
    Tool::new(cutter, Some(&Holder::cylinder(12.0, 30.0).unwrap()))
        .with(osculate_tools::reach::Mounted { body: nut, height_mm })
        .unwrap()
}

pub struct Scene {
    pub points: Vec<ObstaclePoint>,
    pub places: Vec<Place>,
}

fn unit(v: Vec3) -> Unit3 {
    Unit3::new_normalize(v)
}

/// A face as a map of two parameters in 0..1 to point and outward normal.
pub type Face = fn(f64, f64) -> Place;

fn floor(u: f64, v: f64) -> Place {
    Place { point: Point3::new(9.0 * (u - 0.5), 40.0 * (v - 0.5), 0.0), normal: Vec3::z_axis() }
}

fn left(u: f64, v: f64) -> Place {
    Place { point: Point3::new(-4.5, 40.0 * (v - 0.5), 14.0 * u), normal: Vec3::x_axis() }
}

fn right(u: f64, v: f64) -> Place {
    let at = left(u, v);
    Place { point: at.point + Vec3::new(9.0, 0.0, 0.0), normal: -at.normal }
}

/// The inside of a torus' tube of radius 6, its lower half.
fn groove(u: f64, v: f64) -> Place {
    let ((su, cu), (sv, cv)) = ((u * TAU).sin_cos(), (0.5 * TAU * (1.0 + v)).sin_cos());
    let out = Vec3::new(cu * cv, su * cv, sv);
    Place { point: Point3::new(25.0 * cu, 25.0 * su, 0.0) + out * 6.0, normal: unit(-out) }
}

fn bump(u: f64, v: f64) -> Place {
    let ((su, cu), (sv, cv)) = ((u * TAU).sin_cos(), (v * 0.25 * TAU).sin_cos());
    let out = Vec3::new(cu * cv, su * cv, sv);
    Place { point: Point3::origin() + out * 8.0, normal: unit(out) }
}

fn plane(u: f64, v: f64) -> Place {
    Place { point: Point3::new(60.0 * (u - 0.5), 60.0 * (v - 0.5), 0.0), normal: Vec3::z_axis() }
}

/// `count` steps along each parameter of each face; places at a few of the points and between them.
pub fn scene(faces: &[Face], count: usize, places: usize) -> Scene {
    let at = |k: usize, n: usize| k as f64 / n as f64;
    let mut points = Vec::new();
    for (owner, face) in faces.iter().enumerate() {
        for i in 0..=count {
            for j in 0..=count {
                let point = face(at(i, count), at(j, count)).point;
                points.push(ObstaclePoint { point, owner: owner as u32, kind: ObstacleKind::Part });
            }
        }
    }
    // A low-discrepancy sequence, so that places lie anywhere between the points.
    let spread = |k: usize| [0.754_877_666, 0.569_840_291].map(|step| (0.5 + step * k as f64).fract());
    let places = (0..places).map(|k| {
        let [u, v] = spread(k);
        faces[k % faces.len()](u, v)
    });
    Scene { points, places: places.collect() }
}

pub fn scenes() -> [Scene; 4] {
    let clamp = |x: f64, y: f64, z: f64, owner| ObstaclePoint {
        point: Point3::new(x, y, z),
        owner,
        kind: ObstacleKind::Surroundings,
    };
    let raw = |x: f64, y: f64, z: f64| ObstaclePoint { kind: ObstacleKind::Stock, ..clamp(x, y, z, 10) };
    let mut all = [
        scene(&[floor, left, right], 24, 15),
        scene(&[groove], 40, 15),
        scene(&[bump, plane], 30, 15),
        scene(&[plane], 30, 15),
    ];
    for k in 0..20 {
        let z = 0.7 * f64::from(k);
        all[2].points.push(clamp(12.0, 3.0, z, 8));
        all[3].points.push(clamp(-6.0, 2.0 + 0.1 * z, z, 9));
        // The cutter goes through it.
        all[0].points.push(raw(0.3 * z - 2.0, 1.0, 1.5 * z));
        all[3].points.push(raw(2.0, -1.0, 1.5 * z));
    }
    all
}

/// The least spare of a pose over all bodies and points, with what has it.
pub fn slow_spare(
    tool: &Tool,
    limits: &ReachLimits,
    points: &[ObstaclePoint],
    at: &Place,
    axis: &Unit3,
) -> f64 {
    let pose = pose_with_axis(tool.cutter(), &at.point, &at.normal, axis);
    let own = |p: &ObstaclePoint| {
        let [own, above] = match p.kind {
            ObstacleKind::Part => [-limits.gouge_mm, limits.clearance_mm],
            ObstacleKind::Surroundings => [limits.clearance_mm; 2],
            ObstacleKind::Stock => [f64::NEG_INFINITY, limits.stock_mm],
        };
        let cutter = tool.cutter().distance(&pose, &p.point) - own;
        tool.mounted().iter().fold(cutter, |least, m| {
            let spare = m.body.distance(&pose.retracted(m.height_mm), &p.point) - above;
            least.min(spare)
        })
    };
    points.iter().map(own).fold(f64::INFINITY, f64::min)
}

/// Whether a pose may lean so.
pub fn leans(limits: &ReachLimits, at: &Place, axis: &Unit3) -> bool {
    let cosine = at.normal.dot(axis);
    let most = if limits.most_lean_rad < 1.57 { limits.most_lean_rad.cos() } else { 0.0 };
    cosine >= most && (limits.least_lean_rad == 0.0 || cosine <= limits.least_lean_rad.cos())
}

/// A slow answer for all directions: spares where the lean allows one.
pub fn slow_spares(problem: &ReachProblem<'_>, points: &[ObstaclePoint], at: &Place) -> Vec<Option<f64>> {
    let all = problem.directions.all().iter().enumerate();
    all.map(|(k, axis)| {
        let is_allowed =
            problem.allowed.is_none_or(|mask| mask.contains(k)) && leans(&problem.limits, at, axis);
        is_allowed.then(|| slow_spare(problem.tool, &problem.limits, points, at, axis))
    })
    .collect()
}

/// Two ways to the same distance differ by some roundings of coordinates up to a hundred.
pub const ROUNDING_MM: f64 = 1e-11;

/// The bits are those of the spares, but where a spare is zero to rounding. Number of directions in the set.
pub fn assert_same(bits: &Bits, spares: &[Option<f64>], what: &str) -> usize {
    for (k, spare) in spares.iter().enumerate() {
        let spare = spare.unwrap_or(f64::NEG_INFINITY);
        assert!(
            bits.contains(k) == (spare >= 0.0) || spare.abs() < ROUNDING_MM,
            "{what}: direction {k} has spare {spare}, bit {}",
            bits.contains(k)
        );
    }
    bits.count()
}

/// Asserts bits, best and gap of places against the slow answers. Numbers of possible and of impossible directions.
pub fn assert_all(problem: ReachProblem<'_>, points: &[ObstaclePoint], places: &[Place]) -> [usize; 2] {
    let reach = Reach::new(problem).unwrap();
    let all = reach.map(places);
    let mut counts = [0; 2];
    for (i, (at, bits)) in places.iter().zip(&all).enumerate() {
        let spares = slow_spares(&problem, points, at);
        let own = assert_same(bits, &spares, &format!("place {i}"));
        counts[0] += own;
        counts[1] += spares.iter().flatten().count() - own;
        assert_eq!(*bits, reach.bits(at));
        let best = spares.iter().flatten().copied().fold(f64::NEG_INFINITY, f64::max);
        match reach.best(at) {
            None => assert!(spares.iter().all(Option::is_none)),
            Some(found) => {
                let own = found.gap.spare_mm;
                // Without obstacles both are infinite.
                let is_same = |slow: f64| slow == own || (slow - own).abs() < ROUNDING_MM;
                assert!(is_same(best) && is_same(spares[found.direction].unwrap()), "place {i}");
            }
        }
    }
    counts
}

/// The spare of what a gap names, found without the tree.
pub fn spare_of(tool: &Tool, limits: &ReachLimits, met: &Met, at: &Place, axis: &Unit3) -> f64 {
    slow_spare(tool, limits, &[met.obstacle], at, axis)
}

pub fn obstacles(points: &[ObstaclePoint]) -> Obstacles {
    Obstacles::new(points.iter().copied()).unwrap()
}

pub fn sphere(level: u32) -> Directions {
    Directions::icosphere(level).unwrap()
}
