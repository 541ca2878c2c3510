//! Cutter location data as a source of moves: the text is read each time and never held.

use std::cell::RefCell;
use std::io::{self, BufRead};
use std::ops::ControlFlow;
use std::sync::mpsc;
use std::thread;

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

    /// Reads until cutter and spindle speed are known and the first point has come, or to the end.
    ///
    /// # Errors
    /// Where the text cannot be read.
    pub fn head(&self) -> Result<ClReader, ClStreamError> {
        let mut reader = ClReader::new(self.options);
        feed(&self.open, &mut reader, |reader| {
            reader.take_moves();
            match (reader.cutter(), reader.spindle_rpm()) {
                (Some(_), Some(_)) if !reader.is_empty() => ControlFlow::Break(()),
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
        feed(&self.open, &mut reader, |reader| {
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
}

/// Feeds the lines to the reader; `after` sees it after each. True where the end was reached.
fn feed<R: BufRead, O: Fn() -> io::Result<R>>(
    open: &O,
    reader: &mut ClReader,
    mut after: impl FnMut(&mut ClReader) -> ControlFlow<()>,
) -> Result<bool, ClStreamError> {
    let mut text = open()?;
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

/// Pieces that are read while one is worked on.
const AHEAD: usize = 2;

impl<R: BufRead, O: Fn() -> io::Result<R> + Sync> MoveSource for ClStream<O> {
    type Error = ClStreamError;

    /// The text is read by a thread of its own, a few pieces ahead of `take`.
    fn pieces(
        &self,
        most: usize,
        take: &mut dyn FnMut(&[ClMove]) -> ControlFlow<()>,
    ) -> Result<(), ClStreamError> {
        let (open, options) = (&self.open, self.options);
        let (send, receive) = mpsc::sync_channel::<Vec<ClMove>>(AHEAD);
        let (whole, found) = thread::scope(|scope| {
            let reading = scope.spawn(move || {
                let mut reader = ClReader::new(options);
                let mut piece = Vec::with_capacity(most);
                let whole = feed(open, &mut reader, |reader| {
                    piece.extend(reader.take_moves());
                    while piece.len() >= most {
                        let rest = piece.split_off(most);
                        // Where nobody listens any more, there is nothing to be read for.
                        if send.send(std::mem::replace(&mut piece, rest)).is_err() {
                            return ControlFlow::Break(());
                        }
                        piece.reserve(most);
                    }
                    ControlFlow::Continue(())
                });
                // What stands before a fault is worked on first: a fault there comes before.
                let sent = piece.is_empty() || send.send(piece).is_ok();
                (whole.map(|whole| whole && sent), reader.diagnostics())
            });
            for piece in &receive {
                if take(&piece).is_break() {
                    break;
                }
            }
            drop(receive);
            reading.join().expect("the reader does not panic")
        });
        if whole? {
            *self.found.borrow_mut() = found;
        }
        Ok(())
    }
}
