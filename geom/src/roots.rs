//! Roots and minima of functions of one variable, each with a bound on its work and a stated residual.

use std::convert::Infallible;

/// A root found by [`bracketed`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Root {
    /// The abscissa.
    pub x: f64,
    /// The function there.
    pub residual: f64,
    /// Half the width of the last bracket, or the tolerance where the value is exactly zero.
    pub error: f64,
    /// Function evaluations.
    pub evaluations: u32,
}

/// Why there is no root.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RootError {
    /// The function has the same sign at both ends.
    #[error("no change of sign: f({lo}) = {f_lo}, f({hi}) = {f_hi}")]
    NoSignChange {
        /// Lower end.
        lo: f64,
        /// Upper end.
        hi: f64,
        /// Value at the lower end.
        f_lo: f64,
        /// Value at the upper end.
        f_hi: f64,
    },
    /// The bracket did not shrink below the tolerance in the allowed number of evaluations.
    #[error("no convergence after {evaluations} evaluations: residual {residual:.3e}")]
    NotConverged {
        /// Function evaluations.
        evaluations: u32,
        /// The smallest value seen.
        residual: f64,
    },
}

/// One end of a bracket: abscissa and value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct End {
    /// Abscissa.
    pub x: f64,
    /// Function value.
    pub f: f64,
}

/// Most evaluations of [`bracketed`]: bisection alone needs 53 to exhaust a double's digits, and Chandrupatla's
/// rule never takes more than about three times as many.
const MAX_EVALUATIONS: u32 = 160;

/// The root of `f` in a bracket whose ends have values of opposite sign, to `x_tol` in the abscissa.
///
/// Chandrupatla's method: inverse quadratic interpolation where it is safe, bisection elsewhere. Works on kinks and
/// jumps too (it then returns the place of the sign change).
///
/// ```
/// use osculate_geom::roots::{End, RootError, bracketed};
/// let f = |x: f64| x * x - 2.0;
/// let end = |x: f64| End { x, f: f(x) };
/// let root = bracketed(end(0.0), end(2.0), 1e-14, f)?;
/// assert!((root.x - 2f64.sqrt()).abs() < 1e-14);
/// assert!(matches!(bracketed(end(2.0), end(3.0), 1e-14, f), Err(RootError::NoSignChange { .. })));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`RootError::NoSignChange`]; [`RootError::NotConverged`] where the function returns NaN.
pub fn bracketed(a: End, b: End, x_tol: f64, mut f: impl FnMut(f64) -> f64) -> Result<Root, RootError> {
    if a.f == 0.0 {
        return Ok(Root { x: a.x, residual: 0.0, error: 0.0, evaluations: 0 });
    }
    if b.f == 0.0 {
        return Ok(Root { x: b.x, residual: 0.0, error: 0.0, evaluations: 0 });
    }
    if a.f.is_nan() || b.f.is_nan() || a.f.signum() == b.f.signum() {
        return Err(RootError::NoSignChange { lo: a.x, hi: b.x, f_lo: a.f, f_hi: b.f });
    }
    let (mut a, mut b) = (b, a);
    let mut c;
    let mut t = 0.5;
    for evaluations in 1..=MAX_EVALUATIONS {
        let x = a.x + t * (b.x - a.x);
        let fx = f(x);
        if fx.is_nan() {
            return Err(RootError::NotConverged { evaluations, residual: fx });
        }
        if (fx > 0.0) == (a.f > 0.0) {
            c = a;
        } else {
            c = b;
            b = a;
        }
        a = End { x, f: fx };
        let best = if a.f.abs() < b.f.abs() { a } else { b };
        let width = (b.x - a.x).abs();
        let tol = x_tol.max(2.0 * f64::EPSILON * best.x.abs());
        if best.f == 0.0 || width <= 2.0 * tol {
            // A value of zero inside a wide bracket: the root is there to rounding.
            let error = if best.f == 0.0 { tol.min(0.5 * width) } else { 0.5 * width };
            return Ok(Root { x: best.x, residual: best.f, error, evaluations });
        }
        let margin = tol / width;
        let xi = (a.x - b.x) / (c.x - b.x);
        let phi = (a.f - b.f) / (c.f - b.f);
        t = if phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi {
            a.f / (b.f - a.f) * c.f / (b.f - c.f)
                + (c.x - a.x) / (b.x - a.x) * a.f / (c.f - a.f) * b.f / (c.f - b.f)
        } else {
            0.5
        };
        t = t.clamp(margin, 1.0 - margin);
    }
    Err(RootError::NotConverged { evaluations: MAX_EVALUATIONS, residual: a.f })
}

/// The least value found by [`minimum`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Minimum {
    /// The abscissa.
    pub x: f64,
    /// The function there.
    pub f: f64,
    /// The minimum lies at most this far from `x` where the function has one in the bracket; larger than was asked for
    /// where the evaluations ran out.
    pub error: f64,
    /// Function evaluations.
    pub evaluations: u32,
}

/// The share of its bracket to which a smooth minimum has a place: it is flat there, so that the value is exact to rounding.
pub const FLAT: f64 = 1e-8;

/// Most evaluations of [`minimum`]: golden section alone shrinks a bracket by 4e-9 in 40.
const MAX_MINIMUM: u32 = 61;

/// The least value of `f` between two ends, to `share` of their distance in the abscissa (not below [`FLAT`] for smooth
/// functions, whose values say nothing nearer).
///
/// Parabolas through the three best places where they help, golden section elsewhere; the ends themselves are not looked at.
/// A function with several minima gives one of them, one without numbers NaN. [Brent, Algorithms for Minimization without
/// Derivatives, chapter 5]
///
/// ```
/// use osculate_geom::roots::{FLAT, minimum};
/// let m = minimum([-1.0, 3.0], FLAT, |x| (x - 0.7).cosh());
/// assert!((m.x - 0.7).abs() < 1e-7 && (m.f - 1.0).abs() < 1e-15 && m.evaluations < 25);
/// ```
pub fn minimum(ends: [f64; 2], share: f64, mut f: impl FnMut(f64) -> f64) -> Minimum {
    match try_minimum(ends, share, |x| Ok::<f64, Infallible>(f(x))) {
        Ok(found) => found,
        Err(never) => match never {},
    }
}

/// As [`minimum`], of a function that may fail.
///
/// # Errors
/// The first error of the function.
pub fn try_minimum<E>(
    [mut a, mut b]: [f64; 2],
    share: f64,
    mut f: impl FnMut(f64) -> Result<f64, E>,
) -> Result<Minimum, E> {
    const GOLDEN: f64 = 0.381_966_011_250_105_1;
    let tolerance = share * (b - a);
    let x = a + GOLDEN * (b - a);
    let mut best = End { x, f: f(x)? };
    let (mut second, mut third) = (best, best);
    let (mut step, mut before) = (0.0f64, 0.0f64);
    let mut evaluations = 1;
    while evaluations < MAX_MINIMUM {
        let middle = 0.5 * (a + b);
        if (best.x - middle).abs() <= 2.0 * tolerance - 0.5 * (b - a) {
            break;
        }
        let r = (best.x - second.x) * (best.f - third.f);
        let q = (best.x - third.x) * (best.f - second.f);
        let leap = ((best.x - second.x) * r - (best.x - third.x) * q) / (2.0 * (q - r));
        let inside = best.x + leap > a + tolerance && best.x + leap < b - tolerance;
        if before.abs() > tolerance && inside && leap.abs() < 0.5 * before.abs() {
            (before, step) = (step, leap);
        } else {
            before = if best.x < middle { b - best.x } else { a - best.x };
            step = GOLDEN * before;
        }
        let x = best.x + if step.abs() >= tolerance { step } else { tolerance.copysign(step) };
        let next = End { x, f: f(x)? };
        evaluations += 1;
        if next.f <= best.f {
            *(if next.x < best.x { &mut b } else { &mut a }) = best.x;
            (third, second, best) = (second, best, next);
        } else {
            *(if next.x < best.x { &mut a } else { &mut b }) = next.x;
            if next.f <= second.f || second.x == best.x {
                (third, second) = (second, next);
            } else if next.f <= third.f || third.x == best.x || third.x == second.x {
                third = next;
            }
        }
    }
    Ok(Minimum { x: best.x, f: best.f, error: (b - best.x).max(best.x - a), evaluations })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solve(lo: f64, hi: f64, f: impl Fn(f64) -> f64) -> Root {
        bracketed(End { x: lo, f: f(lo) }, End { x: hi, f: f(hi) }, 1e-14, &f).unwrap()
    }

    #[test]
    fn smooth_flat_and_kinked_roots() {
        assert!((solve(0.0, 2.0, |x| x * x - 2.0).x - 2f64.sqrt()).abs() < 1e-14);
        // A triple root: the abscissa is only as sharp as the cube root of the value.
        assert!((solve(-1.0, 2.5, |x| (x - 0.7).powi(3)).x - 0.7).abs() < 1e-5);
        let jump = solve(-3.0, 4.0, |x| if x < 0.25 { -1.0 } else { 2.0 });
        assert!((jump.x - 0.25).abs() < 1e-13 && jump.evaluations < 110);
        // Quick on smooth functions.
        assert!(solve(0.0, 1.5, |x| x.cos() - x).evaluations < 12);
    }

    #[test]
    fn refuses_what_it_cannot_do() {
        let same = bracketed(End { x: 0.0, f: 1.0 }, End { x: 1.0, f: 2.0 }, 1e-9, |x| x);
        assert!(matches!(same, Err(RootError::NoSignChange { .. })));
        let nan = bracketed(End { x: 0.0, f: f64::NAN }, End { x: 1.0, f: 2.0 }, 1e-9, |x| x);
        assert!(nan.is_err());
        let inner = bracketed(End { x: -1.0, f: -1.0 }, End { x: 1.0, f: 2.0 }, 1e-9, |_| f64::NAN);
        assert!(matches!(inner, Err(RootError::NotConverged { .. })));
    }

    #[test]
    fn smooth_sharp_and_border_minima() {
        let smooth = minimum([-1.0, 3.0], FLAT, |x| (x - 0.7).cosh());
        assert!((smooth.x - 0.7).abs() < 1e-7 && (smooth.f - 1.0).abs() < 1e-15, "{smooth:?}");
        assert!(smooth.evaluations < 25 && smooth.error <= 2.0 * 4.0 * FLAT, "{smooth:?}");
        let sharp = minimum([0.0, 1.0], FLAT, |x| (x - 0.3).abs());
        assert!((sharp.x - 0.3).abs() <= sharp.error && sharp.error < 1e-7);
        assert!(minimum([0.0, 1.0], FLAT, |x| x).x < 1e-7);
        // Finer than evaluations allow: the error says so.
        let long = minimum([0.0, 1.0], 1e-30, |x| (x - 0.3).abs());
        assert!(long.evaluations == MAX_MINIMUM && long.error > 1e-30 && (long.x - 0.3).abs() <= long.error);
        // A function without numbers ends too.
        assert!(minimum([0.0, 1.0], FLAT, |_| f64::NAN).f.is_nan());
        assert_eq!(try_minimum([0.0, 1.0], FLAT, |_| Err::<f64, u8>(7)), Err(7));
    }
}
