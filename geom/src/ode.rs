//! One step of an autonomous ordinary differential equation `y' = f(y)`: fifth order, with an error estimate and
//! dense output.
//!
//! The pair of Dormand & Prince (1980): seven slopes, the last one being the first of the next step. The error
//! estimate is the difference from an embedded formula of fourth order; the dense output is Hairer's of fourth order
//! [Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I, sections II.5 and II.6]. A step knows no
//! events and no signs: who follows a field of directions without sense settles the sense in `f`.

/// A finished step of length `h` from `start` to `end`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OdeStep<const N: usize> {
    /// State at the start.
    pub start: [f64; N],
    /// State at the end, of fifth order.
    pub end: [f64; N],
    /// Slope at the end: the first slope of the next step.
    pub end_slope: [f64; N],
    /// Estimated error of `end`, by component: the embedded formula's of fourth order, hence too large rather than
    /// too small.
    pub error: [f64; N],
    /// Length of the step in the independent variable.
    pub h: f64,
    /// Hairer's coefficients of the dense output beyond `start`.
    dense: [[f64; N]; 4],
}

/// Rows of the tableau below the diagonal.
const A: [&[f64]; 6] = [
    &[1.0 / 5.0],
    &[3.0 / 40.0, 9.0 / 40.0],
    &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
    &[19_372.0 / 6_561.0, -25_360.0 / 2_187.0, 64_448.0 / 6_561.0, -212.0 / 729.0],
    &[9_017.0 / 3_168.0, -355.0 / 33.0, 46_732.0 / 5_247.0, 49.0 / 176.0, -5_103.0 / 18_656.0],
    &[35.0 / 384.0, 0.0, 500.0 / 1_113.0, 125.0 / 192.0, -2_187.0 / 6_784.0, 11.0 / 84.0],
];

/// Fifth-order weights less fourth-order ones.
const E: [f64; 7] = [
    71.0 / 57_600.0,
    0.0,
    -71.0 / 16_695.0,
    71.0 / 1_920.0,
    -17_253.0 / 339_200.0,
    22.0 / 525.0,
    -1.0 / 40.0,
];

/// Weights of the slopes in the last coefficient of the dense output.
const D: [f64; 7] = [
    -12_715_105_075.0 / 11_282_082_432.0,
    0.0,
    87_487_479_700.0 / 32_700_410_799.0,
    -10_690_763_975.0 / 1_880_347_072.0,
    701_980_252_875.0 / 199_316_789_632.0,
    -1_453_857_185.0 / 822_651_844.0,
    69_997_945.0 / 29_380_423.0,
];

impl<const N: usize> OdeStep<N> {
    /// The step of length `h` from `start`, where the slope is `slope`.
    ///
    /// ```
    /// use osculate_geom::ode::OdeStep;
    /// // y' = y from 1: e^h to fifth order, and in between.
    /// let f = |y: &[f64; 1]| Ok::<_, std::convert::Infallible>(*y);
    /// let step = OdeStep::take([1.0], [1.0], 0.1, f)?;
    /// assert!((step.end[0] - 0.1f64.exp()).abs() < 1e-8 && step.error[0].abs() < 1e-6);
    /// assert!((step.at(0.5)[0] - 0.05f64.exp()).abs() < 1e-7);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// The first error of `f`, which is asked at six states.
    pub fn take<X>(
        start: [f64; N],
        slope: [f64; N],
        h: f64,
        mut f: impl FnMut(&[f64; N]) -> Result<[f64; N], X>,
    ) -> Result<Self, X> {
        let mut k = [[0.0; N]; 7];
        k[0] = slope;
        let mut end = start;
        for (stage, row) in A.iter().enumerate() {
            end = std::array::from_fn(|c| {
                let sum: f64 = row.iter().zip(&k).map(|(a, k)| a * k[c]).sum();
                start[c] + h * sum
            });
            k[stage + 1] = f(&end)?;
        }
        let weighted = |w: &[f64; 7], c: usize| h * w.iter().zip(&k).map(|(w, k)| w * k[c]).sum::<f64>();
        let mut dense = [[0.0; N]; 4];
        for c in 0..N {
            let rise = end[c] - start[c];
            let bend = h * k[0][c] - rise;
            dense[0][c] = rise;
            dense[1][c] = bend;
            dense[2][c] = rise - h * k[6][c] - bend;
            dense[3][c] = weighted(&D, c);
        }
        let error = std::array::from_fn(|c| weighted(&E, c));
        Ok(Self { start, end, end_slope: k[6], error, h, dense })
    }

    /// The state at the fraction `t` of the step, 0 to 1; its error is of fifth order in `h`.
    #[must_use]
    pub fn at(&self, t: f64) -> [f64; N] {
        let r = 1.0 - t;
        let d = &self.dense;
        std::array::from_fn(|c| self.start[c] + t * (d[0][c] + r * (d[1][c] + t * (d[2][c] + r * d[3][c]))))
    }
}

/// The factor for the next step's length after an error of `error` where `allowed` was: between 1/5 and 5, with a
/// tenth to spare.
#[must_use]
pub fn step_factor(error: f64, allowed: f64) -> f64 {
    if error > 0.0 { (0.9 * (allowed / error).powf(0.2)).clamp(0.2, 5.0) } else { 5.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    fn turn(y: &[f64; 2]) -> Result<[f64; 2], Infallible> {
        Ok([-y[1], y[0]])
    }

    fn circle(h: f64) -> OdeStep<2> {
        OdeStep::take([1.0, 0.0], [0.0, 1.0], h, turn).unwrap()
    }

    /// Distance of the step's state at the fraction `t` from the circle's.
    fn off(h: f64, t: f64) -> f64 {
        let [x, y] = circle(h).at(t);
        (x - (h * t).cos()).hypot(y - (h * t).sin())
    }

    #[test]
    fn orders_are_five_and_four() {
        // Local errors are of one order more: halving h divides them by 64 and by 32, inside by up to 64 where the
        // leading coefficient happens to be small.
        let end = off(0.4, 1.0) / off(0.2, 1.0);
        assert!((50.0..80.0).contains(&end), "{end}");
        for t in [0.3, 0.5, 0.8] {
            let inside = off(0.4, t) / off(0.2, t);
            assert!((26.0..70.0).contains(&inside), "{t}: {inside}");
        }
        let s = circle(0.4);
        assert_eq!(s.at(0.0), s.start);
        assert!(s.at(1.0).iter().zip(s.end).all(|(a, b)| (a - b).abs() < 1e-15));
        assert_eq!(s.end_slope, turn(&s.end).unwrap());
    }

    #[test]
    fn the_estimate_bounds_the_error() {
        for h in [0.05, 0.1, 0.2, 0.4, 0.8] {
            let e = circle(h).error;
            assert!(off(h, 1.0) < e[0].hypot(e[1]), "{h}");
        }
    }

    #[test]
    fn errors_of_the_slope_come_through() {
        let stop = OdeStep::take([0.0], [1.0], 1.0, |y| if y[0] > 0.5 { Err(y[0]) } else { Ok([1.0]) });
        assert!(stop.is_err());
        assert_eq!(step_factor(0.0, 1.0), 5.0);
        assert!(step_factor(2.0, 1.0) < 0.9);
    }
}
