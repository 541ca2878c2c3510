//! CL, NC, CL on a real blade, for every machine, dialect and feed mode: `cargo xtask interop roundtrip`.
//!
//! The blade is NASA Rotor 37. For each row three paths are posted and read back strictly; every CL point must be met, in
//! order, within half a count of the output (1e-4 mm, 1e-4 deg) on every axis. Shown are the worst distances and how far
//! the time of the feed blocks is from L_CL / F0 by the control's own reading of F. Modes that the control reads
//! otherwise, that do not correct, that bound the rise of F or that are as fast as the joints allow have another time,
//! and so have paths on which the post reports joints at their greatest speed; it is shown in brackets. What a control does not have is refused with a word on it.
#![allow(clippy::print_stdout, clippy::expect_used, dead_code)]

#[path = "../tests/common/blade.rs"]
mod blade;

use osculate_geom::Vec3;
use osculate_postproc::readback::{ReadBack, ReadOptions, read};
use osculate_postproc::{Dialect, FeedMode, Machine, Orientation, PostOptions, Setup, built_in_names, post};
use osculate_tools::cl::{ClPath, Motion};
use std::process::ExitCode;

/// Half a count, mm and deg.
const HALF: f64 = 0.5e-4;

/// The farthest that a tip of the blade is from a rotary axis, gauge length and pivot included, mm.
const REACH_MM: f64 = 400.0;

/// Share of the paths' feed: slow enough that no joint is at its greatest speed around the edges.
const SLOWER: f64 = 0.05;

/// The worst of some paths.
#[derive(Default)]
struct Worst {
    tip_mm: f64,
    axis_rad: f64,
    time: f64,
    points: usize,
    missed: usize,
    /// Joints at their greatest speed made blocks longer than asked, as the post has said.
    slowed: bool,
}

fn angle(a: &Vec3, b: &Vec3) -> f64 {
    a.cross(b).norm().atan2(a.dot(b))
}

impl Worst {
    fn add(&mut self, path: &ClPath, back: &ReadBack) {
        let tip_mm = HALF * 3f64.sqrt() + REACH_MM * 2.0 * HALF.to_radians();
        let axis_rad = 2.0 * HALF.to_radians();
        let mut at = 0;
        for m in &path.moves {
            let off = |r: &osculate_postproc::readback::ReadMove| {
                ((r.pose.tip - m.pose.tip).norm(), angle(&r.pose.axis, &m.pose.axis))
            };
            let hit = back.moves[at..].iter().position(|r| {
                let (tip, axis) = off(r);
                tip <= tip_mm && axis <= axis_rad
            });
            let Some(hit) = hit else {
                self.missed += 1;
                continue;
            };
            at += hit;
            let (tip, axis) = off(&back.moves[at]);
            self.tip_mm = self.tip_mm.max(tip);
            self.axis_rad = self.axis_rad.max(axis);
            self.points += 1;
        }
        let wanted: f64 = path
            .moves
            .windows(2)
            .map(|w| match w[1].motion {
                Motion::Feed(f) => (w[1].pose.tip - w[0].pose.tip).norm() / f,
                Motion::Rapid => 0.0,
            })
            .sum();
        let got: f64 = back.blocks.iter().filter(|b| !b.rapid).map(|b| b.time_min).sum();
        let off = got / wanted - 1.0;
        self.time = if off.abs() > self.time.abs() { off } else { self.time };
    }
}

/// Whether the time of every block is L_CL / F0 by intention and by the control's reading.
fn keeps_time(machine: &Machine, dialect: Dialect, feed: FeedMode) -> bool {
    let plain = machine.rotary().is_empty();
    let corrects = !matches!(feed, FeedMode::None | FeedMode::Kz { .. } | FeedMode::Fastest { .. });
    let own = dialect.feed_metric(machine);
    let read_so = dialect == Dialect::Sinumerik
        || matches!(feed, FeedMode::Tcp | FeedMode::InverseTime)
        || feed.metric(own) == Some(own);
    (plain && !matches!(feed, FeedMode::Fastest { .. } | FeedMode::Kz { .. })) || (corrects && read_so)
}

fn main() -> ExitCode {
    let setup = Setup::at(Vec3::new(5.0, -3.0, 40.0), 80.0);
    let (mut programs, mut refused, mut bad) = (0, 0, 0);
    let mut most = [0.0f64; 3];
    println!(
        "{:<18} {:<11} {:<14} {:>7} {:>10} {:>10} {:>12}",
        "machine", "dialect", "feed", "points", "tip mm", "axis deg", "time %"
    );
    for name in built_in_names() {
        let machine = Machine::built_in(name).expect("built in");
        let mut paths = blade::for_rotary_axes(machine.rotary().len());
        for m in paths.iter_mut().flat_map(|p| &mut p.1.moves) {
            if let Motion::Feed(f) = &mut m.motion {
                *f *= SLOWER;
            }
        }
        for dialect in Dialect::ALL {
            let joints = blade::feed_modes().map(|(n, f)| (n, f, Orientation::Joints));
            let vectors = [("tcp, vectors", FeedMode::Tcp, Orientation::Vectors)];
            for (mode, feed, orientation) in joints.into_iter().chain(vectors) {
                let mut worst = Worst::default();
                let mut said = String::new();
                for (_, path) in &paths {
                    let options = PostOptions { orientation, ..PostOptions::new(dialect, feed) };
                    match post(path, &machine, &setup, &options) {
                        Ok(posted) => {
                            let back = read(&posted.text, dialect, &machine, &setup, &ReadOptions::default())
                                .expect("what we write we can read");
                            assert!(back.diagnostics.is_empty(), "{:?}", back.diagnostics);
                            let slowed =
                                |d: &osculate_geom::Diagnostic| d.message.contains("slower than asked");
                            worst.slowed |= posted.diagnostics.iter().any(slowed);
                            worst.add(path, &back);
                            programs += 1;
                        }
                        Err(e) => {
                            said = e.to_string();
                            refused += 1;
                        }
                    }
                }
                let start = format!("{name:<18} {dialect:<11} {mode:<14}", dialect = dialect.name());
                if worst.points + worst.missed == 0 {
                    println!("{start} refused: {}", said.chars().take(70).collect::<String>());
                    continue;
                }
                let keeps = keeps_time(&machine, dialect, feed) && !worst.slowed;
                let percent = 100.0 * worst.time;
                let time = if keeps { format!("{percent:.4}") } else { format!("({percent:.1})") };
                let off = worst.missed > 0 || (keeps && worst.time.abs() > 1e-3);
                bad += usize::from(off);
                let time_off = if keeps { worst.time.abs() } else { 0.0 };
                for (m, v) in most.iter_mut().zip([worst.tip_mm, worst.axis_rad.to_degrees(), time_off]) {
                    *m = m.max(v);
                }
                println!(
                    "{start} {:>7} {:>10.6} {:>10.7} {time:>12}{}",
                    worst.points,
                    worst.tip_mm,
                    worst.axis_rad.to_degrees(),
                    if off { "  OFF" } else { "" }
                );
            }
        }
    }
    println!("worst: tip {:.6} mm, axis {:.7} deg, time {:.4} %", most[0], most[1], 100.0 * most[2]);
    println!("{programs} programs come back, {refused} refused with a reason, {bad} rows off");
    if bad == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
