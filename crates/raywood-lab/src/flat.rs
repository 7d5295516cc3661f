//! Scenes as experiments need them: with one structure over all surfaces.

use raywood_render::PreparedScene;

use crate::SceneStructure;

/// The structure over a scene's surfaces.
///
/// # Panics
///
/// If the scene has instances: experiments compare structures over the same triangles, so these must be [copied](raywood_scene::Scene::flatten) first.
pub(crate) fn structure_of<'s, 'a>(scene: &'s PreparedScene<'a>) -> &'s SceneStructure<'a> {
    scene.structure().expect("experiments need scenes without instances: see Scene::flatten")
}
