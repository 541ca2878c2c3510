//! Surfaces and frames to and from their specs.

use super::fault::{FaceFault, possible};
use super::spec;
use crate::nurbs::{Net, NurbsSurface};
use crate::trim::analytic::{Analytic, Shape};
use crate::trim::carrier::FaceSurface;
use osculate_geom::analytic::Placement;
use osculate_geom::{Axis, Offset, Point3, Side, Unit3, Vec3};
use std::sync::Arc;

pub(super) const fn of_side(side: Side) -> spec::Side {
    match side {
        Side::Along => spec::Side::Along,
        Side::Against => spec::Side::Against,
    }
}

pub(super) fn of_frame(f: &Placement) -> spec::Frame {
    spec::Frame { origin_mm: f.origin.coords.into(), x: f.x.into_inner().into(), z: f.z.into_inner().into() }
}

/// Axes within this of units at right angles are a frame; written ones are to the last digit.
const SQUARE: f64 = 1e-9;

/// Axes within this are taken as they are, so that what was written comes back to the bit.
const EXACT: f64 = 1e-14;

pub(super) fn to_frame(f: &spec::Frame) -> Result<Placement, FaceFault> {
    let (x, z) = (Vec3::from(f.x), Vec3::from(f.z));
    let off = (x.norm() - 1.0).abs().max((z.norm() - 1.0).abs()).max(x.dot(&z).abs());
    if off.is_nan() || off > SQUARE {
        return Err(FaceFault::Frame { x: f.x, z: f.z });
    }
    let origin = to_point(f.origin_mm)?;
    if off <= EXACT {
        let y = Unit3::new_unchecked(z.cross(&x));
        return Ok(Placement { origin, x: Unit3::new_unchecked(x), y, z: Unit3::new_unchecked(z) });
    }
    Ok(Placement::new(origin, Unit3::new_normalize(z), Some(x)))
}

pub(super) fn to_point(p: [f64; 3]) -> Result<Point3, FaceFault> {
    if p.iter().all(|c| c.is_finite()) {
        Ok(p.into())
    } else {
        Err(FaceFault::Number { what: "a coordinate" })
    }
}

pub(super) fn of_surface(surface: &FaceSurface) -> spec::Surface {
    match surface {
        FaceSurface::Analytic(a) => {
            let frame = of_frame(a.placement());
            match a.shape() {
                Shape::Plane => spec::Surface::Plane(spec::Plane { frame }),
                Shape::Cylinder { radius_mm } => spec::Surface::Cylinder(spec::Round { frame, radius_mm }),
                Shape::Cone { radius_mm, half_angle_rad } => {
                    spec::Surface::Cone(spec::Cone { frame, radius_mm, half_angle_rad })
                }
                Shape::Sphere { radius_mm } => spec::Surface::Sphere(spec::Round { frame, radius_mm }),
                Shape::Torus { major_radius_mm, minor_radius_mm } => {
                    spec::Surface::Torus(spec::Torus { frame, major_radius_mm, minor_radius_mm })
                }
                Shape::Lemon { major_radius_mm, minor_radius_mm } => {
                    spec::Surface::Lemon(spec::Torus { frame, major_radius_mm, minor_radius_mm })
                }
            }
        }
        FaceSurface::Offset(o) => {
            spec::Surface::Offset(spec::Offset { base: of_nurbs(o.base()), distance_mm: o.distance_mm() })
        }
        FaceSurface::Nurbs(n) => spec::Surface::Nurbs(of_nurbs(n)),
    }
}

fn of_nurbs(n: &NurbsSurface) -> spec::Nurbs {
    let net = n.net();
    let row = net.count[1];
    let knots = [Axis::U, Axis::V].map(|axis| n.knots(axis).as_slice().to_vec());
    let poles = net.points.chunks(row).map(|r| r.iter().map(|p| p.coords.into()).collect());
    spec::Nurbs {
        degree: n.degree(),
        knots,
        poles_mm: poles.collect(),
        weights: net.weights.as_ref().map(|w| w.chunks(row).map(<[f64]>::to_vec).collect()),
        side: of_side(n.side()),
    }
}

pub(super) fn to_surface(s: spec::Surface) -> Result<FaceSurface, FaceFault> {
    let (shape, frame) = match s {
        spec::Surface::Plane(p) => (Shape::Plane, p.frame),
        spec::Surface::Cylinder(c) => (Shape::Cylinder { radius_mm: c.radius_mm }, c.frame),
        spec::Surface::Cone(c) => {
            let angle = c.half_angle_rad;
            if angle.is_nan() || angle.abs() >= std::f64::consts::FRAC_PI_2 {
                return Err(FaceFault::Number { what: "half_angle_rad, below a right angle," });
            }
            (Shape::Cone { radius_mm: c.radius_mm, half_angle_rad: angle }, c.frame)
        }
        spec::Surface::Sphere(r) => (Shape::Sphere { radius_mm: r.radius_mm }, r.frame),
        spec::Surface::Torus(t) => {
            let (major_radius_mm, minor_radius_mm) = (t.major_radius_mm, t.minor_radius_mm);
            (Shape::Torus { major_radius_mm, minor_radius_mm }, t.frame)
        }
        spec::Surface::Lemon(t) => {
            let (major_radius_mm, minor_radius_mm) = (t.major_radius_mm, t.minor_radius_mm);
            (Shape::Lemon { major_radius_mm, minor_radius_mm }, t.frame)
        }
        spec::Surface::Nurbs(n) => return Ok(FaceSurface::Nurbs(Arc::new(to_nurbs(n)?))),
        spec::Surface::Offset(o) => {
            let number = FaceFault::Number { what: "distance_mm" };
            let made = Offset::new(Arc::new(to_nurbs(o.base)?), o.distance_mm).map_err(|_| number)?;
            return Ok(FaceSurface::Offset(Arc::new(made)));
        }
    };
    Ok(FaceSurface::Analytic(Arc::new(Analytic::new(shape, to_frame(&frame)?)?)))
}

fn to_nurbs(n: spec::Nurbs) -> Result<NurbsSurface, FaceFault> {
    if !n.degree.into_iter().all(possible) {
        return Err(FaceFault::Number {
            what: "a degree, which must be at least 1 and not above the greatest,",
        });
    }
    let need = n.poles_mm.first().map_or(0, Vec::len);
    let even = |what: &'static str, lengths: &mut dyn Iterator<Item = usize>| {
        let odd = lengths.enumerate().find(|(_, got)| *got != need);
        odd.map_or(Ok(()), |(row, got)| Err(FaceFault::Rows { what, row, got, need }))
    };
    even("poles", &mut n.poles_mm.iter().map(Vec::len))?;
    if let Some(w) = &n.weights {
        even("weights", &mut w.iter().map(Vec::len))?;
    }
    let count = [n.poles_mm.len(), need];
    let points = n.poles_mm.into_iter().flatten().map(Point3::from).collect();
    let weights = n.weights.map(|w| w.into_iter().flatten().collect());
    let surface = NurbsSurface::new(n.degree, n.knots, Net { count, points, weights })?;
    Ok(match n.side {
        spec::Side::Along => surface,
        spec::Side::Against => surface.with_side(Side::Against),
    })
}
