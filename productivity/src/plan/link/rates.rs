//! How long moves between passes take: enough to choose among ways and orders, not the time of a program.

use osculate_tools::cl::{ClMove, ClPath, Motion};

/// How fast the machine goes where it does not cut.
///
/// A rapid move goes from rest to rest: it takes `d / v + v / a`, or `2 sqrt(d / a)` where it is too short to get up to its speed. Of a
/// way and a turn the longer counts.
///
/// ```
/// use osculate_productivity::plan::Rates;
///
/// let rates = Rates::default();
/// assert_eq!(rates.rapid_mm_min, 30_000.0);
/// // 4 m/s2 in mm and minutes.
/// assert!((rates.rapid_mm_min2 / 3600.0 - 4000.0).abs() < 1e-9);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates {
    /// Speed of rapid moves, mm/min.
    pub rapid_mm_min: f64,
    /// Acceleration of rapid moves, mm/min2.
    pub rapid_mm_min2: f64,
    /// Speed of the slowest joint that turns the axis, rad/min.
    pub turn_rad_min: f64,
    /// Its acceleration, rad/min2.
    pub turn_rad_min2: f64,
}

impl Default for Rates {
    /// 30 m/min at 4 m/s2, 180 degrees a second at 1000 degrees/s2.
    fn default() -> Self {
        let deg_s = 60.0 * std::f64::consts::PI / 180.0;
        Self {
            rapid_mm_min: 30_000.0,
            rapid_mm_min2: 4000.0 * 3600.0,
            turn_rad_min: 180.0 * deg_s,
            turn_rad_min2: 1000.0 * 60.0 * deg_s,
        }
    }
}

/// A way of the tip with the turn of the axis on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::plan) struct Step {
    pub length_mm: f64,
    pub turn_rad: f64,
}

fn from_rest(way: f64, speed: f64, acceleration: f64) -> f64 {
    if way * acceleration >= speed * speed {
        way / speed + speed / acceleration
    } else {
        2.0 * (way / acceleration).sqrt()
    }
}

impl Rates {
    /// Time of a rapid move, min.
    pub(in crate::plan) fn rapid_min(&self, step: Step) -> f64 {
        let way = from_rest(step.length_mm, self.rapid_mm_min, self.rapid_mm_min2);
        way.max(from_rest(step.turn_rad, self.turn_rad_min, self.turn_rad_min2))
    }

    /// Time of a whole path, min, from its first place on.
    pub(in crate::plan) fn path_min(&self, path: &ClPath) -> f64 {
        self.moves_min(&path.moves)
    }

    /// Time of moves, min, from the first of their places on.
    pub(in crate::plan) fn moves_min(&self, moves: &[ClMove]) -> f64 {
        let pair = |w: &[ClMove]| {
            let (a, b) = (&w[0].pose, &w[1].pose);
            let step = Step { length_mm: (b.tip - a.tip).norm(), turn_rad: a.axis.angle(&b.axis) };
            match w[1].motion {
                Motion::Rapid => self.rapid_min(step),
                Motion::Feed(feed_mm_min) => self.feed_min(step, feed_mm_min),
            }
        };
        moves.windows(2).map(pair).sum()
    }

    /// Time of a way through the air at a feed, min: from rest to rest, as its corners are sharp.
    pub(in crate::plan) fn air_min(&self, step: Step, feed_mm_min: f64) -> f64 {
        let way = from_rest(step.length_mm, feed_mm_min, self.rapid_mm_min2);
        way.max(from_rest(step.turn_rad, self.turn_rad_min, self.turn_rad_min2))
    }

    /// Time of a move at a feed, min.
    pub(in crate::plan) fn feed_min(&self, step: Step, feed_mm_min: f64) -> f64 {
        (step.length_mm / feed_mm_min).max(step.turn_rad / self.turn_rad_min)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_those_of_a_body_that_speeds_up_and_slows_down() {
        let rates = Rates::default();
        let of = |length_mm: f64, turn_rad: f64| rates.rapid_min(Step { length_mm, turn_rad }) * 60.0;
        // 500 mm/s at 4000 mm/s2: up to speed after 31.25 mm and an eighth of a second, and as much to slow down.
        assert!((of(62.5, 0.0) - 0.25).abs() < 1e-12);
        assert!((of(562.5, 0.0) - 1.25).abs() < 1e-12);
        assert!((of(62.5 / 4.0, 0.0) - 0.125).abs() < 1e-12);
        // 180 degrees/s at 1000 degrees/s2: 32.4 degrees to get there and stop.
        assert!((of(0.0, 32.4f64.to_radians()) - 0.36).abs() < 1e-12);
        assert_eq!(of(1.0, 1.0), of(0.0, 1.0));
        assert!((rates.feed_min(Step { length_mm: 10.0, turn_rad: 0.0 }, 600.0) * 60.0 - 1.0).abs() < 1e-12);
    }
}
