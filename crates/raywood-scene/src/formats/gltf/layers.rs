//! Extensions of glTF materials that the reader of the JSON leaves as they are: clear coats, sheen and dispersion.

use gltf_json::extensions::material as extension;
use gltf_json::{Value, deserialize};

use super::material::{positive, unit};
use super::texture::{Named, Textures};
use crate::formats::images::Use;
use crate::{Clearcoat, Rgb, Sheen, SurfaceTextures, Texture};

/// `KHR_materials_clearcoat`, but for its normals: a coat follows those of what it covers.
const CLEARCOAT: &str = "KHR_materials_clearcoat";
const SHEEN: &str = "KHR_materials_sheen";
const DISPERSION: &str = "KHR_materials_dispersion";

/// The clear coat of a material, if it has one.
pub(super) fn clearcoat(extensions: &extension::Material) -> Option<Clearcoat> {
    let source = extensions.others.get(CLEARCOAT)?;
    let factor = |name| unit(number(source, name).unwrap_or(0.0));
    let (strength, roughness) = (factor("clearcoatFactor"), factor("clearcoatRoughnessFactor"));
    (strength > 0.0).then_some(Clearcoat { strength, roughness })
}

/// The sheen of a material, if it has one.
pub(super) fn sheen(extensions: &extension::Material) -> Option<Sheen> {
    let source = extensions.others.get(SHEEN)?;
    let factors = source.get("sheenColorFactor");
    let channel = |i: usize| factors.and_then(|f| f.get(i)?.as_f64()).map_or(0.0, |x| x as f32);
    let color = Rgb::from([0, 1, 2].map(|i| unit(channel(i))));
    let roughness = unit(number(source, "sheenRoughnessFactor").unwrap_or(0.0));
    (color != Rgb::ZERO).then_some(Sheen { color, roughness })
}

/// By how much a material parts light into colours.
pub(super) fn dispersion(extensions: &extension::Material) -> f32 {
    let source = extensions.others.get(DISPERSION);
    source.and_then(|source| number(source, "dispersion")).map_or(0.0, positive)
}

/// Finds the textures of the coat and the sheen.
pub(super) fn find_textures(
    extensions: &extension::Material,
    textures: &mut Textures<'_>,
    found: &mut SurfaceTextures,
) {
    let mut texture = |extension: &str, name: &str, use_: Use| -> Option<Texture> {
        let source = extensions.others.get(extension)?.get(name)?;
        let info = deserialize::from_value(source.clone()).ok()?;
        textures.texture(Named::info(&info), use_)
    };
    if clearcoat(extensions).is_some() {
        found.clearcoat = texture(CLEARCOAT, "clearcoatTexture", Use::Factors);
        let name = "clearcoatRoughnessTexture";
        found.clearcoat_roughness = texture(CLEARCOAT, name, Use::Factors);
    }
    if sheen(extensions).is_some() {
        found.sheen_color = texture(SHEEN, "sheenColorTexture", Use::ColorFactors);
        found.sheen_roughness = texture(SHEEN, "sheenRoughnessTexture", Use::Factors);
    }
}

fn number(source: &Value, name: &str) -> Option<f32> {
    source.get(name)?.as_f64().map(|number| number as f32)
}
