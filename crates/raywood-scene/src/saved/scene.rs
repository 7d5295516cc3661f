//! The section `scene` of a saved scene: everything that is small. `docs/format.md` specifies it.

use raywood::Vec3;

use super::stored::{Fault, Reader, Stored, stored_enum, stored_struct};
use crate::{
    Background, Camera, Clearcoat, Light, LightKind, Magnification, Material, MetallicRoughness,
    Pattern, Sheen, SurfaceTextures, Texture, TextureTransform, Wrap,
};

/// The version of what stands in the section.
const VERSION: u32 = 2;

/// What the section holds.
pub(super) struct Small {
    pub(super) up: Option<Vec3>,
    pub(super) background: Background,
    pub(super) materials: Vec<Material>,
    pub(super) lights: Vec<Light>,
    pub(super) cameras: Vec<Camera>,
}

impl Small {
    /// As bytes, its version first.
    pub(super) fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        VERSION.put(&mut bytes);
        self.put(&mut bytes);
        bytes
    }

    /// From all of some bytes.
    pub(super) fn of_bytes(bytes: &[u8]) -> Result<Self, Fault> {
        let mut reader = Reader { bytes, at: 0 };
        let version = u32::get(&mut reader)?;
        if version != VERSION {
            let problem = format!(
                "a scene of version {version}, expected version {VERSION}; save it again from its model"
            );
            return Err(Fault { at: 0, problem });
        }
        let small = Self::get(&mut reader)?;
        match reader.at == bytes.len() {
            true => Ok(small),
            false => Err(reader.fault("more bytes than the scene has")),
        }
    }
}

stored_struct!(Small { up, background, materials, lights, cameras });
stored_struct!(Background { zenith, horizon, nadir });
stored_struct!(Material {
    name,
    diffuse,
    pattern,
    specular,
    shininess,
    mirror,
    transmission,
    ior,
    absorption,
    emission,
    metallic_roughness,
    clearcoat,
    sheen,
    dispersion,
    textures,
});
stored_struct!(Clearcoat { strength, roughness });
stored_struct!(Sheen { color, roughness });
stored_struct!(MetallicRoughness { base, metallic, roughness, reflectance, transmission });
stored_struct!(SurfaceTextures {
    color,
    opacity,
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
});
stored_struct!(Texture { image, set, transform, wrap, magnification });
stored_enum!(Wrap { 0 => Repeat {}, 1 => Mirror {}, 2 => Clamp {} });
stored_enum!(Magnification { 0 => Nearest {}, 1 => Linear {} });
stored_struct!(Light { name, kind, intensity });
stored_struct!(Camera { name, eye, target, up, fov_y });
stored_enum!(Pattern {
    0 => Plain {},
    1 => Checker { other, size },
    2 => Marble { vein, size },
    3 => Tiles { other, size, edge, joint },
    4 => Masonry { length, height, joint },
});
stored_enum!(LightKind {
    0 => Point { position },
    1 => Spot { position, direction, cos_inner, cos_outer },
    2 => Directional { direction, angular_radius },
    3 => Ambient {},
});

/// Its two rows, all numbers of which are finite.
impl Stored for TextureTransform {
    fn put(&self, bytes: &mut Vec<u8>) {
        self.rows.as_flattened().iter().for_each(|number| number.put(bytes));
    }

    fn get(reader: &mut Reader<'_>) -> Result<Self, Fault> {
        let start = reader.at;
        let mut rows = [[0.0f32; 3]; 2];
        for number in rows.as_flattened_mut() {
            *number = f32::get(reader)?;
        }
        match rows.as_flattened().iter().all(|number| number.is_finite()) {
            true => Ok(Self { rows }),
            false => {
                let problem = "a number of a texture's transform is not finite".to_owned();
                Err(Fault { at: start, problem })
            }
        }
    }
}
