//! Tools, poses and samples that several tests use.

use osculate_geom::{Point3, Unit3, Vec3, uv};
use osculate_tools::removal::{Cut, Job, Sample, Swept, cut};
use osculate_tools::{Cutter, CutterSpec, Pose};

pub fn ball(diameter_mm: f64) -> Cutter {
    Cutter::try_from(CutterSpec::Ball { diameter_mm, length_mm: 60.0 }).expect("a good ball")
}

pub fn toroidal(diameter_mm: f64, corner_radius_mm: f64) -> Cutter {
    Cutter::try_from(CutterSpec::Toroidal { diameter_mm, corner_radius_mm, length_mm: 60.0 })
        .expect("a good tool")
}

pub fn flat(diameter_mm: f64) -> Cutter {
    Cutter::try_from(CutterSpec::Flat { diameter_mm, length_mm: 60.0 }).expect("a good tool")
}

pub fn pose(tip: [f64; 3], axis: [f64; 3]) -> Pose {
    Pose { tip: Point3::from(tip), axis: Unit3::new_normalize(Vec3::from(axis)) }
}

pub fn upright(x: f64, y: f64, z: f64) -> Pose {
    pose([x, y, z], [0.0, 0.0, 1.0])
}

pub fn sample(point: [f64; 3], normal: [f64; 3]) -> Sample {
    Sample {
        point: Point3::from(point),
        normal: Unit3::new_normalize(Vec3::from(normal)),
        face: 0,
        uv: uv(point[0], point[1]),
        area_mm2: 1.0,
        check_only: false,
    }
}

/// Feed motions through the poses, blocks numbered from 1.
pub fn through(poses: &[Pose]) -> Vec<Swept> {
    let pairs = poses.windows(2).zip(1u32..);
    pairs.map(|(p, block)| Swept { from: p[0], to: p[1], rapid: false, block }).collect()
}

pub fn run(cutter: &Cutter, motions: &[Swept], samples: &[Sample], stock_mm: f64) -> Vec<Cut> {
    let job = Job { cutter, holder: None, motions, samples, stock_mm, depth_mm: 2.0 };
    cut(&job, &|_| ()).expect("a good job")
}
