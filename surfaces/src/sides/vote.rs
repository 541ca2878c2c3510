//! On which side of a group of faces the part encloses material, by rays.
//!
//! A ray that leaves a closed body crosses its boundary an even number of times, one that starts inside an odd number. From
//! points spread over the area of the group rays go out to both sides; the side on which odd counts prevail is the material.
//! Files of loose faces are rarely quite closed, so it is a vote.

use super::tree::Tree;
use crate::mesh::Mesh;
use osculate_geom::{Point3, Side, Vec3};
use rayon::prelude::*;

/// Points that rays go out from.
const POINTS: usize = 256;
/// Rays to either side of a point.
const RAYS: usize = 4;
/// Cosine and sine of the angle between the rays and the normal: along it the ray would meet what is parallel to the face, and
/// rays of one point would be one.
const LEAN: [f64; 2] = [0.8, 0.6];
/// The golden angle, rad: turns of it repeat nothing.
const TURN: f64 = 2.399_963_229_728_653;
/// Steps of the points within triangles, as parts of a side: no two agree.
const SPREAD: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3];

/// A place with its outward unit normal.
pub(super) type Place = (Point3, Vec3);

/// Places spread over faces by area, on the sides given.
pub(super) fn places(meshes: &[(&Mesh, Side)]) -> Vec<Place> {
    let mut reach = Vec::new();
    let mut whole = 0.0;
    for (m, (mesh, _)) in meshes.iter().enumerate() {
        for (t, corners) in mesh.triangles.iter().enumerate() {
            let [a, b, c] = corners.map(|k| Vec3::from(mesh.positions[k as usize]));
            let area = 0.5 * (b - a).cross(&(c - a)).norm();
            if area.is_finite() && area > 0.0 {
                whole += area;
                reach.push((whole, m, t));
            }
        }
    }
    if reach.is_empty() {
        return Vec::new();
    }
    let place = |k: usize| {
        let wanted = whole * (k as f64 + 0.5) / POINTS as f64;
        let (_, m, t) = reach[reach.partition_point(|r| r.0 < wanted).min(reach.len() - 1)];
        let (mesh, side) = meshes[m];
        let corners = mesh.triangles[t];
        let [mut u, mut v] = SPREAD.map(|s| (s * (k + 1) as f64).fract());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        let [a, b, c] = corners.map(|k| Vec3::from(mesh.positions[k as usize]));
        let normal: Vec3 = corners.iter().map(|k| Vec3::from(mesh.normals[*k as usize])).sum();
        let normal = normal.try_normalize(1e-6)? * side.sign();
        Some((Point3::from(a + (b - a) * u + (c - a) * v), normal))
    };
    (0..POINTS).filter_map(place).collect()
}

/// Share of rays against the normals with an odd count less that of rays along them: 1 for a closed body with its normals
/// outward, -1 for one with its normals inward, 0 for an open sheet.
pub(super) fn enclosure(places: &[Place], part: &Tree, skip_mm: f64) -> f64 {
    if places.is_empty() {
        return 0.0;
    }
    let votes = |k: usize, (p, n): &Place| -> i64 {
        let across = if n.x.abs() < 0.6 { Vec3::x() } else { Vec3::y() };
        let e = n.cross(&across).normalize();
        let f = n.cross(&e);
        (0..RAYS)
            .map(|r| {
                let turn = TURN * k as f64 + std::f64::consts::TAU * r as f64 / RAYS as f64;
                let d = n * LEAN[0] + (e * turn.cos() + f * turn.sin()) * LEAN[1];
                let odd = |d: &Vec3| (part.crossings(p, d, skip_mm) % 2) as i64;
                odd(&-d) - odd(&d)
            })
            .sum()
    };
    let sum: i64 = places.par_iter().enumerate().map(|(k, place)| votes(k, place)).sum();
    sum as f64 / (RAYS * places.len()) as f64
}
