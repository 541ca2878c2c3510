//! How the faces of a part hang together as its file says: bodies with their shells, the assembly that they stand in, layers.
//!
//! Faces are named by their ids. A body that stands in several places is one body at each of them. Nothing is found by geometry
//! here: files without bodies give none.

use std::collections::HashMap;
use std::fmt;

/// What a body is in its file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum BodyKind {
    /// A solid: its shells enclose material.
    Solid,
    /// Shells without a word of what they enclose.
    Surfaces,
    /// Faces that nothing joins.
    Set,
}

impl fmt::Display for BodyKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Solid => "solid",
            Self::Surfaces => "surfaces",
            Self::Set => "set",
        })
    }
}

/// Connected faces of a body.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Shell {
    /// Its number in the file.
    pub entity: u64,
    /// Its name, empty where it has none.
    pub name: String,
    /// Whether the file says that it closes.
    pub closed: bool,
    /// The ids of its faces.
    pub faces: Vec<String>,
}

/// A shape item of a file at one place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Body {
    /// `B1`, `B2`, ... in the order of their first faces.
    pub id: String,
    /// Its number in the file.
    pub entity: u64,
    /// Its name in the file, empty where it has none.
    pub name: String,
    /// What the file says it is.
    pub kind: BodyKind,
    /// The products from the whole assembly down to the one that it belongs to, those that have a name.
    pub path: Vec<String>,
    /// Its shells, in the order of their first faces.
    pub shells: Vec<Shell>,
}

impl Body {
    /// The ids of its faces.
    pub fn faces(&self) -> impl Iterator<Item = &str> {
        self.shells.iter().flat_map(|s| &s.faces).map(String::as_str)
    }
}

/// Faces that a file has put together under a name to show or to hide.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Layer {
    /// Its name or number.
    pub name: String,
    /// The ids of its faces.
    pub faces: Vec<String>,
}

impl Structure {
    /// The place in `bodies` of the solid that each of these ids of faces bounds; none for faces of other bodies and of none.
    #[must_use]
    pub fn solids<'i>(&self, ids: impl IntoIterator<Item = &'i str>) -> Vec<Option<usize>> {
        let solids = self.bodies.iter().enumerate().filter(|(_, b)| b.kind == BodyKind::Solid);
        let of: HashMap<&str, usize> = solids.flat_map(|(k, b)| b.faces().map(move |id| (id, k))).collect();
        ids.into_iter().map(|id| of.get(id).copied()).collect()
    }
}

/// What a file says of how its faces hang together.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Structure {
    /// The bodies; faces that belong to none are in none.
    pub bodies: Vec<Body>,
    /// The layers that have faces.
    pub layers: Vec<Layer>,
}
