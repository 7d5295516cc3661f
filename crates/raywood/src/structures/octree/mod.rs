//! The octree: space divided in eight while a cell is crowded. Glassner, "Space Subdivision for Fast Ray Tracing", IEEE CG&A 1984.

mod build;
mod cell;
mod check;
mod traverse;

use super::{AccelerationStructure, StructureKind};
use crate::build::{BuildMemory, Work};
use crate::traverse::mailbox::Mailbox;
use crate::traverse::nearest::{Nearest, blocks};
use crate::{Aabb, BuildError, BuildOptions, Geometry, Hit, PreparedRay, Probe, Ray};
use crate::{NodeView, ValidationError};
use cell::{middle, octant};
use traverse::walk;

/// The most levels of an octree, the root's counted: below them cells are as fine as single precision resolves the root.
pub(crate) const MAX_LEVELS: usize = 24;

/// A cell of 8 bytes. Where it lies follows from the way to it, so no box is stored; octants without primitives have no node.
///
/// `content` tells what it is. Of an interior cell it is the set of octants that have a node, one bit each (below 256), and
/// these nodes lie side by side from `first` on. Of a leaf it is 255 more than the number of its references, which stand in
/// `references[first..]`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
struct Node {
    first: u32,
    content: u32,
}

const _: () = assert!(size_of::<Node>() == 8);

/// The largest set of octants; what is more is a number of references.
const ALL_OCTANTS: u32 = 0xFF;

impl Node {
    /// A leaf with `count` references, at least one, from place `first` on.
    fn leaf(first: usize, count: usize) -> Self {
        Self { first: first as u32, content: count as u32 + ALL_OCTANTS }
    }

    /// An interior cell whose nodes begin at `first`.
    fn interior(first: usize, octants: u8) -> Self {
        Self { first: first as u32, content: u32::from(octants) }
    }

    /// The number of references of a leaf; 0 in an interior cell.
    #[inline]
    fn count(&self) -> usize {
        self.content.saturating_sub(ALL_OCTANTS) as usize
    }

    /// The octants of an interior cell that have a node, one bit each; none in a leaf.
    #[inline]
    fn octants(&self) -> u8 {
        if self.content <= ALL_OCTANTS { self.content as u8 } else { 0 }
    }

    /// The number of the node of one of these octants.
    #[inline]
    fn child(&self, octant: usize) -> usize {
        let before = self.octants() & ((1u8 << octant) - 1);
        self.first as usize + before.count_ones() as usize
    }
}

/// An octree: the box around everything, divided in eight equal octants again and again while a cell holds many primitives; in four or two
/// as long as some axes are half as long as the longest, so that cells become near cubes.
///
/// A primitive is referred to by every leaf that it overlaps. A cell stays a leaf when it holds few primitives, when the depth
/// limit is reached, when dividing it would not pay (a ray through a cell meets a quarter of what its octants hold together), or
/// when primitives would have more than eight references each on average. So N primitives have at most 8N references, and with the
/// default options at most 50 bytes a reference in the worst of scenes, about 6 in usual ones.
///
/// Building takes O(N log N) for primitives that are small against the scene, in parallel; O(N) a level in any case.
#[derive(Clone, Debug, PartialEq)]
pub struct Octree {
    bounds: Aabb,
    primitives: u32,
    nodes: Vec<Node>,
    references: Vec<u32>,
}

impl Octree {
    /// Builds the octree. The same for any number of threads.
    ///
    /// # Errors
    ///
    /// Too many primitives, or one whose box is empty or not finite.
    pub fn build<G: Geometry>(geometry: &G, options: &BuildOptions) -> Result<Self, BuildError> {
        Self::build_in(geometry, options, Work::UNWATCHED)
    }

    /// Builds it as a part of some work.
    pub(crate) fn build_in<G: Geometry>(
        geometry: &G,
        options: &BuildOptions,
        work: Work<'_>,
    ) -> Result<Self, BuildError> {
        BuildMemory::check(StructureKind::Octree, geometry.len(), options)?;
        build::build(geometry, &options.clamped(), work)
    }

    /// The box around everything, which is the root's cell; empty if there is nothing.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// The numbers of a leaf's primitives, in ascending order.
    #[inline]
    fn leaf_primitives(&self, leaf: &Node) -> &[u32] {
        &self.references[leaf.first as usize..][..leaf.count()]
    }
}

impl AccelerationStructure for Octree {
    fn intersect<G: Geometry, P: Probe>(
        &self,
        geometry: &G,
        ray: &Ray,
        probe: &mut P,
    ) -> Option<Hit> {
        let ray = PreparedRay::new(ray)?;
        let mut nearest = Nearest::new(&ray);
        let mut mailbox = Mailbox::new();
        walk(self, &ray, probe, |probe, primitives| {
            for &primitive in primitives {
                probe.references(1);
                if mailbox.is_new(primitive) {
                    probe.primitives(1);
                    nearest.test(geometry, &ray, primitive);
                }
            }
            Some(nearest.t_max())
        });
        nearest.into_hit()
    }

    fn occluded<G: Geometry, P: Probe>(&self, geometry: &G, ray: &Ray, probe: &mut P) -> bool {
        let Some(ray) = PreparedRay::new(ray) else { return false };
        let mut blocked = false;
        let mut mailbox = Mailbox::new();
        walk(self, &ray, probe, |probe, primitives| {
            blocked = primitives.iter().any(|&primitive| {
                probe.references(1);
                mailbox.is_new(primitive) && {
                    probe.primitives(1);
                    blocks(geometry, &ray, primitive)
                }
            });
            (!blocked).then_some(ray.t_max)
        });
        blocked
    }

    fn visit_nodes(&self, visit: &mut dyn FnMut(NodeView)) {
        let mut pending = Vec::new();
        pending.extend(self.nodes.first().map(|&root| (root, self.bounds, 0)));
        while let Some((node, bounds, level)) = pending.pop() {
            let references = (node.count() > 0).then_some(node.count());
            visit(NodeView { bounds, level, references });

            let middle = middle(&bounds);
            for number in (0..8).filter(|number| node.octants() >> number & 1 == 1) {
                let child = self.nodes[node.child(number)];
                pending.push((child, octant(&bounds, middle, number), level + 1));
            }
        }
    }

    fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.references[..])
    }

    fn primitives(&self) -> usize {
        self.primitives as usize
    }

    fn validate<G: Geometry>(&self, geometry: &G) -> Result<(), ValidationError> {
        self.check(geometry)
    }
}
