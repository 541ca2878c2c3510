//! Data that the package has for its tests are those of the examples.

#[test]
fn the_hull_of_the_tests_is_the_example() {
    assert_eq!(include_str!("../data/hull.step"), include_str!("../../../examples/wigley-hull/hull.step"));
}
