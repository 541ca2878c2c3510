//! The contact points of passes as a picture of the part: how deep a tool goes into it where it does not cut.
//!
//! Their points are filled up along them, and points of the faces lie between: strips may be as wide as the tool. So the tool finds
//! what it could run into of the faces that it machines. Depths are those at points: what lies between them can be a little deeper.

use super::Pass;
use osculate_geom::Point3;
use osculate_tools::{Cutter, Pose};

/// Points in a group.
const GROUP: usize = 48;

/// Whether a point lies no further than `reach_mm` from the half-infinite cylinder around the cutter: most points do not, and
/// that costs less to see than their distance.
fn near(cutter: &Cutter, pose: &Pose, p: &Point3, reach_mm: f64) -> bool {
    let way = p - pose.tip;
    let (z, most) = (way.dot(&pose.axis), cutter.radius_mm() + reach_mm);
    z >= -reach_mm && way.norm_squared() - z * z <= most * most
}

/// Points in groups that follow each other along passes.
pub(super) struct Cloud {
    /// Middle, greatest distance from it, points.
    groups: Vec<(Point3, f64, Vec<Point3>)>,
}

impl Cloud {
    /// The contact points of passes, no further apart along them than `spacing_mm`, and other points of the faces.
    pub fn of(passes: &[Pass], spacing_mm: f64, ground: &[Point3]) -> Self {
        let grouped = |chunk: &[Point3]| {
            let middle = chunk[chunk.len() / 2];
            let reach = chunk.iter().map(|p| (p - middle).norm()).fold(0.0, f64::max);
            (middle, reach, chunk.to_vec())
        };
        let mut groups: Vec<_> = ground.chunks(GROUP).map(grouped).collect();
        for pass in passes {
            let mut points: Vec<Point3> = Vec::new();
            for p in &pass.points {
                if let Some(last) = points.last().copied() {
                    let step = p.point - last;
                    let pieces = (step.norm() / spacing_mm).ceil().max(1.0);
                    points.extend((1..pieces as usize).map(|k| last + step * (k as f64 / pieces)));
                }
                points.push(p.point);
            }
            groups.extend(points.chunks(GROUP).map(grouped));
        }
        Self { groups }
    }

    /// How deep the deepest point lies in the cutter, zero where none does.
    pub fn depth_mm(&self, cutter: &Cutter, pose: &Pose) -> f64 {
        let mut depth = 0.0f64;
        for (middle, reach, points) in &self.groups {
            // A signed distance changes by no more than the way to another point.
            if near(cutter, pose, middle, *reach) && cutter.distance(pose, middle) - reach < -depth {
                let inside = points.iter().filter(|p| near(cutter, pose, p, 0.0));
                depth = inside.map(|p| -cutter.distance(pose, p)).fold(depth, f64::max);
            }
        }
        depth
    }

    /// Whether a point is nearer to the cutter than so much.
    pub fn is_within(&self, cutter: &Cutter, pose: &Pose, limit_mm: f64) -> bool {
        self.groups.iter().any(|(middle, reach, points)| {
            near(cutter, pose, middle, reach + limit_mm)
                && cutter.distance(pose, middle) - reach < limit_mm
                && points.iter().any(|p| cutter.distance(pose, p) < limit_mm)
        })
    }
}
