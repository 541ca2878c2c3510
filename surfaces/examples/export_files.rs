//! Reads every file named after the first argument and writes its faces to that folder as STEP, then reads it back:
//! prints the number of faces and the largest relative change of a face's area.

#![allow(clippy::print_stdout, clippy::unwrap_used)]

use osculate_surfaces::{iges, read, step};

fn main() {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().unwrap();
    std::fs::create_dir_all(&folder).unwrap();
    for path in arguments {
        let name = path.rsplit('/').next().unwrap_or(&path).to_owned();
        let Ok(part) = read(&std::fs::read(&path).unwrap()) else { continue };
        if part.faces.is_empty() {
            continue;
        }
        let written = match step::write(&part.faces, &step::StepOptions::default()) {
            Ok(text) => text,
            Err(e) => {
                println!("{name:50} {e}");
                continue;
            }
        };
        let stem = name.rsplit_once('.').map_or(name.as_str(), |p| p.0);
        std::fs::write(format!("{folder}/{stem}.step"), &written).unwrap();
        match iges::write(&part.faces, &iges::IgesOptions::default()) {
            Ok(text) => std::fs::write(format!("{folder}/{stem}.igs"), &text).unwrap(),
            Err(e) => println!("{name:50} IGES: {e}"),
        }
        let areas: Vec<String> = part.faces.iter().map(|f| format!("{:?}", f.area_mm2())).collect();
        std::fs::write(format!("{folder}/{stem}.areas"), areas.join("\n")).unwrap();
        let back = step::read(written.as_bytes()).unwrap();
        let worst = part.faces.iter().zip(&back.faces).fold((0.0_f64, ""), |w, (a, b)| {
            let e = (a.area_mm2() / b.area_mm2() - 1.0).abs();
            if e > w.0 { (e, a.id.as_str()) } else { w }
        });
        let kinds = part.faces.iter().zip(&back.faces).filter(|(a, b)| a.kind != b.kind).count();
        let same = part.faces.len() == back.faces.len();
        println!(
            "{name:50} {:5} faces back: {same}, {kinds} kinds differ, area {:9.2e} at {}, {} findings",
            part.faces.len(),
            worst.0,
            worst.1,
            back.diagnostics.len()
        );
    }
}
