//! Edges in the parameters of the surfaces that they bound, for writers.
//!
//! The way `C(t)` of an edge is followed over a surface by the feet of its points, `S(a(t)) - C(t)` along the normal;
//! `a` becomes a cubic spline with the way's own parameter, from values and exact slopes: with `r = S - C` the foot
//! moves so that `(S_i . S_j + r . S_ij) a'_j = C' . S_i`. Pieces are halved until the middle of each is within the
//! accuracy on the surface; kinks of the way or of the surface stay kinks.
//!
//! On a surface that closes, an edge is put where the face is on its left: the two uses of a seam lie one period apart.

use super::chart::{Chart, Wrapped};
use super::course::{Follower, Spacing, on_polyline};
use super::loops::Step;
use super::shared::FaceEdges;
use super::track::Track;
use crate::nurbs::{NurbsCurve, NurbsCurve2, NurbsSurface};
use crate::part::Face;
use crate::trim::analytic::Analytic;
use crate::trim::carrier::FaceSurface;
use crate::trim::foot;
use osculate_geom::solve::symmetric;
use osculate_geom::{Axis, Domain, Interval, Point3, Surface, Uv, Vec3, uv};

/// Splines keep to the feet within this part of the face's size, mm on the surface.
const ACCURACY: f64 = 1e-8;

/// A point of an edge that is farther than this part of the face's size from the surface has no parameters on it.
const FAR: f64 = 1e-2;

/// Halvings of a piece at most, and nodes of an edge: a kink is chased no further.
const DEPTH: u32 = 9;
const NODES: usize = 4000;

/// Pieces of an edge before any halving.
const START: usize = 8;

/// Parameters within this part of a side of the rectangle lie on it.
const ON_SIDE: f64 = 1e-6;

/// A face's surface as it is written.
pub(crate) struct Ground<'a> {
    surface: &'a dyn Surface,
    analytic: Option<&'a Analytic>,
    face: &'a Face,
    chart: &'a Chart,
    domain: Domain,
    period: [Option<f64>; 2],
    /// The same rectangle in the parameters of the face.
    from: Domain,
}

/// A place on the way.
#[derive(Clone, Copy)]
struct Node {
    t: f64,
    at: Uv,
    /// Slopes before and behind it; `None` where the surface has none.
    slopes: [Option<[f64; 2]>; 2],
}

impl<'a> Ground<'a> {
    /// The face's own carrier.
    pub(crate) fn own(face: &'a Face, chart: &'a Chart) -> Self {
        let analytic = match &face.carrier {
            FaceSurface::Analytic(a) => Some(&**a),
            FaceSurface::Nurbs(_) | FaceSurface::Offset(_) => None,
        };
        let domain = face.domain();
        Self { surface: &face.carrier, analytic, face, chart, domain, period: chart.period, from: domain }
    }

    /// A spline that is the face's carrier over the rectangle `from` with other parameters.
    pub(crate) fn spline(spline: &'a NurbsSurface, from: Domain, face: &'a Face, chart: &'a Chart) -> Self {
        let domain = spline.domain();
        let period = [Axis::U, Axis::V].map(|axis| {
            let k = usize::from(axis == Axis::V);
            chart.closes[k].then(|| domain.get(axis).length())
        });
        Self { surface: spline, analytic: None, face, chart, domain, period, from }
    }

    fn side(&self, k: usize) -> Interval {
        if k == 0 { self.domain.u } else { self.domain.v }
    }

    /// Whether parameters beyond the rectangle mean something to a reader.
    const fn unlimited(&self) -> bool {
        self.analytic.is_some()
    }

    /// The parameters of the face as those of this surface, near enough to begin a search.
    fn guess(&self, at: Uv) -> Uv {
        let s = self.chart.shift(at);
        let map = |t: f64, k: usize, from: Interval, to: Interval| {
            let t = match self.chart.period[k] {
                Some(p) if self.chart.closes[k] => t - ((t - from.lo) / p).floor() * p,
                _ => t,
            };
            if from == to { t } else { to.lo + (t - from.lo) / from.length() * to.length() }
        };
        let (from, to) = (self.from, self.domain);
        uv(map(at.u - s.u, 0, from.u, to.u), map(at.v - s.v, 1, from.v, to.v))
    }

    /// The foot of a point near `hint`, unwrapped, and its distance, mm.
    fn foot(&self, p: &Point3, hint: Uv) -> (Uv, f64) {
        let (at, gap) = match self.analytic {
            Some(a) => {
                let at = a.locate(p, hint);
                (at, (a.point(at) - p).norm())
            }
            None => {
                let closes = self.chart.closes;
                foot::newton(&foot::Target { surface: self.surface, closes, point: *p }, hint)
            }
        };
        let near = |t: f64, h: f64, period: Option<f64>| period.map_or(t, |p| t + ((h - t) / p).round() * p);
        (uv(near(at.u, hint.u, self.period[0]), near(at.v, hint.v, self.period[1])), gap)
    }

    /// The same place within the rectangle, for surfaces that have values only there.
    fn inside(&self, at: Uv) -> Uv {
        let bring = |t: f64, k: usize| match self.period[k] {
            Some(p) if !self.unlimited() => t - ((t - self.side(k).lo) / p).floor() * p,
            _ => t,
        };
        uv(bring(at.u, 0), bring(at.v, 1))
    }

    /// How the foot moves where the way has this point and derivative; `None` where the surface has no tangent plane.
    fn slope(&self, at: Uv, (p, d): (Point3, Vec3)) -> Option<[f64; 2]> {
        let jet = self.surface.jet2(self.inside(at));
        let short = 1e-7 * self.chart.size_mm;
        if jet.du.norm() * self.domain.u.length() < short || jet.dv.norm() * self.domain.v.length() < short {
            return None;
        }
        let r = jet.point - p;
        let e = jet.du.norm_squared() + r.dot(&jet.duu);
        let f = jet.du.dot(&jet.dv) + r.dot(&jet.duv);
        let h = jet.dv.norm_squared() + r.dot(&jet.dvv);
        let g = [d.dot(&jet.du), d.dot(&jet.dv)];
        (e * h - f * f > 1e-10 * e * h).then(|| symmetric([e, f, h], g))
    }

    /// Length on the surface of a step between parameters, mm.
    fn length_mm(&self, at: Uv, other: Uv) -> f64 {
        self.surface.jet2(self.inside(at)).tangent(uv(at.u - other.u, at.v - other.v)).norm()
    }

    fn node(&self, track: &Track<'_>, t: f64, at: Uv) -> Node {
        let ends = [track.breaks[0], track.breaks[track.breaks.len() - 1]];
        // A hair to either side: at a knot the derivatives of the way differ.
        let hair = 1e-9 * (ends[1] - ends[0]);
        let slope = |s: f64| self.slope(at, (track.jet)(s.clamp(ends[0], ends[1])));
        Node { t, at, slopes: [slope(t - hair), slope(t + hair)] }
    }

    /// The places at the start of the search, from the middle outwards so that an end in a pole takes its neighbour's
    /// parameter.
    fn first(&self, track: &Track<'_>, points: &[Uv]) -> Option<Vec<Node>> {
        let breaks = track.apart();
        let per = START.div_ceil(breaks.len() - 1).max(2);
        let part =
            |w: &[f64], k: usize| if k == 0 { w[0] } else { w[0] + (w[1] - w[0]) * k as f64 / per as f64 };
        let mut ts: Vec<f64> = breaks.windows(2).flat_map(|w| (0..per).map(move |k| part(w, k))).collect();
        ts.push(breaks[breaks.len() - 1]);
        let middle = ts.len() / 2;
        let wrapped = Wrapped::new(self.face, self.chart);
        let spacing = Spacing { chord_mm: 1e-3 * self.chart.size_mm, length_mm: f64::INFINITY };
        let p = (track.jet)(ts[middle]).0;
        let s = Follower::new(&wrapped, points, spacing).place(&p, 0.5, 0.0);
        let (at, gap) = self.foot(&p, self.guess(on_polyline(points, s)));
        let far = FAR * self.chart.size_mm;
        if gap.is_nan() || gap > far {
            return None;
        }
        let mut nodes = vec![self.node(track, ts[middle], at); ts.len()];
        let step = |nodes: &mut Vec<Node>, from: usize, to: usize| -> bool {
            let (before, p) = (nodes[from], (track.jet)(ts[to]).0);
            let slope = before.slopes[usize::from(to > from)].unwrap_or([0.0, 0.0]);
            let h = ts[to] - before.t;
            let (mut at, gap) = self.foot(&p, uv(before.at.u + slope[0] * h, before.at.v + slope[1] * h));
            let plain = self.foot(&p, before.at);
            if plain.1 < 0.5 * gap {
                at = plain.0;
            }
            nodes[to] = self.node(track, ts[to], self.settled(at, before.at));
            gap.min(plain.1) <= far
        };
        let down = (0..middle).rev().all(|k| step(&mut nodes, k + 1, k));
        let up = (middle + 1..ts.len()).all(|k| step(&mut nodes, k - 1, k));
        (down && up).then_some(nodes)
    }

    /// In a pole the parameter that makes no difference is the neighbour's.
    fn settled(&self, at: Uv, neighbour: Uv) -> Uv {
        let jet = self.surface.jet2(self.inside(at));
        let short = 1e-7 * self.chart.size_mm;
        uv(
            if jet.du.norm() * self.domain.u.length() < short { neighbour.u } else { at.u },
            if jet.dv.norm() * self.domain.v.length() < short { neighbour.v } else { at.v },
        )
    }

    /// Nodes between which the cubic pieces keep the accuracy.
    fn refined(&self, track: &Track<'_>, nodes: Vec<Node>) -> Vec<Node> {
        let accuracy_mm = ACCURACY * self.chart.size_mm;
        let mut out: Vec<Node> = vec![nodes[0]];
        for node in &nodes[1..] {
            let mut pending = vec![(*node, 0_u32)];
            while let Some((right, depth)) = pending.pop() {
                let left = out[out.len() - 1];
                let t = 0.5 * (left.t + right.t);
                let [_, b, c, _] = bezier(&left, &right);
                let on_piece = |k: usize| {
                    let ends = [left.at, right.at].map(|p| if k == 0 { p.u } else { p.v });
                    (ends[0] + 3.0 * (b[k] + c[k]) + ends[1]) / 8.0
                };
                let guess = uv(on_piece(0), on_piece(1));
                let (at, _) = self.foot(&(track.jet)(t).0, guess);
                if self.length_mm(at, guess) > accuracy_mm
                    && depth < DEPTH
                    && out.len() + pending.len() < NODES
                {
                    pending.push((right, depth + 1));
                    pending.push((self.node(track, t, self.settled(at, guess)), depth + 1));
                } else {
                    out.push(right);
                }
            }
        }
        out
    }
}

/// Poles of the cubic between two nodes.
fn bezier(left: &Node, right: &Node) -> [[f64; 2]; 4] {
    let h = right.t - left.t;
    let (a, b) = ([left.at.u, left.at.v], [right.at.u, right.at.v]);
    let chord = [0, 1].map(|k| (b[k] - a[k]) / h);
    let out = left.slopes[1].unwrap_or(chord);
    let into = right.slopes[0].unwrap_or(chord);
    [a, [0, 1].map(|k| a[k] + out[k] * h / 3.0), [0, 1].map(|k| b[k] - into[k] * h / 3.0), b]
}

/// The edges of loops as they are walked, in the parameters of the surface with the parameter of their tracks; `None` for
/// an edge that leaves the surface or crosses the side along which it closes. The loops have the face on their left.
pub(crate) fn pcurves<'t>(
    ground: &Ground<'_>,
    of: &FaceEdges,
    walks: &[Vec<Step>],
    track: &dyn Fn(usize) -> Track<'t>,
) -> Vec<Vec<Option<NurbsCurve2>>> {
    let uses = |edge: usize| walks.iter().flatten().filter(|s| s.edge == edge).count();
    let mut out = Vec::with_capacity(walks.len());
    for walk in walks {
        let mut made: Vec<Option<NurbsCurve2>> = vec![None; walk.len()];
        // From a seam on, whose place is known, the others follow.
        let first = walk.iter().position(|s| uses(s.edge) == 2).unwrap_or(0);
        let mut last: Option<Uv> = None;
        for k in (0..walk.len()).map(|k| (first + k) % walk.len()) {
            let step = walk[k];
            let track = track(step.edge);
            let usable = track.breaks.len() > 1 && track.breaks.len() < NODES / 4;
            let nodes = if usable { ground.first(&track, &of.local[step.local].points) } else { None };
            let Some(nodes) = nodes else {
                last = None;
                continue;
            };
            let mut nodes = ground.refined(&track, nodes);
            let along = step.forward == track.forward;
            place(ground, &mut nodes, Use { along, seam: uses(step.edge) == 2, last });
            let end = &nodes[if along { nodes.len() - 1 } else { 0 }];
            last = end.slopes.iter().any(Option::is_some).then_some(end.at);
            made[k] = spline(ground, &nodes);
        }
        out.push(made);
    }
    out
}

/// How an edge is used.
struct Use {
    /// Whether its parameter grows along the loop.
    along: bool,
    /// Whether the same face is on both its sides.
    seam: bool,
    /// Where the loop has come from, unless that is a pole.
    last: Option<Uv>,
}

/// Shifts an edge by whole periods to where the face is on its left.
fn place(ground: &Ground<'_>, nodes: &mut [Node], of: Use) {
    let (n, middle) = (nodes.len(), nodes[nodes.len() / 2].at);
    for k in 0..2 {
        let Some(period) = ground.period[k] else { continue };
        let side = ground.side(k);
        let value = |p: Uv| if k == 0 { p.u } else { p.v };
        let other = |p: Uv| if k == 0 { p.v } else { p.u };
        let home = match ground.chart.closes[k] {
            true => -((value(middle) - side.lo) / period).floor() * period,
            false => ((side.at(0.5) - value(middle)) / period).round() * period,
        };
        let off = |p: Uv| {
            let turns = (value(p) - side.lo) / period;
            (turns - turns.round()).abs()
        };
        let on_side = ground.chart.closes[k] && nodes.iter().all(|m| off(m.at) <= ON_SIDE);
        let [from, to] =
            if of.along { [nodes[0].at, nodes[n - 1].at] } else { [nodes[n - 1].at, nodes[0].at] };
        // The inside lies towards greater values left of an edge that runs down in v (or up in u).
        let low = (other(to) < other(from)) == (k == 0);
        let across = (value(to) - value(from)).abs() * ground.chart.speed[k]
            < (other(to) - other(from)).abs() * ground.chart.speed[1 - k];
        let shift = if on_side {
            let at = if low { side.lo } else { side.lo + period };
            nodes.iter_mut().for_each(|m| set(&mut m.at, k, at));
            for s in nodes.iter_mut().flat_map(|m| m.slopes.iter_mut()).flatten() {
                s[k] = 0.0;
            }
            0.0
        } else if of.seam && across && ground.unlimited() && ground.chart.closes[k] {
            home + if low { 0.0 } else { period }
        } else if let Some(last) = of.last.filter(|_| ground.unlimited()) {
            ((value(last) - value(from)) / period).round() * period
        } else {
            home
        };
        for m in nodes.iter_mut() {
            let moved = value(m.at) + shift;
            set(&mut m.at, k, moved);
        }
    }
}

fn set(at: &mut Uv, k: usize, value: f64) {
    if k == 0 {
        at.u = value;
    } else {
        at.v = value;
    }
}

/// The spline through nodes; `None` where it crosses the seam of a surface that has values only within its rectangle.
fn spline(ground: &Ground<'_>, nodes: &[Node]) -> Option<NurbsCurve2> {
    let accuracy_mm = ACCURACY * ground.chart.size_mm;
    let (first, last) = (nodes[0], nodes[nodes.len() - 1]);
    let straight = nodes.iter().all(|m| {
        let f = (m.t - first.t) / (last.t - first.t);
        let on = uv(first.at.u + f * (last.at.u - first.at.u), first.at.v + f * (last.at.v - first.at.v));
        ground.length_mm(m.at, on) <= accuracy_mm
    });
    let mut knots = vec![first.t; if straight { 2 } else { 4 }];
    let mut poles = vec![[first.at.u, first.at.v]];
    if straight {
        knots.extend([last.t; 2]);
        poles.push([last.at.u, last.at.v]);
    } else {
        for (k, w) in nodes.windows(2).enumerate() {
            let end = k + 2 == nodes.len();
            let [_, b, c, d] = bezier(&w[0], &w[1]);
            poles.extend([b, c]);
            let smooth = !end && {
                let next = bezier(&nodes[k + 1], &nodes[k + 2]);
                let ratio = (nodes[k + 2].t - w[1].t) / (w[1].t - w[0].t);
                let off = [0, 1].map(|j| (next[1][j] - d[j]) - (d[j] - c[j]) * ratio);
                let speed = ground.speed();
                (off[0] * speed[0]).hypot(off[1] * speed[1]) <= accuracy_mm
            };
            if !smooth {
                poles.push(d);
            }
            knots.extend(std::iter::repeat_n(w[1].t, if end { 4 } else { 2 + usize::from(!smooth) }));
        }
    }
    if !ground.unlimited() {
        for p in &mut poles {
            for (k, x) in p.iter_mut().enumerate() {
                let i = ground.side(k);
                let hair = ON_SIDE * i.length();
                // Where it does not close, the feet have stopped at the side, and a cubic may only swing over.
                if ground.period[k].is_some() && (*x < i.lo - hair || *x > i.hi + hair) {
                    return None;
                }
                *x = x.clamp(i.lo, i.hi);
            }
        }
    }
    let poles = poles.into_iter().map(|p| p.into()).collect();
    NurbsCurve::new(if straight { 1 } else { 3 }, knots, poles, None).ok()
}

impl Ground<'_> {
    /// Mean length of the derivatives, mm.
    fn speed(&self) -> [f64; 2] {
        [0, 1].map(|k| self.chart.speed[k] * self.chart.side(k).length() / self.side(k).length())
    }
}
