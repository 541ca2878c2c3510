//! Strips of many postures at one place, quickly and nearly: the surface around it tabulated once.
//!
//! Feed line and cross line of a contact are geodesics through one point, whatever the feed. A [`Chart`] follows geodesics
//! from there in equally spaced directions and keeps point, normal and their derivatives along the way at equal distances.
//! Lines in directions between are interpolated over six neighbours, places between nodes by Hermite's cubics. A strip on a
//! chart then costs no evaluation of the surface.
//!
//! *Error.* [`Chart::error_mm`] is the larger of the deviation found midway between nodes of some rays, and of what rays
//! deviate by from those interpolated from their other neighbours, an eighth of it: half the angle between
//! them makes it less; the normal's counts times the chart's radius. Heights are off by about as much at most, the width by that over twice
//! the tolerance, relative. Where it is too large, nodes and rays are doubled, rays twice. Outside the surface's rectangle the chart goes on
//! by its Taylor polynomial; strips end at the rectangle. For a final figure take [`super::exact`].

mod heel;
mod posture;
mod walk;

pub use posture::{ChartError, Nearly, Within};

use crate::contact::Lean;
use crate::cutter::{Cutter, Line};
use osculate_geom::geodesic::GeodesicState;
use osculate_geom::{
    Darboux, Degenerate, Domain, Forms, Jet2, Point3, Relative, Surface, Taylor, Unit3, Uv, Vec3, uv,
};
use std::cell::RefCell;
use std::f64::consts::TAU;
use std::rc::Rc;

/// Directions, and nodes on each; how many there may be in a second and a third attempt.
const RAYS: usize = 36;
const NODES: usize = 16;
const MOST: [[usize; 2]; 2] = [[2 * RAYS, 2 * NODES], [4 * RAYS, 2 * NODES]];
/// Every so manieth ray is looked at midway between nodes.
const CHECKED: usize = 6;
/// Point, normal, parameters and the derivatives of the first two along the ray.
const PARTS: usize = 14;
/// Rays that are kept: feed and both sides of several postures.
const KEPT: usize = 8;
/// Neighbours of a direction that are interpolated, and places before it.
const NEIGHBOURS: usize = 6;
const BEFORE: usize = 2;
/// What half the angle between rays makes of the error of interpolation between them; its order, 6, promises less.
const FINER: f64 = 1.0 / 8.0;
/// Most turn of the normal from node to node, rad, by the curvature at the place.
const TURN: f64 = 0.25;
/// Order of the continuation outside the rectangle.
const BEYOND: usize = 4;

/// A surface around a place.
pub struct Chart<'a> {
    /// Forms of the surface at the place.
    pub forms: Forms,
    surface: &'a dyn Surface,
    /// Count of rays, and of nodes on each.
    size: [usize; 2],
    /// Largest curvature with which the part is hollow anywhere on the chart, 1/mm.
    hollow: f64,
    centre: Point3,
    at: Uv,
    domain: Domain,
    /// +1 where (S_u, S_v, n) is right-handed.
    side: f64,
    /// As far as it is tabulated, and as far as it is good.
    radius: f64,
    reach: f64,
    /// Whether all of it lies in the surface's rectangle.
    whole: bool,
    error: f64,
    /// By ray and node; the place itself, which all rays share, first.
    table: Vec<[f64; PARTS]>,
    /// The last rays made, and frames further along the feed.
    rays: RefCell<[Option<KeptRay>; KEPT]>,
    trails: RefCell<[Option<heel::KeptTrail>; KEPT]>,
}

/// The surface, beyond its rectangle by Taylor polynomials at the nearest place of it.
struct Extended<'a>(&'a dyn Surface);

impl Surface for Extended<'_> {
    fn domain(&self) -> Domain {
        self.0.domain()
    }
    fn jet2(&self, at: Uv) -> Jet2 {
        let domain = self.0.domain();
        if domain.contains(at) {
            return self.0.jet2(at);
        }
        self.0.taylor(domain.bring(at), BEYOND).jet2_at(at)
    }
    fn taylor(&self, at: Uv, order: usize) -> Taylor {
        self.0.taylor(at, order)
    }
}

impl<'a> Chart<'a> {
    /// The chart to `radius_mm`, or as far as its error is at most `tolerance_mm`; with more nodes and rays where that is
    /// less, tabulated anew to 0.4 of the radius, three times at most, where it still is less than a third.
    ///
    /// # Errors
    /// [`Degenerate`] without a tangent plane at the place.
    pub fn new(
        surface: &'a dyn Surface,
        at: Uv,
        radius_mm: f64,
        tolerance_mm: f64,
    ) -> Result<Self, Degenerate> {
        let p = surface.jet2(at).forms()?.principal();
        let bend = p.k_max.abs().max(p.k_min.abs());
        let mut radius = radius_mm.min(TURN * NODES as f64 / bend);
        let mut size = [RAYS, NODES];
        let (mut chart, mut finer) = Self::of_radius(surface, at, (radius, tolerance_mm), size)?;
        for most in MOST {
            let next = [0, 1].map(|k| if finer[k] { (2 * size[k]).min(most[k]) } else { size[k] });
            if next == size {
                break;
            }
            size = next;
            (chart, finer) = Self::of_radius(surface, at, (radius, tolerance_mm), size)?;
        }
        for _ in 0..3 {
            if 3.0 * chart.reach >= radius {
                break;
            }
            radius *= 0.4;
            chart = Self::of_radius(surface, at, (radius, tolerance_mm), size)?.0;
        }
        Ok(chart)
    }

    /// Largest deviation found, mm.
    #[must_use]
    pub const fn error_mm(&self) -> f64 {
        self.error
    }

    /// Whether the usual size was too coarse.
    const fn is_wavy(&self) -> bool {
        self.size[0] > RAYS || self.size[1] > NODES
    }

    /// How far the chart reaches, mm.
    #[must_use]
    pub const fn radius_mm(&self) -> f64 {
        self.reach
    }

    /// The chart of a size, and whether more rays and more nodes are wanted.
    fn of_radius(
        surface: &'a dyn Surface,
        at: Uv,
        (radius, tolerance_mm): (f64, f64),
        [rays, nodes]: [usize; 2],
    ) -> Result<(Self, [bool; 2]), Degenerate> {
        let domain = surface.domain();
        let extended = Extended(surface);
        let jet = surface.jet2(at);
        let forms = jet.forms()?;
        let side = jet.side.sign();
        let [e1, e2] = [forms.frame[0].into_inner(), forms.frame[1].into_inner() * side];
        let step = radius / nodes as f64;
        let mut table = vec![[0.0; PARTS]; rays * (nodes + 1)];
        let mut halfway: Vec<(usize, usize, [f64; PARTS])> = Vec::with_capacity(rays / CHECKED * nodes);
        let (mut whole, mut lost, mut hollow) = (true, false, 0.0f64);
        for ray in 0..rays {
            let (s, c) = (TAU * ray as f64 / rays as f64).sin_cos();
            let mut state = GeodesicState::start(surface, at, &(e1 * c + e2 * s))?;
            for node in 0..=nodes {
                let jet_here = extended.jet2(state.at);
                match parts(&jet, &jet_here, &forms, state) {
                    Ok((values, k_min)) => {
                        table[ray * (nodes + 1) + node] = values;
                        hollow = hollow.max(-k_min);
                    }
                    Err(_) => lost = true,
                }
                whole &= domain.contains(state.at);
                if node == nodes {
                    break;
                }
                let next = if ray % CHECKED == 0 {
                    state.step(&extended, 0.5 * step).and_then(|half| {
                        let there = extended.jet2(half.at);
                        halfway.push((ray, node, parts(&jet, &there, &forms, half)?.0));
                        half.step(&extended, 0.5 * step)
                    })
                } else {
                    state.step(&extended, step)
                };
                // A geodesic that meets a pole goes no further, and the error says so.
                match next {
                    Ok(next) => state = next,
                    Err(_) => lost = true,
                }
            }
        }
        let mut chart = Self {
            forms,
            surface,
            size: [rays, nodes],
            hollow,
            centre: jet.point,
            at,
            domain,
            side,
            radius,
            reach: radius,
            whole,
            error: 0.0,
            table,
            rays: RefCell::new([const { None }; KEPT]),
            trails: RefCell::new([const { None }; KEPT]),
        };
        let along = if lost { vec![f64::INFINITY; nodes] } else { chart.errors_along(&halfway) };
        let between = chart.errors_between();
        let finer = [&between, &along].map(|errors| errors.iter().any(|e| *e > tolerance_mm));
        let error = |k: usize| along[k].max(between[k]);
        let good = (0..nodes).find(|k| error(*k) > tolerance_mm).unwrap_or(nodes);
        chart.reach = step * good as f64;
        chart.error = (0..good).map(error).fold(0.0, f64::max);
        Ok((chart, finer))
    }

    /// What the normal and the place are off by, `way` mm from the centre; infinite where that is no number.
    fn off(got: &[f64; DERIVATIVES], want: &[f64; PARTS], way: f64) -> f64 {
        let off = |k: usize| (got[k] - want[k]).powi(2);
        let height = (off(0) + off(1) + off(2)).sqrt() + way * (off(3) + off(4) + off(5)).sqrt();
        if height.is_finite() { height } else { f64::INFINITY }
    }

    /// Deviations midway between nodes, by node.
    fn errors_along(&self, halfway: &[(usize, usize, [f64; PARTS])]) -> Vec<f64> {
        let [rays, nodes] = self.size;
        let mut errors = vec![0.0f64; nodes];
        for (ray, node, want) in halfway {
            let (s, c) = (TAU * *ray as f64 / rays as f64).sin_cos();
            let got = self.ray_of([c, s]).values((*node as f64 + 0.5) / nodes as f64);
            let way = self.radius * (node + 1) as f64 / nodes as f64;
            errors[*node] = errors[*node].max(Self::off(&got, want, way));
        }
        errors
    }

    /// Deviations of every second ray from its interpolation between the others, by node, less what half their angle makes.
    fn errors_between(&self) -> Vec<f64> {
        let [rays, nodes] = self.size;
        let weights = lagrange(0.5);
        let mut errors = vec![0.0f64; nodes];
        for ray in (0..rays).step_by(2) {
            for (node, error) in errors.iter_mut().enumerate() {
                let mut got = [0.0; DERIVATIVES];
                for (k, weight) in weights.iter().enumerate() {
                    let other = (ray + rays + 2 * k - 2 * BEFORE - 1) % rays;
                    let from = &self.table[other * (nodes + 1) + node + 1];
                    got.iter_mut().zip(from).for_each(|(g, f)| *g += weight * f);
                }
                let way = self.radius * (node + 1) as f64 / nodes as f64;
                let want = &self.table[ray * (nodes + 1) + node + 1];
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
    fn ray(&self, direction: [f64; 2]) -> Rc<Ray> {
        let mut kept = self.rays.borrow_mut();
        if let Some(k) = kept.iter().position(|r| r.as_ref().is_some_and(|r| r.0 == direction)) {
            kept[..=k].rotate_right(1);
        } else {
            kept.rotate_right(1);
            kept[0] = Some((direction, Rc::new(self.ray_of(direction))));
        }
        kept[0].as_ref().map_or_else(|| Rc::new(self.ray_of(direction)), |r| Rc::clone(&r.1))
    }

    fn ray_of(&self, [c, s]: [f64; 2]) -> Ray {
        let [rays, count] = self.size;
        let mut nodes = vec![[0.0; PARTS]; 2 * count + 1];
        for back in [true, false] {
            let turn = if back { (-s).atan2(-c) } else { s.atan2(c) };
            let x = turn.rem_euclid(TAU) / TAU * rays as f64;
            let (low, share) = (x.floor(), x - x.floor());
            let weights = lagrange(share);
            for (k, weight) in weights.into_iter().enumerate() {
                let ray = (low as usize + rays + k - BEFORE) % rays;
                let from = &self.table[ray * (count + 1)..(ray + 1) * (count + 1)];
                for (node, values) in from.iter().enumerate().skip(usize::from(back)) {
                    let into = &mut nodes[if back { count - node } else { count + node }];
                    for (i, v) in into.iter_mut().zip(values) {
                        *i += weight * v;
                    }
                }
            }
        }
        for node in &mut nodes[..count] {
            // Behind the place the way runs against the ray.
            for v in &mut node[DERIVATIVES..] {
                *v = -*v;
            }
        }
        let step = self.radius / count as f64;
        for node in &mut nodes {
            for v in &mut node[DERIVATIVES..] {
                *v *= step;
            }
        }
        Ray { nodes }
    }

    fn line(&self, ray: &Ray, q: f64) -> Line {
        let v = ray.values(q / self.radius);
        let normal = self.forms.normal.into_inner() + Vec3::new(v[3], v[4], v[5]);
        Line { origin: self.centre + Vec3::new(v[0], v[1], v[2]), direction: Unit3::new_normalize(normal) }
    }

    fn inside(&self, ray: &Ray, q: f64) -> bool {
        self.whole || {
            let v = ray.values(q / self.radius);
            self.domain.contains(uv(self.at.u + v[6], self.at.v + v[7]))
        }
    }
}

/// A ray by its direction.
type KeptRay = ([f64; 2], Rc<Ray>);

/// Where the derivatives begin among the parts.
const DERIVATIVES: usize = 8;

/// The parts of a node, less those of the place, and the smaller principal curvature there.
fn parts(
    place: &Jet2,
    here: &Jet2,
    forms: &Forms,
    state: GeodesicState,
) -> Result<([f64; PARTS], f64), Degenerate> {
    let own = here.forms()?;
    let tangent = here.tangent(state.rate);
    // Weingarten: the normal turns with the frame.
    let frame = Darboux::with_forms(here, &own, &tangent, 0.0);
    let n_rate = frame.turn.cross(&own.normal);
    let (x, n) = (here.point - place.point, own.normal.into_inner() - forms.normal.into_inner());
    let (u, v) = (state.at.u - place.uv.u, state.at.v - place.uv.v);
    let d = frame.tangent;
    let parts = [x.x, x.y, x.z, n.x, n.y, n.z, u, v, d.x, d.y, d.z, n_rate.x, n_rate.y, n_rate.z];
    Ok((parts, own.principal().k_min))
}

/// Weights of equally spaced neighbours for a place `share` behind the one with `BEFORE` others before it.
fn lagrange(share: f64) -> [f64; NEIGHBOURS] {
    let x = share + BEFORE as f64;
    std::array::from_fn(|i| {
        let others = (0..NEIGHBOURS).filter(|j| *j != i);
        others.map(|j| (x - j as f64) / (i as f64 - j as f64)).product()
    })
}

/// A line through the chart's centre by nodes, the centre in the middle; derivatives are per step of nodes.
struct Ray {
    nodes: Vec<[f64; PARTS]>,
}

impl Ray {
    /// The piece at `x` (length over the chart's radius) and the place in it from 0 to 1.
    fn piece(&self, x: f64) -> (&[f64; PARTS], &[f64; PARTS], f64) {
        let last = self.nodes.len() - 1;
        let at = 0.5 * (x + 1.0) * last as f64;
        let k = (at.floor().max(0.0) as usize).min(last - 1);
        (&self.nodes[k], &self.nodes[k + 1], at - k as f64)
    }

    /// Point, normal and parameters, less those of the place; parameters by chords.
    fn values(&self, x: f64) -> [f64; DERIVATIVES] {
        let (a, b, t) = self.piece(x);
        let (u, tt) = (1.0 - t, t * t);
        let (h1, h2, h3) = (tt * (3.0 - 2.0 * t), t * u * u, -tt * u);
        let mut out = [0.0; DERIVATIVES];
        for k in 0..6 {
            let (da, db) = (a[DERIVATIVES + k], b[DERIVATIVES + k]);
            out[k] = a[k] + (b[k] - a[k]) * h1 + da * h2 + db * h3;
        }
        for k in 6..DERIVATIVES {
            out[k] = a[k] + (b[k] - a[k]) * t;
        }
        out
    }

    /// Point and normal with two derivatives of the one and one of the other, per step of nodes.
    fn moving(&self, x: f64) -> ([f64; 6], [f64; 6], [f64; 3]) {
        let (a, b, t) = self.piece(x);
        let (mut p, mut d, mut dd) = ([0.0; 6], [0.0; 6], [0.0; 3]);
        for k in 0..6 {
            let (da, db) = (a[DERIVATIVES + k], b[DERIVATIVES + k]);
            let rise = b[k] - a[k];
            // a + t (da + t (c2 + t c3)).
            let (c2, c3) = (3.0 * rise - 2.0 * da - db, da + db - 2.0 * rise);
            p[k] = a[k] + t * (da + t * (c2 + t * c3));
            d[k] = da + t * (2.0 * c2 + 3.0 * t * c3);
            if k < 3 {
                dd[k] = 2.0 * c2 + 6.0 * t * c3;
            }
        }
        (p, d, dd)
    }
}
