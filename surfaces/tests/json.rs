//! Faces as JSON and back: the same text, the same points to the bit; and every way a text can be wrong.

use crate::part21;
use crate::solids;

use osculate_geom::Side;
use osculate_surfaces::json::{self, FaceFault, JsonError};
use osculate_surfaces::{Face, MeshOptions, mesh_faces, step};
use part21::{circle, file, flat_patch, only_face};

fn patch_with_hole() -> Face {
    let hole = circle(300, [5.0, 5.0, 0.0], 2.0, false);
    let (outer, l) = part21::polygon(200, &part21::SQUARE);
    only_face(&file(&format!(
        "{}{outer}{hole}#400=FACE_BOUND('',#{l},.T.);#401=FACE_BOUND('',#309,.T.);\
         #402=ADVANCED_FACE('a patch',(#400,#401),#120,.T.);",
        flat_patch()
    )))
}

#[test]
fn faces_come_back_to_the_bit() {
    let mut patch = vec![patch_with_hole()];
    patch.push(patch[0].clone().flipped());
    for (what, faces) in [
        ("cylinder", solids::cylinder()),
        ("block", solids::block_with_bore()),
        ("sphere", solids::sphere()),
        ("torus", solids::torus()),
        ("cone", solids::cone()),
        ("patches", patch),
    ] {
        let text = json::write(&faces).unwrap();
        let back = json::read(text.as_bytes()).unwrap();
        assert_eq!(json::write(&back).unwrap(), text, "{what}");
        assert_eq!(back.len(), faces.len());
        let part = osculate_surfaces::read(text.as_bytes()).unwrap();
        assert_eq!((part.format, part.faces.len()), (osculate_surfaces::Format::Json, faces.len()));
        for (a, b) in faces.iter().zip(&back) {
            assert_eq!((&a.id, &a.name, a.kind, a.oriented), (&b.id, &b.name, b.kind, b.oriented));
            assert_eq!(a.surface.side(), b.surface.side());
            assert_eq!(a.surface.loops(), b.surface.loops());
            let (p, q) = (a.surface.samples(3), b.surface.samples(3));
            assert_eq!(p, q, "{what} {}", a.id);
        }
        let [m, n] = [&faces, &back].map(|f| mesh_faces(f, &MeshOptions::chord(0.05)).unwrap());
        assert_eq!(m.positions.len(), n.positions.len(), "{what}");
        assert_eq!(m.report.watertight(), n.report.watertight(), "{what}");
    }
}

#[test]
fn what_json_gives_step_takes() {
    let faces = json::read(json::write(&solids::block_with_bore()).unwrap().as_bytes()).unwrap();
    let options = step::StepOptions::default();
    assert_eq!(
        step::write(&faces, &options).unwrap(),
        step::write(&solids::block_with_bore(), &options).unwrap()
    );
    assert_eq!(faces[0].surface.side(), Side::Against);
}

fn wrong(from: &str, to: &str) -> JsonError {
    let text = json::write(&[solids::cylinder().remove(0), patch_with_hole()]).unwrap();
    assert!(text.contains(from), "{from} is not in the text");
    json::read(text.replacen(from, to, 1).as_bytes()).unwrap_err()
}

#[test]
fn every_error() {
    assert!(matches!(json::read(b"{"), Err(JsonError::Syntax { line: 1, column: 1, .. })));
    assert!(matches!(wrong("\"format\": 1", "\"format\": 2"), JsonError::Format { got: 2 }));
    let unknown = wrong("\"radius_mm\"", "\"colour\": 1, \"radius_mm\"").to_string();
    assert!(unknown.contains("colour") && unknown.contains("line"), "{unknown}");
    let fault = |from, to| match wrong(from, to) {
        JsonError::Face { face, why } => (face, why),
        other => panic!("{other}"),
    };
    assert!(matches!(fault("\"radius_mm\": 3.0", "\"radius_mm\": -3.0").1, FaceFault::Size(_)));
    assert!(matches!(fault("\"kind\": \"cylinder\"", "\"kind\": \"tube\"").1, FaceFault::Kind { .. }));
    assert!(matches!(
        fault("\"ends\"", "\"parameters\": [[0.0, 0.0], [1.0, 1.0]], \"ends\"").1,
        FaceFault::Edge { of: 0, edge: 0 }
    ));
    assert!(matches!(
        fault("\"x\": [\n              1.0", "\"x\": [\n              2.0").1,
        FaceFault::Frame { .. }
    ));
    assert!(matches!(
        fault("\"degree\": [\n            3", "\"degree\": [\n            900").1,
        FaceFault::Number { .. }
    ));
    assert_eq!(
        fault("\"semi_axes_mm\": [\n                  3.0", "\"semi_axes_mm\": [\n                  0.0").0,
        "F1"
    );
}
