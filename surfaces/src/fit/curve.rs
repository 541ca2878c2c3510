//! Curves through or near a row of points.

use super::params::{Spacing, averaged, closed_breaks, parameters, periodic, spread, spread_closed};
use super::solve::{Row, least_squares, solve};
use super::{FitError, Misfit};
use crate::knots::{Knots, MAX_DEGREE};
use crate::nurbs::NurbsCurve;
use nalgebra::{DMatrix, Point, SVector};

/// What holds at the ends of an interpolating curve.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Ends<const D: usize> {
    /// Nothing: as many poles as points, any degree.
    Free,
    /// No curvature: the second derivative vanishes. A cubic with its knots at the points.
    Natural,
    /// Given derivatives by the parameter, which runs from 0 to 1 over the whole curve. A cubic with its knots
    /// at the points.
    Tangents([SVector<f64, D>; 2]),
    /// The last point is followed by the first, smoothly: knots that continue periodically.
    Closed,
}

/// A curve, the parameters of the points and how far off they are.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct CurveFit<const D: usize> {
    /// The curve over [0, 1]; over [h, 1 + h] for a closed one of even degree.
    pub curve: NurbsCurve<D>,
    /// The parameter of each point.
    pub parameters: Vec<f64>,
    /// How far the points are off.
    pub misfit: Misfit,
}

/// The basis of a fit: knots, and whether pole i is pole i + poles again.
#[derive(Clone, Debug)]
pub(super) struct Basis {
    pub(super) knots: Knots,
    pub(super) closed: bool,
}

impl Basis {
    pub(super) fn new(degree: usize, knots: Vec<f64>, closed: bool) -> Result<Self, FitError> {
        let poles = knots.len() - degree - 1;
        // Neighbours too near for their parameters to differ.
        let knots = Knots::new(degree, poles, knots).map_err(|_| FitError::Singular { unknowns: poles })?;
        Ok(Self { knots, closed })
    }

    /// Different poles.
    pub(super) fn unknowns(&self) -> usize {
        self.knots.poles() - if self.closed { self.knots.degree() } else { 0 }
    }

    /// A parameter in the domain of the knots.
    pub(super) fn bring(&self, t: f64) -> f64 {
        let [lo, hi] = self.knots.domain();
        if self.closed && t < lo { (t + (hi - lo)).min(hi) } else { t }
    }

    /// The equation of the derivative of some order (0, 1 or 2) at t.
    pub(super) fn row(&self, t: f64, order: usize) -> Row {
        let t = self.bring(t);
        let basis = self.knots.basis(self.knots.find(t), t);
        let n = self.unknowns();
        (0..=self.knots.degree()).map(|r| ((basis.first + r) % n, basis.order[order][r])).collect()
    }

    /// The poles of the knots from the solution's rows.
    pub(super) fn poles<const D: usize>(&self, x: &DMatrix<f64>) -> Vec<Point<f64, D>> {
        let n = self.unknowns();
        (0..self.knots.poles()).map(|i| Point::from(SVector::from_fn(|c, _| x[(i % n, c)]))).collect()
    }
}

/// Refuses numbers that are not finite.
pub(super) fn check_finite<const D: usize>(points: &[Point<f64, D>]) -> Result<(), FitError> {
    for (index, p) in points.iter().enumerate() {
        if let Some(got) = p.iter().copied().find(|c| !c.is_finite()) {
            return Err(FitError::NotFinite { index, got });
        }
    }
    Ok(())
}

/// Refuses degrees that the points do not carry.
pub(super) fn check_degree(degree: usize, points: usize, need: usize) -> Result<(), FitError> {
    if degree == 0 || degree > MAX_DEGREE || points < need {
        return Err(FitError::Degree { degree, points, need, most: MAX_DEGREE });
    }
    Ok(())
}

/// The basis for interpolation at the parameters.
pub(super) fn interpolation_basis(
    degree: usize,
    parameters: &[f64],
    closed: bool,
) -> Result<Basis, FitError> {
    let knots = if closed {
        periodic(degree, &closed_breaks(degree, parameters))
    } else {
        averaged(degree, parameters)
    };
    Basis::new(degree, knots, closed)
}

/// The right-hand sides of points.
pub(super) fn right<const D: usize>(points: &[Point<f64, D>]) -> DMatrix<f64> {
    DMatrix::from_fn(points.len(), D, |i, c| points[i][c])
}

/// The curve of a degree through all points.
///
/// A closed row does not repeat its first point.
///
/// ```
/// use osculate_geom::Point3;
/// use osculate_surfaces::fit::{Ends, Spacing, interpolate};
/// // Through five points of a parabola at even steps: a cubic can be that parabola, and is.
/// let points: Vec<Point3> = (0..5).map(f64::from).map(|x| Point3::new(x, x * x, 0.0)).collect();
/// let fit = interpolate(&points, 3, Spacing::Uniform, &Ends::Free)?;
/// assert!(fit.misfit.max_mm < 1e-12);
/// assert!((fit.curve.point(0.375) - Point3::new(1.5, 2.25, 0.0)).norm() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`FitError`].
pub fn interpolate<const D: usize>(
    points: &[Point<f64, D>],
    degree: usize,
    spacing: Spacing,
    ends: &Ends<D>,
) -> Result<CurveFit<D>, FitError> {
    check_finite(points)?;
    let closed = matches!(ends, Ends::Closed);
    let cubic = matches!(ends, Ends::Natural | Ends::Tangents(_));
    if cubic && degree != 3 {
        return Err(FitError::Ends { degree });
    }
    let need = if cubic { 2 } else { degree + 1 + usize::from(closed) };
    check_degree(degree, points.len(), need)?;
    let t = parameters(points, spacing, closed)?;
    let data = &t[..points.len()];
    let (basis, rows, rhs) = if cubic {
        let knots = [&[0.0; 3][..], &t, &[1.0; 3]].concat();
        let basis = Basis::new(degree, knots, false)?;
        let (order, values) = match ends {
            Ends::Tangents(d) => (1, *d),
            _ => (2, [SVector::zeros(); 2]),
        };
        let mut rows: Vec<Row> = data.iter().map(|t| basis.row(*t, 0)).collect();
        let last = rows.len();
        // Beside the equations of the end points, so that entries stay near the diagonal.
        rows.insert(last - 1, basis.row(1.0, order));
        rows.insert(1, basis.row(0.0, order));
        let mut all: Vec<Point<f64, D>> = points.to_vec();
        all.insert(last - 1, Point::from(values[1]));
        all.insert(1, Point::from(values[0]));
        (basis, rows, right(&all))
    } else {
        return through(points, degree, &t, closed);
    };
    let x = solve(&rows, &rhs)?;
    Ok(finish(&basis, &x, points, data))
}

/// The curve of a degree that is at each point at its parameter; a closed row has one parameter more, of its first point again.
pub(super) fn through<const D: usize>(
    points: &[Point<f64, D>],
    degree: usize,
    parameters: &[f64],
    closed: bool,
) -> Result<CurveFit<D>, FitError> {
    let data = &parameters[..points.len()];
    let basis = interpolation_basis(degree, parameters, closed)?;
    let rows: Vec<Row> = data.iter().map(|t| basis.row(*t, 0)).collect();
    let x = solve(&rows, &right(points))?;
    Ok(finish(&basis, &x, points, data))
}

/// The curve of the solution and its misfit.
fn finish<const D: usize>(
    basis: &Basis,
    x: &DMatrix<f64>,
    points: &[Point<f64, D>],
    parameters: &[f64],
) -> CurveFit<D> {
    let curve = NurbsCurve::checked(basis.knots.clone(), basis.poles(x), None);
    let parameters: Vec<f64> = parameters.iter().map(|t| basis.bring(*t)).collect();
    let misfit = Misfit::of(points.iter().zip(&parameters).map(|(p, t)| (curve.point(*t) - p).norm()));
    CurveFit { curve, parameters, misfit }
}

/// The basis for `poles` poles that the parameters determine.
pub(super) fn approximation_basis(
    degree: usize,
    poles: usize,
    parameters: &[f64],
    closed: bool,
) -> Result<Basis, FitError> {
    let knots = if closed {
        periodic(degree, &spread_closed(poles, parameters))
    } else {
        spread(degree, poles, parameters)
    };
    Basis::new(degree, knots, closed)
}

/// Poles by least squares for any number of right-hand sides. The ends of an open row are kept exactly.
pub(super) fn near(basis: &Basis, parameters: &[f64], rhs: &DMatrix<f64>) -> Result<DMatrix<f64>, FitError> {
    let rows: Vec<Row> = parameters.iter().map(|t| basis.row(*t, 0)).collect();
    let n = basis.unknowns();
    if basis.closed {
        return least_squares(&rows, n, rhs);
    }
    let (last, m) = (n - 1, parameters.len());
    let mut x = DMatrix::zeros(n, rhs.ncols());
    x.row_mut(0).copy_from(&rhs.row(0));
    x.row_mut(last).copy_from(&rhs.row(m - 1));
    if n > 2 {
        // What the kept poles leave to the others.
        let mut rest = rhs.rows(1, m - 2).into_owned();
        let mut inner: Vec<Row> = Vec::with_capacity(m - 2);
        for (k, row) in rows[1..m - 1].iter().enumerate() {
            for (i, f) in row {
                if *i == 0 || *i == last {
                    for c in 0..rhs.ncols() {
                        rest[(k, c)] -= f * x[(*i, c)];
                    }
                }
            }
            inner.push(row.iter().filter(|(i, _)| *i > 0 && *i < last).map(|(i, f)| (i - 1, *f)).collect());
        }
        let solved = least_squares(&inner, n - 2, &rest)?;
        x.rows_mut(1, n - 2).copy_from(&solved);
    }
    Ok(x)
}

/// The range of pole counts that points determine.
pub(super) fn check_poles(degree: usize, poles: usize, points: usize) -> Result<(), FitError> {
    let (least, most) = (degree + 1, points.saturating_sub(1));
    if poles < least || poles > most {
        return Err(FitError::Poles { poles, degree, points, least, most });
    }
    Ok(())
}

/// The curve of a degree with a number of poles that has the least sum of squared distances from the points at
/// their parameters. An open curve keeps its end points; a closed row does not repeat its first point.
///
/// # Errors
/// [`FitError`].
pub fn approximate<const D: usize>(
    points: &[Point<f64, D>],
    degree: usize,
    poles: usize,
    spacing: Spacing,
    closed: bool,
) -> Result<CurveFit<D>, FitError> {
    check_finite(points)?;
    check_degree(degree, points.len(), degree + 2)?;
    check_poles(degree, poles, points.len())?;
    let t = parameters(points, spacing, closed)?;
    let data = &t[..points.len()];
    let basis = approximation_basis(degree, poles, &t, closed)?;
    let x = near(&basis, data, &right(points))?;
    Ok(finish(&basis, &x, points, data))
}

/// The curve of [`approximate`] with few poles whose misfit is within the tolerance: a third more poles until
/// it holds.
///
/// ```
/// use osculate_geom::Point3;
/// use osculate_surfaces::fit::{FitError, Spacing, approximate_within};
/// // A hundred points of a sine: a few poles do within a hundredth of a millimetre, none within zero.
/// let points: Vec<Point3> =
///     (0..100).map(|k| 0.1 * f64::from(k)).map(|x| Point3::new(x, x.sin(), 0.0)).collect();
/// let fit = approximate_within(&points, 3, 0.01, Spacing::Chord, false)?;
/// assert!(fit.misfit.max_mm <= 0.01 && fit.curve.poles().len() < 30);
/// let none = approximate_within(&points, 3, 0.0, Spacing::Chord, false);
/// assert!(matches!(none, Err(FitError::Tolerance { .. })));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`FitError::Tolerance`] where as many poles as points less one miss it; otherwise as [`approximate`].
pub fn approximate_within<const D: usize>(
    points: &[Point<f64, D>],
    degree: usize,
    tolerance_mm: f64,
    spacing: Spacing,
    closed: bool,
) -> Result<CurveFit<D>, FitError> {
    let most = points.len().saturating_sub(1);
    let mut poles = degree + 1;
    loop {
        let fit = approximate(points, degree, poles, spacing, closed)?;
        if fit.misfit.max_mm <= tolerance_mm {
            return Ok(fit);
        }
        if poles == most {
            return Err(FitError::Tolerance { tolerance_mm, poles, reached_mm: fit.misfit.max_mm });
        }
        poles = (poles + poles.div_ceil(3)).min(most);
    }
}
