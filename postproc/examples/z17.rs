//! Table 1 and figures 6 and 7 of Z17 on a real blade: `cargo xtask papers z17`.
//!
//! Usage: `z17 FOLDER` writes `z17.md` and its pictures there. The blade is NASA Rotor 37 on the turning centre
//! `mill-turn-xyzc`, a ball end of 4 mm, passes around the leading and trailing edges with a lead of 10 degrees.
#![allow(clippy::print_stderr, clippy::expect_used, dead_code)]

#[path = "../tests/common/blade.rs"]
mod blade;

use blade::{At, Blade, radial};
use osculate_geom::Vec3;
use osculate_postproc::feed::{PathMetric, Step, limited_rise};
use osculate_postproc::nc::timing::time;
use osculate_postproc::readback::{ReadOptions, read};
use osculate_postproc::{Dialect, FeedMode, Machine, PostOptions, Setup, SolveOptions, post};
use osculate_tools::cl::{ClPath, Motion};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// The feed that is wanted at the tip, mm/min.
const FEED: f64 = 500.0;
/// Passes on each side.
const PASSES: usize = 12;
/// K_Z's step, mm/min, as the paper has it.
const KZ_STEP: f64 = 200.0;

fn main() -> ExitCode {
    let Some(folder) = std::env::args_os().nth(1).map(PathBuf::from) else {
        eprintln!("usage: z17 FOLDER");
        return ExitCode::from(2);
    };
    match study(&folder) {
        Ok(()) => ExitCode::SUCCESS,
        Err(e) => {
            eprintln!("z17: {e}");
            ExitCode::FAILURE
        }
    }
}

/// A mode on one path.
struct Row {
    model_s: f64,
    by_f_s: f64,
    slowest: f64,
    fastest: f64,
    share_wanted: f64,
}

fn modes() -> [(&'static str, FeedMode); 8] {
    [
        ("with TCP", FeedMode::Tcp),
        ("without TCP, no correction", FeedMode::None),
        ("without TCP, K_V", FeedMode::Kv { fgref_mm: None }),
        ("without TCP, K_Z", FeedMode::Kz { step_mm_min: KZ_STEP, fgref_mm: None }),
        ("without TCP, K_F", FeedMode::Kf),
        ("without TCP, rotary only", FeedMode::RotaryOnly),
        ("without TCP, inverse time", FeedMode::InverseTime),
        ("time-optimal, no cap on the tip", FeedMode::Fastest { tip_mm_min: None }),
    ]
}

/// Back and forth over the points from one edge to the other, at rising spans.
fn side(blade: &Blade, first: usize, last: usize) -> ClPath {
    let n = blade.around();
    let count = (last + n - first) % n;
    let mut all: Vec<At> = Vec::new();
    for pass in 0..PASSES {
        let span = 0.25 + 0.5 * pass as f64 / PASSES as f64;
        for k in 0..=count {
            let k = if pass % 2 == 0 { k } else { count - k };
            all.push(blade.at(span, first + k));
        }
    }
    blade::path(all.iter().map(|a| radial(a, 10f64.to_radians())), FEED)
}

fn row(
    machine: &Machine,
    setup: &Setup,
    path: &ClPath,
    mode: FeedMode,
) -> Result<Row, Box<dyn std::error::Error>> {
    let options = PostOptions::new(Dialect::Fanuc, mode);
    let posted = post(path, machine, setup, &options)?;
    let timed = time(&posted.text, Dialect::Fanuc, machine, setup, true)?;
    let back = read(&posted.text, Dialect::Fanuc, machine, setup, &ReadOptions::default())?;
    let mut row = Row {
        model_s: 60.0 * timed.time.cutting_min,
        by_f_s: 0.0,
        slowest: f64::INFINITY,
        fastest: 0.0,
        share_wanted: 0.0,
    };
    let (mut near, mut length) = (0.0, 0.0);
    for b in back.blocks.iter().filter(|b| !b.rapid && b.tip_length_mm > 0.0) {
        let feed = b.tip_length_mm / b.time_min;
        row.by_f_s += 60.0 * b.time_min;
        row.slowest = row.slowest.min(feed);
        row.fastest = row.fastest.max(feed);
        length += b.tip_length_mm;
        near += if (feed / FEED - 1.0).abs() < 0.05 { b.tip_length_mm } else { 0.0 };
    }
    row.share_wanted = near / length;
    Ok(row)
}

fn study(folder: &Path) -> Result<(), Box<dyn std::error::Error>> {
    std::fs::create_dir_all(folder)?;
    for (file, text) in page()? {
        std::fs::write(folder.join(file), text)?;
    }
    Ok(())
}

/// The page and its pictures by file. A test makes them too.
pub fn page() -> Result<Vec<(&'static str, String)>, Box<dyn std::error::Error>> {
    let machine = Machine::built_in("mill-turn-xyzc")?;
    let setup = Setup::at(Vec3::new(0.0, 0.0, 200.0), 60.0);
    let paths = paths(&Blade::rotor_37());
    let mut text = head();
    for (name, path) in &paths {
        let rows = modes()
            .iter()
            .map(|(mode_name, mode)| Ok((*mode_name, row(&machine, &setup, path, *mode)?)))
            .collect::<Result<Vec<_>, Box<dyn std::error::Error>>>()?;
        table(&mut text, name, path, &rows)?;
    }
    let (words, charts) = figures(&machine, &setup, &paths[0].1)?;
    Ok(charts.into_iter().chain([("z17.md", text + &words)]).collect())
}

/// The paths, with their names.
fn paths(blade: &Blade) -> [(&'static str, ClPath); 3] {
    let n = blade.around();
    let x = |i: &usize| blade.at(0.5, *i).point.x;
    let leading = (0..n).min_by(|a, b| x(a).total_cmp(&x(b))).unwrap_or(0);
    let trailing = (0..n).max_by(|a, b| x(a).total_cmp(&x(b))).unwrap_or(0);
    // The suction side is the convex one: the further from the chord.
    let bulge = |a: usize, b: usize| {
        let (p, q) = (blade.at(0.5, a).point, blade.at(0.5, b).point);
        let across = Vec3::z().cross(&(q - p)).normalize();
        let count = (b + n - a) % n;
        (0..count).map(|k| (blade.at(0.5, a + k).point - p).dot(&across).abs()).fold(0.0, f64::max)
    };
    let mut sides = [("suction side", leading, trailing), ("pressure side", trailing, leading)];
    if bulge(trailing, leading) > bulge(leading, trailing) {
        sides.swap(0, 1);
        sides[0].0 = "suction side";
        sides[1].0 = "pressure side";
    }
    [
        (
            "around both edges",
            blade::path(
                blade.rounds(0.3, PASSES / 2, 0.05).iter().map(|a| radial(a, 10f64.to_radians())),
                FEED,
            ),
        ),
        (sides[0].0, side(blade, sides[0].1, sides[0].2)),
        (sides[1].0, side(blade, sides[1].1, sides[1].2)),
    ]
}

fn head() -> String {
    format!(
        "# Z17 on a real blade\n\n\
         Regenerated by `cargo xtask papers z17`. The paper's blade is not published; this is NASA Rotor 37 (its\n\
         sections are in `postproc/tests/data/blade`) on the built-in turning centre `mill-turn-xyzc`: the part in C,\n\
         a ball end of {} mm along X, leaning by 10 degrees, wanted feed {FEED} mm/min at the tip. The control reads F\n\
         over X Y Z, as those of Table 1 must have: only then is K_F the mode that keeps the wanted feed and K_V the one\n\
         that runs faster. *By F* is what F asks of the control; *model* adds the joints' speeds, accelerations and\n\
         jerks and the corners. Feeds are those of the tip relative to the part, by F.\n\n",
        2.0 * blade::BALL_MM
    )
}

fn table(text: &mut String, name: &str, path: &ClPath, rows: &[(&str, Row)]) -> std::fmt::Result {
    let mm: f64 = path.moves.windows(2).map(|w| (w[1].pose.tip - w[0].pose.tip).norm()).sum();
    let tcp = rows[0].1.model_s;
    writeln!(text, "## {} ({} CL points, {mm:.1} mm)\n", name, path.moves.len())?;
    writeln!(
        text,
        "| mode | by F, s | model, s | model / TCP | slowest, mm/min | fastest, mm/min | way within 5 % of F0 |"
    )?;
    writeln!(text, "|---|---:|---:|---:|---:|---:|---:|")?;
    for (mode, r) in rows {
        writeln!(
            text,
            "| {mode} | {:.2} | {:.2} | {:.3} | {:.1} | {:.1} | {:.1} % |",
            r.by_f_s,
            r.model_s,
            r.model_s / tcp,
            r.slowest,
            r.fastest,
            100.0 * r.share_wanted
        )?;
    }
    if name != "around both edges" {
        let printed = if name.starts_with("suction") { [0.917, 0.879, 1.029] } else { [1.012, 0.782, 0.985] };
        let [none, kv, kf] = printed;
        writeln!(text, "\nTable 1 of the paper, relative to TCP: no correction {none}, K_V {kv}, K_F {kf}.")?;
    }
    let find = |key: &str| rows.iter().find(|r| r.0.ends_with(key)).map_or(f64::NAN, |r| r.1.model_s);
    let (kv, kf) = (find("K_V"), find("K_F"));
    let without = rows.iter().filter(|r| r.0.starts_with("without TCP, K") || r.0.ends_with("no correction"));
    let first = without.map(|r| r.1.model_s).fold(f64::INFINITY, f64::min);
    writeln!(
        text,
        "\nK_V is {} among no correction, K_V, K_Z and K_F; K_F takes {:.3} of the time with TCP.\n",
        if kv <= first { "the fastest" } else { "not the fastest" },
        kf / tcp
    )
}

/// Words and their pictures, by file.
type Figures = (String, [(&'static str, String); 2]);

/// K and F by block over two rounds.
fn figures(machine: &Machine, setup: &Setup, path: &ClPath) -> Result<Figures, Box<dyn std::error::Error>> {
    let options = SolveOptions { tcp: false, ..SolveOptions::default() };
    let two_rounds = ClPath { moves: path.moves.iter().take(601).copied().collect(), ..path.clone() };
    let joints = machine.solve(&two_rounds, setup, &options)?;
    let (mut kv, mut kf) = (Vec::new(), Vec::new());
    for pair in joints.blocks.windows(2).filter(|p| p[1].motion != Motion::Rapid && p[1].tip_length_mm > 0.0)
    {
        let (a, b) = (&pair[0].joints, &pair[1].joints);
        let linear: f64 = machine.linear().iter().map(|p| (b[*p] - a[*p]).powi(2)).sum();
        let turn = machine.rotary().first().map_or(0.0, |p| b[*p] - a[*p]);
        let step = Step { linear_mm: linear.sqrt(), rotary_rad: [turn, 0.0] };
        let degree = PathMetric::Arc { radius_mm: 180.0 / std::f64::consts::PI };
        kv.push(degree.length(&step) / pair[1].tip_length_mm);
        kf.push(step.linear_mm / pair[1].tip_length_mm);
    }
    let f: Vec<f64> = kv.iter().map(|k| k * FEED).collect();
    let kz = limited_rise(&f, KZ_STEP);
    let charts = [
        ("z17-k.svg", chart("K by block", &[("K_V", &kv), ("K_F", &kf)])),
        ("z17-f.svg", chart("F by block, mm/min", &[("K_V", &f), ("K_Z", &kz)])),
    ];
    let most = kv.iter().copied().fold(0.0, f64::max);
    let words = format!(
        "## K and F by block\n\n\
         As figures 6 and 7 of the paper, over two rounds: the peaks are the leading and the trailing edge. The greatest\n\
         K_V is {most:.1}, so F reaches {:.0} mm/min at F0 = {FEED} mm/min. K_Z limits the rise of F to {KZ_STEP} mm/min a\n\
         block.\n\n![K by block](z17-k.svg)\n\n![F by block](z17-f.svg)\n",
        most * FEED
    );
    Ok((words, charts))
}

/// A line chart with a logarithmic ordinate.
fn chart(title: &str, lines: &[(&str, &Vec<f64>)]) -> String {
    let (w, h, left, low) = (900.0, 320.0, 60.0, 40.0);
    let all = || lines.iter().flat_map(|l| l.1.iter()).copied().filter(|v| *v > 0.0);
    let min = all().fold(f64::INFINITY, f64::min).log10().floor();
    let max = all().fold(0.0, f64::max).log10().ceil().max(min + 1.0);
    let count = lines.iter().map(|l| l.1.len()).max().unwrap_or(1).max(2) as f64 - 1.0;
    let y = |v: f64| h - low - (v.log10() - min) / (max - min) * (h - low - 30.0);
    let mut s = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w} {h}\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"{w}\" height=\"{h}\" fill=\"white\"/>\n<text x=\"{left}\" y=\"18\">{title}</text>\n"
    );
    let mut decade = min;
    while decade <= max {
        let at = y(10f64.powf(decade));
        s.push_str(&format!(
            "<path d=\"M{left} {at:.1}H{}\" stroke=\"#ccc\"/><text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>\n",
            w - 10.0, left - 6.0, at + 4.0, 10f64.powf(decade)
        ));
        decade += 1.0;
    }
    for (k, (name, values)) in lines.iter().enumerate() {
        let colour = ["#c22", "#16c"][k % 2];
        let mut d = String::new();
        for (i, v) in values.iter().enumerate().filter(|v| *v.1 > 0.0) {
            let x = left + i as f64 / count * (w - left - 10.0);
            d.push_str(&format!("{}{x:.1} {:.1}", if d.is_empty() { "M" } else { "L" }, y(*v)));
        }
        s.push_str(&format!("<path d=\"{d}\" fill=\"none\" stroke=\"{colour}\"/>\n"));
        let x = left + 160.0 + 80.0 * k as f64;
        s.push_str(&format!("<text x=\"{x}\" y=\"18\" fill=\"{colour}\">{name}</text>\n"));
    }
    let last = count + 1.0;
    s.push_str(&format!("<text x=\"{left}\" y=\"{}\">block 1</text><text x=\"{}\" y=\"{}\" text-anchor=\"end\">{last}</text>\n</svg>\n", h - 20.0, w - 10.0, h - 20.0));
    s
}
