//! `inspect` and `probe` on built-in surfaces and on small files, against closed forms.

use crate::common;
use common::{Scratch, close, osculate};

#[test]
fn built_in_surfaces() {
    let keys = "kind = \"torus\", major_radius_mm = 200, minor_radius_mm = 60, material = \"outside\"";
    let run = osculate(&["inspect", "--builtin", keys, "--json"]);
    assert_eq!(run.code, 0, "{}", run.err);
    close(&run.json()["area_mm2"], 4.0 * std::f64::consts::PI.powi(2) * 12_000.0, 1e-9);
    let run =
        osculate(&["probe", "--builtin", keys, "--at", "0.3,3.141592653589793", "--at", "0,0", "--json"]);
    assert_eq!(run.code, 0, "{}", run.err);
    let points = run.json();
    let k = &points["points"][0]["principal_per_mm"];
    // Inside of the tube: hollow across, convex along.
    close(&k[0], 1.0 / 140.0, 1e-12);
    close(&k[1], -1.0 / 60.0, 1e-12);
    assert_eq!(points["points"].as_array().unwrap().len(), 2);
    let run = osculate(&["probe", "--builtin", keys, "--at", "0.3,3.14"]);
    assert!(run.out.contains("first form") && run.out.contains("convex"), "{}", run.out);
}

#[test]
fn lists_of_what_is_built_in() {
    for (verb, word) in [("machines", "trunnion-ac"), ("dialects", "sinumerik"), ("tools", "toroidal")] {
        assert!(osculate(&[verb]).out.contains(word));
        assert!(osculate(&[verb, "--json"]).json().to_string().contains(word));
    }
}

/// A red sphere in a product of its own, placed twice in an assembly.
const TWICE: &str = "ISO-10303-21;
HEADER;
FILE_DESCRIPTION((''),'2;1');
FILE_NAME('','',(''),(''),'','','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));
ENDSEC;
DATA;
#1=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));
#2=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));
#3=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#1,#2))REPRESENTATION_CONTEXT('',''));
#4=DIRECTION('',(0.,0.,1.));
#5=DIRECTION('',(1.,0.,0.));
#6=CARTESIAN_POINT('',(0.,0.,0.));
#7=AXIS2_PLACEMENT_3D('',#6,#4,#5);
#8=CARTESIAN_POINT('',(9.,0.,0.));
#9=AXIS2_PLACEMENT_3D('',#8,#4,#5);
#10=CARTESIAN_POINT('',(0.,0.,2.));
#11=VERTEX_POINT('',#10);
#12=VERTEX_LOOP('',#11);
#13=FACE_BOUND('',#12,.T.);
#14=SPHERICAL_SURFACE('',#7,2.);
#15=ADVANCED_FACE('ball',(#13),#14,.T.);
#16=CLOSED_SHELL('',(#15));
#17=MANIFOLD_SOLID_BREP('',#16);
#18=SHAPE_REPRESENTATION('',(#17,#7),#3);
#20=PRODUCT('p','bearing ball','',());
#21=PRODUCT_DEFINITION_FORMATION('','',#20);
#22=PRODUCT_DEFINITION('','',#21,$);
#23=PRODUCT_DEFINITION_SHAPE('','',#22);
#24=SHAPE_DEFINITION_REPRESENTATION(#23,#18);
#30=REPRESENTATION_MAP(#7,#18);
#31=MAPPED_ITEM('',#30,#7);
#32=MAPPED_ITEM('',#30,#9);
#33=SHAPE_REPRESENTATION('',(#31,#32),#3);
#40=COLOUR_RGB('',1.,0.,0.);
#41=FILL_AREA_STYLE_COLOUR('',#40);
#42=FILL_AREA_STYLE('',(#41));
#43=SURFACE_STYLE_FILL_AREA(#42);
#44=SURFACE_SIDE_STYLE('',(#43));
#45=SURFACE_STYLE_USAGE(.BOTH.,#44);
#46=PRESENTATION_STYLE_ASSIGNMENT((#45));
#47=STYLED_ITEM('',(#46),#15);
#48=PRESENTATION_LAYER_ASSIGNMENT('balls','',(#17));
#50=DATE_AND_NOTHING('');
#51=DATE_AND_NOTHING('');
ENDSEC;
END-ISO-10303-21;
";

#[test]
fn names_colours_instances_and_lines() {
    let scratch = Scratch::new();
    let path = scratch.write("twice.step", TWICE);
    let run = osculate(&["inspect", path.to_str().unwrap(), "--json"]);
    assert_eq!(run.code, 0, "{}", run.err);
    let answer = run.json();
    close(&answer["area_mm2"], 2.0 * 16.0 * std::f64::consts::PI, 1e-9);
    close(&answer["bbox_mm"][3], 11.0, 1e-9);
    for face in answer["faces"].as_array().unwrap() {
        assert_eq!((&face["name"], &face["colour"]), (&"ball".into(), &"#ff0000".into()));
        assert_eq!(face["product"], "bearing ball");
    }
    assert_eq!(answer["products"], serde_json::json!([{"name": "bearing ball", "faces": 2, "instances": 2}]));
    // A solid at each of its places, with its shell.
    let bodies = answer["bodies"].as_array().unwrap();
    assert_eq!(bodies.len(), 2, "{answer}");
    for (k, b) in bodies.iter().enumerate() {
        let id = format!("F{}", k + 1);
        assert_eq!((&b["kind"], &b["path"]), (&"solid".into(), &serde_json::json!(["bearing ball"])));
        let shell = &b["shells"][0];
        assert_eq!((&shell["closed"], &shell["faces"]), (&true.into(), &serde_json::json!([id])));
        assert_eq!(answer["faces"][k]["body"], b["id"]);
    }
    assert_eq!(answer["layers"], serde_json::json!([{"name": "balls", "faces": ["F1", "F2"]}]));
    assert_eq!(answer["faces"][1]["layers"], serde_json::json!(["balls"]));
    let left = answer["not_used"].as_array().unwrap().iter().find(|n| n["kind"] == "DATE_AND_NOTHING");
    let lines: Vec<usize> =
        ["#50", "#51"].map(|id| 1 + TWICE.lines().position(|l| l.starts_with(id)).unwrap()).to_vec();
    let left = left.unwrap();
    assert_eq!((&left["count"], &left["lines"]), (&2.into(), &serde_json::json!(lines)));
    let text = osculate(&["inspect", path.to_str().unwrap()]).out;
    for word in [
        "ball",
        "#ff0000",
        "bearing ball",
        "instances",
        "solid",
        "1 closed",
        "balls",
        "lines",
        &format!("{}, {}", lines[0], lines[1]),
    ] {
        assert!(text.contains(word), "{word} is not in {text}");
    }
}
