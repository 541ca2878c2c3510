//! Built-in surfaces as written in jobs and on the command line.

use osculate_geom::analytic::{Cone, Cylinder, Ellipsoid, Paraboloid, Plane, Sphere, Torus};
use osculate_geom::{Domain, Interval, Patch, Side, Surface};
use serde::Deserialize;
use std::sync::Arc;

/// A built-in surface's keys.
#[derive(Debug, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
enum Keys {
    Plane {
        half_size_mm: f64,
        #[serde(default)]
        material: Material,
        u_range: Option<[f64; 2]>,
        v_range: Option<[f64; 2]>,
    },
    Cylinder {
        radius_mm: f64,
        height_mm: f64,
        #[serde(default)]
        material: Material,
        u_range: Option<[f64; 2]>,
        v_range: Option<[f64; 2]>,
    },
    Cone {
        radius_mm: f64,
        half_angle_deg: f64,
        height_mm: f64,
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
    Paraboloid {
        a_per_mm: f64,
        b_per_mm: f64,
        half_size_mm: f64,
        #[serde(default)]
        material: Material,
        u_range: Option<[f64; 2]>,
        v_range: Option<[f64; 2]>,
    },
}

/// Which side of the surface the material is on. For open surfaces inside means below (z smaller).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Material {
    #[default]
    Inside,
    Outside,
}

/// A built-in surface with its name.
pub struct Builtin {
    /// The kind.
    pub kind: &'static str,
    /// The surface.
    pub surface: Arc<dyn Surface>,
}

fn patch<S: Surface + 'static>(
    kind: &'static str,
    surface: S,
    material: Material,
    ranges: [Option<[f64; 2]>; 2],
) -> Result<Builtin, String> {
    let whole = surface.domain();
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
        Some([lo, hi]) => {
            Err(format!("{key} = [{lo}, {hi}] must be two finite numbers, the lower one first"))
        }
    };
    let domain = Domain { u: cut("u_range", whole.u, ranges[0])?, v: cut("v_range", whole.v, ranges[1])? };
    let side = match material {
        Material::Inside => Side::Along,
        Material::Outside => Side::Against,
    };
    Ok(Builtin { kind, surface: Arc::new(Patch { surface, domain, side }) })
}

/// The surface that the keys describe.
pub fn build(keys: &toml::Table) -> Result<Builtin, String> {
    let keys: Keys = keys.clone().try_into().map_err(|e: toml::de::Error| e.message().to_owned())?;
    let say = |e: osculate_geom::analytic::BadSize| e.to_string();
    let size = |key: &str, v: f64| {
        if v.is_finite() && v > 0.0 {
            Ok(v)
        } else {
            Err(format!("{key} must be positive and finite, got {v}"))
        }
    };
    match keys {
        Keys::Plane { half_size_mm, material, u_range, v_range } => {
            let h = size("half_size_mm", half_size_mm)?;
            let i = Interval::new(-h, h);
            patch("plane", Plane::new(Domain { u: i, v: i }), material, [u_range, v_range])
        }
        Keys::Cylinder { radius_mm, height_mm, material, u_range, v_range } => {
            let z = Interval::new(0.0, size("height_mm", height_mm)?);
            patch("cylinder", Cylinder::new(radius_mm, z).map_err(say)?, material, [u_range, v_range])
        }
        Keys::Cone { radius_mm, half_angle_deg, height_mm, material, u_range, v_range } => {
            let angle = half_angle_deg.to_radians();
            let v = Interval::new(0.0, size("height_mm", height_mm)? / angle.cos());
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
        Keys::Paraboloid { a_per_mm, b_per_mm, half_size_mm, material, u_range, v_range } => {
            let p = Paraboloid::new([a_per_mm, b_per_mm], half_size_mm).map_err(say)?;
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
        Some(toml::Value::Table(t)) => build(t).map_err(|e| format!("--builtin: {e}")),
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
    fn mistakes_are_named() {
        for (keys, word) in [
            ("kind = \"donut\"", "donut"),
            ("kind = \"sphere\", radius_mm = -1", "radius_mm"),
            ("kind = \"sphere\", radius = 1", "radius"),
            ("kind = \"sphere\", radius_mm = 1, v_range = [0, 9]", "v_range"),
            ("kind = \"torus\", major_radius_mm = 2", "minor_radius_mm"),
            ("kind = ", "--builtin"),
        ] {
            let error = parse(keys).err().unwrap();
            assert!(error.contains(word), "{error}");
        }
    }
}
