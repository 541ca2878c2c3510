//! Fewer triangles for the static picture: vertices that fall into one cell of the picture become one.
//!
//! Cells are cubes in picture space, so that the result is equally fine everywhere in the picture. A cell is stood for
//! by a vertex on the face's border where it has one, so that outlines stay on the part. Its value is the mean of its
//! vertices' deviations, or the worst one as soon as that is out of tolerance: the picture may show a bad spot too large by a
//! cell, and never hides one.

use super::legend::Limits;
use super::mesh::Clean;
use std::collections::{BTreeSet, HashMap};

/// A triangle of vertices of the face, with its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facet {
    /// Indices into the face's vertices.
    pub corners: [u32; 3],
    /// Deviation, mm; NaN where not known.
    pub deviation_mm: f64,
}

struct Cell {
    vertex: u32,
    on_border: bool,
    distance: f64,
    sum: f64,
    known: usize,
    worst: f64,
}

/// At most about `budget` facets that stand for the triangles of `face`, whose vertices lie at `picture`.
pub fn simplify(face: &Clean, picture: &[[f64; 3]], limits: Limits, budget: usize) -> Vec<Facet> {
    if face.triangles.len() <= budget {
        return face
            .triangles
            .iter()
            .map(|t| Facet { corners: *t, deviation_mm: facet_value(t.map(|i| value_of(face, i)), limits) })
            .collect();
    }
    // A cell of the size at which a face that fills the picture once keeps two facets a cell, then larger ones.
    let mut size = 2.0;
    loop {
        let facets = merged(face, picture, limits, size);
        if facets.len() <= budget {
            return facets;
        }
        size *= (facets.len() as f64 / budget as f64).sqrt().max(1.06);
    }
}

fn value_of(face: &Clean, vertex: u32) -> f64 {
    face.deviation_mm.get(vertex as usize).map_or(f64::NAN, |d| f64::from(*d))
}

/// The worst corner's value where that is out of tolerance, otherwise the mean of those known.
fn facet_value(values: [f64; 3], limits: Limits) -> f64 {
    let known = || values.into_iter().filter(|v| !v.is_nan());
    let worst = known().fold(f64::NAN, |w, v| if w.is_nan() || limits.severity(v) > limits.severity(w) { v } else { w });
    if limits.severity(worst) > 1.0 { worst } else { known().sum::<f64>() / known().count() as f64 }
}

fn merged(face: &Clean, picture: &[[f64; 3]], limits: Limits, size: f64) -> Vec<Facet> {
    let mut on_border = vec![false; picture.len()];
    for &end in face.borders.iter().flatten() {
        on_border[end as usize] = true;
    }
    let mut cells: Vec<Cell> = Vec::new();
    let mut index: HashMap<[i64; 3], usize> = HashMap::new();
    let cell_of: Vec<usize> = picture
        .iter()
        .zip(&on_border)
        .enumerate()
        .map(|(i, (p, &border))| {
            let key = p.map(|x| (x / size).floor() as i64);
            let distance = p.iter().zip(key).map(|(x, k)| (x / size - k as f64 - 0.5).powi(2)).sum::<f64>();
            let value = value_of(face, i as u32);
            let at = *index.entry(key).or_insert(cells.len());
            if at == cells.len() {
                cells.push(Cell { vertex: i as u32, on_border: border, distance, sum: 0.0, known: 0, worst: value });
            }
            let cell = &mut cells[at];
            if (border, -distance) > (cell.on_border, -cell.distance) {
                (cell.vertex, cell.on_border, cell.distance) = (i as u32, border, distance);
            }
            if !value.is_nan() {
                cell.sum += value;
                cell.known += 1;
                if cell.worst.is_nan() || limits.severity(value) > limits.severity(cell.worst) {
                    cell.worst = value;
                }
            }
            at
        })
        .collect();
    let mut seen: BTreeSet<[usize; 3]> = BTreeSet::new();
    let mut facets = Vec::new();
    for triangle in &face.triangles {
        let three = triangle.map(|i| cell_of[i as usize]);
        let mut key = three;
        key.sort_unstable();
        if key[0] == key[1] || key[1] == key[2] || !seen.insert(key) {
            continue;
        }
        let value = |c: usize| {
            let cell = &cells[c];
            if limits.severity(cell.worst) > 1.0 { cell.worst } else { cell.sum / cell.known as f64 }
        };
        facets.push(Facet {
            corners: three.map(|c| cells[c].vertex),
            deviation_mm: facet_value(three.map(value), limits),
        });
    }
    facets
}

#[cfg(test)]
mod tests {
    use super::super::data::FaceMesh;
    use super::super::mesh::clean;
    use super::*;

    const LIMITS: Limits = Limits { scallop_mm: 0.01, gouge_mm: 0.005 };

    /// A flat square of `n` by `n` cells, one pixel each, with a spot of the given value at one vertex.
    fn square(n: u32, spot: Option<(usize, f32)>) -> (Clean, Vec<[f64; 3]>) {
        let stride = n + 1;
        let positions: Vec<[f32; 3]> =
            (0..stride * stride).map(|i| [(i % stride) as f32, (i / stride) as f32, 0.0]).collect();
        let corner = |i: u32| (i / n) * stride + i % n;
        let triangles = (0..n * n)
            .map(corner)
            .flat_map(|c| [[c, c + 1, c + stride], [c + 1, c + stride + 1, c + stride]])
            .collect();
        let mut deviation_mm = vec![0.002; positions.len()];
        if let Some((at, value)) = spot {
            deviation_mm[at] = value;
        }
        let clean = clean(&FaceMesh { positions, triangles, deviation_mm, ..FaceMesh::default() }, 0);
        let picture = clean.positions.iter().map(|p| p.map(f64::from)).collect();
        (clean, picture)
    }

    #[test]
    fn the_budget_holds_and_the_border_stays() {
        let (face, picture) = square(60, None);
        let facets = simplify(&face, &picture, LIMITS, 500);
        assert!(facets.len() <= 500 && facets.len() > 150, "{}", facets.len());
        let used: BTreeSet<u32> = facets.iter().flat_map(|f| f.corners).collect();
        for side in [0, 1] {
            for end in [0.0, 60.0] {
                assert!(used.iter().any(|&i| picture[i as usize][side] == end));
            }
        }
        assert!(facets.iter().all(|f| (f.deviation_mm - 0.002).abs() < 1e-6));
    }

    #[test]
    fn one_bad_vertex_of_thousands_is_still_seen() {
        for bad in [0.5_f32, -0.1] {
            let (face, picture) = square(60, Some((1234, bad)));
            let facets = simplify(&face, &picture, LIMITS, 500);
            let shown = facets.iter().filter(|f| (f.deviation_mm - f64::from(bad)).abs() < 1e-9).count();
            // Its cell with the ring of facets about it, and not half of the picture.
            assert!((1..=12).contains(&shown), "{shown}");
        }
    }

    #[test]
    fn what_fits_is_left_alone() {
        let (face, picture) = square(5, None);
        assert_eq!(simplify(&face, &picture, LIMITS, 500).len(), 50);
    }
}
