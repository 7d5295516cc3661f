//! Meshes and rays in double precision: coordinates of the Earth, of a factory hall in micrometres, of planets.
//!
//! The tree and its boxes are single precision, in a frame of the mesh's own ([`LocalFrame`]); what single precision cannot tell of a triangle is decided
//! in double precision, and what that cannot tell in [`twofold`] numbers. `docs/numerics.md`, "Double precision", derives why nothing is lost.

mod all_hits;
mod bvh;
mod closest_point;
mod filtered;
mod hit;
mod local_frame;
mod mesh;
mod nearest_hits;
mod overlap;
mod pairs;
mod ray;
mod solid;
mod sphere_cast;
mod surface;
mod triangle;
mod twofold;

pub use bvh::Bvh64;
pub use closest_point::ClosestPoint64;
pub use hit::Hit64;
pub(crate) use local_frame::{LocalFrame, LocalRay};
pub use mesh::TriangleMesh64;
pub use overlap::{Aabb64, Ball64, Frustum64, Region64};
pub use ray::Ray64;
pub use solid::Solid64;
pub use sphere_cast::SphereHit64;
pub use surface::SurfacePoint64;
pub(crate) use triangle::PreparedRay64;
