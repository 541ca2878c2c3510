//! Groups, instances, names, status flags and the forms of IGES files.

use crate::punched;

use osculate_geom::{Point3, Surface, uv};
use osculate_surfaces::iges::{self, IgesError};
use osculate_surfaces::read;
use proptest::prelude::*;
use punched::{Entity, assert_area, entity, file, file_in, flat_patch, part, rectangle};

/// The patch as a 144 of its own rectangle, at entities 0 to 6 of the list.
fn trimmed() -> Vec<Entity> {
    let mut list = vec![flat_patch()];
    list.extend(rectangle(1, [0.1, 0.9, 0.2, 0.8]));
    list.push(entity(142, "0,@0,@5,0,1"));
    list.push(entity(144, "@0,1,0,@6"));
    list
}

#[test]
fn instances_are_placed() {
    let mut list = trimmed();
    list.push(entity(124, "0.,-1.,0.,0.,1.,0.,0.,0.,0.,0.,1.,0."));
    // 9: the definition; 10: doubled and shifted; 11: as it is, shifted, then turned by the matrix 8.
    list.push(entity(308, "0,4HPART,1,@7"));
    list.push(entity(408, "@9,100.,0.,0.,2."));
    list.push(Entity(408, 0, 9, "@9,0.,0.,7.,1.".into()));
    // A group with both, and another group with one of them: no face twice.
    list.push(Entity(402, 7, 0, "2,@10,@11".into()));
    list.push(Entity(402, 7, 0, "1,@11".into()));
    let part = part(&list);
    assert_eq!(part.faces.len(), 2, "{:?}", part.diagnostics);
    assert_area(&part.faces[0], 4.0 * 48.0);
    assert_area(&part.faces[1], 48.0);
    let at = |k: usize| part.faces[k].point(uv(0.5, 0.25));
    assert!((at(0) - Point3::new(110.0, 5.0, 0.0)).norm() < 1e-12);
    // (5, 2.5, 7) turned about z.
    assert!((at(1) - Point3::new(-2.5, 5.0, 7.0)).norm() < 1e-12);
    assert!(part.diagnostics.iter().any(|d| d.message.starts_with("3 instances")), "{:?}", part.diagnostics);
    assert!(part.not_used.is_empty(), "{:?}", part.not_used);
    // A definition that nothing places.
    let mut list = trimmed();
    list.push(entity(308, "0,4HPART,1,@7"));
    let part = punched::part(&list);
    assert_eq!(part.faces.len(), 1);
    assert!(part.diagnostics.iter().any(|d| d.message.contains("placed nowhere")));
}

#[test]
fn mirrored_solids_keep_their_material_side() {
    let mut list = vec![flat_patch()];
    list.extend(rectangle(1, [1.0, 9.0, 2.0, 8.0]));
    let edges: String = (0..4).map(|k| format!(",@{},@7,{},@7,{}", k + 1, k + 1, (k + 1) % 4 + 1)).collect();
    list.push(entity(504, format!("4{edges}")));
    list.push(entity(502, "4,1.,2.,0.,9.,2.,0.,9.,8.,0.,1.,8.,0."));
    let uses: String = (1..=4).map(|k| format!(",0,@6,{k},1,0")).collect();
    list.push(entity(508, format!("4{uses}")));
    list.push(entity(510, "@0,1,1,@8"));
    list.push(entity(514, "1,@9,1"));
    list.push(entity(186, "@10,1,0"));
    // x turned round, and shifted: a reflection.
    list.push(entity(124, "-1.,0.,0.,30.,0.,1.,0.,0.,0.,0.,1.,0."));
    list.push(Entity(430, 0, 13, "@11".into()));
    list.push(entity(184, "1,@11,0"));
    let part = part(&list);
    assert_eq!(part.faces.len(), 2, "{:?}", part.diagnostics);
    for f in &part.faces {
        assert_area(f, 48.0);
        // The image of (0, 0, 1) in a mirror along x is (0, 0, 1).
        assert!(f.oriented);
        assert_eq!(f.jet2(uv(0.5, 0.5)).normal().unwrap().z, 1.0);
    }
    // Operands of a boolean tree are no faces by themselves.
    list.truncate(12);
    list.push(entity(158, "3.,0.,0.,0."));
    list.push(entity(180, "3,-@11,-@12,2"));
    let part = punched::part(&list);
    assert!(part.faces.is_empty());
    assert!(part.diagnostics.iter().any(|d| d.message.contains("boolean trees")), "{:?}", part.diagnostics);
    assert!(part.not_used.iter().any(|n| n.kind.starts_with("186")));
}

#[test]
fn bombs_and_circles_end() {
    // Each definition holds two instances of the next: 2^40 faces.
    let mut list = Vec::new();
    for k in 0..40_usize {
        let next = 3 * k + 3;
        list.push(entity(308, format!("0,1HX,2,@{},@{}", 3 * k + 1, 3 * k + 2)));
        list.push(entity(408, format!("@{next},{k}.,0.,0.,1.")));
        list.push(entity(408, format!("@{next},0.,{k}.,0.,1.")));
    }
    list.push(entity(108, "0.,0.,1.,0.,0,0.,0.,0.,0."));
    let began = std::time::Instant::now();
    let told = part(&list);
    assert!(told.faces.is_empty());
    assert!(told.diagnostics.iter().any(|d| d.message.contains("the rest was not read")));
    // A tenth of a second here; the bound leaves room for a loaded machine.
    assert!(began.elapsed().as_secs_f64() < 10.0);
    // Groups in a circle have no root; a group of itself neither.
    let list = [
        Entity(402, 7, 0, "1,@1".into()),
        Entity(402, 7, 0, "1,@0".into()),
        Entity(402, 7, 0, "1,@2".into()),
        entity(124, "1.,0.,0.,0.,0.,1.,0.,0.,0.,0.,1.,0."),
    ];
    let told = part(&list);
    assert!(told.faces.is_empty());
    // The last group leads to itself, which is told; the others and the matrix are left.
    assert_eq!(told.not_used.iter().map(|n| n.count).sum::<usize>(), 3, "{:?}", told.not_used);
    assert!(told.diagnostics.iter().any(|d| d.message.contains("in a circle")), "{:?}", told.diagnostics);
    // Composite curves of a hundred members each, down to one without any.
    let mut list = vec![flat_patch()];
    for k in 0..12_usize {
        let members = vec![format!("@{}", k + 2); 100].join(",");
        list.push(entity(102, format!("100,{members}")));
    }
    list.extend([entity(102, "0"), entity(142, "0,@0,0,@1,2"), entity(144, "@0,1,0,@14")]);
    let told = part(&list);
    assert!(told.diagnostics.iter().any(|d| d.message.contains("or too many")), "{:?}", told.diagnostics);
    // A matrix that refers to itself.
    let mut list = vec![flat_patch(), Entity(124, 0, 2, "1.,0.,0.,0.,0.,1.,0.,0.,0.,0.,1.,0.".into())];
    list[0].2 = 2;
    let told = part(&list);
    assert!(told.diagnostics.iter().any(|d| d.message.contains("in a circle")), "{:?}", told.diagnostics);
}

/// The status of an entity's directory entry, put into the text of a file.
fn with_status(text: &str, index: usize, status: &str) -> String {
    let mut seen = 0;
    text.lines()
        .map(|l| {
            let mut l = l.to_owned();
            if &l[72..73] == "D" {
                if seen == 2 * index {
                    l.replace_range(64..72, status);
                }
                seen += 1;
            }
            l + "\n"
        })
        .collect()
}

#[test]
fn names_and_flags() {
    let mut list = trimmed();
    // A group pointer, then a property: the name.
    list[7] = entity(144, "@0,1,0,@6,1,@9,1,@8");
    list.push(Entity(406, 15, 0, "1,12HUpper  blade".into()));
    list.push(Entity(402, 7, 0, "1,@7".into()));
    let text = file(&list);
    let part = iges::read(text.as_bytes()).unwrap();
    assert_eq!(part.faces[0].name, "Upper  blade");
    assert!(part.not_used.is_empty() && part.diagnostics.is_empty(), "{:?}", part.diagnostics);
    let blanked = iges::read(with_status(&text, 7, "01000000").as_bytes()).unwrap();
    assert_eq!(blanked.faces.len(), 1);
    assert!(blanked.diagnostics[0].message.contains("not to be shown"), "{:?}", blanked.diagnostics);
    // Dependent on something that is not there.
    let orphan = iges::read(with_status(&file(&trimmed()), 7, "00010000").as_bytes()).unwrap();
    assert!(orphan.diagnostics[0].message.contains("none holds them"), "{:?}", orphan.diagnostics);
    // Blanks in the status are zeros.
    assert!(iges::read(with_status(&text, 7, "       0").as_bytes()).unwrap().diagnostics.is_empty());
}

#[test]
fn colours_by_number_and_definition() {
    let mut list = trimmed();
    list.push(entity(314, "100.,50.,0.,6HORANGE"));
    let text = file(&list);
    // Field 13 of the 144: columns 17 to 24 of its second card.
    let coloured = |field: &str| {
        let mut cards: Vec<String> = text.lines().map(str::to_owned).collect();
        let first = cards.iter().position(|l| &l[72..73] == "D").unwrap();
        cards[first + 15].replace_range(16..24, field);
        let part = iges::read((cards.join("\n") + "\n").as_bytes()).unwrap();
        part.faces[0].colour.map(|c| [c.red, c.green, c.blue])
    };
    assert_eq!(coloured("       0"), None);
    assert_eq!(coloured("       3"), Some([0.0, 1.0, 0.0]));
    assert_eq!(coloured("     -17"), Some([1.0, 0.5, 0.0]));
    assert_eq!(coloured("     -15"), None);
}

/// The same file in the compressed form.
fn compressed(fixed: &str) -> String {
    let section = |letter: &str| -> Vec<&str> { fixed.lines().filter(|l| &l[72..73] == letter).collect() };
    let mut out = format!("{:72}C{:>7}\n", "", 1);
    for l in section("S").into_iter().chain(section("G")) {
        out += &format!("{l}\n");
    }
    let data = section("P");
    let mut before = [String::new(), String::new(), String::new()];
    for pair in section("D").chunks(2) {
        let number: usize = pair[0][73..80].trim().parse().unwrap();
        let now = [&pair[0][0..8], &pair[0][48..56], &pair[1][32..40]].map(|f| f.trim().to_owned());
        out += &format!("D{number}");
        for (k, field) in [1, 7, 15].into_iter().enumerate() {
            if now[k] != before[k] {
                out += &format!("@{field}_{}", now[k]);
            }
        }
        before = now;
        out += "@18_LABEL\n";
        for l in &data {
            if l[64..72].trim().parse::<usize>().unwrap() == number {
                out += &format!("{}\n", l[..64].trim_end());
            }
        }
    }
    for l in section("T") {
        out += &format!("{l}\n");
    }
    out
}

#[test]
fn all_ways_to_write_a_file() {
    let text = file(&trimmed());
    let area = |text: &str| -> (f64, usize) {
        let part = read(text.as_bytes()).unwrap();
        assert_eq!(part.faces.len(), 1, "{:?}", part.diagnostics);
        assert!(!part.truncated);
        (part.faces[0].area_mm2(), part.diagnostics.len())
    };
    let (want, said) = area(&text);
    assert_eq!(said, 0);
    assert_eq!(area(&compressed(&text)), (want, 0));
    assert_eq!(area(&text.replace('\n', "\r\n")), (want, 0));
    assert_eq!(area(&text.replace('\n', "\r")), (want, 0));
    // Blanks at the ends and NULs behind the last card.
    assert_eq!(area(&(text.replace('\n', "   \n") + &"\0".repeat(400))), (want, 0));
    // Other delimiters, which strings may hold.
    let own: String = text
        .lines()
        .map(|l| {
            let (data, tail) = l.split_at(if &l[72..73] == "P" { 64 } else { 72 });
            let data = if matches!(&l[72..73], "G" | "P") {
                data.replace(',', "/").replace(';', "!")
            } else {
                data.into()
            };
            data + tail + "\n"
        })
        .collect();
    assert_eq!(area(&own), (want, 0));
    // All cards numbered as one: entries and data count by their places.
    let numbered = |letters: &str| -> String {
        let wrong = |l: &str| {
            if letters.contains(&l[72..73]) { format!("{}{:>7}\n", &l[..73], 1) } else { format!("{l}\n") }
        };
        text.lines().map(wrong).collect()
    };
    assert_eq!(area(&numbered("D")), (want, 1));
    assert_eq!(area(&numbered("P")).0, want);
    assert_eq!(area(&numbered("DP")).0, want);
    // A line that is no card, and cards behind the end.
    assert_eq!(area(&format!("a word\n{text}")), (want, 1));
    assert_eq!(area(&format!("{text}{:72}P{:>7}\n", "", 1)), (want, 1));
    // No terminate section: read, and marked.
    let cut: String = text.lines().filter(|l| &l[72..73] != "T").map(|l| format!("{l}\n")).collect();
    let part = read(cut.as_bytes()).unwrap();
    assert!(part.truncated && part.faces.len() == 1);
    // The binary form.
    let binary = format!("{:72}B{:>7}\n", "", 1);
    assert_eq!(iges::read(binary.as_bytes()).unwrap_err(), IgesError::Binary);
}

#[test]
fn units_by_flag() {
    for (units, mm) in [
        ("1.,1,2HIN", 25.4),
        ("1.,6,1HM", 1000.0),
        ("1.,10,2HCM", 10.0),
        ("1.,3,2HFT", 304.8),
        ("2.,2,", 0.5),
    ] {
        let part = iges::read(file_in(units, &[flat_patch()]).as_bytes()).unwrap();
        let want = 100.0 * mm * mm;
        assert!((part.faces[0].area_mm2() - want).abs() < 1e-11 * want, "{units}");
    }
}

/// A file with most kinds of entity.
fn many() -> String {
    let mut list = trimmed();
    list.push(entity(308, "0,4HPART,1,@7"));
    list.push(entity(408, "@8,100.,0.,0.,2."));
    list.push(Entity(402, 7, 0, "1,@9".into()));
    list.push(Entity(104, 1, 0, "4.,0.,9.,0.,0.,-36.,0.,3.,0.,3.,0.".into()));
    list.push(Entity(108, 1, 0, "0.,0.,1.,0.,@11,0.,0.,0.,0.".into()));
    list.push(entity(110, "0.,0.,0.,0.,0.,1."));
    list.push(entity(
        112,
        "3,2,2,2,0.,1.,2.,0.,1.,0.,0.,0.,0.,1.,0.,0.,0.,0.,0.,1.,1.,0.,0.,1.,2.,1.,0.,0.,0.,0.,0.",
    ));
    list.push(entity(122, "@14,0.,0.,2."));
    list.push(entity(120, "@13,@14,0.,3."));
    list.push(Entity(118, 1, 0, "@13,@14,0,0".into()));
    list.push(entity(130, "@13,1,0,0,0,0.5,0.,0.,0.,0.,1.,0.,0.,1."));
    list.push(Entity(118, 0, 0, "@18,@14,1,0".into()));
    list.push(entity(116, "1.,2.,3.,0"));
    list.push(entity(196, "@20,2."));
    let numbers: Vec<String> = (0..105).map(|k| format!("{}", k % 7)).collect();
    list.push(entity(114, format!("3,1,1,1,0.,1.,0.,1.,{}", numbers.join(","))));
    file(&list)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    /// Numbers replaced by others that mean something: an error or a part in bounded time, never a panic.
    #[test]
    fn lying_numbers_never_panic(changes in prop::collection::vec((0.0..1.0, 0_usize..16), 1..6)) {
        const LIES: [&str; 16] = ["0", "-1", "1", "2", "3", "7", "19", "1000000000", "-2000000000", "1e308", "-1e308", "1e-308", "0.5", "", "9HA,B;", "9999999999999999999999"];
        let mut text = many();
        for (at, lie) in changes {
            // The number at or behind a place in the sections D and P.
            let start = text.find("D      1").unwrap() - 72;
            let bytes = text.as_bytes();
            let mut k = start + (at * (bytes.len() - start - 100) as f64) as usize;
            while k < bytes.len() && !bytes[k].is_ascii_digit() {
                k += 1;
            }
            let mut end = k;
            while end < bytes.len() && (bytes[end].is_ascii_alphanumeric() || bytes[end] == b'.') {
                end += 1;
            }
            let column = k - text[..k].rfind('\n').map_or(0, |n| n + 1);
            if column >= 64 {
                continue;
            }
            // The card keeps its columns: what is longer overwrites what follows, what is shorter leaves blanks.
            let end = end.max(k + LIES[lie].len()).min(k + 64 - column);
            let word: String = LIES[lie].chars().chain(std::iter::repeat(' ')).take(end - k).collect();
            text.replace_range(k..end, &word);
        }
        if let Ok(part) = read(text.as_bytes()) {
            for f in &part.faces {
                prop_assert!(f.area_mm2() >= 0.0 && f.entity > 0);
            }
        }
    }
}
