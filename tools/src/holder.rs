//! Tool holders: round sections above the cutter, from the nose upwards.
//!
//! Each section is a cylinder or a cone, a convex body of its own, so that every distance to it is exact and convex; a holder as a whole
//! is as hollow between its sections as it is. The nose sits where the cutter's length ends.

use crate::cutter::{Cutter, CutterError};
use crate::pose::Pose;
use crate::spec::{CutterSpec, HolderSpec};

/// Most sections.
const MOST: usize = 30;

/// A section of a holder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HolderSection {
    /// Its body, lower end down.
    pub body: Cutter,
    /// How far its lower end is above the nose, mm.
    pub above_mm: f64,
}

/// A validated holder; it has one section at least.
#[derive(Clone, Debug, PartialEq)]
pub struct Holder {
    sections: Vec<HolderSection>,
}

/// Sections that make no holder.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HolderError {
    /// None, or too many of them.
    #[error("a holder has 1 to {most} sections, not {got}")]
    Count {
        /// How many are given.
        got: usize,
        /// The most.
        most: usize,
    },
    /// A section that is no body.
    #[error("section {section}: {why}")]
    Section {
        /// Which, from 1.
        section: usize,
        /// Why not.
        why: CutterError,
    },
}

impl HolderSpec {
    /// The section as a body: a cylinder, or a cone to another diameter at its upper end.
    fn body(&self) -> Result<Cutter, CutterError> {
        let Self { diameter_mm, length_mm, upper_diameter_mm } = *self;
        let upper_mm = upper_diameter_mm.unwrap_or(diameter_mm);
        if !(upper_mm.is_finite() && upper_mm > 0.0) {
            return Err(CutterError::Size { what: "upper_diameter_mm", got: upper_mm });
        }
        let plain = Cutter::cylinder(diameter_mm, length_mm)?;
        if upper_mm == diameter_mm {
            return Ok(plain);
        }
        let opening = (0.5 * (upper_mm - diameter_mm)).atan2(length_mm);
        Cutter::try_from(CutterSpec::Apt {
            diameter_mm,
            corner_radius_mm: 0.0,
            bottom_angle_deg: 0.0,
            side_angle_deg: opening.to_degrees(),
            length_mm,
        })
    }
}

impl Holder {
    /// A holder of sections from the nose upwards.
    ///
    /// ```
    /// use osculate_tools::{Holder, HolderError, HolderSpec};
    /// // A nose that widens from 20 to 40 mm over 30 mm, and a body above it.
    /// let nose = HolderSpec { diameter_mm: 20.0, length_mm: 30.0, upper_diameter_mm: Some(40.0) };
    /// let body = HolderSpec { diameter_mm: 40.0, length_mm: 50.0, upper_diameter_mm: None };
    /// let holder = Holder::new(&[nose, body])?;
    /// assert_eq!((holder.length_mm(), holder.sections()[1].above_mm), (80.0, 30.0));
    /// assert!(matches!(Holder::new(&[]), Err(HolderError::Count { got: 0, .. })));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`HolderError`].
    pub fn new(sections: &[HolderSpec]) -> Result<Self, HolderError> {
        if !(1..=MOST).contains(&sections.len()) {
            return Err(HolderError::Count { got: sections.len(), most: MOST });
        }
        let mut made = Vec::with_capacity(sections.len());
        let mut above_mm = 0.0;
        for (spec, section) in sections.iter().zip(1..) {
            let body = spec.body().map_err(|why| HolderError::Section { section, why })?;
            made.push(HolderSection { body, above_mm });
            above_mm += body.length_mm();
        }
        Ok(Self { sections: made })
    }

    /// A plain cylinder.
    ///
    /// # Errors
    /// [`HolderError::Section`].
    pub fn cylinder(diameter_mm: f64, length_mm: f64) -> Result<Self, HolderError> {
        Self::new(&[HolderSpec { diameter_mm, length_mm, upper_diameter_mm: None }])
    }

    /// The sections, from the nose upwards.
    #[must_use]
    pub fn sections(&self) -> &[HolderSection] {
        &self.sections
    }

    /// From the nose to the upper end, mm.
    #[must_use]
    pub fn length_mm(&self) -> f64 {
        self.sections.iter().map(|s| s.body.length_mm()).sum()
    }

    /// The sections with the poses that they have above a cutter in a pose.
    ///
    /// ```
    /// use osculate_geom::{Point3, Vec3};
    /// use osculate_tools::{Cutter, CutterSpec, Holder, Pose};
    /// // The nose sits where the cutter ends.
    /// let cutter = Cutter::try_from(CutterSpec::Ball { diameter_mm: 6.0, length_mm: 25.0 })?;
    /// let holder = Holder::cylinder(30.0, 50.0)?;
    /// let pose = Pose { tip: Point3::origin(), axis: Vec3::z_axis() };
    /// let noses: Vec<Point3> = holder.posed(&cutter, &pose).map(|(_, pose)| pose.tip).collect();
    /// assert_eq!(noses, [Point3::new(0.0, 0.0, 25.0)]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn posed<'a>(
        &'a self,
        cutter: &Cutter,
        pose: &Pose,
    ) -> impl Iterator<Item = (&'a Cutter, Pose)> + use<'a> {
        let nose = pose.retracted(cutter.length_mm());
        self.sections.iter().map(move |s| (&s.body, nose.retracted(s.above_mm)))
    }
}

impl From<Cutter> for Holder {
    /// A single body as a holder.
    fn from(body: Cutter) -> Self {
        Self { sections: vec![HolderSection { body, above_mm: 0.0 }] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::{Point3, Vec3};

    fn section(diameter_mm: f64, upper_mm: Option<f64>, length_mm: f64) -> HolderSpec {
        HolderSpec { diameter_mm, length_mm, upper_diameter_mm: upper_mm }
    }

    /// The distance of a point from a stepped holder is that of the meridian's corners and edges, written out by hand.
    #[test]
    fn sections_stand_on_each_other() {
        let holder = Holder::new(&[
            section(12.0, None, 30.0),
            section(12.0, Some(40.0), 14.0),
            section(40.0, Some(30.0), 20.0),
        ])
        .unwrap();
        assert_eq!(holder.length_mm(), 64.0);
        let cutter = Cutter::cylinder(6.0, 25.0).unwrap();
        let pose = Pose { tip: Point3::new(1.0, 2.0, 3.0), axis: Vec3::z_axis() };
        let distance = |rho: f64, above_nose: f64| {
            let p = Point3::new(1.0 + rho, 2.0, 28.0 + above_nose);
            holder
                .posed(&cutter, &pose)
                .map(|(body, at)| body.distance(&at, &p))
                .fold(f64::INFINITY, f64::min)
        };
        let root = 0.5f64.sqrt();
        let turn = 0.25f64.atan();
        for (rho, above, wanted) in [
            // Beside the nose, beneath it, and within it.
            (8.0, 10.0, 2.0),
            (3.0, -1.5, 1.5),
            (5.0, 10.0, -1.0),
            // The cone opens by 14 mm over 14 mm: 45 degrees. Its flank passes (13, 37).
            (13.0 + root, 37.0 - root, 1.0),
            (13.0 - root, 37.0 + root, -1.0),
            // The last one closes by 5 mm over 20 mm; its flank passes (17.5, 54).
            (17.5 + turn.cos(), 54.0 + turn.sin(), 1.0),
            // In the hollow between nose and cone only the bounding cylinder would be met.
            (10.0, 20.0, 4.0),
        ] {
            let got = distance(rho, above);
            assert!((got - wanted).abs() < 1e-12, "{rho} {above}: {got} {wanted}");
        }
    }

    #[test]
    fn what_is_no_holder_is_refused() {
        assert!(matches!(Holder::new(&[]), Err(HolderError::Count { got: 0, .. })));
        let many = vec![section(10.0, None, 1.0); 31];
        assert!(matches!(Holder::new(&many), Err(HolderError::Count { got: 31, .. })));
        for bad in [section(0.0, None, 5.0), section(10.0, Some(-1.0), 5.0), section(10.0, None, f64::NAN)] {
            let got = Holder::new(&[section(10.0, None, 5.0), bad]);
            assert!(matches!(got, Err(HolderError::Section { section: 2, .. })), "{got:?}");
        }
    }
}
