//! Placings of CL data: `TRACUT/` moves the points that follow, `COPY/` repeats those since its `INDEX/`.
//!
//! - `TRACUT/a1,b1,c1,d1,...,d3` (three rows of a matrix, x' = a1 x + b1 y + c1 z + d1) until `TRACUT/NOMORE`; another one takes its place.
//! - `COPY/n,SAME,k`, `COPY/n,TRANSL,x,y,z,k`, `COPY/n,XYROT,deg,k` (`YZROT`, `ZXROT`), `COPY/n,MODIFY,(12 numbers),k`: what stands
//!   between `INDEX/n` and here comes k times more, each time moved once more than the time before.
//!
//! Only placings that keep lengths are taken, mirrors among them: a cutter's path that is scaled is no cutter's path.

use nalgebra::Matrix3;
use osculate_geom::{Point3, Unit3, Vec3};

use super::error::ClReadError;
use super::fields::numbers;
use super::statement::Statement;

/// How far rows of a matrix may be from unit vectors across each other: rounding of six decimals.
const RIGID: f64 = 1e-5;

/// Where points go: turned or mirrored, then moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Transform {
    linear: Matrix3<f64>,
    /// mm.
    shift: Vec3,
}

impl Transform {
    pub fn identity() -> Self {
        Self { linear: Matrix3::identity(), shift: Vec3::zeros() }
    }

    fn moved(shift: Vec3) -> Self {
        Self { shift, ..Self::identity() }
    }

    /// Turned from one coordinate axis towards another by an angle, deg.
    fn turned(from: usize, to: usize, angle_deg: f64) -> Self {
        let (s, c) = angle_deg.to_radians().sin_cos();
        let mut linear = Matrix3::identity();
        (linear[(from, from)], linear[(to, to)]) = (c, c);
        (linear[(to, from)], linear[(from, to)]) = (s, -s);
        Self { linear, shift: Vec3::zeros() }
    }

    /// Of three rows of four numbers; `None` where it does not keep lengths.
    fn rows(n: &[f64; 12], unit_mm: f64) -> Option<Self> {
        let linear = Matrix3::new(n[0], n[1], n[2], n[4], n[5], n[6], n[8], n[9], n[10]);
        let off = (linear * linear.transpose() - Matrix3::identity()).abs().max();
        (off < RIGID).then(|| Self { linear, shift: Vec3::new(n[3], n[7], n[11]) * unit_mm })
    }

    /// First the other one, then this one.
    pub fn after(&self, other: &Self) -> Self {
        Self { linear: self.linear * other.linear, shift: self.linear * other.shift + self.shift }
    }

    pub fn point(&self, p: &Point3) -> Point3 {
        self.linear * p + self.shift
    }

    /// A tool axis; it keeps its length but for rounding.
    pub fn axis(&self, axis: &Unit3) -> Unit3 {
        Unit3::new_normalize(self.linear * axis.into_inner())
    }
}

/// Why a placing cannot be taken.
pub(super) type Why = &'static str;

/// What `TRACUT/` asks for; `None` inside: nothing any more.
pub(super) fn tracut(s: &Statement, unit_mm: f64) -> Result<Result<Option<Transform>, Why>, ClReadError> {
    match s.fields.first().map(String::as_str) {
        Some("NOMORE") => return Ok(Ok(None)),
        Some("LAST") => return Ok(Err("LAST is not interpreted")),
        _ => {}
    }
    let n = numbers(s, &s.fields)?;
    let Ok(rows) = <[f64; 12]>::try_from(n) else { return Ok(Err("it needs the 12 numbers of a matrix")) };
    Ok(Transform::rows(&rows, unit_mm).map(Some).ok_or("its matrix does not keep lengths"))
}

/// What `COPY/` asks for.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Copy {
    /// Of its `INDEX/`.
    pub name: String,
    /// From one time to the next.
    pub step: Transform,
    /// Times more.
    pub times: usize,
}

/// More times than any pattern has; each may still be one of many moves.
const MOST_TIMES: f64 = 1e5;

pub(super) fn copy(s: &Statement, unit_mm: f64) -> Result<Result<Copy, Why>, ClReadError> {
    let [name, kind, rest @ ..] = &s.fields[..] else { return Ok(Err("it needs an index and a kind")) };
    let n = numbers(s, rest)?;
    let Some((&times, by)) = n.split_last() else { return Ok(Err("it needs a count")) };
    let step = match (kind.as_str(), by) {
        ("SAME", []) => Some(Transform::identity()),
        ("TRANSL", &[x, y, z]) => Some(Transform::moved(Vec3::new(x, y, z) * unit_mm)),
        ("XYROT", &[angle]) => Some(Transform::turned(0, 1, angle)),
        ("YZROT", &[angle]) => Some(Transform::turned(1, 2, angle)),
        ("ZXROT", &[angle]) => Some(Transform::turned(2, 0, angle)),
        ("MODIFY", by) => match <[f64; 12]>::try_from(by) {
            Ok(rows) => match Transform::rows(&rows, unit_mm) {
                Some(step) => Some(step),
                None => return Ok(Err("its matrix does not keep lengths")),
            },
            Err(_) => None,
        },
        _ => None,
    };
    let Some(step) = step else {
        return Ok(Err("known are SAME,k; TRANSL,x,y,z,k; XYROT, YZROT or ZXROT,deg,k; MODIFY,12 numbers,k"));
    };
    if times.fract() != 0.0 || !(0.0..=MOST_TIMES).contains(&times) {
        return Ok(Err("the count must be a whole number from 0 to 100000"));
    }
    // Whole and in the range, as just checked.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let times = times as usize;
    Ok(Ok(Copy { name: name.clone(), step, times }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn statement(fields: &str) -> Statement {
        let fields = fields.split(',').map(str::to_owned).collect();
        Statement { line: 1, word: "COPY".into(), fields }
    }

    #[test]
    fn turns_are_right_handed_and_compose() {
        for (kind, from, to) in [
            ("XYROT", [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
            ("YZROT", [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
            ("ZXROT", [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]),
        ] {
            let step = copy(&statement(&format!("1,{kind},90,2")), 1.0).unwrap().unwrap().step;
            assert!((step.point(&Point3::from(from)) - Point3::from(to)).norm() < 1e-15, "{kind}");
            let twice = step.after(&step);
            assert!((twice.point(&Point3::from(from)) + Vec3::from(from)).coords.norm() < 1e-15);
        }
        let inch = copy(&statement("2,TRANSL,1,0,-2,3"), 25.4).unwrap().unwrap();
        assert_eq!((inch.step.point(&Point3::origin()), inch.times), (Point3::new(25.4, 0.0, -50.8), 3));
    }

    #[test]
    fn what_does_not_keep_lengths_is_refused() {
        let mirror = tracut(&statement("-1,0,0,5,0,1,0,0,0,0,1,0"), 1.0).unwrap().unwrap().unwrap();
        assert_eq!(mirror.point(&Point3::new(1.0, 2.0, 3.0)), Point3::new(4.0, 2.0, 3.0));
        for bad in
            ["2,0,0,5,0,1,0,0,0,0,1,0", "1,0,0,5,0,1,0,0,0,0.1,1,0", "1,0,0", "LAST,1,0,0,5,0,1,0,0,0,0,1,0"]
        {
            assert!(tracut(&statement(bad), 1.0).unwrap().is_err(), "{bad}");
        }
        for bad in ["1,SAME", "1", "1,SAME,1.5", "1,SAME,-1", "1,SAME,1e9", "1,TURN,5,2", "1,TRANSL,1,2,3"] {
            assert!(copy(&statement(bad), 1.0).unwrap().is_err(), "{bad}");
        }
    }
}
