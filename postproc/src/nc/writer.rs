//! A program put into words move by move: what has been said leaves, so that its length costs no memory.

use super::block::{NcMove, Program, WriteError};
use super::lines::Lines;
use super::modal::{Modal, Wording};
use super::{Dialect, auxiliary, fanuc, heidenhain, linuxcnc, sinumerik};
use crate::auxiliary::AuxiliaryWord;

/// Words moves as they come.
pub(crate) struct Writer<'a> {
    dialect: Dialect,
    program: &'a Program,
    modal: Modal,
    lines: Lines,
    words: String,
    started: bool,
    /// The plane in force, and the rotary axes there.
    plane: ([i64; 3], [i64; 2]),
    /// The move that is not worded yet, behind the rotary axes before it: how it ends depends on the next one.
    held: Option<([i64; 2], NcMove)>,
    /// The control comes to rest at the end of every move.
    resting: bool,
}

impl<'a> Writer<'a> {
    /// The head of the program is written.
    ///
    /// # Errors
    /// Where the dialect cannot say the program.
    pub fn new(dialect: Dialect, program: &'a Program) -> Result<Self, WriteError> {
        let mut lines = Lines::default();
        if program.subprogram && dialect != Dialect::Sinumerik {
            return Err(WriteError::Subprogram { dialect: dialect.name() });
        }
        match dialect {
            Dialect::Sinumerik => sinumerik::head(program, &mut lines)?,
            Dialect::Heidenhain => heidenhain::head(program, &mut lines)?,
            Dialect::Fanuc => fanuc::head(program, &mut lines)?,
            Dialect::LinuxCnc => linuxcnc::head(program, &mut lines)?,
        }
        let modal = Modal::new(program);
        Ok(Self {
            dialect,
            program,
            modal,
            lines,
            words: String::new(),
            started: false,
            plane: ([0; 3], [0; 2]),
            held: None,
            resting: false,
        })
    }

    /// Goes on with another tool, as `program` has it: away from the part, the tool's call, and the next move leads from an unknown place.
    ///
    /// # Errors
    /// Where the dialect cannot say it.
    pub fn change(&mut self, program: &'a Program) -> Result<(), WriteError> {
        self.release(None);
        let (before, lines) = (self.program, &mut self.lines);
        match self.dialect {
            Dialect::Sinumerik => sinumerik::next(before, program, lines)?,
            Dialect::Heidenhain => heidenhain::next(before, program, lines)?,
            Dialect::Fanuc => fanuc::next(before, program, lines)?,
            Dialect::LinuxCnc => linuxcnc::next(before, program, lines)?,
        }
        self.program = program;
        self.modal = Modal::new(program);
        (self.started, self.resting) = (false, false);
        Ok(())
    }

    /// Words the next move; the first one leads from an unknown place.
    pub fn take(&mut self, m: &NcMove) {
        if self.started && self.dialect == Dialect::LinuxCnc && !self.program.tcp {
            let before = self.held.map_or(self.plane.1, |h| h.1.rotary);
            self.release(Some(m));
            self.held = Some((before, *m));
            return;
        }
        self.word(m);
    }

    /// Words the move that is held, which comes to rest where rotary axes stop or start before `next`.
    fn release(&mut self, next: Option<&NcMove>) {
        let Some((before, m)) = self.held.take() else { return };
        let rests = next.is_some_and(|next| linuxcnc::rests(before, &m, next));
        if rests != self.resting {
            linuxcnc::corners(self.program, rests, &mut self.lines);
            self.resting = rests;
        }
        self.word(&m);
    }

    fn word(&mut self, m: &NcMove) {
        let (program, modal, lines) = (self.program, &mut self.modal, &mut self.lines);
        let plane = std::mem::replace(&mut self.plane, (m.orientation, m.rotary));
        if !self.started {
            self.started = true;
            match self.dialect {
                Dialect::Sinumerik => sinumerik::first(program, modal, m, lines),
                Dialect::Heidenhain => heidenhain::first(program, modal, m, lines),
                Dialect::Fanuc => fanuc::first(program, modal, m, lines),
                Dialect::LinuxCnc => linuxcnc::first(program, modal, m, lines),
            }
            return;
        }
        if program.in_planes() && plane != self.plane {
            match self.dialect {
                Dialect::Sinumerik => sinumerik::next_plane(program, modal, m, lines),
                Dialect::Heidenhain => heidenhain::next_plane(program, modal, m, lines),
                Dialect::Fanuc => fanuc::next_plane(program, modal, m, lines),
                // Its head has refused planes.
                Dialect::LinuxCnc => {}
            }
            return;
        }
        let wording: &Wording = match self.dialect {
            Dialect::Heidenhain if program.in_vectors() => &heidenhain::DIRECTED,
            Dialect::Sinumerik => &sinumerik::WORDING,
            Dialect::Heidenhain => &heidenhain::WORDING,
            Dialect::Fanuc => &fanuc::WORDING,
            Dialect::LinuxCnc => &linuxcnc::WORDING,
        };
        self.words.clear();
        modal.block(program, wording, m, &mut self.words);
        if self.words.is_empty() {
            return;
        }
        if m.rapid && self.dialect == Dialect::Heidenhain {
            self.words.push_str(" FMAX");
        }
        lines.line(&self.words[1..]);
    }

    /// Says what is done before the next move.
    pub fn say(&mut self, word: AuxiliaryWord) {
        self.release(None);
        auxiliary::say(self.dialect, word, &mut self.lines);
    }

    /// The end of the program.
    pub fn finish(&mut self) {
        self.release(None);
        let (program, lines) = (self.program, &mut self.lines);
        match self.dialect {
            Dialect::Sinumerik => sinumerik::tail(program, lines),
            Dialect::Heidenhain => heidenhain::tail(program, lines),
            Dialect::Fanuc => fanuc::tail(program, lines),
            Dialect::LinuxCnc => linuxcnc::tail(program, lines),
        }
    }

    /// What has been written since the last [`Writer::clear`].
    pub fn text(&self) -> &str {
        &self.lines.text
    }

    /// Forgets what has been written.
    pub fn clear(&mut self) {
        self.lines.text.clear();
    }
}
