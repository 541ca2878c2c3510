//! What a path does to a part, by brute force: the tool at frozen poses, distances from first principles.
//!
//! Nothing of the verification is used here but the list of motions: distances to the tool are written out, a ray's way into
//! it is found by ternary search and bisection, places are not its samples, and where the outcome is near a limit the place
//! of the worst is searched for.

use super::programs::{Good, Part, Tool};
use super::{DEPTH_MM, LIMITS, STOCK_MM};
use osculate_geom::{Point3, Surface, Unit3, Uv, Vec3, uv};
use osculate_tools::removal::Swept;
use rayon::prelude::*;

/// Distance of frozen poses, mm of way of any point of the tool near the part.
/// Half of it away a ball of radius 3 stands 7e-5 mm higher, and a place between two poses is no more off.
const STEP_MM: f64 = 0.04;
/// Untouched places count as this share of the scallop limit.
const UNTOUCHED: f64 = 10.0;
/// Where the worst place is within this range of its limit, its neighbourhood is searched.
const NEAR: [f64; 2] = [0.5, 2.0];
/// From column to column the first row looked at moves by so many, so that early looks are all over the patch.
const SHUFFLE: u32 = 13;
/// Places whose neighbourhoods are searched.
const SEARCHED: usize = 3;

/// A tool by its sizes alone, mm.
#[derive(Clone, Copy, Debug)]
pub struct Shape {
    pub core: f64,
    pub corner: f64,
    pub length: f64,
}

impl Shape {
    pub fn of(g: &Good, larger_mm: f64) -> Self {
        let corner = match g.recipe.tool {
            Tool::Ball => 3.0 + larger_mm,
            Tool::Toroidal => 2.0,
        };
        let core = match g.recipe.tool {
            Tool::Ball => 0.0,
            Tool::Toroidal => 3.0 + larger_mm,
        };
        Self { core, corner, length: 40.0 }
    }

    /// Distance of a point to the tool at a pose: exact outside and near the surface, negative inside.
    fn distance(&self, tip: &Point3, axis: &Vec3, p: &Point3) -> f64 {
        let w = p - tip;
        let z = w.dot(axis);
        let rho = (w - axis * z).norm();
        let (x, y) = (rho - self.core, self.corner - z);
        let end =
            if x > 0.0 && y > 0.0 { (x * x + y * y).sqrt() - self.corner } else { x.max(y) - self.corner };
        end.max(z - self.length)
    }
}

/// A frozen pose.
struct Frozen {
    tip: Point3,
    axis: Vec3,
}

/// One motion, frozen.
struct Steps<'a> {
    swept: &'a Swept,
    /// No point of the tool goes farther.
    way: f64,
    poses: Vec<Frozen>,
}

fn freeze<'a>(swept: &'a Swept, shape: &Shape) -> Steps<'a> {
    let (a, b) = (swept.from.axis.into_inner(), swept.to.axis.into_inner());
    let straight = (swept.to.tip - swept.from.tip).norm();
    // Lengths of arcs are below 1.6 times their chords for turns below a right angle.
    let way = straight + 1.6 * (b - a).norm() * (shape.length + shape.core + shape.corner);
    let near = straight + 1.6 * (b - a).norm() * 2.0 * (shape.core + shape.corner);
    let count = ((near / STEP_MM).ceil() as usize).clamp(1, 2_000_000);
    let poses = (0..=count).map(|k| {
        let t = k as f64 / count as f64;
        let axis = a * (1.0 - t) + b * t;
        Frozen { tip: swept.from.tip + (swept.to.tip - swept.from.tip) * t, axis: axis / axis.norm() }
    });
    Steps { swept, way, poses: poses.collect() }
}

/// What is left at one place.
struct Left {
    /// The largest share of a limit.
    share: f64,
}

struct World<'a> {
    shape: Shape,
    steps: Vec<Steps<'a>>,
}

impl World<'_> {
    /// Where the tool is on the line `p + s n`, within the range; None where it is not.
    fn interval(&self, at: &Frozen, p: &Point3, n: &Unit3, [lo, hi]: [f64; 2]) -> Option<[f64; 2]> {
        let d = |s: f64| self.shape.distance(&at.tip, &at.axis, &(p + n.into_inner() * s));
        let (mut a, mut b) = (lo, hi);
        let mut inside = None;
        // The distance is convex along the line. 50 thirds leave 1e-9 of the range.
        for _ in 0..50 {
            let (x, y) = (a + (b - a) / 3.0, b - (b - a) / 3.0);
            let (dx, dy) = (d(x), d(y));
            if dx.min(dy) <= 0.0 {
                inside = Some(if dx <= 0.0 { x } else { y });
                break;
            }
            if dx < dy {
                b = y;
            } else {
                a = x;
            }
        }
        let inside = inside?;
        let edge = |outside: f64| {
            if d(outside) <= 0.0 {
                return outside;
            }
            let (mut out, mut within) = (outside, inside);
            for _ in 0..36 {
                let middle = 0.5 * (out + within);
                if d(middle) > 0.0 { out = middle } else { within = middle }
            }
            within
        };
        Some([edge(lo), edge(hi)])
    }

    fn look(&self, surface: &dyn Surface, place: Uv) -> Left {
        let jet = surface.jet2(place);
        let (p, n) = (jet.point, jet.normal().expect("regular"));
        let (mut height, mut touched, mut share) = (STOCK_MM, false, 0.0f64);
        let mut near: Vec<(f64, usize)> = Vec::new();
        for m in &self.steps {
            let first = self.shape.distance(&m.swept.from.tip, &m.swept.from.axis, &p);
            if first > m.way + height.max(0.0) {
                continue;
            }
            let before = height;
            // To lower the height the tool must come to the stretch of the line from the part up to it.
            let reaches = |at: &Frozen, height: f64| {
                let half = 0.5 * height.max(0.0);
                self.shape.distance(&at.tip, &at.axis, &(p + n.into_inner() * half)) <= half
            };
            // From pose to pose no point of the tool goes farther than this: far off, many are passed over.
            let pace = m.way / (m.poses.len() - 1) as f64;
            near.clear();
            let mut k = 0;
            while let Some(at) = m.poses.get(k) {
                let over = self.shape.distance(&at.tip, &at.axis, &p) - height.max(0.0);
                if over <= 0.0 {
                    near.push((over, k));
                }
                k += if over > pace { (over / pace) as usize } else { 1 };
            }
            // The nearest pose first: it spares most of the others.
            let nearest = near.iter().min_by(|a, b| a.0.total_cmp(&b.0));
            for (_, k) in nearest.into_iter().chain(&near) {
                let at = &m.poses[*k];
                if !reaches(at, height) {
                    continue;
                }
                let range = [-2.0 * DEPTH_MM, height.max(0.0) + 2.0 * DEPTH_MM];
                let Some([entry, exit]) = self.interval(at, &p, &n, range) else { continue };
                if exit < 0.0 {
                    continue;
                }
                let here = if entry >= 0.0 { entry } else { entry.max(-exit) };
                height = height.min(here.max(-DEPTH_MM));
            }
            touched |= height < before;
            if m.swept.rapid {
                share = share.max((before - height) / LIMITS.collision_mm);
            }
        }
        let stands = if touched { height / LIMITS.scallop_mm } else { UNTOUCHED };
        Left { share: share.max(stands).max(-height / LIMITS.gouge_mm) }
    }
}

/// The largest share of a limit that a path takes anywhere on the part, from `side` times `side` places.
pub fn reference(motions: &[Swept], shape: Shape, part: Part, side: u32) -> f64 {
    let surface = part.surface(1.0);
    let (middle, half) = part.range();
    let world = World { shape, steps: motions.iter().map(|m| freeze(m, &shape)).collect() };
    let at = |x: f64, y: f64| uv(middle.u + half[0] * x, middle.v + half[1] * y);
    // Places from side to side, off any regular pattern of passes.
    let place = |k: u32, shift: f64| 2.0 * (f64::from(k) + shift) / f64::from(side) - 1.0;
    let order: Vec<u32> =
        (0..side).flat_map(|i| (0..side).map(move |j| (j * SHUFFLE + i) % side * side + j)).collect();
    let mut found: Vec<(f64, [f64; 2])> = Vec::with_capacity(order.len());
    for some in order.chunks(2 * side as usize) {
        let looked = some.par_iter().map(|k| {
            let [x, y] = [place(k % side, 0.377), place(k / side, 0.613)];
            (world.look(&*surface, at(x, y)).share, [x, y])
        });
        found.extend(looked.collect::<Vec<_>>());
        // Far beyond a limit it does not matter by how much.
        if found.iter().any(|f| f.0 >= NEAR[1]) {
            break;
        }
    }
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    let coarse = found[0].0;
    if !(NEAR[0]..NEAR[1]).contains(&coarse) {
        return coarse;
    }
    let searched = found.par_iter().take(SEARCHED).map(|(share, start)| {
        // Downhill in no direction: halve the step.
        let (mut best, mut here, mut step) = (*share, *start, 1.0 / f64::from(side));
        while step > 1e-4 {
            let tries = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
            let next = tries
                .map(|d| [0, 1].map(|i| (here[i] + step * d[i]).clamp(-1.0, 1.0)))
                .map(|q| (world.look(&*surface, at(q[0], q[1])).share, q));
            let top = next.iter().max_by(|a, b| a.0.total_cmp(&b.0)).expect("four tries");
            if top.0 > best {
                (best, here) = *top;
            } else {
                step *= 0.5;
            }
        }
        best
    });
    searched.reduce(|| coarse, f64::max)
}
