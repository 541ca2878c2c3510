//! Exact strips on a measured blade against brute force ([`dense`]).

use crate::dense;

use dense::{Steps, dense};
use osculate_geom::uv;
use osculate_surfaces::read;
use osculate_tools::{Contact, Cutter, CutterSpec, FeedLine, Lean, strip};

/// A blade through measured points, whose waves are a thirtieth of the cutter's radius long: it rocks over them.
#[test]
fn a_blade_with_waves_finer_than_the_cutter() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/eee-hpt-rotor2/blade.igs");
    let part = read(&std::fs::read(file).unwrap()).unwrap();
    let face = part.face("F1").unwrap();
    let spec = CutterSpec::Toroidal { diameter_mm: 3.0, corner_radius_mm: 0.5, length_mm: 40.0 };
    let cutter = Cutter::try_from(spec).unwrap();
    let (first, second) = (uv(1.089_676_709, 1.760_635_816), uv(1.478, 1.484));
    for (at, angle, tilt_rad, scallop_mm) in [
        (first, 2.785_714, 0.213_400, 0.008_354),
        (first, 3.403_392, 0.4, 0.008_546),
        // Two passages meet in an edge 0.4 mm from the contact, some hundredths of a millimetre wide where it stands above the lower
        // tolerance and a little below the higher one: the strip ends at it or goes on for as much again.
        (second, 3.4034, 0.4, 0.0080),
        (second, 3.4034, 0.4, 0.0083),
    ] {
        let lean = Lean { lead_rad: 3f64.to_radians(), tilt_rad };
        let contact = Contact::new(face, at, &cutter, FeedLine::Angle(angle), lean).unwrap();
        let got = strip::exact(&contact, scallop_mm).unwrap();
        let steps = if at == first {
            Steps { along_mm: 0.01, across_mm: 0.02 }
        } else {
            Steps { along_mm: 0.01, across_mm: 0.005 }
        };
        let want = dense(&contact, spec, scallop_mm, &steps, 1.2 * got.left_mm.max(got.right_mm));
        let beyond = got.left_mm > 0.41;
        assert!(want.other_passages > 0 || at == second && !beyond, "{want:?}");
        for (a, b) in [(got.left_mm, want.left_mm), (got.right_mm, want.right_mm)] {
            assert!((a - b).abs() < 1e-5 * got.width_mm, "{got:?} {want:?}");
        }
    }
}
