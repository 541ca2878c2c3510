//! What a program takes from the machine's description beside its kinematics: where Z is out of the way, and which axis turns without end.

use crate::common;

use common::{path, pose};
use osculate_postproc::readback::{ReadOptions, read};
use osculate_postproc::{
    Dialect, FeedMode, Machine, PostOptions, Section, Setup, built_in_text, post, post_sections,
};
use osculate_tools::cl::ClPath;

/// A trunnion whose Z has these lines beside its travel of -120 to 120 mm.
fn trunnion(z: &str) -> Machine {
    let plain = built_in_text("linuxcnc-xyzac").expect("built in");
    let travel = "min_mm = -300\nmax_mm = 500";
    assert!(plain.contains(travel));
    Machine::from_toml(&plain.replace(travel, &format!("min_mm = -120\n{z}"))).expect("a machine")
}

fn way() -> ClPath {
    path((0..=10).map(|k| pose([f64::from(k), 0.0, 5.0], [0.0, 0.1, 1.0])), 300.0)
}

/// Programs retract to the end of the travel, wherever the control has its zero.
#[test]
fn retracts_follow_the_machine() {
    let rows = [
        // Nothing is said: zero is the top.
        ("max_mm = 120", "0", 120.0),
        // Zero in the middle of the travel, as LinuxCNC's own trunnion has it.
        ("max_mm = 120\nmachine_zero_mm = 0", "120", 120.0),
        ("max_mm = 120\nmachine_zero_mm = -120", "240", 120.0),
        ("max_mm = 120\nmachine_zero_mm = 0\nretract_mm = 95.5", "95.5", 95.5),
        ("max_mm = 120\nretract_mm = -20", "-20", 100.0),
    ];
    for (z, word, end_mm) in rows {
        let machine = trunnion(z);
        let at = machine.joint_named("Z").unwrap();
        for dialect in Dialect::ALL {
            let options = PostOptions::new(dialect, FeedMode::InverseTime);
            let options = match dialect {
                Dialect::Heidenhain => PostOptions { feed: FeedMode::Kf, ..options },
                _ => options,
            };
            let posted = post(&way(), &machine, &Setup::default(), &options).unwrap();
            let counts: f64 = word.parse().unwrap();
            let line = match dialect {
                Dialect::Sinumerik => format!("G0 SUPA Z{word} D0"),
                Dialect::Heidenhain => format!("L Z{counts:+.4} R0 FMAX M91"),
                Dialect::Fanuc | Dialect::LinuxCnc => format!("G53 G0 Z{word}"),
            };
            let retracts = posted.text.lines().filter(|l| l.ends_with(&line)).count();
            assert_eq!(retracts, 2, "{line}\n{}", posted.text);
            let back =
                read(&posted.text, dialect, &machine, &Setup::default(), &ReadOptions::default()).unwrap();
            let last = back.blocks.last().unwrap();
            assert!(last.own_frame && (last.to[at] - end_mm).abs() < 1e-9, "{z} {dialect}: {last:?}");
            // It goes up from the part, never down.
            assert!(last.to[at] > last.from[at]);
        }
    }
    let e = Machine::from_toml(
        &built_in_text("3-axis").unwrap().replace("max_mm = 500", "max_mm = 500\nretract_mm = nan"),
    );
    assert!(e.unwrap_err().to_string().contains("retract_mm"));
}

/// Without an end of the travel nothing is guessed.
#[test]
fn an_unknown_place_is_left_out_and_said() {
    let machine = trunnion("machine_zero_mm = 0");
    let options = PostOptions::new(Dialect::LinuxCnc, FeedMode::Kf);
    let posted = post(&way(), &machine, &Setup::default(), &options).unwrap();
    assert!(!posted.text.contains("G53"), "{}", posted.text);
    assert!(
        posted.diagnostics.iter().any(|d| d.message.contains("does not retract Z")),
        "{:?}",
        posted.diagnostics
    );
}

/// The head names what turns without end; where turns are counted it is told how far, and the next tool begins near zero.
#[test]
fn endless_axes_are_named_and_unwound_between_tools() {
    let machine = Machine::built_in("trunnion-ac").unwrap();
    let round = |k: u32| {
        let a = f64::from(k) * 0.3;
        pose([20.0 * a.cos(), 20.0 * a.sin(), 5.0], [0.3 * a.cos(), 0.3 * a.sin(), 1.0])
    };
    let ways = [path((0..=200).map(round), 900.0), path((0..=5).map(round), 900.0)];
    let posted = |dialect: Dialect| {
        let of = |k: usize| Section {
            name: format!("round {k}"),
            path: &ways[k],
            gauge_length_mm: 80.0,
            options: PostOptions { tool_number: k as u32 + 1, ..PostOptions::new(dialect, FeedMode::Tcp) },
        };
        post_sections(&[of(0), of(1)], &machine, &Setup::at(osculate_geom::Vec3::zeros(), 80.0)).unwrap()
    };
    for dialect in Dialect::ALL {
        let text = posted(dialect).text;
        assert!(text.lines().take(20).any(|l| l.contains("C turns without end: ")), "{text}");
        assert!(!text.contains("A turns without end"), "{text}");
    }
    let linuxcnc = posted(Dialect::LinuxCnc);
    let turns: Vec<f64> = linuxcnc
        .text
        .lines()
        .filter_map(|l| l.split(' ').find_map(|w| w.strip_prefix('C')?.parse().ok()))
        .collect();
    let most = turns.iter().fold(0.0f64, |m, c| m.max(c.abs()));
    assert!(most > 3000.0, "{most}");
    let said = linuxcnc
        .diagnostics
        .iter()
        .any(|d| d.message.contains("counts on to") && d.message.contains("axis C"));
    assert!(said, "{:?}", linuxcnc.diagnostics);
    // Z is up and no tool turns when it goes back.
    let lines: Vec<&str> = linuxcnc.text.lines().collect();
    let call = lines.iter().position(|l| *l == "T2 M6").unwrap();
    let approach = lines[call..].iter().find(|l| l.contains('C') && l.contains("G0")).unwrap();
    let back: f64 = approach.split(' ').find_map(|w| w.strip_prefix('C')?.parse().ok()).unwrap();
    assert!(back.abs() <= 180.0, "{approach}");
    assert!(lines[..call].iter().rev().take(3).any(|l| *l == "G53 G0 Z0"), "{}", linuxcnc.text);
}

/// What a file leaves open is told; one that says all leaves nothing.
#[test]
fn gaps_of_machine_files() {
    let keys = |machine: &Machine| machine.gaps().into_iter().map(|g| g.key).collect::<Vec<_>>();
    let open = keys(&Machine::built_in("trunnion-ac").unwrap());
    for key in ["min_deg and max_deg of C", "machine_zero_mm of Z", "home_mm of X"] {
        assert!(open.iter().any(|k| k == key), "{key}: {open:?}");
    }
    assert!(!open.iter().any(|k| k.contains("jerk") || k.contains("retract_mm")), "{open:?}");
    assert!(keys(&trunnion("machine_zero_mm = 0")).contains(&"retract_mm of Z".to_owned()));
    let plain = built_in_text("3-axis").unwrap();
    let said = plain.replace("max_mm = ", "machine_zero_mm = 0\nhome_mm = 0\nmax_mm = ");
    assert_eq!(keys(&Machine::from_toml(&said).unwrap()), ["[[body]]"]);
    let body = |name: &str, carrier: &str| {
        format!(
            "\n[[body]]\nkind = \"box\"\nname = \"{name}\"\ncarried_by = \"{carrier}\"\nmin_mm = [-9, -9, 0]\nmax_mm = [9, 9, 9]\n"
        )
    };
    let head = said + &body("head", "Z");
    assert_eq!(keys(&Machine::from_toml(&head).unwrap()), ["[[body]] of the table"]);
    let all = head + &body("table", "bed");
    assert_eq!(keys(&Machine::from_toml(&all).unwrap()), Vec::<String>::new());
}

/// The first pose is reached across the tool first and along it last, wherever the table has turned the part: X Y Z are the tip's.
#[test]
fn programs_of_the_tip_come_along_the_tool() {
    let machine = Machine::built_in("trunnion-ac").unwrap();
    for (axis, last) in
        [([0.0, 0.5, 1.0], 'Z'), ([0.2, -1.0, 0.4], 'Y'), ([0.0, 1.0, -0.14], 'Y'), ([1.0, 0.3, -0.2], 'X')]
    {
        let way = path((0..=5).map(|k| pose([1.0 + f64::from(k), 2.0, 3.0], axis)), 900.0);
        for dialect in Dialect::ALL {
            let options = PostOptions::new(dialect, FeedMode::Tcp);
            let text =
                post(&way, &machine, &Setup::at(osculate_geom::Vec3::zeros(), 80.0), &options).unwrap().text;
            let words = |l: &str| {
                let block = if dialect == Dialect::Heidenhain { l.split_once(' ').unwrap().1 } else { l };
                let is = |w: &&str| w.starts_with(['X', 'Y', 'Z']) && w[1..].parse::<f64>().is_ok();
                block.split(' ').filter(is).map(|w| w.chars().next().unwrap()).collect::<String>()
            };
            // Behind the turn of the rotary axes: two blocks, and the second names one axis.
            let turned = text.lines().position(|l| l.contains(" A") || l.starts_with("A")).unwrap();
            let blocks: Vec<String> =
                text.lines().skip(turned + 1).map(words).filter(|w| !w.is_empty()).take(2).collect();
            let across: String = "XYZ".chars().filter(|c| *c != last).collect();
            assert_eq!(blocks, [across, last.to_string()], "{dialect:?} {axis:?}\n{text}");
        }
    }
}
