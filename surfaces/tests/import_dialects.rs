//! One square face written in the ways of Part 21 that occur in the wild: the face is read, or a diagnostic says what
//! was lost. No dialect gives a part without faces and without a word.

use crate::part21;

use osculate_surfaces::{ImportError, Part, read};
use part21::{AREA, SQUARE, file, polygon};

fn base() -> String {
    let (edges, at) = polygon(100, &SQUARE);
    let face = format!(
        "#200=FACE_OUTER_BOUND('',#{at},.T.);\n#201=PLANE('',#7);\n#202=ADVANCED_FACE('a',(#200),#201,.T.);\n\
         #203=OPEN_SHELL('',(#202));\n#204=SHELL_BASED_SURFACE_MODEL('',(#203));\n\
         #205=SHAPE_REPRESENTATION('',(#204),#3);\n"
    );
    file(&(edges + &face))
}

fn words(part: &Part) -> String {
    part.diagnostics.iter().map(|d| format!("{} {}\n", d.place, d.message)).collect()
}

/// The square of 100 mm2, whole.
fn assert_square(name: &str, text: &[u8]) -> Part {
    let part = read(text).unwrap_or_else(|e| panic!("{name}: {e}"));
    assert_eq!(part.faces.len(), 1, "{name}: {}", words(&part));
    let area = part.faces[0].area_mm2();
    assert!((area - 100.0).abs() <= AREA * 100.0, "{name}: {area}");
    part
}

#[test]
fn harmless_dialects_lose_nothing() {
    let base = base();
    let after_data = |more: &str| base.replacen("DATA;\n", &format!("DATA;\n{more}\n"), 1);
    let cases = [
        ("as it is", base.clone()),
        ("byte order mark", format!("\u{feff}{base}")),
        ("carriage returns", base.replace('\n', "\r\n")),
        ("comments", base.replace("=", "/* = ; ' */=/**/").replace(",(#", ",/* ( */(#")),
        ("blanks around signs", base.replace('=', " =  ").replace("(#", "( #")),
        ("exponent without point", base.replace("10.0", "1E1")),
        ("integers for reals", base.replace("10.0", "10").replace("0.0", "0")),
        ("Fortran's exponent", base.replace("10.0", "1.0D+01")),
        ("blank lines before", format!("\n \n\n{base}")),
        ("a shifted apostrophe", base.replace("'a'", "'a\\S\\'b'")),
        ("a reverse solidus at the end", base.replace("'a'", "'C:\\\\S\\\\'")),
        ("escapes", base.replace("'a'", "'\\X2\\00E4\\X0\\\\S\\d'")),
        ("two data sections", base.replacen("#200=", "ENDSEC;\nDATA;\n#200=", 1)),
        ("user-defined record", after_data("#900=!MINE(1.,'x',$,*,(#1,#2));")),
        ("unknown record", after_data("#900=TOTALLY_UNKNOWN(1.,'x',$,*,(#1,#2));")),
        ("binary", after_data("#900=SOMETHING(\"0F3A\");")),
        ("large numbers", base.replace('#', "#18446744073709000")),
        ("tabs and form feeds", base.replace(',', ",\t").replace(";\n", ";\u{c}\n")),
        ("zeros behind", format!("{base}\0\0\0\0")),
    ];
    for (name, text) in cases {
        let part = assert_square(name, text.as_bytes());
        assert!(!part.truncated, "{name}");
    }
}

#[test]
fn what_is_lost_is_said() {
    let base = base();
    let twice = base.replacen("#7=", "#6=CARTESIAN_POINT('',(1.,0.,0.));\n#7=", 1);
    assert!(words(&assert_square("one number twice", twice.as_bytes())).contains("#6"));
    let anchors = "ENDSEC;\nANCHOR;\n<a>=#1;\nENDSEC;\nREFERENCE;\n#999=<http://x/y#z>;\nENDSEC;\nDATA;";
    let third = base.replacen("ENDSEC;\nDATA;", anchors, 1);
    let said = words(&assert_square("edition 3", third.as_bytes()));
    assert!(said.contains("#999: it stands in another file"), "{said}");
    let cut = &base[..base.find("ENDSEC;\nEND-ISO").unwrap()];
    let part = assert_square("no trailer", cut.as_bytes());
    assert!(part.truncated && !part.diagnostics.is_empty());
    // Cut in the middle of the edges, nothing makes a face any more: it has to be said.
    for keep in (base.find("DATA;").unwrap() + 6..base.len()).step_by(97) {
        match read(&base.as_bytes()[..keep]) {
            Ok(part) => assert!(part.faces.len() == 1 || !part.diagnostics.is_empty(), "{keep}"),
            Err(why) => assert!(!why.to_string().is_empty()),
        }
    }
}

#[test]
fn two_bytes_a_character_are_refused_with_a_word() {
    let text = base();
    let wide = |to: fn(u16) -> [u8; 2]| -> Vec<u8> { text.encode_utf16().flat_map(to).collect() };
    for (mark, bytes) in [([0xff, 0xfe], wide(u16::to_le_bytes)), ([0xfe, 0xff], wide(u16::to_be_bytes))] {
        let marked: Vec<u8> = mark.into_iter().chain(bytes.iter().copied()).collect();
        for input in [bytes, marked] {
            let why = read(&input).unwrap_err();
            assert_eq!(why, ImportError::Wide);
            assert!(why.to_string().contains("UTF-16") && why.to_string().contains("UTF-8"));
        }
    }
}
