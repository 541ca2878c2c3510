//! A tree of boxes over triangles that counts how often a ray crosses them.

use osculate_geom::{Box3, Point3, Vec3};

/// Triangles of a leaf at most.
const LEAF: usize = 4;

/// A box with its children or its triangles.
#[derive(Clone, Debug)]
struct Node {
    around: Box3,
    /// First triangle and their number, for leaves; number of the second child and zero, for others.
    what: (usize, usize),
}

/// Triangles with a tree over them.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    nodes: Vec<Node>,
    triangles: Vec<[Point3; 3]>,
}

impl Tree {
    /// A tree over triangles; those that are not finite are left out.
    pub(crate) fn new(mut triangles: Vec<[Point3; 3]>) -> Self {
        triangles.retain(|t| t.iter().all(|p| p.coords.iter().all(|c| c.is_finite())));
        let mut tree = Self { nodes: Vec::new(), triangles };
        if !tree.triangles.is_empty() {
            tree.build(0, tree.triangles.len());
        }
        tree
    }

    fn build(&mut self, from: usize, to: usize) {
        let part = &mut self.triangles[from..to];
        let around = Box3::around(part.iter().flatten());
        let number = self.nodes.len();
        self.nodes.push(Node { around, what: (from, to - from) });
        if to - from <= LEAF {
            return;
        }
        let axis = (around.max - around.min).imax();
        let key = |t: &[Point3; 3]| t[0][axis] + t[1][axis] + t[2][axis];
        let middle = (to - from) / 2;
        part.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)));
        self.build(from, from + middle);
        self.nodes[number].what = (self.nodes.len(), 0);
        self.build(from + middle, to);
    }

    /// How many triangles the ray from `p` along the unit vector `d` crosses farther off than `skip_mm`.
    pub(crate) fn crossings(&self, p: &Point3, d: &Vec3, skip_mm: f64) -> usize {
        let inverse = d.map(|c| 1.0 / c);
        let mut found = 0;
        let mut waiting = vec![0];
        while let Some(k) = waiting.pop() {
            let Some(node) = self.nodes.get(k) else { continue };
            if !meets(&node.around, p, &inverse) {
                continue;
            }
            match node.what {
                (second, 0) => waiting.extend([second, k + 1]),
                (from, count) => {
                    let part = &self.triangles[from..from + count];
                    found += part.iter().filter(|t| crosses(p, d, t, skip_mm)).count();
                }
            }
        }
        found
    }
}

/// Whether a ray meets a box; doubt counts as yes.
fn meets(b: &Box3, p: &Point3, inverse: &Vec3) -> bool {
    let (mut near, mut far) = (0.0_f64, f64::INFINITY);
    for k in 0..3 {
        if inverse[k].is_infinite() {
            if p[k] < b.min[k] || p[k] > b.max[k] {
                return false;
            }
            continue;
        }
        let (s, t) = ((b.min[k] - p[k]) * inverse[k], (b.max[k] - p[k]) * inverse[k]);
        near = near.max(s.min(t));
        far = far.min(s.max(t));
    }
    near <= far * (1.0 + 1e-12) + 1e-12
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

    /// Triangles all over a box: the tree counts what looking at each of them counts.
    #[test]
    fn the_tree_counts_what_all_triangles_count() {
        let mut seed = 7_u64;
        let mut next = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut point = || Point3::new(next(), next(), next());
        let triangles: Vec<[Point3; 3]> = (0..400).map(|_| [point(), point(), point()]).collect();
        let tree = Tree::new(triangles.clone());
        let mut met = 0;
        for k in 0..300 {
            let p = point();
            let d = [Vec3::x(), -Vec3::z(), (point() - p).normalize()][k % 3];
            let all = triangles.iter().filter(|t| crosses(&p, &d, t, 1e-6)).count();
            assert_eq!(tree.crossings(&p, &d, 1e-6), all, "{k}");
            met += all;
        }
        assert!(met > 1000);
        assert_eq!(Tree::new(Vec::new()).crossings(&Point3::origin(), &Vec3::x(), 0.0), 0);
    }
}
