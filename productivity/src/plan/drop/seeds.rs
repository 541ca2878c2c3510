//! Seeds of drops: places all over the faces and along their rims, from which it is found where a tool rests.

use super::frame::Frame;
use super::height::{Seed, way};
use super::silhouettes::{Spacing, long_mm, silhouettes};
use super::task::DropTask;
use crate::plan::PlanError;
use osculate_geom::{Axis, Surface, Uv, Vec3, quadrature};
use osculate_tools::removal::{self, sample_surface};
use rayon::prelude::*;

/// Seeds of drops stand this part of the tool's radius apart.
const SEEDS: f64 = 0.1;
/// A face may have this many seeds or places, however small it is.
const FEWEST: usize = 200;
/// Most seeds over all faces.
const MOST_SEEDS: f64 = 1e6;
/// Chords between seeds on a rim may be off one of the tool's radius by this part of the chord tolerance.
const RIM_SAGITTA: f64 = 0.1;
/// Seeds along silhouettes are no closer than this many chord tolerances.
const NARROWEST: f64 = 4.0;
/// Lines along each parameter on whose ends the rim of a face is seeded: fewest and most.
const RIM_LINES: [f64; 2] = [20.0, 2000.0];
/// Halvings of the way from one of these lines to the next where the rim bends.
const RIM_HALVINGS: u32 = 8;

/// Samples of one face `spacing_mm` apart: of a count over all faces its share by area.
pub(super) fn sampled(
    (task, surfaces, areas): (&DropTask<'_>, &[&dyn Surface], &[f64]),
    k: usize,
    spacing_mm: f64,
    [most, over]: [f64; 2],
) -> Result<removal::Sampling, PlanError> {
    let name = task.faces.iter().chain(task.check).nth(k).map_or("", |n| n.face);
    let share = ((most * areas[k] / over) as usize).max(FEWEST);
    // Face numbers are positions in the list, far below the limit of u32.
    sample_surface(surfaces[k], k as u32, spacing_mm, share)
        .map_err(|e| PlanError::Nothing { face: name.to_owned(), why: e.to_string() })
}

/// Areas that only share out counts: coarse values will do.
pub(super) fn areas(surfaces: &[&dyn Surface]) -> Vec<f64> {
    surfaces.par_iter().map(|s| quadrature::area(*s, 1e-2).value).collect()
}

/// Seeds of drops, their distance, mm, and the least and greatest of their positions.
pub(super) type Seeds = (Vec<Seed>, f64, [[f64; 2]; 2]);

/// Seeds on all faces and their rims.
pub(super) fn seeds(
    task: &DropTask<'_>,
    (surfaces, areas): (&[&dyn Surface], &[f64]),
    frame: &Frame,
) -> Result<Seeds, PlanError> {
    let radius = task.cutter.radius_mm();
    let all: f64 = areas.iter().sum();
    let (mut seeds, mut spacing): (Vec<Seed>, f64) = (Vec::new(), 0.0);
    // Between seeds on an edge the tool sinks by the sagitta of its radius; in a bore hardly wider than it is it is kept off by that.
    let along_rim = (SEEDS * radius).min((8.0 * radius * RIM_SAGITTA * task.tolerance.chord_mm).sqrt());
    for (k, surface) in surfaces.iter().enumerate() {
        let sampling = sampled((task, surfaces, areas), k, SEEDS * radius, [MOST_SEEDS, all])?;
        spacing = spacing.max(sampling.density.spacing_mm);
        seeds.extend(sampling.samples.iter().map(|s| Seed {
            at: frame.of(&s.point),
            uv: s.uv,
            face: s.face,
            along: [0.0; 3],
        }));
        let apart = Apart { along_mm: along_rim, off_mm: RIM_SAGITTA * task.tolerance.chord_mm };
        let spacing = Spacing {
            over_mm: sampling.density.spacing_mm,
            along_mm: along_rim,
            off_mm: apart.off_mm,
            least_mm: NARROWEST * task.tolerance.chord_mm,
        };
        seeds.extend(silhouettes((*surface, k as u32), frame, spacing));
        rim(*surface, k as u32, (frame, apart), &mut seeds);
    }
    let by =
        |f: fn(f64, f64) -> f64, start: f64| [0, 1].map(|k| seeds.iter().map(|s| s.at[k]).fold(start, f));
    let extent = [by(f64::min, f64::INFINITY), by(f64::max, f64::NEG_INFINITY)];
    Ok((seeds, spacing, extent))
}

/// How far seeds on a rim may be apart, and how far the rim may stray from the chords between them.
#[derive(Clone, Copy)]
struct Apart {
    along_mm: f64,
    off_mm: f64,
}

/// The ends of stretches of inside on a line across a face, at a share of its other parameter.
struct Ends {
    share: f64,
    seeds: Vec<Seed>,
}

impl Ends {
    /// Whether the ends here and there are of the same rims, as far as is seen.
    fn goes_on(&self, next: &Self) -> bool {
        self.seeds.len() == next.seeds.len()
    }

    /// Whether the rims stray between two lines from the chords, by the ends on a line in between. Those that lie far apart belong to
    /// different rims.
    fn strays(&self, [from, to]: [&Self; 2], apart: Apart) -> bool {
        let ends = self.seeds.iter().zip(from.seeds.iter().zip(&to.seeds));
        self.goes_on(from)
            && self.goes_on(to)
            && ends.into_iter().any(|(m, (a, b))| {
                let chord = Seed { along: way(a, b), ..*a };
                let near = Vec3::from(chord.nearest_of(m.at));
                (Vec3::from(m.at) - near).norm() > apart.off_mm && is_one(a, b, apart)
            })
    }
}

fn is_one(a: &Seed, b: &Seed, apart: Apart) -> bool {
    Vec3::from(way(a, b)).norm() <= 4.0 * apart.along_mm
}

/// Seeds on the rim of a face, at the ends of its stretches of inside on lines across it, as many as the rim asks for by its length and by
/// its bends.
fn rim(surface: &dyn Surface, face: u32, (frame, apart): (&Frame, Apart), seeds: &mut Vec<Seed>) {
    let domain = surface.domain();
    let see = |at: Uv| Seed { at: frame.of(&surface.point(at)), uv: at, face, along: [0.0; 3] };
    for axis in [Axis::U, Axis::V] {
        let i = domain.get(axis.other());
        let across = long_mm(surface, axis.other());
        let lines = (across / apart.along_mm).ceil().clamp(RIM_LINES[0], RIM_LINES[1]) as usize;
        let on = |share: f64| {
            let fixed = i.at(share);
            let ends = |s: &osculate_geom::Interval| [s.lo, s.hi];
            let spans = surface.spans(axis, fixed);
            let seeds = spans.iter().flat_map(ends).map(|t| see(Uv::from_axis(axis, t, fixed))).collect();
            Ends { share, seeds }
        };
        let even: Vec<Ends> = (0..=lines).into_par_iter().map(|k| on(k as f64 / lines as f64)).collect();
        // Around a narrow bend of a rim its chords cut the corner: there lines are closer.
        let between: Vec<Vec<Ends>> =
            even.par_windows(2).map(|w| closer(&on, [&w[0], &w[1]], (apart, RIM_HALVINGS))).collect();
        let mut found: Vec<Ends> = Vec::with_capacity(even.len());
        let mut between = between.into_iter();
        for line in even {
            found.push(line);
            found.extend(between.next().into_iter().flatten());
        }
        // Where neighbouring lines have as many ends, those are joined: a rim is seeded without gaps.
        for k in 0..found.len() - 1 {
            let (before, after) = found.split_at_mut(k + 1);
            let (here, next) = (&mut before[k], &after[0]);
            if here.goes_on(next) {
                for (a, b) in here.seeds.iter_mut().zip(&next.seeds) {
                    // Ends that lie further apart belong to different rims.
                    if is_one(a, b, apart) {
                        a.along = way(a, b);
                    }
                }
            }
        }
        seeds.extend(found.into_iter().flat_map(|line| line.seeds));
    }
    seeds.extend(surface.turns().into_iter().map(see));
}

/// Lines between two, as long as the rims stray from the chords between them.
fn closer(
    on: &(impl Fn(f64) -> Ends + Sync),
    [from, to]: [&Ends; 2],
    (apart, halvings): (Apart, u32),
) -> Vec<Ends> {
    if halvings == 0 || !from.goes_on(to) {
        return Vec::new();
    }
    let middle = on(0.5 * (from.share + to.share));
    if !middle.strays([from, to], apart) {
        return Vec::new();
    }
    let mut out = closer(on, [from, &middle], (apart, halvings - 1));
    let after = closer(on, [&middle, to], (apart, halvings - 1));
    out.push(middle);
    out.extend(after);
    out
}
