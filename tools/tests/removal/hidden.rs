//! What hides between samples stays below its bound, which closes in with the square of the spacing.

use crate::common::{ball, sample, toroidal, upright};
use osculate_geom::analytic::{Cylinder, Plane};
use osculate_geom::{Domain, Interval, Point3, Surface, Unit3, Uv, Vec3, uv};
use osculate_tools::removal::{
    Cut, Job, Patch, Sampling, Swept, Wanted, cut, hidden, sample_boundary, sample_surface,
};
use osculate_tools::{Cutter, Pose};

fn square(side: f64) -> Plane {
    let i = Interval::new(0.0, side);
    Plane::new(Domain { u: i, v: i })
}

/// The highest standoff seen, and the bound on the highest there is.
fn look(surface: &dyn Surface, sampling: &Sampling, cutter: &Cutter, motions: &[Swept]) -> [f64; 2] {
    let job = Job { cutter, holder: None, motions, samples: &sampling.samples, stock_mm: 0.5, depth_mm: 1.0 };
    let cuts: Vec<Cut> = cut(&job, &|_| ()).expect("a good job");
    let patches: Vec<Option<Patch>> = sampling.patches.iter().copied().map(Some).collect();
    let seen = cuts.iter().map(|c| c.standoff_mm).fold(0.0, f64::max);
    let bound = |enough_mm: f64| {
        let wanted = Wanted { uncut_mm: 0.4, enough_mm, tool_radius_mm: cutter.radius_mm() };
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
    let job =
        Job { cutter: &cutter, holder: None, motions: &motions, samples: &row, stock_mm: 0.5, depth_mm: 1.0 };
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
    let highest = |samples: &[osculate_tools::removal::Sample]| {
        let job =
            Job { cutter: &cutter, holder: None, motions: &motions, samples, stock_mm: 0.5, depth_mm: 1.0 };
        let cuts = cut(&job, &|_| ()).unwrap();
        cuts.iter().map(|c| c.standoff_mm).fold(0.0, f64::max)
    };
    let (inside, with_edge) = (highest(&sampling.samples), highest(&edge));
    assert!((with_edge - left).abs() < 1e-9 && inside < left, "{inside} {with_edge} {left}");
}
