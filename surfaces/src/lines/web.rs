//! A conforming triangulation of a chart that is fine enough for a field's contours at given levels.
//!
//! Every cell gives two triangles with its diagonal as the edge to be cut first; triangles are cut by newest-vertex
//! bisection, and neighbours with them, so that no vertex ever lies inside an edge. A triangle is cut while an edge
//! of it may be crossed twice by a level (the cubic through values and slopes at its ends says so, or the parabola
//! through its middle where there are no slopes), while it holds an extreme value that a level separates from its
//! corners, and while the sense of a signless field is not settled in it.

use super::chart::Chart;
use super::field::{FieldSample, ScalarField};
use osculate_geom::{Axis, Uv, uv};
use rayon::prelude::*;
use std::collections::HashMap;

/// The triangulation with the field at its vertices.
pub(crate) struct Web {
    /// Parameters of the vertices.
    pub at: Vec<Uv>,
    /// The field there.
    pub samples: Vec<Option<FieldSample>>,
    /// Vertices of the triangles; the edge between the first two is cut next.
    pub triangles: Vec<[u32; 3]>,
    /// Triangles that would have been cut once more, had there not been so many.
    pub uncut: usize,
    /// Values of a signless field up to this are zero.
    zero: f64,
}

/// An extreme value of the field that the triangulation must not miss.
#[derive(Clone, Copy)]
pub(crate) struct Extreme {
    pub at: Uv,
    pub value: f64,
}

/// Rounds of refinement; each halves the area: sixteen make triangles a 256th of a cell wide.
const ROUNDS: usize = 16;
/// So many triangles more than the chart's cells give are the last round of refinement. Noise takes what it may have.
const MOST_MORE: usize = 80_000;

/// The two ends of an edge in the order in which it is always taken.
pub(crate) fn edge(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}

/// `+1` where two samples of a signless field agree in sense, `-1` where they do not; `+1` for other fields.
pub(crate) fn same_sense(a: &FieldSample, b: &FieldSample) -> f64 {
    match (a.sense, b.sense) {
        (Some(a), Some(b)) if a.dot(&b) < 0.0 => -1.0,
        _ => 1.0,
    }
}

impl Web {
    /// The triangulation for `levels`, which are ascending.
    pub fn new(chart: &Chart, field: &dyn ScalarField, levels: &[f64], extremes: &[Extreme]) -> Self {
        let mut web = Self::grid(chart, field);
        // Triangles that are new since the last round.
        let most = web.triangles.len() + MOST_MORE;
        let mut fresh: Vec<bool> = vec![true; web.triangles.len()];
        for _ in 0..ROUNDS {
            let marks: Vec<bool> = (0..web.triangles.len())
                .into_par_iter()
                .map(|t| fresh[t] && web.needs_cut(chart, field, levels, extremes, web.triangles[t]))
                .collect();
            let marked = marks.iter().filter(|m| **m).count();
            if marked == 0 {
                break;
            }
            if web.triangles.len() > most {
                web.uncut = marked;
                break;
            }
            fresh = web.cut(chart, field, &marks);
        }
        web
    }

    fn grid(chart: &Chart, field: &dyn ScalarField) -> Self {
        let [us, vs] = [Axis::U, Axis::V].map(|axis| rows(chart, field, axis));
        let closes = [chart.domain().u.periodic, chart.domain().v.periodic];
        let (nu, nv) = (us.len() - 1, vs.len() - 1);
        // Where a parameter closes, the last border is the first.
        let (mu, mv) = (nu + usize::from(!closes[0]), nv + usize::from(!closes[1]));
        let at: Vec<Uv> = (0..mu * mv).map(|k| uv(us[k / mv], vs[k % mv])).collect();
        let samples = at.par_iter().map(|p| field.sample(chart.surface(), *p)).collect();
        let vertex = |i: usize, j: usize| ((i % mu) * mv + j % mv) as u32;
        let mut triangles = Vec::with_capacity(2 * nu * nv);
        for i in 0..nu {
            for j in 0..nv {
                let [a, b] = [vertex(i, j), vertex(i + 1, j)];
                let [c, d] = [vertex(i + 1, j + 1), vertex(i, j + 1)];
                // Alternating diagonals favour no direction.
                if (i + j) % 2 == 0 {
                    triangles.extend([[a, c, b], [a, c, d]]);
                } else {
                    triangles.extend([[b, d, a], [b, d, c]]);
                }
            }
        }
        Self { at, samples, triangles, uncut: 0, zero: field.zero(chart.scale()) }
    }

    /// Whether a signless field is zero but for rounding at all corners of a triangle: there is no line in it.
    pub fn is_zero(&self, corners: &[FieldSample; 3]) -> bool {
        corners.iter().all(|s| s.sense.is_some() && s.value.abs() <= self.zero)
    }

    /// Whether the levels' lines may do in a triangle what its corners do not tell.
    fn needs_cut(
        &self,
        chart: &Chart,
        field: &dyn ScalarField,
        levels: &[f64],
        extremes: &[Extreme],
        triangle: [u32; 3],
    ) -> bool {
        let [a, b, c] = triangle.map(|v| self.samples[v as usize]);
        let (Some(a), Some(b), Some(c)) = (a, b, c) else { return false };
        if self.is_zero(&[a, b, c]) {
            return false;
        }
        if a.sense.is_some() && same_sense(&a, &b) * same_sense(&b, &c) * same_sense(&c, &a) < 0.0 {
            return true;
        }
        let corners = [(triangle[0], a), (triangle[1], b), (triangle[2], c)];
        for k in 0..3 {
            let ((i, p), (j, q)) = (corners[k], corners[(k + 1) % 3]);
            if self.hides(chart, field, levels, (i, &p), (j, &q)) {
                return true;
            }
        }
        let values = [a.value, b.value, c.value];
        let (lo, hi) =
            values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |r, v| (r.0.min(*v), r.1.max(*v)));
        extremes.iter().any(|e| {
            (between(levels, e.value, lo) || between(levels, hi, e.value))
                && self.holds(chart, triangle, e.at)
        })
    }

    /// Whether the field along an edge turns back across a level.
    fn hides(
        &self,
        chart: &Chart,
        field: &dyn ScalarField,
        levels: &[f64],
        (i, p): (u32, &FieldSample),
        (j, q): (u32, &FieldSample),
    ) -> bool {
        let (a, b) = (self.at[i as usize], self.at[j as usize]);
        let step = chart.between(a, b);
        let sign = same_sense(p, q);
        let (v0, v1) = (p.value, sign * q.value);
        let turns: Vec<f64> = match (p.gradient, q.gradient) {
            (Some(g), Some(h)) => {
                let d0 = g[0] * step.u + g[1] * step.v;
                let d1 = h[0] * step.u + h[1] * step.v;
                cubic_turns([v0, v1], [d0, d1])
            }
            _ => {
                let Some(m) = field.sample(chart.surface(), chart.towards(a, b, 0.5)) else { return false };
                let middle = same_sense(p, &m) * m.value;
                // The parabola through the three values: its slopes at the ends.
                let d0 = 4.0 * middle - 3.0 * v0 - v1;
                let d1 = v0 + 3.0 * v1 - 4.0 * middle;
                cubic_turns([v0, v1], [d0, d1])
            }
        };
        let (lo, hi) = (v0.min(v1), v0.max(v1));
        turns.iter().any(|e| between(levels, hi, *e) || between(levels, *e, lo))
    }

    /// Whether the triangle covers the place, with a little to spare.
    fn holds(&self, chart: &Chart, triangle: [u32; 3], place: Uv) -> bool {
        let [a, b, c] = triangle.map(|v| chart.between(place, self.at[v as usize]));
        let cross = |p: Uv, q: Uv| p.u * q.v - p.v * q.u;
        let area = cross(uv(b.u - a.u, b.v - a.v), uv(c.u - a.u, c.v - a.v));
        [(a, b), (b, c), (c, a)].iter().all(|(p, q)| cross(*p, *q) / area >= -1e-9)
    }

    /// Cuts the marked triangles and what must be cut with them; says which triangles are new.
    fn cut(&mut self, chart: &Chart, field: &dyn ScalarField, marks: &[bool]) -> Vec<bool> {
        let mut middles: HashMap<(u32, u32), u32> = HashMap::new();
        let mut wanted: Vec<(u32, u32)> = Vec::new();
        let mut next = self.at.len() as u32;
        let mut add = |e: (u32, u32), wanted: &mut Vec<(u32, u32)>, middles: &mut HashMap<_, _>| {
            if let std::collections::hash_map::Entry::Vacant(place) = middles.entry(e) {
                place.insert(next);
                wanted.push(e);
                next += 1;
                true
            } else {
                false
            }
        };
        for (t, _) in self.triangles.iter().zip(marks).filter(|(_, m)| **m) {
            add(edge(t[0], t[1]), &mut wanted, &mut middles);
        }
        // A triangle with a cut edge has its own first edge cut.
        loop {
            let mut changed = false;
            for t in &self.triangles {
                let cut =
                    [(t[1], t[2]), (t[2], t[0])].iter().any(|(a, b)| middles.contains_key(&edge(*a, *b)));
                if cut {
                    changed |= add(edge(t[0], t[1]), &mut wanted, &mut middles);
                }
            }
            if !changed {
                break;
            }
        }
        let places: Vec<Uv> = wanted
            .iter()
            .map(|(a, b)| chart.towards(self.at[*a as usize], self.at[*b as usize], 0.5))
            .collect();
        let samples: Vec<_> = places.par_iter().map(|p| field.sample(chart.surface(), *p)).collect();
        self.at.extend(places);
        self.samples.extend(samples);
        let (mut triangles, mut fresh) = (Vec::new(), Vec::new());
        for t in &self.triangles {
            let mut queue = vec![(*t, false)];
            while let Some((t, new)) = queue.pop() {
                match middles.get(&edge(t[0], t[1])) {
                    Some(m) => queue.extend([([t[2], t[0], *m], true), ([t[1], t[2], *m], true)]),
                    None => {
                        triangles.push(t);
                        fresh.push(new);
                    }
                }
            }
        }
        self.triangles = triangles;
        fresh
    }
}

/// Borders of the cells along one parameter, with one row more in the ring around a pole where the field has digits
/// there.
fn rows(chart: &Chart, field: &dyn ScalarField, axis: Axis) -> Vec<f64> {
    /// Where the row is, as a part of the parameter's range: a ring around nothing that matters.
    const INNERMOST: f64 = 1e-7;
    let mut rows = chart.borders(axis).to_vec();
    let whole = chart.whole().get(axis);
    if field.holds_at_poles() {
        if chart.pole(axis, false).is_some() {
            rows.insert(0, whole.at(INNERMOST));
        }
        if chart.pole(axis, true).is_some() {
            rows.push(whole.at(1.0 - INNERMOST));
        }
    }
    rows
}

/// Whether a level lies strictly between `lo` and `hi`; never where `lo >= hi`.
fn between(levels: &[f64], lo: f64, hi: f64) -> bool {
    lo < hi && levels.get(levels.partition_point(|l| *l <= lo)).is_some_and(|l| *l < hi)
}

/// Values at the turning points inside (0, 1) of the cubic with the given values and slopes at 0 and 1.
fn cubic_turns([v0, v1]: [f64; 2], [d0, d1]: [f64; 2]) -> Vec<f64> {
    // v = v0 + d0 t + b t^2 + c t^3.
    let b = 3.0 * (v1 - v0) - 2.0 * d0 - d1;
    let c = d0 + d1 - 2.0 * (v1 - v0);
    let value = |t: f64| v0 + t * (d0 + t * (b + t * c));
    let disc = b * b - 3.0 * c * d0;
    if disc < 0.0 {
        return Vec::new();
    }
    // The roots of d0 + 2 b t + 3 c t^2 without cancellation.
    let q = -(b + b.signum() * disc.sqrt());
    [q / (3.0 * c), d0 / q].into_iter().filter(|t| *t > 0.0 && *t < 1.0).map(value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turning_points_of_a_cubic() {
        // t (1 - t): top 1/4 at 1/2.
        let top = cubic_turns([0.0, 0.0], [1.0, -1.0]);
        assert!(top.iter().any(|v| (v - 0.25).abs() < 1e-15), "{top:?}");
        assert!(cubic_turns([0.0, 1.0], [1.0, 1.0]).is_empty());
        // T_3 shifted to [0, 1] has both turns inside, at +-1.
        let t3 = cubic_turns([-1.0, 1.0], [18.0, 18.0]);
        assert_eq!(t3.len(), 2);
        assert!(t3.iter().all(|v| (v.abs() - 1.0).abs() < 1e-12), "{t3:?}");
    }

    #[test]
    fn levels_between() {
        let l = [1.0, 2.0];
        assert!(between(&l, 0.5, 1.5) && !between(&l, 1.0, 2.0) && !between(&l, 1.5, 0.5));
    }
}
