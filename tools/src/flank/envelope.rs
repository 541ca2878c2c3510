//! What a moving flank leaves: the distance of points to the envelope of a cutter whose axis follows an axis surface.
//!
//! `delta(P) = min over tau of D(P; axis(tau))`, D the signed distance to the cutter's side: for a cylinder the distance to the
//! axis less R, so that the envelope is the R-offset of the surface of axes. Positive: material is left; negative: gouge. The
//! minimum is where the cutter's normal through P sees no velocity (`g . v = 0`, the grazing curve), or an end of the motion.
//! Along a part's normal n the height left h solves `delta(P + h n) = 0`; both agree to first order in the angle between
//! the normals squared.
//!
//! The minimum is bracketed among stations evenly spread over the motion and settled on the derivative: a minimum
//! narrower than the spacing of stations, a small part of R, would not be seen; sweeps of a rigid cutter have none.

use crate::flank::axes::{AxisSurface, MovingAxis};
use crate::flank::cutter_side::CutterSide;
use osculate_geom::{Point3, Unit3, Vec3};

/// Stations per span of an axis surface, and the least over a motion.
const STATIONS_PER_SPAN: usize = 2;
const LEAST_STATIONS: usize = 48;
/// Most stations of a piece: a motion of more spans is scanned at every few of them.
const MOST_STATIONS: usize = 256;
/// Most steps on the derivative: bisection alone would need 50.
const MAX_STEPS: usize = 60;
/// Newton steps for the height along a normal.
const MAX_HEIGHT_STEPS: usize = 12;

/// The place of a motion that comes nearest to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Nearest {
    /// Signed distance of the point to the moving cutter's side, mm.
    pub distance_mm: f64,
    /// Index of the piece of the motion.
    pub piece: usize,
    /// The parameter of the axis surface.
    pub tau: f64,
    /// Outward unit normal of the cutter towards the point.
    pub normal: Vec3,
    /// Height on the axis from Q0 at which that normal meets the axis, mm.
    pub foot_mm: f64,
}

/// Axes at the stations, as arrays.
#[derive(Clone, Debug, Default)]
struct Stations {
    tau: Vec<f64>,
    base: [Vec<f64>; 3],
    direction: [Vec<f64>; 3],
    /// By how much the axis moves to the next station, near the rule, mm.
    step: Vec<f64>,
}

impl Stations {
    fn new(axes: &AxisSurface) -> Self {
        let count = (axes.spans() * STATIONS_PER_SPAN).clamp(LEAST_STATIONS, MOST_STATIONS);
        let mut s = Self::default();
        let mut before: Option<MovingAxis> = None;
        for k in 0..=count {
            let tau = axes.range().at(k as f64 / count as f64);
            let j = axes.jet(tau);
            s.tau.push(tau);
            for c in 0..3 {
                s.base[c].push(j.lower[c]);
                s.direction[c].push(j.direction[c]);
            }
            if let Some(b) = before {
                let top = |x: &MovingAxis| x.lower + x.direction * x.length;
                s.step.push((j.lower - b.lower).norm().max((top(&j) - top(&b)).norm()));
            }
            before = Some(j);
        }
        s.step.push(0.0);
        s
    }

    /// Distances of a point to the cutter at all stations.
    fn scan(&self, side: &CutterSide, p: &Point3, out: &mut Vec<f64>) {
        out.clear();
        let ([bx, by, bz], [dx, dy, dz]) = (&self.base, &self.direction);
        out.extend((0..self.tau.len()).map(|k| {
            let (x, y, z) = (p.x - bx[k], p.y - by[k], p.z - bz[k]);
            let along = x * dx[k] + y * dy[k] + z * dz[k];
            let (x, y, z) = (x - along * dx[k], y - along * dy[k], z - along * dz[k]);
            side.near((x * x + y * y + z * z).sqrt(), along).distance
        }));
    }
}

/// Distance and its rate at one parameter.
struct At {
    distance: f64,
    rate: f64,
}

fn at(axes: &AxisSurface, side: &CutterSide, p: &Point3, tau: f64) -> At {
    let j = axes.jet(tau);
    let w = p.coords - j.lower;
    let z = w.dot(&j.direction);
    let rho = (w - j.direction * z).norm();
    let near = side.near(rho, z);
    let z_rate = w.dot(&j.direction_rate()) - j.lower_rate.dot(&j.direction);
    // On the axis itself the distance has no derivative; its normal is undefined and any side will do.
    let rho_rate = if rho > 0.0 { -(w.dot(&j.lower_rate) + z * z_rate) / rho } else { 0.0 };
    At { distance: near.distance, rate: near.by_rho * rho_rate + near.by_z * z_rate }
}

/// The moving flank of a cutter: one or more pieces of motion.
///
/// ```
/// use osculate_geom::{Interval, Point3};
/// use osculate_tools::Cutter;
/// use osculate_tools::flank::axes::{AxisPoints, AxisSurface};
/// use osculate_tools::flank::cutter_side::CutterSide;
/// use osculate_tools::flank::envelope::{Envelope, Scratch};
/// // A cylinder of radius 8 moved along x: its side leaves a wall at y = 8.
/// let at = |k: f64| AxisPoints { lower: Point3::new(k, 0.0, 0.0), upper: Point3::new(k, 0.0, 50.0) };
/// let positions: Vec<AxisPoints> = (0..=10).map(|k| at(f64::from(k))).collect();
/// let pieces = [AxisSurface::along(Interval::new(0.0, 10.0), &positions)?];
/// let envelope = Envelope::new(CutterSide::of(&Cutter::cylinder(16.0, 60.0)?, -5.0), &pieces);
/// let mut scratch = Scratch::default();
/// assert!((envelope.distance_mm(&Point3::new(4.3, 10.0, 20.0), &mut scratch) - 2.0).abs() < 1e-9);
/// let nearest = envelope.nearest(&Point3::new(4.3, 10.0, 20.0), &mut scratch).ok_or("it has no pieces")?;
/// assert!((nearest.tau - 4.3).abs() < 1e-6 && (nearest.normal.y - 1.0).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Envelope<'a> {
    side: CutterSide,
    pieces: &'a [AxisSurface],
    stations: Vec<Stations>,
}

/// Memory for a scan, kept between points by the caller.
#[derive(Clone, Debug, Default)]
pub struct Scratch(Vec<f64>);

impl<'a> Envelope<'a> {
    /// The envelope of a cutter's side over pieces of motion, in any order.
    #[must_use]
    pub fn new(side: CutterSide, pieces: &'a [AxisSurface]) -> Self {
        Self { side, pieces, stations: pieces.iter().map(Stations::new).collect() }
    }

    /// The cutter's side.
    #[must_use]
    pub const fn side(&self) -> &CutterSide {
        &self.side
    }

    /// Where the motion comes nearest to a point; None without pieces.
    #[must_use]
    pub fn nearest(&self, p: &Point3, scratch: &mut Scratch) -> Option<Nearest> {
        let mut best: Option<(f64, usize, f64)> = None;
        self.visit(p, scratch, f64::NEG_INFINITY, |distance, piece, tau| {
            if best.is_none_or(|b| distance < b.0) {
                best = Some((distance, piece, tau));
            }
        });
        best.map(|b| self.place(p, b))
    }

    /// All places where the distance of the motion to a point has a minimum below `limit_mm`, in the order of the motion.
    pub fn contacts(&self, p: &Point3, limit_mm: f64, scratch: &mut Scratch) -> Vec<Nearest> {
        let mut found: Vec<(f64, usize, f64)> = Vec::new();
        self.visit(p, scratch, limit_mm, |distance, piece, tau| {
            // One that sits at a station is seen from both sides.
            let again =
                found.last().is_some_and(|f| f.1 == piece && (f.2 - tau).abs() <= f64::EPSILON * tau.abs());
            if distance < limit_mm && !again {
                found.push((distance, piece, tau));
            }
        });
        found.into_iter().map(|f| self.place(p, f)).collect()
    }

    /// Settles the minima that may be the least one or lie below a limit.
    fn visit(&self, p: &Point3, scratch: &mut Scratch, limit: f64, mut see: impl FnMut(f64, usize, f64)) {
        let mut least = f64::INFINITY;
        for (piece, (axes, stations)) in self.pieces.iter().zip(&self.stations).enumerate() {
            let f = &mut scratch.0;
            stations.scan(&self.side, p, f);
            least = f.iter().copied().fold(least, f64::min);
            for k in 0..f.len() {
                let (before, after) = (k.saturating_sub(1), (k + 1).min(f.len() - 1));
                let is_low = f[k] <= f[before] && f[k] <= f[after];
                // What the axis may come nearer between stations bounds what a low place can turn out to be.
                let reach = stations.step[before].max(stations.step[k]);
                if is_low && f[k] - reach <= least.max(limit) {
                    let bracket = [stations.tau[before], stations.tau[after]];
                    let (distance, tau) = self.settle(axes, p, bracket, stations.tau[k], f[k]);
                    least = least.min(distance);
                    see(distance, piece, tau);
                }
            }
        }
    }

    /// The cutter at a minimum.
    fn place(&self, p: &Point3, (distance_mm, piece, tau): (f64, usize, f64)) -> Nearest {
        let j = self.pieces[piece].jet(tau);
        let w = p.coords - j.lower;
        let z = w.dot(&j.direction);
        let radial = w - j.direction * z;
        let rho = radial.norm();
        let near = self.side.near(rho, z);
        let out = if rho > 0.0 { radial / rho } else { Vec3::zeros() };
        let foot_mm = if near.by_rho > 0.0 { z - rho * near.by_z / near.by_rho } else { z };
        Nearest { distance_mm, piece, tau, normal: out * near.by_rho + j.direction * near.by_z, foot_mm }
    }

    /// The minimum in a bracket of stations: a root of the rate, by secants kept inside the bracket.
    fn settle(
        &self,
        axes: &AxisSurface,
        p: &Point3,
        bracket: [f64; 2],
        middle: f64,
        seen: f64,
    ) -> (f64, f64) {
        let [mut a, mut b] = bracket;
        let rate = |tau: f64| at(axes, &self.side, p, tau);
        let first = rate(middle);
        let mut best = (seen, middle);
        if first.distance < best.0 {
            best.0 = first.distance;
        }
        // The end of the motion, or a station that happens to be the minimum.
        if (middle == a && first.rate >= 0.0) || (middle == b && first.rate <= 0.0) || first.rate == 0.0 {
            return best;
        }
        let other = if first.rate > 0.0 { a } else { b };
        let end = rate(other);
        if end.distance < best.0 {
            best = (end.distance, other);
        }
        let (mut fa, mut fb) = if first.rate > 0.0 { (end.rate, first.rate) } else { (first.rate, end.rate) };
        if first.rate > 0.0 {
            b = middle
        } else {
            a = middle
        }
        if fa > 0.0 || fb < 0.0 {
            // The rate has no change of sign: lowest at one of the ends, which both were seen.
            return best;
        }
        let tolerance = 1e-13 * self.side.radius_mm();
        let mut last = (middle, first.rate > 0.0);
        for _ in 0..MAX_STEPS {
            let secant = a - fa * (b - a) / (fb - fa);
            let tau = if secant > a && secant < b { secant } else { 0.5 * (a + b) };
            let now = rate(tau);
            if now.distance < best.0 {
                best = (now.distance, tau);
            }
            // What the distance still falls: the rate times a step like the last one.
            if now.rate.abs() * (tau - last.0).abs() < tolerance || tau == a || tau == b {
                break;
            }
            let rises = now.rate > 0.0;
            // Illinois: an end that stays twice loses half its weight.
            let halved = if rises == last.1 { 0.5 } else { 1.0 };
            if rises {
                (b, fb, fa) = (tau, now.rate, fa * halved);
            } else {
                (a, fa, fb) = (tau, now.rate, fb * halved);
            }
            last = (tau, rises);
        }
        best
    }

    /// Signed distance of a point to the envelope, mm; infinite without pieces.
    #[must_use]
    pub fn distance_mm(&self, p: &Point3, scratch: &mut Scratch) -> f64 {
        self.nearest(p, scratch).map_or(f64::INFINITY, |n| n.distance_mm)
    }

    /// Height of the material left above a point along the part's normal, mm: negative for a gouge. None where the normal
    /// does not meet the envelope near the point.
    #[must_use]
    pub fn height_mm(&self, p: &Point3, normal: &Unit3, scratch: &mut Scratch) -> Option<f64> {
        let tolerance = 1e-12 * self.side.radius_mm();
        let mut h = 0.0;
        for _ in 0..MAX_HEIGHT_STEPS {
            let n = self.nearest(&(p + normal.into_inner() * h), scratch)?;
            if n.distance_mm.abs() <= tolerance {
                return Some(h);
            }
            let slope = n.normal.dot(normal);
            // The cutter lies outside the part: its own normal points against the part's.
            if slope >= -0.1 {
                return None;
            }
            h -= n.distance_mm / slope;
        }
        Some(h)
    }
}
