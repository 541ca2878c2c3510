//! A face finished row by row: the productivity in time, integrated, against the face's area.

use osculate_geom::quadrature::gauss;
use osculate_geom::{Axis, Surface, uv};
use osculate_productivity::finish::{Across, Place, area_rate_mm2_min};

/// Area that `rows` rows along u, `feed` parameters of u a minute, add up to, mm2. Trims are met where each line of constant
/// u meets them.
pub fn integrated(face: &dyn Surface, rows: usize, feed: f64) -> f64 {
    let d = face.domain();
    // The instants of a row, between the breaks of the surface and the turns of its boundary.
    let mut breaks = face.breaks(Axis::U);
    breaks.extend(face.turns().iter().map(|p| p.u));
    breaks.retain(|u| *u >= d.u.lo && *u <= d.u.hi);
    breaks.sort_by(f64::total_cmp);
    let mut total = 0.0;
    for row in 0..rows {
        let low = d.v.at(row as f64 / rows as f64);
        let high = d.v.at((row + 1) as f64 / rows as f64);
        for pair in breaks.windows(2).filter(|p| p[1] > p[0]) {
            // Time runs from 0 in each stretch; rows are passed one after the other.
            let minutes = (pair[1] - pair[0]) / feed;
            total += gauss(0.0, minutes, 4, |t| {
                let u = pair[0] + feed * t;
                face.spans(Axis::V, u)
                    .iter()
                    .map(|span| (span.lo.max(low), span.hi.min(high)))
                    .filter(|(from, to)| from < to)
                    .map(|(from, to)| {
                        let across = Across { from, to, panels: 2 };
                        let line =
                            |w: f64| Place { at: uv(u, w), by_time: uv(feed, 0.0), by_across: uv(0.0, 1.0) };
                        area_rate_mm2_min(face, across, line).expect("no fold")
                    })
                    .sum()
            });
        }
    }
    total
}
