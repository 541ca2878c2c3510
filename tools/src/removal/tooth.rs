//! Tooth marks: what stands between the places at which the teeth pass.
//!
//! A tooth passes a place once in the period `1 / (n z)`. Between two passes of it the tool goes on, so that the part is cut by
//! frozen tools one period apart. At a sample, let `e(t)` be the height at which the tool at the time t enters the sample's normal:
//! the standoff is its least value. Whatever the phase, some tooth passes within the stretch of one period around that instant,
//! and the worst phase leaves `e(a) = e(a + period)`, the two passes on either side as high as each other [R97, eq. 41, at a given
//! feed]. The mark is that height above the standoff. Passes beside this one may cut some of it; the sum of standoff and mark is
//! therefore a bound, which the lattice of passes and teeth reaches where their phases agree. Where it is too high the other passes
//! are asked as well, and the least that any of them leaves counts.
//!
//! Times are those of the read program, so that feeds that joints or the control cap are the capped ones, and a tool that turns
//! makes its marks as it turns. Where a run of feed moves ends, or turns sharply, the tool stands still for a moment.

use super::body::Body as Solid;
use super::goal::Program;
use super::job::{Body, Cut, Job, JobError, Sample, Swept};
use super::target::Target;
use super::tree::{Ways, Which};
use crate::cutter::{Cutter, Line};
use crate::pose::Pose;
use osculate_geom::Unit3;
use osculate_geom::roots::minimum;
use rayon::prelude::*;

/// Accuracy of the instant of the standoff, of its motion and of a period: it has only to lie between the two heights.
const INSTANT: f64 = 1e-2;
/// Cosine of the sharpest corner that is taken without a stop, 45 degrees: a control that keeps to some micrometres of the way goes
/// around a sharper one at less than a fifth of a usual feed.
const CORNER: f64 = 0.707;
/// Halvings of the bracket of the worst phase: to a thousandth of a period and of the motion; of two heights at its ends the
/// higher one is taken, so that what is left of it adds to the mark.
const HALVINGS: u32 = 12;

/// Samples are held against other passes where they stand higher than this share of the limit ...
const HIGH: f64 = 0.5;
/// ... of which the mark is no less than that share, ...
const MARKED: f64 = 0.1;
/// ... and where they are so few: more of them are no edges.
const MOST_LOWERED: usize = 50_000;

/// The teeth of a tool.
#[derive(Clone, Copy)]
pub(super) struct Edge<'a> {
    pub cutter: &'a Cutter,
    /// Time from one tooth to the next, min.
    pub period_min: f64,
}

/// Tools with teeth on the way of a program.
pub(super) struct Teeth<'a> {
    /// In the order of the program.
    pub tools: Vec<Edge<'a>>,
    pub program: Program<'a>,
}

impl Teeth<'_> {
    /// The marks at samples, mm, in their order; zero where no feed move of the cutter made the surface, and where they are not looked
    /// for: at one sample in so many they are.
    pub fn marks(&self, (samples, cuts): (&[Sample], &[Cut]), stock_mm: f64, stride: usize) -> Vec<f64> {
        let mark = |(k, (s, c)): (usize, (&Sample, &Cut))| {
            if k.is_multiple_of(stride) { self.mark(s, c, stock_mm) } else { 0.0 }
        };
        samples.par_iter().zip(cuts).enumerate().map(mark).collect()
    }

    fn mark(&self, sample: &Sample, cut: &Cut, stock_mm: f64) -> f64 {
        let Some(by) = cut.by.filter(|by| !sample.check_only && !by.rapid && by.body == Body::Cutter) else {
            return 0.0;
        };
        (self.left_mm(sample, by.motion as usize, stock_mm) - cut.standoff_mm).max(0.0)
    }

    /// Lowers the marks with which samples stand next to a limit or above it, where other passes leave less. The pass that goes lowest may only graze a
    /// place beside an edge, for less than the time from tooth to tooth, where the one before has left little: what a pass has taken no
    /// later one puts back, so that the least of what they leave is a bound.
    pub fn lower(
        &self,
        (samples, cuts): (&[Sample], &[Cut]),
        marks: &mut [f64],
        job: &Job<'_>,
        limit_mm: f64,
    ) -> Result<(), JobError> {
        let high =
            |k: &usize| marks[*k] > MARKED * limit_mm && cuts[*k].standoff_mm + marks[*k] > HIGH * limit_mm;
        let high: Vec<usize> = (0..samples.len()).filter(high).collect();
        if high.is_empty() || high.len() > MOST_LOWERED {
            return Ok(());
        }
        let (ways, bodies) = (Ways::of_job(job)?, Solid::all(job));
        let lowered: Vec<f64> = high
            .par_iter()
            .map(|k| {
                let (sample, cut) = (&samples[*k], &cuts[*k]);
                // Others are no help where they enter the normal above the limit.
                let target = Target::segment(sample.point, &sample.normal, limit_mm);
                let mut near: Vec<u32> = Vec::new();
                ways.near(&bodies, &target, Which::Cutting, |piece, body, _| {
                    let motion = ways.pieces[piece as usize].motion;
                    if body.cuts() && !job.motions[motion as usize].rapid {
                        near.push(motion);
                    }
                });
                near.sort_unstable();
                near.dedup();
                let own = cut.standoff_mm + marks[*k];
                let least =
                    near.iter().map(|m| self.left_mm(sample, *m as usize, job.stock_mm)).fold(own, f64::min);
                (least - cut.standoff_mm).max(0.0)
            })
            .collect();
        for (k, mark) in high.into_iter().zip(lowered) {
            marks[k] = mark;
        }
        Ok(())
    }

    /// What the worst phase of the teeth leaves at a sample when a motion passes it, mm above it; no more than `stock_mm`.
    fn left_mm(&self, sample: &Sample, motion: usize, stock_mm: f64) -> f64 {
        let Edge { cutter, period_min } = self.tools[self.program.tool_of(motion)];
        let up = Line { origin: sample.point, direction: sample.normal };
        let top = sample.point + sample.normal.into_inner() * stock_mm;
        let height = |t: f64| {
            let pose = self.pose(motion, t);
            match cutter.entry(&pose, &up) {
                Some(entry) if entry.at_mm < stock_mm => entry.at_mm,
                // A tool that is above the layer is so the more the farther it is: the search must know where to go.
                _ => stock_mm + cutter.distance(&pose, &top).max(0.0),
            }
        };
        let (begin, end) = (self.begin(motion), self.program.times_min[motion]);
        // The instant that left the standoff lies in the motion: a stretch that ends there falls, one that begins there rises.
        let share = (INSTANT * period_min / (end - begin)).min(INSTANT);
        let lowest = minimum([begin, end], share, height);
        let instant =
            [begin, end].into_iter().fold(lowest.x, |t, u| if height(u) < height(t) { u } else { t });
        let (mut low, mut high) = (instant - period_min, instant);
        let mut worst = f64::INFINITY;
        for _ in 0..HALVINGS {
            let a = 0.5 * (low + high);
            let (first, second) = (height(a), height(a + period_min));
            // The worst phase leaves no more than the higher of the two, wherever the stretch lies.
            worst = worst.min(first.max(second));
            if first > second { low = a } else { high = a }
        }
        worst.min(stock_mm)
    }

    fn begin(&self, motion: usize) -> f64 {
        if motion == 0 { 0.0 } else { self.program.times_min[motion - 1] }
    }

    /// The tool at a time within the run of feed moves that has this motion.
    fn pose(&self, motion: usize, t: f64) -> Pose {
        let (motions, times) = (self.program.motions, self.program.times_min);
        let mut k = motion;
        while t < self.begin(k) && k > 0 && goes_on(&motions[k - 1], &motions[k]) {
            k -= 1;
        }
        while t > times[k] && k + 1 < motions.len() && goes_on(&motions[k], &motions[k + 1]) {
            k += 1;
        }
        let (swept, begin) = (&motions[k], self.begin(k));
        let whole = times[k] - begin;
        let share = if whole > 0.0 { ((t - begin) / whole).clamp(0.0, 1.0) } else { 1.0 };
        let axis = swept.from.axis.lerp(&swept.to.axis, share);
        Pose {
            tip: swept.from.tip + (swept.to.tip - swept.from.tip) * share,
            axis: Unit3::try_new(axis, 0.0).unwrap_or(swept.to.axis),
        }
    }
}

/// Whether the tool goes from one motion into the next at feed.
fn goes_on(one: &Swept, next: &Swept) -> bool {
    let (a, b) = (one.to.tip - one.from.tip, next.to.tip - next.from.tip);
    // A tool that only turns stands at a corner of any angle.
    !one.rapid && !next.rapid && a.dot(&b) >= CORNER * a.norm() * b.norm()
}

/// Tooth marks at samples.
pub(super) struct Marks {
    /// At each sample, mm; zero where they are not known.
    pub each: Vec<f64>,
    /// Whether they are known.
    pub known: bool,
}

/// Samples are bounded in lots by the height of their marks: up to these shares of them, and the rest.
const LOTS: [f64; 2] = [0.9, 0.99];

impl Marks {
    /// The marks of each lot, above the first and up to the second of two, ascending.
    pub fn lots(&self) -> Vec<[f64; 2]> {
        let mut sorted = self.each.clone();
        sorted.sort_unstable_by(f64::total_cmp);
        let at = |share: f64| sorted.get((share * sorted.len() as f64) as usize).copied();
        let mut lots: Vec<f64> = LOTS.iter().filter_map(|share| at(*share)).collect();
        lots.push(self.most_mm());
        lots.dedup();
        let lows = std::iter::once(f64::NEG_INFINITY).chain(lots.iter().copied());
        lows.zip(&lots).map(|(low, most)| [low, *most]).collect()
    }

    /// The highest, mm.
    pub fn most_mm(&self) -> f64 {
        self.each.iter().fold(0.0, |a: f64, b| a.max(*b))
    }
}
