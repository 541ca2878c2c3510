//! What a verdict measured, and the way of the tool, for other programs: points with named numbers, as a file of VTK and as an archive of NumPy.
//!
//! Lengths are mm, times min, angles none; the frame is the part's. A deviation is along the outward normal: positive is material left,
//! negative a gouge. Faces are numbered from 1 in the order of the array `faces`, those to machine first; lines of programs from 1, and 0 where
//! nothing came.

mod cloud;
mod npz;
mod vtp;

use crate::part::Part;
use crate::work::verify::Verified;
use cloud::{Cloud, Column};
use osculate_geom::{Point3, Vec3};
use osculate_tools::removal::Swept;

/// The files of a verdict: their names, and what is in them.
#[must_use]
pub fn files(
    (verified, part): (&Verified, &Part),
    (motions, times_min): (&[Swept], &[f64]),
) -> Vec<(&'static str, Vec<u8>)> {
    let (samples, moves) = (samples(verified, part, motions), moves(motions, times_min));
    vec![
        ("samples.vtp", vtp::bytes(&samples)),
        ("samples.npz", npz::bytes(&samples)),
        ("moves.vtp", vtp::bytes(&moves)),
        ("moves.npz", npz::bytes(&moves)),
    ]
}

fn line(block: u32) -> i32 {
    i32::try_from(block).unwrap_or(i32::MAX)
}

fn three(p: &Point3) -> [f64; 3] {
    [p.x, p.y, p.z]
}

/// The samples of a verdict with what stands on them.
fn samples(verified: &Verified, part: &Part, motions: &[Swept]) -> Cloud {
    let (samples, cuts) = (verified.verdict.samples(), verified.verdict.cuts());
    let made_by = cuts.iter().map(|c| {
        let by = c.by.and_then(|by| motions.get(by.motion as usize));
        by.map_or(0, |m| line(m.block))
    });
    let faces = part.faces.iter().chain(&part.check).map(|f| f.id.clone()).collect();
    Cloud {
        points: samples.iter().map(|s| three(&s.point)).collect(),
        chains: Vec::new(),
        columns: vec![
            Column::real("deviation_mm", 1, cuts.iter().map(|c| c.standoff_mm)),
            Column::real("normal", 3, samples.iter().flat_map(|s| [s.normal.x, s.normal.y, s.normal.z])),
            Column::real("uv", 2, samples.iter().flat_map(|s| [s.uv.u, s.uv.v])),
            Column::real("area_mm2", 1, samples.iter().map(|s| s.area_mm2)),
            Column::whole("face", samples.iter().map(|s| line(s.face.saturating_add(1)))),
            Column::whole("check_only", samples.iter().map(|s| i32::from(s.check_only))),
            Column::whole("line", made_by),
        ],
        names: Some(("faces", faces)),
    }
}

/// The way of the tool's tip, in chains of feed and of rapid moves.
fn moves(motions: &[Swept], times_min: &[f64]) -> Cloud {
    let mut points: Vec<[f64; 3]> = Vec::new();
    let mut chains: Vec<std::ops::Range<usize>> = Vec::new();
    let (mut axes, mut times, mut lines, mut rapid) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut put = |points: &mut Vec<[f64; 3]>, tip: &Point3, axis: Vec3, time_min: f64, m: &Swept| {
        points.push(three(tip));
        axes.extend([axis.x, axis.y, axis.z]);
        times.push(time_min);
        lines.push(line(m.block));
        rapid.push(i32::from(m.rapid));
    };
    for (k, m) in motions.iter().enumerate() {
        let goes_on = k > 0 && motions[k - 1].to.tip == m.from.tip && motions[k - 1].rapid == m.rapid;
        if !goes_on {
            let begin_min = if k == 0 { 0.0 } else { times_min[k - 1] };
            chains.push(points.len()..points.len() + 1);
            put(&mut points, &m.from.tip, m.from.axis.into_inner(), begin_min, m);
        }
        put(&mut points, &m.to.tip, m.to.axis.into_inner(), times_min[k], m);
        if let Some(chain) = chains.last_mut() {
            chain.end = points.len();
        }
    }
    let columns = vec![
        Column::real("axis", 3, axes),
        Column::real("time_min", 1, times),
        Column::whole("line", lines),
        Column::whole("rapid", rapid),
    ];
    Cloud { points, chains, columns, names: None }
}

#[cfg(test)]
mod tests {
    use super::cloud::Numbers;
    use super::*;
    use osculate_tools::Pose;

    fn pose(x: f64) -> Pose {
        Pose { tip: Point3::new(x, 0.0, 0.0), axis: Vec3::z_axis() }
    }

    #[test]
    fn chains_end_where_feed_turns_to_rapid_and_where_the_tip_is_elsewhere() {
        let go = |from: f64, to: f64, rapid: bool, block: u32| Swept {
            from: pose(from),
            to: pose(to),
            rapid,
            block,
        };
        let motions =
            [go(0.0, 1.0, true, 3), go(1.0, 2.0, false, 4), go(2.0, 3.0, false, 5), go(7.0, 8.0, false, 9)];
        let cloud = moves(&motions, &[0.1, 0.2, 0.3, 0.4]);
        assert_eq!(cloud.chains, [0..2, 2..5, 5..7]);
        assert_eq!(cloud.points.len(), 7);
        assert_eq!(cloud.columns[2].numbers, Numbers::Whole(vec![3, 3, 4, 4, 5, 9, 9]));
        assert_eq!(cloud.columns[1].numbers, Numbers::Real(vec![0.0, 0.1, 0.1, 0.2, 0.3, 0.3, 0.4]));
    }
}
