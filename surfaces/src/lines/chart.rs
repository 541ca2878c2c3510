//! A face prepared for the search of lines: its cells, its poles, its scale.
//!
//! The parameter rectangle is cut at the surface's breaks and then into cells whose sides are about
//! [`LineTolerance::cell_mm`] long on the surface. What is promised about completeness is promised at this size. A
//! side of the rectangle that shrinks to a point is a *pole*; the search stays a thousandth of the range away from
//! it, where the parametrisation still has digits, and treats the ring around it as the point.

use super::field::Scale;
use osculate_geom::{Axis, Domain, Point3, Surface, Uv, uv};
use std::sync::OnceLock;

/// How exact lines are and how finely features are looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineTolerance {
    /// Largest estimated error of one step along a line, and largest distance of a contour's points from the contour.
    pub position_mm: f64,
    /// Largest distance between the line and the straight pieces drawn for it.
    pub chord_mm: f64,
    /// Side of the cells in which features are looked for: a feature smaller than this may be missed.
    pub cell_mm: f64,
}

impl LineTolerance {
    /// The tolerance for a face whose box has the given diagonal: steps to 1e-10 of it, chords to 1e-4, cells of a
    /// fiftieth.
    #[must_use]
    pub fn for_size(diagonal_mm: f64) -> Self {
        Self { position_mm: 1e-10 * diagonal_mm, chord_mm: 1e-4 * diagonal_mm, cell_mm: 0.02 * diagonal_mm }
    }
}

/// Why a face has no chart.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ChartError {
    /// A tolerance that is zero, negative or not finite.
    #[error("{what} is {got_mm} mm; it must be positive and finite")]
    Tolerance {
        /// Which.
        what: &'static str,
        /// Its value, mm.
        got_mm: f64,
    },
    /// The surface is unlimited, or has no extent, along a parameter.
    #[error("the surface runs from {lo} to {hi} along {axis:?}; lines need a finite range")]
    Range {
        /// The parameter.
        axis: Axis,
        /// Lower end.
        lo: f64,
        /// Upper end.
        hi: f64,
    },
    /// Points of the surface that are not finite, or all the same.
    #[error("the surface has no finite extent: its sampled box measures {size_mm} mm")]
    Size {
        /// Diagonal of the box around sampled points, mm.
        size_mm: f64,
    },
}

/// A side of the parameter rectangle that is one point of space.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Pole {
    /// The parameter that is constant along the side.
    pub axis: Axis,
    /// Whether the side is the upper one.
    pub high: bool,
    /// The point.
    pub point: Point3,
    /// Parameters of the side's middle.
    pub at: Uv,
}

/// A face with its cells.
pub struct Chart<'a> {
    surface: &'a dyn Surface,
    /// The surface's rectangle.
    whole: Domain,
    /// The rectangle searched: the surface's, less the poles' rings.
    domain: Domain,
    /// Cell borders along u and along v, ascending, both ends included.
    lines: [Vec<f64>; 2],
    poles: Vec<Pole>,
    size_mm: f64,
    /// The largest curvature, once asked for.
    curvature_per_mm: OnceLock<f64>,
    tolerance: LineTolerance,
}

/// Most cells along one parameter: 400 x 400 cells are evaluated in a second.
const MOST_CELLS: usize = 400;
/// Fewest cells along one parameter: seams need four, a Newton step likes a smooth cell.
const FEWEST_CELLS: usize = 8;
/// A side shorter than this part of the face's size is a pole.
const POLE: f64 = 1e-9;
/// Width of the ring around a pole, in terms of the parameter's range: curvature keeps ten digits there.
const RING: f64 = 1e-3;

impl<'a> Chart<'a> {
    /// The chart of a face.
    ///
    /// # Errors
    /// [`ChartError`] for tolerances that are not positive and for surfaces without a finite extent.
    pub fn new(surface: &'a dyn Surface, tolerance: LineTolerance) -> Result<Self, ChartError> {
        for (what, got_mm) in [
            ("position_mm", tolerance.position_mm),
            ("chord_mm", tolerance.chord_mm),
            ("cell_mm", tolerance.cell_mm),
        ] {
            if !(got_mm > 0.0 && got_mm.is_finite()) {
                return Err(ChartError::Tolerance { what, got_mm });
            }
        }
        let mut domain = surface.domain();
        for axis in [Axis::U, Axis::V] {
            let i = domain.get(axis);
            if !(i.length() > 0.0 && i.length().is_finite()) {
                return Err(ChartError::Range { axis, lo: i.lo, hi: i.hi });
            }
        }
        let size_mm = sampled_size(surface, &domain);
        if !(size_mm > 0.0 && size_mm.is_finite()) {
            return Err(ChartError::Size { size_mm });
        }
        let mut poles = Vec::new();
        for axis in [Axis::U, Axis::V] {
            for high in [false, true] {
                let i = surface.domain().get(axis);
                if i.periodic || side_length(surface, axis, if high { i.hi } else { i.lo }) > POLE * size_mm {
                    continue;
                }
                let end = if high { i.hi } else { i.lo };
                let at = Uv::from_axis(axis, end, surface.domain().get(axis.other()).at(0.5));
                poles.push(Pole { axis, high, point: surface.point(at), at });
                let ring = RING * i.length();
                let kept = match axis {
                    Axis::U => &mut domain.u,
                    Axis::V => &mut domain.v,
                };
                if high {
                    kept.hi -= ring;
                } else {
                    kept.lo += ring;
                }
            }
        }
        let lines = [Axis::U, Axis::V].map(|axis| cell_borders(surface, &domain, axis, tolerance.cell_mm));
        let (whole, curvature_per_mm) = (surface.domain(), OnceLock::new());
        Ok(Self { surface, whole, domain, lines, poles, size_mm, curvature_per_mm, tolerance })
    }

    /// The face.
    #[must_use]
    pub const fn surface(&self) -> &'a dyn Surface {
        self.surface
    }

    /// The rectangle searched.
    #[must_use]
    pub const fn domain(&self) -> &Domain {
        &self.domain
    }

    /// Borders of the cells along one parameter, ascending.
    #[must_use]
    pub fn borders(&self, axis: Axis) -> &[f64] {
        &self.lines[axis as usize]
    }

    /// The poles.
    #[must_use]
    pub fn poles(&self) -> &[Pole] {
        &self.poles
    }

    /// The pole at the given side of the rectangle.
    #[must_use]
    pub fn pole(&self, axis: Axis, high: bool) -> Option<&Pole> {
        self.poles.iter().find(|p| p.axis == axis && p.high == high)
    }

    /// Diagonal of the box around sampled points, mm.
    #[must_use]
    pub const fn size_mm(&self) -> f64 {
        self.size_mm
    }

    /// The largest curvature at the cells' corners, at least that of a sphere of the face's size, 1/mm.
    #[must_use]
    pub fn curvature_per_mm(&self) -> f64 {
        *self.curvature_per_mm.get_or_init(|| {
            let mut size = 1.0 / self.size_mm;
            for u in self.borders(Axis::U) {
                for v in self.borders(Axis::V) {
                    if let Ok(forms) = self.surface.jet2(uv(*u, *v)).forms() {
                        let p = forms.principal();
                        size = size.max(p.k_max.abs()).max(p.k_min.abs());
                    }
                }
            }
            size
        })
    }

    /// How large the face and its curvatures are: what rounding of fields over it is measured by.
    pub(super) fn scale(&self) -> Scale {
        Scale { size_mm: self.size_mm, curvature_per_mm: self.curvature_per_mm() }
    }

    /// The tolerances.
    #[must_use]
    pub const fn tolerance(&self) -> &LineTolerance {
        &self.tolerance
    }

    /// The longest side of a cell, mm: the resolution at which searches are complete. It exceeds
    /// [`LineTolerance::cell_mm`] only where the face would need more cells than are allowed.
    #[must_use]
    pub fn resolution_mm(&self) -> f64 {
        let mut longest = 0.0_f64;
        for axis in [Axis::U, Axis::V] {
            for w in self.borders(axis).windows(2) {
                for k in 0..=4 {
                    let across = self.domain.get(axis.other()).at(f64::from(k) / 4.0);
                    let ends = [w[0], w[1]].map(|t| self.surface.point(Uv::from_axis(axis, t, across)));
                    longest = longest.max((ends[1] - ends[0]).norm());
                }
            }
        }
        longest
    }

    /// The parameters brought into the surface's rectangle, the poles' rings included.
    #[must_use]
    pub fn bring(&self, at: Uv) -> Uv {
        self.whole.bring(at)
    }

    /// The surface's rectangle, the poles' rings included.
    #[must_use]
    pub const fn whole(&self) -> &Domain {
        &self.whole
    }

    /// The way from `a` to `b`, the shorter one where a parameter closes.
    #[must_use]
    pub fn between(&self, a: Uv, b: Uv) -> Uv {
        let one = |axis: Axis| {
            let (i, d) = (self.domain.get(axis), b.get(axis) - a.get(axis));
            if i.periodic { d - i.length() * (d / i.length()).round() } else { d }
        };
        uv(one(Axis::U), one(Axis::V))
    }

    /// The parameters at the fraction `t` of the way from `a` to `b`, brought into the rectangle.
    #[must_use]
    pub fn towards(&self, a: Uv, b: Uv, t: f64) -> Uv {
        let d = self.between(a, b);
        self.bring(uv(a.u + t * d.u, a.v + t * d.v))
    }

    /// Half the sides of the cell that holds `at`.
    #[must_use]
    pub(crate) fn half_cell(&self, at: Uv) -> [f64; 2] {
        [Axis::U, Axis::V].map(|axis| {
            let (lines, k) = (self.borders(axis), self.column(axis, at.get(axis)));
            0.5 * (lines[k + 1] - lines[k])
        })
    }

    /// Which column of cells along a parameter holds it; beyond the ends the first and the last one.
    #[must_use]
    pub(crate) fn column(&self, axis: Axis, t: f64) -> usize {
        let lines = self.borders(axis);
        lines.partition_point(|x| *x <= t).clamp(1, lines.len() - 1) - 1
    }
}

/// Diagonal of the box around points of a coarse grid.
fn sampled_size(surface: &dyn Surface, domain: &Domain) -> f64 {
    let mut found = osculate_geom::Box3::empty();
    for i in 0..=8 {
        for j in 0..=8 {
            let p = surface.point(domain.at(f64::from(i) / 8.0, f64::from(j) / 8.0));
            if !p.iter().all(|c| c.is_finite()) {
                return f64::NAN;
            }
            found.add(&p);
        }
    }
    found.diagonal_mm()
}

/// Length of the line on which `axis` has the value `fixed`, mm, by chords.
fn side_length(surface: &dyn Surface, axis: Axis, fixed: f64) -> f64 {
    let along = surface.domain().get(axis.other());
    let points: Vec<Point3> =
        (0..=16).map(|k| surface.point(Uv::from_axis(axis, fixed, along.at(f64::from(k) / 16.0)))).collect();
    points.windows(2).map(|w| (w[1] - w[0]).norm()).sum()
}

/// Borders of cells about `cell_mm` long along one parameter.
fn cell_borders(surface: &dyn Surface, domain: &Domain, axis: Axis, cell_mm: f64) -> Vec<f64> {
    let (along, across) = (domain.get(axis), domain.get(axis.other()));
    let mut breaks = vec![along.lo];
    breaks.extend(surface.breaks(axis).into_iter().filter(|t| *t > along.lo && *t < along.hi));
    breaks.push(along.hi);
    // Neighbouring knots closer than a sliver are one border.
    let sliver = 1e-9 * along.length();
    breaks.dedup_by(|b, a| *b - *a < sliver);
    if breaks.len() < 2 || breaks.len() > MOST_CELLS {
        breaks = vec![along.lo, along.hi];
    }
    *breaks.last_mut().expect("a rectangle has two sides") = along.hi;
    let spans = breaks.len() - 1;
    let lengths: Vec<f64> = breaks
        .windows(2)
        .map(|w| {
            (0..=4)
                .map(|k| {
                    let fixed = across.at(f64::from(k) / 4.0);
                    let at = |j: i32| {
                        let t = w[0] + (w[1] - w[0]) * f64::from(j) / 4.0;
                        surface.point(Uv::from_axis(axis, t, fixed))
                    };
                    (0..4).map(|j| (at(j + 1) - at(j)).norm()).sum::<f64>()
                })
                .fold(0.0, f64::max)
        })
        .collect();
    let fewest = FEWEST_CELLS.div_ceil(spans);
    let wanted: Vec<usize> =
        lengths.iter().map(|l| ((l / cell_mm).ceil().min(MOST_CELLS as f64) as usize).max(fewest)).collect();
    let total: usize = wanted.iter().sum();
    let mut borders = vec![breaks[0]];
    for (w, n) in breaks.windows(2).zip(&wanted) {
        let n = if total > MOST_CELLS { (n * MOST_CELLS / total).max(1) } else { *n };
        borders
            .extend((1..=n).map(|k| if k == n { w[1] } else { w[0] + (w[1] - w[0]) * k as f64 / n as f64 }));
    }
    borders
}
