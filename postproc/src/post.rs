//! The whole way from a CL path to NC text.

use std::io;

use osculate_geom::Diagnostic;
use osculate_tools::cl::ClPath;

use crate::cldata::ClStreamError;
use crate::draft::Draft;
use crate::feed::{FeedMode, fastest_durations_min};
use crate::joint_path::JointBlock;
use crate::machine::Machine;
use crate::nc::block::RotaryName;
use crate::nc::writer::Writer;
use crate::nc::{Coolant, Dialect, FeedWord, Orientation, Program, WorkOffset, WriteError};
use crate::setup::Setup;
use crate::setup_comment;
use crate::solve::SolveOptions;
use crate::solve_error::SolveError;
use crate::source::MoveSource;

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
    /// Name of the program.
    pub program_name: String,
    /// Number of the program, where the dialect has one (Fanuc).
    pub program_number: u32,
    /// Number of the tool, and of its length offset.
    pub tool_number: u32,
    /// Work offset; absent: `G54`, or with Heidenhain the preset that is active.
    pub work_offset: Option<WorkOffset>,
    /// Coolant.
    pub coolant: Option<Coolant>,
    /// Spindle speed; absent: the path's own.
    pub spindle_rpm: Option<f64>,
}

impl PostOptions {
    /// Default tolerances, tool 1, the path's own speed.
    #[must_use]
    pub fn new(dialect: Dialect, feed: FeedMode) -> Self {
        Self {
            dialect,
            feed,
            orientation: Orientation::Joints,
            subprogram: false,
            solve: SolveOptions::default(),
            blend_mm: SolveOptions::default().tip_tol_mm,
            program_name: "OSCULATE".into(),
            program_number: 1,
            tool_number: 1,
            work_offset: None,
            coolant: None,
            spindle_rpm: None,
        }
    }
}

/// What became of a path.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct PostSummary {
    /// Blocks that move the machine.
    pub blocks: usize,
    /// Time as the control reads F, with joint speeds as caps and rapid moves at the joints' rates, min.
    pub time_min: f64,
    /// Rewinds of the rotary joints.
    pub rewinds: usize,
    /// Length of the way on which a rotary joint was held near a pole, mm.
    pub singular_mm: f64,
    /// Points put in to keep the tool on its line.
    pub inserted_points: usize,
    /// Greatest distance of the tip from the CL line in feed moves, without the rounding of the output, mm.
    pub tip_error_mm: f64,
    /// Greatest angle of the tool axis from the CL's in feed moves, deg.
    pub axis_error_deg: f64,
}

/// NC text with its summary.
#[derive(Clone, Debug, PartialEq)]
pub struct Posted {
    /// The program.
    pub text: String,
    /// Figures.
    pub summary: PostSummary,
    /// Findings.
    pub diagnostics: Vec<Diagnostic>,
}

/// Why a path cannot be posted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PostError {
    /// The machine cannot run the path.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// The dialect cannot say the program.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The moves cannot be had.
    #[error(transparent)]
    Source(#[from] ClStreamError),
    /// The sink takes no more.
    #[error("the program cannot be written: {kind}")]
    Sink {
        /// What the sink says.
        kind: io::ErrorKind,
    },
    /// An orientation that the feed mode does not allow.
    #[error("the tool's orientation as vectors or planes needs feed mode tcp: there X Y Z are the tip")]
    Orientation,
    /// A rewind, which directions cannot say.
    #[error(
        "CL move {index}: the rotary joints must be rewound here, and directions of the tool do not say to which turn: \
         write joints instead of vectors"
    )]
    Rewind {
        /// The CL move.
        index: usize,
    },
    /// The tool turns at feed.
    #[error(
        "CL move {index}: the tool axis turns at feed, which tilted planes cannot say: write joints or vectors"
    )]
    Turns {
        /// The CL move.
        index: usize,
    },
    /// A position beyond what an axis word holds.
    #[error("CL move {index}: a position of {value} does not fit an axis word")]
    Position {
        /// The CL move.
        index: usize,
        /// The position, mm or deg.
        value: f64,
    },
    /// A feed option that makes no sense.
    #[error("feed option {what} is {value}: it must be finite and above zero")]
    Feed {
        /// The option.
        what: &'static str,
        /// What was given.
        value: f64,
    },
    /// A spindle speed that makes no sense.
    #[error("a spindle speed of {rpm} rpm: it must be finite and above zero")]
    Spindle {
        /// What was given.
        rpm: f64,
    },
}

impl From<std::convert::Infallible> for PostError {
    fn from(never: std::convert::Infallible) -> Self {
        match never {}
    }
}

impl PostError {
    /// The CL move that it speaks of, from 0.
    #[must_use]
    pub const fn index(&self) -> Option<usize> {
        match self {
            Self::Solve(e) => e.index(),
            Self::Position { index, .. } | Self::Rewind { index } | Self::Turns { index } => Some(*index),
            _ => None,
        }
    }
}

/// What became of a path whose text went into a sink.
#[derive(Clone, Debug, PartialEq)]
pub struct PostReport {
    /// Figures.
    pub summary: PostSummary,
    /// Findings.
    pub diagnostics: Vec<Diagnostic>,
}

/// Posts a path: kinematics, feed, words.
///
/// # Errors
/// Where the machine cannot run the path or the dialect cannot say it.
pub fn post(
    path: &ClPath,
    machine: &Machine,
    setup: &Setup,
    options: &PostOptions,
) -> Result<Posted, PostError> {
    let mut text = Vec::new();
    let report = post_to(path, machine, setup, options, &mut text)?;
    let text = String::from_utf8(text).expect("the pieces are text");
    Ok(Posted { text, summary: report.summary, diagnostics: report.diagnostics })
}

/// As [`post()`], with the text going to `sink` in pieces of some ten kilobytes. Beside the path, what is held does not
/// grow with its length, except in [`FeedMode::Fastest`], whose feed at the start depends on the end: 120 bytes a block.
///
/// # Errors
/// As [`post()`], and where the sink takes no more. What the sink has then is a part of a program and must not be run.
pub fn post_to(
    path: &ClPath,
    machine: &Machine,
    setup: &Setup,
    options: &PostOptions,
    sink: &mut dyn io::Write,
) -> Result<PostReport, PostError> {
    let spindle_rpm = options.spindle_rpm.or(path.spindle_rpm);
    post_from(path, machine, setup, &PostOptions { spindle_rpm, ..options.clone() }, sink)
}

/// As [`post_to`], from any source of moves, which is gone over twice; the speed of the spindle is that of the options.
///
/// # Errors
/// As [`post_to`], and where the source fails.
pub fn post_from<S: MoveSource>(
    source: &S,
    machine: &Machine,
    setup: &Setup,
    options: &PostOptions,
    sink: &mut dyn io::Write,
) -> Result<PostReport, PostError>
where
    PostError: From<S::Error>,
{
    check(options)?;
    let tcp = options.feed == FeedMode::Tcp;
    let spindle_rpm = options.spindle_rpm;
    let planes = options.orientation == Orientation::Planes;
    let program = Program {
        orientation: options.orientation,
        name: options.program_name.clone(),
        comments: comments(machine, setup, (tcp, planes)),
        tcp: tcp && !planes,
        subprogram: options.subprogram,
        linuxcnc_tcp: machine.control().linuxcnc_tcp.clone(),
        number: options.program_number,
        tool_number: options.tool_number,
        work_offset: options.work_offset,
        spindle_rpm,
        coolant: options.coolant,
        feed_word: feed_word(options, machine),
        blend_mm: options.blend_mm,
        linear_names: if tcp {
            ["X", "Y", "Z"].map(String::from)
        } else {
            machine.linear().map(|p| machine.joints()[p].letter.clone())
        },
        linear_decimals: linear_decimals(machine, tcp),
        rotary_names: machine.rotary().iter().map(|p| rotary_name(machine, *p)).collect(),
    };
    let mut writer = Writer::new(options.dialect, &program)?;
    let mut draft = Draft::new(machine, setup, options);
    let solve = SolveOptions { tcp, ..options.solve };
    let mut blocks = 0;
    let mut word = |draft: &mut Draft, writer: &mut Writer, block: &JointBlock, fastest: Option<f64>| {
        let Some(m) = draft.next(block, fastest)? else { return Ok(()) };
        blocks += 1;
        writer.take(&m);
        if writer.text().len() >= SINK_BYTES { flush(writer, sink) } else { Ok::<(), PostError>(()) }
    };
    let joints = if let FeedMode::Fastest { tip_mm_min } = options.feed {
        let joints = machine.solve_from::<S, PostError>(source, setup, &solve)?;
        let times = fastest_durations_min(machine, &joints, tip_mm_min);
        for (block, time_min) in joints.blocks.iter().zip(times) {
            word(&mut draft, &mut writer, block, Some(time_min))?;
        }
        joints
    } else {
        machine.solve_pieces::<S, PostError>(source, setup, &solve, |piece| {
            piece.iter().try_for_each(|block| word(&mut draft, &mut writer, block, None))
        })?
    };
    writer.finish();
    flush(&mut writer, sink)?;
    let mut diagnostics = joints.diagnostics;
    if spindle_rpm.is_none() {
        diagnostics.push(Diagnostic::warning(
            "program",
            "no spindle speed is known: the program does not start the spindle",
        ));
    }
    draft.report(&mut diagnostics, &program);
    let s = joints.summary;
    let summary = PostSummary {
        blocks,
        time_min: draft.time_min,
        rewinds: s.rewinds,
        singular_mm: s.singular_mm,
        inserted_points: s.inserted_points,
        tip_error_mm: s.tip_error_mm,
        axis_error_deg: s.axis_error_rad.to_degrees(),
    };
    Ok(PostReport { summary, diagnostics })
}

/// Text is given to the sink when there is this much of it.
const SINK_BYTES: usize = 1 << 16;

fn flush(writer: &mut Writer, sink: &mut dyn io::Write) -> Result<(), PostError> {
    sink.write_all(writer.text().as_bytes()).map_err(|e| PostError::Sink { kind: e.kind() })?;
    writer.clear();
    Ok(())
}

fn check(options: &PostOptions) -> Result<(), PostError> {
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
    match options.spindle_rpm.filter(|r| !(r.is_finite() && *r > 0.0)) {
        Some(rpm) => Err(PostError::Spindle { rpm }),
        None => Ok(()),
    }
}

fn feed_word(options: &PostOptions, machine: &Machine) -> FeedWord {
    match options.feed {
        FeedMode::InverseTime => FeedWord::Inverse,
        FeedMode::Fastest { .. } => FeedWord::PerMinute(Some(machine.control().feed_reading.into())),
        mode => FeedWord::PerMinute(mode.metric()),
    }
}

/// Decimals of the linear words: of the joints, or of those called X, Y, Z where the words are the tip's.
pub(crate) fn linear_decimals(machine: &Machine, of_tip: bool) -> [usize; 3] {
    let joints = machine.joints();
    let own = machine.linear().map(|p| joints[p].decimals);
    if !of_tip {
        return own;
    }
    let finest = own.into_iter().fold(1, usize::max);
    ["X", "Y", "Z"].map(|name| machine.joint_named(name).map_or(finest, |p| joints[p].decimals))
}

fn rotary_name(machine: &Machine, place: usize) -> RotaryName {
    let joint = &machine.joints()[place];
    RotaryName { letter: joint.letter.clone(), endless: joint.is_endless(), decimals: joint.decimals }
}

fn comments(machine: &Machine, setup: &Setup, (tcp, planes): (bool, bool)) -> Vec<String> {
    let t = setup.part_zero.translation.vector;
    let place = format!("X{:.4} Y{:.4} Z{:.4}", t.x + 0.0, t.y + 0.0, t.z + 0.0);
    let mut lines = vec![format!("machine {}", machine.name())];
    if tcp {
        lines.push(if planes {
            "tilted planes: X Y Z are the tip in the plane".into()
        } else {
            "tool-centre-point control: X Y Z are the tip relative to the part".into()
        });
        lines.push(format!("program zero: the part's origin, {place} from the table's reference point"));
    } else {
        lines.push("no tool-centre-point control: X Y Z are joints".into());
        lines.push(format!("program zero: the table's reference point, part origin posted for {place}"));
        if !machine.rotary().is_empty() {
            lines.push(format!("posted for a gauge length of {:.4} mm", setup.gauge_length_mm));
        }
    }
    lines.extend(setup_comment::lines(setup));
    lines
}
