//! Numbers as controls take them: a fixed count of decimals, no exponent, no `-0`.
//!
//! Positions are whole multiples of the output resolution from the moment they are rounded. Whether a word changes,
//! how long a block is and what F must be are all decided on these integers, so a residue below the resolution can
//! neither produce a word nor an F.

/// Decimals of positions, in mm and deg.
pub const DECIMALS: usize = 4;

/// Counts per mm or deg.
pub const COUNTS_PER_UNIT: f64 = 10_000.0;

/// A position in counts, or `None` where it is not finite or beyond what an axis word can hold.
///
/// ```
/// use osculate_postproc::nc::number::{counts, plain, value};
///
/// let twelve = counts(-12.5).expect("no axis is that long");
/// assert_eq!((twelve, value(twelve), plain(twelve)), (-125_000, -12.5, "-12.5".to_owned()));
/// // What is below the resolution is gone, the sign with it.
/// assert_eq!(counts(-0.00004).map(plain).as_deref(), Some("0"));
/// assert_eq!(counts(f64::NAN), None);
/// ```
#[must_use]
pub fn counts(value: f64) -> Option<i64> {
    // 10^9 mm or deg in counts: far beyond any machine, far within the exact integers of f64.
    const LARGEST: f64 = 1e13;
    let rounded = (value * COUNTS_PER_UNIT).round();
    // The range check makes the conversion exact.
    #[allow(clippy::cast_possible_truncation)]
    (rounded.abs() <= LARGEST).then_some(rounded as i64)
}

/// The position in mm or deg that stands for the counts.
#[must_use]
pub fn value(counts: i64) -> f64 {
    counts as f64 / COUNTS_PER_UNIT
}

/// Fixed decimals.
#[must_use]
pub fn fixed(counts: i64) -> String {
    let mut text = String::new();
    push_fixed(&mut text, counts);
    text
}

/// Without trailing zeros: `0`, `-12.5`.
#[must_use]
pub fn plain(counts: i64) -> String {
    let text = fixed(counts);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Adds a position with fixed decimals.
pub fn push_fixed(text: &mut String, counts: i64) {
    if counts < 0 {
        text.push('-');
    }
    push_decimal(text, counts.unsigned_abs(), DECIMALS);
}

/// Adds a position with fewer decimals than counts have; the count is a multiple of what is left out.
pub(crate) fn push_rounded(text: &mut String, counts: i64, decimals: usize) {
    let step = 10i64.pow(u32::try_from(DECIMALS.saturating_sub(decimals)).unwrap_or_default());
    if counts < 0 {
        text.push('-');
    }
    push_decimal(text, (counts / step).unsigned_abs(), decimals.min(DECIMALS));
}

/// The count rounded to so many decimals.
#[must_use]
pub(crate) fn to_decimals(counts: i64, decimals: usize) -> i64 {
    let step = 10i64.pow(u32::try_from(DECIMALS.saturating_sub(decimals)).unwrap_or_default());
    let half = if counts < 0 { -step / 2 } else { step / 2 };
    (counts + half) / step * step
}

/// `digits` with the point before the last `decimals` of them.
fn push_decimal(text: &mut String, digits: u64, decimals: usize) {
    // 20 digits are all of u64, and 17 decimals are the most that are asked for.
    let mut buffer = [b'0'; 40];
    let mut at = buffer.len();
    let (mut rest, mut count) = (digits, 0);
    loop {
        at -= 1;
        buffer[at] = b'0' + u8::try_from(rest % 10).unwrap_or_default();
        rest /= 10;
        count += 1;
        if count == decimals {
            at -= 1;
            buffer[at] = b'.';
        }
        if rest == 0 && count > decimals {
            break;
        }
    }
    text.extend(buffer[at..].iter().map(|b| char::from(*b)));
}

/// Adds a count with the given decimals.
pub(crate) fn push_count(text: &mut String, counts: i64, decimals: usize) {
    if counts < 0 {
        text.push('-');
    }
    push_decimal(text, counts.unsigned_abs(), decimals);
}

/// Adds a whole number.
pub fn push_whole(text: &mut String, value: u64) {
    push_decimal(text, value, 0);
}

/// Digits that an F word carries at least.
const FEED_DIGITS: i32 = 7;

/// F with seven digits, without trailing zeros. A positive feed never becomes zero.
///
/// ```
/// use osculate_postproc::nc::number::feed;
///
/// assert_eq!((feed(600.0), feed(1.0 / 3.0)), ("600".to_owned(), "0.3333333".to_owned()));
/// // However slow, it is not zero.
/// assert!(feed(1e-9).parse::<f64>()? > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn feed(value: f64) -> String {
    let mut text = String::new();
    push_feed(&mut text, value);
    text
}

/// Adds F with seven digits, without trailing zeros.
pub fn push_feed(text: &mut String, value: f64) {
    // Digits before the point; zero or negative below 1. The cast saturates, and the count is clamped below.
    #[allow(clippy::cast_possible_truncation)]
    let whole_digits = value.log10().floor() as i32 + 1;
    // 15 decimals still tell 1e-9 from zero; no block takes longer than that.
    let decimals = usize::try_from((FEED_DIGITS - whole_digits).clamp(0, 15)).unwrap_or_default();
    let scaled = value * POWERS[decimals];
    let start = text.len();
    // Where the scaled value is a whole number that u64 and f64 hold exactly, it is written digit by digit.
    if (0.5..9e15).contains(&scaled) {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        push_decimal(text, scaled.round() as u64, decimals);
    } else {
        text.push_str(&format!("{value:.decimals$}"));
    }
    if text[start..].contains('.') {
        let kept = text[start..].trim_end_matches('0').trim_end_matches('.').len();
        text.truncate(start + kept);
    }
}

/// Powers of ten, all exact in f64.
const POWERS: [f64; 16] =
    [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn fixed_numbers() {
        assert_eq!(fixed(0), "0.0000");
        assert_eq!(fixed(counts(-0.000_04).unwrap()), "0.0000");
        assert_eq!(fixed(-1), "-0.0001");
        assert_eq!(fixed(-123_456), "-12.3456");
        assert_eq!(counts(f64::NAN), None);
        assert_eq!(counts(f64::INFINITY), None);
        assert_eq!(counts(1e300), None);
    }

    #[test]
    fn feeds() {
        assert_eq!(feed(2000.0), "2000");
        assert_eq!(feed(1_562.049_935), "1562.05");
        assert_eq!(feed(0.012_345_678_9), "0.01234568");
        assert_eq!(feed(99_999.0), "99999");
        assert_eq!(feed(1e-9), "0.000000001");
        assert_eq!(feed(123_456_789.0), "123456789");
    }

    proptest! {
        #[test]
        fn a_feed_keeps_its_digits(exponent in -6.0..5.0f64) {
            let f = 10f64.powf(exponent);
            let back: f64 = feed(f).parse().unwrap();
            // Half a unit in the seventh digit of a number that starts with 1.
            prop_assert!((back / f - 1.0).abs() <= 0.5e-6 && back > 0.0);
        }

        #[test]
        fn positions_round_once(x in -1e5..1e5f64) {
            let text = fixed(counts(x).unwrap());
            let back: f64 = text.parse().unwrap();
            prop_assert!((back - x).abs() <= 0.5 / COUNTS_PER_UNIT + 1e-10);
            prop_assert!(!text.contains('e') && text != "-0.0000");
        }
    }
}
