//! Whether a point is in the material of a body.
//!
//! Far from the surface rays through its triangles say so: an odd number of crossings is inside. Nearer than what the triangles are
//! off the faces the foot on the face itself decides by the outward normal.

use super::sheet::Sheet;
use super::soup::{Patch, Soup};
use crate::mesh::tessellate;
use crate::sides::Tree;
use crate::trimmed::TrimmedSurface;
use osculate_geom::{Box3, Point3, Side, Uv, Vec3, uv};

/// Directions of the rays; none is along an axis or a plane that parts like.
const RAYS: [[f64; 3]; 5] = [
    [0.269_387_0, 0.661_230_1, 0.700_140_3],
    [-0.743_901_2, 0.117_702_3, 0.657_843_1],
    [0.512_330_7, -0.834_110_9, 0.204_371_8],
    [-0.331_902_6, -0.287_110_4, -0.898_541_2],
    [0.871_230_4, 0.402_170_9, -0.281_203_7],
];

/// What is said of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Where {
    /// In the material by more than the tolerance.
    Inside,
    /// Outside by more than the tolerance.
    Outside,
    /// On the surface, or nothing says.
    Near,
}

/// A face of a body with the side on which the outside is, relative to its normal.
#[derive(Clone, Copy)]
pub(super) struct Wall<'a> {
    /// Number of the face.
    pub(super) face: usize,
    pub(super) surface: &'a TrimmedSurface,
    pub(super) side: Side,
}

/// A body: its faces, and triangles of them.
pub(super) struct Solid<'a> {
    pub(super) walls: Vec<Wall<'a>>,
    pub(super) soup: Soup,
    pub(super) around: Box3,
    rays: Tree,
    chord_mm: f64,
}

/// The triangles of a face, which is named by a number.
pub(super) fn patches(face: usize, surface: &TrimmedSurface, chord_mm: f64) -> Vec<Patch> {
    let mesh = tessellate(surface, chord_mm, None);
    let corner = |k: u32| Point3::from(mesh.positions[k as usize]);
    let at = |k: u32| -> Uv {
        let [u, v] = mesh.uvs[k as usize];
        uv(u, v)
    };
    mesh.triangles.iter().map(|t| Patch { face, at: t.map(at), corners: t.map(corner) }).collect()
}

impl<'a> Solid<'a> {
    /// A body with triangles that are at most about `chord_mm` off its faces. Patches carry the index of the wall.
    pub(super) fn new(walls: Vec<Wall<'a>>, chord_mm: f64) -> Self {
        let all: Vec<Patch> =
            walls.iter().enumerate().flat_map(|(k, w)| patches(k, w.surface, chord_mm)).collect();
        let around = Box3::around(all.iter().flat_map(|p| &p.corners)).grown(chord_mm);
        let rays = Tree::new(all.iter().map(|p| p.corners).collect());
        Self { walls, soup: Soup::new(all), around, rays, chord_mm }
    }

    /// Distance from the triangles within which only the faces themselves say where a point is, mm.
    pub(super) fn doubt_mm(&self) -> f64 {
        2.0 * self.chord_mm
    }

    /// Where a point is, to a tolerance that is no more than what the triangles are off.
    pub(super) fn tell(&self, p: &Point3, tolerance_mm: f64) -> Where {
        let Some(near) = self.soup.nearest(p) else { return Where::Near };
        let doubt_mm = self.doubt_mm();
        if near.distance_mm > doubt_mm {
            let odd = |d: &[f64; 3]| self.rays.crossings(p, &Vec3::from(*d).normalize(), 0.0) % 2 == 1;
            let votes = RAYS.iter().filter(|d| odd(d)).count();
            return if 2 * votes > RAYS.len() { Where::Inside } else { Where::Outside };
        }
        let wall = &self.walls[self.soup.patches[near.patch].face];
        let sheet = Sheet::new(wall.surface);
        let Some((at, foot)) = sheet.foot(p, near.at, 1e-3 * tolerance_mm) else { return Where::Near };
        let far = (p - foot).norm() > near.distance_mm + doubt_mm;
        if far || !osculate_geom::Surface::contains(wall.surface, at) {
            return Where::Near;
        }
        let Some(normal) = sheet.normal(at) else { return Where::Near };
        let height_mm = (p - foot).dot(&normal) * wall.side.sign();
        if height_mm < -tolerance_mm {
            Where::Inside
        } else if height_mm > tolerance_mm {
            Where::Outside
        } else {
            Where::Near
        }
    }
}
