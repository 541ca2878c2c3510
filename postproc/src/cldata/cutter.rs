//! The seven parameters of the APT cutter: `CUTTER/d, r, e, f, a, b, h`.
//!
//! d diameter, r corner radius, e and f the centre of the corner arc across and along the axis (from the tip), a the
//! rise of the bottom, b the opening of the side, both deg, h the height. Ball, flat and toroidal cutters have
//! a = b = 0, e = d/2 - r, f = r.

use osculate_tools::CutterSpec;

/// What became of a `CUTTER/` statement.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Found {
    /// A cutter that this project knows.
    Known(CutterSpec),
    /// The same, but the height was not given and had to be assumed (mm).
    Assumed(CutterSpec, f64),
    /// A cutter with a conical bottom or side, or numbers that make no cutter.
    Other,
}

/// A cutter without a height is taken to be this many diameters long; the reader says so.
const ASSUMED_LENGTH_DIAMETERS: f64 = 3.0;

/// Lengths in CUTTER/ come with three to six decimals: below this, mm, two of them are the same.
const SAME_MM: f64 = 1e-4;

/// The seven parameters of a cutter.
pub(super) fn parameters(cutter: &CutterSpec) -> Option<[f64; 7]> {
    let (d, r, h) = match *cutter {
        CutterSpec::Ball { diameter_mm, length_mm } => (diameter_mm, 0.5 * diameter_mm, length_mm),
        CutterSpec::Flat { diameter_mm, length_mm } => (diameter_mm, 0.0, length_mm),
        CutterSpec::Toroidal { diameter_mm, corner_radius_mm, length_mm } => {
            (diameter_mm, corner_radius_mm, length_mm)
        }
        #[allow(unreachable_patterns)]
        _ => return None,
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
    if !(d > 0.0 && r >= 0.0 && r <= 0.5 * d + SAME_MM) || conical || !centre {
        return Found::Other;
    }
    let given = get(6).filter(|h| *h > 0.0);
    let length_mm = given.unwrap_or(ASSUMED_LENGTH_DIAMETERS * d);
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
        // A drill with a 31 degree point, and a radius larger than half the diameter.
        assert_eq!(cutter(&[12.0, 0.0, 6.0, 3.605164, 31.0, 0.0, 63.0]), Found::Other);
        assert_eq!(cutter(&[4.0, 3.0]), Found::Other);
        assert_eq!(cutter(&[]), Found::Other);
    }
}
