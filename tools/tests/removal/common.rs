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

/// Cones, a barrel and an APT cutter of about the size of `ball(6.0)`.
pub fn shapes() -> [Cutter; 4] {
    let (diameter_mm, length_mm) = (8.0, 25.0);
    let cone = |taper_deg, corner_radius_mm, tip_diameter_mm| CutterSpec::Cone {
        diameter_mm,
        taper_deg,
        corner_radius_mm,
        tip_diameter_mm,
        length_mm,
    };
    [
        cone(10.0, 1.0, None),
        cone(25.0, 0.0, Some(3.0)),
        CutterSpec::Barrel { diameter_mm, barrel_radius_mm: 30.0, corner_radius_mm: 1.5, length_mm },
        CutterSpec::Apt {
            diameter_mm,
            corner_radius_mm: 0.8,
            bottom_angle_deg: 12.0,
            side_angle_deg: -5.0,
            length_mm,
        },
    ]
    .map(|spec| Cutter::try_from(spec).expect("a good shape"))
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
    let job = Job { cutter, holder: None, changes: &[], motions, samples, stock_mm, depth_mm: 2.0 };
    cut(&job, &|_| ()).expect("a good job")
}
