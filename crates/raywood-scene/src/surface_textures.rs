//! What varies over a surface by textures.

use crate::Texture;

/// The textures of a material. Each modulates something that the material says for the whole surface; without it nothing varies.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceTextures {
    /// Multiplies the colour: the base colour of what is [metallic and rough](crate::MetallicRoughness), else diffuse light. Its alpha is the
    /// share of the surface that is there, if `opacity` says so.
    pub color: Option<Texture>,
    /// How much of the surface is there, for alpha to multiply. `None` means all of it, whatever alpha says. What is not there
    /// lets rays straight on.
    pub opacity: Option<f32>,
    /// A further factor of opacity: red, green and blue, averaged.
    pub opacity_map: Option<Texture>,
    /// Normals in tangent space: red along u, green against v, blue along the normal, each from -1 to 1. The number scales the first two.
    pub normal: Option<(Texture, f32)>,
    /// Blue multiplies how metallic, green how rough it is.
    pub metallic_roughness: Option<Texture>,
    /// Red, green and blue multiply what is mirrored by what is not metal, alpha multiplies `1 - roughness`
    /// (`KHR_materials_pbrSpecularGlossiness`).
    pub glossiness: Option<Texture>,
    /// Multiplies what is mirrored by what is not metal, or the highlight and mirror of a material that is not [metallic and
    /// rough](crate::MetallicRoughness).
    pub specular_color: Option<Texture>,
    /// Its alpha does so too.
    pub specular: Option<Texture>,
    /// Red multiplies the share let through.
    pub transmission: Option<Texture>,
    /// Red tells how much of the ambient light arrives, weighted by the number: at 0 all does.
    pub occlusion: Option<(Texture, f32)>,
    /// Red multiplies the strength of the clear coat.
    pub clearcoat: Option<Texture>,
    /// Green multiplies how rough the clear coat is.
    pub clearcoat_roughness: Option<Texture>,
    /// Multiplies the colour of the sheen.
    pub sheen_color: Option<Texture>,
    /// Its alpha multiplies how rough the sheen is.
    pub sheen_roughness: Option<Texture>,
    /// Multiplies the light sent out.
    pub emission: Option<Texture>,
}

/// The textures of a reference, to be read or to be changed as that allows. No field can be forgotten: there is no `..`.
macro_rules! all_of {
    ($textures:expr) => {{
        let SurfaceTextures {
            color,
            opacity: _,
            opacity_map,
            normal,
            metallic_roughness,
            glossiness,
            specular_color,
            specular,
            transmission,
            occlusion,
            clearcoat,
            clearcoat_roughness,
            sheen_color,
            sheen_roughness,
            emission,
        } = $textures;
        let numbered = [normal, occlusion].into_iter().flatten().map(|(texture, _)| texture);
        let others = [
            color,
            opacity_map,
            metallic_roughness,
            glossiness,
            specular_color,
            specular,
            transmission,
            clearcoat,
            clearcoat_roughness,
            sheen_color,
            sheen_roughness,
            emission,
        ];
        others.into_iter().flatten().chain(numbered)
    }};
}

impl SurfaceTextures {
    /// All that there are.
    pub fn all(&self) -> impl Iterator<Item = &Texture> {
        all_of!(self)
    }

    /// All that there are, to be changed.
    pub(crate) fn all_mut(&mut self) -> impl Iterator<Item = &mut Texture> {
        all_of!(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// None is passed over, neither when they are read nor when they are changed.
    #[test]
    fn all_textures_are_among_all() {
        let texture = Some(Texture::new(1));
        let numbered = texture.map(|texture| (texture, 1.0));
        let mut textures = SurfaceTextures {
            color: texture,
            opacity: None,
            opacity_map: texture,
            normal: numbered,
            metallic_roughness: texture,
            glossiness: texture,
            specular_color: texture,
            specular: texture,
            transmission: texture,
            occlusion: numbered,
            clearcoat: texture,
            clearcoat_roughness: texture,
            sheen_color: texture,
            sheen_roughness: texture,
            emission: texture,
        };
        assert_eq!(textures.all().count(), 14);
        textures.all_mut().for_each(|texture| texture.image += 1);
        assert_eq!(textures.all().filter(|texture| texture.image == 2).count(), 14);
    }
}
