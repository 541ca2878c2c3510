//! Three-axis passes in parallel planes over any number of faces: the cutter is dropped onto them (isoplanar, 3C).
//!
//! The tool keeps its axis. Each place of the faces says from where the tool touches it, and how far a pass may be off that
//! ([`wants`]); levels are the fewest planes that satisfy every place. Along a level the tool is dropped onto all faces
//! together ([`height`]), those that are not to be machined among them, so that it cannot cut one while it machines
//! another. What the passes leave is then measured with the swept cutter, and where it is too much the places concerned are
//! asked again with a shorter reach.

mod circle;
mod course;
mod frame;
mod gradient;
mod ground;
mod height;
mod laid;
mod planes;
mod rims;
mod rough;
mod rounds;
mod seeds;
mod silhouettes;
mod task;
mod three_axis;
mod trace;
mod wants;
mod waterline;

pub use gradient::gradient_3c;
pub use planes::drop_cutter;
pub use rough::{Entry, Heading, Headings, Places, RoughTask, Roughing, Rows, Search, Sizes, rough};
pub use task::DropTask;
pub use three_axis::{ThreeAxis, ThreeAxisLines};
pub use waterline::waterline_3c;
