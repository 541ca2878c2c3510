//! The record graph of a Part 21 file: instances by number, read as far as the text is sound.
//!
//! A record that cannot be read is skipped to its semicolon and reported; a truncated file gives what was complete.
//! Nested parameter lists are limited to [`MAX_DEPTH`], so that hostile text cannot exhaust the stack.

use super::lexer::{Lexer, Stop, Token, find};
use osculate_geom::Diagnostic;
use std::collections::{BTreeMap, HashMap};

/// Deepest nesting of lists in a record. Geometry needs four (a net of poles in a typed select); 64 is far above any
/// schema and far below what a thread's stack holds.
const MAX_DEPTH: usize = 64;

/// Findings of one kind that are listed one by one; the rest is counted.
const MAX_LISTED: usize = 8;

/// A parameter of a record.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value {
    /// `$`, `*` or something without use here (binary, resource).
    Nothing,
    /// An integer.
    Int(i64),
    /// A real.
    Real(f64),
    /// A string.
    Text(String),
    /// An enumeration value, `T` and `F` included.
    Enum(String),
    /// A reference.
    Ref(u64),
    /// A list.
    List(Vec<Value>),
    /// `KEYWORD(...)` as a parameter.
    Typed(String, Vec<Value>),
}

impl Value {
    /// The number, integer or real; typed measures are looked through.
    pub(crate) fn number(&self) -> Option<f64> {
        match self {
            Self::Int(i) => Some(*i as f64),
            Self::Real(x) => Some(*x),
            Self::Typed(_, inner) => match inner.as_slice() {
                [one] if !matches!(one, Self::Typed(..)) => one.number(),
                _ => None,
            },
            _ => None,
        }
    }
    /// The referenced instance.
    pub(crate) const fn reference(&self) -> Option<u64> {
        match self {
            Self::Ref(id) => Some(*id),
            _ => None,
        }
    }
    /// The elements of a list; empty for anything else.
    pub(crate) fn list(&self) -> &[Self] {
        match self {
            Self::List(items) => items,
            _ => &[],
        }
    }
    /// `.T.` or `.F.`.
    pub(crate) fn flag(&self) -> Option<bool> {
        match self {
            Self::Enum(e) if e == "T" => Some(true),
            Self::Enum(e) if e == "F" => Some(false),
            _ => None,
        }
    }
    /// The text of a string, empty for anything else.
    pub(crate) fn text(&self) -> &str {
        match self {
            Self::Text(t) => t,
            _ => "",
        }
    }
}

/// An instance: one part, or several for a complex one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Record {
    /// Keyword and parameters of each part.
    pub(crate) parts: Vec<(String, Vec<Value>)>,
}

impl Record {
    /// The parameters of the part with this keyword.
    pub(crate) fn part(&self, keyword: &str) -> Option<&[Value]> {
        self.parts.iter().find(|p| p.0 == keyword).map(|p| p.1.as_slice())
    }
    /// Whether a part has this keyword.
    pub(crate) fn is(&self, keyword: &str) -> bool {
        self.parts.iter().any(|p| p.0 == keyword)
    }
    /// The keyword of a simple record; the parts' keywords joined for a complex one.
    pub(crate) fn kind(&self) -> String {
        self.parts.iter().map(|p| p.0.as_str()).collect::<Vec<_>>().join("+")
    }
    /// All references in the record, in order.
    pub(crate) fn references(&self) -> Vec<u64> {
        fn walk(v: &Value, out: &mut Vec<u64>) {
            match v {
                Value::Ref(id) => out.push(*id),
                Value::List(items) | Value::Typed(_, items) => items.iter().for_each(|i| walk(i, out)),
                _ => {}
            }
        }
        let mut out = Vec::new();
        self.parts.iter().flat_map(|p| &p.1).for_each(|v| walk(v, &mut out));
        out
    }
}

/// All instances of a file.
#[derive(Debug, Default)]
pub(crate) struct Graph {
    /// Records in file order.
    pub(crate) records: Vec<(u64, Record)>,
    index: HashMap<u64, usize>,
    /// Schema names of the header.
    pub(crate) schemas: Vec<String>,
    /// What was found on the way.
    pub(crate) diagnostics: Vec<Diagnostic>,
    /// Whether the file ends inside a record or a section; one that lacks only its last line does not count.
    pub(crate) truncated: bool,
}

/// The missing parameter that empty slots read as.
static NOTHING: Value = Value::Nothing;

impl Graph {
    /// The record with this number.
    pub(crate) fn get(&self, id: u64) -> Option<&Record> {
        self.index.get(&id).map(|k| &self.records[*k].1)
    }

    /// Reads every record of the header and the data sections. `start` is the offset behind `ISO-10303-21`.
    pub(crate) fn read(text: &[u8], start: usize) -> Self {
        let mut graph = Self::default();
        let mut lexer = Lexer::new(text, start);
        let mut bad: Tally = Tally::default();
        let mut duplicates: BTreeMap<u64, usize> = BTreeMap::new();
        let mut ended = false;
        let mut truncated = false;
        let mut in_section = true;
        loop {
            let from = lexer.at;
            match lexer.next() {
                Ok(Token::Id(id)) => match record(&mut lexer) {
                    Ok(r) => {
                        if graph.index.contains_key(&id) {
                            *duplicates.entry(id).or_default() += 1;
                        } else {
                            graph.index.insert(id, graph.records.len());
                            graph.records.push((id, r));
                        }
                    }
                    Err(Fault::End) => {
                        truncated = true;
                        break;
                    }
                    Err(Fault::Bad(what)) => {
                        bad.add(format!("#{id}: {what}"));
                        if !lexer.skip_statement() {
                            truncated = true;
                            break;
                        }
                    }
                    // The statement's semicolon has been read already.
                    Err(Fault::Early(what)) => bad.add(format!("#{id}: {what}")),
                },
                Ok(Token::Word(word)) => {
                    if word == "END-ISO-10303-21" {
                        ended = true;
                        break;
                    }
                    in_section = word != "ENDSEC";
                    if word == "SIGNATURE" {
                        // Base 64 text, no tokens: move to its end.
                        match find(&text[lexer.at..], b"ENDSEC") {
                            Some(n) => lexer.at += n,
                            None => break,
                        }
                        continue;
                    }
                    if word == "FILE_SCHEMA"
                        && let Ok(Token::Open) = lexer.next()
                        && let Ok(values) = list(&mut lexer, 0)
                    {
                        graph.schemas = values
                            .first()
                            .map(|v| v.list().iter().map(|s| s.text().to_owned()).collect())
                            .unwrap_or_default();
                    }
                    if !lexer.skip_statement() {
                        truncated = true;
                        break;
                    }
                }
                Ok(Token::Semicolon) => {}
                Ok(_) => {
                    // `<name>=#1;` of an ANCHOR section, or stray text.
                    if !lexer.skip_statement() {
                        truncated = true;
                        break;
                    }
                }
                Err(Stop::End { open }) => {
                    truncated = open;
                    break;
                }
                Err(Stop::Bad { what }) => {
                    bad.add(format!("byte {from}: {what}"));
                    if !lexer.skip_statement() {
                        break;
                    }
                }
            }
        }
        graph.truncated = truncated || (!ended && in_section);
        if truncated || !ended {
            let last = graph.records.last().map_or_else(String::new, |r| format!("#{}", r.0));
            graph.diagnostics.push(Diagnostic::loss(
                last,
                format!(
                    "the file ends at byte {} without END-ISO-10303-21: it is truncated; {} complete records \
                     were read",
                    text.len(),
                    graph.records.len()
                ),
            ));
        }
        bad.report("unreadable record skipped", &mut graph.diagnostics);
        for (id, count) in duplicates.iter().take(MAX_LISTED) {
            graph.diagnostics.push(Diagnostic::warning(
                format!("#{id}"),
                format!("defined {} times; the first definition is used", count + 1),
            ));
        }
        if duplicates.len() > MAX_LISTED {
            let rest = duplicates.len() - MAX_LISTED;
            graph.diagnostics.push(Diagnostic::warning("", format!("{rest} more numbers defined twice")));
        }
        graph
    }
}

/// Parameter `k`, or [`Value::Nothing`] beyond the end.
pub(crate) fn arg(args: &[Value], k: usize) -> &Value {
    args.get(k).unwrap_or(&NOTHING)
}

/// Messages, the first few kept.
#[derive(Default)]
struct Tally {
    listed: Vec<String>,
    count: usize,
}

impl Tally {
    fn add(&mut self, message: String) {
        if self.listed.len() < MAX_LISTED {
            self.listed.push(message);
        }
        self.count += 1;
    }
    fn report(&self, what: &str, out: &mut Vec<Diagnostic>) {
        for m in &self.listed {
            out.push(Diagnostic::loss("", format!("{what}: {m}")));
        }
        if self.count > self.listed.len() {
            out.push(Diagnostic::loss("", format!("{what}: {} more", self.count - self.listed.len())));
        }
    }
}

/// Why a record could not be read.
enum Fault {
    /// The text ended.
    End,
    /// Malformed; the statement still has to be skipped.
    Bad(String),
    /// Malformed, and the statement's semicolon is already behind.
    Early(String),
}

impl From<Stop> for Fault {
    fn from(stop: Stop) -> Self {
        match stop {
            Stop::End { .. } => Self::End,
            Stop::Bad { what } => Self::Bad(what),
        }
    }
}

fn unexpected(token: &Token, wanted: &str) -> Fault {
    let text = format!("{wanted} expected, found {token:?}");
    if *token == Token::Semicolon { Fault::Early(text) } else { Fault::Bad(text) }
}

/// The rest of an instance after its number.
fn record(lexer: &mut Lexer<'_>) -> Result<Record, Fault> {
    match lexer.next()? {
        Token::Equals => {}
        other => return Err(unexpected(&other, "'='")),
    }
    let mut parts = Vec::new();
    let mut token = lexer.next()?;
    // `#1=&SCOPE ... ENDSCOPE` of the first edition does not occur; `#1=<uri>;` of the third is not a record.
    if token == Token::Open {
        loop {
            match lexer.next()? {
                Token::Word(word) => parts.push((word, parameters(lexer)?)),
                Token::Close => break,
                other => return Err(unexpected(&other, "a keyword or ')'")),
            }
        }
    } else if let Token::Word(word) = token {
        parts.push((word, parameters(lexer)?));
    } else {
        return Err(unexpected(&token, "a keyword"));
    }
    token = lexer.next()?;
    match token {
        Token::Semicolon => Ok(Record { parts }),
        other => Err(unexpected(&other, "';'")),
    }
}

fn parameters(lexer: &mut Lexer<'_>) -> Result<Vec<Value>, Fault> {
    match lexer.next()? {
        Token::Open => list(lexer, 0),
        other => Err(unexpected(&other, "'('")),
    }
}

/// Values up to the closing parenthesis. Stray and doubled commas are passed over.
fn list(lexer: &mut Lexer<'_>, depth: usize) -> Result<Vec<Value>, Fault> {
    if depth >= MAX_DEPTH {
        return Err(Fault::Bad(format!("lists nested deeper than {MAX_DEPTH}")));
    }
    let mut values = Vec::new();
    loop {
        let value = match lexer.next()? {
            Token::Close => return Ok(values),
            Token::Comma => continue,
            Token::Open => Value::List(list(lexer, depth + 1)?),
            Token::Id(id) => Value::Ref(id),
            Token::Int(i) => Value::Int(i),
            Token::Real(x) => Value::Real(x),
            Token::Text(t) => Value::Text(t),
            Token::Enum(e) => Value::Enum(e),
            Token::Omitted | Token::Derived | Token::Binary | Token::Resource => Value::Nothing,
            Token::Word(word) => match lexer.next()? {
                Token::Open => Value::Typed(word, list(lexer, depth + 1)?),
                other => return Err(unexpected(&other, "'(' after a keyword")),
            },
            other => return Err(unexpected(&other, "a parameter")),
        };
        values.push(value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Graph {
        Graph::read(text.as_bytes(), 0)
    }

    #[test]
    fn simple_and_complex_records() {
        let g = read("DATA;#1=A('x',(1,2.),$,.T.,B(3.));#2=(C(#1)D());ENDSEC;END-ISO-10303-21;");
        assert!(g.diagnostics.is_empty(), "{:?}", g.diagnostics);
        let a = g.get(1).unwrap().part("A").unwrap();
        assert_eq!(a[1].list().iter().filter_map(Value::number).sum::<f64>(), 3.0);
        assert_eq!((a[3].flag(), a[4].number(), arg(a, 9)), (Some(true), Some(3.0), &Value::Nothing));
        assert_eq!((g.get(2).unwrap().kind().as_str(), g.get(2).unwrap().references()), ("C+D", vec![1]));
    }

    #[test]
    fn damage_is_skipped_and_told() {
        let g = read("#1=A(1;#2=A(2);#2=A(3);#3=;#4=A((?));#5=A(5);END-ISO-10303-21;");
        let ids: Vec<u64> = g.records.iter().map(|r| r.0).collect();
        assert_eq!(ids, [2, 5]);
        assert_eq!(g.get(2).unwrap().part("A").unwrap()[0], Value::Int(2));
        assert_eq!(g.diagnostics.len(), 4, "{:?}", g.diagnostics);
    }

    #[test]
    fn truncation_keeps_what_is_complete() {
        let g = read("#1=A(1);#2=A('abc");
        assert_eq!(g.records.len(), 1);
        assert!(g.diagnostics[0].message.contains("truncated"));
    }

    #[test]
    fn deep_nesting_is_refused() {
        let text = format!("#1=A({}1{});#2=A();END-ISO-10303-21;", "(".repeat(100_000), ")".repeat(100_000));
        let g = read(&text);
        assert!(g.get(1).is_none() && g.get(2).is_some());
        assert!(g.diagnostics[0].message.contains("nested"));
    }
}
