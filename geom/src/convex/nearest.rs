//! The point of a simplex that is nearest to the origin, and the corners between which it lies.
//!
//! Every face of the simplex (corners, edges, triangles, the whole) is asked for the foot of the origin on it; the nearest of the feet
//! that lie inside their face is the answer. There are fifteen faces at most, and none is preferred by rounding.

use crate::point::Vec3;

/// One to four points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Simplex {
    corners: [Vec3; 4],
    count: usize,
}

/// A foot: its squared distance, where it is, and the corners of its face as bits.
type Foot = (f64, Vec3, u8);

impl Simplex {
    pub fn new(corner: Vec3) -> Self {
        Self { corners: [corner; 4], count: 1 }
    }

    /// One corner more; false where it is one already, or there is no room.
    pub fn take(&mut self, corner: Vec3) -> bool {
        if self.count == 4 || self.corners[..self.count].contains(&corner) {
            return false;
        }
        self.corners[self.count] = corner;
        self.count += 1;
        true
    }

    /// The nearest point; corners that it does not need are dropped.
    pub fn nearest(&mut self) -> Vec3 {
        let n = self.count;
        let c = self.corners;
        let mut best: Foot = (f64::INFINITY, c[0], 1);
        let mut offer = |foot: Option<Vec3>, face: u8| {
            if let Some(at) = foot
                && at.norm_squared() < best.0
            {
                best = (at.norm_squared(), at, face);
            }
        };
        for i in 0..n {
            offer(Some(c[i]), 1 << i);
            for j in i + 1..n {
                offer(on_edge(&c[i], &c[j]), 1 << i | 1 << j);
                for k in j + 1..n {
                    offer(on_triangle(&c[i], &c[j], &c[k]), 1 << i | 1 << j | 1 << k);
                }
            }
        }
        if n == 4 && holds_origin(&c) {
            offer(Some(Vec3::zeros()), 0b1111);
        }
        let (_, at, face) = best;
        self.count = 0;
        for (k, corner) in c.into_iter().enumerate().take(n) {
            if face >> k & 1 == 1 {
                self.corners[self.count] = corner;
                self.count += 1;
            }
        }
        at
    }
}

fn on_edge(a: &Vec3, b: &Vec3) -> Option<Vec3> {
    let along = b - a;
    let t = -a.dot(&along) / along.norm_squared();
    (t > 0.0 && t < 1.0).then(|| a + along * t)
}

fn on_triangle(a: &Vec3, b: &Vec3, c: &Vec3) -> Option<Vec3> {
    let normal = (b - a).cross(&(c - a));
    let size2 = normal.norm_squared();
    if size2 <= 0.0 {
        return None;
    }
    let share = |p: &Vec3, q: &Vec3| p.cross(q).dot(&normal) / size2;
    let shares = [share(b, c), share(c, a), share(a, b)];
    // Made of the corners the foot is a point of the triangle, however narrow that is.
    shares.iter().all(|s| *s > 0.0).then(|| {
        let sum = shares[0] + shares[1] + shares[2];
        (a * shares[0] + b * shares[1] + c * shares[2]) / sum
    })
}

/// Whether the origin is on the inner side of all four triangles.
fn holds_origin(c: &[Vec3; 4]) -> bool {
    let volume = |a: &Vec3, b: &Vec3, c: &Vec3, d: &Vec3| (b - a).cross(&(c - a)).dot(&(d - a));
    let zero = Vec3::zeros();
    let whole = volume(&c[0], &c[1], &c[2], &c[3]);
    let parts = [
        volume(&zero, &c[1], &c[2], &c[3]),
        volume(&c[0], &zero, &c[2], &c[3]),
        volume(&c[0], &c[1], &zero, &c[3]),
        volume(&c[0], &c[1], &c[2], &zero),
    ];
    whole != 0.0 && parts.iter().all(|p| p * whole > 0.0)
}
