//! Strips of many postures at one place, quickly and nearly: the surface around it tabulated once.
//!
//! Feed line and cross line of a contact are geodesics through one point, whatever the feed. A [`Chart`] keeps point, normal and
//! their derivatives along them at equal distances; places between nodes are Hermite's cubics, so that a strip on a
//! chart costs no evaluation of the surface. Where the surface is smooth enough a table of geodesics in equally spaced directions
//! is made at once, and lines between are interpolated over six neighbours. Over waves, and where neighbours leave the
//! surface's rectangle, each line is traced on the surface when it is first asked for.
//!
//! *Error.* [`Chart::error_mm`] is the larger of the deviation found midway between nodes of some lines, and of what lines of the
//! table deviate by from those interpolated from their other neighbours, an eighth of it: half the angle between
//! them makes it less; the normal's counts times the distance from the place. Heights are off by about as much at most, the width by
//! that over twice the tolerance, relative. Where it is too large, nodes and lines are doubled, then lines traced, with more nodes.
//! Nodes outside the surface's rectangle, on its Taylor polynomial, do not count; feed and strips end at the rectangle. For a final
//! figure take [`super::exact`].

mod asked;
mod heel;
mod posture;
mod ray;
#[cfg(test)]
mod tests;
mod walk;

pub use asked::{ChartError, Nearly, Within};

use crate::contact::Lean;
use crate::cutter::{Cutter, Line};
use osculate_geom::{Darboux, Degenerate, Forms, Point3, Relative, Surface, Unit3, Uv, Vec3};
use ray::{Node, Nodes, PARTS, Pace, Place, Ray, Way};
use std::cell::RefCell;
use std::f64::consts::TAU;
use std::rc::Rc;

/// Directions of the table, and nodes on each way that leaves the place; as many again in the second attempt.
const RAYS: usize = 36;
const NODES: usize = 16;
/// Lines over waves go further, as far as the tool's bottom may come over the strip again, with as many nodes.
const FURTHER: usize = 2;
/// Most nodes on a way that is traced.
const MOST_NODES: usize = 128 * FURTHER;
/// What a piece of most nodes may be off by, of the tolerance: where the part's curvature jumps at a knot, only the piece that has
/// it is off.
const AT_KNOTS: f64 = 8.0;
/// What a second attempt promises to make of errors between lines and along them.
const PROMISED: [f64; 2] = [1.0 / 8.0, 1.0 / 16.0];
/// Every so manieth way is looked at midway between nodes.
const CHECKED: usize = 6;
/// Lines that are kept: those of 72 directions of feed, whose cross lines are among them.
const KEPT: usize = 40;
const KEPT_TRAILS: usize = 8;
/// Cosine of the angle below which two directions are one: less than the width of an atom over a tool's radius.
const SAME: f64 = 1.0 - 1e-14;
/// Steps between two knots.
const OF_PITCH: f64 = 0.5;
/// Neighbours of a direction that are interpolated, and places before it.
const NEIGHBOURS: usize = 6;
const BEFORE: usize = 2;
/// What half the angle between rays makes of the error of interpolation between them; its order, 6, promises less.
const FINER: f64 = 1.0 / 8.0;
/// Most turn of the normal from node to node, rad, by the curvature at the place.
const TURN: f64 = 0.25;

/// A surface around a place.
pub struct Chart<'a> {
    /// Forms of the surface at the place.
    pub forms: Forms,
    place: Place<'a>,
    /// Count of rays of the table, none where lines are traced, and of nodes on each.
    size: [usize; 2],
    /// Largest curvature with which the part is hollow anywhere on the chart, 1/mm.
    hollow: f64,
    centre: Point3,
    /// +1 where (S_u, S_v, n) is right-handed.
    side: f64,
    /// As far as it is tabulated, and as far as it is good.
    radius: f64,
    reach: f64,
    error: f64,
    /// By ray and node; the place itself, which all rays share, first.
    table: Vec<Node>,
    /// The last lines made, and frames further along the feed.
    lines: RefCell<Vec<KeptLine>>,
    trails: RefCell<Vec<KeptTrail>>,
}

/// Errors by node, mm.
struct Errors {
    between: Vec<f64>,
    along: Vec<f64>,
}

fn greatest(errors: &[f64]) -> f64 {
    errors.iter().copied().fold(0.0, f64::max)
}

impl<'a> Chart<'a> {
    /// The chart to `radius_mm`, or as far as its error is at most `tolerance_mm` (some times as much where the part's curvature jumps);
    /// where lines are traced to twice the radius, made anew to 0.4 of it, three times at most, where less than a third is good.
    ///
    /// # Errors
    /// [`Degenerate`] without a tangent plane at the place.
    pub fn new(
        surface: &'a dyn Surface,
        at: Uv,
        radius_mm: f64,
        tolerance_mm: f64,
    ) -> Result<Self, Degenerate> {
        let place = Place::new(surface, at)?;
        let p = place.forms.principal();
        let bend = p.k_max.abs().max(p.k_min.abs());
        let mut chart = Self {
            forms: place.forms,
            size: [0; 2],
            hollow: (-p.k_min).max(0.0),
            centre: place.jet.point,
            side: place.jet.side.sign(),
            radius: radius_mm.min(TURN * NODES as f64 / bend),
            reach: 0.0,
            error: 0.0,
            table: Vec::new(),
            lines: RefCell::new(Vec::with_capacity(KEPT)),
            trails: RefCell::new(Vec::with_capacity(KEPT_TRAILS)),
            place,
        };
        if chart.tabulate(tolerance_mm)? {
            return Ok(chart);
        }
        chart.radius *= FURTHER as f64;
        for attempt in 0..4 {
            let good = chart.by_lines(tolerance_mm)?;
            if good || attempt == 3 || 3.0 * chart.reach >= chart.radius {
                break;
            }
            chart.radius *= 0.4;
        }
        Ok(chart)
    }

    /// Largest deviation found, mm.
    #[must_use]
    pub const fn error_mm(&self) -> f64 {
        self.error
    }

    /// Whether no table of lines was good enough, so that each is traced: the part has waves, a strip may end at one for one direction
    /// and not for its neighbour, and the tool may come over it at several instants.
    #[must_use]
    pub const fn is_traced(&self) -> bool {
        self.size[0] == 0
    }

    /// How far the chart reaches, mm.
    #[must_use]
    pub const fn radius_mm(&self) -> f64 {
        self.reach
    }

    /// Makes the table; false where it does not keep to the tolerance.
    fn tabulate(&mut self, tolerance_mm: f64) -> Result<bool, Degenerate> {
        let mut size = [RAYS, NODES];
        for _ in 0..2 {
            let Some(errors) = self.table_of(size)? else { return Ok(false) };
            let worst = [greatest(&errors.between), greatest(&errors.along)];
            if worst.iter().all(|e| *e <= tolerance_mm) {
                (self.reach, self.error) = (self.radius, worst[0].max(worst[1]));
                return Ok(true);
            }
            if (0..2).any(|k| worst[k] * PROMISED[k] > tolerance_mm) {
                return Ok(false);
            }
            size = [0, 1].map(|k| if worst[k] > tolerance_mm { 2 * size[k] } else { size[k] });
        }
        Ok(false)
    }

    /// The table of a size with its errors; None where a line ends.
    fn table_of(&mut self, [rays, nodes]: [usize; 2]) -> Result<Option<Errors>, Degenerate> {
        self.size = [rays, nodes];
        self.lines.get_mut().clear();
        self.table.clear();
        self.table.reserve(rays * (nodes + 1));
        let mut midway = Vec::with_capacity(rays.div_ceil(CHECKED));
        for ray in 0..rays {
            let midway_too = ray % CHECKED == 0;
            let way = self.way(direction(ray, rays), midway_too)?;
            if way.nodes.len() <= nodes {
                return Ok(None);
            }
            self.hollow = self.hollow.max(way.hollow_per_mm);
            self.table.extend(way.nodes);
            if midway_too {
                midway.push(way.midway);
            }
        }
        let mut along = vec![0.0f64; nodes];
        for (k, midway) in midway.iter().enumerate() {
            let ray = CHECKED * k;
            let line = Ray { line: Rc::new(self.interpolated(direction(ray, rays))), backwards: false };
            let own = &self.table[ray * (nodes + 1)..(ray + 1) * (nodes + 1)];
            self.see_midway(&line, own, midway, &mut along);
        }
        Ok(Some(Errors { between: self.errors_between(), along }))
    }

    /// Traces lines from now on, with as many nodes as some of them need; whether that is good all over.
    fn by_lines(&mut self, tolerance_mm: f64) -> Result<bool, Degenerate> {
        self.table = Vec::new();
        let mut nodes = NODES * FURTHER;
        loop {
            self.size = [0, nodes];
            self.lines.get_mut().clear();
            let step = self.radius / nodes as f64;
            let mut along = vec![0.0f64; nodes];
            for line in 0..RAYS / (2 * CHECKED) {
                let towards = direction(CHECKED * line, RAYS);
                let pitch = self.place.pitch_mm(towards, self.radius);
                let ahead = self.way(towards, true)?;
                let behind = self.way(towards.map(|x| -x), true)?;
                self.hollow = self.hollow.max(ahead.hollow_per_mm).max(behind.hollow_per_mm);
                let ways = [&behind.nodes[..], &ahead.nodes[..]];
                let made = Nodes::new(&self.place, ways, (self.radius, nodes), pitch);
                let made = Rc::new(made);
                for (way, backwards) in [(&ahead, false), (&behind, true)] {
                    let ray = Ray { line: Rc::clone(&made), backwards };
                    self.see_midway(&ray, &way.nodes, &way.midway, &mut along);
                    // A way that ends short limits the chart.
                    along[way.nodes.len() - 1..].fill(f64::INFINITY);
                }
                self.lines.get_mut().push((towards, made));
            }
            let most = if nodes < MOST_NODES { tolerance_mm } else { AT_KNOTS * tolerance_mm };
            let good = along.iter().position(|e| *e > most).unwrap_or(nodes);
            self.reach = step * good as f64;
            self.error = greatest(&along[..good]);
            if good == nodes || nodes >= MOST_NODES {
                return Ok(good == nodes);
            }
            nodes *= 2;
        }
    }

    fn way(&self, towards: [f64; 2], midway: bool) -> Result<Way, Degenerate> {
        let count = self.size[1];
        self.place.trace(towards, Pace { step_mm: self.radius / count as f64, count, midway })
    }

    /// Notes what a line is off by midway between its nodes, inside the rectangle.
    fn see_midway(&self, line: &Ray, nodes: &[Node], midway: &[Node], along: &mut [f64]) {
        let count = self.size[1] as f64;
        for (k, want) in midway.iter().enumerate() {
            if self.place.holds(&nodes[k]) && self.place.holds(want) {
                let got = line.values((k as f64 + 0.5) / count);
                along[k] = along[k].max(Self::off(&got, want, self.radius * (k + 1) as f64 / count));
            }
        }
    }

    /// What the normal and the place are off by, `way` mm from the centre; infinite where that is no number.
    fn off(got: &[f64; 6], want: &Node, way: f64) -> f64 {
        let off = |k: usize| (got[k] - want[k]).powi(2);
        let height = (off(0) + off(1) + off(2)).sqrt() + way * (off(3) + off(4) + off(5)).sqrt();
        if height.is_finite() { height } else { f64::INFINITY }
    }

    /// Deviations of every second ray from its interpolation between the others, by node, less what half their angle makes; inside
    /// the rectangle.
    fn errors_between(&self) -> Vec<f64> {
        let [rays, nodes] = self.size;
        let weights = lagrange(0.5);
        let mut errors = vec![0.0f64; nodes];
        for ray in (0..rays).step_by(2) {
            for (node, error) in errors.iter_mut().enumerate() {
                let want = &self.table[ray * (nodes + 1) + node + 1];
                if !self.place.holds(want) {
                    break;
                }
                let mut got = [0.0; 6];
                for (k, weight) in weights.iter().enumerate() {
                    let other = (ray + rays + 2 * k - 2 * BEFORE - 1) % rays;
                    let from = &self.table[other * (nodes + 1) + node + 1];
                    got.iter_mut().zip(from).for_each(|(g, f)| *g += weight * f);
                }
                let way = self.radius * (node + 1) as f64 / nodes as f64;
                *error = error.max(FINER * Self::off(&got, want, way));
            }
        }
        errors
    }

    /// Frame of the feed at an angle from S_u towards S_v.
    #[must_use]
    pub fn frame(&self, angle_rad: f64) -> Darboux {
        let (s, c) = angle_rad.sin_cos();
        let e2 = self.forms.frame[1].into_inner() * self.side;
        let tangent = Unit3::new_normalize(self.forms.frame[0].into_inner() * c + e2 * s);
        let left = Unit3::new_unchecked(self.forms.normal.cross(&tangent));
        Darboux { point: self.centre, tangent, left, normal: self.forms.normal, turn: Vec3::zeros() }
    }

    /// The relative form of a posture.
    #[must_use]
    pub fn relative(&self, cutter: &Cutter, angle_rad: f64, lean: Lean) -> Relative {
        Relative::new(&self.forms, &lean.tool_curvature(cutter, &self.frame(angle_rad)))
    }

    /// The line through the place in a direction, (cos, sin) of its angle from S_u towards S_v; the last ones are kept.
    fn ray(&self, direction: [f64; 2]) -> Ray {
        let mut kept = self.lines.borrow_mut();
        let turn = |known: &[f64; 2]| known[0] * direction[0] + known[1] * direction[1];
        if let Some(k) = kept.iter().position(|line| turn(&line.0).abs() > SAME) {
            kept[..=k].rotate_right(1);
        } else {
            let made = if self.size[0] > 0 { self.interpolated(direction) } else { self.traced(direction) };
            kept.truncate(KEPT - 1);
            kept.insert(0, (direction, Rc::new(made)));
        }
        Ray { line: Rc::clone(&kept[0].1), backwards: turn(&kept[0].0) < 0.0 }
    }

    /// The line in a direction, traced on the surface.
    fn traced(&self, direction: [f64; 2]) -> Nodes {
        let pitch = self.place.pitch_mm(direction, self.radius);
        // Without a way there is the place itself.
        let only = || vec![[0.0; PARTS]];
        let [behind, ahead] = [-1.0, 1.0]
            .map(|sign| self.way(direction.map(|x| sign * x), false).map_or_else(|_| only(), |w| w.nodes));
        Nodes::new(&self.place, [&behind, &ahead], (self.radius, self.size[1]), pitch)
    }

    /// The line in a direction, between those of the table.
    fn interpolated(&self, [c, s]: [f64; 2]) -> Nodes {
        let [rays, count] = self.size;
        let way = |turn: f64| {
            let x = turn.rem_euclid(TAU) / TAU * rays as f64;
            let (low, share) = (x.floor(), x - x.floor());
            let mut nodes = vec![[0.0; PARTS]; count + 1];
            for (k, weight) in lagrange(share).into_iter().enumerate() {
                if weight == 0.0 {
                    continue;
                }
                let ray = (low as usize + rays + k - BEFORE) % rays;
                let from = &self.table[ray * (count + 1)..(ray + 1) * (count + 1)];
                for (into, values) in nodes.iter_mut().zip(from) {
                    into.iter_mut().zip(values).for_each(|(i, v)| *i += weight * v);
                }
            }
            nodes
        };
        let [behind, ahead] = [way((-s).atan2(-c)), way(s.atan2(c))];
        // What a table can follow has no waves to be looked for.
        Nodes::new(&self.place, [&behind, &ahead], (self.radius, count), f64::INFINITY)
    }

    fn line(&self, ray: &Ray, q: f64) -> Line {
        let v = ray.values(q / self.radius);
        let normal = self.forms.normal.into_inner() + Vec3::new(v[3], v[4], v[5]);
        Line { origin: self.centre + Vec3::new(v[0], v[1], v[2]), direction: Unit3::new_normalize(normal) }
    }
}

/// A line by its direction.
type KeptLine = ([f64; 2], Rc<Nodes>);

/// Frames along a direction, (cos, sin), with the distance between them and how many were asked for.
type KeptTrail = ([f64; 2], f64, usize, Rc<Vec<Darboux>>);

/// (cos, sin) of one of equally spaced directions.
fn direction(k: usize, of: usize) -> [f64; 2] {
    let (s, c) = (TAU * k as f64 / of as f64).sin_cos();
    [c, s]
}

/// Weights of equally spaced neighbours for a place `share` behind the one with `BEFORE` others before it.
fn lagrange(share: f64) -> [f64; NEIGHBOURS] {
    let x = share + BEFORE as f64;
    std::array::from_fn(|i| {
        let others = (0..NEIGHBOURS).filter(|j| *j != i);
        others.map(|j| (x - j as f64) / (i as f64 - j as f64)).product()
    })
}
