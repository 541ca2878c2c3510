//! A tilt whose side does not change with the sense of travel: its axis to and fro, and passes that lean with it.

use crate::cutting;

use cutting::{motions, verdict};
use osculate_geom::analytic::{Paraboloid, Torus};
use osculate_geom::line::{IsoLine, SurfaceLine};
use osculate_geom::{Axis, Jet2, Surface, Unit3, Vec3};
use osculate_productivity::plan::{
    Along, Leaning, PlanError, SideTilt, Strategy, Task, Tolerance, isoparametric, run,
};
use osculate_tools::{Cutter, CutterSpec, Lean, Pose};
use proptest::prelude::*;

const TOLERANCE: Tolerance = Tolerance { scallop_mm: 0.03, gouge_mm: 0.015, chord_mm: 0.003 };

fn toroidal() -> Cutter {
    let spec = CutterSpec::Toroidal { diameter_mm: 8.0, corner_radius_mm: 2.0, length_mm: 40.0 };
    Cutter::try_from(spec).unwrap()
}

fn sided(lead_deg: f64, side_deg: f64) -> Leaning<'static> {
    Leaning::Sided(SideTilt { lead_rad: lead_deg.to_radians(), side_rad: side_deg.to_radians() })
}

/// How far an axis leans along the growing parameter and to the left of it, as tangents.
fn leans(jet: &Jet2, along: Axis, axis: &Unit3) -> [f64; 2] {
    let n = jet.normal().unwrap();
    let d = if along == Axis::U { jet.du } else { jet.dv }.normalize();
    [d, n.cross(&d)].map(|e: Vec3| axis.dot(&e) / axis.dot(&n))
}

proptest! {
    /// On lines to and fro through one place the sideways part of the axis is the same, and the lead changes its end; without a lead the
    /// tool stands the same. The surface's directions are not at right angles, and one of the surfaces is hollow.
    #[test]
    fn the_side_is_that_of_the_growing_parameter(
        part in 0u32..2, along in any::<bool>(), at in (0.05..0.95f64, 0.05..0.95f64),
        lead in prop_oneof![Just(0.0), -40.0..40.0f64], side in prop_oneof![-60.0..-1.0f64, 1.0..60.0f64],
    ) {
        let (dome, ring) = (Paraboloid::new([-0.02, 0.01], 10.0).unwrap(), Torus::new(60.0, 15.0).unwrap());
        let surface: &dyn Surface = if part == 0 { &dome } else { &ring };
        let along = if along { Axis::U } else { Axis::V };
        let (place, cutter, lean) = (surface.domain().at(at.0, at.1), toroidal(), sided(lead, side));
        let [to, fro] = [false, true].map(|reversed| -> Pose {
            let line = IsoLine { surface, along, fixed: place.get(along.other()), reversed };
            let (frame, speed) = line.frame(place.get(along)).unwrap();
            lean.against(place, (&frame, speed)).pose(&cutter, &frame, 0.0)
        });
        let [ahead, left] = [lead, side].map(|deg| deg.to_radians().tan());
        let jet = surface.jet2(place);
        for (pose, sense) in [(to, 1.0), (fro, -1.0)] {
            let [along, across] = leans(&jet, along, &pose.axis);
            prop_assert!((across - left).abs() < 1e-12 * (1.0 + left.abs()), "{across} for {left}");
            prop_assert!((along - sense * ahead).abs() < 1e-12 * (1.0 + ahead.abs()), "{along} for {ahead}");
        }
        if lead == 0.0 {
            prop_assert!((to.axis.into_inner() - fro.axis.into_inner()).norm() < 1e-12);
            // The coordinates are some tens of mm.
            prop_assert!((to.tip - fro.tip).norm() < 1e-11, "{:?} {:?}", to.tip, fro.tip);
        }
    }
}

/// Passes to and fro hold the tolerance and lean to one side by the angle that was asked for: but for the second-order difference
/// between a normal and its average along the pass. A tilt that is held turns from side to side.
#[test]
fn passes_lean_to_one_side() {
    let (dome, cutter) = (Paraboloid::new([0.02, 0.01], 8.0).unwrap(), toroidal());
    let task = |lean: Leaning<'static>| -> Vec<Vec<[f64; 2]>> {
        let task = Task::new("F1", &dome, &cutter, lean, TOLERANCE);
        let mut found = Vec::new();
        for along in [Axis::U, Axis::V] {
            let passes = isoparametric(&task, Along::Fixed(along)).unwrap().passes;
            assert!(passes.len() > 3);
            let v = verdict(&dome, &motions(&dome, &passes, &cutter), &cutter, TOLERANCE, 0.2);
            assert!(v.within, "scallop {} gouge {}", v.scallop_max_mm, v.gouge_max_mm);
            for pass in &passes {
                let ends = [pass.points[0].uv, pass.points[pass.points.len() - 1].uv].map(|uv| uv.get(along));
                let sense = (ends[1] - ends[0]).signum();
                // Beyond the border a pass knows the place of the border next to it.
                let on = pass.points.iter().filter(|p| (p.point - dome.point(p.uv)).norm() < 1e-9);
                found.push(on.map(|p| leans(&dome.jet2(p.uv), along, &p.pose.axis)).collect::<Vec<_>>());
                for lean in found.last_mut().unwrap() {
                    lean[0] *= sense;
                }
            }
        }
        found
    };
    for (lead, side) in [(0.0, 20.0), (0.0, -20.0), (8.0, 15.0)] {
        let [ahead, left] = [lead, side].map(|deg: f64| deg.to_radians().tan());
        for lean in task(sided(lead, side)).into_iter().flatten() {
            assert!((lean[1] - left).abs() < 1e-3 && (lean[0] - ahead).abs() < 1e-3, "{lean:?}");
        }
    }
    let held = task(Lean { lead_rad: 20f64.to_radians(), tilt_rad: 90f64.to_radians() }.into());
    let sides = held.iter().flatten().filter(|lean| lean[1] > 0.0).count();
    assert!(sides > 0 && sides < held.iter().flatten().count());
}

#[test]
fn lines_without_a_parameter_and_angles_that_are_none_are_refused() {
    let (dome, cutter) = (Paraboloid::new([0.02, 0.01], 8.0).unwrap(), toroidal());
    let plan = |lean: Leaning<'static>, strategy: Strategy| {
        let task = Task::new("F1", &dome, &cutter, lean, TOLERANCE);
        run(&task, &strategy)
    };
    let normal = Vec3::x_axis();
    for strategy in
        [Strategy::Isoplanar { normal }, Strategy::Isoscallop, Strategy::Streamline, Strategy::Curvature5c]
    {
        assert!(matches!(plan(sided(0.0, 20.0), strategy), Err(PlanError::Sided { .. })), "{strategy:?}");
    }
    for (lead, side) in [(0.0, 90.0), (100.0, 20.0), (f64::NAN, 20.0), (0.0, f64::INFINITY)] {
        let refused = plan(sided(lead, side), Strategy::Regions { along: Along::Fixed(Axis::U) });
        assert!(matches!(refused, Err(PlanError::Contact { .. })), "{lead} {side}");
    }
}
