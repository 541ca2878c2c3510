//! Scallops of passes on torus, sphere and cylinder against closed forms and independently computed widths.
//!
//! Passes along circles are given as chords; their number is chosen so that the chords stray by at most a tenth of what is
//! allowed, a ten-thousandth of the tolerance.

use crate::removal::common::{ball, run, sample, through, toroidal};
use osculate_geom::analytic::{Sphere, Torus};
use osculate_geom::{Axis, Flipped, Surface, Uv, Vec3, uv};
use osculate_geom::{Point3, Unit3};
use osculate_tools::removal::{Sample, Swept};
use osculate_tools::sweep::SweptMotion;
use osculate_tools::{Contact, ContactMotion, Cutter, CutterSpec, FeedLine, Lean, Pose, strip};
use serde_json::Value;

/// Of the tolerance: what a measured scallop may be off.
const ALLOWED: f64 = 1e-4;

fn number(v: &Value, key: &str) -> f64 {
    v[key].as_f64().unwrap_or_else(|| panic!("{key} in {v}"))
}

/// Poses along an isoparametric u-line, `half` to both sides of the contact.
fn along(contact: &Contact<'_>, half: f64, step: f64) -> Vec<Pose> {
    let (line, at) = contact.line().expect("a line");
    let motion =
        ContactMotion { line: &line, cutter: contact.cutter, lean: contact.lean, lift_mm: contact.lift_mm };
    let count = (half / step).ceil() as i32;
    (-count..=count).map(|k| motion.at(at + step * f64::from(k)).expect("defined").pose).collect()
}

fn on(surface: &dyn Surface, at: Uv) -> Sample {
    let jet = surface.jet2(at);
    Sample { normal: jet.normal().expect("regular"), uv: at, ..sample(jet.point.into(), [0.0, 0.0, 1.0]) }
}

/// Twenty-two passes of ball, flat and toroidal ends along parallels of tori, convex and hollow: at the widths of
/// `torus_exact.json` exactly the tolerance is left.
#[test]
fn tori_with_independent_widths() {
    let file: Value = serde_json::from_str(include_str!("../data/torus_exact.json")).unwrap();
    let cases = file["cases"].as_array().unwrap();
    let mut worst = 0.0f64;
    for case in cases {
        let (p, t, c) = (&case["part"], &case["tool"], &case["contact"]);
        let (major, minor) = (number(p, "major_radius_mm"), number(p, "minor_radius_mm"));
        let torus = Torus::new(major, minor).unwrap();
        let surface: Box<dyn Surface> =
            if p["material"] == "outside" { Box::new(Flipped(torus)) } else { Box::new(torus) };
        let diameter_mm = number(t, "diameter_mm");
        let spec = match t["kind"].as_str().unwrap() {
            "ball" => CutterSpec::Ball { diameter_mm, length_mm: 100.0 },
            "flat" => CutterSpec::Flat { diameter_mm, length_mm: 100.0 },
            _ => CutterSpec::Toroidal {
                diameter_mm,
                corner_radius_mm: number(t, "corner_radius_mm"),
                length_mm: 100.0,
            },
        };
        let cutter = Cutter::try_from(spec).unwrap();
        let at = uv(c["at"][0].as_f64().unwrap(), c["at"][1].as_f64().unwrap());
        let lean = Lean {
            lead_rad: number(c, "lead_deg").to_radians(),
            tilt_rad: number(c, "tilt_deg").to_radians(),
        };
        let contact = Contact::new(&*surface, at, &cutter, FeedLine::Iso(Axis::U), lean)
            .unwrap()
            .lifted(number(c, "lift_mm"));
        let h = number(case, "scallop_mm");
        // Every point of the tool runs on a circle about the torus' axis, within a tool of the parallel's.
        let circle = major + minor + diameter_mm;
        let step = (8.0 * 0.1 * ALLOWED * h / circle).sqrt();
        let reach = 1.5 * diameter_mm / (major + minor * at.v.cos());
        let motions = through(&along(&contact, reach, step));
        let edges = [("toward_plus_v_mm", 1.0), ("toward_minus_v_mm", -1.0)]
            .map(|(key, side)| on(&*surface, uv(at.u, at.v + side * number(&case["expect"], key) / minor)));
        for cut in run(&cutter, &motions, &edges, 1.0) {
            let off = (cut.standoff_mm - h).abs() / h;
            worst = worst.max(off);
            assert!(off < ALLOWED, "{cut:?} want {h}, off by {off:.1e} of it: {case}");
        }
    }
    assert!(cases.len() >= 20 && worst > 0.0);
}

/// Passes of a ball along parallels of a sphere, on its outside and inside: between two passes the ball's circle in the
/// meridian's plane, centre P + R (or P - R) from the middle.
#[test]
fn balls_on_spheres() {
    for (part, tool, hollow) in [(30.0, 4.0, false), (18.0, 6.0, true)] {
        let cutter = ball(2.0 * tool);
        let sign = if hollow { -1.0 } else { 1.0 };
        let at = |latitude: f64, u: f64| {
            let (s, c) = latitude.sin_cos();
            Vec3::new(c * u.cos(), c * u.sin(), s)
        };
        let step = 0.05;
        let mut motions = Vec::new();
        for k in 0..7u32 {
            let latitude = 0.3 + step * f64::from(k);
            let poses: Vec<Pose> = (-300..=300)
                .map(|i| {
                    let n = at(latitude, 1e-4 * f64::from(i));
                    Pose { tip: Point3::from(n * part), axis: Unit3::new_normalize(n * sign) }
                })
                .collect();
            motions.extend(through(&poses).into_iter().map(|m| Swept { block: k, ..m }));
        }
        let centre = part + sign * tool;
        for k in 0..61 {
            let latitude = 0.3 + 0.1 * step * f64::from(k);
            let n = at(latitude, 0.0);
            let s = [sample((n * part).into(), (n * sign).into())];
            let off = latitude - 0.3 - step * (0.1 * f64::from(k)).round();
            // Along the normal from the middle, to where the circle is met first on the part's side.
            let want =
                (centre * off.cos() - sign * (tool * tool - (centre * off.sin()).powi(2)).sqrt() - part)
                    * sign;
            let got = run(&cutter, &motions, &s, 1.0)[0].standoff_mm;
            // Chords of 1e-4 rad at a radius of 34 mm: 5e-8 mm.
            assert!((got - want).abs() < 1e-7, "{latitude}: {got} want {want}");
        }
    }
}

/// A leaned toroidal end along the generators of a cylinder: seen along the feed it is the corner's offset of an ellipse.
#[test]
fn leaned_toroidal_ends_on_cylinders() {
    let (part, lead) = (40.0, 0.2f64);
    let cutter = toroidal(16.0, 3.0);
    let (core, r) = (cutter.core_mm(), cutter.corner_mm());
    let low = core * lead.sin();
    // The contact on top of the cylinder at x = 0, the feed along y.
    let tip = |y: f64| Point3::new(0.0, y, part + r + low - r * lead.cos());
    let pose =
        |y: f64| Pose { tip: tip(y), axis: Unit3::new_normalize(Vec3::new(0.0, lead.sin(), lead.cos())) };
    let motions = through(&[pose(-60.0), pose(60.0)]);
    for k in 0..20 {
        let (sin, cos) = (0.07 * f64::from(k)).sin_cos();
        let normal = (sin / core).hypot(cos / low);
        let across = core * sin + r * (sin / core) / normal;
        let height = r + low - low * cos - r * (cos / low) / normal;
        // The sample on the cylinder below that point of the envelope, seen from its axis.
        let (out, up) = (across, part + height);
        let want = out.hypot(up) - part;
        let n = [out / out.hypot(up), 0.0, up / out.hypot(up)];
        let s = [sample([part * n[0], 0.4, part * n[2]], n)];
        let got = run(&cutter, &motions, &s, 20.0)[0].standoff_mm;
        assert!((got - want).abs() < 1e-10, "{k}: {got} want {want}");
    }
}

/// A toroidal end along a great circle: the edges of the exact strip stand at the tolerance.
#[test]
fn toroidal_ends_on_spheres() {
    let h = 0.01;
    for (hollow, lead) in [(false, 0.1), (true, 0.5)] {
        let sphere = Sphere::new(45.0).unwrap();
        let surface: Box<dyn Surface> = if hollow { Box::new(Flipped(sphere)) } else { Box::new(sphere) };
        let cutter = toroidal(14.0, 2.5);
        let lean = Lean { lead_rad: lead, tilt_rad: 0.0 };
        let contact = Contact::new(&*surface, uv(0.4, 0.0), &cutter, FeedLine::Iso(Axis::U), lean).unwrap();
        let strip = strip::exact(&contact, h).unwrap();
        let motions = through(&along(&contact, 0.5, (8.0 * 0.1 * ALLOWED * h / 60.0f64).sqrt()));
        // By symmetry both sides are alike.
        for side in [-1.0, 1.0] {
            let s = [on(&*surface, uv(0.4, side * strip.left_mm / 45.0))];
            let cut = run(&cutter, &motions, &s, 1.0)[0];
            assert!((cut.standoff_mm - h).abs() < ALLOWED * h, "{cut:?}");
        }
    }
}

/// Halving the steps of a chorded pass quarters what it is off.
#[test]
fn chords_converge_with_the_square_of_the_step() {
    let (part, tool) = (30.0, 4.0);
    let error = |step: f64| {
        let pose = |k: i32| {
            let (s, c) = (step * (f64::from(k) + 0.5)).sin_cos();
            let n = Vec3::new(c, s, 0.0);
            Pose { tip: Point3::from(n * part), axis: Unit3::new_normalize(n) }
        };
        let poses: Vec<Pose> = (-20..20).map(pose).collect();
        // Half way between two poses, and off the plane of the circle.
        let up = 0.01f64;
        let s = [sample([part * up.cos(), 0.0, part * up.sin()], [up.cos(), 0.0, up.sin()])];
        let want =
            (part + tool) * up.cos() - (tool * tool - ((part + tool) * up.sin()).powi(2)).sqrt() - part;
        run(&ball(2.0 * tool), &through(&poses), &s, 1.0)[0].standoff_mm - want
    };
    let errors = [0.04, 0.02, 0.01, 0.005].map(error);
    for pair in errors.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((ratio - 4.0).abs() < 0.1, "{errors:?}");
    }
}
