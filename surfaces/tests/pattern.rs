//! Circular patterns: faces of a part with known symmetry find their images, and what has none says so.

use crate::common;

use osculate_geom::{Axis, Point3, Side, TurnAxis, Unit3, Vec3, uv};
use osculate_surfaces::pattern::{Circle, Pattern, PatternError, PatternFace, same_axis};
use osculate_surfaces::{Net, NurbsSurface, TrimmedSurface};
use proptest::prelude::*;
use std::f64::consts::TAU;
use std::sync::Arc;

/// A bent patch off the axis z, with its poles moved by up to 2 mm.
fn blade(bends: &[f64; 9]) -> NurbsSurface {
    let at = |k: usize| {
        let (i, j) = ((k / 3) as f64, (k % 3) as f64);
        Point3::new(20.0 + 8.0 * i, 1.0 + 2.0 * bends[k], 6.0 * j + 2.0 * bends[8 - k])
    };
    let knots = vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    let net = Net { count: [3, 3], points: (0..9).map(at).collect(), weights: None };
    NurbsSurface::new([2, 2], [knots.clone(), knots], net).unwrap()
}

fn moved(s: &NurbsSurface, by: &nalgebra::Isometry3<f64>) -> NurbsSurface {
    let net = s.net();
    let points = net.points.iter().map(|p| by * p).collect();
    let knots = [Axis::U, Axis::V].map(|a| s.knots(a).as_slice().to_vec());
    NurbsSurface::new(s.degree(), knots, Net { count: net.count, points, weights: net.weights.clone() })
        .unwrap()
}

/// A face with its spline.
type Own = (String, TrimmedSurface, Arc<NurbsSurface>);

fn face(name: String, spline: NurbsSurface, loops: &[Vec<osculate_geom::Uv>]) -> Own {
    let spline = Arc::new(spline);
    let carrier: Arc<dyn osculate_geom::Surface> = spline.clone();
    (name, TrimmedSurface::new(carrier, loops, Side::Along).unwrap(), spline)
}

/// As many blades about an axis, all as one face.
fn wheel(bends: &[f64; 9], circle: &Circle, place: &nalgebra::Isometry3<f64>) -> Vec<Own> {
    let first = moved(&blade(bends), place);
    (0..circle.count).map(|k| face(format!("B{}", k + 1), moved(&first, &circle.turn(k)), &[])).collect()
}

fn listed(faces: &[Own]) -> Vec<PatternFace<'_>> {
    faces.iter().map(|(name, surface, spline)| PatternFace { name, surface, carrier: Some(spline) }).collect()
}

/// The motion that takes z to an axis.
fn upon(axis: &TurnAxis) -> nalgebra::Isometry3<f64> {
    let to = nalgebra::UnitQuaternion::rotation_between(&Vec3::z(), &axis.direction).unwrap();
    nalgebra::Isometry3::from_parts(axis.origin.coords.into(), to)
}

fn z() -> TurnAxis {
    TurnAxis { origin: Point3::origin(), direction: Vec3::z_axis() }
}

const FLAT: [f64; 9] = [0.0, 0.3, 0.6, 0.0, -0.2, 0.4, 0.1, 0.5, -0.3];
const EXACT: f64 = 1e-6;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Whatever the axis, the turn k takes the first blade to the blade k + 1, and no other number of places serves but divisors.
    #[test]
    fn blades_find_their_images(
        bends in prop::array::uniform9(-1.0..1.0f64),
        count in 2usize..8,
        at in prop::array::uniform3(-30.0..30.0f64),
        lean in prop::array::uniform2(-2.0..2.0f64),
        other in 2usize..12,
    ) {
        let direction = Unit3::new_normalize(Vec3::new(lean[0], lean[1], 1.0));
        let circle = Circle { axis: TurnAxis { origin: Point3::from(at), direction }, count };
        let faces = wheel(&bends, &circle, &upon(&circle.axis));
        let pattern = Pattern::new(&listed(&faces), EXACT);
        let images = pattern.images(&[0], &circle).unwrap();
        prop_assert_eq!(images, (1..count).map(|k| vec![k]).collect::<Vec<_>>());
        prop_assert_eq!(pattern.most_places(&[0], &circle.axis), Some(count));
        let got = pattern.images(&[0], &Circle { count: other, ..circle });
        prop_assert_eq!(got.is_ok(), count % other == 0, "{:?}", got);
        // About an axis a little beside it there is none.
        let beside = TurnAxis { origin: circle.axis.origin + direction.cross(&Vec3::x()).normalize() * 0.01, direction };
        let got = pattern.images(&[0], &Circle { axis: beside, count });
        let said = matches!(&got, Err(PatternError::NoImage { face, .. }) if face == "B1");
        prop_assert!(said, "{got:?}");
    }
}

#[test]
fn five_places_on_a_wheel_of_six_are_refused_with_face_angle_and_distance() {
    let six = Circle { axis: z(), count: 6 };
    let faces = wheel(&FLAT, &six, &nalgebra::Isometry3::identity());
    let pattern = Pattern::new(&listed(&faces), EXACT);
    let got = pattern.images(&[0], &Circle { count: 5, ..six }).unwrap_err();
    let said = got.to_string();
    assert!(said.starts_with("B1 turned by 72.0000 deg is not on the part: it is "), "{said}");
    let Err(PatternError::Count { got: 1 }) = pattern.images(&[0], &Circle { count: 1, ..six }) else {
        panic!("one place is none");
    };
    assert_eq!(pattern.most_places(&[0], &six.axis), Some(6));
    // Every other blade.
    assert_eq!(pattern.images(&[0, 1], &Circle { count: 3, ..six }).unwrap(), vec![vec![2, 3], vec![4, 5]]);
}

#[test]
fn an_image_may_be_cut_into_other_faces() {
    let three = Circle { axis: z(), count: 3 };
    let mut faces = wheel(&FLAT, &three, &nalgebra::Isometry3::identity());
    // The second blade is two faces, cut askew.
    let (_, _, spline) = faces.remove(1);
    let cut = |side: [f64; 2]| vec![uv(side[0], 0.0), uv(0.4, 0.0), uv(0.7, 1.0), uv(side[1], 1.0)];
    for (name, side) in [("B2a", [0.0, 0.0]), ("B2b", [1.0, 1.0])] {
        faces.push(face(name.to_owned(), (*spline).clone(), &[cut(side)]));
    }
    let pattern = Pattern::new(&listed(&faces), EXACT);
    assert_eq!(pattern.images(&[0], &three).unwrap(), vec![vec![2, 3], vec![1]]);
    assert_eq!(pattern.images(&[2, 3], &three).unwrap(), vec![vec![1], vec![0]]);
    let piece = pattern.images(&[2], &three).unwrap_err().to_string();
    assert_eq!(piece.split(':').next(), Some("B2a turned by 120.0000 deg is only a piece of B3"), "{piece}");
    // A part with one of the halves only.
    faces.pop();
    let pattern = Pattern::new(&listed(&faces), EXACT);
    let half = pattern.images(&[0], &three).unwrap_err();
    assert!(matches!(half, PatternError::NoImage { .. }), "{half}");
}

#[test]
fn a_turned_face_is_its_own_image_and_a_hole_is_seen_by_its_area() {
    let round = common::cylinder(10.0, 20.0);
    let faces = [face("F1".to_owned(), round, &[])];
    let pattern = Pattern::new(&listed(&faces), EXACT);
    let got = pattern.images(&[0], &Circle { axis: z(), count: 4 }).unwrap_err();
    assert!(matches!(&got, PatternError::Itself { on, .. } if on == "F1"), "{got}");
    let two = Circle { axis: z(), count: 2 };
    let mut faces = wheel(&FLAT, &two, &nalgebra::Isometry3::identity());
    let (name, _, spline) = faces.remove(1);
    let whole = vec![uv(0.0, 0.0), uv(1.0, 0.0), uv(1.0, 1.0), uv(0.0, 1.0)];
    let hole = vec![uv(0.45, 0.45), uv(0.45, 0.55), uv(0.55, 0.55), uv(0.55, 0.45)];
    faces.push(face(name, (*spline).clone(), &[whole, hole]));
    let pattern = Pattern::new(&listed(&faces), EXACT);
    let got = pattern.images(&[0], &two).unwrap_err();
    assert!(matches!(got, PatternError::Area { .. } | PatternError::NoImage { .. }), "{got}");
}

#[test]
fn turns_keep_to_their_axis() {
    let axis = TurnAxis {
        origin: Point3::new(1.0, 2.0, 3.0),
        direction: Unit3::new_normalize(Vec3::new(1.0, 1.0, 1.0)),
    };
    let circle = Circle { axis, count: 3 };
    assert!((circle.turn(1) * Point3::new(2.0, 2.0, 3.0) - Point3::new(1.0, 3.0, 3.0)).norm() < 1e-12);
    let full = axis.turn(TAU);
    assert!((full * Point3::new(7.0, -3.0, 1.0) - Point3::new(7.0, -3.0, 1.0)).norm() < 1e-12);
    let along =
        TurnAxis { origin: axis.origin + axis.direction.into_inner() * 5.0, direction: -axis.direction };
    assert!(same_axis(&axis, &along, 1e-9) && !same_axis(&axis, &z(), 1e-9));
}
