//! The least lean at a place, by the way that the axis leans: what a set of directions some degrees apart cannot tell.
//!
//! The strip of a flat or toroidal end is widest where the end lies closest, and there the lean is a degree or a few. So
//! next to the normal the axes are told apart by bisection, not by bits.

use osculate_geom::{Unit3, Vec3, any_perpendicular};
use osculate_tools::reach::{Place, Reach};
use std::f64::consts::PI;

/// Ways to lean that are asked, four of them along the parameters: leans along passes often need be far less than beside them.
const WAYS: usize = 16;
const QUARTER: usize = WAYS / 4;
/// The angle between the parameters' ways counts as no less than this, rad.
const LEAST_BETWEEN_RAD: f64 = 0.1;
/// Leans up to here are asked, rad: three times the distance of directions of the set.
const MOST_RAD: f64 = 0.26;
/// The first lean that is asked where none is the least, quotient of those asked, and halvings between the last two.
const FIRST_RAD: f64 = 0.004;
const STEP: f64 = 1.6;
const HALVINGS: u32 = 7;

/// The least leans at a place.
pub(super) struct Rim {
    normal: Unit3,
    /// The first way, the direction a quarter of a turn on, and the angle between the parameters' ways, rad.
    x: Vec3,
    y: Vec3,
    between_rad: f64,
    /// By the way; infinite where no lean that was asked is possible.
    least_rad: [f64; WAYS],
}

/// Where an axis leans.
#[derive(Clone, Copy)]
pub(super) struct Spot {
    /// The ways next to it, and where it is between them.
    pub ways: [usize; 2],
    pub share: f64,
    /// How far it leans, rad.
    pub lean_rad: f64,
}

impl Rim {
    /// Asks the leans at a place with two tangents.
    pub fn of(reach: &Reach<'_>, place: &Place, tangents: [Vec3; 2], from_rad: f64) -> Self {
        let [du, dv] = tangents.map(|t| t - place.normal.into_inner() * place.normal.dot(&t));
        let x = Unit3::try_new(du, f64::MIN_POSITIVE).unwrap_or_else(|| any_perpendicular(&place.normal));
        let y = place.normal.cross(&x);
        // Whatever the sense of the second tangent, its line is met within half a turn.
        let turn = dv.dot(&y).atan2(dv.dot(&x)).rem_euclid(PI);
        let mut out = Self {
            normal: place.normal,
            x: x.into_inner(),
            y,
            between_rad: turn.clamp(LEAST_BETWEEN_RAD, PI - LEAST_BETWEEN_RAD),
            least_rad: [f64::INFINITY; WAYS],
        };
        for k in 0..WAYS {
            let clear = |lean: f64| reach.is_clear(place, &out.axis(k, lean));
            out.least_rad[k] = least(&clear, from_rad);
        }
        out
    }

    /// The axis that leans so far in one of the ways.
    pub fn axis(&self, way: usize, lean_rad: f64) -> Unit3 {
        let (half, k) = (way / (2 * QUARTER), way % (2 * QUARTER));
        let share = (k % QUARTER) as f64 / QUARTER as f64;
        let [from, to] = if k < QUARTER { [0.0, self.between_rad] } else { [self.between_rad, PI] };
        let (s, c) = (PI * half as f64 + from + (to - from) * share).sin_cos();
        let (sin, cos) = lean_rad.sin_cos();
        Unit3::new_normalize(self.normal.into_inner() * cos + (self.x * c + self.y * s) * sin)
    }

    /// Where an axis leans: between which ways, and how far; None where it leans further than was asked.
    pub fn spot(&self, axis: &Unit3) -> Option<Spot> {
        let (a, b) = (axis.dot(&self.x), axis.dot(&self.y));
        let lean_rad = a.hypot(b).atan2(axis.dot(&self.normal));
        if lean_rad > MOST_RAD {
            return None;
        }
        let turn = b.atan2(a).rem_euclid(2.0 * PI);
        let half = if turn < PI { 0 } else { 2 };
        let rest = turn - if half == 0 { 0.0 } else { PI };
        let (quarter, share) = if rest < self.between_rad {
            (half, rest / self.between_rad)
        } else {
            (half + 1, (rest - self.between_rad) / (PI - self.between_rad))
        };
        let x = share.min(1.0) * QUARTER as f64;
        // A whole number of ways, less than their count.
        let way = (quarter * QUARTER + x.floor() as usize) % WAYS;
        Some(Spot { ways: [way, (way + 1) % WAYS], share: x.fract(), lean_rad })
    }

    /// How much further an axis leans than it must, rad, as far as the ways next to it say: the least and the most.
    pub fn margin_rad(&self, spot: &Spot) -> [f64; 2] {
        let ends = spot.ways.map(|k| self.least_rad[k]);
        let least = if ends.iter().all(|e| e.is_finite()) { self.between(spot) } else { f64::INFINITY };
        [spot.lean_rad - least, spot.lean_rad - ends[0].min(ends[1])]
    }

    /// The least lean between two ways by the cubic through the four around, or the line through two where not all are there.
    fn between(&self, spot: &Spot) -> f64 {
        let [b, c] = spot.ways.map(|k| self.least_rad[k]);
        let [a, d] = [spot.ways[0] + WAYS - 1, spot.ways[1] + 1].map(|k| self.least_rad[k % WAYS]);
        let f = spot.share;
        let line = b + (c - b) * f;
        if !(a.is_finite() && d.is_finite()) {
            return line;
        }
        // Of the parabolas through the two and one neighbour the mean: the cubic of Lagrange.
        let bend = ((a - 2.0 * b + c) * (2.0 - f) + (b - 2.0 * c + d) * (1.0 + f)) / 3.0;
        line - 0.5 * f * (1.0 - f) * bend
    }

    /// Whether no lean that was asked is possible.
    pub fn is_empty(&self) -> bool {
        self.least_rad.iter().all(|l| l.is_infinite())
    }

    /// An axis for each way that has one, with so much more lean than it must have.
    pub fn axes(&self, more_rad: f64) -> impl Iterator<Item = (usize, Unit3)> + '_ {
        let found = self.least_rad.iter().enumerate().filter(|(_, l)| l.is_finite());
        found.map(move |(k, l)| (k, self.axis(k, (l + more_rad).min(MOST_RAD))))
    }

    /// The least lean in a way, rad; infinite where there is none.
    pub const fn least_rad(&self, way: usize) -> f64 {
        self.least_rad[way]
    }

    /// The ways that are asked.
    pub const fn ways() -> usize {
        WAYS
    }
}

/// The least lean from one on that is clear.
fn least(clear: &dyn Fn(f64) -> bool, from_rad: f64) -> f64 {
    if clear(from_rad) {
        return from_rad;
    }
    let (mut low, mut high) = (from_rad, from_rad.max(FIRST_RAD) * STEP);
    while !clear(high) {
        if high >= MOST_RAD {
            return f64::INFINITY;
        }
        (low, high) = (high, (high * STEP).min(MOST_RAD));
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if clear(middle) { high = middle } else { low = middle }
    }
    high
}
