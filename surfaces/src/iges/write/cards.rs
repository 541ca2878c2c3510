//! Cards of 80 columns: directory entries, parameter data, and the global section that says units and accuracy.

use super::options::{IgesOptions, IgesWriteError};
use std::io::Write;

/// Status of an entity that stands by itself.
pub(super) const INDEPENDENT: &str = "00000000";
/// Status of an entity that is part of another one.
pub(super) const DEPENDENT: &str = "00010000";
/// Status of a curve in the parameters of a surface.
pub(super) const PARAMETRIC: &str = "00010500";

/// A parameter.
#[derive(Clone, Debug)]
pub(super) enum Value {
    Integer(usize),
    Real(f64),
    /// Another entity, by its number in [`Cards`].
    Pointer(usize),
}

struct Entity {
    kind: u32,
    form: u32,
    status: &'static str,
    values: Vec<Value>,
    label: String,
    /// A name property that belongs to it.
    name: Option<usize>,
    /// The text of a name property.
    text: String,
}

/// Entities so far.
pub(super) struct Cards {
    entities: Vec<Entity>,
}

/// Columns of parameter data on a card.
const WIDTH: usize = 64;

impl Cards {
    pub(super) const fn new() -> Self {
        Self { entities: Vec::new() }
    }

    /// Adds an entity; its number.
    pub(super) fn add(&mut self, kind: u32, form: u32, status: &'static str, values: Vec<Value>) -> usize {
        let (label, text) = (String::new(), String::new());
        self.entities.push(Entity { kind, form, status, values, label, name: None, text });
        self.entities.len() - 1
    }

    /// Names an entity by a property 406, form 15; names beyond ASCII cannot be written and are left out.
    pub(super) fn name(&mut self, entity: usize, name: &str) {
        if name.is_empty() || !name.bytes().all(|c| (32..127).contains(&c)) {
            return;
        }
        let property = self.add(406, 15, DEPENDENT, vec![Value::Integer(1)]);
        self.entities[property].text = hollerith(name);
        self.entities[entity].name = Some(property);
        self.entities[entity].label = name.chars().take(8).collect();
    }

    /// Writes the whole file.
    pub(super) fn file(
        &self,
        options: &IgesOptions,
        size_mm: f64,
        out: &mut dyn Write,
    ) -> Result<(), IgesWriteError> {
        let counts: Vec<usize> = (0..self.entities.len()).map(|k| self.lines(k).len()).collect();
        let (d, p) = (2 * self.entities.len(), counts.iter().sum::<usize>());
        let most = d.max(p);
        if most > 9_999_999 {
            return Err(IgesWriteError::TooLong { cards: most });
        }
        let written = self.sections(options, size_mm, &counts, out);
        written.map_err(|e| IgesWriteError::Output { why: e.to_string() })
    }

    /// The parameter data of an entity.
    fn lines(&self, number: usize) -> Vec<String> {
        let e = &self.entities[number];
        let mut words = vec![e.kind.to_string()];
        words.extend(e.values.iter().map(word));
        if !e.text.is_empty() {
            words.push(e.text.clone());
        }
        if let Some(property) = e.name {
            // No associativities, one property.
            words.extend(["0".to_owned(), "1".to_owned(), (2 * property + 1).to_string()]);
        }
        wrapped(&words, WIDTH)
    }

    /// The sections, with so many cards of parameter data for each entity.
    fn sections(
        &self,
        options: &IgesOptions,
        size_mm: f64,
        counts: &[usize],
        out: &mut dyn Write,
    ) -> std::io::Result<()> {
        let name = hollerith(&options.name);
        let date =
            hollerith(if options.timestamp.is_empty() { "00000101.000000" } else { &options.timestamp });
        let global = [
            "1H,".to_owned(),
            "1H;".to_owned(),
            name.clone(),
            name,
            hollerith("osculate"),
            hollerith("osculate"),
            "32".into(),
            "308".into(),
            "15".into(),
            "308".into(),
            "15".into(),
            String::new(),
            "1.".into(),
            "2".into(),
            "2HMM".into(),
            "1".into(),
            "1.".into(),
            date,
            real((1e-7 * size_mm).max(f64::MIN_POSITIVE)),
            real(size_mm),
            String::new(),
            String::new(),
            "11".into(),
            "0".into(),
        ];
        let global = wrapped(&global, 72);
        writeln!(out, "{:<72}S{:>7}", "", 1)?;
        for (k, line) in global.iter().enumerate() {
            writeln!(out, "{line:<72}G{:>7}", k + 1)?;
        }
        let mut first = 1;
        for (number, (e, count)) in self.entities.iter().zip(counts).enumerate() {
            let owner = 2 * number + 1;
            let Entity { kind, form, status, label, .. } = e;
            let o = 0;
            writeln!(out, "{kind:>8}{first:>8}{o:>8}{o:>8}{o:>8}{o:>8}{o:>8}{o:>8}{status:>8}D{owner:>7}")?;
            let next = owner + 1;
            writeln!(out, "{kind:>8}{o:>8}{o:>8}{count:>8}{form:>8}{:>16}{label:>8}{o:>8}D{next:>7}", "")?;
            first += count;
        }
        let mut sequence = 0;
        for number in 0..self.entities.len() {
            let owner = 2 * number + 1;
            for line in self.lines(number) {
                sequence += 1;
                writeln!(out, "{line:<64} {owner:>7}P{sequence:>7}")?;
            }
        }
        let (g, d) = (global.len(), 2 * self.entities.len());
        let counts = format!("S{:>7}G{g:>7}D{d:>7}P{sequence:>7}", 1);
        writeln!(out, "{counts:<72}T{:>7}", 1)
    }
}

/// Words with commas between and a semicolon behind, broken between words; a text that is longer than a line runs on.
fn wrapped(words: &[String], width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for (k, w) in words.iter().enumerate() {
        let ended = format!("{w}{}", if k + 1 == words.len() { ';' } else { ',' });
        let last = lines.len() - 1;
        if lines[last].len() + ended.len() <= width {
            lines[last].push_str(&ended);
            continue;
        }
        if ended.len() <= width {
            lines.push(ended);
            continue;
        }
        for c in ended.chars() {
            let last = lines.len() - 1;
            if lines[last].len() == width {
                lines.push(c.to_string());
            } else {
                lines[last].push(c);
            }
        }
    }
    lines
}

fn word(v: &Value) -> String {
    match v {
        Value::Integer(n) => n.to_string(),
        Value::Real(x) => real(*x),
        Value::Pointer(n) => (2 * n + 1).to_string(),
    }
}

/// A real number that reads back as the same number: with a point, and D before the exponent for double precision.
fn real(x: f64) -> String {
    let s = format!("{x:?}");
    match s.find('e') {
        Some(e) => {
            let point = if s[..e].contains('.') { "" } else { "." };
            format!("{}{point}D{}", &s[..e], &s[e + 1..])
        }
        None => s.strip_suffix(".0").map_or(s.clone(), |short| format!("{short}.")),
    }
}

/// A text with its length before it; what is not ASCII becomes a question mark, for lengths count bytes.
fn hollerith(s: &str) -> String {
    let plain: String = s.chars().map(|c| if (' '..='~').contains(&c) { c } else { '?' }).collect();
    format!("{}H{plain}", plain.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back() {
        for (x, want) in [(1.0, "1."), (-0.25, "-0.25"), (1e-9, "1.D-9"), (1.5e20, "1.5D20"), (0.0, "0.")] {
            assert_eq!(real(x), want);
            assert_eq!(want.replace('D', "E").parse::<f64>().unwrap(), x);
        }
    }

    #[test]
    fn lines_hold_their_width() {
        let long = hollerith(&"x".repeat(200));
        let lines = wrapped(&["1".into(), long.clone(), "2".into()], 64);
        assert!(lines.iter().all(|l| l.len() <= 64));
        assert_eq!(lines.concat(), format!("1,{long},2;"));
    }
}
