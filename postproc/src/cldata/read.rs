//! Reading APT text of this and of other systems.
//!
//! What describes the tool's way is read: `GOTO`, `GODLTA`, `FROM`, `FEDRAT`, `RAPID`, `UNITS`, `TLAXIS`, arcs
//! ([`super::arc`]) and drilling cycles ([`super::cycle`]), and what says with which tool and how: `LOADTL`, `CUTTER`, `SPINDL`,
//! `COOLNT`, `DELAY`, `STOP`, `OPSTOP` ([`super::section`]). Everything else is reported by word with its
//! lines: as a loss where it may change the way (transformations, cutter compensation, unknown words), as a note where
//! it does not (texts). `TRACUT` and `COPY` place points ([`super::transform`], [`super::repeat`]). A `GOTO` without an axis keeps the last one, at first (0, 0, 1).
//!
//! A feed per revolution needs the speed of the spindle. Where `SPINDL/` gives a surface speed instead (turning), the
//! speed follows the distance of the tip from the part's Z axis, never taken below [`LEAST_RADIUS_MM`].

use std::collections::BTreeMap;

use osculate_geom::{Diagnostic, Point3, Unit3, Vec3};
use osculate_tools::cl::{ClMove, ClPath, Motion};
use osculate_tools::{CutterSpec, Pose};

use super::arc::Arc;
use super::cycle::Cycle;
use super::error::ClReadError;
use super::feed::Feed;
use super::fields::{axis, count, is_identity, numbers, place, unit, vector};
use super::placing::Placing;
use super::section::{ClSection, ClTool, Said};
use super::statement::{Item, Joiner, Statement};
use crate::auxiliary::{AuxiliaryWord, Spindle};
use crate::nc::Coolant;

/// A path and what was noticed on the way.
#[derive(Clone, Debug, PartialEq)]
pub struct ClData {
    /// The path.
    pub path: ClPath,
    /// Findings, with line numbers.
    pub diagnostics: Vec<Diagnostic>,
}

/// Words that say nothing about the tool's way.
const HARMLESS: &[&str] = &[
    "PPRINT",
    "INSERT",
    "TPRINT",
    "OPNAME",
    "REMARK",
    "SELECT",
    "SELECTL",
    "TOOLNO",
    "MACHIN",
    "REWIND",
    "SEQNO",
    "PAINT",
    "DISPLY",
    "END",
    "CSI_SET_FLUTE_LENGTH",
    "CSI_SET_EXTENSION_LENGTH",
    "LEADER",
    "INTOL",
    "OUTTOL",
    "TOLER",
    "NOPOST",
    "CLPRNT",
    "SWITCH",
    "PREFUN",
    "AUXFUN",
    "MODE",
    "SAFETY",
    "CLEARP",
    "THICK",
    "LINTOL",
    "ROTABL",
];

/// Words that say what the tool does.
const KNOWN: &[&str] = &[
    "GOTO", "GODLTA", "FROM", "RAPID", "FEDRAT", "UNITS", "SPINDL", "CUTTER", "LOADTL", "LOAD", "COOLNT",
    "DELAY", "STOP", "OPSTOP", "CUTCOM", "TLAXIS", "CIRCLE", "MOVARC", "INDIRV", "CYCLE", "TRACUT", "INDEX",
    "COPY", "CSYS", "TRNTYP", "MULTAX", "PARTNO", "FINI",
];

/// The words that are read, those that say nothing of the tool's way among them.
pub fn known_words() -> impl Iterator<Item = &'static str> {
    KNOWN.iter().chain(HARMLESS).copied()
}

/// Lines of one word that are listed before the rest is only counted.
const LISTED_LINES: usize = 5;

/// The least distance from the turning axis at which a surface speed is turned into revolutions, mm.
pub(super) const LEAST_RADIUS_MM: f64 = 1.0;

/// How a text is to be read.
///
/// ```
/// use osculate_postproc::cldata::{ClReadOptions, ClReader};
///
/// // Half around a circle of 10 mm about Z, from (10, 0) to (-10, 0).
/// let text = "RAPID\nGOTO/10,0,0\nFEDRAT/100\nMOVARC/0,0,0,0,0,1,10\nGOTO/-10,0,0\n";
/// let mut reader = ClReader::new(ClReadOptions { arc_tol_mm: 0.1, ..ClReadOptions::default() });
/// for line in text.lines() {
///     reader.line(line)?;
/// }
/// reader.end()?;
/// let points: Vec<_> = reader.take_moves().map(|m| m.pose.tip.coords).collect();
/// // Chords stray from the arc by 0.1 mm at most, in their middle.
/// for pair in points.windows(2) {
///     let middle = (pair[0] + pair[1]) / 2.0;
///     assert!((9.9 - 1e-9..=10.0).contains(&middle.norm()) && middle.y > 0.0);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClReadOptions {
    /// How far the chords of an arc may stray from it, mm.
    pub arc_tol_mm: f64,
    /// Points between `CUTCOM/LEFT` (`RIGHT`) and `CUTCOM/OFF` are the cutter's centre, as CL data has it: the compensation would be of
    /// wear only, and is left out. Else it is a loss, since there are systems that write the contour there.
    pub cutcom_is_centre: bool,
}

impl Default for ClReadOptions {
    /// Arcs within 1 um; of what points under `CUTCOM/` are nothing is known.
    fn default() -> Self {
        Self { arc_tol_mm: 0.001, cutcom_is_centre: false }
    }
}

/// How a word that is not a plain point was taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Taken {
    /// It may change the way.
    Lost,
    /// It does not.
    Harmless,
    /// An arc, as chords.
    Chords,
    /// A cycle, as moves.
    Moves,
    /// A placing, put into the points.
    Placed,
    /// A copy, made.
    Copied,
    /// Compensation of a path of the cutter's centre.
    Centre,
}

/// Reads cutter location data a line at a time: points go out as they come, nothing of the text is kept.
///
/// ```
/// use osculate_postproc::cldata::ClReader;
///
/// let mut reader = ClReader::default();
/// for line in "FEDRAT/100\nRAPID\nGOTO/0,0,5\nGOTO/0,0,0\n".lines() {
///     reader.line(line)?;
/// }
/// reader.end()?;
/// assert_eq!(reader.take_moves().count(), 2);
/// # Ok::<(), osculate_postproc::cldata::ClReadError>(())
/// ```
#[derive(Clone, Debug)]
pub struct ClReader {
    /// What is known beside the points, and the points not taken yet.
    pub(super) path: ClPath,
    /// No point has come yet.
    pub(super) first: bool,
    ended: bool,
    joiner: Joiner,
    pub(super) options: ClReadOptions,
    pub(super) diagnostics: Vec<Diagnostic>,
    /// mm per unit of length.
    pub(super) unit_mm: f64,
    pub(super) axis: Unit3,
    pub(super) tip: Option<Point3>,
    pub(super) feed: Option<Feed>,
    /// Surface speed of the part under the tool, mm/min.
    pub(super) surface_mm_min: Option<f64>,
    pub(super) rapid: bool,
    /// What the tools do, one after the other.
    pub(super) sections: Vec<ClSection>,
    /// What has been said of the tool since the last point.
    pub(super) said: Said,
    /// The cutter is compensated at the control.
    pub(super) compensated: bool,
    /// The way to the next point.
    pub(super) arc: Option<Arc>,
    /// The initial direction of a CATIA arc.
    pub(super) heading: Option<Vec3>,
    /// What happens at the points to come.
    pub(super) cycle: Option<Cycle>,
    /// Between CYCLE/ and CYCLE/OFF, where points are holes.
    pub(super) in_cycle: bool,
    /// Where points go.
    pub(super) placing: Placing,
    /// Points are in the world's frame: coordinate systems are for people.
    world: bool,
    /// Word and how it was taken -> lines listed, count.
    others: BTreeMap<(String, Taken), (Vec<usize>, usize)>,
}

impl Default for ClReader {
    fn default() -> Self {
        Self::new(ClReadOptions::default())
    }
}

/// The path of an APT text.
///
/// ```
/// use osculate_postproc::cldata::{ClReadError, read};
///
/// let path = read("UNITS/INCHES\nRAPID\nGOTO/0,0,1\nFEDRAT/10,IPM\nGOTO/1,0,0,0,0.6,0.8\nFINI\n")?.path;
/// // An inch is 25.4 mm.
/// assert!((path.moves[1].pose.tip.x - 25.4).abs() < 1e-12);
/// assert_eq!(path.moves[1].motion, osculate_tools::cl::Motion::Feed(254.0));
/// // No feed before the first cut: refused with its line.
/// assert_eq!(read("RAPID\nGOTO/0,0,5\nGOTO/0,0,0\n").err(), Some(ClReadError::NoFeed { line: 3 }));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Where a number or axis cannot be read, a feed is unknown, or there is no point at all.
pub fn read(text: &str) -> Result<ClData, ClReadError> {
    let mut reader = ClReader::default();
    for line in text.lines() {
        reader.line(line)?;
    }
    reader.end()?;
    let mut diagnostics = reader.diagnostics();
    reader.one_tool_only(&mut diagnostics);
    let path = ClPath { cutter: reader.cutter(), spindle_rpm: reader.spindle_rpm(), ..reader.path };
    Ok(ClData { path, diagnostics })
}

impl ClReader {
    /// Before the first line.
    #[must_use]
    pub fn new(options: ClReadOptions) -> Self {
        Self {
            path: ClPath::default(),
            first: true,
            ended: false,
            joiner: Joiner::default(),
            options,
            diagnostics: Vec::new(),
            unit_mm: 1.0,
            axis: Vec3::z_axis(),
            tip: None,
            feed: None,
            surface_mm_min: None,
            rapid: false,
            sections: Vec::new(),
            said: Said::default(),
            compensated: false,
            arc: None,
            heading: None,
            cycle: None,
            in_cycle: false,
            placing: Placing::default(),
            world: false,
            others: BTreeMap::new(),
        }
    }

    /// One line; those after `FINI` are ignored.
    ///
    /// # Errors
    /// Where a number or axis cannot be read or a feed is unknown.
    pub fn line(&mut self, line: &str) -> Result<(), ClReadError> {
        if self.ended {
            return Ok(());
        }
        match self.joiner.line(line) {
            Some(item) => self.item(item),
            None => Ok(()),
        }
    }

    /// The end of the text.
    ///
    /// # Errors
    /// As [`Self::line`], and where no point has come.
    pub fn end(&mut self) -> Result<(), ClReadError> {
        if !self.ended
            && let Some(item) = self.joiner.finish()
        {
            self.item(item)?;
        }
        self.open_arc()?;
        if self.first { Err(ClReadError::NoPoints { lines: self.joiner.lines }) } else { Ok(()) }
    }

    /// The points since the last call.
    pub fn take_moves(&mut self) -> std::vec::Drain<'_, ClMove> {
        self.path.moves.drain(..)
    }

    /// Points waiting to be taken.
    #[must_use]
    pub fn waiting(&self) -> usize {
        self.path.moves.len()
    }

    /// The first cutter, as far as the text has said it.
    #[must_use]
    pub fn cutter(&self) -> Option<CutterSpec> {
        self.first_tool().cutter
    }

    /// The first speed of the spindle, as far as the text has said it.
    #[must_use]
    pub fn spindle_rpm(&self) -> Option<f64> {
        self.first_tool().spindle.and_then(Spindle::rpm)
    }

    /// The coolant of the first tool.
    #[must_use]
    pub fn coolant(&self) -> Option<Coolant> {
        self.first_tool().coolant
    }

    /// The first tool: as its first point has it, and before that as the text has said until now.
    fn first_tool(&self) -> ClTool {
        self.sections.first().map_or(self.said.tool, |s| s.tool)
    }

    /// No point has come yet.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.first
    }

    /// Lines seen.
    #[must_use]
    pub const fn lines(&self) -> usize {
        self.joiner.lines
    }

    /// Findings so far, with line numbers.
    #[must_use]
    pub fn diagnostics(&self) -> Vec<Diagnostic> {
        let mut all = self.diagnostics.clone();
        self.report_others(&mut all);
        all
    }

    /// As it is, with nothing noticed so far.
    pub(super) fn without_findings(&self) -> Self {
        Self { diagnostics: Vec::new(), others: BTreeMap::new(), ..self.clone() }
    }

    pub(super) fn execute(&mut self, item: Item) -> Result<(), ClReadError> {
        match item {
            Item::Goto { line, numbers: n, count } => {
                if count == 6 {
                    self.axis = unit(line, Vec3::new(n[3], n[4], n[5]))?;
                }
                self.arrive(line, Point3::new(n[0], n[1], n[2]) * self.unit_mm)
            }
            Item::Other(s) => {
                self.statement(&s)?;
                self.ended |= s.word == "FINI";
                Ok(())
            }
        }
    }

    fn statement(&mut self, s: &Statement) -> Result<(), ClReadError> {
        match s.word.as_str() {
            "GOTO" => self.goto(s)?,
            "GODLTA" => self.delta(s)?,
            "FROM" => {
                self.rapid = true;
                self.goto(s)?;
            }
            "RAPID" => self.rapid = true,
            "FEDRAT" => self.feed(s)?,
            "UNITS" | "UNIT" => self.units(s),
            "SPINDL" => self.spindle(s)?,
            "CUTTER" => self.cutter_word(s)?,
            "LOADTL" | "LOAD" => self.load(s)?,
            "COOLNT" => self.coolant_word(s),
            "DELAY" => self.delay(s)?,
            "STOP" => self.say_later(s.line, AuxiliaryWord::Stop),
            "OPSTOP" => self.say_later(s.line, AuxiliaryWord::OptionalStop),
            "CUTCOM" => self.compensation(s),
            "TLAXIS" => self.axis = axis(s, &numbers(s, &s.fields)?)?,
            "CIRCLE" | "MOVARC" => self.arc(s)?,
            "INDIRV" => self.heading = Some(vector(s, &numbers(s, &s.fields)?)?),
            "PARTNO" | "FINI" | "MULTAX" => {}
            word if word.ends_with("GOFWD") && s.fields.first().is_some_and(|f| f.contains("CIRCLE")) => {
                self.catia_arc(s)?;
            }
            "CYCLE" => self.cycle(s)?,
            "TRACUT" => self.tracut(s)?,
            word => {
                if word.starts_with("CYCLE") {
                    self.in_cycle = s.fields.first().is_none_or(|f| f != "OFF");
                }
                if word == "TRNTYP" {
                    self.world = s.fields.first().is_some_and(|f| f == "WORLD");
                }
                let harmless = HARMLESS.contains(&word)
                    || is_identity(s)
                    || (self.world && matches!(word, "CSYS" | "TRNTYP"));
                self.other(word, s.line, if harmless { Taken::Harmless } else { Taken::Lost });
            }
        }
        Ok(())
    }

    pub(super) fn other(&mut self, word: &str, line: usize, taken: Taken) {
        let entry = self.others.entry((word.to_string(), taken)).or_default();
        if entry.0.len() < LISTED_LINES {
            entry.0.push(line);
        }
        entry.1 += 1;
    }

    fn goto(&mut self, s: &Statement) -> Result<(), ClReadError> {
        let n = numbers(s, &s.fields)?;
        match n[..] {
            [_, _, _] => {}
            [_, _, _, _, _, _] => self.axis = axis(s, &n[3..])?,
            _ => return Err(count(s, n.len(), "3 (tip) or 6 (tip and axis)")),
        }
        self.arrive(s.line, Point3::new(n[0], n[1], n[2]) * self.unit_mm)
    }

    fn delta(&mut self, s: &Statement) -> Result<(), ClReadError> {
        let n = numbers(s, &s.fields)?;
        let from = self.tip.ok_or_else(|| count(s, n.len(), "a GOTO/ or FROM/ before it"))?;
        let by = match n[..] {
            [along] => self.axis.into_inner() * along,
            [x, y, z] => Vec3::new(x, y, z),
            _ => return Err(count(s, n.len(), "1 (along the axis) or 3")),
        };
        self.arrive(s.line, from + by * self.unit_mm)
    }

    pub(super) fn arrive(&mut self, line: usize, tip: Point3) -> Result<(), ClReadError> {
        self.settle(line);
        if let Some(cycle) = self.cycle.clone() {
            return self.hole(line, tip, &cycle);
        }
        let motion = match (self.rapid, self.feed) {
            (true, _) => Motion::Rapid,
            (false, _) if self.first => {
                let text = "the first point comes without RAPID: it leads from an unknown place and is taken as rapid";
                self.note(line, text);
                Motion::Rapid
            }
            (false, Some(feed)) => Motion::Feed(self.feed_mm_min(&feed, &tip)?),
            // The cycle says how a hole is made; it is reported as not interpreted, its points are kept.
            (false, None) if self.in_cycle => Motion::Rapid,
            (false, None) => return Err(ClReadError::NoFeed { line }),
        };
        self.rapid = false;
        if let Some(arc) = self.arc.take() {
            self.round(line, &arc, (tip, motion))?;
        }
        self.push(tip, motion);
        Ok(())
    }

    pub(super) fn push(&mut self, tip: Point3, motion: Motion) {
        self.first = false;
        self.tip = Some(tip);
        if let Some(section) = self.sections.last_mut() {
            section.begins_at_feed |= section.moves == 0 && motion != Motion::Rapid;
            section.moves += 1;
        }
        let (tip, axis) = self.placing.place(tip, self.axis);
        self.path.moves.push(ClMove { pose: Pose { tip, axis }, motion, aloft: false });
    }

    fn note(&mut self, line: usize, text: &str) {
        self.diagnostics.push(Diagnostic::note(place(line), text));
    }

    fn report_others(&self, all: &mut Vec<Diagnostic>) {
        for ((word, taken), (lines, times)) in &self.others {
            let listed: Vec<String> = lines.iter().map(usize::to_string).collect();
            let more = if *times > lines.len() { ", ..." } else { "" };
            let at = format!("line {}{more}", listed.join(", "));
            let what = match taken {
                Taken::Lost => "is not interpreted and may change the tool's way".to_string(),
                Taken::Harmless => "is not interpreted; it does not change the tool's way".to_string(),
                Taken::Chords => format!("is read as chords within {} mm", self.options.arc_tol_mm),
                Taken::Moves => "is read as the moves that it stands for".to_string(),
                Taken::Placed => "is put into the points".to_string(),
                Taken::Copied => "is made: its statements come again".to_string(),
                Taken::Centre => "is left out: points are the cutter's centre, as asked; wear is not \
                                  compensated at the control"
                    .to_string(),
            };
            let text = format!("{word} ({times} x) {what}");
            let lost = *taken == Taken::Lost;
            all.push(if lost { Diagnostic::loss(at, text) } else { Diagnostic::note(at, text) });
        }
    }
}
