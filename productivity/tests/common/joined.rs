//! Passes over one face, joined to a path around the face's box.

use osculate_geom::{Box3, Surface};
use osculate_productivity::plan::{Links, Pass, Rates, Walls, link};
use osculate_tools::Cutter;
use osculate_tools::cl::ClPath;

/// Passes over a face, joined around its box.
pub fn joined(surface: &dyn Surface, passes: &[Pass], cutter: &Cutter) -> ClPath {
    let d = surface.domain();
    let mut obstacles = Box3::empty();
    for i in 0..=20 {
        for j in 0..=20 {
            obstacles.add(&surface.point(d.at(f64::from(i) / 20.0, f64::from(j) / 20.0)));
        }
    }
    let links = Links {
        obstacles,
        clearance_mm: 5.0,
        approach_mm: 2.0,
        hop_mm: 0.25,
        contacts: true,
        dropped: false,
        layer_mm: 0.0,
        dip_mm: 0.0,
        rates: Rates::default(),
        cutter: *cutter,
        holder: None,
        feed_mm_min: 1000.0,
        plunge_mm_min: 500.0,
    };
    link(passes, &links, &Walls::default()).path
}
