//! What is asked of passes of a tool that keeps its axis.

use crate::plan::{Named, Tolerance};
use osculate_geom::{Unit3, Vec3};
use osculate_tools::Cutter;

/// What to plan with a fixed tool axis.
///
/// ```
/// use osculate_geom::{Domain, Interval, Vec3, analytic::Plane};
/// use osculate_productivity::plan::{DropTask, Named, Tolerance, drop_cutter};
/// use osculate_tools::{Cutter, CutterSpec};
///
/// // A flat end dropped onto a level face of 30 x 20 mm stands on it.
/// let plane = Plane::new(Domain { u: Interval::new(0.0, 30.0), v: Interval::new(0.0, 20.0) });
/// let end = Cutter::try_from(CutterSpec::Flat { diameter_mm: 8.0, length_mm: 40.0 })?;
/// let passes = drop_cutter(&DropTask {
///     faces: &[Named { face: "top", surface: &plane }],
///     check: &[],
///     cutter: &end,
///     axis: Vec3::z_axis(),
///     feed: Vec3::x(),
///     tolerance: Tolerance { scallop_mm: 0.02, gouge_mm: 0.01, chord_mm: 0.005 },
///     progress: &|_| {},
/// })?;
/// let mut poses = passes.passes.iter().flat_map(|pass| &pass.points).map(|p| p.pose);
/// assert!(poses.all(|pose| pose.tip.z.abs() < 1e-6 && pose.axis == Vec3::z_axis()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy)]
pub struct DropTask<'a> {
    /// Faces to machine.
    pub faces: &'a [Named<'a>],
    /// Faces that the tool must not cut.
    pub check: &'a [Named<'a>],
    /// The cutter.
    pub cutter: &'a Cutter,
    /// The tool axis, from the tip to the holder.
    pub axis: Unit3,
    /// The way of the passes, brought into the plane across the axis.
    pub feed: Vec3,
    /// What must hold.
    pub tolerance: Tolerance,
    /// Told how far the work is, 0 to 1.
    pub progress: &'a (dyn Fn(f64) + Sync),
}
