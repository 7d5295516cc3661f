//! What lies over a surface: a clear coat, or the sheen of fibres.

use crate::Rgb;

/// A clear coat, such as lacquer, over all else that a surface is: a second, colourless mirror of index of refraction 1.5 (`KHR_materials_clearcoat`).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Clearcoat {
    /// The share of the surface that is coated, from 0 to 1.
    pub strength: f32,
    /// 0 for a smooth coat, 1 for one that is all rough.
    pub roughness: f32,
}

/// The sheen of fibres that stand off a surface, as those of velvet: light at grazing angles (`KHR_materials_sheen`).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sheen {
    /// How strong it is and in which colour, each channel from 0 to 1.
    pub color: Rgb,
    /// From fibres that stand straight up, 0, to those that stand anyhow, 1.
    pub roughness: f32,
}
