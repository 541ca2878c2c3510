//! First and second fundamental form, principal and normal curvature.
//!
//! Sign: **positive curvature is a convex body**, `k(d) = -II(d, d) / I(d, d)` with the outward normal, so a ball of
//! radius R has k = 1/R and a hole has k < 0 (Radzevich's convention; Marciniak's kappa is -k).

use crate::jet::Jet2;
use crate::point::{Unit3, Uv, Vec3, any_perpendicular, uv};
use nalgebra::Matrix2;

/// No tangent plane: the partial derivatives are parallel or vanish. The surface may still have one:
/// [`limit::forms`](crate::limit::forms) says.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "the surface has no tangent plane at u = {}, v = {}: |S_u x S_v| is {sin_uv:.3e} of |S_u| |S_v|", at.u, at.v
)]
pub struct Degenerate {
    /// Where.
    pub at: Uv,
    /// Sine of the angle between S_u and S_v; zero where one of them vanishes.
    pub sin_uv: f64,
}

/// Smallest sine of the angle between S_u and S_v that still counts as a tangent plane. Below it the normal keeps
/// fewer than five of double precision's sixteen digits.
pub(crate) const MIN_SIN_UV: f64 = 1e-11;

/// The outward unit normal, and the length of S_u.
#[inline]
pub(crate) fn normal_of(jet: &Jet2) -> Result<(Unit3, f64), Degenerate> {
    let cross = jet.du.cross(&jet.dv);
    let (a, b) = (jet.du.norm(), jet.dv.norm());
    let area = cross.norm();
    let sin_uv = if a > 0.0 && b > 0.0 { area / (a * b) } else { 0.0 };
    // The negated comparison also catches NaN.
    if !(sin_uv > MIN_SIN_UV && sin_uv.is_finite()) {
        return Err(Degenerate { at: jet.uv, sin_uv });
    }
    // One division: the length is known and not zero.
    Ok((Unit3::new_unchecked(cross * (jet.side.sign() / area)), a))
}

impl Jet2 {
    /// The outward unit normal.
    ///
    /// # Errors
    /// [`Degenerate`] where S_u and S_v are parallel or vanish.
    pub fn normal(&self) -> Result<Unit3, Degenerate> {
        Ok(normal_of(self)?.0)
    }

    /// First and second fundamental form with the outward normal.
    ///
    /// # Errors
    /// [`Degenerate`] where S_u and S_v are parallel or vanish.
    pub fn forms(&self) -> Result<Forms, Degenerate> {
        Forms::of(self)
    }
}

/// Both fundamental forms at a point, in the parameter basis and in an orthonormal tangent frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Forms {
    /// `[E, F, G]`.
    pub first: [f64; 3],
    /// `[L, M, N]` with the outward normal: negative along a convex direction.
    pub second: [f64; 3],
    /// The outward unit normal.
    pub normal: Unit3,
    /// Orthonormal tangent frame: `e1` along S_u, `e2 = n x e1`.
    pub frame: [Unit3; 2],
    /// The curvature matrix W in `frame`, convex positive: `k(d) = d^T W d`.
    pub curvature: Matrix2<f64>,
}

impl Forms {
    pub(crate) fn of(jet: &Jet2) -> Result<Self, Degenerate> {
        let (su, sv) = (jet.du, jet.dv);
        let (normal, a) = normal_of(jet)?;
        let e1 = Unit3::new_unchecked(su * (1.0 / a));
        let e2 = Unit3::new_unchecked(normal.cross(&e1));
        // S_u = a e1, S_v = p e1 + q e2. The second derivatives' normal parts, carried over to the frame, give W
        // without the cancellation of H^2 - K.
        let (p, q) = (sv.dot(&e1), sv.dot(&e2));
        let (l, m, n) = (jet.duu.dot(&normal), jet.duv.dot(&normal), jet.dvv.dot(&normal));
        let w11 = l / (a * a);
        let w12 = (m / a - p * w11) / q;
        let w22 = (n - 2.0 * p * q * w12 - p * p * w11) / (q * q);
        Ok(Self {
            first: [su.dot(&su), su.dot(&sv), sv.dot(&sv)],
            second: [l, m, n],
            normal,
            frame: [e1, e2],
            curvature: -Matrix2::new(w11, w12, w12, w22),
        })
    }

    /// Principal curvatures and directions.
    #[must_use]
    pub fn principal(&self) -> Principal {
        let eig = SymEigen::of(&self.curvature);
        let dir = |c: [f64; 2]| {
            // Unit to rounding: both are perpendicular unit vectors, and so is c.
            Unit3::new_unchecked(self.frame[0].into_inner() * c[0] + self.frame[1].into_inner() * c[1])
        };
        Principal { k_max: eig.max, k_min: eig.min, d_max: dir(eig.d_max), d_min: dir(eig.d_min) }
    }

    /// Normal curvature in the direction of a tangent vector, 1/mm, convex positive (Euler).
    ///
    /// ```
    /// use osculate_geom::{Interval, Surface, Vec3, analytic::Cylinder, uv};
    /// // A shaft of radius 25 mm along z, at its side x = 25: around it, along it, and half way between.
    /// let shaft = Cylinder::new(25.0, Interval::new(0.0, 80.0))?;
    /// let forms = shaft.jet2(uv(0.0, 40.0)).forms()?;
    /// let k = [Vec3::y(), Vec3::z(), Vec3::new(0.0, 1.0, 1.0)].map(|d| forms.normal_curvature(&d));
    /// for (got, want) in k.into_iter().zip([1.0 / 25.0, 0.0, 0.5 / 25.0]) {
    ///     assert!((got - want).abs() < 1e-15);
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn normal_curvature(&self, direction: &Vec3) -> f64 {
        let c = self.components(direction);
        let w = &self.curvature;
        w[(0, 0)] * c[0] * c[0] + 2.0 * w[(0, 1)] * c[0] * c[1] + w[(1, 1)] * c[1] * c[1]
    }

    /// Geodesic torsion in the direction of a tangent vector d, 1/mm: the component of W between d and `n x d`.
    #[must_use]
    pub fn geodesic_torsion(&self, direction: &Vec3) -> f64 {
        let c = self.components(direction);
        let w = &self.curvature;
        (w[(1, 1)] - w[(0, 0)]) * c[0] * c[1] + w[(0, 1)] * (c[0] * c[0] - c[1] * c[1])
    }

    /// Mean curvature H, 1/mm: 1/R on a sphere's outside.
    #[must_use]
    pub fn mean(&self) -> f64 {
        0.5 * self.curvature.trace()
    }

    /// Gaussian curvature K, 1/mm2.
    ///
    /// ```
    /// use osculate_geom::{Surface, analytic::Torus, uv};
    /// // Inside of a ring a saddle, on top of it a parabolic place.
    /// let ring = Torus::new(200.0, 60.0)?;
    /// let k = |v: f64| ring.jet2(uv(0.0, v)).forms().map(|f| f.gauss());
    /// assert!((k(std::f64::consts::PI)? + 1.0 / (60.0 * 140.0)).abs() < 1e-15);
    /// assert!(k(std::f64::consts::FRAC_PI_2)?.abs() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn gauss(&self) -> f64 {
        self.curvature.determinant()
    }

    /// Area of the parameter unit square, `sqrt(EG - F^2)`.
    #[must_use]
    pub fn area_density(&self) -> f64 {
        let [e, f, g] = self.first;
        (e * g - f * f).max(0.0).sqrt()
    }

    /// The parameter rate whose tangent vector is `direction`.
    #[must_use]
    pub fn rate(&self, jet: &Jet2, direction: &Vec3) -> Uv {
        let a = jet.du.norm();
        let (p, q) = (jet.dv.dot(&self.frame[0]), jet.dv.dot(&self.frame[1]));
        let rv = direction.dot(&self.frame[1]) / q;
        uv((direction.dot(&self.frame[0]) - p * rv) / a, rv)
    }

    /// Components of the unit vector along `direction` in the tangent frame.
    fn components(&self, direction: &Vec3) -> [f64; 2] {
        let (x, y) = (direction.dot(&self.frame[0]), direction.dot(&self.frame[1]));
        let r = x.hypot(y);
        [x / r, y / r]
    }
}

/// Principal curvatures, convex positive, with `k_max >= k_min`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Principal {
    /// The most convex normal curvature, 1/mm.
    pub k_max: f64,
    /// The least convex (most concave) normal curvature, 1/mm.
    pub k_min: f64,
    /// Direction of `k_max`; arbitrary at an umbilic.
    pub d_max: Unit3,
    /// Direction of `k_min`, `n x d_max` up to sign.
    pub d_min: Unit3,
}

impl Principal {
    /// Normal curvature at an angle from `d_max`, 1/mm, by Euler's formula `k_max cos^2 + k_min sin^2` [R97, eq. 47].
    ///
    /// ```
    /// use osculate_geom::{Surface, analytic::Torus, uv};
    /// // At 45 degrees to the principal directions: the mean of both curvatures.
    /// let forms = Torus::new(200.0, 60.0)?.jet2(uv(0.0, 0.0)).forms()?;
    /// let k = forms.principal().euler(45f64.to_radians());
    /// assert!((k - forms.mean()).abs() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn euler(&self, angle_rad: f64) -> f64 {
        let (s, c) = angle_rad.sin_cos();
        self.k_max * c * c + self.k_min * s * s
    }
}

/// Eigenvalues and unit eigenvectors of a symmetric 2x2 matrix, without cancellation near equal eigenvalues.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SymEigen {
    /// Larger eigenvalue.
    pub max: f64,
    /// Smaller eigenvalue.
    pub min: f64,
    /// Unit eigenvector of `max`.
    pub d_max: [f64; 2],
    /// Unit eigenvector of `min`, `d_max` turned by +90 degrees.
    pub d_min: [f64; 2],
}

impl SymEigen {
    /// The eigen-decomposition of the symmetric part that `m` stores in its upper triangle.
    #[must_use]
    pub fn of(m: &Matrix2<f64>) -> Self {
        let (a, b, c) = (m[(0, 0)], m[(0, 1)], m[(1, 1)]);
        let mean = 0.5 * (a + c);
        let half = 0.5 * (a - c);
        let radius = length(half, b);
        // Twice the angle of d_max has cosine half/radius and sine b/radius. The larger of the angle's own
        // cosine and sine comes from a sum without cancellation, the other one from sin 2x = 2 sin x cos x.
        let (s, co) = if radius > 0.0 {
            let large = (0.5 * (1.0 + (half / radius).abs())).sqrt();
            let small = 0.5 * b / (radius * large);
            if half >= 0.0 { (small, large) } else { (large.copysign(b), small.abs()) }
        } else {
            (0.0, 1.0)
        };
        Self { max: mean + radius, min: mean - radius, d_max: [co, s], d_min: [-s, co] }
    }
}

/// `sqrt(x^2 + y^2)`, by `hypot` only where the squares leave the number range: it costs as much as all the rest.
#[inline]
fn length(x: f64, y: f64) -> f64 {
    let square = x * x + y * y;
    if square > 1e-280 && square < 1e280 { square.sqrt() } else { x.hypot(y) }
}

/// The unit tangent nearest to `wanted`, or any tangent where `wanted` is along the normal.
#[must_use]
pub fn project_to_tangent(normal: &Unit3, wanted: &Vec3) -> Unit3 {
    let t = wanted - normal.into_inner() * wanted.dot(normal);
    Unit3::try_new(t, 1e-12 * wanted.norm()).unwrap_or_else(|| any_perpendicular(normal))
}
