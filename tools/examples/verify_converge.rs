//! Halving the spacing of samples: what is seen, and the bound on what there is, on three analytic and two real faces.
//!
//! `cargo run --release -p osculate-tools --example verify_converge`; exits 1 where the bound does not hold. A ball passes over
//! every face along v, or u, its axis along the normal. Truth is the closed form or, where there is none, the highest place
//! found by a search from the highest samples of the finest sampling. Samples miss a cusp by up to half their spacing: what is
//! seen closes in with order one, by chance more or less. The bound is to close in with order two, a factor of four.

#![allow(clippy::print_stdout, reason = "a study prints its tables")]

use osculate_geom::analytic::{Cylinder, Paraboloid, Torus};
use osculate_geom::{Interval, Surface, Uv, uv};
use osculate_surfaces::{read, sections};
use osculate_tools::removal::{Job, Patch, Sample, Sampling, Swept, Wanted, cut, hidden, sample_surface};
use osculate_tools::{Cutter, CutterSpec, Pose};
use std::error::Error;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

/// A face and how it is passed over.
struct Case {
    name: &'static str,
    surface: Arc<dyn Surface>,
    radius_mm: f64,
    /// Passes from side to side, and steps along each.
    passes: u32,
    steps: u32,
    along_u: bool,
    spacing_mm: f64,
    truth_mm: Option<f64>,
}

fn cases() -> Result<Vec<Case>, Box<dyn Error>> {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples");
    let propeller = read(&std::fs::read(examples.join("propeller/propeller.step"))?)?;
    let propeller = propeller.face("F7").ok_or("the propeller has a face F7")?.surface.clone();
    let blade = std::fs::read(examples.join("centrifugal-blade/blade.csv"))?;
    let blade = sections::read_in(&blade, Some(1000.0))?;
    let blade = blade.face("F1").ok_or("the blade has a face F1")?.surface.clone();
    // A ball on a cylinder along generators a radians apart: where the circles of two passes meet.
    let (part, tool, passes) = (25.0, 4.0, 157);
    let half = std::f64::consts::PI / f64::from(passes);
    let (middle, aside) = ((part + tool) * half.cos(), (part + tool) * half.sin());
    let truth_mm = middle - (tool * tool - aside * aside).sqrt() - part;
    let torus = Torus::new(12.0, 4.0)?;
    let saddle = Paraboloid::new([-0.05, 0.08], 5.0)?;
    let case = |name, surface: Arc<dyn Surface>, passes, spacing_mm| Case {
        name,
        surface,
        radius_mm: 3.0,
        passes,
        steps: 200,
        along_u: true,
        spacing_mm,
        truth_mm: None,
    };
    Ok(vec![
        Case {
            radius_mm: tool,
            along_u: false,
            steps: 1,
            truth_mm: Some(truth_mm),
            ..case("cylinder", Arc::new(Cylinder::new(part, Interval::new(0.0, 5.0))?), passes, 0.4)
        },
        case("torus", Arc::new(torus), 40, 0.6),
        case("saddle", Arc::new(saddle), 20, 0.4),
        case("propeller F7", propeller, 60, 1.6),
        case("centrifugal blade F1", blade, 60, 1.6),
    ])
}

impl Case {
    fn motions(&self) -> Result<Vec<Swept>, Box<dyn Error>> {
        let d = self.surface.domain();
        let (along, across) = if self.along_u { (d.u, d.v) } else { (d.v, d.u) };
        let at = |i: &Interval, k: u32, n: u32| i.lo + (i.hi - i.lo) * f64::from(k) / f64::from(n);
        let mut motions = Vec::new();
        let last = if across.periodic { self.passes - 1 } else { self.passes };
        for pass in 0..=last {
            let mut from: Option<Pose> = None;
            for step in 0..=self.steps {
                let (a, b) = (at(&along, step, self.steps), at(&across, pass, self.passes));
                let place = if self.along_u { uv(a, b) } else { uv(b, a) };
                let jet = self.surface.jet2(place);
                // No pass where a side of the face is a point.
                let Ok(axis) = jet.normal() else { continue };
                // A ball whose axis is the normal touches with its tip.
                let to = Pose { tip: jet.point, axis };
                motions.extend(from.map(|from| Swept { from, to, rapid: false, block: pass }));
                from = Some(to);
            }
        }
        Ok(motions)
    }

    /// A ball that is a short cylinder above: it does not reach the far side of the torus.
    fn cutter(&self) -> Result<Cutter, Box<dyn Error>> {
        let diameter_mm = 2.0 * self.radius_mm;
        Ok(Cutter::try_from(CutterSpec::Ball { diameter_mm, length_mm: diameter_mm })?)
    }

    /// The highest standoff that a search from the highest samples finds, cell by cell ever smaller.
    fn highest(&self, motions: &[Swept], spacing_mm: f64) -> Result<f64, Box<dyn Error>> {
        let cutter = self.cutter()?;
        let Sampling { samples, patches, .. } = sample_surface(&*self.surface, 0, spacing_mm, MOST_SAMPLES)?;
        let mut cuts = cut(&job(&cutter, motions, &samples), &|_| ())?;
        let mut order: Vec<usize> = (0..samples.len()).collect();
        order.sort_by(|a, b| cuts[*b].standoff_mm.total_cmp(&cuts[*a].standoff_mm));
        // Where a search stands, how high, and how far it looks.
        let mut seeds: Vec<(Uv, f64, [f64; 2])> = order
            .iter()
            .take(SEEDS)
            .map(|k| {
                let patch = &patches[*k];
                (samples[*k].uv, cuts[*k].standoff_mm, [patch.u[1] - patch.u[0], patch.v[1] - patch.v[0]])
            })
            .collect();
        for _ in 0..ROUNDS {
            let mut around: Vec<Sample> = Vec::new();
            let mut of: Vec<usize> = Vec::new();
            for (seed, (at, _, [du, dv])) in seeds.iter().enumerate() {
                for k in 0..ACROSS * ACROSS {
                    let share = |n: u32| 2.0 * f64::from(n) / f64::from(ACROSS - 1) - 1.0;
                    let place = uv(at.u + du * share(k % ACROSS), at.v + dv * share(k / ACROSS));
                    let d = self.surface.domain();
                    let inside = |i: &Interval, x: f64| i.periodic || (i.lo..=i.hi).contains(&x);
                    if !(inside(&d.u, place.u) && inside(&d.v, place.v) && self.surface.contains(place)) {
                        continue;
                    }
                    let jet = self.surface.jet2(place);
                    let Ok(normal) = jet.normal() else { continue };
                    around.push(Sample { point: jet.point, normal, uv: place, ..samples[0] });
                    of.push(seed);
                }
            }
            cuts = cut(&job(&cutter, motions, &around), &|_| ())?;
            for ((sample, cut), seed) in around.iter().zip(&cuts).zip(of) {
                if cut.standoff_mm > seeds[seed].1 {
                    (seeds[seed].0, seeds[seed].1) = (sample.uv, cut.standoff_mm);
                }
            }
            for seed in &mut seeds {
                seed.2 = seed.2.map(|w| w * SMALLER);
            }
        }
        Ok(seeds.iter().map(|s| s.1).fold(0.0, f64::max))
    }

    /// Samples, the highest standoff, and the bound.
    fn look(&self, motions: &[Swept], spacing_mm: f64) -> Result<(usize, f64, f64), Box<dyn Error>> {
        let cutter = self.cutter()?;
        let Sampling { samples, patches, .. } = sample_surface(&*self.surface, 0, spacing_mm, MOST_SAMPLES)?;
        let job = job(&cutter, motions, &samples);
        let cuts = cut(&job, &|_| ())?;
        let seen = cuts.iter().map(|c| c.standoff_mm).fold(0.0, f64::max);
        let patches: Vec<Option<Patch>> = patches.into_iter().map(Some).collect();
        let wanted = Wanted { uncut_mm: STOCK_MM, enough_mm: 0.0, gouge_mm: GOUGE_MM };
        let more = hidden(&[&*self.surface], &job, (&patches, &cuts), wanted)?;
        Ok((samples.len(), seen, seen + more.scallop_mm))
    }
}

fn job<'a>(cutter: &'a Cutter, motions: &'a [Swept], samples: &'a [Sample]) -> Job<'a> {
    Job { cutter, holder: None, changes: &[], motions, samples, stock_mm: STOCK_MM, depth_mm: 1.0 }
}

const STOCK_MM: f64 = 1.0;
/// Depth of gouges that is asked for, which these paths do not reach.
const GOUGE_MM: f64 = 0.01;
const MOST_SAMPLES: usize = 3_000_000;
const HALVINGS: u32 = 4;
/// Searches for the highest place, rounds of each, places looked at each way, and by how much smaller the next round is.
const SEEDS: usize = 400;
const ROUNDS: u32 = 14;
const ACROSS: u32 = 7;
const SMALLER: f64 = 0.4;

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let mut good = true;
    for case in cases()? {
        let motions = case.motions()?;
        let spacing = |k: u32| case.spacing_mm * 0.5f64.powi(k as i32);
        let truth = match case.truth_mm {
            Some(truth) => truth,
            None => case.highest(&motions, spacing(HALVINGS - 1))?,
        };
        println!("{}, highest there is {truth:.6} mm", case.name);
        println!(
            "{:>10} {:>9} {:>11} {:>11} {:>13} {:>13} {:>14} {:>7}",
            "spacing mm",
            "samples",
            "seen",
            "bound",
            "truth - seen",
            "bound - seen",
            "bound - truth",
            "ratio"
        );
        let mut before: Option<f64> = None;
        for k in 0..HALVINGS {
            let (samples, seen, bound) = case.look(&motions, spacing(k))?;
            let off = bound - truth;
            let ratio = before.map_or(String::new(), |b| format!("{:.2}", b / off));
            println!(
                "{:>10.5} {samples:>9} {seen:>11.6} {bound:>11.6} {:>13.2e} {:>13.2e} {off:>14.2e} {ratio:>7}",
                spacing(k),
                truth - seen,
                bound - seen
            );
            good &= bound >= truth - 1e-12 && seen <= truth + 1e-12;
            before = Some(off);
        }
        println!();
    }
    println!("{}", if good { "the bound holds throughout" } else { "the bound does NOT hold" });
    Ok(ExitCode::from(u8::from(!good)))
}
