//! Cutter location data as a source of moves: the text is read each time and never held.

use std::cell::RefCell;
use std::io::{self, BufRead, Read, Seek, SeekFrom};
use std::ops::ControlFlow;
use std::sync::mpsc;
use std::thread;

use osculate_geom::{Diagnostic, Point3};
use osculate_tools::cl::ClMove;

use super::error::ClReadError;
use super::read::{ClReadOptions, ClReader};
use super::section::ClSection;
use crate::source::MoveSource;

/// Why moves cannot be had from a text.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
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
///
/// ```
/// use osculate_postproc::cldata::{ClReadOptions, ClStream};
/// use std::io::Cursor;
///
/// // Two tools; whatever can be opened again is a source, a file as well as this text.
/// let text = "LOADTL/1\nRAPID\nGOTO/0,0,5\nFEDRAT/600\nGOTO/9,0,5\nLOADTL/2\nRAPID\nGOTO/0,0,5\nFINI\n";
/// let stream = ClStream::new(|| Ok(Cursor::new(text)), ClReadOptions::default());
/// let outline = stream.outline()?;
/// let tools: Vec<_> = outline.sections.iter().map(|s| (s.tool.number, s.moves)).collect();
/// assert_eq!(tools, [(Some(1), 2), (Some(2), 1)]);
/// // Move 1 stands in line 5, 9 mm along the way.
/// let place = stream.locate(&[1])?[0];
/// assert_eq!((place.line, place.length_mm), (5, 9.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct ClStream<O> {
    open: O,
    options: ClReadOptions,
    found: RefCell<Vec<Diagnostic>>,
}

/// Where a move stands in a text.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ClPlace {
    /// The line on which its statement ends, from 1.
    pub line: usize,
    /// Length of the tip's way from the first point to its end, mm.
    pub length_mm: f64,
}

/// What a whole text does: its tools one after the other, and what was noticed.
#[derive(Clone, Debug)]
pub struct ClOutline {
    /// The tools, each with its moves.
    pub sections: Vec<ClSection>,
    /// Findings, with line numbers.
    pub diagnostics: Vec<Diagnostic>,
    starts: Vec<Start>,
}

/// Where a section can be read from.
#[derive(Clone, Debug)]
struct Start {
    bytes: u64,
    reader: ClReader,
}

/// The moves of one section of a text.
pub struct ClPart<'a, O> {
    stream: &'a ClStream<O>,
    start: &'a Start,
}

impl<R: BufRead + Seek, O: Fn() -> io::Result<R>> ClStream<O> {
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
        feed(&self.open, 0, &mut reader, |reader, _| {
            reader.take_moves();
            match (reader.cutter(), reader.spindle_rpm()) {
                (Some(_), Some(_)) if !reader.is_empty() => ControlFlow::Break(()),
                _ => ControlFlow::Continue(()),
            }
        })?;
        Ok(reader)
    }

    /// Goes over the whole text for its tools.
    ///
    /// # Errors
    /// Where the text cannot be read.
    pub fn outline(&self) -> Result<ClOutline, ClStreamError> {
        let mut reader = ClReader::new(self.options);
        let first = Start { bytes: 0, reader: reader.clone() };
        let (mut starts, mut next) = (Vec::new(), Some(first));
        feed(&self.open, 0, &mut reader, |reader, bytes| {
            reader.take_moves();
            while starts.len() < reader.sections().len() {
                // A section begins with its first point; the state before it was kept when its tool was called.
                let kept = next.take();
                starts.push(kept.expect("a section follows the text's begin or a tool call"));
            }
            if reader.waits_for_tool() && !starts.is_empty() {
                next = Some(Start { bytes, reader: reader.without_findings() });
            }
            ControlFlow::Continue(())
        })?;
        Ok(ClOutline { sections: reader.sections().to_vec(), diagnostics: reader.diagnostics(), starts })
    }

    /// The moves of each section of the text's own outline, as sources.
    pub fn parts<'a>(&'a self, outline: &'a ClOutline) -> Vec<ClPart<'a, O>> {
        outline.starts.iter().map(|start| ClPart { stream: self, start }).collect()
    }

    /// Where moves stand, counted from 0 and in rising order; those behind the end are left out.
    ///
    /// # Errors
    /// Where the text cannot be read.
    pub fn locate(&self, indices: &[usize]) -> Result<Vec<ClPlace>, ClStreamError> {
        let start = Start { bytes: 0, reader: ClReader::new(self.options) };
        locate(&self.open, &start, indices)
    }
}

impl<R: BufRead + Seek, O: Fn() -> io::Result<R>> ClPart<'_, O> {
    /// As [`ClStream::locate`], with moves and length from the beginning of the section.
    ///
    /// # Errors
    /// Where the text cannot be read.
    pub fn locate(&self, indices: &[usize]) -> Result<Vec<ClPlace>, ClStreamError> {
        locate(&self.stream.open, self.start, indices)
    }
}

fn locate<R: BufRead + Seek, O: Fn() -> io::Result<R>>(
    open: &O,
    start: &Start,
    indices: &[usize],
) -> Result<Vec<ClPlace>, ClStreamError> {
    let mut reader = start.reader.clone();
    let (mut at, mut length_mm) = (0, 0.0);
    let mut tip: Option<Point3> = None;
    let mut places = Vec::with_capacity(indices.len());
    let mut wanted = indices.iter().copied().peekable();
    feed(open, start.bytes, &mut reader, |reader, _| {
        let line = reader.lines();
        for m in reader.take_moves() {
            length_mm += tip.map_or(0.0, |t| (m.pose.tip - t).norm());
            tip = Some(m.pose.tip);
            while wanted.next_if_eq(&at).is_some() {
                places.push(ClPlace { line, length_mm });
            }
            at += 1;
        }
        if wanted.peek().is_some() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    })?;
    Ok(places)
}

/// Bytes of a line: a statement has a few hundred.
const LONGEST_LINE: usize = 1 << 16;

/// Feeds the lines from a place on to the reader; `after` sees it after each, with the bytes read so far. True where the end was reached.
fn feed<R: BufRead + Seek, O: Fn() -> io::Result<R>>(
    open: &O,
    from: u64,
    reader: &mut ClReader,
    mut after: impl FnMut(&mut ClReader, u64) -> ControlFlow<()>,
) -> Result<bool, ClStreamError> {
    let mut text = open()?;
    if from > 0 {
        text.seek(SeekFrom::Start(from))?;
    }
    let mut bytes = Vec::new();
    let mut at = from;
    loop {
        bytes.clear();
        let count = text.by_ref().take(LONGEST_LINE as u64 + 1).read_until(b'\n', &mut bytes)?;
        if count == 0 {
            break;
        }
        if count > LONGEST_LINE {
            return Err(ClReadError::Long { line: reader.lines() + 1, most: LONGEST_LINE }.into());
        }
        at += count as u64;
        // Comments of old files are in other encodings.
        let line = String::from_utf8_lossy(&bytes);
        reader.line(line.trim_end_matches(['\r', '\n']))?;
        if after(reader, at).is_break() {
            return Ok(false);
        }
    }
    reader.end()?;
    Ok(after(reader, at).is_continue())
}

/// Pieces that are read while one is worked on.
const AHEAD: usize = 2;

/// Gives the moves from a start on, to the end of the section where `one` is asked for; the findings of a text that was read whole.
fn pieces<R: BufRead + Seek, O: Fn() -> io::Result<R> + Sync>(
    open: &O,
    (start, one): (&Start, bool),
    most: usize,
    take: &mut dyn FnMut(&[ClMove]) -> ControlFlow<()>,
) -> Result<Option<Vec<Diagnostic>>, ClStreamError> {
    let last = start.reader.sections().len() + 1;
    let (send, receive) = mpsc::sync_channel::<Vec<ClMove>>(AHEAD);
    let (whole, found) = thread::scope(|scope| {
        let reading = scope.spawn(move || {
            let mut reader = start.reader.clone();
            let mut piece = Vec::with_capacity(most);
            let whole = feed(open, start.bytes, &mut reader, |reader, _| {
                if one && reader.sections().len() > last {
                    return ControlFlow::Break(());
                }
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
    Ok(whole?.then_some(found))
}

impl<R: BufRead + Seek, O: Fn() -> io::Result<R> + Sync> MoveSource for ClStream<O> {
    type Error = ClStreamError;

    /// The text is read by a thread of its own, a few pieces ahead of `take`.
    fn pieces(
        &self,
        most: usize,
        take: &mut dyn FnMut(&[ClMove]) -> ControlFlow<()>,
    ) -> Result<(), ClStreamError> {
        let start = Start { bytes: 0, reader: ClReader::new(self.options) };
        if let Some(found) = pieces(&self.open, (&start, false), most, take)? {
            *self.found.borrow_mut() = found;
        }
        Ok(())
    }
}

impl<R: BufRead + Seek, O: Fn() -> io::Result<R> + Sync> MoveSource for ClPart<'_, O> {
    type Error = ClStreamError;

    /// As of the whole text, from where the tool is called.
    fn pieces(
        &self,
        most: usize,
        take: &mut dyn FnMut(&[ClMove]) -> ControlFlow<()>,
    ) -> Result<(), ClStreamError> {
        pieces(&self.stream.open, (self.start, true), most, take).map(|_| ())
    }
}
