//! B-spline curves and surfaces of a Part 21 file: with knots, uniform, quasi-uniform and Bezier, rational or not.

use super::geometry::{Geometry, Unread};
use super::graph::{Args, Record, Value, arg};
use crate::knots::MAX_DEGREE;
use crate::nurbs::{Net, NurbsSurface};
use crate::part::FaceKind;
use crate::trim::spline::Spline;

/// Knot multiplicities are expanded; their sum is bounded by what one record can reasonably hold.
const MAX_KNOTS: usize = 1_000_000;

impl Geometry<'_> {
    /// Any B_SPLINE_CURVE, or `None` for another kind.
    pub(super) fn spline(&self, id: u64, record: &Record<'_>) -> Result<Option<Spline>, Unread> {
        const KINDS: [&str; 4] =
            ["B_SPLINE_CURVE_WITH_KNOTS", "BEZIER_CURVE", "QUASI_UNIFORM_CURVE", "UNIFORM_CURVE"];
        let kind = KINDS.into_iter().find(|k| record.is(k));
        // A complex record spreads the parameters over its parts; a simple one has them all, a name first.
        let own = |kind: &str| record.part(kind).unwrap_or(Args::none());
        let (base, knots) = match (record.part("B_SPLINE_CURVE").filter(|b| !b.is_empty()), kind) {
            // A simple record of the general kind has a name in front.
            (Some(base), None) if base.len() > 5 => (base.skip(1), Args::none()),
            (Some(base), kind) => (base, kind.map_or(Args::none(), own)),
            (None, Some(kind)) => (own(kind).skip(1), own(kind).skip(6)),
            (None, None) => return Ok(None),
        };
        let degree = self.degree(id, &base, 0)?;
        let poles = self.points(id, &arg(&base, 1).list())?;
        let knots = self.knots(id, kind, degree, poles.len(), arg(&knots, 0), arg(&knots, 1))?;
        let weights = match record.part("RATIONAL_B_SPLINE_CURVE") {
            Some(args) => arg(&args, 0).list().iter().filter_map(|v| v.number()).collect(),
            None => Vec::new(),
        };
        Spline::new(degree, knots, poles, weights)
            .map(Some)
            .map_err(|e| Unread::Malformed { id, what: e.to_string() })
    }

    fn degree(&self, id: u64, args: &Args<'_>, k: usize) -> Result<usize, Unread> {
        let d = self.number(id, args, k)?;
        if d >= 1.0 && d <= MAX_DEGREE as f64 && d.fract() == 0.0 {
            Ok(d as usize)
        } else {
            Err(Unread::Malformed { id, what: format!("degree {d}, 1 to {MAX_DEGREE} can be read") })
        }
    }

    /// The knot vector of one direction: written out, or by the rule of the kind.
    fn knots(
        &self,
        id: u64,
        kind: Option<&str>,
        degree: usize,
        poles: usize,
        multiplicities: Value<'_>,
        values: Value<'_>,
    ) -> Result<Vec<f64>, Unread> {
        let need = poles + degree + 1;
        if kind.is_some_and(|k| k.ends_with("_WITH_KNOTS")) {
            let (m, v) = (multiplicities.list(), values.list());
            if m.len() != v.len() {
                let what = format!("{} multiplicities for {} knots", m.len(), v.len());
                return Err(Unread::Malformed { id, what });
            }
            let mut knots = Vec::new();
            for (m, v) in m.iter().zip(v.iter()) {
                let (Some(m), Some(v)) = (m.number(), v.number()) else {
                    return Err(Unread::Malformed { id, what: "a knot that is no number".into() });
                };
                if !(m >= 0.0 && m + knots.len() as f64 <= MAX_KNOTS as f64) {
                    return Err(Unread::Malformed { id, what: format!("knot multiplicity {m}") });
                }
                knots.extend(std::iter::repeat_n(v, m as usize));
            }
            if knots.len() != need {
                let what =
                    format!("{} knots for {poles} poles of degree {degree}, {need} are needed", knots.len());
                return Err(Unread::Malformed { id, what });
            }
            return Ok(knots);
        }
        let uniform = kind.is_some_and(|k| k.starts_with("UNIFORM"));
        if uniform {
            return Ok((0..need).map(|k| k as f64 - degree as f64).collect());
        }
        // Ends with full multiplicity; inside, Bezier pieces meet with the degree, quasi-uniform knots are simple.
        let bezier = kind.is_some_and(|k| k.starts_with("BEZIER"));
        let step = if bezier { degree } else { 1 };
        let inner = poles.saturating_sub(degree + 1);
        if bezier && !inner.is_multiple_of(degree) {
            let what = format!("{poles} poles make no whole number of Bezier pieces of degree {degree}");
            return Err(Unread::Malformed { id, what });
        }
        let mut knots = vec![0.0; degree + 1];
        knots.extend((0..inner).map(|k| (k / step + 1) as f64));
        knots.extend(std::iter::repeat_n((inner / step + 1) as f64, degree + 1));
        Ok(knots)
    }

    /// Any B_SPLINE_SURFACE, or `None` for another kind.
    pub(super) fn spline_surface(
        &self,
        id: u64,
        record: &Record<'_>,
    ) -> Result<Option<(NurbsSurface, FaceKind)>, Unread> {
        const KINDS: [&str; 4] =
            ["B_SPLINE_SURFACE_WITH_KNOTS", "BEZIER_SURFACE", "QUASI_UNIFORM_SURFACE", "UNIFORM_SURFACE"];
        let kind = KINDS.into_iter().find(|k| record.is(k));
        let own = |kind: &str| record.part(kind).unwrap_or(Args::none());
        let (base, knots) = match (record.part("B_SPLINE_SURFACE").filter(|b| !b.is_empty()), kind) {
            // A simple record of the general kind has a name in front.
            (Some(base), None) if base.len() > 7 => (base.skip(1), Args::none()),
            (Some(base), kind) => (base, kind.map_or(Args::none(), own)),
            (None, Some(kind)) => (own(kind).skip(1), own(kind).skip(8)),
            (None, None) => return Ok(None),
        };
        let degree = [self.degree(id, &base, 0)?, self.degree(id, &base, 1)?];
        let rows = arg(&base, 2).list();
        let columns = arg(&rows, 0).list().len();
        let mut points = Vec::with_capacity(rows.len() * columns);
        for row in rows.iter().map(|r| r.list()) {
            if row.len() != columns {
                let what = format!("rows of {columns} and {} poles", row.len());
                return Err(Unread::Malformed { id, what });
            }
            for pole in row.iter() {
                points.push(self.pole(id, pole)?);
            }
        }
        let count = [rows.len(), columns];
        let vector = |k: usize| self.knots(id, kind, degree[k], count[k], arg(&knots, k), arg(&knots, k + 2));
        let vectors = [vector(0)?, vector(1)?];
        let weights = match record.part("RATIONAL_B_SPLINE_SURFACE") {
            Some(args) => {
                let w: Vec<f64> = arg(&args, 0)
                    .list()
                    .iter()
                    .flat_map(|v| v.list().iter())
                    .filter_map(|v| v.number())
                    .collect();
                if w.len() != points.len() {
                    let what = format!("{} weights for {} poles", w.len(), points.len());
                    return Err(Unread::Malformed { id, what });
                }
                // Equal weights change nothing and cost a division at every point.
                (w.iter().any(|x| *x != w[0])).then_some(w)
            }
            None => None,
        };
        let kind = if kind == Some("BEZIER_SURFACE") { FaceKind::Bezier } else { FaceKind::Bspline };
        let made = NurbsSurface::new(degree, vectors, Net { count, points, weights })
            .map_err(|e| Unread::Malformed { id, what: e.to_string() })?;
        Ok(Some((made, kind)))
    }
}
