//! The text of a first job, with the reason of every choice beside it.

use super::asked::{Grouped, Wanted, name, relative};
use super::fit::{Fit, OF_SCALLOP};
use super::target::{Target, listed};
use crate::job::library;
use crate::job::words::ToolKind;
use crate::job::{Normals, Tool};
use crate::words::number;
use osculate_geom::Unit3;
use std::fmt::Write;

/// Raw material stands over the part by this, mm.
const OVER_MM: f64 = 1.0;
/// What a roughing leaves, mm.
const ALLOWANCE_MM: f64 = 0.3;
/// A roughing tool is no wider than the finishing one by this.
const FLAT: f64 = 2.0;
/// Samples of a verification: a first look is to end in minutes.
const SAMPLES: usize = 600_000;

/// A direction as TOML: whole numbers where it is one of the part's axes, and digits enough for an axis at the end of a joint's range.
fn direction(d: &Unit3) -> String {
    let one = |x: f64| if x.abs() < 1e-9 { "0".to_owned() } else { format!("{}", (x * 1e9).round() / 1e9) };
    format!("[{}, {}, {}]", one(d.x), one(d.y), one(d.z))
}

fn quoted(all: &[&str]) -> String {
    let all: Vec<String> = all.iter().map(|id| format!("\"{id}\"")).collect();
    format!("[{}]", all.join(", "))
}

/// A line of a group for the head of the job.
fn groups(grouped: &Grouped) -> String {
    const MOST: usize = 8;
    let mut out = String::new();
    for (k, g) in grouped.groups.iter().enumerate().take(MOST) {
        let alike = if g.alike > 1 { format!(", {} alike", g.alike) } else { String::new() };
        let _ = writeln!(
            out,
            "#   {:<4} {:<7} {:>12} mm2{alike}: {}",
            name(k),
            g.look.to_string(),
            number(g.area_mm2, 5),
            listed(&grouped.ids(k))
        );
    }
    let more = grouped.groups.len().saturating_sub(MOST);
    if more > 0 {
        let _ = writeln!(out, "#   and {more} smaller ones");
    }
    out
}

fn normals(word: Normals) -> &'static str {
    match word {
        Normals::Auto => "",
        Normals::File => {
            "# Nothing says on which side of this sheet the material is. It is taken to be the one towards which the sheet bends: say \"reversed\" to\n\
             # machine its other side, as of a mould.\nnormals = \"file\"\n"
        }
        Normals::Reversed => {
            "# Nothing says on which side of this sheet the material is. It is taken to be the one towards which the sheet bends: say \"file\" to\n\
             # machine its other side, as of a mould.\nnormals = \"reversed\"\n"
        }
    }
}

/// The job.
pub fn job(wanted: &Wanted<'_>, (grouped, word): (&Grouped, Normals), target: &Target, fit: &Fit) -> String {
    let ids: Vec<&str> = target.faces.iter().map(|f| grouped.part.faces[*f].id.as_str()).collect();
    let file = relative(wanted.part, wanted.job);
    let t = &fit.tolerance;
    let mm = |x: f64| number(x, 4);
    let mut out = format!(
        "# A first job for {part}, made by osculate init. Every choice has its reason beside it: change what you know better.\n\
         # `osculate check` says in a second what fits, `osculate plan JOB --out DIR` plans and verifies it, `osculate keys` has all keys.\n\
         #\n# The part has {faces} faces in {n} groups:\n{groups}\
         format = 2\n\n[part]\nfile = {file}\n# {why}.\nfaces = {ids}\n{normals}\n",
        part = wanted.part.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned()),
        faces = grouped.part.faces.len(),
        n = grouped.groups.len(),
        groups = groups(grouped),
        file = toml_text(&file.to_string_lossy()),
        why = capital(&target.why),
        ids = quoted(&ids),
        normals = normals(word),
    );
    let _ = write!(
        out,
        "[tolerance]\n# {}.\nscallop_mm = {}\ngouge_mm = {}\nchord_mm = {}\n",
        capital(&fit.why_tolerance),
        t.scallop_mm,
        plain(t.gouge_mm),
        plain(t.chord_mm)
    );
    if fit.accepted_mm2 > 0.0 {
        let edges = if fit.inner_mm > 0.0 {
            format!(": beside {} mm of sharp inner edges, above all", mm(fit.inner_mm))
        } else {
            String::new()
        };
        let _ = write!(
            out,
            "# Estimated area that the tool does not reach{edges}. It is accepted, and the verdict names it; 0 accepts none.\nunreached_mm2 = {}\n",
            plain(fit.accepted_mm2)
        );
    }
    let machine = if wanted.machine.ends_with(".toml") { "file" } else { "name" };
    let (deg, up) = fit.stands;
    let _ = write!(
        out,
        "\n[verification]\n# Enough for a first look; more samples show more between passes, and take longer.\nmax_samples = {SAMPLES}\n\
         \n[machine]\n{machine} = {}\ndialect = \"linuxcnc\"\n\
         \n[[setup]]\nname = \"op10\"\n# The part's {up} axis is up: all axes below are in the range of the machine's joints.\nrotate_deg = [{}, {}, {}]\n\
         \n# {}.\n{}\n",
        toml_text(wanted.machine),
        deg[0],
        deg[1],
        deg[2],
        capital(&format!("{}, of {}", fit.why, wanted.tools.1)),
        library::toml(&fit.tool, 1),
    );
    out += &block(wanted, grouped, fit);
    for (k, (from, faces)) in fit.axes.iter().enumerate() {
        let ids: Vec<&str> = faces.iter().map(|f| ids[*f]).collect();
        let share = 100.0 * from.area_mm2 / target.area_mm2;
        let _ = write!(
            out,
            "# From this axis the tool reaches {} % of the faces. It keeps it, so that any 3+2-axis control runs the passes.\n[[operation]]\nname = \"axis {}\"\nkind = \"finish\"\ntools = [1]\nfaces = {}\n\
             # Half of the tolerance: the rest is for marks of teeth, rounding and steep places.\nscallop_mm = {}\n\
             # Where the tool or its holder would go into the part nothing is cut.\n\
             strategy = {{ kind = \"isoplanar_3c\", axis = {}, gouges = \"leave_out\" }}\n\n",
            number(share.min(100.0), 3),
            k + 1,
            quoted(&ids),
            plain(OF_SCALLOP * t.scallop_mm),
            direction(&from.axis)
        );
    }
    format!("{}\n", out.trim_end())
}

/// A number of mm outwards to a tenth, with what stands over the part.
fn outwards(x: f64, sign: f64) -> String {
    plain((sign * x * 10.0 + 10.0 * OVER_MM).ceil() / 10.0 * sign)
}

/// Raw material and its roughing, as lines that begin with a mark and no space: a job without these marks begins with the block.
fn block(wanted: &Wanted<'_>, grouped: &Grouped, fit: &Fit) -> String {
    let begin = "# The part is taken to be roughed to a layer of some tenths";
    let most_mm = FLAT * 2.0 * fit.tool.cutter().radius_mm();
    let of = |t: &&Tool| t.kind() == ToolKind::Flat && 2.0 * t.cutter().radius_mm() <= most_mm;
    let wide = |a: &&Tool, b: &&Tool| a.cutter().radius_mm().total_cmp(&b.cutter().radius_mm());
    let Some(flat) = wanted.tools.0.tools.iter().filter(of).max_by(wide) else {
        return format!("{begin}; a [stock] and an operation of kind = \"rough\" begin with the block.\n");
    };
    let bounds: Vec<_> = grouped.part.faces.iter().map(crate::part::bounds).collect();
    let end = |k: usize, sign: f64| {
        let all = bounds.iter().map(|b| sign * if sign < 0.0 { b.min[k] } else { b.max[k] });
        outwards(all.fold(f64::NEG_INFINITY, f64::max) * sign, sign)
    };
    let corners: Vec<String> = [-1.0, 1.0].iter().flat_map(|s| (0..3).map(|k| end(k, *s))).collect();
    let depth_mm = 0.5 * flat.cutter().radius_mm();
    let mut lines =
        format!("[stock]\nbox_mm = [{}]\n\n{}\n", corners.join(", "), library::toml(flat, 2).trim_end());
    for (k, (from, _)) in fit.axes.iter().enumerate() {
        let _ = write!(
            lines,
            "\n[[operation]]\nname = \"rough {}\"\nkind = \"rough\"\ntools = [2]\nallowance_mm = {}\nstepdown_mm = {}\nstrategy = {{ axis = {} }}\n",
            k + 1,
            ALLOWANCE_MM.max(2.0 * fit.tolerance.scallop_mm),
            plain(depth_mm),
            direction(&from.axis)
        );
    }
    let marked: String =
        lines.lines().map(|l| if l.is_empty() { "#\n".to_owned() } else { format!("#{l}\n") }).collect();
    format!("{begin}. Without the marks before these lines it comes from the block around it:\n{marked}\n")
}

/// What was chosen, in sentences for a screen.
pub fn told(grouped: &Grouped, target: &Target, fit: &Fit, tried: &[String]) -> Vec<String> {
    let mut out: Vec<String> = tried.iter().map(|t| format!("not {t}")).collect();
    out.push(format!("{}: {}, {} mm2", target.words, target.why, number(target.area_mm2, 5)));
    out.push(format!("{}: {}", fit.tool.words(), fit.why));
    let short = |d: &Unit3| format!("({}, {}, {})", number(d.x, 3), number(d.y, 3), number(d.z, 3));
    let axes: Vec<String> = fit.axes.iter().map(|(f, _)| short(&f.axis)).collect();
    out.push(format!("tool axes {}, the part's {} up", axes.join(", "), fit.stands.1));
    if fit.accepted_mm2 > 0.0 {
        out.push(format!("about {} mm2 are not reached and accepted", number(fit.accepted_mm2, 3)));
    }
    if !grouped.open.is_empty() {
        let open: Vec<&str> = grouped.open.iter().map(String::as_str).collect();
        out.push(format!(
            "nothing says on which side the material of {} is: they are left out",
            listed(&open)
        ));
    }
    out
}

fn plain(x: f64) -> String {
    format!("{}", (x * 1e6).round() / 1e6)
}

fn toml_text(s: &str) -> String {
    toml::Value::from(s).to_string()
}

fn capital(s: &str) -> String {
    let mut chars = s.chars();
    chars.next().map_or_else(String::new, |c| c.to_uppercase().collect::<String>() + chars.as_str())
}
