//! Faces as JSON, both ways: everything that a face is made of, in full precision. The form is in `spec`.

mod curves;
mod fault;
mod spec;
mod surfaces;

pub use fault::FaceFault;

use crate::part::{Colour, Face, FaceKind, Format, Part};
use crate::structure::Structure;
use crate::trim::boundary::{Boundary, build};
use osculate_geom::Side;
use std::sync::Arc;

/// The number of the form that is written and read.
pub const FORMAT: u32 = 1;

/// Why a text is no faces.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum JsonError {
    /// Not the JSON of the form.
    #[error("not the JSON of faces: {what}")]
    Syntax {
        /// Line of the text, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What is wrong, with the place.
        what: String,
    },
    /// Another form.
    #[error("format {got}, but only format {FORMAT} is read")]
    Format {
        /// The number found.
        got: u32,
    },
    /// A face that is none.
    #[error("face {face}: {why}")]
    Face {
        /// Its id.
        face: String,
        /// What is wrong with it.
        why: FaceFault,
    },
}

/// Why faces cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum JsonWriteError {
    /// A number that JSON cannot hold, or a text that cannot be made.
    #[error("the faces cannot be written as JSON: {0}")]
    Text(#[from] serde_json::Error),
}

/// Writes faces.
///
/// ```
/// use osculate_surfaces::{json, patches};
/// let part = patches::read(b"1\n1 1\n0 0 0\n0 20 0\n10 0 0\n10 20 0.1\n")?;
/// let text = json::write(&part.faces)?;
/// // Numbers come back to the bit: what is written again is the same text.
/// assert_eq!(json::write(&json::read(text.as_bytes())?)?, text);
/// assert!(matches!(json::read(b"{\"format\": 2, \"faces\": []}"), Err(json::JsonError::Format { got: 2 })));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`JsonWriteError`].
pub fn write(faces: &[Face]) -> Result<String, JsonWriteError> {
    let faces = faces.iter().map(of_face).collect();
    let mut text = serde_json::to_string_pretty(&spec::File { format: FORMAT, faces })?;
    text.push('\n');
    Ok(text)
}

/// Reads faces that [`write()`] has written.
///
/// # Errors
/// [`JsonError`] with the place in the text, or the face and what is wrong with it.
pub fn read(bytes: &[u8]) -> Result<Vec<Face>, JsonError> {
    let file: spec::File = serde_json::from_slice(unmarked(bytes)).map_err(|e| JsonError::Syntax {
        line: e.line(),
        column: e.column(),
        what: e.to_string(),
    })?;
    if file.format != FORMAT {
        return Err(JsonError::Format { got: file.format });
    }
    let numbered = file.faces.into_iter().enumerate();
    numbered
        .map(|(k, f)| {
            let id = f.id.clone();
            to_face(f, k as u64 + 1).map_err(|why| JsonError::Face { face: id, why })
        })
        .collect()
}

/// Whether the bytes begin as JSON does.
pub(crate) fn looks_like(bytes: &[u8]) -> bool {
    unmarked(bytes).iter().find(|c| !c.is_ascii_whitespace()) == Some(&b'{')
}

/// The text without a byte order mark.
fn unmarked(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

/// Reads faces as a part.
///
/// # Errors
/// [`JsonError`].
pub fn read_part(bytes: &[u8]) -> Result<Part, JsonError> {
    Ok(Part {
        structure: Structure::default(),
        format: Format::Json,
        uncertainty_mm: None,
        unit: "mm".to_owned(),
        schema: format!("format {FORMAT}"),
        faces: read(bytes)?,
        not_used: Vec::new(),
        truncated: false,
        diagnostics: Vec::new(),
    })
}

const KINDS: [FaceKind; 12] = [
    FaceKind::Plane,
    FaceKind::Cylinder,
    FaceKind::Cone,
    FaceKind::Sphere,
    FaceKind::Torus,
    FaceKind::Bspline,
    FaceKind::Bezier,
    FaceKind::Revolution,
    FaceKind::Extrusion,
    FaceKind::Offset,
    FaceKind::Ruled,
    FaceKind::Other,
];

fn of_face(face: &Face) -> spec::Face {
    spec::Face {
        id: face.id.clone(),
        name: face.name.clone(),
        product: face.product.clone(),
        colour: face.colour.map(|c| [c.red, c.green, c.blue]),
        kind: face.kind.to_string(),
        oriented: face.oriented,
        side: surfaces::of_side(face.surface.side()),
        surface: surfaces::of_surface(&face.carrier),
        loops: curves::of_loops(face),
    }
}

fn to_face(f: spec::Face, entity: u64) -> Result<Face, FaceFault> {
    let kind = KINDS.into_iter().find(|k| k.to_string() == f.kind);
    let kind = kind.ok_or_else(|| FaceFault::Kind { got: f.kind.clone() })?;
    let colour = f.colour.map(|[red, green, blue]| Colour { red, green, blue });
    let carrier = surfaces::to_surface(f.surface)?;
    let mut loops: Vec<Vec<Boundary>> = Vec::with_capacity(f.loops.len());
    for (of, edges) in f.loops.into_iter().enumerate() {
        let mut boundary = Vec::with_capacity(edges.len());
        for (edge, e) in edges.into_iter().enumerate() {
            boundary.push(curves::to_boundary(e, of, edge)?);
        }
        loops.push(boundary);
    }
    let side = match f.side {
        spec::Side::Along => Side::Along,
        spec::Side::Against => Side::Against,
    };
    let built = build(carrier, &loops, side, f.oriented)?;
    Ok(Face {
        id: f.id,
        name: f.name,
        product: f.product,
        colour,
        entity,
        kind,
        oriented: f.oriented,
        carrier: built.assembled.carrier,
        surface: Arc::new(built.assembled.surface),
    })
}
