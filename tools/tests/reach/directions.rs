//! Counts, neighbours and the nearest of the directions, and sets of them.

use crate::reach::scenes::sphere;
use osculate_geom::{Unit3, Vec3};
use osculate_tools::reach::{Bits, Directions, DirectionsError};
use proptest::prelude::*;

#[test]
fn counts_are_those_of_a_subdivided_icosahedron() {
    for level in 0..6 {
        let directions = sphere(level);
        assert_eq!(directions.all().len(), 10 * 4usize.pow(level) + 2);
        let five = (0..directions.all().len()).filter(|&k| directions.neighbours(k).len() == 5).count();
        assert_eq!(five, 12);
    }
    assert!(matches!(Directions::icosphere(9), Err(DirectionsError::Level { level: 9, most: 8 })));
}

#[test]
fn neighbours_are_mutual_and_near() {
    let directions = sphere(4);
    let all = directions.all();
    let mut least = f64::INFINITY;
    for k in 0..all.len() {
        let near = directions.neighbours(k);
        assert!(near.windows(2).all(|w| w[0] < w[1]));
        for &j in near {
            assert!(directions.neighbours(j as usize).contains(&(k as u32)));
            let apart = all[k].angle(&all[j as usize]);
            assert!(apart <= directions.spacing_rad() + 1e-12);
            least = least.min(apart);
        }
    }
    // The known spread of edges of a subdivided icosahedron: 3.95 to 4.73 degrees at level 4.
    assert!((least.to_degrees() - 3.95).abs() < 0.05, "{}", least.to_degrees());
    assert!((directions.spacing_rad().to_degrees() - 4.73).abs() < 0.05, "{}", directions.spacing_rad());
}

#[test]
fn the_first_of_a_finer_set_are_the_coarser_one() {
    let (coarse, fine) = (sphere(2), sphere(3));
    assert_eq!(coarse.all(), &fine.all()[..coarse.all().len()]);
}

#[test]
fn sets_count_and_iterate() {
    let mut bits = Bits::of(130, |k| k % 64 == 1);
    assert_eq!((bits.len(), bits.count()), (130, 3));
    assert_eq!(bits.iter().collect::<Vec<_>>(), [1, 65, 129]);
    bits.clear(65);
    bits.clear(1000);
    bits.set(0);
    assert_eq!(bits.iter().collect::<Vec<_>>(), [0, 1, 129]);
    assert!(!bits.contains(1000) && !bits.is_empty() && Bits::none(5).is_empty());
    assert_eq!(bits.and(&Bits::of(130, |k| k > 0)).count(), 2);
}

proptest! {
    #[test]
    fn the_nearest_is_the_nearest_of_all(level in 0u32..6, a in prop::array::uniform3(-1.0..1.0f64)) {
        let Some(axis) = Unit3::try_new(Vec3::from(a), 1e-3) else { return Ok(()) };
        let directions = sphere(level);
        let found = directions.all()[directions.nearest(&axis)].dot(&axis);
        let best = directions.all().iter().map(|d| d.dot(&axis)).fold(-1.0, f64::max);
        prop_assert_eq!(found, best);
        prop_assert!(found >= (0.6 * directions.spacing_rad()).cos());
    }
}
