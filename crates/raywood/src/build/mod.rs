//! Builders: from primitives to the binary tree of [`Bvh2`](crate::Bvh2). One builder per file; `driver.rs` holds what
//! they share, the recursion and its parallel form.

pub(crate) mod driver;
mod options;
mod packed_aabb;
pub(crate) mod sah_binned;

pub use options::BuildOptions;
pub(crate) use packed_aabb::PackedAabb;
