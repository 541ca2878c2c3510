//! The compressed ASCII form: directory and parameter data of an entity stand together.
//!
//! A flag section, letter C in column 73, comes first; sections S, G and T are as in the fixed form. Between G and T
//! each entity begins with a line `D`, its directory number, and the fields of its directory entry as `@field_value`.
//! Fields that are left out are those of the entity before. The parameter data follow, up to the record delimiter.
//! Fields are counted from 1 to 20 over the two cards of the fixed form: 1 kind, 7 transform, 9 status, 13 colour,
//! 15 form, 18 label, 19 subscript. Source: [IGES 5.3, 2.3].

use super::columns::{Line, integer};
use super::directory::{Directory, Entity, Faults, Status};
use super::params::{Parsed, Separators, parse};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

/// The fields of the entity before.
#[derive(Clone, Default)]
struct Fields {
    kind: i64,
    transform: i64,
    status: i64,
    color: i64,
    level: i64,
    form: i64,
    label: String,
}

/// Whether a line begins an entity.
fn begins(card: &[u8]) -> bool {
    card.first() == Some(&b'D') && card.get(1).is_some_and(|c| c.is_ascii_digit() || matches!(c, b'@' | b' '))
}

/// Takes the fields of a line; gives what follows them.
fn header<'l>(mut line: &'l [u8], separators: Separators, fields: &mut Fields) -> Option<&'l [u8]> {
    while let Some(rest) = line.strip_prefix(b"@") {
        let digits = rest.iter().take_while(|c| c.is_ascii_digit()).count();
        let number = integer(&rest[..digits])?;
        let value = rest[digits..].strip_prefix(b"_")?;
        let end = value.iter().position(|c| *c == b'@' || *c == separators.record).unwrap_or(value.len());
        let text = value[..end].trim_ascii();
        match number {
            1 => fields.kind = integer(text)?,
            5 => fields.level = integer(text)?,
            7 => fields.transform = integer(text)?,
            9 => fields.status = integer(text)?,
            13 => fields.color = integer(text)?,
            15 => fields.form = integer(text)?,
            18 => fields.label = String::from_utf8_lossy(text).into_owned(),
            _ => {}
        }
        line = value[end..].strip_prefix(&[separators.record]).unwrap_or(&value[end..]).trim_ascii_start();
    }
    Some(line)
}

/// Entities of the compressed form.
pub(crate) fn read(data: &[Line<'_>], separators: Separators) -> Directory {
    let mut faults = Faults::default();
    let mut entities = BTreeMap::new();
    let mut fields = Fields::default();
    let mut place = 0_i64;
    let mut k = 0;
    while k < data.len() {
        let (line, first) = (data[k].0, &data[k].1);
        let end = (k + 1..data.len()).find(|j| begins(&data[*j].1)).unwrap_or(data.len());
        if !begins(first) {
            faults.broken.add(|| format!("line {line}"));
            k = end;
            continue;
        }
        let body = first[1..].trim_ascii();
        let digits = body.iter().take_while(|c| c.is_ascii_digit()).count();
        place += 2;
        let number = integer(&body[..digits]).filter(|n| *n > 0).unwrap_or(place - 1);
        let mut text = Vec::new();
        let mut sound = true;
        for (j, card) in data[k..end].iter().enumerate() {
            let card = if j == 0 { body[digits..].trim_ascii_start() } else { &card.1 };
            if text.is_empty() {
                match header(card, separators, &mut fields) {
                    Some(rest) => text.extend_from_slice(rest),
                    None => sound = false,
                }
            } else {
                text.extend_from_slice(card);
            }
        }
        k = end;
        if !sound {
            faults.broken.add(|| format!("line {line}"));
            continue;
        }
        let named = || format!("{} at DE {number}, line {line}", fields.kind);
        let Parsed { params, ended, lies } = parse(&text, separators);
        if params.number(0) != Some(fields.kind as f64) {
            faults.mismatched.add(named);
            continue;
        }
        if lies > 0 {
            faults.lying.add(named);
        }
        if !ended {
            faults.cut.add(named);
        }
        let entity = Entity {
            kind: u32::try_from(fields.kind).unwrap_or(0),
            form: i32::try_from(fields.form).unwrap_or(0),
            transform: fields.transform,
            color: fields.color,
            level: fields.level,
            label: fields.label.clone(),
            status: Status::new(fields.status),
            line,
            params: params.behind_first(),
        };
        match entities.entry(number) {
            Entry::Occupied(_) => faults.doubled.add(named),
            Entry::Vacant(slot) => {
                slot.insert(entity);
            }
        }
    }
    let mut findings = Vec::new();
    faults.findings(&mut findings);
    Directory { entities, findings }
}

#[cfg(test)]
mod tests {
    use super::super::params::STANDARD;
    use super::*;
    use std::borrow::Cow;

    #[test]
    fn fields_are_those_of_the_entity_before() {
        let text = [
            "D1@1_110@3_0@7_5@9_00010000@13_-7@15_0@18_EDGE",
            "110,0.,0.,0.,",
            "1.,2.,3.;",
            "D3 @18_NEXT;110,4.,5.,6.,7.,8.,9.;",
            "D5@1_116",
            "@7_0",
            "116,1.,2.,3.;",
            "D7@1_100",
            "110,1.;",
        ];
        let lines: Vec<Line<'_>> =
            text.iter().enumerate().map(|(k, l)| (k as u32 + 4, Cow::Borrowed(l.as_bytes()))).collect();
        let Directory { entities, findings } = read(&lines, STANDARD);
        let e = &entities[&1];
        assert_eq!((e.kind, e.transform, e.color, e.label.as_str(), e.line), (110, 5, -7, "EDGE", 4));
        assert_eq!((e.params.len(), e.params.number(5), e.status.subordinate), (6, Some(3.0), 1));
        let e = &entities[&3];
        assert_eq!((e.kind, e.transform, e.label.as_str()), (110, 5, "NEXT"));
        assert_eq!(
            (entities[&5].kind, entities[&5].transform, entities[&5].label.as_str()),
            (116, 0, "NEXT")
        );
        // The kind of the last is not that of its data.
        assert!(!entities.contains_key(&7) && findings.len() == 1);
    }
}
