//! Which leaves of a node lie in one block: two that fill it together, one from its first lane on, the other up to its last.

use super::node::WIDTH;
use crate::geometry::LANES;

/// Where the leaves of a node lie.
pub(super) struct Sharing {
    places: [Place; WIDTH],
    /// How many blocks they take.
    pub(super) blocks: usize,
}

/// Where a leaf lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    /// The number of the block among those of the node.
    pub(super) block: usize,
    /// Whether it ends with the last lane, instead of beginning with the first.
    pub(super) at_end: bool,
}

impl Sharing {
    /// That of leaves of so many primitives, one to eight, by the lane of the child; 0 for children that are no leaves.
    ///
    /// Each leaf, the largest first, is joined by the largest that finds room: no way to put one or two into a block takes fewer blocks.
    pub(super) fn of(counts: &[usize; WIDTH]) -> Self {
        // By their number of primitives the leaves that have no place yet.
        let mut waiting = [0u16; LANES + 1];
        for (lane, &count) in counts.iter().enumerate() {
            waiting[count] |= 1 << lane;
        }
        let mut places = [Place { block: 0, at_end: false }; WIDTH];
        let mut blocks = 0;
        for count in (1..=LANES).rev() {
            while let Some(lane) = take_first(&mut waiting[count]) {
                places[lane] = Place { block: blocks, at_end: false };
                let fitting = (1..=LANES - count).rev().find(|&other| waiting[other] != 0);
                if let Some(lane) = fitting.and_then(|other| take_first(&mut waiting[other])) {
                    places[lane] = Place { block: blocks, at_end: true };
                }
                blocks += 1;
            }
        }
        Self { places, blocks }
    }

    /// How many blocks leaves take of which so many have 0, 1, ... primitives.
    pub(super) fn blocks(mut leaves: [u32; LANES + 1]) -> usize {
        let mut blocks = 0;
        for count in (1..=LANES).rev() {
            while leaves[count] > 0 {
                leaves[count] -= 1;
                if let Some(other) = (1..=LANES - count).rev().find(|&other| leaves[other] > 0) {
                    leaves[other] -= 1;
                }
                blocks += 1;
            }
        }
        blocks
    }

    /// Where the leaf lies that is the child in a lane.
    pub(super) fn place(&self, lane: usize) -> Place {
        self.places[lane]
    }
}

/// Takes the first lane out of a set, if there is one.
fn take_first(set: &mut u16) -> Option<usize> {
    let lane = set.trailing_zeros();
    *set &= set.wrapping_sub(1);
    (lane < u16::BITS).then_some(lane as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_leaf_has_lanes_of_its_own_and_no_pair_is_missed() {
        let mut state = 5u32;
        for round in 0..20_000 {
            let counts: [usize; WIDTH] = std::array::from_fn(|_| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let most = [9, 5, 4, 8][round % 4];
                ((state >> 16) as usize % most + usize::from(round % 8 > 3)).min(LANES)
            });
            let sharing = Sharing::of(&counts);
            let mut lanes = [0u32; WIDTH];
            for (lane, &count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
                let Place { block, at_end } = sharing.place(lane);
                let own = ((1 << count) - 1) << if at_end { LANES - count } else { 0 };
                assert_eq!(lanes[block] & own, 0, "{counts:?}");
                lanes[block] |= own;
            }
            assert!(lanes[..sharing.blocks].iter().all(|&lanes| lanes & 1 == 1), "{counts:?}");
            assert!(lanes[sharing.blocks..].iter().all(|&lanes| lanes == 0), "{counts:?}");
            assert_eq!(sharing.blocks, fewest_blocks(&counts), "{counts:?}");

            let mut leaves = [0; LANES + 1];
            counts.iter().for_each(|&count| leaves[count] += 1);
            assert_eq!(sharing.blocks, Sharing::blocks(leaves), "{counts:?}");
        }
    }

    /// The fewest blocks for leaves that share them by twos at most: the smallest with the largest that it fits to, as sorting shows.
    fn fewest_blocks(counts: &[usize]) -> usize {
        let mut counts: Vec<_> = counts.iter().copied().filter(|&count| count > 0).collect();
        counts.sort_unstable();
        let (mut first, mut end, mut blocks) = (0, counts.len(), 0);
        while first < end {
            end -= 1;
            if first < end && counts[first] + counts[end] <= LANES {
                first += 1;
            }
            blocks += 1;
        }
        blocks
    }
}
