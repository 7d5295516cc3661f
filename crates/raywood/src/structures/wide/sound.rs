//! Whether a wide tree that comes from outside is sound: whether nothing in it can lead a query astray.
//!
//! Every reference leads to a node or block that is there, to no node twice, and no deeper than stacks reach; numbers of primitives are in range; boxes and corners are numbers,
//! each in the box that it should be in. In contrast to `check.rs`, which asks whether a tree is right for a geometry, this looks at each byte once, as far as it can in the order in
//! which they lie in memory: loading a tree should hardly take longer than reading it.

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use super::WideBvh;
use super::collapse::{BLOCK_LINES, NODE_LINES};
use super::node::{Reference, WideNode};
use super::search::lanes;
use crate::checksum::Checksum;
use crate::geometry::TriangleBlock;
use crate::simd::{Float, Kernel, Simd, dispatch_on};
use crate::structures::MAX_DEPTH;
use crate::{Aabb, Vec3, parallel};

/// Why a tree is not sound.
pub(crate) struct Unsound {
    /// The line at which the node or block begins that is wrong; `None` if it is what is said of the root.
    pub(crate) line: Option<usize>,
    /// What is wrong.
    pub(crate) problem: String,
}

/// So many nodes wait before threads take them.
const TASKS: usize = 128;

/// Into so many stretches of memory the tree is divided at most, for threads to take.
const STRETCHES: usize = 64;

/// How many lines ahead memory is asked for: some hundred nanoseconds of work.
const AHEAD: usize = 64;

/// So many lines the checksum reads at a time, and has read ahead of what is looked at: half of what a core's own cache holds.
const READ_AHEAD: usize = (1 << 18) / 64;

/// What is found out of a tree that is sound.
pub(super) struct Checked {
    /// How many nodes lie on the longest way from the root to a leaf.
    pub(super) depth: usize,
    /// The checksum of its memory.
    pub(super) checksum: u32,
}

/// Looks at all of a tree over primitives of which the first so many are triangles. O(N), on all threads.
pub(super) fn check(tree: &WideBvh, triangles: u32) -> Result<Checked, Unsound> {
    if (tree.root == Reference::NOTHING) != (tree.primitives == 0) {
        return unsound(None, "primitives without a root, or a root without primitives");
    }
    if tree.root == Reference::NOTHING {
        return match tree.bounds == Aabb::EMPTY && tree.arena.len() == 0 {
            true => Ok(Checked { depth: 0, checksum: Checksum::of_all([]) }),
            false => unsound(None, "nothing has a box or memory"),
        };
    }
    if !tree.bounds.is_finite() || tree.bounds.is_empty() {
        return unsound(None, "the box around everything is empty or not finite");
    }
    // Which of two references to a node is the second depends on threads; what is said of it must not.
    check_in_stretches(tree, triangles, TASKS)
        .or_else(|_: Unsound| check_in_stretches(tree, triangles, 1))
}

/// The same of a tree with a root, in one stretch of memory if not more than one node is to wait, else in several at once.
fn check_in_stretches(tree: &WideBvh, triangles: u32, tasks: usize) -> Result<Checked, Unsound> {
    let words = tree.arena.len().div_ceil(64);
    let reached: Vec<_> = (0..words).map(|_| AtomicU64::new(0)).collect();
    let walk = |pending, lines| Walk {
        tree,
        triangles,
        reached: &reached,
        pending,
        unread: lines,
        checksum: Checksum::default(),
        deepest: 0,
    };

    // What refers to the root is like a node without other children.
    let mut above = WideNode::EMPTY;
    above.set(0, &tree.bounds, tree.root);
    let mut crown = walk(Vec::new(), 0..0);
    dispatch_on(tree.level, Root { walk: &mut crown, above: &above })?;
    while crown.pending.len() < tasks && !crown.pending.is_empty() {
        dispatch_on(tree.level, Level(&mut crown))?;
    }

    let stretches = stretches(tree, crown.pending, STRETCHES.min(tasks));
    let walks = parallel::map_tasks(stretches, |(pending, lines)| {
        dispatch_on(tree.level, walk(pending, lines))
    });
    let (mut depth, mut checksums) = (crown.deepest, Vec::with_capacity(walks.len()));
    for walk in walks {
        let (deepest, checksum) = walk?;
        depth = depth.max(deepest);
        checksums.push(checksum);
    }
    Ok(Checked { depth, checksum: Checksum::of_all(checksums) })
}

/// All lines in stretches of about the same size, each with the nodes that wait and what is below them there, the last one first.
fn stretches(
    tree: &WideBvh,
    mut pending: Vec<Pending>,
    most: usize,
) -> Vec<(Vec<Pending>, Range<usize>)> {
    let lines = tree.arena.len();
    let first_below =
        |node: &Pending| first_below(tree.node(Reference::node(node.line))).min(lines);
    pending.sort_by_cached_key(first_below);
    let size = lines.div_ceil(most);
    let mut stretches = vec![(Vec::new(), 0..lines)];
    for node in pending {
        let start = first_below(&node);
        let last = stretches.len() - 1;
        let (nodes, stretch) = &mut stretches[last];
        if start - stretch.start >= size && !nodes.is_empty() {
            stretch.end = start;
            stretches.push((vec![node], start..lines));
        } else {
            nodes.push(node);
        }
    }
    stretches.iter_mut().for_each(|(nodes, _)| nodes.reverse());
    stretches
}

/// Something that is wrong.
#[cold]
fn unsound<T>(line: Option<usize>, problem: impl Into<String>) -> Result<T, Unsound> {
    Err(Unsound { line, problem: problem.into() })
}

/// A walk through a part of the tree. Tells how deep it came, and the checksum of a stretch of memory, which is read just before most of what lies there is looked at.
struct Walk<'a> {
    tree: &'a WideBvh,
    /// How many primitives are triangles: the first.
    triangles: u32,
    /// By their first lines the nodes that something refers to, a bit each.
    reached: &'a [AtomicU64],
    pending: Vec<Pending>,
    /// The lines that the checksum has yet to read.
    unread: Range<usize>,
    checksum: Checksum,
    deepest: usize,
}

/// A node that is yet to be looked at.
struct Pending {
    line: usize,
    /// The box that its parent has for it.
    bounds: Aabb,
    /// How many nodes lie on the way to it, itself counted.
    depth: usize,
}

impl Kernel for Walk<'_> {
    type Output = Result<(usize, Checksum), Unsound>;

    #[inline(always)]
    fn run<S: Simd>(mut self, simd: S) -> Self::Output {
        while let Some(node) = self.pending.pop() {
            // Most nodes have only leaves below them: then this one is next.
            if let Some(next) = self.pending.last() {
                simd.prefetch(self.tree.arena.address(next.line));
            }
            let first = first_below(self.tree.node(Reference::node(node.line)));
            self.read_up_to(first + READ_AHEAD);
            self.look_below(simd, &node)?;
        }
        self.read_up_to(usize::MAX);
        Ok((self.deepest, self.checksum))
    }
}

/// The nodes that wait, and not what is below them.
struct Level<'a, 'b>(&'a mut Walk<'b>);

impl Kernel for Level<'_, '_> {
    type Output = Result<(), Unsound>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let nodes = std::mem::take(&mut self.0.pending);
        nodes.iter().try_for_each(|node| self.0.look_below(simd, node))
    }
}

/// The root as the child of nothing.
struct Root<'a, 'b> {
    walk: &'a mut Walk<'b>,
    above: &'a WideNode,
}

impl Kernel for Root<'_, '_> {
    type Output = Result<(), Unsound>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let bounds = self.walk.tree.bounds;
        self.walk.look_into(simd, None, self.above, &bounds, 0)
    }
}

impl Walk<'_> {
    /// Has the checksum read the lines before this one, and some more.
    #[inline(always)]
    fn read_up_to(&mut self, line: usize) {
        while self.unread.start < self.unread.end.min(line) {
            let end = self.unread.end.min(self.unread.start + READ_AHEAD);
            self.checksum.read(self.tree.arena.bytes_of(self.unread.start..end));
            self.unread.start = end;
        }
    }

    /// Looks at what is below a node.
    #[inline(always)]
    fn look_below<S: Simd>(&mut self, simd: S, node: &Pending) -> Result<(), Unsound> {
        let &Pending { line, bounds, depth } = node;
        self.deepest = self.deepest.max(depth);
        let node = self.tree.node(Reference::node(line));
        self.look_into(simd, Some(line), node, &bounds, depth)
    }

    /// Looks at the children of a node that is to lie in a box; those that are nodes wait from then on.
    #[inline(always)]
    fn look_into<S: Simd>(
        &mut self,
        simd: S,
        line: Option<usize>,
        node: &WideNode,
        bounds: &Aabb,
        depth: usize,
    ) -> Result<(), Unsound> {
        let (missing, leaves) = kinds_of_children(node);
        let (inside, absent) = boxes_of(simd, node, bounds);
        if inside & !missing | absent & missing != 0xffff {
            return unsound(line, "a child's box is not in that of its parent");
        }
        for lane in lanes(leaves) {
            let leaf = Reference(node.children[lane]);
            simd.prefetch(self.tree.arena.address(leaf.line() + AHEAD));
            self.check_line(line, leaf, BLOCK_LINES)?;
            if !self.is_leaf_sound(simd, leaf, node, lane) {
                return unsound(Some(leaf.line()), self.problem_of_leaf(leaf));
            }
        }
        // The last first, so that the first is taken from the stack first: as they lie in memory.
        let mut nodes = 0xffff & !missing & !leaves;
        while nodes != 0 {
            let lane = nodes.ilog2() as usize;
            nodes ^= 1 << lane;
            let child = Reference(node.children[lane]);
            self.check_line(line, child, NODE_LINES)?;
            self.refer(line, child, box_of(node, lane), depth + 1)?;
        }
        Ok(())
    }

    /// Whether a child's lines exist.
    #[inline(always)]
    fn check_line(
        &self,
        from: Option<usize>,
        child: Reference,
        size: usize,
    ) -> Result<(), Unsound> {
        let (line, lines) = (child.line(), self.tree.arena.len());
        if lines.saturating_sub(line) < size {
            return unsound(from, format!("a child in line {line}, but there are {lines} lines"));
        }
        Ok(())
    }

    /// Has a node wait that something refers to, which must be the first to do so.
    #[inline(always)]
    fn refer(
        &mut self,
        from: Option<usize>,
        child: Reference,
        bounds: Aabb,
        depth: usize,
    ) -> Result<(), Unsound> {
        let line = child.line();
        if child != Reference::node(line) {
            return unsound(from, format!("a reference of no kind, {:#010x}", child.0));
        }
        if depth > MAX_DEPTH {
            return unsound(from, format!("more than {MAX_DEPTH} nodes above one another"));
        }
        let bit = 1 << (line % 64);
        if self.reached[line / 64].fetch_or(bit, Relaxed) & bit != 0 {
            return unsound(from, format!("a second reference to the node in line {line}"));
        }
        self.pending.push(Pending { line, bounds, depth });
        Ok(())
    }

    /// Whether all that a leaf refers to is in range, and in its box where it should be.
    #[inline(always)]
    fn is_leaf_sound<S: Simd>(
        &self,
        simd: S,
        leaf: Reference,
        node: &WideNode,
        lane: usize,
    ) -> bool {
        let block = self.tree.block(leaf);
        // Lanes that are not the leaf's as well: kernels look at whole blocks.
        let most = block.primitives.iter().fold(0, |most, &primitive| most.max(primitive));
        let inside = block.corners_inside(simd, &box_of(node, lane));
        let is_usual = most < self.triangles && !leaf.is_mixed() && leaf.lanes() & !inside == 0;
        most < self.tree.primitives && (is_usual || self.is_unusual_leaf_sound(leaf, block, inside))
    }

    /// The same of a leaf with parts of triangles or with primitives that are none. The triangles in the lanes `inside` lie in its box.
    #[inline(never)]
    fn is_unusual_leaf_sound(&self, leaf: Reference, block: &TriangleBlock, inside: u32) -> bool {
        let others = if leaf.is_mixed() { block.others() } else { 0 };
        lanes(leaf.lanes()).all(|lane| {
            let primitive = block.primitives[lane];
            if others >> lane & 1 == 1 {
                let (center, radius) = block.ball(lane);
                return primitive >= self.triangles && center.is_finite() && radius >= 0.0;
            }
            let is_finite = || block.corners(lane).iter().all(|corner| corner.is_finite());
            let is_part = || self.tree.parts.contain(primitive) && is_finite();
            primitive < self.triangles && (inside >> lane & 1 == 1 || is_part())
        })
    }

    /// What is wrong with a leaf that is not sound.
    #[cold]
    fn problem_of_leaf(&self, leaf: Reference) -> String {
        let block = self.tree.block(leaf);
        let primitives = self.tree.primitives;
        if let Some(&primitive) = block.primitives.iter().find(|&&p| p >= primitives) {
            return format!("primitive {primitive}, but there are {primitives}");
        }
        let others = if leaf.is_mixed() { block.others() } else { 0 };
        let is_other = |lane: usize| others >> lane & 1 == 1;
        let is_wrong = |&lane: &usize| is_other(lane) != (block.primitives[lane] >= self.triangles);
        match lanes(leaf.lanes()).find(is_wrong) {
            Some(lane) => {
                let primitive = block.primitives[lane];
                let is = if is_other(lane) { "no triangle" } else { "a triangle" };
                format!("primitive {primitive} is {is} in its leaf, but not in the geometry")
            }
            None => "a triangle is not in its leaf's box, or a ball is not finite".to_owned(),
        }
    }
}

/// The first line of what is below a node: its blocks, then its children side by side, then what is below each.
#[inline(always)]
fn first_below(node: &WideNode) -> usize {
    // Nothing has the largest number of all.
    let first = node.children.iter().fold(u32::MAX, |first, &child| first.min(child));
    Reference(first).line()
}

/// The lanes of a node without a child, and those with leaves.
#[inline(always)]
fn kinds_of_children(node: &WideNode) -> (u32, u32) {
    let (mut missing, mut odd) = (0, 0);
    for (lane, &child) in node.children.iter().enumerate() {
        missing |= u32::from(child == Reference::NOTHING.0) << lane;
        odd |= (child & 1) << lane;
    }
    (missing, odd & !missing)
}

/// The box of a child.
#[inline(always)]
fn box_of(node: &WideNode, lane: usize) -> Aabb {
    let [x, y, z] = &node.planes;
    let min = Vec3::new(x[0][lane], y[0][lane], z[0][lane]);
    let max = Vec3::new(x[1][lane], y[1][lane], z[1][lane]);
    Aabb { min, max }
}

/// The lanes of a node whose boxes are not empty and lie in this box, and those whose boxes are those of children that are not there.
#[inline(always)]
fn boxes_of<S: Simd>(simd: S, node: &WideNode, bounds: &Aabb) -> (u32, u32) {
    let (mut inside, mut absent) = (0xffff, 0xffff);
    let (infinite, negative) = (simd.splat16(f32::INFINITY), simd.splat16(f32::NEG_INFINITY));
    for axis in 0..3 {
        let [least, greatest] = &node.planes[axis];
        let (least, greatest) = (simd.load16(least), simd.load16(greatest));
        inside &= simd.splat16(bounds.min[axis]).less_or_equal(least)
            & least.less_or_equal(greatest)
            & greatest.less_or_equal(simd.splat16(bounds.max[axis]));
        absent &= infinite.less_or_equal(least) & greatest.less_or_equal(negative);
    }
    (inside, absent)
}
