//! Sides of faces that neither the file nor the part says: asked for by face, and taken from the job.

use crate::common;
use common::{Scratch, job};
use osculate::{Failure, Job, Part};
use osculate_geom::{Surface, uv};
use std::path::Path;

/// Two flat patches of Bezier points, 10 mm wide and 100 mm apart, with S_u x S_v along +z or -z.
fn patches() -> String {
    let indices = |first: usize| (first..first + 16).map(|k| k.to_string()).collect::<Vec<_>>().join(",");
    let mut text = format!("2\n{}\n{}\n32\n", indices(1), indices(17));
    for x0 in [0.0, 100.0] {
        for k in 0..16 {
            let (i, j) = (f64::from(k / 4), f64::from(k % 4));
            text += &format!("{:?},{:?},0.0\n", x0 + 10.0 / 3.0 * j, 10.0 / 3.0 * i);
        }
    }
    text
}

fn part(scratch: &Scratch, faces: &str, more: &str) -> Result<Part, Failure> {
    std::fs::write(scratch.path("two.bpt"), patches()).unwrap();
    let text = job(|j| {
        let start = j.find("builtin").unwrap();
        let end = j[start..].find('\n').unwrap() + start;
        let file = format!("file = \"two.bpt\"\nunit_mm = 1\nfaces = {faces}\n{more}");
        format!("{}{file}{}", &j[..start], &j[end..])
    });
    Part::of(&Job::from_toml(&text, &scratch.path("job.toml"))?)
}

/// The z component of the outward normal in the middle of the first face.
fn up(part: &Part) -> f64 {
    let face = &part.faces[0].surface;
    let d = face.domain();
    face.jet2(uv(d.u.at(0.5), d.v.at(0.5))).normal().unwrap().z
}

#[test]
fn each_face_is_asked_for_and_takes_the_side_that_the_job_says() {
    let scratch = Scratch::new();
    let open = part(&scratch, "\"all\"", "").err().unwrap();
    for word in ["F1", "F2", "[[part.side]]", "below_normal", "probe", "lines"] {
        assert!(open.message().contains(word), "{word}: {}", open.message());
    }
    let side =
        |id: &str, material: &str| format!("[[part.side]]\nfaces = [\"{id}\"]\nmaterial = \"{material}\"\n");
    let of = |material: &str| up(&part(&scratch, "[\"F1\"]", &side("F1", material)).unwrap());
    let (below, above) = (of("below_normal"), of("above_normal"));
    assert!((below.abs() - 1.0).abs() < 1e-12 && (below + above).abs() < 1e-12, "{below} {above}");
    // A word for one face says nothing of the other: it is not looked at, and the verdict's scope says so.
    let one = part(&scratch, "[\"F1\"]", &side("F1", "below_normal")).unwrap();
    assert_eq!((one.open.as_slice(), one.check.len()), (&["F2".to_owned()][..], 0));
    let both = format!("{}{}", side("F1", "below_normal"), side("F2", "above_normal"));
    let both = part(&scratch, "[\"F1\"]", &both).unwrap();
    assert!(both.open.is_empty() && both.check.len() == 1);
    assert!((both.check[0].surface.jet2(uv(0.5, 0.5)).normal().unwrap().z + below).abs() < 1e-12);
    // What it says of one face counts before what `normals` says of all.
    let more = format!("normals = \"file\"\n{}", side("F1", "above_normal"));
    assert!((up(&part(&scratch, "[\"F1\"]", &more).unwrap()) - above).abs() < 1e-12);
}

#[test]
fn what_cannot_be_meant_is_refused() {
    let scratch = Scratch::new();
    let said = |more: &str| part(&scratch, "[\"F1\"]", more).err().unwrap().message().to_owned();
    let of = |faces: &str, material: &str| {
        said(&format!("[[part.side]]\nfaces = {faces}\nmaterial = \"{material}\"\n"))
    };
    assert!(of("[\"F7\"]", "below_normal").contains("F7"));
    assert!(of("[\"F1\"]", "below").contains("below_normal"));
    assert!(of("[\"F1\", \"F1\"]", "below_normal").contains("once"));
    assert!(said("[[part.side]]\nfaces = [\"F1\"]\n").contains("material"));
    // A file that says the sides itself.
    let hull = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/hull.step");
    let text = job(|j| {
        let start = j.find("builtin").unwrap();
        let end = j[start..].find('\n').unwrap() + start;
        let file = format!("file = {hull:?}\n[[part.side]]\nfaces = \"F1\"\nmaterial = \"above_normal\"");
        format!("{}{file}{}", &j[..start], &j[end..])
    });
    let why = Job::from_toml(&text, &scratch.path("job.toml"))
        .and_then(|j| Part::of(&j).map(|_| ()))
        .err()
        .unwrap();
    assert!(why.message().contains("the file says the side"), "{}", why.message());
}
