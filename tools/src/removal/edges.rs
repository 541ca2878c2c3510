//! Places beside sharp outer edges, where a depth along one face's normal says nothing.
//!
//! A gouge is deeper than h where the tool takes a point of the part that is farther than h from all of its faces. Along the normal
//! of a face this is read off by how far the tool goes beneath a sample, but for samples beside an outer edge: there the points
//! beneath lie next to the other face as well. A tool that goes a thousandth too deep over a face takes nearly a tenth of a
//! millimetre from the rim of the wall below it, as measured along the wall's normal, and no point of that is deeper than the
//! thousandth. So such places are measured by the distance from the other face too. At inner and at smooth edges nothing changes. A sharp
//! ridge within one face is such an edge as well, and so is what is thinner than the tool went deep.
//!
//! At an open rim of a face, where no other goes on, nothing says what lies beneath. There the material is taken to end along the normals,
//! and that wall counts as another face for the places of its own.
//!
//! Over t beneath a sample the depth is that of `min(t, d(t))`, d the distance from all faces. Distances are to points that were
//! found on these: none is too small. Between two places that were looked at each of the two points found there is as near as it is,
//! whatever the faces do between them: of the way from one place to the other the first point serves up to where both are as far, the
//! second from there, and a distance from a point is greatest at the ends of a way. So bounds rest on points of faces alone, and on
//! nothing about how faces bend. They come near where places are as close together as the depth that is enough: along a wall of 4 mm
//! that is two thousand of them, most of which cost one point of the face between two that are known.

use super::foot::{Beside, Foot, Place, most_mm, nearest};
use super::hints::Hints;
use super::job::{Cut, Sample};
use super::rim::{OpenRim, Rims};
use osculate_geom::{Point3, Surface, Unit3, Uv};
use rayon::prelude::*;
use std::collections::VecDeque;
use std::sync::OnceLock;

/// What lies beneath is nearer to another place than this share of the depth that is asked for; at an inner edge it is as far.
const NEARER: f64 = 0.999;
/// Steps towards the nearest point of another face.
const STEPS: usize = 8;
/// Pieces of what was taken beneath a sample at first ...
const BENEATH: u32 = 4;
/// ... and places in it that are looked at, at most.
const LOOKS: usize = 32_768;
/// At so many of them all faces around are looked at, at others only the one that is near the places next to them.
const AROUND: usize = 128;
/// Steps towards the nearest point from one between two nearest points.
const STEPS_BETWEEN: usize = 3;
/// What is said to be deep may be this share of the limit less.
const CLOSE: f64 = 0.02;
/// Depths below this share of the limit are left as they seem, and others need not be told apart from it where they are below.
const DEEP: f64 = 0.25;
/// Samples that are measured anew at most: beyond it a program is far off wherever it goes.
const MOST: usize = 50_000;

/// Which samples lie beside a sharp outer edge: what lies so far beneath them, along their normals, is nearer to another place of the faces,
/// so that a tool there takes nothing that deep, whatever its depth along the normal. Samples name their faces by number, and are no
/// farther apart than `apart_mm`.
#[must_use]
pub fn beside_edges(
    surfaces: &[&dyn Surface],
    samples: &[Sample],
    apart_mm: f64,
    depth_mm: impl Fn(&Sample) -> f64 + Sync,
) -> Vec<bool> {
    let edges = Edges::new(surfaces, &[], samples, apart_mm);
    samples.par_iter().map(|s| edges.is_beside((&s.point, &s.normal), s.face, depth_mm(s))).collect()
}

/// Measures anew the depths of cuts that seem deeper than a share of the limit, beside sharp outer edges of these faces, as verdicts have
/// them. Samples name their faces by number, and are no farther apart than `apart_mm`.
pub fn measure_beside_edges(
    surfaces: &[&dyn Surface],
    (samples, apart_mm): (&[Sample], f64),
    cuts: &mut [Cut],
    limit_mm: f64,
) {
    Edges::new(surfaces, &[], samples, apart_mm).measure(samples, cuts, limit_mm);
}

/// All faces of a goal, found by place.
pub(super) struct Edges<'a> {
    surfaces: &'a [&'a dyn Surface],
    rims: &'a [OpenRim<'a>],
    samples: &'a [Sample],
    side_mm: f64,
    /// Made when they are first asked for: where nothing is deep, nobody asks.
    hints: OnceLock<(Hints, Rims)>,
}

impl<'a> Edges<'a> {
    /// Faces by number, with samples that are no farther apart than this.
    pub const fn new(
        surfaces: &'a [&'a dyn Surface],
        rims: &'a [OpenRim<'a>],
        samples: &'a [Sample],
        apart_mm: f64,
    ) -> Self {
        Self { surfaces, rims, samples, side_mm: 2.0 * apart_mm, hints: OnceLock::new() }
    }

    fn hints(&self) -> &(Hints, Rims) {
        self.hints.get_or_init(|| {
            let hints = Hints::new(self.samples, self.surfaces.len(), self.side_mm);
            (hints, Rims::new(self.rims, self.side_mm))
        })
    }

    /// Whether an open rim of a face is this near to a place of it, where that is about as far as samples are from each other.
    pub fn is_at_rim(&self, place: &Point3, face: u32, within_mm: f64) -> bool {
        !self.rims.is_empty() && self.hints().1.is_within(self.rims, (place, face), within_mm)
    }

    /// What a number stands for: faces first, then pieces of open rims.
    fn beside(&self, number: u32) -> Beside<'a> {
        let k = number as usize;
        match self.surfaces.get(k) {
            Some(surface) => Beside::Face(*surface),
            None => Beside::Rim(&self.rims[k - self.surfaces.len()]),
        }
    }

    /// Whether the point so far beneath a place of a face lies nearer than that to another place, of this face or another.
    pub fn is_beside(&self, (place, normal): (&Point3, &Unit3), face: u32, depth_mm: f64) -> bool {
        let beneath = place - normal.into_inner() * depth_mm;
        self.foot(&beneath, (place, face), NEARER * depth_mm).mm < NEARER * depth_mm
    }

    /// The place nearest to a point beneath a place of a face, as far as it is found, of all faces and of walls on open rims of this one;
    /// looking ends where it is below `enough_mm`.
    fn foot(&self, q: &Point3, (place, face): (&Point3, u32), enough_mm: f64) -> Foot {
        // Of each face around, its own among them, the nearest sample.
        let near = self.hints().0.nearest(q);
        let mut least = Foot { mm: f64::INFINITY, on: None };
        for (away, other, at) in near {
            let surface = self.surfaces[other as usize];
            let found = nearest(surface, at, q, STEPS);
            for (mm, at) in [(away, at), found] {
                if mm < least.mm {
                    least = Foot { mm, on: Some((other, at, surface.point(at))) };
                }
            }
            if least.mm < enough_mm {
                return least;
            }
        }
        if self.rims.is_empty() {
            return least;
        }
        for k in self.hints().1.near(self.rims, (place, face)) {
            let rim = &self.rims[k as usize];
            let (mm, at) = rim.nearest(q);
            if mm < least.mm {
                least = Foot { mm, on: Some((self.surfaces.len() as u32 + k, at, rim.point(at))) };
            }
        }
        least
    }

    /// A point of the face that two feet are on, and whether it is as near as it was found to come: one between the two where that is no
    /// farther than `enough_mm`.
    fn foot_between(&self, q: &Point3, feet: [&Foot; 2], enough_mm: f64) -> Option<(Foot, bool)> {
        let [Some((face, from, _)), Some((other, to, _))] = feet.map(|f| f.on) else { return None };
        if face != other {
            return None;
        }
        let surface = self.beside(face);
        let at = Uv { u: 0.5 * (from.u + to.u), v: 0.5 * (from.v + to.v) };
        if surface.contains(at) {
            let point = surface.point(at);
            let mm = (point - q).norm();
            if mm <= enough_mm {
                return Some((Foot { mm, on: Some((face, at, point)) }, false));
            }
        }
        let (mm, at) = surface.nearest(at, q, STEPS_BETWEEN);
        mm.is_finite().then(|| (Foot { mm, on: Some((face, at, surface.point(at))) }, true))
    }

    /// No less than how deep the deepest point beneath a sample is that was taken, where the tool went so far along its normal; more by a
    /// share of the limit at most, or no more than `enough_mm`, as long as looks suffice.
    fn depth_mm(&self, s: &Sample, along_mm: f64, (limit_mm, enough_mm): (f64, f64)) -> f64 {
        let beneath = |t: f64| s.point - s.normal.into_inner() * t;
        let look = |t: f64| (t, self.foot(&beneath(t), (&s.point, s.face), 0.0));
        let places: Vec<Place> =
            (0..=BENEATH).map(|k| look(along_mm * f64::from(k) / f64::from(BENEATH))).collect();
        let piece = |a: Place, b: Place| (most_mm(s, [&a, &b]), a, b);
        let mut pieces: VecDeque<_> = places.windows(2).map(|w| piece(w[0], w[1])).collect();
        let mut found = places.iter().map(|p| p.0.min(p.1.mm)).fold(0.0, f64::max);
        let (mut most, mut looks) = (0.0f64, 0);
        // Wide ones first: what is found in them may do for the others.
        while let Some((bound, a, b)) = pieces.pop_front() {
            let enough = enough_mm.max(found + CLOSE * limit_mm);
            if bound <= enough || looks == LOOKS {
                most = most.max(bound);
                continue;
            }
            looks += 1;
            let t = 0.5 * (a.0 + b.0);
            let between = self.foot_between(&beneath(t), [&a.1, &b.1], 0.5 * enough);
            let (foot, nearest) = match between {
                Some(known) if !known.1 || looks > AROUND => known,
                _ => (look(t).1, true),
            };
            if nearest {
                found = found.max(t.min(foot.mm));
            }
            let middle = (t, foot);
            pieces.push_back(piece(a, middle));
            pieces.push_back(piece(middle, b));
        }
        most.max(found)
    }

    /// Measures anew what seems deeper than a share of a limit.
    pub fn measure(&self, samples: &[Sample], cuts: &mut [Cut], limit_mm: f64) {
        let enough_mm = DEEP * limit_mm;
        let deep = samples.iter().zip(cuts).filter(|(_, c)| -c.standoff_mm > enough_mm);
        let deep: Vec<(&Sample, &mut Cut)> = deep.take(MOST).collect();
        deep.into_par_iter().for_each(|(s, c)| {
            let along_mm = limit_mm.min(-c.standoff_mm);
            let own = (s.face as usize) < self.surfaces.len();
            if own && self.is_beside((&s.point, &s.normal), s.face, along_mm) {
                c.standoff_mm = -self.depth_mm(s, -c.standoff_mm, (limit_mm, enough_mm));
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::analytic::Torus;
    use osculate_geom::analytic::{Cylinder, Placed, Placement, Plane};
    use osculate_geom::{Axis, Domain, Interval, Jet2, Patch, Series, Side, Taylor, Vec3, uv};
    use proptest::prelude::*;

    proptest! {
        /// Beneath a place beside the edge of two planes at any angle, against the distance from the other plane.
        #[test]
        fn depths_beside_an_edge_are_no_less_than_the_closed_form(
            inner_rad in 0.3..2.9f64,
            e in 0.01..0.4f64,
            along in 0.02..0.8f64,
            limit in 0.01..0.2f64,
        ) {
            let i = Interval::new(0.0, 6.0);
            let flat = Plane::new(Domain { u: i, v: i });
            // The other plane goes down from the edge at x = 6, the material between them.
            let (sin, cos) = inner_rad.sin_cos();
            let (down, out) = (Vec3::new(-cos, 0.0, -sin), Vec3::new(sin, 0.0, -cos));
            let at = Placement::new(Point3::new(6.0, 0.0, 0.0), Unit3::new_normalize(out), Some(down));
            let wall = Placed { surface: flat, placement: at };
            let surfaces: [&dyn Surface; 2] = [&flat, &wall];
            let sample = |face: u32, at: Uv| {
                let jet = surfaces[face as usize].jet2(at);
                let normal = if face == 0 { Vec3::z_axis() } else { Unit3::new_normalize(out) };
                Sample { point: jet.point, normal, face, uv: at, area_mm2: 0.01, check_only: false }
            };
            let own = sample(0, uv(6.0 - e, 3.0));
            prop_assert!((own.point - Point3::new(6.0 - e, 3.0, 0.0)).norm() < 1e-12);
            let mut samples = vec![own];
            for k in 0..60 {
                for j in 25..36 {
                    let s = sample(1, uv(0.1 * f64::from(k), 0.1 * f64::from(j)));
                    prop_assert!(s.point.z < 1e-9);
                    samples.push(s);
                }
            }
            let edges = Edges::new(&surfaces, &[], &samples, 1.0);
            let found = edges.depth_mm(&own, along, (limit, 0.0));
            let beneath = |t: f64| t.min((e * sin - t * cos).abs());
            let want = (0..=20_000).map(|k| beneath(along * f64::from(k) / 2e4)).fold(0.0, f64::max);
            prop_assert!(found >= want - 1e-9, "{found} of {want}");
            prop_assert!(found <= want + CLOSE * limit + 1e-9, "{found} of {want}");
        }
    }

    /// A flat end goes flush over a face, round or not, and far beyond its edge: beneath the rim of the wall nothing is taken, however far
    /// that goes along the wall's normal.
    #[test]
    fn what_is_flush_is_not_deep() {
        let i = Interval::new(0.0, 6.0);
        let flat = Plane::new(Domain { u: i, v: i });
        let round = Cylinder::new(20.0, i).unwrap();
        // The wall x = 0 below the plane, and that across the cylinder at its end.
        let down = Placement::new(Point3::origin(), -Vec3::x_axis(), Some(-Vec3::z()));
        let wall = Placed { surface: flat, placement: down };
        let end = Plane::new(Domain { u: Interval::new(-20.0, 20.0), v: Interval::new(-20.0, 20.0) });
        for (other, own, normal, rim) in [
            (&flat as &dyn Surface, &wall as &dyn Surface, -Vec3::x_axis(), Point3::new(0.0, 3.0, 0.0)),
            (&round, &end, -Vec3::z_axis(), Point3::new(20.0, 0.0, 0.0)),
        ] {
            let surfaces = [own, other];
            let d = other.domain();
            let mut samples = Vec::new();
            for k in 0..=120 {
                for j in 0..=120 {
                    let at = d.at(f64::from(k) / 120.0, f64::from(j) / 120.0);
                    let jet = other.jet2(at);
                    samples.push(Sample {
                        point: jet.point,
                        normal,
                        face: 1,
                        uv: at,
                        area_mm2: 0.01,
                        check_only: false,
                    });
                }
            }
            let s =
                Sample { point: rim, normal, face: 0, uv: uv(0.0, 0.0), area_mm2: 0.01, check_only: false };
            let found = Edges::new(&surfaces, &[], &samples, 1.5).depth_mm(&s, 4.0, (0.01, 0.0));
            assert!(found <= CLOSE * 0.01, "{found}");
        }
    }

    /// A face over a rectangle, its height a formula.
    struct Sheet<F>(Domain, F);

    impl<F: Fn(Series, Series) -> Series + Send + Sync> Surface for Sheet<F> {
        fn domain(&self) -> Domain {
            self.0
        }
        fn jet2(&self, uv: Uv) -> Jet2 {
            self.taylor(uv, 2).jet2()
        }
        fn point(&self, uv: Uv) -> Point3 {
            let [x, y, z] = self.taylor(uv, 0).coordinates.map(|c| c.coefficient(0, 0));
            Point3::new(x, y, z)
        }
        fn taylor(&self, uv: Uv, order: usize) -> Taylor {
            let (x, y) = (Series::variable(Axis::U, uv.u, order), Series::variable(Axis::V, uv.v, order));
            Taylor { uv, side: Side::Along, coordinates: [x, y, (self.1)(x, y)] }
        }
    }

    /// How far a tool goes along x, the normal of the wall x = 0 turned about.
    const ALONG: f64 = 4.0;

    /// What is found beneath the origin along x beside a face, and what a search finds at so many places: from the best of a grid
    /// ever closer around the best place so far.
    fn along_x(
        face: &dyn Surface,
        (places, [along, across]): (u32, [u32; 2]),
        limit: f64,
    ) -> ([f64; 2], f64) {
        let i = Interval::new(0.0, 6.0);
        let own = Plane::new(Domain { u: i, v: i });
        let surfaces: [&dyn Surface; 2] = [&own, face];
        let d = face.domain();
        let mut samples = Vec::new();
        for k in 0..=along {
            for j in 0..=across {
                let at = d.at(f64::from(k) / f64::from(along), f64::from(j) / f64::from(across));
                let (point, normal) = (face.point(at), Vec3::z_axis());
                samples.push(Sample { point, normal, face: 1, uv: at, area_mm2: 0.01, check_only: false });
            }
        }
        let s = Sample {
            point: Point3::origin(),
            normal: -Vec3::x_axis(),
            face: 0,
            uv: uv(0.0, 0.0),
            area_mm2: 0.01,
            check_only: false,
        };
        let edges = Edges::new(&surfaces, &[], &samples, 0.25);
        let found = [0.0, DEEP * limit].map(|enough| edges.depth_mm(&s, ALONG, (limit, enough)));
        let deep = |k: u32| {
            let t = ALONG * f64::from(k) / f64::from(places);
            let q = Point3::new(t, 0.0, 0.0);
            let mut best = samples
                .iter()
                .map(|s| ((s.point - q).norm(), s.uv))
                .fold((f64::INFINITY, uv(0.0, 0.0)), |a, b| if b.0 < a.0 { b } else { a });
            let mut step = [d.u.length() / f64::from(along), d.v.length() / f64::from(across)];
            for _ in 0..26 {
                for [du, dv] in [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]] {
                    let at = d.bring(uv(best.1.u + du * step[0], best.1.v + dv * step[1]));
                    let away = (face.point(at) - q).norm();
                    if away < best.0 {
                        best = (away, at);
                    }
                }
                step = step.map(|s| 0.5 * s);
            }
            t.min(best.0)
        };
        (found, (0..=places).into_par_iter().map(deep).reduce(|| 0.0, f64::max))
    }

    fn strip() -> Domain {
        Domain { u: Interval::new(-0.5, 5.0), v: Interval::new(-0.5, 0.5) }
    }

    fn check(face: &dyn Surface, places: (u32, [u32; 2]), limit: f64) -> Result<(), TestCaseError> {
        let (found, want) = along_x(face, places, limit);
        for (found, enough) in found.into_iter().zip([0.0, DEEP * limit]) {
            prop_assert!(found >= want - 1e-9, "{found} of {want}");
            prop_assert!(
                found <= (want + CLOSE * limit + 0.5 * ALONG / f64::from(places.0)).max(enough),
                "{found} of {want}"
            );
        }
        Ok(())
    }

    /// Waves that the line meets at the ends and in the middle of every quarter, and twice as short ones: chords say nothing of them.
    #[test]
    fn a_face_that_bends_both_ways_is_no_less_deep() {
        for waves in [4.0, 8.0, 12.0] {
            let turns = waves * std::f64::consts::TAU / ALONG;
            let face = Sheet(strip(), move |x: Series, _| (x * turns).sin_cos().0 * 0.02);
            check(&face, (20_000, [1200, 2]), 0.01).unwrap();
        }
    }

    /// A bump or a hollow in a flat face, off the places that are looked at first and off the middles between them.
    #[test]
    fn a_bump_off_the_middle_is_no_less_deep() {
        for (at, wide, high) in [(1.23, 0.1, 0.02), (2.7, 0.03, -0.05), (0.8, 0.2, 0.3)] {
            let face = Sheet(strip(), move |x: Series, _| {
                let off = (x + Series::constant(-at, x.order())) * (1.0 / wide);
                (off * off + Series::constant(1.0, x.order())).recip() * high
            });
            check(&face, (20_000, [1200, 2]), 0.01).unwrap();
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        #[test]
        fn saddles_are_no_less_deep(
            bends in prop::array::uniform3(-0.05..0.05f64),
            [height, tilt] in [-0.1..0.1f64, -0.05..0.05f64],
        ) {
            let [a, b, c] = bends;
            let face = Sheet(strip(), move |x: Series, y: Series| {
                let off = x + Series::constant(-2.0, x.order());
                Series::constant(height, x.order()) + off * tilt + off * off * a + x * y * b + y * y * c
            });
            check(&face, (400, [240, 24]), 0.02)?;
        }

        /// A cubic patch by its control points.
        #[test]
        fn cubic_patches_are_no_less_deep(
            heights in prop::array::uniform16(-1.0..1.0f64),
            scale in 0.001..1.0f64,
        ) {
            let face = Sheet(strip(), move |x: Series, y: Series| {
                let basis = |t: Series| {
                    let one = Series::constant(1.0, t.order());
                    let r = one - t;
                    [r * r * r, r * r * t * 3.0, r * t * t * 3.0, t * t * t]
                };
                let d = strip();
                let share = |t: Series, i: Interval| {
                    (t - Series::constant(i.lo, t.order())) * (1.0 / i.length())
                };
                let (of_u, of_v) = (basis(share(x, d.u)), basis(share(y, d.v)));
                (0..16).fold(Series::constant(0.0, x.order()), |sum, k| {
                    sum + of_u[k / 4] * of_v[k % 4] * (heights[k] * scale)
                })
            });
            check(&face, (400, [240, 24]), 0.02)?;
        }

        #[test]
        fn tori_are_no_less_deep(major in 8.0..20.0f64, minor in 1.0..2.5f64, lower in -0.05..0.05f64) {
            // The line runs above the outermost circle's top from beside it.
            let torus = Torus::new(major, minor).unwrap();
            let surface = Patch {
                surface: torus,
                domain: Domain { u: Interval::new(1.0, 2.0), v: Interval::new(0.9, 2.2) },
                side: Side::Along,
            };
            let origin = Point3::new(1.0, -major, -minor + lower);
            let placement = Placement::new(origin, Vec3::z_axis(), Some(Vec3::x()));
            check(&Placed { surface, placement }, (400, [240, 24]), 0.02)?;
        }
    }
}
