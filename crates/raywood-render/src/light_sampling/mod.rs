//! Light that has extent, as a path tracer asks for it: a direction that light comes from, chosen at random and mostly where much does, and how likely
//! it was.

mod alias_table;
mod area_lights;
mod cone;
mod environment;

use raywood::Vec3;
use raywood_scene::Rgb;

pub(crate) use alias_table::AliasTable;
pub(crate) use area_lights::{AreaLights, Lit};
pub(crate) use cone::Cone;
pub(crate) use environment::{EnvironmentLight, SpherePart, to_angles};

/// A point that light comes from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightSample {
    /// Towards the light, unit length.
    pub(crate) direction: Vec3,
    /// The point on the light.
    pub(crate) target: Vec3,
    /// How bright the light is there: radiance, in units in which a white diffuse surface in a surrounding of 1 is 1.
    pub(crate) radiance: Rgb,
    /// How likely the direction was, by solid angle; above zero.
    pub(crate) density: f32,
}
