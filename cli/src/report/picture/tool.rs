//! The tool at one pose, as facets of the static picture.

use super::super::data::Report;
use super::super::pack::{Bounds, finite};
use super::super::project::{Camera, DepthMap, dot, unit};
use super::super::tool_body::{Piece, outlines};
use super::paint::{Facet, shaded};

/// Facets around the tool.
const SECTORS: usize = 40;

/// A circle around the tool's axis.
pub struct Ring {
    piece: Piece,
    /// Above the tip, mm.
    pub height: f64,
    /// Points around it, mm.
    pub points: Vec<[f64; 3]>,
}

/// The tool at one pose.
pub struct Placed {
    tip: [f64; 3],
    /// Two directions across the axis and the axis.
    frame: [[f64; 3]; 3],
    outlines: Vec<(Piece, Vec<[f64; 2]>)>,
}

/// The tool of `report` at a share of its path from 0 to 1, or at the next pose after it that is among the passes: where tools are
/// changed the picture would have to hold the way there. `None` without tool, pose or share.
pub fn placed(report: &Report, share: Option<f64>) -> Option<Placed> {
    let share = share.filter(|s| s.is_finite())?;
    let poses: Vec<_> = report.poses.iter().filter(|p| finite(&p.tip_mm) && finite(&p.axis)).collect();
    let first = (share.clamp(0.0, 1.0) * poses.len().saturating_sub(1) as f64).round() as usize;
    // A tip is no farther off its contact than the tool is wide.
    let wide = report.tools.iter().map(|t| t.diameter_mm as f32).fold(0.0, f32::max);
    let room = Bounds::of(report.passes.iter().flat_map(|p| &p.points_mm));
    let is_in = |tip: &[f32; 3]| {
        let inside = |b: &Bounds, i: usize| (b.lo[i] - wide..=b.hi[i] + wide).contains(&tip[i]);
        room.as_ref().is_none_or(|b| (0..3).all(|i| inside(b, i)))
    };
    let pose =
        poses.iter().cycle().skip(first).take(poses.len()).find(|p| is_in(&p.tip_mm)).or(poses.get(first))?;
    let axis = unit(pose.axis.map(f64::from));
    let aside = if axis[0].abs() < 0.8 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let x = unit(cross(aside, axis));
    let outlines = outlines(report.tools.get(pose.tool as usize)?);
    Some(Placed { tip: pose.tip_mm.map(f64::from), frame: [x, cross(axis, x), axis], outlines })
}

impl Placed {
    fn point(&self, radius: f64, height: f64, turn: f64) -> [f64; 3] {
        let (sin, cos) = (turn * std::f64::consts::TAU).sin_cos();
        let [x, y, axis] = self.frame;
        std::array::from_fn(|i| self.tip[i] + radius * (cos * x[i] + sin * y[i]) + height * axis[i])
    }

    /// Rings along all pieces, long walls cut into pieces short enough for painting in order of depth.
    pub fn rings(&self, sectors: usize) -> Vec<Ring> {
        let mut rings = Vec::new();
        for (piece, outline) in &self.outlines {
            let widest = outline.iter().map(|p| p[0]).fold(0.0, f64::max);
            for pair in outline.windows(2) {
                let length = (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
                let steps = (length / widest.max(1e-9)).ceil().clamp(1.0, 12.0) as usize;
                for i in 0..steps {
                    let at = |k: usize| pair[0][k] + (pair[1][k] - pair[0][k]) * i as f64 / steps as f64;
                    rings.push(self.ring(*piece, [at(0), at(1)], sectors));
                }
            }
            if let Some(last) = outline.last() {
                rings.push(self.ring(*piece, *last, sectors));
            }
        }
        rings
    }

    fn ring(&self, piece: Piece, [radius, height]: [f64; 2], sectors: usize) -> Ring {
        let points = (0..sectors).map(|k| self.point(radius, height, k as f64 / sectors as f64)).collect();
        Ring { piece, height, points }
    }
}

/// What of the tool the viewer sees; drawn into `depth` too.
pub fn facets(placed: &Placed, camera: &Camera, depth: &mut DepthMap) -> Vec<Facet> {
    let rings = placed.rings(SECTORS);
    let mut facets = Vec::new();
    for pair in rings.windows(2).filter(|pair| pair[0].piece == pair[1].piece) {
        let base = match pair[0].piece {
            Piece::Cutter => [0xd9, 0xb4, 0x5b],
            Piece::Shank => [0xb4, 0xbc, 0xc6],
            Piece::Holder => [0x83, 0x8e, 0x9b],
        };
        for k in 0..SECTORS {
            let next = (k + 1) % SECTORS;
            let corners = [pair[0].points[k], pair[0].points[next], pair[1].points[next], pair[1].points[k]];
            let diagonal =
                |a: usize, b: usize| -> [f64; 3] { std::array::from_fn(|i| corners[b][i] - corners[a][i]) };
            let (u, v) = (diagonal(0, 2), diagonal(1, 3));
            let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            // The body is closed: what faces away is behind what faces the viewer.
            if dot(normal, camera.toward) <= 0.0 {
                continue;
            }
            let colour = shaded(base, 0.62 + 0.4 * camera.light(unit(normal)));
            let q = corners.map(|p| camera.project(p));
            for corners in [[q[0], q[1], q[2]], [q[0], q[2], q[3]]] {
                depth.fill(corners);
                facets.push(Facet { corners, colour });
            }
        }
    }
    facets
}
