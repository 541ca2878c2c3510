//! The parameter rectangle of a face as a map: which sides are one line in space, which are a point, how long
//! parameters are.

use crate::part::Face;
use crate::trim::carrier::FaceSurface;
use osculate_geom::{Axis, Box3, Domain, Interval, Jet2, Point3, Surface, Taylor, Uv, uv};
use std::f64::consts::TAU;
use std::sync::Arc;

/// What tessellation and export have to know of a parameter rectangle.
#[derive(Clone, Debug)]
pub(crate) struct Chart {
    pub(crate) domain: Domain,
    /// Sides at both ends of u (of v) are the same line.
    pub(crate) closes: [bool; 2],
    /// Period of a parameter of the carrier, where it has one; the rectangle may be narrower.
    pub(crate) period: [Option<f64>; 2],
    /// The side at an end of u (of v) is a point.
    pub(crate) pole: [[bool; 2]; 2],
    /// Mean length of the derivatives, mm.
    pub(crate) speed: [f64; 2],
    /// Diagonal of the box around the rectangle's image, mm.
    pub(crate) size_mm: f64,
}

/// Sides whose distance is below this fraction of the size are one line, and shorter ones are a point: files carry
/// seven or more digits.
const SAME_LINE: f64 = 1e-7;

/// Samples along a side.
const PROBES: usize = 17;

impl Chart {
    pub(crate) fn new(face: &Face) -> Self {
        let surface = &*face.surface;
        let domain = surface.domain();
        let fractions: Vec<f64> = (0..PROBES).map(|k| k as f64 / (PROBES - 1) as f64).collect();
        let side = |axis: Axis, end: f64| -> Vec<Point3> {
            let at = domain.get(axis).at(end);
            let other = domain.get(axis.other());
            fractions.iter().map(|f| surface.point(Uv::from_axis(axis, at, other.at(*f)))).collect()
        };
        let sides = [Axis::U, Axis::V].map(|axis| [side(axis, 0.0), side(axis, 1.0)]);
        let middle = fractions.iter().map(|f| surface.point(domain.at(*f, 0.5)));
        let points: Vec<Point3> = sides.iter().flatten().flatten().copied().chain(middle).collect();
        let size_mm = Box3::around(&points).diagonal_mm();
        let slack = SAME_LINE * size_mm;
        let pole =
            sides.each_ref().map(|ends| ends.each_ref().map(|s| Box3::around(s).diagonal_mm() <= slack));
        let mut speed = [0.0; 2];
        for f in [0.1, 0.3, 0.5, 0.7, 0.9] {
            for g in [0.1, 0.3, 0.5, 0.7, 0.9] {
                let jet = surface.jet2(domain.at(f, g));
                speed[0] += jet.du.norm() / 25.0;
                speed[1] += jet.dv.norm() / 25.0;
            }
        }
        let mut closes = [false; 2];
        let mut period = [None; 2];
        for (k, axis) in [Axis::U, Axis::V].into_iter().enumerate() {
            let same = sides[k][0].iter().zip(&sides[k][1]).all(|(p, q)| (p - q).norm() <= slack);
            // Two sides that are the same point are a closed meridian only where the lines between them are long.
            closes[k] = same && !pole[k][0];
            period[k] = if closes[k] {
                Some(domain.get(axis).length())
            } else {
                turns(&face.carrier, axis, domain, slack).then_some(TAU)
            };
        }
        Self { domain, closes, period, pole, speed, size_mm }
    }

    /// The interval of a parameter by number.
    pub(crate) const fn side(&self, k: usize) -> Interval {
        if k == 0 { self.domain.u } else { self.domain.v }
    }

    /// Length of a parameter difference, mm, by the mean speeds.
    pub(crate) fn length_mm(&self, a: Uv, b: Uv) -> f64 {
        ((a.u - b.u) * self.speed[0]).hypot((a.v - b.v) * self.speed[1])
    }

    /// The whole periods to take from parameters near `middle` to have them in the rectangle.
    pub(crate) fn shift(&self, middle: Uv) -> Uv {
        let of = |t: f64, k: usize| {
            let i = self.side(k);
            match self.period[k] {
                // A closing rectangle holds every value; a narrower one is met by the nearest turn.
                Some(p) if self.closes[k] => ((t - i.lo) / p).floor() * p,
                Some(p) => ((t - i.at(0.5)) / p).round() * p,
                None => 0.0,
            }
        };
        uv(of(middle.u, 0), of(middle.v, 1))
    }
}

/// Whether a parameter of a closed-form surface is an angle: a full turn leads to the same place.
fn turns(carrier: &FaceSurface, axis: Axis, domain: Domain, slack_mm: f64) -> bool {
    if carrier.nurbs().is_some() {
        return false;
    }
    [0.15, 0.5, 0.85].iter().all(|f| {
        let at = domain.at(*f, 1.0 - 0.7 * f);
        let round = match axis {
            Axis::U => uv(at.u + TAU, at.v),
            Axis::V => uv(at.u, at.v + TAU),
        };
        let half = match axis {
            Axis::U => uv(at.u + 0.5 * TAU, at.v),
            Axis::V => uv(at.u, at.v + 0.5 * TAU),
        };
        let p = carrier.point(at);
        (carrier.point(round) - p).norm() <= slack_mm && (carrier.point(half) - p).norm() > slack_mm
    })
}

/// A carrier that takes parameters of any turn where its rectangle closes: splines that close with a kink do not wrap
/// by themselves.
pub(crate) struct Wrapped {
    surface: Arc<dyn Surface>,
    domain: Domain,
    closes: [bool; 2],
}

impl Wrapped {
    pub(crate) fn new(face: &Face, chart: &Chart) -> Self {
        Self { surface: face.surface.carrier().clone(), domain: chart.domain, closes: chart.closes }
    }

    fn inside(&self, at: Uv) -> Uv {
        let bring = |t: f64, i: Interval, closes: bool| {
            if closes && (t < i.lo || t > i.hi) {
                t - ((t - i.lo) / i.length()).floor() * i.length()
            } else {
                t
            }
        };
        uv(bring(at.u, self.domain.u, self.closes[0]), bring(at.v, self.domain.v, self.closes[1]))
    }
}

impl Surface for Wrapped {
    fn domain(&self) -> Domain {
        self.domain
    }
    fn taylor(&self, at: Uv, order: usize) -> Taylor {
        self.surface.taylor(self.inside(at), order)
    }
    fn jet2(&self, at: Uv) -> Jet2 {
        self.surface.jet2(self.inside(at))
    }
    fn point(&self, at: Uv) -> Point3 {
        self.surface.point(self.inside(at))
    }
}
