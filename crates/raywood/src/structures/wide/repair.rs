//! A wide tree whose worst boughs are cut off, and a new tree over the primitives in them put beside the others: the primitives of all of them together, as those that moved may
//! have come among each other. What Yoon, Curtis and Manocha, "Ray Tracing Dynamic Scenes Using Selective Restructuring", 2007, do between pairs of nodes.

use super::WideBvh;
use super::collapse::NODE_LINES;
use super::crown::{Bough, Crown, Limb};
use super::gathered::Gathered;
use super::graft::{Graft, copy_blocks, own_lines};
use super::node::{Reference, WIDTH, WideNode};
use crate::simd::{Arena, Part};
use crate::structures::MAX_DEPTH;
use crate::{Aabb, BuildError, BuildOptions, Geometry, parallel};

impl WideBvh {
    /// The primitives in those boughs and twigs that are chosen, in order, each once.
    pub(crate) fn primitives_in(&self, chosen: &[bool]) -> Vec<u32> {
        let crown = Crown::of(self);
        let mut primitives = Vec::new();
        for ((limb, lane), _) in crown.cuttings().zip(chosen).filter(|(_, is_chosen)| **is_chosen) {
            let node = self.node(Reference::node(crown.limbs[limb].line));
            self.collect(Reference(node.children[lane]), &mut primitives);
        }
        primitives.sort_unstable();
        // Those that spatial splits had cut may be in several leaves.
        primitives.dedup();
        primitives
    }

    /// Adds the primitives in a subtree.
    fn collect(&self, root: Reference, primitives: &mut Vec<u32>) {
        if root.is_leaf() {
            primitives.extend(self.primitives_of(root).map(|(_, number)| number));
        } else {
            let children = self.node(root).children();
            children.for_each(|(_, child)| self.collect(child, primitives));
        }
    }

    /// The tree without those boughs and twigs that are chosen, and with a new bough over their primitives. `None` if nothing else is left, or if it would become too large or too
    /// deep. O(k log k) for `k` primitives to build it, O(N) to copy everything, in parallel; the same for any number of threads.
    ///
    /// # Errors
    ///
    /// Those of building the bough.
    pub(crate) fn with_new_bough<G: Geometry>(
        &self,
        geometry: &G,
        (chosen, primitives): (&[bool], &[u32]),
        options: &BuildOptions,
    ) -> Result<Option<Self>, BuildError> {
        // Triangles are not cut, and what the memory allows was asked when all was built.
        let options = BuildOptions { spatial_splits: 0.0, memory_limit: None, ..options.clone() };
        let new = Self::build(&Gathered::of(geometry, primitives), &options)?;
        let mut pruned = Pruned::of(self, chosen);
        if pruned.nodes[0].children().next().is_none() {
            return Ok(None);
        }

        // Beside the children of the root if there is room, else beside the root.
        let free = (0..WIDTH).find(|&lane| pruned.nodes[0].children[lane] == Reference::NOTHING.0);
        let above = free.is_none().then(|| {
            let mut above = WideNode::EMPTY;
            above.set(0, &pruned.nodes[0].around(), Reference::NOTHING);
            above
        });
        let grafts: Vec<_> = pruned.boughs.iter().map(|bough| bough.line).collect();
        let mut grafts = parallel::map_pieces(&grafts, 1, |line| Graft::below(self, line[0]));
        grafts.push(Graft::whole(&new, primitives));
        let lines = pruned.lines() + grafts.iter().map(|graft| graft.lines).sum::<usize>();
        let lines = lines + if above.is_some() { NODE_LINES } else { 0 };
        if lines > Reference::LINES {
            return Ok(None);
        }
        let filled = Arena::filled(lines, |mut all| {
            let top = above.map(|node| (node, all.take(NODE_LINES)));
            let places = pruned.take_places(&mut all);
            let tasks: Vec<_> = grafts.iter().map(|graft| (graft, all.take(graft.lines))).collect();
            let mut copied = parallel::map_tasks(tasks, |(graft, part): (&Graft<'_>, Part<'_>)| {
                graft.copy(part)
            });
            let (new_root, new_depth) = copied.pop().unwrap_or((Reference::NOTHING, 0));
            let old_depth = pruned.refer_to(&copied, &places);
            let old_root = Reference::node(places[0].first());
            if let Some(lane) = free {
                pruned.nodes[0].set(lane, &new.bounds, new_root);
            }
            pruned.put(self, places);
            match top {
                None => (old_root, old_depth.max(1 + new_depth)),
                Some((mut node, mut place)) => {
                    node.children[0] = old_root.0;
                    node.set(1, &new.bounds, new_root);
                    let root = Reference::node(place.first());
                    place.put(node);
                    (root, 1 + old_depth.max(new_depth))
                }
            }
        });
        let Some((arena, (root, depth))) = filled else { return Ok(None) };
        Ok((depth <= MAX_DEPTH).then(|| Self { root, depth, arena, ..self.clone() }))
    }
}

/// The limbs of a tree after boughs were cut off.
struct Pruned {
    limbs: Vec<Limb>,
    /// The limbs' nodes as they are then. One without children is not needed any more.
    nodes: Vec<WideNode>,
    /// The boughs that are left.
    boughs: Vec<Bough>,
}

impl Pruned {
    /// Cuts boughs and twigs off a tree.
    fn of(tree: &WideBvh, chosen: &[bool]) -> Self {
        let crown = Crown::of(tree);
        let nodes = crown.limbs.iter().map(|limb| *tree.node(Reference::node(limb.line)));
        let mut nodes: Vec<_> = nodes.collect();
        for ((limb, lane), _) in crown.cuttings().zip(chosen).filter(|(_, is_chosen)| **is_chosen) {
            nodes[limb].set(lane, &Aabb::EMPTY, Reference::NOTHING);
        }
        let Crown { limbs, boughs, .. } = crown;
        // Children come after their parents, so from the last to the first.
        for (place, limb) in limbs.iter().enumerate().rev() {
            let Some((parent, lane)) = limb.parent else { continue };
            let bounds = nodes[place].around();
            let is_left = nodes[place].children().next().is_some();
            let reference = if is_left { Reference::node(limb.line) } else { Reference::NOTHING };
            nodes[parent].set(lane, &bounds, reference);
        }
        let boughs = boughs.into_iter().zip(chosen).filter(|(_, is_chosen)| !**is_chosen);
        let boughs = boughs.map(|(bough, _)| bough).collect();
        Self { limbs, nodes, boughs }
    }

    /// How many lines a limb takes with the blocks of its leaves.
    fn lines_of(node: &WideNode) -> usize {
        if node.children().next().is_some() { own_lines(node) } else { 0 }
    }

    /// How many lines all limbs take.
    fn lines(&self) -> usize {
        self.nodes.iter().map(Self::lines_of).sum()
    }

    /// A place for each limb.
    fn take_places<'a>(&self, all: &mut Part<'a>) -> Vec<Part<'a>> {
        self.nodes.iter().map(|node| all.take(Self::lines_of(node))).collect()
    }

    /// Has the limbs refer to each other at their places, and to the boughs at theirs. Tells how many nodes lie on the longest way down.
    fn refer_to(&mut self, boughs: &[(Reference, usize)], places: &[Part<'_>]) -> usize {
        let mut depths = vec![1; self.limbs.len()];
        for (number, limb) in self.limbs.iter().enumerate() {
            let Some((parent, lane)) = limb.parent else { continue };
            depths[number] = depths[parent] + 1;
            let reference = &mut self.nodes[parent].children[lane];
            if *reference != Reference::NOTHING.0 {
                *reference = Reference::node(places[number].first()).0;
            }
        }
        for (bough, &(root, depth)) in self.boughs.iter().zip(boughs) {
            let (limb, lane) = bough.parent;
            self.nodes[limb].children[lane] = root.0;
            depths.push(bough.depth + depth);
        }
        depths.into_iter().max().unwrap_or(0)
    }

    /// Puts all limbs into their places, with the blocks of their leaves, which lie in the tree.
    fn put(&mut self, tree: &WideBvh, places: Vec<Part<'_>>) {
        for (node, mut place) in self.nodes.iter_mut().zip(places) {
            if place.len() > 0 {
                let mut own = place.take(NODE_LINES);
                copy_blocks(tree, None, node, &mut place);
                own.put(*node);
            }
        }
    }
}
