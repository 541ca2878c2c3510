//! The whole way from a CL path to NC text.

use std::io;

use osculate_geom::{Box3, Diagnostic, Point3};
use osculate_tools::cl::ClPath;

use crate::auxiliary::AuxiliaryWord;
use crate::draft::{Draft, linear_decimals};
use crate::feed::{FeedMode, fastest_durations_min};
use crate::joint_path::JointBlock;
use crate::machine::Machine;
use crate::motion::TooLong;
use crate::nc::block::RotaryName;
use crate::nc::number;
use crate::nc::writer::Writer;
use crate::nc::{FeedWord, Orientation, Program};
use crate::post_error::PostError;
use crate::post_options::{PostOptions, check};
use crate::setup::Setup;
use crate::setup_comment;
use crate::solve_options::SolveOptions;
use crate::source::MoveSource;

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
    /// CL points over which blocks go on ([`SolveOptions::join`]).
    pub joined_points: usize,
    /// Greatest distance of the tip from the CL line in feed moves, without the rounding of the output, mm: what of it counts
    /// (`SolveOptions::touch_rad`).
    pub tip_error_mm: f64,
    /// Greatest angle of the tool axis from the CL's in feed moves, deg.
    pub axis_error_deg: f64,
}

/// NC text with its summary.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Posted {
    /// The program.
    pub text: String,
    /// Figures.
    pub summary: PostSummary,
    /// Findings.
    pub diagnostics: Vec<Diagnostic>,
}

/// What became of a path whose text went into a sink.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PostReport {
    /// Figures.
    pub summary: PostSummary,
    /// Findings.
    pub diagnostics: Vec<Diagnostic>,
}

/// Posts a path: kinematics, feed, words.
///
/// ```
/// use osculate_postproc::{Dialect, FeedMode, Machine, PostOptions, Setup, cldata, post};
///
/// // A machine of three axes needs no kinematics: the joints are the tip's coordinates.
/// let path = cldata::read("SPINDL/5000,CLW\nRAPID\nGOTO/0,0,5\nFEDRAT/600\nGOTO/60,0,5\nFINI\n")?.path;
/// let machine = Machine::built_in("3-axis")?;
/// let options = PostOptions::new(Dialect::LinuxCnc, FeedMode::InverseTime);
/// let posted = post(&path, &machine, &Setup::default(), &options)?;
/// // 60 mm at 600 mm/min take a tenth of a minute, which G93 writes as 10 per minute.
/// assert!(posted.text.lines().any(|line| line.contains("X60") && line.contains("F10")));
/// assert!(posted.text.contains("S5000"));
/// assert!(posted.diagnostics.is_empty() && posted.summary.tip_error_mm == 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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
/// ```
/// use osculate_postproc::{Dialect, FeedMode, Machine, PostOptions, Setup, cldata, post, post_to};
///
/// let path = cldata::read("RAPID\nGOTO/0,0,5\nFEDRAT/600\nGOTO/60,0,5\nFINI\n")?.path;
/// let (machine, setup) = (Machine::built_in("3-axis")?, Setup::default());
/// let options = PostOptions::new(Dialect::Fanuc, FeedMode::InverseTime);
/// // Whatever can be written to takes the text: a file, a socket, or here a vector of bytes.
/// let mut bytes = Vec::new();
/// let report = post_to(&path, &machine, &setup, &options, &mut bytes)?;
/// let whole = post(&path, &machine, &setup, &options)?;
/// assert_eq!(bytes, whole.text.as_bytes());
/// assert_eq!(report.summary, whole.summary);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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
    let program = program_of(machine, setup, options, comments(machine, setup, options));
    let mut writer = Writer::new(options.dialect, &program)?;
    let report = moves_from(source, machine, setup, (options, &program), &mut writer, sink)?;
    writer.finish();
    flush(&mut writer, sink)?;
    Ok(report)
}

/// What stands around the moves of a program.
pub(crate) fn program_of(
    machine: &Machine,
    setup: &Setup,
    options: &PostOptions,
    comments: Vec<String>,
) -> Program {
    let tcp = options.feed == FeedMode::Tcp;
    let planes = options.orientation == Orientation::Planes;
    Program {
        orientation: options.orientation,
        name: options.program_name.clone(),
        comments,
        tcp: tcp && !planes,
        subprogram: options.subprogram,
        linuxcnc_tcp: machine.control().linuxcnc_tcp.clone(),
        number: options.program_number,
        tool_number: options.tool_number,
        next_tool: None,
        work_offset: options.work_offset,
        blank: options.blank_mm.and_then(|corners| blank(&corners, setup, tcp)),
        spindle_rpm: options.spindle_rpm,
        counter_clockwise: options.counter_clockwise,
        coolant: options.coolant,
        cools: options.coolant.is_some()
            || options.auxiliary.iter().any(|a| matches!(a.word, AuxiliaryWord::Coolant(Some(_)))),
        feed_word: feed_word(options, machine),
        blend_mm: options.blend_mm,
        joins: options.joins,
        retract: machine.retract_mm().and_then(number::counts),
        linear_names: if tcp {
            ["X", "Y", "Z"].map(String::from)
        } else {
            machine.linear().map(|p| machine.joints()[p].letter.clone())
        },
        linear_decimals: linear_decimals(machine, tcp),
        rotary_names: machine.rotary().iter().map(|p| rotary_name(machine, *p)).collect(),
    }
}

/// Words the moves of a source, after what stands before them.
pub(crate) fn moves_from<S: MoveSource>(
    source: &S,
    machine: &Machine,
    setup: &Setup,
    (options, program): (&PostOptions, &Program),
    writer: &mut Writer<'_>,
    sink: &mut dyn io::Write,
) -> Result<PostReport, PostError>
where
    PostError: From<S::Error>,
{
    let mut draft = Draft::new(machine, setup, options);
    // What is said between two points is said at the end of a block.
    let join = options.solve.join && options.auxiliary.iter().all(|a| a.before == 0);
    let solve = SolveOptions { tcp: options.feed == FeedMode::Tcp, join, ..options.solve };
    let mut blocks = 0;
    let mut auxiliary = options.auxiliary.iter().peekable();
    let mut word = |draft: &mut Draft, writer: &mut Writer, block: &JointBlock, fastest: Option<f64>| {
        let Some(m) = draft.next(block, fastest)? else { return Ok(()) };
        blocks += 1;
        while let Some(one) = auxiliary.next_if(|a| a.before <= block.source) {
            writer.say(one.word);
        }
        writer.take(&m);
        if writer.text().len() >= SINK_BYTES { flush(writer, sink) } else { Ok::<(), PostError>(()) }
    };
    let joints = if let FeedMode::Fastest { tip_mm_min } = options.feed {
        let joints = machine.solve_from::<S, PostError>(source, setup, &solve)?;
        let times = fastest_durations_min(machine, &joints, tip_mm_min);
        for (block, time_min) in joints.blocks.iter().zip(times) {
            word(&mut draft, writer, block, Some(time_min))?;
        }
        joints
    } else {
        machine.solve_pieces::<S, PostError>(source, setup, &solve, |piece| {
            piece.iter().try_for_each(|block| word(&mut draft, writer, block, None))
        })?
    };
    auxiliary.for_each(|one| writer.say(one.word));
    let mut diagnostics = joints.diagnostics;
    if options.spindle_rpm.is_none() {
        diagnostics.push(Diagnostic::warning(
            "program",
            "no spindle speed is known: the program does not start the spindle",
        ));
    }
    draft.report(&mut diagnostics, program);
    let s = joints.summary;
    let summary = PostSummary {
        blocks,
        time_min: TooLong::refused(draft.time_min)?,
        rewinds: s.rewinds,
        singular_mm: s.singular_mm,
        inserted_points: s.inserted_points,
        joined_points: s.joined_points,
        tip_error_mm: s.tip_error_mm,
        axis_error_deg: s.axis_error_rad.to_degrees(),
    };
    Ok(PostReport { summary, diagnostics })
}

/// Text is given to the sink when there is this much of it.
const SINK_BYTES: usize = 1 << 16;

pub(crate) fn flush(writer: &mut Writer, sink: &mut dyn io::Write) -> Result<(), PostError> {
    sink.write_all(writer.text().as_bytes()).map_err(|e| PostError::Sink { kind: e.kind() })?;
    writer.clear();
    Ok(())
}

fn feed_word(options: &PostOptions, machine: &Machine) -> FeedWord {
    match options.feed {
        FeedMode::InverseTime => FeedWord::Inverse,
        FeedMode::Fastest { .. } => FeedWord::PerMinute(Some(options.dialect.feed_metric(machine))),
        mode => FeedWord::PerMinute(mode.metric(options.dialect.feed_metric(machine))),
    }
}

/// The box around a box of the part's frame in the coordinates of a program.
fn blank(corners: &[[f64; 3]; 2], setup: &Setup, tcp: bool) -> Option<[[i64; 3]; 2]> {
    let mut around = Box3::empty();
    for k in 0..8 {
        let p = Point3::from([0, 1, 2].map(|axis| corners[k >> axis & 1][axis]));
        let seen = if tcp { Point3::from(setup.to_program(&p)) } else { setup.part_zero * p };
        around.add(&seen);
    }
    let counts = |p: &Point3| -> Option<[i64; 3]> {
        Some([number::counts(p.x)?, number::counts(p.y)?, number::counts(p.z)?])
    };
    Some([counts(&around.min)?, counts(&around.max)?])
}

fn rotary_name(machine: &Machine, place: usize) -> RotaryName {
    let joint = &machine.joints()[place];
    RotaryName { letter: joint.letter.clone(), endless: joint.is_endless(), decimals: joint.decimals }
}

pub(crate) fn comments(machine: &Machine, setup: &Setup, options: &PostOptions) -> Vec<String> {
    let (tcp, planes) = (options.feed == FeedMode::Tcp, options.orientation == Orientation::Planes);
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
    let endless = machine.rotary().iter().map(|p| &machine.joints()[*p]).filter(|j| j.is_endless());
    lines.extend(
        endless.map(|joint| format!("{} turns without end: {}", joint.letter, options.dialect.turning())),
    );
    let turned = setup.turn_rad().map(|a| a.to_degrees() + 0.0);
    if turned.iter().any(|a| a.abs() >= 5e-5) {
        let [x, y, z] = turned;
        lines.push(format!(
            "part turned on the table: {x:.4} deg about X, then {y:.4} about Y, then {z:.4} about Z"
        ));
    }
    lines.extend(setup_comment::lines(setup));
    lines
}
