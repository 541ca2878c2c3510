//! The posture of greatest productivity on a measured blade, against scans.

use crate::limits::{CAPS, limits};
use osculate_geom::line::SurfaceLine;
use osculate_geom::uv;
use osculate_productivity::optimum::{self, Limits, Posture, Range, measure};
use osculate_productivity::rate::Caps;
use osculate_surfaces::{Part, read};
use osculate_tools::contact::ContactLine;
use osculate_tools::strip::{self, StripError};
use osculate_tools::{Contact, Cutter, CutterSpec, FeedLine, Lean, Line, Pose};
use std::f64::consts::{PI, TAU};

/// Face, cutter and limits of a blade through measured points: waves end strips, so that the best posture lies in a basin some
/// degrees wide, or at a brink.
fn blade() -> (Part, Cutter, Limits) {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/eee-hpt-rotor2/blade.igs");
    let spec = CutterSpec::Toroidal { diameter_mm: 3.0, corner_radius_mm: 0.5, length_mm: 40.0 };
    let limits = Limits {
        lead: Range { least_rad: 3f64.to_radians(), most_rad: 40f64.to_radians() },
        tilt: Range { least_rad: -0.4, most_rad: 0.4 },
        caps: Caps { spindle_rpm: 12_000.0, feed_mm_min: 3000.0, ..CAPS },
        ..limits()
    };
    (read(&std::fs::read(file).unwrap()).unwrap(), Cutter::try_from(spec).unwrap(), limits)
}

/// Directions of 15 degrees and tilts at the least lead, where the best of the whole scan lies at these places.
#[test]
fn never_beaten_by_a_scan_over_waves() {
    let (part, cutter, limits) = blade();
    let face = part.face("F1").unwrap();
    for at in [
        uv(28.243_138_334_146_7, 1.105_641_597_182_416),
        uv(31.244_301_423_901_08, 2.159_850_096_579_854),
        uv(30.179_124_004_958_506, 1.403_018_463_916_972_5),
        uv(29.832_341_904_196_404, 1.250_746_594_123_868_7),
        // The strip jumps within the difference between a planar tooth mark and that on the waves.
        uv(33.044_999_277_754_79, 0.083_223_996_218_372_06),
        // Another passage of the tool takes over within the strip, at a place whose lines a few nodes can follow.
        uv(48.422_427_943_944_28, 0.388_251_986_282_357_4),
        uv(43.561_485_650_222_47, 2.568_386_155_751_232_6),
        // ... so late that the place at which a coarse walk ends is not reached by it, in a narrow dip.
        uv(32.639_135_826_875_87, 1.088_668_694_930_099_9),
    ] {
        let mut scanned = 0.0f64;
        for k in 0..72 {
            let lean = Lean { lead_rad: limits.lead.least_rad, tilt_rad: 0.4 * f64::from(k / 24 - 1) };
            let posture = Posture { direction_rad: TAU * f64::from(k % 24) / 24.0, lean };
            let found = measure(face, at, &cutter, posture, &limits);
            scanned = scanned.max(found.map_or(0.0, |m| m.rate.area_mm2_min));
        }
        let best = optimum::at(face, at, std::slice::from_ref(&cutter), &limits).unwrap();
        assert!(best.rate.area_mm2_min >= 0.995 * scanned, "{best:?} against {scanned}");
    }
}

/// Where two passages of the tool cross within a strip their edge may stand above the tolerance between two steps of the walk: against
/// heights by the lowest of many instants at many places.
#[test]
fn strips_end_where_passages_cross() {
    let (part, cutter, limits) = blade();
    let face = part.face("F1").unwrap();
    let mut jumps = 0;
    for (at, direction_rad, tilt_rad) in [
        (uv(43.950_223_984_369_18, 2.291_807_752_933_725), 6.021_4, -0.4),
        (uv(48.422_427_943_944_28, 0.388_251_986_282_357_4), 2.356_194, 0.0),
    ] {
        let lean = Lean { lead_rad: limits.lead.least_rad, tilt_rad };
        let contact = Contact::new(face, at, &cutter, FeedLine::Angle(direction_rad), lean).unwrap();
        let (feed, _) = contact.line().unwrap();
        let frame = |line: &ContactLine<'_>, t: f64| line.frame(t).unwrap().0;
        let poses: Vec<Pose> =
            (-600..=1200).map(|k| lean.pose(&cutter, &frame(&feed, 0.0015 * f64::from(k)), 0.0)).collect();
        let across = |sign: f64| -> Vec<(f64, f64)> {
            let turned = FeedLine::Angle(direction_rad + sign * 0.5 * PI);
            let across = Contact::new(face, at, &cutter, turned, Lean::default()).unwrap();
            let (cross, _) = across.line().unwrap();
            let height = |q: f64| {
                let here = frame(&cross, q);
                let line = Line { origin: here.point, direction: here.normal };
                let entries = poses.iter().filter_map(|p| cutter.entry(p, &line));
                (q, entries.map(|e| e.at_mm).fold(f64::INFINITY, f64::min))
            };
            (1..120).map(|k| height(0.01 * f64::from(k))).collect()
        };
        let sides = [across(1.0), across(-1.0)];
        for k in 0..40 {
            let h = 0.006 + 1e-4 * f64::from(k);
            // Inside up to the first place that stands higher: to the distance between two.
            let end =
                |side: &[(f64, f64)], h: f64| side.iter().find(|p| p.1 > h).map_or(f64::INFINITY, |p| p.0);
            let width = |h: f64| sides.iter().map(|s| end(s, h)).sum::<f64>();
            let got = strip::exact(&contact, h).unwrap().width_mm;
            // An edge between two places may stand a little higher than both.
            assert!(
                got < width(h) + 1e-9 && got > width(0.97 * h) - 0.02 - 1e-9,
                "{at:?} {h}: {got}, {}",
                width(h)
            );
            jumps += i32::from(width(h) - width(h - 1e-4) > 0.1);
        }
    }
    assert!(jumps >= 2, "{jumps}");
}

/// A tool lifted by more than the tolerance leaves no strip, though at another instant it comes over the contact.
#[test]
fn lifted_by_more_than_the_tolerance_there_is_no_strip() {
    let (part, cutter, limits) = blade();
    let face = part.face("F1").unwrap();
    let at = uv(30.314_411_821_918_142, 1.067_870_231_013_088_8);
    let lean = Lean { lead_rad: 0.159_988_514_766_146_9, tilt_rad: 0.4 };
    let posture = Posture { direction_rad: 5.759_586_531_581_287, lean };
    let refused = measure(face, at, &cutter, posture, &limits);
    assert!(matches!(refused, Err(StripError::AboveTolerance { .. })), "{refused:?}");
    let best = optimum::at(face, at, std::slice::from_ref(&cutter), &limits).unwrap();
    assert!(best.lift_mm <= best.share.across_mm(), "{best:?}");
}
