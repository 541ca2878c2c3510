//! Text as a machine file and as a dialect file: an error with its place, or a program for a path of two points.

/// Looks at the bytes.
pub fn look(bytes: &[u8]) {
    use osculate_postproc::{Dialect, DialectFile, FeedMode, Machine, PostOptions, Setup, cldata, post};
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    if let Ok(dialect) = DialectFile::from_toml(text) {
        let _ = dialect.out("N10 G1 X1.5 Y-2 F100\n");
        let _ = dialect.back("N10 G1 X1.5 Y-2 F100");
    }
    let Ok(machine) = Machine::from_toml(text) else { return };
    let Ok(read) = cldata::read("RAPID\nGOTO/0,0,9\nFEDRAT/100\nGOTO/1,0,0\n") else { return };
    let options = PostOptions::new(Dialect::Fanuc, FeedMode::Kf);
    let _ = post(&read.path, &machine, &Setup::default(), &options);
}
