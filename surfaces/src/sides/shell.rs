//! Whether faces close around material by themselves: the volume behind them.

use crate::part::Face;
use osculate_geom::{Box3, Jet2, Point3, Side, Vec3};
use rayon::prelude::*;

/// Accuracy of the integrals, relative to each face.
const ACCURACY: f64 = 1e-4;
/// The normals times areas of a closed shell cancel; what is left is below this part of the area.
const LEAK: f64 = 1e-3;
/// Volumes below this part of area times size may be none.
const THIN: f64 = 1e-4;

/// The sign of the volume behind faces on the sides given, where they close.
pub(crate) fn volume_sign(faces: &[(&Face, Side)]) -> Option<f64> {
    let around = faces.iter().fold(Box3::empty(), |b, f| b.union(&f.0.surface.bbox(1)));
    let (from, size_mm) = (around.centre(), around.diagonal_mm());
    let parts: Vec<(f64, Vec3, f64)> = faces.par_iter().map(|(f, side)| of(f, *side, &from)).collect();
    let (mut area, mut leak, mut volume) = (0.0, Vec3::zeros(), 0.0);
    for p in parts {
        area += p.0;
        leak += p.1;
        volume += p.2;
    }
    let error = leak.norm().max(THIN * area) * size_mm;
    (leak.norm() <= LEAK * area && volume.abs() > error).then(|| volume.signum())
}

/// Area, normal times area, and volume seen from a point.
fn of(face: &Face, side: Side, from: &Point3) -> (f64, Vec3, f64) {
    let over = |f: &dyn Fn(&Vec3, &Point3) -> f64| {
        let of = |jet: &Jet2| jet.normal().map_or(0.0, |n| f(&n, &jet.point));
        face.surface.integrate(ACCURACY, &of)
    };
    let leak = Vec3::new(over(&|n, _| n.x), over(&|n, _| n.y), over(&|n, _| n.z)) * side.sign();
    let volume = over(&|n, p| (p - from).dot(n) / 3.0) * side.sign();
    (over(&|_, _| 1.0), leak, volume)
}
