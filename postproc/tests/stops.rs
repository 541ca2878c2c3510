//! LinuxCNC without tool-centre-point control: the table starts and stops at rest beside feed moves, since the control keeps to corners
//! of its slides alone.

use osculate_postproc::readback::{ReadBlock, ReadOptions, read};
use osculate_postproc::{Dialect, FeedMode, Machine, PostOptions, Setup, cldata, post};

/// Down without turning, along with the axis turning and then held, up, back above the part.
const PATH: &str = "SPINDL/5000,CLW\nMULTAX/ON\nRAPID\nGOTO/0,50,20,0,0,1\nFEDRAT/600\nGOTO/0,50,0,0,0,1\n\
    GOTO/5,50,0,0,-0.1,1\nGOTO/10,50,0,0,-0.2,1\nGOTO/15,50,0,0,-0.2,1\nGOTO/15,50,20,0,-0.2,1\n\
    RAPID\nGOTO/0,50,20,0,0,1\nFINI\n";

fn posted(feed: FeedMode, dialect: Dialect, joins: bool) -> String {
    let path = cldata::read(PATH).unwrap().path;
    let machine = Machine::built_in("trunnion-ac").unwrap();
    let options = PostOptions { joins, ..PostOptions::new(dialect, feed) };
    post(&path, &machine, &Setup::default(), &options).unwrap().text
}

fn blocks(text: &str) -> Vec<ReadBlock> {
    let machine = Machine::built_in("trunnion-ac").unwrap();
    read(text, Dialect::LinuxCnc, &machine, &Setup::default(), &ReadOptions::default()).unwrap().blocks
}

#[test]
fn a_table_starts_and_stops_at_rest() {
    let machine = Machine::built_in("trunnion-ac").unwrap();
    for feed in [FeedMode::InverseTime, FeedMode::None] {
        let text = posted(feed, Dialect::LinuxCnc, true);
        let blocks = blocks(&text);
        let turns = |b: &ReadBlock| machine.rotary().iter().any(|k| b.to[*k] != b.from[*k]);
        let pairs = || blocks.windows(2).filter(|p| !(p[0].rapid && p[1].rapid));
        // Before and after the turn, and before the way back, which is rapid and turns.
        let changes = pairs().filter(|p| turns(&p[0]) != turns(&p[1])).count();
        assert_eq!(changes, 3, "{text}");
        for p in pairs() {
            assert_eq!(p[0].exact, turns(&p[0]) != turns(&p[1]), "line {}: {text}", p[0].line);
        }
        // Every move that ends at rest is one by itself: corners are blended again behind it.
        assert_eq!(text.matches("G61.1\n").count(), 3, "{text}");
        assert_eq!(text.matches("G64 P0.0020\n").count(), 4, "{text}");
    }
}

#[test]
fn nothing_else_stops() {
    assert!(!posted(FeedMode::Tcp, Dialect::LinuxCnc, true).contains("G61"));
    for dialect in [Dialect::Sinumerik, Dialect::Heidenhain] {
        assert!(!posted(FeedMode::None, dialect, true).contains("G61"));
    }
}

/// What is not to be joined says so, and is blended half as wide.
#[test]
fn joining_is_forbidden_by_a_word() {
    let text = posted(FeedMode::InverseTime, Dialect::LinuxCnc, false);
    assert_eq!(text.matches("G64 P0.0020 Q0\n").count(), text.matches("G64").count(), "{text}");
    let sinumerik = [true, false].map(|joins| posted(FeedMode::None, Dialect::Sinumerik, joins));
    assert_eq!(sinumerik[0], sinumerik[1]);
}
