//! A crate read from its sources: its modules with what they define, bring in and implement.

use super::expand;
use super::text::line;
use crate::cmd::Failure;
use proc_macro2::TokenStream;
use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use syn::{Attribute, Item, ItemImpl, ItemMacro, UseTree, Visibility};

/// Most calls of macros that are written out: a macro that calls itself for ever ends here.
const MOST_CALLS: usize = 10_000;

/// What a module defines under a name.
pub struct Defined {
    pub name: String,
    /// Whether it stands with `pub` alone.
    pub public: bool,
    pub what: What,
}

/// An item, or a module of this crate by its place.
pub enum What {
    Module(usize),
    Item(Box<Item>),
}

/// A branch of a `use`.
pub struct Use {
    /// As written, without the `*` of a glob.
    pub path: Vec<String>,
    /// The name that it has here; `None` for a glob.
    pub name: Option<String>,
    pub public: bool,
}

/// A module.
pub struct Module {
    pub parent: Option<usize>,
    /// Where it stands, for messages.
    pub file: PathBuf,
    /// The conditions under which it is compiled, as written.
    pub attributes: Vec<Attribute>,
    pub defined: Vec<Defined>,
    pub uses: Vec<Use>,
    pub impls: Vec<ItemImpl>,
}

/// A macro of the crate.
pub struct Rules {
    pub name: String,
    pub exported: bool,
    pub tokens: TokenStream,
    file: PathBuf,
}

/// A crate; its first module is the root.
pub struct Crate {
    /// The name in paths.
    pub name: String,
    pub modules: Vec<Module>,
    pub macros: Vec<Rules>,
    /// Names of other crates.
    pub others: Vec<String>,
    /// Calls of macros that are not written out yet.
    calls: VecDeque<(usize, ItemMacro)>,
}

/// What is wrong in a source file.
pub fn wrong(file: &Path, why: impl std::fmt::Display) -> Failure {
    Failure::Source { path: file.to_path_buf(), why: why.to_string() }
}

/// Whether an item with these attributes is left out of what users compile.
fn only_tested(attributes: &[Attribute]) -> bool {
    attributes.iter().filter(|a| a.path().is_ident("cfg")).any(|a| match &a.meta {
        syn::Meta::List(list) => {
            let text = line(&list.tokens);
            matches!(text.as_str(), "test" | "doctest")
                || text
                    .strip_prefix("all(")
                    .is_some_and(|rest| rest.split([',', ')']).any(|w| w.trim() == "test"))
        }
        _ => false,
    })
}

/// Where the files of a module's children lie.
struct Place {
    module: usize,
    /// For `mod name;`.
    children: PathBuf,
    /// For `#[path]`.
    beside: PathBuf,
}

impl Crate {
    /// The crate in a folder with `Cargo.toml` and `src/lib.rs`; `shown` is what messages call the folder.
    ///
    /// # Errors
    /// Where a file is missing or cannot be read as Rust, or where a macro makes items that cannot be known.
    pub fn read(folder: &Path, shown: &Path, package: &str) -> Result<Self, Failure> {
        let read = |name: &str| {
            std::fs::read_to_string(folder.join(name))
                .map_err(|why| Failure::Read { path: shown.join(name), why })
        };
        let mut others: Vec<String> = ["std", "core", "alloc"].map(ToOwned::to_owned).into();
        others.extend(dependencies(&read("Cargo.toml")?));
        let mut out = Self {
            name: package.replace('-', "_"),
            modules: Vec::new(),
            macros: Vec::new(),
            others,
            calls: VecDeque::new(),
        };
        let files = Files { folder, shown };
        let root = out.module(None, shown.join("src/lib.rs"), Vec::new());
        let parsed = files.parse(Path::new("src/lib.rs"))?;
        let place = Place { module: root, children: PathBuf::from("src"), beside: PathBuf::from("src") };
        out.add(parsed.items, &place, &files)?;
        out.write_out(&files)?;
        Ok(out)
    }

    fn module(&mut self, parent: Option<usize>, file: PathBuf, attributes: Vec<Attribute>) -> usize {
        let (defined, uses, impls) = (Vec::new(), Vec::new(), Vec::new());
        self.modules.push(Module { parent, file, attributes, defined, uses, impls });
        self.modules.len() - 1
    }

    fn add(&mut self, items: Vec<Item>, at: &Place, files: &Files<'_>) -> Result<(), Failure> {
        for item in items {
            if only_tested(attributes(&item)) {
                continue;
            }
            match item {
                Item::Mod(item) => self.add_module(item, at, files)?,
                Item::Use(item) => {
                    let public = matches!(item.vis, Visibility::Public(_));
                    branches(&item.tree, &mut Vec::new(), public, &mut self.modules[at.module].uses);
                }
                Item::Impl(item) => self.modules[at.module].impls.push(item),
                Item::Macro(item) => match &item.ident {
                    Some(name) => {
                        let exported = item.attrs.iter().any(|a| a.path().is_ident("macro_export"));
                        let file = self.modules[at.module].file.clone();
                        self.macros.push(Rules {
                            name: name.to_string(),
                            exported,
                            tokens: item.mac.tokens,
                            file,
                        });
                    }
                    None => self.calls.push_back((at.module, item)),
                },
                other => {
                    let Some((name, public)) = named(&other) else {
                        let file = &self.modules[at.module].file;
                        return Err(wrong(file, format!("an item that is not known here: {}", line(&other))));
                    };
                    let what = What::Item(Box::new(other));
                    self.modules[at.module].defined.push(Defined { name, public, what });
                }
            }
        }
        Ok(())
    }

    fn add_module(&mut self, item: syn::ItemMod, at: &Place, files: &Files<'_>) -> Result<(), Failure> {
        let name = item.ident.to_string();
        let public = matches!(item.vis, Visibility::Public(_));
        let file = self.modules[at.module].file.clone();
        let (file, items, children, beside) = match item.content {
            Some((_, items)) => (file, items, at.children.join(&name), at.children.join(&name)),
            None => {
                let path = files.of_module(&name, &item.attrs, at).ok_or_else(|| {
                    let folder = files.shown.join(&at.children);
                    let what =
                        format!("mod {name}; has no file {name}.rs or {name}/mod.rs in {}", folder.display());
                    wrong(&file, what)
                })?;
                let own = path.parent().map(Path::to_path_buf).unwrap_or_default();
                let stem = path.file_stem().unwrap_or_default();
                let children = if stem == "mod" { own.clone() } else { own.join(stem) };
                let parsed = files.parse(&path)?;
                if only_tested(&parsed.attrs) {
                    return Ok(());
                }
                (files.shown.join(&path), parsed.items, children, own)
            }
        };
        let module = self.module(Some(at.module), file, item.attrs);
        self.modules[at.module].defined.push(Defined { name, public, what: What::Module(module) });
        self.add(items, &Place { module, children, beside }, files)
    }

    /// Calls of macros become the items that they make.
    fn write_out(&mut self, files: &Files<'_>) -> Result<(), Failure> {
        for _ in 0..MOST_CALLS {
            let Some((module, call)) = self.calls.pop_front() else { return Ok(()) };
            let file = self.modules[module].file.clone();
            let name = call.mac.path.segments.last().map_or_else(String::new, |s| s.ident.to_string());
            let text = call.mac.tokens.to_string();
            if name == "thread_local" && !text.split_whitespace().any(|word| word == "pub") {
                continue;
            }
            let named = || self.macros.iter().filter(|m| m.name == name);
            let here: Vec<&Rules> = named().filter(|m| m.file == file).collect();
            let found = if here.is_empty() { named().collect() } else { here };
            let [rules] = found.as_slice() else {
                let what = format!(
                    "{name}! makes items here, and {} macros of this crate have its name: write the items out",
                    found.len()
                );
                return Err(wrong(&file, what));
            };
            let made = expand::expand(&rules.tokens, &call.mac.tokens)
                .and_then(|tokens| syn::parse2::<syn::File>(tokens).map_err(|e| e.to_string()))
                .map_err(|why| wrong(&file, format!("{name}! cannot be written out: {why}")))?;
            let nowhere = PathBuf::from("src");
            self.add(made.items, &Place { module, children: nowhere.clone(), beside: nowhere }, files)?;
        }
        Err(wrong(&self.modules[0].file, format!("more than {MOST_CALLS} calls of macros make items")))
    }
}

/// The files of a crate, by paths from its folder.
struct Files<'a> {
    folder: &'a Path,
    shown: &'a Path,
}

impl Files<'_> {
    fn parse(&self, path: &Path) -> Result<syn::File, Failure> {
        let shown = self.shown.join(path);
        let text = std::fs::read_to_string(self.folder.join(path))
            .map_err(|why| Failure::Read { path: shown.clone(), why })?;
        syn::parse_file(&text).map_err(|why| wrong(&shown, why))
    }

    fn of_module(&self, name: &str, attributes: &[Attribute], at: &Place) -> Option<PathBuf> {
        let given = attributes.iter().filter(|a| a.path().is_ident("path")).find_map(|a| match &a.meta {
            syn::Meta::NameValue(pair) => Some(line(&pair.value).trim_matches('"').to_owned()),
            _ => None,
        });
        let name = name.trim_start_matches("r#");
        let all = match given {
            Some(path) => vec![at.beside.join(path)],
            None => vec![at.children.join(format!("{name}.rs")), at.children.join(name).join("mod.rs")],
        };
        all.into_iter().find(|path| self.folder.join(path).is_file())
    }
}

/// The names of dependencies in a manifest as cargo writes it, as paths have them.
fn dependencies(manifest: &str) -> Vec<String> {
    let mut out = Vec::new();
    let mut within = false;
    for text in manifest.lines() {
        if let Some(table) = text.strip_prefix('[') {
            within = table.starts_with("dependencies") || table.contains(".dependencies");
            let of_one = table.trim_end_matches(']').strip_prefix("dependencies.");
            out.extend(of_one.map(|name| name.replace('-', "_")));
        } else if within && let Some((key, _)) = text.split_once('=') {
            out.extend(key.trim().split('.').next().map(|name| name.replace('-', "_")));
        }
    }
    out
}

/// The branches of a `use` tree.
fn branches(tree: &UseTree, before: &mut Vec<String>, public: bool, out: &mut Vec<Use>) {
    let mut leaf = |ident: &syn::Ident, name: &syn::Ident| {
        let mut path = before.clone();
        // `a::{self}` is `a`.
        if ident != "self" || path.is_empty() {
            path.push(ident.to_string());
        }
        let name = if name == "self" { path.last().cloned() } else { Some(name.to_string()) };
        out.push(Use { path, name, public });
    };
    match tree {
        UseTree::Path(path) => {
            before.push(path.ident.to_string());
            branches(&path.tree, before, public, out);
            before.pop();
        }
        UseTree::Name(name) => leaf(&name.ident, &name.ident),
        UseTree::Rename(rename) => leaf(&rename.ident, &rename.rename),
        UseTree::Glob(_) => out.push(Use { path: before.clone(), name: None, public }),
        UseTree::Group(group) => group.items.iter().for_each(|tree| branches(tree, before, public, out)),
    }
}

/// The attributes of an item.
pub fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(i) => &i.attrs,
        Item::Enum(i) => &i.attrs,
        Item::ExternCrate(i) => &i.attrs,
        Item::Fn(i) => &i.attrs,
        Item::ForeignMod(i) => &i.attrs,
        Item::Impl(i) => &i.attrs,
        Item::Macro(i) => &i.attrs,
        Item::Mod(i) => &i.attrs,
        Item::Static(i) => &i.attrs,
        Item::Struct(i) => &i.attrs,
        Item::Trait(i) => &i.attrs,
        Item::TraitAlias(i) => &i.attrs,
        Item::Type(i) => &i.attrs,
        Item::Union(i) => &i.attrs,
        Item::Use(i) => &i.attrs,
        _ => &[],
    }
}

/// The name of an item that others can name, and whether it stands with `pub` alone.
fn named(item: &Item) -> Option<(String, bool)> {
    let (name, visibility) = match item {
        Item::Const(i) => (&i.ident, &i.vis),
        Item::Enum(i) => (&i.ident, &i.vis),
        Item::Fn(i) => (&i.sig.ident, &i.vis),
        Item::Static(i) => (&i.ident, &i.vis),
        Item::Struct(i) => (&i.ident, &i.vis),
        Item::Trait(i) => (&i.ident, &i.vis),
        Item::Type(i) => (&i.ident, &i.vis),
        Item::Union(i) => (&i.ident, &i.vis),
        _ => return None,
    };
    Some((name.to_string(), matches!(visibility, Visibility::Public(_))))
}
