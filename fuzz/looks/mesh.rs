//! Bytes to the readers of meshes, and triangles to what makes faces of them.

/// Looks at the bytes.
pub fn look(bytes: &[u8]) {
    use osculate_surfaces::facets;
    let _ = facets::mesh_format(bytes);
    let Ok(file) = facets::read(bytes) else { return };
    let _ = facets::mesh_part(&file.triangles, facets::SHARP_RAD);
}
