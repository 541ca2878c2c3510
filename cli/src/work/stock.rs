//! The `[stock]` and `[fixture]` tables: raw material and what holds the part.

use crate::failure::{Failure, read};
use crate::job::{Blank as Raw, Job, Source};
use crate::part::{self, LeftMaterial, Part};
use crate::triangles::triangles;
use osculate_geom::convex::Convex;
use osculate_geom::{Box3, Diagnostic, Point3, Unit3, any_perpendicular};
use osculate_surfaces::tessellate;
use osculate_tools::removal::stock::{Blank, Resolution, Stock};
use osculate_tools::removal::{Body, GoalStock, Sample, StockFound, sample_triangles};
use serde::Serialize;
use std::path::Path;
use std::sync::Arc;

/// Cells along the longest side of the stock where the job gives none.
const DEFAULT_CELLS: f64 = 256.0;
/// Cubes along the longest side of a saved stock, where bodies of a machine are held against it.
const SEEN_CUBES: usize = 128;
/// Blocks listed by what they took.
const LISTED: usize = 10;

/// The `stock` object of `verify --json`.
#[derive(Debug, Serialize, Clone)]
#[non_exhaustive]
pub struct StockSummary {
    /// Sides of cells.
    pub cell_mm: f64,
    /// Rays along x, y and z.
    pub rays: usize,
    /// Volume before.
    pub volume_mm3: f64,
    /// What feed moves of the cutter took.
    pub removed_mm3: f64,
    /// What is left.
    pub left_mm3: f64,
    /// Range of what is left over the three directions of rays: how good it is.
    pub spread_mm3: f64,
    /// The blocks that took most.
    pub most: Vec<StockBlock>,
    /// Everything that met material and is not to.
    pub collisions: Vec<StockCollision>,
    /// Every block that took something, in the order of the program; too many for the answer.
    #[serde(skip)]
    pub blocks: Vec<StockBlock>,
}

impl StockSummary {
    /// The blocks as comma-separated lines under a heading.
    pub fn csv(&self) -> String {
        let mut out = String::from("block,volume_mm3,section_mm2,engaged_deg,height_mm\n");
        for b in &self.blocks {
            let StockBlock { block, volume_mm3, section_mm2, engaged_deg, height_mm } = b;
            out += &format!("{block},{volume_mm3:.6},{section_mm2:.6},{engaged_deg:.2},{height_mm:.4}\n");
        }
        out
    }
}

/// What one block took.
#[derive(Debug, Serialize, Clone)]
#[non_exhaustive]
pub struct StockBlock {
    /// NC line or CL move.
    pub block: u32,
    /// Volume.
    pub volume_mm3: f64,
    /// Mean section of the chip.
    pub section_mm2: f64,
    /// Engaged angle around the axis.
    pub engaged_deg: f64,
    /// Highest engaged place above the tip.
    pub height_mm: f64,
}

/// Something that ran into material.
#[derive(Debug, Serialize, Clone)]
#[non_exhaustive]
pub struct StockCollision {
    /// `cutter` (in rapid), `shank` or `holder`.
    pub body: &'static str,
    /// Whether in rapid.
    pub rapid: bool,
    /// NC line or CL move.
    pub block: u32,
    /// Longest way through material along a ray.
    pub deepest_mm: f64,
    /// Volume.
    pub volume_mm3: f64,
    /// Where, part coordinates.
    pub at_mm: [f64; 3],
    /// Of a list of operations, the one that did it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub operation: Option<String>,
    /// With which tool.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tool_number: Option<u32>,
    /// The motion of the whole program, by its index.
    #[serde(skip)]
    pub motion: usize,
}

impl StockCollision {
    /// Of a list of operations, the one that did it with its tool.
    pub fn made_by(&self) -> String {
        match (&self.operation, self.tool_number) {
            (Some(name), Some(n)) => format!("{name} with T{n}"),
            (Some(name), None) => name.clone(),
            (None, _) => String::new(),
        }
    }
}

/// What a saved stock says that it is of: the part by its fingerprint, and by the name of its file for people.
pub fn of_part(job: &Job, faces: &Part) -> String {
    let name = match job.part().source() {
        Source::File { path, .. } => path.file_name().map(|n| n.to_string_lossy().into_owned()),
        Source::Builtin(_) | Source::Ruled(_) => None,
    };
    format!("part {} {}", faces.part.fingerprint(), name.unwrap_or_else(|| "built in".to_owned()))
}

/// A stock that was saved.
///
/// # Errors
/// Where the file is none, or is of another part.
fn saved(path: &Path, job: &Job, faces: &Part) -> Result<Stock, Failure> {
    let again = "copy it again from where it was planned, or plan that job again: stock-N.stock is what its operation N left";
    let (stock, of) = Stock::read(&read(path)?).map_err(|e| Failure::file(path, format!("{e}; {again}")))?;
    let own = of_part(job, faces);
    let print = |text: &str| text.split(' ').nth(1).map(ToOwned::to_owned);
    if print(&of) != print(&own) {
        let name = |text: &str| text.splitn(3, ' ').nth(2).unwrap_or_default().to_owned();
        let what = format!(
            "file = \"{}\" is what was left of another part ({}; that of this job is {}): where its shape is meant all the same name its mesh, \
             the .stl beside it",
            path.display(),
            name(&of),
            name(&own)
        );
        return Err(job.refuse("stock", "file", what));
    }
    Ok(stock)
}

/// Places on the fixtures, as faces that carry no material, numbered after those of the part.
pub fn fixtures(job: &Job, faces: &Part) -> Result<Vec<Sample>, Failure> {
    let Some(table) = job.fixture() else { return Ok(Vec::new()) };
    let face = (faces.faces.len() + faces.check.len()) as u32;
    let mut out = Vec::new();
    for (k, file) in table.files.iter().enumerate() {
        out.extend(sample_triangles(&triangles(file)?, face + k as u32, table.spacing_mm));
    }
    Ok(out)
}

/// Sides of the prism that stands for a round blank.
const SIDES: usize = 360;

/// A round blank as a closed prism around it.
fn prism(axis: Unit3, diameter_mm: f64, along_mm: [f64; 2]) -> Vec<[Point3; 3]> {
    let first = any_perpendicular(&axis);
    let second = axis.cross(&first);
    let turn = std::f64::consts::TAU / SIDES as f64;
    let radius = 0.5 * diameter_mm / (0.5 * turn).cos();
    let at = |k: usize, z: f64| {
        let (s, c) = (k as f64 * turn).sin_cos();
        Point3::from(first.into_inner() * (radius * c) + second * (radius * s) + axis.into_inner() * z)
    };
    let [lo, hi] = along_mm;
    let middle = along_mm.map(|z| Point3::from(axis.into_inner() * z));
    (0..SIDES)
        .flat_map(|k| {
            let n = (k + 1) % SIDES;
            [
                [at(k, lo), at(n, lo), at(n, hi)],
                [at(k, lo), at(n, hi), at(k, hi)],
                [middle[0], at(n, lo), at(k, lo)],
                [middle[1], at(k, hi), at(n, hi)],
            ]
        })
        .collect()
}

/// The box around the faces of a job.
pub fn around(faces: &Part) -> Box3 {
    faces.faces.iter().fold(Box3::empty(), |all, f| all.union(&part::bounds(f)))
}

/// A box by two corners.
pub fn corners(b: &Box3) -> String {
    format!(
        "({:.1}, {:.1}, {:.1}) to ({:.1}, {:.1}, {:.1})",
        b.min.x, b.min.y, b.min.z, b.max.x, b.max.y, b.max.z
    )
}

/// Tells raw material that does not hold the part: in another unit or another frame.
pub fn holds(stock: &Box3, part: &Box3) -> Option<Diagnostic> {
    const INCH: f64 = 25.4;
    // A part may be as large as its raw material.
    let slack = 1e-3 * part.diagonal_mm();
    let holds = |scale: f64| {
        (0..3).all(|k| {
            stock.min[k] * scale <= part.min[k] + slack && stock.max[k] * scale >= part.max[k] - slack
        })
    };
    let hint = if holds(INCH) {
        "it would if it were in inches: give it in mm"
    } else {
        "is it in mm, and in the part's frame?"
    };
    (!holds(1.0)).then(|| {
        let (stock, part) = (corners(stock), corners(part));
        let text = format!("the raw material, {stock} mm, does not hold the part, {part} mm; {hint}");
        Diagnostic::warning("stock", text)
    })
}

/// The box around the raw material of a job, where it has one.
pub fn bounds(job: &Job, faces: &Part) -> Result<Option<Box3>, Failure> {
    let Some(stock) = job.stock() else { return Ok(None) };
    Ok(Some(match &stock.blank {
        Raw::Box(b) => *b,
        Raw::Cylinder { axis, diameter_mm, along_mm } => {
            Box3::around(prism(*axis, *diameter_mm, *along_mm).iter().flatten())
        }
        Raw::File { path, layer_mm } => {
            Box3::around(triangles(path)?.iter().flatten()).grown(layer_mm.unwrap_or(0.0))
        }
        Raw::Saved(path) => *saved(path, job, faces)?.bounds(),
        Raw::Layer(thickness_mm) => around(faces).grown(*thickness_mm),
    }))
}

/// Two opposite corners of the box around the raw material, where the job declares some that is more than a layer.
pub fn corners_of(job: &Job, faces: &Part) -> Result<Option<[[f64; 3]; 2]>, Failure> {
    if job.stock().is_none_or(|s| matches!(s.blank, Raw::Layer(_))) {
        return Ok(None);
    }
    Ok(bounds(job, faces)?.map(|b| [b.min.into(), b.max.into()]))
}

/// How far a ray from a point goes until it leaves a box, mm; zero from outside.
fn leaves(b: &Box3, from: &Point3, along: &Unit3) -> f64 {
    let each = (0..3).map(|k| match along[k] {
        d if d > 0.0 => (b.max[k] - from[k]) / d,
        d if d < 0.0 => (b.min[k] - from[k]) / d,
        _ => f64::INFINITY,
    });
    each.fold(f64::INFINITY, f64::min).max(0.0)
}

/// As [`leaves`], of a round blank of a radius about an axis, between two places along it.
fn round_leaves(axis: &Unit3, (radius, [low, high]): (f64, [f64; 2]), from: &Point3, along: &Unit3) -> f64 {
    let (z, dz) = (from.coords.dot(axis), along.dot(axis));
    let (p, d) = (from.coords - axis.into_inner() * z, along.into_inner() - axis.into_inner() * dz);
    let ends = if dz > 0.0 {
        (high - z) / dz
    } else if dz < 0.0 {
        (low - z) / dz
    } else {
        f64::INFINITY
    };
    let (a, b, c) = (d.norm_squared(), p.dot(&d), radius * radius - p.norm_squared());
    let wall = if a > 0.0 { ((b * b + a * c).max(0.0).sqrt() - b) / a } else { f64::INFINITY };
    ends.min(wall).max(0.0)
}

/// Raw material as the job declares it, ready to be filled.
pub struct RawMaterial<'a> {
    /// What the job declares.
    blank: Option<&'a Raw>,
    triangles: Vec<[Point3; 3]>,
    /// The box around it.
    bounds: Box3,
    /// What a run before has saved, or operations before have left.
    left: Option<Arc<Stock>>,
    resolution: Resolution,
    words: String,
}

impl<'a> RawMaterial<'a> {
    /// The raw material of a job: what operations before have left, or what it declares, if it does.
    pub fn of(job: &'a Job, faces: &Part) -> Result<Option<Self>, Failure> {
        if let Some(left) = &faces.left {
            return Ok(Some(Self::left(left)));
        }
        let Some(given) = job.stock() else { return Ok(None) };
        let mut left = None;
        let (triangles, words) = match &given.blank {
            Raw::Saved(path) => {
                left = Some(Arc::new(saved(path, job, faces)?));
                let name = path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
                (Vec::new(), format!("what was left as {name} has it"))
            }
            Raw::Box(b) => (Vec::new(), format!("a box, {} mm", corners(b))),
            Raw::Cylinder { axis, diameter_mm, along_mm: [from, to] } => (
                prism(*axis, *diameter_mm, [*from, *to]),
                format!("a cylinder of {diameter_mm} mm from {from} to {to} mm"),
            ),
            Raw::File { path, layer_mm } => {
                let name = path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
                let more = layer_mm.map_or_else(String::new, |a| format!(" and {a} mm around it"));
                (triangles(path)?, format!("the solid of {name}{more}"))
            }
            Raw::Layer(thickness) => {
                let chord = 0.5 * job.tolerance().scallop_mm;
                let mut out = Vec::new();
                for f in &faces.faces {
                    let m = tessellate(&f.surface, chord, None);
                    let p = |k: u32| Point3::from(m.positions[k as usize]);
                    out.extend(m.triangles.iter().map(|t| t.map(p)));
                }
                (out, format!("a layer of {thickness} mm on the faces to machine"))
            }
        };
        let size = match (&left, &given.blank) {
            (Some(stock), _) => *stock.bounds(),
            (None, Raw::Box(b)) => *b,
            _ => Box3::around(triangles.iter().flatten()),
        };
        let cells = || (size.max - size.min).amax() / DEFAULT_CELLS;
        let resolution = Resolution {
            cell_mm: given.cell_mm.or(left.as_ref().map(|stock| stock.cell_mm())).unwrap_or_else(cells),
            tri: true,
            // Beyond what a machine can address there is no limit.
            budget_bytes: (given.memory_mb * 1e6).min(1e15) as usize,
        };
        let bounds = match &given.blank {
            Raw::File { layer_mm, .. } => size.grown(layer_mm.unwrap_or(0.0)),
            _ => size,
        };
        Ok(Some(Self { blank: Some(&given.blank), triangles, bounds, left, resolution, words }))
    }

    fn left(left: &LeftMaterial) -> Self {
        Self {
            blank: None,
            triangles: Vec::new(),
            bounds: *left.stock.bounds(),
            left: Some(left.stock.clone()),
            // It is filled already.
            resolution: Resolution { cell_mm: left.cell_mm, tri: true, budget_bytes: usize::MAX },
            words: "what operations before have left".to_owned(),
        }
    }

    /// In words.
    #[must_use]
    pub fn words(&self) -> &str {
        &self.words
    }

    /// How far it goes from a point within it along a direction at most, mm.
    #[must_use]
    pub fn beyond_mm(&self, from: &Point3, along: &Unit3) -> f64 {
        if let Some(stock) = &self.left {
            return stock.beyond_mm(from, along);
        }
        match self.blank {
            Some(Raw::Layer(thickness_mm)) => *thickness_mm,
            Some(Raw::Box(b)) => leaves(b, from, along),
            Some(Raw::Cylinder { axis, diameter_mm, along_mm }) => {
                round_leaves(axis, (0.5 * diameter_mm, *along_mm), from, along)
            }
            Some(Raw::File { .. } | Raw::Saved(_)) | None => leaves(&self.bounds, from, along),
        }
    }

    /// It, as convex bodies; none of a layer, which is where the part is.
    #[must_use]
    pub fn members(&self) -> Vec<Convex> {
        let all = |triangles: &[[Point3; 3]]| triangles.iter().map(|t| Convex::Triangle(*t)).collect();
        if let Some(stock) = &self.left {
            let mesh = stock.mesh(SEEN_CUBES);
            let at = |k: u32| mesh.points[k as usize];
            return all(&mesh.triangles.iter().map(|t| t.map(at)).collect::<Vec<_>>());
        }
        match self.blank {
            Some(Raw::Box(b)) => vec![Convex::cuboid(b)],
            Some(Raw::Layer(_)) => Vec::new(),
            Some(Raw::Cylinder { .. } | Raw::File { .. } | Raw::Saved(_)) | None => all(&self.triangles),
        }
    }

    /// It, filled.
    ///
    /// # Errors
    /// Where it is none.
    pub fn filled(&self) -> Result<Stock, Failure> {
        let GoalStock::Declared { blank, resolution, .. } = self.goal(0.0) else {
            return Err(Failure::job("no raw material is declared"));
        };
        Stock::fill(&blank, &resolution).map(|made| made.stock).map_err(Failure::job)
    }

    /// The raw material of a goal, with the layer on the faces to machine as far as they are judged.
    pub fn goal(&self, layer_mm: f64) -> GoalStock<'_> {
        let layer = |thickness_mm: f64, filled: bool| Blank::Layer {
            triangles: &self.triangles,
            thickness_mm,
            filled,
        };
        let blank = match (&self.left, self.blank) {
            (Some(stock), _) => Blank::Left(stock),
            (None, Some(Raw::Box(b))) => Blank::Box(*b),
            (None, Some(Raw::File { layer_mm: Some(thickness_mm), .. })) => layer(*thickness_mm, true),
            (None, Some(Raw::Layer(thickness_mm))) => layer(*thickness_mm, false),
            (None, Some(Raw::Cylinder { .. } | Raw::File { .. } | Raw::Saved(_)) | None) => {
                Blank::Mesh(&self.triangles)
            }
        };
        GoalStock::Declared { blank, resolution: self.resolution, layer_mm, words: &self.words }
    }
}

/// What became of raw material, as files have it, with what is to be told.
pub fn told(found: &StockFound, faces: &Part) -> (StockSummary, Vec<Diagnostic>) {
    let mut notes = Vec::new();
    if let Some(wanted) = found.coarsened_mm {
        let cell = found.cell_mm;
        let text = format!("cells are {cell:.4} mm instead of {wanted:.4} mm to stay within memory_mb");
        notes.push(Diagnostic::warning("stock", text));
    }
    notes.extend(holds(&found.bounds, &around(faces)));
    let stock = summary(found);
    let text = format!(
        "{:.0} mm3 of {:.0} mm3 are taken, {:.0} mm3 left (+- {:.0})",
        stock.removed_mm3, stock.volume_mm3, stock.left_mm3, stock.spread_mm3
    );
    notes.push(Diagnostic::note("stock", text));
    for c in stock.collisions.iter().take(LISTED) {
        let [x, y, z] = c.at_mm;
        let rapid = if c.rapid { " in rapid" } else { "" };
        let text = format!(
            "block {}: the {}{rapid} goes {:.3} mm deep through raw material at ({x:.3}, {y:.3}, {z:.3})",
            c.block, c.body, c.deepest_mm
        );
        notes.push(Diagnostic::loss("stock", text));
    }
    (stock, notes)
}

fn summary(found: &StockFound) -> StockSummary {
    let (left, carved) = (&found.left, &found.carved);
    let blocks: Vec<StockBlock> = carved
        .work
        .iter()
        .map(|w| StockBlock {
            block: w.block,
            volume_mm3: w.volume_mm3,
            section_mm2: w.section_mm2,
            engaged_deg: w.arc_rad.to_degrees(),
            height_mm: w.height_mm[1],
        })
        .collect();
    let mut most = blocks.clone();
    // Blocks that took the same stay in the order of the program.
    most.sort_by(|a, b| b.volume_mm3.total_cmp(&a.volume_mm3));
    most.truncate(LISTED);
    let collisions = carved.collisions.iter().map(|c| StockCollision {
        body: match c.body {
            Body::Cutter => "cutter",
            Body::Shank => "shank",
            Body::Holder => "holder",
        },
        rapid: c.rapid,
        block: c.block,
        deepest_mm: c.deepest_mm,
        volume_mm3: c.volume_mm3,
        at_mm: c.at.into(),
        operation: None,
        tool_number: None,
        motion: c.motion as usize,
    });
    StockSummary {
        cell_mm: found.cell_mm,
        rays: found.rays,
        volume_mm3: found.before.mm3,
        removed_mm3: carved.volume_mm3(),
        left_mm3: left.mm3,
        spread_mm3: left.spread_mm3,
        most,
        collisions: collisions.collect(),
        blocks,
    }
}
