//! Layouts of point files: rows of numbers, and where one section ends and the next begins.
//!
//! Numbers are separated by commas, semicolons, tabs or blanks. A first line of words names the columns: `x`, `y`, `z`
//! of points, `x`, `r` (or `z`, `r`) of a contour to be turned about its first axis, `ss_x`, `ss_y`, `ss_z`, `ps_x`, ..
//! of several points a row, and an index of the section. Without names three columns are a point and four are an index
//! and a point. Sections end where the index changes, else at lines of words, comments, counts and blank lines, else
//! where a coordinate that is constant within each section changes.

use super::error::SectionsError;
use osculate_geom::Point3;
use std::collections::BTreeSet;

/// A section: where it begins in the file, and its points in the file's unit.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Section {
    pub(super) line: usize,
    pub(super) points: Vec<Point3>,
}

/// What a file holds.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Content {
    /// Faces by name, each over its sections.
    Sides(Vec<(String, Vec<Section>)>),
    /// A contour as points (x along the axis, y the radius), to be turned about the x axis.
    Contour(Section),
}

/// Rows and what stands between them.
pub(super) struct Layout {
    pub(super) content: Content,
    /// Millimetres in a unit where a comment names it, with the name.
    pub(super) unit: Option<(f64, &'static str)>,
}

struct Row {
    line: usize,
    numbers: Vec<f64>,
    /// Whether something stands between this row and the one before.
    apart: bool,
}

/// The columns of one point.
#[derive(Clone, Debug, PartialEq)]
struct Columns {
    name: String,
    at: [usize; 3],
}

/// A section shorter than this is none: its points make no curve of degree two.
pub(super) const FEWEST: usize = 3;

fn words(text: &str) -> Vec<&str> {
    let by = |c: char| c == ',' || c == ';' || c.is_whitespace();
    text.split(by).map(str::trim).filter(|w| !w.is_empty()).collect()
}

fn numbers(text: &str) -> Option<Vec<f64>> {
    let all: Vec<f64> =
        words(text).iter().map(|w| w.replace(['d', 'D'], "e").parse().ok()).collect::<Option<_>>()?;
    (!all.is_empty()).then_some(all)
}

/// Whether a text begins with rows of numbers of one width.
pub(super) fn looks_like(head: &str) -> bool {
    let (mut rows, mut others, mut width) = (0_usize, 0_usize, BTreeSet::new());
    for line in head.lines().take(60).filter(|l| !l.trim().is_empty()) {
        match numbers(line) {
            Some(n) if (2..=16).contains(&n.len()) && n.iter().all(|x| x.is_finite()) => {
                rows += 1;
                width.insert(n.len());
            }
            _ => others += 1,
        }
    }
    // The last line of a cut head may be short.
    rows >= FEWEST && rows > 3 * others && width.len() <= 2
}

/// The unit that a comment names behind the word `unit`.
fn unit_of(text: &str) -> Option<(f64, &'static str)> {
    let lower = text.to_ascii_lowercase();
    let at = lower.find("unit")?;
    let named = |w: &str| match w {
        "mm" | "millimetres" | "millimeters" => Some((1.0, "mm")),
        "cm" | "centimetres" | "centimeters" => Some((10.0, "cm")),
        "m" | "metres" | "meters" => Some((1000.0, "m")),
        "in" | "inch" | "inches" => Some((25.4, "in")),
        "ft" | "feet" => Some((304.8, "ft")),
        _ => None,
    };
    lower[at..].split(|c: char| !c.is_ascii_alphanumeric()).skip(1).find_map(named)
}

/// The points of a row and the index column, by the names of the columns.
fn named_columns(names: &[String]) -> Option<(Vec<Columns>, Option<usize>)> {
    let mut groups: Vec<Columns> = Vec::new();
    for (k, name) in names.iter().enumerate() {
        let Some(prefix) = name.strip_suffix('x') else { continue };
        let find = |axis: &str| names.iter().position(|n| *n == format!("{prefix}{axis}"));
        if let (Some(y), Some(z)) = (find("y"), find("z")) {
            groups.push(Columns { name: prefix.trim_end_matches(['_', '-', '.']).to_owned(), at: [k, y, z] });
        }
    }
    let index = names
        .iter()
        .position(|n| ["span", "section", "profile", "index", "slice"].iter().any(|w| n.contains(w)));
    (!groups.is_empty()).then_some((groups, index))
}

/// Reads a text.
pub(super) fn read(text: &str) -> Result<Layout, SectionsError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut rows: Vec<Row> = Vec::new();
    let mut names: Option<Vec<String>> = None;
    let mut unit = None;
    let mut apart = false;
    for (k, line) in text.lines().enumerate() {
        let line = line.trim_matches('\0');
        match numbers(line) {
            // A number alone is a count before a block.
            Some(n) if n.len() == 1 => apart = true,
            Some(numbers) => {
                if let Some(got) = numbers.iter().find(|x| !x.is_finite()) {
                    return Err(SectionsError::NotFinite { line: k + 1, got: *got });
                }
                rows.push(Row { line: k + 1, numbers, apart });
                apart = false;
            }
            None => {
                apart = true;
                unit = unit.or_else(|| unit_of(line));
                let own: Vec<String> =
                    words(line.trim_start_matches('#')).iter().map(|w| w.to_ascii_lowercase()).collect();
                if rows.is_empty() && own.len() > 1 {
                    names = Some(own);
                }
            }
        }
    }
    let Some(first) = rows.first() else { return Err(SectionsError::NoRows) };
    let want = first.numbers.len();
    if let Some(row) = rows.iter().find(|r| r.numbers.len() != want) {
        return Err(SectionsError::Columns { line: row.line, got: row.numbers.len(), want });
    }
    let names = names.filter(|n| n.len() == want).unwrap_or_default();
    if want == 2 {
        let of_contour = matches!(names.iter().map(String::as_str).collect::<Vec<_>>()[..], ["x" | "z", "r"]);
        if !of_contour {
            return Err(SectionsError::TwoColumns { line: first.line });
        }
        let points = rows.iter().map(|r| Point3::new(r.numbers[0], r.numbers[1], 0.0)).collect();
        return Ok(Layout { content: Content::Contour(Section { line: first.line, points }), unit });
    }
    let (groups, index) = match named_columns(&names) {
        Some(found) => found,
        None => {
            let whole = |k: usize| rows.iter().all(|r| r.numbers[k].fract() == 0.0);
            let own = |at| vec![Columns { name: String::new(), at }];
            match want {
                3 => (own([0, 1, 2]), None),
                4 if whole(0) => (own([1, 2, 3]), Some(0)),
                _ => return Err(SectionsError::Unnamed { line: first.line, columns: want }),
            }
        }
    };
    // An index that never repeats numbers the points, not the sections.
    let index = match index {
        Some(k) if rows.windows(2).any(|w| w[0].numbers[k] == w[1].numbers[k]) => Some(k),
        Some(_) if groups.len() == 1 && rows.iter().skip(1).all(|r| !r.apart) => {
            return Err(SectionsError::Cloud { points: rows.len() });
        }
        _ => None,
    };
    let sides = groups
        .into_iter()
        .map(|g| {
            let sections = split(&rows, &g, index);
            (g.name, sections)
        })
        .collect();
    Ok(Layout { content: Content::Sides(sides), unit })
}

fn split(rows: &[Row], columns: &Columns, index: Option<usize>) -> Vec<Section> {
    let point = |r: &Row| Point3::from(columns.at.map(|k| r.numbers[k]));
    let begins: Vec<bool> = match index {
        Some(k) => (0..rows.len()).map(|i| i == 0 || rows[i].numbers[k] != rows[i - 1].numbers[k]).collect(),
        None if rows.iter().skip(1).any(|r| r.apart) => {
            rows.iter().enumerate().map(|(i, r)| i == 0 || r.apart).collect()
        }
        None => by_height(rows, &point),
    };
    let mut sections: Vec<Section> = Vec::new();
    for (row, begin) in rows.iter().zip(begins) {
        if begin {
            sections.push(Section { line: row.line, points: Vec::new() });
        }
        if let Some(last) = sections.last_mut() {
            last.points.push(point(row));
        }
    }
    sections
}

/// Sections at constant values of one coordinate, at least [`FEWEST`] points each; else one section.
fn by_height(rows: &[Row], point: &dyn Fn(&Row) -> Point3) -> Vec<bool> {
    for axis in (0..3).rev() {
        let begins: Vec<bool> =
            (0..rows.len()).map(|i| i == 0 || point(&rows[i])[axis] != point(&rows[i - 1])[axis]).collect();
        let starts: Vec<usize> = (0..rows.len()).filter(|i| begins[*i]).chain([rows.len()]).collect();
        if starts.len() > 2 && starts.windows(2).all(|w| w[1] - w[0] >= FEWEST) {
            return begins;
        }
    }
    (0..rows.len()).map(|i| i == 0).collect()
}
