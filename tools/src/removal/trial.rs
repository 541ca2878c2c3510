//! A goal with a program that is held against it: what is measured, and what is bounded between.

use super::boundary::sample_boundary;
use super::crest::crests;
use super::cut::{Cutting, cut};
use super::density::{Density, Hidden};
use super::edges::Edges;
use super::goal::{Goal, GoalFace, GoalFixture, GoalTool, Program};
use super::hidden::Wanted;
use super::job::{Change, Cut, Job, JobError, Sample};
use super::refine::{Measured, Refined, refine_beside};
use super::rim::OpenRim;
use super::sampling::{Patch, Sampling, SamplingError, sample_surface};
use super::stock::BlankError;
use super::tally::{Limits, Tally, TallyError, tally};
use super::tooth::{Edge, Marks, Teeth};
use super::tree::Ways;
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
/// Fewest samples that say anything.
pub const LEAST_SAMPLES: usize = 100;
/// Times that samples of a sliver are put four times as close before it counts as having none.
const FINER: usize = 4;

/// Why motions cannot be judged.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProveError {
    /// No face to machine.
    #[error("there is no face to judge")]
    NoFace,
    /// Nothing moves.
    #[error("the program has no motion: at least two positions are needed")]
    NoMotion,
    /// Tools that are not those of the program.
    #[error("{tools} tools for a program that changes them {changes} times")]
    Tools {
        /// Tools of the goal.
        tools: usize,
        /// Changes in the program.
        changes: usize,
    },
    /// Too few samples.
    #[error("max_samples = {got} is too few: {LEAST_SAMPLES} or more are needed")]
    Samples {
        /// What was given.
        got: usize,
    },
    /// Operations that are not those of the program.
    #[error("{steps} operations for a program that has {stops} in ascending order: one for each, or none")]
    Stops {
        /// Ends of operations in the program.
        stops: usize,
        /// Operations.
        steps: usize,
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

/// What is known between samples that were not bounded.
pub(super) fn unbounded() -> Refined {
    Refined { hidden: Hidden { scallop_mm: f64::INFINITY, gouge_mm: f64::INFINITY }, added: 0, left_out: 0 }
}

/// Samples with what was found at them.
pub(super) struct Look {
    pub measured: Measured,
    pub tally: Tally,
    pub density: Density,
    /// What could not be looked at.
    pub lost: Vec<String>,
    pub settled: Settled,
    /// Around those of the first so many samples that stand too high all was given up.
    pub given_up: usize,
}

/// What was shown between samples already: limits that are kept there are kept whatever becomes of other places.
#[derive(Default)]
pub(super) struct Settled {
    /// Whether nothing in the cell of each sample exceeds the limits; none where nothing was bounded.
    pub each: Vec<bool>,
    /// What nothing in these cells stands above with its mark, mm.
    height_mm: f64,
    /// What no gouge in these cells is deeper than, mm.
    depth_mm: f64,
}

impl Look {
    /// Whether nothing is left open between the samples.
    pub fn is_settled(&self) -> bool {
        self.settled.each.len() == self.measured.samples.len() && self.settled.each.iter().all(|is| *is)
    }
}

/// A goal with a program that is held against it.
pub(super) struct Trial<'a> {
    pub goal: &'a Goal<'a>,
    pub program: Program<'a>,
    /// Faces by number: to machine first, then those that are checked.
    pub faces: Vec<&'a GoalFace<'a>>,
    pub surfaces: Vec<&'a dyn Surface>,
    rims: Vec<OpenRim<'a>>,
    pub limits: Limits,
    /// Width of a strip that a ball of the smallest cutter's radius leaves on a plane, mm.
    pub strip_mm: f64,
    /// Where tools take over from the first, or go on after a stop.
    changes: &'a [Change<'a>],
}

/// What hears of samples and what was left at them when a stop is reached, with the place of the stop.
pub(super) type AtStop<'a> = &'a mut dyn FnMut(usize, &Sampled, &[Cut]) -> Result<(), ProveError>;

/// Samples on faces, an even distance apart.
pub(super) struct Sampled {
    pub samples: Vec<Sample>,
    pub patches: Vec<Option<Patch>>,
    pub density: Density,
    /// What could not be looked at.
    pub lost: Vec<String>,
}

/// Where tools take over from the first: at the changes of the program, and once more the same one at every stop at which something is
/// looked at.
pub(super) fn changes_of<'a>(goal: &Goal<'a>, program: &Program<'_>, stops: &[usize]) -> Vec<Change<'a>> {
    let mut firsts: Vec<usize> = program.changes.to_vec();
    let more =
        stops.iter().filter(|s| **s > 0 && **s < program.motions.len() && !program.changes.contains(s));
    firsts.extend(more);
    firsts.sort_unstable();
    firsts.dedup();
    let change = |first: usize| {
        // A tool that makes no motion is passed over.
        let tool = &goal.tools[program.tool_of(first).min(goal.tools.len() - 1)];
        Change { first, cutter: tool.cutter, holder: tool.holder }
    };
    firsts.into_iter().map(change).collect()
}

impl<'a> Trial<'a> {
    pub fn new(goal: &'a Goal<'a>, program: Program<'a>, changes: &'a [Change<'a>]) -> Self {
        let faces: Vec<&GoalFace<'_>> = goal.machined.iter().chain(&goal.checked).collect();
        let surfaces = faces.iter().map(|f| f.surface).collect();
        let rims = faces.iter().zip(0..).flat_map(|(f, k)| {
            f.open_rims.iter().filter_map(move |points| OpenRim::new(k, f.surface, points))
        });
        let rims = rims.collect();
        let limits = Limits::new(goal.limits.scallop_mm, goal.limits.gouge_mm);
        let smallest = goal.tools.iter().map(|t| t.cutter.radius_mm()).fold(f64::INFINITY, f64::min);
        let strip_mm = 2.0 * (2.0 * goal.limits.scallop_mm * smallest).sqrt();
        Self { goal, program, faces, surfaces, rims, limits, strip_mm, changes }
    }

    pub fn is_machined(&self, face: usize) -> bool {
        face < self.goal.machined.len()
    }

    /// How far so many samples of all faces are apart.
    pub fn spacing_of_mm(&self, samples: f64) -> f64 {
        let area = |k: usize| {
            let coarser = if self.is_machined(k) { 1.0 } else { CHECK_COARSER * CHECK_COARSER };
            osculate_geom::quadrature::area(self.surfaces[k], 1e-2).value / coarser
        };
        let whole: f64 = (0..self.surfaces.len()).map(area).filter(|a| a.is_finite()).sum();
        (whole / samples).sqrt()
    }

    /// How far samples are to be apart.
    pub fn spacing_mm(&self, notes: &mut Vec<String>) -> f64 {
        let wanted = self.goal.looks.spacing_mm.unwrap_or(self.strip_mm / SAMPLES_ACROSS);
        let max = self.goal.looks.max_samples;
        let spacing = wanted.max(self.spacing_of_mm(MOST_EVEN * max as f64));
        if spacing > 1.01 * wanted {
            notes.push(format!(
                "warning: verification: samples are {spacing:.4} mm apart instead of {wanted:.4} mm to stay within {max} of them"
            ));
        }
        spacing
    }

    /// Tool and motions with samples that are looked at.
    pub fn job(&self, samples: &'a [Sample]) -> Job<'a> {
        Job { samples, ..self.job_without() }
    }

    pub fn job_without(&self) -> Job<'a> {
        let tool = &self.goal.tools[0];
        Job {
            cutter: tool.cutter,
            holder: tool.holder,
            changes: self.changes,
            motions: self.program.motions,
            samples: &[],
            stock_mm: self.goal.stock.layer_mm(),
            depth_mm: self.goal.tools.iter().map(|t| t.cutter.radius_mm()).fold(0.0, f64::max),
        }
    }

    /// Samples an even distance apart.
    fn sampled(&self, spacing: f64) -> Result<Sampled, ProveError> {
        // Faces that bend a lot have more of them than their area says; those between them need room.
        let max = (MOST_EVEN * self.goal.looks.max_samples as f64) as usize;
        let (mut samples, mut patches, mut lost) = (Vec::new(), Vec::new(), Vec::new());
        let mut density: Option<Density> = None;
        for (k, face) in self.faces.iter().enumerate() {
            let check_only = !self.is_machined(k);
            let step = if check_only { CHECK_COARSER * spacing } else { spacing };
            let found = match finest(face.surface, k as u32, step, max) {
                Ok(found) => found,
                // A sliver that is not machined and has no place to look at is told, not refused.
                Err(SamplingError::Nothing { .. }) if check_only => {
                    lost.push(format!(
                        "warning: {}: has no place with a tangent plane and is not verified",
                        face.name
                    ));
                    continue;
                }
                Err(why) => return Err(ProveError::Sampling { face: face.name.to_owned(), why }),
            };
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
        Ok(Sampled { samples, patches, density: density.ok_or(ProveError::NoFace)?, lost })
    }

    /// Samples an even distance apart, and what is left at them; at stops, by the motions that come after each, on the way.
    pub fn look(
        &self,
        spacing: f64,
        stops: &[usize],
        (at_stop, progress): (AtStop<'_>, &(dyn Fn(f64) + Sync)),
    ) -> Result<Look, ProveError> {
        let sampled = self.sampled(spacing)?;
        let job = Job { samples: &sampled.samples, ..self.job_without() };
        let mut cuts = job.before_any();
        let ways = Ways::of_job(&job)?;
        let cutting = Cutting::new(&job, &ways)?;
        let mut done = 0;
        for (k, stop) in stops.iter().enumerate() {
            let tools = self.tools_before(*stop);
            let share = |x: f64| progress((done as f64 + x * (tools - done) as f64) / ways.tools() as f64);
            cutting.go(done..tools, &mut cuts, &share);
            at_stop(k, &sampled, &cuts)?;
            done = tools;
        }
        let share = |x: f64| progress((done as f64 + x * (ways.tools() - done) as f64) / ways.tools() as f64);
        cutting.go(done..ways.tools(), &mut cuts, &share);
        drop(cutting);
        self.seen(sampled, cuts)
    }

    /// How many of the tools, those that go on after stops counted, begin before a motion.
    fn tools_before(&self, motion: usize) -> usize {
        1 + self.changes.partition_point(|c| c.first < motion)
    }

    /// Samples with what was left at them, depths measured beside edges too, and what fixtures met.
    pub fn seen(&self, sampled: Sampled, mut cuts: Vec<Cut>) -> Result<Look, ProveError> {
        let Sampled { mut samples, mut patches, density, lost } = sampled;
        self.edges(&samples, density.spacing_mm).measure(&samples, &mut cuts, self.limits.gouge_mm);
        for fixture in &self.goal.fixtures {
            cuts.extend(self.met(fixture)?);
            samples.extend(&fixture.samples);
        }
        patches.resize(samples.len(), None);
        let (tally, settled) = (self.tally(&samples, &cuts, &density)?, Settled::default());
        Ok(Look { measured: Measured { samples, patches, cuts }, tally, density, lost, settled, given_up: 0 })
    }

    /// The faces with their outer edges, found by samples so far apart.
    fn edges<'s>(&'s self, samples: &'s [Sample], spacing: f64) -> Edges<'s> {
        Edges::new(&self.surfaces, &self.rims, samples, CHECK_COARSER * spacing)
    }

    /// What motions take from a fixture while it is there.
    fn met(&self, fixture: &GoalFixture) -> Result<Vec<Cut>, ProveError> {
        let all = self.program.motions;
        let end = fixture.motions.end.min(all.len());
        let begin = fixture.motions.start.min(end);
        let first = self.changes.partition_point(|c| c.first <= begin);
        let later = self.changes[first..].iter().take_while(|c| c.first < end);
        let changes: Vec<Change<'_>> = later.map(|c| Change { first: c.first - begin, ..*c }).collect();
        let tool = &self.goal.tools[self.program.tool_of(begin)];
        let work = Job {
            cutter: tool.cutter,
            holder: tool.holder,
            changes: &changes,
            motions: &all[begin..end],
            samples: &fixture.samples,
            ..self.job_without()
        };
        let shift = u32::try_from(begin).unwrap_or(u32::MAX);
        Ok(cut(&work, &|_| {})?.into_iter().map(|c| c.later(shift)).collect())
    }

    /// What a sample may stand above the face with its mark, so that corners which the control blends are not too high.
    pub fn highest_mm(&self) -> f64 {
        less(self.limits.scallop_mm, self.goal.control.blend_mm)
    }

    /// What is asked of bounds where marks are no higher than this.
    pub fn wanted(&self, most_mark: f64) -> Wanted {
        let blend_mm = self.goal.control.blend_mm;
        Wanted {
            uncut_mm: self.limits.uncut_mm,
            enough_mm: less(self.limits.scallop_mm, most_mark + blend_mm),
            gouge_mm: less(self.limits.gouge_mm, blend_mm),
        }
    }

    pub fn tally(&self, samples: &[Sample], cuts: &[Cut], density: &Density) -> Result<Tally, ProveError> {
        // The tool's effective radius across the feed, from the strip that it leaves.
        let effective = self.strip_mm * self.strip_mm / (8.0 * self.limits.scallop_mm);
        Ok(tally(samples, cuts, &self.limits, density, effective)?)
    }

    pub fn crests(&self, measured: &Measured) -> Result<f64, ProveError> {
        let job = Job { samples: &measured.samples, ..self.job_without() };
        Ok(crests(&self.surfaces, &job, &measured.cuts, self.strip_mm, self.limits.uncut_mm)?)
    }

    /// Time from tooth to tooth of a tool, min, where it is known.
    pub fn period_min(&self, tool: &GoalTool<'_>) -> Option<f64> {
        let per_min = tool.spindle_rpm? * f64::from(tool.teeth.unwrap_or(1));
        // The layers of a roughing stand higher than any mark, and are judged.
        let judged = !self.program.times_min.is_empty() && self.goal.roughing_mm.is_none();
        (judged && per_min > 0.0 && per_min.is_finite()).then(|| 1.0 / per_min)
    }

    /// The marks at samples; at so many of them at most, evenly chosen.
    pub fn marks(&self, Measured { samples, cuts, .. }: &Measured, most: usize) -> Result<Marks, ProveError> {
        let tools: Option<Vec<Edge<'_>>> = self
            .goal
            .tools
            .iter()
            .map(|t| Some(Edge { cutter: t.cutter, period_min: self.period_min(t)? }))
            .collect();
        let Some(tools) = tools else {
            return Ok(Marks { each: vec![0.0; samples.len()], known: false });
        };
        let teeth = Teeth { tools, program: self.program };
        let stride = samples.len().div_ceil(most).max(1);
        let job = self.job_without();
        let mut each = teeth.marks((samples, cuts), job.stock_mm, stride);
        teeth.lower((samples, cuts), &mut each, &job, self.limits.scallop_mm)?;
        Ok(Marks { each, known: true })
    }

    /// Whether what was measured keeps the limits, marks aside.
    pub fn holds(&self, look: &Look) -> bool {
        self.failings(&look.tally, look.tally.scallop_max_mm).is_empty()
    }

    /// Adds samples where limits may be exceeded between those there are. What comes back of scallops is what nothing stands above
    /// with its mark, not what hides above others.
    ///
    /// What is left for a scallop is the less the higher its mark. Samples are taken by the height of their marks, and each lot is
    /// bounded against what its highest mark leaves: a few places with high marks do not spoil all others. Cells that were settled before
    /// are not looked at again.
    pub fn refine(&self, look: &mut Look, marks: &mut Marks) -> Result<Refined, ProveError> {
        let even = look.measured.samples.len();
        let holds = self.holds(look) && self.can_be_shown(&look.tally);
        // Between samples of a path that fails already nothing is left to be found out.
        let max = self.goal.looks.max_samples;
        let most = if holds { max.saturating_sub(even).min(MOST_ADDED * even) } else { 0 };
        let lots = marks.lots();
        let Measured { samples, patches, cuts } = std::mem::take(&mut look.measured);
        let mut settled = std::mem::take(&mut look.settled);
        settled.each.resize(samples.len(), false);
        let edges = self.edges(&samples, look.density.spacing_mm);
        let (mut all, mut more) = (Measured::default(), Measured::default());
        let (mut marks_of_all, mut settled_more) = (Vec::with_capacity(samples.len()), Vec::new());
        let mut settled_all = Vec::with_capacity(samples.len());
        let mut keep = |k: usize, to: &mut Measured| {
            to.samples.push(samples[k]);
            to.patches.push(patches[k]);
            to.cuts.push(cuts[k]);
            marks_of_all.push(marks.each[k]);
        };
        for k in (0..samples.len()).filter(|k| settled.each[*k]) {
            keep(k, &mut all);
            settled_all.push(true);
        }
        let mut refined = Refined { added: 0, left_out: 0, ..unbounded() };
        // Nothing in any lot stands above this with its mark, or lies below that.
        let (mut highest, mut deepest) = (settled.height_mm, settled.depth_mm);
        for [low, most_mark] in lots {
            let of_lot = |m: &f64| *m > low && *m <= most_mark;
            let mut lot = Measured::default();
            for k in (0..samples.len()).filter(|k| !settled.each[*k] && of_lot(&marks.each[*k])) {
                keep(k, &mut lot);
            }
            let evenly = lot.samples.len();
            if evenly == 0 {
                continue;
            }
            let wanted = self.wanted(most_mark);
            let room = most.saturating_sub(refined.added);
            let (found, mut of_each) =
                refine_beside((&self.surfaces, Some(&edges)), &self.job(&[]), &mut lot, wanted, room)?;
            let t = self.tally(&lot.samples, &lot.cuts, &look.density)?;
            let height_mm = t.scallop_max_mm + found.hidden.scallop_mm;
            let depth_mm = t.gouge_max_mm + found.hidden.gouge_mm;
            highest = highest.max(height_mm + most_mark);
            deepest = deepest.max(depth_mm);
            settled.height_mm = settled.height_mm.max(height_mm.min(wanted.enough_mm) + most_mark);
            settled.depth_mm = settled.depth_mm.max(depth_mm.min(wanted.gouge_mm));
            refined.added += found.added;
            refined.left_out += found.left_out;
            // Those that were added come after all others.
            settled_more.extend(of_each.drain(evenly..));
            settled_all.append(&mut of_each);
            more.samples.extend(lot.samples.drain(evenly..));
            more.patches.extend(lot.patches.drain(evenly..));
            more.cuts.extend(lot.cuts.drain(evenly..));
            all.samples.append(&mut lot.samples);
            all.patches.append(&mut lot.patches);
            all.cuts.append(&mut lot.cuts);
        }
        marks_of_all.extend(self.marks(&more, usize::MAX)?.each);
        marks.each = marks_of_all;
        settled_all.append(&mut settled_more);
        all.samples.append(&mut more.samples);
        all.patches.append(&mut more.patches);
        all.cuts.append(&mut more.cuts);
        look.measured = all;
        look.settled = Settled { each: settled_all, ..settled };
        if refined.added > 0 {
            look.tally = self.tally(&look.measured.samples, &look.measured.cuts, &look.density)?;
        }
        refined.hidden =
            Hidden { scallop_mm: highest, gouge_mm: (deepest - look.tally.gouge_max_mm).max(0.0) };
        Ok(refined)
    }
}

/// A limit less what is added to what is measured; all of it where nothing would be left.
fn less(limit_mm: f64, by_mm: f64) -> f64 {
    if by_mm < limit_mm { limit_mm - by_mm } else { limit_mm }
}

/// Samples of a face; of one that is narrower than they are apart, closer ones.
fn finest(surface: &dyn Surface, face: u32, spacing_mm: f64, max: usize) -> Result<Sampling, SamplingError> {
    let mut spacing = spacing_mm;
    for _ in 0..FINER {
        match sample_surface(surface, face, spacing, max) {
            Err(SamplingError::Nothing { .. }) => spacing *= 0.25,
            found => return found,
        }
    }
    sample_surface(surface, face, spacing, max)
}
