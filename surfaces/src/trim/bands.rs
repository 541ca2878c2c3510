//! Even-odd crossing counts against many segments, indexed by bands of the first coordinate.
//!
//! A query counts the segments below it (smaller second coordinate). Bands end at segment ends, so a band holds only
//! segments that pass through it, usually two or four; the count is then a binary search and a handful of
//! comparisons. Ends follow the half-open rule `a <= x < b`, so that a vertex counts once.

/// A segment in the plane, from `a` to `b`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Segment {
    /// Start, `[x, y]`.
    pub(crate) a: [f64; 2],
    /// End.
    pub(crate) b: [f64; 2],
}

impl Segment {
    /// The same segment with the coordinates exchanged.
    pub(crate) const fn swapped(&self) -> Self {
        Self { a: [self.a[1], self.a[0]], b: [self.b[1], self.b[0]] }
    }

    /// Second coordinate where the first is `x`; the segment must not be vertical.
    fn at(&self, x: f64) -> f64 {
        let ([x0, y0], [x1, y1]) = (self.a, self.b);
        // From the nearer end, so that both ends are met exactly.
        if (x - x0).abs() <= (x1 - x).abs() {
            y0 + (x - x0) * ((y1 - y0) / (x1 - x0))
        } else {
            y1 - (x1 - x) * ((y1 - y0) / (x1 - x0))
        }
    }
}

/// Most band entries per segment before neighbouring bands are joined; bounds the memory for shapes like combs, where
/// every band is crossed by nearly every segment.
const ENTRIES_PER_SEGMENT: usize = 64;

/// Segments sorted into bands.
#[derive(Clone, Debug, Default)]
pub(crate) struct Bands {
    /// Band ends, ascending; band `k` is `edges[k] .. edges[k + 1]`.
    edges: Vec<f64>,
    /// First entry of each band, and one past the last.
    start: Vec<u32>,
    /// The segments of all bands, each running upwards in x.
    entries: Vec<Segment>,
}

impl Bands {
    /// Sorts segments into bands. Vertical segments are never crossed and are left out.
    pub(crate) fn new(segments: &[Segment]) -> Self {
        let mut rising: Vec<Segment> = Vec::with_capacity(segments.len());
        for s in segments {
            match s.a[0].total_cmp(&s.b[0]) {
                std::cmp::Ordering::Less => rising.push(*s),
                std::cmp::Ordering::Greater => rising.push(Segment { a: s.b, b: s.a }),
                std::cmp::Ordering::Equal => {}
            }
        }
        let mut ends: Vec<f64> = rising.iter().flat_map(|s| [s.a[0], s.b[0]]).collect();
        ends.sort_by(f64::total_cmp);
        ends.dedup();
        if ends.len() < 2 {
            return Self::default();
        }
        let limit = ENTRIES_PER_SEGMENT * rising.len();
        let mut stride = 1;
        loop {
            let mut edges: Vec<f64> = ends.iter().copied().step_by(stride).collect();
            let last = ends[ends.len() - 1];
            if edges[edges.len() - 1] < last {
                edges.push(last);
            }
            let bands = edges.len() - 1;
            let range = |s: &Segment| {
                let lo = edges.partition_point(|e| *e <= s.a[0]).saturating_sub(1);
                let hi = edges.partition_point(|e| *e < s.b[0]).min(bands);
                lo..hi
            };
            let total: usize = rising.iter().map(|s| range(s).len()).sum();
            if total > limit && bands > 1 {
                stride *= 2;
                continue;
            }
            let mut start = vec![0_u32; bands + 1];
            for s in &rising {
                for k in range(s) {
                    start[k + 1] += 1;
                }
            }
            for k in 0..bands {
                start[k + 1] += start[k];
            }
            let mut fill = start.clone();
            let mut entries = vec![Segment { a: [0.0; 2], b: [0.0; 2] }; total];
            for s in &rising {
                for k in range(s) {
                    entries[fill[k] as usize] = *s;
                    fill[k] += 1;
                }
            }
            return Self { edges, start, entries };
        }
    }

    /// The segments of the band that holds `x`.
    fn band(&self, x: f64) -> &[Segment] {
        let k = self.edges.partition_point(|e| *e <= x);
        if k == 0 || k >= self.edges.len() {
            return &[];
        }
        &self.entries[self.start[k - 1] as usize..self.start[k] as usize]
    }

    /// Number of segments below the point.
    pub(crate) fn below(&self, x: f64, y: f64) -> usize {
        let mut n = 0;
        for s in self.band(x) {
            if s.a[0] <= x && x < s.b[0] && s.at(x) < y {
                n += 1;
            }
        }
        n
    }

    /// Second coordinates of all crossings of the line `x = const`, ascending.
    pub(crate) fn crossings(&self, x: f64) -> Vec<f64> {
        let hit = self.band(x).iter().filter(|s| s.a[0] <= x && x < s.b[0]);
        let mut ys: Vec<f64> = hit.map(|s| s.at(x)).collect();
        ys.sort_by(f64::total_cmp);
        ys
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygon(points: &[[f64; 2]]) -> Vec<Segment> {
        (0..points.len()).map(|k| Segment { a: points[k], b: points[(k + 1) % points.len()] }).collect()
    }

    #[test]
    fn square_counts() {
        let bands = Bands::new(&polygon(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]));
        assert_eq!(bands.below(0.5, 0.5), 1);
        assert_eq!(bands.below(0.5, 1.5), 2);
        assert_eq!(bands.below(0.5, -0.5), 0);
        assert_eq!(bands.below(-0.5, 0.5) + bands.below(1.5, 0.5), 0);
        assert_eq!(bands.crossings(0.25), [0.0, 1.0]);
    }

    #[test]
    fn a_vertex_counts_once() {
        // A diamond: the vertical line through its lower corner meets one edge there, not two or none.
        let bands = Bands::new(&polygon(&[[0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]]));
        assert_eq!(bands.below(0.0, 0.0), 1);
        assert_eq!(bands.below(0.0, 2.0), 2);
    }

    #[test]
    fn a_comb_stays_small_and_right() {
        // 1000 teeth along x: every vertical line crosses every tooth.
        let mut points = Vec::new();
        for k in 0..1000 {
            let y = f64::from(k);
            points.push([if k % 2 == 0 { 0.0 } else { 1e-4 * f64::from(k) }, y]);
            points.push([10.0 - 1e-4 * f64::from(k), y + 0.5]);
        }
        points.push([-5.0, 999.0]);
        points.push([-5.0, 0.0]);
        let segments = polygon(&points);
        let bands = Bands::new(&segments);
        assert!(bands.entries.len() <= ENTRIES_PER_SEGMENT * segments.len());
        let brute = |x: f64, y: f64| {
            segments
                .iter()
                .filter(|s| (s.a[0] <= x) != (s.b[0] <= x))
                .filter(|s| s.a[1] + (x - s.a[0]) * (s.b[1] - s.a[1]) / (s.b[0] - s.a[0]) < y)
                .count()
        };
        for k in 0..400 {
            let (x, y) = (f64::from(k % 23) * 0.613 - 4.9, f64::from(k) * 2.501);
            assert_eq!(bands.below(x, y), brute(x, y), "({x}, {y})");
        }
    }
}
