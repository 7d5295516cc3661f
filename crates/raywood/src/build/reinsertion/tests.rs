//! Moves and the search for them, against the definition of the cost and against trying every place.

use super::linked_tree::LinkedTree;
use super::rotations::{best_rotation, rotate};
use super::search::best_move;
use crate::build::Work;
use crate::{BuildOptions, Bvh2, Spheres, Vec3};

/// A tree over spheres of different sizes, one in each leaf, built badly.
fn tree(count: usize, seed: u32) -> (Spheres, LinkedTree) {
    let mut state = seed;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 24) as f32
    };
    let mut sphere = || (Vec3::new(random(), random(), random()), 0.01 + 0.3 * random().powi(4));
    let spheres = Spheres::new((0..count).map(|_| sphere()).collect()).expect("finite spheres");
    let options = BuildOptions { max_leaf_size: 1, bins: 2, ..Default::default() };
    let tree = Bvh2::build(&spheres, &options).expect("it builds");
    (spheres, LinkedTree::new(tree, Work::UNWATCHED).expect("nobody stops it"))
}

/// All moves that change something.
fn moves(tree: &LinkedTree, from: usize) -> impl Iterator<Item = usize> {
    let stays = [tree.parent(from), tree.sibling(from)];
    (0..tree.len()).filter(move |&to| tree.can_move(from, to) && !stays.contains(&to))
}

fn assert_near(a: f64, b: f64) {
    assert!((a - b).abs() <= 1e-12 * a.abs().max(b.abs()).max(1.0), "{a} is not {b}");
}

#[test]
fn a_move_changes_the_cost_as_it_says_and_can_be_taken_back() {
    let (spheres, mut tree) = tree(12, 1);
    let before = tree.clone();
    for from in 1..tree.len() {
        for to in moves(&before, from).collect::<Vec<_>>() {
            let parent = tree.parent(from);
            let growth = tree.move_beside(from, to);
            assert_near(tree.cost(), before.cost() + growth);
            assert_eq!(
                tree.clone().into_bvh2(Work::UNWATCHED).expect("nobody stops it").check(&spheres),
                Ok(())
            );
            assert_near(tree.move_beside(from, parent), -growth);
            assert!(tree == before, "{from} beside {to} and back");
        }
    }
}

#[test]
fn the_search_finds_the_best_of_all_places() {
    for seed in 0..20 {
        let (_, tree) = tree(20, seed);
        for from in 1..tree.len() {
            let gain = |to| -tree.clone().move_beside(from, to);
            let best = moves(&tree, from).map(gain).fold(0.0, f64::max);
            match best_move(&tree, from) {
                Some(found) => {
                    assert_near(found.gain, best);
                    assert_near(gain(found.to as usize), best);
                }
                None => assert_near(best, 0.0),
            }
        }
    }
}

#[test]
fn the_best_rotation_is_the_best_of_all_that_there_are() {
    for seed in 0..40 {
        let (spheres, tree) = tree(20, seed);
        for node in 0..tree.len() {
            // All pairs of subtrees one or two levels below the node, on different sides of it, but both children.
            let Some(left) = tree.left_child(node) else {
                assert_eq!(best_rotation(&tree, node), None);
                continue;
            };
            let below = |child| tree.left_child(child).into_iter().flat_map(|g| [g, g + 1]);
            let (mut best, mut pairs) = (0.0_f64, 0);
            for a in below(left).chain([left]) {
                for b in below(left + 1).chain([left + 1]) {
                    if (a, b) != (left, left + 1) {
                        best = best.max(-tree.clone().swap(a, b));
                        pairs += 1;
                    }
                }
            }
            assert!(pairs <= 8);
            let Some(found) = best_rotation(&tree, node) else {
                assert_near(best, 0.0);
                continue;
            };
            assert_near(found.gain, best);
            let (mut rotated, [a, b]) = (tree.clone(), found.places);
            assert_near(rotated.swap(a, b), -best);
            assert_near(rotated.cost(), tree.cost() - best);
            let bvh = rotated.clone().into_bvh2(Work::UNWATCHED).expect("nobody stops it");
            assert_eq!(bvh.check(&spheres), Ok(()));
            rotated.swap(a, b);
            assert!(rotated == tree, "{a} and {b} and back");
        }
    }
}

#[test]
fn as_many_passes_as_numbers_allow_end_when_nothing_is_gained() {
    let (spheres, _) = tree(300, 9);
    let cost = |rotation_passes, reinsertion_passes| {
        let (rotations, passes) = (rotation_passes, Some(reinsertion_passes));
        let options = BuildOptions {
            rotation_passes: rotations,
            reinsertion_passes: passes,
            ..Default::default()
        };
        let tree = Bvh2::build(&spheres, &options).expect("it builds");
        LinkedTree::new(tree, Work::UNWATCHED).expect("nobody stops it").cost()
    };
    assert!(cost(1, usize::MAX) < cost(0, 0));
    assert!(cost(usize::MAX, 0) < cost(0, 0));
}

#[test]
fn passes_of_rotations_gain_what_they_say() {
    let (spheres, mut tree) = tree(500, 8);
    let first = tree.cost();
    let mut cost = first;
    for _ in 0..20 {
        cost -= rotate(&mut tree, Work::UNWATCHED).expect("nobody stops it");
        assert!((tree.cost() - cost).abs() <= 1e-9 * cost);
    }
    assert!(cost < 0.9 * first, "{cost} of {first}");
    let bvh = tree.into_bvh2(Work::UNWATCHED).expect("nobody stops it");
    assert_eq!(bvh.check(&spheres), Ok(()));
}

#[test]
fn a_subtree_is_not_moved_into_itself() {
    let (_, tree) = tree(20, 3);
    assert!((0..tree.len()).all(|to| !tree.can_move(0, to)));
    for (left, from) in (1..tree.len()).filter_map(|from| Some((tree.left_child(from)?, from))) {
        assert!(!tree.can_move(from, from) && !tree.can_move(from, left));
        assert!(tree.can_move(left, 0));
    }
}
