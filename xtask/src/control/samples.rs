//! What the sampler wrote down, one row a servo cycle: times are counted in rows, speeds and more are differences of rows.
//!
//! A row is its number, the joints X Y Z A C in mm and deg, the kind of motion (0 none, 1 rapid, 2 feed, 3 feed on an arc) and
//! the line. Over the step h = 1 ms speed is `(q1 - q0) / h`, acceleration `(q2 - 2 q1 + q0) / h^2`, jerk `(q3 - 3 q2 + 3 q1 -
//! q0) / h^3`. Positions are rounded to 1e-6, so jerk is known to 4e3 per s^3.

use super::machine::Joint;
use super::tip::{Walk, tip};
use crate::cmd::Failure;
use std::io::{BufRead, BufReader};
use std::path::Path;

/// Servo cycles in a second.
const RATE: f64 = 1000.0;

/// What a run shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shown {
    pub feed_s: f64,
    pub rapid_s: f64,
    /// Rapid moves up to the first place that the program alone tells.
    pub approach_s: f64,
    /// Without motion between the first and the last feed move: tool changes and switches of kinematics, and where blocks come
    /// too late.
    pub idle_s: f64,
    /// Rows that the sampler lost.
    pub lost: usize,
    /// Largest speed, acceleration and jerk of each joint in feed moves.
    pub most: [[f64; 5]; 3],
    /// Farthest tip from the path in feed moves, mm, and how far 99 of 100 cycles are at most.
    pub tip_mm: f64,
    pub tip_p99_mm: f64,
}

impl Shown {
    /// Shares of the joints' limits.
    pub fn shares(&self, joints: &[Joint; 5]) -> [[f64; 5]; 3] {
        let share = |what: usize, limit: fn(&Joint) -> f64| {
            std::array::from_fn(|k| self.most[what][k] / limit(&joints[k]))
        };
        [share(0, |j| j.velocity), share(1, |j| j.acceleration), share(2, |j| j.jerk)]
    }
}

/// Kinds of motion: rapid, and feed on a line or an arc.
pub const RAPID: u32 = 1;
pub const CUT: [u32; 2] = [2, 3];

/// One row.
pub struct Row {
    number: u64,
    /// X Y Z A C, mm and deg.
    pub joints: [f64; 5],
    pub kind: u32,
    line: usize,
}

/// The rows of a file of samples; what is no row is passed over.
pub fn rows(text: &str) -> impl Iterator<Item = Row> {
    text.lines().filter_map(row)
}

fn row(line: &str) -> Option<Row> {
    let mut words = line.split_ascii_whitespace();
    let number = words.next()?.parse().ok()?;
    let mut joints = [0.0; 5];
    for joint in &mut joints {
        *joint = words.next()?.parse().ok()?;
    }
    let kind = words.next()?.parse().ok()?;
    Some(Row { number, joints, kind, line: words.next()?.parse().ok()? })
}

/// Where the table and the part are, and the path.
pub struct Place<'a> {
    /// How far the control's zero of Z is above the table's reference point, less the tool's length, mm.
    pub z_mm: f64,
    /// The line of the program with which all joints have been named.
    pub named_line: usize,
    /// The part's origin from the table's reference point.
    pub part_zero_mm: [f64; 3],
    /// Empty where the tip is not looked at.
    pub way: &'a [[f64; 3]],
}

/// Reads a file of samples.
///
/// # Errors
/// Where it cannot be read.
pub fn read(path: &Path, place: &Place<'_>) -> Result<Shown, Failure> {
    let fail = |why| Failure::Read { path: path.to_path_buf(), why };
    let file = std::fs::File::open(path).map_err(fail)?;
    let mut counted = Counted::new(place);
    for line in BufReader::new(file).lines() {
        counted.line(&line.map_err(fail)?);
    }
    Ok(counted.shown())
}

struct Counted<'a> {
    place: &'a Place<'a>,
    walk: Walk<'a>,
    out: Shown,
    feed: usize,
    rapid: usize,
    approach: usize,
    idle: usize,
    /// Idle rows since the last feed row.
    resting: usize,
    last: Option<u64>,
    /// The last rows of one stretch of feed, newest first.
    before: Vec<[f64; 5]>,
    offs: Vec<f32>,
}

impl<'a> Counted<'a> {
    fn new(place: &'a Place<'a>) -> Self {
        Self {
            place,
            walk: Walk::new(place.way),
            out: Shown::default(),
            feed: 0,
            rapid: 0,
            approach: 0,
            idle: 0,
            resting: 0,
            last: None,
            before: Vec::new(),
            offs: Vec::new(),
        }
    }

    fn line(&mut self, line: &str) {
        // What is no row is the sampler's word that it lost some, which numbers tell too.
        let Some(row) = row(line) else { return };
        let lost = self.last.map_or(0, |l| row.number.saturating_sub(l + 1));
        self.out.lost += lost as usize;
        self.last = Some(row.number);
        if lost > 0 {
            self.before.clear();
        }
        match row.kind {
            kind if CUT.contains(&kind) => self.feed(row.joints),
            RAPID => {
                let named = row.line > self.place.named_line;
                *(if named { &mut self.rapid } else { &mut self.approach }) += 1;
                self.before.clear();
            }
            _ => {
                self.resting += 1;
                self.before.clear();
            }
        }
    }

    fn feed(&mut self, joints: [f64; 5]) {
        if self.feed > 0 {
            self.idle += self.resting;
        }
        self.resting = 0;
        self.feed += 1;
        self.differences(&joints);
        self.before.insert(0, joints);
        self.before.truncate(3);
        if !self.place.way.is_empty() {
            let [x, y, z, a, c] = joints;
            let at = tip(&[x, y, z + self.place.z_mm, a, c]);
            let zero = self.place.part_zero_mm;
            let off = self.walk.off(&[at[0] - zero[0], at[1] - zero[1], at[2] - zero[2]]);
            self.offs.push(off as f32);
        }
    }

    /// Of the first, second and third order, as far as the stretch is long.
    fn differences(&mut self, now: &[f64; 5]) {
        for k in 0..5 {
            let mut values = vec![now[k]];
            values.extend(self.before.iter().map(|b| b[k]));
            for order in 0..3 {
                values = values.windows(2).map(|w| (w[0] - w[1]) * RATE).collect();
                let Some(newest) = values.first() else { break };
                self.out.most[order][k] = self.out.most[order][k].max(newest.abs());
            }
        }
    }

    fn shown(mut self) -> Shown {
        self.offs.sort_by(f32::total_cmp);
        let at = |share: f64| self.offs.get((share * (self.offs.len() as f64 - 1.0)).round() as usize);
        let off = |share: f64| at(share).map_or(f64::NAN, |v| f64::from(*v));
        Shown {
            feed_s: self.feed as f64 / RATE,
            rapid_s: self.rapid as f64 / RATE,
            approach_s: self.approach as f64 / RATE,
            idle_s: self.idle as f64 / RATE,
            tip_mm: off(1.0),
            tip_p99_mm: off(0.99),
            ..self.out
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_counted_and_differences_taken() {
        let place =
            Place { z_mm: -1.0, named_line: 3, part_zero_mm: [0.0; 3], way: &[[0.0; 3], [9.0, 0.0, 0.0]] };
        let mut counted = Counted::new(&place);
        // X goes 0 0 1 4 um, one row is lost, Z keeps 1 mm, which is on the way.
        for line in [
            "6 0 0 1 0 0 1 3",
            "7 0 0 1 0 0 1 4",
            "8 0 0 1 0 0 2 5",
            "9 0 0 1 0 0 2 5",
            "10 0.001 0 1 0 0 2 5",
            "11 0.004 0 1 0 0 2 5",
            "overrun",
            "13 0.004 0 1.5 0 0 0 5",
            "14 0.004 0 1 0 0 3 6",
            "15 0.004 0 1 0 0 0 0",
        ] {
            counted.line(line);
        }
        let shown = counted.shown();
        assert_eq!(
            (shown.feed_s, shown.rapid_s, shown.approach_s, shown.idle_s, shown.lost),
            (0.005, 0.001, 0.001, 0.001, 1)
        );
        let x = [shown.most[0][0], shown.most[1][0], shown.most[2][0]];
        let want = [3.0, 2e3, 1e6];
        assert!(x.iter().zip(want).all(|(a, b)| (a / b - 1.0).abs() < 1e-9), "{x:?}");
        assert!(shown.tip_mm < 1e-9 && shown.most[0][2] == 0.0);
    }
}
