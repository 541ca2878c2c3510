//! What has to be said of each damaged file of the collection: words that its error, its diagnostics or the list of what
//! was not used must have. They follow from what is wrong with each file.

use osculate_surfaces::{ImportError, Part};

/// Beginning or whole of a file's name, and the words.
type Wanted = (&'static str, &'static [&'static str]);

const TESSELLATED: &[&str] = &["tessellated geometry"];
const ELSEWHERE: &[&str] = &["#10", "another file"];
const SIGNED: &[&str] = &["line 13", "behind END-ISO-10303-21"];
const BUILDING: &[&str] = &["IFCPERSON", "a building model, which is not read"];

const WANTED: &[Wanted] = &[
    ("brlcad_ap203_invalid_brep.stp", &["#26, line 20", "CYLINDRICAL_SURFACE", "enclose no area"]),
    ("brlcad_ap203_unsupported_geometry.stp", &["SHAPE_REPRESENTATION", "a representation without faces"]),
    ("brlcad_ap214_csg_invalid.stp", &["CSG_SOLID", "a solid without boundary faces"]),
    ("brlcad_ap214_lazy_diagnostics.stp", &["#1, line 8", "#99, which is not in the file (2 times)"]),
    ("brlcad_ap242_tessellated_malformed.stp", TESSELLATED),
    ("cadmpeg_ap07_malformed_short_strip.p21", TESSELLATED),
    ("cadmpeg_ts01_", TESSELLATED),
    ("cadmpeg_ce02_composition_subsidiary.p21", &["line 11: #20", "another file"]),
    ("cadmpeg_ce02_root_forwarded_unparsed.p21", ELSEWHERE),
    ("cadmpeg_ce02_subsidiary_unparsed.p21", &["no format that is read", "ISO-10303-21"]),
    ("cadmpeg_ce02_subsidiary_valid.p21", &["ITEM"]),
    ("cadmpeg_er03_root.p21", ELSEWHERE),
    ("cadmpeg_er03_root_distinct_resources.p21", &["#10", "#11", "another file"]),
    ("cadmpeg_er03_root_valid.p21", ELSEWHERE),
    ("cadmpeg_er03_subsidiary_", &["ITEM"]),
    ("cadmpeg_sg0", SIGNED),
    ("cadmpegfuzz_iges_cards__point_5_3", &["116 point", "no face uses it"]),
    ("cadmpegfuzz_iges_cards__trimmed_plane_5_3", &[]),
    ("cadmpegfuzz_iges_cards__truncated", &["no directory entry section", "truncated", "export it again"]),
    ("cadmpegfuzz_step_decode__minimal", &["CARTESIAN_POINT", "no face refers to it"]),
    ("cadmpegfuzz_step_reader__minimal", &["CARTESIAN_POINT", "no face refers to it"]),
    ("cadmpegfuzz_step_lexer__escapes", &["!X", "a user-defined entity"]),
    ("cadmpegfuzz_step_parser__edition3", &["X", "no face refers to it"]),
    ("cadmpegfuzz_step_parser__minimal", &["Y", "no face refers to it"]),
    ("gitlfs_pointer_not_step.stp", &["no format that is read", "git-lfs"]),
    ("igesio_first_line_82_cols.iges", &["no format that is read", "column 73"]),
    ("igesio_first_line_without_80_cols.iges", &["no directory entry section", "export it again"]),
    ("ios_fail_duplicate_id.ifc", &["#19, line 26", "defined 2 times"]),
    ("ios_fail_multiple_duplicate_ids.ifc", &["#18, line 24", "#19, line 26", "defined 2 times"]),
    ("ios_", BUILDING),
    ("stepcode_comments.p21", &["CARTESIAN_POINT", "no face refers to it"]),
    ("stepcode_missing_and_required.p21", &["CARTESIAN_POINT", "no face refers to it"]),
    ("stepcode_select_segfault_2.stp", &["DRC", "DRE"]),
    ("stepcode_test_inherit_inverse.p21", &["REPRESENTATION", "a representation without faces"]),
    ("stepcode_test_inverse_attr.p21", &["RELDEFINESBYTYPE", "no face refers to it"]),
];

/// The first words that are missing in what is said of a file; all of them where the file is not known.
pub fn missing(name: &str, part: &Result<Part, ImportError>) -> Option<&'static str> {
    let Some((_, words)) = WANTED.iter().find(|w| name.starts_with(w.0)) else {
        return Some("an entry of this file in malformed.rs");
    };
    let said = match part {
        Err(why) => why.to_string(),
        Ok(part) => {
            let left = part.not_used.iter().map(|n| format!("{} {} {}\n", n.kind, n.count, n.why));
            part.diagnostics.iter().map(|d| format!("{d}\n")).chain(left).collect()
        }
    };
    words.iter().find(|w| !said.contains(**w)).copied()
}
