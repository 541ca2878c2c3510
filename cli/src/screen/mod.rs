//! What a person types and sees: arguments, progress, signals, tables and files.

pub mod args;
pub mod cancel;
pub mod output;
pub mod progress;
pub mod render;
pub mod usage;
