//! What a key of a job file may be: the one source of checks, reference and template.

use std::fmt;

/// Numbers that a key takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// The least.
    pub least: f64,
    /// The greatest.
    pub most: f64,
    /// Whether the ends themselves are left out.
    pub open: [bool; 2],
}

impl Range {
    /// Whether a number is in it; what is not finite never is.
    ///
    /// ```
    /// use osculate::job::schema::Range;
    ///
    /// // Above zero, and 90 at most.
    /// let lean_deg = Range { least: 0.0, most: 90.0, open: [true, false] };
    /// assert!(lean_deg.holds(90.0) && lean_deg.holds(0.1) && !lean_deg.holds(0.0));
    /// ```
    #[must_use]
    pub fn holds(&self, x: f64) -> bool {
        let above = if self.open[0] { x > self.least } else { x >= self.least };
        let below = if self.open[1] { x < self.most } else { x <= self.most };
        x.is_finite() && above && below
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.least, self.most) {
            (f64::NEG_INFINITY, f64::INFINITY) => f.write_str("a finite number"),
            (0.0, b) if self.open[0] => {
                write!(f, "a positive number {} {b}", if self.open[1] { "below" } else { "up to" })
            }
            (0.0, b) => write!(f, "zero or a positive number up to {b}"),
            (a, b) if self.open == [true; 2] => write!(f, "a number between {a} and {b}, neither of them"),
            (a, b) => write!(f, "a number from {a} to {b}"),
        }
    }
}

/// What a key takes.
#[derive(Debug, Clone, Copy)]
pub enum Kind {
    /// A number with its unit.
    Number(Range, &'static str),
    /// A whole number.
    Whole(i64, i64),
    /// A whole number, or the table of the same name.
    WholeOrTable(i64, i64),
    /// Whole numbers.
    Wholes(i64, i64),
    /// 1 or -1.
    Sign,
    /// true or false.
    Flag,
    /// A number or one of these words.
    NumberOr(Range, &'static str, &'static [&'static str]),
    /// So many numbers.
    Numbers(usize, Range, &'static str),
    /// Three numbers that are not all zero.
    Direction,
    /// A whole number within bounds, or one of these words.
    WholeOr(i64, i64, &'static [&'static str]),
    /// Three numbers that are not all zero, or one of these words.
    DirectionOr(&'static [&'static str]),
    /// A lower and a greater number.
    Between(Range, &'static str),
    /// Two corners, the lower one first.
    Corners(&'static str),
    /// One of these words.
    Word(&'static [&'static str]),
    /// One of these names.
    Name(fn() -> Vec<&'static str>),
    /// Any text.
    Text,
    /// A file, relative to the job's.
    File,
    /// Files.
    Files,
    /// "all", an id, ids or { largest = n }.
    Faces,
    /// "all", an id or ids.
    Others,
    /// An id or ids.
    Ids,
    /// A built-in surface's keys.
    Builtin,
    /// A list of numbers or of points, of any length.
    List,
}

impl Kind {
    /// The words that it takes, where it takes words.
    #[must_use]
    pub fn words(&self) -> Vec<&'static str> {
        match self {
            Self::NumberOr(_, _, w) | Self::WholeOr(_, _, w) | Self::DirectionOr(w) | Self::Word(w) => {
                w.to_vec()
            }
            Self::Name(names) => names(),
            _ => Vec::new(),
        }
    }

    /// What it takes, in words.
    #[must_use]
    pub fn expects(&self) -> String {
        let list = |w: &[&str]| w.iter().map(|w| format!("\"{w}\"")).collect::<Vec<_>>().join(", ");
        let with = |text: String, unit: &str| if unit.is_empty() { text } else { format!("{text}, {unit}") };
        match self {
            Self::Number(r, unit) => with(r.to_string(), unit),
            Self::Whole(a, b) if a == b => format!("{a}: this version reads format = {a}"),
            Self::Whole(a, b) => format!("a whole number from {a} to {b}"),
            Self::WholeOrTable(a, b) => format!("a whole number from {a} to {b}, or a table with the number as count"),
            Self::WholeOr(a, b, w) => format!("a whole number from {a} to {b} or one of {}", list(w)),
            Self::Wholes(a, b) => format!("a list of whole numbers from {a} to {b}"),
            Self::Sign => "1 or -1".to_owned(),
            Self::Flag => "true or false".to_owned(),
            Self::NumberOr(r, unit, w) => format!("{} or one of {}", with(r.to_string(), unit), list(w)),
            Self::Numbers(n, r, unit) => with(format!("a list of {n} numbers, each {r}"), unit),
            Self::Direction => "a direction: three finite numbers that are not all zero".to_owned(),
            Self::DirectionOr(w) => {
                format!("a direction (three finite numbers that are not all zero) or one of {}", list(w))
            }
            Self::Between(r, unit) => with(format!("two numbers, the lower one first, each {r}"), unit),
            Self::Corners(unit) => {
                with("six finite numbers: the lower corner and the upper one, x y z each, as a flat box has no volume".to_owned(), unit)
            }
            Self::Word(w) => format!("one of {}", list(w)),
            Self::Name(names) => format!("one of {}", list(&names())),
            Self::Text => "text".to_owned(),
            Self::File => "the path of a file, relative to the job file".to_owned(),
            Self::Files => "a list of paths, relative to the job file".to_owned(),
            Self::Faces => "\"all\", an id, a list of ids, or { largest = n }".to_owned(),
            Self::Others => "\"all\", an id or a list of ids".to_owned(),
            Self::Ids => "an id or a list of ids".to_owned(),
            Self::Builtin => {
                "a table with kind and the sizes of a built-in surface (see `gallery`)".to_owned()
            }
            Self::List => "a list".to_owned(),
        }
    }
}

/// A key.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct Key {
    /// Its name.
    pub name: &'static str,
    /// What it takes.
    pub kind: Kind,
    /// What holds where it is not given; `None` where it must be.
    pub default: Option<&'static str>,
    /// A value, as TOML.
    pub example: &'static str,
    /// What it is, in one line.
    pub meaning: &'static str,
}

/// A table.
#[derive(Debug, Clone, Copy)]
pub struct Table {
    /// Its name with that of the tables around it; empty for the keys before the first table.
    pub name: &'static str,
    /// Whether every job has it.
    pub needed: bool,
    /// What it is, in one line.
    pub meaning: &'static str,
    /// Its keys.
    pub keys: &'static [Key],
}

impl Table {
    /// A key of it.
    #[must_use]
    pub fn key(&self, name: &str) -> Option<&'static Key> {
        self.keys.iter().find(|k| k.name == name)
    }
}

/// The list of tables that stands for several of `[tool]` in a job of one operation.
pub const TOOLS: &str = "tools";

/// Tables that may be lists of such tables as well.
pub const ONE_OR_MORE: [&str; 2] = ["tool.holder", "part.side"];

/// What a kind of job file may hold: its tables, and which of them stand in lists.
#[derive(Debug)]
#[non_exhaustive]
pub struct Schema {
    /// The format of the files that it is of.
    pub format: i64,
    /// The tables in the order of the reference. The keys of one may stand in two of the same name.
    pub tables: Vec<Table>,
    /// Lists of tables, each with the name of the table that an entry is.
    pub lists: &'static [(&'static str, &'static str)],
}

impl Schema {
    /// The name of a table in a list as the schema has it.
    fn listed(&self, name: &str) -> String {
        let (head, rest) = name.split_at(name.find('.').unwrap_or(name.len()));
        match self.lists.iter().find(|l| l.0 == head) {
            Some((_, own)) => format!("{own}{rest}"),
            None => name.to_owned(),
        }
    }

    /// The tables of this name.
    fn named(&self, name: &str) -> impl Iterator<Item = &Table> {
        let own = self.listed(name);
        self.tables.iter().filter(move |t| t.name == own)
    }

    /// The keys of a table.
    pub fn keys(&self, name: &str) -> impl Iterator<Item = &'static Key> {
        self.named(name).flat_map(|t| t.keys)
    }

    /// A key of a table.
    #[must_use]
    pub fn key(&self, table: &str, key: &str) -> Option<&'static Key> {
        self.keys(table).find(|k| k.name == key)
    }

    /// What a table is, in one line.
    #[must_use]
    pub fn meaning(&self, name: &str) -> Option<&'static str> {
        self.named(name).next().map(|t| t.meaning)
    }

    /// Whether every job has a table.
    #[must_use]
    pub fn needs(&self, name: &str) -> bool {
        self.named(name).any(|t| t.needed)
    }

    /// Whether a name is that of a list of tables.
    #[must_use]
    pub fn is_list(&self, name: &str) -> bool {
        self.lists.iter().any(|l| l.0 == name)
    }

    /// Tables and lists of tables that stand directly in a table.
    pub fn tables_in(&self, name: &str) -> Vec<&'static str> {
        let prefix = if name.is_empty() { String::new() } else { format!("{}.", self.listed(name)) };
        let own = self.tables.iter().filter_map(|t| t.name.strip_prefix(prefix.as_str()));
        let mut out: Vec<&'static str> = Vec::new();
        let lists = self.lists.iter().filter(|_| name.is_empty()).map(|l| l.0);
        for inner in own.filter(|n| !n.is_empty() && !n.contains('.')).chain(lists) {
            if !out.contains(&inner) {
                out.push(inner);
            }
        }
        out
    }
}
