//! Experiments with acceleration structures on scenes: [sets of rays](ray_sets) as renderings have them, [fair timing](timing), the
//! [comparison](compare) of structures on the same rays, the [lecture]'s claims as experiments, and the [tables and charts](figures) that come of them.

mod comparison;
pub mod figures;
pub mod lecture;
pub mod ray_sets;
mod rng;
pub mod timing;

pub use comparison::{Answer, CompareError, CompareOptions, Comparison, Mismatch};
pub use comparison::{RaySetSummary, SceneStructure, StructureReport, Traces, compare};
pub use ray_sets::{RayKind, RaySet};
pub use timing::Timing;
