//! Charts of a machine's joints over the time.

use super::chart::{Axis, BOTTOM, HEIGHT, LEFT, RIGHT, TOP, WIDTH, base_line, frame};
use super::data::ToolPose;
use super::machine::Machine;
use super::text::{coordinate, escape};
use osculate_postproc::machine::MAX_JOINTS;
use std::fmt::Write;

/// Stretches of time of which the least and the greatest place of a joint are drawn.
const JOINT_SLOTS: usize = 300;
/// Lines of a chart of joints that have a look of their own.
const LOOKS: usize = 3;
/// Width of a word of the legend with its line, and length of the line.
const KEY: f64 = 46.0;
const KEY_LINE: f64 = 16.0;

/// Which joints of a machine a chart shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Moved {
    /// Those that turn, in degrees.
    Turning,
    /// Those that slide, in mm at the spindle nose.
    Sliding,
}

/// Where the joints of one kind stand over the time, a line each; where nothing is known of a pose the lines have a gap.
pub fn joints(machine: Option<&Machine>, poses: &[ToolPose], moved: Moved) -> Option<String> {
    let turns = moved == Moved::Turning;
    let shown: Vec<(usize, &str)> = machine?
        .joints
        .iter()
        .enumerate()
        .take(MAX_JOINTS)
        .filter(|(_, joint)| joint.turns == turns)
        .map(|(k, joint)| (k, joint.letter.as_str()))
        .collect();
    let end = poses.iter().map(|p| f64::from(p.time_min)).filter(|t| t.is_finite()).fold(0.0, f64::max);
    if end <= 0.0 {
        return None;
    }
    let value = |pose: &ToolPose, joint: usize| {
        let at = f64::from(pose.at_nose[joint]);
        if turns { at.to_degrees() } else { at }
    };
    let lines: Vec<Drawn> = shown
        .iter()
        .map(|(joint, _)| thinned(poses.iter().map(|p| [f64::from(p.time_min), value(p, *joint)]), end))
        .collect();
    let mut known: Vec<f64> = lines.iter().flatten().flatten().map(|p| p[1]).collect();
    known.sort_by(f64::total_cmp);
    let (lo, hi) = if turns { (*known.first()?, *known.last()?) } else { usual(&known)? };
    // Joints that rest have some room around their line.
    let room = (0.05 * (hi - lo)).max(0.5);
    let x = Axis { lo: 0.0, hi: end, from: LEFT, to: WIDTH - RIGHT };
    let y = Axis { lo: lo - room, hi: hi + room, from: HEIGHT - BOTTOM, to: TOP + 4.0 };
    let (label, unit) = if turns {
        ("Rotary joints over the time", "joint, deg")
    } else {
        ("Slides over the time", "slide at the spindle nose, mm; far ways run out of it")
    };
    let mut out = frame(label, x, y, &x.ticks(8.0), "time, min", unit);
    for (k, (line, (_, letter))) in lines.iter().zip(&shown).enumerate() {
        let mut d = String::new();
        let mut pen_down = false;
        for point in line {
            let Some([time, at]) = point else {
                pen_down = false;
                continue;
            };
            let word = if pen_down { 'L' } else { 'M' };
            let _ = write!(d, "{word}{} {}", coordinate(x.at(*time)), coordinate(y.at(*at)));
            pen_down = true;
        }
        let look = k % LOOKS;
        let left = WIDTH - RIGHT - KEY * (shown.len() - k) as f64;
        let _ = write!(
            out,
            "<path class=\"joint j{look}\" d=\"{d}\"/><path class=\"joint j{look}\" d=\"M{left} 6h{KEY_LINE}\"/>\
             <text class=\"strong\" x=\"{}\" y=\"6\" dy=\".35em\">{}</text>",
            left + KEY_LINE + 5.0,
            escape(letter)
        );
    }
    Some(out + &base_line() + "</svg>")
}

/// Share of places at either end that may lie out of the picture, and how far beyond the others they must be, of their range: slides go
/// all the way to where tools are changed.
const FAR: f64 = 0.02;
const BEYOND: f64 = 1.0;

/// The range of values in ascending order without a few that are far off; None where there are none.
fn usual(known: &[f64]) -> Option<(f64, f64)> {
    let (first, last) = (*known.first()?, *known.last()?);
    let few = (FAR * known.len() as f64) as usize;
    let (lo, hi) = (known[few], known[known.len() - 1 - few]);
    let far = BEYOND * (hi - lo).max(1.0);
    Some((if lo - first > far { lo } else { first }, if last - hi > far { hi } else { last }))
}

/// What is drawn of a line: time and value, or a gap.
type Drawn = Vec<Option<[f64; 2]>>;

/// A stretch of time: the places with the least and the greatest value, by their numbers.
struct Slot {
    number: usize,
    least: (usize, [f64; 2]),
    most: (usize, [f64; 2]),
}

impl Slot {
    /// Both places in their order, or the one that there is.
    fn close(self, out: &mut Drawn) {
        let (a, b) =
            if self.least.0 <= self.most.0 { (self.least, self.most) } else { (self.most, self.least) };
        out.push(Some(a.1));
        if b.0 != a.0 {
            out.push(Some(b.1));
        }
    }
}

/// Of values over the time up to `end` the least and the greatest of each stretch, in their order; a gap where some are not known.
fn thinned(all: impl Iterator<Item = [f64; 2]>, end: f64) -> Drawn {
    let mut out = Drawn::new();
    let mut open: Option<Slot> = None;
    for (n, point) in all.enumerate() {
        if !point.iter().all(|x| x.is_finite()) {
            if let Some(slot) = open.take() {
                slot.close(&mut out);
                out.push(None);
            }
            continue;
        }
        let number = (point[0] / end * JOINT_SLOTS as f64) as usize;
        let own = (n, point);
        match &mut open {
            Some(slot) if slot.number == number => {
                if point[1] < slot.least.1[1] {
                    slot.least = own;
                }
                if point[1] > slot.most.1[1] {
                    slot.most = own;
                }
            }
            _ => {
                if let Some(slot) = open.replace(Slot { number, least: own, most: own }) {
                    slot.close(&mut out);
                }
            }
        }
    }
    if let Some(slot) = open {
        slot.close(&mut out);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::machine::Joint;
    use super::*;

    fn joint(letter: &str, turns: bool) -> Joint {
        let (direction, point_mm) = ([0.0, 0.0, 1.0], [0.0; 3]);
        Joint { letter: letter.into(), turns, of_table: turns, direction, point_mm }
    }

    fn machine() -> Machine {
        let joints =
            [("X", false), ("Y", false), ("Z", false), ("A", true), ("<C>", true)].map(|(l, t)| joint(l, t));
        Machine { joints: joints.to_vec(), ..Machine::default() }
    }

    /// A pose a tenth of a minute: A swings by a radian, C turns on by one a pose.
    fn poses(count: u32) -> Vec<ToolPose> {
        let pose = |k: u32| {
            let t = k as f32;
            ToolPose {
                tip_mm: [0.0; 3],
                axis: [0.0, 0.0, 1.0],
                time_min: 0.1 * t,
                pass: None,
                tool: 0,
                line: k,
                setup: 0,
                at_nose: [t, -t, 40.0, t.sin(), t],
            }
        };
        (0..count).map(pose).collect()
    }

    #[test]
    fn without_places_there_is_no_chart() {
        let (machine, poses) = (machine(), poses(20));
        for moved in [Moved::Turning, Moved::Sliding] {
            assert!(joints(None, &poses, moved).is_none());
            assert!(joints(Some(&machine), &[], moved).is_none());
            assert!(joints(Some(&machine), &poses[..1], moved).is_none(), "no time goes by");
            let unknown = |p: &ToolPose| ToolPose { at_nose: [f32::NAN; MAX_JOINTS], ..*p };
            let unknown: Vec<ToolPose> = poses.iter().map(unknown).collect();
            assert!(joints(Some(&machine), &unknown, moved).is_none());
        }
        let slides = Machine { joints: machine.joints[..3].to_vec(), ..Machine::default() };
        assert!(joints(Some(&slides), &poses, Moved::Turning).is_none());
        assert!(joints(Some(&slides), &poses, Moved::Sliding).is_some());
    }

    #[test]
    fn each_joint_has_a_line_and_a_word_in_the_legend() {
        let text = joints(Some(&machine()), &poses(20), Moved::Turning).expect("two joints");
        assert_eq!(text.matches("class=\"joint j0\"").count(), 2);
        assert_eq!(text.matches("class=\"joint j1\"").count(), 2);
        assert!(text.contains(">A</text>") && text.contains(">&lt;C&gt;</text>") && !text.contains(">X<"));
        assert!(text.contains("joint, deg") && text.contains("time, min"));
        // C ends at 19 rad, which is beyond the tick at 1000 degrees.
        assert!(text.contains(">1000</text>"), "{text}");
        let text = joints(Some(&machine()), &poses(20), Moved::Sliding).expect("three slides");
        assert!(text.contains("j2") && text.contains("nose, mm;") && text.contains(">40</text>"), "{text}");
    }

    /// The last way to where tools are changed does not flatten what is cut; a joint that turns far shows it.
    #[test]
    fn slides_that_go_far_leave_the_picture_and_turns_do_not() {
        let mut away = poses(200);
        away[199].at_nose = [0.0, 0.0, 3000.0, 60.0, 0.0];
        let text = joints(Some(&machine()), &away, Moved::Sliding).expect("three slides");
        assert!(text.contains(">200</text>") && !text.contains("000</text>"), "{text}");
        let text = joints(Some(&machine()), &away, Moved::Turning).expect("two joints");
        assert!(text.contains(">10\u{2009}000</text>"), "{text}");
    }

    #[test]
    fn of_many_places_the_least_and_the_greatest_of_each_stretch_stay() {
        let all = |n: u32| (0..n).map(|k| [f64::from(k), f64::from(k * k % 977)]);
        let kept = thinned(all(60_000), 59_999.0);
        assert!(kept.len() <= 2 * (JOINT_SLOTS + 1), "{}", kept.len());
        let known = || kept.iter().flatten();
        assert!(known().zip(known().skip(1)).all(|(a, b)| a[0] < b[0]));
        let ends = |value: f64| known().any(|p| p[1] == value);
        assert!(ends(0.0) && ends(976.0));
        // A single needle is not lost.
        let needle = all(60_000).map(|[t, v]| [t, if t == 31_415.0 { 5000.0 } else { v }]);
        assert!(thinned(needle, 59_999.0).contains(&Some([31_415.0, 5000.0])));
        // Few places stay as they are, and what is not known is a gap.
        let few: Vec<_> = all(20).map(Some).collect();
        assert_eq!(thinned(all(20), 19.0), few);
        let gap = all(20).map(|[t, v]| [t, if (5.0..8.0).contains(&t) { f64::NAN } else { v }]);
        let kept = thinned(gap, 19.0);
        assert_eq!((kept[4], kept[5], kept[6]), (few[4], None, few[8]));
    }
}
