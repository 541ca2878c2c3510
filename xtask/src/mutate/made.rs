//! Whole files that no collection has: small jobs, meshes, and what the program itself writes.

use super::kind::Kind;
use crate::cmd::Failure;
use std::path::Path;
use std::process::{Command, Stdio};

/// A plane of 20 x 20 mm.
const PLANE: &str = "builtin = { kind = \"plane\", u_range = [0, 20], v_range = [0, 20] }\n";
/// What follows the part in a job.
const REST: &str = "[tool]\nkind = \"ball\"\ndiameter_mm = 6\nlength_mm = 30\n[tolerance]\nscallop_mm = 0.05\ngouge_mm = 0.05\n\
    [cutting]\nfeed_mm_min = 1000\n[machine]\nname = \"trunnion-ac\"\ndialect = \"linuxcnc\"\n[verification]\nmax_samples = 2000\n";
/// A path of a few moves.
const PATH: &str = "UNITS/MM\nCUTTER/6, 3, 0, 0, 0, 0, 30\nSPINDL/RPM,8000,CLW\nFEDRAT/1000,MMPM\nRAPID\nGOTO/0,0,40,0,0,1\nGOTO/0,0,0,0,0,1\n\
    GOTO/20,0,0,0,0,1\nGOTO/20,1,0,0,0.1,1\nRAPID\nGOTO/20,1,40,0,0,1\nFINI\n";
/// A program of a few blocks.
const PROGRAM: &str = "O1\nG17 G21 G90 G94\nT1 M6\nS8000 M3\nG0 X0 Y0 Z40 A0 C0\nG1 Z0 F1000\nX20\nG2 X10 Y10 I-10 J0\nG1 A10 C20\nG0 Z40\nM30\n";
/// A list of two operations on a plate; the first leaves a file of raw material.
const LIST: &str = "format = 2\n[part]\nbuiltin = { kind = \"plane\", u_range = [0, 8], v_range = [0, 8] }\n\
    [stock]\nbox_mm = [0, 0, -3, 8, 8, 1.5]\ncell_mm = 0.5\n[tolerance]\nscallop_mm = 0.1\ngouge_mm = 0.05\n\
    [verification]\nmax_samples = 2000\naccept = \"samples\"\n[machine]\nname = \"trunnion-ac\"\ndialect = \"linuxcnc\"\n\
    [[tool]]\nnumber = 4\nkind = \"flat\"\ndiameter_mm = 6\nlength_mm = 30\nteeth = 2\ncutting = { spindle_rpm = 6000, feed_mm_min = 900 }\n\
    [[tool]]\nnumber = 7\nkind = \"ball\"\ndiameter_mm = 6\nlength_mm = 40\nteeth = 2\ncutting = { spindle_rpm = 9000, feed_mm_min = 1500 }\n";
const ROUGH: &str = "[[operation]]\nname = \"rough\"\nkind = \"rough\"\ntools = [4]\nallowance_mm = 0.4\n";
/// The side of a cutter on a ruled face.
const SIDE: &str = "format = 1\n[part]\nbuiltin = { kind = \"d98-liu\" }\n[tool]\nkind = \"cylindrical\"\ndiameter_mm = 20\nlength_mm = 80\n\
    [tolerance]\nscallop_mm = 0.2\ngouge_mm = 0.2\n[flank]\nat_u = 21.892\nspans = 4\n[cutting]\nspindle_rpm = 3000\nfeed_mm_min = 500\n\
    [machine]\nname = \"trunnion-ac\"\ndialect = \"sinumerik\"\n[verification]\nmax_samples = 2000\n";
const FINISH: &str = "[[operation]]\nname = \"finish\"\nkind = \"finish\"\ntools = [7]\nstrategy = { kind = \"isoplanar_3c\" }\n";

/// The job of a part.
fn job(part: &str) -> String {
    format!("format = 1\n[part]\n{part}{REST}")
}

/// What stands beside a file of a kind.
pub fn beside(kind: Kind, name: &str) -> Vec<(String, Vec<u8>)> {
    let file = format!("file = \"{name}\"\n");
    let mut texts = vec![("path-of.cl", PATH.to_owned()), ("program-of.nc", PROGRAM.to_owned())];
    match kind {
        Kind::Part => texts.push(("job-of.toml", job(&file))),
        Kind::Mesh => texts.extend([
            ("job-of.toml", job(&file)),
            ("stock-of.toml", format!("{}[stock]\n{file}cell_mm = 0.5\n[[fixture]]\n{file}", job(PLANE))),
        ]),
        Kind::Library => texts.push(("sheet-of.json", sheet())),
        Kind::Stock => {
            let stock = format!("[stock]\n{file}");
            let from = LIST.find("[stock]").unwrap_or(0);
            let to = LIST.find("[tolerance]").unwrap_or(0);
            texts.push(("left-of.toml", format!("{}{stock}{}{FINISH}", &LIST[..from], &LIST[to..])));
        }
        _ => texts.push(("job-of.toml", job(PLANE))),
    }
    texts.into_iter().map(|(name, text)| (name.to_owned(), text.into_bytes())).collect()
}

/// A plane face of 12 x 12 mm as the JSON of faces.
fn sheet() -> String {
    "{\"format\": 1, \"faces\": [{\"id\": \"F1\", \"kind\": \"bspline\", \"oriented\": true, \"side\": \"along\", \"surface\": {\"nurbs\": \
     {\"degree\": [1, 1], \"knots\": [[0, 0, 1, 1], [0, 0, 1, 1]], \"poles_mm\": [[[0, 0, 0], [0, 12, 0]], [[12, 0, 0], [12, 12, 0]]], \
     \"weights\": [[1, 1], [1, 1]], \"side\": \"along\"}}}]}"
        .to_owned()
}

/// All files of this module with their kind.
pub fn all(program: &Path, scratch: &Path) -> Result<Vec<(Kind, String, Vec<u8>)>, Failure> {
    std::fs::create_dir_all(scratch).map_err(|why| Failure::Write { path: scratch.to_path_buf(), why })?;
    let mut out = vec![
        (Kind::Part, "sheet.json".to_owned(), sheet().into_bytes()),
        (Kind::Path, "path.cl".to_owned(), PATH.as_bytes().to_vec()),
        (Kind::Program, "program.nc".to_owned(), PROGRAM.as_bytes().to_vec()),
    ];
    out.extend(meshes().map(|(name, bytes)| (Kind::Mesh, name.to_owned(), bytes)));
    out.extend(small_jobs().map(|(name, text)| (Kind::SmallJob, name.to_owned(), text.into_bytes())));
    out.push((Kind::SideJob, "flank.toml".to_owned(), SIDE.as_bytes().to_vec()));
    for name in ["library.toml", "library.tbl", "library.json", "Library/library.fctl"] {
        let file = scratch.join(name);
        if let Some(folder) = file.parent() {
            std::fs::create_dir_all(folder)
                .map_err(|why| Failure::Write { path: folder.to_path_buf(), why })?;
        }
        written(program, scratch, &["tools", "shipped", "--out", name])?;
        out.push((Kind::Library, flat(name), read(&file)?));
    }
    let bits = scratch.join("Bit");
    if let Some(bit) = std::fs::read_dir(&bits).ok().and_then(|mut all| all.next()).and_then(Result::ok) {
        out.push((Kind::Library, "bit.fctb".to_owned(), read(&bit.path())?));
    }
    let list = scratch.join("list.toml");
    let text = format!("{LIST}{ROUGH}{FINISH}");
    std::fs::write(&list, text).map_err(|why| Failure::Write { path: list.clone(), why })?;
    written(program, scratch, &["plan", "list.toml", "--out", "list"])?;
    out.push((Kind::Stock, "left.stock".to_owned(), read(&scratch.join("list/stock-1.stock"))?));
    Ok(out)
}

/// The name of a file without its folders.
fn flat(name: &str) -> String {
    name.rsplit('/').next().unwrap_or(name).to_owned()
}

fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    std::fs::read(path).map_err(|why| Failure::Read { path: path.to_path_buf(), why })
}

/// Lets the program write something; that its answer may be no is its own affair, a missing file is told when it is read.
fn written(program: &Path, folder: &Path, arguments: &[&str]) -> Result<(), Failure> {
    let mut command = Command::new(program);
    command
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    let line = arguments.join(" ");
    command.status().map(|_| ()).map_err(|why| Failure::Start { line, why })
}

/// Jobs that are planned within a second or two: of every kind of strategy, with a place for `strip`, a list.
fn small_jobs() -> [(&'static str, String); 6] {
    let bowl = "builtin = { kind = \"paraboloid\", a_per_mm = 0.005, b_per_mm = -0.003, half_size_mm = 4 }\n";
    let with = |part: &str, more: &str| format!("{}{more}", job(part));
    [
        ("auto.toml", job(PLANE)),
        ("lines.toml", with(bowl, "[strategy]\nkind = \"isoparametric\"\nlead_deg = 15\n")),
        ("planes.toml", with(bowl, "[strategy]\nkind = \"isoplanar_3c\"\n")),
        ("regions.toml", with(bowl, "[strategy]\nkind = \"regions\"\nlead_deg = 15\n")),
        ("strip.toml", with(bowl, "[contact]\nuv = [0.5, 0.5]\nlead_deg = 10\n")),
        ("list.toml", format!("{LIST}{ROUGH}{FINISH}")),
    ]
}

/// A block as STL in both forms, as PLY in both forms, and as 3MF.
fn meshes() -> [(&'static str, Vec<u8>); 5] {
    let corner = |k: usize| [k & 1, k >> 1 & 1, k >> 2 & 1].map(|bit| 20.0 * bit as f32);
    let sides: [[usize; 4]; 6] =
        [[4, 5, 7, 6], [0, 2, 3, 1], [0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]];
    let triangles: Vec<[usize; 3]> =
        sides.iter().flat_map(|s| [[s[0], s[1], s[2]], [s[0], s[2], s[3]]]).collect();
    let mut text = "solid block\n".to_owned();
    let mut binary = vec![b' '; 80];
    binary.extend((triangles.len() as u32).to_le_bytes());
    for t in &triangles {
        text += "facet normal 0 0 0\nouter loop\n";
        binary.extend([0; 12]);
        for p in t.map(corner) {
            text += &format!("vertex {} {} {}\n", p[0], p[1], p[2]);
            p.iter().for_each(|x| binary.extend(x.to_le_bytes()));
        }
        text += "endloop\nendfacet\n";
        binary.extend([0; 2]);
    }
    text += "endsolid block\n";
    let head = |form: &str| {
        format!(
            "ply\nformat {form} 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\nelement face 12\n\
             property list uchar int vertex_indices\nend_header\n"
        )
    };
    let (mut ply, mut ply_binary) = (head("ascii"), head("binary_little_endian").into_bytes());
    for p in (0..8).map(corner) {
        ply += &format!("{} {} {}\n", p[0], p[1], p[2]);
        p.iter().for_each(|x| ply_binary.extend(x.to_le_bytes()));
    }
    for [a, b, c] in &triangles {
        ply += &format!("3 {a} {b} {c}\n");
        ply_binary.push(3);
        [a, b, c].iter().for_each(|k| ply_binary.extend((**k as i32).to_le_bytes()));
    }
    [
        ("text.stl", text.into_bytes()),
        ("binary.stl", binary),
        ("text.ply", ply.into_bytes()),
        ("binary.ply", ply_binary),
        ("block.3mf", stored("3D/3dmodel.model", model(&triangles, corner).as_bytes())),
    ]
}

/// The block as the model of a 3MF file.
fn model(triangles: &[[usize; 3]], corner: impl Fn(usize) -> [f32; 3]) -> String {
    let mut text = "<?xml version=\"1.0\"?>\n<model unit=\"millimeter\" \
                    xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n<resources>\n<object id=\"1\" type=\"model\">\n\
                    <mesh>\n<vertices>\n"
        .to_owned();
    for p in (0..8).map(corner) {
        text += &format!("<vertex x=\"{}\" y=\"{}\" z=\"{}\"/>\n", p[0], p[1], p[2]);
    }
    text += "</vertices>\n<triangles>\n";
    for [a, b, c] in triangles {
        text += &format!("<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"/>\n");
    }
    text + "</triangles>\n</mesh>\n</object>\n</resources>\n<build>\n<item objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 0 0 0\"/>\n</build>\n</model>\n"
}

/// An archive of one file that is not packed, so that damages meet its text. Sums of bytes are left out.
fn stored(name: &str, bytes: &[u8]) -> Vec<u8> {
    let [size, length] = [bytes.len() as u32, name.len() as u32];
    // Version, flags, method, time, date, sum, both sizes, lengths of the name and of what follows it.
    let mut about = vec![20, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];
    about.extend([size.to_le_bytes(), size.to_le_bytes()].concat());
    about.extend([(length as u16).to_le_bytes(), [0; 2]].concat());
    let local = [b"PK\x03\x04".as_slice(), &about, name.as_bytes(), bytes].concat();
    let entry = [b"PK\x01\x02".as_slice(), &[20, 0], &about, &[0; 14], name.as_bytes()].concat();
    let counts = [0, 0, 0, 0, 1, 0, 1, 0];
    let places = [(entry.len() as u32).to_le_bytes(), (local.len() as u32).to_le_bytes()].concat();
    [local, entry, [b"PK\x05\x06".as_slice(), &counts, &places, &[0; 2]].concat()].concat()
}
