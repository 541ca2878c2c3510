//! Lines through the place of a chart, node by node.
//!
//! Between nodes point and normal are Hermite's cubics through both with their derivatives, parameters are chords.

use crate::strip::knotted::Knotted;
use crate::strip::traced::{Kept, between};
use osculate_geom::geodesic::GeodesicState;
use osculate_geom::{Darboux, Degenerate, Domain, Forms, Jet2, Surface, Taylor, Unit3, Uv, Vec3, uv};
use std::rc::Rc;
use std::sync::OnceLock;

/// Point, normal, parameters and the derivatives of the first two along the line.
pub(super) const PARTS: usize = 14;
/// Where the derivatives begin among the parts.
pub(super) const DERIVATIVES: usize = 8;
/// Order of the continuation outside the rectangle.
const BEYOND: usize = 4;
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
    /// Nodes to a Runge-Kutta step.
    pub stride: usize,
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
        let state = GeodesicState::start(self.part.surface, self.jet.uv, &self.direction(direction))?;
        let mut way =
            Way { nodes: Vec::with_capacity(pace.count + 1), midway: Vec::new(), hollow_per_mm: 0.0 };
        let (node, k_min) = self.parts(&self.jet, state)?;
        way.nodes.push(node);
        way.hollow_per_mm = (-k_min).max(0.0);
        let mut kept = None;
        let mut state = state;
        while way.nodes.len() <= pace.count {
            match self.stretch(&extended, (state, kept), pace, &mut way) {
                Ok(end) => (state, kept) = end,
                // What there is of the way is good.
                Err(_) => break,
            }
        }
        way.midway.truncate(way.nodes.len() - 1);
        Ok(way)
    }

    /// One Runge-Kutta step with its nodes; its end, and that with the second derivative where that was needed.
    fn stretch(
        &self,
        extended: &Extended<'_>,
        (from, kept): (GeodesicState, Option<Kept>),
        pace: Pace,
        way: &mut Way,
    ) -> Result<(GeodesicState, Option<Kept>), Degenerate> {
        let many = pace.stride.min(pace.count + 1 - way.nodes.len());
        let long = pace.step_mm * many as f64;
        let end = from.step(extended, long)?;
        let known = |state: GeodesicState| -> Result<Kept, Degenerate> {
            Ok(Kept { state, second: state.acceleration(extended)?, clear: true })
        };
        let ends = if many > 1 || pace.midway {
            let first = kept.map_or_else(|| known(from), Ok)?;
            Some((first, known(end)?))
        } else {
            None
        };
        let inner = |k: f64| ends.as_ref().map(|(a, b)| between(a, b, long, k / many as f64));
        for k in 1..=many {
            if pace.midway
                && let Some(half) = inner(k as f64 - 0.5)
            {
                way.midway.push(self.parts(&extended.jet2(half.at), half)?.0);
            }
            let state = if k < many { inner(k as f64).unwrap_or(end) } else { end };
            let (node, k_min) = self.parts(&extended.jet2(state.at), state)?;
            if self.holds(&node) {
                way.hollow_per_mm = way.hollow_per_mm.max(-k_min);
            }
            way.nodes.push(node);
        }
        Ok((end, ends.map(|e| e.1)))
    }

    /// The parts of a place less those of the chart's own, and the smaller principal curvature there.
    fn parts(&self, here: &Jet2, state: GeodesicState) -> Result<(Node, f64), Degenerate> {
        let own = here.forms()?;
        let tangent = here.tangent(state.rate);
        // Weingarten: the normal turns with the frame.
        let frame = Darboux::with_forms(here, &own, &tangent, 0.0);
        let n_rate = frame.turn.cross(&own.normal);
        let x = here.point - self.jet.point;
        let n = own.normal.into_inner() - self.forms.normal.into_inner();
        let (u, v) = (state.at.u - self.jet.uv.u, state.at.v - self.jet.uv.v);
        let d = frame.tangent;
        let node = [x.x, x.y, x.z, n.x, n.y, n.z, u, v, d.x, d.y, d.z, n_rate.x, n_rate.y, n_rate.z];
        Ok((node, own.principal().k_min))
    }
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
