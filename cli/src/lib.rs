//! **osculate** plans, verifies and posts multi-axis NC machining of free-form surfaces.

pub mod failure;
pub mod figure;
pub mod job;
pub mod part;
pub mod report;
pub mod second;
pub mod watch;
pub mod words;
pub mod work;
