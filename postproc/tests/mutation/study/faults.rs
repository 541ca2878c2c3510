//! Faults: changes to a program's text, to what the reader is told of the machine, or to the tool.

use super::programs::{Good, Tool};
use osculate_geom::Vec3;
use osculate_postproc::{Dialect, Setup};
use osculate_tools::{Cutter, CutterSpec};

/// A generator good enough to choose faults (Knuth's constants).
pub struct Dice(u64);

impl Dice {
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }
    pub fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % n.max(1)
    }
}

/// One fault.
pub struct Fault {
    pub kind: &'static str,
    /// What was changed.
    pub note: String,
    pub text: String,
    pub setup: Setup,
    pub cutter: Cutter,
    /// By how much the cutter is larger than programmed for, mm.
    pub larger_mm: f64,
}

/// What can go wrong.
pub const KINDS: [&str; 16] = [
    "digit",
    "last digit",
    "word left out",
    "line left out",
    "lines left out",
    "line twice",
    "lines swapped",
    "sign",
    "decimal point",
    "rapid for feed",
    "slower feed",
    "comment",
    "garbled word",
    "gauge length",
    "part zero",
    "tool radius",
];

/// Sizes of what the reader is told wrongly, mm.
const OFF: [f64; 4] = [0.001, 0.02, 0.05, 0.3];
const AXES: [&str; 6] = ["X", "Y", "Z", "A", "B", "C"];

/// Lines of the text that name axes.
fn cutting(text: &str) -> Vec<usize> {
    let has = |l: &str| AXES.iter().any(|a| word(l, a).is_some());
    text.lines().enumerate().filter(|(_, l)| has(l)).map(|(k, _)| k).collect()
}

/// The place of an axis word's number in a line.
fn word(line: &str, axis: &str) -> Option<(usize, usize)> {
    let bytes = line.as_bytes();
    let digit = |k: usize| bytes.get(k).is_some_and(|b| b.is_ascii_digit() || b"+-.".contains(b));
    for (k, _) in line.match_indices(axis) {
        let alone = k == 0 || !bytes[k - 1].is_ascii_alphanumeric();
        let mut from = k + axis.len();
        if bytes.get(from) == Some(&b'=') {
            from += 1;
        }
        if alone && digit(from) {
            let to = (from..bytes.len()).take_while(|j| digit(*j)).count() + from;
            return Some((from, to));
        }
    }
    None
}

/// A fault of this kind at a line and axis that the dice choose; None where there is nothing to change there.
pub fn fault(g: &Good, kind: &'static str, dice: &mut Dice) -> Option<Fault> {
    let mut lines: Vec<String> = g.text.lines().map(str::to_owned).collect();
    let spots = cutting(&g.text);
    let k = spots[spots.len() / 8 + dice.below(spots.len() * 3 / 4)];
    let before = lines[k].clone();
    // Faults along a pass do little: those of height and axis are tried more often.
    let axis = ["X", "Y", "Z", "Z", "A", "B", "C"][dice.below(7)];
    let (mut setup, mut cutter, mut larger_mm) = (g.setup, g.cutter, 0.0);
    let mut note = None;
    match kind {
        "digit" | "last digit" => {
            let (from, to) = word(&before, axis)?;
            let digits: Vec<usize> = (from..to).filter(|j| before.as_bytes()[*j].is_ascii_digit()).collect();
            let at = if kind == "digit" { digits[dice.below(digits.len())] } else { *digits.last()? };
            let old = before.as_bytes()[at];
            let new = b'0' + (old - b'0' + 1 + dice.below(9) as u8) % 10;
            lines[k].replace_range(at..=at, &char::from(new).to_string());
        }
        "word left out" => {
            let (from, to) = word(&before, axis)?;
            let letter = before[..from].rfind(axis)?;
            lines[k].replace_range(letter..to, "");
        }
        "line left out" => {
            lines.remove(k);
        }
        "lines left out" => {
            lines.drain(k..(k + 6).min(lines.len()));
        }
        "line twice" => lines.insert(k, before.clone()),
        "lines swapped" => {
            let other = *spots.iter().find(|s| **s > k)?;
            lines.swap(k, other);
        }
        "sign" => {
            let (from, _) = word(&before, axis)?;
            match before.as_bytes()[from] {
                b'-' => lines[k].replace_range(from..=from, ""),
                b'+' => lines[k].replace_range(from..=from, "-"),
                _ => lines[k].insert(from, '-'),
            }
        }
        "decimal point" => {
            // A rotary axis would go round thousands of times.
            let linear = ["X", "Y", "Z"][dice.below(3)];
            let (from, to) = word(&before, linear)?;
            let point = before[from..to].find('.')? + from;
            lines[k].remove(point);
        }
        "rapid for feed" => {
            if g.recipe.dialect == Dialect::Heidenhain {
                let cut = before.find(" F").unwrap_or(before.len());
                lines[k] = format!("{} FMAX", &before[..cut]);
            } else if before.contains("G1") {
                lines[k] = before.replacen("G1", "G0", 1);
            } else {
                let (from, _) = AXES.iter().filter_map(|a| word(&before, a)).min()?;
                let letter = before[..from].rfind(|c: char| c.is_ascii_alphabetic())?;
                lines[k].insert_str(letter, "G0 ");
            }
        }
        "slower feed" => {
            let (from, to) = word(&before, "F")?;
            lines[k].replace_range(from..to, "123.");
        }
        "comment" => {
            let text = match g.recipe.dialect {
                Dialect::Sinumerik | Dialect::Heidenhain => "; a remark",
                Dialect::Fanuc | Dialect::LinuxCnc => "(A REMARK)",
            };
            lines[k].push(' ');
            lines[k].push_str(text);
        }
        "garbled word" => {
            // A letter O for the digit.
            let (from, to) = word(&before, axis)?;
            let at = (from..to).find(|j| before.as_bytes()[*j].is_ascii_digit())?;
            lines[k].replace_range(at..=at, "O");
        }
        "gauge length" => {
            let off = OFF[dice.below(OFF.len())];
            setup.gauge_length_mm += off;
            note = Some(format!("{off} mm longer"));
        }
        "part zero" => {
            let off = OFF[dice.below(OFF.len())];
            let to = [Vec3::x(), Vec3::y(), -Vec3::z()][dice.below(3)] * off;
            setup.part_zero.translation.vector += to;
            note = Some(format!("off by ({}, {}, {}) mm", to.x, to.y, to.z));
        }
        _ => {
            larger_mm = OFF[dice.below(OFF.len())];
            let (diameter_mm, length_mm) = (2.0 * (cutter.radius_mm() + larger_mm), cutter.length_mm());
            let spec = match g.recipe.tool {
                Tool::Ball => CutterSpec::Ball { diameter_mm, length_mm },
                Tool::Toroidal => {
                    CutterSpec::Toroidal { diameter_mm, corner_radius_mm: cutter.corner_mm(), length_mm }
                }
            };
            cutter = Cutter::try_from(spec).ok()?;
            note = Some(format!("{larger_mm} mm larger"));
        }
    }
    let note = note.unwrap_or_else(|| {
        format!("line {}: {} -> {}", k + 1, before.trim(), lines.get(k).map_or("", |l| l.trim()))
    });
    Some(Fault { kind, note, text: lines.join("\n") + "\n", setup, cutter, larger_mm })
}
