//! The tool's motion near a contact as polynomials, and its deepest reach found with them.
//!
//! One strip asks for the pose of the tool some hundred times within a few strip widths of the contact. Each pose costs
//! a jet of the surface and a frame of the line; over so short a way tip and axis are polynomials to rounding. The
//! way is cut into pieces, each fitted at Chebyshev nodes the first time that it is asked for and compared with the
//! motion itself at its ends. A piece that does not agree (a knot of the surface lies in it, the line ends in it)
//! is answered by the motion itself.

use crate::cutter::{Cutter, Line};
use crate::pose::Pose;
use crate::sweep::{Moving, Reach, State, SweptMotion, reach_from, state};
use osculate_geom::{Point3, Unit3, Vec3};
use std::cell::{Cell, RefCell};
use std::sync::LazyLock;

/// Coefficients of a piece: degree 7.
const TERMS: usize = 8;
/// Pieces to each side of the one around the contact.
const SIDE: i64 = 4;
/// Tip and axis, three coordinates each.
const PARTS: usize = 6;

/// Coefficients of the Lagrange polynomials of the Chebyshev nodes in powers of x on [-1, 1].
static POWERS: LazyLock<[[f64; TERMS]; TERMS]> = LazyLock::new(|| {
    let nodes = nodes();
    let mut out = [[0.0; TERMS]; TERMS];
    for (j, row) in out.iter_mut().enumerate() {
        row[0] = 1.0;
        let others = nodes.iter().enumerate().filter(|(k, _)| *k != j);
        for (degree, (_, x)) in others.enumerate() {
            // Times (z - x) / (x_j - x).
            let scale = 1.0 / (nodes[j] - x);
            for k in (0..=degree + 1).rev() {
                let lower = if k > 0 { row[k - 1] } else { 0.0 };
                row[k] = (lower - x * row[k]) * scale;
            }
        }
    }
    out
});

fn nodes() -> [f64; TERMS] {
    std::array::from_fn(|j| (std::f64::consts::PI * (j as f64 + 0.5) / TERMS as f64).cos())
}

/// One piece of the way.
// Kept in a fixed array: a box would allocate for every strip.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Copy)]
enum Piece {
    Unknown,
    /// The motion itself answers.
    Direct,
    /// Tip less `origin`, and axis, in powers of the piece's own parameter.
    Fitted {
        origin: Point3,
        terms: [[f64; PARTS]; TERMS],
    },
}

/// A motion with its neighbourhood of `t0` fitted piece by piece.
pub(super) struct LocalMotion<'a, M> {
    motion: &'a M,
    t0: f64,
    /// Half the length of a piece in the motion's parameter.
    half: f64,
    /// Largest disagreement accepted: mm for the tip, rad for the axis times the cutter's size.
    tolerance_mm: f64,
    arm_mm: f64,
    pieces: RefCell<[Piece; 2 * SIDE as usize + 1]>,
    error_mm: Cell<f64>,
}

impl<'a, M: SweptMotion> LocalMotion<'a, M> {
    /// Pieces of length `2 half` in the motion's parameter, the first around `t0`. `arm_mm` is the lever of the axis.
    pub(super) fn new(motion: &'a M, t0: f64, half: f64, [arm_mm, tolerance_mm]: [f64; 2]) -> Self {
        let pieces = RefCell::new([Piece::Unknown; 2 * SIDE as usize + 1]);
        Self { motion, t0, half, tolerance_mm, arm_mm, pieces, error_mm: Cell::new(0.0) }
    }

    /// Largest disagreement between the pieces used and the motion.
    pub(super) const fn error_mm(&self) -> f64 {
        self.error_mm.get()
    }

    fn fit(&self, centre: f64) -> Piece {
        let Some(middle) = self.motion.at(centre) else { return Piece::Direct };
        let origin = middle.pose.tip;
        let mut terms = [[0.0; PARTS]; TERMS];
        for (x, powers) in nodes().iter().zip(POWERS.iter()) {
            let Some(m) = self.motion.at(centre + x * self.half) else { return Piece::Direct };
            let (w, a) = (m.pose.tip - origin, m.pose.axis);
            for (term, power) in terms.iter_mut().zip(powers) {
                for (c, value) in term.iter_mut().zip([w.x, w.y, w.z, a.x, a.y, a.z]) {
                    *c += power * value;
                }
            }
        }
        let piece = Piece::Fitted { origin, terms };
        let mut worst = 0.0f64;
        for x in [-1.0, 1.0] {
            let (Some(m), Some(p)) = (self.motion.at(centre + x * self.half), self.evaluate(&piece, x))
            else {
                return Piece::Direct;
            };
            let tip = (m.pose.tip - p.pose.tip).amax();
            let axis = (m.pose.axis.into_inner() - p.pose.axis.into_inner()).amax();
            worst = worst.max(tip + axis * self.arm_mm);
        }
        if worst <= self.tolerance_mm {
            self.error_mm.set(self.error_mm.get().max(worst));
            piece
        } else {
            Piece::Direct
        }
    }

    fn evaluate(&self, piece: &Piece, x: f64) -> Option<Moving> {
        let Piece::Fitted { origin, terms } = piece else { return None };
        let (mut p, mut d) = ([0.0; PARTS], [0.0; PARTS]);
        for term in terms.iter().rev() {
            for k in 0..PARTS {
                d[k] = d[k] * x + p[k];
                p[k] = p[k] * x + term[k];
            }
        }
        let rate = 1.0 / self.half;
        let axis = Unit3::new_unchecked(Vec3::new(p[3], p[4], p[5]));
        Some(Moving {
            pose: Pose { tip: origin + Vec3::new(p[0], p[1], p[2]), axis },
            tip_rate: Vec3::new(d[0], d[1], d[2]) * rate,
            turn: axis.cross(&Vec3::new(d[3], d[4], d[5])) * rate,
        })
    }
}

impl<M: SweptMotion> SweptMotion for LocalMotion<'_, M> {
    fn at(&self, t: f64) -> Option<Moving> {
        let cell = ((t - self.t0) / (2.0 * self.half)).round();
        if cell.is_nan() || cell.abs() > SIDE as f64 {
            return self.motion.at(t);
        }
        let centre = self.t0 + cell * 2.0 * self.half;
        let slot = (cell as i64 + SIDE) as usize;
        let mut pieces = self.pieces.borrow_mut();
        if let Piece::Unknown = pieces[slot] {
            pieces[slot] = self.fit(centre);
        }
        match &pieces[slot] {
            Piece::Fitted { .. } => self.evaluate(&pieces[slot], (t - centre) / self.half),
            _ => self.motion.at(t),
        }
    }
}

/// Where the tool was deepest at the place before: the instant, and how fast the entry's rate grows there.
#[derive(Clone, Copy)]
pub(super) struct Near {
    pub t: f64,
    /// Second derivative of the entry by the motion's parameter; None before the first answer.
    pub bend: Option<f64>,
}

/// How the deepest instant is looked for.
#[derive(Clone, Copy)]
pub(super) struct Pace {
    /// Longest step, in the motion's parameter.
    pub step: f64,
    /// How far above the minimum the entry may be left, mm.
    pub settled_mm: f64,
}

/// Secant steps towards the deepest instant; more happen only where the cutter's outline has an edge there.
const MAX_SECANTS: u32 = 8;

/// The deepest entry near `near`, by secants on its rate, or by [`reach_from`] where they do not settle.
pub(super) fn deepest(
    cutter: &Cutter,
    line: &Line,
    motion: &impl SweptMotion,
    near: Near,
    pace: Pace,
) -> Option<(Reach, Near)> {
    let found = if cutter.is_end_mill() && cutter.corner_mm() == 0.0 {
        on_rim(cutter, line, motion, near, pace)
    } else {
        by_secants(cutter, line, motion, near, pace)
    };
    found.or_else(|| {
        let reach = reach_from(cutter, line, motion, near.t, pace.step)?;
        Some((reach, Near { t: reach.t, bend: None }))
    })
}

fn by_secants(
    cutter: &Cutter,
    line: &Line,
    motion: &impl SweptMotion,
    near: Near,
    Pace { step, settled_mm: settled }: Pace,
) -> Option<(Reach, Near)> {
    let hit = |t: f64| match state(cutter, line, motion, t) {
        State::Hit { s, rate, .. } => Some((s, rate)),
        _ => None,
    };
    // Half the square of the rate over the bend is how far the entry lies above its minimum.
    let mut bend = near.bend;
    let mut t = near.t;
    let (mut s, mut rate) = hit(t)?;
    for _ in 0..MAX_SECANTS {
        if let Some(b) = bend
            && 0.5 * rate * rate <= settled * b
        {
            return Some((Reach { at_mm: s, t }, Near { t, bend }));
        }
        let move_by = match bend {
            Some(b) => (-rate / b).clamp(-step, step),
            None => -0.1 * step * rate.signum(),
        };
        if move_by == 0.0 {
            return None;
        }
        let (s_new, rate_new) = hit(t + move_by)?;
        let b = (rate_new - rate) / move_by;
        if b.is_nan() || b <= 0.0 {
            return None;
        }
        bend = Some(b);
        (t, s, rate) = (t + move_by, s_new, rate_new);
    }
    None
}

/// The instant at which a line passes through the sharp rim of the bottom, where that is the deepest.
fn on_rim(
    cutter: &Cutter,
    line: &Line,
    motion: &impl SweptMotion,
    near: Near,
    Pace { step, settled_mm: settled }: Pace,
) -> Option<(Reach, Near)> {
    // How far outside the rim the line meets the plane of the bottom, and where.
    let outside = |t: f64| -> Option<(f64, f64)> {
        let pose = motion.at(t)?.pose;
        let along = line.direction.dot(&pose.axis);
        if along <= 0.0 {
            return None;
        }
        let s = (pose.tip - line.origin).dot(&pose.axis) / along;
        Some(((line.point(s) - pose.tip).norm() - cutter.radius_mm(), s))
    };
    let mut slope = near.bend;
    let mut t = near.t;
    let (mut f, mut s) = outside(t)?;
    for _ in 0..MAX_SECANTS {
        if slope.is_some() && f.abs() <= settled {
            break;
        }
        let move_by = slope.map_or(0.1 * step, |k| (-f / k).clamp(-step, step));
        if move_by == 0.0 {
            break;
        }
        let (f_new, s_new) = outside(t + move_by)?;
        if f_new == f {
            break;
        }
        slope = Some((f_new - f) / move_by);
        (t, f, s) = (t + move_by, f_new, s_new);
    }
    if f.abs() > 8.0 * settled {
        return None;
    }
    // Only where the entry has its minimum: on the far side of the rim it would be a maximum.
    let d = 1e-6 * step;
    let falls = state(cutter, line, motion, t - d).rate() <= 0.0;
    let rises = state(cutter, line, motion, t + d).rate() >= 0.0;
    (falls && rises).then_some((Reach { at_mm: s, t }, Near { t, bend: slope }))
}
