//! Pages of papers against what is made anew.

/// The first line in which a page differs from what is made anew, as it is made.
pub fn first_stale<'a>(page: &str, made: &'a str) -> Option<&'a str> {
    let mut lines = page.lines();
    let changed = made.lines().find(|line| lines.next() != Some(line));
    changed.or(if page == made { None } else { Some("its end") })
}

#[test]
fn any_change_is_found() {
    assert_eq!(first_stale("a\nb\n", "a\nb\n"), None);
    assert_eq!(first_stale("a\nb\n", "a\nc\n"), Some("c"));
    assert_eq!(first_stale("a\n", "a\nb\n"), Some("b"));
    assert_eq!(first_stale("a\nb\n", "a\n"), Some("its end"));
}
