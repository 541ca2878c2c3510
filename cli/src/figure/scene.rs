//! The view of a figure: projection, and which parts of a line one sees.

use super::study::Study;
use crate::report::project::{Camera, DepthMap, Direction, Frame, dot};
use osculate_geom::{Point3, Vec3};

/// A place on the page, px.
pub type Place = [f64; 2];

/// The camera, with what the face hides.
pub struct Scene {
    /// The camera.
    pub camera: Camera,
    depth: DepthMap,
    frame: Frame,
}

/// Pixels of the depth map for one of the page.
const FINE: f64 = 2.0;
/// What lies less than this in front of a point does not hide it, px: facets stand off the surface by less.
const SLACK: f64 = 2.0;
/// Lines are looked at in pieces of this length, px.
const PIECE: f64 = 1.0;

/// Where the camera stands unless it is told: a little to the right of the front, from above.
const USUAL: Direction = Direction { azimuth_deg: -62.0, elevation_deg: 38.0 };

/// The direction from which the outside of a face shows: the usual one where it does.
pub fn direction(study: &Study) -> Direction {
    let faces = study.facing;
    let toward = |d: Direction| {
        let ((sa, ca), (se, ce)) =
            (d.azimuth_deg.to_radians().sin_cos(), d.elevation_deg.to_radians().sin_cos());
        Vec3::new(ce * ca, ce * sa, se)
    };
    // A face that bends around is seen from anywhere.
    if faces.norm() < 0.3 || toward(USUAL).dot(&faces) > 0.35 * faces.norm() {
        return USUAL;
    }
    let candidates = [30.0, -150.0, 120.0]
        .into_iter()
        .flat_map(|turn| [38.0, -38.0].map(|elevation_deg| Direction { azimuth_deg: turn, elevation_deg }));
    let below = Direction { elevation_deg: -38.0, ..USUAL };
    let mut best = (toward(below).dot(&faces), below);
    for c in candidates {
        let seen = toward(c).dot(&faces);
        if seen > best.0 + 1e-9 {
            best = (seen, c);
        }
    }
    best.1
}

impl Scene {
    /// The view of a face within a frame.
    pub fn new(study: &Study, direction: Direction, frame: Frame) -> Self {
        let positions = &study.mesh.positions;
        let extra = study.bezier.iter().flat_map(|b| b.net.points.iter().map(|p| [p.x, p.y, p.z]));
        let camera = Camera::fit(direction, frame, positions.iter().copied().chain(extra));
        let (w, h) = ((frame.width * FINE) as usize + 2, (frame.height * FINE) as usize + 2);
        let mut scene = Self { camera, depth: DepthMap::new(w, h), frame };
        for t in &study.mesh.triangles {
            let corners = t.map(|k| scene.fine(positions[k as usize]));
            scene.depth.fill(corners);
        }
        scene
    }

    /// Coordinates in the depth map, and depth.
    fn fine(&self, p: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = self.camera.project(p);
        [(x - self.frame.x) * FINE, (y - self.frame.y) * FINE, z * FINE]
    }

    /// A point on the page.
    pub fn place(&self, p: &Point3) -> Place {
        let [x, y, _] = self.camera.project([p.x, p.y, p.z]);
        [x, y]
    }

    /// Whether a point of the face is seen.
    pub fn sees(&self, p: &Point3) -> bool {
        self.depth.sees(self.fine([p.x, p.y, p.z]), SLACK * FINE)
    }

    /// The direction towards the viewer.
    pub fn toward(&self) -> Vec3 {
        Vec3::from(self.camera.toward)
    }

    /// How bright a facet with this normal is, 0 to 1.
    pub fn light(&self, n: &Vec3) -> f64 {
        self.camera.light([n.x, n.y, n.z])
    }

    /// Depth of a point, larger nearer.
    pub fn nearness(&self, p: &Point3) -> f64 {
        dot(self.camera.toward, [p.x, p.y, p.z])
    }

    /// The pieces of a line on the face that are seen.
    pub fn visible(&self, points: impl Iterator<Item = Point3>) -> Vec<Vec<Place>> {
        self.pieces(points, true)
    }

    /// The pieces of a line on the face that are not.
    pub fn hidden(&self, points: impl Iterator<Item = Point3>) -> Vec<Vec<Place>> {
        self.pieces(points, false)
    }

    fn pieces(&self, points: impl Iterator<Item = Point3>, seen: bool) -> Vec<Vec<Place>> {
        let (mut out, mut current): (Vec<Vec<Place>>, Vec<Place>) = (Vec::new(), Vec::new());
        let mut before: Option<Point3> = None;
        let mut look = |p: Point3, current: &mut Vec<Place>| {
            if self.sees(&p) == seen {
                current.push(self.place(&p));
            } else if !current.is_empty() {
                out.push(std::mem::take(current));
            }
        };
        for p in points {
            if let Some(a) = before {
                let (from, to) = (self.place(&a), self.place(&p));
                let far = (to[0] - from[0]).hypot(to[1] - from[1]);
                let pieces = (far / PIECE).ceil().clamp(1.0, 2000.0) as usize;
                for k in 1..=pieces {
                    look(a + (p - a) * (k as f64 / pieces as f64), &mut current);
                }
            } else {
                look(p, &mut current);
            }
            before = Some(p);
        }
        if !current.is_empty() {
            out.push(current);
        }
        // Specks are what the depth map's pixels leave of hidden lines.
        out.retain(|line| length(line) > 2.5);
        out
    }
}

/// Length of a line on the page, px.
pub fn length(line: &[Place]) -> f64 {
    line.windows(2).map(|w| (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1])).sum()
}
