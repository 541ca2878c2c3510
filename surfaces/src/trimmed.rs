//! A surface limited by loops in its parameter rectangle.
//!
//! Loops are closed polylines of parameters; a point is inside where a path from outside crosses them an odd number
//! of times, whatever their sense. Directions that close (cylinder, closed splines) are cut to one period; loops may
//! wrap around them.

use crate::trim::edge::FaceEdge;
use crate::trim::integrate;
use crate::trim::region::{Chain, Known, Region};
use osculate_geom::roots::{FLAT, minimum};
use osculate_geom::solve::symmetric;
use osculate_geom::{
    Axis, Box3, Domain, Facets, Interval, Jet2, Jet3, Point3, Side, Surface, Taylor, Uv, forward_surface, uv,
};
use std::sync::Arc;

/// A closed polyline in the parameter rectangle; the first point is not repeated.
#[derive(Clone, Debug, PartialEq)]
pub struct Loop {
    /// At least three points.
    pub points: Vec<Uv>,
}

impl Loop {
    /// Enclosed area in the parameter plane, positive where the loop runs counter-clockwise.
    ///
    /// ```
    /// use osculate_geom::uv;
    /// use osculate_surfaces::Loop;
    /// let triangle = Loop { points: vec![uv(0.0, 0.0), uv(3.0, 0.0), uv(0.0, 4.0)] };
    /// assert_eq!(triangle.signed_area(), 6.0);
    /// let points = triangle.points.into_iter().rev().collect();
    /// assert_eq!(Loop { points }.signed_area(), -6.0);
    /// ```
    #[must_use]
    pub fn signed_area(&self) -> f64 {
        let n = self.points.len();
        // Relative to the first point, so that far-away parameters do not cancel.
        let o = self.points[0];
        let cross = |a: Uv, b: Uv| (a.u - o.u) * (b.v - o.v) - (b.u - o.u) * (a.v - o.v);
        0.5 * (0..n).map(|k| cross(self.points[k], self.points[(k + 1) % n])).sum::<f64>()
    }
}

/// Why loops limit no surface.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TrimError {
    /// A loop has too few points.
    #[error("loop {index} has {got} points; a closed polyline needs three")]
    TooFewPoints {
        /// Which loop.
        index: usize,
        /// Its points.
        got: usize,
    },
    /// A loop has a parameter that is no finite number.
    #[error("loop {index} has a point at u = {}, v = {}; parameters must be finite", at.u, at.v)]
    NotFinite {
        /// Which loop.
        index: usize,
        /// The point.
        at: Uv,
    },
    /// An unlimited surface has no boundary in some direction.
    #[error("the surface is unlimited in {axis:?} and has no boundary there; it needs a loop")]
    Unlimited {
        /// The direction.
        axis: Axis,
    },
    /// The boundary belongs to another surface.
    #[error("the boundary, {size_mm:.3e} mm large, lies up to {gap_mm:.3e} mm off the surface")]
    OffSurface {
        /// Largest distance, mm.
        gap_mm: f64,
        /// Diagonal of the box around the boundary, mm.
        size_mm: f64,
    },
    /// The loops enclose nothing.
    #[error("its loops ({loops}) enclose no area of the surface")]
    Empty {
        /// How many.
        loops: usize,
    },
}

/// A carrier, the part of it that counts, and the side that the material is on.
#[derive(Clone)]
pub struct TrimmedSurface {
    carrier: Arc<dyn Surface>,
    domain: Domain,
    side: Side,
    loops: Vec<Loop>,
    /// `None` where the whole rectangle counts.
    region: Option<Arc<Region>>,
    /// The edges of the file; none for a surface that was not imported.
    edges: Arc<[FaceEdge]>,
    /// The triangles, where it is made of such.
    facets: Option<Arc<Facets>>,
}

impl std::fmt::Debug for TrimmedSurface {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("TrimmedSurface")
            .field("domain", &self.domain)
            .field("side", &self.side)
            .field("loops", &self.loops.len())
            .field("trimmed", &self.is_trimmed())
            .finish_non_exhaustive()
    }
}

/// Loops within this fraction of the sides of the rectangle are the rectangle.
const RIM: f64 = 1e-6;

impl TrimmedSurface {
    /// The part of `carrier` inside the loops (all of it without loops). `side` is the material side relative to the
    /// carrier's own.
    ///
    /// Loops may run across the sides of a periodic direction: consecutive points are taken as they are, so that a
    /// loop around a cylinder goes from u to u plus one period.
    ///
    /// ```
    /// use osculate_geom::{Axis, Domain, Interval, Side, Surface, analytic::Plane, uv};
    /// use osculate_surfaces::{TrimError, TrimmedSurface};
    /// use std::sync::Arc;
    /// // A plate of 40 x 40 mm with a hole of 20 x 20 in it.
    /// let side = Interval::new(0.0, 40.0);
    /// let square = |lo: f64, hi: f64| vec![uv(lo, lo), uv(hi, lo), uv(hi, hi), uv(lo, hi)];
    /// let plane = Arc::new(Plane::new(Domain { u: side, v: side }));
    /// let plate = TrimmedSurface::new(plane.clone(), &[square(0.0, 40.0), square(10.0, 30.0)], Side::Along)?;
    /// assert!((plate.area_mm2() - 1200.0).abs() < 1e-6 && !plate.contains(uv(20.0, 20.0)));
    /// // A line through the hole is in two pieces.
    /// assert_eq!(plate.spans(Axis::U, 20.0).len(), 2);
    /// let line = vec![uv(0.0, 0.0), uv(40.0, 0.0)];
    /// assert!(matches!(TrimmedSurface::new(plane, &[line], Side::Along), Err(TrimError::TooFewPoints { got: 2, .. })));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`TrimError`] for a loop that is none and for loops that enclose nothing.
    pub fn new(carrier: Arc<dyn Surface>, loops: &[Vec<Uv>], side: Side) -> Result<Self, TrimError> {
        let domain = carrier.domain();
        let mut chains = Vec::with_capacity(loops.len());
        for (index, points) in loops.iter().enumerate() {
            if points.len() < 3 {
                return Err(TrimError::TooFewPoints { index, got: points.len() });
            }
            if let Some(at) = points.iter().find(|p| !(p.u.is_finite() && p.v.is_finite())) {
                return Err(TrimError::NotFinite { index, at: *at });
            }
            let mut closed = points.clone();
            let (first, last) = (closed[0], closed[closed.len() - 1]);
            let end = |first: f64, last: f64, i: Interval| {
                let turns = if i.periodic { ((last - first) / i.length()).round() } else { 0.0 };
                first + turns * i.length()
            };
            closed.push(uv(end(first.u, last.u, domain.u), end(first.v, last.v, domain.v)));
            chains.push(Chain { points: closed });
        }
        let closes = [domain.u.periodic, domain.v.periodic];
        // A given rectangle ends where it ends: both ends are out unless a loop says otherwise.
        let known = Known { below_out: true, above_out: true, oriented: false };
        let region = Region::new(domain, closes, &chains, known);
        Self::from_region(carrier, domain, region, side, loops.len())
    }

    /// The part of a carrier that a region leaves.
    pub(crate) fn from_region(
        carrier: Arc<dyn Surface>,
        domain: Domain,
        region: Region,
        side: Side,
        loops: usize,
    ) -> Result<Self, TrimError> {
        for axis in [Axis::U, Axis::V] {
            if !domain.get(axis).length().is_finite() {
                return Err(TrimError::Unlimited { axis });
            }
        }
        if region.is_whole(RIM) {
            let corners =
                [domain.at(0.0, 0.0), domain.at(1.0, 0.0), domain.at(1.0, 1.0), domain.at(0.0, 1.0)];
            let rectangle = Loop { points: corners.to_vec() };
            return Ok(Self {
                carrier,
                domain,
                side,
                loops: vec![rectangle],
                region: None,
                edges: Arc::new([]),
                facets: None,
            });
        }
        let mut outlines: Vec<Loop> = region
            .outline()
            .into_iter()
            .map(|points| Loop { points })
            .filter(|l| l.points.len() > 2)
            .collect();
        // The loop around the largest area is the outer one.
        outlines.sort_by(|a, b| b.signed_area().abs().total_cmp(&a.signed_area().abs()));
        let smallest = 1e-14 * domain.u.length() * domain.v.length();
        if outlines.first().is_none_or(|l| l.signed_area().abs() <= smallest) {
            return Err(TrimError::Empty { loops });
        }
        Ok(Self {
            carrier,
            domain,
            side,
            loops: outlines,
            region: Some(Arc::new(region)),
            edges: Arc::new([]),
            facets: None,
        })
    }

    /// Triangles as a surface, none of which is cut away; on its natural side the material is where they do not look.
    #[must_use]
    pub fn of_facets(facets: Arc<Facets>) -> Self {
        let domain = facets.domain();
        let corners = [domain.at(0.0, 0.0), domain.at(1.0, 0.0), domain.at(1.0, 1.0), domain.at(0.0, 1.0)];
        Self {
            carrier: facets.clone(),
            domain,
            side: Side::Along,
            loops: vec![Loop { points: corners.to_vec() }],
            region: None,
            edges: Arc::new([]),
            facets: Some(facets),
        }
    }

    /// The triangles that it is made of, where it is a mesh: outward where [`side`](Self::side) is the natural one.
    #[must_use]
    pub const fn facets(&self) -> Option<&Arc<Facets>> {
        self.facets.as_ref()
    }

    /// The surface with the edges that its loops were made of.
    pub(crate) fn with_edges(mut self, edges: Vec<FaceEdge>) -> Self {
        self.edges = edges.into();
        self
    }

    /// The edges that the loops were made of, in the file's order; none where the surface was not imported.
    pub(crate) fn edges(&self) -> &[FaceEdge] {
        &self.edges
    }

    /// The same trims and side on a carrier with the same parameters.
    pub(crate) fn on(&self, carrier: Arc<dyn Surface>) -> Self {
        Self { carrier, ..self.clone() }
    }

    /// The surface without its loops.
    #[must_use]
    pub fn carrier(&self) -> &Arc<dyn Surface> {
        &self.carrier
    }

    /// The loops, outermost first, cut along the sides of the rectangle where they wrap. Without trims: the rectangle.
    #[must_use]
    pub fn loops(&self) -> &[Loop] {
        &self.loops
    }

    /// Whether something of the rectangle is cut away.
    #[must_use]
    pub const fn is_trimmed(&self) -> bool {
        self.region.is_some()
    }

    /// The material side, relative to the carrier's own.
    #[must_use]
    pub const fn side(&self) -> Side {
        self.side
    }

    /// The same surface with the material on the other side.
    #[must_use]
    pub fn flipped(mut self) -> Self {
        self.side = self.side.flipped();
        self
    }

    /// Integral of `f dA` over the inside, mm2 times the unit of `f`; `relative` is the accuracy aimed at.
    #[must_use]
    pub fn integrate(&self, relative: f64, f: &dyn Fn(&Jet2) -> f64) -> f64 {
        let (bu, bv) = (self.breaks(Axis::U), self.breaks(Axis::V));
        integrate(self, [&bu, &bv], self.region.as_deref(), relative, f)
    }

    /// Area, mm2, to about 1e-6 plus the effect of the loops' chord tolerance.
    #[must_use]
    pub fn area_mm2(&self) -> f64 {
        self.facets.as_ref().map_or_else(|| self.integrate(1e-7, &|_| 1.0), |f| f.area_mm2())
    }

    /// A box around the inside, mm: from boundary points and the points of a grid of `lines` per span, with each side
    /// settled to the extreme point near the best samples.
    #[must_use]
    pub fn bbox(&self, lines: usize) -> Box3 {
        /// Direction slots: the coordinate upwards, then downwards.
        const SIGNS: [f64; 2] = [1.0, -1.0];
        if let Some(facets) = &self.facets {
            return facets.bounds();
        }
        let mut found = Box3::empty();
        // The best samples of each of the six directions, inside and on the boundary.
        let mut inside = [(f64::NEG_INFINITY, uv(0.0, 0.0)); 6];
        let mut rim = [(f64::NEG_INFINITY, [uv(0.0, 0.0); 2]); 6];
        let value = |p: &Point3, slot: usize| SIGNS[slot % 2] * p[slot / 2];
        for (at, p) in self.samples(lines) {
            found.add(&p);
            for (slot, best) in inside.iter_mut().enumerate() {
                if value(&p, slot) > best.0 {
                    *best = (value(&p, slot), at);
                }
            }
        }
        let breaks = [self.breaks(Axis::U), self.breaks(Axis::V)];
        for l in &self.loops {
            let n = l.points.len();
            for k in 0..n {
                let (a, b) = (l.points[k], l.points[(k + 1) % n]);
                // A straight parameter line bends in space with the spans that it crosses.
                let crossed = |axis: Axis, breaks: &[f64]| {
                    let (lo, hi) = (a.get(axis).min(b.get(axis)), a.get(axis).max(b.get(axis)));
                    breaks.iter().filter(|t| **t > lo && **t < hi).count()
                };
                let steps = 4 * (1 + crossed(Axis::U, &breaks[0]) + crossed(Axis::V, &breaks[1]));
                let on = |t: f64| uv(a.u + t * (b.u - a.u), a.v + t * (b.v - a.v));
                let points: Vec<Uv> = (0..=steps).map(|j| on(j as f64 / steps as f64)).collect();
                for (j, at) in points.iter().enumerate() {
                    let p = self.point(*at);
                    found.add(&p);
                    for (slot, best) in rim.iter_mut().enumerate() {
                        if value(&p, slot) > best.0 {
                            let ends = [points[j.saturating_sub(1)], points[(j + 1).min(steps)]];
                            *best = (value(&p, slot), ends);
                        }
                    }
                }
            }
        }
        for slot in 0..6 {
            let sign = SIGNS[slot % 2];
            if inside[slot].0.is_finite()
                && let Some(p) = self.climb(inside[slot].1, slot / 2, sign)
            {
                found.add(&p);
            }
            // Along the boundary: between the neighbours of the best sample.
            let [a, b] = rim[slot].1;
            let on = |t: f64| self.point(uv(a.u + t * (b.u - a.u), a.v + t * (b.v - a.v)));
            found.add(&on(minimum([0.0, 1.0], FLAT, |t| -value(&on(t), slot)).x));
        }
        found
    }

    /// The point inside with the locally greatest `sign * coordinate`, by Newton steps from `at`; `None` where they
    /// leave the inside.
    fn climb(&self, at: Uv, coordinate: usize, sign: f64) -> Option<Point3> {
        let mut at = at;
        let mut value = sign * self.point(at)[coordinate];
        for _ in 0..20 {
            let jet = self.jet2(at);
            let g = [sign * jet.du[coordinate], sign * jet.dv[coordinate]];
            let h = [jet.duu, jet.duv, jet.dvv].map(|d| sign * d[coordinate]);
            if !(h[0] < 0.0 && h[0] * h[2] - h[1] * h[1] > 0.0) {
                return None;
            }
            let step = symmetric(h, g);
            let next = uv(at.u - step[0], at.v - step[1]);
            if !(next.u.is_finite() && next.v.is_finite() && self.contains(next)) {
                return None;
            }
            let reached = sign * self.point(next)[coordinate];
            if reached <= value {
                break;
            }
            (at, value) = (next, reached);
        }
        Some(self.point(at))
    }

    /// Points of the inside on a grid: the middles of `lines` equal parts of every span in both directions.
    #[must_use]
    pub fn samples(&self, lines: usize) -> Vec<(Uv, Point3)> {
        let middles = |axis: Axis| -> Vec<f64> {
            let n = lines.max(1);
            self.breaks(axis)
                .windows(2)
                .flat_map(|w| (0..n).map(move |k| w[0] + (w[1] - w[0]) * (k as f64 + 0.5) / n as f64))
                .collect()
        };
        let vs = middles(Axis::V);
        let mut out = Vec::new();
        for u in middles(Axis::U) {
            for v in &vs {
                let at = uv(u, *v);
                if self.contains(at) {
                    out.push((at, self.point(at)));
                }
            }
        }
        out
    }
}

impl Surface for TrimmedSurface {
    forward_surface!(point | s | s.carrier);
    fn jet2(&self, uv: Uv) -> Jet2 {
        self.carrier.jet2(uv).turned(self.side)
    }
    fn taylor(&self, uv: Uv, order: usize) -> Taylor {
        self.carrier.taylor(uv, order).turned(self.side)
    }
    fn jet3(&self, uv: Uv) -> Jet3 {
        self.carrier.jet3(uv).turned(self.side)
    }
    fn breaks(&self, axis: Axis) -> Vec<f64> {
        self.domain.get(axis).breaks(self.carrier.breaks(axis))
    }
    fn domain(&self) -> Domain {
        self.domain
    }
    fn contains(&self, uv: Uv) -> bool {
        self.domain.contains(uv)
            && self.region.as_ref().is_none_or(|r| r.inside(self.domain.bring(uv)))
            && self.facets.as_ref().is_none_or(|f| f.contains(uv))
    }
    fn pieces(&self) -> Vec<Domain> {
        self.facets.as_ref().map_or_else(|| vec![self.domain], |f| f.pieces())
    }
    /// Exact for the loops' polygons. Empty where `fixed` is outside the rectangle.
    fn spans(&self, axis: Axis, fixed: f64) -> Vec<Interval> {
        if let Some(facets) = &self.facets {
            return facets.spans(axis, fixed);
        }
        let across = self.domain.get(axis.other());
        if !across.contains(fixed) {
            return Vec::new();
        }
        let along = self.domain.get(axis);
        match &self.region {
            None => vec![Interval::new(along.lo, along.hi)],
            Some(r) => r.spans(axis, across.bring(fixed)),
        }
    }
    fn turns(&self) -> Vec<Uv> {
        let turns = |points: &[Uv]| -> Vec<Uv> {
            let n = points.len();
            let around = |k: usize| (points[(k + n - 1) % n], points[k], points[(k + 1) % n]);
            let back = |axis: Axis, k: usize| {
                let (a, b, c) = around(k);
                (b.get(axis) - a.get(axis)) * (c.get(axis) - b.get(axis)) <= 0.0
            };
            (0..n).filter(|k| back(Axis::U, *k) || back(Axis::V, *k)).map(|k| points[k]).collect()
        };
        self.loops.iter().flat_map(|l| turns(&l.points)).collect()
    }
}
