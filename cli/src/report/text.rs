//! Text for the page: its style sheet, escaping, numbers with sensible digits, base64.

/// How all pages look.
pub(super) const STYLE: &str = include_str!("../../assets/report.css");

/// `text` with the five characters escaped that mean something to HTML and XML, in content and in quoted
/// attributes. Control characters that XML forbids become U+FFFD, so that the picture stays well-formed.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\t' | '\n' => out.push(c),
            '\u{FFFE}' | '\u{FFFF}' => out.push('\u{FFFD}'),
            c if c.is_control() => out.push('\u{FFFD}'),
            c => out.push(c),
        }
    }
    out
}

/// JSON that can stand inside a `script` element: `<`, `>` and `&` occur in JSON only within strings, where their
/// `\u` forms mean the same, and without `<` nothing can end the element or open a comment.
pub fn script_json(value: &serde_json::Value) -> String {
    value.to_string().replace('<', "\\u003c").replace('>', "\\u003e").replace('&', "\\u0026")
}

/// `value` with `digits` significant digits, without an exponent where it lies between 1e-5 and 1e7, thousands apart.
/// What is not finite becomes a dash.
pub fn figure(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return "\u{2013}".into();
    }
    if value == 0.0 {
        return "0".into();
    }
    // The exponent after rounding: 9.996 with three digits is 10.0, not 10.00.
    let rounded = format!("{value:.*e}", digits.max(1) - 1);
    let exponent: i32 = rounded.rsplit_once('e').and_then(|(_, e)| e.parse().ok()).unwrap_or(0);
    if !(-5..7).contains(&exponent) {
        return rounded.replace('-', "\u{2212}");
    }
    let decimals = (digits.max(1) as i32 - 1 - exponent).max(0) as usize;
    grouped(&format!("{value:.decimals$}"))
}

/// [`figure`] without the zeros at its end: for ticks and limits, which are round.
pub fn short(value: f64, digits: usize) -> String {
    let text = figure(value, digits);
    if text.contains('.') && !text.contains('e') {
        text.trim_end_matches('0').trim_end_matches('.').into()
    } else {
        text
    }
}

/// `value` with a fixed number of decimals; a dash where it is not finite, and no minus before a zero.
pub fn fixed(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return "\u{2013}".into();
    }
    let text = format!("{value:.decimals$}");
    let zero = text.bytes().all(|b| matches!(b, b'-' | b'0' | b'.'));
    grouped(if zero { text.trim_start_matches('-') } else { &text })
}

/// A count, thousands apart.
pub fn count(value: usize) -> String {
    grouped(&value.to_string())
}

/// Thin spaces between groups of three before the decimal point (from five digits on), and a real minus sign.
fn grouped(text: &str) -> String {
    let (sign, digits) = text.strip_prefix('-').map_or(("", text), |rest| ("\u{2212}", rest));
    let whole = digits.find('.').unwrap_or(digits.len());
    let mut out = String::from(sign);
    for (i, c) in digits.char_indices() {
        if i > 0 && i < whole && whole > 4 && (whole - i).is_multiple_of(3) {
            out.push('\u{2009}');
        }
        out.push(c);
    }
    out
}

/// A coordinate of a drawing: one decimal, trailing zeros dropped.
pub fn coordinate(value: f64) -> String {
    let text = format!("{value:.1}");
    let text = text.strip_suffix(".0").unwrap_or(&text);
    if text == "-0" { "0".into() } else { text.into() }
}

/// Standard base64 with padding (RFC 4648, section 4).
pub fn base64(bytes: &[u8]) -> String {
    const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let get = |i: usize| u32::from(chunk.get(i).copied().unwrap_or(0));
        let word = (get(0) << 16) | (get(1) << 8) | get(2);
        for i in 0..4 {
            if i <= chunk.len() {
                out.push(char::from(ALPHABET[(word >> (18 - 6 * i)) as usize & 63]));
            } else {
                out.push('=');
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn markup_is_escaped() {
        assert_eq!(
            escape("<b a=\"1\" c='2'>&</b>"),
            "&lt;b a=&quot;1&quot; c=&#39;2&#39;&gt;&amp;&lt;/b&gt;"
        );
        assert_eq!(escape("a\u{0}b\u{1b}c\nd"), "a\u{FFFD}b\u{FFFD}c\nd");
    }

    #[test]
    fn json_cannot_leave_its_script_element() {
        let text = script_json(&serde_json::json!({"name": "</script><!-- & \u{2028}"}));
        assert!(!text.contains('<') && !text.contains('>') && !text.contains('&'), "{text}");
        let back: serde_json::Value = serde_json::from_str(&text).expect("it is still JSON");
        assert_eq!(back["name"], "</script><!-- & \u{2028}");
    }

    #[test]
    fn base64_agrees_with_the_vectors_of_rfc_4648() {
        for (plain, coded) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
        assert_eq!(base64(&[0xfb, 0xff, 0xfe]), "+//+");
    }

    #[test]
    fn figures_have_the_digits_asked_for() {
        assert_eq!(figure(0.009_996, 3), "0.0100");
        assert_eq!(figure(-12.345, 3), "\u{2212}12.3");
        assert_eq!(figure(123_456.7, 4), "123\u{2009}457");
        assert_eq!(figure(1234.0, 4), "1234");
        assert_eq!(figure(3.2e-9, 2), "3.2e\u{2212}9");
        assert_eq!(figure(f64::NAN, 3), "\u{2013}");
        assert_eq!([short(0.0200, 4), short(20.0, 4), short(1e-7, 3)], ["0.02", "20", "1.00e\u{2212}7"]);
        assert_eq!(fixed(-0.000_04, 3), "0.000");
        assert_eq!(fixed(1.25, 1), "1.2");
        assert_eq!(count(1_234_567), "1\u{2009}234\u{2009}567");
        assert_eq!(coordinate(-0.04), "0");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Escaped text holds no character that could open a tag or close a quoted attribute.
        #[test]
        fn nothing_escapes_the_escape(text in any::<String>()) {
            let out = escape(&text);
            prop_assert!(!out.contains(['<', '>', '"', '\'']));
            let back = out.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"").replace("&#39;", "'")
                .replace("&amp;", "&");
            prop_assert_eq!(back.chars().count(), text.chars().count());
        }

        /// The figure shown, read back, is within half a unit of its last digit: 5e-3 relative for three digits.
        #[test]
        fn a_figure_is_its_value(mantissa in 1.0..10.0_f64, exponent in -5..6_i32) {
            let value = mantissa * 10.0_f64.powi(exponent);
            let back: f64 = figure(value, 3).replace('\u{2009}', "").replace('\u{2212}', "-").parse().expect("a number");
            prop_assert!((back - value).abs() <= 5e-3 * value * (1.0 + 1e-9), "{} for {}", back, value);
        }
    }
}
