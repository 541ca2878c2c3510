//! Fields of a statement as numbers, directions and words.

use osculate_geom::{Unit3, Vec3};

use super::error::ClReadError;
use super::statement::Statement;

pub(super) fn place(line: usize) -> String {
    format!("line {line}")
}

/// A coordinate system statement that leaves everything where it is.
pub(super) fn is_identity(s: &Statement) -> bool {
    const IDENTITY: [f64; 12] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    matches!(s.word.as_str(), "CSYS" | "MATRIX")
        && (s.fields == ["NOMORE"] || numbers(s, &s.fields).is_ok_and(|n| n == IDENTITY))
}

pub(super) fn is_word(field: &str) -> bool {
    field.starts_with(|c: char| c.is_ascii_alphabetic()) && field != "NAN" && field != "INF"
}

pub(super) fn numbers(s: &Statement, fields: &[String]) -> Result<Vec<f64>, ClReadError> {
    let number = |f: &String| {
        let bad = || ClReadError::Number { line: s.line, word: s.word.clone(), field: f.clone() };
        // FORTRAN writes exponents with D.
        let value: f64 = f.replace('D', "E").parse().map_err(|_| bad())?;
        if value.is_finite() { Ok(value) } else { Err(bad()) }
    };
    fields.iter().map(number).collect()
}

pub(super) fn count(s: &Statement, got: usize, need: &'static str) -> ClReadError {
    ClReadError::Count { line: s.line, word: s.word.clone(), got, need }
}

pub(super) fn vector(s: &Statement, n: &[f64]) -> Result<Vec3, ClReadError> {
    let [x, y, z] = *n else { return Err(count(s, n.len(), "3 for a direction")) };
    Ok(Vec3::new(x, y, z))
}

pub(super) fn axis(s: &Statement, n: &[f64]) -> Result<Unit3, ClReadError> {
    unit(s.line, vector(s, n)?)
}

pub(super) fn unit(line: usize, v: Vec3) -> Result<Unit3, ClReadError> {
    // A direction given with any sensible digits is far longer than this.
    Unit3::try_new(v, 1e-6).ok_or(ClReadError::ZeroAxis { line, length: v.norm() })
}
