//! Crests of what a path leaves: the ridges between passes.
//!
//! Material between two passes rises from one to a ridge and falls to the other, so that most of the area stands far below
//! the scallop: the median height over the area is a quarter of it for parabolic strips. How well passes use the tolerance
//! is told by the ridges alone. From places spread over the faces lines go out across the feed; where the cut passes from
//! one pass to another on them, the heights to both sides are carried on by parabolas until they meet. What a strip itself
//! has of ridges, and what ends at the border of a face, is no crest between passes.

use super::cut::cut;
use super::job::{Body, Cut, Job, JobError, Sample, Swept};
use osculate_geom::{Surface, Vec3, project_to_tangent, uv};
use rayon::prelude::*;

/// Places from which lines go out.
const LINES: usize = 240;
/// Rays on a line to each side, and how far it goes, of a usual strip: strips may be up to twice as wide as that.
const RAYS: usize = 20;
const REACH: f64 = 1.1;
/// Two motions belong to different passes where the path between them is longer than this share of a strip.
const APART: f64 = 0.75;
/// Halvings until parabolas meet: to a millionth of the step.
const HALVINGS: u32 = 20;

/// Median height of the ridges between passes over the machined samples' faces, mm; zero where none is found.
///
/// `surfaces` are the faces by number, `cuts` what the job left at its samples, `strip_mm` a usual width of strips. Ridges
/// that stand above `uncut_mm` are not counted: there a pass is missing.
///
/// # Errors
/// [`JobError`] as [`cut`].
pub fn crests(
    surfaces: &[&dyn Surface],
    job: &Job<'_>,
    cuts: &[Cut],
    strip_mm: f64,
    uncut_mm: f64,
) -> Result<f64, JobError> {
    if !(strip_mm > 0.0 && strip_mm.is_finite()) {
        return Ok(0.0);
    }
    let is_cut = |k: &usize| !job.samples[*k].check_only && by_cutter(&cuts[*k]).is_some();
    let all: Vec<usize> = (0..cuts.len()).filter(is_cut).collect();
    let stride = all.len().div_ceil(LINES).max(1);
    let lines: Vec<(Vec<Sample>, usize)> = all
        .par_iter()
        .skip(stride / 2)
        .step_by(stride)
        .filter_map(|k| {
            let (sample, motion) = (&job.samples[*k], by_cutter(&cuts[*k])?);
            let Swept { from, to, .. } = job.motions[motion];
            let across = sample.normal.cross(&(to.tip - from.tip));
            let surface = *surfaces.get(sample.face as usize)?;
            let step_mm = strip_mm * REACH / RAYS as f64;
            let mut line = walk(surface, sample, &-across, step_mm);
            line.reverse();
            let middle = line.len();
            line.push(*sample);
            line.extend(walk(surface, sample, &across, step_mm));
            Some((line, middle))
        })
        .collect();
    let samples: Vec<Sample> = lines.iter().flat_map(|(line, _)| line.iter().copied()).collect();
    let found = cut(&Job { samples: &samples, ..*job }, &|_| {})?;
    let stations = stations(job.motions, strip_mm);
    let apart = |a: usize, b: usize| (stations[a] - stations[b]).abs() > APART * strip_mm;
    let (mut heights, mut rest) = (Vec::new(), &found[..]);
    for (line, middle) in &lines {
        let (here, more) = rest.split_at(line.len());
        rest = more;
        let ridge = |k: usize| ridge(here, k, &apart).filter(|h| *h > 0.0 && *h <= uncut_mm);
        heights.extend((0..*middle).rev().find_map(ridge));
        heights.extend((*middle..line.len() - 1).find_map(ridge));
    }
    heights.sort_by(f64::total_cmp);
    Ok(heights.get(heights.len() / 2).copied().unwrap_or(0.0))
}

/// The motion that cut a place, where the cutter did at feed.
fn by_cutter(cut: &Cut) -> Option<usize> {
    cut.by.filter(|by| by.body == Body::Cutter && !by.rapid).map(|by| by.motion as usize)
}

/// Where on the path each motion ends, mm; rapids part passes however short they are.
fn stations(motions: &[Swept], strip_mm: f64) -> Vec<f64> {
    let mut s = 0.0;
    let step = |m: &Swept| {
        s += (m.to.tip - m.from.tip).norm() + if m.rapid { strip_mm } else { 0.0 };
        s
    };
    motions.iter().map(step).collect()
}

/// Samples on the face away from one, up to its border.
fn walk(surface: &dyn Surface, from: &Sample, way: &Vec3, step_mm: f64) -> Vec<Sample> {
    let (mut at, mut way) = (from.uv, *way);
    let mut out = Vec::with_capacity(RAYS);
    for _ in 0..RAYS {
        let jet = surface.jet2(at);
        let Ok(forms) = jet.forms() else { break };
        if way.norm() == 0.0 {
            break;
        }
        way = project_to_tangent(&forms.normal, &way).into_inner();
        let rate = forms.rate(&jet, &way);
        at = uv(at.u + rate.u * step_mm, at.v + rate.v * step_mm);
        if !surface.domain().contains(at) {
            break;
        }
        at = surface.domain().bring(at);
        let here = surface.jet2(at);
        let (true, Ok(normal)) = (surface.contains(at), here.normal()) else { break };
        out.push(Sample { point: here.point, normal, uv: at, ..*from });
    }
    out
}

/// The height at which two passes meet between rays `k` and `k + 1`; None where one pass cut both or nothing rises there.
fn ridge(line: &[Cut], k: usize, apart: &dyn Fn(usize, usize) -> bool) -> Option<f64> {
    let (a, b) = (by_cutter(&line[k])?, by_cutter(&line[k + 1])?);
    if !apart(a, b) {
        return None;
    }
    // Heights of a pass from a ray away from the ridge, as far as they are of that pass.
    let heights = |motion: usize, rays: [Option<usize>; 3]| -> Vec<f64> {
        let of_it = |k: &usize| line.get(*k).and_then(by_cutter).is_some_and(|m| !apart(m, motion));
        let own = rays.iter().map_while(|k| k.filter(of_it));
        own.map(|k| line[k].standoff_mm).collect()
    };
    let left = carried(&heights(a, [Some(k), k.checked_sub(1), k.checked_sub(2)]))?;
    let right = carried(&heights(b, [1, 2, 3].map(|d| Some(k + d))))?;
    let [mut low, mut high] = [0.0, 1.0];
    for _ in 0..HALVINGS {
        let t = 0.5 * (low + high);
        if left(t) < right(1.0 - t) { low = t } else { high = t }
    }
    Some(left(low).max(line[k].standoff_mm).max(line[k + 1].standoff_mm))
}

/// The parabola through heights one step apart, at steps beyond the first; None where they do not rise towards it.
fn carried(heights: &[f64]) -> Option<impl Fn(f64) -> f64 + use<>> {
    let (first, second) = (*heights.first()?, *heights.get(1)?);
    let slope = first - second;
    let bend = heights.get(2).map_or(0.0, |third| slope - (second - third));
    (slope > 0.0).then_some(move |t: f64| first + t * (slope + 0.5 * (t + 1.0) * bend))
}
