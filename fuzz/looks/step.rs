//! Bytes to the STEP reader: it must answer, without panic, within bounded time and memory; what it makes of them must
//! bear being looked at.

/// Looks at the bytes.
pub fn look(bytes: &[u8]) {
    let Ok(part) = osculate_surfaces::step::read(bytes) else { return };
    for face in part.faces.iter().take(4) {
        let _ = face.bbox();
        let _ = face.degree();
    }
}
