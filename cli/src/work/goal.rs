//! What a job demands of a program: the goal that its verdict is made against. The same for every verb.

use crate::failure::Failure;
use crate::job::{Accept, Job};
use crate::part::{LoadedFace, Part};
use crate::work::rough;
use crate::work::stock::{self, RawMaterial};
use osculate_geom::{Offset, Surface};
use osculate_surfaces::TrimmedSurface;
use osculate_tools::Cutter;
use osculate_tools::removal::{Goal, GoalControl, GoalFace, GoalLimits, GoalStock, GoalTool, Looks, Sample};

/// Most samples where the job does not say.
const MAX_SAMPLES: usize = 1_000_000;

/// What a goal looks at: made once for a job with its tool in hand.
pub struct Aim<'a> {
    job: &'a Job,
    faces: &'a Part,
    cutter: Cutter,
    flutes: Cutter,
    shank: Option<Cutter>,
    holder: Option<Cutter>,
    /// Of a roughing, the faces to machine, outside by its allowance.
    offsets: Vec<Offset<TrimmedSurface>>,
    raw: Option<RawMaterial<'a>>,
    fixtures: Vec<Sample>,
}

impl<'a> Aim<'a> {
    /// Everything that the job's files say of it.
    pub fn of(job: &'a Job, faces: &'a Part) -> Result<Self, Failure> {
        let (flutes, shank) = job.flutes();
        let number = (faces.faces.len() + faces.check.len()) as u32;
        Ok(Self {
            job,
            faces,
            cutter: job.cutter(),
            flutes,
            shank,
            holder: job.holder(),
            offsets: rough::measured(job, faces)?,
            raw: RawMaterial::of(job, faces)?,
            fixtures: stock::fixtures(job, number)?,
        })
    }

    /// The goal, with the state of the control as a program has it.
    pub fn goal(&self, control: GoalControl, spindle_rpm: Option<f64>) -> Goal<'_> {
        let job = self.job;
        let tolerance = job.tolerance();
        let face = |k: usize, f: &'a LoadedFace| GoalFace {
            name: &f.id,
            surface: self.offsets.get(k).map_or(&*f.surface as &dyn Surface, |o| o),
            outlines: if f.surface.is_trimmed() {
                f.surface.loops().iter().map(|l| l.points.as_slice()).collect()
            } else {
                Vec::new()
            },
            part_of_it: f.part_of_it.clone(),
        };
        let machined: Vec<GoalFace<'_>> =
            self.faces.faces.iter().enumerate().map(|(k, f)| face(k, f)).collect();
        let checked = self.faces.check.iter().map(|f| face(usize::MAX, f)).collect();
        let layer_mm = job.layer_mm();
        Goal {
            machined,
            checked,
            unseen: self.faces.unseen.clone(),
            fixtures: self.fixtures.clone(),
            tool: GoalTool {
                cutter: &self.cutter,
                flutes: &self.flutes,
                shank: self.shank.as_ref(),
                holder: self.holder.as_ref(),
                teeth: job.tool().teeth(),
                spindle_rpm: spindle_rpm.or(job.spindle_rpm()),
            },
            stock: self.raw.as_ref().map_or(GoalStock::Assumed { layer_mm }, |raw| raw.goal(layer_mm)),
            limits: GoalLimits {
                scallop_mm: tolerance.scallop_mm,
                gouge_mm: tolerance.gouge_mm,
                unreached_mm2: job.unreached_mm2(),
                at_samples: job.verification().accept == Accept::Samples,
            },
            looks: Looks {
                spacing_mm: job.verification().spacing_mm,
                max_samples: job.verification().max_samples.unwrap_or(MAX_SAMPLES),
            },
            roughing_mm: job.strategy().layers().map(|l| l.allowance_mm),
            control,
        }
    }

    /// The name of a face by its number in a goal; places on fixtures have none of their own.
    pub fn face_name(&self, number: u32) -> String {
        let all = self.faces.faces.iter().chain(&self.faces.check);
        all.into_iter().nth(number as usize).map_or_else(|| "fixture".to_owned(), |f| f.id.clone())
    }
}
