//! Cutter location paths: what crosses the border between planning, posting and verification.

use crate::pose::Pose;
use crate::spec::{CutterSpec, HolderSpec};

/// How the tool gets to a pose from the one before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// As fast as the machine goes; not meant to touch material.
    Rapid,
    /// At a feed of the tool tip relative to the part, mm/min.
    Feed(f64),
}

/// One CL point with the motion that leads to it. Between two points tip and axis move linearly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClMove {
    /// Where the tool ends.
    pub pose: Pose,
    /// How it gets there.
    pub motion: Motion,
    /// Whether the tool is off everything on the way there, by more than it may stray as it turns: [`Motion::Rapid`] says so by itself. CL
    /// data does not.
    pub aloft: bool,
}

/// A whole tool path in the part's frame.
///
/// ```
/// use osculate_geom::{Point3, Vec3};
/// use osculate_tools::cl::{ClMove, ClPath, Motion};
/// use osculate_tools::{CutterSpec, Pose};
/// // Down to the part and one pass along x at 1200 mm/min: 40 mm, two seconds.
/// let at = |x: f64, z: f64| Pose { tip: Point3::new(x, 0.0, z), axis: Vec3::z_axis() };
/// let path = ClPath {
///     cutter: Some(CutterSpec::Ball { diameter_mm: 10.0, length_mm: 60.0 }),
///     spindle_rpm: Some(8000.0),
///     moves: vec![
///         ClMove { pose: at(0.0, 50.0), motion: Motion::Rapid, aloft: false },
///         ClMove { pose: at(0.0, 0.0), motion: Motion::Feed(300.0), aloft: false },
///         ClMove { pose: at(40.0, 0.0), motion: Motion::Feed(1200.0), aloft: false },
///     ],
///     ..Default::default()
/// };
/// let pass_mm = (path.moves[2].pose.tip - path.moves[1].pose.tip).norm();
/// assert_eq!(path.moves[2].motion, Motion::Feed(pass_mm / (2.0 / 60.0)));
/// ```
#[derive(Clone, Debug, PartialEq, Default)]
pub struct ClPath {
    /// The cutter, where known.
    pub cutter: Option<CutterSpec>,
    /// The sections of the holder from the nose upwards, where known.
    pub holder: Vec<HolderSpec>,
    /// Spindle speed, where known.
    pub spindle_rpm: Option<f64>,
    /// The moves. The first one's motion leads from an unknown place and must be [`Motion::Rapid`].
    pub moves: Vec<ClMove>,
}
