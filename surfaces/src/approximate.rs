//! Any surface as a bicubic one within a tolerance.
//!
//! On every cell of a grid the bicubic polynomial takes point, S_u, S_v and S_uv of the surface at the four
//! corners, so that neighbouring cells join with continuous derivatives. Its error falls with the fourth power
//! of the cell; cells in rows and columns that miss the tolerance are halved.
//!
//! The error is measured, not proven: at sixteen places of every cell, at the same parameters, where a
//! quartic remainder is at its largest within a few percent. Features smaller than a cell at the start (an
//! eighth of every smooth piece) can be missed.

use crate::knots::Knots;
use crate::nurbs::{Net, NurbsSurface};
use osculate_geom::{Axis, Domain, Interval, Point3, Surface, Uv, Vec3, uv};

/// A surface near another one.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Approximation {
    /// The bicubic surface, over the rectangle asked for.
    pub surface: NurbsSurface,
    /// Largest distance measured between points at the same parameters.
    pub error_mm: f64,
    /// Root of the mean of its square over all places measured.
    pub rms_mm: f64,
}

/// Why no surface within the tolerance was made.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ApproximateError {
    /// A rectangle without end or empty.
    #[error("the range [{lo}, {hi}] along {axis:?} must be finite and not empty")]
    Range {
        /// Along which parameter.
        axis: Axis,
        /// Lower end.
        lo: f64,
        /// Upper end.
        hi: f64,
    },
    /// A tolerance that is not positive.
    #[error("a tolerance of {got_mm} mm: it must be positive")]
    Tolerance {
        /// Its value.
        got_mm: f64,
    },
    /// A place where the surface is no number.
    #[error("the surface is not finite at u = {}, v = {}", at.u, at.v)]
    NotFinite {
        /// Where.
        at: Uv,
    },
    /// The cells allowed are not enough.
    #[error("{cells} cells still miss the tolerance of {tolerance_mm} mm by {error_mm} mm near u = {}, v = {}", at.u, at.v)]
    TooFine {
        /// Cells used.
        cells: usize,
        /// The tolerance.
        tolerance_mm: f64,
        /// What was reached.
        error_mm: f64,
        /// The worst place.
        at: Uv,
    },
}

/// Most cells: 65 thousand need 8 MB of poles.
const MAX_CELLS: usize = 1 << 16;

/// Cells of every smooth piece to begin with, each way.
const FIRST: usize = 2;

/// Where a cell is measured, each way.
const PLACES: [f64; 4] = [0.15, 0.4, 0.6, 0.85];

/// The bicubic surface over `domain` that stays within `tolerance_mm` of `surface` at the places measured.
///
/// ```
/// use osculate_geom::{Domain, Interval, Surface, analytic::Sphere, uv};
/// use osculate_surfaces::approximate;
/// // A piece of a ball without weights: a thousandth of a millimetre off its radius at most.
/// let part = Domain { u: Interval::new(0.0, 1.0), v: Interval::new(-0.5, 0.5) };
/// let near = approximate(&Sphere::new(10.0)?, &part, 1e-3)?;
/// assert!(near.error_mm <= 1e-3 && !near.surface.is_rational());
/// assert!((near.surface.point(uv(0.3, 0.2)).coords.norm() - 10.0).abs() <= 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ApproximateError`].
pub fn approximate(
    surface: &dyn Surface,
    domain: &Domain,
    tolerance_mm: f64,
) -> Result<Approximation, ApproximateError> {
    for axis in [Axis::U, Axis::V] {
        let Interval { lo, hi, .. } = domain.get(axis);
        if !(lo.is_finite() && hi.is_finite() && hi > lo) {
            return Err(ApproximateError::Range { axis, lo, hi });
        }
    }
    if tolerance_mm <= 0.0 || tolerance_mm.is_nan() {
        return Err(ApproximateError::Tolerance { got_mm: tolerance_mm });
    }
    let mut lines = [Axis::U, Axis::V].map(|axis| {
        let i = domain.get(axis);
        let inner = surface.breaks(axis).into_iter().filter(|t| *t > i.lo && *t < i.hi);
        let ends: Vec<f64> = std::iter::once(i.lo).chain(inner).chain([i.hi]).collect();
        let mut all: Vec<f64> = ends
            .windows(2)
            .flat_map(|w| (0..FIRST).map(move |k| w[0] + (w[1] - w[0]) * k as f64 / FIRST as f64))
            .collect();
        all.push(i.hi);
        all
    });
    loop {
        let made = hermite(surface, &lines)?;
        let measured = measure(surface, &made, &lines)?;
        if measured.worst_mm <= tolerance_mm {
            let rms_mm = measured.mean_square.sqrt();
            return Ok(Approximation { surface: made, error_mm: measured.worst_mm, rms_mm });
        }
        let cells = (lines[0].len() - 1) * (lines[1].len() - 1);
        let too_fine = ApproximateError::TooFine {
            cells,
            tolerance_mm,
            error_mm: measured.worst_mm,
            at: measured.worst_at,
        };
        let mut halved = false;
        for (axis, lines) in lines.iter_mut().enumerate() {
            let bad: Vec<bool> = measured.strips[axis].iter().map(|e| *e > 0.5 * tolerance_mm).collect();
            let mut next = Vec::with_capacity(2 * lines.len());
            for (k, w) in lines.windows(2).enumerate() {
                next.push(w[0]);
                let middle = 0.5 * (w[0] + w[1]);
                if bad[k] && middle > w[0] && middle < w[1] {
                    next.push(middle);
                    halved = true;
                }
            }
            next.push(lines[lines.len() - 1]);
            *lines = next;
        }
        if !halved || (lines[0].len() - 1).saturating_mul(lines[1].len() - 1) > MAX_CELLS {
            return Err(too_fine);
        }
    }
}

/// The bicubic surface that takes the surface's derivatives at the crossings of the lines.
fn hermite(surface: &dyn Surface, lines: &[Vec<f64>; 2]) -> Result<NurbsSurface, ApproximateError> {
    let [us, vs] = lines;
    let count = [2 * us.len(), 2 * vs.len()];
    let mut points = vec![Point3::origin(); count[0] * count[1]];
    for (i, u) in us.iter().enumerate() {
        for (j, v) in vs.iter().enumerate() {
            let jet = surface.jet2(uv(*u, *v));
            let finite = |v: &Vec3| v.iter().all(|c| c.is_finite());
            if ![&jet.point.coords, &jet.du, &jet.dv, &jet.duv].into_iter().all(finite) {
                return Err(ApproximateError::NotFinite { at: uv(*u, *v) });
            }
            // The two poles at a double knot stand a third of the neighbouring interval before and behind it.
            for (a, hu) in thirds(us, i).into_iter().enumerate() {
                for (b, hv) in thirds(vs, j).into_iter().enumerate() {
                    let p = jet.point + jet.du * hu + jet.dv * hv + jet.duv * (hu * hv);
                    points[(2 * i + a) * count[1] + 2 * j + b] = p;
                }
            }
        }
    }
    let knots = [us, vs].map(|lines| {
        // Double inside, four at the ends.
        let mut k: Vec<f64> = lines.iter().flat_map(|t| [*t, *t]).collect();
        k.splice(0..0, [lines[0]; 2]);
        k.extend([lines[lines.len() - 1]; 2]);
        let poles = k.len() - 4;
        Knots::with_spans(3, k, poles)
    });
    let side = surface.jet2(uv(us[0], vs[0])).side;
    Ok(NurbsSurface::checked(knots, Net { count, points, weights: None }, side))
}

/// Steps from a line to its two poles.
fn thirds(lines: &[f64], k: usize) -> [f64; 2] {
    let before = if k > 0 { (lines[k - 1] - lines[k]) / 3.0 } else { 0.0 };
    let behind = if k + 1 < lines.len() { (lines[k + 1] - lines[k]) / 3.0 } else { 0.0 };
    [before, behind]
}

/// What was measured.
struct Measured {
    worst_mm: f64,
    worst_at: Uv,
    mean_square: f64,
    /// Largest error of each strip between two lines along u and v that halving that strip can mend.
    strips: [Vec<f64>; 2],
}

fn measure(
    surface: &dyn Surface,
    made: &NurbsSurface,
    lines: &[Vec<f64>; 2],
) -> Result<Measured, ApproximateError> {
    let [us, vs] = lines;
    let mut m = Measured {
        worst_mm: 0.0,
        worst_at: uv(us[0], vs[0]),
        mean_square: 0.0,
        strips: [vec![0.0; us.len() - 1], vec![0.0; vs.len() - 1]],
    };
    let mut count = 0.0;
    let error = |at: Uv| -> Result<f64, ApproximateError> {
        let e = (surface.point(at) - made.point(at)).norm();
        if e.is_finite() { Ok(e) } else { Err(ApproximateError::NotFinite { at }) }
    };
    for (i, u) in us.windows(2).enumerate() {
        for (j, v) in vs.windows(2).enumerate() {
            let place = |f: f64, g: f64| uv(u[0] + (u[1] - u[0]) * f, v[0] + (v[1] - v[0]) * g);
            for f in PLACES {
                for g in PLACES {
                    let e = error(place(f, g))?;
                    m.mean_square += e * e;
                    count += 1.0;
                    if e > m.worst_mm {
                        (m.worst_mm, m.worst_at) = (e, place(f, g));
                    }
                }
            }
            // Along a line of the grid only the other direction's step is at fault.
            let along = error(place(0.5, 0.0))?.max(error(place(0.5, 1.0))?);
            let across = error(place(0.0, 0.5))?.max(error(place(1.0, 0.5))?);
            let inside = error(place(0.5, 0.5))?;
            // What neither side shows is due to both.
            let both = if inside > 2.0 * (along + across) { inside } else { 0.0 };
            m.strips[0][i] = m.strips[0][i].max(along).max(both);
            m.strips[1][j] = m.strips[1][j].max(across).max(both);
            for (e, at) in [(along, place(0.5, 0.0)), (across, place(0.0, 0.5)), (inside, place(0.5, 0.5))] {
                if e > m.worst_mm {
                    (m.worst_mm, m.worst_at) = (e, at);
                }
            }
        }
    }
    m.mean_square /= count;
    Ok(m)
}
