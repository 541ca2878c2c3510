//! Tokens of a Part 21 exchange file (ISO 10303-21, clear text encoding), as ranges of the text.
//!
//! Lenient where dialects differ and the meaning is plain: comments anywhere between tokens, blanks of any kind
//! (tabs, form feeds, CR LF), integers for reals, `D` for `E` in exponents, exponents without a point, keywords and
//! enumerations in any case. Nothing is copied: strings are decoded by [`super::text`] where somebody asks for them.

/// A range of the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Span {
    /// Offset of the first byte.
    pub(crate) at: u32,
    /// Number of bytes.
    pub(crate) len: u32,
}

impl Span {
    /// The range between two offsets.
    pub(crate) const fn between(from: usize, to: usize) -> Self {
        Self { at: from as u32, len: (to - from) as u32 }
    }

    /// The bytes of the range.
    pub(crate) fn of(self, text: &[u8]) -> &[u8] {
        &text[self.at as usize..(self.at + self.len) as usize]
    }
}

/// One token.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Token {
    /// `#12`.
    Id(u64),
    /// A keyword; user-defined ones keep their `!`.
    Word(Span),
    /// A number written without point and exponent.
    Int(i64),
    /// Any other number.
    Real(f64),
    /// A string between its apostrophes.
    Text(Span),
    /// `.T.` without its points.
    Enum(Span),
    /// `"0F3A"`.
    Binary,
    /// `<...>` of editions 3 and later.
    Resource,
    /// `$`.
    Omitted,
    /// `*`.
    Derived,
    /// `(`.
    Open,
    /// `)`.
    Close,
    /// `,`.
    Comma,
    /// `;`.
    Semicolon,
    /// `=`.
    Equals,
    /// `&` of a scope in the first edition.
    Ampersand,
    /// `/` of a scope's export list.
    Slash,
}

/// Why there is no next token.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stop {
    /// The text ended, inside a token or comment where the flag is set.
    End {
        /// True where a string, a comment or another bracketed token was still open.
        open: bool,
    },
    /// A character that begins no token, or a malformed one.
    Bad(Mark),
}

/// A malformed token.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum Mark {
    /// A byte.
    #[error("byte 0x{0:02x} begins no token")]
    Byte(u8),
    /// `#` without digits.
    #[error("a reference without a number")]
    NoNumber,
    /// Digits beyond the range.
    #[error("an instance number above 2^64")]
    HugeId,
    /// An enumeration value that goes on.
    #[error("an enumeration value without its closing point")]
    OpenEnum,
    /// Digits that make no number.
    #[error("a number that is none, or beyond the range of numbers")]
    Number,
    /// A string that goes on to the next record.
    #[error("a string without its closing apostrophe")]
    OpenText,
    /// A binary literal that goes on.
    #[error("a binary literal without its closing quotation mark")]
    OpenBinary,
}

/// A reader of tokens.
#[derive(Clone, Debug)]
pub(crate) struct Lexer<'a> {
    text: &'a [u8],
    /// Offset of the next byte.
    pub(crate) at: usize,
}

impl<'a> Lexer<'a> {
    /// A lexer that starts at byte `at`.
    pub(crate) const fn new(text: &'a [u8], at: usize) -> Self {
        Self { text, at }
    }

    #[inline]
    fn peek(&self, ahead: usize) -> Option<u8> {
        self.text.get(self.at + ahead).copied()
    }

    /// Skips blanks, comments and the print control directives `\N\` and `\F\`.
    #[inline]
    fn skip_blank(&mut self) -> Result<(), Stop> {
        loop {
            match self.peek(0) {
                // Control characters and a byte order mark count as blanks.
                Some(c) if c <= b' ' || c == 0x7f || matches!(c, 0xef | 0xbb | 0xbf) => self.at += 1,
                Some(b'/') if self.peek(1) == Some(b'*') => {
                    let rest = &self.text[self.at + 2..];
                    let Some(end) = find(rest, b"*/") else {
                        self.at = self.text.len();
                        return Err(Stop::End { open: true });
                    };
                    self.at += 2 + end + 2;
                }
                Some(b'\\')
                    if matches!(self.peek(1), Some(b'N' | b'F' | b'n' | b'f'))
                        && self.peek(2) == Some(b'\\') =>
                {
                    self.at += 3;
                }
                _ => return Ok(()),
            }
        }
    }

    /// Moves behind the next semicolon outside strings and comments; false at the end of the text.
    pub(crate) fn skip_statement(&mut self) -> bool {
        loop {
            match self.next() {
                Ok(Token::Semicolon) => return true,
                Ok(_) => {}
                Err(Stop::End { .. }) => return false,
                // A bad character never holds the reader: next() has moved past it.
                Err(Stop::Bad(_)) => {}
            }
        }
    }

    /// The next token. A `Bad` stop always moves at least one byte on.
    pub(crate) fn next(&mut self) -> Result<Token, Stop> {
        self.skip_blank()?;
        let Some(c) = self.peek(0) else {
            return Err(Stop::End { open: false });
        };
        let simple = match c {
            b'(' => Token::Open,
            b')' => Token::Close,
            b',' => Token::Comma,
            b';' => Token::Semicolon,
            b'=' => Token::Equals,
            b'$' => Token::Omitted,
            b'*' => Token::Derived,
            b'&' => Token::Ampersand,
            b'/' => Token::Slash,
            b'#' | b'@' => return self.id(),
            b'0'..=b'9' | b'+' | b'-' => return self.number(),
            b'\'' => return self.string(),
            b'"' => return self.binary(),
            b'<' => return self.resource(),
            b'.' if self.peek(1).is_some_and(|d| d.is_ascii_alphabetic() || d == b'_') => {
                return self.enumeration();
            }
            b'.' => return self.number(),
            b'!' | b'_' => return Ok(self.word()),
            c if c.is_ascii_alphabetic() => return Ok(self.word()),
            c => {
                self.at += 1;
                return Err(Stop::Bad(Mark::Byte(c)));
            }
        };
        self.at += 1;
        Ok(simple)
    }

    fn id(&mut self) -> Result<Token, Stop> {
        self.at += 1;
        // Some writers set a blank behind the sign.
        while self.peek(0) == Some(b' ') {
            self.at += 1;
        }
        let start = self.at;
        let mut id: u64 = 0;
        let mut whole = true;
        while let Some(c @ b'0'..=b'9') = self.peek(0) {
            match id.checked_mul(10).and_then(|v| v.checked_add(u64::from(c - b'0'))) {
                Some(v) => id = v,
                None => whole = false,
            }
            self.at += 1;
        }
        if start == self.at {
            // `#name` of edition 3: a reference to a constant or an external value.
            while self.peek(0).is_some_and(|c| c.is_ascii_alphanumeric() || c == b'_') {
                self.at += 1;
            }
            return Err(Stop::Bad(Mark::NoNumber));
        }
        if whole { Ok(Token::Id(id)) } else { Err(Stop::Bad(Mark::HugeId)) }
    }

    fn word(&mut self) -> Token {
        let start = self.at;
        self.at += 1;
        while self.peek(0).is_some_and(|c| c.is_ascii_alphanumeric() || c == b'_' || c == b'-') {
            self.at += 1;
        }
        Token::Word(Span::between(start, self.at))
    }

    fn enumeration(&mut self) -> Result<Token, Stop> {
        let start = self.at + 1;
        let mut end = start;
        while self.text.get(end).is_some_and(|c| c.is_ascii_alphanumeric() || *c == b'_') {
            end += 1;
        }
        match self.text.get(end) {
            Some(b'.') => {
                self.at = end + 1;
                Ok(Token::Enum(Span::between(start, end)))
            }
            Some(_) => {
                self.at = end;
                Err(Stop::Bad(Mark::OpenEnum))
            }
            None => {
                self.at = end;
                Err(Stop::End { open: true })
            }
        }
    }

    fn resource(&mut self) -> Result<Token, Stop> {
        match self.text[self.at + 1..].iter().position(|c| *c == b'>' || *c == b';') {
            Some(n) if self.text[self.at + 1 + n] == b'>' => {
                self.at += n + 2;
                Ok(Token::Resource)
            }
            // Up to the semicolon there is no end: what stands between is not looked through again.
            Some(n) => {
                self.at += n + 1;
                Err(Stop::Bad(Mark::Byte(b'<')))
            }
            None => {
                self.at = self.text.len();
                Err(Stop::End { open: true })
            }
        }
    }

    fn binary(&mut self) -> Result<Token, Stop> {
        let mut end = self.at + 1;
        while self.text.get(end).is_some_and(|c| c.is_ascii_hexdigit() || c.is_ascii_whitespace()) {
            end += 1;
        }
        let closed = self.text.get(end);
        self.at = end;
        match closed {
            Some(b'"') => {
                self.at += 1;
                Ok(Token::Binary)
            }
            Some(_) => Err(Stop::Bad(Mark::OpenBinary)),
            None => Err(Stop::End { open: true }),
        }
    }

    fn number(&mut self) -> Result<Token, Stop> {
        let start = self.at;
        let mut end = start + 1;
        let (mut integer, mut fortran) = (self.text[start] != b'.', false);
        while let Some(c) = self.text.get(end) {
            match c {
                b'0'..=b'9' => {}
                b'.' => integer = false,
                b'e' | b'E' | b'd' | b'D' => {
                    integer = false;
                    fortran |= matches!(c, b'd' | b'D');
                    if matches!(self.text.get(end + 1), Some(b'+' | b'-')) {
                        end += 1;
                    }
                }
                _ => break,
            }
            end += 1;
        }
        self.at = end;
        let digits = &self.text[start..end];
        if integer && let Some(i) = int(digits) {
            return Ok(Token::Int(i));
        }
        let value = if fortran {
            let folded = digits.iter().map(|c| if matches!(c, b'd' | b'D') { b'E' } else { *c }).collect();
            String::from_utf8(folded).ok().and_then(|t| t.parse::<f64>().ok())
        } else {
            short(digits).or_else(|| std::str::from_utf8(digits).ok().and_then(|t| t.parse::<f64>().ok()))
        };
        match value {
            Some(x) if x.is_finite() => Ok(Token::Real(x)),
            _ => Err(Stop::Bad(Mark::Number)),
        }
    }

    fn string(&mut self) -> Result<Token, Stop> {
        let start = self.at + 1;
        match string_end(self.text, start) {
            StringEnd::At(end) => {
                self.at = end + 1;
                Ok(Token::Text(Span::between(start, end)))
            }
            StringEnd::Open => {
                self.at = self.text.len();
                Err(Stop::End { open: true })
            }
            StringEnd::Lost(line) => {
                self.at = line;
                Err(Stop::Bad(Mark::OpenText))
            }
        }
    }
}

/// Where a string ends.
pub(crate) enum StringEnd {
    /// At this closing apostrophe.
    At(usize),
    /// Nowhere.
    Open,
    /// Its apostrophe is missing: the text goes on with a record at the beginning of a line. The offset is that of
    /// the semicolon before it.
    Lost(usize),
}

/// Looks for the end of the string whose text begins at `start`.
pub(crate) fn string_end(text: &[u8], start: usize) -> StringEnd {
    let mut end = start;
    loop {
        match text.get(end) {
            None => return StringEnd::Open,
            Some(b'\'') if text.get(end + 1) == Some(&b'\'') => end += 2,
            Some(b'\'') => return StringEnd::At(end),
            // A reverse solidus for itself, and \S\ with the character it shifts, which may be an apostrophe.
            Some(b'\\') if text.get(end + 1) == Some(&b'\\') => end += 2,
            Some(b'\\') if text[end..].starts_with(b"\\S\\'") => end += 4,
            Some(b';') if record_follows(&text[end + 1..]) => return StringEnd::Lost(end),
            Some(_) => end += 1,
        }
    }
}

/// Whether a line break and the beginning of a record follow.
fn record_follows(rest: &[u8]) -> bool {
    let blank = rest.iter().take_while(|c| c.is_ascii_whitespace()).count();
    if !rest[..blank].contains(&b'\n') || rest.get(blank) != Some(&b'#') {
        return false;
    }
    let digits = rest[blank + 1..].iter().take_while(|c| c.is_ascii_digit()).count();
    let behind = &rest[blank + 1 + digits..];
    digits > 0 && behind.iter().find(|c| **c != b' ') == Some(&b'=')
}

/// The integer, where it fits.
fn int(digits: &[u8]) -> Option<i64> {
    let (negative, digits) = match digits {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        rest => (false, rest),
    };
    if digits.is_empty() {
        return None;
    }
    let value = digits
        .iter()
        .try_fold(0_i64, |v, c| v.checked_mul(10)?.checked_add(i64::from(c.wrapping_sub(b'0'))))?;
    Some(if negative { -value } else { value })
}

/// Powers of ten that are exact.
const TENS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18,
    1e19, 1e20, 1e21, 1e22,
];

/// A number of at most 15 digits and a power of ten up to 22: one multiplication or division of exact numbers, hence
/// rounded correctly ([Clinger, How to read floating point numbers accurately, 1990]). `None` for any other.
fn short(digits: &[u8]) -> Option<f64> {
    let (mut mantissa, mut count, mut power, mut k) = (0_u64, 0_u32, 0_i32, 0);
    let negative = digits[0] == b'-';
    if matches!(digits[0], b'-' | b'+') {
        k = 1;
    }
    let (mut point, mut any) = (false, false);
    while let Some(c) = digits.get(k) {
        match c {
            b'0'..=b'9' => {
                any = true;
                count += u32::from(count > 0 || *c != b'0');
                if count > 15 {
                    return None;
                }
                mantissa = mantissa * 10 + u64::from(c - b'0');
                power -= i32::from(point);
            }
            b'.' if !point => point = true,
            b'e' | b'E' => break,
            _ => return None,
        }
        k += 1;
    }
    if !any {
        return None;
    }
    if k < digits.len() {
        let e = int(&digits[k + 1..])?;
        power += i32::try_from(e).ok().filter(|e| e.abs() < 400)?;
    }
    let value = match power {
        0..=22 => mantissa as f64 * TENS[power as usize],
        -22..=-1 => mantissa as f64 / TENS[-power as usize],
        _ => return None,
    };
    Some(if negative { -value } else { value })
}

/// Offset of the first occurrence of `what`.
pub(crate) fn find(text: &[u8], what: &[u8]) -> Option<usize> {
    let first = *what.first()?;
    let mut from = 0;
    while let Some(n) = text[from..].iter().position(|c| *c == first) {
        if text[from + n..].starts_with(what) {
            return Some(from + n);
        }
        from += n + 1;
    }
    None
}

#[cfg(test)]
mod tests;
