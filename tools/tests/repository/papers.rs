//! The page of D98 and its figures, made again by the program that makes them.

use crate::fresh::first_stale;

#[path = "../../examples/d98/main.rs"]
#[allow(dead_code)]
mod d98;

#[test]
fn the_page_is_fresh() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/papers");
    let files = d98::page().unwrap();
    assert!(files.len() > 8);
    for (file, made) in files {
        let page = std::fs::read_to_string(folder.join(file)).unwrap();
        assert_eq!(first_stale(&page, &made), None, "{file}: make it again by `cargo xtask papers d98`");
    }
}
