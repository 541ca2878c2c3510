//! Two equations with two unknowns, by Cramer's rule.

/// The solution of `m x = b`, the rows of m first; not finite where the determinant vanishes.
#[inline]
#[must_use]
pub fn general([[p, q], [r, s]]: [[f64; 2]; 2], [a, b]: [f64; 2]) -> [f64; 2] {
    let det = p * s - q * r;
    [(a * s - b * q) / det, (b * p - a * r) / det]
}

/// The solution of the symmetric `[[e, f], [f, g]] x = b`, as the first fundamental form has it; not finite where the
/// determinant vanishes.
///
/// ```
/// use osculate_geom::solve;
/// // 2 x + y = 5, x + 4 y = 6.
/// let [x, y] = solve::symmetric([2.0, 1.0, 4.0], [5.0, 6.0]);
/// assert!((x - 2.0).abs() < 1e-15 && (y - 1.0).abs() < 1e-15);
/// ```
#[inline]
#[must_use]
pub fn symmetric([e, f, g]: [f64; 3], b: [f64; 2]) -> [f64; 2] {
    general([[e, f], [f, g]], b)
}

/// As [`symmetric`], with unknowns that are `held` at zero and their equations left out; None unless the rest is positive
/// definite. `least` is the smallest determinant relative to `e g`, the squared sine between the directions that the
/// unknowns stand for.
#[inline(always)]
#[must_use]
pub fn definite([e, f, g]: [f64; 3], b: [f64; 2], held: [bool; 2], least: f64) -> Option<[f64; 2]> {
    match held {
        [true, true] => Some([0.0, 0.0]),
        [true, false] => (g > 0.0).then(|| [0.0, b[1] / g]),
        [false, true] => (e > 0.0).then(|| [b[0] / e, 0.0]),
        [false, false] => {
            (e > 0.0 && g > 0.0 && e * g - f * f > least * e * g).then(|| symmetric([e, f, g], b))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solutions_satisfy_their_equations() {
        let m = [[2.0, -1.0], [0.5, 3.0]];
        let [x, y] = general(m, [4.0, -2.0]);
        assert!(
            (m[0][0] * x + m[0][1] * y - 4.0).abs() < 1e-15
                && (m[1][0] * x + m[1][1] * y + 2.0).abs() < 1e-15
        );
        assert_eq!(symmetric([2.0, 1.0, 4.0], [5.0, 6.0]), general([[2.0, 1.0], [1.0, 4.0]], [5.0, 6.0]));
        assert!(!general([[1.0, 2.0], [2.0, 4.0]], [1.0, 1.0])[0].is_finite());
    }

    #[test]
    fn only_definite_systems_are_solved() {
        let free = [false, false];
        assert_eq!(definite([2.0, 0.0, 4.0], [2.0, 2.0], free, 0.0), Some([1.0, 0.5]));
        assert_eq!(definite([1.0, 2.0, 1.0], [1.0, 1.0], free, 0.0), None);
        assert_eq!(definite([-1.0, 0.0, -1.0], [1.0, 1.0], free, 0.0), None);
        // Nearly parallel directions are refused by the share.
        assert_eq!(definite([1.0, 1.0 - 1e-9, 1.0], [1.0, 1.0], free, 1e-8), None);
        assert_eq!(definite([-1.0, 7.0, 2.0], [1.0, 3.0], [true, false], 0.0), Some([0.0, 1.5]));
        assert_eq!(definite([-1.0, 7.0, 2.0], [1.0, 3.0], [false, true], 0.0), None);
        assert_eq!(definite([-1.0, 7.0, -2.0], [1.0, 3.0], [true, true], 0.0), Some([0.0, 0.0]));
    }
}
