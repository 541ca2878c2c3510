//! Passes in regions: on a cone along its rulings, where the far end needs several times the passes of the near one.

use crate::cutting;

use cutting::{motions, verdict};
use osculate_geom::analytic::Cone;
use osculate_geom::{Axis, Domain, Interval, Patch, Side, Surface, Uv, forward_surface};
use osculate_productivity::plan::{Along, Pass, Passes, Strategy, Task, Tolerance, run};
use osculate_tools::{Cutter, CutterSpec, Lean};

const TOLERANCE: Tolerance = Tolerance { scallop_mm: 0.02, gouge_mm: 0.005, chord_mm: 0.004 };

/// A third of a cone about z whose radius grows from 4 to 40 mm; its rulings run along v.
fn cone() -> Patch<Cone> {
    let half_angle = 0.5_f64;
    let v = Interval::new(0.0, 36.0 / half_angle.sin());
    let surface = Cone::new(4.0, half_angle, v).unwrap();
    Patch { surface, domain: Domain { u: Interval::new(0.3, 2.4), v }, side: Side::Along }
}

fn plan(lean: Lean, strategy: &Strategy) -> Passes {
    let (surface, cutter) = (&cone(), &cutter());
    run(&Task::new("F1", surface, cutter, lean, TOLERANCE), strategy).unwrap()
}

fn cutter() -> Cutter {
    let spec = CutterSpec::Toroidal { diameter_mm: 8.0, corner_radius_mm: 1.0, length_mm: 60.0 };
    Cutter::try_from(spec).unwrap()
}

/// Along the rulings of a cone there are as many strips as the circle is strips around: with the radius r of the circle and
/// the effective radius e of the tool strips are sqrt(8 h / (cos a / r + 1 / e)) wide, so that the near end needs a third of the
/// passes of the far one.
#[test]
fn regions_of_a_cone_are_shorter_and_leave_nothing() {
    let lean = Lean { lead_rad: 0.1, tilt_rad: 0.0 };
    let along = Along::Fixed(Axis::V);
    let whole = plan(lean, &Strategy::Isoparametric { along });
    let parts = plan(lean, &Strategy::Regions { along });
    assert!(parts.length_mm() < 0.8 * whole.length_mm(), "{} of {}", parts.length_mm(), whole.length_mm());
    let moves = motions(&cone(), &parts.passes, &cutter());
    let v = verdict(&cone(), &moves, &cutter(), TOLERANCE, 0.25);
    assert!(v.scallop_max_mm <= TOLERANCE.scallop_mm && v.gouge_max_mm <= TOLERANCE.gouge_mm);
    assert_eq!(v.uncut_samples, 0);
    // The passes of the region at the near end, in closed form: its far border is its tightest place.
    let near: Vec<&Pass> = parts.passes.iter().filter(|p| p.points.iter().any(|c| c.uv.v < 1.0)).collect();
    let border = near.iter().flat_map(|p| &p.points).map(|c| c.uv.v).fold(0.0, f64::max);
    let radius = 4.0 + border * 0.5_f64.sin();
    let effective = 3.0 / lean.lead_rad.sin() + 1.0;
    let width = (8.0 * TOLERANCE.scallop_mm / (0.5_f64.cos() / radius + 1.0 / effective)).sqrt();
    let want = 2.1 * radius / width;
    // Passes go over the border, and strips that are wide against the radius are not quite as the closed form has them.
    let got = near.len() as f64;
    assert!(got > 0.85 * want && got < 1.2 * want + 1.0, "{got} against {want}");
}

/// Along the circles all columns need the same: there is one region, and the passes are those without.
#[test]
fn where_all_columns_are_alike_there_is_one_region() {
    let lean = Lean { lead_rad: 0.1, tilt_rad: 0.0 };
    let along = Along::Fixed(Axis::U);
    assert_eq!(
        plan(lean, &Strategy::Regions { along }).passes,
        plan(lean, &Strategy::Isoparametric { along }).passes
    );
}

/// The cone of which only the middle is inside.
struct Middle(Patch<Cone>);

impl Middle {
    const RANGE: Interval = Interval::new(20.0, 50.0);
}

impl Surface for Middle {
    forward_surface!(domain | s | s.0);
    forward_surface!(shape | s | s.0);
    fn contains(&self, at: Uv) -> bool {
        Self::RANGE.contains(at.v) && self.0.contains(at)
    }
}

/// What of the parameters lies beside the inside needs no passes, and is no region by itself.
#[test]
fn regions_of_a_face_that_is_less_than_its_parameters() {
    let (face, cutter) = (Middle(cone()), cutter());
    let lean = Lean { lead_rad: 0.1, tilt_rad: 0.0 };
    let task = Task::new("F1", &face, &cutter, lean, TOLERANCE);
    let [whole, parts] = [
        Strategy::Isoparametric { along: Along::Fixed(Axis::V) },
        Strategy::Regions { along: Along::Fixed(Axis::V) },
    ]
    .map(|strategy| run(&task, &strategy).unwrap());
    assert!(parts.length_mm() <= whole.length_mm(), "{} of {}", parts.length_mm(), whole.length_mm());
    let v = verdict(&face, &motions(&face, &parts.passes, &cutter), &cutter, TOLERANCE, 0.25);
    assert!(v.scallop_max_mm <= TOLERANCE.scallop_mm && v.gouge_max_mm <= TOLERANCE.gouge_mm);
    assert_eq!(v.uncut_samples, 0);
}
