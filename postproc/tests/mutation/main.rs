//! A small version of `cargo run --release -p osculate-postproc --example mutate`.
#![allow(clippy::unwrap_used, dead_code)]

mod study;

#[test]
fn faults_are_found_and_harmless_changes_are_not_called_faults() {
    let programs = study::programs();
    study::check_good(&programs, 12);
    let rows = study::study(&programs, 32, 7, 24);
    for row in &rows {
        assert_ne!(row.right(), Some(false), "{row:?}");
    }
    let counts = study::table(&rows).values().fold([0; 6], |a, b| std::array::from_fn(|k| a[k] + b[k]));
    assert!(counts[1] >= 8 && counts[3] >= 6, "{counts:?}");
}
