//! What must not touch: holder, rapids, and what does not touch though it seems to.

use crate::removal::common::{ball, flat, run, sample, through, upright};
use osculate_tools::removal::{Body, Cut, Job, JobError, Sample, Swept, cut};
use osculate_tools::{Cutter, Holder, HolderSpec};

fn with_holder(cutter: &Cutter, holder: &Holder, motions: &[Swept], samples: &[Sample]) -> Vec<Cut> {
    let job =
        Job { cutter, holder: Some(holder), changes: &[], motions, samples, stock_mm: 0.3, depth_mm: 2.0 };
    cut(&job, &|_| ()).expect("a good job")
}

#[test]
fn a_holder_that_hits_a_step() {
    // A floor at z = 0 and, 8 mm beside the tool, the top of a step.
    let cutter = Cutter::cylinder(6.0, 20.0).unwrap();
    let holder = Holder::cylinder(30.0, 40.0).unwrap();
    let motions = through(&[upright(0.0, 0.0, 0.0), upright(10.0, 0.0, 0.0)]);
    let floor = sample([5.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    for (step, gouge) in [(20.5, 0.5), (19.0, -1.0)] {
        let top = sample([5.0, 8.0, step], [0.0, 0.0, 1.0]);
        let cuts = with_holder(&cutter, &holder, &motions, &[floor, top]);
        assert!(cuts[0].holder.is_none() && cuts[0].standoff_mm.abs() < 1e-12);
        if gouge > 0.0 {
            let touch = cuts[1].holder.unwrap();
            assert!((cuts[1].standoff_mm + gouge).abs() < 1e-12 && touch.block == 1);
            assert!((touch.removed_mm - (0.3 + gouge)).abs() < 1e-12, "stock and step: {touch:?}");
            assert_eq!(cuts[1].by.unwrap().body, Body::Holder);
        } else {
            assert!(cuts[1].holder.is_none() && cuts[1].by.is_none() && cuts[1].standoff_mm == 0.3);
        }
    }
}

/// A nose of 12 mm, a cone from there to 40 mm, and a cylinder: beside a step each section reaches as far as its meridian says, where the
/// cylinder around all of them would take everything above the nose.
#[test]
fn a_stepped_holder_clears_where_a_cylinder_around_it_would_not() {
    let section = |diameter_mm: f64, upper_diameter_mm: Option<f64>, length_mm: f64| HolderSpec {
        diameter_mm,
        length_mm,
        upper_diameter_mm,
    };
    let cutter = Cutter::cylinder(6.0, 20.0).unwrap();
    let sections = [section(12.0, None, 30.0), section(12.0, Some(40.0), 14.0), section(40.0, None, 20.0)];
    let stepped = Holder::new(&sections).unwrap();
    let around = Holder::cylinder(40.0, 64.0).unwrap();
    let motions = through(&[upright(0.0, 0.0, 0.0), upright(10.0, 0.0, 0.0)]);
    // The meridian's height above the tip at a distance from the axis.
    for (off, height) in [(5.0, 20.0), (8.0, 52.0), (13.0, 57.0), (19.0, 63.0)] {
        for (above, meets) in [(0.05, true), (-0.05, false)] {
            // The top of a step stands so much above the holder's lower side, with a hair of raw material on it.
            let top = sample([5.0, off, height + above], [0.0, 0.0, 1.0]);
            let job = Job {
                cutter: &cutter,
                holder: Some(&stepped),
                changes: &[],
                motions: &motions,
                samples: &[top],
                stock_mm: 0.01,
                depth_mm: 2.0,
            };
            let got = cut(&job, &|_| ()).unwrap()[0];
            assert_eq!(got.holder.is_some(), meets, "{off} {above}: {got:?}");
            if meets {
                assert!((got.standoff_mm + above).abs() < 1e-9, "{got:?}");
            }
            let other = cut(&Job { holder: Some(&around), ..job }, &|_| ()).unwrap()[0];
            assert_eq!(other.holder.is_some(), off > 6.0 || meets);
        }
    }
}

#[test]
fn a_rapid_takes_only_what_no_feed_took_before() {
    let cutter = ball(6.0);
    let ends = [upright(-5.0, 0.0, 0.0), upright(5.0, 0.0, 0.0)];
    let feed = Swept { from: ends[0], to: ends[1], rapid: false, block: 10 };
    let up = [upright(-5.0, 0.0, 0.1), upright(5.0, 0.0, 0.1)];
    let rapid = Swept { from: up[1], to: up[0], rapid: true, block: 20 };
    let s = [sample([0.2, 0.0, 0.0], [0.0, 0.0, 1.0])];
    // Before the feed it takes the stock down to 0.1.
    let first = run(&cutter, &[rapid, feed], &s, 0.4)[0];
    let touch = first.rapid.unwrap();
    assert!((touch.removed_mm - 0.3).abs() < 1e-12 && touch.block == 20 && touch.motion == 0);
    assert!(first.standoff_mm.abs() < 1e-12 && !first.by.unwrap().rapid, "the feed cut last: {first:?}");
    // After it, nothing.
    let second = run(&cutter, &[feed, rapid], &s, 0.4)[0];
    assert!(second.rapid.is_none() && second.by.unwrap().block == 10);
    // A retract from the end of the cut takes nothing either, nor one back along the same line.
    let away = Swept { from: ends[1], to: upright(5.0, 0.0, 50.0), rapid: true, block: 30 };
    let back = Swept { from: ends[1], to: ends[0], rapid: true, block: 40 };
    let at_end = [sample([5.0, 0.0, 0.0], [0.0, 0.0, 1.0]), sample([5.0, 0.4, 0.0], [0.0, 0.0, 1.0])];
    for c in run(&cutter, &[feed, away, back], &at_end, 0.4) {
        assert!(c.rapid.is_none_or(|t| t.removed_mm < 1e-12), "{c:?}");
    }
    // Into the part: a rapid and a gouge.
    let down = Swept { from: upright(0.0, 0.0, 9.0), to: upright(0.2, 0.0, -0.7), rapid: true, block: 50 };
    let deep = run(&cutter, &[feed, down], &s, 0.4)[0];
    assert!((deep.standoff_mm + 0.7).abs() < 1e-12 && deep.by.unwrap().rapid);
    assert!((deep.rapid.unwrap().removed_mm - 0.7).abs() < 1e-12);
}

/// A plate 1 mm thick: the tool on one side does not touch the other, until it comes through.
#[test]
fn the_far_side_of_a_thin_plate() {
    let below = |deep: f64| {
        through(&[
            crate::removal::common::pose([-4.0, 0.0, -1.0 + deep], [0.0, 0.0, -1.0]),
            crate::removal::common::pose([4.0, 0.0, -1.0 + deep], [0.0, 0.0, -1.0]),
        ])
    };
    let top = [
        sample([0.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
        Sample { check_only: true, ..sample([0.5, 0.0, 0.0], [0.0, 0.0, 1.0]) },
    ];
    for cutter in [ball(6.0), flat(6.0)] {
        for deep in [0.0, 0.4, 0.999] {
            for c in run(&cutter, &below(deep), &top, 0.5) {
                assert!(c.by.is_none(), "{deep}: {c:?}");
            }
        }
        for c in run(&cutter, &below(1.25), &top, 0.5) {
            assert!((c.standoff_mm + 0.25).abs() < 1e-12, "it comes through by 0.25: {c:?}");
        }
    }
}

/// At a knife edge the tool of one face touches the other face's edge and runs on behind it. What it takes
/// there is what comes through, not the way to its far end.
#[test]
fn a_knife_edge_is_not_a_gouge() {
    let (radius, through_mm, edge) = (3.0, 1e-4, 0.7f64);
    let cutter = ball(2.0 * radius);
    let n = osculate_geom::Vec3::new(edge.sin(), 0.0, -edge.cos());
    let at = |y: f64| {
        let tip = n * -through_mm + osculate_geom::Vec3::y() * y;
        crate::removal::common::pose(tip.into(), n.into())
    };
    let motions = through(&[at(-4.0), at(4.0)]);
    let c = run(&cutter, &motions, &[sample([0.0; 3], [0.0, 0.0, 1.0])], 0.5)[0];
    // The line leaves the ball's centre sideways by e = (R - t) sin(edge) and its exit above the sample is
    // sqrt(R^2 - e^2) - (R - t) cos(edge): about t / cos(edge).
    let centre = radius - through_mm;
    let want = (radius * radius - (centre * edge.sin()).powi(2)).sqrt() - centre * edge.cos();
    assert!((c.standoff_mm + want).abs() < 1e-11 && want < 2.0 * through_mm, "{c:?} want {want}");
}

#[test]
fn checked_faces_carry_no_stock() {
    let cutter = ball(6.0);
    let s = [Sample { check_only: true, ..sample([0.0; 3], [0.0, 0.0, 1.0]) }];
    let at = |z: f64| through(&[upright(-5.0, 0.0, z), upright(5.0, 0.0, z)]);
    let above = run(&cutter, &at(0.1), &s, 0.5)[0];
    assert!(above.standoff_mm == 0.0 && above.by.is_none());
    assert!((run(&cutter, &at(-0.1), &s, 0.5)[0].standoff_mm + 0.1).abs() < 1e-12);
}

#[test]
fn impossible_jobs_are_refused() {
    let cutter = ball(6.0);
    let good = through(&[upright(0.0, 0.0, 0.0), upright(1.0, 0.0, 0.0)]);
    let s = [sample([0.0; 3], [0.0, 0.0, 1.0])];
    let job = Job {
        cutter: &cutter,
        holder: None,
        changes: &[],
        motions: &good,
        samples: &s,
        stock_mm: 0.5,
        depth_mm: 1.0,
    };
    let of = |job: Job<'_>| cut(&job, &|_| ()).unwrap_err();
    assert!(matches!(of(Job { stock_mm: f64::NAN, ..job }), JobError::Stock { .. }));
    assert!(matches!(of(Job { depth_mm: 0.0, ..job }), JobError::Depth { .. }));
    // The last is finite, its square is not.
    for x in [f64::NAN, f64::INFINITY, -1e200] {
        let bad = [Swept { to: upright(x, 0.0, 0.0), ..good[0] }];
        assert!(matches!(of(Job { motions: &bad, ..job }), JobError::NotFinite { motion: 0, block: 1 }));
    }
    let over = [Swept { to: crate::removal::common::pose([0.0; 3], [0.0, 1e-4, -1.0]), ..good[0] }];
    assert!(matches!(of(Job { motions: &over, ..job }), JobError::Reversal { .. }));
    let lost = [sample([0.0, f64::INFINITY, 0.0], [0.0, 0.0, 1.0])];
    assert!(matches!(of(Job { samples: &lost, ..job }), JobError::SampleNotFinite { sample: 0, .. }));
    // Nothing to do is no error.
    assert!(cut(&Job { motions: &[], ..job }, &|_| ()).unwrap()[0].by.is_none());
    assert!(cut(&Job { samples: &[], ..job }, &|_| ()).unwrap().is_empty());
}
