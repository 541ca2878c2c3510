//! Productivity integrated over time on real faces: roughing against the tri-dexel model, finishing against the area:
//! `cargo run --release -p osculate-productivity --example productivity_in_time` from the repository's root.
#![allow(clippy::print_stdout, clippy::expect_used)]

#[path = "../tests/repository/rows.rs"]
mod rows;
#[path = "../tests/repository/slot.rs"]
mod slot;

use osculate_geom::Surface;
use osculate_surfaces::{Part, read};
use osculate_tools::{Cutter, CutterSpec, Lean};
use slot::Slot;

fn part(file: &str) -> Result<Part, Box<dyn std::error::Error>> {
    Ok(read(&std::fs::read(format!("examples/{file}"))?)?)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let length_mm = 30.0;
    println!("roughing, two passes side by side through a layer of stock, mm3");
    println!(
        "{:>18} {:>16} {:>9} {:>12} {:>12} {:>9} {:>12} {:>12} {:>9}",
        "face", "cutter", "layer mm", "1st, rate", "removal", "off %", "2nd, rate", "removal", "off %"
    );
    for (file, face, [fu, fv], scale) in [
        ("propeller/propeller.step", "F7", [0.5, 0.5], 1.0),
        ("eee-hpt-rotor2/blade.igs", "F1", [0.3, 0.5], 1.0),
        ("wigley-hull/hull.step", "F1", [0.4, 0.4], 8.0),
    ] {
        let part = part(file)?;
        let face = part.face(face).ok_or("no such face")?;
        let length_mm = scale * length_mm;
        for spec in [
            CutterSpec::Ball { diameter_mm: 4.0 * scale, length_mm },
            CutterSpec::Toroidal { diameter_mm: 5.0 * scale, corner_radius_mm: scale, length_mm },
        ] {
            let cutter = Cutter::try_from(spec)?;
            let slot = Slot {
                face,
                at: face.domain().at(fu, fv),
                cutter: &cutter,
                lean: Lean { lead_rad: 0.25, tilt_rad: 0.0 },
                stock_mm: 0.6 * scale,
                length_mm: 6.0 * scale,
                step_mm: 1.2 * scale,
                cell_mm: 0.03 * scale,
                instants: 40,
            };
            let got = slot.volumes();
            let name = if cutter.is_ball() { "ball" } else { "toroidal" };
            print!(
                "{:>18} {:>16} {:>9}",
                file.rsplit('/').next().unwrap_or(file),
                format!("{name} D{}", 2.0 * cutter.radius_mm()),
                slot.stock_mm
            );
            for (a, b) in got.by_rate.iter().zip(got.by_removal) {
                print!(" {a:>12.5} {b:>12.5} {:>+9.3}", 100.0 * (a / b - 1.0));
            }
            println!();
        }
    }
    println!("\nfinishing row by row, mm2");
    println!("{:>18} {:>6} {:>14} {:>14} {:>10}", "face", "rows", "over time", "area", "off %");
    for (file, face) in [
        ("propeller/propeller.step", "F7"),
        ("propeller/propeller.step", "F6"),
        ("eee-hpt-rotor2/blade.igs", "F1"),
        ("wigley-hull/hull.step", "F1"),
    ] {
        let part = part(file)?;
        let name = format!("{} {face}", file.rsplit('/').next().unwrap_or(file));
        let face = part.face(face).ok_or("no such face")?;
        for rows in [1, 12] {
            let (got, area) = (rows::integrated(face, rows, 2.5), face.area_mm2());
            println!("{name:>18} {rows:>6} {got:>14.5} {area:>14.5} {:>+10.5}", 100.0 * (got / area - 1.0));
        }
    }
    Ok(())
}
