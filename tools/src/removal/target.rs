//! What a body may come near: a box in any position, flat ones for groups of samples, a segment for one
//! sample.
//!
//! A convex distance D obeys `D(q) >= D(c) + g . (q - c)`, so that over a box with centre c and half axes a_i
//! it is at least `D(c) - sum |g . a_i|`. Near the surface g is along the normal, and a group of samples,
//! long and wide but not thick, is told apart from tools above it much better than by a ball.

use osculate_geom::{Point3, Unit3, Vec3};

/// A box; half axes may vanish.
#[derive(Clone, Copy)]
pub(super) struct Target {
    pub centre: Point3,
    pub half_axes: [Vec3; 3],
    /// Of the ball around it, mm.
    pub radius: f64,
}

impl Target {
    /// The segment from `height` below to `height` above `centre` along `normal`.
    pub fn segment(centre: Point3, normal: &Unit3, height: f64) -> Self {
        Self {
            centre,
            half_axes: [normal.into_inner() * height, Vec3::zeros(), Vec3::zeros()],
            radius: height,
        }
    }

    /// A box along the axes.
    pub fn upright(centre: Point3, half: &Vec3) -> Self {
        let half_axes =
            [Vec3::new(half.x, 0.0, 0.0), Vec3::new(0.0, half.y, 0.0), Vec3::new(0.0, 0.0, half.z)];
        Self { centre, half_axes, radius: half.norm() }
    }

    /// The smallest box around the points with one axis along `normal` and the other two as they come.
    pub fn around(points: impl Iterator<Item = Point3> + Clone, normal: &Unit3) -> Self {
        Self::wider(points, normal, [0.0; 2])
    }

    /// The same with so much more on either end of the axis along `normal`, and of the other two, mm.
    pub fn wider(
        points: impl Iterator<Item = Point3> + Clone,
        normal: &Unit3,
        [along, across]: [f64; 2],
    ) -> Self {
        let t = osculate_geom::any_perpendicular(normal);
        let axes = [normal.into_inner(), t.into_inner(), normal.cross(&t)];
        let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
        for p in points.clone() {
            for (r, a) in range.iter_mut().zip(&axes) {
                let x = p.coords.dot(a);
                *r = [r[0].min(x), r[1].max(x)];
            }
        }
        let middle = |r: &[f64; 2]| 0.5 * (r[0] + r[1]);
        let centre = Point3::from(axes.iter().zip(&range).map(|(a, r)| a * middle(r)).sum::<Vec3>());
        let radius = points.map(|p| (p - centre).norm()).fold(0.0, f64::max) + along + 2.0 * across;
        let more = [along, across, across];
        let half_axes = std::array::from_fn(|k| axes[k] * (0.5 * (range[k][1] - range[k][0]) + more[k]));
        Self { centre, half_axes, radius }
    }

    /// Its corners.
    pub fn corners(&self) -> [Point3; 8] {
        let [a, b, c] = self.half_axes;
        std::array::from_fn(|k| {
            let side = |bit: usize| if k >> bit & 1 == 0 { -1.0 } else { 1.0 };
            self.centre + a * side(0) + b * side(1) + c * side(2)
        })
    }

    /// By how much a convex function with gradient `g` at the centre may be lower elsewhere in the box.
    pub fn fall(&self, g: &Vec3) -> f64 {
        let [a, b, c] = &self.half_axes;
        g.dot(a).abs() + g.dot(b).abs() + g.dot(c).abs()
    }
}
