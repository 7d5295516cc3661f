//! Building a kD-tree top down.

use super::split::{Reference, Split, choose};
use super::{KdNode, KdTree, halves};
use crate::build::Work;
use crate::build::driver::primitive_bounds;
use crate::{Aabb, BuildError, BuildOptions, Geometry, parallel};

/// Sets larger than this build their two halves in parallel.
const PARALLEL_SUBTREES: usize = 4096;

/// The most primitives: with two nodes a leaf, 30 bits still number every node.
const MAX_PRIMITIVES: usize = KdNode::NUMBERS / 2;

/// Builds the tree over a geometry.
pub(super) fn build<G: Geometry>(
    geometry: &G,
    options: &BuildOptions,
    work: Work<'_>,
) -> Result<KdTree, BuildError> {
    let n = geometry.len();
    if n > MAX_PRIMITIVES {
        return Err(BuildError::TooManyPrimitives { primitives: n });
    }
    let [listing, dividing] = work.shares([1.0, 100.0]);
    let primitive_bounds = primitive_bounds(geometry, listing)?;
    let references: Vec<Reference> = primitive_bounds
        .iter()
        .zip(0..)
        .map(|(&bounds, primitive)| Reference { bounds: bounds.into(), primitive })
        .collect();
    drop(primitive_bounds);
    let bounds = references.iter().fold(Aabb::EMPTY, |all, r| all.union(r.bounds));

    let mut subtree = Subtree::default();
    if n > 0 {
        let builder = Builder { geometry, options: options.clamped() };
        let room = Room {
            levels: (8 + (1.3 * (n as f64).log2()) as usize).min(59),
            spare: (5 * n + 64).min(MAX_PRIMITIVES - n),
        };
        subtree.nodes.push(KdNode::leaf(0, 0));
        builder.subdivide(&mut subtree, 0, bounds, references, (room, dividing));
        work.check()?;
    }
    subtree.nodes.shrink_to_fit();
    subtree.primitive_indices.shrink_to_fit();
    let Subtree { nodes, primitive_indices } = subtree;
    Ok(KdTree { bounds, primitives: n as u32, nodes, primitive_indices })
}

/// A part of the tree: node 0 is its root.
#[derive(Default)]
struct Subtree {
    nodes: Vec<KdNode>,
    primitive_indices: Vec<u32>,
}

/// What a subtree may still use up.
#[derive(Clone, Copy)]
struct Room {
    /// Levels below its root.
    levels: usize,
    /// References beyond those it starts with; an empty leaf counts as one.
    spare: usize,
}

struct Builder<'a, G> {
    geometry: &'a G,
    options: BuildOptions,
}

impl<G: Geometry> Builder<'_, G> {
    /// Puts the tree over the references into a node of the subtree and behind its last one. Small ones do not report their work.
    fn subdivide(
        &self,
        subtree: &mut Subtree,
        node: usize,
        cell: Aabb,
        references: Vec<Reference>,
        (room, work): (Room, Work<'_>),
    ) {
        if references.len() > PARALLEL_SUBTREES && work.ask().is_err() {
            return;
        }
        let split = if room.levels == 0 { None } else { choose(&references, &cell, &self.options) };
        let count = references.len();
        let parts = split.map(|split| (split, self.distribute(&references, &cell, &split)));
        // More references than there is room for: a leaf.
        let Some((split, [left, right], used)) = parts.and_then(|(split, parts)| {
            let used = parts.iter().map(|part| part.len().max(1)).sum::<usize>() - count;
            (used <= room.spare).then_some((split, parts, used))
        }) else {
            let first = subtree.primitive_indices.len();
            subtree.nodes[node] = KdNode::leaf(first, count);
            subtree.primitive_indices.extend(references.iter().map(|r| r.primitive));
            return;
        };
        drop(references);

        // The children share what room is left by their numbers of references.
        let spare = room.spare - used;
        let share = |part: usize| {
            (spare as u128 * part as u128 / (left.len() + right.len()).max(1) as u128) as usize
        };
        let spare_left = share(left.len());
        let room_left = Room { levels: room.levels - 1, spare: spare_left };
        let room_right = Room { levels: room.levels - 1, spare: spare - spare_left };

        let [below, above] = halves(&cell, split.axis, split.position);
        let first_child = subtree.nodes.len();
        subtree.nodes[node] = KdNode::plane(split.axis, split.position, first_child);
        subtree.nodes.extend([KdNode::leaf(0, 0); 2]);
        if count > PARALLEL_SUBTREES {
            let [work_left, work_right] = work.shares([left.len() as f64, right.len() as f64]);
            let grow = |cell, references: Vec<Reference>, room, work: Work<'_>| {
                let is_small = references.len() <= PARALLEL_SUBTREES;
                let mut subtree = Subtree::new();
                self.subdivide(&mut subtree, 0, cell, references, (room, work));
                if is_small {
                    // If the build is stopped, the next large set sees it.
                    let _ = work.done();
                }
                subtree
            };
            let (left, right) = parallel::join_if(
                true,
                || grow(below, left, room_left, work_left),
                || grow(above, right, room_right, work_right),
            );
            subtree.graft(first_child, left);
            subtree.graft(first_child + 1, right);
        } else {
            self.subdivide(subtree, first_child, below, left, (room_left, work));
            self.subdivide(subtree, first_child + 1, above, right, (room_right, work));
        }
    }

    /// The references on each side of a plane, those on both sides clipped to each.
    fn distribute(
        &self,
        references: &[Reference],
        cell: &Aabb,
        split: &Split,
    ) -> [Vec<Reference>; 2] {
        let halves = halves(cell, split.axis, split.position);
        let mut parts = [Vec::new(), Vec::new()];
        for reference in references {
            match split.sides(&reference.bounds) {
                (true, true) => {
                    // Rounding makes parts larger, never smaller: a primitive that reaches into a half stays there.
                    for (half, part) in halves.iter().zip(&mut parts) {
                        let bounds = self
                            .geometry
                            .clipped_bounds(reference.primitive, half)
                            .intersection(&reference.bounds.intersection(half));
                        if !bounds.is_empty() {
                            part.push(Reference { bounds, ..*reference });
                        }
                    }
                }
                (left, _) => parts[usize::from(!left)].push(*reference),
            }
        }
        parts
    }
}

impl Subtree {
    /// Only a root, still to be made.
    fn new() -> Self {
        Self { nodes: vec![KdNode::leaf(0, 0)], primitive_indices: Vec::new() }
    }

    /// Puts another subtree's root into a node and its other nodes behind the last one.
    fn graft(&mut self, node: usize, other: Self) {
        let (nodes, places) = (self.nodes.len() - 1, self.primitive_indices.len());
        let mut moved = other.nodes.into_iter().map(|node| node.moved(nodes, places));
        if let Some(root) = moved.next() {
            self.nodes[node] = root;
        }
        self.nodes.extend(moved);
        self.primitive_indices.extend(other.primitive_indices);
    }
}
