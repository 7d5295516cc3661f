//! From where a scene is seen and by what it is lit when nobody says: its own camera and lights, else default ones.
//!
//! The bounding box alone cannot tell a statue from a room, of which it would show the outer walls. So a few hundred rays
//! are traced first, always the same ones: see [`Setting`].

mod inside;
mod outside;
mod probes;
mod setting;

use raywood::Aabb;
use raywood_scene::{Camera, Light, default_lights, frame_bounds};

use crate::PreparedScene;
pub use setting::Setting;

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
/// `aspect` is the picture's width over its height. The same scene always gets the same view.
pub fn default_view(prepared: &PreparedScene<'_>, aspect: f32) -> View {
    let scene = prepared.scene();
    let camera = match scene.cameras.first() {
        Some(camera) => camera.clone(),
        None => choose_camera(prepared, aspect),
    };
    let lights = if scene.lights.is_empty() {
        choose_lights(prepared, &camera)
    } else {
        scene.lights.clone()
    };
    View { camera, lights }
}

/// A camera for the scene, whether it has cameras of its own or not.
pub fn choose_camera(prepared: &PreparedScene<'_>, aspect: f32) -> Camera {
    let bounds = prepared.bounds();
    match Setting::of(prepared) {
        Setting::Outside => outside::camera(prepared, &bounds, aspect),
        Setting::Opening { towards } => frame_bounds(&bounds, towards, prepared.axes().up, aspect),
        Setting::Inside => inside::camera(prepared, &bounds, aspect),
    }
}

/// Lights for the scene as the camera sees it, whether it has lights of its own or not.
pub fn choose_lights(prepared: &PreparedScene<'_>, camera: &Camera) -> Vec<Light> {
    let bounds = prepared.bounds();
    match Setting::of(prepared) {
        Setting::Opening { .. } => inside::lights(prepared, &bounds, camera),
        Setting::Inside if bounds.contains(&Aabb::new(camera.eye, camera.eye)) => {
            inside::lights(prepared, &bounds, camera)
        }
        _ => default_lights(camera),
    }
}
