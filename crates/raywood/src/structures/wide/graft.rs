//! Subtrees of wide trees copied to other memory, in the order in which trees are built: a node's blocks, then its children side by side, then what is below each.

use super::WideBvh;
use super::collapse::{BLOCK_LINES, NODE_LINES};
use super::node::{Reference, WIDTH, WideNode};
use crate::geometry::TriangleBlock;
use crate::simd::Part;

/// A subtree that is to be copied.
pub(super) struct Graft<'t> {
    tree: &'t WideBvh,
    root: Reference,
    /// By the numbers that primitives have in it those that they get, if these are others.
    numbers: Option<&'t [u32]>,
    /// How many cache lines it takes.
    pub(super) lines: usize,
}

impl<'t> Graft<'t> {
    /// The subtree below a node, with it.
    pub(super) fn below(tree: &'t WideBvh, line: usize) -> Self {
        let root = Reference::node(line);
        Self { tree, root, numbers: None, lines: lines_of(tree, root) }
    }

    /// A whole tree in which there is something, whose primitives get these numbers.
    pub(super) fn whole(tree: &'t WideBvh, numbers: &'t [u32]) -> Self {
        let root = tree.root;
        let lines = if root.is_leaf() { BLOCK_LINES } else { lines_of(tree, root) };
        Self { tree, root, numbers: Some(numbers), lines }
    }

    /// Copies it into a part of as many lines. Tells the reference to it, and how many nodes lie on the longest way down.
    pub(super) fn copy(&self, mut all: Part<'_>) -> (Reference, usize) {
        if self.root.is_leaf() {
            let mut above = WideNode::EMPTY;
            above.children[0] = self.root.0;
            copy_blocks(self.tree, self.numbers, &mut above, &mut all);
            return (Reference(above.children[0]), 0);
        }
        let place = all.take(NODE_LINES);
        let root = Reference::node(place.first());
        (root, self.copy_below(self.root, place, &mut all))
    }

    /// Copies a node to its place, and what is below it to the front of some lines.
    fn copy_below(&self, node: Reference, mut place: Part<'_>, below: &mut Part<'_>) -> usize {
        let mut copy = *self.tree.node(node);
        copy_blocks(self.tree, self.numbers, &mut copy, below);
        let mut children = [const { None }; WIDTH];
        for (child, number) in children.iter_mut().zip(&mut copy.children) {
            let reference = Reference(*number);
            if reference != Reference::NOTHING && !reference.is_leaf() {
                let place = below.take(NODE_LINES);
                *number = Reference::node(place.first()).0;
                *child = Some((reference, place));
            }
        }
        place.put(copy);
        let children = children.into_iter().flatten();
        let depths = children.map(|(child, place)| self.copy_below(child, place, below));
        1 + depths.max().unwrap_or(0)
    }
}

/// How many lines a node takes with everything below it.
fn lines_of(tree: &WideBvh, node: Reference) -> usize {
    let node = tree.node(node);
    let nodes = node.children().filter(|(_, child)| !child.is_leaf());
    own_lines(node) + nodes.map(|(_, child)| lines_of(tree, child)).sum::<usize>()
}

/// How many lines a node takes with the blocks of its leaves.
pub(super) fn own_lines(node: &WideNode) -> usize {
    let mut blocks = [0; WIDTH];
    let mut count = 0;
    for (_, child) in node.children().filter(|(_, child)| child.is_leaf()) {
        if !blocks[..count].contains(&child.line()) {
            blocks[count] = child.line();
            count += 1;
        }
    }
    NODE_LINES + BLOCK_LINES * count
}

/// Copies the blocks of a node's leaves, which lie in a tree, to the front of some lines, and has the node refer to them.
pub(super) fn copy_blocks(
    tree: &WideBvh,
    numbers: Option<&[u32]>,
    node: &mut WideNode,
    lines: &mut Part<'_>,
) {
    let mut copied = [(0, 0); WIDTH];
    let mut count = 0;
    for number in &mut node.children {
        let child = Reference(*number);
        if child == Reference::NOTHING || !child.is_leaf() {
            continue;
        }
        let known = copied[..count].iter().find(|(line, _)| *line == child.line());
        let line = match known {
            Some(&(_, line)) => line,
            None => {
                let mut block: TriangleBlock = *tree.block(child);
                if let Some(numbers) = numbers {
                    block.primitives = block.primitives.map(|number| numbers[number as usize]);
                }
                let line = lines.first();
                lines.put(block);
                copied[count] = (child.line(), line);
                count += 1;
                line
            }
        };
        *number = child.at(line).0;
    }
}
