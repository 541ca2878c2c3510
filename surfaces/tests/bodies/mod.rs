//! Closed bodies of analytic faces at any place.

#![allow(clippy::unwrap_used, dead_code)]

use osculate_geom::analytic::{Cylinder, Placed, Placement, Plane, Sphere};
use osculate_geom::{Domain, Interval, Point3, Side, Surface, Unit3, Uv, Vec3, uv};
use osculate_surfaces::{Analytic, Face, FaceKind, FaceSurface, Shape, ToNurbs, TrimmedSurface};
use std::f64::consts::TAU;
use std::sync::Arc;

/// A frame from its origin, its z axis and a vector that x is near.
pub fn frame(origin: [f64; 3], z: [f64; 3], x: [f64; 3]) -> Placement {
    Placement::new(Point3::from(origin), Unit3::new_normalize(Vec3::from(z)), Some(Vec3::from(x)))
}

/// A frame seen from another one.
pub fn within(outer: &Placement, inner: &Placement) -> Placement {
    let turned = |d: &Unit3| outer.point(&Point3::from(d.into_inner())) - outer.origin;
    Placement::new(outer.point(&inner.origin), Unit3::new_normalize(turned(&inner.z)), Some(turned(&inner.x)))
}

fn face(shape: Shape, at: Placement, domain: Domain, loops: &[Vec<Uv>], side: Side) -> Face {
    let carrier = Arc::new(Analytic::new(shape, at).unwrap().limited(domain));
    let surface = TrimmedSurface::new(carrier.clone(), loops, side).unwrap();
    Face {
        id: String::new(),
        name: String::new(),
        product: String::new(),
        colour: None,
        entity: 0,
        kind: FaceKind::Other,
        oriented: true,
        carrier: FaceSurface::Analytic(carrier),
        surface: Arc::new(surface),
    }
}

/// A block over `[0, size]` in its frame: x low and high, y low and high, z low and high.
pub fn block(at: &Placement, size: [f64; 3]) -> Vec<Face> {
    let mut out = Vec::new();
    for axis in 0..3 {
        for high in [false, true] {
            let mut origin = [0.0; 3];
            origin[axis] = if high { size[axis] } else { 0.0 };
            let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
            let unit = |k: usize| {
                let mut d = [0.0; 3];
                d[k] = 1.0;
                d
            };
            let own = frame(origin, unit(axis), unit(i));
            let domain = Domain { u: Interval::new(0.0, size[i]), v: Interval::new(0.0, size[j]) };
            let side = if high { Side::Along } else { Side::Against };
            out.push(face(Shape::Plane, within(at, &own), domain, &[], side));
        }
    }
    out
}

/// Points of a loop around a disk: the polygon has the disk's area to 2e-6.
const AROUND: usize = 2000;

fn disk(at: &Placement, z: f64, radius: f64, side: Side) -> Face {
    let i = Interval::new(-radius, radius);
    let points = (0..AROUND).map(|k| {
        let a = TAU * (k as f64 + 0.5) / AROUND as f64;
        uv(radius * a.cos(), radius * a.sin())
    });
    let own = frame([0.0, 0.0, z], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    face(Shape::Plane, within(at, &own), Domain { u: i, v: i }, &[points.collect()], side)
}

/// A cylinder about z from 0 to its height: wall, lower and upper disk.
pub fn post(at: &Placement, radius_mm: f64, height: f64) -> Vec<Face> {
    let domain = Domain { u: Interval::periodic(0.0, TAU), v: Interval::new(0.0, height) };
    vec![
        face(Shape::Cylinder { radius_mm }, *at, domain, &[], Side::Along),
        disk(at, 0.0, radius_mm, Side::Against),
        disk(at, height, radius_mm, Side::Along),
    ]
}

/// A sphere about the frame's origin.
pub fn ball(at: &Placement, radius_mm: f64) -> Vec<Face> {
    let whole = Analytic::new(Shape::Sphere { radius_mm }, *at).unwrap();
    vec![face(Shape::Sphere { radius_mm }, *at, whole.domain(), &[], Side::Along)]
}

/// The same face on a spline: a seam is then a side of it as any other.
pub fn splined(face: &Face) -> Face {
    let FaceSurface::Analytic(a) = &face.carrier else { panic!("made of analytic faces") };
    let (domain, placement) = (a.domain(), *a.placement());
    let spline = match a.shape() {
        Shape::Plane => Placed { surface: Plane::new(domain), placement }.to_nurbs(domain),
        Shape::Cylinder { radius_mm } => {
            Placed { surface: Cylinder::new(radius_mm, domain.v).unwrap(), placement }.to_nurbs(domain)
        }
        Shape::Sphere { radius_mm } => {
            Placed { surface: Sphere::new(radius_mm).unwrap(), placement }.to_nurbs(domain)
        }
        other => panic!("{other:?}"),
    };
    let spline = Arc::new(spline.unwrap());
    let trimmed = face.surface.is_trimmed();
    let loops: Vec<Vec<Uv>> =
        face.surface.loops().iter().filter(|_| trimmed).map(|l| l.points.clone()).collect();
    let surface = TrimmedSurface::new(spline.clone(), &loops, face.surface.side()).unwrap();
    Face { carrier: FaceSurface::Nurbs(spline), surface: Arc::new(surface), ..face.clone() }
}
