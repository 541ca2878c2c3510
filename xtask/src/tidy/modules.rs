//! What the code of one module declares and names: items, children, `use` trees and paths.
//!
//! This is a scan of tokens and not a parser. Modules are files; a module written in braces counts as part of its
//! file. Names that macros make are unknown here: a path to one of them ends at the module in which it is looked up.

use std::collections::{BTreeMap, BTreeSet};

/// One name that a `use` brings in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Use {
    /// The path as written, without the `*` of a glob.
    pub path: Vec<String>,
    /// The name it has here; `None` for a glob.
    pub name: Option<String>,
    /// Whether it is exported in any way (`pub`, `pub(crate)`, `pub(super)`).
    pub public: bool,
    /// Line, counted from 0.
    pub line: usize,
}

/// What the code of a module says of itself and of others. Lines are counted from 0.
#[derive(Clone, Debug, Default)]
pub struct Names {
    /// Modules declared as `mod name;`.
    pub children: BTreeSet<String>,
    /// Items that stand outside of all braces.
    pub items: BTreeSet<String>,
    /// What `use` brings in, inside functions too.
    pub uses: Vec<Use>,
    /// Paths of two and more segments outside of `use`, each with its line.
    pub paths: Vec<(Vec<String>, usize)>,
    /// Single names that stand for an item, each with its first line.
    pub words: BTreeMap<String, usize>,
}

#[derive(Clone, Copy, Debug)]
struct Token<'a> {
    text: &'a str,
    line: usize,
}

/// Words, `::` and single signs. Lifetimes are left out.
fn tokens(code: &str) -> Vec<Token<'_>> {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let mut found = Vec::new();
    for (line, text) in code.lines().enumerate() {
        let mut rest = text.trim_start();
        while let Some(first) = rest.chars().next() {
            let quote = usize::from(first == '\'');
            let length = match first {
                _ if is_word(first) || quote == 1 => {
                    quote + rest[quote..].find(|c| !is_word(c)).unwrap_or(rest.len() - quote)
                }
                ':' if rest.starts_with("::") => 2,
                _ => first.len_utf8(),
            };
            if quote == 0 {
                found.push(Token { text: &rest[..length], line });
            }
            rest = rest[length..].trim_start();
        }
    }
    found
}

/// The keywords before the name of an item.
const ITEMS: [&str; 9] = ["fn", "struct", "enum", "union", "trait", "type", "const", "static", "mod"];

impl Names {
    /// Reads code whose comments, literals and tests are blanked.
    pub fn read(code: &str) -> Self {
        let tokens = tokens(code);
        let text = |i: usize| tokens.get(i).map_or("", |t| t.text);
        let before = |i: usize, back: usize| i.checked_sub(back).map_or("", text);
        let (mut names, mut depth, mut at) = (Self::default(), 0i32, 0);
        let mut locals = BTreeSet::new();
        let mut plain: Vec<Token<'_>> = Vec::new();
        while at < tokens.len() {
            let token = tokens[at];
            match token.text {
                "{" => depth += 1,
                "}" => depth -= 1,
                "use" if text(at + 1) != "<" => {
                    let public = matches!(before(at, 1), "pub" | ")");
                    let mut tree = UseTree { tokens: &tokens, at: at + 1, public, found: Vec::new() };
                    tree.read(&[]);
                    at = tree.at;
                    names.uses.extend(tree.found);
                    continue;
                }
                "mod" if text(at + 2) == ";" => {
                    names.children.insert(text(at + 1).to_owned());
                }
                kind if ITEMS.contains(&kind) && depth == 0 && is_name(text(at + 1)) => {
                    names.items.insert(text(at + 1).to_owned());
                }
                "macro_rules" => {
                    names.items.insert(text(at + 2).to_owned());
                }
                word if is_name(word) || matches!(word, "crate" | "super" | "self" | "Self") => {
                    let mut segments = vec![word.to_owned()];
                    let mut end = at + 1;
                    while text(end) == "::" && (is_name(text(end + 1)) || text(end + 1) == "super") {
                        segments.push(text(end + 1).to_owned());
                        end += 2;
                    }
                    let inner = before(at, 1) == "::";
                    if segments.len() > 1 && !inner {
                        names.paths.push((segments, token.line));
                        at = end;
                        continue;
                    }
                    let bound = matches!(before(at, 1), "let" | "mut" | "|") || text(end) == ":";
                    if bound {
                        locals.insert(word);
                    } else if !matches!(before(at, 1), "." | "fn") && !inner {
                        plain.push(token);
                        if matches!(text(end), "(" | "::" | "!") {
                            names.words.entry(word.to_owned()).or_insert(token.line);
                        }
                    }
                }
                _ => {}
            }
            at += 1;
        }
        // A name in small letters may be a variable; where it is one anywhere in the file only calls count.
        for token in plain.into_iter().filter(|t| !locals.contains(t.text)) {
            let line = names.words.entry(token.text.to_owned()).or_insert(token.line);
            *line = token.line.min(*line);
        }
        names
    }
}

/// Whether a token is an identifier that may name something.
fn is_name(text: &str) -> bool {
    let first = text.chars().next();
    first.is_some_and(|c| c.is_alphabetic() || c == '_')
        && !ITEMS.contains(&text)
        && !matches!(text, "_" | "crate" | "super" | "self" | "Self" | "use" | "pub" | "as" | "impl" | "for")
}

/// The reading of one `use` tree.
struct UseTree<'a> {
    tokens: &'a [Token<'a>],
    at: usize,
    public: bool,
    found: Vec<Use>,
}

impl UseTree<'_> {
    fn text(&self) -> &str {
        self.tokens.get(self.at).map_or(";", |t| t.text)
    }

    /// Reads one branch with the segments before it, up to the sign that ends it.
    fn read(&mut self, before: &[String]) {
        let mut path = before.to_vec();
        let mut name = None;
        let mut is_leaf = false;
        let line = self.tokens.get(self.at).map_or(0, |t| t.line);
        loop {
            match self.text() {
                ";" | "," | "}" => break,
                "{" => {
                    self.at += 1;
                    while !matches!(self.text(), "}" | ";") {
                        self.read(&path);
                        if self.text() == "," {
                            self.at += 1;
                        }
                    }
                    is_leaf = false;
                }
                "*" => {
                    self.found.push(Use { path: path.clone(), name: None, public: self.public, line });
                    is_leaf = false;
                }
                "as" => {
                    self.at += 1;
                    name = Some(self.text().to_owned());
                }
                "::" => {}
                "self" if !before.is_empty() => is_leaf = true,
                segment => {
                    path.push(segment.to_owned());
                    is_leaf = true;
                }
            }
            self.at += 1;
        }
        if is_leaf {
            let name = name.or_else(|| path.last().cloned());
            self.found.push(Use { path, name, public: self.public, line });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn uses(code: &str) -> Vec<String> {
        let shown = |u: &Use| {
            let name = u.name.as_deref().unwrap_or("*");
            format!("{}{}={name}@{}", if u.public { "pub " } else { "" }, u.path.join("::"), u.line)
        };
        Names::read(code).uses.iter().map(shown).collect()
    }

    #[test]
    fn trees_of_use_are_read_leaf_by_leaf() {
        assert_eq!(uses("use crate::a::B;"), ["crate::a::B=B@0"]);
        assert_eq!(
            uses("pub(crate) use super::{a::{self, B as C},\n d::*, };"),
            ["pub super::a=a@0", "pub super::a::B=C@0", "pub super::d=*@1"]
        );
        assert_eq!(uses("fn a() -> impl B + use<'_> {\n use c::D as _; }"), ["c::D=_@1"]);
    }

    #[test]
    fn items_paths_and_words_are_told_apart() {
        let names = Names::read(
            "mod a;\npub struct B<'b>(&'b C);\nimpl B<'_> { fn d(&self) { a::e::<F>(self.g); h(i) } }\n\
             fn j(i: u8) { crate::k::l!(m) }",
        );
        assert!(names.children.contains("a") && names.items.contains("B") && names.items.contains("j"));
        assert!(!names.items.contains("d"));
        let paths: Vec<(String, usize)> = names.paths.iter().map(|(p, line)| (p.join("::"), *line)).collect();
        assert_eq!(paths, [("a::e".to_owned(), 2), ("crate::k::l".to_owned(), 3)]);
        for (word, there) in [("C", true), ("F", true), ("g", false), ("h", true), ("i", false), ("m", true)]
        {
            assert_eq!(names.words.contains_key(word), there, "{word}");
        }
    }
}
