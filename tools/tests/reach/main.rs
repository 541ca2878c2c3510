//! The reach against closed forms, against every direction and every point taken one by one, and its laws.
#![allow(clippy::unwrap_used)]

mod closed;
mod directions;
mod laws;
mod scenes;
mod slowly;
