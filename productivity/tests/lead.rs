//! Lead that changes from place to place: what it leaves, how fast it changes and that no lead held all over is shorter.

use crate::cutting;

use cutting::{motions, verdict};
use osculate_geom::line::{IsoLine, SurfaceLine};
use osculate_geom::{Axis, Point3, Surface, Vec3};
use osculate_productivity::compare::Around;
use osculate_productivity::plan::{
    Along, CcPoint, Leaning, LocalLead, Pass, Passes, PlanError, Strategy, Task, Tolerance, run,
};
use osculate_surfaces::{Net, NurbsSurface};
use osculate_tools::{Cutter, CutterSpec, Lean};

const TOLERANCE: Tolerance = Tolerance { scallop_mm: 0.01, gouge_mm: 0.005, chord_mm: 0.001 };
/// Sides of the face, mm.
const SIZE_MM: f64 = 30.0;
/// Curvature at the ends, 1/mm: hollow at the upper one, convex at the lower.
const BENT_PER_MM: f64 = 0.05;
const RATE_DEG_PER_MM: f64 = 0.8;

/// `z = c x^3` over `|x| <= 15` and `0 <= y <= 30`, material below: hollow by `6 c x`, about.
fn bend() -> NurbsSurface {
    sheared(3, 0.0)
}

/// `z = c x^n` for an odd n, hollow by as much at its end, each line of constant y moved along x by a share of y.
fn sheared(n: usize, share: f64) -> NurbsSurface {
    let half = 0.5 * SIZE_MM;
    // Poles of (x / half)^n as a Bezier polynomial: its blossom, the product, at ends of either sign.
    let height = BENT_PER_MM * half * half / (n * (n - 1)) as f64;
    let pole = |i: usize| if (n - i).is_multiple_of(2) { height } else { -height };
    let points = (0..=n)
        .flat_map(|i| (0..2).map(move |j| (i, SIZE_MM * f64::from(j))))
        .map(|(i, y)| Point3::new(-half + SIZE_MM * i as f64 / n as f64 + share * y, y, pole(i)))
        .collect();
    let u = [vec![0.0; n + 1], vec![1.0; n + 1]].concat();
    let knots = [u, vec![0.0, 0.0, 1.0, 1.0]];
    NurbsSurface::new([n, 1], knots, Net { count: [n + 1, 2], points, weights: None }).unwrap()
}

fn cutter() -> Cutter {
    Cutter::try_from(CutterSpec::Toroidal { diameter_mm: 8.0, corner_radius_mm: 1.0, length_mm: 40.0 })
        .unwrap()
}

fn local() -> LocalLead<'static> {
    LocalLead {
        tilt_rad: Some(0.0),
        least_rad: 1f64.to_radians(),
        most_rad: LocalLead::MOST_RAD,
        rate_rad_per_mm: RATE_DEG_PER_MM.to_radians(),
        holder: None,
        around: None,
    }
}

fn plan(lean: Leaning<'_>, strategy: &Strategy) -> Result<Passes, PlanError> {
    let (surface, cutter) = (&bend(), &cutter());
    run(&Task::new("F1", surface, cutter, lean, TOLERANCE), strategy)
}

/// Whether passes hold the tolerance, and by how much they go too deep.
fn holds(passes: &Passes) -> (bool, f64) {
    let (surface, cutter) = (bend(), cutter());
    let moves = motions(&surface, &passes.passes, &cutter);
    let v = verdict(&surface, &moves, &cutter, TOLERANCE, 0.25);
    let within = v.scallop_max_mm <= TOLERANCE.scallop_mm
        && v.gouge_max_mm <= TOLERANCE.gouge_mm
        && v.uncut_samples == 0;
    (within, v.gouge_max_mm)
}

#[test]
fn a_local_lead_holds_and_is_shorter_than_any_held() {
    let strategy = Strategy::Isoparametric { along: Along::Fixed(Axis::V) };
    let passes = plan(Leaning::Local(&local()), &strategy).unwrap();
    let (within, gouge_mm) = holds(&passes);
    assert!(within, "gouge {gouge_mm}");
    let [least, mean, most] = passes.inclination_rad().unwrap();
    // The hollow end wants R k, less for the corner and for the heel that has left the face; the convex one nothing.
    let want = (4.0 * BENT_PER_MM).asin();
    assert!(most > 0.5 * want && most < 1.3 * want && least < 0.5 * mean, "{least} {mean} {most}");
    // The least of the leads that hold when they are held, a degree apart: the shortest path of them.
    let held = (5..15).find_map(|deg| {
        let lean = Lean { lead_rad: f64::from(deg).to_radians(), tilt_rad: 0.0 };
        plan(lean.into(), &strategy).ok().filter(|p| holds(p).0)
    });
    let best = held.unwrap().length_mm();
    assert!(passes.length_mm() < 0.9 * best, "{} against {best}", passes.length_mm());
}

/// Across the lines of constant curvature the hollow end needs more passes than the rest: regions are shorter, and hold.
#[test]
fn regions_with_a_local_lead_hold_and_are_shorter() {
    let along = Along::Fixed(Axis::U);
    let own = local();
    let local = Leaning::Local(&own);
    let whole = plan(local, &Strategy::Isoparametric { along }).unwrap();
    let parts = plan(local, &Strategy::Regions { along }).unwrap();
    let (within, gouge_mm) = holds(&parts);
    assert!(within, "gouge {gouge_mm}");
    assert!(parts.length_mm() < 0.9 * whole.length_mm(), "{} of {}", parts.length_mm(), whole.length_mm());
}

/// A wall beside the face that the tool touches at any lead: the passes say how many places that concerns.
#[test]
fn places_that_no_lead_clears_are_told() {
    let free =
        plan(Leaning::Local(&local()), &Strategy::Isoparametric { along: Along::Fixed(Axis::V) }).unwrap();
    let told = |p: &Passes| p.diagnostics.iter().filter(|d| d.to_string().contains("no lead keeps")).count();
    assert_eq!(told(&free), 0);
    let [a, b] = [-0.5 * SIZE_MM, 0.5 * SIZE_MM];
    // Three millimetres beyond the end of the passes, a radius being four.
    let corners = [[a, -40.0], [a, 40.0], [b, -40.0], [b, 40.0]];
    let points = corners.map(|[x, z]| Point3::new(x, SIZE_MM + 3.0, z)).to_vec();
    let knots = [vec![0.0, 0.0, 1.0, 1.0], vec![0.0, 0.0, 1.0, 1.0]];
    let wall = NurbsSurface::new([1, 1], knots, Net { count: [2, 2], points, weights: None }).unwrap();
    let around = Around::of(std::iter::once((&wall as &dyn Surface, "wall")));
    let beside = LocalLead { around: Some(&around), ..local() };
    for strategy in [
        Strategy::Isoparametric { along: Along::Fixed(Axis::V) },
        Strategy::Isoplanar { normal: Vec3::x_axis() },
    ] {
        let passes = plan(Leaning::Local(&beside), &strategy).unwrap();
        assert_eq!(told(&passes), 1, "{strategy:?}");
    }
}

#[test]
fn even_passes_with_a_local_lead_hold() {
    let passes = plan(Leaning::Local(&local()), &Strategy::Curvature5c).unwrap();
    let (within, gouge_mm) = holds(&passes);
    assert!(within, "gouge {gouge_mm}");
}

/// The lead that a pass has, against that at the point before: no more than the rate; and the tool goes no deeper than the
/// tolerance into any of ninety thousand points of the face, at places that are no nodes of any grid.
#[test]
fn the_lead_changes_no_faster_than_the_rate_and_clears_everywhere() {
    let strategy = Strategy::Isoparametric { along: Along::Fixed(Axis::U) };
    let (face, cutter) = (bend(), cutter());
    let passes = plan(Leaning::Local(&local()), &strategy).unwrap();
    let domain = face.domain();
    let part = |k: usize| (k % 301) as f64 / 300.0;
    let points: Vec<Point3> = (0..301 * 301).map(|k| face.point(domain.at(part(k), part(k / 301)))).collect();
    let (mut fastest, mut asked) = (0.0f64, 0);
    for pass in &passes.passes {
        for w in pass.points.windows(2) {
            let lead = w.iter().map(|p| p.pose.axis.angle(&p.normal)).collect::<Vec<_>>();
            let step = (w[1].point - w[0].point).norm();
            if step > 1e-3 {
                fastest = fastest.max((lead[1] - lead[0]).abs() / step);
            }
        }
        // Every point of the face against the tool standing there.
        for p in pass.points.iter().step_by(7) {
            let deepest =
                points.iter().map(|x| -cutter.distance(&p.pose, x)).fold(f64::NEG_INFINITY, f64::max);
            assert!(deepest <= TOLERANCE.gouge_mm, "{:?}: {deepest}", p.uv);
            asked += 1;
        }
    }
    assert!(asked > 30);
    // Chords are shorter than the way, by less than a thousandth.
    let limit = RATE_DEG_PER_MM.to_radians();
    assert!(fastest <= 1.001 * limit && fastest > 0.1 * limit, "{} deg/mm", fastest.to_degrees());
}

/// Near the hollow end the far side of the tool lies over other places when a pass runs towards the end than when it runs away from it: each
/// sense has a lead of its own, and with the lesser of the two the other would dig in.
#[test]
fn each_sense_has_the_lead_that_it_needs() {
    let (face, cutter) = (bend(), cutter());
    let passes =
        plan(Leaning::Local(&local()), &Strategy::Isoparametric { along: Along::Fixed(Axis::U) }).unwrap();
    let u = 0.97;
    let lead_rad = |reversed: bool| {
        let runs = |p: &&Pass| (p.points[0].uv.u > 0.5) == reversed;
        let points = passes.passes.iter().filter(runs).flat_map(|p| &p.points);
        let near = points.min_by(|a, b| (a.uv.u - u).abs().total_cmp(&(b.uv.u - u).abs())).unwrap();
        near.pose.axis.angle(&near.normal)
    };
    let leads = [false, true].map(lead_rad);
    let domain = face.domain();
    let part = |k: usize| (k % 301) as f64 / 300.0;
    let points: Vec<Point3> = (0..301 * 301).map(|k| face.point(domain.at(part(k), part(k / 301)))).collect();
    let deepest = |reversed: bool, lead_rad: f64| {
        let line = IsoLine { surface: &face, along: Axis::U, fixed: 0.5, reversed };
        let pose = Lean { lead_rad, tilt_rad: 0.0 }.pose(&cutter, &line.frame(u).unwrap().0, 0.0);
        points.iter().map(|x| -cutter.distance(&pose, x)).fold(f64::NEG_INFINITY, f64::max)
    };
    let more = usize::from(leads[1] > leads[0]);
    assert!(leads[more] > 1.2 * leads[1 - more], "{leads:?}");
    for (k, reversed) in [(0, false), (1, true)] {
        assert!(deepest(reversed, leads[k]) <= TOLERANCE.gouge_mm, "{leads:?}");
    }
    assert!(deepest(more == 1, leads[1 - more]) > TOLERANCE.gouge_mm, "{leads:?}");
}

/// On a saddle whose hollow way lies at 45 degrees to the passes the second contact is always on one side, the other one where a pass runs
/// back. A tilt found place by place takes strips to both sides: fewer passes, which hold, and none leans further than it may.
#[test]
fn a_tilt_by_place_takes_strips_to_both_sides() {
    let (half, bent) = (0.5 * SIZE_MM, 0.02);
    let points = (0..4).map(|k| [[-half, half][k / 2], [-half, half][k % 2]]);
    let points = points.map(|[x, y]| Point3::new(x, y, bent * x * y)).collect();
    let knots = [vec![0.0, 0.0, 1.0, 1.0], vec![0.0, 0.0, 1.0, 1.0]];
    let face = NurbsSurface::new([1, 1], knots, Net { count: [2, 2], points, weights: None }).unwrap();
    let cutter = cutter();
    let plan = |tilt_rad: Option<f64>| {
        let own = LocalLead { tilt_rad, ..local() };
        let task = Task::new("F1", &face, &cutter, Leaning::Local(&own), TOLERANCE);
        run(&task, &Strategy::Isoparametric { along: Along::Fixed(Axis::U) }).unwrap()
    };
    let (upright, tilted) = (plan(Some(0.0)), plan(None));
    let moves = motions(&face, &tilted.passes, &cutter);
    let v = verdict(&face, &moves, &cutter, TOLERANCE, 0.25);
    // In a corner of the face, where a pass ends before it digs in, a twentieth more is left.
    let within = v.scallop_max_mm <= 1.05 * TOLERANCE.scallop_mm && v.gouge_max_mm <= TOLERANCE.gouge_mm;
    assert!(within && v.uncut_samples == 0, "left {} mm, dug {} mm", v.scallop_max_mm, v.gouge_max_mm);
    let counts = [&upright, &tilted].map(|p| p.passes.len());
    assert!(20 * counts[1] < 18 * counts[0], "{counts:?}");
    // Against the chord of a pass, which bends between two points.
    let [none, some] = [&upright, &tilted].map(|p| p.tilts_rad().unwrap());
    assert!(none.iter().all(|t| t.abs() < 0.01), "{none:?}");
    assert!(some[0] < -0.02 || some[1] > 0.02, "{some:?}");
    assert!(some.iter().all(|t| t.abs() < 0.36), "{some:?}");
}

/// Passes run out over an end that they meet at a slant. Where the face goes on ever more hollow there the tool with the lead of the
/// border would dig in behind itself: a pass that leaves the face ends before that. What it has not come down to is left to the
/// others, and no lead is greater than the border wants: `R k`, where half a strip further on k is a quarter more.
#[test]
fn passes_end_before_the_tool_digs_in_beyond_a_border() {
    let (face, cutter) = (sheared(7, 1.0), cutter());
    let lean = Leaning::Local(&local());
    let task = Task::new("F1", &face, &cutter, lean, TOLERANCE);
    let passes = run(&task, &Strategy::Isoparametric { along: Along::Fixed(Axis::U) }).unwrap();
    let moves = motions(&face, &passes.passes, &cutter);
    let v = verdict(&face, &moves, &cutter, TOLERANCE, 0.25);
    let within = v.scallop_max_mm <= TOLERANCE.scallop_mm && v.gouge_max_mm <= TOLERANCE.gouge_mm;
    assert!(within && v.uncut_samples == 0, "left {} mm, dug {} mm", v.scallop_max_mm, v.gouge_max_mm);
    let want = (4.0 * BENT_PER_MM).asin();
    let [_, _, most] = passes.inclination_rad().unwrap();
    assert!(most < 1.12 * want, "{most} against {want}");
    // How far beyond the hollow end passes begin there, and how far they end.
    let beyond = |p: &CcPoint| (p.point - face.point(p.uv)).norm();
    let [mut begin, mut end] = [0.0f64; 2];
    for points in passes.passes[1..passes.passes.len() - 1].iter().map(|p| &p.points) {
        let (first, last) = (&points[0], &points[points.len() - 1]);
        if first.uv.u > last.uv.u { begin = begin.max(beyond(first)) } else { end = end.max(beyond(last)) }
    }
    assert!(end > 0.01 && end < 0.8 * begin && begin < 1.0, "{begin} {end}");
}

/// The rates of a pose whose lead changes are those of its differences.
#[test]
fn the_motion_with_a_changing_lead_meets_its_differences() {
    let (face, cutter) = (bend(), cutter());
    let line = IsoLine { surface: &face, along: Axis::U, fixed: 0.4, reversed: false };
    let lead = |t: f64| 0.1 + 0.3 * t;
    let moving = |t: f64| {
        let (frame, speed) = line.frame(t).unwrap();
        Lean { lead_rad: lead(t), tilt_rad: 0.2 - 0.2 * t }.moving(
            &cutter,
            &frame,
            0.05,
            (speed, [0.3, -0.2]),
        )
    };
    let d = 1e-5;
    for t in [0.2, 0.55, 0.9] {
        let (a, b, here) = (moving(t - d), moving(t + d), moving(t));
        let tip = (b.pose.tip - a.pose.tip) / (2.0 * d);
        let axis = (b.pose.axis.into_inner() - a.pose.axis.into_inner()) / (2.0 * d);
        // Differences to second order over rounding of coordinates of some 40 mm.
        assert!((tip - here.tip_rate).norm() < 1e-6, "{tip:?} {:?}", here.tip_rate);
        assert!((axis - here.turn.cross(&here.pose.axis)).norm() < 1e-7);
    }
}
