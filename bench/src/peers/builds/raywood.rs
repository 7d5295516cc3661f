//! Raywood: the wide tree by each preset.

use raywood::{BuildPreset, Structure, StructureKind, TriangleMesh};

use super::super::raywood::batch_mode;
use super::super::{Mode, Peer, RAYWOOD};
use super::{BuildEntry, Builder, Cost, Prepared, measured};
use crate::embree::Library;

/// The entry of a preset.
const fn entry(
    preset: &'static str,
    prepare: for<'a> fn(&'a TriangleMesh, Option<&'a Library>) -> Prepared<'a>,
) -> BuildEntry {
    let settings = "Structure::build of bvh-wide with the preset's options; traced by intersect_batch and occluded_batch, watertight; bytes by its statistics, \
        peak by the allocator";
    BuildEntry { peer: RAYWOOD, preset, settings, prepare }
}

pub(super) const BUILDS: &[BuildEntry] = &[
    entry("fastest", |mesh, _| prepare(mesh, BuildPreset::Fastest)),
    entry("fast", |mesh, _| prepare(mesh, BuildPreset::Fast)),
    entry("balanced", |mesh, _| prepare(mesh, BuildPreset::Balanced)),
    entry("high", |mesh, _| prepare(mesh, BuildPreset::High)),
    entry("best", |mesh, _| prepare(mesh, BuildPreset::Best)),
];

fn prepare(mesh: &TriangleMesh, preset: BuildPreset) -> Prepared<'_> {
    Ok(Box::new(Preset { mesh, preset }))
}

struct Preset<'a> {
    mesh: &'a TriangleMesh,
    preset: BuildPreset,
}

impl Builder for Preset<'_> {
    fn build(&mut self) -> Result<(Cost, Box<dyn Peer + '_>), String> {
        let options = self.preset.options();
        let build = || Structure::build(StructureKind::BvhWide, self.mesh, &options);
        let (mut cost, structure) = measured(build);
        let structure = structure.map_err(|error| error.to_string())?;
        let stats = structure.stats();
        cost.memory.bytes = stats.bytes;
        cost.q = Some(stats.q);
        Ok((cost, Box::new(Wide(structure))))
    }
}

struct Wide<'a>(Structure<&'a TriangleMesh>);

impl Peer for Wide<'_> {
    fn modes(&self) -> Vec<Mode<'_>> {
        vec![batch_mode("batch", &self.0)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_preset_is_there_under_its_own_name() {
        let names: Vec<_> = BuildPreset::ALL.iter().map(|preset| preset.name()).collect();
        assert_eq!(BUILDS.iter().map(|entry| entry.preset).collect::<Vec<_>>(), names);
    }
}
