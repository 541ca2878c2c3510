//! APT cutter location data (CLDATA as text, in the manner of ISO 4343).
//!
//! `GOTO/` carries the tool **tip** in the part's frame and the tool axis (from the tip to the spindle). `RAPID` holds
//! for the next `GOTO` only, `FEDRAT/` until the next one.

mod arc;
mod cutter;
mod cycle;
mod error;
mod feed;
mod fields;
mod placing;
mod read;
mod repeat;
mod section;
mod settle;
mod statement;
mod stream;
mod transform;
mod ways;
mod words;
mod write;

pub use error::ClReadError;
pub use read::{ClData, ClReadOptions, ClReader, known_words, read};
pub use section::{ClSection, ClTool};
pub use stream::{ClOutline, ClPart, ClPlace, ClStream, ClStreamError};
pub use write::{ClWriteError, ClWriteOptions, ClWriter, write};
