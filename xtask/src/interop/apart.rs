//! How far a tip is off a straight piece of its path.

/// The distance of a point from a straight piece.
pub(crate) fn apart(p: &[f64; 3], a: &[f64; 3], b: &[f64; 3]) -> f64 {
    let (mut along, mut length) = (0.0, 0.0);
    for k in 0..3 {
        along += (p[k] - a[k]) * (b[k] - a[k]);
        length += (b[k] - a[k]).powi(2);
    }
    let t = if length == 0.0 { 0.0 } else { (along / length).clamp(0.0, 1.0) };
    (0..3).map(|k| (p[k] - a[k] - t * (b[k] - a[k])).powi(2)).sum::<f64>().sqrt()
}
