//! The surface as cut, as a PLY file: the faces' triangles with every vertex moved along its normal to where the tool left
//! it, and coloured by how far that is.
//!
//! Binary, little-endian; a vertex has x, y, z (float, mm), deviation (float, mm, positive is material left), red, green and
//! blue. Green is within tolerance, red above, blue below; grey was not reached.

use crate::failure::Failure;
use crate::job::Job;
use crate::part::Part;
use osculate_geom::{Point3, Unit3, Vec3, uv};
use osculate_surfaces::tessellate;
use osculate_tools::removal::{self, Sample, Swept};

/// Vertices are this many samples apart.
const COARSER: f64 = 2.0;

/// Cuts the vertices of the job's faces and makes the file of them.
pub fn bytes(job: &Job, faces: &Part, motions: &[Swept], spacing_mm: f64) -> Result<Vec<u8>, Failure> {
    let tolerance = job.tolerance();
    let cutter = job.cutter();
    let holder = job.holder();
    let (mut samples, mut triangles) = (Vec::new(), Vec::<[u32; 3]>::new());
    for (k, face) in faces.faces.iter().enumerate() {
        let mesh = tessellate(&face.surface, tolerance.scallop_mm, Some(COARSER * spacing_mm));
        let first = samples.len() as u32;
        for ((p, n), at) in mesh.positions.iter().zip(&mesh.normals).zip(&mesh.uvs) {
            // Where there is no tangent plane the vertex stays where it is: any direction does.
            let normal = Unit3::try_new(Vec3::from(*n), 0.5).unwrap_or_else(Vec3::z_axis);
            samples.push(Sample {
                point: Point3::from(*p),
                normal,
                face: k as u32,
                uv: uv(at[0], at[1]),
                area_mm2: 0.0,
                check_only: false,
            });
        }
        triangles.extend(mesh.triangles.iter().map(|t| t.map(|i| i + first)));
    }
    let work = removal::Job {
        cutter: &cutter,
        holder,
        changes: &[],
        motions,
        samples: &samples,
        stock_mm: job.layer_mm(),
        depth_mm: cutter.radius_mm(),
    };
    let cuts = removal::cut(&work, &|_| {}).map_err(Failure::job)?;
    let mut out = format!(
        "ply\nformat binary_little_endian 1.0\ncomment osculate: surface as cut, mm\nelement vertex {}\n\
         property float x\nproperty float y\nproperty float z\nproperty float deviation\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\nelement face {}\n\
         property list uchar int vertex_indices\nend_header\n",
        samples.len(),
        triangles.len()
    )
    .into_bytes();
    for (s, c) in samples.iter().zip(&cuts) {
        let p = s.point + s.normal.into_inner() * c.standoff_mm;
        for x in [p.x, p.y, p.z, c.standoff_mm] {
            out.extend((x as f32).to_le_bytes());
        }
        out.extend(if c.by.is_none() {
            [150, 150, 150]
        } else if c.standoff_mm > tolerance.scallop_mm {
            [200, 40, 40]
        } else if c.standoff_mm < -tolerance.gouge_mm {
            [40, 60, 200]
        } else {
            // Darker the more is left.
            let share = (c.standoff_mm / tolerance.scallop_mm).clamp(0.0, 1.0);
            [60, (190.0 - 90.0 * share) as u8, 80]
        });
    }
    for t in &triangles {
        out.push(3);
        for i in t {
            out.extend(i.to_le_bytes());
        }
    }
    Ok(out)
}
