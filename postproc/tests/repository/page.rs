//! The page that explains dialects to users shows the dialect file that the tests of dialects are about.

const PAGE: &str = include_str!("../../../docs/dialects.md");

#[test]
fn the_page_shows_the_file_that_is_tested() {
    let after = PAGE.split("```toml\n").nth(1).expect("the page has a file");
    let shown = after.split("```").next().expect("it ends");
    assert_eq!(shown, include_str!("../data/osp.toml"));
}
