//! A first job from the example parts alone.

use crate::common;
use common::{Scratch, osculate};

fn example(path: &str) -> String {
    format!("{}/../examples/{path}", env!("CARGO_MANIFEST_DIR"))
}

/// The blades of a propeller that look up, from above, with what the hub hides from a ball accepted; the job is one that can be meant, and
/// is not written over.
#[test]
fn a_first_job_can_be_meant() {
    let scratch = Scratch::new();
    let out = scratch.path("first");
    let folder = out.display().to_string();
    let part = example("propeller/propeller.step");
    let run = osculate(&["init", &part, "--faces", "F7,F12", "--out", &folder, "--json"]);
    assert_eq!(run.code, 0, "{}", run.err);
    assert_eq!(run.json()["faces"], serde_json::json!(["F7", "F12"]));
    let path = out.join("job.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let read: toml::Table = text.parse().unwrap();
    assert_eq!(read["operation"].as_array().unwrap().len(), 1, "{text}");
    assert_eq!(read["operation"][0]["strategy"]["axis"], toml::Value::from(vec![0, 1, 0]));
    assert_eq!(read["tool"][0]["kind"].as_str(), Some("ball"));
    assert!(
        read["tolerance"]["unreached_mm2"]
            .as_float()
            .or(read["tolerance"]["unreached_mm2"].as_integer().map(|x| x as f64))
            .unwrap()
            > 1.0
    );
    // Every table is explained.
    for words in [
        "# As asked for.",
        "# Estimated area that the tool does not reach",
        "# The part's ",
        "# Half of the tolerance",
    ] {
        assert!(text.contains(words), "'{words}' is missing in {text}");
    }
    let check = osculate(&["check", &path.display().to_string(), "--json"]);
    assert_eq!(check.code, 0, "{}{}", check.out, check.err);
    let said = check.json();
    assert_eq!(said["faces"], serde_json::json!([2, 18]));
    let [reached, area] = ["reached_mm2", "area_mm2"].map(|k| said["reached"][0][k].as_f64().unwrap());
    // Both faces are 5543.6 mm2, by their places within two per cent; beside the hub a ball does not come.
    assert!(
        (area - 5543.6).abs() < 0.02 * 5543.6 && reached > 0.93 * area && reached < area,
        "{reached} {area}"
    );
    osculate(&["init", &part, "--out", &folder]).refused(&["job.toml", "is there already"]);
    // Without the marks it begins with the block: the part's box is 260.3 x 11.2 x 49.8 mm, and 1 mm and a tenth at most stand over it.
    let unmarked: String = text
        .lines()
        .map(|l| l.strip_prefix('#').filter(|l| !l.starts_with(' ')).unwrap_or(l).to_owned() + "\n")
        .collect();
    let read: toml::Table = unmarked.parse().unwrap();
    let corners: Vec<f64> = read["stock"]["box_mm"]
        .as_array()
        .unwrap()
        .iter()
        .map(|x| x.as_float().or(x.as_integer().map(|x| x as f64)).unwrap())
        .collect();
    for (k, size) in [260.3, 11.2, 49.8].iter().enumerate() {
        let over = corners[k + 3] - corners[k] - size;
        assert!((1.85..2.4).contains(&over), "{corners:?}");
    }
    let block = scratch.write("first/block.toml", &unmarked);
    let check = osculate(&["check", &block.display().to_string(), "--json"]);
    assert_eq!(check.code, 0, "{}{}", check.out, check.err);
    assert!(!check.json()["unset"].to_string().contains("[stock]"));
}

/// The hull's file says where the material is; a face of the blade's sections does not, and the job says what it is taken to be.
#[test]
fn sheets_are_turned_with_a_word() {
    let scratch = Scratch::new();
    let text = |part: &str| {
        let out = scratch.path(&part.replace('/', "-"));
        let run = osculate(&["init", &example(part), "--out", &out.display().to_string()]);
        assert_eq!(run.code, 0, "{}", run.err);
        std::fs::read_to_string(out.join("job.toml")).unwrap()
    };
    let blade = text("eee-hpt-rotor2/blade.igs");
    assert!(!blade.contains("normals =") && blade.matches("[[operation]]").count() > 1, "{blade}");
}

#[test]
fn what_is_not_there_is_named() {
    let scratch = Scratch::new();
    let out = scratch.path("none").display().to_string();
    let part = example("propeller/propeller.step");
    osculate(&["init", &part, "--faces", "F21", "--out", &out]).refused(&[
        "has no face F21",
        "F1 to F20",
        "G1 to G",
    ]);
    osculate(&["init", &part, "--machine", "trunion-ac", "--out", &out])
        .refused(&["trunion-ac", "trunnion-ac"]);
    let library = scratch.write("tools.toml", "format = 1\n[[tool]]\nkind = \"bal\"\ndiameter_mm = 6\n");
    let tools = library.display().to_string();
    osculate(&["init", &part, "--tools", &tools, "--out", &out]).refused(&["line 3", "is \"ball\" meant?"]);
    let library = scratch.write("tools.toml", "format = 1\n[[tool]]\nkind = \"flat\"\ndiameter_mm = 6\n");
    let tools = library.display().to_string();
    osculate(&["init", &part, "--tools", &tools, "--out", &out]).refused(&["tools.toml has no ball"]);
    assert!(scratch.files().iter().all(|f| f == "tools.toml"));
}
