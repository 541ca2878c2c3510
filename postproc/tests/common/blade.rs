//! Paths on a real blade: NASA Rotor 37, its sections in `data/blade`.
//!
//! The blade stands along z, its section in x and y, mm, the middle section about the origin. Normals point outward:
//! across the way along the section and the way to the next section.
#![allow(dead_code)]

use osculate_geom::{Point3, Unit3, Vec3};
use osculate_postproc::FeedMode;
use osculate_tools::Pose;
use osculate_tools::cl::{ClMove, ClPath, Motion};

/// Radius of the ball end that the paths are made for, mm.
pub const BALL_MM: f64 = 2.0;

/// A point of the blade with its outward normal.
#[derive(Clone, Copy, Debug)]
pub struct At {
    pub point: Point3,
    pub normal: Vec3,
}

/// The blade's sections from hub to tip, each a closed line of the same number of points.
pub struct Blade {
    sections: Vec<Vec<Point3>>,
}

impl Blade {
    pub fn rotor_37() -> Self {
        let text = include_str!("../data/blade/rotor37.dat");
        let mut sections: Vec<Vec<Point3>> = Vec::new();
        for line in text.lines() {
            if line.starts_with('#') {
                sections.push(Vec::new());
                continue;
            }
            let n: Vec<f64> = line.split_whitespace().filter_map(|w| w.parse().ok()).collect();
            if let (Some(section), [x, y, z]) = (sections.last_mut(), n.as_slice()) {
                section.push(Point3::new(10.0 * x, 10.0 * y, 10.0 * z));
            }
        }
        let middle = &sections[sections.len() / 2];
        let centre: Vec3 = middle.iter().map(|p| p.coords).sum::<Vec3>() / middle.len() as f64;
        let zero = Vec3::new(centre.x, centre.y, sections[0][0].z);
        for p in sections.iter_mut().flatten() {
            *p -= zero;
        }
        Self { sections }
    }

    /// Points of one section.
    pub fn around(&self) -> usize {
        self.sections[0].len() - 1
    }

    /// The point at a share of the span and an index around the section, which counts on through whole rounds.
    pub fn at(&self, span: f64, index: usize) -> At {
        let s = span.clamp(0.0, 1.0) * (self.sections.len() - 1) as f64;
        let k = (s.floor() as usize).min(self.sections.len() - 2);
        let t = s - k as f64;
        let n = self.around();
        let on = |i: usize| {
            let (a, b) = (self.sections[k][i % n], self.sections[k + 1][i % n]);
            a + (b - a) * t
        };
        let along = on(index + 1) - on(index + n - 1);
        let up = self.sections[k + 1][index % n] - self.sections[k][index % n];
        let normal = along.cross(&up).normalize();
        At { point: on(index), normal: self.outward() * normal }
    }

    /// The sections may run either way round; the signed area of the first tells.
    fn outward(&self) -> f64 {
        let s = &self.sections[0];
        let area: f64 = s.windows(2).map(|w| w[0].x * w[1].y - w[1].x * w[0].y).sum();
        area.signum()
    }

    /// Rounds about the section at rising spans, leading and trailing edge included.
    pub fn rounds(&self, from: f64, rounds: usize, rise: f64) -> Vec<At> {
        let n = self.around();
        let all = 0..rounds * n;
        all.map(|i| self.at(from + rise * i as f64 / n as f64, i)).collect()
    }

    /// Up and down the span, over a part of the section.
    pub fn zigzag(&self, first: usize, passes: usize, step: usize, spans: usize) -> Vec<At> {
        let mut all = Vec::new();
        for pass in 0..passes {
            for k in 0..=spans {
                let share = k as f64 / spans as f64;
                let span = 0.1 + 0.8 * if pass % 2 == 0 { share } else { 1.0 - share };
                all.push(self.at(span, first + pass * step));
            }
        }
        all
    }
}

/// The pose of the ball end that touches the blade there, with its axis in this direction.
pub fn touching(at: &At, axis: Vec3) -> Pose {
    let axis = Unit3::new_normalize(axis);
    Pose { tip: at.point + (at.normal - axis.into_inner()) * BALL_MM, axis }
}

/// Leans from z by this share of a right angle towards the normal.
pub fn leaning(at: &At, share: f64) -> Pose {
    let out = Vec3::new(at.normal.x, at.normal.y, 0.0).normalize();
    let (s, c) = (share * std::f64::consts::FRAC_PI_2).sin_cos();
    touching(at, out * s + Vec3::z() * c)
}

/// Across z, turned by the lead from the normal: what a turning centre can reach.
pub fn radial(at: &At, lead_rad: f64) -> Pose {
    let out = Vec3::new(at.normal.x, at.normal.y, 0.0).normalize();
    let (s, c) = lead_rad.sin_cos();
    touching(at, out * c + Vec3::z().cross(&out) * s)
}

/// A rapid to the first pose, then feed moves; poses that repeat are left out.
pub fn path(poses: impl IntoIterator<Item = Pose>, feed_mm_min: f64) -> ClPath {
    let mut moves: Vec<ClMove> = Vec::new();
    for pose in poses {
        let motion = if moves.is_empty() { Motion::Rapid } else { Motion::Feed(feed_mm_min) };
        if moves.last().is_none_or(|m| (m.pose.tip - pose.tip).norm() > 1e-3) {
            moves.push(ClMove { pose, motion, aloft: false });
        }
    }
    ClPath { moves, spindle_rpm: Some(8000.0), ..ClPath::default() }
}

/// Three paths for five axes: rounds with the edges, zigzag up the pressure side, rounds with a wandering lead.
pub fn five_axis() -> [(&'static str, ClPath); 3] {
    let blade = Blade::rotor_37();
    let rounds = blade.rounds(0.45, 1, 0.02);
    let zigzag = blade.zigzag(40, 4, 5, 40);
    let upper = blade.rounds(0.8, 1, 0.05);
    let wander = |(i, at): (usize, &At)| leaning(at, 0.3 + 0.1 * (i as f64 * 0.05).sin());
    [
        ("rounds", path(rounds.iter().map(|a| leaning(a, 0.35)), 600.0)),
        ("zigzag", path(zigzag.iter().map(|a| leaning(a, 0.5)), 900.0)),
        ("wander", path(upper.iter().enumerate().map(wander), 400.0)),
    ]
}

/// Rounds for a turning centre, the tool across the turning axis.
pub fn mill_turn(rounds: usize, feed_mm_min: f64) -> ClPath {
    let at = Blade::rotor_37().rounds(0.4, rounds, 0.02);
    path(at.iter().map(|a| radial(a, 10f64.to_radians())), feed_mm_min)
}

/// Three paths for a turning centre: rounds at two heights and leads, and a zigzag with the lead turning back.
pub fn four_axis() -> [(&'static str, ClPath); 3] {
    let blade = Blade::rotor_37();
    let lead = |at: &At, deg: f64| radial(at, deg.to_radians());
    [
        ("rounds", mill_turn(1, 500.0)),
        ("upper", path(blade.rounds(0.8, 1, 0.05).iter().map(|a| lead(a, -8.0)), 800.0)),
        ("zigzag", path(blade.zigzag(40, 4, 5, 40).iter().map(|a| lead(a, 15.0)), 300.0)),
    ]
}

/// Three paths with the tool upright: rounds, zigzag, and the section from the side.
pub fn three_axis() -> [(&'static str, ClPath); 3] {
    let blade = Blade::rotor_37();
    let upright = |at: &At| touching(at, Vec3::z());
    [
        ("rounds", path(blade.rounds(0.45, 1, 0.02).iter().map(upright), 600.0)),
        ("zigzag", path(blade.zigzag(40, 4, 5, 40).iter().map(upright), 900.0)),
        ("upper", path(blade.rounds(0.8, 1, 0.1).iter().map(upright), 400.0)),
    ]
}

/// The paths for a machine with so many rotary axes.
pub fn for_rotary_axes(count: usize) -> [(&'static str, ClPath); 3] {
    match count {
        2 => five_axis(),
        1 => four_axis(),
        _ => three_axis(),
    }
}

/// Every feed mode of the postprocessor.
pub fn feed_modes() -> [(&'static str, FeedMode); 9] {
    [
        ("tcp", FeedMode::Tcp),
        ("none", FeedMode::None),
        ("kf", FeedMode::Kf),
        ("kv", FeedMode::Kv { fgref_mm: None }),
        ("kv, fgref 30", FeedMode::Kv { fgref_mm: Some(30.0) }),
        ("kz", FeedMode::Kz { step_mm_min: 200.0, fgref_mm: None }),
        ("rotary", FeedMode::RotaryOnly),
        ("inverse_time", FeedMode::InverseTime),
        ("fastest", FeedMode::Fastest { tip_mm_min: None }),
    ]
}
