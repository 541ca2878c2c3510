//! The machine of a job with its control: what it is posted for, tried on a path of two points when the job is read.

use crate::failure::{Failure, read_text};
use crate::job::Tool;
use crate::job::check::line;
use crate::job::language::Language;
use crate::job::problem::Places;
use crate::job::raw;
use crate::job::words::{CoolantWord, FeedWord};
use crate::triangles::triangles;
use osculate_geom::{Diagnostic, Point3, Vec3};
use osculate_postproc::feed::FeedMode;
use osculate_postproc::nc::{Coolant, Dialect};
use osculate_postproc::{
    Machine, MachineError, PostError, PostOptions, Setup, built_in_names, built_in_text, post,
};
use osculate_tools::Pose;
use osculate_tools::cl::{ClMove, ClPath, Motion};
use std::path::Path;

/// Largest rise of F from block to block for `kz` where the job gives none, mm/min.
const DEFAULT_KZ_STEP: f64 = 200.0;
/// What a job without a machine is posted for.
const DEFAULT_MACHINE: &str = "trunnion-ac";
/// The language of a job that names none.
const DEFAULT_DIALECT: Dialect = Dialect::Sinumerik;

/// The table's name.
const TABLE: &str = "machine";

/// A machine with the control's language and feed mode.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Control {
    /// The machine.
    pub machine: Machine,
    /// Its description as it stands in its file.
    pub machine_toml: String,
    /// The dialect that makes and reads its programs.
    pub dialect: Dialect,
    /// The language of its programs: the dialect's, or one with words of its own.
    pub language: Language,
    /// How F is programmed.
    pub feed: FeedMode,
    /// As the job names it.
    pub dialect_name: String,
    /// As the job names it.
    pub feed_name: String,
    /// Extension of program files.
    pub extension: String,
}

/// The words of a control, from a command line.
pub struct Words<'a> {
    /// A built-in name.
    pub name: Option<&'a str>,
    /// A machine file.
    pub file: Option<&'a Path>,
    /// The language.
    pub dialect: &'a str,
    /// The feed mode.
    pub feed: &'a str,
    /// For `kz`.
    pub kz_step: Option<f64>,
}

impl Control {
    /// The control that the words describe.
    pub fn from_words(words: &Words<'_>) -> Result<Self, Failure> {
        let machine = machine(words.name, words.file)?;
        let language = Language::of_word(words.dialect)?;
        let feed = FeedWord::of(words.feed)
            .ok_or_else(|| Failure::unknown("feed", "feed mode", words.feed, FeedWord::WORDS))?;
        Ok(Self::new(machine, language, feed, words.kz_step))
    }

    fn new(
        (machine, machine_toml): (Machine, String),
        language: Language,
        feed: FeedWord,
        kz_step: Option<f64>,
    ) -> Self {
        let step_mm_min = kz_step.unwrap_or(DEFAULT_KZ_STEP);
        let mode = match feed {
            FeedWord::Tcp => FeedMode::Tcp,
            FeedWord::None => FeedMode::None,
            FeedWord::Kf => FeedMode::Kf,
            FeedWord::Kv => FeedMode::Kv { fgref_mm: None },
            FeedWord::Kz => FeedMode::Kz { step_mm_min, fgref_mm: None },
            FeedWord::InverseTime => FeedMode::InverseTime,
            FeedWord::Rotary => FeedMode::RotaryOnly,
            FeedWord::Fastest => FeedMode::Fastest { tip_mm_min: None },
        };
        Self {
            machine,
            machine_toml,
            dialect: language.engine,
            feed: mode,
            dialect_name: language.name().to_owned(),
            feed_name: feed.word().to_owned(),
            extension: language.extension().to_owned(),
            language,
        }
    }

    /// The same with tool-centre-point control.
    pub fn by_tip(&self) -> Self {
        Self { feed: FeedMode::Tcp, feed_name: FeedWord::Tcp.word().to_owned(), ..self.clone() }
    }

    /// The control of a job, which has its words tried.
    pub(super) fn of(places: &Places, t: Option<&raw::Machine>, tool: &Tool) -> Result<Self, Failure> {
        let none = raw::Machine::default();
        let given = t.unwrap_or(&none);
        let file = given.file.as_ref().map(|f| crate::failure::beside(places.path(), f));
        let name = match (t, given.name.as_deref(), &file) {
            (None, ..) => Some(DEFAULT_MACHINE),
            (_, None, None) => {
                let what = format!("needs name = one of {} or file = \"...\"", built_in_names().join(", "));
                return Err(places.refuse(TABLE, "", what));
            }
            (_, Some(_), Some(_)) => {
                return Err(places.refuse(TABLE, "file", "has both name and file; keep one of them"));
            }
            (_, name, _) => name,
        };
        let machine = machine(name, file.as_deref()).map_err(|e| {
            let key = if file.is_some() { "file" } else { "name" };
            places.refuse(TABLE, key, e.message())
        })?;
        let language = match (given.dialect.as_deref(), &given.dialect_file) {
            (None, None) => DEFAULT_DIALECT.into(),
            (Some(name), None) => {
                Language::named(name).map_err(|e| places.refuse(TABLE, "dialect", e.message()))?
            }
            (None, Some(file)) => {
                let path = crate::failure::beside(places.path(), file);
                Language::of_file(&path).map_err(|e| places.refuse(TABLE, "dialect_file", e.message()))?
            }
            (Some(_), Some(_)) => {
                return Err(places.refuse(
                    TABLE,
                    "dialect_file",
                    "has both dialect and dialect_file; keep one of them",
                ));
            }
        };
        let control = Self::new(machine, language, given.feed.unwrap_or_default(), given.kz_step);
        control.tried(places, tool)?;
        Ok(control)
    }

    /// Refuses a combination that no path could be posted for: the words are asked for with a path of two points.
    fn tried(&self, places: &Places, tool: &Tool) -> Result<(), Failure> {
        let at = |x: f64, motion: Motion| ClMove {
            pose: Pose { tip: Point3::new(x, 0.0, 0.0), axis: Vec3::z_axis() },
            motion,
            aloft: false,
        };
        let moves = vec![at(0.0, Motion::Rapid), at(1.0, Motion::Feed(1000.0))];
        let path = ClPath { cutter: Some(tool.spec()), moves, ..ClPath::default() };
        let setup = Setup::at(Vec3::zeros(), tool.cutter().length_mm());
        match post(&path, &self.machine, &setup, &PostOptions::new(self.dialect, self.feed)) {
            Err(e @ (PostError::Write(_) | PostError::Orientation | PostError::Feed { .. })) => {
                let (d, f) = (&self.dialect_name, &self.feed_name);
                let what = format!(
                    "{} cannot be posted in dialect = \"{d}\" with feed = \"{f}\": {e}",
                    self.machine.name()
                );
                let key = if places.has(TABLE, "feed") { "feed" } else { "dialect" };
                let others = FeedWord::WORDS.iter().filter(|w| **w != f).copied().collect::<Vec<_>>();
                Err(places.full(
                    TABLE,
                    key,
                    what,
                    format!("another dialect, or feed one of {}", others.join(", ")),
                    None,
                ))
            }
            // Where this path goes says nothing of the job's.
            _ => Ok(()),
        }
    }
}

/// The machine of a file, with its text. What stands in a file that is none is not repeated.
pub fn machine_file(file: &Path) -> Result<(Machine, String), Failure> {
    let text = read_text(file)?;
    let meshes = |name: &str| {
        let beside = file.parent().map_or_else(|| name.into(), |folder| folder.join(name));
        triangles(&beside).map_err(|e| e.message().to_owned())
    };
    let machine = Machine::from_toml_with(&text, &meshes).map_err(|e| match &e {
        MachineError::Toml(e) => {
            let at = e.span().map_or_else(String::new, |s| format!(", line {}", line(&text, s.start)));
            Failure::file(file, format!("is no machine{at}: {}", e.message().trim_end()))
        }
        e => Failure::file(file, e),
    })?;
    Ok((machine, text))
}

/// A built-in machine or one of a file, with its description.
fn machine(name: Option<&str>, file: Option<&Path>) -> Result<(Machine, String), Failure> {
    match (name, file) {
        (_, Some(file)) => machine_file(file),
        (Some(name), None) => {
            let machine = Machine::built_in(name)
                .map_err(|_| Failure::unknown("machine", "built-in machine", name, &built_in_names()))?;
            Ok((machine, built_in_text(name).unwrap_or_default().to_owned()))
        }
        (None, None) => Err(Failure::job(format!(
            "a machine is needed: name = one of {} or file = \"...\"",
            built_in_names().join(", ")
        ))),
    }
}

/// What a job leaves to the program.
pub(super) fn assumed(control: &Control) -> Diagnostic {
    let (m, d, f) = (control.machine.name(), &control.dialect_name, &control.feed_name);
    Diagnostic::warning("machine", format!("the job names none: posted for {m}, {d}, feed {f}"))
}

/// The coolant of a word.
pub(super) const fn coolant(word: CoolantWord) -> Option<Coolant> {
    match word {
        CoolantWord::Off => None,
        CoolantWord::Flood => Some(Coolant::Flood),
        CoolantWord::Mist => Some(Coolant::Mist),
    }
}

/// A work offset that a dialect has.
pub(super) fn work_offset(places: &Places, dialect: Dialect, word: &str) -> Result<String, Failure> {
    let number = |prefix: &str| word.strip_prefix(prefix).and_then(|n| n.parse::<u32>().ok());
    let within = |n: Option<u32>, lo: u32, hi: u32| n.is_some_and(|n| (lo..=hi).contains(&n));
    let (good, expected) = match dialect {
        Dialect::Sinumerik => {
            (within(number("G"), 54, 57) || within(number("G"), 505, 599), "G54 to G57 or G505 to G599")
        }
        Dialect::Fanuc => (
            within(number("G"), 54, 59) || within(number("G54.1 P"), 1, 300),
            "G54 to G59 or G54.1 P1 to G54.1 P300",
        ),
        Dialect::LinuxCnc => {
            (within(number("G"), 54, 59) || within(number("G59."), 1, 3), "G54 to G59 or G59.1 to G59.3")
        }
        Dialect::Heidenhain => (within(number(""), 0, 9999), "the number of a preset, 0 to 9999"),
    };
    if good {
        return Ok(word.to_owned());
    }
    let what = format!("work_offset = \"{word}\" must be {expected} in {}", dialect.name());
    Err(places.full(TABLE, "work_offset", what, expected.to_owned(), None))
}
