//! A field of tool axes over a face: painted by how far they lean off the normal, with sticks along them, and the places that no axis
//! reaches.

use super::cells;
use super::drawing::{Anchor, Drawing, Type, letters, pen};
use super::panel::{self, BAR_AT, BAR_LENGTH, FRAME, HEIGHT, WIDTH};
use super::scene::Scene;
use super::study::Study;
use crate::report::legend::{Scale, UNKNOWN, hex};
use crate::words::number;
use osculate_geom::{Point3, Unit3, Uv, uv};
use osculate_surfaces::TrimmedSurface;

/// Length of a stick that lies in the plane of the picture, px.
const STICK: f64 = 26.0;
/// Half the size of the mark of a place that no axis reaches, px.
const CROSS: f64 = 2.6;
/// Least distance of two of them, px.
const APART: f64 = 9.0;
const RED: &str = "#b3122b";
const INK: &str = "#222";

/// Corners of cells over the parameters of a face: how many along u and along v, v growing first. Rows have the same u, columns the
/// same v.
#[non_exhaustive]
pub struct Corners {
    /// How many.
    pub count: [usize; 2],
    /// Their parameters.
    pub at: Vec<Uv>,
}

impl Corners {
    /// Cells along u and along v.
    pub const fn cells(&self) -> [usize; 2] {
        [self.count[0] - 1, self.count[1] - 1]
    }

    /// The parameters at numbers of corners, whole or not.
    pub fn between(&self, i: f64, j: f64) -> Uv {
        let part = |x: f64, n: usize| {
            // Corners are few.
            let low = (x.floor() as usize).min(n - 2);
            (low, x - low as f64)
        };
        let ((i, s), (j, t)) = (part(i, self.count[0]), part(j, self.count[1]));
        let [a, b] = [i, i + 1].map(|i| self.at[i * self.count[1]].u);
        let [c, d] = [j, j + 1].map(|j| self.at[j].v);
        uv(a + s * (b - a), c + t * (d - c))
    }

    /// The middles of all cells, v growing first.
    pub fn middles(&self) -> Vec<Uv> {
        let [n, m] = self.cells();
        (0..n * m).map(|k| self.between((k / m) as f64 + 0.5, (k % m) as f64 + 0.5)).collect()
    }
}

/// The field for one direction of passes.
#[non_exhaustive]
pub struct Shown {
    /// The direction in words.
    pub passes: String,
    /// How far the axis leans off the normal in the middle of every cell, degrees; NaN where no axis is possible.
    pub lean_deg: Vec<f64>,
    /// Places of the face with the axis there.
    pub sticks: Vec<(Point3, Unit3)>,
}

/// What no axis reaches.
#[non_exhaustive]
pub struct Unreached {
    /// Places.
    pub places: Vec<Point3>,
    /// Their area, mm2.
    pub area_mm2: f64,
}

/// The fields over a face, one beside the other.
pub fn page(
    (study, scene, name): (&Study, &Scene, &str),
    (face, corners): (&TrimmedSurface, &Corners),
    all: &[Shown],
    unreached: &Unreached,
) -> String {
    const TOP: f64 = 34.0;
    let mut sheet = Drawing::default();
    sheet.text([FRAME[0], 24.0], name, Type { bold: true, ..letters(15.0) });
    let leans = all.iter().flat_map(|s| s.lean_deg.iter().copied());
    let scale = Scale::sequential("lean off the normal", "\u{b0}", leans);
    for (k, shown) in all.iter().enumerate() {
        let mut d = Drawing::default();
        cells::paint(&mut d, scene, (face, corners.cells()), &|i, j| corners.between(i, j), |i, j| {
            let lean = shown.lean_deg.get(i * corners.cells()[1] + j);
            scale.as_ref().zip(lean).map_or(UNKNOWN, |(s, lean)| s.colour(*lean))
        });
        d.lines(&panel::seen(scene, &study.silhouette(&scene.toward())), pen(INK, 0.8));
        d.lines(&panel::seen(scene, &study.borders), pen(INK, 1.0));
        marks(&mut d, scene, &unreached.places);
        sticks(&mut d, scene, &shown.sticks);
        panel::ornaments(&mut d, study, scene);
        if let Some(s) = &scale {
            d.fragment(&s.bar(BAR_LENGTH), BAR_AT, 9.5);
            let middle = Type { anchor: Anchor::Middle, ..letters(9.5) };
            d.text([BAR_AT[0] + 24.0, BAR_AT[1] + BAR_LENGTH + 16.0], &s.unit, middle);
        }
        legend(&mut d, shown, unreached);
        sheet.insert(&d, [WIDTH * k as f64, TOP]);
    }
    sheet.finish(WIDTH * all.len() as f64, TOP + HEIGHT, &format!("{name}: tool axes"))
}

/// The places that no axis reaches, those that are seen and not upon each other.
fn marks(d: &mut Drawing, scene: &Scene, places: &[Point3]) {
    let mut kept: Vec<[f64; 2]> = Vec::new();
    for [x, y] in places.iter().filter(|p| scene.sees(p)).map(|p| scene.place(p)) {
        if kept.iter().all(|k| (k[0] - x).hypot(k[1] - y) > APART) {
            kept.push([x, y]);
        }
    }
    let lines: Vec<_> = kept.into_iter().flat_map(cross).collect();
    d.lines(&lines, pen("#fff", 2.6));
    d.lines(&lines, pen(RED, 1.2));
}

fn cross([x, y]: [f64; 2]) -> [Vec<[f64; 2]>; 2] {
    let r = CROSS;
    [vec![[x - r, y - r], [x + r, y + r]], vec![[x - r, y + r], [x + r, y - r]]]
}

/// Sticks along the axes at places that are seen.
fn sticks(d: &mut Drawing, scene: &Scene, all: &[(Point3, Unit3)]) {
    let seen = || all.iter().filter(|(p, _)| scene.sees(p));
    let lines: Vec<_> = seen()
        .map(|(p, axis)| {
            let end = p + axis.into_inner() * (STICK / scene.camera.scale);
            vec![scene.place(p), scene.place(&end)]
        })
        .collect();
    d.lines(&lines, pen("#fff", 3.2));
    d.lines(&lines, pen(INK, 1.3));
    for (p, _) in seen() {
        d.disc(scene.place(p), 1.9, INK, pen("#fff", 0.6));
    }
}

/// What colours, sticks and marks mean.
fn legend(d: &mut Drawing, shown: &Shown, unreached: &Unreached) {
    let top = FRAME[1] + FRAME[3] + 30.0;
    let bold = Type { bold: true, ..letters(13.0) };
    d.text([FRAME[0], top], &format!("{}: lean of the tool axis off the normal", shown.passes), bold);
    let y = top + 18.0;
    let x = FRAME[0];
    if shown.sticks.is_empty() {
        d.text([x, y], "no field", letters(10.5));
    } else {
        d.lines(&[vec![[x + 2.0, y - 3.5], [x + 20.0, y - 3.5]]], pen(INK, 1.3));
        d.disc([x + 2.0, y - 3.5], 1.9, INK, pen("#fff", 0.6));
        d.text([x + 26.0, y], "tool axis, from the face to the spindle", letters(10.5));
    }
    if unreached.area_mm2 > 0.0 {
        let x = x + 230.0;
        let swatch = [[x, y - 8.5], [x + 10.0, y - 8.5], [x + 10.0, y + 0.5], [x, y + 0.5]];
        d.area(&swatch, &hex(UNKNOWN));
        d.lines(&cross([x + 5.0, y - 4.0]), pen(RED, 1.2));
        let words = format!("no axis reaches: {} mm\u{b2}", number(unreached.area_mm2, 3));
        d.text([x + 16.0, y], &words, letters(10.5));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_between_corners_are_linear() {
        let at = [0.0, 1.0, 4.0].iter().flat_map(|u| [2.0, 3.0].map(|v| uv(*u, v))).collect();
        let corners = Corners { count: [3, 2], at };
        assert_eq!(corners.between(1.5, 0.25), uv(2.5, 2.25));
        assert_eq!(corners.between(2.0, 1.0), uv(4.0, 3.0));
        assert_eq!(corners.middles(), [uv(0.5, 2.5), uv(2.5, 2.5)]);
    }
}
