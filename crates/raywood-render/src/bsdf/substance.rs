//! What a surface is made of at a point, in the terms of a path tracer: read from what files and built-in scenes say in those of Whitted's method.

use raywood_scene::{MetallicRoughness, Rgb};

use super::layer::{Coat, Sheen};
use super::opaque::OpaqueSurface;
use crate::surface_material::SurfaceMaterial;

/// What a surface is made of at a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Substance {
    /// What lets no light through.
    pub(crate) opaque: OpaqueSurface,
    /// The share that is glass instead.
    pub(crate) glass_share: f32,
    /// What that lets through of what it does not mirror, its index of refraction, and the alpha of its facets.
    pub(crate) tint: Rgb,
    pub(crate) ior: f32,
    pub(crate) glass_alpha: f32,
}

/// Light that goes straight on, as if nothing were there: through holes, and through what does not bend it. In all channels the share of light.
#[inline]
pub(crate) fn straight_share(material: &SurfaceMaterial) -> Rgb {
    let thin = material.transmissive && material.ior == 1.0;
    let through = if thin { material.transmission } else { Rgb::ZERO };
    Rgb::splat(1.0 - material.opacity) + material.opacity * through
}

impl Substance {
    /// What is there of the material but what [goes straight on](straight_share). `diffuse` is the diffuse colour at the point, `made_of` the description by metal
    /// and roughness if there is one.
    pub(crate) fn of(
        material: &SurfaceMaterial,
        diffuse: Rgb,
        made_of: Option<MetallicRoughness>,
    ) -> Self {
        let mut substance = match made_of {
            Some(made_of) => Self::of_metallic_roughness(material, made_of),
            None => Self::of_shares(material, diffuse),
        };
        let (coat, sheen) = (material.coat, material.sheen);
        let alpha = |roughness: f32| roughness * roughness;
        substance.opaque.coat = (coat.strength > 0.0)
            .then(|| Coat { share: coat.strength, alpha: alpha(coat.roughness) });
        substance.opaque.sheen = (sheen.color != Rgb::ZERO)
            .then(|| Sheen { color: sheen.color, alpha: alpha(sheen.roughness) });
        substance
    }

    fn of_metallic_roughness(material: &SurfaceMaterial, made_of: MetallicRoughness) -> Self {
        let unit = |x: f32| if x.is_nan() { 0.0 } else { x.clamp(0.0, 1.0) };
        let colour = |c: Rgb| Rgb::from(c.to_array().map(unit));
        let MetallicRoughness { base, metallic, roughness, reflectance, transmission } = made_of;
        let (base, metallic, roughness) = (colour(base), unit(metallic), unit(roughness));
        // Of what lets light straight on, that is told already.
        let bends = material.ior != 1.0;
        let alpha = roughness * roughness;
        Self {
            opaque: OpaqueSurface {
                base,
                metallic,
                reflectance: Some(colour(reflectance)),
                alpha,
                coat: None,
                sheen: None,
            },
            glass_share: if bends { unit(transmission) * (1.0 - metallic) } else { 0.0 },
            tint: base,
            ior: material.ior,
            glass_alpha: alpha,
        }
    }

    /// Of diffuse, highlight, mirror and transmitted light: a body under a mirror, smooth or as rough as the highlight is broad.
    fn of_shares(material: &SurfaceMaterial, diffuse: Rgb) -> Self {
        let bends = material.transmissive && material.ior != 1.0;
        let transmitted = material.transmission.max_element();
        // The diffuse colour counts what is let through already.
        let is_all_glass = bends && diffuse == Rgb::ZERO;
        let glass_share = if is_all_glass {
            1.0
        } else if bends {
            transmitted
        } else {
            0.0
        };
        let body = 1.0 - if is_all_glass { 0.0 } else { transmitted };
        let base = if body > 0.0 { (1.0 / body) * diffuse } else { Rgb::ZERO };
        let tint = if is_all_glass || transmitted == 0.0 {
            material.transmission
        } else {
            (1.0 / transmitted) * material.transmission
        };

        let (reflectance, alpha) = if material.mirrors {
            (Some(material.mirror), 0.0)
        } else if material.shiny && !material.transmissive {
            // A mirror whose facets make a highlight as broad (Walter et al. 2007) and, of lights without extent, as bright.
            let strength = 8.0 / (material.shininess + 8.0);
            let alpha = (2.0 / (material.shininess + 2.0)).sqrt();
            (Some((strength * material.specular).min(Rgb::ONE)), alpha)
        } else {
            (None, 0.0)
        };
        Self {
            opaque: OpaqueSurface {
                base: base.min(Rgb::ONE),
                metallic: 0.0,
                reflectance,
                alpha,
                coat: None,
                sheen: None,
            },
            glass_share,
            tint,
            ior: material.ior,
            glass_alpha: 0.0,
        }
    }
}
