//! The same answers as asking for every direction and every point.

use crate::reach::scenes::{
    KINDS, WIDE, assert_all, cutter, obstacles, scenes, slow_spare, spare_of, sphere, tool,
};
use osculate_geom::{Point3, Unit3, Vec3};
use osculate_tools::reach::{
    Barred, Bits, ObstacleKind, ObstaclePoint, Place, Reach, ReachLimits, ReachProblem, Tool,
};
use proptest::prelude::*;

#[test]
fn bits_and_best_on_parts_with_every_kind_of_cutter() {
    let directions = sphere(3);
    for (i, scene) in scenes().iter().enumerate() {
        let obstacles = obstacles(&scene.points);
        for kind in 0..KINDS {
            for holder in [true, false].into_iter().take(if kind == 0 { 2 } else { 1 }) {
                let tool = if holder { tool(kind) } else { Tool::new(cutter(kind), None) };
                let limits = ReachLimits { least_lean_rad: if kind == 1 { 0.02 } else { 0.0 }, ..WIDE };
                let problem = ReachProblem {
                    tool: &tool,
                    limits,
                    obstacles: &obstacles,
                    directions: &directions,
                    allowed: None,
                };
                let [free, blocked] = assert_all(problem, &scene.points, &scene.places);
                assert!(free > 0 && blocked > 0, "scene {i}, cutter {kind}, {holder}: {free} {blocked}");
            }
        }
    }
}

#[test]
fn a_gap_is_the_least_spare_and_names_what_has_it() {
    let directions = sphere(2);
    for scene in scenes() {
        let obstacles = obstacles(&scene.points);
        for kind in 0..KINDS {
            let tool = tool(kind);
            let problem = ReachProblem {
                tool: &tool,
                limits: WIDE,
                obstacles: &obstacles,
                directions: &directions,
                allowed: None,
            };
            let reach = Reach::new(problem).unwrap();
            for at in &scene.places {
                for axis in directions.all().iter().step_by(3) {
                    let slow = slow_spare(&tool, &WIDE, &scene.points, at, axis);
                    let gap = reach.gap(at, axis);
                    assert!((gap.spare_mm - slow).abs() < 1e-11, "{gap:?} {slow}");
                    let met = gap.met.unwrap();
                    assert!((spare_of(&tool, &WIDE, &met, at, axis) - slow).abs() < 1e-11);
                    let leans = reach.leans_within_limits(at, axis);
                    assert_eq!(reach.is_clear(at, axis), leans && gap.spare_mm >= 0.0);
                }
            }
        }
    }
}

#[test]
fn a_direction_is_possible_exactly_where_nothing_bars_it() {
    let directions = sphere(2);
    let all = directions.all();
    let mask = Bits::of(all.len(), |k| all[k].y > -0.6);
    let mut seen = [0; 4];
    for scene in scenes() {
        let obstacles = obstacles(&scene.points);
        for kind in 0..KINDS {
            let tool = tool(kind);
            let limits = ReachLimits { least_lean_rad: 0.1, ..WIDE };
            let allowed = Some(&mask);
            let problem =
                ReachProblem { tool: &tool, limits, obstacles: &obstacles, directions: &directions, allowed };
            let reach = Reach::new(problem).unwrap();
            for at in &scene.places {
                let bits = reach.bits(at);
                for (k, axis) in all.iter().enumerate() {
                    let barred = reach.barred(at, k);
                    assert_eq!(barred.is_none(), bits.contains(k), "{barred:?}");
                    let leans = reach.leans_within_limits(at, axis);
                    let which = match barred {
                        None => 0,
                        Some(Barred::Lean) => {
                            assert!(!leans);
                            1
                        }
                        Some(Barred::Machine) => {
                            assert!(leans && !mask.contains(k));
                            2
                        }
                        Some(Barred::Meets(met)) => {
                            assert!(leans && mask.contains(k));
                            let height = |p: &Point3| (p - at.point).dot(axis);
                            let own = height(&met.obstacle.point);
                            assert!(spare_of(&tool, &limits, &met, at, axis) < 0.0);
                            // Of those that are in the way nothing lies lower.
                            let lower = scene.points.iter().filter(|p| height(&p.point) < own - 1e-9);
                            for obstacle in lower.filter(|_| k % 7 == 0) {
                                let alone = slow_spare(&tool, &limits, &[*obstacle], at, axis);
                                assert!(alone >= 0.0, "{alone} of {obstacle:?} below {met:?}");
                            }
                            3
                        }
                    };
                    seen[which] += 1;
                }
            }
        }
    }
    assert!(seen.iter().all(|n| *n > 0), "{seen:?}");
}

#[test]
fn a_mask_takes_directions_away_and_nothing_else() {
    let directions = sphere(3);
    let scene = &scenes()[0];
    let obstacles = obstacles(&scene.points);
    let tool = tool(2);
    // What a four-axis machine with its rotary axis along x leaves: a band.
    let mask = Bits::of(directions.all().len(), |k| directions.all()[k].x.abs() < 0.1);
    let problem = ReachProblem {
        tool: &tool,
        limits: WIDE,
        obstacles: &obstacles,
        directions: &directions,
        allowed: None,
    };
    let masked = ReachProblem { allowed: Some(&mask), ..problem };
    assert_all(masked, &scene.points, &scene.places);
    let (all, some) = (Reach::new(problem).unwrap(), Reach::new(masked).unwrap());
    for at in &scene.places {
        assert_eq!(some.bits(at), all.bits(at).and(&mask));
    }
    let none = Bits::none(directions.all().len());
    let shut = Reach::new(ReachProblem { allowed: Some(&none), ..problem }).unwrap();
    assert!(shut.bits(&scene.places[0]).is_empty() && shut.best(&scene.places[0]).is_none());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]
    #[test]
    fn clouds_of_points(
        kind in 0..KINDS, holder in any::<bool>(),
        cloud in prop::collection::vec((prop::array::uniform3(-25.0..25.0f64), 0..3usize), 0..60),
        n in prop::array::uniform3(-1.0..1.0f64), gouge_mm in 0.0..0.5f64,
        clearance_mm in 0.0..2.0f64, stock_mm in 0.0..2.0f64,
        least in 0.0..0.5f64, most in 0.6..1.7f64,
    ) {
        let Some(normal) = Unit3::try_new(Vec3::from(n), 0.1) else { return Ok(()) };
        let at = Place { point: Point3::new(0.5, -0.25, 1.0), normal };
        let points: Vec<ObstaclePoint> = cloud.iter().enumerate().map(|(k, (p, kind))| ObstaclePoint {
            point: Point3::from(*p),
            owner: k as u32,
            kind: [ObstacleKind::Part, ObstacleKind::Surroundings, ObstacleKind::Stock][*kind],
        }).collect();
        let most_lean_rad = most.min(std::f64::consts::FRAC_PI_2);
        let limits = ReachLimits { gouge_mm, clearance_mm, stock_mm, least_lean_rad: (least - 0.1).max(0.0), most_lean_rad };
        let (tool, directions) = (if holder { tool(kind) } else { Tool::new(cutter(kind), None) }, sphere(2));
        let obstacles = obstacles(&points);
        let problem =
            ReachProblem { tool: &tool, limits, obstacles: &obstacles, directions: &directions, allowed: None };
        assert_all(problem, &points, &[at]);
    }
}
