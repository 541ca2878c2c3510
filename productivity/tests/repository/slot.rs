//! Slots through a layer of stock on real faces: volume by the productivity of the engagement, and by material removal.
//!
//! The stock is a layer of even thickness over a patch of a face, as a closed mesh. A cutter in contact with the face goes
//! through it along an isoparametric line, then once more beside its first way. What the rate of its engagement adds up to
//! over the pass is held against the volume that the tri-dexel model takes away.

use osculate_geom::line::IsoLine;
use osculate_geom::{Axis, Domain, Interval, Point3, Surface, Uv, uv};
use osculate_productivity::engagement::{Fineness, Outline};
use osculate_tools::removal::Swept;
use osculate_tools::removal::stock::{Blank, Resolution, Stock, StockJob};
use osculate_tools::sweep::SweptMotion;
use osculate_tools::{ContactMotion, Cutter, Lean, Pose};

/// Poses from which a pass is swept: chords stray from the motion by far less than a cell.
const POSES: usize = 48;

/// A slot to be cut.
pub struct Slot<'a> {
    pub face: &'a dyn Surface,
    /// The middle of the pass.
    pub at: Uv,
    pub cutter: &'a Cutter,
    pub lean: Lean,
    /// Thickness of the layer, mm.
    pub stock_mm: f64,
    /// Length of the pass, mm.
    pub length_mm: f64,
    /// Side step to the second pass, mm.
    pub step_mm: f64,
    /// Cells of the tri-dexel model, mm.
    pub cell_mm: f64,
    /// Instants at which the rate is taken; meridians of the cutter are three times as many.
    pub instants: usize,
}

/// Volumes of the two passes, mm3: by the rate and by removal.
#[derive(Debug)]
pub struct Volumes {
    pub by_rate: [f64; 2],
    pub by_removal: [f64; 2],
}

struct Layer<'a> {
    face: &'a dyn Surface,
    patch: Domain,
    stock_mm: f64,
    /// mm per parameter.
    speed: [f64; 2],
}

impl Layer<'_> {
    /// Distance to the boundary of the layer, positive inside, near its zeros; `near` is the last foot.
    fn depth(&self, p: &Point3, near: &mut Uv) -> f64 {
        let mut at = *near;
        let mut height = 0.0;
        for _ in 0..8 {
            let jet = self.face.jet2(at);
            let w = p - jet.point;
            let (f, g) = (w.dot(&jet.du), w.dot(&jet.dv));
            let a = jet.du.dot(&jet.du) - w.dot(&jet.duu);
            let b = jet.du.dot(&jet.dv) - w.dot(&jet.duv);
            let c = jet.dv.dot(&jet.dv) - w.dot(&jet.dvv);
            let det = a * c - b * b;
            let (x, y) = ((f * c - g * b) / det, (g * a - f * b) / det);
            at = uv(at.u + x, at.v + y);
            let Ok(n) = jet.normal() else { return -1.0 };
            height = w.dot(&n);
            if !(x.is_finite() && y.is_finite()) {
                return -1.0;
            }
            if x.abs() * self.speed[0] + y.abs() * self.speed[1] < 1e-9 {
                break;
            }
        }
        *near = at;
        let d = &self.patch;
        let walls = [
            (at.u - d.u.lo) * self.speed[0],
            (d.u.hi - at.u) * self.speed[0],
            (at.v - d.v.lo) * self.speed[1],
            (d.v.hi - at.v) * self.speed[1],
        ];
        walls.into_iter().fold(height.min(self.stock_mm - height), f64::min)
    }

    /// The layer as a closed mesh, counter-clockwise from outside.
    fn mesh(&self, spacing_mm: f64) -> Vec<[Point3; 3]> {
        let cuts = |i: &Interval, speed: f64| ((i.hi - i.lo) * speed / spacing_mm).ceil() as usize;
        let [nu, nv] = [cuts(&self.patch.u, self.speed[0]), cuts(&self.patch.v, self.speed[1])];
        let at =
            |i: usize, j: usize| self.face.jet2(self.patch.at(i as f64 / nu as f64, j as f64 / nv as f64));
        let bottom: Vec<Point3> =
            (0..=nu).flat_map(|i| (0..=nv).map(move |j| (i, j))).map(|(i, j)| at(i, j).point).collect();
        let top: Vec<Point3> = (0..=nu)
            .flat_map(|i| (0..=nv).map(move |j| (i, j)))
            .map(|(i, j)| {
                let jet = at(i, j);
                jet.point + jet.normal().expect("a tangent plane").into_inner() * self.stock_mm
            })
            .collect();
        let k = |i: usize, j: usize| i * (nv + 1) + j;
        let mut quads: Vec<[Point3; 4]> = Vec::new();
        for i in 0..nu {
            for j in 0..nv {
                let c = [k(i, j), k(i + 1, j), k(i + 1, j + 1), k(i, j + 1)];
                quads.push(c.map(|c| top[c]));
                quads.push([c[0], c[3], c[2], c[1]].map(|c| bottom[c]));
            }
        }
        let mut wall = |a: usize, b: usize| quads.push([bottom[a], bottom[b], top[b], top[a]]);
        for i in 0..nu {
            wall(k(i, 0), k(i + 1, 0));
            wall(k(i + 1, nv), k(i, nv));
        }
        for j in 0..nv {
            wall(k(nu, j), k(nu, j + 1));
            wall(k(0, j + 1), k(0, j));
        }
        let jet = at(0, 0);
        let right = jet.du.cross(&jet.dv).dot(&jet.normal().expect("a tangent plane")) > 0.0;
        quads
            .into_iter()
            .flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]])
            .map(|t| if right { t } else { [t[0], t[2], t[1]] })
            .collect()
    }
}

impl Slot<'_> {
    fn layer(&self) -> Layer<'_> {
        let jet = self.face.jet2(self.at);
        let speed = [jet.du.norm(), jet.dv.norm()];
        // Both ends of the pass lie in the layer; to the sides it is wider than the cutter on the second pass.
        let side = self.cutter.radius_mm() + self.step_mm + self.stock_mm;
        let long = 0.5 * self.length_mm + self.cutter.radius_mm() + self.stock_mm;
        let around = |x: f64, by: f64, domain: Interval| {
            assert!(x - by >= domain.lo && x + by <= domain.hi, "the face is too small for the slot");
            Interval::new(x - by, x + by)
        };
        let d = self.face.domain();
        let patch =
            Domain { u: around(self.at.u, long / speed[0], d.u), v: around(self.at.v, side / speed[1], d.v) };
        Layer { face: self.face, patch, stock_mm: self.stock_mm, speed }
    }

    /// Cuts both passes both ways.
    pub fn volumes(&self) -> Volumes {
        let layer = self.layer();
        let half = 0.5 * self.length_mm / layer.speed[0];
        let ends = [self.at.u - half, self.at.u + half];
        let mesh = layer.mesh(4.0 * self.cell_mm);
        let resolution = Resolution { cell_mm: self.cell_mm, tri: true, budget_bytes: 1 << 30 };
        let mut stock = Stock::fill(&Blank::Mesh(&mesh), &resolution).expect("a closed mesh").stock;
        let fineness = Fineness {
            meridians: 3 * self.instants,
            step_mm: 0.8 / self.instants as f64 * self.cutter.radius_mm(),
        };
        let outline = Outline::new(self.cutter, fineness);
        let reach = 2.0 * self.cutter.radius_mm() + 2.0 * self.stock_mm;
        let mut before: Vec<Pose> = Vec::new();
        let mut out = Volumes { by_rate: [0.0; 2], by_removal: [0.0; 2] };
        for pass in 0..2 {
            let fixed = self.at.v + if pass == 0 { 0.0 } else { self.step_mm / layer.speed[1] };
            let line = IsoLine { surface: self.face, along: Axis::U, fixed, reversed: false };
            let motion = ContactMotion { line: &line, cutter: self.cutter, lean: self.lean, lift_mm: 0.0 };
            let poses: Vec<Pose> = (0..=POSES)
                .map(|k| ends[0] + (ends[1] - ends[0]) * k as f64 / POSES as f64)
                .map(|t| motion.at(t).expect("inside the face").pose)
                .collect();
            let motions = |poses: &[Pose]| -> Vec<Swept> {
                poses.windows(2).map(|w| Swept { from: w[0], to: w[1], rapid: false, block: 1 }).collect()
            };
            let mut carve = |motions: &[Swept]| {
                let job = StockJob { cutter: self.cutter, uppers: &[], motions, touch_mm: 1.0 };
                stock.carve(&job, &|_| ()).expect("a good job").volume_mm3()
            };
            // Down along the axis first: what the tool covers where it begins is not of the pass.
            let above = Pose { tip: poses[0].tip + poses[0].axis.into_inner() * 20.0, ..poses[0] };
            carve(&motions(&[above, poses[0]]));
            out.by_removal[pass] = carve(&motions(&poses));
            let mut near = self.at;
            let depth = |t: f64, p: &Point3| {
                let contact = uv(t, fixed);
                if (p - self.face.point(contact)).norm() > reach {
                    return -1.0;
                }
                near = contact;
                let depth = layer.depth(p, &mut near);
                if depth <= 0.0 {
                    return depth;
                }
                before.iter().fold(depth, |d, pose| d.min(self.cutter.distance(pose, p)))
            };
            out.by_rate[pass] =
                outline.volume_mm3(&motion, ends, self.instants, depth).expect("inside the face");
            // Finer than the pass is swept: the scallops between frozen poses shall not count.
            let fine = 3 * POSES;
            before = (0..=fine)
                .map(|k| ends[0] + (ends[1] - ends[0]) * k as f64 / fine as f64)
                .map(|t| motion.at(t).expect("inside the face").pose)
                .collect();
        }
        out
    }
}
