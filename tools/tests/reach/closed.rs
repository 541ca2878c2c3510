//! Scenes whose possible axes have a closed form.

use crate::reach::scenes::{WIDE, cutter, obstacles, sphere};
use osculate_geom::{Point3, Unit3, Vec3};
use osculate_tools::reach::{
    ObstacleKind, ObstaclePoint, Obstacles, Place, Reach, ReachError, ReachLimits, ReachProblem, Tool,
};
use osculate_tools::{Cutter, CutterSpec, Holder};

const AT: Place =
    Place { point: Point3::new(0.0, 0.0, 0.0), normal: Unit3::new_unchecked(Vec3::new(0.0, 0.0, 1.0)) };
/// Exactly no gouge and no clearance: no direction of the set is at a limit here.
const EXACT: ReachLimits = ReachLimits { gouge_mm: 0.0, clearance_mm: 0.0, ..WIDE };

fn ball(radius: f64, length_mm: f64) -> Tool {
    let spec = CutterSpec::Ball { diameter_mm: 2.0 * radius, length_mm };
    Tool::new(Cutter::try_from(spec).unwrap(), None)
}

fn part(points: impl IntoIterator<Item = Point3>) -> Obstacles {
    let of = |point| ObstaclePoint { point, owner: 7, kind: ObstacleKind::Part };
    obstacles(&points.into_iter().map(of).collect::<Vec<_>>())
}

/// A point at the distance D from the ball's centre c stops the axes within asin(R / D) of its direction.
#[test]
fn a_point_stops_a_cap_of_axes() {
    let (tool, directions) = (ball(2.0, 1000.0), sphere(5));
    for p in [Point3::new(1.0, 2.0, 9.0), Point3::new(-6.0, 0.5, 4.0), Point3::new(3.0, -3.0, 2.5)] {
        let obstacles = part([p]);
        let problem = ReachProblem {
            tool: &tool,
            limits: EXACT,
            obstacles: &obstacles,
            directions: &directions,
            allowed: None,
        };
        let reach = Reach::new(problem).unwrap();
        let to = p - Point3::new(0.0, 0.0, 2.0);
        let cap = (2.0 / to.norm()).asin();
        let bits = reach.bits(&AT);
        for (k, axis) in directions.all().iter().enumerate().filter(|(_, a)| a.z >= 0.0) {
            assert_eq!(bits.contains(k), axis.angle(&Unit3::new_normalize(to)) > cap, "{k}");
        }
        // The best axis is square to it, or farther away, and nothing is better than the ball itself.
        let best = reach.best(&AT).unwrap();
        assert!(best.gap.spare_mm > 0.0 && best.gap.spare_mm <= to.norm() - 2.0 + 1e-12);
        assert_eq!(best.gap.met.unwrap().obstacle.owner, 7);
    }
}

/// The edge of a wall at the distance d and the height h is a line e along y. The cylinder of radius R about the axis a through
/// the ball's centre misses it where the distance of the two lines, `|w . (a x y)| / |a x y|` with w from the centre to the
/// edge, is R or more.
#[test]
fn a_wall_stops_what_leans_over_its_edge() {
    let (radius, d, h) = (2.0, 5.0, 8.0);
    let (tool, directions) = (ball(radius, 1e4), sphere(4));
    // Only the edge counts: points along it so near to each other that between them the tool comes no deeper than a
    // ten thousandth.
    let edge = (-60_000..=60_000).map(|k| Point3::new(d, 0.01 * f64::from(k), h));
    let obstacles = part(edge);
    let problem = ReachProblem {
        tool: &tool,
        limits: EXACT,
        obstacles: &obstacles,
        directions: &directions,
        allowed: None,
    };
    let reach = Reach::new(problem).unwrap();
    let bits = reach.bits(&AT);
    let w = Vec3::new(d, 0.0, h - radius);
    let mut seen = [0; 2];
    for (k, axis) in directions.all().iter().enumerate() {
        let across = axis.cross(&Vec3::y());
        // Axes that lean so far along the edge that they would pass its ends are not asked.
        if axis.z < 0.02 || across.norm() < 0.05 {
            continue;
        }
        let apart = w.dot(&across).abs() / across.norm();
        assert!(apart < radius - 1e-4 || apart > radius + 1e-12, "at the limit");
        assert_eq!(bits.contains(k), apart > radius, "{k}: {axis:?}");
        seen[usize::from(apart > radius)] += 1;
    }
    assert!(seen[0] > 100 && seen[1] > 300, "{seen:?}");
}

/// On a plane without anything else all axes are possible whose holder stays above it: with a holder of radius H at the
/// height L above the ball's tip, `R + (L - R) cos(theta) - H sin(theta) >= clearance`.
#[test]
fn a_holder_over_a_plane() {
    let directions = sphere(4);
    let (radius, length, wide, clearance_mm) = (2.0, 12.0, 10.0, 0.5);
    let holder = Holder::cylinder(2.0 * wide, 5.0).unwrap();
    let tool = Tool::new(*ball(radius, length).cutter(), Some(&holder));
    let step = 0.25;
    let points = (-120..=120)
        .flat_map(|i| (-120..=120).map(move |j| Point3::new(step * f64::from(i), step * f64::from(j), 0.0)));
    let obstacles = part(points);
    let limits = ReachLimits { gouge_mm: 1e-9, clearance_mm, ..WIDE };
    let problem =
        ReachProblem { tool: &tool, limits, obstacles: &obstacles, directions: &directions, allowed: None };
    let reach = Reach::new(problem).unwrap();
    let bits = reach.bits(&AT);
    let mut free = 0;
    for (k, axis) in directions.all().iter().enumerate().filter(|(_, a)| a.z >= 0.0) {
        let (cos, sin) = (axis.z, axis.x.hypot(axis.y));
        let over = radius + (length - radius) * cos - wide * sin - clearance_mm;
        // The nearest point of the lattice is at most step / sqrt 2 away from the lowest point of the rim, and the rim's
        // edge is off the plane by no more than that.
        if !(-0.3..=0.0).contains(&over) {
            assert_eq!(bits.contains(k), over > 0.0, "{k} {over}");
            free += usize::from(over > 0.0);
        }
    }
    assert!(free > 300);
}

#[test]
fn without_obstacles_the_lean_alone_counts() {
    let (tool, directions) = (ball(2.0, 30.0), sphere(4));
    let obstacles = Obstacles::default();
    let limits = ReachLimits { least_lean_rad: 0.2, most_lean_rad: 0.7, ..WIDE };
    let problem =
        ReachProblem { tool: &tool, limits, obstacles: &obstacles, directions: &directions, allowed: None };
    let reach = Reach::new(problem).unwrap();
    let bits = reach.bits(&AT);
    for (k, axis) in directions.all().iter().enumerate() {
        assert_eq!(bits.contains(k), (0.2..=0.7).contains(&axis.angle(&AT.normal)));
    }
    let gap = reach.gap(&AT, &AT.normal);
    assert!(gap.spare_mm == f64::INFINITY && gap.met.is_none() && reach.best(&AT).is_some());
}

#[test]
fn nonsense_is_refused() {
    let (tool, directions) = (Tool::new(cutter(0), None), sphere(1));
    let obstacles = Obstacles::default();
    let of = |limits| {
        let problem = ReachProblem {
            tool: &tool,
            limits,
            obstacles: &obstacles,
            directions: &directions,
            allowed: None,
        };
        Reach::new(problem).map(|_| ())
    };
    assert!(matches!(of(ReachLimits { gouge_mm: f64::NAN, ..WIDE }), Err(ReachError::Length { .. })));
    assert!(matches!(of(ReachLimits { clearance_mm: -1.0, ..WIDE }), Err(ReachError::Length { .. })));
    assert!(matches!(of(ReachLimits { most_lean_rad: 1.6, ..WIDE }), Err(ReachError::Lean { .. })));
    assert!(matches!(of(ReachLimits { least_lean_rad: f64::NAN, ..WIDE }), Err(ReachError::Lean { .. })));
    let point = Point3::new(0.0, f64::NAN, 0.0);
    assert!(Obstacles::new([ObstaclePoint { point, owner: 0, kind: ObstacleKind::Part }]).is_err());
    let short = osculate_tools::reach::Bits::none(3);
    let problem = ReachProblem {
        tool: &tool,
        limits: WIDE,
        obstacles: &obstacles,
        directions: &directions,
        allowed: Some(&short),
    };
    assert!(matches!(Reach::new(problem), Err(ReachError::Mask { mask: 3, directions: 42 })));
    // A place that is nowhere has no axes.
    let obstacles = part([Point3::new(50.0, 0.0, 0.0)]);
    let problem = ReachProblem { allowed: None, obstacles: &obstacles, ..problem };
    assert!(Reach::new(problem).unwrap().bits(&Place { point, ..AT }).is_empty());
}
