//! Passes of a ball at constant height of its centre along a fixed axis (2CL, [M86, section 2]).
//!
//! A ball of radius R that touches at S has its centre at `S + R n`. With the tool axis a, a 2CL machine keeps
//! `H(u, v) = a . (S + R n)` constant on a pass: passes are contour lines of H, the CC points lie near contour lines of the face.
//!
//! Levels: a pass at level z leaves a place within tolerance if the contour H = z comes within half a strip of it. The
//! levels that do so for the whole face are the fewest numbers that stab the intervals of H over discs of half a
//! strip around a dense set of places: taken greedily from below.

use super::march::Grid;
use super::resample::{Knot, contact_points};
use super::{MAX_PASSES, Pass, Passes, PlanError, Task};
use osculate_geom::{Axis, Diagnostic, Unit3, Uv, uv};
use osculate_tools::sweep::{LinearMotion, SweptMotion};
use osculate_tools::{Contact, FeedLine, Lean, Pose, strip};
use rayon::prelude::*;

/// Grid nodes along one parameter, at most.
const MAX_NODES: usize = 700;
/// Halvings of one piece of a contour.
const MAX_DEPTH: u32 = 12;
/// Below this sine of the slope a contour is no longer a pass: the ball's tip, which does not cut, touches the part.
const FLAT_SINE: f64 = 0.02;

/// The height field of the ball's centre over a grid of parameters.
struct Field<'a> {
    task: &'a Task<'a>,
    axis: Unit3,
    n: [usize; 2],
    height: Vec<f64>,
    /// a . n at the node; NaN outside the face.
    facing: Vec<f64>,
}

impl Field<'_> {
    fn uv(&self, i: usize, j: usize) -> Uv {
        let d = self.task.surface.domain();
        d.at(i as f64 / self.n[0] as f64, j as f64 / self.n[1] as f64)
    }

    fn index(&self, i: usize, j: usize) -> usize {
        i * (self.n[1] + 1) + j
    }

    /// H, a . n and the gradient of H in the parameters; None without a tangent plane.
    fn at(&self, at: Uv) -> Option<(f64, f64, [f64; 2])> {
        let jet = self.task.surface.jet2(at);
        let forms = jet.forms().ok()?;
        let r = self.task.cutter.radius_mm();
        let a = self.axis.into_inner();
        let facing = forms.normal.dot(&a);
        // n_d = W d in the tangent frame, for d = S_u and S_v.
        let tangential = [a.dot(&forms.frame[0]), a.dot(&forms.frame[1])];
        let slope = |d: osculate_geom::Vec3| {
            let c = [d.dot(&forms.frame[0]), d.dot(&forms.frame[1])];
            let w = &forms.curvature;
            let nd = [w[(0, 0)] * c[0] + w[(0, 1)] * c[1], w[(0, 1)] * c[0] + w[(1, 1)] * c[1]];
            tangential[0] * (c[0] + r * nd[0]) + tangential[1] * (c[1] + r * nd[1])
        };
        Some((jet.point.coords.dot(&a) + r * facing, facing, [slope(jet.du), slope(jet.dv)]))
    }

    /// The parameters moved along the gradient onto H = z; None where Newton does not get there.
    fn project(&self, mut at: Uv, z: f64, tolerance: f64) -> Option<Uv> {
        let domain = self.task.surface.domain();
        let (lu, lv) = (domain.u.length(), domain.v.length());
        for _ in 0..20 {
            let (h, _, [gu, gv]) = self.at(at)?;
            if (h - z).abs() <= tolerance {
                return Some(at);
            }
            // The gradient in parameters scaled to their ranges.
            let (su, sv) = (gu * lu, gv * lv);
            let g2 = su * su + sv * sv;
            if g2 <= 0.0 {
                return None;
            }
            let k = (z - h) / g2;
            at = domain.bring(uv(at.u + k * su * lu, at.v + k * sv * lv));
        }
        None
    }
}

/// Plans passes at constant height along `axis` with a ball whose axis stays on it.
///
/// ```
/// use osculate_geom::{Vec3, analytic::Paraboloid};
/// use osculate_productivity::plan::{Task, Tolerance, contour_2cl};
/// use osculate_tools::{Cutter, CutterSpec, Lean};
///
/// // A shallow bowl: the ball keeps its height along each pass, to a thousandth of the chord tolerance.
/// let bowl = Paraboloid::new([0.01, 0.01], 10.0)?;
/// let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 10.0, length_mm: 50.0 })?;
/// let lean = Lean { lead_rad: 0.0, tilt_rad: 0.0 };
/// let tolerance = Tolerance { scallop_mm: 0.1, gouge_mm: 0.01, chord_mm: 0.01 };
/// let task = Task::new("bowl", &bowl, &ball, lean, tolerance);
/// for pass in contour_2cl(&task, Vec3::z_axis())?.passes {
///     let z = pass.points[0].pose.tip.z;
///     assert!(pass.points.iter().all(|p| (p.pose.tip.z - z).abs() <= 2e-3 * tolerance.chord_mm));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`PlanError::Tool`] for a cutter that is not a ball; [`PlanError::Nothing`] where no place faces the axis.
pub fn contour_2cl(task: &Task<'_>, axis: Unit3) -> Result<Passes, PlanError> {
    task.check()?;
    if !task.cutter.is_ball() {
        return Err(PlanError::Tool { strategy: "contour_2cl", need: "ball cutter" });
    }
    let field = field(task, axis)?;
    let (intervals, lost) = intervals(&field)?;
    if intervals.is_empty() {
        return Err(PlanError::Nothing {
            face: task.face.to_owned(),
            why: "no place of it faces the tool axis; give another axis".to_owned(),
        });
    }
    let levels = stab(intervals);
    if levels.len() > MAX_PASSES {
        return Err(PlanError::TooManyPasses {
            face: task.face.to_owned(),
            limit: MAX_PASSES,
            scallop_mm: task.tolerance.scallop_mm,
        });
    }
    (task.progress)(0.5);
    let built: Vec<Vec<Pass>> = levels.par_iter().map(|z| passes_at(&field, *z)).collect();
    (task.progress)(1.0);
    let passes = to_and_fro(built.into_iter().flatten().collect());
    let mut out = Passes { passes, diagnostics: Vec::new() };
    out.diagnostics.push(Diagnostic::note(
        task.face,
        format!("{} contour passes on {} levels, {:.0} mm", out.passes.len(), levels.len(), out.length_mm()),
    ));
    for (share, what) in lost {
        if share > 1e-3 {
            out.diagnostics.push(Diagnostic::loss(
                task.face,
                format!("{:.1} % of the face {what}; it is left uncut by this strategy", 100.0 * share),
            ));
        }
    }
    if out.passes.is_empty() {
        return Err(PlanError::Nothing {
            face: task.face.to_owned(),
            why: "the face is flat across the tool axis: it has no contour lines; give another axis"
                .to_owned(),
        });
    }
    Ok(out)
}

/// Turns open passes over where that brings their start nearer to the end of the one before: a ball without lead
/// cuts the same both ways.
fn to_and_fro(mut passes: Vec<Pass>) -> Vec<Pass> {
    let mut last: Option<osculate_geom::Point3> = None;
    for pass in &mut passes {
        let (Some(a), Some(b)) = (pass.points.first(), pass.points.last()) else { continue };
        if let Some(l) = last
            && !pass.closed
            && (b.point - l).norm() < (a.point - l).norm()
        {
            pass.points.reverse();
        }
        last = pass.points.last().map(|p| p.point);
    }
    passes
}

/// Heights at the nodes of a grid whose cells are smaller than half a strip.
fn field<'a>(task: &'a Task<'a>, axis: Unit3) -> Result<Field<'a>, PlanError> {
    let surface = task.surface;
    let d = surface.domain();
    let half = (2.0 * task.tolerance.scallop_mm * task.cutter.radius_mm()).sqrt();
    let length = |along: Axis| -> f64 {
        (0..=4)
            .map(|k| {
                let at = |t: f64| {
                    let across = d.get(along.other()).at(f64::from(k) / 4.0);
                    surface.point(Uv::from_axis(along, d.get(along).at(t), across))
                };
                (0..40).map(|s| (at(f64::from(s + 1) / 40.0) - at(f64::from(s) / 40.0)).norm()).sum()
            })
            .fold(0.0, f64::max)
    };
    let nodes = |along: Axis| ((length(along) / (0.6 * half)).ceil() as usize).clamp(24, MAX_NODES);
    let n = [nodes(Axis::U), nodes(Axis::V)];
    let mut f = Field { task, axis, n, height: Vec::new(), facing: Vec::new() };
    let rows: Vec<Vec<(f64, f64)>> = (0..=n[0])
        .into_par_iter()
        .map(|i| {
            (0..=n[1])
                .map(|j| {
                    let at = f.uv(i, j);
                    f.at(at).map_or((f64::NAN, f64::NAN), |(h, c, _)| {
                        (h, if surface.contains(at) { c } else { f64::NAN })
                    })
                })
                .collect()
        })
        .collect();
    for (h, c) in rows.into_iter().flatten() {
        f.height.push(h);
        f.facing.push(c);
    }
    Ok(f)
}

/// A share of the face, and what is the matter with it.
type Share = (f64, &'static str);

/// Stretches of level that a pass must meet for each inside node, and the shares of the face that no pass can do.
fn intervals(f: &Field<'_>) -> Result<(Vec<[f64; 2]>, [Share; 2]), PlanError> {
    let task = f.task;
    let domain = task.surface.domain();
    let h = task.design_scallop_mm(-1.0, 0.0);
    let found: Vec<Result<Option<[f64; 2]>, PlanError>> = (0..f.height.len())
        .into_par_iter()
        .map(|k| {
            let (i, j) = (k / (f.n[1] + 1), k % (f.n[1] + 1));
            let facing = f.facing[k];
            if facing.is_nan() || facing <= 0.0 || facing > (1.0 - FLAT_SINE * FLAT_SINE).sqrt() {
                return Ok(None);
            }
            let at = f.uv(i, j);
            let jet = task.surface.jet2(at);
            let forms = jet.forms().map_err(|e| task.contact(e.into()))?;
            // The feed goes across the slope: along n x a.
            let feed = forms.normal.cross(&f.axis);
            let rate = forms.rate(&jet, &feed);
            let angle = {
                let t = jet.tangent(rate);
                let e2 = forms.frame[1].into_inner() * jet.side.sign();
                t.dot(&e2).atan2(t.dot(&forms.frame[0]))
            };
            let contact =
                Contact::new(task.surface, at, task.cutter, FeedLine::Angle(angle), Lean::default())
                    .map_err(|e| task.contact(e))?;
            contact.fits().map_err(|e| task.contact(e))?;
            let half = match strip::exact(&contact, h) {
                // An edge of the face ends a strip, not the tolerance: the other side tells the width.
                Ok(s) if s.at_edge[0] => s.right_mm,
                Ok(s) if s.at_edge[1] => s.left_mm,
                Ok(s) => s.left_mm.min(s.right_mm),
                Err(e) => return Err(task.strip(e)),
            };
            // H over the circle of half a strip: eight directions and the centre.
            let mut range = [f.height[k]; 2];
            for q in 0..8 {
                let (s, c) = (std::f64::consts::FRAC_PI_4 * f64::from(q)).sin_cos();
                let d = forms.frame[0].into_inner() * c + forms.frame[1].into_inner() * s;
                let r = forms.rate(&jet, &d);
                let p = uv(at.u + half * r.u, at.v + half * r.v);
                if domain.contains(p)
                    && let Some((height, ..)) = f.at(p)
                {
                    range = [range[0].min(height), range[1].max(height)];
                }
            }
            Ok(Some(range))
        })
        .collect();
    let mut out = Vec::new();
    let (mut inside, mut undercut, mut flat) = (0u32, 0u32, 0u32);
    for (k, r) in found.into_iter().enumerate() {
        if !f.facing[k].is_nan() {
            inside += 1;
            undercut += u32::from(f.facing[k] <= 0.0);
        }
        match r? {
            Some(range) => out.push(range),
            None => flat += u32::from(f.facing[k] > 0.0),
        }
    }
    let share = |n: u32| f64::from(n) / f64::from(inside.max(1));
    Ok((
        out,
        [
            (share(undercut), "faces away from the tool axis"),
            (share(flat), "is level, where only the ball's tip would cut"),
        ],
    ))
}

/// The fewest levels that meet every interval, ascending.
fn stab(mut intervals: Vec<[f64; 2]>) -> Vec<f64> {
    intervals.sort_by(|a, b| a[1].total_cmp(&b[1]));
    let mut levels: Vec<f64> = Vec::new();
    for [lo, hi] in intervals {
        if levels.last().is_none_or(|z| *z < lo) {
            levels.push(hi);
        }
    }
    levels
}

/// The passes on one level: marching squares, the pieces chained, refined and thinned.
fn passes_at(f: &Field<'_>, z: f64) -> Vec<Pass> {
    let chains = march(f, z);
    let mut out = Vec::new();
    for (chain, closed) in chains {
        let tolerance = 1e-3 * f.task.tolerance.chord_mm;
        let mut run: Vec<Knot> = Vec::new();
        let mut whole = true;
        let flush = |run: &mut Vec<Knot>, closed: bool, out: &mut Vec<Pass>| {
            if run.len() >= 2 {
                let uvs: Vec<Uv> = run.iter().map(|k| uv(k.t, k.v)).collect();
                let mut points = contact_points(run, |_| uv(0.0, 0.0));
                for (p, at) in points.iter_mut().zip(uvs) {
                    p.uv = at;
                    p.width_mm = width(f, at);
                }
                out.push(Pass { points, closed });
            }
            run.clear();
        };
        for at in chain {
            let knot = f.project(at, z, tolerance).and_then(|p| knot(f, p));
            match knot {
                Some(k) => match run.last().copied() {
                    Some(last) => join(f, z, tolerance, last, k, 0, &mut run),
                    None => run.push(k),
                },
                None => {
                    whole = false;
                    flush(&mut run, false, &mut out);
                }
            }
        }
        flush(&mut run, closed && whole, &mut out);
    }
    out
}

/// Strip width at a contact, across the slope.
fn width(f: &Field<'_>, at: Uv) -> f64 {
    let task = f.task;
    let jet = task.surface.jet2(at);
    let Ok(forms) = jet.forms() else { return f64::NAN };
    let across = f.axis.into_inner() - forms.normal.into_inner() * forms.normal.dot(&f.axis);
    if across.norm() == 0.0 {
        return f64::NAN;
    }
    let section = crate::closed_form::Section {
        part_per_mm: forms.normal_curvature(&across),
        tool_per_mm: 1.0 / task.cutter.radius_mm(),
        scallop_mm: task.tolerance.scallop_mm,
    };
    crate::closed_form::width_37(section).unwrap_or(f64::NAN)
}

fn knot(f: &Field<'_>, at: Uv) -> Option<Knot> {
    let jet = f.task.surface.jet2(at);
    let normal = jet.normal().ok()?;
    if normal.dot(&f.axis) < 0.0 {
        return None;
    }
    let r = f.task.cutter.radius_mm();
    let tip = jet.point + normal.into_inner() * r - f.axis.into_inner() * r;
    let pose = Pose { tip, axis: f.axis };
    Some(Knot { t: at.u, v: at.v, point: jet.point, normal, pose, height: 0.0 })
}

/// Appends the contour from `a` to `b`, halved until the straight motion holds the chord tolerance.
fn join(f: &Field<'_>, z: f64, tolerance: f64, a: Knot, b: Knot, depth: u32, out: &mut Vec<Knot>) {
    let mid_uv = uv(0.5 * (a.t + b.t), 0.5 * (a.v + b.v));
    let mid = f.project(mid_uv, z, tolerance).and_then(|p| knot(f, p));
    if let Some(m) = mid
        && depth < MAX_DEPTH
    {
        let chord = b.point - a.point;
        let l2 = chord.norm_squared();
        let along = if l2 > 0.0 { ((m.point - a.point).dot(&chord) / l2).clamp(0.0, 1.0) } else { 0.5 };
        let motion = LinearMotion { from: a.pose, to: b.pose };
        let off = motion.at(along).map_or(f64::INFINITY, |s| f.task.cutter.distance(&s.pose, &m.point).abs());
        if off > f.task.tolerance.chord_mm {
            join(f, z, tolerance, a, m, depth + 1, out);
            join(f, z, tolerance, m, b, depth + 1, out);
            return;
        }
    }
    out.push(b);
}

/// Chains of parameters near the level line, each with whether it closes.
fn march(f: &Field<'_>, z: f64) -> Vec<(Vec<Uv>, bool)> {
    let inside = |i: usize, j: usize| {
        // Cells that touch the face: a pass may run out over its trim by one cell.
        [(0, 0), (1, 0), (0, 1), (1, 1)].iter().any(|(a, b)| !f.facing[f.index(i + a, j + b)].is_nan())
    };
    let domain = f.task.surface.domain();
    let place = |p: [f64; 2]| domain.at(p[0] / f.n[0] as f64, p[1] / f.n[1] as f64);
    let grid = Grid { count: f.n, values: &f.height, closes: [false; 2] };
    grid.lines(z, inside)
        .into_iter()
        .map(|(l, closed)| (l.into_iter().map(place).collect(), closed))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stabbing_is_greedy_and_complete() {
        let intervals = vec![[0.0, 1.0], [0.9, 2.0], [2.5, 3.0], [0.5, 4.0], [3.5, 3.6]];
        let levels = stab(intervals.clone());
        assert_eq!(levels, vec![1.0, 3.0, 3.6]);
        assert!(intervals.iter().all(|[a, b]| levels.iter().any(|z| z >= a && z <= b)));
    }
}
