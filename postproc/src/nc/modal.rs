//! Words of moves with what is still in force left out.

use super::block::{FeedWord, NcMove, Program, RotaryName};
use super::number;
use super::orientation::VECTOR_DECIMALS;

/// How a dialect words a move.
pub(super) struct Wording {
    /// Rapid and feed; repeated only on change where the dialect is modal in it.
    pub rapid: &'static str,
    /// Word of a feed move.
    pub feed: &'static str,
    /// The two words above hold until changed.
    pub modal: bool,
    /// A position word.
    pub axis: fn(text: &mut String, name: &str, position: Position),
    /// A rotary position word.
    pub rotary: fn(text: &mut String, name: &RotaryName, counts: i64),
    /// Names of the components of the tool's direction, and whether a plus stands before them.
    pub vector: ([&'static str; 3], bool),
}

/// A position with the decimals in which it is written.
#[derive(Clone, Copy, Debug)]
pub(super) struct Position {
    pub counts: i64,
    pub decimals: usize,
}

impl Position {
    /// Of a rotary axis: inside one turn where it turns without end and the control takes the shortest way.
    pub fn of(name: &RotaryName, counts: i64) -> Self {
        let counts = if name.endless { in_turn(counts) } else { counts };
        Self { counts, decimals: name.decimals }
    }
}

/// What is in force.
#[derive(Default)]
pub(super) struct Modal {
    rapid: Option<bool>,
    linear: [Option<i64>; 3],
    rotary: [Option<i64>; 2],
    orientation: Option<[i64; 3]>,
    feed: String,
    spare: String,
    /// Linear and rotary words in the order of their names.
    order: ([usize; 3], Vec<usize>),
}

impl Modal {
    /// Nothing is in force.
    pub fn new(program: &Program) -> Self {
        let mut linear = [0, 1, 2];
        linear.sort_by_key(|&i| &program.linear_names[i]);
        let mut rotary: Vec<usize> = (0..program.rotary_names.len()).collect();
        rotary.sort_by_key(|&i| &program.rotary_names[i].letter);
        Self { order: (linear, rotary), ..Self::default() }
    }

    /// Adds the words of the axes that change to `m`, linear ones in the order of their names, then rotary ones.
    fn axes(&mut self, program: &Program, wording: &Wording, m: &NcMove, out: (Which, &mut String)) {
        let (which, text) = out;
        if which != Which::Rotary {
            for i in self.order.0 {
                let name = &program.linear_names[i];
                let skipped = match which {
                    Which::Across => m.along == Some(i),
                    Which::Along => m.along != Some(i),
                    _ => false,
                };
                if !skipped && self.linear[i] != Some(m.linear[i]) {
                    self.linear[i] = Some(m.linear[i]);
                    text.push(' ');
                    let (counts, decimals) = (m.linear[i], program.linear_decimals[i]);
                    (wording.axis)(text, name, Position { counts, decimals });
                }
            }
        }
        let vectors = program.in_vectors();
        // Where nothing is modal (LN), a direction stands in every block.
        let turned = self.orientation != Some(m.orientation) || !wording.modal;
        if vectors && which == Which::All && turned {
            let (names, plus) = wording.vector;
            for (name, c) in names.iter().zip(m.orientation) {
                text.push(' ');
                text.push_str(name);
                if plus && c >= 0 {
                    text.push('+');
                }
                number::push_count(text, c, VECTOR_DECIMALS);
            }
        }
        self.orientation = Some(m.orientation);
        if which == Which::Rotary || (which == Which::All && !vectors) {
            for &i in &self.order.1 {
                if self.rotary[i] != Some(m.rotary[i]) {
                    self.rotary[i] = Some(m.rotary[i]);
                    text.push(' ');
                    (wording.rotary)(text, &program.rotary_names[i], m.rotary[i]);
                }
            }
        }
    }

    /// After positions in the machine's own coordinates.
    pub fn forget(&mut self) {
        (self.rapid, self.linear) = (None, [None; 3]);
    }

    fn motion(&mut self, wording: &Wording, rapid: bool, text: &mut String) {
        if self.rapid != Some(rapid) || !wording.modal {
            text.push_str(if rapid { wording.rapid } else { wording.feed });
            self.rapid = Some(rapid);
        }
    }

    /// Adds one whole move with a blank before every word; nothing where nothing moves.
    pub fn block(&mut self, program: &Program, wording: &Wording, m: &NcMove, text: &mut String) {
        let start = text.len();
        let before = self.rapid;
        text.push(' ');
        self.motion(wording, m.rapid, text);
        let words = text.len();
        if words == start + 1 {
            text.truncate(start);
        }
        let words = text.len();
        self.axes(program, wording, m, (Which::All, text));
        if text.len() == words {
            self.rapid = before;
            text.truncate(start);
            return;
        }
        if !m.rapid {
            self.spare.clear();
            number::push_feed(&mut self.spare, m.feed);
            if program.feed_word == FeedWord::Inverse || self.feed != self.spare {
                text.push_str(" F");
                text.push_str(&self.spare);
                std::mem::swap(&mut self.feed, &mut self.spare);
            }
        }
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
            let mut axes = String::new();
            self.axes(program, wording, m, (*part, &mut axes));
            if axes.is_empty() {
                continue;
            }
            let mut line = String::new();
            self.motion(wording, true, &mut line);
            line.push_str(&axes);
            lines.push(line.trim_start().to_string());
        }
        lines
    }
}

/// Which axes a block names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Which {
    /// All.
    All,
    /// Rotary ones.
    Rotary,
    /// Linear ones other than the one that goes most along the tool.
    Across,
    /// That one.
    Along,
}

/// `X1.0000`, or `CA1=1.0000` where the name ends with a digit.
pub(super) fn plain(text: &mut String, name: &str, position: Position) {
    text.push_str(name);
    if name.len() > 1 {
        text.push('=');
    }
    number::push_rounded(text, position.counts, position.decimals);
}

/// Position of an endless axis inside one turn.
fn in_turn(counts: i64) -> i64 {
    // A turn in counts; the product of two small integers is exact.
    counts.rem_euclid(360 * 10_000)
}
