//! Raw material that is left, as points of its surface, and which pass takes each of them away.
//!
//! *Limits.* What passes lay bare within the material is not seen, nor what is thinner than the points are apart: whether a rapid move
//! meets material is decided elsewhere, exactly. Here it decides where moves are fed from the start.

use super::tree::{Dot, Dots};
use crate::plan::Pass;
use osculate_geom::{Point3, Vec3};
use osculate_tools::sweep::{LinearMotion, SweptMotion};
use osculate_tools::{Cutter, Pose};

/// Distance of poses along a pass at which it takes points away, in radii of the cutter.
const STEP: f64 = 0.5;
/// Not taken away by any pass.
const STAYS: u32 = u32::MAX;

/// Points of the surface of raw material.
pub(super) struct Left {
    dots: Dots,
    /// The pass that takes each away, and the last that takes one of each ball away.
    taken: Vec<u32>,
    last: Vec<u32>,
}

impl Left {
    /// Points that passes take away with a cutter, in their order.
    pub fn new(points: &[Point3], passes: &[Pass], cutter: &Cutter) -> Self {
        let dots = Dots::new(points.iter().map(|p| Dot { at: *p, normal: Vec3::z_axis() }).collect());
        let mut out = Self { taken: vec![STAYS; dots.len()], last: Vec::new(), dots };
        for (pass, k) in passes.iter().zip(0u32..) {
            for w in pass.points.windows(2) {
                let motion = LinearMotion { from: w[0].pose, to: w[1].pose };
                let length = (w[1].pose.tip - w[0].pose.tip).norm();
                // A pass has no gaps: lengths are finite.
                let steps = (length / (STEP * cutter.radius_mm())).ceil().max(1.0) as u32;
                for i in 0..=steps {
                    if let Some(now) = motion.at(f64::from(i) / f64::from(steps)) {
                        out.take(cutter, &now.pose, k);
                    }
                }
            }
        }
        out.last = out.dots.greatest(&out.taken);
        out
    }

    fn take(&mut self, cutter: &Cutter, pose: &Pose, pass: u32) {
        let taken = &mut self.taken;
        self.dots.each((cutter, pose), 0.0, &|_| true, &mut |dot| {
            taken[dot] = taken[dot].min(pass);
            false
        });
    }

    /// Whether material is nearer to a body than so much when a pass begins.
    pub fn is_within(&self, posed: (&Cutter, &Pose), within_mm: f64, pass: u32) -> bool {
        let stands = |k: u32| k >= pass;
        self.dots.each(posed, within_mm, &|ball| stands(self.last[ball]), &mut |dot| stands(self.taken[dot]))
    }
}
