//! Queries beyond the closest and any hit, of rays and of space, one operation per file; each a part of [`Bvh`](crate::Bvh).

mod all_hits;
mod closest_point;
mod filtered;
mod hit_lists;
mod nearest_hits;
mod options;
mod overlap;
mod solid;
mod sphere_cast;
mod visit;

pub(crate) use all_hits::by_distance;
pub use closest_point::ClosestPoint;
pub use hit_lists::HitLists;
pub(crate) use nearest_hits::NearestHits;
pub use options::{AcceptAll, Face, HitFilter, HitRules, QueryOptions};
pub use overlap::{Ball, Frustum, Region};
pub(crate) use overlap::{PreparedFrustum, Touch};
pub use solid::Solid;
pub(crate) use sphere_cast::First;
pub use sphere_cast::SphereHit;
