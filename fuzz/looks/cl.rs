//! Text to the reader of CL data, at once and as a stream, and what it gives to the postprocessor.

/// Looks at the bytes.
pub fn look(bytes: &[u8]) {
    use osculate_postproc::{Dialect, FeedMode, Machine, PostOptions, Setup, cldata, post};
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let Ok(read) = cldata::read(text) else { return };
    let Ok(machine) = Machine::built_in("trunnion-ac") else { return };
    let options = PostOptions::new(Dialect::Heidenhain, FeedMode::Tcp);
    let _ = post(&read.path, &machine, &Setup::default(), &options);
}
