//! The tip goes as fast as asked on the model of each control: machines x dialects x feed modes.
//!
//! The model here is its own: it takes the words of the text and the table of who reads F over what, and nothing of the reader.

use crate::common;

use osculate_geom::Vec3;
use osculate_postproc::readback::{ReadOptions, read};
use osculate_postproc::{
    Dialect, FeedMode, Machine, PostOptions, Posted, Setup, built_in_names, built_in_text, post,
};
use osculate_tools::cl::{ClPath, Motion};
use std::collections::BTreeMap;

const FEED_MM_MIN: f64 = 300.0;

/// Of the feed asked for.
const WITHIN: f64 = 0.02;

/// A radius at which 1 mm is two degrees.
const RADIUS_MM: f64 = 28.6479;

/// What a control reads F over.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Over {
    Linear,
    /// All axes, a rotary one at a radius, mm.
    All(f64),
    Rotary,
}

/// The built-in machines, and trunnions whose controls read F otherwise.
fn machines() -> Vec<(Machine, Over)> {
    let degree = 180.0 / std::f64::consts::PI;
    let mut all: Vec<(Machine, Over)> = built_in_names()
        .into_iter()
        .map(|name| {
            let linear = name.starts_with("linuxcnc") || name == "mill-turn-xyzc";
            (Machine::built_in(name).expect(name), if linear { Over::Linear } else { Over::All(degree) })
        })
        .collect();
    let plain = built_in_text("trunnion-ac").expect("built in");
    let reads = plain.lines().find(|l| l.starts_with("feed_reading")).expect("it says how F is read");
    for (kind, over) in [
        (format!("{{ kind = \"arc\", radius_mm = {RADIUS_MM} }}"), Over::All(RADIUS_MM)),
        ("{ kind = \"rotary_only\" }".to_owned(), Over::Rotary),
        ("{ kind = \"linear\" }".to_owned(), Over::Linear),
    ] {
        let text = plain.replace(reads, &format!("feed_reading = {kind}"));
        all.push((Machine::from_toml(&text).expect("a machine"), over));
    }
    all
}

/// A way that every machine can go: from joints.
fn way(machine: &Machine, setup: &Setup) -> ClPath {
    let at = |i: u32| {
        let t = f64::from(i) / 12.0;
        let mut q = [0.0; 5];
        for (k, place) in machine.rotary().iter().enumerate() {
            q[*place] = 0.4 + 0.15 * (1.0 + t + k as f64).sin();
        }
        for (k, place) in machine.linear().iter().enumerate() {
            q[*place] = 12.0 * (1.5 * t + 2.0 * k as f64).sin() - if k == 2 { 100.0 } else { 0.0 };
        }
        machine.forward(&q, setup)
    };
    common::path((0..40).map(at), FEED_MM_MIN)
}

/// Name and value of the position words and of F in a line.
fn words(line: &str) -> BTreeMap<String, f64> {
    let plain = line.replace("=DC(", "").replace([')', '+', '='], "");
    let word = |w: &str| {
        let at = w.find(|c: char| c.is_ascii_digit() || c == '-')?;
        Some((w[..at].to_owned(), w[at..].parse().ok()?))
    };
    plain.split_whitespace().filter_map(word).collect()
}

/// How long the control is in the feed moves, min.
fn minutes(text: &str, machine: &Machine, (tip, inverse, over): (bool, bool, Over)) -> f64 {
    let named = |places: &[usize]| -> Vec<String> {
        places.iter().map(|p| machine.joints()[*p].letter.clone()).collect()
    };
    let linear = if tip { ["X", "Y", "Z"].map(String::from).to_vec() } else { named(&machine.linear()) };
    let rotary = named(machine.rotary());
    let mut at: BTreeMap<String, f64> = BTreeMap::new();
    let (mut feeding, mut f, mut sum) = (false, 0.0, 0.0);
    for line in text.lines() {
        let has = |w: &str| line.split(' ').any(|x| x == w);
        if ["G53", "SUPA", "M91", "CYCLE832", "G4"].iter().any(|w| line.contains(w)) || line.contains(';') {
            continue;
        }
        let klartext = has("L");
        feeding = (feeding || has("G1") || klartext) && !has("G0") && !has("FMAX");
        let given = words(line);
        f = given.get("F").copied().unwrap_or(f);
        let mut moved = [0.0; 2];
        for (k, names) in [&linear, &rotary].into_iter().enumerate() {
            for name in names {
                let (Some(to), from) = (given.get(name), at.get(name)) else { continue };
                let mut d = to - from.unwrap_or(to);
                if k == 1 {
                    d -= 360.0 * (d / 360.0).round();
                }
                moved[k] += d * d;
                at.insert(name.clone(), *to);
            }
        }
        let [mm, deg] = moved.map(f64::sqrt);
        if !feeding || mm + deg == 0.0 {
            continue;
        }
        let length = match over {
            Over::Linear if mm > 0.0 => mm,
            Over::Rotary if deg == 0.0 => mm,
            Over::Linear | Over::Rotary => deg,
            Over::All(radius) => mm.hypot(radius * deg.to_radians()),
        };
        sum += if inverse { 1.0 / f } else { length / f };
    }
    sum
}

/// The range of the tip's feed that a warning speaks of, as shares of the one asked for.
fn warned(posted: &Posted) -> Option<(f64, f64)> {
    let text = posted.diagnostics.iter().find(|d| d.message.contains("the tip runs at"))?.message.clone();
    let range = text.split("the tip runs at ").nth(1)?.split(" times").next()?;
    let (a, b) = range.split_once(" to ")?;
    Some((a.parse().ok()?, b.parse().ok()?))
}

#[test]
fn the_tip_goes_as_fast_as_asked_or_the_post_says_by_how_much_it_does_not() {
    let setup = Setup::at(Vec3::new(5.0, -3.0, 40.0), 80.0);
    let (mut right, mut other) = (0, 0);
    for (machine, machine_over) in machines() {
        let path = way(&machine, &setup);
        let wanted: f64 =
            path.moves.windows(2).map(|w| (w[1].pose.tip - w[0].pose.tip).norm()).sum::<f64>() / FEED_MM_MIN;
        for dialect in Dialect::ALL {
            let reads = if dialect == Dialect::LinuxCnc { Over::Linear } else { machine_over };
            let radius = if let Over::All(radius) = reads { radius } else { 180.0 / std::f64::consts::PI };
            for (feed, over) in [
                (FeedMode::Tcp, Some(Over::Linear)),
                (FeedMode::Kf, Some(Over::Linear)),
                (FeedMode::Kv { fgref_mm: None }, Some(Over::All(radius))),
                (FeedMode::Kv { fgref_mm: Some(40.0) }, Some(Over::All(40.0))),
                (FeedMode::RotaryOnly, Some(Over::Rotary)),
                (FeedMode::None, None),
                (FeedMode::InverseTime, None),
            ] {
                let name = format!("{} {dialect} {feed:?}", machine.name());
                let Ok(posted) = post(&path, &machine, &setup, &PostOptions::new(dialect, feed)) else {
                    continue;
                };
                let (tip, inverse) = (feed == FeedMode::Tcp, feed == FeedMode::InverseTime);
                let slowed = posted.diagnostics.iter().any(|d| d.message.contains("slower than asked"));
                assert!(!slowed, "{name}: no joint is to limit: {:?}", posted.diagnostics);
                // Sinumerik reads over what FGROUP and FGREF say, all controls at the tip with its control on.
                let declares = dialect == Dialect::Sinumerik && over.is_some();
                let read_over = if tip { Over::Linear } else { over.filter(|_| declares).unwrap_or(reads) };
                let got = minutes(&posted.text, &machine, (tip, inverse, read_over));
                assert!(
                    (posted.summary.time_min / got - 1.0).abs() < 0.02,
                    "{name}: {} told, {got} true",
                    posted.summary.time_min
                );
                let back = read(&posted.text, dialect, &machine, &setup, &ReadOptions::default())
                    .unwrap_or_else(|e| panic!("{name}: {e}"));
                let read_min: f64 = back.blocks.iter().filter(|b| !b.rapid).map(|b| b.time_min).sum();
                assert!((read_min / got - 1.0).abs() < 1e-6, "{name}: {read_min} read, {got} true");
                let corrects = inverse || tip || over == Some(read_over) || machine.rotary().is_empty();
                if !corrects {
                    other += 1;
                    let (least, most) =
                        warned(&posted).unwrap_or_else(|| panic!("{name}: {:?}", posted.diagnostics));
                    let feeds = back.moves.iter().filter_map(|m| match m.motion {
                        Motion::Feed(f) => Some(f / FEED_MM_MIN),
                        Motion::Rapid => None,
                    });
                    let (lo, hi) = feeds.fold((f64::INFINITY, 0.0f64), |(a, b), f| (a.min(f), b.max(f)));
                    assert!(
                        (least / lo - 1.0).abs() < WITHIN && (most / hi - 1.0).abs() < WITHIN,
                        "{name}: {least} to {most} said, {lo} to {hi} true"
                    );
                    continue;
                }
                right += 1;
                assert_eq!(warned(&posted), None, "{name}");
                assert!((got / wanted - 1.0).abs() < WITHIN, "{name}: {got} min, {wanted} asked");
                for m in back.moves.iter().skip(1).filter(|m| m.time_min * FEED_MM_MIN > 0.05) {
                    if let Motion::Feed(f) = m.motion {
                        assert!(
                            (f / FEED_MM_MIN - 1.0).abs() < WITHIN,
                            "{name}, line {}: {f} mm/min",
                            m.line
                        );
                    }
                }
            }
        }
    }
    assert!(right >= 150 && other >= 60, "{right} right, {other} with a warning");
}

/// F over the linear axes is right for LinuxCNC on any machine, and over all axes it is not.
#[test]
fn linuxcnc_reads_linear_axes_on_any_machine() {
    let setup = Setup::at(Vec3::new(5.0, -3.0, 40.0), 80.0);
    let machine = Machine::built_in("trunnion-ac").unwrap();
    let path = way(&machine, &setup);
    let posted = |feed| post(&path, &machine, &setup, &PostOptions::new(Dialect::LinuxCnc, feed)).unwrap();
    assert_eq!(warned(&posted(FeedMode::Kf)), None);
    assert!(warned(&posted(FeedMode::Kv { fgref_mm: None })).is_some());
}

/// Where a machine has its own radius, K_V and FGREF are of it.
#[test]
fn the_radius_is_the_machines() {
    let setup = Setup::at(Vec3::new(5.0, -3.0, 40.0), 80.0);
    let (machine, _) = machines().into_iter().find(|m| m.1 == Over::All(RADIUS_MM)).unwrap();
    let path = way(&machine, &setup);
    let options = PostOptions::new(Dialect::Sinumerik, FeedMode::Kv { fgref_mm: None });
    let text = post(&path, &machine, &setup, &options).unwrap().text;
    assert!(text.contains("FGREF[A]=28.647900 FGREF[C]=28.647900"), "{text}");
}
