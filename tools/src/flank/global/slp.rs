//! The sequence of linear problems: linearise, solve inside a trust region, accept what is better.
//!
//! What does not change the deviation at all would make the answer arbitrary; a little of the squared third differences of
//! poles is added to the goal against that. The search begins with even motions of small root mean square, which have few local
//! optima, and goes on to the maximum.

use super::band::Bordered;
use super::linear::{Moves, Unevenness, derivatives, unevenness, unevenness_mm2};
use super::qp::{Constraint, Program, Rows, lower_bound};
use super::sampling::{Judged, Places, goal};
use super::{Found, GlobalError, Goal, Options, Task, starts};
use crate::flank::axes::{AxisSurface, ORDER};
use crate::flank::deviation::deviation;
use crate::flank::envelope::Envelope;
use osculate_geom::Uv;

/// Weight of unevenness that makes the answer unique, relative to the value over R squared.
const UNIQUE: f64 = 1e-7;
/// The same where the search begins: an even motion first, then a better one.
const SMOOTH: [f64; 3] = [1.0, 1e-2, 1e-4];
/// First and greatest trust region, in radii.
const FIRST_REGION: f64 = 0.1;
const MOST_REGION: f64 = 0.5;
/// The search ends where a linear problem promises less than this part of the value, or the region is this part of R.
const PROMISE: f64 = 1e-5;
const LEAST_REGION: f64 = 1e-6;
/// How far poles may move for the lower bound, in radii.
const BOUND_REGION: f64 = 0.01;
/// Motions of more spans than this are held against those of half as many.
const MOST_EVEN: usize = 20;
/// Iterations given to each start and weight.
const TRIAL: usize = 8;
/// Most rounds in which places between the grid's that stand out are added, and by how much they may, of the value.
const EXCHANGES: usize = 6;
const EXCESS: f64 = 5e-5;
/// Places whose deviation cannot come within this part of the value inside the trust region are left out.
const NEAR: f64 = 0.7;

fn constraints(rows: &Rows, judged: &Judged, o: &Options, region: f64) -> Vec<Constraint> {
    let mut out = Vec::new();
    for (k, v) in judged.values().enumerate() {
        let row = k as u32;
        let change: f64 =
            region * rows.values[k * rows.length..(k + 1) * rows.length].iter().map(|g| g.abs()).sum::<f64>();
        // Where gouges count more, the value is theirs and says nothing of the material left.
        let level = if o.gouge_weight > 1.0 { 0.0 } else { NEAR * judged.value };
        let forbids = o.goal == Goal::Rms && o.gouge_weight > 1.0;
        if o.goal == Goal::Minimax && v + change >= level {
            out.push(Constraint { row, sign: 1.0, share: 1.0, limit: -v });
        }
        if forbids || (o.goal == Goal::Minimax && (change - v) * o.gouge_weight >= level) {
            out.push(Constraint { row, sign: -1.0, share: 1.0 / o.gouge_weight, limit: v });
        }
    }
    out
}

/// One search from one start.
struct Search<'a> {
    task: &'a Task<'a>,
    places: &'a Places,
    options: Options,
    axes: AxisSurface,
    judged: Judged,
    region: f64,
    /// Weight of what makes the answer unique, relative to the value over R squared.
    unique: f64,
    iterations: usize,
    converged: bool,
}

impl<'a> Search<'a> {
    fn new(
        task: &'a Task<'a>,
        places: &'a Places,
        options: Options,
        axes: AxisSurface,
    ) -> Result<Self, GlobalError> {
        let judged = judge(task, places, &axes, &options)?;
        let region = FIRST_REGION * task.side.radius_mm();
        Ok(Self {
            task,
            places,
            options,
            axes,
            judged,
            region,
            unique: UNIQUE,
            iterations: 0,
            converged: false,
        })
    }

    /// Weight of the squared third differences: what was asked for, and what makes the answer unique.
    fn weight(&self) -> f64 {
        let r = self.task.side.radius_mm();
        self.options.smoothness_per_mm + self.unique * self.judged.value / (r * r)
    }

    /// Whether no better motion is wanted.
    fn is_enough(&self) -> bool {
        let uneven = if self.options.smoothness_per_mm > 0.0 { unevenness_mm2(&self.axes) } else { 0.0 };
        self.judged.value + self.options.smoothness_per_mm * uneven <= self.options.enough_mm
    }

    fn run(&mut self, most: usize) -> Result<(), GlobalError> {
        let r = self.task.side.radius_mm();
        let end = self.iterations + most;
        self.converged = false;
        let mut kept: Option<(Rows, Moves)> = None;
        while self.iterations < end {
            if self.is_enough() {
                self.converged = true;
                break;
            }
            self.iterations += 1;
            let (rows, moves) = kept.take().unwrap_or_else(|| {
                let moves = Moves::new(&self.axes, !self.task.side.is_cylinder());
                (derivatives(&self.axes, &self.judged, &moves), moves)
            });
            let weight = self.weight();
            let uneven = unevenness(&self.axes, &moves);
            let x = self.step(&rows, &uneven, weight)?;
            let predicted = rows.times(&x).into_iter().zip(self.judged.values()).map(|(a, b)| a + b);
            let axes = moves.apply(&self.axes, &x);
            let merit = |axes: &AxisSurface, value: f64| value + weight * unevenness_mm2(axes);
            let before = merit(&self.axes, self.judged.value);
            let promised = before - merit(&axes, goal(predicted, &self.options));
            let judged = judge(self.task, self.places, &axes, &self.options)?;
            let gained = before - merit(&axes, judged.value);
            let reached = x.iter().fold(0.0, |a: f64, x| a.max(x.abs()));
            let enough = promised >= PROMISE * self.judged.value;
            if gained > 0.1 * promised {
                (self.axes, self.judged) = (axes, judged);
                if gained > 0.7 * promised && reached > 0.9 * self.region {
                    self.region = (2.0 * self.region).min(MOST_REGION * r);
                } else if gained < 0.3 * promised {
                    self.region *= 0.5;
                }
            } else {
                self.region = 0.3 * reached.min(self.region);
                kept = Some((rows, moves));
            }
            if !enough || self.region < LEAST_REGION * r {
                self.converged = true;
                break;
            }
        }
        Ok(())
    }

    /// The best displacement inside the trust region.
    fn step(&self, rows: &Rows, uneven: &Unevenness, weight: f64) -> Result<Vec<f64>, GlobalError> {
        let n = uneven.gradient.len();
        let mut curvature = Bordered::zeros(n, rows.length);
        curvature.add_band(&uneven.matrix, weight);
        let r = self.task.side.radius_mm();
        for i in 0..n {
            curvature.add(i, i, 1e-3 * UNIQUE * self.judged.value / (r * r));
        }
        let mut gradient: Vec<f64> = uneven.gradient.iter().map(|g| g * weight).collect();
        if self.options.goal == Goal::Rms {
            // Half the mean square over the value has the value's own gradient.
            let values: Vec<f64> = self.judged.values().collect();
            let scale = 1.0 / (values.len() as f64 * self.judged.value.max(1e-9 * r));
            for (k, first) in rows.first.iter().enumerate() {
                curvature.add_square(
                    *first as usize,
                    &rows.values[k * rows.length..(k + 1) * rows.length],
                    scale,
                );
            }
            let scaled: Vec<f64> = values.iter().map(|v| v * scale).collect();
            rows.add_transposed(&scaled, &mut gradient);
            curvature.corner = 1e-6;
        }
        let mut constraints = constraints(rows, &self.judged, &self.options, self.region);
        let rows = &rows.only(&mut constraints);
        let program = Program {
            rows,
            constraints: &constraints,
            curvature: &curvature,
            linear: &gradient,
            cost: 1.0,
            limit: self.region,
        };
        program.solve().ok_or(GlobalError::Numbers { iteration: self.iterations }).map(|a| a.x)
    }
}

/// The dual's value of the linearised problem without smoothness.
fn bound(
    task: &Task<'_>,
    places: &Places,
    axes: &AxisSurface,
    options: &Options,
) -> Result<Option<f64>, GlobalError> {
    let judged = judge(task, places, axes, options)?;
    let moves = Moves::new(axes, !task.side.is_cylinder());
    let rows = derivatives(axes, &judged, &moves);
    let n = moves.unknowns();
    let r = task.side.radius_mm();
    let mut curvature = Bordered::zeros(n, rows.length);
    for i in 0..n {
        curvature.add(i, i, 1e-9 * judged.value / (r * r));
    }
    let limit = BOUND_REGION * r;
    let constraints = constraints(&rows, &judged, options, limit);
    let linear = vec![0.0; n];
    let program = Program {
        rows: &rows,
        constraints: &constraints,
        curvature: &curvature,
        linear: &linear,
        cost: 1.0,
        limit,
    };
    Ok(program.solve().map(|a| lower_bound(&rows, &constraints, &a.multipliers, n, limit)))
}

fn judge(task: &Task<'_>, places: &Places, axes: &AxisSurface, o: &Options) -> Result<Judged, GlobalError> {
    places.judge(task, axes, o).map_err(|at: Uv| GlobalError::NotFinite { u: at.u, v: at.v })
}

fn check(task: &Task<'_>, o: &Options) -> Result<(), GlobalError> {
    let [along, across] = task.judged.count;
    let counts = [("spans", o.spans, ORDER), ("places along u", along, 2), ("places along v", across, 3)];
    for (what, got, least) in counts {
        if got < least {
            return Err(GlobalError::TooFew { what, got, least });
        }
    }
    for (what, got, least) in [
        ("gouge_weight", o.gouge_weight, 1.0),
        ("smoothness_per_mm", o.smoothness_per_mm, 0.0),
        ("enough_mm", o.enough_mm, 0.0),
    ] {
        if !(got.is_finite() && got >= least) {
            return Err(GlobalError::Weight { what, got, least });
        }
    }
    Ok(())
}

/// The best motion for a face.
///
/// It begins beside the rules ([`starts`]) and at `more` motions that the caller has, with the same number of spans. The optimum
/// is a local one: the best of what all of them lead to.
///
/// # Errors
/// [`GlobalError`].
pub fn optimise(task: &Task<'_>, options: &Options, more: &[AxisSurface]) -> Result<Found, GlobalError> {
    check(task, options)?;
    let [along, across] = task.judged.count;
    let judged =
        crate::flank::deviation::Patch { count: [(along / 3).max(5), across.min(11)], ..task.judged };
    let thin = Task { judged, ..*task };
    let few = Places::new(&thin);
    let own: Vec<AxisSurface> = starts(task, options.spans)?.into_iter().map(|s| s.axes).collect();
    let mut best: Option<(f64, AxisSurface)> = None;
    for axes in own.into_iter().chain(more.iter().cloned()) {
        let even = Options { goal: Goal::Rms, gouge_weight: 1.0, ..*options };
        let mut s = Search::new(&thin, &few, even, axes)?;
        for unique in SMOOTH {
            s.unique = unique;
            s.region = FIRST_REGION * task.side.radius_mm();
            s.run(TRIAL)?;
        }
        if options.goal == Goal::Minimax || options.gouge_weight > 1.0 {
            let (iterations, axes) = (s.iterations, s.axes);
            s = Search::new(&thin, &few, *options, axes)?;
            s.iterations = iterations;
            s.unique = SMOOTH[SMOOTH.len() - 1];
            s.run(2 * TRIAL)?;
        }
        if best.as_ref().is_none_or(|b| s.judged.value < b.0) {
            best = Some((s.judged.value, s.axes.clone()));
        }
        if s.is_enough() {
            break;
        }
    }
    let (_, axes) = best.ok_or(GlobalError::TooFew { what: "starts", got: 0, least: 1 })?;
    let found = finish(task, options, axes)?;
    // A motion with half the spans is one of these, too, and may have been found more easily.
    let many = options.spans.is_multiple_of(2) && options.spans > MOST_EVEN;
    if options.goal == Goal::Minimax && many && found.value_mm > options.enough_mm {
        let half = optimise(task, &Options { spans: options.spans / 2, ..*options }, &[])?;
        if half.value_mm < found.value_mm {
            return finish(task, options, half.axes.refined());
        }
    }
    Ok(found)
}

/// From the best start on the whole grid to the end, with places added where the deviation stands out between the grid's.
fn finish(task: &Task<'_>, options: &Options, axes: AxisSurface) -> Result<Found, GlobalError> {
    let mut places = Places::new(task);
    let mut best: Option<(f64, AxisSurface, bool)> = None;
    let (mut axes, mut iterations) = (axes, 0);
    for round in 0..EXCHANGES {
        let mut s = Search::new(task, &places, *options, axes)?;
        s.iterations = iterations;
        if round > 0 {
            s.region *= 0.1;
        }
        s.run(options.iterations)?;
        iterations = s.iterations;
        let pieces = std::slice::from_ref(&s.axes);
        let fine = deviation(&Envelope::new(task.side, pieces), task.surface, task.fine());
        let ends = [fine.min, fine.max];
        let all = fine.values_mm.iter().copied().chain(ends.map(|e| e.value_mm));
        let (sampled, whole) = (s.judged.value, goal(all, options));
        if best.as_ref().is_none_or(|b| whole < b.0) {
            best = Some((whole, s.axes.clone(), s.converged));
        }
        axes = s.axes;
        if options.goal == Goal::Rms || whole <= (sampled * (1.0 + EXCESS)).max(options.enough_mm) {
            break;
        }
        let over = |v: f64| goal(std::iter::once(v), options) > sampled * (1.0 + 0.3 * EXCESS);
        let extra: Vec<Uv> = fine
            .at
            .iter()
            .copied()
            .zip(fine.values_mm.iter().copied())
            .chain(ends.map(|e| (e.at, e.value_mm)))
            .filter(|(_, v)| over(*v))
            .map(|(at, _)| at)
            .collect();
        places.add(task, &extra);
    }
    let (value_mm, axes, converged) = best.ok_or(GlobalError::TooFew { what: "rounds", got: 0, least: 1 })?;
    let (bound_mm, bound_refined_mm) = match options.goal {
        Goal::Minimax => {
            (bound(task, &places, &axes, options)?, bound(task, &places, &axes.refined(), options)?)
        }
        Goal::Rms => (None, None),
    };
    let bound_within_mm = BOUND_REGION * task.side.radius_mm();
    Ok(Found { axes, value_mm, bound_mm, bound_refined_mm, bound_within_mm, iterations, converged })
}
