//! Which scenes, shared by the commands that measure.

use std::path::PathBuf;

use raywood::Vec3;

use super::names;
use crate::failure::Failure;
use crate::scenes::{BenchScene, SCENES, SceneEntry, View, load_model};

/// The options that choose scenes.
#[derive(clap::Args)]
pub(crate) struct SceneArgs {
    /// Which scenes, separated by commas [default: those that are found, for build and query of
    /// sponza, dragon and hall]
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = names::scene)]
    scenes: Vec<SceneEntry>,

    /// The folder with the models, searched to any depth [default: $RAYWOOD_TEST_SCENES]
    #[arg(long, value_name = "FOLDER")]
    scene_files: Option<PathBuf>,

    /// Any model instead, in any format that Raywood reads
    #[arg(long, value_name = "FILE", conflicts_with_all = ["scenes", "scene_files"])]
    #[arg(requires_all = ["eye", "target", "tan", "light"])]
    triangles: Option<PathBuf>,

    /// Where the model is seen from
    #[arg(long, value_name = "X,Y,Z", value_parser = names::point, allow_hyphen_values = true)]
    #[arg(requires = "triangles")]
    eye: Option<Vec3>,

    /// What is in the middle of the picture
    #[arg(long, value_name = "X,Y,Z", value_parser = names::point, allow_hyphen_values = true)]
    #[arg(requires = "triangles")]
    target: Option<Vec3>,

    /// The tangent of half the vertical angle of view
    #[arg(long, value_name = "K", value_parser = names::above_zero, requires = "triangles")]
    tan: Option<f32>,

    /// Where the light is
    #[arg(long, value_name = "X,Y,Z", value_parser = names::point, allow_hyphen_values = true)]
    #[arg(requires = "triangles")]
    light: Option<Vec3>,
}

impl SceneArgs {
    /// What loads each scene, when its turn comes: they need not all be in memory. `default` are those that are taken where none is named. A scene
    /// whose model is not there is `None`, after a word on standard error.
    pub(crate) fn loaders(&self, default: &[SceneEntry]) -> Vec<Loader> {
        if let (Some(path), Some(eye), Some(target), Some(tan), Some(light)) =
            (self.triangles.clone(), self.eye, self.target, self.tan, self.light)
        {
            let view = View { eye, target, tan, light, diagonal: None };
            return vec![Box::new(move || {
                load_model(&path, view).map(Some).map_err(Failure::BadInput)
            })];
        }
        let from_environment = || std::env::var_os("RAYWOOD_TEST_SCENES").map(PathBuf::from);
        let folder = self.scene_files.clone().or_else(from_environment);
        let entries = if self.scenes.is_empty() { default } else { &self.scenes };
        let loader = |&entry: &SceneEntry| {
            let folder = folder.clone();
            Box::new(move || match entry.load(folder.as_deref()) {
                Ok(scene) => Ok(Some(scene)),
                Err(why) => {
                    eprintln!("raywood-bench: {}: {why}; skipped", entry.name);
                    Ok(None)
                }
            }) as Loader
        };
        entries.iter().map(loader).collect()
    }
}

/// The scenes that commands take where none is named whose runs over all of them would be long.
pub(super) fn few_scenes() -> Vec<SceneEntry> {
    let few = |scene: &&SceneEntry| ["sponza", "dragon", "hall"].contains(&scene.name);
    SCENES.iter().filter(few).copied().collect()
}

/// Loads a scene.
pub(crate) type Loader = Box<dyn Fn() -> Result<Option<BenchScene>, Failure>>;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_scenes_are_those_that_the_help_names() {
        let names: Vec<_> = few_scenes().iter().map(|scene| scene.name).collect();
        assert_eq!(names, ["sponza", "dragon", "hall"]);
    }
}
