//! Ray tracing acceleration structures and ray queries: fast, watertight, deterministic.
//!
//! ```
//! use raywood::{Bvh, Ray, TriangleMesh};
//!
//! let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
//! let mesh = TriangleMesh::new(positions, vec![[0, 1, 2], [1, 3, 2]])?;      // checked once
//! let bvh = Bvh::build(&mesh)?;                                              // good defaults
//!
//! let ray = Ray::new([0.2, 0.2, 1.0], [0.0, 0.0, -1.0]);
//! if let Some(hit) = bvh.intersect(&ray) {                                   // the closest hit
//!     let point = bvh.surface_point(&ray, &hit);
//!     let light = [5.0, 5.0, 5.0];
//!     let lit = !bvh.occluded(&point.spawn_towards(light));                  // any blocker, no epsilon to choose
//!     println!("triangle {} at distance {}, lit: {lit}", hit.primitive, hit.t);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! - [`TriangleMesh`] is geometry, and so are [`Spheres`], [`Discs`], [`Capsules`], [`Cylinders`], [`Quads`] and [`Boxes`]; your own types can be through [`Geometry`]. A
//!   [`MeshView`] reads triangles from memory of your own, whatever form they have there. An [`Assembly`] puts any number of them into one tree, [`Joined`] two.
//! - [`Bvh`] has the queries: closest hit, any hit, and both for slices of rays on all cores. Its tree, the [`WideBvh`], is traced by vector instructions
//!   ([`SimdLevel`]).
//! - Besides rays it answers what is [closest](Bvh::closest_point), what lies [inside](Bvh::solid), what [overlaps](Bvh::overlapping) a region or
//!   [another geometry](Bvh::overlapping_pairs), and what a [moving sphere](Bvh::sphere_cast) touches first.
//! - It also finds [all hits](Bvh::all_hits), each crossing of a surface exactly once, and the [nearest few](Bvh::nearest_hits); and [`QueryOptions`] say which
//!   hits count: of one side, of some primitives, those that a filter of your own accepts.
//! - [`Tlas`] puts instances of trees into one scene, each at its place by a [`Transform`], on several levels if need be: rays, [options](Tlas::intersect_with), [all hits](Tlas::all_hits),
//!   [closest points](Tlas::closest_point), [insides](Tlas::solid), [overlaps](Tlas::overlapping), [moving spheres](Tlas::sphere_cast) and [walks](Tlas::visit) go through them.
//! - [`Bvh64`] takes meshes in double precision, where single precision cannot tell points apart: with hits of all kinds, [closest points](Bvh64::closest_point), [insides](Bvh64::solid),
//!   [overlaps](Bvh64::overlapping) and [moving spheres](Bvh64::sphere_cast).
//! - What moves need not be built anew: [`Bvh::refit`] makes new boxes, [`DynamicBvh`] looks after the quality of the tree as well, and [`Tlas::update`] does for instances.
//! - A tree can be [saved](Bvh::save) with its mesh and [loaded](Bvh::load) where it lies in memory, or [with more](SavedTree): a mapped file of a million triangles answers its first ray within milliseconds.
//! - [`Structure`] is any of the textbook's structures, chosen by [`StructureKind`]: for comparing.
//! - [`Bvh2`] is the tree itself: 32-byte nodes that can be read and checked, and through which [packets](Bvh2::intersect_packet) of rays can
//!   walk together.
//!
//! Who knows Embree, `parry3d` or `bvh` finds what each of their calls becomes in `docs/migrating-from-embree.md` and `docs/migrating-from-parry3d-and-bvh.md`.
//!
//! # Contracts
//!
//! - Hits lie at `t_min <= t < t_max`, in units of the direction's length; directions need not be normalised.
//! - At exactly equal `t` the lowest primitive number wins, of instances first the lowest of theirs: [`Hit`] has the rule and where it ends. `docs/conformance.md` lists what is compared with brute force.
//! - Watertight: no ray slips between two triangles that share an edge or vertex.
//! - No input panics, hangs or gives a hit that is not there: meshes with NaN or infinite vertices are refused, rays with NaN miss,
//!   empty meshes are legal. Saved trees are checked when they are loaded: whatever their bytes are, the same holds.
//! - A build can be [watched](Bvh::build_watched) and stopped, and its [memory](BuildMemory) is known before it begins.
//! - Trees and answers do not depend on the number of threads. Work runs in the caller's rayon pool (feature `rayon`, on by
//!   default) or on the calling thread.

mod aabb;
mod build;
mod bvh;
mod change;
mod checksum;
mod double;
mod doubles;
mod error;
mod geometry;
mod hit;
mod hit_columns;
mod instances;
mod minmax;
mod parallel;
mod query;
mod ray;
mod saved;
mod simd;
mod stats;
mod storage;
mod structures;
mod traverse;
mod validate;
mod vec3;

pub use aabb::Aabb;
pub use build::{BuildMemory, BuildOptions, BuildPreset, Builder, TriangleTest};
pub use bvh::Bvh;
pub use change::{Decision, DynamicBvh, RefitError, Update, UpdateOptions};
pub use doubles::{Aabb64, Ball64, Frustum64, Region64};
pub use doubles::{Bvh64, ClosestPoint64, Hit64, Ray64, SurfacePoint64, TriangleMesh64};
pub use doubles::{Solid64, SphereHit64};
pub use error::BuildError;
pub use geometry::{
    Assembly, Boxes, Capsule, Capsules, Cylinder, Cylinders, Disc, Discs, Quads, ShapeError,
    ShapeProblem, Spheres, SpheresError,
};
pub use geometry::{
    Consecutive, IndexNumber, Indices, MeshError, MeshPart, MeshView, Strided, StridedError,
    TriangleMesh, Vertices,
};
pub use geometry::{Geometry, Joined, PreparedRay, PrimitiveHit, PrimitivePoint, SurfacePoint};
pub use hit::Hit;
pub use hit_columns::{HitColumns, HitColumnsMut};
pub use instances::{
    BoundsMargin, Enclosure, FrustumSearch, InsideSearch, Instance, InstanceError, ObjectPoint,
    PairSearch, SceneRegion, SceneSolid, Searchable, SpaceSearch, SweptSearch, Tlas, Traceable,
    Transform, TransformError, WalkSearch,
};
pub use query::{AcceptAll, Face, HitFilter, HitLists, HitRules, QueryOptions};
pub use query::{Ball, ClosestPoint, Frustum, Region, Solid, SphereHit};
pub use ray::Ray;
pub use saved::{SavedGeometry, SavedTree, SavedTreeError};
pub use simd::{SimdLevel, SimdLevelError, Vectorized};
pub use stats::{Level, NodeView, StructureStats};
pub use structures::{AccelerationStructure, KdNode, Node, Structure, StructureKind};
pub use structures::{BruteForce, Bvh2, KdTree, NestedGrid, Octree, UniformGrid, WideBvh};
pub use traverse::{Coherence, Counts, Probe};
pub use validate::ValidationError;
pub use vec3::Vec3;

/// The examples of the pages for who comes from other libraries, which nobody else compiles.
#[cfg(doctest)]
mod pages {
    #[doc = include_str!("../../../docs/migrating-from-embree.md")]
    struct FromEmbree;

    #[doc = include_str!("../../../docs/migrating-from-parry3d-and-bvh.md")]
    struct FromParry3dAndBvh;
}
