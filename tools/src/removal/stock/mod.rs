//! Stock as a tri-dexel model: what roughing takes away, block by block, and what runs into the material.
//!
//! Rays stand along one direction or along x, y and z. Each keeps the stretches of it that are material. [`Stock::carve`]
//! moves cutter, shank and holder through the path: on every ray a moving body covers an interval that is found exactly
//! (to the tolerances below), not from frozen positions, and which is taken away.
//!
//! *Errors.* Ends of stretches are good to [`ENDS_MM`] of distance to the tool; over a turning motion the straight pieces
//! that it is taken apart into stray by at most [`Stock::stray_mm`], to both sides. What dominates is that space is looked
//! at along rays: the volume of a body is the sum of stretches times the square of the cell. Rays are set off from the
//! middle of their cells row by row by a golden-section sequence, so that a wall along the rays falls on each side of a ray
//! in the right share of the rows: its place counts to the cell over the number of rows, not to the cell. The three
//! directions are three nearly independent sums; [`Volume::mm3`] is their mean, [`Volume::spread_mm3`] their range.
//!
//! *Memory.* Sixteen bytes a stretch and four a ray; [`Stock::fill`] makes the cells larger where a budget requires it,
//! and says so in [`Made::coarsened`].
//!
//! A block's cost does not depend on the size of the stock: rays stand in tiles, tiles ask a tree over the motions for
//! those that come near what is left in them.

mod beyond;
mod blank;
mod carve;
mod glide;
mod instant;
mod lattice;
mod mesh;
mod query;
mod rays;
mod report;
mod saved;
mod world;

pub use blank::{Blank, BlankError, Made, Resolution};
pub use mesh::Mesh;
pub use report::{Carved, Collision, Volume, Work};
pub use saved::{SavedError, sum_of};
pub use world::{StockJob, Upper};

use lattice::{Lattice, Tile};
use osculate_geom::{Box3, Point3};

/// Accuracy of the ends of stretches, mm of distance to the tool.
pub const ENDS_MM: f64 = 1e-6;
/// Most that the straight pieces of a turning motion stray from it where cells are fine, mm ...
pub const TURNING_MM: f64 = 1e-3;
/// ... and of the side of coarse ones.
pub const TURNING_OF_CELL: f64 = 0.02;

/// The material that is left.
#[derive(Clone, Debug, PartialEq)]
pub struct Stock {
    bounds: Box3,
    cell: f64,
    /// One for each direction.
    fields: Vec<Field>,
}

/// All rays of one direction.
#[derive(Clone, Debug, PartialEq)]
struct Field {
    lattice: Lattice,
    tiles: Vec<Tile>,
}

impl Stock {
    /// The sides of cells, mm.
    #[must_use]
    pub const fn cell_mm(&self) -> f64 {
        self.cell
    }

    /// Most that the straight pieces of a turning motion stray from it, mm.
    #[must_use]
    pub fn stray_mm(&self) -> f64 {
        TURNING_MM.max(TURNING_OF_CELL * self.cell)
    }

    /// The box that the rays fill.
    #[must_use]
    pub const fn bounds(&self) -> &Box3 {
        &self.bounds
    }

    /// The number of rays.
    #[must_use]
    pub fn rays(&self) -> usize {
        self.fields.iter().map(|f| f.lattice.rays()).sum()
    }

    /// Memory held by stretches and rays, bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.fields.iter().flat_map(|f| &f.tiles).map(Tile::bytes).sum()
    }

    /// The volume left.
    #[must_use]
    pub fn volume(&self) -> Volume {
        let each = self.fields.iter().map(|f| {
            let length: f64 = f.tiles.iter().map(Tile::length).fold(0.0, |a, b| a + b);
            length * f.lattice.area()
        });
        Volume::of(each)
    }

    /// Both ends of every stretch, for pictures: points of the surface of the material.
    #[must_use]
    pub fn ends(&self) -> Vec<Point3> {
        let mut out = Vec::new();
        for f in &self.fields {
            for (k, tile) in f.tiles.iter().enumerate() {
                f.lattice.each_ray(k, |ray, at| {
                    for span in tile.of(ray) {
                        out.extend(span.map(|s| f.lattice.point(at, s)));
                    }
                });
            }
        }
        out
    }
}
