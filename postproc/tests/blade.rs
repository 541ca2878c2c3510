//! Real paths there and back: CL, NC, CL for every dialect, machine and feed mode that go together.

use crate::common;

use common::{angle, blade};
use osculate_geom::Vec3;
use osculate_postproc::nc::timing::time;
use osculate_postproc::readback::{ReadBack, ReadOptions, read};
use osculate_postproc::{Dialect, FeedMode, Machine, PostOptions, Setup, built_in_names, post};
use osculate_tools::cl::ClPath;

/// Half a count of 1e-4 on three axes, and on two rotary ones at the given distance of the tip from their axes.
fn rounding_mm(reach_mm: f64) -> f64 {
    0.5e-4 * 3f64.sqrt() + reach_mm * 2.0 * 0.5e-4f64.to_radians()
}

/// Every CL point is met within the output resolution, in order.
fn meets(path: &ClPath, back: &ReadBack, reach_mm: f64, name: &str) {
    let mut at = 0;
    for (i, m) in path.moves.iter().enumerate() {
        let hit = back.moves[at..].iter().position(|r| {
            (r.pose.tip - m.pose.tip).norm() <= rounding_mm(reach_mm)
                && angle(&r.pose.axis, &m.pose.axis) <= 2.0 * 0.5e-4f64.to_radians()
        });
        at += hit.unwrap_or_else(|| panic!("{name}: CL point {i} is not met after move {at}"));
    }
}

#[test]
fn blade_paths_come_back() {
    let setup = Setup::at(Vec3::new(5.0, -3.0, 40.0), 80.0);
    let families: Vec<_> = (0..3).map(blade::for_rotary_axes).collect();
    let mut done = 0;
    for name in built_in_names() {
        let machine = Machine::built_in(name).unwrap();
        let paths = &families[machine.rotary().len()];
        for dialect in Dialect::ALL {
            for (_, feed) in blade::feed_modes() {
                for (path_name, path) in paths {
                    let what = format!("{name}, {dialect}, {feed:?}, {path_name}");
                    let posted = match post(path, &machine, &setup, &PostOptions::new(dialect, feed)) {
                        Ok(posted) => posted,
                        // What a control does not have is refused with a word on it, never left out.
                        Err(e) => {
                            let said = e.to_string();
                            let tcp = feed == FeedMode::Tcp && dialect == Dialect::LinuxCnc;
                            let inverse = feed == FeedMode::InverseTime && dialect == Dialect::Heidenhain;
                            assert!(tcp && said.contains("linuxcnc_tcp") || inverse, "{what}: {said}");
                            continue;
                        }
                    };
                    let timed = ReadOptions { timed: true, ..ReadOptions::default() };
                    let back = read(&posted.text, dialect, &machine, &setup, &timed);
                    let back = back.unwrap_or_else(|e| panic!("{what}: {e}"));
                    assert!(back.diagnostics.is_empty(), "{what}: {:?}", back.diagnostics);
                    // The moves' times are those of the clock that reads the text alone.
                    let clock = time(&posted.text, dialect, &machine, &setup, true).unwrap().time;
                    let own = back.control.as_ref().unwrap();
                    let whole = own.time_min();
                    let same = |a: f64, b: f64| (a - b).abs() <= 1e-9 * whole;
                    assert!(same(own.cutting_min, clock.cutting_min), "{what}: {own:?} {clock:?}");
                    assert!(
                        same(own.rapid_min, clock.rapid_min) && own.dwell_min == clock.dwell_min,
                        "{what}"
                    );
                    let sum: f64 = own.of_moves_min.iter().sum();
                    assert!(same(sum + own.dwell_min, whole) && own.of_moves_min.len() == back.moves.len());
                    assert!(own.of_moves_min.iter().all(|t| *t >= 0.0), "{what}");
                    // The blade is 75 mm high; heads add gauge length and pivot.
                    meets(path, &back, 400.0, &what);
                    done += 1;
                }
            }
        }
    }
    // 9 machines, 4 dialects, 9 modes, 3 paths, without what is refused.
    assert!(done > 900, "{done} programs");
}
