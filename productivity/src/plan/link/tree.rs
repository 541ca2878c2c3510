//! Points in a tree of balls: how near a body of the tool comes to them.
//!
//! A signed distance changes by no more than the way to another point, so that a ball is decided by its centre. Leaves hold a few
//! points each, so that a million of them is a small tree.

use osculate_geom::{Point3, Unit3, Vec3};
use osculate_tools::{Cutter, Pose};

/// Most points in a leaf: fewer are as soon looked at as bounded.
const LEAF: usize = 8;

/// A point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::plan) struct Dot {
    pub at: Point3,
    /// Outward unit normal.
    pub normal: Unit3,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Ball {
    centre: Point3,
    radius_mm: f64,
    /// Its points.
    first: u32,
    end: u32,
    /// Its second half, the first follows the ball itself; zero for a leaf.
    second: u32,
}

/// Points of surfaces.
#[derive(Clone, Debug, PartialEq, Default)]
pub(in crate::plan) struct Dots {
    dots: Vec<Dot>,
    balls: Vec<Ball>,
}

impl Dots {
    /// A tree over points, which are finite and fewer than an index can hold.
    pub fn new(dots: Vec<Dot>) -> Self {
        let mut out = Self { balls: Vec::with_capacity(dots.len() / 2 + 1), dots };
        out.add(0, out.dots.len());
        out
    }

    pub const fn len(&self) -> usize {
        self.dots.len()
    }

    fn add(&mut self, first: usize, end: usize) {
        if first >= end {
            return;
        }
        let own = &mut self.dots[first..end];
        let (lo, hi) = own.iter().fold((own[0].at, own[0].at), |(lo, hi), d| (lo.inf(&d.at), hi.sup(&d.at)));
        let extent: Vec3 = hi - lo;
        let centre = lo + extent * 0.5;
        let radius_mm = own.iter().map(|d| (d.at - centre).norm()).fold(0.0, f64::max);
        let index = self.balls.len();
        // Counts fit an index, as said above.
        self.balls.push(Ball { centre, radius_mm, first: first as u32, end: end as u32, second: 0 });
        if end - first <= LEAF {
            return;
        }
        let widest = extent.imax();
        let half = (end - first) / 2;
        own.select_nth_unstable_by(half, |a, b| a.at[widest].total_cmp(&b.at[widest]));
        self.add(first, first + half);
        self.balls[index].second = self.balls.len() as u32;
        self.add(first + half, end);
    }

    /// The least signed distance of a body from the points, where that is less than `below_mm`; else `below_mm`.
    pub fn least_mm(&self, body: &Cutter, pose: &Pose, below_mm: f64) -> f64 {
        let mut least = below_mm;
        if let Some(root) = self.balls.first() {
            self.lower((0, body.distance(pose, &root.centre) - root.radius_mm), (body, pose), &mut least);
        }
        least
    }

    fn lower(&self, (ball, bound_mm): (u32, f64), (body, pose): (&Cutter, &Pose), least: &mut f64) {
        if bound_mm >= *least {
            return;
        }
        let b = &self.balls[ball as usize];
        if b.second == 0 {
            for d in &self.dots[b.first as usize..b.end as usize] {
                *least = least.min(body.distance(pose, &d.at));
            }
            return;
        }
        let bound = |k: u32| {
            let b = &self.balls[k as usize];
            (k, body.distance(pose, &b.centre) - b.radius_mm)
        };
        let (one, other) = (bound(ball + 1), bound(b.second));
        // The nearer first: it often rules out the other.
        let (one, other) = if other.1 < one.1 { (other, one) } else { (one, other) };
        self.lower(one, (body, pose), least);
        self.lower(other, (body, pose), least);
    }

    /// Whether a point nearer to a body than `within_mm` is one for which `is`, of it and its distance, holds.
    pub fn any(
        &self,
        (body, pose): (&Cutter, &Pose),
        within_mm: f64,
        is: &mut impl FnMut(&Dot, f64) -> bool,
    ) -> bool {
        self.each((body, pose), within_mm, &|_| true, &mut |k| {
            let dot = &self.dots[k];
            is(dot, body.distance(pose, &dot.at))
        })
    }

    /// Looks at points that are nearer to a body than `within_mm`, by number, in balls that are `open`, until `is` holds for one; whether
    /// it does.
    pub fn each(
        &self,
        posed: (&Cutter, &Pose),
        within_mm: f64,
        open: &impl Fn(usize) -> bool,
        is: &mut impl FnMut(usize) -> bool,
    ) -> bool {
        !self.balls.is_empty() && self.each_in(0, (posed, within_mm), open, is)
    }

    fn each_in(
        &self,
        ball: usize,
        ((body, pose), within_mm): ((&Cutter, &Pose), f64),
        open: &impl Fn(usize) -> bool,
        is: &mut impl FnMut(usize) -> bool,
    ) -> bool {
        let b = &self.balls[ball];
        if !open(ball) || body.distance(pose, &b.centre) - b.radius_mm >= within_mm {
            return false;
        }
        if b.second == 0 {
            return (b.first as usize..b.end as usize)
                .any(|k| body.distance(pose, &self.dots[k].at) < within_mm && is(k));
        }
        self.each_in(ball + 1, ((body, pose), within_mm), open, is)
            || self.each_in(b.second as usize, ((body, pose), within_mm), open, is)
    }

    /// The greatest of the numbers of the points in each ball.
    pub fn greatest(&self, of: &[u32]) -> Vec<u32> {
        let mut out = vec![0; self.balls.len()];
        // Halves follow the ball that they are of.
        for k in (0..self.balls.len()).rev() {
            let b = &self.balls[k];
            out[k] = match b.second {
                0 => of[b.first as usize..b.end as usize].iter().copied().max().unwrap_or(0),
                second => out[k + 1].max(out[second as usize]),
            };
        }
        out
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use osculate_tools::CutterSpec;
    use proptest::prelude::*;

    proptest! {
        /// The tree says what all points say one after the other.
        #[test]
        fn nothing_is_passed_over(
            points in prop::collection::vec(prop::array::uniform3(-10.0..10.0f64), 0..80),
            tip in prop::array::uniform3(-10.0..10.0f64),
            axis in prop::array::uniform3(-1.0..1.0f64),
            below in -2.0..8.0f64,
        ) {
            prop_assume!(Vec3::from(axis).norm() > 0.1);
            let pose = Pose { tip: Point3::from(tip), axis: Unit3::new_normalize(Vec3::from(axis)) };
            let spec = CutterSpec::Toroidal { diameter_mm: 6.0, corner_radius_mm: 1.0, length_mm: 9.0 };
            let body = Cutter::try_from(spec).unwrap();
            let dot = |p: &[f64; 3]| Dot { at: Point3::from(*p), normal: Vec3::z_axis() };
            let tree = Dots::new(points.iter().map(dot).collect());
            let all = || points.iter().map(|p| body.distance(&pose, &Point3::from(*p)));
            prop_assert_eq!(tree.least_mm(&body, &pose, below), all().fold(below, f64::min));
            let odd = |x: f64| (x * 1e3) as i64 % 2 == 1;
            let found = tree.any((&body, &pose), below, &mut |_, off| odd(off));
            prop_assert_eq!(found, all().any(|off| off < below && odd(off)));
        }
    }
}
