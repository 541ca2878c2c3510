//! A spline that is nowhere below given values and, with a bounded slope, as low as it can be.
//!
//! The sixteen weights at a place are positive and add up to one: the spline moves there by a mean of the moves of its poles. So when each
//! pole is raised by the most that any place within its reach lacks, no place lacks anything, and when each is lowered by the least that
//! any of them has too much, none falls below its value.

use super::envelope::{Network, raise};
use crate::spline::{Four, Spline};
use osculate_geom::Uv;

/// Rounds in which poles are lowered. (On surface 3 of M86 and a propeller a third as many make passes as long to a thousandth. A spline that
/// begins at the floors, or whose poles are lowered one by one after this, lies closer above them, but follows them down at borders, and axes
/// that lean so fast there ask for 14 passes on that surface where these ask for 12.)
const ROUNDS: u32 = 12;

/// A value that the spline must not be below at a place.
struct Floor {
    four: [Four; 2],
    value: f64,
}

/// The floors of a spline, by the poles that they concern.
pub(super) struct Floors {
    all: Vec<Floor>,
    /// For each pole the floors within its reach.
    near: Vec<Vec<usize>>,
}

impl Floors {
    pub fn new(spline: &Spline) -> Self {
        Self { all: Vec::new(), near: vec![Vec::new(); spline.poles.len()] }
    }

    pub fn add(&mut self, spline: &Spline, at: Uv, value: f64) {
        let four = [spline.bases[0].at(at.u), spline.bases[1].at(at.v)];
        for (a, b) in (0..16).map(|n| (n / 4, n % 4)) {
            if four[0].value[a] * four[1].value[b] > 0.0 {
                self.near[spline.index(four[0].index[a], four[1].index[b])].push(self.all.len());
            }
        }
        self.all.push(Floor { four, value });
    }

    /// By how much the spline is above each floor, negative where it is below.
    fn above(&self, spline: &Spline) -> Vec<f64> {
        self.all.iter().map(|f| spline.first(&f.four[0], &f.four[1]).0 - f.value).collect()
    }

    /// Raises poles until the spline is nowhere below a floor and their slope is at most `slope` per mm.
    pub fn raise(&self, spline: &mut Spline, network: &dyn Network, slope: f64) {
        let above = self.above(spline);
        for (pole, near) in spline.poles.iter_mut().zip(&self.near) {
            *pole += near.iter().map(|k| -above[*k]).fold(0.0, f64::max);
        }
        raise(&mut spline.poles, network, slope);
    }

    /// Lowers poles of a spline that is nowhere below a floor, none below `least`, as far as both stays so; a pole that no floor
    /// concerns follows from its neighbours.
    pub fn lower(&self, spline: &mut Spline, (network, slope): (&dyn Network, f64), least: f64) {
        for _ in 0..ROUNDS {
            let above = self.above(spline);
            for (pole, near) in spline.poles.iter_mut().zip(&self.near) {
                let by = near.iter().map(|k| above[*k].max(0.0)).fold(f64::INFINITY, f64::min);
                *pole = (*pole - by).max(least);
            }
            raise(&mut spline.poles, network, slope);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rectangle::Rectangle;
    use osculate_geom::{Domain, Interval, uv};
    use proptest::prelude::*;

    /// Poles a millimetre apart, with their neighbours along both parameters.
    struct Square(usize);

    impl Network for Square {
        fn around(&self, node: usize, see: &mut dyn FnMut(usize, f64)) {
            let (i, j) = (node / self.0, node % self.0);
            for (x, y) in [(i.wrapping_sub(1), j), (i + 1, j), (i, j.wrapping_sub(1)), (i, j + 1)] {
                if x < self.0 && y < self.0 {
                    see(x * self.0 + y, 1.0);
                }
            }
        }
    }

    fn flat() -> Spline {
        let side = Interval::new(0.0, 6.0);
        let rectangle = Rectangle { domain: Domain { u: side, v: side }, closes: [false; 2] };
        Spline::constant(&rectangle, [6, 6], 0.1)
    }

    fn fitted(needs: &[(Uv, f64)], slope: f64) -> Spline {
        let mut spline = flat();
        let network = Square(spline.bases[0].count());
        let mut floors = Floors::new(&spline);
        needs.iter().for_each(|(at, value)| floors.add(&spline, *at, *value));
        floors.raise(&mut spline, &network, slope);
        let high = spline.clone();
        floors.lower(&mut spline, (&network, slope), 0.1);
        assert!(spline.poles.iter().zip(&high.poles).all(|(low, high)| low <= high));
        spline
    }

    fn lattice(value: impl Fn(f64, f64) -> f64) -> Vec<(Uv, f64)> {
        let half = |k: usize| 0.5 * k as f64;
        (0..13 * 13).map(|k| (half(k / 13), half(k % 13))).map(|(u, v)| (uv(u, v), value(u, v))).collect()
    }

    proptest! {
        /// Nowhere below a floor, no pole below the least, no steeper than the slope.
        #[test]
        fn floors_and_slopes_are_kept(
            all in prop::collection::vec((0.0..6.0f64, 0.0..6.0f64, 0.1..0.8f64), 1..80),
            slope in 0.02..0.5f64,
        ) {
            let needs: Vec<(Uv, f64)> = all.iter().map(|(u, v, value)| (uv(*u, *v), *value)).collect();
            let spline = fitted(&needs, slope);
            for (at, value) in &needs {
                // Sums of some dozens of terms below one.
                prop_assert!(spline.jet(*at).value >= value - 1e-13);
            }
            prop_assert!(spline.poles.iter().all(|p| *p >= 0.1));
            let network = Square(spline.bases[0].count());
            for (k, pole) in spline.poles.iter().enumerate() {
                network.around(k, &mut |next, _| {
                    assert!((pole - spline.poles[next]).abs() <= slope * (1.0 + 1e-12));
                });
            }
        }
    }

    /// Over a plane and a parabola the spline lies above by less, in the mean, than half of what they change by within the reach of a
    /// pole, two steps along either parameter; and over what is the same everywhere by nothing.
    #[test]
    fn smooth_needs_are_met_closely() {
        let ramp = lattice(|u, v| 0.2 + 0.05 * u + 0.02 * v);
        let bowl = lattice(|u, v| 0.2 + 0.02 * ((u - 3.0).powi(2) + 0.5 * (v - 2.0).powi(2)));
        for (needs, most) in [(ramp, 0.07), (bowl, 0.16), (lattice(|_, _| 0.3), 1e-12)] {
            let spline = fitted(&needs, 0.5);
            let over = needs.iter().map(|(at, need)| spline.jet(*at).value - need);
            let mean = over.sum::<f64>() / needs.len() as f64;
            assert!(mean < most, "{mean}");
        }
    }
}
