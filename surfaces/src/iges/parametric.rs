//! Parametric splines (entities 112 and 114): polynomials in powers, exactly as B-splines.
//!
//! A segment is `A + B s + C s^2 + D s^3` for s from 0 to the length h of its interval, and has the Bezier poles
//! `A, A + B h / 3, A + 2 B h / 3 + C h^2 / 3, A + B h + C h^2 + D h^3`; a patch has them in both directions. The
//! B-spline has each inner break three times.

use crate::nurbs::{CurveError, Net, NurbsError, NurbsSurface};
use crate::trim::spline::Spline;
use osculate_geom::{Box3, Point3, Vec3};

/// Two segments farther apart than this fraction of the curve's size are told: seven digits of coefficients leave less.
const JUMP: f64 = 1e-6;

/// Bezier poles of a cubic in powers over an interval of length h.
fn bezier(power: [Vec3; 4], h: f64) -> [Vec3; 4] {
    let [a, b, c, d] = [power[0], power[1] * h, power[2] * (h * h), power[3] * (h * h * h)];
    [a, a + b / 3.0, a + b * (2.0 / 3.0) + c / 3.0, a + b + c + d]
}

/// Knots of degree three with every inner break three times.
fn knots(breaks: &[f64]) -> Vec<f64> {
    let last = breaks.len() - 1;
    breaks
        .iter()
        .enumerate()
        .flat_map(|(k, t)| std::iter::repeat_n(*t, if k == 0 || k == last { 4 } else { 3 }))
        .collect()
}

/// The spline of n segments from n + 1 breaks and 12 coefficients a segment (x, then y, then z), and the largest gap
/// between two segments where it is worth telling, mm. Where they do not meet, the later one begins where the earlier
/// one ends.
pub(crate) fn curve(
    breaks: &[f64],
    coefficients: &[f64],
    unit: f64,
) -> Result<(Spline, Option<f64>), CurveError> {
    let mut poles: Vec<Point3> = Vec::new();
    let mut jump_mm = 0.0_f64;
    for (c, w) in coefficients.chunks_exact(12).zip(breaks.windows(2)) {
        let power = [0, 1, 2, 3].map(|k| Vec3::new(c[k], c[4 + k], c[8 + k]) * unit);
        let own = bezier(power, w[1] - w[0]).map(Point3::from);
        match poles.last() {
            Some(end) => jump_mm = jump_mm.max((own[0] - end).norm()),
            None => poles.push(own[0]),
        }
        poles.extend_from_slice(&own[1..]);
    }
    let size = Box3::around(&poles).diagonal_mm();
    let spline = Spline::new(3, knots(breaks), poles, Vec::new())?;
    Ok((spline, (jump_mm > JUMP * size).then_some(jump_mm)))
}

/// The numbers of entity 114: breaks in both directions, and for each patch, v fastest, 16 coefficients of x, of y and
/// of z, those of `s^i t^j` at `i + 4 j`.
pub(crate) struct Patches<'p> {
    pub(crate) breaks: [&'p [f64]; 2],
    pub(crate) coefficients: &'p [f64],
    /// Coefficients from one row of patches to the next.
    pub(crate) stride: usize,
}

/// The surface of patches, `place` giving each pole in millimetres, and the largest gap where it is worth telling, mm.
pub(crate) fn surface(
    patches: &Patches<'_>,
    place: impl Fn(&Vec3) -> Point3,
) -> Result<(NurbsSurface, Option<f64>), NurbsError> {
    let count = patches.breaks.map(|b| b.len() - 1);
    let rows = [3 * count[0] + 1, 3 * count[1] + 1];
    let mut points = vec![None::<Point3>; rows[0] * rows[1]];
    let mut jump_mm = 0.0_f64;
    for i in 0..count[0] {
        for j in 0..count[1] {
            let h = [
                patches.breaks[0][i + 1] - patches.breaks[0][i],
                patches.breaks[1][j + 1] - patches.breaks[1][j],
            ];
            let c = &patches.coefficients[i * patches.stride + 48 * j..][..48];
            // In u for each power of t, then in v.
            let in_u = [0, 1, 2, 3].map(|b| {
                let power =
                    [0, 1, 2, 3].map(|a| Vec3::new(c[a + 4 * b], c[16 + a + 4 * b], c[32 + a + 4 * b]));
                bezier(power, h[0])
            });
            for a in 0..4 {
                let in_v = bezier([in_u[0][a], in_u[1][a], in_u[2][a], in_u[3][a]], h[1]);
                for (b, pole) in in_v.iter().enumerate() {
                    let slot = &mut points[(3 * i + a) * rows[1] + 3 * j + b];
                    let own = place(pole);
                    match slot {
                        Some(there) => jump_mm = jump_mm.max((own - *there).norm()),
                        None => *slot = Some(own),
                    }
                }
            }
        }
    }
    let points: Vec<Point3> = points.into_iter().flatten().collect();
    let size = Box3::around(&points).diagonal_mm();
    let net = Net { count: rows, points, weights: None };
    let surface = NurbsSurface::new([3, 3], patches.breaks.map(knots), net)?;
    Ok((surface, (jump_mm > JUMP * size).then_some(jump_mm)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::{Surface, uv};

    #[test]
    fn a_curve_is_its_polynomials() {
        // x = t, y = t^2, z = t^3 in two segments over [1, 3] and [3, 3.5].
        let segment =
            |t: f64| [t, 1.0, 0.0, 0.0, t * t, 2.0 * t, 1.0, 0.0, t * t * t, 3.0 * t * t, 3.0 * t, 1.0];
        let coefficients: Vec<f64> = [1.0, 3.0].into_iter().flat_map(segment).collect();
        let (s, jump) = curve(&[1.0, 3.0, 3.5], &coefficients, 10.0).unwrap();
        assert_eq!((jump, s.range()), (None, [1.0, 3.5]));
        for k in 0..=20 {
            let t = 1.0 + 2.5 * f64::from(k) / 20.0;
            let want = Point3::new(t, t * t, t * t * t) * 10.0;
            // 43 * 10 at the largest, a few roundings.
            assert!((s.point(t) - want).norm() < 1e-12, "{t}");
        }
        // The second segment moved: it is told, and the curve has no gap.
        let mut moved = coefficients;
        moved[12] += 0.5;
        let (_, jump) = curve(&[1.0, 3.0, 3.5], &moved, 10.0).unwrap();
        assert!((jump.unwrap() - 5.0).abs() < 1e-12);
    }

    #[test]
    fn a_surface_is_its_polynomials() {
        // z = (u + v)^3 / 8 + u over [0, 2] + [2, 3] by [0, 1]; the stride leaves a patch out at the end of each row.
        let patch = |u: f64| {
            let mut c = [0.0; 48];
            (c[0], c[1]) = (u, 1.0);
            c[16 + 4] = 1.0;
            let z = &mut c[32..];
            let binomial = [1.0, 3.0, 3.0, 1.0];
            for i in 0..=3_usize {
                for j in 0..=3 - i {
                    // Terms of (u + s + t)^3: 3! / (i! j! k!) u^k s^i t^j.
                    let k = 3 - i - j;
                    let choose = binomial[i]
                        * [
                            [1.0, 3.0, 3.0, 1.0],
                            [1.0, 2.0, 1.0, 0.0],
                            [1.0, 1.0, 0.0, 0.0],
                            [1.0, 0.0, 0.0, 0.0],
                        ][i][j];
                    z[i + 4 * j] += choose * u.powi(k as i32) / 8.0;
                }
            }
            z[0] += u;
            z[1] += 1.0;
            c
        };
        let mut coefficients = Vec::new();
        for u in [0.0, 2.0] {
            coefficients.extend(patch(u));
            coefficients.extend([7.0; 48]);
        }
        let patches =
            Patches { breaks: [&[0.0, 2.0, 3.0], &[0.0, 1.0]], coefficients: &coefficients, stride: 96 };
        let (s, jump) = surface(&patches, |p| Point3::from(*p)).unwrap();
        assert_eq!(jump, None);
        for (u, v) in [(0.0, 0.0), (0.7, 0.3), (2.0, 0.5), (2.4, 0.9), (3.0, 1.0)] {
            let p = s.point(uv(u, v));
            let want = Point3::new(u, v, (u + v_cubed(u, v)) - 0.0);
            assert!((p - want).norm() < 1e-14, "{p} {want}");
        }
    }

    fn v_cubed(u: f64, v: f64) -> f64 {
        (u + v).powi(3) / 8.0
    }
}
