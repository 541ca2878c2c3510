//! One piece of motion as the trajectory planner of LinuxCNC sees it: a length along the path, limits, and how it
//! ends. Lengths are mm, or degrees where only rotary axes move; times are seconds.

use osculate_geom::Vec3;

/// Share of the acceleration that a curved piece keeps for speeding up and slowing down.
pub(super) const TANGENTIAL_SHARE: f64 = 0.5;

/// The rest, for going round: sqrt(1 - 0.5^2).
pub(super) const NORMAL_SHARE: f64 = 0.866_025_403_784_438_6;

/// How a piece meets the next one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    /// At rest.
    Stop,
    /// At rest, unless the next piece is tangent (exact path mode).
    Exact,
    /// The next piece starts while this one slows down.
    Parabolic,
    /// Without slowing down.
    Tangent,
}

/// The place of a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Shape {
    /// X Y Z on a line (or at rest, while rotary axes move).
    Line {
        /// Where it starts, mm.
        from: Vec3,
        /// Where it ends, mm.
        to: Vec3,
    },
    /// A programmed arc or helix.
    Circle {
        /// Radius of curvature, mm.
        radius_mm: f64,
        /// Across its plane.
        normal: Vec3,
    },
    /// An arc put in by the planner to round a corner.
    Blend,
}

/// A piece of motion.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Segment {
    /// The last of the moves that it is made of, by its place in the program.
    pub of: usize,
    pub rapid: bool,
    pub shape: Shape,
    /// Unit tangents of the way in X Y Z; +x where X Y Z rest.
    pub start: Vec3,
    pub end: Vec3,
    /// A rotary axis moves.
    pub rotary: bool,
    /// Nothing else moves.
    pub pure_rotary: bool,
    pub length: f64,
    pub nominal: f64,
    pub wanted: f64,
    pub greatest: f64,
    pub acceleration: f64,
    /// Tolerance of blending, mm; 0: as far as half of a piece allows.
    pub tolerance_mm: f64,
    pub ends: End,
    /// The piece before blends into this one parabolically.
    pub blended_into: bool,
    /// Greatest speed over the kink at the end, where it is nearly tangent.
    pub kink: Option<f64>,
    /// Shares of the acceleration given away to the kinks at the start and at the end.
    pub kink_share: [f64; 2],
    pub tangential: f64,
    /// Its length cannot change any more.
    pub final_length: bool,
    /// Speed at its end that the look-ahead allows.
    pub out: f64,
    pub run: Run,
}

/// State of a piece under way.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub(super) struct Run {
    pub active: bool,
    pub done: f64,
    pub speed: f64,
    /// Time of the next step, s, where the piece ends within it.
    pub split: Option<f64>,
    pub split_speed: f64,
    pub blending: bool,
    pub slowing: bool,
    pub blend_speed: f64,
    pub ramp: bool,
    pub over: bool,
    pub steps: u32,
}

impl Segment {
    /// Acceleration along the path, with what blends, kinks and curvature take away.
    pub fn along(&self) -> f64 {
        let round = match self.shape {
            Shape::Line { .. } => 1.0,
            Shape::Circle { .. } | Shape::Blend => self.tangential,
        };
        self.overall() * round
    }

    fn overall(&self) -> f64 {
        let kinks = 1.0 - self.kink_share[0].max(self.kink_share[1]);
        // Two pieces run at once in a parabolic blend; each gets half.
        let half = if self.blended_into || self.ends == End::Parabolic { 0.5 } else { 1.0 };
        self.acceleration * kinks * half
    }

    /// The speed that is wanted and allowed.
    pub fn target(&self, cap: f64) -> f64 {
        let v = self.wanted.min(self.greatest);
        if self.pure_rotary { v } else { v.min(cap) }
    }

    /// The speed reached halfway from rest to rest; an unfinished piece may still lose half.
    pub fn triangle(&self) -> f64 {
        let length = if self.final_length { self.length } else { 0.5 * self.length };
        (self.along() * length).sqrt()
    }

    pub fn to_go(&self) -> f64 {
        self.length - self.run.done
    }

    /// No piece is shorter than one step of the control.
    pub fn clamp_to_step(&mut self, step_s: f64) {
        self.greatest = self.greatest.min(self.length / step_s);
    }

    /// After this the length stays.
    pub fn finalize(&mut self, step_s: f64) {
        if self.final_length {
            return;
        }
        self.clamp_to_step(step_s);
        if let Shape::Circle { radius_mm, .. } = self.shape {
            let a = self.overall();
            let normal = self.greatest * self.greatest / radius_mm;
            if normal > NORMAL_SHARE * a {
                self.greatest = (NORMAL_SHARE * a * radius_mm).sqrt();
                self.tangential = TANGENTIAL_SHARE;
            } else {
                self.tangential = (1.0 - (normal / a).powi(2)).sqrt();
            }
        }
        self.final_length = true;
    }
}

/// Makes the first of two pieces end like this.
pub(super) fn join(first: &mut Segment, second: &mut Segment, ends: End) {
    first.ends = ends;
    second.blended_into = ends == End::Parabolic;
}

/// Half of the angle between two pieces: pi/2 where they run straight on.
pub(super) fn half_angle(u1: &Vec3, u2: &Vec3) -> f64 {
    0.5 * (-u1.dot(u2)).clamp(-1.0, 1.0).acos()
}
