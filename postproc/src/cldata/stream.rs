//! Cutter location data as a source of moves: the text is read each time and never held.

use std::cell::RefCell;
use std::io::{self, BufRead};
use std::ops::ControlFlow;

use osculate_geom::{Diagnostic, Point3};
use osculate_tools::cl::ClMove;

use super::error::ClReadError;
use super::read::{ClReadOptions, ClReader};
use crate::source::MoveSource;

/// Why moves cannot be had from a text.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ClStreamError {
    /// The text ends in the middle.
    #[error("cannot be read: {kind}")]
    Io {
        /// What the reader says.
        kind: io::ErrorKind,
    },
    /// It is no cutter location data.
    #[error(transparent)]
    Read(#[from] ClReadError),
}

impl From<io::Error> for ClStreamError {
    fn from(e: io::Error) -> Self {
        Self::Io { kind: e.kind() }
    }
}

/// A text that can be opened as often as needed.
pub struct ClStream<O> {
    open: O,
    options: ClReadOptions,
    found: RefCell<Vec<Diagnostic>>,
}

/// Where a move stands in a text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClPlace {
    /// The line on which its statement ends, from 1.
    pub line: usize,
    /// Length of the tip's way from the first point to its end, mm.
    pub length_mm: f64,
}

impl<R: BufRead, O: Fn() -> io::Result<R>> ClStream<O> {
    /// A source; `open` starts the text anew.
    pub const fn new(open: O, options: ClReadOptions) -> Self {
        Self { open, options, found: RefCell::new(Vec::new()) }
    }

    /// Findings of the last time that the text was read to its end, with line numbers.
    #[must_use]
    pub fn diagnostics(&self) -> Vec<Diagnostic> {
        self.found.borrow().clone()
    }

    /// Reads until cutter and spindle speed are known, or to the end.
    ///
    /// # Errors
    /// Where the text cannot be read.
    pub fn head(&self) -> Result<ClReader, ClStreamError> {
        let mut reader = ClReader::new(self.options);
        self.read(&mut reader, |reader| {
            reader.take_moves();
            match (reader.cutter(), reader.spindle_rpm()) {
                (Some(_), Some(_)) => ControlFlow::Break(()),
                _ => ControlFlow::Continue(()),
            }
        })?;
        Ok(reader)
    }

    /// Where moves stand, counted from 0 and in rising order; those behind the end are left out.
    ///
    /// # Errors
    /// Where the text cannot be read.
    pub fn locate(&self, indices: &[usize]) -> Result<Vec<ClPlace>, ClStreamError> {
        let mut reader = ClReader::new(self.options);
        let (mut at, mut length_mm) = (0, 0.0);
        let mut tip: Option<Point3> = None;
        let mut places = Vec::with_capacity(indices.len());
        let mut open = indices.iter().copied().peekable();
        self.read(&mut reader, |reader| {
            let line = reader.lines();
            for m in reader.take_moves() {
                length_mm += tip.map_or(0.0, |t| (m.pose.tip - t).norm());
                tip = Some(m.pose.tip);
                while open.next_if_eq(&at).is_some() {
                    places.push(ClPlace { line, length_mm });
                }
                at += 1;
            }
            if open.peek().is_some() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        })?;
        Ok(places)
    }

    /// Feeds the lines to the reader; `after` sees it after each. True where the end was reached.
    fn read(
        &self,
        reader: &mut ClReader,
        mut after: impl FnMut(&mut ClReader) -> ControlFlow<()>,
    ) -> Result<bool, ClStreamError> {
        let mut text = (self.open)()?;
        let mut bytes = Vec::new();
        loop {
            bytes.clear();
            if text.read_until(b'\n', &mut bytes)? == 0 {
                break;
            }
            // Comments of old files are in other encodings.
            let line = String::from_utf8_lossy(&bytes);
            reader.line(line.trim_end_matches(['\r', '\n']))?;
            if after(reader).is_break() {
                return Ok(false);
            }
        }
        reader.end()?;
        Ok(after(reader).is_continue())
    }
}

impl<R: BufRead, O: Fn() -> io::Result<R>> MoveSource for ClStream<O> {
    type Error = ClStreamError;

    fn pieces(
        &self,
        most: usize,
        take: &mut dyn FnMut(&[ClMove]) -> ControlFlow<()>,
    ) -> Result<(), ClStreamError> {
        let mut reader = ClReader::new(self.options);
        let mut piece = Vec::with_capacity(most);
        let whole = self.read(&mut reader, |reader| {
            piece.extend(reader.take_moves());
            while piece.len() >= most {
                let rest = piece.split_off(most);
                let flow = take(&piece);
                piece = rest;
                flow?;
            }
            ControlFlow::Continue(())
        })?;
        if whole {
            if !piece.is_empty() && take(&piece).is_break() {
                return Ok(());
            }
            *self.found.borrow_mut() = reader.diagnostics();
        }
        Ok(())
    }
}
