//! The time model against programs timed on a real controller (LinuxCNC 2.9, see `data/timing/NOTICE`).

use osculate_postproc::nc::timing::time;
use osculate_postproc::readback::{ReadOptions, read};
use osculate_postproc::{Dialect, Machine, Setup};

/// Limits of one kind of axis.
#[derive(Clone, Copy)]
struct Axis {
    velocity: f64,
    acceleration: f64,
}

fn machine(linear: Axis, rotary: Axis, cap_mm_s: f64) -> Machine {
    let mut text = format!(
        "format = 1\nname = \"timed\"\n[control]\nfeed_reading = {{ kind = \"linear\" }}\n\
         max_path_velocity_mm_s = {cap_mm_s}\n"
    );
    for (letter, direction) in [("C", "[0, 0, 1]"), ("A", "[1, 0, 0]")] {
        text.push_str(&format!(
            "[[joint]]\nkind = \"rotary\"\nletter = \"{letter}\"\nside = \"table\"\ndirection = {direction}\n\
             max_velocity_deg_s = {:?}\nmax_acceleration_deg_s2 = {:?}\n",
            rotary.velocity, rotary.acceleration
        ));
    }
    for (letter, direction) in [("X", "[1, 0, 0]"), ("Y", "[0, 1, 0]"), ("Z", "[0, 0, 1]")] {
        text.push_str(&format!(
            "[[joint]]\nkind = \"linear\"\nletter = \"{letter}\"\nside = \"head\"\ndirection = {direction}\n\
             max_velocity_mm_s = {:?}\nmax_acceleration_mm_s2 = {:?}\n",
            linear.velocity, linear.acceleration
        ));
    }
    Machine::from_toml(&text).expect("the text above is a machine")
}

fn fast() -> Machine {
    let linear = Axis { velocity: 500.0, acceleration: 5000.0 };
    machine(linear, Axis { velocity: 600.0, acceleration: 20_000.0 }, 866.0)
}

fn slow() -> Machine {
    let linear = Axis { velocity: 20.0, acceleration: 300.0 };
    machine(linear, Axis { velocity: 30.0, acceleration: 300.0 }, 35.0)
}

fn mid() -> Machine {
    let linear = Axis { velocity: 100.0, acceleration: 1000.0 };
    machine(linear, Axis { velocity: 90.0, acceleration: 500.0 }, 200.0)
}

fn cutting_s(machine: &Machine, text: &str) -> f64 {
    let timed = time(text, Dialect::LinuxCnc, machine, &Setup::default(), true);
    let cutting_min = timed.expect("the programs are LinuxCNC's").time.cutting_min;
    // Read back, the same time is shared out among its moves: those that the control joins have theirs too.
    let options = ReadOptions { timed: true, ..ReadOptions::default() };
    let back = read(text, Dialect::LinuxCnc, machine, &Setup::default(), &options).expect("they are");
    let own = back.control.expect("it is asked for");
    assert!((own.cutting_min / cutting_min - 1.0).abs() < 1e-9, "{} {cutting_min}", own.cutting_min);
    let rests = back.moves.iter().zip(&own.of_moves_min).filter(|(m, t)| m.time_min > 0.0 && **t == 0.0);
    assert_eq!(rests.count(), 0);
    60.0 * cutting_min
}

/// Within 1 % of what the controller took; 5 % is asked for.
fn check(machine: &Machine, text: &str, name: &str, measured_s: f64) {
    let ours = cutting_s(machine, text);
    assert!(
        (ours / measured_s - 1.0).abs() < 0.01,
        "{name}: {ours:.3} s, the controller took {measured_s} s"
    );
}

macro_rules! program {
    ($name:literal) => {
        ($name, include_str!(concat!("data/timing/", $name)))
    };
}

#[test]
fn ellipse_in_every_feed_mode() {
    // Seconds at F0 = 60 and at F0 = 100; the files carry 60. Inverse time scales like F.
    let measured = [
        (program!("ell_none.ngc"), 58.25, 34.85),
        (program!("ell_KF.ngc"), 45.90, 27.47),
        (program!("ell_G93.ngc"), 45.90, 27.47),
        (program!("ell_KV.ngc"), 10.13, 6.82),
        (program!("ell_dpm.ngc"), 10.53, 7.05),
    ];
    let machine = fast();
    for ((name, text), at_60, at_100) in measured {
        check(&machine, text, name, at_60);
        let faster = text.lines().map(|line| match line.split_once(" F") {
            Some((words, f)) => format!("{words} F{:.4}\n", f.trim().parse::<f64>().unwrap() * 100.0 / 60.0),
            None => format!("{line}\n"),
        });
        check(&machine, &faster.collect::<String>(), name, at_100);
    }
}

#[test]
fn sculpted_waves() {
    let machine = slow();
    for ((name, text), measured) in
        [(program!("sculpt_3axis_F1200.ngc"), 6.92), (program!("sculpt_5axis_g94_F600.ngc"), 19.72)]
    {
        check(&machine, text, name, measured);
    }
}

/// Arcs in all planes, corners, exact path, rapid moves between, rotary axes alone, random walks, inches: counted
/// steps of 1 ms in which the controller fed.
#[test]
fn what_else_a_program_may_hold() {
    let programs = [
        (program!("arc_pocket_F3000.ngc"), 8.341),
        (program!("arc_corners.ngc"), 2.737),
        (program!("helix_planes.ngc"), 9.043),
        (program!("zig_G64.ngc"), 3.520),
        (program!("zig_G61.ngc"), 4.728),
        (program!("zig_P01.ngc"), 4.546),
        (program!("five_long.ngc"), 19.017),
        (program!("mixed_ax.ngc"), 2.788),
        (program!("rotary.ngc"), 9.559),
        (program!("walk1.ngc"), 12.647),
        (program!("rapid_mix.ngc"), 2.936),
        (program!("inch.ngc"), 12.797),
        (program!("wave_P005Q002.ngc"), 3.582),
        (program!("many_arcs.ngc"), 3.994),
    ];
    let machine = mid();
    for ((name, text), measured) in programs {
        let ours = cutting_s(&machine, text);
        // 2 %: corners between arcs and lines are the least well modelled.
        assert!(
            (ours / measured - 1.0).abs() < 0.02,
            "{name}: {ours:.3} s, the controller took {measured} s"
        );
    }
}
