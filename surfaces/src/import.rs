//! Reading a file of any format: which one it is, and the part that it gives.

use crate::part::{Format, Part};
use crate::{iges, json, patches, sections, step};

/// Why bytes are no part.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ImportError {
    /// Nothing to read.
    #[error("the file is empty")]
    Empty,
    /// Two bytes a character.
    #[error(
        "the file is UTF-16 text; STEP, IGES and point files are one byte a character: save it as UTF-8 or ASCII"
    )]
    Wide,
    /// None of the formats. What stands in the file is not repeated: it may be anything that this program can read.
    #[error(
        "no format that is read: it is {kind}; STEP begins with ISO-10303-21, IGES has S, G, D and P \
         in column 73 of its lines, a set of Bezier patches begins with their number and a line of vertex numbers, \
         sections are rows of x y z, and faces that were exported as JSON begin with a brace"
    )]
    Unknown {
        /// What the file seems to be, in words.
        kind: &'static str,
    },
    /// A STEP file that cannot be read.
    #[error(transparent)]
    Step(#[from] step::StepError),
    /// An IGES file that cannot be read.
    #[error(transparent)]
    Iges(#[from] iges::IgesError),
    /// Bezier patches that cannot be read.
    #[error("Bezier patches: {0}")]
    Patches(#[from] patches::PatchesError),
    /// Sections that no surface goes through.
    #[error("point sections: {0}")]
    Sections(#[from] sections::SectionsError),
    /// Faces as JSON that cannot be read.
    #[error(transparent)]
    Json(#[from] json::JsonError),
}

/// The format of a file, by its first lines.
///
/// ```
/// use osculate_surfaces::{Format, detect};
/// assert_eq!(detect(b"ISO-10303-21;\nHEADER;"), Some(Format::Step));
/// assert_eq!(detect(b"%PDF-1.7"), None);
/// ```
#[must_use]
pub fn detect(bytes: &[u8]) -> Option<Format> {
    if step::looks_like(bytes) {
        Some(Format::Step)
    } else if iges::looks_like(bytes) {
        Some(Format::Iges)
    } else if patches::looks_like(bytes) {
        Some(Format::Patches)
    } else if sections::looks_like(bytes) {
        Some(Format::Sections)
    } else if json::looks_like(bytes) {
        Some(Format::Json)
    } else {
        None
    }
}

/// Whether text begins as UTF-16 does: with its mark, or with every other byte zero.
fn is_wide(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(64)];
    let every_other = |odd: usize| head.len() >= 16 && head.iter().skip(odd).step_by(2).all(|b| *b == 0);
    head.starts_with(&[0xff, 0xfe]) || head.starts_with(&[0xfe, 0xff]) || (every_other(0) != every_other(1))
}

/// Beginnings of files that people take for parts.
const KNOWN: [(&[u8], &str); 12] = [
    (b"solid", "a mesh as STL text"),
    (b"ply", "a PLY mesh"),
    (b"PK\x03\x04", "a ZIP archive without a 3MF model: unpack it"),
    (b"\x1f\x8b", "compressed by gzip: unpack it"),
    (b"%PDF", "a PDF document"),
    (b"\x89PNG", "a PNG picture"),
    (b"\xff\xd8\xff", "a JPEG picture"),
    (b"\xd0\xcf\x11\xe0", "a native file of another CAD system: export it as STEP"),
    (b"**ABCDEFGHIJKLMNOPQRSTUVWXYZ", "a Parasolid file: export it as STEP"),
    (b"ACIS", "an ACIS file: export it as STEP"),
    (b"<", "XML or HTML"),
    (b"AC10", "a DWG drawing"),
];

/// What a file of none of the formats seems to be.
fn kind(bytes: &[u8]) -> &'static str {
    let known = KNOWN.iter().find(|(begin, _)| bytes.starts_with(begin)).map(|k| k.1);
    // A binary STL file: a heading of 80 bytes, the number of triangles, 50 bytes for each.
    let triangles = bytes.get(80..84).and_then(|n| n.try_into().ok()).map(u32::from_le_bytes);
    let is_mesh = triangles.is_some_and(|n| 84 + 50 * u64::from(n) == bytes.len() as u64);
    let text = !bytes.iter().take(1024).any(|b| matches!(b, 0..=8 | 14..=31 | 127));
    known.unwrap_or(if is_mesh {
        "a mesh as binary STL"
    } else if text {
        "other text"
    } else {
        "binary data"
    })
}

/// Reads a file of any format that [`detect`] knows.
///
/// ```
/// use osculate_surfaces::{Format, ImportError, read};
/// // One flat patch of 10 x 20 mm as text. Its file does not say on which side the material is.
/// let part = read(b"1\n1 1\n0 0 0\n0 20 0\n10 0 0\n10 20 0\n")?;
/// assert_eq!((part.format, part.faces.len()), (Format::Patches, 1));
/// assert!((part.faces[0].area_mm2() - 200.0).abs() < 1e-9 && !part.faces[0].oriented);
/// // What is no part is told by what it seems to be.
/// assert!(matches!(read(b"%PDF-1.7"), Err(ImportError::Unknown { .. })));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ImportError`] where the bytes are neither, or nothing of them can be read.
pub fn read(bytes: &[u8]) -> Result<Part, ImportError> {
    if bytes.iter().all(u8::is_ascii_whitespace) {
        return Err(ImportError::Empty);
    }
    match detect(bytes) {
        Some(Format::Step) => Ok(step::read(bytes)?),
        Some(Format::Iges) => Ok(iges::read(bytes)?),
        Some(Format::Patches) => Ok(patches::read(bytes)?),
        Some(Format::Sections) => Ok(sections::read(bytes)?),
        Some(Format::Json) => Ok(json::read_part(bytes)?),
        None if is_wide(bytes) => Err(ImportError::Wide),
        None => {
            let kind = kind(bytes);
            Err(ImportError::Unknown { kind })
        }
    }
}
