//! Where a spline surface folds over itself: its normals turn round within a length that no tool resolves.
//!
//! At such a place a face has no depth that means anything, and no bound on a gouge closes: a model is to be mended before it is machined.
//!
//! A Bezier patch whose differences of poles along u, each crossed with each along v, all point into one half space has its normals there
//! too, as they are sums of these products with weights that are not negative. (Of a rational patch that holds in the limit of small pieces,
//! to which it is halved.) What fails this is halved until it is small, and then looked at.

use crate::nurbs::{BezierPatch, NurbsSurface};
use nalgebra::Vector4;
use osculate_geom::{Axis, Box3, Domain, Point3, Surface, Uv, Vec3, uv};
use rayon::prelude::*;

/// Normals that are further apart than this have turned round, as the cosine of 120 deg.
const ROUND_COSINE: f64 = -0.5;
/// Pieces of a patch that are looked at, at most: a patch with a crease all along needs some thousands.
const MOST_PIECES: usize = 20_000;
/// Normals are looked at in this many places along each side of a small piece.
const PLACES: usize = 5;

/// A place where a surface folds over itself.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Fold {
    /// Where: the middle of the piece.
    pub at: Uv,
    /// Where, mm.
    pub point: Point3,
    /// The normals of the piece turn by this, rad.
    pub turn_rad: f64,
    /// The size of the piece, mm.
    pub within_mm: f64,
}

/// What a search for folds found.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Folds {
    /// The places, in the order of the patches, of each patch one.
    pub found: Vec<Fold>,
    /// Patches that were not looked through to the end.
    pub open: usize,
}

/// Where the normals of a surface turn by more than 120 deg within pieces no larger than `within_mm`, at places that `counts`.
///
/// ```
/// use osculate_surfaces::{folds::folds, gallery};
/// // A smooth patch has none: all of it was looked through.
/// let found = folds(&gallery::m86(4), 0.1, &|_| true);
/// assert!(found.found.is_empty() && found.open == 0);
/// ```
#[must_use]
pub fn folds(surface: &NurbsSurface, within_mm: f64, counts: &(dyn Fn(Uv) -> bool + Sync)) -> Folds {
    let patches = surface.bezier_patches();
    let looks: Vec<Look> = patches.par_iter().map(|patch| look(surface, patch, within_mm, counts)).collect();
    let mut out = Folds::default();
    for look in looks {
        match look {
            Look::Smooth => {}
            Look::Folded(fold) => out.found.push(fold),
            Look::Open => out.open += 1,
        }
    }
    out
}

enum Look {
    Smooth,
    Folded(Fold),
    Open,
}

/// A piece of a patch.
struct Piece {
    domain: Domain,
    count: [usize; 2],
    /// Homogeneous, v fastest.
    poles: Vec<Vector4<f64>>,
}

impl Piece {
    fn of(patch: &BezierPatch) -> Self {
        let net = &patch.net;
        let weight = |k: usize| net.weights.as_ref().map_or(1.0, |w| w[k]);
        let pole = |(k, p): (usize, &Point3)| {
            let w = weight(k);
            Vector4::new(p.x * w, p.y * w, p.z * w, w)
        };
        Self {
            domain: patch.domain,
            count: net.count,
            poles: net.points.iter().enumerate().map(pole).collect(),
        }
    }

    fn points(&self) -> Vec<Point3> {
        self.poles.iter().map(|p| Point3::from(p.xyz() / p.w)).collect()
    }

    /// Differences of neighbouring poles along an axis.
    fn steps(&self, points: &[Point3], axis: Axis) -> Vec<Vec3> {
        let [n, m] = self.count;
        let (rows, columns, next) = match axis {
            Axis::U => (n - 1, m, m),
            Axis::V => (n, m - 1, 1),
        };
        let step = |(i, j): (usize, usize)| points[i * m + j + next] - points[i * m + j];
        (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))).map(step).collect()
    }

    /// Whether all products of steps point into one half space; with it the length of the piece along each axis.
    fn is_open(&self) -> (bool, [f64; 2], f64) {
        let points = self.points();
        let [along, across] = [Axis::U, Axis::V].map(|axis| self.steps(&points, axis));
        let sum = |steps: &[Vec3]| steps.iter().fold(Vec3::zeros(), |all, s| all + s);
        let normal = sum(&along).cross(&sum(&across));
        let size = |steps: &[Vec3], lines: usize| steps.iter().map(Vec3::norm).sum::<f64>() / lines as f64;
        let sizes = [size(&along, self.count[1]), size(&across, self.count[0])];
        let open = along.iter().all(|a| across.iter().all(|b| a.cross(b).dot(&normal) > 0.0));
        (open, sizes, Box3::around(&points).diagonal_mm())
    }

    /// Both halves along an axis, by de Casteljau's midpoints.
    fn halves(&self, axis: Axis) -> [Self; 2] {
        let [n, m] = self.count;
        let (lines, length) = match axis {
            Axis::U => (m, n),
            Axis::V => (n, m),
        };
        let place = |line: usize, k: usize| match axis {
            Axis::U => k * m + line,
            Axis::V => line * m + k,
        };
        let (mut low, mut high) = (self.poles.clone(), self.poles.clone());
        let mut row = Vec::with_capacity(length);
        for line in 0..lines {
            row.clear();
            row.extend((0..length).map(|k| self.poles[place(line, k)]));
            for level in 0..length {
                low[place(line, level)] = row[0];
                high[place(line, length - 1 - level)] = row[length - 1 - level];
                for k in 0..length - 1 - level {
                    row[k] = (row[k] + row[k + 1]) * 0.5;
                }
            }
        }
        let (mut first, mut second) = (self.domain, self.domain);
        match axis {
            Axis::U => {
                let middle = 0.5 * (first.u.lo + first.u.hi);
                (first.u.hi, second.u.lo) = (middle, middle);
            }
            Axis::V => {
                let middle = 0.5 * (first.v.lo + first.v.hi);
                (first.v.hi, second.v.lo) = (middle, middle);
            }
        }
        [(first, low), (second, high)].map(|(domain, poles)| Self { domain, count: self.count, poles })
    }
}

fn look(
    surface: &NurbsSurface,
    patch: &BezierPatch,
    within_mm: f64,
    counts: &(dyn Fn(Uv) -> bool + Sync),
) -> Look {
    if patch.net.count.contains(&1) {
        return Look::Smooth;
    }
    let mut left = vec![Piece::of(patch)];
    let mut looked = 0;
    while let Some(piece) = left.pop() {
        looked += 1;
        if looked > MOST_PIECES {
            return Look::Open;
        }
        let (open, sizes, diagonal_mm) = piece.is_open();
        if open {
            continue;
        }
        if diagonal_mm <= within_mm {
            if let Some(fold) = turned(surface, &piece.domain, diagonal_mm, counts) {
                return Look::Folded(fold);
            }
            continue;
        }
        left.extend(piece.halves(if sizes[0] >= sizes[1] { Axis::U } else { Axis::V }));
    }
    Look::Smooth
}

/// The fold in a small piece, if there is one: two of its normals have turned round.
fn turned(
    surface: &NurbsSurface,
    domain: &Domain,
    within_mm: f64,
    counts: &(dyn Fn(Uv) -> bool + Sync),
) -> Option<Fold> {
    let share = |k: usize| (k as f64 + 0.5) / PLACES as f64;
    let place = |k: usize| {
        uv(
            domain.u.lo + share(k / PLACES) * (domain.u.hi - domain.u.lo),
            domain.v.lo + share(k % PLACES) * (domain.v.hi - domain.v.lo),
        )
    };
    let normal = |at: Uv| {
        let jet = surface.jet2(at);
        let n = jet.du.cross(&jet.dv);
        (n.norm() > 0.0).then(|| n.normalize())
    };
    let normals: Vec<Vec3> =
        (0..PLACES * PLACES).map(place).filter(|at| counts(*at)).filter_map(normal).collect();
    let pairs = normals.iter().enumerate().flat_map(|(k, a)| normals[..k].iter().map(move |b| a.dot(b)));
    let least = pairs.fold(1.0, f64::min);
    (least < ROUND_COSINE).then(|| {
        let at = place(PLACES * PLACES / 2);
        Fold { at, point: surface.point(at), turn_rad: least.clamp(-1.0, 1.0).acos(), within_mm }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nurbs::Net;

    fn bicubic(pole: impl Fn(usize, usize) -> [f64; 3]) -> NurbsSurface {
        let knots = vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
        let points = (0..16).map(|k| Point3::from(pole(k / 4, k % 4))).collect();
        let net = Net { count: [4, 4], points, weights: None };
        NurbsSurface::new([3, 3], [knots.clone(), knots], net).expect("a surface")
    }

    /// x(u) runs forward, back by `back` mm and forward again over a floor: where it does, the surface is folded. A cubic with poles 0, 1, d,
    /// 1 + d turns back where its slope 3 [(1 - u)^2 + 2 u (1 - u) (d - 1) + u^2] has zeros: for d < 0.
    fn folded(d: f64) -> NurbsSurface {
        let x = [0.0, 1.0, d, 1.0 + d];
        bicubic(|i, j| [10.0 * x[i], 10.0 * j as f64, 0.001 * i as f64])
    }

    #[test]
    fn a_surface_that_turns_back_is_folded_and_one_that_does_not_is_not() {
        let all = |_: Uv| true;
        for d in [0.05, 0.3, 1.0] {
            assert_eq!(folds(&folded(d), 0.05, &all), Folds::default(), "{d}");
        }
        for d in [-0.01, -0.3] {
            let folds = folds(&folded(d), 0.05, &all);
            let [fold] = folds.found[..] else { panic!("{d}: {folds:?}") };
            // The slope is zero at 1/2 +- sqrt(-d / (4 (2 - d))).
            let off = (-d / (4.0 * (2.0 - d))).sqrt();
            let near = [0.5 - off, 0.5 + off].into_iter().map(|u| (fold.at.u - u).abs()).fold(1.0, f64::min);
            assert!(near < 0.02 && fold.within_mm <= 0.05 && fold.turn_rad > 2.0, "{d}: {fold:?}");
            assert_eq!(folds.open, 0);
        }
        // Outside of what counts there is none.
        assert!(folds(&folded(-0.3), 0.05, &|at: Uv| at.u < 0.2).found.is_empty());
    }

    /// A tube bends through a half turn, and a pole has no tangent plane: neither is a fold.
    #[test]
    fn a_small_radius_and_a_pole_are_no_folds() {
        let turn = [[0.0, 0.0], [4.0, 0.0], [4.0, 0.5], [0.0, 0.5]];
        let tube = bicubic(|i, j| [turn[i][0], 5.0 * j as f64, turn[i][1]]);
        assert_eq!(folds(&tube, 0.02, &|_| true), Folds::default());
        let cap = bicubic(|i, j| {
            let r = 3.0 * i as f64;
            [r * (0.3 * j as f64).cos(), r * (0.3 * j as f64).sin(), -0.1 * r * r]
        });
        assert_eq!(folds(&cap, 0.02, &|_| true), Folds::default());
    }
}
