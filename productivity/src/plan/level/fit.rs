//! The field whose gradient comes nearest to wanted vectors: a linear least-squares problem over the face.
//!
//! Minimises `integral |grad phi - X|^2 dA` over bicubic splines, in the metric of the face at Gauss points, plus small second
//! differences of the poles, which settle what lies outside the trims. X has the length 1/w, w the width of the strip,
//! and points across the wanted feed; what no field can do (a curl of X) is spread over the face. Where only the length of the
//! gradient matters X follows the field's own direction and the problem is solved again: the matrix stays the same.

use crate::plan::Task;
use crate::rectangle::Rectangle;
use crate::spline::{Four, Spline};
use crate::system::{Factor, NotDefinite, Symmetric};
use osculate_geom::{Axis, Forms, Jet2, Uv};
use rayon::prelude::*;

/// Gauss points along each side of a span, on [0, 1], and their weights.
const GAUSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 4.0 / 9.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];
/// Weight of the second differences of the poles where the field may follow its own direction, and where it has wishes to
/// follow: those turn on the scale of a span near umbilics, and passes with them.
const SMOOTH: [f64; 2] = [0.1, 1.0];
/// Weight of places outside the trims: a margin that guides the lines over the boundary.
const OUTSIDE: f64 = 0.02;
/// Holds the constant that no gradient sees.
const HOLD: f64 = 1e-9;

/// A Gauss point of the face.
pub(super) struct Place {
    pub jet: Jet2,
    pub forms: Forms,
    /// Area that it stands for, mm2; less outside the trims.
    pub area_mm2: f64,
    pub inside: bool,
    /// Measured width of strips here along the passes of the field before, mm; None while only the closed form is known.
    pub measured_mm: Option<f64>,
    u: Four,
    v: Four,
    /// Rates of u and v along the tangent frame's two directions.
    along: [Uv; 2],
}

impl Place {
    /// The gradient of a field in the tangent frame, 1/mm.
    pub fn gradient(&self, field: &Spline) -> [f64; 2] {
        let [a, b] = field.first(&self.u, &self.v).1;
        self.along.map(|r| a * r.u + b * r.v)
    }

    /// The gradient of a parameter.
    pub fn parameter_gradient(&self, axis: Axis) -> [f64; 2] {
        self.along.map(|r| r.get(axis))
    }
}

/// The least-squares problem over a face.
pub(super) struct Problem {
    pub places: Vec<Place>,
    zero: Spline,
    factor: Factor,
}

impl Problem {
    /// The places and the factored matrix.
    pub fn new(
        task: &Task<'_>,
        rectangle: &Rectangle,
        spans: [usize; 2],
        wishes: bool,
    ) -> Result<Self, NotDefinite> {
        let zero = Spline::constant(rectangle, spans, 0.0);
        let places = places(task, rectangle, &zero);
        let mut matrix = Symmetric::zeros(zero.poles.len());
        for p in &places {
            let rows = p.rows(&zero);
            for (k, (i, a)) in rows.iter().enumerate() {
                for (j, b) in &rows[..=k] {
                    // Both residuals of the place.
                    matrix.add(*i, *j, p.area_mm2 * (a[0] * b[0] + a[1] * b[1]));
                }
            }
        }
        zero.smooth(&mut matrix, SMOOTH[usize::from(wishes)]);
        Ok(Self { places, zero, factor: matrix.factor()? })
    }

    /// The field that is zero everywhere.
    pub fn zero(&self) -> Spline {
        self.zero.clone()
    }

    /// The field for wanted gradients in the tangent frames of the places.
    pub fn solve(&self, wanted: &[[f64; 2]]) -> Spline {
        let mut right = vec![0.0; self.zero.poles.len()];
        for (p, x) in self.places.iter().zip(wanted) {
            for (i, a) in p.rows(&self.zero) {
                right[i] += p.area_mm2 * (a[0] * x[0] + a[1] * x[1]);
            }
        }
        let x = self.factor.solve(&right);
        Spline { bases: self.zero.bases, poles: x }
    }
}

impl Place {
    /// What each pole adds to the gradient in the tangent frame, by its index.
    fn rows(&self, spline: &Spline) -> [(usize, [f64; 2]); 16] {
        std::array::from_fn(|k| {
            let (a, b) = (k / 4, k % 4);
            let (du, dv) = (self.u.first[a] * self.v.value[b], self.u.value[a] * self.v.first[b]);
            let pole = spline.index(self.u.index[a], self.v.index[b]);
            (pole, self.along.map(|r| du * r.u + dv * r.v))
        })
    }
}

impl Spline {
    /// Adds the squares of the poles' second differences, and a trace of the poles themselves.
    fn smooth(&self, matrix: &mut Symmetric, weight: f64) {
        let [nu, nv] = self.bases.map(|b| b.count());
        let mut add = |poles: [usize; 3]| {
            for (i, a) in poles.iter().zip([1.0, -2.0, 1.0]) {
                for (j, b) in poles.iter().zip([1.0, -2.0, 1.0]) {
                    if i >= j {
                        matrix.add(*i, *j, weight * a * b);
                    }
                }
            }
        };
        for i in 0..nu {
            for j in 0..nv {
                if i + 2 < nu {
                    add([0, 1, 2].map(|d| self.index(i + d, j)));
                }
                if j + 2 < nv {
                    add([0, 1, 2].map(|d| self.index(i, j + d)));
                }
            }
        }
        for k in 0..self.poles.len() {
            matrix.add(k, k, HOLD);
        }
    }
}

fn places(task: &Task<'_>, rectangle: &Rectangle, spline: &Spline) -> Vec<Place> {
    let spans = spline.bases.map(|b| b.spans);
    let surface = task.surface;
    (0..spans[0] * GAUSS.len())
        .into_par_iter()
        .flat_map_iter(|row| {
            let (gu, wu) = GAUSS[row % GAUSS.len()];
            let fu = ((row / GAUSS.len()) as f64 + gu) / spans[0] as f64;
            let u = rectangle.domain.u.at(fu);
            let inside = surface.spans(Axis::V, u);
            let mut out = Vec::with_capacity(spans[1] * GAUSS.len());
            for column in 0..spans[1] * GAUSS.len() {
                let (gv, wv) = GAUSS[column % GAUSS.len()];
                let v = rectangle.domain.v.at(((column / GAUSS.len()) as f64 + gv) / spans[1] as f64);
                let at = Uv { u, v };
                let jet = surface.jet2(at);
                let Ok(forms) = jet.forms() else { continue };
                let inside = inside.iter().any(|s| s.lo <= v && v <= s.hi);
                let cell =
                    rectangle.domain.u.length() * rectangle.domain.v.length() / (spans[0] * spans[1]) as f64;
                let area = forms.area_density() * cell * wu * wv;
                let along = [0, 1].map(|k| forms.rate(&jet, &forms.frame[k]));
                out.push(Place {
                    jet,
                    forms,
                    area_mm2: if inside { area } else { OUTSIDE * area },
                    inside,
                    measured_mm: None,
                    u: spline.bases[0].at(u),
                    v: spline.bases[1].at(v),
                    along,
                });
            }
            out
        })
        .collect()
}
