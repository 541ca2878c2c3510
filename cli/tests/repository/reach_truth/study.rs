//! The reach of the tools of five jobs at random places of their faces, by `tools::reach` and by brute force.

mod brute;

use brute::{Answer, Body, Brute};
use osculate::part::LoadedFace;
use osculate::{Job, Part, part};
use osculate_geom::{Surface, Unit3};
use osculate_tools::CutterSpec;
use osculate_tools::reach::{
    Bits, Directions, ObstacleKind, ObstaclePoint, Obstacles, Place, Reach, ReachLimits, ReachProblem, Tool,
};
use osculate_tools::removal::{Sample, SamplingError, sample_surface};
use rayon::prelude::*;
use std::error::Error;
use std::fmt;
use std::path::Path;
use std::time::{Duration, Instant};

/// A job among the examples, with the holder that its tool gets where it has none: diameter and length, mm.
pub struct Example {
    pub name: &'static str,
    holder_mm: [f64; 2],
}

/// A flat end, toroidal ends, and a ball; a blade with its other side, one all around, a whole propeller, a hull, a hollow.
pub const EXAMPLES: [Example; 5] = [
    Example { name: "centrifugal-blade", holder_mm: [16.0, 40.0] },
    Example { name: "eee-hpt-rotor2", holder_mm: [16.0, 40.0] },
    Example { name: "propeller", holder_mm: [20.0, 40.0] },
    Example { name: "wigley-hull", holder_mm: [100.0, 120.0] },
    Example { name: "torus-groove", holder_mm: [50.0, 60.0] },
];

/// How much is asked.
#[derive(Clone, Copy)]
pub struct Size {
    pub places: usize,
    /// Obstacle points, about.
    pub points: usize,
    /// Level of the icosphere.
    pub level: u32,
    pub seed: u64,
}

/// What the holder keeps from everything and the cutter from faces that are not next to what it machines, mm.
const CLEARANCE_MM: f64 = 0.5;
/// Faces narrower than the spacing of points are sampled so many times as densely, down to so small a part of it.
const DENSER: f64 = 4.0;
const DENSEST: f64 = 1e-3;
/// Least lean of a flat or toroidal end and greatest lean, degrees.
const LEAN_DEG: [f64; 2] = [1.0, 88.0];

/// SplitMix64.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// Of 0..1.
    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// What came out for a part.
#[derive(Default)]
pub struct Figures {
    pub name: &'static str,
    pub tool: String,
    pub faces: usize,
    pub places: usize,
    pub points: usize,
    /// Points that are none of the part's.
    pub others: usize,
    /// Directions at all places, and those of them that `tools::reach` calls possible.
    pub bits: usize,
    pub set: usize,
    /// Directions that lean too little or too much, and those that the cutter and the holder stand in the way of.
    pub leaning: usize,
    pub blocked: [usize; 2],
    /// Directions whose spare or lean is within the slack by brute force, and those of them with another bit.
    pub close: usize,
    pub within: usize,
    /// Bits that differ beyond the slack, in words.
    pub wrong: Vec<String>,
    pub reach_time: Duration,
    pub brute_time: Duration,
}

impl fmt::Display for Figures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, tool, faces, places, points, others, bits, set, leaning, close, within, .. } = self;
        writeln!(
            f,
            "{name}: {tool}; {faces} faces, {points} points ({others} to keep off), {places} places, {bits} bits"
        )?;
        writeln!(
            f,
            "  {set} set; {leaning} lean out of the limits, {} blocked by the cutter, {} by the holder",
            self.blocked[0], self.blocked[1]
        )?;
        writeln!(
            f,
            "  {} differ: {within} of {close} within the slack, {} beyond it; reach {:.3} s, brute force {:.1} s",
            within + self.wrong.len(),
            self.wrong.len(),
            self.reach_time.as_secs_f64(),
            self.brute_time.as_secs_f64()
        )?;
        self.wrong.iter().take(10).try_for_each(|line| writeln!(f, "  WRONG: {line}"))
    }
}

/// The job of an example, its tool with a holder, all faces that are not to machine in the tool's way.
fn job_of(example: &Example) -> Result<Job, Box<dyn Error>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples").join(example.name).join("job.toml");
    let mut text = std::fs::read_to_string(&path)?.replace("may_hit = \"all\"", "");
    if !text.contains("[tool.holder]") {
        let [diameter_mm, length_mm] = example.holder_mm;
        text += &format!("\n[tool.holder]\ndiameter_mm = {diameter_mm}\nlength_mm = {length_mm}\n");
    }
    Ok(Job::from_toml(&text, &path)?)
}

/// The bodies of a job's tool, from its numbers alone.
fn bodies(job: &Job) -> Result<Vec<Body>, Box<dyn Error>> {
    let (diameter_mm, corner_mm, length_mm) = match job.cutter_spec() {
        CutterSpec::Ball { diameter_mm, length_mm } => (diameter_mm, 0.5 * diameter_mm, length_mm),
        CutterSpec::Flat { diameter_mm, length_mm } | CutterSpec::Cylindrical { diameter_mm, length_mm } => {
            (diameter_mm, 0.0, length_mm)
        }
        CutterSpec::Toroidal { diameter_mm, corner_radius_mm, length_mm } => {
            (diameter_mm, corner_radius_mm, length_mm)
        }
        other => return Err(format!("no brute force for {other:?}").into()),
    };
    let cutter = Body {
        radius_mm: 0.5 * diameter_mm,
        corner_mm,
        from_mm: 0.0,
        to_mm: length_mm,
        part_mm: -job.tolerance().gouge_mm,
        other_mm: CLEARANCE_MM,
    };
    let [holder] = job.tool().holder_sections() else {
        return Err("a holder of one section is needed".into());
    };
    let holder = Body {
        radius_mm: 0.5 * holder.diameter_mm,
        corner_mm: 0.0,
        from_mm: length_mm,
        to_mm: length_mm + holder.length_mm,
        part_mm: CLEARANCE_MM,
        other_mm: CLEARANCE_MM,
    };
    Ok(vec![cutter, holder])
}

/// Points of a face, however narrow it is.
fn sampled(face: &LoadedFace, k: u32, spacing_mm: f64, most: usize) -> Result<Vec<Sample>, SamplingError> {
    let mut apart = spacing_mm;
    loop {
        match sample_surface(&*face.surface, k, apart, most) {
            Err(SamplingError::Nothing { .. }) if apart > DENSEST * spacing_mm => apart /= DENSER,
            found => return found.map(|f| f.samples),
        }
    }
}

/// Points of all faces. Those of other faces that are within the cutter's radius of what is machined are points of the part, which
/// the cutter may go into like those; the others it keeps off.
fn points(faces: &Part, radius_mm: f64, size: Size) -> Result<Vec<ObstaclePoint>, SamplingError> {
    let all: Vec<&LoadedFace> = faces.faces.iter().chain(&faces.check).collect();
    let whole: f64 = all.iter().map(|f| part::area(f)).sum();
    let apart = (whole / size.points as f64).sqrt();
    let found: Result<Vec<_>, _> =
        all.par_iter().zip(0..all.len() as u32).map(|(f, k)| sampled(f, k, apart, size.points)).collect();
    let (own, other): (Vec<Sample>, Vec<Sample>) =
        found?.into_iter().flatten().partition(|s| (s.face as usize) < faces.faces.len());
    let point = |s: &Sample, kind| ObstaclePoint { point: s.point, owner: s.face, kind };
    let other = other.par_iter().map(|s| {
        let is_next = own.iter().any(|o| (o.point - s.point).norm_squared() < radius_mm * radius_mm);
        point(s, if is_next { ObstacleKind::Part } else { ObstacleKind::Surroundings })
    });
    let own = own.par_iter().map(|s| point(s, ObstacleKind::Part));
    Ok(own.chain(other).collect())
}

/// Places anywhere on the faces to machine, larger faces more often.
fn places(faces: &Part, size: Size) -> Vec<Place> {
    let areas: Vec<f64> = faces.faces.iter().map(part::area).collect();
    let whole: f64 = areas.iter().sum();
    let mut random = Random(size.seed);
    let mut found = Vec::with_capacity(size.places);
    while found.len() < size.places {
        let mut rest = random.unit() * whole;
        let k = areas.iter().position(|area| {
            rest -= area;
            rest < 0.0
        });
        let surface = &faces.faces[k.unwrap_or(0)].surface;
        let at = surface.domain().at(random.unit(), random.unit());
        let jet = surface.jet2(at);
        if let (true, Ok(normal)) = (surface.contains(at), jet.normal()) {
            found.push(Place { point: jet.point, normal });
        }
    }
    found
}

/// Counts what a place has, and compares its bits.
fn compare(
    found: &mut Figures,
    brute: &Brute,
    place: &Place,
    all: &[Unit3],
    (bits, answers): (&Bits, &[Answer]),
) {
    found.bits += all.len();
    found.set += bits.count();
    for (k, answer) in answers.iter().enumerate() {
        let is_set = bits.contains(k);
        let is_same = match *answer {
            Answer::Close(own) => {
                found.close += 1;
                found.within += usize::from(is_set != own);
                true
            }
            Answer::Free => is_set,
            Answer::Leaning => {
                found.leaning += 1;
                !is_set
            }
            Answer::Blocked(body) => {
                found.blocked[body] += 1;
                !is_set
            }
        };
        if !is_same {
            let spare = brute.least_mm(place, &all[k]);
            found.wrong.push(format!(
                "place {:?} with normal {:?}, direction {k}: bit {is_set}, but {answer:?}, spare {spare:e} mm",
                place.point.coords.as_slice(),
                place.normal.as_slice()
            ));
        }
    }
}

/// Both answers for one part.
pub fn study(example: &Example, size: Size) -> Result<Figures, Box<dyn Error>> {
    let job = job_of(example)?;
    let faces = Part::of(&job)?;
    let cutter = job.cutter();
    let points = points(&faces, cutter.radius_mm(), size)?;
    let obstacles = Obstacles::new(points.iter().copied())?;
    let [least, most] = LEAN_DEG.map(f64::to_radians);
    let lean_rad = [if cutter.is_ball() { 0.0 } else { least }, most];
    let directions = Directions::icosphere(size.level)?;
    let tool = Tool::new(cutter, job.holder());
    let reach = Reach::new(ReachProblem {
        tool: &tool,
        limits: ReachLimits {
            gouge_mm: job.tolerance().gouge_mm,
            clearance_mm: CLEARANCE_MM,
            stock_mm: CLEARANCE_MM,
            least_lean_rad: lean_rad[0],
            most_lean_rad: lean_rad[1],
        },
        obstacles: &obstacles,
        directions: &directions,
        allowed: None,
    })?;
    let places = places(&faces, size);
    let start = Instant::now();
    let bits = reach.map(&places);
    let reach_time = start.elapsed();
    let brute = Brute { bodies: bodies(&job)?, lean_rad, points };
    let start = Instant::now();
    let answers: Vec<Vec<Answer>> =
        places.par_iter().map(|place| brute.answers(place, directions.all())).collect();
    let mut found = Figures {
        name: example.name,
        tool: job.tool_words(),
        faces: faces.faces.len() + faces.check.len(),
        places: places.len(),
        points: brute.points.len(),
        others: brute.points.iter().filter(|p| p.kind == ObstacleKind::Surroundings).count(),
        reach_time,
        brute_time: start.elapsed(),
        ..Figures::default()
    };
    for (place, both) in places.iter().zip(bits.iter().zip(&answers)) {
        compare(&mut found, &brute, place, directions.all(), (both.0, both.1));
    }
    Ok(found)
}
