//! Passes over one face, joined to a path around the face's box.

use osculate_geom::{Box3, Surface};
use osculate_productivity::plan::{Links, Pass, Walls, link};
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
    let mut links = Links::new(obstacles, *cutter, 1000.0);
    links.clearance_mm = 5.0;
    link(passes, &links, &Walls::default()).path
}
