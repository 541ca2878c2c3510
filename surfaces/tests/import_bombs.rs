//! Files that ask for more than they hold: records that lead to themselves, lists within lists, assemblies of millions of
//! instances, counts that lie, and long runs of one character. Every one ends soon, in bounded memory, and says what is
//! wrong, where, and what to do.

use crate::part21;

use osculate_surfaces::{Part, read, step};
use part21::{SQUARE, file, flat_patch, numbered, polygon};
use std::time::{Duration, Instant};

/// Reading takes well below a second on an idle machine; the tests run on loaded ones, unoptimised too.
const LIMIT: Duration = Duration::from_secs(20);

fn timed(text: &str) -> Part {
    let began = Instant::now();
    let part = step::read(text.as_bytes()).unwrap();
    assert!(began.elapsed() < LIMIT, "{:?}", began.elapsed());
    part
}

fn said(part: &Part) -> String {
    part.diagnostics.iter().map(|d| format!("{d}\n")).collect()
}

/// A square face of number 402 over [`flat_patch`] in the representation 600.
fn square() -> String {
    let (outer, l) = polygon(200, &SQUARE);
    format!(
        "{}{outer}#400=FACE_BOUND('',#{l},.T.);\n#402=ADVANCED_FACE('',(#400),#120,.T.);\n#403=OPEN_SHELL('',(#402));\n\
         #404=SHELL_BASED_SURFACE_MODEL('',(#403));\n#600=SHAPE_REPRESENTATION('',(#404,#7),#3);\n",
        flat_patch()
    )
}

/// Levels of assemblies above the representation 600, each with two instances of the one below.
fn doubled(levels: u64) -> String {
    let mut out = square();
    for k in 0..levels {
        let below = if k == 0 { 600 } else { 993 + 10 * k };
        let records = format!(
            "@0=REPRESENTATION_MAP(#7,#{below});\n@1=MAPPED_ITEM('',@0,#7);\n@2=MAPPED_ITEM('',@0,#7);\n\
             @3=SHAPE_REPRESENTATION('',(@1,@2),#3);\n"
        );
        out += &numbered(1000 + 10 * k, &records);
    }
    out
}

#[test]
fn an_assembly_of_a_million_million_instances() {
    let part = timed(&file(&doubled(40)));
    assert!(part.truncated && !part.faces.is_empty());
    let words = said(&part);
    assert!(words.contains("one by one"), "{words}");
}

#[test]
fn assemblies_within_themselves() {
    // A holds B, B holds A; and an item of its own representation.
    let text = file(&format!(
        "{}#700=REPRESENTATION_MAP(#7,#710);#701=MAPPED_ITEM('',#700,#7);#702=REPRESENTATION_MAP(#7,#711);\
         #703=MAPPED_ITEM('',#702,#7);#710=SHAPE_REPRESENTATION('',(#404,#703),#3);\
         #711=SHAPE_REPRESENTATION('',(#404,#701),#3);",
        square()
    ));
    let words = said(&timed(&text));
    assert!(words.contains("contains itself") && words.contains(", line "), "{words}");
    // Shells and oriented faces that lead to themselves, and a chain of a thousand.
    let chain: String =
        (0..1000).map(|k| format!("#{}=ORIENTED_FACE('',*,#{},.T.);", 1000 + k, 1001 + k)).collect();
    for (records, word) in [
        ("#500=OPEN_SHELL('',(#501));#501=ORIENTED_FACE('',*,#500,.T.);".to_owned(), "nested deeper than 64"),
        (format!("{chain}#500=OPEN_SHELL('',(#1000));"), "nested deeper than 64"),
    ] {
        let text = file(&format!("{records}#900=SHAPE_REPRESENTATION('',(#500),#3);"));
        let words = said(&timed(&text));
        assert!(words.contains(word) && words.contains(", line "), "{words}");
    }
}

#[test]
fn composites_of_composites() {
    // Twelve levels of a hundred segments: 10^24 pieces.
    let mut curves = String::from(
        "#900=LINE('',#6,#901);#901=VECTOR('',#5,1.);\
         #1000=TRIMMED_CURVE('',#900,(PARAMETER_VALUE(0.)),(PARAMETER_VALUE(1.)),.T.,.PARAMETER.);",
    );
    for k in 1..13_u64 {
        let segments = vec!["@1"; 100].join(",");
        let records = format!(
            "@0=COMPOSITE_CURVE('',({segments}),.F.);\
             @1=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#{});\n",
            990 + 10 * k
        );
        curves += &numbered(1000 + 10 * k, &records);
    }
    let text = file(&format!(
        "{curves}#2000=VERTEX_POINT('',#6);#2001=EDGE_CURVE('',#2000,#2000,#1120,.T.);\
         #2002=ORIENTED_EDGE('',*,*,#2001,.T.);#2003=EDGE_LOOP('',(#2002));#2004=FACE_BOUND('',#2003,.T.);\
         #2005=PLANE('',#7);#2006=ADVANCED_FACE('',(#2004),#2005,.T.);"
    ));
    let words = said(&timed(&text));
    assert!(words.contains("F1 (#2006") && words.contains("export them as one"), "{words}");
}

#[test]
fn styles_of_styles() {
    let mut styles = String::new();
    for k in 0..16_u64 {
        let next = vec![format!("#{}", 1001 + k); 60].join(",");
        styles += &format!("#{}=PRESENTATION_STYLE_ASSIGNMENT(({next}));\n", 1000 + k);
    }
    let part = timed(&file(&format!("{}{styles}#1100=STYLED_ITEM('',(#1000),#402);", square())));
    assert_eq!((part.faces.len(), part.faces[0].colour), (1, None));
}

#[test]
fn long_chains_and_many_kinds() {
    // Representations in one frame, each related to the next one, written backwards.
    let mut text = square();
    let n = 20_000_u64;
    for k in 0..n {
        text += &format!("#{}=SHAPE_REPRESENTATION('',(#7),#3);", 10_000 + k);
    }
    for k in (1..n).rev() {
        text += &format!(
            "#{}=SHAPE_REPRESENTATION_RELATIONSHIP('','',#{},#{});\n",
            50_000 + k,
            10_000 + k,
            9_999 + k
        );
    }
    assert_eq!(timed(&file(&text)).faces.len(), 1);
    // A keyword of its own for every record.
    let kinds: String = (0..30_000).map(|k| format!("#{}=!K{k}();\n", 1000 + k)).collect();
    let part = timed(&file(&format!("{}{kinds}", square())));
    assert_eq!(part.faces.len(), 1);
    assert_eq!(part.not_used.iter().filter(|n| n.why == "a user-defined entity").count(), 30_000);
}

#[test]
fn lists_within_lists() {
    for open in ["(", "A("] {
        let deep = open.repeat(200_000);
        let words = said(&timed(&file(&format!("{}#900=A({deep});\n", square()))));
        assert!(words.contains("#900") && words.contains("nested deeper than 64"), "{words}");
        assert!(words.contains("line "), "{words}");
    }
    // As many bad records as one likes are few lines.
    let bad: String = (0..20_000).map(|k| format!("#{}=A(,,?);\n", 1000 + k)).collect();
    let part = timed(&file(&format!("{}{bad}", square())));
    assert_eq!(part.faces.len(), 1);
    assert!(part.diagnostics.len() < 20 && said(&part).contains("19992 more"), "{}", said(&part));
}

#[test]
fn long_runs_of_one_character() {
    // Every character that can be typed, and pairs that open something, within a record of either format.
    let runs = (b' '..=b'~').map(|c| char::from(c).to_string());
    let pairs = ["/*", "('", "#<", "\\X2\\", "&SCOPE ", "'\n#1=", ";'", "<;", "1H", "9H,"].map(str::to_owned);
    let iges = {
        let rest = format!("{:<72}S      1\n1H,,1H;,4HSLOT,37H$1$DUA2:[IGESLIB.BDRAFT.B2I]SLOT.IGS,", "run");
        format!("{rest:<153}")
    };
    for run in runs.chain(pairs) {
        let long = run.repeat(200_000 / run.len());
        let began = Instant::now();
        let step = file(&format!("#900=A(1.,{long}\n);\n#901=B('',{long});\n"));
        let _ = read(step.as_bytes());
        let cards: String = long
            .as_bytes()
            .chunks(64)
            .enumerate()
            .map(|(k, c)| format!("{:<64}      1P{:>7}\n", String::from_utf8_lossy(c), k + 1))
            .collect();
        let _ = read(format!("{iges}\n{cards}").as_bytes());
        assert!(began.elapsed() < LIMIT, "{run:?}: {:?}", began.elapsed());
    }
}
