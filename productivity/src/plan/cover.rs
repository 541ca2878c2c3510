//! Which stretches of a trimmed face an isoparametric pass must run over.

use osculate_geom::{Axis, Surface};

/// Joins stretches that overlap or lie closer than `gap`.
pub(super) fn union(mut all: Vec<[f64; 2]>, gap: f64) -> Vec<[f64; 2]> {
    all.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut out: Vec<[f64; 2]> = Vec::new();
    for s in all {
        match out.last_mut() {
            Some(l) if s[0] <= l[1] + gap => l[1] = l[1].max(s[1]),
            _ => out.push(s),
        }
    }
    out
}

/// The range of the fixed parameter over which the face has an inside: from its boundary's turns, and rows between.
pub(super) fn across_range(surface: &dyn Surface, along: Axis) -> Option<[f64; 2]> {
    const ROWS: usize = 200;
    let i = surface.domain().get(along.other());
    let empty = |t: f64| surface.spans(along, t).is_empty();
    let rows: Vec<f64> = (0..=ROWS).map(|k| i.at(k as f64 / ROWS as f64)).filter(|t| !empty(*t)).collect();
    let [lo, hi] = surface
        .turns()
        .iter()
        .map(|at| i.bring(at.get(along.other())))
        .chain(rows)
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], t| [lo.min(t), hi.max(t)]);
    // Where only `contains` is known, the inside may begin between two rows.
    let refine = |end: f64, inside: f64| -> f64 {
        let (mut out, mut inn) = (end, inside);
        for _ in 0..40 {
            if empty(out) {
                let m = 0.5 * (out + inn);
                if empty(m) { out = m } else { inn = m }
            }
        }
        out
    };
    let step = i.length() / ROWS as f64;
    let (lo, hi) = (refine((lo - step).max(i.lo), lo), refine((hi + step).min(i.hi), hi));
    (hi > lo).then_some([lo, hi])
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::{Domain, Interval, Jet2, Taylor, Uv, analytic::Plane};

    /// A square with a round hole.
    struct Holed(Plane);
    impl Surface for Holed {
        fn domain(&self) -> Domain {
            self.0.domain()
        }
        fn jet2(&self, uv: Uv) -> Jet2 {
            self.0.jet2(uv)
        }
        fn taylor(&self, uv: Uv, order: usize) -> Taylor {
            self.0.taylor(uv, order)
        }
        fn contains(&self, uv: Uv) -> bool {
            self.0.contains(uv) && (uv.u * uv.u + uv.v * uv.v) > 4.0 && uv.v.abs() < 4.0
        }
    }

    #[test]
    fn spans_stop_at_holes() {
        let i = Interval::new(-5.0, 5.0);
        let s = Holed(Plane::new(Domain { u: i, v: i }));
        let got = s.spans(Axis::U, 1.0);
        let x = 3f64.sqrt();
        assert_eq!(got.len(), 2);
        for (g, w) in got.iter().flat_map(|g| [g.lo, g.hi]).zip([-5.0, -x, x, 5.0]) {
            assert!((g - w).abs() < 1e-9, "{got:?}");
        }
        assert_eq!(s.spans(Axis::U, 3.0), vec![i]);
        let across = across_range(&s, Axis::U).unwrap();
        assert!((across[0] + 4.0).abs() < 1e-4 && (across[1] - 4.0).abs() < 1e-4);
        assert_eq!(union(vec![[3.0, 4.0], [0.0, 1.0], [0.9, 2.0]], 0.1), vec![[0.0, 2.0], [3.0, 4.0]]);
    }
}
