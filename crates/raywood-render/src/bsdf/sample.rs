//! A direction that was chosen at random.

use raywood::Vec3;
use raywood_scene::Rgb;

/// Where light comes from that a surface scatters towards `wo`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scattered {
    /// The direction, unit length; with negative z it comes from the other side.
    pub(crate) wi: Vec3,
    /// What light from there counts: the surface's answer times the cosine, divided by the density.
    pub(crate) weight: Rgb,
    /// How likely the direction was.
    pub(crate) density: Density,
}

/// How likely a direction was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Density {
    /// By solid angle.
    Angle(f32),
    /// There was no other: a perfect mirror, or what is bent at a smooth surface.
    Mirror,
}
