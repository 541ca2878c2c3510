//! The page of Z17 and its pictures, made again by the program that makes them.

use crate::fresh::first_stale;

#[path = "../../examples/z17.rs"]
mod z17;

#[test]
fn the_page_is_fresh() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/papers");
    for (file, made) in z17::page().unwrap() {
        let page = std::fs::read_to_string(folder.join(file)).unwrap();
        assert_eq!(first_stale(&page, &made), None, "{file}: make it again by `cargo xtask papers z17`");
    }
}
