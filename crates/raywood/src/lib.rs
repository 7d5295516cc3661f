//! Ray tracing acceleration structures and ray queries: fast, watertight, deterministic.

mod aabb;
mod geometry;
mod hit;
mod ray;
mod vec3;

pub use aabb::Aabb;
pub use geometry::{
    Geometry, Joined, MeshError, PreparedRay, PrimitiveHit, Spheres, SpheresError, SurfacePoint,
    TriangleMesh,
};
pub use hit::Hit;
pub use ray::Ray;
pub use vec3::Vec3;
