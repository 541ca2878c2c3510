//! Orthographic projection and hidden points for the static picture.
//!
//! Picture frame: x to the right and y down in pixels, depth towards the viewer in the same unit. The camera stands
//! at an azimuth about z (from +x towards +y) and an elevation above the xy plane and looks at the part with z up.

/// Where the camera stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direction {
    /// About z, from +x towards +y, degrees.
    pub azimuth_deg: f64,
    /// Above the xy plane, degrees.
    pub elevation_deg: f64,
}

impl Direction {
    /// The unit vector towards the viewer.
    pub fn toward(&self) -> [f64; 3] {
        let (sin_a, cos_a) = self.azimuth_deg.to_radians().sin_cos();
        let (sin_e, cos_e) = self.elevation_deg.to_radians().sin_cos();
        [cos_e * cos_a, cos_e * sin_a, sin_e]
    }
}

/// A rectangle of the picture, px.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Frame {
    /// Left edge.
    pub x: f64,
    /// Upper edge.
    pub y: f64,
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
}

/// An orthographic camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    right: [f64; 3],
    up: [f64; 3],
    /// From the part towards the viewer.
    pub toward: [f64; 3],
    /// Pixels a millimetre.
    pub scale: f64,
    offset: [f64; 2],
}

/// The scalar product.
pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `v` at unit length; zero where it has none.
pub fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = dot(v, v).sqrt();
    if length > 0.0 { v.map(|x| x / length) } else { [0.0; 3] }
}

impl Camera {
    /// A camera in `direction` that shows all `points` within `frame`, as large as fits. Points without extent appear
    /// in its middle at a pixel a millimetre.
    pub fn fit(direction: Direction, frame: Frame, points: impl Iterator<Item = [f64; 3]>) -> Self {
        let (sin_a, cos_a) = direction.azimuth_deg.to_radians().sin_cos();
        let (sin_e, cos_e) = direction.elevation_deg.to_radians().sin_cos();
        let mut camera = Self {
            right: [-sin_a, cos_a, 0.0],
            up: [-sin_e * cos_a, -sin_e * sin_a, cos_e],
            toward: direction.toward(),
            scale: 1.0,
            offset: [0.0; 2],
        };
        let (mut lo, mut hi) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for p in points.map(|p| camera.project(p)) {
            for i in 0..2 {
                (lo[i], hi[i]) = (lo[i].min(p[i]), hi[i].max(p[i]));
            }
        }
        let (width, height) = (hi[0] - lo[0], hi[1] - lo[1]);
        let scale = (frame.width / width).min(frame.height / height);
        camera.scale = if scale.is_finite() && scale > 0.0 { scale } else { 1.0 };
        let middle = [0, 1].map(|i| if lo[i] <= hi[i] { 0.5 * (lo[i] + hi[i]) } else { 0.0 });
        camera.offset = [
            frame.x + 0.5 * frame.width - camera.scale * middle[0],
            frame.y + 0.5 * frame.height - camera.scale * middle[1],
        ];
        camera
    }

    /// Picture coordinates and depth of a point of the part.
    pub fn project(&self, p: [f64; 3]) -> [f64; 3] {
        [
            self.offset[0] + self.scale * dot(self.right, p),
            self.offset[1] - self.scale * dot(self.up, p),
            self.scale * dot(self.toward, p),
        ]
    }

    /// How bright a surface with normal `n` is, from 0 to 1: seen from either side, lit from above the viewer's left
    /// shoulder.
    pub fn light(&self, n: [f64; 3]) -> f64 {
        let n = if dot(n, self.toward) < 0.0 { n.map(|x| -x) } else { n };
        let from = std::array::from_fn(|i| self.toward[i] + 0.55 * self.up[i] - 0.35 * self.right[i]);
        dot(unit(n), unit(from)).max(0.0)
    }
}

/// The pixels whose centres a triangle covers, as indices row by row, each with the weights of its second and third
/// corner. None for a triangle without area.
pub fn covered(
    [a, b, c]: [[f64; 3]; 3],
    width: usize,
    height: usize,
) -> impl Iterator<Item = (usize, f64, f64)> {
    let twice_area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
    let range = move |i: usize, size: usize| {
        let lo = a[i].min(b[i]).min(c[i]).floor().max(0.0) as usize;
        let hi = a[i].max(b[i]).max(c[i]).ceil().clamp(0.0, size as f64) as usize;
        lo..hi
    };
    let rows = if twice_area.abs() > 0.0 && twice_area.is_finite() { range(1, height) } else { 0..0 };
    rows.flat_map(move |y| range(0, width).map(move |x| (x, y))).filter_map(move |(x, y)| {
        let (px, py) = (x as f64 + 0.5 - a[0], y as f64 + 0.5 - a[1]);
        let v = (px * (c[1] - a[1]) - (c[0] - a[0]) * py) / twice_area;
        let w = ((b[0] - a[0]) * py - px * (b[1] - a[1])) / twice_area;
        (v >= 0.0 && w >= 0.0 && v + w <= 1.0).then_some((y * width + x, v, w))
    })
}

/// The nearest depth in each pixel.
pub struct DepthMap {
    width: usize,
    height: usize,
    nearest: Vec<f32>,
}

impl DepthMap {
    /// Nothing drawn yet.
    pub fn new(width: usize, height: usize) -> Self {
        Self { width, height, nearest: vec![f32::NEG_INFINITY; width * height] }
    }

    /// Draws a triangle in picture coordinates.
    pub fn fill(&mut self, corners: [[f64; 3]; 3]) {
        let [a, b, c] = corners.map(|p| p[2]);
        for (pixel, v, w) in covered(corners, self.width, self.height) {
            self.nearest[pixel] = self.nearest[pixel].max((a + v * (b - a) + w * (c - a)) as f32);
        }
    }

    /// Is any of a triangle no more than `slack` pixels behind what is drawn?
    pub fn shows(&self, corners: [[f64; 3]; 3], slack: f64) -> bool {
        let [a, b, c] = corners.map(|p| p[2]);
        let depth = |(pixel, v, w): (usize, f64, f64)| (pixel, a + v * (b - a) + w * (c - a));
        corners.iter().any(|p| self.sees(*p, slack))
            || covered(corners, self.width, self.height)
                .map(depth)
                .any(|(pixel, z)| f64::from(self.nearest[pixel]) <= z + slack)
    }

    /// Is nothing drawn more than `slack` pixels in front of `p`, there or in one of the pixels around? The
    /// neighbours count because on a steep surface the depth changes much within a pixel. Outside the picture
    /// nothing is hidden.
    pub fn sees(&self, p: [f64; 3], slack: f64) -> bool {
        let (x, y) = (p[0].floor(), p[1].floor());
        if !(x >= 0.0 && y >= 0.0 && x < self.width as f64 && y < self.height as f64) {
            return true;
        }
        let (x, y) = (x as usize, y as usize);
        let rows = y.saturating_sub(1)..(y + 2).min(self.height);
        let columns = x.saturating_sub(1)..(x + 2).min(self.width);
        rows.flat_map(|row| columns.clone().map(move |column| row * self.width + column))
            .any(|pixel| f64::from(self.nearest[pixel]) <= p[2] + slack)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Frame = Frame { x: 10.0, y: 20.0, width: 100.0, height: 50.0 };

    /// From the front x goes right and z up; from above y goes up. Rounding of sines only.
    #[test]
    fn named_views_look_as_drawings_do() {
        let corners = || [[0.0, 0.0, 0.0], [2.0, 2.0, 2.0]].into_iter();
        let front = Camera::fit(Direction { azimuth_deg: -90.0, elevation_deg: 0.0 }, FRAME, corners());
        assert!((front.scale - 25.0).abs() < 1e-12);
        let (o, x, z) =
            (front.project([0.0; 3]), front.project([1.0, 0.0, 0.0]), front.project([0.0, 0.0, 1.0]));
        assert!((x[0] - o[0] - 25.0).abs() < 1e-12 && (x[1] - o[1]).abs() < 1e-12);
        assert!((z[1] - o[1] + 25.0).abs() < 1e-12);
        let top = Camera::fit(Direction { azimuth_deg: -90.0, elevation_deg: 90.0 }, FRAME, corners());
        let y = top.project([0.0, 1.0, 0.0]);
        assert!((y[1] - top.project([0.0; 3])[1] + 25.0).abs() < 1e-12);
    }

    #[test]
    fn the_camera_shows_everything_and_survives_nothing() {
        let direction = Direction { azimuth_deg: 33.0, elevation_deg: 21.0 };
        let points = [[1.0, -4.0, 2.0], [7.0, 3.0, 9.0], [-2.0, 0.5, -1.0]];
        let camera = Camera::fit(direction, FRAME, points.into_iter());
        for p in points.map(|p| camera.project(p)) {
            assert!(p[0] > 10.0 - 1e-9 && p[0] < 110.0 + 1e-9 && p[1] > 20.0 - 1e-9 && p[1] < 70.0 + 1e-9);
        }
        let empty = Camera::fit(direction, FRAME, std::iter::empty());
        assert_eq!(empty.project([0.0; 3]), [60.0, 45.0, 0.0]);
    }

    #[test]
    fn what_lies_behind_is_hidden() {
        let mut map = DepthMap::new(10, 10);
        map.fill([[0.0, 0.0, 5.0], [10.0, 0.0, 5.0], [0.0, 10.0, 5.0]]);
        assert!(map.sees([2.0, 2.0, 5.0], 0.1) && map.sees([2.0, 2.0, 8.0], 0.1));
        assert!(!map.sees([2.0, 2.0, 4.0], 0.1));
        assert!(map.sees([9.5, 9.5, 4.0], 0.1), "outside the triangle");
        assert!(map.sees([-3.0, 50.0, 4.0], 0.1), "outside the picture");
        map.fill([[0.0; 3], [1.0, f64::NAN, 0.0], [1.0; 3]]);
        // Behind a smaller triangle all corners of a larger one may be seen or none; what is right behind it counts as seen.
        let mut map = DepthMap::new(10, 10);
        map.fill([[-20.0, -20.0, 5.0], [60.0, -20.0, 5.0], [-20.0, 60.0, 5.0]]);
        let at = |z: f64| [[2.0, 2.0, z], [8.0, 2.0, z], [2.0, 8.0, z]];
        assert!(map.shows(at(5.0), 0.5) && map.shows(at(4.6), 0.5) && !map.shows(at(3.0), 0.5));
        let mut wall = DepthMap::new(10, 10);
        wall.fill([[0.0, 0.0, 5.0], [4.0, 0.0, 5.0], [0.0, 4.0, 5.0]]);
        assert!(wall.shows([[0.5, 0.5, 0.0], [9.5, 0.5, 0.0], [0.5, 9.5, 0.0]], 0.5));
    }
}
