//! Schema, serde tables and template held against each other, and whole jobs read.

use crate::job::problem::full;
use crate::job::schema::Kind;
use crate::job::{
    Job, check,
    keys::{LIST, ONE, TABLES},
    raw, reference, schema,
};
use std::path::Path;

const BASE: &str = "format = 1\n[part]\nbuiltin = { kind = \"plane\", half_size_mm = 5 }\n[tool]\nkind = \"ball\"\n\
                    diameter_mm = 10\n[tolerance]\nscallop_mm = 0.01\n";

fn job(text: &str) -> Result<Job, String> {
    Job::from_toml(text, Path::new("job.toml")).map_err(|e| e.message().to_owned())
}

/// Field names that serde lists where it meets one that it does not know.
fn fields<T: serde::de::DeserializeOwned>() -> Vec<String> {
    let Err(e) = toml::from_str::<T>("no_such_key = 1") else { return Vec::new() };
    let text = e.message().to_owned();
    assert!(text.contains("unknown field `no_such_key`"), "{text}");
    text.split('`').skip(3).step_by(2).map(ToOwned::to_owned).collect()
}

/// What serde accepts, table by table: each format of job files has its own schema, what they share is read by one type.
fn accepted() -> Vec<(&'static str, Vec<String>)> {
    vec![
        ("", fields::<raw::Raw>()),
        ("part", fields::<raw::Part>()),
        ("part.side", fields::<raw::SideKey>()),
        ("part.ruled", fields::<raw::Ruled>()),
        ("part.ruled.c0", fields::<raw::Curve>()),
        ("part.ruled.c1", fields::<raw::Curve>()),
        ("tool", fields::<raw::Tool>()),
        ("tool.holder", fields::<osculate_tools::HolderSpec>()),
        ("tolerance", fields::<raw::Tolerance>()),
        ("strategy", fields::<raw::Strategy>()),
        ("cutting", fields::<raw::Cutting>()),
        ("machine", fields::<raw::Machine>()),
        ("setup", fields::<raw::Setup>()),
        ("contact", fields::<raw::Contact>()),
        ("stock", fields::<raw::Stock>()),
        ("stock.cylinder", fields::<raw::Cylinder>()),
        ("fixture", fields::<raw::Fixture>()),
        ("flank", fields::<raw::Flank>()),
        ("verification", fields::<raw::Verification>()),
        ("operation", fields::<raw::Operation>()),
        ("operation.repeat", fields::<raw::Circle>()),
    ]
}

#[test]
fn what_serde_accepts_and_what_the_schema_lists_are_the_same() {
    let all = accepted();
    assert_eq!(all.len(), TABLES.len() + 2);
    for (name, mut fields) in all {
        let of = |schema: &schema::Schema| -> Vec<String> {
            schema.keys(name).map(|k| k.name).chain(schema.tables_in(name)).map(ToOwned::to_owned).collect()
        };
        // The file itself is read by a type for each format.
        let mut listed = if name.is_empty() { of(&ONE) } else { [of(&ONE), of(&LIST)].concat() };
        assert!(!fields.is_empty());
        fields.sort();
        listed.sort();
        listed.dedup();
        assert_eq!(fields, listed, "[{name}]");
    }
    let mut top = fields::<raw::RawList>();
    let mut listed: Vec<&str> = LIST.keys("").map(|k| k.name).chain(LIST.tables_in("")).collect();
    top.sort();
    listed.sort_unstable();
    assert_eq!(top, listed);
}

/// A text in which one key stands with its example, and whatever its table needs beside it.
fn with_key(table: &schema::Table, name: &str) -> String {
    let mut text = String::new();
    for t in
        TABLES.iter().filter(|t| t.name == table.name || ["", "part", "tool", "tolerance"].contains(&t.name))
    {
        if !t.name.is_empty() {
            text += &format!("[{}]\n", t.name);
        }
        for k in t.keys.iter().filter(|k| k.default.is_none() || (t.name == table.name && k.name == name)) {
            text += &format!("{} = {}\n", k.name, k.example);
        }
    }
    if table.name.starts_with("part.ruled") {
        for c in ["c0", "c1"].map(|c| format!("part.ruled.{c}")).iter().filter(|c| **c != table.name) {
            text += &format!("[{c}]\npoints = [[0, 0, 0], [1, 0, 0]]\n");
        }
    }
    text
}

#[test]
fn every_key_of_the_schema_can_be_given() {
    let mut count = 0;
    for table in TABLES {
        for key in table.keys {
            let text = with_key(table, key.name);
            let name = full(table.name, key.name);
            let places = check::places(&text, Path::new("job.toml"), &ONE)
                .unwrap_or_else(|e| panic!("{name}: {}", e.message()));
            assert!(places.has(table.name, key.name));
            toml::from_str::<raw::Raw>(&text).unwrap_or_else(|e| panic!("{name}: {e}"));
            count += 1;
        }
    }
    assert!(count > 90, "{count}");
}

#[test]
fn every_word_of_the_schema_is_one_of_serde() {
    for table in TABLES {
        for key in table.keys {
            for word in key.kind.words() {
                let text = with_key(table, key.name);
                let given = format!("{} = {}\n", key.name, key.example);
                let text = text.replace(&given, &format!("{} = \"{word}\"\n", key.name));
                check::places(&text, Path::new("job.toml"), &ONE)
                    .unwrap_or_else(|e| panic!("{}", e.message()));
                toml::from_str::<raw::Raw>(&text).unwrap_or_else(|e| panic!("{word}: {e}"));
            }
        }
    }
}

/// Every numeric key refuses what no number of it can be, with its name and line, at once.
#[test]
fn every_numeric_key_refuses_nonsense() {
    let mut tried = 0;
    for table in TABLES {
        for key in table.keys {
            let bad: Vec<String> = match key.kind {
                Kind::Number(r, _) | Kind::NumberOr(r, ..) => {
                    let past = [r.least - 1.0, 2.0 * r.most.abs() + 1.0];
                    let mut all: Vec<String> =
                        ["nan", "inf", "-inf", "true", "\"x\"", "[1]"].map(String::from).to_vec();
                    all.extend(past.into_iter().filter(|x| x.is_finite()).map(|x| format!("{x:?}")));
                    if r.open[0] {
                        all.push(format!("{:?}", r.least));
                    }
                    all
                }
                Kind::Whole(a, b) => {
                    vec![(a - 1).to_string(), (b + 1).to_string(), "nan".into(), "1.5".into(), "\"x\"".into()]
                }
                Kind::Flag => vec!["1".into(), "\"true\"".into()],
                Kind::Sign => vec!["0".into(), "2".into(), "nan".into()],
                Kind::Numbers(n, ..) => vec![
                    format!("[{}]", vec!["nan"; n].join(", ")),
                    format!("[{}]", vec!["0"; n + 1].join(", ")),
                    "1".into(),
                ],
                Kind::Direction | Kind::DirectionOr(_) => {
                    vec!["[0, 0, 0]".into(), "[0, nan, 1]".into(), "[1, 0]".into()]
                }
                Kind::Between(..) => vec!["[1, 0]".into(), "[1, 1]".into(), "[0, nan]".into(), "[0]".into()],
                Kind::Corners(_) => {
                    vec!["[0, 0, 0, 1, 1, -1]".into(), "[0, 0, 0, 1, 1, nan]".into(), "[0]".into()]
                }
                _ => continue,
            };
            let good = with_key(table, key.name);
            let given = format!("{} = {}\n", key.name, key.example);
            for value in bad {
                let text = good.replacen(&given, &format!("{} = {value}\n", key.name), 1);
                let begun = std::time::Instant::now();
                let error = job(&text).err().unwrap_or_else(|| panic!("{} = {value} is taken", key.name));
                assert!(begun.elapsed().as_secs_f64() < 0.2);
                for word in ["job.toml: line ", key.name, "must be"] {
                    assert!(error.contains(word), "{word}: {error}");
                }
                tried += 1;
            }
        }
    }
    assert!(tried > 250, "{tried}");
}

#[test]
fn unknown_keys_and_words_are_answered_with_the_nearest() {
    for table in TABLES.iter().filter(|t| !t.keys.is_empty()) {
        let first = &table.keys[0];
        let text = with_key(table, first.name);
        let misspelt = format!("{}x = {}\n", first.name, first.example);
        let head = if table.name.is_empty() { String::new() } else { format!("[{}]\n", table.name) };
        let text =
            if head.is_empty() { misspelt + &text } else { text.replace(&head, &(head.clone() + &misspelt)) };
        let error = job(&text).err().unwrap();
        assert!(error.contains(&format!("{}x is no key here", first.name)), "{error}");
        assert!(error.contains(&format!("(is {} meant?)", first.name)), "{error}");
        for key in table.keys {
            for word in key.kind.words() {
                let given = format!("{} = {}\n", key.name, key.example);
                let text =
                    with_key(table, key.name).replacen(&given, &format!("{} = \"{word}q\"\n", key.name), 1);
                let error = job(&text).err().unwrap();
                // Of one letter, any other is as near.
                assert!(word.len() < 2 || error.contains("meant?"), "{word}: {error}");
                assert!(error.contains(key.name) && error.contains("job.toml: line "), "{error}");
            }
        }
    }
    let error = job(&format!("{BASE}[strategy]\nhop_mm = 1\n")).err().unwrap();
    assert!(error.contains("[setup] hop_mm"), "{error}");
}

#[test]
fn the_template_is_a_job_and_has_every_key() {
    let text = reference::template(TABLES);
    let read = job(&text).unwrap();
    assert_eq!(read.tolerance().scallop_mm, 0.01);
    for table in TABLES {
        for key in table.keys {
            let line = format!("{} = {}", key.name, key.example);
            assert!(text.lines().any(|l| l.trim_start_matches("# ") == line), "{line}");
        }
    }
    let shown = reference::text(TABLES);
    assert!(reference::rows(TABLES).iter().all(|r| shown.contains(r.key) && !r.meaning.is_empty()));
}

#[test]
fn values_arrive() {
    let read = job(&format!(
        "{}number = 7\nteeth = 2\nflute_length_mm = 20\n[tolerance]\nscallop_mm = 0.02\nunreached_mm2 = 3\n[strategy]\n\
         kind = \"z_level\"\nstepdown_mm = 2\nstepover_mm = 4\n[cutting]\nspindle_rpm = 1000\nfeed_per_tooth_mm = 0.1\n\
         coolant = \"mist\"\n[machine]\nname = \"3-axis\"\ndialect = \"fanuc\"\nwork_offset = \"G54.1 P12\"\n\
         program_number = 12\n[stock]\n[stock.cylinder]\ndiameter_mm = 30\nz_mm = [-5, 5]\n[verification]\n\
         accept = \"samples\"\n[flank]\nside = -1\nmethod = \"optimum\"\n",
        BASE.split("[tolerance]").next().unwrap()
    ))
    .unwrap();
    assert_eq!((read.tool().number(), read.program_number()), (7, Some(12)));
    assert_eq!((read.feed_mm_min(), read.unreached_mm2()), (200.0, 3.0));
    assert_eq!(read.coolant(), Some(osculate_postproc::Coolant::Mist));
    assert_eq!(read.work_offset(), Some("G54.1 P12"));
    assert_eq!(read.strategy().layers().unwrap().stepover_mm, 4.0);
    assert_eq!(read.verification().accept, crate::job::Accept::Samples);
    assert!(matches!(read.stock().unwrap().blank, crate::job::Blank::Cylinder { along_mm: [-5.0, 5.0], .. }));
    assert!(read.flank().flipped && read.flank().method.word() == "optimum");
    let several = BASE
        .replace("[tool]", "[[tools]]")
        .replace("10\n", "10\nholder = { diameter_mm = 40, length_mm = 60 }\n");
    let several =
        job(&several.replace("[tolerance]", "[[tools]]\nkind = \"flat\"\ndiameter_mm = 4\n[tolerance]"))
            .unwrap();
    let numbers: Vec<u32> = several.each_tool().iter().map(|j| j.tool().number()).collect();
    assert_eq!((numbers, several.holder().map(|h| h.length_mm())), (vec![1, 2], Some(60.0)));
    let (cutting, shank) = read.flutes();
    assert_eq!((cutting.length_mm(), shank.unwrap().length_mm()), (20.0, 30.0));
    // A roughing hops as high as it approaches.
    assert_eq!(read.setup().hop_mm, read.setup().approach_mm);
}

/// Through the air a tool goes as fast as through material where nothing else is said, and no slower.
#[test]
fn the_feed_of_the_air_is_no_less() {
    let with = |cutting: &str| job(&format!("{BASE}[cutting]\n{cutting}\n"));
    let air = |cutting: &str| with(cutting).unwrap().air_mm_min();
    assert_eq!(air("feed_mm_min = 800"), 800.0);
    assert_eq!(air("feed_mm_min = 800\nair_feed_mm_min = 6000"), 6000.0);
    let why = with("feed_mm_min = 800\nair_feed_mm_min = 700").unwrap_err().to_string();
    assert!(why.contains("air_feed_mm_min = 700") && why.contains("feed_mm_min = 800 or more"), "{why}");
}
