//! Depth of field: a thin lens in place of the pinhole (Cook, Porter and Carpenter, "Distributed Ray Tracing", 1984).

use raywood::Vec3;
use raywood_scene::Camera;

use crate::PreparedScene;
use crate::bsdf::frame::disk;
use crate::camera_rays::{CameraError, CameraRays};

/// A thin lens, round and without flaws. What lies in the plane of focus is sharp; what is elsewhere is a disk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Half of the aperture's width, in units of the scene; 0 is a pinhole.
    pub radius: f32,
    /// How far the plane of focus is from the eye, along the line of sight; above 0.
    pub focus: f32,
}

impl Lens {
    /// A lens that is as wide as one of an f-number: of a camera of this field of view from bottom to top, in degrees, in front of a picture 24 mm high as that
    /// of a 35 mm film, in a scene whose unit is the metre.
    pub fn of_f_number(f_number: f32, fov_y: f32, focus: f32) -> Self {
        const HALF_HEIGHT: f32 = 0.012;
        let focal_length = HALF_HEIGHT / (0.5 * fov_y.to_radians()).tan();
        Self { radius: 0.5 * focal_length / f_number, focus }
    }

    /// Whether light passes, and the plane of focus is in front of the eye.
    pub(crate) fn is_sound(&self) -> bool {
        let Self { radius, focus } = *self;
        radius >= 0.0 && radius.is_finite() && focus > 0.0 && focus.is_finite()
    }

    /// Where on the lens a ray passes that is drawn by two numbers from 0 to 1: as far to the right and up, from the eye.
    pub(crate) fn point(&self, u: [f32; 2], [right, up]: [Vec3; 2]) -> Vec3 {
        let [x, y] = disk(u);
        self.radius * (x * right + y * up)
    }
}

/// How far in front of the eye, along the line of sight, that is which is seen at a point of a picture of this size, in pixels from the upper left corner; `None` where
/// nothing is seen. Of what moves, as it is at time 0.
///
/// # Errors
///
/// Nothing can be seen through the camera.
pub fn depth_at(
    scene: &PreparedScene<'_>,
    camera: &Camera,
    (width, height): (u32, u32),
    [x, y]: [f32; 2],
) -> Result<Option<f32>, CameraError> {
    let rays = CameraRays::new(camera, width, height)?;
    let ray = rays.ray(x, y);
    let hit = scene.tracer().intersect(&ray);
    Ok(hit.map(|hit| hit.t * rays.depth_along(ray.direction)))
}
