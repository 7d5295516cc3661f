//! `parry3d`: its tree by each strategy.

use parry3d::partitioning::{Bvh, BvhBuildStrategy};
use parry3d::shape::TriMesh;
use raywood::TriangleMesh;

use super::super::parry3d::{ENTRY, leaves, tree_mode, tri_mesh};
use super::super::{Mode, Peer};
use super::{BuildEntry, Builder, Cost, Prepared, measured};
use crate::embree::Library;

/// The entry of a strategy.
const fn entry(
    preset: &'static str,
    prepare: for<'a> fn(&'a TriangleMesh, Option<&'a Library>) -> Prepared<'a>,
) -> BuildEntry {
    let settings = "Bvh::from_iter over the boxes of a TriMesh's triangles, on one thread; traced as TriMesh does; bytes and peak by the allocator";
    BuildEntry { peer: ENTRY.name, preset, settings, prepare }
}

pub(super) const BUILDS: &[BuildEntry] = &[
    entry("Binned", |mesh, _| prepare(mesh, BvhBuildStrategy::Binned)),
    entry("Ploc", |mesh, _| prepare(mesh, BvhBuildStrategy::Ploc)),
];

fn prepare(mesh: &TriangleMesh, strategy: BvhBuildStrategy) -> Prepared<'_> {
    Ok(Box::new(Strategy { mesh: tri_mesh(mesh)?, strategy }))
}

struct Strategy {
    mesh: TriMesh,
    strategy: BvhBuildStrategy,
}

impl Builder for Strategy {
    fn build(&mut self) -> Result<(Cost, Box<dyn Peer + '_>), String> {
        let (cost, tree) = measured(|| Bvh::from_iter(self.strategy, leaves(&self.mesh)));
        Ok((cost, Box::new(OverMesh { mesh: &self.mesh, tree })))
    }
}

struct OverMesh<'a> {
    mesh: &'a TriMesh,
    tree: Bvh,
}

impl Peer for OverMesh<'_> {
    fn modes(&self) -> Vec<Mode<'_>> {
        vec![tree_mode("bvh", self.mesh, &self.tree)]
    }
}
