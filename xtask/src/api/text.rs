//! Tokens as one line of text: the same for the same tokens, however the source breaks its lines.

use proc_macro2::{Delimiter, Spacing, TokenStream, TokenTree};
use quote::ToTokens;

/// What stands in the line, for the sake of the blanks between.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Word,
    Lifetime,
    Sign,
    Open,
    Close,
}

#[derive(Debug)]
struct Piece {
    text: String,
    kind: Kind,
}

/// Signs of two and three characters that stand in items.
const JOINED: [&str; 9] = ["..=", "...", "::", "->", "=>", "==", "!=", "&&", ".."];

/// Words after which a bracket opens something new.
const APART: [&str; 9] = ["as", "const", "dyn", "fn", "impl", "in", "mut", "ref", "where"];

/// The tokens as one line.
pub fn line(tokens: &impl ToTokens) -> String {
    let mut pieces = Vec::new();
    flatten(tokens.to_token_stream(), &mut pieces);
    let mut out = String::new();
    for (k, piece) in pieces.iter().enumerate() {
        let next = pieces.get(k + 1);
        // A comma before the end of a list says nothing.
        if piece.text == "," && next.is_some_and(|n| n.kind == Kind::Close || n.text == ">") {
            continue;
        }
        let before = k.checked_sub(1).map(|k| &pieces[k]).filter(|_| !out.is_empty());
        if before.is_some_and(|before| blank(before, piece)) {
            out.push(' ');
        }
        out += &piece.text;
    }
    out
}

fn flatten(tokens: TokenStream, out: &mut Vec<Piece>) {
    let mut signs = String::new();
    let mut trees = tokens.into_iter().peekable();
    while let Some(tree) = trees.next() {
        match tree {
            TokenTree::Group(group) => {
                let (open, close) = match group.delimiter() {
                    Delimiter::Parenthesis => ("(", ")"),
                    Delimiter::Bracket => ("[", "]"),
                    Delimiter::Brace => ("{", "}"),
                    Delimiter::None => ("", ""),
                };
                let mut side = |text: &str, kind| {
                    if !text.is_empty() {
                        out.push(Piece { text: text.to_owned(), kind });
                    }
                };
                side(open, Kind::Open);
                flatten(group.stream(), out);
                if !close.is_empty() {
                    out.push(Piece { text: close.to_owned(), kind: Kind::Close });
                }
            }
            TokenTree::Punct(sign) if sign.as_char() == '\'' => {
                let name = trees.next().map_or_else(String::new, |t| t.to_string());
                out.push(Piece { text: format!("'{name}"), kind: Kind::Lifetime });
            }
            TokenTree::Punct(sign) => {
                signs.push(sign.as_char());
                let goes_on = sign.spacing() == Spacing::Joint
                    && matches!(trees.peek(), Some(TokenTree::Punct(p)) if p.as_char() != '\'');
                if !goes_on {
                    split(&signs, out);
                    signs.clear();
                }
            }
            word => out.push(Piece { text: word.to_string(), kind: Kind::Word }),
        }
    }
}

/// Signs that stand together, each of [`JOINED`] as one: `>` and `,` stay two.
fn split(signs: &str, out: &mut Vec<Piece>) {
    let mut rest = signs;
    while !rest.is_empty() {
        let whole = JOINED.iter().find(|j| rest.starts_with(**j)).map_or(1, |j| j.len());
        let (text, after) = rest.split_at(whole);
        out.push(Piece { text: text.to_owned(), kind: Kind::Sign });
        rest = after;
    }
}

/// Whether a blank stands between two pieces.
fn blank(a: &Piece, b: &Piece) -> bool {
    let word = a.kind == Kind::Word && !APART.contains(&a.text.as_str());
    match (a.text.as_str(), b.text.as_str()) {
        (_, "," | ";" | ":" | "." | ")" | "]" | ">") | ("(" | "[", _) => false,
        ("{", "}") => false,
        ("<" | "::" | "&" | "#" | "!" | "?" | "$" | "." | "..", _) => false,
        ("*", "const" | "mut") => false,
        (_, "::") => !(a.kind == Kind::Word || a.text == ">"),
        (_, "<") => !(a.kind == Kind::Word && a.text != "as"),
        (_, "!") => a.kind != Kind::Word,
        (_, "(") => !(word || matches!(a.text.as_str(), ">" | "fn")),
        (_, "[") => !word,
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use super::line;

    #[test]
    fn lines_read_as_people_write_them() {
        for text in [
            "pub fn f<'a, T: Fn(&'a [f64; 3]) -> X + ?Sized>(&'a mut self, a: &mut [T], b: (f64, [X; N])) -> Option<Vec<T>>",
            "impl<const N: usize> a::B<N> where for<'a> &'a T: Add<Output = T>, T: 'static",
            "dyn Fn(f64) -> f64 + Sync + '_",
            "<T as a::B>::C",
            "*const T",
            "Vec<Vec<f64>>",
            "#[cfg(not(unix))]",
            "!",
        ] {
            let tokens: proc_macro2::TokenStream = text.parse().unwrap();
            assert_eq!(line(&tokens), text);
        }
    }

    #[test]
    fn breaks_of_lines_and_last_commas_do_not_count() {
        let one: proc_macro2::TokenStream = "f<A, B>(a: A, b: B)".parse().unwrap();
        let two: proc_macro2::TokenStream = "f<\n A,\n B,\n>(\n a: A,\n b: B,\n)".parse().unwrap();
        assert_eq!(line(&one), line(&two));
    }
}
