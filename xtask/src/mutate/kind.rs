//! Kinds of files by what reads them.

/// What reads a file.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// STEP, IGES, JSON of faces, patches, sections.
    Part,
    /// STL, PLY, 3MF.
    Mesh,
    Program,
    Path,
    /// Jobs of examples, which are not planned.
    Job,
    /// Jobs of a few mm2, which are.
    SmallJob,
    /// Jobs for the side of a cutter. Planned by ways of its end, which they do not name, they would take a minute, damaged or whole.
    SideJob,
    Machine,
    Dialect,
    /// Libraries of tools.
    Library,
    /// What an operation has left.
    Stock,
}

/// How many kinds there are.
pub const KINDS: usize = 11;
