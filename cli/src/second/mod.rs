//! A second opinion on an NC program: frozen poses of the tool against points of the whole part.
//!
//! The verification follows exact motions through the material. Here nothing of it is used: the program is read by a reader, the
//! machine's joints are followed by a chain and the tool is measured by formulas that stand in this folder alone. What is
//! asked is simple: the tool is frozen at poses along the path, and of each point of the part it is seen how deep it is in the
//! tool, and how low over it the tool has come. Whatever is not known for certain, a word of the program or a key of the machine, is
//! said: then there is no opinion.
//!
//! - `words`, `iso`, `heidenhain`, `state`, `reader`: from the text to straight `moves`;
//! - `setup`, `kinematics`: where the tool is then, in the part's frame;
//! - `tool`, `points`, `search`: how deep and how low;
//! - `compare`: beside the figures of the verification.
//!
//! ```
//! use osculate::second::{Options, PartPoint, Setup, Shape, Tool, look};
//! let machine = r#"
//!     format = 1
//!     name = "3-axis"
//!     [[joint]]
//!     kind = "linear"
//!     letter = "X"
//!     side = "head"
//!     direction = [1, 0, 0]
//!     [[joint]]
//!     kind = "linear"
//!     letter = "Y"
//!     side = "head"
//!     direction = [0, 1, 0]
//!     [[joint]]
//!     kind = "linear"
//!     letter = "Z"
//!     side = "head"
//!     direction = [0, 0, 1]
//! "#;
//! let program = "G90 G21\nG53 G0 Z0\nT1 M6\nG43 H1\nG0 X-5 Y0\nZ-0.01\nG1 X5 F500\nM30\n";
//! let tool =
//!     Tool { shape: Shape::Ball, diameter_mm: 6.0, length_mm: 40.0, flute_mm: None, holder: Vec::new() };
//! let setup = Setup { part_zero_mm: [0.0; 3], turn: [0.0, 0.0, 0.0, 1.0], gauge_length_mm: 40.0 };
//! let points = [PartPoint { face: 1, machined: true, at: [0.3, 0.0, 0.0], normal: [0.0, 0.0, 1.0] }];
//! let opinion = look(program, "linuxcnc", machine, Some(setup), &tool, &points, &Options::new(0.5, 0.001))?;
//! assert!((opinion.gouge_mm - 0.01).abs() <= opinion.slack_mm);
//! # Ok::<(), osculate::second::NoOpinion>(())
//! ```

mod compare;
mod heidenhain;
mod iso;
mod kinematics;
mod moves;
mod opinion;
mod points;
mod reader;
mod refusal;
mod search;
mod setup;
mod state;
mod tool;
mod vector;
mod words;

use std::time::Instant;

pub use compare::{Accepted, Agreement, Figures, Which, compare};
pub use opinion::Opinion;
pub use points::PartPoint;
pub use refusal::{NoOpinion, Unread};
pub use setup::Setup;
pub use tool::{HolderPart, Shape, Tool};

use kinematics::Chain;
use moves::{Dialect, Shop};
use points::Cloud;
use search::{Wanted, World, search};
use setup::Stand;
use tool::Bodies;

/// How closely to look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// What stands over faces to machine before the program, at the least: nothing higher is looked at.
    pub stock_mm: f64,
    /// What the figures may be off by at the points, where the number of poses allows.
    pub slack_mm: f64,
    /// Poses at most.
    pub most_poses: usize,
}

/// Frozen poses at most where nothing else is said: minutes at the very worst.
const MOST_POSES: usize = 20_000_000;

impl Options {
    /// A stock and a slack; the slack is usually a tenth of the scallop tolerance.
    #[must_use]
    pub fn new(stock_mm: f64, slack_mm: f64) -> Self {
        Self { stock_mm, slack_mm, most_poses: MOST_POSES }
    }
}

/// Looks at a program: what it does to points of the part.
///
/// `setup` counts where it is given; otherwise what the program's head says it was posted for.
/// Lengths are mm; points are in the part's frame, their normals out of the material. A point in the tool is deep by a positive
/// number.
///
/// # Errors
/// Where anything is not known for certain: no opinion is given then.
pub fn look(
    program: &str,
    dialect: &str,
    machine_toml: &str,
    setup: Option<Setup>,
    tool: &Tool,
    points: &[PartPoint],
    options: &Options,
) -> Result<Opinion, NoOpinion> {
    let start = Instant::now();
    let fine = |x: f64| x.is_finite() && x > 0.0;
    if !(fine(options.stock_mm) && fine(options.slack_mm)) {
        return Err(NoOpinion::Points { what: "stock and slack have to be above zero" });
    }
    let bodies = Bodies::of(tool)?;
    let shop = shop(program, machine_toml, setup)?;
    let path = reader::read(program, Dialect::of(dialect)?, &shop)?;
    let cloud = Cloud::of(points)?;
    let Options { stock_mm, slack_mm, most_poses } = *options;
    let wanted = Wanted { stock_mm, slack_mm, most_poses };
    let found = search(&World { moves: &path.moves, shop: &shop, bodies: &bodies, cloud: &cloud, wanted });
    let mut slack = slack_mm;
    for worst in [&found.gouge, &found.rapid, &found.holder] {
        slack = slack.max(worst.open_mm - worst.mm.max(0.0));
    }
    let (mut left, mut bound, mut uncut) = (None, 0.0f64, 0);
    for (k, p) in cloud.points.iter().enumerate().filter(|(_, p)| p.machined) {
        let height = found.heights[k];
        uncut += usize::from(height >= stock_mm);
        if left.is_none_or(|(most, _)| height > most) {
            left = Some((height, p));
        }
        // Stretches that were dropped came no lower than the lowest less the slack.
        bound = bound.max(found.bounds[k].min(height - slack_mm));
    }
    if let Some((most, _)) = left {
        slack = slack.max(most - bound);
    }
    let near = |d: &search::Deepest| if d.mm.is_finite() { d.mm } else { 0.0 };
    let seen = |d: &search::Deepest| d.mm.is_finite().then_some(d.line);
    let deepest = found.gouge.mm.is_finite().then(|| &cloud.points[found.gouge.point]);
    let aside = cloud.apart_mm * 0.5f64.sqrt();
    let corner = bodies.corner_mm;
    Ok(Opinion {
        gouge_mm: deepest.map_or(0.0, |_| found.gouge.mm),
        on_face: deepest.map(|p| p.face),
        at_mm: deepest.map(|p| p.at),
        line: seen(&found.gouge),
        rapid_mm: near(&found.rapid),
        rapid_line: seen(&found.rapid),
        holder_mm: near(&found.holder),
        holder_line: seen(&found.holder),
        left_mm: left.map_or(0.0, |l| l.0),
        left_face: left.map(|l| l.1.face),
        left_at_mm: left.map(|l| l.1.at),
        uncut,
        poses: found.poses,
        points: points.len(),
        poses_apart_mm: if found.closest_mm.is_finite() { found.closest_mm } else { 0.0 },
        points_apart_mm: cloud.apart_mm,
        slack_mm: slack,
        // A dig of a corner of radius r is shallower by r - sqrt(r^2 - d^2) at the distance d from its deepest place.
        gouge_between_mm: if aside < corner {
            corner - (corner * corner - aside * aside).sqrt()
        } else {
            aside
        },
        corner_radius_mm: corner,
        unseen_rapids: path.unseen_rapids,
        seconds: start.elapsed().as_secs_f64(),
    })
}

fn shop(program: &str, machine_toml: &str, setup: Option<Setup>) -> Result<Shop, NoOpinion> {
    let setup = match setup {
        Some(setup) => setup,
        None => Setup::of_program(program)?.ok_or_else(|| NoOpinion::Setup {
            what: "the program's head does not say where the part stands, and nothing else does".into(),
        })?,
    };
    Ok(Shop { chain: Chain::of(machine_toml)?, stand: Stand::of(&setup)? })
}

/// Where a tool stands: its tip, mm, and the unit vector from there to the spindle, in the part's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Station {
    /// The program's line, from 1.
    pub line: usize,
    /// Reached by a rapid.
    pub rapid: bool,
    /// The tip.
    pub tip_mm: [f64; 3],
    /// The axis.
    pub axis: [f64; 3],
}

/// The places to which the moves of a program lead, and before each row of moves that follow each other where it begins.
///
/// # Errors
/// As [`look`].
pub fn stations(
    program: &str,
    dialect: &str,
    machine_toml: &str,
    setup: Option<Setup>,
) -> Result<Vec<Station>, NoOpinion> {
    let shop = shop(program, machine_toml, setup)?;
    let path = reader::read(program, Dialect::of(dialect)?, &shop)?;
    let mut out: Vec<Station> = Vec::with_capacity(path.moves.len() + 1);
    let mut before = None;
    for m in &path.moves {
        let station = |t: f64| {
            let pose = m.pose(&shop, t);
            Station { line: m.line, rapid: m.rapid || t == 0.0, tip_mm: pose.tip, axis: pose.axis }
        };
        if before != Some(m.from) {
            out.push(station(0.0));
        }
        out.push(station(1.0));
        before = Some(m.to);
    }
    Ok(out)
}

/// The tool in the table's frame for joints of a machine in its chain's order, mm and deg: tip and axis.
///
/// # Errors
/// Where the machine's description is not known for certain.
pub fn forward(
    machine_toml: &str,
    linear_mm: [f64; 3],
    rotary_deg: [f64; 2],
    gauge_length_mm: f64,
) -> Result<[[f64; 3]; 2], NoOpinion> {
    let pose = Chain::of(machine_toml)?.at(&linear_mm, &rotary_deg.map(f64::to_radians), gauge_length_mm).0;
    Ok([pose.tip, pose.axis])
}
