//! The parameter rectangle in cells: what of the face lies in each, which levels of the field pass it, and how far a pass
//! reaches there.

use super::cell::{Cell, Ways};
use super::even::closed_width_mm;
use super::field::Face;
use super::reach::reach;
use crate::plan::seat::Seat;
use crate::plan::{PlanError, Task};
use crate::rectangle::{AXES, lengths};
use osculate_geom::line::LineError;
use osculate_geom::{Axis, Uv, uv};
use rayon::prelude::*;

/// Cells on a face, about; more where knots stand closer.
const CELLS: f64 = 2600.0;
/// Fewest and most cells along one parameter.
const ALONG: [f64; 2] = [12.0, 320.0];
/// Rows of each cell in which the trims are looked for.
const ROWS: usize = 4;
/// Most turns of the boundary with rows of their own.
pub(super) const MOST_TURNS: usize = 200;
/// The share of a reach that is counted on where the face is rough.
const ROUGH: f64 = 0.96;
/// Most nodes along a parameter of the grid for level lines.
const FINEST: usize = 600;
/// How near an extreme of the field a pass must come, of half a strip, and how finely extremes are looked for.
const CLOSE: f64 = 0.75;
const FINE: usize = 9;
const AROUND: u32 = 32;
/// Places around an extreme that lie beyond it where its lines are bent: half of them where they are straight.
const BENT: u32 = 18;
/// Share of the cells without an answer above which there is no plan.
const MOST_LOST: f64 = 0.1;

/// The cells of a face.
pub(super) struct Cells<'a> {
    pub face: Face<'a>,
    pub count: [usize; 2],
    pub cells: Vec<Cell>,
    /// Values of the field at the corners, in rows of v for each u; NaN where there are none.
    corners: Vec<f64>,
    /// Which way the passes run, level by level.
    pub ways: Ways,
    /// Where the face is rough, in a cell or next to it.
    pub rough: Vec<bool>,
    /// Half a strip at the narrowest extreme of the field around which lines bend, mm.
    loops_mm: Option<f64>,
}

/// The place of a fractional cell index.
pub(super) fn place(face: &Face<'_>, count: [usize; 2], i: f64, j: f64) -> Uv {
    face.rectangle.domain.at(i / count[0] as f64, j / count[1] as f64)
}

/// Values of the field at the corners of cells.
fn values(face: &Face<'_>, count: [usize; 2]) -> Vec<f64> {
    (0..(count[0] + 1) * (count[1] + 1))
        .into_par_iter()
        .map(|k| {
            // On a seam both sides have the value of the first, rounding and all.
            let seam = |i: usize, axis: usize| if face.rectangle.closes[axis] { i % count[axis] } else { i };
            let (i, j) = (seam(k / (count[1] + 1), 0), seam(k % (count[1] + 1), 1));
            face.at(place(face, count, i as f64, j as f64)).map_or(f64::NAN, |(.., phi)| phi.value)
        })
        .collect()
}

/// Cells a side: about square on the face, and not much longer than the spans between knots.
pub(super) fn counts(face: &Face<'_>) -> [usize; 2] {
    let surface = face.surface;
    let [a, b] = lengths(surface, &face.rectangle);
    let side = (a * b / CELLS).sqrt();
    let of = |l: f64, axis: Axis| {
        let knots = surface.breaks(axis).len() as f64 - 1.0;
        (l / side).max(knots).clamp(ALONG[0], ALONG[1]).ceil() as usize
    };
    [of(a, Axis::U), of(b, Axis::V)]
}

impl<'a> Cells<'a> {
    /// The cells of a field over a face, with their reaches.
    pub fn new(seat: &Seat<'_>, face: Face<'a>) -> Result<Self, PlanError> {
        let count = counts(&face);
        let corners = values(&face, count);
        let empty = Cell {
            low: f64::INFINITY,
            high: f64::NEG_INFINITY,
            full: false,
            up: [f64::NAN; 2],
            down: [f64::NAN; 2],
            slope_per_mm: f64::NAN,
            peak: f64::INFINITY,
            floor: f64::NEG_INFINITY,
        };
        let mut cells = Self {
            face,
            count,
            cells: vec![empty; count[0] * count[1]],
            corners,
            ways: Ways::Either,
            rough: Vec::new(),
            loops_mm: None,
        };
        cells.find_inside();
        cells.find_extremes();
        cells.find_ways(seat);
        cells.find_rough(seat);
        cells.find_reaches(seat)?;
        Ok(cells)
    }

    /// Where no level line can close, passes run to and fro by level; else a tool with two sides is asked for the worse of them.
    fn find_ways(&mut self, seat: &Seat<'_>) {
        let open = self.face.rectangle.closes == [false; 2];
        let border = |k: usize| {
            let (i, j) = (k / self.count[1], k % self.count[1]);
            i == 0 || j == 0 || i + 1 == self.count[0] || j + 1 == self.count[1]
        };
        let within = |k: usize| !border(k) && self.neighbours(k).all(|m| self.cells[m].full);
        let bends = |k: usize| self.cells[k].inside() && self.cells[k].at_extreme() && within(k);
        if open && !seat.task().cutter.is_ball() && !(0..self.cells.len()).any(bends) {
            self.ways = Ways::ToAndFro { first_reversed: false };
        }
    }

    fn index(&self, i: usize, j: usize) -> usize {
        i * self.count[1] + j
    }

    /// The field inside a cell by its corners, at fractions of its sides.
    fn bilinear(&self, i: usize, j: usize, [f, g]: [f64; 2]) -> f64 {
        let w = self.count[1] + 1;
        let at = |a: usize, b: usize| self.corners[(i + a) * w + j + b];
        (at(0, 0) * (1.0 - g) + at(0, 1) * g) * (1.0 - f) + (at(1, 0) * (1.0 - g) + at(1, 1) * g) * f
    }

    /// The cell of a place, and where in it.
    pub fn locate(&self, at: Uv) -> Option<(usize, [f64; 2])> {
        let at = self.face.rectangle.bring(at)?;
        let part = |axis: Axis, n: usize| {
            let i = self.face.rectangle.domain.get(axis);
            let x = (at.get(axis) - i.lo) / i.length() * n as f64;
            let k = x.floor().clamp(0.0, n as f64 - 1.0);
            (k as usize, x - k)
        };
        let ((i, f), (j, g)) = (part(Axis::U, self.count[0]), part(Axis::V, self.count[1]));
        Some((self.index(i, j), [f, g]))
    }

    /// Marks what lies inside the trims and the field's values there.
    fn find_inside(&mut self) {
        let (surface, domain, n) = (self.face.surface, self.face.rectangle.domain, self.count);
        // Rows across the cells, each with half the width that it stands for; where the boundary turns back in u a row of its own.
        let step = domain.u.length() / (n[0] * ROWS) as f64;
        let mut rows: Vec<(f64, f64)> =
            (0..n[0] * ROWS).map(|r| (domain.u.lo + step * (r as f64 + 0.5), 0.5 / ROWS as f64)).collect();
        let turns = surface.turns();
        rows.extend(turns.iter().take(MOST_TURNS).map(|at| (at.u, 0.0)));
        let cell_of = |v: f64| (v - domain.v.lo) / domain.v.length() * n[1] as f64;
        let spans: Vec<Vec<[f64; 2]>> = rows
            .par_iter()
            .map(|(u, _)| surface.spans(Axis::V, *u).iter().map(|s| [cell_of(s.lo), cell_of(s.hi)]).collect())
            .collect();
        let mut full = vec![0usize; self.cells.len()];
        for ((u, half), row) in rows.iter().zip(&spans) {
            let x = (u - domain.u.lo) / domain.u.length() * n[0] as f64;
            let i = (x.floor().max(0.0) as usize).min(n[0] - 1);
            let f = x - i as f64;
            for [from, to] in row {
                let last = (to.ceil() as usize).clamp(1, n[1]);
                for j in (from.floor().max(0.0) as usize).min(n[1] - 1)..last {
                    let k = self.index(i, j);
                    let g = [(from - j as f64).clamp(0.0, 1.0), (to - j as f64).clamp(0.0, 1.0)];
                    full[k] += usize::from(*half > 0.0 && g[0] <= 1e-9 && g[1] >= 1.0 - 1e-9);
                    for (f, g) in [f - half, f + half].into_iter().flat_map(|f| g.map(|g| (f, g))) {
                        let value = self.bilinear(i, j, [f, g]);
                        let c = &mut self.cells[k];
                        c.low = c.low.min(value);
                        c.high = c.high.max(value);
                    }
                }
            }
        }
        for (c, full) in self.cells.iter_mut().zip(full) {
            c.full = full == ROWS;
        }
        for at in turns {
            if let (Some((k, _)), Some((.., phi))) = (self.locate(at), self.face.at(at)) {
                let c = &mut self.cells[k];
                c.low = c.low.min(phi.value);
                c.high = c.high.max(phi.value);
            }
        }
    }

    /// Finds where the ways up and down through the cells inside end.
    fn find_extremes(&mut self) {
        let mut order: Vec<usize> = (0..self.cells.len()).filter(|k| self.cells[*k].inside()).collect();
        let near = |cells: &Self, k: usize| -> Vec<usize> {
            cells.neighbours(k).filter(|m| cells.cells[*m].inside()).collect()
        };
        order.sort_by(|a, b| self.cells[*a].low.total_cmp(&self.cells[*b].low));
        for k in &order {
            let low = |m: &usize| self.cells[*m].low;
            let lowest = near(self, *k).into_iter().min_by(|a, b| low(a).total_cmp(&low(b)));
            let below = lowest.filter(|m| low(m) < low(k)).map(|m| self.cells[m].floor);
            self.cells[*k].floor = below.unwrap_or(self.cells[*k].low);
        }
        order.sort_by(|a, b| self.cells[*b].high.total_cmp(&self.cells[*a].high));
        for k in &order {
            let high = |m: &usize| self.cells[*m].high;
            let highest = near(self, *k).into_iter().max_by(|a, b| high(a).total_cmp(&high(b)));
            let above = highest.filter(|m| high(m) > high(k)).map(|m| self.cells[m].peak);
            self.cells[*k].peak = above.unwrap_or(self.cells[*k].high);
        }
    }

    /// Marks where the face is rough: elsewhere reaches hold as they are.
    fn find_rough(&mut self, seat: &Seat<'_>) {
        let (face, n) = (self.face, self.count);
        let half = AXES.map(|axis| {
            0.5 * face.rectangle.domain.get(axis).length() / n[usize::from(axis == Axis::V)] as f64
        });
        let own: Vec<bool> = (0..self.cells.len())
            .into_par_iter()
            .map(|k| {
                let at = place(&face, n, (k / n[1]) as f64 + 0.5, (k % n[1]) as f64 + 0.5);
                self.cells[k].inside() && seat.rough_near(at, half)
            })
            .collect();
        self.rough = (0..own.len()).map(|k| own[k] || self.neighbours(k).any(|m| own[m])).collect();
    }

    /// Reaches at the middles of the cells, the least of a cell's own and what lies halfway to its neighbours.
    fn find_reaches(&mut self, seat: &Seat<'_>) -> Result<(), PlanError> {
        let task = seat.task();
        let (face, n) = (self.face, self.count);
        let found: Vec<Option<Result<[Option<f64>; 5], LineError>>> = (0..self.cells.len())
            .into_par_iter()
            .map(|k| {
                self.cells[k].inside().then(|| {
                    let (i, j) = ((k / n[1]) as f64 + 0.5, (k % n[1]) as f64 + 0.5);
                    let r = reach(seat, face, place(&face, n, i, j))?;
                    Ok([r.up[0], r.up[1], r.down[0], r.down[1], Some(r.slope_per_mm)])
                })
            })
            .collect();
        let inside = found.iter().flatten().count();
        if inside == 0 {
            return Err(PlanError::Nothing {
                face: task.face.to_owned(),
                why: "its trim loops leave no inside; check them with inspect".to_owned(),
            });
        }
        // Ripples change from place to place within a cell.
        let sure = |k: usize| if self.rough[k] { ROUGH } else { 1.0 };
        let mut lost = None;
        let mut count = 0;
        let mut values = vec![[f64::NAN; 5]; found.len()];
        for (k, (v, f)) in values.iter_mut().zip(found).enumerate() {
            match f {
                Some(Ok(all)) => {
                    *v = all.map(|x| x.filter(|x| *x > 0.0).unwrap_or(f64::NAN));
                    v[..4].iter_mut().for_each(|x| *x *= sure(k));
                }
                Some(Err(e)) => {
                    count += 1;
                    lost = Some(e);
                }
                None => {}
            }
        }
        if let Some(e) = lost
            && count as f64 > MOST_LOST * inside as f64
        {
            return Err(task.contact(e.into()));
        }
        for q in 0..5 {
            let spread = self.spread(values.iter().map(|v| v[q]).collect());
            if spread.iter().zip(&self.cells).any(|(x, c)| c.inside() && x.is_nan()) {
                return Err(PlanError::Nothing {
                    face: task.face.to_owned(),
                    why: format!(
                        "the tool leaves more than scallop_mm = {} mm beside its own contact everywhere; use a \
                         smaller tool or a larger lead",
                        task.tolerance.scallop_mm
                    ),
                });
            }
            for k in 0..spread.len() {
                let least = self
                    .neighbours(k)
                    .filter(|m| self.cells[*m].inside())
                    .map(|m| 0.5 * (spread[m] + spread[k]))
                    .fold(spread[k], f64::min);
                let c = &mut self.cells[k];
                match q {
                    0 | 1 => c.up[q] = least,
                    2 | 3 => c.down[q - 2] = least,
                    _ => c.slope_per_mm = spread[k],
                }
            }
        }
        if self.ways == Ways::Either {
            for c in &mut self.cells {
                c.up = [c.up[0].min(c.up[1]); 2];
                c.down = [c.down[0].min(c.down[1]); 2];
            }
        }
        for k in 0..self.cells.len() {
            self.bound_extreme(task, k);
        }
        Ok(())
    }

    /// Where the field has an extreme its slope fades, and reaches from the middle of the cell say nothing: the pass next to it
    /// must lie within half a strip of the extreme itself.
    fn bound_extreme(&mut self, task: &Task<'_>, k: usize) {
        let c = self.cells[k];
        if !c.inside() || !c.at_extreme() {
            return;
        }
        // Where the slope fades reaches over it are no widths: the closed form bounds those of the cells around.
        let width = |m: usize| {
            let c = &self.cells[m];
            let at = place(
                &self.face,
                self.count,
                (m / self.count[1]) as f64 + 0.5,
                (m % self.count[1]) as f64 + 0.5,
            );
            let closed = closed_width_mm(task, &self.face, at).unwrap_or(f64::INFINITY);
            closed.min(c.width_mm())
        };
        let around = self.neighbours(k).filter(|m| self.cells[*m].inside());
        let width = around.map(width).fold(width(k), f64::min);
        let half = CLOSE * 0.5 * width;
        let (i, j) = ((k / self.count[1]) as f64, (k % self.count[1]) as f64);
        for (sign, extreme) in [(1.0, c.floor == c.low), (-1.0, c.peak == c.high)] {
            if !extreme {
                continue;
            }
            let value = |at: Uv| self.face.at(at).map(|(_, jet, phi)| (sign * phi.value, at, jet));
            let places = (0..FINE * FINE).map(|m| {
                let part = |m: usize| (m as f64 + 0.5) / FINE as f64;
                place(&self.face, self.count, i + part(m / FINE), j + part(m % FINE))
            });
            let inside = places.filter(|at| self.face.surface.contains(*at));
            let Some((lowest, at, jet)) = inside.filter_map(value).min_by(|a, b| a.0.total_cmp(&b.0)) else {
                continue;
            };
            let Ok(forms) = jet.forms() else { continue };
            let around = (0..AROUND).filter_map(|m| {
                let (s, co) = (std::f64::consts::TAU * f64::from(m) / f64::from(AROUND)).sin_cos();
                let way =
                    forms.frame[0].into_inner() * (half * co) + forms.frame[1].into_inner() * (half * s);
                let by = forms.rate(&jet, &way);
                value(uv(at.u + by.u, at.v + by.v)).map(|v| v.0 - lowest)
            });
            // The furthest level that comes as near as that from any side.
            let (higher, reach) = around.fold((0, 0.0), |(n, b), x| (n + u32::from(x > 0.0), f64::max(b, x)));
            // Lines that bend around the extreme this tightly may slip between the corners of cells.
            if higher >= BENT {
                self.loops_mm = Some(self.loops_mm.map_or(half, |l| l.min(half)));
            }
            let c = &mut self.cells[k];
            if reach > 0.0 && sign > 0.0 {
                c.up = c.up.map(|x| x.min(reach));
            } else if reach > 0.0 {
                c.down = c.down.map(|x| x.min(reach));
            }
        }
    }

    /// The grid on which level lines are found: the cells, or finer ones where lines bend around extremes.
    pub fn nodes(&self) -> ([usize; 2], Vec<f64>) {
        let Some(loops) = self.loops_mm else { return (self.count, self.corners.clone()) };
        let lengths = lengths(self.face.surface, &self.face.rectangle);
        let count = [0, 1].map(|k| {
            ((lengths[k] / (0.5 * loops)).ceil() as usize).clamp(self.count[k], FINEST.max(self.count[k]))
        });
        (count, values(&self.face, count))
    }

    /// The cells next to one, across seams too.
    pub fn neighbours(&self, k: usize) -> impl Iterator<Item = usize> {
        let n = self.count;
        let (i, j) = (k / n[1], k % n[1]);
        let closes = self.face.rectangle.closes;
        let step = move |i: usize, d: i32, axis: usize| -> Option<usize> {
            match (i, d) {
                (0, -1) => closes[axis].then(|| n[axis] - 1),
                (i, -1) => Some(i - 1),
                (i, 1) if i + 1 == n[axis] => closes[axis].then_some(0),
                (i, 1) => Some(i + 1),
                (i, _) => Some(i),
            }
        };
        (-1..=1)
            .flat_map(move |a| (-1..=1).map(move |b| (a, b)))
            .filter(|d| *d != (0, 0))
            .filter_map(move |(a, b)| Some(step(i, a, 0)? * n[1] + step(j, b, 1)?))
    }

    /// Fills cells without a value from their neighbours, ring by ring.
    pub fn spread(&self, mut values: Vec<f64>) -> Vec<f64> {
        let mut open: Vec<usize> = (0..values.len()).filter(|k| values[*k].is_nan()).collect();
        for _ in 0..self.count[0] + self.count[1] {
            let filled: Vec<(usize, f64)> = open
                .iter()
                .filter_map(|k| {
                    let near: Vec<f64> =
                        self.neighbours(*k).map(|m| values[m]).filter(|v| !v.is_nan()).collect();
                    (!near.is_empty()).then(|| (*k, near.iter().sum::<f64>() / near.len() as f64))
                })
                .collect();
            if filled.is_empty() {
                break;
            }
            for (k, v) in &filled {
                values[*k] = *v;
            }
            open.retain(|k| values[*k].is_nan());
        }
        values
    }

    /// Strip width around a place, mm: the reach of passes above and below it, over the field's slope.
    pub fn width_mm(&self, at: Uv) -> f64 {
        self.locate(at).map_or(f64::NAN, |(k, _)| self.cells[k].width_mm())
    }

    /// Whether any of the face lies across a level line at a place, between parameters `from` and `to`.
    pub fn needed(&self, from: Uv, to: Uv, rows: usize) -> bool {
        (0..=rows).any(|r| {
            let f = r as f64 / rows.max(1) as f64;
            let at = uv(from.u + (to.u - from.u) * f, from.v + (to.v - from.v) * f);
            match self.locate(at) {
                Some((k, _)) if self.cells[k].full => true,
                Some((k, _)) if self.cells[k].inside() => {
                    self.face.rectangle.bring(at).is_some_and(|at| self.face.surface.contains(at))
                }
                _ => false,
            }
        })
    }
}
