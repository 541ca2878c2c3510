//! What has been said of the tool comes into force at the next point: another section, or words between the moves of the one at hand.

use osculate_geom::Diagnostic;

use super::fields::place;
use super::read::ClReader;
use super::section::{ClSection, ClTool};
use crate::auxiliary::{Auxiliary, AuxiliaryWord, Spindle};

impl ClReader {
    /// The tools so far, each with its moves.
    #[must_use]
    pub fn sections(&self) -> &[ClSection] {
        &self.sections
    }

    /// A tool call waits for its first point.
    pub(super) const fn waits_for_tool(&self) -> bool {
        self.said.loaded.is_some()
    }

    /// Before a point: what has been said comes into force.
    pub(super) fn settle(&mut self, line: usize) {
        if !(self.said.changed || self.sections.is_empty()) {
            return;
        }
        self.said.changed = false;
        let loaded = self.said.loaded.take();
        let mut tool = self.said.tool;
        if loaded.is_some() && !self.said.cutter {
            // Loaded again a tool is what it was.
            let known = self.sections.iter().rfind(|s| s.tool.number == tool.number);
            tool.cutter = known.and_then(|s| s.tool.cutter);
            self.said.tool.cutter = tool.cutter;
        }
        let another = |section: &ClSection| {
            let cut =
                section.tool.number.is_some() || section.tool.cutter.is_some_and(|c| Some(c) != tool.cutter);
            cut && section.tool.number != tool.number
        };
        if let Some(section) = self.sections.last_mut()
            && !(loaded.is_some() && another(section))
        {
            if section.tool.number.is_none() && loaded.is_some() {
                (section.line, section.tool.number) = (loaded.unwrap_or(line), tool.number);
            }
            self.go_on(&tool);
        } else {
            self.said.in_force = tool;
            let line = loaded.unwrap_or(line);
            self.sections.push(ClSection {
                line,
                tool,
                moves: 0,
                begins_at_feed: false,
                auxiliary: Vec::new(),
                lines: Vec::new(),
            });
            self.said.cutter = false;
        }
        for (line, word) in std::mem::take(&mut self.said.waiting) {
            self.say(line, word);
        }
    }

    /// The same tool goes on.
    fn go_on(&mut self, tool: &ClTool) {
        let Some(section) = self.sections.last_mut() else { return };
        let [spindle_line, coolant_line, cutter_line] = self.said.lines;
        match (section.tool.cutter, tool.cutter) {
            (None, cutter) => section.tool.cutter = cutter,
            (Some(before), Some(after)) if before != after => {
                let text = "another CUTTER/ on the way without a LOADTL/: the cutter stays what it was";
                self.diagnostics.push(Diagnostic::loss(place(cutter_line), text));
                self.said.tool.cutter = Some(before);
            }
            _ => {}
        }
        let unknown = self.said.in_force.spindle.is_none();
        if unknown {
            section.tool.spindle = tool.spindle;
        }
        if let Some(next) = tool.spindle.filter(|s| !unknown && self.said.in_force.spindle != Some(*s)) {
            self.say(spindle_line, AuxiliaryWord::Spindle(next));
        }
        if self.said.in_force.coolant != tool.coolant {
            self.say(coolant_line, AuxiliaryWord::Coolant(tool.coolant));
        }
        self.said.in_force = *tool;
    }

    /// Something to be done before the next move.
    pub(super) fn say(&mut self, line: usize, word: AuxiliaryWord) {
        if let Some(section) = self.sections.last_mut() {
            section.auxiliary.push(Auxiliary { before: section.moves, word });
            section.lines.push(line);
        }
    }

    /// Something to be done before the next point, which a tool call may still precede.
    pub(super) fn say_later(&mut self, line: usize, word: AuxiliaryWord) {
        self.said.waiting.push((line, word));
        self.said.changed = true;
    }

    /// What a path with one tool cannot say of them.
    pub(super) fn one_tool_only(&self, all: &mut Vec<Diagnostic>) {
        let mut lose = |line: usize, text: String| all.push(Diagnostic::loss(place(line), text));
        for (k, section) in self.sections.iter().enumerate() {
            if let (true, Some(number)) = (k > 0, section.tool.number) {
                lose(
                    section.line,
                    format!("tool change to {number} on the way: the path goes on with the first tool"),
                );
            }
            let words = section.auxiliary.iter().zip(&section.lines);
            let turns = words.filter_map(|(a, line)| match a.word {
                AuxiliaryWord::Spindle(spindle) => Some((spindle, *line)),
                _ => None,
            });
            let mut before = section.tool.spindle;
            let mut reversed = false;
            for (spindle, line) in turns {
                let same = before.map(Spindle::reversed) == Some(spindle);
                before = Some(spindle);
                if same && reversed {
                    continue;
                }
                reversed |= same;
                let text = match (same, spindle.rpm()) {
                    (true, _) => "the spindle is reversed; a path has one direction of it, the first is kept"
                        .to_owned(),
                    (_, None) => "SPINDL/OFF on the way; a path has one speed, the first is kept".to_owned(),
                    (_, Some(rpm)) => {
                        format!(
                            "SPINDL/{rpm} changes the speed on the way; a path has one speed, the first is kept"
                        )
                    }
                };
                lose(line, text);
            }
        }
    }
}
