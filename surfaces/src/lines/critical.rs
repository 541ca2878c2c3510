//! Minima, maxima and saddles of a scalar field inside a face.
//!
//! They are the zeros of the field's gradient in the parameters, found as [`zeros`](super::zeros) finds them; the
//! rotation of the gradient is +1 around an extremum and -1 around a saddle. Extremes on the border are not among
//! them: there the gradient does not vanish.

use super::chart::{Chart, Pole};
use super::field::ScalarField;
use super::zeros::{Plane, Zero, boundary_rotation, zeros};
use osculate_geom::{Axis, Point3, Uv, uv};

/// What a field does at a critical point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CriticalKind {
    /// It is smallest there.
    Minimum,
    /// It is greatest there.
    Maximum,
    /// It rises and falls in two directions each, or in more (a monkey saddle).
    Saddle,
    /// Neither: the second derivatives vanish, or the turn of the gradient could not be counted.
    Degenerate,
}

/// A critical point.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Critical {
    /// Where.
    pub at: Uv,
    /// The point, mm.
    pub point: Point3,
    /// The field there.
    pub value: f64,
    /// What the field does.
    pub kind: CriticalKind,
    /// Turns of the gradient around the point.
    pub index: Option<i32>,
    /// Whether it lies on the face, inside its trims.
    pub inside: bool,
}

/// All critical points of a field.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct CriticalPoints {
    /// Isolated ones, of the whole parameter rectangle.
    pub points: Vec<Critical>,
    /// Places along lines of critical points, as on the top of a torus.
    pub lines: Vec<Vec<Uv>>,
    /// Middles of cells in which the field is constant.
    pub flat: Vec<Uv>,
    /// Whether the sum of the indices agrees with the gradient's turn along the border; `None` where there are lines
    /// or constant regions, or the gradient vanishes on the border.
    pub confirmed: Option<bool>,
    /// Cells that were searched less finely than others, since critical points are all over the face: the field is noise.
    pub coarse_cells: usize,
}

impl CriticalPoints {
    /// The points on the face of one kind.
    pub fn inside(&self, kind: CriticalKind) -> impl Iterator<Item = &Critical> {
        self.points.iter().filter(move |c| c.inside && c.kind == kind)
    }
}

/// A gradient that changes the field by less than this part of its range over the whole face is zero.
const FLAT: f64 = 1e-9;

/// All critical points of a field whose gradient is known; without a gradient there are none.
///
/// ```
/// use osculate_geom::{Vec3, analytic::Paraboloid};
/// use osculate_surfaces::lines::{Chart, CriticalKind, Height, LineTolerance, critical_points};
/// // The bottom of a bowl is its only critical height.
/// let bowl = Paraboloid::new([0.01, 0.02], 20.0)?;
/// let chart = Chart::new(&bowl, LineTolerance::for_size(60.0))?;
/// let found = critical_points(&chart, &Height { axis: Vec3::z_axis() });
/// let lowest: Vec<_> = found.inside(CriticalKind::Minimum).collect();
/// assert!(found.points.len() == 1 && lowest.len() == 1 && lowest[0].point.coords.norm() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn critical_points(chart: &Chart, field: &dyn ScalarField) -> CriticalPoints {
    let surface = chart.surface();
    let d = chart.domain();
    // In parts of the rectangle, so that both components have the field's unit.
    let gradient = |at: Uv| {
        let g = field.sample(surface, at)?.gradient?;
        Some([g[0] * d.u.length(), g[1] * d.v.length()])
    };
    let gradient: Plane = &gradient;
    // A field that is constant but for its rounding has no critical points, and its noise would have them everywhere.
    let rounding = field.rounding(chart.scale());
    let found = zeros(chart, gradient, rounding.max(FLAT * range(chart, field)));
    let mut points: Vec<Critical> =
        found.points.iter().filter_map(|z| describe(chart, field, gradient, z)).collect();
    let sum = found.points.iter().map(|z| z.rotation).try_fold(0, |sum, r| r.map(|r| sum + r));
    let whole = found.lines.is_empty() && found.flat.is_empty() && found.undefined == 0;
    let confirmed = match (sum, boundary_rotation(chart, gradient)) {
        (Some(sum), Some(border)) if whole => Some(sum == border),
        _ => None,
    };
    points.extend(chart.poles().iter().filter_map(|p| describe_pole(chart, field, p)));
    CriticalPoints { points, lines: found.lines, flat: found.flat, confirmed, coarse_cells: found.coarse }
}

/// Greatest less smallest value at the cells' corners.
pub(super) fn range(chart: &Chart, field: &dyn ScalarField) -> f64 {
    let (mut lo, mut hi) = (f64::INFINITY, f64::NEG_INFINITY);
    for u in chart.borders(Axis::U) {
        for v in chart.borders(Axis::V) {
            if let Some(s) = field.sample(chart.surface(), uv(*u, *v)) {
                (lo, hi) = (lo.min(s.value), hi.max(s.value));
            }
        }
    }
    if hi > lo { hi - lo } else { 0.0 }
}

fn describe(chart: &Chart, field: &dyn ScalarField, gradient: Plane, zero: &Zero) -> Option<Critical> {
    let surface = chart.surface();
    let value = field.sample(surface, zero.at)?.value;
    let kind = match zero.rotation {
        Some(1) => extreme(chart, gradient, zero)?,
        Some(r) if r < 0 => CriticalKind::Saddle,
        _ => CriticalKind::Degenerate,
    };
    Some(Critical {
        at: zero.at,
        point: surface.point(zero.at),
        value,
        kind,
        index: zero.rotation,
        inside: surface.contains(zero.at),
    })
}

/// Minimum or maximum: whether the gradient on a small circle points away from the zero or towards it.
fn extreme(chart: &Chart, gradient: Plane, zero: &Zero) -> Option<CriticalKind> {
    let (half, d) = (chart.half_cell(zero.at), chart.domain());
    let mut outward = 0.0;
    for k in 0..16 {
        let (s, c) = (std::f64::consts::TAU * f64::from(k) / 16.0).sin_cos();
        let (du, dv) = (0.01 * half[0] * c, 0.01 * half[1] * s);
        let g = gradient(uv(zero.at.u + du, zero.at.v + dv))?;
        outward += g[0] * du / d.u.length() + g[1] * dv / d.v.length();
    }
    Some(if outward > 0.0 { CriticalKind::Minimum } else { CriticalKind::Maximum })
}

/// A pole where the field is critical, by the signs of the field's rise on the ring around it: none changes at an
/// extremum, two changes are a slope, more a saddle.
fn describe_pole(chart: &Chart, field: &dyn ScalarField, pole: &Pole) -> Option<Critical> {
    /// Places on a ring.
    const AROUND: usize = 64;
    let surface = chart.surface();
    let (i, along) = (chart.domain().get(pole.axis), chart.domain().get(pole.axis.other()));
    let end = surface.domain().get(pole.axis);
    let (edge, ring) = if pole.high { (end.hi, i.hi) } else { (end.lo, i.lo) };
    let values = |times: f64| -> Option<Vec<f64>> {
        (0..AROUND)
            .map(|k| {
                let fixed = edge + times * (ring - edge);
                let at = Uv::from_axis(pole.axis, fixed, along.at((k as f64 + 0.5) / AROUND as f64));
                field.sample(surface, at).map(|s| s.value)
            })
            .collect()
    };
    let (near, far) = (values(1.0)?, values(2.0)?);
    let mean = |v: &[f64]| v.iter().sum::<f64>() / AROUND as f64;
    // A field that needs a tangent plane has no value at the pole: extrapolated from both rings, whose means differ
    // by the square of their widths.
    let value = if field.holds_at_poles() {
        field.sample(surface, pole.at)?.value
    } else {
        (4.0 * mean(&near) - mean(&far)) / 3.0
    };
    let rises: Vec<f64> = far.iter().map(|v| v - value).collect();
    let size = rises.iter().fold(0.0_f64, |m, r| m.max(r.abs()));
    let range = range(chart, field);
    if range <= field.rounding(chart.scale()) || size <= FLAT * FLAT.sqrt() * range {
        return None;
    }
    let changes = (0..AROUND).filter(|k| rises[*k] * rises[(k + 1) % AROUND] < 0.0).count();
    let kind = match changes {
        0 if rises[0] > 0.0 => CriticalKind::Minimum,
        0 => CriticalKind::Maximum,
        1..=2 => return None,
        _ => CriticalKind::Saddle,
    };
    let index = Some(1 - i32::try_from(changes / 2).unwrap_or(i32::MAX));
    Some(Critical { at: pole.at, point: pole.point, value, kind, index, inside: surface.contains(pole.at) })
}
