//! Dialect files as they are written.

use serde::Deserialize;

/// A dialect file as it is written.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Spec {
    pub format: u32,
    pub name: String,
    #[serde(default)]
    pub description: String,
    pub engine: String,
    pub extension: Option<String>,
    pub blocks: Option<Blocks>,
    #[serde(default)]
    pub numbers: Numbers,
    #[serde(default)]
    pub modal: ModalRules,
    #[serde(default, rename = "rule")]
    pub rules: Vec<RuleSpec>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Blocks {
    pub letter: String,
    pub first: u64,
    pub step: u64,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Numbers {
    pub trailing_zeros: bool,
}

impl Default for Numbers {
    fn default() -> Self {
        Self { trailing_zeros: true }
    }
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct ModalRules {
    pub motion: bool,
    pub feed: bool,
}

impl Default for ModalRules {
    fn default() -> Self {
        Self { motion: true, feed: true }
    }
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RuleSpec {
    pub engine: String,
    pub words: Option<Vec<String>>,
    pub refused: Option<String>,
}
