//! The first byte chooses the control and how strict it is; the text goes to the reader and to the clock.

/// Looks at the bytes.
pub fn look(bytes: &[u8]) {
    use osculate_postproc::nc::timing::time;
    use osculate_postproc::readback::{ReadOptions, read};
    use osculate_postproc::{Dialect, Machine, Setup};
    let Some((choice, text)) = bytes.split_first() else { return };
    let Ok(text) = std::str::from_utf8(text) else { return };
    let Ok(machine) = Machine::built_in("trunnion-ac") else { return };
    let dialects = [Dialect::Fanuc, Dialect::Heidenhain, Dialect::LinuxCnc, Dialect::Sinumerik];
    let dialect = dialects[usize::from(choice % 4)];
    let strict = choice & 4 != 0;
    let options = ReadOptions { strict, ..ReadOptions::default() };
    let _ = read(text, dialect, &machine, &Setup::default(), &options);
    let _ = time(text, dialect, &machine, &Setup::default(), strict);
}
