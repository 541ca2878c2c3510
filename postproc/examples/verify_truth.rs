//! Verification against closed forms and second methods: scallops of rasters, planted gouges, convergence.
//!
//! `cargo run --release -p osculate-postproc --example verify_truth`; exits 1 where a figure misses its limit: scallops within
//! a ten-thousandth of the tolerance, gouges within 5 % and at their block.

#![allow(clippy::print_stdout, reason = "a study prints its tables")]

#[path = "verify_truth/gouges.rs"]
mod gouges;
#[path = "verify_truth/rasters.rs"]
mod rasters;

use osculate_geom::{Point3, Unit3, Vec3, uv};
use osculate_tools::removal::{Cut, Job, Sample, Swept, cut};
use osculate_tools::{Cutter, CutterSpec, Pose};
use std::process::ExitCode;

fn ball(diameter_mm: f64) -> Cutter {
    Cutter::try_from(CutterSpec::Ball { diameter_mm, length_mm: 60.0 }).expect("a good ball")
}

fn toroidal(diameter_mm: f64, corner_radius_mm: f64) -> Cutter {
    Cutter::try_from(CutterSpec::Toroidal { diameter_mm, corner_radius_mm, length_mm: 60.0 })
        .expect("a good tool")
}

fn pose(tip: Point3, axis: Vec3) -> Pose {
    Pose { tip, axis: Unit3::new_normalize(axis) }
}

fn sample(point: Point3, normal: Vec3) -> Sample {
    let normal = Unit3::new_normalize(normal);
    Sample { point, normal, face: 0, uv: uv(0.0, 0.0), area_mm2: 1.0, check_only: false }
}

/// Feed motions through the poses, blocks numbered from 1.
fn through(poses: &[Pose]) -> Vec<Swept> {
    let pairs = poses.windows(2).zip(1u32..);
    pairs.map(|(p, block)| Swept { from: p[0], to: p[1], rapid: false, block }).collect()
}

fn run(cutter: &Cutter, motions: &[Swept], samples: &[Sample]) -> Vec<Cut> {
    let job = Job { cutter, holder: None, changes: &[], motions, samples, stock_mm: 1.0, depth_mm: 2.0 };
    cut(&job, &|_| ()).expect("a good job")
}

fn main() -> ExitCode {
    let good = [rasters::scallops(), rasters::spacing(), rasters::steps(), gouges::planted()];
    ExitCode::from(u8::from(good.contains(&false)))
}
