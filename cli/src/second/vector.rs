//! Vectors and turns in three dimensions, as plain numbers.

/// A vector or a point.
pub(super) type V = [f64; 3];

/// A turn, by rows.
pub(super) type M = [V; 3];

/// No length of a machine is larger, mm or deg: squares of what is smaller are far from overflow.
const LARGEST: f64 = 1e9;

/// A number that can be calculated with.
pub(super) fn usual(x: f64) -> bool {
    x.abs() <= LARGEST
}

pub(super) fn dot(a: V, b: V) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross(a: V, b: V) -> V {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(super) fn norm(a: V) -> f64 {
    dot(a, a).sqrt()
}

pub(super) fn add(a: V, b: V) -> V {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(super) fn sub(a: V, b: V) -> V {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `a + s b`.
pub(super) fn ahead(a: V, s: f64, b: V) -> V {
    [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]]
}

/// The place at share `t` between two.
pub(super) fn between(a: V, b: V, t: f64) -> V {
    [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])]
}

/// The direction; None of nothing and of what is not finite.
pub(super) fn unit(a: V) -> Option<V> {
    let n = norm(a);
    // Directions are written with components near one: shorter ones are a slip.
    (n.is_finite() && n > 1e-6).then(|| [a[0] / n, a[1] / n, a[2] / n])
}

/// The angle between two directions, exact for small ones too.
pub(super) fn angle(a: V, b: V) -> f64 {
    norm(cross(a, b)).atan2(dot(a, b))
}

/// Rodrigues: `v` turned about the unit vector `k`, right-handed.
pub(super) fn turned(v: V, k: V, angle_rad: f64) -> V {
    let (s, c) = angle_rad.sin_cos();
    let (kv, along) = (cross(k, v), dot(k, v) * (1.0 - c));
    [0, 1, 2].map(|i| v[i] * c + kv[i] * s + k[i] * along)
}

/// The turn about an axis, as a matrix.
pub(super) fn about(k: V, angle_rad: f64) -> M {
    let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|e| turned(e, k, angle_rad));
    [[x[0], y[0], z[0]], [x[1], y[1], z[1]], [x[2], y[2], z[2]]]
}

pub(super) fn times(m: &M, v: V) -> V {
    [dot(m[0], v), dot(m[1], v), dot(m[2], v)]
}

/// The inverse of a turn applied to `v`.
pub(super) fn back(m: &M, v: V) -> V {
    [0, 1, 2].map(|j| m[0][j] * v[0] + m[1][j] * v[1] + m[2][j] * v[2])
}

/// First `b`, then `a`.
pub(super) fn after(a: &M, b: &M) -> M {
    [0, 1, 2].map(|i| back(b, a[i]))
}

/// The direction at share `t` on the great circle from `a` to `b`.
pub(super) fn on_circle(a: V, b: V, t: f64) -> V {
    let whole = angle(a, b);
    match unit(cross(a, b)) {
        Some(k) => turned(a, k, whole * t),
        // So near that the chord is the circle.
        None => unit(between(a, b, t)).unwrap_or(a),
    }
}
