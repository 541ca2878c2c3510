//! `macro_rules!` written out, as far as it is needed to know which items a call makes.
//!
//! Matching is greedy, as the compiler's is where it takes a macro at all. Fragments are read by `syn`; hygiene does not matter for items.

use proc_macro2::{Delimiter, Group, Ident, TokenStream, TokenTree};
use quote::ToTokens;
use std::collections::BTreeMap;
use syn::parse::{Parse, ParseStream, Parser};

/// One arm of a macro.
struct Arm {
    matcher: Vec<Part>,
    body: TokenStream,
}

/// A part of a matcher.
enum Part {
    /// A token as it stands.
    Token(String),
    Group(Delimiter, Vec<Self>),
    /// `$name:fragment`.
    Bind(String, String),
    /// `$( ... ) separator op`.
    Repeat {
        inner: Vec<Self>,
        separator: Option<String>,
        op: char,
    },
}

/// What a name of a matcher stands for.
#[derive(Clone)]
enum Bound {
    One(TokenStream),
    Many(Vec<Bindings>),
}

type Bindings = BTreeMap<String, Bound>;

/// The matchers of a macro's arms, as they are written.
pub fn matchers(definition: &TokenStream) -> Result<Vec<TokenStream>, String> {
    Ok(arms(definition)?.into_iter().map(|(matcher, _)| matcher).collect())
}

/// What a call makes.
///
/// # Errors
/// Where the definition cannot be read or no arm takes the call.
pub fn expand(definition: &TokenStream, call: &TokenStream) -> Result<TokenStream, String> {
    for (matcher, body) in arms(definition)? {
        let arm = Arm { matcher: parts(&trees(matcher))?, body };
        let (mut bound, input) = (Bindings::new(), trees(call.clone()));
        if matched(&arm.matcher, &input, &mut bound).is_some_and(<[TokenTree]>::is_empty) {
            return written(&trees(arm.body), &bound);
        }
    }
    Err("no arm of the macro takes this call".to_owned())
}

fn trees(tokens: TokenStream) -> Vec<TokenTree> {
    tokens.into_iter().collect()
}

/// The matcher and the body of each arm.
fn arms(definition: &TokenStream) -> Result<Vec<(TokenStream, TokenStream)>, String> {
    let trees = trees(definition.clone());
    let groups: Vec<&Group> = trees
        .iter()
        .filter_map(|tree| match tree {
            TokenTree::Group(group) => Some(group),
            _ => None,
        })
        .collect();
    let (pairs, []) = groups.as_chunks::<2>() else {
        return Err("a macro whose arms cannot be told apart".to_owned());
    };
    Ok(pairs.iter().map(|[matcher, body]| (matcher.stream(), body.stream())).collect())
}

fn sign(tree: Option<&TokenTree>) -> Option<char> {
    match tree {
        Some(TokenTree::Punct(sign)) => Some(sign.as_char()),
        _ => None,
    }
}

/// After `$( ... )`: the separator, the operator and how many trees they are.
fn repetition(after: &[TokenTree]) -> Result<(Option<String>, char, usize), String> {
    let op = |k: usize| sign(after.get(k)).filter(|c| matches!(c, '*' | '+' | '?'));
    match (op(0), op(1)) {
        (Some(op), _) => Ok((None, op, 1)),
        (None, Some(op)) => Ok((Some(after[0].to_string()), op, 2)),
        (None, None) => {
            Err("a repetition without `*`, `+` or `?` right after it or its separator".to_owned())
        }
    }
}

fn parts(trees: &[TokenTree]) -> Result<Vec<Part>, String> {
    let (mut out, mut at) = (Vec::new(), 0);
    while at < trees.len() {
        match (&trees[at], &trees[at + 1..]) {
            (TokenTree::Punct(dollar), [TokenTree::Ident(name), colon, TokenTree::Ident(kind), ..])
                if dollar.as_char() == '$' && sign(Some(colon)) == Some(':') =>
            {
                out.push(Part::Bind(name.to_string(), kind.to_string()));
                at += 4;
            }
            (TokenTree::Punct(dollar), [TokenTree::Group(group), after @ ..]) if dollar.as_char() == '$' => {
                let (separator, op, length) = repetition(after)?;
                out.push(Part::Repeat { inner: parts(&self::trees(group.stream()))?, separator, op });
                at += 2 + length;
            }
            (TokenTree::Group(group), _) => {
                out.push(Part::Group(group.delimiter(), parts(&self::trees(group.stream()))?));
                at += 1;
            }
            (token, _) => {
                out.push(Part::Token(token.to_string()));
                at += 1;
            }
        }
    }
    Ok(out)
}

/// Holds the parts against the beginning of the input; what is left of it, or `None`.
fn matched<'a>(parts: &[Part], mut input: &'a [TokenTree], bound: &mut Bindings) -> Option<&'a [TokenTree]> {
    for part in parts {
        input = match (part, input) {
            (Part::Token(text), [tree, rest @ ..]) if tree.to_string() == *text => rest,
            (Part::Group(delimiter, inner), [TokenTree::Group(group), rest @ ..])
                if group.delimiter() == *delimiter =>
            {
                matched(inner, &trees(group.stream()), bound)
                    .is_some_and(<[TokenTree]>::is_empty)
                    .then_some(rest)?
            }
            (Part::Bind(name, kind), _) => {
                let (found, length) = fragment(kind, input)?;
                bound.insert(name.clone(), Bound::One(found));
                &input[length..]
            }
            (Part::Repeat { inner, separator, op }, _) => {
                let (rounds, rest) = repeated(inner, (separator.as_deref(), *op), input);
                if *op == '+' && rounds.is_empty() {
                    return None;
                }
                let mut names = Vec::new();
                names_of(inner, &mut names);
                for name in names {
                    bound.insert(name, Bound::Many(rounds.clone()));
                }
                rest
            }
            _ => return None,
        };
    }
    Some(input)
}

fn repeated<'a>(
    inner: &[Part],
    (separator, op): (Option<&str>, char),
    mut input: &'a [TokenTree],
) -> (Vec<Bindings>, &'a [TokenTree]) {
    let mut rounds = Vec::new();
    loop {
        let here = match (separator, input) {
            (Some(separator), [tree, rest @ ..]) if !rounds.is_empty() && tree.to_string() == separator => {
                rest
            }
            (Some(_), _) if !rounds.is_empty() => break,
            _ => input,
        };
        let mut round = Bindings::new();
        match matched(inner, here, &mut round) {
            Some(rest) if rest.len() < input.len() => input = rest,
            _ => break,
        }
        rounds.push(round);
        if op == '?' {
            break;
        }
    }
    (rounds, input)
}

/// The names that parts bind.
fn names_of(parts: &[Part], out: &mut Vec<String>) {
    for part in parts {
        match part {
            Part::Bind(name, _) => out.push(name.clone()),
            Part::Group(_, inner) | Part::Repeat { inner, .. } => names_of(inner, out),
            Part::Token(_) => {}
        }
    }
}

/// A fragment at the beginning of the input, and how many trees it takes.
fn fragment(kind: &str, input: &[TokenTree]) -> Option<(TokenStream, usize)> {
    fn read<T: Parse + ToTokens>(input: &[TokenTree]) -> Option<(TokenStream, usize)> {
        taken(input, |stream| Ok(stream.parse::<T>()?.into_token_stream()))
    }
    match kind {
        "tt" => input.first().map(|tree| (tree.clone().into(), 1)),
        "ident" => read::<Ident>(input),
        "lifetime" => read::<syn::Lifetime>(input),
        "literal" => read::<syn::Lit>(input),
        "ty" => read::<syn::Type>(input),
        "path" => read::<syn::Path>(input),
        "vis" => read::<syn::Visibility>(input),
        "item" => read::<syn::Item>(input),
        "block" => read::<syn::Block>(input),
        "meta" => read::<syn::Meta>(input),
        "expr" => {
            let (found, length) = read::<syn::Expr>(input)?;
            Some((TokenTree::Group(Group::new(Delimiter::None, found)).into(), length))
        }
        "pat" | "pat_param" => taken(input, |stream| Ok(syn::Pat::parse_single(stream)?.into_token_stream())),
        _ => None,
    }
}

fn taken(
    input: &[TokenTree],
    read: impl Fn(ParseStream<'_>) -> syn::Result<TokenStream>,
) -> Option<(TokenStream, usize)> {
    let whole: TokenStream = input.iter().cloned().collect();
    let both = |stream: ParseStream<'_>| Ok((read(stream)?, stream.parse::<TokenStream>()?));
    let (found, rest) = both.parse2(whole).ok()?;
    Some((found, input.len() - rest.into_iter().count()))
}

/// A body with its names replaced.
fn written(body: &[TokenTree], bound: &Bindings) -> Result<TokenStream, String> {
    let (mut out, mut at) = (TokenStream::new(), 0);
    while at < body.len() {
        match (&body[at], &body[at + 1..]) {
            (TokenTree::Punct(dollar), [TokenTree::Ident(name), ..]) if dollar.as_char() == '$' => {
                match bound.get(&name.to_string()) {
                    Some(Bound::One(tokens)) => out.extend(tokens.clone()),
                    Some(Bound::Many(_)) => return Err(format!("${name} stands outside of its repetition")),
                    None if name == "crate" => out.extend([TokenTree::Ident(name.clone())]),
                    None => return Err(format!("${name} is not bound")),
                }
                at += 2;
            }
            (TokenTree::Punct(dollar), [TokenTree::Group(group), after @ ..]) if dollar.as_char() == '$' => {
                let (separator, _, length) = repetition(after)?;
                let inner = trees(group.stream());
                let mut used = Vec::new();
                names_in(&inner, &mut used);
                let rounds = used.iter().find_map(|name| match bound.get(name) {
                    Some(Bound::Many(rounds)) => Some(rounds),
                    _ => None,
                });
                for (k, round) in rounds.ok_or("a repetition in which nothing repeats")?.iter().enumerate() {
                    if let Some(separator) = separator.as_ref().filter(|_| k > 0) {
                        out.extend(separator.parse::<TokenStream>().map_err(|e| e.to_string())?);
                    }
                    let mut inside = bound.clone();
                    inside.extend(round.clone());
                    out.extend(written(&inner, &inside)?);
                }
                at += 2 + length;
            }
            (TokenTree::Group(group), _) => {
                let inner = written(&trees(group.stream()), bound)?;
                out.extend([TokenTree::Group(Group::new(group.delimiter(), inner))]);
                at += 1;
            }
            (token, _) => {
                out.extend([token.clone()]);
                at += 1;
            }
        }
    }
    Ok(out)
}

/// The names after `$`.
fn names_in(trees: &[TokenTree], out: &mut Vec<String>) {
    for (k, tree) in trees.iter().enumerate() {
        match tree {
            TokenTree::Group(group) => names_in(&self::trees(group.stream()), out),
            TokenTree::Ident(name) if k > 0 && sign(trees.get(k - 1)) == Some('$') => {
                out.push(name.to_string())
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn expanded(definition: &str, call: &str) -> Result<String, String> {
        let [definition, call] = [definition, call].map(|text| text.parse().unwrap());
        expand(&definition, &call).map(|tokens| tokens.to_string().split_whitespace().collect())
    }

    #[test]
    fn calls_are_written_out() {
        let words = "($(#[$about:meta])* $name:ident { $($v:ident = $w:literal,)+ }) => { $(#[$about])* pub enum $name { $($v,)+ }
                     impl $name { pub const ALL: &[&str] = &[$($w),+]; } };";
        assert_eq!(
            expanded(words, "/// A. \n B { C = \"c\", D = \"d\", }").unwrap(),
            "#[doc=\"A.\"]pubenumB{C,D,}implB{pubconstALL:&[&str]=&[\"c\",\"d\"];}"
        );
        let types = "($($t:ty),*) => {$(impl $crate::A for $t {})*}; (one $e:expr) => { const X: u8 = $e; }";
        assert_eq!(expanded(types, "&C, Box<C>").unwrap(), "implcrate::Afor&C{}implcrate::AforBox<C>{}");
        assert_eq!(expanded(types, "one 1 + 2").unwrap(), "constX:u8=1+2;");
    }

    #[test]
    fn calls_that_no_arm_takes_are_refused() {
        assert!(
            expanded("($a:ident) => {};", "1").is_err() && expanded("($($a:ident)+) => {};", "").is_err()
        );
        assert!(expanded("() => { $b };", "").unwrap_err().contains("$b"));
        assert_eq!(matchers(&"(a) => {}; (b) => {}".parse().unwrap()).unwrap().len(), 2);
    }
}
