//! From a description to a validated cutter.

use crate::cutter::{Cutter, CutterError};
use crate::meridian::{Apt, Barrel, Cone, Meridian, Misfit};
use crate::spec::CutterSpec;

impl TryFrom<CutterSpec> for Cutter {
    type Error = CutterError;

    fn try_from(spec: CutterSpec) -> Result<Self, CutterError> {
        match spec {
            CutterSpec::Ball { diameter_mm, length_mm } => {
                Self::new(diameter_mm, 0.5 * diameter_mm, length_mm)
            }
            CutterSpec::Flat { diameter_mm, length_mm }
            | CutterSpec::Cylindrical { diameter_mm, length_mm } => Self::new(diameter_mm, 0.0, length_mm),
            CutterSpec::Toroidal { diameter_mm, corner_radius_mm, length_mm } => {
                Self::new(diameter_mm, corner_radius_mm, length_mm)
            }
            CutterSpec::Cone { diameter_mm, taper_deg, corner_radius_mm, tip_diameter_mm, length_mm } => {
                let tip = [("tip_diameter_mm", tip_diameter_mm.unwrap_or(diameter_mm))];
                sizes(&[("diameter_mm", diameter_mm), ("length_mm", length_mm), tip[0]], corner_radius_mm)?;
                let cone = Cone {
                    radius: 0.5 * diameter_mm,
                    taper: taper_deg.to_radians(),
                    corner: corner_radius_mm,
                    tip_radius: tip_diameter_mm.map(|d| 0.5 * d),
                    length: length_mm,
                };
                Self::shaped(Meridian::cone(cone), [corner_radius_mm, length_mm, 0.0])
            }
            CutterSpec::Barrel { diameter_mm, barrel_radius_mm, corner_radius_mm, length_mm } => {
                let all = [
                    ("diameter_mm", diameter_mm),
                    ("length_mm", length_mm),
                    ("barrel_radius_mm", barrel_radius_mm),
                ];
                sizes(&all, corner_radius_mm)?;
                let barrel = Barrel {
                    radius: 0.5 * diameter_mm,
                    barrel: barrel_radius_mm,
                    corner: corner_radius_mm,
                    length: length_mm,
                };
                Self::shaped(Meridian::barrel(barrel), [corner_radius_mm, length_mm, barrel_radius_mm])
            }
            CutterSpec::Apt {
                diameter_mm,
                corner_radius_mm,
                bottom_angle_deg,
                side_angle_deg,
                length_mm,
            } => {
                sizes(&[("diameter_mm", diameter_mm), ("length_mm", length_mm)], corner_radius_mm)?;
                if bottom_angle_deg == 0.0 && side_angle_deg == 0.0 {
                    return Self::new(diameter_mm, corner_radius_mm, length_mm);
                }
                let apt = Apt {
                    radius: 0.5 * diameter_mm,
                    corner: corner_radius_mm,
                    bottom: bottom_angle_deg.to_radians(),
                    side: side_angle_deg.to_radians(),
                    length: length_mm,
                };
                Self::shaped(Meridian::apt(apt), [corner_radius_mm, length_mm, 0.0])
            }
        }
    }
}

/// Checks lengths that must be positive and a corner that may vanish.
fn sizes(positive: &[(&'static str, f64)], corner: f64) -> Result<(), CutterError> {
    for &(what, got) in positive {
        if !(got.is_finite() && got > 0.0) {
            return Err(CutterError::Size { what, got });
        }
    }
    if corner.is_finite() && corner >= 0.0 {
        Ok(())
    } else {
        Err(CutterError::Size { what: "corner_radius_mm", got: corner })
    }
}

impl Cutter {
    /// A cutter with a meridian of its own, from corner, length and barrel radius for the message.
    fn shaped(
        meridian: Result<Meridian, Misfit>,
        [corner_mm, length_mm, barrel_mm]: [f64; 3],
    ) -> Result<Self, CutterError> {
        match meridian {
            Ok(m) => Ok(Self {
                radius: m.radius,
                corner: m.corner.radius_mm,
                length: length_mm,
                meridian: Some(m),
            }),
            Err(Misfit::Angle { what, got, least, most }) => Err(CutterError::Angle {
                what,
                got_deg: got.to_degrees(),
                least_deg: least.to_degrees(),
                most_deg: most.to_degrees(),
            }),
            Err(Misfit::Corner { most }) => Err(CutterError::ShapeCorner { corner_mm, most_mm: most }),
            Err(Misfit::Barrel { least }) => Err(CutterError::Barrel { barrel_mm, radius_mm: least }),
            Err(Misfit::Length { least, most }) => {
                Err(CutterError::ShapeLength { length_mm, least_mm: least, most_mm: most })
            }
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(crate) fn shaped() -> [Cutter; 4] {
        [
            CutterSpec::Cone {
                diameter_mm: 20.0,
                taper_deg: 12.0,
                corner_radius_mm: 2.0,
                tip_diameter_mm: None,
                length_mm: 50.0,
            },
            CutterSpec::Cone {
                diameter_mm: 20.0,
                taper_deg: 30.0,
                corner_radius_mm: 0.0,
                tip_diameter_mm: Some(6.0),
                length_mm: 50.0,
            },
            CutterSpec::Barrel {
                diameter_mm: 20.0,
                barrel_radius_mm: 85.0,
                corner_radius_mm: 3.0,
                length_mm: 50.0,
            },
            CutterSpec::Apt {
                diameter_mm: 16.0,
                corner_radius_mm: 1.5,
                bottom_angle_deg: 15.0,
                side_angle_deg: -8.0,
                length_mm: 30.0,
            },
        ]
        .map(|s| Cutter::try_from(s).unwrap())
    }

    /// Distance to the meridian by many points of its boundary: along the flanks found from both neighbours.
    #[test]
    fn shapes_are_what_their_parameters_say() {
        let [cone, frustum, barrel, apt] = shaped();
        // The cone's ball tip, its flank at a radius, and the cylinder.
        assert!(cone.local_distance(0.0, 0.0).abs() < 1e-14);
        let (s, c) = 12f64.to_radians().sin_cos();
        let flank = |rho: f64| (rho * c - 2.0 * (1.0 - s)) / s;
        assert!(cone.local_distance(5.0, flank(5.0)).abs() < 1e-13 && flank(10.0) < 50.0);
        assert!(cone.local_distance(10.0, flank(10.0)).abs() < 1e-13);
        assert!((cone.local_distance(11.0, 49.0) - 1.0).abs() < 1e-13);
        // The frustum has a flat of radius 3 and a flank of slope 1 : tan 30.
        assert!(frustum.local_distance(3.0, 0.0).abs() < 1e-14);
        assert!(frustum.local_distance(4.0, 1.0 / 30f64.to_radians().tan()).abs() < 1e-13);
        assert!((frustum.local_distance(1.0, -2.0) - 2.0).abs() < 1e-14);
        // The barrel is 10 wide where its arc is level, 85 - sqrt(85^2 - 9) less 3 mm above and below.
        let widest = 3.0 + (82f64 * 82.0 - 75.0 * 75.0).sqrt();
        let less = 85.0 - (85f64 * 85.0 - 9.0).sqrt();
        for (z, rho) in [(widest, 10.0), (widest + 3.0, 10.0 - less), (widest - 3.0, 10.0 - less)] {
            assert!(barrel.local_distance(rho, z).abs() < 1e-12, "{z}");
        }
        assert_eq!(barrel.radius_mm(), 10.0);
        // APT: the corner touches bottom and side lines that meet at d/2.
        let (bottom, side) = (15f64.to_radians().tan(), (-8f64).to_radians().tan());
        assert!(apt.local_distance(3.0, 3.0 * bottom).abs() < 1e-13);
        assert!(apt.local_distance(8.0 + 20.0 * side, 8.0 * bottom + 20.0).abs() < 1e-13);
        assert!(apt.local_distance(8.0, 8.0 * bottom) > 0.1, "the corner is rounded");
        // An APT cutter without angles is an end mill.
        let plain = CutterSpec::Apt {
            diameter_mm: 12.0,
            corner_radius_mm: 1.5,
            bottom_angle_deg: 0.0,
            side_angle_deg: 0.0,
            length_mm: 30.0,
        };
        assert_eq!(Cutter::try_from(plain), Cutter::new(12.0, 1.5, 30.0));
    }

    #[test]
    fn refuses_impossible_shapes() {
        let cone = |taper_deg, corner_radius_mm, tip_diameter_mm, length_mm| {
            Cutter::try_from(CutterSpec::Cone {
                diameter_mm: 10.0,
                taper_deg,
                corner_radius_mm,
                tip_diameter_mm,
                length_mm,
            })
        };
        assert!(matches!(cone(90.0, 1.0, None, 50.0), Err(CutterError::Angle { .. })));
        assert!(matches!(cone(f64::NAN, 1.0, None, 50.0), Err(CutterError::Angle { .. })));
        assert!(matches!(cone(5.0, 3.0, Some(2.0), 50.0), Err(CutterError::ShapeCorner { .. })));
        assert!(matches!(cone(5.0, 1.0, Some(4.0), 30.0), Err(CutterError::ShapeLength { .. })));
        assert!(matches!(cone(5.0, -1.0, None, 30.0), Err(CutterError::Size { .. })));
        let barrel = |barrel_radius_mm, corner_radius_mm, length_mm| {
            Cutter::try_from(CutterSpec::Barrel {
                diameter_mm: 10.0,
                barrel_radius_mm,
                corner_radius_mm,
                length_mm,
            })
        };
        assert!(matches!(barrel(4.0, 1.0, 30.0), Err(CutterError::Barrel { .. })));
        assert!(matches!(barrel(40.0, 5.0, 30.0), Err(CutterError::ShapeCorner { .. })));
        assert!(matches!(barrel(40.0, 1.0, 10.0), Err(CutterError::ShapeLength { .. })));
        assert!(matches!(barrel(40.0, 1.0, 100.0), Err(CutterError::ShapeLength { .. })));
        let apt = |corner_radius_mm, bottom_angle_deg, side_angle_deg| {
            Cutter::try_from(CutterSpec::Apt {
                diameter_mm: 10.0,
                corner_radius_mm,
                bottom_angle_deg,
                side_angle_deg,
                length_mm: 30.0,
            })
        };
        assert!(apt(5.0, 0.0, 1.0).is_ok() && apt(0.0, 31.0, 0.0).is_ok());
        assert!(matches!(apt(1.0, -5.0, 0.0), Err(CutterError::Angle { .. })));
        assert!(matches!(apt(1.0, 40.0, 50.0), Err(CutterError::Angle { .. })));
        assert!(matches!(apt(7.0, 0.0, 2.0), Err(CutterError::ShapeCorner { .. })));
        assert!(matches!(apt(1.0, 0.0, -20.0), Err(CutterError::ShapeLength { .. })));
    }
}
