//! The level lines of a field as lines that passes run along.

use super::cells::place;
use super::field::Face;
use crate::plan::line::PassLine;
use crate::plan::march::Grid;
use osculate_geom::line::{LineError, SurfaceLine};
use osculate_geom::{Darboux, Interval, Point3, Uv, uv};

/// Steps up or down to the level where the straight way misses it, of the piece between two nodes.
const LED: f64 = 0.25;

/// A place on a level line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    /// Arc length along the line, uphill to the left, mm.
    pub s: f64,
    /// Parameters, running on past seams.
    pub at: Uv,
    pub point: Point3,
    /// Rate of the parameters by s.
    rate: Uv,
    /// Steepest ascent, parameters by mm, and the field's slope along it.
    pub uphill: Uv,
    pub slope_per_mm: f64,
}

/// One component of a level line: places joined by cubics and settled on the level.
#[derive(Clone)]
pub(super) struct Traced<'a> {
    pub face: Face<'a>,
    pub level: f64,
    pub nodes: Vec<Node>,
    pub closed: bool,
    pub reversed: bool,
}

/// All components of a level.
pub(super) fn trace<'a>(face: Face<'a>, grid: Grid<'_>, level: f64) -> Vec<Traced<'a>> {
    let mut out = Vec::new();
    for (chain, closed) in grid.lines(level, |_, _| true) {
        // Places at which the line cannot be settled part it.
        let mut run: Vec<Node> = Vec::new();
        let mut whole = true;
        for p in &chain {
            let at = place(&face, grid.count, p[0], p[1]);
            match node(&face, at, level) {
                Some(n) => {
                    let s = run.last().map_or(0.0, |l: &Node| l.s + (n.point - l.point).norm());
                    // Two crossings next to the same corner are one place.
                    if run.is_empty() || s > run[run.len() - 1].s {
                        run.push(Node { s, ..n });
                    }
                }
                None => {
                    whole = false;
                    keep(&mut out, face, level, std::mem::take(&mut run), false);
                }
            }
        }
        keep(&mut out, face, level, run, closed && whole);
    }
    out
}

fn node(face: &Face<'_>, at: Uv, level: f64) -> Option<Node> {
    let (_, jet, phi) = face.at(at)?;
    let (uphill, _) = Face::ascent(&jet, &phi).ok()?;
    // On the border the way uphill may lead out of the rectangle: then along the border.
    let at = [uphill, uv(1.0, 0.0), uv(0.0, 1.0)].iter().find_map(|way| face.settle(at, *way, level).ok())?;
    let (_, jet, phi) = face.at(at)?;
    let (uphill, slope_per_mm) = Face::ascent(&jet, &phi).ok()?;
    let (frame, rate, _) = face.frame(at, false).ok()?;
    Some(Node { s: 0.0, at, point: frame.point, rate, uphill, slope_per_mm })
}

fn keep<'a>(out: &mut Vec<Traced<'a>>, face: Face<'a>, level: f64, mut nodes: Vec<Node>, closed: bool) {
    if nodes.len() < 2 {
        return;
    }
    let (a, b) = (&nodes[0], &nodes[1]);
    let along = jet_tangent(&face, a.at, a.rate).dot(&(b.point - a.point));
    if along < 0.0 {
        let length = nodes[nodes.len() - 1].s;
        nodes.reverse();
        for n in &mut nodes {
            n.s = length - n.s;
        }
    }
    out.push(Traced { face, level, nodes, closed, reversed: false });
}

fn jet_tangent(face: &Face<'_>, at: Uv, rate: Uv) -> osculate_geom::Vec3 {
    face.at(at).map_or_else(osculate_geom::Vec3::zeros, |(_, jet, _)| jet.tangent(rate))
}

impl<'a> Traced<'a> {
    pub fn length(&self) -> f64 {
        self.nodes.last().map_or(0.0, |n| n.s)
    }

    /// The piece around `t`: its nodes, and how far into it.
    fn piece(&self, t: f64) -> (&Node, &Node, f64) {
        let k = self.nodes.partition_point(|n| n.s <= t).clamp(1, self.nodes.len() - 1);
        let (a, b) = (&self.nodes[k - 1], &self.nodes[k]);
        (a, b, (t - a.s) / (b.s - a.s))
    }

    /// The node nearest to `t`.
    pub fn near(&self, t: f64) -> &Node {
        let (a, b, f) = self.piece(t);
        if f < 0.5 { a } else { b }
    }

    /// The parameters about `t`, off the level by the sag of a piece.
    pub fn between(&self, t: f64) -> Uv {
        let (a, b, f) = self.piece(t);
        uv(a.at.u + (b.at.u - a.at.u) * f, a.at.v + (b.at.v - a.at.v) * f)
    }

    /// The line begun at another of its nodes, for a closed one.
    pub fn begun_at(mut self, k: usize) -> Self {
        if !self.closed || k == 0 || k + 1 >= self.nodes.len() {
            return self;
        }
        let (length, last) = (self.length(), self.nodes.len() - 1);
        let (end, first) = (self.nodes[last].at, self.nodes[0].at);
        let turn = uv(end.u - first.u, end.v - first.v);
        let start = self.nodes[k].s;
        let mut nodes: Vec<Node> = self.nodes[k..last].to_vec();
        nodes.extend(self.nodes[..=k].iter().map(|n| Node {
            s: n.s + length,
            at: uv(n.at.u + turn.u, n.at.v + turn.v),
            ..*n
        }));
        for n in &mut nodes {
            n.s -= start;
        }
        self.nodes = nodes;
        self
    }

    fn place(&self, t: f64) -> Result<Uv, LineError> {
        let length = self.length();
        let t = if self.closed { t.rem_euclid(length) } else { t.clamp(0.0, length) };
        let (a, b, f) = self.piece(t);
        if f <= 0.0 {
            return Ok(a.at);
        }
        if f >= 1.0 {
            return Ok(b.at);
        }
        let h = b.s - a.s;
        let (f2, g) = (f * f, 1.0 - f);
        let cubic = |p: f64, q: f64, dp: f64, dq: f64| {
            p * (1.0 + 2.0 * f) * g * g + q * f2 * (3.0 - 2.0 * f) + (dp * f * g * g - dq * f2 * g) * h
        };
        let guess = uv(cubic(a.at.u, b.at.u, a.rate.u, b.rate.u), cubic(a.at.v, b.at.v, a.rate.v, b.rate.v));
        // Along the border settling may step outside: the cubic itself is near enough there.
        let guess = self.face.rectangle.clamped(guess);
        let (_, jet, phi) = self.face.at(guess).ok_or(LineError::Outside { at: guess })?;
        let (uphill, _) = Face::ascent(&jet, &phi)?;
        let settled = self.face.settle(guess, uphill, self.level).or_else(|why| match why {
            LineError::Outside { .. } => Err(why),
            _ => self.face.led(guess, self.level, LED * h),
        });
        match settled {
            Err(LineError::Outside { .. }) => Ok(guess),
            other => other,
        }
    }
}

impl SurfaceLine for Traced<'_> {
    fn frame(&self, t: f64) -> Result<(Darboux, f64), LineError> {
        let frame = self.face.frame(self.place(t)?, self.reversed)?.0;
        Ok((frame, if self.reversed { -1.0 } else { 1.0 }))
    }
}

impl PassLine for Traced<'_> {
    fn uv(&self, t: f64) -> Uv {
        let at = self.place(t).unwrap_or_else(|_| self.near(t).at);
        self.face.rectangle.bring(at).unwrap_or(at)
    }
    fn rate(&self, t: f64) -> Uv {
        self.near(t).rate
    }
    fn reversed(&self) -> bool {
        self.reversed
    }
    fn range(&self) -> Interval {
        Interval { lo: 0.0, hi: self.length(), periodic: self.closed }
    }
}
