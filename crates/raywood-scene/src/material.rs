//! What a surface looks like, as far as Whitted's method can show it.

use raywood::Vec3;

use crate::{Clearcoat, MetallicRoughness, Pattern, Rgb, Sheen, SurfaceTextures};

/// The number of a material in its scene.
pub type MaterialId = u32;

/// How a surface answers light: a sum of diffuse, highlight, mirror and transmitted light.
///
/// Light that is mirrored is not available to what lies below: with the mirror's share `F` at the angle of view, diffuse and
/// transmitted light count `1 - F`.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Its name in the file, or empty.
    pub name: String,
    /// The share of light scattered in all directions alike.
    pub diffuse: Rgb,
    /// What modulates the diffuse colour over the surface.
    pub pattern: Pattern,
    /// Strength of the highlight that lights without extent leave on a shiny surface (Blinn 1977).
    pub specular: Rgb,
    /// The exponent of that highlight: 10 is dull, 1000 is polished.
    pub shininess: f32,
    /// The share of light mirrored when looking straight at the surface; towards grazing angles it rises to
    /// one (Schlick 1994). Zero in all channels means no mirror at all. Ignored where `transmission` is not zero:
    /// a dielectric's mirror follows from its `ior` (Fresnel).
    pub mirror: Rgb,
    /// The share of light let through, of what is not mirrored; tints like a filter. Zero means opaque.
    pub transmission: Rgb,
    /// Index of refraction on the inside (the side the normal points away from). Exactly 1 lets rays straight on and mirrors
    /// nothing: thin or cut-out surfaces.
    pub ior: f32,
    /// Light absorbed inside, per channel and unit of length (Beer and Lambert): `exp(-absorption * length)` is left.
    pub absorption: Vec3,
    /// Light that the surface sends out by itself, on both sides, as bright from everywhere. With Whitted's method the eye alone sees it; with a path tracer it lights other
    /// surfaces: white ones all around which it is 1 are 1.
    pub emission: Rgb,
    /// What it is made of, where a file says so in these terms: diffuse light, highlight, mirror and transmission follow from it, point by point
    /// where textures modulate it.
    pub metallic_roughness: Option<MetallicRoughness>,
    /// The clear coat over it, if there is one.
    pub clearcoat: Option<Clearcoat>,
    /// The sheen of fibres on it, if there are any. Shown by a path tracer alone, where no coat covers it.
    pub sheen: Option<Sheen>,
    /// By how much glass parts light into colours: 20 over its Abbe number (`KHR_materials_dispersion`), 0 for not at all. The index of refraction, which `ior` is for green light, is less for red and more for blue,
    /// by `(ior - 1) * dispersion / 40` each. Shown by a path tracer alone.
    pub dispersion: f32,
    /// What varies over the surface, if anything does.
    pub textures: Option<Box<SurfaceTextures>>,
}

impl Default for Material {
    /// A light grey, purely diffuse surface.
    fn default() -> Self {
        Self {
            name: String::new(),
            diffuse: Rgb::splat(0.7),
            pattern: Pattern::Plain,
            specular: Rgb::ZERO,
            shininess: 50.0,
            mirror: Rgb::ZERO,
            transmission: Rgb::ZERO,
            ior: 1.0,
            absorption: Vec3::ZERO,
            emission: Rgb::ZERO,
            metallic_roughness: None,
            clearcoat: None,
            sheen: None,
            dispersion: 0.0,
            textures: None,
        }
    }
}
