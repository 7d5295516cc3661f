//! The kernels that are compared, one file per library. To add a library, write its file with a `pub(super) const ENTRY` and name it in
//! `PEERS`; to add a mode to one, add a line to its `modes`.

pub(crate) mod builds;
mod bvh;
mod each_ray;
mod embree;
mod moeller_trumbore;
mod obvhs;
mod parry3d;
pub(crate) mod queries;
mod raywood;

use ::raywood::TriangleMesh;

use crate::answers::Answers;
use crate::embree::Library;
use crate::ray_sets::RaySet;

/// All libraries, ours first.
pub(crate) const PEERS: &[PeerEntry] =
    &[raywood::ENTRY, embree::ENTRY, obvhs::ENTRY, parry3d::ENTRY, bvh::ENTRY];

/// The name of our own.
pub(crate) const RAYWOOD: &str = raywood::ENTRY.name;

/// The name of the one to beat.
pub(crate) const EMBREE: &str = embree::ENTRY.name;

/// A library.
#[derive(Clone, Copy)]
pub(crate) struct PeerEntry {
    /// Its name on the command line and in tables.
    pub(crate) name: &'static str,
    /// With which settings it is used.
    pub(crate) settings: &'static str,
    /// Builds its trees over a mesh, in the caller's rayon pool where it offers that; an error says why there are none.
    pub(crate) build: for<'a> fn(&'a TriangleMesh, Option<&'a Library>) -> Built<'a>,
}

/// The trees of a library over a mesh, or why there are none.
pub(crate) type Built<'a> = Result<Box<dyn Peer + 'a>, String>;

/// The trees of a library over a mesh.
pub(crate) trait Peer: Sync {
    /// The ways in which it traces rays.
    fn modes(&self) -> Vec<Mode<'_>>;
}

/// A way in which a library traces rays.
pub(crate) struct Mode<'a> {
    /// Its name in tables.
    pub(crate) name: &'static str,
    /// Whether the library promises that no ray slips between triangles that share an edge.
    pub(crate) watertight: bool,
    /// Makes it ready for a set of rays; `None` where it does not trace rays of that kind.
    pub(crate) prepare: Box<dyn Fn(&'a RaySet) -> Option<Box<dyn Tracer + 'a>> + 'a>,
}

impl<'a> Mode<'a> {
    fn new(
        name: &'static str,
        watertight: bool,
        prepare: impl Fn(&'a RaySet) -> Option<Box<dyn Tracer + 'a>> + 'a,
    ) -> Self {
        Self { name, watertight, prepare: Box::new(prepare) }
    }
}

/// A set of rays in a library's own format, with a place for each answer.
pub(crate) trait Tracer: Send {
    /// Packs the rays and clears the answers: what is not timed. Leaves both in the caches, as far as they fit.
    fn reset(&mut self);

    /// Traces all rays on the threads of the current rayon pool: what is timed.
    fn trace(&mut self);

    /// What came out.
    fn answers(&self) -> Answers;
}
