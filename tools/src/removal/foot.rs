//! Points found on faces near places beneath a sample, and what they bound between two such places.

use super::job::Sample;
use super::rim::OpenRim;
use osculate_geom::{Point3, Surface, Uv};

/// The nearest point of other faces that was found: how far it is, its face and where it is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Foot {
    pub mm: f64,
    pub on: Option<(u32, Uv, Point3)>,
}

/// A place so far beneath a sample, with the point found for it.
pub(super) type Place = (f64, Foot);

/// What no place between two beneath a sample is deeper than, whatever the faces do there. The points found for the two are both on
/// faces, so that the nearer of them is no nearer than the face. Over t the squares of their distances differ by a linear function:
/// up to one t the first is nearer, from there the second, or one is all the way. The distance from a point is convex in t, and so
/// greatest at an end of either part.
pub(super) fn most_mm(s: &Sample, [a, b]: [&Place; 2]) -> f64 {
    let (Some((.., p)), Some((.., q))) = (a.1.on, b.1.on) else { return b.0 };
    let beneath = |t: f64| s.point - s.normal.into_inner() * t;
    let away = |t: f64| (beneath(t) - p).norm().min((beneath(t) - q).norm());
    // Seen from the sample: how far beneath they are, and the squares of how far they are away.
    let (p0, q0) = (p - s.point, q - s.point);
    let (pt, qt) = (-p0.dot(&s.normal), -q0.dot(&s.normal));
    let same = 0.5 * (q0 - p0).dot(&(q0 + p0)) / (qt - pt);
    let (first, last) = (away(a.0), away(b.0));
    if same > a.0 && same < b.0 {
        let middle = away(same);
        same.min(first.max(middle)).max(b.0.min(middle.max(last)))
    } else {
        b.0.min(first.max(last))
    }
}

/// The distance of a point from the place of a face that Newton's method comes to from a place near it, and that place; infinite where
/// it is not on the face.
pub(super) fn nearest(surface: &dyn Surface, from: Uv, q: &Point3, steps: usize) -> (f64, Uv) {
    let domain = surface.domain();
    let mut at = from;
    for _ in 0..steps {
        let jet = surface.jet2(at);
        let off = q - jet.point;
        let (a, b, c) = (jet.du.norm_squared(), jet.du.dot(&jet.dv), jet.dv.norm_squared());
        let (e, f) = (off.dot(&jet.du), off.dot(&jet.dv));
        let det = a * c - b * b;
        if det.is_nan() || det <= 0.0 {
            break;
        }
        let next = domain.bring(Uv { u: at.u + (e * c - f * b) / det, v: at.v + (f * a - e * b) / det });
        if next == at {
            break;
        }
        at = next;
    }
    (if surface.contains(at) { (surface.point(at) - q).norm() } else { f64::INFINITY }, at)
}

/// What is beside a place of a face: a face, or the wall on a piece of its own open rim.
pub(super) enum Beside<'a> {
    Face(&'a dyn Surface),
    Rim(&'a OpenRim<'a>),
}

impl Beside<'_> {
    pub fn contains(&self, at: Uv) -> bool {
        match self {
            Self::Face(surface) => surface.contains(at),
            Self::Rim(rim) => rim.contains(at),
        }
    }

    pub fn point(&self, at: Uv) -> Point3 {
        match self {
            Self::Face(surface) => surface.point(at),
            Self::Rim(rim) => rim.point(at),
        }
    }

    /// The nearest place that is found in so many steps from one.
    pub fn nearest(&self, from: Uv, q: &Point3, steps: usize) -> (f64, Uv) {
        match self {
            Self::Face(surface) => nearest(*surface, from, q, steps),
            Self::Rim(rim) => rim.nearest(q),
        }
    }
}
