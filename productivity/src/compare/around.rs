//! Points of everything that a tool can run into, for a coarse look at its body.

use osculate_geom::{Box3, Point3, Surface};
use osculate_tools::{Cutter, Pose};

/// Points a side of a face.
const SIDE: usize = 24;

/// Points of part and check faces.
#[derive(Clone, Debug, Default)]
pub struct Around {
    names: Vec<String>,
    points: Vec<Point3>,
    /// For each face where its points begin, and the end.
    first: Vec<usize>,
    boxes: Vec<Box3>,
}

impl Around {
    /// Points of faces with their names.
    #[must_use]
    pub fn of<'a>(faces: impl Iterator<Item = (&'a dyn Surface, &'a str)>) -> Self {
        let mut out = Self { first: vec![0], ..Self::default() };
        for (surface, name) in faces {
            let domain = surface.domain();
            let mut bounds = Box3::empty();
            for i in 0..=SIDE {
                for j in 0..=SIDE {
                    let at = domain.at(i as f64 / SIDE as f64, j as f64 / SIDE as f64);
                    if surface.contains(at) {
                        let p = surface.point(at);
                        bounds.add(&p);
                        out.points.push(p);
                    }
                }
            }
            out.names.push(name.to_owned());
            out.first.push(out.points.len());
            out.boxes.push(bounds);
        }
        out
    }

    /// The name of a face; empty where there is none of this number.
    #[must_use]
    pub fn name(&self, face: usize) -> &str {
        self.names.get(face).map_or("", String::as_str)
    }

    /// Where a body at a pose goes deeper than `slack_mm` into a face: depth and face of the first such point.
    #[must_use]
    pub fn met(&self, body: &Cutter, pose: &Pose, slack_mm: f64) -> Option<(f64, usize)> {
        // A ball around the body.
        let half = 0.5 * body.length_mm();
        let middle = pose.tip + pose.axis.into_inner() * half;
        let reach = half.hypot(body.radius_mm());
        for (face, bounds) in self.boxes.iter().enumerate() {
            if bounds.is_empty() || (bounds.centre() - middle).norm() > reach + 0.5 * bounds.diagonal_mm() {
                continue;
            }
            for p in &self.points[self.first[face]..self.first[face + 1]] {
                if (p - middle).norm_squared() < reach * reach {
                    let depth = -body.distance(pose, p);
                    if depth > slack_mm {
                        return Some((depth, face));
                    }
                }
            }
        }
        None
    }
}
