//! Rust source reduced to what the checks read: comments and literals blanked, test items blanked.
//!
//! This is a scan and not a parser. It knows line comments, nested block comments, strings with escapes, raw strings,
//! character literals and lifetimes. Lines keep their numbers.

/// The source with every comment and the content of every literal replaced by blanks.
pub fn code_only(text: &str) -> String {
    let chars: Vec<char> = text.chars().collect();
    let mut out = String::with_capacity(text.len());
    let mut at = 0;
    while at < chars.len() {
        let end = match (chars[at], chars.get(at + 1)) {
            ('/', Some('/')) => find(&chars, at, |c| c == '\n').unwrap_or(chars.len()),
            ('/', Some('*')) => block_comment_end(&chars, at),
            ('"', _) => string_end(&chars, at),
            ('\'', _) => quote_end(&chars, at),
            _ => at,
        };
        if end == at {
            out.push(chars[at]);
            at += 1;
        } else {
            out.extend(chars[at..end].iter().map(|&c| if c == '\n' { '\n' } else { ' ' }));
            at = end;
        }
    }
    out
}

fn find(chars: &[char], from: usize, wanted: impl Fn(char) -> bool) -> Option<usize> {
    (from..chars.len()).find(|&i| wanted(chars[i]))
}

/// The place after the block comment that begins at `at`; block comments nest.
fn block_comment_end(chars: &[char], at: usize) -> usize {
    let (mut depth, mut i) = (0usize, at);
    while i < chars.len() {
        match (chars[i], chars.get(i + 1)) {
            ('/', Some('*')) => (depth, i) = (depth + 1, i + 2),
            ('*', Some('/')) => (depth, i) = (depth - 1, i + 2),
            _ => i += 1,
        }
        if depth == 0 {
            return i;
        }
    }
    chars.len()
}

/// The place after the string whose opening quote is at `at`: raw where `r`, `br` or `cr` and any number of `#` stand
/// before the quote.
fn string_end(chars: &[char], at: usize) -> usize {
    let before = chars[..at].iter().rev();
    let hashes = before.clone().take_while(|c| **c == '#').count();
    let prefix: String = before.skip(hashes).take_while(|c| is_word(**c)).collect();
    if matches!(prefix.as_str(), "r" | "rb" | "rc") {
        let closes = |i: &usize| chars[*i] == '"' && chars[i + 1..].iter().take(hashes).all(|c| *c == '#');
        let fits = |i: &usize| i + hashes < chars.len();
        return (at + 1..chars.len()).filter(fits).find(closes).map_or(chars.len(), |i| i + 1 + hashes);
    }
    let mut i = at + 1;
    while i < chars.len() && chars[i] != '"' {
        i += if chars[i] == '\\' { 2 } else { 1 };
    }
    (i + 1).min(chars.len())
}

/// The place after a character literal, or `at` itself where the quote begins a lifetime.
fn quote_end(chars: &[char], at: usize) -> usize {
    match (chars.get(at + 1), chars.get(at + 2)) {
        (Some('\\'), Some(_)) => find(chars, at + 3, |c| c == '\'').map_or(chars.len(), |i| i + 1),
        (Some(_), Some('\'')) => at + 3,
        _ => at,
    }
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// The attribute that marks an item as compiled for tests only.
const TEST_ONLY: &str = "#[cfg(test)]";

/// The code (from [`code_only`]) with every test-only item blanked, and the names of the test-only modules that stand
/// in files of their own.
pub fn without_tests(code: &str) -> (String, Vec<String>) {
    if code.contains("#![cfg(test)]") {
        return (blank(code), Vec::new());
    }
    let (mut kept, mut modules) = (String::with_capacity(code.len()), Vec::new());
    let mut rest = code;
    while let Some(start) = rest.find(TEST_ONLY) {
        let (before, item) = rest.split_at(start);
        let (item, after) = item.split_at(item_end(item));
        kept.push_str(before);
        kept.push_str(&blank(item));
        if let Some(name) = item.strip_suffix(';').and_then(|i| i.rsplit_once("mod ")) {
            modules.push(name.1.trim().to_owned());
        }
        rest = after;
    }
    kept.push_str(rest);
    (kept, modules)
}

fn blank(code: &str) -> String {
    code.chars().map(|c| if c == '\n' { '\n' } else { ' ' }).collect()
}

/// The length of the item at the start of `code`: up to its `;`, or up to the brace that closes its body.
/// Attributes and signatures keep their own brackets balanced.
fn item_end(code: &str) -> usize {
    let (mut inner, mut braces) = (0i32, 0i32);
    for (i, c) in code.char_indices() {
        match c {
            '(' | '[' => inner += 1,
            ')' | ']' => inner -= 1,
            '{' => braces += 1,
            '}' => braces -= 1,
            _ => {}
        }
        if (c == ';' && inner == 0 && braces == 0) || (c == '}' && braces == 0) {
            return i + c.len_utf8();
        }
    }
    code.len()
}

/// The byte places where `wanted` stands as a word of its own: neither a letter, a digit nor `_` on either side of it.
/// A side of `wanted` that is no letter itself needs no border.
pub fn words<'a>(line: &'a str, wanted: &'a str) -> impl Iterator<Item = usize> + 'a {
    let ends_free = |inside: Option<char>, outside: Option<char>| {
        !(inside.is_some_and(is_word) && outside.is_some_and(is_word))
    };
    line.match_indices(wanted).map(|(at, _)| at).filter(move |&at| {
        let (before, after) = (line[..at].chars().next_back(), line[at + wanted.len()..].chars().next());
        ends_free(wanted.chars().next(), before) && ends_free(wanted.chars().next_back(), after)
    })
}

/// Whether [`words`] finds any.
pub fn has_word(line: &str, wanted: &str) -> bool {
    words(line, wanted).next().is_some()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_and_literals_are_blanked_and_lines_stay() {
        let text = "let a = \"x // y\"; // b\n/* c /* d */ e */ f('\\'', 'g', '\"', &'h str);\nr#\"i\"j\"# k";
        let code = code_only(text);
        assert_eq!(code.lines().count(), text.lines().count());
        let letters: String = code.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(letters, "let a = ; f( , , , &'h str); r# k");
    }

    #[test]
    fn unfinished_literals_end_with_the_file() {
        for text in ["\"a", "r##\"a\"#", "/* a", "'\\", "'", "\"a\\"] {
            assert!(!code_only(text).contains('a'), "{text}");
        }
    }

    #[test]
    fn test_items_are_blanked() {
        let code = "fn a() {}\n#[cfg(test)]\n#[allow(x)]\nmod tests {\n fn b() { c(); }\n}\nfn d() {}\n\
                    #[cfg(test)]\nmod e;\n#[cfg(test)]\npub fn f(x: [u8; 2]) { g() }\nfn h() {}";
        let (kept, modules) = without_tests(code);
        assert_eq!(kept.lines().count(), code.lines().count());
        assert_eq!(kept.split_whitespace().collect::<String>(), "fna(){}fnd(){}fnh(){}");
        assert_eq!(modules, ["e"]);
        assert_eq!(without_tests("#![cfg(test)]\nfn a() {}").0.trim(), "");
    }

    #[test]
    fn words_have_borders() {
        assert!(has_word("a dbg!(b)", "dbg!") && has_word("x.mul_add(1)", ".mul_add("));
        assert!(!has_word("a_dbg!(b)", "dbg!") && !has_word("prints", "print"));
        assert_eq!(words("ab a ab a", "a").collect::<Vec<_>>(), [3, 8]);
    }
}
