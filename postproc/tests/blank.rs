//! The box around the raw material in programs: where it lies in their coordinates, and that it moves nothing when it is read.

use crate::common;

use common::wave;
use nalgebra::UnitQuaternion;
use osculate_geom::Vec3;
use osculate_postproc::readback::{ReadOptions, read};
use osculate_postproc::{Dialect, FeedMode, Machine, PostOptions, Setup, post};

const BLANK_MM: [[f64; 3]; 2] = [[-30.0, -20.0, -5.0], [30.0, 25.0, 40.0]];

fn posted(setup: &Setup, dialect: Dialect, feed: FeedMode, blank_mm: Option<[[f64; 3]; 2]>) -> String {
    let machine = Machine::built_in("trunnion-ac").unwrap();
    post(&wave(20, 0.2), &machine, setup, &PostOptions { blank_mm, ..PostOptions::new(dialect, feed) })
        .unwrap()
        .text
}

fn forms(text: &str) -> Vec<&str> {
    text.lines().filter_map(|l| l.split_once("BLK FORM ")).map(|(_, form)| form).collect()
}

#[test]
fn it_stands_where_program_zero_says() {
    let at = |setup: &Setup, feed| posted(setup, Dialect::Heidenhain, feed, Some(BLANK_MM));
    let mut setup = Setup::at(Vec3::new(7.0, 0.0, 100.0), 80.0);
    // The tip's coordinates begin at the part's origin.
    let text = at(&setup, FeedMode::Tcp);
    let own = ["0.1 Z X-30.0000 Y-20.0000 Z-5.0000", "0.2 X+30.0000 Y+25.0000 Z+40.0000"];
    assert_eq!(forms(&text), own, "{text}");
    // Joints begin at the table's reference point.
    let text = at(&setup, FeedMode::None);
    assert_eq!(forms(&text), ["0.1 Z X-23.0000 Y-20.0000 Z+95.0000", "0.2 X+37.0000 Y+25.0000 Z+140.0000"]);
    // Turned by a quarter about Z the box is turned too: x goes to y, y to -x.
    setup.part_zero.rotation = UnitQuaternion::from_scaled_axis(Vec3::z() * std::f64::consts::FRAC_PI_2);
    let text = at(&setup, FeedMode::Tcp);
    assert_eq!(forms(&text), ["0.1 Z X-25.0000 Y-30.0000 Z-5.0000", "0.2 X+20.0000 Y+30.0000 Z+40.0000"]);
}

#[test]
fn it_changes_no_move() {
    let machine = Machine::built_in("trunnion-ac").unwrap();
    let setup = Setup::at(Vec3::zeros(), 80.0);
    for dialect in Dialect::ALL {
        let [bare, with] = [None, Some(BLANK_MM)].map(|blank| posted(&setup, dialect, FeedMode::Tcp, blank));
        assert_eq!(forms(&with).len(), if dialect == Dialect::Heidenhain { 2 } else { 0 });
        let back = |text: &str| read(text, dialect, &machine, &setup, &ReadOptions::default()).unwrap();
        let poses = |text: &str| back(text).moves.iter().map(|m| m.pose).collect::<Vec<_>>();
        assert_eq!(poses(&bare), poses(&with), "{dialect}");
    }
    // What Sinumerik has for it is passed over too.
    let text = posted(&setup, Dialect::Sinumerik, FeedMode::Tcp, None);
    let with = text.replacen("N10 ", "N5 WORKPIECE(,\"\",,\"BOX\",112,0,-20,-80,-30,-20,30,20)\nN10 ", 1);
    assert!(
        with != text && read(&with, Dialect::Sinumerik, &machine, &setup, &ReadOptions::default()).is_ok()
    );
}
