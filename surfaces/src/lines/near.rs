//! Places of a chart that are near others, found without looking at all of them.
//!
//! A place reaches `reach` half cells around itself, the cell that holds it being the measure, and is noted in every cell that
//! this square meets; what is asked for is looked up in the cell that holds it. Searches of faces full of zeros have hundreds of
//! thousands of places.

use super::chart::Chart;
use osculate_geom::{Axis, Uv};
use std::collections::HashMap;

/// The square is noted a little larger than it is, for the rounding of its corners.
const ROUNDING: f64 = 1.0 + 1e-9;

/// Distance of two places in half cells of the first one's cell, the larger of both parameters'.
fn apart(chart: &Chart, a: Uv, b: Uv) -> f64 {
    let (d, half) = (chart.between(a, b), chart.half_cell(a));
    (d.u / half[0]).abs().max((d.v / half[1]).abs())
}

/// Places with what each reaches.
pub(super) struct Near<'c> {
    chart: &'c Chart<'c>,
    cells: HashMap<[usize; 2], Vec<(Uv, f64)>>,
}

impl<'c> Near<'c> {
    /// No places yet.
    pub(super) fn new(chart: &'c Chart<'c>) -> Self {
        Self { chart, cells: HashMap::new() }
    }

    /// Places that all reach as far.
    pub(super) fn of(chart: &'c Chart<'c>, places: impl IntoIterator<Item = Uv>, reach: f64) -> Self {
        let mut out = Self::new(chart);
        places.into_iter().for_each(|at| out.add(at, reach));
        out
    }

    /// One place more, which reaches `reach` half cells of its own cell.
    pub(super) fn add(&mut self, at: Uv, reach: f64) {
        let half = self.chart.half_cell(at);
        let of = |axis: Axis| self.columns(axis, at.get(axis), reach * half[axis as usize] * ROUNDING);
        let (columns, rows) = (of(Axis::U), of(Axis::V));
        for i in &columns {
            for j in &rows {
                self.cells.entry([*i, *j]).or_default().push((at, reach));
            }
        }
    }

    /// Whether one of the places reaches this one.
    pub(super) fn reaches(&self, at: Uv) -> bool {
        self.around(at).next().is_some()
    }

    /// The places that reach this one, with their distances in half cells.
    pub(super) fn around(&self, at: Uv) -> impl Iterator<Item = (Uv, f64)> + '_ {
        let key = [Axis::U, Axis::V].map(|axis| self.chart.column(axis, at.get(axis)));
        self.cells.get(&key).into_iter().flatten().filter_map(move |(place, reach)| {
            let far = apart(self.chart, *place, at);
            (far <= *reach).then_some((*place, far))
        })
    }

    /// The columns of cells that an interval meets, around where the parameter closes.
    fn columns(&self, axis: Axis, middle: f64, wide: f64) -> Vec<usize> {
        let range = self.chart.domain().get(axis);
        let turns: &[f64] = if range.periodic { &[-1.0, 0.0, 1.0] } else { &[0.0] };
        let mut out: Vec<usize> = Vec::new();
        for turn in turns {
            let middle = middle + turn * range.length();
            if *turn == 0.0 || (middle + wide >= range.lo && middle - wide <= range.hi) {
                out.extend(self.chart.column(axis, middle - wide)..=self.chart.column(axis, middle + wide));
            }
        }
        out.sort_unstable();
        out.dedup();
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lines::LineTolerance;
    use osculate_geom::analytic::Torus;
    use osculate_geom::{Surface, uv};

    /// Places all over a torus, whose both parameters close: what is looked up is what looking at each of them finds.
    #[test]
    fn what_is_near_is_what_all_places_say() {
        let torus = Torus::new(5.0, 2.0).expect("radii are positive");
        let chart = Chart::new(&torus, LineTolerance::for_size(14.0)).expect("it has a size");
        let mut seed = 3_u64;
        let mut next = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64
        };
        let d = torus.domain();
        let mut place = || uv(d.u.at(next()), d.v.at(next()));
        let places: Vec<Uv> = (0..400).map(|_| place()).collect();
        for reach in [1e-6, 0.3, 2.2, 7.0] {
            let near = Near::of(&chart, places.iter().copied(), reach);
            let mut met = 0;
            for at in (0..200).map(|_| place()).chain(places[..20].iter().copied()) {
                let all = places.iter().filter(|p| apart(&chart, **p, at) <= reach).count();
                assert_eq!(near.around(at).count(), all, "{reach} {at:?}");
                assert_eq!(near.reaches(at), all > 0);
                met += all;
            }
            assert!(met >= 20, "{reach}: {met}");
        }
    }
}
