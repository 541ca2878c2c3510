//! The whole way from a CL path to NC text.

use std::io;

use osculate_geom::Diagnostic;
use osculate_tools::cl::{ClPath, Motion};

use crate::feed::{
    FeedMode, PathMetric, Step, capped_duration, duration_min, fastest_durations_min, inverse_time_per_min,
};
use crate::joint_path::JointBlock;
use crate::machine::{JointValues, Machine};
use crate::motion::rapid_time_min;
use crate::nc::block::RotaryName;
use crate::nc::writer::Writer;
use crate::nc::{Dialect, FeedWord, NcMove, Program, WriteError, number};
use crate::setup::Setup;
use crate::solve::SolveOptions;
use crate::solve_error::SolveError;

/// How a path is to be posted.
#[derive(Clone, Debug, PartialEq)]
pub struct PostOptions {
    /// The language.
    pub dialect: Dialect,
    /// How F is written; [`FeedMode::Tcp`] turns tool-centre-point control on.
    pub feed: FeedMode,
    /// Tolerances and what else the kinematics need. Its `tcp` is not read: the feed mode says it.
    pub solve: SolveOptions,
    /// Name of the program.
    pub program_name: String,
    /// Number of the tool.
    pub tool_number: u32,
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
            solve: SolveOptions::default(),
            program_name: "OSCULATE".into(),
            tool_number: 1,
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
    /// The sink takes no more.
    #[error("the program cannot be written: {kind}")]
    Sink {
        /// What the sink says.
        kind: io::ErrorKind,
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
    check(path, options)?;
    let tcp = options.feed == FeedMode::Tcp;
    let spindle_rpm = options.spindle_rpm.or(path.spindle_rpm);
    let program = Program {
        name: options.program_name.clone(),
        comments: comments(machine, setup, tcp),
        tcp,
        linuxcnc_tcp: machine.control().linuxcnc_tcp.clone(),
        tool_number: options.tool_number,
        spindle_rpm,
        feed_word: feed_word(options, machine),
        blend_mm: options.solve.tip_tol_mm,
        linear_names: if tcp {
            ["X", "Y", "Z"].map(String::from)
        } else {
            machine.linear().map(|p| machine.joints()[p].letter.clone())
        },
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
        let joints = machine.solve(path, setup, &solve)?;
        let times = fastest_durations_min(machine, &joints, tip_mm_min);
        for (block, time_min) in joints.blocks.iter().zip(times) {
            word(&mut draft, &mut writer, block, Some(time_min))?;
        }
        joints
    } else {
        machine.solve_pieces(path, setup, &solve, |piece| {
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

fn check(path: &ClPath, options: &PostOptions) -> Result<(), PostError> {
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
    match options.spindle_rpm.or(path.spindle_rpm).filter(|r| !(r.is_finite() && *r > 0.0)) {
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

fn rotary_name(machine: &Machine, place: usize) -> RotaryName {
    let joint = &machine.joints()[place];
    RotaryName { letter: joint.letter.clone(), endless: joint.is_endless() }
}

fn comments(machine: &Machine, setup: &Setup, tcp: bool) -> Vec<String> {
    let t = setup.part_zero.translation.vector;
    let place = format!("X{:.4} Y{:.4} Z{:.4}", t.x + 0.0, t.y + 0.0, t.z + 0.0);
    let mut lines = vec![format!("machine {}", machine.name())];
    if tcp {
        lines.push("tool-centre-point control: X Y Z are the tip relative to the part".into());
        lines.push(format!("program zero: the part's origin, {place} from the table's reference point"));
    } else {
        lines.push("no tool-centre-point control: X Y Z are joints".into());
        lines.push(format!("program zero: the table's reference point, part origin posted for {place}"));
        if !machine.rotary().is_empty() {
            lines.push(format!("posted for a gauge length of {:.4} mm", setup.gauge_length_mm));
        }
    }
    lines
}

/// Moves being made from joints, with what is counted on the way.
struct Draft<'a> {
    machine: &'a Machine,
    setup: &'a Setup,
    options: &'a PostOptions,
    /// Blocks that a joint's speed made longer, per joint.
    slowed: Vec<usize>,
    /// Blocks whose F would not have fitted the control's format.
    limited: usize,
    time_min: f64,
    /// Least and greatest feed of the tip, as a share of what was asked for.
    shares: [f64; 2],
    /// The last move with the joints at its end.
    last: Option<(NcMove, JointValues)>,
    /// Tip lengths and times of blocks that rounded to nothing: they go into the next one.
    carried_mm: f64,
    carried_min: f64,
    /// The last F of a mode that bounds its rise.
    risen: Option<f64>,
}

impl<'a> Draft<'a> {
    fn new(machine: &'a Machine, setup: &'a Setup, options: &'a PostOptions) -> Self {
        Self {
            machine,
            setup,
            options,
            slowed: vec![0; machine.joints().len()],
            limited: 0,
            time_min: 0.0,
            shares: [f64::INFINITY, 0.0],
            last: None,
            carried_mm: 0.0,
            carried_min: 0.0,
            risen: None,
        }
    }

    /// The move of the next block; `None` where it rounds to nothing. `fastest_min` is its time in the fastest program.
    fn next(&mut self, block: &JointBlock, fastest_min: Option<f64>) -> Result<Option<NcMove>, PostError> {
        let mut m = self.rounded(block)?;
        let Some((before, from)) = self.last else {
            self.last = Some((m, block.joints));
            return Ok(Some(m));
        };
        if m.linear == before.linear && m.rotary == before.rotary {
            self.carried_mm += if m.rapid { 0.0 } else { block.tip_length_mm };
            self.carried_min += fastest_min.unwrap_or(0.0);
            return Ok(None);
        }
        match block.motion {
            Motion::Rapid => {
                self.time_min += rapid_time_min(self.machine, &from, &block.joints).0;
                self.risen = None;
            }
            Motion::Feed(wanted) => {
                let length = block.tip_length_mm + self.carried_mm;
                let asked_min = match fastest_min {
                    Some(t) => t + self.carried_min,
                    None => duration_min(length, wanted),
                };
                let capped = capped_duration(self.machine, &from, &block.joints, asked_min);
                if let Some(place) = capped.joint {
                    self.slowed[place] += 1;
                }
                let step = step(&before, &m);
                m.feed = self.feed(&step, wanted, (capped.duration_min, capped.joint.is_some()));
                let read_min = self.control_time(&step, m.feed);
                if length > 0.0 && read_min > 0.0 {
                    let share = capped.duration_min / read_min;
                    self.shares = [self.shares[0].min(share), self.shares[1].max(share)];
                }
                self.time_min +=
                    read_min.max(capped_duration(self.machine, &from, &block.joints, 0.0).duration_min);
            }
        }
        (self.carried_mm, self.carried_min) = (0.0, 0.0);
        self.last = Some((m, block.joints));
        Ok(Some(m))
    }

    fn rounded(&self, block: &JointBlock) -> Result<NcMove, PostError> {
        let index = block.source;
        let counts = |value: f64| number::counts(value).ok_or(PostError::Position { index, value });
        let xyz = if self.options.feed == FeedMode::Tcp {
            let p = self.setup.to_program(&block.tip);
            [p.x, p.y, p.z]
        } else {
            self.machine.linear().map(|place| block.joints[place])
        };
        let mut linear = [0; 3];
        for (to, value) in linear.iter_mut().zip(xyz) {
            *to = counts(value)?;
        }
        let mut rotary = [0; 2];
        for (to, place) in rotary.iter_mut().zip(self.machine.rotary()) {
            *to = counts(block.joints[*place].to_degrees())?;
        }
        Ok(NcMove { rapid: block.motion == Motion::Rapid, linear, rotary, feed: 0.0 })
    }

    /// F of a block that shall take this long.
    fn feed(&mut self, step: &Step, wanted: f64, duration: (f64, bool)) -> f64 {
        let (duration_min, slowed) = duration;
        let f = match self.options.feed {
            FeedMode::InverseTime => inverse_time_per_min(duration_min),
            FeedMode::None => wanted,
            // The tip's feed is F itself, whatever rounding does to the length.
            FeedMode::Tcp if !slowed && step.linear_mm > 0.0 => wanted,
            mode => {
                // The fastest program is written over whatever the control reads.
                let own = PathMetric::from(self.machine.control().feed_reading);
                let f = mode.metric().unwrap_or(own).length(step) / duration_min;
                match mode {
                    FeedMode::Kz { step_mm_min, .. } => {
                        let f = self.risen.map_or(f, |b| f.min(b + step_mm_min));
                        self.risen = Some(f);
                        f
                    }
                    _ => f,
                }
            }
        };
        let largest = self.machine.control().largest_feed;
        if f > largest {
            self.limited += 1;
            return largest;
        }
        f
    }

    /// How long the control takes, by its own reading of F, min.
    fn control_time(&self, step: &Step, feed: f64) -> f64 {
        match self.options.feed {
            FeedMode::InverseTime => 1.0 / feed,
            mode => {
                // A program that declares its metric (Sinumerik) is read over it; elsewhere the machine's own holds.
                let declared = mode.metric().filter(|_| {
                    self.options.dialect == Dialect::Sinumerik || self.options.feed == FeedMode::Tcp
                });
                let metric = declared.unwrap_or_else(|| self.machine.control().feed_reading.into());
                metric.length(step) / feed
            }
        }
    }

    fn report(&self, diagnostics: &mut Vec<Diagnostic>, program: &Program) {
        for (count, joint) in self.slowed.iter().zip(self.machine.joints()) {
            if *count > 0 {
                let text = format!(
                    "{count} blocks are slower than asked: joint {} is at its greatest speed",
                    joint.letter
                );
                diagnostics.push(Diagnostic::warning("feed", text));
            }
        }
        if self.limited > 0 {
            let largest = self.machine.control().largest_feed;
            let text = format!(
                "{} blocks are slower than asked: F is cut to the control's largest, {largest}",
                self.limited
            );
            diagnostics.push(Diagnostic::warning("feed", text));
        }
        let own = PathMetric::from(self.machine.control().feed_reading);
        let wanted =
            self.options.feed.metric().filter(|_| !program.tcp && self.options.dialect != Dialect::Sinumerik);
        if let Some(wanted) = wanted.filter(|w| *w != own && !self.machine.rotary().is_empty()) {
            let text = format!(
                "F is written over {}, but this control reads it over {}: mixed moves take another time than asked, \
                 the tip runs at {:.3} to {:.3} times the feed asked for",
                metric_name(wanted),
                metric_name(own),
                self.shares[0],
                self.shares[1]
            );
            diagnostics.push(Diagnostic::warning("feed", text));
        }
        if self.options.feed == FeedMode::None && !self.machine.rotary().is_empty() {
            let text = format!(
                "F is not corrected: where rotary axes move, the tip runs at {:.3} to {:.3} times the feed asked for",
                self.shares[0], self.shares[1]
            );
            diagnostics.push(Diagnostic::warning("feed", text));
        }
    }
}

fn metric_name(metric: PathMetric) -> String {
    match metric {
        PathMetric::Linear => "the linear axes".into(),
        PathMetric::Arc { radius_mm } => format!("all axes, rotary ones at a radius of {radius_mm:.3} mm"),
        PathMetric::RotaryOnly => "the rotary axes".into(),
    }
}

/// By how much the words of a move differ from those before.
fn step(from: &NcMove, to: &NcMove) -> Step {
    let mm = |k: usize| number::value(to.linear[k] - from.linear[k]);
    let rad = |k: usize| number::value(to.rotary[k] - from.rotary[k]).to_radians();
    Step { linear_mm: (mm(0) * mm(0) + mm(1) * mm(1) + mm(2) * mm(2)).sqrt(), rotary_rad: [rad(0), rad(1)] }
}
