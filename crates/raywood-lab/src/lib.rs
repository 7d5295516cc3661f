//! Experiments with acceleration structures on scenes: [sets of rays](ray_sets) as renderings have them, [fair timing](timing), and the
//! [comparison](compare) of structures on the same rays.

pub mod ray_sets;
mod rng;
pub mod timing;

pub use ray_sets::{RayKind, RaySet};
pub use timing::Timing;
