//! Scalar fields over a face whose contours are drawn.

use super::course::Family;
use super::third::forms_rate;
use osculate_geom::{Surface, Unit3, Uv, Vec3};

/// A field's value at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldSample {
    /// The value.
    pub value: f64,
    /// Derivatives by u and v, where they are known.
    pub gradient: Option<[f64; 2]>,
    /// For a field that is defined up to its sign only: the direction with which the sign turns over.
    pub sense: Option<Vec3>,
}

/// How large a face and its curvatures are.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Scale {
    /// The face's size, mm.
    pub size_mm: f64,
    /// Its largest curvature, 1/mm.
    pub curvature_per_mm: f64,
}

/// A scalar field over a surface.
pub trait ScalarField: Sync {
    /// The field at a point; `None` where it is not defined (no tangent plane).
    fn sample(&self, surface: &dyn Surface, at: Uv) -> Option<FieldSample>;

    /// Differences that are rounding, on a face with curvatures up to `curvature_per_mm`: a field that is constant but
    /// for them has no contours.
    fn rounding(&self, _scale: Scale) -> f64 {
        0.0
    }

    /// Values of a field that is defined up to its sign only which are zero but for rounding: where it has no others there is
    /// no line, though its sign turns all over.
    fn zero(&self, _scale: Scale) -> f64 {
        0.0
    }

    /// Whether the field has its digits at the poles of the parametrisation too: it needs no tangent plane.
    fn holds_at_poles(&self) -> bool {
        false
    }
}

/// The height along an axis, mm from the frame's origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Height {
    /// The direction: the tool axis of machining with a fixed axis.
    pub axis: Unit3,
}

impl ScalarField for Height {
    fn sample(&self, surface: &dyn Surface, at: Uv) -> Option<FieldSample> {
        let jet = surface.jet2(at);
        let gradient = Some([jet.du.dot(&self.axis), jet.dv.dot(&self.axis)]);
        Some(FieldSample { value: jet.point.coords.dot(&self.axis), gradient, sense: None })
    }
    fn rounding(&self, scale: Scale) -> f64 {
        1e-13 * scale.size_mm
    }
    fn holds_at_poles(&self) -> bool {
        true
    }
}

/// The square of the difference of the principal curvatures, `(k_1 - k_2)^2`, 1/mm2: smooth at umbilics, where the
/// difference itself has a cone. The contour of the difference at D is this field's at D squared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CurvatureDifference;

impl ScalarField for CurvatureDifference {
    fn sample(&self, surface: &dyn Surface, at: Uv) -> Option<FieldSample> {
        let (value, gradient) = forms_rate(surface, at).ok()?.difference_squared();
        finite(value, gradient, None)
    }
    fn rounding(&self, scale: Scale) -> f64 {
        1e-14 * scale.curvature_per_mm.powi(2)
    }
}

/// The Gaussian curvature, 1/mm2; zero on parabolic lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gauss;

impl ScalarField for Gauss {
    fn sample(&self, surface: &dyn Surface, at: Uv) -> Option<FieldSample> {
        let (value, gradient) = forms_rate(surface, at).ok()?.gauss();
        finite(value, gradient, None)
    }
    fn rounding(&self, scale: Scale) -> f64 {
        1e-11 * scale.curvature_per_mm.powi(2)
    }
}

/// The derivative of a principal curvature along its own line of curvature, 1/mm2; zero on ridges. Its sign turns
/// over with the direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Extremality {
    /// Which principal curvature.
    pub family: Family,
}

impl ScalarField for Extremality {
    fn sample(&self, surface: &dyn Surface, at: Uv) -> Option<FieldSample> {
        let rate = forms_rate(surface, at).ok()?;
        let p = rate.forms.principal();
        let (k, d) = self.family.of(&p);
        let along = rate.forms.rate(&surface.jet2(at), &d);
        let value = rate.extremality(along, k);
        value.is_finite().then(|| FieldSample { value, gradient: None, sense: Some(d.into_inner()) })
    }
    fn zero(&self, scale: Scale) -> f64 {
        // Third derivatives keep ten digits.
        1e-10 * scale.curvature_per_mm.powi(2)
    }
}

fn finite(value: f64, gradient: [f64; 2], sense: Option<Vec3>) -> Option<FieldSample> {
    let good = value.is_finite() && gradient.iter().all(|g| g.is_finite());
    good.then_some(FieldSample { value, gradient: Some(gradient), sense })
}
