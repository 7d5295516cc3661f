//! Embree 4: single rays and packets of 8 and 16, with and without its COHERENT flag, in scenes with and without its ROBUST flag, both of
//! build quality HIGH.

use rayon::prelude::*;
use raywood::TriangleMesh;

use super::each_ray::PIECE;
use super::{Built, Mode, Peer, PeerEntry, Tracer};
use crate::answers::Answers;
use crate::embree::{Coherence, Library, Packet, Record, Robustness, Scene, Single};
use crate::ray_sets::RaySet;

pub(super) const ENTRY: PeerEntry = PeerEntry {
    name: "embree",
    settings: "build quality HIGH; flush-to-zero and denormals-are-zero while tracing; `1` single rays, `8` and `16` packets, `coherent` with RTC_RAY_QUERY_FLAG_COHERENT, `robust` with RTC_SCENE_FLAG_ROBUST",
    build,
};

fn build<'a>(mesh: &'a TriangleMesh, library: Option<&'a Library>) -> Built<'a> {
    let library = library.ok_or(ABSENT)?;
    Ok(Box::new(Embree {
        fast: Scene::build(library, mesh, Robustness::Default)?,
        robust: Scene::build(library, mesh, Robustness::Robust)?,
    }))
}

struct Embree<'a> {
    fast: Scene<'a>,
    robust: Scene<'a>,
}

impl Peer for Embree<'_> {
    fn modes(&self) -> Vec<Mode<'_>> {
        let (fast, robust) = (&self.fast, &self.robust);
        let (coherent, incoherent) = (Coherence::Coherent, Coherence::Incoherent);
        let mut modes = fast_modes(fast);
        modes.extend([
            mode::<Single>("1 robust", robust, incoherent),
            mode::<Packet<8>>("8 robust", robust, incoherent),
            mode::<Packet<8>>("8 coherent robust", robust, coherent),
            mode::<Packet<16>>("16 robust", robust, incoherent),
            mode::<Packet<16>>("16 coherent robust", robust, coherent),
        ]);
        modes
    }
}

/// The modes in a scene without the flag ROBUST.
pub(super) fn fast_modes<'a>(scene: &'a Scene<'a>) -> Vec<Mode<'a>> {
    vec![
        mode::<Single>("1", scene, Coherence::Incoherent),
        mode::<Packet<8>>("8", scene, Coherence::Incoherent),
        mode::<Packet<8>>("8 coherent", scene, Coherence::Coherent),
        mode::<Packet<16>>("16", scene, Coherence::Incoherent),
        mode::<Packet<16>>("16 coherent", scene, Coherence::Coherent),
    ]
}

/// What is said where there is none.
pub(super) const ABSENT: &str = "absent; `pip download --no-deps embreex`, unzip the wheel, and give its \
     embreex.libs/libembree4-*.so.4 as --embree LIB";

/// The mode that traces one kind of record in a scene.
fn mode<'a, R: Record + 'a>(
    name: &'static str,
    scene: &'a Scene<'a>,
    coherence: Coherence,
) -> Mode<'a> {
    let watertight = scene.robustness() == Robustness::Robust;
    Mode::new(name, watertight, move |set: &'a RaySet| {
        let records = (0..set.rays.len()).step_by(R::RAYS).map(|_| R::default()).collect();
        Some(Box::new(Records::<R> { scene, coherence, set, records }))
    })
}

/// A set of rays in Embree's format, which its answers overwrite.
struct Records<'a, R> {
    scene: &'a Scene<'a>,
    coherence: Coherence,
    set: &'a RaySet,
    records: Vec<R>,
}

impl<R: Record> Tracer for Records<'_, R> {
    fn reset(&mut self) {
        for (record, rays) in self.records.iter_mut().zip(self.set.rays.chunks(R::RAYS)) {
            record.pack(rays);
        }
    }

    fn trace(&mut self) {
        let any_hit = self.set.kind.any_hit();
        let pieces = self.records.par_chunks_mut(PIECE / R::RAYS);
        pieces.for_each(|records| R::trace(self.scene, records, any_hit, self.coherence));
    }

    fn answers(&self) -> Answers {
        // The last packet may hold fewer rays than it has lanes.
        let lanes = self.records.iter().flat_map(|record| (0..R::RAYS).map(|i| record.lane(i)));
        let lanes = lanes.take(self.set.rays.len());
        if self.set.kind.any_hit() {
            Answers::Any(lanes.map(|lane| lane.occluded).collect())
        } else {
            Answers::closest(lanes.map(|lane| lane.t))
        }
    }
}

const _: () = assert!(PIECE.is_multiple_of(16));
