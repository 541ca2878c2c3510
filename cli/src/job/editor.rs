//! The schema of job files as editors know it: JSON Schema, made of the list of keys that the checks go by.

use crate::job::schema::{Key, Kind, Range, Schema};
use serde_json::{Map, Value, json};

/// The JSON schema of files of any of these kinds.
#[must_use]
pub fn schema(kinds: &[&Schema]) -> Value {
    let each: Vec<Value> = kinds.iter().map(|kind| table(kind, "", "")).collect();
    json!({
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "A job of osculate",
        "oneOf": each,
    })
}

/// A table with the tables in it. `name` is its full name.
fn table(schema: &Schema, name: &str, meaning: &str) -> Value {
    let mut properties = Map::new();
    let mut required: Vec<Value> = Vec::new();
    for key in schema.keys(name) {
        properties.insert(key.name.to_owned(), described(key));
        if key.default.is_none() {
            required.push(key.name.into());
        }
    }
    for inner in schema.tables_in(name) {
        let full = if name.is_empty() { inner.to_owned() } else { format!("{name}.{inner}") };
        let about = schema.meaning(&full).unwrap_or_default();
        let one = table(schema, &full, about);
        let own = if name.is_empty() && schema.is_list(inner) {
            json!({ "type": "array", "items": one })
        } else if crate::job::schema::ONE_OR_MORE.contains(&full.as_str()) {
            json!({ "anyOf": [one, { "type": "array", "items": one }] })
        } else {
            one
        };
        // A key that may be a table as well.
        let own = match properties.remove(inner) {
            Some(plain) => json!({ "anyOf": [plain, own] }),
            None => own,
        };
        properties.insert(inner.to_owned(), own);
        if schema.needs(&full) {
            required.push(inner.into());
        }
    }
    let mut out = json!({ "type": "object", "additionalProperties": false, "properties": properties, "required": required });
    if !meaning.is_empty() {
        out["description"] = meaning.into();
    }
    out
}

/// A key with what it means.
fn described(key: &Key) -> Value {
    let mut out = kind(&key.kind);
    out["description"] = format!("{}: {}", key.meaning, key.kind.expects()).into();
    if let Some(default) = key.default.filter(|d| !d.is_empty()) {
        out["description"] = format!("{}: {} (left out: {default})", key.meaning, key.kind.expects()).into();
    }
    out
}

fn number(r: &Range) -> Value {
    let mut out = json!({ "type": "number" });
    let ends = [(r.least, ["minimum", "exclusiveMinimum"], 0), (r.most, ["maximum", "exclusiveMaximum"], 1)];
    for (end, names, k) in ends.into_iter().filter(|e| e.0.is_finite()) {
        out[names[usize::from(r.open[k])]] = end.into();
    }
    out
}

fn words(all: &[&str]) -> Value {
    json!({ "enum": all })
}

fn list(of: Value, count: Option<usize>) -> Value {
    match count {
        Some(n) => json!({ "type": "array", "items": of, "minItems": n, "maxItems": n }),
        None => json!({ "type": "array", "items": of }),
    }
}

fn kind(kind: &Kind) -> Value {
    let any = json!({ "type": "number" });
    let whole = |a: i64, b: i64| json!({ "type": "integer", "minimum": a, "maximum": b });
    let text = || json!({ "type": "string", "minLength": 1 });
    match kind {
        Kind::Number(r, _) => number(r),
        Kind::Whole(a, b) | Kind::WholeOrTable(a, b) => whole(*a, *b),
        Kind::Wholes(a, b) => list(whole(*a, *b), None),
        Kind::Sign => json!({ "enum": [1, -1] }),
        Kind::Flag => json!({ "type": "boolean" }),
        Kind::NumberOr(r, _, w) => json!({ "anyOf": [number(r), words(w)] }),
        Kind::WholeOr(a, b, w) => json!({ "anyOf": [whole(*a, *b), words(w)] }),
        Kind::Numbers(n, r, _) => list(number(r), Some(*n)),
        Kind::Direction => list(any, Some(3)),
        Kind::DirectionOr(w) => json!({ "anyOf": [list(any, Some(3)), words(w)] }),
        Kind::Between(r, _) => list(number(r), Some(2)),
        Kind::Corners(_) => list(any, Some(6)),
        Kind::Word(w) => words(w),
        Kind::Name(names) => words(&names()),
        Kind::Text | Kind::File => text(),
        Kind::Files => list(text(), None),
        Kind::Faces => json!({ "anyOf": [text(), list(text(), None), {
            "type": "object", "additionalProperties": false, "required": ["largest"],
            "properties": { "largest": { "type": "integer", "minimum": 1 } }
        }] }),
        Kind::Others | Kind::Ids => json!({ "anyOf": [text(), list(text(), None)] }),
        Kind::Builtin => json!({ "type": "object" }),
        Kind::List => json!({ "type": "array" }),
    }
}
