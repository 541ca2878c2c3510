//! Surfaces over sections: curves of points with differing counts, brought to common knots and joined.

use super::curve::{
    approximation_basis, check_degree, check_finite, interpolation_basis, near, right, through,
};
use super::params::{Spacing, averaged, mean, parameters};
use super::solve::{Row, solve};
use super::{FitError, Misfit, SurfaceFit};
use crate::knots::Knots;
use crate::nurbs::{Net, NurbsCurve3, NurbsSurface};
use nalgebra::{DMatrix, Vector4};
use osculate_geom::{Point3, Side, Surface, uv};
use std::collections::BTreeMap;

/// How a loft is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoftOptions {
    /// Degrees along the sections (u) and across them (v).
    pub degree: [usize; 2],
    /// How parameters follow from distances.
    pub spacing: Spacing,
    /// Whether every section is closed; its first point is not repeated.
    pub closed: bool,
    /// How far the points may be from the surface: few common knots by least squares. `None` goes through all
    /// points, with the knots of all sections; sections of as many points share theirs.
    pub tolerance_mm: Option<f64>,
}

/// The surface over sections of points: u along a section, v from the first section to the last.
///
/// Sections may have different numbers of points. Corresponding places are those of equal parameters, so that
/// all sections should begin at corresponding places and run the same way.
///
/// ```
/// use osculate_geom::{Point3, Surface, uv};
/// use osculate_surfaces::fit::{LoftOptions, Spacing, loft};
/// let section = |z: f64| (0..9).map(|k| 0.7 * f64::from(k)).map(|t| Point3::new(t, t.sin(), z)).collect();
/// let sections: Vec<Vec<Point3>> = vec![section(0.0), section(1.0), section(2.0), section(3.0)];
/// let options =
///     LoftOptions { degree: [3, 3], spacing: Spacing::Chord, closed: false, tolerance_mm: None };
/// let surface = loft(&sections, &options)?.surface;
/// assert!((surface.point(uv(1.0, 1.0)) - sections[3][8]).norm() < 1e-12);
/// # Ok::<(), osculate_surfaces::fit::FitError>(())
/// ```
///
/// # Errors
/// [`FitError`]. Sections that all have as many points are a grid: [`super::interpolate_grid`].
pub fn loft(sections: &[Vec<Point3>], options: &LoftOptions) -> Result<SurfaceFit, FitError> {
    let [p, q] = options.degree;
    check_sections(sections.len(), q)?;
    for points in sections {
        check_finite(points)?;
        check_degree(p, points.len(), p + 2)?;
    }
    let own: Vec<Vec<f64>> = sections
        .iter()
        .map(|points| parameters(points, options.spacing, options.closed))
        .collect::<Result<_, _>>()?;
    let (t, curves) = match options.tolerance_mm {
        None => {
            let t = shared(&own);
            let each = sections.iter().zip(&t).map(|(s, t)| Ok(through(s, p, t, options.closed)?.curve));
            let curves = compatible(&each.collect::<Result<Vec<_>, FitError>>()?)?;
            (t, curves)
        }
        Some(tolerance) => {
            let curves = common(sections, &own, options, tolerance)?;
            (own, curves)
        }
    };
    let (surface, v) = across(&curves, q, options.spacing)?;
    let [lo, hi] = curves[0].knots().domain();
    let bring = |t: f64| if options.closed && t < lo { (t + (hi - lo)).min(hi) } else { t };
    let misfit = Misfit::of(sections.iter().zip(&t).zip(&v).flat_map(|((points, t), v)| {
        let surface = &surface;
        points.iter().zip(t).map(move |(p, t)| (surface.point(uv(bring(*t), *v)) - p).norm())
    }));
    // The longest section's parameters stand for all.
    let longest = t.iter().max_by_key(|t| t.len()).cloned().unwrap_or_default();
    Ok(SurfaceFit { surface, parameters: [longest, v], misfit })
}

/// Parameters of sections, those of as many points brought to their mean: they then have the same knots, where a point more in one
/// section would else bring knots of all beside each other, and a surface as uneven as these lie.
fn shared(own: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut of_count: BTreeMap<usize, Vec<Vec<f64>>> = BTreeMap::new();
    for t in own {
        of_count.entry(t.len()).or_default().push(t.clone());
    }
    let means: BTreeMap<usize, Vec<f64>> = of_count.into_iter().map(|(n, rows)| (n, mean(&rows))).collect();
    own.iter().map(|t| means[&t.len()].clone()).collect()
}

fn check_sections(got: usize, degree: usize) -> Result<(), FitError> {
    check_degree(degree, got, 2)?;
    if got <= degree { Err(FitError::Sections { got, need: degree + 1 }) } else { Ok(()) }
}

/// Curves by least squares over common knots, with a third more poles until all sections are near enough.
fn common(
    sections: &[Vec<Point3>],
    t: &[Vec<f64>],
    options: &LoftOptions,
    tolerance_mm: f64,
) -> Result<Vec<NurbsCurve3>, FitError> {
    let p = options.degree[0];
    // Knots spread over the parameters of the section with the fewest points hold points of all sections.
    let fewest = t.iter().min_by_key(|t| t.len()).map_or(&t[0], |f| f);
    let most = fewest.len() - 1 - usize::from(options.closed);
    let mut poles = (p + 1).min(most);
    // The most poles that could be determined, and what they reached.
    let mut reached: Option<(usize, f64)> = None;
    loop {
        let basis = approximation_basis(p, poles, fewest, options.closed)?;
        let mut curves = Vec::with_capacity(sections.len());
        let mut worst = 0.0_f64;
        for (points, t) in sections.iter().zip(t) {
            let data = &t[..points.len()];
            let x = match (near(&basis, data, &right(points)), reached) {
                (Ok(x), _) => x,
                // This section has no points in some span: more poles are no way to the tolerance.
                (Err(FitError::Singular { .. }), Some((poles, reached_mm))) => {
                    return Err(FitError::Tolerance { tolerance_mm, poles, reached_mm });
                }
                (Err(e), _) => return Err(e),
            };
            let curve = NurbsCurve3::checked(basis.knots.clone(), basis.poles(&x), None);
            for (p, t) in points.iter().zip(data) {
                worst = worst.max((curve.point(basis.bring(*t)) - p).norm());
            }
            curves.push(curve);
        }
        if worst <= tolerance_mm {
            return Ok(curves);
        }
        if poles == most {
            return Err(FitError::Tolerance { tolerance_mm, poles, reached_mm: worst });
        }
        reached = Some((poles, worst));
        poles = (poles + poles.div_ceil(3)).min(most);
    }
}

/// The surface through curves: u along the curves, v from the first to the last. Curves of different degrees
/// and knots are made [`compatible`] first.
///
/// ```
/// use osculate_geom::{Point3, Surface, uv};
/// use osculate_surfaces::NurbsCurve3;
/// use osculate_surfaces::fit::{Spacing, skin};
/// // Three parallel edges, the middle one higher: a parabola across.
/// let edge = |y: f64, z: f64| {
///     let ends = vec![Point3::new(0.0, y, z), Point3::new(50.0, y, z)];
///     NurbsCurve3::new(1, vec![0.0, 0.0, 1.0, 1.0], ends, None)
/// };
/// let sheet = skin(&[edge(0.0, 0.0)?, edge(10.0, 4.0)?, edge(20.0, 0.0)?], 2, Spacing::Uniform)?;
/// assert!((sheet.point(uv(0.5, 0.25)) - Point3::new(25.0, 5.0, 3.0)).norm() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`FitError`].
pub fn skin(curves: &[NurbsCurve3], degree: usize, spacing: Spacing) -> Result<NurbsSurface, FitError> {
    check_sections(curves.len(), degree)?;
    Ok(across(&compatible(curves)?, degree, spacing)?.0)
}

/// The surface whose rows across interpolate the poles of compatible curves, and the parameters of the curves.
fn across(
    curves: &[NurbsCurve3],
    degree: usize,
    spacing: Spacing,
) -> Result<(NurbsSurface, Vec<f64>), FitError> {
    let poles = curves[0].poles().len();
    // Mean parameters over the rows of poles; rows that shrink to a point do not count.
    let rows: Vec<Vec<f64>> = (0..poles)
        .filter_map(|i| {
            let row: Vec<Point3> = curves.iter().map(|c| c.poles()[i]).collect();
            parameters(&row, spacing, false).ok()
        })
        .collect();
    if rows.is_empty() {
        return Err(FitError::Coincident { index: 0 });
    }
    let v = mean(&rows);
    let rational = curves.iter().any(|c| c.weights().is_some());
    let rhs = DMatrix::from_fn(curves.len(), 4 * poles, |j, k| {
        let (i, c) = (k / 4, k % 4);
        let w = curves[j].weights().map_or(1.0, |w| w[i]);
        if c < 3 { curves[j].poles()[i][c] * w } else { w }
    });
    let basis = interpolation_basis(degree, &v, false)?;
    let equations: Vec<Row> = v.iter().map(|t| basis.row(*t, 0)).collect();
    let x = solve(&equations, &rhs)?;
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for i in 0..poles {
        for j in 0..curves.len() {
            let h = Vector4::from_fn(|c, _| x[(j, 4 * i + c)]);
            let w = if rational { h.w } else { 1.0 };
            if !(w > 0.0 && w.is_finite()) {
                return Err(FitError::Singular { unknowns: curves.len() });
            }
            points.push(Point3::from(h.xyz() / w));
            weights.push(w);
        }
    }
    let knots = Knots::new(degree, v.len(), averaged(degree, &v))
        .map_err(|_| FitError::Singular { unknowns: v.len() })?;
    let net = Net { count: [poles, curves.len()], points, weights: rational.then_some(weights) };
    Ok((NurbsSurface::checked([curves[0].knots().clone(), knots], net, Side::Along), v))
}

/// Two knots nearer than this fraction of the domain are one: files that keep ten digits write them apart.
const SAME_KNOT: f64 = 1e-10;

/// The same curves with one degree and one knot vector over the domain of the first: degrees raised, domains
/// scaled, knots of each inserted into all.
///
/// # Errors
/// [`FitError::Degree`] where the degree is too high.
pub fn compatible(curves: &[NurbsCurve3]) -> Result<Vec<NurbsCurve3>, FitError> {
    let Some(first) = curves.first() else { return Err(FitError::Sections { got: 0, need: 1 }) };
    let degree = curves.iter().map(|c| c.degree()).max().unwrap_or(1);
    let [lo, hi] = first.knots().domain();
    let same = curves.iter().all(|c| c.knots() == first.knots());
    if same {
        return Ok(curves.to_vec());
    }
    let raised: Vec<NurbsCurve3> = curves
        .iter()
        .map(|c| {
            let refused =
                |_| FitError::Degree { degree, points: c.poles().len(), need: 2, most: crate::MAX_DEGREE };
            let c = c.elevated(degree - c.degree()).map_err(refused)?;
            let whole = c.restricted(c.domain()).map_err(refused)?;
            Ok(whole.over_domain([lo, hi]))
        })
        .collect::<Result<_, FitError>>()?;
    // The union of all inner knots with their greatest multiplicity.
    let slack = SAME_KNOT * (hi - lo);
    let mut union: Vec<(f64, usize)> = Vec::new();
    for c in &raised {
        for t in &c.knots().breaks()[1..c.knots().span_count()] {
            let times = c.knots().multiplicity(*t);
            let at = union.partition_point(|(u, _)| *u < *t - slack);
            match union.get_mut(at) {
                Some((u, most)) if (*u - *t).abs() <= slack => *most = times.max(*most),
                _ => union.insert(at, (*t, times)),
            }
        }
    }
    raised
        .into_iter()
        .map(|c| {
            let c = c.snapped(&union, slack);
            let more = |(t, times): &(f64, usize)| (*t, times - c.knots().multiplicity(*t).min(*times));
            let more: Vec<(f64, usize)> = union.iter().map(more).filter(|m| m.1 > 0).collect();
            c.insert_knots(&more).map_err(|_| FitError::Singular { unknowns: c.poles().len() })
        })
        .collect()
}

impl NurbsCurve3 {
    /// The same curve over another parameter interval.
    fn over_domain(&self, to: [f64; 2]) -> Self {
        let [lo, hi] = self.knots().domain();
        if [lo, hi] == to {
            return self.clone();
        }
        let at = |t: f64| {
            if t == lo {
                to[0]
            } else if t == hi {
                to[1]
            } else {
                to[0] + (to[1] - to[0]) * ((t - lo) / (hi - lo))
            }
        };
        let knots: Vec<f64> = self.knots().as_slice().iter().map(|t| at(*t)).collect();
        let poles = self.poles().len();
        Self::checked(
            Knots::with_spans(self.degree(), knots, poles),
            self.poles().to_vec(),
            self.weights().map(<[f64]>::to_vec),
        )
    }

    /// Inner knots within `slack` of common ones moved onto them.
    fn snapped(&self, common: &[(f64, usize)], slack: f64) -> Self {
        let knots: Vec<f64> = self
            .knots()
            .as_slice()
            .iter()
            .map(|t| {
                let at = common.partition_point(|(u, _)| *u < *t - slack);
                common.get(at).filter(|(u, _)| (*u - *t).abs() <= slack).map_or(*t, |(u, _)| *u)
            })
            .collect();
        let poles = self.poles().len();
        Self::checked(
            Knots::with_spans(self.degree(), knots, poles),
            self.poles().to_vec(),
            self.weights().map(<[f64]>::to_vec),
        )
    }
}
