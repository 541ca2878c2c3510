//! A machine of one's own as data: a head that swivels about Y over a table that turns about Z. A path is posted for it and read back.
//!
//!     cargo run -p osculate --example own_machine
#![allow(clippy::print_stdout)]

use osculate_postproc::{Dialect, FeedMode, Machine, PostOptions, Setup, cldata, post, readback};
use std::error::Error;

/// From the part to the table, and from the tool to the bed: each joint with its side, letter and travel.
const MACHINE: &str = r#"
format = 1
name = "swivel-bc"
description = "B swivels the head, C turns the table"

[control]
feed_reading = { kind = "arc", radius_mm = 57.29577951308232 }
largest_feed = 20000

[[joint]]
kind = "rotary"
letter = "C"
side = "table"
direction = [0, 0, 1]
max_velocity_deg_s = 360
max_acceleration_deg_s2 = 2000

[[joint]]
kind = "linear"
letter = "X"
side = "head"
direction = [1, 0, 0]
min_mm = -400
max_mm = 400
max_velocity_mm_s = 500
max_acceleration_mm_s2 = 4000

[[joint]]
kind = "linear"
letter = "Y"
side = "head"
direction = [0, 1, 0]
min_mm = -300
max_mm = 300
max_velocity_mm_s = 500
max_acceleration_mm_s2 = 4000

[[joint]]
kind = "linear"
letter = "Z"
side = "head"
direction = [0, 0, 1]
min_mm = -100
max_mm = 600
max_velocity_mm_s = 500
max_acceleration_mm_s2 = 4000

[[joint]]
kind = "rotary"
letter = "B"
side = "head"
direction = [0, 1, 0]
min_deg = -30
max_deg = 110
max_velocity_deg_s = 180
max_acceleration_deg_s2 = 1000
"#;

fn main() -> Result<(), Box<dyn Error>> {
    let machine = Machine::from_toml(MACHINE)?;
    let path = cldata::read("FEDRAT/600,MMPM\nGOTO/0,0,1,0.6,0,0.8\nGOTO/8,0,1,0,0.6,0.8\nFINI\n")?.path;
    let setup = Setup::default();
    let posted = post(&path, &machine, &setup, &PostOptions::new(Dialect::Sinumerik, FeedMode::Tcp))?;
    println!("{}", posted.text);
    let read = readback::read(
        &posted.text,
        Dialect::Sinumerik,
        &machine,
        &setup,
        &readback::ReadOptions::default(),
    )?;
    let end = read.moves.iter().rfind(|m| !m.own_frame).ok_or("no moves")?;
    let asked = &path.moves[path.moves.len() - 1].pose;
    assert!((end.pose.tip - asked.tip).norm() < 1e-3 && end.pose.axis.angle(&asked.axis) < 1e-4);
    // What the machine cannot reach is refused by name.
    let far = cldata::read("FEDRAT/600,MMPM\nGOTO/0,0,1,0,0,1\nGOTO/900,0,1,0,0,1\nFINI\n")?.path;
    let why = post(&far, &machine, &setup, &PostOptions::new(Dialect::Sinumerik, FeedMode::Tcp));
    println!("{}", why.err().ok_or("beyond the travel of X")?);
    Ok(())
}
