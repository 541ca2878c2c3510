//! What the words of the dialects mean to the control.

use super::Dialect;
use super::asked::{Asked, LengthWord, PathWord};
use super::control::{Corner, Spindle, Tool};
use super::event::{Event, Sink};
use super::interpret::Interpreter;
use super::read_error::ReadError;
use super::state::{FeedReading, Group};
use super::token::Manner;
use super::work_offset::WorkOffset;

impl<S: Sink> Interpreter<'_, S> {
    fn switch(&mut self, on: bool) {
        if self.state.tcp != on {
            self.state.switch_tcp(on, self.machine, &self.setup);
            self.tell(&Event::Halt);
        }
    }

    pub(super) fn g(&mut self, line: usize, code: i64, asked: &mut Asked) -> Result<(), ReadError> {
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
            170 => s.arc_plane = ["X", "Y"],
            180 => s.arc_plane = ["Z", "X"],
            190 => s.arc_plane = ["Y", "Z"],
            // A dwell's words are times.
            40 => asked.dwell = true,
            200 | 700 | 7000 => s.unit_mm = 25.4,
            210 | 710 | 7100 => s.unit_mm = 1.0,
            900 => s.absolute = true,
            910 => s.absolute = false,
            930 => self.reading(FeedReading::Inverse),
            940 => self.reading(FeedReading::PerMinute),
            950 => self.reading(FeedReading::PerTurn),
            434 | 435 if self.dialect == Dialect::Fanuc => {
                asked.length = Some(LengthWord::On);
                s.vectors = code == 435;
                self.switch(true);
            }
            430 | 490 if matches!(self.dialect, Dialect::Fanuc | Dialect::LinuxCnc) => {
                asked.length = Some(if code == 430 { LengthWord::On } else { LengthWord::Off });
                // LinuxCNC's kinematics have words of their own.
                if self.dialect == Dialect::Fanuc {
                    s.vectors = false;
                    self.switch(false);
                }
            }
            431 if self.dialect == Dialect::LinuxCnc => {
                asked.length = Some(LengthWord::Measured);
                asked.other_use = true;
            }
            280 | 300 if matches!(self.dialect, Dialect::Fanuc | Dialect::LinuxCnc) => asked.home = true,
            682 if self.dialect == Dialect::Fanuc => asked.plane = true,
            531 if self.dialect == Dialect::Fanuc => asked.turn_to_plane = true,
            690 if self.dialect == Dialect::Fanuc => self.level(),
            921 if self.dialect == Dialect::LinuxCnc => {}
            530 => asked.machine_frame = true,
            1530 if self.dialect == Dialect::Sinumerik => asked.machine_frame = true,
            600 | 610 => asked.path = Some(PathWord::ExactPath),
            90 | 611 | 601 => asked.path = Some(PathWord::ExactStop),
            640 => asked.path = Some(PathWord::Blend),
            6410 | 6420 | 6430 | 6440 | 6450 if self.dialect == Dialect::Sinumerik => {
                asked.path = Some(PathWord::Blend);
            }
            // Look-ahead, smoothing.
            51 if self.dialect == Dialect::Fanuc => asked.contour = true,
            // Compensations and cycles off, how exactly an exact stop stops.
            400 | 800 | 6010 | 6020 => {}
            540..=599 | 5000..=5990 => match self.offset_of(code) {
                Some(offset) => asked.work_offset = Some(offset),
                None => return self.refuse(line, &format!("G{}", code as f64 / 10.0)),
            },
            _ => return self.refuse(line, &format!("G{}", code as f64 / 10.0)),
        }
        Ok(())
    }

    /// The work offset of a G word, by its number times ten.
    fn offset_of(&self, code: i64) -> Option<WorkOffset> {
        let (whole, tenth) = (u32::try_from(code / 10).ok()?, u32::try_from(code % 10).ok()?);
        let offset = match (whole, tenth) {
            (54, 1) => WorkOffset::Extended(0),
            (54..=59, 0) => WorkOffset::Standard(whole),
            (59, 1..=3) => WorkOffset::Further(tenth),
            (500, 0) => WorkOffset::Off,
            (505..=599, 0) => WorkOffset::Settable(whole),
            _ => return None,
        };
        // The number of an extended one is still to come.
        let named = if offset == WorkOffset::Extended(0) { WorkOffset::Extended(1) } else { offset };
        named.words(self.dialect).map(|_| offset)
    }

    /// Switching between G93, G94 and G95 makes the control forget F.
    fn reading(&mut self, reading: FeedReading) {
        if self.state.reading != reading {
            self.state.reading = reading;
            self.state.feed = None;
        }
    }

    pub(super) fn m(&mut self, line: usize, code: i64, asked: &mut Asked) -> Result<(), ReadError> {
        let word = format!("M{code}");
        if let Some(switch) =
            self.machine.control().linuxcnc_tcp.as_ref().filter(|_| self.dialect == Dialect::LinuxCnc)
        {
            for (name, on) in [(&switch.on, true), (&switch.off, false)] {
                if *name == word {
                    self.switch(on);
                    return Ok(());
                }
            }
        }
        match (code, self.dialect) {
            (2 | 17 | 30, _) => asked.end = true,
            (0 | 1, _) => self.tell(&Event::Halt),
            (6, _) => {
                asked.change = true;
                self.tell(&Event::Halt);
            }
            (3 | 4 | 13 | 14, _) if code < 10 || self.dialect == Dialect::Heidenhain => {
                let clockwise = code % 10 == 3;
                asked.spindle = Some(if clockwise { Spindle::Clockwise } else { Spindle::Counter });
                self.control.flood |= code > 10;
            }
            (5, _) => asked.spindle = Some(Spindle::Stopped),
            (7, _) => self.control.mist = true,
            (8, _) => self.control.flood = true,
            (9, _) => (self.control.mist, self.control.flood) = (false, false),
            (126 | 127, Dialect::Heidenhain) => {}
            // Outputs switched along with the motion.
            (62..=65, Dialect::LinuxCnc) => {}
            (91, Dialect::Heidenhain) => asked.machine_frame = true,
            (92, Dialect::Heidenhain) => asked.builders_place = true,
            (128, Dialect::Heidenhain) => {
                self.state.great_circle = false;
                self.switch(true);
            }
            (129, Dialect::Heidenhain) => self.switch(false),
            _ => return self.refuse(line, &word),
        }
        Ok(())
    }

    pub(super) fn address(
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
        if self.dialect == Dialect::Sinumerik
            && let Some(k) = ["A3", "B3", "C3"].iter().position(|n| *n == name)
        {
            asked.vector[k] = Some(given.0);
            return Ok(());
        }
        if self.dialect == Dialect::Heidenhain {
            if let Some(k) = ["TX", "TY", "TZ"].iter().position(|n| *n == name) {
                asked.vector[k] = Some(given.0);
                return Ok(());
            }
            // The surface's normal, for the cutter's compensation; without a difference of radii it moves nothing.
            if matches!(name, "NX" | "NY" | "NZ") {
                return Ok(());
            }
        }
        match name {
            "I" => asked.centre[0] = Some(given.0 * self.state.unit_mm),
            "J" => asked.centre[1] = Some(given.0 * self.state.unit_mm),
            "K" => asked.centre[2] = Some(given.0 * self.state.unit_mm),
            "R" | "CR" => asked.radius = Some(given.0 * self.state.unit_mm),
            "P" => asked.p = Some(given.0),
            "Q" => asked.q = Some(given.0),
            "L" => asked.l = Some(given.0),
            "N" | "O" => {}
            "T" | "D" | "H" => return self.number(line, name, (given.0, asked)),
            "S1" | "M1" | "CTOL" | "OTOL" | "ADIS" | "ADISPOS" if self.dialect == Dialect::Sinumerik => {
                return self.sinumerik_address(line, name, (given.0, asked));
            }
            _ => return self.refuse(line, name),
        }
        Ok(())
    }

    /// T, D and H: whole numbers.
    fn number(
        &mut self,
        line: usize,
        name: &str,
        (value, asked): (f64, &mut Asked),
    ) -> Result<(), ReadError> {
        // Tools have up to eight digits.
        if !((0.0..1e9).contains(&value) && value.fract() == 0.0) {
            return self.refuse(line, &format!("{name}{value}"));
        }
        // Whole and in the range of u32, as just checked.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let number = Some(value as u32);
        match name {
            "T" => asked.tool = number,
            "D" => asked.d = number,
            _ => asked.h = number,
        }
        Ok(())
    }

    fn sinumerik_address(
        &mut self,
        line: usize,
        name: &str,
        (value, asked): (f64, &mut Asked),
    ) -> Result<(), ReadError> {
        let mm = value.max(0.0) * self.state.unit_mm;
        match name {
            "S1" => self.spindle_speed(value),
            "M1" if value == 3.0 => return self.m(line, 3, asked),
            "M1" if value == 4.0 => return self.m(line, 4, asked),
            "M1" if value == 5.0 => return self.m(line, 5, asked),
            "CTOL" => self.control.smoothing_mm = (value >= 0.0).then_some(mm),
            "ADIS" => asked.corner = Some(Corner::Within(mm)),
            // Of orientations, and of rapid moves.
            "OTOL" | "ADISPOS" => {}
            _ => return self.refuse(line, &format!("{name}={value}")),
        }
        Ok(())
    }

    pub(super) fn name(
        &mut self,
        line: usize,
        name: &str,
        arguments: &str,
        asked: &mut Asked,
    ) -> Result<(), ReadError> {
        let klartext = self.dialect == Dialect::Heidenhain;
        match name {
            "TRAORI" => self.switch(true),
            "TRAFOOF" => self.switch(false),
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
            "TRANS" if self.dialect == Dialect::Sinumerik && arguments.is_empty() => {
                asked.frames_deleted = true
            }
            "CYCLE832" => return self.cycle832(line, arguments),
            "CYCLE800" => return self.cycle800(line, arguments),
            "PLANE" if klartext => return self.klartext_plane(line, arguments),
            "ORIVECT" | "ORIPLANE" => self.state.great_circle = true,
            "ORIAXES" => self.state.great_circle = false,
            "CYCL" if klartext => return self.klartext_cycle(line, arguments),
            _ if klartext && name.starts_with("Q339=") => return self.preset(line, &[name]),
            "T" => self.selected = Some(Tool::Named),
            "ORIWKS" | "ORIMKS" | "MSG" | "FNORM" | "FFWON" | "FFWOF" | "SOFT" | "BRISK" | "COMPOF" => {}
            "L" if klartext => asked.klartext_move = true,
            "R0" if klartext => {}
            "TOOL" if klartext => self.tool_call(line, arguments),
            "FMAX" if klartext => asked.rapid_once = true,
            "FUNCTION" if klartext && arguments == "RESET TCPM" => {
                self.switch(false);
            }
            "FUNCTION" if klartext && arguments == "TCPM F TCP AXIS POS PATHCTRL AXIS" => {
                self.state.great_circle = false;
                self.switch(true);
            }
            "FUNCTION" if klartext && arguments == "TCPM F TCP AXIS SPAT PATHCTRL VECTOR" => {
                self.state.great_circle = true;
                self.switch(true);
            }
            // Raw material for the picture of the control.
            "BLK" if klartext && arguments.starts_with("FORM ") => {}
            "WORKPIECE" if self.dialect == Dialect::Sinumerik => {}
            "BEGIN" if klartext => self.state.unit_mm = if arguments.ends_with("INCH") { 25.4 } else { 1.0 },
            "END" if klartext => asked.end = true,
            _ => return self.refuse(line, format!("{name} {arguments}").trim()),
        }
        Ok(())
    }
}
