//! `obvhs`: its binary tree by each preset.

use std::time::Duration;

use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::triangle::Triangle;
use raywood::TriangleMesh;

use super::super::obvhs::{ENTRY, Ordered, triangles};
use super::super::{Mode, Peer};
use super::{BuildEntry, Builder, Cost, Prepared, measured};
use crate::embree::Library;

/// The entry of a preset.
const fn entry(
    preset: &'static str,
    prepare: for<'a> fn(&'a TriangleMesh, Option<&'a Library>) -> Prepared<'a>,
) -> BuildEntry {
    let settings = "build_bvh2_from_tris, and RtTriangle in the order of the leaves as its examples have it, from triangles in its own format; traced as bvh2; bytes \
        and peak by the allocator";
    BuildEntry { peer: ENTRY.name, preset, settings, prepare }
}

pub(super) const BUILDS: &[BuildEntry] = &[
    entry("fastest_build", |mesh, _| prepare(mesh, BvhBuildParams::fastest_build())),
    entry("very_fast_build", |mesh, _| prepare(mesh, BvhBuildParams::very_fast_build())),
    entry("fast_build", |mesh, _| prepare(mesh, BvhBuildParams::fast_build())),
    entry("medium_build", |mesh, _| prepare(mesh, BvhBuildParams::medium_build())),
    entry("slow_build", |mesh, _| prepare(mesh, BvhBuildParams::slow_build())),
    entry("very_slow_build", |mesh, _| prepare(mesh, BvhBuildParams::very_slow_build())),
];

fn prepare(mesh: &TriangleMesh, params: BvhBuildParams) -> Prepared<'_> {
    Ok(Box::new(Preset { triangles: triangles(mesh), params }))
}

struct Preset {
    triangles: Vec<Triangle>,
    params: BvhBuildParams,
}

impl Builder for Preset {
    fn build(&mut self) -> Result<(Cost, Box<dyn Peer + '_>), String> {
        let (cost, tree) = measured(|| {
            let tree = build_bvh2_from_tris(&self.triangles, self.params, &mut Duration::default());
            Ordered::new(tree, &self.triangles)
        });
        Ok((cost, Box::new(Binary(tree))))
    }
}

struct Binary(Ordered<Bvh2>);

impl Peer for Binary {
    fn modes(&self) -> Vec<Mode<'_>> {
        vec![self.0.mode("bvh2")]
    }
}
