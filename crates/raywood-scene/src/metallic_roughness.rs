//! The metallic-roughness model (glTF 2.0, appendix B), as far as Whitted's method can show it.
//!
//! Mirrors here are perfect, so roughness is told by how much of a surface is mirror: all of it when smooth, fading to none; what
//! a rough metal no longer mirrors, it shows as a broad highlight and a coloured, diffuse-like sheen, so that it is not black.
//! Highlights follow Blinn with the exponent `2 / roughness^4 - 2` that matches the distribution of microfacets (Walter
//! et al. 2007), and a strength that keeps their energy, up to white.

use crate::Rgb;

/// What a surface is made of. All numbers are from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetallicRoughness {
    /// The colour: of diffuse light where it is no metal, of mirrored light where it is.
    pub base: Rgb,
    /// 1 for metal, 0 for anything else, between for what mixes both.
    pub metallic: f32,
    /// 0 for a mirror, 1 for chalk.
    pub roughness: f32,
    /// The share mirrored by what is not metal, looking straight at it: 0.04 for most things.
    pub reflectance: Rgb,
    /// The share of the light that enters what is not metal and is let through instead of scattered.
    pub transmission: f32,
}

/// How a surface shares out light, in the terms of [`Material`](crate::Material).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightShares {
    /// See [`Material::diffuse`](crate::Material::diffuse).
    pub diffuse: Rgb,
    /// See [`Material::specular`](crate::Material::specular).
    pub specular: Rgb,
    /// See [`Material::shininess`](crate::Material::shininess).
    pub shininess: f32,
    /// See [`Material::mirror`](crate::Material::mirror).
    pub mirror: Rgb,
    /// The share mirrored at grazing angles, to which `mirror` rises: 1 where all is smooth, less where roughness leaves little of the mirror.
    pub grazing: f32,
    /// See [`Material::transmission`](crate::Material::transmission).
    pub transmission: Rgb,
}

impl MetallicRoughness {
    /// How the surface shares out light.
    #[inline(always)]
    pub fn light_shares(&self) -> LightShares {
        let Self { base, metallic, roughness, reflectance, transmission } = *self;
        let f0 = (1.0 - metallic) * reflectance + metallic * base;

        let alpha = (roughness * roughness).max(1e-2);
        let shininess = (2.0 / (alpha * alpha) - 2.0).clamp(1.0, 10_000.0);
        let strength = (shininess + 8.0) / 8.0;
        let specular = (strength * f0).min(Rgb::ONE);

        // How much is mirror. Anything rises to a full mirror at grazing angles, which only the smooth of what is not metal may.
        let metal_share = metallic * (1.0 - roughness) * (1.0 - roughness);
        let smooth = (1.0 - roughness / 0.25).max(0.0);
        let mirror = metal_share * base + (1.0 - metallic) * smooth * reflectance;
        let sheen = 0.6 * (metallic - metal_share) * base;
        let shares = LightShares {
            diffuse: (1.0 - metallic) * base + sheen,
            specular: if metallic > 0.5 { (1.0 - 0.5 * roughness) * specular } else { specular },
            shininess,
            mirror,
            grazing: metal_share + (1.0 - metallic) * smooth,
            transmission: Rgb::ZERO,
        };

        // What lets light through is a dielectric, whose mirror follows from its index of refraction.
        let through = transmission * (1.0 - metallic);
        if through == 0.0 {
            return shares;
        }
        LightShares {
            diffuse: (1.0 - through) * shares.diffuse,
            mirror: Rgb::ZERO,
            transmission: through * base,
            ..shares
        }
    }
}
