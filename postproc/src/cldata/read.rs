//! Reading APT text of this and of other systems.
//!
//! What describes the tool's way is read: `GOTO`, `GODLTA`, `FROM`, `FEDRAT`, `RAPID`, `UNITS`, `SPINDL`, `CUTTER`,
//! `TLAXIS`. Everything else is reported by word with its lines: as a loss where it may change the way (cycles, arcs,
//! transformations, unknown words), as a note where it does not (coolant, texts). A `GOTO` without an axis keeps the
//! last one, at first (0, 0, 1).

use std::collections::BTreeMap;

use osculate_geom::{Diagnostic, Point3, Unit3, Vec3};
use osculate_tools::Pose;
use osculate_tools::cl::{ClMove, ClPath, Motion};

use super::cutter::{self, Found};
use super::statement::{Item, Statement, items};

/// A path and what was noticed on the way.
#[derive(Clone, Debug, PartialEq)]
pub struct ClData {
    /// The path.
    pub path: ClPath,
    /// Findings, with line numbers.
    pub diagnostics: Vec<Diagnostic>,
}

/// Why a text is no cutter location data. Lines count from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ClReadError {
    /// A field that should be a number.
    #[error("line {line}: '{field}' in {word}/ is not a finite number")]
    Number {
        /// Line.
        line: usize,
        /// Statement.
        word: String,
        /// The field as it stands there.
        field: String,
    },
    /// Too few or too many numbers.
    #[error("line {line}: {word}/ has {got} numbers, it needs {need}")]
    Count {
        /// Line.
        line: usize,
        /// Statement.
        word: String,
        /// Numbers found.
        got: usize,
        /// Numbers that would do.
        need: &'static str,
    },
    /// A tool axis of length zero.
    #[error("line {line}: the tool axis has length {length:.3e}: give a direction")]
    ZeroAxis {
        /// Line.
        line: usize,
        /// Its length.
        length: f64,
    },
    /// A feed per revolution without a speed.
    #[error("line {line}: FEDRAT per revolution before any SPINDL/ in rpm: put SPINDL/ first or use MMPM")]
    NoSpindle {
        /// Line.
        line: usize,
    },
    /// A feed that is not above zero.
    #[error("line {line}: a feed of {feed_mm_min} mm/min: it must be above zero")]
    Feed {
        /// Line.
        line: usize,
        /// What was read.
        feed_mm_min: f64,
    },
    /// A move at feed before any feed.
    #[error("line {line}: a move that is not RAPID before any FEDRAT/: the feed is unknown")]
    NoFeed {
        /// Line.
        line: usize,
    },
    /// Not one point.
    #[error("no GOTO/ or FROM/ in {lines} lines: this is no cutter location data, or in binary form")]
    NoPoints {
        /// Lines read.
        lines: usize,
    },
}

/// Words that say nothing about the tool's way.
const HARMLESS: &[&str] = &[
    "PPRINT",
    "INSERT",
    "TPRINT",
    "OPNAME",
    "REMARK",
    "COOLNT",
    "LOAD",
    "SELECT",
    "SELECTL",
    "TOOLNO",
    "MACHIN",
    "REWIND",
    "SEQNO",
    "STOP",
    "OPSTOP",
    "DELAY",
    "PAINT",
    "DISPLY",
    "END",
    "TRNTYP",
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

/// Lines of one word that are listed before the rest is only counted.
const LISTED_LINES: usize = 5;

/// A feed: per revolution it waits for the spindle's speed.
#[derive(Clone, Copy)]
struct Feed {
    mm: f64,
    per_turn: bool,
    line: usize,
}

struct Reader {
    path: ClPath,
    diagnostics: Vec<Diagnostic>,
    /// mm per unit of length.
    unit_mm: f64,
    axis: Unit3,
    tip: Option<Point3>,
    feed: Option<Feed>,
    rapid: bool,
    loaded: Option<String>,
    /// Between CYCLE/ and CYCLE/OFF, where points are holes.
    in_cycle: bool,
    /// Word -> (loses, lines).
    others: BTreeMap<String, (bool, Vec<usize>)>,
}

/// The path of an APT text.
///
/// # Errors
/// Where a number or axis cannot be read, a feed is unknown, or there is no point at all.
pub fn read(text: &str) -> Result<ClData, ClReadError> {
    let mut r = Reader {
        path: ClPath::default(),
        diagnostics: Vec::new(),
        unit_mm: 1.0,
        axis: Vec3::z_axis(),
        tip: None,
        feed: None,
        rapid: false,
        loaded: None,
        in_cycle: false,
        others: BTreeMap::new(),
    };
    items(text, |item| match item {
        Item::Goto { line, numbers: n, count } => {
            if count == 6 {
                r.axis = unit(line, Vec3::new(n[3], n[4], n[5]))?;
            }
            r.arrive(line, Point3::new(n[0], n[1], n[2]) * r.unit_mm)?;
            Ok(false)
        }
        Item::Other(s) => {
            r.statement(&s)?;
            Ok(s.word == "FINI")
        }
    })?;
    if r.path.moves.is_empty() {
        return Err(ClReadError::NoPoints { lines: text.lines().count() });
    }
    r.report_others();
    Ok(ClData { path: r.path, diagnostics: r.diagnostics })
}

impl Reader {
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
            "CUTTER" => self.cutter(s)?,
            "LOADTL" => self.load(s),
            "TLAXIS" => self.axis = axis(s, &numbers(s, &s.fields)?)?,
            "PARTNO" | "FINI" | "MULTAX" => {}
            word => {
                if word.starts_with("CYCLE") {
                    self.in_cycle = s.fields.first().is_none_or(|f| f != "OFF");
                }
                let loses = !HARMLESS.contains(&word) && !is_identity(s);
                let entry = self.others.entry(word.to_string()).or_insert((false, Vec::new()));
                entry.0 |= loses;
                entry.1.push(s.line);
            }
        }
        Ok(())
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

    fn arrive(&mut self, line: usize, tip: Point3) -> Result<(), ClReadError> {
        let first = self.path.moves.is_empty();
        let motion = match (self.rapid, self.feed) {
            (true, _) => Motion::Rapid,
            (false, _) if first => {
                let text = "the first point comes without RAPID: it leads from an unknown place and is taken as rapid";
                self.note(line, text);
                Motion::Rapid
            }
            (false, Some(feed)) => Motion::Feed(self.feed_mm_min(&feed)?),
            // The cycle says how a hole is made; it is reported as not interpreted, its points are kept.
            (false, None) if self.in_cycle => Motion::Rapid,
            (false, None) => return Err(ClReadError::NoFeed { line }),
        };
        self.rapid = false;
        self.tip = Some(tip);
        self.path.moves.push(ClMove { pose: Pose { tip, axis: self.axis }, motion });
        Ok(())
    }

    fn feed(&mut self, s: &Statement) -> Result<(), ClReadError> {
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

    fn feed_mm_min(&self, feed: &Feed) -> Result<f64, ClReadError> {
        match (feed.per_turn, self.path.spindle_rpm) {
            (false, _) => Ok(feed.mm),
            (true, Some(rpm)) if rpm > 0.0 => Ok(feed.mm * rpm),
            (true, _) => Err(ClReadError::NoSpindle { line: feed.line }),
        }
    }

    fn units(&mut self, s: &Statement) {
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

    fn spindle(&mut self, s: &Statement) -> Result<(), ClReadError> {
        if s.fields.iter().any(|f| f == "SFM" || f == "SMM") {
            let text = "SPINDL/ as a surface speed needs a turning diameter: the speed in rpm stays unknown";
            self.diagnostics.push(Diagnostic::loss(place(s.line), text));
            return Ok(());
        }
        let values: Vec<String> = s.fields.iter().filter(|f| !is_word(f)).cloned().collect();
        if let Some(&rpm) = numbers(s, &values)?.first() {
            let known = self.path.spindle_rpm;
            if self.path.moves.is_empty() || known.is_none() {
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

    fn cutter(&mut self, s: &Statement) -> Result<(), ClReadError> {
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
        if self.path.moves.is_empty() || self.path.cutter.is_none() {
            self.path.cutter = Some(spec);
        } else if self.path.cutter != Some(spec) {
            let text = "another CUTTER/ on the way; a path has one cutter, the first is kept";
            self.diagnostics.push(Diagnostic::loss(place(s.line), text));
        }
        Ok(())
    }

    fn load(&mut self, s: &Statement) {
        let tool = s.fields.first().cloned();
        if !self.path.moves.is_empty() && self.loaded.is_some() && tool != self.loaded {
            let text = format!(
                "tool change to {} on the way: the path goes on with the first tool",
                s.fields.join(",")
            );
            self.diagnostics.push(Diagnostic::loss(place(s.line), text));
        }
        self.loaded = self.loaded.take().or(tool);
    }

    fn note(&mut self, line: usize, text: &str) {
        self.diagnostics.push(Diagnostic::note(place(line), text));
    }

    fn report_others(&mut self) {
        for (word, (loses, lines)) in std::mem::take(&mut self.others) {
            let listed: Vec<String> = lines.iter().take(LISTED_LINES).map(usize::to_string).collect();
            let more = if lines.len() > LISTED_LINES { ", ..." } else { "" };
            let at = format!("line {}{more}", listed.join(", "));
            let times = lines.len();
            self.diagnostics.push(if loses {
                Diagnostic::loss(
                    at,
                    format!("{word} ({times} x) is not interpreted and may change the tool's way"),
                )
            } else {
                Diagnostic::note(
                    at,
                    format!("{word} ({times} x) is not interpreted; it does not change the tool's way"),
                )
            });
        }
    }
}

fn place(line: usize) -> String {
    format!("line {line}")
}

/// A coordinate system statement that leaves everything where it is.
fn is_identity(s: &Statement) -> bool {
    const IDENTITY: [f64; 12] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    matches!(s.word.as_str(), "CSYS" | "MATRIX" | "TRACUT")
        && (s.fields == ["NOMORE"] || numbers(s, &s.fields).is_ok_and(|n| n == IDENTITY))
}

fn is_word(field: &str) -> bool {
    field.starts_with(|c: char| c.is_ascii_alphabetic()) && field != "NAN" && field != "INF"
}

fn numbers(s: &Statement, fields: &[String]) -> Result<Vec<f64>, ClReadError> {
    let number = |f: &String| {
        let bad = || ClReadError::Number { line: s.line, word: s.word.clone(), field: f.clone() };
        // FORTRAN writes exponents with D.
        let value: f64 = f.replace('D', "E").parse().map_err(|_| bad())?;
        if value.is_finite() { Ok(value) } else { Err(bad()) }
    };
    fields.iter().map(number).collect()
}

fn count(s: &Statement, got: usize, need: &'static str) -> ClReadError {
    ClReadError::Count { line: s.line, word: s.word.clone(), got, need }
}

fn axis(s: &Statement, n: &[f64]) -> Result<Unit3, ClReadError> {
    let [x, y, z] = *n else { return Err(count(s, n.len(), "3 for an axis")) };
    unit(s.line, Vec3::new(x, y, z))
}

fn unit(line: usize, v: Vec3) -> Result<Unit3, ClReadError> {
    // A direction given with any sensible digits is far longer than this.
    Unit3::try_new(v, 1e-6).ok_or(ClReadError::ZeroAxis { line, length: v.norm() })
}
