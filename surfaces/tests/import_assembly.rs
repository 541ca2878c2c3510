//! Assemblies, instances, names and colours of STEP files: every face at every place.

use crate::part21;

use osculate_geom::Point3;
use osculate_surfaces::structure::BodyKind;
use osculate_surfaces::{Colour, Part, step};
use part21::{SQUARE, circle, file, numbered, polygon};

/// A square face in a shell model #410, and the placements #500 to #504: the origin, 20 to the right, a quarter turn
/// about z at (0, 40, 0), a scaled and a mirrored operator.
fn square() -> String {
    let (edges, l) = polygon(200, &SQUARE);
    format!(
        "{edges}#399=PLANE('',#7);#400=FACE_BOUND('',#{l},.T.);#401=ADVANCED_FACE('top',(#400),#399,.T.);\
         #402=OPEN_SHELL('',(#401));#410=SHELL_BASED_SURFACE_MODEL('',(#402));\
         #500=AXIS2_PLACEMENT_3D('',#6,#4,#5);\
         #511=CARTESIAN_POINT('',(20.,0.,0.));#501=AXIS2_PLACEMENT_3D('',#511,#4,#5);\
         #512=CARTESIAN_POINT('',(0.,40.,0.));#513=DIRECTION('',(0.,1.,0.));#502=AXIS2_PLACEMENT_3D('',#512,#4,#513);\
         #503=CARTESIAN_TRANSFORMATION_OPERATOR_3D('','','',$,$,#6,2.,$);\
         #514=DIRECTION('',(0.,0.,-1.));#515=DIRECTION('',(0.,1.,0.));\
         #504=CARTESIAN_TRANSFORMATION_OPERATOR_3D('','','',#5,#515,#511,1.,#514);\
         #600=SHAPE_REPRESENTATION('',(#410),#3);"
    )
}

fn read(data: &str) -> Part {
    step::read(file(data).as_bytes()).unwrap()
}

/// Middles of the faces' boxes, rounded.
fn middles(part: &Part) -> Vec<[i64; 3]> {
    let round = |p: Point3| [p.x, p.y, p.z].map(|c| c.round() as i64);
    part.faces.iter().map(|f| round(f.bbox().centre())).collect()
}

fn said(part: &Part) -> String {
    part.diagnostics.iter().map(|d| format!("{d}\n")).collect()
}

/// A relation that puts representation `child` at placement `to` of `parent`.
fn relation(n: u64, child: u64, parent: u64, to: u64) -> String {
    format!(
        "#{n}=ITEM_DEFINED_TRANSFORMATION('','',#500,#{to});\
         #{}=(REPRESENTATION_RELATIONSHIP('','',#{child},#{parent})\
         REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#{n})SHAPE_REPRESENTATION_RELATIONSHIP());",
        n + 1
    )
}

#[test]
fn mapped_items_and_relations_place_instances() {
    let mapped = format!(
        "{}#700=REPRESENTATION_MAP(#500,#600);#701=MAPPED_ITEM('',#700,#501);#702=MAPPED_ITEM('',#700,#502);\
         #710=SHAPE_REPRESENTATION('',(#701,#702),#3);",
        square()
    );
    let related = format!(
        "{}#710=SHAPE_REPRESENTATION('',(#500,#501,#502),#3);{}{}",
        square(),
        relation(720, 600, 710, 501),
        relation(730, 600, 710, 502)
    );
    for text in [mapped, related] {
        let part = read(&text);
        assert_eq!(middles(&part), [[25, 5, 0], [-5, 45, 0]], "{}", said(&part));
        assert!(
            part.faces
                .iter()
                .all(|f| (f.area_mm2() - 100.0).abs() < 1e-9 && f.entity == 401 && f.name == "top")
        );
        assert_eq!((part.faces[0].id.as_str(), part.faces[1].id.as_str()), ("F1", "F2"));
        assert!(part.diagnostics.is_empty(), "{}", said(&part));
    }
}

#[test]
fn assemblies_nest_and_the_product_structure_decides_the_sense() {
    // The sub-assembly 710 holds two squares, the assembly 800 two sub-assemblies.
    let nested = format!(
        "{}#710=SHAPE_REPRESENTATION('',(#500),#3);#800=SHAPE_REPRESENTATION('',(#500),#3);{}{}{}{}",
        square(),
        relation(720, 600, 710, 500),
        relation(730, 600, 710, 501),
        relation(740, 710, 800, 500),
        relation(750, 710, 800, 502),
    );
    // A quarter turn takes (25, 5) to (-5, 25), then comes the shift.
    assert_eq!(middles(&read(&nested)), [[5, 5, 0], [25, 5, 0], [-5, 45, 0], [-5, 65, 0]]);
    // Written the other way round: the first representation is the assembly, as the products say.
    let products = |n: u64, rep: u64| {
        let records = format!(
            "@0=PRODUCT('id{n}','part {n}','',());@1=PRODUCT_DEFINITION_FORMATION('','',@0);\
             @2=PRODUCT_DEFINITION('','',@1,$);@3=PRODUCT_DEFINITION_SHAPE('','',@2);\
             @4=SHAPE_DEFINITION_REPRESENTATION(@3,#{rep});"
        );
        numbered(n, &records)
    };
    let turned = format!(
        "{}#710=SHAPE_REPRESENTATION('',(#500),#3);{}{}#720=ITEM_DEFINED_TRANSFORMATION('','',#501,#500);\
         #721=(REPRESENTATION_RELATIONSHIP('','',#710,#600)REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#720)\
         SHAPE_REPRESENTATION_RELATIONSHIP());#722=CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#721,#723);\
         #723=PRODUCT_DEFINITION_SHAPE('','',#724);#724=NEXT_ASSEMBLY_USAGE_OCCURRENCE('','','',#902,#952,$);",
        square(),
        products(900, 710),
        products(950, 600),
    );
    let part = read(&turned);
    assert_eq!(middles(&part), [[25, 5, 0]], "{}", said(&part));
    assert_eq!(part.faces[0].product, "part 950");
}

#[test]
fn scaled_and_mirrored_instances_are_placed_or_told() {
    // Plane: its parameters are lengths, a scaled instance is refused; the mirrored one lies face down.
    let text = |to: u64| {
        format!(
            "{}#700=REPRESENTATION_MAP(#500,#600);#701=MAPPED_ITEM('',#700,#{to});\
             #710=SHAPE_REPRESENTATION('',(#701),#3);",
            square()
        )
    };
    let scaled = read(&text(503));
    assert!(scaled.faces.is_empty() && said(&scaled).contains("scales lengths by 2"), "{}", said(&scaled));
    let mirrored = read(&text(504));
    let facing = |p: &Part| {
        use osculate_geom::{Surface, uv};
        p.faces[0].jet2(uv(5.0, 5.0)).normal().unwrap().z
    };
    assert_eq!(middles(&mirrored), [[25, 5, 0]]);
    assert!((facing(&mirrored) + 1.0).abs() < 1e-15);
}

#[test]
fn a_root_in_a_frame_of_its_own_is_moved_and_told() {
    let text = format!(
        "{}#900=PRODUCT('p','plate','',());#901=PRODUCT_DEFINITION_FORMATION('','',#900);\
         #902=PRODUCT_DEFINITION('','',#901,$);#903=PRODUCT_DEFINITION_SHAPE('','',#902);\
         #904=SHAPE_DEFINITION_REPRESENTATION(#903,#600);",
        square().replace("('',(#410),#3)", "('',(#501,#410),#3)")
    );
    let part = read(&text);
    assert_eq!((middles(&part), part.faces[0].product.as_str()), (vec![[25, 5, 0]], "plate"));
    assert!(
        said(&part).contains("#501, line 44: the shape of #600 is moved into this frame"),
        "{}",
        said(&part)
    );
}

#[test]
fn shared_shells_count_for_every_solid_and_voids_are_turned() {
    let text = format!(
        "{}#411=SHELL_BASED_SURFACE_MODEL('',(#402));#420=ORIENTED_OPEN_SHELL('',*,#402,.F.);\
         #421=SHELL_BASED_SURFACE_MODEL('',(#420));",
        square().replace("(#410),#3", "(#410,#411,#421),#3")
    );
    let part = read(&text);
    assert_eq!(part.faces.len(), 3);
    use osculate_geom::{Surface, uv};
    let up: Vec<f64> = part.faces.iter().map(|f| f.jet2(uv(5.0, 5.0)).normal().unwrap().z).collect();
    assert_eq!(up, [1.0, 1.0, -1.0]);
}

#[test]
fn circles_of_assemblies_and_bombs_of_instances_end_with_a_word() {
    let circle = format!(
        "{}#710=SHAPE_REPRESENTATION('',(#500),#3);{}{}",
        square(),
        relation(720, 600, 710, 501),
        relation(730, 710, 600, 501)
    );
    let part = read(&circle);
    assert!(!part.faces.is_empty() && said(&part).contains("contains itself"), "{}", said(&part));
    // Sixty levels, each holding the one below eight times: 8^60 instances.
    let mut bomb = square();
    let mut below = 600;
    for level in 0..60 {
        let map = 10_000 + 20 * level;
        bomb += &format!("#{map}=REPRESENTATION_MAP(#500,#{below});");
        let items: Vec<String> = (1..9).map(|k| format!("#{}", map + k)).collect();
        for item in &items {
            bomb += &format!("{item}=MAPPED_ITEM('',#{map},#501);");
        }
        below = map + 19;
        bomb += &format!("#{below}=SHAPE_REPRESENTATION('',({}),#3);", items.join(","));
    }
    let start = std::time::Instant::now();
    let part = read(&bomb);
    assert!(part.truncated && said(&part).contains("more than"), "{}", said(&part));
    // Two seconds optimised; the test profile is slower by less than five.
    assert!(start.elapsed().as_secs_f64() < 10.0, "{:?}", start.elapsed());
}

#[test]
fn colours_of_faces_and_solids() {
    let colour = |n: u64, rgb: &str, item: u64| {
        format!(
            "#{n}=COLOUR_RGB('',{rgb});#{}=FILL_AREA_STYLE_COLOUR('',#{n});#{}=FILL_AREA_STYLE('',(#{}));\
             #{}=SURFACE_STYLE_FILL_AREA(#{});#{}=SURFACE_SIDE_STYLE('',(#{}));#{}=SURFACE_STYLE_USAGE(.BOTH.,#{});\
             #{}=PRESENTATION_STYLE_ASSIGNMENT((#{}));#{}=STYLED_ITEM('',(#{}),#{item});",
            n + 1,
            n + 2,
            n + 1,
            n + 3,
            n + 2,
            n + 4,
            n + 3,
            n + 5,
            n + 4,
            n + 6,
            n + 5,
            n + 7,
            n + 6
        )
    };
    let of_solid = read(&format!("{}{}", square(), colour(800, "0.25,0.5,1.", 410)));
    assert_eq!(of_solid.faces[0].colour, Some(Colour { red: 0.25, green: 0.5, blue: 1.0 }));
    let both = format!("{}{}{}", square(), colour(800, "0.25,0.5,1.", 410), colour(820, "1.,0.,0.", 401));
    assert_eq!(read(&both).faces[0].colour, Some(Colour { red: 1.0, green: 0.0, blue: 0.0 }));
    assert_eq!(read(&square()).faces[0].colour, None);
}

#[test]
fn bounded_surfaces_of_geometric_sets_are_faces() {
    let disc = circle(700, [5.0, 5.0, 0.0], 2.0, true);
    let text = format!(
        "{disc}#720=PLANE('',#7);#721=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#725);\
         #725=TRIMMED_CURVE('',#702,(PARAMETER_VALUE(0.)),(PARAMETER_VALUE(6.283185307179586)),.T.,.PARAMETER.);\
         #722=OUTER_BOUNDARY_CURVE('',(#721),.F.);#723=CURVE_BOUNDED_SURFACE('',#720,(#722),.F.);\
         #730=CYLINDRICAL_SURFACE('',#7,2.);\
         #731=RECTANGULAR_TRIMMED_SURFACE('',#730,0.,1.5,0.,4.,.T.,.T.);\
         #732=RECTANGULAR_TRIMMED_SURFACE('',#730,6.,0.5,0.,4.,.T.,.T.);\
         #740=SPHERICAL_SURFACE('',#7,3.);\
         #750=GEOMETRIC_SET('',(#723,#731,#732,#740));#760=SHAPE_REPRESENTATION('',(#750),#3);"
    );
    let part = read(&text);
    let pi = std::f64::consts::PI;
    let want = [4.0 * pi, 2.0 * 1.5 * 4.0, 2.0 * (2.0 * pi - 5.5) * 4.0, 36.0 * pi];
    assert_eq!(part.faces.len(), 4, "{}", said(&part));
    for (face, want) in part.faces.iter().zip(want) {
        part21::assert_area(face, want);
        assert!(!face.oriented);
    }
}

#[test]
fn senses_say_which_part_of_a_torus_is_meant() {
    // Ways of u and v: from the first value to the second, up where the flag is true and down where it is false.
    let cases = [("5.5,.5,.5,4.5", ".T.,.T."), ("5.5,.5,.5,4.5", ".T.,.F."), (".5,5.5,5.5,.5", ".F.,.T.")];
    let tau = std::f64::consts::TAU;
    let over_seam = [5.5, 0.5 + tau];
    let ways = [(over_seam, [0.5, 4.5]), (over_seam, [4.5, 0.5 + tau]), (over_seam, over_seam)];
    for ((values, senses), (u, v)) in cases.into_iter().zip(ways) {
        let part = read(&format!(
            "#700=TOROIDAL_SURFACE('',#7,3.,1.);#701=RECTANGULAR_TRIMMED_SURFACE('',#700,{values},{senses});\
             #702=GEOMETRIC_SET('',(#701));#703=SHAPE_REPRESENTATION('',(#702),#3);"
        ));
        assert_eq!(part.faces.len(), 1, "{}", said(&part));
        // The integral of 3 + cos v.
        part21::assert_area(
            &part.faces[0],
            (u[1] - u[0]) * (3.0 * (v[1] - v[0]) + f64::sin(v[1]) - f64::sin(v[0])),
        );
    }
}

#[test]
fn rectangles_of_swept_surfaces_are_measured_in_the_parameters_of_the_file() {
    // A line (3, 0, 2 v) turned over 2 rad; a circle of 2 from 0.5 to 2 rad, and once over its seam, drawn along 4 z.
    let cases = [
        (
            "#700=CARTESIAN_POINT('',(3.,0.,0.));#701=VECTOR('',#4,2.);#702=LINE('',#700,#701);\
             #703=AXIS1_PLACEMENT('',#6,#4);#704=SURFACE_OF_REVOLUTION('',#702,#703);",
            "0.5,2.5,0.,2.",
            3.0 * 2.0 * 4.0,
        ),
        (
            "#700=CIRCLE('',#7,2.);#701=VECTOR('',#4,4.);#704=SURFACE_OF_LINEAR_EXTRUSION('',#700,#701);",
            "0.5,2.,0.,1.5",
            2.0 * 1.5 * 6.0,
        ),
        (
            "#700=CIRCLE('',#7,2.);#701=VECTOR('',#4,4.);#704=SURFACE_OF_LINEAR_EXTRUSION('',#700,#701);",
            "5.5,.5,-1.,.5",
            2.0 * (std::f64::consts::TAU - 5.0) * 6.0,
        ),
    ];
    for (surface, values, want) in cases {
        let part = read(&format!(
            "{surface}#705=RECTANGULAR_TRIMMED_SURFACE('',#704,{values},.T.,.T.);\
             #706=GEOMETRIC_SET('',(#705));#707=SHAPE_REPRESENTATION('',(#706),#3);"
        ));
        assert_eq!(part.faces.len(), 1, "{}", said(&part));
        part21::assert_area(&part.faces[0], want);
    }
}

#[test]
fn parameter_curves_of_surfaces_of_revolution_are_measured_in_the_parameters_of_the_file() {
    // A circle of 1 around (3, 0, 0) in the plane y = 0, turned about z: a torus, from 0.5 to 2.5 rad around, 0 to 1 along.
    let part = read(
        "#700=CARTESIAN_POINT('',(3.,0.,0.));#701=DIRECTION('',(0.,-1.,0.));#702=AXIS2_PLACEMENT_3D('',#700,#701,#5);\
         #703=CIRCLE('',#702,1.);#704=AXIS1_PLACEMENT('',#6,#4);#705=SURFACE_OF_REVOLUTION('',#703,#704);\
         #710=CARTESIAN_POINT('',(0.5,0.));#711=CARTESIAN_POINT('',(2.5,0.));#712=CARTESIAN_POINT('',(2.5,1.));\
         #713=CARTESIAN_POINT('',(0.5,1.));#714=POLYLINE('',(#710,#711,#712,#713,#710));\
         #715=(GEOMETRIC_REPRESENTATION_CONTEXT(2)PARAMETRIC_REPRESENTATION_CONTEXT()REPRESENTATION_CONTEXT('',''));\
         #716=DEFINITIONAL_REPRESENTATION('',(#714),#715);#717=PCURVE('',#705,#716);\
         #718=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#717);#719=OUTER_BOUNDARY_CURVE('',(#718),.F.);\
         #720=CURVE_BOUNDED_SURFACE('',#705,(#719),.F.);#721=GEOMETRIC_SET('',(#720));\
         #722=SHAPE_REPRESENTATION('',(#721),#3);",
    );
    assert_eq!(part.faces.len(), 1, "{}", said(&part));
    // The integral of 3 + cos v.
    part21::assert_area(&part.faces[0], 2.0 * (3.0 + 1.0_f64.sin()));
}

#[test]
fn bodies_shells_and_layers_are_as_the_file_has_them() {
    // A product "frame" with a shell model, and in it two instances of a product "block" whose solid "block" is named.
    let product = |n: u64, name: &str, rep: u64| {
        let records = format!(
            "@0=PRODUCT('{name}','{name}','',());@1=PRODUCT_DEFINITION_FORMATION('','',@0);\
             @2=PRODUCT_DEFINITION('','',@1,$);@3=PRODUCT_DEFINITION_SHAPE('','',@2);\
             @4=SHAPE_DEFINITION_REPRESENTATION(@3,#{rep});"
        );
        numbered(n, &records)
    };
    let usage = |n: u64, to: u64| {
        format!(
            "#{n}=ITEM_DEFINED_TRANSFORMATION('','',#500,#{to});\
             #{}=(REPRESENTATION_RELATIONSHIP('','',#650,#600)REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#{n})\
             SHAPE_REPRESENTATION_RELATIONSHIP());#{}=CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#{},#{});\
             #{}=PRODUCT_DEFINITION_SHAPE('','',#{});#{}=NEXT_ASSEMBLY_USAGE_OCCURRENCE('','','',#902,#952,$);",
            n + 1,
            n + 2,
            n + 1,
            n + 3,
            n + 3,
            n + 4,
            n + 4
        )
    };
    let (edges, l) = polygon(300, &SQUARE);
    let text = format!(
        "{}{edges}#415=FACE_BOUND('',#{l},.T.);#416=ADVANCED_FACE('',(#415),#399,.T.);#417=CLOSED_SHELL('skin',(#416));\
         #420=MANIFOLD_SOLID_BREP('block',#417);#650=SHAPE_REPRESENTATION('',(#420),#3);{}{}{}{}\
         #990=PRESENTATION_LAYER_ASSIGNMENT('tools','',(#420));#991=PRESENTATION_LAYER_ASSIGNMENT('all','',(#420,#401));\
         #992=PRESENTATION_LAYER_ASSIGNMENT('empty','',());",
        square(),
        product(900, "frame", 600),
        product(950, "block", 650),
        usage(720, 501),
        usage(740, 502)
    );
    let part = read(&text);
    assert_eq!(part.faces.len(), 3, "{}", said(&part));
    let seen: Vec<_> = part
        .structure
        .bodies
        .iter()
        .map(|b| {
            (
                b.id.as_str(),
                b.name.as_str(),
                b.kind,
                b.entity,
                b.path.join("/"),
                b.faces().collect::<Vec<_>>(),
            )
        })
        .collect();
    let want = [
        ("B1", "", BodyKind::Surfaces, 410, "frame".to_owned(), vec!["F1"]),
        ("B2", "block", BodyKind::Solid, 420, "frame/block".to_owned(), vec!["F2"]),
        ("B3", "block", BodyKind::Solid, 420, "frame/block".to_owned(), vec!["F3"]),
    ];
    assert_eq!(seen, want);
    let shell = &part.structure.bodies[1].shells[0];
    assert_eq!((shell.entity, shell.name.as_str(), shell.closed), (417, "skin", true));
    assert!(!part.structure.bodies[0].shells[0].closed);
    let layers: Vec<_> = part.structure.layers.iter().map(|l| (l.name.as_str(), l.faces.join(" "))).collect();
    assert_eq!(layers, [("tools", "F2 F3".to_owned()), ("all", "F1 F2 F3".to_owned())]);
    assert!(
        part.not_used.iter().all(|n| n.kind != "PRESENTATION_LAYER_ASSIGNMENT" || n.count == 0),
        "{:?}",
        part.not_used
    );
}
