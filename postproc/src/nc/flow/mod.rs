//! In which order the lines of a text are run: subprograms, labels and loops with literal counts.
//!
//! A text goes by once, line by line. From its first label or loop on its lines are kept ([`Kept`], which [`super::names::Names`] fills before
//! the first move), so that what is called or comes again can be run where it is asked for. What the program may ask for so is bounded.

mod words;

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use self::words::{FlowWord, behind_label, flow_word};
use super::Dialect;
use super::read_error::ReadError;

/// Lines that subprograms and repeats of one text may run.
pub(super) const MOST_LINES: usize = 300_000;
/// Bytes of a text that are kept.
const MOST_BYTES: usize = 1 << 26;
/// Subprograms and repeats within each other.
const DEEPEST: usize = 16;

/// The lines of a text from its first label or loop on.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Kept {
    lines: Vec<String>,
    bytes: usize,
    /// Lines seen.
    seen: usize,
    /// Number of the first line kept, from 1.
    first: usize,
    /// Names of places: their first line, as index of `lines`.
    labels: BTreeMap<String, usize>,
    /// It was too long to be kept.
    over: bool,
    /// Something stands before its first label.
    begun: bool,
}

impl Kept {
    /// One line of the text.
    pub fn line(&mut self, line: &str, dialect: Dialect) {
        self.seen += 1;
        if self.over {
            return;
        }
        let word = flow_word(line, dialect);
        if self.first == 0 {
            let iso = matches!(dialect, Dialect::Fanuc | Dialect::LinuxCnc);
            let begins = match word {
                // A text begins with its own name, which nothing in it needs.
                Some(FlowWord::Label(_)) => self.begun || !iso,
                Some(FlowWord::Sub(_) | FlowWord::Times { .. } | FlowWord::While { .. }) => true,
                _ => false,
            };
            let text = line.trim_start();
            self.begun |= !(text.is_empty() || text.starts_with(['%', '(', ';']));
            if !begins {
                return;
            }
            self.first = self.seen;
        }
        if let Some(FlowWord::Label(name) | FlowWord::Sub(name)) = word {
            let at = self.lines.len();
            self.labels.entry(name).or_insert(at);
        }
        self.bytes += line.len();
        self.over = self.bytes > MOST_BYTES;
        if self.over {
            self.lines = Vec::new();
        } else {
            self.lines.push(line.to_owned());
        }
    }
}

/// A loop that is open.
#[derive(Clone, Debug)]
struct Loop {
    /// Its first line, as index of what is kept.
    at: usize,
    head: Head,
}

#[derive(Clone, Debug)]
enum Head {
    /// So many times more.
    Times(u32),
    While {
        name: String,
        test: words::Test,
    },
    /// Its head is not understood: it is run once.
    Once,
}

/// What runs a single line: its number and text; true at the end of the program.
pub(super) type Run<'r> = dyn FnMut(usize, &str) -> Result<bool, ReadError> + 'r;

/// Where a text is in its order.
#[derive(Clone, Debug)]
pub(super) struct Flow {
    dialect: Dialect,
    kept: Arc<Kept>,
    /// Loops that the text itself is in.
    loops: Vec<Loop>,
    /// Passing over a loop that is not run, or a subprogram where it stands: loops opened since.
    over: Option<(usize, bool)>,
    variables: BTreeMap<String, f64>,
    made: usize,
}

/// How a run of lines ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Ended {
    /// With its last line.
    Through,
    /// By a return.
    Back,
    /// With the end of the program.
    Program,
}

impl Flow {
    pub fn new(dialect: Dialect, kept: Arc<Kept>) -> Self {
        Self { dialect, kept, loops: Vec::new(), over: None, variables: BTreeMap::new(), made: 0 }
    }

    /// One line of the text as it goes by; true at the end of the program.
    pub fn line(&mut self, number: usize, line: &str, run: &mut Run<'_>) -> Result<bool, ReadError> {
        let Some(word) = flow_word(line, self.dialect) else {
            return if self.over.is_some() { Ok(false) } else { run(number, line) };
        };
        let mut loops = std::mem::take(&mut self.loops);
        let mut over = self.over.take();
        let at = number.checked_sub(self.kept.first).unwrap_or(usize::MAX);
        let ended = self.step((number, line, at), word, (&mut loops, &mut over), 0, run);
        (self.loops, self.over) = (loops, over);
        match ended? {
            // A return at the top: of the text itself.
            Ended::Back if self.dialect != Dialect::Heidenhain => run(number, line),
            ended => Ok(ended == Ended::Program),
        }
    }

    /// A line that steers.
    fn step(
        &mut self,
        (number, line, at): (usize, &str, usize),
        word: FlowWord,
        (loops, over): (&mut Vec<Loop>, &mut Option<(usize, bool)>),
        depth: usize,
        run: &mut Run<'_>,
    ) -> Result<Ended, ReadError> {
        let through = |ended: bool| if ended { Ended::Program } else { Ended::Through };
        if let Some((deep, sub)) = over {
            match word {
                FlowWord::Times { .. } | FlowWord::While { .. } => *deep += 1,
                FlowWord::End if *deep > 0 => *deep -= 1,
                FlowWord::End if !*sub => *over = None,
                FlowWord::Return if *sub => *over = None,
                _ => {}
            }
            return Ok(Ended::Through);
        }
        match word {
            FlowWord::Label(_) => {
                let rest = behind_label(line, self.dialect);
                if rest.trim().is_empty() { Ok(Ended::Through) } else { run(number, rest).map(through) }
            }
            FlowWord::Sub(_) => {
                *over = Some((0, true));
                Ok(Ended::Through)
            }
            FlowWord::Return => Ok(Ended::Back),
            FlowWord::Jump(word) => run(number, word).map(through),
            FlowWord::Set { name, value } => {
                match value {
                    Some(value) => {
                        self.variables.insert(name, value);
                    }
                    None => {
                        self.variables.remove(&name);
                        return run(number, line).map(through);
                    }
                }
                Ok(Ended::Through)
            }
            FlowWord::Add { name, by } => match self.variables.get_mut(&name) {
                Some(value) => {
                    *value += by;
                    Ok(Ended::Through)
                }
                None => run(number, line).map(through),
            },
            FlowWord::Times { times: 0 } => {
                *over = Some((0, false));
                Ok(Ended::Through)
            }
            FlowWord::Times { times } => {
                loops.push(Loop { at: at.saturating_add(1), head: Head::Times(times - 1) });
                Ok(Ended::Through)
            }
            FlowWord::While { name, test } => {
                let Some(value) = self.variables.get(&name) else {
                    loops.push(Loop { at: at.saturating_add(1), head: Head::Once });
                    return run(number, line).map(through);
                };
                if test.holds(*value) {
                    loops.push(Loop { at: at.saturating_add(1), head: Head::While { name, test } });
                } else {
                    *over = Some((0, false));
                }
                Ok(Ended::Through)
            }
            FlowWord::End => match loops.pop() {
                Some(open) => self.around(number, line, &open, at, depth, run),
                None => run(number, line).map(through),
            },
            FlowWord::Call { name, times } => {
                // From its label to the return.
                let Some(first) = self.kept.labels.get(&name).map(|l| l + 1) else {
                    return run(number, line).map(through);
                };
                let end = self.kept.lines.len();
                self.again(number, (first..end, times), true, depth, run)
            }
            FlowWord::RepeatToHere { from, times } => match self.kept.labels.get(&from) {
                Some(first) if *first < at => {
                    let range = first + 1..at;
                    self.again(number, (range, times), false, depth, run)
                }
                _ => run(number, line).map(through),
            },
            FlowWord::RepeatLine { from, times } => match self.kept.labels.get(&from) {
                Some(first) => {
                    let range = *first..first + 1;
                    self.again(number, (range, times), false, depth, run)
                }
                None => run(number, line).map(through),
            },
            FlowWord::RepeatPart { from, to, times } => match self.part(&from, to.as_deref(), at) {
                Some(range) => self.again(number, (range, times), false, depth, run),
                None => run(number, line).map(through),
            },
        }
    }

    /// From a label to another one, to `ENDLABEL`, or to here.
    fn part(&self, from: &str, to: Option<&str>, here: usize) -> Option<Range<usize>> {
        let first = *self.kept.labels.get(from)?;
        let end = match to {
            Some(to) => *self.kept.labels.get(to)? + 1,
            None => match self.kept.labels.get("ENDLABEL") {
                Some(end) if *end > first => *end,
                _ => here,
            },
        };
        // The repeat itself is not among what it repeats.
        (first < end && !(first..end).contains(&here)).then_some(first..end)
    }

    /// A loop comes to its end: again from its first line, as often as its head says.
    fn around(
        &mut self,
        number: usize,
        line: &str,
        open: &Loop,
        end: usize,
        depth: usize,
        run: &mut Run<'_>,
    ) -> Result<Ended, ReadError> {
        if self.kept.over || end > self.kept.lines.len() || open.at > end {
            return run(number, line).map(|ended| if ended { Ended::Program } else { Ended::Through });
        }
        match &open.head {
            Head::Once => run(number, line).map(|ended| if ended { Ended::Program } else { Ended::Through }),
            Head::Times(times) => self.again(number, (open.at..end, *times), false, depth, run),
            Head::While { name, test } => {
                while self.variables.get(name).is_some_and(|v| test.holds(*v)) {
                    match self.again(number, (open.at..end, 1), false, depth, run)? {
                        Ended::Through => {}
                        ended => return Ok(ended),
                    }
                }
                Ok(Ended::Through)
            }
        }
    }

    /// Lines that are kept, so often.
    fn again(
        &mut self,
        number: usize,
        (range, times): (Range<usize>, u32),
        is_sub: bool,
        depth: usize,
        run: &mut Run<'_>,
    ) -> Result<Ended, ReadError> {
        if depth == DEEPEST {
            return Err(ReadError::Repeats {
                line: number,
                what: "calls and repeats within each other",
                most: DEEPEST,
            });
        }
        for _ in 0..times {
            let ended = self.run_lines((number, is_sub), range.clone(), depth + 1, run)?;
            match ended {
                Ended::Program => return Ok(ended),
                Ended::Back if !is_sub => return Ok(ended),
                Ended::Through if is_sub => return Err(ReadError::NoReturn { line: number }),
                _ => {}
            }
        }
        Ok(Ended::Through)
    }

    fn run_lines(
        &mut self,
        (caller, is_sub): (usize, bool),
        range: Range<usize>,
        depth: usize,
        run: &mut Run<'_>,
    ) -> Result<Ended, ReadError> {
        let kept = Arc::clone(&self.kept);
        let (mut loops, mut over) = (Vec::new(), None);
        // An empty range costs its turns too.
        self.count(caller)?;
        for at in range {
            self.count(caller)?;
            let (number, line) = (kept.first + at, kept.lines[at].as_str());
            let ended = match flow_word(line, self.dialect) {
                Some(word) => self.step((number, line, at), word, (&mut loops, &mut over), depth, run)?,
                None if over.is_some() => Ended::Through,
                None if run(number, line)? => Ended::Program,
                None => Ended::Through,
            };
            // LBL 0 says nothing where no subprogram is run.
            let passed = ended == Ended::Back && !is_sub && self.dialect == Dialect::Heidenhain;
            if ended != Ended::Through && !passed {
                return Ok(ended);
            }
        }
        Ok(Ended::Through)
    }

    fn count(&mut self, line: usize) -> Result<(), ReadError> {
        self.made += 1;
        if self.made > MOST_LINES {
            return Err(ReadError::Repeats {
                line,
                what: "lines run by calls and repeats",
                most: MOST_LINES,
            });
        }
        Ok(())
    }
}
