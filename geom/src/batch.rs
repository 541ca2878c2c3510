//! Jets and curvatures of many places at once, as a structure of arrays in blocks of [`LANES`] places.
//!
//! A [`JetBlock`] holds every component of eight jets in an array of its own, so that a formula over it is a
//! loop over eight neighbours. [`JetBlock::curvatures`] has the arithmetic of [`crate::Forms`] and
//! [`crate::Principal`]; both agree to the last few units in the last place.
//!
//! Curvature is positive where the body is convex, with the normal out of the material, as everywhere.

use crate::forms::{Degenerate, MIN_SIN_UV, Principal};
use crate::jet::{Jet2, Side};
use crate::lanes::{LANES, Lanes, Lanes3, cross, dot, times};
use crate::point::{Point3, Unit3, Uv, Vec3, uv};
use crate::surface::Surface;

/// Eight numbers.
pub type Lane = Lanes<LANES>;

/// Eight jets.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct JetBlock {
    /// Parameters u and v.
    pub uv: [Lane; 2],
    /// x, y and z of S (mm), S_u, S_v, S_uu, S_uv and S_vv.
    pub orders: [Lanes3<LANES>; 6],
    /// `+1` where the outward normal is along `S_u x S_v`, else `-1`.
    pub side: Lane,
}

impl JetBlock {
    /// Puts a jet into a lane.
    ///
    /// # Panics
    /// For a lane from [`LANES`] on.
    #[inline]
    pub fn set(&mut self, lane: usize, jet: &Jet2) {
        self.uv[0].0[lane] = jet.uv.u;
        self.uv[1].0[lane] = jet.uv.v;
        for (order, v) in
            self.orders.iter_mut().zip([&jet.point.coords, &jet.du, &jet.dv, &jet.duu, &jet.duv, &jet.dvv])
        {
            for c in 0..3 {
                order[c].0[lane] = v[c];
            }
        }
        self.side.0[lane] = jet.side.sign();
    }

    /// The jet in a lane.
    ///
    /// # Panics
    /// For a lane from [`LANES`] on.
    #[inline]
    #[must_use]
    pub fn get(&self, lane: usize) -> Jet2 {
        let v = |k: usize| {
            let [x, y, z] = &self.orders[k];
            Vec3::new(x.0[lane], y.0[lane], z.0[lane])
        };
        Jet2 {
            uv: uv(self.uv[0].0[lane], self.uv[1].0[lane]),
            point: Point3::from(v(0)),
            du: v(1),
            dv: v(2),
            duu: v(3),
            duv: v(4),
            dvv: v(5),
            side: if self.side.0[lane] < 0.0 { Side::Against } else { Side::Along },
        }
    }

    /// Copies a lane to a lane of another block.
    ///
    /// # Panics
    /// For a lane from [`LANES`] on.
    #[inline(always)]
    pub fn copy_lane(&self, lane: usize, to: &mut Self, to_lane: usize) {
        for k in 0..2 {
            to.uv[k].0[to_lane] = self.uv[k].0[lane];
        }
        for (a, b) in self.orders.iter().zip(&mut to.orders) {
            for c in 0..3 {
                b[c].0[to_lane] = a[c].0[lane];
            }
        }
        to.side.0[to_lane] = self.side.0[lane];
    }

    /// Principal curvatures and directions of all lanes.
    ///
    /// Half angles by square roots instead of trigonometry: with `c = cos 2a`, `s = sin 2a` the direction is
    /// `(sqrt((1 + c) / 2), s / sqrt(2 (1 + c)))` for c >= 0 and the mirrored form for c < 0, so that nothing
    /// cancels.
    #[inline(always)]
    #[must_use]
    pub fn curvatures(&self) -> CurvatureBlock {
        let [_, su, sv, suu, suv, svv] = &self.orders;
        let one = Lane::splat(1.0);
        let half = Lane::splat(0.5);
        let normal = cross(su, sv);
        let (aa, gg, area) = (dot(su, su), dot(sv, sv), dot(&normal, &normal).sqrt());
        let a = aa.sqrt();
        // |S_u x S_v| / (|S_u| |S_v|), 0/0 where one vanishes: fails the comparison below as well.
        let sin_uv = area / (a * gg.sqrt());
        let n = times(&normal, self.side / area);
        let e1 = times(su, one / a);
        let e2 = cross(&n, &e1);
        let (p, q) = (dot(sv, &e1), dot(sv, &e2));
        let (l, m, nn) = (dot(suu, &n), dot(suv, &n), dot(svv, &n));
        let w11 = l / aa;
        let w12 = (m / a - p * w11) / q;
        let w22 = (nn - (p + p) * q * w12 - p * p * w11) / (q * q);
        let (w11, w12, w22) = (-w11, -w12, -w22);
        let mean = half * (w11 + w22);
        let diff = half * (w11 - w22);
        let radius = (diff * diff + w12 * w12).sqrt();
        let safe = radius.map(|r| if r > 0.0 { r } else { 1.0 });
        let c = diff.with(radius, |d, r| if r > 0.0 { d } else { 1.0 }) / safe;
        let s = w12 / safe;
        // The larger of cosine and sine of the half angle, at least sqrt(1/2), and the other one from it.
        let large = (half * (one + c.map(f64::abs))).sqrt();
        let small = half * s / large;
        let co = c.with(large, |c, x| if c >= 0.0 { x } else { 0.0 })
            + c.with(small, |c, x| if c < 0.0 { x.abs() } else { 0.0 });
        let si = c.with(small, |c, x| if c >= 0.0 { x } else { 0.0 })
            + c.with(large.with(s, |x, s| x.copysign(s)), |c, x| if c < 0.0 { x } else { 0.0 });
        let valid = sin_uv.map(|x| if x > MIN_SIN_UV && x.is_finite() { 0.0 } else { f64::NAN });
        let along =
            |x: Lane, y: Lane| -> Lanes3<LANES> { std::array::from_fn(|k| e1[k] * x + e2[k] * y + valid) };
        CurvatureBlock {
            uv: self.uv,
            k_max: mean + radius + valid,
            k_min: mean - radius + valid,
            d_max: along(co, si),
            d_min: along(-si, co),
            normal: std::array::from_fn(|k| n[k] + valid),
            sin_uv,
        }
    }
}

/// Principal curvatures of eight places; all of a lane is NaN where there is no tangent plane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct CurvatureBlock {
    /// Parameters u and v.
    pub uv: [Lane; 2],
    /// The most convex normal curvature, 1/mm.
    pub k_max: Lane,
    /// The least convex normal curvature, 1/mm.
    pub k_min: Lane,
    /// Its components: the unit direction of `k_max`.
    pub d_max: Lanes3<LANES>,
    /// The unit direction of `k_min`, `n x d_max` up to sign.
    pub d_min: Lanes3<LANES>,
    /// The outward unit normal.
    pub normal: Lanes3<LANES>,
    /// Sine of the angle between S_u and S_v.
    pub sin_uv: Lane,
}

impl CurvatureBlock {
    /// The principal curvatures in a lane.
    ///
    /// # Errors
    /// [`Degenerate`] where S_u and S_v are parallel or vanish.
    ///
    /// # Panics
    /// For a lane from [`LANES`] on.
    pub fn get(&self, lane: usize) -> Result<Principal, Degenerate> {
        let sin_uv = self.sin_uv.0[lane];
        if self.k_max.0[lane].is_nan() {
            let at = uv(self.uv[0].0[lane], self.uv[1].0[lane]);
            return Err(Degenerate { at, sin_uv: if sin_uv.is_nan() { 0.0 } else { sin_uv } });
        }
        let unit =
            |v: &Lanes3<LANES>| Unit3::new_unchecked(Vec3::new(v[0].0[lane], v[1].0[lane], v[2].0[lane]));
        Ok(Principal {
            k_max: self.k_max.0[lane],
            k_min: self.k_min.0[lane],
            d_max: unit(&self.d_max),
            d_min: unit(&self.d_min),
        })
    }
}

/// Blocks that hold this many places.
#[must_use]
pub const fn block_count(places: usize) -> usize {
    places.div_ceil(LANES)
}

/// Jets of any surface in blocks, one after the other, replacing what `out` held: what a surface without a
/// faster way of its own does. The last block is filled up with its last place.
///
/// ```
/// use osculate_geom::{Surface, analytic::Torus, batch, uv};
/// // Ten places of a ring in two blocks: the same curvatures as one at a time.
/// let ring = Torus::new(200.0, 60.0)?;
/// let places: Vec<_> = (0..10).map(|k| uv(0.1, 0.3 * f64::from(k))).collect();
/// let mut blocks = Vec::new();
/// batch::jets_into(&ring, &places, &mut blocks);
/// assert_eq!(blocks.len(), batch::block_count(places.len()));
/// let (ninth, alone) = (blocks[1].curvatures().get(0)?, ring.jet2(places[8]).forms()?.principal());
/// assert!((ninth.k_min - alone.k_min).abs() < 1e-15 && (ninth.k_max - alone.k_max).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn jets_into<S: Surface + ?Sized>(surface: &S, at: &[Uv], out: &mut Vec<JetBlock>) {
    out.resize(block_count(at.len()), JetBlock::default());
    for (places, block) in at.chunks(LANES).zip(out) {
        let mut jet = surface.jet2(places[0]);
        block.set(0, &jet);
        for lane in 1..LANES {
            if let Some(place) = places.get(lane) {
                jet = surface.jet2(*place);
            }
            block.set(lane, &jet);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::{Ellipsoid, Torus};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn blocks_agree_with_one_place_at_a_time(
            places in proptest::collection::vec((0.0f64..6.2, -1.5f64..1.5), 1..20), turned in any::<bool>(),
        ) {
            let at: Vec<Uv> = places.iter().map(|(u, v)| uv(*u, *v)).collect();
            let shapes: [&dyn Surface; 2] =
                [&Torus::new(40.0, 9.0).unwrap(), &Ellipsoid::new([3.0, 2.0, 1.0]).unwrap()];
            for shape in shapes {
                let shape = crate::surface::Flipped(shape);
                let surface: &dyn Surface = if turned { &shape } else { shape.0 };
                let mut blocks = Vec::new();
                jets_into(surface, &at, &mut blocks);
                for (k, at) in at.iter().enumerate() {
                    let jet = surface.jet2(*at);
                    prop_assert_eq!(blocks[k / LANES].get(k % LANES), jet);
                    let one = jet.forms().unwrap().principal();
                    let eight = blocks[k / LANES].curvatures().get(k % LANES).unwrap();
                    let size = one.k_max.abs().max(one.k_min.abs());
                    // Some twenty roundings.
                    prop_assert!((one.k_max - eight.k_max).abs() <= 1e-14 * size);
                    prop_assert!((one.k_min - eight.k_min).abs() <= 1e-14 * size);
                    // A direction turns by the error of W over the difference of the curvatures.
                    let turn = 1e-14 * size / (one.k_max - one.k_min).max(1e-12 * size);
                    prop_assert!(one.d_max.cross(&eight.d_max).norm() <= turn + 1e-15);
                    prop_assert!((eight.d_min.norm() - 1.0).abs() < 4e-15 && (eight.d_max.norm() - 1.0).abs() < 4e-15);
                    prop_assert!(eight.d_max.dot(&eight.d_min).abs() < 4e-15);
                }
            }
        }
    }

    #[test]
    fn a_place_without_tangent_plane_is_refused_alone() {
        let e = Ellipsoid::new([3.0, 2.0, 1.0]).unwrap();
        let mut blocks = Vec::new();
        jets_into(&e, &[uv(0.3, 0.2), uv(0.3, std::f64::consts::FRAC_PI_2)], &mut blocks);
        let mut block = blocks[0];
        block.orders[1].iter_mut().for_each(|c| c.0[1] = 0.0);
        let k = block.curvatures();
        assert!(k.get(0).is_ok());
        assert_eq!(k.get(1).unwrap_err().sin_uv, 0.0);
    }
}
