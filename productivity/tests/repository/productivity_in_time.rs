//! Productivity integrated over time on real faces: roughing against material removal, finishing against the area.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::rows;
use crate::slot;

use osculate_surfaces::{Part, read};
use osculate_tools::{Cutter, CutterSpec, Lean};
use slot::Slot;

fn part(file: &str) -> Part {
    let path = format!("{}/../examples/{file}", env!("CARGO_MANIFEST_DIR"));
    read(&std::fs::read(path).unwrap()).unwrap()
}

/// Ball and toroidal, two real faces; coarser than the example `productivity_in_time`, which prints more of it.
#[test]
fn roughing_takes_what_removal_takes() {
    let length_mm = 30.0;
    let lean = Lean { lead_rad: 0.25, tilt_rad: 0.0 };
    for (file, face, [fu, fv], spec) in [
        ("propeller/propeller.step", "F7", [0.5, 0.5], CutterSpec::Ball { diameter_mm: 4.0, length_mm }),
        (
            "wigley-hull/hull.step",
            "F1",
            [0.4, 0.4],
            CutterSpec::Toroidal { diameter_mm: 5.0, corner_radius_mm: 1.0, length_mm },
        ),
    ] {
        let part = part(file);
        let face = part.face(face).unwrap();
        let cutter = Cutter::try_from(spec).unwrap();
        let at = osculate_geom::Surface::domain(face).at(fu, fv);
        let slot = Slot {
            face,
            at,
            cutter: &cutter,
            lean,
            stock_mm: 0.6,
            length_mm: 3.0,
            step_mm: 1.2,
            cell_mm: 0.08,
            instants: 20,
        };
        let got = slot.volumes();
        for (a, b) in got.by_rate.iter().zip(got.by_removal) {
            assert!(b > 0.5 && (a / b - 1.0).abs() < 5e-3, "{file}: {got:?}");
        }
    }
}

#[test]
fn finishing_adds_up_to_the_area() {
    for (file, face) in [("propeller/propeller.step", "F7"), ("wigley-hull/hull.step", "F1")] {
        let part = part(file);
        let face = part.face(face).unwrap();
        let got = rows::integrated(face, 2, 3.7);
        assert!((got / face.area_mm2() - 1.0).abs() < 1e-3, "{file}: {got} against {}", face.area_mm2());
    }
}
