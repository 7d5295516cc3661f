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
        if pruned.bounds().is_empty() {
            return Ok(None);
        }

        // Beside the children of the root if there is room, else beside the root.
        let free = pruned.free_lane();
        let old = pruned.bounds();
        let mut grafts =
            parallel::map_pieces(&pruned.boughs, 1, |bough| Graft::below(self, bough[0].line));
        grafts.push(Graft::whole(&new, primitives));
        let above = if free.is_some() { 0 } else { NODE_LINES };
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
            let (new_root, new_depth) = copied.pop().unwrap_or((Reference::NOTHING, 0));
            let (old_root, old_depth) = pruned.refer_to(&copied, &places);
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
        Ok((depth <= MAX_DEPTH).then(|| Self { root, depth, arena, ..self.clone() }))
    }
}
