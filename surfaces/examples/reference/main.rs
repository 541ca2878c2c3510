//! The kernel against reference numbers: `cargo xtask reference --data FOLDER`.
//!
//! - `FOLDER/kernel`: jets, principal curvatures and directions of two bicubic surfaces at 120 places each, a
//!   thousand hard closest points each, the textbook examples of `refs.json`, and `one.step`;
//! - `FOLDER/truth`: 25 samples on every spline face of the collection that carries them.
//!
//! Errors of points and derivatives are relative to the size of the surface (and of its coordinates), those of
//! curvatures to the larger one or to one over the size, whichever is greater. The samples are printed with 13
//! digits of coordinates and 10 of curvatures. A number beyond its limit counts as an exception where a bound
//! from the digits printed, from the rounding of both programs or from what the file itself says explains it
//! ([`exceptions`]); exceptions are counted and named. Exit status 1 where a deviation is left without a reason.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a program that prints its findings")]

mod exceptions;
#[path = "../truth/reference.rs"]
#[allow(dead_code, reason = "areas and boxes are the other program's")]
mod reference;

use exceptions::Why;
use osculate_geom::{Axis, Point3, Surface, Vec3, uv};
use osculate_surfaces::{Net, NurbsCurve, NurbsSurface, closest};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Points and first derivatives.
const POINT: f64 = 1e-12;
/// Curvatures.
const CURVATURE: f64 = 1e-9;

/// Errors of one kind and how many there are.
#[derive(Default)]
struct Errors {
    all: Vec<(f64, String)>,
    /// Beyond the limit with a reason: how many, the largest error.
    excepted: BTreeMap<&'static str, (usize, f64)>,
}

impl Errors {
    fn add(&mut self, error: f64, place: impl Fn() -> String) {
        // A NaN counts as the worst.
        let error = if error.is_nan() { f64::INFINITY } else { error };
        self.all.push((error, if error > 1e-13 { place() } else { String::new() }));
    }

    /// Adds an error that may be beyond `limit` for a reason.
    fn add_unless(&mut self, error: f64, limit: f64, why: Option<Why>, place: impl Fn() -> String) {
        match why {
            Some(why) if error > limit && error <= why.bound => {
                let seen = self.excepted.entry(why.reason).or_default();
                *seen = (seen.0 + 1, seen.1.max(error));
            }
            _ => self.add(error, place),
        }
    }

    /// Prints the distribution and says whether all are within the limit.
    fn report(&mut self, what: &str, limit: f64) -> bool {
        self.all.sort_by(|a, b| b.0.total_cmp(&a.0));
        let beyond = self.all.partition_point(|e| e.0 > limit);
        let at = |q: f64| self.all.get(((self.all.len() as f64) * q) as usize).map_or(0.0, |e| e.0);
        println!(
            "{what:<38} {:>7}  limit {limit:.0e}  median {:.1e}  99 % {:.1e}  worst {:.1e}  beyond {beyond}",
            self.all.len(),
            at(0.5),
            at(0.01),
            at(0.0),
        );
        for (reason, (count, worst)) in &self.excepted {
            println!("    {count} exceptions up to {worst:.1e}: {reason}");
        }
        for (error, place) in self.all[..beyond].iter().take(12) {
            println!("    {error:.1e}  {place}");
        }
        beyond == 0
    }
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [flag, folder] = &arguments[..] else {
        eprintln!("usage: reference --data FOLDER");
        return ExitCode::from(2);
    };
    if flag != "--data" {
        eprintln!("usage: reference --data FOLDER");
        return ExitCode::from(2);
    }
    match run(Path::new(folder)) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(why) => {
            eprintln!("reference: {why}");
            ExitCode::from(2)
        }
    }
}

fn read(path: PathBuf) -> Result<String, String> {
    std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))
}

/// A surface of the kernel folder: `nu nv pu pv`, both knot vectors, then `x y z w` a pole, v fastest.
fn from_text(text: &str) -> Result<NurbsSurface, String> {
    let mut lines = text.lines();
    let mut next = || -> Vec<f64> {
        lines.next().unwrap_or_default().split_whitespace().filter_map(|x| x.parse().ok()).collect()
    };
    let (head, ku, kv) = (next(), next(), next());
    let [nu, nv, pu, pv] = head[..] else { return Err("a surface begins with four numbers".into()) };
    let rows: Vec<Vec<f64>> = (0..(nu * nv) as usize).map(|_| next()).collect();
    if rows.iter().any(|r| r.len() != 4) {
        return Err("a pole has four numbers".into());
    }
    let points = rows.iter().map(|r| Point3::new(r[0], r[1], r[2])).collect();
    let weights = Some(rows.iter().map(|r| r[3]).collect());
    let net = Net { count: [nu as usize, nv as usize], points, weights };
    NurbsSurface::new([pu as usize, pv as usize], [ku, kv], net).map_err(|e| e.to_string())
}

fn run(data: &Path) -> Result<bool, String> {
    let mut good = true;
    let kernel = data.join("kernel");
    for name in ["poly", "rat"] {
        let surface = from_text(&read(kernel.join(format!("surf_{name}.txt")))?)?;
        good &= vectors(name, &surface, &read(kernel.join(format!("vec_{name}.csv")))?);
        good &= far(name, &surface, &read(kernel.join(format!("far_{name}.txt")))?);
    }
    let text = read(kernel.join("refs.json"))?;
    good &= textbook(&serde_json::from_str(&text).map_err(|e| format!("refs.json: {e}"))?);
    good &= one_step(&kernel)?;
    good &= samples(data)?;
    Ok(good)
}

/// Jets to third order and curvatures.
fn vectors(name: &str, surface: &NurbsSurface, text: &str) -> bool {
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let size = surface.control_box().diagonal_mm();
    let mut errors: [Errors; 5] = Default::default();
    for line in lines.filter(|l| !l.is_empty()) {
        let row: Vec<f64> = line.split(',').filter_map(|x| x.parse().ok()).collect();
        let at = |n: &str| {
            names.iter().position(|x| *x == n).and_then(|k| row.get(k)).copied().unwrap_or(f64::NAN)
        };
        let vector = |n: &str| Vec3::new(at(&format!("{n}_x")), at(&format!("{n}_y")), at(&format!("{n}_z")));
        let place = || format!("{name} at u = {}, v = {}", at("u"), at("v"));
        let jet = surface.jet3(uv(at("u"), at("v")));
        let j = jet.jet2;
        let orders: [(&str, usize, Vec3); 10] = [
            ("S", 0, j.point.coords),
            ("Su", 1, j.du),
            ("Sv", 1, j.dv),
            ("Suu", 2, j.duu),
            ("Suv", 2, j.duv),
            ("Svv", 2, j.dvv),
            ("Suuu", 3, jet.duuu),
            ("Suuv", 3, jet.duuv),
            ("Suvv", 3, jet.duvv),
            ("Svvv", 3, jet.dvvv),
        ];
        for (n, order, got) in orders {
            let want = vector(n);
            errors[order].add((got - want).norm() / size.max(want.norm()), || format!("{n} of {}", place()));
        }
        let Ok(forms) = j.forms() else { return false };
        let p = forms.principal();
        // The reference counts bending towards the normal as positive.
        let (k_max, k_min) = (-at("kmin"), -at("kmax"));
        let scale = k_max.abs().max(k_min.abs()).max(1.0 / size);
        errors[4].add((p.k_max - k_max).abs() / scale, place);
        errors[4].add((p.k_min - k_min).abs() / scale, place);
    }
    let titles = ["points", "first derivatives", "second derivatives", "third derivatives", "curvatures"];
    let limits = [POINT, POINT, POINT, CURVATURE, CURVATURE];
    let mut good = true;
    for ((e, title), limit) in errors.iter_mut().zip(titles).zip(limits) {
        good &= !e.all.is_empty() & e.report(&format!("vec_{name}.csv: {title}"), limit);
    }
    good
}

/// The thousand hard closest points: none farther than the reference.
fn far(name: &str, surface: &NurbsSurface, text: &str) -> bool {
    let mut farther = Errors::default();
    for line in text.lines().skip(1).filter(|l| !l.is_empty()) {
        let v: Vec<f64> = line.split_whitespace().filter_map(|x| x.parse().ok()).collect();
        let excess = match closest(surface, &Point3::new(v[0], v[1], v[2]), None) {
            Ok(foot) => (foot.distance_mm / v[3] - 1.0).max(foot.gap_mm / v[3]),
            Err(_) => f64::INFINITY,
        };
        farther.add(excess.max(0.0), || line.to_owned());
    }
    farther.all.len() == 1000 && farther.report(&format!("far_{name}.txt: farther than known"), CURVATURE)
}

fn list(value: &Value) -> Vec<f64> {
    value.as_array().map(|a| a.iter().filter_map(Value::as_f64).collect()).unwrap_or_default()
}

fn rows(value: &Value) -> Vec<Vec<f64>> {
    value.as_array().map(|a| a.iter().map(list).collect()).unwrap_or_default()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

/// The examples of the NURBS Book and two surfaces with published derivatives (ten digits).
fn textbook(json: &Value) -> bool {
    let (mut exact, mut published) = (Errors::default(), Errors::default());
    let curve = |c: &Value| {
        let poles = rows(&c["P"]).iter().map(|p| nalgebra::Point2::new(p[0], p[1])).collect();
        NurbsCurve::<2>::new(number(&c["p"]) as usize, list(&c["knots"]), poles, Some(list(&c["w"]))).ok()
    };
    let off =
        |got: nalgebra::Vector2<f64>, want: &[f64]| (got - nalgebra::Vector2::new(want[0], want[1])).norm();
    if let Some(c) = curve(&json["ex4.1"]) {
        let got = c.point(number(&json["ex4.1"]["u"])).coords;
        exact.add(off(got, &list(&json["ex4.1"]["C"])), || "example 4.1".into());
    }
    if let Some(c) = curve(&json["ex4.2"]) {
        for (t, name) in [(0.0, "d0"), (1.0, "d1")] {
            let (j, want) = (c.jet(t), rows(&json["ex4.2"][name]));
            for (got, want) in [j.point.coords, j.first, j.second].into_iter().zip(&want) {
                exact.add(off(got, want), || format!("example 4.2 at {t}"));
            }
        }
    }
    // Example 4.3 gives the nine poles that act on the place asked for; its knots are those of example 2.3.
    let book = &json["ex4.3"];
    let mut net = Net { count: [8, 5], points: vec![Point3::origin(); 40], weights: Some(vec![1.0; 40]) };
    for (key, value) in book["active"].as_object().into_iter().flatten() {
        let ij: Vec<usize> =
            key.trim_matches(['(', ')']).split(',').filter_map(|x| x.trim().parse().ok()).collect();
        let p = list(&value[0]);
        let k = ij[0] * 5 + ij[1];
        net.points[k] = Point3::new(p[0], p[1], p[2]);
        if let Some(w) = &mut net.weights {
            w[k] = number(&value[1]);
        }
    }
    let ku = vec![0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 4.0, 5.0, 5.0, 5.0];
    let kv = vec![0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 3.0, 3.0];
    if let Ok(s) = NurbsSurface::new([2, 2], [ku, kv], net) {
        let want = list(&book["S"]);
        let got = s.point(uv(number(&book["u"]), number(&book["v"]))).coords;
        exact.add((got - Vec3::new(want[0], want[1], want[2])).norm() / got.norm(), || "example 4.3".into());
    }
    for name in ["anurbs_poly", "anurbs_rational"] {
        let v = &json[name];
        let points: Vec<Point3> = rows(&v["P"]).iter().map(|p| Point3::new(p[0], p[1], p[2])).collect();
        let (ku, kv) = (list(&v["knots_u"]), list(&v["knots_v"]));
        let degree = [number(&v["pu"]) as usize, number(&v["pv"]) as usize];
        let count = [ku.len() - degree[0] - 1, kv.len() - degree[1] - 1];
        let net = Net { count, points, weights: Some(list(&v["w"])) };
        let Ok(s) = NurbsSurface::new(degree, [ku, kv], net) else { return false };
        let j = s.jet2(uv(number(&v["u"]), number(&v["v"])));
        let want = rows(&v["ders_S_u_v_uu_uv_vv"]);
        for (got, want) in [j.point.coords, j.du, j.dv, j.duu, j.duv, j.dvv].into_iter().zip(&want) {
            published.add((got - Vec3::new(want[0], want[1], want[2])).norm(), || name.to_owned());
        }
    }
    let complete = exact.all.len() == 8 && published.all.len() == 12;
    complete & exact.report("refs.json: NURBS Book", POINT) & published.report("refs.json: ten digits", 1e-10)
}

/// The one rational face, against the surface it was written from.
fn one_step(kernel: &Path) -> Result<bool, String> {
    let part = osculate_surfaces::read(read(kernel.join("one.step"))?.as_bytes())
        .map_err(|e| format!("one.step: {e}"))?;
    let same = from_text(&read(kernel.join("surf_rat.txt"))?)?;
    let mut errors = Errors::default();
    let Some(s) = part.faces.first().and_then(|f| f.carrier.nurbs()) else {
        return Err("one.step has no spline face".into());
    };
    let size = same.control_box().diagonal_mm();
    let digits = exceptions::poles(s, &same);
    for k in 0..400 {
        let (f, g) = (f64::from(k % 20) / 19.0, f64::from(k / 20) / 19.0);
        let (a, b) = (s.jet2(s.domain().at(f, g)), same.jet2(same.domain().at(f, g)));
        errors.add((a.point - b.point).norm() / size, || format!("one.step at {f}, {g}"));
        let (off, scale) = ((a.du - b.du).norm(), b.du.norm().max(size));
        let why = Why { bound: digits.bound / scale, ..digits };
        errors.add_unless(off / scale, POINT, Some(why), || format!("S_u of one.step at {f}, {g}"));
    }
    Ok(errors.report("one.step", POINT))
}

/// The samples of the collection's spline faces.
fn samples(data: &Path) -> Result<bool, String> {
    let (mut points, mut curvatures) = (Errors::default(), Errors::default());
    let (mut faces, mut missing) = (0, 0);
    for entry in reference::entries(data, false)? {
        let reference::Reference::Shape(reference) = &entry.reference else { continue };
        let bytes = std::fs::read(data.join("files").join(&entry.file))
            .map_err(|e| format!("{}: {e}", entry.file))?;
        let Ok(part) = osculate_surfaces::read(&bytes) else {
            missing += reference.faces.iter().filter(|f| !f.samples.is_empty()).count();
            continue;
        };
        for face in reference.faces.iter().filter(|f| !f.samples.is_empty()) {
            // A face may stand in several places: the one meant is the one that the first sample lies on.
            let off = |s: &NurbsSurface| {
                let first = &face.samples[0];
                (s.point(uv(first.uv[0], first.uv[1])) - Point3::from(first.point_mm)).norm()
            };
            let same = part.faces.iter().filter(|f| Some(f.entity) == face.id);
            let ours = same.filter_map(|f| f.carrier.nurbs()).min_by(|a, b| off(a).total_cmp(&off(b)));
            let Some(s) = ours else {
                missing += 1;
                continue;
            };
            faces += 1;
            let size = s.control_box().diagonal_mm();
            let units = exceptions::UNITS.iter().find(|(file, ..)| *file == entry.file);
            let factor = units.map_or(1.0, |(_, factor, why)| {
                println!("{}: compared after division by {factor}: {why}", entry.file);
                *factor
            });
            for sample in &face.samples {
                let at = uv(sample.uv[0], sample.uv[1]);
                let place = || format!("{} face {:?} at u = {}, v = {}", entry.file, face.id, at.u, at.v);
                let jet = s.jet2(at);
                let want = Point3::from(sample.point_mm) / factor;
                let scale = size.max(want.coords.norm());
                let why = exceptions::point(&jet, scale);
                points.add_unless((jet.point - want).norm() / scale, POINT, Some(why), place);
                let (Some(curvature), Ok(forms)) = (sample.curvature_per_mm, jet.forms()) else {
                    continue;
                };
                let [k_max, k_min] = curvature.map(|k| k * factor);
                // Curvatures jump at a knot: the reference may stand on its other side.
                let on_knot = |axis: Axis, t: f64| {
                    s.breaks(axis).iter().any(|b| (b - t).abs() <= 1e-9 * s.domain().get(axis).length())
                };
                if on_knot(Axis::U, at.u) || on_knot(Axis::V, at.v) {
                    continue;
                }
                let p = forms.principal();
                let natural = if s.side() == osculate_geom::Side::Along { 1.0 } else { -1.0 };
                let (got_max, got_min) =
                    if natural > 0.0 { (-p.k_min, -p.k_max) } else { (p.k_max, p.k_min) };
                let scale = k_max.abs().max(k_min.abs()).max(1.0 / size);
                let off = (got_max - k_max).abs().max((got_min - k_min).abs());
                let why = exceptions::curvature(s, &jet, scale);
                curvatures.add_unless(off / scale, CURVATURE, why, || {
                    let sine = jet.du.cross(&jet.dv).norm() / (jet.du.norm() * jet.dv.norm());
                    let bound = why.map_or(0.0, |w| w.bound);
                    format!("{} (explained {bound:.1e}): ours {got_max:.9e} {got_min:.9e}, theirs {k_max:.9e} {k_min:.9e}, sine {sine:.1e}", place())
                });
            }
        }
    }
    println!("truth: {faces} spline faces with samples, {missing} more not read as such");
    let good = points.report("truth: points", POINT);
    Ok(curvatures.report("truth: curvatures", CURVATURE) && good)
}
