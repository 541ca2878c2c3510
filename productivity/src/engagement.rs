//! What a cutter takes out of real stock at an instant: the volume rate of its engagement [R97, eqs. 23 to 30].
//!
//! The surface of cutting C is the part of the cutter's surface T that lies in material and moves into it. Through an element
//! of it with outward normal g and velocity v flows `g . v dA` of material, so that
//!
//! ```text
//! E_R(t) = int over C of (g . v) dA = int I(psi) d psi      I(psi) = int rho (g . v) ds along the meridian at psi
//! ```
//!
//! psi is the angle about the axis. The first form is that of a continuous surface [R97, eqs. 23, 24, 27, 28]. With m teeth each
//! edge takes, as it passes psi, the chip that the feed has put there since the tooth before: `2 pi / m` of I, so that
//! `E_R(t) = (2 pi / m) sum I(psi_j(t))` over the teeth in cut [R97, eqs. 25 to 30]; its mean over a turn is the first form.
//!
//! *Errors.* Along a meridian ends of the engagement are interpolated linearly between nodes, in psi the midpoint rule is used:
//! the error falls with the square of both steps. Edges stand for meridians (no helix), the feed is slow against the cutting
//! speed.

use osculate_geom::{Point3, any_perpendicular};
use osculate_tools::Cutter;
use osculate_tools::sweep::{Moving, SweptMotion};
use std::f64::consts::TAU;

/// How finely the cutter's surface is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fineness {
    /// Meridians around the axis.
    pub meridians: usize,
    /// Longest step along a meridian, mm.
    pub step_mm: f64,
}

/// The engagement at an instant.
#[derive(Clone, Debug, PartialEq)]
pub struct Engagement {
    /// I(psi) at equal steps of psi, the first half a step from the direction `any_perpendicular` of the axis, right-handed; mm3
    /// per unit of the motion's parameter and rad.
    by_angle: Vec<f64>,
}

/// A cutter's outline cut into steps, ready for many instants.
///
/// ```
/// use osculate_geom::{Point3, Vec3};
/// use osculate_productivity::engagement::{Fineness, Outline};
/// use osculate_tools::{Cutter, CutterSpec, Pose, sweep::Moving};
///
/// // A flat end of 10 mm, 3 mm deep in material below z = 3, at 200 mm a minute: 10 x 3 x 200 mm3 a minute of a slot.
/// let end = Cutter::try_from(CutterSpec::Flat { diameter_mm: 10.0, length_mm: 30.0 })?;
/// let outline = Outline::new(&end, Fineness { meridians: 360, step_mm: 0.05 });
/// let pose = Pose { tip: Point3::origin(), axis: Vec3::z_axis() };
/// let moving = Moving { pose, tip_rate: Vec3::new(200.0, 0.0, 0.0), turn: Vec3::zeros() };
/// let slot = outline.engaged(&moving, |p| 3.0 - p.z);
/// assert!((slot.rate() / 6000.0 - 1.0).abs() < 1e-3);
/// // Its front half is in cut.
/// assert!((slot.arc_rad() - std::f64::consts::PI).abs() < 0.02);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// (rho, z) from the tip upwards, mm.
    nodes: Vec<[f64; 2]>,
    meridians: usize,
}

/// Turn of the outline on an arc from node to node, at least and at most: areas are good to its square over 24.
const TURN_RAD: [f64; 2] = [0.02, 0.25];

impl Outline {
    /// The outline of a cutter.
    #[must_use]
    pub fn new(cutter: &Cutter, fineness: Fineness) -> Self {
        let turn_rad = (fineness.step_mm / cutter.corner_mm()).clamp(TURN_RAD[0], TURN_RAD[1]);
        let corners = cutter.outline_mm(turn_rad);
        let mut nodes: Vec<[f64; 2]> = Vec::with_capacity(corners.len());
        for pair in corners.windows(2) {
            let [a, b] = [pair[0], pair[1]];
            let length = (b[0] - a[0]).hypot(b[1] - a[1]);
            // Steps of nothing or of no number mean one step.
            let cuts = (length / fineness.step_mm).ceil().clamp(1.0, 1e4) as usize;
            for k in 0..cuts {
                let f = k as f64 / cuts as f64;
                nodes.push([a[0] + (b[0] - a[0]) * f, a[1] + (b[1] - a[1]) * f]);
            }
        }
        nodes.extend(corners.last());
        Self { nodes, meridians: fineness.meridians.max(8) }
    }

    /// The engagement at an instant with material where `depth_mm` is positive: a continuous function, near its zeros the
    /// distance to the boundary of the material.
    pub fn engaged(&self, moving: &Moving, mut depth_mm: impl FnMut(&Point3) -> f64) -> Engagement {
        let axis = moving.pose.axis.into_inner();
        let e1 = any_perpendicular(&moving.pose.axis).into_inner();
        let e2 = axis.cross(&e1);
        let by_angle = (0..self.meridians).map(|k| {
            let (s, c) = (TAU * (k as f64 + 0.5) / self.meridians as f64).sin_cos();
            let out = e1 * c + e2 * s;
            let point = |n: [f64; 2]| moving.pose.tip + out * n[0] + axis * n[1];
            let mut sum = 0.0;
            // The depth at a node, where it was asked for.
            let mut last: Option<f64> = None;
            for pair in self.nodes.windows(2) {
                let [from, node] = [pair[0], pair[1]];
                let (drho, dz) = (node[0] - from[0], node[1] - from[1]);
                let normal = out * dz - axis * drho;
                let into = |at: [f64; 2]| {
                    normal.dot(&(moving.tip_rate + moving.turn.cross(&(point(at) - moving.pose.tip))))
                };
                // Where neither end moves outward nothing between them does.
                if into(from) <= 0.0 && into(node) <= 0.0 {
                    last = None;
                    continue;
                }
                let before = last.unwrap_or_else(|| depth_mm(&point(from)));
                let depth = depth_mm(&point(node));
                last = Some(depth);
                {
                    // The stretch in material, as shares of the step.
                    let cross = before / (before - depth);
                    let [lo, hi] = match (before > 0.0, depth > 0.0) {
                        (true, true) => [0.0, 1.0],
                        (true, false) => [0.0, cross],
                        (false, true) => [cross, 1.0],
                        (false, false) => [0.0, 0.0],
                    };
                    let middle = 0.5 * (lo + hi);
                    let at = [from[0] + drho * middle, from[1] + dz * middle];
                    // Outward: the meridian goes up from the tip.
                    sum += (hi - lo) * at[0] * into(at).max(0.0);
                }
            }
            sum
        });
        Engagement { by_angle: by_angle.collect() }
    }

    /// Volume taken between two values of the motion's parameter, by the trapezium rule over `steps` steps, mm3.
    ///
    /// None where the motion is not defined all the way.
    pub fn volume_mm3(
        &self,
        motion: &impl SweptMotion,
        [from, to]: [f64; 2],
        steps: usize,
        mut depth_mm: impl FnMut(f64, &Point3) -> f64,
    ) -> Option<f64> {
        let steps = steps.max(1);
        let mut sum = 0.0;
        for k in 0..=steps {
            let t = from + (to - from) * k as f64 / steps as f64;
            let weight = if k == 0 || k == steps { 0.5 } else { 1.0 };
            let moving = motion.at(t)?;
            sum += weight * self.engaged(&moving, |p| depth_mm(t, p)).rate();
        }
        Some(sum * (to - from) / steps as f64)
    }
}

impl Engagement {
    /// Volume per unit of the motion's parameter, mm3: the rate of a continuous cutting surface [R97, eqs. 24, 27].
    #[must_use]
    pub fn rate(&self) -> f64 {
        self.by_angle.iter().sum::<f64>() * TAU / self.by_angle.len() as f64
    }

    /// The rate of `teeth` edges, the first at `phase_rad` [R97, eqs. 29, 30]; its mean over a turn is [`Engagement::rate`].
    #[must_use]
    pub fn rate_of_teeth(&self, teeth: u32, phase_rad: f64) -> f64 {
        let n = self.by_angle.len() as f64;
        let teeth = teeth.max(1);
        let each = (0..teeth).map(|j| {
            let turn = (phase_rad / TAU + f64::from(j) / f64::from(teeth)).rem_euclid(1.0);
            // Between the meridians, which stand at half steps.
            let x = turn * n - 0.5;
            let (low, part) = (x.floor(), x - x.floor());
            let at = |k: f64| self.by_angle[k.rem_euclid(n) as usize % self.by_angle.len()];
            at(low) * (1.0 - part) + at(low + 1.0) * part
        });
        each.sum::<f64>() * TAU / f64::from(teeth)
    }

    /// How many of `teeth` edges are in cut, the first at `phase_rad`: the m of [R97, eq. 30].
    #[must_use]
    pub fn teeth_in_cut(&self, teeth: u32, phase_rad: f64) -> u32 {
        let n = self.by_angle.len();
        let in_cut = |j: &u32| {
            let turn = (phase_rad / TAU + f64::from(*j) / f64::from(teeth)).rem_euclid(1.0);
            self.by_angle[(turn * n as f64) as usize % n] > 0.0
        };
        (0..teeth).filter(in_cut).count() as u32
    }

    /// The angle over which the cutter is engaged, rad.
    #[must_use]
    pub fn arc_rad(&self) -> f64 {
        let engaged = self.by_angle.iter().filter(|x| **x > 0.0).count();
        TAU * engaged as f64 / self.by_angle.len() as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::{Unit3, Vec3};
    use osculate_tools::{CutterSpec, Pose};
    use std::f64::consts::PI;

    const FINE: Fineness = Fineness { meridians: 360, step_mm: 0.05 };

    fn slot(spec: CutterSpec) -> (Engagement, f64) {
        let cutter = Cutter::try_from(spec).unwrap();
        let pose = Pose { tip: Point3::origin(), axis: Unit3::new_unchecked(Vec3::z()) };
        let moving = Moving { pose, tip_rate: Vec3::new(3.0, 0.0, 0.0), turn: Vec3::zeros() };
        // Material up to 3.3 mm above the tip.
        let got = Outline::new(&cutter, FINE).engaged(&moving, |p| 3.3 - p.z);
        let rate = got.rate();
        (got, rate)
    }

    /// Slots: section times feed, for flat, ball and toroidal ends.
    #[test]
    fn slots_with_closed_forms() {
        let length_mm = 30.0;
        for (spec, section) in [
            (CutterSpec::Flat { diameter_mm: 10.0, length_mm }, 33.0),
            (
                CutterSpec::Ball { diameter_mm: 10.0, length_mm },
                25.0 * (1.7f64 / 5.0).acos() - 1.7 * (25.0f64 - 1.7 * 1.7).sqrt(),
            ),
            (
                CutterSpec::Toroidal { diameter_mm: 10.0, corner_radius_mm: 2.0, length_mm },
                33.0 - 2.0 * (4.0 - PI),
            ),
        ] {
            let (got, rate) = slot(spec);
            assert!((rate / (3.0 * section) - 1.0).abs() < 1e-4, "{rate} {section}");
            assert!((got.arc_rad() - PI).abs() < 0.02);
        }
    }

    /// The mean over a turn of any number of teeth is the continuous rate, and each instant differs from it.
    #[test]
    fn teeth_have_the_continuous_mean() {
        let (got, rate) = slot(CutterSpec::Flat { diameter_mm: 10.0, length_mm: 30.0 });
        for teeth in [1, 2, 3, 4] {
            let n = 720;
            let all: Vec<f64> =
                (0..n).map(|k| got.rate_of_teeth(teeth, TAU * f64::from(k) / f64::from(n))).collect();
            let mean = all.iter().sum::<f64>() / f64::from(n);
            assert!((mean / rate - 1.0).abs() < 1e-9, "{teeth}: {mean} {rate}");
            let most = all.iter().copied().fold(0.0, f64::max);
            // One tooth in a slot: pi times the mean at the middle of its cut; four teeth: two in cut at a time.
            let want = match teeth {
                1 => PI,
                2 => PI / 2.0,
                3 => PI / 3.0,
                _ => PI * 2f64.sqrt() / 4.0,
            };
            assert!((most / rate - want).abs() < 1e-3, "{teeth}: {}", most / rate);
            // Half a turn of a slot is in cut, and so are half of an even number of teeth.
            let phase = |k: i32| TAU * (f64::from(k) + 0.25) / f64::from(n);
            let in_cut: Vec<u32> = (0..n).map(|k| got.teeth_in_cut(teeth, phase(k))).collect();
            let range = [in_cut.iter().min(), in_cut.iter().max()].map(|x| *x.unwrap());
            assert_eq!(range, [teeth / 2, teeth.div_ceil(2)], "{teeth}");
        }
    }

    /// A tool that only turns about its own axis, or stands in air, takes nothing.
    #[test]
    fn nothing_where_nothing_moves() {
        let cutter = Cutter::try_from(CutterSpec::Ball { diameter_mm: 8.0, length_mm: 30.0 }).unwrap();
        let pose = Pose { tip: Point3::origin(), axis: Unit3::new_unchecked(Vec3::z()) };
        let spin = Moving { pose, tip_rate: Vec3::zeros(), turn: Vec3::z() };
        let outline = Outline::new(&cutter, FINE);
        assert!(outline.engaged(&spin, |_| 1.0).rate().abs() < 1e-9);
        let feed = Moving { tip_rate: Vec3::x(), ..spin };
        assert_eq!(outline.engaged(&feed, |_| -1.0).rate(), 0.0);
    }
}
