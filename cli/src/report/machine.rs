//! The machine in the view: its joints as a chain from the table to the spindle, where the part sits, and the bodies that ride on them.
//!
//! The page follows the chain itself, so that a place of the tool costs one number a joint: frame `k` is what the first `k` joints make of
//! the table's, as in the machine file, slides at the spindle nose.

use osculate_geom::convex::Convex;
use osculate_postproc::machine::spec::CarriedSide;
use osculate_postproc::machine::{self, JointKind, Machine as Chain};
use serde_json::{Value, json};

/// Triangles of bodies given as meshes at most; beyond it a box stands for such a body.
const TRIANGLES: usize = 40_000;

/// The machine that a program runs on.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Machine {
    /// Its name.
    pub name: String,
    /// The joints, those of the table first.
    pub joints: Vec<Joint>,
    /// From the part's frame to the table's, one for each setup: 4 by 4, column by column.
    pub setups: Vec<[f64; 16]>,
    /// What moves with the joints.
    pub bodies: Vec<Body>,
    /// Bodies for which a box stands, since they have too many triangles.
    pub boxed: Vec<String>,
}

/// A joint.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Joint {
    /// Its letter.
    pub letter: String,
    /// It turns; else it slides.
    pub turns: bool,
    /// It carries the table; else the head.
    pub of_table: bool,
    /// Its direction, tool relative to part.
    pub direction: [f64; 3],
    /// A point of the axis that it turns about, mm.
    pub point_mm: [f64; 3],
}

/// A body.
#[derive(Clone, Debug)]
pub struct Body {
    /// Its name.
    pub name: String,
    /// It is on the side of the tool.
    pub of_head: bool,
    /// So many joints lie between it and the part.
    pub frame: usize,
    /// Its shape there.
    pub pieces: Vec<Piece>,
}

/// A shape that a view can draw.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Piece {
    /// A cylinder or a cone: the centres of its ends, mm, and the radii there.
    Round {
        /// The centres.
        ends_mm: [[f64; 3]; 2],
        /// The radii.
        radii_mm: [f64; 2],
    },
    /// A box between two corners, mm.
    Box {
        /// The corners.
        corners_mm: [[f64; 3]; 2],
    },
    /// Triangles, mm.
    Triangles(Vec<[[f32; 3]; 3]>),
}

impl Machine {
    /// A machine, with the places of the part on its table.
    pub fn new(chain: &Chain, setups: Vec<[f64; 16]>) -> Self {
        let joint = |j: &machine::Joint| Joint {
            letter: j.letter.clone(),
            turns: j.kind == JointKind::Rotary,
            of_table: j.side == CarriedSide::Table,
            direction: j.direction.into_inner().into(),
            point_mm: j.point.into(),
        };
        let mut out = Self {
            name: chain.name().to_owned(),
            joints: chain.joints().iter().map(joint).collect(),
            setups,
            ..Self::default()
        };
        let mut left = TRIANGLES;
        for body in chain.bodies() {
            let flat = body.shape.members().iter().filter(|m| matches!(m, Convex::Triangle(_))).count();
            let pieces = if flat > left {
                out.boxed.push(body.name.clone());
                let bounds = body.shape.bounds();
                vec![Piece::Box { corners_mm: [bounds.min.into(), bounds.max.into()] }]
            } else {
                left -= flat;
                pieces(body.shape.members())
            };
            out.bodies.push(Body {
                name: body.name.clone(),
                of_head: body.of_head,
                frame: body.frame,
                pieces,
            });
        }
        out
    }

    /// What the page reads of it; `put` keeps numbers in the block and says where.
    pub fn head(&self, mut put: impl FnMut(Vec<f32>) -> usize) -> Value {
        let joint = |j: &Joint| json!({"letter": j.letter, "turns": j.turns, "table": j.of_table, "direction": j.direction, "point": j.point_mm});
        let mut piece = |p: &Piece| match p {
            Piece::Round { ends_mm, radii_mm } => json!({"ends": ends_mm, "radii": radii_mm}),
            Piece::Box { corners_mm } => json!({"corners": corners_mm}),
            Piece::Triangles(all) => {
                json!({"at": put(all.as_flattened().as_flattened().to_vec()), "count": all.len()})
            }
        };
        let mut body = |b: &Body| {
            let pieces: Vec<Value> = b.pieces.iter().map(&mut piece).collect();
            json!({"name": b.name, "head": b.of_head, "frame": b.frame, "pieces": pieces})
        };
        json!({
            "name": self.name,
            "joints": self.joints.iter().map(joint).collect::<Vec<_>>(),
            "setups": self.setups,
            "bodies": self.bodies.iter().map(&mut body).collect::<Vec<_>>(),
        })
    }
}

/// Shapes of the members of a body; triangles are put together.
fn pieces(members: &[Convex]) -> Vec<Piece> {
    let mut out = Vec::new();
    let mut triangles = Vec::new();
    for member in members {
        match member {
            Convex::Triangle(corners) => triangles.push(corners.map(|p| [p.x, p.y, p.z].map(|c| c as f32))),
            Convex::Frustum { ends, radii_mm } => {
                out.push(Piece::Round { ends_mm: ends.map(Into::into), radii_mm: *radii_mm });
            }
            // Of machine files only boxes come so.
            Convex::Hull(_) => {
                let bounds = member.bounds();
                out.push(Piece::Box { corners_mm: [bounds.min.into(), bounds.max.into()] });
            }
        }
    }
    if !triangles.is_empty() {
        out.push(Piece::Triangles(triangles));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::Point3;

    #[test]
    fn members_become_shapes_and_triangles_are_put_together() {
        let at = |x: f64| Point3::new(x, 0.0, 1.0);
        let triangle = Convex::Triangle([at(0.0), at(1.0), Point3::new(0.0, 2.0, 1.0)]);
        let round = Convex::Frustum { ends: [at(0.0), at(3.0)], radii_mm: [2.0, 1.0] };
        let cuboid = Convex::cuboid(&osculate_geom::Box3 { min: at(-1.0), max: Point3::new(4.0, 5.0, 6.0) });
        let all = pieces(&[triangle.clone(), round, cuboid, triangle]);
        assert_eq!(all.len(), 3);
        assert!(matches!(all[0], Piece::Round { ends_mm: [[0.0, 0.0, 1.0], [3.0, 0.0, 1.0]], .. }));
        assert!(matches!(all[1], Piece::Box { corners_mm: [[-1.0, 0.0, 1.0], [4.0, 5.0, 6.0]] }));
        assert!(matches!(&all[2], Piece::Triangles(two) if two.len() == 2));
    }
}
