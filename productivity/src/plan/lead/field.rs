//! A lead over the face as a bicubic spline whose poles are an envelope.
//!
//! A value of the spline is a mean of the poles around, and its slope a mean of their differences: poles that differ by no more
//! than a rate times their distance bound the rate of the field. Where the mean lies below what a place needs, the sixteen poles
//! around it are raised by what is missing and the envelope is made again; the places stand closer than the nodes, and between them the
//! need is allowed to grow as it does from node to node.

use super::envelope::{Network, raise};
use super::lean::{Feed, LeadField, LocalLead};
use super::need::{Clearance, Stand};
use crate::plan::{Passes, PlanError, Task};
use crate::rectangle::{Rectangle, lengths};
use crate::spline::Spline;
use osculate_geom::{Axis, Diagnostic, Uv};
use rayon::prelude::*;

/// Distance of nodes, in radii of the tool, and fewest and most along a parameter, and most of all.
const APART: f64 = 0.5;
const ALONG: [f64; 2] = [8.0, 120.0];
const NODES: f64 = 1600.0;
/// Places asked along each side of a cell.
const ASKED: usize = 2;
/// Rounds in which poles are raised.
const ROUNDS: u32 = 6;
/// A rate along the edges and diagonals of a grid is one in any direction to this quotient; cells are no squares.
const ANY_WAY: f64 = 1.15;

/// Poles of a spline over a face as nodes.
struct Poles<'a> {
    spline: &'a Spline,
    /// First fundamental form at the poles, by steps of the grid: `[E, F, G]`, mm2.
    form: Vec<[f64; 3]>,
    closes: [bool; 2],
}

impl Network for Poles<'_> {
    fn around(&self, node: usize, see: &mut dyn FnMut(usize, f64)) {
        let n = self.spline.bases.map(|b| b.count() as i64);
        let (i, j) = (node as i64 / n[1], node as i64 % n[1]);
        for a in -1..=1i64 {
            for b in -1..=1i64 {
                let held = |k: i64, axis: usize| {
                    let k = if self.closes[axis] { k.rem_euclid(n[axis]) } else { k };
                    (k >= 0 && k < n[axis]).then_some(k)
                };
                let (Some(x), Some(y)) = (held(i + a, 0), held(j + b, 1)) else { continue };
                let next = (x * n[1] + y) as usize;
                if next == node {
                    continue;
                }
                let [e, f, g] = [0, 1, 2].map(|q| 0.5 * (self.form[node][q] + self.form[next][q]));
                let (a, b) = (a as f64, b as f64);
                see(next, (e * a * a + 2.0 * f * a * b + g * b * b).max(0.0).sqrt());
            }
        }
    }
}

impl LeadField {
    /// The field of a task for passes that run along `feed`.
    ///
    /// # Errors
    /// [`PlanError::Nothing`] where the passes have no direction anywhere.
    pub(in crate::plan) fn find(
        task: &Task<'_>,
        local: &LocalLead<'_>,
        (feed, rough): (&Feed<'_>, bool),
    ) -> Result<Self, PlanError> {
        let rectangle = Rectangle::of(task.surface);
        let clearance = Clearance::new(task, local, rough);
        let mut spline = Spline::constant(&rectangle, spans(task, &rectangle), 0.0);
        let spans = spline.bases.map(|b| b.spans);
        let stands = |at: Uv| -> Vec<Stand> {
            let way = feed(at, &task.surface.jet2(at));
            let both = way.iter().flat_map(|w| [*w, -*w]);
            both.filter_map(|w| clearance.stand(at, &w)).collect()
        };
        // Poles stand over the corners of cells, one row of them outside.
        let corner = |k: usize, axis: usize| {
            let n = spans[axis] as f64;
            let x = k as f64 - 1.0;
            if rectangle.closes[axis] { x.rem_euclid(n) / n } else { (x / n).clamp(0.0, 1.0) }
        };
        let columns = spline.bases[1].count();
        let pole_at = |k: usize| rectangle.domain.at(corner(k / columns, 0), corner(k % columns, 1));
        // Outside None where passes have no direction, inside where no lead does.
        let found: Vec<Option<Option<f64>>> = (0..spline.poles.len())
            .into_par_iter()
            .map(|k| {
                let all = stands(pole_at(k));
                (!all.is_empty()).then(|| clearance.least(&all, local.least_rad))
            })
            .collect();
        if found.iter().all(Option::is_none) {
            return Err(PlanError::Nothing {
                face: task.face.to_owned(),
                why: "passes have no direction on it for which a lead could be found".to_owned(),
            });
        }
        let unmet = [found.iter().filter(|f| **f == Some(None)).count(), found.iter().flatten().count()];
        let mut poles: Vec<f64> = found.into_iter().map(|f| f.flatten().unwrap_or(local.least_rad)).collect();
        let form = (0..poles.len())
            .map(|k| {
                let jet = task.surface.jet2(pole_at(k));
                let [du, dv] = [(jet.du, Axis::U, 0), (jet.dv, Axis::V, 1)]
                    .map(|(d, axis, k)| d * (rectangle.domain.get(axis).length() / spans[k] as f64));
                [du.dot(&du), du.dot(&dv), dv.dot(&dv)]
            })
            .collect();
        let need = poles.clone();
        let network = Poles { spline: &spline.clone(), form, closes: rectangle.closes };
        let rate = local.rate_rad_per_mm / ANY_WAY;
        // Places at equal parts of the cells.
        let halves = [0, 1].map(|k| ASKED * spans[k] + 1);
        let part = |k: usize, axis: usize| k as f64 / (halves[axis] - 1) as f64;
        let mut asked: Vec<Uv> = (0..halves[0] * halves[1])
            .map(|k| rectangle.domain.at(part(k / halves[1], 0), part(k % halves[1], 1)))
            .collect();
        for _ in 0..ROUNDS {
            raise(&mut poles, &network, rate);
            spline.poles.clone_from(&poles);
            let missing: Vec<(Uv, f64)> = asked
                .par_iter()
                .filter_map(|at| {
                    let lead = spline.jet(*at).value;
                    // Between two places the need may go on as it does between nodes, up to halfway.
                    let beyond = steepest(&spline, &need, *at) * (0.5 / ASKED as f64);
                    let short = clearance.least(&stands(*at), lead - beyond)? + beyond - lead;
                    (short > clearance.missing_rad()).then_some((*at, short))
                })
                .collect();
            if missing.is_empty() {
                break;
            }
            for (at, short) in &missing {
                let (u, v) = (spline.bases[0].at(at.u), spline.bases[1].at(at.v));
                for (i, j) in u.index.iter().flat_map(|i| v.index.map(|j| (*i, j))) {
                    let k = spline.index(i, j);
                    poles[k] = poles[k].max((spline.poles[k] + short).min(local.most_rad));
                }
            }
            asked = missing.into_iter().map(|m| m.0).collect();
        }
        raise(&mut poles, &network, rate);
        spline.poles = poles;
        Ok(Self { spline, rectangle, tilt_rad: local.tilt_rad, unmet })
    }

    /// Passes with a word about the places that no lead clears.
    pub(in crate::plan) fn told(&self, mut passes: Passes, face: &str) -> Passes {
        let [places, all] = self.unmet;
        if places > 0 {
            passes.diagnostics.push(Diagnostic::warning(
                face,
                format!(
                    "at {places} of {all} places no lead keeps cutter and holder off the part: verification says what they cut \
                     there; give a tilt, a smaller tool or another direction"
                ),
            ));
        }
        passes
    }
}

/// The greatest difference of values at neighbouring poles around a place.
fn steepest(spline: &Spline, values: &[f64], at: Uv) -> f64 {
    let (u, v) = (spline.bases[0].at(at.u), spline.bases[1].at(at.v));
    let value = |i: usize, j: usize| values[spline.index(u.index[i], v.index[j])];
    let pairs = (0..3).flat_map(|i| (0..4).map(move |j| (i, j)));
    pairs
        .map(|(i, j)| (value(i + 1, j) - value(i, j)).abs().max((value(j, i + 1) - value(j, i)).abs()))
        .fold(0.0, f64::max)
}

fn spans(task: &Task<'_>, rectangle: &Rectangle) -> [usize; 2] {
    let [a, b] = lengths(task.surface, rectangle);
    let side = (APART * task.cutter.radius_mm()).max((a * b / NODES).sqrt());
    [a, b].map(|l| (l / side).clamp(ALONG[0], ALONG[1]).ceil() as usize)
}
