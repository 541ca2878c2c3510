//! The key `lead_deg` of a job: a number in degrees or a word.

use serde::Deserialize;

/// A lead in degrees, "auto" or "local".
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum LeadKey {
    /// The program chooses one for the whole path.
    #[default]
    Auto,
    /// The least at every place.
    Local,
    /// As given.
    Given(f64),
}

impl<'de> Deserialize<'de> for LeadKey {
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
