//! The feed of a roughing: the volume that the cutter takes is kept under a cap from place to place [R97, eq. 27].
//!
//! At a feed f the tool takes f times the section of material that it moves into, which is the rate of its engagement per length of its
//! way. Feeds are steps of a twentieth, so that a program does not say a new one in every block.

use super::columns::Columns;
use super::grid::Grid;
use crate::engagement::{Fineness, Outline};
use osculate_geom::{Point3, Vec3};
use osculate_tools::sweep::Moving;
use osculate_tools::{Cutter, Pose};

/// Meridians of the cutter that are asked for material.
const MERIDIANS: usize = 40;
/// Steps along a meridian, of the step down.
const STEP: f64 = 0.125;
/// A cutter is asked as far up as this many steps down: nothing stands higher beside it as a rule.
const HIGH: f64 = 2.0;
/// Feeds are powers of this quotient below the job's.
const QUOTIENT: f64 = 0.95;
/// The slowest feed, of the job's: slower the tool would rub.
const SLOWEST: f64 = 0.05;

/// How fast a tool goes.
pub(super) struct Pace {
    outline: Outline,
    /// Greatest volume rate, mm3/min.
    most: f64,
}

impl Pace {
    pub fn new(cutter: &Cutter, stepdown_mm: f64, most: f64) -> Self {
        let high = HIGH * stepdown_mm + cutter.corner_mm();
        let short = cutter.shortened(high.min(cutter.length_mm())).unwrap_or(*cutter);
        let fineness = Fineness { meridians: MERIDIANS, step_mm: STEP * stepdown_mm };
        Self { outline: Outline::new(&short, fineness), most }
    }

    /// Whether there is a cap at all.
    pub const fn is_capped(&self) -> bool {
        self.most.is_finite()
    }

    /// The section that the tool moves into from a place along a way, mm2.
    pub fn section_mm2(&self, (columns, grid): (&Columns, &Grid), at: [f64; 3], way: [f64; 3]) -> f64 {
        let Some(tip_rate) = Vec3::from(way).try_normalize(0.0) else { return 0.0 };
        // The frame's own coordinates serve as well as the part's.
        let pose = Pose { tip: Point3::from(at), axis: Vec3::z_axis() };
        let moving = Moving { pose, tip_rate, turn: Vec3::zeros() };
        let depth = |p: &Point3| columns.depth_mm(grid, [p.x, p.y, p.z], grid.cell);
        self.outline.engaged(&moving, depth).rate()
    }

    /// The feed on a section, of a feed that is not exceeded, mm/min.
    pub fn feed_mm_min(&self, section_mm2: f64, feed_mm_min: f64) -> f64 {
        let share = self.most / (section_mm2 * feed_mm_min);
        // An infinite share is that of air.
        if share >= 1.0 || share.is_nan() {
            return feed_mm_min;
        }
        let steps = (share.ln() / QUOTIENT.ln()).ceil();
        feed_mm_min * QUOTIENT.powf(steps).max(SLOWEST)
    }
}

/// A place with the feed of the way to it.
pub(super) type Fed = ([f64; 3], f64);

/// Leaves out places between others of the same feed that the straight way passes by within a tolerance.
pub(super) fn thinned(way: &[Fed], within_mm: f64) -> Vec<Fed> {
    /// Most places that one piece stands for.
    const MOST: usize = 200;
    let Some(first) = way.first() else { return Vec::new() };
    let mut out = vec![*first];
    let mut at = 0;
    while at + 1 < way.len() {
        let mut next = at + 1;
        while next + 1 < way.len() && next - at < MOST && way[next + 1].1 == way[at + 1].1 && {
            let (a, b) = (Vec3::from(way[at].0), Vec3::from(way[next + 1].0));
            let d = b - a;
            let long = d.norm_squared();
            way[at + 1..=next].iter().all(|(p, _)| {
                let w = Vec3::from(*p) - a;
                let t = if long > 0.0 { (w.dot(&d) / long).clamp(0.0, 1.0) } else { 0.0 };
                (w - d * t).norm() <= within_mm
            })
        } {
            next += 1;
        }
        out.push(way[next]);
        at = next;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::super::frame::Frame;
    use super::super::columns::Underside;
    use super::super::material::Material;
    use super::*;
    use osculate_geom::Box3;
    use osculate_tools::CutterSpec;
    use osculate_tools::removal::stock::{Blank, Resolution, Stock};

    /// A flat end in a full slot, half in, and with a shoulder of a third: depth times the width that it moves into.
    #[test]
    fn sections_of_slots_and_shoulders() {
        let b = Box3 { min: Point3::new(-20.0, -20.0, -10.0), max: Point3::new(20.0, 20.0, 0.0) };
        let resolution = Resolution { cell_mm: 0.4, tri: true, budget_bytes: 1 << 26 };
        let stock = Stock::fill(&Blank::Box(b), &resolution).unwrap().stock;
        let frame = Frame::new(Vec3::z_axis(), &Vec3::x());
        let grid = Grid::over([[-20.0, -20.0], [20.0, 20.0]], 0.4);
        let cutter = Cutter::try_from(CutterSpec::Flat { diameter_mm: 6.0, length_mm: 40.0 }).unwrap();
        let pace = Pace::new(&cutter, 2.0, 9000.0);
        let mut columns = Columns::of(&Material::of(&stock, None), &frame, &grid, |_| true);
        let section = |c: &Columns, at: [f64; 3]| pace.section_mm2((c, &grid), at, [1.0, 0.0, 0.0]);
        let close = |got: f64, want: f64| (got - want).abs() < 0.06 * 12.0;
        assert!(close(section(&columns, [0.0, 0.0, -2.0]), 12.0), "{}", section(&columns, [0.0, 0.0, -2.0]));
        assert_eq!(section(&columns, [0.0, 0.0, 0.5]), 0.0);
        columns.cut(&grid, &Underside::of(&cutter), [[-30.0, 0.0, -2.0], [30.0, 0.0, -2.0]]);
        for over in [1.0, 2.0, 3.0] {
            let got = section(&columns, [0.0, over, -2.0]);
            assert!(close(got, 2.0 * over), "{over}: {got}");
        }
        // 12 mm2 at 2000 mm/min would take 24000 mm3/min: no more than 9000, and no step too slow.
        let feed = pace.feed_mm_min(12.0, 2000.0);
        assert!(feed * 12.0 <= 9000.0 && feed * 12.0 > 0.95 * 0.999 * 9000.0);
        assert_eq!(pace.feed_mm_min(4.0, 2000.0), 2000.0);
        assert_eq!(pace.feed_mm_min(0.0, 2000.0), 2000.0);
    }

    #[test]
    fn a_way_keeps_its_corners_and_changes_of_feed() {
        let way: Vec<Fed> = (0..=20)
            .map(f64::from)
            .map(|k| ([k.min(10.0), (k - 10.0).max(0.0), 0.0], if k <= 4.0 { 100.0 } else { 200.0 }))
            .collect();
        let thin = thinned(&way, 0.01);
        let xy: Vec<[f64; 2]> = thin.iter().map(|(p, _)| [p[0], p[1]]).collect();
        assert_eq!(xy, [[0.0, 0.0], [4.0, 0.0], [10.0, 0.0], [10.0, 10.0]]);
    }
}
