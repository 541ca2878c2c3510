//! Words of CL data that stand beside the points: feed, units, spindle, cutter, tool.

use osculate_geom::{Diagnostic, Point3};

use super::cutter::{self, Found};
use super::error::ClReadError;
use super::feed::{FEEDS, Feed};
use super::fields::{count, is_word, numbers, place};
use super::read::{ClReader, LEAST_RADIUS_MM, Taken};
use super::statement::Statement;
use crate::auxiliary::{AuxiliaryWord, Spindle};
use crate::nc::Coolant;

/// Tools of controls have up to eight digits.
const LARGEST_TOOL: f64 = 1e8;

/// Ten hours: what waits longer was meant in another unit, s.
const LONGEST_DWELL_S: f64 = 36_000.0;

impl ClReader {
    pub(super) fn feed(&mut self, s: &Statement) -> Result<(), ClReadError> {
        if s.fields.iter().any(|f| f == "RAPID") {
            self.rapid = true;
            return Ok(());
        }
        let (words, values): (Vec<_>, Vec<_>) = s.fields.iter().cloned().partition(|f| is_word(f));
        let values = numbers(s, &values)?;
        // FEDRAT/IN, 5 and the like carry one number; what follows it (RAPTO distances) is not a feed.
        let Some(&value) = values.first() else { return Err(count(s, 0, "1")) };
        let has = |names: &[&str]| words.iter().any(|w| names.contains(&w.as_str()));
        let per_turn = has(&["MMPR", "IPR", "PERREV"]);
        let unit = if has(&["MMPM", "MMPR", "MPM"]) {
            1.0
        } else if has(&["IPM", "IPR"]) {
            25.4
        } else {
            self.unit_mm
        };
        let mm = value * unit;
        if !FEEDS.contains(&mm) {
            return Err(ClReadError::Feed { line: s.line, feed_mm_min: mm });
        }
        self.feed = Some(Feed { mm, per_turn, line: s.line });
        // A feed between RAPID and GOTO cancels the rapid in no system; it holds from the point after.
        Ok(())
    }

    pub(super) fn feed_mm_min(&self, feed: &Feed, tip: &Point3) -> Result<f64, ClReadError> {
        match (feed.per_turn, self.surface_mm_min, self.said.tool.spindle.and_then(Spindle::rpm)) {
            (false, ..) => Ok(feed.mm),
            (true, Some(v), _) => {
                let radius_mm = tip.x.hypot(tip.y).max(LEAST_RADIUS_MM);
                Ok(feed.mm * v / (std::f64::consts::TAU * radius_mm))
            }
            (true, None, Some(rpm)) if rpm > 0.0 => Ok(feed.mm * rpm),
            (true, ..) => Err(ClReadError::NoSpindle { line: feed.line }),
        }
    }

    pub(super) fn units(&mut self, s: &Statement) {
        match s.fields.first().map(String::as_str) {
            Some("MM") => self.unit_mm = 1.0,
            Some("CM") => self.unit_mm = 10.0,
            Some("INCHES" | "INCH" | "IN") => self.unit_mm = 25.4,
            other => {
                let text =
                    format!("UNITS/{} is not known, lengths stay as before", other.unwrap_or_default());
                self.diagnostics.push(Diagnostic::loss(place(s.line), text));
            }
        }
    }

    pub(super) fn spindle(&mut self, s: &Statement) -> Result<(), ClReadError> {
        let values: Vec<String> = s.fields.iter().filter(|f| !is_word(f)).cloned().collect();
        if let Some(unit) = s.fields.iter().find(|f| *f == "SFM" || *f == "SMM") {
            // Feet or metres a minute.
            let mm = if unit == "SFM" { 304.8 } else { 1000.0 };
            self.surface_mm_min = numbers(s, &values)?.first().map(|v| v * mm).filter(|v| *v > 0.0);
            let text = "SPINDL/ as a surface speed: a path has one speed in rpm, which stays unknown; feeds per \
                        revolution follow the tip's distance from the part's Z axis";
            self.diagnostics.push(Diagnostic::loss(place(s.line), text));
            return Ok(());
        }
        let has = |names: &[&str]| s.fields.iter().any(|f| names.contains(&f.as_str()));
        let spindle = match (numbers(s, &values)?.first(), self.said.tool.spindle) {
            (Some(&rpm), _) if rpm < 0.0 => return Err(ClReadError::Speed { line: s.line, rpm }),
            (Some(&rpm), _) if rpm > 0.0 => {
                self.surface_mm_min = None;
                self.said.speed_rpm = Some(rpm);
                let counter = has(&["CCLW", "CCW"]);
                Some(if counter { Spindle::Counter { rpm } } else { Spindle::Clockwise { rpm } })
            }
            (Some(_), _) => Some(Spindle::Off),
            (None, _) if has(&["OFF"]) => Some(Spindle::Off),
            // On again, as it was.
            (None, Some(Spindle::Off)) => self.said.speed_rpm.map(|rpm| Spindle::Clockwise { rpm }),
            (None, now) => now,
        };
        self.said.tool.spindle = spindle;
        (self.said.lines[0], self.said.changed) = (s.line, true);
        Ok(())
    }

    pub(super) fn cutter_word(&mut self, s: &Statement) -> Result<(), ClReadError> {
        let mut p = numbers(s, &s.fields)?;
        for (i, v) in p.iter_mut().enumerate() {
            // Fields 5 and 6 are angles.
            if i != 4 && i != 5 {
                *v *= self.unit_mm;
            }
        }
        let found = cutter::cutter(&p);
        let spec = match found {
            Found::Known(spec) => spec,
            Found::Assumed(spec, length_mm) => {
                let text = format!("CUTTER/ has no height: a length of {length_mm} mm is assumed");
                self.diagnostics.push(Diagnostic::warning(place(s.line), text));
                spec
            }
            Found::Other => {
                let text = format!(
                    "CUTTER/{} is no ball, flat or toroidal cutter: the cutter stays unknown",
                    s.fields.join(",")
                );
                self.diagnostics.push(Diagnostic::loss(place(s.line), text));
                return Ok(());
            }
        };
        (self.said.tool.cutter, self.said.cutter) = (Some(spec), true);
        (self.said.lines[2], self.said.changed) = (s.line, true);
        Ok(())
    }

    /// `LOADTL/3,...`, `LOAD/TOOL,3,...`, `LOAD/3`.
    pub(super) fn load(&mut self, s: &Statement) -> Result<(), ClReadError> {
        self.open_arc()?;
        let mut fields = s.fields.iter().filter(|f| *f != "TOOL");
        let number = fields.next().and_then(|f| numbers(s, std::slice::from_ref(f)).ok()?.first().copied());
        let whole = number.filter(|n| n.fract() == 0.0 && (0.0..LARGEST_TOOL).contains(n));
        let Some(number) = whole else {
            let text = format!(
                "{}/{} names no tool by a number: the tool stays what it was",
                s.word,
                s.fields.join(",")
            );
            self.diagnostics.push(Diagnostic::loss(place(s.line), text));
            return Ok(());
        };
        // Whole and in the range of u32, as just checked.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let number = number as u32;
        self.said.tool.number = Some(number);
        self.placing.tool_called(s.line);
        (self.said.loaded, self.said.changed) = (Some(s.line), true);
        Ok(())
    }

    /// `COOLNT/ON`, `FLOOD`, `MIST`, `OFF`.
    pub(super) fn coolant_word(&mut self, s: &Statement) {
        let asked = match s.fields.first().map(String::as_str) {
            Some("MIST") => Some(Coolant::Mist),
            Some("OFF") => None,
            _ => Some(Coolant::Flood),
        };
        self.said.tool.coolant = asked;
        (self.said.lines[1], self.said.changed) = (s.line, true);
    }

    /// `DELAY/s`; in revolutions with `REV`.
    pub(super) fn delay(&mut self, s: &Statement) -> Result<(), ClReadError> {
        let (words, values): (Vec<_>, Vec<_>) = s.fields.iter().cloned().partition(|f| is_word(f));
        let Some(&value) = numbers(s, &values)?.first() else { return Err(count(s, 0, "1")) };
        let turns = words.iter().any(|w| w == "REV");
        let rpm = self.said.tool.spindle.and_then(Spindle::rpm);
        let seconds = match (turns, rpm) {
            (true, Some(rpm)) => 60.0 * value / rpm,
            (true, None) => return Err(ClReadError::NoSpindle { line: s.line }),
            (false, _) => value,
        };
        self.dwell(s.line, seconds)?.into_iter().for_each(|word| self.say_later(s.line, word));
        Ok(())
    }

    /// A dwell of this length; none where it is zero.
    pub(super) fn dwell(&self, line: usize, seconds: f64) -> Result<Option<AuxiliaryWord>, ClReadError> {
        if !(0.0..=LONGEST_DWELL_S).contains(&seconds) {
            return Err(ClReadError::Dwell { line, seconds });
        }
        Ok((seconds > 0.0).then_some(AuxiliaryWord::Dwell { seconds }))
    }

    /// `CUTCOM/OFF` where none is on says nothing; else it is a loss, but for a path that is known to be the cutter's centre.
    pub(super) fn compensation(&mut self, s: &Statement) {
        let off = s.fields.first().is_some_and(|f| f == "OFF");
        let taken = match (off && !self.compensated, self.options.cutcom_is_centre) {
            (true, _) => Taken::Harmless,
            (false, true) => Taken::Centre,
            (false, false) => Taken::Lost,
        };
        self.compensated = !off;
        self.other(&s.word, s.line, taken);
    }
}
