//! What a caller can choose about a build.

use super::{Builder, PackedAabb};

/// How to build a tree. The defaults are good; start from them:
///
/// ```
/// let options = raywood::BuildOptions { max_leaf_size: 4, ..Default::default() };
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct BuildOptions {
    /// Into how many bins the centroids are sorted per axis when a split is chosen, 2 to 32. More bins find slightly better
    /// splits and take longer.
    pub bins: usize,
    /// The most primitives a leaf of a bounding volume hierarchy may hold, at least 1. Larger sets are split even if the cost model would
    /// not. Only there: each of its primitives lies in one leaf, so that any set can be split in two smaller ones. No plane or grid does that
    /// for primitives that overlap, so structures that divide space stop where dividing no longer pays.
    pub max_leaf_size: usize,
    /// The most primitives a leaf of the binary tree may hold from which the wide tree is made, at least 1. The wide tree puts leaves together again, up to
    /// eight primitives. From smaller ones come no better trees: reinsertion then tears primitives apart that one leaf would hold at the cost of one.
    pub wide_leaf_size: usize,
    /// Who builds the binary tree from which the wide tree is made. With [`Builder::Lbvh`], no passes of reinsertion and nothing cut there is none: the wide tree is made
    /// from the order on the curve at once, in half of the time.
    pub wide_builder: Builder,
    /// By which share, 0 to 4, the wide tree may have more references than there are primitives because large triangles are cut where that pays (spatial splits: Stich,
    /// Friedrich and Dietrich 2009). Traces up to a tenth faster where large triangles lie among small ones, takes several times as long to build, and more memory. 0 cuts nothing.
    /// Only triangles are cut.
    /// Above 0 the binary tree is built as by [`Builder::SahBinned`], whatever `wide_builder` says;
    /// and another as if this were 0, for that is better in some scenes: the one of which rays are expected to visit fewer nodes is kept.
    pub spatial_splits: f32,
    /// The estimated cost of visiting a node (`C_aabb`).
    pub node_cost: f32,
    /// The estimated cost of testing a primitive (`C_tri`), in the same unit.
    pub primitive_cost: f32,
    /// How many passes at most improve a bounding volume hierarchy after it is built, before reinsertion, by having subtrees near a node change places (rotations: Kensler 2008).
    /// A pass gains less than one of reinsertion that takes as long.
    pub rotation_passes: usize,
    /// How many passes at most improve a bounding volume hierarchy after it is built, by moving subtrees to where they cost less. `None` leaves it to the structure: four for scenes of instances, whose boxes overlap, none for all other trees.
    pub reinsertion_passes: Option<usize>,
    /// Which share of the nodes a pass of reinsertion tries to move, 0 to 1: the largest ones, which matter most. More gain a little more and take
    /// longer in proportion.
    pub reinsertion_share: f32,
    /// The least share, 0 to 1, by which a pass of rotations or reinsertion must lower the cost of the whole tree for another one to follow.
    pub reinsertion_gain: f32,
    /// About how many cells a grid has for each primitive, 0.01 to 100. More cells make shorter lists, longer walks and more memory.
    pub grid_density: f32,
    /// How many primitives a cell of an octree may hold without being split, at least 1.
    pub octree_leaf_size: usize,
    /// The most levels of an octree, the root's counted, 1 to 24.
    pub octree_max_depth: usize,
    /// By which share, 0 to 1, a kD-tree's split counts as cheaper when it cuts off empty space.
    pub kd_empty_bonus: f32,
    /// How rays are tested against triangles by [`WideBvh`](crate::WideBvh). All other structures are always watertight.
    pub triangle_test: TriangleTest,
    /// The most memory that a build may take, in bytes, what it holds meanwhile counted but not the geometry. One that may take more by [`BuildMemory`](crate::BuildMemory) ends
    /// with [`BuildError::MemoryLimit`](crate::BuildError::MemoryLimit) before it begins. `None` for as much as there is.
    pub memory_limit: Option<usize>,
}

/// How rays are tested against triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum TriangleTest {
    /// No ray slips between triangles that share an edge, and hits of single rays are the same for every structure, to the bit.
    #[default]
    Watertight,
    /// Rays may slip between triangles that share an edge, and hits may differ from those of other structures in the last digits, for triangles millions of times as long as they are far away by
    /// more: then another of the hits may be told of as the closest by each kernel. Kept to compare speeds: other libraries test like this by default.
    Fast,
}

impl Default for BuildOptions {
    fn default() -> Self {
        Self {
            bins: 16,
            max_leaf_size: 8,
            wide_leaf_size: 8,
            wide_builder: Builder::Ploc,
            spatial_splits: 0.0,
            node_cost: 1.0,
            primitive_cost: 1.0,
            rotation_passes: 0,
            reinsertion_passes: None,
            reinsertion_share: 0.05,
            reinsertion_gain: 0.005,
            grid_density: 4.0,
            octree_leaf_size: 8,
            octree_max_depth: crate::structures::octree::MAX_LEVELS,
            kd_empty_bonus: 0.2,
            triangle_test: TriangleTest::Watertight,
            memory_limit: None,
        }
    }
}

impl BuildOptions {
    /// The options with every value inside its documented range.
    pub(crate) fn clamped(&self) -> Self {
        let cost = |c: f32| if c.is_finite() && c > 0.0 { c } else { 1.0 };
        // Not a number counts as nothing.
        let share = |share: f32| if share > 0.0 { share.min(1.0) } else { 0.0 };
        Self {
            bins: self.bins.clamp(2, super::sah_binned::MAX_BINS),
            max_leaf_size: self.max_leaf_size.max(1),
            wide_leaf_size: self.wide_leaf_size.clamp(1, crate::geometry::LANES),
            wide_builder: self.wide_builder,
            spatial_splits: if self.spatial_splits > 0.0 {
                self.spatial_splits.min(4.0)
            } else {
                0.0
            },
            node_cost: cost(self.node_cost),
            primitive_cost: cost(self.primitive_cost),
            rotation_passes: self.rotation_passes.min(64),
            reinsertion_passes: self.reinsertion_passes,
            reinsertion_share: share(self.reinsertion_share),
            reinsertion_gain: share(self.reinsertion_gain),
            grid_density: if self.grid_density.is_nan() {
                Self::default().grid_density
            } else {
                self.grid_density.clamp(0.01, 100.0)
            },
            octree_leaf_size: self.octree_leaf_size.max(1),
            octree_max_depth: self.octree_max_depth.clamp(1, crate::structures::octree::MAX_LEVELS),
            kd_empty_bonus: share(self.kd_empty_bonus),
            triangle_test: self.triangle_test,
            memory_limit: self.memory_limit,
        }
    }

    /// Whether a bounding volume hierarchy is improved after it is built; a structure that has passes of its own says so before.
    pub(crate) fn improves(&self) -> bool {
        self.rotation_passes > 0 || self.reinsertion_passes.is_some_and(|passes| passes > 0)
    }

    /// Whether triangles are cut for the wide tree.
    pub(crate) fn cuts_triangles(&self) -> bool {
        self.clamped().spatial_splits > 0.0
    }

    /// Whether dividing a set of `count` primitives costs less than a leaf over it; `split_cost` is `N_l*A_l + N_r*A_r` in half areas.
    pub(super) fn split_is_cheaper(
        &self,
        count: usize,
        node_bounds: &PackedAabb,
        split_cost: f64,
    ) -> bool {
        let area = node_bounds.half_area();
        let (node_cost, primitive_cost) =
            (f64::from(self.node_cost), f64::from(self.primitive_cost));
        let leaf_cost = primitive_cost * count as f64 * area;
        2.0 * node_cost * area + primitive_cost * split_cost < leaf_cost
    }
}
