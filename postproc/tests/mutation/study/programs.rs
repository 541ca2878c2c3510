//! Good programs: parts, tools, machines, dialects and feed modes in ten combinations.
//!
//! Passes run out over the sides of a patch of about 8 x 8 mm, between rapids 15 mm off the part.

use osculate_geom::analytic::{Paraboloid, Placed, Placement, Sphere, Torus};
use osculate_geom::{Axis, Domain, Flipped, Interval, Patch, Point3, Side, Surface, Unit3, Uv, Vec3, uv};
use osculate_postproc::{Dialect, FeedMode, Machine, PostOptions, Setup, post};
use osculate_tools::cl::{ClMove, ClPath, Motion};
use osculate_tools::{Contact, Cutter, CutterSpec, FeedLine, Lean, Pose};
use std::f64::consts::FRAC_PI_2;

/// Half the side of a patch, mm.
pub const HALF_MM: f64 = 4.0;
/// Poses of a pass.
const POSES: u32 = 25;
/// Feed of the passes, mm/min.
const FEED: f64 = 800.0;

/// The part of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// A saddle, z = b y^2 - a x^2.
    Saddle,
    /// A cap of a ball.
    Cap,
    /// The bottom of a groove that runs in a circle.
    Groove,
}

impl Part {
    pub const fn name(self) -> &'static str {
        match self {
            Self::Saddle => "saddle",
            Self::Cap => "cap",
            Self::Groove => "groove",
        }
    }

    /// Middle of the patch and half its range.
    pub fn range(self) -> (Uv, [f64; 2]) {
        match self {
            Self::Saddle => (uv(0.0, 0.0), [HALF_MM, HALF_MM]),
            Self::Cap => (uv(0.0, 0.0), [HALF_MM / 30.0, HALF_MM / 30.0]),
            Self::Groove => (uv(0.0, -FRAC_PI_2), [HALF_MM / 60.0, HALF_MM / 25.0]),
        }
    }

    /// The surface over `times` the patch.
    pub fn surface(self, times: f64) -> Box<dyn Surface> {
        let (middle, half) = self.range();
        let around = |m: f64, h: f64| Interval::new(m - times * h, m + times * h);
        let domain = Domain { u: around(middle.u, half[0]), v: around(middle.v, half[1]) };
        match self {
            Self::Saddle => {
                Box::new(Paraboloid::new([-0.006, 0.004], times * HALF_MM).expect("a good paraboloid"))
            }
            Self::Cap => {
                let surface =
                    Patch { surface: Sphere::new(30.0).expect("a ball"), domain, side: Side::Along };
                // Longitude and latitude zero on top.
                let placement = Placement::new(Point3::new(0.0, 0.0, -30.0), Vec3::x_axis(), Some(Vec3::z()));
                Box::new(Placed { surface, placement })
            }
            Self::Groove => {
                let torus = Flipped(Torus::new(60.0, 25.0).expect("a torus"));
                let surface = Patch { surface: torus, domain, side: Side::Along };
                let placement = Placement { origin: Point3::new(-60.0, 0.0, 25.0), ..Placement::identity() };
                Box::new(Placed { surface, placement })
            }
        }
    }
}

/// The tool of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tool {
    Ball,
    Toroidal,
}

/// What a program is made of.
#[derive(Clone, Copy, Debug)]
pub struct Recipe {
    pub machine: &'static str,
    pub dialect: Dialect,
    pub feed: FeedMode,
    pub tool: Tool,
    pub part: Part,
}

/// A good program.
pub struct Good {
    pub recipe: Recipe,
    pub text: String,
    pub setup: Setup,
    pub machine: Machine,
    pub cutter: Cutter,
}

const KV: FeedMode = FeedMode::Kv { fgref_mm: None };

/// All combinations that faults are put into.
pub const RECIPES: [Recipe; 10] = {
    use Dialect::{Fanuc, Heidenhain, LinuxCnc, Sinumerik};
    use FeedMode::{InverseTime, Kf, None, Tcp};
    const fn of(machine: &'static str, dialect: Dialect, feed: FeedMode, tool: Tool, part: Part) -> Recipe {
        Recipe { machine, dialect, feed, tool, part }
    }
    [
        of("trunnion-ac", Sinumerik, Tcp, Tool::Ball, Part::Saddle),
        of("head-ca", Sinumerik, KV, Tool::Toroidal, Part::Cap),
        of("trunnion-bc", Heidenhain, Tcp, Tool::Toroidal, Part::Groove),
        of("trunnion-ac", Heidenhain, KV, Tool::Ball, Part::Cap),
        of("nutated-b-table-c", Fanuc, Tcp, Tool::Ball, Part::Groove),
        of("trunnion-bc", Fanuc, InverseTime, Tool::Toroidal, Part::Saddle),
        of("linuxcnc-xyzac", LinuxCnc, InverseTime, Tool::Toroidal, Part::Saddle),
        of("linuxcnc-xyzbc", LinuxCnc, Kf, Tool::Ball, Part::Cap),
        of("3-axis", Fanuc, None, Tool::Ball, Part::Groove),
        of("head-b-table-c", Sinumerik, Tcp, Tool::Toroidal, Part::Cap),
    ]
};

/// The program of a recipe.
pub fn good(recipe: Recipe) -> Good {
    let (spec, lead_rad, step) = match recipe.tool {
        Tool::Ball => (CutterSpec::Ball { diameter_mm: 6.0, length_mm: 40.0 }, 0.3, 0.7),
        Tool::Toroidal => {
            (CutterSpec::Toroidal { diameter_mm: 10.0, corner_radius_mm: 2.0, length_mm: 40.0 }, 0.15, 1.1)
        }
    };
    let cutter = Cutter::try_from(spec).expect("a good cutter");
    let (middle, half) = recipe.part.range();
    let part = recipe.part.surface(2.0);
    let lean = Lean { lead_rad, tilt_rad: 0.2 };
    let pose = |at: Uv| {
        if recipe.machine == "3-axis" {
            // A ball touches wherever its centre is a radius off.
            let jet = part.jet2(at);
            let normal: Unit3 = jet.normal().expect("regular");
            let r = cutter.radius_mm();
            let centre = jet.point + normal.into_inner() * r;
            return Pose { tip: centre - Vec3::z() * r, axis: Vec3::z_axis() };
        }
        let contact = Contact::new(&*part, at, &cutter, FeedLine::Iso(Axis::U), lean).expect("fits");
        lean.pose(&cutter, &contact.frame, 0.0)
    };
    let mut moves: Vec<ClMove> = Vec::new();
    let rows = (2.0 * HALF_MM / step).ceil() as u32 + 2;
    for i in 0..rows {
        let y = (-HALF_MM - 0.3 * step + step * f64::from(i)).min(HALF_MM + 0.3 * step) / HALF_MM;
        for k in 0..POSES {
            let x = 1.2 * (2.0 * f64::from(k) / f64::from(POSES - 1) - 1.0);
            let pose = pose(uv(middle.u + half[0] * x, middle.v + half[1] * y));
            let lifted = ClMove { pose: pose.retracted(15.0), motion: Motion::Rapid, aloft: false };
            if k == 0 {
                moves.push(lifted);
            }
            moves.push(ClMove { pose, motion: Motion::Feed(FEED), aloft: false });
            if k == POSES - 1 {
                moves.push(lifted);
            }
        }
    }
    let path = ClPath { cutter: Some(spec), holder: Vec::new(), spindle_rpm: Some(6000.0), moves };
    let machine = Machine::built_in(recipe.machine).expect("built in");
    let setup = Setup::at(Vec3::new(0.0, 0.0, 30.0), 40.0);
    let posted =
        post(&path, &machine, &setup, &PostOptions::new(recipe.dialect, recipe.feed)).expect("within reach");
    Good { recipe, text: posted.text, setup, machine, cutter }
}
