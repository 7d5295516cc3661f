//! What lights a scene.

use raywood::Vec3;

use crate::Rgb;

/// A light without extent, as Whitted's method uses them.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Its name in the file, or empty.
    pub name: String,
    /// What kind it is, and where.
    pub kind: LightKind,
    /// Colour times strength. For a directional light what a white diffuse surface facing it sends out (irradiance / pi);
    /// for point and spot lights the same at distance 1, falling with the square of the distance.
    pub intensity: Rgb,
}

/// The kinds of light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// Shines from a point in all directions.
    Point {
        /// Where it is.
        position: Vec3,
    },
    /// Shines from a point into a cone.
    Spot {
        /// Where it is.
        position: Vec3,
        /// The cone's axis, unit length, away from the light.
        direction: Vec3,
        /// Cosine of the angle within which it shines at full strength.
        cos_inner: f32,
        /// Cosine of the angle outside of which it is dark; less than `cos_inner`.
        cos_outer: f32,
    },
    /// Shines from infinitely far away.
    Directional {
        /// Where the light goes, unit length.
        direction: Vec3,
        /// Half the angle that it takes up in the sky, in radians: how soft its shadows are, with a path tracer. 0 makes them sharp; the sun has 0.00465.
        angular_radius: f32,
    },
    /// Reaches every surface from all sides alike, without shadow. A path tracer has the surroundings and other surfaces in its place.
    Ambient,
}

impl LightKind {
    /// Shines in a direction of unit length, with sharp shadows.
    pub const fn directional(direction: Vec3) -> Self {
        Self::Directional { direction, angular_radius: 0.0 }
    }
}
