//! The registry of structures: names and how each is built. A new structure is one line here.

use super::{
    AccelerationStructure, BruteForce, Bvh2, KdTree, NestedGrid, Octree, UniformGrid, WideBvh,
};
use crate::ValidationError;
use crate::build::{Builder, Work};
use crate::{BuildError, BuildOptions, Geometry, Hit, HitColumnsMut, NodeView, Probe};
use crate::{Ray, SimdLevel, Vec3};

/// Defines the kinds, their names, and the type that holds a structure of any kind.
macro_rules! structures {
    ($($kind:ident, $type:ident, $name:literal, $description:literal, $build:expr;)*) => {
        /// The kinds of acceleration structure.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum StructureKind {
            $(#[doc = $description] $kind,)*
        }

        impl StructureKind {
            /// All kinds.
            pub const ALL: &[Self] = &[$(Self::$kind,)*];

            /// Its name, as command lines and tables have it.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$kind => $name,)*
                }
            }

            /// What it is, in one line.
            pub fn description(self) -> &'static str {
                match self {
                    $(Self::$kind => $description,)*
                }
            }
        }

        /// A structure of any kind.
        #[derive(Clone, Debug)]
        pub(super) enum AnyStructure {
            $($kind($type),)*
        }

        impl AnyStructure {
            pub(super) fn build<G: Geometry>(
                kind: StructureKind,
                geometry: &G,
                options: &BuildOptions,
                work: Work<'_>,
            ) -> Result<Self, BuildError> {
                Ok(match kind {
                    $(StructureKind::$kind => Self::$kind($build(geometry, options, work)?),)*
                })
            }
        }

        impl AccelerationStructure for AnyStructure {
            #[inline]
            fn intersect<G: Geometry, P: Probe>(
                &self,
                geometry: &G,
                ray: &Ray,
                probe: &mut P,
            ) -> Option<Hit> {
                match self {
                    $(Self::$kind(structure) => structure.intersect(geometry, ray, probe),)*
                }
            }

            #[inline]
            fn occluded<G: Geometry, P: Probe>(&self, geometry: &G, ray: &Ray, probe: &mut P) -> bool {
                match self {
                    $(Self::$kind(structure) => structure.occluded(geometry, ray, probe),)*
                }
            }

            fn intersect_batch<G: Geometry>(&self, geometry: &G, rays: &[Ray], hits: &mut [Option<Hit>]) {
                match self {
                    $(Self::$kind(structure) => structure.intersect_batch(geometry, rays, hits),)*
                }
            }

            fn occluded_batch<G: Geometry>(&self, geometry: &G, rays: &[Ray], occluded: &mut [bool]) {
                match self {
                    $(Self::$kind(structure) => structure.occluded_batch(geometry, rays, occluded),)*
                }
            }

            fn intersect_from<G: Geometry>(
                &self,
                geometry: &G,
                origin: Vec3,
                directions: &[Vec3],
                hits: HitColumnsMut<'_>,
            ) {
                match self {
                    $(Self::$kind(structure) => structure.intersect_from(geometry, origin, directions, hits),)*
                }
            }

            fn occluded_towards<G: Geometry>(
                &self,
                geometry: &G,
                target: (Vec3, f32),
                points: (&[Vec3], &[u32]),
                occluded: &mut [bool],
            ) {
                match self {
                    $(Self::$kind(structure) => structure.occluded_towards(geometry, target, points, occluded),)*
                }
            }

            fn simd_level(&self) -> Option<SimdLevel> {
                match self {
                    $(Self::$kind(structure) => structure.simd_level(),)*
                }
            }

            fn set_simd_level(&mut self, level: SimdLevel) {
                match self {
                    $(Self::$kind(structure) => structure.set_simd_level(level),)*
                }
            }

            fn visit_nodes(&self, visit: &mut dyn FnMut(NodeView)) {
                match self {
                    $(Self::$kind(structure) => structure.visit_nodes(visit),)*
                }
            }

            fn bytes(&self) -> usize {
                match self {
                    $(Self::$kind(structure) => structure.bytes(),)*
                }
            }

            fn primitives(&self) -> usize {
                match self {
                    $(Self::$kind(structure) => structure.primitives(),)*
                }
            }

            fn validate<G: Geometry>(&self, geometry: &G) -> Result<(), ValidationError> {
                match self {
                    $(Self::$kind(structure) => structure.validate(geometry),)*
                }
            }
        }
    };
}

structures! {
    BruteForce, BruteForce, "brute-force", "No structure: every ray tests every primitive.", BruteForce::build_in;
    UniformGrid, UniformGrid, "uniform-grid", "Equal cells, walked one by one.", UniformGrid::build_in;
    NestedGrid, NestedGrid, "nested-grid", "Grids in the crowded cells of a coarse grid.", NestedGrid::build_in;
    BvhMidpoint, Bvh2, "bvh-midpoint", "Binary BVH, split in the middle of the longest axis.",
        |geometry, options, work| Bvh2::build_in(Builder::Midpoint, geometry, options, work);
    BvhMedian, Bvh2, "bvh-median", "Binary BVH, halved by number of primitives.",
        |geometry, options, work| Bvh2::build_in(Builder::Median, geometry, options, work);
    BvhSahSweep, Bvh2, "bvh-sah-sweep", "Binary BVH, every split tried by the surface area heuristic.",
        |geometry, options, work| Bvh2::build_in(Builder::SahSweep, geometry, options, work);
    BvhSahBinned, Bvh2, "bvh-sah-binned", "Binary BVH, splits between bins tried by the surface area heuristic.",
        |geometry, options, work| Bvh2::build_in(Builder::SahBinned, geometry, options, work);
    BvhLbvh, Bvh2, "bvh-lbvh", "Binary BVH, split where a space-filling curve through the primitives turns.",
        |geometry, options, work| Bvh2::build_in(Builder::Lbvh, geometry, options, work);
    BvhHlbvh, Bvh2, "bvh-hlbvh", "Binary BVH, leaves from a space-filling curve, the rest as bvh-sah-binned.",
        |geometry, options, work| Bvh2::build_in(Builder::Hlbvh, geometry, options, work);
    BvhPloc, Bvh2, "bvh-ploc", "Binary BVH, neighbours along a space-filling curve merged from the bottom up.",
        |geometry, options, work| Bvh2::build_in(Builder::Ploc, geometry, options, work);
    BvhWide, WideBvh, "bvh-wide", "BVH of sixteen children a node, traced by vector instructions: the default.", WideBvh::build_in;
    Octree, Octree, "octree", "Octree: crowded cells split in eight.", Octree::build_in;
    KdTree, KdTree, "kd-tree", "kD-tree: space divided by planes, surface area heuristic.", KdTree::build_in;
}

impl Default for StructureKind {
    /// The structure that traces fastest.
    fn default() -> Self {
        Self::BvhWide
    }
}

impl StructureKind {
    /// The kind of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|kind| kind.name() == name)
    }
}
