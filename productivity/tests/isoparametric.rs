//! What isoparametric plans leave on a part, judged by closed forms rather than by the planner's own reach.

use crate::cutting::joined;

use joined::joined;
use osculate_geom::analytic::{Cylinder, Paraboloid, Plane, Torus};
use osculate_geom::{
    Axis, Domain, Flipped, Interval, Jet2, Patch, Point3, Series, Side, Surface, Taylor, Unit3, Uv, Vec3, uv,
};
use osculate_productivity::plan::{Along, Leaning, LocalLead, Task, Tolerance, isoparametric};
use osculate_tools::cl::{ClMove, Motion};
use osculate_tools::{Contact, Cutter, CutterSpec, FeedLine, Lean, Pose, strip};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Mutex;

/// Material left at a point along its normal by a ball that moves linearly between CL points: the first meeting of the
/// line with a sphere or with the cylinder around each segment of ball centres, in closed form. The cutter's
/// body above the ball is left out, so that only the ball's own work counts.
fn left_by_ball(point: &Point3, normal: &Unit3, centres: &[Point3], radius: f64) -> f64 {
    let sphere = |c: &Point3| -> f64 {
        let w = c - point;
        let along = w.dot(normal);
        let off2 = w.norm_squared() - along * along;
        if off2 <= radius * radius { along - (radius * radius - off2).sqrt() } else { f64::INFINITY }
    };
    let mut best = f64::INFINITY;
    for w in centres.windows(2) {
        let (a, b) = (&w[0], &w[1]);
        if (a - point).norm() > radius + 3.0 {
            continue;
        }
        best = best.min(sphere(a)).min(sphere(b));
        // The cylinder: perpendicular parts to the segment.
        let axis = b - a;
        let l2 = axis.norm_squared();
        if l2 == 0.0 {
            continue;
        }
        let perp = |v: Vec3| v - axis * (v.dot(&axis) / l2);
        let (o, d) = (perp(point - a), perp(normal.into_inner()));
        let (qa, qb, qc) = (d.norm_squared(), o.dot(&d), o.norm_squared() - radius * radius);
        let disc = qb * qb - qa * qc;
        if qa > 1e-12 && disc >= 0.0 {
            let s = (-qb - disc.sqrt()) / qa;
            let t = (point + normal.into_inner() * s - a).dot(&axis) / l2;
            if (0.0..=1.0).contains(&t) {
                best = best.min(s);
            }
        }
    }
    best
}

fn centres(moves: &[ClMove], radius: f64) -> Vec<Point3> {
    // The axis turns little between points, so that the centre's path is straight to within rounding of what is
    // asserted; four pieces a segment make that certain.
    let at = |p: &Pose| p.tip + p.axis.into_inner() * radius;
    let mut out = vec![at(&moves[0].pose)];
    for w in moves.windows(2) {
        if matches!(w[1].motion, Motion::Rapid) {
            out.push(at(&w[1].pose));
            continue;
        }
        for k in 1..=4 {
            let f = f64::from(k) / 4.0;
            let axis = Unit3::new_normalize(w[0].pose.axis.lerp(&w[1].pose.axis, f));
            out.push(at(&Pose { tip: w[0].pose.tip + (w[1].pose.tip - w[0].pose.tip) * f, axis }));
        }
    }
    out
}

fn plan(surface: &dyn Surface, cutter: &Cutter, lean: Lean, tolerance: Tolerance) -> Vec<ClMove> {
    let task = Task::new("F1", surface, cutter, lean, tolerance);
    let passes = isoparametric(&task, Along::Fixed(Axis::U)).unwrap();
    joined(surface, &passes.passes, cutter).moves
}

#[test]
fn saddle_with_a_ball_holds_the_tolerance_everywhere_inside() {
    let surface = Paraboloid::new([0.005, -0.003], 10.0).unwrap();
    let cutter = Cutter::try_from(CutterSpec::Ball { diameter_mm: 10.0, length_mm: 50.0 }).unwrap();
    let tolerance = Tolerance { scallop_mm: 0.01, gouge_mm: 0.003, chord_mm: 0.002 };
    for lead in [0.0, 0.2] {
        let moves = plan(&surface, &cutter, Lean { lead_rad: lead, tilt_rad: 0.0 }, tolerance);
        let centres = centres(&moves, 5.0);
        let (mut highest, mut deepest) = (0.0f64, 0.0f64);
        let mut above_60 = 0;
        let n = 150;
        for i in 0..=n {
            // Columns of samples across the passes, so dense that they meet the cusps.
            let x = -9.0 + 18.0 * f64::from(i) / f64::from(n);
            let mut column_high = 0.0f64;
            for j in 0..=n * 2 {
                let y = -9.0 + 18.0 * f64::from(j) / f64::from(2 * n);
                let jet = surface.jet2(uv(x, y));
                let left = left_by_ball(&jet.point, &jet.normal().unwrap(), &centres, 5.0);
                highest = highest.max(left);
                deepest = deepest.min(left);
                column_high = column_high.max(left);
            }
            above_60 += i32::from(column_high > 0.006);
        }
        println!("lead {lead}: {} points, left {highest:.5}, cut {deepest:.5}", moves.len());
        assert!(highest <= 0.0100, "{highest}");
        assert!(deepest >= -0.003, "{deepest}");
        // The spacing is used: nearly everywhere the cusps reach at least 60 % of the tolerance.
        assert!(above_60 > n * 9 / 10, "{above_60}");
    }
}

#[test]
fn groove_passes_are_evenly_spaced_by_the_exact_strip() {
    let torus = Torus::new(200.0, 60.0).unwrap();
    let domain = Domain { u: Interval::new(0.0, 0.3), v: Interval::new(2.6, 3.7) };
    let groove = Flipped(Patch { surface: torus, domain, side: Side::Along });
    let spec = CutterSpec::Toroidal { diameter_mm: 20.0, corner_radius_mm: 2.0, length_mm: 60.0 };
    let cutter = Cutter::try_from(spec).unwrap();
    let lean = Lean { lead_rad: 12f64.to_radians(), tilt_rad: 0.0 };
    let tolerance = Tolerance { scallop_mm: 0.01, gouge_mm: 0.005, chord_mm: 0.002 };
    let task = Task::new("F1", &groove, &cutter, lean, tolerance);
    let passes = isoparametric(&task, Along::Fixed(Axis::U)).unwrap().passes;
    assert!(passes.len() > 10);
    // Two neighbouring passes leave the design height, 98 % of the tolerance, where their exact strips meet: the
    // spacing is the strip's width there, up to the change of width from one pass to the next.
    for w in passes[1..passes.len() - 1].windows(2) {
        let (a, b) = (&w[0].points[0], &w[1].points[0]);
        let spacing = 60.0 * (b.uv.v - a.uv.v);
        let width = |at| {
            let contact = Contact::new(&groove, at, &cutter, FeedLine::Iso(Axis::U), lean).unwrap();
            strip::exact(&contact, 0.0098).unwrap().width_mm
        };
        // At the end of the face, on which the tool goes on, a strip is cut short.
        let want = 0.5 * (width(uv(0.15, a.uv.v)) + width(uv(0.15, b.uv.v)));
        assert!((spacing / want - 1.0).abs() < 0.02, "{spacing} against {want}");
    }
    for p in &passes {
        assert!(p.points.iter().all(|c| c.width_mm > 1.0 && c.width_mm < 5.0));
    }
}

#[test]
fn a_tool_too_large_for_the_hollow_is_refused_with_the_largest_that_fits() {
    let torus = Torus::new(200.0, 60.0).unwrap();
    let domain = Domain { u: Interval::new(0.0, 0.3), v: Interval::new(2.6, 3.7) };
    let groove = Flipped(Patch { surface: torus, domain, side: Side::Along });
    let cutter = Cutter::try_from(CutterSpec::Ball { diameter_mm: 130.0, length_mm: 200.0 }).unwrap();
    let tolerance = Tolerance { scallop_mm: 0.01, gouge_mm: 0.005, chord_mm: 0.002 };
    let task = Task::new("F7", &groove, &cutter, Lean::default(), tolerance);
    let error = isoparametric(&task, Along::Auto).unwrap_err().to_string();
    assert!(error.contains("F7") && error.contains("does not fit"), "{error}");
    assert!(error.contains("60.000 mm or less") || error.contains("59.999"), "{error}");
}

/// With both directions laid out to find the shorter, and with leads found place by place, what is told of the progress never
/// falls back: a run that is stopped says how far it came.
#[test]
fn progress_goes_on_only() {
    let surface = Paraboloid::new([0.004, -0.006], 8.0).unwrap();
    let spec = CutterSpec::Toroidal { diameter_mm: 10.0, corner_radius_mm: 2.0, length_mm: 50.0 };
    let cutter = &Cutter::try_from(spec).unwrap();
    let held = Lean { lead_rad: 0.1, tilt_rad: 0.0 };
    let local = LocalLead {
        tilt_rad: Some(0.0),
        least_rad: 0.05,
        most_rad: LocalLead::MOST_RAD,
        rate_rad_per_mm: 0.02,
        holder: None,
        around: None,
    };
    for lean in [held.into(), Leaning::Local(&local)] {
        let told = Mutex::new(Vec::new());
        let tolerance = Tolerance { scallop_mm: 0.01, gouge_mm: 0.005, chord_mm: 0.002 };
        let progress = |f: f64| told.lock().unwrap().push(f);
        let task = Task::new("F1", &surface, cutter, lean, tolerance).watched(&progress);
        // Threads may tell theirs in any order.
        let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        one_thread.install(|| isoparametric(&task, Along::Auto)).unwrap();
        let told = told.into_inner().unwrap();
        assert!(told.len() > 10 && told.is_sorted(), "{told:?}");
        assert_eq!(told.last(), Some(&1.0));
    }
}

/// On a plane the bottom circle of a leaning tool, of radius 8 mm, is at its lowest in front, and comes down to a place `d` beside
/// the line of contacts 8 - sqrt(64 - d^2) mm further on only. Between the passes what is left at the border is what is left
/// inside: the design height, 98 % of the scallop.
#[test]
fn passes_run_out_until_the_border_is_cut_between_them() {
    let i = Interval::new(0.0, 24.0);
    let plane = Plane::new(Domain { u: i, v: i });
    let spec = CutterSpec::Toroidal { diameter_mm: 20.0, corner_radius_mm: 2.0, length_mm: 50.0 };
    let cutter = &Cutter::try_from(spec).unwrap();
    let lean = Lean { lead_rad: 3f64.to_radians(), tilt_rad: 0.0 };
    let tolerance = Tolerance { scallop_mm: 0.01, gouge_mm: 0.005, chord_mm: 0.002 };
    let (face, progress) = ("F1", &|_| {});
    let task = Task::new(face, &plane, cutter, lean, tolerance).watched(progress);
    let passes = isoparametric(&task, Along::Fixed(Axis::U)).unwrap().passes;
    let inside = |p: &Point3, pose: &Pose| {
        let way = p - pose.tip;
        let z = way.dot(&pose.axis);
        let rho = (way.norm_squared() - z * z).max(0.0).sqrt();
        z > 0.0 && rho < if z < 2.0 { 8.0 + (4.0 - (2.0 - z).powi(2)).sqrt() } else { 10.0 }
    };
    let mut poses: Vec<Pose> = Vec::new();
    for w in passes.iter().flat_map(|p| p.points.windows(2)) {
        let way = w[1].pose.tip - w[0].pose.tip;
        let steps = (way.norm() / 0.02).ceil();
        let at = |k: usize| Pose { tip: w[0].pose.tip + way * (k as f64 / steps), axis: w[0].pose.axis };
        poses.extend((0..=steps as usize).map(at));
    }
    // No further than that takes.
    for p in &passes {
        let ends = [p.points[0].point.x, p.points[p.points.len() - 1].point.x];
        let [lo, hi] = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        assert!(lo > -0.5 && hi < 24.5, "{ends:?}");
    }
    for x in [0.0, 24.0] {
        let near: Vec<&Pose> = poses.iter().filter(|p| (p.tip.x - x).abs() < 12.0).collect();
        let mut highest = 0.0f64;
        for k in 0..=240 {
            let y = 0.1 * f64::from(k);
            let (mut cut, mut left) = (0.02, 0.0);
            for _ in 0..12 {
                let z = 0.5 * (cut + left);
                let p = Point3::new(x, y, z);
                if near.iter().any(|pose| inside(&p, pose)) { cut = z } else { left = z }
            }
            highest = highest.max(left);
        }
        assert!(highest > 0.0085 && highest <= 0.01, "{highest} at x = {x}");
    }
}

/// Round a cylinder the tip goes on a circle, and on chords of it the tool sags by its radius times 1 - cos(angle / 2): the steps are as
/// long as that allows, but for the twentieth that they aim short of it and the first and last few.
#[test]
fn steps_round_a_cylinder_are_as_long_as_the_chord_allows() {
    let (radius, ball_mm, lead_rad) = (20.0, 5.0, 0.2f64);
    let cylinder = Cylinder::new(radius, Interval::new(0.0, 4.0)).unwrap();
    let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 2.0 * ball_mm, length_mm: 50.0 }).unwrap();
    for scallop_mm in [0.001, 0.01, 0.1] {
        let tolerance = Tolerance { scallop_mm, gouge_mm: 0.5 * scallop_mm, chord_mm: 0.2 * scallop_mm };
        let task = Task::new("cylinder", &cylinder, &ball, Lean { lead_rad, tilt_rad: 0.0 }, tolerance);
        let passes = isoparametric(&task, Along::Fixed(Axis::U)).unwrap();
        // Planning leaves a twentieth of the scallop to the chords.
        let centre = radius + ball_mm;
        let tip = (centre * centre + ball_mm * ball_mm - 2.0 * centre * ball_mm * lead_rad.cos()).sqrt();
        let most_rad = 2.0 * (1.0 - 0.05 * scallop_mm / tip).acos();
        for pass in &passes.passes {
            let turns: Vec<f64> = pass.points.windows(2).map(|w| w[0].normal.angle(&w[1].normal)).collect();
            let longest = turns.iter().copied().fold(0.0, f64::max);
            assert!(longest <= most_rad * (1.0 + 1e-3), "{longest} over {most_rad}");
            let least = turns.iter().sum::<f64>() / most_rad;
            assert!((turns.len() as f64) < 1.12 * least + 6.0, "{} steps for {least}", turns.len());
        }
    }
}

/// A washboard, `z = slope / k sin(k u)`, knots a quarter of a wave apart.
struct Washboard {
    slope: f64,
    k: f64,
}

impl Surface for Washboard {
    fn domain(&self) -> Domain {
        Domain { u: Interval::new(0.0, 8.0), v: Interval::new(0.0, 3.0) }
    }
    fn jet2(&self, at: Uv) -> Jet2 {
        self.taylor(at, 2).jet2()
    }
    fn taylor(&self, at: Uv, order: usize) -> Taylor {
        let (x, y) = (Series::variable(Axis::U, at.u, order), Series::variable(Axis::V, at.v, order));
        let z = (x * self.k).sin_cos().0 * (self.slope / self.k);
        Taylor { uv: at, side: Side::Along, coordinates: [x, y, z] }
    }
    fn breaks(&self, axis: Axis) -> Vec<f64> {
        let i = self.domain().get(axis);
        let quarters = if axis == Axis::U { (i.length() * self.k / FRAC_PI_2).round() as usize } else { 1 };
        (0..=quarters).map(|q| i.at(q as f64 / quarters as f64)).collect()
    }
}

/// Ripples as long as the stretch over which a held lead's normal is averaged to either side, whose mean is flat: the axis keeps its lead to
/// the flat as far as a tenth of the lead allows, where the normals at the contacts swing with what a short mean leaves of them.
#[test]
fn an_axis_at_a_held_lead_does_not_swing_with_ripples() {
    let spec = CutterSpec::Toroidal { diameter_mm: 6.0, corner_radius_mm: 1.0, length_mm: 50.0 };
    let cutter = Cutter::try_from(spec).unwrap();
    // A twentieth of the radius, four times.
    let face = Washboard { slope: 0.03, k: TAU / (4.0 * 0.05 * 3.0) };
    let tolerance = Tolerance { scallop_mm: 0.02, gouge_mm: 0.01, chord_mm: 0.004 };
    for (lead_deg, bound) in [(20f64, false), (3.0, true)] {
        let lead_rad = lead_deg.to_radians();
        let task = Task::new("washboard", &face, &cutter, Lean { lead_rad, tilt_rad: 0.0 }, tolerance);
        let passes = isoparametric(&task, Along::Fixed(Axis::U)).unwrap().passes;
        let (mut off_flat, mut swing, mut off_lead) = (0.0f64, 0.0f64, 0.0f64);
        for p in passes.iter().flat_map(|p| &p.points).filter(|p| (1.0..7.0).contains(&p.uv.u)) {
            off_flat = off_flat.max((p.pose.axis.angle(&Vec3::z_axis()) - lead_rad).abs());
            swing = swing.max(p.normal.angle(&Vec3::z_axis()));
            off_lead = off_lead.max((p.pose.axis.angle(&p.normal) - lead_rad).abs());
        }
        let most = 0.1 * lead_rad;
        assert!(swing > 0.02 && swing < 0.03, "{swing}");
        assert!(off_lead < most + 1e-3, "{off_lead} of {most}");
        if bound {
            assert!(
                off_lead > 0.9 * most && off_flat > swing - most - 1e-3,
                "{off_lead}, {off_flat} of {swing}"
            );
        } else {
            assert!(off_flat < 1e-3, "{off_flat}");
        }
    }
}
