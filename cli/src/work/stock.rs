//! The `[stock]` and `[fixture]` tables: raw material and what holds the part.

use crate::failure::{Failure, beside, read};
use crate::job::Job;
use crate::part::{self, JobFaces};
use osculate_geom::{Box3, Diagnostic, Point3, Unit3, Vec3};
use osculate_surfaces::tessellate;
use osculate_tools::removal::stock::{Blank, Resolution, read_stl};
use osculate_tools::removal::{Body, GoalStock, Sample, StockFound, sample_triangles};
use serde::{Deserialize, Serialize};

/// Cells along the longest side of the stock where the job gives none.
const DEFAULT_CELLS: f64 = 256.0;
/// Memory for the stock where the job gives none.
const DEFAULT_MEMORY_MB: f64 = 512.0;
/// Blocks listed by what they took.
const LISTED: usize = 10;

/// `[stock]`: one of `box_mm`, `file` and `allowance_mm` (with `file`: a layer around it).
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StockTable {
    /// Lower and upper corner in the part's frame.
    pub box_mm: Option<[f64; 6]>,
    /// A closed STL mesh in the part's frame, mm, relative to the job file.
    pub file: Option<String>,
    /// A cylinder.
    pub cylinder: Option<CylinderTable>,
    /// A layer of this thickness around the faces of the job, or around the file's solid.
    pub allowance_mm: Option<f64>,
    /// Sides of cells.
    pub cell_mm: Option<f64>,
    /// Memory for it.
    pub memory_mb: Option<f64>,
}

/// `cylinder` of `[stock]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CylinderTable {
    /// Its axis, through the part's origin; z where not given.
    pub axis: Option<[f64; 3]>,
    /// Diameter.
    pub diameter_mm: f64,
    /// Where it begins and ends along the axis.
    pub z_mm: [f64; 2],
}

/// `[fixture]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FixtureTable {
    /// STL meshes in the part's frame, mm, relative to the job file.
    pub files: Vec<String>,
    /// Distance of the places looked at; 1 mm where not given.
    pub spacing_mm: Option<f64>,
}

/// The `stock` object of `verify --json`.
#[derive(Debug, Serialize, Clone)]
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
}

fn mesh(job: &Job, file: &str) -> Result<Vec<[Point3; 3]>, Failure> {
    let path = beside(&job.path, file);
    read_stl(&read(&path)?).map_err(|e| Failure::file(&path, e))
}

/// Places on the fixtures, as faces that carry no material, numbered from `face` on.
pub fn fixtures(job: &Job, face: u32) -> Result<Vec<Sample>, Failure> {
    let Some(table) = &job.fixture else { return Ok(Vec::new()) };
    let spacing = table.spacing_mm.unwrap_or(1.0);
    if !(spacing.is_finite() && spacing > 0.0) {
        return Err(Failure::file(&job.path, format!("[fixture] spacing_mm = {spacing} must be positive")));
    }
    let mut out = Vec::new();
    for (k, file) in table.files.iter().enumerate() {
        out.extend(sample_triangles(&mesh(job, file)?, face + k as u32, spacing));
    }
    Ok(out)
}

/// The box around the faces of a job.
pub fn around(faces: &JobFaces) -> Box3 {
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
fn holds(stock: &Box3, part: &Box3) -> Option<Diagnostic> {
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
pub fn bounds(job: &Job, faces: &JobFaces) -> Result<Option<Box3>, Failure> {
    let Some(table) = &job.stock else { return Ok(None) };
    let solid = match (&table.box_mm, &table.file, &table.cylinder) {
        (Some(b), ..) => Box3 { min: Point3::new(b[0], b[1], b[2]), max: Point3::new(b[3], b[4], b[5]) },
        (None, Some(file), _) => Box3::around(mesh(job, file)?.iter().flatten()),
        (None, None, Some(c)) => {
            let prism = c.prism().map_err(|e| Failure::file(&job.path, format!("[stock] {e}")))?;
            Box3::around(prism.iter().flatten())
        }
        (None, None, None) => around(faces),
    };
    Ok(Some(solid.grown(table.allowance_mm.unwrap_or(0.0))))
}

/// Raw material as the job declares it.
pub struct RawMaterial {
    boxed: Option<Box3>,
    triangles: Vec<[Point3; 3]>,
    /// Thickness of the layer around the triangles, mm, and whether they are filled.
    layer: Option<(f64, bool)>,
    resolution: Resolution,
    words: String,
}

/// Sides of the prism that stands around a cylinder: it is a ten-thousandth of the radius wider.
const SIDES: u32 = 256;

impl RawMaterial {
    /// The raw material of a job, where it declares one.
    pub fn of(job: &Job, faces: &JobFaces) -> Result<Option<Self>, Failure> {
        let Some(table) = &job.stock else { return Ok(None) };
        let wrong = |text: String| Failure::file(&job.path, format!("[stock] {text}"));
        let (mut boxed, mut triangles, mut layer) = (None, Vec::new(), None);
        let words = match (&table.box_mm, &table.file, &table.cylinder, table.allowance_mm) {
            (Some(b), None, None, None) => {
                let b = Box3 { min: Point3::new(b[0], b[1], b[2]), max: Point3::new(b[3], b[4], b[5]) };
                boxed = Some(b);
                format!("a box, {} mm", corners(&b))
            }
            (None, Some(file), None, allowance) => {
                triangles = mesh(job, file)?;
                layer = allowance.map(|a| (a, true));
                let more = allowance.map_or_else(String::new, |a| format!(" and {a} mm around it"));
                format!("the solid of {file}{more}")
            }
            (None, None, Some(c), None) => {
                triangles = c.prism().map_err(wrong)?;
                format!("a cylinder of {} mm from {} to {} mm", c.diameter_mm, c.z_mm[0], c.z_mm[1])
            }
            (None, None, None, Some(allowance)) => {
                let chord = 0.5 * job.tolerance()?.scallop_mm;
                for f in &faces.faces {
                    let m = tessellate(&f.surface, chord, None);
                    let p = |k: u32| Point3::from(m.positions[k as usize]);
                    triangles.extend(m.triangles.iter().map(|t| t.map(p)));
                }
                layer = Some((allowance, false));
                format!("a layer of {allowance} mm on the faces to machine")
            }
            (None, None, None, None) => {
                return Err(wrong("needs box_mm, cylinder, file or allowance_mm".to_owned()));
            }
            _ => {
                return Err(wrong(
                    "has several of box_mm, cylinder, file and allowance_mm; keep one (allowance_mm goes with file)".to_owned(),
                ));
            }
        };
        let size = boxed.unwrap_or_else(|| Box3::around(triangles.iter().flatten()));
        let memory = table.memory_mb.unwrap_or(DEFAULT_MEMORY_MB);
        if !(memory.is_finite() && memory > 0.0) {
            return Err(wrong(format!("memory_mb = {memory} must be positive")));
        }
        let resolution = Resolution {
            cell_mm: table.cell_mm.unwrap_or((size.max - size.min).amax() / DEFAULT_CELLS),
            tri: true,
            // Beyond what a machine can address there is no limit.
            budget_bytes: (memory * 1e6).min(1e15) as usize,
        };
        Ok(Some(Self { boxed, triangles, layer, resolution, words }))
    }

    /// The raw material of a goal, with the layer on the faces to machine as far as they are judged.
    pub fn goal(&self, layer_mm: f64) -> GoalStock<'_> {
        let blank = match (&self.boxed, self.layer) {
            (Some(b), _) => Blank::Box(*b),
            (None, Some((thickness_mm, filled))) => {
                Blank::Layer { triangles: &self.triangles, thickness_mm, filled }
            }
            (None, None) => Blank::Mesh(&self.triangles),
        };
        GoalStock::Declared { blank, resolution: self.resolution, layer_mm, words: &self.words }
    }
}

impl CylinderTable {
    /// The axis of the cylinder through the part's origin.
    fn axis(&self) -> Result<Unit3, String> {
        let a = self.axis.unwrap_or([0.0, 0.0, 1.0]);
        Unit3::try_new(Vec3::from(a), 1e-9)
            .filter(|u| u.iter().all(|c| c.is_finite()))
            .ok_or_else(|| format!("cylinder axis = {a:?} has no direction"))
    }

    /// A closed prism around the cylinder, its triangles counter-clockwise from outside.
    fn prism(&self) -> Result<Vec<[Point3; 3]>, String> {
        let (d, [low, high]) = (self.diameter_mm, self.z_mm);
        if !(d.is_finite() && d > 0.0 && low.is_finite() && high.is_finite() && low < high) {
            return Err("cylinder needs diameter_mm above zero and z_mm = [lower, upper]".to_owned());
        }
        let axis = self.axis()?.into_inner();
        let side = if axis.z.abs() < 0.9 { Vec3::z() } else { Vec3::x() };
        let x = axis.cross(&side).normalize();
        let y = axis.cross(&x);
        let step = std::f64::consts::TAU / f64::from(SIDES);
        let radius = 0.5 * d / (0.5 * step).cos();
        let at = |k: u32, h: f64| {
            let (sin, cos) = (step * f64::from(k % SIDES)).sin_cos();
            Point3::from(axis * h + (x * cos + y * sin) * radius)
        };
        let middle = |h: f64| Point3::from(axis * h);
        Ok((0..SIDES)
            .flat_map(|k| {
                let [a, b] = [k, k + 1].map(|k| at(k, low));
                let [c, d] = [k, k + 1].map(|k| at(k, high));
                [[a, b, d], [a, d, c], [middle(high), c, d], [middle(low), b, a]]
            })
            .collect())
    }
}

/// What became of raw material, as files have it, with what is to be told.
pub fn told(found: &StockFound, faces: &JobFaces) -> (StockSummary, Vec<Diagnostic>) {
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
