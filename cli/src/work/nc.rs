//! Between jobs and the postprocessor: machine, dialect, setup, text out and motions back.

use crate::failure::Failure;
use crate::job::control::machine_file;
use crate::job::language::Language;
use crate::job::{Control, Job};
use crate::work::budget;
use crate::work::verify::Reading;
use osculate_geom::Diagnostic;
use osculate_postproc::cldata::{self, ClWriteOptions};
use osculate_postproc::conduct::{Conduct, Expected, ExpectedTool, Grade};
use osculate_postproc::machine::JointValues;
use osculate_postproc::motion::JointDemand;
use osculate_postproc::nc::Dialect;
use osculate_postproc::nc::WorkOffset;
use osculate_postproc::nc::readback::{self, ControlTime, ReadBack, ReadBlock, ReadError, ReadOptions};
use osculate_postproc::{FeedMode, Machine, PostOptions, Setup, built_in_names};
use osculate_tools::CutterSpec;
use osculate_tools::cl::{ClPath, Motion};
use osculate_tools::removal::{GoalControl, Gravity, Program, Remark, Swept};
use std::collections::BTreeSet;
use std::path::Path;

/// The machine of a command line: a built-in name or a file.
///
/// ```
/// use osculate::work::nc;
///
/// assert_eq!(nc::machine("trunnion-ac")?.rotary().len(), 2);
/// // Neither a built-in one nor a file.
/// assert!(nc::machine("no-such-machine").is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn machine(word: &str) -> Result<Machine, Failure> {
    let file = Path::new(word);
    if !built_in_names().contains(&word) && (word.ends_with(".toml") || file.exists()) {
        return machine_file(file).map(|m| m.0);
    }
    Machine::built_in(word)
        .map_err(|_| Failure::unknown("machine", "built-in machine", word, &built_in_names()))
}

/// The language of a program: as said, by a name or a dialect file, or by its extension.
pub fn dialect_of(said: Option<&str>, file: &Path) -> Result<Language, Failure> {
    if let Some(word) = said {
        return Language::of_word(word);
    }
    let extension = file.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    let engine = Dialect::ALL.into_iter().find(|d| d.extension() == extension);
    engine.map(Language::from).ok_or_else(|| {
        let all = Language::names().join(", ");
        Failure::file(file, format!("the extension does not tell the dialect: give --dialect, one of {all}"))
    })
}

/// CL data as text.
pub fn cl_text(path: &ClPath, tool_number: u32, part_name: &str) -> Result<String, String> {
    let options = ClWriteOptions { part_name: part_name.to_owned(), tool_number };
    cldata::write(path, &options).map_err(|e| e.to_string())
}

/// A cutter in a few words, for the comments of a program.
#[must_use]
pub fn cutter_words(cutter: Option<CutterSpec>) -> String {
    match cutter {
        None => "tool".to_owned(),
        Some(CutterSpec::Ball { diameter_mm, .. }) => format!("ball {diameter_mm}"),
        Some(CutterSpec::Flat { diameter_mm, .. } | CutterSpec::Cylindrical { diameter_mm, .. }) => {
            format!("flat {diameter_mm}")
        }
        Some(CutterSpec::Toroidal { diameter_mm, corner_radius_mm, .. }) => {
            format!("toroidal {diameter_mm} r {corner_radius_mm}")
        }
        Some(CutterSpec::Apt { diameter_mm, bottom_angle_deg, .. }) if bottom_angle_deg > 0.0 => {
            format!("pointed {diameter_mm}, {bottom_angle_deg} deg")
        }
        Some(CutterSpec::Apt { diameter_mm, .. } | CutterSpec::Cone { diameter_mm, .. }) => {
            format!("conical {diameter_mm}")
        }
        Some(CutterSpec::Barrel { diameter_mm, .. }) => format!("barrel {diameter_mm}"),
    }
}

/// The options of a post for this control.
pub fn post_options(control: &Control, name: &str) -> PostOptions {
    PostOptions { program_name: name.to_owned(), ..PostOptions::new(control.dialect, control.feed) }
}

/// The options of a post of a job's path, as close to it as its tolerance wants where the tool touches the part at no more than
/// `touch_rad` from its axis.
pub fn job_options(job: &Job, control: &Control, name: &str, touch_rad: f64) -> PostOptions {
    let usual = post_options(control, name);
    PostOptions {
        blend_mm: budget::asked_mm(job),
        solve: budget::solve(job, touch_rad),
        tool_number: job.tool().number(),
        coolant: job.coolant(),
        work_offset: work_offset(job),
        program_number: job.program_number().unwrap_or(usual.program_number),
        ..usual
    }
}

/// What an NC program does, in the part's frame.
#[derive(Default)]
#[non_exhaustive]
pub struct Motions {
    /// Straight pieces with the line of the program that makes them.
    pub motions: Vec<Swept>,
    /// Time at the end of each piece, min.
    pub times_min: Vec<f64>,
    /// The time that its control takes, with accelerations and corners; none where no machine is known.
    pub on_control: Option<OnControl>,
    /// Where the joints stand at the end of each piece, as [`ReadMove::at_nose`](readback::ReadMove::at_nose); empty where no machine is known.
    pub at_nose: Vec<Option<JointValues>>,
    /// Total time, min.
    pub time_min: f64,
    /// Time of feed moves, min.
    pub cutting_time_min: f64,
    /// What its feed moves ask of the joints, against the feed of the job; none where no machine is known.
    pub joints: Option<JointDemand>,
    /// The spindle's speed, where the program says one.
    pub spindle_rpm: Option<f64>,
    /// The tools in the order in which they move: the first motion of each, its number, and its speed where the program says one.
    pub calls: Vec<Call>,
    /// Numbers of the tools that its feed moves are made with.
    pub tools: BTreeSet<u32>,
    /// The state of the control while it runs.
    pub control: GoalControl,
    /// Findings.
    pub diagnostics: Vec<Diagnostic>,
}

/// The time that a control takes over a program.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct OnControl {
    /// At the end of each piece, min; dwells are in none of them.
    pub times_min: Vec<f64>,
    /// All of it, min.
    pub time_min: f64,
    /// Feed moves, min.
    pub cutting_min: f64,
}

/// A tool that takes over in a program.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Call {
    /// Its first motion.
    pub first: usize,
    /// Its number, where the program says one.
    pub number: Option<u32>,
    /// Its speed.
    pub spindle_rpm: Option<f64>,
}

impl Motions {
    /// The time by which programs are ranked, min: that of their control where it is known.
    #[must_use]
    pub fn ranked_min(&self) -> f64 {
        self.on_control.as_ref().map_or(self.time_min, |c| c.time_min)
    }

    /// The time of its feed moves on the same clock, min.
    #[must_use]
    pub fn cutting_min(&self) -> f64 {
        self.on_control.as_ref().map_or(self.cutting_time_min, |c| c.cutting_min)
    }

    /// The motions as a verdict takes them, all with one tool.
    pub fn reading(&self, source: &'static str) -> Reading<'_> {
        Reading {
            source,
            program: Program { motions: &self.motions, times_min: &self.times_min, changes: &[] },
            control: self.control.clone(),
            speeds_rpm: vec![self.spindle_rpm],
        }
    }
}

/// From the spindle's nose to the tip of the tool in hand, mm.
pub fn gauge_mm(job: &Job) -> f64 {
    job.cutter().length_mm() + job.holder().map_or(0.0, osculate_tools::Holder::length_mm)
}

/// The lengths of the tools in hand in these jobs, by their numbers.
pub fn lengths(tools: &[Job]) -> Vec<(u32, f64)> {
    tools.iter().map(|one| (one.tool().number(), gauge_mm(one))).collect()
}

/// The state of the control that jobs mean their program to run in, each for the tool that it has in hand.
fn expected(job: &Job, more: &[Job], gauge_length_mm: f64) -> Expected {
    if let [] | [_] = more {
        let tool = ExpectedTool::new(job.tool().number(), gauge_length_mm);
        let (work_offset, coolant) = (work_offset(job), job.coolant());
        return Expected {
            work_offset,
            coolant,
            ..Expected::new(tool, job.spindle_rpm(), job.tolerance().gouge_mm)
        };
    }
    let tools = more.iter().map(|one| ExpectedTool {
        spindle_rpm: one.spindle_rpm(),
        coolant: one.coolant(),
        ..ExpectedTool::new(one.tool().number(), gauge_mm(one))
    });
    Expected {
        tools: tools.collect(),
        spindle_rpm: None,
        work_offset: work_offset(job),
        coolant: None,
        tolerance_mm: job.tolerance().gouge_mm,
    }
}

/// The work offset that a job names.
fn work_offset(job: &Job) -> Option<WorkOffset> {
    let word = job.work_offset()?;
    // Loading has seen that the dialect has it; Heidenhain's presets have numbers only.
    word.parse().or_else(|_| format!("preset {word}").parse()).ok()
}

/// What a program is told whose rotary joints start or stop beside a feed move without coming to rest, on a control that keeps to
/// corners of its slides alone. (Measured on LinuxCNC: where a table stopped at the end of a pass its tip was up to 0.05 mm off, with
/// corners of 0.0005 mm.)
const ENDS: &str = "; where rotary joints stop or start without an exact stop the control may leave the way further, which is NOT described";

/// A rotary joint that turns by no more than this in a block goes too slowly for its start or stop to be seen.
const SEEN_RAD: f64 = 2e-4;

/// Whether a control keeps to corners of its slides alone, and rotary joints of a program stop or start beside a feed move otherwise
/// than at rest.
fn swings(control: &Control, read: &ReadBack) -> bool {
    let rotary = control.machine.rotary();
    let swung = |a: &ReadBlock, b: &ReadBlock| {
        let stops = |k: &usize| {
            let turned = [a, b].map(|one| (one.to[*k] - one.from[*k]).abs());
            turned.contains(&0.0) && turned.into_iter().any(|t| t > SEEN_RAD)
        };
        !(a.exact || a.rapid && b.rapid) && rotary.iter().any(stops)
    };
    let slides_alone = control.dialect == Dialect::LinuxCnc && !matches!(control.feed, FeedMode::Tcp);
    slides_alone && read.blocks.windows(2).any(|pair| swung(&pair[0], &pair[1]))
}

/// A conduct as a verdict takes it.
fn judged(conduct: &Conduct, swings: bool) -> GoalControl {
    let remarks = conduct.findings.iter().map(|f| {
        let (gravity, word) = match f.grade {
            Grade::Warning => (Gravity::Told, "warning: "),
            Grade::Open => (Gravity::Open, ""),
            Grade::Breaks => (Gravity::Breaks, ""),
        };
        let at = if f.line == 0 { String::new() } else { format!("line {}: ", f.line) };
        Remark { gravity, text: format!("{word}{at}{}", f.what) }
    });
    let blend = match conduct.blend_line {
        Some(line) if conduct.blend_mm > 0.0 => {
            let ends = if swings { ENDS } else { "" };
            format!(
                "; corners are blended by up to {} mm (line {line}), which bounds have added{ends}",
                conduct.blend_mm
            )
        }
        _ => "; corners are not blended".to_owned(),
    };
    GoalControl {
        words: format!("tool, length, work offset and spindle in every feed move, retracts{blend}"),
        remarks: remarks.collect(),
        blend_mm: conduct.blend_mm,
        bodies: String::new(),
    }
}

/// The clock of the control at the end of each piece: the first move leads from an unknown place and is none.
fn on_control(read: &ControlTime) -> OnControl {
    let mut clock = 0.0;
    let at = |t: &f64| {
        clock += t;
        clock
    };
    let times_min = read.of_moves_min.iter().skip(1).map(at).collect();
    OnControl { times_min, time_min: read.time_min(), cutting_min: read.cutting_min }
}

/// Reads an NC program back through the machine; it is to run in the state that the job means.
pub fn read_back(
    text: &str,
    job: &Job,
    control: &Control,
    setup: &Setup,
    lenient: bool,
) -> Result<Motions, String> {
    read_back_tools(text, (job, &[]), control, setup, lenient)
}

/// As [`read_back`], of a program that calls the tools in hand in the jobs that follow the first; where none follow, its own.
pub fn read_back_tools(
    text: &str,
    (job, tools): (&Job, &[Job]),
    control: &Control,
    setup: &Setup,
    lenient: bool,
) -> Result<Motions, String> {
    let expected = expected(job, tools, setup.gauge_length_mm);
    let options = ReadOptions { strict: !lenient, timed: true, ..ReadOptions::default() };
    let lengths = lengths(tools);
    let length = |number: Option<u32>| {
        let own = lengths.iter().find(|l| Some(l.0) == number);
        own.map_or(setup.gauge_length_mm, |l| l.1)
    };
    let text = control.language.engine_text(text);
    let read = readback::read_tools(&text, control.dialect, &control.machine, (setup, &lengths), &options)
        .map_err(|e| match e {
            ReadError::Word { line, word } => format!(
                "line {line}: {word} is not interpreted and may change the tool's way; --lenient leaves such words out \
                 and lists them"
            ),
            other => other.to_string(),
        })?;
    let mut out = Motions {
        motions: Vec::with_capacity(read.moves.len()),
        times_min: Vec::with_capacity(read.moves.len()),
        on_control: read.control.as_ref().map(on_control),
        at_nose: Vec::with_capacity(read.moves.len()),
        time_min: read.time_min(),
        cutting_time_min: read.blocks.iter().filter(|b| !b.rapid).map(|b| b.time_min).sum(),
        joints: Some(read.joint_demand(&control.machine, job.feed_mm_min())),
        spindle_rpm: read.spindle_rpm,
        calls: Vec::new(),
        tools: read
            .moves
            .iter()
            .filter(|m| !matches!(m.motion, Motion::Rapid))
            .filter_map(|m| m.tool)
            .collect(),
        control: judged(&read.conduct(&expected), swings(control, &read)),
        diagnostics: read.diagnostics,
    };
    let mut clock = 0.0;
    let mut at_work: Option<Option<u32>> = None;
    for w in read.moves.windows(2) {
        clock += w[1].time_min;
        let mut from = w[0].pose;
        if at_work != Some(w[1].tool) {
            // The spindle stays where it was while the tool is changed.
            from.tip += from.axis.into_inner() * (length(w[0].tool) - length(w[1].tool));
            let speed = read.speeds_rpm.iter().find(|s| s.0 == w[1].tool).map(|s| s.1);
            out.calls.push(Call { first: out.motions.len(), number: w[1].tool, spindle_rpm: speed });
            at_work = Some(w[1].tool);
        }
        out.motions.push(Swept {
            from,
            to: w[1].pose,
            rapid: matches!(w[1].motion, Motion::Rapid),
            // Lines beyond 2^32 do not fit in memory.
            block: u32::try_from(w[1].line).unwrap_or(u32::MAX),
        });
        out.times_min.push(clock);
        out.at_nose.push(w[1].at_nose);
    }
    Ok(out)
}
