//! Umbilics: where both principal curvatures agree and lines of curvature end.
//!
//! In the tangent frame of [`Forms`](osculate_geom::Forms) an umbilic is a zero of the field
//! `g = ((w_11 - w_22) / 2, w_12)`, whose angle is twice that of the direction of k_1. The index of an umbilic, the
//! turn of the lines of curvature around it, is half the rotation of g. With the surface over its tangent plane as
//! `k (x^2 + y^2) / 2 + (a x^3 + 3 b x^2 y + 3 c x y^2 + d y^3) / 6 + ...` the index has the sign of
//! `(a - c) c - (b - d) b`, and the number of directions in which a line of curvature runs into the umbilic is that
//! of the real roots t = tan(angle) of
//!
//! ```text
//! c t^3 - (d - 2 b) t^2 - (2 c - a) t - b = 0
//! ```
//!
//! three for the star (index -1/2), and for index +1/2 three for the monstar and one for the lemon [Berry & Hannay,
//! Umbilic points on Gaussian random surfaces, 1977].

use super::chart::{Chart, Pole};
use super::third::forms_rate;
use super::zeros::{Plane, boundary_rotation, ring_rotation, zeros};
use osculate_geom::{Axis, Point3, Surface, Unit3, Uv};

/// The type of an umbilic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UmbilicKind {
    /// Index +1/2, one line of curvature of each family ends in it.
    Lemon,
    /// Index +1/2, three lines of each family end in it.
    Monstar,
    /// Index -1/2, three lines of each family end in it.
    Star,
    /// Third derivatives do not decide: the index says what the lines do.
    Degenerate,
}

/// An umbilic.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Umbilic {
    /// Where; at a pole of the parametrisation the middle of its side.
    pub at: Uv,
    /// The point, mm.
    pub point: Point3,
    /// The outward normal.
    pub normal: Unit3,
    /// The curvature in all directions, 1/mm, convex positive.
    pub curvature_per_mm: f64,
    /// Its type.
    pub kind: UmbilicKind,
    /// Twice the index; `None` where the turn of the lines could not be counted (an umbilic on the border).
    pub index_twice: Option<i32>,
    /// `[a, b, c, d]` of the surface's third-order part, 1/mm2, in the tangent frame of the forms.
    pub cubic_per_mm2: [f64; 4],
    /// Whether it lies on the face, inside its trims.
    pub inside: bool,
}

/// A line all of whose points are umbilics, as on some surfaces of revolution.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct UmbilicLine {
    /// Places along it, not in order.
    pub places: Vec<Uv>,
}

/// All umbilics of a face.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Umbilics {
    /// Isolated umbilics of the whole parameter rectangle, those outside the trims too.
    pub points: Vec<Umbilic>,
    /// Lines of umbilics.
    pub lines: Vec<UmbilicLine>,
    /// Middles of cells that consist of umbilics, as on spheres and planes.
    pub regions: Vec<Uv>,
    /// Twice the sum of the indices found, poles not counted.
    pub index_sum_twice: Option<i32>,
    /// Twice what that sum must be, from the turn of the lines of curvature along the border.
    pub border_sum_twice: Option<i32>,
    /// Cells in which the surface has no tangent plane.
    pub undefined_cells: usize,
    /// Cells that were searched less finely than others, since umbilics are all over the face: its curvature is noise.
    pub coarse_cells: usize,
    /// Side of the largest cell searched, mm: pairs of umbilics nearer than the cells' samples tell may cancel.
    pub resolution_mm: f64,
}

impl Umbilics {
    /// The umbilics on the face.
    pub fn inside(&self) -> impl Iterator<Item = &Umbilic> {
        self.points.iter().filter(|u| u.inside)
    }

    /// Whether the sum of the indices agrees with the turn of the lines of curvature along the border, with nothing
    /// in between that has no index.
    #[must_use]
    pub fn confirmed(&self) -> bool {
        self.index_sum_twice.is_some()
            && self.index_sum_twice == self.border_sum_twice
            && self.lines.is_empty()
            && self.regions.is_empty()
            && self.undefined_cells == 0
    }
}

/// Curvature differences below this part of the face's largest curvature (at least that of a sphere of the face's
/// size) are zero: spline spheres reach 1e-12.
const FLAT: f64 = 1e-9;
/// A cubic form whose deciding number is below this part of its size does not decide.
const UNDECIDED: f64 = 1e-6;

/// All umbilics of a face, see [`Umbilics`].
#[must_use]
pub fn umbilics(chart: &Chart) -> Umbilics {
    let surface = chart.surface();
    let field = |at: Uv| directions(surface, at);
    let field: Plane = &field;
    let size = chart.curvature_per_mm();
    let found = zeros(chart, field, FLAT * size);
    let sign = orientation(chart);
    let mut points: Vec<Umbilic> = found
        .points
        .iter()
        .filter_map(|z| describe(surface, z.at, z.rotation.map(|r| r * sign), z.simple))
        .collect();
    let index_sum_twice =
        found.points.iter().map(|z| z.rotation).try_fold(0, |sum, r| r.map(|r| sum + r * sign));
    let border_sum_twice = boundary_rotation(chart, field).map(|r| r * sign);
    for pole in chart.poles() {
        let Some(turn) = ring_rotation(chart, field, pole.axis, pole.high) else { continue };
        // The pole lies to the left of the ring, seen along the rising parameter, or to the right.
        let left = (pole.axis == Axis::V) == pole.high;
        let around = sign * if left { turn } else { -turn };
        // Around the pole the frame itself turns once.
        let index_twice = around + 2;
        if index_twice != 0
            && let Some(u) = describe_pole(chart, pole, index_twice)
        {
            points.push(u);
        }
    }
    Umbilics {
        points,
        lines: found.lines.into_iter().map(|places| UmbilicLine { places }).collect(),
        regions: found.flat,
        index_sum_twice,
        border_sum_twice,
        undefined_cells: found.undefined,
        coarse_cells: found.coarse,
        resolution_mm: chart.resolution_mm(),
    }
}

/// The field whose angle is twice that of the direction of k_1.
fn directions(surface: &dyn Surface, at: Uv) -> Option<[f64; 2]> {
    let w = surface.jet2(at).forms().ok()?.curvature;
    Some([0.5 * (w[(0, 0)] - w[(1, 1)]), w[(0, 1)]])
}

/// +1 where the tangent frame of the forms turns as (u, v) does, -1 where the outward normal is on the other side.
fn orientation(chart: &Chart) -> i32 {
    if chart.surface().jet2(chart.domain().at(0.5, 0.5)).side.sign() > 0.0 { 1 } else { -1 }
}

fn describe(surface: &dyn Surface, at: Uv, index_twice: Option<i32>, simple: bool) -> Option<Umbilic> {
    let rate = forms_rate(surface, at).ok()?;
    let jet = surface.jet2(at);
    let k = rate.forms.mean();
    let frame = rate.forms.frame.map(|e| rate.forms.rate(&jet, &e));
    let cubic = rate.cubic(frame, k);
    let known = index_twice.is_none_or(|i| i.abs() == 1);
    let kind = if simple && known { kind_of(cubic) } else { UmbilicKind::Degenerate };
    Some(Umbilic {
        at,
        point: jet.point,
        normal: rate.forms.normal,
        curvature_per_mm: k,
        kind,
        index_twice,
        cubic_per_mm2: cubic,
        inside: surface.contains(at),
    })
}

/// The type by the cubic form.
fn kind_of([a, b, c, d]: [f64; 4]) -> UmbilicKind {
    let size = a * a + b * b + c * c + d * d;
    let turn = (a - c) * c - (b - d) * b;
    if turn.abs() <= UNDECIDED * size || turn.is_nan() {
        return UmbilicKind::Degenerate;
    }
    if turn < 0.0 {
        return UmbilicKind::Star;
    }
    let (p, q, r, s) = (c, 2.0 * b - d, a - 2.0 * c, -b);
    let discriminant = 18.0 * p * q * r * s - 4.0 * q * q * q * s + q * q * r * r
        - 4.0 * p * r * r * r
        - 27.0 * p * p * s * s;
    if discriminant.abs() <= UNDECIDED * size * size {
        UmbilicKind::Degenerate
    } else if discriminant > 0.0 {
        UmbilicKind::Monstar
    } else {
        UmbilicKind::Lemon
    }
}

/// A pole that is an umbilic. Its normal and curvature are means over the ring around it, good to the square of the
/// ring's width.
fn describe_pole(chart: &Chart, pole: &Pole, index_twice: i32) -> Option<Umbilic> {
    /// Places on the ring.
    const AROUND: usize = 16;
    let i = chart.domain().get(pole.axis);
    let fixed = if pole.high { i.hi } else { i.lo };
    let along = chart.domain().get(pole.axis.other());
    let (mut normal, mut curvature) = (osculate_geom::Vec3::zeros(), 0.0);
    for k in 0..AROUND {
        let at = Uv::from_axis(pole.axis, fixed, along.at(k as f64 / AROUND as f64));
        let forms = chart.surface().jet2(at).forms().ok()?;
        normal += forms.normal.into_inner();
        curvature += forms.mean() / AROUND as f64;
    }
    Some(Umbilic {
        at: pole.at,
        point: pole.point,
        normal: Unit3::try_new(normal, 0.0)?,
        curvature_per_mm: curvature,
        kind: if index_twice == -1 { UmbilicKind::Star } else { UmbilicKind::Degenerate },
        index_twice: Some(index_twice),
        cubic_per_mm2: [0.0; 4],
        inside: chart.surface().contains(pole.at),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_of_cubic_forms() {
        // Re z^3 = x^3 - 3 x y^2: the monkey saddle's star.
        assert_eq!(kind_of([6.0, 0.0, -6.0, 0.0]), UmbilicKind::Star);
        // With b = d = 0 the roots are 0 and +-sqrt((2 c - a) / c): lemon for a > 2 c > 0, monstar for c < a < 2 c.
        assert_eq!(kind_of([3.0, 0.0, 1.0, 0.0]), UmbilicKind::Lemon);
        assert_eq!(kind_of([1.5, 0.0, 1.0, 0.0]), UmbilicKind::Monstar);
        assert_eq!(kind_of([1.0, 0.0, 0.0, 0.0]), UmbilicKind::Degenerate);
        assert_eq!(kind_of([0.0; 4]), UmbilicKind::Degenerate);
    }
}
