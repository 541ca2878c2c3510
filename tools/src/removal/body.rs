//! The rigid bodies that move: the cutter, and the sections of the holder above it.
//!
//! All are convex bodies of revolution about the tool axis, so their signed distance is a convex function of
//! the point with slope at most one. Every bound of this module rests on these two facts.

use super::job::Job;
use crate::cutter::Cutter;
use crate::holder::Holder;
use osculate_geom::Vec3;

/// A body of revolution whose lower end is `above_mm` up the axis from the tool tip.
#[derive(Clone, Copy)]
pub(super) struct Body<'a> {
    pub cutter: &'a Cutter,
    pub above_mm: f64,
    /// Which of the tools has it.
    pub tool: usize,
    /// Whether it counts among what intrudes although it cuts.
    pub intrudes: bool,
}

/// Signed distance, mm, and a subgradient of it (length at most one) in the frame of the arguments.
#[derive(Clone, Copy)]
pub(super) struct Near {
    pub distance: f64,
    pub gradient: Vec3,
}

/// Signed distance in the half plane of a meridian.
#[derive(Clone, Copy)]
pub(super) struct Local {
    /// Millimetres.
    pub distance: f64,
    /// Derivative of the distance by rho, over rho; zero on the axis.
    pub outwards: f64,
    /// Derivative of the distance by z.
    pub by_z: f64,
    /// Curvature of the curve of equal distance in the half plane, 1/mm.
    pub bend: f64,
}

impl<'a> Body<'a> {
    /// The cutters of a job in the order of its tools, each with its holder where it has one.
    pub fn all(job: &Job<'a>) -> Vec<Self> {
        let mut bodies = Vec::with_capacity(2 * (1 + job.changes.len()));
        let first = (job.cutter, job.holder);
        let tools = std::iter::once(first).chain(job.changes.iter().map(|c| (c.cutter, c.holder)));
        for (tool, (cutter, holder)) in tools.enumerate() {
            bodies.push(Self { cutter, above_mm: 0.0, tool, intrudes: false });
            for section in holder.map(Holder::sections).unwrap_or_default() {
                let above_mm = cutter.length_mm() + section.above_mm;
                bodies.push(Self { cutter: &section.body, above_mm, tool, intrudes: true });
            }
        }
        bodies
    }

    /// Whether it is what cuts: all others sit above it.
    pub fn cuts(&self) -> bool {
        self.above_mm == 0.0
    }
}

impl Body<'_> {
    /// Distance from a point at `from_tip` of the tool tip to the body with unit `axis`.
    ///
    /// Equal to [`Cutter::distance`]; beyond the upper end it is a lower bound, which still is convex.
    #[inline]
    pub fn near(&self, from_tip: &Vec3, axis: &Vec3) -> Near {
        let along = from_tip.dot(axis);
        let radial = from_tip - axis * along;
        let Local { distance, outwards, by_z, .. } = self.local(radial.norm(), along);
        Near { distance, gradient: radial * outwards + axis * by_z }
    }

    /// The same for a point `rho` from the axis and `along` above the tool tip.
    #[inline]
    pub fn local(&self, rho: f64, along: f64) -> Local {
        let z = along - self.above_mm;
        let over = z - self.cutter.length_mm();
        let top = Local { distance: over, outwards: 0.0, by_z: 1.0, bend: 0.0 };
        if let Some(meridian) = self.cutter.meridian() {
            let near = meridian.near(rho, z);
            // On the axis every radial slope up to the meridian's own is a subgradient: zero is.
            let outwards = if rho > 0.0 { near.by_rho / rho } else { 0.0 };
            let side = Local { distance: near.distance, outwards, by_z: near.by_z, bend: near.bend };
            return if over > side.distance { top } else { side };
        }
        let corner = self.cutter.corner_mm();
        let (x, y) = (rho - self.cutter.core_mm(), corner - z);
        let end = if x > 0.0 && y > 0.0 {
            // Millimetres neither overflow nor underflow: the plain form, several times faster than hypot,
            // and one division in place of six. x > 0 has rho > 0.
            let r = (x * x + y * y).sqrt();
            let inverse = 1.0 / (r * rho);
            let bend = rho * inverse;
            Local { distance: r - corner, outwards: x * inverse, by_z: -y * bend, bend }
        } else if x >= y {
            // On the axis every radial slope up to one is a subgradient: zero is.
            let outwards = if rho > 0.0 { 1.0 / rho } else { 0.0 };
            Local { distance: x - corner, outwards, by_z: 0.0, bend: 0.0 }
        } else {
            Local { distance: y - corner, outwards: 0.0, by_z: -1.0, bend: 0.0 }
        };
        if over > end.distance { top } else { end }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CutterSpec, Pose};
    use osculate_geom::{Point3, Unit3};
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]
        /// The distance is the cutter's own, and the gradient supports it: |g| <= 1 and
        /// d(q) >= d(p) + g . (q - p).
        #[test]
        fn gradient_supports_the_distance(
            kind in 0usize..4,
            r in 0.0..=1.0f64,
            p in prop::array::uniform3(-20.0..20.0f64),
            q in prop::array::uniform3(-20.0..20.0f64),
            a in prop::array::uniform3(-1.0..1.0f64)
        ) {
            let Some(axis) = Unit3::try_new(Vec3::from(a), 0.1) else { return Ok(()) };
            let corner_radius_mm = 5.0 * r;
            let (diameter_mm, length_mm) = (10.0, 12.0);
            let spec = match kind {
                0 => CutterSpec::Toroidal { diameter_mm, corner_radius_mm, length_mm },
                1 => {
                    let (taper_deg, corner_radius_mm) = (40.0, 0.2 * corner_radius_mm);
                    CutterSpec::Cone { diameter_mm, taper_deg, corner_radius_mm, tip_diameter_mm: None, length_mm }
                }
                2 => {
                    let (barrel_radius_mm, corner_radius_mm) = (10.0 + 2.0 * r, 1.0 + 3.0 * r);
                    CutterSpec::Barrel { diameter_mm, barrel_radius_mm, corner_radius_mm, length_mm }
                }
                _ => {
                    let (bottom_angle_deg, side_angle_deg) = (30.0 * r, 10.0 - 20.0 * r);
                    let corner_radius_mm = 0.5 * corner_radius_mm;
                    CutterSpec::Apt { diameter_mm, corner_radius_mm, bottom_angle_deg, side_angle_deg, length_mm }
                }
            };
            let cutter = Cutter::try_from(spec).unwrap();
            let body = Body { cutter: &cutter, above_mm: 3.0, tool: 0, intrudes: false };
            let (p, q) = (Vec3::from(p), Vec3::from(q));
            let (at_p, at_q) = (body.near(&p, &axis), body.near(&q, &axis));
            let pose = Pose { tip: Point3::origin() + axis.into_inner() * 3.0, axis };
            // Rounding of coordinates of size 20.
            prop_assert!((at_p.distance - cutter.distance(&pose, &Point3::from(p))).abs() < 1e-13);
            prop_assert!(at_p.gradient.norm() < 1.0 + 1e-12);
            prop_assert!(at_q.distance >= at_p.distance + at_p.gradient.dot(&(q - p)) - 1e-12);
        }
    }
}
