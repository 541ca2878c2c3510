//! What to rough, and the pieces of rows that a layer takes.

use crate::plan::{Linked, Links, Named, Passes, PlanError};
use osculate_geom::{Box3, Point3, Unit3, Vec3};
use osculate_tools::Cutter;

/// What to rough.
#[derive(Clone, Copy)]
pub struct RoughTask<'a> {
    /// Faces to machine.
    pub faces: &'a [Named<'a>],
    /// Faces that the tool must not come nearer to than the allowance either.
    pub check: &'a [Named<'a>],
    /// The cutter: a ball, flat or toroidal end.
    pub cutter: &'a Cutter,
    /// The tool axis, from the tip to the holder.
    pub axis: Unit3,
    /// The way of the rows, brought into the plane across the axis.
    pub feed: Vec3,
    /// Box around the raw material.
    pub blank: Box3,
    /// How much is taken and left.
    pub sizes: Sizes,
    /// How the tool goes between rows and layers.
    pub links: &'a Links,
    /// Told how far the work is, 0 to 1.
    pub progress: &'a (dyn Fn(f64) + Sync),
}

/// How much a roughing takes at once and leaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sizes {
    /// Deepest cut along the axis, mm.
    pub stepdown_mm: f64,
    /// Distance of rows, mm.
    pub stepover_mm: f64,
    /// What is left on the faces, mm; zero or more.
    pub allowance_mm: f64,
    /// Steepest way down into material, rad.
    pub ramp_rad: f64,
    /// Deviation of the path's pieces from the allowance, mm.
    pub chord_mm: f64,
}

impl Sizes {
    pub(super) fn check(&self) -> Result<(), PlanError> {
        for (what, got, least) in [
            ("stepdown_mm", self.stepdown_mm, 0.0),
            ("stepover_mm", self.stepover_mm, 0.0),
            ("chord_mm", self.chord_mm, 0.0),
            ("ramp", self.ramp_rad, 0.0),
            ("allowance_mm", self.allowance_mm, -f64::MIN_POSITIVE),
        ] {
            if !(got > least && got.is_finite()) {
                return Err(PlanError::Tolerance { what, got });
            }
        }
        Ok(())
    }
}

/// Layers, and how they are joined.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Roughing {
    /// Rows in the order of cutting, each a pass.
    pub passes: Passes,
    /// The whole path.
    pub linked: Linked,
    /// Heights of the layers along the axis, from the top, mm.
    pub layers: Vec<f64>,
}

/// A place of a row: along it and the height of the tip, mm.
pub(super) type Place = [f64; 2];

/// A stretch of a row on a layer.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    /// Position of the row across the feed, mm.
    pub y: f64,
    pub places: Vec<Place>,
}

/// Greatest height of a box along the axis.
pub(super) fn top_mm(b: &Box3, axis: &Unit3) -> f64 {
    let ends = [b.min, b.max];
    (0..8)
        .map(|k| Point3::new(ends[k & 1].x, ends[k >> 1 & 1].y, ends[k >> 2].z).coords.dot(axis))
        .fold(f64::NEG_INFINITY, f64::max)
}

/// Where a line of heights is on a level between two of its places.
fn crossing(a: Place, b: Place, level: f64) -> Place {
    [a[0] + (b[0] - a[0]) * (level - a[1]) / (b[1] - a[1]), level]
}

/// The parts of a line of heights that lie below a level, each of two places at least.
pub(super) fn below(run: &[Place], level: f64) -> Vec<Vec<Place>> {
    let mut out: Vec<Vec<Place>> = Vec::new();
    let mut part: Vec<Place> = Vec::new();
    for (k, p) in run.iter().enumerate() {
        let before = k.checked_sub(1).map(|k| run[k]);
        let inside = p[1] < level;
        if let Some(b) = before
            && (b[1] < level) != inside
        {
            part.push(crossing(b, *p, level));
        }
        if inside {
            part.push(*p);
        } else if !part.is_empty() {
            out.push(std::mem::take(&mut part));
        }
    }
    out.push(part);
    out.retain(|p| p.len() > 1);
    out
}

/// A line of heights held above a level.
pub(super) fn raised(run: &[Place], level: f64) -> Vec<Place> {
    let mut out: Vec<Place> = Vec::with_capacity(run.len());
    let add = |out: &mut Vec<Place>, p: Place| {
        // Between two others on the level a place says nothing.
        let n = out.len();
        if n >= 2 && out[n - 1][1] == level && out[n - 2][1] == level && p[1] == level {
            out[n - 1] = p;
        } else {
            out.push(p);
        }
    };
    for (k, p) in run.iter().enumerate() {
        if let Some(b) = k.checked_sub(1).map(|k| run[k])
            && (b[1] < level) != (p[1] < level)
        {
            add(&mut out, crossing(b, *p, level));
        }
        add(&mut out, [p[0], p[1].max(level)]);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_heights_is_cut_and_held() {
        let run = [[0.0, 4.0], [2.0, 0.0], [4.0, 4.0], [6.0, 0.0]];
        assert_eq!(
            below(&run, 2.0),
            vec![vec![[1.0, 2.0], [2.0, 0.0], [3.0, 2.0]], vec![[5.0, 2.0], [6.0, 0.0]]]
        );
        assert_eq!(raised(&run[..3], 2.0), vec![[0.0, 4.0], [1.0, 2.0], [3.0, 2.0], [4.0, 4.0]]);
    }
}
