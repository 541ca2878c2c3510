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
    let sign = if counts < 0 { "-" } else { "" };
    let (whole, part) = (counts.unsigned_abs() / 10_000, counts.unsigned_abs() % 10_000);
    format!("{sign}{whole}.{part:0DECIMALS$}")
}

/// Digits that an F word carries at least.
const FEED_DIGITS: i32 = 7;

/// F with seven digits, without trailing zeros. A positive feed never becomes zero.
#[must_use]
pub fn feed(value: f64) -> String {
    // Digits before the point; zero or negative below 1. The cast saturates, and the count is clamped below.
    #[allow(clippy::cast_possible_truncation)]
    let whole_digits = value.log10().floor() as i32 + 1;
    // 15 decimals still tell 1e-9 from zero; no block takes longer than that.
    let decimals = usize::try_from((FEED_DIGITS - whole_digits).clamp(0, 15)).unwrap_or_default();
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_string() } else { text }
}

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
