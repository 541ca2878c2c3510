//! Where a tool that does not turn would dig in next to its contact [M86, 3C]: undercut regions of a face, along the axis asked for and
//! along the one with the fewest minima of height, as a picture and as arrays.
//!
//! Every place of the grid paints the cell around it.

use super::cells;
use super::drawing::{Drawing, Type, letters, pen};
use super::panel::{self, FRAME, HEIGHT, WIDTH};
use super::scene::Scene;
use super::study::Study;
use crate::report::legend::{Rgb, UNKNOWN, hex};
use crate::words::{minima, number};
use osculate_geom::Surface;
use osculate_productivity::fixed_axis::{Place, Undercut, over};
use osculate_surfaces::TrimmedSurface;
use osculate_surfaces::lines::{Standing, Turn};
use osculate_tools::Cutter;
use serde::Serialize;

/// What can be said of a place.
const STATES: [State; 5] = [
    State { word: "clear", name: "clear", colour: [0xd3, 0xe4, 0xcf] },
    State { word: "tight_contour", name: "contour line too tight", colour: [0x88, 0x22, 0x55] },
    State { word: "too_hollow", name: "too hollow", colour: [0xcc, 0x66, 0x77] },
    State { word: "faces_away", name: "faces away", colour: [0x33, 0x22, 0x88] },
    State { word: "no_tangent", name: "no tangent plane", colour: [0x99, 0x99, 0x33] },
];

/// Places to a node of postures, along each parameter.
pub const FINER: usize = 4;
/// Side of a coloured box of the legend, and the mean width of its letters, px.
const SWATCH: f64 = 9.0;
const LETTER: f64 = 5.9;

/// A word, a name for people, and a colour.
struct State {
    word: &'static str,
    name: &'static str,
    colour: Rgb,
}

/// The place of a state in the list.
const fn state(clear: &Result<f64, Undercut>) -> usize {
    match clear {
        Ok(_) => 0,
        Err(Undercut::TightContour) => 1,
        Err(Undercut::TooHollow) => 2,
        Err(Undercut::FacesAway) => 3,
        Err(Undercut::NoTangent) => 4,
    }
}

/// A face under a tool with a fixed axis.
pub struct FixedAxis<'a> {
    face: &'a TrimmedSurface,
    nodes: usize,
    ways: Vec<Way>,
}

/// One axis.
struct Way {
    standing: Standing,
    places: Vec<Place>,
}

/// The same as arrays, one for each axis: v grows first, then u.
#[derive(Debug, Serialize)]
pub struct Arrays {
    axis: [f64; 3],
    /// From the axis asked for.
    turn_deg: f64,
    /// Of the height, inside the face.
    minima: usize,
    /// Parts of the face's area by state, per cent.
    shares_percent: Vec<Share>,
    /// Nodes along u and along v.
    count: [usize; 2],
    uv: Vec<[f64; 2]>,
    /// Null outside the face.
    state: Vec<Option<&'static str>>,
    /// Smaller eigenvalue of the relative form; null where the tool does not stand.
    relative_min_per_mm: Vec<Option<f64>>,
}

#[derive(Debug, Serialize)]
struct Share {
    state: &'static str,
    percent: f64,
}

impl<'a> FixedAxis<'a> {
    /// The face along the axis asked for and, where another has fewer minima, along that; at places [`FINER`] times as close as the
    /// nodes of postures, since it costs less.
    pub fn of(face: &'a TrimmedSurface, cutter: &Cutter, turn: &Turn, nodes: usize) -> Self {
        let nodes = FINER * nodes;
        let way =
            |standing: Standing| Way { standing, places: over(face, &standing.axis, cutter, [nodes; 2]) };
        let mut ways = vec![way(turn.asked)];
        if turn.fewest.minima < turn.asked.minima {
            ways.push(way(turn.fewest));
        }
        Self { face, nodes, ways }
    }

    /// The arrays.
    pub fn arrays(&self) -> Vec<Arrays> {
        let of = |way: &Way| {
            let shares = shares(way);
            let a = way.standing.axis;
            Arrays {
                axis: [a.x, a.y, a.z],
                turn_deg: way.standing.turn_rad.to_degrees(),
                minima: way.standing.minima,
                shares_percent: STATES
                    .iter()
                    .zip(shares)
                    .map(|(s, percent)| Share { state: s.word, percent })
                    .collect(),
                count: [self.nodes; 2],
                uv: way.places.iter().map(|p| [p.at.u, p.at.v]).collect(),
                state: way.places.iter().map(|p| p.clear.as_ref().map(|c| STATES[state(c)].word)).collect(),
                relative_min_per_mm: way
                    .places
                    .iter()
                    .map(|p| p.clear.as_ref().and_then(|c| c.as_ref().ok().copied()))
                    .collect(),
            }
        };
        self.ways.iter().map(of).collect()
    }

    /// One line for each axis.
    pub fn told(&self) -> Vec<String> {
        self.ways.iter().map(|w| format!("tool held along {}: {}", axis(&w.standing), parts(w))).collect()
    }

    /// The figures side by side.
    pub fn page(&self, study: &Study, scene: &Scene, name: &str) -> String {
        const TOP: f64 = 34.0;
        let mut sheet = Drawing::default();
        sheet.text([FRAME[0], 24.0], name, Type { bold: true, ..letters(15.0) });
        for (k, way) in self.ways.iter().enumerate() {
            sheet.insert(&self.figure(study, scene, way, ["a", "b"][k]), [WIDTH * k as f64, TOP]);
        }
        sheet.finish(
            WIDTH * self.ways.len() as f64,
            TOP + HEIGHT,
            &format!("{name}: a tool that does not turn"),
        )
    }

    fn figure(&self, study: &Study, scene: &Scene, way: &Way, letter: &str) -> Drawing {
        let mut d = Drawing::default();
        let of = |k: usize| way.places[k].clear.as_ref().map(state);
        let colour = |k: usize| of(k).map_or(UNKNOWN, |s| STATES[s].colour);
        let n = self.nodes;
        let at = |i: f64, j: f64| self.face.domain().at(i / n as f64, j / n as f64);
        cells::paint(&mut d, scene, (self.face, [n; 2]), &at, |i, j| colour(i * n + j));
        d.lines(&panel::seen(scene, &study.silhouette(&scene.toward())), pen("#222", 0.8));
        d.lines(&panel::seen(scene, &study.borders), pen("#222", 1.0));
        panel::ornaments(&mut d, study, scene);
        let top = FRAME[1] + FRAME[3] + 30.0;
        d.text([FRAME[0], top], letter, Type { bold: true, ..letters(13.0) });
        let caption = format!("held along {}: {}", axis(&way.standing), minima(way.standing.minima));
        d.text([FRAME[0] + 16.0, top], &caption, letters(13.0));
        let (mut x, y) = (FRAME[0] + 16.0, top + 18.0);
        for (s, known) in STATES.iter().enumerate() {
            if !(0..way.places.len()).any(|k| of(k) == Some(s)) {
                continue;
            }
            let corners = [[x, y - SWATCH], [x + SWATCH, y - SWATCH], [x + SWATCH, y], [x, y]];
            d.area(&corners, &hex(known.colour));
            d.text([x + SWATCH + 5.0, y], known.name, letters(10.5));
            x += SWATCH + 17.0 + LETTER * known.name.len() as f64;
        }
        d
    }
}

/// An axis in words, with how far it is turned.
fn axis(s: &Standing) -> String {
    let [x, y, z] = [s.axis.x, s.axis.y, s.axis.z].map(|x| number(x, 4));
    match s.turn_rad {
        0.0 => format!("{x} {y} {z}"),
        turn => format!("{x} {y} {z} ({} deg off)", number(turn.to_degrees(), 3)),
    }
}

/// Parts of the area in every state, per cent.
fn shares(way: &Way) -> [f64; STATES.len()] {
    let (mut each, mut all) = ([0.0; STATES.len()], 0.0);
    for p in &way.places {
        if let Some(clear) = &p.clear {
            each[state(clear)] += p.weight;
            all += p.weight;
        }
    }
    each.map(|x| if all > 0.0 { 100.0 * x / all } else { 0.0 })
}

/// The shares in words.
fn parts(way: &Way) -> String {
    let of = |(s, x): (&State, f64)| (x > 0.0).then(|| format!("{} % {}", number(x, 3), s.name));
    STATES.iter().zip(shares(way)).filter_map(of).collect::<Vec<_>>().join(", ")
}
