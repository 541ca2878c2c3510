//! Distances of convex bodies against closed forms, and of crowds against all pairs.

use nalgebra::{Isometry3, Translation3, UnitQuaternion};
use osculate_geom::convex::{Apart, Convex, Crowd};
use osculate_geom::{Box3, Point3, Vec3};
use proptest::prelude::*;

const SHARE: f64 = 1e-6;

fn vector(size: f64) -> impl Strategy<Value = Vec3> {
    [-size..size, -size..size, -size..size].prop_map(|[x, y, z]| Vec3::new(x, y, z))
}

fn placed() -> impl Strategy<Value = Isometry3<f64>> {
    (vector(60.0), vector(3.0)).prop_map(|(shift, turn)| {
        Isometry3::from_parts(Translation3::from(shift), UnitQuaternion::from_scaled_axis(turn))
    })
}

fn is(apart: Apart, wanted_mm: f64) {
    let room = 1e-9 + 2.0 * SHARE * wanted_mm;
    let Apart { least_mm, most_mm } = apart;
    assert!(least_mm <= wanted_mm + room && wanted_mm <= most_mm + room, "{apart:?}, {wanted_mm}");
    assert!(most_mm - least_mm <= room, "{apart:?} is wide, {wanted_mm}");
}

proptest! {
    /// Boxes that stand alike, both moved by one placing: the root of the sum of the squared gaps.
    #[test]
    fn boxes(a in vector(30.0), b in vector(30.0), c in vector(90.0), d in vector(30.0), at in placed()) {
        let cuboid = |p: Vec3, q: Vec3| Box3::around(&[Point3::from(p), Point3::from(p + q.abs() + Vec3::repeat(0.1))]);
        let (own, other) = (cuboid(a, b), cuboid(c, d));
        let gap = |k: usize| (other.min[k] - own.max[k]).max(own.min[k] - other.max[k]).max(0.0);
        let wanted = Vec3::new(gap(0), gap(1), gap(2)).norm();
        // The other one as a hull of turned corners, put back by the placing.
        let back = at.inverse();
        let Convex::Hull(corners) = Convex::cuboid(&other) else { unreachable!() };
        let turned = Convex::Hull(corners.iter().map(|p| back * p).collect());
        is(Convex::cuboid(&own).apart(&turned, &at, SHARE, f64::INFINITY), wanted);
    }

    /// Two upright cylinders: the gap between two discs, and that along the axis.
    #[test]
    fn cylinders(shift in vector(80.0), r in 0.5..20.0f64, s in 0.5..20.0f64, h in 1.0..40.0f64, turn in -3.0..3.0f64) {
        let upright = |radius: f64| Convex::Frustum {
            ends: [Point3::origin(), Point3::new(0.0, 0.0, h)],
            radii_mm: [radius, radius],
        };
        let at = Isometry3::from_parts(Translation3::from(shift), UnitQuaternion::from_scaled_axis(Vec3::z() * turn));
        let across = (shift.xy().norm() - r - s).max(0.0);
        let along = (shift.z.abs() - h).max(0.0);
        is(upright(r).apart(&upright(s), &at, SHARE, f64::INFINITY), across.hypot(along));
    }

    /// A point beside a cone: against the distance in the plane of the axis.
    #[test]
    fn cones(p in vector(50.0), low in 0.0..20.0f64, high in 0.5..20.0f64, h in 1.0..40.0f64) {
        let cone = Convex::Frustum { ends: [Point3::origin(), Point3::new(0.0, 0.0, h)], radii_mm: [low, high] };
        let point = Convex::Hull(vec![Point3::from(p)]);
        let (rho, z) = (p.xy().norm(), p.z);
        let on = |a: [f64; 2], b: [f64; 2]| {
            let (u, w) = ([b[0] - a[0], b[1] - a[1]], [rho - a[0], z - a[1]]);
            let length2 = u[0] * u[0] + u[1] * u[1];
            let t = if length2 > 0.0 { ((u[0] * w[0] + u[1] * w[1]) / length2).clamp(0.0, 1.0) } else { 0.0 };
            (w[0] - t * u[0]).hypot(w[1] - t * u[1])
        };
        let inside = z >= 0.0 && z <= h && rho <= low + (high - low) * z / h;
        let sides = [on([0.0, 0.0], [low, 0.0]), on([low, 0.0], [high, h]), on([0.0, h], [high, h])];
        let wanted = if inside { 0.0 } else { sides.into_iter().fold(f64::INFINITY, f64::min) };
        // Deeper than rounding inside, or clear of the edge between in and out.
        prop_assume!(wanted > 1e-6 || inside);
        is(cone.apart(&point, &Isometry3::identity(), SHARE, f64::INFINITY), wanted);
    }

    /// Two triangles: no pair of their points is nearer than the lower bound, and one is about as near as the upper one.
    #[test]
    fn triangles(a in [vector(20.0), vector(20.0), vector(20.0)], b in [vector(20.0), vector(20.0), vector(20.0)], at in placed()) {
        let (own, other) = (a.map(Point3::from), b.map(Point3::from));
        let apart = Convex::Triangle(own).apart(&Convex::Triangle(other), &at, SHARE, f64::INFINITY);
        let points = |t: &[Point3; 3]| -> Vec<Vec3> {
            let n = 24;
            (0..=n).flat_map(|i| (0..=n - i).map(move |j| (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n))))
                .map(|(x, y)| t[0].coords * (1.0 - x - y) + t[1].coords * x + t[2].coords * y)
                .collect()
        };
        let (p, q) = (points(&own), points(&other.map(|c| at * c)));
        let nearest = p.iter().flat_map(|x| q.iter().map(move |y| (x - y).norm())).fold(f64::INFINITY, f64::min);
        let longest = |t: &[Point3; 3]| (t[1] - t[0]).norm().max((t[2] - t[0]).norm()).max((t[2] - t[1]).norm());
        prop_assert!(apart.least_mm <= nearest + 1e-9);
        prop_assert!(nearest <= apart.most_mm + (longest(&own) + longest(&other)) / 24.0);
        prop_assert!(apart.most_mm - apart.least_mm <= 1e-8 + 1e-5 * apart.most_mm);
    }

    /// A crowd is as near as the nearest pair of its members, wherever it stands.
    #[test]
    fn crowds(seeds in prop::collection::vec((vector(40.0), vector(6.0), vector(6.0)), 1..40), at in placed(), split in 0.1..0.9f64) {
        let triangle = |(p, u, v): &(Vec3, Vec3, Vec3)| {
            Convex::Triangle([Point3::from(*p), Point3::from(p + u), Point3::from(p + v)])
        };
        let all: Vec<Convex> = seeds.iter().map(triangle).collect();
        let cut = ((all.len() as f64 * split) as usize).clamp(1, all.len());
        let (own, other) = (all[..cut].to_vec(), all[all.len() - cut..].to_vec());
        let pairs = own.iter().flat_map(|p| other.iter().map(move |q| p.apart(q, &at, SHARE, f64::INFINITY)));
        let (least, most) = pairs.fold((f64::INFINITY, f64::INFINITY), |(l, m), a| (f64::min(l, a.least_mm), f64::min(m, a.most_mm)));
        let crowd = |members: Vec<Convex>| Crowd::new(members).unwrap();
        let apart = crowd(own).apart(&crowd(other), &at, SHARE, f64::INFINITY);
        prop_assert!(apart.least_mm <= most + 1e-9 && apart.most_mm >= least - 1e-9);
        prop_assert!(apart.most_mm - apart.least_mm <= 1e-8 + 1e-4 * most);
    }

    /// The frame does not matter: seen from the other body the distance is the same.
    #[test]
    fn both_ways(a in vector(20.0), r in 0.5..9.0f64, corners in prop::collection::vec(vector(20.0), 4..9), at in placed()) {
        let round = Convex::Frustum { ends: [Point3::origin(), Point3::from(a)], radii_mm: [r, 0.5 * r] };
        let hull = Convex::Hull(corners.into_iter().map(Point3::from).collect());
        let here = round.apart(&hull, &at, SHARE, f64::INFINITY);
        let there = hull.apart(&round, &at.inverse(), SHARE, f64::INFINITY);
        prop_assert!((here.most_mm - there.most_mm).abs() <= 1e-6 + 1e-4 * here.most_mm, "{here:?} {there:?}");
    }
}

#[test]
fn a_crowd_of_nothing_and_of_no_numbers() {
    assert!(Crowd::new(Vec::new()).is_err());
    let bad =
        Convex::Triangle([Point3::origin(), Point3::new(f64::NAN, 0.0, 0.0), Point3::new(1.0, 0.0, 0.0)]);
    assert!(Crowd::new(vec![bad]).is_err());
}
