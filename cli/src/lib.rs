//! What the command line of `osculate` is made of, for other programs.

pub mod second;
