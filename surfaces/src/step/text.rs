//! Strings of Part 21: the control directives `''`, `\\`, `\S\`, `\P.\`, `\X\`, `\X2\` and `\X4\` (ISO 10303-21, 6.4.3).

use super::lexer::find;

/// Decodes the control directives of a string. A malformed directive stays as it is written.
pub(crate) fn decode(raw: &[u8]) -> String {
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
        } else if let [b'\\', b'P', b'A'..=b'I', b'\\', ..] = rest {
            // The choice of another part of ISO 8859; the characters keep their codes.
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
    let digits = digits.filter(|d| !d.is_empty() && d.len() <= 8)?;
    digits.iter().try_fold(0_u32, |acc, d| Some((acc << 4) | char::from(*d).to_digit(16)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strings_decode_their_directives() {
        let one = |s: &str| decode(s.as_bytes());
        assert_eq!(one(r"a''b"), "a'b");
        assert_eq!(one(r"\X2\00E90416\X0\\S\d z"), "\u{e9}\u{416}\u{e4} z");
        assert_eq!(one(r"\X\E9 \X4\0001F600\X0\"), "\u{e9} \u{1f600}");
        assert_eq!(one("c:\\\\x"), "c:\\x");
        assert_eq!(one("two\r\nlines"), "twolines");
        assert_eq!(one(r"\X2\00"), "\u{0}");
        assert_eq!(one(r"\PE\\S\0"), "\u{b0}");
        assert_eq!(one(r"\X4\"), "");
    }
}
