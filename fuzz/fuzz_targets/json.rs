//! Bytes to the JSON reader: faces or an error with its place, and faces that it gives can be written again.

#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(faces) = osculate_surfaces::json::read(bytes) {
        let _ = osculate_surfaces::json::write(&faces);
    }
});
