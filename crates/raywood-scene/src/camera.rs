//! Where a scene is seen from.

use raywood::Vec3;

/// A pinhole camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Its name in the file, or empty.
    pub name: String,
    /// Where the eye is.
    pub eye: Vec3,
    /// The point in the middle of the picture.
    pub target: Vec3,
    /// The direction that is up in the picture; not along the line of sight.
    pub up: Vec3,
    /// The angle from the picture's bottom to its top, in degrees; above 0, below 180.
    pub fov_y: f32,
}
