//! Machine files that come with the library.

/// Name and text, in the order in which they are listed.
const FILES: [(&str, &str); 9] = [
    ("3-axis", include_str!("../../machines/3-axis.toml")),
    ("trunnion-ac", include_str!("../../machines/trunnion-ac.toml")),
    ("trunnion-bc", include_str!("../../machines/trunnion-bc.toml")),
    ("linuxcnc-xyzac", include_str!("../../machines/linuxcnc-xyzac.toml")),
    ("linuxcnc-xyzbc", include_str!("../../machines/linuxcnc-xyzbc.toml")),
    ("head-ca", include_str!("../../machines/head-ca.toml")),
    ("head-b-table-c", include_str!("../../machines/head-b-table-c.toml")),
    ("nutated-b-table-c", include_str!("../../machines/nutated-b-table-c.toml")),
    ("mill-turn-xyzc", include_str!("../../machines/mill-turn-xyzc.toml")),
];

/// The names that [`super::Machine::built_in`] takes.
#[must_use]
pub fn built_in_names() -> Vec<&'static str> {
    FILES.iter().map(|(name, _)| *name).collect()
}

/// The description of a built-in machine, as its file has it.
#[must_use]
pub fn built_in_text(name: &str) -> Option<&'static str> {
    FILES.iter().find(|(n, _)| *n == name).map(|(_, text)| *text)
}
