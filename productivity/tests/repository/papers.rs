//! The pages of R97 and M86, their pictures and the page of all forms, made again by the program that makes them.

use crate::fresh::first_stale;

#[path = "../../examples/papers/main.rs"]
#[allow(dead_code)]
mod maker;

#[test]
fn pages_are_fresh() {
    let docs = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    let files = maker::pages(|_| true);
    assert!(files.len() > 6);
    for (file, made) in files {
        let page = std::fs::read_to_string(docs.join(&file)).unwrap();
        assert_eq!(first_stale(&page, &made), None, "{file}: make it again by `cargo xtask papers r97 m86`");
    }
}
