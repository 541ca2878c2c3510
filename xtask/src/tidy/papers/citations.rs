//! What a line cites of a paper: `[R97, eq. 37]`, `[R97, eqs. 31 to 35]`, `R97 (37)`, `[Z17, Fig. 4]`, `D98's figure 7`.

/// What papers number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sort {
    Equation,
    Figure,
    Table,
}

impl Sort {
    /// As a row is numbered.
    pub fn number(self, number: u32) -> String {
        let word = match self {
            Self::Equation => "eq.",
            Self::Figure => "fig.",
            Self::Table => "table",
        };
        format!("{word} {number}")
    }
}

/// Words before numbers.
const WORDS: [(&str, Sort); 10] = [
    ("eqs.", Sort::Equation),
    ("eq.", Sort::Equation),
    ("Figs.", Sort::Figure),
    ("figs.", Sort::Figure),
    ("Fig.", Sort::Figure),
    ("fig.", Sort::Figure),
    ("figures", Sort::Figure),
    ("figure", Sort::Figure),
    ("Table", Sort::Table),
    ("table", Sort::Table),
];

/// The numbers cited in a line, with the key of their paper, as rows are numbered.
pub fn cited(line: &str, keys: &[&'static str]) -> Vec<(&'static str, String)> {
    let mut out = Vec::new();
    for key in keys {
        for (at, _) in line.match_indices(key) {
            let inside = line[..at].chars().next_back().is_some_and(|c| c.is_alphanumeric() || c == '_');
            if !inside {
                out.extend(numbers(&line[at + key.len()..]).into_iter().map(|number| (*key, number)));
            }
        }
    }
    out
}

/// The numbers that follow a key.
fn numbers(after: &str) -> Vec<String> {
    let rest = after.strip_prefix("'s").unwrap_or(after);
    let rest = rest.strip_prefix(',').unwrap_or(rest);
    let Some(rest) = rest.strip_prefix(' ') else { return Vec::new() };
    let word = WORDS.iter().find_map(|(word, sort)| Some((*sort, rest.strip_prefix(word)?)));
    let (sort, mut rest) = word.unwrap_or((Sort::Equation, rest));
    let (mut out, mut range) = (Vec::new(), None);
    while let Some((number, next)) = number(rest) {
        let first = range.map_or(number, |low: u32| low + 1);
        out.extend((first..=number).map(|n| sort.number(n)));
        let step = [(", ", false), (" and ", false), (" to ", true), ("-", true)];
        let Some((further, through)) = step.iter().find_map(|(s, r)| Some((next.strip_prefix(*s)?, *r)))
        else {
            break;
        };
        (rest, range) = (further, through.then_some(number));
    }
    out
}

/// A whole number, maybe in parentheses, and what follows; a section such as `2.1` and a name such as `5C` are none.
fn number(text: &str) -> Option<(u32, &str)> {
    let text = text.trim_start_matches([' ', '(']);
    let end = text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
    let (digits, rest) = text.split_at(end);
    let mut following = rest.chars();
    let goes_on = match (following.next(), following.next()) {
        (Some('.'), Some(c)) => c.is_ascii_digit(),
        (Some(c), _) => c.is_alphanumeric() || c == '_',
        (None, _) => false,
    };
    if goes_on { None } else { Some((digits.parse().ok()?, rest.strip_prefix(')').unwrap_or(rest))) }
}
