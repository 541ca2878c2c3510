//! Ways of the tool in the plane across its axis.

/// A chain of places in the frame's plane, mm; places on it go by their length along it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Course {
    nodes: Vec<[f64; 2]>,
    /// Length up to each node, mm, growing.
    lengths: Vec<f64>,
}

fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

impl Course {
    /// Through the nodes in their order; None where they are fewer than two different ones.
    pub(super) fn through(all: impl IntoIterator<Item = [f64; 2]>) -> Option<Self> {
        let (mut nodes, mut lengths): (Vec<[f64; 2]>, Vec<f64>) = (Vec::new(), Vec::new());
        for n in all {
            let to = match (nodes.last(), lengths.last()) {
                (Some(l), Some(s)) => s + apart(*l, n),
                _ => 0.0,
            };
            if lengths.last().is_none_or(|s| to > *s) {
                nodes.push(n);
                lengths.push(to);
            }
        }
        (nodes.len() > 1).then_some(Self { nodes, lengths })
    }

    pub(super) fn nodes(&self) -> &[[f64; 2]] {
        &self.nodes
    }

    /// Lengths up to the nodes.
    pub(super) fn lengths(&self) -> &[f64] {
        &self.lengths
    }

    /// The nodes between two lengths.
    pub(super) fn nodes_between(&self, [from, to]: [f64; 2]) -> &[[f64; 2]] {
        let first = self.lengths.partition_point(|l| *l <= from);
        let last = self.lengths.partition_point(|l| *l < to);
        self.nodes.get(first..last).unwrap_or_default()
    }

    /// The place at a length; on a straight line with the first or last piece beyond the ends.
    pub(super) fn at(&self, s: f64) -> [f64; 2] {
        let k = self.lengths.partition_point(|l| *l <= s).clamp(1, self.nodes.len() - 1);
        let (a, b) = (self.nodes[k - 1], self.nodes[k]);
        let f = (s - self.lengths[k - 1]) / (self.lengths[k] - self.lengths[k - 1]);
        [a[0] + (b[0] - a[0]) * f, a[1] + (b[1] - a[1]) * f]
    }

    /// How far the course strays from the chord between two of its lengths, mm.
    pub(super) fn stray(&self, from: f64, to: f64) -> f64 {
        let (a, b) = (self.at(from), self.at(to));
        let long = apart(a, b);
        let off = |p: &[f64; 2]| {
            let w = [p[0] - a[0], p[1] - a[1]];
            if long > 0.0 { ((b[0] - a[0]) * w[1] - (b[1] - a[1]) * w[0]).abs() / long } else { apart(a, *p) }
        };
        self.nodes_between([from, to]).iter().map(off).fold(0.0, f64::max)
    }
}

/// The distance of a place from a straight piece, and how far along that is, 0 to 1.
pub(super) fn from_piece(c: [f64; 2], a: [f64; 2], b: [f64; 2]) -> (f64, f64) {
    let d = [b[0] - a[0], b[1] - a[1]];
    let w = [c[0] - a[0], c[1] - a[1]];
    let l2 = d[0] * d[0] + d[1] * d[1];
    let t = if l2 > 0.0 { ((w[0] * d[0] + w[1] * d[1]) / l2).clamp(0.0, 1.0) } else { 0.0 };
    ((w[0] - t * d[0]).hypot(w[1] - t * d[1]), t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bent_course_by_its_length() {
        let c = Course::through([[0.0, 0.0], [3.0, 0.0], [3.0, 0.0], [3.0, 4.0]]).unwrap();
        assert_eq!((c.lengths().last(), c.nodes().len()), (Some(&7.0), 3));
        assert_eq!((c.at(2.0), c.at(5.0), c.at(8.0)), ([2.0, 0.0], [3.0, 2.0], [3.0, 5.0]));
        // The corner over the chord of a 3-4-5 triangle.
        assert_eq!(c.nodes_between([0.0, 7.0]), [[3.0, 0.0]]);
        assert!(c.nodes_between([3.0, 7.0]).is_empty() && c.nodes_between([5.0, 4.0]).is_empty());
        assert!((c.stray(0.0, 7.0) - 2.4).abs() < 1e-12 && c.stray(3.5, 6.0) == 0.0);
        assert_eq!(from_piece([4.0, 1.0], [3.0, 0.0], [3.0, 4.0]), (1.0, 0.25));
        assert_eq!(Course::through([[1.0, 1.0], [1.0, 1.0]]), None);
    }
}
