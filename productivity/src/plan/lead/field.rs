//! A lead over the face as a bicubic spline that is as low as the places of a lattice allow.
//!
//! A value of the spline is a mean of the poles around, and its slope a mean of their differences: poles that differ by no more
//! than a rate times their distance bound the rate of the field. Where the lead turns out too low between the places of the lattice it is
//! looked for there too, and the spline laid once more.

use super::balance;
use super::envelope::Network;
use super::fit::Floors;
use super::lean::{Angles, Feed, LeadField, LocalLead};
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
struct Poles {
    /// How many along u and v.
    count: [i64; 2],
    /// First fundamental form at the poles, by steps of the grid: `[E, F, G]`, mm2.
    form: Vec<[f64; 3]>,
    closes: [bool; 2],
}

impl Network for Poles {
    fn around(&self, node: usize, see: &mut dyn FnMut(usize, f64)) {
        let n = self.count;
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

/// What a lead is looked for over.
struct Over<'a> {
    task: &'a Task<'a>,
    local: &'a LocalLead<'a>,
    clearance: &'a Clearance<'a>,
    rectangle: Rectangle,
}

impl Over<'_> {
    /// The lowest lead that clears the contacts at all places, and at how many of them none does, and how many were asked.
    fn spline(
        &self,
        stand: &(dyn Fn(Uv) -> Option<Stand> + Sync),
    ) -> Result<(Spline, [usize; 2]), PlanError> {
        let (task, local, rectangle) = (self.task, self.local, &self.rectangle);
        let mut spline = Spline::constant(rectangle, spans(task, rectangle), local.least_rad);
        let spans = spline.bases.map(|b| b.spans);
        // Places at equal parts of the cells: where a lead is looked for, and those between them.
        let parts = spans.map(|n| ASKED * n);
        let place = |i: f64, j: f64| rectangle.domain.at(i / parts[0] as f64, j / parts[1] as f64);
        let corner = |k: usize| place((k / (parts[1] + 1)) as f64, (k % (parts[1] + 1)) as f64);
        // Outside None where passes have no direction, inside where no lead does.
        let found: Vec<Option<Option<f64>>> = (0..(parts[0] + 1) * (parts[1] + 1))
            .into_par_iter()
            .map(|k| stand(corner(k)).map(|s| self.clearance.least(&s, local.least_rad)))
            .collect();
        if found.iter().all(Option::is_none) {
            return Err(PlanError::Nothing {
                face: task.face.to_owned(),
                why: "passes have no direction on it for which a lead could be found".to_owned(),
            });
        }
        let unmet = [found.iter().filter(|f| **f == Some(None)).count(), found.iter().flatten().count()];
        let network = self.network(&spline);
        let rate = local.rate_rad_per_mm / ANY_WAY;
        let mut floors = Floors::new(&spline);
        for (k, need) in found.iter().enumerate() {
            if let Some(Some(need)) = need {
                floors.add(&spline, corner(k), *need);
            }
        }
        let between = |k: usize| place((k / parts[1]) as f64 + 0.5, (k % parts[1]) as f64 + 0.5);
        let asked: Vec<Uv> = (0..parts[0] * parts[1]).map(between).collect();
        for round in 0..ROUNDS {
            floors.raise(&mut spline, &network, rate);
            floors.lower(&mut spline, (&network, rate), local.least_rad);
            let missing: Vec<(Uv, f64)> = asked
                .par_iter()
                .filter_map(|at| {
                    let lead = spline.jet(*at).value;
                    let need = self.clearance.least(&stand(*at)?, lead)?;
                    (need - lead > self.clearance.missing_rad()).then_some((*at, need))
                })
                .collect();
            if missing.is_empty() {
                break;
            }
            for (at, need) in &missing {
                floors.add(&spline, *at, *need);
            }
            // What was lowered elsewhere may lack something next time.
            if round + 1 == ROUNDS {
                floors.raise(&mut spline, &network, rate);
            }
        }
        spline.poles.iter_mut().for_each(|p| *p = p.min(local.most_rad));
        Ok((spline, unmet))
    }

    fn network(&self, spline: &Spline) -> Poles {
        let rectangle = &self.rectangle;
        let spans = spline.bases.map(|b| b.spans);
        // Poles stand over the corners of cells, one row of them outside.
        let corner = |k: usize, axis: usize| {
            let n = spans[axis] as f64;
            let x = k as f64 - 1.0;
            if rectangle.closes[axis] { x.rem_euclid(n) / n } else { (x / n).clamp(0.0, 1.0) }
        };
        let columns = spline.bases[1].count();
        let form = (0..spline.poles.len())
            .map(|k| {
                let at = rectangle.domain.at(corner(k / columns, 0), corner(k % columns, 1));
                let jet = self.task.surface.jet2(at);
                let [du, dv] = [(jet.du, Axis::U, 0), (jet.dv, Axis::V, 1)]
                    .map(|(d, axis, k)| d * (rectangle.domain.get(axis).length() / spans[k] as f64));
                [du.dot(&du), du.dot(&dv), dv.dot(&dv)]
            })
            .collect();
        Poles { count: spline.bases.map(|b| b.count() as i64), form, closes: rectangle.closes }
    }
}

impl LeadField {
    /// The field of a task for passes that run along `feed`, and against it unless they run one way alone.
    ///
    /// # Errors
    /// [`PlanError::Nothing`] where the passes have no direction anywhere.
    pub(in crate::plan) fn find(
        task: &Task<'_>,
        local: &LocalLead<'_>,
        (feed, one_way): (&Feed<'_>, bool),
        rough: bool,
    ) -> Result<Self, PlanError> {
        let clearance = Clearance::new(task, local, rough);
        let over = Over { task, local, clearance: &clearance, rectangle: Rectangle::of(task.surface) };
        let found = |sign: f64| {
            let way = |at: Uv| Some(feed(at, &task.surface.jet2(at))? * sign);
            let tilt = balance::tilts(task, local, &clearance, &over.rectangle, &way);
            let stand = |at: Uv| clearance.stand(at, &way(at)?, tilt.jet(at).value);
            let (lead, unmet) = over.spline(&stand)?;
            Ok::<_, PlanError>((Angles { lead, tilt }, unmet))
        };
        let (along, unmet) = found(1.0)?;
        let (against, more) = if one_way { (along.clone(), [0; 2]) } else { found(-1.0)? };
        let unmet = [0, 1].map(|k| unmet[k] + more[k]);
        Ok(Self { senses: [along, against], rectangle: over.rectangle, unmet })
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

fn spans(task: &Task<'_>, rectangle: &Rectangle) -> [usize; 2] {
    let [a, b] = lengths(task.surface, rectangle);
    let side = (APART * task.cutter.radius_mm()).max((a * b / NODES).sqrt());
    [a, b].map(|l| (l / side).clamp(ALONG[0], ALONG[1]).ceil() as usize)
}
