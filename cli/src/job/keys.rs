//! All keys of a job file: what each takes, what holds where it is not given, and what it means.

use crate::job::language::Language;
use crate::job::schema::{Key, Kind, Range, Schema, TOOLS, Table};
use crate::job::words::{
    Accept, AlongWord, AxisKey, AxisWord, ClimbWord, CoolantWord, DirectionsKey, EffortWord, EntryWord,
    FeedWord, FlankShape, Gouges, LeanKey, MaterialWord, Method, Normals, OperationWord, StrategyWord, Tip,
    ToolKind, Turns,
};
use osculate_postproc::built_in_names;
use std::sync::LazyLock;

const ANY: Range = Range { least: f64::NEG_INFINITY, most: f64::INFINITY, open: [false; 2] };
const ABOVE: Range = Range { least: 0.0, most: 1e6, open: [true, false] };
/// Across a cutter: a micrometre is a tenth of the thinnest that is sold.
const ACROSS: Range = Range { least: 1e-3, most: 1e6, open: [false; 2] };
const NOT_BELOW: Range = Range { least: 0.0, most: 1e6, open: [false; 2] };
/// What a tolerance may be: a nanometre is below what rounding of coordinates leaves.
const FINE: Range = Range { least: 1e-6, most: 1e3, open: [false; 2] };
const FAR: Range = Range { least: -1e6, most: 1e6, open: [false; 2] };
const LEAN: Range = Range { least: -90.0, most: 90.0, open: [true; 2] };
const ASIDE: Range = Range { least: -60.0, most: 60.0, open: [false; 2] };
const TURN: Range = Range { least: -360.0, most: 360.0, open: [false; 2] };

/// Places of a circle: more are no part of a machine.
const MOST_PLACES: i64 = 1000;

const MM: Kind = Kind::Number(ABOVE, "mm");
const MM_OR_ZERO: Kind = Kind::Number(NOT_BELOW, "mm");
const SMALL: Kind = Kind::Number(FINE, "mm");
const RATE: Range = Range { least: 0.0, most: 1e9, open: [true, false] };
const RAMP: Kind = Kind::Number(Range { least: 0.0, most: 45.0, open: [true, false] }, "deg");
const SHARE: Kind = Kind::Number(Range { least: 0.0, most: 1.0, open: [true, false] }, "");
const DIRECTIONS: Kind = Kind::WholeOr(1, 100, DirectionsKey::WORDS);
const TRIPLE: Kind = Kind::Numbers(3, FAR, "mm");

/// A key that must be given where its table is.
const fn must(name: &'static str, kind: Kind, example: &'static str, meaning: &'static str) -> Key {
    Key { name, kind, default: None, example, meaning }
}

/// A key that may be left out.
const fn may(
    name: &'static str,
    kind: Kind,
    default: &'static str,
    example: &'static str,
    meaning: &'static str,
) -> Key {
    Key { name, kind, default: Some(default), example, meaning }
}

const fn table(name: &'static str, needed: bool, meaning: &'static str, keys: &'static [Key]) -> Table {
    Table { name, needed, meaning, keys }
}

fn dialects() -> Vec<&'static str> {
    Language::names()
}

/// What a job of one operation may hold.
pub static ONE: LazyLock<Schema> =
    LazyLock::new(|| Schema { format: 1, tables: TABLES.to_vec(), lists: &[(TOOLS, "tool")] });

/// What a list of operations may hold: the tables that it has in common with a job of one operation, and its own.
pub static LIST: LazyLock<Schema> = LazyLock::new(|| {
    let common = [
        "part",
        "part.side",
        "part.ruled",
        "part.ruled.c0",
        "part.ruled.c1",
        "tool",
        "tool.holder",
        "tolerance",
        "cutting",
    ];
    let last = ["machine", "stock", "stock.cylinder", "setup", "verification"];
    let of = |names: &[&str]| TABLES.iter().filter(|t| names.contains(&t.name)).copied().collect::<Vec<_>>();
    let renamed = |from: &str, name: &'static str| {
        TABLES
            .iter()
            .filter(|t| t.name == from)
            .map(|t| Table { name, needed: false, ..*t })
            .collect::<Vec<_>>()
    };
    let tables = [
        OWN[..1].to_vec(),
        of(&common),
        renamed("cutting", "tool.cutting"),
        of(&last),
        OWN[1..].to_vec(),
        renamed("strategy", "operation.strategy"),
    ];
    Schema {
        format: 2,
        tables: tables.concat(),
        lists: &[("tool", "tool"), ("setup", "setup"), ("operation", "operation")],
    }
});

/// What a library of tools may hold: the same tables as the tools of a list of operations.
pub static LIBRARY: LazyLock<Schema> = LazyLock::new(|| {
    let named =
        |from: &[Table], name: &str| from.iter().filter(|t| t.name == name).copied().collect::<Vec<_>>();
    let cutting: Vec<Table> = named(TABLES, "cutting")
        .iter()
        .map(|t| Table { name: "tool.cutting", needed: false, ..*t })
        .collect();
    const FORMAT: &[Key] =
        &[must("format", Kind::Whole(1, 1), "1", "format of the file: a library of tools")];
    let own = table("", true, "the file itself", FORMAT);
    let tables =
        [vec![own], named(TABLES, "tool"), named(TABLES, "tool.holder"), cutting, named(OWN, "tool")];
    Schema { format: 1, tables: tables.concat(), lists: &[("tool", "tool")] }
});

/// The tables that only a list of operations has, and keys that tables have only there.
#[rustfmt::skip]
static OWN: &[Table] = &[
    table("", true, "the file itself", &[
        must("format", Kind::Whole(2, 2), "2", "format of the file: operations in their order"),
    ]),
    table("tool", false, "in a list of operations [[tool]] is a list", &[
        may("name", Kind::Text, "by kind and sizes", "\"toroidal 6 r 1\"", "what people call it"),
    ]),
    table("setup", false, "in a list of operations [[setup]] is a list; one with all defaults where none is given", &[
        may("name", Kind::Text, "op and its place times ten", "\"op10\"", "how operations name it, and its program"),
        may("fixtures", Kind::Files, "none", "[\"vice.stl\"]", "what holds the part in it: STL, PLY or 3MF meshes in the part's frame, mm"),
        may("fixture_spacing_mm", MM, "1", "1", "distance of the places looked at on fixtures"),
    ]),
    table("operation", false, "what is done, one after the other, each from the material that the one before left", &[
        may("name", Kind::Text, "by kind and place", "\"rough\"", "what people call it"),
        may("setup", Kind::Text, "the first one", "\"op10\"", "in which setup"),
        must("kind", Kind::Word(OperationWord::WORDS), "\"finish\"", "rough: in layers down to an allowance; finish: to tolerance; rest: where too much stands"),
        may("tools", Kind::Wholes(1, 9999), "all tools", "[3, 4]", "numbers of tools; of several the fastest that holds is chosen"),
        may("faces", Kind::Faces, "those of the part", "[\"F1\", \"F2\"]", "faces to machine"),
        may("repeat", Kind::WholeOrTable(2, MOST_PLACES), "planned where its faces are, once", "6",
            "equal places in a circle: planned at its faces, and repeated by turning about an axis of the part"),
        may("allowance_mm", MM_OR_ZERO, "rough: 0.5", "0.5", "what it leaves on the faces on purpose"),
        may("stepdown_mm", MM, "rough: a quarter of the diameter", "3", "deepest cut along the axis"),
        may("stepover_mm", MM, "rough: 0.4 of the diameter", "5", "distance of rows"),
        may("axis", Kind::Direction, "rough: [0, 0, 1]", "[0, 0, 1]", "rough: the tool's axis, from tip to holder"),
        may("directions", DIRECTIONS, "rough: one, axis", "\"auto\"", "rough: axes found from where most is reached; no more than so many"),
        may("least_share", SHARE, "0.02", "0.02", "rough: a found axis that takes less than this share is not taken"),
        may("entry", Kind::Word(EntryWord::WORDS), "auto", "\"helix\"", "rough: the way into material where none leads in from outside"),
        may("ramp_deg", RAMP, "3", "3", "rough: steepest way down into material"),
        may("volume_rate_mm3_min", Kind::Number(RATE, "mm3/min"), "no limit", "12000",
            "rough: most that is taken a minute; the feed follows"),
        may("overlap_mm", MM, "rest: a tenth of the diameter", "0.5", "how far passes go beyond what stands too high"),
        may("scallop_mm", SMALL, "that of the job, of which 0.92 are planned; rough: stepdown", "0.02", "highest material left standing, above the allowance"),
        may("gouge_mm", SMALL, "that of the job; rough: a fifth of the allowance", "0.01", "deepest undercut, into the allowance of a roughing"),
    ]),
    table("operation.repeat", false, "equal places in a circle about an axis that the part does not show by itself", &[
        may("axis", Kind::Direction, "[0, 0, 1]", "[0, 0, 1]", "direction of the axis"),
        may("at_mm", TRIPLE, "[0, 0, 0]", "[0, 0, 0]", "a point of it"),
        must("count", Kind::Whole(2, MOST_PLACES), "6", "how many places, that of its faces counted"),
    ]),
];

/// The tables of a job file in the order of the reference.
#[rustfmt::skip]
pub static TABLES: &[Table] = &[
    table("", true, "the file itself", &[
        must("format", Kind::Whole(1, 1), "1", "format of the file: one operation; 2 is a list of them"),
    ]),
    table("part", true, "the part and which of its faces: one of file, builtin and [part.ruled]", &[
        may("file", Kind::File, "", "\"part.step\"", "STEP, IGES, JSON, point sections or patches"),
        may("builtin", Kind::Builtin, "", "{ kind = \"paraboloid\", a_per_mm = 0.005, b_per_mm = -0.003, half_size_mm = 20 }",
            "a built-in surface instead of a file"),
        may("unit_mm", MM, "as the file says", "25.4", "millimetres in a unit of point sections, patches or meshes"),
        may("faces", Kind::Faces, "all", "[\"F1\", \"F2\"]", "faces to machine, as `inspect` prints their ids"),
        may("check_faces", Kind::Faces, "none named", "\"all\"", "faces that the tool must not touch"),
        may("may_hit", Kind::Others, "none", "[\"F3\"]", "faces not machined that the tool may cut or hit; the verdict's scope says so"),
        may("normals", Kind::Word(Normals::WORDS), "auto", "\"file\"", "side of the material for faces whose file does not say it"),
    ]),
    table("part.side", false, "the side of the material of faces of which neither the file nor the part says it; [[part.side]] are several", &[
        must("faces", Kind::Ids, "[\"F12\"]", "the faces, by the ids that `inspect` prints"),
        must("material", Kind::Word(MaterialWord::WORDS), "\"below_normal\"", "where the material is, seen along S_u x S_v as `probe` shows it"),
    ]),
    table("part.ruled", false, "the surface between two curves", &[]),
    table("part.ruled.c0", true, "the curve at v = 0: a NURBS curve, or points for a cubic through them", CURVE),
    table("part.ruled.c1", true, "the curve at v = 1", CURVE),
    table("tool", false, "the cutter; [[tools]] with the same keys is a list to choose from", &[
        must("kind", Kind::Word(ToolKind::WORDS), "\"ball\"", "kind of cutter"),
        must("diameter_mm", Kind::Number(ACROSS, "mm"), "10", "outer diameter; of apt, d"),
        may("number", Kind::Whole(1, 9999), "1; in [[tools]] its place", "3", "number of the tool in the program"),
        may("corner_radius_mm", MM_OR_ZERO, "by the kind", "5", "radius of the rounded end or corner"),
        may("length_mm", MM, "five diameters", "60", "from the tip to the holder"),
        may("flute_length_mm", MM, "the length", "20", "from the tip to where the cutting edges end"),
        may("taper_deg", Kind::Number(Range { least: 0.0, most: 90.0, open: [true; 2] }, "deg"), "", "10", "cone: half its angle"),
        may("tip_diameter_mm", MM_OR_ZERO, "a ball tip", "2", "cone: diameter at the tip"),
        may("barrel_radius_mm", MM, "", "80", "barrel: radius of the large arc"),
        may("bottom_angle_deg", Kind::Number(LEAN, "deg"), "0", "2", "apt: rise of the bottom"),
        may("side_angle_deg", Kind::Number(LEAN, "deg"), "0", "5", "apt: opening of the side"),
        may("teeth", Kind::Whole(1, 1000), "", "4", "number of teeth, for feed_per_tooth_mm"),
        may("plunges", Kind::Flag, "false", "true", "whether it may go straight down into material"),
    ]),
    table("tool.holder", false, "a cylinder or cone above the cutter; holder = [{ ... }, { ... }] are several, from the nose upwards", &[
        must("diameter_mm", MM, "40", "diameter, at the lower end"),
        must("length_mm", MM, "60", "length"),
        may("upper_diameter_mm", MM, "diameter_mm", "50", "diameter at the upper end of a cone"),
    ]),
    table("tolerance", true, "what must hold", &[
        must("scallop_mm", SMALL, "0.01", "highest material left standing"),
        may("gouge_mm", SMALL, "half of scallop_mm", "0.005", "deepest undercut that is accepted"),
        may("chord_mm", SMALL, "a fifth of scallop_mm", "0.002", "how far straight moves may be off the path; `auto` takes twice the default where that is quicker"),
        may("unreached_mm2", Kind::Number(Range { least: 0.0, most: 1e9, open: [false; 2] }, "mm2"), "0", "2.5",
            "area that no tool reaches and that is accepted"),
    ]),
    table("strategy", false, "how to cut", &[
        may("kind", Kind::Word(StrategyWord::WORDS), "auto", "\"isoparametric\"", "the way of the passes; auto chooses"),
        may("effort", Kind::Word(EffortWord::WORDS), "normal", "\"long\"", "auto, or several tools: how much is tried; quick: little around the first that holds"),
        may("lead_deg", Kind::NumberOr(LEAN, "deg", LeanKey::WORDS), "auto", "15", "lean of the axis towards the feed"),
        may("lead_rate_deg_per_mm", Kind::Number(Range { least: 0.0, most: 1e3, open: [true, false] }, "deg/mm"), "1", "0.5",
            "lead_deg = \"local\": its greatest change along the face"),
        may("tilt_deg", Kind::NumberOr(TURN, "deg", LeanKey::WORDS), "auto", "5",
            "turn of the leaning axis about the normal; \"local\": strips reach as far to both sides"),
        may("side_tilt_deg", Kind::Number(ASIDE, "deg"), "none", "15",
            "isoparametric, regions: lean to the left of the growing parameter, the same for passes to and fro; lead_deg is 0 where not given"),
        may("along", Kind::Word(AlongWord::WORDS), "auto", "\"u\"", "isoparametric, regions: the parameter along the passes"),
        may("axis", Kind::DirectionOr(AxisKey::WORDS), "\"feed\", or [0, 0, 1]", "\"field\"",
            "\"feed\": it leans along the feed; \"field\": the same for passes to and fro; a direction: contour_2cl, gradient_3c, isoplanar_3c, waterline_3c, z_level keep it; auto: its ways that keep one, the nearest to the mean normal where not given"),
        may("one_way", Kind::Flag, "false", "true", "axis = \"field\": neighbouring passes all run the same way"),
        may("climb", Kind::Word(ClimbWord::WORDS), "any", "\"climb\"",
            "waterline_3c, axis = \"field\": chips from thick to thin (M3: what is still to be cut on the right of the feed), or the other way"),
        may("feed_direction", Kind::Direction, "the longest side", "[1, 0, 0]", "gradient_3c, isoplanar_3c, z_level: way of the passes"),
        may("normal", Kind::Direction, "[0, 1, 0]", "[0, 1, 0]", "isoplanar: normal of the planes"),
        may("stepdown_mm", MM, "", "3", "z_level: deepest cut along the axis"),
        may("stepover_mm", MM, "", "5", "z_level: distance of rows"),
        may("allowance_mm", MM_OR_ZERO, "0", "0.5", "z_level: what it leaves on the faces"),
        may("ramp_deg", RAMP, "3", "3", "z_level: steepest way down into material"),
        may("directions", DIRECTIONS, "one, axis", "\"auto\"", "z_level: axes found from where most is reached; no more than so many"),
        may("least_share", SHARE, "0.02", "0.02", "z_level: a found axis that takes less than this share is not taken"),
        may("entry", Kind::Word(EntryWord::WORDS), "auto", "\"helix\"", "z_level: the way into material where none leads in from outside"),
        may("volume_rate_mm3_min", Kind::Number(RATE, "mm3/min"), "no limit", "12000",
            "z_level: most that is taken a minute; the feed follows"),
        may("gouges", Kind::Word(Gouges::WORDS), "report", "\"leave_out\"", "places where the tool would go into the part"),
        may("keep_off_mm", MM_OR_ZERO, "0", "0.5", "gouges = \"leave_out\": distance kept from check faces"),
    ]),
    table("cutting", false, "spindle and feed", &[
        may("spindle_rpm", Kind::Number(ABOVE, "rpm"), "", "8000", "spindle speed"),
        may("feed_mm_min", Kind::Number(ABOVE, "mm/min"), "1000", "2000", "feed of the tip on the part"),
        may("air_feed_mm_min", Kind::Number(ABOVE, "mm/min"), "feed_mm_min", "6000", "roughing: feed of ways on which the tool takes nothing, too near to what stands for a rapid"),
        may("feed_per_tooth_mm", SMALL, "no cap", "0.06", "cap of the feed; needs spindle_rpm and teeth"),
        may("coolant", Kind::Word(CoolantWord::WORDS), "off", "\"flood\"", "coolant"),
    ]),
    table("machine", false, "machine and control", &[
        may("name", Kind::Name(built_in_names), "", "\"trunnion-ac\"", "a built-in machine (see `machines`)"),
        may("file", Kind::File, "", "\"my-machine.toml\"", "a machine file instead"),
        may("dialect", Kind::Name(dialects), "sinumerik", "\"sinumerik\"", "language of the control"),
        may("dialect_file", Kind::File, "", "\"my-dialect.toml\"", "a dialect file instead: words of a control that is near to one of these"),
        may("feed", Kind::Word(FeedWord::WORDS), "tcp", "\"tcp\"", "how the program says the feed"),
        may("kz_step", Kind::Number(ABOVE, "mm/min"), "200", "200", "feed = \"kz\": largest rise of F from block to block"),
        may("work_offset", Kind::Text, "as the dialect begins", "\"G54\"", "work offset: G54 to G59 and more, by the dialect"),
        may("program_number", Kind::Whole(1, 9999), "none", "100", "number of the program"),
    ]),
    table("setup", false, "where the part sits and how rapid moves go", &[
        may("part_zero_mm", TRIPLE, "from the box of the faces", "[0, 0, 50]", "the part's origin from the table's reference point"),
        may("rotate_deg", Kind::Numbers(3, TURN, "deg"), "from the tool axes", "[0, 0, 90]", "turn of the part about x, then y, then z"),
        may("turns", Kind::Word(Turns::WORDS), "axis", "\"free\"",
            "without rotate_deg: whether the part is turned to save time: not, with one of its axes up, or anyhow; of a list where it is given"),
        may("clearance_mm", MM, "10", "10", "clearance of rapid moves over the sphere around the part"),
        may("approach_mm", MM, "2", "2", "distance from the surface at which rapid moves end"),
        may("hop_mm", MM, "an eighth of approach_mm", "0.25", "least lift in hops from pass to pass"),
        may("check_clearance_mm", MM, "half of approach_mm", "1", "what the tool keeps from check faces in hops"),
    ]),
    table("contact", false, "one contact, for `strip`", &[
        must("at", Kind::Numbers(2, ANY, ""), "[0.1, 0.2]", "surface parameters u, v"),
        may("lift_mm", Kind::Number(FAR, "mm"), "0", "0.01", "height of the tool above the contact"),
        may("along", Kind::Word(AxisWord::WORDS), "", "\"u\"", "feed along a line of constant parameter"),
        may("angle_deg", Kind::Number(TURN, "deg"), "", "30", "or along the geodesic at this angle from S_u towards S_v"),
    ]),
    table("stock", false, "raw material: one of box_mm, [stock.cylinder], file, allowance_mm", &[
        may("box_mm", Kind::Corners("mm"), "", "[-10, -10, -20, 10, 10, 5]", "two corners in the part's frame"),
        may("file", Kind::File, "", "\"stock.stl\"", "a closed STL, PLY or 3MF mesh in the part's frame, mm, or stock-N.stock of a plan of the same part"),
        may("allowance_mm", MM, "", "2", "a layer around the faces, or around the file's solid"),
        may("cell_mm", MM, "a 256th of its size", "0.5", "sides of cells"),
        may("memory_mb", Kind::Number(ABOVE, "MB"), "512", "512", "memory for it"),
    ]),
    table("stock.cylinder", false, "a round blank in the part's frame", &[
        may("axis", Kind::Direction, "[0, 0, 1]", "[0, 0, 1]", "its axis, through the origin"),
        must("diameter_mm", MM, "220", "diameter"),
        must("z_mm", Kind::Between(FAR, "mm"), "[0, 60]", "where it begins and ends along the axis"),
    ]),
    table("fixture", false, "what holds the part", &[
        must("files", Kind::Files, "[\"vice.stl\"]", "STL, PLY or 3MF meshes in the part's frame, mm"),
        may("spacing_mm", MM, "1", "1", "distance of the places looked at"),
    ]),
    table("flank", false, "the side of the cutter on a ruled face, for `flank`", &[
        may("at_u", Kind::Number(ANY, ""), "the middle", "0.4", "the rule at which settings are compared"),
        may("side", Kind::Sign, "1", "-1", "1: the side that the normal points to; -1: the other"),
        may("span_u", Kind::Between(ANY, ""), "the face", "[0, 1]", "where the cutter goes"),
        may("judge_u", Kind::Between(ANY, ""), "the face", "[0, 1]", "where it is judged"),
        may("positions", Kind::Whole(4, 20_000), "181", "181", "positions over the span"),
        may("method", Kind::Word(Method::WORDS), "envelope_minimax", "\"optimum\"", "the positioning that becomes a path"),
        may("along", Kind::Word(AlongWord::WORDS), "auto", "\"u\"", "the parameter along the directrices"),
        may("face", Kind::Word(FlankShape::WORDS), "own", "\"borders\"", "the face's shape, or the lines between its borders"),
        may("tip", Kind::Word(Tip::WORDS), "auto", "\"v0\"", "the end of the rules where the tip is"),
        may("below_mm", MM_OR_ZERO, "1", "1", "what the cutter reaches beyond the rules at the tip"),
        may("lead_mm", MM_OR_ZERO, "a radius and 2", "5", "straight way before and after the face"),
        may("spans", Kind::Whole(1, 1000), "by the length", "32", "spans of the axis surface"),
        may("gouge_weight", Kind::Number(Range { least: 1.0, most: 1e6, open: [false; 2] }, ""), "1", "2",
            "what a gouge counts against material left"),
        may("smoothness_per_mm", Kind::Number(NOT_BELOW, "1/mm"), "0", "0.1", "weight of an uneven motion"),
        may("ruled_tolerance_mm", SMALL, "0.01", "0.01", "how far a face may stray from straight lines and count as ruled"),
    ]),
    table("verification", false, "how densely to verify", &[
        may("spacing_mm", MM, "by the strips", "0.2", "distance of samples"),
        may("max_samples", Kind::Whole(100, 1_000_000_000), "1000000", "200000", "most samples"),
        may("accept", Kind::Word(Accept::WORDS), "proof", "\"samples\"", "what a verdict must rest on"),
    ]),
];

#[rustfmt::skip]
const CURVE: &[Key] = &[
    may("degree", Kind::Whole(1, 25), "", "1", "degree"),
    may("knots", Kind::List, "", "[0, 0, 1, 1]", "all knots, those at the ends repeated"),
    may("poles", Kind::List, "", "[[0, 0, 0], [10, 0, 0]]", "poles, mm"),
    may("weights", Kind::List, "none", "[1, 1]", "weights of a rational curve"),
    may("points", Kind::List, "", "[[0, 0, 0], [10, 0, 0]]", "instead: points that a cubic goes through, mm"),
];
