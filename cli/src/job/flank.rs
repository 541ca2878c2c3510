//! `[flank]` and `[part.ruled]` of a job file.

use osculate_geom::{Point3, Side};
use osculate_surfaces::NurbsCurve3;
use osculate_surfaces::fit::{Ends, Spacing, interpolate};
use osculate_tools::flank::RuledStrip;
use serde::Deserialize;
use std::sync::Arc;

/// `[flank]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FlankTable {
    /// The rule at which the settings are compared; the middle one where not given.
    pub at_u: Option<f64>,
    /// 1: the side that the face's normal points to, which is N0 + N1 for surfaces between two directrices; -1: the other.
    pub side: i32,
    /// Where the cutter goes; the face's own range where not given. It may reach beyond.
    pub span_u: Option<[f64; 2]>,
    /// Where the envelope is judged and the part verified; the face's own range where not given.
    pub judge_u: Option<[f64; 2]>,
    /// Positions over the span.
    pub positions: usize,
    /// The method that becomes a path.
    pub method: String,
    /// The parameter of a face that runs along the directrices: `u`, `v` or `auto`.
    pub along: String,
    /// What is milled: the face's `own` shape, or the straight lines between its `borders`.
    pub face: String,
    /// The end of the rules where the tip is: `v0`, `v1` or `auto`, which keeps the spindle up.
    pub tip: String,
    /// How far the straight side of the cutter reaches beyond the rules at the tip's end.
    pub below_mm: f64,
    /// Straight way before and after the face; a radius and 2 mm where not given.
    pub lead_mm: Option<f64>,
    /// Spans of the axis surface; by the length of the span where not given.
    pub spans: Option<usize>,
    /// What a gouge counts against material left, 1 or more.
    pub gouge_weight: f64,
    /// Weight of an uneven motion of the axis, 1/mm.
    pub smoothness_per_mm: f64,
    /// How far lines across the face may stray from straight ones for it to count as ruled.
    pub ruled_tolerance_mm: f64,
}

impl Default for FlankTable {
    fn default() -> Self {
        Self {
            at_u: None,
            side: 1,
            span_u: None,
            judge_u: None,
            positions: 181,
            method: "envelope_minimax".to_owned(),
            along: "auto".to_owned(),
            face: "own".to_owned(),
            tip: "auto".to_owned(),
            below_mm: 1.0,
            lead_mm: None,
            spans: None,
            gouge_weight: 1.0,
            smoothness_per_mm: 0.0,
            ruled_tolerance_mm: 0.01,
        }
    }
}

/// `[part.ruled]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RuledTable {
    /// The directrix at v = 0.
    pub c0: CurveTable,
    /// The directrix at v = 1; its range is mapped on that of the first.
    pub c1: CurveTable,
}

/// A directrix.
#[derive(Debug, Clone, Deserialize)]
#[serde(untagged, deny_unknown_fields)]
pub enum CurveTable {
    /// A NURBS curve.
    Nurbs {
        /// Degree.
        degree: usize,
        /// All knots, those at the ends repeated.
        knots: Vec<f64>,
        /// Poles, mm.
        poles: Vec<[f64; 3]>,
        /// Weights of a rational curve.
        weights: Option<Vec<f64>>,
    },
    /// A cubic through points, by chord length; straight pieces' ends where there are fewer than four.
    Points {
        /// The points, mm.
        points: Vec<[f64; 3]>,
    },
}

impl CurveTable {
    fn curve(&self) -> Result<NurbsCurve3, String> {
        match self {
            Self::Nurbs { degree, knots, poles, weights } => {
                let poles = poles.iter().map(|p| Point3::from(*p)).collect();
                NurbsCurve3::new(*degree, knots.clone(), poles, weights.clone()).map_err(|e| e.to_string())
            }
            Self::Points { points } => {
                let points: Vec<Point3> = points.iter().map(|p| Point3::from(*p)).collect();
                let degree = points.len().saturating_sub(1).clamp(1, 3);
                interpolate(&points, degree, Spacing::Chord, &Ends::Free)
                    .map(|f| f.curve)
                    .map_err(|e| e.to_string())
            }
        }
    }
}

/// Rules shorter than this part of the longest one make no face.
const SHORTEST: f64 = 1e-4;

/// The least length of a rule for directrices of this size, mm.
pub fn least_mm(size_mm: f64) -> f64 {
    (SHORTEST * size_mm).max(f64::MIN_POSITIVE)
}

/// The surface between two directrices.
pub fn strip(table: &RuledTable) -> Result<Arc<RuledStrip<'static>>, String> {
    let curve = |name: &str, c: &CurveTable| c.curve().map_err(|e| format!("[part.ruled] {name}: {e}"));
    let (a, b) = (curve("c0", &table.c0)?, curve("c1", &table.c1)?);
    let (i, j) = (a.domain(), b.domain());
    let size =
        [0.0, 0.5, 1.0].map(|t| (a.point(i.at(t)) - b.point(j.at(t))).norm()).into_iter().fold(0.0, f64::max);
    RuledStrip::new(a, b, Side::Along, least_mm(size)).map(Arc::new).map_err(|e| format!("[part.ruled] {e}"))
}
