//! The places in which an operation is done: that of its faces, which is planned, and those that it is repeated in by turns.

use crate::failure::Failure;
use crate::job::{Job, Operation, OperationWord, Repeat};
use crate::part::{self, LeftMaterial, Part, TurnedFaces};
use crate::work::operations::behind::{Behind, TooHigh};
use crate::work::passes;
use crate::work::program::Planned;
use crate::work::stock::RawMaterial;
use nalgebra::Isometry3;
use osculate_geom::{Diagnostic, Unit3};
use osculate_productivity::plan::{Places, Stretches, repeated};

/// An axis that leans off that of the turns by more than this, as a sine, is another one in every place.
const ALONG: f64 = 1e-9;

/// The places of an operation.
pub struct Passages {
    /// The part as it is seen in each place, the one that is planned first.
    each: Vec<Part>,
    /// What takes the first place to each of them.
    turns: Vec<Isometry3<f64>>,
    /// The part with the faces of all places to machine, where there is more than one.
    all: Option<Part>,
    circle: Option<Places>,
}

impl Passages {
    /// The places of an operation on a part.
    ///
    /// # Errors
    /// Where it names a face that is not there, and where the part is not the same in all places: with the face and the angle.
    pub fn of(operation: &Operation, job: &Job, whole: &Part) -> Result<Self, Failure> {
        let own = whole.seen_by(job).map_err(|why| why.in_operation(&operation.name))?;
        let Some(Repeat { axis, count }) = operation.repeat else {
            return Ok(Self { each: vec![own], turns: vec![Isometry3::identity()], all: None, circle: None });
        };
        let refuse = |why: String| operation.refuse("repeat", format!("repeat: {why}"));
        let ids: Vec<String> = own.faces.iter().map(|f| f.id.clone()).collect();
        let TurnedFaces { circle, images } = {
            let may_go_around = operation.kind == OperationWord::Rough;
            part::turned(&whole.part, &ids, (axis, count), may_go_around).map_err(refuse)?
        };
        let mut all = ids;
        let mut each = vec![own];
        for image in images {
            each.push(whole.with_faces(job, image.clone())?);
            all.extend(image);
        }
        // Faces that go all the way around are their own images.
        let mut seen = std::collections::BTreeSet::new();
        all.retain(|id| seen.insert(id.clone()));
        let all = whole.with_faces(job, all)?;
        let turns = (0..count).map(|k| circle.turn(k)).collect();
        let circle = Places { axis: circle.axis, count };
        Ok(Self { each, turns, all: Some(all), circle: Some(circle) })
    }

    /// The same in the raw material that is left.
    pub fn in_stock(mut self, left: Option<LeftMaterial>) -> Self {
        self.each.iter_mut().chain(&mut self.all).for_each(|part| part.left.clone_from(&left));
        self
    }

    /// The part with the faces to machine of the place that is planned.
    pub fn first(&self) -> &Part {
        &self.each[0]
    }

    /// The part with the faces to machine of all places.
    pub fn all(&self) -> &Part {
        self.all.as_ref().unwrap_or(&self.each[0])
    }

    /// The circle of the places, where there is more than one.
    pub const fn circle(&self) -> Option<Places> {
        self.circle
    }

    /// The part with the faces to machine of all places.
    pub fn into_all(mut self) -> Part {
        self.all.unwrap_or_else(|| self.each.swap_remove(0))
    }

    /// The axis that a job's tool keeps in all places, where it is one.
    pub fn kept_axis(&self, job: &Job) -> Option<Unit3> {
        let own = job.strategy().kept_axis()?;
        self.circle.is_none_or(|c| c.axis.direction.cross(&own).norm() < ALONG).then_some(own)
    }

    /// How high material stands in the place in which it stands highest, mm: what was left need not be the same in all of them.
    pub fn standing_mm(&self, behind: &Behind, job: &Job, raw: &RawMaterial<'_>) -> Result<f64, Failure> {
        let axis = job.strategy().kept_axis();
        let mut highest_mm: f64 = 0.0;
        for (part, turn) in self.each.iter().zip(&self.turns) {
            let axis = axis.map(|a| Unit3::new_normalize(turn * a.into_inner()));
            highest_mm = highest_mm.max(behind.standing_mm(axis, part, raw)?);
        }
        Ok(highest_mm)
    }

    /// Where material stands too high in any of the places, turned back to the one that is planned. The faces are alike but what was
    /// left on them need not be: a blank that is not round, or an operation that came to one place only.
    pub fn too_high(&self, behind: &Behind, job: &Job, overlap_mm: f64) -> Result<TooHigh, Failure> {
        let mut out = TooHigh { places: Vec::new(), area_mm2: 0.0 };
        for (part, turn) in self.each.iter().zip(&self.turns) {
            let found = behind.too_high(job, part, overlap_mm)?;
            let back = turn.inverse();
            out.places.extend(found.places.iter().map(|p| back * p));
            out.area_mm2 += found.area_mm2;
        }
        Ok(out)
    }

    /// The plan of the first place done in all of them: its passes turned, and joined in one go.
    ///
    /// # Errors
    /// Where the faces that links keep off cannot be taken in.
    pub fn repeat(&self, job: &Job, planned: Planned<'static>) -> Result<Planned<'static>, Failure> {
        let Some(all) = &self.all else { return Ok(planned) };
        let Planned { mut passes, skipped, mut extras, .. } = planned;
        let count = self.turns.len();
        let one = Stretches { passes: passes.passes, skipped };
        let stretches = repeated(&one, &self.turns);
        let linked = passes::linked(job, all, &stretches)?;
        passes.passes = stretches.passes;
        let skipped = stretches.skipped;
        for left in &mut extras.left_out {
            left.area_mm2 *= count as f64;
            left.face = format!("{} and its {} images", left.face, count - 1);
        }
        let ids: Vec<&str> = self.each[0].faces.iter().map(|f| f.id.as_str()).collect();
        let text = format!("planned on {} and repeated in {count} places", ids.join(", "));
        extras.diagnostics.push(Diagnostic::note("repeat", text));
        Ok(Planned { passes, skipped, linked, extras, ..planned })
    }
}
