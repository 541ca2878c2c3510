//! Lines over faces whose curvature is noise: the search ends in work that goes with the chart, however much noise there is.
#![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

use osculate_geom::{Axis, Jet2, Jet3, Point3, Surface, Taylor, Uv, forward_surface};
use osculate_surfaces::lines::{
    Chart, Course, Cover, CoverEnd, FieldSample, LineTolerance, ScalarField, TraceStops, cover,
    critical_points,
};
use osculate_surfaces::{Net, NurbsSurface};
use std::sync::atomic::{AtomicUsize, Ordering};

/// A surface that counts how often its derivatives are asked for.
struct Counted {
    surface: NurbsSurface,
    asked: AtomicUsize,
}

impl Counted {
    fn count(&self) {
        self.asked.fetch_add(1, Ordering::Relaxed);
    }
}

impl Surface for Counted {
    forward_surface!(trims | s | s.surface);
    forward_surface!(point | s | s.surface);
    fn jet2(&self, uv: Uv) -> Jet2 {
        self.count();
        self.surface.jet2(uv)
    }
    fn jet3(&self, uv: Uv) -> Jet3 {
        self.count();
        self.surface.jet3(uv)
    }
    fn taylor(&self, uv: Uv, order: usize) -> Taylor {
        self.count();
        self.surface.taylor(uv, order)
    }
}

/// A bicubic sheet over a square, a millimetre between its poles, whose heights are random.
fn rough(poles: usize) -> Counted {
    let mut seed = 7_u64;
    let mut next = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1_u64 << 53) as f64
    };
    let points = (0..poles * poles)
        .map(|k| Point3::new((k / poles) as f64, (k % poles) as f64, 0.3 * next()))
        .collect();
    let inner = (1..poles - 3).map(|k| k as f64);
    let knots: Vec<f64> = [0.0; 4].into_iter().chain(inner).chain([(poles - 3) as f64; 4]).collect();
    let net = Net { count: [poles; 2], points, weights: None };
    let surface = NurbsSurface::new([3, 3], [knots.clone(), knots], net).unwrap();
    Counted { surface, asked: AtomicUsize::new(0) }
}

/// Every asymptotic line ends where the sheet turns convex, within a pole or two, and is shorter than the spacing: after some hundreds of such no
/// further ones are tried.
#[test]
fn stubs_of_lines_are_not_tried_all_over_a_face() {
    let sheet = rough(70);
    let chart =
        Chart::new(&sheet, LineTolerance { position_mm: 1e-5, chord_mm: 1e-2, cell_mm: 1.0 }).unwrap();
    let how = Cover {
        spacing_mm: 8.0,
        ends_early: true,
        stops: TraceStops::default(),
        seeds: Vec::new(),
        most_lines: 400,
    };
    sheet.asked.store(0, Ordering::Relaxed);
    let lines = cover(&chart, Course::Asymptotic { left: true }, &how);
    let asked = sheet.asked.load(Ordering::Relaxed);
    println!("{} lines, {asked} places asked", lines.lines.len());
    assert_eq!(lines.end, CoverEnd::Stubs, "the end of the search is told");
    assert!(asked < 1_000_000, "{asked}");
}

/// A field of which nothing is smooth, that counts how often it is asked.
struct Noise(AtomicUsize);

impl ScalarField for Noise {
    fn sample(&self, _: &dyn Surface, at: Uv) -> Option<FieldSample> {
        self.0.fetch_add(1, Ordering::Relaxed);
        let of = |k: f64| ((at.u * 12.9898 + at.v * 78.233 + k) * 43_758.545_3).sin();
        Some(FieldSample { value: of(0.0), gradient: Some([of(1.0), of(2.0)]), sense: None })
    }
}

/// Zeros of the gradient in every cell: 10,000 cells are cut into some 20 pieces each, asked at nine places and where Newton's steps lead, which
/// is 640 places a cell; while pieces went on to be cut as others were taken from the queue it was 2400.
#[test]
fn cells_full_of_zeros_are_bounded_together() {
    let sheet = rough(8);
    let chart = Chart::new(&sheet, LineTolerance { cell_mm: 0.07, ..LineTolerance::for_size(7.0) }).unwrap();
    let cells = [Axis::U, Axis::V].map(|a| chart.borders(a).len() - 1).iter().product::<usize>();
    let noise = Noise(AtomicUsize::new(0));
    let found = critical_points(&chart, &noise);
    let asked = noise.0.into_inner();
    assert!(cells >= 10_000 && !found.lines.is_empty(), "{cells}");
    assert!(asked < 1000 * cells, "{asked} places of {cells} cells");
    assert!(
        found.coarse_cells > cells / 2,
        "{} of {cells} cells are told as searched less finely",
        found.coarse_cells
    );
}
