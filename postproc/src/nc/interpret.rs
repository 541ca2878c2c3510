//! A model of the control: blocks in, moves out, a line at a time.
//!
//! [`super::codes`] knows what the words mean; here lines become moves. What is not understood is refused or, if
//! asked so, left out and reported; see [`super::readback`].

use std::collections::BTreeSet;

use osculate_geom::{Diagnostic, Unit3, Vec3};

use super::Dialect;
use super::asked::{Asked, PathWord};
use super::control::{Control, Kind, Record, Tool};
use super::event::{Event, FeedNow, Frame, Moved, Sink};
use super::read_error::ReadError;
use super::sections::Sections;
use super::state::{FeedReading, Known, State};
use super::token::{BadWord, Manner, Word, words};
use super::way::{Arc, ArcWords, Way};
use crate::feed::Step;
use crate::machine::{Beyond, JointValues, Machine, NearWish, nearest_turn};
use crate::motion::linuxcnc::PathControl;
use crate::setup::Setup;

/// Losses that are listed one by one; further ones are counted.
const LISTED: usize = 10_000;

/// Travel is looked at whenever a block has turned by this, rad: between two looks a slide is off their line by less than 0.0004 of the radius.
const LOOK_RAD: f64 = 0.05;
/// Looks along a block at most: 32 turns.
const MOST_LOOKS: f64 = 4096.0;

/// The control, its machine, and what has come out so far.
pub(super) struct Interpreter<'a, S> {
    pub(super) dialect: Dialect,
    pub(super) machine: &'a Machine,
    pub(super) setup: Setup,
    /// Gauge lengths of tools by their numbers, mm; that of the setup for all others.
    pub(super) lengths: Vec<(u32, f64)>,
    /// The setup's own gauge length, mm.
    pub(super) gauge_length_mm: f64,
    strict: bool,
    pub(super) state: State,
    pub sink: S,
    pub diagnostics: Vec<Diagnostic>,
    pub spindle_rpm: Option<f64>,
    /// Losses that are only counted, with the first and the last line of them.
    unlisted: (usize, usize, usize),
    pub(super) sections: Sections,
    /// The sink knows where the machine stands.
    pub(super) placed: bool,
    /// The state beside the way.
    pub(super) control: Control,
    pub(super) record: Record,
    /// The tool that the next change puts into the spindle.
    pub(super) selected: Option<Tool>,
}

impl<'a, S: Sink> Interpreter<'a, S> {
    pub fn new(dialect: Dialect, frame: Frame<'a>, strict: bool, sink: S) -> Self {
        Self {
            dialect,
            machine: frame.machine,
            setup: *frame.setup,
            lengths: Vec::new(),
            gauge_length_mm: frame.setup.gauge_length_mm,
            strict,
            state: State::new(dialect),
            sink,
            diagnostics: Vec::new(),
            spindle_rpm: None,
            unlisted: (0, 0, 0),
            sections: Sections::default(),
            placed: false,
            control: Control::default(),
            record: Record { dialect: Some(dialect), ..Record::default() },
            selected: None,
        }
    }

    /// Works through one line, counted from 1; true at the end of the program.
    pub(super) fn program_line(&mut self, number: usize, line: &str) -> Result<bool, ReadError> {
        let line = if number == 1 { line.trim_start_matches('\u{feff}') } else { line };
        match words(line, self.dialect) {
            Ok(words) => self.line(number, &words),
            Err(BadWord(text)) if self.strict => Err(ReadError::Syntax { line: number, text }),
            Err(BadWord(text)) => {
                self.lost(number, &text);
                Ok(false)
            }
        }
    }

    /// The end of the text: what was only counted is said.
    pub fn end(&mut self) -> Result<(), ReadError> {
        self.close_sections()?;
        self.tell(&Event::Halt);
        let (count, first, last) = self.unlisted;
        if count > 0 {
            let text = format!("{count} more words are not interpreted and may change the tool's way");
            self.diagnostics.push(Diagnostic::loss(format!("lines {first} to {last}"), text));
        }
        Ok(())
    }

    /// An axis that the text never names stays where it is; it is taken to be at zero, and the reader says so.
    pub fn rest_unnamed(&mut self, named: &BTreeSet<String>) {
        let vector = ["A3", "B3", "C3", "TX", "TY", "TZ"].iter().any(|n| named.contains(*n));
        let mut rest = |slot: &mut Option<f64>, place: usize, rotary: bool| {
            let letter = &self.machine.joints()[place].letter;
            if !(named.contains(letter) || rotary && vector) {
                *slot = Some(0.0);
                let text = format!("axis {letter} is never named: it is taken to stand at zero");
                self.diagnostics.push(Diagnostic::warning("program", text));
            }
        };
        for (slot, place) in self.state.rotary.iter_mut().zip(self.machine.rotary()) {
            rest(slot, *place, true);
        }
        for (slot, place) in self.state.linear.iter_mut().zip(self.machine.linear()) {
            rest(slot, place, false);
        }
    }

    pub(super) fn tell(&mut self, event: &Event<'_>) {
        let frame = Frame { machine: self.machine, setup: &self.setup };
        self.sink.take(frame, event);
    }

    pub(super) fn lost(&mut self, line: usize, word: &str) {
        if self.diagnostics.len() >= LISTED {
            let (count, first, _) = self.unlisted;
            self.unlisted = (count + 1, if count == 0 { line } else { first }, line);
            return;
        }
        let text = format!("{word} is not interpreted and may change the tool's way");
        self.diagnostics.push(Diagnostic::loss(format!("line {line}"), text));
    }

    /// An error where the reader is strict, else a loss.
    fn or_lost(&mut self, error: ReadError, line: usize, what: &str) -> Result<(), ReadError> {
        if self.strict {
            return Err(error);
        }
        self.lost(line, what);
        Ok(())
    }

    /// F, dwells and path control of a line, once all its words are seen.
    fn settle(&mut self, asked: &Asked) {
        if asked.dwell {
            let min = match (self.dialect, asked.p, asked.f) {
                // Fanuc's P counts milliseconds.
                (Dialect::Fanuc, Some(p), _) => p / 60_000.0,
                (_, Some(s), _) | (Dialect::Sinumerik, None, Some(s)) => s / 60.0,
                _ => asked.axes.iter().find(|a| a.0 == "X" || a.0 == "U").map_or(0.0, |a| a.1 / 60.0),
            };
            if min.is_finite() && min > 0.0 {
                self.tell(&Event::Dwell(min));
            }
            return;
        }
        if let Some(f) = asked.f {
            self.state.feed = Some(f);
            self.state.feed_unit_mm = self.state.unit_mm;
        }
        if let Some(path) = asked.path {
            let unit = self.state.unit_mm;
            let tolerance_mm = asked.p.unwrap_or(0.0).max(0.0) * unit;
            let join_mm = asked.q.map_or(tolerance_mm, |q| q.max(0.0) * unit);
            self.tell(&Event::Path(match path {
                PathWord::ExactPath => PathControl::ExactPath,
                PathWord::ExactStop => PathControl::ExactStop,
                PathWord::Blend => PathControl::Blend { tolerance_mm, join_mm },
            }));
        }
    }

    pub(super) fn refuse(&mut self, line: usize, word: &str) -> Result<(), ReadError> {
        if self.strict {
            return Err(ReadError::Word { line, word: word.into() });
        }
        self.lost(line, word);
        Ok(())
    }

    pub(super) fn spindle_speed(&mut self, rpm: f64) {
        self.state.speed = Some(rpm);
        self.spindle_rpm = self.spindle_rpm.or(Some(rpm));
    }

    /// Works through one line; true at the end of the program.
    fn line(&mut self, line: usize, words: &[Word]) -> Result<bool, ReadError> {
        let mut asked = Asked::default();
        for word in words {
            match word {
                Word::G(code) => self.g(line, *code, &mut asked)?,
                Word::M(code) => self.m(line, *code, &mut asked)?,
                Word::F(f) => asked.f = Some(*f),
                Word::S(s) => self.spindle_speed(*s),
                Word::Address { name, value, manner } => {
                    self.address(line, name, (*value, *manner), &mut asked)?
                }
                Word::Name { name, arguments } => self.name(line, name, arguments, &mut asked)?,
                Word::Skip => asked.skipped = true,
            }
            asked.acts |= word.acts();
        }
        if asked.frames_deleted && !asked.axes.is_empty() {
            return self.refuse(line, "TRANS with axes").map(|()| false);
        }
        self.settle(&asked);
        self.settle_control(line, &asked);
        if asked.plane {
            self.g68_2(line, &asked)?;
            return Ok(false);
        }
        if asked.turn_to_plane {
            self.turn_to_plane(line)?;
        }
        if self.state.vectors && self.state.clockwise.is_none() {
            // Read as centres they have been scaled.
            let unit = self.state.unit_mm;
            asked.vector = std::mem::take(&mut asked.centre).map(|c| c.map(|c| c / unit));
        }
        let circles = self.state.clockwise.is_some() && asked.centre.iter().any(Option::is_some);
        let turns = asked.vector.iter().any(Option::is_some);
        if (circles || turns || !asked.axes.is_empty()) && !(asked.other_use || asked.dwell) {
            self.go(line, &asked)?;
        }
        if asked.home {
            self.go_home(line, &asked)?;
        }
        if asked.end {
            self.tell(&Event::Halt);
        }
        Ok(asked.end)
    }

    fn go(&mut self, line: usize, asked: &Asked) -> Result<(), ReadError> {
        if self.dialect == Dialect::Heidenhain {
            if !asked.klartext_move {
                return self.refuse(line, "a position without L");
            }
            self.state.rapid = Some(asked.rapid_once);
        }
        if asked.machine_frame || asked.builders_place {
            return self.go_in_own_frame(line, asked);
        }
        let before = self.state.known(self.machine);
        for (name, value, manner) in &asked.axes {
            // By way of a place that is not known there is nothing to be lost.
            if before.is_some() || !asked.home {
                self.position(line, name, (*value, *manner))?;
            }
        }
        if asked.vector.iter().any(Option::is_some) {
            self.point(line, &asked.vector)?;
        }
        let rapid = asked.home.then_some(true);
        self.arrive(line, (before, self.state.known(self.machine)), (rapid, asked))
    }

    /// Rapid or feed, as the word in force says.
    pub(super) fn rapid(&mut self, line: usize) -> Result<bool, ReadError> {
        if let Some(rapid) = self.state.rapid {
            return Ok(rapid);
        }
        let error = ReadError::NoFeed { line, what: "G0 or G1 before it" };
        self.or_lost(error, line, "a move before any G0 or G1")?;
        Ok(true)
    }

    /// A move from one place to another, as far as they are known.
    pub(super) fn arrive(
        &mut self,
        line: usize,
        (before, to): (Option<Known>, Option<Known>),
        (rapid, asked): (Option<bool>, &Asked),
    ) -> Result<(), ReadError> {
        let Some(known) = to else {
            if rapid.or(self.state.rapid) == Some(false) {
                self.record.nowhere.again(line);
            }
            return Ok(());
        };
        let joints = known.joints(self.machine, &self.setup).ok_or(ReadError::Flat { line })?;
        let rapid = match rapid {
            Some(rapid) => rapid,
            None => self.rapid(line)?,
        };
        let own = asked.machine_frame || asked.builders_place || asked.home;
        let Some(from) = before.filter(|_| self.placed) else {
            self.placed = true;
            self.look_at_travel(line, self.machine.out_of_limits(&joints, self.setup.gauge_length_mm));
            if !rapid {
                self.record.from_nowhere.again(line);
            }
            let plunges = !own && asked.axes.iter().any(|a| a.0 == "Z");
            self.record.moved(line, Kind::of(rapid, plunges), &self.control);
            let tool = self.control.tool_number();
            self.tell(&Event::Placed { line, known, joints, tool });
            return Ok(());
        };
        let arc = match self.state.clockwise.filter(|_| self.dialect != Dialect::Heidenhain && !rapid) {
            Some(clockwise) => match self.arc(line, &from, &known, (clockwise, asked)) {
                Ok(arc) => Some(arc),
                Err(error) => {
                    self.or_lost(error, line, "an arc whose ends lie on no common circle (taken as a line)")?;
                    None
                }
            },
            None => None,
        };
        let way = Way { from, to: known, arc };
        self.look_at_travel(line, self.farthest_out(&way, &joints));
        if way.step() != Step::default() {
            let z = self.linear_names().iter().position(|n| *n == "Z");
            let plunges = !own && z.is_some_and(|z| from.linear[z] != known.linear[z]);
            self.record.moved(line, Kind::of(rapid, plunges), &self.control);
        }
        self.moved(line, &way, (joints, rapid, own))
    }

    fn look_at_travel(&mut self, line: usize, out: Option<Beyond>) {
        if let Some(out) = out {
            self.record.outside(line, &self.machine.joints()[out.place], &out);
        }
    }

    /// The joint that is farthest out of its range along a way: while the tool turns or goes round, slides are elsewhere between the ends.
    fn farthest_out(&self, way: &Way, end: &JointValues) -> Option<Beyond> {
        let length_mm = self.setup.gauge_length_mm;
        let pieces = (way.turned_rad() / LOOK_RAD).ceil().clamp(1.0, MOST_LOOKS) as u32;
        let between = (1..pieces).filter_map(|k| {
            let joints = way.at(f64::from(k) / f64::from(pieces)).joints(self.machine, &self.setup)?;
            self.machine.out_of_limits(&joints, length_mm)
        });
        let all = between.chain(self.machine.out_of_limits(end, length_mm));
        all.max_by(|a, b| a.by.total_cmp(&b.by))
    }

    fn arc(&self, line: usize, from: &Known, to: &Known, asked: (bool, &Asked)) -> Result<Arc, ReadError> {
        let (clockwise, asked) = asked;
        let names = self.linear_names();
        let mut words = ArcWords { clockwise, plane: [0; 2], centre_mm: [None; 2], radius_mm: asked.radius };
        for (k, name) in self.state.arc_plane.into_iter().enumerate() {
            let slot = names.iter().position(|n| *n == name);
            words.plane[k] =
                slot.ok_or_else(|| ReadError::Word { line, word: format!("an arc in {name}") })?;
            let letter = ["X", "Y", "Z"].iter().position(|n| *n == name);
            words.centre_mm[k] = letter.and_then(|l| asked.centre[l]);
        }
        if words.radius_mm.is_none() && words.centre_mm == [None; 2] {
            return Err(ReadError::Word { line, word: "an arc without centre or radius".into() });
        }
        Arc::new(from, to, &words).map_err(|off_mm| ReadError::Arc { line, off_mm })
    }

    /// The tool's direction, in the axes of X Y Z. The control turns the rotary axes there by the
    /// nearest way.
    fn point(&mut self, line: usize, vector: &[Option<f64>; 3]) -> Result<(), ReadError> {
        let v = Vec3::new(vector[0].unwrap_or(0.0), vector[1].unwrap_or(0.0), vector[2].unwrap_or(0.0));
        let v = self.state.plane.map_or(v, |plane| plane.rotation * v);
        let axis = Unit3::try_new(v, 1e-6).filter(|_| self.state.tcp);
        let near = self.state.rotary.map(|q| q.unwrap_or(0.0));
        let wish = NearWish { rotary_rad: near, cone_rad: 0.0 };
        match axis.and_then(|axis| self.machine.rotary_near(&axis, &wish).ok()) {
            Some(rotary) => {
                self.state.rotary = rotary.map(Some);
                Ok(())
            }
            None => self.refuse(
                line,
                "a tool direction that the machine does not reach, or without tool-centre-point control,",
            ),
        }
    }

    fn lost_increment(&mut self, line: usize, name: &str) -> Result<(), ReadError> {
        let error = ReadError::Increment { line, axis: name.into() };
        self.or_lost(error, line, &format!("an increment of {name} from an unknown place"))
    }

    /// Names of the linear words now in force, by slot.
    fn linear_names(&self) -> [&str; 3] {
        if self.state.of_tip() {
            ["X", "Y", "Z"]
        } else {
            self.machine.linear().map(|place| self.machine.joints()[place].letter.as_str())
        }
    }

    fn position(&mut self, line: usize, name: &str, given: (f64, Manner)) -> Result<(), ReadError> {
        let s = &mut self.state;
        let (value, manner) = given;
        let incremental = manner == Manner::Incremental || (manner == Manner::Modal && !s.absolute);
        let place = self.machine.joint_named(name);
        let rotary = place.and_then(|p| self.machine.rotary().iter().position(|r| *r == p));
        if let (Some(slot), Some(place)) = (rotary, place) {
            let angle = value.to_radians();
            let endless = self.machine.joints()[place].is_endless();
            let before = s.rotary[slot];
            s.rotary[slot] = Some(match (incremental, before) {
                (true, None) => return self.lost_increment(line, name),
                (true, Some(b)) => b + angle,
                (false, Some(b))
                    if manner == Manner::Shortest || (endless && self.dialect != Dialect::LinuxCnc) =>
                {
                    nearest_turn(angle, b)
                }
                (false, _) => angle,
            });
            return Ok(());
        }
        let slot = self.linear_names().iter().position(|n| *n == name);
        let Some(slot) = slot else { return self.refuse(line, name) };
        let s = &mut self.state;
        let mm = value * s.unit_mm;
        s.linear[slot] = match (incremental, s.linear[slot]) {
            (true, None) => return self.lost_increment(line, name),
            (true, Some(before)) => Some(before + mm),
            (false, _) => Some(mm),
        };
        Ok(())
    }

    /// A move along a way; nothing where it leads nowhere.
    fn moved(&mut self, line: usize, way: &Way, end: (JointValues, bool, bool)) -> Result<(), ReadError> {
        let (to, mut rapid, own_frame) = end;
        let from = way.from.joints(self.machine, &self.setup).ok_or(ReadError::Flat { line })?;
        let step = way.step();
        if step == Step::default() {
            return Ok(());
        }
        let mut time_min = 0.0;
        if !rapid {
            match self.state.duration_min(self.machine, &step) {
                Some(t) => time_min = t,
                None => {
                    let what = match (self.state.feed, self.state.reading) {
                        (Some(_), FeedReading::PerTurn) => "S",
                        _ => "an F above zero",
                    };
                    let error = ReadError::NoFeed { line, what };
                    self.or_lost(error, line, &format!("a feed move without {what} (taken as rapid)"))?;
                    rapid = true;
                }
            }
        }
        let s = &self.state;
        let (reading, unit_mm, speed_rpm) = (s.reading, s.feed_unit_mm, s.speed);
        let feed = s.feed.filter(|_| !rapid).map(|value| FeedNow { reading, value, unit_mm, speed_rpm });
        if reading == FeedReading::Inverse && !rapid {
            // G93's F holds for its own block.
            self.state.feed = None;
        }
        let tool = self.control.tool_number();
        self.tell(&Event::Moved(&Moved {
            line,
            way: *way,
            from,
            to,
            rapid,
            feed,
            time_min,
            tool,
            own_frame,
        }));
        Ok(())
    }
}
