//! Which stretches of a trimmed face an isoparametric pass must run over.

use osculate_geom::{Axis, Surface, Uv};

/// Stretches of inside along one isoparametric line: found on a grid of `n` cells, ends refined by bisection.
pub(super) fn spans(surface: &dyn Surface, along: Axis, fixed: f64, n: usize) -> Vec<[f64; 2]> {
    let i = surface.domain().get(along);
    let inside = |t: f64| surface.contains(Uv::from_axis(along, t, fixed));
    let edge = |mut a: f64, mut b: f64| -> f64 {
        // `a` is inside, `b` is not; forty halvings exhaust what matters of a cell.
        for _ in 0..40 {
            let m = 0.5 * (a + b);
            if inside(m) { a = m } else { b = m }
        }
        a
    };
    let mut out: Vec<[f64; 2]> = Vec::new();
    let mut open: Option<f64> = None;
    let mut last = i.lo;
    for k in 0..=n {
        let t = i.at(k as f64 / n as f64);
        match (inside(t), open) {
            (true, None) => open = Some(if k == 0 { t } else { edge(t, last) }),
            (false, Some(start)) => {
                out.push([start, edge(last, t)]);
                open = None;
            }
            _ => {}
        }
        last = t;
    }
    if let Some(start) = open {
        out.push([start, i.hi]);
    }
    out
}

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

/// The range of the fixed parameter over which the face has an inside, to a two-hundredth of the domain outward.
pub(super) fn across_range(surface: &dyn Surface, along: Axis) -> Option<[f64; 2]> {
    const ROWS: usize = 200;
    let i = surface.domain().get(along.other());
    let has = |k: usize| !spans(surface, along, i.at(k as f64 / ROWS as f64), 200).is_empty();
    let first = (0..=ROWS).find(|k| has(*k))?;
    let last = (0..=ROWS).rev().find(|k| has(*k))?;
    // Between the last row without and the first with an inside, by bisection.
    let refine = |out: f64, inn: f64| -> f64 {
        let (mut out, mut inn) = (out, inn);
        for _ in 0..12 {
            let m = 0.5 * (out + inn);
            if spans(surface, along, m, 400).is_empty() { out = m } else { inn = m }
        }
        out
    };
    let at = |k: usize| i.at(k as f64 / ROWS as f64);
    let lo = if first == 0 { i.lo } else { refine(at(first - 1), at(first)) };
    let hi = if last == ROWS { i.hi } else { refine(at(last + 1), at(last)) };
    (hi > lo).then_some([lo, hi])
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::{Domain, Interval, Jet2, Taylor, analytic::Plane};

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
        let got = spans(&s, Axis::U, 1.0, 50);
        let x = 3f64.sqrt();
        assert_eq!(got.len(), 2);
        for (g, w) in got.iter().flatten().zip([-5.0, -x, x, 5.0]) {
            assert!((g - w).abs() < 1e-9, "{got:?}");
        }
        assert_eq!(spans(&s, Axis::U, 3.0, 50), vec![[-5.0, 5.0]]);
        let across = across_range(&s, Axis::U).unwrap();
        assert!((across[0] + 4.0).abs() < 1e-4 && (across[1] - 4.0).abs() < 1e-4);
        assert_eq!(union(vec![[3.0, 4.0], [0.0, 1.0], [0.9, 2.0]], 0.1), vec![[0.0, 2.0], [3.0, 4.0]]);
    }
}
