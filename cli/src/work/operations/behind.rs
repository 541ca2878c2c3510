//! What operations have cut so far, as they are planned: how high material stands, and where too high.

use crate::failure::Failure;
use crate::job::Job;
use crate::part::{Part, area};
use crate::work::stock::RawMaterial;
use osculate_geom::{Point3, Unit3};
use osculate_productivity::plan::Linked;
use osculate_tools::Cutter;
use osculate_tools::cl::Motion;
use osculate_tools::removal::stock::{Stock, StockJob, Upper};
use osculate_tools::removal::{
    self, Body, Change, Limits, Sample, Swept, cut, sample_boundary, sample_surface,
};
use serde::Serialize;

/// Places at which it is looked how high material stands on the faces of an operation.
const PLACES: f64 = 8000.0;
/// Places at which rest is looked for, at most ...
const REST_PLACES: f64 = 400_000.0;
/// ... so far apart, of its overlap.
const REST_APART: f64 = 0.5;
/// What stands higher than this share of the scallop is too high: the rest is for the marks of teeth, which are not known here.
const HIGH: f64 = 0.85;
/// Feed of moves down into material, of that of passes.
const PLUNGE: f64 = 0.5;
/// Normals that lean off a tool's axis by more than this, as a cosine, are of walls, on which nothing stands that it comes through.
const SEEN: f64 = 0.05;
/// Area that may stand higher under a tool that leans.
const APART: f64 = 0.02;
/// Up to so many cells of the stock heights are asked of the tools themselves.
const NEAR_CELLS: f64 = 4.0;
/// Where less than this stands nothing is said to stand, mm: a layer of nothing has no place in a job.
const LEAST_MM: f64 = 0.05;

/// The motions of operations that are planned, and their tools.
#[derive(Default)]
pub struct Behind {
    motions: Vec<Swept>,
    /// With the first motion of each.
    tools: Vec<(usize, Cutter, Option<Cutter>)>,
    /// What is left of the raw material, where some is declared.
    stock: Option<Stock>,
}

/// Places of faces where material stands too high.
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

/// Places on the faces to machine of a part, so far apart or `most` of them.
fn samples(part: &Part, apart_mm: f64, most: f64) -> Result<Vec<Sample>, Failure> {
    let whole: f64 = part.faces.iter().map(area).sum();
    let spacing = apart_mm.max((whole / most).sqrt());
    let mut out = Vec::new();
    for (face, k) in part.faces.iter().zip(0u32..) {
        match sample_surface(&*face.surface, k, spacing, 2 * most as usize) {
            Ok(found) => {
                out.extend(found.samples);
                // What stands on an edge may be narrower than samples are apart.
                let outlines = face.surface.loops().iter().filter(|_| face.surface.is_trimmed());
                out.extend(outlines.flat_map(|l| sample_boundary(&*face.surface, &l.points, k, spacing)));
            }
            // A sliver without a place says nothing of what stands on it; its neighbours do.
            Err(removal::SamplingError::Nothing { .. }) => {}
            Err(why) => return Err(Failure::job(format!("{}: {why}", face.id))),
        }
    }
    Ok(out)
}

impl Behind {
    /// Before the first operation.
    pub fn new(raw: Option<&RawMaterial<'_>>) -> Result<Self, Failure> {
        let stock = raw.map(RawMaterial::filled).transpose()?;
        Ok(Self { stock, ..Self::default() })
    }

    /// What is left of the raw material, where some is declared.
    pub const fn stock(&self) -> Option<&Stock> {
        self.stock.as_ref()
    }

    /// Goes on with an operation. Its rapid moves that would go through material are made at the feed of plunges; how many they are
    /// comes back.
    pub fn take(&mut self, job: &Job, linked: &mut Linked) -> Result<usize, Failure> {
        let mut slowed = 0;
        if let Some(stock) = &mut self.stock {
            let (flutes, shank) = job.flutes();
            let holder = job.holder();
            let mut uppers = Vec::new();
            let mut above_mm = flutes.length_mm();
            for (body, kind) in [(&shank, Body::Shank), (&holder, Body::Holder)] {
                if let Some(body) = body {
                    uppers.push(Upper { body, above_mm, kind });
                    above_mm += body.length_mm();
                }
            }
            let t = job.tolerance();
            let touch_mm = Limits::new(t.scallop_mm, t.gouge_mm).collision_mm;
            let motions = Swept::along(&linked.path);
            let work = StockJob { cutter: &flutes, uppers: &uppers, motions: &motions, touch_mm };
            let carved = stock.carve(&work, &|_| {}).map_err(Failure::job)?;
            let plunge = Motion::Feed(PLUNGE * job.feed_mm_min());
            for c in carved.collisions.iter().filter(|c| c.rapid && c.body == Body::Cutter) {
                // A motion ends at the point after that with which it begins.
                linked.path.moves[c.motion as usize + 1].motion = plunge;
                slowed += 1;
            }
        }
        self.tools.push((self.motions.len(), job.cutter(), job.holder()));
        self.motions.extend(Swept::along(&linked.path));
        Ok(slowed)
    }

    /// How high material stands at samples, mm; nowhere higher than `most_mm`. What stands high is taken from the stock, to its cells: only
    /// close to the faces the tools themselves are asked.
    fn heights_mm(&self, samples: &[Sample], most_mm: f64) -> Result<Vec<f64>, Failure> {
        let Some(stock) = &self.stock else { return self.exact_mm(samples, most_mm) };
        let cell = stock.cell_mm();
        let near_mm = NEAR_CELLS * cell;
        if most_mm <= near_mm || self.tools.is_empty() {
            return self.exact_mm(samples, most_mm);
        }
        let stands = |s: &Sample| {
            let n = s.normal.into_inner();
            let steps = ((most_mm - cell) / (0.5 * cell)).ceil() as usize;
            let at = |k: usize| (cell + 0.5 * cell * k as f64).min(most_mm);
            (0..=steps).map(at).find(|h| !stock.is_material(&(s.point + n * *h))).unwrap_or(most_mm)
        };
        let mut out: Vec<f64> = samples.iter().map(stands).collect();
        let low: Vec<usize> = (0..out.len()).filter(|k| out[*k] < 0.75 * near_mm).collect();
        let close: Vec<Sample> = low.iter().map(|k| samples[*k]).collect();
        for (k, height) in low.into_iter().zip(self.exact_mm(&close, near_mm)?) {
            out[k] = height;
        }
        Ok(out)
    }

    /// How high material stands at samples by the tools that went there, mm; nowhere higher than `most_mm`.
    fn exact_mm(&self, samples: &[Sample], most_mm: f64) -> Result<Vec<f64>, Failure> {
        let Some(((_, cutter, holder), later)) = self.tools.split_first() else {
            return Ok(vec![most_mm; samples.len()]);
        };
        let change =
            |(first, cutter, holder): &'_ (usize, Cutter, Option<Cutter>)| (*first, *cutter, *holder);
        let owned: Vec<_> = later.iter().map(change).collect();
        let changes: Vec<Change<'_>> = owned
            .iter()
            .map(|(first, cutter, holder)| Change { first: *first, cutter, holder: holder.as_ref() })
            .collect();
        let work = removal::Job {
            cutter,
            holder: holder.as_ref(),
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

    /// What stands on each face to machine of a part, and where it is higher than a limit: at some thousand places.
    pub fn stands(
        &self,
        part: &Part,
        raw: &RawMaterial<'_>,
        limit_mm: f64,
    ) -> Result<Vec<Standing>, Failure> {
        let samples = samples(part, 0.0, PLACES)?;
        let beyond: Vec<f64> = samples.iter().map(|s| raw.beyond_mm(&s.point, &s.normal)).collect();
        let heights = self.heights_mm(&samples, beyond.iter().copied().fold(LEAST_MM, f64::max))?;
        let mut out = vec![Standing::default(); part.faces.len()];
        for ((s, height), beyond) in samples.iter().zip(heights).zip(beyond) {
            let (on, height_mm) = (&mut out[s.face as usize], height.min(beyond));
            on.highest_mm = on.highest_mm.max(height_mm);
            on.too_high_mm2 += if height_mm > limit_mm { s.area_mm2 } else { 0.0 };
        }
        Ok(out)
    }

    /// Where material stands above the scallop of a job.
    pub fn too_high(&self, job: &Job, part: &Part, overlap_mm: f64) -> Result<TooHigh, Failure> {
        let samples = samples(part, REST_APART * overlap_mm, REST_PLACES)?;
        let limit = HIGH * job.tolerance().scallop_mm;
        let heights = self.heights_mm(&samples, job.layer_mm().max(2.0 * limit))?;
        let high = samples.iter().zip(&heights).filter(|(_, h)| **h > limit);
        let (mut places, mut area_mm2) = (Vec::new(), 0.0);
        for (s, _) in high {
            places.push(s.point);
            area_mm2 += s.area_mm2;
        }
        Ok(TooHigh { places, area_mm2 })
    }
}
