//! Plans with a tool that keeps its axis, and what they leave.

use osculate_geom::{Surface, Vec3};
use osculate_productivity::plan::{DropTask, Named, Passes, PlanError, Tolerance};
use osculate_tools::Cutter;
use osculate_tools::removal::{Job, Sample, Swept, cut, sample_surface};

pub const TOLERANCE: Tolerance = Tolerance { scallop_mm: 0.01, gouge_mm: 0.005, chord_mm: 0.002 };

/// Least and greatest height left on the faces by the passes alone.
pub fn left(faces: &[&dyn Surface], cutter: &Cutter, passes: &Passes) -> [f64; 2] {
    // Twice as dense as what the planner measures at.
    let samples: Vec<Sample> =
        faces.iter().flat_map(|f| sample_surface(*f, 0, 0.1, 100_000).unwrap().samples).collect();
    let motions: Vec<Swept> = passes
        .passes
        .iter()
        .flat_map(|p| p.points.windows(2))
        .map(|w| Swept { from: w[0].pose, to: w[1].pose, rapid: false, block: 0 })
        .collect();
    let job = Job {
        cutter,
        holder: None,
        changes: &[],
        motions: &motions,
        samples: &samples,
        stock_mm: 0.1,
        depth_mm: 0.1,
    };
    let cuts = cut(&job, &|_| ()).unwrap();
    cuts.iter().fold([0.0, 0.0], |[lo, hi]: [f64; 2], c| [lo.min(c.standoff_mm), hi.max(c.standoff_mm)])
}

/// A plan with the axis along z.
pub fn dropped(
    strategy: impl Fn(&DropTask<'_>) -> Result<Passes, PlanError>,
    faces: &[&dyn Surface],
    check: &[&dyn Surface],
    cutter: &Cutter,
) -> Result<Passes, PlanError> {
    let named = |all: &[&'static str], s: &[&dyn Surface]| -> Vec<(usize, &'static str)> {
        (0..s.len()).map(|k| (k, all[k])).collect()
    };
    let faces: Vec<Named<'_>> =
        named(&["F1", "F2"], faces).into_iter().map(|(k, face)| Named { face, surface: faces[k] }).collect();
    let check: Vec<Named<'_>> =
        named(&["C1", "C2"], check).into_iter().map(|(k, face)| Named { face, surface: check[k] }).collect();
    strategy(&DropTask {
        faces: &faces,
        check: &check,
        cutter,
        axis: Vec3::z_axis(),
        feed: Vec3::x(),
        tolerance: TOLERANCE,
        progress: &|_| {},
    })
}

/// Nothing above the scallop is left, nothing below the gouge cut.
pub fn holds(faces: &[&dyn Surface], cutter: &Cutter, passes: &Passes) {
    let [cut, rest] = left(faces, cutter, passes);
    assert!(rest <= TOLERANCE.scallop_mm, "left {rest}");
    assert!(cut >= -TOLERANCE.gouge_mm, "cut {cut}");
}
