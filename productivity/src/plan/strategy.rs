//! The strategies by name, and the one call that plans by any of them.

use super::{
    Along, DropTask, Named, Passes, PlanError, Task, ThreeAxis, along_walls, contour_2cl, curvature_5c,
    isoparametric, isoplanar, isoscallop, regions, streamline,
};
use osculate_geom::Unit3;

/// How passes are placed on a face.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Strategy {
    /// Along lines of constant parameter (5C).
    Isoparametric {
        /// Which parameter varies along the passes.
        along: Along,
    },
    /// Along lines of constant parameter, in regions with passes as far apart as each allows (5C).
    Regions {
        /// Which parameter varies along the passes.
        along: Along,
    },
    /// A ball at constant height along an axis that it keeps (2CL, M86).
    Contour2cl {
        /// The tool axis.
        axis: Unit3,
    },
    /// In parallel planes (5C).
    Isoplanar {
        /// Normal of the planes.
        normal: Unit3,
    },
    /// With the same scallop all along (5C).
    Isoscallop,
    /// Along the directions of the widest strip, evenly spaced (5C).
    Streamline,
    /// Along lines of curvature with a toroidal or flat cutter (5C, M86).
    Curvature5c,
    /// Along the walls beside the face, from one to the other (5C): [`Task::walls`].
    AlongWalls,
    /// Any cutter dropped along an axis that it keeps (3C); [`run`] sees no face but its own.
    ThreeAxis(ThreeAxis),
}

impl Strategy {
    /// The key of job files.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Isoparametric { .. } => "isoparametric",
            Self::Regions { .. } => "regions",
            Self::Contour2cl { .. } => "contour_2cl",
            Self::Isoplanar { .. } => "isoplanar",
            Self::Isoscallop => "isoscallop",
            Self::Streamline => "streamline",
            Self::Curvature5c => "curvature_5c",
            Self::AlongWalls => "along_walls",
            Self::ThreeAxis(way) => way.lines.name(),
        }
    }

    /// The direction that the tool axis keeps; None where it leans along the passes as [`Task::lean`] says.
    #[must_use]
    pub const fn fixed_axis(&self) -> Option<Unit3> {
        match self {
            Self::Contour2cl { axis } | Self::ThreeAxis(ThreeAxis { axis, .. }) => Some(*axis),
            Self::Isoparametric { .. }
            | Self::Regions { .. }
            | Self::Isoplanar { .. }
            | Self::Isoscallop
            | Self::Streamline
            | Self::Curvature5c
            | Self::AlongWalls => None,
        }
    }
}

/// Plans passes over a face by a strategy.
///
/// ```
/// use osculate_geom::{Domain, Interval, Vec3, analytic::Plane};
/// use osculate_productivity::plan::{Strategy, Task, Tolerance, run};
/// use osculate_tools::{Cutter, CutterSpec, Lean};
///
/// let plane = Plane::new(Domain { u: Interval::new(0.0, 12.0), v: Interval::new(0.0, 12.0) });
/// let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 10.0, length_mm: 50.0 })?;
/// let lean = Lean { lead_rad: 0.2, tilt_rad: 0.0 };
/// let tolerance = Tolerance { scallop_mm: 0.05, gouge_mm: 0.01, chord_mm: 0.005 };
/// let task = Task::new("top", &plane, &ball, lean, tolerance);
/// // Planes across x: every pass keeps its x.
/// let strategy = Strategy::Isoplanar { normal: Vec3::x_axis() };
/// for pass in run(&task, &strategy)?.passes {
///     assert!(pass.points.iter().all(|p| (p.point.x - pass.points[0].point.x).abs() < 1e-6));
/// }
/// assert_eq!(strategy.name(), "isoplanar");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`PlanError`], as the strategy's own function has it.
pub fn run(task: &Task<'_>, strategy: &Strategy) -> Result<Passes, PlanError> {
    match *strategy {
        Strategy::Isoparametric { along } => isoparametric(task, along),
        Strategy::Regions { along } => regions(task, along),
        Strategy::Contour2cl { axis } => contour_2cl(task, axis),
        Strategy::Isoplanar { normal } => isoplanar(task, normal),
        Strategy::Isoscallop => isoscallop(task),
        Strategy::Streamline => streamline(task),
        Strategy::Curvature5c => curvature_5c(task),
        Strategy::AlongWalls => along_walls(task),
        Strategy::ThreeAxis(ThreeAxis { lines, axis, feed }) => lines.passes(&DropTask {
            faces: &[Named { face: task.face, surface: task.surface }],
            check: &[],
            cutter: task.cutter,
            axis,
            feed,
            tolerance: task.tolerance,
            progress: task.progress,
        }),
    }
}
