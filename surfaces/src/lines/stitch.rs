//! Linking pieces into lines.

/// Chains of nodes from links between pairs of nodes, each node in two links at most. Open chains come first in the
/// order of their first node, closed ones (without repeating the first node) after them.
pub(crate) fn chains(nodes: usize, links: &[(u32, u32)]) -> Vec<(Vec<u32>, bool)> {
    let mut next: Vec<[Option<u32>; 2]> = vec![[None; 2]; nodes];
    let mut add = |a: u32, b: u32| {
        let slots = &mut next[a as usize];
        let free = if slots[0].is_none() { 0 } else { 1 };
        slots[free] = Some(b);
    };
    for (a, b) in links {
        add(*a, *b);
        add(*b, *a);
    }
    let mut seen = vec![false; nodes];
    let mut out = Vec::new();
    for pass in 0..2 {
        for first in 0..nodes {
            let degree = next[first].iter().flatten().count();
            // First from the ends of open chains, then around what is left.
            if seen[first] || degree == 0 || (pass == 0 && degree != 1) {
                continue;
            }
            let mut chain = vec![first as u32];
            seen[first] = true;
            let mut at = first;
            while let Some(n) = next[at].iter().flatten().find(|n| !seen[**n as usize]) {
                at = *n as usize;
                seen[at] = true;
                chain.push(*n);
            }
            out.push((chain, pass == 1));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn open_and_closed_chains() {
        let c = chains(8, &[(3, 1), (0, 3), (4, 5), (6, 4), (5, 6)]);
        assert_eq!(c, vec![(vec![0, 3, 1], false), (vec![4, 5, 6], true)]);
    }
}
