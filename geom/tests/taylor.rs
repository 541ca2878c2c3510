//! A Taylor polynomial away from its place against the surface's own jets there.

use osculate_geom::analytic::{Paraboloid, Torus};
use osculate_geom::{Jet2, Surface, Uv, uv};
use proptest::prelude::*;
use std::f64::consts::{SQRT_2, TAU};

/// The greatest distance between parts of two jets.
fn apart(a: &Jet2, b: &Jet2) -> f64 {
    let vectors = [a.du - b.du, a.dv - b.dv, a.duu - b.duu, a.duv - b.duv, a.dvv - b.dvv];
    vectors.iter().map(|v| v.norm()).fold((a.point - b.point).norm(), f64::max)
}

/// The distance of the jet told from `from` from the jet at `step` beyond it.
fn off(s: &dyn Surface, from: Uv, step: Uv, order: usize) -> f64 {
    let at = uv(from.u + step.u, from.v + step.v);
    let told = s.taylor(from, order).jet2_at(at);
    assert_eq!((told.uv, told.side), (at, s.jet2(at).side));
    apart(&told, &s.jet2(at))
}

proptest! {
    /// A paraboloid is its own polynomial of second order, wherever that is asked.
    #[test]
    fn polynomials_are_exact_anywhere(
        (a, b) in (-2.0f64..2.0, -2.0f64..2.0),
        (du, dv) in (-3.0f64..3.0, -3.0f64..3.0),
        order in 2usize..6,
    ) {
        let s = Paraboloid::new([0.3, -0.7], 10.0).unwrap();
        prop_assert!(off(&s, uv(a, b), uv(du, dv), order) < 1e-12);
    }

    /// Second derivatives are off by the remainder of Lagrange, whose order the worst direction reaches.
    #[test]
    fn the_error_has_the_order_of_the_remainder((a, b) in (0.0f64..6.0, 0.0f64..6.0), order in 3usize..6) {
        let (major, minor) = (5.0, 2.0);
        let s = Torus::new(major, minor).unwrap();
        for h in [0.2, 0.02] {
            let turns = (0..16).map(|k| f64::from(k) * TAU / 16.0);
            let worst = turns.map(|t| off(&s, uv(a, b), uv(h * t.cos(), h * t.sin()), order)).fold(0.0, f64::max);
            // No derivative is longer than both radii together.
            let factorial: f64 = (1..order).map(|k| k as f64).product();
            let remainder = (major + minor) * (SQRT_2 * h).powi(order as i32 - 1) / factorial;
            prop_assert!((0.02 * remainder..=remainder).contains(&worst), "{worst} of {remainder}");
        }
    }
}
