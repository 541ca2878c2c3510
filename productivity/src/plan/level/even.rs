//! Fields whose gradient has the length 1/w everywhere: passes with the same scallop all along, in wanted directions or
//! in those that cost least.
//!
//! From a start along one parameter the wanted vectors X are made again and again of the field's own direction, turned
//! towards the wish of each place as far as that is trusted, and of the width of a strip in that direction; the
//! least-squares problem is solved until the field settles. Wishes have no sign: the field's own direction gives it, so that
//! umbilics, where a wish turns through half a turn, leave no hole. What cannot be both even and as wished is decided by the
//! length of path: several starts and trusts are tried and the shortest is kept.

use super::field::Face;
use super::fit::{Place, Problem};
use crate::plan::{PlanError, Task};
use crate::rectangle::{Rectangle, lengths};
use crate::spline::Spline;
use crate::width::planar_width_mm;
use osculate_geom::{Axis, Darboux, Forms, Jet2, Uv, Vec3};
use rayon::prelude::*;

/// Spans of the spline along the longer side of a face, and fewest along any.
const SPANS: [f64; 2] = [36.0, 8.0];
/// Rounds at most, and the change of the mean deviation at which they end.
const ROUNDS: u32 = 40;
const SETTLED: f64 = 2e-4;
/// The share of the face whose strips may stay narrower than what the path is predicted by.
const NARROW: f64 = 0.02;

/// The direction across the feed that a place wishes for, in its tangent frame, and how far it is trusted, 0 to 1.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Wish {
    pub across: [f64; 2],
    pub trust: f64,
}

/// A settled field.
pub(super) struct Even {
    pub field: Spline,
    /// Predicted length of the passes, mm.
    pub length_mm: f64,
    /// Mean square of the sine between the gradient and the wishes over the face, as these are trusted.
    pub astray: f64,
    /// Root mean square of `|grad phi| w - 1` over the face.
    pub deviation: f64,
    pub rounds: u32,
    /// How far wishes were trusted.
    pub trust: f64,
}

/// Width of the strip whose direction across is `c` in the tangent frame: the planar closed form.
pub(super) fn width_mm(task: &Task<'_>, jet: &Jet2, forms: &Forms, c: [f64; 2]) -> f64 {
    let [e1, e2] = forms.frame;
    let left: Vec3 = e1.into_inner() * c[0] + e2.into_inner() * c[1];
    let feed = left.cross(&forms.normal);
    let frame = Darboux::with_forms(jet, forms, &feed, 0.0);
    let lean = task.lean.about(jet.uv, forms, &frame, task.cutter);
    planar_width_mm(forms, &frame, (task.cutter, lean), task.tolerance.scallop_mm)
}

impl Place {
    /// Width of the strip whose direction across is `c` in the tangent frame, mm; as measured where it was, in any direction.
    ///
    /// Where the closed form changes steeply with the direction no field can follow it, and lines begin to waver between
    /// directions; measured widths are those of lines that are nearly there already.
    pub fn width_mm(&self, task: &Task<'_>, c: [f64; 2]) -> f64 {
        self.measured_mm.unwrap_or_else(|| width_mm(task, &self.jet, &self.forms, c))
    }
}

/// Width by the closed form of the strip along the level line at a place of a field; None where the field has no slope.
pub(super) fn closed_width_mm(task: &Task<'_>, face: &Face<'_>, at: Uv) -> Option<f64> {
    let (_, jet, phi) = face.at(at)?;
    let (uphill, _) = Face::ascent(&jet, &phi).ok()?;
    let (left, forms) = (jet.tangent(uphill), jet.forms().ok()?);
    let c = unit([0, 1].map(|k| left.dot(&forms.frame[k])))?;
    Some(width_mm(task, &jet, &forms, c))
}

fn unit(x: [f64; 2]) -> Option<[f64; 2]> {
    let n = x[0].hypot(x[1]);
    (n > 0.0 && n.is_finite()).then(|| [x[0] / n, x[1] / n])
}

/// The vectors wanted next: from the field's gradients, the wishes and how much all of them count.
fn wanted(
    task: &Task<'_>,
    problem: &Problem,
    gradients: &[[f64; 2]],
    wishes: &[Wish],
    trust: f64,
) -> Vec<[f64; 2]> {
    (0..gradients.len())
        .into_par_iter()
        .map(|k| {
            let Some(own) = unit(gradients[k]) else { return [0.0; 2] };
            let Wish { across, trust: here } = wishes[k];
            let cosine = own[0] * across[0] + own[1] * across[1];
            // Near a right angle the wish has no side: there it must fade, or it would tear the field.
            let by = trust * here * cosine * cosine;
            let c = unit([0, 1].map(|q| (1.0 - by) * own[q] + by * cosine.signum() * across[q]));
            let c = c.unwrap_or(own);
            let w = problem.places[k].width_mm(task, c);
            c.map(|x| x / w)
        })
        .collect()
}

/// Settles the field that starts along a parameter.
fn settle(task: &Task<'_>, problem: &Problem, grows: Axis, wishes: &[Wish], trust: f64) -> Even {
    let mut gradients: Vec<[f64; 2]> = problem.places.iter().map(|p| p.parameter_gradient(grows)).collect();
    let mut out = Even {
        field: problem.zero(),
        length_mm: f64::INFINITY,
        astray: 0.0,
        deviation: f64::INFINITY,
        rounds: 0,
        trust,
    };
    for round in 1..=ROUNDS {
        let x = wanted(task, problem, &gradients, wishes, trust);
        out.field = problem.solve(&x);
        gradients = problem.places.iter().map(|p| p.gradient(&out.field)).collect();
        let before = out.deviation;
        (out.length_mm, out.deviation) = judged(task, problem, &gradients);
        out.astray = astray(problem, &gradients, wishes);
        out.rounds = round;
        if (before - out.deviation).abs() < SETTLED {
            break;
        }
    }
    out
}

/// How far a field's gradients are from what places wish for: [`Even::astray`].
fn astray(problem: &Problem, gradients: &[[f64; 2]], wishes: &[Wish]) -> f64 {
    let (mut square, mut all) = (0.0, 0.0);
    for ((p, g), wish) in problem.places.iter().zip(gradients).zip(wishes) {
        if let (true, Some(g)) = (p.inside, unit(*g)) {
            let weight = wish.trust * p.area_mm2;
            square += weight * (g[0] * wish.across[1] - g[1] * wish.across[0]).powi(2);
            all += weight;
        }
    }
    if all > 0.0 { square / all } else { 0.0 }
}

/// Predicted length of path, and how uneven the field is.
fn judged(task: &Task<'_>, problem: &Problem, gradients: &[[f64; 2]]) -> (f64, f64) {
    let (mut flux, mut area, mut square) = (0.0, 0.0, 0.0);
    let mut steps: Vec<(f64, f64)> = Vec::new();
    for (p, g) in problem.places.iter().zip(gradients) {
        if !p.inside {
            continue;
        }
        let slope = g[0].hypot(g[1]);
        let Some(c) = unit(*g) else { return (f64::INFINITY, f64::INFINITY) };
        let step = slope * p.width_mm(task, c);
        flux += slope * p.area_mm2;
        area += p.area_mm2;
        square += (step - 1.0).powi(2) * p.area_mm2;
        steps.push((step, p.area_mm2));
    }
    steps.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut passed = 0.0;
    let narrow = steps.iter().find(|s| {
        passed += s.1;
        passed >= NARROW * area
    });
    (narrow.map_or(f64::INFINITY, |s| flux / s.0), (square / area).sqrt())
}

/// Wishes of places, and trusts to try them with.
#[derive(Clone, Copy)]
pub(super) struct Wishes<'a> {
    pub of: &'a (dyn Fn(&[Place]) -> Vec<Wish> + Sync),
    pub trusts: &'a [f64],
    /// Whether lines follow them whatever that costs.
    pub binding: bool,
    /// Whether of the two starts the one is taken whose lines follow them better, not that of the shorter path.
    pub followed: bool,
}

/// The field of the shortest path that starts along a parameter, among the trusts given; `measured` tells the width of strips
/// where it is known, mm.
pub(super) fn even(
    task: &Task<'_>,
    grows: Axis,
    wishes: Wishes<'_>,
    measured: &dyn Fn(Uv) -> Option<f64>,
) -> Result<Even, PlanError> {
    let nothing = |why: &str| PlanError::Nothing { face: task.face.to_owned(), why: why.to_owned() };
    let rectangle = Rectangle::of(task.surface);
    let mut problem = Problem::new(task, &rectangle, spans(task, &rectangle), wishes.binding)
        .map_err(|_| nothing("no field can be laid over it: it has no area"))?;
    // Wishes compare directions, of which measured widths know one.
    let all = (wishes.of)(&problem.places);
    problem.places.iter_mut().for_each(|p| p.measured_mm = measured(p.jet.uv));
    wishes
        .trusts
        .iter()
        .map(|trust| settle(task, &problem, grows, &all, *trust))
        .reduce(|a, b| if b.length_mm < a.length_mm { b } else { a })
        .ok_or_else(|| nothing("no field was tried"))
}

fn spans(task: &Task<'_>, rectangle: &Rectangle) -> [usize; 2] {
    let [a, b] = lengths(task.surface, rectangle);
    let most = a.max(b).max(f64::MIN_POSITIVE);
    [a, b].map(|l| (SPANS[0] * l / most).max(SPANS[1]).ceil() as usize)
}

/// The widest strip at a few places of a face, mm: how far passes must be able to run out over its border.
pub(in crate::plan) fn widest_mm(task: &Task<'_>) -> f64 {
    const LOOKS: usize = 6;
    let domain = task.surface.domain();
    let look = |k: usize| {
        let part = |k: usize| (k as f64 + 0.5) / LOOKS as f64;
        let jet = task.surface.jet2(domain.at(part(k / LOOKS), part(k % LOOKS)));
        let forms = jet.forms().ok()?;
        let width = |c: [f64; 2]| width_mm(task, &jet, &forms, c);
        Some(width([1.0, 0.0]).max(width([0.0, 1.0])))
    };
    (0..LOOKS * LOOKS).filter_map(look).fold(0.0, f64::max)
}
