//! A face made fit for drawing: triangles that cannot be drawn are left out and counted, equal vertices are merged,
//! borders are found.

use super::data::FaceMesh;
use std::collections::HashMap;

/// A face whose indices are valid, whose vertices are finite and distinct, and whose lists have one length.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Clean {
    /// Vertices, mm.
    pub positions: Vec<[f32; 3]>,
    /// Unit normals; from the triangles where the face had none.
    pub normals: Vec<[f32; 3]>,
    /// Deviation, mm; NaN where not known.
    pub deviation_mm: Vec<f32>,
    /// Further quantities; NaN where not known.
    pub scalars: Vec<Vec<f32>>,
    /// Triangles.
    pub triangles: Vec<[u32; 3]>,
    /// Edges that belong to one triangle only. A seam whose two sides coincide is no border.
    pub borders: Vec<[u32; 2]>,
    /// Triangles left out: an index beyond the vertices, or a vertex that is not finite.
    pub dropped: usize,
}

/// Makes `face` fit for drawing, with `scalars` quantities at each vertex. The order of vertices and triangles is
/// that of the triangles given: equal input gives equal output.
pub fn clean(face: &FaceMesh, scalars: usize) -> Clean {
    let mut out = Clean { scalars: vec![Vec::new(); scalars], ..Clean::default() };
    let finite = |i: u32| face.positions.get(i as usize).is_some_and(|p| p.iter().all(|x| x.is_finite()));
    let computed;
    let normals = if face.normals.len() == face.positions.len() {
        &face.normals
    } else {
        computed = vertex_normals(face);
        &computed
    };
    let mut known: HashMap<Vec<u32>, u32> = HashMap::new();
    let mut merged: Vec<Option<u32>> = vec![None; face.positions.len()];
    for triangle in &face.triangles {
        if !triangle.iter().all(|&i| finite(i)) {
            out.dropped += 1;
            continue;
        }
        let corners = triangle.map(|index| {
            let i = index as usize;
            if let Some(at) = merged[i] {
                return at;
            }
            let deviation = face.deviation_mm.get(i).copied().unwrap_or(f32::NAN);
            let values =
                (0..scalars).map(|s| face.scalars.get(s).and_then(|v| v.get(i)).copied().unwrap_or(f32::NAN));
            // Adding zero makes -0 and 0 the same vertex.
            let floats =
                face.positions[i].into_iter().chain(normals[i]).chain([deviation]).chain(values.clone());
            let key: Vec<u32> = floats.map(|x| (x + 0.0).to_bits()).collect();
            let next = out.positions.len() as u32;
            let at = *known.entry(key).or_insert(next);
            if at == next {
                out.positions.push(face.positions[i]);
                out.normals.push(normals[i]);
                out.deviation_mm.push(deviation);
                for (list, value) in out.scalars.iter_mut().zip(values) {
                    list.push(value);
                }
            }
            merged[i] = Some(at);
            at
        });
        out.triangles.push(corners);
    }
    out.borders = borders(&out.positions, &out.triangles);
    out
}

/// Area-weighted normals of the vertices, out of the side from which the triangles turn counter-clockwise.
fn vertex_normals(face: &FaceMesh) -> Vec<[f32; 3]> {
    let mut sums = vec![[0.0_f64; 3]; face.positions.len()];
    for triangle in &face.triangles {
        let corner = |k: usize| face.positions.get(triangle[k] as usize).map(|p| p.map(f64::from));
        let (Some(a), Some(b), Some(c)) = (corner(0), corner(1), corner(2)) else { continue };
        let (u, v): ([f64; 3], [f64; 3]) =
            (std::array::from_fn(|i| b[i] - a[i]), std::array::from_fn(|i| c[i] - a[i]));
        let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        for &index in triangle {
            for (sum, n) in sums[index as usize].iter_mut().zip(normal) {
                *sum += n;
            }
        }
    }
    sums.into_iter()
        .map(|n| {
            let length = n.iter().map(|x| x * x).sum::<f64>().sqrt();
            // A vertex of degenerate triangles only has no normal; up is as good as any for its shading.
            if length > 0.0 { n.map(|x| (x / length) as f32) } else { [0.0, 0.0, 1.0] }
        })
        .collect()
}

/// Edges between two places that one triangle alone has.
fn borders(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let mut places: HashMap<[u32; 3], u32> = HashMap::new();
    let place: Vec<u32> = positions
        .iter()
        .map(|p| {
            let next = places.len() as u32;
            *places.entry(p.map(|x| (x + 0.0).to_bits())).or_insert(next)
        })
        .collect();
    let mut edges: Vec<([u32; 2], [u32; 2])> = triangles
        .iter()
        .flat_map(|t| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]])
        .map(|e| {
            let ends = e.map(|i| place[i as usize]);
            ([ends[0].min(ends[1]), ends[0].max(ends[1])], e)
        })
        .filter(|(ends, _)| ends[0] != ends[1])
        .collect();
    edges.sort_unstable();
    let alone: Vec<([u32; 2], [u32; 2])> =
        edges.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() == 1).map(|same| same[0]).collect();
    // Of each place where it is.
    let mut points = vec![[0.0; 3]; places.len()];
    for (position, at) in positions.iter().zip(&place) {
        points[*at as usize] = position.map(f64::from);
    }
    let ends: Vec<[u32; 2]> = alone.iter().map(|e| e.0).collect();
    let inner = beside_smaller(&points, &ends);
    alone.iter().zip(inner).filter(|(_, inner)| !inner).map(|(e, _)| e.1).collect()
}

/// How far a chain of small edges may turn off a large one beside which it runs, as a cosine: tessellations bend less within a triangle.
const ALONG: f64 = 0.96;
/// Small edges beside a large one at most.
const CHAIN: usize = 64;

/// Which edges that one triangle alone has lie inside a face all the same: a large triangle beside several small ones has an edge where
/// they have a chain. Edges are given by the places of their ends.
fn beside_smaller(points: &[[f64; 3]], alone: &[[u32; 2]]) -> Vec<bool> {
    let mut around: HashMap<u32, Vec<(usize, u32)>> = HashMap::new();
    for (k, [a, b]) in alone.iter().enumerate() {
        around.entry(*a).or_default().push((k, *b));
        around.entry(*b).or_default().push((k, *a));
    }
    let at = |place: u32| &points[place as usize];
    let mut inner = vec![false; alone.len()];
    for (k, ends) in alone.iter().enumerate() {
        let span = minus(at(ends[1]), at(ends[0]));
        let length = norm(&span);
        let mut chain: Vec<usize> = Vec::new();
        let mut here = ends[0];
        while here != ends[1] && chain.len() < CHAIN {
            let next = around[&here].iter().find(|(edge, other)| {
                let step = minus(at(*other), at(here));
                let way = dot(&minus(at(*other), at(ends[0])), &span) / (length * length);
                let forward = dot(&step, &span) / (norm(&step) * length);
                *edge != k && forward > ALONG && (way < 1.0 - 1e-6 || *other == ends[1])
            });
            let Some((edge, other)) = next else { break };
            chain.push(*edge);
            here = *other;
        }
        if here == ends[1] && chain.len() > 1 {
            inner[k] = true;
            chain.into_iter().for_each(|edge| inner[edge] = true);
        }
    }
    inner
}

fn minus(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn norm(a: &[f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One triangle on the left of a line, two on the right of it: the line is inside, whatever the triangles have there.
    #[test]
    fn a_large_triangle_beside_two_small_ones_has_no_border_between() {
        let face = FaceMesh {
            positions: vec![
                [0.0, 0.0, 0.0],
                [0.0, 2.0, 0.0],
                [-1.0, 1.0, 0.0],
                [0.0, 1.0, 0.01],
                [1.0, 1.0, 0.0],
            ],
            triangles: vec![[0, 1, 2], [0, 4, 3], [3, 4, 1]],
            ..FaceMesh::default()
        };
        let mut found =
            clean(&face, 0).borders.iter().map(|[a, b]| [*a.min(b), *a.max(b)]).collect::<Vec<_>>();
        found.sort_unstable();
        // Vertices come in the order of the triangles: 0, 1, 2 of the large one, then 4 and 3 of the small ones as 3 and 4.
        assert_eq!(found, [[0, 2], [0, 3], [1, 2], [1, 3]]);
        // Without one of the small ones the line is a border.
        let half = FaceMesh { triangles: vec![[0, 1, 2], [0, 4, 3]], ..face };
        assert_eq!(clean(&half, 0).borders.len(), 6);
    }

    /// A unit square of two triangles that share no vertex record.
    fn soup() -> FaceMesh {
        let (a, b, c, d) = ([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, -0.0]);
        FaceMesh {
            positions: vec![a, b, c, a, c, d],
            triangles: vec![[0, 1, 2], [3, 4, 5]],
            deviation_mm: vec![0.001; 6],
            ..FaceMesh::default()
        }
    }

    #[test]
    fn a_square_of_two_triangles_has_four_vertices_and_four_borders() {
        let clean = clean(&soup(), 0);
        assert_eq!((clean.positions.len(), clean.triangles.len(), clean.borders.len()), (4, 2, 4));
        assert!(clean.normals.iter().all(|n| *n == [0.0, 0.0, 1.0]));
    }

    #[test]
    fn vertices_that_differ_in_value_stay_apart_but_are_no_border() {
        let mut face = soup();
        face.deviation_mm[3] = 0.5;
        let clean = clean(&face, 0);
        assert_eq!((clean.positions.len(), clean.borders.len()), (5, 4));
    }

    #[test]
    fn what_cannot_be_drawn_is_counted() {
        let mut face = soup();
        face.triangles.push([0, 1, 99]);
        face.positions[5] = [f32::NAN, 0.0, 0.0];
        let clean = clean(&face, 2);
        assert_eq!((clean.triangles.len(), clean.dropped), (1, 2));
        assert!(clean.scalars.iter().all(|s| s.len() == clean.positions.len()));
    }

    #[test]
    fn a_tube_closes_over_its_seam() {
        let n = 12_u32;
        let ring = |z: f32| {
            (0..=n).map(move |i| {
                let a = std::f32::consts::TAU * (i % n) as f32 / n as f32;
                [a.cos(), a.sin(), z]
            })
        };
        let stride = n + 1;
        let triangles =
            (0..n).flat_map(|i| [[i, i + 1, i + stride], [i + 1, i + 1 + stride, i + stride]]).collect();
        let face =
            FaceMesh { positions: ring(0.0).chain(ring(1.0)).collect(), triangles, ..FaceMesh::default() };
        assert_eq!(clean(&face, 0).borders.len(), 2 * n as usize);
    }
}
