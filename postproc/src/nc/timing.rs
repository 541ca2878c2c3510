//! How long a control takes over a text, from the text alone and in bounded memory.
//!
//! Programs of LinuxCNC go through its own planner ([`crate::motion::linuxcnc`]): it plans the programmed words, so
//! with its kinematics switched on X Y Z of the tip are what its limits hold for. Programs of the other controls go
//! through the joints ([`crate::motion::Stretch`]); their rapid moves run from rest to rest.

use super::Dialect;
use super::event::{Event, FeedNow, Frame, Moved, Sink};
use super::flow::Flow;
use super::interpret::Interpreter;
pub use super::names::Names;
use super::read_error::ReadError;
use super::state::{FeedReading, Known};
use crate::machine::{MAX_JOINTS, Machine};
use crate::motion::linuxcnc::{Canon, CanonArc, CanonFeed, CanonMove, Limits, PathControl};
use crate::motion::{FeedBlock, JointDemand, LookAhead, ProgramTime, Stretch, TooLong, rapid_time_min};
use crate::setup::Setup;
use osculate_geom::Diagnostic;

/// What a text takes.
#[derive(Clone, Debug, PartialEq, Default)]
#[non_exhaustive]
pub struct Timed {
    /// The time.
    pub time: ProgramTime,
    /// What the feed moves ask of the joints, against the program's own F.
    pub joints: JointDemand,
    /// Findings, with line numbers.
    pub diagnostics: Vec<Diagnostic>,
}

/// A clock that runs along a text, a line at a time.
pub struct Clock<'a> {
    control: Interpreter<'a, Planned>,
    flow: Flow,
    lines: usize,
    ended: bool,
}

impl<'a> Clock<'a> {
    /// Before the first line. `names` must have seen the whole text; `strict` refuses words that are not understood.
    ///
    /// # Errors
    /// Where the setup is none.
    pub fn new(
        names: &Names,
        machine: &'a Machine,
        setup: &'a Setup,
        strict: bool,
    ) -> Result<Self, ReadError> {
        setup.check()?;
        let frame = Frame { machine, setup };
        let planned = Planned::new(names.dialect(), machine);
        let mut control = Interpreter::new(names.dialect(), frame, strict, planned);
        control.rest_unnamed(names.all());
        let flow = Flow::new(names.dialect(), names.kept());
        Ok(Self { control, flow, lines: 0, ended: false })
    }

    /// One line; those after the end of the program are ignored.
    ///
    /// # Errors
    /// As [`super::readback::read`].
    pub fn line(&mut self, line: &str) -> Result<(), ReadError> {
        self.lines += 1;
        if !self.ended {
            let Self { control, flow, .. } = self;
            let mut run = |number: usize, text: &str| control.text_line(number, text);
            self.ended = flow.line(self.lines, line, &mut run)?;
        }
        Ok(())
    }

    /// The end of the text.
    ///
    /// # Errors
    /// Where a subprogram is missing, with `strict`.
    pub fn finish(mut self) -> Result<Timed, ReadError> {
        self.control.end()?;
        if !self.control.placed {
            let text = "nothing moves: no complete position is named (a text that only defines subprograms runs none)";
            self.control.diagnostics.push(Diagnostic::loss("program", text));
        }
        let planned = self.control.sink;
        let mut time = planned.time;
        if let Some(stretch) = &planned.stretch {
            time.cutting_min = stretch.time_s() / 60.0;
            let counts = stretch.slowed().into_iter().zip(planned.rapid_limited).map(|(a, b)| a + b);
            for (joint, count) in self.control.machine.joints().iter().zip(counts).filter(|c| c.1 > 0) {
                time.limited_by.insert(joint.letter.clone(), count);
            }
        }
        if let Some(canon) = planned.canon {
            let [cutting, rapid] = canon.clock_s();
            time.cutting_min = cutting / 60.0;
            time.rapid_min = rapid / 60.0;
            let machine = self.control.machine;
            let letters = letters(machine, &planned.order);
            for (letter, count) in letters.iter().zip(canon.limited()).filter(|l| l.1 > 0) {
                time.limited_by.insert(letter.clone(), count);
            }
        }
        TooLong::refused(time.time_min())?;
        Ok(Timed { time, joints: planned.joints, diagnostics: self.control.diagnostics })
    }
}

/// The time of a whole text.
///
/// ```
/// use osculate_postproc::{Dialect, Machine, Setup, nc::timing::time};
///
/// let machine = Machine::built_in("3-axis")?;
/// let text = "G21 G90 G94\nG0 X0 Y0 Z5\nG1 X60 F600\nG4 P30\nM30\n";
/// let timed = time(text, Dialect::LinuxCnc, &machine, &Setup::default(), true)?.time;
/// // A tenth of a minute for 60 mm at 600 mm/min and a little for starting and stopping; half a minute of dwell.
/// assert!((0.1..0.102).contains(&timed.cutting_min));
/// assert_eq!(timed.dwell_min, 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`super::readback::read`].
pub fn time(
    text: &str,
    dialect: Dialect,
    machine: &Machine,
    setup: &Setup,
    strict: bool,
) -> Result<Timed, ReadError> {
    let mut names = Names::new(dialect, machine);
    text.lines().for_each(|l| names.line(l));
    let mut clock = Clock::new(&names, machine, setup, strict)?;
    for line in text.lines() {
        clock.line(line)?;
    }
    clock.finish()
}

fn letters(machine: &Machine, order: &[usize; 3]) -> Vec<String> {
    let linear = order.iter().map(|slot| machine.linear()[*slot]);
    linear.chain(machine.rotary().iter().copied()).map(|p| machine.joints()[p].letter.clone()).collect()
}

/// Plans what happens.
pub(super) struct Planned {
    /// Programs of LinuxCNC.
    canon: Option<Canon>,
    /// Programs of the other controls.
    stretch: Option<Stretch>,
    rapid_limited: [usize; MAX_JOINTS],
    limits: Limits,
    /// Slot of the linear joint that is X, Y, Z, without tool-centre-point control.
    order: [usize; 3],
    time: ProgramTime,
    joints: JointDemand,
    control: PathControl,
    /// Every block so far, where their times are asked for.
    blocks: Option<Vec<Block>>,
}

/// A block whose time is asked for.
#[derive(Clone, Copy)]
struct Block {
    /// Rapid moves of controls that run them from rest to rest have their time at once.
    known_min: Option<f64>,
    /// Its time by F, min.
    asked_min: f64,
}

impl Planned {
    fn new(dialect: Dialect, machine: &Machine) -> Self {
        let own = dialect != Dialect::LinuxCnc;
        let stretch = own.then(|| Stretch::new(machine, &LookAhead::default()));
        let linear = machine.linear();
        let slot = |k: usize, letter: &str| {
            linear.iter().position(|p| machine.joints()[*p].letter == letter).unwrap_or(k)
        };
        let order = [slot(0, "X"), slot(1, "Y"), slot(2, "Z")];
        let drive = |slot: usize| machine.joints()[linear[slot]].drive;
        let mut limits = Limits {
            velocity_mm_s: order.map(|s| drive(s).velocity_per_s),
            acceleration_mm_s2: order.map(|s| drive(s).acceleration_per_s2),
            velocity_deg_s: [f64::INFINITY; 2],
            acceleration_deg_s2: [f64::INFINITY; 2],
            path_velocity_mm_s: machine.control().max_path_velocity_mm_s.unwrap_or(f64::INFINITY),
        };
        for (k, place) in machine.rotary().iter().enumerate() {
            let drive = machine.joints()[*place].drive;
            limits.velocity_deg_s[k] = drive.velocity_per_s.to_degrees();
            limits.acceleration_deg_s2[k] = drive.acceleration_per_s2.to_degrees();
        }
        Self {
            canon: None,
            stretch,
            rapid_limited: [0; MAX_JOINTS],
            limits,
            order,
            time: ProgramTime::default(),
            joints: JointDemand::new(machine),
            control: PathControl::FIRST,
            blocks: None,
        }
    }

    /// One that keeps the time of every block.
    pub(super) fn of_blocks(dialect: Dialect, machine: &Machine) -> Self {
        let mut out = Self::new(dialect, machine);
        out.blocks = Some(Vec::new());
        if let Some(stretch) = &mut out.stretch {
            stretch.keep_each();
        }
        out
    }

    /// The time of every block, min, and that of all dwells: the end of the text.
    pub(super) fn block_times_min(mut self) -> (Vec<f64>, f64) {
        let blocks = self.blocks.take().unwrap_or_default();
        let dwell_min = self.time.dwell_min;
        let mut each_s = Vec::new();
        if let Some(stretch) = &mut self.stretch {
            stretch.stop();
            each_s = stretch.take_each_s();
            // Starting and stopping with limited jerk is of no block: all have their share of it.
            let sum: f64 = each_s.iter().sum();
            let more = if sum > 0.0 { stretch.time_s() / sum } else { 1.0 };
            each_s.iter_mut().for_each(|t| *t *= more);
        } else if let Some(canon) = &mut self.canon {
            canon.stop();
            let own = blocks.iter().filter(|b| b.known_min.is_none());
            each_s = canon.take_each_s(&own.map(|b| b.asked_min).collect::<Vec<_>>());
        }
        let mut each_min = each_s.into_iter().map(|t| t / 60.0);
        let time = |b: &Block| b.known_min.unwrap_or_else(|| each_min.next().unwrap_or(0.0));
        (blocks.iter().map(time).collect(), dwell_min)
    }

    fn place(&self, known: &Known) -> ([f64; 3], [f64; 2]) {
        let xyz = if known.tcp { known.tip().into() } else { self.order.map(|s| known.linear[s]) };
        (xyz, known.rotary.map(f64::to_degrees))
    }

    fn canon_move(&self, m: &Moved) -> CanonMove {
        let (xyz_mm, rotary_deg) = self.place(&m.way.to);
        let axis = |slot: usize| {
            if m.way.to.tcp { slot } else { self.order.iter().position(|s| *s == slot).unwrap_or(slot) }
        };
        let arc = m.way.arc.map(|a| CanonArc {
            plane: a.plane.map(axis),
            centre_mm: a.centre,
            sweep_rad: a.sweep_rad,
        });
        CanonMove { rapid: m.rapid, xyz_mm, rotary_deg, arc, feed: canon_feed(m.feed) }
    }
}

fn canon_feed(feed: Option<FeedNow>) -> CanonFeed {
    let Some(f) = feed else { return CanonFeed::Inverse(0.0) };
    match f.reading {
        FeedReading::Inverse => CanonFeed::Inverse(f.value),
        FeedReading::PerMinute => CanonFeed::PerMinute { mm_min: f.value * f.unit_mm, deg_min: f.value },
        FeedReading::PerTurn => {
            let f_min = f.value * f.speed_rpm.unwrap_or(0.0);
            CanonFeed::PerMinute { mm_min: f_min * f.unit_mm, deg_min: f_min }
        }
    }
}

impl Sink for Planned {
    fn take(&mut self, frame: Frame<'_>, event: &Event<'_>) {
        if let Event::Moved(&Moved { line, from, to, rapid: false, time_min, .. }) = *event {
            let asked_min = time_min;
            self.joints.add(frame.machine, &FeedBlock { line, from, to, time_min, asked_min });
        }
        if let (Some(blocks), Event::Moved(m)) = (&mut self.blocks, event) {
            let known_min = match (&self.stretch, &self.canon) {
                (Some(_), _) if m.rapid => Some(rapid_time_min(frame.machine, &m.from, &m.to).0),
                (None, None) => Some(m.time_min),
                _ => None,
            };
            blocks.push(Block { known_min, asked_min: m.time_min });
        }
        if let Some(stretch) = &mut self.stretch {
            match event {
                Event::Moved(m) if m.rapid => {
                    stretch.stop();
                    let (min, place) = rapid_time_min(frame.machine, &m.from, &m.to);
                    self.time.rapid_min += min;
                    if let Some(place) = place {
                        self.rapid_limited[place] += 1;
                    }
                }
                Event::Moved(m) => stretch.block(&m.from, &m.to, 60.0 * m.time_min),
                Event::Dwell(min) => {
                    stretch.stop();
                    self.time.dwell_min += min;
                }
                Event::Path(PathControl::Blend { .. }) => {}
                Event::Placed { .. } | Event::Path(_) | Event::Halt => stretch.stop(),
            }
            return;
        }
        match event {
            Event::Placed { known, .. } => {
                let (xyz, rotary) = self.place(known);
                match &mut self.canon {
                    Some(canon) => canon.jump(xyz, rotary),
                    None => {
                        let mut canon = Canon::new(&self.limits, xyz, rotary);
                        if self.blocks.is_some() {
                            canon.keep_each();
                        }
                        canon.path_control(self.control);
                        self.canon = Some(canon);
                    }
                }
            }
            Event::Moved(m) => {
                let next = self.canon_move(m);
                // After a switch of the kinematics the words of the same place are others.
                let from = self.place(&m.way.from);
                if let Some(canon) = &mut self.canon {
                    canon.stand_at(from.0, from.1);
                    canon.go(&next);
                }
            }
            Event::Dwell(min) => {
                if let Some(canon) = &mut self.canon {
                    canon.stop();
                }
                self.time.dwell_min += min;
            }
            Event::Path(control) => {
                self.control = *control;
                if let Some(canon) = &mut self.canon {
                    canon.path_control(*control);
                }
            }
            Event::Halt => {
                if let Some(canon) = &mut self.canon {
                    canon.stop();
                }
            }
        }
    }
}
