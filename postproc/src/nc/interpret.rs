//! A model of the control: blocks in, moves of the tool out.
//!
//! Modal words, units, the tool-centre-point switch, declarations of what F is read over. What is not understood is
//! refused or, if asked so, left out and reported; see [`super::readback`].

use osculate_geom::{Diagnostic, Unit3};
use osculate_tools::Pose;
use osculate_tools::cl::Motion;

use super::Dialect;
use super::readback::{ReadBack, ReadBlock, ReadError, ReadMove, ReadOptions};
use super::state::{FeedReading, Group, Known, State};
use super::token::{BadWord, Manner, Word, words};
use super::way::{Arc, ArcWords, Way};
use crate::feed::Step;
use crate::machine::{JointValues, Machine, nearest_turn};
use crate::motion::rapid_time_min;
use crate::setup::Setup;

/// The control, its machine, and what has come out so far.
pub(super) struct Interpreter<'a> {
    dialect: Dialect,
    machine: &'a Machine,
    setup: &'a Setup,
    options: &'a ReadOptions,
    state: State,
    out: ReadBack,
}

/// What one line asks for, once all its words are seen.
#[derive(Default)]
struct Asked {
    /// Axis words.
    axes: Vec<(String, f64, Manner)>,
    /// Positions are the machine's own.
    machine_frame: bool,
    /// A word that makes the axis words of the line something other than a move.
    other_use: bool,
    klartext_move: bool,
    rapid_once: bool,
    /// I, J, K and R (or CR), mm.
    centre: [Option<f64>; 3],
    radius: Option<f64>,
    end: bool,
}

impl<'a> Interpreter<'a> {
    pub fn new(dialect: Dialect, machine: &'a Machine, setup: &'a Setup, options: &'a ReadOptions) -> Self {
        Self { dialect, machine, setup, options, state: State::new(), out: ReadBack::default() }
    }

    /// Works through a whole text.
    pub fn run(mut self, text: &str) -> Result<ReadBack, ReadError> {
        self.rest_unnamed(text);
        for (number, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
            let number = number + 1;
            match words(line, self.dialect) {
                Ok(words) => {
                    if self.line(number, &words)? {
                        break;
                    }
                }
                Err(BadWord(text)) if self.options.strict => {
                    return Err(ReadError::Syntax { line: number, text });
                }
                Err(BadWord(text)) => self.lost(number, &text),
            }
        }
        Ok(self.out)
    }

    /// An axis that the text never names stays where it is; it is taken to be at zero, and the reader says so.
    fn rest_unnamed(&mut self, text: &str) {
        let mut named = std::collections::BTreeSet::new();
        for word in text.lines().filter_map(|l| words(l, self.dialect).ok()).flatten() {
            if let Word::Address { name, .. } = word {
                named.insert(name);
            }
        }
        let mut rest = |slot: &mut Option<f64>, place: usize| {
            let letter = &self.machine.joints()[place].letter;
            if !named.contains(letter) {
                *slot = Some(0.0);
                let text = format!("axis {letter} is never named: it is taken to stand at zero");
                self.out.diagnostics.push(Diagnostic::warning("program", text));
            }
        };
        for (slot, place) in self.state.rotary.iter_mut().zip(self.machine.rotary()) {
            rest(slot, *place);
        }
        for (slot, place) in self.state.linear.iter_mut().zip(self.machine.linear()) {
            rest(slot, place);
        }
    }

    fn lost(&mut self, line: usize, word: &str) {
        let text = format!("{word} is not interpreted and may change the tool's way");
        self.out.diagnostics.push(Diagnostic::loss(format!("line {line}"), text));
    }

    fn refuse(&mut self, line: usize, word: &str) -> Result<(), ReadError> {
        if self.options.strict {
            return Err(ReadError::Word { line, word: word.into() });
        }
        self.lost(line, word);
        Ok(())
    }

    /// Works through one line; true at the end of the program.
    fn line(&mut self, line: usize, words: &[Word]) -> Result<bool, ReadError> {
        let mut asked = Asked::default();
        for word in words {
            match word {
                Word::G(code) => self.g(line, *code, &mut asked)?,
                Word::M(code) => self.m(line, *code, &mut asked)?,
                Word::F(f) => self.state.feed = Some(*f),
                Word::S(s) => {
                    self.state.speed = Some(*s);
                    self.out.spindle_rpm = self.out.spindle_rpm.or(Some(*s));
                }
                Word::Address { name, value, manner } => {
                    self.address(line, name, (*value, *manner), &mut asked)?
                }
                Word::Name { name, arguments } => self.name(line, name, arguments, &mut asked)?,
            }
        }
        let circles = self.state.clockwise.is_some() && asked.centre.iter().any(Option::is_some);
        if (circles || !asked.axes.is_empty()) && !asked.other_use {
            self.go(line, &asked)?;
        }
        Ok(asked.end)
    }

    fn g(&mut self, line: usize, code: i64, asked: &mut Asked) -> Result<(), ReadError> {
        let s = &mut self.state;
        match code {
            0 | 10 => {
                s.rapid = Some(code == 0);
                s.clockwise = None;
            }
            20 | 30 => {
                s.rapid = Some(false);
                s.clockwise = Some(code == 20);
            }
            170 => s.plane = ["X", "Y"],
            180 => s.plane = ["Z", "X"],
            190 => s.plane = ["Y", "Z"],
            // A dwell's words are times.
            40 => asked.other_use = true,
            200 | 700 | 7000 => s.unit_mm = 25.4,
            210 | 710 | 7100 => s.unit_mm = 1.0,
            900 => s.absolute = true,
            910 => s.absolute = false,
            930 => self.reading(FeedReading::Inverse),
            940 => self.reading(FeedReading::PerMinute),
            950 => self.reading(FeedReading::PerTurn),
            434 => s.switch_tcp(true, self.machine, self.setup),
            490 | 430 => s.switch_tcp(false, self.machine, self.setup),
            530 if self.dialect != Dialect::Sinumerik => asked.machine_frame = true,
            // Planes, compensations off, offsets, path modes, exact stop.
            90 | 400 | 540 | 600 | 601 | 610 | 640 | 641..=645 | 800 | 6010 | 6020 => {}
            _ => return self.refuse(line, &format!("G{}", code as f64 / 10.0)),
        }
        Ok(())
    }

    /// Switching between G93, G94 and G95 makes the control forget F.
    fn reading(&mut self, reading: FeedReading) {
        if self.state.reading != reading {
            self.state.reading = reading;
            self.state.feed = None;
        }
    }

    fn m(&mut self, line: usize, code: i64, asked: &mut Asked) -> Result<(), ReadError> {
        let word = format!("M{code}");
        if let Some(switch) =
            self.machine.control().linuxcnc_tcp.as_ref().filter(|_| self.dialect == Dialect::LinuxCnc)
        {
            for (name, on) in [(&switch.on, true), (&switch.off, false)] {
                if *name == word {
                    self.state.switch_tcp(on, self.machine, self.setup);
                    return Ok(());
                }
            }
        }
        match (code, self.dialect) {
            (2 | 17 | 30, _) => asked.end = true,
            (0 | 1 | 3..=9, _) | (126, Dialect::Heidenhain) => {}
            (91, Dialect::Heidenhain) => asked.machine_frame = true,
            (128, Dialect::Heidenhain) => self.state.switch_tcp(true, self.machine, self.setup),
            (129, Dialect::Heidenhain) => self.state.switch_tcp(false, self.machine, self.setup),
            _ => return self.refuse(line, &word),
        }
        Ok(())
    }

    fn address(
        &mut self,
        line: usize,
        name: &str,
        given: (f64, Manner),
        asked: &mut Asked,
    ) -> Result<(), ReadError> {
        let is_axis = self.machine.joint_named(name).is_some() || matches!(name, "X" | "Y" | "Z");
        if is_axis {
            asked.axes.push((name.to_string(), given.0, given.1));
            return Ok(());
        }
        if let Some(letter) = name.strip_prefix("FGREF[").and_then(|n| n.strip_suffix(']')) {
            if self.machine.joint_named(letter).is_none() {
                return self.refuse(line, name);
            }
            let group = self.state.group.get_or_insert_with(Group::default);
            if group.radius_mm.is_some_and(|r| (r - given.0).abs() > 1e-9 * r) {
                return self.refuse(line, "FGREF with different radii");
            }
            group.radius_mm = Some(given.0);
            return Ok(());
        }
        match name {
            "I" => asked.centre[0] = Some(given.0 * self.state.unit_mm),
            "J" => asked.centre[1] = Some(given.0 * self.state.unit_mm),
            "K" => asked.centre[2] = Some(given.0 * self.state.unit_mm),
            "R" | "CR" => asked.radius = Some(given.0 * self.state.unit_mm),
            "N" | "O" | "T" | "D" | "H" | "P" | "Q" | "L" => {}
            _ => return self.refuse(line, name),
        }
        Ok(())
    }

    fn name(&mut self, line: usize, name: &str, arguments: &str, asked: &mut Asked) -> Result<(), ReadError> {
        let klartext = self.dialect == Dialect::Heidenhain;
        match name {
            "TRAORI" => self.state.switch_tcp(true, self.machine, self.setup),
            "TRAFOOF" => self.state.switch_tcp(false, self.machine, self.setup),
            "SUPA" => asked.machine_frame = true,
            "FGROUP" => {
                let letters =
                    arguments.split(',').map(|l| l.trim().to_ascii_uppercase()).filter(|l| !l.is_empty());
                let group = self.state.group.get_or_insert_with(Group::default);
                group.letters = letters.collect();
                if group.letters.is_empty() {
                    self.state.group = None;
                }
            }
            "ORIMKS" | "ORIAXES" | "MSG" | "FNORM" | "FFWON" | "FFWOF" | "SOFT" | "BRISK" | "COMPOF"
            | "T" => {}
            "L" if klartext => asked.klartext_move = true,
            "R0" | "TOOL" if klartext => {}
            "FMAX" if klartext => asked.rapid_once = true,
            "FUNCTION" if klartext && arguments == "RESET TCPM" => {
                self.state.switch_tcp(false, self.machine, self.setup);
            }
            "FUNCTION" if klartext && arguments.starts_with("TCPM F TCP AXIS POS PATHCTRL AXIS") => {
                self.state.switch_tcp(true, self.machine, self.setup);
            }
            "BEGIN" if klartext => self.state.unit_mm = if arguments.ends_with("INCH") { 25.4 } else { 1.0 },
            "END" if klartext => asked.end = true,
            _ => return self.refuse(line, format!("{name} {arguments}").trim()),
        }
        Ok(())
    }

    fn go(&mut self, line: usize, asked: &Asked) -> Result<(), ReadError> {
        if self.dialect == Dialect::Heidenhain {
            if !asked.klartext_move {
                return self.refuse(line, "a position without L");
            }
            self.state.rapid = Some(asked.rapid_once);
        }
        let before = self.state.known(self.machine);
        for (name, value, manner) in &asked.axes {
            self.position(line, name, (*value, *manner), asked.machine_frame)?;
        }
        if asked.machine_frame {
            // The linear axes go to places of the machine's own frame, which the text does not relate to the part:
            // `position` has made them unknown.
            return Ok(());
        }
        let Some(known) = self.state.known(self.machine) else { return Ok(()) };
        let to = known.joints(self.machine, self.setup).ok_or(ReadError::Flat { line })?;
        let rapid = match self.state.rapid {
            Some(rapid) => rapid,
            None => return Err(ReadError::NoFeed { line, what: "G0 or G1 before it" }),
        };
        let Some(from) = before else {
            self.first(line, &known, &to);
            return Ok(());
        };
        let arc = match self.state.clockwise.filter(|_| self.dialect != Dialect::Heidenhain) {
            Some(clockwise) => Some(self.arc(line, &from, &known, (clockwise, asked))?),
            None => None,
        };
        self.moved(line, &Way { from, to: known, arc }, (to, rapid))
    }

    fn arc(&self, line: usize, from: &Known, to: &Known, asked: (bool, &Asked)) -> Result<Arc, ReadError> {
        let (clockwise, asked) = asked;
        let names = self.linear_names();
        let mut words = ArcWords { clockwise, plane: [0; 2], centre_mm: [None; 2], radius_mm: asked.radius };
        for (k, name) in self.state.plane.into_iter().enumerate() {
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

    /// Names of the linear words now in force, by slot.
    fn linear_names(&self) -> [&str; 3] {
        if self.state.tcp {
            ["X", "Y", "Z"]
        } else {
            self.machine.linear().map(|place| self.machine.joints()[place].letter.as_str())
        }
    }

    fn position(
        &mut self,
        line: usize,
        name: &str,
        given: (f64, Manner),
        machine_frame: bool,
    ) -> Result<(), ReadError> {
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
                (true, None) => return Err(ReadError::Increment { line, axis: name.into() }),
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
        s.linear[slot] = match (machine_frame, incremental, s.linear[slot]) {
            (true, ..) => None,
            (false, true, None) => return Err(ReadError::Increment { line, axis: name.into() }),
            (false, true, Some(before)) => Some(before + mm),
            (false, false, _) => Some(mm),
        };
        Ok(())
    }

    fn first(&mut self, line: usize, known: &Known, joints: &JointValues) {
        let pose = self.pose(known);
        self.out.moves.push(ReadMove { pose, motion: Motion::Rapid, line, time_min: 0.0 });
        let (from, to) = (*joints, *joints);
        self.out.blocks.push(ReadBlock { line, from, to, rapid: true, time_min: 0.0, tip_length_mm: 0.0 });
    }

    fn moved(&mut self, line: usize, way: &Way, end: (JointValues, bool)) -> Result<(), ReadError> {
        let (joints, rapid) = end;
        let before = way.from.joints(self.machine, self.setup).ok_or(ReadError::Flat { line })?;
        let step = way.step();
        if step == Step::default() {
            return Ok(());
        }
        let time_min = if rapid {
            rapid_time_min(self.machine, &before, &joints).0
        } else {
            let what = match (self.state.feed, self.state.reading) {
                (Some(_), FeedReading::PerTurn) => "S",
                _ => "an F above zero",
            };
            let t = self.state.duration_min(self.machine, &step);
            t.ok_or(ReadError::NoFeed { line, what })?
        };
        if self.state.reading == FeedReading::Inverse {
            // G93's F holds for its own block.
            self.state.feed = None;
        }
        let poses = way.densified(&|k| self.pose(k), [self.options.tip_tol_mm, self.options.axis_tol_rad]);
        let mut tip_length_mm = 0.0;
        let mut at = self.pose(&way.from).tip;
        for (_, pose) in &poses {
            tip_length_mm += (pose.tip - at).norm();
            at = pose.tip;
        }
        let motion = match (rapid, self.state.feed) {
            (true, _) => Motion::Rapid,
            (false, Some(f)) if tip_length_mm == 0.0 => Motion::Feed(f),
            (false, _) if tip_length_mm == 0.0 => Motion::Feed(1.0 / time_min),
            (false, _) => Motion::Feed(tip_length_mm / time_min),
        };
        let mut t0 = 0.0;
        for (t, pose) in poses {
            self.out.moves.push(ReadMove { pose, motion, line, time_min: time_min * (t - t0) });
            t0 = t;
        }
        self.out.blocks.push(ReadBlock { line, from: before, to: joints, rapid, time_min, tip_length_mm });
        Ok(())
    }

    fn pose(&self, known: &Known) -> Pose {
        if !known.tcp {
            let joints = known.joints(self.machine, self.setup).unwrap_or_default();
            return self.machine.forward(&joints, self.setup);
        }
        let axis = self.machine.axis_at(&known.rotary);
        let back = self.setup.part_zero.rotation.inverse();
        Pose {
            tip: self.setup.from_program(&known.linear.into()),
            axis: Unit3::new_normalize(back * axis.into_inner()),
        }
    }
}
