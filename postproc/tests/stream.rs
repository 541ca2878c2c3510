//! Posting piece by piece: the same program as in one text, whole or reported as cut off, and right across the borders
//! of the pieces in which a long path is solved.

use crate::common;

use std::io;

use common::{angle, path, pose, wave};
use osculate_postproc::{
    BlockKind, Dialect, FeedMode, Machine, PostError, PostOptions, Setup, SolveOptions, post, post_to,
};
use osculate_tools::Pose;

/// Counts pieces and takes a given number of bytes.
#[derive(Default)]
struct Sink {
    text: Vec<u8>,
    largest: usize,
    room: Option<usize>,
}

impl io::Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.room.is_some_and(|room| self.text.len() + bytes.len() > room) {
            return Err(io::ErrorKind::StorageFull.into());
        }
        self.largest = self.largest.max(bytes.len());
        self.text.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_sink_gets_the_text_in_small_pieces() {
    let (machine, setup, long) =
        (Machine::built_in("trunnion-ac").unwrap(), Setup::default(), wave(6000, 0.0));
    for dialect in Dialect::ALL {
        let options = PostOptions::new(dialect, FeedMode::Kv { fgref_mm: None });
        let whole = post(&long, &machine, &setup, &options).unwrap();
        let mut sink = Sink::default();
        let report = post_to(&long, &machine, &setup, &options, &mut sink).unwrap();
        assert_eq!(String::from_utf8(sink.text).unwrap(), whole.text);
        assert_eq!((report.summary, report.diagnostics), (whole.summary, whole.diagnostics));
        assert!(whole.text.len() > 200_000 && sink.largest < 70_000, "{} bytes at once", sink.largest);
    }
}

#[test]
fn a_full_sink_is_an_error() {
    let (machine, setup) = (Machine::built_in("trunnion-ac").unwrap(), Setup::default());
    let options = PostOptions::new(Dialect::Sinumerik, FeedMode::InverseTime);
    let mut sink = Sink { room: Some(100_000), ..Sink::default() };
    let e = post_to(&wave(6000, 0.0), &machine, &setup, &options, &mut sink).unwrap_err();
    assert_eq!(e, PostError::Sink { kind: io::ErrorKind::StorageFull });
}

/// The tool leans, stands upright for a while, and leans another way: the upright stretch lies across the border of two
/// pieces (16384 points), once exactly on it, once over a whole piece.
#[test]
fn pieces_join_without_a_trace() {
    let machine = Machine::built_in("trunnion-ac").unwrap();
    let (setup, options) =
        (Setup::at([1.0, 2.0, 3.0].into(), 0.0), SolveOptions { tcp: true, ..SolveOptions::default() });
    for (up, down, count) in [(16_300, 16_500, 17_000), (16_384, 16_390, 16_500), (16_000, 33_000, 33_100)] {
        let lean = |i: u32| -> f64 {
            let past = f64::from(up) - f64::from(i);
            let beyond = f64::from(i) - f64::from(down - 1);
            1e-3 * past.max(beyond).max(0.0)
        };
        let at = |i: u32| {
            let (x, y) = if i < up { (lean(i).min(0.3), 0.0) } else { (0.0, lean(i).min(0.3)) };
            pose([0.01 * f64::from(i), 5.0, 2.0], [x, y, 1.0])
        };
        let poses: Vec<Pose> = (0..count).map(at).collect();
        let joints = machine.solve(&path(poses.iter().copied(), 500.0), &setup, &options).unwrap();
        let ends: Vec<_> = joints.blocks.iter().filter(|b| b.kind == BlockKind::Point).collect();
        assert_eq!(ends.len(), poses.len());
        let outer: Vec<f64> = ends.iter().map(|b| b.joints[machine.rotary()[0]]).collect();
        for (i, (end, want)) in ends.iter().zip(&poses).enumerate() {
            let got = machine.forward(&end.joints, &setup);
            assert_eq!(end.source, i);
            assert!((got.tip - want.tip).norm() < 1e-9, "{i}");
            assert!(angle(&got.axis, &want.axis) < 1e-9, "{i}");
        }
        // Upright, the outer joint goes linearly from the one lean to the other.
        let (a, b) = (up as usize - 1, down as usize);
        for i in a..=b {
            let t = (i - a) as f64 / (b - a) as f64;
            assert!((outer[i] - (outer[a] + (outer[b] - outer[a]) * t)).abs() < 1e-9, "{i}");
        }
        assert!((outer[b] - outer[a]).abs() > 1.0);
    }
}
