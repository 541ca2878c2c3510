//! Where a motion is judged while it is improved: a grid, places added to it, and the extremes of every rule.
//!
//! The extremes of the deviation along a rule lie between the grid's places and move with the motion. They are found by
//! the parabola through three places and used as places of their own, so that what is minimised is the maximum along the
//! rules and not over a few points of them.

use super::{Goal, Options, Task};
use crate::flank::axes::AxisSurface;
use crate::flank::envelope::{Envelope, Nearest, Scratch};
use osculate_geom::{Point3, Uv, uv};
use rayon::prelude::*;

/// Extremes below this part of the greatest deviation are not looked for.
const NOTABLE: f64 = 0.5;
/// Parabolas through an extreme.
const CLOSER: usize = 2;

/// Places of a task that stay.
pub(super) struct Places {
    pub at: Vec<Uv>,
    points: Vec<Point3>,
    /// Places of a rule, the first ones of `at` by rules.
    across: usize,
    rules: usize,
}

/// A motion judged.
pub(super) struct Judged {
    pub nearest: Vec<Nearest>,
    /// The goal's value.
    pub value: f64,
}

impl Judged {
    pub fn values(&self) -> impl Iterator<Item = f64> + '_ {
        self.nearest.iter().map(|n| n.distance_mm)
    }
}

/// The goal's value of deviations: greatest, gouges weighted, or root mean square.
pub(super) fn goal(values: impl Iterator<Item = f64>, o: &Options) -> f64 {
    let (mut worst, mut gouge, mut sum, mut count) = (0.0f64, 0.0f64, 0.0, 0.0f64);
    for v in values {
        worst = worst.max(if v < 0.0 { -v * o.gouge_weight } else { v });
        gouge = gouge.max(-v);
        sum += v * v;
        count += 1.0;
    }
    match o.goal {
        Goal::Minimax => worst,
        Goal::Rms if o.gouge_weight > 1.0 => (sum / count.max(1.0)).sqrt() + o.gouge_weight * gouge,
        Goal::Rms => (sum / count.max(1.0)).sqrt(),
    }
}

impl Places {
    pub fn new(task: &Task<'_>) -> Self {
        let at = task.judged.parameters();
        let points = at.par_iter().map(|uv| task.surface.point(*uv)).collect();
        let [rules, across] = task.judged.count.map(|n| n.max(2));
        Self { at, points, across, rules }
    }

    pub fn add(&mut self, task: &Task<'_>, at: &[Uv]) {
        self.points.extend(at.iter().map(|uv| task.surface.point(*uv)));
        self.at.extend(at);
    }

    /// The motion judged at all places; None where a deviation is not finite.
    pub fn judge(&self, task: &Task<'_>, axes: &AxisSurface, o: &Options) -> Result<Judged, Uv> {
        let pieces = std::slice::from_ref(axes);
        let envelope = Envelope::new(task.side, pieces);
        let all = |points: &[Point3]| -> Vec<Option<Nearest>> {
            points.par_iter().map_init(Scratch::default, |s, p| envelope.nearest(p, s)).collect()
        };
        let mut at = self.at.clone();
        let mut nearest = Vec::with_capacity(at.len());
        for (n, at) in all(&self.points).into_iter().zip(&at) {
            nearest.push(n.filter(|n| n.distance_mm.is_finite()).ok_or(*at)?);
        }
        if o.goal == Goal::Minimax {
            let mut triples = self.brackets(&nearest, o);
            let mut points = Vec::new();
            for _ in 0..CLOSER {
                let extra: Vec<Uv> = triples.iter().map(Triple::vertex).collect();
                points = extra.iter().map(|uv| task.surface.point(*uv)).collect();
                let found = all(&points);
                at.truncate(self.at.len());
                nearest.truncate(self.at.len());
                for ((n, place), t) in found.into_iter().zip(extra).zip(&mut triples) {
                    let n = n.filter(|n| n.distance_mm.is_finite()).ok_or(place)?;
                    t.narrow(place.v, n.distance_mm);
                    nearest.push(n);
                    at.push(place);
                }
            }
            // A gouge may be cut by several passages: all of them must come out, not only the deepest.
            let value = goal(nearest.iter().map(|n| n.distance_mm), o);
            let limit = -NOTABLE * value / o.gouge_weight;
            let deep: Vec<Point3> = self
                .points
                .iter()
                .chain(&points)
                .copied()
                .zip(&nearest)
                .filter(|(_, n)| n.distance_mm < limit)
                .map(|(p, _)| p)
                .collect();
            let all: Vec<Vec<Nearest>> =
                deep.par_iter().map_init(Scratch::default, |s, p| envelope.contacts(p, limit, s)).collect();
            for contacts in all {
                if contacts.len() > 1 {
                    nearest.extend(contacts);
                }
            }
        }
        let value = goal(nearest.iter().map(|n| n.distance_mm), o);
        Ok(Judged { nearest, value })
    }

    /// The extremes of each rule that count, bracketed.
    fn brackets(&self, nearest: &[Nearest], o: &Options) -> Vec<Triple> {
        let count = |n: &Nearest| goal(std::iter::once(n.distance_mm), o);
        let notable = NOTABLE * nearest.iter().map(count).fold(0.0, f64::max);
        let mut out = Vec::new();
        for i in 0..self.rules {
            for j in 1..self.across - 1 {
                let k = i * self.across + j;
                let places = [k - 1, k, k + 1].map(|k| (self.at[k].v, nearest[k].distance_mm));
                let [a, b, c] = places.map(|p| p.1);
                if (a - b) * (c - b) > 0.0 && count(&nearest[k]) >= notable {
                    out.push(Triple { u: self.at[k].u, places });
                }
            }
        }
        out
    }
}

/// Three places of a rule around an extreme, (v, deviation).
struct Triple {
    u: f64,
    places: [(f64, f64); 3],
}

impl Triple {
    /// The vertex of the parabola through the places.
    fn vertex(&self) -> Uv {
        let [a, b, c] = self.places;
        let (p, q) = (a.0 - b.0, c.0 - b.0);
        // f = left at p, right at q, 0 at 0.
        let (left, right) = (a.1 - b.1, c.1 - b.1);
        let (curve, slope) = ((left / p - right / q) / (p - q), (left * q / p - right * p / q) / (q - p));
        let v = b.0 - 0.5 * slope / curve;
        uv(self.u, if v > a.0 && v < c.0 { v } else { b.0 })
    }

    /// Takes the value at the vertex in.
    fn narrow(&mut self, v: f64, value: f64) {
        let [a, b, c] = self.places;
        if v == b.0 {
            return;
        }
        let sign = if b.1 < a.1 { 1.0 } else { -1.0 };
        let (low, high) = if v < b.0 { ((v, value), b) } else { (b, (v, value)) };
        // The lower one of both inner places stays in the middle.
        self.places = if sign * low.1 <= sign * high.1 { [a, low, high] } else { [low, high, c] };
    }
}
