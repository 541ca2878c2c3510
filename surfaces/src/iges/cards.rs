//! The fixed ASCII form of IGES 5.3: 80-column cards in the sections S, G, D, P and T.
//!
//! Column 73 holds the section letter, columns 74 to 80 the number within the section. Directory entries are two
//! cards of ten 8-column fields; parameter data are free text in columns 1 to 64, with the delimiters that the global
//! section names.

use osculate_geom::Diagnostic;
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, HashMap};

/// A parameter.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Param {
    /// Left out.
    Default,
    /// A number; integers are exact.
    Number(f64),
    /// A Hollerith string.
    Text(String),
    /// Anything else.
    Other(String),
}

impl Param {
    pub(crate) const fn number(&self) -> Option<f64> {
        match self {
            Self::Number(x) => Some(*x),
            _ => None,
        }
    }
}

/// A directory entry with its parameters.
#[derive(Clone, Debug)]
pub(crate) struct Entity {
    pub(crate) kind: u32,
    pub(crate) form: i32,
    /// Directory number of its transformation, 0 for none.
    pub(crate) transform: i64,
    pub(crate) label: String,
    /// Parameters behind the entity number.
    pub(crate) params: Vec<Param>,
}

/// What the global section says.
#[derive(Clone, Debug)]
pub(crate) struct Global {
    /// Millimetres in one unit of model space.
    pub(crate) unit_mm: f64,
    pub(crate) unit_name: String,
    /// Ratio of model space to real space.
    pub(crate) scale: f64,
    pub(crate) version: String,
}

/// A file's cards, taken apart.
#[derive(Debug)]
pub(crate) struct Cards {
    pub(crate) global: Global,
    /// Entities by directory number.
    pub(crate) entities: BTreeMap<i64, Entity>,
    pub(crate) diagnostics: Vec<Diagnostic>,
    /// Whether the terminate section is missing.
    pub(crate) truncated: bool,
}

/// Why the cards make no model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CardFault {
    NoDirectory,
    NoParameters,
}

/// The cards of a text: lines, or 80-byte records where there are no line ends.
pub(crate) fn cards(bytes: &[u8]) -> Vec<&[u8]> {
    if !bytes.contains(&b'\n') && !bytes.contains(&b'\r') {
        return bytes.chunks(80).collect();
    }
    bytes.split(|c| *c == b'\n').flat_map(|l| l.split(|c| *c == b'\r')).filter(|l| !l.is_empty()).collect()
}

/// Section letter of a card, where it is one.
pub(crate) fn section(card: &[u8]) -> Option<u8> {
    let letter = *card.get(72)?;
    let numbered = card.get(73..card.len().min(80))?;
    let is_number =
        numbered.iter().all(|c| c.is_ascii_digit() || *c == b' ') && numbered.iter().any(u8::is_ascii_digit);
    (is_number && b"SGDPT".contains(&letter)).then_some(letter)
}

/// Columns `from..to` (from zero) as text, blank beyond the end.
fn columns(card: &[u8], from: usize, to: usize) -> String {
    let mut out = vec![b' '; to - from];
    for (k, slot) in out.iter_mut().enumerate() {
        if let Some(c) = card.get(from + k) {
            *slot = *c;
        }
    }
    String::from_utf8_lossy(&out).into_owned()
}

fn integer(text: &str) -> Option<i64> {
    let t = text.trim();
    if t.is_empty() { Some(0) } else { t.parse().ok() }
}

impl Cards {
    /// Takes a file apart.
    pub(crate) fn read(bytes: &[u8]) -> Result<Self, CardFault> {
        let mut diagnostics = Vec::new();
        let mut global_text = Vec::new();
        let mut directory: Vec<&[u8]> = Vec::new();
        let mut parameters: Vec<&[u8]> = Vec::new();
        let (mut strays, mut terminated) = (0_usize, false);
        for card in cards(bytes) {
            match section(card) {
                Some(b'G') => global_text.extend_from_slice(&raw(card, 72)),
                Some(b'D') => directory.push(card),
                Some(b'P') => parameters.push(card),
                Some(b'T') => terminated = true,
                Some(_) => {}
                None if card.iter().all(u8::is_ascii_whitespace) => {}
                None => strays += 1,
            }
        }
        if strays > 0 {
            diagnostics.push(Diagnostic::warning(
                "",
                format!("{strays} lines have no section letter in column 73 and were passed over"),
            ));
        }
        if directory.is_empty() {
            return Err(CardFault::NoDirectory);
        }
        if parameters.is_empty() {
            return Err(CardFault::NoParameters);
        }
        if !terminated {
            diagnostics.push(Diagnostic::loss(
                "",
                "the file has no terminate section: it is truncated; entities whose data are complete were read",
            ));
        }
        let (separators, global) = global(&global_text, &mut diagnostics);
        let entities = entities(&directory, &parameters, separators, &mut diagnostics);
        Ok(Self { global, entities, diagnostics, truncated: !terminated })
    }
}

fn raw(card: &[u8], width: usize) -> Vec<u8> {
    let mut out = vec![b' '; width];
    let n = card.len().min(width);
    out[..n].copy_from_slice(&card[..n]);
    out
}

/// Parameter and record delimiter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Separators {
    parameter: u8,
    record: u8,
}

/// Parameters of a record.
#[derive(Debug, PartialEq)]
struct Parsed {
    params: Vec<Param>,
    /// Whether the record delimiter came.
    ended: bool,
    /// Strings whose count does not lead to a delimiter.
    lies: usize,
}

/// Parameters up to the record delimiter.
fn parse(text: &[u8], separators: Separators) -> Parsed {
    let mut out = Vec::new();
    let mut at = 0;
    let mut lies = 0;
    loop {
        while text.get(at) == Some(&b' ') {
            at += 1;
        }
        let start = at;
        while text.get(at).is_some_and(u8::is_ascii_digit) {
            at += 1;
        }
        let digits = &text[start..at];
        let param = if !digits.is_empty() && matches!(text.get(at), Some(b'H' | b'h')) {
            let count: usize =
                std::str::from_utf8(digits).ok().and_then(|d| d.parse().ok()).unwrap_or(usize::MAX);
            let from = at + 1;
            let mut to = from.saturating_add(count).min(text.len());
            let next = text[to..].iter().copied().find(|c| *c != b' ');
            if next.is_none_or(|c| c != separators.parameter && c != separators.record) {
                // The count lies: what follows is no delimiter. The string then ends at the first one.
                lies += 1;
                let end =
                    text[from..].iter().position(|c| *c == separators.parameter || *c == separators.record);
                to = end.map_or(text.len(), |n| from + n);
            }
            at = to;
            Param::Text(String::from_utf8_lossy(&text[from..to]).into_owned())
        } else {
            at = start;
            while text.get(at).is_some_and(|c| *c != separators.parameter && *c != separators.record) {
                at += 1;
            }
            plain(&text[start..at])
        };
        out.push(param);
        // Blanks between a value and its delimiter.
        while text.get(at).is_some_and(|c| *c != separators.parameter && *c != separators.record) {
            at += 1;
        }
        match text.get(at) {
            Some(c) if *c == separators.record => return Parsed { params: out, ended: true, lies },
            Some(_) => at += 1,
            None => return Parsed { params: out, ended: false, lies },
        }
    }
}

/// A value that is no string.
fn plain(text: &[u8]) -> Param {
    let cleaned: String = text
        .iter()
        .filter(|c| !c.is_ascii_whitespace())
        .map(|c| if matches!(c, b'd' | b'D') { 'e' } else { char::from(*c) })
        .collect();
    if cleaned.is_empty() {
        return Param::Default;
    }
    match cleaned.parse::<f64>() {
        // Rust also reads words such as `inf`; a number begins with a digit, a sign or a point.
        Ok(x) if x.is_finite() && !cleaned.starts_with(|c: char| c.is_ascii_alphabetic()) => Param::Number(x),
        _ => Param::Other(String::from_utf8_lossy(text).trim().to_owned()),
    }
}

fn global(text: &[u8], diagnostics: &mut Vec<Diagnostic>) -> (Separators, Global) {
    // The first two parameters name the delimiters, as `1H,` and `1H;`, or are left out: `,,`.
    let skip = |t: &'_ [u8]| t.iter().position(|c| *c != b' ').unwrap_or(t.len());
    let named =
        |t: &[u8]| if t.len() > 2 && t[0] == b'1' && matches!(t[1], b'H' | b'h') { Some(t[2]) } else { None };
    let mut separators = Separators { parameter: b',', record: b';' };
    let mut rest = &text[skip(text)..];
    if let Some(c) = named(rest) {
        separators.parameter = c;
        rest = &rest[3..];
        rest = &rest[skip(rest)..];
    }
    if rest.first() == Some(&separators.parameter) {
        rest = &rest[1..];
        if let Some(c) = named(&rest[skip(rest)..]) {
            separators.record = c;
        }
    }
    let Parsed { params, lies, .. } = parse(text, separators);
    if lies > 0 {
        diagnostics.push(Diagnostic::warning(
            "",
            format!("{lies} strings of the global section have a wrong character count; they were ended at the next delimiter"),
        ));
    }
    let number = |k: usize| params.get(k - 1).and_then(Param::number);
    let text_of = |k: usize| match params.get(k - 1) {
        Some(Param::Text(t) | Param::Other(t)) => t.trim().to_owned(),
        _ => String::new(),
    };
    let scale = match number(13) {
        Some(s) if s > 0.0 => s,
        Some(s) => {
            diagnostics.push(Diagnostic::warning("", format!("the global model scale is {s}; 1 is used")));
            1.0
        }
        None => 1.0,
    };
    let named = text_of(15);
    let flag = number(14).unwrap_or(1.0);
    let by_name = |name: &str| match name.to_ascii_uppercase().as_str() {
        "IN" | "INCH" | "INCHES" => Some(25.4),
        "MM" | "MILLIMETER" | "MILLIMETERS" => Some(1.0),
        "FT" | "FOOT" | "FEET" => Some(304.8),
        "MI" | "MILE" | "MILES" => Some(1_609_344.0),
        "M" | "METER" | "METERS" => Some(1000.0),
        "KM" => Some(1e6),
        "MIL" => Some(0.0254),
        "UM" | "MICRON" | "MICRONS" => Some(1e-3),
        "CM" => Some(10.0),
        "UIN" => Some(2.54e-5),
        _ => None,
    };
    let (unit_mm, default_name) = match flag as i64 {
        1 => (25.4, "IN"),
        2 => (1.0, "MM"),
        3 => {
            match by_name(&named) {
                Some(mm) => (mm, ""),
                None => {
                    diagnostics.push(Diagnostic::warning(
                    "",
                    format!("the global section names the unit {named:?}, which is none; millimetres are assumed"),
                ));
                    (1.0, "MM")
                }
            }
        }
        4 => (304.8, "FT"),
        5 => (1_609_344.0, "MI"),
        6 => (1000.0, "M"),
        7 => (1e6, "KM"),
        8 => (0.0254, "MIL"),
        9 => (1e-3, "UM"),
        10 => (10.0, "CM"),
        11 => (2.54e-5, "UIN"),
        other => {
            diagnostics.push(Diagnostic::warning(
                "",
                format!("the global unit flag is {other}; 1 to 11 have a meaning, inches are assumed"),
            ));
            (25.4, "IN")
        }
    };
    let unit_name = if named.is_empty() { default_name.to_owned() } else { named };
    let version = match number(23).map(|v| v as i64) {
        Some(v @ 1..=11) => {
            const NAMES: [&str; 11] = [
                "1.0",
                "ANSI Y14.26M-1981",
                "2.0",
                "3.0",
                "ANSI Y14.26M-1987",
                "4.0",
                "ASME Y14.26M-1989",
                "5.0",
                "5.1",
                "5.2",
                "5.3",
            ];
            format!("IGES {}", NAMES[v as usize - 1])
        }
        _ => "IGES".to_owned(),
    };
    (separators, Global { unit_mm, unit_name, scale, version })
}

fn entities(
    directory: &[&[u8]],
    parameters: &[&[u8]],
    separators: Separators,
    diagnostics: &mut Vec<Diagnostic>,
) -> BTreeMap<i64, Entity> {
    let number_of = |card: &[u8]| columns(card, 73, 80).trim().parse::<i64>().ok();
    let by_number: HashMap<i64, usize> =
        parameters.iter().enumerate().filter_map(|(k, c)| number_of(c).map(|n| (n, k))).collect();
    let mut out = BTreeMap::new();
    let (mut broken, mut cut, mut doubled, mut lying) = (0_usize, 0_usize, 0_usize, 0_usize);
    for pair in directory.chunks(2) {
        let [first, second] = pair else {
            broken += 1;
            continue;
        };
        let field = |card: &[u8], k: usize| integer(&columns(card, 8 * k, 8 * k + 8));
        let (Some(kind), Some(start), Some(number)) = (field(first, 0), field(first, 1), number_of(first))
        else {
            broken += 1;
            continue;
        };
        let count = field(second, 3).unwrap_or(1).max(1);
        let Some(from) = by_number.get(&start).copied() else {
            broken += 1;
            continue;
        };
        // The data go on as long as the cards point back here, whatever the count says.
        let mut text = Vec::new();
        for (k, card) in parameters[from..].iter().enumerate() {
            let back = columns(card, 64, 72).trim().parse::<i64>().ok();
            if k as i64 >= count && back != Some(number) {
                break;
            }
            text.extend_from_slice(&raw(card, 64));
        }
        let Parsed { mut params, ended, lies } = parse(&text, separators);
        lying += lies;
        if !ended {
            cut += 1;
        }
        if params.first().and_then(Param::number) != Some(kind as f64) {
            broken += 1;
            continue;
        }
        params.remove(0);
        let entity = Entity {
            kind: u32::try_from(kind).unwrap_or(0),
            form: field(second, 4).unwrap_or(0) as i32,
            transform: field(first, 6).unwrap_or(0),
            label: columns(second, 56, 64).trim().to_owned(),
            params,
        };
        match out.entry(number) {
            Entry::Occupied(_) => doubled += 1,
            Entry::Vacant(slot) => {
                slot.insert(entity);
            }
        }
    }
    for (count, what) in [
        (broken, "directory entries do not fit their parameter data and were passed over"),
        (cut, "entities have parameter data without a record delimiter"),
        (lying, "strings have a wrong character count and were ended at the next delimiter"),
        (doubled, "directory numbers occur twice; the first is used"),
    ] {
        if count > 0 {
            diagnostics.push(Diagnostic::loss("", format!("{count} {what}")));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    const COMMA: Separators = Separators { parameter: b',', record: b';' };

    #[test]
    fn parameters_of_all_forms() {
        let p = parse(b"110, 1., -2.5D0,,7Ha,b;c d , 3 ; rest", COMMA);
        assert!(p.ended && p.lies == 0);
        assert_eq!(
            p.params,
            [
                Param::Number(110.0),
                Param::Number(1.0),
                Param::Number(-2.5),
                Param::Default,
                Param::Text("a,b;c d".into()),
                Param::Number(3.0)
            ]
        );
        let p = parse(b"110,99999999999Hab", COMMA);
        assert_eq!((p.params.len(), p.ended, p.lies), (2, false, 1));
        // A count that runs into the next value.
        let p = parse(b"38Hpart.igs,      4Hname,2;", COMMA);
        assert_eq!(p.params[1..], [Param::Text("name".into()), Param::Number(2.0)]);
        assert_eq!((p.ended, p.lies), (true, 1));
    }

    #[test]
    fn delimiters_are_named_by_the_file() {
        let mut d = Vec::new();
        let (s, g) = global(b"1H/ /1H$/4Hpart/1Hx/1Hs/1Hv/32/38/6/308/15/4Hpart/2./6/1HM/1/0.1$", &mut d);
        assert_eq!((s.parameter, s.record), (b'/', b'$'));
        assert_eq!((g.scale, g.unit_mm, g.unit_name.as_str()), (2.0, 1000.0, "M"));
        let (s, g) = global(b",,1Hx,1Hx,1Hs,1Hv,32,38,6,308,15,1Hp,1.,1,4HINCH;", &mut d);
        assert_eq!((s.parameter, s.record, g.unit_mm), (b',', b';', 25.4));
        assert!(d.is_empty());
    }

    #[test]
    fn a_card_needs_its_letter_and_number() {
        assert_eq!(section(format!("{:72}D{:>7}", "", 12).as_bytes()), Some(b'D'));
        assert_eq!(section(format!("{:72}Dx", "").as_bytes()), None);
        assert_eq!(section(b"short"), None);
    }
}
