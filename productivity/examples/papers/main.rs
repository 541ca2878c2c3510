//! The pages of R97 and M86, every closed form held against the exact strip:
//! `cargo run -p osculate-productivity --example papers -- docs [r97] [m86]`.
#![allow(clippy::print_stdout, clippy::expect_used)]

mod forms;
mod m86;
mod plot;
mod r97;

use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let docs = Path::new(arguments.first().map_or("docs", String::as_str));
    let wanted = |paper: &str| arguments.len() < 2 || arguments[1..].iter().any(|a| a == paper);
    std::fs::create_dir_all(docs.join("papers"))?;
    for (name, text) in pages(wanted) {
        std::fs::write(docs.join(&name), text)?;
        println!("{}", docs.join(&name).display());
    }
    Ok(())
}

/// The pages of papers that are wanted and their pictures, and the page of all forms, by file. A test makes them too.
pub fn pages(wanted: impl Fn(&str) -> bool) -> Vec<(String, String)> {
    let rows = forms::all();
    let mut files: Vec<(String, String)> = Vec::new();
    if wanted("r97") {
        files.extend(r97::page(&rows));
    }
    if wanted("m86") {
        files.extend(m86::page(&rows));
    }
    let mut files: Vec<_> = files.into_iter().map(|(name, text)| (format!("papers/{name}"), text)).collect();
    files.push(("closed-forms.md".into(), closed_forms(&rows)));
    files
}

fn closed_forms(rows: &[forms::Row]) -> String {
    format!(
        "# Closed forms of strip width and feed\n\n\
         Made by `cargo xtask papers r97 m86`. Each form is held against the exact strip (`tools::strip::exact`) or tooth mark\n\
         (`tools::strip::mark`) at up to 160 contacts on tori, ellipsoids and NURBS patches of its domain; h is the tolerance, R the\n\
         tool's radius. *Order* is the power of h with which the relative error falls; *observed* is that of the largest deviation\n\
         between h/R = 1e-2 and 1e-4. The same is kept by the property tests `productivity/tests/against_exact.rs`.\n\n{}\n\
         An order of 0 means that the form does not tend to the exact width: off Q's eigenvectors the tool passes a point beside the\n\
         contact at its lowest when it is not abreast of it, and the planar section misses that. The *swept* leading order,\n\
         `2 sqrt(2 h / (q_cc - q_lc^2 / q_ll))`, has it. The 5C form of the paper takes D for `k_f cos^2(lead) - k_y + k_y^3 R^2` and\n\
         the chord for the arc: about 1 % at any tolerance.\n",
        forms::table(rows)
    )
}
