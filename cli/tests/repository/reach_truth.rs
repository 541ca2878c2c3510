//! The reach on five parts against every direction and every point taken one by one, by code of the test's own: a small version of
//! `cargo run --release -p osculate --example reach_truth`.

#[path = "reach_truth/study.rs"]
mod study;

use study::{EXAMPLES, Size, study};

#[test]
fn bits_at_random_places_of_five_parts_are_those_of_brute_force() {
    let size = Size { places: 30, points: 5_000, level: 3, seed: 1 };
    let mut blocked = [0; 2];
    for example in &EXAMPLES {
        let found = study(example, size).unwrap();
        println!("{found}");
        assert!(found.wrong.is_empty(), "{found}");
        // Neither answer is all there is, and most directions have no point near their limit.
        assert!(found.set > 0 && found.blocked != [0; 2] && 100 * found.close < found.bits, "{found}");
        blocked = [0, 1].map(|k| blocked[k] + found.blocked[k]);
    }
    assert!(blocked[0] > 0 && blocked[1] > 0, "{blocked:?}");
}
