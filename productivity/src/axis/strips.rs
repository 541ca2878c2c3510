//! Strips next to the normal, by the way that the axis leans and how much further than it must: where the strip of a flat or toroidal end
//! is widest the closed forms know least.
//!
//! On a hollow place the end touches a second time at its heel; with the least lean the strip is widest there, and a quarter of a degree
//! more takes a third of it. So strips are asked on a chart of the place, and axes between those asked are interpolated.

use super::lattice::Node;
use super::rim::{Rim, Spot};
use osculate_geom::{Darboux, Surface};
use osculate_tools::strip::{Chart, ChartError, Within};
use osculate_tools::{Cutter, Lean};

/// Leans beyond the least that are asked, rad.
const BEYOND_RAD: [f64; 9] = [0.0, 0.001, 0.002, 0.004, 0.008, 0.016, 0.032, 0.064, 0.128];
/// Radius of charts, in the cutter's radius, and misfit accepted, of the scallop.
const REACH: f64 = 1.2;
const MISFIT: f64 = 0.05;

/// What is asked of strips.
#[derive(Clone, Copy)]
pub(super) struct Wanted<'a> {
    pub cutter: &'a Cutter,
    pub scallop_mm: f64,
    /// Strips count as no wider, mm.
    pub widest_mm: f64,
}

/// Widths of strips at a place for one direction of feed.
pub(super) struct Strips {
    /// Logarithms of widths in mm: for each way those of all leans.
    log_width: Vec<f64>,
    widest_mm: f64,
}

impl Strips {
    /// Asks the strips of a place for each of some frames of feed; none where the place has no chart.
    pub fn of(surface: &dyn Surface, node: &Node, rim: &Rim, frames: &[Option<&Darboux>], wanted: Wanted<'_>) -> Vec<Option<Self>> {
        let none = || frames.iter().map(|_| None).collect();
        if node.rough || rim.is_empty() {
            return none();
        }
        let (radius, h) = (wanted.cutter.radius_mm(), wanted.scallop_mm);
        let Ok(chart) = Chart::new(surface, node.at, super::dump::knob("K_REACH", REACH) * radius, MISFIT * h) else { return none() };
        let [x, y] = [0.0, std::f64::consts::FRAC_PI_2].map(|angle| chart.frame(angle).tangent);
        let one = |frame: &Darboux| {
            let angle = frame.tangent.dot(&y).atan2(frame.tangent.dot(&x));
            let feed = chart.frame(angle);
            // The axis is clear of the part by the rim: what it does next to the contact is not asked again.
            let within = Within { scallop_mm: h, gouge_mm: f64::INFINITY };
            let width = |way: usize, beyond: f64| {
                let least = rim.least_rad(way);
                if !least.is_finite() {
                    return f64::NAN;
                }
                let lean = Lean::of(&rim.axis(way, least + beyond), &feed);
                match chart.strip(wanted.cutter, angle, lean, within) {
                    Ok(strip) => strip.width_mm.clamp(1e-3 * h, wanted.widest_mm),
                    Err(ChartError::Beyond { .. }) => wanted.widest_mm,
                    Err(_) => 1e-3 * h,
                }
                .ln()
            };
            let log_width: Vec<f64> =
                (0..Rim::ways()).flat_map(|way| BEYOND_RAD.map(|beyond| width(way, beyond))).collect();
            // What the field is off by between nodes must not take much of a strip: of all leans up to so much more the narrowest counts.
            let off = super::dump::knob("K_OFF", 0.002);
            let log_width: Vec<f64> = (0..log_width.len()).map(|k| {
                let (way, j) = (k / BEYOND_RAD.len(), k % BEYOND_RAD.len());
                let to = BEYOND_RAD[j] + off;
                (j..BEYOND_RAD.len()).filter(|i| *i == j || BEYOND_RAD[*i] <= to + 1e-9).map(|i| log_width[way * BEYOND_RAD.len() + i]).fold(f64::INFINITY, f64::min)
            }).map(|w| if w.is_finite() { w } else { f64::NAN }).collect();
            let widest_mm = log_width.iter().copied().filter(|w| !w.is_nan()).fold(f64::NEG_INFINITY, f64::max).exp();
            Self { log_width, widest_mm }
        };
        frames.iter().map(|f| f.map(one)).collect()
    }

    /// The widest of all, mm.
    pub const fn widest_mm(&self) -> f64 {
        self.widest_mm
    }

    /// The width with an axis, mm; None further off than was asked.
    pub fn width_mm(&self, rim: &Rim, spot: &Spot) -> Option<f64> {
        let of = |way: usize| {
            let beyond = spot.lean_rad - rim.least_rad(way);
            let row = &self.log_width[way * BEYOND_RAD.len()..(way + 1) * BEYOND_RAD.len()];
            let k = BEYOND_RAD.partition_point(|b| *b <= beyond).max(1) - 1;
            let next = BEYOND_RAD.get(k + 1)?;
            let f = ((beyond - BEYOND_RAD[k]) / (next - BEYOND_RAD[k])).max(0.0);
            let log = row[k] + (row[k + 1] - row[k]) * f;
            (!log.is_nan()).then_some(log)
        };
        let [a, b] = spot.ways.map(of);
        let log = match (a, b) {
            (Some(a), Some(b)) => a + (b - a) * spot.share,
            (Some(one), None) | (None, Some(one)) => one,
            (None, None) => return None,
        };
        Some(log.exp())
    }
}
