//! New boxes for a tree whose primitives moved, from the leaves to the root, while everything stays where it is: Wald, Boulos and Shirley, "Ray Tracing Deformable Scenes Using
//! Dynamic Bounding Volume Hierarchies", 2007, section 4. Subtrees are given to threads; every line of memory is written by one of them.

use super::WideBvh;
use super::cost::Cost;
use super::crown::{Bough, Crown};
use super::measure::Measured;
use super::node::{Reference, WIDTH, WideNode};
use super::parts::Parts;
use super::step::lanes;
use crate::build::PackedAabb;
use crate::change::{RefitError, check_primitives};
use crate::geometry::TriangleBlock;
use crate::simd::{Claims, Lines};
use crate::structures::MAX_DEPTH;
use crate::{Aabb, Geometry, parallel};

/// What is known of a subtree after its boxes were made anew.
#[derive(Clone, Copy)]
pub(super) struct Fitted {
    /// The box around it.
    pub(super) bounds: PackedAabb,
    /// What the nodes below its root cost.
    pub(super) below: Cost,
}

impl WideBvh {
    /// Takes on the places that primitives have now. On an error nothing has changed.
    pub(crate) fn refit_measured<G: Geometry>(
        &mut self,
        geometry: &G,
    ) -> Result<Measured, RefitError> {
        check_primitives(geometry, self.primitives as usize)?;
        let crown = Crown::of(self);
        // What others see stays as it is, and so does what comes from outside: there may be lines that are referred to twice.
        let mut copy = None;
        if !self.arena.is_alone() {
            copy = Some(self.arena.copied());
        }
        let arena = copy.as_mut().unwrap_or(&mut self.arena);
        let claims = arena.claims().ok_or(RefitError::NotATree { line: 0 })?;
        let refit = Refit { geometry, claims: &claims };
        let (root, bounds, below, cuttings) = match self.root {
            Reference::NOTHING => return Ok(Measured { cost: 0.0, cuttings: Vec::new() }),
            leaf if leaf.is_leaf() => {
                let mut above = WideNode::EMPTY;
                above.children[0] = leaf.0;
                let fitted = refit.leaves(&mut above)?;
                (Reference(above.children[0]), fitted.bounds, Cost::default(), Vec::new())
            }
            node => {
                let (fitted, cuttings) = refit.crown(&crown)?;
                (node, fitted.bounds, fitted.below, cuttings)
            }
        };

        let bounds = Aabb::from(bounds);
        let mut cost = below;
        cost.add(bounds.half_area(), root.references());
        if let Some(copy) = copy {
            self.arena = copy;
        }
        self.root = root;
        self.bounds = bounds;
        self.reach = bounds.min.abs().max(bounds.max.abs()).max_element();
        self.parts = Parts::from_bits(self.parts.take_bits(), &bounds);
        Ok(Measured { cost: cost.within(&bounds), cuttings })
    }
}

/// How many lines ahead memory is asked for: about those of a node's leaves.
const AHEAD: usize = 64;

/// Boxes that are being made anew.
struct Refit<'r, 'a, G> {
    geometry: &'r G,
    claims: &'r Claims<'a>,
}

impl<'a, G: Geometry> Refit<'_, 'a, G> {
    /// Refits all of a tree. Also tells what each bough and each twig adds to its cost.
    fn crown(&self, crown: &Crown) -> Result<(Fitted, Vec<f64>), RefitError> {
        let Crown { limbs, boughs, twigs } = crown;
        let fit = |&Bough { line, depth, .. }: &Bough| self.node(line, depth);
        let fitted: Result<Vec<_>, _> =
            parallel::map_pieces(boughs, 1, |bough| fit(&bough[0])).into_iter().collect();
        let fitted = fitted?;

        // The rest from the last limb to the first: what is below each is known when its turn comes.
        let mut waiting: Vec<Vec<(usize, Fitted)>> = limbs.iter().map(|_| Vec::new()).collect();
        for (&Bough { parent: (limb, lane), .. }, &fitted) in boughs.iter().zip(&fitted) {
            waiting[limb].push((lane, fitted));
        }
        let mut whole = Fitted { bounds: PackedAabb::EMPTY, below: Cost::default() };
        let mut twig_costs = vec![Cost::default(); twigs.len()];
        for (place, limb) in limbs.iter().enumerate().rev() {
            let node: &mut WideNode = self.take(limb.line)?;
            whole = self.leaves(node)?;
            for twig in limb.twigs.clone() {
                let (_, lane) = twigs[twig];
                let references = Reference(node.children[lane]).references();
                twig_costs[twig].add(node.bounds(lane).half_area(), references);
            }
            for (lane, fitted) in waiting[place].drain(..) {
                whole.put(node, lane, &fitted);
            }
            if let Some((parent, lane)) = limb.parent {
                waiting[parent].push((lane, whole));
            }
        }
        let boughs = fitted.iter().map(|bough| {
            let mut cost = bough.below;
            cost.add(bough.bounds.half_area(), 0);
            cost
        });
        let bounds = Aabb::from(whole.bounds);
        let costs = boughs.chain(twig_costs).map(|cost| cost.within(&bounds)).collect();
        Ok((whole, costs))
    }

    /// Refits a node and everything below it.
    fn node(&self, line: usize, depth: usize) -> Result<Fitted, RefitError> {
        // No tree is deeper, whoever made it.
        if depth > MAX_DEPTH {
            return Err(RefitError::NotATree { line });
        }
        let node: &mut WideNode = self.take(line)?;
        let mut whole = self.leaves(node)?;
        for lane in 0..WIDTH {
            let child = Reference(node.children[lane]);
            if child != Reference::NOTHING && !child.is_leaf() {
                let fitted = self.node(child.line(), depth + 1)?;
                whole.put(node, lane, &fitted);
            }
        }
        Ok(whole)
    }

    /// Refits those children of a node that are leaves. Tells the box around these, and what they cost.
    fn leaves(&self, node: &mut WideNode) -> Result<Fitted, RefitError> {
        // All blocks first, and the memory of all primitives asked for, so that it comes while others are looked at.
        let mut blocks: [Option<(usize, &mut TriangleBlock)>; WIDTH] = [const { None }; WIDTH];
        let mut count = 0;
        for lane in 0..WIDTH {
            let child = Reference(node.children[lane]);
            if child == Reference::NOTHING || !child.is_leaf() {
                continue;
            }
            let line = child.line();
            if !blocks[..count].iter().flatten().any(|&(other, _)| other == line) {
                self.claims.prefetch::<TriangleBlock>(line + AHEAD);
                let block: &mut TriangleBlock = self.take(line)?;
                for &primitive in &block.primitives {
                    self.geometry.prefetch(primitive);
                }
                blocks[count] = Some((line, block));
                count += 1;
            }
        }
        for (_, block) in blocks[..count].iter().flatten() {
            block.primitives.iter().for_each(|&primitive| self.geometry.prefetch_rest(primitive));
        }
        let mut whole = Fitted { bounds: PackedAabb::EMPTY, below: Cost::default() };
        for lane in 0..WIDTH {
            let child = Reference(node.children[lane]);
            if child == Reference::NOTHING || !child.is_leaf() {
                continue;
            }
            let own = blocks[..count].iter_mut().flatten().find(|(line, _)| *line == child.line());
            let Some((_, block)) = own else { continue };
            let (bounds, is_mixed) = self.leaf(child.lanes(), block);
            whole.bounds.grow(&bounds);
            whole.below.add(bounds.half_area(), child.count());
            node.set(lane, &bounds.into(), child.mixed_if(is_mixed));
        }
        Ok(whole)
    }

    /// Puts the primitives of a leaf into their lanes anew. Tells the box around them, and whether there are some that are no triangles.
    #[inline(always)]
    fn leaf(&self, own: u32, block: &mut TriangleBlock) -> (PackedAabb, bool) {
        let mut bounds = PackedAabb::EMPTY;
        let mut is_mixed = false;
        for lane in lanes(own) {
            let primitive = block.primitives[lane];
            match self.geometry.triangle(primitive) {
                Some(corners) => {
                    for corner in corners {
                        bounds = bounds.including([corner.x, corner.y, corner.z, 0.0]);
                    }
                    block.set(lane, primitive, corners);
                }
                None => {
                    is_mixed = true;
                    bounds.grow(&self.geometry.bounds(primitive).into());
                    block.set_other(lane, primitive, self.geometry.bounding_ball(primitive));
                }
            }
        }
        (bounds, is_mixed)
    }

    /// A thing that nobody has yet, to be changed.
    fn take<T: Lines>(&self, line: usize) -> Result<&'a mut T, RefitError> {
        self.claims.take(line).ok_or(RefitError::NotATree { line })
    }
}

impl Fitted {
    /// Puts a subtree into a lane of the node, which this is about.
    fn put(&mut self, node: &mut WideNode, lane: usize, child: &Self) {
        self.bounds.grow(&child.bounds);
        self.below.add_all(&child.below);
        self.below.add(child.bounds.half_area(), 0);
        node.set(lane, &child.bounds.into(), Reference(node.children[lane]));
    }
}
