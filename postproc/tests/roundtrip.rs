//! CL path to NC text and back: the same way of the tool, the same durations, in every dialect and feed mode.

use crate::common;

use common::{angle, distance_mm, wave};
use osculate_geom::Vec3;
use osculate_postproc::readback::{ReadBack, ReadOptions, read};
use osculate_postproc::{Dialect, FeedMode, Machine, PostOptions, Posted, Setup, post};
use osculate_tools::cl::{ClPath, Motion};
use proptest::prelude::*;

fn there_and_back(
    path: &ClPath,
    machine: &Machine,
    setup: &Setup,
    dialect: Dialect,
    feed: FeedMode,
) -> (Posted, ReadBack) {
    let posted = post(path, machine, setup, &PostOptions::new(dialect, feed)).expect("a path within limits");
    let back = read(&posted.text, dialect, machine, setup, &ReadOptions::default()).expect("text of our own");
    assert!(back.diagnostics.is_empty(), "{:?}", back.diagnostics);
    let way = common::way_of(path, &back, rounding_mm(400.0));
    (posted, way)
}

/// What rounding to 4 decimals does to the tip at most, mm: half a count on three axes, and half a count of angle on
/// two rotary axes at the given distance from them.
fn rounding_mm(reach_mm: f64) -> f64 {
    0.5e-4 * 3f64.sqrt() + reach_mm * 2.0 * 0.5e-4f64.to_radians()
}

/// Half a count on each of two rotary axes.
fn rounding_rad() -> f64 {
    2.0 * 0.5e-4f64.to_radians()
}

/// Every CL point is met in order, and in between the tool stays near the CL line.
fn same_way(path: &ClPath, back: &ReadBack, reach_mm: f64, name: &str) {
    let tol = rounding_mm(reach_mm);
    let mut at = 0;
    for (i, m) in path.moves.iter().enumerate() {
        let hit = back.moves[at..].iter().position(|r| {
            (r.pose.tip - m.pose.tip).norm() <= tol && angle(&r.pose.axis, &m.pose.axis) <= rounding_rad()
        });
        at += hit.unwrap_or_else(|| panic!("{name}: CL point {i} is not met after {at}"));
    }
    // The post's own tolerance, the reader's chords, the rounding.
    let allowed = 0.002 + 1e-4 + tol;
    let worst = back.moves.iter().map(|r| distance_mm(path, &r.pose.tip)).fold(0.0, f64::max);
    assert!(worst <= allowed, "{name}: the tip strays {worst} mm");
}

/// Every feed block takes its tip length over the wanted feed.
fn same_time(path: &ClPath, back: &ReadBack, reach_mm: f64, name: &str) {
    let Motion::Feed(feed) = path.moves[1].motion else { panic!("the test paths feed") };
    for block in back.blocks.iter().filter(|b| !b.rapid) {
        let length = block.time_min * feed;
        // F keeps seven digits; the way read back starts and ends rounded, and is curved by less than 0.002 mm.
        let tol = 1e-6 * length + 2.0 * rounding_mm(reach_mm) + 0.002;
        assert!(
            (length - block.tip_length_mm).abs() <= tol,
            "{name}, line {}: {length} mm for {}",
            block.line,
            block.tip_length_mm
        );
    }
    let wanted: f64 = path.moves.windows(2).map(|w| (w[1].pose.tip - w[0].pose.tip).norm() / feed).sum();
    let got: f64 = back.blocks.iter().filter(|b| !b.rapid).map(|b| b.time_min).sum();
    // In sum the roundings of single blocks cancel: the lengths that F is made from are those of the CL line.
    assert!((got / wanted - 1.0).abs() < 1e-3, "{name}: {got} min instead of {wanted}");
}

const KV: FeedMode = FeedMode::Kv { fgref_mm: None };

#[test]
fn every_dialect_and_mode_that_the_control_reads_so() {
    let modes = [
        (Dialect::Sinumerik, FeedMode::Tcp),
        (Dialect::Sinumerik, FeedMode::Kf),
        (Dialect::Sinumerik, KV),
        (Dialect::Sinumerik, FeedMode::Kv { fgref_mm: Some(30.0) }),
        (Dialect::Sinumerik, FeedMode::RotaryOnly),
        (Dialect::Sinumerik, FeedMode::InverseTime),
        (Dialect::LinuxCnc, FeedMode::Tcp),
        (Dialect::LinuxCnc, FeedMode::Kf),
        (Dialect::LinuxCnc, FeedMode::InverseTime),
        (Dialect::Heidenhain, FeedMode::Tcp),
        (Dialect::Heidenhain, KV),
        (Dialect::Fanuc, FeedMode::Tcp),
        (Dialect::Fanuc, KV),
        (Dialect::Fanuc, FeedMode::InverseTime),
    ];
    let machines = [
        "trunnion-ac",
        "trunnion-bc",
        "linuxcnc-xyzac",
        "linuxcnc-xyzbc",
        "head-ca",
        "head-b-table-c",
        "nutated-b-table-c",
    ];
    let path = wave(40, 0.3);
    let setup = Setup::at(Vec3::new(12.0, -7.0, 30.0), 90.0);
    for (dialect, feed) in modes {
        for machine in machines {
            let name = format!("{dialect} {feed:?} {machine}");
            let linuxcnc = machine.starts_with("linuxcnc");
            // LinuxCNC reads F over X Y Z; the other built-in controls over all axes, a degree as a mm.
            let reads = dialect == Dialect::Sinumerik || linuxcnc == (feed == FeedMode::Kf);
            let machine = Machine::built_in(machine).unwrap();
            // Some machine files have no words that switch LinuxCNC's kinematics.
            let switches = machine.control().linuxcnc_tcp.is_some();
            if dialect == Dialect::LinuxCnc && feed == FeedMode::Tcp && !switches {
                let refused = post(&path, &machine, &setup, &PostOptions::new(dialect, feed)).unwrap_err();
                assert!(refused.to_string().contains("linuxcnc_tcp"), "{refused}");
                continue;
            }
            let (_, back) = there_and_back(&path, &machine, &setup, dialect, feed);
            // Tip to rotary axes: at most 60 mm on tables, 290 mm gauge plus pivot on heads.
            same_way(&path, &back, 300.0, &name);
            if reads || matches!(feed, FeedMode::Tcp | FeedMode::InverseTime) {
                same_time(&path, &back, 300.0, &name);
            }
        }
    }
}

/// The wrong metric for a control is not silent, and the time is as wrong as the metric says.
#[test]
fn a_metric_that_the_control_does_not_use() {
    let path = wave(40, 0.3);
    let setup = Setup::at(Vec3::new(12.0, -7.0, 30.0), 90.0);
    let machine = Machine::built_in("linuxcnc-xyzac").unwrap();
    let (posted, back) = there_and_back(&path, &machine, &setup, Dialect::LinuxCnc, KV);
    assert!(
        posted.diagnostics.iter().any(|d| d.message.contains("another time")),
        "{:?}",
        posted.diagnostics
    );
    let (right, fine) = there_and_back(&path, &machine, &setup, Dialect::LinuxCnc, FeedMode::Kf);
    assert!(right.diagnostics.is_empty(), "{:?}", right.diagnostics);
    assert!(back.time_min() < 0.8 * fine.time_min(), "{} {}", back.time_min(), fine.time_min());
    // The summary says what the control will do, not what was asked for.
    assert!((posted.summary.time_min / back.time_min() - 1.0).abs() < 1e-3);
    assert!((right.summary.time_min / fine.time_min() - 1.0).abs() < 1e-3);
}

/// Five turns on a head with 740 deg: the text contains the rewinds, and every CL point is still met.
#[test]
fn rewinds_come_back() {
    let machine = Machine::built_in("head-ca").unwrap();
    let setup = Setup::at(Vec3::zeros(), 80.0);
    let around = |i: u32| {
        let w = f64::from(i) * 5f64.to_radians();
        common::pose([10.0, 0.01 * f64::from(i), 5.0], [0.4 * w.cos(), 0.4 * w.sin(), 1.0])
    };
    let path = common::path((0..=360).map(around), 500.0);
    for (dialect, feed) in [(Dialect::Sinumerik, FeedMode::Tcp), (Dialect::Fanuc, FeedMode::InverseTime)] {
        let (posted, back) = there_and_back(&path, &machine, &setup, dialect, feed);
        assert_eq!(posted.summary.rewinds, 2);
        let tol = rounding_mm(300.0);
        let met = |m: &osculate_tools::cl::ClMove| {
            back.moves.iter().any(|r| (r.pose.tip - m.pose.tip).norm() <= tol)
        };
        assert!(path.moves.iter().all(met));
        // Away from the line only in rapid moves and on the way back to it.
        let away = back.moves.iter().filter(|r| distance_mm(&path, &r.pose.tip) > 0.01);
        assert!(away.clone().count() > 4 && away.clone().all(|r| r.motion == Motion::Rapid));
        let far = away.map(|r| distance_mm(&path, &r.pose.tip)).fold(0.0, f64::max);
        assert!((far - 50.0).abs() < 1.0, "{far}");
    }
}

#[test]
fn the_same_text_every_time() {
    let path = wave(60, 1.0);
    let machine = Machine::built_in("trunnion-ac").unwrap();
    let setup = Setup::default();
    let options = PostOptions::new(Dialect::Sinumerik, FeedMode::InverseTime);
    let one = post(&path, &machine, &setup, &options).unwrap();
    assert_eq!(one, post(&path, &machine, &setup, &options).unwrap());
    for line in one.text.lines().filter(|l| l.starts_with('N')) {
        for bad in ["-0.0000 ", "NaN", "inf", "F0 ", "e-", "E-"] {
            assert!(!format!("{line} ").contains(bad), "{line} has {bad}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Random setups and phases, both families of controls, with and without tool-centre-point control.
    #[test]
    fn random_setups(
        phase in 0.0..6.0f64,
        zero in prop::array::uniform3(-40.0..40.0f64),
        turn in -3.0..3.0f64,
        gauge in 20.0..150.0f64,
        which in 0..4usize,
    ) {
        let path = wave(16, phase);
        let rotation = nalgebra::UnitQuaternion::from_axis_angle(&Vec3::z_axis(), turn);
        let part_zero = nalgebra::Isometry3::from_parts(nalgebra::Translation3::from(Vec3::from(zero)), rotation);
        let setup = Setup { part_zero, gauge_length_mm: gauge };
        let (dialect, feed, machine) = [
            (Dialect::Sinumerik, FeedMode::Tcp, "head-b-table-c"),
            (Dialect::Sinumerik, FeedMode::InverseTime, "trunnion-bc"),
            (Dialect::LinuxCnc, FeedMode::Tcp, "linuxcnc-xyzac"),
            (Dialect::LinuxCnc, FeedMode::InverseTime, "linuxcnc-xyzbc"),
        ][which];
        let machine = Machine::built_in(machine).unwrap();
        let (_, back) = there_and_back(&path, &machine, &setup, dialect, feed);
        same_way(&path, &back, 400.0, machine.name());
        same_time(&path, &back, 400.0, machine.name());
    }
}
