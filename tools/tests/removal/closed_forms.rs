//! Scallops with closed forms. Tools and motions are exact, so that only rounding is allowed: coordinates of
//! some ten millimetres have an ulp of 2e-15, a standoff is a few dozen operations away, `cut` stops at
//! distances of 1e-13.

use crate::removal::common::{ball, flat, pose, run, sample, through, toroidal, upright};
use osculate_geom::analytic::Torus;
use osculate_geom::{Axis, Flipped, Point3, Surface, Unit3, Vec3, uv};
use osculate_tools::removal::{Sample, Swept};
use osculate_tools::sweep::SweptMotion;
use osculate_tools::{Contact, ContactMotion, Cutter, FeedLine, Lean, Pose, strip};

const ROUNDING: f64 = 1e-11;

#[test]
fn ball_raster_on_a_plane() {
    let (r, step) = (3.0f64, 0.5);
    let cutter = ball(2.0 * r);
    let lines: Vec<Swept> = (0..12)
        .map(|k| Swept {
            from: upright(0.0, step * f64::from(k), 0.0),
            to: upright(10.0, step * f64::from(k), 0.0),
            rapid: false,
            block: k,
        })
        .collect();
    let samples: Vec<Sample> = (0..400)
        .map(|k| {
            // Every second sample on a cusp line.
            let y = if k % 2 == 0 { 0.25 + step * f64::from(k % 11) } else { 0.0137 * f64::from(k) };
            sample([1.0 + 0.02 * f64::from(k), y, 0.0], [0.0, 0.0, 1.0])
        })
        .collect();
    for (s, c) in samples.iter().zip(run(&cutter, &lines, &samples, 0.5)) {
        let nearest = (s.point.y / step).round().min(11.0);
        let off = s.point.y - step * nearest;
        let want = r - (r * r - off * off).sqrt();
        assert!((c.standoff_mm - want).abs() < ROUNDING, "{c:?} want {want}");
        // On a cusp either neighbour may have cut.
        assert!((f64::from(c.by.unwrap().block) - s.point.y / step).abs() < 0.5 + 1e-9);
    }
}

/// Seen along the feed a leaned toroidal cutter is the r-offset of an ellipse with half axes core and core
/// sin(lead).
#[test]
fn leaned_toroidal_and_flat_passes_on_a_plane() {
    for (cutter, lead) in [(toroidal(16.0, 3.0), 0.3f64), (flat(12.0), 0.2), (toroidal(10.0, 1.0), 0.05)] {
        let (core, r) = (cutter.core_mm(), cutter.corner_mm());
        let axis = [lead.sin(), 0.0, lead.cos()];
        let height = core * lead.sin();
        // The contact's height is r + core sin(lead) below the core circle's centre, the tip r along the axis
        // below it.
        let tip = |x: f64| [x, 0.0, r + height - r * lead.cos()];
        let motions = through(&[pose(tip(-40.0), axis), pose(tip(40.0), axis)]);
        for k in 0..20 {
            let phi = 0.075 * f64::from(k);
            let (sin, cos) = phi.sin_cos();
            let normal = (sin / core).hypot(cos / height);
            let across = core * sin + r * (sin / core) / normal;
            let want = r + height - height * cos - r * (cos / height) / normal;
            let samples =
                [sample([0.3, across, 0.0], [0.0, 0.0, 1.0]), sample([0.3, -across, 0.0], [0.0, 0.0, 1.0])];
            for c in run(&cutter, &motions, &samples, 20.0) {
                // The instant is found to 1e-12 of 80 mm, which counts at the sharp rim of a flat end.
                assert!((c.standoff_mm - want).abs() < 1e-10, "phi {phi}: {c:?} want {want}");
            }
        }
    }
}

#[test]
fn ball_along_the_generators_of_a_cylinder() {
    let (part, r) = (25.0f64, 4.0f64);
    let cutter = ball(2.0 * r);
    let step = 0.06f64;
    let at = |angle: f64, y: f64| {
        let n = Vec3::new(angle.sin(), 0.0, angle.cos());
        // A ball may lean as it likes: along the normal.
        Pose { tip: Point3::from(n * part) + Vec3::y() * y, axis: Unit3::new_normalize(n) }
    };
    let motions: Vec<Swept> = (0..9u32)
        .map(|k| {
            let angle = step * (f64::from(k) - 4.0);
            Swept { from: at(angle, -5.0), to: at(angle, 5.0), rapid: false, block: k }
        })
        .collect();
    let angles: Vec<f64> = (0..81).map(|k| 0.006 * (f64::from(k) - 40.0)).collect();
    let samples: Vec<Sample> = angles
        .iter()
        .map(|a| sample([part * a.sin(), 0.7, part * a.cos()], [a.sin(), 0.0, a.cos()]))
        .collect();
    for (a, c) in angles.iter().zip(run(&cutter, &motions, &samples, 1.0)) {
        let off = a - step * (a / step).round().clamp(-4.0, 4.0);
        let want = (part + r) * off.cos() - (r * r - ((part + r) * off.sin()).powi(2)).sqrt() - part;
        assert!((c.standoff_mm - want).abs() < ROUNDING, "{a}: {c:?} want {want}");
    }
}

/// One pass along a parallel of a groove leaves exactly the tolerance at the edges of the exact strip.
#[test]
fn the_edges_of_a_strip_stand_at_the_tolerance() {
    let (minor, h) = (20.0, 0.01);
    let groove = Flipped(Torus::new(60.0, minor).unwrap());
    let cutter = toroidal(16.0, 3.0);
    let at = uv(0.7, -std::f64::consts::FRAC_PI_2);
    let lean = Lean { lead_rad: 0.45, tilt_rad: 0.0 };
    let contact = Contact::new(&groove, at, &cutter, FeedLine::Iso(Axis::U), lean).unwrap();
    let strip = strip::exact(&contact, h).unwrap();
    let (line, _) = contact.line().unwrap();
    let motion = ContactMotion { line: &line, cutter: &cutter, lean, lift_mm: 0.0 };
    // 0.2 rad either way are 12 mm of parallel; steps of 1e-4 rad leave the tool's path by 60 * 1e-8 / 8 =
    // 8e-8 mm.
    let poses: Vec<Pose> =
        (0..=4000).map(|k| motion.at(at.u - 0.2 + 1e-4 * f64::from(k)).unwrap().pose).collect();
    let up = groove.jet2(at).dv.dot(&contact.frame.left) > 0.0;
    let edges = if up { [strip.left_mm, -strip.right_mm] } else { [-strip.left_mm, strip.right_mm] };
    let samples: Vec<Sample> = edges
        .iter()
        .map(|q| {
            // The cross line is a meridian: arc length is the minor radius times v.
            let jet = groove.jet2(uv(at.u, at.v + q / minor));
            let normal = jet.normal().unwrap();
            Sample { normal, ..sample(jet.point.into(), [0.0, 0.0, 1.0]) }
        })
        .collect();
    assert!(strip.width_mm > 1.0);
    for c in run(&cutter, &through(&poses), &samples, 1.0) {
        assert!((c.standoff_mm - h).abs() < 4e-7, "{c:?} want {h} +- four times the chord error");
    }
}

/// Swinging about its tip, the side of a cylinder that leans by a stands `(R + Z sin a) / cos a` from the tip
/// at height Z.
#[test]
fn a_swing_about_the_tip() {
    let radius = 5.0;
    let cutter = flat(2.0 * radius);
    let leaning = |a: f64| pose([0.0; 3], [a.sin(), 0.0, a.cos()]);
    let (from, to) = (0.1f64, 0.7f64);
    let motions = through(&[leaning(from), leaning(to)]);
    let wall = 40.0;
    let samples: Vec<Sample> =
        (0..30).map(|k| sample([wall, 0.0, 1.0 + f64::from(k)], [-1.0, 0.0, 0.0])).collect();
    for (s, c) in samples.iter().zip(run(&cutter, &motions, &samples, 60.0)) {
        let want = wall - (radius + s.point.z * to.sin()) / to.cos();
        // As long as that point of the side is above the bottom: on the axis of the leaning tool.
        let along = s.point.z * to.cos() + (wall - want) * to.sin();
        assert!(along > 0.0 && (c.standoff_mm - want.max(-2.0)).abs() < 1e-10, "{s:?} {c:?} want {want}");
    }
}

#[test]
fn every_motion_counts_whatever_its_direction() {
    // Only the middle of one long oblique motion comes near the sample: both its ends are far off.
    let cutter: Cutter = ball(6.0);
    let motions =
        through(&[pose([-80.0, -60.0, 20.0], [0.0, 0.6, 0.8]), pose([80.0, 60.0, -20.0], [0.0, 0.6, 0.8])]);
    let s = [sample([0.0; 3], [0.0, 0.0, 1.0])];
    let c = run(&cutter, &motions, &s, 1.0)[0];
    // The ball's centre passes (0, 1.8, 2.4) along (4, 3, -1)/5.099: the sample is inside the swept cylinder.
    let d = Vec3::new(4.0, 3.0, -1.0).normalize();
    let w = Vec3::new(0.0, 1.8, 2.4);
    // |(w - h z) x d| = 3 for the lower crossing, h negative.
    let (wd, zd) = (w.cross(&d), Vec3::z().cross(&d));
    let (a, b, k) = (zd.norm_squared(), wd.dot(&zd), wd.norm_squared() - 9.0);
    let want = (b - (b * b - a * k).sqrt()) / a;
    assert!(want < 0.0 && (c.standoff_mm - want).abs() < ROUNDING, "{c:?} want {want}");
}

/// Nothing depends on where the part stands, nor on how a straight motion is cut in two.
#[test]
fn moved_parts_and_split_motions() {
    let turn = |v: Vec3| {
        let (s, c) = 1.1f64.sin_cos();
        let a = Vec3::new(c * v.x - s * v.y, s * v.x + c * v.y, v.z);
        Vec3::new(a.x, 0.6 * a.y - 0.8 * a.z, 0.8 * a.y + 0.6 * a.z)
    };
    let shift = Vec3::new(120.0, -45.0, 300.0);
    let moved = |p: &Pose| Pose {
        tip: Point3::from(turn(p.tip.coords) + shift),
        axis: Unit3::new_normalize(turn(p.axis.into_inner())),
    };
    for cutter in [ball(6.0), toroidal(8.0, 1.5), flat(5.0)] {
        let poses: Vec<Pose> = (0..12)
            .map(|k| {
                let t = f64::from(k);
                pose([0.4 * t - 2.0, t.sin(), 0.05 * (2.0 * t).cos()], [0.2 * t.sin(), 0.1, 1.0])
            })
            .collect();
        let motions = through(&poses);
        let samples: Vec<Sample> = (0..60)
            .map(|k| sample([0.06 * f64::from(k) - 2.0, (0.3 * f64::from(k)).sin(), 0.0], [0.1, 0.0, 1.0]))
            .collect();
        let there: Vec<Swept> =
            motions.iter().map(|m| Swept { from: moved(&m.from), to: moved(&m.to), ..*m }).collect();
        let samples_there: Vec<Sample> = samples
            .iter()
            .map(|s| Sample {
                point: Point3::from(turn(s.point.coords) + shift),
                normal: Unit3::new_normalize(turn(s.normal.into_inner())),
                ..*s
            })
            .collect();
        let here = run(&cutter, &motions, &samples, 0.5);
        assert!(here.iter().filter(|c| c.by.is_some()).count() > 30);
        for (a, b) in here.iter().zip(run(&cutter, &there, &samples_there, 0.5)) {
            // Coordinates of 300 mm and the root finder's own rounding.
            assert!((a.standoff_mm - b.standoff_mm).abs() < 1e-8, "{a:?} {b:?}");
        }
        // Split where tip and axis are both half way only if the axis keeps its direction.
        let straight = Swept { to: Pose { axis: poses[0].axis, ..poses[5] }, ..motions[0] };
        let middle =
            Pose { tip: straight.from.tip + (straight.to.tip - straight.from.tip) * 0.3, ..straight.from };
        let halves = [Swept { to: middle, ..straight }, Swept { from: middle, ..straight }];
        for (a, b) in
            run(&cutter, &[straight], &samples, 0.5).iter().zip(run(&cutter, &halves, &samples, 0.5))
        {
            assert!((a.standoff_mm - b.standoff_mm).abs() < 1e-10, "{a:?} {b:?}");
        }
    }
}
