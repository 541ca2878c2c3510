//! What passes leave on a face, by material removal along its normals, and how well they use the tolerance.

#[path = "joined.rs"]
pub mod joined;

use joined::joined;
use osculate_geom::{Axis, Surface, Unit3, Uv};
use osculate_productivity::plan::{Pass, Tolerance};
use osculate_tools::Cutter;
use osculate_tools::removal::{Job, Limits, Sample, Swept, Tally, cut, sample_surface, tally};

/// Rows along each parameter on which cusps are looked for, and samples on a row.
const ROWS: usize = 8;
const ON_ROW: usize = 4000;

/// The linked path of passes over a face, as motions.
pub fn motions(surface: &dyn Surface, passes: &[Pass], cutter: &Cutter) -> Vec<Swept> {
    Swept::along(&joined(surface, passes, cutter))
}

/// The verdict of material removal on samples `spacing_mm` apart.
pub fn verdict(
    surface: &dyn Surface,
    motions: &[Swept],
    cutter: &Cutter,
    tolerance: Tolerance,
    spacing_mm: f64,
) -> Tally {
    let sampling = sample_surface(surface, 0, spacing_mm, 400_000).expect("a face");
    let job = Job {
        cutter,
        holder: None,
        changes: &[],
        motions,
        samples: &sampling.samples,
        stock_mm: 1.0,
        depth_mm: 2.0,
    };
    let cuts = cut(&job, &|_| ()).expect("a job");
    let limits = Limits::new(tolerance.scallop_mm, tolerance.gouge_mm);
    tally(&sampling.samples, &cuts, &limits, &sampling.density, cutter.radius_mm()).expect("a verdict")
}

/// Median height of the cusps between passes over the tolerance: of the highest places between two lower ones on rows
/// across the face, along that parameter on which they are higher.
pub fn cusps(surface: &dyn Surface, motions: &[Swept], cutter: &Cutter, scallop_mm: f64) -> f64 {
    let along = |axis: Axis| -> Vec<f64> {
        let d = surface.domain();
        let mut samples: Vec<Sample> = Vec::new();
        let mut ends = vec![0];
        for r in 0..ROWS {
            let fixed = d.get(axis.other()).at((r as f64 + 0.5) / ROWS as f64);
            for k in 0..ON_ROW {
                let at = Uv::from_axis(axis, d.get(axis).at((k as f64 + 0.5) / ON_ROW as f64), fixed);
                let jet = surface.jet2(at);
                let normal: Option<Unit3> = jet.normal().ok();
                if let Some(normal) = normal.filter(|_| surface.contains(at)) {
                    let (point, uv) = (jet.point, at);
                    samples.push(Sample { point, normal, face: 0, uv, area_mm2: 1.0, check_only: false });
                }
            }
            ends.push(samples.len());
        }
        let job = Job {
            cutter,
            holder: None,
            changes: &[],
            motions,
            samples: &samples,
            stock_mm: 1.0,
            depth_mm: 2.0,
        };
        let cuts = cut(&job, &|_| ()).expect("a job");
        ends.windows(2)
            .flat_map(|w| peaks(&cuts[w[0]..w[1]].iter().map(|c| c.standoff_mm).collect::<Vec<_>>()))
            .collect()
    };
    let median = |axis: Axis| {
        let mut all = along(axis);
        all.sort_by(f64::total_cmp);
        all.get(all.len() / 2).map_or(0.0, |m| m / scallop_mm)
    };
    median(Axis::U).max(median(Axis::V))
}

/// Heights of the maxima that stand at least twice as high as the minima to both sides.
fn peaks(heights: &[f64]) -> Vec<f64> {
    let mut out = Vec::new();
    let (mut low, mut high) = (f64::INFINITY, None::<f64>);
    for h in heights {
        match high {
            None if *h > 2.0 * low.max(0.0) && *h > 1e-4 => high = Some(*h),
            None => low = low.min(*h),
            Some(p) if *h > p => high = Some(*h),
            Some(p) if *h < 0.5 * p => {
                out.push(p);
                (low, high) = (*h, None);
            }
            Some(_) => {}
        }
    }
    out
}
