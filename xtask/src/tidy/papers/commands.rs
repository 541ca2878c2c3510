//! The verbs of the program and their options, read from the source of its command line.

use proc_macro2::{TokenStream, TokenTree};
use std::collections::{BTreeMap, BTreeSet};
use syn::{Attribute, Field, Fields, File, Item, ItemStruct, Type};

/// The name of the program.
pub const PROGRAM: &str = "osculate ";

/// Options by verb.
pub type Verbs = BTreeMap<String, BTreeSet<String>>;

/// What is wrong with a command: no such verb, or no such option of it.
pub fn wrong(command: &str, verbs: &Verbs) -> Option<String> {
    let mut words = command.split_whitespace().skip(1);
    let verb = words.next().unwrap_or_default();
    let Some(options) = verbs.get(verb) else { return Some(format!("the program has no verb `{verb}`")) };
    let mut asked = words.filter_map(|word| word.strip_prefix("--"));
    let unknown = asked.find(|option| !options.contains(*option))?;
    Some(format!("`osculate {verb}` has no option `--{unknown}`"))
}

/// The verbs in the variants of an enum `Verb`, each with its options and those of the struct `Cli`. Empty where the source is not of that
/// shape.
pub fn verbs(source: &str) -> Verbs {
    let mut out = Verbs::new();
    let Ok(file) = syn::parse_file(source) else { return out };
    let variants = file.items.iter().find_map(|item| match item {
        Item::Enum(e) if e.ident == "Verb" => Some(&e.variants),
        _ => None,
    });
    for variant in variants.into_iter().flatten() {
        let mut options = BTreeSet::new();
        match &variant.fields {
            Fields::Named(named) => named.named.iter().for_each(|f| option(f, &file, &mut options)),
            Fields::Unnamed(given) => given.unnamed.iter().for_each(|f| of_type(&f.ty, &file, &mut options)),
            Fields::Unit => {}
        }
        if let Some(all) = struct_of(&file, "Cli") {
            all.fields.iter().for_each(|f| option(f, &file, &mut options));
        }
        out.insert(variant.ident.to_string().to_lowercase(), options);
    }
    out
}

fn struct_of<'a>(file: &'a File, name: &str) -> Option<&'a ItemStruct> {
    file.items.iter().find_map(|item| match item {
        Item::Struct(s) if s.ident == name => Some(s),
        _ => None,
    })
}

/// The options of the fields of a struct of the file.
fn of_type(ty: &Type, file: &File, out: &mut BTreeSet<String>) {
    let Type::Path(path) = ty else { return };
    let name = path.path.segments.last().map(|s| s.ident.to_string());
    if let Some(s) = name.and_then(|name| struct_of(file, &name)) {
        s.fields.iter().for_each(|f| option(f, file, out));
    }
}

/// The option that a field is, or those of what it holds.
fn option(field: &Field, file: &File, out: &mut BTreeSet<String>) {
    if words(&field.attrs, "command").iter().any(|word| word == "flatten") {
        of_type(&field.ty, file, out);
    }
    let own = words(&field.attrs, "arg").iter().any(|word| word == "long");
    if let Some(name) = field.ident.as_ref().filter(|_| own) {
        out.insert(name.to_string().replace('_', "-"));
    }
}

/// The words at the top level of attributes of a name.
fn words(attributes: &[Attribute], name: &str) -> Vec<String> {
    let lists =
        attributes.iter().filter(|a| a.path().is_ident(name)).filter_map(|a| a.meta.require_list().ok());
    lists.flat_map(|list| idents(list.tokens.clone())).collect()
}

fn idents(tokens: TokenStream) -> Vec<String> {
    let word = |tree| match tree {
        TokenTree::Ident(ident) => Some(ident.to_string()),
        _ => None,
    };
    tokens.into_iter().filter_map(word).collect()
}
