//! IGES files punched card by card, for tests.
#![allow(dead_code, clippy::unwrap_used)]

use osculate_surfaces::iges;
use osculate_surfaces::{Face, Part};

/// See the STEP tests: loops follow their curves to 2e-6 of the face's size.
pub const AREA: f64 = 1e-5;

/// An entity: number, form, number of its transform's entity in the list plus one (0: none), parameters behind the
/// entity number, with `@k` for a pointer to entity k of the list.
#[derive(Clone)]
pub struct Entity(pub u32, pub i32, pub usize, pub String);

pub fn entity(kind: u32, parameters: impl Into<String>) -> Entity {
    Entity(kind, 0, 0, parameters.into())
}

/// Cuts text into cards of `width` columns with `tail` between text and section letter.
pub fn cards(text: &str, width: usize, letter: char, tail: &str, from: usize) -> String {
    let chars: Vec<char> = text.chars().collect();
    let mut out = String::new();
    for (k, c) in chars.chunks(width).enumerate() {
        let line: String = c.iter().collect();
        out += &format!("{line:<width$}{tail}{letter}{:>7}\n", from + k);
    }
    out
}

/// A file in millimetres.
pub fn file(entities: &[Entity]) -> String {
    file_in("1.,2,2HMM", entities)
}

/// A file whose global parameters 13 to 15 are `units`.
pub fn file_in(units: &str, entities: &[Entity]) -> String {
    punch("8Htest.igs", units, entities)
}

/// A file with the global parameters 4 and 13 to 15 as given.
pub fn punch(name: &str, units: &str, entities: &[Entity]) -> String {
    let global = format!(
        "1H,,1H;,4Htest,{name},1Hx,1Hx,32,38,6,308,15,4Htest,{units},1,0.1,1Hd,1E-6,100.,1Hx,1Hx,11,0,;"
    );
    let mut out = cards("a test", 72, 'S', "", 1) + &cards(&global, 72, 'G', "", 1);
    let (mut directory, mut parameters) = (String::new(), String::new());
    let mut line = 1;
    for (k, Entity(kind, form, transform, text)) in entities.iter().enumerate() {
        let de = 2 * k + 1;
        // The highest numbers first: `@12` is not `@1` and a 2.
        let mut text = format!("{kind},{text};");
        for j in (0..entities.len()).rev() {
            text = text.replace(&format!("@{j}"), &format!("{}", 2 * j + 1));
        }
        let data = cards(&text, 64, 'P', &format!("{de:>8}"), line);
        let count = data.lines().count();
        let t = if *transform == 0 { 0 } else { 2 * transform - 1 };
        directory +=
            &format!("{kind:>8}{line:>8}{:>8}{:>8}{:>8}{:>8}{t:>8}{:>8}{:>8}D{de:>7}\n", 0, 0, 0, 0, 0, 0);
        directory += &format!(
            "{kind:>8}{:>8}{:>8}{count:>8}{form:>8}{:>8}{:>8}{:>8}{:>8}D{:>7}\n",
            0,
            0,
            "",
            "",
            "LABEL",
            0,
            de + 1
        );
        parameters += &data;
        line += count;
    }
    out += &directory;
    out += &parameters;
    out + &format!("S{:>7}G{:>7}D{:>7}P{:>7}{:40}T{:>7}\n", 1, 1, 2 * entities.len(), line - 1, "", 1)
}

/// A bicubic flat patch over `[0, 10]^2`, u = x / 10 and v = y / 10; the file runs along u first.
pub fn flat_patch() -> Entity {
    let mut text = String::from("3,3,3,3,0,0,1,0,0,0.,0.,0.,0.,1.,1.,1.,1.,0.,0.,0.,0.,1.,1.,1.,1.");
    text += &",1.".repeat(16);
    for j in 0..4 {
        for i in 0..4 {
            text += &format!(",{:?},{:?},0.", 10.0 * f64::from(i) / 3.0, 10.0 * f64::from(j) / 3.0);
        }
    }
    entity(128, text + ",0.,1.,0.,1.")
}

pub fn part(entities: &[Entity]) -> Part {
    iges::read(file(entities).as_bytes()).unwrap()
}

pub fn only_face(entities: &[Entity]) -> Face {
    let part = part(entities);
    assert!(part.diagnostics.is_empty(), "{:?}", part.diagnostics);
    assert_eq!(part.faces.len(), 1, "{:?}", part.not_used);
    part.faces.into_iter().next().unwrap()
}

pub fn assert_area(face: &Face, want: f64) {
    let got = face.area_mm2();
    assert!((got - want).abs() <= AREA * want, "area {got}, {want} wanted");
}

/// The sides of a rectangle as lines and their composite, from entity `n` of the list on.
pub fn rectangle(n: usize, [x0, x1, y0, y1]: [f64; 4]) -> Vec<Entity> {
    let corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
    let mut out: Vec<Entity> = (0..4)
        .map(|k| {
            let (a, b) = (corners[k], corners[(k + 1) % 4]);
            entity(110, format!("{:?},{:?},0.,{:?},{:?},0.", a[0], a[1], b[0], b[1]))
        })
        .collect();
    out.push(entity(102, format!("4,@{n},@{},@{},@{}", n + 1, n + 2, n + 3)));
    out
}
