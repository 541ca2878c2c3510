//! Where the tip is when the joints are somewhere, and how far that is off the path of the CL file.
//!
//! LinuxCNC's `xyzac-trt-kins` with both axes of rotation through the table's reference point: with the tip at (x, y, z) above
//! that point in the machine, the part sees it at `R_C R_A (x, y, z)`, where positive A and C turn the table right-handed.

use crate::interop::apart::apart;

/// Points of a CL file, mm, with the lines before them.
pub type Way = Vec<[f64; 3]>;

/// Of how many pieces ahead the nearest one is taken, and of how many behind: blocks are longer than a cycle's way.
const AHEAD: usize = 40;
const BEHIND: usize = 4;
/// Beyond this, mm, the tip is looked for on all of the path that is left: links between passes leave it in rapid.
const LOST_MM: f64 = 0.5;

/// Tips of a CL file.
pub fn way(cl: &str) -> Way {
    let point = |line: &str| {
        let mut numbers = line.strip_prefix("GOTO/")?.split(',').map(str::parse);
        let mut next = || numbers.next()?.ok();
        Some([next()?, next()?, next()?])
    };
    cl.lines().filter_map(point).collect()
}

/// A path turned by a unit quaternion i j k w.
pub fn turned(way: Way, [i, j, k, w]: [f64; 4]) -> Way {
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let turn = |p: [f64; 3]| {
        let once = cross([i, j, k], p);
        let twice = cross([i, j, k], once);
        std::array::from_fn(|n| p[n] + 2.0 * (w * once[n] + twice[n]))
    };
    way.into_iter().map(turn).collect()
}

/// The tip in the table's frame; joints X Y Z A C with X Y Z above the table's reference point, mm and deg.
pub fn tip(joints: &[f64; 5]) -> [f64; 3] {
    let [x, y, z, a, c] = *joints;
    let (sa, ca) = a.to_radians().sin_cos();
    let (sc, cc) = c.to_radians().sin_cos();
    let across = ca * y + sa * z;
    [cc * x + sc * across, -sc * x + cc * across, -sa * y + ca * z]
}

/// A walk along a path.
pub struct Walk<'a> {
    way: &'a [[f64; 3]],
    at: usize,
}

impl<'a> Walk<'a> {
    pub const fn new(way: &'a [[f64; 3]]) -> Self {
        Self { way, at: 0 }
    }

    /// How far the tip is off the path near the place where it was last, mm.
    pub fn off(&mut self, tip: &[f64; 3]) -> f64 {
        let last = self.way.len().saturating_sub(2);
        let near = self.nearest(tip, self.at.saturating_sub(BEHIND), (self.at + AHEAD).min(last));
        let found =
            if near.1 > LOST_MM { self.nearest(tip, self.at.saturating_sub(BEHIND), last) } else { near };
        self.at = found.0;
        found.1
    }

    fn nearest(&self, tip: &[f64; 3], from: usize, to: usize) -> (usize, f64) {
        let pieces = self.way.windows(2).enumerate().take(to + 1).skip(from);
        let apart = pieces.map(|(k, w)| (k, apart(tip, &w[0], &w[1])));
        apart.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((self.at, f64::INFINITY))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed forms: a right-handed quarter turn of the table by C takes the part's -y to where its x was, so the tip at +x is
    /// seen at -y; a quarter turn by A likewise takes the tip above the table to the part's +y.
    #[test]
    fn quarter_turns() {
        let near = |a: [f64; 3], b: [f64; 3]| (0..3).all(|k| (a[k] - b[k]).abs() < 1e-12);
        assert!(near(tip(&[1.0, 2.0, 3.0, 0.0, 0.0]), [1.0, 2.0, 3.0]));
        assert!(near(tip(&[1.0, 0.0, 0.0, 0.0, 90.0]), [0.0, -1.0, 0.0]));
        assert!(near(tip(&[0.0, 0.0, 1.0, 90.0, 0.0]), [0.0, 1.0, 0.0]));
    }

    /// A quarter turn about z takes x to y.
    #[test]
    fn paths_turn_with_the_part() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let [x, y, z] = turned(vec![[1.0, 0.0, 2.0]], [0.0, 0.0, half, half])[0];
        assert!(x.abs() < 1e-12 && (y - 1.0).abs() < 1e-12 && (z - 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_walk_keeps_to_its_pass() {
        let cl = "CUTTER/6\nGOTO/0,0,0,0,0,1\nRAPID\nGOTO/10,0,0\nGOTO/10,1,0\nGOTO/0,1,0\n";
        let way = way(cl);
        assert_eq!(way.len(), 4);
        let mut walk = Walk::new(&way);
        let offs = [[5.0, 0.25, 0.0], [10.0, 0.5, 0.0], [5.0, 1.0, 0.125]].map(|p| walk.off(&p));
        assert_eq!(offs, [0.25, 0.0, 0.125]);
    }
}
