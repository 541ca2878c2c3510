//! From standoffs to verdicts.

use crate::removal::common::{ball, sample, through, upright};
use osculate_geom::analytic::Plane;
use osculate_geom::{Domain, Interval};
use osculate_tools::cl::{ClMove, ClPath, Motion};
use osculate_tools::removal::{
    Body, By, Cut, Density, Job, Kind, Limits, Sample, Swept, Tally, TallyError, Touch, crests, cut,
    sample_surface, tally,
};

const DENSITY: Density = Density { spacing_mm: 0.1, convex_per_mm: 0.0 };

fn cut_to(standoff_mm: f64) -> Cut {
    let by = By { motion: 3, block: 30, body: Body::Cutter, rapid: false };
    Cut { standoff_mm, by: Some(by), rapid: None, holder: None }
}

fn line(count: usize) -> Vec<Sample> {
    (0..count).map(|k| sample([k as f64, 0.0, 0.0], [0.0, 0.0, 1.0])).collect()
}

fn judged(samples: &[Sample], cuts: &[Cut]) -> Tally {
    tally(samples, cuts, &Limits::new(0.01, 0.005), &DENSITY, 5.0).expect("good limits")
}

#[test]
fn quantiles_go_by_area() {
    let mut samples = line(200);
    let mut cuts: Vec<Cut> = (0..200).map(|k| cut_to(4e-5 * k as f64)).collect();
    let even = judged(&samples, &cuts);
    assert!(even.within);
    // 198 of 200 samples reach 99 percent, 100 the median.
    assert_eq!((even.scallop_p99_mm, even.median_mm), (4e-5 * 197.0, 4e-5 * 99.0));
    assert_eq!(even.scallop_max_mm, 4e-5 * 199.0);
    // The highest sample stands for as much as all others together: it is the 99th percentile.
    samples[199].area_mm2 = 200.0;
    assert_eq!(judged(&samples, &cuts).scallop_p99_mm, 4e-5 * 199.0);
    let bins: f64 = even.histogram.iter().map(|b| b.area_mm2).sum();
    assert_eq!(bins, 200.0);
    assert!(even.histogram.windows(2).all(|b| b[0].to_mm == b[1].from_mm));
    // One sample above the tolerance is enough.
    cuts[5] = cut_to(0.0101);
    assert!(!judged(&samples, &cuts).within);
}

/// Passes of a ball on a plane: two of them meet at `R - sqrt(R^2 - (w/2)^2)` above it, whatever the spacing of the samples.
#[test]
fn crests_are_the_ridges_between_passes() {
    let cutter = ball(10.0);
    let square = Interval::new(0.0, 20.0);
    let plane = Plane::new(Domain { u: square, v: square });
    let high = |width: f64| 5.0 - (25.0 - 0.25 * width * width).sqrt();
    // To and fro, two narrow strips to three wide ones.
    let (mut poses, mut y) = (Vec::new(), 0.3);
    for k in 0.. {
        let [a, b] = if k % 2 == 0 { [-5.0, 25.0] } else { [25.0, -5.0] };
        poses.extend([upright(a, y, 0.0), upright(b, y, 0.0)]);
        y += if k % 5 < 2 { 0.4 } else { 0.7 };
        if y > 20.0 {
            break;
        }
    }
    let motions = through(&poses);
    for spacing in [0.25, 1.3] {
        let found = sample_surface(&plane, 0, spacing, 10_000).unwrap();
        let job = |samples| Job {
            cutter: &cutter,
            holder: None,
            changes: &[],
            motions: &motions,
            samples,
            stock_mm: 1.0,
            depth_mm: 2.0,
        };
        let (samples, with) = (&found.samples, job(&found.samples));
        let cuts = cut(&with, &|_| ()).unwrap();
        // Rays are a thirtieth of a strip apart; what parabolas leave of a circle's fourth order lies far below.
        let median = crests(&[&plane], &with, &cuts, 0.6, 0.05).unwrap();
        assert!((median - high(0.7)).abs() < 1e-6, "{median} want {}", high(0.7));
        assert_eq!(crests(&[&plane], &with, &cuts, f64::NAN, 0.05).unwrap(), 0.0);
        // Check faces have none, nor what was never touched, nor one pass alone.
        let check: Vec<Sample> = samples.iter().map(|s| Sample { check_only: true, ..*s }).collect();
        assert_eq!(crests(&[&plane], &job(&check), &cuts, 0.6, 0.05).unwrap(), 0.0);
        let bare: Vec<Cut> = cuts.iter().map(|c| Cut { by: None, ..*c }).collect();
        assert_eq!(crests(&[&plane], &with, &bare, 0.6, 0.05).unwrap(), 0.0);
        let one = Job { motions: &motions[..1], ..with };
        let cuts = cut(&one, &|_| ()).unwrap();
        assert_eq!(crests(&[&plane], &one, &cuts, 0.6, 0.05).unwrap(), 0.0);
    }
}

#[test]
fn uncut_is_told_from_scallops() {
    let samples = line(100);
    let mut cuts = vec![cut_to(0.004); 100];
    cuts[10] = Cut { standoff_mm: 0.3, by: None, rapid: None, holder: None };
    cuts[50] = cut_to(0.2);
    let v = judged(&samples, &cuts);
    assert!(!v.within && v.uncut_area_mm2 == 2.0 && v.uncut_samples == 2 && v.scallop_max_mm == 0.004);
    let uncut: Vec<_> =
        v.worst.iter().filter(|w| w.kind == Kind::Uncut).map(|w| (w.value_mm, w.block)).collect();
    assert_eq!(uncut, [(0.3, None), (0.2, Some(30))]);
    // A layer of stock thinner than the tolerance is uncut all the same where nothing touched it.
    cuts[10].standoff_mm = 0.001;
    cuts[50] = cut_to(0.004);
    assert!(!judged(&samples, &cuts).within);
    // But not on a checked face.
    let mut checked = samples.clone();
    checked[10].check_only = true;
    assert!(judged(&checked, &cuts).within);
}

#[test]
fn gouges_and_collisions_fail_a_path() {
    let samples = line(100);
    let mut cuts = vec![cut_to(0.004); 100];
    cuts[20] = cut_to(-0.006);
    let v = judged(&samples, &cuts);
    assert!(
        !v.within && v.gouge_max_mm == 0.006 && v.gouge_area_mm2 == 1.0 && v.worst[0].kind == Kind::Gouge
    );
    cuts[20] = cut_to(-0.004);
    assert!(judged(&samples, &cuts).within);
    let touch = Some(Touch { removed_mm: 0.2, motion: 1, block: 9 });
    for (kind, hit) in [
        (Kind::Holder, Cut { holder: touch, ..cut_to(0.0) }),
        (Kind::Rapid, Cut { rapid: touch, ..cut_to(0.0) }),
    ] {
        cuts[30] = hit;
        let v = judged(&samples, &cuts);
        let worst = v.worst.iter().find(|w| w.kind == kind).unwrap();
        assert!(!v.within && v.holder_max_mm + v.rapid_max_mm == 0.2);
        assert!(worst.block == Some(9) && worst.value_mm == 0.2 && worst.at == samples[30].point);
    }
}

#[test]
fn worst_places_are_apart_and_few() {
    let samples = line(1000);
    // A hump around 500 and a lower one around 200.
    let height = |k: usize| {
        let hump = |at: f64, top: f64| top - 1e-6 * (k as f64 - at).abs();
        hump(500.0, 0.02).max(hump(200.0, 0.018))
    };
    let cuts: Vec<Cut> = (0..1000).map(|k| cut_to(height(k))).collect();
    let v = judged(&samples, &cuts);
    let at: Vec<f64> = v.worst.iter().map(|w| w.at.x).collect();
    assert!(at.len() == 10 && at[0] == 500.0, "{at:?}");
    for (k, a) in at.iter().enumerate() {
        assert!(at[..k].iter().all(|b| (a - b).abs() >= 999.0 / 50.0), "{at:?}");
    }
    assert!(v.worst.windows(2).all(|w| w[0].value_mm >= w[1].value_mm));
}

#[test]
fn nonsense_is_refused() {
    let samples = line(3);
    let cuts = vec![cut_to(0.0); 2];
    let limits = Limits::new(0.01, 0.005);
    assert!(matches!(
        tally(&samples, &cuts, &limits, &DENSITY, 5.0),
        Err(TallyError::Count { samples: 3, cuts: 2 })
    ));
    let cuts = vec![cut_to(0.0); 3];
    for bad in [
        Limits { scallop_mm: 0.0, ..limits },
        Limits { gouge_mm: f64::NAN, ..limits },
        Limits { uncut_mm: 0.009, ..limits },
    ] {
        assert!(matches!(tally(&samples, &cuts, &bad, &DENSITY, 5.0), Err(TallyError::Limits(_))));
    }
    let mut no_area = samples.clone();
    no_area[1].area_mm2 = f64::NAN;
    assert!(matches!(
        tally(&no_area, &cuts, &limits, &DENSITY, 5.0),
        Err(TallyError::Area { sample: 1, .. })
    ));
    let empty = tally(&[], &[], &limits, &DENSITY, 5.0).unwrap();
    assert!(empty.samples == 0 && empty.scallop_p99_mm == 0.0 && empty.worst.is_empty());
}

#[test]
fn a_path_becomes_motions() {
    let at = |x: f64| upright(x, 0.0, 0.0);
    let go = |x: f64, motion: Motion| ClMove { pose: at(x), motion, aloft: false };
    let path = ClPath {
        moves: vec![go(0.0, Motion::Rapid), go(1.0, Motion::Feed(100.0)), go(2.0, Motion::Rapid)],
        ..ClPath::default()
    };
    let want = [
        Swept { from: at(0.0), to: at(1.0), rapid: false, block: 1 },
        Swept { from: at(1.0), to: at(2.0), rapid: true, block: 2 },
    ];
    assert_eq!(Swept::along(&path), want);
}
