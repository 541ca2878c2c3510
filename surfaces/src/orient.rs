//! Which side of a face the material is on, where the file does not say.
//!
//! A ray that leaves a closed body crosses its boundary an even number of times, one that starts inside an odd
//! number. From points of the face rays go out to both sides; the side on which odd counts prevail is the material.
//! Files of loose faces are rarely quite closed, so it is a vote: the answer carries how clear it was.

use osculate_geom::{Point3, Side, Unit3, Vec3};
use rayon::prelude::*;

/// The outcome of the vote.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enclosure {
    /// The side that the outward normal is on, relative to the normals given.
    pub side: Side,
    /// Share of rays into the material with an odd count less that of rays out of it: 1 for a closed body, 0 for
    /// an open sheet.
    pub certainty: f64,
}

/// The vote over rays from `points`, given with their natural normals, against a soup of triangles that includes
/// the face itself. None without points or triangles.
#[must_use]
pub fn enclosed_side(points: &[(Point3, Unit3)], triangles: &[[Point3; 3]]) -> Option<Enclosure> {
    if points.is_empty() || triangles.is_empty() {
        return None;
    }
    let box3 = osculate_geom::Box3::around(triangles.iter().flatten());
    // Beyond the chord error of the tessellation, well below the thickness of anything that is machined.
    let skip = 1e-4 * box3.diagonal_mm();
    let odd = |sign: f64| -> usize {
        points
            .par_iter()
            .filter(|(p, n)| {
                let d = n.into_inner() * sign;
                let crossings = triangles.iter().filter(|t| crosses(p, &d, t, skip)).count();
                crossings % 2 == 1
            })
            .count()
    };
    let (ahead, behind) = (odd(1.0), odd(-1.0));
    let certainty = (behind as f64 - ahead as f64) / points.len() as f64;
    let side = if certainty >= 0.0 { Side::Along } else { Side::Against };
    Some(Enclosure { side, certainty: certainty.abs() })
}

/// Whether the ray from `p` along `d` crosses the triangle farther off than `skip`.
fn crosses(p: &Point3, d: &Vec3, [a, b, c]: &[Point3; 3], skip: f64) -> bool {
    let (e1, e2) = (b - a, c - a);
    let h = d.cross(&e2);
    let det = e1.dot(&h);
    if det.abs() <= 1e-14 * e1.norm() * e2.norm() {
        return false;
    }
    let s = p - a;
    let u = s.dot(&h) / det;
    if !(0.0..1.0).contains(&u) {
        return false;
    }
    let q = s.cross(&e1);
    let v = d.dot(&q) / det;
    v >= 0.0 && u + v < 1.0 && e2.dot(&q) / det > skip
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tetrahedron's faces wound outward, and points in them.
    fn body() -> (Vec<[Point3; 3]>, Vec<(Point3, Unit3)>) {
        let v = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0]].map(Point3::from);
        let triangles: Vec<[Point3; 3]> =
            [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]].map(|t| t.map(|k: usize| v[k])).to_vec();
        let points = triangles
            .iter()
            .map(|[a, b, c]| {
                let m = a + ((b - a) * 0.37 + (c - a) * 0.31);
                (m, Unit3::new_normalize((b - a).cross(&(c - a))))
            })
            .collect();
        (triangles, points)
    }

    #[test]
    fn closed_bodies_are_certain_both_ways() {
        let (triangles, points) = body();
        let e = enclosed_side(&points, &triangles).unwrap();
        assert_eq!((e.side, e.certainty), (Side::Along, 1.0));
        let flipped: Vec<_> = points.iter().map(|(p, n)| (*p, -*n)).collect();
        let e = enclosed_side(&flipped, &triangles).unwrap();
        assert_eq!((e.side, e.certainty), (Side::Against, 1.0));
    }

    #[test]
    fn an_open_sheet_is_uncertain() {
        let (triangles, points) = body();
        let e = enclosed_side(&points[..1], &triangles[..1]).unwrap();
        assert_eq!(e.certainty, 0.0);
        assert!(enclosed_side(&[], &triangles).is_none());
    }
}
