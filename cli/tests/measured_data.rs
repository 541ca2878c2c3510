//! What `verify --data` writes: the same figures as the verdict, in files that other programs read.

use crate::common::{Scratch, job, osculate};
use std::collections::BTreeMap;

/// The members of an archive that is not packed, by its local heads.
fn members(archive: &[u8]) -> BTreeMap<String, &[u8]> {
    let mut out = BTreeMap::new();
    let mut at = 0;
    while archive[at..].starts_with(b"PK\x03\x04") {
        let two = |k: usize| usize::from(u16::from_le_bytes([archive[at + k], archive[at + k + 1]]));
        let size = u32::from_le_bytes(archive[at + 18..at + 22].try_into().unwrap()) as usize;
        let (name, body) = (at + 30, at + 30 + two(26) + two(28));
        out.insert(
            String::from_utf8(archive[name..name + two(26)].to_vec()).unwrap(),
            &archive[body..body + size],
        );
        at = body + size;
    }
    out
}

/// The numbers of an array of reals.
fn reals(npy: &[u8]) -> Vec<f64> {
    let begin = 10 + usize::from(u16::from_le_bytes([npy[8], npy[9]]));
    assert!(String::from_utf8_lossy(&npy[10..begin]).contains("'<f8'"));
    npy[begin..].chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect()
}

#[test]
fn the_files_hold_what_the_verdict_says() {
    let scratch = Scratch::new();
    let path = scratch.write("job.toml", &job(|text| text));
    let path = path.to_str().unwrap();
    osculate(&["plan", path, "--out", scratch.path("out").to_str().unwrap()]);
    let program = std::fs::read_dir(scratch.path("out"))
        .unwrap()
        .map(|e| e.unwrap().path())
        .find(|p| p.file_stem().is_some_and(|s| s == "program"))
        .unwrap();
    let folder = scratch.path("data");
    let said = osculate(&[
        "verify",
        program.to_str().unwrap(),
        "--job",
        path,
        "--data",
        folder.to_str().unwrap(),
        "--json",
    ])
    .json();
    let archive = std::fs::read(folder.join("samples.npz")).unwrap();
    let members = members(&archive);
    let deviation = reals(members["deviation_mm.npy"]);
    let count = said["samples"].as_u64().unwrap() as usize;
    assert_eq!([deviation.len(), reals(members["points.npy"]).len()], [count, 3 * count]);
    let (low, high) = deviation.iter().fold((0.0_f64, 0.0_f64), |(l, h), d| (l.min(*d), h.max(*d)));
    assert!((high - said["scallop_max_mm"].as_f64().unwrap()).abs() < 1e-12, "{high}");
    assert!((-low - said["gouge_max_mm"].as_f64().unwrap()).abs() < 1e-12, "{low}");
    // The last time is that of the whole program.
    let moves = std::fs::read(folder.join("moves.npz")).unwrap();
    let times = reals(self::members(&moves)["time_min.npy"]);
    assert!(times.windows(2).all(|w| w[0] <= w[1]) && times[times.len() - 1] > 0.0);
    for name in ["samples.vtp", "moves.vtp"] {
        assert!(std::fs::read(folder.join(name)).unwrap().starts_with(b"<?xml"));
    }
}
