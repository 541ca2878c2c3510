//! Heights of the tip along a row, cut and held at levels.

/// A place of a row: along it and the height of the tip, mm.
pub(super) type Place = [f64; 2];

/// Where a line of heights is on a level between two of its places.
fn crossing(a: Place, b: Place, level: f64) -> Place {
    // Next to air, where nothing holds the tip, no height says how far it is.
    if let Some(air) = [a, b].into_iter().find(|p| p[1] == f64::NEG_INFINITY) {
        return [air[0], level];
    }
    [a[0] + (b[0] - a[0]) * (level - a[1]) / (b[1] - a[1]), level]
}

/// The parts of a line of heights that lie below a level, each of two places at least.
pub(super) fn below(run: &[Place], level: f64) -> Vec<Vec<Place>> {
    let mut out: Vec<Vec<Place>> = Vec::new();
    let mut part: Vec<Place> = Vec::new();
    for (k, p) in run.iter().enumerate() {
        let before = k.checked_sub(1).map(|k| run[k]);
        let inside = p[1] < level;
        if let Some(b) = before
            && (b[1] < level) != inside
        {
            part.push(crossing(b, *p, level));
        }
        if inside {
            part.push(*p);
        } else if !part.is_empty() {
            out.push(std::mem::take(&mut part));
        }
    }
    out.push(part);
    out.retain(|p| p.len() > 1);
    out
}

/// A line of heights held above a level.
pub(super) fn raised(run: &[Place], level: f64) -> Vec<Place> {
    let mut out: Vec<Place> = Vec::with_capacity(run.len());
    let add = |out: &mut Vec<Place>, p: Place| {
        // Between two others on the level a place says nothing.
        let n = out.len();
        if n >= 2 && out[n - 1][1] == level && out[n - 2][1] == level && p[1] == level {
            out[n - 1] = p;
        } else {
            out.push(p);
        }
    };
    for (k, p) in run.iter().enumerate() {
        if let Some(b) = k.checked_sub(1).map(|k| run[k])
            && (b[1] < level) != (p[1] < level)
        {
            add(&mut out, crossing(b, *p, level));
        }
        add(&mut out, [p[0], p[1].max(level)]);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_heights_is_cut_and_held() {
        let run = [[0.0, 4.0], [2.0, 0.0], [4.0, 4.0], [6.0, 0.0]];
        assert_eq!(
            below(&run, 2.0),
            vec![vec![[1.0, 2.0], [2.0, 0.0], [3.0, 2.0]], vec![[5.0, 2.0], [6.0, 0.0]]]
        );
        assert_eq!(raised(&run[..3], 2.0), vec![[0.0, 4.0], [1.0, 2.0], [3.0, 2.0], [4.0, 4.0]]);
        // Beside air a line goes as far as air is known.
        let beside = [[0.0, f64::NEG_INFINITY], [1.0, f64::NEG_INFINITY], [2.0, 5.0]];
        let part = &below(&beside, 3.0)[0];
        assert_eq!(raised(part, 1.0), vec![[0.0, 1.0], [1.0, 1.0], [1.0, 3.0]]);
    }
}
