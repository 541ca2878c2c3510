//! The reference answers: `manifest.json` names the files, one JSON file each says what is in them.

use serde_json::Value;
use std::path::Path;

/// One file of the collection.
pub struct Entry {
    /// Path below `files/`.
    pub file: String,
    /// What the reference says of it.
    pub reference: Reference,
}

/// The reference's answer.
pub enum Reference {
    /// Faces.
    Shape(Shape),
    /// None, with the status: `no-shape`, `read-failed` or `crash`.
    Without(String),
}

/// Faces and totals.
pub struct Shape {
    pub faces: Vec<RefFace>,
    pub area_mm2: f64,
    pub area_tol_mm2: f64,
    /// Lower corner, then upper corner.
    pub bbox_mm: Option<[f64; 6]>,
    /// Whether the box is around curves and points too that belong to no face.
    pub more_in_box: bool,
}

/// One face.
pub struct RefFace {
    /// Instance number or directory entry.
    pub id: Option<u64>,
    pub kind: String,
    pub area_mm2: f64,
    pub area_tol_mm2: f64,
    /// Poles by direction as the file has them.
    pub poles: Option<[usize; 2]>,
    pub samples: Vec<Sample>,
}

/// A point of a spline face.
pub struct Sample {
    pub uv: [f64; 2],
    pub point_mm: [f64; 3],
    /// `S_u x S_v`, unit.
    pub normal: Option<[f64; 3]>,
    /// Largest, smallest; positive bends towards the normal.
    pub curvature_per_mm: Option<[f64; 2]>,
    /// `None` on the boundary.
    pub inside: Option<bool>,
}

/// Every STEP and IGES file with its reference; the damaged ones too where asked for.
pub fn entries(data: &Path, malformed: bool) -> Result<Vec<Entry>, String> {
    let manifest = parse(&data.join("manifest.json"))?;
    let mut entries = Vec::new();
    for item in manifest["files"].as_array().ok_or("manifest.json has no files")? {
        let Some(file) = item["file"].as_str() else { continue };
        let folder = file.split('/').next().unwrap_or_default();
        let wanted = matches!(folder, "step" | "step_micro" | "iges" | "iges_micro");
        let damaged = malformed && folder == "malformed";
        if !(wanted || damaged) {
            continue;
        }
        let Some(truth) = item["truth"].as_str() else { continue };
        let json = parse(&data.join(truth))?;
        entries.push(Entry { file: file.to_owned(), reference: reference(&json) });
    }
    Ok(entries)
}

fn parse(path: &Path) -> Result<Value, String> {
    let text = std::fs::read_to_string(path).map_err(|e| format!("cannot read {}: {e}", path.display()))?;
    serde_json::from_str(&text).map_err(|e| format!("{} is no JSON: {e}", path.display()))
}

fn reference(json: &Value) -> Reference {
    let status = json["status"].as_str().unwrap_or_default();
    if status != "ok" {
        return Reference::Without(status.to_owned());
    }
    let number = |v: &Value| v.as_f64().unwrap_or(f64::NAN);
    let faces = json["faces"].as_array().map(|f| f.iter().map(face).collect()).unwrap_or_default();
    Reference::Shape(Shape {
        faces,
        area_mm2: number(&json["area"]),
        area_tol_mm2: number(&json["area_tol"]),
        more_in_box: json["edges"]["not_on_face"].as_u64().unwrap_or(0) > 0,
        bbox_mm: numbers(&json["bbox"]).and_then(|b| b.try_into().ok()),
    })
}

fn numbers(v: &Value) -> Option<Vec<f64>> {
    v.as_array()?.iter().map(Value::as_f64).collect()
}

fn face(json: &Value) -> RefFace {
    let number = |k: &str| json[k].as_f64().unwrap_or(f64::NAN);
    let poles = numbers(&json["raw"]).filter(|r| r.len() == 5).map(|r| [r[3] as usize, r[4] as usize]);
    let samples = json["s"].as_array().map(|rows| rows.iter().filter_map(sample).collect());
    RefFace {
        id: json["id"].as_u64(),
        kind: json["type"].as_str().unwrap_or_default().to_owned(),
        area_mm2: number("area"),
        area_tol_mm2: number("atol"),
        poles,
        samples: samples.unwrap_or_default(),
    }
}

fn sample(row: &Value) -> Option<Sample> {
    let x: Vec<Option<f64>> = row.as_array()?.iter().map(Value::as_f64).collect();
    let several = |from: usize, to: usize| x.get(from..to)?.iter().copied().collect::<Option<Vec<f64>>>();
    Some(Sample {
        uv: several(0, 2)?.try_into().ok()?,
        point_mm: several(2, 5)?.try_into().ok()?,
        normal: several(5, 8).and_then(|n| n.try_into().ok()),
        curvature_per_mm: several(8, 10).and_then(|k| k.try_into().ok()),
        inside: match x.get(13).copied().flatten() {
            Some(0.0) => Some(false),
            Some(1.0) => Some(true),
            _ => None,
        },
    })
}
