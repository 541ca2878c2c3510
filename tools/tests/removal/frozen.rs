//! What is left between operations, against a cut that shares nothing with the model: tools frozen at dense steps, their shapes
//! by hand, rays through a box.
//!
//! A tool is all that is no farther than its corner radius from a core: a disc, and all above it along the axis. The moving tool
//! covers what its frozen poses cover, and no more than those grown by half of what a point moves from pose to pose. So on every
//! ray of the stock what is left must hold all that the grown tools leave and lie in what the frozen ones leave.

use crate::removal::common::{ball, flat, pose, through, toroidal, upright};
use osculate_geom::{Box3, Point3, Vec3};
use osculate_tools::removal::Swept;
use osculate_tools::removal::stock::{Blank, Resolution, Stock, StockJob};
use osculate_tools::{Cutter, Pose};
use std::collections::HashSet;

const SIZE_MM: [f64; 3] = [18.0, 14.0, 9.0];
const CELL_MM: f64 = 0.5;
/// Most that a point of a tool in the block moves from one pose to the next, mm.
const STEP_MM: f64 = 0.08;
/// Ends of stretches are good to a millionth of a millimetre of distance.
const ENDS_MM: f64 = 2e-6;

/// One tool of a program.
struct Operation {
    cutter: Cutter,
    shape: Shape,
    motions: Vec<Swept>,
}

#[derive(Clone, Copy)]
struct Shape {
    radius: f64,
    corner: f64,
}

/// A frozen tool: a core of radius `disc` from `height` above the tip on, and all within `round` of it.
struct Frozen {
    tip: Point3,
    axis: Vec3,
    disc: f64,
    height: f64,
    round: f64,
}

impl Frozen {
    /// With all of its boundary set out by `by`, or in where that is negative.
    fn new(shape: Shape, at: &Pose, by: f64) -> Self {
        let sharp = (shape.corner + by).min(0.0);
        Self {
            tip: at.tip,
            axis: at.axis.into_inner(),
            disc: shape.radius - shape.corner + sharp,
            height: shape.corner - sharp,
            round: (shape.corner + by).max(0.0),
        }
    }

    /// The stretch of a line that it covers: convex, so its least distance first and then an end to both sides.
    fn covered(&self, from: &Point3, along: &Vec3, length: f64) -> Option<[f64; 2]> {
        let w = from - self.tip;
        let (z, dz) = (w.dot(&self.axis), along.dot(&self.axis));
        let (q, dq) = (w - self.axis * z, along - self.axis * dz);
        let radius = self.disc + self.round;
        // Where the line is in the cylinder around all of it.
        let (a, b, c) = (dq.norm_squared(), q.dot(&dq), q.norm_squared() - radius * radius);
        let [mut lo, mut hi] = [0.0, length];
        if a < 1e-18 {
            if c > 0.0 {
                return None;
            }
        } else {
            let root = b * b - a * c;
            if root <= 0.0 {
                return None;
            }
            lo = f64::max(lo, (-b - root.sqrt()) / a);
            hi = f64::min(hi, (-b + root.sqrt()) / a);
        }
        if lo >= hi {
            return None;
        }
        let off = |s: f64| {
            let side = ((q + dq * s).norm() - self.disc).max(0.0);
            side.hypot((self.height - z - dz * s).max(0.0)) - self.round
        };
        let (mut l, mut r) = (lo, hi);
        for _ in 0..30 {
            let (m, n) = (l + (r - l) / 3.0, r - (r - l) / 3.0);
            if off(m) <= off(n) { r = n } else { l = m }
        }
        let inside = 0.5 * (l + r);
        if off(inside) > 0.0 {
            return None;
        }
        let end = |mut out: f64| {
            if off(out) <= 0.0 {
                return out;
            }
            let mut within = inside;
            for _ in 0..26 {
                let m = 0.5 * (within + out);
                if off(m) <= 0.0 { within = m } else { out = m }
            }
            within
        };
        Some([end(lo), end(hi)])
    }
}

/// Poses along the motions, so dense that no point within 12 mm of a tip moves farther than a step.
fn frozen(motions: &[Swept]) -> Vec<Pose> {
    let mut out = Vec::new();
    for m in motions {
        let turn = m.from.axis.dot(&m.to.axis).clamp(-1.0, 1.0).acos();
        let steps = (((m.to.tip - m.from.tip).norm() + 12.0 * turn) / STEP_MM).ceil().max(1.0);
        out.extend((0..=steps as usize).map(|k| {
            let t = k as f64 / steps;
            let axis = m.from.axis.into_inner() * (1.0 - t) + m.to.axis.into_inner() * t;
            pose((m.from.tip + (m.to.tip - m.from.tip) * t).into(), axis.into())
        }));
    }
    out
}

/// A ray through the block.
struct Ray {
    from: Point3,
    along: Vec3,
    length: f64,
}

impl Ray {
    /// Along an axis, through a point.
    fn new(axis: usize, through: &Point3) -> Self {
        let mut from = *through;
        from[axis] = 0.0;
        let mut along = Vec3::zeros();
        along[axis] = 1.0;
        Self { from, along, length: SIZE_MM[axis] }
    }

    /// What frozen tools leave of it.
    fn left(&self, tools: &[Frozen]) -> Vec<[f64; 2]> {
        let mut gone: Vec<[f64; 2]> =
            tools.iter().filter_map(|t| t.covered(&self.from, &self.along, self.length)).collect();
        gone.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let (mut left, mut at) = (Vec::new(), 0.0);
        for [a, b] in gone {
            if a > at {
                left.push([at, a]);
            }
            at = f64::max(at, b);
        }
        if at < self.length {
            left.push([at, self.length]);
        }
        left
    }
}

/// Every stretch lies in one of the others.
fn assert_within(inner: &[[f64; 2]], outer: &[[f64; 2]], ray: &Ray, what: &str) {
    for [a, b] in inner {
        let held = outer.iter().any(|[c, d]| c - ENDS_MM <= *a && *b <= d + ENDS_MM);
        assert!(held, "{what}: {a} to {b} from {:?} on, beside {outer:?}", ray.from);
    }
}

/// Cuts operation after operation and looks at what is left after each.
fn check(operations: &[Operation]) {
    let whole = Box3 { min: Point3::origin(), max: Point3::from(SIZE_MM) };
    let resolution = Resolution { cell_mm: CELL_MM, tri: true, budget_bytes: 1 << 28 };
    let mut stock = Stock::fill(&Blank::Box(whole), &resolution).expect("a box").stock;
    let (mut least, mut most) = (Vec::new(), Vec::new());
    for (k, own) in operations.iter().enumerate() {
        // As the next operation takes it.
        stock = Stock::fill(&Blank::Left(&stock), &resolution).expect("what is left").stock;
        let job = StockJob { cutter: &own.cutter, uppers: &[], motions: &own.motions, touch_mm: 1e-3 };
        let carved = stock.carve(&job, &|_| ()).expect("a good job");
        assert!(carved.volume_mm3() > 10.0, "operation {k} takes {}", carved.volume_mm3());
        let turns = own.motions.iter().any(|m| m.from.axis.dot(&m.to.axis) < 1.0 - 1e-12);
        let stray = if turns { stock.stray_mm() } else { 0.0 };
        for p in frozen(&own.motions) {
            least.push(Frozen::new(own.shape, &p, -ENDS_MM - stray));
            most.push(Frozen::new(own.shape, &p, 0.5 * STEP_MM + ENDS_MM + stray));
        }
        let ends = stock.ends();
        let mut seen: [HashSet<[u64; 3]>; 3] = Default::default();
        let mut at = 0;
        while at < ends.len() {
            let axis = [0, 1, 2].into_iter().find(|j| ends[at + 1][*j] > ends[at][*j]).expect("a stretch");
            let ray = Ray::new(axis, &ends[at]);
            let mut own = Vec::new();
            while at < ends.len()
                && Ray::new(axis, &ends[at]).from == ray.from
                && ends[at + 1][axis] > ends[at][axis]
            {
                own.push([ends[at][axis], ends[at + 1][axis]]);
                at += 2;
            }
            assert_within(&own, &ray.left(&least), &ray, "stock that the tools have taken");
            assert_within(&ray.left(&most), &own, &ray, "no stock where no tool was");
            seen[axis].insert([0, 1, 2].map(|j| ray.from[j].to_bits()));
        }
        // Nothing goes through the bottom, so that every upright ray has been looked at.
        let [nx, ny] = [0, 1].map(|j| (SIZE_MM[j] / CELL_MM).ceil() as usize);
        assert_eq!(seen[2].len(), nx * ny);
        assert!(seen[0].len() > 100 && seen[1].len() > 100);
        between(&ends, &least);
    }
}

/// Between its rays the stock is as fine as its cells: from the surface that frozen tools leave, on a grid of its own, some end is
/// no farther than the side of a cell.
fn between(ends: &[Point3], tools: &[Frozen]) {
    let mut worst = 0.0f64;
    let (mut x, mut seen) = (0.17, 0);
    while x < SIZE_MM[0] {
        let mut y = 0.23;
        while y < SIZE_MM[1] {
            let ray = Ray::new(2, &Point3::new(x, y, 0.0));
            for end in ray.left(tools).into_iter().flatten().filter(|z| *z > 0.0 && *z < SIZE_MM[2]) {
                let p = ray.from + ray.along * end;
                let near = ends.iter().map(|e| (e - p).norm_squared()).fold(f64::INFINITY, f64::min);
                worst = worst.max(near.sqrt());
                seen += 1;
            }
            y += 0.71;
        }
        x += 0.67;
    }
    assert!(seen > 50 && worst < CELL_MM, "{worst} mm at {seen} places");
}

fn operation(cutter: Cutter, shape: [f64; 2], motions: Vec<Swept>) -> Operation {
    Operation { cutter, shape: Shape { radius: shape[0], corner: shape[1] }, motions }
}

/// A pocket of a flat end with a ramp into it.
fn roughing() -> Operation {
    let at = |x, y, z| upright(x, y, z);
    let poses = [
        at(4.0, 4.1, 12.0),
        at(4.0, 4.1, 8.0),
        at(13.3, 4.1, 6.2),
        at(13.3, 9.7, 6.2),
        at(5.1, 9.7, 6.2),
        at(5.1, 6.9, 6.2),
        at(13.3, 6.9, 4.9),
    ];
    operation(flat(6.0), [3.0, 0.0], through(&poses))
}

#[test]
fn three_tools_one_after_the_other_along_z() {
    let semi =
        [upright(-4.0, 11.2, 7.1), upright(9.0, 10.4, 4.3), upright(15.6, 4.2, 3.6), upright(15.6, 1.0, 7.9)];
    // A wave along and across what the two before left.
    let wave: Vec<Pose> = (0..24)
        .map(|k| {
            let t = f64::from(k) / 23.0;
            upright(1.0 + 16.0 * t, 7.0 + 3.5 * (5.0 * t).sin(), 3.4 + 1.2 * (9.0 * t).cos())
        })
        .collect();
    check(&[
        roughing(),
        operation(toroidal(5.0, 1.5), [2.5, 1.5], through(&semi)),
        operation(ball(4.0), [2.0, 2.0], through(&wave)),
    ]);
}

#[test]
fn tilted_and_turning_tools_after_one_along_z() {
    // Fixed, leaning 25 degrees, so that it cuts under.
    let (s, c) = 25f64.to_radians().sin_cos();
    let leaning =
        [[1.0, 3.0, 4.2], [10.0, 5.5, 3.1], [16.0, 12.0, 5.0]].map(|p| pose(p, [-0.6 * s, 0.8 * s, c]));
    let under = [[3.0, 12.5, 5.9], [14.0, 12.5, 4.4]].map(|p| pose(p, [0.0, s, c]));
    let turning = [
        pose([4.0, 2.2, 4.5], [0.3, 0.1, 1.0]),
        pose([9.0, 6.0, 2.8], [-0.2, 0.35, 1.0]),
        pose([14.5, 8.0, 3.9], [-0.4, -0.3, 1.0]),
    ];
    check(&[
        roughing(),
        operation(ball(4.0), [2.0, 2.0], through(&leaning)),
        operation(flat(3.0), [1.5, 0.0], through(&under)),
        operation(toroidal(4.0, 0.8), [2.0, 0.8], through(&turning)),
    ]);
}
