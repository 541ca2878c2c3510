//! What operations have cut so far, as they are planned: how high material stands, and where too high.

use crate::failure::Failure;
use crate::job::Job;
use crate::part::{LeftMaterial, LoadedFace, Part, area};
use crate::work::stock::RawMaterial;
use crate::work::{budget, plunges};
use osculate_geom::{Point3, Unit3};
use osculate_productivity::plan::Linked;
use osculate_tools::Cutter;
use osculate_tools::removal::stock::Stock;
use osculate_tools::removal::{
    self, Change, Cut, Sample, Swept, cut, cut_on, sample_boundary, sample_surface,
};
use serde::Serialize;
use std::sync::Arc;

/// Places at which it is looked how high material stands on the faces of an operation, along the axis that its tool keeps.
const PLACES: f64 = 8000.0;
/// Places on all faces of the part at which it is known how high material stands, and on a face at least.
const GROUND: f64 = 16_000.0;
const OF_A_FACE: f64 = 250.0;
/// Most places on one face.
const MOST_OF_A_FACE: usize = 1_000_000;
/// Places at which rest is looked for, at most ...
const REST_PLACES: f64 = 400_000.0;
/// ... so far apart, of its overlap.
const REST_APART: f64 = 0.25;
/// Normals that lean off a tool's axis by more than this, as a cosine, are of walls, on which nothing stands that it comes through.
const SEEN: f64 = 0.05;
/// Area that may stand higher under a tool that leans.
const APART: f64 = 0.02;
/// Where less than this stands nothing is said to stand, mm: a layer of nothing has no place in a job.
const LEAST_MM: f64 = 0.05;

/// The motions of operations that are planned, and their tools.
#[derive(Default)]
pub struct Behind {
    motions: Vec<Swept>,
    /// With the first motion of each.
    tools: Vec<(usize, Cutter)>,
    /// What is left of the raw material, where some is declared.
    stock: Option<Stock>,
    ground: Ground,
}

/// How high material stands on the faces of the part, as the last operation has left it.
#[derive(Default)]
struct Ground {
    /// Ids of faces by their numbers in the samples.
    faces: Vec<String>,
    samples: Vec<Sample>,
    /// How far the raw material goes beyond each sample, mm.
    beyond_mm: Vec<f64>,
    cuts: Vec<Cut>,
}

impl Ground {
    fn of(part: &Part, raw: &RawMaterial<'_>) -> Result<Self, Failure> {
        let whole: f64 = part.faces.iter().map(area).sum();
        let even_mm = (whole / GROUND).sqrt();
        let mut samples = Vec::new();
        for (face, k) in part.faces.iter().zip(0u32..) {
            samples.extend(samples_of(face, k, even_mm.min((area(face) / OF_A_FACE).sqrt()))?);
        }
        let beyond_mm: Vec<f64> = samples.iter().map(|s| raw.beyond_mm(&s.point, &s.normal)).collect();
        let cuts = beyond_mm.iter().map(|b| Cut::untouched(b.max(LEAST_MM))).collect();
        Ok(Self { faces: part.faces.iter().map(|f| f.id.clone()).collect(), samples, beyond_mm, cuts })
    }

    /// Goes on with the motions of one tool.
    fn take(&mut self, cutter: &Cutter, motions: &[Swept]) -> Result<(), Failure> {
        let job = removal::Job {
            cutter,
            holder: None,
            changes: &[],
            motions,
            samples: &self.samples,
            stock_mm: self.cuts.iter().map(|c| c.standoff_mm).fold(LEAST_MM, f64::max),
            depth_mm: cutter.radius_mm(),
        };
        self.cuts = cut_on(&job, std::mem::take(&mut self.cuts), &|_| {}).map_err(Failure::job)?;
        Ok(())
    }
}

/// Places of faces where material stands too high.
#[non_exhaustive]
pub struct TooHigh {
    /// The places.
    pub places: Vec<Point3>,
    /// The area that they stand for, mm2.
    pub area_mm2: f64,
}

/// What stands on a face above it.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub struct Standing {
    /// The highest along its normals, mm.
    pub highest_mm: f64,
    /// The area on which more stands than the finished part may have, mm2.
    pub too_high_mm2: f64,
}

/// What an operation makes of what stands on a face.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct OnFace {
    /// The face.
    pub face: String,
    /// Before it.
    pub before: Standing,
    /// After it.
    pub after: Standing,
}

/// What stands before and after, by the faces to machine of a part.
pub fn on_faces(part: &Part, before: Vec<Standing>, after: Vec<Standing>) -> Vec<OnFace> {
    let both = part.faces.iter().zip(before.into_iter().zip(after));
    both.map(|(face, (before, after))| OnFace { face: face.id.clone(), before, after }).collect()
}

/// Places on a face, so far apart; none on a sliver, of which its neighbours tell what stands on it.
fn samples_of(face: &LoadedFace, number: u32, apart_mm: f64) -> Result<Vec<Sample>, Failure> {
    match sample_surface(&*face.surface, number, apart_mm, MOST_OF_A_FACE) {
        Ok(found) => {
            let mut out = found.samples;
            // What stands on an edge may be narrower than samples are apart.
            let outlines = face.surface.loops().iter().filter(|_| face.surface.is_trimmed());
            out.extend(outlines.flat_map(|l| sample_boundary(&*face.surface, &l.points, number, apart_mm)));
            Ok(out)
        }
        Err(removal::SamplingError::Nothing { .. }) => Ok(Vec::new()),
        Err(why) => Err(Failure::job(format!("{}: {why}", face.id))),
    }
}

/// Places on the faces to machine of a part, so far apart or `most` of them.
fn samples(part: &Part, apart_mm: f64, most: f64) -> Result<Vec<Sample>, Failure> {
    let whole: f64 = part.faces.iter().map(area).sum();
    let apart_mm = apart_mm.max((whole / most).sqrt());
    let each = part.faces.iter().zip(0u32..).map(|(face, k)| samples_of(face, k, apart_mm));
    Ok(each.collect::<Result<Vec<_>, _>>()?.concat())
}

impl Behind {
    /// Before the first operation on a part, all of whose faces to machine are looked at.
    pub fn new(part: &Part, raw: Option<&RawMaterial<'_>>) -> Result<Self, Failure> {
        let stock = raw.map(RawMaterial::filled).transpose()?;
        let ground = raw.map(|raw| Ground::of(part, raw)).transpose()?.unwrap_or_default();
        Ok(Self { stock, ground, ..Self::default() })
    }

    /// The surface of the raw material that is left, where some is declared.
    pub fn left(&self) -> Option<LeftMaterial> {
        let of = |s: &Stock| LeftMaterial {
            points: s.ends().into(),
            cell_mm: s.cell_mm(),
            stock: Arc::new(s.clone()),
        };
        self.stock.as_ref().map(of)
    }

    /// What is left of the raw material, where some is declared.
    pub const fn stock(&self) -> Option<&Stock> {
        self.stock.as_ref()
    }

    /// Goes on with an operation. Its rapid moves that would go through material are made at the feed of plunges; how many they are
    /// comes back. The part as a whole says what of it is no more than a touch.
    pub fn take(&mut self, job: &Job, touch_mm: f64, linked: &mut Linked) -> Result<usize, Failure> {
        let mut slowed = 0;
        if let Some(stock) = &mut self.stock {
            slowed = plunges::slow(stock, job, touch_mm, linked)?;
        }
        // What takes material is a motion that cuts, as far as heights are concerned: where it must not it is found elsewhere, and
        // where the order of motions does not matter there is far less to look at.
        let motions = Swept::along(&linked.path).into_iter().map(|m| Swept { rapid: false, ..m });
        self.tools.push((self.motions.len(), job.cutter()));
        self.motions.extend(motions);
        let (first, cutter) = &self.tools[self.tools.len() - 1];
        self.ground.take(cutter, &self.motions[*first..])?;
        Ok(slowed)
    }

    /// How high material stands at samples, mm; nowhere higher than `most_mm`. What stands high is taken from the stock, to its cells: only
    /// close to the faces the tools themselves are asked.
    fn heights_mm(&self, samples: &[Sample], most_mm: f64) -> Result<Vec<f64>, Failure> {
        let Some(((_, cutter), later)) = self.tools.split_first() else {
            return Ok(vec![most_mm; samples.len()]);
        };
        let change = |(first, cutter): &'_ (usize, Cutter)| (*first, *cutter);
        let owned: Vec<_> = later.iter().map(change).collect();
        let changes: Vec<Change<'_>> =
            owned.iter().map(|(first, cutter)| Change { first: *first, cutter, holder: None }).collect();
        let work = removal::Job {
            cutter,
            holder: None,
            changes: &changes,
            motions: &self.motions,
            samples,
            stock_mm: most_mm,
            depth_mm: cutter.radius_mm(),
        };
        let cuts = cut(&work, &|_| {}).map_err(Failure::job)?;
        Ok(cuts.into_iter().map(|c| c.standoff_mm).collect())
    }

    /// How high material stands on the faces to machine, mm: at most, where the tool comes along an axis that it keeps and as seen along it;
    /// else on all but a fiftieth of their area, along the normals.
    pub fn standing_mm(
        &self,
        axis: Option<Unit3>,
        part: &Part,
        raw: &RawMaterial<'_>,
    ) -> Result<f64, Failure> {
        let mut samples = samples(part, 0.0, PLACES)?;
        if let Some(axis) = axis {
            samples.retain(|s| s.normal.dot(&axis) > SEEN);
            samples.iter_mut().for_each(|s| s.normal = axis);
        }
        let beyond: Vec<f64> = samples.iter().map(|s| raw.beyond_mm(&s.point, &s.normal)).collect();
        let most = beyond.iter().copied().fold(LEAST_MM, f64::max);
        let heights = self.heights_mm(&samples, most)?;
        let mut all: Vec<(f64, f64)> =
            samples.iter().zip(heights).zip(&beyond).map(|((s, h), b)| (h.min(*b), s.area_mm2)).collect();
        all.sort_by(|a, b| b.0.total_cmp(&a.0));
        let share = if axis.is_some() { 0.0 } else { APART };
        let mut tail = share * all.iter().map(|a| a.1).sum::<f64>();
        let found = all.iter().find(|(_, area)| {
            tail -= area;
            tail <= 0.0
        });
        Ok(found.map_or(LEAST_MM, |f| f.0.max(LEAST_MM)))
    }

    /// What stands on each face to machine of a part, and where it is higher than a limit; nothing where no raw material is declared.
    pub fn stands(&self, part: &Part, limit_mm: f64) -> Vec<Standing> {
        let Ground { faces, samples, beyond_mm, cuts } = &self.ground;
        if samples.is_empty() {
            return Vec::new();
        }
        let mut of: Vec<Standing> = vec![Standing::default(); faces.len()];
        for ((s, cut), beyond) in samples.iter().zip(cuts).zip(beyond_mm) {
            let (on, height_mm) = (&mut of[s.face as usize], cut.standoff_mm.min(*beyond));
            on.highest_mm = on.highest_mm.max(height_mm);
            on.too_high_mm2 += if height_mm > limit_mm { s.area_mm2 } else { 0.0 };
        }
        let on = |f: &LoadedFace| faces.iter().position(|id| *id == f.id).map(|k| of[k]).unwrap_or_default();
        part.faces.iter().map(on).collect()
    }

    /// Where material stands higher than passes of a job are laid out for: teeth and corners add to that.
    pub fn too_high(&self, job: &Job, part: &Part, overlap_mm: f64) -> Result<TooHigh, Failure> {
        let samples = samples(part, REST_APART * overlap_mm, REST_PLACES)?;
        let limit_mm = budget::laid_out_mm(job, part);
        let heights = self.heights_mm(&samples, job.layer_mm().max(2.0 * limit_mm))?;
        let high = samples.iter().zip(&heights).filter(|(_, h)| **h > limit_mm);
        let (mut places, mut area_mm2) = (Vec::new(), 0.0);
        for (s, _) in high {
            places.push(s.point);
            area_mm2 += s.area_mm2;
        }
        Ok(TooHigh { places, area_mm2 })
    }
}
