//! The public items of a crate as lines of text, one an item.

use super::resolve::{Names, Public, Target};
use super::text::line;
use super::tree::{Crate, attributes, wrong};
use crate::cmd::Failure;
use quote::ToTokens;
use std::collections::{BTreeMap, BTreeSet};
use syn::{
    Attribute, Fields, FnArg, Generics, ImplItem, Item, ItemImpl, Pat, ReceiverKind, Signature, TraitItem,
    Type, Visibility,
};

/// All lines, in order of the paths in them.
///
/// # Errors
/// Where it cannot be told to what a `pub use` leads or to which type an `impl` belongs.
pub fn lines(of: &Crate) -> Result<Vec<String>, Failure> {
    let public = of.public()?;
    let mut list = List { of, public: &public, lines: BTreeSet::new(), traits: BTreeMap::new() };
    for target in public.shortest.keys() {
        list.target(target);
    }
    for (path, target) in &public.others {
        let what = list.shown(target);
        list.lines.insert(format!("pub use {} = {what}", list.path(path)));
    }
    for (path, glob) in &public.globs {
        list.lines.insert(format!(
            "pub use {} = {glob}::*",
            list.path(&[path.as_slice(), &["*".to_owned()]].concat())
        ));
    }
    list.macros()?;
    for module in 0..of.modules.len() {
        for item in &of.modules[module].impls {
            list.implemented(module, item)?;
        }
    }
    for (path, traits) in &list.traits {
        let all: Vec<&str> = traits.iter().map(String::as_str).collect();
        list.lines.insert(format!("impl {path}: {}", all.join(", ")));
    }
    let mut lines: Vec<String> = list.lines.into_iter().collect();
    lines.sort_by(|a, b| key(a, &of.name).cmp(key(b, &of.name)).then_with(|| a.cmp(b)));
    Ok(lines)
}

/// What a line is sorted by: the first path of the crate in it.
pub fn key<'a>(line: &'a str, name: &str) -> &'a str {
    let start = line.find(&format!("{name}::")).unwrap_or(line.len());
    let is_path = |c: char| c.is_alphanumeric() || matches!(c, '_' | ':' | '#');
    let path = &line[start..];
    path[..path.find(|c| !is_path(c)).unwrap_or(path.len())].trim_end_matches(':')
}

struct List<'a> {
    of: &'a Crate,
    public: &'a Public,
    lines: BTreeSet<String>,
    /// Of each type, by its path, the traits that it has.
    traits: BTreeMap<String, BTreeSet<String>>,
}

/// What stands between an item's generics and its `where`.
fn bounds(generics: &Generics) -> String {
    generics
        .where_clause
        .as_ref()
        .filter(|w| !w.predicates.is_empty())
        .map_or_else(String::new, |w| format!(" {}", line(w)))
}

/// Attributes that callers notice, before an item.
fn noted(attributes: &[Attribute]) -> String {
    let mut out = String::new();
    for attribute in attributes {
        let hidden =
            attribute.path().is_ident("doc") && line(&attribute.meta).replace(' ', "") == "doc(hidden)";
        let names = ["non_exhaustive", "cfg", "deprecated", "repr"];
        if hidden || names.iter().any(|name| attribute.path().is_ident(name)) {
            out += &format!("{} ", line(attribute));
        }
    }
    out
}

fn is_public(visibility: &Visibility) -> bool {
    matches!(visibility, Visibility::Public(_))
}

/// The parts of a signature around the name; arguments without their patterns.
fn signature(sig: &Signature, path: &str) -> String {
    let mut out = String::new();
    for word in [
        sig.constness.to_token_stream(),
        sig.asyncness.to_token_stream(),
        sig.safety.to_token_stream(),
        sig.abi.to_token_stream(),
    ] {
        if !word.is_empty() {
            out += &format!("{} ", line(&word));
        }
    }
    let inputs: Vec<String> = sig.inputs.iter().map(argument).collect();
    out += &format!("fn {path}{}({})", line(&sig.generics), inputs.join(", "));
    let output = line(&sig.output);
    if !output.is_empty() {
        out += &format!(" {output}");
    }
    out + &bounds(&sig.generics)
}

fn argument(argument: &FnArg) -> String {
    match argument {
        FnArg::Receiver(receiver) => match &receiver.kind {
            ReceiverKind::Value => "self".to_owned(),
            ReceiverKind::Typed(_, ty) => format!("self: {}", line(ty)),
            // Without the attributes that it may have.
            _ => line(&syn::Receiver { attrs: Vec::new(), ..receiver.clone() }),
        },
        FnArg::Typed(typed) => {
            let name = match &*typed.pat {
                Pat::Ident(name) => name.ident.to_string(),
                _ => "_".to_owned(),
            };
            format!("{name}: {}", line(&typed.ty))
        }
    }
}

/// Fields in brackets, each with its type; private ones of a struct as `_`.
fn in_brackets(fields: &Fields, all: bool) -> String {
    let shown = |f: &syn::Field| if all || is_public(&f.vis) { line(&f.ty) } else { "_".to_owned() };
    let open = |f: &syn::Field| if !all && is_public(&f.vis) { "pub " } else { "" };
    let each = fields.iter().map(|f| match &f.ident {
        Some(name) => format!("{name}: {}", shown(f)),
        None => format!("{}{}", open(f), shown(f)),
    });
    let each: Vec<String> = each.collect();
    match fields {
        Fields::Named(_) => format!(" {{ {} }}", each.join(", ")),
        Fields::Unnamed(_) => format!("({})", each.join(", ")),
        Fields::Unit => String::new(),
    }
}

impl List<'_> {
    fn path(&self, names: &[String]) -> String {
        let crate_name = std::iter::once(self.of.name.as_str());
        crate_name.chain(names.iter().map(String::as_str)).collect::<Vec<_>>().join("::")
    }

    /// A target as others name it.
    fn shown(&self, target: &Target) -> String {
        match target {
            Target::Foreign(path) => path.clone(),
            Target::Variant(m, place, name) => {
                let of = self.public.shortest.get(&Target::Item(*m, *place)).map(|p| self.path(p));
                format!("{}::{name}", of.unwrap_or_else(|| self.of.modules[*m].defined[*place].name.clone()))
            }
            other => self.public.shortest.get(other).map_or_else(String::new, |p| self.path(p)),
        }
    }

    fn target(&mut self, target: &Target) {
        let path = self.shown(target);
        if let Target::Module(m) = target {
            self.lines.insert(format!("{}pub mod {path}", noted(&self.of.modules[*m].attributes)));
        }
        let Some(item) = self.of.item(target) else { return };
        let noted = noted(attributes(item));
        let text = match item {
            Item::Const(i) => format!("pub const {path}: {}", line(&i.ty)),
            Item::Static(i) => format!("pub static {path}: {}", line(&i.ty)),
            Item::Fn(i) => format!("pub {}", signature(&i.sig, &path)),
            Item::Type(i) => {
                format!("pub type {path}{}{} = {}", line(&i.generics), bounds(&i.generics), line(&i.ty))
            }
            Item::Struct(i) => {
                self.derived(&path, &i.generics, &i.attrs, i.fields.iter());
                self.fields(&path, &i.fields);
                let own = match &i.fields {
                    Fields::Unnamed(_) => in_brackets(&i.fields, false),
                    Fields::Unit => ";".to_owned(),
                    Fields::Named(_) => String::new(),
                };
                let private = match &i.fields {
                    Fields::Named(f) if f.named.iter().any(|f| !is_public(&f.vis)) => {
                        " (with private fields)"
                    }
                    _ => "",
                };
                format!("pub struct {path}{}{own}{}{private}", line(&i.generics), bounds(&i.generics))
            }
            Item::Union(i) => {
                self.derived(&path, &i.generics, &i.attrs, i.fields.named.iter());
                self.fields(&path, &Fields::Named(i.fields.clone()));
                format!("pub union {path}{}{}", line(&i.generics), bounds(&i.generics))
            }
            Item::Enum(i) => {
                let fields = i.variants.iter().flat_map(|v| v.fields.iter());
                self.derived(&path, &i.generics, &i.attrs, fields);
                for v in &i.variants {
                    let value =
                        v.discriminant.as_ref().map_or_else(String::new, |(_, e)| format!(" = {}", line(e)));
                    let own = in_brackets(&v.fields, true);
                    self.lines.insert(format!(
                        "{}variant {path}::{}{own}{value}",
                        self::noted(&v.attrs),
                        v.ident
                    ));
                }
                format!("pub enum {path}{}{}", line(&i.generics), bounds(&i.generics))
            }
            Item::Trait(i) => {
                i.items.iter().for_each(|inner| self.of_trait(&path, inner));
                let unsafety = if i.unsafety.is_some() { "unsafe " } else { "" };
                let above = line(&i.supertraits);
                let above = if above.is_empty() { above } else { format!(": {above}") };
                format!("pub {unsafety}trait {path}{}{above}{}", line(&i.generics), bounds(&i.generics))
            }
            other => format!("pub {}", line(other)),
        };
        self.lines.insert(noted + &text);
    }

    fn fields(&mut self, path: &str, fields: &Fields) {
        for field in fields.iter().filter(|f| is_public(&f.vis)) {
            if let Some(name) = &field.ident {
                self.lines.insert(format!(
                    "{}pub field {path}::{name}: {}",
                    noted(&field.attrs),
                    line(&field.ty)
                ));
            }
        }
    }

    fn of_trait(&mut self, path: &str, item: &TraitItem) {
        let given = |given: bool| if given { "provided" } else { "required" };
        let text = match item {
            TraitItem::Fn(f) => {
                let own = signature(&f.sig, &format!("{path}::{}", f.sig.ident));
                format!("{}{} {own}", noted(&f.attrs), given(f.default.is_some()))
            }
            TraitItem::Const(c) => {
                format!("{} const {path}::{}: {}", given(c.default.is_some()), c.ident, line(&c.ty))
            }
            TraitItem::Type(t) => {
                let above = line(&t.bounds);
                let above = if above.is_empty() { above } else { format!(": {above}") };
                format!(
                    "required type {path}::{}{}{above}{}",
                    t.ident,
                    line(&t.generics),
                    bounds(&t.generics)
                )
            }
            other => format!("in {path}: {}", line(other)),
        };
        self.lines.insert(text);
    }

    /// The traits that attributes of a type give it.
    fn derived<'f>(
        &mut self,
        path: &str,
        generics: &Generics,
        attributes: &[Attribute],
        fields: impl Iterator<Item = &'f syn::Field>,
    ) {
        let mut traits = BTreeSet::new();
        for attribute in attributes {
            traits.extend(derives(&attribute.meta));
        }
        // `thiserror` makes the text as well, and what a field is made from.
        if traits.contains("Error") {
            traits.insert("Display".to_owned());
            let from = fields.filter(|f| f.attrs.iter().any(|a| a.path().is_ident("from")));
            traits.extend(from.map(|f| format!("From<{}>", line(&f.ty))));
        }
        let bound = generics.params.iter().any(|p| matches!(p, syn::GenericParam::Type(_)));
        let traits = traits.into_iter().map(|t| if bound { format!("{t} (derived)") } else { t });
        let traits: BTreeSet<String> = traits.collect();
        if !traits.is_empty() {
            self.traits.entry(path.to_owned()).or_default().extend(traits);
        }
    }

    /// Macros that other crates can call.
    fn macros(&mut self) -> Result<(), Failure> {
        for rules in self.of.macros.iter().filter(|m| m.exported) {
            let arms =
                super::expand::matchers(&rules.tokens).map_err(|why| wrong(&self.of.modules[0].file, why))?;
            for arm in arms {
                self.lines.insert(format!("pub macro {}::{}!({})", self.of.name, rules.name, line(&arm)));
            }
        }
        Ok(())
    }

    fn implemented(&mut self, module: usize, item: &ItemImpl) -> Result<(), Failure> {
        let own = self.type_of(module, item)?;
        let path = own.as_ref().map(|(t, _)| self.public.shortest.get(t).map(|p| self.path(p)));
        let aliased = own.is_some_and(|(_, aliased)| aliased);
        // Which of a type's kinds it is for, where that is not all of them.
        let of = if aliased || has_parameters(item) {
            format!(" [impl{} {}{}]", line(&item.generics), line(&item.self_ty), bounds(&item.generics))
        } else {
            String::new()
        };
        match (&item.trait_, path) {
            // Nobody outside names the type.
            (_, Some(None)) => Ok(()),
            (None, Some(Some(path))) => self.inherent(module, item, (&path, &of)),
            (None, None) => {
                let what = "the type is none of this crate, as far as can be told";
                let what = format!("impl {}: {what}", line(&item.self_ty));
                Err(wrong(&self.of.modules[module].file, what))
            }
            (Some((trait_path, _)), path) => {
                self.of_type(module, item, trait_path, path.flatten().map(|p| (p, of)))
            }
        }
    }

    /// A trait that a type has; `own` is the type's path and which of its kinds, where it is one of this crate.
    fn of_type(
        &mut self,
        module: usize,
        item: &ItemImpl,
        of: &syn::Path,
        own: Option<(String, String)>,
    ) -> Result<(), Failure> {
        let target = self.of.meant(module, &names(of), &self.of.modules[module].file)?;
        let public = target.as_ref().map(|t| self.public.shortest.get(t).map(|p| self.path(p)));
        let mut others: Vec<&Type> = Vec::new();
        if let Type::Reference(to) = bare(&item.self_ty) {
            others.push(&to.elem);
        }
        if let Some(syn::PathArguments::AngleBracketed(all)) = of.segments.last().map(|s| &s.arguments) {
            others.extend(all.args.iter().filter_map(|argument| match argument {
                syn::GenericArgument::Type(ty) => Some(ty),
                _ => None,
            }));
        }
        // Nobody outside sees a trait that is not public, or one between types that are not.
        if matches!(public, Some(None)) || others.iter().any(|ty| self.is_private(module, ty)) {
            return Ok(());
        }
        let made = item.items.iter().filter_map(|i| match i {
            ImplItem::Type(t) => Some(format!("{}{} = {}", t.ident, line(&t.generics), line(&t.ty))),
            _ => None,
        });
        let made: Vec<String> = made.collect();
        let made = if made.is_empty() { String::new() } else { format!(" ({})", made.join(", ")) };
        let not = if item.modifiers.polarity.is_some() { "!" } else { "" };
        if let Some((path, which)) = own {
            let last = of.segments.last().map_or_else(String::new, line);
            self.traits.entry(path).or_default().insert(format!("{not}{last}{made}{which}"));
        } else {
            let (generics, ends) = (line(&item.generics), bounds(&item.generics));
            let of = public.flatten().unwrap_or_else(|| line(of));
            self.lines.insert(format!("impl{generics} {not}{of} for {}{made}{ends}", line(&item.self_ty)));
        }
        Ok(())
    }

    /// The type of this crate that an `impl` is for, and whether it is named by an alias.
    fn type_of(&self, module: usize, item: &ItemImpl) -> Result<Option<(Target, bool)>, Failure> {
        let (mut module, mut ty, mut aliased) = (module, bare(&item.self_ty), false);
        loop {
            let Type::Path(path) = ty else { return Ok(None) };
            let names = names(&path.path);
            let is_parameter = |one: &String| item.generics.type_params().any(|p| p.ident == one);
            if path.qself.is_some() || matches!(names.as_slice(), [one] if is_parameter(one)) {
                return Ok(None);
            }
            let found = self.of.meant(module, &names, &self.of.modules[module].file)?;
            match (&found, found.as_ref().and_then(|t| self.of.item(t))) {
                (Some(Target::Item(m, _)), Some(Item::Type(alias))) => {
                    (module, ty, aliased) = (*m, bare(&alias.ty), true);
                }
                _ => return Ok(found.map(|t| (t, aliased))),
            }
        }
    }

    /// Whether a type is one of this crate that nobody outside can name.
    fn is_private(&self, module: usize, ty: &Type) -> bool {
        let Type::Path(path) = bare(ty) else { return false };
        let found = self.of.resolve(module, &names(&path.path));
        let own = |t: &&Target| matches!(t, Target::Item(..));
        found.iter().any(|t| own(&t)) && !found.iter().any(|t| self.public.shortest.contains_key(t))
    }

    fn inherent(&mut self, module: usize, item: &ItemImpl, (path, of): (&str, &str)) -> Result<(), Failure> {
        for inner in &item.items {
            let text = match inner {
                ImplItem::Fn(f) if is_public(&f.vis) => {
                    format!(
                        "{}pub {}",
                        noted(&f.attrs),
                        signature(&f.sig, &format!("{path}::{}", f.sig.ident))
                    )
                }
                ImplItem::Const(c) if is_public(&c.vis) => {
                    format!("{}pub const {path}::{}: {}", noted(&c.attrs), c.ident, line(&c.ty))
                }
                ImplItem::Fn(_) | ImplItem::Const(_) => continue,
                other => {
                    let what =
                        format!("impl {path}: what this makes is not known, write it out: {}", line(other));
                    return Err(wrong(&self.of.modules[module].file, what));
                }
            };
            self.lines.insert(text + of);
        }
        Ok(())
    }
}

/// A type without what only groups it.
fn bare(ty: &Type) -> &Type {
    match ty {
        Type::Group(group) => bare(&group.elem),
        Type::Paren(paren) => bare(&paren.elem),
        other => other,
    }
}

/// The names of a path without arguments.
fn names(path: &syn::Path) -> Names {
    path.segments.iter().map(|s| s.ident.to_string()).collect()
}

/// Whether it matters of which of a type's kinds an `impl` is: it has parameters that are no lifetimes, or the type has arguments.
fn has_parameters(item: &ItemImpl) -> bool {
    let arguments = match bare(&item.self_ty) {
        Type::Path(path) => path.path.segments.iter().any(|s| match &s.arguments {
            syn::PathArguments::AngleBracketed(all) => {
                all.args.iter().any(|a| !matches!(a, syn::GenericArgument::Lifetime(_)))
            }
            _ => false,
        }),
        _ => true,
    };
    arguments || item.generics.params.iter().any(|p| !matches!(p, syn::GenericParam::Lifetime(_)))
}

/// The traits of `derive(...)`, and of one that a feature turns on.
fn derives(meta: &syn::Meta) -> Vec<String> {
    let of = syn::punctuated::Punctuated::<syn::Meta, syn::Token![,]>::parse_terminated;
    let Ok(inner) = meta.require_list().and_then(|list| list.parse_args_with(of)) else { return Vec::new() };
    if meta.path().is_ident("derive") {
        inner.iter().filter_map(|m| m.path().segments.last().map(|s| s.ident.to_string())).collect()
    } else if meta.path().is_ident("cfg_attr") {
        inner.iter().skip(1).flat_map(derives).collect()
    } else {
        Vec::new()
    }
}
