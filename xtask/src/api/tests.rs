//! Lists of small crates in a temporary folder.

use super::{Action, Counts, changes, list, tree::Crate};
use crate::cmd::write;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

/// A folder of its own for each crate.
static NEXT: AtomicUsize = AtomicUsize::new(0);

struct Folder(PathBuf);

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// The lines of a crate `small`, or what is wrong with it.
fn lines(files: &[(&str, &str)]) -> Result<Vec<String>, String> {
    let name = format!("osculate-api-{}-{}", std::process::id(), NEXT.fetch_add(1, Ordering::Relaxed));
    let folder = Folder(std::env::temp_dir().join(name));
    write(
        &folder.0.join("Cargo.toml"),
        "[package]\nname = \"small\"\n\n[dependencies]\nother-crate.workspace = true\n",
    )
    .unwrap();
    for (path, text) in files {
        write(&folder.0.join("src").join(path), text).unwrap();
    }
    let read = Crate::read(&folder.0, Path::new("small"), "small").and_then(|found| list::lines(&found));
    read.map_err(|why| why.to_string())
}

const ROOT: &str = "
    mod hidden;
    pub mod open;
    mod inner { pub mod deep { pub struct Deep { pub a: f64, b: u8 } pub fn loose() {} fn own() {} } }
    #[cfg(test)] pub mod tests;
    pub use hidden::{Kept, Old as New, both};
    pub use inner::deep::*;
    pub use other_crate::{self, Thing as Other};
    pub use open::Shape as Form;
    pub(crate) fn for_the_crate() {}
    pub use hidden::names;
";

/// A crate with every way of handing an item on.
const FILES: [(&str, &str); 4] = [
    ("lib.rs", ROOT),
    (
        "hidden/mod.rs",
        "mod further;
         pub use self::further::both;
         pub mod names { pub const ONE: [u8; 2] = [0; 2]; }
         #[derive(Clone)] #[cfg_attr(feature = \"f\", derive(Debug))] #[non_exhaustive] pub enum Kept { A, B(u8, String), C { x: f64 } }
         pub struct Old(pub f64, u8);
         pub struct Lost;
         impl Lost { pub fn never(&self) {} }
         impl Old { fn private(&self) {} }",
    ),
    (
        "hidden/further.rs",
        "use super::{Kept, Old};
         pub fn both<'a, T: ?Sized>(
             mut a: &'a T,
             (_b, _c): (f64, u8),
         ) -> Option<Vec<T>> where T: Clone { None }
         impl Kept { pub const fn kind(&self) -> u8 { 0 } pub(crate) fn inside(&self) {} }
         impl From<f64> for Old { fn from(x: f64) -> Self { Old(x, 0) } }
         impl PartialEq for Old { fn eq(&self, o: &Self) -> bool { true } }",
    ),
    (
        "open.rs",
        "pub trait Shape: Send { type Out; const N: usize = 3; fn one(&self, at: f64) -> Self::Out; fn two(&mut self) {} }
         macro_rules! made { ($($name:ident),*) => { $(pub struct $name; impl $name { pub fn get(self) -> u8 { 1 } })* } }
         made!(First, Second);
         pub struct Many<const N: usize>([f64; N]);
         pub type Two = Many<2>;
         impl Two { pub fn pair(&self) {} }
         impl<const N: usize> Many<N> { #[must_use] pub fn all(&self) -> &[f64; N] { &self.0 } }
         impl<S: Shape + ?Sized> Shape for Box<S> { type Out = S::Out; fn one(&self, at: f64) -> S::Out { (**self).one(at) } }
         #[macro_export] macro_rules! call { (one $x:expr) => { $x }; (two) => { 2 }; }",
    ),
];

#[test]
fn every_item_that_is_reached_stands_at_its_shortest_path_and_no_other() {
    let expected = [
        "pub macro small::call!(one $x: expr)",
        "pub macro small::call!(two)",
        "impl small::Kept: Clone, Debug",
        "#[non_exhaustive] pub enum small::Kept",
        "variant small::Kept::A",
        "variant small::Kept::B(u8, String)",
        "variant small::Kept::C { x: f64 }",
        "pub const fn small::Kept::kind(&self) -> u8",
    ];
    let found = lines(&FILES).unwrap();
    for line in expected {
        assert!(found.iter().any(|l| l == line), "{line} is not in\n{}", found.join("\n"));
    }
    let mut left: Vec<&str> = found.iter().map(String::as_str).filter(|l| !expected.contains(l)).collect();
    left.sort_unstable();
    let mut rest = [
        "impl small::New: From<f64>, PartialEq",
        "impl<S: Shape + ?Sized> small::Form for Box<S> (Out = S::Out)",
        "provided const small::Form::N: usize",
        "provided fn small::Form::two(&mut self)",
        "pub const small::names::ONE: [u8; 2]",
        "pub field small::Deep::a: f64",
        "pub fn small::both<'a, T: ?Sized>(a: &'a T, _: (f64, u8)) -> Option<Vec<T>> where T: Clone",
        "pub fn small::loose()",
        "pub fn small::open::First::get(self) -> u8",
        "pub fn small::open::Many::all(&self) -> &[f64; N] [impl<const N: usize> Many<N>]",
        "pub fn small::open::Many::pair(&self) [impl Two]",
        "pub fn small::open::Second::get(self) -> u8",
        "pub mod small::names",
        "pub mod small::open",
        "pub struct small::Deep (with private fields)",
        "pub struct small::New(pub f64, _)",
        "pub struct small::open::First;",
        "pub struct small::open::Many<const N: usize>(_)",
        "pub struct small::open::Second;",
        "pub trait small::Form: Send",
        "pub type small::open::Two = Many<2>",
        "pub use small::Other = other_crate::Thing",
        "pub use small::open::Shape = small::Form",
        "pub use small::other_crate = other_crate",
        "required fn small::Form::one(&self, at: f64) -> Self::Out",
        "required type small::Form::Out",
    ];
    rest.sort_unstable();
    assert_eq!(left, rest);
}

#[test]
fn a_signature_that_changes_shows_as_a_difference() {
    let kept = lines(&FILES).unwrap();
    assert!(changes(&(kept.join("\n") + "\n"), &kept, "small").is_empty());
    let changed =
        FILES.map(|(path, text)| (path, text.replace("kind(&self) -> u8", "kind(&self, of: f64) -> u8")));
    let changed = changed.each_ref().map(|(path, text)| (*path, text.as_str()));
    assert_eq!(
        changes(&kept.join("\n"), &lines(&changed).unwrap(), "small"),
        [
            "- pub const fn small::Kept::kind(&self) -> u8",
            "+ pub const fn small::Kept::kind(&self, of: f64) -> u8"
        ]
    );
}

#[test]
fn what_cannot_be_told_is_an_error_that_names_the_file() {
    for (text, words) in [
        ("mod a;", ["small/src/lib.rs", "mod a; has no file a.rs or a/mod.rs"]),
        ("pub use a::B;", ["small/src/lib.rs", "pub use a::B: nothing of this name is found"]),
        ("impl Unknown { pub fn f() {} }", ["small/src/lib.rs", "`Unknown` leads to 0 types"]),
        ("macro_made!(A);", ["small/src/lib.rs", "0 macros of this crate have its name"]),
        ("pub struct A; impl A { made!(b); }", ["small/src/lib.rs", "what this makes is not known"]),
        ("pub fn 3", ["small/src/lib.rs", "expected identifier"]),
        (
            "mod a { pub struct X; } mod b { pub struct X; } use a::*; use b::*; mod c { use super::d::X; impl X { pub fn f() {} } } mod d {}",
            ["small/src/lib.rs", "`X` leads to 0 types"],
        ),
    ] {
        let said = lines(&[("lib.rs", text)]).unwrap_err();
        assert!(words.iter().all(|w| said.contains(w)), "{text}: {said}");
    }
}

#[test]
fn circles_of_globs_and_items_under_conditions_end() {
    let text =
        "pub mod a { pub use super::b::*; pub struct A; } pub mod b { pub use super::a::*; pub struct B; }
                #[cfg(unix)] pub fn f() {} #[cfg(not(unix))] pub fn f(x: u8) {}";
    let found = lines(&[("lib.rs", text)]).unwrap();
    for line in [
        "pub struct small::a::A;",
        "pub use small::b::A = small::a::A",
        "pub struct small::a::B;",
        "pub use small::b::B = small::a::B",
        "#[cfg(unix)] pub fn small::f()",
        "#[cfg(not(unix))] pub fn small::f(x: u8)",
    ] {
        assert!(found.iter().any(|l| l == line), "{line} is not in\n{}", found.join("\n"));
    }
}

#[test]
fn a_function_in_modules_of_its_name_is_found() {
    let text = "mod a { mod same { mod same { pub fn same() {} } pub use same::same; } pub use same::same; } pub use a::same;
                mod b { use super::c::d; pub use d::d; } mod c { pub mod d { pub fn d() {} } } pub use b::d;";
    assert_eq!(lines(&[("lib.rs", text)]).unwrap(), ["pub fn small::d()", "pub fn small::same()"]);
}

#[test]
fn items_are_counted() {
    let counts = Counts::of(&lines(&FILES).unwrap());
    let expected = Counts { lines: 34, modules: 2, structs: 5, enums: 1, open: 1, traits: 1, functions: 9 };
    assert_eq!(counts, expected);
    assert_eq!(Action::of(&["--bless"]), Some(Action::Bless));
    assert!(Action::of(&["--blessed"]).is_none() && Action::of(&["--bless", "--count"]).is_none());
}
