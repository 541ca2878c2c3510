//! Verification of poses against the faces of a job, shared by `plan` and `verify`.

use crate::failure::Failure;
use crate::job::Job;
use crate::part::JobFaces;
use crate::work::rough;
use osculate_geom::{Diagnostic, Surface};
use osculate_tools::Cutter;
use osculate_tools::removal::{self, Cut, Density, Kind, Limits, Measured, Patch, Sample, Swept, Verdict};
use serde::Serialize;

/// Most samples where the job does not say.
const MAX_SAMPLES: usize = 1_000_000;
/// Check faces are sampled this many times as coarsely: there only deep contact matters.
const CHECK_COARSER: f64 = 4.0;
/// Samples that are added at most, of the even ones.
const MOST_ADDED: usize = 4;
/// The share of `max_samples` that the even ones take at most.
const MOST_EVEN: f64 = 0.8;
/// The share of a verification's time that the even samples take, for its progress.
const EVEN_SHARE: f64 = 0.7;
/// Samples across the narrowest usual strip.
const SAMPLES_ACROSS: f64 = 10.0;

/// The `verification` object of `summary.json` and of `verify --json`.
#[derive(Debug, Serialize, Clone)]
pub struct Verification {
    /// `nc` or `cl`.
    pub source: &'static str,
    /// Number of samples.
    pub samples: usize,
    /// Those of them that were added where limits might be exceeded between the others.
    pub added_samples: usize,
    /// Distance between the others, mm.
    pub spacing_mm: f64,
    /// Scallop that may hide between samples above the highest one seen, mm.
    pub hidden_scallop_mm: f64,
    /// Gouge that may hide between samples below the deepest one seen, mm.
    pub hidden_gouge_mm: f64,
    /// The smallest radius of curvature at a sample; absent where everything is flat.
    pub smallest_radius_mm: Option<f64>,
    /// Whether the limits hold with what may hide added to what was measured.
    pub certain: bool,
    /// Highest material left where the tool passed.
    pub scallop_max_mm: f64,
    /// Of 99 % of the area.
    pub scallop_p99_mm: f64,
    /// Median over the area.
    pub scallop_median_mm: f64,
    /// Median height of the crests between passes, on lines across the feed. Zero where none is found.
    pub crest_median_mm: f64,
    /// That over the scallop tolerance.
    pub scallop_use: f64,
    /// Deepest undercut.
    pub gouge_max_mm: f64,
    /// Area left standing at more than five times the scallop tolerance, or never touched.
    pub uncut_area_mm2: f64,
    /// The most that a rapid move of the cutter took.
    pub rapid_max_mm: f64,
    /// The most that the holder took.
    pub holder_max_mm: f64,
    /// Whether everything holds.
    pub within_tolerance: bool,
}

/// A bin of the histogram: area by what stands on it.
#[derive(Debug, Serialize, Clone)]
pub struct HistogramBin {
    /// From here, negative is below the part; absent in the first.
    pub from_mm: Option<f64>,
    /// To here; absent in the last.
    pub to_mm: Option<f64>,
    /// Area of the machined faces.
    pub area_mm2: f64,
}

impl Verification {
    /// The verdict.
    pub const fn words(&self) -> &'static str {
        if self.certain {
            "within tolerance, with all that may hide between samples"
        } else if self.within_tolerance {
            "within tolerance at the samples; more may hide between them"
        } else {
            "NOT within tolerance"
        }
    }

    /// What the figures are worth, in a sentence.
    pub fn confidence(&self) -> String {
        let bend = self.smallest_radius_mm.map_or_else(
            || "the faces are flat".to_owned(),
            |r| {
                let turn = (self.spacing_mm / r).to_degrees();
                format!("the sharpest radius met is {r:.3} mm, over which normals turn by {turn:.2} deg from sample to sample")
            },
        );
        format!(
            "{} samples {:.4} mm apart and {} between them where limits were near; {bend}; between them all scallops may be \
             {:.5} mm higher and gouges {:.5} mm deeper than measured",
            self.samples - self.added_samples,
            self.spacing_mm,
            self.added_samples,
            self.hidden_scallop_mm,
            self.hidden_gouge_mm
        )
    }
}

/// A worst place.
#[derive(Debug, Serialize, Clone)]
pub struct WorstPlace {
    /// `scallop`, `gouge`, `uncut`, `holder` or `rapid`.
    pub kind: String,
    /// How bad.
    pub value_mm: f64,
    /// Where, part coordinates.
    pub at_mm: [f64; 3],
    /// The face.
    pub face: String,
    /// Its parameters.
    pub uv: [f64; 2],
    /// NC line or CL move, from 1; 0 where no motion did it.
    pub block: u32,
}

/// A verification with what the report needs.
pub struct Verified {
    /// The figures.
    pub summary: Verification,
    /// Worst places.
    pub worst: Vec<WorstPlace>,
    /// Area by what stands on it.
    pub histogram: Vec<HistogramBin>,
    /// Where it was measured: evenly at first, then the samples that were added.
    pub samples: Vec<Sample>,
    /// What was measured there.
    pub cuts: Vec<Cut>,
    /// The library's own verdict.
    pub verdict: Verdict,
    /// Findings.
    pub diagnostics: Vec<Diagnostic>,
}

/// What is to be cut: stock far above any scallop, and gouges as deep as the tool's radius told.
pub fn to_cut<'a>(
    (cutter, holder): (&'a Cutter, Option<&'a Cutter>),
    motions: &'a [Swept],
    samples: &'a [Sample],
    scallop_mm: f64,
) -> removal::Job<'a> {
    let radius = cutter.radius_mm();
    let stock_mm = (20.0 * scallop_mm).max(0.5).min(0.5 * radius);
    removal::Job { cutter, holder, motions, samples, stock_mm, depth_mm: radius }
}

/// Runs the material removal of `motions` against the faces of the job.
pub fn run(
    job: &Job,
    faces: &JobFaces,
    motions: &[Swept],
    source: &'static str,
    strip_mm: Option<f64>,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Verified, Failure> {
    let cutter = job.cutter();
    let holder = job.holder();
    let tolerance = job.tolerance();
    let max = job.verification().max_samples.unwrap_or(MAX_SAMPLES);
    let strip = strip_mm
        .filter(|s| s.is_finite() && *s > 0.0)
        .unwrap_or_else(|| 2.0 * (2.0 * tolerance.scallop_mm * cutter.radius_mm()).sqrt());
    let wanted = job.verification().spacing_mm.unwrap_or(strip / SAMPLES_ACROSS);
    let all: Vec<_> =
        faces.faces.iter().map(|f| (f, false)).chain(faces.check.iter().map(|f| (f, true))).collect();
    // A roughing is measured against its allowance.
    let offsets = rough::measured(job, faces)?;
    let surface = |k: usize| -> &dyn Surface {
        match offsets.get(k) {
            Some(o) => o,
            None => &*all[k].0.surface,
        }
    };
    let area: f64 = faces.faces.iter().map(crate::part::area).sum();
    let check_area: f64 = faces.check.iter().map(crate::part::area).sum();
    let mut diagnostics = Vec::new();
    let coarsest = ((area + check_area / (CHECK_COARSER * CHECK_COARSER)) / (MOST_EVEN * max as f64)).sqrt();
    let spacing = wanted.max(coarsest);
    if spacing > 1.01 * wanted {
        diagnostics.push(Diagnostic::warning(
            "verification",
            format!(
                "samples are {spacing:.4} mm apart instead of {wanted:.4} mm to stay within {max} of them"
            ),
        ));
    }
    let mut samples = Vec::new();
    let mut patches: Vec<Option<Patch>> = Vec::new();
    let mut density: Option<Density> = None;
    for (k, (face, check_only)) in all.iter().enumerate() {
        let step = if *check_only { CHECK_COARSER * spacing } else { spacing };
        let found = removal::sample_surface(surface(k), k as u32, step, max)
            .map_err(|e| Failure::job(format!("{}: {e}", face.id)))?;
        if found.lost_area_mm2 > 0.0 {
            diagnostics.push(Diagnostic::warning(
                &face.id,
                format!("{:.4} mm2 of it have no tangent plane and are not verified", found.lost_area_mm2),
            ));
        }
        if !check_only {
            density = Some(density.map_or(found.density, |d| d.union(&found.density)));
        }
        samples.extend(found.samples.into_iter().map(|s| Sample { check_only: *check_only, ..s }));
        patches.extend(found.patches.into_iter().map(Some));
        if !check_only && face.surface.is_trimmed() {
            for outline in face.surface.loops() {
                samples.extend(removal::sample_boundary(surface(k), &outline.points, k as u32, step));
            }
        }
        patches.resize(samples.len(), None);
    }
    samples.extend(crate::work::stock::fixtures(job, all.len() as u32)?);
    patches.resize(samples.len(), None);
    let density = density.ok_or_else(|| Failure::job("there is no face to verify"))?;
    let work = to_cut((&cutter, holder.as_ref()), motions, &samples, tolerance.scallop_mm);
    let cuts = removal::cut(&work, &|f| progress(EVEN_SHARE * f)).map_err(Failure::job)?;
    // The tool's effective radius across the feed, from the strip that it leaves.
    let effective = strip * strip / (8.0 * tolerance.scallop_mm);
    let limits = Limits::new(tolerance.scallop_mm, tolerance.gouge_mm);
    let surfaces: Vec<&dyn Surface> = (0..all.len()).map(surface).collect();
    let crest_median_mm =
        removal::crests(&surfaces, &work, &cuts, strip, limits.uncut_mm).map_err(Failure::job)?;
    let wanted = removal::Wanted {
        uncut_mm: limits.uncut_mm,
        // What a roughing leaves above its allowance is told, not judged.
        enough_mm: if rough::is(job) { f64::INFINITY } else { limits.scallop_mm },
        gouge_mm: limits.gouge_mm,
    };
    let even = samples.len();
    let mut verdict = removal::judge(&samples, &cuts, &limits, &density, effective).map_err(Failure::job)?;
    let mut measured = Measured { samples, patches, cuts };
    // The same without samples of its own.
    let work = to_cut((&cutter, holder.as_ref()), motions, &[], tolerance.scallop_mm);
    // Between samples of a path that fails already nothing is left to be found out.
    let holds = verdict.within || rough::is(job);
    let most = if holds { max.saturating_sub(even).min(MOST_ADDED * even) } else { 0 };
    let refined = removal::refine(&surfaces, &work, &mut measured, wanted, most).map_err(Failure::job)?;
    let Measured { samples, patches, cuts } = measured;
    if refined.added > 0 {
        verdict = removal::judge(&samples, &cuts, &limits, &density, effective).map_err(Failure::job)?;
    }
    verdict.hidden = refined.hidden;
    if holds && refined.left_out > 0 {
        let text = format!(
            "limits may be exceeded at {} or more places between samples that were not looked at: set [verification] spacing_mm \
             below {:.4}, and max_samples above {max} where it is reached",
            refined.left_out, density.spacing_mm
        );
        diagnostics.push(Diagnostic::warning("verification", text));
    }
    progress(1.0);
    if rough::is(job) {
        // What a roughing leaves above its allowance is told, not judged: finishing takes it.
        verdict.within = verdict.gouge_max_mm <= limits.gouge_mm
            && verdict.rapid_max_mm <= limits.collision_mm
            && verdict.holder_max_mm <= limits.collision_mm;
    }
    let sharpest =
        patches.iter().flatten().map(|p| p.convex_per_mm.max(p.concave_per_mm)).fold(0.0, f64::max);
    // Worst first: by how much of its own limit a place takes.
    let share = |w: &removal::Worst| match w.kind {
        Kind::Scallop | Kind::Uncut => w.value_mm / limits.scallop_mm,
        Kind::Gouge => w.value_mm / limits.gouge_mm,
        Kind::Holder | Kind::Rapid => w.value_mm / limits.collision_mm,
    };
    let mut places: Vec<removal::Worst> = verdict.worst.clone();
    places.sort_by(|a, b| share(b).total_cmp(&share(a)));
    let worst = places
        .iter()
        .map(|w| WorstPlace {
            kind: match w.kind {
                Kind::Scallop => "scallop",
                Kind::Gouge => "gouge",
                Kind::Uncut => "uncut",
                Kind::Holder => "holder",
                Kind::Rapid => "rapid",
            }
            .to_owned(),
            value_mm: w.value_mm,
            at_mm: [w.at.x, w.at.y, w.at.z],
            face: all.get(w.face as usize).map_or_else(|| "fixture".to_owned(), |f| f.0.id.clone()),
            uv: [w.uv.u, w.uv.v],
            block: w.block.unwrap_or(0),
        })
        .collect();
    let summary = Verification {
        source,
        samples: samples.len(),
        added_samples: refined.added,
        spacing_mm: density.spacing_mm,
        hidden_scallop_mm: verdict.hidden.scallop_mm,
        hidden_gouge_mm: verdict.hidden.gouge_mm,
        smallest_radius_mm: (sharpest > 0.0).then(|| 1.0 / sharpest),
        certain: verdict.within
            && (rough::is(job) || verdict.scallop_max_mm + verdict.hidden.scallop_mm <= limits.scallop_mm)
            && verdict.gouge_max_mm + verdict.hidden.gouge_mm <= limits.gouge_mm,
        scallop_max_mm: verdict.scallop_max_mm,
        scallop_p99_mm: verdict.scallop_p99_mm,
        scallop_median_mm: verdict.median_mm,
        crest_median_mm,
        scallop_use: crest_median_mm / tolerance.scallop_mm,
        gouge_max_mm: verdict.gouge_max_mm,
        uncut_area_mm2: verdict.uncut_area_mm2,
        rapid_max_mm: verdict.rapid_max_mm,
        holder_max_mm: verdict.holder_max_mm,
        within_tolerance: verdict.within,
    };
    let finite = |x: f64| x.is_finite().then_some(x);
    let bin = |b: &removal::Bin| HistogramBin {
        from_mm: finite(b.from_mm),
        to_mm: finite(b.to_mm),
        area_mm2: b.area_mm2,
    };
    let histogram = verdict.histogram.iter().map(bin).collect();
    Ok(Verified { summary, worst, histogram, samples, cuts, verdict, diagnostics })
}
