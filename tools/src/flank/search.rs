//! Least values of functions of one variable in a bracket.

/// Evaluations at most: golden section alone shrinks a bracket by 4e-9 in 40.
const MAX_EVALUATIONS: usize = 60;
/// A bracket below this share of the first one ends the search: a minimum is flat, so that its value is exact to rounding.
const SHARE: f64 = 1e-8;

/// Abscissa and value of the least value in a bracket: parabolas through the three best places where they help, golden
/// section elsewhere. [Brent, Algorithms for Minimization without Derivatives, chapter 5]
pub(super) fn least_between(mut a: f64, mut b: f64, f: impl Fn(f64) -> f64) -> (f64, f64) {
    const GOLDEN: f64 = 0.381_966_011_250_105_1;
    let tolerance = SHARE * (b - a);
    let mut best = a + GOLDEN * (b - a);
    let mut value = f(best);
    let (mut second, mut third) = ((best, value), (best, value));
    let (mut step, mut before) = (0.0f64, 0.0f64);
    for _ in 0..MAX_EVALUATIONS {
        let middle = 0.5 * (a + b);
        if (best - middle).abs() <= 2.0 * tolerance - 0.5 * (b - a) {
            break;
        }
        let r = (best - second.0) * (value - third.1);
        let q = (best - third.0) * (value - second.1);
        let numerator = (best - third.0) * q - (best - second.0) * r;
        let denominator = 2.0 * (q - r);
        let leap = -numerator / denominator;
        let inside = best + leap > a + tolerance && best + leap < b - tolerance;
        if before.abs() > tolerance && inside && leap.abs() < 0.5 * before.abs() {
            (before, step) = (step, leap);
        } else {
            before = if best < middle { b - best } else { a - best };
            step = GOLDEN * before;
        }
        let next = best + if step.abs() >= tolerance { step } else { tolerance.copysign(step) };
        let there = f(next);
        if there <= value {
            if next < best {
                b = best;
            } else {
                a = best;
            }
            (third, second) = (second, (best, value));
            (best, value) = (next, there);
        } else {
            if next < best {
                a = next;
            } else {
                b = next;
            }
            if there <= second.1 || second.0 == best {
                (third, second) = (second, (next, there));
            } else if there <= third.1 || third.0 == best || third.0 == second.0 {
                third = (next, there);
            }
        }
    }
    (best, value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    #[test]
    fn smooth_sharp_and_border_minima() {
        let calls = Cell::new(0);
        let (x, y) = least_between(-1.0, 3.0, |x| {
            calls.set(calls.get() + 1);
            (x - 0.7).cosh()
        });
        assert!((x - 0.7).abs() < 1e-7 && (y - 1.0).abs() < 1e-15 && calls.get() < 25, "{}", calls.get());
        let (x, _) = least_between(0.0, 1.0, |x| (x - 0.3).abs());
        assert!((x - 0.3).abs() < 1e-7);
        let (x, _) = least_between(0.0, 1.0, |x| x);
        assert!(x < 1e-7);
        // A function without numbers ends too.
        assert!(least_between(0.0, 1.0, |_| f64::NAN).1.is_nan());
    }
}
