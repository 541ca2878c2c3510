//! What of a part differs from the reference.
//!
//! Tolerances: areas within the reference's own, else [`AREA`] of the value; points within [`POINT`] of the model's
//! size; the reference prints 12 digits of normals and 10 of curvatures, of which its own checks by differences
//! confirm [`NORMAL`] and [`CURVATURE`].

use crate::reference::{RefFace, Reference, Sample, Shape};
use osculate_geom::{Box3, Jet2, Point3, Surface, Unit3, Uv, Vec3, uv};
use osculate_surfaces::{Face, FaceKind, ImportError, Part};
use std::fmt;

/// Relative accuracy of areas where the reference claims a better one.
const AREA: f64 = 1e-5;
/// Relative accuracy of areas that the collection's notes recommend to compare with.
const LOOSE_AREA: f64 = 1e-4;
/// Accuracy of points, as a fraction of the model's size.
const POINT: f64 = 1e-9;
/// Accuracy of normals, rad.
const NORMAL: f64 = 1e-7;
/// Accuracy of curvatures, relative to the larger one, beside the same fraction of one over the model's size.
const CURVATURE: f64 = 1e-6;
/// Accuracy of the box, as a fraction of the model's size: the reference finds it by an iterative search that ends at
/// this fraction.
const BOX: f64 = 1e-5;
/// The reference widens its boxes by this, mm.
const BOX_GAP_MM: f64 = 2e-7;
/// Samples whose neighbours at this fraction of the face's parameter range lie on the other side are on the boundary.
const RIM: f64 = 1e-6;

/// One difference.
pub enum Difference {
    Unread { why: ImportError },
    Panic { said: String },
    Slow { wall_s: f64 },
    Message { wanted: &'static str },
    OnlyOurs { status: String, faces: usize },
    FaceCount { ours: usize, reference: usize },
    Missing { id: Option<u64>, kind: String, ours: usize, reference: usize },
    Kind { face: String, ours: FaceKind, reference: String },
    FaceArea { face: String, ours_mm2: f64, reference_mm2: f64, tol_mm2: f64 },
    Area { ours_mm2: f64, reference_mm2: f64, tol_mm2: f64 },
    Box { corner: usize, ours_mm: f64, reference_mm: f64, tol_mm: f64 },
    Poles { face: String, ours: Option<[usize; 2]>, reference: [usize; 2] },
    Point { face: String, at: [f64; 2], off_mm: f64, tol_mm: f64 },
    Normal { face: String, at: [f64; 2], off_rad: f64 },
    Curvature { face: String, at: [f64; 2], ours: [f64; 2], reference: [f64; 2] },
    Inside { face: String, at: [f64; 2], ours: bool },
}

impl Difference {
    /// The reason without quantities, to count by.
    pub const fn reason(&self) -> &'static str {
        match self {
            Self::Unread { .. } => "not read",
            Self::Panic { .. } => "panic",
            Self::Slow { .. } => "slow",
            Self::Message { .. } => "message",
            Self::OnlyOurs { .. } => "faces without a reference",
            Self::FaceCount { .. } => "number of faces",
            Self::Missing { .. } => "number of faces of one entity",
            Self::Kind { .. } => "kind",
            Self::FaceArea { .. } => "area of a face",
            Self::Area { .. } => "area in all",
            Self::Box { .. } => "box",
            Self::Poles { .. } => "poles",
            Self::Point { .. } => "sample: point",
            Self::Normal { .. } => "sample: normal",
            Self::Curvature { .. } => "sample: curvature",
            Self::Inside { .. } => "sample: inside",
        }
    }
}

impl Difference {
    /// By how much of the reference's an area differs; zero for any other difference, and for a reference of zero.
    pub fn relative_area(&self) -> f64 {
        match self {
            Self::FaceArea { ours_mm2, reference_mm2, .. } | Self::Area { ours_mm2, reference_mm2, .. }
                if *reference_mm2 > 0.0 =>
            {
                (ours_mm2 / reference_mm2 - 1.0).abs()
            }
            _ => 0.0,
        }
    }

    /// Whether it is an area that differs by no more than the collection's notes recommend to allow.
    pub fn is_small_area(&self) -> bool {
        match self {
            Self::FaceArea { ours_mm2, reference_mm2, .. } | Self::Area { ours_mm2, reference_mm2, .. } => {
                within(*ours_mm2, *reference_mm2, LOOSE_AREA * reference_mm2)
            }
            _ => false,
        }
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.reason())?;
        match self {
            Self::Unread { why } => write!(f, "{why}"),
            Self::Panic { said } => write!(f, "{said}"),
            Self::Slow { wall_s } => write!(f, "{wall_s:.2} s"),
            Self::Message { wanted } => write!(f, "{wanted:?} is not said"),
            Self::OnlyOurs { status, faces } => write!(f, "{faces} faces where the reference has {status}"),
            Self::FaceCount { ours, reference } => write!(f, "{ours}, reference {reference}"),
            Self::Missing { id, kind, ours, reference } => {
                write!(f, "entity {id:?} ({kind}): {ours}, reference {reference}")
            }
            Self::Kind { face, ours, reference } => write!(f, "{face}: {ours}, reference {reference}"),
            Self::FaceArea { face, ours_mm2, reference_mm2, tol_mm2 } => write!(
                f,
                "{face}: {ours_mm2:.9}, reference {reference_mm2:.9}, off by {:.3e}, allowed {tol_mm2:.3e}",
                (ours_mm2 - reference_mm2).abs()
            ),
            Self::Area { ours_mm2, reference_mm2, tol_mm2 } => write!(
                f,
                "{ours_mm2:.9}, reference {reference_mm2:.9}, off by {:.3e}, allowed {tol_mm2:.3e}",
                (ours_mm2 - reference_mm2).abs()
            ),
            Self::Box { corner, ours_mm, reference_mm, tol_mm } => write!(
                f,
                "{} {}: {ours_mm:.9}, reference {reference_mm:.9}, off by {:.3e}, allowed {tol_mm:.3e}",
                if *corner < 3 { "lower" } else { "upper" },
                ["x", "y", "z"][corner % 3],
                (ours_mm - reference_mm).abs()
            ),
            Self::Poles { face, ours, reference } => write!(f, "{face}: {ours:?}, reference {reference:?}"),
            Self::Point { face, at, off_mm, tol_mm } => {
                write!(f, "{face} at {at:?}: off by {off_mm:.3e} mm, allowed {tol_mm:.3e}")
            }
            Self::Normal { face, at, off_rad } => write!(f, "{face} at {at:?}: off by {off_rad:.3e} rad"),
            Self::Curvature { face, at, ours, reference } => {
                write!(f, "{face} at {at:?}: {ours:?}, reference {reference:?}")
            }
            Self::Inside { face, at, ours } => write!(f, "{face} at {at:?}: {ours}, reference {}", !ours),
        }
    }
}

/// Everything that differs.
pub fn differences(reference: &Reference, part: &Result<Part, ImportError>) -> Vec<Difference> {
    let shape = match (reference, part) {
        // Where the reference crashed, any answer is one.
        (Reference::Without(status), _) if status == "crash" => return Vec::new(),
        (Reference::Without(_), Err(_)) => return Vec::new(),
        (Reference::Without(status), Ok(p)) => {
            let faces = p.faces.len();
            return if faces == 0 {
                Vec::new()
            } else {
                vec![Difference::OnlyOurs { status: status.clone(), faces }]
            };
        }
        (Reference::Shape(shape), _) => shape,
    };
    let part = match part {
        Ok(part) => part,
        // A file without a face refused with a message is no less than one read without a face.
        Err(_) if shape.faces.is_empty() => return Vec::new(),
        Err(why) => return vec![Difference::Unread { why: why.clone() }],
    };
    let mut out = Vec::new();
    if part.faces.len() != shape.faces.len() {
        out.push(Difference::FaceCount { ours: part.faces.len(), reference: shape.faces.len() });
    }
    totals(shape, part, &mut out);
    let size_mm = part.bbox().diagonal_mm();
    for (ours, theirs) in pairs(shape, part, &mut out) {
        compare_face(ours, theirs, size_mm, &mut out);
    }
    out
}

fn totals(shape: &Shape, part: &Part, out: &mut Vec<Difference>) {
    let ours_mm2: f64 = part.faces.iter().map(Face::area_mm2).sum();
    let reference_mm2 = shape.area_mm2;
    let tol_mm2 = (shape.area_tol_mm2).max(AREA * reference_mm2);
    if !shape.faces.is_empty() && !within(ours_mm2, reference_mm2, tol_mm2) {
        out.push(Difference::Area { ours_mm2, reference_mm2, tol_mm2 });
    }
    let ours: Box3 = part.bbox();
    if let Some(theirs) = shape.bbox_mm
        && !shape.faces.is_empty()
    {
        let corner = |b: &[f64; 6], k: usize| Point3::new(b[k], b[k + 1], b[k + 2]);
        let tol_mm = BOX * (corner(&theirs, 3) - corner(&theirs, 0)).norm() + BOX_GAP_MM;
        let mine = [ours.min.x, ours.min.y, ours.min.z, ours.max.x, ours.max.y, ours.max.z];
        for (k, ours_mm) in mine.into_iter().enumerate() {
            let reference_mm = theirs[k];
            // Curves without face can only widen the reference's box.
            let inner =
                if k < 3 { ours_mm >= reference_mm - tol_mm } else { ours_mm <= reference_mm + tol_mm };
            if !(within(ours_mm, reference_mm, tol_mm) || shape.more_in_box && inner) {
                out.push(Difference::Box { corner: k, ours_mm, reference_mm, tol_mm });
            }
        }
    }
}

/// Whether two numbers agree; a NaN agrees with nothing.
fn within(a: f64, b: f64, tol: f64) -> bool {
    (a - b).abs() <= tol
}

/// Faces of the same entity, those of several instances by the first sample or area.
fn pairs<'a>(shape: &'a Shape, part: &'a Part, out: &mut Vec<Difference>) -> Vec<(&'a Face, &'a RefFace)> {
    let mut free: Vec<Option<&Face>> = part.faces.iter().map(Some).collect();
    let mut pairs = Vec::new();
    let mut unmatched: Vec<&RefFace> = Vec::new();
    for theirs in &shape.faces {
        let near = |f: &Face| distance(f, theirs);
        let best = free
            .iter()
            .enumerate()
            .filter_map(|(k, f)| f.filter(|f| theirs.id == Some(f.entity)).map(|f| (k, near(f))))
            .min_by(|a, b| a.1.total_cmp(&b.1));
        match best {
            Some((k, _)) => pairs.extend(free[k].take().map(|f| (f, theirs))),
            None => unmatched.push(theirs),
        }
    }
    for theirs in unmatched {
        // The reference names some entity near the face; the same kind and the nearest area then make a pair.
        let best = free
            .iter()
            .enumerate()
            .filter_map(|(k, f)| {
                let f = (*f)?;
                let known = shape.faces.iter().any(|t| t.id == Some(f.entity)) && theirs.id.is_some();
                (!known && same_kind(f.kind, &theirs.kind))
                    .then(|| (k, (f.area_mm2() - theirs.area_mm2).abs()))
            })
            .min_by(|a, b| a.1.total_cmp(&b.1));
        match best {
            Some((k, _)) => pairs.extend(free[k].take().map(|f| (f, theirs))),
            None => {
                let count = |id| shape.faces.iter().filter(|f| f.id == id).count();
                out.push(Difference::Missing {
                    id: theirs.id,
                    kind: theirs.kind.clone(),
                    ours: part.faces.iter().filter(|f| Some(f.entity) == theirs.id).count(),
                    reference: count(theirs.id),
                });
            }
        }
    }
    pairs
}

/// How far a face is from a reference's: by the first sample, else by area.
fn distance(face: &Face, theirs: &RefFace) -> f64 {
    match theirs.samples.first() {
        Some(s) => (face.carrier.point(wrapped(face, s)) - Point3::from(s.point_mm)).norm(),
        None => (face.area_mm2() - theirs.area_mm2).abs(),
    }
}

/// The kinds that the reference's own kinds stand for. It reads a Bezier surface as a spline.
fn same_kind(ours: FaceKind, theirs: &str) -> bool {
    match theirs {
        "Plane" => ours == FaceKind::Plane,
        "Cylinder" => ours == FaceKind::Cylinder,
        "Cone" => ours == FaceKind::Cone,
        "Sphere" => ours == FaceKind::Sphere,
        "Torus" => ours == FaceKind::Torus,
        "BSplineSurface" | "BezierSurface" => {
            matches!(ours, FaceKind::Bspline | FaceKind::Bezier | FaceKind::Ruled)
        }
        "SurfaceOfRevolution" => ours == FaceKind::Revolution,
        "SurfaceOfExtrusion" => ours == FaceKind::Extrusion,
        "OffsetSurface" => ours == FaceKind::Offset,
        _ => ours == FaceKind::Other,
    }
}

fn compare_face(ours: &Face, theirs: &RefFace, size_mm: f64, out: &mut Vec<Difference>) {
    let face = || format!("{} (#{})", ours.id, ours.entity);
    if !same_kind(ours.kind, &theirs.kind) {
        out.push(Difference::Kind { face: face(), ours: ours.kind, reference: theirs.kind.clone() });
    }
    let (ours_mm2, reference_mm2) = (ours.area_mm2(), theirs.area_mm2);
    let tol_mm2 = (theirs.area_tol_mm2).max(AREA * reference_mm2);
    if !within(ours_mm2, reference_mm2, tol_mm2) {
        out.push(Difference::FaceArea { face: face(), ours_mm2, reference_mm2, tol_mm2 });
    }
    if let Some(reference) = theirs.poles
        && ours.pole_count() != Some(reference)
    {
        out.push(Difference::Poles { face: face(), ours: ours.pole_count(), reference });
    }
    if ours.carrier.nurbs().is_none() {
        return;
    }
    // One difference of each sort a face is enough.
    let mut told = [false; 4];
    for s in &theirs.samples {
        for d in sample(ours, s, size_mm).into_iter().flatten() {
            let k = match d {
                Difference::Point { .. } => 0,
                Difference::Normal { .. } => 1,
                Difference::Curvature { .. } => 2,
                _ => 3,
            };
            if !std::mem::replace(&mut told[k], true) {
                out.push(d);
            }
        }
    }
}

/// The sample's parameters, brought into the rectangle where the face closes.
fn wrapped(face: &Face, s: &Sample) -> Uv {
    let d = face.carrier.domain();
    let bring = |t: f64, i: osculate_geom::Interval| {
        let slack = 1e-9 * i.length();
        if t < i.lo - slack || t > i.hi + slack { i.lo + (t - i.lo).rem_euclid(i.length()) } else { t }
    };
    uv(bring(s.uv[0], d.u), bring(s.uv[1], d.v))
}

fn sample(ours: &Face, s: &Sample, size_mm: f64) -> [Option<Difference>; 4] {
    let face = || format!("{} (#{})", ours.id, ours.entity);
    let at = wrapped(ours, s);
    let jet = ours.carrier.jet2(at);
    let off_mm = (jet.point - Point3::from(s.point_mm)).norm();
    let tol_mm = POINT * size_mm;
    let point = (off_mm.is_nan() || off_mm > tol_mm).then(|| Difference::Point {
        face: face(),
        at: s.uv,
        off_mm,
        tol_mm,
    });
    let normal = s.normal.and_then(|n| {
        let off_rad = natural_normal(&jet).map_or(f64::INFINITY, |m| {
            let n = Vec3::from(n).normalize();
            m.cross(&n).norm().atan2(m.dot(&n))
        });
        (off_rad > NORMAL).then(|| Difference::Normal { face: face(), at: s.uv, off_rad })
    });
    let curvature = s.curvature_per_mm.and_then(|k| {
        let reference = k.map(|k| k);
        let ours = curvatures(&jet)?;
        let tol = CURVATURE * (reference[0].abs().max(reference[1].abs()) + 1.0 / size_mm);
        let off = (0..2).any(|j| !within(ours[j], reference[j], tol));
        off.then(|| Difference::Curvature { face: face(), at: s.uv, ours, reference })
    });
    let inside = s.inside.and_then(|inside| {
        let mine = ours.surface.contains(at);
        (mine != inside && !on_rim(ours, at)).then(|| Difference::Inside {
            face: face(),
            at: s.uv,
            ours: mine,
        })
    });
    [point, normal, curvature, inside]
}

fn natural_normal(jet: &Jet2) -> Option<Unit3> {
    Unit3::try_new(jet.du.cross(&jet.dv), 0.0)
}

/// Largest and smallest principal curvature, positive towards `S_u x S_v`.
fn curvatures(jet: &Jet2) -> Option<[f64; 2]> {
    let n = natural_normal(jet)?;
    let (e, f, g) = (jet.du.norm_squared(), jet.du.dot(&jet.dv), jet.dv.norm_squared());
    let (l, m, nn) = (jet.duu.dot(&n), jet.duv.dot(&n), jet.dvv.dot(&n));
    let w = e * g - f * f;
    let mean = 0.5 * (e * nn - 2.0 * f * m + g * l) / w;
    let gauss = (l * nn - m * m) / w;
    let root = (mean * mean - gauss).max(0.0).sqrt();
    Some([mean + root, mean - root])
}

/// Whether the boundary passes within [`RIM`] of the parameters.
fn on_rim(face: &Face, at: Uv) -> bool {
    let d = face.carrier.domain();
    let (du, dv) = (RIM * d.u.length(), RIM * d.v.length());
    let flags: Vec<bool> = [(0.0, 0.0), (du, 0.0), (-du, 0.0), (0.0, dv), (0.0, -dv)]
        .iter()
        .map(|(a, b)| face.surface.contains(uv(at.u + a, at.v + b)))
        .collect();
    flags.iter().any(|f| *f != flags[0])
}
