//! How structures are built: the option that every command that builds some shares.

use raywood::{BuildError, BuildPreset, Structure, StructureKind};
use raywood_render::PreparedScene;
use raywood_scene::Scene;

use crate::parse::build_preset;

/// The option of the build.
#[derive(clap::Args)]
pub(crate) struct BuildArgs {
    /// fastest, fast, balanced, high or best build
    ///
    /// From the fastest build to the tree that is fastest to trace; of the bounding volume hierarchies, other structures are the same by all. What comes out does not change.
    #[arg(long = "build", value_name = "PRESET", value_parser = build_preset, default_value = "balanced", hide_default_value = true)]
    pub(crate) preset: BuildPreset,
}

impl BuildArgs {
    /// A scene with its structure, on the threads of the current pool.
    pub(crate) fn prepare<'a>(
        &self,
        scene: &'a Scene,
        kind: StructureKind,
    ) -> Result<PreparedScene<'a>, BuildError> {
        let surfaces = PreparedScene::surfaces(scene);
        let structure = Structure::build(kind, surfaces, &self.preset.options())?;
        Ok(PreparedScene::from_structure(scene, structure))
    }
}
