//! What an import gives: faces as trimmed surfaces, what was left out and why, and findings on the way.
//!
//! Lengths are millimetres whatever the file's unit was. Nothing is repaired silently: every departure from what the
//! file says is a [`Diagnostic`].

use crate::trim::carrier::FaceSurface;
use crate::trim::curve::Motion;
use crate::trimmed::TrimmedSurface;
use crate::{iges, json, patches, sections, step};
use osculate_geom::{Axis, Box3, Diagnostic, Domain, Interval, Jet2, Jet3, Point3, Surface, Taylor, Uv};
use std::collections::HashMap;
use std::fmt;
use std::sync::Arc;

/// The file format of an import.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// ISO 10303-21.
    Step,
    /// IGES, both ASCII forms.
    Iges,
    /// Bezier patches as text.
    Patches,
    /// Sections of points as text.
    Sections,
    /// The JSON of [`json`].
    Json,
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Step => "STEP",
            Self::Iges => "IGES",
            Self::Patches => "Bezier patches",
            Self::Sections => "point sections",
            Self::Json => "JSON of faces",
        })
    }
}

/// An imported part.
#[derive(Clone, Debug)]
pub struct Part {
    /// The format it came from.
    pub format: Format,
    /// The largest uncertainty of length that the file states, mm: points nearer than this mean one.
    pub uncertainty_mm: Option<f64>,
    /// Name of the file's length unit, as the file says it; several differing ones joined with `, `.
    pub unit: String,
    /// Schema (STEP) or version (IGES) as the file says it.
    pub schema: String,
    /// The faces in file order.
    pub faces: Vec<Face>,
    /// What the file has and the part has not, by kind.
    pub not_used: Vec<NotUsed>,
    /// Whether the file ends before its format says it does: faces may be missing without a trace.
    pub truncated: bool,
    /// Findings.
    pub diagnostics: Vec<Diagnostic>,
}

/// Entities of one kind that became no face.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NotUsed {
    /// The file's own name of the kind.
    pub kind: String,
    /// How many.
    pub count: usize,
    /// Why.
    pub why: String,
    /// Lines of the file on which the first ones stand, where the format has lines.
    pub lines: Vec<usize>,
}

/// A colour, each part from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Colour {
    /// Red.
    pub red: f64,
    /// Green.
    pub green: f64,
    /// Blue.
    pub blue: f64,
}

/// Why a face cannot be put into its place.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub(crate) enum PlaceError {
    /// The motion scales or mirrors.
    #[error(
        "its place scales lengths by {scale} (negative: mirrors them), which its surface does not follow"
    )]
    Scaled {
        /// Factor of lengths.
        scale: f64,
    },
    /// The motion distorts.
    #[error("its place distorts it")]
    Distorted,
    /// Coordinates leave the range of numbers.
    #[error("its place leaves the range of numbers")]
    Far,
}

/// The kind of surface that a file gave for a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum FaceKind {
    /// Plane.
    Plane,
    /// Circular cylinder.
    Cylinder,
    /// Circular cone.
    Cone,
    /// Sphere.
    Sphere,
    /// Torus.
    Torus,
    /// B-spline surface, rational or not.
    Bspline,
    /// Bezier surface.
    Bezier,
    /// Surface of revolution.
    Revolution,
    /// Surface of linear extrusion.
    Extrusion,
    /// Offset surface.
    Offset,
    /// Ruled surface.
    Ruled,
    /// Anything else.
    Other,
}

impl fmt::Display for FaceKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Plane => "plane",
            Self::Cylinder => "cylinder",
            Self::Cone => "cone",
            Self::Sphere => "sphere",
            Self::Torus => "torus",
            Self::Bspline => "bspline",
            Self::Bezier => "bezier",
            Self::Revolution => "revolution",
            Self::Extrusion => "extrusion",
            Self::Offset => "offset",
            Self::Ruled => "ruled",
            Self::Other => "other",
        })
    }
}

/// A face of a part.
#[derive(Clone, Debug)]
pub struct Face {
    /// `F1`, `F2`, ... in file order.
    pub id: String,
    /// The face's name in the file, empty where it has none.
    pub name: String,
    /// The product that it belongs to, empty where the file names none.
    pub product: String,
    /// Its colour, or its solid's.
    pub colour: Option<Colour>,
    /// STEP: the instance number of the face. IGES: the sequence number of its directory entry. Text: the line that it
    /// begins in.
    pub entity: u64,
    /// What the file says its surface is.
    pub kind: FaceKind,
    /// True where the file says on which side the material is. Where it does not, the outward normal is
    /// `S_u x S_v` and the caller has to decide.
    pub oriented: bool,
    /// The surface without trims; the carrier of `surface`.
    pub carrier: FaceSurface,
    /// The trimmed surface with its material side.
    pub surface: Arc<TrimmedSurface>,
}

/// Range of the principal curvatures over a face, 1/mm, convex positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvatureRange {
    /// The most concave curvature found.
    pub k_min_per_mm: f64,
    /// The most convex curvature found.
    pub k_max_per_mm: f64,
    /// Number of points it was taken at.
    pub samples: usize,
}

impl Face {
    /// Degrees of a spline face.
    #[must_use]
    pub fn degree(&self) -> Option<[usize; 2]> {
        self.carrier.nurbs().map(|n| n.degree())
    }

    /// Numbers of poles of a spline face.
    #[must_use]
    pub fn pole_count(&self) -> Option<[usize; 2]> {
        self.carrier.nurbs().map(|n| n.net().count)
    }

    /// Whether a spline face is rational.
    #[must_use]
    pub fn is_rational(&self) -> Option<bool> {
        self.carrier.nurbs().map(|n| n.is_rational())
    }

    /// Whether the boundary is something else than the four sides of the parameter rectangle.
    #[must_use]
    pub fn trimmed(&self) -> bool {
        self.surface.is_trimmed()
    }

    /// Area of the face, mm2.
    #[must_use]
    pub fn area_mm2(&self) -> f64 {
        self.surface.area_mm2()
    }

    /// Box around the face, mm.
    #[must_use]
    pub fn bbox(&self) -> Box3 {
        self.surface.bbox(4)
    }

    /// Principal curvatures on a grid of about `per_side` points between any two sides, inside the face; `None`
    /// where no sampled point has a tangent plane.
    #[must_use]
    pub fn curvature_range(&self, per_side: usize) -> Option<CurvatureRange> {
        let spans = self.surface.breaks(Axis::U).len().max(self.surface.breaks(Axis::V).len()) - 1;
        let mut range: Option<CurvatureRange> = None;
        for (at, _) in self.surface.samples(per_side.div_ceil(spans.max(1))) {
            let Ok(forms) = self.surface.jet2(at).forms() else { continue };
            let k = forms.principal();
            let so_far =
                range.unwrap_or(CurvatureRange { k_min_per_mm: k.k_min, k_max_per_mm: k.k_max, samples: 0 });
            range = Some(CurvatureRange {
                k_min_per_mm: so_far.k_min_per_mm.min(k.k_min),
                k_max_per_mm: so_far.k_max_per_mm.max(k.k_max),
                samples: so_far.samples + 1,
            });
        }
        range
    }

    /// About how much memory a copy at another place takes, bytes: poles and polynomial pieces of a spline, and the loops'
    /// points, which edges and trims keep.
    pub(crate) fn copy_bytes(&self) -> usize {
        let spline = self.degree().zip(self.pole_count()).map_or(0, |([p, q], [n, m])| {
            let pieces = n.saturating_sub(p) * m.saturating_sub(q);
            32 * (n * m + pieces * (p + 1) * (q + 1))
        });
        let loops: usize = self.surface.edges().iter().map(|e| 512 + 64 * e.points.len()).sum();
        1024 + spline + loops
    }

    /// The face at a place: edges are shared with the other faces of the same place number.
    pub(crate) fn placed(&self, motion: Option<&Motion>, place: u64) -> Result<Self, PlaceError> {
        let mut face = self.clone();
        let edges = self.surface.edges().iter().map(|e| e.placed(motion, place)).collect();
        let Some(motion) = motion else {
            face.surface = Arc::new(TrimmedSurface::clone(&self.surface).with_edges(edges));
            return Ok(face);
        };
        let scale = motion.scale().ok_or(PlaceError::Distorted)?;
        face.carrier = self.carrier.moved(motion, scale)?;
        let mut surface = self.surface.on(face.carrier.shared()).with_edges(edges);
        if scale < 0.0 {
            surface = surface.flipped();
        }
        face.surface = Arc::new(surface);
        Ok(face)
    }

    /// The face with the material on the other side.
    #[must_use]
    pub fn flipped(mut self) -> Self {
        self.surface = Arc::new(TrimmedSurface::clone(&self.surface).flipped());
        self
    }
}

impl Surface for Face {
    fn domain(&self) -> Domain {
        self.surface.domain()
    }
    fn jet2(&self, uv: Uv) -> Jet2 {
        self.surface.jet2(uv)
    }
    fn taylor(&self, uv: Uv, order: usize) -> Taylor {
        self.surface.taylor(uv, order)
    }
    fn jet3(&self, uv: Uv) -> Jet3 {
        self.surface.jet3(uv)
    }
    fn point(&self, uv: Uv) -> Point3 {
        self.surface.point(uv)
    }
    fn contains(&self, uv: Uv) -> bool {
        self.surface.contains(uv)
    }
    fn breaks(&self, axis: Axis) -> Vec<f64> {
        self.surface.breaks(axis)
    }
    fn spans(&self, axis: Axis, fixed: f64) -> Vec<Interval> {
        self.surface.spans(axis, fixed)
    }
    fn turns(&self) -> Vec<Uv> {
        self.surface.turns()
    }
}

impl Part {
    /// The face with this id.
    #[must_use]
    pub fn face(&self, id: &str) -> Option<&Face> {
        self.faces.iter().find(|f| f.id == id)
    }

    /// Box around all faces, mm.
    #[must_use]
    pub fn bbox(&self) -> Box3 {
        self.faces.iter().fold(Box3::empty(), |b, f| b.union(&f.bbox()))
    }
}

/// Why bytes are no part.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ImportError {
    /// Nothing to read.
    #[error("the file is empty")]
    Empty,
    /// Two bytes a character.
    #[error(
        "the file is UTF-16 text; STEP, IGES and point files are one byte a character: save it as UTF-8 or ASCII"
    )]
    Wide,
    /// None of the formats.
    #[error(
        "no format that is read: it begins with {begin:?}; STEP begins with ISO-10303-21, IGES has S, G, D and P \
         in column 73 of its lines, a set of Bezier patches begins with their number and a line of vertex numbers, \
         sections are rows of x y z, and faces that were exported as JSON begin with a brace"
    )]
    Unknown {
        /// The first characters.
        begin: String,
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

/// Reads a file of any format that [`detect`] knows.
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
            let begin = String::from_utf8_lossy(&bytes[..bytes.len().min(40)]).into_owned();
            Err(ImportError::Unknown { begin })
        }
    }
}

/// Memory that copies of faces at other places may take in all, bytes ([`Face::copy_bytes`]): a file of a few kilobytes
/// can ask for any number of copies of a large face.
pub(crate) const MAX_COPIES: usize = 1 << 30;

/// What is said where [`MAX_COPIES`] ends the placing.
pub(crate) fn too_many_copies(left_out: usize) -> Diagnostic {
    Diagnostic::loss(
        "",
        format!(
            "{left_out} instances of faces are left out: the copies would take more than {} MiB. Export the parts of the \
             assembly one by one",
            MAX_COPIES >> 20
        ),
    )
}

/// Counts of entities left out, by kind and reason, in order of first appearance.
#[derive(Debug, Default)]
pub(crate) struct Leftovers {
    entries: Vec<NotUsed>,
    /// Places of kind and reason in the list.
    index: HashMap<(String, String), usize>,
}

impl Leftovers {
    /// Lines that are kept of each kind.
    pub(crate) const LINES: usize = 8;

    /// Counts one more, on a line.
    pub(crate) fn add_at(&mut self, kind: &str, why: &str, line: usize) {
        self.add_lines(kind, 1, why, &[line]);
    }

    /// Counts several, the first ones on these lines.
    pub(crate) fn add_lines(&mut self, kind: &str, count: usize, why: &str, lines: &[usize]) {
        let at = *self.index.entry((kind.to_owned(), why.to_owned())).or_insert(self.entries.len());
        if at == self.entries.len() {
            let (kind, why) = (kind.to_owned(), why.to_owned());
            self.entries.push(NotUsed { kind, count: 0, why, lines: Vec::new() });
        }
        let entry = &mut self.entries[at];
        entry.count += count;
        entry.lines.extend(lines.iter().take(Self::LINES.saturating_sub(entry.lines.len())));
    }

    pub(crate) fn into_entries(self) -> Vec<NotUsed> {
        self.entries
    }
}
