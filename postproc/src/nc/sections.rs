//! Where in an archive of programs the reader is; [`super::archive`] goes through it.

use std::collections::VecDeque;

/// Where in an archive the reader is.
#[derive(Clone, Debug, Default)]
pub(super) struct Sections {
    /// The text is an archive.
    pub archive: bool,
    /// The call that waits for its subprogram, with its line.
    pub wanted: Option<(usize, String)>,
    /// Lines of the caller behind the call.
    pub waiting: VecDeque<(usize, String)>,
    /// In the subprogram that is wanted.
    pub inside: bool,
    /// In a program that nobody has called.
    pub skipped: bool,
}
