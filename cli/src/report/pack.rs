//! What the viewer draws, as one binary block and a JSON head that says what lies where.
//!
//! Little-endian; every section begins at a multiple of four bytes. Points are 16-bit steps of a box around part and
//! passes (a metre gives steps of 0.015 mm: far below a pixel), normals are octahedral in two 13-bit numbers, and
//! deviations 32-bit floats of four digits, which is what the viewer shows. A shared vertex costs 14 bytes, a triangle 6
//! or 12. Points, normals and indices are written as differences from what stands before them: neighbours are alike. Of records of
//! several bytes all first bytes stand first, then all second ones and so on: bytes that mean the same are more alike than those of
//! one record. The page packs the block (RFC 1950).

use super::data::{FaceMesh, Report};
use super::mesh::Clean;
use serde_json::{Value, json};

/// More path points than this are thinned: beyond it lines differ by less than a pixel and the file only grows.
const PATH_POINTS: usize = 120_000;
/// Numbers of a pose: tip, axis, time, pass, tool, line of the program, setup; then where the joints stand.
const POSE_NUMBERS: usize = 11;

/// The block and its head.
#[non_exhaustive]
pub struct Packed {
    /// The bytes.
    pub bytes: Vec<u8>,
    /// What lies where.
    pub head: Value,
    /// What of the report is not drawn, in words.
    pub notes: Vec<String>,
}

/// Axis-aligned box of the points that are finite.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Bounds {
    /// Least coordinates, mm.
    pub lo: [f32; 3],
    /// Greatest coordinates, mm.
    pub hi: [f32; 3],
}

impl Bounds {
    /// `None` where no point is finite.
    pub fn of<'a>(points: impl Iterator<Item = &'a [f32; 3]>) -> Option<Self> {
        let start = Self { lo: [f32::INFINITY; 3], hi: [f32::NEG_INFINITY; 3] };
        let all = points.filter(|p| finite(p)).fold(start, |b, p| Self {
            lo: std::array::from_fn(|i| b.lo[i].min(p[i])),
            hi: std::array::from_fn(|i| b.hi[i].max(p[i])),
        });
        (all.lo[0] <= all.hi[0]).then_some(all)
    }
}

/// Are all three coordinates finite?
pub fn finite(point: &[f32; 3]) -> bool {
    point.iter().all(|x| x.is_finite())
}

#[derive(Default)]
struct Writer {
    bytes: Vec<u8>,
}

impl Writer {
    /// Appends a section and returns its offset.
    fn put(&mut self, bytes: impl IntoIterator<Item = u8>) -> usize {
        let at = self.bytes.len();
        self.bytes.extend(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        at
    }

    /// Records of so many bytes, taken apart byte by byte.
    fn records(&mut self, size: usize, bytes: &[u8]) -> usize {
        self.put((0..size).flat_map(|k| bytes.iter().skip(k).step_by(size).copied()))
    }

    /// Records of so many floats.
    fn floats(&mut self, stride: usize, values: impl Iterator<Item = f32>) -> usize {
        let bytes: Vec<u8> = values.flat_map(f32::to_le_bytes).collect();
        self.records(4 * stride, &bytes)
    }

    /// Floats of four digits.
    fn digits(&mut self, values: impl Iterator<Item = f32>) -> usize {
        self.floats(1, values.map(four_digits))
    }

    /// Records of so many numbers of two bytes, as differences from the record before.
    fn shorts(&mut self, stride: usize, values: impl Iterator<Item = u16>) -> usize {
        let bytes: Vec<u8> = differences(stride, values.map(u32::from))
            .into_iter()
            .flat_map(|d| (d as u16).to_le_bytes())
            .collect();
        self.records(2 * stride, &bytes)
    }

    /// Four bytes each, as differences from the value `stride` before.
    fn words(&mut self, stride: usize, values: impl Iterator<Item = u32>) -> usize {
        self.put(differences(stride, values).into_iter().flat_map(u32::to_le_bytes))
    }
}

/// A float with twelve bits of its fraction left, to the nearest: to one part in 8192.
fn four_digits(x: f32) -> f32 {
    if !x.is_finite() {
        return x;
    }
    let rounded = f32::from_bits((x.to_bits() + 0x400) & !0x7ff);
    if rounded.is_finite() { rounded } else { x }
}

/// Each value less the one `stride` before it, the first ones as they are; below zero they go round, in two bytes as in four.
fn differences(stride: usize, values: impl Iterator<Item = u32>) -> Vec<u32> {
    let mut out: Vec<u32> = values.collect();
    for k in (stride..out.len()).rev() {
        out[k] = out[k].wrapping_sub(out[k - stride]);
    }
    out
}

/// The steps of a coordinate box.
struct Steps {
    lo: [f64; 3],
    step: [f64; 3],
}

impl Steps {
    fn new(bounds: Option<Bounds>) -> Self {
        let b = bounds.unwrap_or(Bounds { lo: [0.0; 3], hi: [0.0; 3] });
        let lo = b.lo.map(f64::from);
        Self { lo, step: std::array::from_fn(|i| (f64::from(b.hi[i]) - lo[i]) / 65535.0) }
    }

    fn of(&self, point: &[f32; 3]) -> [u16; 3] {
        std::array::from_fn(|i| {
            let steps = (f64::from(point[i]) - self.lo[i]) / self.step[i];
            if steps.is_finite() { steps.round().clamp(0.0, 65535.0) as u16 } else { 0 }
        })
    }
}

/// Steps of a normal's two numbers on either side of zero: 0.03 deg, which no shading shows.
const NORMAL_STEPS: f64 = 4095.0;

/// A unit vector on the octahedron unfolded to a square, each coordinate from -4095 to 4095.
fn octahedral(normal: [f32; 3]) -> [u16; 2] {
    let n = normal.map(f64::from);
    let sum = n[0].abs() + n[1].abs() + n[2].abs();
    if !(sum > 0.0 && sum.is_finite()) {
        return [0, 0];
    }
    let (x, y) = (n[0] / sum, n[1] / sum);
    let sign = |a: f64| if a < 0.0 { -1.0 } else { 1.0 };
    let (x, y) = if n[2] < 0.0 { ((1.0 - y.abs()) * sign(x), (1.0 - x.abs()) * sign(y)) } else { (x, y) };
    [x, y].map(|a| ((a * NORMAL_STEPS).round() as i16) as u16)
}

/// Packs `report`, whose faces are `faces` made clean.
pub fn pack(report: &Report, faces: &[Clean]) -> Packed {
    let mut out = Writer::default();
    let mut notes = Vec::new();
    let points =
        faces.iter().flat_map(|f| &f.positions).chain(report.passes.iter().flat_map(|p| &p.points_mm));
    let bounds = Bounds::of(points);
    let steps = Steps::new(bounds);

    let heads: Vec<Value> = faces
        .iter()
        .zip(&report.faces)
        .map(|(clean, face)| {
            if clean.dropped > 0 {
                notes.push(format!(
                    "Face {}: {} triangles are not drawn, they have an index without vertex or a vertex that is not finite.",
                    face.id, clean.dropped
                ));
            }
            face_head(&mut out, clean, face, &steps)
        })
        .collect();
    let path = path_head(&mut out, report, &steps, &mut notes);
    let links: Vec<Value> = report
        .links
        .iter()
        .filter(|l| l.points_mm.len() > 1 && l.points_mm.iter().all(finite))
        .map(|l| {
            let at = out.floats(3, l.points_mm.iter().flatten().copied());
            json!({"at": at, "count": l.points_mm.len(), "rapid": l.rapid})
        })
        .collect();
    if links.len() < report.links.len() {
        notes.push(format!(
            "{} of {} links are not drawn: fewer than two points, or a point that is not finite.",
            report.links.len() - links.len(),
            report.links.len()
        ));
    }
    let joints = report.machine.as_ref().map_or(0, |m| m.joints.len());
    let numbers = POSE_NUMBERS + joints;
    let poses: Vec<f32> = report
        .poses
        .iter()
        .filter(|p| finite(&p.tip_mm) && finite(&p.axis))
        .flat_map(|p| {
            let ([x, y, z], [i, j, k]) = (p.tip_mm, p.axis);
            let pass = p.pass.map_or(-1.0, |n| n as f32);
            let own = [x, y, z, i, j, k, p.time_min, pass, p.tool as f32, p.line as f32, p.setup as f32];
            own.into_iter().chain(p.at_nose.into_iter().take(joints))
        })
        .collect();
    let pose_count = poses.len() / numbers;
    if pose_count < report.poses.len() {
        let hidden = report.poses.len() - pose_count;
        notes.push(format!("{hidden} tool poses are not finite and not shown."));
    }
    let poses_at = out.floats(numbers, poses.into_iter());
    let machine = report.machine.as_ref().map(|m| m.head(|values| out.floats(9, values.into_iter())));
    for name in report.machine.iter().flat_map(|m| &m.boxed) {
        notes.push(format!("Of {name}, a body of the machine, its box is drawn: it has too many triangles."));
    }
    let head = json!({
        "lo": steps.lo,
        "step": steps.step,
        "empty": bounds.is_none(),
        "faces": heads,
        "path": path,
        "links": links,
        "poses": {"at": poses_at, "count": pose_count, "numbers": numbers},
        "machine": machine,
    });
    Packed { bytes: out.bytes, head, notes }
}

fn face_head(out: &mut Writer, face: &Clean, of: &FaceMesh, steps: &Steps) -> Value {
    let vertices = face.positions.len();
    let wide = vertices > usize::from(u16::MAX);
    let indices = face.triangles.iter().flatten().copied();
    json!({
        "id": of.id,
        "checked": of.checked,
        "vertices": vertices,
        "triangles": face.triangles.len(),
        "wide": wide,
        "position": out.shorts(3, face.positions.iter().flat_map(|p| steps.of(p))),
        "normal": out.shorts(2, face.normals.iter().flat_map(|n| octahedral(*n))),
        "deviation": out.digits(face.deviation_mm.iter().copied()),
        "index": if wide { out.words(1, indices) } else { out.shorts(1, indices.map(|i| i as u16)) },
        "border": out.words(1, face.borders.iter().flatten().copied()),
        "borders": face.borders.len(),
        "scalars": face.scalars.iter().map(|s| out.digits(s.iter().copied())).collect::<Vec<_>>(),
    })
}

fn path_head(out: &mut Writer, report: &Report, steps: &Steps, notes: &mut Vec<String>) -> Value {
    let total: usize = report.passes.iter().map(|p| p.points_mm.len()).sum();
    let stride = total.div_ceil(PATH_POINTS).max(1);
    let mut kept: Vec<([u16; 3], f32)> = Vec::new();
    let mut counts: Vec<usize> = Vec::new();
    let mut lost = 0;
    for pass in &report.passes {
        let before = kept.len();
        let last = pass.points_mm.len().saturating_sub(1);
        for (i, point) in pass.points_mm.iter().enumerate() {
            if !finite(point) {
                lost += 1;
            } else if i % stride == 0 || i == last {
                kept.push((steps.of(point), pass.widths_mm.get(i).copied().unwrap_or(f32::NAN)));
            }
        }
        counts.push(kept.len() - before);
    }
    if stride > 1 {
        notes.push(format!("The passes are drawn through {} of their {total} points.", kept.len()));
    }
    if lost > 0 {
        notes.push(format!("{lost} path points are not finite and not drawn."));
    }
    json!({
        "counts": counts,
        "points": kept.len(),
        "position": out.shorts(3, kept.iter().flat_map(|k| k.0)),
        "width": out.digits(kept.iter().map(|k| k.1)),
    })
}

#[cfg(test)]
mod tests {
    use super::super::data::{Link, Pass};
    use super::super::mesh::clean;
    use super::*;
    use proptest::prelude::*;

    fn decode(q: [u16; 2]) -> [f64; 3] {
        let [x, y] = q.map(|a| f64::from(a as i16) / NORMAL_STEPS);
        let z = 1.0 - x.abs() - y.abs();
        let t = (-z).max(0.0);
        let fold = |a: f64| if a < 0.0 { a + t } else { a - t };
        let n = [fold(x), fold(y), z];
        let length = n.iter().map(|a| a * a).sum::<f64>().sqrt();
        n.map(|a| a / length)
    }

    #[test]
    fn an_empty_report_packs_to_nothing() {
        let packed = pack(&Report::default(), &[]);
        assert!(packed.bytes.is_empty() && packed.notes.is_empty());
        assert_eq!(packed.head["empty"], true);
    }

    #[test]
    fn sections_are_aligned_and_sized_as_said() {
        let face = FaceMesh {
            positions: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]],
            triangles: vec![[0, 1, 2]],
            ..FaceMesh::default()
        };
        let report = Report { faces: vec![face], ..Report::default() };
        let faces = [clean(&report.faces[0], 0)];
        let packed = pack(&report, &faces);
        let head = &packed.head["faces"][0];
        // 3 vertices: 18 bytes of positions rounded up to 20, 12 of normals, 12 of deviations, 6 of indices, 3
        // borders.
        assert_eq!([&head["position"], &head["normal"], &head["deviation"], &head["index"]], [0, 20, 32, 44]);
        assert_eq!(packed.bytes.len(), 52 + 24);
        assert_eq!(packed.head["step"][1], 2.0 / 65535.0);
    }

    #[test]
    fn what_is_not_drawn_is_said() {
        let pass = Pass { points_mm: vec![[0.0; 3]; PATH_POINTS + 1], widths_mm: vec![] };
        let broken = Pass { points_mm: vec![[f32::NAN; 3], [1.0; 3]], widths_mm: vec![] };
        let report = Report { passes: vec![pass, broken], links: vec![Link::default()], ..Report::default() };
        let packed = pack(&report, &[]);
        assert_eq!(packed.notes.len(), 3, "{:?}", packed.notes);
        assert!(packed.head["path"]["points"].as_u64() < Some(PATH_POINTS as u64));
    }

    #[test]
    fn records_are_taken_apart_and_floats_keep_four_digits() {
        let mut out = Writer::default();
        assert_eq!(out.records(3, &[1, 2, 3, 4, 5, 6]), 0);
        assert_eq!(out.bytes, [1, 4, 2, 5, 3, 6, 0, 0]);
        for x in [0.073_64_f32, -1.0e-7, 3.4e38, 0.0] {
            assert!((four_digits(x) - x).abs() <= x.abs() / 8192.0, "{x}");
        }
        assert!(four_digits(f32::NAN).is_nan() && four_digits(f32::INFINITY) == f32::INFINITY);
        assert!(four_digits(f32::MAX).is_finite());
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// What the viewer does to have the values back: each more than the one `stride` before, going round.
        #[test]
        fn differences_come_back(values in prop::collection::vec(any::<u16>(), 0..40), stride in 1..4_usize) {
            let mut back: Vec<u16> =
                differences(stride, values.iter().map(|v| u32::from(*v))).into_iter().map(|d| d as u16).collect();
            for k in stride..back.len() {
                back[k] = back[k].wrapping_add(back[k - stride]);
            }
            prop_assert_eq!(back, values);
        }

        /// Half a step in each of two coordinates of a map that stretches lengths by at most 3 (a corner of the
        /// octahedron against the sphere): 3 * sqrt(2) * 0.5 / 4095 = 5.2e-4.
        #[test]
        fn normals_come_back(x in -1.0..1.0_f32, y in -1.0..1.0_f32, z in -1.0..1.0_f32) {
            let length = (x * x + y * y + z * z).sqrt();
            prop_assume!(length > 0.1);
            let n = [x / length, y / length, z / length];
            let back = decode(octahedral(n));
            let error = (0..3).map(|i| (back[i] - f64::from(n[i])).powi(2)).sum::<f64>().sqrt();
            prop_assert!(error < 5.2e-4, "{error}");
        }

        /// A point comes back within half a step, and the rounding of f32, in each coordinate.
        #[test]
        fn points_come_back(at in prop::array::uniform3(-500.0..500.0_f32)) {
            let steps = Steps::new(Bounds::of([[-500.0; 3], [500.0; 3]].iter()));
            let q = steps.of(&at);
            for i in 0..3 {
                let back = steps.lo[i] + steps.step[i] * f64::from(q[i]);
                prop_assert!((back - f64::from(at[i])).abs() <= 0.5 * steps.step[i] + 1e-9);
            }
        }
    }
}
