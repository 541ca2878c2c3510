//! The keys and values of a job file held against the schema, each with its line.

use crate::failure::Failure;
use crate::job::keys::{LIST, ONE};
use crate::job::problem::{Places, full, shown};
use crate::job::schema::{Key, Kind, ONE_OR_MORE, Range, Schema};
use crate::job::words::nearest;
use std::path::Path;
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

/// Longest value that a message repeats, characters.
const SHOWN: usize = 40;

/// A text with the places of its keys.
struct Reader<'a> {
    text: &'a str,
    /// Where lines end.
    ends: Vec<usize>,
    places: Places,
    schema: &'a Schema,
}

/// What a value lacks: what was expected, and the nearest word.
struct Wrong {
    expected: String,
    nearest: Option<String>,
}

/// Holds a job file against the schema; the places of its keys serve later messages.
///
/// # Errors
/// At the first key or value that cannot be meant.
pub fn places(text: &str, path: &Path, schema: &Schema) -> Result<Places, Failure> {
    let ends = text.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(at, _)| at).collect();
    let mut reader = Reader { text, ends, places: Places::new(path), schema };
    let top = DeTable::parse(text).map_err(|e| reader.syntax(&e))?;
    reader.table("", top.get_ref())?;
    reader.needed("", top.get_ref())?;
    Ok(reader.places)
}

/// The format that a job file says it has, where it says one, and the line that says so.
pub fn format(text: &str) -> Option<(i64, usize)> {
    let top = DeTable::parse(text).ok()?;
    let said = top.get_ref().get("format")?;
    Some((whole(said.get_ref())?, line(text, said.span().start)))
}

/// The line of a place of a text.
pub fn line(text: &str, at: usize) -> usize {
    1 + text.bytes().take(at).filter(|b| *b == b'\n').count()
}

impl Reader<'_> {
    fn line(&self, at: usize) -> usize {
        1 + self.ends.partition_point(|end| *end < at)
    }

    fn syntax(&self, e: &toml::de::Error) -> Failure {
        let line = e.span().map(|s| self.line(s.start));
        let written = e.span().and_then(|s| self.text.get(s)).unwrap_or_default();
        let at: String = written.lines().next().unwrap_or_default().chars().take(SHOWN).collect();
        let at = if at.is_empty() { at } else { format!(" at `{at}`") };
        let what = format!("no TOML: {}{at}", e.message().trim_end());
        self.places.at(line, "", what, "TOML".to_owned(), None)
    }

    /// All keys of a table, and of the tables in it.
    fn table(&mut self, name: &str, table: &DeTable<'_>) -> Result<(), Failure> {
        let kind = plain(name);
        for (key, value) in table {
            let line = self.line(key.span().start);
            let key: &str = key.get_ref();
            self.places.keep(name, key, line);
            if name.is_empty() && self.schema.is_list(key) {
                self.list(key, value)?;
            } else if self.schema.tables_in(&kind).contains(&key)
                && (value.get_ref().is_table() || self.schema.key(&kind, key).is_none())
            {
                match value.get_ref() {
                    DeValue::Table(t) => self.table(&full(name, key), t)?,
                    DeValue::Array(all) if ONE_OR_MORE.contains(&full(&kind, key).as_str()) => {
                        self.sections(&full(name, key), all)?;
                    }
                    _ => {
                        let what = format!("{key} is a table: write [{}] above its keys", full(name, key));
                        return Err(self.places.full(name, key, what, "a table".to_owned(), None));
                    }
                }
            } else if let Some(known) = self.schema.key(&kind, key) {
                check(&known.kind, value.get_ref()).map_err(|wrong| self.wrong(name, known, value, wrong))?;
            } else {
                return Err(self.unknown(name, &kind, key));
            }
        }
        Ok(())
    }

    fn list(&mut self, list: &str, value: &Spanned<DeValue<'_>>) -> Result<(), Failure> {
        let all = value.get_ref().as_array();
        for (k, one) in all.into_iter().flatten().enumerate() {
            let name = format!("{list}[{}]", k + 1);
            self.places.keep(&name, "", self.line(one.span().start));
            let Some(table) = one.get_ref().as_table() else { return Err(self.no_list(list)) };
            self.table(&name, table)?;
        }
        if all.is_some() { Ok(()) } else { Err(self.no_list(list)) }
    }

    /// The tables of a list that stands where one table may.
    fn sections(&mut self, name: &str, all: &DeArray<'_>) -> Result<(), Failure> {
        for (k, one) in all.iter().enumerate() {
            let own = format!("{name}[{}]", k + 1);
            self.places.keep(&own, "", self.line(one.span().start));
            let Some(table) = one.get_ref().as_table() else {
                let what = format!("{name} is a table, or a list of tables");
                return Err(self.places.full(name, "", what, "tables".to_owned(), None));
            };
            self.table(&own, table)?;
        }
        Ok(())
    }

    fn no_list(&self, list: &str) -> Failure {
        let what = format!("{list} is a list of tables: write [[{list}]] above the keys of each");
        self.places.full("", list, what, "a list of tables".to_owned(), None)
    }

    /// Keys that must be given, in the table and those in it.
    fn needed(&self, name: &str, table: &DeTable<'_>) -> Result<(), Failure> {
        let kind = plain(name);
        let has = |key: &str| table.contains_key(key);
        for key in self.schema.keys(&kind) {
            if key.default.is_none() && !has(key.name) {
                let what = format!("needs {}: {} ({})", key.name, key.kind.expects(), key.meaning);
                return Err(self.places.full(name, "", what, key.kind.expects(), None));
            }
        }
        for inner in self.schema.tables_in(&kind) {
            let path = full(name, inner);
            match table.get(inner).map(Spanned::get_ref) {
                Some(DeValue::Table(t)) => self.needed(&path, t)?,
                Some(DeValue::Array(all)) => {
                    for (k, one) in all.iter().enumerate() {
                        if let DeValue::Table(t) = one.get_ref() {
                            self.needed(&format!("{path}[{}]", k + 1), t)?;
                        }
                    }
                }
                _ if self.schema.needs(&plain(&path)) => {
                    let shown =
                        if self.schema.is_list(&path) { format!("[[{path}]]") } else { format!("[{path}]") };
                    let what = format!("needs a table {shown}");
                    return Err(self.places.full(name, "", what, shown, None));
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn unknown(&self, name: &str, kind: &str, key: &str) -> Failure {
        let here: Vec<&str> =
            self.schema.keys(kind).map(|k| k.name).chain(self.schema.tables_in(kind)).collect();
        let list = name.ends_with(']').then(|| format!("[[{}]]", plain(name)));
        let own = if name.is_empty() { "a job".to_owned() } else { shown(name).trim_end().to_owned() };
        let place = list.unwrap_or(own);
        let takes = format!("{place} takes {}", here.join(", "));
        let owner = self.schema.tables.iter().find(|t| !t.name.is_empty() && t.key(key).is_some());
        let near = nearest(key, here.iter().copied());
        let other = if self.schema.format == 1 { &*LIST } else { &*ONE };
        let there = other.key(kind, key).is_some() || other.tables_in(kind).contains(&key);
        let what = match (near, owner) {
            _ if there => {
                let formats = [self.schema.format, other.format];
                format!(
                    "{key} is no key here with format = {}, but with format = {}; {takes}",
                    formats[0], formats[1]
                )
            }
            (None, Some(t)) => format!("{key} is no key here, but one of [{}]; {takes}", t.name),
            _ => format!("{key} is no key here; {takes}"),
        };
        let elsewhere = owner.map(|t| format!("[{}] {key}", t.name));
        self.places.full(name, key, what, here.join(", "), near.or(elsewhere.as_deref()))
    }

    fn wrong(&self, name: &str, key: &Key, value: &Spanned<DeValue<'_>>, wrong: Wrong) -> Failure {
        let written = match value.get_ref() {
            DeValue::Float(_) | DeValue::Integer(_) => number(value.get_ref()).map(short),
            _ => None,
        };
        let source = self.text.get(value.span()).unwrap_or_default();
        let written = written.unwrap_or_else(|| source.chars().take(SHOWN).collect());
        let what = format!("{} = {written} must be {}", key.name, wrong.expected);
        let near = wrong.nearest.map(|w| format!("\"{w}\""));
        self.places.full(name, key.name, what, wrong.expected, near.as_deref())
    }
}

/// The name of a table without its places in lists.
fn plain(name: &str) -> String {
    let (mut out, mut inside) = (String::new(), false);
    for c in name.chars() {
        match c {
            '[' => inside = true,
            ']' => inside = false,
            c if !inside => out.push(c),
            _ => {}
        }
    }
    out
}

/// A number, whatever it looks like.
fn number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(x) => x.as_str().replace('_', "").parse().ok(),
        DeValue::Integer(_) => whole(value).map(|x| x as f64),
        _ => None,
    }
}

fn whole(value: &DeValue<'_>) -> Option<i64> {
    let i = value.as_integer()?;
    i64::from_str_radix(&i.as_str().replace('_', ""), i.radix()).ok()
}

fn each(list: Option<&DeArray<'_>>, of: impl Fn(&DeValue<'_>) -> bool) -> bool {
    list.is_some_and(|all| all.iter().all(|v| of(v.get_ref())))
}

fn numbers(value: &DeValue<'_>) -> Option<Vec<f64>> {
    value.as_array()?.iter().map(|v| number(v.get_ref())).collect()
}

/// Whether a value is what a key takes.
fn check(kind: &Kind, value: &DeValue<'_>) -> Result<(), Wrong> {
    let within = |r: &Range, v: &DeValue<'_>| number(v).is_some_and(|x| r.holds(x));
    let list = |n: usize, r: &Range| numbers(value).filter(|x| x.len() == n && x.iter().all(|x| r.holds(*x)));
    let any = Range { least: f64::NEG_INFINITY, most: f64::INFINITY, open: [false; 2] };
    let direction = || list(3, &any).is_some_and(|d| d.iter().any(|x| x.abs() > 1e-9));
    let words = kind.words();
    let good = match kind {
        Kind::Number(r, _) => within(r, value),
        Kind::Whole(a, b) | Kind::WholeOrTable(a, b) => whole(value).is_some_and(|x| (*a..=*b).contains(&x)),
        Kind::WholeOr(a, b, _) => {
            whole(value).is_some_and(|x| (*a..=*b).contains(&x))
                || value.as_str().is_some_and(|w| words.contains(&w))
        }
        Kind::Wholes(a, b) => each(value.as_array(), |v| whole(v).is_some_and(|x| (*a..=*b).contains(&x))),
        Kind::Flag => value.as_bool().is_some(),
        Kind::Sign => whole(value).is_some_and(|x| x.abs() == 1),
        Kind::NumberOr(r, ..) => within(r, value) || value.as_str().is_some_and(|w| words.contains(&w)),
        Kind::Numbers(n, r, _) => list(*n, r).is_some(),
        Kind::Direction => direction(),
        Kind::DirectionOr(_) => direction() || value.as_str().is_some_and(|w| words.contains(&w)),
        Kind::Between(r, _) => list(2, r).is_some_and(|d| d[0] < d[1]),
        Kind::Corners(_) => list(6, &any).is_some_and(|c| (0..3).all(|k| c[k] < c[k + 3])),
        Kind::Word(_) | Kind::Name(_) => value.as_str().is_some_and(|w| words.contains(&w)),
        Kind::Text | Kind::File => value.as_str().is_some_and(|t| !t.trim().is_empty()),
        Kind::Files => each(value.as_array(), |v| v.as_str().is_some_and(|t| !t.trim().is_empty())),
        Kind::Faces => faces(value),
        Kind::Others | Kind::Ids => !value.is_table() && faces(value),
        Kind::Builtin => value.is_table(),
        Kind::List => numbers(value).is_some_and(|x| x.iter().all(|x| x.is_finite())) || points(value),
    };
    if good {
        return Ok(());
    }
    let near = value.as_str().and_then(|w| nearest(w, words)).map(ToOwned::to_owned);
    Err(Wrong { expected: kind.expects(), nearest: near })
}

fn faces(value: &DeValue<'_>) -> bool {
    let id = |v: &DeValue<'_>| v.as_str().is_some_and(|t| !t.trim().is_empty());
    match value {
        DeValue::Table(t) => {
            t.len() == 1 && t.get("largest").and_then(|n| whole(n.get_ref())).is_some_and(|n| n > 0)
        }
        DeValue::Array(all) => all.iter().all(|v| id(v.get_ref())),
        other => id(other),
    }
}

fn points(value: &DeValue<'_>) -> bool {
    each(value.as_array(), |v| numbers(v).is_some_and(|p| p.len() == 3 && p.iter().all(|x| x.is_finite())))
}

/// A number as one writes it: hundreds of digits say less than their count.
fn short(x: f64) -> String {
    if x.abs() < 1e15 { x.to_string() } else { format!("{x:e}") }
}
