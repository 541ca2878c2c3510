//! Whether a place lies inside of a part, by counting how often rays from it cross the triangles of all faces: odd is inside, whatever way
//! the triangles are turned.
//!
//! Written for the check alone: it takes nothing from the search for sides. Rays that meet a gap between two faces count wrong;
//! that is why there are several, of which nearly all have to agree.

use osculate_geom::{Point3, Vec3};

/// Directions, none of which lies in a plane or along an edge that parts are made of.
const RAYS: [[f64; 3]; 7] = [
    [0.3141, 0.8271, 0.4657],
    [-0.5613, 0.2937, 0.7741],
    [0.7219, -0.4127, 0.5553],
    [-0.2713, -0.6191, 0.7369],
    [0.6247, 0.5437, -0.5607],
    [-0.8123, 0.4241, -0.4003],
    [0.1733, -0.7817, -0.5991],
];

/// Rays that have to agree.
const AGREE: usize = 6;

/// True inside, false outside, none where the rays do not agree.
pub fn inside(at: Point3, triangles: &[[Point3; 3]]) -> Option<bool> {
    let odd = RAYS
        .iter()
        .filter(|d| {
            let d = Vec3::from(**d);
            triangles.iter().filter(|t| crosses(at, d, t)).count() % 2 == 1
        })
        .count();
    match odd {
        n if n >= AGREE => Some(true),
        n if n + AGREE <= RAYS.len() => Some(false),
        _ => None,
    }
}

/// Whether a ray crosses a triangle (Moeller and Trumbore).
fn crosses(from: Point3, d: Vec3, [a, b, c]: &[Point3; 3]) -> bool {
    let (ab, ac) = (b - a, c - a);
    let p = d.cross(&ac);
    let det = ab.dot(&p);
    if det == 0.0 {
        return false;
    }
    let to = from - a;
    let u = to.dot(&p) / det;
    let q = to.cross(&ab);
    let v = d.dot(&q) / det;
    u >= 0.0 && v >= 0.0 && u + v <= 1.0 && ac.dot(&q) / det > 0.0
}
