//! Libraries of tools: a file of ours, or a table of another system, as tools of a job.
//!
//! A library of ours is TOML with `format = 1` and the `[[tool]]` tables of a list of operations. Lengths are mm, angles deg, feeds mm/min,
//! whatever unit a foreign file has. What a foreign file says of a tool and a job cannot hold is told, tool by tool; nothing is
//! guessed where a measure is missing.

mod found;
mod freecad;
mod fusion;
mod linuxcnc;
mod ours;

use found::Found;
pub use ours::toml;

use crate::failure::{Failure, read_text};
use crate::job::problem::Places;
use crate::job::{Tool, check, keys, raw, schema};
use osculate_geom::Diagnostic;
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The library that comes with the program.
const SHIPPED: &str = include_str!("../../../data/tools.toml");

/// Tools with what was found on reading them.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Library {
    /// As tables name it.
    pub format: &'static str,
    /// The tools, in the order of the file.
    pub tools: Vec<Tool>,
    /// Tools that are left out, and what of the others is.
    pub diagnostics: Vec<Diagnostic>,
}

/// Files by their paths, with what stands in them.
pub type Files = Vec<(PathBuf, String)>;

/// A unit of length that a table may be in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Unit {
    /// mm.
    Millimetre,
    /// 25.4 mm.
    Inch,
}

impl Unit {
    const fn mm(self) -> f64 {
        match self {
            Self::Millimetre => 1.0,
            Self::Inch => 25.4,
        }
    }
}

/// What a file is, by its ending.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Ours,
    LinuxCnc,
    Fusion,
    Bit,
    Bits,
}

impl Format {
    /// Endings with what they stand for.
    const ALL: [(&'static str, Self); 5] = [
        ("toml", Self::Ours),
        ("tbl", Self::LinuxCnc),
        ("json", Self::Fusion),
        ("fctb", Self::Bit),
        ("fctl", Self::Bits),
    ];

    fn of(path: &Path) -> Result<Self, Failure> {
        let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
        if ending == "tools" {
            let what = "is a packed library of Fusion: unpack it (it is a zip with a tools.json in it)";
            return Err(Failure::file(path, what));
        }
        let found = Self::ALL.iter().find(|(e, _)| *e == ending).map(|(_, format)| *format);
        found.ok_or_else(|| {
            let known = Self::ALL.map(|(e, _)| e);
            Failure::unknown(&path.display().to_string(), "library of tools that ends in", &ending, &known)
        })
    }

    const fn name(self) -> &'static str {
        match self {
            Self::Ours => "osculate",
            Self::LinuxCnc => "LinuxCNC",
            Self::Fusion => "Fusion",
            Self::Bit | Self::Bits => "FreeCAD",
        }
    }
}

/// The folder of the bits of a library: FreeCAD keeps them in `Bit` beside `Library`.
fn bits_of(library: &Path) -> PathBuf {
    let folder = library.parent().unwrap_or_else(|| Path::new(""));
    if folder.file_name().is_some_and(|n| n == "Library") {
        folder.with_file_name("Bit")
    } else {
        folder.to_path_buf()
    }
}

/// The file of a bit that a library names. What leads out of the folders around the library is none.
fn bit_of(library: &Path, name: &str) -> Option<PathBuf> {
    let plain = Path::new(name).file_name()?;
    let folder = library.parent().unwrap_or_else(|| Path::new(""));
    let around = [folder.to_path_buf(), folder.join("../Bit"), folder.join("../ToolBits")];
    around.iter().map(|f| f.join(plain)).find(|p| p.is_file())
}

#[derive(Deserialize)]
struct RawLibrary {
    #[allow(dead_code)]
    format: u32,
    #[serde(default)]
    tool: Vec<raw::Tool>,
}

impl Library {
    /// The tools that come with the program.
    ///
    /// # Errors
    /// None: they are checked by a test.
    pub fn shipped() -> Result<Self, Failure> {
        Self::from_toml(SHIPPED, Path::new("the tools of the program"))
    }

    /// The text of the library that comes with the program.
    #[must_use]
    pub const fn shipped_text() -> &'static str {
        SHIPPED
    }

    /// All tables and keys of libraries.
    #[must_use]
    pub fn schema() -> &'static schema::Schema {
        &keys::LIBRARY
    }

    /// The library of a file, by its ending: `.toml` is ours, `.tbl` LinuxCNC's, `.fctb` and `.fctl` FreeCAD's, `.json` Fusion's.
    ///
    /// # Errors
    /// Names the line or the tool, what was expected, and what to change.
    pub fn load(path: &Path) -> Result<Self, Failure> {
        Self::load_in(path, Unit::Millimetre)
    }

    /// As [`Library::load`], of a table that does not name its unit of length.
    ///
    /// # Errors
    /// As [`Library::load`].
    pub fn load_in(path: &Path, unit: Unit) -> Result<Self, Failure> {
        let refused = |why: String| Failure::file(path, why);
        let found = match Format::of(path)? {
            Format::Ours => return Self::from_toml(&read_text(path)?, path),
            Format::LinuxCnc => linuxcnc::read(&read_text(path)?, unit.mm()),
            Format::Fusion => fusion::read(&read_text(path)?).map_err(refused)?,
            Format::Bit => {
                let mut found = Found::default();
                freecad::read(&read_text(path)?, &path.display().to_string(), None, &mut found);
                found
            }
            Format::Bits => {
                let mut found = Found::default();
                for (number, file) in freecad::listed(&read_text(path)?).map_err(refused)? {
                    match bit_of(path, &file) {
                        Some(bit) => freecad::read(&read_text(&bit)?, &file, Some(number), &mut found),
                        None => {
                            let what = format!(
                                "left out: there is no such file beside the library, in ../Bit or ../ToolBits (tool {number})"
                            );
                            found.diagnostics.push(Diagnostic::warning(file, what));
                        }
                    }
                }
                found
            }
        };
        Self::of_found(found, path)
    }

    /// What a foreign file says, as tools; those that no job can have are left out and told.
    fn of_found(found: Found, path: &Path) -> Result<Self, Failure> {
        let Found { tools: raw, mut diagnostics } = found;
        let mut tools: Vec<Tool> = Vec::with_capacity(raw.len());
        let mut taken = BTreeSet::new();
        // From where the next free number is looked for: those before are taken, up to the one that was asked for.
        let mut free: BTreeMap<u32, u32> = BTreeMap::new();
        for (place, mut one) in raw {
            let wanted = one.number.unwrap_or(1);
            let from = free.entry(wanted).or_insert(wanted);
            let number = (*from..).find(|n| !taken.contains(n)).unwrap_or(wanted);
            *from = number;
            if one.number.is_some_and(|n| n != number) {
                let what = format!("number {wanted} is that of a tool before it: it is {number} here");
                diagnostics.push(Diagnostic::warning(place.clone(), what));
            }
            one.number = Some(number);
            let made = Tool::of(&Places::new(path), "tool", (&one, number), &raw::Cutting::default());
            match made.and_then(|tool| within_keys(tool, path)) {
                Ok(tool) => {
                    taken.insert(number);
                    tools.push(tool);
                }
                Err(why) => {
                    diagnostics.push(Diagnostic::warning(place, format!("left out: {}", why.problem().what)));
                }
            }
        }
        if tools.is_empty() {
            let why: String = diagnostics.iter().map(|d| format!("\n{d}")).collect();
            return Err(Failure::file(path, format!("holds no tools that a job can have{why}")));
        }
        Ok(Self { format: Format::of(path)?.name(), tools, diagnostics })
    }

    /// The library as the files of a format, by the ending of `path`, which is the first of them; what the format cannot hold is told.
    ///
    /// # Errors
    /// Where the ending is that of no format, or of a single bit and there are several tools.
    pub fn files(&self, path: &Path) -> Result<(Files, Vec<Diagnostic>), Failure> {
        let label = path.file_stem().map_or_else(|| "tools".to_owned(), |s| s.to_string_lossy().into_owned());
        let (text, told) = match Format::of(path)? {
            Format::Ours => {
                let tables: Vec<String> = self.tools.iter().map(|t| toml(t, t.number())).collect();
                (format!("format = 1\n\n{}", tables.join("\n")), Vec::new())
            }
            Format::LinuxCnc => (linuxcnc::write(&self.tools), Vec::new()),
            Format::Fusion => fusion::write(&self.tools),
            Format::Bits => {
                let (library, bits, told) = freecad::write(&self.tools, &label);
                let beside = bits_of(path);
                let bits = bits.into_iter().map(|(file, text)| (beside.join(file), text));
                return Ok((std::iter::once((path.to_path_buf(), library)).chain(bits).collect(), told));
            }
            Format::Bit => {
                let (_, mut bits, told) = freecad::write(&self.tools, &label);
                match (bits.pop(), bits.is_empty()) {
                    (Some((_, text)), true) => (text, told),
                    _ => {
                        let what = "a bit of FreeCAD is one tool: write a library, .fctl";
                        return Err(Failure::file(path, what));
                    }
                }
            }
        };
        Ok((vec![(path.to_path_buf(), text)], told))
    }

    /// The library of a text of ours.
    ///
    /// ```
    /// use osculate::job::library::{Library, toml};
    /// use std::path::Path;
    ///
    /// let text = "format = 1\n[[tool]]\nnumber = 5\nkind = \"ball\"\ndiameter_mm = 6\nlength_mm = 40\n";
    /// let library = Library::from_toml(text, Path::new("shop.toml"))?;
    /// assert_eq!(library.tools[0].cutter().radius_mm(), 3.0);
    /// // Written again it is the same tool.
    /// let again = format!("format = 1\n{}", toml(&library.tools[0], 5));
    /// assert_eq!(Library::from_toml(&again, Path::new("shop.toml"))?.tools[0].spec(), library.tools[0].spec());
    /// // A library comes with the program.
    /// assert!(!Library::shipped()?.tools.is_empty());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`Library::load`].
    pub fn from_toml(text: &str, path: &Path) -> Result<Self, Failure> {
        let places = check::places(text, path, &keys::LIBRARY)?;
        let raw: RawLibrary =
            ::toml::from_str(text).map_err(|e| Failure::file(path, e.to_string().trim_end()))?;
        if raw.tool.is_empty() {
            return Err(Failure::file(path, "holds no tools: give at least one [[tool]]"));
        }
        let tools = made(&places, &raw.tool)?;
        Ok(Self { format: "osculate", tools, diagnostics: Vec::new() })
    }
}

/// A tool whose values are within what the keys of a job allow: other programs write what they like.
fn within_keys(tool: Tool, path: &Path) -> Result<Tool, Failure> {
    let text = format!("format = 1\n\n{}", toml(&tool, tool.number()));
    check::places(&text, path, &keys::LIBRARY).map(|_| tool)
}

/// The tools of tables; each has a number of its own.
fn made(places: &Places, all: &[raw::Tool]) -> Result<Vec<Tool>, Failure> {
    let mut out: Vec<Tool> = Vec::with_capacity(all.len());
    let mut taken = BTreeSet::new();
    for (t, place) in all.iter().zip(1..) {
        let table = format!("tool[{place}]");
        let tool = Tool::of(places, &table, (t, place), &raw::Cutting::default())?;
        if !taken.insert(tool.number()) {
            let what = format!("number = {} is that of a tool before it", tool.number());
            return Err(places.refuse(&table, "number", what));
        }
        out.push(tool);
    }
    Ok(out)
}
