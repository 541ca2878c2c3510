//! Cutters against closed forms, and entries of lines against distances.

use super::*;
use proptest::prelude::*;

fn cutter(d: f64, r: f64) -> Cutter {
    Cutter::new(d, r, 60.0).unwrap()
}

#[test]
fn refuses_impossible_cutters() {
    assert!(matches!(Cutter::new(-1.0, 0.0, 10.0), Err(CutterError::Size { .. })));
    assert!(matches!(Cutter::new(f64::NAN, 0.0, 10.0), Err(CutterError::Size { .. })));
    assert!(matches!(Cutter::new(10.0, 5.1, 10.0), Err(CutterError::Corner { .. })));
    assert!(matches!(Cutter::new(10.0, -0.1, 10.0), Err(CutterError::Corner { .. })));
    assert!(matches!(Cutter::new(10.0, f64::NAN, 10.0), Err(CutterError::Corner { .. })));
    assert!(matches!(Cutter::new(10.0, 5.0, 4.0), Err(CutterError::Length { .. })));
}

#[test]
fn closed_forms() {
    let upright = Pose { tip: Point3::origin(), axis: Vec3::z_axis() };
    let up = |x: f64| Line { origin: Point3::new(x, 0.0, -3.0), direction: Vec3::z_axis() };
    // Straight up below the flat, the corner and outside.
    let t = cutter(20.0, 2.0);
    assert_eq!(t.entry(&upright, &up(7.0)).unwrap().at_mm, 3.0);
    let corner = t.entry(&upright, &up(9.0)).unwrap();
    assert!((corner.at_mm - (3.0 + 2.0 - 3f64.sqrt())).abs() < 1e-14, "{corner:?}");
    assert!(t.entry(&upright, &up(10.01)).is_none());
    // A ball: 2 - sqrt(4 - x^2).
    let b = cutter(4.0, 2.0);
    let e = b.entry(&upright, &up(1.2)).unwrap().at_mm;
    assert!((e - (3.0 + 2.0 - (4f64 - 1.44).sqrt())).abs() < 1e-14);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]
    /// Wherever a line enters, the distance is zero, negative just behind and positive before; where it misses,
    /// no sampled point of the line is inside.
    #[test]
    fn entry_is_the_first_zero_of_the_distance(
        kind in 0usize..5, r in 0.0..=1.0f64, o in prop::array::uniform3(-30.0..30.0f64), d in prop::array::uniform3(-1.0..1.0f64),
        a in prop::array::uniform3(-1.0..1.0f64)
    ) {
        let c = if kind == 0 { cutter(20.0, 10.0 * r) } else { crate::make::tests::shaped()[kind - 1] };
        let (Some(direction), Some(axis)) = (Unit3::try_new(Vec3::from(d), 0.1), Unit3::try_new(Vec3::from(a), 0.1))
        else { return Ok(()) };
        let pose = Pose { tip: Point3::new(0.3, -0.2, 0.1), axis };
        let line = Line { origin: Point3::from(o), direction };
        match c.entry(&pose, &line) {
            Some(e) => {
                prop_assert!(c.distance(&pose, &line.point(e.at_mm)).abs() < 1e-9);
                prop_assert!(c.distance(&pose, &line.point(e.at_mm - 0.5)) > 0.0);
                prop_assert!(e.at_mm > Cutter::least_entry_mm(&pose, &line) - 1e-9);
                prop_assert!(!c.enters_above(&pose, &line, e.at_mm + 1e-6));
                // The body of this question has no top.
                if kind == 0 && e.part != Part::Top {
                    prop_assert!(c.enters_above(&pose, &line, e.at_mm - 1e-3));
                }
                // The normal points against the line.
                let n = c.normal_at(&pose, &line.point(e.at_mm), e.part);
                prop_assert!(n.dot(&direction) <= 1e-6, "{n:?}");
            }
            None => {
                for k in -400..400 {
                    // A grazing line within rounding of the boundary counts as a miss.
                    prop_assert!(c.distance(&pose, &line.point(0.3 * f64::from(k))) > -1e-9);
                }
            }
        }
    }
}
