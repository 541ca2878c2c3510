//! From text to records: the text is cut at semicolons into pieces, which are read side by side.
//!
//! A record that cannot be read is skipped to its semicolon and reported. Nested parameter lists are limited to
//! [`MAX_DEPTH`], so that hostile text cannot exhaust the stack.

use super::lexer::{Lexer, Mark, Span, Stop, StringEnd, Token, find, string_end};
use rayon::prelude::*;

/// Deepest nesting of lists in a record. Geometry needs four (a net of poles in a typed select); 64 is far above any
/// schema and far below what a thread's stack holds.
const MAX_DEPTH: usize = 64;

/// A parameter. Lists are followed by what is in them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Atom {
    /// `$`, `*` or something without use here (binary, resource).
    Nothing,
    /// An integer.
    Int(i64),
    /// A real.
    Real(f64),
    /// A string, not decoded.
    Text(Span),
    /// An enumeration value.
    Enum(Span),
    /// A reference.
    Ref(u64),
    /// A list: the index behind its last atom and the number of its elements.
    List {
        /// Index behind its last atom.
        end: u32,
        /// Elements.
        count: u32,
    },
    /// `KEYWORD(...)` as a parameter: the index behind its last atom, and where the keyword is.
    Typed {
        /// Index behind its last atom.
        end: u32,
        /// Offset of the keyword.
        at: u32,
    },
}

/// A keyword with parameters: a simple record is one, a complex record several.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    /// The keyword as it is written.
    pub(crate) word: Span,
    /// Range of its parameters' atoms.
    pub(crate) atoms: [u32; 2],
}

/// An instance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    /// Its number.
    pub(crate) id: u64,
    /// Where it begins.
    pub(crate) at: u32,
    /// Range of its parts.
    pub(crate) parts: [u32; 2],
    /// Whether it is of a [`BULK`] kind.
    pub(crate) bulk: bool,
}

/// Kinds that are only ever reached by reference, and make up most of a file.
const BULK: [&str; 8] = [
    "CARTESIAN_POINT",
    "DIRECTION",
    "VECTOR",
    "LINE",
    "AXIS2_PLACEMENT_3D",
    "VERTEX_POINT",
    "EDGE_CURVE",
    "ORIENTED_EDGE",
];

/// What stands between the records.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Event {
    /// A section's keyword or a header entity.
    Word(Span),
    /// A record with this number that cannot be read.
    Bad(Option<u64>, Fault),
    /// The text ended inside a token or a statement.
    End,
}

/// What is wrong with a record.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub(crate) enum Fault {
    /// The text ended.
    #[error("the file ends here")]
    End,
    /// A malformed token.
    #[error(transparent)]
    Mark(#[from] Mark),
    /// A token that does not belong here.
    #[error("{wanted} expected, found {found}")]
    Unexpected {
        /// What belongs here.
        wanted: &'static str,
        /// What stands here.
        found: &'static str,
    },
    /// `#1=<file#name>;` of edition 3.
    #[error("it stands in another file, which is not read; export the parts into one file")]
    External,
    /// Lists in lists in lists.
    #[error("lists nested deeper than {MAX_DEPTH}")]
    Deep,
}

impl From<Stop> for Fault {
    fn from(stop: Stop) -> Self {
        match stop {
            Stop::End { .. } => Self::End,
            Stop::Bad(mark) => Self::Mark(mark),
        }
    }
}

/// The records of a piece of text.
#[derive(Debug, Default)]
pub(crate) struct Chunk {
    pub(crate) atoms: Vec<Atom>,
    pub(crate) parts: Vec<Part>,
    pub(crate) entries: Vec<Entry>,
    /// Events with their offset and the number of entries before them.
    pub(crate) events: Vec<(Event, usize, usize)>,
}

/// Pieces smaller than this are not worth a thread.
const CHUNK: usize = 1 << 16;

/// Reads all statements of the text from `start` on.
pub(crate) fn chunks(text: &[u8], start: usize) -> Vec<Chunk> {
    let ends = cuts(text, start, CHUNK.max((text.len() - start) / 64));
    let ranges: Vec<(usize, usize)> =
        std::iter::once(start).chain(ends.iter().copied()).zip(ends.iter().copied()).collect();
    if ranges.len() == 1 {
        return ranges.iter().map(|r| chunk(&text[..r.1], r.0)).collect();
    }
    ranges.par_iter().map(|r| chunk(&text[..r.1], r.0)).collect()
}

/// Offsets behind semicolons outside strings and comments, at least `size` apart; the last one is the end.
fn cuts(text: &[u8], start: usize, size: usize) -> Vec<usize> {
    let mut ends = Vec::new();
    let (mut at, mut from) = (start, start);
    while let Some(n) = text[at..].iter().position(|c| matches!(c, b';' | b'\'' | b'"' | b'/')) {
        at += n + 1;
        match text[at - 1] {
            b';' if at - from >= size => {
                ends.push(at);
                from = at;
            }
            b'\'' => match string_end(text, at) {
                StringEnd::At(end) => at = end + 1,
                StringEnd::Lost(end) => at = end,
                StringEnd::Open => break,
            },
            b'/' if text.get(at) == Some(&b'*') => match find(&text[at + 1..], b"*/") {
                Some(end) => at += 1 + end + 2,
                None => break,
            },
            _ => {}
        }
    }
    if ends.last() != Some(&text.len()) {
        ends.push(text.len());
    }
    ends
}

/// Reads the statements of `text` from `start` on.
fn chunk(text: &[u8], start: usize) -> Chunk {
    // A typical record has 70 bytes and six parameters.
    let expected = (text.len() - start) / 70;
    let mut reader = Reader {
        lexer: Lexer::new(text, start),
        out: Chunk {
            atoms: Vec::with_capacity(6 * expected),
            parts: Vec::with_capacity(expected),
            entries: Vec::with_capacity(expected),
            events: Vec::new(),
        },
        scopes: Vec::new(),
    };
    while reader.statement(text) {}
    // The records stay until the last face is made.
    reader.out.atoms.shrink_to_fit();
    reader.out.parts.shrink_to_fit();
    reader.out.entries.shrink_to_fit();
    reader.out
}

struct Reader<'a> {
    lexer: Lexer<'a>,
    out: Chunk,
    /// Numbers of the instances whose scope is open.
    scopes: Vec<(u64, usize)>,
}

impl Reader<'_> {
    fn event(&mut self, event: Event, at: usize) {
        let before = self.out.entries.len();
        self.out.events.push((event, at, before));
    }

    /// Reads one statement; false at the end.
    fn statement(&mut self, text: &[u8]) -> bool {
        let token = self.lexer.next();
        let at = self.lexer.at;
        match token {
            Ok(Token::Id(id)) => {
                // The offset of the sign: lines are told by it.
                let sign = text[..at].iter().rposition(|c| matches!(c, b'#' | b'@')).unwrap_or(at);
                self.record(text, id, sign)
            }
            Ok(Token::Word(word)) if word.of(text).eq_ignore_ascii_case(b"ENDSCOPE") => {
                let Some((id, sign)) = self.scopes.pop() else {
                    self.event(
                        Event::Bad(None, Fault::Unexpected { wanted: "a record", found: "ENDSCOPE" }),
                        at,
                    );
                    return self.skip(at);
                };
                self.export_list();
                self.body(text, id, sign)
            }
            Ok(Token::Word(word)) => {
                self.event(Event::Word(word), word.at as usize);
                // The last line may lack its semicolon.
                self.lexer.skip_statement() || {
                    if !word.of(text).to_ascii_uppercase().starts_with(b"END") {
                        self.event(Event::End, at);
                    }
                    false
                }
            }
            Ok(Token::Semicolon) => true,
            // `<name>=#1;` of an ANCHOR section, base 64 of a SIGNATURE section, or stray text.
            Ok(_) => self.skip(at),
            Err(Stop::End { open }) => {
                if open {
                    self.event(Event::End, at);
                }
                false
            }
            Err(Stop::Bad(mark)) => {
                self.event(Event::Bad(None, Fault::Mark(mark)), at);
                self.skip(at)
            }
        }
    }

    fn skip(&mut self, at: usize) -> bool {
        if self.lexer.skip_statement() {
            return true;
        }
        self.event(Event::End, at);
        false
    }

    /// `/#1,#2/` behind ENDSCOPE.
    fn export_list(&mut self) {
        let mut ahead = self.lexer.clone();
        if ahead.next() != Ok(Token::Slash) {
            return;
        }
        while let Ok(Token::Id(_) | Token::Comma) = ahead.next() {}
        self.lexer = ahead;
    }

    /// The rest of an instance after its number.
    fn record(&mut self, text: &[u8], id: u64, sign: usize) -> bool {
        match self.lexer.next() {
            Ok(Token::Equals) => self.body(text, id, sign),
            other => self.fault(id, sign, fault("'='", other)),
        }
    }

    fn body(&mut self, text: &[u8], id: u64, sign: usize) -> bool {
        let (parts, atoms) = (self.out.parts.len(), self.out.atoms.len());
        match self.parts() {
            Ok(true) => {
                let bulk = match &self.out.parts[parts..] {
                    [one] => BULK.iter().any(|b| one.word.of(text).eq_ignore_ascii_case(b.as_bytes())),
                    _ => false,
                };
                let parts = [parts as u32, self.out.parts.len() as u32];
                self.out.entries.push(Entry { id, at: sign as u32, parts, bulk });
                true
            }
            Ok(false) => {
                // A scope: the instances within come first.
                self.scopes.push((id, sign));
                true
            }
            Err(fault) => {
                self.out.parts.truncate(parts);
                self.out.atoms.truncate(atoms);
                self.fault(id, sign, fault)
            }
        }
    }

    fn fault(&mut self, id: u64, sign: usize, fault: Fault) -> bool {
        if fault == Fault::End {
            self.event(Event::End, sign);
            return false;
        }
        self.event(Event::Bad(Some(id), fault), sign);
        // The statement's semicolon may have been read already.
        matches!(fault, Fault::Unexpected { found: SEMICOLON, .. }) || self.skip(sign)
    }

    /// The keywords and parameters of an instance up to its semicolon; false where a scope begins instead.
    fn parts(&mut self) -> Result<bool, Fault> {
        match self.lexer.next()? {
            Token::Open => loop {
                match self.lexer.next()? {
                    Token::Word(word) => self.part(word)?,
                    Token::Close => break,
                    other => return Err(fault("a keyword or ')'", Ok(other))),
                }
            },
            Token::Word(word) => self.part(word)?,
            Token::Ampersand => {
                // SCOPE, the only word that follows.
                self.lexer.next()?;
                return Ok(false);
            }
            Token::Resource => return Err(Fault::External),
            other => return Err(fault("a keyword", Ok(other))),
        }
        match self.lexer.next()? {
            Token::Semicolon => Ok(true),
            other => Err(fault("';'", Ok(other))),
        }
    }

    fn part(&mut self, word: Span) -> Result<(), Fault> {
        match self.lexer.next()? {
            Token::Open => {}
            other => return Err(fault("'('", Ok(other))),
        }
        let from = self.out.atoms.len() as u32;
        self.list(0)?;
        let part = Part { word, atoms: [from, self.out.atoms.len() as u32] };
        self.out.parts.push(part);
        Ok(())
    }

    /// Values up to the closing parenthesis, with their number. Stray and doubled commas are passed over.
    fn list(&mut self, depth: usize) -> Result<u32, Fault> {
        if depth >= MAX_DEPTH {
            return Err(Fault::Deep);
        }
        let mut count = 0;
        loop {
            let atom = match self.lexer.next()? {
                Token::Close => return Ok(count),
                Token::Comma => continue,
                Token::Id(id) => Atom::Ref(id),
                Token::Int(i) => Atom::Int(i),
                Token::Real(x) => Atom::Real(x),
                Token::Text(t) => Atom::Text(t),
                Token::Enum(e) => Atom::Enum(e),
                Token::Omitted | Token::Derived | Token::Binary | Token::Resource => Atom::Nothing,
                Token::Open => {
                    let own = self.out.atoms.len();
                    self.out.atoms.push(Atom::Nothing);
                    let inner = self.list(depth + 1)?;
                    self.out.atoms[own] = Atom::List { end: self.out.atoms.len() as u32, count: inner };
                    count += 1;
                    continue;
                }
                Token::Word(word) => match self.lexer.next()? {
                    Token::Open => {
                        let own = self.out.atoms.len();
                        self.out.atoms.push(Atom::Nothing);
                        self.list(depth + 1)?;
                        self.out.atoms[own] = Atom::Typed { end: self.out.atoms.len() as u32, at: word.at };
                        count += 1;
                        continue;
                    }
                    other => return Err(fault("'(' after a keyword", Ok(other))),
                },
                other => return Err(fault("a parameter", Ok(other))),
            };
            self.out.atoms.push(atom);
            count += 1;
        }
    }
}

/// The name of a semicolon in messages; a fault that has met one needs no skipping.
const SEMICOLON: &str = "';'";

fn fault(wanted: &'static str, found: Result<Token, Stop>) -> Fault {
    let found = match found {
        Err(stop) => return stop.into(),
        Ok(Token::Id(_)) => "a reference",
        Ok(Token::Word(_)) => "a keyword",
        Ok(Token::Int(_) | Token::Real(_)) => "a number",
        Ok(Token::Text(_)) => "a string",
        Ok(Token::Enum(_)) => "an enumeration value",
        Ok(Token::Binary) => "a binary literal",
        Ok(Token::Resource) => "a resource",
        Ok(Token::Omitted) => "'$'",
        Ok(Token::Derived) => "'*'",
        Ok(Token::Open) => "'('",
        Ok(Token::Close) => "')'",
        Ok(Token::Comma) => "','",
        Ok(Token::Semicolon) => SEMICOLON,
        Ok(Token::Equals) => "'='",
        Ok(Token::Ampersand) => "'&'",
        Ok(Token::Slash) => "'/'",
    };
    Fault::Unexpected { wanted, found }
}
