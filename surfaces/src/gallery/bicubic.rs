//! Bicubic Bezier patches of the gallery.

use crate::{Net, NurbsSurface};
use osculate_geom::Point3;

/// Side of the square below the M86 patches, mm.
const SIDE: f64 = 90.0;

/// Heights of the control points of the four M86 patches, mm, row by row along x, each along y. The points stand over
/// a square grid 30 mm apart, so that u and v are x and y over 90 mm.
///
/// All four are shallow hollows under a tool from above, alike at first sight as in the paper:
///
/// 1. a channel whose floor falls evenly along y and whose bend across grows along x: k1 - k2 changes across it only;
/// 2. the same channel bent most in its middle;
/// 3. a bowl with its lowest point inside and one umbilic, the other one being cut off;
/// 4. the bowl with both.
const M86_MM: [[[f64; 4]; 4]; 4] = [
    [[12.0, 21.0, 31.0, 42.0], [4.0, 13.0, 23.0, 34.0], [4.0, 13.0, 23.0, 34.0], [16.0, 25.0, 35.0, 46.0]],
    [[8.0, 17.0, 29.0, 44.0], [-5.0, 4.0, 16.0, 31.0], [-5.0, 4.0, 16.0, 31.0], [6.0, 16.0, 28.0, 42.0]],
    [[33.0, 19.0, 18.0, 32.0], [10.0, -4.0, -5.0, 9.0], [5.0, -10.0, -11.0, 4.0], [18.0, 3.0, 2.0, 17.0]],
    [[26.0, 9.0, 8.0, 24.0], [7.0, -9.0, -10.0, 6.0], [7.0, -9.0, -9.0, 7.0], [24.0, 8.0, 9.0, 26.0]],
];

/// The four patches of M86, by their number 1 to 4: 0, 0, 1 and 2 umbilics and 0, 0, 1 and 1 contour minima along z,
/// the second with an extremum of the difference of the principal curvatures. The material is below.
///
/// # Panics
/// Never for 1 to 4; other numbers are taken as the nearest of these.
#[must_use]
pub fn m86(number: usize) -> NurbsSurface {
    let heights = &M86_MM[number.clamp(1, 4) - 1];
    let step = SIDE / 3.0;
    let points = (0..4)
        .flat_map(|i| (0..4).map(move |j| Point3::new(step * i as f64, step * j as f64, heights[i][j])))
        .collect();
    patch(points, [0.0, 1.0])
}

/// The monkey saddle z = (x^3 - 3 x y^2) / 2000 over the square of half side 20 mm: u = x, v = y.
///
/// ```
/// use osculate_geom::{Point3, Surface, uv};
/// use osculate_surfaces::gallery;
/// // 120 degrees on, the saddle is the same: z depends on the third power of x + i y.
/// let saddle = gallery::monkey_saddle();
/// assert!((saddle.point(uv(10.0, 0.0)) - Point3::new(10.0, 0.0, 0.5)).norm() < 1e-12);
/// let (x, y) = (-5.0, 10.0 * 0.75f64.sqrt());
/// assert!((saddle.point(uv(x, y)).z - 0.5).abs() < 1e-12);
/// ```
#[must_use]
pub fn monkey_saddle() -> NurbsSurface {
    through([-20.0, 20.0], |x, y| Point3::new(x, y, (x * x * x - 3.0 * x * y * y) / 2000.0))
}

/// Enneper's minimal surface, ten times (u - u^3/3 + u v^2, v^3/3 - v - v u^2, u^2 - v^2), over |u|, |v| <= 1, turned so
/// that its outward normal is +z at the origin.
///
/// ```
/// use osculate_geom::{Surface, uv};
/// use osculate_surfaces::gallery;
/// // Minimal: the mean curvature vanishes everywhere.
/// let forms = gallery::enneper().jet2(uv(0.3, -0.6)).forms()?;
/// assert!(forms.mean().abs() < 1e-12 && forms.gauss() < 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn enneper() -> NurbsSurface {
    through([-1.0, 1.0], |u, v| {
        let (x, y) = (u - u * u * u / 3.0 + u * v * v, v - v * v * v / 3.0 + v * u * u);
        Point3::new(10.0 * x, 10.0 * y, 10.0 * (u * u - v * v))
    })
}

/// The bicubic Bezier patch over `range` in both parameters that equals `f`, which must be bicubic.
fn through(range: [f64; 2], f: impl Fn(f64, f64) -> Point3) -> NurbsSurface {
    let at = |k: usize| range[0] + (range[1] - range[0]) * k as f64 / 3.0;
    // Bezier points of a cubic from its values at 0, 1/3, 2/3 and 1.
    let bezier = |p: [Point3; 4]| {
        let sum = |w: [f64; 4]| {
            Point3::from(p.iter().zip(w).fold(osculate_geom::Vec3::zeros(), |s, (p, w)| s + p.coords * w))
        };
        let sixth = 1.0 / 6.0;
        [
            p[0],
            sum([-5.0, 18.0, -9.0, 2.0].map(|w| w * sixth)),
            sum([2.0, -9.0, 18.0, -5.0].map(|w| w * sixth)),
            p[3],
        ]
    };
    let rows: [[Point3; 4]; 4] = std::array::from_fn(|i| bezier(std::array::from_fn(|j| f(at(i), at(j)))));
    let columns: [[Point3; 4]; 4] = std::array::from_fn(|j| bezier(std::array::from_fn(|i| rows[i][j])));
    let points = (0..4).flat_map(|i| (0..4).map(move |j| (i, j))).map(|(i, j)| columns[j][i]).collect();
    patch(points, range)
}

fn patch(points: Vec<Point3>, [lo, hi]: [f64; 2]) -> NurbsSurface {
    let knots = vec![lo, lo, lo, lo, hi, hi, hi, hi];
    let net = Net { count: [4, 4], points, weights: None };
    NurbsSurface::new([3, 3], [knots.clone(), knots], net).expect("sixteen finite poles over clamped knots")
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::{Surface, uv};

    #[test]
    fn patches_equal_their_functions() {
        let s = monkey_saddle();
        let p = s.point(uv(7.0, -13.0));
        let want = (343.0 - 3.0 * 7.0 * 169.0) / 2000.0;
        assert!((p.x - 7.0).abs() < 1e-13 && (p.y + 13.0).abs() < 1e-13 && (p.z - want).abs() < 1e-13);
        let e = enneper().jet2(uv(0.3, -0.8));
        let (r2, want) = (0.09 + 0.64, 10.0 * (0.09 - 0.64));
        assert!((e.point.z - want).abs() < 1e-13);
        // E = G = (1 + u^2 + v^2)^2, F = 0.
        let g = 100.0 * (1.0 + r2) * (1.0 + r2);
        assert!((e.du.norm_squared() - g).abs() < 1e-11 && (e.dv.norm_squared() - g).abs() < 1e-11);
        assert!(e.du.dot(&e.dv).abs() < 1e-11);
    }
}
