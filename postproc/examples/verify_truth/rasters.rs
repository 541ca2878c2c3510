//! Scallops between two passes of ball and toroidal ends on plane, cylinder, sphere and torus.
//!
//! The sample stands on the cusp, half way between the passes. Closed forms: a ball's section is a circle about the part's
//! section grown (or shrunk) by the ball's radius; seen along the feed a leaned toroidal end is the corner's offset of an
//! ellipse. Toroidal ends along parallels of sphere and torus have none: there the tool is turned about the axis in
//! frozen poses, and a ray's way to it is found by bisection on a distance written out here.

use super::{ball, pose, run, sample, through, toroidal};
use osculate_geom::analytic::{Cylinder, Sphere, Torus};
use osculate_geom::{Axis, Flipped, Interval, Point3, Surface, Vec3, uv};
use osculate_tools::removal::{Job, Swept, Wanted, cut, hidden, sample_surface};
use osculate_tools::{Contact, Cutter, FeedLine, Lean, Pose};

/// The tolerance that deviations are compared with, mm.
const TOLERANCE: f64 = 0.01;
/// Of the tolerance.
const ALLOWED: f64 = 1e-4;

struct Row {
    part: &'static str,
    tool: &'static str,
    step_mm: f64,
    measured: f64,
    truth: f64,
    how: &'static str,
}

/// Across the feed and above the contact: a point of a leaned toroidal end's outline, and the slope there.
fn outline(cutter: &Cutter, lead: f64, phi: f64) -> (f64, f64) {
    let (core, r) = (cutter.core_mm(), cutter.corner_mm());
    let low = core * lead.sin();
    let (sin, cos) = phi.sin_cos();
    let normal = (sin / core).hypot(cos / low);
    (core * sin + r * (sin / core) / normal, r + low - low * cos - r * (cos / low) / normal)
}

/// A ball's passes in the meridian plane of a body of this radius of curvature, turned by `step` about its middle.
fn ball_cusp(part: f64, tool: f64, hollow: bool, step: f64) -> f64 {
    let sign = if hollow { -1.0 } else { 1.0 };
    let (centre, off) = (part + sign * tool, 0.5 * step);
    sign * (centre * off.cos() - sign * (tool * tool - (centre * off.sin()).powi(2)).sqrt() - part)
}

fn plane() -> [Row; 2] {
    let top = [sample(Point3::new(0.3, 0.0, 0.0), Vec3::z())];
    let (r, step) = (3.0f64, 0.5);
    let at = |x: f64, y: f64| pose(Point3::new(x, y, 0.0), Vec3::z());
    let mut motions = through(&[at(-9.0, -0.5 * step), at(9.0, -0.5 * step)]);
    motions.extend(through(&[at(-9.0, 0.5 * step), at(9.0, 0.5 * step)]));
    let measured = run(&ball(2.0 * r), &motions, &top)[0].standoff_mm;
    let truth = r - (r * r - 0.25 * step * step).sqrt();
    let how = "closed form";
    let first = Row { part: "plane", tool: "ball", step_mm: step, measured, truth, how };
    let (cutter, lead) = (toroidal(16.0, 3.0), 0.3f64);
    let (half, truth) = outline(&cutter, lead, 0.2);
    let low = cutter.corner_mm() * (1.0 - lead.cos()) + cutter.core_mm() * lead.sin();
    let at = |x: f64, y: f64| pose(Point3::new(x, y, low), Vec3::new(lead.sin(), 0.0, lead.cos()));
    let mut motions = through(&[at(-40.0, -half), at(40.0, -half)]);
    motions.extend(through(&[at(-40.0, half), at(40.0, half)]));
    let measured = run(&cutter, &motions, &top)[0].standoff_mm;
    [first, Row { part: "plane", tool: "toroidal", step_mm: 2.0 * half, measured, truth, how }]
}

fn cylinder(hollow: bool) -> Vec<Row> {
    let (radius, tool, step) = (25.0, 4.0, 0.03);
    let sign = if hollow { -1.0 } else { 1.0 };
    let part = if hollow { "hollow cylinder" } else { "cylinder" };
    let how = "closed form";
    let out = |a: f64| Vec3::new(a.sin(), 0.0, a.cos());
    let top = [sample(Point3::new(0.0, 0.3, radius), Vec3::z() * sign)];
    let at = |a: f64, y: f64| pose(Point3::from(out(a) * radius + Vec3::y() * y), out(a) * sign);
    let mut motions = through(&[at(-0.5 * step, -9.0), at(-0.5 * step, 9.0)]);
    motions.extend(through(&[at(0.5 * step, -9.0), at(0.5 * step, 9.0)]));
    let measured = run(&ball(2.0 * tool), &motions, &top)[0].standoff_mm;
    let truth = ball_cusp(radius, tool, hollow, step);
    let mut rows = vec![Row { part, tool: "ball", step_mm: radius * step, measured, truth, how }];
    // A toroidal end leaned by 0.35 is at most as flat as 2 / sin(0.35) + 2 mm, which fits a hollow of 25 mm.
    let (cutter, lead) = (toroidal(8.0, 2.0), 0.35f64);
    let (across, above) = outline(&cutter, lead, 0.25);
    let up = radius + sign * above;
    let (half, truth) = ((across / up).atan(), sign * (across.hypot(up) - radius));
    let low = cutter.corner_mm() * (1.0 - lead.cos()) + cutter.core_mm() * lead.sin();
    let at = |a: f64, y: f64| {
        let n = out(a) * sign;
        pose(Point3::from(out(a) * radius + n * low + Vec3::y() * y), n * lead.cos() + Vec3::y() * lead.sin())
    };
    let mut motions = through(&[at(-half, -40.0), at(-half, 40.0)]);
    motions.extend(through(&[at(half, -40.0), at(half, 40.0)]));
    let measured = run(&cutter, &motions, &top)[0].standoff_mm;
    rows.push(Row { part, tool: "toroidal", step_mm: 2.0 * radius * half, measured, truth, how });
    rows
}

/// Parallels of a surface of revolution about z, at v - step/2 and v + step/2, and the sample between.
fn parallels(
    part: &'static str,
    surface: &dyn Surface,
    at_v: f64,
    (cutter, lead): (&Cutter, f64),
    step: f64,
    radius: f64,
) -> Row {
    let lean = Lean { lead_rad: lead, tilt_rad: 0.0 };
    let pose_at = |u: f64, v: f64| -> Pose {
        let contact = Contact::new(surface, uv(u, v), cutter, FeedLine::Iso(Axis::U), lean).expect("fits");
        lean.pose(cutter, &contact.frame, 0.0)
    };
    let jet = surface.jet2(uv(0.0, at_v));
    let normal = jet.normal().expect("regular");
    let mut motions: Vec<Swept> = Vec::new();
    let (reach, chord) = (0.15, 1e-4);
    for v in [at_v - 0.5 * step, at_v + 0.5 * step] {
        let count = (2.0 * reach / chord) as u32;
        let poses: Vec<Pose> = (0..=count).map(|k| pose_at(chord * f64::from(k) - reach, v)).collect();
        motions.extend(through(&poses));
    }
    let measured = run(cutter, &motions, &[sample(jet.point, normal.into_inner())])[0].standoff_mm;
    let least = |v: f64| {
        let entry = |u: f64| entry(cutter, &pose_at(u, v), &jet.point, &normal);
        golden(entry, -reach, reach)
    };
    let truth = least(at_v - 0.5 * step).min(least(at_v + 0.5 * step));
    let tool = if cutter.is_ball() { "ball" } else { "toroidal" };
    Row { part, tool, step_mm: radius * step, measured, truth, how: "frozen poses" }
}

/// The least value of a function with one minimum.
fn golden(f: impl Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    const RATIO: f64 = 0.618_033_988_749_894_9;
    // 60 sections leave 3e-13 of the range, and the minimum is level.
    for _ in 0..60 {
        let (x, y) = (b - RATIO * (b - a), a + RATIO * (b - a));
        if f(x) < f(y) { b = y } else { a = x }
    }
    f(0.5 * (a + b))
}

/// How far along the normal from a point the tool's lower side begins; 1e3 and its distance where the ray misses.
fn entry(cutter: &Cutter, pose: &Pose, p: &Point3, n: &Vec3) -> f64 {
    let (core, r) = (cutter.core_mm(), cutter.corner_mm());
    let distance = |s: f64| {
        let w = p + n * s - pose.tip;
        let z = w.dot(&pose.axis);
        let rho = (w - pose.axis.into_inner() * z).norm();
        let (x, y) = (rho - core, r - z);
        if x > 0.0 && y > 0.0 { x.hypot(y) - r } else { x.max(y) - r }
    };
    let (mut a, mut b) = (-1.0, 2.0 * r);
    for _ in 0..200 {
        let (x, y) = (a + (b - a) / 3.0, b - (b - a) / 3.0);
        if distance(x) < distance(y) { b = y } else { a = x }
    }
    let mut inside = 0.5 * (a + b);
    if distance(inside) > 0.0 {
        return 1e3 + distance(inside);
    }
    let mut outside = -1.0;
    for _ in 0..60 {
        let middle = 0.5 * (outside + inside);
        if distance(middle) > 0.0 { outside = middle } else { inside = middle }
    }
    inside
}

/// Rasters; whether all are as they should be.
pub fn scallops() -> bool {
    let sphere = Sphere::new(30.0).expect("a ball");
    let torus = Torus::new(60.0, 20.0).expect("a torus");
    let (balls, bull) = (ball(8.0), toroidal(10.0, 2.0));
    let inner = std::f64::consts::PI;
    let mut rows: Vec<Row> = plane().into_iter().chain(cylinder(false)).chain(cylinder(true)).collect();
    let known = |row: Row, truth: f64| Row { truth, how: "closed form", ..row };
    rows.push(known(
        parallels("sphere", &sphere, 0.3, (&balls, 0.1), 0.03, 30.0),
        ball_cusp(30.0, 4.0, false, 0.03),
    ));
    rows.push(parallels("sphere", &sphere, 0.3, (&bull, 0.2), 0.05, 30.0));
    rows.push(known(
        parallels("hollow sphere", &Flipped(sphere), 0.3, (&balls, 0.1), 0.03, 30.0),
        ball_cusp(30.0, 4.0, true, 0.03),
    ));
    rows.push(parallels("hollow sphere", &Flipped(sphere), 0.3, (&bull, 0.4), 0.05, 30.0));
    rows.push(known(
        parallels("torus", &torus, 0.8, (&balls, 0.1), 0.04, 20.0),
        ball_cusp(20.0, 4.0, false, 0.04),
    ));
    rows.push(parallels("torus", &torus, 0.8, (&bull, 0.2), 0.06, 20.0));
    rows.push(known(
        parallels("groove", &Flipped(torus), inner, (&balls, 0.1), 0.04, 20.0),
        ball_cusp(20.0, 4.0, true, 0.04),
    ));
    rows.push(parallels("groove", &Flipped(torus), inner + 0.4, (&bull, 0.5), 0.1, 20.0));
    println!("scallops on cusps; tolerance {TOLERANCE} mm, allowed {ALLOWED:e} of it");
    println!(
        "{:<16} {:<9} {:>8} {:>15} {:>15} {:>12}  against",
        "part", "tool", "step mm", "measured mm", "truth mm", "off / tol"
    );
    let mut good = true;
    for r in &rows {
        let off = (r.measured - r.truth) / TOLERANCE;
        good &= off.abs() <= ALLOWED;
        println!(
            "{:<16} {:<9} {:>8.4} {:>15.12} {:>15.12} {:>12.1e}  {}",
            r.part, r.tool, r.step_mm, r.measured, r.truth, off, r.how
        );
    }
    println!("{}\n", if good { "all within" } else { "NOT all within" });
    good
}

/// Halving the spacing of samples: what is seen, and the bound on what there is.
pub fn spacing() -> bool {
    let (radius, tool, passes) = (25.0, 4.0, 157u32);
    let step = std::f64::consts::TAU / f64::from(passes);
    let truth = ball_cusp(radius, tool, false, step);
    let surface = Cylinder::new(radius, Interval::new(0.0, 5.0)).expect("a cylinder");
    let at = |k: u32, z: f64| {
        let a = step * f64::from(k) + 0.0137;
        pose(Point3::new(radius * a.cos(), radius * a.sin(), z), Vec3::new(a.cos(), a.sin(), 0.0))
    };
    let motions: Vec<Swept> = (0..passes)
        .map(|k| Swept { from: at(k, -9.0), to: at(k, 14.0), rapid: false, block: k + 1 })
        .collect();
    println!("a ball's raster on a cylinder, highest there is {truth:.9} mm");
    println!(
        "{:>10} {:>9} {:>13} {:>13} {:>13} {:>7}",
        "spacing", "samples", "seen", "bound", "bound - truth", "ratio"
    );
    let (mut good, mut before) = (true, None::<f64>);
    for spacing_mm in [0.4, 0.2, 0.1, 0.05] {
        let sampling = sample_surface(&surface, 0, spacing_mm, 1_000_000).expect("a good face");
        let samples = &sampling.samples;
        let cutter = ball(2.0 * tool);
        let job = Job {
            cutter: &cutter,
            holder: None,
            changes: &[],
            motions: &motions,
            samples,
            stock_mm: 0.5,
            depth_mm: 1.0,
        };
        let cuts = cut(&job, &|_| ()).expect("a good job");
        let seen = cuts.iter().map(|c| c.standoff_mm).fold(0.0, f64::max);
        let patches: Vec<Option<osculate_tools::removal::Patch>> =
            sampling.patches.iter().copied().map(Some).collect();
        let wanted = Wanted { uncut_mm: 0.4, enough_mm: 0.0, gouge_mm: 0.01 };
        let more = hidden(&[&surface], &job, (&patches, &cuts), wanted).expect("a good job").scallop_mm;
        let bound = seen + more;
        let over = bound - truth;
        let ratio = before.map_or(String::new(), |b| format!("{:.2}", b / over));
        println!("{spacing_mm:>10} {:>9} {seen:>13.9} {bound:>13.9} {over:>13.9} {ratio:>7}", samples.len());
        good &= seen <= truth + 1e-12 && bound >= truth - 1e-12;
        before = Some(over);
    }
    println!("{}\n", if good { "seen <= truth <= bound throughout" } else { "the bound does NOT hold" });
    good
}

/// Halving the chords of a circular pass: order two.
pub fn steps() -> bool {
    let (radius, tool, up) = (30.0, 4.0, 0.01f64);
    let truth =
        (radius + tool) * up.cos() - (tool * tool - ((radius + tool) * up.sin()).powi(2)).sqrt() - radius;
    println!("a ball once around a sphere in chords");
    println!("{:>10} {:>15} {:>7}", "chord rad", "off mm", "ratio");
    let (mut good, mut before) = (true, None::<f64>);
    for step in [0.08, 0.04, 0.02, 0.01, 0.005] {
        let at = |k: i32| {
            let a = step * (f64::from(k) + 0.5);
            let n = Vec3::new(a.cos(), a.sin(), 0.0);
            pose(Point3::from(n * radius), n)
        };
        let poses: Vec<Pose> = (-20..20).map(at).collect();
        let n = Vec3::new(up.cos(), 0.0, up.sin());
        let s = [sample(Point3::from(n * radius), n)];
        let off = run(&ball(2.0 * tool), &through(&poses), &s)[0].standoff_mm - truth;
        let ratio = before.map(|b| b / off);
        println!("{step:>10} {off:>15.3e} {:>7}", ratio.map_or(String::new(), |r| format!("{r:.3}")));
        good &= ratio.is_none_or(|r| (r - 4.0).abs() < 0.1);
        before = Some(off);
    }
    println!("{}\n", if good { "order two" } else { "NOT of order two" });
    good
}
