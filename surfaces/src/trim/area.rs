//! Integrals over the inside of a trimmed rectangle.
//!
//! The rectangle is cut at the surface's breaks into cells. A cell without boundary is integrated by Gauss panels; in
//! a cell that the boundary crosses, columns between the boundary's vertices have straight limits, so that Gauss points
//! in the column and along its inside spans are exact up to the smoothness of the integrand.

use super::region::Region;
use osculate_geom::quadrature::GAUSS5;
use osculate_geom::{Axis, Jet2, Surface, uv};

/// Nodes and weights of the 2-point rule: columns between the vertices of a fine polyline are narrow.
const GAUSS2: [(f64, f64); 2] = [(0.211_324_865_405_187_1, 0.5), (0.788_675_134_594_812_9, 0.5)];

/// Halvings of a cell at most in each direction.
const MAX_DEPTH: u32 = 5;

/// Halvings of cells at most in all, or so many for each cell: a surface of noise is not followed further.
const MOST_HALVED: usize = 100_000;
const HALVED_EACH: usize = 8;

/// A cell of the rectangle.
#[derive(Clone, Copy)]
pub(crate) struct Cell {
    pub(crate) u: [f64; 2],
    pub(crate) v: [f64; 2],
}

impl Cell {
    fn quarters(self) -> [Self; 4] {
        let (mu, mv) = (0.5 * (self.u[0] + self.u[1]), 0.5 * (self.v[0] + self.v[1]));
        [
            Self { u: [self.u[0], mu], v: [self.v[0], mv] },
            Self { u: [self.u[0], mu], v: [mv, self.v[1]] },
            Self { u: [mu, self.u[1]], v: [self.v[0], mv] },
            Self { u: [mu, self.u[1]], v: [mv, self.v[1]] },
        ]
    }
}

/// Integral of `f dA` over the inside of `region` (everything where there is none), refined until halving a cell
/// changes its part by less than `relative` of the running total.
pub(crate) fn integrate(
    surface: &dyn Surface,
    breaks: [&[f64]; 2],
    region: Option<&Region>,
    relative: f64,
    f: &dyn Fn(&Jet2) -> f64,
) -> f64 {
    let density = |u: f64, v: f64| {
        let jet = surface.jet2(uv(u, v));
        let area = jet.du.cross(&jet.dv).norm();
        if area > 0.0 { area * f(&jet) } else { 0.0 }
    };
    let cells: Vec<Cell> = breaks[0]
        .windows(2)
        .flat_map(|u| breaks[1].windows(2).map(|v| Cell { u: [u[0], u[1]], v: [v[0], v[1]] }))
        .collect();
    let coarse: f64 = cells.iter().map(|c| panel(*c, &density).abs()).sum();
    let allowed = relative * coarse / (cells.len() as f64).sqrt().max(1.0);
    let mut left = MOST_HALVED.max(HALVED_EACH * cells.len());
    cells.iter().map(|c| cell(*c, region, &density, allowed, (0, &mut left))).sum()
}

fn cell(
    c: Cell,
    region: Option<&Region>,
    density: &dyn Fn(f64, f64) -> f64,
    allowed: f64,
    (depth, left): (u32, &mut usize),
) -> f64 {
    let whole = panel(c, density);
    let parts = c.quarters().map(|q| panel(q, density));
    let halved: f64 = parts.iter().sum();
    if (halved - whole).abs() > allowed && depth < MAX_DEPTH && *left > 0 {
        *left -= 1;
        let quarters = c.quarters().into_iter();
        return quarters.map(|q| cell(q, region, density, 0.5 * allowed, (depth + 1, &mut *left))).sum();
    }
    match region {
        None => halved,
        Some(region) => match crossing(c, region) {
            Crossing::Inside => halved,
            Crossing::Outside => 0.0,
            Crossing::Cut(columns) => clipped(c, region, density, &columns),
        },
    }
}

fn panel(c: Cell, density: &dyn Fn(f64, f64) -> f64) -> f64 {
    let (du, dv) = (c.u[1] - c.u[0], c.v[1] - c.v[0]);
    let mut sum = 0.0;
    for (x, wx) in GAUSS5 {
        for (y, wy) in GAUSS5 {
            sum += wx * wy * density(c.u[0] + du * x, c.v[0] + dv * y);
        }
    }
    sum * du * dv
}

/// How the boundary passes through a cell.
pub(crate) enum Crossing {
    /// Not at all, the cell is inside.
    Inside,
    /// Not at all, the cell is outside.
    Outside,
    /// Ends of the columns with straight limits.
    Cut(Vec<f64>),
}

/// Looks at a cell.
pub(crate) fn crossing(c: Cell, region: &Region) -> Crossing {
    let mut columns = vec![c.u[0], c.u[1]];
    let mut touched = false;
    for (a, b) in region.segments() {
        let (ulo, uhi) = (a.u.min(b.u), a.u.max(b.u));
        let (vlo, vhi) = (a.v.min(b.v), a.v.max(b.v));
        if uhi <= c.u[0] || ulo >= c.u[1] || vhi <= c.v[0] || vlo >= c.v[1] {
            // A vertical piece along the cell's own side does not enter it either.
            continue;
        }
        touched = true;
        columns.extend([a.u, b.u]);
        // Where the piece passes the lower or upper side of the cell, the limits have a corner.
        for side in c.v {
            if (a.v - side) * (b.v - side) < 0.0 {
                columns.push(a.u + (side - a.v) / (b.v - a.v) * (b.u - a.u));
            }
        }
    }
    if !touched {
        let middle = uv(0.5 * (c.u[0] + c.u[1]), 0.5 * (c.v[0] + c.v[1]));
        return if region.inside(middle) { Crossing::Inside } else { Crossing::Outside };
    }
    columns.retain(|u| *u >= c.u[0] && *u <= c.u[1]);
    columns.sort_by(f64::total_cmp);
    columns.dedup();
    Crossing::Cut(columns)
}

fn clipped(c: Cell, region: &Region, density: &dyn Fn(f64, f64) -> f64, columns: &[f64]) -> f64 {
    let mut sum = 0.0;
    for w in columns.windows(2) {
        let width = w[1] - w[0];
        if width <= 0.0 {
            continue;
        }
        let mut add = |x: f64, weight: f64| {
            let u = w[0] + width * x;
            for span in region.spans(Axis::V, u) {
                let (lo, hi) = (span.lo.max(c.v[0]), span.hi.min(c.v[1]));
                if hi > lo {
                    for (y, wy) in GAUSS5 {
                        sum += weight * width * (hi - lo) * wy * density(u, lo + (hi - lo) * y);
                    }
                }
            }
        };
        // Wide columns lie between few vertices: the integrand's own shape decides there.
        if width > 0.05 * (c.u[1] - c.u[0]) {
            GAUSS5.iter().for_each(|(x, wx)| add(*x, *wx));
        } else {
            GAUSS2.iter().for_each(|(x, wx)| add(*x, *wx));
        }
    }
    sum
}
