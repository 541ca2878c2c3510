//! Time of the map of possible axes in a channel between two blades.
//!
//! `cargo run --release -p osculate-tools --example reach_bench -- [PLACES] [POINTS] [LEVEL] [CHECKED]`; `10000 100000 4 0` are
//! the figures to keep: below 20 s on two cores for each tool. CHECKED places are compared with the distances of all points
//! in all directions, one by one, and so are their best axes.
//!
//! The channel: a floor that rises like a saddle, and two walls that lean, curve and twist, 11 to 17 mm apart and 30 mm high,
//! 80 mm long. Tools: a ball of 4 mm and a bull nose of 6 mm with a corner of 1 mm, with holders of 20 mm that sit 25 mm and
//! 30 mm above the tip.

#![allow(clippy::print_stdout, reason = "a bench prints its figures")]

use osculate_geom::{Point3, Unit3, Vec3};
use osculate_tools::reach::{
    Directions, ObstacleKind, ObstaclePoint, Obstacles, Place, Reach, ReachLimits, ReachProblem, Tool,
};
use osculate_tools::{Cutter, CutterSpec, Holder, pose_with_axis};
use std::error::Error;
use std::time::Instant;

const LONG_MM: f64 = 80.0;
const HIGH_MM: f64 = 30.0;

/// Half the width of the channel at a place along it and a height, and the middle of it.
fn side(u: f64, v: f64, sign: f64) -> Point3 {
    let (x, z) = (LONG_MM * (u - 0.5), HIGH_MM * v);
    let middle = 0.006 * x * x;
    let half = 5.5 + 2.5 * v + 0.8 * (0.05 * x).sin() * v;
    let twist = 0.02 * x * (v - 0.5);
    Point3::new(x, middle + sign * half + twist, z + floor_z(x, middle + sign * half))
}

fn floor_z(x: f64, y: f64) -> f64 {
    0.003 * x * x - 0.004 * y * y
}

fn face(owner: u32, u: f64, v: f64) -> Point3 {
    match owner {
        0 => {
            let [a, b] = [side(u, 0.0, -1.0), side(u, 0.0, 1.0)];
            let y = a.y + v * (b.y - a.y);
            Point3::new(a.x, y, floor_z(a.x, y))
        }
        1 => side(u, v, -1.0),
        _ => side(u, v, 1.0),
    }
}

/// A point of a face with its normal, into the channel.
fn place(owner: u32, u: f64, v: f64) -> Place {
    let step = 1e-5;
    let by = |du: f64, dv: f64| face(owner, u + du, v + dv) - face(owner, u - du, v - dv);
    let normal = Unit3::new_normalize(by(step, 0.0).cross(&by(0.0, step)));
    let inwards = match owner {
        0 => Vec3::z(),
        1 => Vec3::y(),
        _ => -Vec3::y(),
    };
    let normal = if normal.dot(&inwards) > 0.0 { normal } else { -normal };
    Place { point: face(owner, u, v), normal }
}

fn points(count: usize) -> Vec<ObstaclePoint> {
    let areas = [12.0, HIGH_MM, HIGH_MM].map(|wide| wide * LONG_MM);
    let total: f64 = areas.iter().sum();
    let mut all = Vec::new();
    for owner in 0..3u32 {
        let apart = (total / count as f64).sqrt();
        let along = (LONG_MM / apart).round() as usize;
        let across = (areas[owner as usize] / LONG_MM / apart).round() as usize;
        for i in 0..=along {
            for j in 0..=across {
                let point = face(owner, i as f64 / along as f64, j as f64 / across as f64);
                all.push(ObstaclePoint { point, owner, kind: ObstacleKind::Part });
            }
        }
    }
    all
}

fn places(count: usize) -> Vec<Place> {
    let spread = |k: usize, step: f64| (0.5 + step * k as f64).fract();
    (0..count)
        .map(|k| {
            let (u, v) = (spread(k, 0.754_877_666), spread(k, 0.569_840_291));
            place((k % 3) as u32, 0.05 + 0.9 * u, 0.02 + 0.96 * v)
        })
        .collect()
}

/// The spare of all directions, by all distances.
fn slowly(problem: &ReachProblem<'_>, at: &Place) -> Vec<f64> {
    let (cutter, limits) = (problem.tool.cutter(), &problem.limits);
    let of = |axis: &Unit3| {
        let lean = axis.dot(&at.normal);
        let most = limits.least_lean_rad;
        if lean < limits.most_lean_rad.cos() || (most > 0.0 && lean > most.cos()) {
            return f64::NEG_INFINITY;
        }
        let pose = pose_with_axis(cutter, &at.point, &at.normal, axis);
        let own = problem.obstacles.points().iter().map(|p| {
            let first = cutter.distance(&pose, &p.point) + limits.gouge_mm;
            problem.tool.mounted().iter().fold(first, |least, m| {
                let raised = pose.retracted(m.height_mm);
                least.min(m.body.distance(&raised, &p.point) - limits.clearance_mm)
            })
        });
        own.fold(f64::INFINITY, f64::min)
    };
    problem.directions.all().iter().map(of).collect()
}

/// User seconds of the whole process so far; zero where the system does not tell.
fn cpu_s() -> f64 {
    // The fourteenth field, in hundredths of a second on every Linux of today.
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after = stat.rsplit_once(") ").map_or("", |(_, after)| after);
    after.split(' ').nth(11).and_then(|ticks| ticks.parse::<f64>().ok()).unwrap_or(0.0) / 100.0
}

fn main() -> Result<(), Box<dyn Error>> {
    let given: Vec<usize> = std::env::args().skip(1).map(|a| a.parse()).collect::<Result<_, _>>()?;
    let get = |k: usize, default: usize| given.get(k).copied().unwrap_or(default);
    let (places, points) = (places(get(0, 10_000)), points(get(1, 100_000)));
    let start = Instant::now();
    let directions = Directions::icosphere(get(2, 4) as u32)?;
    let obstacles = Obstacles::new(points)?;
    println!(
        "{} places, {} directions, {} points; trees in {:.3} s",
        places.len(),
        directions.all().len(),
        obstacles.len(),
        start.elapsed().as_secs_f64()
    );
    let ball = CutterSpec::Ball { diameter_mm: 4.0, length_mm: 25.0 };
    let bull = CutterSpec::Toroidal { diameter_mm: 6.0, corner_radius_mm: 1.0, length_mm: 30.0 };
    for (name, spec, least_lean_rad) in [("ball 4", ball, 0.0), ("bull nose 6 r 1", bull, 0.02)] {
        let tool = Tool::new(Cutter::try_from(spec)?, Some(&Holder::cylinder(20.0, 60.0)?));
        let limits = ReachLimits {
            gouge_mm: 0.01,
            clearance_mm: 0.5,
            stock_mm: 0.5,
            least_lean_rad,
            most_lean_rad: 85f64.to_radians(),
        };
        let problem = ReachProblem {
            tool: &tool,
            limits,
            obstacles: &obstacles,
            directions: &directions,
            allowed: None,
        };
        let reach = Reach::new(problem)?;
        let (wall, cpu) = (Instant::now(), cpu_s());
        let all = reach.map(&places);
        let (wall, cpu) = (wall.elapsed().as_secs_f64(), cpu_s() - cpu);
        let free: usize = all.iter().map(|b| b.count()).sum();
        let shut = all.iter().filter(|b| b.is_empty()).count();
        println!(
            "{name}: map {wall:.2} s, {cpu:.2} CPU s; {:.1} directions at a place, {shut} places with none",
            free as f64 / places.len() as f64
        );
        let (wall, asked) = (Instant::now(), places.len().min(1000));
        let spares: f64 = places[..asked].iter().filter_map(|p| reach.best(p)).map(|b| b.gap.spare_mm).sum();
        println!(
            "  best axis of {asked} places: {:.2} s on one thread, mean spare {:.4} mm",
            wall.elapsed().as_secs_f64(),
            spares / asked as f64
        );
        let mut worst: f64 = 0.0;
        let mut different = 0;
        for k in 0..get(3, 0).min(places.len()) {
            let slow = slowly(&problem, &places[k]);
            different += (0..slow.len()).filter(|&d| all[k].contains(d) != (slow[d] >= 0.0)).count();
            let best = slow.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            worst = reach.best(&places[k]).map_or(worst, |b| worst.max((b.gap.spare_mm - best).abs()));
        }
        if get(3, 0) > 0 {
            println!(
                "  {} places one by one: {different} bits differ, best spares by {worst:.1e} mm",
                get(3, 0)
            );
        }
    }
    Ok(())
}
