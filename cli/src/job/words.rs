//! The words that a job file takes, each list with its enum: the same list for reading, checking and the reference.

use serde::Deserialize;

/// An enum whose variants are words of job files.
macro_rules! words {
    ($(#[$about:meta])* $name:ident { $($(#[$doc:meta])* $variant:ident = $word:literal,)+ }) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
        pub enum $name { $($(#[$doc])* #[serde(rename = $word)] $variant,)+ }

        impl $name {
            /// All words, in the order of the reference.
            pub const WORDS: &'static [&'static str] = &[$($word),+];

            /// The word.
            #[must_use]
            pub const fn word(self) -> &'static str {
                match self { $(Self::$variant => $word,)+ }
            }

            /// What a word means.
            #[must_use]
            pub fn of(word: &str) -> Option<Self> {
                match word { $($word => Some(Self::$variant),)+ _ => None }
            }
        }
    };
}

words! {
    /// Which side of a face the outward normal is on.
    Normals {
        /// As the file says; where it does not, by looking which side is enclosed.
        #[default]
        Auto = "auto",
        /// Along S_u x S_v as the file has it.
        File = "file",
        /// Against it.
        Reversed = "reversed",
    }
}

words! {
    /// On which side of a face its material is.
    MaterialWord {
        /// The normal S_u x S_v points out of it.
        #[default]
        Below = "below_normal",
        /// The normal S_u x S_v points into it.
        Above = "above_normal",
    }
}

words! {
    /// A kind of cutter.
    ToolKind {
        /// A ball end.
        #[default]
        Ball = "ball",
        /// A flat end with a sharp edge.
        Flat = "flat",
        /// A flat end with a rounded corner.
        Toroidal = "toroidal",
        /// A cylinder that works with its side.
        Cylindrical = "cylindrical",
        /// A cone with a cylinder above it.
        Cone = "cone",
        /// A ball tip and a large arc.
        Barrel = "barrel",
        /// APT's general cutter.
        Apt = "apt",
    }
}

words! {
    /// A way to cut, by name.
    StrategyWord {
        /// Chosen by the program.
        #[default]
        Auto = "auto",
        /// Along lines of constant parameter.
        Isoparametric = "isoparametric",
        /// Along lines of constant parameter, in regions.
        Regions = "regions",
        /// In parallel planes.
        Isoplanar = "isoplanar",
        /// With the same scallop all along.
        Isoscallop = "isoscallop",
        /// Along the directions of the widest strip.
        Streamline = "streamline",
        /// Along lines of curvature.
        Curvature5c = "curvature_5c",
        /// Along the walls beside the face.
        AlongWalls = "along_walls",
        /// A ball at constant height along an axis that it keeps.
        Contour2cl = "contour_2cl",
        /// Up and down the slope, the axis kept.
        Gradient3c = "gradient_3c",
        /// In parallel planes, the axis kept.
        Isoplanar3c = "isoplanar_3c",
        /// At constant heights around steep places, the axis kept.
        Waterline3c = "waterline_3c",
        /// Roughing in layers.
        ZLevel = "z_level",
        /// The side of the cutter on a ruled face: the verb `flank`.
        Flank = "flank",
    }
}

words! {
    /// What an operation does.
    OperationWord {
        /// From raw material down to an allowance, in layers.
        Rough = "rough",
        /// Faces to their tolerance.
        #[default]
        Finish = "finish",
        /// What stands above the tolerance after the operations before.
        Rest = "rest",
    }
}

words! {
    /// The parameter of a face that something runs along.
    AlongWord {
        /// Chosen by the program.
        #[default]
        Auto = "auto",
        /// The first.
        U = "u",
        /// The second.
        V = "v",
    }
}

words! {
    /// How much is tried where the program chooses.
    EffortWord {
        /// The first that holds, and a little around it.
        Quick = "quick",
        /// What is worth its time on most parts.
        #[default]
        Normal = "normal",
        /// Several times as much.
        Long = "long",
    }
}

words! {
    /// How a roughing comes into the material.
    EntryWord {
        /// From outside, else by a helix, else down a ramp, else straight down with a tool that plunges.
        #[default]
        Auto = "auto",
        /// From outside, else by a helix.
        Helix = "helix",
        /// From outside, else down a ramp along the pass.
        Ramp = "ramp",
        /// From outside only.
        Outside = "outside",
    }
}

words! {
    /// How chips are cut.
    ClimbWord {
        /// As it comes.
        #[default]
        Any = "any",
        /// From thick to thin.
        Climb = "climb",
        /// From thin to thick.
        Conventional = "conventional",
    }
}

words! {
    /// One parameter of a face.
    AxisWord {
        /// The first.
        #[default]
        U = "u",
        /// The second.
        V = "v",
    }
}

words! {
    /// What becomes of places where the tool would go into the part.
    Gouges {
        /// They are machined, and verification says that the path does not hold.
        #[default]
        Report = "report",
        /// Passes end before them; verification counts what stands as uncut.
        LeaveOut = "leave_out",
    }
}

words! {
    /// How a program says the feed.
    FeedWord {
        /// Tool-centre-point control.
        #[default]
        Tcp = "tcp",
        /// As wanted, whatever comes of it.
        None = "none",
        /// Corrected over all axes.
        Kv = "kv",
        /// Corrected over the linear axes.
        Kf = "kf",
        /// As `kv`, rising by at most a step from block to block.
        Kz = "kz",
        /// One over the duration.
        InverseTime = "inverse_time",
        /// Degrees a minute over the rotary axes.
        Rotary = "rotary",
        /// As fast as the joints can follow.
        Fastest = "fastest",
    }
}

words! {
    /// What cools the cut.
    CoolantWord {
        /// Nothing.
        #[default]
        Off = "off",
        /// M8.
        Flood = "flood",
        /// M7.
        Mist = "mist",
    }
}

words! {
    /// What a verdict must rest on for the exit code to say yes.
    Accept {
        /// Limits met at the samples, and shown to be met between them.
        #[default]
        Proof = "proof",
        /// Limits met at the samples.
        Samples = "samples",
    }
}

words! {
    /// What flank milling takes for the face.
    FlankShape {
        /// The face's own shape.
        #[default]
        Own = "own",
        /// The straight lines between its borders.
        Borders = "borders",
    }
}

words! {
    /// The end of the rules where the tip is.
    Tip {
        /// The one that keeps the spindle up.
        #[default]
        Auto = "auto",
        /// v = 0.
        V0 = "v0",
        /// v = 1.
        V1 = "v1",
    }
}

words! {
    /// How the part may be turned where the job gives no turn.
    Turns {
        /// One of its own axes up and the others along the machine's; never for the sake of time.
        None = "none",
        /// One of its own axes up; for the sake of time another one, or about the vertical.
        #[default]
        Axis = "axis",
        /// In any way.
        Free = "free",
    }
}

words! {
    /// A positioning of a cutter on a ruled face.
    Method {
        /// Touching at the first directrix.
        StandardA = "standard_a",
        /// Touching at the second directrix.
        StandardB = "standard_b",
        /// Liu's double point offset.
        DoublePointOffset = "double_point_offset",
        /// The same, leaving as much at the ends of the rule as it gouges on it.
        DoublePointBalanced = "double_point_balanced",
        /// The best setting at each rule.
        Optimum = "optimum",
        /// The least greatest deviation at each rule.
        StaticMinimax = "static_minimax",
        /// The least mean square of the envelope.
        EnvelopeRms = "envelope_rms",
        /// The least greatest deviation of the envelope.
        #[default]
        EnvelopeMinimax = "envelope_minimax",
    }
}

/// An angle of the lean in degrees, "auto" or "local".
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum LeanKey {
    /// The program chooses.
    #[default]
    Auto,
    /// Found at every place.
    Local,
    /// As given.
    Given(f64),
}

impl LeanKey {
    /// The words that stand for an angle.
    pub const WORDS: &'static [&'static str] = &["auto", "local"];

    /// The angle that is given, deg; none where the program finds it.
    #[must_use]
    pub fn given_deg(self) -> Option<f64> {
        match self {
            Self::Given(deg) => Some(deg),
            Self::Auto | Self::Local => None,
        }
    }
}

impl<'de> Deserialize<'de> for LeanKey {
    fn deserialize<D: serde::Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged)]
        enum Raw {
            Number(f64),
            Word(String),
        }
        match Raw::deserialize(d)? {
            Raw::Number(x) => Ok(Self::Given(x)),
            Raw::Word(w) if w == "auto" => Ok(Self::Auto),
            Raw::Word(w) if w == "local" => Ok(Self::Local),
            Raw::Word(w) => Err(serde::de::Error::custom(format!(
                "expected a number, \"auto\" or \"local\", got \"{w}\""
            ))),
        }
    }
}

/// The tool's axis: a direction that it keeps, or how it goes along.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum AxisKey {
    /// It leans against the feed of every pass.
    Feed,
    /// One axis at each place of the part, the same for passes to and fro.
    Field,
    /// As given.
    Given([f64; 3]),
}

impl AxisKey {
    /// The words that stand for an axis.
    pub const WORDS: &'static [&'static str] = &["feed", "field"];
}

impl<'de> Deserialize<'de> for AxisKey {
    fn deserialize<D: serde::Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged)]
        enum Raw {
            Direction([f64; 3]),
            Word(String),
        }
        match Raw::deserialize(d)? {
            Raw::Direction(x) => Ok(Self::Given(x)),
            Raw::Word(w) if w == "feed" => Ok(Self::Feed),
            Raw::Word(w) if w == "field" => Ok(Self::Field),
            Raw::Word(w) => Err(serde::de::Error::custom(format!(
                "expected a direction, \"feed\" or \"field\", got \"{w}\""
            ))),
        }
    }
}

/// From how many directions a part is roughed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum DirectionsKey {
    /// As many as are worth it.
    Auto,
    /// No more than so many.
    Most(usize),
}

impl DirectionsKey {
    /// The words that stand for a number.
    pub const WORDS: &'static [&'static str] = &["auto"];
}

impl<'de> Deserialize<'de> for DirectionsKey {
    fn deserialize<D: serde::Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged)]
        enum Raw {
            Number(usize),
            Word(String),
        }
        match Raw::deserialize(d)? {
            Raw::Number(n) => Ok(Self::Most(n)),
            Raw::Word(w) if w == "auto" => Ok(Self::Auto),
            Raw::Word(w) => {
                Err(serde::de::Error::custom(format!("expected a whole number or \"auto\", got \"{w}\"")))
            }
        }
    }
}

/// The candidate that is least changed to become `word`, where one is near enough to be meant.
#[must_use]
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let lower = word.to_lowercase();
    let all = candidates.into_iter().map(|c| (distance(&lower, &c.to_lowercase()), c));
    // Of words as near, the one that begins alike.
    let alike = |c: &str| c.chars().zip(lower.chars()).take_while(|(a, b)| a == b).count();
    let (changes, best) = all.min_by_key(|(d, c)| (*d, usize::MAX - alike(c)))?;
    // Beyond half of the letters it is another word.
    (2 * changes <= word.chars().count().max(best.chars().count())).then_some(best)
}

/// What a parser says of a word that it does not know ("unknown variant `x`, expected one of `a`, `b`"), in parts: the word's kind and the
/// word, and those there are. `None` where it says something else.
pub fn not_known(message: &str) -> Option<(&'static str, &str, Vec<&str>)> {
    let (kind, rest) =
        match (message.strip_prefix("unknown variant "), message.strip_prefix("unknown field ")) {
            (Some(rest), _) => ("kind", rest),
            (_, Some(rest)) => ("key", rest),
            _ => return None,
        };
    // Words stand between back quotes: the first is the one that was written.
    let mut words = rest.split('`').skip(1).step_by(2);
    let written = words.next()?;
    Some((kind, written, words.collect()))
}

/// Letters put in, taken out, changed or exchanged with their neighbour.
fn distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut before: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let changed = last[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut least = changed.min(last[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                least = least.min(before[j - 2] + 1);
            }
            row.push(least);
        }
        before = std::mem::replace(&mut last, row);
    }
    last.last().copied().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_word_is_the_least_changed() {
        assert_eq!(distance("scallop_um", "scallop_mm"), 1);
        assert_eq!(distance("toriodal", "toroidal"), 1);
        assert_eq!(distance("", "abc"), 3);
        assert_eq!(nearest("Toriodal", ToolKind::WORDS.iter().copied()), Some("toroidal"));
        assert_eq!(nearest("linux", ["fanuc", "linuxcnc"]), Some("linuxcnc"));
        assert_eq!(nearest("hexapod", ["ball", "flat"]), None);
        let said = not_known("unknown field `half_size`, expected one of `a_per_mm`, `half_size_mm`");
        assert_eq!(said, Some(("key", "half_size", vec!["a_per_mm", "half_size_mm"])));
        assert_eq!(not_known("missing field `a_per_mm`"), None);
    }
}
