//! Which tool, strategy, direction and lead machine a job fastest: many are screened, few planned, fewer posted.
//!
//! Fields of axes come first: a few are planned, and the quickest that holds is hard to undercut. Then candidates wait in the order of the least time known of them: by strips at places, then by the planned length, then by the
//! posted program. The first is taken a level further, or out when it fails there, until the first one is posted. What screening
//! leaves out is optimistic as a rule (overlaps, links), so that little is missed. Of the leads of one tool and strategy only
//! the best is open at a time, and each plan of them that fails puts the next one back in the order. A plan that leaves a
//! little too much is laid out once more for less. Where none holds, tools and strategies that failed least are tried further;
//! around one that holds, leads beside its own and other strategies with its tool are planned for less time, and plans whose
//! lead is found place by place, with other tools too: those take long to plan, and little else gains as much; then a few of tools that keep their axis. Last the plan
//! that holds then is laid out again for what it left of its limits, and where the control does not reach the feed for other shares of the tolerance; one that
//! would hold but for a little depth along its chords, along shorter ones. The work is
//! bounded by counts, not by time: the same job gives the same choice everywhere.

mod again;
mod candidates;
mod effort;
mod entry;
mod layout;
mod measured;
mod search;
mod settle;
mod table;

pub use again::less_of;
pub use candidates::check;
pub use measured::Measured;
pub use search::{Choice, Contender, patches};
pub use settle::{Settled, objection, settle};
pub use table::{Outcome, Row, page_table, text_table};
