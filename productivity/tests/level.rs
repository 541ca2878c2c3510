//! Passes along level lines of a field: what they leave on analytic faces, by material removal, and spacings in closed form.

use crate::cutting;

use cutting::{cusps, motions, verdict};
use nalgebra::Vector2;
use osculate_geom::analytic::{Cylinder, Paraboloid, Placed, Placement, Plane, Sphere, Torus};
use osculate_geom::{
    Axis, Domain, Flipped, Interval, Jet2, Patch, Point3, Series, Side, Surface, Taylor, Unit3, Uv, Vec3, uv,
};
use osculate_productivity::plan::{
    CcPoint, Named, Passes, PlanError, Strategy, Task, Tolerance, run, wall_edges,
};
use osculate_tools::removal::{Kind, Swept};
use osculate_tools::{Cutter, CutterSpec, Lean};

const TOLERANCE: Tolerance = Tolerance { scallop_mm: 0.01, gouge_mm: 0.004, chord_mm: 0.002 };

fn ball(diameter_mm: f64) -> Cutter {
    Cutter::try_from(CutterSpec::Ball { diameter_mm, length_mm: 50.0 }).unwrap()
}

/// A tool at a lead and what it must hold.
struct Job {
    cutter: Cutter,
    lead_rad: f64,
    tolerance: Tolerance,
    /// Of the samples of the verification.
    spacing_mm: f64,
}

impl Job {
    fn new(cutter: Cutter, lead_rad: f64) -> Self {
        Self { cutter, lead_rad, tolerance: TOLERANCE, spacing_mm: 0.2 }
    }

    fn plan(&self, surface: &dyn Surface, strategy: &Strategy) -> Passes {
        let lean = Lean { lead_rad: self.lead_rad, tilt_rad: 0.0 };
        let (cutter, tolerance) = (&self.cutter, self.tolerance);
        let task = Task::new("F1", surface, cutter, lean, tolerance);
        run(&task, strategy).unwrap()
    }

    /// Plans and verifies; the motions come back.
    fn holds(&self, name: &str, surface: &dyn Surface, strategy: &Strategy) -> Vec<Swept> {
        let passes = self.plan(surface, strategy);
        let moves = motions(surface, &passes.passes, &self.cutter);
        let v = verdict(surface, &moves, &self.cutter, self.tolerance, self.spacing_mm);
        let worst = |kind: Kind| v.worst.iter().find(|w| w.kind == kind);
        assert!(v.scallop_max_mm <= self.tolerance.scallop_mm, "{name}: {:?}", worst(Kind::Scallop));
        assert!(v.gouge_max_mm <= self.tolerance.gouge_mm, "{name}: {:?}", worst(Kind::Gouge));
        assert!(v.uncut_samples == 0, "{name}: {:?}", worst(Kind::Uncut));
        moves
    }
}

fn patch<S: Surface>(surface: S, u: [f64; 2], v: [f64; 2]) -> Patch<S> {
    let domain = Domain { u: Interval::new(u[0], u[1]), v: Interval::new(v[0], v[1]) };
    Patch { surface, domain, side: Side::Along }
}

fn isoplanar(normal: [f64; 3]) -> Strategy {
    Strategy::Isoplanar { normal: Unit3::new_normalize(Vec3::from(normal)) }
}

#[test]
fn parallel_planes_on_a_plane_at_any_angle() {
    let i = Interval::new(0.0, 12.0);
    let face = Plane::new(Domain { u: i, v: i });
    let job = Job::new(ball(6.0), 0.1);
    for normal in [[0.0, 1.0, 0.0], [1.0, 2.0, 0.0], [-1.0, 0.9, 0.3]] {
        job.holds("plane", &face, &isoplanar(normal));
        let passes = job.plan(&face, &isoplanar(normal)).passes;
        // On a plane the ball leaves R - sqrt(R^2 - (s/2)^2) between passes s apart.
        let h: f64 = 0.98 * TOLERANCE.scallop_mm;
        let spacing = 2.0 * (h * (6.0 - h)).sqrt();
        let d = Vec3::new(normal[0], normal[1], 0.0).normalize();
        let mut heights: Vec<f64> = passes.iter().map(|p| p.points[1].point.coords.dot(&d)).collect();
        heights.sort_by(f64::total_cmp);
        for w in heights[..heights.len() - 2].windows(2) {
            assert!(((w[1] - w[0]) / spacing - 1.0).abs() < 0.02, "{w:?} against {spacing}");
        }
    }
}

#[test]
fn parallel_planes_on_round_faces() {
    let cylinder = patch(Cylinder::new(15.0, Interval::new(0.0, 10.0)).unwrap(), [0.3, 1.5], [0.0, 10.0]);
    Job::new(ball(6.0), 0.1).holds("cylinder, along", &cylinder, &isoplanar([1.0, -1.0, 0.0]));
    Job::new(ball(6.0), 0.1).holds("cylinder, around", &cylinder, &isoplanar([0.0, 0.0, 1.0]));
    Job::new(ball(6.0), 0.1).holds("cylinder, slanted", &cylinder, &isoplanar([-0.5, 0.5, 1.0]));
    let whole = Cylinder::new(8.0, Interval::new(0.0, 5.0)).unwrap();
    Job::new(ball(6.0), 0.1).holds("whole cylinder, loops", &whole, &isoplanar([0.0, 0.0, 1.0]));
    let cap = patch(Sphere::new(20.0).unwrap(), [-0.3, 0.4], [-0.2, 0.4]);
    Job::new(ball(8.0), 0.1).holds("sphere", &cap, &isoplanar([0.0, 0.0, 1.0]));
    let groove = Flipped(patch(Torus::new(200.0, 60.0).unwrap(), [0.0, 0.1], [2.9, 3.3]));
    let spec = CutterSpec::Toroidal { diameter_mm: 20.0, corner_radius_mm: 2.0, length_mm: 60.0 };
    let wide = Job::new(Cutter::try_from(spec).unwrap(), 0.25);
    wide.holds("groove", &groove, &isoplanar([0.0, 0.1, 1.0]));
    // Level along its lowest line: one level has a pass on either side of it.
    let valley = Flipped(patch(Torus::new(200.0, 60.0).unwrap(), [0.0, 0.06], [4.5, 5.0]));
    wide.holds("valley", &valley, &isoplanar([0.0, 0.0, 1.0]));
}

/// Where a plane touches the inner side of a ring the lines of the planes beside it bend sharply, and the straight way uphill may miss
/// them: each stays in its plane, and none fails, wherever the planes lie.
#[test]
fn planes_beside_a_saddle_are_kept_to() {
    let normal = [1.0, 0.4, 0.2];
    let job = Job {
        tolerance: Tolerance { scallop_mm: 0.05, gouge_mm: 0.02, chord_mm: 0.005 },
        ..Job::new(ball(6.0), 0.15)
    };
    for k in 0..24 {
        let radius_mm = 14.0 + 6.0 * (0.2 + 0.4 * f64::from(k) / 24.0);
        let hollow = patch(Flipped(Torus::new(40.0, radius_mm).unwrap()), [0.0, 0.4], [2.6, 3.5]);
        let passes = job.plan(&hollow, &isoplanar(normal)).passes;
        let d = Vec3::from(normal).normalize();
        for pass in &passes {
            let height = |p: &CcPoint| p.point.coords.dot(&d);
            let mut heights: Vec<f64> = pass.points.iter().map(height).collect();
            heights.sort_by(f64::total_cmp);
            let middle = heights[heights.len() / 2];
            let off = heights.iter().map(|h| (h - middle).abs()).fold(0.0, f64::max);
            assert!(off < 1e-6, "radius {radius_mm}: {off} off the plane {middle}");
        }
    }
    let hollow = patch(Flipped(Torus::new(40.0, 17.2302).unwrap()), [0.0, 0.4], [2.6, 3.5]);
    job.holds("beside a saddle", &hollow, &isoplanar(normal));
}

#[test]
fn even_passes_on_round_and_free_faces() {
    let saddle = Paraboloid::new([0.01, -0.006], 8.0).unwrap();
    for strategy in [Strategy::Isoscallop, Strategy::Streamline] {
        let job = Job::new(ball(6.0), 0.1);
        let moves = job.holds(strategy.name(), &saddle, &strategy);
        let used = cusps(&saddle, &moves, &job.cutter, TOLERANCE.scallop_mm);
        assert!(used > 0.8, "{used}");
    }
}

/// A flat cutter's strips along the hollows of this face are bounded by its rim, which the closed form of the width does not see:
/// lines that followed that form wavered between directions and used a fifth of the tolerance.
#[test]
fn a_flat_cutter_leaves_even_crests() {
    let face = osculate_surfaces::gallery::m86(4);
    let spec = CutterSpec::Flat { diameter_mm: 12.0, length_mm: 80.0 };
    let job = Job { spacing_mm: 0.5, ..Job::new(Cutter::try_from(spec).unwrap(), 6.0_f64.to_radians()) };
    let moves = job.holds("m86-4", &face, &Strategy::Isoscallop);
    let used = cusps(&face, &moves, &job.cutter, TOLERANCE.scallop_mm);
    assert!(used > 0.85, "{used}");
}

/// On a face that winds along the passes a leaning tool reaches further to one side. To and fro passes meet with far sides and near
/// sides in turn: both kinds of ridges stand at the tolerance, and spacing is wide and narrow by turns.
#[test]
fn passes_to_and_fro_use_the_far_side_of_the_tool() {
    let saddle = Paraboloid::new([0.004, -0.004], 30.0).unwrap();
    let spec = CutterSpec::Toroidal { diameter_mm: 16.0, corner_radius_mm: 2.0, length_mm: 80.0 };
    let job = Job { spacing_mm: 0.5, ..Job::new(Cutter::try_from(spec).unwrap(), 0.06) };
    let strategy = isoplanar([1.0, 1.0, 0.0]);
    let passes = job.plan(&saddle, &strategy).passes;
    let moves = job.holds("saddle", &saddle, &strategy);
    let used = cusps(&saddle, &moves, &job.cutter, TOLERANCE.scallop_mm);
    let levels: Vec<f64> = passes.iter().map(|p| p.points[1].point.x + p.points[1].point.y).collect();
    let gaps: Vec<f64> = levels.windows(2).map(|w| (w[1] - w[0]).abs()).collect();
    let uneven =
        gaps[2..gaps.len() - 2].windows(2).map(|w| (w[1] / w[0]).ln().abs()).fold(f64::INFINITY, f64::min);
    assert!(used > 0.85 && uneven > 0.05, "{used} {uneven} {gaps:?}");
}

/// How much passes turn at most within `arc_mm` of their way, rad.
fn sharpest_turn(passes: &Passes, arc_mm: f64) -> f64 {
    let mut sharpest = 0.0f64;
    for pass in &passes.passes {
        let ways: Vec<Vec3> = pass.points.windows(2).map(|w| w[1].point - w[0].point).collect();
        for (k, way) in ways.iter().enumerate() {
            let mut gone = 0.0;
            for next in ways[k + 1..].iter() {
                if gone > arc_mm {
                    break;
                }
                sharpest = sharpest.max(way.angle(next));
                gone += next.norm();
            }
        }
    }
    sharpest
}

/// The faces of M86 with umbilics, with a larger tolerance so that the tests stay short.
#[test]
fn umbilics_leave_no_hole_and_no_hook() {
    let spec = CutterSpec::Toroidal { diameter_mm: 8.0, corner_radius_mm: 2.0, length_mm: 60.0 };
    let tolerance = Tolerance { scallop_mm: 0.06, gouge_mm: 0.01, chord_mm: 0.01 };
    let job = Job { cutter: Cutter::try_from(spec).unwrap(), lead_rad: 0.3, tolerance, spacing_mm: 0.5 };
    for k in [3, 4] {
        let face = osculate_surfaces::gallery::m86(k);
        for strategy in [Strategy::Isoscallop, Strategy::Curvature5c] {
            let name = format!("m86-{k} {}", strategy.name());
            job.holds(&name, &face, &strategy);
            // Lines of curvature bend sharply beside an umbilic; a hook would turn back over the tool's radius.
            let most = if strategy == Strategy::Curvature5c { 1.4 } else { 0.6 };
            let turn = sharpest_turn(&job.plan(&face, &strategy), job.cutter.radius_mm());
            assert!(turn < most, "{name}: turns by {turn}");
        }
    }
}

/// A tilted ring around a sphere's cap: the outer loop and a hole, as the trims of a file would have them.
struct Ring(Patch<Sphere>);

impl Surface for Ring {
    fn domain(&self) -> Domain {
        self.0.domain()
    }
    fn jet2(&self, at: Uv) -> Jet2 {
        self.0.jet2(at)
    }
    fn taylor(&self, at: Uv, order: usize) -> Taylor {
        self.0.taylor(at, order)
    }
    fn contains(&self, at: Uv) -> bool {
        let r = (1.3 * at.u + 0.2 * at.v).hypot(at.v - 0.1 * at.u);
        self.0.contains(at) && (0.12..0.33).contains(&r)
    }
}

#[test]
fn trims_and_holes_are_covered_and_not_more_than_they_need() {
    let ring = Ring(patch(Sphere::new(20.0).unwrap(), [-0.5, 0.5], [-0.5, 0.5]));
    let job = Job::new(ball(6.0), 0.1);
    for strategy in [isoplanar([0.3, 0.2, 1.0]), Strategy::Isoscallop] {
        job.holds(strategy.name(), &ring, &strategy);
        let whole = job.plan(&ring.0, &strategy);
        let trimmed = job.plan(&ring, &strategy);
        // The ring is a quarter of the rectangle; its passes run out by half a strip at each end.
        assert!(
            trimmed.length_mm() < 0.45 * whole.length_mm(),
            "{}",
            trimmed.length_mm() / whole.length_mm()
        );
    }
}

/// Passes around a tube close; passes along it meet at the seam across which their field is cut.
#[test]
fn seams_leave_no_mark() {
    let tube = Cylinder::new(6.0, Interval::new(0.0, 8.0)).unwrap();
    let job = Job::new(ball(6.0), 0.1);
    let around = job.plan(&tube, &isoplanar([0.1, 0.0, 1.0]));
    assert!(around.passes.iter().filter(|p| p.closed).count() > 10);
    job.holds("around", &tube, &isoplanar([0.1, 0.0, 1.0]));
    job.holds("isoscallop", &tube, &Strategy::Isoscallop);
}

/// A triangle in a plane, with a tip towards lower u between sides that rise by 20 for one.
struct Tip(Plane, Uv);

impl Surface for Tip {
    fn domain(&self) -> Domain {
        self.0.domain()
    }
    fn jet2(&self, at: Uv) -> Jet2 {
        self.0.jet2(at)
    }
    fn taylor(&self, at: Uv, order: usize) -> Taylor {
        self.0.taylor(at, order)
    }
    fn contains(&self, at: Uv) -> bool {
        self.0.contains(at) && (at.v - self.1.v).abs() * 20.0 <= at.u - self.1.u
    }
    fn spans(&self, axis: Axis, fixed: f64) -> Vec<Interval> {
        let (Uv { u, v }, top) = (self.1, self.domain().u.hi);
        let [lo, hi] = match axis {
            Axis::U => [u + 20.0 * (fixed - v).abs(), top],
            Axis::V => [-1.0, 1.0].map(|side| v + side * 0.05 * (fixed - u)),
        };
        if lo < hi { vec![Interval::new(lo, hi)] } else { Vec::new() }
    }
    fn turns(&self) -> Vec<Uv> {
        let (Uv { u, v }, top) = (self.1, self.domain().u.hi);
        [-1.0, 0.0, 1.0].map(|side: f64| uv(u + side.abs() * (top - u), v + side * 0.05 * (top - u))).to_vec()
    }
}

/// A sharp corner of the trims may be all that lies in a cell, and narrower than what is looked at along a level: the first pass still
/// comes as near as half a strip, and runs over it.
#[test]
fn a_sharp_tip_is_covered() {
    let i = Interval::new(0.0, 12.0);
    let job = Job::new(ball(6.0), 0.1);
    let h = TOLERANCE.scallop_mm;
    let half = (h * (6.0 - h)).sqrt();
    for k in 0..40 {
        let tip = uv(1.0 + 0.0071 * f64::from(k), 6.0);
        let face = Tip(Plane::new(Domain { u: i, v: i }), tip);
        let passes = job.plan(&face, &isoplanar([1.0, 0.1, 0.0])).passes;
        let to = |w: &[CcPoint]| {
            let (a, b) = (w[0].point.xy().coords, w[1].point.xy().coords);
            let (way, to) = (b - a, Vector2::new(tip.u, tip.v) - a);
            (to - way * (to.dot(&way) / way.norm_squared()).clamp(0.0, 1.0)).norm()
        };
        let nearest = passes.iter().flat_map(|p| p.points.windows(2)).map(to).fold(f64::INFINITY, f64::min);
        assert!(nearest <= half, "{tip:?}: {nearest} of {half}");
    }
}

/// A roof with a rounded edge, `z = -0.4 sqrt(x^2 + r^2)`.
struct Roof;

impl Surface for Roof {
    fn domain(&self) -> Domain {
        Domain { u: Interval::new(-4.0, 10.0), v: Interval::new(0.0, 14.0) }
    }
    fn jet2(&self, at: Uv) -> Jet2 {
        self.taylor(at, 2).jet2()
    }
    fn taylor(&self, at: Uv, order: usize) -> Taylor {
        let (x, y) = (Series::variable(Axis::U, at.u, order), Series::variable(Axis::V, at.v, order));
        let z = (x * x + Series::constant(0.04, order)).sqrt() * -0.4;
        Taylor { uv: at, side: Side::Along, coordinates: [x, y, z] }
    }
    fn breaks(&self, axis: Axis) -> Vec<f64> {
        let i = self.domain().get(axis);
        (0..=28).map(|k| i.at(f64::from(k) / 28.0)).collect()
    }
}

/// At the edge the normal turns faster than the tool follows it: that is no reason for passes elsewhere to lie closer.
#[test]
fn an_edge_does_not_make_the_rest_of_a_face_rough() {
    let spec = CutterSpec::Toroidal { diameter_mm: 6.0, corner_radius_mm: 1.0, length_mm: 50.0 };
    let job = Job::new(Cutter::try_from(spec).unwrap(), 0.1);
    let along = isoplanar([1.0, 0.0, 0.0]);
    let moves = job.holds("roof", &Roof, &along);
    let used = cusps(&Roof, &moves, &job.cutter, TOLERANCE.scallop_mm);
    assert!(used > 0.9, "{used}");
}

/// A wall that stands on a line through a point, 12 mm high and leaning back from upright; it looks to the right of the line.
fn wall(on: [f64; 2], along: Vec3, back_rad: f64) -> Placed<Plane> {
    let to_right = along.cross(&Vec3::z());
    let normal = Vec3::z() * back_rad.sin() + to_right * back_rad.cos();
    let placement = Placement::new(Point3::new(on[0], on[1], 0.0), Unit3::new_normalize(normal), Some(along));
    // With its normal to the right and x along, y runs up.
    let domain = Domain { u: Interval::new(-40.0, 40.0), v: Interval::new(0.0, 12.0) };
    Placed { surface: Plane::new(domain), placement }
}

#[test]
fn passes_run_along_the_walls_beside_them() {
    let floor = Plane::new(Domain { u: Interval::new(-10.0, 10.0), v: Interval::new(-9.0, 9.0) });
    let corners = [[-10.0, -9.0], [10.0, -9.0], [10.0, 9.0], [-10.0, 9.0]].map(|[u, v]| uv(u, v));
    let cutter = ball(6.0);
    let edges = |walls: &[Placed<Plane>]| {
        let named: Vec<Named<'_>> = walls.iter().map(|w| Named { face: "wall", surface: w }).collect();
        wall_edges((&floor, &[corners.to_vec()]), &named, &cutter).unwrap()
    };
    // The directions in which the passes of the floor run.
    let run_between = |walls: &[Placed<Plane>]| -> Result<Vec<Vec3>, PlanError> {
        let edges = edges(walls);
        let lean = Lean { lead_rad: 0.1, tilt_rad: 0.0 };
        let task = Task::new("floor", &floor, &cutter, lean, TOLERANCE).beside(&edges);
        let passes = run(&task, &Strategy::AlongWalls)?.passes;
        let pieces = passes.iter().flat_map(|p| p.points.windows(2)).map(|w| w[1].point - w[0].point);
        Ok(pieces.filter(|w| w.norm() > 1e-3).map(|w| w.normalize()).collect())
    };
    let (x, y) = (Vec3::x(), Vec3::y());
    // Walls to both sides, and a single one; upright, and leaning back by 60 degrees.
    for back_rad in [0.0, 1.05] {
        let both = [wall([0.0, 9.0], x, back_rad), wall([0.0, -9.0], -x, back_rad)];
        let along = run_between(&both).unwrap();
        assert!(along.len() > 20 && along.iter().all(|d| d.x.abs() > 0.97), "{back_rad}");
        let along = run_between(&[wall([-10.0, 0.0], y, back_rad)]).unwrap();
        assert!(along.len() > 20 && along.iter().all(|d| d.y.abs() > 0.97), "{back_rad}");
    }
    // What rises by 7 degrees only, goes on level or falls away is no wall.
    for back_rad in [1.45, std::f64::consts::FRAC_PI_2, 2.5] {
        let gentle = [wall([0.0, 9.0], x, back_rad)];
        assert!(edges(&gentle).is_empty(), "{back_rad}");
        assert!(matches!(run_between(&gentle), Err(PlanError::Nothing { .. })));
    }
}
