//! Orientation by two rotary axes: `R(b, beta) R(a, alpha) u = w` for any directions.
//!
//! `b` is the outer axis (nearer the part), `a` the inner one, `u` the tool axis with both at zero, `w` the wanted
//! tool axis. The vector between, `v = R(a, alpha) u = R(b, -beta) w`, has `v.a = u.a` and `v.b = w.b`; with
//! `c = a.b` it is
//!
//! ```text
//! v = x a + y b + z (a x b),   x = (u.a - c w.b) / (1 - c^2),   y = (w.b - c u.a) / (1 - c^2),
//! z^2 = (1 - x^2 - y^2 - 2 x y c) / (1 - c^2)
//! ```
//!
//! The two signs of z are the two branches. They meet where `z = 0`: at the border of what can be reached, and at a
//! **pole**, where `w` lies along `b` and `beta` is free. Source: Paden and Kahan's second subproblem, for directions.

use osculate_geom::{Unit3, Vec3};

/// Two axes with an angle between them below this sine are one axis to the arithmetic: the formulas divide by its
/// square, and no machine has axes that close.
const SMALLEST_SINE: f64 = 1e-3;

/// How far outside the reachable cone a wanted axis may lie and still count as on its border, rad. CL axes carry nine
/// decimals; rounding of unit vectors and of 1 - cos near a border stays below this.
pub(crate) const REACH_TOLERANCE_RAD: f64 = 1e-7;

/// One solution: the angles in (-pi, pi].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Angles {
    /// About the outer axis, rad.
    pub outer_rad: f64,
    /// About the inner axis, rad.
    pub inner_rad: f64,
}

/// Both solutions for one tool axis.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Solutions {
    /// The branches with z > 0 and z < 0, in this order; equal where they meet.
    pub branches: [Angles; 2],
    /// Angle between the wanted axis and the nearer pole direction, rad. Where it is zero the outer angle is free
    /// and reported as zero.
    pub pole_rad: f64,
}

/// The wanted tool axis lies outside of what the two axes reach.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the tool axis is {:.4} deg outside of what the rotary axes reach", off_rad.to_degrees())]
#[non_exhaustive]
pub struct AxisUnreachable {
    /// Angle to the nearest axis that can be reached, rad.
    pub off_rad: f64,
}

/// Why two directions do not orient a tool.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TwoAxisError {
    /// The rotary axes are parallel.
    #[error(
        "the two rotary axes are parallel (sine of the angle between them {sine:.2e}): give one another direction"
    )]
    ParallelAxes {
        /// Sine of the angle between them.
        sine: f64,
    },
    /// The inner rotary axis is the tool axis.
    #[error(
        "the rotary axis next to the tool lies along the tool (sine {sine:.2e}): it turns nothing, give it another \
         direction or leave it out"
    )]
    AlongTool {
        /// Sine of the angle between them.
        sine: f64,
    },
}

/// The directions of a two-axis orienting mechanism.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoAxis {
    outer: Unit3,
    inner: Unit3,
    tool: Unit3,
    /// Smallest and largest angle between a reachable tool axis and the outer axis, rad.
    reach_rad: [f64; 2],
}

impl TwoAxis {
    /// A mechanism of these unit directions, all three in one frame, with both angles at zero.
    ///
    /// ```
    /// use osculate_geom::Vec3;
    /// use osculate_postproc::machine::{TwoAxis, TwoAxisError};
    ///
    /// let (x, z) = (Vec3::x_axis(), Vec3::z_axis());
    /// assert!(TwoAxis::new(z, x, z).is_ok());
    /// // A rotation about the tool itself does not turn its axis.
    /// assert!(matches!(TwoAxis::new(x, z, z), Err(TwoAxisError::AlongTool { .. })));
    /// ```
    ///
    /// # Errors
    /// Where the axes are parallel to each other, or the inner one to the tool.
    pub fn new(outer: Unit3, inner: Unit3, tool: Unit3) -> Result<Self, TwoAxisError> {
        let sine = outer.cross(&inner).norm();
        if sine < SMALLEST_SINE {
            return Err(TwoAxisError::ParallelAxes { sine });
        }
        let sine = inner.cross(&tool).norm();
        if sine < SMALLEST_SINE {
            return Err(TwoAxisError::AlongTool { sine });
        }
        // The reachable axes make an angle with b between |ab - ua| and pi - |pi - ab - ua|.
        let (ab, ua) = (angle(&inner, &outer), angle(&tool, &inner));
        let pi = std::f64::consts::PI;
        Ok(Self { outer, inner, tool, reach_rad: [(ab - ua).abs(), pi - (pi - ab - ua).abs()] })
    }

    /// The tool axis at the given angles.
    #[must_use]
    pub fn axis(&self, angles: &Angles) -> Unit3 {
        let v = rotate(&self.inner, angles.inner_rad, &self.tool);
        Unit3::new_normalize(rotate(&self.outer, angles.outer_rad, &v))
    }

    /// Both branches for the wanted axis.
    ///
    /// ```
    /// use osculate_geom::{Unit3, Vec3};
    /// use osculate_postproc::machine::TwoAxis;
    ///
    /// // A nutated head: the inner axis lies 45 deg between the outer one and the tool, which thus reaches a half sphere.
    /// let inner = Unit3::new_normalize(Vec3::new(0.0, 1.0, 1.0));
    /// let head = TwoAxis::new(Vec3::z_axis(), inner, Vec3::z_axis())?;
    /// let wanted = Unit3::new_normalize(Vec3::new(0.6, 0.0, 0.8));
    /// for branch in head.solve(&wanted)?.branches {
    ///     assert!((head.axis(&branch).into_inner() - wanted.into_inner()).norm() < 1e-12);
    /// }
    /// // By so much a tool from below is out of reach.
    /// let below = head.solve(&-Vec3::z_axis()).expect_err("it reaches the upper half");
    /// assert!((below.off_rad.to_degrees() - 90.0).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`AxisUnreachable`] with the angle by which the wanted axis is out of reach.
    pub fn solve(&self, wanted: &Unit3) -> Result<Solutions, AxisUnreachable> {
        let (a, b, u, w) = (&self.inner, &self.outer, &self.tool, wanted);
        let wb = angle(w, b);
        let off_rad = (self.reach_rad[0] - wb).max(wb - self.reach_rad[1]).max(0.0);
        if off_rad > REACH_TOLERANCE_RAD {
            return Err(AxisUnreachable { off_rad });
        }
        let normal = a.cross(b);
        let (c, s2) = (a.dot(b), normal.norm_squared());
        let x = (u.dot(a) - c * w.dot(b)) / s2;
        let y = (w.dot(b) - c * u.dot(a)) / s2;
        let z2 = (1.0 - x * x - y * y - 2.0 * x * y * c) / s2;
        // On the border z^2 is a difference of nearly equal numbers; a negative rest is the border itself.
        let z = z2.max(0.0).sqrt();
        let branch = |z: f64| {
            let v = a.into_inner() * x + b.into_inner() * y + normal * z;
            Angles { outer_rad: angle_about(b, &v, w), inner_rad: angle_about(a, u, &v) }
        };
        let pole_rad = wb.min(std::f64::consts::PI - wb);
        Ok(Solutions { branches: [branch(z), branch(-z)], pole_rad })
    }

    /// The inner angle that brings the tool nearest to the wanted axis when the outer one is given.
    #[must_use]
    pub fn inner_for(&self, outer_rad: f64, wanted: &Unit3) -> f64 {
        let v = rotate(&self.outer, -outer_rad, wanted);
        angle_about(&self.inner, &self.tool, &v)
    }

    /// The pole direction: the axis along which the outer angle is free, up to sign.
    #[must_use]
    pub const fn pole(&self) -> Unit3 {
        self.outer
    }
}

/// The angle between two directions, exact near 0 and pi.
fn angle(p: &Vec3, q: &Vec3) -> f64 {
    p.cross(q).norm().atan2(p.dot(q))
}

/// `v` turned right-handed about `axis`.
pub(crate) fn rotate(axis: &Unit3, angle_rad: f64, v: &Vec3) -> Vec3 {
    let (s, c) = angle_rad.sin_cos();
    v * c + axis.cross(v) * s + axis.into_inner() * (axis.dot(v) * (1.0 - c))
}

/// The angle about `axis` that turns the part of `from` across the axis onto that of `to`; zero where one vanishes.
pub(crate) fn angle_about(axis: &Unit3, from: &Vec3, to: &Vec3) -> f64 {
    let p = from - axis.into_inner() * axis.dot(from);
    let q = to - axis.into_inner() * axis.dot(to);
    axis.dot(&p.cross(&q)).atan2(p.dot(&q))
}
