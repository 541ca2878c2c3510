//! Time of `removal::cut` and of `removal::stock` on passes over waves: samples, motions, seconds, memory.
//!
//! `cargo run --release -p osculate-tools --example removal_bench -- SAMPLES MOTIONS RAYS [SIDE_MM] [CASE]`, RAYS being the
//! number of rays along each side of the stock, SIDE_MM the side of the part (100) and CASE one of `3-axis`, `5-axis`,
//! `thick`, `levels`, `deep` (all of these) and `sizes`; `1000000 100000 512` are the figures to keep: below 10 s each for
//! the faces and below 60 s for the stock on two cores. CPU seconds are of the whole process, all threads.
//!
//! Stock is a cube around the waves. `levels` roughs it from the top in 25 levels of 25 passes, five axes at once; `deep`
//! takes the upper half of it in one layer of narrow passes, the whole side of the tool at work in every block, and one
//! more above the waves. `sizes` takes parts of one, four and sixteen times the area with as many blocks, samples and rays
//! for each square millimetre: what a block costs is to stay the same.

#![allow(clippy::print_stdout, reason = "a bench prints its figures")]

use osculate_geom::{
    Axis, Box3, Domain, Interval, Jet2, Point3, Series, Side, Surface, Taylor, Unit3, Uv, Vec3, uv,
};
use osculate_tools::removal::stock::{Blank, Resolution, Stock, StockJob, Upper};
use osculate_tools::removal::{Body, Job, Limits, Swept, cut, sample_surface, tally};
use osculate_tools::{Cutter, CutterSpec, Holder, Pose};
use std::error::Error;
use std::time::Instant;

/// z = height sin(u k) sin(v k) over a square.
struct Waves {
    side_mm: f64,
    height_mm: f64,
    per_mm: f64,
}

impl Surface for Waves {
    fn domain(&self) -> Domain {
        Domain { u: Interval::new(0.0, self.side_mm), v: Interval::new(0.0, self.side_mm) }
    }
    fn jet2(&self, at: Uv) -> Jet2 {
        let (h, k) = (self.height_mm, self.per_mm);
        let ((su, cu), (sv, cv)) = ((at.u * k).sin_cos(), (at.v * k).sin_cos());
        Jet2 {
            uv: at,
            point: Point3::new(at.u, at.v, h * su * sv),
            du: Vec3::new(1.0, 0.0, h * k * cu * sv),
            dv: Vec3::new(0.0, 1.0, h * k * su * cv),
            duu: Vec3::new(0.0, 0.0, -h * k * k * su * sv),
            duv: Vec3::new(0.0, 0.0, h * k * k * cu * cv),
            dvv: Vec3::new(0.0, 0.0, -h * k * k * su * sv),
            side: Side::Along,
        }
    }
    fn taylor(&self, at: Uv, order: usize) -> Taylor {
        let (u, v) = (Series::variable(Axis::U, at.u, order), Series::variable(Axis::V, at.v, order));
        let (su, sv) = ((u * self.per_mm).sin_cos().0, (v * self.per_mm).sin_cos().0);
        Taylor { uv: at, side: Side::Along, coordinates: [u, v, su * sv * self.height_mm] }
    }
}

/// Passes over the waves: the tool touches at each pose, three-axis or with the axis leaned from the normal.
fn passes(
    waves: &Waves,
    cutter: &Cutter,
    count: usize,
    five_axis: bool,
) -> Result<Vec<Swept>, Box<dyn Error>> {
    // As many steps along a pass as needed for steps twice the stepover.
    let lines = (count as f64 * 2.0).sqrt().round().max(2.0) as usize;
    let steps = (count / lines).max(1);
    let mut poses = Vec::new();
    for i in 0..lines {
        for j in 0..=steps {
            let f = j as f64 / steps as f64;
            let u = waves.side_mm * if i % 2 == 0 { f } else { 1.0 - f };
            let at = uv(u, waves.side_mm * i as f64 / (lines - 1) as f64);
            poses.push(touching(waves, cutter, at, five_axis)?);
        }
    }
    Ok(through(&poses))
}

/// The pose in which the tool touches the waves.
fn touching(waves: &Waves, cutter: &Cutter, at: Uv, five_axis: bool) -> Result<Pose, Box<dyn Error>> {
    let jet = waves.jet2(at);
    let n = jet.normal()?.into_inner();
    let lean = if five_axis { n + Vec3::x() * 0.25 } else { Vec3::z() };
    let axis = Unit3::new_normalize(lean);
    let (r, core) = (cutter.corner_mm(), cutter.core_mm());
    let side = axis.into_inner() * n.dot(&axis) - n;
    let out = if core > 0.0 { side.normalize() * core } else { Vec3::zeros() };
    Ok(Pose { tip: jet.point + n * r - out - axis.into_inner() * r, axis })
}

/// User CPU seconds of this process, where the system tells.
fn cpu_s() -> f64 {
    // Clock ticks are hundredths of a second on Linux.
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after_name = stat.rsplit(')').next().unwrap_or_default();
    after_name.split_whitespace().nth(11).and_then(|t| t.parse::<f64>().ok()).map_or(f64::NAN, |t| t / 100.0)
}

/// Most memory that this process has held, MB, where the system tells.
fn peak_mb() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    let kb = line.and_then(|l| l.split_whitespace().next()).and_then(|n| n.parse::<f64>().ok());
    kb.map_or(f64::NAN, |kb| kb / 1024.0)
}

/// A layer of narrow passes 2 mm above the waves, and one over the waves themselves.
fn deep(waves: &Waves, cutter: &Cutter, motions: usize) -> Result<Vec<Swept>, Box<dyn Error>> {
    let mut path = passes(waves, cutter, motions / 2, true)?;
    let raised: Vec<Swept> =
        path.iter().map(|m| Swept { from: m.from.retracted(2.0), to: m.to.retracted(2.0), ..*m }).collect();
    path.splice(0..0, raised);
    Ok(path)
}

/// How roughing goes down.
struct Levels {
    /// Where the first level lies, mm above the middle of the waves, and how far apart levels are.
    top_mm: f64,
    down_mm: f64,
    count: usize,
    /// Passes to a level, and steps along each.
    lines: usize,
    steps: usize,
}

/// Levels one below the other, kept above the waves, the axis leaning as on the waves.
fn levels(waves: &Waves, cutter: &Cutter, levels: &Levels) -> Result<Vec<Swept>, Box<dyn Error>> {
    let mut poses: Vec<Pose> = Vec::new();
    for level in 0..levels.count {
        let z = levels.top_mm - levels.down_mm * level as f64;
        for i in 0..levels.lines {
            let back = (level + i) % 2 == 1;
            let line = if level % 2 == 0 { i } else { levels.lines - 1 - i };
            for j in 0..=levels.steps {
                let f = j as f64 / levels.steps as f64;
                let along = waves.side_mm * if back { 1.0 - f } else { f };
                let across = waves.side_mm * line as f64 / (levels.lines - 1) as f64;
                let mut pose = touching(waves, cutter, uv(along, across), true)?;
                pose.tip.z = pose.tip.z.max(z);
                poses.push(pose);
            }
        }
    }
    Ok(through(&poses))
}

fn through(poses: &[Pose]) -> Vec<Swept> {
    let pairs = poses.windows(2).zip(1u32..);
    pairs.map(|(p, block)| Swept { from: p[0], to: p[1], rapid: false, block }).collect()
}

/// Carves a block around the waves; CPU microseconds a motion.
fn rough(
    (name, height_mm, cell_mm): (&str, [f64; 2], f64),
    waves: &Waves,
    cutter: &Cutter,
    path: &[Swept],
) -> Result<f64, Box<dyn Error>> {
    let side = waves.side_mm;
    let bounds =
        Box3 { min: Point3::new(0.0, 0.0, height_mm[0]), max: Point3::new(side, side, height_mm[1]) };
    let begin = Instant::now();
    let resolution = Resolution { cell_mm, tri: true, budget_bytes: 2 << 30 };
    let mut stock = Stock::fill(&Blank::Box(bounds), &resolution)?.stock;
    let filled = begin.elapsed().as_secs_f64();
    let (begin, before) = (Instant::now(), cpu_s());
    let holder = Cutter::cylinder(40.0, 60.0)?;
    let uppers = [Upper { body: &holder, above_mm: cutter.length_mm(), kind: Body::Holder }];
    let job = StockJob { cutter, uppers: &uppers, motions: path, touch_mm: 1e-3 };
    let carved = stock.carve(&job, &|_| ())?;
    let cpu = cpu_s() - before;
    println!(
        "{name:<10} {:>9} rays    {:>8} motions {:>8.2} s, {cpu:>7.2} CPU s, filled in {filled:.2} s: {:.1} mm3 taken in {} \
         motions, {} collisions, {:.0} MB of stretches",
        stock.rays(),
        path.len(),
        begin.elapsed().as_secs_f64(),
        carved.volume_mm3(),
        carved.work.len(),
        carved.collisions.len(),
        stock.bytes() as f64 / 1e6,
    );
    Ok(1e6 * cpu / path.len() as f64)
}

/// What a block costs on parts of different size, for each square millimetre all the same.
fn sizes(ball: &Cutter, bull: &Cutter) -> Result<(), Box<dyn Error>> {
    const PER_SIDE_MM: f64 = 0.04;
    println!("   side mm   blocks     us a block of faces    us a block of stock");
    for side_mm in [25.0, 50.0, 100.0] {
        let waves = Waves { side_mm, height_mm: 4.0, per_mm: 0.1 };
        let times = side_mm * PER_SIDE_MM;
        let samples = (1.5e4 * times * times) as usize;
        let sampling = sample_surface(&waves, 0, 1e-3, samples)?;
        let motions = passes(&waves, ball, (2e3 * times * times) as usize, false)?;
        let before = cpu_s();
        let job = Job {
            cutter: ball,
            holder: None,
            changes: &[],
            motions: &motions,
            samples: &sampling.samples,
            stock_mm: 0.3,
            depth_mm: 1.0,
        };
        cut(&job, &|_| ())?;
        let faces = 1e6 * (cpu_s() - before) / motions.len() as f64;
        let (lines, steps) = ((9.0 * times) as usize, (40.0 * times) as usize);
        let down = Levels { top_mm: 8.0, down_mm: 2.0, count: 5, lines, steps };
        let path = levels(&waves, bull, &down)?;
        let stock = rough(("", [-10.0, 10.0], 0.2), &waves, bull, &path)?;
        println!("{side_mm:>10} {:>8} {faces:>23.1} {stock:>22.1}", path.len());
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let mut number = |default: usize| args.next().map_or(Ok(default), |s| s.parse());
    let (samples, count, rays) = (number(300_000)?, number(30_000)?, number(256)?);
    let side_mm = number(100)? as f64;
    let only = args.next();
    let asked = |case: &str| only.as_ref().is_none_or(|o| o == case);
    let waves = Waves { side_mm, height_mm: 4.0, per_mm: 0.1 };
    let begin = Instant::now();
    let sampling = sample_surface(&waves, 0, 1e-3, samples)?;
    println!("sampling   {:>9} samples {:>27.2} s", sampling.samples.len(), begin.elapsed().as_secs_f64());
    let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 10.0, length_mm: 60.0 })?;
    let bull =
        Cutter::try_from(CutterSpec::Toroidal { diameter_mm: 10.0, corner_radius_mm: 2.0, length_mm: 60.0 })?;
    let holder = Holder::cylinder(40.0, 60.0)?;
    for (name, cutter, five_axis, stock_mm) in
        [("3-axis", &ball, false, 0.3), ("5-axis", &bull, true, 0.3), ("thick", &bull, true, 3.0)]
    {
        if !asked(name) {
            continue;
        }
        let motions = passes(&waves, cutter, count, five_axis)?;
        let (begin, cpu) = (Instant::now(), cpu_s());
        let job = Job {
            cutter,
            holder: Some(&holder),
            changes: &[],
            motions: &motions,
            samples: &sampling.samples,
            stock_mm,
            depth_mm: 1.0,
        };
        let cuts = cut(&job, &|_| ())?;
        let (seconds, cpu) = (begin.elapsed().as_secs_f64(), cpu_s() - cpu);
        let begin = Instant::now();
        let verdict = tally(&sampling.samples, &cuts, &Limits::new(0.02, 0.02), &sampling.density, 5.0)?;
        println!(
            "{name:<10} {:>9} samples {:>8} motions {seconds:>8.2} s, {cpu:>7.2} CPU s, judged in {:.2} s: \
             scallop {:.4} gouge {:.4} uncut {:.1} mm2",
            cuts.len(),
            motions.len(),
            begin.elapsed().as_secs_f64(),
            verdict.scallop_max_mm,
            verdict.gouge_max_mm,
            verdict.uncut_area_mm2,
        );
    }
    let (half, cell_mm) = (0.5 * side_mm, side_mm / rays as f64);
    if asked("levels") {
        const ACROSS: usize = 25;
        let steps = (count / (ACROSS * ACROSS)).max(1);
        let down_mm = half / ACROSS as f64;
        let down = Levels { top_mm: half - down_mm, down_mm, count: ACROSS, lines: ACROSS, steps };
        rough(("levels", [-half, half], cell_mm), &waves, &bull, &levels(&waves, &bull, &down)?)?;
    }
    if asked("deep") {
        rough(("deep", [-half, half], cell_mm), &waves, &bull, &deep(&waves, &bull, count)?)?;
    }
    if only.as_deref() == Some("sizes") {
        sizes(&ball, &bull)?;
    }
    println!("at most {:.0} MB of memory held at any time", peak_mb());
    Ok(())
}
