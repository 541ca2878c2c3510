//! How a path is to be posted.

use crate::auxiliary::{Auxiliary, AuxiliaryWord};
use crate::feed::FeedMode;
use crate::nc::{Coolant, Dialect, Orientation, WorkOffset};
use crate::post_error::PostError;
use crate::solve_options::SolveOptions;

/// How a path is to be posted.
#[derive(Clone, Debug, PartialEq)]
pub struct PostOptions {
    /// The language.
    pub dialect: Dialect,
    /// How F is written; [`FeedMode::Tcp`] turns tool-centre-point control on.
    pub feed: FeedMode,
    /// How the program says where the tool points; other than by joints only with [`FeedMode::Tcp`].
    pub orientation: Orientation,
    /// The moves stand in a subprogram that the main program calls (Sinumerik).
    pub subprogram: bool,
    /// Tolerances and what else the kinematics need. Its `tcp` is not read: the feed mode says it.
    pub solve: SolveOptions,
    /// How far the control may round corners, mm.
    pub blend_mm: f64,
    /// LinuxCNC may join straight moves of X Y Z alone into one, as far as they leave the way by `blend_mm` at most, on top of what it
    /// rounds corners by; moves in which a rotary joint turns it never joins. Other controls are told nothing of it.
    pub joins: bool,
    /// Name of the program.
    pub program_name: String,
    /// Number of the program, where the dialect has one (Fanuc).
    pub program_number: u32,
    /// Number of the tool, and of its length offset.
    pub tool_number: u32,
    /// Of several tools the next one is put ready while one is at work.
    pub preselect: bool,
    /// Work offset; absent: `G54`, or with Heidenhain the preset that is active.
    pub work_offset: Option<WorkOffset>,
    /// Two opposite corners of the box around the raw material, part's frame, mm: for the picture of the control, where the dialect has a
    /// word for it (Heidenhain).
    pub blank_mm: Option<[[f64; 3]; 2]>,
    /// Coolant.
    pub coolant: Option<Coolant>,
    /// Spindle speed; absent: the path's own.
    pub spindle_rpm: Option<f64>,
    /// The spindle turns counter-clockwise.
    pub counter_clockwise: bool,
    /// What is done between the moves, in the order of the moves.
    pub auxiliary: Vec<Auxiliary>,
}

impl PostOptions {
    /// Default tolerances, tool 1, the path's own speed.
    ///
    /// ```
    /// use osculate_postproc::{Dialect, FeedMode, PostOptions};
    ///
    /// let options = PostOptions {
    ///     tool_number: 12,
    ///     spindle_rpm: Some(9000.0),
    ///     ..PostOptions::new(Dialect::Heidenhain, FeedMode::Tcp)
    /// };
    /// // Tip within 2 um of its line, axis within 0.02 deg; no word about the work offset: the active preset.
    /// assert_eq!(options.solve.tip_tol_mm, 0.002);
    /// assert!((options.solve.axis_tol_rad.to_degrees() - 0.02).abs() < 1e-12);
    /// assert_eq!(options.work_offset, None);
    /// ```
    #[must_use]
    pub fn new(dialect: Dialect, feed: FeedMode) -> Self {
        Self {
            dialect,
            feed,
            orientation: Orientation::Joints,
            subprogram: false,
            solve: SolveOptions::default(),
            blend_mm: SolveOptions::default().tip_tol_mm,
            joins: true,
            program_name: "OSCULATE".into(),
            program_number: 1,
            tool_number: 1,
            preselect: false,
            work_offset: None,
            blank_mm: None,
            coolant: None,
            spindle_rpm: None,
            counter_clockwise: false,
            auxiliary: Vec::new(),
        }
    }
}

/// # Errors
/// Where an option makes no sense.
pub(crate) fn check(options: &PostOptions) -> Result<(), PostError> {
    if options.orientation != Orientation::Joints && options.feed != FeedMode::Tcp {
        return Err(PostError::Orientation);
    }
    let radius = match options.feed {
        FeedMode::Kv { fgref_mm } | FeedMode::Kz { fgref_mm, .. } => fgref_mm,
        _ => None,
    };
    let step = match options.feed {
        FeedMode::Kz { step_mm_min, .. } => Some(step_mm_min),
        _ => None,
    };
    let tip = match options.feed {
        FeedMode::Fastest { tip_mm_min } => tip_mm_min,
        _ => None,
    };
    for (what, value) in [("fgref_mm", radius), ("step_mm_min", step), ("tip_mm_min", tip)] {
        if let Some(value) = value.filter(|v| !(v.is_finite() && *v > 0.0)) {
            return Err(PostError::Feed { what, value });
        }
    }
    let words = options.auxiliary.iter().filter_map(|a| match a.word {
        AuxiliaryWord::Spindle(spindle) => spindle.rpm(),
        _ => None,
    });
    let takes = |rpm: &f64| *rpm > 0.0 && *rpm <= LARGEST_SPEED_RPM;
    match options.spindle_rpm.into_iter().chain(words).find(|rpm| !takes(rpm)) {
        Some(rpm) => Err(PostError::Spindle { rpm }),
        None => Ok(()),
    }
}

/// Six digits before the point, which is what S words hold; spindles reach half of it.
pub(crate) const LARGEST_SPEED_RPM: f64 = 999_999.0;
