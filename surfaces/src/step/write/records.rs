//! The records of a Part 21 file being written: numbers, texts, points.

use super::options::{StepOptions, StepWriteError};
use osculate_geom::analytic::Placement;
use osculate_geom::{Point3, Vec3};
use std::fmt::Write as _;
use std::io::Write;

/// A file of records, numbered from 1, as they come.
pub(super) struct Records<'a> {
    out: &'a mut dyn Write,
    last: usize,
    /// The first failure: nothing is written after it.
    failed: Option<std::io::Error>,
}

impl<'a> Records<'a> {
    /// Begins the file.
    pub(super) fn new(out: &'a mut dyn Write, options: &StepOptions) -> Self {
        let mut made = Self { out, last: 0, failed: None };
        made.put(format_args!(
            "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\n\
             FILE_NAME({},{},(''),(''),'osculate','osculate','');\n\
             FILE_SCHEMA(('AUTOMOTIVE_DESIGN {{ 1 0 10303 214 1 1 1 1 }}'));\nENDSEC;\nDATA;\n",
            text(&options.name),
            text(&options.timestamp),
        ));
        made
    }

    fn put(&mut self, words: std::fmt::Arguments<'_>) {
        if self.failed.is_none() {
            self.failed = self.out.write_fmt(words).err();
        }
    }

    /// Adds a record; its number.
    pub(super) fn add(&mut self, record: String) -> usize {
        self.last += 1;
        let number = self.last;
        self.put(format_args!("#{number}={record};\n"));
        number
    }

    pub(super) fn point(&mut self, p: &Point3) -> usize {
        self.add(format!("CARTESIAN_POINT('',({},{},{}))", real(p.x), real(p.y), real(p.z)))
    }

    pub(super) fn direction(&mut self, d: &Vec3) -> usize {
        self.add(format!("DIRECTION('',({},{},{}))", real(d.x), real(d.y), real(d.z)))
    }

    pub(super) fn placement(&mut self, f: &Placement) -> usize {
        let origin = self.point(&f.origin);
        let z = self.direction(&f.z);
        let x = self.direction(&f.x);
        self.add(format!("AXIS2_PLACEMENT_3D('',#{origin},#{z},#{x})"))
    }

    /// Ends the file.
    pub(super) fn end(mut self) -> Result<(), StepWriteError> {
        self.put(format_args!("ENDSEC;\nEND-ISO-10303-21;\n"));
        match self.failed {
            Some(e) => Err(StepWriteError::Output { why: e.to_string() }),
            None => Ok(()),
        }
    }
}

/// A real number that reads back as the same number: a mantissa with a point, and E before the exponent.
pub(super) fn real(x: f64) -> String {
    let mut s = format!("{x:?}");
    if let Some(e) = s.find('e') {
        let point = if s[..e].contains('.') { "" } else { "." };
        s = format!("{}{point}E{}", &s[..e], &s[e + 1..]);
    } else if let Some(short) = s.strip_suffix(".0") {
        s = format!("{short}.");
    }
    s
}

/// A text in quotes; what is not plain ASCII as `\X2\` and `\X4\` directives.
pub(super) fn text(s: &str) -> String {
    let mut out = String::from("'");
    for c in s.chars() {
        match c {
            '\'' => out.push_str("''"),
            '\\' => out.push_str("\\\\"),
            ' '..='~' => out.push(c),
            _ => {
                // Writing into a String cannot fail.
                let _ = if u32::from(c) < 0x1_0000 {
                    write!(out, "\\X2\\{:04X}\\X0\\", u32::from(c))
                } else {
                    write!(out, "\\X4\\{:08X}\\X0\\", u32::from(c))
                };
            }
        }
    }
    out.push('\'');
    out
}

/// Numbers in brackets.
pub(super) fn reals(values: &[f64]) -> String {
    let each: Vec<String> = values.iter().map(|x| real(*x)).collect();
    format!("({})", each.join(","))
}

/// Knots as multiplicities and values.
pub(super) fn knots(all: &[f64]) -> (String, String) {
    let mut values: Vec<f64> = Vec::new();
    let mut times: Vec<usize> = Vec::new();
    for t in all {
        match (values.last(), times.last_mut()) {
            (Some(v), Some(n)) if v == t => *n += 1,
            _ => {
                values.push(*t);
                times.push(1);
            }
        }
    }
    let times: Vec<String> = times.iter().map(usize::to_string).collect();
    (format!("({})", times.join(",")), reals(&values))
}

pub(super) const fn flag(value: bool) -> &'static str {
    if value { ".T." } else { ".F." }
}

/// References in brackets.
pub(super) fn list(ids: &[usize]) -> String {
    let each: Vec<String> = ids.iter().map(|k| format!("#{k}")).collect();
    format!("({})", each.join(","))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back_and_have_their_point() {
        for (x, want) in [(1.0, "1."), (-0.5, "-0.5"), (1e-7, "1.E-7"), (1.25e300, "1.25E300"), (0.0, "0.")] {
            assert_eq!(real(x), want);
            assert_eq!(want.parse::<f64>().unwrap(), x);
        }
        assert_eq!(real(0.1 + 0.2).parse::<f64>().unwrap(), 0.1 + 0.2);
    }

    #[test]
    fn texts_keep_to_ascii() {
        assert_eq!(text("it's a \\ Ü"), "'it''s a \\\\ \\X2\\00DC\\X0\\'");
        assert_eq!(knots(&[0.0, 0.0, 1.0, 2.0, 2.0]), ("(2,1,2)".into(), "(0.,1.,2.)".into()));
    }
}
