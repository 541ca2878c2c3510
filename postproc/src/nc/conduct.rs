//! Whether a program makes its moves in the state of the control that the job means: with its tool and that tool's
//! length, in its work offset, with the spindle turning as it should.
//!
//! What is judged are feed moves; the tool's length and the work offset also for rapid moves along Z. Findings of one
//! kind are one finding, with the first line and the number of moves.
//!
//! Corners and smoothing are not judged: [`Conduct::blend_mm`] says by how much the control may leave the programmed
//! way, and whoever bounds the way adds it.

use super::block::Coolant;
use super::control::{Control, Corner, Length, Record, Seen, Spindle, Tool};
use super::{Dialect, WorkOffset};

/// A tool that the job has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExpectedTool {
    /// By which it is called; its length offset (H) has the same number.
    pub number: u32,
    /// Its length, mm: what a program that states the length itself (LinuxCNC's `G43.1`) is held against.
    pub length_mm: f64,
    /// Its speed, where it is not that of the whole program.
    pub spindle_rpm: Option<f64>,
    /// Its coolant, where it is not that of the whole program.
    pub coolant: Option<Coolant>,
}

impl ExpectedTool {
    /// A tool with the speed and coolant of the whole program.
    ///
    /// ```
    /// use osculate_postproc::{Dialect, Machine, Setup, conduct::{Expected, ExpectedTool, Grade}, readback};
    ///
    /// let read = |text: &str| {
    ///     let (machine, setup) = (Machine::built_in("3-axis")?, Setup::default());
    ///     let back = readback::read(text, Dialect::LinuxCnc, &machine, &setup, &readback::ReadOptions::default())?;
    ///     // Tool 1, 80 mm long, at 8000 rpm.
    ///     Ok::<_, Box<dyn std::error::Error>>(back.conduct(&Expected::new(ExpectedTool::new(1, 80.0), Some(8000.0), 0.01)))
    /// };
    /// let head = "G21 G90 G94 G54 G64 P0.01\nT1 M6\nS8000 M3\nG0 X0 Y0\n";
    /// assert_eq!(read(&format!("{head}G43 H1 Z5\nG1 X60 F600\nM30\n"))?.worst(), None);
    /// // The length of another tool: it would crash.
    /// assert_eq!(read(&format!("{head}G43 H2 Z5\nG1 X60 F600\nM30\n"))?.worst(), Some(Grade::Breaks));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub const fn new(number: u32, length_mm: f64) -> Self {
        Self { number, length_mm, spindle_rpm: None, coolant: None }
    }
}

/// What the job means.
#[derive(Clone, Debug, PartialEq)]
pub struct Expected {
    /// Its tools; none: any tool will do.
    pub tools: Vec<ExpectedTool>,
    /// Speed of the spindle, clockwise; absent: any.
    pub spindle_rpm: Option<f64>,
    /// Where program zero is; absent: [`WorkOffset::usual`].
    pub work_offset: Option<WorkOffset>,
    /// Coolant; absent: any or none.
    pub coolant: Option<Coolant>,
    /// By how much a stated length may be off, mm.
    pub tolerance_mm: f64,
}

impl Expected {
    /// One tool at a speed, in the usual work offset.
    #[must_use]
    pub fn new(tool: ExpectedTool, spindle_rpm: Option<f64>, tolerance_mm: f64) -> Self {
        Self { tools: vec![tool], spindle_rpm, work_offset: None, coolant: None, tolerance_mm }
    }
}

/// How grave a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Grade {
    /// To be told.
    Warning,
    /// It cannot be known from the program: nothing is shown.
    Open,
    /// Not what the job means: the program is not held.
    Breaks,
}

/// Something in the state of the control that is not as the job means it.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct StateFinding {
    /// Line of the text, from 1; 0 where it is no line's.
    pub line: usize,
    /// How grave it is.
    pub grade: Grade,
    /// What it is, with the number of moves.
    pub what: String,
}

/// How a program conducts itself.
#[derive(Clone, Debug, PartialEq, Default)]
#[non_exhaustive]
pub struct Conduct {
    /// What is not as the job means it, by line.
    pub findings: Vec<StateFinding>,
    /// By how much the control may leave the programmed way at corners and in smoothing, mm: the widest in force during
    /// a feed move, as far as the program says it. LinuxCNC's is P and Q, which act one after the other.
    pub blend_mm: f64,
    /// The first line in which it is so wide.
    pub blend_line: Option<usize>,
}

impl Conduct {
    /// The gravest grade.
    #[must_use]
    pub fn worst(&self) -> Option<Grade> {
        self.findings.iter().map(|f| f.grade).max()
    }
}

/// S may be off by this share: controls round it, and no tool minds.
const SPEED_SHARE: f64 = 0.005;

/// Findings by kind, before they are put into words.
#[derive(Default)]
struct Found {
    all: Vec<(Grade, String, Seen, &'static str)>,
}

impl Found {
    /// `what` counts something by a noun in the singular; findings of the same words are one.
    fn add(&mut self, grade: Grade, (what, noun): (&str, &'static str), seen: Seen) {
        if seen.count == 0 {
            return;
        }
        match self.all.iter_mut().find(|f| f.0 == grade && f.1 == what) {
            Some(found) => found.2 = found.2.with(seen),
            None => self.all.push((grade, what.to_string(), seen, noun)),
        }
    }

    fn told(self) -> Vec<StateFinding> {
        let tell = |(grade, what, seen, noun): (Grade, String, Seen, &str)| {
            let count = match (seen.count, noun) {
                (_, "") => String::new(),
                (1, noun) => format!(" (1 {noun})"),
                (n, noun) => format!(" ({n} {noun}s)"),
            };
            StateFinding { line: seen.line, grade, what: what + &count }
        };
        let mut findings: Vec<StateFinding> = self.all.into_iter().map(tell).collect();
        findings.sort_by_key(|f| f.line);
        findings
    }
}

const FEED: &str = "feed move";
const MOVE: &str = "move";

impl Record {
    /// What is not as the job means it.
    #[must_use]
    pub fn conduct(&self, expected: &Expected) -> Conduct {
        let Some(dialect) = self.dialect else { return Conduct::default() };
        let judge = Judge { record: self, expected, dialect };
        let mut found = Found::default();
        let (mut blend_mm, mut blend_line) = (0.0, None);
        for used in &self.uses {
            let both = used.feed.with(used.plunge);
            judge.spindle(&used.control, used.feed, &mut found);
            judge.tool(&used.control, used.feed, &mut found);
            judge.length(&used.control, both, &mut found);
            judge.work_offset(&used.control, both, &mut found);
            judge.corners(&used.control, used.feed, &mut found);
            let width_mm = width_mm(&used.control);
            if used.feed.count > 0 && width_mm > blend_mm {
                (blend_mm, blend_line) = (width_mm, Some(used.feed.line));
            }
        }
        judge.rest(&mut found);
        Conduct { findings: found.told(), blend_mm, blend_line }
    }
}

/// What corners and smoothing leave of the way, as far as it is said.
fn width_mm(control: &Control) -> f64 {
    let corner_mm = if let Corner::Within(mm) = control.corner { mm } else { 0.0 };
    corner_mm + control.smoothing_mm.unwrap_or(0.0)
}

struct Judge<'a> {
    record: &'a Record,
    expected: &'a Expected,
    dialect: Dialect,
}

impl Judge<'_> {
    fn spindle(&self, control: &Control, feed: Seen, found: &mut Found) {
        let own = self.expected.tools.iter().find(|t| control.tool == Tool::Number(t.number));
        let wanted = own.and_then(|t| t.spindle_rpm).or(self.expected.spindle_rpm);
        let still = control.speed_rpm == Some(0.0);
        match control.spindle {
            Spindle::Clockwise if !still => {}
            Spindle::Counter if !still => {
                found.add(
                    Grade::Breaks,
                    ("the spindle turns the wrong way, counter-clockwise (M4)", FEED),
                    feed,
                );
            }
            _ if wanted.is_some() || self.record.spindle_started => {
                found.add(Grade::Breaks, ("the spindle does not turn", FEED), feed);
            }
            _ => found.add(
                Grade::Warning,
                ("the program does not start the spindle, and the job names no speed", FEED),
                feed,
            ),
        }
        let Some(wanted) = wanted else { return };
        match control.speed_rpm {
            None => found.add(
                Grade::Breaks,
                (
                    &format!(
                        "the speed of the spindle is not said: there is no S, the job has {wanted:.0} rpm"
                    ),
                    FEED,
                ),
                feed,
            ),
            Some(rpm) if (rpm - wanted).abs() > SPEED_SHARE * wanted => found.add(
                Grade::Breaks,
                (&format!("the spindle turns at {rpm:.0} rpm, the job has {wanted:.0} rpm"), FEED),
                feed,
            ),
            Some(_) => {}
        }
        let wet = match own.and_then(|t| t.coolant).or(self.expected.coolant) {
            None => true,
            Some(Coolant::Flood) => control.flood,
            Some(Coolant::Mist) => control.mist,
        };
        if !wet {
            found.add(Grade::Breaks, ("the job's coolant is off", FEED), feed);
        }
    }

    fn tool(&self, control: &Control, feed: Seen, found: &mut Found) {
        let tools = &self.expected.tools;
        if tools.is_empty() {
            return;
        }
        match control.tool {
            Tool::Number(n) if !tools.iter().any(|t| t.number == n) => {
                let what = format!("tool {n} is in the spindle, which is none of the job's");
                found.add(Grade::Breaks, (&what, FEED), feed);
            }
            Tool::Number(_) => {}
            Tool::Named => found.add(
                Grade::Warning,
                ("the tool is not called by a number: whether it is the job's is not known", FEED),
                feed,
            ),
            Tool::Unsaid => {
                let first = Seen { line: self.record.first_move, ..feed };
                found.add(Grade::Warning, ("which tool is in the spindle is not said", FEED), first);
            }
        }
        if control.tool_delta_mm > 0.0 {
            let what = format!(
                "the tool call adds {} mm to the tool's length or radius, which the job does not",
                control.tool_delta_mm
            );
            found.add(Grade::Breaks, (&what, FEED), feed);
        }
    }

    fn length(&self, control: &Control, moves: Seen, found: &mut Found) {
        let word = match self.dialect {
            // A tool call brings the tool's length.
            Dialect::Heidenhain => return,
            Dialect::Sinumerik => "D",
            Dialect::Fanuc | Dialect::LinuxCnc => "G43 H",
        };
        let wrong = |what: String, found: &mut Found| found.add(Grade::Breaks, (&what, MOVE), moves);
        match control.length {
            Length::Off => {
                wrong(format!("the tool's length is not applied: it is switched off ({word})"), found)
            }
            Length::Unsaid if self.dialect == Dialect::Sinumerik => found.add(
                Grade::Open,
                ("no D says which edge of the tool applies, which is then the machine's data", MOVE),
                moves,
            ),
            Length::Unsaid => wrong(format!("the tool's length is never applied: there is no {word}"), found),
            Length::On(None) if self.dialect == Dialect::Fanuc => {
                wrong("G43 without H applies no length".into(), found);
            }
            Length::On(None) => {}
            Length::On(Some(edge)) if self.dialect == Dialect::Sinumerik => {
                if edge != 1 {
                    wrong(format!("edge D{edge} of the tool applies, the job means D1"), found);
                }
            }
            Length::On(Some(h)) => {
                let right = match control.tool {
                    Tool::Number(n) => h == n,
                    _ => self.expected.tools.is_empty() || self.expected.tools.iter().any(|t| t.number == h),
                };
                if !right {
                    wrong(format!("the length of H{h} applies, which is not that of the tool"), found);
                }
            }
            Length::Measured(mm) => self.measured(control, mm, moves, found),
        }
    }

    fn measured(&self, control: &Control, mm: f64, moves: Seen, found: &mut Found) {
        let own = control.tool_number();
        let mut tools = self.expected.tools.iter().filter(|t| own.is_none_or(|n| t.number == n));
        if self.expected.tools.is_empty() {
            found.add(Grade::Open, ("a length that the program states (G43.1) applies", MOVE), moves);
        } else if !tools.any(|t| (t.length_mm - mm).abs() <= self.expected.tolerance_mm) {
            let what = format!("a length of {mm} mm applies (G43.1), which is not that of the tool");
            found.add(Grade::Breaks, (&what, MOVE), moves);
        }
    }

    fn work_offset(&self, control: &Control, moves: Seen, found: &mut Found) {
        let usual = WorkOffset::usual(self.dialect);
        let wanted = self.expected.work_offset.or(usual);
        let name = |w: Option<WorkOffset>| w.map_or("the active preset".to_string(), |w| w.to_string());
        match control.work_offset {
            got if got == wanted => {}
            None if wanted == usual => {
                let what = format!("no work offset is said, the job means {}", name(wanted));
                found.add(Grade::Warning, (&what, MOVE), moves);
            }
            got => {
                let got = got.map_or("no work offset".to_string(), |w| w.to_string());
                let what = format!("it moves in {got}, the job means {}", name(wanted));
                found.add(Grade::Breaks, (&what, MOVE), moves);
            }
        }
    }

    fn corners(&self, control: &Control, feed: Seen, found: &mut Found) {
        let bounded = control.smoothing_mm.is_some();
        match (control.corner, self.dialect) {
            (Corner::Unlimited, _) => {
                found.add(Grade::Open, ("G64 without P rounds corners by any amount", FEED), feed);
            }
            (Corner::Unsaid, Dialect::LinuxCnc) => {
                found.add(
                    Grade::Open,
                    ("how far corners are rounded is not said: no G64 P, no G61", FEED),
                    feed,
                );
            }
            (Corner::Machine, _) | (Corner::Unsaid, Dialect::Sinumerik | Dialect::Heidenhain) if !bounded => {
                found.add(
                    Grade::Warning,
                    ("how far corners are rounded is not said: the machine's data have it", FEED),
                    feed,
                );
            }
            _ => {}
        }
    }

    fn rest(&self, found: &mut Found) {
        let r = self.record;
        found.add(
            Grade::Open,
            ("blocks behind a slash are left out where the machine's switch is set", "block"),
            r.skipped,
        );
        found.add(Grade::Open, ("it feeds while where the machine stands is not known", FEED), r.nowhere);
        found.add(
            Grade::Warning,
            ("it feeds from a place that is not known to the first that is", FEED),
            r.from_nowhere,
        );
        let away =
            "an axis goes to a place of the machine that its file does not say (home_mm, machine_zero_mm)";
        found.add(Grade::Open, (away, ""), r.sent);
        found.add(Grade::Warning, (away, ""), r.sent_first);
        found.add(
            Grade::Warning,
            ("machine coordinates are taken from the joint's own zero: the machine file has no machine_zero_mm", ""),
            r.guessed,
        );
        for out in &r.beyond {
            let what = format!(
                "{} would have to go to {:.3}, beyond its travel of {}{}",
                out.letter,
                out.at,
                out.range,
                if out.slides { " at the spindle nose" } else { "" }
            );
            found.add(Grade::Breaks, (&what, MOVE), out.seen);
        }
        let tools = &self.expected.tools;
        let cuts = |n: u32| r.uses.iter().any(|u| u.feed.count > 0 && u.control.tool == Tool::Number(n));
        let strange = |n: u32| !tools.is_empty() && !tools.iter().any(|t| t.number == n) && !cuts(n);
        if let Some((number, line)) = r.selected.iter().find(|s| strange(s.0)) {
            let what = format!("tool {number} is selected, which is none of the job's");
            found.add(Grade::Warning, (&what, ""), Seen { line: *line, count: 1 });
        }
    }
}
