//! What is compared by `raywood-bench build`: every way of each library to build its tree, one file per library. To add a library, write
//! its file with a `BUILDS` and name it here.
//!
//! The clock runs from triangles as a library takes them to a tree that can be traced: boxes of triangles, which every builder begins with,
//! are computed while it runs, also where a library wants them from its caller.

mod bvh;
mod embree;
mod obvhs;
mod parry3d;
mod raywood;

use ::raywood::TriangleMesh;
use raywood_lab::timing::seconds;

use super::Peer;
use crate::embree::Library;
use crate::memory::{Memory, watch};

/// The ways of all libraries, ours first.
pub(crate) fn builds() -> impl Iterator<Item = &'static BuildEntry> {
    [raywood::BUILDS, embree::BUILDS, obvhs::BUILDS, parry3d::BUILDS, bvh::BUILDS]
        .into_iter()
        .flatten()
}

/// Our preset and Embree's build quality that are for the same purpose.
pub(crate) const PAIRS: &[(&str, &str)] =
    &[("fastest", "LOW"), ("balanced", "MEDIUM"), ("high", "HIGH")];

/// A way to build.
pub(crate) struct BuildEntry {
    /// The library's name.
    pub(crate) peer: &'static str,
    /// The library's name for this way.
    pub(crate) preset: &'static str,
    /// How it is used, and where its bytes are known from.
    pub(crate) settings: &'static str,
    /// Converts a mesh to what the library takes, or says why it cannot.
    pub(crate) prepare: for<'a> fn(&'a TriangleMesh, Option<&'a Library>) -> Prepared<'a>,
}

/// What is ready to build, or why there is nothing.
pub(crate) type Prepared<'a> = Result<Box<dyn Builder + 'a>, String>;

/// A mesh in a library's format, to be built over any number of times.
pub(crate) trait Builder: Send {
    /// Builds a tree in the current rayon pool, and says what that took.
    ///
    /// # Errors
    ///
    /// Why there is none.
    fn build(&mut self) -> Result<(Cost, Box<dyn Peer + '_>), String>;
}

/// What a build took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Cost {
    /// Seconds by the clock.
    pub(crate) seconds: f64,
    /// The memory of the tree, and the most that was needed while it was built.
    pub(crate) memory: Memory,
    /// The expected cost of a ray, for ours.
    pub(crate) q: Option<f64>,
}

/// What `build` took of time and of Rust's memory, and its result.
fn measured<T>(build: impl FnOnce() -> T) -> (Cost, T) {
    let (memory, (seconds, tree)) = watch(|| seconds(build));
    (Cost { seconds, memory, q: None }, tree)
}
