//! Splines brought together: joined end to end, and over common knots.
//!
//! A degree is raised piece by piece on the Bezier poles, `Q_i = i / (p + 1) P_(i-1) + (1 - i / (p + 1)) P_i`, in
//! homogeneous coordinates. Source: [Piegl & Tiller, The NURBS Book, 5.5].

use crate::nurbs::{CurveError, EditError};
use crate::trim::spline::Spline;
use nalgebra::Vector4;
use osculate_geom::{Interval, Point3};

/// Why splines could not be brought together.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(crate) enum JoinError {
    #[error("a composite of no curves")]
    Nothing,
    #[error(transparent)]
    Curve(#[from] CurveError),
    #[error(transparent)]
    Edit(#[from] EditError),
}

/// Knots nearer than this fraction of the range are one: what two roundings of a quotient may differ by, and far below
/// the nearest knots of real files.
const SAME_KNOT: f64 = 1e-10;

/// Homogeneous Bezier pieces and the breaks between them.
struct Pieces {
    poles: Vec<Vec<Vector4<f64>>>,
    breaks: Vec<f64>,
}

fn pieces(spline: &Spline) -> Pieces {
    let homogeneous = |p: &Point3, w: f64| Vector4::new(p.x * w, p.y * w, p.z * w, w);
    let poles = spline
        .curve()
        .bezier_pieces()
        .iter()
        .map(|b| {
            let w = |k: usize| b.weights().map_or(1.0, |w| w[k]);
            b.poles().iter().enumerate().map(|(k, p)| homogeneous(p, w(k))).collect()
        })
        .collect();
    Pieces { poles, breaks: spline.curve().knots().breaks().to_vec() }
}

/// The same Bezier curve with one degree more.
fn raised(poles: &[Vector4<f64>]) -> Vec<Vector4<f64>> {
    let p = poles.len();
    (0..=p)
        .map(|i| {
            let f = i as f64 / p as f64;
            let before = if i > 0 { poles[i - 1] * f } else { Vector4::zeros() };
            let here = if i < p { poles[i] * (1.0 - f) } else { Vector4::zeros() };
            before + here
        })
        .collect()
}

/// The spline of Bezier pieces of one degree; where two of them meet the later one's pole is left out.
fn assembled(pieces: &[Vec<Vector4<f64>>], breaks: &[f64]) -> Result<Spline, CurveError> {
    let degree = pieces[0].len() - 1;
    let mut poles = vec![pieces[0][0]];
    let mut knots = vec![breaks[0]; degree + 1];
    for (k, piece) in pieces.iter().enumerate() {
        poles.extend_from_slice(&piece[1..]);
        let times = if k + 1 == pieces.len() { degree + 1 } else { degree };
        knots.extend(std::iter::repeat_n(breaks[k + 1], times));
    }
    let weights: Vec<f64> = poles.iter().map(|p| p.w).collect();
    let points = poles.iter().map(|p| Point3::new(p.x, p.y, p.z) / p.w).collect();
    let same = weights.iter().all(|w| (w - weights[0]).abs() <= 1e-14 * weights[0]);
    Spline::new(degree, knots, points, if same { Vec::new() } else { weights })
}

/// The piece of a spline between two of its parameters.
pub(crate) fn part(spline: &Spline, ends: [f64; 2]) -> Result<Spline, EditError> {
    Ok(Spline::from_curve(spline.curve().restricted(Interval::new(ends[0], ends[1]))?))
}

/// The curves one after the other, turned where their other end is nearer, and the largest gap between two, mm. A
/// single one is left as it is.
pub(crate) fn joined(mut parts: Vec<Spline>) -> Result<(Spline, f64), JoinError> {
    if parts.len() <= 1 {
        return parts.pop().map(|p| (p, 0.0)).ok_or(JoinError::Nothing);
    }
    let ends = |s: &Spline| {
        let d = s.curve().domain();
        [s.curve().point(d.lo), s.curve().point(d.hi)]
    };
    // The first one is turned where its start is nearer to the second than its end.
    let (a, b) = (ends(&parts[0]), ends(&parts[1]));
    let to = |p: &Point3| (p - b[0]).norm().min((p - b[1]).norm());
    if to(&a[0]) < to(&a[1]) {
        parts[0] = parts[0].reversed();
    }
    let mut gap_mm = 0.0_f64;
    for k in 1..parts.len() {
        let end = ends(&parts[k - 1])[1];
        let here = ends(&parts[k]);
        if (here[1] - end).norm() < (here[0] - end).norm() {
            parts[k] = parts[k].reversed();
        }
        gap_mm = gap_mm.max((ends(&parts[k])[0] - end).norm());
    }
    let degree = parts.iter().map(|p| p.curve().degree()).max().unwrap_or(1);
    let (mut poles, mut breaks): (Vec<Vec<Vector4<f64>>>, Vec<f64>) = (Vec::new(), vec![0.0]);
    for part in &parts {
        let own = pieces(part);
        let start = breaks[breaks.len() - 1];
        breaks.extend(own.breaks[1..].iter().map(|t| start + t - own.breaks[0]));
        // The weight goes on where the part before ended: a common factor changes nothing.
        let factor = poles.last().map_or(1.0, |p| p[p.len() - 1].w) / own.poles[0][0].w;
        for mut piece in own.poles {
            while piece.len() <= degree {
                piece = raised(&piece);
            }
            poles.push(piece.into_iter().map(|p| p * factor).collect());
        }
    }
    Ok((assembled(&poles, &breaks)?, gap_mm))
}

/// Both splines over `[0, 1]` with one degree and the same knots.
pub(crate) fn alike(both: [&Spline; 2]) -> Result<[Spline; 2], JoinError> {
    let unit = |s: &Spline| -> Vec<f64> {
        let knots = s.curve().knots();
        let [lo, hi] = knots.domain();
        knots.as_slice().iter().map(|t| (t - lo) / (hi - lo)).collect()
    };
    let over_unit = |s: &Spline| {
        let weights = s.curve().weights().map_or_else(Vec::new, <[f64]>::to_vec);
        Spline::new(s.curve().degree(), unit(s), s.curve().poles().to_vec(), weights)
    };
    let [a, b] = both;
    if a.curve().degree() == b.curve().degree() && unit(a) == unit(b) {
        return Ok([over_unit(a)?, over_unit(b)?]);
    }
    let degree = a.curve().degree().max(b.curve().degree());
    let raised_over = |s: &Spline| -> Result<(Spline, Vec<f64>), JoinError> {
        let mut own = pieces(&over_unit(s)?);
        for piece in &mut own.poles {
            while piece.len() <= degree {
                *piece = raised(piece);
            }
        }
        Ok((assembled(&own.poles, &own.breaks)?, own.breaks))
    };
    let (mut a, of_a) = raised_over(a)?;
    let (b, of_b) = raised_over(b)?;
    // Breaks of both; where two are as good as one, that of the first.
    let foreign = |own: &[f64], other: &[f64]| -> Vec<f64> {
        other.iter().copied().filter(|t| own.iter().all(|o| (o - t).abs() > SAME_KNOT)).collect()
    };
    let (into_a, into_b) = (foreign(&of_a, &of_b), foreign(&of_b, &of_a));
    for t in into_a {
        a = Spline::from_curve(a.curve().insert_knot(t, degree)?);
    }
    let mut raw = b.curve().clone();
    for t in into_b {
        raw = raw.insert_knot(t, degree)?;
    }
    // The same knots to the bit.
    let weights = raw.weights().map_or_else(Vec::new, <[f64]>::to_vec);
    let b = Spline::new(degree, a.curve().knots().as_slice().to_vec(), raw.poles().to_vec(), weights)?;
    Ok([a, b])
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::Vec3;
    use std::f64::consts::FRAC_PI_2;

    fn quarter() -> Spline {
        Spline::arc(Point3::origin(), Vec3::x() * 2.0, Vec3::y() * 2.0, [0.0, FRAC_PI_2]).unwrap()
    }

    #[test]
    fn parts_are_joined_exactly_whatever_their_sense() {
        let line = Spline::polyline(vec![Point3::new(2.0, -3.0, 0.0), Point3::new(2.0, 0.0, 0.0)]).unwrap();
        let end = Spline::polyline(vec![Point3::new(-1.0, 2.0, 0.0), Point3::new(0.0, 2.0, 0.0)]).unwrap();
        let (all, gap) = joined(vec![line.reversed(), quarter(), end]).unwrap();
        assert_eq!((all.curve().degree(), all.range()), (2, [0.0, 3.0]));
        assert!(gap < 1e-15);
        for k in 0..=60 {
            let p = all.point(f64::from(k) / 20.0);
            // On one of the three to rounding.
            let off = if p.y < 0.0 {
                (p.x - 2.0).abs()
            } else if p.x < 0.0 {
                (p.y - 2.0).abs()
            } else {
                (p.coords.norm() - 2.0).abs()
            };
            assert!(off < 1e-14, "{p}");
        }
        assert_eq!(joined(Vec::new()).unwrap_err(), JoinError::Nothing);
    }

    #[test]
    fn curves_made_alike_keep_their_points() {
        let poles = [[0.0, 0.0, 1.0], [1.0, 2.0, 1.0], [2.0, -1.0, 1.5], [3.0, 0.0, 1.0]];
        let cubic =
            Spline::new(1, vec![4.0, 4.0, 5.0, 5.5, 6.0, 6.0], poles.map(Point3::from).to_vec(), Vec::new())
                .unwrap();
        let [a, b] = alike([&quarter(), &cubic]).unwrap();
        assert_eq!(a.curve().knots(), b.curve().knots());
        for k in 0..=40 {
            let t = f64::from(k) / 40.0;
            assert!((a.point(t) - quarter().point(t)).norm() < 1e-14);
            assert!((b.point(t) - cubic.point(4.0 + 2.0 * t)).norm() < 1e-14);
        }
        // Alike already: only the range changes.
        let [a, b] = alike([&quarter(), &quarter().reversed()]).unwrap();
        assert_eq!((a.curve().poles().len(), b.curve().poles().len()), (3, 3));
    }
}
