//! A surface of one's own, without a job: its exact strips, a path that they space, and the verdict on that path.
//!
//! The surface is a wave, `z = a sin(k x)`, straight along y. A ball of radius R that follows the wave sweeps a pipe, whose cut
//! across the feed is a circle over a straight line: the strip is `2 sqrt(h (2 R - h))` wide for a scallop h, everywhere.
//!
//!     cargo run -p osculate --example own_surface
#![allow(clippy::print_stdout)]

use osculate_geom::{Axis, Domain, Interval, Jet2, Series, Side, Surface, Taylor, Uv, uv};
use osculate_tools::removal::{
    Answer, Goal, GoalFace, GoalLimits, GoalStock, GoalTool, Program, Swept, prove,
};
use osculate_tools::{Contact, ContactError, Cutter, CutterSpec, FeedLine, Lean, Pose, strip};
use std::error::Error;

/// Amplitude, mm, and wave number, 1/mm: crests 40 mm apart, hollows of radius 20 mm and more.
const WAVE: [f64; 2] = [2.0, std::f64::consts::TAU / 40.0];

struct Wave;

impl Surface for Wave {
    fn domain(&self) -> Domain {
        Domain { u: Interval::new(0.0, 40.0), v: Interval::new(0.0, 10.0) }
    }
    fn jet2(&self, at: Uv) -> Jet2 {
        self.taylor(at, 2).jet2()
    }
    fn taylor(&self, at: Uv, order: usize) -> Taylor {
        let [x, y] = [(Axis::U, at.u), (Axis::V, at.v)].map(|(axis, t)| Series::variable(axis, t, order));
        let z = (x * WAVE[1]).sin_cos().0 * WAVE[0];
        Taylor { uv: at, side: Side::Along, coordinates: [x, y, z] }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let (radius_mm, scallop_mm) = (4.0, 0.05_f64);
    let ball = Cutter::try_from(CutterSpec::Ball { diameter_mm: 2.0 * radius_mm, length_mm: 40.0 })?;
    let contact = |at: Uv| Contact::new(&Wave, at, &ball, FeedLine::Iso(Axis::U), Lean::default());
    let strip = strip::exact(&contact(uv(13.0, 5.0))?, scallop_mm)?;
    let closed_mm = 2.0 * (scallop_mm * (2.0 * radius_mm - scallop_mm)).sqrt();
    println!("strip {:.9} mm, closed form {closed_mm:.9} mm", strip.width_mm);
    assert!((strip.width_mm - closed_mm).abs() < 1e-8);

    // Passes at nine tenths of the strip or less, so that chords have room below the tolerance; 160 chords each, to and fro.
    let path = |passes: usize| -> Result<Vec<Swept>, ContactError> {
        let mut poses: Vec<Pose> = Vec::new();
        for (pass, chord) in (0..161 * passes).map(|k| (k / 161, k % 161)) {
            let u = 0.25 * if pass.is_multiple_of(2) { chord } else { 160 - chord } as f64;
            poses.push(contact(uv(u, 10.0 * pass as f64 / (passes - 1) as f64))?.pose());
        }
        let pairs = poses.windows(2).zip(1..);
        Ok(pairs.map(|(p, block)| Swept { from: p[0], to: p[1], rapid: false, block }).collect())
    };
    let (faces, tools) = (vec![GoalFace::new("wave", &Wave)], vec![GoalTool::new(&ball)]);
    let stock = GoalStock::Assumed { layer_mm: 1.0 };
    let mut goal = Goal::new(faces, tools, stock, GoalLimits::new(scallop_mm, 0.5 * scallop_mm));
    goal.looks.max_samples = 200_000;
    let enough = 1 + (10.0 / (0.9 * strip.width_mm)).ceil() as usize;
    for (passes, answer) in [(enough, Answer::Held), (enough - 2, Answer::NotHeld)] {
        let motions = path(passes)?;
        let verdict = prove(&goal, Program { motions: &motions, times_min: &[], changes: &[] }, &|_| ())?;
        println!("{passes} passes\n{verdict}");
        assert_eq!(verdict.answer(), answer);
    }
    Ok(())
}
