//! Fewer triangles for the static picture: vertices that fall into one cell of the picture become one.
//!
//! Cells are cubes in picture space, the same for all faces, so that the result is equally fine everywhere and faces
//! stay joined. Vertices out of tolerance have cells of their own. A cell is stood for by a corner of the face's border where
//! it has one, otherwise by a vertex on the border, so that outlines stay on the part, otherwise by one where what is out of
//! tolerance ends, so that this border is where its samples are. A facet's value is the mean over its cells, or their worst
//! where two of them are out of tolerance, or one that no other facet shows: the picture may show a lone bad spot too large by a
//! cell, and never hides one.

use super::legend::Limits;
use super::mesh::Clean;
use super::project::{dot, unit};
use std::collections::{BTreeSet, HashMap};

/// A triangle of vertices of the face, with its value.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Facet {
    /// Indices into the face's vertices.
    pub corners: [u32; 3],
    /// Deviation, mm; NaN where not known.
    pub deviation_mm: f64,
}

struct Cell {
    vertex: u32,
    rank: u8,
    distance: f64,
    sum: f64,
    known: usize,
    worst: f64,
    /// Its vertices are out of tolerance; otherwise none is.
    bad: bool,
    /// Shares a facet with another cell out of tolerance.
    shown: bool,
}

impl Cell {
    fn mean(&self) -> f64 {
        self.sum / self.known as f64
    }
}

/// A border that turns by more than this has a corner there: cos 30 degrees.
const CORNER_COS: f64 = 0.866;

/// At most about `budget` facets that stand for the triangles of `faces`, whose vertices lie at `pictures`; a list a
/// face.
pub fn simplify(
    faces: &[Clean],
    pictures: &[Vec<[f64; 3]>],
    limits: Limits,
    budget: usize,
) -> Vec<Vec<Facet>> {
    let total: usize = faces.iter().map(|f| f.triangles.len()).sum();
    if total <= budget {
        let value = |face: &Clean, t: &[u32; 3]| facet_value(t.map(|i| value_of(face, i)), limits);
        let facet = |face, t: &[u32; 3]| Facet { corners: *t, deviation_mm: value(face, t) };
        return faces.iter().map(|face| face.triangles.iter().map(|t| facet(face, t)).collect()).collect();
    }
    let ranks = ranks(faces);
    // Cells only grow: once all vertices of a face share one, it has no facet left, so the loop ends.
    let mut size = 2.0;
    loop {
        let facets: Vec<Vec<Facet>> = faces
            .iter()
            .zip(pictures)
            .zip(&ranks)
            .map(|((face, picture), ranks)| merged(face, picture, ranks, limits, size))
            .collect();
        let count: usize = facets.iter().map(Vec::len).sum();
        if count <= budget {
            return facets;
        }
        size *= (count as f64 / budget as f64).sqrt().max(1.03);
    }
}

/// How much each vertex matters for the outline: 3 at a corner of a border, 2 on a border, 1 where the border is also
/// that of another face, 0 elsewhere.
fn ranks(faces: &[Clean]) -> Vec<Vec<u8>> {
    type Place = [u32; 3];
    let place = |face: &Clean, i: u32| -> Place { face.positions[i as usize].map(|x| (x + 0.0).to_bits()) };
    let edge = |face: &Clean, [a, b]: [u32; 2]| -> [Place; 2] {
        let (a, b) = (place(face, a), place(face, b));
        [a.min(b), a.max(b)]
    };
    let mut owners: HashMap<[Place; 2], usize> = HashMap::new();
    for face in faces {
        face.borders.iter().for_each(|&e| *owners.entry(edge(face, e)).or_insert(0) += 1);
    }
    let of_face = |face: &Clean| {
        let mut ranks = vec![0_u8; face.positions.len()];
        let mut before: Vec<Option<[f64; 3]>> = vec![None; face.positions.len()];
        for &[a, b] in &face.borders {
            let at = |i: u32| face.positions[i as usize].map(f64::from);
            let direction = unit(std::array::from_fn(|k| at(b)[k] - at(a)[k]));
            let rank = if owners.get(&edge(face, [a, b])) == Some(&1) { 2 } else { 1 };
            for end in [a, b].map(|i| i as usize) {
                ranks[end] = ranks[end].max(rank);
                match before[end] {
                    Some(other) if dot(other, direction).abs() < CORNER_COS => ranks[end] = 3,
                    _ => before[end] = Some(direction),
                }
            }
        }
        ranks
    };
    faces.iter().map(of_face).collect()
}

fn value_of(face: &Clean, vertex: u32) -> f64 {
    face.deviation_mm.get(vertex as usize).map_or(f64::NAN, |d| f64::from(*d))
}

/// The worst corner's value where that is out of tolerance, otherwise the mean of those known.
fn facet_value(values: [f64; 3], limits: Limits) -> f64 {
    let known = || values.into_iter().filter(|v| !v.is_nan());
    let worst = known()
        .fold(f64::NAN, |w, v| if w.is_nan() || limits.severity(v) > limits.severity(w) { v } else { w });
    if limits.severity(worst) > 1.0 { worst } else { mean(values) }
}

/// The mean of the values known; NaN where none is.
fn mean(values: [f64; 3]) -> f64 {
    let known = || values.into_iter().filter(|v| !v.is_nan());
    known().sum::<f64>() / known().count() as f64
}

fn merged(face: &Clean, picture: &[[f64; 3]], ranks: &[u8], limits: Limits, size: f64) -> Vec<Facet> {
    let bad: Vec<bool> =
        (0..picture.len()).map(|i| limits.severity(value_of(face, i as u32)) > 1.0).collect();
    // A border of the face counts for more than where what is out of tolerance ends.
    let mut ranks: Vec<u8> = ranks.iter().map(|r| 2 * r).collect();
    for triangle in &face.triangles {
        let three = triangle.map(|i| i as usize);
        if three.iter().any(|i| bad[*i] != bad[three[0]]) {
            three.iter().for_each(|i| ranks[*i] = ranks[*i].max(1));
        }
    }
    let mut cells: Vec<Cell> = Vec::new();
    let mut index: HashMap<([i64; 3], bool), usize> = HashMap::new();
    let cell_of: Vec<usize> = picture
        .iter()
        .zip(&ranks)
        .enumerate()
        .map(|(i, (p, &rank))| {
            let key = p.map(|x| (x / size).floor() as i64);
            let distance = p.iter().zip(key).map(|(x, k)| (x / size - k as f64 - 0.5).powi(2)).sum::<f64>();
            let value = value_of(face, i as u32);
            let (vertex, bad) = (i as u32, bad[i]);
            let at = *index.entry((key, bad)).or_insert(cells.len());
            if at == cells.len() {
                let (sum, known, shown) = (0.0, 0, false);
                cells.push(Cell { vertex, rank, distance, sum, known, worst: value, bad, shown });
            }
            let cell = &mut cells[at];
            if (rank, -distance) > (cell.rank, -cell.distance) {
                (cell.vertex, cell.rank, cell.distance) = (vertex, rank, distance);
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
    let mut kept: Vec<[usize; 3]> = Vec::new();
    for triangle in &face.triangles {
        let three = triangle.map(|i| cell_of[i as usize]);
        let mut key = three;
        key.sort_unstable();
        if key[0] != key[1] && key[1] != key[2] && seen.insert(key) {
            kept.push(three);
        }
    }
    surfaced(face, &cell_of, &kept, (&mut cells, limits));
    // Two cells out of tolerance show in the facets between them; one alone shows in all facets around it.
    for three in &kept {
        let wrong: Vec<usize> = three.iter().copied().filter(|&c| cells[c].bad).collect();
        if wrong.len() > 1 {
            wrong.into_iter().for_each(|c| cells[c].shown = true);
        }
    }
    kept.into_iter()
        .map(|three| {
            let wrong = || three.into_iter().filter(|&c| cells[c].bad);
            let shows = wrong().count() > 1 || wrong().any(|c| !cells[c].shown);
            let corners = three.map(|c| cells[c].vertex);
            if shows {
                let deviation_mm = facet_value(three.map(|c| cells[c].worst), limits);
                return Facet { corners, deviation_mm };
            }
            let good = three.map(|c| if cells[c].bad { f64::NAN } else { cells[c].mean() });
            Facet { corners, deviation_mm: mean(good) }
        })
        .collect()
}

/// Lets what is out of tolerance inside a single cell, which has no facet, be seen: that cell is out of tolerance then.
fn surfaced(face: &Clean, cell_of: &[usize], kept: &[[usize; 3]], (cells, limits): (&mut [Cell], Limits)) {
    let mut has_facet = vec![false; cells.len()];
    kept.iter().flatten().for_each(|c| has_facet[*c] = true);
    for triangle in &face.triangles {
        let three = triangle.map(|i| cell_of[i as usize]);
        for hidden in three {
            if !cells[hidden].bad || has_facet[hidden] {
                continue;
            }
            let worst = cells[hidden].worst;
            for c in three.into_iter().filter(|c| has_facet[*c]) {
                let cell = &mut cells[c];
                if !cell.bad || limits.severity(worst) > limits.severity(cell.worst) {
                    (cell.bad, cell.worst) = (true, worst);
                }
            }
        }
    }
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

    fn simplify_one(face: &Clean, picture: &[[f64; 3]]) -> Vec<Facet> {
        simplify(std::slice::from_ref(face), &[picture.to_vec()], LIMITS, 500).remove(0)
    }

    #[test]
    fn the_budget_holds_and_the_border_stays() {
        let (face, picture) = square(60, None);
        let facets = simplify_one(&face, &picture);
        assert!(facets.len() <= 500 && facets.len() > 150, "{}", facets.len());
        let used: BTreeSet<u32> = facets.iter().flat_map(|f| f.corners).collect();
        for corner in [[0.0, 0.0], [60.0, 0.0], [0.0, 60.0], [60.0, 60.0]] {
            assert!(used.iter().any(|&i| picture[i as usize][..2] == corner), "{corner:?}");
        }
        assert!(facets.iter().all(|f| (f.deviation_mm - 0.002).abs() < 1e-6));
    }

    #[test]
    fn one_bad_vertex_of_thousands_is_still_seen() {
        for bad in [0.5_f32, -0.1] {
            let (face, picture) = square(60, Some((1234, bad)));
            let facets = simplify_one(&face, &picture);
            let shown = facets.iter().filter(|f| (f.deviation_mm - f64::from(bad)).abs() < 1e-9).count();
            // The facets around its cell, and not half of the picture.
            assert!((1..=12).contains(&shown), "{shown}");
        }
    }

    /// Every vertex of one half is out of tolerance: what is painted so is that half, to an edge of the face and not of a facet.
    #[test]
    fn the_border_of_what_is_bad_is_that_of_the_samples() {
        let (mut face, picture) = square(60, None);
        for (value, p) in face.deviation_mm.iter_mut().zip(&picture) {
            // A slanted border meets cells in all ways.
            if p[0] + 0.3 * p[1] > 37.0 {
                *value = 0.5;
            }
        }
        let facets = simplify_one(&face, &picture);
        assert!(facets.len() <= 500, "{}", facets.len());
        let inside = |f: &Facet, x: f64, y: f64| {
            let c = f.corners.map(|i| picture[i as usize]);
            let side = |a: [f64; 3], b: [f64; 3]| (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
            let sides = [side(c[0], c[1]), side(c[1], c[2]), side(c[2], c[0])];
            sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0)
        };
        let seen = |x: f64, y: f64| facets.iter().find(|f| inside(f, x, y)).map(|f| f.deviation_mm);
        for k in 0..3600 {
            let (x, y) = (f64::from(k % 60) + 0.41, f64::from(k / 60) + 0.37);
            let from_border = (x + 0.3 * y - 37.0) / 1.09_f64.sqrt();
            if let Some(value) = seen(x, y).filter(|_| from_border.abs() > 1.5) {
                assert_eq!(value > 0.01, from_border > 0.0, "({x}, {y}) is {value}");
            }
        }
    }

    #[test]
    fn what_fits_is_left_alone() {
        let (face, picture) = square(5, None);
        assert_eq!(simplify_one(&face, &picture).len(), 50);
    }
}
