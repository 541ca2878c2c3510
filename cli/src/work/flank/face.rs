//! A face as flank milling sees it: u along its directrices, v across from 0 to 1, the tool on the side of its normal.

use crate::failure::Failure;
use crate::job::Job;
use crate::job::words::{AlongWord, FlankShape};
use crate::part::{LoadedFace, Part};
use osculate_geom::{Axis, Domain, Interval, Jet2, Point3, Series, Side, Surface, Taylor, Uv, Vec3, uv};
use osculate_surfaces::TrimmedSurface;
use std::sync::Arc;

/// Places along and across at which a face is held against straight lines.
const LOOKS: [usize; 2] = [40, 12];

fn factorial(n: usize) -> f64 {
    (1..=n).map(|k| k as f64).product()
}

/// A face turned and scaled.
#[derive(Clone)]
pub struct Across {
    surface: Arc<dyn Surface>,
    along: Axis,
    across: Interval,
    range: Interval,
    flipped: bool,
    /// Straight between the borders, whatever the face does there.
    straight: bool,
}

impl Across {
    /// The face's own jet, turned and scaled.
    fn own_jet2(&self, at: Uv) -> Jet2 {
        let j = self.surface.jet2(self.native(at));
        let s = self.across.length();
        // Exchanging the parameters turns S_u x S_v over, and so does the other side of the face.
        let over = self.flipped != (self.along == Axis::V);
        let side = if over { j.side.flipped() } else { j.side };
        match self.along {
            Axis::U => Jet2 { uv: at, dv: j.dv * s, duv: j.duv * s, dvv: j.dvv * (s * s), side, ..j },
            Axis::V => Jet2 {
                uv: at,
                du: j.dv,
                dv: j.du * s,
                duu: j.dvv,
                duv: j.duv * s,
                dvv: j.duu * (s * s),
                side,
                ..j
            },
        }
    }

    fn own_taylor(&self, at: Uv, order: usize) -> Taylor {
        let t = self.surface.taylor(self.native(at), order);
        let over = self.flipped != (self.along == Axis::V);
        let t = if over { t.flipped() } else { t };
        let scale = self.across.length();
        let coefficient = |axis: usize, i: usize, j: usize| {
            let (a, b) = if self.along == Axis::U { (i, j) } else { (j, i) };
            t.derivative(a, b)[axis] * scale.powi(j as i32) / (factorial(i) * factorial(j))
        };
        let series = |axis: usize| Series::from_coefficients(t.order(), |i, j| coefficient(axis, i, j));
        Taylor { uv: at, side: t.side, coordinates: [series(0), series(1), series(2)] }
    }

    fn native(&self, at: Uv) -> Uv {
        Uv::from_axis(self.along, at.u, self.across.at(at.v))
    }

    /// How far lines across the face stray from the chords between their ends, mm.
    pub fn straying_mm(&self) -> f64 {
        let mut worst = 0.0_f64;
        for i in 0..=LOOKS[0] {
            let u = self.range.at(i as f64 / LOOKS[0] as f64);
            let [a, b] = [0.0, 1.0].map(|v| self.point(uv(u, v)));
            let chord = b - a;
            for j in 1..LOOKS[1] {
                let w = self.point(uv(u, j as f64 / LOOKS[1] as f64)) - a;
                let along = (w.dot(&chord) / chord.norm_squared()).clamp(0.0, 1.0);
                worst = worst.max((w - chord * along).norm());
            }
        }
        worst
    }
}

impl Surface for Across {
    fn domain(&self) -> Domain {
        Domain { u: self.range, v: Interval::new(0.0, 1.0) }
    }
    fn jet2(&self, at: Uv) -> Jet2 {
        if !self.straight {
            return self.own_jet2(at);
        }
        let [a, b] = [0.0, 1.0].map(|v| self.own_jet2(uv(at.u, v)));
        let mix = |x: Vec3, y: Vec3| x + (y - x) * at.v;
        let rule = b.point - a.point;
        Jet2 {
            uv: at,
            point: a.point + rule * at.v,
            du: mix(a.du, b.du),
            dv: rule,
            duu: mix(a.duu, b.duu),
            duv: b.du - a.du,
            dvv: Vec3::zeros(),
            side: a.side,
        }
    }
    fn taylor(&self, at: Uv, order: usize) -> Taylor {
        if !self.straight {
            return self.own_taylor(at, order);
        }
        let [a, b] = [0.0, 1.0].map(|v| self.own_taylor(uv(at.u, v), order));
        let border = |t: &Taylor, axis: usize| {
            let c: Vec<f64> = (0..=t.order()).map(|i| t.derivative(i, 0)[axis] / factorial(i)).collect();
            Series::along(Axis::U, &c, t.order())
        };
        let v = Series::variable(Axis::V, at.v, a.order());
        let series = |axis: usize| {
            let (p, q) = (border(&a, axis), border(&b, axis));
            p + (q - p) * v
        };
        Taylor { uv: at, side: a.side, coordinates: [series(0), series(1), series(2)] }
    }
    fn contains(&self, at: Uv) -> bool {
        self.straight || self.surface.contains(self.native(at))
    }
    fn point(&self, at: Uv) -> Point3 {
        if !self.straight {
            return self.surface.point(self.native(at));
        }
        let [a, b] = [0.0, 1.0].map(|v| self.surface.point(self.native(uv(at.u, v))));
        a + (b - a) * at.v
    }
}

/// The faces of a job, that to machine as `[flank]` says that it is judged: on its other side, or over a part of its length.
pub fn judged(job: &Job, all: Part) -> Result<Part, Failure> {
    if !job.flank().flipped && job.flank().judge_u.is_none() {
        return Ok(all);
    }
    let FlankFace { judged, .. } = FlankFace::of(job, &all)?;
    Ok(Part { faces: vec![judged], ..all })
}

/// A face ready to be flank milled.
#[non_exhaustive]
pub struct FlankFace {
    /// The face.
    pub face: Arc<Across>,
    /// Which of its own parameters runs along.
    pub along: Axis,
    /// How far its lines across stray from straight ones, mm.
    pub straying_mm: f64,
    /// The real face, where it is judged.
    pub judged: LoadedFace,
}

/// The rectangle of its own parameters that a face fills.
fn rectangle(face: &LoadedFace) -> Domain {
    let d = face.surface.domain();
    let mut points = face.surface.loops().iter().flat_map(|l| l.points.iter()).peekable();
    if !face.surface.is_trimmed() || points.peek().is_none() {
        return d;
    }
    let mut r = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for p in points {
        for (r, x) in r.iter_mut().zip([p.u, p.v]) {
            *r = [r[0].min(x), r[1].max(x)];
        }
    }
    Domain { u: Interval::new(r[0][0], r[0][1]), v: Interval::new(r[1][0], r[1][1]) }
}

impl FlankFace {
    /// The only machined face of a job.
    pub fn of(job: &Job, all: &Part) -> Result<Self, Failure> {
        let table = job.flank();
        let wrong = |text: String| Failure::file(job.path(), format!("[flank] {text}"));
        let [one] = all.faces.as_slice() else {
            return Err(Failure::file(
                job.path(),
                format!("[part] faces chooses {} faces; flank mills one at a time", all.faces.len()),
            ));
        };
        let flipped = table.flipped;
        let d = rectangle(one);
        let as_along = |along: Axis| {
            let (u, v) = (d.get(along), d.get(along.other()));
            let range = Interval::new(u.lo, u.hi);
            let across = Interval::new(v.lo, v.hi);
            let a = Across { surface: one.surface.clone(), along, across, range, flipped, straight: false };
            let straying = a.straying_mm();
            (a, straying)
        };
        let (across, straying_mm) = match table.along {
            AlongWord::U => as_along(Axis::U),
            AlongWord::V => as_along(Axis::V),
            AlongWord::Auto => {
                let (u, v) = (as_along(Axis::U), as_along(Axis::V));
                // Directrices run along u unless the lines across are straighter the other way.
                if v.1 < u.1 - 1e-9 * u.1.max(1e-9) { v } else { u }
            }
        };
        let across = match table.face {
            FlankShape::Own => across,
            FlankShape::Borders => Across { straight: true, ..across },
        };
        let whole = across.range;
        let judge = table.judge_u.unwrap_or(whole);
        if judge.lo < whole.lo - 1e-9 * whole.length() || judge.hi > whole.hi + 1e-9 * whole.length() {
            return Err(wrong(format!(
                "judge_u = [{}, {}] leaves the face, whose u runs from {} to {}",
                judge.lo, judge.hi, whole.lo, whole.hi
            )));
        }
        let mut judged = one.clone();
        if judge.lo > whole.lo || judge.hi < whole.hi {
            // The face itself, whatever stands for it while it is planned.
            let part = Across { range: judge, straight: false, ..across.clone() };
            let surface = TrimmedSurface::new(Arc::new(part), &[], Side::Along).map_err(Failure::job)?;
            judged.surface = Arc::new(surface);
            judged.part_of_it = Some(format!("u = {} to {} along it", judge.lo, judge.hi));
        } else if flipped {
            judged.surface = Arc::new(TrimmedSurface::clone(&judged.surface).flipped());
        }
        let along = across.along;
        Ok(Self { face: Arc::new(across), along, straying_mm, judged })
    }
}
