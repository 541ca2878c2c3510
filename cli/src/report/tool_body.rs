//! The tool's outline as bodies of revolution: cutter, shank, holder.
//!
//! Local frame: `[radius, height]` in mm, height along the axis from the tip towards the spindle. The same outlines
//! drive the viewer's model and the static picture.

use super::data::Tool;

/// A part of the tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Piece {
    /// What cuts.
    Cutter,
    /// The same diameter without edges.
    Shank,
    /// What holds it.
    Holder,
}

/// Steps on a quarter of the corner's circle: a 20 mm ball then deviates 12 um from round, which no picture shows.
const CORNER_STEPS: usize = 16;

/// The outlines, each closed at both ends by the axis, in ascending height. Sizes that are not positive and finite
/// leave their piece out.
pub fn outlines(tool: &Tool) -> Vec<(Piece, Vec<[f64; 2]>)> {
    let good = |x: f64| x.is_finite() && x > 0.0;
    let mut pieces = Vec::new();
    let mut top = 0.0_f64;
    let given: Vec<[f64; 2]> = tool
        .meridian_mm
        .iter()
        .copied()
        .filter(|p| p[0].is_finite() && p[0] >= 0.0 && p[1].is_finite())
        .collect();
    if let (Some(first), Some(last)) = (given.first().copied(), given.last().copied()) {
        let mut outline = given;
        if first[0] > 0.0 {
            outline.insert(0, [0.0, first[1]]);
        }
        outline.push([0.0, last[1]]);
        top = last[1];
        pieces.push((Piece::Cutter, outline));
    } else if good(tool.diameter_mm) && good(tool.length_mm) {
        let radius = 0.5 * tool.diameter_mm;
        let corner = if good(tool.corner_radius_mm) { tool.corner_radius_mm.min(radius) } else { 0.0 };
        let end =
            tool.flute_mm.filter(|f| good(*f)).map_or(tool.length_mm, |f| f.clamp(corner, tool.length_mm));
        let mut outline = vec![[0.0, 0.0]];
        if corner > 0.0 {
            for i in 0..=CORNER_STEPS {
                let (sin, cos) = (std::f64::consts::FRAC_PI_2 * i as f64 / CORNER_STEPS as f64).sin_cos();
                outline.push([radius - corner + corner * sin, corner * (1.0 - cos)]);
            }
        } else {
            outline.push([radius, 0.0]);
        }
        outline.push([radius, end]);
        outline.push([0.0, end]);
        pieces.push((Piece::Cutter, outline));
        if end < tool.length_mm {
            pieces.push((Piece::Shank, section([radius; 2], end, tool.length_mm)));
        }
        top = tool.length_mm;
    }
    for holder in tool.holder.iter().filter(|h| h.diameters_mm.iter().all(|d| good(*d)) && good(h.length_mm))
    {
        let radii = holder.diameters_mm.map(|d| 0.5 * d);
        pieces.push((Piece::Holder, section(radii, top, top + holder.length_mm)));
        top += holder.length_mm;
    }
    pieces
}

/// A cylinder, or a cone where the radii of both ends differ.
fn section(radii: [f64; 2], from: f64, to: f64) -> Vec<[f64; 2]> {
    vec![[0.0, from], [radii[0], from], [radii[1], to], [0.0, to]]
}

#[cfg(test)]
mod tests {
    use super::super::data::Holder;
    use super::*;

    /// Every corner point of a ball end lies on the ball; rounding of a few operations on sizes of 10 mm.
    #[test]
    fn a_ball_is_round() {
        let tool = Tool { diameter_mm: 20.0, corner_radius_mm: 10.0, length_mm: 60.0, ..Tool::default() };
        let pieces = outlines(&tool);
        assert_eq!(pieces.len(), 1);
        let corner = pieces[0].1.iter().filter(|p| p[1] <= 10.0 && p[0] > 0.0);
        assert!(corner.clone().count() >= CORNER_STEPS);
        for [rho, z] in corner {
            assert!((rho.hypot(z - 10.0) - 10.0).abs() < 1e-13);
        }
    }

    #[test]
    fn pieces_stand_on_each_other() {
        let tool = Tool {
            diameter_mm: 12.0,
            corner_radius_mm: 2.0,
            length_mm: 50.0,
            flute_mm: Some(25.0),
            holder: vec![
                Holder { diameters_mm: [12.0, 40.0], length_mm: 20.0 },
                Holder { diameters_mm: [40.0; 2], length_mm: 40.0 },
            ],
            ..Tool::default()
        };
        let pieces = outlines(&tool);
        assert_eq!(
            pieces.iter().map(|p| p.0).collect::<Vec<_>>(),
            [Piece::Cutter, Piece::Shank, Piece::Holder, Piece::Holder]
        );
        for pair in pieces.windows(2) {
            assert_eq!(pair[0].1.last().map(|p| p[1]), pair[1].1.first().map(|p| p[1]));
        }
        assert_eq!(pieces[2].1[1..3], [[6.0, 50.0], [20.0, 70.0]]);
        assert_eq!(pieces[3].1.last(), Some(&[0.0, 110.0]));
    }

    #[test]
    fn nonsense_gives_nothing_rather_than_a_panic() {
        for bad in [f64::NAN, -1.0, 0.0, f64::INFINITY] {
            assert!(outlines(&Tool { diameter_mm: bad, length_mm: 10.0, ..Tool::default() }).is_empty());
        }
        assert!(outlines(&Tool::default()).is_empty());
    }
}
