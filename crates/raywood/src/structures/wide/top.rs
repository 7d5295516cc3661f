//! A wide tree over boxes alone, of which each leads to something else: the upper level of scenes of instances.
//!
//! Boxes stand in the nodes themselves, so that sixteen are tested at once and nothing but what is met is looked into.

use std::ops::ControlFlow;

use super::cost::Cost;
use super::node::{WIDTH, WideNode};
use super::search::lanes;
use super::slabs::{Slabs, end_of_keys};
use crate::simd::{Kernel, Simd, SimdLevel, dispatch_on};
use crate::structures::Bvh2;
use crate::{Aabb, PreparedRay};

/// What a lane of a node leads to: an even number is twice that of a node, an odd one one more than twice that of an entry.
const END: u32 = u32::MAX;

/// As many entries as a leaf of the binary tree has at most that a tree is made from.
pub(crate) const MOST_IN_LEAF: usize = WIDTH;

/// The most entries.
pub(crate) const MAX_ENTRIES: usize = 1 << 30;

/// The tree.
#[derive(Clone, Debug)]
pub(crate) struct TopTree {
    /// The first is the root.
    nodes: Vec<WideNode>,
    /// How many nodes lie on the longest way down.
    depth: usize,
    /// How far the boxes reach from zero along any axis.
    reach: f32,
    bounds: Aabb,
}

impl TopTree {
    /// Made from a binary tree of one to sixteen entries a leaf, whose nodes of largest area are opened until sixteen children are found, and from what
    /// each primitive leads to, with its box. A leaf of several becomes a node. O(N).
    pub(crate) fn of(tree: &Bvh2, entry: impl Fn(u32) -> (u32, Aabb)) -> Self {
        let bounds = tree.bounds();
        let reach = bounds.min.abs().max(bounds.max.abs()).max_element();
        if tree.nodes().is_empty() {
            return Self { nodes: Vec::new(), depth: 0, reach: 0.0, bounds };
        }
        let area = bounds.half_area();
        let per_area = if area > 0.0 { 1.0 / area } else { 0.0 };
        let nodes = Vec::with_capacity(tree.nodes().len() / WIDTH);
        let mut growth = Growth { tree, entry, per_area, nodes };
        let depth = growth.add(0);
        Self { nodes: growth.nodes, depth, reach, bounds }
    }

    /// Takes on other boxes of the same entries, by their numbers, those empty that are no entries; every box is made anew from the last node to the first. `None`, and nothing
    /// changes, if other entries have boxes than before. O(N).
    pub(crate) fn refit(&mut self, boxes: &[Aabb]) -> Option<()> {
        let entries = || {
            self.nodes
                .iter()
                .flat_map(|node| node.children)
                .filter(|item| item & 1 == 1 && *item != END)
        };
        let is_there =
            |item: u32| boxes.get((item >> 1) as usize).is_some_and(|bounds| !bounds.is_empty());
        let expected = boxes.iter().filter(|bounds| !bounds.is_empty()).count();
        if entries().count() != expected || !entries().all(is_there) {
            return None;
        }
        // Children come after their parents.
        for number in (0..self.nodes.len()).rev() {
            for lane in 0..WIDTH {
                let item = self.nodes[number].children[lane];
                let place = (item >> 1) as usize;
                if item != END {
                    let bounds =
                        if item & 1 == 1 { boxes[place] } else { self.nodes[place].around() };
                    self.nodes[number].set_item(lane, &bounds, item);
                }
            }
        }
        self.bounds = self.nodes.first().map_or(Aabb::EMPTY, WideNode::around);
        self.reach = match self.nodes.is_empty() {
            true => 0.0,
            false => self.bounds.min.abs().max(self.bounds.max.abs()).max_element(),
        };
        Some(())
    }

    /// The expected cost `Q` of a ray through it, an entry counted as a leaf of one primitive. O(N).
    pub(crate) fn cost(&self) -> f64 {
        let mut cost = Cost::default();
        if !self.nodes.is_empty() {
            cost.add(self.bounds.half_area(), 0);
        }
        for node in &self.nodes {
            for (bounds, item) in node.children() {
                cost.add(bounds.half_area(), (item.0 & 1) as usize);
            }
        }
        cost.within(&self.bounds)
    }

    /// The box around everything; empty if there is nothing.
    pub(crate) fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// How many nodes lie on the longest way down; 0 if there is nothing.
    pub(super) fn depth(&self) -> usize {
        self.depth
    }

    /// How far the boxes reach from zero along any axis.
    pub(crate) fn reach(&self) -> f32 {
        self.reach
    }

    /// Has a query look into entries, those with small keys mostly first. A break ends the search.
    pub(crate) fn search<Q: TopQuery>(&self, query: &mut Q) -> ControlFlow<()> {
        let mut waiting: Vec<(f32, u32)> = Vec::with_capacity(4 * WIDTH);
        if !self.nodes.is_empty() {
            waiting.push((0.0, 0));
        }
        while let Some((key, item)) = waiting.pop() {
            if key > query.limit() {
                continue;
            }
            if item & 1 == 1 {
                query.entry(item >> 1)?;
                continue;
            }
            let node = &self.nodes[(item >> 1) as usize];
            let ((chosen, keys), first) = (query.children(node), waiting.len());
            waiting.extend(lanes(chosen).map(|lane| (keys[lane], node.children[lane])));
            // The smallest is taken first.
            waiting[first..].sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
        }
        ControlFlow::Continue(())
    }

    /// A node by its number.
    #[inline(always)]
    pub(super) fn node(&self, number: u32) -> &WideNode {
        &self.nodes[number as usize]
    }

    /// A ray among its boxes when these are larger by `margin`.
    #[inline(always)]
    pub(super) fn slabs(&self, ray: &PreparedRay, margin: f32) -> Slabs {
        Slabs::new(ray, self.reach + margin).around(margin)
    }

    /// How much memory it takes.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..])
    }

    /// Tells `visit` of each entry that a ray may meet within its interval when all boxes are larger by `margin`, those that begin first mostly first. It is given the
    /// limit, and returns the one from there on: entries that begin beyond it are left out. A break ends the walk.
    #[inline(always)]
    pub(crate) fn walk<F: FnMut(u32, f32) -> ControlFlow<(), f32>>(
        &self,
        level: SimdLevel,
        ray: &PreparedRay,
        margin: f32,
        limit: f32,
        visit: F,
    ) -> ControlFlow<()> {
        let limit = if limit < ray.t_max { limit } else { ray.t_max };
        dispatch_on(level, Walk { tree: self, ray, margin, limit, visit })
    }
}

/// What a search through the tree looks for.
pub(crate) trait TopQuery {
    /// The children of a node to look into, as a set of lanes, and the key of each.
    fn children(&mut self, node: &WideNode) -> (u32, [f32; WIDTH]);

    /// What has a larger key need not be looked into.
    fn limit(&self) -> f32;

    /// Looks into an entry.
    fn entry(&mut self, entry: u32) -> ControlFlow<()>;
}

/// A tree that is being made.
struct Growth<'a, E> {
    /// The binary tree that it is made from.
    tree: &'a Bvh2,
    /// What each primitive leads to.
    entry: E,
    /// One by half the surface of the box around everything; zero if that has none.
    per_area: f64,
    nodes: Vec<WideNode>,
}

impl<E: Fn(u32) -> (u32, Aabb)> Growth<'_, E> {
    /// Adds the wide node of a leaf's entries.
    fn add_leaf(&mut self, primitives: &[u32]) {
        let mut node = WideNode::EMPTY;
        for (lane, &primitive) in primitives.iter().enumerate() {
            let (entry, bounds) = (self.entry)(primitive);
            node.set_item(lane, &bounds, 2 * entry + 1);
        }
        self.nodes.push(node);
    }

    /// Adds the wide node of a node of the binary tree and all below it; returns how many lie on the longest way down.
    fn add(&mut self, number: usize) -> usize {
        let nodes = self.tree.nodes();
        if nodes[number].is_leaf() {
            self.add_leaf(self.tree.leaf_primitives(&nodes[number]));
            return 1;
        }
        // Open the largest, again and again. As numbers of which the greatest is found by vectors: the bits of the area as a share of the whole but for the last four, in which the
        // lane stands. Leaves cannot be opened.
        let key = |number: usize, lane: usize| match nodes[number].is_leaf() {
            true => i32::MIN,
            false => {
                let share = (nodes[number].bounds().half_area() * self.per_area) as f32;
                share.to_bits() as i32 & !(WIDTH as i32 - 1) | lane as i32
            }
        };
        let (mut children, mut keys) = ([number; WIDTH], [i32::MIN; WIDTH]);
        keys[0] = key(number, 0);
        let mut count = 1;
        while count < WIDTH {
            let greatest = keys.iter().fold(i32::MIN, |greatest, &key| greatest.max(key));
            if greatest == i32::MIN {
                break;
            }
            let place = greatest as usize % WIDTH;
            let left = nodes[children[place]].left_first() as usize;
            (children[place], children[count]) = (left, left + 1);
            (keys[place], keys[count]) = (key(left, place), key(left + 1, count));
            count += 1;
        }

        let own = self.nodes.len();
        self.nodes.push(WideNode::EMPTY);
        let mut deepest = 0;
        for (lane, &number) in children[..count].iter().enumerate() {
            let node = &nodes[number];
            let item = if node.is_leaf() && node.count() == 1 {
                2 * (self.entry)(self.tree.leaf_primitives(node)[0]).0 + 1
            } else {
                let below = self.nodes.len();
                deepest = deepest.max(self.add(number));
                2 * below as u32
            };
            self.nodes[own].set_item(lane, &node.bounds(), item);
        }
        1 + deepest
    }
}

impl WideNode {
    /// Puts an item into a lane.
    fn set_item(&mut self, lane: usize, bounds: &Aabb, item: u32) {
        for axis in 0..3 {
            self.planes[axis][0][lane] = bounds.min[axis];
            self.planes[axis][1][lane] = bounds.max[axis];
        }
        self.children[lane] = item;
    }
}

struct Walk<'a, F> {
    tree: &'a TopTree,
    ray: &'a PreparedRay,
    margin: f32,
    limit: f32,
    visit: F,
}

impl<F: FnMut(u32, f32) -> ControlFlow<(), f32>> Kernel for Walk<'_, F> {
    type Output = ControlFlow<()>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> ControlFlow<()> {
        let Self { tree, ray, margin, limit, visit } = self;
        if tree.nodes.is_empty() {
            return ControlFlow::Continue(());
        }
        let slabs = tree.slabs(ray, margin);
        walk_below(simd, tree, &slabs, 0, limit, visit)
    }
}

/// Tells `visit` of each entry at or below an item that a ray may meet up to a limit: see [`TopTree::walk`].
#[inline(always)]
pub(super) fn walk_below<S: Simd, F: FnMut(u32, f32) -> ControlFlow<(), f32>>(
    simd: S,
    tree: &TopTree,
    slabs: &Slabs,
    item: u32,
    mut limit: f32,
    mut visit: F,
) -> ControlFlow<()> {
    let mut stack = TopStack::new(tree.depth);
    let (keys, items) = stack.parts();
    let (mut top, mut current) = (1, item);
    while current != END {
        if current & 1 == 1 {
            limit = visit(current >> 1, limit)?;
        } else {
            let node = &tree.nodes[(current >> 1) as usize];
            let (met, near) = slabs.children_met(simd, node, limit);
            top += simd.push_sorted(met, near, &node.children, (keys, items), top).0;
        }

        // On to the next that begins before the limit.
        let end = end_of_keys(limit);
        current = loop {
            top -= 1;
            if keys[top] <= end {
                break items[top];
            }
        };
    }
    ControlFlow::Continue(())
}

/// How many items a stack has room for without asking for memory.
const SMALL: usize = 128;

/// What waits during a walk: on the program's own stack unless the tree is unusually deep.
struct TopStack {
    keys: [f32; SMALL],
    items: [u32; SMALL],
    large: (Vec<f32>, Vec<u32>),
}

impl TopStack {
    #[inline(always)]
    fn new(depth: usize) -> Self {
        // Of each node on the way all children but one stay behind, below them lies the end, and sixteen are stored before it is known how many count.
        let size = (depth + 2) * WIDTH;
        let large = if size > SMALL { (vec![0.0; size], vec![0; size]) } else { (vec![], vec![]) };
        Self { keys: [0.0; SMALL], items: [0; SMALL], large }
    }

    #[inline(always)]
    fn parts(&mut self) -> (&mut [f32], &mut [u32]) {
        let (keys, items) = if self.large.0.is_empty() {
            (&mut self.keys[..], &mut self.items[..])
        } else {
            (&mut self.large.0[..], &mut self.large.1[..])
        };
        (keys[0], items[0]) = (f32::NEG_INFINITY, END);
        (keys, items)
    }
}
