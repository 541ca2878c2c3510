//! Tokens of a Part 21 exchange file (ISO 10303-21, clear text encoding).
//!
//! Lenient where dialects differ and the meaning is plain: comments anywhere between tokens, blanks of any kind
//! (tabs, form feeds, CR LF), integers for reals, `D` for `E` in exponents, exponents without a point. Keywords are
//! folded to upper case; control directives in strings (`''`, `\S\`, `\X\`, `\X2\`, `\X4\`) are decoded.

/// One token.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Token {
    /// `#12`.
    Id(u64),
    /// A keyword, upper case; user-defined ones keep their `!`.
    Word(String),
    /// A number written without point and exponent.
    Int(i64),
    /// Any other number.
    Real(f64),
    /// A decoded string.
    Text(String),
    /// `.T.` without its points, upper case.
    Enum(String),
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
}

/// Why there is no next token.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Stop {
    /// The text ended, inside a token or comment where the flag is set.
    End {
        /// True where a string, a comment or another bracketed token was still open.
        open: bool,
    },
    /// A character that begins no token, or a malformed one.
    Bad {
        /// What is wrong.
        what: String,
    },
}

/// A reader of tokens.
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

    fn peek(&self, ahead: usize) -> Option<u8> {
        self.text.get(self.at + ahead).copied()
    }

    /// Skips blanks, comments and the print control directives `\N\` and `\F\`.
    fn skip_blank(&mut self) -> Result<(), Stop> {
        loop {
            match self.peek(0) {
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
                // Control characters and a byte order mark count as blanks.
                Some(c) if c <= b' ' || c == 0x7f || matches!(c, 0xef | 0xbb | 0xbf) => self.at += 1,
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
                Err(Stop::Bad { .. }) => {}
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
            b'(' => Some(Token::Open),
            b')' => Some(Token::Close),
            b',' => Some(Token::Comma),
            b';' => Some(Token::Semicolon),
            b'=' => Some(Token::Equals),
            b'$' => Some(Token::Omitted),
            b'*' => Some(Token::Derived),
            _ => None,
        };
        if let Some(token) = simple {
            self.at += 1;
            return Ok(token);
        }
        match c {
            b'#' | b'@' => self.id(),
            b'\'' => self.string(),
            b'"' => self.bracketed(b'"', Token::Binary),
            b'<' => self.bracketed(b'>', Token::Resource),
            b'.' if self.peek(1).is_some_and(|d| d.is_ascii_alphabetic() || d == b'_') => self.enumeration(),
            b'0'..=b'9' | b'+' | b'-' | b'.' => self.number(),
            b'!' | b'_' => self.word(),
            c if c.is_ascii_alphabetic() => self.word(),
            c => {
                self.at += 1;
                Err(Stop::Bad { what: format!("byte 0x{c:02x} begins no token") })
            }
        }
    }

    fn id(&mut self) -> Result<Token, Stop> {
        self.at += 1;
        let start = self.at;
        while self.peek(0).is_some_and(|c| c.is_ascii_digit()) {
            self.at += 1;
        }
        let digits = &self.text[start..self.at];
        if digits.is_empty() {
            // `#name` of edition 3: a reference to a constant or an external value.
            while self.peek(0).is_some_and(|c| c.is_ascii_alphanumeric() || c == b'_') {
                self.at += 1;
            }
            return Err(Stop::Bad { what: "a reference without a number".into() });
        }
        let mut id: u64 = 0;
        for d in digits {
            id = match id.checked_mul(10).and_then(|v| v.checked_add(u64::from(d - b'0'))) {
                Some(v) => v,
                None => return Err(Stop::Bad { what: "an instance number above 2^64".into() }),
            };
        }
        Ok(Token::Id(id))
    }

    fn word(&mut self) -> Result<Token, Stop> {
        let start = self.at;
        self.at += 1;
        while self.peek(0).is_some_and(|c| c.is_ascii_alphanumeric() || c == b'_' || c == b'-') {
            self.at += 1;
        }
        let bytes = self.text[start..self.at].to_ascii_uppercase();
        Ok(Token::Word(String::from_utf8_lossy(&bytes).into_owned()))
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
                let bytes = self.text[start..end].to_ascii_uppercase();
                Ok(Token::Enum(String::from_utf8_lossy(&bytes).into_owned()))
            }
            Some(_) => {
                self.at = end;
                Err(Stop::Bad { what: "an enumeration value without its closing point".into() })
            }
            None => {
                self.at = end;
                Err(Stop::End { open: true })
            }
        }
    }

    fn bracketed(&mut self, close: u8, token: Token) -> Result<Token, Stop> {
        match self.text[self.at + 1..].iter().position(|c| *c == close) {
            Some(n) => {
                self.at += n + 2;
                Ok(token)
            }
            None => {
                self.at = self.text.len();
                Err(Stop::End { open: true })
            }
        }
    }

    fn number(&mut self) -> Result<Token, Stop> {
        let start = self.at;
        if matches!(self.peek(0), Some(b'+' | b'-')) {
            self.at += 1;
        }
        let mut integer = true;
        let mut text = String::with_capacity(24);
        while let Some(c) = self.peek(0) {
            match c {
                b'0'..=b'9' => {}
                b'.' => integer = false,
                b'e' | b'E' | b'd' | b'D' => {
                    integer = false;
                    if matches!(self.peek(1), Some(b'+' | b'-')) {
                        self.at += 1;
                    }
                }
                _ => break,
            }
            self.at += 1;
        }
        for c in &self.text[start..self.at] {
            text.push(match c {
                b'd' | b'D' => 'e',
                c => char::from(*c),
            });
        }
        if integer && let Ok(i) = text.parse::<i64>() {
            return Ok(Token::Int(i));
        }
        match text.parse::<f64>() {
            Ok(x) if x.is_finite() => Ok(Token::Real(x)),
            _ => Err(Stop::Bad { what: format!("'{text}' is no finite number") }),
        }
    }

    fn string(&mut self) -> Result<Token, Stop> {
        let start = self.at + 1;
        let mut end = start;
        loop {
            match self.text.get(end) {
                None => {
                    self.at = self.text.len();
                    return Err(Stop::End { open: true });
                }
                Some(b'\'') if self.text.get(end + 1) == Some(&b'\'') => end += 2,
                Some(b'\'') => break,
                Some(_) => end += 1,
            }
        }
        self.at = end + 1;
        Ok(Token::Text(decode(&self.text[start..end])))
    }
}

/// Offset of the first occurrence of `what`.
pub(crate) fn find(text: &[u8], what: &[u8]) -> Option<usize> {
    text.windows(what.len()).position(|w| w == what)
}

/// Decodes the control directives of a string. A malformed directive stays as it is written.
fn decode(raw: &[u8]) -> String {
    let mut out = String::with_capacity(raw.len());
    let mut k = 0;
    // Text outside directives may be UTF-8 (edition 3 and many writers): collect bytes, convert in one go.
    let mut plain: Vec<u8> = Vec::with_capacity(raw.len());
    let flush = |plain: &mut Vec<u8>, out: &mut String| {
        out.push_str(&String::from_utf8_lossy(plain));
        plain.clear();
    };
    while k < raw.len() {
        let rest = &raw[k..];
        if rest.starts_with(b"''") {
            plain.push(b'\'');
            k += 2;
        } else if rest.starts_with(b"\\\\") {
            plain.push(b'\\');
            k += 2;
        } else if rest.starts_with(b"\\S\\") && rest.len() > 3 {
            // ISO 8859-1 upper half is the part of \S\ that is in use.
            flush(&mut plain, &mut out);
            out.push(char::from(rest[3] | 0x80));
            k += 4;
        } else if rest.starts_with(b"\\X\\") && hex(rest.get(3..5)).is_some() {
            flush(&mut plain, &mut out);
            out.extend(hex(rest.get(3..5)).and_then(char::from_u32));
            k += 5;
        } else if rest.starts_with(b"\\X2\\") || rest.starts_with(b"\\X4\\") {
            let width = if rest[2] == b'2' { 4 } else { 8 };
            let body_end = find(&rest[4..], b"\\X0\\").map_or(rest.len(), |e| e + 4);
            flush(&mut plain, &mut out);
            let codes: Vec<u32> = rest[4..body_end].chunks(width).filter_map(|c| hex(Some(c))).collect();
            if width == 4 {
                let units: Vec<u16> = codes.iter().map(|c| *c as u16).collect();
                out.push_str(&String::from_utf16_lossy(&units));
            } else {
                out.extend(codes.iter().map(|c| char::from_u32(*c).unwrap_or('\u{fffd}')));
            }
            k += (body_end + 4).min(rest.len());
        } else {
            // Line ends inside a string are no part of it.
            if !matches!(raw[k], b'\r' | b'\n') {
                plain.push(raw[k]);
            }
            k += 1;
        }
    }
    flush(&mut plain, &mut out);
    out
}

fn hex(digits: Option<&[u8]>) -> Option<u32> {
    let digits = digits.filter(|d| !d.is_empty())?;
    digits.iter().try_fold(0_u32, |acc, d| Some((acc << 4) | char::from(*d).to_digit(16)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(text: &str) -> Vec<Token> {
        let mut lexer = Lexer::new(text.as_bytes(), 0);
        let mut out = Vec::new();
        while let Ok(t) = lexer.next() {
            out.push(t);
        }
        out
    }

    #[test]
    fn numbers_of_all_dialects() {
        assert_eq!(
            all("1 -2 1. 1.E-3 1.5D+02 1E0 -.5 +7"),
            [
                Token::Int(1),
                Token::Int(-2),
                Token::Real(1.0),
                Token::Real(1e-3),
                Token::Real(150.0),
                Token::Real(1.0),
                Token::Real(-0.5),
                Token::Int(7)
            ]
        );
        let mut big = Lexer::new(b"1.E999 #3", 0);
        assert!(matches!(big.next(), Err(Stop::Bad { .. })));
        assert_eq!(big.next(), Ok(Token::Id(3)));
    }

    #[test]
    fn strings_decode_their_directives() {
        let one = |s: &str| match all(s).remove(0) {
            Token::Text(t) => t,
            other => panic!("{other:?}"),
        };
        assert_eq!(one(r"'a''b'"), "a'b");
        assert_eq!(one(r"'\X2\00E90416\X0\\S\d z'"), "\u{e9}\u{416}\u{e4} z");
        assert_eq!(one(r"'\X\E9 \X4\0001F600\X0\'"), "\u{e9} \u{1f600}");
        assert_eq!(one("'c:\\\\x'"), "c:\\x");
        assert_eq!(one("'two\r\nlines'"), "twolines");
        assert_eq!(one(r"'\X2\00'"), "\u{0}");
    }

    #[test]
    fn comments_enumerations_and_brackets() {
        assert_eq!(
            all("/* ; ' */ .T. /**/$*\"0F\"<a#b>!MY"),
            [
                Token::Enum("T".into()),
                Token::Omitted,
                Token::Derived,
                Token::Binary,
                Token::Resource,
                Token::Word("!MY".into())
            ]
        );
    }

    #[test]
    fn open_ends_are_told_from_ends() {
        for text in ["'abc", "/* x", "\"0F", ".UNSPEC"] {
            assert_eq!(Lexer::new(text.as_bytes(), 0).next(), Err(Stop::End { open: true }), "{text}");
        }
        assert_eq!(Lexer::new(b"  \t\x0c", 0).next(), Err(Stop::End { open: false }));
    }

    #[test]
    fn a_statement_is_skipped_past_strings() {
        let mut lexer = Lexer::new(b"A('x;y') ? ; #4", 0);
        assert!(lexer.skip_statement());
        assert_eq!(lexer.next(), Ok(Token::Id(4)));
        assert!(!lexer.skip_statement());
    }
}
