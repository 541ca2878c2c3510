//! A block as heights over a fine lattice, cut by a flat tool that stands upright: it shares no code with the planner.

use osculate_geom::Box3;
use osculate_tools::cl::{ClPath, Motion};

/// Distance of columns, mm.
const CELL: f64 = 0.2;
/// Positions along a move are this far apart, mm.
const STEP: f64 = 0.1;
/// What the tool's rim touches does not count, mm.
const RIM: f64 = 0.1;

pub struct Heights {
    lo: [f64; 2],
    n: [usize; 2],
    z: Vec<f64>,
    radius_mm: f64,
}

/// What a path did.
#[derive(Debug, Default)]
pub struct Done {
    /// Taken in all, mm3.
    pub taken_mm3: f64,
    /// Deepest that a rapid move went into material, mm.
    pub rapid_mm: f64,
    /// Deepest that a move down, steeper than is allowed, went into material, mm.
    pub dive_mm: f64,
    /// Greatest volume rate of a feed move longer than the tool's radius, mm3/min.
    pub rate_mm3_min: f64,
    /// Length of feed moves, mm.
    pub feed_mm: f64,
}

impl Heights {
    pub fn of(block: &Box3, radius_mm: f64) -> Self {
        let lo = [block.min.x + 0.5 * CELL, block.min.y + 0.5 * CELL];
        let n = [block.max.x - block.min.x, block.max.y - block.min.y].map(|s| (s / CELL).round() as usize);
        Self { lo, n, z: vec![block.max.z; n[0] * n[1]], radius_mm }
    }

    /// The columns under the tool at a place, with their distance from its axis.
    fn under(&self, at: [f64; 2]) -> Vec<(usize, f64)> {
        let range = |a: usize| {
            let lo = ((at[a] - self.radius_mm - self.lo[a]) / CELL).ceil().max(0.0) as usize;
            let hi = ((at[a] + self.radius_mm - self.lo[a]) / CELL).floor().max(-1.0) + 1.0;
            lo..(hi as usize).min(self.n[a])
        };
        let mut out = Vec::new();
        for j in range(1) {
            for i in range(0) {
                let [x, y] = [self.lo[0] + CELL * i as f64, self.lo[1] + CELL * j as f64];
                let rho = (x - at[0]).hypot(y - at[1]);
                if rho <= self.radius_mm {
                    out.push((j * self.n[0] + i, rho));
                }
            }
        }
        out
    }

    /// Runs a path; moves down steeper than the ramp are dives.
    pub fn run(&mut self, path: &ClPath, ramp_rad: f64) -> Done {
        let mut done = Done::default();
        for pair in path.moves.windows(2) {
            let ([a, b], motion) = ([pair[0].pose.tip, pair[1].pose.tip], pair[1].motion);
            let way = b - a;
            let steep = -way.z > 1.001 * ramp_rad.tan() * way.x.hypot(way.y) + 1e-9;
            let steps = (way.norm() / STEP).ceil().max(1.0) as usize;
            let mut taken = 0.0;
            for s in 0..=steps {
                let p = a + way * (s as f64 / steps as f64);
                for (k, rho) in self.under([p.x, p.y]) {
                    let over = self.z[k] - p.z;
                    if over <= 0.0 {
                        continue;
                    }
                    if rho < self.radius_mm - RIM {
                        match motion {
                            Motion::Rapid => done.rapid_mm = done.rapid_mm.max(over),
                            Motion::Feed(_) if steep => done.dive_mm = done.dive_mm.max(over),
                            Motion::Feed(_) => {}
                        }
                    }
                    taken += over * CELL * CELL;
                    self.z[k] = p.z;
                }
            }
            done.taken_mm3 += taken;
            if let Motion::Feed(feed) = motion {
                done.feed_mm += way.norm();
                if way.norm() > self.radius_mm {
                    done.rate_mm3_min = done.rate_mm3_min.max(taken * feed / way.norm());
                }
            }
        }
        done
    }
}
