//! Groups of faces of a propeller.

use osculate_surfaces::Face;
use osculate_surfaces::groups::{Look, groups};
use osculate_surfaces::sides::meetings;
use std::path::Path;

/// The upper and the lower sides of a propeller's two blades are formed, and each of them has one like it.
#[test]
fn the_blades_of_a_propeller_are_alike() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/propeller/propeller.step");
    let part = osculate_surfaces::read(&std::fs::read(path).unwrap()).unwrap();
    let faces = part.faces.iter().collect::<Vec<&Face>>();
    let met = meetings(&faces, part.uncertainty_mm);
    let found = groups(&faces, &met);
    let mut numbers: Vec<usize> = found.iter().flat_map(|g| g.faces.iter().copied()).collect();
    numbers.sort_unstable();
    assert_eq!(numbers, (0..faces.len()).collect::<Vec<_>>());
    let of = |id: &str| {
        let k = part.faces.iter().position(|f| f.id == id).unwrap();
        found.iter().find(|g| g.faces.contains(&k)).unwrap()
    };
    for id in ["F6", "F7", "F11", "F12"] {
        assert_eq!((of(id).look, of(id).alike), (Look::Formed, 2), "{id}");
    }
    assert_eq!((of("F20").look, of("F8").look), (Look::Hole, Look::Round));
}
