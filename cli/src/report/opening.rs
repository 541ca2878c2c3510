//! From where a part is looked at first: the side from which most of what is machined is seen.

use super::data::Report;
use super::mesh::Clean;
use super::picture::USUAL;
use super::project::{Camera, Direction, Frame, covered, dot};
use rayon::prelude::*;

/// Width and height of the small pictures by which sides are compared, px.
const SMALL: usize = 72;
/// A side must show so much more than the usual one to be taken instead.
const MUCH_MORE: f64 = 1.15;
/// Sides around, at each of two elevations.
const AROUND: u32 = 8;

/// The side from which most of what is machined is seen, outside out and not behind other faces; the usual one where that is nearly as
/// good. Faces are those of the report, made clean.
pub fn opening(report: &Report, faces: &[Clean]) -> Direction {
    let usual = USUAL;
    let turned = |k: u32| usual.azimuth_deg + 360.0 * f64::from(k) / f64::from(AROUND);
    let sides: Vec<Direction> = [usual.elevation_deg, -usual.elevation_deg]
        .into_iter()
        .flat_map(|elevation_deg| {
            (0..AROUND).map(move |k| Direction { azimuth_deg: turned(k), elevation_deg })
        })
        .collect();
    let shown: Vec<f64> = sides.par_iter().map(|side| shown_mm2(*side, report, faces)).collect();
    let best = (0..sides.len()).fold(0, |best, k| if shown[k] > shown[best] { k } else { best });
    if shown[best] > MUCH_MORE * shown[0] { sides[best] } else { usual }
}

/// How much of what is machined is seen from a side, mm2 of the picture.
fn shown_mm2(side: Direction, report: &Report, faces: &[Clean]) -> f64 {
    let frame = Frame { x: 0.0, y: 0.0, width: SMALL as f64, height: SMALL as f64 };
    let all = faces.iter().flat_map(|f| &f.positions).map(|p| p.map(f64::from));
    let camera = Camera::fit(side, frame, all);
    let mut nearest = vec![(f64::NEG_INFINITY, false); SMALL * SMALL];
    for (k, face) in faces.iter().enumerate() {
        let machined = !report.faces[k].checked;
        let picture: Vec<[f64; 3]> =
            face.positions.iter().map(|p| camera.project(p.map(f64::from))).collect();
        for triangle in &face.triangles {
            let corners = triangle.map(|i| picture[i as usize]);
            let faces_us: f64 =
                triangle.iter().map(|i| dot(face.normals[*i as usize].map(f64::from), camera.toward)).sum();
            let [a, b, c] = corners.map(|p| p[2]);
            for (pixel, v, w) in covered(corners, SMALL, SMALL) {
                let depth = a + v * (b - a) + w * (c - a);
                if depth > nearest[pixel].0 {
                    nearest[pixel] = (depth, machined && faces_us > 0.0);
                }
            }
        }
    }
    nearest.iter().filter(|n| n.1).count() as f64 / (camera.scale * camera.scale)
}

#[cfg(test)]
mod tests {
    use super::super::data::FaceMesh;
    use super::super::mesh::clean;
    use super::*;

    /// A square of 2 mm with its outside along `normal`, which is along an axis, `off` from the middle.
    fn square(axis: usize, sign: f32, off: f32, checked: bool) -> FaceMesh {
        let corner = |a: f32, b: f32| {
            let mut p = [off * sign; 3];
            (p[(axis + 1) % 3], p[(axis + 2) % 3]) = (a, b);
            p
        };
        let mut normal = [0.0; 3];
        normal[axis] = sign;
        FaceMesh {
            positions: vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
            normals: vec![normal; 4],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            checked,
            ..FaceMesh::default()
        }
    }

    fn opened(faces: Vec<FaceMesh>) -> Direction {
        let clean: Vec<Clean> = faces.iter().map(|f| clean(f, 0)).collect();
        opening(&Report { faces, ..Report::default() }, &clean)
    }

    /// Of a cube of which one side is machined, the view opens on that side.
    #[test]
    fn the_machined_side_of_a_cube_is_seen() {
        for (axis, sign) in [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0), (2, 1.0), (2, -1.0)] {
            let sides = [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0), (2, 1.0), (2, -1.0)];
            let cube = sides.map(|(a, s)| square(a, s, 1.0, (a, s) != (axis, sign)));
            let Direction { azimuth_deg, elevation_deg } = opened(cube.to_vec());
            let ((sa, ca), se) = (azimuth_deg.to_radians().sin_cos(), elevation_deg.to_radians().sin());
            let toward = [ca, sa, se];
            assert!(f64::from(sign) * toward[axis] > 0.3, "{axis} {sign}: {azimuth_deg}, {elevation_deg}");
        }
    }

    /// What another face hides is not seen: from the usual side a wall stands before it.
    #[test]
    fn a_wall_before_it_turns_the_view() {
        let top = || square(2, 1.0, 0.0, false);
        assert_eq!(opened(vec![top()]), USUAL);
        let mut wall = square(1, -1.0, 1.5, true);
        wall.positions.iter_mut().for_each(|p| *p = [3.0 * p[0], p[1], 3.0 * p[2]]);
        assert_ne!(opened(vec![top(), wall]), USUAL);
        assert_eq!(opened(Vec::new()), USUAL);
    }
}
