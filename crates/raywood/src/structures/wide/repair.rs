//! A wide tree whose worst boughs are cut off, and a new tree over the primitives in them put beside the others: the primitives of all of them together, as those that moved may
//! have come among each other. What Yoon, Curtis and Manocha, "Ray Tracing Dynamic Scenes Using Selective Restructuring", 2007, do between pairs of nodes.

use super::WideBvh;
use super::collapse::NODE_LINES;
use super::crown::Crown;
use super::gathered::Gathered;
use super::graft::Graft;
use super::node::{Reference, WideNode};
use super::pruned::Pruned;
use crate::simd::{Arena, Part};
use crate::structures::MAX_DEPTH;
use crate::{BuildError, BuildOptions, Geometry, parallel};

impl WideBvh {
    /// The primitives in those boughs and twigs that are chosen, in order, each once.
    pub(crate) fn primitives_in(&self, chosen: &[bool]) -> Vec<u32> {
        let crown = Crown::of(self);
        let mut primitives = Vec::new();
        for ((limb, lane), _) in crown.cuttings().zip(chosen).filter(|(_, is_chosen)| **is_chosen) {
            let node = self.node(crown.limbs[limb].reference());
            self.collect(Reference(node.children[lane]), &mut primitives);
        }
        primitives.sort_unstable();
        // Those that spatial splits had cut may be in several leaves.
        primitives.dedup();
        primitives
    }

    /// Which boughs and twigs have blocks with primitives of this number or higher ones.
    pub(crate) fn cuttings_from(&self, first: u32) -> Vec<bool> {
        let crown = Crown::of(self);
        let cuttings: Vec<_> = crown.cuttings().collect();
        parallel::map_pieces(&cuttings, 1, |cutting| {
            let (limb, lane) = cutting[0];
            let node = self.node(crown.limbs[limb].reference());
            self.reaches(Reference(node.children[lane]), first)
        })
    }

    /// Whether blocks of a subtree have such primitives, be it in lanes of other leaves, which are copied with them.
    fn reaches(&self, root: Reference, first: u32) -> bool {
        if root.is_leaf() {
            return self.block(root).primitives.iter().any(|&number| number >= first);
        }
        self.node(root).children().any(|(_, child)| self.reaches(child, first))
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

    /// The tree without those boughs and twigs that are chosen, and with a new bough over their primitives: those of these numbers. These may be others than there were, if the tree is then over all
    /// of the geometry; where these lie that the tree had before is not looked at. `None` if nothing else is left, or if it would become too large or too deep. O(k log k) for `k` primitives to build it, O(N) to copy everything, in parallel; the same for any number of threads.
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
        if self.root.is_leaf() {
            return Ok(None);
        }
        let mut pruned = Pruned::of(self, chosen);
        if pruned.bounds().is_empty() {
            return Ok(None);
        }

        // Beside the children of the root if there is room, else beside the root.
        let free = pruned.free_lane();
        let old = pruned.bounds();
        let mut grafts =
            parallel::map_pieces(&pruned.boughs, 1, |bough| Graft::below(self, bough[0].line));
        if !primitives.is_empty() {
            grafts.push(Graft::whole(&new, primitives));
        }
        let above = if free.is_some() || primitives.is_empty() { 0 } else { NODE_LINES };
        let lines = above + pruned.lines() + grafts.iter().map(|graft| graft.lines).sum::<usize>();
        if lines > Reference::LINES {
            return Ok(None);
        }
        let filled = Arena::filled(lines, |mut all| {
            let mut above = all.take(above);
            let places = pruned.copy_twigs(self, &mut all);
            let tasks: Vec<_> = grafts.iter().map(|graft| (graft, all.take(graft.lines))).collect();
            let copy = |(graft, part): (&Graft<'_>, Part<'_>)| graft.copy(part);
            let mut copied = parallel::map_tasks(tasks, copy);
            let grafted = if primitives.is_empty() { None } else { copied.pop() };
            let (old_root, old_depth) = pruned.refer_to(&copied, &places);
            let Some((new_root, new_depth)) = grafted else {
                pruned.put(places);
                return (old_root, old_depth);
            };
            if let Some(lane) = free {
                pruned.add_below_root(lane, &new.bounds, new_root);
                pruned.put(places);
                return (old_root, old_depth.max(1 + new_depth));
            }
            pruned.put(places);
            let mut node = WideNode::EMPTY;
            node.set(0, &old, old_root);
            node.set(1, &new.bounds, new_root);
            let root = Reference::node(above.first());
            above.put(node);
            (root, 1 + old_depth.max(new_depth))
        });
        let Some((arena, (root, depth))) = filled else { return Ok(None) };
        if depth > MAX_DEPTH {
            return Ok(None);
        }
        let bounds = old.union(new.bounds);
        let reach = bounds.min.abs().max(bounds.max.abs()).max_element();
        let parts = self.parts.resized(geometry.len());
        let primitives = geometry.len() as u32;
        Ok(Some(Self { root, depth, arena, bounds, reach, parts, primitives, ..self.clone() }))
    }
}
