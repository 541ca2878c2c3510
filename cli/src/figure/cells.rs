//! A face painted cell by cell.

use super::drawing::Drawing;
use super::scene::Scene;
use crate::report::legend::{Rgb, hex};
use osculate_geom::{Surface, Uv};
use osculate_surfaces::TrimmedSurface;

/// Paints the cells of a face whose middle lies within its trims, from far to near. Their corners stand at whole numbers, none of
/// them above `count` along u and along v; `at` has the parameters of any place between, and `colour` those of the cell that
/// begins at a corner.
pub fn paint(
    d: &mut Drawing,
    scene: &Scene,
    (face, [n, m]): (&TrimmedSurface, [usize; 2]),
    at: &dyn Fn(f64, f64) -> Uv,
    colour: impl Fn(usize, usize) -> Rgb,
) {
    let middle = |i: usize, j: usize| at(i as f64 + 0.5, j as f64 + 0.5);
    let mut cells: Vec<(f64, usize, usize)> = (0..n * m)
        .map(|k| (k / m, k % m))
        .filter(|(i, j)| face.contains(middle(*i, *j)))
        .map(|(i, j)| (scene.nearness(&face.point(middle(i, j))), i, j))
        .collect();
    cells.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (_, i, j) in cells {
        let corners = [[0, 0], [1, 0], [1, 1], [0, 1]]
            .map(|[a, b]| scene.place(&face.point(at((i + a) as f64, (j + b) as f64))));
        d.area(&corners, &hex(colour(i, j)));
    }
}
