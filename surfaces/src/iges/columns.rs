//! Cards of 80 columns: lines or records, their section letters and fields.

use std::borrow::Cow;

/// A card and the number of its line, from one.
pub(crate) type Line<'b> = (u32, Cow<'b, [u8]>);

/// The cards of a text: lines, or 80-byte records where there are no line ends.
pub(crate) fn cards(bytes: &[u8]) -> impl Iterator<Item = Line<'_>> {
    let packed = !bytes.contains(&b'\n') && !bytes.contains(&b'\r');
    let mut rest = bytes;
    let mut number = 0_u32;
    std::iter::from_fn(move || {
        if rest.is_empty() {
            return None;
        }
        number = number.saturating_add(1);
        if packed {
            let (card, next) = rest.split_at(rest.len().min(80));
            rest = next;
            return Some((number, Cow::Borrowed(card)));
        }
        let end = rest.iter().position(|c| *c == b'\n' || *c == b'\r').unwrap_or(rest.len());
        let card = &rest[..end];
        // CR LF is one line end.
        let ends = if rest[end..].starts_with(b"\r\n") { 2 } else { 1 };
        rest = &rest[(end + ends).min(rest.len())..];
        Some((number, columns_of(card)))
    })
}

/// The card with a byte a column: characters beyond ASCII take several bytes in UTF-8 and one column each.
fn columns_of(card: &[u8]) -> Cow<'_, [u8]> {
    if card.len() <= 80 || card.is_ascii() {
        return Cow::Borrowed(card);
    }
    match std::str::from_utf8(card) {
        Ok(text) => Cow::Owned(text.chars().map(|c| u8::try_from(c).unwrap_or(b'?')).collect()),
        Err(_) => Cow::Borrowed(card),
    }
}

/// Section letter of a card, where it is one.
pub(crate) fn section(card: &[u8]) -> Option<u8> {
    let letter = *card.get(72)?;
    let numbered = card.get(73..card.len().min(80))?;
    let is_number =
        numbered.iter().all(|c| c.is_ascii_digit() || *c == b' ') && numbered.iter().any(u8::is_ascii_digit);
    (is_number && b"BCSGDPT".contains(&letter)).then_some(letter)
}

/// Columns `from..to` (from zero) of a card, without blanks around; empty beyond its end.
pub(crate) fn field(card: &[u8], from: usize, to: usize) -> &[u8] {
    card.get(from.min(card.len())..to.min(card.len())).unwrap_or(&[]).trim_ascii()
}

/// A whole number; nothing is zero.
pub(crate) fn integer(text: &[u8]) -> Option<i64> {
    if text.is_empty() { Some(0) } else { std::str::from_utf8(text).ok()?.parse().ok() }
}

/// Appends the first `width` columns of a card, blank beyond its end.
pub(crate) fn append(text: &mut Vec<u8>, card: &[u8], width: usize) {
    let n = card.len().min(width);
    text.extend_from_slice(&card[..n]);
    text.resize(text.len() + width - n, b' ');
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_card_needs_its_letter_and_number() {
        assert_eq!(section(format!("{:72}D{:>7}", "", 12).as_bytes()), Some(b'D'));
        assert_eq!(section(format!("{:72}Dx", "").as_bytes()), None);
        assert_eq!(section(b"short"), None);
    }

    #[test]
    fn line_ends_and_wide_characters() {
        let lines = |text: &str| cards(text.as_bytes()).map(|(k, c)| (k, c.len())).collect::<Vec<_>>();
        assert_eq!(lines("ab\r\nc\n\nd"), [(1, 2), (2, 1), (3, 0), (4, 1)]);
        assert_eq!(lines("ab\rc\r"), [(1, 2), (2, 1)]);
        assert_eq!(lines(&"x".repeat(170)), [(1, 80), (2, 80), (3, 10)]);
        // 70 letters of two bytes are 70 columns.
        let wide = format!("{:<72}S{:>7}\n", "é".repeat(70), 1);
        assert_eq!(cards(wide.as_bytes()).map(|c| section(&c.1)).collect::<Vec<_>>(), [Some(b'S')]);
    }
}
