//! Modules of a crate do not use each other in circles, so that each can be read, tested and moved by itself.
//!
//! A module uses another one where its code names something that is defined there: by `use`, or by a path in an
//! expression. A name that another module only hands on counts for the module that defines it. Declaring and exporting
//! children is no use of them, and tests are left out.

use super::code::code_of;
use super::finding::Finding;
use super::known_circles::KNOWN;
use super::modules::{Names, Use};
use super::tree::CRATES;
use super::tree::Tree;
use std::collections::{BTreeMap, BTreeSet};

/// No modules of a crate use each other in a circle, but those of [`KNOWN`].
pub fn no_module_circles(tree: &Tree) -> Vec<Finding> {
    findings(tree, KNOWN)
}

fn findings(tree: &Tree, known: &[(&str, &[&str])]) -> Vec<Finding> {
    let mut found = Vec::new();
    for folder in CRATES {
        let graph = Graph::of(tree, folder);
        let knots = graph.knots();
        let known: Vec<&[&str]> = known.iter().filter(|(at, _)| *at == folder).map(|(_, of)| *of).collect();
        for knot in &knots {
            let is_known = |of: &&[&str]| knot.iter().all(|&m| of.contains(&graph.modules[m].name.as_str()));
            if !known.iter().any(is_known) {
                found.extend(graph.circles(knot));
            }
        }
        let tied: BTreeSet<&str> = knots.iter().flatten().map(|&m| graph.modules[m].name.as_str()).collect();
        for name in known.iter().flat_map(|of| of.iter()).filter(|name| !tied.contains(**name)) {
            let what = format!("`{name}` stands in no circle any more: take it off the list of known ones");
            found.push(Finding::whole(folder, what));
        }
    }
    found
}

/// A module with what its code names.
struct Module {
    /// Path inside the crate; `crate` for the root.
    name: String,
    parent: Option<usize>,
    file: String,
    names: Names,
}

/// Where a path leads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Target {
    Module(usize),
    /// Something that this module defines.
    Item(usize),
}

/// Most steps from one `use` to the next that it names; more of them are a circle of exports.
const MOST_STEPS: usize = 16;

/// The modules of a crate and which of them use which.
struct Graph {
    modules: Vec<Module>,
    /// Used modules of each module, with the first line (from 0) that names something of them.
    uses: Vec<BTreeMap<usize, usize>>,
}

/// The path of a module inside its crate, from the path of its file below `src`.
fn module_path(file: &str) -> String {
    let path = file.strip_suffix(".rs").unwrap_or(file);
    let path = path.strip_suffix("/mod").unwrap_or(path);
    if matches!(path, "lib" | "main") { ROOT.to_owned() } else { path.replace('/', "::") }
}

const ROOT: &str = "crate";

impl Graph {
    fn of(tree: &Tree, folder: &str) -> Self {
        let start = format!("{folder}/src/");
        let mut modules: Vec<Module> = code_of(tree, &[folder])
            .iter()
            .map(|(file, code)| Module {
                name: module_path(file.path.strip_prefix(&start).unwrap_or(&file.path)),
                parent: None,
                file: file.path.clone(),
                names: Names::read(code),
            })
            .collect();
        let place: BTreeMap<String, usize> =
            modules.iter().enumerate().map(|(i, m)| (m.name.clone(), i)).collect();
        for module in &mut modules {
            let above = module.name.rsplit_once("::").map_or(ROOT, |(above, _)| above);
            module.parent = if module.name == ROOT { None } else { place.get(above).copied() };
        }
        let mut graph = Self { modules, uses: Vec::new() };
        graph.uses = (0..graph.modules.len()).map(|m| graph.used_by(m)).collect();
        graph
    }

    fn child(&self, of: usize, name: &str) -> Option<usize> {
        if !self.modules[of].names.children.contains(name) {
            return None;
        }
        self.modules.iter().position(|m| m.parent == Some(of) && m.name.rsplit("::").next() == Some(name))
    }

    /// Where a path leads that stands in `from`; `None` for other crates.
    fn resolve(&self, from: usize, path: &[String], steps: usize) -> Option<Target> {
        let root = self.modules.iter().position(|m| m.name == ROOT)?;
        let (mut at, mut rest) = match path.first()?.as_str() {
            "crate" => (root, &path[1..]),
            "self" => (from, &path[1..]),
            "super" => (self.modules[from].parent?, &path[1..]),
            _ => return self.below(from, path, steps, true),
        };
        while let Some(("super", more)) = rest.split_first().map(|(first, more)| (first.as_str(), more)) {
            (at, rest) = (self.modules[at].parent?, more);
        }
        self.below(at, rest, steps, false)
    }

    /// Where a path leads whose first segment is looked up in the module `at`. What is `bare` may be the name of another
    /// crate.
    fn below(&self, at: usize, path: &[String], steps: usize, bare: bool) -> Option<Target> {
        let Some((first, rest)) = path.split_first() else { return Some(Target::Module(at)) };
        let names = &self.modules[at].names;
        let is_item = names.items.contains(first);
        if let Some(child) = self.child(at, first).filter(|_| !(rest.is_empty() && is_item)) {
            return self.below(child, rest, steps, false);
        }
        if is_item {
            return Some(Target::Item(at));
        }
        let steps = steps.checked_sub(1)?;
        let onward = |target: Option<Target>| match target? {
            Target::Module(module) => self.below(module, rest, steps, false),
            item @ Target::Item(_) => Some(item),
        };
        let mut named =
            names.uses.iter().filter(|u| u.name.as_ref() == Some(first) && u.path != [first.clone()]);
        if let Some(brought) = named.next() {
            return onward(self.resolve(at, &brought.path, steps));
        }
        for glob in names.uses.iter().filter(|u| u.name.is_none()) {
            if let Some(Target::Module(module)) = self.resolve(at, &glob.path, steps)
                && module != at
                && self.exports(module).any(|name| name == first)
            {
                return self.below(module, path, steps, false);
            }
        }
        (!bare).then_some(Target::Item(at))
    }

    /// The names that a glob of a module may bring.
    fn exports(&self, module: usize) -> impl Iterator<Item = &String> {
        let names = &self.modules[module].names;
        names.items.iter().chain(names.uses.iter().filter_map(|u| u.name.as_ref()))
    }

    fn is_below(&self, module: usize, above: usize) -> bool {
        std::iter::successors(self.modules[module].parent, |&m| self.modules[m].parent).any(|m| m == above)
    }

    /// The modules that the code of one names something of.
    fn used_by(&self, module: usize) -> BTreeMap<usize, usize> {
        let names = &self.modules[module].names;
        let mut used = BTreeMap::new();
        let mut note = |path: &[String], line: usize, handed_on: bool| {
            if let Some(Target::Item(target)) = self.resolve(module, path, MOST_STEPS)
                && target != module
                && !(handed_on && self.is_below(target, module))
            {
                let first = used.entry(target).or_insert(line);
                *first = line.min(*first);
            }
        };
        for brought in &names.uses {
            match self.named_here(module, brought) {
                None => note(&brought.path, brought.line, brought.public),
                Some(named) => named.iter().for_each(|(path, line)| note(path, *line, false)),
            }
        }
        names.paths.iter().for_each(|(path, line)| note(path, *line, false));
        used
    }

    /// For globs and exports, what of them the module's own code names, with its lines; `None` where the `use` itself is
    /// what counts.
    fn named_here(&self, module: usize, brought: &Use) -> Option<Vec<(Vec<String>, usize)>> {
        let words = &self.modules[module].names.words;
        let Some(name) = &brought.name else {
            let Some(Target::Module(of)) = self.resolve(module, &brought.path, MOST_STEPS) else {
                return None;
            };
            let path = |name: &String| [brought.path.clone(), vec![name.clone()]].concat();
            return Some(self.exports(of).filter_map(|n| Some((path(n), *words.get(n)?))).collect());
        };
        let line = words.get(name).filter(|_| brought.public)?;
        Some(vec![(brought.path.clone(), *line)])
    }

    /// How one gets from a module back to itself: for every module the one before it on a shortest way.
    fn way_back(&self, from: usize) -> Option<Vec<usize>> {
        let mut before: BTreeMap<usize, usize> = BTreeMap::new();
        let mut front = vec![from];
        while !front.is_empty() && !before.contains_key(&from) {
            let mut next = Vec::new();
            for &at in &front {
                for &to in self.uses[at].keys() {
                    before.entry(to).or_insert_with(|| {
                        next.push(to);
                        at
                    });
                }
            }
            front = next;
        }
        let mut way = vec![from, *before.get(&from)?];
        while let Some(&last) = way.last().filter(|&&last| last != from) {
            way.push(before[&last]);
        }
        way.reverse();
        Some(way)
    }

    fn reach(&self, from: usize) -> BTreeSet<usize> {
        let (mut seen, mut open) = (BTreeSet::new(), vec![from]);
        while let Some(at) = open.pop() {
            open.extend(self.uses[at].keys().copied().filter(|&to| seen.insert(to)));
        }
        seen
    }

    /// The sets of modules each of which can be reached from each other.
    fn knots(&self) -> Vec<Vec<usize>> {
        let reach: Vec<BTreeSet<usize>> = (0..self.modules.len()).map(|m| self.reach(m)).collect();
        let tied =
            |a: usize| (0..reach.len()).filter(|&b| reach[a].contains(&b) && reach[b].contains(&a)).collect();
        let knots: BTreeSet<Vec<usize>> =
            (0..reach.len()).map(tied).filter(|knot: &Vec<usize>| !knot.is_empty()).collect();
        knots.into_iter().collect()
    }

    /// The shortest circle through every module of a knot, each circle once.
    fn circles(&self, knot: &[usize]) -> Vec<Finding> {
        let mut seen = BTreeSet::new();
        let ways = knot.iter().filter_map(|&module| self.way_back(module));
        let ways = ways.filter(|way| seen.insert(way.iter().copied().collect::<BTreeSet<usize>>()));
        ways.map(|way| self.finding(&way, knot.len())).collect()
    }

    fn finding(&self, way: &[usize], knot: usize) -> Finding {
        let name = |m: usize| self.modules[m].name.as_str();
        let names: Vec<&str> = way.iter().map(|&m| name(m)).collect();
        let steps: Vec<(&Module, usize, usize)> =
            way.windows(2).map(|w| (&self.modules[w[0]], self.uses[w[0]][&w[1]], w[1])).collect();
        let edge = |(from, line, to): &(&Module, usize, usize)| {
            format!("{}:{} names something of {}", from.file, line + 1, name(*to))
        };
        let what = format!(
            "modules use each other in a circle (a knot of {knot}): {} ({}); move what both need to a module of its own",
            names.join(" -> "),
            steps.iter().map(edge).collect::<Vec<_>>().join(", ")
        );
        Finding::at(&steps[0].0.file, steps[0].1, what)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The circles among files of one crate, as the modules of the first finding of each.
    fn circles(files: &[(&str, &str)]) -> Vec<String> {
        let files: Vec<(String, &str)> = files.iter().map(|(p, t)| (format!("geom/src/{p}"), *t)).collect();
        let tree = Tree::of(&files.iter().map(|(p, t)| (p.as_str(), *t)).collect::<Vec<_>>());
        let way = |f: &Finding| f.what.split(['(', ')']).nth(2).unwrap_or_default()[2..].trim().to_owned();
        findings(&tree, &[]).iter().map(way).collect()
    }

    const LIB: (&str, &str) = ("lib.rs", "mod a;\nmod b;\nmod c;\npub use a::A;");

    #[test]
    fn a_circle_is_found_with_its_lines() {
        let tree = Tree::of(&[
            ("geom/src/lib.rs", LIB.1),
            ("geom/src/a.rs", "pub struct A;\nuse crate::b::B;"),
            ("geom/src/b.rs", "pub struct B;\n\nfn f() { super::c::f() }"),
            ("geom/src/c.rs", "pub fn f() { crate::A }"),
        ]);
        let found = findings(&tree, &[]);
        assert_eq!(found.len(), 1);
        assert_eq!((found[0].place.as_str(), found[0].line), ("geom/src/a.rs", 2));
        for part in
            ["a -> b -> c -> a", "a.rs:2 names something of b", "b.rs:3", "c.rs:1 names something of a"]
        {
            assert!(found[0].what.contains(part), "{part}: {}", found[0].what);
        }
    }

    #[test]
    fn every_way_of_naming_closes_a_circle() {
        for named in [
            "use crate::a::A;",
            "use super::{c::C, a::{A as D}};",
            "fn f() -> crate::a::A {}",
            "use crate::A;",
            "use super::a;\nfn f() { a::A }",
            "use super::a::*;\nfn f() { A }",
            "pub use super::a::A;",
            "fn f() { use crate::a as d; d::deep::thing!() }",
        ] {
            let b = format!("pub struct B;\n{named}");
            let found = circles(&[LIB, ("a.rs", "pub struct A;\nuse super::b::B;"), ("b.rs", &b)]);
            assert_eq!(found, ["a -> b -> a"], "{named}");
        }
    }

    #[test]
    fn names_that_lead_elsewhere_close_none() {
        for named in [
            "use other::a::A;",
            "#[cfg(test)]\nmod tests { use super::super::a::A; }",
            "// crate::a::A",
            "const S: &str = \"crate::a::A\";",
            "use super::a;",
            "use super::a::*;\nfn f() { x.A }",
        ] {
            let b = format!("pub struct B;\n{named}");
            let found = circles(&[LIB, ("a.rs", "pub struct A;\nuse super::b::B;"), ("b.rs", &b)]);
            assert!(found.is_empty(), "{named}: {found:?}");
        }
    }

    #[test]
    fn what_a_parent_hands_on_counts_for_its_owner() {
        let lib = ("lib.rs", "mod x;");
        // x only exports; y needs what z has.
        let parts = [lib, ("x/mod.rs", "mod y;\nmod z;\npub use y::Y;\npub use z::Z;")];
        let open = [("x/y.rs", "pub struct Y;\nuse super::Z;"), ("x/z.rs", "pub struct Z;")];
        assert!(circles(&[&parts[..], &open[..]].concat()).is_empty());
        let shut =
            [("x/y.rs", "pub struct Y;\nuse super::Z;"), ("x/z.rs", "pub struct Z;\nuse crate::x::Y;")];
        assert_eq!(circles(&[&parts[..], &shut[..]].concat()), ["x::y -> x::z -> x::y"]);
    }

    #[test]
    fn a_child_that_needs_its_parents_own_code_closes_a_circle() {
        let child = ("x/y.rs", "pub struct Y;\nuse super::own;");
        for (parent, count) in [
            ("mod y;\npub fn own() {}", 0),
            ("mod y;\npub use y::Y;\npub fn own() {}", 0),
            ("mod y;\nuse y::Y;\npub fn own() {}", 1),
            ("mod y;\npub use y::Y;\npub fn own(y: Y) {}", 1),
            ("mod y;\npub use y::*;\npub fn own() -> Y {}", 1),
            ("mod y;\npub fn own() { y::f() }", 1),
        ] {
            assert_eq!(
                circles(&[("lib.rs", "mod x;"), ("x/mod.rs", parent), child]).len(),
                count,
                "{parent}"
            );
        }
    }

    #[test]
    fn known_circles_may_only_shrink() {
        let tree = Tree::of(&[
            ("geom/src/lib.rs", LIB.1),
            ("geom/src/a.rs", "pub struct A;\nuse crate::b::B;"),
            ("geom/src/b.rs", "pub struct B;\nuse crate::a::A;"),
            ("geom/src/c.rs", "use crate::a::A;"),
        ]);
        let count = |known: &[(&str, &[&str])]| findings(&tree, known).len();
        assert_eq!(count(&[("geom", &["a", "b"])]), 0);
        assert_eq!(count(&[("geom", &["a", "b", "c"])]), 1, "c is in no circle");
        assert_eq!(count(&[("geom", &["a"])]), 1, "b joined it");
        assert_eq!(count(&[("tools", &["a", "b"])]), 3, "of another crate");
        assert_eq!(count(&[]), 1);
    }
}
