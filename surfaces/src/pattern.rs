//! Circular patterns of faces: where the faces of a part lie again when they are turned about an axis.
//!
//! A face f belongs to the image of a set of faces A under a turn T where all samples of f, turned back, lie on A, with the same normal.
//! A has an image where the samples of A, turned, lie on such faces, and where both have the same area:
//!
//! ```text
//! f in image(A)  <=>  T^-1 p in A for all samples p of f
//! ```
//!
//! The image may be cut into other faces than A is: a turned face has a seam somewhere. Samples lie inside the faces, so that neighbours
//! across an edge do not count. What samples cannot tell, such as a hole between them, the area does.

use crate::closest::FaceSearch;
use crate::nurbs::NurbsSurface;
use crate::trim::analytic::Shape;
use crate::trim::carrier::FaceSurface;
use crate::trimmed::TrimmedSurface;
use nalgebra::Isometry3;
use osculate_geom::{Box3, Point3, Surface, TurnAxis, Unit3, Uv};
use std::f64::consts::TAU;

/// Lines of samples in a span: as many as give enough samples.
const LINES: [usize; 4] = [1, 3, 9, 27];
/// Enough samples of a face ...
const ENOUGH: usize = 8;
/// ... and the most.
const MOST: usize = 32;
/// Cosine of the angle between normals that are the same: apart by what the tolerance makes of a small radius.
const SAME_NORMAL: f64 = 0.99;
/// Areas are equal within this share, and within a strip of the tolerance along the boundary.
const SAME_AREA: f64 = 1e-3;
/// The largest number of turns that is looked for.
const MOST_FOLDS: usize = 36;
/// Axes are one axis where they are this near in direction, as a sine.
const SAME_AXIS: f64 = 1e-6;

/// Equal turns about an axis, a full circle of them.
///
/// ```
/// use osculate_geom::{Point3, TurnAxis, Vec3};
/// use osculate_surfaces::pattern::Circle;
/// // Six blades about the z axis: the third stands at 120 degrees.
/// let axis = TurnAxis { origin: Point3::origin(), direction: Vec3::z_axis() };
/// let wheel = Circle { axis, count: 6 };
/// assert!((wheel.angle_deg(2) - 120.0).abs() < 1e-12);
/// let turned = wheel.turn(3) * Point3::new(5.0, 0.0, 1.0);
/// assert!((turned - Point3::new(-5.0, 0.0, 1.0)).norm() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// The axis.
    pub axis: TurnAxis,
    /// How many places there are, the first one counted.
    pub count: usize,
}

impl Circle {
    /// The angle of a turn, degrees; the turn 0 is none.
    #[must_use]
    pub fn angle_deg(&self, turn: usize) -> f64 {
        360.0 * turn as f64 / self.count as f64
    }

    /// The motion of a turn.
    #[must_use]
    pub fn turn(&self, turn: usize) -> Isometry3<f64> {
        self.axis.turn(TAU * turn as f64 / self.count as f64)
    }
}

/// A face among which images are looked for.
#[derive(Clone, Copy)]
pub struct PatternFace<'a> {
    /// As messages name it.
    pub name: &'a str,
    /// The face.
    pub surface: &'a TrimmedSurface,
    /// The spline under it, with the same parameters, where there is one.
    pub carrier: Option<&'a NurbsSurface>,
}

/// Why faces do not lie on the part again when they are turned.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PatternError {
    /// One turn is none.
    #[error("a pattern has two places or more, got {got}")]
    Count {
        /// The number.
        got: usize,
    },
    /// A place of a face has nothing of the part where it is turned to.
    #[error(
        "{face} turned by {angle_deg:.4} deg is not on the part: it is {off_mm:.3} mm off {near}, the nearest face, at \
         ({:.2}, {:.2}, {:.2})", at.x, at.y, at.z
    )]
    NoImage {
        /// The face.
        face: String,
        /// The turn, degrees.
        angle_deg: f64,
        /// The nearest face that looks the same way.
        near: String,
        /// How far that is, mm.
        off_mm: f64,
        /// The place, turned.
        at: Point3,
    },
    /// A face comes to lie on one that is larger.
    #[error(
        "{face} turned by {angle_deg:.4} deg is only a piece of {on}: name all faces that make up {on} where it is turned from"
    )]
    Piece {
        /// The face.
        face: String,
        /// The turn, degrees.
        angle_deg: f64,
        /// The larger face.
        on: String,
    },
    /// A face comes to lie on one of the faces that are turned.
    #[error(
        "{face} turned by {angle_deg:.4} deg lies on {on}, which is turned itself: it would be machined more than once"
    )]
    Itself {
        /// The face.
        face: String,
        /// The turn, degrees.
        angle_deg: f64,
        /// The face that it lies on.
        on: String,
    },
    /// The image has another area.
    #[error(
        "{faces} turned by {angle_deg:.4} deg are {own_mm2:.3} mm2 and lie on {image} with {image_mm2:.3} mm2: the part is not \
         the same there"
    )]
    Area {
        /// The faces.
        faces: String,
        /// The turn, degrees.
        angle_deg: f64,
        /// The faces that they lie on.
        image: String,
        /// Area of the faces, mm2.
        own_mm2: f64,
        /// Area of the image, mm2.
        image_mm2: f64,
    },
}

/// A face with what looking for images needs.
struct Known<'a> {
    face: PatternFace<'a>,
    search: FaceSearch<'a>,
    bounds: Box3,
    samples: Vec<(Point3, Option<Unit3>)>,
    area_mm2: f64,
    rim_mm: f64,
}

/// The faces of a part among which images are looked for.
pub struct Pattern<'a> {
    faces: Vec<Known<'a>>,
    tolerance_mm: f64,
}

/// Places inside a face, with its normals.
fn samples(face: &TrimmedSurface) -> Vec<(Point3, Option<Unit3>)> {
    let found = LINES.iter().map(|lines| face.samples(*lines));
    let mut best: Vec<(Uv, Point3)> = Vec::new();
    for all in found {
        best = all;
        if best.len() >= ENOUGH {
            break;
        }
    }
    if best.is_empty() {
        // A sliver: its boundary stands for it, and its normals there for nothing.
        let rim = face.loops().iter().flat_map(|l| l.points.iter().map(|at| (face.point(*at), None)));
        let rim: Vec<_> = rim.collect();
        return thinned(&rim);
    }
    let all: Vec<_> = best.iter().map(|(at, p)| (*p, face.jet2(*at).normal().ok())).collect();
    thinned(&all)
}

fn thinned<T: Copy>(all: &[T]) -> Vec<T> {
    let count = all.len().min(MOST);
    (0..count).map(|k| all[k * all.len() / count]).collect()
}

fn rim_mm(face: &TrimmedSurface) -> f64 {
    let side = |points: &[Uv]| -> f64 {
        let at = |k: usize| face.point(points[k % points.len()]);
        (0..points.len()).map(|k| (at(k + 1) - at(k)).norm()).sum()
    };
    face.loops().iter().map(|l| side(&l.points)).sum()
}

/// A face that a place lies on, or the nearest.
struct Near {
    face: usize,
    off_mm: f64,
}

impl<'a> Pattern<'a> {
    /// Prepares the faces of a part; places nearer than `tolerance_mm` are one.
    #[must_use]
    pub fn new(faces: &[PatternFace<'a>], tolerance_mm: f64) -> Self {
        let known = |face: &PatternFace<'a>| Known {
            face: *face,
            search: FaceSearch::new(face.surface, face.carrier),
            bounds: face.surface.bbox(4),
            samples: samples(face.surface),
            area_mm2: face.surface.area_mm2(),
            rim_mm: rim_mm(face.surface),
        };
        Self { faces: faces.iter().map(known).collect(), tolerance_mm }
    }

    /// How far a place with a normal is off a face that looks the same way there; nothing where it looks another way.
    fn off_mm(&self, face: usize, (point, normal): &(Point3, Option<Unit3>)) -> Option<f64> {
        let known = &self.faces[face];
        let foot = known.search.closest(point, None).ok()?;
        let own = known.face.surface.jet2(foot.uv).normal().ok();
        let same = normal.zip(own).is_none_or(|(a, b)| a.dot(&b) > SAME_NORMAL);
        same.then_some(foot.distance_mm)
    }

    fn lies_on(&self, face: usize, at: &(Point3, Option<Unit3>)) -> bool {
        let b = &self.faces[face].bounds.grown(self.tolerance_mm);
        let inside = (0..3).all(|k| at.0[k] >= b.min[k] && at.0[k] <= b.max[k]);
        inside && self.off_mm(face, at).is_some_and(|d| d <= self.tolerance_mm)
    }

    /// The images of some of the faces under all turns of a circle but the first, which is none. Each is a list of numbers in
    /// ascending order.
    ///
    /// # Errors
    /// Names the first face that has no image, and the angle.
    pub fn images(&self, own: &[usize], circle: &Circle) -> Result<Vec<Vec<usize>>, PatternError> {
        if circle.count < 2 {
            return Err(PatternError::Count { got: circle.count });
        }
        (1..circle.count).map(|turn| self.image(own, circle, turn)).collect()
    }

    fn image(&self, own: &[usize], circle: &Circle, turn: usize) -> Result<Vec<usize>, PatternError> {
        let (motion, angle_deg) = (circle.turn(turn), circle.angle_deg(turn));
        let back = motion.inverse();
        let moved = |by: &Isometry3<f64>, (p, n): &(Point3, Option<Unit3>)| {
            (by * p, n.map(|n| Unit3::new_normalize(by * n.into_inner())))
        };
        let comes_from_own = |f: &usize| {
            let at = |s: &(Point3, Option<Unit3>)| own.iter().any(|o| self.lies_on(*o, &moved(&back, s)));
            !self.faces[*f].samples.is_empty() && self.faces[*f].samples.iter().all(at)
        };
        let name = |f: usize| self.faces[f].face.name.to_owned();
        let mut image: Option<Vec<usize>> = None;
        for face in own {
            for sample in &self.faces[*face].samples {
                let at = moved(&motion, sample);
                // Which faces the image has is asked once a place shows that there is anything.
                let on = |f: &usize| self.lies_on(*f, &at);
                let Some(first) = (0..self.faces.len()).find(on) else {
                    let Near { face: near, off_mm } = self.nearest(&at);
                    let face = name(*face);
                    return Err(PatternError::NoImage {
                        face,
                        angle_deg,
                        near: name(near),
                        off_mm,
                        at: at.0,
                    });
                };
                let image = image
                    .get_or_insert_with(|| (0..self.faces.len()).filter(comes_from_own).collect::<Vec<_>>());
                if let Some(same) = image.iter().find(|f| own.contains(f) && on(f)) {
                    return Err(PatternError::Itself { face: name(*face), angle_deg, on: name(*same) });
                }
                if !image.iter().any(on) {
                    let (face, on) = (name(*face), name(first));
                    return Err(PatternError::Piece { face, angle_deg, on });
                }
            }
        }
        let image = image.unwrap_or_default();
        let sum = |all: &[usize], of: &dyn Fn(&Known<'_>) -> f64| {
            all.iter().map(|f| of(&self.faces[*f])).sum::<f64>()
        };
        let (own_mm2, image_mm2) = (sum(own, &|k| k.area_mm2), sum(&image, &|k| k.area_mm2));
        let slack = SAME_AREA * own_mm2 + self.tolerance_mm * sum(own, &|k| k.rim_mm);
        if (own_mm2 - image_mm2).abs() > slack {
            let list = |all: &[usize]| all.iter().map(|f| name(*f)).collect::<Vec<_>>().join(", ");
            let (faces, image) = (list(own), list(&image));
            return Err(PatternError::Area { faces, angle_deg, image, own_mm2, image_mm2 });
        }
        Ok(image)
    }

    /// Whether faces lie on themselves again when they are turned by one place: they go all the way around, and each turn does the same.
    #[must_use]
    pub fn goes_around(&self, own: &[usize], circle: &Circle) -> bool {
        let motion = circle.turn(1);
        let on_own = |(p, n): &(Point3, Option<Unit3>)| {
            let at = (motion * p, n.map(|n| Unit3::new_normalize(motion * n.into_inner())));
            own.iter().any(|o| self.lies_on(*o, &at))
        };
        circle.count > 1 && own.iter().all(|f| self.faces[*f].samples.iter().all(on_own))
    }

    /// The face that is nearest to a place and looks the same way there; of all faces where none does.
    fn nearest(&self, at: &(Point3, Option<Unit3>)) -> Near {
        let least = |at: &(Point3, Option<Unit3>)| {
            let all =
                (0..self.faces.len()).filter_map(|face| Some(Near { face, off_mm: self.off_mm(face, at)? }));
            all.min_by(|a, b| a.off_mm.total_cmp(&b.off_mm))
        };
        least(at).or_else(|| least(&(at.0, None))).unwrap_or(Near { face: 0, off_mm: f64::INFINITY })
    }

    /// The largest number of places that a circle about an axis may have for some of the faces.
    #[must_use]
    pub fn most_places(&self, own: &[usize], axis: &TurnAxis) -> Option<usize> {
        (2..=MOST_FOLDS).rev().find(|count| self.images(own, &Circle { axis: *axis, count: *count }).is_ok())
    }
}

/// The axis of a surface that is turned about one, where it says so.
#[must_use]
pub fn turn_axis(surface: &FaceSurface) -> Option<TurnAxis> {
    let FaceSurface::Analytic(a) = surface else { return None };
    let turned = matches!(a.shape(), Shape::Cylinder { .. } | Shape::Cone { .. } | Shape::Torus { .. });
    let p = a.placement();
    turned.then_some(TurnAxis { origin: p.origin, direction: p.z })
}

/// Whether two axes are one, to `tolerance_mm` across.
#[must_use]
pub fn same_axis(a: &TurnAxis, b: &TurnAxis, tolerance_mm: f64) -> bool {
    let across = a.direction.cross(&b.direction).norm();
    across < SAME_AXIS && (b.origin - a.origin).cross(&a.direction).norm() <= tolerance_mm
}
