//! The untrimmed surface under a face, with what trimming has to know of it: where it closes, where it shrinks to a
//! point, and the parameters of a point near it.

use super::analytic::{Analytic, Shape};
use super::foot;
use super::region::Known;
use crate::nurbs::NurbsSurface;
use osculate_geom::{Axis, Box3, Domain, Jet2, Jet3, Point3, Surface, Taylor, Uv};
use std::sync::Arc;

/// The untrimmed surface of a face.
#[derive(Clone, Debug)]
pub enum FaceSurface {
    /// A spline surface.
    Nurbs(Arc<NurbsSurface>),
    /// A surface with a closed form.
    Analytic(Arc<Analytic>),
}

impl FaceSurface {
    /// The spline surface, where it is one.
    #[must_use]
    pub const fn nurbs(&self) -> Option<&Arc<NurbsSurface>> {
        match self {
            Self::Nurbs(s) => Some(s),
            Self::Analytic(_) => None,
        }
    }

    fn surface(&self) -> &dyn Surface {
        match self {
            Self::Nurbs(s) => &**s,
            Self::Analytic(s) => &**s,
        }
    }
}

impl Surface for FaceSurface {
    fn domain(&self) -> Domain {
        self.surface().domain()
    }
    fn jet2(&self, uv: Uv) -> Jet2 {
        self.surface().jet2(uv)
    }
    fn taylor(&self, uv: Uv, order: usize) -> Taylor {
        self.surface().taylor(uv, order)
    }
    fn jet3(&self, uv: Uv) -> Jet3 {
        self.surface().jet3(uv)
    }
    fn point(&self, uv: Uv) -> Point3 {
        self.surface().point(uv)
    }
    fn contains(&self, uv: Uv) -> bool {
        self.surface().contains(uv)
    }
    fn breaks(&self, axis: Axis) -> Vec<f64> {
        self.surface().breaks(axis)
    }
}

/// A face surface with its closing directions and typical size at hand.
pub(crate) struct Carrier {
    pub(crate) surface: FaceSurface,
    /// The widest rectangle; infinite in the unlimited directions of analytic surfaces.
    pub(crate) domain: Domain,
    /// Directions in which both sides of the rectangle are the same line in space.
    pub(crate) closes: [bool; 2],
    /// What is known of the two ends of the direction that does not close.
    pub(crate) known: Known,
    /// Typical length of the derivative by each parameter.
    pub(crate) speed: [f64; 2],
    seeds: foot::Seeds,
}

/// Places along a side at which closing and shrinking are looked for.
const PROBES: usize = 17;

/// Sides whose distance is below this fraction of the surface's size are the same line, and a side whose length is
/// below it is a point: files carry seven or more digits, and real gaps and edges are larger.
const SAME_LINE: f64 = 1e-7;

impl Carrier {
    /// Looks at a surface. `oriented` says whether the chains to come have the inside on their left.
    pub(crate) fn new(surface: FaceSurface, oriented: bool) -> Self {
        let domain = surface.domain();
        match &surface {
            FaceSurface::Analytic(a) => {
                let (closes, below_out, above_out) = match a.shape() {
                    Shape::Plane => ([false, false], true, true),
                    Shape::Cylinder { .. } => ([true, false], true, true),
                    Shape::Cone { half_angle_rad, .. } => {
                        ([true, false], half_angle_rad <= 0.0, half_angle_rad >= 0.0)
                    }
                    Shape::Sphere { .. } => ([true, false], false, false),
                    Shape::Torus { .. } => ([true, true], false, false),
                };
                let speed = match a.shape() {
                    Shape::Plane => [1.0, 1.0],
                    Shape::Cylinder { radius_mm } => [radius_mm, 1.0],
                    Shape::Cone { radius_mm, .. } => [radius_mm, 1.0],
                    Shape::Sphere { radius_mm } => [radius_mm, radius_mm],
                    Shape::Torus { major_radius_mm, minor_radius_mm } => [major_radius_mm, minor_radius_mm],
                };
                let known = Known { below_out, above_out, oriented };
                Self { surface, domain, closes, known, speed, seeds: foot::Seeds::default() }
            }
            FaceSurface::Nurbs(n) => {
                let size = Box3::around(&n.net().points).diagonal_mm();
                let fractions: Vec<f64> = (0..PROBES).map(|k| k as f64 / (PROBES - 1) as f64).collect();
                let side = |axis: Axis, end: f64| -> Vec<Point3> {
                    let at = domain.get(axis).at(end);
                    let other = domain.get(axis.other());
                    fractions.iter().map(|f| n.point(Uv::from_axis(axis, at, other.at(*f)))).collect()
                };
                let sides = [Axis::U, Axis::V].map(|axis| [side(axis, 0.0), side(axis, 1.0)]);
                let closes = [Axis::U, Axis::V].map(|axis| n.closed(axis));
                let is_point = |points: &[Point3]| Box3::around(points).diagonal_mm() <= SAME_LINE * size;
                // The direction that does not close is v, or u where only v closes.
                let open = if closes[1] && !closes[0] { 0 } else { 1 };
                let [below_out, above_out] = match closes {
                    [false, false] => [true, true],
                    _ => [0, 1].map(|end| !is_point(&sides[open][end])),
                };
                let speed = [Axis::U, Axis::V].map(|axis| {
                    let mut sum = 0.0;
                    for f in [0.1, 0.3, 0.5, 0.7, 0.9] {
                        for g in [0.1, 0.3, 0.5, 0.7, 0.9] {
                            let jet = n.jet2(domain.at(f, g));
                            sum += if axis == Axis::U { jet.du.norm() } else { jet.dv.norm() };
                        }
                    }
                    sum / 25.0
                });
                let known = Known { below_out, above_out, oriented };
                let seeds = foot::Seeds::new(&**n);
                Self { surface, domain, closes, known, speed, seeds }
            }
        }
    }

    /// Parameters of the surface point nearest to `p`, and its distance, mm. With a hint the search stays near it
    /// where it finds a point within `good_mm`.
    pub(crate) fn locate(&self, p: &Point3, hint: Option<Uv>, good_mm: f64) -> (Uv, f64) {
        match &self.surface {
            FaceSurface::Analytic(a) => {
                let at = a.locate(p, hint.unwrap_or_default());
                (at, (a.point(at) - p).norm())
            }
            FaceSurface::Nurbs(n) => {
                let target = foot::Target { surface: &**n, closes: self.closes, point: *p };
                if let Some(hint) = hint {
                    let near = foot::newton(&target, hint);
                    if near.1 <= good_mm {
                        return near;
                    }
                    let far = self.seeds.global(&target);
                    return if far.1 < 0.5 * near.1 { far } else { near };
                }
                self.seeds.global(&target)
            }
        }
    }
}
