//! Spline surfaces swept from a generatrix: extrusion and revolution, exactly.

use super::spline::Spline;
use crate::nurbs::{CurveError, Net, NurbsError, NurbsSurface};
use osculate_geom::analytic::Placement;
use osculate_geom::{Point3, Vec3};

/// Why a generatrix sweeps no surface.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub(crate) enum SweepError {
    /// The turn is no arc.
    #[error(transparent)]
    Arc(#[from] CurveError),
    /// The net is no surface.
    #[error(transparent)]
    Surface(#[from] NurbsError),
}

/// The surface `generatrix(u) + v * direction` for v over `range`.
///
/// # Errors
/// [`SweepError`].
pub(crate) fn extrude(
    generatrix: &Spline,
    direction: &Vec3,
    range: [f64; 2],
) -> Result<NurbsSurface, SweepError> {
    let curve = generatrix.curve();
    let n = curve.poles().len();
    let mut points = Vec::with_capacity(2 * n);
    let mut weights = Vec::with_capacity(2 * n);
    for (k, p) in curve.poles().iter().enumerate() {
        for v in range {
            points.push(p + direction * v);
            weights.push(generatrix.weight(k));
        }
    }
    let weights = curve.weights().is_some().then_some(weights);
    let knots = [curve.knots().as_slice().to_vec(), vec![range[0], range[0], range[1], range[1]]];
    Ok(NurbsSurface::new([curve.degree(), 1], knots, Net { count: [n, 2], points, weights })?)
}

/// The surface swept by turning the generatrix about the z axis of `axis`, u the turn over `angles` (not
/// proportional to the angle), v along the generatrix.
///
/// # Errors
/// [`SweepError`].
pub(crate) fn revolve(
    generatrix: &Spline,
    axis: &Placement,
    angles: [f64; 2],
) -> Result<NurbsSurface, SweepError> {
    let turn = Spline::arc(Point3::origin(), Vec3::x(), Vec3::y(), angles)?;
    let (around, along) = (turn.curve(), generatrix.curve());
    let (n, m) = (around.poles().len(), along.poles().len());
    let mut points = Vec::with_capacity(n * m);
    let mut weights = Vec::with_capacity(n * m);
    for (i, pole) in around.poles().iter().enumerate() {
        for (j, p) in along.poles().iter().enumerate() {
            let q = axis.local(p);
            // The turn's pole is a complex number by which x + iy is multiplied.
            let turned = Point3::new(q.x * pole.x - q.y * pole.y, q.x * pole.y + q.y * pole.x, q.z);
            points.push(axis.point(&turned));
            weights.push(turn.weight(i) * generatrix.weight(j));
        }
    }
    let net = Net { count: [n, m], points, weights: Some(weights) };
    let knots = [around, along].map(|c| c.knots().as_slice().to_vec());
    Ok(NurbsSurface::new([around.degree(), along.degree()], knots, net)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::{Surface, Unit3, uv};

    #[test]
    fn a_turned_line_is_a_cone() {
        let z = Unit3::new_normalize(Vec3::new(1.0, 2.0, -0.5));
        let axis = Placement::new(Point3::new(3.0, -1.0, 2.0), z, None);
        let ends = [Point3::new(2.0, 0.0, 0.0), Point3::new(5.0, 0.0, 4.0)].map(|p| axis.point(&p));
        let cone = revolve(&Spline::polyline(ends.to_vec()).unwrap(), &axis, [0.4, 0.4 + 4.5]).unwrap();
        for k in 0..40 {
            let at = cone.domain().at(f64::from(k) / 39.0, f64::from(k % 7) / 6.0);
            let q = axis.local(&cone.point(at));
            // r = 2 + 3/4 z; coordinates of size 10.
            assert!((q.x.hypot(q.y) - 2.0 - 0.75 * q.z).abs() < 1e-13, "{at:?}");
        }
        // Beginning and end of the turn.
        let angle = |u: f64| {
            let q = axis.local(&cone.point(uv(u, 0.0)));
            q.y.atan2(q.x).rem_euclid(std::f64::consts::TAU)
        };
        assert!((angle(cone.domain().u.lo) - 0.4).abs() < 1e-14);
        assert!((angle(cone.domain().u.hi) - 4.9).abs() < 1e-14);
    }

    #[test]
    fn an_extruded_arc_is_a_cylinder() {
        let arc = Spline::arc(Point3::origin(), Vec3::x() * 3.0, Vec3::y() * 3.0, [0.0, 2.0]).unwrap();
        let wall = extrude(&arc, &(Vec3::z() * 2.0), [-1.0, 4.0]).unwrap();
        for k in 0..20 {
            let p = wall.point(wall.domain().at(f64::from(k) / 19.0, 0.3));
            assert!((p.x.hypot(p.y) - 3.0).abs() < 1e-14 && (p.z - 1.0).abs() < 1e-14);
        }
    }
}
