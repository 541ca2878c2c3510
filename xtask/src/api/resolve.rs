//! Names of a crate: what a path leads to, and under which paths users reach an item.

use super::tree::{Crate, Use, What, wrong};
use crate::cmd::Failure;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use syn::Item;

/// What a name stands for.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Target {
    /// A module by its place.
    Module(usize),
    /// An item by its module's place and its own.
    Item(usize, usize),
    /// A variant of an enum: that, and the variant's name.
    Variant(usize, usize, String),
    /// Of another crate, as it is written.
    Foreign(String),
}

/// A target, and whether those outside of the module may take it.
type Found = (Target, bool);

/// What is being looked for: a module, the place of one of its `use`s, and the name that is asked of it.
type Seen = BTreeSet<(usize, usize, String)>;

/// A path of users: names from the root of the crate on.
pub type Names = Vec<String>;

/// What is reached from outside.
pub struct Public {
    /// The shortest path of each target.
    pub shortest: BTreeMap<Target, Names>,
    /// Other paths of targets with a shorter one.
    pub others: Vec<(Names, Target)>,
    /// Globs that hand on another crate: the module and the path.
    pub globs: Vec<(Names, String)>,
}

impl Crate {
    /// What a path leads to that is written in a module; nothing where it cannot be told.
    pub fn resolve(&self, module: usize, path: &[String]) -> Vec<Target> {
        let mut out: Vec<Target> =
            self.path(module, path, &mut Seen::new()).into_iter().map(|f| f.0).collect();
        out.sort();
        out.dedup();
        out
    }

    /// The item of a target.
    pub fn item(&self, target: &Target) -> Option<&Item> {
        let Target::Item(module, place) = target else { return None };
        match &self.modules[*module].defined[*place].what {
            What::Item(item) => Some(item),
            What::Module(_) => None,
        }
    }

    fn path(&self, module: usize, path: &[String], seen: &mut Seen) -> Vec<Found> {
        let Some((first, rest)) = path.split_first() else { return vec![(Target::Module(module), true)] };
        let above = self.modules[module].parent;
        let mut found = match (first.as_str(), above) {
            ("crate", _) => vec![(Target::Module(0), true)],
            ("self", _) => vec![(Target::Module(module), true)],
            ("super", Some(above)) => vec![(Target::Module(above), true)],
            _ => self.name(module, first, seen),
        };
        if found.is_empty() && self.others.contains(first) {
            return vec![(Target::Foreign(path.join("::")), true)];
        }
        for (k, name) in rest.iter().enumerate() {
            let mut next = Vec::new();
            for (target, _) in found {
                match target {
                    Target::Module(m) if name == "super" => {
                        next.extend(self.modules[m].parent.map(|m| (Target::Module(m), true)));
                    }
                    Target::Module(m) => next.extend(self.name(m, name, seen)),
                    Target::Item(m, place) => {
                        if let Some(Item::Enum(e)) = self.item(&Target::Item(m, place))
                            && e.variants.iter().any(|v| v.ident == name)
                        {
                            let public = self.modules[m].defined[place].public;
                            next.push((Target::Variant(m, place, name.clone()), public));
                        }
                    }
                    Target::Foreign(before) => {
                        return vec![(Target::Foreign(format!("{before}::{}", rest[k..].join("::"))), true)];
                    }
                    Target::Variant(..) => {}
                }
            }
            found = next;
        }
        found
    }

    /// What a name stands for in a module: by a definition, else by `use`, else by a glob, in each of the spaces of names.
    fn name(&self, module: usize, name: &str, seen: &mut Seen) -> Vec<Found> {
        let own = &self.modules[module];
        let mut out: Vec<Found> = Vec::new();
        for (place, defined) in own.defined.iter().enumerate().filter(|(_, d)| d.name == name) {
            out.push((target(&defined.what, module, place), defined.public));
        }
        let named = own.uses.iter().enumerate().filter(|(_, u)| u.name.as_deref() == Some(name));
        let globs = own.uses.iter().enumerate().filter(|(_, u)| u.name.is_none());
        for (k, brought) in named.chain(globs) {
            // A `use` that is asked for the name while it looks for it leads nowhere new; another one of the module may.
            let asked = (module, k, name.to_owned());
            if !seen.insert(asked.clone()) {
                continue;
            }
            if brought.name.is_some() {
                self.brought(module, brought, &brought.path, seen, &mut out);
            } else if !matches!(self.path(module, &brought.path, seen).as_slice(), [(Target::Foreign(_), _)])
            {
                // What a glob may bring of another crate is not known; a path that leads there is asked for by name.
                let path = [brought.path.as_slice(), &[name.to_owned()]].concat();
                self.brought(module, brought, &path, seen, &mut out);
            }
            seen.remove(&asked);
        }
        out
    }

    /// Adds what a `use` brings, but for what stands for the name in the same space already.
    fn brought(&self, module: usize, brought: &Use, path: &[String], seen: &mut Seen, out: &mut Vec<Found>) {
        for (target, public) in self.path(module, path, seen) {
            let space = self.space(&target);
            if !out.iter().any(|(other, _)| self.space(other) == space) {
                out.push((target, public && brought.public));
            }
        }
    }

    /// Types and modules share their names, functions and values do.
    fn space(&self, target: &Target) -> u8 {
        match (target, self.item(target)) {
            (_, Some(Item::Fn(_) | Item::Const(_) | Item::Static(_))) => 1,
            (Target::Foreign(_), _) => 2,
            _ => 0,
        }
    }

    /// What a module hands on to those outside, by names; globs of other crates go into `globs`.
    fn exports(
        &self,
        module: usize,
        seen: &mut BTreeSet<usize>,
        globs: &mut Vec<String>,
    ) -> Result<BTreeSet<(String, Target)>, Failure> {
        let mut out = BTreeSet::new();
        if !seen.insert(module) {
            return Ok(out);
        }
        let own = &self.modules[module];
        for (place, defined) in own.defined.iter().enumerate().filter(|(_, d)| d.public) {
            out.insert((defined.name.clone(), target(&defined.what, module, place)));
        }
        for brought in own.uses.iter().filter(|u| u.public) {
            let found = self.path(module, &brought.path, &mut Seen::new());
            if found.is_empty() {
                // Macros of the crate stand at its root whoever hands them on.
                if brought.path.last().is_some_and(|n| self.macros.iter().any(|m| m.name == *n)) {
                    continue;
                }
                let what = format!("pub use {}: nothing of this name is found", brought.path.join("::"));
                return Err(wrong(&own.file, what));
            }
            match &brought.name {
                Some(name) => {
                    let public = found.into_iter().filter(|(_, public)| *public);
                    out.extend(public.map(|(target, _)| (name.clone(), target)));
                }
                None => {
                    for (target, _) in found {
                        match target {
                            Target::Module(m) => {
                                let handed = self.exports(m, seen, globs)?;
                                let named = |name: &str| {
                                    own.defined.iter().any(|d| d.name == name)
                                        || own.uses.iter().any(|u| u.name.as_deref() == Some(name))
                                };
                                // A name of its own hides that of a glob.
                                out.extend(handed.into_iter().filter(|(name, _)| !named(name)));
                            }
                            Target::Foreign(path) => globs.push(path),
                            Target::Item(m, place) => {
                                if let Some(Item::Enum(e)) = self.item(&Target::Item(m, place)) {
                                    let each = e.variants.iter().map(|v| v.ident.to_string());
                                    out.extend(each.map(|v| (v.clone(), Target::Variant(m, place, v))));
                                }
                            }
                            Target::Variant(..) => {}
                        }
                    }
                }
            }
        }
        seen.remove(&module);
        Ok(out)
    }

    /// Everything that is reached from outside, by its shortest path; of two as long the first in the alphabet.
    ///
    /// # Errors
    /// Where a `pub use` leads to nothing that is known.
    pub fn public(&self) -> Result<Public, Failure> {
        let mut all: BTreeMap<Target, BTreeSet<(usize, Names)>> = BTreeMap::new();
        let mut globs = Vec::new();
        let mut waiting = BTreeSet::from([(0, Names::new(), 0)]);
        let mut done = BTreeSet::new();
        while let Some((_, at, module)) = waiting.pop_first() {
            // What lies in a module is listed where the module's own path is shortest.
            if !done.insert(module) {
                continue;
            }
            let mut handed = Vec::new();
            for (name, target) in self.exports(module, &mut BTreeSet::new(), &mut handed)? {
                let path = [at.as_slice(), &[name]].concat();
                if let Target::Module(m) = target {
                    waiting.insert((path.len(), path.clone(), m));
                }
                all.entry(target).or_default().insert((path.len(), path));
            }
            globs.extend(handed.into_iter().map(|path| (at.clone(), path)));
        }
        let mut out = Public { shortest: BTreeMap::new(), others: Vec::new(), globs };
        for (target, paths) in all {
            let mut paths = paths.into_iter().map(|(_, path)| path);
            // What belongs to another crate, or to an enum, has its own path there.
            if !matches!(target, Target::Foreign(_) | Target::Variant(..))
                && let Some(shortest) = paths.next()
            {
                out.shortest.insert(target.clone(), shortest);
            }
            out.others.extend(paths.map(|path| (path, target.clone())));
        }
        Ok(out)
    }

    /// The item of this crate that a type's or a trait's path means; `None` where it is of another crate or of the language.
    ///
    /// # Errors
    /// Where that cannot be told.
    pub fn meant(&self, module: usize, path: &[String], file: &Path) -> Result<Option<Target>, Failure> {
        let is_kind = |target: &Target| {
            matches!(
                self.item(target),
                Some(Item::Struct(_) | Item::Enum(_) | Item::Union(_) | Item::Trait(_) | Item::Type(_))
            )
        };
        let found = self.resolve(module, path);
        let mut local: Vec<&Target> = found.iter().filter(|t| is_kind(t)).collect();
        // One item under different conditions stands there once for each of them.
        local.dedup_by(|a, b| {
            matches!((a, b), (Target::Item(m, j), Target::Item(n, k))
            if m == n && self.modules[*m].defined[*j].name == self.modules[*n].defined[*k].name)
        });
        match (local.as_slice(), found.as_slice()) {
            ([one], _) => Ok(Some((*one).clone())),
            ([], [Target::Foreign(_), ..]) => Ok(None),
            ([], []) if matches!(path, [name] if KNOWN.contains(&name.as_str())) => Ok(None),
            (many, _) => {
                let what =
                    format!("`{}` leads to {} types or traits, and not to one", path.join("::"), many.len());
                Err(wrong(file, what + ": name it by `use` or by a path from `crate`"))
            }
        }
    }
}

fn target(what: &What, module: usize, place: usize) -> Target {
    match what {
        What::Module(m) => Target::Module(*m),
        What::Item(_) => Target::Item(module, place),
    }
}

/// Types and traits of the language that no `use` brings in.
const KNOWN: [&str; 51] = [
    "AsMut",
    "AsRef",
    "Box",
    "Clone",
    "Copy",
    "Default",
    "DoubleEndedIterator",
    "Drop",
    "Eq",
    "ExactSizeIterator",
    "Extend",
    "Fn",
    "FnMut",
    "FnOnce",
    "From",
    "FromIterator",
    "Into",
    "IntoIterator",
    "Iterator",
    "Option",
    "Ord",
    "PartialEq",
    "PartialOrd",
    "Result",
    "Send",
    "Sized",
    "String",
    "Sync",
    "ToOwned",
    "ToString",
    "TryFrom",
    "TryInto",
    "Unpin",
    "Vec",
    "bool",
    "char",
    "f32",
    "f64",
    "i128",
    "i16",
    "i32",
    "i64",
    "i8",
    "isize",
    "str",
    "u128",
    "u16",
    "u32",
    "u64",
    "u8",
    "usize",
];
