//! The faces of a part as points that a tool keeps out of.
//!
//! Depth is measured along the normals of faces, as verification does: a point sunk by what is accepted lies in the tool
//! where the tool goes deeper than that. The side of a tool that is hardly in the edge of a face goes deep along its normal between two
//! points, so that it keeps off the points of other faces but for those next to what it machines.

use crate::plan::Named;
use crate::plan::samples::{Wanted, samples};
use osculate_geom::{Box3, Point3};
use osculate_tools::Cutter;
use osculate_tools::reach::{ObstacleKind, ObstaclePoint, Obstacles};
use osculate_tools::removal::{Sample, SamplingError};
use std::collections::HashSet;

/// Most points over all faces, and fewest of one.
const MOST: f64 = 5e5;
const FEWEST: usize = 200;
/// Points stand no closer than lets a ball go deeper between them by this part of what it may.
const HIDDEN: f64 = 0.2;
/// Where they stand so far apart that it may go deeper by more than what it may they are sunk the less; by this part of it at least, as
/// the tool touches the face.
const LEAST_SUNK: f64 = 0.2;
/// Edges sharper than this part of the tool's radius count as so round.
const SHARP: f64 = 0.1;
/// What is kept from points that are not next to what is machined, of their spacing: half the side of a cell.
const ADDED: f64 = 0.5;

/// Faces around a tool.
#[derive(Clone, Copy)]
pub struct Around<'a> {
    /// Faces to machine.
    pub faces: &'a [Named<'a>],
    /// All others, which a tool that touches the part elsewhere keeps off.
    pub check: &'a [Named<'a>],
    /// The tool's end.
    pub cutter: &'a Cutter,
    /// How deep it may go into faces along their normals, mm.
    pub gouge_mm: f64,
    /// Raw material that is left: the cutter takes it, its holder must not meet it.
    pub left: Left<'a>,
}

/// Raw material that is left, as points of its surface.
#[derive(Clone, Copy, Debug, Default)]
pub struct Left<'a> {
    /// The points.
    pub points: &'a [Point3],
    /// How far they are apart, mm.
    pub apart_mm: f64,
}

impl Left<'_> {
    /// The owner of its points among obstacles: none of the faces.
    pub const OWNER: u32 = u32::MAX;

    /// The points as obstacles.
    pub(crate) fn obstacles(&self) -> impl Iterator<Item = ObstaclePoint> + '_ {
        self.points.iter().map(|p| ObstaclePoint { point: *p, owner: Self::OWNER, kind: ObstacleKind::Stock })
    }

    /// What a holder keeps from the points, mm.
    pub(crate) const fn keep_mm(&self) -> f64 {
        ADDED * self.apart_mm
    }
}

/// Points of faces, and what the tool keeps from those that are not next to what it machines.
#[derive(Default)]
#[non_exhaustive]
pub struct Surroundings {
    /// The points, each with the place of its face among those to machine and then all others. Those that the tool may touch are sunk
    /// into their faces.
    pub obstacles: Obstacles,
    /// What is kept from the others, mm.
    pub keep_mm: f64,
    /// What is mounted above the cutter keeps from raw material, mm.
    pub stock_mm: f64,
}

/// A sample sunk by so much along its normal.
pub(crate) fn sunk(s: &Sample, by_mm: f64) -> ObstaclePoint {
    let point = s.point - s.normal.into_inner() * by_mm;
    ObstaclePoint { point, owner: s.face, kind: ObstacleKind::Part }
}

/// Cells of a grid with a point of what is machined in them.
struct Touched {
    side: f64,
    cells: HashSet<[i64; 3]>,
    /// Around all of them.
    within: Box3,
}

impl Touched {
    fn cell(&self, p: &Point3) -> [i64; 3] {
        // Cells of a part are far fewer than whole numbers.
        [p.x, p.y, p.z].map(|x| (x / self.side).floor() as i64)
    }

    fn new(samples: &[Sample], side: f64) -> Self {
        let mut out = Self { side, cells: HashSet::new(), within: Box3::empty() };
        for s in samples {
            let cell = out.cell(&s.point);
            out.cells.insert(cell);
            out.within.add(&s.point);
        }
        out.within = out.within.grown(2.0 * side);
        out
    }

    /// Whether a point is in or next to one of the cells. The cells around are looked up here, not noted there: most points of a part
    /// are machined and few are asked for.
    fn holds(&self, p: &Point3) -> bool {
        if !(0..3).all(|k| (self.within.min[k]..=self.within.max[k]).contains(&p[k])) {
            return false;
        }
        let [x, y, z] = self.cell(p);
        (0..27).any(|c| self.cells.contains(&[x + c / 9 - 1, y + c / 3 % 3 - 1, z + c % 3 - 1]))
    }
}

impl Surroundings {
    /// The points of faces.
    ///
    /// # Errors
    /// A face that cannot be sampled, by its name.
    pub fn of(around: &Around<'_>) -> Result<Self, (String, SamplingError)> {
        // Between two points on a plane a ball comes deeper by s^2 / 8 r, a rounded edge too.
        let round_mm = around.cutter.corner_mm().max(SHARP * around.cutter.radius_mm());
        let spacing_mm = (8.0 * round_mm * HIDDEN * around.gouge_mm).sqrt();
        let all: Vec<&Named<'_>> = around.faces.iter().chain(around.check).collect();
        let found = samples(&all, Wanted { spacing_mm, most: MOST, fewest: FEWEST })?;
        let [machined, others] = {
            let mut found = found;
            let others = found.split_off(around.faces.len());
            [found, others]
        };
        let apart = others.iter().map(|f| f.density.spacing_mm).fold(0.0, f64::max);
        let own: Vec<Sample> = machined.iter().flat_map(|f| &f.samples).copied().collect();
        let touched = Touched::new(&own, 0.5 * around.cutter.radius_mm());
        // How deep a tool comes between points is known by how far they are apart.
        let deeper = |apart_mm: f64| apart_mm * apart_mm / (8.0 * round_mm);
        let by_mm = |apart_mm: f64| {
            let more = deeper(apart_mm) - around.gouge_mm;
            (around.gouge_mm - more.max(0.0)).max(LEAST_SUNK * around.gouge_mm)
        };
        let sunk = |s: &Sample| sunk(s, around.gouge_mm);
        let other = |s: Sample| {
            if touched.holds(&s.point) {
                sunk(&s)
            } else {
                ObstaclePoint { point: s.point, owner: s.face, kind: ObstacleKind::Surroundings }
            }
        };
        let others = others.into_iter().flat_map(|f| f.samples).map(other);
        let own = machined.iter().flat_map(|f| {
            let mm = by_mm(f.density.spacing_mm);
            f.samples.iter().map(move |s| self::sunk(s, mm))
        });
        let points = own.chain(others).chain(around.left.obstacles());
        // Samples have finite coordinates, and there are far fewer than an index can hold.
        let obstacles = Obstacles::new(points).unwrap_or_default();
        Ok(Self { obstacles, keep_mm: ADDED * apart, stock_mm: around.left.keep_mm() })
    }
}
