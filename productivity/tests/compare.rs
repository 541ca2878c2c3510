//! Screening of candidates: against closed forms where strips have one, and the reasons for what is not possible.

use osculate_geom::analytic::{Paraboloid, Plane, Sphere};
use osculate_geom::{Axis, Domain, Interval, Surface, Unit3, Vec3};
use osculate_productivity::closed_form::{Section, width_37};
use osculate_productivity::compare::{Around, Axes, Candidate, Reason, Screened, Setting, Tool, screen};
use osculate_productivity::ideal::{Feeding, Patch, Search, ideal};
use osculate_productivity::optimum::Range;
use osculate_productivity::plan::{
    Along, DropTask, Named, Strategy, Task, ThreeAxis, ThreeAxisLines, Tolerance, drop_cutter, gradient_3c,
    run, waterline_3c,
};
use osculate_tools::{Cutter, CutterSpec, Holder, Lean};
use std::f64::consts::{FRAC_PI_2, PI};

const TOLERANCE: Tolerance = Tolerance { scallop_mm: 0.01, gouge_mm: 0.002, chord_mm: 0.002 };
const FEED: f64 = 1200.0;

fn ball(diameter_mm: f64) -> Cutter {
    Cutter::try_from(CutterSpec::Ball { diameter_mm, length_mm: 60.0 }).unwrap()
}

fn toroidal(diameter_mm: f64) -> Cutter {
    let spec = CutterSpec::Toroidal { diameter_mm, corner_radius_mm: 1.0, length_mm: 8.0 };
    Cutter::try_from(spec).unwrap()
}

fn along(axis: Axis, lead_deg: f64) -> Candidate {
    Candidate {
        tool: 0,
        strategy: Strategy::Isoparametric { along: Along::Fixed(axis) },
        axes: Axes::Held,
        lean: Lean { lead_rad: f64::to_radians(lead_deg), tilt_rad: 0.0 },
    }
}

fn screened(patch: Patch<'_>, tool: Tool<'_>, around: &Around, candidates: &[Candidate]) -> Vec<Screened> {
    let (faces, tools) = ([patch], [tool]);
    screen(&Setting { faces: &faces, tools: &tools, tolerance: TOLERANCE, around, line: None }, candidates)
}

/// Meridians of a sphere lie as far apart as the equator lets them: pi / 2 times as long as strips side by side.
#[test]
fn meridians_overlap_and_parallels_do_not() {
    let sphere = Sphere::new(25.0).unwrap();
    let area_mm2 = 4.0 * PI * 625.0;
    let cutter = ball(8.0);
    let tool = Tool { cutter: &cutter, holder: None, feed_mm_min: FEED };
    let both = [along(Axis::U, 15.0), along(Axis::V, 15.0)];
    let found = screened(Patch { surface: &sphere, area_mm2 }, tool, &Around::default(), &both);
    let section = Section { part_per_mm: 0.04, tool_per_mm: 0.25, scallop_mm: TOLERANCE.scallop_mm };
    let bare = area_mm2 / (width_37(section).unwrap() * FEED);
    for (s, overlap) in found.iter().zip([1.0, FRAC_PI_2]) {
        assert!(s.out.is_none(), "{s:?}");
        assert!((s.pointwise_min / bare - 1.0).abs() < 5e-3, "{s:?} {bare}");
        // The rows nearest to the equator stand half a cell, 11 degrees, off it.
        assert!((s.layout_min / bare / overlap - 1.0).abs() < 0.04, "{s:?} {}", s.layout_min / bare);
        assert!((s.length_mm / FEED - s.layout_min).abs() < 1e-9 * s.layout_min);
    }
    // No candidate is below the least time of all.
    let search = Search { places: 9, tilt: Range::only(0.0) };
    let tools = [Feeding { cutter: &cutter, feed_mm_min: FEED }];
    let least = ideal(&[Patch { surface: &sphere, area_mm2 }], &tools, &TOLERANCE, search).unwrap();
    assert!(found.iter().all(|s| s.pointwise_min > 0.995 * least.time_min));
}

/// On a plane that slopes strips of a ball are as wide whatever the axis: planes and heights cost no overlap.
#[test]
fn a_tool_that_keeps_its_axis_lays_strips_side_by_side_on_a_slope() {
    let plane = Plane::new(Domain { u: Interval::new(0.0, 30.0), v: Interval::new(0.0, 20.0) });
    let cutter = ball(8.0);
    let tool = Tool { cutter: &cutter, holder: None, feed_mm_min: FEED };
    let section = Section { part_per_mm: 0.0, tool_per_mm: 0.25, scallop_mm: TOLERANCE.scallop_mm };
    let bare_min = 600.0 / (width_37(section).unwrap() * FEED);
    let way = |lines: ThreeAxisLines, axis: Vec3, feed: Vec3| Candidate {
        tool: 0,
        strategy: Strategy::ThreeAxis(ThreeAxis { lines, axis: Unit3::new_normalize(axis), feed }),
        axes: Axes::Held,
        lean: Lean::default(),
    };
    for slope in [0.1_f64, 0.6, 1.2] {
        let axis = Vec3::new(slope.sin(), 0.0, slope.cos());
        let ways = [
            way(ThreeAxisLines::Planes, axis, Vec3::y()),
            way(ThreeAxisLines::Planes, axis, Vec3::x()),
            way(ThreeAxisLines::Gradient, axis, Vec3::x()),
            way(ThreeAxisLines::Waterlines, axis, Vec3::x()),
        ];
        for s in screened(Patch { surface: &plane, area_mm2: 600.0 }, tool, &Around::default(), &ways) {
            assert!(s.out.is_none(), "{s:?}");
            for min in [s.pointwise_min, s.layout_min] {
                assert!((min / bare_min - 1.0).abs() < 5e-3, "{slope}: {s:?} {bare_min}");
            }
        }
    }
    // From below nothing is reached.
    let below = [way(ThreeAxisLines::Planes, -Vec3::z(), Vec3::x())];
    let found = screened(Patch { surface: &plane, area_mm2: 600.0 }, tool, &Around::default(), &below);
    assert_eq!(found[0].out, Some(Reason::Away { percent: 100.0 }));
}

/// Planned on one face by name, such a way is what its own function makes.
#[test]
fn the_ways_of_a_tool_that_keeps_its_axis_are_strategies() {
    let plane = Plane::new(Domain { u: Interval::new(0.0, 12.0), v: Interval::new(0.0, 8.0) });
    let cutter = toroidal(6.0);
    let (axis, feed) = (Unit3::new_normalize(Vec3::new(1.0, 0.0, 1.0)), Vec3::x());
    let faces = [Named { face: "top", surface: &plane }];
    let drop = DropTask {
        faces: &faces,
        check: &[],
        cutter: &cutter,
        axis,
        feed,
        tolerance: TOLERANCE,
        progress: &|_| {},
    };
    let own = [drop_cutter(&drop), gradient_3c(&drop), waterline_3c(&drop)];
    let all = [ThreeAxisLines::Planes, ThreeAxisLines::Gradient, ThreeAxisLines::Waterlines];
    for (lines, own) in all.into_iter().zip(own) {
        let strategy = Strategy::ThreeAxis(ThreeAxis { lines, axis, feed });
        let task = Task::new("top", &plane, &cutter, Lean::default(), TOLERANCE);
        let [by_name, own] = [run(&task, &strategy).unwrap(), own.unwrap()].map(|p| p.passes);
        assert_eq!(strategy.fixed_axis(), Some(axis));
        assert_eq!(strategy.name(), lines.name());
        assert!(!own.is_empty() && by_name == own, "{lines:?}");
    }
}

#[test]
fn what_is_too_large_is_told_what_fits() {
    // Hollow with 10 mm in the middle, 12.8 mm in the corners.
    let bowl = Paraboloid::new([0.05, 0.05], 3.0).unwrap();
    let patch = Patch { surface: &bowl, area_mm2: 36.0 };
    let cutter = ball(30.0);
    let tool = Tool { cutter: &cutter, holder: None, feed_mm_min: FEED };
    let found = screened(patch, tool, &Around::default(), &[along(Axis::U, 15.0)]);
    let Some(Reason::TooLarge { percent, largest_mm }) = found[0].out else { panic!("{found:?}") };
    assert!(percent > 95.0 && (20.0..20.2).contains(&largest_mm), "{found:?}");
    // A tool of the size that is named does fit.
    let cutter = ball(largest_mm - 0.2);
    let tool = Tool { cutter: &cutter, holder: None, feed_mm_min: FEED };
    assert!(screened(patch, tool, &Around::default(), &[along(Axis::U, 15.0)])[0].out.is_none());
    // Of toroidal cutters a larger lead fits where a smaller one does not.
    let cutter = toroidal(10.0);
    let tool = Tool { cutter: &cutter, holder: None, feed_mm_min: FEED };
    let found = screened(patch, tool, &Around::default(), &[along(Axis::U, 5.0), along(Axis::U, 35.0)]);
    assert!(matches!(found[0].out, Some(Reason::TooLarge { .. })) && found[1].out.is_none(), "{found:?}");
}

/// A wall beside a flat floor: a steep bowl stands for it.
#[test]
fn bodies_and_holders_that_meet_something_are_named() {
    let floor = Paraboloid::new([0.0, 0.0], 10.0).unwrap();
    // z = x^2 / 2, a trough whose sides rise 50 mm over the floor.
    let trough = Paraboloid::new([0.5, 0.0], 10.0).unwrap();
    let patch = Patch { surface: &floor, area_mm2: 400.0 };
    let cutter = ball(6.0);
    let tool = Tool { cutter: &cutter, holder: None, feed_mm_min: FEED };
    let around = Around::of([(&floor as &dyn Surface, "F1"), (&trough, "F2")].into_iter());
    let upright = along(Axis::V, 0.0);
    let found = screened(patch, tool, &around, &[upright]);
    let Some(Reason::Body { ref face, depth_mm, .. }) = found[0].out else { panic!("{found:?}") };
    assert!(face == "F2" && depth_mm > 0.1, "{found:?}");
    // Alone on the floor it may; its holder, where the cutter is short, meets the floor at a great lead only.
    let alone = Around::of(std::iter::once((&floor as &dyn Surface, "F1")));
    let (cutter, holder) = (toroidal(6.0), Holder::cylinder(80.0, 40.0).unwrap());
    let tool = Tool { cutter: &cutter, holder: Some(&holder), feed_mm_min: FEED };
    let found = screened(patch, tool, &alone, &[along(Axis::V, 5.0), along(Axis::V, 60.0)]);
    assert!(found[0].out.is_none(), "{found:?}");
    let Some(Reason::Holder { ref face, .. }) = found[1].out else { panic!("{found:?}") };
    assert_eq!(face, "F1");
    let text = found[1].out.as_ref().unwrap().to_string();
    assert!(text.contains("holder") && text.contains("F1"), "{text}");
}
