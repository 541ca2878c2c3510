//! Faces joined to groups with the side of each relative to the first one.

use super::link::Link;
use osculate_geom::Side;

/// Faces that hang together.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Joined {
    /// Numbers of the faces, ascending.
    pub(crate) faces: Vec<usize>,
    /// The side of each relative to the first one.
    pub(crate) sides: Vec<Side>,
}

/// Numbers joined to classes, each with its side relative to the one above it.
struct Classes(Vec<(usize, Side)>);

impl Classes {
    /// The class of a number and its side in it.
    fn find(&self, mut k: usize) -> (usize, Side) {
        let mut side = Side::Along;
        while self.0[k].0 != k {
            side = side.seen(self.0[k].1);
            k = self.0[k].0;
        }
        (k, side)
    }
}

/// The groups of `count` faces, and the links that contradict heavier ones.
pub(super) fn groups(count: usize, links: &[Link]) -> (Vec<Joined>, Vec<Link>) {
    let mut order: Vec<&Link> = links.iter().collect();
    order.sort_by(|a, b| b.weight_mm.total_cmp(&a.weight_mm).then(a.faces.cmp(&b.faces)));
    let mut classes = Classes((0..count).map(|k| (k, Side::Along)).collect());
    let mut against = Vec::new();
    for link in order {
        let wanted = if link.agree { Side::Along } else { Side::Against };
        let [(a, of_a), (b, of_b)] = link.faces.map(|f| classes.find(f));
        let between = of_a.seen(of_b).seen(wanted);
        if a != b {
            // The smaller number stays, so that the groups do not depend on the order of links.
            classes.0[a.max(b)] = (a.min(b), between);
        } else if between == Side::Against {
            against.push(*link);
        }
    }
    let mut of = vec![Joined { faces: Vec::new(), sides: Vec::new() }; count];
    for k in 0..count {
        let (class, side) = classes.find(k);
        of[class].faces.push(k);
        of[class].sides.push(side);
    }
    of.retain(|g| !g.faces.is_empty());
    (of, against)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_go_along_links_and_the_lightest_of_a_contradiction_gives_way() {
        let link = |a, b, agree, weight_mm| Link { faces: [a, b], agree, weight_mm };
        let all =
            [link(0, 2, false, 3.0), link(2, 3, false, 2.0), link(0, 3, false, 1.0), link(1, 4, true, 1.0)];
        let (groups, against) = groups(6, &all);
        let (w, a) = (Side::Along, Side::Against);
        assert_eq!(groups[0], Joined { faces: vec![0, 2, 3], sides: vec![w, a, w] });
        assert_eq!(groups[1], Joined { faces: vec![1, 4], sides: vec![w, w] });
        assert_eq!(groups[2].faces, [5]);
        assert_eq!(against, [all[2]]);
    }
}
