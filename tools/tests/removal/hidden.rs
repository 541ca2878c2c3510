//! What hides between samples stays below its bound, which closes in with the square of the spacing.

use crate::removal::common::{ball, sample, toroidal, upright};
use osculate_geom::analytic::{Cylinder, Plane};
use osculate_geom::{Domain, Interval, Point3, Surface, Unit3, Uv, Vec3, uv};
use osculate_tools::removal::{
    Change, Cut, Job, Measured, Patch, Refined, Sample, Sampling, Swept, Wanted, cut, hidden, refine,
    sample_boundary, sample_surface,
};
use osculate_tools::{Cutter, Holder, Pose};

fn square(side: f64) -> Plane {
    let i = Interval::new(0.0, side);
    Plane::new(Domain { u: i, v: i })
}

/// The highest standoff seen, and the bound on the highest there is.
fn look(surface: &dyn Surface, sampling: &Sampling, cutter: &Cutter, motions: &[Swept]) -> [f64; 2] {
    let job = Job {
        cutter,
        holder: None,
        changes: &[],
        motions,
        samples: &sampling.samples,
        stock_mm: 0.5,
        depth_mm: 1.0,
    };
    let cuts: Vec<Cut> = cut(&job, &|_| ()).expect("a good job");
    let patches: Vec<Option<Patch>> = sampling.patches.iter().copied().map(Some).collect();
    let seen = cuts.iter().map(|c| c.standoff_mm).fold(0.0, f64::max);
    let bound = |enough_mm: f64| {
        let wanted = Wanted { uncut_mm: 0.4, enough_mm, gouge_mm: 0.01 };
        seen + hidden(&[surface], &job, (&patches, &cuts), wanted).expect("a good job").scallop_mm
    };
    let sharpest = bound(0.0);
    // A bound that need not be sharper is one still, and no higher than it needs to be.
    for enough in [seen, 1.1 * sharpest, 2.0 * sharpest] {
        let loose = bound(enough);
        assert!(loose >= sharpest - 1e-12 && loose <= sharpest.max(enough) + 1e-12, "{loose} for {enough}");
    }
    [seen, sharpest]
}

fn raster(step: f64, count: u32, place: impl Fn(f64, f64) -> Pose) -> Vec<Swept> {
    (0..count)
        .map(|k| step * f64::from(k))
        .map(|y| Swept { from: place(-10.0, y), to: place(20.0, y), rapid: false, block: 1 })
        .collect()
}

#[test]
fn cusps_of_balls_on_a_plane() {
    let (r, step) = (3.0f64, 0.61);
    let motions = raster(step, 20, |x, y| upright(x, y - 0.13, 0.0));
    let truth = r - (r * r - 0.25 * step * step).sqrt();
    let surface = square(8.0);
    let mut above = Vec::new();
    for spacing in [0.16, 0.08, 0.04] {
        let sampling = sample_surface(&surface, 0, spacing, 1_000_000).unwrap();
        let [seen, bound] = look(&surface, &sampling, &ball(2.0 * r), &motions);
        assert!(seen <= truth + 1e-12 && bound >= truth - 1e-12, "{seen} {truth} {bound}");
        // The cell's corner is half a diagonal away: the mean of two motions is above the cusp by r^2 / 2R.
        assert!(bound - truth <= spacing * spacing / (4.0 * r) + 1e-9, "{spacing}: {bound} {truth}");
        above.push(bound - truth);
    }
    // At least: a cell may do better where the cusp runs along its edge.
    assert!(above[2] < above[0] / 8.0, "{above:?}");
}

#[test]
fn cusps_of_a_toroidal_end_on_a_cylinder() {
    let (part, lead) = (25.0, 0.15f64);
    let cutter = toroidal(10.0, 2.0);
    let (core, r) = (cutter.core_mm(), cutter.corner_mm());
    let surface = Cylinder::new(part, Interval::new(0.0, 5.0)).unwrap();
    // Along generators 0.11 rad apart, all around; leaning along the axis.
    let passes = 57;
    let pose = |k: u32, z: f64| {
        let (s, c) = (std::f64::consts::TAU * f64::from(k) / f64::from(passes) + 0.017).sin_cos();
        let n = Vec3::new(c, s, 0.0);
        let axis = n * lead.cos() + Vec3::z() * lead.sin();
        let low = Vec3::z() * lead.cos() - n * lead.sin();
        let tip = Point3::from(n * (part + r) + Vec3::z() * z - low * core - axis * r);
        Pose { tip, axis: Unit3::new_normalize(axis) }
    };
    let motions: Vec<Swept> = (0..passes)
        .map(|k| Swept { from: pose(k, -10.0), to: pose(k, 20.0), rapid: false, block: k })
        .collect();
    // Along the passes everything is alike: one row of samples around, a hundredth of a millimetre apart.
    let row: Vec<_> = (0..15_000)
        .map(|k| (std::f64::consts::TAU * f64::from(k) / 15_000.0).sin_cos())
        .map(|(s, c)| sample([part * c, part * s, 2.5], [c, s, 0.0]))
        .collect();
    let job = Job {
        cutter: &cutter,
        holder: None,
        changes: &[],
        motions: &motions,
        samples: &row,
        stock_mm: 0.5,
        depth_mm: 1.0,
    };
    let truth = cut(&job, &|_| ()).unwrap().iter().map(|c| c.standoff_mm).fold(0.0, f64::max);
    for spacing in [0.3, 0.15] {
        let sampling = sample_surface(&surface, 0, spacing, 1_000_000).unwrap();
        let [seen, bound] = look(&surface, &sampling, &cutter, &motions);
        // The row's samples miss the cusp by up to 0.005 mm of a slope below 0.2.
        assert!(
            seen <= truth + 1e-3 && bound >= truth && bound <= truth + 1.5e-3 + 0.1 * spacing * spacing,
            "{seen} {truth} {bound}"
        );
    }
}

/// A square with a wedge that ends in a tip, cut from its left.
struct Wedge;

impl Surface for Wedge {
    fn domain(&self) -> Domain {
        square(8.0).domain()
    }
    fn jet2(&self, at: Uv) -> osculate_geom::Jet2 {
        square(8.0).jet2(at)
    }
    fn contains(&self, at: Uv) -> bool {
        at.u >= 0.0 && at.u <= 7.93 && (at.v - 4.013).abs() <= 0.05 * (7.93 - at.u)
    }
    fn taylor(&self, at: Uv, order: usize) -> osculate_geom::Taylor {
        square(8.0).taylor(at, order)
    }
}

/// The tip of a trimmed face lies between the samples of the grid; the samples on its outline see what is left on it.
#[test]
fn tips_of_trims_are_looked_at() {
    let cutter = ball(6.0);
    // Passes across the wedge that end before its tip.
    let motions: Vec<Swept> = (0..19)
        .map(|k| 0.4 * f64::from(k))
        .map(|x| Swept { from: upright(x, 0.0, 0.0), to: upright(x, 8.0, 0.0), rapid: false, block: 1 })
        .collect();
    let left = 3.0 - (9.0f64 - 0.73 * 0.73).sqrt();
    let outline = [uv(0.0, 4.013 - 0.3965), uv(7.93, 4.013), uv(0.0, 4.013 + 0.3965)];
    let sampling = sample_surface(&Wedge, 0, 0.2, 100_000).unwrap();
    let edge = sample_boundary(&Wedge, &outline, 3, 0.2);
    assert!(edge.iter().all(|s| s.face == 3 && s.area_mm2 == 0.0));
    // Half the spacing apart at most, all the way round.
    let way: f64 = edge.windows(2).map(|p| (p[1].point - p[0].point).norm()).fold(0.0, f64::max);
    assert!(way <= 0.1 + 1e-12 && edge.len() >= 160, "{way} {}", edge.len());
    let highest = |samples: &[Sample]| {
        let job = Job {
            cutter: &cutter,
            holder: None,
            changes: &[],
            motions: &motions,
            samples,
            stock_mm: 0.5,
            depth_mm: 1.0,
        };
        let cuts = cut(&job, &|_| ()).unwrap();
        cuts.iter().map(|c| c.standoff_mm).fold(0.0, f64::max)
    };
    let (inside, with_edge) = (highest(&sampling.samples), highest(&edge));
    assert!((with_edge - left).abs() < 1e-9 && inside < left, "{inside} {with_edge} {left}");
}

/// Samples put where limits may be exceeded, and how those came out: the highest and the deepest seen, with their bounds.
fn refined(
    surface: &dyn Surface,
    spacing: f64,
    (cutter, changes, motions): (&Cutter, &[Change<'_>], &[Swept]),
    (scallop, gouge): (f64, f64),
    most: usize,
) -> (Measured, Refined) {
    let sampling = sample_surface(surface, 0, spacing, 1_000_000).expect("a good face");
    let job = Job {
        cutter,
        holder: None,
        changes,
        motions,
        samples: &sampling.samples,
        stock_mm: 0.5,
        depth_mm: 1.0,
    };
    let patches = sampling.patches.iter().copied().map(Some).collect();
    let cuts = cut(&job, &|_| ()).expect("a good job");
    let mut measured = Measured { samples: sampling.samples.clone(), patches, cuts };
    let wanted = Wanted { uncut_mm: 0.4, enough_mm: scallop, gouge_mm: gouge };
    let refined = refine(&[surface], &job, &mut measured, wanted, most).expect("a good job");
    let area = |s: &[Sample]| s.iter().map(|s| s.area_mm2).sum::<f64>();
    assert!((area(&measured.samples) - sampling.area_mm2).abs() < 1e-9 * sampling.area_mm2);
    assert!(measured.samples.iter().all(|s| s.area_mm2 >= 0.0));
    (measured, refined)
}

#[test]
fn a_cusp_between_samples_is_found_by_samples_added_there() {
    let (r, step) = (3.0f64, 0.61);
    let motions = raster(step, 20, |x, y| upright(x, y - 0.13, 0.0));
    let truth = r - (r * r - 0.25 * step * step).sqrt();
    let (surface, cutter) = (square(3.0), ball(2.0 * r));
    let top = |m: &Measured| m.cuts.iter().map(|c| c.standoff_mm).fold(0.0, f64::max);
    let measure =
        |limit: f64, most: usize| refined(&surface, 0.16, (&cutter, &[], &motions), (limit, 0.01), most);
    // Without more samples the cusp seems lower than it is.
    let (before, none) = measure(0.999 * truth, 0);
    assert!(top(&before) < 0.9995 * truth && none.added == 0 && none.left_out > 0, "{none:?}");
    assert!(top(&before) + none.hidden.scallop_mm >= truth);
    // A limit just below the cusp is seen to be exceeded, one just above to be kept.
    let (over, some) = measure(0.9995 * truth, 1_000_000);
    assert!(top(&over) > 0.9995 * truth && top(&over) <= truth + 1e-12 && some.added > 0);
    let (under, kept) = measure(1.0005 * truth, 1_000_000);
    assert!(top(&under) + kept.hidden.scallop_mm <= 1.0005 * truth && kept.left_out == 0, "{kept:?}");
    assert!(top(&under) + kept.hidden.scallop_mm >= truth - 1e-12);
    // With room for some only, what could not be looked at may hide still.
    let (few, short) = measure(0.9995 * truth, 40);
    assert!(short.added == 40 && short.left_out > 0 && few.samples.len() == before.samples.len() + 40);
    assert!(top(&few) + short.hidden.scallop_mm >= truth);
}

#[test]
fn a_gouge_between_samples_is_found_by_samples_added_there() {
    // One pass digs in by this much, with its bottom between two rows of samples.
    let (depth, r) = (0.012, 3.0);
    let motions = [Swept {
        from: upright(-10.0, 1.43, -depth),
        to: upright(20.0, 1.6, -depth),
        rapid: false,
        block: 1,
    }];
    let (surface, cutter) = (square(3.0), ball(2.0 * r));
    let deepest = |m: &Measured| m.cuts.iter().map(|c| -c.standoff_mm).fold(0.0, f64::max);
    // Most of the face is not cut at all: gouges are looked for beside it.
    let measure = |limit: f64, most: usize| {
        refined(&surface, 0.3, (&cutter, &[], &motions), (f64::INFINITY, limit), most)
    };
    let (before, none) = measure(0.99995 * depth, 0);
    assert!(deepest(&before) + none.hidden.gouge_mm >= depth, "{none:?}");
    let (over, some) = measure(0.99995 * depth, 1_000_000);
    assert!(deepest(&over) > 0.99995 * depth && deepest(&over) <= depth + 1e-12 && some.added > 0);
    assert!(deepest(&before) < deepest(&over));
    let (under, kept) = measure(1.0005 * depth, 1_000_000);
    assert!(deepest(&under) + kept.hidden.gouge_mm <= 1.0005 * depth, "{kept:?}");
    assert!(deepest(&under) + kept.hidden.gouge_mm >= depth - 1e-12);
}

/// Poses along x of a tool that leans aside, its lowest point on a line a little across the rows of samples.
fn aside(cutter: &Cutter, tilt: f64, depth: f64) -> [Pose; 2] {
    let axis = Vec3::new(0.0, tilt.sin(), tilt.cos());
    let down = Vec3::new(0.0, tilt.cos(), -tilt.sin());
    // From the tip to the lowest point: to the middle of the corner's circle, then straight down.
    let low = down * cutter.core_mm() + axis * cutter.corner_mm() - Vec3::z() * cutter.corner_mm();
    [(-20.0, 1.43), (25.0, 1.6)]
        .map(|(x, y)| Pose { tip: Point3::new(x, y, -depth) - low, axis: Unit3::new_normalize(axis) })
}

/// Alone, and after a ball that has gone over the face as it should: what is sharp is found beside what is blunt.
#[test]
fn gouges_as_sharp_as_a_corner_are_found() {
    let (surface, depth) = (square(3.0), 0.02);
    let first = ball(6.0);
    let before = raster(0.3, 12, |x, y| upright(x, y, 0.0));
    let tools = [(0.3, 0.2), (0.05, 0.2), (0.0, 0.1), (0.0, 0.5)];
    for ((corner, tilt), alone) in tools.into_iter().flat_map(|t| [(t, true), (t, false)]) {
        let cutter = toroidal(10.0, corner);
        let [from, to] = aside(&cutter, tilt, depth);
        let mut motions = vec![Swept { from, to, rapid: false, block: 1 }];
        let mut changes = Vec::new();
        if !alone {
            motions.splice(0..0, before.iter().copied());
            changes.push(Change { first: before.len(), cutter: &cutter, holder: None });
        }
        let tool = if alone { &cutter } else { &first };
        let deepest = |m: &Measured| m.cuts.iter().map(|c| -c.standoff_mm).fold(0.0, f64::max);
        let measure = |limit: f64, most: usize| {
            refined(&surface, 0.15, (tool, &changes, &motions), (f64::INFINITY, limit), most)
        };
        let (before, none) = measure(0.6 * depth, 0);
        assert!(deepest(&before) + none.hidden.gouge_mm >= depth - 1e-12, "{corner} {tilt}: {none:?}");
        let (over, some) = measure(0.98 * depth, 1_000_000);
        assert!(deepest(&over) > 0.98 * depth && deepest(&over) <= depth + 1e-12, "{corner}: {some:?}");
        assert!(deepest(&before) < deepest(&over) && some.added > 0);
        let (under, kept) = measure(1.02 * depth, 1_000_000);
        assert!(deepest(&under) + kept.hidden.gouge_mm <= 1.02 * depth + 1e-15, "{corner}: {kept:?}");
        assert!(deepest(&under) + kept.hidden.gouge_mm >= depth - 1e-12);
    }
}

/// Between the samples of a face that is only checked, and by a rapid or by a holder.
#[test]
fn gouges_of_rapids_and_holders_are_found_on_check_faces() {
    let (surface, depth, limit) = (square(3.0), 0.02, 0.005);
    let holder = toroidal(10.0, 0.0);
    let held_by = Holder::from(holder);
    // The holder begins where the cutter ends: its own tip is so much higher up the axis.
    let short = toroidal(2.0, 0.5);
    let [from, to] = aside(&holder, 0.3, depth)
        .map(|p| Pose { tip: p.tip - p.axis.into_inner() * short.length_mm(), axis: p.axis });
    let held = [Swept { from, to, rapid: false, block: 1 }];
    let [from, to] = aside(&holder, 0.3, depth);
    let rapid = [Swept { from, to, rapid: true, block: 1 }];
    for (cutter, holder, motions) in [(&short, Some(&held_by), &held), (&holder, None, &rapid)] {
        let mut sampling = sample_surface(&surface, 0, 0.3, 1_000_000).unwrap();
        for sample in &mut sampling.samples {
            sample.check_only = true;
        }
        let samples = &sampling.samples;
        let job = Job { cutter, holder, changes: &[], motions, samples, stock_mm: 0.5, depth_mm: 1.0 };
        let patches = sampling.patches.iter().copied().map(Some).collect();
        let mut measured = Measured { samples: samples.clone(), patches, cuts: cut(&job, &|_| ()).unwrap() };
        let deepest = |m: &Measured| m.cuts.iter().map(|c| -c.standoff_mm).fold(0.0, f64::max);
        let wanted = |gouge_mm: f64| Wanted { uncut_mm: 0.4, enough_mm: 0.01, gouge_mm };
        let seen = deepest(&measured);
        let refine =
            |m: &mut Measured, gouge: f64, most| refine(&[&surface], &job, m, wanted(gouge), most).unwrap();
        let none = refine(&mut measured.clone(), limit, 0);
        assert!(seen + none.hidden.gouge_mm >= depth - 1e-12 && seen < 0.9 * depth, "{seen} {none:?}");
        let kept = refine(&mut measured.clone(), 1.1 * depth, 1_000_000);
        assert!(kept.hidden.gouge_mm + seen <= 1.1 * depth + 1e-15, "{kept:?}");
        let found = refine(&mut measured, 0.95 * depth, 1_000_000);
        assert!(deepest(&measured) > 0.95 * depth && found.added > 0, "{seen} {found:?}");
        assert!(deepest(&measured) <= depth + 1e-12);
    }
}
