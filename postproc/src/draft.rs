//! Moves of a program made from joints: rounded to the output's counts, with the F that each block needs.

use osculate_geom::{Diagnostic, Unit3, Vec3};
use osculate_tools::cl::Motion;

use crate::feed::{FeedMode, PathMetric, Step, capped_duration, duration_min, inverse_time_per_min};
use crate::joint_path::{BlockKind, JointBlock};
use crate::machine::{JointValues, Machine};
use crate::motion::rapid_time_min;
use crate::nc::orientation::{plane, plane_counts, vector_counts};
use crate::nc::{Dialect, NcMove, Orientation, Program, number};
use crate::post_error::PostError;
use crate::post_options::PostOptions;
use crate::setup::Setup;

/// Decimals of the linear words: of the joints, or of those called X, Y, Z where the words are the tip's.
pub(crate) fn linear_decimals(machine: &Machine, of_tip: bool) -> [usize; 3] {
    let joints = machine.joints();
    let own = machine.linear().map(|p| joints[p].decimals);
    if !of_tip {
        return own;
    }
    let finest = own.into_iter().fold(1, usize::max);
    ["X", "Y", "Z"].map(|name| machine.joint_named(name).map_or(finest, |p| joints[p].decimals))
}

/// Moves being made from joints, with what is counted on the way.
pub(crate) struct Draft<'a> {
    machine: &'a Machine,
    setup: &'a Setup,
    options: &'a PostOptions,
    linear_decimals: [usize; 3],
    /// Blocks that a joint's speed made longer, per joint.
    slowed: Vec<Slowed>,
    /// Blocks whose F would not have fitted the control's format.
    limited: Slowed,
    pub time_min: f64,
    /// Least and greatest feed of the tip, as a share of what was asked for.
    shares: [f64; 2],
    /// The last move with the joints at its end.
    last: Option<(NcMove, JointValues)>,
    /// Tip lengths and times of blocks that rounded to nothing: they go into the next one.
    carried_mm: f64,
    carried_min: f64,
    /// The farthest that each rotary joint is from its zero, rad.
    wound_rad: [f64; 2],
    /// The last F of a mode that bounds its rise.
    risen: Option<f64>,
}

impl<'a> Draft<'a> {
    pub fn new(machine: &'a Machine, setup: &'a Setup, options: &'a PostOptions) -> Self {
        Self {
            machine,
            setup,
            options,
            linear_decimals: linear_decimals(machine, options.feed == FeedMode::Tcp),
            slowed: vec![Slowed::default(); machine.joints().len()],
            limited: Slowed::default(),
            time_min: 0.0,
            shares: [f64::INFINITY, 0.0],
            last: None,
            carried_mm: 0.0,
            carried_min: 0.0,
            risen: None,
            wound_rad: [0.0; 2],
        }
    }

    /// The move of the next block; `None` where it rounds to nothing. `fastest_min` is its time in the fastest program.
    pub fn next(
        &mut self,
        block: &JointBlock,
        fastest_min: Option<f64>,
    ) -> Result<Option<NcMove>, PostError> {
        let mut m = self.rounded(block)?;
        for (most, place) in self.wound_rad.iter_mut().zip(self.machine.rotary()) {
            *most = most.max(block.joints[*place].abs());
        }
        let index = block.source;
        let planes = self.options.orientation == Orientation::Planes;
        if planes && m.rapid && block.kind != BlockKind::Point && self.last.is_some() {
            // Between two planes the tool is away from the part: only the end counts.
            return Ok(None);
        }
        if block.kind == BlockKind::Rewind && self.options.orientation == Orientation::Vectors {
            return Err(PostError::Rewind { index });
        }
        let Some((before, from)) = self.last else {
            self.last = Some((m, block.joints));
            return Ok(Some(m));
        };
        if m.linear == before.linear && m.rotary == before.rotary {
            self.carried_mm += if m.rapid { 0.0 } else { block.tip_length_mm };
            self.carried_min += fastest_min.unwrap_or(0.0);
            return Ok(None);
        }
        if planes && !m.rapid && m.rotary != before.rotary {
            return Err(PostError::Turns { index });
        }
        match block.motion {
            Motion::Rapid => {
                self.time_min += rapid_time_min(self.machine, &from, &block.joints).0;
                self.risen = None;
            }
            Motion::Feed(wanted) => {
                let length = block.tip_length_mm + self.carried_mm;
                let asked_min = match fastest_min {
                    Some(t) => t + self.carried_min,
                    None => duration_min(length, wanted),
                };
                let capped = capped_duration(self.machine, &from, &block.joints, asked_min);
                if let Some(place) = capped.joint {
                    let factor = if asked_min > 0.0 { capped.duration_min / asked_min } else { 1.0 };
                    self.slowed[place].add(index, factor);
                }
                let step = step(&before, &m);
                let f = self.feed(&step, wanted, (capped.duration_min, capped.joint.is_some()));
                let largest = self.machine.control().largest_feed;
                if f > largest {
                    self.limited.add(index, f / largest);
                }
                m.feed = f.min(largest);
                let read_min = self.control_time(&step, m.feed);
                if length > 0.0 && read_min > 0.0 {
                    let share = capped.duration_min / read_min;
                    self.shares = [self.shares[0].min(share), self.shares[1].max(share)];
                }
                self.time_min +=
                    read_min.max(capped_duration(self.machine, &from, &block.joints, 0.0).duration_min);
            }
        }
        (self.carried_mm, self.carried_min) = (0.0, 0.0);
        self.last = Some((m, block.joints));
        Ok(Some(m))
    }

    fn rounded(&self, block: &JointBlock) -> Result<NcMove, PostError> {
        let index = block.source;
        let counts = |value: f64| number::counts(value).ok_or(PostError::Position { index, value });
        let xyz = if self.options.feed == FeedMode::Tcp {
            let p = self.setup.to_program(&block.tip);
            [p.x, p.y, p.z]
        } else {
            self.machine.linear().map(|place| block.joints[place])
        };
        let axis = || self.machine.axis_at(&self.machine.rotary_of(&block.joints));
        let (xyz, orientation) = match self.options.orientation {
            Orientation::Joints => (xyz, [0; 3]),
            Orientation::Vectors => (xyz, vector_counts(&axis())),
            Orientation::Planes => {
                let angles = plane_counts(self.options.dialect, &axis());
                let plane = plane(self.options.dialect, angles.map(number::value));
                ((plane.inverse() * Vec3::from(xyz)).into(), angles)
            }
        };
        let mut linear = [0; 3];
        for ((to, value), decimals) in linear.iter_mut().zip(xyz).zip(self.linear_decimals) {
            *to = number::to_decimals(counts(value)?, decimals);
        }
        let mut rotary = [0; 2];
        for (to, place) in rotary.iter_mut().zip(self.machine.rotary()) {
            let decimals = self.machine.joints()[*place].decimals;
            *to = number::to_decimals(counts(block.joints[*place].to_degrees())?, decimals);
        }
        let (rapid, along) = (block.motion == Motion::Rapid, self.along(&axis()));
        Ok(NcMove { rapid, linear, rotary, orientation, along, feed: 0.0 })
    }

    /// Which linear word goes most along the tool, which points along `axis` in the part.
    fn along(&self, axis: &Unit3) -> Option<usize> {
        if self.options.feed != FeedMode::Tcp {
            let joints = self.machine.joints();
            return self.machine.linear().iter().position(|place| joints[*place].letter == "Z");
        }
        // In a tilted plane the tool stands along Z.
        let turns = self.options.orientation != Orientation::Planes;
        let most = |k: usize| if turns { axis[k].abs() } else { 0.0 };
        // Z where it is as good as another.
        (0..3).max_by(|a, b| most(*a).total_cmp(&most(*b)))
    }

    /// F of a block that shall take this long.
    fn feed(&mut self, step: &Step, wanted: f64, duration: (f64, bool)) -> f64 {
        let (duration_min, slowed) = duration;
        match self.options.feed {
            FeedMode::InverseTime => inverse_time_per_min(duration_min),
            FeedMode::None => wanted,
            // The tip's feed is F itself, whatever rounding does to the length.
            FeedMode::Tcp if !slowed && step.linear_mm > 0.0 => wanted,
            mode => {
                // The fastest program is written over whatever the control reads.
                let own = self.own_metric();
                let f = mode.metric(own).unwrap_or(own).length(step) / duration_min;
                match mode {
                    FeedMode::Kz { step_mm_min, .. } => {
                        let f = self.risen.map_or(f, |b| f.min(b + step_mm_min));
                        self.risen = Some(f);
                        f
                    }
                    _ => f,
                }
            }
        }
    }

    /// Over what the control reads F by itself.
    fn own_metric(&self) -> PathMetric {
        self.options.dialect.feed_metric(self.machine)
    }

    /// How long the control takes, by its own reading of F, min.
    fn control_time(&self, step: &Step, feed: f64) -> f64 {
        match self.options.feed {
            FeedMode::InverseTime => 1.0 / feed,
            mode => {
                // A program that declares its metric (Sinumerik) is read over it; elsewhere the machine's own holds.
                let declared = mode.metric(self.own_metric()).filter(|_| {
                    self.options.dialect == Dialect::Sinumerik || self.options.feed == FeedMode::Tcp
                });
                let metric = declared.unwrap_or_else(|| self.own_metric());
                metric.length(step) / feed
            }
        }
    }

    /// How far axes without end count on where the control does not wrap them, and whether Z has a place out of the way.
    fn report_axes(&self, diagnostics: &mut Vec<Diagnostic>) {
        let joints = self.machine.joints();
        for (most, place) in self.wound_rad.iter().zip(self.machine.rotary()) {
            let joint = &joints[*place];
            let counts = self.options.dialect == Dialect::LinuxCnc && joint.is_endless();
            if counts && *most > std::f64::consts::TAU {
                let text = format!(
                    "axis {} counts on to {:.0} deg, {:.1} turns: the limits of the control must hold that; it turns back where the next \
                     tool begins, away from the part",
                    joint.letter,
                    most.to_degrees(),
                    most / std::f64::consts::TAU
                );
                diagnostics.push(Diagnostic::warning("program", text));
            }
        }
        if self.machine.retract_mm().is_none() && self.machine.joint_named("Z").is_some() {
            let text = "the machine file has machine_zero_mm of Z, but no end of its travel: the program does not retract Z; give max_mm \
                        (min_mm where Z counts downwards) or retract_mm";
            diagnostics.push(Diagnostic::warning("program", text));
        }
    }

    pub fn report(&self, diagnostics: &mut Vec<Diagnostic>, program: &Program) {
        for (count, joint) in self.slowed.iter().zip(self.machine.joints()) {
            if let Some(place) = count.place() {
                let text = format!(
                    "{} blocks from here on are slower than asked, at worst {:.1} times: joint {} is at its greatest speed",
                    count.blocks, count.worst, joint.letter
                );
                diagnostics.push(Diagnostic::warning(place, text));
            }
        }
        self.report_axes(diagnostics);
        if let Some(place) = self.limited.place() {
            let largest = self.machine.control().largest_feed;
            let text = format!(
                "{} blocks from here on are slower than asked, at worst {:.1} times: F is cut to the control's largest, {largest}",
                self.limited.blocks, self.limited.worst
            );
            diagnostics.push(Diagnostic::warning(place, text));
        }
        let own = self.own_metric();
        let wanted = self
            .options
            .feed
            .metric(own)
            .filter(|_| !program.tcp && self.options.dialect != Dialect::Sinumerik);
        if let Some(wanted) = wanted.filter(|w| *w != own && !self.machine.rotary().is_empty()) {
            let text = format!(
                "F is written over {}, but this control reads it over {}: mixed moves take another time than asked, \
                 the tip runs at {:.3} to {:.3} times the feed asked for",
                metric_name(wanted),
                metric_name(own),
                self.shares[0],
                self.shares[1]
            );
            diagnostics.push(Diagnostic::warning("feed", text));
        }
        if self.options.feed == FeedMode::None && !self.machine.rotary().is_empty() {
            let text = format!(
                "F is not corrected: where rotary axes move, the tip runs at {:.3} to {:.3} times the feed asked for",
                self.shares[0], self.shares[1]
            );
            diagnostics.push(Diagnostic::warning("feed", text));
        }
    }
}

/// Blocks that take longer than asked.
#[derive(Clone, Copy, Debug, Default)]
struct Slowed {
    blocks: usize,
    /// The CL move of the first of them.
    first: usize,
    /// By what factor at worst.
    worst: f64,
}

impl Slowed {
    fn add(&mut self, index: usize, factor: f64) {
        if self.blocks == 0 {
            self.first = index;
        }
        self.blocks += 1;
        self.worst = self.worst.max(factor);
    }

    fn place(&self) -> Option<String> {
        (self.blocks > 0).then(|| format!("CL move {}", self.first))
    }
}

fn metric_name(metric: PathMetric) -> String {
    match metric {
        PathMetric::Linear => "the linear axes".into(),
        PathMetric::Arc { radius_mm } => format!("all axes, rotary ones at a radius of {radius_mm:.3} mm"),
        PathMetric::RotaryOnly => "the rotary axes".into(),
    }
}

/// By how much the words of a move differ from those before.
fn step(from: &NcMove, to: &NcMove) -> Step {
    let mm = |k: usize| number::value(to.linear[k] - from.linear[k]);
    let rad = |k: usize| number::value(to.rotary[k] - from.rotary[k]).to_radians();
    Step { linear_mm: (mm(0) * mm(0) + mm(1) * mm(1) + mm(2) * mm(2)).sqrt(), rotary_rad: [rad(0), rad(1)] }
}
