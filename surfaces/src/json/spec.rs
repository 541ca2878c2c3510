//! The JSON of faces as it is written: `format` 1, lengths in mm and angles in rad by their keys.
//!
//! ```text
//! { "format": 1,
//!   "faces": [ { "id": "F1", "name": "", "kind": "cylinder", "oriented": true, "side": "along",
//!                "surface": { "cylinder": { "frame": { "origin_mm": [..], "x": [..], "z": [..] }, "radius_mm": 3 } },
//!                "loops": [ [ { "key": 7, "curve": { "ellipse": .. }, "ends": [0, 6.28] }, .. ], .. ] } ] }
//! ```
//!
//! A loop's edges follow each other with the face on their left, seen against `S_u x S_v`; the same `key` is the same
//! edge wherever it stands. `ends` are the curve's parameters at the edge's start and end. An edge without curve has
//! its `parameters`, a polyline of surface parameters.

use serde::{Deserialize, Serialize};

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    pub(super) format: u32,
    pub(super) faces: Vec<Face>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Face {
    pub(super) id: String,
    #[serde(default)]
    pub(super) name: String,
    /// The product that it belongs to.
    #[serde(default)]
    pub(super) product: String,
    /// Red, green and blue from 0 to 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) colour: Option<[f64; 3]>,
    pub(super) kind: String,
    pub(super) oriented: bool,
    pub(super) side: Side,
    pub(super) surface: Surface,
    #[serde(default)]
    pub(super) loops: Vec<Vec<Edge>>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Side {
    Along,
    Against,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Surface {
    Plane(Plane),
    Cylinder(Round),
    Cone(Cone),
    Sphere(Round),
    Torus(Torus),
    /// The inner part of a spindle torus.
    Lemon(Torus),
    Nurbs(Nurbs),
    Offset(Offset),
}

/// A spline moved along its normal `S_u x S_v`.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Offset {
    pub(super) base: Nurbs,
    pub(super) distance_mm: f64,
}

/// Right-handed: y is z x x.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Frame {
    pub(super) origin_mm: [f64; 3],
    pub(super) x: [f64; 3],
    pub(super) z: [f64; 3],
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Plane {
    pub(super) frame: Frame,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Round {
    pub(super) frame: Frame,
    pub(super) radius_mm: f64,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Cone {
    pub(super) frame: Frame,
    pub(super) radius_mm: f64,
    pub(super) half_angle_rad: f64,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Torus {
    pub(super) frame: Frame,
    pub(super) major_radius_mm: f64,
    pub(super) minor_radius_mm: f64,
}

/// Poles row by row: `poles_mm[i][j]` belongs to the i-th basis function of u and the j-th of v.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Nurbs {
    pub(super) degree: [usize; 2],
    pub(super) knots: [Vec<f64>; 2],
    pub(super) poles_mm: Vec<Vec<[f64; 3]>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) weights: Option<Vec<Vec<f64>>>,
    /// The surface's own side, before the face's.
    pub(super) side: Side,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Edge {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) key: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) curve: Option<Curve>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) ends: Option<[f64; 2]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) parameters: Option<Vec<[f64; 2]>>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Curve {
    Line(Line),
    Ellipse(Ellipse),
    Parabola(Parabola),
    Hyperbola(Hyperbola),
    Polyline(Polyline),
    Spline(Spline),
}

/// `origin + t direction`.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Line {
    pub(super) origin_mm: [f64; 3],
    pub(super) direction_mm: [f64; 3],
}

/// `a cos t x + b sin t y`.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Ellipse {
    pub(super) frame: Frame,
    pub(super) semi_axes_mm: [f64; 2],
}

/// `f (t^2 x + 2 t y)`.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Parabola {
    pub(super) frame: Frame,
    pub(super) focal_mm: f64,
}

/// `a cosh t x + b sinh t y`.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Hyperbola {
    pub(super) frame: Frame,
    pub(super) semi_axes_mm: [f64; 2],
}

/// Straight pieces, the parameter counts points.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Polyline {
    pub(super) points_mm: Vec<[f64; 3]>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Spline {
    pub(super) degree: usize,
    pub(super) knots: Vec<f64>,
    pub(super) poles_mm: Vec<[f64; 3]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) weights: Option<Vec<f64>>,
}
