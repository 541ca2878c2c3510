//! The signed distance D(x, s) of a point of a ray at an instant of a piece, with its first and second derivatives in closed form.
//!
//! x is the instant, s the place along the ray; f(s) is the least D over x (see `glide`).

use crate::removal::body::Local;
use osculate_geom::Vec3;

/// D, its derivatives, and where the point is.
#[derive(Clone, Copy)]
pub(super) struct Instant {
    pub x: f64,
    pub local: Local,
    pub by_x: f64,
    pub by_s: f64,
    pub place: Vec3,
    pub rate: Vec3,
}

/// f with a slope, and the x where it is.
#[derive(Clone, Copy)]
pub(super) struct Lowest {
    pub x: f64,
    pub value: f64,
    pub slope: f64,
    /// The second derivative; zero where it is not known or asked for: at kinks, and within the body.
    pub bend: f64,
}

impl Instant {
    /// A direction around the axis, and along the body's meridian: of a second derivative the circle's curvature goes with the one,
    /// the meridian's with the other.
    #[inline]
    fn around_and_along(&self, v: &Vec3) -> [f64; 2] {
        let Self { local, place, .. } = self;
        let rho2 = place.x * place.x + place.y * place.y;
        if rho2 == 0.0 {
            return [0.0; 2];
        }
        let inverse = 1.0 / rho2.sqrt();
        let (out, around) =
            ((place.x * v.x + place.y * v.y) * inverse, (place.x * v.y - place.y * v.x) * inverse);
        [around, local.outwards * rho2 * inverse * v.z - local.by_z * out]
    }

    /// Second derivative of the distance in a direction.
    #[inline]
    pub fn bend_along(&self, v: &Vec3) -> f64 {
        let [around, along] = self.around_and_along(v);
        self.local.outwards * around * around + self.local.bend * along * along
    }

    /// f, where D is least at this x; the ray's direction is as seen from the tool.
    #[inline]
    pub fn lowest(&self, along: &Vec3) -> Lowest {
        Lowest { bend: self.bend(along), ..self.inside() }
    }

    /// The same where the point is within the body, and it does not matter how D bends.
    #[inline]
    pub const fn inside(&self) -> Lowest {
        Lowest { x: self.x, value: self.local.distance, slope: self.by_s, bend: 0.0 }
    }

    /// f'': D_ss - D_xs^2 / D_xx where the least x is free, D_ss at an end.
    #[inline]
    fn bend(&self, along: &Vec3) -> f64 {
        let along = self.around_and_along(along);
        let rate = self.around_and_along(&self.rate);
        let second =
            |a: [f64; 2], b: [f64; 2]| self.local.outwards * a[0] * b[0] + self.local.bend * a[1] * b[1];
        let own = second(along, along);
        let still = second(rate, rate);
        if self.x.abs() >= 0.5 || still <= 0.0 {
            return own;
        }
        let mixed = second(along, rate);
        own - mixed * mixed / still
    }
}
