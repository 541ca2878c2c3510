//! The only place where a verdict is made.
//!
//! Faces are looked at evenly, coarsely first: a program that is far off is told so at a fraction of the cost of a right one.
//! Then follow tooth marks, bounds on what hides between samples with more samples where these are not near enough, and the
//! declared raw material. What the limits are compared with is always measured or bounded; what is not looked at stands in the
//! scope.

use super::boundary::sample_boundary;
use super::crest::crests;
use super::cut::cut;
use super::density::Density;
use super::density::Hidden;
use super::goal::{Goal, GoalFace, GoalStock, Gravity, Program, Unseen};
use super::hidden::Wanted;
use super::job::{Body, Cut, Job, JobError, Sample};
use super::refine::{Measured, Refined, refine};
use super::sampling::{Patch, SamplingError, sample_surface};
use super::stock::{BlankError, Stock, StockJob, Upper};
use super::tally::{Limits, Tally, TallyError, tally};
use super::tooth::Teeth;
use super::verdict::{Answer, Figures, ScopeRow, StockFound, Verdict};
use osculate_geom::Surface;

/// Samples across a strip that a ball of the cutter's radius leaves on a plane.
const SAMPLES_ACROSS: f64 = 10.0;
/// Faces that are only checked are sampled this many times as coarsely: there only deep contact matters, and bounds between the
/// samples add what is needed.
const CHECK_COARSER: f64 = 4.0;
/// The share of the samples allowed that the even ones take at most.
const MOST_EVEN: f64 = 0.8;
/// Samples that are added at most, of the even ones.
const MOST_ADDED: usize = 4;
/// A first look is this many times as coarse: it costs a twenty-fifth.
const COARSE: f64 = 5.0;
/// A limit exceeded this many times by the first look ends the work: what lies closer would not turn the answer, and no plan
/// that is laid out anew makes good for it.
const HOPELESS: f64 = 10.0;
/// The share of the area left uncut by the first look that ends the work.
const HOPELESS_UNCUT: f64 = 0.05;
/// Shares of the work, for its progress.
const SHARES: [f64; 3] = [0.05, 0.65, 0.85];
/// Fewest samples that say anything.
pub const LEAST_SAMPLES: usize = 100;

/// Why motions cannot be judged.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProveError {
    /// No face to machine.
    #[error("there is no face to judge")]
    NoFace,
    /// Nothing moves.
    #[error("the program has no motion: at least two positions are needed")]
    NoMotion,
    /// Too few samples.
    #[error("max_samples = {got} is too few: {LEAST_SAMPLES} or more are needed")]
    Samples {
        /// What was given.
        got: usize,
    },
    /// Times that are not those of the motions.
    #[error("{times} times for {motions} motions: one for each, or none")]
    Times {
        /// Times.
        times: usize,
        /// Motions.
        motions: usize,
    },
    /// A face that cannot be sampled.
    #[error("{face}: {why}")]
    Sampling {
        /// The face.
        face: String,
        /// Why.
        why: SamplingError,
    },
    /// Motions that cannot be followed.
    #[error(transparent)]
    Motions(#[from] JobError),
    /// Limits that are none.
    #[error(transparent)]
    Limits(#[from] TallyError),
    /// Raw material that is none.
    #[error("raw material: {0}")]
    Blank(#[from] BlankError),
}

/// Judges a program against a goal.
///
/// `progress` gets the fraction done. The verdict does not depend on the number of threads.
///
/// # Errors
/// [`ProveError`] where there is nothing to judge or it cannot be judged.
pub fn prove(
    goal: &Goal<'_>,
    program: Program<'_>,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Verdict, ProveError> {
    let (motions, times) = (program.motions.len(), program.times_min.len());
    if motions == 0 {
        return Err(ProveError::NoMotion);
    }
    if times != 0 && times != motions {
        return Err(ProveError::Times { times, motions });
    }
    if goal.machined.is_empty() {
        return Err(ProveError::NoFace);
    }
    if goal.looks.max_samples < LEAST_SAMPLES {
        return Err(ProveError::Samples { got: goal.looks.max_samples });
    }
    let trial = Trial::new(goal, program);
    let mut notes = Vec::new();
    let spacing = trial.spacing_mm(&mut notes);
    let mut look = trial.look(COARSE * spacing, &|f| progress(SHARES[0] * f))?;
    let coarse = trial.is_hopeless(&look.tally);
    if !coarse {
        let rest = SHARES[1] - SHARES[0];
        look = trial.look(spacing, &|f| progress(SHARES[0] + rest * f))?;
    }
    let marks = trial.marks(&look.measured);
    let crest_median_mm = trial.crests(&look.measured)?;
    let refined = if coarse { unbounded() } else { trial.refine(&mut look, &marks)? };
    progress(SHARES[2]);
    // Samples that were added have marks too.
    let marks = if refined.added > 0 { trial.marks(&look.measured) } else { marks };
    let stock = if coarse { None } else { trial.carve(&|f| progress(SHARES[2] + (1.0 - SHARES[2]) * f))? };
    progress(1.0);
    let Look { measured, tally, density, lost } = look;
    let Measured { samples, patches, cuts } = measured;
    let bend = patches.iter().flatten().map(|p| p.convex_per_mm.max(p.concave_per_mm)).fold(0.0, f64::max);
    notes.extend(lost);
    let height = |(s, mark): (&Cut, &f64)| {
        if s.standoff_mm > trial.limits.uncut_mm { 0.0 } else { s.standoff_mm.max(0.0) + mark }
    };
    let machined =
        samples.iter().zip(&cuts).zip(&marks.each).filter(|((s, c), _)| !s.check_only && c.by.is_some());
    let with_marks = machined.map(|((_, c), m)| height((c, m))).fold(0.0, f64::max);
    let height_max_mm = tally.scallop_max_mm.max(if marks.known { with_marks } else { 0.0 });
    let figures = Figures {
        added: refined.added,
        spacing_mm: density.spacing_mm,
        hidden: Hidden { scallop_mm: (refined.hidden.scallop_mm - height_max_mm).max(0.0), ..refined.hidden },
        smallest_radius_mm: (bend > 0.0).then(|| 1.0 / bend),
        crest_median_mm,
        mark_max_mm: marks.known.then(|| marks.most_mm()),
        height_max_mm,
        coarse,
        stock,
        tally,
    };
    let (answer, why) = trial.answer(&figures, refined.left_out);
    let told = goal.control.remarks.iter().filter(|r| r.gravity == Gravity::Told).map(|r| r.text.clone());
    let remarks = told.chain(notes).collect();
    Ok(Verdict {
        answer,
        only: trial.only(),
        why,
        remarks,
        scope: trial.scope(&figures),
        figures,
        samples,
        cuts,
    })
}

/// What is known between samples that were not bounded.
fn unbounded() -> Refined {
    Refined { hidden: Hidden { scallop_mm: f64::INFINITY, gouge_mm: f64::INFINITY }, added: 0, left_out: 0 }
}

/// Samples with what was found at them.
struct Look {
    measured: Measured,
    tally: Tally,
    density: Density,
    /// What could not be looked at.
    lost: Vec<String>,
}

/// Tooth marks at samples.
struct Marks {
    each: Vec<f64>,
    known: bool,
}

/// Samples are bounded in lots by the height of their marks: up to these shares of them, and the rest.
const LOTS: [f64; 2] = [0.9, 0.99];

impl Marks {
    /// The highest mark of each lot, ascending and all different.
    fn lots(&self) -> Vec<f64> {
        let mut sorted = self.each.clone();
        sorted.sort_unstable_by(f64::total_cmp);
        let at = |share: f64| sorted.get((share * sorted.len() as f64) as usize).copied();
        let mut lots: Vec<f64> = LOTS.iter().filter_map(|share| at(*share)).collect();
        lots.push(self.most_mm());
        lots.dedup();
        lots
    }

    fn most_mm(&self) -> f64 {
        self.each.iter().fold(0.0, |a: f64, b| a.max(*b))
    }
}

/// A goal with a program that is held against it.
struct Trial<'a> {
    goal: &'a Goal<'a>,
    program: Program<'a>,
    /// Faces by number: to machine first, then those that are checked.
    faces: Vec<&'a GoalFace<'a>>,
    surfaces: Vec<&'a dyn Surface>,
    limits: Limits,
    /// Width of a strip that a ball of the cutter's radius leaves on a plane, mm.
    strip_mm: f64,
}

impl<'a> Trial<'a> {
    fn new(goal: &'a Goal<'a>, program: Program<'a>) -> Self {
        let faces: Vec<&GoalFace<'_>> = goal.machined.iter().chain(&goal.checked).collect();
        let surfaces = faces.iter().map(|f| f.surface).collect();
        let limits = Limits::new(goal.limits.scallop_mm, goal.limits.gouge_mm);
        let strip_mm = 2.0 * (2.0 * goal.limits.scallop_mm * goal.tool.cutter.radius_mm()).sqrt();
        Self { goal, program, faces, surfaces, limits, strip_mm }
    }

    fn is_machined(&self, face: usize) -> bool {
        face < self.goal.machined.len()
    }

    /// How far samples are to be apart.
    fn spacing_mm(&self, notes: &mut Vec<String>) -> f64 {
        let wanted = self.goal.looks.spacing_mm.unwrap_or(self.strip_mm / SAMPLES_ACROSS);
        let area = |k: usize| {
            let coarser = if self.is_machined(k) { 1.0 } else { CHECK_COARSER * CHECK_COARSER };
            osculate_geom::quadrature::area(self.surfaces[k], 1e-2).value / coarser
        };
        let whole: f64 = (0..self.surfaces.len()).map(area).filter(|a| a.is_finite()).sum();
        let max = self.goal.looks.max_samples;
        let spacing = wanted.max((whole / (MOST_EVEN * max as f64)).sqrt());
        if spacing > 1.01 * wanted {
            notes.push(format!(
                "warning: verification: samples are {spacing:.4} mm apart instead of {wanted:.4} mm to stay within {max} of them"
            ));
        }
        spacing
    }

    /// Tool and motions with samples that are looked at.
    fn job(&self, samples: &'a [Sample]) -> Job<'a> {
        Job { samples, ..self.job_without() }
    }

    fn job_without(&self) -> Job<'a> {
        let tool = &self.goal.tool;
        Job {
            cutter: tool.cutter,
            holder: tool.holder,
            motions: self.program.motions,
            samples: &[],
            stock_mm: self.goal.stock.layer_mm(),
            depth_mm: tool.cutter.radius_mm(),
        }
    }

    /// Samples an even distance apart, and what is left at them.
    fn look(&self, spacing: f64, progress: &(dyn Fn(f64) + Sync)) -> Result<Look, ProveError> {
        let max = self.goal.looks.max_samples;
        let mut samples: Vec<Sample> = Vec::new();
        let mut patches: Vec<Option<Patch>> = Vec::new();
        let mut density: Option<Density> = None;
        let mut lost = Vec::new();
        for (k, face) in self.faces.iter().enumerate() {
            let check_only = !self.is_machined(k);
            let step = if check_only { CHECK_COARSER * spacing } else { spacing };
            let found = sample_surface(face.surface, k as u32, step, max)
                .map_err(|why| ProveError::Sampling { face: face.name.to_owned(), why })?;
            if found.lost_area_mm2 > 0.0 {
                let area = found.lost_area_mm2;
                lost.push(format!(
                    "warning: {}: {area:.4} mm2 of it have no tangent plane and are not verified",
                    face.name
                ));
            }
            if !check_only {
                density = Some(density.map_or(found.density, |d| d.union(&found.density)));
            }
            samples.extend(found.samples.into_iter().map(|s| Sample { check_only, ..s }));
            patches.extend(found.patches.into_iter().map(Some));
            if !check_only {
                for outline in &face.outlines {
                    samples.extend(sample_boundary(face.surface, outline, k as u32, step));
                }
            }
            patches.resize(samples.len(), None);
        }
        samples.extend(self.goal.fixtures.iter().copied());
        patches.resize(samples.len(), None);
        let density = density.ok_or(ProveError::NoFace)?;
        let cuts = cut(&Job { samples: &samples, ..self.job_without() }, progress)?;
        let tally = self.tally(&samples, &cuts, &density)?;
        Ok(Look { measured: Measured { samples, patches, cuts }, tally, density, lost })
    }

    fn tally(&self, samples: &[Sample], cuts: &[Cut], density: &Density) -> Result<Tally, ProveError> {
        // The tool's effective radius across the feed, from the strip that it leaves.
        let effective = self.strip_mm * self.strip_mm / (8.0 * self.limits.scallop_mm);
        Ok(tally(samples, cuts, &self.limits, density, effective)?)
    }

    /// Whether a coarse look says that the program cannot hold, by far.
    fn is_hopeless(&self, t: &Tally) -> bool {
        let area: f64 = t.histogram.iter().map(|b| b.area_mm2).sum();
        let uncut = t.uncut_area_mm2 - self.goal.limits.unreached_mm2;
        t.gouge_max_mm > HOPELESS * self.limits.gouge_mm
            || t.rapid_max_mm.max(t.holder_max_mm) > HOPELESS * self.limits.collision_mm
            || uncut > HOPELESS_UNCUT * area
    }

    fn crests(&self, measured: &Measured) -> Result<f64, ProveError> {
        let job = Job { samples: &measured.samples, ..self.job_without() };
        Ok(crests(&self.surfaces, &job, &measured.cuts, self.strip_mm, self.limits.uncut_mm)?)
    }

    /// Time from tooth to tooth, min, where it is known.
    fn period_min(&self) -> Option<f64> {
        let tool = &self.goal.tool;
        let per_min = tool.spindle_rpm? * f64::from(tool.teeth.unwrap_or(1));
        // The layers of a roughing stand higher than any mark, and are judged.
        let judged = !self.program.times_min.is_empty() && self.goal.roughing_mm.is_none();
        (judged && per_min > 0.0 && per_min.is_finite()).then(|| 1.0 / per_min)
    }

    fn marks(&self, measured: &Measured) -> Marks {
        let Some(period_min) = self.period_min() else {
            return Marks { each: vec![0.0; measured.samples.len()], known: false };
        };
        let teeth = Teeth { cutter: self.goal.tool.cutter, program: self.program, period_min };
        let stock_mm = self.goal.stock.layer_mm();
        Marks { each: teeth.marks(&measured.samples, &measured.cuts, stock_mm), known: true }
    }

    /// Adds samples where limits may be exceeded between those there are. What comes back of scallops is what nothing stands above
    /// with its mark, not what hides above others.
    ///
    /// What is left for a scallop is the less the higher its mark. Samples are taken by the height of their marks, and each lot is
    /// bounded against what its highest mark leaves: a few places with high marks do not spoil all others.
    fn refine(&self, look: &mut Look, marks: &Marks) -> Result<Refined, ProveError> {
        let even = look.measured.samples.len();
        let holds = self.failings(&look.tally, look.tally.scallop_max_mm).is_empty();
        let blend_mm = self.goal.control.blend_mm;
        let less = |limit: f64, by: f64| if by < limit { limit - by } else { limit };
        // Between samples of a path that fails already nothing is left to be found out.
        let max = self.goal.looks.max_samples;
        let most = if holds { max.saturating_sub(even).min(MOST_ADDED * even) } else { 0 };
        let lots = marks.lots();
        let Measured { samples, patches, cuts } = std::mem::take(&mut look.measured);
        let (mut all, mut more) = (Measured::default(), Measured::default());
        let mut refined = Refined { added: 0, left_out: 0, ..unbounded() };
        // Nothing in any lot stands above this with its mark, or lies below that.
        let (mut highest, mut deepest, mut dug) = (0.0f64, 0.0f64, 0.0f64);
        for (k, most_mark) in lots.iter().enumerate() {
            let low = if k == 0 { f64::NEG_INFINITY } else { lots[k - 1] };
            let of_lot = |m: &f64| *m > low && *m <= *most_mark;
            let mut lot = Measured::default();
            for k in (0..samples.len()).filter(|k| of_lot(&marks.each[*k])) {
                lot.samples.push(samples[k]);
                lot.patches.push(patches[k]);
                lot.cuts.push(cuts[k]);
            }
            let evenly = lot.samples.len();
            let wanted = Wanted {
                uncut_mm: self.limits.uncut_mm,
                enough_mm: less(self.limits.scallop_mm, most_mark + blend_mm),
                gouge_mm: less(self.limits.gouge_mm, blend_mm),
            };
            let room = most.saturating_sub(refined.added);
            let found = refine(&self.surfaces, &self.job(&[]), &mut lot, wanted, room)?;
            let t = self.tally(&lot.samples, &lot.cuts, &look.density)?;
            highest = highest.max(t.scallop_max_mm + found.hidden.scallop_mm + most_mark);
            deepest = deepest.max(t.gouge_max_mm + found.hidden.gouge_mm);
            dug = dug.max(t.gouge_max_mm);
            refined.added += found.added;
            refined.left_out += found.left_out;
            // Those that were added come after all others.
            more.samples.extend(lot.samples.drain(evenly..));
            more.patches.extend(lot.patches.drain(evenly..));
            more.cuts.extend(lot.cuts.drain(evenly..));
            all.samples.append(&mut lot.samples);
            all.patches.append(&mut lot.patches);
            all.cuts.append(&mut lot.cuts);
        }
        all.samples.append(&mut more.samples);
        all.patches.append(&mut more.patches);
        all.cuts.append(&mut more.cuts);
        look.measured = all;
        refined.hidden = Hidden { scallop_mm: highest, gouge_mm: (deepest - dug).max(0.0) };
        if refined.added > 0 {
            look.tally = self.tally(&look.measured.samples, &look.measured.cuts, &look.density)?;
        }
        Ok(refined)
    }

    /// Moves the tool through the declared raw material.
    fn carve(&self, progress: &(dyn Fn(f64) + Sync)) -> Result<Option<StockFound>, ProveError> {
        let GoalStock::Declared { blank, resolution, .. } = &self.goal.stock else { return Ok(None) };
        let made = Stock::fill(blank, resolution)?;
        let mut stock = made.stock;
        let before = stock.volume();
        let tool = &self.goal.tool;
        let mut uppers = Vec::new();
        let mut above_mm = tool.flutes.length_mm();
        for (body, kind) in [(tool.shank, Body::Shank), (tool.holder, Body::Holder)] {
            if let Some(body) = body {
                uppers.push(Upper { body, above_mm, kind });
                above_mm += body.length_mm();
            }
        }
        let (motions, touch_mm) = (self.program.motions, self.limits.collision_mm);
        let carved =
            stock.carve(&StockJob { cutter: tool.flutes, uppers: &uppers, motions, touch_mm }, progress)?;
        Ok(Some(StockFound {
            cell_mm: stock.cell_mm(),
            coarsened_mm: made.coarsened,
            rays: stock.rays(),
            bounds: *stock.bounds(),
            before,
            left: stock.volume(),
            carved,
        }))
    }

    /// What fails at the samples, in words.
    fn failings(&self, t: &Tally, height_mm: f64) -> Vec<String> {
        let (l, limits) = (&self.limits, &self.goal.limits);
        let mut why = Vec::new();
        let mut over = |what: &str, is: f64, limit: f64, unit: &str| {
            if is > limit {
                why.push(format!("{what} {is:.4} {unit} where {limit} {unit} are accepted"));
            }
        };
        over("a gouge of", t.gouge_max_mm, l.gouge_mm, "mm");
        over("the holder takes", t.holder_max_mm, l.collision_mm, "mm");
        over("a rapid move takes", t.rapid_max_mm, l.collision_mm, "mm");
        over("uncut area of", t.uncut_area_mm2, limits.unreached_mm2, "mm2");
        if height_mm > t.scallop_max_mm && height_mm > l.scallop_mm {
            over("a scallop with its tooth mark of", height_mm, l.scallop_mm, "mm");
        } else {
            over("a scallop of", t.scallop_max_mm, l.scallop_mm, "mm");
        }
        why
    }

    /// The answer, and why it is not held.
    fn answer(&self, f: &Figures, left_out: usize) -> (Answer, Vec<String>) {
        let mut bad = self.failings(&f.tally, f.height_max_mm);
        if f.coarse {
            bad.push("a coarse look tells; nothing was looked at closer".to_owned());
        }
        if let Some(first) = f.stock.as_ref().and_then(|s| s.carved.collisions.first()) {
            let count = f.stock.as_ref().map_or(0, |s| s.carved.collisions.len());
            let body = match first.body {
                Body::Cutter => "cutter",
                Body::Shank => "shank",
                Body::Holder => "holder",
            };
            let rapid = if first.rapid { " in rapid" } else { "" };
            let (block, deep) = (first.block, first.deepest_mm);
            bad.push(format!(
                "{count} collisions with raw material, the first in block {block}: the {body}{rapid} goes {deep:.3} mm deep"
            ));
        }
        let of = |g: Gravity| {
            self.goal.control.remarks.iter().filter(move |r| r.gravity == g).map(|r| r.text.clone())
        };
        bad.extend(of(Gravity::Breaks));
        if !bad.is_empty() {
            return (Answer::NotHeld, bad);
        }
        let mut open = Vec::new();
        let blend_mm = self.goal.control.blend_mm;
        let blended = if blend_mm > 0.0 {
            format!(" and corners blended by up to {blend_mm} mm")
        } else {
            String::new()
        };
        let (scallop, gouge) = (f.hidden.scallop_mm + blend_mm, f.hidden.gouge_mm + blend_mm);
        let limits = &self.limits;
        let at_samples = self.goal.limits.at_samples;
        if f.height_max_mm + scallop > limits.scallop_mm
            && !(at_samples && f.height_max_mm + blend_mm <= limits.scallop_mm)
        {
            open.push(format!(
                "between samples{blended} scallops may be {scallop:.5} mm higher than the {:.5} mm measured",
                f.height_max_mm
            ));
        }
        let gouge_max_mm = f.tally.gouge_max_mm;
        if gouge_max_mm + gouge > limits.gouge_mm
            && !(at_samples && gouge_max_mm + blend_mm <= limits.gouge_mm)
        {
            open.push(format!(
                "between samples{blended} gouges may be {gouge:.5} mm deeper than the {gouge_max_mm:.5} mm measured"
            ));
        }
        if !open.is_empty() && left_out > 0 {
            open.push(format!(
                "{left_out} or more places between samples were not looked at: smaller spacing_mm, larger max_samples"
            ));
        }
        for unseen in &self.goal.unseen {
            if let Unseen::NoSide(faces) = unseen {
                open.push(format!("nothing says on which side of {} the material is", listed(faces)));
            }
        }
        open.extend(of(Gravity::Open));
        let answer = if open.is_empty() { Answer::Held } else { Answer::NotShown };
        (answer, open)
    }

    /// The faces for which alone the verdict is, where some of the part are not looked at.
    fn only(&self) -> Option<String> {
        let names: Vec<String> = self.goal.machined.iter().map(|f| f.name.to_owned()).collect();
        let part = self.goal.machined.iter().any(|f| f.part_of_it.is_some());
        (part || !self.goal.unseen.is_empty()).then(|| listed(&names))
    }

    fn scope(&self, f: &Figures) -> Vec<ScopeRow> {
        let goal = self.goal;
        let mut rows = Vec::new();
        let mut row = |what: &'static str, covers: String| rows.push(ScopeRow { what, covers });
        let machined: Vec<String> = goal
            .machined
            .iter()
            .map(|f| f.part_of_it.as_ref().map_or_else(|| f.name.to_owned(), |p| format!("{} ({p})", f.name)))
            .collect();
        row("to machine", listed(&machined));
        let checked: Vec<String> = goal.checked.iter().map(|f| f.name.to_owned()).collect();
        let mut others =
            if checked.is_empty() { "none".to_owned() } else { format!("{} checked", listed(&checked)) };
        for unseen in &goal.unseen {
            match unseen {
                Unseen::MayBeHit(faces) => {
                    others += &format!("; NOT looked at, as they may be hit: {}", listed(faces))
                }
                Unseen::NoSide(faces) => {
                    others +=
                        &format!("; NOT looked at, as their material side is not known: {}", listed(faces));
                }
            }
        }
        row("other faces", others);
        if let Some(allowance) = goal.roughing_mm {
            row("roughing", format!("faces are judged {allowance} mm outside, by what stands above that"));
        }
        if goal.limits.unreached_mm2 > 0.0 {
            let text = format!(
                "{:.3} mm2, of which {} mm2 are accepted",
                f.tally.uncut_area_mm2, goal.limits.unreached_mm2
            );
            row("not reached", text);
        }
        row(
            "raw material",
            match (&goal.stock, f.coarse) {
                (GoalStock::Assumed { layer_mm }, _) => {
                    format!("none declared: {layer_mm:.3} mm on the faces to machine are assumed")
                }
                (GoalStock::Declared { words, .. }, false) => (*words).to_owned(),
                (GoalStock::Declared { words, .. }, true) => {
                    format!("{words}; NOT looked at, as the program is far off without it")
                }
            },
        );
        row(
            "fixtures",
            if goal.fixtures.is_empty() { "none declared".to_owned() } else { "as declared".to_owned() },
        );
        row(
            "tool",
            match goal.tool.holder {
                Some(_) => "cutter and holder, in feed and rapid".to_owned(),
                None => "cutter, in feed and rapid; no holder declared".to_owned(),
            },
        );
        row("tooth marks", self.teeth_words());
        let control = &goal.control;
        row(
            "control",
            if control.words.is_empty() {
                "NOT looked at: CL data have none".to_owned()
            } else {
                control.words.clone()
            },
        );
        row(
            "machine",
            "reach of its joints as posted; table, head and their bodies are NOT described".to_owned(),
        );
        rows
    }

    fn teeth_words(&self) -> String {
        let tool = &self.goal.tool;
        match (self.period_min(), tool.spindle_rpm) {
            (Some(_), Some(rpm)) => {
                let teeth = tool
                    .teeth
                    .map_or_else(|| "one tooth, as none are declared,".to_owned(), |z| format!("{z} teeth"));
                format!("added to scallops: {teeth} at {rpm} rpm")
            }
            _ if self.goal.roughing_mm.is_some() => "NOT judged on a roughing".to_owned(),
            (None, None) => "NOT judged: nothing says the spindle's speed".to_owned(),
            _ => "NOT judged: nothing says the feed".to_owned(),
        }
    }
}

/// Names for a sentence; of many the first.
fn listed(names: &[String]) -> String {
    const MOST: usize = 12;
    match names.len() {
        0 => "none".to_owned(),
        n if n > MOST => format!("{} and {} more", names[..MOST].join(", "), n - MOST),
        _ => names.join(", "),
    }
}
