//! Questions about space: what is near, what overlaps, what a moving sphere touches first. One operation per file, each a part of
//! [`Bvh`](crate::Bvh).

mod closest_point;
mod overlap;
mod solid;
mod sphere_cast;
mod visit;

pub use closest_point::ClosestPoint;
pub use overlap::{Ball, Frustum, Region};
pub use solid::Solid;
pub use sphere_cast::SphereHit;
