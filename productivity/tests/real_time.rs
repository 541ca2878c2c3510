//! Productivity in real time against areas that are known otherwise: by quadrature of the face, and by what each pass cuts alone.

use crate::cutting::motions;

use osculate_geom::analytic::{Cylinder, Ellipsoid, Paraboloid, Plane, Torus};
use osculate_geom::quadrature::area;
use osculate_geom::{Axis, Domain, Flipped, Interval, Patch, Point3, Side, Surface, Unit3, Vec3};
use osculate_productivity::plan::{Along, Pass, Strategy, Task, Tolerance, run};
use osculate_productivity::real_time::{
    Cells, Fineness, FinishedPlace, Finishing, Region, Spread, TimedMotion,
};
use osculate_surfaces::{Net, NurbsSurface};
use osculate_tools::removal::{Cut, Job, Sample, Swept, cut, sample_surface};
use osculate_tools::{Cutter, CutterSpec, Lean};
use proptest::prelude::*;

/// Distance of the places, mm: a fifth of the narrowest strip below.
const SPACING_MM: f64 = 0.2;

fn patch(surface: impl Surface + 'static, u: [f64; 2], v: [f64; 2]) -> Box<dyn Surface> {
    let domain = Domain { u: Interval::new(u[0], u[1]), v: Interval::new(v[0], v[1]) };
    Box::new(Patch { surface, domain, side: Side::Along })
}

/// A bicubic face of 14 x 11 mm with a wave of this height, mm.
fn nurbs(wave_mm: f64) -> Box<dyn Surface> {
    let knots = vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
    let pole = |k: usize| {
        let (i, j) = ((k / 4) as f64, (k % 4) as f64);
        let z = if (k / 4 + k % 4).is_multiple_of(2) { wave_mm } else { -0.5 * wave_mm };
        Point3::new(14.0 * i / 3.0, 11.0 * j / 3.0 + 0.6 * i, z)
    };
    let net = Net { count: [4, 4], points: (0..16).map(pole).collect(), weights: None };
    Box::new(NurbsSurface::new([3, 3], [knots.clone(), knots], net).unwrap())
}

/// One of six faces; `x` from 0 to 1 bends it.
fn face(kind: u8, x: f64) -> Box<dyn Surface> {
    match kind {
        0 => {
            let domain = Domain { u: Interval::new(0.0, 15.0), v: Interval::new(0.0, 7.0 + 6.0 * x) };
            Box::new(Plane::new(domain))
        }
        1 => patch(Torus::new(25.0, 7.0 + 4.0 * x).unwrap(), [0.3, 0.8], [-0.6, 0.9]),
        // Inside the tube the ball must be the smaller one.
        2 => patch(Flipped(Torus::new(40.0, 14.0 + 6.0 * x).unwrap()), [0.0, 0.4], [2.6, 3.5]),
        3 => Box::new(Paraboloid::new([0.008 * x, -0.006], 6.0).unwrap()),
        4 => patch(Ellipsoid::new([18.0, 14.0, 10.0 + 5.0 * x]).unwrap(), [0.2, 1.0], [-0.4, 0.6]),
        _ => nurbs(1.5 * x),
    }
}

fn strategy(kind: u8) -> Strategy {
    match kind {
        0 => Strategy::Isoparametric { along: Along::Fixed(Axis::U) },
        1 => Strategy::Isoparametric { along: Along::Fixed(Axis::V) },
        2 => Strategy::Isoplanar { normal: Unit3::new_normalize(Vec3::new(1.0, 0.4, 0.2)) },
        _ => Strategy::Isoscallop,
    }
}

fn cutter(kind: u8) -> Cutter {
    let spec = match kind {
        0 => CutterSpec::Ball { diameter_mm: 6.0, length_mm: 50.0 },
        1 => CutterSpec::Ball { diameter_mm: 10.0, length_mm: 50.0 },
        _ => CutterSpec::Toroidal { diameter_mm: 8.0, corner_radius_mm: 2.0, length_mm: 50.0 },
    };
    Cutter::try_from(spec).unwrap()
}

const TOLERANCE: Tolerance = Tolerance { scallop_mm: 0.05, gouge_mm: 0.02, chord_mm: 0.005 };

fn plan(surface: &dyn Surface, cutter: &Cutter, strategy: &Strategy) -> Vec<Pass> {
    let lean = Lean { lead_rad: 0.15, tilt_rad: 0.0 };
    run(&Task::new("F1", surface, cutter, lean, TOLERANCE), strategy).unwrap().passes
}

fn cuts(samples: &[Sample], motions: &[Swept], cutter: &Cutter) -> Vec<Cut> {
    let (stock_mm, depth_mm) = (0.5, 1.0);
    let job = Job { cutter, holder: None, changes: &[], motions, samples, stock_mm, depth_mm };
    cut(&job, &|_| ()).unwrap()
}

fn places(samples: &[Sample], cuts: &[Cut]) -> Vec<FinishedPlace> {
    let place = |(s, c): (&Sample, &Cut)| FinishedPlace {
        face: s.face,
        at: s.uv,
        area_mm2: s.area_mm2,
        by: c.by.filter(|b| !b.rapid).map(|b| b.motion),
    };
    samples.iter().zip(cuts).map(place).collect()
}

/// Times of motions whose speed comes and goes along the way: from a fifth of 2000 mm/min to all of it over `wave_mm`.
fn timed(motions: &[Swept], wave_mm: f64) -> Vec<TimedMotion> {
    let mut way = 0.0;
    let time = |m: &Swept| {
        let length_mm = (m.to.tip - m.from.tip).norm();
        way += length_mm;
        let share = 0.2 + 0.8 * (way / wave_mm).sin().abs();
        TimedMotion { time_min: length_mm / (2000.0 * share), length_mm, feed: !m.rapid }
    };
    motions.iter().map(time).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(36))]

    /// The maps in time add up to the face: whatever face, tool, way of the passes and speeds.
    #[test]
    fn productivity_over_time_is_the_area(
        (shape, x) in (0..6u8, 0.0..1.0f64),
        (tool, way) in (0..3u8, 0..4u8),
        wave_mm in 2.0..60.0f64,
        most in 1..1600usize,
    ) {
        let (surface, tool) = (face(shape, x), cutter(tool));
        let surface = &*surface;
        let passes = plan(surface, &tool, &strategy(way));
        let moves = motions(surface, &passes, &tool);
        let samples = sample_surface(surface, 0, SPACING_MM, 400_000).unwrap().samples;
        let places = places(&samples, &cuts(&samples, &moves, &tool));
        let path = timed(&moves, wave_mm);
        let found = Finishing::of(&places, &path, Fineness::of_places(SPACING_MM)).unwrap();
        let exact = area(surface, 1e-9).value;

        // At every instant: the rates of the stretches by their real times.
        let in_time: f64 = found.stretches.iter().map(|s| s.per_min() * s.time_min).sum();
        prop_assert!((in_time / exact - 1.0).abs() < 0.005, "instantaneous {in_time} of {exact}");
        // Region by region.
        let cells = Cells::over(surface, 0, most);
        let region = Region::of(&places, &found, cells);
        let by_cells = region.integral_mm2();
        prop_assert!((by_cells / exact - 1.0).abs() < 0.005, "regional {by_cells} of {exact}");
        prop_assert!(region.area_mm2.len() == cells.along_u * cells.along_v && region.area_mm2.len() <= most);
        // No time is made or lost: that of the cells is that of the stretches, and the path takes that and more.
        let time: f64 = region.time_min.iter().sum();
        prop_assert!((time / found.time_min - 1.0).abs() < 1e-9, "{time} {}", found.time_min);
        let at_feed: f64 = path.iter().filter(|m| m.feed).map(|m| m.time_min).sum();
        prop_assert!(found.time_min <= at_feed * (1.0 + 1e-12));
        // Strips overlap and reach over the border: width times speed over the time is never less than the area.
        let strips: f64 = passes.iter().map(strip_mm2).sum();
        prop_assert!(strips > 0.995 * exact, "strips {strips} of {exact}");
    }
}

/// Width times way along a pass: what S_C times the speed comes to over its time, whatever the speed.
fn strip_mm2(pass: &Pass) -> f64 {
    let piece = |w: &[osculate_productivity::plan::CcPoint]| {
        0.5 * (w[0].width_mm + w[1].width_mm) * (w[1].point - w[0].point).norm()
    };
    pass.points.windows(2).map(piece).filter(|a| a.is_finite()).sum()
}

/// On a ring, which has no border, width times speed over the time is the area and what strips share. The latter is measured: what
/// every pass alone brings within the tolerance, less the area.
#[test]
fn strips_are_the_area_and_their_overlap() {
    // The hole is wider than the tool is long.
    for (major, minor) in [(36.0, 4.0), (40.0, 7.0)] {
        let ring = Torus::new(major, minor).unwrap();
        let tool = cutter(1);
        let passes = plan(&ring, &tool, &strategy(0));
        let strips: f64 = passes.iter().map(strip_mm2).sum();
        let samples = sample_surface(&ring, 0, SPACING_MM, 400_000).unwrap().samples;
        let mut alone = 0.0;
        for pass in &passes {
            let moves: Vec<Swept> = pass
                .points
                .windows(2)
                .map(|w| Swept { from: w[0].pose, to: w[1].pose, rapid: false, block: 0 })
                .collect();
            let cuts = cuts(&samples, &moves, &tool);
            let within = cuts.iter().zip(&samples).filter(|(c, _)| c.standoff_mm <= TOLERANCE.scallop_mm);
            alone += within.map(|(_, s)| s.area_mm2).sum::<f64>();
        }
        let exact = area(&ring, 1e-9).value;
        let overlap = alone / exact - 1.0;
        println!("ring {major} {minor}: overlap {overlap:.4}, strips {:.4} of the area", strips / exact);
        // Passes are circles about the axis: where the ring closes across them two lie nearer than they need, and around the
        // ring strips of one width differ in length inside and outside.
        assert!(overlap > 0.0 && overlap < 0.3, "{overlap}");
        // Widths are measured along the face at right angles to a circle of geodesic curvature k_g <= 1 / (R - r), whose sides
        // differ by less than a tenth: k_g w / 2 of that, below .2 %. Places a fifth of a strip apart lie on rings of the same
        // kind as the strips, so that every border is off by up to half a row, some of them this way and some that: 1 %.
        assert!((strips / alone - 1.0).abs() < 0.012, "{strips} {alone}");
    }
}

/// Passes of one spacing at one speed: E is their product everywhere, and where blocks take thrice the time a third of it, whatever
/// feed was asked for.
#[test]
fn a_plane_is_spacing_times_real_speed() {
    let interval = Interval::new(0.0, 24.0);
    let plane = Plane::new(Domain { u: interval, v: interval });
    let tool = cutter(0);
    let passes = plan(&plane, &tool, &strategy(0));
    let spacing_mm = (passes[2].points[0].point.y - passes[1].points[0].point.y).abs();
    // Short blocks, of which those over x > 12 mm are slow.
    let mut moves = Vec::new();
    for (k, pass) in passes.iter().enumerate() {
        let (a, b) = (pass.points[0].pose, pass.points[pass.points.len() - 1].pose);
        let n = ((b.tip - a.tip).norm() / 0.3).ceil();
        let at = |i: f64| osculate_tools::Pose { tip: a.tip + (b.tip - a.tip) * (i / n), axis: a.axis };
        if k > 0 {
            let from = moves.last().map_or(a, |m: &Swept| m.to);
            // Far above: a rapid that cuts nothing.
            let up = |p: osculate_tools::Pose| osculate_tools::Pose {
                tip: p.tip + Vec3::new(0.0, 0.0, 20.0),
                ..p
            };
            moves.push(Swept { from: up(from), to: up(a), rapid: true, block: 0 });
        }
        let pieces = (0..n as u32).map(f64::from);
        moves.extend(pieces.map(|i| Swept { from: at(i), to: at(i + 1.0), rapid: false, block: 0 }));
    }
    let samples = sample_surface(&plane, 0, SPACING_MM, 400_000).unwrap().samples;
    let places = places(&samples, &cuts(&samples, &moves, &tool));
    let slow = |m: &Swept| m.from.tip.x + m.to.tip.x > 24.0;
    let path: Vec<TimedMotion> = moves
        .iter()
        .map(|m| {
            let length_mm = (m.to.tip - m.from.tip).norm();
            let speed = if slow(m) { 500.0 } else { 1500.0 };
            TimedMotion { time_min: length_mm / speed, length_mm, feed: !m.rapid }
        })
        .collect();
    let found = Finishing::of(&places, &path, Fineness::of_places(SPACING_MM)).unwrap();
    let region =
        Region::of(&places, &found, Cells { face: 0, domain: plane.domain(), along_u: 4, along_v: 4 });
    let rates = region.mm2_min();
    for (u, want) in [(0, 1500.0 * spacing_mm), (3, 500.0 * spacing_mm)] {
        // Inside, away from the first and the last pass: a cell holds about ten of them, one more or less at its sides.
        for v in [1, 2] {
            let got = rates[u * 4 + v];
            assert!((got / want - 1.0).abs() < 0.04, "{got} instead of {want}");
        }
    }
    let spread = Spread::of(&found.stretches).unwrap();
    assert!(spread.min < 600.0 * spacing_mm && spread.max > 1400.0 * spacing_mm, "{spread:?}");
    // Half of the way takes three quarters of the time: the mean is 2 / (1 / 1500 + 1 / 500) = 750 mm/min times the spacing, less
    // what the last pass shares with the one before it and what both outer ones lay beside the face.
    let strips = passes.len() as f64 * spacing_mm * 24.0;
    let want = 750.0 * spacing_mm * (24.0 * 24.0 / strips);
    assert!((spread.mean / want - 1.0).abs() < 0.01, "{spread:?} {want}");
}

/// A face of which a part is not reached: the maps say that part, and not more than what was cut.
#[test]
fn what_no_pass_reaches_is_not_finished() {
    let tube = patch(Cylinder::new(12.0, Interval::new(0.0, 12.0)).unwrap(), [0.0, 1.2], [0.0, 12.0]);
    let tool = cutter(1);
    let passes = plan(&*tube, &tool, &strategy(0));
    let half = &passes[..passes.len() / 2];
    let moves = motions(&*tube, half, &tool);
    let samples = sample_surface(&*tube, 0, SPACING_MM, 400_000).unwrap().samples;
    let cuts = cuts(&samples, &moves, &tool);
    let places = places(&samples, &cuts);
    let found = Finishing::of(&places, &timed(&moves, 10.0), Fineness::of_places(SPACING_MM)).unwrap();
    let reached: f64 =
        samples.iter().zip(&cuts).filter(|(_, c)| c.by.is_some()).map(|(s, _)| s.area_mm2).sum();
    assert!((found.finished_mm2 - reached).abs() < 1e-9 * reached);
    let share = found.finished_mm2 / found.area_mm2;
    assert!(share > 0.4 && share < 0.75, "{share}");
    let region = Region::of(&places, &found, Cells::over(&*tube, 0, 300));
    assert!((region.integral_mm2() / reached - 1.0).abs() < 1e-9);
    assert!(region.mm2_min().iter().any(|rate| rate.is_nan()));
}
