//! Motions cut into pieces that turn little, and a quick bound on how near a piece comes to a point.
//!
//! Seen from the tool, a point passes on a path `y(t)`. While tip and axis move linearly its second
//! derivative is at most `w^2 rho + 2 w v + a rho` (w angular rate, a its derivative, v speed of the tip, rho
//! distance from the tip), so that over a piece, t from 0 to 1, the path stays within an eighth of that, its
//! sagitta, of the straight line with the same position and velocity at mid-piece. Along a straight line the
//! distance to a convex body is a convex function, which tangents bound from below.

use super::body::Body;
use super::target::Target;
use super::{JobError, Swept};
use crate::pose::Pose;
use crate::sweep::{LinearMotion, Moving, SweptMotion};
use osculate_geom::{Point3, Unit3, Vec3};

/// Largest sagitta of a piece, mm, compared with the size of a group of samples, from which a piece is
/// rejected with this much slack. Pieces that are not rejected are halved on, see [`Passes::Near`].
pub(super) const SAGITTA_MM: f64 = 5e-2;
/// Sagitta of pieces in which the deepest instant is searched, mm. It is no error as such, but turning
/// motions have more than one deepest instant (bottom, then rim): of two within one piece the lesser may be
/// found, too high by about this.
pub(super) const FINE_MM: f64 = 2e-5;

/// Pose and velocity at a parameter of a motion.
#[inline]
pub(super) fn moving(swept: &Swept, t: f64) -> Moving {
    if swept.from.axis == swept.to.axis {
        let tip_rate = swept.to.tip - swept.from.tip;
        let pose = Pose { tip: swept.from.tip + tip_rate * t, axis: swept.from.axis };
        return Moving { pose, tip_rate, turn: Vec3::zeros() };
    }
    LinearMotion { from: swept.from, to: swept.to }
        .at(t)
        .expect("a linear motion is defined at every parameter")
}

/// A stretch of one motion.
#[derive(Clone, Copy)]
pub(super) struct Piece {
    /// Index into the job's motions.
    pub motion: u32,
    /// Range of the motion's parameter.
    pub range: [f64; 2],
}

/// Bounds on the turning of a motion whose axis is interpolated linearly and renormalised: with h half the
/// angle between the axes and x = 2t - 1 the angle passed is `atan(x tan h)`.
#[derive(Clone, Copy)]
struct Turning {
    rate: f64,
    acceleration: f64,
}

impl Turning {
    /// Over the whole motion, per unit of its parameter. The angle's second derivative is with T = tan h
    /// `8 |x| T^3 / (1 + x^2 T^2)^2`, greatest at x = 1 or, where T is large, at x T = 1/sqrt(3).
    fn of(swept: &Swept) -> Self {
        let (a, b) = (swept.from.axis.into_inner(), swept.to.axis.into_inner());
        // tan of half the angle between unit vectors, without cancellation for small angles.
        let tan_half = (b - a).norm() / (b + a).norm();
        let square = tan_half * tan_half;
        Self { rate: 2.0 * tan_half, acceleration: (8.0 * tan_half * square).min(2.6 * square) }
    }

    /// Derivative of the rate by the motion's parameter, over the rate, where x = 2 t - 1; `rate` is 2 T.
    fn spin(rate: f64, x: f64) -> f64 {
        let square = 0.25 * rate * rate;
        -4.0 * x * square / (1.0 + x * x * square)
    }

    fn sagitta(self, speed: f64, rho: f64) -> f64 {
        (rho * (self.rate * self.rate + self.acceleration) + 2.0 * self.rate * speed) / 8.0
    }
}

/// Smallest |a + b| of two unit axes whose motion has a meaning: half a degree from opposite. Nearer, the
/// axis flips within a hundredth of the motion and the plane in which it does so is noise.
const MIN_AXIS_SUM: f64 = 0.01;

/// Most pieces: 24 bytes each, and the tree as much again.
const MAX_PIECES: usize = 1 << 28;
/// No motion goes farther than this: products of coordinates stay numbers.
const FAR_MM: f64 = 1e9;

/// Splits the motions; `reach_mm` is the largest distance of a point of tool or holder from the tip.
pub(super) fn pieces(motions: &[Swept], reach_mm: f64) -> Result<Vec<Piece>, JobError> {
    let mut out = Vec::with_capacity(motions.len());
    for (k, swept) in motions.iter().enumerate() {
        let too_many =
            JobError::TooMany { what: "motions, turning ones counted in pieces", limit: MAX_PIECES };
        let motion = u32::try_from(k).map_err(|_| too_many)?;
        let finite = |p: &Point3, a: &Unit3| p.iter().chain(a.iter()).all(|x| x.abs() <= FAR_MM);
        if !finite(&swept.from.tip, &swept.from.axis) || !finite(&swept.to.tip, &swept.to.axis) {
            return Err(JobError::NotFinite { motion: k, block: swept.block });
        }
        if (swept.from.axis.into_inner() + swept.to.axis.into_inner()).norm() < MIN_AXIS_SUM {
            return Err(JobError::Reversal { motion: k, block: swept.block });
        }
        let speed = (swept.to.tip - swept.from.tip).norm();
        // Speed, rate and acceleration shrink so that the sagitta falls with the square of the count.
        let count = (Turning::of(swept).sagitta(speed, reach_mm) / SAGITTA_MM).sqrt().ceil().max(1.0);
        if count + out.len() as f64 > MAX_PIECES as f64 {
            return Err(too_many);
        }
        let step = 1.0 / count;
        for i in 0..count as u32 {
            let lo = f64::from(i) * step;
            let hi = if f64::from(i + 1) == count { 1.0 } else { f64::from(i + 1) * step };
            out.push(Piece { motion, range: [lo, hi] });
        }
    }
    Ok(out)
}

impl Piece {
    /// Both halves, the earlier first.
    pub fn halves(&self) -> [Self; 2] {
        let [lo, hi] = self.range;
        let middle = 0.5 * (lo + hi);
        [Self { range: [lo, middle], ..*self }, Self { range: [middle, hi], ..*self }]
    }
}

/// A piece seen from its middle.
#[derive(Clone, Copy)]
pub(super) struct Approach {
    pub tip: Point3,
    pub axis: Vec3,
    /// Movement of the tip and turn of the axis over the piece, to first order at the middle.
    pub advance: Vec3,
    pub turn: Vec3,
    /// Change of the turn over the piece.
    pub spin: Vec3,
    turning: Turning,
    speed: f64,
}

/// What [`Approach::passes`] found.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Passes {
    /// Farther than the radius throughout.
    Clear,
    /// It may come near.
    Near {
        /// A distance that it comes to, up to the sagitta, mm.
        distance: f64,
        /// How far the piece strays from a straight motion, seen from the target, mm.
        sagitta: f64,
    },
}

impl Approach {
    pub fn new(swept: &Swept, piece: &Piece) -> Self {
        let [lo, hi] = piece.range;
        let share = hi - lo;
        let Moving { pose, tip_rate, turn } = moving(swept, 0.5 * (lo + hi));
        let Turning { rate, acceleration } = Turning::of(swept);
        let advance = tip_rate * share;
        let spin = if rate == 0.0 { 0.0 } else { share * Turning::spin(rate, lo + hi - 1.0) };
        Self {
            tip: pose.tip,
            axis: pose.axis.into_inner(),
            advance,
            turn: turn * share,
            spin: turn * share * spin,
            turning: Turning { rate: rate * share, acceleration: acceleration * share * share },
            speed: advance.norm(),
        }
    }

    /// Whether the moving body may come into the target, deeper than `ignored` mm, at some instant of the piece.
    pub fn passes(&self, body: &Body<'_>, target: &Target, ignored: f64) -> Passes {
        /// Tangents drawn before the answer is left open. Three settle nearly all.
        const TANGENTS: u32 = 8;
        let w = target.centre - self.tip;
        let u = -(self.advance + self.turn.cross(&w));
        let (sagitta, skew) = if self.turning.rate == 0.0 {
            (0.0, 0.0)
        } else {
            // The rest of the target turns with its centre.
            let sagitta = self.turning.sagitta(self.speed, w.norm() + self.speed + target.radius);
            (sagitta, 0.5 * self.turning.rate * target.radius)
        };
        // Slack for the rounding of coordinates.
        let need = sagitta + skew + 1e-12 * (1.0 + w.amax()) - ignored;
        let uu = u.norm_squared();
        let mut x = if uu > 0.0 { (-w.dot(&u) / uu).clamp(-0.5, 0.5) } else { 0.0 };
        let mut left: Option<Tangent> = None;
        let mut right: Option<Tangent> = None;
        let mut nearest = f64::INFINITY;
        for _ in 0..TANGENTS {
            let near = body.near(&(w + u * x), &self.axis);
            nearest = nearest.min(near.distance);
            let value = near.distance - target.fall(&near.gradient);
            if value <= need {
                break;
            }
            let tangent = Tangent { x, value, slope: near.gradient.dot(&u) };
            if tangent.slope == 0.0 {
                return Passes::Clear;
            }
            if tangent.slope > 0.0 {
                right = Some(tangent)
            } else {
                left = Some(tangent)
            }
            let lowest = match (left, right) {
                (Some(a), Some(b)) => {
                    // Where the tangents cross: b.value + b.slope (x - b.x) = a.value + a.slope (x - a.x).
                    let cross = (a.value - b.value + b.slope * b.x - a.slope * a.x) / (b.slope - a.slope);
                    cross.clamp(a.x.min(b.x), a.x.max(b.x))
                }
                (Some(_), None) => 0.5,
                _ => -0.5,
            };
            let at = |t: Option<Tangent>| t.map_or(f64::NEG_INFINITY, |t| t.at(lowest));
            if at(left).max(at(right)) > need {
                return Passes::Clear;
            }
            if lowest == x {
                break;
            }
            x = lowest;
        }
        Passes::Near { distance: nearest, sagitta }
    }
}

/// A tangent of a convex function.
#[derive(Clone, Copy)]
struct Tangent {
    x: f64,
    value: f64,
    slope: f64,
}

impl Tangent {
    fn at(self, x: f64) -> f64 {
        self.value + self.slope * (x - self.x)
    }
}
