//! What an import gives: faces as trimmed surfaces, what was left out and why, and findings on the way.
//!
//! Lengths are millimetres whatever the file's unit was. Nothing is repaired silently: every departure from what the
//! file says is a [`Diagnostic`].

use crate::structure::Structure;
use crate::trim::carrier::{FaceSurface, PlaceError};
use crate::trim::motion::Motion;
use crate::trim::{Imbalance, imbalance};
use crate::trimmed::TrimmedSurface;
use osculate_geom::{Axis, Box3, Diagnostic, Surface, forward_surface};
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
    /// The JSON of [`crate::json`].
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
#[non_exhaustive]
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
    /// How they hang together, as the file says.
    pub structure: Structure,
    /// What the file has and the part has not, by kind.
    pub not_used: Vec<NotUsed>,
    /// Whether the file ends before its format says it does: faces may be missing without a trace.
    pub truncated: bool,
    /// Findings.
    pub diagnostics: Vec<Diagnostic>,
}

/// Entities of one kind that became no face.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
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

/// The kind of surface that a file gave for a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
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
#[non_exhaustive]
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

    /// The area of the face held against that of its boundary; `None` where they agree, and where a boundary says nothing: for
    /// faces that close on themselves, and for loops that do not close.
    #[must_use]
    pub fn imbalance(&self) -> Option<Imbalance> {
        imbalance(&self.surface)
    }

    /// Box around the face, mm.
    #[must_use]
    pub fn bbox(&self) -> Box3 {
        self.surface.bbox(4)
    }

    /// Principal curvatures on a grid of about `per_side` points between any two sides, inside the face; `None`
    /// where no sampled point has a tangent plane.
    ///
    /// ```
    /// use osculate_surfaces::patches;
    /// // A parabolic sheet z = x (20 - x) / 20, x from 0 to 20 mm: bent by z'' = 1 / 10 at its top, less beside it, and not across.
    /// let part = patches::read(b"1\n2 1\n0 0 0\n0 10 0\n10 0 10\n10 10 10\n20 0 0\n20 10 0\n")?;
    /// let range = part.faces[0].curvature_range(9).ok_or("it has no tangent plane")?;
    /// assert!(range.k_max_per_mm <= 0.1 + 1e-12 && range.k_max_per_mm > 0.09 && range.k_min_per_mm.abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
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
    forward_surface!(all | s | s.surface);
}

impl Part {
    /// The face with this id.
    ///
    /// ```
    /// use osculate_surfaces::patches;
    /// let part = patches::read(b"1\n1 1\n0 0 0\n0 20 0\n10 0 0\n10 20 0\n")?;
    /// assert_eq!(part.face("F1").map(|f| f.trimmed()), Some(false));
    /// assert!(part.face("F2").is_none());
    /// assert!((part.bbox().diagonal_mm() - 500f64.sqrt()).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
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
