//! What the words of a line do to the state of the control that is not the way: tool, offsets, spindle, corners.
//!
//! In a line the tool is changed first, then come length and work offset, spindle and corners, then its move.

use super::Dialect;
use super::asked::{Asked, LengthWord, PathWord};
use super::control::{Corner, Length, Spindle, Tool};
use super::event::{Event, Sink};
use super::interpret::Interpreter;
use super::read_error::ReadError;
use super::work_offset::WorkOffset;

impl<S: Sink> Interpreter<'_, S> {
    /// What a line asks for beside its move.
    pub(super) fn settle_control(&mut self, line: usize, asked: &Asked) {
        if asked.skipped && asked.acts {
            self.record.skipped.again(line);
        }
        if let Some(number) = asked.tool {
            self.selected = Some(Tool::Number(number));
            self.record.select(number, line);
        }
        if let (true, Some(tool)) = (asked.change, self.selected) {
            let before = self.control.tool;
            self.change_tool(tool);
            // Which edge is then in force is the machine's data.
            if self.dialect == Dialect::Sinumerik && before != tool {
                self.control.length = Length::Unsaid;
            }
        }
        self.settle_length(asked);
        if let Some(offset) = self.work_offset(asked) {
            self.control.work_offset = Some(offset);
        }
        if let Some(spindle) = asked.spindle {
            self.control.spindle = spindle;
            self.record.spindle_started |= matches!(spindle, Spindle::Clockwise | Spindle::Counter);
        }
        self.control.speed_rpm = self.state.speed;
        self.settle_corner(asked);
    }

    /// Another tool in the spindle, which stays where it is: the tip is elsewhere.
    fn change_tool(&mut self, tool: Tool) {
        self.control.change(tool);
        if let Tool::Number(number) = tool {
            let own = self.lengths.iter().find(|t| t.0 == number);
            let length_mm = own.map_or(self.gauge_length_mm, |t| t.1);
            self.state.take_length(length_mm, self.machine, &mut self.setup);
        }
    }

    fn settle_length(&mut self, asked: &Asked) {
        let length = &mut self.control.length;
        if self.dialect == Dialect::Sinumerik {
            match asked.d {
                Some(0) => *length = Length::Off,
                Some(edge) => *length = Length::On(Some(edge)),
                None => {}
            }
            return;
        }
        match (asked.length, asked.h) {
            (Some(LengthWord::Off), _) => *length = Length::Off,
            (Some(LengthWord::Measured), _) => {
                let z = asked.axes.iter().find(|a| a.0 == "Z").map_or(0.0, |a| a.1);
                *length = Length::Measured(z * self.state.unit_mm);
            }
            (Some(LengthWord::On), Some(h)) => *length = Length::On(Some(h)),
            // H holds on with Fanuc; LinuxCNC takes the length of the tool in the spindle.
            (Some(LengthWord::On), None) => {
                *length = match (self.dialect, *length) {
                    (Dialect::Fanuc, Length::On(h)) => Length::On(h),
                    _ => Length::On(None),
                }
            }
            (None, Some(h)) if self.dialect == Dialect::Fanuc && matches!(length, Length::On(_)) => {
                *length = Length::On(Some(h));
            }
            (None, _) => {}
        }
    }

    fn work_offset(&self, asked: &Asked) -> Option<WorkOffset> {
        // The P of G54.1, which G54 takes too.
        let number = asked.p.filter(|p| self.dialect == Dialect::Fanuc && asked.path.is_none() && *p >= 1.0);
        match (asked.work_offset?, number) {
            // The number is small and whole; what is not is another offset than the one wanted.
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            (WorkOffset::Extended(_) | WorkOffset::Standard(54), Some(p)) => {
                Some(WorkOffset::Extended(p as u32))
            }
            (offset, _) => Some(offset),
        }
    }

    fn settle_corner(&mut self, asked: &Asked) {
        let unit = self.state.unit_mm;
        match (asked.path, asked.corner) {
            (_, Some(corner)) => self.control.corner = corner,
            (Some(PathWord::ExactPath | PathWord::ExactStop), None) => self.control.corner = Corner::Exact,
            (Some(PathWord::Blend), None) => {
                // P 0 is as none; joined moves may be off by Q, and their corners by P on top of that.
                let p = asked.p.filter(|p| *p > 0.0);
                let width_mm = p.map(|p| (p + asked.q.unwrap_or(p).max(0.0)) * unit);
                self.control.corner = match (self.dialect, width_mm, p) {
                    (Dialect::LinuxCnc, Some(mm), _) => Corner::Within(mm),
                    (Dialect::LinuxCnc, None, _) => Corner::Unlimited,
                    (_, _, Some(p)) => Corner::Within(p * unit),
                    (Dialect::Sinumerik, _, None) => Corner::Machine,
                    _ => Corner::Unsaid,
                };
            }
            (None, None) => {}
        }
        // Fanuc's nano smoothing; Q0 and Q1 keep to the path as servos do.
        if asked.contour {
            self.control.corner = match asked.q {
                Some(q) if q >= 2.0 => Corner::Machine,
                _ => Corner::Unsaid,
            };
        }
    }

    /// `CALL 5 Z S8000 DL+0.1`, what follows `TOOL`; the speed is a word of its own.
    pub(super) fn tool_call(&mut self, line: usize, arguments: &str) {
        let Some(rest) = arguments.strip_prefix("CALL") else { return };
        let rest = rest.trim_start();
        if rest.starts_with(['"', '\'']) || rest.starts_with('Q') {
            self.change_tool(Tool::Named);
        } else if let Some(Ok(number)) = rest
            .split_whitespace()
            .next()
            .filter(|n| n.starts_with(|c: char| c.is_ascii_digit()))
            .map(str::parse::<u32>)
        {
            self.record.select(number, line);
            self.change_tool(Tool::Number(number));
        } else if rest.starts_with(|c: char| c.is_ascii_digit()) {
            // A step of an indexed tool (5.1) has a length of its own.
            self.change_tool(Tool::Named);
        } else {
            return;
        }
        let deltas = rest.split_whitespace().filter_map(|w| {
            let number = w.strip_prefix("DL").or_else(|| w.strip_prefix("DR"))?;
            number.trim_start_matches(['2', '=']).parse::<f64>().ok()
        });
        self.control.tool_delta_mm = deltas.map(f64::abs).fold(0.0, f64::max);
    }

    /// `DEF 247 ... Q339=+1`, `DEF 32.1 T0.05`: what follows `CYCL`; false where it is another cycle.
    pub(super) fn klartext_cycle(&mut self, line: usize, arguments: &str) -> Result<(), ReadError> {
        let words: Vec<&str> = arguments.split_whitespace().collect();
        match words[..] {
            ["DEF", "32.0", ..] => self.control.smoothing_mm = None,
            ["DEF", "32.1", tolerance, ..] => {
                let mm = tolerance.strip_prefix('T').and_then(|t| t.parse::<f64>().ok());
                match mm.filter(|t| t.is_finite() && *t >= 0.0) {
                    Some(mm) => self.control.smoothing_mm = Some(mm * self.state.unit_mm),
                    None => return self.refuse(line, &format!("CYCL {arguments}")),
                }
            }
            ["DEF", n, ..] if n.starts_with("32.") => {}
            ["DEF", "9.0", ..] => {}
            ["DEF", "9.1", ref of @ ..] => {
                let text = of.concat();
                let seconds = text.trim_start_matches("DWELL").trim_start_matches("V.ZEIT").parse::<f64>();
                match seconds.ok().filter(|s| s.is_finite() && *s >= 0.0) {
                    Some(seconds) => self.tell(&Event::Dwell(seconds / 60.0)),
                    None => return self.refuse(line, &format!("CYCL {arguments}")),
                }
            }
            ["DEF", "247", ..] => return self.preset(line, &words),
            _ => return self.refuse(line, &format!("CYCL {arguments}")),
        }
        Ok(())
    }

    /// `Q339=+1` of cycle 247, in its line or in the one behind it.
    pub(super) fn preset(&mut self, line: usize, words: &[&str]) -> Result<(), ReadError> {
        let number = words.iter().find_map(|w| w.strip_prefix("Q339="));
        match number.map(|n| n.trim_start_matches('+').parse::<u32>()) {
            Some(Ok(n)) => self.control.work_offset = Some(WorkOffset::Preset(n)),
            None if words.last() == Some(&"~") => {}
            _ => return self.refuse(line, &words.join(" ")),
        }
        Ok(())
    }

    /// `CYCLE832(0.05,1,1)`: the tolerance, mm; without arguments or with mode 0 there is none.
    pub(super) fn cycle832(&mut self, line: usize, arguments: &str) -> Result<(), ReadError> {
        let mut fields = arguments.split(',').map(str::trim);
        let tolerance = fields.next().unwrap_or_default();
        let off = tolerance.is_empty() || fields.next() == Some("0");
        if off {
            self.control.smoothing_mm = None;
            self.control.corner = Corner::Machine;
            return Ok(());
        }
        match tolerance.parse::<f64>().ok().filter(|t| t.is_finite() && *t >= 0.0) {
            Some(mm) => {
                self.control.smoothing_mm = Some(mm * self.state.unit_mm);
                Ok(())
            }
            None => self.refuse(line, &format!("CYCLE832({arguments})")),
        }
    }
}
