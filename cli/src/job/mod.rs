//! The job file: TOML with units in its keys, read into one value in which everything is checked.

pub mod builtin;
mod check;
pub mod control;
mod cutting;
pub mod editor;
pub mod flank;
mod keys;
pub mod language;
pub mod library;
mod operation;
mod operations;
pub mod part;
pub mod problem;
mod raw;
pub mod reference;
mod repeat;
pub mod roughing;
pub mod schema;
mod setup;
pub mod stock;
pub mod strategy;
#[cfg(test)]
mod tests;
pub mod tool;
mod values;
pub mod words;

use crate::failure::{Failure, read_text};
pub use control::Control;
use cutting::{feed_mm_min, layer_mm};
pub use flank::Flank;
pub use operation::{Circumstances, Operation};
pub use operations::{Clamping, Operations};
use osculate_geom::Axis;
use osculate_productivity::plan::{ThreeAxis, Tolerance};
use osculate_productivity::rate::FeedLimit;
pub use part::{FaceChoice, Part, Source};
use problem::Places;
use raw::Raw;
pub use repeat::Repeat;
pub use setup::Setup;
use std::path::Path;
use std::sync::Arc;
pub use stock::{Blank, Fixture, Stock};
pub use strategy::Strategy;
pub use tool::Tool;
pub use words::{Accept, EffortWord, Gouges, LeanKey, Normals, OperationWord, Turns};

/// Gouge and chord of a job that gives none, of the scallop.
const SHARES: [f64; 2] = [0.5, 0.2];

/// A job in which everything is checked, with one of its tools in hand.
#[derive(Debug, Clone)]
pub struct Job {
    told: Arc<Told>,
    /// None until one of them is taken: the first, which is the only one of most jobs.
    hand: Option<usize>,
    /// What a search gives it of its own.
    own: Overrides,
    /// The strategy then, where that is another than the file's.
    kept: Option<Strategy>,
}

/// What a search may give a job in place of what a file leaves open.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Overrides {
    /// The share of the scallop that the marks of teeth take at most on a plane, less than a half: the feed is held down for that.
    pub mark_share: Option<f64>,
    /// The chord tolerance, mm.
    pub chord_mm: Option<f64>,
    /// How far controls may leave the way at corners, mm.
    pub blend_mm: Option<f64>,
    /// Passes of a tool that keeps its axis.
    pub three_axis: Option<ThreeAxis>,
    /// Area that passes leave to other operations and that is accepted, mm2.
    pub unreached_mm2: Option<f64>,
}

/// What a file tells.
#[derive(Debug)]
struct Told {
    places: Places,
    part: Part,
    tools: Vec<Tool>,
    /// Of each tool, whatever the marks of its teeth.
    feeds_mm_min: Vec<(f64, FeedLimit)>,
    /// With each tool.
    layers_mm: Vec<f64>,
    tolerance: Tolerance,
    gives_chord: bool,
    /// Whether it is judged in a program with others that keep their axis.
    beside_kept: bool,
    unreached_mm2: f64,
    strategy: Strategy,
    control: Control,
    /// Whether the control is the job's own.
    names_machine: bool,
    work_offset: Option<String>,
    program_number: Option<u32>,
    setup: Setup,
    contact: Option<Contact>,
    stock: Option<Stock>,
    fixture: Option<Fixture>,
    flank: Flank,
    verification: Verification,
}

/// The feed at one contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ContactFeed {
    /// Along the line of constant parameter.
    Along(Axis),
    /// Along the geodesic at this angle from S_u towards S_v, rad.
    Angle(f64),
}

/// One contact, for `strip`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Surface parameters.
    pub at: [f64; 2],
    /// Height above the contact.
    pub lift_mm: f64,
    /// The feed.
    pub feed: ContactFeed,
}

/// How densely to verify, and what a verdict must rest on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Verification {
    /// Distance between samples; from the strip width where not given.
    pub spacing_mm: Option<f64>,
    /// Most samples.
    pub max_samples: Option<usize>,
    /// What a verdict must rest on.
    pub accept: Accept,
}

impl Contact {
    fn of(places: &Places, t: &raw::Contact) -> Result<Self, Failure> {
        let feed = match (t.along, t.angle_deg) {
            (Some(words::AxisWord::U), None) => ContactFeed::Along(Axis::U),
            (Some(words::AxisWord::V), None) => ContactFeed::Along(Axis::V),
            (None, Some(deg)) => ContactFeed::Angle(deg.to_radians()),
            _ => {
                let what = "needs either along = \"u\" or \"v\", or angle_deg";
                return Err(places.refuse("contact", "", what));
            }
        };
        Ok(Self { at: t.at, lift_mm: t.lift_mm, feed })
    }
}

/// The tools, of which there is at least one.
fn tools(places: &Places, raw: &Raw) -> Result<Vec<Tool>, Failure> {
    match (&raw.tool, raw.tools.as_deref()) {
        (Some(one), None) => Ok(vec![Tool::of(places, "tool", (one, 1), &raw.cutting)?]),
        (Some(_), Some(_)) => {
            Err(places.refuse("", schema::TOOLS, "has both [tool] and [[tools]]; keep one of them"))
        }
        (None, None) => Err(places.refuse("", "", "needs a [tool] table, or [[tools]] to choose from")),
        (None, Some([])) => {
            let what = "tools = []: the list of tools is empty; give at least one";
            Err(places.refuse("", schema::TOOLS, what))
        }
        (None, Some(all)) => {
            let made: Vec<Tool> = all
                .iter()
                .zip(1..)
                .map(|(t, k)| Tool::of(places, &format!("{}[{k}]", schema::TOOLS), (t, k), &raw.cutting))
                .collect::<Result<_, _>>()?;
            for (k, tool) in made.iter().enumerate() {
                if made[..k].iter().any(|t| t.number() == tool.number()) {
                    let table = format!("{}[{}]", schema::TOOLS, k + 1);
                    let what = format!("number = {} is that of a tool before it", tool.number());
                    return Err(places.refuse(&table, "number", what));
                }
            }
            Ok(made)
        }
    }
}

impl Told {
    fn of(places: Places, raw: &Raw) -> Result<Self, Failure> {
        let tools = tools(&places, raw)?;
        let strategy = Strategy::of(&places, &raw.strategy, tools.len())?;
        let t = &raw.tolerance;
        let feeds_mm_min = tools.iter().map(|t| feed_mm_min(&places, t)).collect::<Result<_, _>>()?;
        // What operations before left is known place by place: links ask it how high it stands.
        let layers = || tools.iter().map(|tool| layer_mm(raw, tool)).fold(0.0, f64::max);
        let highest_mm = if raw.standing_mm.is_some() { 0.0 } else { layers() };
        let setup = Setup::of(&places, &raw.setup, &strategy, highest_mm)?;
        let contact = raw.contact.as_ref().map(|c| Contact::of(&places, c)).transpose()?;
        let control = Control::of(&places, raw.machine.as_ref(), &tools[0])?;
        let machine = raw.machine.as_ref();
        let offset = machine.and_then(|m| m.work_offset.as_deref());
        let work_offset = offset.map(|w| control::work_offset(&places, control.dialect, w)).transpose()?;
        let stock = raw.stock.as_ref().map(|s| Stock::of(&places, s)).transpose()?;
        let fixture = raw.fixture.as_ref().map(|f| Fixture::of(&places, f)).transpose()?;
        let part = Part::of(&places, &raw.part)?;
        if strategy.layers().is_some() && stock.is_none() {
            let what = format!(
                "{} needs the raw material: add [stock] with box_mm, cylinder, file or allowance_mm",
                strategy.name()
            );
            return Err(places.refuse("strategy", "kind", what));
        }
        Ok(Self {
            part,
            feeds_mm_min,
            layers_mm: tools.iter().map(|tool| layer_mm(raw, tool)).collect(),
            tools,
            tolerance: Tolerance {
                scallop_mm: t.scallop_mm,
                gouge_mm: t.gouge_mm.unwrap_or(SHARES[0] * t.scallop_mm),
                chord_mm: t.chord_mm.unwrap_or(SHARES[1] * t.scallop_mm),
            },
            beside_kept: raw.beside_kept,
            gives_chord: places.has("tolerance", "chord_mm"),
            unreached_mm2: t.unreached_mm2.unwrap_or(0.0),
            strategy,
            names_machine: machine.is_some(),
            work_offset,
            program_number: machine.and_then(|m| m.program_number),
            control,
            setup,
            contact,
            stock,
            fixture,
            flank: Flank::of(&raw.flank),
            verification: Verification {
                spacing_mm: raw.verification.spacing_mm,
                max_samples: raw.verification.max_samples,
                accept: raw.verification.accept.unwrap_or_default(),
            },
            places,
        })
    }
}

impl Job {
    /// The job of a text. Files that it names are looked for beside `path`.
    ///
    /// ```
    /// use osculate::Job;
    /// use std::path::Path;
    ///
    /// let text = r#"
    /// format = 1
    /// part = { builtin = { kind = "plane", half_size_mm = 5 } }
    /// tool = { kind = "ball", diameter_mm = 6, length_mm = 40 }
    /// tolerance = { scallop_mm = 0.1 }
    /// "#;
    /// let job = Job::from_toml(text, Path::new("plane.toml"))?;
    /// // Half of the scallop for gouges, a fifth for chords, where the job says nothing else.
    /// let tolerance = job.tolerance();
    /// assert!((tolerance.gouge_mm - 0.05).abs() < 1e-12 && (tolerance.chord_mm - 0.02).abs() < 1e-12);
    /// // A key that nobody knows: line, key, and the one that may be meant.
    /// let slip = Job::from_toml(&text.replace("scallop_mm", "scalop_mm"), Path::new("plane.toml"));
    /// let message = slip.expect_err("there is no such key").to_string();
    /// assert!(message.contains("plane.toml") && message.contains("scallop_mm"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Names line, key, value and what was expected; everything that can be told without the part is.
    pub fn from_toml(text: &str, path: &Path) -> Result<Self, Failure> {
        if let Some((Operations::FORMAT, line)) = check::format(text) {
            let what =
                "format = 2 must be 1 here: a list of operations is taken by plan, verify, check and post";
            return Err(Failure::file(path, format!("line {line}: {what}")));
        }
        let places = check::places(text, path, &keys::ONE)?;
        let raw: Raw = toml::from_str(text).map_err(|e| Failure::file(path, e.to_string().trim_end()))?;
        Self::of(places, &raw)
    }

    /// The job of the tables of a file.
    fn of(places: Places, raw: &Raw) -> Result<Self, Failure> {
        Ok(Self { told: Arc::new(Told::of(places, raw)?), hand: None, own: Overrides::default(), kept: None })
    }

    /// The job of a file.
    ///
    /// # Errors
    /// As [`Job::from_toml`].
    pub fn load(path: &Path) -> Result<Self, Failure> {
        Self::from_toml(&read_text(path)?, path)
    }

    /// The job of a file, which must have a single tool.
    ///
    /// # Errors
    /// As [`Job::from_toml`], and where there are several tools.
    pub fn load_with_one_tool(path: &Path) -> Result<Self, Failure> {
        let job = Self::load(path)?;
        job.one_tool()?;
        Ok(job)
    }

    /// Refuses a job of several tools of which none is in hand.
    ///
    /// # Errors
    /// Where there are several; a job of [`Job::each_tool`], and that of a plan, has one in hand.
    pub fn one_tool(&self) -> Result<(), Failure> {
        if self.told.tools.len() > 1 && self.hand.is_none() {
            let what = "has several [[tools]] where one is needed: copy the job with the one meant as [tool]";
            return Err(self.refuse("", schema::TOOLS, what));
        }
        Ok(())
    }

    /// All tables and keys of job files: what the checks, the reference and the template are made of.
    ///
    /// ```
    /// use osculate::Job;
    ///
    /// let schema = Job::schema();
    /// let scallop = schema.key("tolerance", "scallop_mm").expect("every job has it");
    /// assert!(scallop.default.is_none() && schema.needs("tolerance"));
    /// println!("{}: {}", scallop.name, scallop.meaning);
    /// ```
    #[must_use]
    pub fn schema() -> &'static schema::Schema {
        &keys::ONE
    }

    /// A failure at a key of the file.
    #[must_use]
    pub fn refuse(&self, table: &str, key: &str, what: impl std::fmt::Display) -> Failure {
        self.told.places.refuse(table, key, what)
    }

    /// A failure at a key, of something that has been found wrong already.
    #[must_use]
    pub fn lacks(&self, table: &str, key: &str, found: problem::Problem) -> Failure {
        self.told.places.lacks(table, key, found)
    }
}
