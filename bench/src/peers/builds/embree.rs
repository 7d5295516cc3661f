//! Embree: each build quality.

use raywood::TriangleMesh;
use raywood_lab::timing::seconds;

use super::super::embree::{ABSENT, fast_modes};
use super::super::{EMBREE, Mode, Peer};
use super::{BuildEntry, Builder, Cost, Prepared};
use crate::embree::{Library, Quality, Scene, SharedMesh};

/// The entry of a quality.
const fn entry(
    preset: &'static str,
    prepare: for<'a> fn(&'a TriangleMesh, Option<&'a Library>) -> Prepared<'a>,
) -> BuildEntry {
    let settings = "build quality of scene and geometry, without flags, buffers shared, a device of as many threads; the time of rtcCommitScene; traced by the \
        best of single rays and packets of 16 with and without COHERENT; bytes and peak by its memory monitor";
    BuildEntry { peer: EMBREE, preset, settings, prepare }
}

pub(super) const BUILDS: &[BuildEntry] = &[
    entry("LOW", |mesh, library| prepare(mesh, library, Quality::Low)),
    entry("MEDIUM", |mesh, library| prepare(mesh, library, Quality::Medium)),
    entry("HIGH", |mesh, library| prepare(mesh, library, Quality::High)),
];

fn prepare<'a>(
    mesh: &'a TriangleMesh,
    library: Option<&'a Library>,
    quality: Quality,
) -> Prepared<'a> {
    let library = library.ok_or(ABSENT)?;
    Ok(Box::new(Commit { library, mesh: SharedMesh::new(mesh), quality }))
}

struct Commit<'a> {
    library: &'a Library,
    mesh: SharedMesh,
    quality: Quality,
}

impl Builder for Commit<'_> {
    fn build(&mut self) -> Result<(Cost, Box<dyn Peer + '_>), String> {
        let Self { library, ref mesh, quality } = *self;
        let (memory, built) = library.watch(|| {
            let scene = Scene::prepare(library, mesh, quality)?;
            let (seconds, committed) = seconds(|| scene.commit());
            committed.map(|()| (seconds, scene))
        });
        let (seconds, scene) = built?;
        Ok((Cost { seconds, memory, q: None }, Box::new(Committed(scene))))
    }
}

struct Committed<'a>(Scene<'a>);

impl Peer for Committed<'_> {
    fn modes(&self) -> Vec<Mode<'_>> {
        fast_modes(&self.0)
    }
}
