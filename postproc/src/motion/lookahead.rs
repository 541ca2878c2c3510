//! Time of a stretch of blocks with look-ahead: joints' speeds, accelerations and jerks, corner tolerance, block rate.
//!
//! Blocks are measured in the metric `sigma = |dq_i / v_i|` (2-norm over the joints), so that sigma over its rate w is
//! time. Along a block `q_i' = dq_i / sigma`, and
//!
//! ```text
//! w <= sigma / T_F,   w <= min_i v_i / |q_i'|,   w <= sigma / T_block,   |dw/dt| <= min_i a_i / |q_i'|
//! ```
//!
//! At a corner the joints' speeds jump by `D_i w`. Rounding it with the joints' accelerations takes
//! `t = w tau, tau = max_i |D_i| / a_i` and leaves the corner by `|D_i| w t / 8`; with the tolerance e_i of a joint
//! `w^2 <= 8 e_i / (|D_i| tau)`, and the rounding must fit into both blocks, `w^2 <= min(sigma) / tau`.
//!
//! A backward pass finds the speed at which every block may end, a forward pass the speeds and the time. Jerk is
//! taken into account as controls do that smooth the set values over `a / j`: it adds that time once per stretch from
//! rest to rest; a stretch of a single block is exact ([`super::move_time_s`]). The model looks [`WINDOW`] blocks
//! ahead and keeps no more of the program.

use crate::machine::{Drive, JointValues, MAX_JOINTS, Machine};

/// Blocks that the model looks ahead; controls of today look 100 to 5000 ahead.
const WINDOW: usize = 1024;

/// What a control does between blocks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LookAhead {
    /// How far a linear joint may leave a corner, mm.
    pub corner_mm: f64,
    /// How far a rotary joint may, rad.
    pub corner_rad: f64,
    /// Time that the control needs for a block, s; 0: no limit.
    pub block_s: f64,
}

impl Default for LookAhead {
    /// 10 um, 0.02 deg, 1000 blocks a second.
    fn default() -> Self {
        Self { corner_mm: 0.01, corner_rad: 0.02f64.to_radians(), block_s: 0.001 }
    }
}

/// A block as the model keeps it.
#[derive(Clone, Copy, Debug)]
struct Piece {
    tangent: JointValues,
    sigma: f64,
    fastest: f64,
    acceleration: f64,
    /// Speed allowed at its start by the corner with the piece before.
    corner: f64,
}

/// Adds up the time of blocks.
#[derive(Clone, Debug)]
pub struct Stretch {
    drives: Vec<Drive>,
    tolerance: Vec<f64>,
    block_s: f64,
    jerk_s: f64,
    pieces: Vec<Piece>,
    last: Option<Piece>,
    speed: f64,
    moving: bool,
    single: Option<(JointValues, f64)>,
    time_s: f64,
    /// Blocks that each joint made longer than F asks.
    slowed: [usize; MAX_JOINTS],
    /// Time of every block, s, where it is asked for.
    each_s: Option<Vec<f64>>,
}

/// Time of every block of a path, s, as fast as the joints' speeds and accelerations and the corners allow, or as
/// slow as `wanted_s` of a block asks; `None` is a stop without a block. A block that rests takes what it asks.
///
/// ```
/// use osculate_postproc::{Machine, motion::{LookAhead, block_times_s}};
///
/// // A line of 100 mm as one block, and cut into four: the same time from rest to rest, but for the jerk of a single move.
/// let machine = Machine::built_in("3-axis")?;
/// let x = machine.linear()[0];
/// let at = |mm: f64| {
///     let mut joints = [0.0; 5];
///     joints[x] = mm;
///     joints
/// };
/// let control = LookAhead { block_s: 0.0, ..LookAhead::default() };
/// // F asks for 10 s in all.
/// let whole = block_times_s(&machine, &control, [Some((at(0.0), at(100.0), 10.0))]);
/// let piece = |k: u32| Some((at(25.0 * f64::from(k)), at(25.0 * f64::from(k + 1)), 2.5));
/// let cut = block_times_s(&machine, &control, (0..4).map(piece));
/// assert_eq!((whole.len(), cut.len()), (1, 4));
/// assert!((whole[0] - cut.iter().sum::<f64>()).abs() < 0.1 && whole[0] >= 10.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn block_times_s(
    machine: &Machine,
    control: &LookAhead,
    blocks: impl IntoIterator<Item = Option<(JointValues, JointValues, f64)>>,
) -> Vec<f64> {
    let mut stretch = Stretch::new(machine, control);
    stretch.each_s = Some(Vec::new());
    for block in blocks {
        match block {
            Some((from, to, wanted_s)) => stretch.block(&from, &to, wanted_s),
            None => stretch.stop(),
        }
    }
    stretch.stop();
    stretch.each_s.unwrap_or_default()
}

impl Stretch {
    /// At rest.
    #[must_use]
    pub fn new(machine: &Machine, control: &LookAhead) -> Self {
        let joints = machine.joints();
        let tolerance = |place: usize| {
            if machine.rotary().contains(&place) { control.corner_rad } else { control.corner_mm }
        };
        let drives: Vec<Drive> = joints.iter().map(|j| j.drive).collect();
        let jerk = |d: &Drive| d.jerk_per_s3.map_or(0.0, |j| d.acceleration_per_s2 / j);
        Self {
            jerk_s: drives.iter().map(jerk).fold(0.0, f64::max),
            tolerance: (0..joints.len()).map(tolerance).collect(),
            block_s: control.block_s.max(0.0),
            drives,
            pieces: Vec::with_capacity(2 * WINDOW),
            last: None,
            speed: 0.0,
            moving: false,
            single: None,
            time_s: 0.0,
            slowed: [0; MAX_JOINTS],
            each_s: None,
        }
    }

    /// Keeps the time of every block, for [`Self::take_each_s`]. Before the first one.
    pub(crate) fn keep_each(&mut self) {
        self.each_s = Some(Vec::new());
    }

    /// The time of every block so far, s, after [`Self::stop`]; empty where times are not kept.
    pub(crate) fn take_each_s(&mut self) -> Vec<f64> {
        self.each_s.take().unwrap_or_default()
    }

    /// Time so far, s; all of it only after [`Self::stop`].
    #[must_use]
    pub const fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Blocks that each joint made longer than F asks, in chain order.
    #[must_use]
    pub const fn slowed(&self) -> [usize; MAX_JOINTS] {
        self.slowed
    }

    /// A block that F asks to take `wanted_s`.
    pub fn block(&mut self, from: &JointValues, to: &JointValues, wanted_s: f64) {
        let mut tangent = [0.0; MAX_JOINTS];
        let mut square = 0.0;
        for (k, d) in self.drives.iter().enumerate() {
            tangent[k] = to[k] - from[k];
            square += (tangent[k] / d.velocity_per_s).powi(2);
        }
        let sigma = square.sqrt();
        if sigma == 0.0 {
            // It rests: what came before has its time first.
            if self.each_s.is_some() {
                self.stop();
            }
            self.spend(wanted_s);
            return;
        }
        let (moved, mut acceleration) = (tangent, f64::INFINITY);
        let (mut fastest, mut joint) = (sigma / wanted_s.max(self.block_s), None);
        for (k, d) in self.drives.iter().enumerate() {
            tangent[k] /= sigma;
            let t = tangent[k].abs();
            if t > 0.0 {
                acceleration = acceleration.min(d.acceleration_per_s2 / t);
                if d.velocity_per_s / t < fastest {
                    (fastest, joint) = (d.velocity_per_s / t, Some(k));
                }
            }
        }
        if let Some(k) = joint {
            self.slowed[k] += 1;
        }
        let mut piece = Piece { tangent, sigma, fastest, acceleration, corner: 0.0 };
        if let Some(last) = &self.last {
            piece.corner = self.corner(last, &piece);
        }
        self.single = if self.moving { None } else { Some((moved, wanted_s)) };
        self.moving = true;
        self.last = Some(piece);
        self.pieces.push(piece);
        if self.pieces.len() >= 2 * WINDOW {
            self.run(WINDOW);
        }
    }

    /// Comes to rest.
    pub fn stop(&mut self) {
        if !self.moving {
            return;
        }
        if let Some((moved, wanted_s)) = self.single.take() {
            self.pieces.clear();
            let alone_s = self.alone_s(&moved, wanted_s);
            self.spend(alone_s);
        } else {
            self.run(self.pieces.len());
            self.time_s += self.jerk_s;
        }
        self.moving = false;
        self.last = None;
        self.speed = 0.0;
    }

    fn spend(&mut self, time_s: f64) {
        self.time_s += time_s;
        if let Some(each) = &mut self.each_s {
            each.push(time_s);
        }
    }

    /// A single block from rest to rest: every joint moves along with the slowest one, none faster than F asks.
    fn alone_s(&self, moved: &JointValues, wanted_s: f64) -> f64 {
        let time = |(d, m): (&Drive, &f64)| {
            let v =
                if wanted_s > 0.0 { (m.abs() / wanted_s).min(d.velocity_per_s) } else { d.velocity_per_s };
            if *m == 0.0 { 0.0 } else { super::move_time_s(*m, &Drive { velocity_per_s: v, ..*d }) }
        };
        self.drives.iter().zip(moved).map(time).fold(self.block_s, f64::max)
    }

    fn corner(&self, a: &Piece, b: &Piece) -> f64 {
        let jump = |k: usize| (b.tangent[k] - a.tangent[k]).abs();
        let joints = 0..self.drives.len();
        let tau = joints.clone().map(|k| jump(k) / self.drives[k].acceleration_per_s2).fold(0.0, f64::max);
        let most = a.fastest.min(b.fastest);
        // Straight on, as far as doubles tell.
        if tau <= f64::EPSILON {
            return most;
        }
        let mut square = a.sigma.min(b.sigma) / tau;
        for k in joints.filter(|k| jump(*k) > 0.0) {
            square = square.min(8.0 * self.tolerance[k] / (jump(k) * tau));
        }
        most.min(square.sqrt())
    }

    /// Runs the first `count` blocks, with the speeds at their ends that all of the blocks known allow.
    fn run(&mut self, count: usize) {
        let mut entry = vec![0.0; self.pieces.len() + 1];
        for (k, p) in self.pieces.iter().enumerate().rev() {
            let reach = (entry[k + 1] * entry[k + 1] + 2.0 * p.acceleration * p.sigma).sqrt();
            entry[k] = reach.min(p.corner);
        }
        for (p, out) in self.pieces[..count].iter().zip(&entry[1..]) {
            let (a, v) = (p.acceleration, self.speed.min(p.fastest));
            let reach = (v * v + 2.0 * a * p.sigma).sqrt();
            let out = out.min(reach);
            let peak = (a * p.sigma + 0.5 * (v * v + out * out)).sqrt().min(p.fastest).max(v.max(out));
            let ramps = (2.0 * peak * peak - v * v - out * out) / (2.0 * a);
            let time_s = (2.0 * peak - v - out) / a + (p.sigma - ramps).max(0.0) / peak;
            self.time_s += time_s;
            if let Some(each) = &mut self.each_s {
                each.push(time_s);
            }
            self.speed = out;
        }
        self.pieces.drain(..count);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn machine(jerk: &str) -> Machine {
        let slide = |letter: &str, d: [i32; 3]| {
            format!(
                "[[joint]]\nkind = \"linear\"\nletter = \"{letter}\"\nside = \"head\"\ndirection = {d:?}\n\
                 max_velocity_mm_s = 166.66666666666666\nmax_acceleration_mm_s2 = 1000\n{jerk}\n"
            )
        };
        let all = [("X", [1, 0, 0]), ("Y", [0, 1, 0]), ("Z", [0, 0, 1])].map(|(l, d)| slide(l, d)).concat();
        let head = "format = 1\nname = \"m\"\n[control]\nfeed_reading = { kind = \"linear\" }\n";
        Machine::from_toml(&format!("{head}{all}")).unwrap()
    }

    fn along_x(machine: &Machine, steps: u32, wanted_s: f64) -> f64 {
        let mut stretch = Stretch::new(machine, &LookAhead { block_s: 0.0, ..LookAhead::default() });
        let at = |k: u32| [100.0 * f64::from(k) / f64::from(steps), 0.0, 0.0, 0.0, 0.0];
        for k in 0..steps {
            stretch.block(&at(k), &at(k + 1), wanted_s / f64::from(steps));
        }
        stretch.stop();
        stretch.time_s()
    }

    /// A straight line cut into any number of blocks, beyond the window too, takes the time of the whole.
    #[test]
    fn cutting_a_line_costs_nothing() {
        let plain = machine("");
        // v = 166.667 mm/s, a = 1000 mm/s2 over 100 mm: 0.6 + 1/6 s.
        let whole = 0.6 + 1.0 / 6.0;
        for steps in [1, 2, 7, 1000, 5000] {
            let t = along_x(&plain, steps, 0.0);
            assert!((t - whole).abs() < 1e-6, "{steps} blocks: {t} s");
        }
        // With jerk the time of one block is exact, and the smoothing adds a / j = 0.02 s to many.
        let smooth = machine("max_jerk_mm_s3 = 50000");
        for steps in [1, 2, 100] {
            let t = along_x(&smooth, steps, 0.0);
            assert!((t - whole - 0.02).abs() < 1e-6, "{steps} blocks: {t} s");
        }
    }

    #[test]
    fn f_and_block_rate_bound_the_speed() {
        let plain = machine("");
        // 10 mm/s: ramps of 0.01 s.
        assert!((along_x(&plain, 50, 10.0) - 10.01).abs() < 1e-9);
        let mut slow = Stretch::new(&plain, &LookAhead { block_s: 0.5, ..LookAhead::default() });
        for k in 0..10 {
            let at = |k: i32| [0.1 * f64::from(k), 0.0, 0.0, 0.0, 0.0];
            slow.block(&at(k), &at(k + 1), 0.0);
        }
        slow.stop();
        assert!(slow.time_s() >= 5.0);
    }

    /// A right angle at 0.01 mm: `D = (1, 1) v_full`, tau = v / a, so v^2 = 8 e a in mm/s, where it fits.
    #[test]
    fn corners_follow_the_tolerance() {
        let plain = machine("");
        let mut s = Stretch::new(&plain, &LookAhead { block_s: 0.0, ..LookAhead::default() });
        s.block(&[0.0; 5], &[50.0, 0.0, 0.0, 0.0, 0.0], 0.0);
        s.block(&[50.0, 0.0, 0.0, 0.0, 0.0], &[50.0, 50.0, 0.0, 0.0, 0.0], 0.0);
        s.stop();
        let corner = (8.0 * 0.01 * 1000.0f64).sqrt();
        let (v, a) = (500.0 / 3.0, 1000.0);
        let ramps = (2.0 * v * v - corner * corner) / (2.0 * a);
        let half = (2.0 * v - corner) / a + (50.0 - ramps) / v;
        assert!((s.time_s() - 2.0 * half).abs() < 1e-9, "{} {}", s.time_s(), 2.0 * half);
    }
}
