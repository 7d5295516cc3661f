//! From where a scene is seen and by what it is lit when nobody says: its own camera and lights, else default ones.

use raywood_scene::{Camera, Light, default_camera, default_lights};

use crate::PreparedScene;

/// A camera and the lights that go with it.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// From where the scene is seen.
    pub camera: Camera,
    /// What lights it.
    pub lights: Vec<Light>,
}

/// The scene's first camera and its lights; what it lacks of either is chosen so that one sees what the scene holds.
///
/// `aspect` is the picture's width over its height.
pub fn default_view(prepared: &PreparedScene<'_>, aspect: f32) -> View {
    let scene = prepared.scene();
    let camera = match scene.cameras.first() {
        Some(camera) => camera.clone(),
        None => default_camera(&scene.bounds(), aspect),
    };
    let lights =
        if scene.lights.is_empty() { default_lights(&camera) } else { scene.lights.clone() };
    View { camera, lights }
}
