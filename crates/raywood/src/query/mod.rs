//! Questions about space: what is near, what overlaps, what a moving sphere touches first. One operation per file, each a part of
//! [`Bvh`](crate::Bvh).

mod closest_point;
mod solid;
mod visit;

pub use closest_point::ClosestPoint;
pub use solid::Solid;
