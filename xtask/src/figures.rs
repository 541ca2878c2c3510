//! `cargo xtask figures`: the figures of the gallery, `docs/figures/*.svg`, and the page that shows them.
//!
//! The figures are what `osculate lines` draws; the same sources give the same bytes.

use crate::cmd::{Failure, cargo, output, root};
use std::path::Path;

/// The figures: file, title, built-in surface, what to see.
const FIGURES: [(&str, &str, &str, &str); 8] = [
    (
        "m86-1",
        "M86, surface 1",
        "kind = \"m86-1\"",
        "Nothing in the way: the lines of curvature run nearly parallel to the lines of constant difference, so that a five-axis strip keeps its width. No contour closes.",
    ),
    (
        "m86-2",
        "M86, surface 2",
        "kind = \"m86-2\"",
        "The difference of the curvatures has a maximum inside: there the five-axis strip is narrowest.",
    ),
    (
        "m86-3",
        "M86, surface 3",
        "kind = \"m86-3\"",
        "One umbilic, around which the lines of curvature turn, and one contour minimum, around which contours close and a flat end cannot go.",
    ),
    (
        "m86-4",
        "M86, surface 4",
        "kind = \"m86-4\"",
        "Two umbilics and one contour minimum: five-axis strips vary from point to point.",
    ),
    (
        "ellipsoid",
        "Ellipsoid 3, 2, 1",
        "kind = \"ellipsoid\", semi_axes_mm = [3, 2, 1]",
        "Four lemons; lines of curvature on confocal quadrics; ridges on the principal sections, changing family at the umbilics.",
    ),
    (
        "monkey-saddle",
        "Monkey saddle",
        "kind = \"monkey_saddle\"",
        "One star of index -1/2, where three lines of each family meet.",
    ),
    (
        "enneper",
        "Enneper's surface",
        "kind = \"enneper\"",
        "Minimal: the lines of curvature are the parameter lines, the asymptotic lines their diagonals.",
    ),
    (
        "torus",
        "Torus 5, 2",
        "kind = \"torus\", major_radius_mm = 5, minor_radius_mm = 2",
        "Lines of curvature and lines of constant difference are its circles; parabolic on top and bottom.",
    ),
];

/// Draws every figure and writes the page.
pub fn run() -> Result<(), Failure> {
    let root = root()?;
    let docs = root.join("docs");
    let work = root.join("target").join("figures");
    let mut page = String::from(
        "# Gallery\n\nCharacteristic lines of the surfaces with a name, after figures a to f of M86. `cargo xtask figures` \
         draws them with `osculate lines`; `osculate gallery` lists the surfaces. The paper prints no control points for \
         its four surfaces: ours are of our own design, with the features that the paper names.\n",
    );
    for (file, title, keys, text) in FIGURES {
        let folder = work.join(file);
        let out = folder.to_string_lossy().into_owned();
        let arguments =
            ["run", "--quiet", "--locked", "-p", "osculate", "--", "lines", "--builtin", keys, "--out", &out];
        output(cargo(&root, &arguments))?;
        copy(&folder.join("figures.svg"), &docs.join("figures").join(format!("{file}.svg")))?;
        page.push_str(&format!(
            "\n## {title}\n\n`--builtin '{keys}'`\n\n{text}\n\n![{title}](figures/{file}.svg)\n"
        ));
        println!("figures: {file}");
    }
    write(&docs.join("gallery.md"), &page)
}

fn copy(from: &Path, to: &Path) -> Result<(), Failure> {
    let text =
        std::fs::read_to_string(from).map_err(|why| Failure::Read { path: from.to_path_buf(), why })?;
    write(to, &text)
}

fn write(to: &Path, text: &str) -> Result<(), Failure> {
    let made = to.parent().map_or(Ok(()), std::fs::create_dir_all);
    made.and_then(|()| std::fs::write(to, text)).map_err(|why| Failure::Write { path: to.to_path_buf(), why })
}
