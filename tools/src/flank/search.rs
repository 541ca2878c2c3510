//! Least values of functions of one variable in a bracket.

/// Abscissa and value of the least value in a bracket by golden section, to a hundred-millionth
/// of the bracket: a minimum is flat, so that its value is exact to rounding.
pub(super) fn least_between(mut a: f64, mut b: f64, f: impl Fn(f64) -> f64) -> (f64, f64) {
    const RATIO: f64 = 0.618_033_988_749_894_9;
    /// A bracket shrinks by 4e-9 in so many sections, 0.618^40.
    const SECTIONS: usize = 40;
    let (mut x, mut y) = (b - RATIO * (b - a), a + RATIO * (b - a));
    let (mut fx, mut fy) = (f(x), f(y));
    for _ in 0..SECTIONS {
        if fx <= fy {
            (b, y, fy) = (y, x, fx);
            x = b - RATIO * (b - a);
            fx = f(x);
        } else {
            (a, x, fx) = (x, y, fy);
            y = a + RATIO * (b - a);
            fy = f(y);
        }
    }
    if fx <= fy { (x, fx) } else { (y, fy) }
}
