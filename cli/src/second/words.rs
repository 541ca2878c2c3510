//! Lines of programs as words.

use super::refusal::{NoOpinion, Unread};
use super::vector::usual;

/// A word of an ISO dialect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Word<'a> {
    /// A letter with its number, `X-1.5`, or a longer name, `CA1=1.5`.
    Value(&'a str, f64),
    /// A number that an axis reaches by the shortest way, `C=DC(40.8)`.
    Shortest(&'a str, f64),
    /// A name with an index and a number, `FGREF[C]=57.3`.
    Indexed(&'a str),
    /// A name with arguments, `FGROUP(X,Y)`.
    Call(&'a str, &'a str),
    /// A name alone.
    Name(&'a str),
}

pub(super) fn refuse<T>(line: usize, word: &str, why: Unread) -> Result<T, NoOpinion> {
    // Enough to find it again.
    Err(NoOpinion::Word { line, word: word.chars().take(40).collect(), why })
}

/// A decimal number: no exponent, nothing beyond any machine.
pub(super) fn number(text: &str) -> Option<f64> {
    let plain = text.bytes().all(|b| b.is_ascii_digit() || matches!(b, b'+' | b'-' | b'.'));
    if plain { text.parse().ok().filter(|v: &f64| usual(*v)) } else { None }
}

/// The words of a line of Sinumerik (`round` false), Fanuc or LinuxCNC; comments are left out.
pub(super) fn iso(line: usize, text: &str, round: bool) -> Result<Vec<Word<'_>>, NoOpinion> {
    let text = match text.find(';') {
        Some(at) if !text[..at].contains(['(', '"']) => &text[..at],
        _ => text,
    };
    let mut words = Vec::with_capacity(8);
    let mut rest = text.trim();
    while !rest.is_empty() {
        let syntax = || refuse(line, rest, Unread::Syntax);
        if round && rest.starts_with('(') {
            let Some(end) = rest.find(')') else { return syntax() };
            rest = rest[end + 1..].trim_start();
            continue;
        }
        let length = |t: &str, of: fn(u8) -> bool| t.bytes().take_while(|b| of(*b)).count();
        let name = length(rest, |b| b.is_ascii_uppercase() || b.is_ascii_digit() || b == b'_');
        let letters = length(rest, |b| b.is_ascii_uppercase() || b == b'_');
        if letters == 0 {
            return syntax();
        }
        let (long, after) = rest.split_at(name);
        let numeric = |t: &str| length(t, |b| b.is_ascii_digit() || matches!(b, b'+' | b'-' | b'.'));
        let end;
        if let Some(given) = after.strip_prefix('=').filter(|_| !round) {
            if let Some(inner) = given.strip_prefix("DC(") {
                let close = inner.find(')').unwrap_or(0);
                let Some(value) = number(&inner[..close]) else { return syntax() };
                words.push(Word::Shortest(long, value));
                end = name + 4 + close + 1;
            } else {
                let digits = numeric(given);
                let Some(value) = number(&given[..digits]) else { return syntax() };
                words.push(Word::Value(long, value));
                end = name + 1 + digits;
            }
        } else if after.starts_with('[') && !round {
            let Some(close) = after.find("]=") else { return syntax() };
            let digits = numeric(&after[close + 2..]);
            if number(&after[close + 2..close + 2 + digits]).is_none() {
                return syntax();
            }
            words.push(Word::Indexed(long));
            end = name + close + 2 + digits;
        } else if after.starts_with('(') && !round {
            let Some(close) = after.find(')') else { return syntax() };
            words.push(Word::Call(long, &after[1..close]));
            end = name + close + 1;
        } else if letters == 1 && numeric(&rest[1..]) > 0 {
            let digits = numeric(&rest[1..]);
            let Some(value) = number(&rest[1..1 + digits]) else { return syntax() };
            words.push(Word::Value(&rest[..1], value));
            end = 1 + digits;
        } else {
            words.push(Word::Name(long));
            end = name;
        }
        rest = rest[end..].trim_start();
    }
    Ok(words)
}

/// Letters and a number of Klartext, `X+1.5`.
pub(super) fn klartext(word: &str) -> Option<(&str, f64)> {
    let letters = word.bytes().take_while(u8::is_ascii_uppercase).count();
    let (name, value) = word.split_at(letters);
    Some((name, number(value)?)).filter(|_| !name.is_empty())
}
