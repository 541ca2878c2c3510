//! Flat triangles as one surface: what a mesh has of a part.
//!
//! ```text
//! triangle k over 2k <= u <= 2k + 1, 0 <= v <= 1:   S(u, v) = A + v ((C - A) + (u - 2k) (B - C))
//! ```
//!
//! so that S_u x S_v = v (B - A) x (C - A): the natural normal is that from which A, B, C run counter-clockwise. At v = 0 every
//! triangle has a pole, its corner A. Between the triangles, over 2k + 1 < u < 2k + 2, there is no surface: such places are outside
//! ([`Surface::contains`]), and their jets are those of the side next to them with S_u = 0, so that integrals do not count them.

use crate::domain::{Domain, Interval};
use crate::jet::{Jet2, Side};
use crate::point::{Axis, Box3, Point3, Unit3, Uv, Vec3, uv};
use crate::series::Series;
use crate::surface::Surface;
use crate::taylor::Taylor;

/// Flat triangles as one surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Facets {
    triangles: Vec<[Point3; 3]>,
}

/// Corners that are farther from the origin than this belong to no part, mm: a million kilometres.
const FAR_MM: f64 = 1e12;

/// Triangles that make no surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FacetsError {
    /// None at all.
    #[error("there is no triangle")]
    Empty,
    /// A corner that is not finite.
    #[error("triangle {triangle} has a corner that is not finite")]
    NotFinite {
        /// Which, from 0.
        triangle: usize,
    },
    /// A corner so far away that areas and volumes are no numbers any more.
    #[error("triangle {triangle} has a corner more than {FAR_MM:e} mm from the origin")]
    Far {
        /// Which, from 0.
        triangle: usize,
    },
    /// A triangle without a plane.
    #[error("triangle {triangle} has no area")]
    Flat {
        /// Which, from 0.
        triangle: usize,
    },
}

impl Facets {
    /// Triangles, each counter-clockwise seen from outside the material.
    ///
    /// ```
    /// use osculate_geom::{Facets, FacetsError, Point3, Surface};
    /// // A rectangle of 3 x 4 mm as two triangles, counter-clockwise seen from +z, where the tool is.
    /// let p = |x: f64, y: f64| Point3::new(x, y, 0.0);
    /// let mesh = Facets::new(vec![[p(0.0, 0.0), p(3.0, 0.0), p(3.0, 4.0)], [p(0.0, 0.0), p(3.0, 4.0), p(0.0, 4.0)]])?;
    /// assert_eq!((mesh.area_mm2(), mesh.pieces().len()), (12.0, 2));
    /// assert_eq!(mesh.point(Facets::corner(1, 2)), p(0.0, 4.0));
    /// // A sliver without area has no normal.
    /// let flat = [p(0.0, 0.0), p(1.0, 0.0), p(2.0, 0.0)];
    /// assert_eq!(Facets::new(vec![flat]).unwrap_err(), FacetsError::Flat { triangle: 0 });
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`FacetsError`] where there is none, and for one that is not finite or has no area.
    pub fn new(triangles: Vec<[Point3; 3]>) -> Result<Self, FacetsError> {
        if triangles.is_empty() {
            return Err(FacetsError::Empty);
        }
        for (triangle, t) in triangles.iter().enumerate() {
            Self::places(triangle, t)?;
            if Self::normal_of(t).is_none() {
                return Err(FacetsError::Flat { triangle });
            }
        }
        Ok(Self { triangles })
    }

    /// Whether the corners of a triangle, of which the number is given, are places that a part can have.
    ///
    /// # Errors
    /// [`FacetsError`] where one is not finite or too far away.
    pub fn places(triangle: usize, corners: &[Point3; 3]) -> Result<(), FacetsError> {
        if !corners.iter().flat_map(|p| p.iter()).all(|x| x.is_finite()) {
            return Err(FacetsError::NotFinite { triangle });
        }
        if corners.iter().any(|p| p.coords.amax() > FAR_MM) {
            return Err(FacetsError::Far { triangle });
        }
        Ok(())
    }

    /// The triangles.
    #[must_use]
    pub fn triangles(&self) -> &[[Point3; 3]] {
        &self.triangles
    }

    /// The parameters of a corner of a triangle, by its number from 0.
    #[must_use]
    pub fn corner(triangle: usize, corner: usize) -> Uv {
        let first = 2.0 * triangle as f64;
        match corner {
            0 => uv(first, 0.0),
            1 => uv(first + 1.0, 1.0),
            _ => uv(first, 1.0),
        }
    }

    /// Sum of the triangles' areas, mm2.
    #[must_use]
    pub fn area_mm2(&self) -> f64 {
        self.triangles.iter().map(|[a, b, c]| 0.5 * (b - a).cross(&(c - a)).norm()).sum()
    }

    /// The box around them.
    #[must_use]
    pub fn bounds(&self) -> Box3 {
        Box3::around(self.triangles.iter().flatten())
    }

    /// The unit normal from which a triangle runs counter-clockwise; none where it has no area.
    #[must_use]
    pub fn normal_of([a, b, c]: &[Point3; 3]) -> Option<Unit3> {
        // Products of what is very small vanish: sides of length one do not.
        let size = (b - a).amax().max((c - a).amax());
        if !(size > 0.0 && size.is_finite()) {
            return None;
        }
        Unit3::try_new(((b - a) / size).cross(&((c - a) / size)), 0.0)
    }

    /// The triangle of a place, and its own parameters from 0 to 1; whether the place is between two triangles.
    fn place(&self, at: Uv) -> (&[Point3; 3], [f64; 2], bool) {
        // Casting takes what is below zero, or no number, to the first.
        let k = ((0.5 * at.u).floor() as usize).min(self.triangles.len() - 1);
        let s = at.u - 2.0 * k as f64;
        (&self.triangles[k], [s.clamp(0.0, 1.0), at.v.clamp(0.0, 1.0)], s > 1.0)
    }
}

impl Surface for Facets {
    fn domain(&self) -> Domain {
        let last = 2.0 * self.triangles.len() as f64 - 1.0;
        Domain { u: Interval::new(0.0, last), v: Interval::new(0.0, 1.0) }
    }

    fn jet2(&self, at: Uv) -> Jet2 {
        let ([a, b, c], [s, t], between) = self.place(at);
        let along = if between { Vec3::zeros() } else { b - c };
        let dv = (c - a) + (b - c) * s;
        let zero = Vec3::zeros();
        let point = a + dv * t;
        Jet2 { uv: at, point, du: along * t, dv, duu: zero, duv: along, dvv: zero, side: Side::Along }
    }

    fn point(&self, at: Uv) -> Point3 {
        let ([a, b, c], [s, t], _) = self.place(at);
        a + ((c - a) + (b - c) * s) * t
    }

    fn taylor(&self, at: Uv, order: usize) -> Taylor {
        let ([a, b, c], [s, t], between) = self.place(at);
        let u = if between { Series::constant(s, order) } else { Series::variable(Axis::U, s, order) };
        let v = Series::variable(Axis::V, t, order);
        let (ca, bc) = (c - a, b - c);
        let coordinates = std::array::from_fn(|k| {
            Series::constant(a[k], order) + v * (Series::constant(ca[k], order) + u * bc[k])
        });
        Taylor { uv: at, side: Side::Along, coordinates }
    }

    fn contains(&self, at: Uv) -> bool {
        /// Parameters are whole numbers at sides of triangles, and rounding counts in parts of these.
        const SLACK: f64 = 1e-12;
        let d = self.domain();
        d.contains(at) && at.u - 2.0 * (0.5 * at.u).floor() <= 1.0 + SLACK * d.u.hi
    }

    fn breaks(&self, axis: Axis) -> Vec<f64> {
        match axis {
            Axis::U => (0..2 * self.triangles.len()).map(|k| k as f64).collect(),
            Axis::V => vec![0.0, 1.0],
        }
    }

    fn spans(&self, axis: Axis, fixed: f64) -> Vec<Interval> {
        let on = if axis == Axis::U { uv(0.0, fixed) } else { uv(fixed, 0.0) };
        match axis {
            _ if !self.contains(on) => Vec::new(),
            Axis::U => self.pieces().into_iter().map(|d| d.u).collect(),
            Axis::V => vec![self.domain().v],
        }
    }

    fn turns(&self) -> Vec<Uv> {
        (0..self.triangles.len()).flat_map(|k| (0..3).map(move |c| Self::corner(k, c))).collect()
    }

    fn pieces(&self) -> Vec<Domain> {
        let v = self.domain().v;
        let piece = |k: usize| Domain { u: Interval::new(2.0 * k as f64, 2.0 * k as f64 + 1.0), v };
        (0..self.triangles.len()).map(piece).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature;

    fn two() -> Facets {
        let p = |x: f64, y: f64, z: f64| Point3::new(x, y, z);
        let flat = [p(0.0, 0.0, 0.0), p(4.0, 0.0, 0.0), p(0.0, 3.0, 0.0)];
        let wall = [p(0.0, 0.0, 0.0), p(0.0, 0.0, 2.0), p(4.0, 0.0, 0.0)];
        Facets::new(vec![flat, wall]).unwrap()
    }

    #[test]
    fn places_normals_and_area_are_those_of_the_triangles() {
        let f = two();
        for (k, t) in f.triangles().iter().enumerate() {
            for (c, corner) in t.iter().enumerate() {
                assert_eq!(f.point(Facets::corner(k, c)), *corner);
            }
        }
        // 4 x 3 and 4 x 2, halved: the integral over all parameters, those between triangles too, is exact.
        assert!((f.area_mm2() - 10.0).abs() < 1e-12);
        assert!((quadrature::area(&f, 1e-3).value - 10.0).abs() < 1e-12);
        for (u, normal) in [(0.3, Vec3::z()), (2.8, Vec3::y())] {
            let jet = f.jet2(uv(u, 0.4));
            assert!((jet.normal().unwrap().into_inner() - normal).norm() < 1e-15);
            assert!(jet.forms().unwrap().principal().k_max.abs() < 1e-15);
        }
        assert!(!f.contains(uv(1.5, 0.5)) && f.contains(uv(1.0, 0.5)) && f.contains(uv(2.0, 0.5)));
        assert_eq!(f.spans(Axis::U, 0.5), [Interval::new(0.0, 1.0), Interval::new(2.0, 3.0)]);
        assert!(f.spans(Axis::V, 1.5).is_empty());
        assert_eq!(f.bounds(), Box3 { min: Point3::origin(), max: Point3::new(4.0, 3.0, 2.0) });
    }

    #[test]
    fn what_is_no_triangle_is_refused() {
        assert_eq!(Facets::new(Vec::new()), Err(FacetsError::Empty));
        let [a, b, c] = two().triangles()[0];
        assert_eq!(Facets::new(vec![[a, b, a + (b - a) * 2.0]]), Err(FacetsError::Flat { triangle: 0 }));
        let far = Point3::new(f64::NAN, 0.0, 0.0);
        assert_eq!(Facets::new(vec![[a, b, c], [a, b, far]]), Err(FacetsError::NotFinite { triangle: 1 }));
        let [a, b, c] = two().triangles()[0].map(|p| Point3::from(p.coords * 1e13));
        assert_eq!(Facets::new(vec![[a, b, c]]), Err(FacetsError::Far { triangle: 0 }));
        // A triangle of a picometre is one all the same.
        assert!(Facets::new(vec![[a, b, c].map(|p| Point3::from(p.coords * 1e-213))]).is_ok());
    }
}
