//! Words of moves with what is still in force left out.

use super::block::{FeedWord, NcMove, Program, RotaryName};
use super::number;

/// How a dialect words a move.
pub(super) struct Wording {
    /// Rapid and feed; repeated only on change where the dialect is modal in it.
    pub rapid: &'static str,
    /// Word of a feed move.
    pub feed: &'static str,
    /// The two words above hold until changed.
    pub modal: bool,
    /// A position word.
    pub axis: fn(name: &str, counts: i64) -> String,
    /// A rotary position word.
    pub rotary: fn(name: &RotaryName, counts: i64) -> String,
}

/// What is in force.
#[derive(Default)]
pub(super) struct Modal {
    rapid: Option<bool>,
    linear: [Option<i64>; 3],
    rotary: [Option<i64>; 2],
    feed: Option<String>,
}

impl Modal {
    /// Words of the axes that change to `m`, linear ones in the order of their names, then rotary ones likewise.
    pub fn axes(&mut self, program: &Program, wording: &Wording, m: &NcMove, which: Which) -> Vec<String> {
        let mut words = Vec::new();
        if which != Which::Rotary {
            let mut order = [0, 1, 2];
            order.sort_by_key(|&i| &program.linear_names[i]);
            for i in order {
                let name = &program.linear_names[i];
                let skipped = match which {
                    Which::Across => name == "Z",
                    Which::Along => name != "Z",
                    _ => false,
                };
                if !skipped && self.linear[i] != Some(m.linear[i]) {
                    self.linear[i] = Some(m.linear[i]);
                    words.push((wording.axis)(name, m.linear[i]));
                }
            }
        }
        if matches!(which, Which::All | Which::Rotary) {
            let mut order: Vec<usize> = (0..program.rotary_names.len()).collect();
            order.sort_by_key(|&i| &program.rotary_names[i].letter);
            for i in order {
                if self.rotary[i] != Some(m.rotary[i]) {
                    self.rotary[i] = Some(m.rotary[i]);
                    words.push((wording.rotary)(&program.rotary_names[i], m.rotary[i]));
                }
            }
        }
        words
    }

    /// One whole move; empty where nothing moves.
    pub fn block(&mut self, program: &Program, wording: &Wording, m: &NcMove) -> String {
        let axes = self.axes(program, wording, m, Which::All);
        if axes.is_empty() {
            return String::new();
        }
        let mut words = Vec::new();
        if self.rapid != Some(m.rapid) || !wording.modal {
            words.push(if m.rapid { wording.rapid } else { wording.feed }.to_string());
            self.rapid = Some(m.rapid);
        }
        words.extend(axes);
        if !m.rapid {
            let feed = number::feed(m.feed);
            if program.feed_word == FeedWord::Inverse || self.feed.as_ref() != Some(&feed) {
                words.push(format!("F{feed}"));
                self.feed = Some(feed);
            }
        }
        words.join(" ")
    }

    /// Blocks that reach the first pose from above: rotary axes, then across the spindle, then along it.
    pub fn approach(
        &mut self,
        program: &Program,
        wording: &Wording,
        m: &NcMove,
        which: &[Which],
    ) -> Vec<String> {
        let mut lines = Vec::new();
        for part in which {
            let axes = self.axes(program, wording, m, *part);
            if axes.is_empty() {
                continue;
            }
            let mut words = Vec::new();
            if self.rapid != Some(true) || !wording.modal {
                words.push(wording.rapid.to_string());
                self.rapid = Some(true);
            }
            words.extend(axes);
            lines.push(words.join(" "));
        }
        lines
    }

    /// F must be said again.
    pub fn forget_feed(&mut self) {
        self.feed = None;
    }
}

/// Which axes a block names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Which {
    /// All.
    All,
    /// Rotary ones.
    Rotary,
    /// Linear ones other than Z.
    Across,
    /// Z.
    Along,
}

/// `X1.0000`, or `CA1=1.0000` where the name ends with a digit.
pub(super) fn plain(name: &str, counts: i64) -> String {
    let equals = if name.len() > 1 { "=" } else { "" };
    format!("{name}{equals}{}", number::fixed(counts))
}

/// Position of an endless axis inside one turn.
pub(super) fn in_turn(counts: i64) -> i64 {
    // A turn in counts; the product of two small integers is exact.
    counts.rem_euclid(360 * 10_000)
}
