//! Views of records and their parameters: nothing is copied out of the text but where it is asked for.

use super::parse::{Atom, Chunk, Entry};
use super::text::decode;

/// A parameter of a record.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Value<'g> {
    text: &'g [u8],
    atoms: &'g [Atom],
    /// Index of the atom; beyond the end for a missing parameter.
    at: usize,
}

impl<'g> Value<'g> {
    fn atom(&self) -> Atom {
        self.atoms.get(self.at).copied().unwrap_or(Atom::Nothing)
    }

    /// The number, integer or real; typed measures are looked through.
    pub(crate) fn number(&self) -> Option<f64> {
        match self.atom() {
            Atom::Int(i) => Some(i as f64),
            Atom::Real(x) => Some(x),
            Atom::Typed { end, .. } if end as usize == self.at + 2 => match self.atoms[self.at + 1] {
                Atom::Int(i) => Some(i as f64),
                Atom::Real(x) => Some(x),
                _ => None,
            },
            _ => None,
        }
    }

    /// The referenced instance.
    pub(crate) fn reference(&self) -> Option<u64> {
        match self.atom() {
            Atom::Ref(id) => Some(id),
            _ => None,
        }
    }

    /// The elements of a list; empty for anything else.
    pub(crate) fn list(&self) -> Args<'g> {
        let (from, to, count) = match self.atom() {
            Atom::List { end, count } => (self.at + 1, end as usize, count as usize),
            _ => (0, 0, 0),
        };
        Args { text: self.text, atoms: self.atoms, from, to, count: Some(count) }
    }

    /// `.T.` or `.F.`.
    pub(crate) fn flag(&self) -> Option<bool> {
        match self.word() {
            b"T" | b"t" => Some(true),
            b"F" | b"f" => Some(false),
            w if w.eq_ignore_ascii_case(b"TRUE") => Some(true),
            w if w.eq_ignore_ascii_case(b"FALSE") => Some(false),
            _ => None,
        }
    }

    /// The letters of an enumeration value as they are written, empty for anything else.
    pub(crate) fn word(&self) -> &'g [u8] {
        match self.atom() {
            Atom::Enum(span) => span.of(self.text),
            _ => b"",
        }
    }

    /// The letters of an enumeration value in upper case, empty for anything else.
    pub(crate) fn choice(&self) -> String {
        String::from_utf8_lossy(self.word()).to_ascii_uppercase()
    }

    /// The text of a string, empty for anything else.
    pub(crate) fn text(&self) -> String {
        match self.atom() {
            Atom::Text(span) => decode(span.of(self.text)),
            _ => String::new(),
        }
    }

    /// Whether nothing stands here: `$`, `*` or beyond the end.
    #[cfg(test)]
    pub(crate) fn is_nothing(&self) -> bool {
        self.atom() == Atom::Nothing
    }

    /// Index behind the value.
    fn end(&self) -> usize {
        match self.atom() {
            Atom::List { end, .. } | Atom::Typed { end, .. } => end as usize,
            _ => self.at + 1,
        }
    }
}

/// Parameters of a record, or elements of a list.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Args<'g> {
    text: &'g [u8],
    atoms: &'g [Atom],
    from: usize,
    to: usize,
    count: Option<usize>,
}

impl<'g> Args<'g> {
    /// No parameters.
    pub(crate) const fn none() -> Self {
        Self { text: &[], atoms: &[], from: 0, to: 0, count: Some(0) }
    }

    /// The values in order.
    pub(crate) fn iter(&self) -> impl Iterator<Item = Value<'g>> + use<'g> {
        let Self { text, atoms, from, to, .. } = *self;
        let mut at = from;
        std::iter::from_fn(move || {
            let value = Value { text, atoms, at };
            (at < to).then(|| {
                at = value.end();
                value
            })
        })
    }

    /// How many.
    pub(crate) fn len(&self) -> usize {
        self.count.unwrap_or_else(|| self.iter().count())
    }

    /// Whether there are none.
    pub(crate) const fn is_empty(&self) -> bool {
        self.from >= self.to
    }

    /// The parameters from the `k`-th on.
    pub(crate) fn skip(&self, k: usize) -> Self {
        let from = self.iter().nth(k).map_or(self.to, |v| v.at);
        Self { from, count: None, ..*self }
    }

    /// All instances referred to directly.
    pub(crate) fn references(&self) -> impl Iterator<Item = u64> + use<'g> {
        self.iter().filter_map(|v| v.reference())
    }
}

/// Parameter `k`; nothing beyond the end.
pub(crate) fn arg<'g>(args: &Args<'g>, k: usize) -> Value<'g> {
    let missing = Value { text: args.text, atoms: args.atoms, at: usize::MAX };
    args.iter().nth(k).unwrap_or(missing)
}

/// An instance: one part, or several for a complex one.
#[derive(Clone, Copy)]
pub(crate) struct Record<'g> {
    text: &'g [u8],
    chunk: &'g Chunk,
    entry: Entry,
}

impl<'g> Record<'g> {
    /// A view of an entry.
    pub(super) const fn new(text: &'g [u8], chunk: &'g Chunk, entry: Entry) -> Self {
        Self { text, chunk, entry }
    }
    /// Keywords, as they are written, and parameters of the parts.
    fn parts(&self) -> impl Iterator<Item = (&'g [u8], Args<'g>)> + use<'g> {
        let Self { text, chunk, entry } = *self;
        chunk.parts[entry.parts[0] as usize..entry.parts[1] as usize].iter().map(move |p| {
            let [from, to] = p.atoms.map(|a| a as usize);
            (p.word.of(text), Args { text, atoms: &chunk.atoms, from, to, count: None })
        })
    }
    /// The instance's number.
    pub(crate) const fn id(&self) -> u64 {
        self.entry.id
    }
    /// Offset in the file.
    pub(crate) const fn at(&self) -> usize {
        self.entry.at as usize
    }
    /// The parameters of the part with this keyword.
    pub(crate) fn part(&self, keyword: &str) -> Option<Args<'g>> {
        self.parts().find(|p| p.0.eq_ignore_ascii_case(keyword.as_bytes())).map(|p| p.1)
    }
    /// The parameters of the first part whose keyword ends so.
    pub(crate) fn part_ending(&self, end: &str) -> Option<Args<'g>> {
        let ends = |word: &[u8]| {
            word.len() >= end.len() && word[word.len() - end.len()..].eq_ignore_ascii_case(end.as_bytes())
        };
        self.parts().find(|p| ends(p.0)).map(|p| p.1)
    }
    /// Whether a part has this keyword.
    pub(crate) fn is(&self, keyword: &str) -> bool {
        self.part(keyword).is_some()
    }
    /// The first of the keywords that a part has, with the part's parameters.
    pub(crate) fn any(&self, keywords: &[&'static str]) -> Option<(&'static str, Args<'g>)> {
        keywords.iter().find_map(|k| self.part(k).map(|a| (*k, a)))
    }
    /// The parameters of each part.
    pub(crate) fn all_args(&self) -> impl Iterator<Item = Args<'g>> + use<'g> {
        self.parts().map(|p| p.1)
    }
    /// The keyword of a simple record in upper case; the parts' keywords joined for a complex one.
    pub(crate) fn kind(&self) -> String {
        let words: Vec<String> =
            self.parts().map(|p| String::from_utf8_lossy(p.0).to_ascii_uppercase()).collect();
        words.join("+")
    }
    /// All references in the record, nested ones too, in order.
    pub(crate) fn references(&self) -> impl Iterator<Item = u64> + use<'g> {
        let (chunk, entry) = (self.chunk, self.entry);
        let parts = &chunk.parts[entry.parts[0] as usize..entry.parts[1] as usize];
        let [from, to] = match (parts.first(), parts.last()) {
            (Some(a), Some(b)) => [a.atoms[0] as usize, b.atoms[1] as usize],
            _ => [0, 0],
        };
        chunk.atoms[from..to].iter().filter_map(|a| match a {
            Atom::Ref(id) => Some(*id),
            _ => None,
        })
    }
}
