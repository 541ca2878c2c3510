//! The setting with three tangencies: to the rule at M2 and to both directrices on either side of it. [D98, 1.3 and 2]
//!
//! With `x' = sin(gamma) z + cos(gamma) x` and the generator `g = cos(gamma) z - sin(gamma) x`, a point has the coordinates
//! `(a, b, c) = (x', y, g) . (p - M2)`, `M2 = P0 + h0 z`, in which the tool stands still and touches the origin. Its signed
//! distance f gives four equations for u0, u1, h0 and gamma:
//!
//! ```text
//! f(C_i(u_i)) = 0,   grad f . C_i'(u_i) = 0,   i = 0, 1
//! ```
//!
//! For a cylinder they say |w_perp| = R and w_perp . C_i' = 0 of `theory`; the paper's seven equations (11) to (17) drop a
//! component of the directrices. To leading order in the twist alpha, k_i the projected curvature of directrix i,
//!
//! ```text
//! t_i = 1 / (1 + sqrt(1 + k_i R)),   gamma = alpha R (t0 + t1) / (2 h_p),   h0 = h_p t0 / (t0 + t1)
//! ```
//!
//! from which Newton's method starts; its error is of second order in alpha. The derivative of the root by u follows from
//! the same linear system.

use super::axis::{AxisJet, AxisLine};
use super::rule::Rule;
use super::ruled::RuledStrip;
use super::tool::SideTool;
use super::touch::{PlaceError, Touch};
use nalgebra::{Matrix4, Vector4};
use osculate_geom::{Unit3, Vec3};

/// A root of the four equations.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ThreeTangent {
    /// Parameters of the contacts on the directrices: u0 and u1.
    pub contacts: [f64; 2],
    /// h0: from P0 to the contact M2 on the rule, mm.
    pub height_mm: f64,
    /// gamma: from the rule to the generator that touches it, rad.
    pub turn_rad: f64,
    /// Their derivatives by u, in the same order.
    pub rates: [f64; 4],
    /// The axis, its point in the reference section, with its derivative by u.
    pub axis: AxisJet,
    /// Greatest of the residuals, mm.
    pub residual_mm: f64,
    /// Newton steps.
    pub iterations: u32,
}

/// Newton steps of one attempt at most; a good start takes four to six.
const MAX_STEPS: u32 = 30;
/// Halvings of a step that does not lessen the residual.
const MAX_HALVINGS: u32 = 10;
/// Steps of the continuation in R at most.
const MAX_STAGES: u32 = 60;
/// A residual below this fraction of the radius is rounding: 50 units in the last place of sums of four terms.
const CONVERGED: f64 = 50.0 * f64::EPSILON;
/// Below this twist, rad, the four equations say nothing about h0 (their derivative by h0 falls with its square) and the
/// leading order is as exact as doubles.
const FLAT_RAD: f64 = 1e-7;

/// Unknowns: u0, u1, h0, gamma.
type Unknowns = Vector4<f64>;

struct Equations<'s> {
    strip: &'s RuledStrip<'s>,
    rule: &'s Rule,
    tool: SideTool,
}

struct Linearised {
    value: Vector4<f64>,
    by_unknowns: Matrix4<f64>,
    /// By u, the unknowns held.
    by_u: Vector4<f64>,
    /// Second derivatives of the distance along the directrices: positive at a contact from outside.
    bends: [f64; 2],
}

impl Equations<'_> {
    /// Equations in the order f0, f1, f0', f1', the latter two divided by the speed of the directrix.
    fn at(&self, q: &Unknowns) -> Linearised {
        let frame = &self.rule.frame;
        let rate = &self.rule.frame_rate;
        let (sin, cos) = q[3].sin_cos();
        let along = [frame.z * sin + frame.x * cos, frame.y, frame.z * cos - frame.x * sin];
        let turning = [rate.z * sin + rate.x * cos, rate.y, rate.z * cos - rate.x * sin];
        let m2 = self.rule.ends[0].point + frame.z * q[2];
        let m2_rate = self.rule.ends[0].first + rate.z * q[2];
        let mut out = Linearised {
            value: Vector4::zeros(),
            by_unknowns: Matrix4::zeros(),
            by_u: Vector4::zeros(),
            bends: [0.0; 2],
        };
        for i in 0..2 {
            let j = self.strip.directrix(i, q[i]);
            let w = j.point - m2;
            let local = |v: &Vec3| Vec3::new(along[0].dot(v), along[1].dot(v), along[2].dot(v));
            let turned = |v: &Vec3| Vec3::new(turning[0].dot(v), turning[1].dot(v), turning[2].dot(v));
            let (p, d, dd) = (local(&w), local(&j.first), local(&j.second));
            let (value, gradient, hessian) = self.tool.at_contact([p.x, p.y, p.z]);
            let scale = 1.0 / j.first.norm();
            let hd = hessian * d;
            // Change of a place and of a tangent with h0, gamma and u.
            let by_h = -Vec3::new(sin, 0.0, cos);
            let by_gamma = |v: &Vec3| Vec3::new(v.z, 0.0, -v.x);
            let by_u = turned(&w) - local(&m2_rate);
            out.value[i] = value;
            out.value[2 + i] = gradient.dot(&d) * scale;
            out.bends[i] = hd.dot(&d) + gradient.dot(&dd);
            out.by_unknowns[(i, i)] = gradient.dot(&d);
            out.by_unknowns[(2 + i, i)] = out.bends[i] * scale;
            out.by_unknowns[(i, 2)] = gradient.dot(&by_h);
            out.by_unknowns[(2 + i, 2)] = hd.dot(&by_h) * scale;
            out.by_unknowns[(i, 3)] = gradient.dot(&by_gamma(&p));
            out.by_unknowns[(2 + i, 3)] = (hd.dot(&by_gamma(&p)) + gradient.dot(&by_gamma(&d))) * scale;
            out.by_u[i] = gradient.dot(&by_u);
            out.by_u[2 + i] = (hd.dot(&by_u) + gradient.dot(&turned(&j.first))) * scale;
        }
        out
    }

    /// Residuals in comparable units: lengths by the radius, angles as they are.
    fn size(&self, value: &Vector4<f64>) -> f64 {
        let r = 1.0 / self.tool.radius_mm();
        Vector4::new(value[0] * r, value[1] * r, value[2], value[3]).amax()
    }

    /// Newton's method, each step halved until the residual falls.
    fn solve(&self, start: Unknowns) -> Result<(Unknowns, Linearised, u32), (f64, u32)> {
        let mut q = start;
        let mut now = self.at(&q);
        let mut size = self.size(&now.value);
        for iteration in 0..MAX_STEPS {
            if size <= CONVERGED {
                return Ok((q, now, iteration));
            }
            let Some(step) = now.by_unknowns.lu().solve(&now.value) else { return Err((size, iteration)) };
            let mut share = 1.0;
            let mut better = None;
            for _ in 0..MAX_HALVINGS {
                let next = q - step * share;
                let there = self.at(&next);
                let size = self.size(&there.value);
                if size.is_finite() {
                    better = Some((next, there, size));
                    if size < self.size(&now.value) {
                        break;
                    }
                }
                share *= 0.5;
            }
            match better {
                Some((next, there, new_size)) if new_size < size => (q, now, size) = (next, there, new_size),
                // Rounding stops the fall a little above the limit on badly scaled directrices.
                _ if size <= 1e4 * CONVERGED => return Ok((q, now, iteration)),
                _ => return Err((size, iteration)),
            }
        }
        if size <= 1e4 * CONVERGED { Ok((q, now, MAX_STEPS)) } else { Err((size, MAX_STEPS)) }
    }

    /// The leading order in the twist.
    fn start(&self, twist: f64) -> Unknowns {
        let r = self.tool.radius_mm();
        let h = self.rule.length_mm;
        // Concave ends that the tool just fits: the root is bounded below, so that the start stays finite.
        let t = [0, 1].map(|i| {
            let fit = (1.0 + self.rule.projected_curvature_per_mm(i) * r).max(0.01);
            1.0 / (1.0 + fit.sqrt())
        });
        // For straight ends this is 2 R tan(alpha/4) / h_p of D98's figure 7, which grows right for large twists.
        let gamma = 2.0 * r * (0.25 * twist).tan() * (t[0] + t[1]) / h;
        let height = h * t[0] / (t[0] + t[1]);
        let mut q = Unknowns::new(self.rule.u, self.rule.u, height, gamma.clamp(-0.8, 0.8));
        // The contacts for this pose, directrix by directrix.
        for _ in 0..4 {
            let now = self.at(&q);
            for i in 0..2 {
                let bend = now.by_unknowns[(2 + i, i)];
                let speed = self.strip.directrix(i, q[i]).first.norm();
                let step = now.value[2 + i] / bend;
                if bend > 0.0 && step.is_finite() && (step * speed).abs() < h.max(r) {
                    q[i] -= step;
                }
            }
        }
        q
    }

    /// Whether a root is the setting of the paper: contacts from outside, on opposite sides of the rule, M2 on the rule.
    fn is_proper(&self, q: &Unknowns, there: &Linearised) -> bool {
        let opposite = (q[0] - self.rule.u) * (q[1] - self.rule.u) < 0.0;
        let on_rule = q[2] > 0.0 && q[2] < self.rule.length_mm;
        let outside = there.bends.iter().all(|b| *b > 0.0);
        opposite && on_rule && outside && q[3].abs() < std::f64::consts::FRAC_PI_2
    }
}

/// The setting at a rule.
///
/// Newton's method starts from the leading order, then from the opposite turn, then follows the root from a small radius
/// on. What is kept is a root with contacts from outside on opposite sides of the rule.
///
/// # Errors
/// [`PlaceError::Rule`], [`PlaceError::TooLarge`] and [`PlaceError::NoRoot`].
pub fn three_tangent(strip: &RuledStrip<'_>, u: f64, tool: SideTool) -> Result<ThreeTangent, PlaceError> {
    let rule = strip.rule(u)?;
    let equations = Equations { strip, rule: &rule, tool };
    let twist = rule.twist_rad();
    if twist.abs() < FLAT_RAD && tool.is_cylinder() {
        return Ok(flat(&equations, twist));
    }
    let mut worst = (f64::INFINITY, 0);
    for sign in [1.0, -1.0] {
        match equations.solve(equations.start(sign * twist)) {
            Ok((q, there, iterations)) if equations.is_proper(&q, &there) => {
                return finished(&equations, &q, &there, iterations);
            }
            Ok(_) => {}
            Err(failure) if failure.0 < worst.0 => worst = failure,
            Err(_) => {}
        }
    }
    follow(&equations, twist, worst)
}

/// Follows the root from a small radius to the tool's.
fn follow(e: &Equations<'_>, twist: f64, worst: (f64, u32)) -> Result<ThreeTangent, PlaceError> {
    let target = e.tool.radius_mm();
    let at_radius = |r: f64| Equations { strip: e.strip, rule: e.rule, tool: e.tool.with_radius(r) };
    let mut share = 0.1;
    let mut step = 0.1;
    let mut known: Option<(f64, Unknowns)> = None;
    let mut iterations = worst.1;
    for _ in 0..MAX_STAGES {
        let stage = at_radius(target * share);
        let start = known.map_or_else(|| stage.start(twist), |(_, q)| q);
        match stage.solve(start) {
            Ok((q, there, n)) if stage.is_proper(&q, &there) => {
                iterations += n;
                if share >= 1.0 {
                    return finished(&stage, &q, &there, iterations);
                }
                known = Some((share, q));
                share = (share + step).min(1.0);
                step *= 1.5;
            }
            _ => match known {
                Some((s, _)) => {
                    step = 0.25 * (share - s);
                    if step < 1e-6 {
                        break;
                    }
                    share = s + step;
                }
                None => {
                    share *= 0.25;
                    step = share;
                    if share < 1e-4 {
                        break;
                    }
                }
            },
        }
    }
    let largest_mm = e.rule.largest_fit_mm();
    if target >= largest_mm {
        return Err(PlaceError::TooLarge { u: e.rule.u, radius_mm: target, largest_mm });
    }
    Err(PlaceError::NoRoot {
        u: e.rule.u,
        residual_mm: worst.0 * target,
        iterations,
        reached_mm: known.map_or(0.0, |(s, _)| s * target),
    })
}

/// The leading order where the rule has no twist to speak of.
fn flat(e: &Equations<'_>, twist: f64) -> ThreeTangent {
    let q = e.start(twist);
    let there = e.at(&q);
    let [a, b] = e.rule.normals;
    let [da, db] = e.rule.normal_rates;
    let z = e.rule.frame.z;
    // d/du of the angle from N0 to N1 about z.
    let twist_rate = z.dot(&b.cross(&db)) - z.dot(&a.cross(&da));
    let share = q[2] / e.rule.length_mm;
    let per_twist = {
        let small = e.start(FLAT_RAD);
        small[3] / FLAT_RAD
    };
    let rates = [1.0, 1.0, share * e.rule.length_rate_mm, per_twist * twist_rate];
    made(e, &q, rates, e.size(&there.value), 0)
}

fn finished(
    e: &Equations<'_>,
    q: &Unknowns,
    there: &Linearised,
    iterations: u32,
) -> Result<ThreeTangent, PlaceError> {
    let Some(rates) = there.by_unknowns.lu().solve(&-there.by_u) else {
        return Err(PlaceError::NoRoot {
            u: e.rule.u,
            residual_mm: e.size(&there.value) * e.tool.radius_mm(),
            iterations,
            reached_mm: e.tool.radius_mm(),
        });
    };
    Ok(made(e, q, rates.into(), e.size(&there.value), iterations))
}

fn made(e: &Equations<'_>, q: &Unknowns, rates: [f64; 4], size: f64, iterations: u32) -> ThreeTangent {
    let pose = ContactPose { height_mm: q[2], turn_rad: q[3] };
    ThreeTangent {
        contacts: [q[0], q[1]],
        height_mm: q[2],
        turn_rad: q[3],
        rates,
        axis: pose.axis(e.rule, &e.tool, rates[2], rates[3]),
        residual_mm: size * e.tool.radius_mm(),
        iterations,
    }
}

/// The tool with its reference section touching the rule: M2 at the height, the generator turned from the rule.
pub(super) struct ContactPose {
    pub height_mm: f64,
    pub turn_rad: f64,
}

impl ContactPose {
    /// The axis with its derivative by u, height and turn moving at these rates.
    pub fn axis(&self, rule: &Rule, tool: &SideTool, height_rate_mm: f64, turn_rate: f64) -> AxisJet {
        let (frame, rate) = (&rule.frame, &rule.frame_rate);
        let (sin, cos) = self.turn_rad.sin_cos();
        let side = frame.z * sin + frame.x * cos;
        let along = frame.z * cos - frame.x * sin;
        let along_rate = rate.z * cos - rate.x * sin - side * turn_rate;
        let (ts, tc) = tool.taper_rad().sin_cos();
        // From the contact to the axis: R (cos tau y - sin tau g); the axis leans by tau from the generator to y.
        let to_axis = (frame.y * tc - along * ts) * tool.radius_mm();
        let to_axis_rate = (rate.y * tc - along_rate * ts) * tool.radius_mm();
        let m2 = rule.ends[0].point + frame.z * self.height_mm;
        let m2_rate = rule.ends[0].first + rate.z * self.height_mm + frame.z * height_rate_mm;
        let direction = along * tc + frame.y * ts;
        AxisJet {
            u: rule.u,
            line: AxisLine { point: m2 + to_axis, direction: Unit3::new_unchecked(direction) },
            point_rate: m2_rate + to_axis_rate,
            direction_rate: along_rate * tc + rate.y * ts,
        }
    }
}

impl ThreeTangent {
    /// The three places of contact, M0, M1 and M2.
    #[must_use]
    pub fn touches(&self, strip: &RuledStrip<'_>, u: f64) -> [Touch; 3] {
        let [a, b] = [0, 1].map(|i: usize| Touch {
            u: self.contacts[i],
            v: i as f64,
            point: strip.directrix(i, self.contacts[i]).point,
        });
        let ends = [0, 1].map(|i: usize| strip.directrix(i, u).point);
        let rule = ends[1] - ends[0];
        let v = self.height_mm / rule.norm();
        [a, b, Touch { u, v, point: ends[0] + rule * v }]
    }
}
