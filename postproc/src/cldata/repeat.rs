//! `INDEX/n ... COPY/n`: statements are kept while an index is open and made again where it is copied.
//!
//! A copy repeats the points as they came: units, `TRACUT/` and the tool's place and axis are those of its index. Feed, speed and coolant go on
//! from where the statements before have left them, as they do in a CL file that is written out. Copies within copies are copied with them.
//! `INDEX/n,NOMORE` closes an index.

use osculate_geom::Diagnostic;

use super::error::ClReadError;
use super::fields::place;
use super::placing::{Mark, Reckoning};
use super::read::{ClReader, Taken};
use super::statement::{Item, Statement};
use super::transform::{self, Copy, Transform, Why};

/// Statements that are kept for copies, and moves or statements that one copy may ask for.
const MOST: usize = 500_000;
/// Copies within copies.
const DEEPEST: usize = 10;

/// Whether the first point is come to on an arc; `None` where a statement makes no point.
fn begins_round(item: &Item) -> Option<bool> {
    match item {
        Item::Goto { .. } => Some(false),
        Item::Other(s) => match s.word.as_str() {
            "GOTO" | "GODLTA" | "FROM" => Some(false),
            "CIRCLE" | "MOVARC" => Some(true),
            word => word.ends_with("GOFWD").then_some(true),
        },
    }
}

impl ClReader {
    /// A statement of the text, kept where an index is open.
    pub(super) fn item(&mut self, item: Item) -> Result<(), ClReadError> {
        let line = match &item {
            Item::Goto { line, .. } => *line,
            Item::Other(s) => s.line,
        };
        if !self.placing.marks.is_empty() {
            if self.placing.kept.len() == MOST {
                let (count, most) = (MOST as f64 + 1.0, MOST as f64);
                return Err(ClReadError::Bound { line, what: "what stands since INDEX/", count, most });
            }
            self.placing.kept.push(item.clone());
        }
        match item {
            Item::Other(s) if s.word == "INDEX" => self.index(&s),
            Item::Other(s) if s.word == "COPY" => {
                self.placing.made = 0;
                let done = self.copy(&s)?;
                if let Err(why) = done {
                    self.lose(s.line, &s.word, why);
                }
            }
            item => self.execute(item)?,
        }
        if self.placing.marks.is_empty() {
            self.placing.kept.clear();
        }
        Ok(())
    }

    fn lose(&mut self, line: usize, word: &str, why: Why) {
        let text = format!("{word}/ is not interpreted and may change the tool's way: {why}");
        self.diagnostics.push(Diagnostic::loss(place(line), text));
    }

    fn reckoning(&self) -> Reckoning {
        let tracut = self.placing.tracut;
        Reckoning { unit_mm: self.unit_mm, tracut, axis: self.axis, tip: self.tip }
    }

    fn reckon(&mut self, from: &Reckoning) {
        (self.unit_mm, self.axis, self.tip) = (from.unit_mm, from.axis, from.tip);
        self.placing.tracut = from.tracut;
        self.placing.settle();
    }

    fn index(&mut self, s: &Statement) {
        let Some(name) = s.fields.first() else { return self.lose(s.line, &s.word, "it has no number") };
        if s.fields.len() > 1 {
            self.placing.marks.retain(|m| m.name != *name);
            return;
        }
        if self.placing.marks.len() == DEEPEST {
            return self.lose(s.line, &s.word, "ten are open already");
        }
        let mark =
            Mark { name: name.clone(), at: self.placing.kept.len(), tool: None, reckoning: self.reckoning() };
        self.placing.marks.push(mark);
        self.other(&s.word, s.line, Taken::Harmless);
    }

    /// `COPY/` in the text.
    fn copy(&mut self, s: &Statement) -> Result<Result<(), Why>, ClReadError> {
        self.open_arc()?;
        let copy = match transform::copy(s, self.unit_mm)? {
            Ok(copy) => copy,
            Err(why) => return Ok(Err(why)),
        };
        let Some(mark) = self.placing.marks.pop_if(|m| m.name == copy.name) else {
            return Ok(Err("no INDEX/ with its number is the last one open"));
        };
        if mark.tool.is_some() {
            return Ok(Err("another tool is called since its INDEX/"));
        }
        // The statement itself is the last one kept.
        let range = mark.at..self.placing.kept.len() - 1;
        if self.placing.kept[range.clone()].iter().find_map(begins_round) == Some(true) {
            return Ok(Err("what it repeats begins with an arc"));
        }
        self.times(s.line, &copy, &mark.reckoning, range)?;
        self.other(&s.word, s.line, Taken::Copied);
        Ok(Ok(()))
    }

    /// Makes a range of what is kept as often as a copy asks for.
    fn times(
        &mut self,
        line: usize,
        copy: &Copy,
        from: &Reckoning,
        range: std::ops::Range<usize>,
    ) -> Result<(), ClReadError> {
        let mut placed = Transform::identity();
        for _ in 0..copy.times {
            placed = copy.step.after(&placed);
            self.placing.copies.push(placed);
            self.reckon(from);
            self.again(line, range.clone())?;
            self.placing.copies.pop();
        }
        self.placing.settle();
        Ok(())
    }

    /// Makes a range of what is kept once more; copies in it are found again.
    fn again(&mut self, line: usize, range: std::ops::Range<usize>) -> Result<(), ClReadError> {
        let mut open: Vec<(String, usize, Reckoning)> = Vec::new();
        for k in range {
            self.placing.made += 1;
            let count = self.placing.made.max(self.path.moves.len());
            if count > MOST {
                return Err(ClReadError::Bound {
                    line,
                    what: "COPY/",
                    count: count as f64,
                    most: MOST as f64,
                });
            }
            match self.placing.kept[k].clone() {
                Item::Other(s) if s.word == "INDEX" => {
                    let name = s.fields.first().cloned().unwrap_or_default();
                    if s.fields.len() > 1 {
                        open.retain(|o| o.0 != name);
                    } else {
                        open.push((name, k + 1, self.reckoning()));
                    }
                }
                Item::Other(s) if s.word == "COPY" => {
                    self.open_arc()?;
                    // One that could not be made the first time has been told.
                    let Ok(copy) = transform::copy(&s, self.unit_mm)? else { continue };
                    if let Some((_, at, from)) = open.pop_if(|o| o.0 == copy.name) {
                        self.times(line, &copy, &from, at..k)?;
                    }
                }
                item => self.execute(item)?,
            }
        }
        self.open_arc()
    }

    /// `TRACUT/`.
    pub(super) fn tracut(&mut self, s: &Statement) -> Result<(), ClReadError> {
        self.open_arc()?;
        match transform::tracut(s, self.unit_mm)? {
            Ok(tracut) => {
                self.placing.tracut = tracut;
                self.placing.settle();
                self.other(&s.word, s.line, Taken::Placed);
            }
            Err(why) => self.lose(s.line, &s.word, why),
        }
        Ok(())
    }
}
