//! Strip and tooth mark of one posture on a chart.

use super::asked::{ChartError, Nearly, Within};
use super::walk::{ChartMotion, Profile, Side};
use super::{Chart, OF_PITCH};
use crate::contact::Lean;
use crate::cutter::{Cutter, Line};
use crate::strip::local::Pace;
use crate::strip::passages::extent;
use osculate_geom::roots::{End, bracketed};
use std::cell::{Cell, OnceCell};

/// Steps across the strip: of its leading-order half width, at most of the cutter's radius, and the least of these where knots
/// are close.
const STEP: f64 = 0.4;
const MOST_STEP: f64 = 0.15;
const LEAST_STEP: f64 = 0.125;
/// ... and of the way to the further border.
const OF_FACE: f64 = 0.2;
/// Instants to each side at which a tool that does not fit along the feed is looked at.
const INSTANTS: u32 = 6;

impl Chart<'_> {
    /// How far along the feed the standing tool stays within `height_mm`: as [`mark`](crate::strip::mark()).
    ///
    /// # Errors
    /// [`ChartError`].
    pub fn mark_mm(
        &self,
        cutter: &Cutter,
        angle_rad: f64,
        lean: Lean,
        height_mm: f64,
    ) -> Result<f64, ChartError> {
        let lean = lean.checked()?;
        let (s, c) = angle_rad.sin_cos();
        let pose = lean.pose(cutter, &self.frame(angle_rad), 0.0);
        let ray = self.ray([c, s]);
        let radius = cutter.radius_mm();
        let excess = |t: f64| {
            let entry = cutter.entry(&pose, &self.line(&ray, t));
            entry.map_or(radius, |e| e.at_mm - height_mm)
        };
        let mut total = 0.0;
        for sign in [1.0, -1.0] {
            let mut near = 0.0;
            let mut step = 0.02 * radius.min(self.reach);
            let far = loop {
                let next = near + step;
                if next > self.reach.min(ray.reach()[usize::from(sign > 0.0)]) {
                    return Err(ChartError::Beyond { radius_mm: self.reach });
                }
                if excess(sign * next) > 0.0 {
                    break next;
                }
                near = next;
                step *= 1.6;
            };
            let ends = [near, far].map(|x| End { x, f: excess(sign * x) });
            let first = End { f: ends[0].f.min(0.0), ..ends[0] };
            total += bracketed(first, ends[1], 1e-4 * far, |t| excess(sign * t)).map_or(near, |r| r.x);
        }
        Ok(total)
    }

    /// Depth below a place of a tool that moves as far as the feed goes on the chart, either way.
    fn dug_mm(&self, motion: &ChartMotion<'_>, cutter: &Cutter, line: &Line) -> f64 {
        let (reach, inside) = (motion.feed.reach(), motion.feed.inside());
        let instants = [-1.0, 1.0].into_iter().zip(0..).flat_map(|(sign, side): (f64, usize)| {
            let far = reach[side].min(inside[side]).min(self.reach);
            (1..=INSTANTS).map(move |k| sign * far * f64::from(k) / f64::from(INSTANTS))
        });
        let entries = instants.filter_map(|t| cutter.entry(&motion.moving(t)?.pose, line));
        -entries.map(|e| e.at_mm).fold(0.0, f64::min)
    }

    /// The strip of a posture, its feed at `angle_rad` from S_u towards S_v.
    ///
    /// ```
    /// use osculate_geom::{Interval, analytic::Cylinder, uv};
    /// use osculate_tools::strip::{Chart, Within};
    /// use osculate_tools::{Cutter, CutterSpec, Lean};
    /// // A ball of radius 5 on a shaft of radius 20, one chart for both feeds: around the shaft the strip lies along
    /// // it, where the shaft is straight, and is wider by the root of (1/5 + 1/20) / (1/5).
    /// let shaft = Cylinder::new(20.0, Interval::new(0.0, 80.0))?;
    /// let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 10.0, length_mm: 60.0 })?;
    /// let chart = Chart::new(&shaft, uv(0.0, 40.0), 2.0, 1e-6)?;
    /// let within = Within { scallop_mm: 0.001, gouge_mm: 0.0 };
    /// let width = |angle: f64| chart.strip(&ball, angle, Lean::default(), within).map(|found| found.width_mm);
    /// let ratio = width(0.0)? / width(std::f64::consts::FRAC_PI_2)?;
    /// assert!((ratio - 1.25f64.sqrt()).abs() < 1e-3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ChartError`].
    pub fn strip(
        &self,
        cutter: &Cutter,
        angle_rad: f64,
        lean: Lean,
        within: Within,
    ) -> Result<Nearly, ChartError> {
        let lean = lean.checked()?;
        let (s, c) = angle_rad.sin_cos();
        let motion = ChartMotion {
            chart: self,
            feed: self.ray([c, s]),
            lean,
            arc: cutter.touching(lean.lead_rad),
            beyond: Cell::new(false),
        };
        let q = self.relative(cutter, angle_rad, lean);
        let frame = self.frame(angle_rad);
        let (a, b) = (frame.left.dot(&q.d_min), frame.left.dot(&q.d_max));
        let inverse = a * a / q.min + if q.max.is_finite() { b * b / q.max } else { 0.0 };
        let radius = cutter.radius_mm();
        let half = (2.0 * within.scallop_mm * inverse).sqrt();
        // n x t in the chart's coordinates.
        let left = self.ray([-s * self.side, c * self.side]);
        let step = if q.min > 0.0 { (STEP * half).min(MOST_STEP * radius) } else { MOST_STEP * radius };
        // Between knots there may be a wave.
        let step = step.min((OF_PITCH * left.pitch_mm()).max(LEAST_STEP * step));
        // Nor may a face that is smaller than the tool be crossed at once.
        let [behind, ahead] = left.inside();
        let across = behind.max(ahead);
        // At a corner there is nothing to cross.
        let step = if across > 0.0 { step.min(OF_FACE * across) } else { step };
        let hollow = (-self.forms.principal().k_min).max(0.0);
        let [back, front] = extent(cutter, lean, &frame, hollow);
        let side = Side {
            motion: &motion,
            cutter,
            pace: Pace { step: 0.05 * radius, settled_mm: 2e-4 * within.scallop_mm },
            h: within.scallop_mm + self.error_mm(),
            step,
            fits: q.min > 0.0,
            // Parts of the body behind the contact come over it later.
            over: [front, -back],
            nearby: OnceCell::new(),
        };
        let new = || [1.0, -1.0].map(|sign| Profile::new(left.clone(), sign));
        let mut profiles = new();
        let dip = |line: &Line| self.dip_mm(cutter, angle_rad, lean, line);
        // Lifted by more than the tolerance it would stand above it.
        let too_deep = |undercut: f64| match undercut - within.gouge_mm {
            lift if lift > within.scallop_mm => Err(ChartError::Above { standoff_mm: lift }),
            _ => Ok(undercut),
        };
        let mut undercut = too_deep(dip(&Line { origin: self.centre, direction: self.forms.normal }))?;
        for profile in &mut profiles {
            side.walk(profile)?;
        }
        // A surface that a table cannot follow may have waves over which the tool comes twice: at the contact, or at one end.
        if self.is_traced() {
            let both = side.comes_again(&profiles[0], 0.0);
            for profile in &mut profiles {
                let edge = profile.nearly_edge(within.scallop_mm);
                if both || side.comes_again(profile, edge) {
                    profile.begin_everywhere();
                    side.walk(profile)?;
                }
            }
        }
        // Where the tool does not fit along the feed it comes down on both sides of the contact, and a walk follows one.
        if q.along(&frame.tangent) < 0.0 {
            let ends = profiles.iter().map(|p| p.last_line(self));
            for line in std::iter::once(self.line(&left, 0.0)).chain(ends) {
                undercut = undercut.max(too_deep(self.dug_mm(&motion, cutter, &line))?);
            }
        }
        for profile in &profiles {
            undercut = undercut
                .max(too_deep(side.undercut(profile, within.scallop_mm))?)
                .max(too_deep(dip(&profile.last_line(self)))?);
        }
        let lift = (undercut - within.gouge_mm).max(0.0);
        let (mut sides, mut most) = ([0.0; 2], 0.0);
        for (profile, reach) in profiles.iter().zip(&mut sides) {
            let [edge, higher] = side.edges(profile, within.scallop_mm - lift, self.error_mm())?;
            (*reach, most) = (edge, most + higher);
        }
        let [left_mm, right_mm] = sides;
        let width_mm = left_mm + right_mm;
        if motion.beyond.get() {
            return Err(ChartError::Beyond { radius_mm: self.reach });
        }
        let (most_mm, undercut_mm) = (most.max(width_mm), undercut - lift);
        Ok(Nearly { width_mm, left_mm, right_mm, most_mm, undercut_mm, lift_mm: lift })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{Contact, FeedLine};
    use crate::spec::CutterSpec;
    use crate::strip::{exact, mark};
    use osculate_geom::Flipped;
    use osculate_geom::analytic::{Ellipsoid, Torus};
    use osculate_geom::{Surface, uv};
    use proptest::prelude::*;

    fn toroidal(diameter_mm: f64, corner_radius_mm: f64) -> Cutter {
        Cutter::try_from(CutterSpec::Toroidal { diameter_mm, corner_radius_mm, length_mm: 80.0 }).unwrap()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        /// Width, undercut and mark are those of the exact strip to the error that the misfit allows.
        #[test]
        fn agrees_with_the_exact_strip(
            fu in 0.0..1.0f64, fv in 0.2..0.8f64, angle in 0.0..6.3f64, lead in 0.05..0.5f64, tilt in -0.4..0.4f64,
            hollow: bool
        ) {
            let ellipsoid = Ellipsoid::new([90.0, 60.0, 40.0]).unwrap();
            let groove = Flipped(Torus::new(200.0, 60.0).unwrap());
            let part: &dyn Surface = if hollow { &groove } else { &ellipsoid };
            let at = part.domain().at(fu, if hollow { 0.4 + 0.2 * fv } else { fv });
            let cutter = toroidal(12.0, 2.0);
            // At small leads in the groove the far side cuts too, which may make the exact strip wider.
            let lead = if hollow { lead + 0.1 } else { lead };
            let lean = Lean { lead_rad: lead, tilt_rad: tilt };
            let h = 0.01;
            let chart = Chart::new(part, at, 8.0, 1e-3 * h).unwrap();
            prop_assert!(chart.error_mm() <= 1e-3 * h);
            let contact = Contact::new(part, at, &cutter, FeedLine::Angle(angle), lean).unwrap();
            let want = exact(&contact, h).unwrap();
            // No lift: any undercut is accepted.
            let got = chart.strip(&cutter, angle, lean, Within { scallop_mm: h, gouge_mm: 1.0 });
            match got {
                // A tool that digs in by more than the tolerance is of no use: told as such, if not how deep and how wide.
                Ok(got) if want.undercut_mm > h => prop_assert!(got.undercut_mm > 0.5 * h, "{got:?} {want:?}"),
                Ok(got) => {
                    prop_assert!((got.width_mm / want.width_mm - 1.0).abs() < 2e-3, "{got:?} {want:?}");
                    prop_assert!(got.most_mm >= got.width_mm && got.most_mm < 1.1 * got.width_mm, "{got:?}");
                    prop_assert!((got.undercut_mm - want.undercut_mm).abs() < 2e-2 * h, "{got:?} {want:?}");
                }
                // Wide, or the tool does not fit at all.
                Err(e) => prop_assert!(
                    matches!(e, ChartError::Beyond { .. }) && (want.width_mm > 5.0 || want.undercut_mm > 5.0 * h),
                    "{e} {want:?}"
                ),
            }
            let long = chart.mark_mm(&cutter, angle, lean, h).unwrap();
            prop_assert!((long / mark(&contact, h).unwrap().length_mm() - 1.0).abs() < 2e-3);
        }
    }

    /// With an accepted undercut the tool is lifted by the rest, and the strip is that of the lifted contact.
    #[test]
    fn lifts_what_dips() {
        let groove = Flipped(Torus::new(200.0, 60.0).unwrap());
        let at = uv(0.2, std::f64::consts::PI);
        let cutter = toroidal(20.0, 2.0);
        let angle = 0.0;
        let lean = Lean { lead_rad: 0.122, tilt_rad: 0.0 };
        let within = Within { scallop_mm: 0.01, gouge_mm: 1e-3 };
        let got = Chart::new(&groove, at, 12.0, 1e-5).unwrap().strip(&cutter, angle, lean, within).unwrap();
        assert!(got.lift_mm > 1e-4, "{got:?}");
        let contact = Contact::new(&groove, at, &cutter, FeedLine::Angle(angle), lean).unwrap();
        let want = exact(&contact.lifted(got.lift_mm), 0.01).unwrap();
        assert!((want.undercut_mm - 1e-3).abs() < 1e-4, "{want:?}");
        assert!((got.width_mm / want.width_mm - 1.0).abs() < 1e-2, "{got:?} {want:?}");
    }
}
