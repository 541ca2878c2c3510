//! Reading NC text back: what the machine will really do, as a path of the tool in the part's frame.
//!
//! The text goes through a model of the control (modal words, units, tool-centre-point switch, how F is read) and the
//! machine's forward kinematics. Between two places the control moves all programmed axes linearly; the tool's way is
//! therefore a curve, which comes back as short straight moves that stray from it by at most the asked tolerances.
//! A move is known once every axis has been named; what comes before leads from an unknown place.

use osculate_geom::Diagnostic;
use osculate_tools::Pose;
use osculate_tools::cl::{ClMove, ClPath, Motion};

use super::Dialect;
use super::conduct::{Conduct, Expected};
use super::control::Record;
use super::event::{Event, Frame, Moved, Sink};
use super::flow::Flow;
use super::interpret::Interpreter;
use super::names::Names;
pub use super::read_error::ReadError;
use super::state::FeedReading;
use super::timing::Planned;
use super::way::MOST_PIECES;
use crate::machine::{JointValues, Machine};
use crate::motion::linuxcnc::PathControl;
use crate::motion::{FeedBlock, JointDemand, TimedMove, TooLong, rapid_time_min};
use crate::setup::Setup;

/// How a text is to be read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReadOptions {
    /// How far the straight moves may stray from the tip's true way, mm.
    pub tip_tol_mm: f64,
    /// How far they may stray from the axis, rad.
    pub axis_tol_rad: f64,
    /// Refuse words that are not understood; otherwise they are reported as losses and left out.
    pub strict: bool,
    /// Say how long the control takes too: [`ReadBack::control`].
    pub timed: bool,
}

impl Default for ReadOptions {
    /// 0.1 um, 0.05 deg, strict, without the control's time.
    fn default() -> Self {
        Self { tip_tol_mm: 1e-4, axis_tol_rad: 0.05f64.to_radians(), strict: true, timed: false }
    }
}

/// A straight piece of the tool's way.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ReadMove {
    /// Where it ends, in the part's frame.
    pub pose: Pose,
    /// Rapid, or at this mean feed of the tip relative to the part.
    pub motion: Motion,
    /// Line of the text, from 1.
    pub line: usize,
    /// How long it takes, min.
    pub time_min: f64,
    /// Number of the tool in the spindle, where the program has called one by number.
    pub tool: Option<u32>,
    /// To a place of the machine's own frame: G53, SUPA, M91, G28.
    pub own_frame: bool,
    /// Where the joints themselves stand at its end, in the order of the machine's joints, mm and rad, slides at the spindle nose; none where
    /// no joints lead there.
    pub at_nose: Option<JointValues>,
}

/// One block of the text.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ReadBlock {
    /// Line of the text, from 1.
    pub line: usize,
    /// Joints before.
    pub from: JointValues,
    /// Joints after.
    pub to: JointValues,
    /// G0.
    pub rapid: bool,
    /// How long it takes by its F, or by the joints' drives for a rapid move, min.
    pub time_min: f64,
    /// Length of the tip's way relative to the part, mm.
    pub tip_length_mm: f64,
    /// Number of the tool in the spindle, where the program has called one by number.
    pub tool: Option<u32>,
    /// To a place of the machine's own frame: G53, SUPA, M91, G28.
    pub own_frame: bool,
    /// It comes to rest at its end, or goes through it: G61, G61.1, G9, G60.
    pub exact: bool,
}

/// What a text makes the machine do.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct ReadBack {
    /// The tool's way in short straight moves. The first one leads from an unknown place.
    pub moves: Vec<ReadMove>,
    /// The blocks.
    pub blocks: Vec<ReadBlock>,
    /// Spindle speed, where the text says one: the last.
    pub spindle_rpm: Option<f64>,
    /// The speed at which each tool feeds first, by its number, in the order of the program; tools that feed without S have none.
    pub speeds_rpm: Vec<(Option<u32>, f64)>,
    /// Findings, with line numbers.
    pub diagnostics: Vec<Diagnostic>,
    /// In which states of the control it moves.
    pub record: Record,
    /// The time that its control takes, where it is asked for.
    pub control: Option<ControlTime>,
}

/// The time that a control takes over a program, with its accelerations and corners, as [`crate::nc::timing`] models them.
#[derive(Clone, Debug, PartialEq, Default)]
#[non_exhaustive]
pub struct ControlTime {
    /// Of every one of [`ReadBack::moves`], min; a block's time is shared by its moves as they share its time by F.
    pub of_moves_min: Vec<f64>,
    /// Of feed moves, min.
    pub cutting_min: f64,
    /// Of rapid moves, min.
    pub rapid_min: f64,
    /// Of dwells, min.
    pub dwell_min: f64,
}

impl ControlTime {
    /// All of it, min.
    #[must_use]
    pub fn time_min(&self) -> f64 {
        self.cutting_min + self.rapid_min + self.dwell_min
    }
}

impl ReadBack {
    /// What in the state of the control is not as the job means it.
    #[must_use]
    pub fn conduct(&self, expected: &Expected) -> Conduct {
        self.record.conduct(expected)
    }

    /// The tool's way as a CL path; cutter and holder are not in an NC text.
    ///
    /// ```
    /// use osculate_postproc::{Dialect, Machine, Setup, cldata, readback::{ReadOptions, read}};
    ///
    /// // NC to CL data: a program of three axes as APT text.
    /// let (machine, setup) = (Machine::built_in("3-axis")?, Setup::default());
    /// let program = "G21 G90\nG0 X0 Y0 Z5\nG1 X60 F600\nM30\n";
    /// let back = read(program, Dialect::LinuxCnc, &machine, &setup, &ReadOptions::default())?;
    /// let text = cldata::write(&back.cl_path(), &cldata::ClWriteOptions::default())?;
    /// assert!(text.contains("GOTO/60."));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn cl_path(&self) -> ClPath {
        let moves =
            self.moves.iter().map(|m| ClMove { pose: m.pose, motion: m.motion, aloft: false }).collect();
        ClPath { cutter: None, holder: Vec::new(), spindle_rpm: self.spindle_rpm, moves }
    }

    /// The blocks as [`crate::motion::program_time`] takes them.
    pub fn timed_moves(&self) -> impl Iterator<Item = TimedMove> + '_ {
        self.blocks.iter().map(|b| TimedMove { from: b.from, to: b.to, rapid: b.rapid, time_min: b.time_min })
    }

    /// What the feed moves ask of the joints of the machine that the text was read for, with the tip asked to go at this feed.
    #[must_use]
    pub fn joint_demand(&self, machine: &Machine, feed_mm_min: f64) -> JointDemand {
        let mut demand = JointDemand::new(machine);
        for b in self.blocks.iter().filter(|b| !b.rapid) {
            let ReadBlock { line, from, to, time_min, .. } = *b;
            let asked_min = b.tip_length_mm / feed_mm_min;
            demand.add(machine, &FeedBlock { line, from, to, time_min, asked_min });
        }
        demand
    }

    /// Total time, min.
    #[must_use]
    pub fn time_min(&self) -> f64 {
        self.blocks.iter().map(|b| b.time_min).fold(0.0, |sum, t| sum + t)
    }
}

/// Reads a whole text.
///
/// ```
/// use osculate_postproc::{Dialect, Machine, Setup, readback::{ReadError, ReadOptions, read}};
///
/// let (machine, setup) = (Machine::built_in("3-axis")?, Setup::default());
/// let text = "G21 G90 G94 G54\nT1 M6\nS8000 M3\nG43 H1\nG0 X0 Y0 Z5\nG1 X60 F600\nM30\n";
/// let back = read(text, Dialect::LinuxCnc, &machine, &setup, &ReadOptions::default())?;
/// let cut = back.moves.last().expect("it moves");
/// // 60 mm at 600 mm/min, in line 6.
/// assert!((cut.pose.tip.x - 60.0).abs() < 1e-12 && (cut.time_min - 0.1).abs() < 1e-12);
/// assert_eq!((cut.line, back.spindle_rpm), (6, Some(8000.0)));
/// // A word that is not understood is refused with its line.
/// let strange = read("G1 X0 Y0 Z0 F100\nG777\n", Dialect::LinuxCnc, &machine, &setup, &ReadOptions::default());
/// assert!(matches!(strange, Err(ReadError::Word { line: 2, .. })));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Where the text cannot be read, or (with `strict`) says something that is not understood.
pub fn read(
    text: &str,
    dialect: Dialect,
    machine: &Machine,
    setup: &Setup,
    options: &ReadOptions,
) -> Result<ReadBack, ReadError> {
    read_tools(text, dialect, machine, (setup, &[]), options)
}

/// As [`read()`], of a program with several tools: the gauge lengths of those that have a number in the list are theirs, mm, and the setup's
/// that of all others.
///
/// ```
/// use osculate_postproc::{Dialect, Machine, Setup, readback::{ReadOptions, read_tools}};
///
/// // Both tools end at Z10: the spindle nose stands higher with the longer one.
/// let (machine, setup) = (Machine::built_in("3-axis")?, Setup::default());
/// let text = "G21 G90 G54\nT1 M6\nG43 H1\nG0 X0 Y0 Z10\nT2 M6\nG43 H2\nG0 X0 Y0 Z10\nM30\n";
/// let lengths_mm = [(1, 80.0), (2, 120.0)];
/// let back = read_tools(text, Dialect::LinuxCnc, &machine, (&setup, &lengths_mm), &ReadOptions::default())?;
/// let z = machine.joint_named("Z").expect("it has one");
/// for (tool, length_mm) in lengths_mm {
///     let end = back.moves.iter().rfind(|m| m.tool == Some(tool)).expect("it moves");
///     assert!((end.pose.tip.z - 10.0).abs() < 1e-12);
///     assert!((end.at_nose.expect("it is known")[z] - 10.0 - length_mm).abs() < 1e-12);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`read()`].
pub fn read_tools(
    text: &str,
    dialect: Dialect,
    machine: &Machine,
    (setup, lengths_mm): (&Setup, &[(u32, f64)]),
    options: &ReadOptions,
) -> Result<ReadBack, ReadError> {
    let mut names = Names::new(dialect, machine);
    text.lines().for_each(|line| names.line(line));
    let mut reader = Reader::new(&names, machine, setup, options)?;
    reader.control.lengths = lengths_mm.to_vec();
    for line in text.lines() {
        reader.line(line)?;
    }
    reader.end()?;
    let Reader { mut control, .. } = reader;
    let timed = control.sink.timed();
    let mut out = control.sink.out;
    out.control = timed;
    TooLong::refused(out.time_min())?;
    out.spindle_rpm = control.spindle_rpm;
    out.diagnostics = control.diagnostics;
    out.record = control.record;
    Ok(out)
}

/// Moves that come out of a line that calls or repeats others, at most.
const MOST_MOVES: usize = 2_000_000;

/// Reads a text a line at a time: moves and blocks go out as they come.
pub struct Reader<'a> {
    control: Interpreter<'a, Collect>,
    flow: Flow,
    lines: usize,
    ended: bool,
    moved: bool,
}

impl<'a> Reader<'a> {
    /// Before the first line. `names` must have seen the whole text.
    ///
    /// # Errors
    /// Where the setup or the options are none.
    pub fn new(
        names: &Names,
        machine: &'a Machine,
        setup: &'a Setup,
        options: &ReadOptions,
    ) -> Result<Self, ReadError> {
        setup.check()?;
        for (what, value) in [("tip_tol_mm", options.tip_tol_mm), ("axis_tol_rad", options.axis_tol_rad)] {
            if !(value.is_finite() && value > 0.0) {
                return Err(ReadError::Tolerance { what, value });
            }
        }
        let frame = Frame { machine, setup };
        let tolerance = [options.tip_tol_mm, options.axis_tol_rad];
        let clock = options.timed.then(|| Planned::of_blocks(names.dialect(), machine));
        let collect = Collect {
            out: ReadBack::default(),
            tolerance,
            unbounded: None,
            exact: false,
            clock,
            ends: Vec::new(),
        };
        let mut control = Interpreter::new(names.dialect(), frame, options.strict, collect);
        control.rest_unnamed(names.all());
        let flow = Flow::new(names.dialect(), names.kept());
        Ok(Self { control, flow, lines: 0, ended: false, moved: false })
    }

    /// One line; those after the end of the program are ignored.
    ///
    /// # Errors
    /// As [`read()`].
    pub fn line(&mut self, line: &str) -> Result<(), ReadError> {
        self.lines += 1;
        if !self.ended {
            let Self { control, flow, .. } = self;
            let before = control.sink.out.moves.len();
            let mut run = |number: usize, text: &str| {
                let ended = control.text_line(number, text)?;
                if let Some(line) = control.sink.unbounded {
                    return Err(ReadError::Bound { line, most: MOST_PIECES });
                }
                if control.sink.out.moves.len() - before > MOST_MOVES {
                    let what = "moves made by calls and repeats";
                    return Err(ReadError::Repeats { line: number, what, most: MOST_MOVES });
                }
                Ok(ended)
            };
            self.ended = flow.line(self.lines, line, &mut run)?;
            self.moved |= !self.control.sink.out.moves.is_empty();
        }
        Ok(())
    }

    /// The end of the text.
    ///
    /// # Errors
    /// Where nothing has moved.
    pub fn end(&mut self) -> Result<(), ReadError> {
        self.control.end()?;
        if self.moved {
            return Ok(());
        }
        Err(ReadError::NoMoves { lines: self.lines, machine: self.control.machine.name().into() })
    }

    /// The moves since the last call.
    pub fn take_moves(&mut self) -> std::vec::Drain<'_, ReadMove> {
        self.control.sink.out.moves.drain(..)
    }

    /// The blocks since the last call.
    pub fn take_blocks(&mut self) -> std::vec::Drain<'_, ReadBlock> {
        self.control.sink.out.blocks.drain(..)
    }

    /// Spindle speed, as far as the text has said it.
    #[must_use]
    pub const fn spindle_rpm(&self) -> Option<f64> {
        self.control.spindle_rpm
    }

    /// What in the state of the control, so far, is not as the job means it.
    #[must_use]
    pub fn conduct(&self, expected: &Expected) -> Conduct {
        self.control.record.conduct(expected)
    }

    /// Findings so far, with line numbers.
    #[must_use]
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.control.diagnostics
    }
}

/// Collects everything.
struct Collect {
    out: ReadBack,
    tolerance: [f64; 2],
    /// The line of a block whose way is too long for its curvature.
    unbounded: Option<usize>,
    /// Moves end exactly.
    exact: bool,
    /// The control's clock, where its time is asked for, and the moves of every block of it.
    clock: Option<Planned>,
    ends: Vec<[usize; 2]>,
}

impl Sink for Collect {
    fn take(&mut self, frame: Frame<'_>, event: &Event<'_>) {
        if let Some(clock) = &mut self.clock {
            clock.take(frame, event);
        }
        match *event {
            Event::Placed { line, known, joints, tool } => {
                let (from, to) = (joints, joints);
                let pose = frame.pose(&known);
                self.out.moves.push(ReadMove {
                    pose,
                    motion: Motion::Rapid,
                    line,
                    time_min: 0.0,
                    tool,
                    own_frame: false,
                    at_nose: frame.at_nose(&known),
                });
                let (time_min, tip_length_mm, own_frame, exact) = (0.0, 0.0, false, self.exact);
                let first = ReadBlock {
                    line,
                    from,
                    to,
                    rapid: true,
                    time_min,
                    tip_length_mm,
                    tool,
                    own_frame,
                    exact,
                };
                self.out.blocks.push(first);
            }
            Event::Moved(m) => self.moved(frame, m),
            Event::Path(control) => self.exact = !matches!(control, PathControl::Blend { .. }),
            Event::Dwell(_) | Event::Halt => {}
        }
    }
}

impl Collect {
    /// The control's time of what has been read: the end of the text.
    fn timed(&mut self) -> Option<ControlTime> {
        let (each, dwell_min) = self.clock.take()?.block_times_min();
        let mut out = ControlTime {
            of_moves_min: vec![0.0; self.out.moves.len()],
            dwell_min,
            ..ControlTime::default()
        };
        for (block_min, &[begin, end]) in each.iter().zip(&self.ends) {
            let own = &self.out.moves[begin..end];
            let asked: f64 = own.iter().map(|m| m.time_min).sum();
            for (m, time) in own.iter().zip(&mut out.of_moves_min[begin..end]) {
                let share = if asked > 0.0 { m.time_min / asked } else { 1.0 / own.len() as f64 };
                *time = block_min * share;
            }
            let rapid = own.iter().any(|m| matches!(m.motion, Motion::Rapid));
            *(if rapid { &mut out.rapid_min } else { &mut out.cutting_min }) += block_min;
        }
        Some(out)
    }

    fn moved(&mut self, frame: Frame<'_>, m: &Moved) {
        let time_min = if m.rapid { rapid_time_min(frame.machine, &m.from, &m.to).0 } else { m.time_min };
        let Some(poses) = m.way.densified(&|k| frame.pose(k), self.tolerance) else {
            self.unbounded = self.unbounded.or(Some(m.line));
            return;
        };
        let mut tip_length_mm = 0.0;
        let mut at = frame.pose(&m.way.from).tip;
        for (_, pose) in &poses {
            tip_length_mm += (pose.tip - at).norm();
            at = pose.tip;
        }
        if let Some(rpm) = m.feed.and_then(|f| f.speed_rpm)
            && !self.out.speeds_rpm.iter().any(|s| s.0 == m.tool)
        {
            self.out.speeds_rpm.push((m.tool, rpm));
        }
        let per_minute = m.feed.filter(|f| f.reading == FeedReading::PerMinute);
        let motion = match (m.rapid, per_minute) {
            (true, _) => Motion::Rapid,
            (false, Some(f)) if tip_length_mm == 0.0 => Motion::Feed(f.value),
            (false, _) if tip_length_mm == 0.0 => Motion::Feed(1.0 / time_min),
            (false, _) => Motion::Feed(tip_length_mm / time_min),
        };
        let begin = self.out.moves.len();
        let mut t0 = 0.0;
        for (t, pose) in poses {
            let Moved { line, tool, own_frame, .. } = *m;
            let time_min = time_min * (t - t0);
            let at_nose = frame.at_nose(&m.way.at(t));
            self.out.moves.push(ReadMove { pose, motion, line, time_min, tool, own_frame, at_nose });
            t0 = t;
        }
        if self.clock.is_some() {
            self.ends.push([begin, self.out.moves.len()]);
        }
        self.out.blocks.push(ReadBlock {
            line: m.line,
            from: m.from,
            to: m.to,
            rapid: m.rapid,
            time_min,
            tip_length_mm,
            tool: m.tool,
            own_frame: m.own_frame,
            exact: self.exact,
        });
    }
}
