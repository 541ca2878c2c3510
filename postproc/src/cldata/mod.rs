//! APT cutter location data (CLDATA as text, in the manner of ISO 4343).
//!
//! `GOTO/` carries the tool **tip** in the part's frame and the tool axis (from the tip to the spindle). `RAPID` holds
//! for the next `GOTO` only, `FEDRAT/` until the next one.

mod cutter;
mod read;
mod statement;
mod write;

pub use read::{ClData, ClReadError, read};
pub use write::{ClWriteError, ClWriteOptions, write};
