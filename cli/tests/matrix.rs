//! Every verb that judges a program gives the same verdict on it: `plan`'s own, and `verify`'s of the program that it wrote.

use crate::common;
use common::{Scratch, job, verdict};

/// Two pages of a text mesh of a box from (-8, -8, -12) to (8, 8, -6): a vice below the part.
fn vice() -> String {
    let (lo, hi) = ([-8.0, -8.0, -12.0], [8.0, 8.0, -6.0]);
    let at = |k: usize| -> [f64; 3] { [0, 1, 2].map(|a| if k >> a & 1 == 1 { hi[a] } else { lo[a] }) };
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let mut text = String::from("solid vice\n");
    for [a, b, c, d] in faces {
        for t in [[a, b, c], [a, c, d]] {
            text += "facet normal 0 0 0\nouter loop\n";
            for k in t {
                let [x, y, z] = at(k);
                text += &format!("vertex {x} {y} {z}\n");
            }
            text += "endloop\nendfacet\n";
        }
    }
    text + "endsolid vice\n"
}

#[test]
fn small_jobs() {
    let s = Scratch::new();
    s.write("vice.stl", &vice());
    let dialect = |to: &str| {
        let to = to.to_owned();
        job(move |t| t.replace("dialect = \"linuxcnc\"", &format!("dialect = \"{to}\"")))
    };
    let three = "[machine]\nname = \"3-axis\"\ndialect = \"fanuc\"\n";
    let on_three = |t: String| {
        let from = t.find("[machine]").unwrap();
        let to = t.find("[verification]").unwrap();
        format!("{}{three}{}", &t[..from], &t[to..])
    };
    let planes = |t: String| {
        on_three(t)
            .replace("kind = \"isoparametric\"\nlead_deg = 15", "kind = \"isoplanar_3c\"\naxis = [0, 0, 1]")
    };
    let layers = |t: String| {
        on_three(t)
            .replace(
                "kind = \"isoparametric\"\nlead_deg = 15",
                "kind = \"z_level\"\nstepdown_mm = 1.5\nstepover_mm = 3\nallowance_mm = 0.3",
            )
            .replace("scallop_mm = 0.02", "scallop_mm = 1.5")
            .replace("gouge_mm = 0.005", "gouge_mm = 0.1")
            + "[stock]\nbox_mm = [-6.5, -6.5, -4, 6.5, 6.5, 2]\ncell_mm = 0.25\n"
    };
    let tools = |t: String| {
        t.replace("[tool]\nkind = \"ball\"\ndiameter_mm = 10\nlength_mm = 50\n", "")
            + "[[tools]]\nkind = \"ball\"\ndiameter_mm = 10\nlength_mm = 50\n\
               [[tools]]\nkind = \"ball\"\ndiameter_mm = 6\nlength_mm = 40\n"
    };
    let cases: Vec<(&str, &str, String)> = vec![
        ("linuxcnc", "held", job(|t| t)),
        ("sinumerik", "held", dialect("sinumerik")),
        ("heidenhain", "held", dialect("heidenhain")),
        ("fanuc", "held", dialect("fanuc")),
        ("g93", "held", job(|t| t.replace("feed = \"tcp\"", "feed = \"inverse_time\""))),
        (
            "holder",
            "held",
            job(|t| {
                t.replace(
                    "length_mm = 50\n",
                    "length_mm = 50\nteeth = 3\n[tool.holder]\ndiameter_mm = 20\nlength_mm = 40\n",
                )
            }),
        ),
        ("stock", "held", job(|t| t + "[stock]\nbox_mm = [-7, -7, -10, 7, 7, 15]\ncell_mm = 0.5\n")),
        (
            "stock_in_the_way",
            "not_held",
            job(|t| {
                let block = "[stock]\nbox_mm = [-7, -7, -10, 7, 7, 15]\ncell_mm = 0.5\n";
                t.replace(
                    "length_mm = 50\n",
                    "length_mm = 12\n[tool.holder]\ndiameter_mm = 20\nlength_mm = 40\n",
                ) + block
            }),
        ),
        ("layer", "held", job(|t| t + "[stock]\nallowance_mm = 0.4\ncell_mm = 0.2\n")),
        ("fixture", "held", job(|t| t + "[fixture]\nfiles = [\"vice.stl\"]\n")),
        ("planes", "held", job(planes)),
        ("layers", "held", job(layers)),
        ("tools", "held", job(tools)),
    ];
    for (name, want, text) in cases {
        let path = s.write(&format!("{name}.toml"), &text);
        let verdict = verdict::planned_and_verified(&s, name, "plan", &path);
        assert_eq!(verdict["answer"], want, "{name}: {verdict}");
    }
}
