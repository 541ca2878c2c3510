//! The untrimmed surface under a face, with what trimming has to know of it: where it closes, where it shrinks to a
//! point, and the parameters of a point near it.

use super::analytic::{Analytic, Shape};
use super::foot;
use super::motion::Motion;
use super::region::Known;
use crate::nurbs::{Net, NurbsSurface};
use osculate_geom::analytic::Placement;
use osculate_geom::{Axis, Box3, Domain, Offset, Point3, Surface, Unit3, Uv, forward_surface};
use std::sync::{Arc, OnceLock};

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

/// The untrimmed surface of a face.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum FaceSurface {
    /// A spline surface.
    Nurbs(Arc<NurbsSurface>),
    /// A surface with a closed form.
    Analytic(Arc<Analytic>),
    /// A spline surface moved along its normals.
    Offset(Arc<Offset<Arc<NurbsSurface>>>),
}

impl FaceSurface {
    /// The spline surface, where it is one.
    #[must_use]
    pub const fn nurbs(&self) -> Option<&Arc<NurbsSurface>> {
        match self {
            Self::Nurbs(s) => Some(s),
            Self::Analytic(_) | Self::Offset(_) => None,
        }
    }

    /// The surface at another place, with the same parameters; `scale` is the motion's factor of lengths.
    pub(crate) fn moved(&self, motion: &Motion, scale: f64) -> Result<Self, PlaceError> {
        match self {
            Self::Nurbs(n) => {
                let net = n.net();
                let points = net.points.iter().map(|p| motion.point(p)).collect();
                let net = Net { count: net.count, points, weights: net.weights.clone() };
                let knots = [Axis::U, Axis::V].map(|axis| n.knots(axis).as_slice().to_vec());
                let made = NurbsSurface::new(n.degree(), knots, net).map_err(|_| PlaceError::Far)?;
                Ok(Self::Nurbs(Arc::new(made)))
            }
            Self::Offset(o) => {
                let base = Self::Nurbs(o.base().clone()).moved(motion, scale)?;
                // A mirror turns the natural normal over.
                base.offset(o.distance_mm() * scale).map_err(|_| PlaceError::Far)
            }
            Self::Analytic(a) => {
                let p = a.placement();
                // A mirrored plane keeps its parameters with its normal turned over; lengths among the parameters would
                // have to change with a scale, angles with a mirror.
                let mirrored = a.shape() == Shape::Plane && (scale + 1.0).abs() <= SAME_SCALE;
                if !mirrored && (scale - 1.0).abs() > SAME_SCALE {
                    return Err(PlaceError::Scaled { scale });
                }
                let z = Unit3::new_normalize(motion.vector(&p.z) * scale.signum());
                let moved = Placement::new(motion.point(&p.origin), z, Some(motion.vector(&p.x)));
                let made = Analytic::new(a.shape(), moved).map_err(|_| PlaceError::Far)?;
                Ok(Self::Analytic(Arc::new(made.limited(a.domain()))))
            }
        }
    }

    /// The surface at a distance along its natural normal, exactly: analytic kinds stay of their kind.
    ///
    /// # Errors
    /// Words for a distance that leaves no surface.
    pub(crate) fn offset(&self, distance_mm: f64) -> Result<Self, String> {
        match self {
            Self::Analytic(a) => {
                let made = a.offset(distance_mm).map_err(|e| e.to_string())?;
                Ok(Self::Analytic(Arc::new(made)))
            }
            Self::Nurbs(n) => {
                let made = Offset::new(n.clone(), distance_mm).map_err(|e| e.to_string())?;
                Ok(Self::Offset(Arc::new(made)))
            }
            Self::Offset(o) => {
                let made = (**o).clone().further(distance_mm).map_err(|e| e.to_string())?;
                Ok(Self::Offset(Arc::new(made)))
            }
        }
    }

    /// What one unit of each parameter of a file is worth in this surface's parameters.
    pub(crate) fn parameter_units(&self, length_mm: f64, angle_rad: f64) -> [f64; 2] {
        match self {
            Self::Nurbs(_) | Self::Offset(_) => [1.0, 1.0],
            Self::Analytic(a) => match a.shape() {
                Shape::Plane => [length_mm, length_mm],
                Shape::Cylinder { .. } => [angle_rad, length_mm],
                // The file measures along the axis.
                Shape::Cone { half_angle_rad, .. } => [angle_rad, length_mm / half_angle_rad.cos()],
                Shape::Sphere { .. } | Shape::Torus { .. } | Shape::Lemon { .. } => [angle_rad, angle_rad],
            },
        }
    }

    /// The surface behind a trimmed one.
    pub(crate) fn shared(&self) -> Arc<dyn Surface> {
        match self {
            Self::Nurbs(s) => s.clone(),
            Self::Analytic(s) => s.clone(),
            Self::Offset(s) => s.clone(),
        }
    }

    /// The spline surface that it is or is an offset of; for an analytic surface there is none to ask.
    fn base(&self) -> Option<&NurbsSurface> {
        match self {
            Self::Nurbs(n) => Some(n),
            Self::Offset(o) => Some(o.base()),
            Self::Analytic(_) => None,
        }
    }

    fn surface(&self) -> &dyn Surface {
        match self {
            Self::Nurbs(s) => &**s,
            Self::Analytic(s) => &**s,
            Self::Offset(s) => &**s,
        }
    }
}

impl Surface for FaceSurface {
    forward_surface!(all | s | s.surface());
}

/// A motion whose factor of lengths is this near to one is rigid: frames are made of unit vectors.
const SAME_SCALE: f64 = 1e-9;

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
    /// How large the sides are, mm: at both ends of u, at both ends of v. Infinite where nothing shrinks, and on analytic
    /// surfaces, which know their poles.
    sides_mm: [[f64; 2]; 2],
    /// Sides up to this size are points, mm.
    point_mm: f64,
    /// Made when a point is first looked for without a neighbour.
    seeds: OnceLock<foot::Seeds>,
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
                    // Spindle tori end in apexes.
                    Shape::Lemon { .. } => ([true, false], false, false),
                    Shape::Torus { .. } => ([true, domain.v.periodic], false, false),
                };
                let speed = match a.shape() {
                    Shape::Plane => [1.0, 1.0],
                    Shape::Cylinder { radius_mm } => [radius_mm, 1.0],
                    Shape::Cone { radius_mm, .. } => [radius_mm, 1.0],
                    Shape::Sphere { radius_mm } => [radius_mm, radius_mm],
                    Shape::Torus { major_radius_mm, minor_radius_mm }
                    | Shape::Lemon { major_radius_mm, minor_radius_mm } => [major_radius_mm, minor_radius_mm],
                };
                let known = Known { below_out, above_out, oriented };
                let (sides_mm, point_mm) = ([[f64::INFINITY; 2]; 2], 0.0);
                Self { surface, domain, closes, known, speed, sides_mm, point_mm, seeds: OnceLock::new() }
            }
            FaceSurface::Nurbs(_) | FaceSurface::Offset(_) => {
                let (n, base) = (&surface, surface.base());
                let size = base.map_or(0.0, |b| Box3::around(&b.net().points).diagonal_mm());
                let fractions: Vec<f64> = (0..PROBES).map(|k| k as f64 / (PROBES - 1) as f64).collect();
                let side = |axis: Axis, end: f64| -> Vec<Point3> {
                    let at = domain.get(axis).at(end);
                    let other = domain.get(axis.other());
                    fractions.iter().map(|f| n.point(Uv::from_axis(axis, at, other.at(*f)))).collect()
                };
                let sides = [Axis::U, Axis::V].map(|axis| [side(axis, 0.0), side(axis, 1.0)]);
                let closes = [Axis::U, Axis::V].map(|axis| base.is_some_and(|b| b.closed(axis)));
                let sides_mm = sides.map(|ends| ends.map(|points| Box3::around(&points).diagonal_mm()));
                let point_mm = SAME_LINE * size;
                // The direction that does not close is v, or u where only v closes.
                let open = if closes[1] && !closes[0] { 0 } else { 1 };
                let [below_out, above_out] = match closes {
                    [false, false] => [true, true],
                    _ => [0, 1].map(|end| sides_mm[open][end] > point_mm),
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
                Self { surface, domain, closes, known, speed, sides_mm, point_mm, seeds: OnceLock::new() }
            }
        }
    }

    /// The carrier with its small sides taken for poles, where it closes and has sides that are larger than a point but
    /// not than `small_mm`, and the size of the largest such side, mm.
    pub(crate) fn with_poles(&self, small_mm: f64) -> Option<(Self, f64)> {
        let open = match self.closes {
            [false, false] => return None,
            [false, true] => 0,
            _ => 1,
        };
        let small = self.sides_mm[open].map(|mm| mm > self.point_mm && mm <= small_mm);
        let known = Known {
            below_out: self.known.below_out && !small[0],
            above_out: self.known.above_out && !small[1],
            ..self.known
        };
        let sizes = self.sides_mm[open].iter().zip(small).filter(|s| s.1).map(|s| *s.0);
        let largest = sizes.fold(0.0, f64::max);
        let carrier = Self { surface: self.surface.clone(), known, seeds: OnceLock::new(), ..*self };
        (known != self.known).then_some((carrier, largest))
    }

    /// The corners on the way from one place to another along sides that are points, where the straight way would leave
    /// them: between two such sides.
    pub(crate) fn corners_between(&self, from: Uv, to: Uv) -> Vec<Uv> {
        /// Parameters this near to a side, as a fraction of their range, are on it.
        const ON: f64 = 1e-9;
        if self.closes != [false, false] {
            return Vec::new();
        }
        let value = |axis: Axis, end: usize| {
            if end == 0 { self.domain.get(axis).lo } else { self.domain.get(axis).hi }
        };
        let shrunk =
            |axis: Axis, end: usize| self.sides_mm[usize::from(axis == Axis::V)][end] <= self.point_mm;
        let on = |at: Uv, axis: Axis, end: usize| {
            (at.get(axis) - value(axis, end)).abs() <= ON * self.domain.get(axis).length()
        };
        let sides: Vec<(Axis, usize)> = [Axis::U, Axis::V]
            .into_iter()
            .flat_map(|axis| [(axis, 0), (axis, 1)])
            .filter(|(axis, end)| shrunk(*axis, *end))
            .collect();
        let at = |p: Uv| sides.iter().filter(move |(axis, end)| on(p, *axis, *end));
        if at(from).any(|a| at(to).any(|b| a == b)) {
            return Vec::new();
        }
        let corner =
            |a: (Axis, usize), b: (Axis, usize)| Uv::from_axis(a.0, value(a.0, a.1), value(b.0, b.1));
        for a in at(from) {
            for b in at(to) {
                if a.0 != b.0 {
                    return vec![corner(*a, *b)];
                }
                // Across from each other, with one between them.
                if let Some(c) = sides.iter().find(|c| c.0 != a.0) {
                    return vec![corner(*a, *c), corner(*b, *c)];
                }
            }
        }
        Vec::new()
    }

    fn seeds(&self) -> &foot::Seeds {
        self.seeds.get_or_init(|| foot::Seeds::new(&self.surface))
    }

    /// Parameters of the surface point nearest to `p`, and its distance, mm. With a hint the search stays near it
    /// where it finds a point within `good_mm`.
    pub(crate) fn locate(&self, p: &Point3, hint: Option<Uv>, good_mm: f64) -> (Uv, f64) {
        match &self.surface {
            FaceSurface::Analytic(a) => {
                let at = a.locate(p, hint.unwrap_or_default());
                (at, (a.point(at) - p).norm())
            }
            FaceSurface::Nurbs(_) | FaceSurface::Offset(_) => {
                let target = foot::Target { surface: self.surface.surface(), closes: self.closes, point: *p };
                if let Some(hint) = hint {
                    let near = foot::newton(&target, hint);
                    if near.1 <= good_mm {
                        return near;
                    }
                    let far = self.seeds().global(&target);
                    return if far.1 < 0.5 * near.1 { far } else { near };
                }
                self.seeds().global(&target)
            }
        }
    }
}
