//! Triangles of the faces of a body with a tree of boxes over them: which come near a box, and which is nearest to a point.

use osculate_geom::{Box3, Point3, Uv, uv};

/// Triangles of a leaf at most.
const LEAF: usize = 4;

/// A triangle of a face.
#[derive(Clone, Debug)]
pub(super) struct Patch {
    /// Number of the face.
    pub(super) face: usize,
    /// Parameters of the corners.
    pub(super) at: [Uv; 3],
    /// The corners, mm.
    pub(super) corners: [Point3; 3],
}

/// The triangle nearest to a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    /// Number of the triangle.
    pub(super) patch: usize,
    /// Distance, mm.
    pub(super) distance_mm: f64,
    /// Parameters of the nearest point of the triangle.
    pub(super) at: Uv,
}

/// A box with its children or its triangles.
#[derive(Clone, Debug)]
struct Node {
    around: Box3,
    /// First triangle and their number, for leaves; number of the second child and zero, for others.
    what: (usize, usize),
}

/// Triangles with a tree over them.
#[derive(Clone, Debug)]
pub(super) struct Soup {
    nodes: Vec<Node>,
    /// In the order of the tree.
    pub(super) patches: Vec<Patch>,
}

impl Soup {
    /// A tree over triangles; those that are not finite are left out.
    pub(super) fn new(mut patches: Vec<Patch>) -> Self {
        patches.retain(|t| t.corners.iter().all(|p| p.coords.iter().all(|c| c.is_finite())));
        let mut soup = Self { nodes: Vec::new(), patches };
        if !soup.patches.is_empty() {
            soup.build(0, soup.patches.len());
        }
        soup
    }

    fn build(&mut self, from: usize, to: usize) {
        let part = &mut self.patches[from..to];
        let around = Box3::around(part.iter().flat_map(|t| &t.corners));
        let number = self.nodes.len();
        self.nodes.push(Node { around, what: (from, to - from) });
        if to - from <= LEAF {
            return;
        }
        let axis = (around.max - around.min).imax();
        let key = |t: &Patch| t.corners[0][axis] + t.corners[1][axis] + t.corners[2][axis];
        let middle = (to - from) / 2;
        part.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)));
        self.build(from, from + middle);
        self.nodes[number].what = (self.nodes.len(), 0);
        self.build(from + middle, to);
    }

    /// Numbers of the triangles whose boxes meet a box.
    pub(super) fn meeting(&self, b: &Box3) -> Vec<usize> {
        let mut found = Vec::new();
        let mut waiting = vec![0];
        while let Some(k) = waiting.pop() {
            let Some(node) = self.nodes.get(k) else { continue };
            if !overlap(&node.around, b) {
                continue;
            }
            match node.what {
                (second, 0) => waiting.extend([second, k + 1]),
                (from, count) => {
                    let near = |t: &usize| overlap(&Box3::around(&self.patches[*t].corners), b);
                    found.extend((from..from + count).filter(near));
                }
            }
        }
        found
    }

    /// The triangle nearest to a point; none where there are no triangles.
    pub(super) fn nearest(&self, p: &Point3) -> Option<Nearest> {
        let mut best: Option<Nearest> = None;
        let mut waiting = vec![(0.0, 0)];
        while let Some((far, k)) = waiting.pop() {
            let Some(node) = self.nodes.get(k) else { continue };
            if best.is_some_and(|b| far >= b.distance_mm) {
                continue;
            }
            match node.what {
                (second, 0) => {
                    let child = |c: usize| (off(&self.nodes[c].around, p), c);
                    let (a, b) = (child(k + 1), child(second));
                    // The nearer child comes first.
                    waiting.extend(if a.0 <= b.0 { [b, a] } else { [a, b] });
                }
                (from, count) => {
                    for patch in from..from + count {
                        let t = &self.patches[patch];
                        let w = foot(p, &t.corners);
                        let q = t.corners[0].coords * w[0]
                            + t.corners[1].coords * w[1]
                            + t.corners[2].coords * w[2];
                        let distance_mm = (p.coords - q).norm();
                        if best.is_none_or(|b| distance_mm < b.distance_mm) {
                            best = Some(Nearest { patch, distance_mm, at: blend(&t.at, w) });
                        }
                    }
                }
            }
        }
        best
    }
}

/// The parameters that weights of the corners make.
pub(super) fn blend(at: &[Uv; 3], w: [f64; 3]) -> Uv {
    uv(at[0].u * w[0] + at[1].u * w[1] + at[2].u * w[2], at[0].v * w[0] + at[1].v * w[1] + at[2].v * w[2])
}

/// Whether two boxes have a point in common.
pub(super) fn overlap(a: &Box3, b: &Box3) -> bool {
    (0..3).all(|k| a.min[k] <= b.max[k] && b.min[k] <= a.max[k])
}

/// Distance of a point from a box, mm.
fn off(b: &Box3, p: &Point3) -> f64 {
    (0..3).map(|k| (b.min[k] - p[k]).max(p[k] - b.max[k]).max(0.0).powi(2)).sum::<f64>().sqrt()
}

/// Weights of the corners at the point of a triangle nearest to `p`.
fn foot(p: &Point3, [a, b, c]: &[Point3; 3]) -> [f64; 3] {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(&ap), ac.dot(&ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(&bp), ac.dot(&bp));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let t = d1 / (d1 - d3);
        return [1.0 - t, t, 0.0];
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(&cp), ac.dot(&cp));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let t = d2 / (d2 - d6);
        return [1.0 - t, 0.0, t];
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return [0.0, 1.0 - t, t];
    }
    let sum = va + vb + vc;
    if sum > 0.0 { [va / sum, vb / sum, vc / sum] } else { [1.0, 0.0, 0.0] }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The tree finds what looking at every triangle finds.
    #[test]
    fn the_tree_finds_what_all_triangles_find() {
        let mut seed = 11_u64;
        let mut next = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut point = |size: f64| Point3::new(size * next(), size * next(), size * next());
        let patches: Vec<Patch> = (0..300)
            .map(|face| {
                let c = point(1.0);
                let corners = [0; 3].map(|_| c + point(0.2).coords);
                Patch { face, at: [uv(0.0, 0.0), uv(1.0, 0.0), uv(0.0, 1.0)], corners }
            })
            .collect();
        let soup = Soup::new(patches.clone());
        for _ in 0..200 {
            let p = point(1.3);
            let found = soup.nearest(&p).unwrap();
            // A fine grid of every triangle: never nearer, and about as near.
            let mut least = f64::INFINITY;
            for t in &patches {
                for i in 0..=20 {
                    for j in 0..=20 - i {
                        let w = [f64::from(i) / 20.0, f64::from(j) / 20.0, f64::from(20 - i - j) / 20.0];
                        let q: osculate_geom::Vec3 = (0..3).map(|k| t.corners[k].coords * w[k]).sum();
                        least = least.min((p.coords - q).norm());
                    }
                }
            }
            // Nodes are at most 0.02 apart along a side of at most 0.35.
            assert!(found.distance_mm <= least + 1e-12 && found.distance_mm >= least - 0.02);
            let b = Box3::around(&[p, p + point(0.1).coords]);
            let mut got: Vec<usize> = soup.meeting(&b).iter().map(|t| soup.patches[*t].face).collect();
            got.sort_unstable();
            let all: Vec<usize> =
                patches.iter().filter(|t| overlap(&Box3::around(&t.corners), &b)).map(|t| t.face).collect();
            assert_eq!(got, all);
        }
        assert!(Soup::new(Vec::new()).nearest(&Point3::origin()).is_none());
    }
}
