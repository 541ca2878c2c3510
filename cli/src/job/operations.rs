//! A job of several operations: one after the other on the same part, each from the material that the one before left.
//!
//! Each is a job of its own, made of the tables that all have in common and of its own: what plans or judges a job does an operation too.

use crate::failure::{Failure, beside, read_text};
use crate::job::operation::{self, Operation};
use crate::job::problem::Places;
use crate::job::raw::{self, Raw, RawList};
use crate::job::repeat::Repeat;
use crate::job::words::OperationWord;
use crate::job::{Job, check, keys, roughing, schema};
use std::path::Path;

/// How far rest passes go beyond what stands too high, of the tool's diameter.
const OVERLAP: f64 = 0.1;

/// How the part is held for some of the operations.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Clamping {
    /// As operations name it.
    pub name: String,
    /// The whole part held so, with all tools.
    pub job: Job,
}

/// A job of several operations in which everything is checked.
#[derive(Debug, Clone)]
pub struct Operations {
    text: String,
    places: Places,
    setups: Vec<Clamping>,
    all: Vec<Operation>,
    /// As the text names them.
    files: Vec<String>,
}

impl Operations {
    /// The format of files that hold operations.
    pub const FORMAT: i64 = 2;

    /// Whether a text is a job of operations.
    #[must_use]
    pub fn are_in(text: &str) -> bool {
        check::format(text).is_some_and(|(format, _)| format == Self::FORMAT)
    }

    /// All tables and keys of lists of operations.
    #[must_use]
    pub fn schema() -> &'static schema::Schema {
        &keys::LIST
    }

    /// The operations of a text. Files that it names are looked for beside `path`.
    ///
    /// ```
    /// use osculate::job::{Operations, OperationWord};
    /// use std::path::Path;
    ///
    /// let text = r#"
    /// format = 2
    /// part = { builtin = { kind = "paraboloid", a_per_mm = 0.01, b_per_mm = 0.02, half_size_mm = 6 } }
    /// stock = { box_mm = [-6, -6, -5, 6, 6, 4] }
    /// tolerance = { scallop_mm = 0.04 }
    /// machine = { name = "trunnion-ac", dialect = "linuxcnc" }
    /// tool = [
    ///     { number = 4, kind = "flat", diameter_mm = 6, length_mm = 30 },
    ///     { number = 7, kind = "ball", diameter_mm = 6, length_mm = 40 },
    /// ]
    /// [[operation]]
    /// name = "rough"
    /// kind = "rough"
    /// tools = [4]
    /// allowance_mm = 0.4
    /// [[operation]]
    /// name = "finish"
    /// kind = "finish"
    /// tools = [7]
    /// "#;
    /// assert!(Operations::are_in(text));
    /// let list = Operations::from_toml(text, Path::new("list.toml"))?;
    /// let kinds: Vec<OperationWord> = list.all().iter().map(|o| o.kind).collect();
    /// assert_eq!(kinds, [OperationWord::Rough, OperationWord::Finish]);
    /// // Each is a job of its own, with its tool.
    /// assert_eq!(list.all()[1].judged()?.tool().number(), 7);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Names line, key, value and what was expected; everything that can be told without the part is.
    pub fn from_toml(text: &str, path: &Path) -> Result<Self, Failure> {
        let places = check::places(text, path, &keys::LIST)?;
        let list: RawList =
            toml::from_str(text).map_err(|e| Failure::file(path, e.to_string().trim_end()))?;
        Self::of(text, places, &list)
    }

    /// The same job with operations, as they stand in a job file, in place of none.
    ///
    /// # Errors
    /// As [`Operations::from_toml`].
    pub fn with(&self, operations: &str) -> Result<Self, Failure> {
        Self::from_toml(&format!("{}\n{operations}", self.text.trim_end()), self.path())
    }

    /// The text that it was read from.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The files that it names, as the text has them.
    #[must_use]
    pub fn files(&self) -> &[String] {
        &self.files
    }

    /// The text with the files that it names by their full paths, so that it means the same in another folder.
    #[must_use]
    pub fn text_anywhere(&self) -> String {
        let mut out = self.text.clone();
        for file in &self.files {
            let full = beside(self.path(), file);
            let full = std::fs::canonicalize(&full).unwrap_or(full).display().to_string();
            let full = full.replace('\\', "\\\\").replace('"', "\\\"");
            for quote in ['"', '\''] {
                out = out.replace(&format!("{quote}{file}{quote}"), &format!("\"{full}\""));
            }
        }
        out
    }

    /// The operations of a file.
    ///
    /// # Errors
    /// As [`Operations::from_toml`].
    pub fn load(path: &Path) -> Result<Self, Failure> {
        Self::from_toml(&read_text(path)?, path)
    }

    fn of(text: &str, places: Places, list: &RawList) -> Result<Self, Failure> {
        numbered(&places, list)?;
        let names = setup_names(&places, list)?;
        let setups = names.iter().enumerate().map(|(k, name)| clamping(&places, list, (k, name)));
        let setups = setups.collect::<Result<Vec<_>, _>>()?;
        let mut all: Vec<Operation> = Vec::with_capacity(list.operation.len());
        let mut keep: Vec<(usize, bool)> = Vec::with_capacity(list.operation.len());
        for (k, own) in list.operation.iter().enumerate() {
            let made = composed(&places, list, (k, own), &names)?;
            if all.iter().any(|o| o.name == made.name) {
                let what = format!("name = \"{}\" is that of an operation before it", made.name);
                return Err(made.refuse("name", what));
            }
            if made.setup < all.last().map_or(0, |o| o.setup) {
                let what = format!(
                    "setup = \"{}\" comes after operations of a later one: the part is not put back; order the operations by setup",
                    names[made.setup]
                );
                return Err(made.refuse("setup", what));
            }
            // Everything that can be told of it is told now.
            let strategy = *made.judged()?.strategy();
            keep.push((made.setup, strategy.kept_axis().is_some() || strategy.layers().is_some()));
            all.push(made);
        }
        for (k, operation) in all.iter_mut().enumerate() {
            let mut others = keep.iter().enumerate().filter(|(j, _)| *j != k);
            operation.beside_kept = others.any(|(_, one)| *one == (operation.setup, true));
        }
        if let Some(first) = all.first().filter(|o| o.kind == OperationWord::Rest) {
            let what = "kind = \"rest\" cuts what operations before it left: there is none";
            return Err(first.refuse("kind", what));
        }
        let machine = list.machine.as_ref().and_then(|m| m.file.clone());
        let of_setups = list.setup.iter().flat_map(|s| s.fixtures.iter().flatten().cloned());
        let named = [list.part.file.clone(), list.stock.as_ref().and_then(|s| s.file.clone()), machine];
        let mut files: Vec<String> = named.into_iter().flatten().chain(of_setups).collect();
        files.sort();
        files.dedup();
        Ok(Self { text: text.to_owned(), places, setups, all, files })
    }

    /// The file it came from.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.places.path()
    }

    /// The job that the finished part is held against: all its faces, the tolerance of the whole.
    #[must_use]
    pub fn whole(&self) -> &Job {
        &self.setups[0].job
    }

    /// How the part is held, in order.
    #[must_use]
    pub fn setups(&self) -> &[Clamping] {
        &self.setups
    }

    /// The operations, in order.
    #[must_use]
    pub fn all(&self) -> &[Operation] {
        &self.all
    }
}

/// Refuses tools without a number or with one that another has, and a job without tools.
fn numbered(places: &Places, list: &RawList) -> Result<(), Failure> {
    if list.tool.is_empty() {
        return Err(places.refuse("", "tool", "needs at least one [[tool]] with its number"));
    }
    for (k, tool) in list.tool.iter().enumerate() {
        let table = format!("tool[{}]", k + 1);
        let Some(n) = tool.number else {
            return Err(places.refuse(&table, "", "needs number: programs call tools by it"));
        };
        if list.tool[..k].iter().any(|t| t.number == Some(n)) {
            return Err(places.refuse(&table, "number", format!("number = {n} is that of a tool before it")));
        }
    }
    Ok(())
}

/// The names of setups; one where none is given.
fn setup_names(places: &Places, list: &RawList) -> Result<Vec<String>, Failure> {
    let mut out: Vec<String> = Vec::new();
    for (k, setup) in list.setup.iter().enumerate() {
        let name = setup.name.clone().unwrap_or_else(|| usual_name(k));
        let table = format!("setup[{}]", k + 1);
        if out.contains(&name) {
            return Err(places.refuse(
                &table,
                "name",
                format!("name = \"{name}\" is that of a setup before it"),
            ));
        }
        if !name.chars().all(|c| c.is_ascii_alphanumeric() || "-_".contains(c)) {
            let what = format!("name = \"{name}\" names a file too: letters, digits, - and _ only");
            return Err(places.refuse(&table, "name", what));
        }
        out.push(name);
    }
    if out.is_empty() {
        out.push(usual_name(0));
    }
    Ok(out)
}

fn usual_name(k: usize) -> String {
    format!("op{}", 10 * (k + 1))
}

/// The whole part as a setup holds it, with all tools.
fn clamping(places: &Places, list: &RawList, (k, name): (usize, &str)) -> Result<Clamping, Failure> {
    let tools: Vec<usize> = (0..list.tool.len()).collect();
    let mut raw = common(list, &tools);
    let mut stand = moved(list, None, &tools);
    if let Some(table) = list.setup.get(k) {
        held(&mut raw, table);
        stand.extend(["setup", "fixture"].map(|t| (t.to_owned(), format!("setup[{}]", k + 1))));
    }
    Ok(Clamping { name: name.to_owned(), job: Job::of(places.with(stand), &raw)? })
}

/// A job held as a setup says.
fn held(raw: &mut Raw, table: &raw::Setup) {
    raw.setup = raw::Setup { name: None, fixtures: None, fixture_spacing_mm: None, ..table.clone() };
    if let Some(files) = table.fixtures.clone().filter(|f| !f.is_empty()) {
        raw.fixture = Some(raw::Fixture { files, spacing_mm: table.fixture_spacing_mm });
    }
}

/// Where the tables of an operation stand in the file: tool, setup and strategy of a job are those of lists here.
fn moved(list: &RawList, operation: Option<usize>, tools: &[usize]) -> Vec<(String, String)> {
    let mut out = Vec::new();
    match tools {
        [one] => out.push(("tool".to_owned(), format!("tool[{}]", one + 1))),
        all => out.extend(
            (1..)
                .zip(all)
                .map(|(place, k)| (format!("{}[{place}]", schema::TOOLS), format!("tool[{}]", k + 1))),
        ),
    }
    if let Some(k) = operation {
        let here = format!("operation[{}]", k + 1);
        out.push(("strategy".to_owned(), format!("{here}.strategy")));
        out.push(("operation".to_owned(), here));
        let name = list.operation[k].setup.as_deref();
        if let Some(s) = setup_of(list, name) {
            out.push(("setup".to_owned(), format!("setup[{}]", s + 1)));
            out.push(("fixture".to_owned(), format!("setup[{}]", s + 1)));
        }
    }
    out
}

/// Which table of the list a setup is.
fn setup_of(list: &RawList, name: Option<&str>) -> Option<usize> {
    match name {
        None => (!list.setup.is_empty()).then_some(0),
        Some(name) => {
            let own = |k: usize, s: &raw::Setup| s.name.clone().unwrap_or_else(|| usual_name(k));
            list.setup.iter().enumerate().position(|(k, s)| own(k, s) == name)
        }
    }
}

fn all_tools(list: &RawList) -> Vec<usize> {
    (0..list.tool.len()).collect()
}

/// What all operations have in common.
fn common(list: &RawList, tools: &[usize]) -> Raw {
    let chosen: Vec<raw::Tool> = tools.iter().map(|k| list.tool[*k].clone()).collect();
    let (tool, tools) = match &chosen[..] {
        [one] => (Some(one.clone()), None),
        _ => (None, Some(chosen)),
    };
    Raw {
        format: 1,
        part: list.part.clone(),
        tool,
        tools,
        tolerance: list.tolerance.clone(),
        strategy: raw::Strategy::default(),
        cutting: list.cutting.clone(),
        machine: list.machine.clone(),
        setup: raw::Setup::default(),
        contact: None,
        stock: list.stock.clone(),
        fixture: None,
        flank: raw::Flank::default(),
        verification: list.verification.clone(),
        standing_mm: None,
        beside_kept: false,
    }
}

/// An operation as a job of its own.
fn composed(
    places: &Places,
    list: &RawList,
    (k, own): (usize, &raw::Operation),
    setups: &[String],
) -> Result<Operation, Failure> {
    let here = format!("operation[{}]", k + 1);
    let refuse = |key: &str, what: String| places.refuse(&here, key, what);
    let tools = chosen_tools(list, own.tools.as_deref()).map_err(|what| refuse("tools", what))?;
    let places = places.with(moved(list, Some(k), &tools));
    let setup = match &own.setup {
        None => 0,
        Some(name) => setups.iter().position(|s| s == name).ok_or_else(|| {
            let names: Vec<&str> = setups.iter().map(String::as_str).collect();
            let near = crate::job::words::nearest(name, names.iter().copied());
            let what = format!("setup = \"{name}\" is none of {}", names.join(", "));
            places.full("operation", "setup", what, format!("one of {}", names.join(", ")), near)
        })?,
    };
    let mut raw = common(list, &tools);
    if let Some(faces) = &own.faces {
        raw.part.faces = Some(faces.clone());
    }
    if let Some(table) = list.setup.get(setup) {
        held(&mut raw, table);
    }
    raw.strategy = own.strategy.clone();
    let diameter_mm = tools.iter().map(|k| list.tool[*k].diameter_mm).fold(0.0, f64::max);
    match own.kind {
        OperationWord::Rough => {
            roughing::rough(&mut raw, own, diameter_mm).map_err(|(key, what)| refuse(key, what))?;
        }
        OperationWord::Finish | OperationWord::Rest => {
            operation::fine(&places, &mut raw, own).map_err(|(key, what)| refuse(key, what))?;
        }
    }
    if own.kind != OperationWord::Rest && own.overlap_mm.is_some() {
        return Err(refuse("overlap_mm", "overlap_mm is for kind = \"rest\": leave it out".to_owned()));
    }
    if own.kind == OperationWord::Rough && list.stock.is_none() {
        let what = "kind = \"rough\" needs the raw material: add [stock] with box_mm, cylinder, file or allowance_mm";
        return Err(refuse("kind", what.to_owned()));
    }
    if own.kind != OperationWord::Finish && tools.len() > 1 {
        let what = format!(
            "kind = \"{}\" takes one tool: tools = [{}]",
            own.kind.word(),
            list.tool[tools[0]].number.unwrap_or(1)
        );
        return Err(refuse("tools", what));
    }
    let smallest_mm = tools.iter().map(|k| list.tool[*k].diameter_mm).fold(f64::INFINITY, f64::min);
    Ok(Operation {
        name: own.name.clone().unwrap_or_else(|| format!("{} {}", own.kind.word(), k + 1)),
        kind: own.kind,
        setup,
        overlap_mm: own.overlap_mm.unwrap_or(OVERLAP * smallest_mm),
        repeat: own.repeat.map(Repeat::of),
        beside_kept: false,
        places,
        raw,
    })
}

/// The places in the list of the tools that an operation names; all where it names none.
fn chosen_tools(list: &RawList, named: Option<&[u32]>) -> Result<Vec<usize>, String> {
    let numbers: Vec<u32> = list.tool.iter().filter_map(|t| t.number).collect();
    let Some(named) = named else { return Ok(all_tools(list)) };
    if named.is_empty() {
        return Err(
            "tools = []: the list of tools is empty; give at least one, or leave it out for all".to_owned()
        );
    }
    let mut out = Vec::with_capacity(named.len());
    for n in named {
        let Some(k) = numbers.iter().position(|own| own == n) else {
            let have: Vec<String> = numbers.iter().map(ToString::to_string).collect();
            return Err(format!("tools names {n}, but the tools are {}", have.join(", ")));
        };
        if out.contains(&k) {
            return Err(format!("tools names {n} twice"));
        }
        out.push(k);
    }
    Ok(out)
}
