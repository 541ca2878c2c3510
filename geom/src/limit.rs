//! Normal and curvature where the parametrisation gives none: poles, collapsed sides, cusps, corners, creases.
//!
//! [`Jet2::forms`](crate::Jet2::forms) needs S_u and S_v to span a plane. Where they do not, the surface may still have
//! one: the pole of a sphere is as round as the rest. These functions answer there, from the Taylor polynomial S over
//! the steps x, y from the place, and are [`Jet2::forms`](crate::Jet2::forms) everywhere else:
//!
//! 1. `N = S_u x S_v` is divided by the power `x^a y^b` that all of it carries, and the rest M, which does not vanish,
//!    is the normal, up to the sign of `x^a y^b` on the side that the surface lies on.
//! 2. Where a side of the rectangle is one point in space, M must be the same all along it, or the place is an
//!    [apex](LimitError::Apex).
//! 3. The curvature matrix W maps steps on the surface to turns of the normal: `W S_u = n_u`, `W S_v = n_v`. Both
//!    sides of each are divided by the power that S_u (S_v) carries. Where n_u does not carry it too the curvature is
//!    unbounded; where W is another one at another place of a collapsed side, it has no limit.
//!
//! What does not exist is an error with the numbers that show it.

use crate::domain::Interval;
use crate::forms::Forms;
use crate::jet::Side;
use crate::point::{Axis, Unit3, Uv, Vec3, uv};
use crate::series::{MAX_ORDER, Series};
use crate::surface::Surface;
use crate::taylor::{Taylor, cross, scaled, unit};
use nalgebra::{Matrix2, Matrix3};

/// How much normals and curvatures at different places of one point may differ and still be one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Angle between normals, rad.
    pub angle_rad: f64,
    /// Difference of curvature matrices, as a fraction of the largest curvature there.
    pub curvature_relative: f64,
}

impl Tolerance {
    /// For surfaces whose numbers are good to double precision: rounding of fourth derivatives, a few digits lost.
    pub const ROUNDING: Self = Self { angle_rad: 1e-9, curvature_relative: 1e-7 };
}

/// Why there is no limit.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LimitError {
    /// A point with a cone of tangents: normals at different sides of it differ.
    #[error("an apex at u = {}, v = {}: the normals around it differ by {spread_rad:.3e} rad", at.u, at.v)]
    Apex {
        /// Where.
        at: Uv,
        /// Largest angle between two of the normals, rad.
        spread_rad: f64,
    },
    /// The surface has a tangent plane but changes sides there: a cuspidal edge, or two sheets that cross.
    #[error(
        "the surface turns over at u = {}, v = {}: its normal is along ({:.6}, {:.6}, {:.6}) on one side and \
         {spread_rad:.3e} rad from that on the other", at.u, at.v, normal.x, normal.y, normal.z
    )]
    TurnsOver {
        /// Where.
        at: Uv,
        /// The normal on one side.
        normal: Unit3,
        /// Its angle to the one on another side, rad.
        spread_rad: f64,
    },
    /// S_u x S_v vanishes in a way that no power of x and y explains, to the orders that are known.
    #[error(
        "the tangent plane at u = {}, v = {} does not follow from derivatives to order {order}: |S_u x S_v| is \
         {sin_uv:.3e} of |S_u| |S_v|", at.u, at.v
    )]
    Undetermined {
        /// Where.
        at: Uv,
        /// Orders known.
        order: usize,
        /// Sine of the angle between S_u and S_v; zero where one vanishes.
        sin_uv: f64,
    },
    /// The normal turns faster than the surface goes on.
    #[error(
        "the curvature is unbounded at u = {}, v = {}: along {axis:?} the normal turns by {turn_rad:.3e} rad where the \
         point stands still", at.u, at.v
    )]
    Unbounded {
        /// Where.
        at: Uv,
        /// The parameter along which.
        axis: Axis,
        /// Turn of the normal over a span of the parameter, to first order, rad.
        turn_rad: f64,
    },
    /// The curvatures around the point differ.
    #[error(
        "the curvatures around u = {}, v = {} differ by {spread_per_mm:.3e} of {size_per_mm:.3e} 1/mm", at.u, at.v
    )]
    Varies {
        /// Where.
        at: Uv,
        /// Largest difference between two curvature matrices, 1/mm.
        spread_per_mm: f64,
        /// Largest curvature, 1/mm.
        size_per_mm: f64,
    },
}

/// Coefficients below this fraction of the largest product that they are made of are rounding: as for the sine below
/// which [`Degenerate`](crate::Degenerate) is reported.
const ZERO: f64 = 1e-11;

/// The surface near a place as seen from one quadrant of the steps.
#[derive(Clone, Copy, Debug)]
struct View {
    /// Where the polynomial is taken.
    at: Uv,
    /// Signs of the steps of u and v that lead into the quadrant.
    toward: [f64; 2],
}

/// The unit normal as series on the side of a view, and what it was divided by.
struct Normal {
    taylor: Taylor,
    normal: [Series; 3],
}

/// Length of the span that holds `t`: what a step is compared with.
fn span(breaks: &[f64], t: f64) -> f64 {
    let k = breaks.partition_point(|b| *b <= t).min(breaks.len().saturating_sub(1)).max(1);
    let length = breaks.get(k).map_or(1.0, |hi| hi - breaks[k - 1]);
    if length > 0.0 && length.is_finite() { length } else { 1.0 }
}

/// The places and directions from which one parameter can be looked at.
fn ways(i: Interval, breaks: &[f64], t: f64) -> Vec<(f64, f64)> {
    let inner = breaks.iter().any(|b| *b == t && *b > i.lo && *b < i.hi);
    if i.periodic && (t == i.lo || t == i.hi) {
        // Derivatives are one-sided at the seam: the other side's are those a rounding away.
        vec![(i.lo, 1.0), (i.hi.next_down(), -1.0)]
    } else if inner {
        vec![(t, 1.0), (t.next_down(), -1.0)]
    } else if t <= i.lo && !i.periodic {
        vec![(t, 1.0)]
    } else if t >= i.hi && !i.periodic {
        vec![(t, -1.0)]
    } else {
        vec![(t, 1.0), (t, -1.0)]
    }
}

/// A surface with its breaks at hand.
struct Known<'a> {
    surface: &'a dyn Surface,
    breaks: [Vec<f64>; 2],
}

impl<'a> Known<'a> {
    fn new(surface: &'a dyn Surface) -> Self {
        Self { surface, breaks: [surface.breaks(Axis::U), surface.breaks(Axis::V)] }
    }
    fn lengths(&self, at: Uv) -> [f64; 2] {
        [span(&self.breaks[0], at.u), span(&self.breaks[1], at.v)]
    }
}

fn views(known: &Known<'_>, at: Uv) -> Vec<View> {
    let d = known.surface.domain();
    let us = ways(d.u, &known.breaks[0], at.u);
    let vs = ways(d.v, &known.breaks[1], at.v);
    us.iter().flat_map(|u| vs.iter().map(|v| View { at: uv(u.0, v.0), toward: [u.1, v.1] })).collect()
}

/// The coefficients as a vector, in the units of a span.
fn coefficient(s: &[Series; 3], i: usize, j: usize) -> Vec3 {
    Vec3::from([s[0].coefficient(i, j), s[1].coefficient(i, j), s[2].coefficient(i, j)])
}

/// All `(i, j)` with `i + j <= order`, by degree.
fn places(order: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..=order).flat_map(|n| (0..=n).map(move |j| (n - j, j)))
}

fn largest(s: &[Series; 3]) -> f64 {
    places(s[0].order()).map(|(i, j)| coefficient(s, i, j).norm()).fold(0.0, f64::max)
}

/// The power `x^a y^b` that all of a series carries whose coefficients below `zero` vanish, if what is left does not
/// vanish.
fn power(s: &[Series; 3], zero: f64) -> Option<[usize; 2]> {
    let known = |i: usize, j: usize| coefficient(s, i, j).norm() > zero;
    let seen = || places(s[0].order()).filter(|(i, j)| known(*i, *j));
    let (a, b) = (seen().map(|p| p.0).min()?, seen().map(|p| p.1).min()?);
    (a + b <= s[0].order() && known(a, b)).then_some([a, b])
}

/// The series divided by `x^a y^b`.
fn divided(s: &[Series; 3], [a, b]: [usize; 2]) -> [Series; 3] {
    s.map(|c| Series::from_coefficients(c.order() - a - b, |i, j| c.coefficient(i + a, j + b)))
}

/// The polynomial at a view with both steps measured in spans.
fn local(known: &Known<'_>, view: View) -> Taylor {
    scaled(&known.surface.taylor(view.at, MAX_ORDER), known.lengths(view.at))
}

/// The normal on one side of a place.
fn one_sided(known: &Known<'_>, view: View) -> Result<Normal, LimitError> {
    let taylor = local(known, view);
    let (su, sv) = (taylor.differentiated(Axis::U), taylor.differentiated(Axis::V));
    let n = cross(&su, &sv);
    let size = largest(&su) * largest(&sv);
    let fail = || {
        let (a, b) = (coefficient(&su, 0, 0), coefficient(&sv, 0, 0));
        let sine = a.cross(&b).norm() / (a.norm() * b.norm());
        let sin_uv = if sine.is_finite() { sine } else { 0.0 };
        LimitError::Undetermined { at: view.at, order: taylor.order(), sin_uv }
    };
    let side = taylor.side.sign();
    if let Some([a, b]) = power(&n, ZERO * size) {
        let sign = side * view.toward[0].powi(a as i32) * view.toward[1].powi(b as i32);
        let normal = unit(&divided(&n, [a, b])).map(|c| c * sign);
        return Ok(Normal { taylor, normal });
    }
    // No single power: the lowest form may still point one way all over the quadrant.
    let lowest = places(n[0].order()).find(|(i, j)| coefficient(&n, *i, *j).norm() > ZERO * size);
    let degree = lowest.map(|(i, j)| i + j).ok_or_else(fail)?;
    let form: Vec<Vec3> = (0..=degree).map(|j| coefficient(&n, degree - j, j)).collect();
    let along = form.iter().max_by(|a, b| a.norm().total_cmp(&b.norm())).copied().unwrap_or_default();
    let along = Unit3::try_new(along, 0.0).ok_or_else(fail)?;
    if form.iter().any(|c| c.cross(&along).norm() > ZERO.sqrt() * c.norm().max(ZERO * size)) {
        return Err(fail());
    }
    // Directions over the quadrant, its sides included.
    const DIRECTIONS: usize = 64;
    let values: Vec<f64> = (0..=DIRECTIONS)
        .map(|k| {
            let (s, c) = (std::f64::consts::FRAC_PI_2 * k as f64 / DIRECTIONS as f64).sin_cos();
            let (x, y) = (c * view.toward[0], s * view.toward[1]);
            let value =
                |(j, f): (usize, &Vec3)| f.dot(&along) * x.powi((degree - j) as i32) * y.powi(j as i32);
            form.iter().enumerate().map(value).sum()
        })
        .collect();
    let (least, most) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |r, v| (r.0.min(*v), r.1.max(*v)));
    let sign = if least > ZERO * size {
        side
    } else if most < -ZERO * size {
        -side
    } else {
        return Err(fail());
    };
    let constant = [0, 1, 2].map(|k| Series::constant(along[k] * sign, 0));
    Ok(Normal { taylor, normal: constant })
}

fn value(n: &[Series; 3]) -> Unit3 {
    Unit3::new_normalize(coefficient(n, 0, 0))
}

/// Whether the surface stands still along an axis through the view.
fn collapsed(taylor: &Taylor, axis: Axis) -> bool {
    let along = taylor.differentiated(axis);
    let across = taylor.differentiated(axis.other());
    let size = largest(&along).max(largest(&across));
    (0..=along[0].order()).all(|k| {
        let (i, j) = if axis == Axis::U { (k, 0) } else { (0, k) };
        coefficient(&along, i, j).norm() <= ZERO * size
    })
}

/// Views of the same point in space: those at the place, and where a parameter line through it is a point, those along
/// all of that line. True where there is such a line.
fn all_views(known: &Known<'_>, at: Uv) -> (Vec<View>, bool) {
    /// Looked at per span of a collapsed side, its ends included: limits that agree at five places of a rational
    /// quadratic or cubic agree.
    const PER_SPAN: usize = 5;
    let mut all = views(known, at);
    let mut point = false;
    for axis in [Axis::U, Axis::V] {
        if !all.iter().any(|v| collapsed(&local(known, *v), axis)) {
            continue;
        }
        point = true;
        let across = at.get(axis.other());
        for w in known.breaks[axis as usize].windows(2).filter(|w| (w[1] - w[0]).is_finite()) {
            for k in 0..PER_SPAN {
                let t = w[0] + (w[1] - w[0]) * k as f64 / (PER_SPAN - 1) as f64;
                let t = if k + 1 == PER_SPAN { w[1].next_down() } else { t };
                all.extend(views(known, Uv::from_axis(axis, t, across)));
            }
        }
    }
    (all, point)
}

/// Angle between unit vectors, without the cancellation of the arc cosine.
fn angle_rad(a: &Unit3, b: &Unit3) -> f64 {
    a.cross(b).norm().atan2(a.dot(b))
}

/// The normal there, checked to be the same from all sides.
fn common_normal(
    surface: &dyn Surface,
    at: Uv,
    tolerance: &Tolerance,
) -> Result<(Vec<(View, Normal)>, Unit3), LimitError> {
    let known = Known::new(surface);
    let (all, point) = all_views(&known, at);
    let mut seen = Vec::with_capacity(all.len());
    for view in all {
        seen.push((view, one_sided(&known, view)?));
    }
    let first = value(&seen[0].1.normal);
    let spread_rad = widest(seen.iter().map(|s| value(&s.1.normal)));
    if spread_rad <= tolerance.angle_rad {
        Ok((seen, first))
    } else if point {
        Err(LimitError::Apex { at, spread_rad })
    } else {
        Err(LimitError::TurnsOver { at, normal: first, spread_rad })
    }
}

/// The angle between two of the directions, the largest or at least half of it.
fn widest(directions: impl Iterator<Item = Unit3>) -> f64 {
    let all: Vec<Unit3> = directions.collect();
    // From the first to the farthest, and from there to the one farthest from that.
    let far = |from: &Unit3| {
        all.iter().map(|d| (angle_rad(from, d), *d)).fold((0.0, *from), |m, x| if x.0 > m.0 { x } else { m })
    };
    all.first().map_or(0.0, |first| far(&far(first).1).0)
}

/// The outward unit normal at any place: that of the jet, or its limit.
///
/// ```
/// use osculate_geom::{analytic::Sphere, limit, uv};
/// use std::f64::consts::FRAC_PI_2;
/// let (ball, pole) = (Sphere::new(10.0)?, uv(0.4, FRAC_PI_2));
/// let n = limit::normal(&ball, pole, &limit::Tolerance::ROUNDING)?;
/// assert!((n.z - 1.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`LimitError`] where normals from different sides differ by more than the tolerance.
pub fn normal(surface: &dyn Surface, at: Uv, tolerance: &Tolerance) -> Result<Unit3, LimitError> {
    match surface.jet2(at).normal() {
        Ok(n) => Ok(n),
        Err(_) => Ok(common_normal(surface, at, tolerance)?.1),
    }
}

/// Curvature at any place: the jet's forms, or their limits.
///
/// At a limit `first` and `second` are the forms in the degenerate parameter basis as they stand, and
/// [`Forms::rate`] has no answer; normal, frame, curvature matrix and all that is made of them are those of the
/// surface. The frame's first direction is then that of the parameter which moves the point more.
///
/// ```
/// use osculate_geom::{Interval, analytic::{Cone, Sphere}, limit, uv};
/// // The pole of a ball is as round as the rest; a cone has a point there.
/// let (ball, pole) = (Sphere::new(10.0)?, uv(0.4, std::f64::consts::FRAC_PI_2));
/// let forms = limit::forms(&ball, pole, &limit::Tolerance::ROUNDING)?;
/// assert!((forms.mean() - 0.1).abs() < 1e-9);
/// let cone = Cone::new(0.0, 0.5, Interval::new(0.0, 10.0))?;
/// assert!(matches!(
///     limit::forms(&cone, uv(0.4, 0.0), &limit::Tolerance::ROUNDING),
///     Err(limit::LimitError::Apex { .. })
/// ));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`LimitError`] where there is no normal, or curvatures from different sides differ or have no bound.
pub fn forms(surface: &dyn Surface, at: Uv, tolerance: &Tolerance) -> Result<Forms, LimitError> {
    let jet = surface.jet2(at);
    if let Ok(forms) = jet.forms() {
        return Ok(forms);
    }
    let (seen, normal) = common_normal(surface, at, tolerance)?;
    let mut matrices = Vec::with_capacity(seen.len());
    for (view, n) in &seen {
        matrices.push(curvature(*view, n)?);
    }
    let size_per_mm = matrices.iter().map(Matrix3::norm).fold(0.0, f64::max);
    let apart = matrices.iter().map(|m| (m - matrices[0]).norm()).fold(0.0, f64::max);
    if apart > tolerance.curvature_relative * size_per_mm {
        return Err(LimitError::Varies { at, spread_per_mm: apart, size_per_mm });
    }
    let along = if jet.du.norm() >= jet.dv.norm() { jet.du } else { jet.dv };
    let e1 = crate::forms::project_to_tangent(&normal, &along);
    let e2 = Unit3::new_unchecked(normal.cross(&e1));
    let w = &matrices[0];
    let of = |a: &Unit3, b: &Unit3| a.dot(&(w * b.into_inner()));
    let w12 = 0.5 * (of(&e1, &e2) + of(&e2, &e1));
    let (su, sv) = (jet.du, jet.dv);
    Ok(Forms {
        first: [su.dot(&su), su.dot(&sv), sv.dot(&sv)],
        second: [jet.duu.dot(&normal), jet.duv.dot(&normal), jet.dvv.dot(&normal)],
        normal,
        frame: [e1, e2],
        curvature: Matrix2::new(of(&e1, &e1), w12, w12, of(&e2, &e2)),
    })
}

/// The curvature matrix from one side, as a tensor in space that maps tangents to turns of the normal.
fn curvature(view: View, n: &Normal) -> Result<Matrix3<f64>, LimitError> {
    let mut steps = [Vec3::zeros(); 2];
    let mut turns = [Vec3::zeros(); 2];
    let unknown = LimitError::Undetermined { at: view.at, order: n.taylor.order(), sin_uv: 0.0 };
    for (k, axis) in [Axis::U, Axis::V].into_iter().enumerate() {
        let step = n.taylor.differentiated(axis);
        let turn = n.normal.map(|c| c.differentiated(axis));
        let [a, b] = power(&step, ZERO * largest(&step)).ok_or(unknown)?;
        if n.normal[0].order() == 0 {
            return Err(unknown);
        }
        // Turns that remain where the step is divided away: those that do not carry its power.
        let lost = places(turn[0].order()).filter(|(i, j)| i + j <= a + b && (*i < a || *j < b));
        let turn_rad = lost.map(|(i, j)| coefficient(&turn, i, j).norm()).fold(0.0, f64::max);
        // Rounding of a unit vector's derivatives, each order of which loses some digits.
        if turn_rad > ZERO.sqrt() * 1e-2 {
            return Err(LimitError::Unbounded { at: view.at, axis, turn_rad });
        }
        if a + b > turn[0].order() {
            return Err(unknown);
        }
        steps[k] = coefficient(&step, a, b);
        turns[k] = coefficient(&turn, a, b);
    }
    // W [S_u S_v n] = [n_u n_v 0].
    let n0 = value(&n.normal).into_inner();
    let from = Matrix3::from_columns(&[steps[0], steps[1], n0]);
    let to = Matrix3::from_columns(&[turns[0], turns[1], Vec3::zeros()]);
    from.try_inverse().map(|inverse| to * inverse).ok_or(unknown)
}

/// The normal on one side of a place.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SideNormal {
    /// Signs of the steps of u and v that lead to that side.
    pub toward: [f64; 2],
    /// The outward normal there.
    pub normal: Unit3,
}

/// The normals on all sides of a place: one where the surface is smooth, more on a crease or seam, at a knot, or where
/// the surface turns over. Sides that agree to the tolerance are given once.
///
/// # Errors
/// [`LimitError::Undetermined`] where a side has none.
pub fn sides(surface: &dyn Surface, at: Uv, tolerance: &Tolerance) -> Result<Vec<SideNormal>, LimitError> {
    let mut found: Vec<SideNormal> = Vec::new();
    let known = Known::new(surface);
    for view in views(&known, at) {
        let normal = value(&one_sided(&known, view)?.normal);
        if found.iter().all(|f| angle_rad(&f.normal, &normal) > tolerance.angle_rad) {
            found.push(SideNormal { toward: view.toward, normal });
        }
    }
    Ok(found)
}

/// The outward normal as series about a place, one-sided where the surface has none there: for offsets.
pub(crate) fn normal_series(surface: &dyn Surface, at: Uv, order: usize) -> Option<[Series; 3]> {
    let t = surface.taylor(at, order + 1);
    let n = cross(&t.differentiated(Axis::U), &t.differentiated(Axis::V));
    if surface.jet2(at).normal().is_ok() {
        let sign = if t.side == Side::Along { 1.0 } else { -1.0 };
        return Some(unit(&n).map(|c| c * sign));
    }
    let known = Known::new(surface);
    let view = *views(&known, at).first()?;
    let lengths = known.lengths(view.at);
    let found = one_sided(&known, view).ok()?;
    let back = lengths.map(|l| 1.0 / l);
    Some(crate::taylor::rescaled(&found.normal, back).map(|c| c.truncated(order)))
}
