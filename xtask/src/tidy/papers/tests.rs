//! The rules on pages and sources made up for them.

use super::*;

const ARGS: &str =
    "pub struct Cli { #[arg(long, global = true)] pub json: bool, #[command(subcommand)] pub verb: Verb }
pub enum Verb { Strip { job: PathBuf }, Flank { #[arg(long)] largest_tool: bool }, Lines(LinesArgs), Keys }
pub struct LinesArgs { #[command(flatten)] part: PartArgs, #[arg(long, default_value = \"0\")] pub axis: f64 }
pub struct PartArgs { #[arg(required = true)] pub part: PathBuf, #[arg(long)] pub builtin: String }";
const API: &str = "pub const fn osculate_tools::Mark::length_mm(&self) -> f64\n\
                   #[non_exhaustive] pub enum osculate_tools::Kind\npub field osculate_tools::Mark::at: Uv\n";
const TESTS: &str = "#[test]\nfn good() {}\nfn helper() {}\n#[test]\n// Why.\n#[allow(x)]\nfn late() {}\n\
                     proptest! {\n    fn law(x in 0..3) {}\n}\n";

/// A page with all rows that are numbered, and one more.
fn page(row: &str) -> String {
    let mut text = String::new();
    for paper in PAPERS {
        text += &format!(
            "## {}: title\n\n| {} |\n|---|---|---|---|---|---|---|\n",
            paper.key,
            rows::COLUMNS.join(" | ")
        );
        for (sort, most) in
            [(Sort::Equation, paper.equations), (Sort::Figure, paper.figures), (Sort::Table, paper.tables)]
        {
            for n in 1..=most {
                text += &format!("| {} | | | | empty | | |\n", sort.number(n));
            }
        }
        text += "\nWords.\n\n";
    }
    // After the last table, with a head of its own.
    text + &format!("| {} |\n|---|\n{row}\n", rows::COLUMNS.join(" | "))
}

fn tree_of(page: &str) -> Tree {
    Tree::of(&[
        (PAGE, page),
        (ARGUMENTS, ARGS),
        (KEYS, "table(\"flank\", may(\"at_u\"))"),
        ("api/osculate-tools.txt", API),
        ("tools/tests/a.rs", TESTS),
        ("cli/src/cmd/strip.rs", "pub struct Answer { exact: Exact, width_mm: f64 }"),
    ])
}

fn found(page: &str) -> Vec<String> {
    every_statement(&tree_of(page)).iter().map(|f| f.to_string()).collect()
}

/// What is found of one row with these cells of code, test and command.
fn of_row(code: &str, test: &str, command: &str) -> Vec<String> {
    let all = found(&page(&format!("| name | what | {code} | {test} | {command} | | |")));
    all.into_iter().map(|f| f.split_once(": ").map_or(String::new(), |(_, what)| what.to_owned())).collect()
}

#[test]
fn rows_that_name_what_exists_are_good() {
    for (code, test, command) in [
        (
            "`osculate_tools::Mark::length_mm`",
            "`tools/tests/a.rs::good`",
            "`osculate strip JOB --json`: `exact.width_mm`",
        ),
        (
            "`osculate_tools::Kind`",
            "`tools/tests/a.rs::law`",
            "`osculate flank JOB --largest-tool`, `[flank] at_u = 3`",
        ),
        (
            "`osculate_tools::Mark::at`",
            "`tools/tests/a.rs::late`",
            "`osculate lines --builtin KEYS --axis 0,0,1`",
        ),
        ("", "", "no command yet: too slow"),
        ("", "", "wrong"),
    ] {
        assert_eq!(of_row(code, test, command), Vec::<String>::new(), "{command}");
    }
}

#[test]
fn what_does_not_exist_is_found() {
    let good = ("`osculate_tools::Kind`", "`tools/tests/a.rs::good`", "`osculate keys`");
    let one = |code, test, command, what: &str| assert_eq!(of_row(code, test, command), [what]);
    one("`osculate_tools::gone`", good.1, good.2, "no list in api has `osculate_tools::gone`");
    one(good.0, "`tools/tests/a.rs::gone`", good.2, "tools/tests/a.rs has no test gone");
    one(good.0, "`tools/tests/a.rs::helper`", good.2, "tools/tests/a.rs has no test helper");
    one(good.0, "`tools/tests/b.rs::good`", good.2, "tools/tests/b.rs does not exist");
    one(good.0, "`good`", good.2, "`good` is no test: file::name is wanted");
    one(good.0, "", good.2, "name has code and no test");
    one(good.0, good.1, "`osculate gone`", "the program has no verb `gone`");
    one(good.0, good.1, "`osculate strip JOB --axis 3`", "`osculate strip` has no option `--axis`");
    one(good.0, good.1, "`osculate strip JOB`, `[flank] gone`", "no job has `gone` of `[flank] gone`");
    one(good.0, good.1, "`osculate strip JOB`: `exact.gone`", "no source of the program has `exact.gone`");
    one("", "", "by hand", "name names no command: begin with one of `no command yet`, `wrong`, `empty`");
}

#[test]
fn every_number_has_one_row() {
    let whole = page("| name | | | | empty | | |");
    assert_eq!(found(&whole), Vec::<String>::new());
    let without = whole.replace("| eq. 63 | | | | empty | | |\n", "");
    assert_eq!(found(&without), [format!("{PAGE}: R97 has no row for eq. 63")]);
    let without = whole.replace("| table 3 | | | | empty | | |\n", "");
    assert_eq!(found(&without), [format!("{PAGE}: Z17 has no row for table 3")]);
    let twice = found(&page("| fig. 16 | | | | empty | | |"));
    assert!(twice.len() == 1 && twice[0].ends_with("Z17 has two rows for fig. 16"), "{twice:?}");
    let cells = found(&page("| name | | empty |"));
    assert!(cells.len() == 1 && cells[0].ends_with("3 cells, 7 are wanted"), "{cells:?}");
    let heads = found(&whole.replace("| number | what it is |", "| nr | what it is |"));
    assert_eq!(heads.len(), 5, "{heads:?}");
    assert_eq!(every_statement(&Tree::of(&[])).len(), 1);
    assert_eq!(
        every_statement(&Tree::of(&[(PAGE, &whole)])).len(),
        1,
        "without the verbs nothing is checked"
    );
}

#[test]
fn citations_lead_to_rows() {
    let with = |path: &str, line: &str| {
        let tree = Tree::of(&[(PAGE, &page("| name | | | | empty | | |")), (path, line)]);
        citations(&tree).iter().map(|f| f.to_string()).collect::<Vec<_>>()
    };
    let none = Vec::<String>::new();
    assert_eq!(with("a/src/b.rs", "//! Widths [R97, eq. 37], [D98, eq. 18] and [D98, 2.1]."), none);
    assert_eq!(
        with("a/src/b.rs", "// [R97, eq. 64]"),
        [format!("a/src/b.rs:1: {PAGE} has no row for R97, eq. 64")]
    );
    assert_eq!(with("NOTATION.md", "| E | `Caps` | R97, 1, 2, 71 |").len(), 1);
    assert_eq!(with("a/src/b.rs", "// [M86, eq. 1]: it numbers none").len(), 1);
    assert_eq!(with("a/src/b.rs", "// [Z17, Fig. 17]").len(), 1);
    assert_eq!(with("a/b.txt", "[R97, eq. 99]"), none);
}

#[test]
fn numbers_are_read_as_they_are_cited() {
    let of = |line: &str| cited(line, &["R97", "D98", "Z17"]).into_iter().map(|(_, n)| n).collect::<Vec<_>>();
    assert_eq!(of("[R97, eqs. 1, 2 and 45; the"), ["eq. 1", "eq. 2", "eq. 45"]);
    assert_eq!(of("[R97, eqs. 31 to 33]"), ["eq. 31", "eq. 32", "eq. 33"]);
    assert_eq!(of("[R97, eq. 51-53]"), ["eq. 51", "eq. 52", "eq. 53"]);
    assert_eq!(of("planar one of R97 (37)."), ["eq. 37"]);
    assert_eq!(of("D98's figure 7, and [Z17, Fig. 4]; Table 1 of"), ["fig. 7", "fig. 4"]);
    assert_eq!(of("D98, eq. 18, u from 0 to 1"), ["eq. 18"]);
    for none in ["[D98, 1.3 and 2]", "R97 2CL", "of R97's claim", "XR97, eq. 3", "R97, limit of 37", "R97"] {
        assert!(of(none).is_empty(), "{none}");
    }
}
