//! What a search for axes must know of a machine.

use osculate_geom::Unit3;
use osculate_tools::Pose;

/// The joints of a machine that turn the tool's axis against the part, which stands as it is set up.
pub trait Joints: Sync {
    /// Whether the joints have a place for an axis within their limits.
    fn reaches(&self, axis: &Unit3) -> bool;
    /// Time that the joints take at least to turn from one axis to another, s; infinite where one of them is out of reach.
    fn turn_s(&self, from: &Unit3, to: &Unit3) -> f64;
    /// The nearest axis that the joints reach.
    fn nearest(&self, axis: &Unit3) -> Unit3;
    /// The axes that the joints reach where they are a line or a few: a machine of three or four axes. None where they fill a part
    /// of the sphere.
    fn line(&self) -> Option<Vec<Unit3>>;
    /// Whether the joints take the tool to a pose: the linear ones too, within their limits. Asked where [`line`](Self::line) leaves little choice.
    fn travels(&self, pose: &Pose) -> bool;
}
