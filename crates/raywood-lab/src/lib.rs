//! Experiments with acceleration structures on scenes: [sets of rays](ray_sets) as renderings have them, [fair timing](timing), the
//! [comparison](compare) of structures on the same rays, the [benchmark] of one structure on all instructions and cores of the machine, the
//! [lecture]'s claims as experiments, and the [tables and charts](figures) that come of them.

mod answers;
mod benchmark;
mod comparison;
pub mod figures;
mod flat;
pub mod frame_budget;
pub mod lecture;
pub mod ray_sets;
mod rng;
pub mod timing;
mod tracing;

pub use answers::{Answer, Mismatch};
pub use benchmark::{Benchmark, BenchmarkError, BenchmarkOptions, benchmark};
pub use benchmark::{Clock, Pictures, RaySpeed, Speed};
pub use comparison::{CompareError, CompareOptions, Comparison};
pub use comparison::{SceneStructure, StructureReport, Traces, compare};
pub use ray_sets::{RayKind, RaySet, RaySetSummary};
pub use timing::Timing;
