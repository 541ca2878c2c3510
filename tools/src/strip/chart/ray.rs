//! Lines through the place of a chart, node by node.
//!
//! Between nodes point and normal are Hermite's cubics through both with their derivatives, parameters are chords.

use crate::strip::knotted::Knotted;
use crate::strip::traced::{Kept, between};
use osculate_geom::geodesic::GeodesicState;
use osculate_geom::solve::symmetric;
use osculate_geom::{Degenerate, Domain, Forms, Jet2, Surface, Taylor, Unit3, Uv, Vec3, uv};
use std::rc::Rc;
use std::sync::OnceLock;

/// Point, normal, parameters and the derivatives of the first two along the line.
pub(super) const PARTS: usize = 14;
/// Where the derivatives begin among the parts.
pub(super) const DERIVATIVES: usize = 8;
/// Order of the continuation outside the rectangle.
const BEYOND: usize = 4;
/// Second derivatives from which a line goes on.
const BACK: usize = 4;
/// By how much the two formulas of a step may disagree on the direction, rad; a fourteenth of it is left.
const DISAGREE: f64 = 1e-3;
/// Square of the sine between S_u and S_v below which there is no tangent plane, as for the forms.
const FLAT: f64 = 1e-22;
/// Halvings of the piece in which a line leaves the rectangle.
const HALVINGS: u32 = 30;

/// The parts of one place of a line, less those of the chart's own.
pub(super) type Node = [f64; PARTS];

/// The surface, beyond its rectangle by the Taylor polynomial at the place of it nearest to where it was first left.
pub(super) struct Extended<'a> {
    surface: &'a dyn Surface,
    domain: Domain,
    beyond: OnceLock<Taylor>,
}

impl<'a> Extended<'a> {
    pub(super) fn new(surface: &'a dyn Surface) -> Self {
        Self { surface, domain: surface.domain(), beyond: OnceLock::new() }
    }
}

impl Surface for Extended<'_> {
    fn domain(&self) -> Domain {
        self.domain
    }
    fn jet2(&self, at: Uv) -> Jet2 {
        if self.domain.contains(at) {
            return self.surface.jet2(at);
        }
        self.beyond.get_or_init(|| self.surface.taylor(self.domain.bring(at), BEYOND)).jet2_at(at)
    }
    fn taylor(&self, at: Uv, order: usize) -> Taylor {
        self.surface.taylor(at, order)
    }
}

/// The place of a chart.
pub(super) struct Place<'a> {
    pub part: Knotted<'a>,
    pub jet: Jet2,
    pub forms: Forms,
    pub domain: Domain,
    /// Unit tangent vectors, from the first of which towards the second angles are counted.
    pub axes: [Vec3; 2],
}

/// The nodes of a way that leaves the place.
pub(super) struct Way {
    /// The place itself first; fewer than asked for where the geodesic ends, as at a pole.
    pub nodes: Vec<Node>,
    /// The true parts midway between nodes, where asked for.
    pub midway: Vec<Node>,
    /// Largest curvature with which the part is hollow on the way, inside the rectangle, 1/mm.
    pub hollow_per_mm: f64,
}

/// How a way is followed.
#[derive(Clone, Copy)]
pub(super) struct Pace {
    pub step_mm: f64,
    pub count: usize,
    pub midway: bool,
}

impl<'a> Place<'a> {
    pub(super) fn new(surface: &'a dyn Surface, at: Uv) -> Result<Self, Degenerate> {
        let jet = surface.jet2(at);
        let forms = jet.forms()?;
        let axes = [forms.frame[0].into_inner(), forms.frame[1].into_inner() * jet.side.sign()];
        Ok(Self { part: Knotted::new(surface), jet, forms, domain: surface.domain(), axes })
    }

    pub(super) fn direction(&self, [c, s]: [f64; 2]) -> Vec3 {
        self.axes[0] * c + self.axes[1] * s
    }

    /// Whether a node lies in the surface's rectangle.
    pub(super) fn holds(&self, node: &Node) -> bool {
        self.domain.contains(uv(self.jet.uv.u + node[6], self.jet.uv.v + node[7]))
    }

    /// The least distance between knots on a line, as far as `reach_mm` to both sides, mm.
    pub(super) fn pitch_mm(&self, direction: [f64; 2], reach_mm: f64) -> f64 {
        let tangent = Unit3::new_normalize(self.direction(direction));
        self.part.pitch_mm(self.jet.uv, self.forms.rate(&self.jet, &tangent), reach_mm)
    }

    /// The geodesic that leaves in a direction.
    pub(super) fn trace(&self, direction: [f64; 2], pace: Pace) -> Result<Way, Degenerate> {
        let extended = Extended::new(self.part.surface);
        let mut state = GeodesicState::start(self.part.surface, self.jet.uv, &self.direction(direction))?;
        let mut way =
            Way { nodes: Vec::with_capacity(pace.count + 1), midway: Vec::new(), hollow_per_mm: 0.0 };
        let first = self.seen(&self.jet, state)?;
        way.nodes.push(first.node);
        way.hollow_per_mm = (-first.k_min).max(0.0);
        let mut seconds = [first.second; BACK];
        while way.nodes.len() <= pace.count {
            let known = way.nodes.len().min(BACK);
            // What there is of the way is good.
            let Ok((next, seen)) = self.next(&extended, state, &seconds[..known], pace.step_mm) else {
                break;
            };
            if pace.midway {
                let kept = |state: GeodesicState, second: Uv| Kept { state, second, clear: true };
                let half = between(&kept(state, seconds[0]), &kept(next, seen.second), pace.step_mm, 0.5);
                let Ok(there) = self.seen(&extended.jet2(half.at), half) else { break };
                way.midway.push(there.node);
            }
            if self.holds(&seen.node) {
                way.hollow_per_mm = way.hollow_per_mm.max(-seen.k_min);
            }
            way.nodes.push(seen.node);
            seconds.rotate_right(1);
            (state, seconds[0]) = (next, seen.second);
        }
        way.midway.truncate(way.nodes.len() - 1);
        Ok(way)
    }

    /// The next state at the step `h`, from the second derivatives at the last states, the latest first.
    ///
    /// The place is that of the cubic through four second derivatives, its rate that of the cubic through the new one and
    /// three before (Adams's formulas): one jet a node. Where the two do not agree on the direction, or fewer are known, by a
    /// Runge-Kutta step.
    fn next(
        &self,
        extended: &Extended<'_>,
        state: GeodesicState,
        seconds: &[Uv],
        h: f64,
    ) -> Result<(GeodesicState, Seen), Degenerate> {
        if let [a, b, c, d] = *seconds {
            let sum = |w: [f64; BACK], of: [Uv; BACK]| {
                let of = |x: fn(&Uv) -> f64| of.iter().zip(w).map(|(s, w)| w * x(s)).sum::<f64>();
                uv(of(|s| s.u), of(|s| s.v))
            };
            let on = |from: Uv, rate: Uv, by: f64| uv(from.u + by * rate.u, from.v + by * rate.v);
            let bend = sum([323.0, -264.0, 159.0, -38.0], [a, b, c, d]);
            let at = on(on(state.at, state.rate, h), bend, h * h / 360.0);
            let told = on(state.rate, sum([55.0, -59.0, 37.0, -9.0], [a, b, c, d]), h / 24.0);
            let jet = extended.jet2(at);
            let second = bend_of(&jet, told);
            let rate = on(state.rate, sum([9.0, 19.0, -5.0, 1.0], [second, a, b, c]), h / 24.0);
            // Nor do they where there is no tangent plane.
            if jet.tangent(uv(rate.u - told.u, rate.v - told.v)).norm() <= DISAGREE {
                let next = GeodesicState { at, rate };
                return Ok((next, self.seen(&jet, next)?));
            }
        }
        let next = state.step(extended, h)?;
        Ok((next, self.seen(&extended.jet2(next.at), next)?))
    }

    /// What the surface says at a state.
    fn seen(&self, here: &Jet2, state: GeodesicState) -> Result<Seen, Degenerate> {
        let (su, sv) = (&here.du, &here.dv);
        let cross = su.cross(sv);
        let (e, f, g) = (su.norm_squared(), su.dot(sv), sv.norm_squared());
        let det = cross.norm_squared();
        // The negated comparison also catches NaN.
        if !(det > FLAT * e * g && det.is_finite()) {
            return Err(Degenerate { at: state.at, sin_uv: (det / (e * g)).sqrt() });
        }
        let own = cross * (here.side.sign() / det.sqrt());
        let (l, m, n) = (here.duu.dot(&own), here.duv.dot(&own), here.dvv.dot(&own));
        let tangent = here.tangent(state.rate);
        let speed = tangent.norm();
        let d = tangent / speed;
        // Weingarten: the derivatives of the normal, from its products with S_u and S_v.
        let (p, q) = (l * state.rate.u + m * state.rate.v, m * state.rate.u + n * state.rate.v);
        let turn = (su * (f * q - g * p) + sv * (f * p - e * q)) / (det * speed);
        let (mean, gauss) = (-0.5 * (e * n - 2.0 * f * m + g * l) / det, (l * n - m * m) / det);
        let x = here.point - self.jet.point;
        let w = own - self.forms.normal.into_inner();
        let (u, v) = (state.at.u - self.jet.uv.u, state.at.v - self.jet.uv.v);
        Ok(Seen {
            node: [x.x, x.y, x.z, w.x, w.y, w.z, u, v, d.x, d.y, d.z, turn.x, turn.y, turn.z],
            k_min: mean - (mean * mean - gauss).max(0.0).sqrt(),
            second: bend_of(here, state.rate),
        })
    }
}

/// The second derivative of the parameters that keeps a line with their rate geodesic; no number without a tangent plane.
#[inline]
fn bend_of(here: &Jet2, rate: Uv) -> Uv {
    let (su, sv) = (&here.du, &here.dv);
    let (e, f, g) = (su.norm_squared(), su.dot(sv), sv.norm_squared());
    let second = here.second(rate);
    let [u, v] = symmetric([e, f, g], [-second.dot(su), -second.dot(sv)]);
    uv(u, v)
}

/// A place on a line.
struct Seen {
    /// Its parts, less those of the chart's own.
    node: Node,
    /// The smaller principal curvature, 1/mm.
    k_min: f64,
    /// The second derivative of the parameters along a geodesic, per mm2.
    second: Uv,
}

/// A line by nodes, the place in the middle; derivatives are per step of nodes.
pub(super) struct Nodes {
    nodes: Vec<Node>,
    /// How far the line goes behind and ahead of the place, mm, and where it leaves the rectangle, infinite where it does not.
    reach: [f64; 2],
    inside: [f64; 2],
    /// The least distance between knots on it, mm.
    pitch: f64,
}

impl Nodes {
    /// The line of two ways that leave the place in opposite directions, to `radius` mm by `count` nodes each where they are whole.
    pub(super) fn new(
        place: &Place<'_>,
        [behind, ahead]: [&[Node]; 2],
        (radius, count): (f64, usize),
        pitch: f64,
    ) -> Self {
        let step = radius / count as f64;
        let mut nodes = vec![[0.0; PARTS]; 2 * count + 1];
        let mut put = |index: usize, node: &Node, rate: f64| {
            nodes[index] = *node;
            nodes[index][DERIVATIVES..].iter_mut().for_each(|v| *v *= rate);
        };
        for k in 0..=count {
            // Beyond its end a way stands still; it is not asked there.
            let of = |way: &[Node]| way[k.min(way.len() - 1)];
            if k > 0 {
                put(count - k, &of(behind), -step);
            }
            put(count + k, &of(ahead), step);
        }
        let reach = [behind, ahead].map(|way| step * (way.len() - 1) as f64);
        let inside = [behind, ahead].map(|way| match way.iter().position(|n| !place.holds(n)) {
            None => f64::INFINITY,
            Some(0) => 0.0,
            Some(k) => step * ((k - 1) as f64 + leaves(place, &way[k - 1], &way[k])),
        });
        Self { nodes, reach, inside, pitch }
    }
}

/// The share of a piece at whose end its chord leaves the rectangle.
fn leaves(place: &Place<'_>, from: &Node, to: &Node) -> f64 {
    let (mut lo, mut hi) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let m = 0.5 * (lo + hi);
        let mut node = *from;
        (6..DERIVATIVES).for_each(|i| node[i] += m * (to[i] - from[i]));
        if place.holds(&node) { lo = m } else { hi = m }
    }
    lo
}

/// A line in one of its senses.
#[derive(Clone)]
pub(super) struct Ray {
    pub line: Rc<Nodes>,
    pub backwards: bool,
}

impl Ray {
    /// How far the line goes behind and ahead of the place, mm.
    pub(super) fn reach(&self) -> [f64; 2] {
        self.sorted(self.line.reach)
    }

    /// Where it leaves the rectangle behind and ahead of the place, mm; infinite where it does not.
    pub(super) fn inside(&self) -> [f64; 2] {
        self.sorted(self.line.inside)
    }

    /// The least distance between knots on it, mm.
    pub(super) fn pitch_mm(&self) -> f64 {
        self.line.pitch
    }

    fn sorted(&self, [behind, ahead]: [f64; 2]) -> [f64; 2] {
        if self.backwards { [ahead, behind] } else { [behind, ahead] }
    }

    fn sign(&self) -> f64 {
        if self.backwards { -1.0 } else { 1.0 }
    }

    /// The piece at `x` (length over the chart's radius, in the line's own sense) and the place in it from 0 to 1.
    fn piece(&self, x: f64) -> (&Node, &Node, f64) {
        let nodes = &self.line.nodes;
        let last = nodes.len() - 1;
        let at = 0.5 * (x + 1.0) * last as f64;
        let k = (at.floor().max(0.0) as usize).min(last - 1);
        (&nodes[k], &nodes[k + 1], at - k as f64)
    }

    /// Point and normal, less those of the place.
    pub(super) fn values(&self, x: f64) -> [f64; 6] {
        let (a, b, t) = self.piece(self.sign() * x);
        let (u, tt) = (1.0 - t, t * t);
        let (h1, h2, h3) = (tt * (3.0 - 2.0 * t), t * u * u, -tt * u);
        std::array::from_fn(|k| {
            let (da, db) = (a[DERIVATIVES + k], b[DERIVATIVES + k]);
            a[k] + (b[k] - a[k]) * h1 + da * h2 + db * h3
        })
    }

    /// Point and normal with two derivatives of the one and one of the other, per step of nodes.
    pub(super) fn moving(&self, x: f64) -> ([f64; 6], [f64; 6], [f64; 3]) {
        let sign = self.sign();
        let (a, b, t) = self.piece(sign * x);
        let (mut p, mut d, mut dd) = ([0.0; 6], [0.0; 6], [0.0; 3]);
        for k in 0..6 {
            let (da, db) = (a[DERIVATIVES + k], b[DERIVATIVES + k]);
            let rise = b[k] - a[k];
            // a + t (da + t (c2 + t c3)).
            let (c2, c3) = (3.0 * rise - 2.0 * da - db, da + db - 2.0 * rise);
            p[k] = a[k] + t * (da + t * (c2 + t * c3));
            d[k] = sign * (da + t * (2.0 * c2 + 3.0 * t * c3));
            if k < 3 {
                dd[k] = 2.0 * c2 + 6.0 * t * c3;
            }
        }
        (p, d, dd)
    }
}
