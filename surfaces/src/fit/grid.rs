//! Surfaces through or near a grid of points: a row of equations along u, then one along v.

use super::curve::{
    Basis, approximation_basis, check_degree, check_finite, check_poles, interpolation_basis, near,
};
use super::params::{Spacing, mean, parameters};
use super::solve::{Row, solve};
use super::{FitError, Misfit};
use crate::nurbs::{Net, NurbsSurface};
use nalgebra::DMatrix;
use osculate_geom::{Point3, Side, Surface, uv};

/// Points in rows: point (i, j) is at `i * count[1] + j`, v fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Number of points along u and v.
    pub count: [usize; 2],
    /// The points, mm.
    pub points: Vec<Point3>,
}

/// A surface, the parameters of the grid's lines and how far off the points are.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct SurfaceFit {
    /// The surface over [0, 1] x [0, 1] (shifted along a closed axis of even degree).
    pub surface: NurbsSurface,
    /// Parameters of the rows along u and of the columns along v.
    pub parameters: [Vec<f64>; 2],
    /// How far the points are off.
    pub misfit: Misfit,
}

impl Grid {
    fn check(&self) -> Result<(), FitError> {
        let need = self.count[0].saturating_mul(self.count[1]);
        if self.points.len() != need {
            return Err(FitError::Count { got: self.points.len(), need });
        }
        check_finite(&self.points)
    }

    /// The mean parameters along an axis over all lines. Lines that shrink to a point do not count.
    fn parameters(&self, axis: usize, spacing: Spacing, closed: bool) -> Result<Vec<f64>, FitError> {
        let [n, m] = self.count;
        let lines = if axis == 0 { m } else { n };
        let mut rows = Vec::with_capacity(lines);
        let mut refused = None;
        for k in 0..lines {
            let line: Vec<Point3> = if axis == 0 {
                (0..n).map(|i| self.points[i * m + k]).collect()
            } else {
                self.points[k * m..(k + 1) * m].to_vec()
            };
            match parameters(&line, spacing, closed) {
                Ok(t) => rows.push(t),
                Err(e) => {
                    refused = refused.or(Some(e));
                }
            }
        }
        if rows.is_empty() {
            Err(refused.unwrap_or(FitError::Count { got: 0, need: 1 }))
        } else {
            Ok(mean(&rows))
        }
    }
}

/// The surface of the given degrees through all points of a grid. A line closed along an axis does not repeat
/// its first point.
///
/// ```
/// use osculate_geom::{Point3, Surface, uv};
/// use osculate_surfaces::fit::{Grid, Spacing, interpolate_grid};
/// // 4 x 5 points of z = x y: the surface between them is that too.
/// let at = |x: f64, y: f64| Point3::new(x, y, x * y);
/// let points = (0..4).flat_map(|i| (0..5).map(move |j| at(f64::from(i), f64::from(j)))).collect();
/// let fit = interpolate_grid(&Grid { count: [4, 5], points }, [3, 3], Spacing::Uniform, [false; 2])?;
/// assert!((fit.surface.point(uv(0.5, 0.5)) - at(1.5, 2.0)).norm() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`FitError`].
pub fn interpolate_grid(
    grid: &Grid,
    degree: [usize; 2],
    spacing: Spacing,
    closed: [bool; 2],
) -> Result<SurfaceFit, FitError> {
    grid.check()?;
    for a in 0..2 {
        check_degree(degree[a], grid.count[a], degree[a] + 1 + usize::from(closed[a]))?;
    }
    let t = [grid.parameters(0, spacing, closed[0])?, grid.parameters(1, spacing, closed[1])?];
    let basis = |a: usize| interpolation_basis(degree[a], &t[a], closed[a]);
    fit(grid, [basis(0)?, basis(1)?], &t, |basis, t, rhs| {
        let rows: Vec<Row> = t.iter().map(|t| basis.row(*t, 0)).collect();
        solve(&rows, rhs)
    })
}

/// The surface of the given degrees and numbers of poles near the points of a grid, by least squares along u
/// and then along v.
///
/// # Errors
/// [`FitError`].
pub fn approximate_grid(
    grid: &Grid,
    degree: [usize; 2],
    poles: [usize; 2],
    spacing: Spacing,
    closed: [bool; 2],
) -> Result<SurfaceFit, FitError> {
    grid.check()?;
    for a in 0..2 {
        check_degree(degree[a], grid.count[a], degree[a] + 2)?;
        check_poles(degree[a], poles[a], grid.count[a])?;
    }
    let t = [grid.parameters(0, spacing, closed[0])?, grid.parameters(1, spacing, closed[1])?];
    let basis = |a: usize| approximation_basis(degree[a], poles[a], &t[a], closed[a]);
    fit(grid, [basis(0)?, basis(1)?], &t, near)
}

/// Solves along u for every column, then along v for every row of poles.
fn fit(
    grid: &Grid,
    basis: [Basis; 2],
    parameters: &[Vec<f64>; 2],
    line: impl Fn(&Basis, &[f64], &DMatrix<f64>) -> Result<DMatrix<f64>, FitError>,
) -> Result<SurfaceFit, FitError> {
    let [n, m] = grid.count;
    let [bu, bv] = &basis;
    let along = DMatrix::from_fn(n, 3 * m, |i, k| grid.points[i * m + k / 3][k % 3]);
    let x = line(bu, &parameters[0][..n], &along)?;
    let rows = bu.unknowns();
    let across = DMatrix::from_fn(m, 3 * rows, |j, k| x[(k / 3, 3 * j + k % 3)]);
    let y = line(bv, &parameters[1][..m], &across)?;
    let columns = bv.unknowns();
    let count = [bu.knots.poles(), bv.knots.poles()];
    let points = (0..count[0] * count[1])
        .map(|k| {
            let (i, j) = ((k / count[1]) % rows, (k % count[1]) % columns);
            Point3::new(y[(j, 3 * i)], y[(j, 3 * i + 1)], y[(j, 3 * i + 2)])
        })
        .collect();
    let knots = [bu.knots.clone(), bv.knots.clone()];
    let surface = NurbsSurface::checked(knots, Net { count, points, weights: None }, Side::Along);
    let u: Vec<f64> = parameters[0][..n].iter().map(|t| bu.bring(*t)).collect();
    let v: Vec<f64> = parameters[1][..m].iter().map(|t| bv.bring(*t)).collect();
    let misfit =
        Misfit::of((0..n * m).map(|k| (surface.point(uv(u[k / m], v[k % m])) - grid.points[k]).norm()));
    Ok(SurfaceFit { surface, parameters: [u, v], misfit })
}
