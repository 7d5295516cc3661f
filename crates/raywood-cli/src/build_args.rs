//! How structures are built: the options that every command that builds some shares.

use std::fmt;

use rayon::ThreadPool;
use raywood::StructureKind;
use raywood::{BuildError, BuildMemory, BuildOptions, BuildPreset, Bvh, Geometry, SavedTree};
use raywood_render::{PrepareError, PreparedScene, Surfaces};
use raywood_scene::Scene;

use crate::failure::Failure;
use crate::parse::{build_preset, memory_size};
use crate::progress_bar::during_build;

/// The options of the build.
#[derive(clap::Args)]
#[command(next_help_heading = "Acceleration structure")]
pub(crate) struct BuildArgs {
    /// fastest, fast, balanced, high or best build
    ///
    /// From the fastest build to the tree that is fastest to trace; of the bounding volume hierarchies, other structures are the same by all. What comes out is the same but for last digits, which show in single pixels. The default is balanced, but of a saved scene its own tree.
    #[arg(long = "build", value_name = "PRESET", value_parser = build_preset)]
    preset: Option<BuildPreset>,

    /// Most memory for a build, as 500M or 2G
    ///
    /// Bytes, or with K, M, G or T the next powers of 1024. A build that may take more, the model itself not counted, is refused before it begins.
    #[arg(long, value_name = "SIZE", value_parser = memory_size, hide_short_help = true)]
    memory_limit: Option<usize>,
}

impl BuildArgs {
    /// What they say.
    pub(crate) fn options(&self) -> BuildOptions {
        BuildOptions { memory_limit: self.memory_limit, ..self.preset().options() }
    }

    /// How structures are built.
    pub(crate) fn preset(&self) -> BuildPreset {
        self.preset.unwrap_or_default()
    }

    /// The tree that was saved, if it is what they ask for.
    pub(crate) fn wanted<'t>(
        &self,
        saved: Option<&'t SavedTree>,
        kind: StructureKind,
    ) -> Option<&'t SavedTree> {
        saved.filter(|_| self.preset.is_none() && kind == StructureKind::BvhWide)
    }

    /// A scene with its structure: the one saved with it if that is wanted, else built on the threads of a pool while a bar shows how far it is.
    pub(crate) fn prepare<'a>(
        &self,
        scene: &'a Scene,
        saved: Option<&SavedTree>,
        kind: StructureKind,
        pool: &ThreadPool,
    ) -> Result<PreparedScene<'a>, Failure> {
        if let Some(saved) = self.wanted(saved, kind) {
            let structure = saved.structure(PreparedScene::surfaces(scene));
            let structure = structure.map_err(Failure::bad_input)?;
            return Ok(PreparedScene::from_structure(scene, structure));
        }
        let options = self.options();
        let prepared = during_build(|watcher| {
            pool.install(|| PreparedScene::build_watched(scene, kind, &options, watcher))
        });
        prepared.map_err(|error| match error {
            PrepareError::Build(error) => self.failure(&error, kind, scene),
            error => Failure::bad_input(error),
        })
    }

    /// A tree for all kinds of queries, come by in the same way.
    pub(crate) fn tree<'a>(
        &self,
        scene: &'a Scene,
        saved: Option<&SavedTree>,
        pool: &ThreadPool,
    ) -> Result<Bvh<Surfaces<'a>>, Failure> {
        if let Some(saved) = self.wanted(saved, StructureKind::BvhWide) {
            return saved.bvh(PreparedScene::surfaces(scene)).map_err(Failure::bad_input);
        }
        let (surfaces, options) = (PreparedScene::surfaces(scene), self.options());
        let tree = during_build(|watcher| {
            pool.install(|| Bvh::build_watched(surfaces, &options, watcher))
        });
        tree.map_err(|error| self.failure(&error, StructureKind::BvhWide, scene))
    }

    /// Why a structure is not built, and what can be done about it.
    pub(crate) fn failure(
        &self,
        error: &BuildError,
        kind: StructureKind,
        scene: &Scene,
    ) -> Failure {
        let primitives = PreparedScene::surfaces(scene).len();
        let &BuildError::MemoryLimit { needed, limit } = error else {
            return Failure::bad_input(error);
        };
        let smaller = BuildPreset::ALL.iter().copied().find(|preset| {
            let memory = BuildMemory::of(kind, primitives, &preset.options());
            *preset < self.preset() && memory.peak <= limit
        });
        let advice = match smaller {
            Some(preset) => format!("a higher limit or --build {}", preset.name()),
            None => "a higher limit".to_owned(),
        };
        let (name, needed, limit) = (kind.name(), Size(needed).in_words(), Size(limit));
        Failure::bad_input(format!(
            "building {name} may take {needed} of memory, above --memory-limit {limit}; expected {advice}"
        ))
    }
}

/// A number of bytes as the command line has it, rounded up.
struct Size(usize);

impl Size {
    /// As it is said in a sentence.
    fn in_words(self) -> String {
        if self.0 < 10_000 { format!("{self} bytes") } else { self.to_string() }
    }
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (mut size, mut unit) = (self.0, "");
        for larger in ["K", "M", "G"] {
            if size < 10_000 {
                break;
            }
            (size, unit) = (size.div_ceil(1024), larger);
        }
        write!(f, "{size}{unit}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_in_few_digits() {
        let said = |bytes: usize| Size(bytes).to_string();
        assert_eq!(["0", "9999"], [said(0), said(9999)]);
        assert_eq!(["10K", "500M"], [said(10_000), said(500 << 20)].each_ref().map(String::as_str));
        assert_eq!([Size(9032), Size(10_240)].map(Size::in_words), ["9032 bytes", "10K"]);
        assert_eq!([said((16 << 30) + 1), said((9 << 30) + 1)], ["17G", "9217M"]);
    }
}
