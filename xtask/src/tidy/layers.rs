//! The direction of dependencies between the crates, from `cargo metadata`.

use super::finding::Finding;
use crate::cmd::Failure;
use serde_json::Value;

/// What a crate may depend on among the workspace's own packages.
struct Layer {
    package: &'static str,
    /// For use.
    normal: &'static [&'static str],
    /// For its tests, besides `normal`.
    dev: &'static [&'static str],
}

const GEOM: &str = "osculate-geom";
const SURFACES: &str = "osculate-surfaces";
const TOOLS: &str = "osculate-tools";
const PRODUCTIVITY: &str = "osculate-productivity";
const POSTPROC: &str = "osculate-postproc";

/// The layers, as ARCHITECTURE.md draws them. Tools, productivity and postproc see a surface through the trait in geom
/// only; their tests may build real ones.
const LAYERS: [Layer; 7] = [
    Layer { package: GEOM, normal: &[], dev: &[] },
    Layer { package: SURFACES, normal: &[GEOM], dev: &[] },
    Layer { package: TOOLS, normal: &[GEOM], dev: &[SURFACES] },
    Layer { package: PRODUCTIVITY, normal: &[GEOM, TOOLS], dev: &[SURFACES] },
    Layer { package: POSTPROC, normal: &[GEOM, TOOLS], dev: &[SURFACES] },
    Layer { package: "osculate", normal: &[GEOM, SURFACES, TOOLS, PRODUCTIVITY, POSTPROC], dev: &[] },
    Layer { package: "xtask", normal: &[], dev: &[] },
];

/// Every dependency between workspace packages goes in the direction that [`LAYERS`] allows, and no package is missing
/// from it.
pub fn direction(metadata: &str) -> Result<Vec<Finding>, Failure> {
    let answer =
        |why: String| Failure::Answer { line: "cargo metadata --no-deps --format-version 1".to_owned(), why };
    let json: Value = serde_json::from_str(metadata).map_err(|e| answer(e.to_string()))?;
    let packages = json["packages"].as_array().ok_or_else(|| answer("no array `packages`".to_owned()))?;
    let names: Vec<&str> = packages.iter().filter_map(|p| p["name"].as_str()).collect();
    let mut findings = Vec::new();
    for package in packages {
        let (Some(name), Some(dependencies)) = (package["name"].as_str(), package["dependencies"].as_array())
        else {
            return Err(answer("a package without name or dependencies".to_owned()));
        };
        let Some(layer) = LAYERS.iter().find(|l| l.package == name) else {
            findings.push(Finding::whole(
                name,
                "a package that the layers do not know: put the work into a folder of an existing crate",
            ));
            continue;
        };
        for dependency in dependencies {
            let Some(on) = dependency["name"].as_str() else {
                return Err(answer(format!("a dependency of {name} without a name")));
            };
            // A dependency without a kind is a normal one; build scripts count as normal.
            let is_dev = dependency["kind"].as_str() == Some("dev");
            let allowed = layer.normal.contains(&on) || (is_dev && layer.dev.contains(&on));
            if names.contains(&on) && !allowed {
                let kind = if is_dev { "dev-dependency" } else { "dependency" };
                findings.push(Finding::whole(name, format!("{kind} on {on} goes against the layers")));
            }
        }
    }
    let missing = LAYERS.iter().filter(|l| !names.contains(&l.package));
    findings.extend(missing.map(|l| Finding::whole(l.package, "not in the workspace any more")));
    Ok(findings)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Metadata of the seven packages, where `package` has one dependency of `kind` (JSON) `on` another.
    fn with(package: &str, kind: &str, on: &str) -> String {
        let entry = |l: &Layer| {
            let dependencies = if l.package == package {
                format!(r#"{{"name": "{on}", "kind": {kind}}}, {{"name": "nalgebra", "kind": null}}"#)
            } else {
                String::new()
            };
            format!(r#"{{"name": "{}", "dependencies": [{dependencies}]}}"#, l.package)
        };
        format!(r#"{{"packages": [{}]}}"#, LAYERS.iter().map(entry).collect::<Vec<_>>().join(","))
    }

    #[test]
    fn only_the_given_direction_passes() {
        let count = |package, kind, on| direction(&with(package, kind, on)).unwrap().len();
        for (package, kind, on, expected) in [
            (TOOLS, "null", GEOM, 0),
            (TOOLS, "null", SURFACES, 1),
            (TOOLS, "\"build\"", SURFACES, 1),
            (TOOLS, "\"dev\"", SURFACES, 0),
            (SURFACES, "\"dev\"", TOOLS, 1),
            (GEOM, "\"dev\"", SURFACES, 1),
            (GEOM, "null", TOOLS, 1),
            (POSTPROC, "null", PRODUCTIVITY, 1),
            ("osculate", "null", POSTPROC, 0),
            ("xtask", "null", GEOM, 1),
        ] {
            assert_eq!(count(package, kind, on), expected, "{package} on {on}, {kind}");
        }
    }

    #[test]
    fn unknown_and_missing_packages_are_found() {
        let eighth = with("xtask", "null", "nalgebra").replace(r#""name": "xtask""#, r#""name": "extra""#);
        let found = direction(&eighth).unwrap();
        assert_eq!(found.len(), 2);
        assert!(found[0].place == "extra" && found[1].place == "xtask");
    }

    #[test]
    fn metadata_that_is_none_is_an_error() {
        for text in ["", "{}", r#"{"packages": [{}]}"#, r#"{"packages": [{"name": "xtask"}]}"#] {
            assert!(direction(text).is_err(), "{text}");
        }
    }
}
