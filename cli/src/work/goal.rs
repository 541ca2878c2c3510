//! What a job demands of a program: the goal that its verdict is made against. The same for every verb.

use crate::failure::Failure;
use crate::job::{Accept, Job};
use crate::part::{LoadedFace, Part};
use crate::work::rough;
use crate::work::stock::{self, RawMaterial};
use osculate_geom::{Offset, Surface};
use osculate_surfaces::TrimmedSurface;
use osculate_tools::removal::{Goal, GoalControl, GoalFace, GoalFixture, GoalLimits, GoalStock, GoalTool};
use osculate_tools::{Cutter, Holder};

/// Most samples of a step on the way to a part.
const STEP_SAMPLES: usize = 400_000;

/// A tool as a goal has it.
struct Held {
    cutter: Cutter,
    flutes: Cutter,
    shank: Option<Cutter>,
    holder: Option<Holder>,
    teeth: Option<u32>,
    spindle_rpm: Option<f64>,
    feed_mm_min: f64,
}

impl Held {
    fn of(job: &Job) -> Self {
        let (flutes, shank) = job.flutes();
        Self {
            cutter: job.cutter(),
            flutes,
            shank,
            holder: job.holder().cloned(),
            teeth: job.tool().teeth(),
            spindle_rpm: job.spindle_rpm(),
            feed_mm_min: job.tool_feed_mm_min(),
        }
    }
}

/// What a goal looks at: made once for a job with its tools.
pub struct Aim<'a> {
    job: &'a Job,
    faces: &'a Part,
    tools: Vec<Held>,
    /// Of a roughing, the faces to machine, outside by its allowance.
    offsets: Vec<Offset<TrimmedSurface>>,
    raw: Option<RawMaterial<'a>>,
    /// What a step on the way to the part begins from, in words, where that is not what is declared.
    begun: Option<String>,
    fixtures: Vec<GoalFixture>,
    /// Whether this is a step on the way to the part.
    step: bool,
}

impl<'a> Aim<'a> {
    /// Everything that the job's files say of it.
    pub fn of(job: &'a Job, faces: &'a Part) -> Result<Self, Failure> {
        let held = stock::fixtures(job, faces)?;
        let fixtures = if held.is_empty() {
            Vec::new()
        } else {
            vec![GoalFixture { samples: held, motions: 0..usize::MAX }]
        };
        Self::of_tools(job, faces, std::slice::from_ref(job), fixtures)
    }

    /// As [`of`](Self::of), of a program whose tools are those in hand in these jobs, in the order in which it calls them.
    pub fn of_tools(
        job: &'a Job,
        faces: &'a Part,
        tools: &[Job],
        fixtures: Vec<GoalFixture>,
    ) -> Result<Self, Failure> {
        Ok(Self {
            job,
            faces,
            tools: tools.iter().map(Held::of).collect(),
            offsets: rough::measured(job, faces)?,
            raw: RawMaterial::of(job, faces)?,
            begun: None,
            fixtures,
            step: false,
        })
    }

    /// The same for a step on the way to the part, with what it begins from in words: it is not looked at between the samples, as the
    /// part is.
    #[must_use]
    pub fn of_step(self, begun: Option<String>) -> Self {
        Self { step: true, begun, ..self }
    }

    /// The goal, with the state of the control as a program has it, and the speed of each tool where it says one.
    pub fn goal(&self, control: GoalControl, speeds_rpm: &[Option<f64>]) -> Goal<'_> {
        let job = self.job;
        let most = if self.step { STEP_SAMPLES } else { usize::MAX };
        let face = |k: usize, f: &'a LoadedFace| {
            let surface = self.offsets.get(k).map_or(&*f.surface as &dyn Surface, |o| o);
            let mut face = GoalFace::new(&f.id, surface);
            if f.surface.is_trimmed() {
                face.outlines = f.surface.loops().iter().map(|l| l.points.as_slice()).collect();
            }
            face.part_of_it.clone_from(&f.part_of_it);
            face.open_rims = self.faces.open_rims(&f.id);
            face
        };
        let machined: Vec<GoalFace<'_>> =
            self.faces.faces.iter().enumerate().map(|(k, f)| face(k, f)).collect();
        let checked = self.faces.check.iter().map(|f| face(usize::MAX, f)).collect();
        // What operations before have left tells what moves take, wherever it stands.
        let known = self.faces.left.is_some();
        let layer_mm = if known { job.thin_layer_mm() } else { job.layer_mm() };
        let stock = match self.raw.as_ref().map(|raw| raw.goal(layer_mm)) {
            None => GoalStock::Assumed { layer_mm },
            Some(GoalStock::Declared { blank, resolution, layer_mm, words }) => GoalStock::Declared {
                blank,
                resolution,
                layer_mm,
                words: self.begun.as_deref().unwrap_or(words),
            },
            Some(assumed) => assumed,
        };
        let speed = |k: usize| speeds_rpm.get(k).copied().flatten();
        let tools = self.tools.iter().enumerate().map(|(k, t)| {
            let mut tool = GoalTool::new(&t.cutter);
            tool.flutes = &t.flutes;
            tool.shank = t.shank.as_ref();
            tool.holder = t.holder.as_ref();
            tool.teeth = t.teeth;
            tool.spindle_rpm = speed(k).or(t.spindle_rpm);
            tool.feed_mm_min = Some(t.feed_mm_min);
            tool
        });
        let mut goal = Goal::new(machined, tools.collect(), stock, self.limits());
        goal.checked = checked;
        goal.unseen.clone_from(&self.faces.unseen);
        goal.fixtures.clone_from(&self.fixtures);
        goal.looks.spacing_mm = job.verification().spacing_mm;
        goal.looks.max_samples = job.verification().max_samples.unwrap_or(goal.looks.max_samples).min(most);
        goal.looks.between = !self.step;
        goal.roughing_mm = job.strategy().layers().map(|l| l.allowance_mm);
        goal.control = control;
        goal
    }

    /// What must hold.
    pub fn limits(&self) -> GoalLimits {
        let (job, tolerance) = (self.job, self.job.tolerance());
        let mut limits = GoalLimits::new(tolerance.scallop_mm, tolerance.gouge_mm);
        limits.unreached_mm2 = job.unreached_mm2();
        limits.at_samples = self.step || job.verification().accept == Accept::Samples;
        limits
    }

    /// The faces that it is about.
    #[must_use]
    pub const fn faces(&self) -> &'a Part {
        self.faces
    }

    /// The job that it is for.
    #[must_use]
    pub const fn job(&self) -> &'a Job {
        self.job
    }

    /// The name of a face by its number in a goal; places on fixtures have none of their own.
    pub fn face_name(&self, number: u32) -> String {
        let all = self.faces.faces.iter().chain(&self.faces.check);
        all.into_iter().nth(number as usize).map_or_else(|| "fixture".to_owned(), |f| f.id.clone())
    }
}
