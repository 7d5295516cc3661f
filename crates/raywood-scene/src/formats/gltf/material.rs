//! Metallic and rough materials of glTF as Whitted's method can show them.
//!
//! Mirrors here are perfect, so roughness is told by how much of a surface is mirror: all of it when smooth, fading to none; what
//! a rough metal no longer mirrors, it shows as a broad highlight and a coloured, diffuse-like sheen, so that it is not black.
//! Highlights follow Blinn with the exponent `2 / roughness^4 - 2` that matches the distribution of microfacets (Walter
//! et al. 2007), and a strength that keeps their energy, up to white.

use std::collections::BTreeSet;

use gltf_json::extensions::material as extension;
use gltf_json::material::{AlphaMode, Material as Source};
use gltf_json::texture;
use gltf_json::validation::Checked;
use raywood::Vec3;

use crate::formats::notes::{Notes, counted};
use crate::{Material, Rgb};

/// The textures that materials name, which are not shown yet.
#[derive(Default)]
pub(super) struct Textures {
    found: BTreeSet<(usize, &'static str)>,
}

impl Textures {
    /// Notes a texture; whether there is one.
    fn note(&mut self, kind: &'static str, info: Option<&texture::Info>) -> bool {
        self.found.extend(info.map(|info| (info.index.value(), kind)));
        info.is_some()
    }

    /// Says in one line what is left out.
    pub(super) fn say(&self, notes: &mut Notes) {
        let indices: BTreeSet<usize> = self.found.iter().map(|(index, _)| *index).collect();
        let kinds: BTreeSet<&str> = self.found.iter().map(|(_, kind)| *kind).collect();
        if !indices.is_empty() {
            let kinds = kinds.into_iter().collect::<Vec<_>>().join(", ");
            let verb = if indices.len() == 1 { "is" } else { "are" };
            notes.say(format!(
                "{} {verb} not shown yet: {kinds}",
                counted(indices.len(), "texture")
            ));
        }
    }
}

/// What a surface is made of, as glTF has it.
struct Surface {
    base: Rgb,
    metallic: f32,
    roughness: f32,
    /// The share mirrored by what is not metal, looking straight at it.
    reflectance: Rgb,
}

/// A material of the file.
pub(super) fn convert(source: &Source, textures: &mut Textures) -> Material {
    let none = extension::Material::default();
    let extensions = source.extensions.as_ref().unwrap_or(&none);
    let pbr = &source.pbr_metallic_roughness;
    let [r, g, b, alpha] = pbr.base_color_factor.0.map(unit);

    note_other_textures(source, extensions, textures);
    textures.note("base colour", pbr.base_color_texture.as_ref());
    let mut surface = Surface {
        base: Rgb::new(r, g, b),
        metallic: unit(pbr.metallic_factor.0),
        roughness: unit(pbr.roughness_factor.0),
        reflectance: Rgb::splat(0.04),
    };
    // Where a texture tells metal from the rest, the factors are no more than their upper bounds (mostly 1): more things
    // are half-rough paint than rough metal.
    if textures.note("roughness and metal", pbr.metallic_roughness_texture.as_ref()) {
        surface.metallic = 0.0;
        surface.roughness *= 0.7;
    }
    let ior = extensions.ior.as_ref().map_or(1.5, |ior| ior.ior.0);
    let ior = if (1.0..=10.0).contains(&ior) { ior } else { 1.5 };
    let r0 = (ior - 1.0) / (ior + 1.0);
    surface.reflectance = Rgb::splat(r0 * r0);
    if let Some(specular) = &extensions.specular {
        let color = Rgb::from(specular.specular_color_factor.0.map(positive));
        surface.reflectance =
            (surface.reflectance * color).min(Rgb::ONE) * unit(specular.specular_factor.0);
    }
    let mut alpha = alpha;
    if let Some(glossy) = &extensions.pbr_specular_glossiness {
        let [r, g, b, a] = glossy.diffuse_factor.0.map(unit);
        alpha = a;
        let reflectance = Rgb::from(glossy.specular_factor.0.map(unit));
        let roughness = 1.0 - unit(glossy.glossiness_factor.0);
        surface = Surface { base: Rgb::new(r, g, b), metallic: 0.0, roughness, reflectance };
    }

    let mut material = shade(&surface);
    material.name = source.name.clone().unwrap_or_default();
    transmit(&mut material, extensions, &surface, ior);
    emit(&mut material, source, extensions, textures);
    if extensions.unlit.is_some() {
        let (name, emission) = (material.name, surface.base);
        material = Material { name, emission, diffuse: Rgb::ZERO, ..Material::default() };
    }

    // What is let through by alpha goes straight on.
    let shown = match source.alpha_mode {
        Checked::Valid(AlphaMode::Blend) => alpha,
        Checked::Valid(AlphaMode::Mask) => {
            let cutoff = source.alpha_cutoff.map_or(0.5, |cutoff| cutoff.0);
            if alpha < cutoff { 0.0 } else { 1.0 }
        }
        _ => 1.0,
    };
    if shown < 1.0 {
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

/// Diffuse light, highlight and mirror of an opaque surface.
fn shade(surface: &Surface) -> Material {
    let Surface { base, metallic, roughness, reflectance } = *surface;
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
    Material {
        diffuse: (1.0 - metallic) * base + sheen,
        specular: if metallic > 0.5 { (1.0 - 0.5 * roughness) * specular } else { specular },
        shininess,
        mirror,
        ..Material::default()
    }
}

/// Light let through (`KHR_materials_transmission`), bent, and absorbed on its way (`KHR_materials_volume`). Everything is taken
/// for solid: files say so too seldom.
fn transmit(
    material: &mut Material,
    extensions: &extension::Material,
    surface: &Surface,
    ior: f32,
) {
    let factor = extensions.transmission.as_ref().map_or(0.0, |t| unit(t.transmission_factor.0));
    let through = factor * (1.0 - surface.metallic);
    if through == 0.0 {
        return;
    }
    material.transmission = through * surface.base;
    material.diffuse = (1.0 - through) * material.diffuse;
    material.mirror = Rgb::ZERO;
    material.ior = ior;
    if let Some(volume) = &extensions.volume {
        let distance = volume.attenuation_distance.0;
        if distance.is_finite() && distance > 0.0 && volume.thickness_factor.0 > 0.0 {
            // Attenuation leaves the colour after the distance.
            let absorbed = |left: f32| -unit(left).max(1e-4).ln() / distance;
            material.absorption = Vec3::from(volume.attenuation_color.0.map(absorbed));
        }
    }
}

/// Light sent out.
fn emit(
    material: &mut Material,
    source: &Source,
    extensions: &extension::Material,
    textures: &mut Textures,
) {
    let strength = extensions.emissive_strength.as_ref().map_or(1.0, |e| e.emissive_strength.0);
    // A texture mostly says where a surface is dark; without it all of the surface would glow.
    if !textures.note("emission", source.emissive_texture.as_ref()) {
        material.emission = positive(strength) * Rgb::from(source.emissive_factor.0.map(positive));
    }
}

/// Notes the textures that change nothing here by their absence.
fn note_other_textures(source: &Source, extensions: &extension::Material, textures: &mut Textures) {
    let normal = source.normal_texture.as_ref().map(|t| (t.index.value(), "normal"));
    let occlusion = source.occlusion_texture.as_ref().map(|t| (t.index.value(), "occlusion"));
    textures.found.extend(normal.into_iter().chain(occlusion));
    if let Some(transmission) = &extensions.transmission {
        textures.note("transmission", transmission.transmission_texture.as_ref());
    }
    if let Some(volume) = &extensions.volume {
        textures.note("thickness", volume.thickness_texture.as_ref());
    }
    if let Some(specular) = &extensions.specular {
        textures.note("specular", specular.specular_texture.as_ref());
        textures.note("specular", specular.specular_color_texture.as_ref());
    }
    if let Some(glossy) = &extensions.pbr_specular_glossiness {
        textures.note("diffuse", glossy.diffuse_texture.as_ref());
        textures.note("specular", glossy.specular_glossiness_texture.as_ref());
    }
}

/// A factor within 0 to 1.
fn unit(factor: f32) -> f32 {
    if factor.is_nan() { 0.0 } else { factor.clamp(0.0, 1.0) }
}

/// A finite factor of at least 0.
fn positive(factor: f32) -> f32 {
    if factor.is_finite() { factor.max(0.0) } else { 0.0 }
}
