//! Lines of a course spread evenly over a face.
//!
//! From every line drawn, places at the wanted distance to its left and right are candidates for the next one; what
//! is nearer to a line than nine tenths of the distance is dropped. Where wanted, a line ends as soon as it comes
//! nearer to another than half the distance. In the end every cell of the chart is a candidate, so that no part of the
//! face stays empty [Jobard & Lefer, Creating evenly-spaced streamlines of arbitrary density, 1997].

use super::chart::Chart;
use super::course::Course;
use super::trace::{SurfacePolyline, TraceStops, trace_while};
use osculate_geom::{Axis, Point3, Uv, uv};
use std::cell::RefCell;
use std::collections::{HashMap, VecDeque};

/// How lines are spread.
#[derive(Clone, Debug, PartialEq)]
pub struct Cover {
    /// Wanted distance of neighbouring lines, mm.
    pub spacing_mm: f64,
    /// Whether a line ends where it comes nearer than half the spacing to another one. Without it lines run on to
    /// where they end by themselves, and crowd where the course converges.
    pub ends_early: bool,
    /// Where lines stop.
    pub stops: TraceStops,
    /// Starts that are tried first.
    pub seeds: Vec<Uv>,
    /// Most lines.
    pub most_lines: usize,
}

/// Lines spread over a face.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Covered {
    /// The lines.
    pub lines: Vec<SurfacePolyline>,
    /// Why no more of them were tried.
    pub end: CoverEnd,
}

/// Why no more lines are tried on a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CoverEnd {
    /// No place is left for one.
    Full,
    /// There are as many as asked for at most.
    Most,
    /// Several hundred in a row were shorter than their distance: the course has no lines that mean anything there.
    Stubs,
    /// They have hundreds of thousands of points: the course winds on the scale of noise.
    Points,
}

/// Points of lines in boxes of the spacing's size.
struct Crowd {
    size: f64,
    boxes: HashMap<[i64; 3], Vec<Point3>>,
}

impl Crowd {
    fn key(&self, p: &Point3) -> [i64; 3] {
        [p.x, p.y, p.z].map(|c| (c / self.size).floor() as i64)
    }

    fn add(&mut self, line: &SurfacePolyline, step: f64) {
        let mut since = f64::INFINITY;
        for w in line.points.windows(2) {
            // Long pieces are walked, short ones thinned out.
            let way = w[1].point - w[0].point;
            let (length, mut at) = (way.norm(), 0.0);
            if length <= 0.0 {
                continue;
            }
            if since + length < step {
                since += length;
                continue;
            }
            while at < length {
                let p = w[0].point + way * (at / length);
                self.boxes.entry(self.key(&p)).or_default().push(p);
                at += step;
            }
            since = 0.0;
        }
        if let Some(p) = line.points.last() {
            self.boxes.entry(self.key(&p.point)).or_default().push(p.point);
        }
    }

    /// Whether no point is nearer than `distance`, at most the boxes' size.
    fn is_free(&self, p: &Point3, distance: f64) -> bool {
        let [x, y, z] = self.key(p);
        for dx in -1..=1 {
            for dy in -1..=1 {
                for dz in -1..=1 {
                    let close = |q: &Point3| (q - p).norm_squared() < distance * distance;
                    if self.boxes.get(&[x + dx, y + dy, z + dz]).is_some_and(|b| b.iter().any(close)) {
                        return false;
                    }
                }
            }
        }
        true
    }
}

/// The line under way, so that it does not wind up beside itself.
struct Own {
    spacing: f64,
    /// Whether the second half is under way; its lengths count below zero.
    back: bool,
    reached: f64,
    points: Vec<(Point3, f64)>,
}

impl Own {
    /// Whether a point of the line is away from those that lie further than three spacings behind.
    fn is_free(&mut self, q: &Point3, behind: f64) -> bool {
        // The second half starts at zero again.
        self.back |= behind < self.reached;
        self.reached = behind;
        let at = if self.back { -behind } else { behind };
        let near = CLOSE * self.spacing;
        let close = |(p, s): &(Point3, f64)| {
            (at - s).abs() > 3.0 * self.spacing && (p - q).norm_squared() < near * near
        };
        if self.points.iter().any(close) {
            return false;
        }
        if self.points.last().is_none_or(|(_, s)| (at - s).abs() > 0.2 * self.spacing) {
            self.points.push((*q, at));
        }
        true
    }
}

/// The part of the spacing that must be free at a start.
const FREE: f64 = 0.9;
/// The part of the spacing at which a line ends early.
const CLOSE: f64 = 0.5;

/// So many lines in a row that end before they are a spacing long are the last ones. Faces whose lines mean something have some dozens
/// of them in all; each costs as much as a line.
const MOST_STUBS: usize = 500;
/// With so many points in all, no further lines are tried. Lines of curvature of smooth faces have below a hundred each, and a figure
/// has four hundred at most.
const MOST_POINTS: usize = 300_000;

/// Lines of `course` spread over the face.
#[must_use]
pub fn cover(chart: &Chart, course: Course, how: &Cover) -> Covered {
    let d = how.spacing_mm;
    let mut crowd = Crowd { size: d, boxes: HashMap::new() };
    let mut lines: Vec<SurfacePolyline> = Vec::new();
    let mut queue: VecDeque<Uv> = how.seeds.iter().copied().collect();
    let mut cells = middles(chart).into_iter();
    let (mut stubs, mut points) = (0, 0);
    let end = loop {
        if lines.len() >= how.most_lines {
            break CoverEnd::Most;
        }
        if stubs >= MOST_STUBS {
            break CoverEnd::Stubs;
        }
        if points >= MOST_POINTS {
            break CoverEnd::Points;
        }
        let Some(seed) = queue.pop_front().or_else(|| cells.next()) else { break CoverEnd::Full };
        let p = chart.surface().point(seed);
        if !chart.surface().contains(seed) || !crowd.is_free(&p, FREE * d) {
            continue;
        }
        let line = if how.ends_early {
            let own = RefCell::new(Own { spacing: d, back: false, reached: 0.0, points: Vec::new() });
            let free =
                |q: &Point3, behind: f64| crowd.is_free(q, CLOSE * d) && own.borrow_mut().is_free(q, behind);
            trace_while(chart, course, seed, &how.stops, &free)
        } else {
            trace_while(chart, course, seed, &how.stops, &|_, _| true)
        };
        points += line.points.len();
        // Stubs say nothing and hide the lines around them.
        if line.points.len() < 2 || line.length_mm() < d {
            // Where the course has no direction nothing was followed.
            stubs += usize::from(line.points.len() > 1);
            continue;
        }
        stubs = 0;
        crowd.add(&line, 0.2 * d);
        queue.extend(beside(chart, &line, d));
        lines.push(line);
    };
    Covered { lines, end }
}

/// Middles of the chart's cells, the middle of the face first.
fn middles(chart: &Chart) -> Vec<Uv> {
    let mut out = vec![chart.domain().at(0.5, 0.5)];
    for u in chart.borders(Axis::U).windows(2) {
        for v in chart.borders(Axis::V).windows(2) {
            out.push(uv(0.5 * (u[0] + u[1]), 0.5 * (v[0] + v[1])));
        }
    }
    out
}

/// Places at the spacing to both sides of a line, a spacing apart.
fn beside(chart: &Chart, line: &SurfacePolyline, d: f64) -> Vec<Uv> {
    let (mut out, mut since) = (Vec::new(), f64::INFINITY);
    for w in line.points.windows(2) {
        let way = w[1].point - w[0].point;
        since += way.norm();
        if since < d {
            continue;
        }
        since = 0.0;
        let jet = chart.surface().jet2(w[0].at);
        let Ok(forms) = jet.forms() else { continue };
        let across = forms.normal.cross(&way);
        let Some(across) = osculate_geom::Unit3::try_new(across, 0.0) else { continue };
        let r = forms.rate(&jet, &across);
        for side in [d, -d] {
            let at = uv(w[0].at.u + side * r.u, w[0].at.v + side * r.v);
            if at.u.is_finite() && at.v.is_finite() && chart.domain().contains(at) {
                out.push(chart.domain().bring(at));
            }
        }
    }
    out
}
