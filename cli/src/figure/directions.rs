//! The directions of the tool at one place of a face, as a round map seen from outside along the normal: which are free, and what
//! keeps the tool from the others.
//!
//! The middle is the normal, the distance from it the lean (azimuthal equidistant), the rim a lean of a right angle. The
//! direction of u points to the right.

use super::drawing::{Anchor, Drawing, Type, letters, pen};
use super::scene::Place;
use crate::report::legend::{Rgb, hex};
use crate::report::text::fixed;
use osculate_geom::{Unit3, Vec3, any_perpendicular};
use osculate_tools::reach::Directions;
use std::f64::consts::{FRAC_PI_2, PI};

/// The page, the middle of the map and its radius, px.
const WIDTH: f64 = 700.0;
const HEIGHT: f64 = 520.0;
const MIDDLE: Place = [226.0, 290.0];
const RADIUS: f64 = 190.0;
/// Leans with a ring, degrees.
const RINGS_DEG: [f64; 5] = [15.0, 30.0, 45.0, 60.0, 75.0];
/// Where rings are labelled, degrees anticlockwise from the direction of u.
const LABELS_DEG: f64 = -67.5;
/// Where the legend stands, and its rows, px.
const LEGEND: Place = [456.0, 96.0];
const ROW: f64 = 17.0;
/// Radius of the dot of a direction that has too few neighbours for a cell, px.
const DOT: f64 = 3.2;
/// Points of a line between two directions.
const PIECES: usize = 8;
const INK: &str = "#222";
const GREY: &str = "#555";

/// A row of the legend.
#[derive(Clone, Debug)]
pub struct Kind {
    /// What it is.
    pub name: String,
    /// Its colour.
    pub colour: Rgb,
    /// Its share of the directions that lean by no more than a right angle, per cent.
    pub percent: f64,
}

/// A direction with a name.
#[derive(Clone, Debug)]
pub struct Named {
    /// The name.
    pub name: String,
    /// The direction.
    pub axis: Unit3,
    /// Whether the tool is clear there.
    pub clear: bool,
}

/// What is drawn.
#[non_exhaustive]
pub struct Map<'a> {
    /// The heading.
    pub title: String,
    /// Lines below it.
    pub notes: Vec<String>,
    /// The directions.
    pub directions: &'a Directions,
    /// Of each its row of the legend.
    pub kind_of: &'a [usize],
    /// The legend.
    pub kinds: &'a [Kind],
    /// The outward normal of the face.
    pub normal: Unit3,
    /// Where u and v grow, along the face.
    pub tangents: [Vec3; 2],
    /// Axes of the field.
    pub axes: &'a [Named],
    /// The axes of least lean around the normal; None where there is none.
    pub least: &'a [Option<Unit3>],
}

/// The plane of the map.
#[derive(Clone, Copy)]
struct Round {
    normal: Unit3,
    x: Unit3,
    y: Vec3,
}

impl Round {
    fn new(normal: Unit3, along: &Vec3) -> Self {
        let flat = along - normal.into_inner() * normal.dot(along);
        let x = Unit3::try_new(flat, f64::MIN_POSITIVE).unwrap_or_else(|| any_perpendicular(&normal));
        Self { normal, x, y: normal.cross(&x) }
    }

    /// A direction on the map; one that leans further than a right angle on its rim.
    fn place(&self, axis: &Unit3) -> Place {
        let (a, b) = (axis.dot(&self.x), axis.dot(&self.y));
        let lean = a.hypot(b).atan2(axis.dot(&self.normal));
        polar(lean, b.atan2(a))
    }
}

/// A lean and the turn of it, anticlockwise from the direction of u, on the page.
fn polar(lean_rad: f64, turn_rad: f64) -> Place {
    let r = RADIUS * (lean_rad / FRAC_PI_2).min(1.0);
    let (s, c) = turn_rad.sin_cos();
    [MIDDLE[0] + r * c, MIDDLE[1] - r * s]
}

/// The corners of the cell of a direction: those of the directions that it has next to it, anticlockwise. None for a direction of a row.
fn cell(directions: &Directions, k: usize) -> Option<Vec<Unit3>> {
    let (all, near) = (directions.all(), directions.neighbours(k));
    let own = all[k];
    if near.len() < 3 {
        return None;
    }
    let x = any_perpendicular(&own);
    let y = own.cross(&x);
    let turn = |n: &u32| all[*n as usize].dot(&y).atan2(all[*n as usize].dot(&x));
    let mut around: Vec<u32> = near.to_vec();
    around.sort_by(|a, b| turn(a).total_cmp(&turn(b)));
    let corner = |i: usize| {
        let [a, b] = [around[i], around[(i + 1) % around.len()]].map(|n| all[n as usize].into_inner());
        Unit3::new_normalize(own.into_inner() + a + b)
    };
    Some((0..around.len()).map(corner).collect())
}

impl Map<'_> {
    /// The map as a file of its own.
    pub fn svg(&self) -> String {
        let round = Round::new(self.normal, &self.tangents[0]);
        let mut d = Drawing::default();
        d.text([20.0, 26.0], &self.title, Type { bold: true, ..letters(15.0) });
        for (k, note) in self.notes.iter().enumerate() {
            d.text([20.0, 43.0 + 14.0 * k as f64], note, letters(10.5));
        }
        self.cells(&mut d, &round);
        rings(&mut d);
        self.least_leans(&mut d, &round);
        self.ways(&mut d, &round);
        self.marked(&mut d, &round);
        self.legend(&mut d);
        d.finish(WIDTH, HEIGHT, &self.title)
    }

    /// The directions in their colours.
    fn cells(&self, d: &mut Drawing, round: &Round) {
        let rim = FRAC_PI_2 + self.directions.spacing_rad();
        for (k, kind) in self.kinds.iter().enumerate() {
            let own = self.kind_of.iter().enumerate().filter(|(_, of)| **of == k).map(|(i, _)| i);
            let near = own.filter(|i| self.directions.all()[*i].angle(&self.normal) < rim);
            let (mut cells, mut dots) = (Vec::new(), Vec::new());
            for i in near {
                match cell(self.directions, i) {
                    Some(corners) => {
                        cells.push(corners.iter().map(|c| round.place(c)).collect::<Vec<Place>>());
                    }
                    None => dots.push(round.place(&self.directions.all()[i])),
                }
            }
            if !cells.is_empty() {
                d.areas(cells.iter().map(Vec::as_slice), &hex(kind.colour));
            }
            for dot in dots {
                d.disc(dot, DOT, &hex(kind.colour), pen("none", 0.0));
            }
        }
    }

    /// The least leans around the normal.
    fn least_leans(&self, d: &mut Drawing, round: &Round) {
        let n = self.least.len();
        let pairs = (0..n).filter_map(|k| Some([self.least[k]?, self.least[(k + 1) % n]?]));
        let lines: Vec<Vec<Place>> = pairs
            .map(|[a, b]| {
                let at = |i: usize| {
                    let t = i as f64 / PIECES as f64;
                    round.place(&Unit3::new_normalize(a.into_inner() * (1.0 - t) + b.into_inner() * t))
                };
                (0..=PIECES).map(at).collect()
            })
            .collect();
        d.lines(&lines, pen(INK, 1.1));
    }

    /// Where u, v and the axes of the part point.
    fn ways(&self, d: &mut Drawing, round: &Round) {
        for (name, way) in ["u", "v"].into_iter().zip(&self.tangents) {
            let turn = way.dot(&round.y).atan2(way.dot(&round.x));
            let (s, c) = turn.sin_cos();
            let at = |r: f64| [MIDDLE[0] + r * c, MIDDLE[1] - r * s];
            let tip = at(RADIUS + 17.0);
            let side = |by: f64| {
                let (s, c) = (turn + by).sin_cos();
                [tip[0] - 6.0 * c, tip[1] + 6.0 * s]
            };
            d.lines(&[vec![at(RADIUS + 4.0), tip], vec![side(0.45), tip, side(-0.45)]], pen(INK, 1.2));
            let [x, y] = at(RADIUS + 26.0);
            let word = Type { anchor: Anchor::Middle, bold: true, ..letters(12.0) };
            d.text([x, y + 4.0], name, word);
        }
        for (name, axis) in [("X", Vec3::x_axis()), ("Y", Vec3::y_axis()), ("Z", Vec3::z_axis())] {
            for (sign, axis) in [("+", axis), ("\u{2212}", -axis)] {
                if axis.angle(&self.normal) > FRAC_PI_2 {
                    continue;
                }
                let [x, y] = round.place(&axis);
                let plus = [vec![[x - 3.0, y], [x + 3.0, y]], vec![[x, y - 3.0], [x, y + 3.0]]];
                d.lines(&plus, pen("#fff", 2.4));
                d.lines(&plus, pen(GREY, 1.0));
                let word = Type { halo: true, colour: GREY, ..letters(10.0) };
                d.text([x + 5.0, y + 9.0], &format!("{sign}{name}"), word);
            }
        }
    }

    /// The normal and the axes of the field.
    fn marked(&self, d: &mut Drawing, round: &Round) {
        d.disc(MIDDLE, 2.2, "#fff", pen(INK, 1.0));
        for (k, named) in self.axes.iter().enumerate() {
            let at = round.place(&named.axis);
            d.disc(at, 5.0, "#fff", pen(INK, 1.6));
            if named.clear {
                d.disc(at, 2.0, INK, pen("none", 0.0));
            }
            let word = Type { halo: true, bold: true, ..letters(11.0) };
            // Two names beside one place stand apart.
            let off = if k % 2 == 0 { [8.0, -5.0] } else { [-15.0, 13.0] };
            d.text([at[0] + off[0], at[1] + off[1]], &named.name, word);
        }
    }

    fn legend(&self, d: &mut Drawing) {
        let [x, mut y] = LEGEND;
        d.text([x, y - 6.0], "share of the half sphere", letters(10.5));
        y += 12.0;
        for kind in self.kinds.iter().filter(|k| k.percent > 0.0) {
            let swatch = [[x, y - 9.0], [x + 11.0, y - 9.0], [x + 11.0, y + 1.0], [x, y + 1.0]];
            d.area(&swatch, &hex(kind.colour));
            d.text([x + 18.0, y], &format!("{} %", fixed(kind.percent, 1)), letters(11.0));
            d.text([x + 68.0, y], &kind.name, letters(11.0));
            y += ROW;
        }
        y += 8.0;
        let mark = |d: &mut Drawing, y: f64, clear: bool| {
            d.disc([x + 6.0, y - 4.0], 5.0, "#fff", pen(INK, 1.6));
            if clear {
                d.disc([x + 6.0, y - 4.0], 2.0, INK, pen("none", 0.0));
            }
        };
        for (clear, words) in [(true, "axis of the field"), (false, "axis of the field, NOT clear here")] {
            if self.axes.iter().any(|a| a.clear == clear) {
                mark(d, y, clear);
                d.text([x + 18.0, y], words, letters(11.0));
                y += ROW;
            }
        }
        d.disc([x + 6.0, y - 4.0], 2.2, "#fff", pen(INK, 1.0));
        d.text([x + 18.0, y], "normal of the face; rings: lean off it", letters(11.0));
        y += ROW;
        if self.least.iter().any(Option::is_some) {
            d.lines(&[vec![[x, y - 4.0], [x + 12.0, y - 4.0]]], pen(INK, 1.1));
            d.text([x + 18.0, y], "least lean that is clear, up to 15\u{b0}", letters(11.0));
            y += ROW;
        }
        let plus =
            [vec![[x + 3.0, y - 4.0], [x + 9.0, y - 4.0]], vec![[x + 6.0, y - 7.0], [x + 6.0, y - 1.0]]];
        d.lines(&plus, pen(GREY, 1.0));
        d.text([x + 18.0, y], "axes of the part", letters(11.0));
    }
}

/// The rings of equal lean with their labels.
fn rings(d: &mut Drawing) {
    let ring = |lean_deg: f64| {
        (0..=144)
            .map(|k| polar(lean_deg.to_radians(), 2.0 * PI * f64::from(k) / 144.0))
            .collect::<Vec<Place>>()
    };
    for lean_deg in RINGS_DEG {
        d.lines(&[ring(lean_deg)], pen("#fff", 1.6));
        d.lines(&[ring(lean_deg)], pen(GREY, 0.6));
    }
    d.lines(&[ring(90.0)], pen(INK, 1.2));
    for lean_deg in RINGS_DEG {
        let [x, y] = polar(lean_deg.to_radians(), LABELS_DEG.to_radians());
        let word = Type { anchor: Anchor::Middle, halo: true, ..letters(10.0) };
        d.text([x, y + 3.5], &format!("{lean_deg}\u{b0}"), word);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_is_equidistant_and_seen_from_outside() {
        let normal = Unit3::new_normalize(Vec3::new(0.3, -0.2, 0.9));
        let round = Round::new(normal, &Vec3::new(1.0, 0.2, 0.1));
        let leaning = |deg: f64, way: &Vec3| {
            let (s, c) = deg.to_radians().sin_cos();
            Unit3::new_normalize(normal.into_inner() * c + way * s)
        };
        let near = |a: Place, b: Place| (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-9;
        assert!(near(round.place(&normal), MIDDLE));
        let right = round.place(&leaning(45.0, &round.x));
        assert!(near(right, [MIDDLE[0] + 0.5 * RADIUS, MIDDLE[1]]));
        // A quarter of a turn on, as one sees it from where the normal points, is up.
        let up = round.place(&leaning(30.0, &round.y));
        assert!(near(up, [MIDDLE[0], MIDDLE[1] - RADIUS / 3.0]));
        assert!(round.x.cross(&round.y).dot(&normal) > 0.0);
        // What leans further than a right angle stands on the rim.
        assert!(near(round.place(&leaning(120.0, &round.x)), [MIDDLE[0] + RADIUS, MIDDLE[1]]));
    }

    #[test]
    fn cells_are_around_their_directions_and_of_a_row_there_are_none() {
        let sphere = Directions::icosphere(2).expect("a low level");
        for (k, own) in sphere.all().iter().enumerate() {
            let corners = cell(&sphere, k).expect("five neighbours at least");
            assert_eq!(corners.len(), sphere.neighbours(k).len());
            for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
                // Anticlockwise, and nearer to their own direction than to any other.
                assert!(a.cross(b).dot(own) > 0.0);
                assert!(a.angle(own) < 0.7 * sphere.spacing_rad());
            }
        }
        let row = Directions::row(vec![Vec3::z_axis(), Vec3::x_axis()]).expect("two");
        assert!(cell(&row, 0).is_none());
    }
}
