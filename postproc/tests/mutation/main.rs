//! A small version of `cargo run --release -p osculate-postproc --example mutate`.
#![allow(dead_code, reason = "the study's table is of no use to a test")]

mod study;

#[test]
fn faults_are_found_and_harmless_changes_are_not_called_faults() {
    let programs = study::programs();
    for g in &programs {
        study::check_good(g, 5);
    }
    let rows = study::study(&programs, 14, 7, 33);
    let mut all = study::Count::default();
    for row in &rows {
        assert_ne!(row.right(), Some(false), "{row:?}");
        all.add(row);
    }
    assert!(all.harmful + all.harmless + all.garbled >= 10, "{all:?}");
}
