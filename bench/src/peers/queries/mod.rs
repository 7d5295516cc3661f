//! What is compared by `raywood-bench query`: the libraries that answer questions of points, or count the hits of rays, one file per library. To add a library, write
//! its file with an `ENTRY` and name it in `QUERY_PEERS`.

mod one_by_one;
mod parry3d;
mod raywood;

use ::raywood::TriangleMesh;

use crate::query::answers::Answers;
use crate::query::sets::QuerySet;

/// The libraries, ours first.
pub(crate) const QUERY_PEERS: &[QueryEntry] = &[raywood::ENTRY, parry3d::ENTRY];

/// The name of the one to beat.
pub(crate) const PARRY: &str = parry3d::ENTRY.name;

/// A library.
#[derive(Clone, Copy)]
pub(crate) struct QueryEntry {
    /// Its name on the command line and in tables.
    pub(crate) name: &'static str,
    /// With which settings it is used.
    pub(crate) settings: &'static str,
    /// Builds its trees over a mesh; an error says why there are none.
    pub(crate) build: for<'a> fn(&'a TriangleMesh) -> Result<Box<dyn QueryPeer + 'a>, String>,
}

/// The trees of a library over a mesh.
pub(crate) trait QueryPeer: Sync {
    /// The ways in which it answers.
    fn modes(&self) -> Vec<QueryMode<'_>>;
}

/// A way in which a library answers.
pub(crate) struct QueryMode<'a> {
    /// Its name in tables.
    pub(crate) name: &'static str,
    /// Makes it ready for a set of questions.
    pub(crate) prepare: Box<dyn Fn(&'a QuerySet) -> Box<dyn Finder + 'a> + 'a>,
}

impl<'a> QueryMode<'a> {
    fn new(
        name: &'static str,
        prepare: impl Fn(&'a QuerySet) -> Box<dyn Finder + 'a> + 'a,
    ) -> Self {
        Self { name, prepare: Box::new(prepare) }
    }
}

/// A set of questions in a library's own format, with a place for each answer.
pub(crate) trait Finder: Send {
    /// Clears the answers: what is not timed. Leaves them and the questions in the caches, as far as they fit.
    fn reset(&mut self);

    /// Answers all questions on the threads of the current rayon pool: what is timed.
    fn find(&mut self);

    /// What came out.
    fn answers(&self) -> Answers;
}
