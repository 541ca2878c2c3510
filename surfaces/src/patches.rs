//! Bezier patch sets as text: each patch a face.
//!
//! Two layouts. Newell's: a line with the number of patches, a line of 16 vertex numbers (from 1) a patch, a line with
//! the number of vertices, a line of three coordinates a vertex. The other one (`.bpt`): a line with the number of
//! patches, and for each patch a line with its two degrees and a line of three coordinates a pole. Rows of poles run
//! along v, row after row along u. Numbers are separated by blanks, tabs or commas; lines that begin with `#` do not
//! count. The files name no unit: coordinates are millimetres where none is given.
//!
//! A patch with a side in one point (a lid, a bottom) is a patch; one without any area is left out and told.

use crate::knots::MAX_DEGREE;
use crate::leftovers::Leftovers;
use crate::nurbs::{Net, NurbsError, NurbsSurface};
use crate::part::{Face, FaceKind, Format, Part};
use crate::structure::Structure;
use crate::trim::boundary::build;
use crate::trim::carrier::FaceSurface;
use osculate_geom::{Diagnostic, Point3, Side};
use rayon::prelude::*;
use std::sync::Arc;

/// Why a text is no set of patches.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PatchesError {
    /// The first line is no count.
    #[error("line {line}: {got:?}; the number of patches is due there")]
    NoCount {
        /// Line from one.
        line: usize,
        /// What stands there.
        got: String,
    },
    /// A line with other contents than the layout has there.
    #[error("line {line}: {got:?}; {want} are due there")]
    Line {
        /// Line from one.
        line: usize,
        /// What stands there.
        got: String,
        /// What is due.
        want: &'static str,
    },
    /// The text ends early.
    #[error("the text ends after {got} of {want} {what}: it is cut off, or its count is wrong")]
    Ends {
        /// How many came.
        got: usize,
        /// How many were announced.
        want: usize,
        /// Of what.
        what: &'static str,
    },
    /// A patch names a vertex that is not there.
    #[error("line {line}: the patch names vertex {got} of {vertices}; they count from 1")]
    Vertex {
        /// Line from one.
        line: usize,
        /// The number.
        got: usize,
        /// How many there are.
        vertices: usize,
    },
    /// A degree that is not read.
    #[error("line {line}: degrees {} and {}; 1 to {MAX_DEGREE} can be read", got[0], got[1])]
    Degree {
        /// Line from one.
        line: usize,
        /// Both.
        got: [usize; 2],
    },
}

/// A line that counts: its number from one and its text.
type Line<'t> = (usize, &'t str);

/// What a line shows of itself in a message.
fn shown(text: &str) -> String {
    text.trim().chars().take(40).collect()
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| c == ',' || c.is_whitespace()).filter(|w| !w.is_empty())
}

/// The numbers of a line; `None` where something else stands there.
fn numbers<T: std::str::FromStr>(text: &str) -> Option<Vec<T>> {
    words(text).map(|w| w.parse().ok()).collect()
}

fn coordinates(text: &str) -> Option<Point3> {
    let n: Vec<f64> = numbers(text)?;
    (n.len() == 3 && n.iter().all(|x| x.is_finite())).then(|| Point3::new(n[0], n[1], n[2]))
}

fn lines(text: &str) -> impl Iterator<Item = Line<'_>> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    text.lines()
        .enumerate()
        .map(|(k, l)| (k + 1, l.trim_matches(|c: char| c.is_whitespace() || c == '\0')))
        .filter(|(_, l)| !l.is_empty() && !l.starts_with('#'))
}

/// Whether the bytes begin like a set of patches.
pub(crate) fn looks_like(bytes: &[u8]) -> bool {
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(4096)]);
    let mut all = lines(&head);
    let count =
        all.next().is_some_and(|(_, l)| numbers::<usize>(l).is_some_and(|n| n.len() == 1 && n[0] > 0));
    count && all.next().is_some_and(|(_, l)| numbers::<usize>(l).is_some_and(|n| matches!(n.len(), 2 | 16)))
}

/// A patch before it is a surface.
struct Patch {
    line: usize,
    degree: [usize; 2],
    points: Vec<Point3>,
}

fn count_line<'t>(
    all: &mut impl Iterator<Item = Line<'t>>,
    what: &'static str,
) -> Result<usize, PatchesError> {
    let (line, text) = all.next().ok_or(PatchesError::Ends { got: 0, want: 1, what })?;
    match numbers::<usize>(text).as_deref() {
        Some([n]) => Ok(*n),
        _ => Err(PatchesError::NoCount { line, got: shown(text) }),
    }
}

/// Newell's layout behind the count and the first patch's line.
fn by_vertices<'t>(
    first: Line<'t>,
    count: usize,
    all: &mut impl Iterator<Item = Line<'t>>,
) -> Result<Vec<Patch>, PatchesError> {
    let mut named: Vec<(usize, Vec<usize>)> = Vec::new();
    let mut next = Some(first);
    while named.len() < count {
        let Some((line, text)) = next.take().or_else(|| all.next()) else {
            return Err(PatchesError::Ends { got: named.len(), want: count, what: "patches" });
        };
        match numbers::<usize>(text) {
            Some(n) if n.len() == 16 => named.push((line, n)),
            _ => return Err(PatchesError::Line { line, got: shown(text), want: "16 vertex numbers" }),
        }
    }
    let want = count_line(all, "vertex counts")?;
    let mut vertices: Vec<Point3> = Vec::new();
    while vertices.len() < want {
        let Some((line, text)) = all.next() else {
            return Err(PatchesError::Ends { got: vertices.len(), want, what: "vertices" });
        };
        let p = coordinates(text).ok_or_else(|| PatchesError::Line {
            line,
            got: shown(text),
            want: "three coordinates",
        })?;
        vertices.push(p);
    }
    named
        .into_iter()
        .map(|(line, numbers)| {
            let point = |got: usize| {
                let at = got.checked_sub(1).and_then(|k| vertices.get(k)).copied();
                at.ok_or(PatchesError::Vertex { line, got, vertices: vertices.len() })
            };
            let points = numbers.into_iter().map(point).collect::<Result<Vec<_>, _>>()?;
            Ok(Patch { line, degree: [3, 3], points })
        })
        .collect()
}

/// The other layout behind the count and the first patch's degrees.
fn by_poles<'t>(
    first: Line<'t>,
    count: usize,
    all: &mut impl Iterator<Item = Line<'t>>,
) -> Result<Vec<Patch>, PatchesError> {
    let mut patches = Vec::new();
    let mut next = Some(first);
    while patches.len() < count {
        let Some((line, text)) = next.take().or_else(|| all.next()) else {
            return Err(PatchesError::Ends { got: patches.len(), want: count, what: "patches" });
        };
        let Some([du, dv]) = numbers::<usize>(text).as_deref().and_then(|n| <[usize; 2]>::try_from(n).ok())
        else {
            return Err(PatchesError::Line { line, got: shown(text), want: "two degrees" });
        };
        let degree = [du, dv];
        if degree.iter().any(|d| !(1..=MAX_DEGREE).contains(d)) {
            return Err(PatchesError::Degree { line, got: degree });
        }
        let want = (du + 1) * (dv + 1);
        let mut points = Vec::with_capacity(want);
        while points.len() < want {
            let Some((line, text)) = all.next() else {
                return Err(PatchesError::Ends { got: points.len(), want, what: "poles of a patch" });
            };
            let p = coordinates(text).ok_or_else(|| PatchesError::Line {
                line,
                got: shown(text),
                want: "three coordinates",
            })?;
            points.push(p);
        }
        patches.push(Patch { line, degree, points });
    }
    Ok(patches)
}

fn surface(patch: &Patch) -> Result<NurbsSurface, NurbsError> {
    let clamped = |d: usize| {
        let mut knots = vec![0.0; d + 1];
        knots.resize(2 * d + 2, 1.0);
        knots
    };
    let net = Net { count: patch.degree.map(|d| d + 1), points: patch.points.clone(), weights: None };
    NurbsSurface::new(patch.degree, patch.degree.map(clamped), net)
}

/// Reads a set of Bezier patches, lengths in millimetres, which is told. Faces are in the order of the patches; on which side the
/// material is the file does not say.
///
/// # Errors
/// [`PatchesError`] names the line and what was due there.
pub fn read(bytes: &[u8]) -> Result<Part, PatchesError> {
    read_in(bytes, None)
}

/// Reads a set of Bezier patches with `unit_mm` millimetres in a unit of the file.
///
/// ```
/// use osculate_surfaces::patches;
/// // A patch of 2 x 3 inches.
/// let part = patches::read_in(b"1\n1 1\n0 0 0\n0 3 0\n2 0 0\n2 3 0\n", Some(25.4))?;
/// assert!((part.faces[0].area_mm2() - 6.0 * 25.4 * 25.4).abs() < 1e-6);
/// // A text that ends early says what is missing.
/// let why = patches::read(b"1\n1 1\n0 0 0\n0 3 0\n").unwrap_err();
/// assert!(matches!(why, patches::PatchesError::Ends { got: 2, want: 4, .. }));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`PatchesError`] names the line and what was due there.
pub fn read_in(bytes: &[u8], unit_mm: Option<f64>) -> Result<Part, PatchesError> {
    let text = String::from_utf8_lossy(bytes);
    let mut all = lines(&text);
    let count = count_line(&mut all, "counts of patches")?;
    let mut diagnostics = Vec::new();
    if unit_mm.is_none() {
        let told = "the file names no unit: its coordinates are taken as millimetres";
        diagnostics.push(Diagnostic::note("", told));
    }
    let mut patches = match all.next() {
        None => return Err(PatchesError::Ends { got: 0, want: count, what: "patches" }),
        Some(first) if numbers::<usize>(first.1).is_some_and(|n| n.len() == 2) => {
            by_poles(first, count, &mut all)?
        }
        Some(first) => by_vertices(first, count, &mut all)?,
    };
    if let Some(mm) = unit_mm {
        patches.iter_mut().flat_map(|p| &mut p.points).for_each(|p| *p *= mm);
    }
    let rest = all.count();
    if rest > 0 {
        diagnostics
            .push(Diagnostic::warning("", format!("{rest} lines follow the last number and were not read")));
    }
    let made: Vec<Result<Face, String>> = patches
        .par_iter()
        .enumerate()
        .map(|(k, patch)| {
            let n = surface(patch).map_err(|e| e.to_string())?;
            let built =
                build(FaceSurface::Nurbs(Arc::new(n)), &[], Side::Along, false).map_err(|e| e.to_string())?;
            let surface = Arc::new(built.assembled.surface);
            let area = surface.area_mm2();
            // A patch whose poles lie on one line or in one point.
            if area.is_nan() || area <= 0.0 {
                return Err("its poles span no area".to_owned());
            }
            Ok(Face {
                id: format!("F{}", k + 1),
                name: String::new(),
                product: String::new(),
                colour: None,
                entity: patch.line as u64,
                kind: FaceKind::Bezier,
                oriented: false,
                carrier: built.assembled.carrier,
                surface,
            })
        })
        .collect();
    let mut faces = Vec::new();
    let mut left = Leftovers::default();
    for (face, patch) in made.into_iter().zip(&patches) {
        match face {
            Ok(f) => faces.push(f),
            Err(why) => {
                diagnostics.push(Diagnostic::loss(format!("line {}", patch.line), format!("patch: {why}")));
                left.add_at("Bezier patch", "its poles make no surface", patch.line);
            }
        }
    }
    Ok(Part {
        structure: Structure::default(),
        format: Format::Patches,
        uncertainty_mm: None,
        unit: unit_mm.map_or_else(|| "mm".to_owned(), |mm| format!("{mm} mm")),
        schema: String::new(),
        faces,
        not_used: left.into_entries(),
        truncated: false,
        diagnostics,
    })
}
