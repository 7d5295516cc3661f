//! The scenes of the benchmark: which models, seen from where, lit from where.

use std::path::{Path, PathBuf};

use raywood::{TriangleMesh, Vec3};
use raywood_scene::{LoadOptions, Scene, builtin, load_file};

use crate::cut::cut;
use crate::pinhole::Pinhole;
use crate::ray_sets::Viewpoint;

/// A scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SceneEntry {
    /// Its name on the command line and in tables.
    pub(crate) name: &'static str,
    /// Where its triangles come from.
    pub(crate) source: Source,
    /// By how much they are scaled.
    scale: f32,
    /// How often each is cut in four.
    cuts: u32,
    eye: [f32; 3],
    target: [f32; 3],
    /// The tangent of half the vertical angle of view.
    tan: f32,
    light: [f32; 3],
    /// What counts as the diagonal where a sea or a lawn reaches to the horizon, else that of the box around all triangles. Offsets and lengths
    /// of rays follow from it: by the hall's sea they would start 11 cm off the wall.
    diagonal: Option<f32>,
}

/// Where triangles come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Source {
    /// A scene made by code.
    Builtin(&'static str),
    /// A file of this name in the folder of models.
    File(&'static str),
}

/// All scenes. To add one, add it here.
pub(crate) const SCENES: &[SceneEntry] = &[
    // In the gallery of the atrium, with the light under the open roof.
    SceneEntry {
        name: "sponza",
        source: Source::File("sponza-dabrovic.obj"),
        scale: 1.0,
        cuts: 0,
        eye: [-9.5, 4.5, -0.5],
        target: [0.0, 4.4, 0.1],
        tan: 0.6,
        light: [0.5, 12.5, 0.3],
        diagonal: None,
    },
    // The whole scan before nothing, from the front.
    SceneEntry {
        name: "dragon",
        source: Source::File("dragon.ply"),
        scale: 100.0,
        cuts: 0,
        eye: [2.5, 16.0, 33.0],
        target: [-0.5, 12.0, 0.0],
        tan: 0.16,
        light: [20.0, 40.0, 30.0],
        diagonal: None,
    },
    // Down the nave, as the scene's own camera sees it; the light hangs from the vault. Its few spheres are left out.
    SceneEntry {
        name: "hall",
        source: Source::Builtin("hall"),
        scale: 1.0,
        cuts: 0,
        eye: [-0.35, 1.55, 6.6],
        target: [0.12, 2.45, -6.0],
        tan: 0.4877,
        light: [0.5, 7.5, -3.0],
        diagonal: Some(45.0),
    },
    // The island from a hill, much as the scene's own camera sees it; the light is a sun that is not too far away.
    SceneEntry {
        name: "terrain",
        source: Source::Builtin("terrain?n=1600"),
        scale: 1.0,
        cuts: 0,
        eye: [-1800.0, 900.0, 8200.0],
        target: [0.0, 560.0, 0.0],
        tan: 0.2773,
        light: [20_000.0, 15_000.0, 9_000.0],
        diagonal: Some(20_000.0),
    },
    // The room from its corner, over the worktop, with the light under the ceiling.
    SceneEntry {
        name: "kitchen",
        source: Source::File("country-kitchen.glb"),
        scale: 1.0,
        cuts: 0,
        eye: [1.21, 1.8, 3.85],
        target: [-0.26, 1.21, -0.05],
        tan: 0.4663,
        light: [0.0, 2.2, 1.0],
        diagonal: None,
    },
    // The same view as of Sponza, of the same walls in 64 times as many triangles.
    SceneEntry {
        name: "sponza-cut",
        source: Source::File("sponza-dabrovic.obj"),
        scale: 1.0,
        cuts: 3,
        eye: [-9.5, 4.5, -0.5],
        target: [0.0, 4.4, 0.1],
        tan: 0.6,
        light: [0.5, 12.5, 0.3],
        diagonal: None,
    },
];

/// Triangles and a view of them.
pub(crate) struct BenchScene {
    /// What tables call it.
    pub(crate) name: String,
    /// Where the triangles come from.
    pub(crate) source: String,
    /// The triangles.
    pub(crate) mesh: TriangleMesh,
    /// The view.
    pub(crate) view: View,
}

/// From where a scene is seen and lit, as it is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct View {
    pub(crate) eye: Vec3,
    pub(crate) target: Vec3,
    pub(crate) tan: f32,
    pub(crate) light: Vec3,
    /// What counts as the scene's diagonal, if not that of its box.
    pub(crate) diagonal: Option<f32>,
}

impl View {
    /// The same, ready to make rays in a mesh.
    ///
    /// # Errors
    ///
    /// There is no such camera.
    pub(crate) fn viewpoint(&self, mesh: &TriangleMesh) -> Result<Viewpoint, String> {
        let camera = Pinhole::new(self.eye, self.target, self.tan)?;
        let diagonal = self.diagonal.unwrap_or_else(|| mesh.total_bounds().diagonal());
        Ok(Viewpoint { camera, light: self.light, diagonal })
    }
}

impl SceneEntry {
    /// Finds and loads it; `folder` is where the models are, searched to any depth.
    ///
    /// # Errors
    ///
    /// The model is not there, or cannot be loaded.
    pub(crate) fn load(&self, folder: Option<&Path>) -> Result<BenchScene, String> {
        let (scene, source) = match self.source {
            Source::Builtin(name) => {
                (builtin(name).map_err(|error| error.to_string())?, format!("builtin:{name}"))
            }
            Source::File(name) => {
                let folder = folder.ok_or(
                    "no folder of models: give --scene-files FOLDER or set RAYWOOD_TEST_SCENES",
                )?;
                let path = find(folder, name)
                    .ok_or_else(|| format!("there is no {name} below {}", folder.display()))?;
                (load(&path)?, name.to_owned())
            }
        };
        let [eye, target, light] = [self.eye, self.target, self.light].map(Vec3::from);
        Ok(BenchScene {
            name: self.name.to_owned(),
            source,
            mesh: cut(scaled(scene.mesh.triangles, self.scale)?, self.cuts)?,
            view: View { eye, target, tan: self.tan, light, diagonal: self.diagonal },
        })
    }
}

/// Any model, from a file.
///
/// # Errors
///
/// It cannot be loaded, or has no triangles.
pub(crate) fn load_model(path: &Path, view: View) -> Result<BenchScene, String> {
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let source = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mesh = scaled(load(path)?.mesh.triangles, 1.0)?;
    Ok(BenchScene { name, source, mesh, view })
}

fn load(path: &Path) -> Result<Scene, String> {
    load_file(path, &LoadOptions::default()).map_err(|error| error.to_string())
}

/// The mesh with its vertices multiplied. Peers differ in what they make of meshes without triangles; here there is nothing to time.
fn scaled(mesh: TriangleMesh, scale: f32) -> Result<TriangleMesh, String> {
    if mesh.triangles().is_empty() {
        return Err("there are no triangles".to_owned());
    }
    let positions = mesh.positions().iter().map(|&p| scale * p).collect::<Vec<_>>();
    TriangleMesh::new(positions, mesh.triangles().to_vec()).map_err(|error| error.to_string())
}

/// The file of this name in a folder or below it; the first in alphabetic order of the paths.
fn find(folder: &Path, name: &str) -> Option<PathBuf> {
    let mut entries: Vec<_> =
        std::fs::read_dir(folder).ok()?.filter_map(|entry| Some(entry.ok()?.path())).collect();
    entries.sort_unstable();
    let here = entries.iter().find(|path| path.is_file() && path.ends_with(name)).cloned();
    // Links to folders are not followed: they may lead in circles.
    let folders = entries.iter().filter(|path| path.is_dir() && !path.is_symlink());
    here.or_else(|| folders.into_iter().find_map(|folder| find(folder, name)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_has_a_view_and_a_name_of_its_own() {
        for (number, scene) in SCENES.iter().enumerate() {
            assert!(!SCENES[..number].iter().any(|other| other.name == scene.name));
            let [eye, target, light] = [scene.eye, scene.target, scene.light].map(Vec3::from);
            let view = View { eye, target, tan: scene.tan, light, diagonal: scene.diagonal };
            let viewpoint = view.viewpoint(&TriangleMesh::default()).expect(scene.name);
            assert_eq!(viewpoint.diagonal, scene.diagonal.unwrap_or(0.0), "{}", scene.name);
        }
    }

    #[test]
    fn missing_models_are_said_to_be_missing() {
        let sponza = &SCENES[0];
        let said = sponza.load(None).err().expect("no folder");
        assert!(said.contains("--scene-files"), "{said}");
        let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
        let said = sponza.load(Some(&sources)).err().expect("no model");
        assert!(said.starts_with("there is no sponza-dabrovic.obj below "), "{said}");
    }

    #[test]
    fn files_are_found_at_any_depth() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
        assert_eq!(find(folder, "ffi.rs"), Some(folder.join("src/embree/ffi.rs")));
        assert_eq!(find(folder, "fi.rs"), None);
    }
}
