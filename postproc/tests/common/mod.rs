//! Paths and comparisons that several tests share.
#![allow(dead_code)]

pub mod blade;
pub mod cl_text;

use osculate_geom::{Point3, Unit3, Vec3};
use osculate_postproc::readback::ReadBack;
use osculate_tools::Pose;
use osculate_tools::cl::{ClMove, ClPath, Motion};

pub fn pose(tip: [f64; 3], axis: [f64; 3]) -> Pose {
    Pose { tip: Point3::from(tip), axis: Unit3::new_normalize(Vec3::from(axis)) }
}

/// A rapid to the first pose, then feed moves.
pub fn path(poses: impl IntoIterator<Item = Pose>, feed_mm_min: f64) -> ClPath {
    let motion = |i| if i == 0 { Motion::Rapid } else { Motion::Feed(feed_mm_min) };
    let moves = poses
        .into_iter()
        .enumerate()
        .map(|(i, pose)| ClMove { pose, motion: motion(i), aloft: false })
        .collect();
    ClPath { moves, spindle_rpm: Some(8000.0), ..ClPath::default() }
}

/// A tool that leans about 20 deg and goes round while the tip runs over a bumpy patch.
pub fn wave(points: u32, phase: f64) -> ClPath {
    let at = |i: u32| {
        let t = f64::from(i) / f64::from(points - 1);
        let w = phase + 4.0 * t;
        let (lean, round) = (0.35 + 0.08 * (5.0 * t).sin(), w);
        let axis = [lean.sin() * round.cos(), lean.sin() * round.sin(), lean.cos()];
        pose([40.0 * t - 20.0, 15.0 * w.sin(), 5.0 * w.cos() + 10.0], axis)
    };
    path((0..points).map(at), 300.0)
}

/// What is read back of the way itself: from the line in which the first pose is reached, without what retracts in the
/// machine's own coordinates.
pub fn way_of(path: &ClPath, back: &ReadBack, tol_mm: f64) -> ReadBack {
    let first = path.moves[0].pose.tip;
    let reached = back.moves.iter().position(|m| (m.pose.tip - first).norm() <= tol_mm);
    let at = reached.expect("the first pose is reached");
    let line = back.moves[at].line;
    let moves = back.moves[at..].iter().filter(|m| !m.own_frame).copied().collect();
    let blocks = back.blocks.iter().filter(|b| b.line > line && !b.own_frame).copied().collect();
    ReadBack { moves, blocks, ..back.clone() }
}

/// Distance from a point to the polyline of a path's tips.
pub fn distance_mm(path: &ClPath, p: &Point3) -> f64 {
    let to_segment = |pair: &[ClMove]| {
        let (a, b) = (pair[0].pose.tip, pair[1].pose.tip);
        let d = b - a;
        let t =
            if d.norm_squared() > 0.0 { ((p - a).dot(&d) / d.norm_squared()).clamp(0.0, 1.0) } else { 0.0 };
        (p - (a + d * t)).norm()
    };
    path.moves.windows(2).map(to_segment).fold(f64::INFINITY, f64::min)
}

/// Small angle between two axes.
pub fn angle(a: &Unit3, b: &Unit3) -> f64 {
    a.cross(b).norm().atan2(a.dot(b))
}
