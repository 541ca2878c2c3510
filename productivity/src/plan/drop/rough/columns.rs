//! Stock as columns along the tool's axis over the nodes of a lattice, and a tool that goes through it from above.
//!
//! A tool's body goes on upwards from its lower side, so that what it leaves of a column is what lies below that: columns only lose their
//! upper parts. Where columns end is known as well as the stock is, to a cell.

use super::super::frame::Frame;
use super::grid::{Disc, Grid};
use super::material::Material;
use osculate_geom::{Box3, Point3};
use osculate_tools::Cutter;
use rayon::prelude::*;

/// A column is looked at in steps of this part of the stock's cells.
const STEP: f64 = 0.75;
/// Halvings of a step where material begins or ends.
const HALVINGS: usize = 3;

/// The stretches of material over each node, ascending, mm along the axis.
#[derive(Clone, Debug)]
pub(super) struct Columns {
    spans: Vec<Vec<[f64; 2]>>,
    /// The upper end of each column; minus infinity where nothing is.
    top: Vec<f64>,
    /// What columns were before they lost something, since a trial began.
    before: Option<Vec<(usize, Vec<[f64; 2]>)>>,
}

/// The upper end of a column.
fn top_of(spans: &[[f64; 2]]) -> f64 {
    spans.last().map_or(f64::NEG_INFINITY, |l| l[1])
}

/// The lower side of a tool as columns meet it: how high it is over the tip at a distance from the axis.
#[derive(Clone, Debug)]
pub(super) struct Underside {
    pub radius_mm: f64,
    core_mm: f64,
    corner_mm: f64,
}

impl Underside {
    /// Of a ball, flat or toroidal end.
    pub fn of(cutter: &Cutter) -> Self {
        Self { radius_mm: cutter.radius_mm(), core_mm: cutter.core_mm(), corner_mm: cutter.corner_mm() }
    }

    /// Height over the tip at a distance within the radius.
    pub fn lift_mm(&self, rho: f64) -> f64 {
        let x = rho - self.core_mm;
        if x <= 0.0 {
            return 0.0;
        }
        self.corner_mm - (self.corner_mm * self.corner_mm - x * x).max(0.0).sqrt()
    }

    pub fn is_flat(&self) -> bool {
        self.corner_mm == 0.0
    }
}

/// Where a line along the axis over a place of the plane is within a box; None beside it.
pub(super) fn within(b: &Box3, frame: &Frame, at: [f64; 2]) -> Option<[f64; 2]> {
    let from = frame.point([at[0], at[1], 0.0]);
    let (mut lo, mut hi) = (f64::NEG_INFINITY, f64::INFINITY);
    for k in 0..3 {
        let d = frame.axis[k];
        if d.abs() < 1e-12 {
            if from[k] < b.min[k] || from[k] > b.max[k] {
                return None;
            }
            continue;
        }
        let (a, c) = ((b.min[k] - from[k]) / d, (b.max[k] - from[k]) / d);
        (lo, hi) = (lo.max(a.min(c)), hi.min(a.max(c)));
    }
    (lo < hi).then_some([lo, hi])
}

impl Columns {
    /// The columns of material over the nodes that are wanted; nothing over the others.
    pub fn of(
        stock: &Material<'_>,
        frame: &Frame,
        grid: &Grid,
        wanted: impl Fn(usize) -> bool + Sync,
    ) -> Self {
        let step = STEP * stock.cell_mm();
        let spans: Vec<Vec<[f64; 2]>> = (0..grid.len())
            .into_par_iter()
            .map(|k| {
                let at = grid.at(k);
                let Some([lo, hi]) = within(stock.bounds(), frame, at).filter(|_| wanted(k)) else {
                    return Vec::new();
                };
                let is = |z: f64| stock.is(&frame.point([at[0], at[1], z]));
                let edge = |mut inside: f64, mut outside: f64| {
                    for _ in 0..HALVINGS {
                        let middle = 0.5 * (inside + outside);
                        if is(middle) { inside = middle } else { outside = middle }
                    }
                    0.5 * (inside + outside)
                };
                let steps = ((hi - lo) / step).ceil().max(1.0) as usize;
                let z = |s: usize| lo + (hi - lo) * (s as f64 + 0.5) / steps as f64;
                let (mut out, mut from): (Vec<[f64; 2]>, Option<f64>) = (Vec::new(), None);
                for s in 0..steps {
                    match (is(z(s)), from) {
                        (true, None) => from = Some(if s == 0 { lo } else { edge(z(s), z(s - 1)) }),
                        (false, Some(begin)) => {
                            out.push([begin, edge(z(s - 1), z(s))]);
                            from = None;
                        }
                        _ => {}
                    }
                }
                out.extend(from.map(|begin| [begin, hi]));
                out
            })
            .collect();
        let top = spans.iter().map(|s| top_of(s)).collect();
        Self { spans, top, before: None }
    }

    /// Begins a trial: all that columns lose from here on comes back with [`Self::restore`].
    pub fn try_out(&mut self) {
        self.before = Some(Vec::new());
    }

    /// Ends a trial, with all columns as they were; each that had lost something is told with its upper end before and after.
    pub fn restore(&mut self, told: &mut impl FnMut(usize, [f64; 2])) {
        let mut before = self.before.take().unwrap_or_default();
        // Of several losses of a column the first one says what it was.
        before.sort_by_key(|(k, _)| *k);
        let mut last = None;
        for (k, spans) in before {
            if last.replace(k) == Some(k) {
                continue;
            }
            let after = std::mem::replace(&mut self.top[k], top_of(&spans));
            told(k, [self.top[k], after]);
            self.spans[k] = spans;
        }
    }

    /// The upper ends of all columns.
    pub fn tops(&self) -> &[f64] {
        &self.top
    }

    pub fn of_node(&self, k: usize) -> &[[f64; 2]] {
        &self.spans[k]
    }

    /// Takes what lies above a height; its length comes back.
    fn lower(&mut self, k: usize, z: f64) -> f64 {
        if self.top[k] <= z {
            return 0.0;
        }
        let spans = &mut self.spans[k];
        if let Some(before) = &mut self.before {
            before.push((k, spans.clone()));
        }
        let mut taken = 0.0;
        while let Some(last) = spans.last_mut() {
            if last[1] <= z {
                break;
            }
            if last[0] < z {
                taken += last[1] - z;
                last[1] = z;
                break;
            }
            taken += last[1] - last[0];
            spans.pop();
        }
        self.top[k] = top_of(spans);
        taken
    }

    /// Moves a tool along a straight piece; the volume that it took comes back, mm3.
    pub fn cut(&mut self, grid: &Grid, tool: &Underside, [from, to]: [[f64; 3]; 2]) -> f64 {
        let d = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
        let long = d[0] * d[0] + d[1] * d[1];
        let r = tool.radius_mm;
        let range = |a: usize| {
            let (lo, hi) = (from[a].min(to[a]) - r, from[a].max(to[a]) + r);
            let node = |x: f64| ((x - grid.lo[a]) / grid.cell).max(0.0);
            // Beyond the lattice a range is empty.
            node(lo).ceil() as usize..((node(hi) + 1.0) as usize).min(grid.n[a])
        };
        let mut taken = 0.0;
        for j in range(1) {
            for i in range(0) {
                let k = j * grid.n[0] + i;
                let at = grid.at(k);
                let w = [at[0] - from[0], at[1] - from[1]];
                let along = if long > 0.0 { (w[0] * d[0] + w[1] * d[1]) / long } else { 0.0 };
                let share = along.clamp(0.0, 1.0);
                let rho = (w[0] - share * d[0]).hypot(w[1] - share * d[1]);
                if rho > r || self.top[k] <= from[2].min(to[2]) {
                    continue;
                }
                // On a slope the tool is over a node for a while, and lowest at one of the ends of that.
                let half = if long > 0.0 { (r * r - rho * rho).max(0.0).sqrt() / long.sqrt() } else { 0.0 };
                let ends = [share, (along - half).clamp(0.0, 1.0), (along + half).clamp(0.0, 1.0)];
                let z = ends.into_iter().map(|s| {
                    let rho = (w[0] - s * d[0]).hypot(w[1] - s * d[1]).min(r);
                    from[2] + s * d[2] + tool.lift_mm(rho)
                });
                taken += self.lower(k, z.fold(f64::INFINITY, f64::min));
            }
        }
        taken * grid.cell * grid.cell
    }

    /// How deep a point lies in material along the axis, no more than `most` either way; negative outside. Between nodes it goes over
    /// from one column to the next.
    pub fn depth_mm(&self, grid: &Grid, [x, y, z]: [f64; 3], most: f64) -> f64 {
        let own = |k: usize| {
            let mut out = -most;
            if self.top[k] > z - most {
                for [a, b] in &self.spans[k] {
                    out = out.max((z - a).min(b - z));
                }
            }
            out.min(most)
        };
        grid.around([x, y]).map_or(-most, |([a, b, c, d], [f, g])| {
            let low = own(a) * (1.0 - f) + own(b) * f;
            let high = own(c) * (1.0 - f) + own(d) * f;
            low * (1.0 - g) + high * g
        })
    }

    /// The upper end of material within a disc around a node.
    pub fn top_in(&self, grid: &Grid, disc: &Disc, k: usize) -> f64 {
        let rows =
            grid.disc(disc, k).map(|row| self.top[row].iter().copied().fold(f64::NEG_INFINITY, f64::max));
        rows.fold(f64::NEG_INFINITY, f64::max)
    }
}

/// The frame's heights of the corners of a box: least and greatest along the axis, and in the plane.
pub(super) fn extent(b: &Box3, frame: &Frame) -> [[f64; 3]; 2] {
    let ends = [b.min, b.max];
    let corners = (0..8).map(|k| frame.of(&Point3::new(ends[k & 1].x, ends[k >> 1 & 1].y, ends[k >> 2].z)));
    corners.fold([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]], |[lo, hi], c| {
        [[0, 1, 2].map(|k| lo[k].min(c[k])), [0, 1, 2].map(|k| hi[k].max(c[k]))]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::{Unit3, Vec3};
    use osculate_tools::CutterSpec;
    use osculate_tools::removal::stock::{Blank, Resolution, Stock};
    use std::f64::consts::PI;

    fn stock() -> (Box3, Stock) {
        let b = Box3 { min: Point3::new(-10.0, -6.0, -4.0), max: Point3::new(10.0, 6.0, 0.0) };
        let resolution = Resolution { cell_mm: 0.4, tri: true, budget_bytes: 1 << 26 };
        (b, Stock::fill(&Blank::Box(b), &resolution).unwrap().stock)
    }

    /// A slot in a block: its section times its length, and the ends of the tool's bottom.
    #[test]
    fn a_slot_takes_its_volume() {
        let (_, stock) = stock();
        let frame = Frame::new(Vec3::z_axis(), &Vec3::x());
        let grid = Grid::over([[-11.0, -7.0], [11.0, 7.0]], 0.1);
        let cases = [
            (CutterSpec::Flat { diameter_mm: 4.0, length_mm: 20.0 }, 4.0),
            (CutterSpec::Ball { diameter_mm: 4.0, length_mm: 20.0 }, PI),
        ];
        for (spec, per_mm) in cases {
            let tool = Underside::of(&Cutter::try_from(spec).unwrap());
            let mut columns = Columns::of(&Material::of(&stock, None), &frame, &grid, |_| true);
            // Through and through: the ends lie outside. Half the radius deep a ball's section is a segment.
            let depth = if tool.is_flat() { 1.0 } else { 2.0 };
            let section = if tool.is_flat() { per_mm * depth } else { 0.5 * per_mm * 4.0 };
            let taken = columns.cut(&grid, &tool, [[-14.0, 0.3, -depth], [14.0, 0.3, -depth]]);
            assert!((taken / (20.0 * section) - 1.0).abs() < 0.02, "{taken} {section}");
            assert_eq!(columns.cut(&grid, &tool, [[-14.0, 0.3, -depth], [14.0, 0.3, -depth]]), 0.0);
            let middle = grid.near([0.0, 0.3]).unwrap();
            assert!((columns.tops()[middle] + depth).abs() < 1e-9);
        }
    }

    /// After a trial everything is as it was, and what was told of it adds up to what was taken.
    #[test]
    fn a_trial_leaves_nothing() {
        let (_, stock) = stock();
        let frame = Frame::new(Vec3::z_axis(), &Vec3::x());
        let grid = Grid::over([[-11.0, -7.0], [11.0, 7.0]], 0.1);
        let ball = CutterSpec::Ball { diameter_mm: 4.0, length_mm: 20.0 };
        let tool = Underside::of(&Cutter::try_from(ball).unwrap());
        let mut columns = Columns::of(&Material::of(&stock, None), &frame, &grid, |_| true);
        columns.cut(&grid, &tool, [[-14.0, -3.0, -0.5], [14.0, -3.0, -0.5]]);
        let (spans, top) = (columns.spans.clone(), columns.top.clone());
        columns.try_out();
        let mut taken = columns.cut(&grid, &tool, [[-14.0, 0.3, -1.0], [14.0, 0.3, -1.0]]);
        // Across the first one, deeper, and through to the underside.
        taken += columns.cut(&grid, &tool, [[1.0, -9.0, -5.0], [1.0, 9.0, -1.0]]);
        assert!(taken > 0.0 && columns.top != top);
        let mut told = 0.0;
        columns.restore(&mut |_, [before, after]| told += before - after.max(-4.0));
        assert!((told * 0.01 / taken - 1.0).abs() < 1e-9, "{told} {taken}");
        assert!(columns.spans == spans && columns.top == top && columns.before.is_none());
    }

    /// Along a direction aslant a box is as thick as its faces say.
    #[test]
    fn columns_aslant_go_from_face_to_face() {
        let (b, stock) = stock();
        let axis = Unit3::new_normalize(Vec3::new(0.5, 0.2, 1.0));
        let frame = Frame::new(axis, &Vec3::x());
        let [lo, hi] = extent(&b, &frame);
        let grid = Grid::over([[lo[0], lo[1]], [hi[0], hi[1]]], 0.5);
        let columns = Columns::of(&Material::of(&stock, None), &frame, &grid, |_| true);
        let volume: f64 = (0..grid.len()).flat_map(|k| columns.of_node(k)).map(|[a, b]| b - a).sum();
        assert!((volume * 0.25 / (20.0 * 12.0 * 4.0) - 1.0).abs() < 0.01, "{}", volume * 0.25);
        let k = grid.near([0.0, 0.0]).unwrap();
        let at = grid.at(k);
        let p = |z: f64| frame.point([at[0], at[1], z]);
        let [a, b] = columns.of_node(k)[0];
        assert!((p(b).z).abs() < 0.1 && (p(a).z + 4.0).abs() < 0.1, "{} {}", p(a), p(b));
        assert!((columns.depth_mm(&grid, [at[0], at[1], b - 0.3], 1.0) - 0.3).abs() < 0.1);
    }
}
