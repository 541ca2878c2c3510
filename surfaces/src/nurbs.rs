//! NURBS surfaces: data, invariants and evaluation.
//!
//! The net is stored with v fastest: pole (i, j) is `points[i * count[1] + j]`. Evaluation works on the polynomial
//! pieces between knots, whose coefficients are computed once: a jet costs two nested Horner schemes and, where the
//! surface is rational, the quotient rule.

use crate::knots::{KnotError, Knots};
use osculate_geom::{Axis, Box3, Domain, Interval, Jet2, Point3, Side, Surface, Uv, Vec3};

/// Control net of a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Net {
    /// Number of poles in u and v.
    pub count: [usize; 2],
    /// Poles, v fastest, mm.
    pub points: Vec<Point3>,
    /// Weights in the same order; None for a polynomial surface.
    pub weights: Option<Vec<f64>>,
}

/// Why numbers are no NURBS surface.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NurbsError {
    /// A knot vector is none.
    #[error("knots in {axis:?}: {source}")]
    Knots {
        /// Which parameter.
        axis: Axis,
        /// What is wrong.
        source: KnotError,
    },
    /// Wrong number of poles or weights.
    #[error("{got} {what} where a net of {u} x {v} needs {need}", u = count[0], v = count[1])]
    NetCount {
        /// Poles or weights.
        what: &'static str,
        /// How many there are.
        got: usize,
        /// How many are needed.
        need: usize,
        /// The net.
        count: [usize; 2],
    },
    /// A pole with a coordinate that is not finite.
    #[error("pole {index} has a coordinate that is not finite")]
    NotFinite {
        /// Which.
        index: usize,
    },
    /// A weight that is not positive and finite.
    #[error("weight {index} is {got}; weights must be positive and finite")]
    Weight {
        /// Which.
        index: usize,
        /// Its value.
        got: f64,
    },
}

/// A NURBS surface of any degree.
#[derive(Clone, Debug)]
pub struct NurbsSurface {
    knots: [Knots; 2],
    net: Net,
    domain: Domain,
    closed: [bool; 2],
    patches: Patches,
}

/// Coefficients of all polynomial pieces in local parameters, homogeneous where rational.
#[derive(Clone, Debug)]
struct Patches {
    /// Breaks in u and v.
    breaks: [Vec<f64>; 2],
    /// For each piece (v fastest) `(p + 1)(q + 1)` coefficients `[x, y, z, w]`, powers of v fastest.
    coefficients: Vec<[f64; 4]>,
}

/// Two ends are the same point within this part of the net's size: importers write nine digits or more.
const SAME_POINT: f64 = 1e-7;
/// Two first derivatives are the same within this part of their length.
const SAME_SLOPE: f64 = 1e-4;

impl NurbsSurface {
    /// The surface of `degree`, `knots` and `net`.
    ///
    /// # Errors
    /// [`NurbsError`].
    pub fn new(degree: [usize; 2], knots: [Vec<f64>; 2], net: Net) -> Result<Self, NurbsError> {
        let need = net.count[0].saturating_mul(net.count[1]);
        if net.points.len() != need {
            return Err(NurbsError::NetCount { what: "poles", got: net.points.len(), need, count: net.count });
        }
        if let Some(index) = net.points.iter().position(|p| !p.iter().all(|c| c.is_finite())) {
            return Err(NurbsError::NotFinite { index });
        }
        if let Some(w) = &net.weights {
            if w.len() != need {
                return Err(NurbsError::NetCount { what: "weights", got: w.len(), need, count: net.count });
            }
            if let Some(index) = w.iter().position(|w| !(w.is_finite() && *w > 0.0)) {
                return Err(NurbsError::Weight { index, got: w[index] });
            }
        }
        let [ku, kv] = knots;
        let check = |axis, degree, poles, k| {
            Knots::new(degree, poles, k).map_err(|source| NurbsError::Knots { axis, source })
        };
        let knots = [check(Axis::U, degree[0], net.count[0], ku)?, check(Axis::V, degree[1], net.count[1], kv)?];
        let patches = Patches::new(&knots, &net);
        let end = |k: &Knots| Interval::new(k.domain()[0], k.domain()[1]);
        let domain = Domain { u: end(&knots[0]), v: end(&knots[1]) };
        let mut surface = Self { knots, net, domain, closed: [false; 2], patches };
        for axis in [Axis::U, Axis::V] {
            let [closed, smooth] = surface.closes(axis);
            match axis {
                Axis::U => (surface.closed[0], surface.domain.u.periodic) = (closed, smooth),
                Axis::V => (surface.closed[1], surface.domain.v.periodic) = (closed, smooth),
            }
        }
        Ok(surface)
    }

    /// Degrees in u and v.
    #[must_use]
    pub fn degree(&self) -> [usize; 2] {
        [self.knots[0].degree(), self.knots[1].degree()]
    }

    /// Knot vectors in u and v.
    #[must_use]
    pub const fn knots(&self) -> &[Knots; 2] {
        &self.knots
    }

    /// The control net.
    #[must_use]
    pub const fn net(&self) -> &Net {
        &self.net
    }

    /// Whether the weights differ.
    #[must_use]
    pub fn is_rational(&self) -> bool {
        self.net.weights.as_ref().is_some_and(|w| w.iter().any(|x| *x != w[0]))
    }

    /// Whether the surface meets itself at the two ends of a parameter, smoothly or not.
    #[must_use]
    pub const fn is_closed(&self, axis: Axis) -> bool {
        match axis {
            Axis::U => self.closed[0],
            Axis::V => self.closed[1],
        }
    }

    /// Box around the poles, which contains the surface.
    #[must_use]
    pub fn control_box(&self) -> Box3 {
        Box3::around(&self.net.points)
    }

    /// Whether both ends along `axis` meet, and whether they do so with one slope.
    fn closes(&self, axis: Axis) -> [bool; 2] {
        let size = self.control_box().diagonal_mm();
        let (i, across) = (self.domain.get(axis), self.domain.get(axis.other()));
        let n = 4 * self.knots[usize::from(axis == Axis::U)].span_count().min(64) + 1;
        let (mut closed, mut smooth, mut extent) = (true, true, 0.0f64);
        for k in 0..=n {
            let c = across.at(k as f64 / n as f64);
            let [a, b] = [i.lo, i.hi].map(|t| self.raw_jet(Uv::from_axis(axis, t, c)));
            let slope = |j: &Jet2| if axis == Axis::U { j.du } else { j.dv };
            closed &= (a.point - b.point).norm() <= SAME_POINT * size;
            smooth &= (slope(&a) - slope(&b)).norm() <= SAME_SLOPE * slope(&a).norm().max(slope(&b).norm());
            // A direction that is a point everywhere closes nothing.
            let mid = self.raw_jet(Uv::from_axis(axis, i.at(0.5), c));
            extent = extent.max((mid.point - a.point).norm());
        }
        closed &= extent > SAME_POINT * size;
        [closed, closed && smooth]
    }

    fn raw_jet(&self, at: Uv) -> Jet2 {
        let h = self.patches.jet(self.degree(), at);
        let v3 = |c: &[f64; 4]| Vec3::new(c[0], c[1], c[2]);
        let [a, au, av, auu, auv, avv] = &h;
        if self.net.weights.is_none() {
            return Jet2 {
                uv: at,
                point: Point3::from(v3(a)),
                du: v3(au),
                dv: v3(av),
                duu: v3(auu),
                duv: v3(auv),
                dvv: v3(avv),
                side: Side::Along,
            };
        }
        let w = 1.0 / a[3];
        let s = v3(a) * w;
        let du = (v3(au) - s * au[3]) * w;
        let dv = (v3(av) - s * av[3]) * w;
        Jet2 {
            uv: at,
            point: Point3::from(s),
            du,
            dv,
            duu: (v3(auu) - du * (2.0 * au[3]) - s * auu[3]) * w,
            duv: (v3(auv) - du * av[3] - dv * au[3] - s * auv[3]) * w,
            dvv: (v3(avv) - dv * (2.0 * av[3]) - s * avv[3]) * w,
            side: Side::Along,
        }
    }
}

impl Surface for NurbsSurface {
    fn domain(&self) -> Domain {
        self.domain
    }

    fn jet2(&self, at: Uv) -> Jet2 {
        let mut jet = self.raw_jet(self.domain.bring(at));
        jet.uv = at;
        jet
    }

    fn breaks(&self, axis: Axis) -> Vec<f64> {
        self.patches.breaks[usize::from(axis == Axis::V)].clone()
    }
}

impl Patches {
    fn new(knots: &[Knots; 2], net: &Net) -> Self {
        let [p, q] = [knots[0].degree(), knots[1].degree()];
        let [nu, nv] = [knots[0].span_count(), knots[1].span_count()];
        let polynomials: [Vec<Vec<Vec<f64>>>; 2] =
            [0, 1].map(|k| (0..knots[k].span_count()).map(|s| knots[k].span_polynomials(s)).collect());
        let mut coefficients = Vec::with_capacity(nu * nv * (p + 1) * (q + 1));
        let mut rows = vec![[0.0; 4]; (p + 1) * (q + 1)];
        for (su, in_u) in polynomials[0].iter().enumerate() {
            let (_, i0) = knots[0].span(su);
            for (sv, in_v) in polynomials[1].iter().enumerate() {
                let (_, j0) = knots[1].span(sv);
                // First over v for each row of poles, then over u.
                rows.fill([0.0; 4]);
                for i in 0..=p {
                    for (j, poly) in in_v.iter().enumerate() {
                        let k = (i0 + i) * net.count[1] + j0 + j;
                        let w = net.weights.as_ref().map_or(1.0, |w| w[k]);
                        let c = &net.points[k];
                        let h = [c.x * w, c.y * w, c.z * w, w];
                        for (b, f) in poly.iter().enumerate() {
                            for (o, x) in rows[i * (q + 1) + b].iter_mut().zip(h) {
                                *o += f * x;
                            }
                        }
                    }
                }
                for a in 0..=p {
                    for b in 0..=q {
                        let mut sum = [0.0; 4];
                        for (i, poly) in in_u.iter().enumerate() {
                            for (o, x) in sum.iter_mut().zip(rows[i * (q + 1) + b]) {
                                *o += poly[a] * x;
                            }
                        }
                        coefficients.push(sum);
                    }
                }
            }
        }
        Self { breaks: [knots[0].breaks(), knots[1].breaks()], coefficients }
    }

    /// Homogeneous value, first and second derivatives.
    fn jet(&self, [p, q]: [usize; 2], at: Uv) -> [[f64; 4]; 6] {
        let piece = |breaks: &[f64], t: f64| {
            let k = breaks[1..breaks.len() - 1].partition_point(|b| *b <= t);
            let h = breaks[k + 1] - breaks[k];
            (k, (t - breaks[k]) / h, 1.0 / h)
        };
        let (iu, s, hu) = piece(&self.breaks[0], at.u);
        let (iv, t, hv) = piece(&self.breaks[1], at.v);
        let size = (p + 1) * (q + 1);
        let start = (iu * (self.breaks[1].len() - 1) + iv) * size;
        let c = &self.coefficients[start..start + size];
        let mut out = [[0.0; 4]; 6];
        let [a, au, av, auu, auv, avv] = &mut out;
        for row in c.chunks_exact(q + 1).rev() {
            // Horner in v with both derivatives (the second one halved) ...
            let (mut f, mut d, mut e) = ([0.0; 4], [0.0; 4], [0.0; 4]);
            for x in row.iter().rev() {
                for k in 0..4 {
                    e[k] = e[k] * t + d[k];
                    d[k] = d[k] * t + f[k];
                    f[k] = f[k] * t + x[k];
                }
            }
            // ... and the same in u with these as coefficients.
            for k in 0..4 {
                auu[k] = auu[k] * s + au[k];
                au[k] = au[k] * s + a[k];
                a[k] = a[k] * s + f[k];
                auv[k] = auv[k] * s + av[k];
                av[k] = av[k] * s + d[k];
                avv[k] = avv[k] * s + e[k];
            }
        }
        for k in 0..4 {
            au[k] *= hu;
            av[k] *= hv;
            auu[k] *= 2.0 * hu * hu;
            auv[k] *= hu * hv;
            avv[k] *= 2.0 * hv * hv;
        }
        out
    }
}
