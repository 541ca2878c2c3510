//! `[flank]` and `[part.ruled]` of a job: how the side of a cutter goes over a ruled face.

use crate::failure::Failure;
use crate::job::problem::Places;
use crate::job::raw;
use crate::job::words::{AlongWord, FlankShape, Method, Tip};
use osculate_geom::{Interval, Point3, Side};
use osculate_surfaces::NurbsCurve3;
use osculate_surfaces::fit::{Ends, Spacing, interpolate};
use osculate_tools::flank::RuledStrip;
use std::sync::Arc;

/// How a ruled face is milled with the side of a cutter.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Flank {
    /// The rule at which the settings are compared; the middle one where not given.
    pub at_u: Option<f64>,
    /// The side of the face that is not the one its normal points to.
    pub flipped: bool,
    /// Where the cutter goes; the face's own range where not given. It may reach beyond.
    pub span_u: Option<Interval>,
    /// Where the envelope is judged and the part verified; the face's own range where not given.
    pub judge_u: Option<Interval>,
    /// Positions over the span.
    pub positions: usize,
    /// The method that becomes a path.
    pub method: Method,
    /// The parameter of the face that runs along the directrices.
    pub along: AlongWord,
    /// What is milled.
    pub face: FlankShape,
    /// The end of the rules where the tip is.
    pub tip: Tip,
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

impl Flank {
    pub(super) fn of(t: &raw::Flank) -> Self {
        let range = |r: Option<[f64; 2]>| r.map(|[lo, hi]| Interval::new(lo, hi));
        Self {
            at_u: t.at_u,
            flipped: t.side == Some(-1),
            span_u: range(t.span_u),
            judge_u: range(t.judge_u),
            positions: t.positions.unwrap_or(181),
            method: t.method.unwrap_or_default(),
            along: t.along.unwrap_or_default(),
            face: t.face.unwrap_or_default(),
            tip: t.tip.unwrap_or_default(),
            below_mm: t.below_mm.unwrap_or(1.0),
            lead_mm: t.lead_mm,
            spans: t.spans,
            gouge_weight: t.gouge_weight.unwrap_or(1.0),
            smoothness_per_mm: t.smoothness_per_mm.unwrap_or(0.0),
            ruled_tolerance_mm: t.ruled_tolerance_mm.unwrap_or(0.01),
        }
    }
}

fn curve(places: &Places, name: &str, c: &raw::Curve) -> Result<NurbsCurve3, Failure> {
    let table = format!("part.ruled.{name}");
    let points = |p: &[[f64; 3]]| -> Vec<Point3> { p.iter().map(|p| Point3::from(*p)).collect() };
    let made = match (&c.points, c.degree, &c.knots, &c.poles) {
        (None, Some(degree), Some(knots), Some(poles)) => {
            NurbsCurve3::new(degree, knots.clone(), points(poles), c.weights.clone())
                .map_err(|e| e.to_string())
        }
        (Some(p), None, None, None) if c.weights.is_none() => {
            let points = points(p);
            let degree = points.len().saturating_sub(1).clamp(1, 3);
            interpolate(&points, degree, Spacing::Chord, &Ends::Free)
                .map(|f| f.curve)
                .map_err(|e| e.to_string())
        }
        _ => Err("needs either degree, knots and poles (and weights), or points".to_owned()),
    };
    made.map_err(|e| places.refuse(&table, "", e))
}

/// Rules shorter than this part of the longest one make no face.
const SHORTEST: f64 = 1e-4;

/// The least length of a rule for directrices of this size, mm.
#[must_use]
pub fn least_mm(size_mm: f64) -> f64 {
    (SHORTEST * size_mm).max(f64::MIN_POSITIVE)
}

/// The surface between two directrices.
pub(super) fn strip(places: &Places, table: &raw::Ruled) -> Result<Arc<RuledStrip<'static>>, Failure> {
    let (a, b) = (curve(places, "c0", &table.c0)?, curve(places, "c1", &table.c1)?);
    let (i, j) = (a.domain(), b.domain());
    let size =
        [0.0, 0.5, 1.0].map(|t| (a.point(i.at(t)) - b.point(j.at(t))).norm()).into_iter().fold(0.0, f64::max);
    RuledStrip::new(a, b, Side::Along, least_mm(size))
        .map(Arc::new)
        .map_err(|e| places.refuse("part.ruled", "", e))
}
