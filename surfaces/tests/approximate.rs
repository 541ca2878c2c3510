//! Approximation of any surface: offsets within the error that is stated.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common;

use osculate_geom::analytic::Torus;
use osculate_geom::offset::Offset;
use osculate_geom::{Domain, Interval, Surface, Uv, uv};
use osculate_surfaces::{ApproximateError, approximate};

#[test]
fn offsets_keep_the_error_that_is_stated() {
    let base = Torus::new(40.0, 9.0).unwrap();
    let offset = Offset::new(base, 2.0).unwrap();
    let exact = Torus::new(40.0, 11.0).unwrap();
    for tolerance in [1e-2, 1e-4, 1e-6] {
        let part = Domain { u: Interval::new(0.0, 2.0), v: Interval::new(0.3, 2.9) };
        let a = approximate(&offset, &part, tolerance).unwrap();
        assert!(a.error_mm <= tolerance && a.rms_mm <= a.error_mm);
        let mut worst = 0.0_f64;
        for i in 0..=120 {
            for k in 0..=120 {
                let at = part.at(f64::from(i) / 120.0, f64::from(k) / 120.0);
                worst = worst.max((a.surface.point(at) - exact.point(at)).norm());
            }
        }
        // Sixteen places of a cell see all but a few percent of the largest error.
        assert!(worst <= 1.1 * a.error_mm, "{worst} {}", a.error_mm);
        assert!(worst >= 1e-3 * tolerance, "{worst}: far more cells than needed");
    }
    let spline = common::reference(true);
    let offset = Offset::new(&spline, 0.5).unwrap();
    let a = approximate(&offset, &spline.domain(), 1e-3).unwrap();
    let at: Uv = uv(0.37, 0.61);
    assert!((a.surface.point(at) - offset.point(at)).norm() <= 1e-3);
    let tight = approximate(&offset, &spline.domain(), 1e-16);
    assert!(matches!(tight, Err(ApproximateError::TooFine { .. })), "{tight:?}");
    assert!(matches!(
        approximate(&offset, &spline.domain(), f64::NAN),
        Err(ApproximateError::Tolerance { .. })
    ));
}
