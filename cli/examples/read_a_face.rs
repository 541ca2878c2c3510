//! What a CAD file holds: its faces, and how each bends in its middle.
//!
//!     cargo run -p osculate --example read_a_face [FILE.step]
#![allow(clippy::print_stdout)]

use osculate_geom::{Surface, uv};
use osculate_surfaces::{patches, read, step};
use std::error::Error;

/// Nearly a quarter of a cylinder of radius 10 mm and height 30 mm: a parabola stands for the arc.
const PATCH: &str = "1\n2 1\n10 0 0\n10 30 0\n10 0 10\n10 30 10\n0 0 10\n0 30 10\n";

fn main() -> Result<(), Box<dyn Error>> {
    let bytes = match std::env::args_os().nth(1) {
        Some(file) => std::fs::read(file)?,
        // A file of our own, where none is given.
        None => {
            step::write(&patches::read(PATCH.as_bytes())?.faces, &step::StepOptions::default())?.into_bytes()
        }
    };
    let part = read(&bytes)?;
    println!("{:<6} {:>12} {:>14} {:>14}", "face", "area mm2", "k_min 1/mm", "k_max 1/mm");
    for face in &part.faces {
        let domain = face.surface.domain();
        let middle = uv(domain.u.at(0.5), domain.v.at(0.5));
        let bends = face.surface.jet2(middle).forms()?.principal();
        println!("{:<6} {:>12.3} {:>14.6} {:>14.6}", face.id, face.area_mm2(), bends.k_min, bends.k_max);
        // A step along each parameter turns the normal by no more than the curvature allows.
        let jet = face.surface.jet2(middle);
        let next = face.surface.jet2(uv(domain.u.at(0.501), domain.v.at(0.5)));
        let turned = jet.normal()?.angle(&next.normal()?.into_inner());
        let most = bends.k_max.abs().max(bends.k_min.abs()) * (next.point - jet.point).norm();
        assert!(turned <= 1.01 * most + 1e-9, "{turned} rad over {most}");
    }
    for what in &part.diagnostics {
        println!("{what}");
    }
    Ok(())
}
