//! IGES import against closed forms: every file is punched here, card by card.

use crate::punched;

use osculate_geom::{Point3, Surface, uv};
use osculate_surfaces::iges::{self, IgesError};
use osculate_surfaces::{FaceKind, Format, ImportError, detect, read};
use proptest::prelude::*;
use punched::{Entity, assert_area, entity, file, file_in, flat_patch, only_face, part, punch, rectangle};
use std::f64::consts::PI;

#[test]
fn a_free_surface_is_a_face() {
    let face = only_face(&[flat_patch()]);
    assert_eq!((face.id.as_str(), face.name.as_str(), face.entity), ("F1", "LABEL", 1));
    assert_eq!((face.kind, face.oriented, face.trimmed()), (FaceKind::Bspline, false, false));
    assert_eq!(
        (face.degree(), face.pole_count(), face.is_rational()),
        (Some([3, 3]), Some([4, 4]), Some(false))
    );
    assert!((face.area_mm2() - 100.0).abs() < 1e-10);
    // u runs along x although the file's poles do so first.
    assert!((face.point(uv(0.25, 0.5)) - Point3::new(2.5, 5.0, 0.0)).norm() < 1e-14);
}

#[test]
fn a_trimmed_surface_by_parameter_curves() {
    let mut list = vec![flat_patch()];
    list.extend(rectangle(1, [0.1, 0.9, 0.2, 0.8]));
    list.push(entity(142, "0,@0,@5,0,1"));
    // The hole: a full arc of radius 0.2 in parameters.
    list.push(entity(100, "0.,0.5,0.5,0.7,0.5,0.7,0.5"));
    list.push(entity(142, "0,@0,@7,0,1"));
    list.push(entity(144, "@0,1,1,@6,@8"));
    let face = only_face(&list);
    // The surface of a 144 is no face of its own; the face's number is the 144's.
    assert_eq!(face.entity, 19);
    assert_area(&face, 48.0 - 4.0 * PI);
    assert!(face.contains(uv(0.15, 0.5)) && !face.contains(uv(0.5, 0.5)) && !face.contains(uv(0.05, 0.5)));
}

#[test]
fn a_trimmed_surface_by_model_curves() {
    // The natural rectangle outside (N1 = 0), a hole by a circle in space.
    let list = vec![
        flat_patch(),
        entity(100, "0.,5.,5.,7.,5.,7.,5."),
        entity(142, "0,@0,0,@1,2"),
        entity(144, "@0,0,1,0,@2"),
    ];
    assert_area(&only_face(&list), 100.0 - 4.0 * PI);
    // A spline quarter and three lines.
    let list = vec![
        flat_patch(),
        entity(
            126,
            "2,2,1,0,0,0,0.,0.,0.,1.,1.,1.,1.,0.7071067811865476,1.,6.,0.,0.,6.,6.,0.,0.,6.,0.,0.,1.,0.,0.,1.",
        ),
        entity(110, "0.,6.,0.,0.,0.,0."),
        entity(110, "0.,0.,0.,6.,0.,0."),
        entity(102, "3,@1,@2,@3"),
        entity(142, "0,@0,0,@4,2"),
        entity(144, "@0,1,0,@5"),
    ];
    assert_area(&only_face(&list), 9.0 * PI);
}

#[test]
fn a_parameter_curve_of_another_scale_is_not_believed() {
    let list = vec![
        flat_patch(),
        entity(100, "0.,5.,5.,7.,5.,7.,5."),
        // Twice as large as the curve in space.
        entity(100, "0.,0.5,0.5,0.9,0.5,0.9,0.5"),
        entity(142, "0,@0,@2,@1,1"),
        entity(144, "@0,1,0,@3"),
    ];
    let part = part(&list);
    assert_area(&part.faces[0], 4.0 * PI);
    assert!(part.diagnostics.iter().any(|d| d.message.contains("projected")), "{:?}", part.diagnostics);
}

#[test]
fn transforms_units_and_scale() {
    let turn = "0.,-1.,0.,1.,1.,0.,0.,2.,0.,0.,1.,3.";
    let list = || {
        let patch = flat_patch();
        [Entity(128, 0, 2, patch.3), entity(124, turn)]
    };
    // (x, y, z) -> (1 - y, 2 + x, 3 + z).
    let face = only_face(&list());
    assert!((face.point(uv(0.5, 0.2)) - Point3::new(-1.0, 7.0, 3.0)).norm() < 1e-13);
    let inch = iges::read(file_in("1.,1,4HINCH", &list()).as_bytes()).unwrap();
    assert_eq!((inch.unit.as_str(), inch.format), ("INCH", Format::Iges));
    assert!((inch.faces[0].area_mm2() - 64516.0).abs() < 1e-6);
    assert!((inch.faces[0].point(uv(0.5, 0.2)) - Point3::new(-25.4, 177.8, 76.2)).norm() < 1e-11);
    // Model space at half of real size: lengths double, and it is said.
    let half = iges::read(file_in("0.5,2,2HMM", &list()).as_bytes()).unwrap();
    assert!((half.faces[0].area_mm2() - 400.0).abs() < 1e-9 && half.diagnostics.len() == 1);
    // A string that lies about its length in the global section.
    let text = punch("10Htest.igs", "1.,2,2HMM", &list());
    let lying = iges::read(text.as_bytes()).unwrap();
    assert_eq!((lying.unit.as_str(), lying.diagnostics.len()), ("MM", 1));
}

#[test]
fn planes_revolutions_and_extrusions() {
    let mut list = vec![entity(108, "0.,0.,2.,0.,0,0.,0.,0.,0.")];
    list.extend(rectangle(1, [1.0, 4.0, 1.0, 3.0]));
    list.push(entity(142, "0,@0,0,@5,2"));
    list.push(entity(144, "@0,1,0,@6"));
    let face = only_face(&list);
    assert_eq!(face.kind, FaceKind::Plane);
    assert!((face.area_mm2() - 6.0).abs() < 1e-9);
    // A line turned by a quarter about z: part of a cone, slant 5, radii 3 and 6.
    let quarter = [
        entity(110, "0.,0.,0.,0.,0.,1."),
        entity(110, "3.,0.,0.,6.,0.,4."),
        entity(120, format!("@0,@1,0.,{:?}", PI / 2.0)),
    ];
    let face = only_face(&quarter);
    assert_eq!(face.kind, FaceKind::Revolution);
    assert_area(&face, PI * 9.0 * 5.0 / 4.0);
    // A half circle of radius 2 extruded by 3: the end point is that of the first generator.
    let half = [entity(100, "0.,0.,0.,2.,0.,-2.,0."), entity(122, "@0,2.,0.,3.")];
    let face = only_face(&half);
    assert_eq!(face.kind, FaceKind::Extrusion);
    assert_area(&face, 6.0 * PI);
}

/// A cube's top as a face of a solid: 186, 514, 510, 508, 504 and 502.
fn solid(shell_sense: u32) -> Vec<Entity> {
    let mut list = vec![flat_patch()];
    list.extend(rectangle(1, [0.0, 10.0, 0.0, 10.0]));
    let edges: String = (0..4).map(|k| format!(",@{},@7,{},@7,{}", k + 1, k + 1, (k + 1) % 4 + 1)).collect();
    list.push(entity(504, format!("4{edges}")));
    list.push(entity(502, "4,0.,0.,0.,10.,0.,0.,10.,10.,0.,0.,10.,0."));
    let uses: String = (1..=4).map(|k| format!(",0,@6,{k},1,0")).collect();
    list.push(entity(508, format!("4{uses}")));
    list.push(entity(510, "@0,1,1,@8"));
    list.push(entity(514, format!("1,@9,{shell_sense}")));
    list.push(entity(186, "@10,1,0"));
    list
}

#[test]
fn faces_of_solids_know_their_side() {
    for (sense, z) in [(1, 1.0), (0, -1.0)] {
        let part = part(&solid(sense));
        let face = &part.faces[0];
        assert!(face.oriented && !face.trimmed() && part.faces.len() == 1);
        assert_eq!(face.jet2(uv(0.5, 0.5)).normal().unwrap().z, z);
    }
}

#[test]
fn a_bounded_surface() {
    let mut list = vec![flat_patch()];
    list.extend(rectangle(1, [2.0, 4.0, 2.0, 5.0]));
    list.push(entity(141, "0,1,@0,1,@5,1,0"));
    list.push(entity(143, "0,@0,1,@6"));
    assert_area(&only_face(&list), 6.0);
}

#[test]
fn what_cannot_be_read_is_told() {
    // Counts that lie, a composite that contains itself, a pointer to nothing, an unknown surface.
    let told = |list: &[Entity], what: &str| {
        let part = part(list);
        assert!(part.faces.is_empty() && part.not_used.len() == 1, "{:?}", part.not_used);
        assert!(part.diagnostics.iter().any(|d| d.message.contains(what)), "{what}: {:?}", part.diagnostics);
        part.not_used[0].kind.clone()
    };
    assert_eq!(
        told(&[entity(128, "2000000000,3,3,3,0,0,1,0,0,1.")], "count"),
        "128 rational B-spline surface"
    );
    assert_eq!(
        told(&[entity(128, "3,3,3,3,0,0,1,0,0,0.,0.,0.")], "parameters"),
        "128 rational B-spline surface"
    );
    let circular = [flat_patch(), entity(102, "1,@1"), entity(142, "0,@0,0,@1,2"), entity(144, "@0,1,0,@2")];
    told(&circular, "contain each other");
    told(&[flat_patch(), entity(144, "@0,1,0,99")], "99");
    assert_eq!(told(&[entity(118, "1,3,0,0")], "not read"), "118 ruled surface");
    let part = part(&[entity(150, "1.,2.,3.,0.,0.,0.,1.,0.,0.,0.,0.,1."), entity(110, "0.,0.,0.,1.,0.,0.")]);
    let kinds: Vec<&str> = part.not_used.iter().map(|n| n.kind.as_str()).collect();
    assert_eq!(kinds, ["150 solid primitive", "110 line"]);
}

#[test]
fn every_error() {
    assert_eq!(iges::read(b"no cards\nhere").unwrap_err(), IgesError::NotIges { searched: 2 });
    let text = file(&[flat_patch()]);
    assert_eq!(detect(text.as_bytes()), Some(Format::Iges));
    assert!(read(text.as_bytes()).is_ok());
    let before = |letter: &str| -> String {
        text.lines().take_while(|l| &l[72..73] != letter).map(|l| format!("{l}\n")).collect()
    };
    assert!(matches!(iges::read(before("D").as_bytes()).unwrap_err(), IgesError::NoDirectory { .. }));
    let e = read(before("P").as_bytes()).unwrap_err();
    assert!(matches!(e, ImportError::Iges(IgesError::NoParameters { .. })), "{e}");
}

#[test]
fn no_truncation_is_fatal() {
    let text = file(&solid(1));
    for end in (200..text.len() - 81).step_by(17) {
        if let Ok(part) = iges::read(&text.as_bytes()[..end]) {
            assert!(part.diagnostics.iter().any(|d| d.message.contains("truncated")), "{end}");
        }
    }
    // Without line ends the cards are 80 bytes each.
    let packed: String = text.lines().map(|l| format!("{l:<80}")).collect();
    assert_eq!(iges::read(packed.as_bytes()).unwrap().faces.len(), 1);
    assert_eq!(iges::read(text.replace('\n', "\r\n").as_bytes()).unwrap().faces.len(), 1);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Bytes changed anywhere: an error or a part, never a panic.
    #[test]
    fn damage_never_panics(changes in prop::collection::vec((0.0..1.0, any::<u8>(), any::<bool>()), 1..8)) {
        let mut bytes = file(&solid(1)).into_bytes();
        for (at, byte, keyboard) in changes {
            let k = (at * (bytes.len() - 1) as f64) as usize;
            // Half of the changes are characters that mean something.
            bytes[k] = if keyboard { b"0123456789.,;H-+ DPGS"[byte as usize % 21] } else { byte };
        }
        if let Ok(part) = read(&bytes) {
            for f in &part.faces {
                prop_assert!(f.area_mm2() >= 0.0 && f.entity > 0);
            }
        }
    }
}
