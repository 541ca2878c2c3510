//! What carving found: volumes, work block by block, collisions.

use crate::removal::Body;
use osculate_geom::{Point3, Vec3};

/// A volume seen along every direction of rays.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Volume {
    /// Mean over the directions, mm3.
    pub mm3: f64,
    /// Range over the directions, mm3; 0 for a single one.
    pub spread_mm3: f64,
}

impl Volume {
    pub(super) fn of(each: impl Iterator<Item = f64>) -> Self {
        let all: Vec<f64> = each.collect();
        let (lo, hi) =
            all.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
        let sum = all.iter().fold(0.0, |s, x| s + x);
        Self { mm3: sum / all.len().max(1) as f64, spread_mm3: (hi - lo).max(0.0) }
    }
}

/// What one motion of the cutter took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Work {
    /// Index of the motion.
    pub motion: u32,
    /// Its block.
    pub block: u32,
    /// Volume, mm3.
    pub volume_mm3: f64,
    /// Mean section of the chip across the tip's way, mm2: volume over its length; 0 where the tip stands still.
    pub section_mm2: f64,
    /// Angle around the axis over which the cutter met material, rad, in steps of a sixty-fourth of a turn.
    pub arc_rad: f64,
    /// Lowest and highest place on the cutter that met material, mm above the tip.
    pub height_mm: [f64; 2],
}

/// Something that is not to cut met material.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Collision {
    /// Index of the motion.
    pub motion: u32,
    /// Its block.
    pub block: u32,
    /// What met it: the cutter only in rapids.
    pub body: Body,
    /// Whether it was a rapid.
    pub rapid: bool,
    /// Volume, mm3.
    pub volume_mm3: f64,
    /// Longest stretch taken from a ray, mm.
    pub deepest_mm: f64,
    /// The middle of that stretch.
    pub at: Point3,
}

/// What a path did to the stock.
#[derive(Clone, Debug, PartialEq, Default)]
#[non_exhaustive]
pub struct Carved {
    /// What cutting motions took, in the order of the path; those that took nothing are left out.
    pub work: Vec<Work>,
    /// What met material and is not to, in the order of the path.
    pub collisions: Vec<Collision>,
}

impl Carved {
    /// Adds what a tool did whose motions begin at `first` of the whole path, after all before.
    pub(crate) fn follow(&mut self, mut later: Self, first: usize) {
        // Paths of more motions than are numbered were refused.
        let by = first as u32;
        later.work.iter_mut().for_each(|w| w.motion += by);
        later.collisions.iter_mut().for_each(|c| c.motion += by);
        self.work.append(&mut later.work);
        self.collisions.append(&mut later.collisions);
    }

    /// The whole volume that cutting motions took, mm3.
    #[must_use]
    pub fn volume_mm3(&self) -> f64 {
        self.work.iter().map(|w| w.volume_mm3).fold(0.0, |a, b| a + b)
    }
}

/// What one body of one motion took from one direction's rays in some tiles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bite {
    pub motion: u32,
    pub body: u8,
    pub volume: f64,
    /// Sixty-fourths of a turn around the axis, one bit each.
    pub sectors: u64,
    pub height: [f64; 2],
    pub deepest: f64,
    pub at: Point3,
}

/// Sectors around the axis in which material is noted.
pub(super) const SECTORS: f64 = 64.0;
/// Tangents of the angles at which the sectors of an eighth of a turn end.
const ENDS: [f64; 7] = [
    0.098_491_403_357_164_25,
    0.198_912_367_379_658,
    0.303_346_683_607_342_4,
    0.414_213_562_373_095_03,
    0.534_511_135_950_791_6,
    0.668_178_637_919_298_9,
    0.820_678_790_828_660_5,
];

/// The sector of a direction, by comparing: a fraction of what the angle would cost.
fn sector(x: f64, y: f64) -> u32 {
    let (a, b) = (x.abs(), y.abs());
    let (low, high) = (a.min(b), a.max(b));
    // Directions without length count as along x.
    let eighth = ENDS.iter().filter(|t| low > **t * high).count() as u32;
    // From x towards y within a quarter, then around.
    let quarter = if b > a { 15 - eighth } else { eighth };
    match (x >= 0.0, y >= 0.0) {
        (true, true) => quarter,
        (false, true) => 31 - quarter,
        (false, false) => 32 + quarter,
        (true, false) => 63 - quarter,
    }
}

impl Bite {
    pub fn none(motion: u32, body: u8) -> Self {
        let height = [f64::INFINITY, f64::NEG_INFINITY];
        Self { motion, body, volume: 0.0, sectors: 0, height, deepest: 0.0, at: Point3::origin() }
    }

    /// Notes a stretch of material that was taken: its length, its middle, and where on the body, as ahead, left and up
    /// from the tip, the middle was met.
    pub fn note(&mut self, length: f64, middle: impl Fn() -> Point3, met: &Vec3) {
        self.volume += length;
        if length > self.deepest {
            (self.deepest, self.at) = (length, middle());
        }
        self.height = [self.height[0].min(met.z), self.height[1].max(met.z)];
        self.sectors |= 1u64 << sector(met.x, met.y);
    }

    pub fn merge(&mut self, other: &Self) {
        self.volume += other.volume;
        self.sectors |= other.sectors;
        self.height = [self.height[0].min(other.height[0]), self.height[1].max(other.height[1])];
        if other.deepest > self.deepest {
            (self.deepest, self.at) = (other.deepest, other.at);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sectors are those of the angle, all sixty-four of them, wherever no rounding decides.
    #[test]
    fn sectors_go_around() {
        let mut seen = 0u64;
        for k in 0..640 {
            let angle = (f64::from(k) + 0.5) * std::f64::consts::TAU / 640.0;
            let wanted = (angle / std::f64::consts::TAU * SECTORS) as u32;
            for size in [1e-6, 1.0, 1e6] {
                assert_eq!(sector(size * angle.cos(), size * angle.sin()), wanted, "{angle}");
            }
            seen |= 1 << wanted;
        }
        assert_eq!(seen, u64::MAX);
    }
}
