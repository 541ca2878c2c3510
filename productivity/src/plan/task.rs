//! What to plan, and what a plan is: contact points, passes, and why there are none.

use super::WallEdges;
use super::lead::Leaning;
use osculate_geom::{Axis, Diagnostic, Point3, Surface, Unit3, Uv};
use osculate_tools::strip::StripError;
use osculate_tools::{Contact, ContactError, Cutter, FeedLine, Lean, Pose};

/// What a plan must hold, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Highest material left between passes.
    pub scallop_mm: f64,
    /// Deepest undercut accepted.
    pub gouge_mm: f64,
    /// Largest deviation of the path's straight pieces from the true motion at the contact.
    pub chord_mm: f64,
}

/// Which way isoparametric passes run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Along {
    /// The direction with the shorter path.
    #[default]
    Auto,
    /// Along the given parameter.
    Fixed(Axis),
}

/// What to plan: [`Task::new`].
///
/// ```
/// use osculate_geom::{Axis, Domain, Interval, analytic::Plane};
/// use osculate_productivity::plan::{Along, PlanError, Task, Tolerance, isoparametric};
/// use osculate_tools::{Cutter, CutterSpec, Lean};
///
/// let plane = Plane::new(Domain { u: Interval::new(0.0, 20.0), v: Interval::new(0.0, 10.0) });
/// let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 10.0, length_mm: 50.0 })?;
/// let lean = Lean { lead_rad: 0.2, tilt_rad: 0.0 };
/// let tolerance = Tolerance { scallop_mm: 0.02, gouge_mm: 0.01, chord_mm: 0.005 };
/// let mut task = Task::new("top", &plane, &ball, lean, tolerance);
/// let passes = isoparametric(&task, Along::Fixed(Axis::U))?;
/// // The tool leans by as much as was asked, everywhere.
/// let [least, _, greatest] = passes.inclination_rad().expect("there are points");
/// assert!((least - 0.2).abs() < 1e-6 && (greatest - 0.2).abs() < 1e-6);
/// // A tolerance of nothing is refused by its name.
/// task.tolerance.scallop_mm = 0.0;
/// assert!(matches!(isoparametric(&task, Along::Auto), Err(PlanError::Tolerance { got: 0.0, .. })));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy)]
#[non_exhaustive]
pub struct Task<'a> {
    /// The face, with its trims and material side.
    pub surface: &'a dyn Surface,
    /// The face's name for messages.
    pub face: &'a str,
    /// The cutter.
    pub cutter: &'a Cutter,
    /// The tool's axis.
    pub lean: Leaning<'a>,
    /// What must hold.
    pub tolerance: Tolerance,
    /// Where the part stands up beside the face, for passes along walls.
    pub walls: Option<&'a WallEdges>,
    /// Told how far the work is, 0 to 1.
    pub progress: &'a (dyn Fn(f64) + Sync),
}

impl<'a> Task<'a> {
    /// Passes over a face, by the name that messages give it; nobody is told how far the work is.
    #[must_use]
    pub fn new(
        face: &'a str,
        surface: &'a dyn Surface,
        cutter: &'a Cutter,
        lean: impl Into<Leaning<'a>>,
        tolerance: Tolerance,
    ) -> Self {
        Self { surface, face, cutter, lean: lean.into(), tolerance, walls: None, progress: &|_| {} }
    }

    /// The same, told to somebody as it goes on, from 0 to 1.
    #[must_use]
    pub fn watched(self, progress: &'a (dyn Fn(f64) + Sync)) -> Self {
        Self { progress, ..self }
    }

    /// The same, with what stands up beside the face.
    #[must_use]
    pub fn beside(self, walls: &'a WallEdges) -> Self {
        Self { walls: Some(walls), ..self }
    }
}

/// One contact point of a pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CcPoint {
    /// Surface parameters of the contact.
    pub uv: Uv,
    /// The contact, mm.
    pub point: Point3,
    /// Outward normal there.
    pub normal: Unit3,
    /// The tool.
    pub pose: Pose,
    /// Exact strip width around the contact, mm; interpolated between the places where it was computed.
    pub width_mm: f64,
}

/// A pass: contact points in the order of cutting.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Pass {
    /// The points, at least two.
    pub points: Vec<CcPoint>,
    /// Whether the pass ends where it began.
    pub closed: bool,
}

impl Pass {
    /// Length along the contact points, mm.
    #[must_use]
    pub fn length_mm(&self) -> f64 {
        self.points.windows(2).map(|w| (w[1].point - w[0].point).norm()).sum()
    }

    /// Mean strip width over the points, mm.
    #[must_use]
    pub fn mean_width_mm(&self) -> f64 {
        let n = self.points.len().max(1) as f64;
        self.points.iter().map(|p| p.width_mm).sum::<f64>() / n
    }
}

/// The passes over one face.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Passes {
    /// In the order of cutting.
    pub passes: Vec<Pass>,
    /// Findings.
    pub diagnostics: Vec<Diagnostic>,
}

impl Passes {
    /// Least, mean (by length) and greatest angle between tool axis and normal, rad; None without points.
    #[must_use]
    pub fn inclination_rad(&self) -> Option<[f64; 3]> {
        let (mut least, mut most, mut sum, mut length) = (f64::INFINITY, 0.0f64, 0.0, 0.0);
        for w in self.passes.iter().flat_map(|p| p.points.windows(2)) {
            let [a, b] = [&w[0], &w[1]].map(|p| p.pose.axis.angle(&p.normal));
            let step = (w[1].point - w[0].point).norm();
            (least, most) = (least.min(a).min(b), most.max(a).max(b));
            sum += 0.5 * (a + b) * step;
            length += step;
        }
        (length > 0.0).then(|| [least, sum / length, most])
    }

    /// Least and greatest tilt of the axis against the chords between contact points, rad: from the feed to the left of it, about the normal;
    /// None without points.
    #[must_use]
    pub fn tilts_rad(&self) -> Option<[f64; 2]> {
        let between = self.passes.iter().flat_map(|p| p.points.windows(2)).map(|w| {
            let (normal, axis) = (&w[0].normal, &w[0].pose.axis);
            let along = w[1].point - w[0].point;
            axis.dot(&normal.cross(&along)).atan2(axis.dot(&(along - normal.scale(normal.dot(&along)))))
        });
        let all = between.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], t| [a.min(t), b.max(t)]);
        (all[0] <= all[1]).then_some(all)
    }

    /// Length along the contact points, mm.
    #[must_use]
    pub fn length_mm(&self) -> f64 {
        self.passes.iter().map(Pass::length_mm).sum()
    }
}

/// Why there is no plan.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// A tolerance that is not positive and finite.
    #[error("{what} must be positive and finite, got {got}")]
    Tolerance {
        /// Which key.
        what: &'static str,
        /// The value, mm.
        got: f64,
    },
    /// The tool cannot touch the face somewhere.
    #[error("face {face}: {source}")]
    Contact {
        /// The face.
        face: String,
        /// What is wrong.
        source: ContactError,
    },
    /// The strip could not be computed somewhere.
    #[error("face {face}: {source}")]
    Strip {
        /// The face.
        face: String,
        /// What is wrong.
        source: StripError,
    },
    /// A tilt to one side of a face whose passes run along no parameter of it.
    #[error("face {face}: a tilt to one side of the face is for isoparametric passes and regions")]
    Sided {
        /// The face.
        face: String,
    },
    /// The strategy needs another tool.
    #[error("strategy {strategy} needs a {need}")]
    Tool {
        /// The strategy's key.
        strategy: &'static str,
        /// The tool that it needs.
        need: &'static str,
    },
    /// The face has no inside, or none that the strategy reaches.
    #[error("face {face}: {why}")]
    Nothing {
        /// The face.
        face: String,
        /// Why there is nothing to cut.
        why: String,
    },
    /// More passes than any sensible job has.
    #[error(
        "face {face}: more than {limit} passes are needed at a scallop of {scallop_mm} mm; raise scallop_mm or use a larger tool"
    )]
    TooManyPasses {
        /// The face.
        face: String,
        /// The limit.
        limit: usize,
        /// The tolerance.
        scallop_mm: f64,
    },
}

/// Axes of a field lean off the normal by so much at most where strips are asked for, rad.
const MOST_LEAN_RAD: f64 = 1.55;

/// Passes on one face beyond which a plan is refused.
pub(super) const MAX_PASSES: usize = 20_000;

/// Refuses tolerances that are none.
pub(super) fn check_tolerance(t: &Tolerance) -> Result<(), PlanError> {
    for (what, got) in [("scallop_mm", t.scallop_mm), ("gouge_mm", t.gouge_mm), ("chord_mm", t.chord_mm)] {
        if !(got > 0.0 && got.is_finite()) {
            return Err(PlanError::Tolerance { what, got });
        }
    }
    Ok(())
}

impl Task<'_> {
    pub(super) fn check(&self) -> Result<(), PlanError> {
        check_tolerance(&self.tolerance)?;
        self.lean.checked().map_err(|e| self.contact(e))?;
        Ok(())
    }

    /// As [`Task::check`], for passes along level lines: these have no parameter by whose growth one side is told from the other.
    pub(super) fn check_level(&self) -> Result<(), PlanError> {
        match self.lean {
            Leaning::Sided(_) => Err(PlanError::Sided { face: self.face.to_owned() }),
            _ => self.check(),
        }
    }

    /// The contact at a place, with the tool's axis there on a line along `feed`, whose parameter moves the contact at `speed`.
    pub(super) fn contact_at(&self, at: Uv, feed: FeedLine, speed: f64) -> Result<Contact<'_>, ContactError> {
        let upright = Contact::new(self.surface, at, self.cutter, feed, Lean::default())?;
        let lean = self.lean.against(at, (&upright.frame, speed));
        // Between places that no axis reaches a field may lean over: passes there are cut off, or verification says so.
        upright.leaning(match self.lean {
            Leaning::Axes(_) => Lean { lead_rad: lean.lead_rad.min(MOST_LEAN_RAD), ..lean },
            _ => lean,
        })
    }

    pub(super) fn contact(&self, source: ContactError) -> PlanError {
        PlanError::Contact { face: self.face.to_owned(), source }
    }

    pub(super) fn strip(&self, source: StripError) -> PlanError {
        PlanError::Strip { face: self.face.to_owned(), source }
    }

    /// The height that strips are laid out for: below the tolerance by 2 % for what lies between the places where
    /// spacing is computed and, where the part is hollow along the feed, by what the chords of the path may leave.
    ///
    /// `left_mm` is what a rough face keeps on the line of the pass itself ([`seat`](super::seat)).
    pub(super) fn design_scallop_mm(&self, along_per_mm: f64, left_mm: f64) -> f64 {
        let t = &self.tolerance;
        let chord = if along_per_mm < 0.0 { t.chord_mm.min(0.4 * t.scallop_mm) } else { 0.0 };
        0.98 * (t.scallop_mm - chord - left_mm).max(0.1 * t.scallop_mm)
    }
}

/// The shorter of two that there may be.
pub(super) fn shorter<T>(
    u: Result<T, PlanError>,
    v: Result<T, PlanError>,
    length_mm: impl Fn(&T) -> f64,
) -> Result<T, PlanError> {
    match (u, v) {
        (Ok(u), Ok(v)) => Ok(if length_mm(&v) < length_mm(&u) { v } else { u }),
        (Ok(one), Err(_)) | (Err(_), Ok(one)) => Ok(one),
        (Err(e), Err(_)) => Err(e),
    }
}

/// A face and its name.
#[derive(Clone, Copy)]
pub struct Named<'a> {
    /// The face's name for messages.
    pub face: &'a str,
    /// The face, with its trims and material side.
    pub surface: &'a dyn Surface,
}
