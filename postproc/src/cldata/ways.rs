//! What leads to a point otherwise than straight: arcs, and the moves of a cycle.

use osculate_geom::{Diagnostic, Point3, Unit3};
use osculate_tools::cl::Motion;

use super::arc::{self, Arc, MOST_CHORDS, NoArc};
use super::cycle::{self, Cycle};
use super::error::ClReadError;
use super::fields::place;
use super::read::{ClReader, Taken};
use super::statement::Statement;
use crate::auxiliary::AuxiliaryWord;

impl ClReader {
    pub(super) fn arc(&mut self, s: &Statement) -> Result<(), ClReadError> {
        self.open_arc()?;
        self.arc = Some(arc::circle(s, self.unit_mm)?);
        self.other(&s.word, s.line, Taken::Chords);
        Ok(())
    }

    /// `TLON,GOFWD/(CIRCLE/ ...),ON,(LINE/ ...)`: an arc that carries its end.
    pub(super) fn catia_arc(&mut self, s: &Statement) -> Result<(), ClReadError> {
        self.open_arc()?;
        match (self.tip, self.heading.take(), arc::gofwd(s, self.unit_mm)?) {
            (Some(from), Some(heading), Some((mut arc, to))) => {
                arc.axis = Unit3::try_new((from - arc.centre).cross(&heading), 1e-9);
                self.arc = Some(arc);
                self.other("TLON,GOFWD", s.line, Taken::Chords);
                self.arrive(s.line, to)
            }
            _ => {
                self.other(&s.word, s.line, Taken::Lost);
                Ok(())
            }
        }
    }

    /// An arc after which no point came: by its angle it ends nevertheless.
    pub(super) fn open_arc(&mut self) -> Result<(), ClReadError> {
        let Some(arc) = self.arc.take() else { return Ok(()) };
        match self.tip.and_then(|from| arc.end_by_angle(&from)) {
            Some(to) => {
                let line = arc.line;
                self.arc = Some(arc);
                self.arrive(line, to)
            }
            None => {
                let text = "an arc without a GOTO/ behind it has no end: it is left out";
                self.diagnostics.push(Diagnostic::loss(place(arc.line), text));
                Ok(())
            }
        }
    }

    pub(super) fn cycle(&mut self, s: &Statement) -> Result<(), ClReadError> {
        self.open_arc()?;
        let first = s.fields.first().map_or("", String::as_str);
        self.in_cycle = first != "OFF";
        match first {
            "INIT" => {}
            "OFF" => self.cycle = None,
            "ON" if self.cycle.is_some() => {}
            _ => {
                self.cycle = cycle::cycle(s, self.unit_mm)?;
                let taken = if self.cycle.is_some() { Taken::Moves } else { Taken::Lost };
                self.other(&format!("CYCLE/{first}"), s.line, taken);
                if self.cycle.as_ref().is_some_and(|c| c.kind == cycle::Kind::Tap) {
                    let text =
                        "CYCLE/TAP: the spindle is reversed at the bottom, which wants a floating tap holder";
                    self.diagnostics.push(Diagnostic::warning(place(s.line), text));
                }
            }
        }
        Ok(())
    }

    /// The points on the arc before its end.
    pub(super) fn round(&mut self, line: usize, arc: &Arc, end: (Point3, Motion)) -> Result<(), ClReadError> {
        let Some(from) = self.tip else {
            let text = "an arc before the first point: where it starts is not known, its end is kept";
            self.diagnostics.push(Diagnostic::loss(place(arc.line), text));
            return Ok(());
        };
        match arc.chords(&from, &end.0, self.options.arc_tol_mm) {
            Ok(points) => points.into_iter().for_each(|p| self.push(p, end.1)),
            Err(NoArc::Chords(count)) => {
                return Err(ClReadError::Bound { line: arc.line, what: "the arc", count, most: MOST_CHORDS });
            }
            Err(NoArc::Off(off_mm)) => {
                let text = format!(
                    "the arc of line {} misses its ends by {off_mm:.4} mm: it is taken as a straight line",
                    arc.line
                );
                self.diagnostics.push(Diagnostic::loss(place(line), text));
            }
        }
        Ok(())
    }

    /// A drilling cycle at a point of the part.
    pub(super) fn hole(&mut self, line: usize, tip: Point3, cycle: &Cycle) -> Result<(), ClReadError> {
        self.rapid = false;
        let feed = cycle.feed.or(self.feed).ok_or(ClReadError::NoFeed { line })?;
        let feed = Motion::Feed(self.feed_mm_min(&feed, &tip)?);
        let forward = self.said.tool.spindle;
        if cycle.kind == cycle::Kind::Tap && forward.is_none_or(|s| s.rpm().is_none()) {
            return Err(ClReadError::NoSpindle { line });
        }
        let dwell = self.dwell(line, cycle.dwell_s)?;
        for step in cycle.steps() {
            let motion = if step.rapid { Motion::Rapid } else { feed };
            self.push(tip + self.axis.into_inner() * step.above_mm, motion);
            match step.then {
                cycle::Then::GoOn => {}
                cycle::Then::Bottom => dwell.into_iter().for_each(|word| self.say(line, word)),
                cycle::Then::Reverse(back) => {
                    let spindle = forward.map(|s| if back { s.reversed() } else { s });
                    spindle.into_iter().for_each(|s| self.say(line, AuxiliaryWord::Spindle(s)));
                }
            }
        }
        Ok(())
    }
}
