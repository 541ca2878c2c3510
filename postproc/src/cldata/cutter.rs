//! The seven parameters of the APT cutter: `CUTTER/d, r, e, f, a, b, h`.
//!
//! d diameter, r corner radius, e and f the centre of the corner arc across and along the axis (from the tip), a the
//! rise of the bottom, b the opening of the side, both deg, h the height. Ball, flat and toroidal cutters have
//! a = b = 0, e = d/2 - r, f = r. Corners that do not touch bottom and side are not known.

use osculate_tools::{Cutter, CutterSpec};

/// What became of a `CUTTER/` statement.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Found {
    /// A cutter that this project knows.
    Known(CutterSpec),
    /// The same, but the height was not given and had to be assumed (mm).
    Assumed(CutterSpec, f64),
    /// Numbers that make no cutter, or one whose corner does not touch bottom and side.
    Other,
}

/// A cutter without a height is taken to be this many diameters long; the reader says so.
const ASSUMED_LENGTH_DIAMETERS: f64 = 3.0;

/// From the bottom's normal towards the side's, rad: inside the corner's range, past the tip's.
const CORNER_SIDE_RAD: f64 = 1e-9;

/// Lengths in CUTTER/ come with three to six decimals: below this, mm, two of them are the same.
const SAME_MM: f64 = 1e-4;

/// The seven parameters of a cutter.
pub(super) fn parameters(cutter: &CutterSpec) -> Option<[f64; 7]> {
    let shaped = |d: f64, r: f64, angles: [f64; 2], h: f64| {
        // The corner's arc has the normal of the bottom.
        let lean = angles[0].to_radians();
        let arc = Cutter::try_from(*cutter).ok()?.touching(lean + CORNER_SIDE_RAD);
        Some([d, r, arc.centre_rho_mm, arc.centre_z_mm, angles[0], angles[1], h])
    };
    let (d, r, h) = match *cutter {
        CutterSpec::Ball { diameter_mm, length_mm } => (diameter_mm, 0.5 * diameter_mm, length_mm),
        CutterSpec::Flat { diameter_mm, length_mm } => (diameter_mm, 0.0, length_mm),
        CutterSpec::Toroidal { diameter_mm, corner_radius_mm, length_mm } => {
            (diameter_mm, corner_radius_mm, length_mm)
        }
        CutterSpec::Cylindrical { diameter_mm, length_mm } => (diameter_mm, 0.0, length_mm),
        CutterSpec::Apt { diameter_mm, corner_radius_mm, bottom_angle_deg, side_angle_deg, length_mm } => {
            return shaped(diameter_mm, corner_radius_mm, [bottom_angle_deg, side_angle_deg], length_mm);
        }
        // A cone with its shank and a barrel are not among what seven numbers say.
        CutterSpec::Cone { .. } | CutterSpec::Barrel { .. } => return None,
    };
    Some([d, r, 0.5 * d - r, r, 0.0, 0.0, h])
}

/// The cutter of the parameters, which are already in mm and degrees.
pub(super) fn cutter(p: &[f64]) -> Found {
    let get = |i: usize| p.get(i).copied();
    let (Some(d), r) = (get(0), get(1).unwrap_or(0.0)) else { return Found::Other };
    let conical = [get(4), get(5)].into_iter().flatten().any(|angle| angle != 0.0);
    // Some systems leave e and f at zero, or write e = d/2 and f = 0 for a flat end.
    let centre = match (get(2), get(3)) {
        (Some(e), Some(f)) => {
            (e.abs() < SAME_MM || (e - (0.5 * d - r)).abs() < SAME_MM)
                && (f.abs() < SAME_MM || (f - r).abs() < SAME_MM)
        }
        _ => true,
    };
    let given = get(6).filter(|h| *h > 0.0);
    let length_mm = given.unwrap_or(ASSUMED_LENGTH_DIAMETERS * d);
    if conical {
        let spec = CutterSpec::Apt {
            diameter_mm: d,
            corner_radius_mm: r,
            bottom_angle_deg: get(4).unwrap_or(0.0),
            side_angle_deg: get(5).unwrap_or(0.0),
            length_mm,
        };
        let same = |a: Option<f64>, b: f64| a.is_none_or(|a| a == 0.0 || (a - b).abs() < SAME_MM);
        return match parameters(&spec) {
            Some(own) if same(get(2), own[2]) && same(get(3), own[3]) => {
                if given.is_some() {
                    Found::Known(spec)
                } else {
                    Found::Assumed(spec, length_mm)
                }
            }
            _ => Found::Other,
        };
    }
    if !(d > 0.0 && r >= 0.0 && r <= 0.5 * d + SAME_MM && centre) {
        return Found::Other;
    }
    let spec = if r < SAME_MM {
        CutterSpec::Flat { diameter_mm: d, length_mm }
    } else if (r - 0.5 * d).abs() < SAME_MM {
        CutterSpec::Ball { diameter_mm: d, length_mm }
    } else {
        CutterSpec::Toroidal { diameter_mm: d, corner_radius_mm: r, length_mm }
    };
    if given.is_some() { Found::Known(spec) } else { Found::Assumed(spec, length_mm) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_cutters_come_back() {
        let all = [
            CutterSpec::Ball { diameter_mm: 6.0, length_mm: 30.0 },
            CutterSpec::Flat { diameter_mm: 12.5, length_mm: 40.0 },
            CutterSpec::Toroidal { diameter_mm: 20.0, corner_radius_mm: 2.0, length_mm: 60.0 },
        ];
        for spec in all {
            assert_eq!(cutter(&parameters(&spec).unwrap()), Found::Known(spec));
        }
    }

    #[test]
    fn other_systems_forms() {
        let flat = CutterSpec::Flat { diameter_mm: 6.0, length_mm: 51.0 };
        assert_eq!(cutter(&[6.0, 0.0, 3.0, 0.0, 0.0, 0.0, 51.0]), Found::Known(flat));
        let flat = CutterSpec::Flat { diameter_mm: 10.0, length_mm: 30.0 };
        assert_eq!(cutter(&[10.0]), Found::Assumed(flat, 30.0));
        let ball = CutterSpec::Ball { diameter_mm: 4.0, length_mm: 12.0 };
        assert_eq!(cutter(&[4.0, 2.0]), Found::Assumed(ball, 12.0));
        // A drill with a 31 degree point; the same with a corner that does not touch; a taper ball.
        let apt = |diameter_mm, corner_radius_mm, bottom_angle_deg, side_angle_deg, length_mm| {
            Found::Known(CutterSpec::Apt {
                diameter_mm,
                corner_radius_mm,
                bottom_angle_deg,
                side_angle_deg,
                length_mm,
            })
        };
        let drill = [12.0, 0.0, 6.0, 3.605164, 31.0, 0.0, 63.0];
        assert_eq!(cutter(&drill), apt(12.0, 0.0, 31.0, 0.0, 63.0));
        assert_eq!(cutter(&[12.0, 0.0, 5.0, 3.605164, 31.0, 0.0, 63.0]), Found::Other);
        let taper = cutter(&[6.0, 2.0, 0.0, 0.0, 0.0, 5.0, 30.0]);
        assert_eq!(taper, apt(6.0, 2.0, 0.0, 5.0, 30.0));
        let Found::Known(spec) = taper else { panic!("known") };
        assert_eq!(cutter(&parameters(&spec).unwrap()), Found::Known(spec));
        // A radius larger than half the diameter.
        assert_eq!(cutter(&[4.0, 3.0]), Found::Other);
        assert_eq!(cutter(&[]), Found::Other);
    }
}
