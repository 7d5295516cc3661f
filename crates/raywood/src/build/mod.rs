//! Builders: from primitives to the binary tree of [`Bvh2`](crate::Bvh2). One builder per file; `driver.rs` holds what
//! they share, the recursion and its parallel form. `reinsertion/` improves a finished tree, whoever built it.

mod builder;
mod curve;
pub(crate) mod driver;
mod encode;
mod hlbvh;
mod lbvh;
mod median;
mod memory;
mod midpoint;
mod morton;
mod options;
mod packed_aabb;
mod ploc;
mod preset;
mod primitive;
mod quicksort;
mod radix_sort;
mod reinsertion;
mod sah_binned;
mod sah_small;
mod sah_sweep;
mod spatial;
mod stretch;
mod work;

pub use builder::Builder;
pub(crate) use curve::{Precision, SortedKeys, sorted_keys};
pub use memory::BuildMemory;
pub(crate) use morton::KeyBits;
pub use options::{BuildOptions, TriangleTest};
pub(crate) use packed_aabb::PackedAabb;
pub use preset::BuildPreset;
pub(crate) use primitive::Primitive;
pub(crate) use spatial::margin as part_margin;
pub(crate) use stretch::Stretch;
pub(crate) use work::{Cancelled, Work, watched};
