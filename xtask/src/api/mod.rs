//! `cargo xtask api`: the public items of each package as a text, made from the sources and compared with what is kept in `api`.
//!
//! Every item that users reach stands there once, at its shortest path, with its signature as the source words it; other paths of it are lines
//! `pub use`. Traits of a type are one line. What a change of a line means for callers is a decision, which `CHANGELOG.md` tells.
//!
//! Limits: names of types in signatures are not followed, auto traits (`Send`, `Sync`) are not derived, and an `impl` in the body of a function
//! is not seen. What cannot be told is an error and not left out.

mod expand;
mod list;
mod resolve;
mod text;
mod tree;

use crate::cmd::{Failure, root, write};
use std::collections::BTreeSet;
use std::path::Path;
use std::time::Instant;
use tree::Crate;

/// Where the lists are kept.
const FOLDER: &str = "api";
/// The packages with their folders.
const PACKAGES: [(&str, &str); 6] = [
    ("osculate-geom", "geom"),
    ("osculate-surfaces", "surfaces"),
    ("osculate-tools", "tools"),
    ("osculate-productivity", "productivity"),
    ("osculate-postproc", "postproc"),
    ("osculate", "cli"),
];

/// What is done with the lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// They are compared with those that are kept.
    Compare,
    /// They are kept.
    Bless,
    /// A table of what they hold.
    Count,
}

impl Action {
    /// That of a command line; `None` where it is none.
    pub fn of(words: &[&str]) -> Option<Self> {
        match words {
            [] => Some(Self::Compare),
            ["--bless"] => Some(Self::Bless),
            ["--count"] => Some(Self::Count),
            _ => None,
        }
    }
}

/// Runs the command.
pub fn run(action: Action) -> Result<(), Failure> {
    let start = Instant::now();
    let root = root()?;
    let (mut different, mut all) = (0, 0);
    if action == Action::Count {
        println!("{}", Counts::HEAD);
    }
    for (package, folder) in PACKAGES {
        let lines = list::lines(&Crate::read(&root.join(folder), Path::new(folder), package)?)?;
        all += lines.len();
        let name = format!("{FOLDER}/{package}.txt");
        let path = root.join(&name);
        match action {
            Action::Count => println!("{}", Counts::of(&lines).row(package)),
            Action::Bless => write(&path, &(lines.join("\n") + "\n"))?,
            Action::Compare => {
                let kept =
                    std::fs::read_to_string(&path).map_err(|why| Failure::Read { path: name.into(), why })?;
                let changes = changes(&kept, &lines, &package.replace('-', "_"));
                if !changes.is_empty() {
                    println!("api: {package}: {} lines differ from {FOLDER}/{package}.txt", changes.len());
                    changes.iter().for_each(|line| println!("{line}"));
                    different += 1;
                }
            }
        }
    }
    let seconds = start.elapsed().as_secs_f64();
    match (action, different) {
        (Action::Compare, 0) => {
            println!("api: {all} lines of {} packages, no differences, {seconds:.1} s", PACKAGES.len())
        }
        (Action::Bless, _) => println!("api: {all} lines of {} packages written to {FOLDER}", PACKAGES.len()),
        (Action::Count, _) => {}
        (Action::Compare, packages) => return Err(Failure::Interface(packages)),
    }
    Ok(())
}

/// The lines that only one of the two lists has, in order of their paths: `-` what is kept, `+` what the sources say.
fn changes(kept: &str, lines: &[String], name: &str) -> Vec<String> {
    let old: BTreeSet<&str> = kept.lines().collect();
    let new: BTreeSet<&str> = lines.iter().map(String::as_str).collect();
    let gone = old.difference(&new).map(|line| (list::key(line, name), '-', *line));
    let come = new.difference(&old).map(|line| (list::key(line, name), '+', *line));
    let mut all: Vec<(&str, char, &str)> = gone.chain(come).collect();
    // Of one path what is gone comes first.
    all.sort_by_key(|(key, sign, line)| (*key, *sign == '+', *line));
    all.into_iter().map(|(_, sign, line)| format!("{sign} {line}")).collect()
}

/// What a list holds.
#[derive(Debug, Default, PartialEq, Eq)]
struct Counts {
    lines: usize,
    modules: usize,
    structs: usize,
    enums: usize,
    open: usize,
    traits: usize,
    functions: usize,
}

impl Counts {
    const HEAD: &str = "package                lines  modules  structs  enums  of them non_exhaustive  traits  functions\n\
                        -------------------------------------------------------------------------------------------";

    fn of(lines: &[String]) -> Self {
        let mut out = Self { lines: lines.len(), ..Self::default() };
        for line in lines {
            // The word of the item stands before its path.
            let path = line.find("::").unwrap_or(line.len());
            let words: Vec<&str> = line[..path].split_whitespace().collect();
            let is = |word: &str| words.contains(&word);
            out.modules += usize::from(is("mod"));
            out.structs += usize::from(is("struct"));
            out.enums += usize::from(is("enum"));
            out.traits += usize::from(is("trait"));
            out.functions += usize::from(is("fn"));
            out.open += usize::from(is("#[non_exhaustive]") && (is("struct") || is("enum")));
        }
        out
    }

    fn row(&self, package: &str) -> String {
        let Self { lines, modules, structs, enums, open, traits, functions } = self;
        format!(
            "{package:<21} {lines:>6}  {modules:>7}  {structs:>7}  {enums:>5}  {open:>22}  {traits:>6}  {functions:>9}"
        )
    }
}

#[cfg(test)]
mod tests;
