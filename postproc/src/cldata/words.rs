//! Words of CL data that stand beside the points: feed, units, spindle, cutter, tool.

use osculate_geom::{Diagnostic, Point3};

use super::cutter::{self, Found};
use super::error::ClReadError;
use super::feed::Feed;
use super::fields::{count, is_word, numbers, place};
use super::read::{ClReader, LEAST_RADIUS_MM, Taken};
use super::statement::Statement;
use crate::nc::Coolant;

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
        if !(mm > 0.0 && mm.is_finite()) {
            return Err(ClReadError::Feed { line: s.line, feed_mm_min: mm });
        }
        self.feed = Some(Feed { mm, per_turn, line: s.line });
        // A feed between RAPID and GOTO cancels the rapid in no system; it holds from the point after.
        Ok(())
    }

    pub(super) fn feed_mm_min(&self, feed: &Feed, tip: &Point3) -> Result<f64, ClReadError> {
        match (feed.per_turn, self.surface_mm_min, self.path.spindle_rpm) {
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
        if let Some(&rpm) = numbers(s, &values)?.first() {
            self.surface_mm_min = None;
            let known = self.path.spindle_rpm;
            if self.first || known.is_none() {
                self.path.spindle_rpm = Some(rpm);
            } else if known != Some(rpm) {
                let text = format!(
                    "SPINDL/{rpm} changes the speed on the way; a path has one speed, the first is kept"
                );
                self.diagnostics.push(Diagnostic::loss(place(s.line), text));
            }
        }
        if s.fields.iter().any(|f| f == "CCLW" || f == "CCW") {
            let text = "SPINDL/ counter-clockwise: a path's spindle turns clockwise";
            self.diagnostics.push(Diagnostic::loss(place(s.line), text));
        }
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
        if self.first || self.path.cutter.is_none() {
            self.path.cutter = Some(spec);
        } else if self.path.cutter != Some(spec) {
            let text = "another CUTTER/ on the way; a path has one cutter, the first is kept";
            self.diagnostics.push(Diagnostic::loss(place(s.line), text));
        }
        Ok(())
    }

    pub(super) fn load(&mut self, s: &Statement) {
        let tool = s.fields.first().cloned();
        if !self.first && self.loaded.is_some() && tool != self.loaded {
            let text = format!(
                "tool change to {} on the way: the path goes on with the first tool",
                s.fields.join(",")
            );
            self.diagnostics.push(Diagnostic::loss(place(s.line), text));
        }
        self.loaded = self.loaded.take().or(tool);
    }

    /// `COOLNT/ON`, `FLOOD`, `MIST`, `OFF`: a program has one coolant, the first, from its start to its end.
    pub(super) fn coolant_word(&mut self, s: &Statement) {
        let asked = match s.fields.first().map(String::as_str) {
            Some("MIST") => Some(Coolant::Mist),
            Some("OFF") => None,
            _ => Some(Coolant::Flood),
        };
        match (self.coolant, asked) {
            (None, _) => self.coolant = asked,
            (Some(now), Some(other)) if now == other => {}
            (Some(_), _) => self.other("COOLNT", s.line, Taken::Harmless),
        }
    }
}
