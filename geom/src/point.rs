//! Points, vectors and unit vectors as different types, and surface parameters.
//!
//! All coordinates are millimetres in the part's right-handed frame unless a name says otherwise.

use nalgebra as na;

/// A position, mm.
pub type Point3 = na::Point3<f64>;
/// A displacement or derivative.
pub type Vec3 = na::Vector3<f64>;
/// A direction of length one.
pub type Unit3 = na::Unit<na::Vector3<f64>>;

/// A pair of surface parameters.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Uv {
    /// First parameter.
    pub u: f64,
    /// Second parameter.
    pub v: f64,
}

/// Shorthand for [`Uv`] `{ u, v }`.
#[must_use]
pub const fn uv(u: f64, v: f64) -> Uv {
    Uv { u, v }
}

impl Uv {
    /// The parameter of the given axis.
    #[must_use]
    pub const fn get(self, axis: Axis) -> f64 {
        match axis {
            Axis::U => self.u,
            Axis::V => self.v,
        }
    }

    /// The pair with `along` on `axis` and `across` on the other axis.
    ///
    /// ```
    /// use osculate_geom::{Axis, Uv, uv};
    /// let on_v_line = Uv::from_axis(Axis::V, 0.2, 7.0);
    /// assert_eq!(on_v_line, uv(7.0, 0.2));
    /// assert_eq!((on_v_line.get(Axis::V), on_v_line.get(Axis::V.other())), (0.2, 7.0));
    /// ```
    #[must_use]
    pub const fn from_axis(axis: Axis, along: f64, across: f64) -> Self {
        match axis {
            Axis::U => uv(along, across),
            Axis::V => uv(across, along),
        }
    }
}

/// One of the two parameters of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// The first parameter varies.
    U,
    /// The second parameter varies.
    V,
}

impl Axis {
    /// The other axis.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::U => Self::V,
            Self::V => Self::U,
        }
    }
}

/// An axis-aligned box, mm. Empty until the first point is added.
///
/// ```
/// use osculate_geom::{Box3, Point3};
/// let mut bounds = Box3::around(&[Point3::new(0.0, 0.0, 0.0), Point3::new(2.0, 3.0, 6.0)]);
/// assert_eq!((bounds.diagonal_mm(), bounds.centre()), (7.0, Point3::new(1.0, 1.5, 3.0)));
/// bounds.add(&Point3::new(-1.0, 1.0, 1.0));
/// assert_eq!(bounds.grown(0.5).min, Point3::new(-1.5, -0.5, -0.5));
/// assert!(Box3::empty().is_empty() && Box3::empty().union(&bounds) == bounds);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Box3 {
    /// Smallest coordinates.
    pub min: Point3,
    /// Largest coordinates.
    pub max: Point3,
}

impl Box3 {
    /// The box that contains nothing.
    #[must_use]
    pub fn empty() -> Self {
        Self { min: Point3::from([f64::INFINITY; 3]), max: Point3::from([f64::NEG_INFINITY; 3]) }
    }

    /// The smallest box around the points.
    #[must_use]
    pub fn around<'a>(points: impl IntoIterator<Item = &'a Point3>) -> Self {
        let mut b = Self::empty();
        for p in points {
            b.add(p);
        }
        b
    }

    /// Grows the box to contain `p`.
    pub fn add(&mut self, p: &Point3) {
        self.min = self.min.inf(p);
        self.max = self.max.sup(p);
    }

    /// The box around both.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        Self { min: self.min.inf(&other.min), max: self.max.sup(&other.max) }
    }

    /// Whether no point was ever added.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.min.x > self.max.x
    }

    /// The middle of the box; NaN for an empty box.
    #[must_use]
    pub fn centre(&self) -> Point3 {
        na::center(&self.min, &self.max)
    }

    /// Length of the diagonal, mm; zero for an empty box.
    #[must_use]
    pub fn diagonal_mm(&self) -> f64 {
        if self.is_empty() { 0.0 } else { (self.max - self.min).norm() }
    }

    /// The box grown by `margin_mm` on every side.
    #[must_use]
    pub fn grown(&self, margin_mm: f64) -> Self {
        let m = Vec3::repeat(margin_mm);
        Self { min: self.min - m, max: self.max + m }
    }
}

/// A unit vector perpendicular to `d`, chosen so that the result is never badly conditioned.
#[must_use]
pub fn any_perpendicular(d: &Unit3) -> Unit3 {
    let k = d.iamin();
    let mut e = Vec3::zeros();
    e[k] = 1.0;
    Unit3::new_normalize(e - d.into_inner() * d[k])
}
