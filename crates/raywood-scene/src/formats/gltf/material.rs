//! Materials of glTF: metallic and rough ones, their extensions and their textures.

use gltf_json::extensions::material as extension;
use gltf_json::material::{AlphaMode, Material as Source};
use gltf_json::texture::Info;
use gltf_json::validation::Checked;
use raywood::Vec3;

use super::layers;
use super::texture::{Named, Textures};
use crate::formats::images::Use;
use crate::{LightShares, Material, MetallicRoughness, Rgb, SurfaceTextures, Texture};

/// A material of the file.
pub(super) fn convert(source: &Source, textures: &mut Textures<'_>) -> Material {
    let none = extension::Material::default();
    let extensions = source.extensions.as_ref().unwrap_or(&none);
    let (surface, alpha) = surface(source, extensions);
    let ior = index_of_refraction(extensions);

    let LightShares { diffuse, specular, shininess, mirror, transmission, .. } =
        surface.light_shares();
    let mut material = Material {
        name: source.name.clone().unwrap_or_default(),
        diffuse,
        specular,
        shininess,
        mirror,
        transmission,
        emission: emission(source, extensions),
        metallic_roughness: Some(surface),
        clearcoat: layers::clearcoat(extensions),
        sheen: layers::sheen(extensions),
        ..Material::default()
    };
    if surface.transmission > 0.0 && surface.metallic < 1.0 {
        material.ior = ior;
        material.absorption = absorption(extensions);
        material.dispersion = layers::dispersion(extensions);
    }
    let found = surface_textures(source, extensions, alpha, textures);
    // A texture mostly says where a surface is dark; without it all of the surface would glow.
    if source.emissive_texture.is_some() && found.emission.is_none() {
        material.emission = Rgb::ZERO;
    }
    if extensions.unlit.is_some() {
        let (name, emission) = (material.name, surface.base);
        material = Material { name, emission, diffuse: Rgb::ZERO, ..Material::default() };
        // What is unlit sends out its colour.
        let SurfaceTextures { color, opacity, .. } = found;
        let textures = SurfaceTextures { color, opacity, emission: color, ..Default::default() };
        material.textures = color.is_some().then(|| Box::new(textures));
    } else if found != (SurfaceTextures { opacity: found.opacity, ..Default::default() }) {
        material.textures = Some(Box::new(found));
    }

    // What is let through by the alpha of a whole material goes straight on.
    let shown = match source.alpha_mode {
        Checked::Valid(AlphaMode::Blend) => alpha,
        Checked::Valid(AlphaMode::Mask) => f32::from(u8::from(alpha >= cutoff(source))),
        _ => 1.0,
    };
    if shown < 1.0 && material.textures.is_none() {
        material.diffuse = shown * material.diffuse;
        material.specular = shown * material.specular;
        material.emission = shown * material.emission;
        if material.transmission == Rgb::ZERO {
            material.ior = 1.0;
        }
        material.transmission = shown * material.transmission + Rgb::splat(1.0 - shown);
    }
    material
}

/// What a surface is made of, and its alpha.
fn surface(source: &Source, extensions: &extension::Material) -> (MetallicRoughness, f32) {
    if let Some(glossy) = &extensions.pbr_specular_glossiness {
        let [r, g, b, alpha] = glossy.diffuse_factor.0.map(unit);
        let surface = MetallicRoughness {
            base: Rgb::new(r, g, b),
            metallic: 0.0,
            roughness: 1.0 - unit(glossy.glossiness_factor.0),
            reflectance: Rgb::from(glossy.specular_factor.0.map(unit)),
            transmission: 0.0,
        };
        return (surface, alpha);
    }

    let pbr = &source.pbr_metallic_roughness;
    let [r, g, b, alpha] = pbr.base_color_factor.0.map(unit);
    let ior = index_of_refraction(extensions);
    let r0 = (ior - 1.0) / (ior + 1.0);
    let mut reflectance = Rgb::splat(r0 * r0);
    if let Some(specular) = &extensions.specular {
        let color = Rgb::from(specular.specular_color_factor.0.map(positive));
        reflectance = (reflectance * color).min(Rgb::ONE) * unit(specular.specular_factor.0);
    }
    let transmission =
        extensions.transmission.as_ref().map_or(0.0, |t| unit(t.transmission_factor.0));
    let surface = MetallicRoughness {
        base: Rgb::new(r, g, b),
        metallic: unit(pbr.metallic_factor.0),
        roughness: unit(pbr.roughness_factor.0),
        reflectance,
        transmission,
    };
    (surface, alpha)
}

/// `KHR_materials_ior`.
fn index_of_refraction(extensions: &extension::Material) -> f32 {
    let ior = extensions.ior.as_ref().map_or(1.5, |ior| ior.ior.0);
    if (1.0..=10.0).contains(&ior) { ior } else { 1.5 }
}

/// Light absorbed on its way inside (`KHR_materials_volume`). Everything is taken for solid: files say so too seldom.
fn absorption(extensions: &extension::Material) -> Vec3 {
    let Some(volume) = &extensions.volume else { return Vec3::ZERO };
    let distance = volume.attenuation_distance.0;
    if !(distance.is_finite() && distance > 0.0 && volume.thickness_factor.0 > 0.0) {
        return Vec3::ZERO;
    }
    // Attenuation leaves the colour after the distance.
    let absorbed = |left: f32| -unit(left).max(1e-4).ln() / distance;
    Vec3::from(volume.attenuation_color.0.map(absorbed))
}

/// Light sent out.
fn emission(source: &Source, extensions: &extension::Material) -> Rgb {
    let strength = extensions.emissive_strength.as_ref().map_or(1.0, |e| e.emissive_strength.0);
    positive(strength) * Rgb::from(source.emissive_factor.0.map(positive))
}

/// The least alpha of what is there in a cut-out.
fn cutoff(source: &Source) -> f32 {
    let cutoff = source.alpha_cutoff.map_or(0.5, |cutoff| cutoff.0);
    if cutoff.is_nan() { 0.5 } else { cutoff.max(0.0) }
}

/// The textures of a material, whose whole alpha is given.
fn surface_textures(
    source: &Source,
    extensions: &extension::Material,
    alpha: f32,
    textures: &mut Textures<'_>,
) -> SurfaceTextures {
    let mut texture = |info: Option<&Info>, use_: Use| -> Option<Texture> {
        textures.texture(Named::info(info?), use_)
    };

    // The factor of alpha moves the cut-off of the texture's.
    let (opacity, color_use) = match source.alpha_mode {
        Checked::Valid(AlphaMode::Blend) => (Some(alpha), Use::Color),
        Checked::Valid(AlphaMode::Mask) if alpha > 0.0 => {
            (Some(1.0), Use::cutout(cutoff(source) / alpha))
        }
        Checked::Valid(AlphaMode::Mask) => (Some(0.0), Use::Color),
        _ => (None, Use::Color),
    };
    let pbr = &source.pbr_metallic_roughness;
    let mut found = match &extensions.pbr_specular_glossiness {
        Some(glossy) => SurfaceTextures {
            color: texture(glossy.diffuse_texture.as_ref(), color_use),
            glossiness: texture(glossy.specular_glossiness_texture.as_ref(), Use::ColorFactors),
            ..SurfaceTextures::default()
        },
        None => SurfaceTextures {
            color: texture(pbr.base_color_texture.as_ref(), color_use),
            metallic_roughness: texture(
                pbr.metallic_roughness_texture.as_ref(),
                Use::MetallicRoughness,
            ),
            ..SurfaceTextures::default()
        },
    };
    found.opacity = opacity;
    found.emission = texture(source.emissive_texture.as_ref(), Use::Emission);
    if let Some(transmission) = &extensions.transmission {
        found.transmission = texture(transmission.transmission_texture.as_ref(), Use::Factors);
    }
    if let Some(specular) = &extensions.specular {
        found.specular = texture(specular.specular_texture.as_ref(), Use::Factors);
        found.specular_color = texture(specular.specular_color_texture.as_ref(), Use::ColorFactors);
    }

    layers::find_textures(extensions, textures, &mut found);
    if let Some(normal) = &source.normal_texture {
        let others = normal.extensions.as_ref().and_then(|e| e.others.get(TRANSFORM));
        let named = Named::other(normal.index.value(), normal.tex_coord, others);
        let scale = if normal.scale.is_finite() { normal.scale } else { 1.0 };
        found.normal = textures.texture(named, Use::Normals).map(|texture| (texture, scale));
    }
    if let Some(occlusion) = &source.occlusion_texture {
        let others = occlusion.extensions.as_ref().and_then(|e| e.others.get(TRANSFORM));
        let named = Named::other(occlusion.index.value(), occlusion.tex_coord, others);
        let strength = unit(occlusion.strength.0);
        found.occlusion = textures.texture(named, Use::Factors).map(|texture| (texture, strength));
    }
    found
}

/// The extension that moves texture coordinates.
const TRANSFORM: &str = "KHR_texture_transform";

/// A factor within 0 to 1.
pub(super) fn unit(factor: f32) -> f32 {
    if factor.is_nan() { 0.0 } else { factor.clamp(0.0, 1.0) }
}

/// A finite factor of at least 0.
pub(super) fn positive(factor: f32) -> f32 {
    if factor.is_finite() { factor.max(0.0) } else { 0.0 }
}
