//! Built-in surfaces as written in jobs and on the command line.

use crate::job::words::{nearest, not_known};
use osculate_geom::analytic::{Cone, Cylinder, Ellipsoid, Paraboloid, Plane, Sphere, Torus};
use osculate_geom::{Curve, Domain, Interval, Patch, Point3, Side, Surface};
use osculate_surfaces::gallery::{
    self, FormulaCurve, LiuSize, ParaboloidSize, liu_directrices, paraboloid_directrices,
};
use osculate_surfaces::{Net, NurbsSurface};
use serde::Deserialize;
use std::sync::Arc;

/// A built-in surface's keys.
#[derive(Debug, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
enum Keys {
    Plane {
        half_size_mm: Option<f64>,
        #[serde(default)]
        material: Material,
        u_range: Option<[f64; 2]>,
        v_range: Option<[f64; 2]>,
    },
    Cylinder {
        radius_mm: f64,
        height_mm: Option<f64>,
        #[serde(default)]
        material: Material,
        u_range: Option<[f64; 2]>,
        v_range: Option<[f64; 2]>,
    },
    Cone {
        radius_mm: f64,
        half_angle_deg: f64,
        height_mm: Option<f64>,
        #[serde(default)]
        material: Material,
        u_range: Option<[f64; 2]>,
        v_range: Option<[f64; 2]>,
    },
    Sphere {
        radius_mm: f64,
        #[serde(default)]
        material: Material,
        u_range: Option<[f64; 2]>,
        v_range: Option<[f64; 2]>,
    },
    Torus {
        major_radius_mm: f64,
        minor_radius_mm: f64,
        #[serde(default)]
        material: Material,
        u_range: Option<[f64; 2]>,
        v_range: Option<[f64; 2]>,
    },
    Ellipsoid {
        semi_axes_mm: [f64; 3],
        #[serde(default)]
        material: Material,
        u_range: Option<[f64; 2]>,
        v_range: Option<[f64; 2]>,
    },
    #[serde(rename = "m86-1")]
    M86One(Cut),
    #[serde(rename = "m86-2")]
    M86Two(Cut),
    #[serde(rename = "m86-3")]
    M86Three(Cut),
    #[serde(rename = "m86-4")]
    M86Four(Cut),
    #[serde(rename = "d98-eq18")]
    D98Eq18(Cut),
    #[serde(rename = "d98-liu")]
    D98Liu {
        line_mm: Option<f64>,
        bend_per_mm: Option<f64>,
        height_mm: Option<f64>,
        end_mm: Option<f64>,
        #[serde(default)]
        material: Material,
        u_range: Option<[f64; 2]>,
        v_range: Option<[f64; 2]>,
    },
    #[serde(rename = "d98-hyperbolic")]
    D98Hyperbolic {
        h_mm: f64,
        alpha_deg: f64,
        extent_mm: Option<f64>,
        #[serde(default)]
        material: Material,
        u_range: Option<[f64; 2]>,
        v_range: Option<[f64; 2]>,
    },
    MonkeySaddle(Cut),
    Enneper(Cut),
    Paraboloid {
        a_per_mm: f64,
        b_per_mm: f64,
        half_size_mm: Option<f64>,
        #[serde(default)]
        material: Material,
        u_range: Option<[f64; 2]>,
        v_range: Option<[f64; 2]>,
    },
}

/// The keys that every built-in takes.
#[derive(Debug, Clone, Copy, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Cut {
    #[serde(default)]
    material: Material,
    u_range: Option<[f64; 2]>,
    v_range: Option<[f64; 2]>,
}

/// Which side of the surface the material is on. For open surfaces inside means below (z smaller).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Material {
    #[default]
    Inside,
    Outside,
}

impl Material {
    const fn side(self) -> Side {
        match self {
            Self::Inside => Side::Along,
            Self::Outside => Side::Against,
        }
    }
}

/// A built-in surface with its name.
#[derive(Clone)]
#[non_exhaustive]
pub struct Builtin {
    /// The kind.
    pub kind: &'static str,
    /// The surface.
    pub surface: Arc<dyn Surface>,
    /// The same as a spline, where it is one.
    pub spline: Option<Arc<NurbsSurface>>,
}

impl std::fmt::Debug for Builtin {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Builtin").field("kind", &self.kind).finish_non_exhaustive()
    }
}

fn no_range(key: &str, [lo, hi]: [f64; 2]) -> String {
    format!("{key} = [{lo}, {hi}] must be two finite numbers, the lower one first")
}

/// The rectangle that the ranges leave of a surface's own one.
fn cut_domain(kind: &str, whole: Domain, ranges: [Option<[f64; 2]>; 2]) -> Result<Domain, String> {
    let cut = |key: &str, i: Interval, r: Option<[f64; 2]>| match r {
        None => Ok(i),
        Some([lo, hi]) if lo.is_finite() && hi.is_finite() && lo < hi => {
            let length = hi - lo;
            // A full turn still closes; a part of it, or a range that a closed parameter shifts, does not.
            if i.periodic && (length - i.length()).abs() <= 1e-12 * i.length() {
                Ok(Interval::periodic(lo, hi))
            } else if i.periodic && length > i.length() {
                Err(format!("{key} = [{lo}, {hi}] is longer than a full turn"))
            } else if i.periodic || (lo >= i.lo - 1e-12 && hi <= i.hi + 1e-12) {
                Ok(Interval::new(lo, hi))
            } else {
                Err(format!("{key} = [{lo}, {hi}] leaves the parameters of the {kind}, [{}, {}]", i.lo, i.hi))
            }
        }
        Some(r) => Err(no_range(key, r)),
    };
    Ok(Domain { u: cut("u_range", whole.u, ranges[0])?, v: cut("v_range", whole.v, ranges[1])? })
}

fn patch<S: Surface + 'static>(
    kind: &'static str,
    surface: S,
    material: Material,
    ranges: [Option<[f64; 2]>; 2],
) -> Result<Builtin, String> {
    let domain = cut_domain(kind, surface.domain(), ranges)?;
    Ok(Builtin { kind, surface: Arc::new(Patch { surface, domain, side: material.side() }), spline: None })
}

/// A spline, cut to its ranges.
fn spline(kind: &'static str, surface: NurbsSurface, cut: Cut) -> Result<Builtin, String> {
    let domain = cut_domain(kind, surface.domain(), [cut.u_range, cut.v_range])?;
    let piece = surface.restricted(&domain).map_err(|e| e.to_string())?.with_side(cut.material.side());
    let piece = Arc::new(piece);
    Ok(Builtin { kind, surface: piece.clone(), spline: Some(piece) })
}

/// The ruled spline between two polynomial curves of a degree over the same range.
fn between(
    kind: &'static str,
    curves: [FormulaCurve; 2],
    degree: usize,
    cut: Cut,
) -> Result<Builtin, String> {
    let i = curves[0].domain();
    // Bezier poles of a polynomial of degree 1 or 2 from its ends and the derivative at its start.
    let poles = curves.map(|c| {
        let t = c.taylor(i.lo, 1);
        let mut p = vec![Point3::from(t.derivative(0))];
        if degree == 2 {
            p.push(p[0] + t.derivative(1) * (0.5 * i.length()));
        }
        p.push(c.point(i.hi));
        p
    });
    let points: Vec<Point3> = poles[0].iter().zip(&poles[1]).flat_map(|(a, b)| [*a, *b]).collect();
    let net = Net { count: [degree + 1, 2], points, weights: None };
    let knots = |lo: f64, hi: f64, n: usize| [vec![lo; n], vec![hi; n]].concat();
    let surface = NurbsSurface::new([degree, 1], [knots(i.lo, i.hi, degree + 1), knots(0.0, 1.0, 2)], net)
        .map_err(|e| e.to_string())?;
    spline(kind, surface, cut)
}

/// A size that must be positive.
fn size(key: &str, v: f64) -> Result<f64, String> {
    if v.is_finite() && v > 0.0 { Ok(v) } else { Err(format!("{key} must be positive and finite, got {v}")) }
}

/// Half the side of the square about the origin: as given, or so that it holds both ranges.
fn half_size(given: Option<f64>, ranges: [Option<[f64; 2]>; 2]) -> Result<f64, String> {
    match (given, ranges) {
        (Some(half), _) => size("half_size_mm", half),
        (None, [Some(u), Some(v)]) => {
            let largest = [u, v].concat().iter().fold(0.0f64, |most, x| most.max(x.abs()));
            size("the largest of u_range and v_range", largest)
        }
        _ => Err("give half_size_mm, or both u_range and v_range".into()),
    }
}

/// The parameter along a straight side: from the start to a length, or the range itself.
fn along(length_mm: Option<Result<f64, String>>, v_range: Option<[f64; 2]>) -> Result<Interval, String> {
    match (length_mm, v_range) {
        (Some(length), _) => Ok(Interval::new(0.0, length?)),
        (None, Some([lo, hi])) if lo.is_finite() && hi.is_finite() && lo < hi => Ok(Interval::new(lo, hi)),
        (None, Some(r)) => Err(no_range("v_range", r)),
        (None, None) => Err("give height_mm or v_range".into()),
    }
}

/// The surface that the keys describe.
pub fn build(keys: &toml::Table) -> Result<Builtin, String> {
    let keys: Keys = keys.clone().try_into().map_err(|e: toml::de::Error| e.message().to_owned())?;
    let say = |e: osculate_geom::analytic::BadSize| e.to_string();
    match keys {
        Keys::Plane { half_size_mm, material, u_range, v_range } => {
            let h = half_size(half_size_mm, [u_range, v_range])?;
            let i = Interval::new(-h, h);
            patch("plane", Plane::new(Domain { u: i, v: i }), material, [u_range, v_range])
        }
        Keys::Cylinder { radius_mm, height_mm, material, u_range, v_range } => {
            let z = along(height_mm.map(|h| size("height_mm", h)), v_range)?;
            patch("cylinder", Cylinder::new(radius_mm, z).map_err(say)?, material, [u_range, v_range])
        }
        Keys::Cone { radius_mm, half_angle_deg, height_mm, material, u_range, v_range } => {
            let angle = half_angle_deg.to_radians();
            let v = along(height_mm.map(|h| Ok(size("height_mm", h)? / angle.cos())), v_range)?;
            patch("cone", Cone::new(radius_mm, angle, v).map_err(say)?, material, [u_range, v_range])
        }
        Keys::Sphere { radius_mm, material, u_range, v_range } => {
            patch("sphere", Sphere::new(radius_mm).map_err(say)?, material, [u_range, v_range])
        }
        Keys::Torus { major_radius_mm, minor_radius_mm, material, u_range, v_range } => {
            let torus = Torus::new(major_radius_mm, minor_radius_mm).map_err(say)?;
            patch("torus", torus, material, [u_range, v_range])
        }
        Keys::Ellipsoid { semi_axes_mm, material, u_range, v_range } => {
            patch("ellipsoid", Ellipsoid::new(semi_axes_mm).map_err(say)?, material, [u_range, v_range])
        }
        Keys::M86One(cut) => spline("m86-1", gallery::m86(1), cut),
        Keys::M86Two(cut) => spline("m86-2", gallery::m86(2), cut),
        Keys::M86Three(cut) => spline("m86-3", gallery::m86(3), cut),
        Keys::M86Four(cut) => spline("m86-4", gallery::m86(4), cut),
        Keys::D98Eq18(cut) => {
            patch("d98-eq18", gallery::d98_eq18(), cut.material, [cut.u_range, cut.v_range])
        }
        Keys::D98Liu { line_mm, bend_per_mm, height_mm, end_mm, material, u_range, v_range } => {
            let d = LiuSize::default();
            let given = LiuSize {
                line_mm: line_mm.unwrap_or(d.line_mm),
                bend_per_mm: bend_per_mm.unwrap_or(d.bend_per_mm),
                height_mm: size("height_mm", height_mm.unwrap_or(d.height_mm))?,
                end_mm: size("end_mm", end_mm.unwrap_or(d.end_mm))?,
            };
            between("d98-liu", liu_directrices(given), 2, Cut { material, u_range, v_range })
        }
        Keys::D98Hyperbolic { h_mm, alpha_deg, extent_mm, material, u_range, v_range } => {
            let given = ParaboloidSize {
                height_mm: size("h_mm", h_mm)?,
                half_twist_rad: alpha_deg.to_radians(),
                extent_mm: size("extent_mm", extent_mm.unwrap_or(h_mm))?,
            };
            let curves = paraboloid_directrices(given).map_err(|e| match e.what {
                "half_twist" => format!("alpha_deg = {alpha_deg} must be {}", e.need),
                _ => e.to_string(),
            })?;
            between("d98-hyperbolic", curves, 1, Cut { material, u_range, v_range })
        }
        Keys::MonkeySaddle(cut) => spline("monkey_saddle", gallery::monkey_saddle(), cut),
        Keys::Enneper(cut) => spline("enneper", gallery::enneper(), cut),
        Keys::Paraboloid { a_per_mm, b_per_mm, half_size_mm, material, u_range, v_range } => {
            let h = half_size(half_size_mm, [u_range, v_range])?;
            let p = Paraboloid::new([a_per_mm, b_per_mm], h).map_err(say)?;
            patch("paraboloid", p, material, [u_range, v_range])
        }
    }
}

/// The surface of a `--builtin` argument: the keys of a TOML table, separated by commas.
pub fn parse(keys: &str) -> Result<Builtin, String> {
    let text = format!("builtin = {{ {keys} }}");
    let table: toml::Table =
        toml::from_str(&text).map_err(|e| format!("--builtin '{keys}': {}", e.message()))?;
    match table.get("builtin") {
        Some(toml::Value::Table(t)) => build(t).map_err(|e| match not_known(&e) {
            Some((kind, written, known)) => {
                let near = nearest(written, known.iter().copied());
                let meant = near.map(|n| format!(" (is {n} meant?)")).unwrap_or_default();
                format!("--builtin: there is no {kind} {written}{meant}; there are {}", known.join(", "))
            }
            None => format!("--builtin: {e}"),
        }),
        _ => Err(format!("--builtin '{keys}' is not a list of keys")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use osculate_geom::uv;

    #[test]
    fn torus_sides_and_ranges() {
        let t = parse(
            "kind = \"torus\", major_radius_mm = 200, minor_radius_mm = 60, material = \"outside\", u_range = [0, 0.3]",
        )
        .unwrap();
        let jet = t.surface.jet2(uv(0.0, std::f64::consts::PI));
        assert!((jet.point.x - 140.0).abs() < 1e-12);
        // A groove: the normal points into the tube, away from the axis.
        assert!((jet.normal().unwrap().x - 1.0).abs() < 1e-12);
        assert!(!t.surface.contains(uv(0.4, 0.0)) && t.surface.contains(uv(0.2, 9.0)));
    }

    #[test]
    fn every_surface_of_the_gallery_can_be_built() {
        for e in gallery::ENTRIES {
            let comma = if e.keys.is_empty() { "" } else { ", " };
            let b = parse(&format!("kind = \"{}\"{comma}{}", e.name, e.keys)).unwrap();
            assert_eq!(b.kind, e.name);
            let d = b.surface.domain();
            assert!(b.surface.jet2(d.at(0.4, 0.6)).forms().is_ok());
        }
        let piece = parse("kind = \"m86-4\", u_range = [0.25, 0.75]").unwrap();
        assert_eq!(piece.spline.unwrap().domain().u.lo, 0.25);
    }

    /// Ranges say the size of what has no size of its own.
    #[test]
    fn ranges_stand_for_sizes() {
        let size = |keys: &str| {
            let d = parse(keys).unwrap().surface.domain();
            [d.u.lo, d.u.hi, d.v.lo, d.v.hi]
        };
        assert_eq!(
            size("kind = \"plane\", u_range = [0, 100], v_range = [-5, 20]"),
            [0.0, 100.0, -5.0, 20.0]
        );
        let bowl =
            "kind = \"paraboloid\", a_per_mm = 0.1, b_per_mm = 0.2, u_range = [-3, 2], v_range = [1, 4]";
        assert_eq!(size(bowl), [-3.0, 2.0, 1.0, 4.0]);
        assert_eq!(size("kind = \"cylinder\", radius_mm = 2, v_range = [-5, 20]")[2..], [-5.0, 20.0]);
        let cone = "kind = \"cone\", radius_mm = 9, half_angle_deg = 10, v_range = [1, 2]";
        assert_eq!(size(cone)[2..], [1.0, 2.0]);
    }

    #[test]
    fn mistakes_are_named() {
        for (keys, word) in [
            ("kind = \"donut\"", "donut"),
            ("kind = \"sphere\", radius_mm = -1", "radius_mm"),
            ("kind = \"sphere\", radius = 1", "radius"),
            ("kind = \"sphere\", radius_mm = 1, v_range = [0, 9]", "v_range"),
            ("kind = \"torus\", major_radius_mm = 2", "minor_radius_mm"),
            ("kind = \"plane\", u_range = [0, 1]", "v_range"),
            ("kind = \"plane\", u_range = [0, 1], v_range = [1, nan]", "v_range"),
            ("kind = \"cylinder\", radius_mm = 2", "height_mm"),
            ("kind = \"cylinder\", radius_mm = 2, v_range = [2, 1]", "v_range"),
            ("kind = ", "--builtin"),
        ] {
            let error = parse(keys).err().unwrap();
            assert!(error.contains(word), "{error}");
        }
    }
}
