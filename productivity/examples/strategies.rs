//! Every strategy over one face, verified: passes, length, mean strip, what is left and gouged, the median of the cusps over the
//! tolerance, and user time of planning. From the repository's root:
//! `cargo run --release -p osculate-productivity --example strategies -- FACE CUTTER SCALLOP LEADS [STRATEGY ...]`.
//!
//! FACE is `m86-1` ... `m86-4`, `groove`, `plane`, or `FILE:F7`, flipped with `-` before it; CUTTER is `ball:6` or `toroidal:6:2`; LEADS are degrees, comma
//! separated.
#![allow(clippy::print_stdout, clippy::unwrap_used)]

#[path = "../tests/common/cutting.rs"]
mod cutting;

use cutting::{cusps, motions, verdict};
use osculate_geom::analytic::{Plane, Torus};
use osculate_geom::{Domain, Flipped, Interval, Patch, Side, Surface, Unit3, Vec3};
use osculate_productivity::plan::{Along, Strategy, Task, Tolerance, run};
use osculate_tools::removal::Kind;
use osculate_tools::{Cutter, CutterSpec, Lean};
use std::time::Instant;

fn face(name: &str) -> Box<dyn Surface> {
    let square = |side: f64| Domain { u: Interval::new(0.0, side), v: Interval::new(0.0, side) };
    match name {
        "plane" => Box::new(Plane::new(square(100.0))),
        "groove" => {
            let domain = Domain { u: Interval::new(0.0, 0.35), v: Interval::new(2.6, 3.7) };
            let surface = Torus::new(200.0, 60.0).unwrap();
            Box::new(Flipped(Patch { surface, domain, side: Side::Along }))
        }
        _ if name.starts_with("m86-") => {
            Box::new(osculate_surfaces::gallery::m86(name[4..].parse().unwrap()))
        }
        _ if name.starts_with('-') => Box::new(Flipped(face(&name[1..]))),
        _ => {
            let (file, id) = name.rsplit_once(':').expect("FILE:FACE");
            let part = osculate_surfaces::read(&std::fs::read(file).unwrap()).unwrap();
            let face = part.faces.into_iter().find(|f| f.id == id).expect("no such face");
            Box::new(face.surface)
        }
    }
}

fn cutter(name: &str) -> Cutter {
    let part: Vec<&str> = name.split(':').collect();
    let number = |k: usize| part[k].parse::<f64>().unwrap();
    let length_mm = 80.0;
    let spec = match part[0] {
        "flat" => CutterSpec::Flat { diameter_mm: number(1), length_mm },
        "ball" => CutterSpec::Ball { diameter_mm: number(1), length_mm },
        _ => CutterSpec::Toroidal { diameter_mm: number(1), corner_radius_mm: number(2), length_mm },
    };
    Cutter::try_from(spec).unwrap()
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [name, tool, scallop, leads, only @ ..] = arguments.as_slice() else {
        println!("FACE CUTTER SCALLOP LEADS [STRATEGY ...]");
        return;
    };
    let (surface, cutter, scallop_mm) = (face(name), cutter(tool), scallop.parse::<f64>().unwrap());
    let tolerance = Tolerance { scallop_mm, gouge_mm: 0.5 * scallop_mm, chord_mm: 0.2 * scallop_mm };
    let normal = |n: [f64; 3]| Strategy::Isoplanar { normal: Unit3::new_normalize(Vec3::from(n)) };
    let all = [
        Strategy::Isoparametric { along: Along::Auto },
        normal([0.0, 1.0, 0.0]),
        Strategy::Isoscallop,
        Strategy::Streamline,
        Strategy::Curvature5c,
    ];
    println!("{name} {tool} scallop {scallop_mm}");
    for lead in leads.split(',') {
        let lean = Lean { lead_rad: lead.parse::<f64>().unwrap().to_radians(), tilt_rad: 0.0 };
        let task = Task::new(name, &*surface, &cutter, lean, tolerance);
        for s in all.iter().filter(|s| only.is_empty() || only.iter().any(|o| o == s.name())) {
            let start = Instant::now();
            let passes = match run(&task, s) {
                Ok(p) => p,
                Err(e) => {
                    println!("{:14} lead {lead:>4}: {e}", s.name());
                    continue;
                }
            };
            let wall = start.elapsed().as_secs_f64();
            let moves = motions(&*surface, &passes.passes, &cutter);
            let widths: Vec<f64> = passes.passes.iter().map(|p| p.mean_width_mm()).collect();
            let width = widths.iter().sum::<f64>() / widths.len() as f64;
            let v = verdict(&*surface, &moves, &cutter, tolerance, width / 8.0);
            println!(
                "{:14} lead {lead:>4}: {:4} passes {:8.1} mm, strip {width:.3}, {:6} points, scallop {:.5} gouge {:.5} uncut {:.2} mm2, cusps {:.3}, {wall:.2} s",
                s.name(),
                passes.passes.len(),
                passes.length_mm(),
                moves.len(),
                v.scallop_max_mm,
                v.gouge_max_mm,
                v.uncut_area_mm2,
                cusps(&*surface, &moves, &cutter, scallop_mm),
            );
            for kind in [Kind::Scallop, Kind::Gouge, Kind::Uncut] {
                let Some(w) = v.worst.iter().find(|w| w.kind == kind).filter(|_| !v.within) else { continue };
                println!("    {:?} {:.5} mm at u {:.5}, v {:.5}", w.kind, w.value_mm, w.uv.u, w.uv.v);
            }
        }
    }
}
