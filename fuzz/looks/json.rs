//! Bytes to the JSON reader: faces or an error with its place, and faces that it gives can be written again.

/// Looks at the bytes.
pub fn look(bytes: &[u8]) {
    if let Ok(faces) = osculate_surfaces::json::read(bytes) {
        let _ = osculate_surfaces::json::write(&faces);
    }
}
