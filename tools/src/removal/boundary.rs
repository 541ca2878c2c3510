//! Samples on the trims of a face, and on triangles.
//!
//! A narrow tip of a trimmed face may lie between the samples of a grid. Its outline does not: it is walked at half the
//! spacing, and every corner of it gets a sample of its own. Samples on an outline stand for no area.

use super::job::Sample;
use osculate_geom::{Point3, Surface, Unit3, Uv, uv};

/// An outline turning by more than this, rad, from one chord to the next has a corner there: polylines of smooth
/// curves turn by less.
const CORNER_RAD: f64 = 0.3;

/// Samples along a closed polyline of parameters, at most half of `spacing_mm` apart.
///
/// Where the surface has no tangent plane there is no sample.
#[must_use]
pub fn sample_boundary(surface: &dyn Surface, outline: &[Uv], face: u32, spacing_mm: f64) -> Vec<Sample> {
    let mut out = Vec::new();
    let count = outline.len();
    if count < 2 || spacing_mm.is_nan() || spacing_mm <= 0.0 {
        return out;
    }
    let mut see = |at: Uv| {
        let jet = surface.jet2(at);
        if let Ok(normal) = jet.normal()
            && jet.point.iter().all(|x| x.is_finite())
        {
            out.push(Sample { point: jet.point, normal, face, uv: at, area_mm2: 0.0, check_only: false });
        }
    };
    let points: Vec<_> = outline.iter().map(|at| surface.point(*at)).collect();
    let step = 0.5 * spacing_mm;
    // Way since the last sample.
    let mut since = f64::INFINITY;
    for k in 0..count {
        let (before, next) = ((k + count - 1) % count, (k + 1) % count);
        let (a, b) = (points[k] - points[before], points[next] - points[k]);
        let length = b.norm();
        if a.angle(&b) > CORNER_RAD || since >= step {
            see(outline[k]);
            since = 0.0;
        }
        if !length.is_finite() || length == 0.0 {
            continue;
        }
        // Long chords in between; chords of more than a million steps belong to no part.
        let parts = ((since + length) / step).floor().min(1e6);
        for i in 0..parts as u32 {
            let f = ((f64::from(i) + 1.0) * step - since) / length;
            if f < 1.0 {
                see(uv(
                    outline[k].u + f * (outline[next].u - outline[k].u),
                    outline[k].v + f * (outline[next].v - outline[k].v),
                ));
            }
        }
        since = (since + length) - parts * step;
    }
    out
}

/// Samples on triangles that carry no material and are not to be touched, such as those of a fixture: their corners and
/// places in between at most `spacing_mm` apart, the normal to the side from which they run counter-clockwise.
/// Triangles without area have none.
///
/// ```
/// use osculate_geom::Point3;
/// use osculate_tools::removal::sample_triangles;
/// // One side of a clamp, 3 x 4 mm, seen from +z: nothing may be taken from it.
/// let p = |x: f64, y: f64| Point3::new(x, y, 0.0);
/// let samples = sample_triangles(&[[p(0.0, 0.0), p(3.0, 0.0), p(0.0, 4.0)]], 7, 1.0);
/// assert!(samples.iter().all(|s| s.check_only && s.face == 7 && s.normal.z == 1.0));
/// assert!(samples.iter().any(|s| s.point == p(0.0, 4.0)));
/// ```
#[must_use]
pub fn sample_triangles(triangles: &[[Point3; 3]], face: u32, spacing_mm: f64) -> Vec<Sample> {
    let mut out = Vec::new();
    for t in triangles {
        let (a, b) = (t[1] - t[0], t[2] - t[0]);
        let cross = a.cross(&b);
        let Some(normal) = Unit3::try_new(cross, 0.0) else { continue };
        let longest = a.norm().max(b.norm()).max((b - a).norm());
        // More than a thousand to a side are a mistake in the spacing.
        let parts = (longest / spacing_mm).ceil().clamp(1.0, 1e3) as u32;
        let count = f64::from((parts + 1) * (parts + 2) / 2);
        for i in 0..=parts {
            for j in 0..=parts - i {
                let at = [i, j].map(|k| f64::from(k) / f64::from(parts));
                out.push(Sample {
                    point: t[0] + a * at[0] + b * at[1],
                    normal,
                    face,
                    uv: uv(at[0], at[1]),
                    area_mm2: 0.5 * cross.norm() / count,
                    check_only: true,
                });
            }
        }
    }
    out
}
