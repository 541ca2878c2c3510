//! The global section: delimiters, unit, scale, version.

use super::params::{Parsed, STANDARD, Separators, parse};
use osculate_geom::Diagnostic;

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

/// Parameters that the standard of 1981, the shortest, has.
const FEWEST: usize = 22;

/// Names of the versions that flag 23 counts.
const VERSIONS: [&str; 11] = [
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

/// Millimetres in a unit by its name.
fn by_name(name: &str) -> Option<f64> {
    Some(match name.to_ascii_uppercase().as_str() {
        "IN" | "INCH" | "INCHES" => 25.4,
        "MM" | "MILLIMETER" | "MILLIMETERS" | "MILLIMETRE" | "MILLIMETRES" => 1.0,
        "FT" | "FOOT" | "FEET" => 304.8,
        "MI" | "MILE" | "MILES" => 1_609_344.0,
        "M" | "METER" | "METERS" | "METRE" | "METRES" => 1000.0,
        "KM" | "KILOMETER" | "KILOMETERS" => 1e6,
        "MIL" | "MILS" => 0.0254,
        "UM" | "MICRON" | "MICRONS" => 1e-3,
        "CM" | "CENTIMETER" | "CENTIMETERS" => 10.0,
        "UIN" | "MICROINCH" | "MICROINCHES" => 2.54e-5,
        _ => return None,
    })
}

/// Millimetres in a unit by its flag, and the flag's name.
const fn by_flag(flag: i64) -> Option<(f64, &'static str)> {
    Some(match flag {
        1 => (25.4, "IN"),
        2 => (1.0, "MM"),
        4 => (304.8, "FT"),
        5 => (1_609_344.0, "MI"),
        6 => (1000.0, "M"),
        7 => (1e6, "KM"),
        8 => (0.0254, "MIL"),
        9 => (1e-3, "UM"),
        10 => (10.0, "CM"),
        11 => (2.54e-5, "UIN"),
        _ => return None,
    })
}

/// The delimiters that the first two parameters name, as `1H,` and `1H;`, or leave out: `,,`.
fn separators(text: &[u8]) -> Separators {
    let trimmed = |t: &[u8]| t.iter().position(|c| *c != b' ').unwrap_or(t.len());
    let named = |t: &[u8]| (t.len() > 2 && t[0] == b'1' && matches!(t[1], b'H' | b'h')).then(|| t[2]);
    // What can be part of a number or of a string's count is no delimiter.
    let usable = |c: &u8| {
        c.is_ascii_graphic() && !c.is_ascii_digit() && !matches!(c, b'+' | b'-' | b'.' | b'D' | b'E' | b'H')
    };
    let mut out = STANDARD;
    let mut rest = &text[trimmed(text)..];
    if let Some(c) = named(rest) {
        out.parameter = if usable(&c) { c } else { STANDARD.parameter };
        rest = &rest[3..];
        rest = &rest[trimmed(rest)..];
    }
    if rest.first() == Some(&out.parameter) {
        rest = &rest[1..];
        if let Some(c) = named(&rest[trimmed(rest)..]).filter(|c| usable(c) && *c != out.parameter) {
            out.record = c;
        }
    }
    out
}

/// The unit: by flag, by name where flag 3 says so or there is no flag.
fn unit(flag: Option<f64>, named: &str, diagnostics: &mut Vec<Diagnostic>) -> (f64, String) {
    let mut warn = |what: String| diagnostics.push(Diagnostic::warning("global section", what));
    let own = |default: &str| if named.is_empty() { default.to_owned() } else { named.to_owned() };
    match flag.map(|f| f as i64) {
        Some(3) | None if by_name(named).is_some() => (by_name(named).unwrap_or(1.0), named.to_owned()),
        Some(3) => {
            warn(format!("the unit {named:?} is none that has a length; millimetres are assumed"));
            (1.0, own("MM"))
        }
        None => {
            // The standard's default.
            (25.4, own("IN"))
        }
        Some(flag) => match by_flag(flag) {
            Some((mm, name)) => {
                if let Some(other) = by_name(named).filter(|o| (o - mm).abs() > 1e-9 * mm) {
                    warn(format!(
                        "the unit flag {flag} means {mm} mm and the unit's name {named:?} {other} mm; the flag \
                         counts"
                    ));
                    return (mm, name.to_owned());
                }
                (mm, own(name))
            }
            None => {
                warn(format!("the unit flag is {flag}; 1 to 11 have a meaning, inches are assumed"));
                (25.4, own("IN"))
            }
        },
    }
}

/// Reads the text of the global section.
pub(crate) fn global(text: &[u8], diagnostics: &mut Vec<Diagnostic>) -> (Separators, Global) {
    let separators = separators(text);
    let Parsed { params, lies, ended } = parse(text, separators);
    let mut warn = |what: String| diagnostics.push(Diagnostic::warning("global section", what));
    if lies > 0 {
        warn(format!(
            "{lies} strings of the global section have a wrong character count; they were ended at the next \
             delimiter"
        ));
    }
    if !ended || params.len() < FEWEST {
        warn(format!(
            "{} parameters{}; the standard has {FEWEST} at least; what is missing has its default",
            params.len(),
            if ended { "" } else { " and no record delimiter" }
        ));
    }
    let number = |k: usize| params.number(k - 1);
    let scale = match number(13) {
        Some(s) if s > 0.0 => s,
        Some(s) => {
            warn(format!("the model scale is {s}; 1 is used"));
            1.0
        }
        None => 1.0,
    };
    let named = params.text(14).unwrap_or("").trim();
    let (unit_mm, unit_name) = unit(number(14), named, diagnostics);
    let version = match number(23).map(|v| v as i64) {
        Some(v @ 1..=11) => format!("IGES {}", VERSIONS[v as usize - 1]),
        _ => "IGES".to_owned(),
    };
    (separators, Global { unit_mm, unit_name, scale, version })
}

#[cfg(test)]
mod tests {
    use super::*;

    const TAIL: &str = ",1,0.1,1Hd,1E-6,100.,1Hx,1Hx,11,0,";

    fn read(text: &str) -> (Separators, Global, usize) {
        let mut d = Vec::new();
        let (s, g) = global(text.as_bytes(), &mut d);
        (s, g, d.len())
    }

    #[test]
    fn delimiters_are_named_by_the_file() {
        let own = format!("1H/ ,1H$,4Hpart,1Hx,1Hs,1Hv,32,38,6,308,15,4Hpart,2.,6,1HM{TAIL}$");
        let (s, g, said) = read(&own.replace(',', "/"));
        assert_eq!((s.parameter, s.record, said), (b'/', b'$', 0));
        assert_eq!((g.scale, g.unit_mm, g.unit_name.as_str()), (2.0, 1000.0, "M"));
        let (s, g, said) = read(&format!(",,1Hx,1Hx,1Hs,1Hv,32,38,6,308,15,1Hp,1.,1,4HINCH{TAIL};"));
        assert_eq!((s, g.unit_mm, g.version.as_str(), said), (STANDARD, 25.4, "IGES 5.3", 0));
        // A digit is no delimiter.
        assert_eq!(read("1H1,1H2,4Hpart;").0, STANDARD);
    }

    #[test]
    fn flag_name_and_default_of_the_unit() {
        let unit = |text: &str| {
            let (_, g, said) = read(&format!(",,1Hx,1Hx,1Hs,1Hv,32,38,6,308,15,1Hp,1.,{text}{TAIL};"));
            (g.unit_mm, g.unit_name, said)
        };
        assert_eq!(unit("3,2HCM"), (10.0, "CM".into(), 0));
        assert_eq!(unit("3,6HFURLON"), (1.0, "FURLON".into(), 1));
        assert_eq!(unit(",2HFT"), (304.8, "FT".into(), 0));
        assert_eq!(unit(","), (25.4, "IN".into(), 0));
        assert_eq!(unit("9,"), (1e-3, "UM".into(), 0));
        // Flag and name disagree.
        assert_eq!(unit("1,2HMM"), (25.4, "IN".into(), 1));
        assert_eq!(unit("17,2HMM"), (25.4, "MM".into(), 1));
        // A global section that breaks off.
        assert_eq!(read(",,1Hx,1Hx,").2, 1);
    }
}
