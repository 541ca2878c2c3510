//! A cell of the index for closest points: a sub-rectangle of a piece with its tangent parallelogram and bounds.

use super::bounds::Bounds;
use osculate_geom::{Axis, Box3, Point3, Uv, Vec3, uv};

/// A sub-rectangle of a piece.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    /// The spans of its piece.
    pub(super) span: [u32; 2],
    /// Parameters of its middle and half its widths.
    pub(super) middle: Uv,
    pub(super) half: Uv,
    /// The point in the middle.
    pub(super) centre: Point3,
    /// Derivatives there by s and t.
    pub(super) sides: [Vec3; 2],
    /// Second derivatives there by ss, st and tt.
    pub(super) bends: [Vec3; 3],
    pub(super) bounds: Bounds,
}

impl Cell {
    /// Largest distance of a point of the cell from the parallelogram's point with the same s and t.
    pub(super) fn flatness_mm(&self) -> f64 {
        let [ss, st, tt] = self.bounds.second;
        0.5 * (ss + tt) + st
    }

    /// Radius of a ball around the middle that holds the cell.
    pub(super) fn radius_mm(&self) -> f64 {
        self.sides[0].norm() + self.sides[1].norm() + self.flatness_mm()
    }

    /// The axis whose halving flattens the cell more.
    pub(super) fn bent_axis(&self) -> Axis {
        if self.bounds.second[0] >= self.bounds.second[2] { Axis::U } else { Axis::V }
    }

    /// Parameters at a place of the cell.
    pub(super) fn at(&self, place: [f64; 2]) -> Uv {
        uv(self.middle.u + self.half.u * place[0], self.middle.v + self.half.v * place[1])
    }

    /// The spans of its piece.
    pub(super) fn spans(&self) -> [usize; 2] {
        self.span.map(|s| s as usize)
    }

    /// Distance of the nearest point of the parallelogram, mm.
    fn reach_mm(&self, query: &Point3) -> f64 {
        let [a, b] = &self.sides;
        let r = self.centre - query;
        let (e, f, g) = (a.norm_squared(), a.dot(b), b.norm_squared());
        let (ra, rb) = (r.dot(a), r.dot(b));
        let value = |s: f64, t: f64| (r + a * s + b * t).norm_squared();
        // The part of b across a, for a determinant without cancellation.
        if e > 0.0 {
            let across = b - a * (f / e);
            let det = across.norm_squared();
            if det > 1e-24 * g {
                let t = -r.dot(&across) / det;
                let s = -(ra + f * t) / e;
                if s.abs() <= 1.0 && t.abs() <= 1.0 {
                    return value(s, t).sqrt();
                }
            }
        }
        // On one of the four sides; those of a parallelogram without area are all of it.
        let ratio = |num: f64, den: f64| if den > 0.0 { (num / den).clamp(-1.0, 1.0) } else { 0.0 };
        let on = |end: f64| value(end, ratio(-(rb + f * end), g)).min(value(ratio(-(ra + f * end), e), end));
        on(-1.0).min(on(1.0)).sqrt()
    }

    /// No point of the cell is nearer, mm.
    pub(super) fn least_mm(&self, query: &Point3) -> f64 {
        self.reach_mm(query) - self.flatness_mm()
    }

    pub(super) fn box_around(&self) -> Box3 {
        let reach = self.sides[0].abs() + self.sides[1].abs() + Vec3::repeat(self.flatness_mm());
        Box3 { min: self.centre - reach, max: self.centre + reach }
    }
}
