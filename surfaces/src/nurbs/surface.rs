//! Tensor-product NURBS surfaces: the data, its checks, and the view as [`Surface`].
//!
//! `S(u, v) = sum N_i(u) N_j(v) w_ij P_ij / sum N_i(u) N_j(v) w_ij` over `[u_p, u_n] x [v_q, v_m]`. Poles are
//! stored with v running fastest. Parameters outside are clamped to the domain, or wrapped where the surface
//! closes smoothly.
//!
//! Source: [Piegl & Tiller, The NURBS Book, chapters 3 and 4].

use super::eval::{Evaluator, piece_orders};
use super::net::Net;
use super::pieces::{Orders, Pieces};
use super::taylor::{taylor, third, third_of_piece};
use crate::closest::Index;
use crate::knots::{KnotError, Knots, MAX_DEGREE};
use crate::quad;
use nalgebra::Vector4;
use osculate_geom::{Axis, Box3, Domain, Interval, Jet2, Jet3, Point3, Side, Surface, Taylor, Uv, Vec3};
use std::fmt;
use std::sync::OnceLock;

/// Why data are no NURBS surface.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NurbsError {
    /// Degree zero, above [`MAX_DEGREE`], or not below the number of poles.
    #[error(
        "degree {degree} over {poles} poles along {axis:?}: it must be 1 to {MAX_DEGREE} and below the number of poles"
    )]
    Degree {
        /// Along which parameter.
        axis: Axis,
        /// The degree.
        degree: usize,
        /// The number of poles.
        poles: usize,
    },
    /// Wrong number of knots.
    #[error(
        "{got} knots along {axis:?}, but poles + degree + 1 = {need} are needed (write multiple knots out)"
    )]
    KnotCount {
        /// Along which parameter.
        axis: Axis,
        /// How many there are.
        got: usize,
        /// How many are needed.
        need: usize,
    },
    /// A knot that is not a finite number.
    #[error("knot {index} along {axis:?} is {got}, not a finite number")]
    KnotNotFinite {
        /// Along which parameter.
        axis: Axis,
        /// Which, from 0.
        index: usize,
        /// Its value.
        got: f64,
    },
    /// A knot below the one before.
    #[error("knot {index} along {axis:?} is {got}, below the {before} before it")]
    KnotDecreasing {
        /// Along which parameter.
        axis: Axis,
        /// Which, from 0.
        index: usize,
        /// Its value.
        got: f64,
        /// The one before.
        before: f64,
    },
    /// A knot repeated so often that the surface falls apart there.
    #[error("knot {at} along {axis:?} stands {multiplicity} times, but only {most} are possible there")]
    KnotMultiplicity {
        /// Along which parameter.
        axis: Axis,
        /// The knot.
        at: f64,
        /// How often it stands there.
        multiplicity: usize,
        /// How often it may.
        most: usize,
    },
    /// The domain along one parameter has no length, or one that double precision cannot hold.
    #[error("the domain along {axis:?} is [{lo}, {hi}]: its length must be positive and finite")]
    EmptyDomain {
        /// Along which parameter.
        axis: Axis,
        /// Lower end.
        lo: f64,
        /// Upper end.
        hi: f64,
    },
    /// The poles are not as many as the net's counts say.
    #[error("{got} poles where the counts of the net ask for {need}")]
    PoleCount {
        /// How many there are.
        got: usize,
        /// How many are needed.
        need: usize,
    },
    /// There is not one weight for each pole.
    #[error("{got} weights for {need} poles")]
    WeightCount {
        /// How many there are.
        got: usize,
        /// How many are needed.
        need: usize,
    },
    /// A pole with a coordinate that is not a finite number.
    #[error("pole {index} is ({}, {}, {}): all coordinates must be finite", got[0], got[1], got[2])]
    NonFinite {
        /// Its place in the net, v fastest.
        index: usize,
        /// Its coordinates.
        got: [f64; 3],
    },
    /// A weight that is zero, negative or not finite.
    #[error("weight {index} is {got}: weights must be positive and finite")]
    Weight {
        /// Its place in the net, v fastest.
        index: usize,
        /// Its value.
        got: f64,
    },
}

impl NurbsError {
    /// The error of the knots along one axis.
    const fn on(axis: Axis, error: KnotError) -> Self {
        match error {
            KnotError::Degree { degree, poles } => Self::Degree { axis, degree, poles },
            KnotError::Count { got, need } => Self::KnotCount { axis, got, need },
            KnotError::NotFinite { index, got } => Self::KnotNotFinite { axis, index, got },
            KnotError::Decreasing { index, got, before } => Self::KnotDecreasing { axis, index, got, before },
            KnotError::Multiplicity { at, multiplicity, most, .. } => {
                Self::KnotMultiplicity { axis, at, multiplicity, most }
            }
            KnotError::Empty { lo, hi } => Self::EmptyDomain { axis, lo, hi },
        }
    }
}

/// Two opposite sides closer than this fraction of the control box are one line in space: files that keep ten
/// digits write a seam twice within it, and no wanted gap is as narrow (1e-6 mm on a part of a metre).
const SAME_LINE: f64 = 1e-9;

/// Cross derivatives of the two sides that differ by less than this fraction are one: a crease of a millionth
/// of a radian is below what any machine shows.
const SAME_DERIVATIVE: f64 = 1e-6;

/// A checked NURBS surface with precomputed polynomial pieces.
#[derive(Clone)]
pub struct NurbsSurface {
    knots: [Knots; 2],
    net: Net,
    side: Side,
    domain: Domain,
    closed: [bool; 2],
    evaluator: Evaluator,
    /// Built when the first closest point is asked for.
    /// For closest points, made when the first is asked for.
    pub(crate) index_cell: OnceLock<Index>,
}

impl NurbsSurface {
    /// The surface of the given degrees, knots (multiple ones written out) and control net; `[u, v]`
    /// throughout. The outward normal is along `S_u x S_v`.
    ///
    /// ```
    /// use osculate_geom::{Point3, Surface, Vec3, uv};
    /// use osculate_surfaces::{Net, NurbsError, NurbsSurface};
    /// // A plane of 20 x 30 mm as one bilinear patch; its normal is S_u x S_v.
    /// let points = vec![[0.0, 0.0], [0.0, 30.0], [20.0, 0.0], [20.0, 30.0]];
    /// let points = points.into_iter().map(|[x, y]| Point3::new(x, y, 0.0)).collect();
    /// let (flat, net) = (vec![0.0, 0.0, 1.0, 1.0], Net { count: [2, 2], points, weights: None });
    /// let plane = NurbsSurface::new([1, 1], [flat.clone(), flat.clone()], net.clone())?;
    /// assert_eq!(plane.point(uv(0.5, 0.1)), Point3::new(10.0, 3.0, 0.0));
    /// assert_eq!(plane.jet2(uv(0.5, 0.1)).normal()?, Vec3::z_axis());
    /// // Two poles do not carry degree two.
    /// let refused = NurbsSurface::new([2, 1], [flat.clone(), flat], net);
    /// assert!(matches!(refused, Err(NurbsError::Degree { degree: 2, poles: 2, .. })));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`NurbsError`] says which number is wrong and where.
    pub fn new(degree: [usize; 2], knots: [Vec<f64>; 2], net: Net) -> Result<Self, NurbsError> {
        let [ku, kv] = knots;
        let ku = Knots::new(degree[0], net.count[0], ku).map_err(|e| NurbsError::on(Axis::U, e))?;
        let kv = Knots::new(degree[1], net.count[1], kv).map_err(|e| NurbsError::on(Axis::V, e))?;
        let need = net.count[0].saturating_mul(net.count[1]);
        if net.points.len() != need {
            return Err(NurbsError::PoleCount { got: net.points.len(), need });
        }
        let bad = net.points.iter().enumerate().find(|(_, p)| !p.iter().all(|c| c.is_finite()));
        if let Some((index, p)) = bad {
            return Err(NurbsError::NonFinite { index, got: [p.x, p.y, p.z] });
        }
        if let Some(weights) = &net.weights {
            if weights.len() != need {
                return Err(NurbsError::WeightCount { got: weights.len(), need });
            }
            let bad = weights.iter().enumerate().find(|(_, w)| !(**w > 0.0 && w.is_finite()));
            if let Some((index, got)) = bad {
                return Err(NurbsError::Weight { index, got: *got });
            }
        }
        Ok(Self::checked([ku, kv], net, Side::Along))
    }

    /// The surface of data that are known to be in order.
    pub(crate) fn checked(knots: [Knots; 2], net: Net, side: Side) -> Self {
        let interval = |k: &Knots| Interval::new(k.domain()[0], k.domain()[1]);
        let domain = Domain { u: interval(&knots[0]), v: interval(&knots[1]) };
        let evaluator = Evaluator::new(&knots, &net);
        let mut surface =
            Self { knots, net, side, domain, closed: [false; 2], evaluator, index_cell: OnceLock::new() };
        let seams = [Axis::U, Axis::V].map(|axis| surface.seam(axis));
        surface.closed = seams.map(|s| s != Seam::Open);
        surface.domain.u.periodic = seams[0] == Seam::Smooth;
        surface.domain.v.periodic = seams[1] == Seam::Smooth;
        surface
    }

    /// How the two sides that `axis` runs between meet.
    ///
    /// They are compared at enough places to tell two rational curves of the net's degree apart.
    fn seam(&self, axis: Axis) -> Seam {
        let (along, across) = (self.domain.get(axis), &self.knots[1 - axis as usize]);
        let size = self.control_box().diagonal_mm();
        let places = 2 * across.degree() + 2;
        let (mut speed, mut crease) = (0.0_f64, 0.0_f64);
        for w in across.breaks().windows(2) {
            for k in 0..places {
                let t = w[0] + (w[1] - w[0]) * k as f64 / (places - 1) as f64;
                let [lo, hi] = [along.lo, along.hi].map(|end| self.jet2(Uv::from_axis(axis, end, t)));
                let gap = (lo.point - hi.point).norm();
                // A NaN from coordinates near the end of the number range is no seam.
                if gap > SAME_LINE * size || gap.is_nan() {
                    return Seam::Open;
                }
                let [a, b] = if axis == Axis::U { [lo.du, hi.du] } else { [lo.dv, hi.dv] };
                speed = speed.max(a.norm()).max(b.norm());
                crease = crease.max((a - b).norm());
            }
        }
        // A surface without extent along the axis has no loop to go round.
        if speed * along.length() <= SAME_LINE * size {
            Seam::Open
        } else if crease <= SAME_DERIVATIVE * speed {
            Seam::Smooth
        } else {
            Seam::Creased
        }
    }

    /// The same surface with the material on the given side of `S_u x S_v`.
    #[must_use]
    pub fn with_side(mut self, side: Side) -> Self {
        self.side = side;
        self
    }

    /// The material side.
    #[must_use]
    pub const fn side(&self) -> Side {
        self.side
    }

    /// Degrees along u and v.
    #[must_use]
    pub const fn degree(&self) -> [usize; 2] {
        [self.knots[0].degree(), self.knots[1].degree()]
    }

    /// The knots along one parameter.
    #[must_use]
    pub const fn knots(&self, axis: Axis) -> &Knots {
        match axis {
            Axis::U => &self.knots[0],
            Axis::V => &self.knots[1],
        }
    }

    /// The control net.
    #[must_use]
    pub const fn net(&self) -> &Net {
        &self.net
    }

    /// Whether the weights differ from each other: equal ones make a polynomial surface.
    #[must_use]
    pub fn is_rational(&self) -> bool {
        self.net.weights.as_ref().is_some_and(|w| w.iter().any(|x| *x != w[0]))
    }

    /// The box around the control net, which holds the surface.
    #[must_use]
    pub fn control_box(&self) -> Box3 {
        Box3::around(&self.net.points)
    }

    /// Whether the two sides that the parameter runs between are one line in space, smooth across it or not.
    #[must_use]
    pub const fn closed(&self, axis: Axis) -> bool {
        match axis {
            Axis::U => self.closed[0],
            Axis::V => self.closed[1],
        }
    }

    /// Pole (i, j) in homogeneous coordinates `(w x, w y, w z, w)`.
    pub(crate) fn homogeneous(&self, i: usize, j: usize) -> Vector4<f64> {
        let at = i * self.net.count[1] + j;
        let w = self.net.weights.as_ref().map_or(1.0, |w| w[at]);
        let p = &self.net.points[at];
        Vector4::new(w * p.x, w * p.y, w * p.z, w)
    }

    /// The spans that hold parameters of the domain.
    #[inline(always)]
    pub(crate) fn span(&self, at: Uv) -> [usize; 2] {
        [self.knots[0].find(at.u), self.knots[1].find(at.v)]
    }

    /// The jet of one piece: at the piece's upper ends that of the piece, not of the next one.
    #[inline]
    pub(crate) fn piece_jet(&self, at: Uv, span: [usize; 2]) -> Jet2 {
        match self.evaluator.pieces() {
            Some(pieces) => quad::run(PieceJet { pieces, at, span, side: self.side }),
            None => jet_of(at, Evaluator::direct(&self.knots, &self.net, at, span), self.side),
        }
    }

    /// [`Self::piece_jet`] as part of code that already runs over wide registers.
    #[inline(always)]
    pub(crate) fn jet_on<Q: quad::Quad>(&self, q: Q, pieces: &Pieces, at: Uv, span: [usize; 2]) -> Jet2 {
        jet_of(at, piece_orders(q, pieces, at, span), self.side)
    }

    /// The precomputed pieces, where there are any.
    pub(crate) const fn pieces(&self) -> Option<&Pieces> {
        self.evaluator.pieces()
    }

    /// Both knot vectors.
    pub(crate) const fn both_knots(&self) -> &[Knots; 2] {
        &self.knots
    }

    /// The parameters inside the domain that stand for `at`. Inside, nothing is rounded.
    #[inline(always)]
    pub(crate) fn bring(&self, at: Uv) -> Uv {
        let d = &self.domain;
        if at.u >= d.u.lo && at.u <= d.u.hi && at.v >= d.v.lo && at.v <= d.v.hi { at } else { d.bring(at) }
    }
}

/// A jet from its parts.
#[inline(always)]
fn jet_of(at: Uv, [point, du, dv, duu, duv, dvv]: Orders<Vec3>, side: Side) -> Jet2 {
    Jet2 { uv: at, point: point.into(), du, dv, duu, duv, dvv, side }
}

/// The jet at a place of a known piece.
struct PieceJet<'a> {
    pieces: &'a Pieces,
    at: Uv,
    span: [usize; 2],
    side: Side,
}

impl quad::Over for PieceJet<'_> {
    type Output = Jet2;

    #[inline(always)]
    fn run<Q: quad::Quad>(self, q: Q) -> Jet2 {
        jet_of(self.at, piece_orders(q, self.pieces, self.at, self.span), self.side)
    }
}

/// The jet at any place.
struct JetAt<'a> {
    surface: &'a NurbsSurface,
    pieces: &'a Pieces,
    at: Uv,
}

impl quad::Over for JetAt<'_> {
    type Output = Jet2;

    #[inline(always)]
    fn run<Q: quad::Quad>(self, q: Q) -> Jet2 {
        let at = self.surface.bring(self.at);
        jet_of(at, piece_orders(q, self.pieces, at, self.surface.span(at)), self.surface.side)
    }
}

/// How two opposite sides of a surface meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Seam {
    /// They do not.
    Open,
    /// In one line with a crease.
    Creased,
    /// In one line across which the surface is smooth.
    Smooth,
}

impl Surface for NurbsSurface {
    fn domain(&self) -> Domain {
        self.domain
    }

    #[inline]
    fn jet2(&self, uv: Uv) -> Jet2 {
        if let Some(pieces) = self.evaluator.pieces() {
            return quad::run(JetAt { surface: self, pieces, at: uv });
        }
        let at = self.bring(uv);
        self.piece_jet(at, self.span(at))
    }

    fn jet3(&self, uv: Uv) -> Jet3 {
        let at = self.bring(uv);
        let span = self.span(at);
        let [duuu, duuv, duvv, dvvv] = match self.evaluator.pieces() {
            Some(pieces) => third_of_piece(pieces, at, span),
            None => third(&self.knots, &self.net, at, span),
        };
        Jet3 { jet2: self.piece_jet(at, span), duuu, duuv, duvv, dvvv }
    }

    fn taylor(&self, uv: Uv, order: usize) -> Taylor {
        let at = self.bring(uv);
        taylor(&self.knots, &self.net, self.side, (at, self.span(at)), order)
    }

    #[inline]
    fn point(&self, uv: Uv) -> Point3 {
        let at = self.bring(uv);
        self.evaluator.point(&self.knots, &self.net, at, self.span(at))
    }

    fn breaks(&self, axis: Axis) -> Vec<f64> {
        self.knots(axis).breaks().to_vec()
    }
}

impl fmt::Debug for NurbsSurface {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("NurbsSurface")
            .field("knots", &self.knots)
            .field("net", &self.net)
            .field("side", &self.side)
            .field("domain", &self.domain)
            .field("closed", &self.closed)
            .finish_non_exhaustive()
    }
}
